//! Stable diagnostic codes. The pages that `impellerc explain` prints are beside the codes in [`codes`](mod@super::codes).

use std::fmt;

/// The manual entry of a diagnostic.
#[derive(Debug, PartialEq, Eq)]
pub struct Entry {
    /// `IMP` and four digits; the first two are the number of the stage.
    pub id: &'static str,
    /// Short name of the fault.
    pub title: &'static str,
    /// Meaning, effect at the machine, an example, the remedy.
    pub page: &'static str,
}

/// A stable code: a reference to its manual entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code(pub &'static Entry);

impl Code {
    /// The text of the code, such as `IMP0203`.
    pub fn id(self) -> &'static str {
        self.0.id
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.id)
    }
}

/// Declares the codes of one stage: `NAME = "IMP0101", "title", "page";`.
#[macro_export]
macro_rules! codes {
    ($($name:ident = $id:literal, $title:literal, $page:expr;)*) => {
        $(
            #[doc = concat!($id, ": ", $title)]
            pub const $name: $crate::Code =
                $crate::Code(&$crate::code::Entry { id: $id, title: $title, page: $page });
        )*
        /// All codes of this stage.
        pub const ALL: &[$crate::Code] = &[$($name),*];
    };
}
