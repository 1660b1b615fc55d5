//! Codes IMP05xx: tool orientation.

crate::codes! {
    COLLISION = "IMP0501", "shank, holder or cutter side too near to the part",
        "For a pass of this operation no tool axis was found that keeps the shank and the holder away from vanes and \
hub by the clearance of the job (`require clearance`). At the machine this bends the tool or breaks the spindle.\n\n\
Way out: a longer reach, a slimmer holder, a thinner shank, or a smaller clearance.";
}
