//! Codes IMP05xx: tool orientation.

crate::codes! {
    COLLISION = "IMP0501", "shank, holder or cutter side too near to the part",
        "For a pass of this operation no tool axis was found that keeps the shank and the holder away from vanes and \
hub by the clearance of the job (`require clearance`). At the machine this bends the tool or breaks the spindle.\n\n\
Way out: the help names the reach, the diameter of holder, shank or cutter with which the pass is clear, each by \
itself; or a smaller clearance.";
    NO_AXIS = "IMP0502", "no clear tool axis at a contact",
        "At a contact of this operation no tool axis keeps the side of the cutter, the shank and the holder away from \
vanes and hub by what is asked. Axes were looked for all around the direction of the channel, up to 41 deg from it. The \
message names the distances, the place says where. At the machine such a tool would touch a vane.\n\n\
Way out: the help names the reach, the holder diameter or the cutter diameter with which some axis is clear there, each \
by itself.";
    NOT_SMOOTH = "IMP0503", "no smooth run of the rotary axes is proved clear",
        "Every contact has clear axes, but no smooth run of A and C that stays among them was found, or its clearance \
between two stations could not be proved. The rounds are bounded; the message has what was left after the last one.\n\n\
Way out: a slimmer tool, a longer reach, or `method blend`, which asks for less distance at the side of the cutter.";
}
