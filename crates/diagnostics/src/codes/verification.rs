//! Codes IMP07xx: verification.

crate::codes! {
    MALFORMED_MOTION = "IMP0701", "the motion is malformed",
        "First the verifier checks the form of the planned motion: all operations in order, finite numbers, a feed in \
every move that needs one. This error is a fault of the compiler.\n\nRemedy: report the job file. Nothing was \
written.";
    GOUGE = "IMP0702", "a cutter goes deeper than the job allows",
        "At some time of the program a cutter gouges the design by more than `require gouge` allows. The figure \
compares the swept tool with the design surface, not one tool position with one ruling.\n\nExample: one flank pass on \
a vane with a twist of 33 deg gouges by 126 um.\n\nRemedy: use more strips for flank milling, a thinner tool, a finer \
chord tolerance, or a wider contract.";
    EXCESS = "IMP0703", "excess is larger than the job allows",
        "After the whole program more material than `require excess` allows stands on some place of a milled \
surface. Where the operations are limited to sectors, these are judged.\n\nRemedy: use a smaller scallop height, more strips, a tool \
that reaches the place, or `sectors` that \
include all vanes.";
    CLEARANCE = "IMP0704", "shank or holder too near to the part",
        "At some time of the program the shank or the holder is nearer to the finished part than `require clearance` \
allows. At the machine this bends the tool or breaks the spindle.\n\nRemedy: use a longer reach, a slimmer holder, or \
a thinner shank.";
    RAPID_IN_STOCK = "IMP0705", "a rapid move touches the stock",
        "At rapid the whole tool must stay outside the turned blank, even where stock was already milled off. Here \
the tool enters it.\n\nRemedy: use a longer lead-in or lead-out, so that passes begin and end outside the blank.";
    AXIS_TRAVEL = "IMP0706", "an axis leaves its travel",
        "In a move, or at one of its ends, an axis is outside the travel that the machine file gives.\n\nRemedy: use \
a machine with more travel, or another position of the part on the table.";
    AXIS_SPEED = "IMP0707", "an axis would exceed its speed",
        "With the feed and time of a move an axis would exceed its largest speed. The control would slow down by \
itself, or stop with a following error.\n\nRemedy: use a lower feed. If the compiler has chosen the feed, report the \
job.";
    REST = "IMP0708", "roughing leaves too much for finishing",
        "After the last roughing operation more material than `require rest` allows stands on a surface that \
finishing will meet, or inside a channel.\n\nRemedy: use a smaller step down or step over (`depth`, `residual`), \
smaller allowances, or one more roughing operation with a tool that reaches the place.";
    NOT_REACHED = "IMP0709", "part of a surface is not reached",
        "A remark. No cutter reaches some samples of a milled surface. Without `require excess` this is not an \
error.\n\nRemedy: use operations for all faces and sectors, or a tool that reaches the place.";
    NOT_MEASURED = "IMP0710", "a contract that cannot be judged",
        "A contract requires a figure that this run does not have, such as the rest of roughing in a job without \
roughing, or a figure of the stock simulation when the simulation did not run. A contract that was not checked counts \
as broken.\n\nRemedy: require a figure that exists, or remove the contract.";
    NEEDLESS_ALLOW = "IMP0711", "an allow that has no effect",
        "A remark. All contracts hold without this `allow` too. If the `allow` remains in the job, it hides the next \
real fault at its place.\n\nExample: `allow excess on fillet \"blended by hand\"` when the fillets are within the \
contract.\n\nRemedy: remove the item.";
    TIME = "IMP0712", "the program takes longer than the job allows",
        "The time of all moves, within the limits of feeds and axes, is longer than `require time` allows. The \
message names the operation that takes the most time.\n\nRemedy: use a larger step down and step over, higher feeds, \
or a larger tool.";
    AXIS_SHARE = "IMP0713", "an axis is faster than the job allows",
        "An axis is faster than `require axis-speed` allows, as a share of its limit in the machine file. Near the \
pole of the machine, where the tool axis is nearly parallel to the rotary axis next to the part, a small tilt of the \
tool needs a large turn of this axis.\n\nRemedy: use a lower `feed` or `link-feed`, or tool axes farther from the pole.";
    AIR = "IMP0714", "too much air cut",
        "The share of the time at feed in which no material is removed is larger than `require air` \
allows.\n\nRemedy: use shorter leads, a higher `link-feed`, or passes that begin at the stock.";
    REMOVAL_RATE = "IMP0715", "removal rate is higher than the job allows",
        "In some move the removal rate is higher than `require removal-rate` allows. A high removal rate bends slim \
tools and stalls weak spindles.\n\nRemedy: use a lower `feed`, or smaller steps (`depth`, `residual`).";
    REST_VOLUME = "IMP0716", "rest volume is larger than the job allows",
        "The rest volume is the volume of the simulated stock after the last operation less the volume of the part. \
It is larger than `require rest-volume` allows. The volume of the part is that of a closed mesh of its surfaces. A \
gouge reduces the rest volume, so require `gouge` too. The cells of the simulation limit the accuracy of small \
volumes.\n\nRemedy: use operations for all faces and sectors, smaller steps, or a tool that reaches the material.";
    ENGAGEMENT = "IMP0719", "engagement is larger than the job allows",
        "The engagement is the largest arc of the circle of the cutter that is in the simulated stock. In some move it is larger than `require engagement` allows. A slot has 180 deg. A cut of width b with a cutter of radius R has the angle whose cosine is 1 - b / R.\n\nThe contract judges an upper bound, which includes material between the rays of the stock: cells of a twentieth of the radius of the cutter add some 6 deg. With `outside of slots` it does not judge cuts with material on both sides of the cutter at full width, nor one diameter of tip motion before and behind them.\n\nRemedy: use a smaller `stepover`; a smaller `--stock-cell` or more `--memory` where the figure of the rays is small enough; or `require engagement <= 60 deg outside of slots`.";
    CONTOUR_ERROR = "IMP0717", "the control deviates from the verified motion by more than the job allows",
        "The verified motion moves the tip along straight lines and turns both rotary axes in proportion to its path. \
A real control rounds the corners between blocks within its tolerance, and its drives move straight between two cycles. The \
sum of both deviations in one block, at points of the tool from the tip to the end of the flutes, is larger than \
`require contour-error` allows. Add this deviation to the gouge and excess of the certificate. Rapids are not \
included.\n\nExample: roughing with `tolerance rough 50 um` under `require contour-error <= 5 um`.\n\nRemedy: use a \
smaller `tolerance chord` (or `rough`), a lower `feed` if the cycle causes the deviation, or a wider contract.";
    ORIENTATION_ERROR = "IMP0718", "the control tilts the tool by more than the job allows",
        "Where the control rounds the corner between two blocks, the rotary axes deviate from their programmed path \
too, and the tool axis tilts by more than `require orientation-error` allows. The angle includes the turns of both \
rotary axes.\n\nExample: a fast turn of the second rotary axis, the one next to the part, near the pole between two \
blocks that do not turn.\n\nRemedy: use a smaller \
`tolerance chord` (or `rough`), a lower `feed`, or a wider contract.";
    RAPID_THROUGH_STOCK = "IMP0730", "a rapid move runs through remaining stock",
        "The simulation removes stock block by block. In this block the cutter moves at rapid through stock that no \
earlier block has removed. At the machine the tool breaks. IMP0705 is stricter: rapids must stay outside the turned \
blank.\n\nExample: a rapid to the start of a pass whose layer above was not milled.\n\nRemedy: use a longer lead-in \
or lead-out, a link at feed, or an earlier operation that removes this stock.";
    ABOVE_FLUTES = "IMP0731", "the shank above the flutes meets stock",
        "Before this block cuts, stock stands where the shank just above the flutes will be. The shank does not cut. \
It rubs, gets hot and bends the tool.\n\nExample: a slot 8 mm deep, flutes of 5 mm, and a shank as thick as the \
cutter.\n\nRemedy: use longer flutes, a shank thinner than the cutter, a smaller `depth`, or an earlier operation \
that removes this stock.";
    BODY_IN_STOCK = "IMP0732", "shank or holder runs into remaining stock",
        "Before this block cuts, stock stands where the shank or the holder will be. `require clearance` considers \
only the finished part; this check considers the stock that earlier blocks have left.\n\nRemedy: use a longer reach, \
a slimmer holder, or an earlier operation that removes this stock.";
    STOCK_CELL = "IMP0733", "the stock cannot be simulated with these cells",
        "The simulation sends rays through the stock, one for each cell of three grids. The cell size must be larger \
than zero. It must not be so small that the rays need too much memory. It must not be larger than the default (1 mm, \
more for parts over 200 mm), because larger cells would hide a collision of the shank.\n\nExample: `--stock-cell \
0.001` or `--stock-cell 30` on a part of 120 mm.\n\nRemedy: use a `--stock-cell` between both limits; the help line \
names the limit.";
    LINK_CUTS = "IMP0735", "a link removes material",
        "A move above the process feed of its operation is a link. A link should run through air. Links that remove \
more than 1 mm3 over 100 mm of their way count, however many blocks divide it and whatever stands between them: their \
feed was not chosen for cutting. It is an error if a link has a higher removal \
rate than all cuts of the operation, over four cells of its way, or if the feed per tooth is larger than `max-chip` of \
the tool: at the machine the tool breaks. Otherwise it is a remark.\n\nExample: `F1000` in a block of a slot that is cut with 150 \
mm/min.\n\nRemedy: use the process feed in this block, or leads that begin and end outside the stock.";
    NOT_A_NUMBER = "IMP0741", "a figure of the certificate is no number",
        "A figure of the certificate is not a finite number. The message names the figure by its path in the JSON \
file. A proof cannot rest on this figure, so nothing is written.\n\nExample: a feed so small that rounding errors \
dominate the motion of the machine.\n\nRemedy: use feeds that the machine can run. If the feeds are usual, report the \
job file.";
    RETRACT_TOO_LOW = "IMP0740", "a tool is too low while the machine positions",
        "Before the first move and after the last move of an operation, the tool is changed, and X, Y and both \
rotary axes move with tool centre point control off. Their start positions are unknown, because the program may begin after an abort \
or after another program. The tip must therefore be higher than stock, table and fixture can reach at any position \
of the rotary axes within their travel. On a machine with a head the lowest point counts that the tool reaches at any \
angle of the head.\n\nExample: a machine whose Z ends 120 mm above its rotation point, an impeller that reaches 104 \
mm when the table tilts, and a tool whose length with its holder is 40 mm.\n\nRemedy: set `[retract] z` of the machine file \
to the upper end of Z, use a shorter tool or holder, or mount the part lower or, on a tilting table, nearer \
to the axis of the tilt.";
    CLAMPING = "IMP0737", "the tool runs into the clamping",
        "Chuck and table stand below the stock. The clamping is a cylinder about Z without a lower end; `clamping { \
below -42 mm diameter 60 mm }` of the stock states it. Without `clamping`, all space below the back face counts. No \
part of a tool may enter the clamping in cuts, links and rapids, at any time.\n\nExample: a long lead-out over the \
outlet with a large tilt angle of the tool, so that the holder goes below the back face.\n\nRemedy: use a shorter \
lead, a longer reach, a smaller tilt angle of the tool, or `clamping` with the true height and diameter.";
    ROUGH_TOLERANCE = "IMP0738", "roughing can reach the finished part",
        "In roughing the control may deviate from the programmed path by `tolerance rough`. If the cutter passes the \
finished part at a smaller distance, the smoothed path can cut into the part. The check covers faces, fillets, hub \
and kept surfaces.\n\nExample: `allowance vane 40 um` under `tolerance rough 50 um`.\n\nRemedy: use allowances larger \
than the sum of the tolerance and the chord error of the path, or a smaller tolerance.";
    TOOL_LOAD = "IMP0739", "feed and spindle load the tool beyond its size",
        "The feed per tooth follows from feed, spindle speed and number of teeth. The simulated stock shows how much \
of the cutter is engaged. These cases are reported: a motion down along the axis with material in the middle of the \
end, which has no teeth (`plunge-width`), a way down with material under this middle that is steeper than `ramp` \
of the tool, a cut deeper than `max-depth` of the tool, a feed per tooth above \
`max-chip` of the tool (also over the tip, where a tool that turns is faster), a removal rate above `max-rate` of the tool, more power than the spindle of the machine has, and \
a finishing operation that cuts a slot of full width deeper than a quarter of the diameter. All but \
three are errors. A way down that is steeper than the default of `ramp`, which no one stated, is a remark. So is a cut that loads \
the tool as a slot deeper than its diameter, which only a stated `max-depth` permits. The last is an error \
only if the slot is deeper than the diameter of the tool, whatever its `max-depth` is. Where the tool can take it, the job allows it \
for an operation, with a reason: `allow slot on flank \"tried on this machine\"`. It is then a remark, and the verdict, the \
setup sheet and the certificate list it. \
Without `max-chip` and `max-depth`, the limits are shares of the diameter that fall with the stick-out, and with the \
`material` of the stock.\n\nExample: `flank` directly after `groove`, without an \
`expand` between them.\n\nWith cells of the stock that are coarse for the cutter (`--stock-cell`) material that is gone can \
still count as engaged. The message then says so, and which size shows the engagement.\n\nRemedy: use a lower `feed`, a higher `speed`, a smaller `depth`, or roughing that leaves less stock. If the maker of \
the tool permits more, state it: `max-depth 8 mm`.";
    PART_CUT = "IMP0746", "stock is missing inside the finished part",
        "In the simulated stock material is missing inside the hub disc, deeper than 0.1 mm below its surface (0.5 mm \
where the job allows gouge). This check is independent of the proofs of the surfaces. It is coarser, because it sees \
only the places of its rays.\n\nExample: a hole through the rim.\n\nRemedy: use leads, links and passes that stay \
outside the part.";
    LEFT_LACKS = "IMP0748", "the stock at the start lacks material of the part", include_str!("pages/IMP0748.md");
    VANE_ALLOWANCE = "IMP0749", "roughing leaves less than its allowance on the vanes", include_str!("pages/IMP0749.md");
    OVER_MEMORY = "IMP0747", "the check needs too much memory",
        "`verify` keeps all blocks of a text in memory, divided into pieces of at most 3 mm and 1 deg. After reading \
the text it estimates this memory, before it measures anything. The limit is 2 GB unless `--memory` gives another \
one.\n\nExample: a program of 800 000 blocks, or 100 blocks that each turn the table by 80 turns.\n\nRemedy: put each \
operation into its own text. Use fewer turns of the table if they are not intended. Use `--memory 8GB` if the \
computer has this memory.";
    CARRIED = "IMP0734", "the tool runs into table or fixture",
        "The machine file has a table or a fixture. In this block the cutter, the shank or the holder enters it. The \
check covers cuts, links and rapids at every time. The solids are sampled; the distance between two samples is \
subtracted from the clearance.\n\nExample: a holder of 40 mm diameter that follows the outlet of a hub just above the \
table.\n\nRemedy: use a longer reach, a smaller tilt angle of the tool, or mount the part higher above the table \
(`[part] origin`).";
    KEPT = "IMP0736", "a cutter goes into a kept surface",
        "A kept surface is one that no operation mills, so it remains as the lathe made it: rim, back face, bore and \
nose of the hub disc, the tips of the vanes unless an operation `tip` finishes them, and their turned edges at inlet \
and outlet unless an operation `edge` does. No cutter may go deeper into a kept surface than the strictest contract on gouge allows. The depth is \
found and proved as for design surfaces, in cuts, links and rapids.\n\nExample: a lead-out that turns down over the \
outlet and cuts a groove along the rim.\n\nRemedy: use leads and links that keep clear of the surface, or a thinner \
tool.";
}
