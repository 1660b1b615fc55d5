#!/usr/bin/python3
"""LinuxCNC's own interpreter over many programs: a JSON string a line in, what the interpreter does a line out.

    edits.py INI TOOLS OFFSET_X OFFSET_Y OFFSET_Z    # TOOLS: tool table in mm; offsets: those of G54, mm

Out comes {"refused": why}, or {"events": [...]}. Some programs end the interpreter:
then each of a batch runs in a process of its own.
"""
import json, os, sys

from poses import Canon, gcode, lengths, load_tools

ini, table = sys.argv[1:3]
OFFSETS = [float(x) for x in sys.argv[3:6]]


class Told(Canon):
    """Keeps what `poses.Canon` prints, and the modal state behind each line."""

    def __init__(self):
        super().__init__(lengths(table))
        self.events = []
        with open(self.parameter_file, "w") as file:
            for number, value in zip((5221, 5222, 5223), OFFSETS):
                file.write(f"{number}\t{value}\n")

    def next_line(self, state):
        super().next_line(state)
        self.say("state", *[getattr(state, name) for name in
                 ("plane", "cutter_side", "units", "distance_mode", "feed_mode", "origin", "path_mode", "spindle", "mist",
                  "flood", "speed")])

    def say(self, what, *values):
        self.events.append([self.line, what, *values])

    def comment(self, text):
        # Of the remaps of M428 and M429.
        for kind, switched in (("on", 1), ("off", 0)):
            if text.startswith(f"tool centre point control {kind}: kinematics type"):
                self.say("kinematics", switched)

    def dwell(self, seconds):
        self.say("dwell", seconds)


def meant(path):
    load_tools(table)
    canon = Told()
    result, line = gcode.parse(path, canon, [])
    if result > gcode.MIN_ERROR:
        return {"refused": f"line {line}: {gcode.strerror(result)}"}
    return {"events": canon.events}


BATCH = 40

os.environ["INI_FILE_NAME"] = ini
path, answers = (os.path.join(os.environ["HOME"], name) for name in ("edited.ngc", "answers"))
# The interpreter prints as well.
out = os.fdopen(os.dup(1), "w")
os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def told(text):
    with open(path, "w", newline="") as file:
        file.write(text)
    try:
        return meant(path)
    except Exception as why:  # A word for which the interpreter calls back what Told has not.
        return {"refused": f"call: {why!r}"}


def apart(texts):
    """Answers to some texts from a process of their own; None where it ended too early."""
    child = os.fork()
    if child == 0:
        with open(answers, "w") as file:
            file.writelines(json.dumps(told(text)) + "\n" for text in texts)
        os._exit(0)
    status = os.waitpid(child, 0)[1]
    if status != 0:
        return None
    with open(answers) as file:
        return file.readlines()


texts = [json.loads(line) for line in sys.stdin]
ended = [json.dumps({"refused": "the interpreter ended"}) + "\n"]
for start in range(0, len(texts), BATCH):
    batch = texts[start:start + BATCH]
    out.writelines(apart(batch) or [answer for text in batch for answer in apart([text]) or ended])
out.close()
