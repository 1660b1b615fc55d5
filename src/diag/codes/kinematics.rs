//! Codes IMP06xx: kinematics.

crate::codes! {
    OUT_OF_TRAVEL = "IMP0601", "an axis would leave its travel",
        "A pass cannot be run without an axis leaving its travel, on either branch and with any winding of the rotary axes. A \
pass is never interrupted to unwind, since that leaves a mark on the part.\n\n\
Way out: a machine with more travel, or another place of the part on the table (`[part] origin` in the machine file).";
    KIND_NOT_PLANNED = "IMP0602", "programs for this kind of machine are not planned",
        "A machine file may describe any two rotary axes: both in the table, both in the head, or one in each, at a right angle or \
nutating. Planning and verification are built for tables of which one turns about the vertical and the other tilts it about a \
level axis. With a head, the linear axes move with the length of the tool; at other angles the poles lie elsewhere.\n\n\
Example: `kind = \"head-table\"` with `[axes.B]` and `[axes.C]`.\n\n\
Way out: a machine of the kind A/C or B/C table-table.";
}
