//! The part as a file for other programs.

use super::{Options, PartForm, Stages, or_reported, shown_path};
use crate::diag::codes::geometry;
use crate::diag::{Aborted, Diag, Sink};
use crate::export::step::StepFile;
use crate::export::three_mf::three_mf;
use crate::ir::Program;
use crate::output::Outputs;
use crate::part::shell::{Shell, ShellFault, ShellSurface, shell};
use crate::part::solid::{self, Volume};
use crate::source::SourceMap;
use crate::units::{Mm, trim};
use std::path::Path;

/// What the solid is.
const SOLID: &str = "finished part, closed by bore and back of its stock";

/// Writes the part in a form; returns a text about what was written.
///
/// # Errors
/// The part has no such form, or the file cannot be written; the reason is in the sink.
pub(super) fn write(
    options: &Options,
    form: PartForm,
    program: &Program,
    sources: &SourceMap,
    stages: &mut Stages,
    sink: &mut Sink,
) -> Result<String, Aborted> {
    let path = options.output.as_deref().unwrap_or(Path::new("part.step"));
    let mut outputs = Outputs::default();
    for file in sources.files() {
        if let Some(disk) = &file.disk {
            outputs.protect(format!("`{}`", file.name), disk);
        }
    }
    or_reported(outputs.announce("-o", path), sink)?;
    let (bytes, said) = match form {
        PartForm::Step => step(options, program, stages, sink)?,
        PartForm::Stl | PartForm::ThreeMf => triangles(options, form, program, stages, sink)?,
    };
    or_reported(outputs.stage("-o", path, &bytes).and_then(|()| outputs.commit()), sink)?;
    let lines: String = said.iter().map(|line| format!("  {line}\n")).collect();
    Ok(format!("wrote {}\n{lines}", shown_path(path)))
}

/// The STEP file, and what it holds.
fn step(
    options: &Options,
    program: &Program,
    stages: &mut Stages,
    sink: &mut Sink,
) -> Result<(Vec<u8>, Vec<String>), Aborted> {
    // Fillets are left out: not all wheels with them have passed the checks of OpenCASCADE (`docs/export.md`).
    let sharp = program.part.with_fillet(None);
    let made = stages.run("shell", || shell(&sharp, &program.stock));
    let shell = or_reported(made.map_err(|fault| no_shell(&fault, program)), sink)?;
    let volume = stages.run("volume", || solid::volume(&sharp, &program.stock));
    let said = said(&shell, volume.as_ref(), program.part.main().fillet);
    let file = StepFile { name: &program.name, description: &said, shell: &shell, protocol: options.part.protocol };
    let text = stages.run("write", || file.text());
    Ok((text.into_bytes(), said))
}

/// The file of triangles, and what it holds.
fn triangles(
    options: &Options,
    form: PartForm,
    program: &Program,
    stages: &mut Stages,
    sink: &mut Sink,
) -> Result<(Vec<u8>, Vec<String>), Aborted> {
    let chord = options.part.chord;
    let made = stages.run("mesh", || solid::mesh_within(&program.part, &program.stock, chord));
    let found = or_reported(made.ok_or_else(|| no_shell(&ShellFault::NoPatches, program)), sink)?;
    let exact = format!("chord error {:.2} um, at most {} um allowed", found.error * 1e3, trim(chord * 1e3, 3));
    let size = format!(
        "{} triangles, {} vertices, closed, volume {:.3} mm3",
        found.mesh.triangles.len(),
        found.mesh.vertices.len(),
        found.mesh.volume()
    );
    let bytes = stages.run("write", || match form {
        PartForm::ThreeMf => three_mf(&found.mesh, &program.name, &format!("{SOLID}; {exact}")),
        _ => found.mesh.stl(&format!("{}, {exact}", program.name)),
    });
    Ok((bytes, vec![SOLID.to_owned(), size, exact]))
}

/// What the solid is and how exact it is, a line each.
fn said(shell: &Shell, volume: Option<&Volume>, fillet: Option<Mm>) -> Vec<String> {
    let without =
        fillet.map(|radius| format!("; without its fillets of {radius}: the roots are sharp")).unwrap_or_default();
    let mut lines = vec![
        format!("{SOLID}{without}"),
        format!("{} faces, {} edges, {} vertices", shell.faces.len(), shell.edges.len(), shell.vertices.len()),
        kinds(shell),
        format!("spline surfaces within {:.1e} mm of the design surfaces where compared", shell.error),
    ];
    if let Some(volume) = volume {
        lines.push(format!(
            "volume of the design surfaces {:.6} mm3, error below {:.1e} mm3",
            volume.value, volume.error
        ));
    }
    lines
}

/// How many faces there are of each kind.
fn kinds(shell: &Shell) -> String {
    let count = |is: fn(&ShellSurface) -> bool| shell.faces.iter().filter(|face| is(&face.surface)).count();
    let splines = count(|s| matches!(s, ShellSurface::Spline(_)));
    let planes = count(|s| matches!(s, ShellSurface::Plane { .. }));
    let cylinders = count(|s| matches!(s, ShellSurface::Cylinder { .. }));
    format!("{splines} splines, {planes} planes, {cylinders} cylinders")
}

/// Why the part has no closed shell.
fn no_shell(fault: &ShellFault, program: &Program) -> Diag {
    let diag = |reason: String| {
        Diag::error(geometry::NO_SHELL, format!("the part has no closed surface: {reason}"))
            .label(program.name_span, "this part cannot be written")
    };
    match fault {
        ShellFault::NoPatches => diag(
            "blades with rounded edges, splitters, and fillets that do not reach both ends are not built yet"
                .to_owned(),
        ),
        ShellFault::NotNear(kind, distance) => {
            diag(format!("{} is off its spline by {distance:.1e} mm", kind.in_sectors(&[0])))
        }
        ShellFault::Open(kind) => diag(format!("a border of {} meets no other", kind.in_sectors(&[0]))),
        ShellFault::NotClosedByStock => diag("bore and back of the stock do not close it".to_owned())
            .help("state a back face below the hub, and a bore smaller than the inlet of the hub"),
    }
}
