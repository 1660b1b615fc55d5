//! Roles of faces of a STEP file, and how the caller picks them.

use std::fmt;

/// What a face is in the wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceRole {
    /// Hub between the blades.
    Hub,
    /// Shroud: the tips of the blades.
    Shroud,
    /// Pressure face of a blade.
    Pressure,
    /// Suction face of the same blade.
    Suction,
    /// A face at the inlet, such as the leading edge.
    Inlet,
    /// A face at the outlet.
    Outlet,
}

impl FaceRole {
    /// All roles with their words.
    pub const WORDS: [(Self, &'static str); 6] = [
        (Self::Hub, "hub"),
        (Self::Shroud, "shroud"),
        (Self::Pressure, "pressure"),
        (Self::Suction, "suction"),
        (Self::Inlet, "inlet"),
        (Self::Outlet, "outlet"),
    ];
}

impl fmt::Display for FaceRole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = Self::WORDS.iter().find(|(role, _)| role == self).map(|(_, word)| *word);
        f.write_str(word.unwrap_or_default())
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
        let (role, _) = FaceRole::WORDS.into_iter().find(|(_, name)| *name == word.trim())?;
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
        assert!(["hub", "hub=", "rim=#1", ""].iter().all(|text| FaceChoice::parsed(text).is_none()));
    }
}
