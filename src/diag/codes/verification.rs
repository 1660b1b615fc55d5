//! Codes IMP07xx: verification.

crate::codes! {
    MALFORMED_MOTION = "IMP0701", "the motion is malformed",
        "Before anything else the verifier looks whether the planned motion is a motion at all: all operations in order, \
finite numbers, feeds where there must be feeds. This error is a fault of the compiler.\n\n\
Way out: report the job file; nothing was written.";
    GOUGE = "IMP0702", "a cutter goes deeper than the job allows",
        "At some time of the program a cutter reaches farther into the design than `require gouge` allows. The figure is \
that of the swept tool against the design surface, not of one position against one ruling.\n\nExample: one flank pass \
on a vane whose normal turns by 33 deg along its rulings gouges by 126 um.\n\n\
Way out: more strips for flank milling, a thinner tool, a finer chord tolerance, or a wider contract.";
    EXCESS = "IMP0703", "more material stays than the job allows",
        "After the whole program more material than `require excess` stays somewhere on a milled surface.\n\n\
Way out: a smaller scallop height, more strips, a tool that reaches the place, or `sectors` that cover all vanes.";
    CLEARANCE = "IMP0704", "shank or holder too near to the part",
        "At some time of the program the shank or the holder comes nearer to the design part than `require clearance` \
allows. At the machine this bends the tool or breaks the spindle.\n\n\
Way out: a longer reach, a slimmer holder, or a thinner shank.";
    RAPID_IN_STOCK = "IMP0705", "a rapid move touches the stock",
        "At rapid the whole tool must stay outside of the turned stock, whatever was milled before. Here it does not.\n\n\
Way out: a longer lead-in or lead-out, so that passes begin and end outside of the stock.";
    AXIS_TRAVEL = "IMP0706", "an axis leaves its travel",
        "Between or at the ends of moves a joint lies outside of the travel that the machine file gives.\n\n\
Way out: a machine with more travel, or another place of the part on the table.";
    AXIS_SPEED = "IMP0707", "an axis would have to be faster than it can",
        "With the feed and time of a move an axis would exceed its speed. The control would slow down on its own, or stop \
with a following error.\n\nWay out: a lower feed; if the feed was chosen by the compiler, report the job.";
    REST = "IMP0708", "roughing leaves too much for finishing",
        "After the last roughing operation more material than `require rest` stands on a surface that finishing will \
meet, or inside a channel.\n\nWay out: a smaller step between layers or lines (`depth`, `residual`), smaller \
allowances, or one more roughing operation with a tool that reaches the place.";
    NOT_REACHED = "IMP0709", "part of a surface is not reached",
        "A remark: samples of a milled surface to which no cutter comes. Without `require excess` this is no error.\n\n\
Way out: operations for all faces and sectors, or a tool that reaches the place.";
    NOT_MEASURED = "IMP0710", "a contract that cannot be judged",
        "A contract asks for a figure that this run does not have: what roughing leaves in a job without roughing, or \
something that only the simulation of the stock tells when it did not run. A contract that nobody checked counts as \
broken.\n\nWay out: ask for a figure that exists, or remove the contract.";
    NEEDLESS_ALLOW = "IMP0711", "an allow that excuses nothing",
        "A remark: every contract would hold without this `allow`. Left in the job it hides the next real fault at that \
place.\n\nExample: `allow excess on fillet \"blended by hand\"` when the fillets are within the contract.\n\n\
Way out: remove the item.";
    TIME = "IMP0712", "the program takes longer than the job allows",
        "The time of all moves, as far as feeds and axes allow, is above `require time`. The message names the operation \
that takes most of it.\n\nWay out: larger steps between layers and lines, higher feeds, or a larger tool.";
    AXIS_SHARE = "IMP0713", "an axis is faster than the job allows",
        "An axis uses more of its speed than `require axis-speed` allows, as a share of the limit in the machine file. Near \
the pole of the machine, where the tool axis is nearly along C, a small turn of the tool is a large turn of C.\n\n\
Way out: a lower `feed` or `link-feed`, or tool axes that keep away from the pole.";
    AIR = "IMP0714", "too much of the time cuts air",
        "The share of the time at feed in which no material is removed is above `require air`.\n\n\
Way out: shorter leads, a higher `link-feed`, or passes that begin where stock stands.";
    REMOVAL_RATE = "IMP0715", "a cutter removes more than the job allows",
        "In some move the volume removed a minute is above `require removal-rate`. It bends slim tools and stalls weak \
spindles.\n\nWay out: a lower `feed`, or smaller steps (`depth`, `residual`).";
    REST_VOLUME = "IMP0716", "more stock stays than the job allows",
        "The volume that stands outside of the part after the operations is above `require rest-volume`. It is the \
stock of the simulation less the part, whose volume is that of a closed mesh of its surfaces; what a gouge takes away \
counts against it, so ask for `gouge` too. Cells of the simulation bound how well small volumes are known.\n\n\
Way out: operations for all faces and sectors, smaller steps, or a tool that reaches what stays.";
    CONTOUR_ERROR = "IMP0717", "the control leaves the verified motion by more than the job allows",
        "What was verified is a tip on straight lines with A and C even in its way. A real control rounds the corners \
between blocks as far as the tolerance allows it, and its drives run straight between two of its cycles. The sum of both \
at one block, for points of the tool from the tip to the end of the flutes, is above `require contour-error`. It comes on \
top of the gouge and excess that the certificate states. Rapids are left out.\n\n\
Example: roughing with `tolerance rough 50 um` under `require contour-error <= 5 um`.\n\n\
Way out: a smaller `tolerance chord` (or `rough`), a lower `feed` where the cycle decides, or a wider contract.";
    ORIENTATION_ERROR = "IMP0718", "the control tilts the tool by more than the job allows",
        "Where the control rounds the corner between two blocks, the rotary axes leave their programmed way as well, and \
the tool axis leans by more than `require orientation-error`. The angle counts the turns of A and C together.\n\n\
Example: a fast turn of C near the pole between two blocks that do not turn.\n\n\
Way out: a smaller `tolerance chord` (or `rough`), a lower `feed`, or a wider contract.";
    RAPID_THROUGH_STOCK = "IMP0730", "a rapid move runs through stock that is still there",
        "Block by block the program removes stock; at this block the cutter moves at rapid through a place that nothing \
has cleared. At the machine the tool breaks. IMP0705 asks for more: that rapids stay outside of the turned blank.\n\n\
Example: a rapid to the start of a pass whose layer above was not milled.\n\n\
Way out: a longer lead-in or lead-out, a link at feed, or an operation before that clears the way.";
    ABOVE_FLUTES = "IMP0731", "stock above the flutes meets the shank",
        "Before this block cuts, stock stands where the shank right above the flutes will be. The shank does not cut: it \
rubs, heats and bends the tool.\n\nExample: a slot 8 mm deep with flutes of 5 mm and a shank as thick as the cutter.\n\n\
Way out: longer flutes, a shank thinner than the cutter, a smaller `depth`, or an operation before that opens the way.";
    BODY_IN_STOCK = "IMP0732", "shank or holder runs into stock that is still there",
        "Before this block cuts, stock stands where the shank or the holder will be. `require clearance` looks at the \
finished part only; this looks at what the operations so far have left.\n\n\
Way out: a longer reach, a slimmer holder, or an operation before that opens the way.";
    STOCK_CELL = "IMP0733", "the stock cannot be simulated with these cells",
        "The simulation of the stock sends rays through it, one for each cell of its three faces. Cells must be above \
zero, and not so fine that the rays outgrow memory. Nor may they be larger than the usual ones (1 mm, more for parts over \
200 mm): between larger cells a collision of the shank would not be seen.\n\nExample: `--stock-cell 0.001` or \
`--stock-cell 30` on a part of 120 mm.\n\nWay out: a `--stock-cell` between both; the help line names the bound.";
    LINK_CUTS = "IMP0735", "a link cuts",
        "A move at more than the process feed of its operation is a link: it is there to go through air. Here one removes \
more than a cell of stock, for which its feed was never chosen. It is an error where the link removes more a minute than any \
cut of the operation, or where each of its teeth takes a chip of more than 3 % of the diameter: at the machine the tool \
breaks. Else it is a remark.\n\n\
Example: `F1000` in a block of a slot that is cut with 150 mm/min.\n\n\
Way out: the process feed in this block, or leads that begin and end outside of the stock.";
    NOT_A_NUMBER = "IMP0741", "a figure of the certificate is no number",
        "A figure of the certificate came out as no finite number; the message names it as the JSON file would. A proof cannot \
rest on it, so that nothing is written.\n\n\
Example: feeds so small that the run of the machine is lost in rounding.\n\n\
Way out: feeds that the machine can run; if they are usual ones, report the job file.";
    RETRACT_TOO_LOW = "IMP0740", "a tool does not stand over everything while the machine positions",
        "Before the first and behind the last move of an operation tools are changed, and X, Y, A and C move with tool centre \
point control off. Where they come from nobody knows: a program may begin after an abort, or after another program. So the \
tip must stand higher than stock, table and fixture can come under any A and C of their travel.\n\n\
Example: a machine whose Z ends 120 mm over its rotation point, a wheel that reaches 104 mm when A turns, and a tool with \
its holder of 40 mm.\n\n\
Way out: `[retract] z` of the machine file as high as Z goes, a shorter tool or holder, or a part that stands lower or nearer \
to the axis of A.";
    CLAMPING = "IMP0737", "the tool runs into the clamping",
        "Chuck and table stand below the stock: a cylinder about Z without a lower end, which `clamping { below -42 mm \
diameter 60 mm }` of the stock states. A job that does not say has everything below the back face. No part of a tool may \
enter it, in cuts, links and rapids, over continuous time.\n\n\
Example: a long lead-out over the outlet with a tool that leans far, so that its holder dips below the back face.\n\n\
Way out: a shorter lead, a longer reach, tool axes that lean less, or `clamping` with the true height and diameter.";
    ROUGH_TOLERANCE = "IMP0738", "roughing can reach the finished part",
        "In roughing the control may leave the programmed path by `tolerance rough` to smooth it. Where the cutter passes the \
finished part within this tolerance, the smoothed path can cut into it. Faces, fillets, hub and kept surfaces count.\n\n\
Example: `allowance vane 40 um` under `tolerance rough 50 um`.\n\n\
Way out: allowances that are larger than the tolerance and the chord error of the path together, or a smaller tolerance.";
    TOOL_LOAD = "IMP0739", "feed and spindle load the tool beyond its size",
        "Feed, spindle speed and number of teeth make a chip; the simulated stock tells how much of the cutter stands in \
material. Told are chips over 3 % of the diameter, and finishing that cuts a slot over its full width deeper than a quarter of the \
diameter. Errors are those that break the tool: chips over a tenth of the diameter, a spindle that stands still, and a full slot \
deeper than the diameter with chips over 3 %.\n\n\
Example: `flank` right after `groove`, without an `expand` between them.\n\n\
Way out: a lower `feed`, a higher `speed`, or roughing that leaves less.";
    PART_CUT = "IMP0746", "stock is gone where the finished part is",
        "In the simulated stock material is missing inside of the hub disc, a tenth of a millimetre and more below its surface. This \
net is apart from the proofs of the surfaces and coarser: it sees what its rays meet.\n\n\
Example: a hole through the rim.\n\n\
Way out: leads, links and passes that stay out of the part.";
    OVER_MEMORY = "IMP0747", "the check needs too much memory",
        "`verify` keeps all blocks of a text in memory, each divided into pieces of at most 3 mm and 1 deg. What that takes is \
estimated when the text was read, before anything is measured. It may take 2 GB where `--memory` says nothing else.\n\n\
Example: a program of 800 000 blocks; or 100 blocks that each turn the table by 80 turns.\n\n\
Way out: each operation in a text of its own; fewer turns of the table, if they are not meant; `--memory 8GB` where the \
machine that checks has it.";
    CARRIED = "IMP0734", "the tool runs into table or fixture",
        "The machine file has a table or a fixture; at this block the cutter, the shank or the holder is inside of it. All \
moves are looked at: cuts, links and rapids, over continuous time. The solids are sampled, and the spacing of the samples \
counts against the tool.\n\nExample: a holder of 40 mm that follows the outlet of a hub right over the table.\n\n\
Way out: a longer reach, tool axes that lean less, or a part that stands higher over the table (`[part] origin`).";
    KEPT = "IMP0736", "a cutter goes into a surface that is kept",
        "What no operation makes is kept as the lathe left it: rim, back face, bore and nose of the hub disc, tips of the \
vanes, and their turned edges at inlet and outlet unless an `edge` operation finishes them. No cutter may go deeper into \
these than the strictest contract on gouge. The depth is found and proved as that of design surfaces, over all moves: cuts, \
links and rapids.\n\nExample: a lead-out that turns down over the outlet and cuts a groove along the rim.\n\n\
Way out: leads and links that stay clear of the surface, or a thinner tool.";
}
