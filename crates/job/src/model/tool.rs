//! Tools: the table of their properties, and what a job knows of a tool.
//!
//! A property is a row of [`PROPERTIES`], a field of [`ToolSpec`], and its lines in [`ToolSpec::of`] and [`ToolSpec::text`].
//! Blocks of jobs and files of the library, vocabulary, reference and schema take it from the row.

use crate::property::Without::{Means, Required};
use crate::property::limits;
use crate::property::quantity::{Dimension, angle, mm};
use crate::property::{Form, Property, Range, typed};
use base::source::Span;
use base::units::{Mm, Mm3PerMin, Rad, trim};
use std::f64::consts::FRAC_PI_2;
use wheel::material::Material;

/// Kinds of cutters.
pub(crate) const KINDS: [&str; 6] = ["flat", "ball", "bull", "tapered-ball", "barrel", "lollipop"];

/// Kinds whose flutes have a length; those of a lollipop end at its neck.
const FLUTED: &[&str] = KINDS.split_at(5).0;

/// Kinds with an end that may plunge.
const PLUNGING: &[&str] = KINDS.split_at(3).0;

const fn form(due: Dimension, [least, most]: [f64; 2]) -> Form {
    Form::Quantity(due, Range::Between(least, most))
}

const LENGTH: Form = form(Dimension::LENGTH, limits::LENGTH);
const DIAMETER: Form = form(Dimension::LENGTH, limits::DIAMETER);
const CORNER: Form = form(Dimension::LENGTH, limits::CORNER);

/// Properties of tools.
pub(crate) const PROPERTIES: &[Property] =
    &[
        typed(
            "number",
            Form::Whole(1, 9999),
            Means("the place of the tool in the job, from 1"),
            "Number in the tool table of the control.",
        )
        .like("1"),
        typed("diameter", DIAMETER, Required, "Diameter of the cutter; of a tapered ball that of the ball.")
            .like("6 mm")
            .also(&["d", "dc", "dia"]),
        typed("corner", CORNER, Required, "Radius of the corner.").like("1 mm").of(&["bull"]).also(&[
            "re",
            "r",
            "corner-radius",
        ]),
        typed("angle", form(Dimension::ANGLE, limits::TAPER), Required, "Angle between the side and the tool axis.")
            .like("3 deg")
            .of(&["tapered-ball"]),
        typed("barrel", LENGTH, Required, "Radius of the side.").like("85 mm").of(&["barrel"]),
        typed("tip", CORNER, Required, "Radius of the ball at the tip.").like("2 mm").of(&["barrel"]),
        typed("neck", DIAMETER, Required, "Diameter of the neck.").like("4 mm").of(&["lollipop"]),
        typed("neck-end", LENGTH, Means("the reach"), "End of the neck, from the tip.").like("20 mm").of(&["lollipop"]),
        typed("flutes", Form::Whole(limits::FLUTES[0], limits::FLUTES[1]), Required, "Number of cutting edges.")
            .like("4")
            .also(&["z", "teeth"]),
        typed("flute", LENGTH, Required, "Length of the cutting edges, from the tip.")
            .like("30 mm")
            .of(FLUTED)
            .also(&["lcf", "apmx", "flute-length", "cutting-length"]),
        typed(
            "shank",
            DIAMETER,
            Means("the diameter"),
            "Diameter of the shank: from the end of the flutes, or of the neck, to the holder.",
        )
        .like("6 mm")
        .also(&["shaft"]),
        typed("reach", LENGTH, Required, "From the tip to the holder: the stick-out.").like("40 mm").also(&[
            "lf",
            "oal",
            "stickout",
            "stick-out",
            "overhang",
            "length",
            "gauge-length",
        ]),
        typed(
            "holder",
            Form::Text("quoted name of a holder"),
            Means("no holder: nothing of it is checked"),
            "Holder of the library, with its contour.",
        )
        .like("\"er16-mini\""),
        typed(
            "max-chip",
            form(Dimension::LENGTH, limits::CHIP),
            Means("by diameter, stick-out and material"),
            "Largest feed per tooth. A stated one holds for each material.",
        )
        .like("0.1 mm"),
        typed(
            "max-depth",
            LENGTH,
            Means("by diameter, stick-out and material"),
            "Largest depth of a slot. A stated one holds for each material.",
        )
        .like("12 mm"),
        typed("max-rate", form(Dimension::REMOVAL_RATE, limits::RATE), Means("no limit"), "Largest removal rate.")
            .like("120 cm3/min"),
        typed(
            "plunge-width",
            LENGTH,
            Means("the corner and half of the flat part of the end"),
            "How wide, from the rim, the teeth of the end cut; half of the diameter is a tool that cuts at its centre.",
        )
        .like("1.5 mm")
        .of(PLUNGING),
        typed(
            "ramp",
            form(Dimension::ANGLE, limits::RAMP),
            Means("by `plunge-width` and corner"),
            "How steeply the tool may go down while it moves sideways in material.",
        )
        .like("3 deg"),
    ];

/// Keys of a tool in a file: its kind in the place of the number, which is of a job.
pub(crate) const KEYS: &[Property] = &{
    let mut keys = [typed("kind", Form::Word(|| KINDS.to_vec()), Required, "Form of the cutter."); PROPERTIES.len()];
    let mut at = 1;
    while at < keys.len() {
        keys[at] = PROPERTIES[at];
        at += 1;
    }
    keys
};

/// Values of the properties of a tool by their names, in base units.
#[derive(Default)]
pub(crate) struct Sizes(Vec<(&'static str, f64)>);

impl Sizes {
    pub(crate) fn add(&mut self, name: &'static str, value: f64) {
        self.0.push((name, value));
    }

    pub(crate) fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|size| size.0 == name).map(|size| size.1)
    }
}

/// Shape of a cutter's end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CutterKind {
    /// Flat.
    Flat,
    /// Ball.
    Ball,
    /// Bull nose, with its corner radius.
    Bull(Mm),
    /// Tapered ball, with the angle between axis and side.
    TaperedBall(Rad),
    /// Barrel: an arc of a large radius between a ball tip and the largest diameter.
    Barrel {
        /// Radius of the arc.
        barrel: Mm,
        /// Radius of the ball tip.
        tip: Mm,
    },
    /// Lollipop: a ball on a thinner neck.
    Lollipop {
        /// Diameter of the neck.
        neck: Mm,
        /// Height over the tip at which the neck ends and the shank begins.
        neck_end: Mm,
    },
}

impl CutterKind {
    /// Keyword of the language.
    pub fn keyword(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::Ball => "ball",
            Self::Bull(_) => "bull",
            Self::TaperedBall(_) => "tapered-ball",
            Self::Barrel { .. } => "barrel",
            Self::Lollipop { .. } => "lollipop",
        }
    }

    /// Radius of the rounding between end and side of a tool with this radius, mm; `None` for other shapes than flat, ball
    /// and bull.
    pub fn corner(self, radius: f64) -> Option<f64> {
        match self {
            Self::Flat => Some(0.0),
            Self::Ball => Some(radius),
            Self::Bull(corner) => Some(corner.get()),
            _ => None,
        }
    }

    /// Least height over the tip to which the flutes must extend, in mm, and the name of this place; for a lollipop of
    /// this diameter, the end of its flutes. Formulas: tangent circles, and the chord of the neck in the ball.
    pub fn least_flute(self, diameter: Mm) -> (f64, &'static str) {
        let radius = diameter.get() / 2.0;
        let leg = |long: f64, short: f64| ((long - short) * (long + short)).max(0.0).sqrt();
        match self {
            Self::Flat => (0.0, "tip"),
            Self::Ball | Self::TaperedBall(_) => (radius, "full radius of the ball"),
            Self::Bull(corner) => (corner.get(), "end of the corner"),
            Self::Barrel { barrel, tip } => {
                (tip.get() + leg(barrel.get() - tip.get(), barrel.get() - radius), "largest diameter")
            }
            Self::Lollipop { neck, .. } => (radius + leg(radius, neck.get() / 2.0), "neck"),
        }
    }
}

/// A tool.
#[derive(Clone, Debug)]
pub struct ToolSpec {
    /// Name in the job.
    pub name: String,
    /// Number in the magazine.
    pub number: u32,
    /// Shape of the end.
    pub kind: CutterKind,
    /// Cutting diameter: the largest one; for a tapered ball, the diameter of the ball.
    pub diameter: Mm,
    /// Teeth.
    pub flutes: u32,
    /// Length of the flutes from the tip; a lollipop has flutes up to its neck.
    pub flute: Mm,
    /// Shank diameter.
    pub shank: Mm,
    /// Distance from the tip to the holder.
    pub reach: Mm,
    /// Holder by name and sections: length, lower and upper diameter.
    pub holder: Option<(String, Vec<[Mm; 3]>)>,
    /// Stated limits of its load.
    pub limits: LoadLimits,
    /// Its item.
    pub span: Span,
}

/// Limits of the load that a job or a library states for a tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadLimits {
    /// `max-chip`: largest feed per tooth.
    pub chip: Option<Mm>,
    /// `max-depth`: largest depth of cut at full width.
    pub depth: Option<Mm>,
    /// `max-rate`: largest removal rate.
    pub rate: Option<Mm3PerMin>,
    /// `plunge-width`: width from the rim towards the axis that the teeth of its end cut.
    pub plunge: Option<Mm>,
    /// `ramp`: largest angle against the plane of its end at which it goes down through material.
    pub ramp: Option<Rad>,
}

/// Depth of the hollow in the middle of an end without teeth there, as a share of the radius of the flat part of the end.
const HOLLOW: f64 = 0.5;

/// The text of a property of a tool.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum PropertyText {
    /// The job states it.
    Stated(String),
    /// What holds without it.
    Default(String),
}

impl ToolSpec {
    /// The tool of a kind with these sizes, without name, holder and place; its number is 0 where none is given. `None` where
    /// a size is missing.
    pub(crate) fn of(kind: &str, sizes: &Sizes) -> Option<Self> {
        let length = |name| sizes.get(name).map(Mm);
        let (diameter, reach) = (length("diameter")?, length("reach")?);
        let kind = match kind {
            "flat" => CutterKind::Flat,
            "ball" => CutterKind::Ball,
            "bull" => CutterKind::Bull(length("corner")?),
            "tapered-ball" => CutterKind::TaperedBall(Rad(sizes.get("angle")?)),
            "barrel" => CutterKind::Barrel { barrel: length("barrel")?, tip: length("tip")? },
            "lollipop" => CutterKind::Lollipop { neck: length("neck")?, neck_end: length("neck-end").unwrap_or(reach) },
            _ => return None,
        };
        Some(Self {
            name: String::new(),
            number: sizes.get("number").map_or(0, |number| number as u32),
            kind,
            diameter,
            flutes: sizes.get("flutes")? as u32,
            flute: length("flute").unwrap_or_else(|| Mm(kind.least_flute(diameter).0)),
            shank: length("shank").unwrap_or(diameter),
            reach,
            holder: None,
            limits: LoadLimits {
                chip: length("max-chip"),
                depth: length("max-depth"),
                rate: sizes.get("max-rate").map(Mm3PerMin),
                plunge: length("plunge-width"),
                ramp: sizes.get("ramp").map(Rad),
            },
            span: Span::default(),
        })
    }

    /// The value of a property as a job writes it, with all its digits where it is stated; `None` where the tool has none.
    pub(crate) fn text(&self, property: &str, material: Option<Material>) -> Option<PropertyText> {
        let of_kind = PROPERTIES.iter().find(|row| row.name == property)?.of;
        if !of_kind.is_empty() && !of_kind.contains(&self.kind.keyword()) {
            return None;
        }
        let limit = |stated: Option<String>, default: Option<String>| {
            stated.map(PropertyText::Stated).or(default.map(PropertyText::Default))
        };
        let limits = &self.limits;
        let stated = match (property, self.kind) {
            ("number", _) => self.number.to_string(),
            ("diameter", _) => mm(self.diameter),
            ("corner", CutterKind::Bull(corner)) => mm(corner),
            ("angle", CutterKind::TaperedBall(half)) => angle(half.get()),
            ("barrel", CutterKind::Barrel { barrel, .. }) => mm(barrel),
            ("tip", CutterKind::Barrel { tip, .. }) => mm(tip),
            ("neck", CutterKind::Lollipop { neck, .. }) => mm(neck),
            ("neck-end", CutterKind::Lollipop { neck_end, .. }) => mm(neck_end),
            ("flutes", _) => self.flutes.to_string(),
            ("flute", _) => mm(self.flute),
            ("shank", _) => mm(self.shank),
            ("reach", _) => mm(self.reach),
            ("max-rate", _) => format!("{} mm3/min", limits.rate?.get()),
            ("max-chip", _) => return limit(limits.chip.map(mm), Some(self.largest_chip(material).to_string())),
            ("max-depth", _) => return limit(limits.depth.map(mm), Some(self.largest_depth(material).to_string())),
            ("plunge-width", _) => {
                return limit(limits.plunge.map(mm), self.plunge_width().map(|width| width.to_string()));
            }
            ("ramp", _) => {
                let stated = limits.ramp.map(|ramp| angle(ramp.get()));
                return limit(stated, Some(self.largest_ramp().to_string()));
            }
            _ => return None,
        };
        Some(PropertyText::Stated(stated))
    }

    /// Width, from the rim towards the axis, that the teeth of its end cut in a stroke along the axis: the stated one, or
    /// the corner and half of the flat part of the end. So a ball cuts at its centre. `None` for other shapes than flat,
    /// ball and bull.
    pub fn plunge_width(&self) -> Option<Mm> {
        let radius = 0.5 * self.diameter.get();
        let corner = self.kind.corner(radius)?;
        Some(self.limits.plunge.unwrap_or(Mm(0.5 * (radius + corner))))
    }

    /// Largest distance between neighbouring strokes along the axis, mm: half of the diameter for a tool that cuts at its
    /// centre. Otherwise the flat part of the width that its teeth cut, so that the middle of its end goes down over the
    /// floor of the stroke before. `None` as for [`Self::plunge_width`]; zero or less where the tool cannot plunge.
    pub fn largest_plunge_step(&self) -> Option<f64> {
        let (radius, width) = (0.5 * self.diameter.get(), self.plunge_width()?.get());
        let corner = self.kind.corner(radius)?;
        Some(if width >= radius { radius } else { width - corner })
    }

    /// Largest angle against the plane of its end at which the tool may go down while it moves sideways through material: the
    /// stated one, or what the middle of the end without teeth permits. Over the width of the middle, 2 c, the tool goes
    /// down by 2 c tan a; material as high as that fills the hollow of the middle at most. So a tool that cuts at its centre
    /// may go straight down.
    pub fn largest_ramp(&self) -> Rad {
        let radius = 0.5 * self.diameter.get();
        let middle = radius - self.plunge_width().map_or(radius, Mm::get);
        let flat = (radius - self.kind.corner(radius).unwrap_or(radius)).max(middle);
        let by_middle = if middle > 0.0 { libm::atan2(HOLLOW * flat, 2.0 * middle) } else { FRAC_PI_2 };
        self.limits.ramp.unwrap_or(Rad(by_middle))
    }

    /// Largest feed per tooth, mm: the stated one, or a share of the diameter that falls with the stick-out, less in a
    /// material that is harder to cut than aluminium.
    pub fn largest_chip(&self, material: Option<Material>) -> Mm {
        self.limits.chip.unwrap_or_else(|| self.share([0.03, 0.0225, 0.015], material))
    }

    /// Largest depth of cut at full width, mm, as for [`Self::largest_chip`].
    pub fn largest_depth(&self, material: Option<Material>) -> Mm {
        self.limits.depth.unwrap_or_else(|| self.share([1.0, 0.75, 0.5], material))
    }

    /// A share of the diameter: for a stick-out of up to 4 diameters, of up to 8 diameters, and of more.
    fn share(&self, shares: [f64; 3], material: Option<Material>) -> Mm {
        let stick_out = self.reach.get() / self.diameter.get();
        let [short, middle, long] = shares;
        let share = if stick_out <= 4.0 {
            short
        } else if stick_out <= 8.0 {
            middle
        } else {
            long
        };
        Mm(share * self.diameter.get() * material.map_or(1.0, Material::share))
    }
}

/// The first contradiction in the sizes of a tool.
pub(crate) fn shape_fault(tool: &ToolSpec) -> Option<String> {
    let radius = tool.diameter.get() / 2.0;
    let fault = match tool.kind {
        CutterKind::Bull(corner) if corner.get() >= radius => {
            "the corner radius must be smaller than half of the diameter"
        }
        CutterKind::Barrel { tip, .. } if tip.get() >= radius => {
            "the tip radius must be smaller than half of the diameter"
        }
        CutterKind::Barrel { barrel, .. } if barrel.get() <= radius => {
            "the barrel radius must be larger than half of the diameter; if both are equal, use a ball"
        }
        CutterKind::Lollipop { neck, .. } if neck.get() >= tool.diameter.get() => {
            "the neck must be thinner than the ball"
        }
        CutterKind::Lollipop { neck_end, .. } if neck_end.get() > tool.reach.get() => {
            "the neck must end within the reach, which goes from the tip to the holder"
        }
        CutterKind::Lollipop { neck_end, .. } if neck_end.get() < tool.flute.get() => {
            "the neck must end above the ball; `neck-end` is measured from the tip"
        }
        _ if tool.limits.plunge.is_some_and(|width| width.get() > radius) => {
            "the plunge width, from the rim towards the axis, must be at most half of the diameter"
        }
        _ => "",
    };
    if !fault.is_empty() {
        return Some(fault.to_owned());
    }
    let (least, what) = tool.kind.least_flute(tool.diameter);
    if tool.flute.get() < least {
        return Some(format!("the flutes must reach the {what}, {} mm above the tip", trim(least, 3)));
    }
    if tool.reach.get() < tool.flute.get() {
        return Some("the reach, from the tip to the holder, must be at least the flute length".to_owned());
    }
    let [least, most] = limits::FLUTES;
    (!(least..=most).contains(&tool.flutes)).then(|| format!("it needs {least} to {most} flutes"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A value in the range of a property, which fits the others.
    fn fitting(property: &Property) -> Option<f64> {
        match property.form {
            Form::Whole(..) => Some(3.0),
            Form::Quantity(Dimension::ANGLE, _) => Some(0.1),
            Form::Quantity(..) => Some(match property.name {
                "diameter" => 6.0,
                "barrel" => 80.0,
                "neck" => 4.0,
                "flute" => 20.0,
                "neck-end" | "reach" => 40.0,
                _ => 1.0,
            }),
            _ => None,
        }
    }

    #[test]
    fn each_property_of_the_table_reaches_the_tool() {
        for kind in KINDS {
            let mut sizes = Sizes::default();
            let own = || PROPERTIES.iter().filter(|p| p.is_of(kind));
            own().filter_map(|p| Some((p.name, fitting(p)?))).for_each(|(name, value)| sizes.add(name, value));
            let tool = ToolSpec::of(kind, &sizes).unwrap();
            assert_eq!(tool.kind.keyword(), kind);
            assert_eq!(shape_fault(&tool), None, "{kind}");
            for property in own() {
                let Some(value) = fitting(property) else { continue };
                let changed = value + if matches!(property.form, Form::Whole(..)) { 1.0 } else { 0.01 * value };
                let mut other = Sizes(sizes.0.clone());
                other.0.retain(|size| size.0 != property.name);
                other.add(property.name, changed);
                let texts = [&tool, &ToolSpec::of(kind, &other).unwrap()].map(|t| t.text(property.name, None).unwrap());
                assert_ne!(texts[0], texts[1], "`{}` of {kind}", property.name);
            }
        }
    }

    #[test]
    fn ends_of_ranges_are_in_range_as_they_are_written() {
        for property in PROPERTIES {
            let Form::Quantity(due, range) = property.form else { continue };
            for end in range.bounds() {
                let text = format!("{} {}", due.bound(end), due.usual_unit());
                let end = crate::property::quantity::Quantity::read(&text).unwrap();
                assert!(range.holds(end.value), "`{}`: {text}", property.name);
            }
        }
    }

    #[test]
    fn examples_are_in_range() {
        for property in PROPERTIES {
            if let Form::Quantity(due, range) = property.form {
                let example = crate::property::quantity::Quantity::read(property.example).unwrap();
                assert!(example.dimension == due && range.holds(example.value), "{}", property.written());
            }
        }
    }
}
