//! Codes IMP03xx.

crate::codes! {
    VANE_COUNT = "IMP0301", "impossible number of vanes", include_str!("pages/IMP0301.md");
    VANES_OVERLAP = "IMP0302", "vanes overlap", include_str!("pages/IMP0302.md");
    POINTS = "IMP0303", "points that give no curve", include_str!("pages/IMP0303.md");
    COORDINATE = "IMP0304", "coordinate beyond 10 m", include_str!("pages/IMP0304.md");
    CURVE_CROSSES = "IMP0305", "curve crosses itself", include_str!("pages/IMP0305.md");
    ROOT_AND_TIP = "IMP0306", "root curve not below the tip curve", include_str!("pages/IMP0306.md");
    FACES_CROSS = "IMP0307", "pressure and suction side cross", include_str!("pages/IMP0307.md");
    RULINGS_FOLD = "IMP0308", "rulings of a face fold over", include_str!("pages/IMP0308.md");
    STOCK = "IMP0309", "stock does not hold the part", include_str!("pages/IMP0309.md");
    DIRECTION = "IMP0310", "curve runs from outlet to inlet", include_str!("pages/IMP0310.md");
    AXIS = "IMP0311", "curve too near to the axis of rotation", include_str!("pages/IMP0311.md");
    OFF_HUB = "IMP0312", "face does not end on the hub", include_str!("pages/IMP0312.md");
    FLAT_EDGE = "IMP0313", "flat edge inside of the part is to be finished", include_str!("pages/IMP0313.md");
    STOCK_HIGH = "IMP0314", "blank too high over the shroud", include_str!("pages/IMP0314.md");
    LEFT_OUTSIDE = "IMP0315", "what is left stands out of the turned blank", include_str!("pages/IMP0315.md");
    SECTION = "IMP0316", "section without faces and edges", include_str!("pages/IMP0316.md");
    SECTION_FIT = "IMP0317", "curves miss the points of a section", include_str!("pages/IMP0317.md");
    PRESSURE_SIDE = "IMP0318", "pressure face unknown", include_str!("pages/IMP0318.md");
    SECTIONS_FOUND = "IMP0319", "blade from sections", include_str!("pages/IMP0319.md");
    EXTENSION = "IMP0320", "face ends short of hub or shroud", include_str!("pages/IMP0320.md");
    DISTRIBUTION = "IMP0321", "values do not cover 0 % to 100 %", include_str!("pages/IMP0321.md");
    SPANS = "IMP0322", "spans do not go from hub to shroud", include_str!("pages/IMP0322.md");
    STEEP = "IMP0323", "camber line runs round the axis", include_str!("pages/IMP0323.md");
    THIN = "IMP0324", "thickness of a blade not possible", include_str!("pages/IMP0324.md");
    THICK = "IMP0325", "thickness larger than the camber line allows", include_str!("pages/IMP0325.md");
    EDGE_PLACE = "IMP0326", "edge of a blade outside of its meridian", include_str!("pages/IMP0326.md");
    NO_SHELL = "IMP0327", "part without a closed surface", include_str!("pages/IMP0327.md");
    OUTLIER = "IMP0350", "data point does not fit the others", include_str!("pages/IMP0350.md");
    THROAT = "IMP0351", "throat of the channel", include_str!("pages/IMP0351.md");
    FLANK_FIT = "IMP0353", "how well the side of a cutter fits a face",
        "`impellerc check --fits` tells the least error that flank milling leaves on a face, with one, two and three strips. The error is the \
deviation of the swept cutter from the face, shared evenly between gouge and excess; the hub and the neighbouring \
vane are not considered. A ruled face can have a large error, because the error depends on the twist of the \
face. For a face that an operation mills by points with a ball, the remark compares flank milling with the side of \
the same tool with the scallops.\n\nRemedy: none is needed if the contracts allow the error. Otherwise use more `strips` or a smaller cutter; if \
three strips are not enough, use point milling.";
    CONCAVE = "IMP0354", "smallest concave radius of a face or edge", include_str!("pages/IMP0354.md");
    TIPS_LEFT = "IMP0355", "stock stays on the tips of blades", include_str!("pages/IMP0355.md");
    TWIST = "IMP0352", "twist of a face", include_str!("pages/IMP0352.md");
}
