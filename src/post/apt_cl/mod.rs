//! CL data in the words of APT (ISO 3592 and ISO 4343): poses of the tool in the part frame, for a later post-processor.
//!
//! CL data know no machine: neither rotary axes, nor their branch, nor positions in the machine frame. `GOTO` gives tip and
//! axis; what the rotary axes do between two poses is the choice of the post-processor. The proof is one for the machine
//! file of the job, whose axes turn evenly between poses.
//!
//! Each operation stands between two stations at retract height. They are poses as well: behind the tool change `FROM` says
//! where the tool stands. A move in its place would be one that nobody proved, from the last station of the operation
//! before, in another direction of the tool. A post-processor that skips `FROM` finds the same pose in the GOTO at rapid
//! behind it, and does not go from the tool change straight down to the first target. `GOHOME` is not written, since its way
//! is that of the post-processor. `RAPID` stands before each GOTO at rapid, and `FEDRAT` behind it.

mod reader;
mod statements;
