#!/usr/bin/python3
"""Judges a run of controller.sh: joints against their limits, tool against the program, times against the certificate.

    judge.py ROOM PROGRAM CERTIFICATE     # ROOM: folder with samples.txt and events.json

FLUTE in the environment: length of the flutes in mm. Exits with 1 when something does not hold.
"""
import json, math, os, re, sys

room, program, certificate = sys.argv[1:4]
FLUTE = float(os.environ["FLUTE"])
PERIOD = 0.001
# Limits of xyzac-trt.ini and xyzbc-trt.ini: mm/s or deg/s, and the same for accelerations.
SPEED = [20.0, 20.0, 20.0, 30.0, 30.0]
ACCELERATION = [300.0] * 5
# The axis that tilts, A or B, and how far it lies beside (Y or X) and over the rotation point, mm.
TILT = json.load(open(certificate))["measured"]["machine"]["axes"][3]["axis"]
BESIDE, OVER = {"A": (20.0, 10.0), "B": (-20.0, -15.0)}[TILT]
AXES = f"XYZ{TILT}C"
# Difference of a time to the certificate's, as a share.
TIME = 0.03
# Lines from the last move with the kinematics on to the way up: M429, G49, G53 G0 Z.
RETRACT = 3
# Samples of which the place is looked at.
EVERY = 3

faults = []


def fault(text):
    faults.append(text)
    print("FAULT:", text)


def tool(joints, length):
    """Tip and end of the flutes, from joints with the kinematics on."""
    x, y, z, tilt, c = joints
    s, k = math.sin(math.radians(tilt)), math.cos(math.radians(tilt))
    sc, cc = math.sin(math.radians(c)), math.cos(math.radians(c))
    w = z - OVER - length
    # Back to the untilted table: a positive word turns Y to Z (A), or Z to X (B).
    if TILT == "A":
        v = y - BESIDE
        y, z = k * v + s * w + BESIDE, -s * v + k * w + OVER
    else:
        u = x - BESIDE
        x, z = k * u - s * w + BESIDE, s * u + k * w + OVER
    return ends((cc * x + sc * y, -sc * x + cc * y, z, tilt, c))


def ends(pose):
    """Tip and end of the flutes of a pose in the part frame."""
    x, y, z, tilt, c = pose
    s, k = math.sin(math.radians(tilt)), math.cos(math.radians(tilt))
    sc, cc = math.sin(math.radians(c)), math.cos(math.radians(c))
    i, j = (sc * s, cc * s) if TILT == "A" else (-cc * s, sc * s)
    return (x, y, z), (x + FLUTE * i, y + FLUTE * j, z + FLUTE * k)


def read_program():
    """Moves under the kinematics by line: start, end, at rapid; and all lines."""
    moves, on, inverse, rapid, pose = {}, False, False, True, None
    lines = open(program).read().splitlines()
    for number, line in enumerate(lines, 1):
        code = re.sub(r"\(.*?\)|;.*", "", line).upper()
        if "M428" in code:
            on, pose = True, None
        if "M429" in code:
            on = False
        words = dict(re.findall(rf"([{AXES}])\s*(-?[\d.]+)", code))
        inverse = "G93" in code or (inverse and "G94" not in code)
        if re.search(r"\bG0?[01]\b", code):
            rapid = bool(re.search(r"\bG0?0\b", code))
        if not on or not words:
            continue
        last = pose or [0.0] * 5
        to = [float(words.get(k, v)) for k, v in zip(AXES, last)]
        moves[number] = (pose, to, rapid or inverse)
        pose = to
    return moves, lines


def deviation(block, place):
    """Largest of the ways of tip and flutes to the nearest pose of a block, mm."""
    start, end, _ = block
    if start is None:
        return math.inf
    at = lambda t: [p + (q - p) * t for p, q in zip(start, end)]
    spread = lambda pose: [x for point in ends(pose) for x in point]
    here = [x for point in place for x in point]
    p, q = spread(start), spread(end)
    along = [b - a for a, b in zip(p, q)]
    size = sum(d * d for d in along)
    if size == 0:
        t = 0.0
    else:
        t = sum(d * (h - a) for d, h, a in zip(along, here, p)) / size
        t = min(1.0, max(0.0, t))
        # The flutes turn: once more with the true direction there.
        step = 1e-4
        now, near = spread(at(t)), spread(at(t + step))
        along = [(b - a) / step for a, b in zip(now, near)]
        size = sum(d * d for d in along)
        t += sum(d * (h - a) for d, h, a in zip(along, here, now)) / size
        t = min(1.0, max(0.0, t))
    now = ends(at(t))
    return max(math.dist(a, b) for a, b in zip(now, place))


def main():
    moves, lines = read_program()
    file = json.load(open(certificate))
    events = json.load(open(os.path.join(room, "events.json")))
    for event in events:
        if event["what"] == "error":
            fault(f"line {event['line']}: {event['text']}")
    operations = [
        {"name": o["name"], "last": o["last"], "run": run, "samples": {True: 0, False: 0},
         "worst": {True: (0.0, 0), False: (0.0, 0)}}
        for o, run in zip(file["nc"]["operations"], file["measured"]["machine"]["runs"])
    ]
    of_line = {n: o for o, f in zip(operations, file["nc"]["operations"]) for n in range(f["first"], o["last"] + RETRACT + 1)}
    # Most of speed and acceleration by joint and kind of line, with the line.
    kinds = ("feed", "rapid", "off")
    speeds = {kind: [(0.0, 0)] * 5 for kind in kinds}
    accelerations = {kind: [(0.0, 0)] * 5 for kind in kinds}
    before = before2 = None
    count = lost = 0
    for text in open(os.path.join(room, "samples.txt")):
        values = text.split()
        if len(values) != 9:
            continue
        tag, line = int(values[0]), int(values[8])
        joints = [float(v) for v in values[1:6]]
        on, length = float(values[6]) > 0.5, float(values[7])
        count += 1
        if before and tag != before[0] + 1:
            lost += 1
            before = before2 = None
        if before and joints != before[1]:
            kind = "off" if not on else "rapid" if line in moves and moves[line][2] else "feed"
            for k in range(5):
                v = abs(joints[k] - before[1][k]) / PERIOD
                if v > speeds[kind][k][0]:
                    speeds[kind][k] = (v, line)
                if before2:
                    a = abs(joints[k] - 2 * before[1][k] + before2[1][k]) / PERIOD**2
                    if a > accelerations[kind][k][0]:
                        accelerations[kind][k] = (a, line)
        last_joints = before[1] if before else joints
        before2, before = before, (tag, joints)
        operation = of_line.get(line)
        if operation is None:
            continue
        if not on:
            # The way up to the retract height, with the kinematics off, ends the operation.
            if line > operation["last"] and joints != last_joints:
                operation["samples"][True] += 1
            continue
        if line not in moves:
            continue
        rapid = moves[line][2]
        operation["samples"][rapid] += 1
        if tag % EVERY == 0:
            place = tool(joints, length)
            near = [n for n in range(line - 2, line + 3) if n in moves]
            off = min(deviation(moves[n], place) for n in near)
            beside = any(moves[n][2] for n in near)
            if off > operation["worst"][beside][0]:
                operation["worst"][beside] = (off, line)
    print(f"{count} samples, {lost} gaps")
    for what, limit, found in (("speed", SPEED, speeds), ("acceleration", ACCELERATION, accelerations)):
        for kind in kinds:
            shares = [f"{100 * f[0] / l:.1f} % ({f[1]})" for f, l in zip(found[kind], limit)]
            print(f"largest {what} of {' '.join(AXES)}, {kind}: of the limits, with the line:", ", ".join(shares))
            for joint, f, l in zip(AXES, found[kind], limit):
                if what == "speed" and f[0] > l * 1.001:
                    fault(f"joint {joint} runs at {f[0]:.2f} of {l} a second in line {f[1]}: {lines[f[1] - 1]}")
    for o in operations:
        spent = {rapid: n * PERIOD for rapid, n in o["samples"].items()}
        cut, link, rapid = o["run"]["time"]
        total, said = sum(spent.values()), cut + link + rapid
        bound = o["run"]["contour"]["value"]
        worst, line = o["worst"][False]
        print(
            f"{o['name']}: {total:.2f} s, certificate {said:.2f} s ({100 * (total / said - 1):+.1f} %); "
            f"feed {spent[False]:.2f} and {cut + link:.2f}, rapid {spent[True]:.2f} and {rapid:.2f}; "
            f"deviation {worst * 1e3:.2f} um in line {line}, certificate {bound * 1e3:.2f} um; "
            f"beside rapids {o['worst'][True][0] * 1e3:.1f} um in line {o['worst'][True][1]}"
        )
        if not any(e["what"] == "aborted" for e in events):
            if abs(total / said - 1) > TIME:
                fault(f"{o['name']} takes {total:.2f} s, the certificate says {said:.2f} s")
        if worst > bound:
            fault(f"{o['name']} leaves the program by {worst * 1e3:.2f} um, the certificate says {bound * 1e3:.2f} um")
    print("holds" if not faults else f"{len(faults)} faults")
    sys.exit(1 if faults else 0)


main()
