//! STEP files (ISO 10303-21) of a closed shell: one solid with NURBS faces, planes and cylinders that share their edges.
//!
//! Faces and edges are named as in reports. Lengths are in mm. The file has no curves in parameters: the border of a spline face
//! is the border of its surface.

use nalgebra::Point3;
use nurbs::NurbsCurve;
use std::fmt::Write;
use wheel::part::shell::{EdgeCurve, OrientedEdge, Shell, ShellFace, ShellSurface};

/// Application protocol of a STEP file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepProtocol {
    /// Managed model-based 3D engineering, ISO 10303-242.
    #[default]
    Ap242,
    /// Automotive design, ISO 10303-214.
    Ap214,
}

impl StepProtocol {
    /// Schema of the header, name of the application, and name and year of its protocol.
    fn names(self) -> [&'static str; 4] {
        match self {
            Self::Ap242 => [
                "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }",
                "managed model based 3d engineering",
                "ap242_managed_model_based_3d_engineering",
                "2014",
            ],
            Self::Ap214 => [
                "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }",
                "core data for automotive mechanical design processes",
                "automotive_design",
                "2000",
            ],
        }
    }
}

/// Distance within which the file states that points are the same, mm.
const POINT_ACCURACY: f64 = 1e-6;

/// Time stamp of every file: the format demands one, and the same job must give the same bytes.
const TIME_STAMP: &str = "2000-01-01T00:00:00";

/// A STEP file.
pub struct StepFile<'a> {
    /// Name of the part.
    pub name: &'a str,
    /// What the solid is and how exact it is, a line each.
    pub description: &'a [String],
    /// The solid.
    pub shell: &'a Shell,
    /// Protocol.
    pub protocol: StepProtocol,
}

impl StepFile<'_> {
    /// The text of the file.
    pub fn text(&self) -> String {
        let [schema, ..] = self.protocol.names();
        let name = string(self.name);
        let lines: Vec<String> = self.description.iter().map(|line| string(line)).collect();
        let system = string(concat!("impellerc ", env!("CARGO_PKG_VERSION")));
        let mut out = format!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(({}),'2;1');\nFILE_NAME({name},'{TIME_STAMP}',(''),(''),{system},{system},'');\n\
             FILE_SCHEMA(('{schema}'));\nENDSEC;\nDATA;\n",
            lines.join(",\n")
        );
        let mut data = StepEntities::default();
        let solid = data.solid(self.shell, &name);
        self.product(&mut data, solid, &name);
        out.push_str(&data.text);
        out.push_str("ENDSEC;\nEND-ISO-10303-21;\n");
        out
    }

    /// The product that has the solid as its shape, with its units.
    fn product(&self, data: &mut StepEntities, solid: usize, name: &str) {
        let [_, application, protocol, year] = self.protocol.names();
        let length = data.add("(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.))");
        let angle = data.add("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))");
        let solid_angle = data.add("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())");
        let accuracy = data.add(&format!(
            "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#{length},'distance_accuracy_value','edges')",
            real(POINT_ACCURACY)
        ));
        let context = data.add(&format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{accuracy})) \
             GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid_angle})) REPRESENTATION_CONTEXT('part','3D'))"
        ));
        let frame = data.placement(0.0);
        let shape = data.add(&format!("ADVANCED_BREP_SHAPE_REPRESENTATION({name},(#{frame},#{solid}),#{context})"));
        let application = data.add(&format!("APPLICATION_CONTEXT('{application}')"));
        data.add(&format!(
            "APPLICATION_PROTOCOL_DEFINITION('international standard','{protocol}',{year},#{application})"
        ));
        let product_context = data.add(&format!("PRODUCT_CONTEXT('',#{application},'mechanical')"));
        let product = data.add(&format!("PRODUCT({name},{name},'',(#{product_context}))"));
        data.add(&format!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))"));
        let formation = data.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
        let design = data.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"));
        let definition = data.add(&format!("PRODUCT_DEFINITION('design','',#{formation},#{design})"));
        let of_product = data.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
        data.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{of_product},#{shape})"));
    }
}

/// The entities of a file.
#[derive(Default)]
struct StepEntities {
    text: String,
    count: usize,
}

impl StepEntities {
    /// Adds an entity and returns its number.
    fn add(&mut self, entity: &str) -> usize {
        self.count += 1;
        let _ = writeln!(self.text, "#{}={entity};", self.count);
        self.count
    }

    fn point(&mut self, p: &Point3<f64>) -> usize {
        self.add(&format!("CARTESIAN_POINT('',({},{},{}))", real(p.x), real(p.y), real(p.z)))
    }

    /// The frame of the part at a height.
    fn placement(&mut self, z: f64) -> usize {
        let origin = self.point(&Point3::new(0.0, 0.0, z));
        let up = self.add("DIRECTION('',(0.,0.,1.))");
        let across = self.add("DIRECTION('',(1.,0.,0.))");
        self.add(&format!("AXIS2_PLACEMENT_3D('',#{origin},#{up},#{across})"))
    }

    fn solid(&mut self, shell: &Shell, name: &str) -> usize {
        let points: Vec<usize> = shell.vertices.iter().map(|p| self.point(p)).collect();
        let vertices: Vec<usize> = points.iter().map(|p| self.add(&format!("VERTEX_POINT('',#{p})"))).collect();
        let mut edges = Vec::with_capacity(shell.edges.len());
        for edge in &shell.edges {
            let ends = edge.ends.map(|v| &shell.vertices[v]);
            let curve = match &edge.curve {
                EdgeCurve::Spline(curve) => self.curve(curve, edge.ends.map(|v| points[v])),
                EdgeCurve::Circle { z, radius } => {
                    let frame = self.placement(*z);
                    self.add(&format!("CIRCLE('',#{frame},{})", real(*radius)))
                }
                EdgeCurve::Line => {
                    let along = ends[1] - ends[0];
                    let unit = along.normalize();
                    let (x, y, z) = (real(unit.x), real(unit.y), real(unit.z));
                    let direction = self.add(&format!("DIRECTION('',({x},{y},{z}))"));
                    let vector = self.add(&format!("VECTOR('',#{direction},{})", real(along.norm())));
                    self.add(&format!("LINE('',#{},#{vector})", points[edge.ends[0]]))
                }
            };
            let [from, to] = edge.ends.map(|v| vertices[v]);
            edges.push(self.add(&format!("EDGE_CURVE('',#{from},#{to},#{curve},.T.)")));
        }
        let faces: Vec<String> = shell.faces.iter().map(|face| format!("#{}", self.face(face, &edges))).collect();
        let closed = self.add(&format!("CLOSED_SHELL('',({}))", faces.join(",")));
        self.add(&format!("MANIFOLD_SOLID_BREP({name},#{closed})"))
    }

    /// A spline that ends at vertices.
    fn curve(&mut self, curve: &NurbsCurve, ends: [usize; 2]) -> usize {
        let control = curve.control();
        let last = control.len() - 1;
        let mut points = vec![ends[0]];
        points.extend(control[1..last].iter().map(|c| self.point(&Point3::from(c.xyz()))));
        points.push(ends[1]);
        let (multiplicities, knots) = knots(curve.knots());
        self.add(&format!(
            "B_SPLINE_CURVE_WITH_KNOTS('',{},({}),.UNSPECIFIED.,.F.,.F.,{multiplicities},{knots},.UNSPECIFIED.)",
            curve.degree(),
            numbers(&points),
        ))
    }

    fn face(&mut self, face: &ShellFace, edges: &[usize]) -> usize {
        let surface = match &face.surface {
            ShellSurface::Spline(surface) => {
                let [_, columns] = surface.counts();
                let points: Vec<usize> = surface.control().iter().map(|c| self.point(&Point3::from(c.xyz()))).collect();
                let rows: Vec<String> = points.chunks(columns).map(|row| format!("({})", numbers(row))).collect();
                let [degree_u, degree_v] = surface.degree();
                let [(mu, ku), (mv, kv)] = surface.knots().each_ref().map(|k| knots(k));
                self.add(&format!(
                    "B_SPLINE_SURFACE_WITH_KNOTS('',{degree_u},{degree_v},({}),.UNSPECIFIED.,.F.,.F.,.F.,{mu},{mv},{ku},{kv},.UNSPECIFIED.)",
                    rows.join(",\n")
                ))
            }
            ShellSurface::Plane { z } => {
                let frame = self.placement(*z);
                self.add(&format!("PLANE('',#{frame})"))
            }
            ShellSurface::Cylinder { radius } => {
                let frame = self.placement(0.0);
                self.add(&format!("CYLINDRICAL_SURFACE('',#{frame},{})", real(*radius)))
            }
        };
        let mut bounds = Vec::new();
        for (k, border) in face.borders.iter().enumerate() {
            let edges: Vec<usize> = border
                .iter()
                .map(|OrientedEdge { edge, along }| {
                    self.add(&format!("ORIENTED_EDGE('',*,*,#{},{})", edges[*edge], logical(*along)))
                })
                .collect();
            let edges = self.add(&format!("EDGE_LOOP('',({}))", numbers(&edges)));
            let bound = if k == 0 { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
            bounds.push(self.add(&format!("{bound}('',#{edges},.T.)")));
        }
        let name = string(&face.id.to_string());
        self.add(&format!("ADVANCED_FACE({name},({}),#{surface},{})", numbers(&bounds), logical(face.outward)))
    }
}

/// Multiplicities and values of knots as lists.
fn knots(knots: &[f64]) -> (String, String) {
    let runs: Vec<&[f64]> = knots.chunk_by(|a, b| a == b).collect();
    let multiplicities: Vec<String> = runs.iter().map(|run| run.len().to_string()).collect();
    let values: Vec<String> = runs.iter().map(|run| exact(run[0])).collect();
    (format!("({})", multiplicities.join(",")), format!("({})", values.join(",")))
}

fn numbers(of: &[usize]) -> String {
    of.iter().map(|n| format!("#{n}")).collect::<Vec<_>>().join(",")
}

fn logical(value: bool) -> &'static str {
    if value { ".T." } else { ".F." }
}

/// A coordinate, rounded to 1e-9 mm.
fn real(x: f64) -> String {
    let text = format!("{x:.9}");
    let text = text.trim_end_matches('0');
    if text == "-0." { "0.".to_owned() } else { text.to_owned() }
}

/// A number with all its digits.
fn exact(x: f64) -> String {
    let text = format!("{x}");
    if text.contains('.') { text } else { format!("{text}.") }
}

/// A string: an apostrophe is written twice, and what is not printable ASCII by its code points.
fn string(text: &str) -> String {
    let mut out = String::from("'");
    for c in text.chars() {
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            ' '..='~' => out.push(c),
            _ => {
                let _ = write!(out, "\\X4\\{:08X}\\X0\\", c as u32);
            }
        }
    }
    out.push('\'');
    out
}
