#!/usr/bin/python3
"""LinuxCNC's own interpreter over a program: every move with its line, in mm, degrees and mm/min, one JSON list a line.

    poses.py PROGRAM INI TOOLS     # TOOLS: tool table in mm

The module `gcode` is the interpreter of the controller. Its tool table lies in a file of HOME that all processes with the
same HOME share: HOME must be a folder of this process alone.
"""
import ctypes, json, os, sys

tools = ctypes.CDLL("libtooldata.so.0", mode=ctypes.RTLD_GLOBAL)


mapped = False


def load_tools(table):
    """Loads a tool table as the one of the interpreter."""
    global mapped
    if not mapped:
        # Without its map a tool change crashes. A second map of a process ends it.
        tools._Z17tool_mmap_creatorPK13EMC_TOOL_STATi(None, 0)
        mapped = True
    if tools._Z13tooldata_loadPKcPPc(table.encode(), None) != 0:
        sys.exit("the tool table is not read")


import gcode

MM = 25.4  # The module calls back in inches, in G21 as well.


class Canon:
    """What the interpreter asks of a machine, and tells it."""

    def __init__(self, lengths):
        self.parameter_file = os.path.join(os.environ["HOME"], "parameters.var")
        open(self.parameter_file, "w").close()
        self.lengths, self.line, self.feed = lengths, 0, 0.0

    def next_line(self, state):
        self.line = state.sequence_number

    def get_axis_mask(self):
        return 0x3F

    def get_block_delete(self):
        return False

    def get_external_angular_units(self):
        return 1.0

    def get_external_length_units(self):
        return 1.0  # Tool table and parameter file in mm.

    def check_abort(self):
        return False

    def get_tool(self, pocket):
        number, length = self.lengths.get(pocket, (-1, 0.0))
        return (number, 0.0, 0.0, length) + (0.0,) * 9 + (0,)

    def change_tool(self, pocket):
        self.lengths[0] = self.lengths[pocket]
        self.say("tool", self.lengths[0][0])

    def set_feed_rate(self, feed):
        self.feed = feed * MM

    def tool_offset(self, *offset):
        self.say("length", offset[2] * MM)

    def set_g5x_offset(self, index, *offset):
        self.say("offset", index, *[x * MM for x in offset[:3]], *offset[3:6])

    def set_g92_offset(self, *offset):
        self.say("shift", *offset)

    def set_xy_rotation(self, angle):
        self.say("rotation", angle)

    def straight_traverse(self, *to):
        self.move("G0", to)

    def straight_feed(self, *to):
        self.move("G1", to)

    def arc_feed(self, *to):
        self.say("arc", *to)

    def move(self, kind, to):
        self.say(kind, *[x * MM for x in to[:3]], *to[3:6], self.feed)

    def say(self, what, *values):
        print(json.dumps([self.line, what, *values]))

    def ignore(self, *_):
        pass

    comment = message = dwell = set_plane = set_traverse_rate = user_defined_function = ignore


def lengths(table):
    """Number and length of each tool by its pocket."""
    found = {}
    for line in open(table):
        words = {word[0]: word[1:] for word in line.split(";")[0].split()}
        if "T" in words:
            found[len(found) + 1] = (int(words["T"]), float(words.get("Z", 0)))
    return found


if __name__ == "__main__":
    program, ini, table = sys.argv[1:4]
    os.environ["INI_FILE_NAME"] = ini
    load_tools(table)
    result, line = gcode.parse(program, Canon(lengths(table)), ["G21"], "")
    if result > gcode.MIN_ERROR:
        sys.exit(f"line {line}: {gcode.strerror(result)}")
