//! Forms of the part for other programs, a row each, and what makes their files.

use super::{Stages, or_reported, section_files};
use ::report::step::{StepFile, StepProtocol};
use ::report::three_mf::three_mf;
use ::report::turbogrid::turbogrid;
use base::units::trim;
use diagnostics::codes::{files, geometry};
use diagnostics::{Aborted, Diag, Sink};
use ir::Program;
use std::path::{Path, PathBuf};
use tool_stock::stock::Mesh;
use wheel::part::blade_loops::blade_loops;
use wheel::part::shell::{PatchFault, Shell, ShellFault, ShellSurface, shell};
use wheel::part::solid::{self, Volume};
use wheel::part::{Part, SurfaceKind};

/// How the part is written for other programs.
#[derive(Clone, Copy, Debug)]
pub struct PartOptions {
    /// Protocol of a STEP file.
    pub protocol: StepProtocol,
    /// Largest chord error of triangles, mm.
    pub chord: f64,
    /// Number of sections of a blade.
    pub sections: usize,
}

impl Default for PartOptions {
    fn default() -> Self {
        Self { protocol: StepProtocol::default(), chord: 0.01, sections: 11 }
    }
}

/// A form of the part for other programs.
#[derive(Debug)]
pub struct PartForm {
    /// Name.
    pub name: &'static str,
    /// What is written.
    pub help: &'static str,
    /// Endings of its files.
    pub(super) endings: &'static [&'static str],
    /// What its file is.
    pub(super) file: &'static str,
    pub(super) make: fn(&mut Source<'_>) -> Result<PartFiles, Aborted>,
}

impl PartialEq for PartForm {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for PartForm {}

/// The forms of the part.
pub(super) const PART_FORMS: &[PartForm] = &[
    PartForm {
        name: "step",
        help: "The part as a solid in a STEP file, which `-o` names",
        endings: &["step", "stp", "p21"],
        file: "a STEP file",
        make: step,
    },
    PartForm {
        name: "stl",
        help: "The part as triangles in an STL file, which `-o` names",
        endings: &["stl"],
        file: "an STL file",
        make: |source| triangles(source, |mesh, name, said| mesh.stl(&format!("{name}, {said}"))),
    },
    PartForm {
        name: "3mf",
        help: "The part as triangles in a 3MF file, which `-o` names",
        endings: &["3mf"],
        file: "a 3MF file",
        make: |source| triangles(source, |mesh, name, said| three_mf(mesh, name, &format!("{SOLID}; {said}"))),
    },
    PartForm {
        name: "sections",
        help: "Sections of the blades for TurboGrid: the `.inf` file that `-o` names, with files of hub, shroud and profiles beside it",
        endings: &["inf"],
        file: "the `.inf` file of sections",
        make: sections,
    },
];

/// What a form of the part is made of.
pub(super) struct Source<'a> {
    pub(super) options: PartOptions,
    pub(super) path: &'a Path,
    pub(super) program: &'a Program,
    pub(super) stages: &'a mut Stages,
    pub(super) sink: &'a mut Sink,
}

/// What the solid is.
const SOLID: &str = "finished part, closed by bore and back of its stock";

/// Files with their paths, and what they hold.
pub(super) struct PartFiles {
    pub(super) files: Vec<(PathBuf, Vec<u8>)>,
    /// A line each.
    pub(super) said: Vec<String>,
}

/// The files of the sections, and what they hold.
fn sections(source: &mut Source<'_>) -> Result<PartFiles, Aborted> {
    let Source { options, path, program, stages, sink } = source;
    let part = &program.part;
    let made = stages.run("sections", || blade_loops(part, options.sections));
    let blades = or_reported(made.map_err(|fault| no_shell(&ShellFault::Patches(fault), program)), sink)?;
    let (beside, names) = section_files::places(path);
    let files =
        turbogrid(part, &blades, &names, &format!("{} by impellerc {}", program.name, env!("CARGO_PKG_VERSION")));
    let read = or_reported(stages.run("read back", || section_files::read_back(&files, &names)), sink)?;
    let near = stages.run("compare", || section_files::distance_between(part, &blades, &read));
    let count = blades.first().map_or(0, |blade| blade.loops.len());
    let points = blades.first().and_then(|blade| Some(blade.loops.first()?.len())).unwrap_or(0);
    let mut said = vec![
        format!(
            "{} blades in each of {} sectors, {count} sections of {points} points each",
            blades.len(),
            part.vane_count
        ),
        "equal steps up each ruling from hub to shroud; without fillets".to_owned(),
    ];
    for blade in &blades {
        let form = |end: usize| if blade.rounded[end] { "round" } else { "cut off: two corners" };
        let name = &part.blade(blade.blade).name;
        said.push(format!("{name}: leading edge {}, trailing edge {}", form(0), form(1)));
    }
    said.push(match near {
        Some(distance) => {
            format!("read back, surfaces through the sections are within {distance:.1e} mm of the part between them")
        }
        None => {
            "read back, the sections do not divide into faces and edges: state the edges where they are read".to_owned()
        }
    });
    let texts = [files.hub, files.shroud, files.profile];
    let mut written = vec![(path.to_path_buf(), files.index.into_bytes())];
    written.extend(beside.into_iter().zip(texts).map(|(path, text)| (path, text.into_bytes())));
    Ok(PartFiles { files: written, said })
}

/// Share of the volume within which the text of a STEP file states it: programs that read the file are compared with it.
const VOLUME_SHARE: f64 = 1e-7;

/// Most blades of a STEP file. Each takes some 6 MB of memory while the file is made, so these take 1.8 GB.
const MAX_BLADES_IN_STEP: usize = 300;

/// Refuses a wheel with too many blades for a STEP file.
fn fits_step(program: &Program) -> Result<(), Diag> {
    let sectors = usize::try_from(program.part.vane_count).unwrap_or(usize::MAX);
    let count = sectors.saturating_mul(program.part.blades.len());
    if count <= MAX_BLADES_IN_STEP {
        return Ok(());
    }
    Err(Diag::error(files::CANNOT_WRITE, format!("a STEP file of {count} blades is not written"))
        .label(program.name_span, format!("at most {MAX_BLADES_IN_STEP} blades, with splitters, are written"))
        .help("write `--emit stl` or `--emit sections`, or a part with fewer `vanes`: all sectors are alike"))
}

/// The STEP file, and what it holds.
fn step(source: &mut Source<'_>) -> Result<PartFiles, Aborted> {
    let Source { options, path, program, stages, sink } = source;
    or_reported(fits_step(program), sink)?;
    // Fillets are left out: not all wheels with them have passed the checks of OpenCASCADE (`docs/export.md`).
    let sharp = program.part.without_fillets();
    let made = stages.run("shell", || shell(&sharp, &program.stock));
    let shell = or_reported(made.map_err(|fault| no_shell(&fault, program)), sink)?;
    let volume = stages.run("volume", || solid::volume(&sharp, &program.stock, VOLUME_SHARE));
    let said = said(&shell, volume.as_ref(), &program.part);
    let file = StepFile { name: &program.name, description: &said, shell: &shell, protocol: options.protocol };
    let text = stages.run("write", || file.text());
    Ok(PartFiles { files: vec![(path.to_path_buf(), text.into_bytes())], said })
}

/// The file of triangles, and what it holds. `bytes` makes it of the mesh, the name of the part and what is said of its error.
fn triangles(source: &mut Source<'_>, bytes: fn(&Mesh, &str, &str) -> Vec<u8>) -> Result<PartFiles, Aborted> {
    let Source { options, path, program, stages, sink } = source;
    let chord = options.chord;
    let made = stages.run("mesh", || solid::mesh_within(&program.part, &program.stock, chord));
    let found = or_reported(made.map_err(|fault| no_shell(&fault, program)), sink)?;
    let exact = format!("chord error {:.2} um, at most {} um allowed", found.error * 1e3, trim(chord * 1e3, 3));
    let size = format!(
        "{} triangles, {} vertices, closed, volume {:.3} mm3",
        found.mesh.triangles.len(),
        found.mesh.vertices.len(),
        found.mesh.volume()
    );
    let bytes = stages.run("write", || bytes(&found.mesh, &program.name, &exact));
    Ok(PartFiles { files: vec![(path.to_path_buf(), bytes)], said: vec![SOLID.to_owned(), size, exact] })
}

/// What the solid is and how exact it is, a line each.
fn said(shell: &Shell, volume: Option<&Volume>, part: &Part) -> Vec<String> {
    let mut radii: Vec<String> =
        part.blades.iter().filter_map(|blade| Some(blade.fillet.as_ref()?.to_string())).collect();
    radii.dedup();
    let without = match radii.as_slice() {
        [] => String::new(),
        radii => format!("; without its fillets of {}: the roots are sharp", radii.join(", ")),
    };
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
    let name = |kind: &SurfaceKind| kind.in_sectors(&[0]);
    match fault {
        ShellFault::Patches(PatchFault::Fillet(kind)) => {
            diag(format!("the fillet of {} does not reach both of its ends", name(kind)))
                .help("state a smaller fillet, or write STEP, which has no fillets")
        }
        ShellFault::Patches(PatchFault::Gap(kind, distance)) => {
            diag(format!("{} leaves the end of a face by {distance:.1e} mm", name(kind)))
        }
        ShellFault::Patches(PatchFault::Folded(kind)) => {
            diag(format!("lines between the borders of {} cross each other", name(kind)))
                .help("its blades end too near to each other or to the ends of hub or shroud")
        }
        ShellFault::NoSpline(kind) => diag(format!("no spline runs through the points of {}", name(kind))),
        ShellFault::NotNear(kind, distance) => {
            diag(format!("{} is off its surface in the file by {distance:.1e} mm with the most points", name(kind)))
        }
        ShellFault::Open(kind) => diag(format!("a border of {} meets no other", name(kind))),
        ShellFault::NotClosedByStock => diag("bore and back of the stock do not close it".to_owned())
            .help("state a back face below the hub, and a bore smaller than the inlet of the hub"),
    }
}
