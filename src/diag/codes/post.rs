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
    SENSE = "IMP0808", "rotary words of a sense that the post cannot have",
        "The machine file says for each rotary axis whether a positive word turns the tool right-handed relative to the part \
(`iso`) or the other way round (`opposite`). The kinematics xyzac-trt of LinuxCNC 2.9 turn the work right-handed for a \
positive word, which is `opposite`, and no setting changes that. With a machine file that says `iso` the table would turn \
the wrong way: the tool would cut another part, or the table.\n\n\
Way out: a machine file of a machine that LinuxCNC runs (`5mc850-c-linuxcnc`, `linuxcnc-xyzac-trt`), chosen in the job or \
with `--machine`; or the post of the control that the machine has.";
    CONTROL = "IMP0809", "a machine file of another control than the post's",
        "Speeds are planned for one control. A control with look-ahead keeps the speed of every axis; LinuxCNC 2.9 keeps the \
speed of the tip, adds up two blocks where one goes over into the next, and leaves the path there by more than its tolerance \
where rotary axes change their rate. Planning for it writes ways at rapid in inverse time and stops at such corners, \
and the certificate has its times. It does so for machine files that say `planning = \"linuxcnc-2.9\"`, and a text for \
LinuxCNC is made for those alone.\n\nWay out: such a machine file (`5mc850-c-linuxcnc`, `linuxcnc-xyzac-trt`), chosen in the \
job or with `--machine`; or the post of the control that the machine has.";
    NC_FILE = "IMP0820", "NC file that cannot be read",
        "`impellerc verify` takes NC text: plain UTF-8 of at most 256 MB. Anything else is refused before it is looked at, \
so that memory stays bounded.\n\nWay out: give the text that the control would run, split by operations if it is larger.";
    NC_BLOCK = "IMP0821", "a block of NC text that is refused",
        "The text is read strictly, as the control would run it. A word that is not understood is never skipped, since what it \
does at the machine is not known: so are values beyond travel, words given twice, comments that the control executes, and \
signs of another alphabet.\n\n\
At the start nothing is known: units, plane, distance and feed mode, radius compensation, offsets, tool and its length, \
transformation, smoothing, spindle, coolant and the positions of all axes may be left over from another program. A move on \
any of them that the text did not set, or set otherwise, is refused; the message says what to write. With the \
transformation off the tool first goes straight up to the retract height of the machine file; only there X, Y, A and C \
move. At its end a program leaves the transformation, spindle and coolant off and the tool at that height.\n\n\
Example: `G53 G0 Z0` where the machine file says `[retract] z = \"650 mm\"`, `G43 H1` with tool 2 in the spindle, or a move \
between TRAFOOF and TRAORI.\n\n\
Way out: write what the message says, or name the dialect of the text with `--post`.";
    NC_OPERATIONS = "IMP0822", "NC text that does not follow the job",
        "The operations of the text are those between switching the transformation on and off. They must be the \
operations of the job, in its order, each with its tool and spindle speed: otherwise the text would be measured with the \
wrong cutter.\n\nWay out: give the job that the text was made from, or change tools, speeds and order in one of both.";
    NC_FEED = "IMP0823", "a feed above the job's",
        "A block is faster than both the process feed and the link feed of its operation. In material it would break the \
tool.\n\nWay out: lower the feed, or raise `feed` or `link-feed` in the job.";
    NC_POSITIONING = "IMP0824", "an operation that begins unsafely",
        "An operation begins with a rapid to a place outside of the stock, with A and C already where they have to be. \
Otherwise the table turns, or the tool cuts, while it comes down from the tool change, on a way that nobody can check.\n\n\
Way out: A and C before TRAORI or M428 as in the first move; a rapid as first move.";
    NC_SMOOTHING = "IMP0825", "smoothing wider than the job allows",
        "CYCLE832 or G64 lets the control leave the path by more than the chord tolerance of the job; of G64 both count, P for \
corners and Q for moves that are joined before (Q is P unless said). The text would be \
measured as it stands, and the machine would do something else.\n\n\
Way out: a smaller tolerance in the text, or a wider `tolerance chord` in the job.";
    CERTIFICATE_FORM = "IMP0826", "not a certificate",
        "The file given with `--certificate` is no certificate of this compiler, or its form is one that this version does \
not know. Its form is in docs/certificate.md.\n\nWay out: give the JSON file that `--certificate` wrote beside the NC text.";
    CERTIFICATE_OTHER = "IMP0827", "NC text and certificate do not belong together",
        "A certificate holds the hash of the NC text that it was written for. Here text and certificate differ: the text was \
edited, or one of both is from another run; or the head of the text does not name the hashes of inputs, body and \
certificate, so that nobody can tell. What the certificate proves is not proved of this text.\n\n\
Way out: `impellerc verify part.nc --job job.imp` measures the text anew; compiling the job makes both anew.";
    USAGE = "IMP0828", "nothing to verify against",
        "`impellerc verify` measures NC text against a job, or compares it with a certificate; it needs one of both.\n\n\
Way out: `--job job.imp`, `--certificate part.json`, or both.";
    CERTIFICATE_FIGURES = "IMP0829", "a certificate that says other figures than measured",
        "The contracts were measured on the text, and the certificate says something else by more than the digits of the \
words explain: it was edited, or another version of the compiler measured it.\n\n\
Way out: compile the job anew; trust the measurement.";
}
