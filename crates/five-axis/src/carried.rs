//! Solids that turn with the part.

/// A solid of the machine file that turns with the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum CarriedKind {
    /// The table.
    Table,
    /// What holds the part on it.
    Fixture,
}

impl CarriedKind {
    /// Name in machine files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Table => "table",
            Self::Fixture => "fixture",
        }
    }
}

/// A solid of revolution about the axis of the table that turns with the part.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Carried {
    /// Which solid of the machine file it is.
    pub kind: CarriedKind,
    /// Meridian as (r, z), straight between the points, from the axis at its top to the axis at its bottom; mm, z in
    /// the part frame.
    pub profile: Vec<[f64; 2]>,
}
