//! The operation `plunge`: strokes along the tool axis, with the tools that can make them.

use super::{OperationReader, allowances};
use crate::block::properties::{Properties, Range};
use crate::model::{CutterKind, OperationKind, ToolSpec};
use crate::property::limits;
use crate::property::quantity::Dimension;
use crate::vocabulary::operations::STROKE_STEP;
use base::units::{Mm, length, trim};
use diagnostics::Diag;
use diagnostics::codes::job as codes;
use wheel::operation::RoughingStrategy;

/// Default of the distance of neighbouring strokes, as a share of the diameter, where the tool permits it.
const USUAL_STEP: f64 = 0.25;

impl OperationReader<'_> {
    /// The properties of a `plunge` operation.
    pub(super) fn plunge(&self, tool: Option<&ToolSpec>, p: &mut Properties<'_, '_>) -> Option<OperationKind> {
        let allowances = allowances(p);
        let stepover = self.plunge_step(tool, p);
        let strategy = RoughingStrategy::Plunge { stepover: stepover? };
        Some(OperationKind::Roughing { allowances: allowances?, strategy })
    }

    /// The distance of neighbouring strokes that the job gives, within what the tool permits, or its default.
    fn plunge_step(&self, tool: Option<&ToolSpec>, p: &mut Properties<'_, '_>) -> Option<Mm> {
        let tool = tool?;
        let (diameter, most) = (tool.diameter.get(), tool.largest_plunge_step()?);
        let [least, widest] = limits::STROKE_STEP.map(|share| share * diameter);
        if most < least {
            p.sink.push(
                Diag::error(codes::PLUNGE, format!("{} cannot plunge: its teeth do not cut at its centre", tool.name))
                    .label(tool.span, self.cuts(tool))
                    .note("the middle of its end would stand on the stock that its teeth leave")
                    .help(centre(tool)),
            );
            return None;
        }
        if !p.has(STROKE_STEP.name) {
            return Some(Mm(most.min(USUAL_STEP * diameter)));
        }
        let expr = p.expression_of(&STROKE_STEP)?;
        let step = p.value_of(expr, STROKE_STEP.name, Dimension::LENGTH, Range::Between(least, widest))?;
        // Room for rounding where the job states the limit itself.
        if step <= most * (1.0 + 1e-9) {
            return Some(Mm(step));
        }
        p.sink.push(
            Diag::error(
                codes::PLUNGE,
                format!("the strokes of {} would take the middle of {} into full material", self.name, tool.name),
            )
            .label(expr.span, format!("the limit is {}", length(most)))
            .label(tool.span, self.cuts(tool))
            .note(
                "each stroke may move in by the flat part of what the teeth cut, so that the rest of the end is in air",
            )
            .help(format!(
                "use `stepover {}` or less; or, {}",
                Mm((most * 1e4).floor() / 1e4),
                centre(tool)
            )),
        );
        None
    }

    /// What the teeth of a tool cut, for a label.
    fn cuts(&self, tool: &ToolSpec) -> String {
        let width = tool.plunge_width().map_or(0.0, Mm::get);
        let source = if tool.limits.plunge.is_some() { "" } else { " by default" };
        let corner = match tool.kind {
            CutterKind::Flat => String::new(),
            _ => format!(
                ", {} of it the corner",
                tool.kind.corner(0.5 * tool.diameter.get()).map_or_else(String::new, length)
            ),
        };
        format!("its teeth cut {} from the rim{source}{corner}", length(width))
    }
}

/// What a job says of a tool that cuts at its centre.
fn centre(tool: &ToolSpec) -> String {
    let radius = trim(0.5 * tool.diameter.get(), 4);
    format!("where the teeth of the tool meet at its centre, state `plunge-width {radius} mm` of the tool")
}
