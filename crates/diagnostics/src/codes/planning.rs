//! Codes IMP04xx: planning of passes.

crate::codes! {
    NO_ROOM = "IMP0401", "the tool does not fit into the first layer",
        "A roughing operation begins at the shroud, or at the level where earlier roughing ended. With its \
allowances, its shank and its holder the tool does not fit into the channel even there, so the operation would cut \
nothing.\n\nRemedy: use a thinner tool, a longer reach, a slimmer holder, or smaller allowances.";
    BALL_TOO_BIG = "IMP0402", "the ball is bigger than the fillet",
        "The ball that finishes the root of a vane leaves a fillet of its own radius. If this radius is larger than \
the declared fillet, the ball leaves material that the part must not have. In `flank` the ball rolls along the \
fillet; in `channel` and `point` the lines end at the fillet; in `fillet` the lines lie inside it. The ball of an \
`edge` operation may be larger, because it has free space in front of the edge.\n\nExample: `fillet 2 mm` with a ball \
of 6 mm diameter.\n\nRemedy: use a ball whose diameter is at most twice the fillet radius, or declare a larger \
fillet.";
    TOO_FINE = "IMP0404", "more passes than can be planned",
        "The step down is so small for this part that the compiler would need many minutes to find where the tool \
fits in each layer. Or the lines lie so close together that they cannot cover a surface.\n\nExample: `depth 0.01 mm` \
in a channel 26 mm deep.\n\nRemedy: use a larger `depth` or `scallop`.";
    TOO_LARGE = "IMP0405", "the part is too large to be checked",
        "Planner and verifier use samples of the design surfaces at a fixed spacing. This part would need more \
samples than fit into memory. In most cases a length has the wrong unit.\n\nRemedy: check the units of the points, or allow more \
memory with `--memory`.";
    NO_FILLET = "IMP0403", "the ball touches vane and hub nowhere",
        "At some ruling no ball of this radius touches the face and the hub together. Either the ruling is too short \
for the ball, or the face overhangs the hub.\n\nRemedy: use a smaller ball, or a smaller fillet.";
    NO_REST = "IMP0406", "rest machining finds nothing to cut",
        "An operation with `rest over` cuts only where earlier operations left more stock than this thickness. No \
pass of this operation has such a place. The program changes to its tool and cuts nothing with it: a warning. Without `rest over` \
it is an error.\n\nExample: the same channel finishing twice.\n\nRemedy: remove the operation, or give a smaller thickness. `--stock FOLDER` writes the \
stock after each operation.";
    REST_TOO_FINE = "IMP0407", "rest stock too fine to simulate",
        "The simulation needs small cells to see a rest of the given thickness below a round cutter: sqrt(2 R t) for \
a cutter radius R and a thickness t. On a large part with a small cutter, such cells need more memory than \
allowed.\n\nRemedy: give a larger thickness after `rest over`, or use no rest machining in this operation.";
    TOO_HOLLOW = "IMP0408", "the cutter is larger than the radius of a concave surface",
        "Where the hub or a face is concave, a ball fits only if its radius is smaller than the radius of curvature \
of the surface. A larger ball touches the surface on both sides of its line and gouges there. On faces, fillets and edges the \
compiler measures how deep the cutter would cut in beside each contact; half of the chord tolerance is allowed, so that a \
wave of a fraction of a micrometre does not count.\n\nExample: a meridian \
that turns from axial to radial within 2 mm, and a ball of 6 mm diameter.\n\nRemedy: use a ball smaller than the \
diameter in the help line, or a surface without the sharp turn. Where the waves are those of a fit to sections, state a \
smaller `fit`.";
    NOT_FLANK_MILLABLE = "IMP0409", "the side of the cutter does not fit the face",
        "`method minimax` finds the axis path whose envelope has the least deviation from a strip of the face. Even \
this deviation is larger than the contracts on gouge and excess allow, less the chord tolerance.\n\nExample: one \
strip with a cutter of 10 mm diameter on a vane with a twist of 33 deg, and `require gouge <= 1 um`.\n\nRemedy: use \
more strips (the error falls with the cube of their height), or a smaller cutter (the error falls with the radius); \
the help line names the largest sufficient cutter, found by the same search. Or use wider contracts on this face, or \
point milling.";
    NO_FILLET_TO_FINISH = "IMP0410", "no fillet to finish",
        "`operation fillet` finishes the fillets between vanes and hub, by lines of a ball whose radius is not larger \
than the fillet. This part declares no fillet, or the ball of the fillet radius does not fit between face and \
hub.\n\nExample: `operation fillet` on a part with a sharp root.\n\nRemedy: declare the fillet, `fillet 3 mm`, or \
remove the operation.";
    NO_ROOM_ON_FLOOR = "IMP0411", "a larger tool fits nowhere on the floor",
        "A remark. `channel` with a list of tools finishes the middle of the floor with the larger tools and the rest with \
the last one. Along its outer lines a larger tool keeps `allowance vane` from vanes and fillets, and shank, holder and \
the side of its cutter need a tool axis with the required clearance. A bull nose also needs a lead angle of at most 45 deg \
that keeps its heel out of the hub. Nowhere along the channel is there room for this tool over a length of more than its \
diameter. So the program changes to this tool and cuts nothing with it, and the next tool finishes its part of the \
floor.\n\nExample: a ball of 12 mm diameter between vanes that are 11 mm apart.\n\nRemedy: use a smaller tool, a longer \
reach or a slimmer holder, or leave the tool out of the list.";
    OVER_MEMORY = "IMP0420", "the plan needs too much memory", include_str!("pages/IMP0420.md");
    TOOL_TOO_LARGE = "IMP0450", "tool too large for the channel", include_str!("pages/IMP0450.md");
    NO_TOOL = "IMP0452", "no tool of the library serves",
        "`impellerc new --from`, and `operations auto` in a job, choose tools, methods and operations for a part. For each kind of surface it tries the balls of \
the libraries of the job that fit, the largest first, and takes the first one with which all of the surface has free and smooth \
tool axes. With none of them it has.\n\nExample: fillets of 0.5 mm, and a library whose smallest ball has 1 mm of radius.\n\nRemedy: \
the notes say what was tried and what is in the way. Add a ball of a smaller radius, or one with longer flutes or a slimmer \
holder, to a library of your own (`use tools \"mine\"`), or write the operation by hand.";
    CHOSEN = "IMP0453", "operations were chosen",
        "A remark. The job has `operations auto`, or an operation with `auto` in the place of a value, and the compiler chose what \
it leaves open: tools of the job and its libraries, operations, methods and cutting data. The notes name each operation with \
its tool and the reason.\n\nExample: a job with a part, a machine and `operations auto`.\n\nRemedy: none is needed. `impellerc \
choose job.imp -o chosen.imp` writes the job with what was chosen, to read and to edit; it compiles to the same program.";
    EXCLUDED = "IMP0451", "a requirement that other values of the job exclude", include_str!("pages/IMP0451.md");
}
