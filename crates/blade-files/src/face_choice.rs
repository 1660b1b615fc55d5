//! Roles of faces of a STEP file, and how the caller picks them.

use super::limits;
use std::fmt;

/// What a face is in the wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceRole {
    /// Hub between the blades.
    Hub,
    /// Shroud: the tips of the blades.
    Shroud,
    /// A face of a blade of a sector: 0 is the main blade, its splitters count from 1.
    OfBlade(usize, BladeFace),
}

/// What a face is on its blade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BladeFace {
    /// Pressure face.
    Pressure,
    /// Suction face.
    Suction,
    /// A face at the inlet, such as one of the leading edge.
    Inlet,
    /// A face at the outlet.
    Outlet,
    /// A fillet between the blade and the hub.
    Fillet,
}

impl BladeFace {
    const WORDS: [(Self, &'static str); 5] = [
        (Self::Pressure, "pressure"),
        (Self::Suction, "suction"),
        (Self::Inlet, "inlet"),
        (Self::Outlet, "outlet"),
        (Self::Fillet, "fillet"),
    ];
}

impl FaceRole {
    /// Forms of all roles, for messages.
    pub const FORMS: &'static str =
        "hub, shroud, pressure, suction, inlet, outlet, fillet; of a splitter splitter1-pressure and so on";

    /// Whether several faces can have the role. A pressure or suction face is one face.
    pub fn has_several(self) -> bool {
        !matches!(self, Self::OfBlade(_, BladeFace::Pressure | BladeFace::Suction))
    }

    /// The role of its word.
    fn parsed(word: &str) -> Option<Self> {
        match word {
            "hub" => return Some(Self::Hub),
            "shroud" => return Some(Self::Shroud),
            _ => {}
        }
        let (blade, word) = match word.strip_prefix("splitter") {
            Some(rest) => {
                let (number, word) = rest.split_once('-')?;
                (number.parse().ok().filter(|number| (1..limits::BLADES).contains(number))?, word)
            }
            None => (0, word),
        };
        let (face, _) = BladeFace::WORDS.into_iter().find(|(_, name)| *name == word)?;
        Some(Self::OfBlade(blade, face))
    }
}

impl fmt::Display for FaceRole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of =
            |face: &BladeFace| BladeFace::WORDS.iter().find(|(other, _)| other == face).map_or("", |(_, word)| word);
        match self {
            Self::Hub => f.write_str("hub"),
            Self::Shroud => f.write_str("shroud"),
            Self::OfBlade(0, face) => f.write_str(of(face)),
            Self::OfBlade(blade, face) => write!(f, "splitter{blade}-{}", of(face)),
        }
    }
}

/// A face that the caller picks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaceChoice {
    /// Its role.
    pub role: FaceRole,
    /// Its name in the file, or `#` and its number.
    pub face: String,
}

impl FaceChoice {
    /// The choice of `ROLE=#NUMBER` or `ROLE=NAME`; `None` for another text.
    pub fn parsed(text: &str) -> Option<Self> {
        let (word, face) = text.split_once('=')?;
        let role = FaceRole::parsed(word.trim())?;
        let face = face.trim();
        (!face.is_empty()).then(|| Self { role, face: face.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_parsed() {
        let made = FaceChoice::parsed("hub=#123");
        assert_eq!(made, Some(FaceChoice { role: FaceRole::Hub, face: "#123".to_owned() }));
        assert_eq!(FaceChoice::parsed("suction= a=b ").map(|c| c.face), Some("a=b".to_owned()));
        let splitter = FaceChoice::parsed("splitter2-inlet=#1").map(|c| c.role);
        assert_eq!(splitter, Some(FaceRole::OfBlade(2, BladeFace::Inlet)));
        let none = [
            "hub",
            "hub=",
            "rim=#1",
            "splitter=#1",
            "splitter0-inlet=#1",
            "splitter9-inlet=#1",
            "splitter1-hub=#1",
            "",
        ];
        assert!(none.iter().all(|text| FaceChoice::parsed(text).is_none()));
    }

    /// Each role is written as it is read.
    #[test]
    fn roles_have_their_words() {
        for word in ["hub", "shroud", "pressure", "outlet", "splitter1-suction", "splitter8-fillet"] {
            assert_eq!(FaceRole::parsed(word).map(|role| role.to_string()).as_deref(), Some(word));
        }
    }
}
