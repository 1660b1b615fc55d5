//! Words of other systems for words of the language. Those of a property stand in its row.

use super::{Topic, topics};

/// A word of other systems, and the words that are no property of a block and that it may mean; the first one that fits a place is
/// suggested.
const OTHER_NAMES: &[(&str, &[&str])] = &[
    ("blade", &["vane"]),
    ("main-blade", &["vane"]),
    ("swarf", &["flank"]),
    ("flank-milling", &["flank"]),
    ("swarfing", &["flank"]),
    ("floor", &["channel"]),
    ("hub", &["channel"]),
    ("hub-finish", &["channel"]),
    ("finish", &["flank", "point"]),
    ("finishing", &["flank", "point"]),
    ("roughing", &["rough"]),
    ("pocket", &["rough"]),
    ("pocketing", &["rough"]),
    ("adaptive", &["rough"]),
    ("plunging", &["plunge"]),
    ("slot", &["groove"]),
    ("tolerance", &["gouge"]),
    ("accuracy", &["gouge"]),
    ("deviation", &["gouge"]),
    ("profile", &["gouge"]),
    ("ra", &["excess"]),
    ("rz", &["excess"]),
    ("roughness", &["excess"]),
    ("cusps", &["excess"]),
    ("runtime", &["time"]),
    ("duration", &["time"]),
    ("amax", &["acceleration"]),
    ("accel", &["acceleration"]),
    ("range", &["travel"]),
    ("limits", &["travel"]),
    ("limit", &["travel"]),
    ("min", &["travel"]),
    ("max", &["travel"]),
    ("digits", &["decimals"]),
    ("precision", &["decimals"]),
    ("ballnose", &["ball"]),
    ("ball-nose", &["ball"]),
    ("ball-end", &["ball"]),
    ("ballmill", &["ball"]),
    ("sphere", &["ball"]),
    ("endmill", &["flat"]),
    ("end-mill", &["flat"]),
    ("cylindrical", &["flat"]),
    ("bullnose", &["bull"]),
    ("bull-nose", &["bull"]),
    ("toroid", &["bull"]),
    ("toroidal", &["bull"]),
    ("torus", &["bull"]),
    ("conical", &["tapered-ball"]),
    ("tapered", &["tapered-ball"]),
    ("cylinder", &["turned"]),
    ("round", &["turned"]),
    ("overcut", &["gouge"]),
    ("undercut", &["excess"]),
    ("collision", &["clearance"]),
    ("cycle-time", &["time"]),
    ("sinumerik", &["siemens-840d"]),
    ("sinumerik-840d", &["siemens-840d"]),
    ("840d", &["siemens-840d"]),
    ("siemens", &["siemens-840d"]),
    ("heidenhain530", &["heidenhain-itnc530"]),
    ("heidenhain-530", &["heidenhain-itnc530"]),
    ("itnc530", &["heidenhain-itnc530"]),
    ("tnc640", &["heidenhain"]),
    ("heidenhain640", &["heidenhain"]),
    ("heidenhain-tnc640", &["heidenhain"]),
    ("fanuc31i", &["fanuc"]),
    ("fanuc-31i", &["fanuc"]),
    ("fanuc30i", &["fanuc"]),
    ("m700", &["mitsubishi"]),
    ("emc2", &["linuxcnc"]),
    ("apt", &["apt-cl"]),
    ("axial", &["meridian"]),
    ("meridional", &["meridian"]),
    ("tangential", &["tangent"]),
    ("circumferential", &["tangent"]),
    ("blunt", &["cut-off"]),
    ("square", &["cut-off"]),
    ("cut", &["cut-off"]),
    ("circular", &["round"]),
    ("ellipse", &["elliptic"]),
    ("elliptical", &["elliptic"]),
    ("alu", &["aluminium"]),
    ("al", &["aluminium"]),
    ("al7075", &["aluminium"]),
    ("al2618", &["aluminium"]),
    ("al6061", &["aluminium"]),
    ("ti", &["titanium"]),
    ("ti6al4v", &["titanium"]),
    ("ti-6al-4v", &["titanium"]),
    ("tial6v4", &["titanium"]),
    ("inconel", &["nickel"]),
    ("inconel-718", &["nickel"]),
    ("inconel718", &["nickel"]),
    ("in718", &["nickel"]),
    ("waspaloy", &["nickel"]),
    ("stainless-steel", &["stainless"]),
    ("inox", &["stainless"]),
    ("aisi304", &["stainless"]),
    ("aisi316l", &["stainless"]),
    ("x5crni18-10", &["stainless"]),
    ("c45", &["steel"]),
    ("42crmo4", &["steel"]),
    ("cldata", &["apt-cl"]),
];

/// Words of other systems that have no word here, and what stands in their place.
const INSTEAD: &[(&str, &str)] = &[
    (
        "coolant",
        "leave it out: the post writes the coolant, its frames have `M8` and `M9`; `impellerc posts siemens-840d` prints them",
    ),
    ("tilt", AXES),
    ("lead", AXES),
    ("lead-angle", AXES),
    ("tilt-angle", AXES),
    ("tool-axis", AXES),
    ("safe-z", HEIGHTS),
    ("safety", HEIGHTS),
    ("clearance-height", HEIGHTS),
    ("clearance-plane", HEIGHTS),
    ("retract-height", HEIGHTS),
    ("direction", SENSE),
    ("climb", SENSE),
    ("cutting-direction", SENSE),
    ("deflection", LOADS),
    ("chatter", LOADS),
    ("compensation", "leave it out: paths are those of the stated diameter, the program has no radius compensation"),
    ("work-offset", "state it with the post: `post siemens-840d { work-offset \"G55\" }`"),
];
const AXES: &str = "leave it out: the compiler finds the tool axes itself; `method` says how, and `require clearance` how far all stays away";
const HEIGHTS: &str = "leave it out: the compiler finds safe heights itself, `[retract] z` of the machine file, and over the stock by `require clearance`";
const LOADS: &str = "leave it out: no check covers deflection, vibration or wear; `require engagement` and `require removal-rate` keep loads small";
const SENSE: &str = "`flank`, `point` and `fillet` take `milling climb` or `milling conventional`";

/// What stands in the place of a word of another system that has no word here.
pub(crate) fn instead(word: &str) -> Option<&'static str> {
    let word = word.to_ascii_lowercase().replace('_', "-");
    INSTEAD.iter().find(|(of, _)| *of == word).map(|(_, instead)| *instead)
}

/// Words whose values have another form than those of other systems.
const FORMS: &[(&str, &str)] = &[
    ("allowance", "allowance vane 0.3 mm, hub 0.3 mm"),
    ("speed", "speed 12000 rpm` or `speed 75 m/min"),
    ("feed", "feed 150 mm/min` or `feed 0.02 mm/tooth"),
    ("milling", "milling climb` or `milling conventional"),
    ("turned", "stock turned { over shroud 0 mm  bore 10 mm  back -40 mm }"),
];

/// How a word is written with its values, where other systems write them in another form.
pub(crate) fn form(word: &str) -> Option<&'static str> {
    FORMS.iter().find(|(of, _)| *of == word).map(|(_, form)| *form)
}

/// Numbers in words, with their digits.
const NUMBERS: &[&str] =
    &["zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"];

/// The digits of a number that is written as a word.
pub(crate) fn digits(word: &str) -> Option<usize> {
    NUMBERS.iter().position(|number| number.eq_ignore_ascii_case(word))
}

/// The known word that a word of another system means.
pub(crate) fn meant<'k>(text: &str, known: &[&'k str]) -> Option<&'k str> {
    let text = text.to_ascii_lowercase().replace('_', "-");
    let words = OTHER_NAMES.iter().find(|(other, _)| *other == text).map_or(&[][..], |(_, words)| words);
    let properties = topics().flat_map(Topic::all).filter(|p| p.also.contains(&text.as_str())).map(|p| p.name);
    words.iter().copied().chain(properties).find_map(|word| known.iter().copied().find(|k| *k == word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_name_stands_once_and_means_what_fits() {
        for (k, (name, words)) in OTHER_NAMES.iter().enumerate() {
            assert!(OTHER_NAMES[..k].iter().all(|other| other.0 != *name), "{name}");
            assert!(!words.is_empty());
        }
        assert_eq!(meant("Step_Down", &["speed", "depth"]), Some("depth"));
        assert_eq!(meant("blade", &["vanes", "vane"]), Some("vane"));
        assert_eq!(meant("stepover", &["scallop"]), Some("scallop"));
        assert_eq!(meant("step", &["stepover", "depth"]), Some("depth"));
        assert_eq!(meant("step", &["stepover"]), Some("stepover"));
        assert_eq!(meant("speed", &["feed"]), None);
    }
}
