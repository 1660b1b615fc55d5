//! Keys of machine files about rotary axes without limits, clamps, and what posts use.

use super::machine::{LibraryReader, MIN_DIRECTION_LENGTH};
use super::table::{FileTable, SpannedText};
use crate::model::LinearSpec;
use crate::property::Range;
use crate::property::quantity::{Dimension, Quantity};
use base::source::Span;
use base::units::{Mm, trim};
use five_axis::control::ModuloWay;
use nalgebra::Vector3;
use toml::Spanned;

/// Largest cosine of the angle between the two directions of the part.
const AT_RIGHT_ANGLES: f64 = 1e-3;

impl LibraryReader<'_> {
    /// Where the machine parks: within the travel, and not below the retract height.
    pub(super) fn home(
        &mut self,
        table: Option<FileTable<'_, '_>>,
        linear: &[LinearSpec; 3],
        retract: Mm,
    ) -> [Option<Mm>; 3] {
        let Some(table) = table else { return [None; 3] };
        let [of_x, of_y, of_z] = linear.map(|axis| axis.travel.map(Mm::get));
        let keys = [
            ("x", of_x, ["the travel of X"; 2]),
            ("y", of_y, ["the travel of Y"; 2]),
            ("z", [retract.get(), of_z[1]], ["the retract height", "the travel of Z"]),
        ];
        keys.map(|(key, within, of)| Some(self.place(&table.text(key)?, "home", within, of)))
    }

    /// A place of an axis between two others.
    pub(super) fn place(&mut self, text: &SpannedText, what: &str, [low, high]: [f64; 2], of: [&str; 2]) -> Mm {
        let read = Quantity::read(text.get_ref()).filter(|q| q.dimension == Dimension::LENGTH);
        if let Some(outside) = read.filter(|q| !(low..=high).contains(&q.value)) {
            let (side, of) = if outside.value < low { ("below", of[0]) } else { ("above", of[1]) };
            let [low, high] = [low, high].map(|x| trim(x, 6));
            self.fault(
                self.span(text),
                format!("the {what} `{}` is {side} {of}", text.get_ref()),
                format!("a place from {low} to {high} mm is expected"),
                "write a place that the axis reaches; tools change at the retract height, and the machine parks at home",
            );
            return Mm(0.0);
        }
        Mm(self.quantity(text, Dimension::LENGTH, Range::Between(low, high)))
    }

    /// Directions of X and Z of the part, where the file states one of them. Without `x-direction` X of the part lies along
    /// X of the machine as far as Z permits; for Z along X of the machine it lies along Z of the machine.
    pub(super) fn part_axes(&mut self, table: FileTable<'_, '_>) -> Option<[[f64; 3]; 2]> {
        let stated = table.numbers("direction");
        let z = match &stated {
            Some(given) => self.part_direction("direction", given)?,
            None => Vector3::z(),
        };
        let across = |v: Vector3<f64>| (v - z * z.dot(&v)).try_normalize(AT_RIGHT_ANGLES);
        let Some(given) = &table.numbers("x-direction") else {
            stated?;
            // The second is what the first comes to where Z is turned to X.
            let x = across(Vector3::x()).or_else(|| across(Vector3::z() * -z.x.signum()))?;
            return Some([x.into(), z.into()]);
        };
        let x = self.part_direction("x-direction", given)?;
        if x.dot(&z).abs() > AT_RIGHT_ANGLES {
            self.fault(
                self.span(given),
                format!("`x-direction` is {} deg from the axis of the part", trim(x.angle(&z).to_degrees(), 3)),
                "a direction at right angles to `direction` is expected".to_owned(),
                "write where X of the part points with all axes at zero, or remove the line",
            );
            return None;
        }
        Some([across(x)?.into(), z.into()])
    }

    fn part_direction(&mut self, key: &str, given: &Spanned<[f64; 3]>) -> Option<Vector3<f64>> {
        let found = Vector3::from(*given.get_ref()).try_normalize(MIN_DIRECTION_LENGTH);
        let found = found.filter(|direction| direction.iter().all(|x| x.is_finite()));
        if found.is_none() {
            self.fault(
                self.span(given),
                format!("`{key}` of the part is no direction"),
                "three numbers are expected, at least one of them not 0".to_owned(),
                "write the direction in the machine frame with all axes at zero, such as [0, 1, 0]",
            );
        }
        found
    }

    /// The entry of a list that a text names; without a text the first.
    pub(super) fn named<T: Copy, const N: usize>(
        &mut self,
        text: &Option<SpannedText>,
        key: &str,
        help: &str,
        known: [(T, &'static str); N],
    ) -> T {
        let Some(text) = text else { return known[0].0 };
        if let Some((value, _)) = known.iter().find(|(_, name)| name == text.get_ref()) {
            return *value;
        }
        let names = known.map(|(_, name)| format!("\"{name}\"")).join(", ");
        self.fault(
            self.span(text),
            format!("the value `{}` of `{key}` is not known", text.get_ref()),
            format!("one of {names} is expected"),
            help,
        );
        known[0].0
    }

    /// Travel of a rotary axis, and for an axis modulo 360 deg, which has no limits, the way of the control.
    pub(super) fn turns(
        &mut self,
        name: &str,
        table: FileTable<'_, '_>,
        axis: Span,
    ) -> Option<([f64; 2], Option<ModuloWay>)> {
        let endless = [f64::NEG_INFINITY, f64::INFINITY];
        let (modulo, way) = (table.flag("modulo").filter(|m| *m.get_ref()), table.text("way"));
        Some(match (table.has("travel"), modulo) {
            (true, None) => {
                if let Some(way) = &way {
                    self.fault(
                        self.span(way),
                        format!("axis {name} has a `way`, but its words are not modulo 360 deg"),
                        "this key is for an axis with `modulo = true`".to_owned(),
                        "remove the line, or write `modulo = true` instead of `travel`",
                    );
                }
                (self.pair(table, "travel")?, None)
            }
            (false, Some(modulo)) => {
                if way.is_none() {
                    self.fault(
                        self.span(&modulo),
                        format!("the way that the control takes to a word of {name} is not given"),
                        "`way` is missing".to_owned(),
                        "write `way = \"shortest\"` if the control takes the shorter way, \"direct\" if it never passes 0 deg, \
                         \"sign\" if the sign of the word decides",
                    );
                }
                let help = "the manual of the control says how a rotary axis goes to an absolute word";
                let way = self.named(&way, "way", help, ModuloWay::ALL.map(|way| (way, way.name())));
                (endless, Some(way))
            }
            (true, Some(modulo)) => {
                self.fault(
                    self.span(&modulo),
                    format!("axis {name} has a `travel` and is modulo 360 deg"),
                    "an axis whose words the control reduces modulo 360 deg has no limits".to_owned(),
                    "remove `travel`, or `modulo` for an axis with limits",
                );
                (endless, None)
            }
            (false, None) => {
                self.fault(
                    axis,
                    format!("axis {name} has no `travel`"),
                    "two angles are expected".to_owned(),
                    "write `travel = [\"-120 deg\", \"120 deg\"]`, or `modulo = true` and `way` for a table that turns without end",
                );
                (endless, None)
            }
        })
    }

    /// Words that clamp and unclamp an axis: two different M words.
    pub(super) fn clamp(&mut self, name: &str, words: &[SpannedText; 2]) -> [String; 2] {
        let is_word = |text: &str| {
            let digits = text.strip_prefix('M').unwrap_or_default();
            (1..=4).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit())
        };
        for word in words {
            if !is_word(word.get_ref()) {
                self.fault(
                    self.span(word),
                    format!("`{}` is not a word that clamps {name}", word.get_ref()),
                    "M with one to four digits is expected".to_owned(),
                    "write the word that clamps, then the word that unclamps: [\"M10\", \"M11\"]",
                );
            }
        }
        let [on, off] = words.each_ref().map(|word| word.get_ref().clone());
        if on == off {
            self.fault(
                self.span(&words[1]),
                format!("one word clamps and unclamps {name}"),
                "another word is expected".to_owned(),
                "write the word that clamps, then the word that unclamps: [\"M10\", \"M11\"]",
            );
        }
        [on, off]
    }
}
