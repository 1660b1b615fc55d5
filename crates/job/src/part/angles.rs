//! Blades by angles and thicknesses: `span 0 % { beta [...] start 0 deg thickness [...] }`.

use super::curves::curve;
use super::distributions::{at_spans, distribution, share, single};
use crate::block::context::Context;
use crate::block::eval::nearest;
use crate::block::properties::{Properties, Range, name_of};
use crate::model::{
    AnglesAtSpan, AnglesSpec, CamberSpec, DistributionSpec, EdgePlace, Facing, MeridianPlace, SpanSpec,
};
use crate::property::quantity::Dimension;
use crate::vocabulary::part::FIT_OF_SPANS;
use crate::vocabulary::{self, TopicKind};
use base::source::Span;
use base::units::{Mm, trim};
use blade::angles::{EdgeShape, MAX_CAMBER_ANGLE, limits};
use diagnostics::Diag;
use diagnostics::codes::{geometry, job as codes};
use syntax::ast::{Block, Expr, ExprKind, Name, Path, Value};

/// Entries that may be repeated.
pub(super) const REPEATED: [&str; 1] = ["span"];

const EDGES: [&str; 2] = ["leading-edge", "trailing-edge"];

base::named! {
    /// Direction from which beta is measured.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    enum BetaFrom {
        /// The meridian.
        Meridian = "meridian",
        /// The direction of growing theta.
        Tangent = "tangent",
    }
}

/// A word of a blade and its values.
type Given<'a> = (&'a Name, Vec<&'a Value>);

/// What a blade says of its angles and thicknesses.
pub(super) struct AnglesGiven<'a> {
    main: Option<&'a Name>,
    of: Option<Given<'a>>,
    spans: Vec<Given<'a>>,
    beta_from: Option<BetaFrom>,
    lean: Option<Given<'a>>,
    thickness: Option<Given<'a>>,
    ends: [Option<Given<'a>>; 2],
    edges: [EdgeShape; 2],
    fit: f64,
    pressure: Option<Facing>,
    head: Span,
}

/// What the job says at one span.
struct AtSpan {
    angles: Option<AnglesAtSpan>,
    thickness: Option<DistributionSpec>,
}

impl<'a> AnglesGiven<'a> {
    /// Takes the entries of a blade. `main` is the name of the main blade in a splitter.
    pub(super) fn take(p: &mut Properties<'a, '_>, head: Span, main: Option<&'a Name>) -> Option<Self> {
        let spans = p.take_all("span");
        let fit = p.read_or_default(&FIT_OF_SPANS);
        let pressure = name_of(p, "pressure", &Facing::ALL, Facing::name);
        let beta_from = name_of(p, "beta-from", &BetaFrom::ALL, BetaFrom::name);
        let [leading, trailing] = EDGES.map(|edge| edge_shape(p, edge));
        let [of, lean, thickness, from, to] = ["of", "lean", "thickness", "from", "to"].map(|name| p.take(name));
        Some(Self {
            main,
            of,
            spans,
            beta_from: beta_from?,
            lean,
            thickness,
            ends: [from, to],
            edges: [leading?, trailing?],
            fit: fit?,
            pressure: pressure?,
            head,
        })
    }

    pub(super) fn resolve(self, cx: &mut Context<'_>) -> Option<AnglesSpec> {
        let mut rows = Vec::new();
        for (word, values) in &self.spans {
            rows.push(self.at_span(word, values, cx));
        }
        let rows = rows.into_iter().collect::<Option<Vec<_>>>()?;
        let thickness = self.thickness(&rows, cx)?;
        let camber = match &self.of {
            Some((word, values)) => {
                self.is_main(word, values, cx)?;
                CamberSpec::OfMain { part: self.part_of_main(cx)? }
            }
            None => {
                let angles = rows.into_iter().filter_map(|row| {
                    let SpanSpec { at, says, span } = row;
                    says.angles.map(|says| SpanSpec { at, says, span })
                });
                let angles = at_spans(angles.collect(), "angles", self.head, cx)?;
                let lean = match &self.lean {
                    Some((word, values)) => Some(distribution(
                        single(word, values, cx)?,
                        "lean",
                        Dimension::ANGLE,
                        "lean [(0 %, 0 deg) (100 %, 5 deg)]",
                        cx,
                    )?),
                    None => None,
                };
                let [leading, trailing] = [0, 1].map(|end| self.edge_place(end, cx));
                CamberSpec::Own { angles, lean, edges: Box::new([leading?, trailing?]) }
            }
        };
        let Self { edges, fit, pressure, head, .. } = self;
        Some(AnglesSpec { camber, thickness, edges, fit: Mm(fit), pressure, span: head })
    }

    /// `0 % { ... }`
    fn at_span(&self, word: &Name, values: &[&'a Value], cx: &mut Context<'_>) -> Option<SpanSpec<AtSpan>> {
        let example = "span 0 % { beta [(0 %, 50 deg) (100 %, 35 deg)]  start 0 deg  thickness 2 mm }";
        let named;
        let (place, block): (&Expr, &Block) = match values {
            [Value::Placed(place, block)] => (place, block),
            [Value::Block(Some(name), block)] => {
                let path = Path { names: vec![name.clone()], span: name.span };
                named = Expr { kind: ExprKind::Path(path), span: name.span };
                (&named, block)
            }
            _ => {
                cx.sink.push(
                    Diag::error(codes::WRONG_FORM, "`span` takes a share of the span and a block")
                        .label(word.span, "a share from hub (0 %) to shroud (100 %) and a block are expected")
                        .help(format!("write it like `{example}`")),
                );
                return None;
            }
        };
        let at = share(place, "`span`", geometry::SPANS, cx)?;
        // A splitter on the camber surface of the main blade has its angles.
        let of = self.of.is_some();
        let known =
            vocabulary::properties(TopicKind::Block, "span").into_iter().filter(|name| !of || *name == "thickness");
        let known: Vec<&str> = known.collect();
        let owner = "the span".to_owned();
        let mut p = Properties::new(owner, word.span, block, &known, &mut cx.scope, cx.sink);
        let stacked = ["start", "end"].map(|end| {
            let example = if end == "start" { "start 0 deg" } else { "end 0 deg" };
            let given = p.has(end);
            (given, p.number(end, Dimension::ANGLE, Range::Within(100.0), example))
        });
        let [theta, beta, thickness] = ["theta", "beta", "thickness"].map(|name| p.take(name));
        let span = Span { end: block.span.start, ..word.span };
        let thickness = match thickness {
            Some((word, values)) => Some(thickness_of(word, &values, cx)?),
            None => None,
        };
        let angles = self.angles([theta, beta], stacked, span, cx)?;
        Some(SpanSpec { at, says: AtSpan { angles, thickness }, span })
    }

    /// Theta, or beta with theta at one end. Outer `None`: faulty; inner `None`: not given.
    #[expect(clippy::option_option, reason = "faulty and absent differ")]
    fn angles(
        &self,
        [theta, beta]: [Option<Given<'_>>; 2],
        stacked: [(bool, Option<(f64, Span)>); 2],
        span: Span,
        cx: &mut Context<'_>,
    ) -> Option<Option<AnglesAtSpan>> {
        let mut wrong = |message: &str, label: &str, help: &str| {
            cx.sink.push(Diag::error(codes::WRONG_FORM, message.to_owned()).label(span, label.to_owned()).help(help));
        };
        let count = stacked.iter().filter(|(given, _)| *given).count();
        match (theta, beta) {
            (Some(_), Some(_)) => {
                wrong("a span has both theta and beta", "this span", "give one of them: beta follows from theta");
                None
            }
            (None, None) if count == 0 => Some(None),
            (_, None) if count > 0 => {
                let help =
                    "`start` and `end` place a camber line of which beta is given; put the angle into theta itself";
                wrong("`start` or `end` without beta", "this span", help);
                None
            }
            (None, Some(_)) if count != 1 => {
                let help = "add `start 0 deg`: theta at the leading edge; or `end 0 deg`: theta at the trailing edge";
                wrong("beta needs theta at one end of the blade", "give `start` or `end`, one of them", help);
                None
            }
            (None, None) => Some(None),
            (Some((word, values)), None) => {
                let example = "theta [(0 %, 0 deg) (100 %, 45 deg)]";
                let theta = distribution(single(word, &values, cx)?, "theta", Dimension::ANGLE, example, cx)?;
                Some(Some(AnglesAtSpan::Theta(theta)))
            }
            (None, Some((word, values))) => {
                let beta = self.beta(word, &values, cx)?;
                let end = usize::from(stacked[1].0);
                let (theta, _) = stacked[end].1?;
                Some(Some(AnglesAtSpan::Beta { beta, theta, end }))
            }
        }
    }

    /// Beta to the meridian.
    fn beta(&self, word: &Name, values: &[&Value], cx: &mut Context<'_>) -> Option<DistributionSpec> {
        let Some(from) = self.beta_from else {
            // Each span of the blade asks for it.
            cx.sink.push_first(
                Diag::error(codes::MISSING_PROPERTY, "it is not said from where beta is measured")
                    .label(word.span, "`beta-from` is missing in this blade")
                    .help("add `beta-from meridian` for angles to the meridian, or `beta-from tangent` for angles to the direction round the axis"),
            );
            return None;
        };
        let example = "beta [(0 %, 50 deg) (100 %, 35 deg)]";
        let mut beta = distribution(single(word, values, cx)?, "beta", Dimension::ANGLE, example, cx)?;
        if from == BetaFrom::Tangent {
            beta.points.iter_mut().for_each(|[_, value]| *value = std::f64::consts::FRAC_PI_2 - *value);
        }
        if let Some([at, steep]) = beta.points.iter().find(|[_, value]| value.abs() >= MAX_CAMBER_ANGLE) {
            cx.sink.push(
                Diag::error(geometry::STEEP, "the camber line runs round the axis")
                    .label(
                        beta.span,
                        format!("{} deg to the meridian at {} %", trim(steep.to_degrees(), 4), trim(at * 100.0, 4)),
                    )
                    .help(format!(
                        "give angles of less than {} deg to the meridian; check `beta-from`",
                        trim(MAX_CAMBER_ANGLE.to_degrees(), 4)
                    )),
            );
            return None;
        }
        Some(beta)
    }

    fn thickness(&self, rows: &[SpanSpec<AtSpan>], cx: &mut Context<'_>) -> Option<Vec<SpanSpec<DistributionSpec>>> {
        let at_rows = rows.iter().filter_map(|row| {
            let says = row.says.thickness.clone()?;
            Some(SpanSpec { at: row.at, says, span: row.span })
        });
        let at_rows: Vec<_> = at_rows.collect();
        let Some((word, values)) = &self.thickness else {
            return at_spans(at_rows, "a thickness", self.head, cx);
        };
        if let Some(row) = at_rows.first() {
            cx.sink.push(
                Diag::error(codes::GIVEN_TWICE, "the thickness is given for the whole blade and at a span")
                    .label(row.says.span, "given again")
                    .label(word.span, "first given here")
                    .help("keep one of them"),
            );
            return None;
        }
        Some(vec![SpanSpec { at: 0.0, says: thickness_of(word, values, cx)?, span: word.span }])
    }

    /// Reports a splitter that is not part of the main blade.
    fn is_main(&self, word: &Name, values: &[&Value], cx: &mut Context<'_>) -> Option<()> {
        let main = self.main?;
        let path = match values {
            [Value::Expr(Expr { kind: ExprKind::Path(path), .. })] => Some(path.text()),
            _ => None,
        };
        if path.as_deref() == Some(main.text.as_str()) {
            return Some(());
        }
        let at = values.first().map_or(word.span, |value| value.span());
        cx.sink.push(
            Diag::error(codes::UNKNOWN_NAME, "a splitter can be part of the main blade only")
                .label(at, format!("`{}` is expected", main.text))
                .help(format!("write `of {}`, or give the splitter angles of its own", main.text)),
        );
        None
    }

    /// Shares of the way of the main blade at which the splitter begins and ends, at hub and shroud.
    fn part_of_main(&self, cx: &mut Context<'_>) -> Option<[[f64; 2]; 2]> {
        let mut part = [[0.0; 2], [1.0; 2]];
        for (end, given) in self.ends.iter().enumerate() {
            let Some((word, values)) = given else { continue };
            for (k, expr) in hub_and_shroud(word, values, cx)?.into_iter().enumerate() {
                part[end][k] = share(expr, &format!("`{}` of a splitter", word.text), geometry::EDGE_PLACE, cx)?;
            }
        }
        for k in [0, 1] {
            self.in_order([part[0][k], part[1][k]], k, cx)?;
        }
        Some(part)
    }

    /// Reports a blade that ends before it begins.
    fn in_order(&self, [from, to]: [f64; 2], end: usize, cx: &mut Context<'_>) -> Option<()> {
        /// Least share of the way of a blade.
        const MIN_BLADE_SHARE: f64 = 0.01;
        if to - from >= MIN_BLADE_SHARE {
            return Some(());
        }
        let at = self.ends.iter().flatten().next().map_or(self.head, |(word, _)| word.span);
        let surface = ["hub", "shroud"][end];
        cx.sink.push(
            Diag::error(geometry::EDGE_PLACE, "the blade ends before it begins")
                .label(
                    at,
                    format!("at the {surface} it goes from {} % to {} %", trim(from * 100.0, 4), trim(to * 100.0, 4)),
                )
                .help("let `from` be nearer to the inlet than `to`, by 1 % or more"),
        );
        None
    }

    /// The meridional leading (0) or trailing edge (1).
    fn edge_place(&self, end: usize, cx: &mut Context<'_>) -> Option<EdgePlace> {
        let Some((word, values)) = &self.ends[end] else {
            return Some(EdgePlace::Places([MeridianPlace::Share(end as f64); 2], None));
        };
        if let [Value::Spline(spline)] = values.as_slice() {
            return Some(EdgePlace::Curve(curve(spline, cx)?));
        }
        let places = hub_and_shroud(word, values, cx)?.map(|expr| {
            let value = cx.scope.value(expr, cx.sink)?;
            if value.dimension == Dimension::LENGTH && value.value >= 0.0 {
                return Some(MeridianPlace::Length(Mm(value.value)));
            }
            share(expr, &format!("`{}`", word.text), geometry::EDGE_PLACE, cx).map(MeridianPlace::Share)
        });
        let [hub, shroud] = places;
        Some(EdgePlace::Places([hub?, shroud?], Some(word.span)))
    }
}

fn thickness_of(word: &Name, values: &[&Value], cx: &mut Context<'_>) -> Option<DistributionSpec> {
    let example = "thickness [(0 %, 1.5 mm) (40 %, 2.5 mm) (100 %, 2 mm)]";
    let given = distribution(single(word, values, cx)?, "thickness", Dimension::LENGTH, example, cx)?;
    let [thinnest, thickest] = limits::THICKNESSES;
    let wrong = given.points.iter().find(|[_, value]| !(thinnest..=thickest).contains(value));
    if let Some([at, value]) = wrong {
        cx.sink.push(
            Diag::error(geometry::THIN, "a blade cannot have this thickness")
                .label(given.span, format!("{} at {} %", Mm(*value), trim(at * 100.0, 4)))
                .help(format!("give thicknesses from {thinnest} to {thickest} mm")),
        );
        return None;
    }
    Some(given)
}

/// `elliptic 2`, `round` or `cut-off`.
fn edge_shape(p: &mut Properties<'_, '_>, edge: &str) -> Option<EdgeShape> {
    let example = format!("{edge} elliptic 2");
    let due = "`round`, `cut-off`, or `elliptic` with a number";
    let Some((word, values)) = p.take(edge) else {
        p.missing(edge, &example);
        return None;
    };
    match values.as_slice() {
        [Value::Expr(Expr { kind: ExprKind::Path(path), .. })] if path.text() == "round" => {
            Some(EdgeShape::Elliptic(1.0))
        }
        [Value::Expr(Expr { kind: ExprKind::Path(path), .. })] if path.text() == "cut-off" => Some(EdgeShape::CutOff),
        [Value::Labelled(label, ratio)] if label.text == "elliptic" => {
            let range = Range::Between(limits::RATIOS[0], limits::RATIOS[1]);
            p.value_of(ratio, edge, Dimension::NONE, range).map(EdgeShape::Elliptic)
        }
        _ => {
            let given = match values.first() {
                Some(Value::Expr(Expr { kind: ExprKind::Path(path), .. })) => path.text(),
                Some(Value::Labelled(label, _)) => label.text.clone(),
                _ => String::new(),
            };
            let near = nearest(&given, ["round", "cut-off", "elliptic"].into_iter());
            let example = match near {
                Some("elliptic") | None => example,
                Some(form) => format!("{edge} {form}"),
            };
            let example = if near == Some("round") && values.len() == 1 && given == "round" {
                format!("{example}`: the thickness of the blade gives the radius; or `{edge} elliptic 2")
            } else {
                example
            };
            p.wrong_form(values.first().map_or(word.span, |v| v.span()), edge, due, &example);
            None
        }
    }
}

/// Values at hub and shroud: one for both, or `hub 30 %, shroud 40 %`.
fn hub_and_shroud<'a>(word: &Name, values: &[&'a Value], cx: &mut Context<'_>) -> Option<[&'a Expr; 2]> {
    match values {
        [Value::Expr(both)] => Some([both, both]),
        [Value::Labelled(first, hub), Value::Labelled(second, shroud)]
            if first.text == "hub" && second.text == "shroud" =>
        {
            Some([hub, shroud])
        }
        _ => {
            cx.sink.push(
                Diag::error(codes::WRONG_FORM, format!("`{}` says where an edge is at hub and shroud", word.text))
                    .label(
                        values.first().map_or(word.span, |v| v.span()),
                        "one value, or one for hub and one for shroud",
                    )
                    .help(format!("write it like `{0} hub 30 %, shroud 40 %` or `{0} 30 %`", word.text)),
            );
            None
        }
    }
}
