"""Judges STEP files by OpenCASCADE, and the judge by files that are broken on purpose.

    gate.py LIBRARIES part.step...

LIBRARIES is a folder with the libraries of OpenCASCADE under the names that its program opens. Beside each `part.step` stands
`part.txt`, what impellerc said of it: numbers of faces and edges, volume. A file passes when OpenCASCADE reads it without
a complaint as one valid solid with these faces, tolerances of at most 1e-6 mm, no free edge, nothing that crosses itself or leaves its face, and
this volume within 1e-6. In files of more than 130 faces crossings are not looked for, to save time. Reading alone proves little: it mends what it can and widens tolerances.
"""

import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

HERE = Path(__file__).parent
TOLERANCE = 1e-6
VOLUME = 1e-6
# Most faces of a file in which crossings are looked for, and the longest time of a search.
SEARCHED = 130
SECONDS = 1800


def examine(libraries, path, crossings):
    environment = {**os.environ, "LD_LIBRARY_PATH": libraries, "STEPFILE": str(path)}
    environment |= {"CROSSINGS": "all"} if crossings else {}
    command = ["occt-draw-7.6", "-b", "-f", str(HERE / "examine.tcl")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=SECONDS)
    return done.stdout + done.stderr


def judged(libraries, path, due):
    """What is wrong with a file. Crossings are looked for in files without other faults: that takes most of the time."""
    found = faults(examine(libraries, path, False), due)
    if due["faces"] > SEARCHED:
        due["measured"] += ", crossings not looked for"
    elif not found and "seem(s) to be valid for BOP" not in examine(libraries, path, True):
        found.append("crosses itself, or an edge is not on its face")
    return found


def faults(text, due):
    """What is wrong with a file, by the text of OpenCASCADE and what impellerc said of the file."""
    found = []
    complaint = re.search(r".*(ERR|Fails Count|RetFail|Error|Unresolved).*", text)
    if complaint:
        found.append(f"reading: {complaint[0].strip()}")
    shapes = text.split("\nSHAPE ")[1:]
    if len(shapes) != 1:
        return found + [f"{len(shapes)} shapes"]
    shape = shapes[0]

    def count(of, text):
        number = re.search(rf"^ {of} +: (\d+)", text, re.M)
        return int(number[1]) if number else -1

    for of, expected in [("SOLID", 1), ("SHELL", 1), ("FACE", due["faces"]), ("EDGE", due["edges"])]:
        if count(of, shape) != expected:
            found.append(f"{of}: {count(of, shape)} instead of {expected}")
    kinds = Counter(re.findall(r"^KIND (\w+)", shape, re.M))
    if kinds != due["kinds"]:
        found.append(f"kinds of faces: {dict(kinds)} instead of {dict(due['kinds'])}")
    if "This shape seems to be valid" not in shape:
        found.append("not valid")
    tolerances = [float(x) for x in re.findall(r"(?:Face|Edge|Vertex) +: Min +\S+ +Max +(\S+)", shape)]
    if len(tolerances) != 3 or max(tolerances) > TOLERANCE:
        found.append(f"tolerances {tolerances}")
    free = [count("EDGE", part) for part in shape.split("\nFREE\n")[1:]]
    if free != [0, 0]:
        found.append(f"free edges {free}")
    mass = re.search(r"Mass : +(\S+)", shape)
    volume = float(mass[1]) if mass else 0.0
    if not abs(volume / due["volume"] - 1.0) <= VOLUME:
        found.append(f"volume {volume} instead of {due['volume']}")
    due["measured"] = f"volume {volume:.6f} ({volume / due['volume'] - 1.0:+.1e}), tolerances {tolerances}"
    return found


def stated(path):
    text = path.with_suffix(".txt").read_text()
    faces, edges = re.search(r"(\d+) faces, (\d+) edges", text).groups()
    splines, planes, cylinders = re.search(r"(\d+) splines, (\d+) planes, (\d+) cylinders", text).groups()
    kinds = {"BSplineSurface": int(splines), "Plane": int(planes), "CylindricalSurface": int(cylinders)}
    volume = re.search(r"volume of the design surfaces ([\d.]+) mm3", text)[1]
    return {"faces": int(faces), "edges": int(edges), "volume": float(volume), "kinds": Counter(kinds)}


def entity(text, kind, number=0):
    """Number and text of an entity of a kind."""
    return list(re.finditer(rf"^#(\d+)=({kind}\(.*?\));\n", text, re.M | re.S))[number]


def moved_point(text, row, column, by):
    """The file with a control point of the first spline surface moved."""
    surface = entity(text, "B_SPLINE_SURFACE_WITH_KNOTS")[2]
    rows = re.findall(r"\((#[^()]*)\)", surface)
    point = rows[row].replace("\n", "").split(",")[column]
    old = re.search(rf"^{point}=CARTESIAN_POINT\('',\((.*?),(.*?),(.*?)\)\);", text, re.M)
    new = old[0].replace(f"({old[1]},", f"({float(old[1]) + by:.10f},")
    return text.replace(old[0], new)


def without_face(text):
    """The file with a face less in its shell."""
    shell = entity(text, "CLOSED_SHELL")[0]
    return text.replace(shell, re.sub(r"\(#\d+,", "(", shell, count=1))


def folded(text):
    """The file with the inner rows of the first spline surface mirrored through the middle of the part."""
    surface = entity(text, "B_SPLINE_SURFACE_WITH_KNOTS")[2]
    rows = re.findall(r"\((#[^()]*)\)", surface)
    inner = [point for row in rows[len(rows) // 3 : 2 * len(rows) // 3] for point in row.replace("\n", "").split(",")[1:-1]]
    for point in inner:
        old = re.search(rf"^{point}=CARTESIAN_POINT\('',\((.*?),(.*?),(.*?)\)\);", text, re.M)
        x, y, z = (float(c) for c in old.groups())
        text = text.replace(old[0], f"{point}=CARTESIAN_POINT('',({-x:.9f},{-y:.9f},{z:.9f}));")
    return text


def knots_of(text):
    """The file with a wrong multiplicity of the first knot of a surface."""
    surface = entity(text, "B_SPLINE_SURFACE_WITH_KNOTS")[0]
    return text.replace(surface, re.sub(r"\.F\.,\.F\.,\.F\.,\(4,", ".F.,.F.,.F.,(3,", surface))


def unknown(text):
    """The file with a surface of a kind that there is not."""
    surface = entity(text, "B_SPLINE_SURFACE_WITH_KNOTS")[0]
    return text.replace(surface, surface.replace("B_SPLINE_SURFACE_WITH_KNOTS", "B_SPLINE_SURFACE_WITH_KNOT"))


def dangling(text):
    """The file without an entity that another names."""
    return text.replace(entity(text, "EDGE_CURVE")[0], "")


def unbalanced(text):
    """The file with a parenthesis less."""
    edge = entity(text, "EDGE_CURVE")[0]
    return text.replace(edge, edge.replace(");", ";"))


BROKEN = {
    "border point off by 1e-4 mm": lambda t: moved_point(t, 0, 2, 1e-4),
    "border point off by 0.005 mm": lambda t: moved_point(t, 0, 2, 5e-3),
    "border point off by 0.5 mm": lambda t: moved_point(t, 0, 2, 0.5),
    "inner point off by 0.5 mm": lambda t: moved_point(t, 3, 3, 0.5),
    "face folded through the part": folded,
    "face missing": without_face,
    "unknown entity": unknown,
    "wrong multiplicity": knots_of,
    "entity missing": dangling,
    "parenthesis missing": unbalanced,
    "end missing": lambda t: t[: len(t) // 2],
}


def main():
    libraries, *paths = sys.argv[1:]
    failed = False
    for path in map(Path, paths):
        due = stated(path)
        found = judged(libraries, path, due)
        print(f"{path.name}: {due.get('measured')}: {'; '.join(found) or 'passes'}")
        failed |= bool(found)
    # One file stands for all: each of its broken forms must fail.
    path = min(map(Path, paths), key=lambda p: p.stat().st_size)
    text, due = path.read_text(), stated(path)
    for name, broken in BROKEN.items():
        with tempfile.NamedTemporaryFile("w", suffix=".step") as file:
            changed = broken(text)
            assert changed != text, name
            file.write(changed)
            file.flush()
            found = judged(libraries, file.name, due)
        print(f"broken, {name}: {'; '.join(found) or 'NOT CAUGHT'}")
        failed |= not found
    sys.exit(failed)


if __name__ == "__main__":
    main()
