//! Codes IMP06xx: kinematics.

crate::codes! {
    OUT_OF_TRAVEL = "IMP0601", "an axis would leave its travel",
        "In a pass an axis would leave its travel, on both branches and with every winding of the rotary axes. Nor does \
it help to leave the part within the pass in order to turn.\n\nRemedy: use a machine with more travel, or another \
position of the part (`[part] origin` in the machine file).";
    NO_REACH = "IMP0602", "the rotary axes cannot direct the tool",
        "Within their travel, the rotary axes of the machine do not give the tool the direction along the axis of the \
part, or none around it. No operation can be planned from there.\n\nExample: a head with an axis A from 10 to 50 deg \
and an axis B.\n\nRemedy: correct `travel`, `direction`, `order` and `sense` of both axes in the machine file, or use \
another machine.";
    TURNS_IN_PASS = "IMP0603", "the tool leaves the part within a pass to turn a rotary axis",
        "The travel of a rotary axis ends within the pass, on every branch and winding. The tool leaves along its own axis \
to the clearance surface, the rotary axes turn there, and the tool comes back along its axis to the same place. The \
verifier checks these moves as all others. On a finished surface the tool may leave a mark at that place.\n\nExample: \
a table C from -100 to 100 deg, and a pass from 80 to 120 deg.\n\nRemedy: use a machine with more travel of this \
axis, or sectors whose passes do not reach the end of the travel.";
}
