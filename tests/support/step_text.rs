//! STEP files of one blade on a turned hub, made of numbers: the hub as one surface of any kind, with or without a seam and holes.

use impellerc::nurbs::{NurbsCurve, interpolate_at};
use nalgebra::Point3;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

/// The surface of a hub of which the meridian begins at the radius 20 mm and the height 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HubKind {
    Cylinder,
    Cone,
    Torus,
    Sphere,
    /// A spline turned about the axis.
    Turned,
    /// A circle moved along the axis.
    Moved,
    /// A rational spline that is closed round the axis.
    Spline,
    /// A plane across the axis, from 5 mm to 50 mm.
    Plane,
}

/// A wheel whose file is written.
#[derive(Clone, Copy, Debug)]
pub struct MadeWheel {
    pub hub: HubKind,
    /// Whether the hub has an edge along its meridian; otherwise its borders are two rings.
    pub seam: bool,
    /// Number of feet of blades that are holes of the hub.
    pub holes: usize,
    /// Share of the meridian of a place of the section, by the angle round the section.
    pub along: fn(f64) -> f64,
    /// Angle about the axis of a place of the section, by the angle round the section: 0 at the start of the hub, half a turn at its end.
    pub half: fn(f64) -> f64,
    /// Angles round the section at which both faces begin and end. Half a turn apart they meet at both.
    pub ends: [f64; 2],
    /// Whether the tips are a hole of a shroud between two rings.
    pub shroud: bool,
}

/// An oval blade that ends at its two noses, on two thirds of the meridian.
pub const OVAL: MadeWheel = MadeWheel {
    hub: HubKind::Cylinder,
    seam: true,
    holes: 0,
    along: |angle| 0.5 - angle.cos() / 3.0,
    half: |angle| 0.12 * angle.sin(),
    ends: [0.0, PI],
    shroud: false,
};

impl HubKind {
    /// Radius and height at a share of the meridian.
    pub fn at(self, s: f64) -> [f64; 2] {
        let z = 30.0 * s;
        match self {
            Self::Cylinder | Self::Moved => [20.0, z],
            Self::Cone | Self::Spline => [20.0 + 0.3 * z, z],
            Self::Torus => [50.0 - 30.0 * (0.5 * PI * s).cos(), 30.0 * (0.5 * PI * s).sin()],
            Self::Sphere => [(625.0 - (z - 15.0).powi(2)).sqrt(), z],
            Self::Turned => [20.0 + 0.02 * z * z, z],
            Self::Plane => [5.0 + 45.0 * s, 0.0],
        }
    }

    /// A place 10 mm above the meridian.
    pub fn above(self, s: f64) -> [f64; 2] {
        let ([r, z], step) = (self.at(s), 1e-6);
        let (a, b) = (self.at(s - step), self.at(s + step));
        let [dr, dz] = [b[0] - a[0], b[1] - a[1]];
        let by = 10.0 / dr.hypot(dz);
        [r + by * dz, z - by * dr]
    }
}

impl MadeWheel {
    /// A place of the section of the blade on a meridian, by the angle round it.
    fn on(&self, meridian: impl Fn(f64) -> [f64; 2], angle: f64) -> Point3<f64> {
        let [r, z] = meridian((self.along)(angle));
        let (sin, cos) = (self.half)(angle).sin_cos();
        Point3::new(r * cos, r * sin, z)
    }

    /// Root and tip of a face: the suction face from the start to the end, the pressure face against the angle.
    fn curves(&self, pressure: bool) -> [NurbsCurve; 2] {
        const STEPS: usize = 64;
        let [from, to] = self.ends;
        // Half a turn apart both faces meet; otherwise a face is between their ends.
        let [from, to] = match (pressure, to - from == PI) {
            (false, _) => [from, to],
            (true, true) => [from + TAU, to],
            (true, false) => [from + TAU, TAU - to],
        };
        let parameters: Vec<f64> = (0..=STEPS).map(|k| k as f64 / STEPS as f64).collect();
        let through = |place: &dyn Fn(f64) -> Point3<f64>| {
            let points: Vec<_> = parameters.iter().map(|share| place(from + (to - from) * share)).collect();
            interpolate_at(&parameters, &points, 3).unwrap()
        };
        [through(&|angle| self.on(|s| self.hub.at(s), angle)), through(&|angle| self.on(|s| self.hub.above(s), angle))]
    }

    /// Root and tip of the face between both faces at their end, from the suction to the pressure face on hub and tips.
    fn across(&self) -> [NurbsCurve; 2] {
        const STEPS: usize = 8;
        let (end, half) = (self.ends[1], (self.half)(self.ends[1]));
        let parameters: Vec<f64> = (0..=STEPS).map(|k| k as f64 / STEPS as f64).collect();
        let ring = |[r, z]: [f64; 2]| {
            let at = |share: &f64| {
                let (sin, cos) = (half * (1.0 - 2.0 * share)).sin_cos();
                Point3::new(r * cos, r * sin, z)
            };
            interpolate_at(&parameters, &parameters.iter().map(at).collect::<Vec<_>>(), 3).unwrap()
        };
        let s = (self.along)(end);
        [ring(self.hub.at(s)), ring(self.hub.above(s))]
    }

    /// The file. Its faces have the names `hub`, `shroud`, `pressure`, `suction` and `outlet`.
    pub fn text(&self) -> String {
        let mut text = StepText::default();
        let faces = [true, false].map(|pressure| self.curves(pressure));
        let mut blade = text.blade(&faces, &self.across());
        let hub = text.turned_face("hub", self, |s| self.hub.at(s), &blade.feet);
        if self.shroud {
            let tips = blade.tips.clone();
            let above = |s: f64| self.hub.above(s);
            blade.faces.push(text.turned_face("shroud", self, above, &[tips]));
        }
        blade.faces.push(hub);
        text.file(&blade.faces)
    }
}

/// Entities of a STEP file.
#[derive(Default)]
struct StepText {
    entities: Vec<String>,
}

/// What a blade adds.
struct MadeBlade {
    faces: Vec<usize>,
    /// Oriented edges round its foot, and round its tips.
    feet: Vec<Vec<usize>>,
    tips: Vec<usize>,
}

impl StepText {
    fn add(&mut self, text: String) -> usize {
        self.entities.push(text);
        self.entities.len()
    }

    fn point(&mut self, p: &Point3<f64>) -> usize {
        self.add(format!("CARTESIAN_POINT('',({:.12},{:.12},{:.12}))", p.x, p.y, p.z))
    }

    fn vertex(&mut self, p: &Point3<f64>) -> usize {
        let p = self.point(p);
        self.add(format!("VERTEX_POINT('',#{p})"))
    }

    /// The frame of a file at a height.
    fn frame(&mut self, z: f64) -> usize {
        let p = self.point(&Point3::new(0.0, 0.0, z));
        let [axis, across] = ["0.,0.,1.", "1.,0.,0."].map(|way| self.add(format!("DIRECTION('',({way}))")));
        self.add(format!("AXIS2_PLACEMENT_3D('',#{p},#{axis},#{across})"))
    }

    fn circle(&mut self, [r, z]: [f64; 2]) -> usize {
        let frame = self.frame(z);
        self.add(format!("CIRCLE('',#{frame},{r:.12})"))
    }

    fn line(&mut self, from: &Point3<f64>, to: &Point3<f64>) -> usize {
        let start = self.point(from);
        let way = (to - from).normalize();
        let way = self.add(format!("DIRECTION('',({:.12},{:.12},{:.12}))", way.x, way.y, way.z));
        let way = self.add(format!("VECTOR('',#{way},1.)"));
        self.add(format!("LINE('',#{start},#{way})"))
    }

    /// Points of a list, as references.
    fn points(&mut self, points: impl Iterator<Item = Point3<f64>>) -> String {
        let all: Vec<String> = points.map(|p| format!("#{}", self.point(&p))).collect();
        all.join(",")
    }

    fn spline(&mut self, curve: &NurbsCurve) -> usize {
        let points = self.points(control(curve));
        let (multiplicities, knots) = knots(curve);
        self.add(format!(
            "B_SPLINE_CURVE_WITH_KNOTS('',{},({points}),.UNSPECIFIED.,.F.,.F.,({multiplicities}),({knots}),.UNSPECIFIED.)",
            curve.degree()
        ))
    }

    /// The surface of straight lines between two curves with the same knots.
    fn ruled(&mut self, [root, tip]: &[NurbsCurve; 2]) -> usize {
        let pairs: Vec<_> = control(root).zip(control(tip)).collect();
        let rows: Vec<String> =
            pairs.into_iter().map(|(a, b)| format!("({})", self.points([a, b].into_iter()))).collect();
        let (multiplicities, knots) = knots(root);
        self.add(format!(
            "B_SPLINE_SURFACE_WITH_KNOTS('',{},1,({}),.UNSPECIFIED.,.F.,.F.,.F.,({multiplicities}),(2,2),({knots}),(0.,1.),.UNSPECIFIED.)",
            root.degree(),
            rows.join(",")
        ))
    }

    fn edge(&mut self, [from, to]: [usize; 2], curve: usize) -> usize {
        self.add(format!("EDGE_CURVE('',#{from},#{to},#{curve},.T.)"))
    }

    fn oriented(&mut self, edge: usize, along: bool) -> usize {
        self.add(format!("ORIENTED_EDGE('',*,*,#{edge},.{}.)", if along { 'T' } else { 'F' }))
    }

    fn bound(&mut self, edges: &[usize]) -> usize {
        let edges: Vec<String> = edges.iter().map(|edge| format!("#{edge}")).collect();
        let border = self.add(format!("EDGE_LOOP('',({}))", edges.join(",")));
        self.add(format!("FACE_BOUND('',#{border},.T.)"))
    }

    fn face(&mut self, name: &str, bounds: &[usize], surface: usize) -> usize {
        let bounds: Vec<String> = bounds.iter().map(|bound| format!("#{bound}")).collect();
        self.add(format!("ADVANCED_FACE('{name}',({}),#{surface},.T.)", bounds.join(",")))
    }

    /// A straight edge.
    fn straight(&mut self, [from, to]: [(usize, Point3<f64>); 2]) -> usize {
        let line = self.line(&from.1, &to.1);
        self.edge([from.0, to.0], line)
    }

    /// Pressure and suction face of curves, and where they do not meet at the end a face between them.
    fn blade(&mut self, faces: &[[NurbsCurve; 2]; 2], between: &[NurbsCurve; 2]) -> MadeBlade {
        let meet = nalgebra::distance(&faces[0][0].point(1.0), &faces[1][0].point(1.0)) < 1e-9;
        let mut corner = |p: Point3<f64>| (self.vertex(&p), p);
        let start = faces[0].each_ref().map(|curve| corner(curve.point(0.0)));
        let first = faces[0].each_ref().map(|curve| corner(curve.point(1.0)));
        let second = if meet { first } else { faces[1].each_ref().map(|curve| corner(curve.point(1.0))) };
        let nose = self.straight(start);
        let last = self.straight(first);
        let ends = [last, if meet { last } else { self.straight(second) }];
        let mut made = MadeBlade { faces: Vec::new(), feet: Vec::new(), tips: Vec::new() };
        let mut rows = Vec::new();
        for (((curves, end), corners), name) in faces.iter().zip(ends).zip([first, second]).zip(["pressure", "suction"])
        {
            let [root, tip] = [0, 1].map(|k| {
                let curve = self.spline(&curves[k]);
                self.edge([start[k].0, corners[k].0], curve)
            });
            let round =
                [(root, true), (end, true), (tip, false), (nose, false)].map(|(e, along)| self.oriented(e, along));
            let (bound, surface) = (self.bound(&round), self.ruled(curves));
            made.faces.push(self.face(name, &[bound], surface));
            rows.push([root, tip]);
        }
        let mut across = [Vec::new(), Vec::new()];
        if !meet {
            let [root, tip] = [0, 1].map(|k| {
                let curve = self.spline(&between[k]);
                self.edge([second[k].0, first[k].0], curve)
            });
            let round = [(root, true), (ends[0], true), (tip, false), (ends[1], false)];
            let round = round.map(|(e, along)| self.oriented(e, along));
            let bound = self.bound(&round);
            let surface = self.ruled(between);
            made.faces.push(self.face("outlet", &[bound], surface));
            across = [vec![(root, true)], vec![(tip, true)]];
        }
        let mut round = |k: usize| {
            let edges = [vec![(rows[1][k], true)], across[k].clone(), vec![(rows[0][k], false)]].concat();
            edges.into_iter().map(|(edge, along)| self.oriented(edge, along)).collect::<Vec<_>>()
        };
        made.feet = vec![round(0)];
        made.tips = round(1);
        made
    }

    /// A face between two rings about the axis, with holes.
    fn turned_face(
        &mut self,
        name: &str,
        wheel: &MadeWheel,
        meridian: impl Fn(f64) -> [f64; 2],
        holes: &[Vec<usize>],
    ) -> usize {
        let ends = [0.0, 1.0].map(&meridian);
        let at = ends.map(|[r, z]| Point3::new(-r, 0.0, z));
        let vertices = at.map(|p| self.vertex(&p));
        let rings = [0, 1].map(|k| {
            let circle = self.circle(ends[k]);
            self.edge([vertices[k]; 2], circle)
        });
        let [first, last] = [(rings[0], true), (rings[1], false)].map(|(e, along)| self.oriented(e, along));
        let mut bounds = if wheel.seam {
            let seam = self.seam(&meridian);
            let seam = self.edge(vertices, seam);
            let [up, down] = [true, false].map(|along| self.oriented(seam, along));
            vec![self.bound(&[first, up, last, down])]
        } else {
            vec![self.bound(&[first]), self.bound(&[last])]
        };
        let holes =
            if name == "hub" { holes.iter().take(wheel.holes).collect::<Vec<_>>() } else { holes.iter().collect() };
        for hole in holes {
            bounds.push(self.bound(hole));
        }
        let kind = if name == "hub" { wheel.hub } else { HubKind::Turned };
        let surface = self.turned(kind, &meridian);
        self.face(name, &bounds, surface)
    }

    /// A meridian as a spline in the half plane of negative x.
    fn seam(&mut self, meridian: &impl Fn(f64) -> [f64; 2]) -> usize {
        let parameters: Vec<f64> = (0..=64).map(|k| f64::from(k) / 64.0).collect();
        let points: Vec<_> = parameters.iter().map(|s| meridian(*s)).map(|[r, z]| Point3::new(-r, 0.0, z)).collect();
        self.spline(&interpolate_at(&parameters, &points, 3).unwrap())
    }

    fn turned(&mut self, kind: HubKind, meridian: &impl Fn(f64) -> [f64; 2]) -> usize {
        match kind {
            HubKind::Turned => {
                let (seam, axis) = (self.seam(meridian), self.frame(0.0));
                let origin = self.entities[axis - 1].replace("AXIS2_PLACEMENT_3D", "AXIS1_PLACEMENT");
                let (short, _) = origin.rsplit_once(',').unwrap();
                let axis = self.add(format!("{short})"));
                self.add(format!("SURFACE_OF_REVOLUTION('',#{seam},#{axis})"))
            }
            HubKind::Moved => {
                let circle = self.circle(meridian(0.0));
                let way = self.add("DIRECTION('',(0.,0.,1.))".to_owned());
                let way = self.add(format!("VECTOR('',#{way},1.)"));
                self.add(format!("SURFACE_OF_LINEAR_EXTRUSION('',#{circle},#{way})"))
            }
            HubKind::Spline => self.round_spline([0.0, 1.0].map(meridian)),
            simple => {
                let frame = self.frame(if simple == HubKind::Sphere { 15.0 } else { 0.0 });
                self.add(match simple {
                    HubKind::Cylinder => format!("CYLINDRICAL_SURFACE('',#{frame},20.)"),
                    HubKind::Cone => format!("CONICAL_SURFACE('',#{frame},20.,{:.15})", 0.3_f64.atan()),
                    HubKind::Torus => format!("TOROIDAL_SURFACE('',#{frame},50.,30.)"),
                    HubKind::Sphere => format!("SPHERICAL_SURFACE('',#{frame},25.)"),
                    _ => format!("PLANE('',#{frame})"),
                })
            }
        }
    }

    /// A cone as a rational spline of degree 2 round the axis, from (1, 0) and back.
    fn round_spline(&mut self, ends: [[f64; 2]; 2]) -> usize {
        let (mut rows, mut weights) = (Vec::new(), Vec::new());
        for k in 0..9 {
            let (sin, cos) = (f64::from(k) * PI / 4.0).sin_cos();
            let corner = k % 2 == 1;
            let out = if corner { 2.0_f64.sqrt() } else { 1.0 };
            let points = ends.map(|[r, z]| Point3::new(r * out * cos, r * out * sin, z));
            rows.push(format!("({})", self.points(points.into_iter())));
            let weight = if corner { 0.5_f64.sqrt() } else { 1.0 };
            weights.push(format!("({weight:.15},{weight:.15})"));
        }
        self.add(format!(
            "(BOUNDED_SURFACE() B_SPLINE_SURFACE(2,1,({}),.UNSPECIFIED.,.T.,.F.,.F.) \
             B_SPLINE_SURFACE_WITH_KNOTS((3,2,2,2,3),(2,2),(0.,1.,2.,3.,4.),(0.,1.),.UNSPECIFIED.) \
             GEOMETRIC_REPRESENTATION_ITEM() RATIONAL_B_SPLINE_SURFACE(({})) REPRESENTATION_ITEM('') SURFACE())",
            rows.join(","),
            weights.join(",")
        ))
    }

    fn file(&mut self, faces: &[usize]) -> String {
        let faces: Vec<String> = faces.iter().map(|face| format!("#{face}")).collect();
        let shell = self.add(format!("OPEN_SHELL('',({}))", faces.join(",")));
        let model = self.add(format!("SHELL_BASED_SURFACE_MODEL('',(#{shell}))"));
        let mm = self.add("(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.))".to_owned());
        let radian = self.add("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))".to_owned());
        let context = self.add(format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT((#{mm},#{radian})) REPRESENTATION_CONTEXT('',''))"
        ));
        self.add(format!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{model}),#{context})"));
        let mut text = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n".to_owned();
        for (k, entity) in self.entities.iter().enumerate() {
            _ = writeln!(text, "#{}={entity};", k + 1);
        }
        text + "ENDSEC;\nEND-ISO-10303-21;\n"
    }
}

fn control(curve: &NurbsCurve) -> impl Iterator<Item = Point3<f64>> {
    curve.control().iter().map(|c| Point3::from(c.xyz() / c.w))
}

/// Multiplicities and values of the knots of a curve.
fn knots(curve: &NurbsCurve) -> (String, String) {
    let mut found: Vec<(usize, f64)> = Vec::new();
    for knot in curve.knots() {
        match found.last_mut() {
            Some((count, value)) if *value == *knot => *count += 1,
            _ => found.push((1, *knot)),
        }
    }
    let list = |of: &dyn Fn(&(usize, f64)) -> String| found.iter().map(of).collect::<Vec<_>>().join(",");
    (list(&|(count, _)| count.to_string()), list(&|(_, value)| format!("{value:?}")))
}
