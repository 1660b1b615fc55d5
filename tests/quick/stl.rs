//! Solids from STL files: the reader, and rays through them.

use impellerc::base::source::SourceMap;
use impellerc::diagnostics::{Sink, codes, render};
use impellerc::job::{InMemory, resolve};
use impellerc::syntax::parse;
use impellerc::tool_stock::stock::stl::{MAX_TRIANGLES, StlFault, read};
use impellerc::tool_stock::stock::{Field, Mesh};
use nalgebra::{Point3, Rotation3, Vector3};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

/// A cylinder around the solids of these tests. Rays of cells of 1 mm run at odd halves of a millimetre.
const AROUND: [[f64; 2]; 4] = [[0.0, -20.0], [25.0, -20.0], [25.0, 20.0], [0.0, 20.0]];

fn field(mesh: &Mesh, cell: f64) -> Field {
    Field::new(&AROUND, Some(mesh), cell).expect("a field")
}

/// Rows of points on a sphere, closed at both poles, with a radius for each.
fn ball(rows: u32, around: u32, radius: impl Fn(u32, u32) -> f64) -> Mesh {
    let direction = |i: u32, j: u32| {
        let (polar, azimuth) = (PI * f64::from(i) / f64::from(rows), TAU * f64::from(j) / f64::from(around));
        Vector3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos())
    };
    let mut vertices =
        vec![Point3::from(direction(0, 0) * radius(0, 0)), Point3::from(direction(rows, 0) * radius(rows, 0))];
    for i in 1..rows {
        vertices.extend((0..around).map(|j| Point3::from(direction(i, j) * radius(i, j))));
    }
    let at = |i: u32, j: u32| match i {
        0 => 0,
        i if i == rows => 1,
        i => 2 + (i - 1) * around + j % around,
    };
    let mut triangles = Vec::new();
    for i in 0..rows {
        for j in 0..around {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles
                .extend([[a, b, c], [a, c, d]].into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
        }
    }
    Mesh { vertices, triangles }
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    let corner = |n: usize| Point3::from([0, 1, 2].map(|k| if n >> k & 1 == 0 { low[k] } else { high[k] }));
    let quads: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh { vertices: (0..8).map(corner).collect(), triangles }
}

/// A prism along Z with corners on a circle.
fn prism(corners: u32, radius: f64, [bottom, top]: [f64; 2]) -> Mesh {
    let ring = |z: f64| (0..corners).map(move |k| (TAU * f64::from(k) / f64::from(corners), z));
    let mut vertices: Vec<Point3<f64>> =
        ring(bottom).chain(ring(top)).map(|(t, z)| Point3::new(radius * t.cos(), radius * t.sin(), z)).collect();
    vertices.extend([Point3::new(0.0, 0.0, bottom), Point3::new(0.0, 0.0, top)]);
    let mut triangles = Vec::new();
    for k in 0..corners {
        let (a, b) = (k, (k + 1) % corners);
        let (c, d) = (a + corners, b + corners);
        triangles.extend([[a, b, d], [a, d, c], [2 * corners, b, a], [2 * corners + 1, c, d]]);
    }
    Mesh { vertices, triangles }
}

fn turned(mesh: &Mesh, by: &Rotation3<f64>) -> Mesh {
    Mesh { vertices: mesh.vertices.iter().map(|p| by * p).collect(), triangles: mesh.triangles.clone() }
}

/// How often the mesh surrounds a point: the sum of the solid angles of its triangles (Van Oosterom and Strackee 1983).
fn winding(mesh: &Mesh, p: &Point3<f64>) -> f64 {
    let angle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.vertices[i as usize] - p);
        let [x, y, z] = [a.norm(), b.norm(), c.norm()];
        2.0 * a.dot(&b.cross(&c)).atan2(x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y)
    };
    mesh.triangles.iter().map(angle).sum::<f64>() / (4.0 * PI)
}

/// True when a point lies in a triangle, so that the triangles from it to the sides have the same area together.
fn on_surface(mesh: &Mesh, p: &Point3<f64>) -> bool {
    mesh.triangles.iter().any(|t| {
        let [a, b, c] = t.map(|i| mesh.vertices[i as usize] - p);
        let parts = a.cross(&b).norm() + b.cross(&c).norm() + c.cross(&a).norm();
        parts - (b - a).cross(&(c - a)).norm() < 1e-9
    })
}

#[test]
fn rays_through_faces_edges_and_corners_of_a_box() {
    // Every face lies in a plane of rays, every edge on a ray, every corner on three.
    for (low, high) in [([-3.5, 2.5, -4.5], [6.5, 9.5, 7.5]), ([-10.5; 3], [10.5; 3])] {
        let mesh = cuboid(low, high);
        let size: Vec<f64> = (0..3).map(|k| high[k] - low[k]).collect();
        let field = field(&mesh, 1.0);
        for volume in field.volumes() {
            assert!((volume - size[0] * size[1] * size[2]).abs() < 1e-9, "{volume}");
        }
        for axis in 0..3 {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
            for i in 0..field.cells()[u] {
                for j in 0..field.cells()[v] {
                    let (a, b) = (field.centre(u, i), field.centre(v, j));
                    let within = |x: f64, k: usize| low[k] <= x && x < high[k];
                    let due = if within(a, u) && within(b, v) { vec![[low[axis], high[axis]]] } else { Vec::new() };
                    assert_eq!(field.intervals(axis, i, j), due, "axis {axis} at {a} {b}");
                }
            }
        }
    }
}

#[test]
fn rays_through_a_prism_are_its_chords() {
    for (corners, cell) in [(4, 1.0), (5, 0.7), (64, 0.5)] {
        let (radius, heights) = (12.5, [-10.5, 9.5]);
        let mesh = prism(corners, radius, heights);
        let field = field(&mesh, cell);
        let [count, _, levels] = field.cells();
        let mut seen = 0;
        // Chord along X: the line within the half planes of all sides.
        for j in 0..count {
            let y = field.centre(1, j);
            let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
            for k in 0..corners {
                let normal = TAU * (f64::from(k) + 0.5) / f64::from(corners);
                let left = radius * (PI / f64::from(corners)).cos() - y * normal.sin();
                match normal.cos() {
                    c if c.abs() < 1e-12 && left < 0.0 => to = f64::NEG_INFINITY,
                    c if c > 1e-12 => to = to.min(left / c),
                    c if c < -1e-12 => from = from.max(left / c),
                    _ => {}
                }
            }
            for k in 0..levels {
                let z = field.centre(2, k);
                let mut found = field.intervals(0, j, k);
                // Through a corner alone, rounding may leave a trace.
                found.retain(|[a, b]| b - a > 1e-9);
                let inside = (heights[0]..heights[1]).contains(&z) && to - from > 1e-9;
                assert_eq!(found.len(), usize::from(inside), "at {y} {z}");
                for [a, b] in found {
                    assert!((a - from).abs() < 1e-9 && (b - to).abs() < 1e-9, "{a} {b} instead of {from} {to}");
                    seen += 1;
                }
            }
        }
        assert!(seen > 300, "{seen}");
        let due = 0.5 * f64::from(corners) * (TAU / f64::from(corners)).sin() * radius.powi(2) * 20.0;
        assert!((mesh.volume() - due).abs() < 1e-9 * due);
        assert!((field.volume() - due).abs() < 0.01 * due, "{} {due}", field.volume());
    }
}

#[test]
fn rays_agree_with_volume_and_solid_angles_of_ragged_solids() {
    for seed in 0..8_u32 {
        let noise = |i: u32, j: u32| f64::from((i * 7919 + j * 104_729 + seed * 1_299_709) % 1013) / 1013.0;
        let mut mesh = ball(9, 14, |i, j| 8.0 + 8.0 * noise(i, j));
        if seed % 2 == 0 {
            // Corners on rays.
            mesh.vertices.iter_mut().for_each(|p| *p = p.map(|x| x.floor() + 0.5));
        }
        let field = field(&mesh, 1.0);
        let due = mesh.volume();
        for volume in field.volumes() {
            assert!((volume - due).abs() < 0.02 * due, "seed {seed}: {volume} instead of {due}");
        }
        let (mut inside, mut seen) = (0, 0);
        let [x, y, z] = field.cells();
        for n in (0..x * y * z).step_by(29) {
            let at = [n % x, n / x % y, n / x / y];
            let p = Point3::from([0, 1, 2].map(|k| field.centre(k, at[k])));
            let wound = winding(&mesh, &p);
            // On the surface a point is neither inside nor outside.
            if on_surface(&mesh, &p) {
                continue;
            }
            assert!((wound - wound.round()).abs() < 1e-9, "seed {seed}: {wound} around {p}");
            for axis in 0..3 {
                let ray = field.intervals(axis, at[(axis + 1) % 3], at[(axis + 2) % 3]);
                let found = ray.iter().any(|[a, b]| (*a..*b).contains(&p[axis]));
                assert_eq!(found, wound > 0.5, "seed {seed}, axis {axis}, {p}");
            }
            (inside, seen) = (inside + usize::from(wound > 0.5), seen + 1);
        }
        assert!(inside > 50 && seen > 3000, "{inside} {seen}");
    }
}

#[test]
fn hollow_nested_and_overlapping_shells() {
    let join = |a: &Mesh, b: &Mesh| {
        let first = u32::try_from(a.vertices.len()).unwrap();
        let moved = b.triangles.iter().map(|t| t.map(|i| i + first));
        Mesh {
            vertices: [a.vertices.clone(), b.vertices.clone()].concat(),
            triangles: a.triangles.iter().copied().chain(moved).collect(),
        }
    };
    let inside_out = |m: &Mesh| Mesh {
        vertices: m.vertices.clone(),
        triangles: m.triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect(),
    };
    let (large, small) = (cuboid([-10.0; 3], [10.0; 3]), cuboid([-4.0; 3], [4.0; 3]));
    assert!((field(&join(&large, &inside_out(&small)), 1.0).volume() - (8000.0 - 512.0)).abs() < 1e-9);
    assert!((field(&join(&large, &small), 1.0).volume() - 8000.0).abs() < 1e-9);
    let beside = cuboid([4.0, -10.0, -10.0], [14.0, 10.0, 10.0]);
    assert!((field(&join(&large, &beside), 1.0).volume() - 9600.0).abs() < 1e-9);
    // Two boxes that touch in a face, in an edge.
    let touching = join(&cuboid([-5.0; 3], [5.0; 3]), &cuboid([5.0, -5.0, -5.0], [9.0, 5.0, 5.0]));
    assert!((field(&touching, 1.0).volume() - 1400.0).abs() < 1e-9);
    assert_eq!(field(&touching, 1.0).intervals(0, 25, 20), [[-5.0, 9.0]]);
}

#[test]
fn the_blank_bounds_the_solid_and_threads_do_not_matter() {
    let mesh = turned(&prism(40, 30.0, [-30.0, 10.0]), &Rotation3::from_euler_angles(0.3, 0.2, 0.1));
    let run = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| field(&mesh, 0.5))
    };
    let (one, two, whole) = (run(1), run(2), Field::turned(&AROUND, 0.5).unwrap());
    assert!(one == two && one.volume() < whole.volume() && one.volume() > 0.5 * whole.volume());
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        for i in 0..one.cells()[u] {
            for j in 0..one.cells()[v] {
                let around = whole.intervals(axis, i, j);
                let mut last = f64::NEG_INFINITY;
                for [a, b] in one.intervals(axis, i, j) {
                    assert!(a >= last && b > a && around.iter().any(|w| w[0] <= a && b <= w[1]));
                    last = b;
                }
            }
        }
    }
    let all = cuboid([-40.0; 3], [40.0; 3]);
    assert!(field(&all, 0.5) == whole, "a box around the blank changes it");
}

#[test]
fn writing_and_reading_gives_the_same_solid() {
    let mesh = ball(20, 30, |i, j| 9.0 + f64::from((i * 31 + j * 17) % 10) * 0.1);
    let back = read(&mesh.stl("solid ball")).unwrap();
    assert_eq!((back.vertices.len(), back.triangles.len()), (mesh.vertices.len(), mesh.triangles.len()));
    assert!((back.volume() - mesh.volume()).abs() < 1e-5 * mesh.volume());
    assert_eq!(read(&back.stl("")).unwrap(), back);
    assert_eq!(read(text(&back).as_bytes()).unwrap(), back);
    // Blanks, small and large letters, line ends, a mark of the order of bytes, two solids.
    let other = text(&back).replace('\n', "\r\n\r\n").replace("facet", "FACET ").replace("  ", "\t");
    assert_eq!(read(format!("\u{feff}{other}").as_bytes()).unwrap(), back);
    let two = text(&cuboid([0.0; 3], [1.0; 3])) + &text(&cuboid([2.0; 3], [3.0; 3]));
    assert!((read(two.as_bytes()).unwrap().volume() - 2.0).abs() < 1e-12);
    // Triangles without an area close nothing and open nothing.
    let mut flat = back.clone();
    flat.triangles.extend([[0, 0, 5], [7, 7, 7]]);
    assert_eq!(read(&flat.stl("")).unwrap(), back);
}

#[test]
fn meshes_of_the_simulated_stock_are_read() {
    let field =
        Field::turned(&[[2.0, -8.0], [20.0, -8.0], [9.0, 0.0], [5.0, 0.0], [4.0, 3.0], [2.0, 3.0]], 0.8).unwrap();
    let mesh = field.mesh();
    let back = read(&mesh.stl("x")).unwrap();
    assert!((back.volume() - mesh.volume()).abs() < 1e-5 * mesh.volume());
}

fn text(mesh: &Mesh) -> String {
    let mut out = String::from("solid part\n");
    for t in &mesh.triangles {
        out.push_str("  facet normal 0 0 1\n    outer loop\n");
        for p in t.map(|i| mesh.vertices[i as usize]) {
            out.push_str(&format!("      vertex {} {:e} {}\n", p.x, p.y, p.z));
        }
        out.push_str("    endloop\n  endfacet\n");
    }
    out + "endsolid part\n"
}

/// Bytes with a fault, the fault, and words of its message.
fn faulty() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let solid = cuboid([-1.0; 3], [2.0; 3]);
    let with = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = solid.clone();
        change(&mut mesh);
        mesh.stl("")
    };
    let binary = solid.stl("");
    let mut counted = binary.clone();
    counted[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let mut longer = binary.clone();
    longer.extend([0; 7]);
    let lines = text(&solid);
    let cut = |n: usize| lines.lines().take(n).collect::<Vec<_>>().join("\n").into_bytes();
    let other = |from: &str, to: &str| lines.replacen(from, to, 1).into_bytes();
    let flat = Mesh { vertices: solid.vertices[..4].to_vec(), triangles: vec![[0, 1, 2], [0, 2, 1]] };
    vec![
        ("empty", Vec::new(), "it is empty"),
        ("words", b"curve,number,x,y,z\nroot,1,2,3,4\n".to_vec(), "it is no STL file"),
        ("short", vec![7; 40], "it is no STL file"),
        ("longer", longer, "it is no STL file"),
        ("truncated", binary[..binary.len() - 20].to_vec(), "it ends after 11 of 12 triangles"),
        ("counted", counted, "it ends after 12 of 4294967295 triangles"),
        ("no triangles", Mesh::default().stl(""), "it has no triangle with an area"),
        ("empty solid", b"solid nothing\nendsolid nothing\n".to_vec(), "it has no triangle with an area"),
        ("no end", cut(85), "it ends before `endsolid`"),
        ("in a facet", cut(5), "it ends before `vertex` and three numbers"),
        ("no number", other("vertex -1", "vertex one"), "line 4 is not `vertex` and three numbers"),
        ("two numbers", other("      vertex -1 ", "      vertex "), "line 4 is not `vertex` and three numbers"),
        ("no loop", other("outer loop", "loop"), "line 3 is not `outer loop`"),
        ("four corners", other("    endloop", "      vertex 0 0 0\n    endloop"), "line 7 is not `endloop`"),
        ("binary after", other("endsolid part", "\u{0}\u{1}"), "line 86 is not `facet` or `endsolid`"),
        ("no number at all", with(&|m| m.vertices[3].x = f64::NAN), "a corner of triangle 1 is not three numbers"),
        ("infinite", with(&|m| m.vertices[7].y = f64::INFINITY), "a corner of triangle 3 is not three numbers"),
        ("far", with(&|m| m.vertices[7].y = 2e4), "a corner of triangle 3 is not three numbers within 10 m"),
        (
            "hole",
            with(&|m| m.triangles.truncate(11)),
            "its surface is not closed: an odd number of triangles meets at 3 edges",
        ),
        ("turned", with(&|m| m.triangles[0].swap(0, 1)), "outside on different sides, at 3 edges"),
        ("inside out", with(&|m| m.triangles.iter_mut().for_each(|t| t.swap(0, 1))), "it is inside out"),
        ("flat", flat.stl(""), "its surface encloses nothing"),
        ("needles", prism(60_000, 1e-2, [-10.0, 10.0]).stl(""), "long needles"),
    ]
}

#[test]
fn too_many_triangles_are_refused_before_they_are_read() {
    let mut bytes = vec![0; 84 + 50 * (MAX_TRIANGLES + 1)];
    bytes[80..84].copy_from_slice(&u32::try_from(MAX_TRIANGLES + 1).unwrap().to_le_bytes());
    assert_eq!(read(&bytes), Err(StlFault::TooMany { triangles: MAX_TRIANGLES + 1 }));
}

#[test]
fn each_fault_of_a_file_is_told() {
    let job = include_str!("../../fuzz/stl.imp");
    let curves = include_str!("../../jobs/small/vane_curves.csv");
    for (name, bytes, words) in faulty() {
        let mut files = InMemory::default();
        files.curves.insert("vane_curves.csv".to_owned(), curves.to_owned());
        files.meshes.insert("left.stl".to_owned(), bytes);
        let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
        let source = sources.add("job.imp", job);
        let tree = parse(job, source, &mut sink);
        assert!(resolve(&tree, &mut files, &mut sources, &mut sink).is_err(), "{name} is accepted");
        let told = sink.diags().iter().find(|d| d.code == codes::job::STOCK_FILE).unwrap_or_else(|| panic!("{name}"));
        assert!(told.message.contains(words) && told.help.is_some(), "{name}: {}", told.message);
        let label = &told.labels[0].span;
        assert_eq!(&job[label.range()], "\"left.stl\"", "{name}");
        let _ = render::human(&sink, &sources, false);
    }
}

#[test]
fn open_edges_have_their_place() {
    let mut mesh = cuboid([-1.0; 3], [2.0; 3]);
    mesh.triangles.pop();
    let Err(StlFault::Open { edges: 3, at }) = read(&mesh.stl("")) else { panic!("a hole is closed") };
    let corners = [1_usize, 7, 5].map(|i| mesh.vertices[i]);
    let middles = (0..3).map(|k| nalgebra::center(&corners[k], &corners[(k + 1) % 3]));
    assert!(middles.into_iter().any(|m| (m - at).norm() < 1e-6), "{at}");
}

/// Any bytes are read or refused, and what is read can be cut into rays.
fn readable(bytes: &[u8]) {
    if let Ok(mesh) = read(bytes) {
        assert!(mesh.volume() > 0.0 && mesh.vertices.iter().all(|p| p.iter().all(|x| x.is_finite())));
        if let Ok(field) = Field::new(&AROUND, Some(&mesh), 2.0) {
            assert!((0.0..=100_000.0).contains(&field.volume()));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
        readable(&bytes);
        readable(&[b"solid ".as_slice(), &bytes].concat());
    }

    #[test]
    fn changed_files_are_read_or_refused(
        changes in proptest::collection::vec((0.0..1.0_f64, any::<u8>()), 1..4),
        length in 0.0..1.3_f64,
        in_text: bool,
    ) {
        let mesh = cuboid([-9.5; 3], [10.0, 3.5, 8.0]);
        let mut bytes = if in_text { text(&mesh).into_bytes() } else { mesh.stl("x") };
        for (at, to) in changes {
            let at = (at * bytes.len() as f64) as usize;
            bytes[at] = to;
        }
        bytes.truncate((length * bytes.len() as f64) as usize);
        readable(&bytes);
    }

    #[test]
    fn moved_corners_are_cut_into_rays(moves in proptest::collection::vec((0..8_usize, 0..3_usize, -60..60_i32), 0..12)) {
        // Solids that cross themselves, with corners on rays.
        let mut mesh = cuboid([-9.5; 3], [10.0, 3.5, 8.0]);
        for (corner, axis, to) in moves {
            mesh.vertices[corner][axis] = f64::from(to) / 2.0;
        }
        readable(&mesh.stl(""));
    }
}
