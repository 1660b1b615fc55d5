//! Codes IMP05xx: tool orientation.

crate::codes! {
    COLLISION = "IMP0501", "shank, holder or cutter side too near to the part",
        "In a pass of this operation, no tool axis keeps shank and holder at the required clearance from vanes and \
hub (`require clearance`). At the machine such a pass bends the tool or breaks the spindle.\n\n`rough` plans lines \
only where the whole tool fits. It is refused when shank or holder keep all of its tools from the floor, so that more \
is left than `require rest` allows. The message then compares the tool with the lines that its cutter alone would \
have.\n\nRemedy: the help line \
names a reach, or a diameter of holder, shank or cutter. Each of these changes is sufficient by itself. A smaller \
required clearance helps too.";
    NO_AXIS = "IMP0502", "no clear tool axis at a contact",
        "At a contact of this operation, no tool axis keeps the side of the cutter, the shank and the holder at the \
required clearance from vanes and hub. The search covers all tool axes within 70 deg of the direction of the channel. \
The message gives the distances and the place. At the machine such a tool would touch a vane. An axis that is clear is of no \
use where it is nearly parallel to Z, since the second rotary axis would turn through there, or where it is too far from \
those a few millimetres before. The message says so.\n\nRemedy: the help \
line names a reach, a holder diameter or a cutter diameter. Each of these changes was tried: with it all passes that have no \
axes now have them, and with `method corridor` a smooth motion through them. The change is the smallest of those that were \
tried.";
    NOT_SMOOTH = "IMP0503", "no smooth run of the rotary axes is proved clear",
        "Every contact has collision-free tool axes. But the search found no smooth motion of the rotary axes among them, or \
could not prove the clearance between two stations. The number of rounds of the search is limited; the message gives \
the violation that was left after the last round.\n\nRemedy: the help line names changes of the tool with \
which all these passes have such a motion; they were tried. Or use `method blend`, which requires less distance at the side of \
the cutter.";
}
