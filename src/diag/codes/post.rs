//! Codes IMP08xx: posts.

crate::codes! {
    NAME = "IMP0801", "a name that NC text cannot carry",
        "Program and tool names stand in the NC text. Controls take letters, digits, `-` and `_`, and few of them.\n\n\
Way out: a shorter, plainer name.";
    TOOL_NUMBER = "IMP0802", "a tool number that the control does not take",
        "The dialect calls tools by number, and this number is outside of what its tool table holds.\n\n\
Way out: `number 1` and so on in the tool's declaration.";
    AMBIGUOUS_VECTOR = "IMP0803", "a direction vector that two rotary positions fit",
        "The dialect writes the tool direction as a vector, which two positions of A and C fit. Within a pass the control \
takes the nearer one. When a block turns C by 90 deg or more, or runs through the pole (A = 0), nearer is no longer \
certain, and a wrong choice swings the table by half a turn with the tool in the channel.\n\n\
Way out: a finer chord tolerance, or tool axes that keep away from the pole.";
    STANDSTILL = "IMP0804", "a block at feed that only turns",
        "A block whose tip stands still has no path feed; controls interpret its F word in degrees a minute, or refuse it. \
The compiler plans no such blocks.\n\nWay out: report the job file.";
    NOT_UNDERSTOOD = "IMP0805", "a line of NC text that is not understood",
        "The written text is read back by an independent reader before anything is saved. Here the reader met a line that \
it does not know. Nothing was written.\n\nWay out: report the job file.";
    TEXT_DIFFERS = "IMP0806", "the NC text does not say what the motion means",
        "The written text was read back and compared with the verified motion, move by move, within half a step of each \
word. Here they differ. Nothing was written.\n\nWay out: report the job file.";
    UNKNOWN_POST = "IMP0807", "an unknown post",
        "The job or `--post` names a dialect that is not built.\n\nWay out: one of the posts that the message lists.";
}
