//! Codes IMP06xx: kinematics.

crate::codes! {
    OUT_OF_TRAVEL = "IMP0601", "an axis would leave its travel",
        "A pass cannot be run without an axis leaving its travel, on either branch of A and with any winding of C. A \
pass is never interrupted to unwind, since that leaves a mark on the part.\n\n\
Way out: a machine with more travel, or another place of the part on the table (`[part] origin` in the machine file).";
}
