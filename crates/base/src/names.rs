//! Enums whose variants have words.

/// Declares an enum with the word of each variant beside it. `ALL` has the variants in the order of their declaration, where one is
/// the default it stands first; `name` gives the word.
///
/// ```
/// base::named! {
///     /// Sense of a turn.
///     #[derive(Clone, Copy, Debug, PartialEq)]
///     enum Sense {
///         /// As the clock.
///         Clockwise = "clockwise",
///         /// Against it.
///         CounterClockwise = "counter-clockwise",
///     }
/// }
/// assert_eq!(Sense::ALL.map(Sense::name), ["clockwise", "counter-clockwise"]);
/// ```
#[macro_export]
macro_rules! named {
    ($(#[$meta:meta])* $vis:vis enum $name:ident { $($(#[$doc:meta])* $variant:ident = $word:literal),+ $(,)? }) => {
        $(#[$meta])*
        $vis enum $name {
            $($(#[$doc])* $variant),+
        }

        impl $name {
            /// All of them; a default is the first.
            $vis const ALL: [Self; [$($word),+].len()] = [$(Self::$variant),+];

            /// Its word in jobs, files and messages.
            $vis const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $word),+
                }
            }
        }
    };
}
