//! Codes IMP04xx: planning of passes.

crate::codes! {
    NO_ROOM = "IMP0401", "the tool has no room in the first layer",
        "A roughing operation begins at the shroud, or where earlier roughing ended. With its allowances, its shank and \
its holder the tool does not fit into the channel even there, so the operation would do nothing.\n\n\
Way out: a thinner tool, a longer reach, a slimmer holder, or smaller allowances.";
    BALL_TOO_BIG = "IMP0402", "the ball is bigger than the fillet",
        "The ball that finishes the root of a vane leaves a fillet of its own radius: one bigger than the declared fillet \
leaves material where the design has none. In `flank` the ball rolls in the fillet, in `channel` and `point` lines go up to \
it, in `fillet` into it. An `edge` has free room before it, so that its ball may be bigger.\n\n\
Example: `fillet 2 mm` with a ball of 6 mm diameter.\n\n\
Way out: a ball of at most twice the fillet radius in diameter, or a bigger fillet.";
    TOO_FINE = "IMP0404", "more passes than can be planned",
        "The step between layers is so small against the part that finding the room of the tool in them would take many \
minutes, or lines lie so close that they do not fill a surface.\n\nExample: `depth 0.01 mm` on a channel 26 mm deep.\n\n\
Way out: a bigger `depth` or `scallop`.";
    TOO_LARGE = "IMP0405", "the part is too large to be checked",
        "Planner and verifier look at samples of the design surfaces at a fixed spacing. On this part there would be more \
of them than memory can hold. Most often a length has the wrong unit.\n\n\
Way out: check the units of the points.";
    NO_FILLET = "IMP0403", "the ball touches vane and hub nowhere",
        "Along some ruling there is no place where a ball of this radius touches the face and the hub together: the \
ruling is too short for the ball, or the face leans over the hub.\n\n\
Way out: a smaller ball, or a smaller fillet.";
    NO_REST = "IMP0406", "rest machining finds nothing to cut",
        "An operation with `rest over` cuts only where the operations before it left more than that thickness. Nowhere on \
its passes did they, so the operation would change the tool and do nothing.\n\nExample: the same channel finishing twice.\n\n\
Way out: take the operation out, or give a smaller thickness. The stock that is left shows in `--stock FOLDER`.";
    REST_TOO_FINE = "IMP0407", "rest stock too fine to simulate",
        "To see a rest of the given thickness under the rounding of the cutter, the stock is simulated in cells whose size \
follows from both: sqrt(2 R t) for a radius R and a thickness t. On a large part with a small cutter these would be more than \
memory can hold.\n\nWay out: a bigger thickness after `rest over`, or no rest machining in this operation.";
    TOO_HOLLOW = "IMP0408", "the cutter is bigger than the hollow of a surface",
        "Where hub or face is hollow, a ball that is rounder than the hollow touches it only where it should. A bigger one \
rests on both sides of the line that it is to cut, and cuts there.\n\nExample: a meridian that turns from axial to \
radial over 2 mm, with a ball of 6 mm diameter.\n\n\
Way out: the help line gives the diameter to stay below; or a surface without the sharp turn.";
    NOT_FLANK_MILLABLE = "IMP0409", "the side of the cutter does not fit the face",
        "`method minimax` finds the axis path whose swept envelope comes nearest to a strip of the face. Even that leaves \
more than the contracts on gouge and excess allow, less the chord tolerance.\n\nExample: one strip with a 10 mm cutter on \
a vane whose normal turns by 33 deg along its rulings, and `require gouge <= 1 um`.\n\n\
Way out: more strips (the error falls with the cube of their height); a smaller cutter (it falls with the radius), of which \
the help line names the largest that would do, found by the same search; wider contracts on this face; or point milling.";
    NO_FILLET_TO_FINISH = "IMP0410", "no fillet to finish",
        "`operation fillet` finishes the fillets between vanes and hub by lines of a ball that is not bigger than they are. \
The part declares none, or its faces and hub have no room for the ball that would roll between them.\n\n\
Example: `operation fillet` on a part with a sharp root.\n\n\
Way out: declare the fillet, `fillet 3 mm`, or take the operation out.";
    OVER_MEMORY = "IMP0420", "the plan needs too much memory", include_str!("pages/IMP0420.md");
    TOOL_TOO_LARGE = "IMP0450", "tool too large for the channel", include_str!("pages/IMP0450.md");
}
