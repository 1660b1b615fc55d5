//! Codes IMP08xx: posts.

crate::codes! {
    NAME = "IMP0801", "a name that NC text cannot carry",
        "The names of the program and of the tools appear in the NC text. Controls accept only a few letters, digits, \
`-` and `_`.\n\nRemedy: use a shorter name of these characters.";
    TOOL_NUMBER = "IMP0802", "a tool number that the control does not take",
        "The dialect selects tools by number. This number is outside the range of its tool table.\n\nRemedy: write \
`number 1` or another small number in the declaration of the tool.";
    AMBIGUOUS_VECTOR = "IMP0803", "a direction vector that two rotary positions fit",
        "The dialect writes the tool direction as a vector. Two positions of the rotary axes give the same vector. \
Within a pass the control takes the nearer position. When a block turns the rotary axis next to the part by 90 deg or \
more, or runs through the pole, where the tool is parallel to this axis, the nearer position is no longer certain. A \
wrong choice turns this axis by half a turn with the tool in the channel.\n\nRemedy: use a finer chord tolerance, or tool axes farther from the pole.";
    STANDSTILL = "IMP0804", "a block at feed in which only rotary axes move",
        "If the tip stands still in a block, the block has no path feed. Controls interpret its F word as degrees per \
minute, or refuse the block. The compiler plans no such blocks.\n\nRemedy: report the job file.";
    NOT_UNDERSTOOD = "IMP0805", "a line of NC text that is not understood",
        "Before any file is saved, an independent reader reads the NC text back. The reader found a line that it does \
not know. Nothing was written.\n\nRemedy: report the job file.";
    TEXT_DIFFERS = "IMP0806", "the NC text does not agree with the motion",
        "The NC text was read back and compared with the verified motion, move by move, to half of the last digit of \
each word. Here they differ. Nothing was written.\n\nRemedy: report the job file.";
    UNKNOWN_POST = "IMP0807", "an unknown dialect",
        "The post file names a dialect that the compiler does not have.\n\nRemedy: use one of the dialects that the message lists.";
    SENSE = "IMP0808", "sense of a rotary axis that the post does not support",
        "The machine file states for each rotary axis its sense: `iso` if a positive word turns the tool right-handed \
relative to the part, otherwise `opposite`. In the kinematics xyzac-trt and xyzbc-trt of LinuxCNC 2.9 a positive \
word turns the work right-handed. This sense is `opposite`, and no setting changes it. With a machine file that says `iso`, the \
table would turn in the opposite direction, and the tool would cut into the part or the table.\n\nRemedy: choose the \
machine file of a machine that LinuxCNC controls (`5mc850-c-linuxcnc`, `linuxcnc-xyzac-trt`, `linuxcnc-xyzbc-trt`), in the \
job or with `--machine`. Or choose the post of the control that the machine has.";
    CONTROL = "IMP0809", "machine file and post belong to different controls",
        "The compiler plans speeds for one control. A control with look-ahead keeps every axis within its speed. \
LinuxCNC 2.9 limits the speed of the tip; at the joint of two blocks it adds their speeds, and it deviates from the \
path by more than its tolerance where rotary axes change their rate. For LinuxCNC the compiler therefore writes \
rapids in inverse time, stops at such corners, and states these times in the certificate. It does so only for machine \
files with `planning = \"linuxcnc-2.9\"`, and the post for LinuxCNC accepts only such machine files.\n\n\
Under LinuxCNC the kinematics must be those of the machine as well. The post writes for xyzac-trt and xyzbc-trt: the \
rotary axes are A about X or B about Y, which tilts, and C about Z on it.\n\n\
A machine file can say that words of a rotary axis are reduced modulo 360 deg. The posts siemens-840d, heidenhain and fanuc \
write such words, for controls that take the shorter way to them. Others refuse the axis.\n\nRemedy: \
choose such a machine file (`5mc850-c-linuxcnc`, `linuxcnc-xyzac-trt`, `linuxcnc-xyzbc-trt`), in the job or with \
`--machine`. Or choose the post of the control that the machine has.";
    FRAME = "IMP0810", "a frame of a post file that the dialect refuses",
        "A post file holds the frames of a program as templates: head, start and end of an operation, end of the \
program. Before anything is planned, a small trial program is written with the frames. The reader of the dialect reads \
it as strictly as any text, beginning with an unknown state of the control. The trial failed.\n\nExample: a frame \
`operation-start` without `G54` behind TRAORI, which cancels the work offset; a frame `operation-end` that does not \
retract; a head that does not switch off what an aborted program can have left on.\n\nRemedy: compare the frame with \
the shipped file of the same dialect, which `impellerc posts NAME` prints, and write what the message says.";
    LONG_TURN = "IMP0811", "half a turn or more in one block",
        "A control takes the shorter way to a word of an axis modulo 360 deg. On controls of HEIDENHAIN the word M126 makes \
every rotary axis without end do so, and without M126 a setting of the machine decides. A block that turns such an axis by \
half a turn or more would turn it in the other direction.\n\nRemedy: state the travel of the axis in the machine file, if it is limited at the control to one \
turn. Otherwise use the post of another control.";
    SECTORS_INLINE = "IMP0812", "sectors that the text has move by move",
        "The job asks for subprograms: what several sectors repeat is written once and called for each sector with the work \
frame turned to it. The text has no subprogram where the control of the post has no words for it, where rotary axis 2 does \
not turn the part about its axis, where the words have few digits, or where sectors repeat nothing. Rest machining can \
remove other passes in each sector.\n\nThe text is complete without subprograms, only longer. The motion is the same, but \
for feeds: with subprograms the same moves have the same feed in all sectors.\n\nRemedy: write `sectors inline` in the post \
of the job, or leave the property out.";
    NC_FILE = "IMP0820", "NC file that cannot be read",
        "`impellerc verify` reads NC text: plain UTF-8 of at most 256 MB. It refuses all other files before reading \
them, so that memory stays bounded.\n\nRemedy: give the text that the control would run. Divide a larger text by \
operations.";
    NC_BLOCK = "IMP0821", "a block of NC text that is refused",
        "The reader interprets the text strictly, as the control would run it. It never skips a word that it does not \
understand, because nobody knows what the word does at the machine. It also refuses positions beyond the travel, \
words given twice, comments that the control executes, and letters of other alphabets.\n\nAt the start of a program \
nothing is known. Units, plane, distance and feed mode, radius compensation, offsets, tool and tool length, \
transformation, smoothing, spindle, coolant and the positions of all axes may remain from another program. The reader \
refuses a move that depends on one of them unless the text has set it as required; the message says what to write. \
With the transformation off, the tool first moves straight up to the retract height of the machine file. X, Y and both \
rotary axes may move only at this height. At its end, a program switches off the transformation, the spindle and the coolant, \
with the tool at this height.\n\nExample: `G53 G0 Z0` where the machine file says `[retract] z = \"650 mm\"`, `G43 \
H1` with tool 2 in the spindle, or a move between TRAFOOF and TRAORI.\n\nRemedy: write what the message says, or name \
the dialect of the text with `--post`.";
    NC_OPERATIONS = "IMP0822", "NC text that does not follow the job",
        "An operation of the text lies between switching the transformation on and off. The operations must be those \
of the job, in the same order, with the same tools and spindle speeds. Otherwise the text would be measured with the \
wrong cutter.\n\nRemedy: give the job from which the text was made, or change tools, speeds and order in the job or \
in the text.";
    NC_FEED = "IMP0823", "a feed above the job's",
        "A block is faster than the process feed and the link feed of its operation. In material this feed would \
break the tool.\n\nRemedy: reduce the feed in the text, or increase `feed` or `link-feed` in the job.";
    NC_POSITIONING = "IMP0824", "an operation that begins unsafely",
        "An operation must begin with a rapid to a place outside the stock, with both rotary axes already in \
position. Otherwise a rotary axis turns, or the tool cuts, while the tool approaches from the tool change, and this motion cannot \
be verified.\n\nRemedy: turn the rotary axes to their positions of the first move before the program moves the tool \
there, as the texts of the compiler do, and make the first move a rapid.";
    NC_SMOOTHING = "IMP0825", "smoothing wider than the job allows",
        "CYCLE832 or G64 allows the control to deviate from the path by more than the chord tolerance of the job. In \
G64 both words count: P for corners, and Q for moves that the control joins first (without Q, the value of P). The \
verifier measures the path of the text, but the machine would follow another path.\n\nRemedy: use a smaller tolerance \
in the text, or a larger `tolerance chord` in the job.";
    CERTIFICATE_FORM = "IMP0826", "not a certificate",
        "The file given with `--certificate` is not a certificate of this compiler, or this version does not know its \
form. `docs/certificate.md` describes the form.\n\nRemedy: give the JSON file that `--certificate` wrote beside the \
NC text.";
    CERTIFICATE_OTHER = "IMP0827", "NC text and certificate do not belong together",
        "A certificate contains the hash of its NC text. Here text and certificate differ: the text was edited, or \
one of the two comes from another run. Or the head of the text lacks the hashes of inputs, body and certificate, so \
that they cannot be compared. The proof of the certificate does not apply to this text.\n\nRemedy: measure the text \
again with `impellerc verify part.nc --job job.imp`, or compile the job again to write both files.";
    USAGE = "IMP0828", "nothing to verify against",
        "`impellerc verify` measures NC text against a job, or compares the text with a certificate. It needs at \
least one of the two. `impellerc diff` needs the job of both texts: lengths of tools and axes of the machine are in it.\n\n\
Remedy: add `--job job.imp`; `verify` takes `--certificate part.json` as well, or both.";
    CERTIFICATE_FIGURES = "IMP0829", "figures of the certificate differ from the measured ones",
        "The contracts were measured on the text. The certificate has other figures, and the digits of the NC words \
do not explain the difference. The certificate was edited, or another version of the compiler measured it.\n\nRemedy: \
rely on the measurement, and compile the job again.";
    HEAD_DIFFERS = "IMP0832", "the head of an NC text states what the job does not have",
        "The comments at the head of a text state tools with their lengths, the zero, what the proof assumes, and figures. \
The machinist sets up the machine by them. `impellerc verify` compares each line with the job, the machine file, the library \
and the measured figures. A tool or a zero that differs is an error. A figure that differs is an error in a text that nobody \
changed; where text or job were changed after the head was written, it is a warning.\n\nExample: the head says `length 95 mm \
from the tip to the gauge line`, and the tool of the job is 105 mm long.\n\nRemedy: compile the job again, so that text and \
head are written together.";
    SOURCE_MAP = "IMP0831", "a file that is no source map",
        "`impellerc job.imp -o part.nc --source-map part.map.json` writes the source map of an NC text. `impellerc verify` \
takes it to say for which pass and line of the job a block was written. The given file is no source map of this \
compiler.\n\nRemedy: give the file that was written together with the NC text, or leave the option out.";
    DIFFERS = "IMP0830", "two texts differ for the machine",
        "`impellerc diff` has read both NC texts as motions of the operations of one job. In this operation tip, tool \
axis, speed or time differ by more than the digits of NC words. Comments, block numbers, modal words and the division of \
a way into blocks do not count.\n\nRemedy: nothing, if the difference is meant; otherwise compare the jobs, the machine \
files and the versions of the compiler that wrote the texts.";
}
