//! Codes IMP06xx: kinematics.

crate::codes! {
    OUT_OF_TRAVEL = "IMP0601", "an axis would leave its travel",
        "In a pass an axis would leave its travel, on both branches and with every winding of the rotary axes. The \
compiler never interrupts a pass to unwind an axis, because this leaves a mark on the part.\n\nRemedy: use a machine \
with more travel, or another position of the part on the table (`[part] origin` in the machine file).";
    KIND_NOT_PLANNED = "IMP0602", "programs for this kind of machine are not planned",
        "A machine file may describe any two rotary axes: both in the table, both in the head, or one in each, at \
right angles or nutating. Planning and verification support only tables in which one axis turns about the vertical \
and the other tilts this table about a level axis. With a rotary axis in the head, the linear axes would depend on \
the tool length; with axes at other angles, the poles lie elsewhere.\n\nExample: `kind = \"head-table\"` with \
`[axes.B]` and `[axes.C]`.\n\nRemedy: use a table-table machine with the axes A/C or B/C.";
}
