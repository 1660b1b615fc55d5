//! STL files of closed solids: writer of binary files, reader of binary and text files.
//!
//! STL lists triangles with their corners, without numbers of shared corners. Corners with the same three numbers are
//! one vertex; other programs write shared corners so. Normals in the file are not read: the order of the corners gives
//! the outside.

use super::mesh::Mesh;
use nalgebra::{Point3, Vector3};
use rayon::slice::ParallelSliceMut;
use std::collections::HashMap;

/// Most triangles: some 250 MB as a binary file, and some 600 MB in memory while it is read.
pub const MAX_TRIANGLES: usize = 5_000_000;

/// Largest coordinate, mm.
const FARTHEST: f64 = 1e4;

/// Most length of the longest edges of all triangles, in diagonals of the box around them. A fine mesh has thousands; it
/// bounds the time of what follows against millions of needles across the whole box.
const MAX_LENGTH: f64 = 1e5;

/// Least volume of a solid, mm3.
const LEAST_VOLUME: f64 = 1e-9;

/// Bytes before the triangles of a binary file, and of each triangle.
const BINARY_HEAD: usize = 84;
const RECORD: usize = 50;

/// Why bytes are no STL file of a closed solid.
#[derive(Clone, Debug, PartialEq)]
pub enum StlFault {
    /// No bytes.
    Empty,
    /// Neither text that begins with `solid` nor as long as a binary file with its number of triangles.
    NotStl,
    /// A binary file that ends before its last triangle.
    Truncated {
        /// Triangles that the file announces.
        announced: usize,
        /// Whole triangles that it has.
        found: usize,
    },
    /// A line of a text file, from 1, is not what must stand there.
    Line {
        /// Number of the line.
        line: usize,
        /// What must stand there.
        due: &'static str,
    },
    /// A text file ends where more must stand.
    End {
        /// What must stand there.
        due: &'static str,
    },
    /// No triangle with an area.
    NoTriangles,
    /// More than [`MAX_TRIANGLES`].
    TooMany {
        /// Number of triangles, or how many were read.
        triangles: usize,
    },
    /// A coordinate that is not finite, or beyond 10 m.
    Coordinate {
        /// Number of the triangle, from 1.
        triangle: usize,
    },
    /// Long needles across the whole solid in such numbers that no program can cut them.
    Needles,
    /// Edges at which an odd number of triangles meet: the surface has a hole.
    Open {
        /// Number of these edges.
        edges: usize,
        /// Middle of the first of them.
        at: Point3<f64>,
    },
    /// Edges whose triangles have their outside on different sides.
    Turned {
        /// Number of these edges.
        edges: usize,
        /// Middle of the first of them.
        at: Point3<f64>,
    },
    /// All triangles have their outside in the solid.
    InsideOut,
    /// The surface encloses nothing.
    NoVolume,
}

impl Mesh {
    /// Binary STL. Its 80 bytes of header hold the name, cut off where it is too long.
    pub fn stl(&self, name: &str) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(BINARY_HEAD + RECORD * self.triangles.len());
        // A header that begins with "solid" would make readers expect text.
        let head = format!("binary STL, mm: {name}");
        bytes.extend(head.bytes().filter(u8::is_ascii).chain(std::iter::repeat(b' ')).take(80));
        bytes.extend(u32::try_from(self.triangles.len()).unwrap_or(u32::MAX).to_le_bytes());
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| self.vertices[i as usize]);
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
            for v in [normal, a.coords, b.coords, c.coords] {
                bytes.extend(v.iter().flat_map(|x| (*x as f32).to_le_bytes()));
            }
            bytes.extend([0, 0]);
        }
        bytes
    }
}

/// The closed solid of an STL file, mm.
///
/// # Errors
/// [`StlFault`].
pub fn read(bytes: &[u8]) -> Result<Mesh, StlFault> {
    if bytes.is_empty() {
        return Err(StlFault::Empty);
    }
    let mut reading = Reading::default();
    match announced(bytes) {
        Some(n) if bytes.len() as u64 == BINARY_HEAD as u64 + RECORD as u64 * u64::from(n) => {
            binary(bytes, &mut reading)?
        }
        _ if is_text(bytes) => text(bytes, &mut reading)?,
        Some(n) if (bytes.len() as u64) < BINARY_HEAD as u64 + RECORD as u64 * u64::from(n) => {
            let found = (bytes.len() - BINARY_HEAD) / RECORD;
            return Err(StlFault::Truncated { announced: n as usize, found });
        }
        _ => return Err(StlFault::NotStl),
    }
    let mesh = Mesh { vertices: reading.vertices, triangles: reading.triangles };
    check(&mesh)?;
    Ok(mesh)
}

/// Number of triangles at the head of a binary file.
fn announced(bytes: &[u8]) -> Option<u32> {
    let number = bytes.get(BINARY_HEAD - 4..BINARY_HEAD)?;
    Some(u32::from_le_bytes([number[0], number[1], number[2], number[3]]))
}

fn is_text(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    bytes.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

/// Triangles that were read, with one vertex for equal corners.
#[derive(Default)]
struct Reading {
    vertices: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// Vertices by the bits of their coordinates.
    known: HashMap<[u64; 3], u32>,
    /// Triangles read, those without an area included.
    count: usize,
}

impl Reading {
    fn add(&mut self, corners: [[f64; 3]; 3]) -> Result<(), StlFault> {
        self.count += 1;
        if self.count > MAX_TRIANGLES {
            return Err(StlFault::TooMany { triangles: self.count });
        }
        // Not a number is not within the limit either.
        if !corners.as_flattened().iter().all(|x| x.abs() <= FARTHEST) {
            return Err(StlFault::Coordinate { triangle: self.count });
        }
        let triangle = corners.map(|p| self.vertex(p));
        let [a, b, c] = triangle;
        // Without an area, two of the sides are one edge to and fro: the others close without them.
        if a != b && b != c && c != a {
            self.triangles.push(triangle);
        }
        Ok(())
    }

    fn vertex(&mut self, p: [f64; 3]) -> u32 {
        // Minus zero becomes zero.
        let p = p.map(|x| x + 0.0);
        let next = u32::try_from(self.vertices.len()).unwrap_or(u32::MAX);
        let index = *self.known.entry(p.map(f64::to_bits)).or_insert(next);
        if index == next {
            self.vertices.push(Point3::from(p));
        }
        index
    }
}

fn binary(bytes: &[u8], reading: &mut Reading) -> Result<(), StlFault> {
    let records = bytes.get(BINARY_HEAD..).unwrap_or_default().chunks_exact(RECORD);
    if records.len() > MAX_TRIANGLES {
        return Err(StlFault::TooMany { triangles: records.len() });
    }
    for record in records {
        let number = |at: usize| f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]]);
        let corner = |k: usize| std::array::from_fn(|i| f64::from(number(12 + 12 * k + 4 * i)));
        reading.add([corner(0), corner(1), corner(2)])?;
    }
    Ok(())
}

/// Words of a line of a text file.
struct StlLines<'a> {
    lines: std::slice::Split<'a, u8, fn(&u8) -> bool>,
    /// Number of the last line, from 1.
    number: usize,
    ended: bool,
}

impl StlLines<'_> {
    /// The next line with words, in small letters; `None` at the end.
    fn next(&mut self) -> Option<String> {
        for line in self.lines.by_ref() {
            self.number += 1;
            let line = String::from_utf8_lossy(line).trim_start_matches('\u{feff}').trim().to_ascii_lowercase();
            if !line.is_empty() {
                return Some(line);
            }
        }
        self.ended = true;
        None
    }

    fn fault(&self, due: &'static str) -> StlFault {
        if self.ended { StlFault::End { due } } else { StlFault::Line { line: self.number, due } }
    }

    /// Reads a line that must have these words.
    fn expect(&mut self, words: &str, due: &'static str) -> Result<(), StlFault> {
        let found = self.next().is_some_and(|line| line.split_ascii_whitespace().eq(words.split(' ')));
        if found { Ok(()) } else { Err(self.fault(due)) }
    }

    fn corner(&mut self) -> Result<[f64; 3], StlFault> {
        const VERTEX_FORM: &str = "`vertex` and three numbers";
        let line = self.next().ok_or_else(|| self.fault(VERTEX_FORM))?;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let [keyword, numbers @ ..] = words.as_slice() else { return Err(self.fault(VERTEX_FORM)) };
        let numbers: Option<Vec<f64>> = numbers.iter().map(|w| w.parse().ok()).collect();
        match numbers.as_deref() {
            Some([x, y, z]) if *keyword == "vertex" => Ok([*x, *y, *z]),
            _ => Err(self.fault(VERTEX_FORM)),
        }
    }
}

/// Text: `solid`, then for each triangle `facet normal`, `outer loop`, three `vertex`, `endloop`, `endfacet`; at last
/// `endsolid`. A file may have several solids.
fn text(bytes: &[u8], reading: &mut Reading) -> Result<(), StlFault> {
    let end: fn(&u8) -> bool = |b| *b == b'\n';
    let mut lines = StlLines { lines: bytes.split(end), number: 0, ended: false };
    let mut in_solid = false;
    while let Some(line) = lines.next() {
        let keyword = line.split_ascii_whitespace().next().unwrap_or_default();
        match (keyword, in_solid) {
            ("solid", false) => in_solid = true,
            ("endsolid", true) => in_solid = false,
            ("facet", true) => {
                lines.expect("outer loop", "`outer loop`")?;
                let corners = [lines.corner()?, lines.corner()?, lines.corner()?];
                lines.expect("endloop", "`endloop`")?;
                lines.expect("endfacet", "`endfacet`")?;
                reading.add(corners)?;
            }
            (_, true) => return Err(lines.fault("`facet` or `endsolid`")),
            (_, false) => return Err(lines.fault("`solid`")),
        }
    }
    if in_solid { Err(lines.fault("`endsolid`")) } else { Ok(()) }
}

/// Whether a mesh bounds a solid.
fn check(mesh: &Mesh) -> Result<(), StlFault> {
    if mesh.triangles.is_empty() {
        return Err(StlFault::NoTriangles);
    }
    let corner = |i: u32| mesh.vertices[i as usize];
    let (mut low, mut high) = (mesh.vertices[0], mesh.vertices[0]);
    for p in &mesh.vertices {
        (low, high) = (low.inf(p), high.sup(p));
    }
    let longest = |t: &[u32; 3]| {
        let side = |k: usize| (corner(t[k]) - corner(t[(k + 1) % 3])).norm();
        side(0).max(side(1)).max(side(2))
    };
    if mesh.triangles.iter().map(longest).sum::<f64>() > MAX_LENGTH * (high - low).norm() {
        return Err(StlFault::Needles);
    }
    closed(mesh)?;
    match mesh.volume() {
        volume if volume.abs() < LEAST_VOLUME => Err(StlFault::NoVolume),
        volume if volume < 0.0 => Err(StlFault::InsideOut),
        _ => Ok(()),
    }
}

/// Whether each edge is followed as often in one direction as in the other.
fn closed(mesh: &Mesh) -> Result<(), StlFault> {
    // Both ends of an edge, the smaller index first, and one bit for the direction.
    let sides = mesh.triangles.iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
    let key = |[a, b]: [u32; 2]| u64::from(a.min(b)) << 32 | u64::from(a.max(b)) << 1 | u64::from(a > b);
    let mut edges: Vec<u64> = sides.map(key).collect();
    edges.par_sort_unstable();
    let middle = |key: u64| {
        let [a, b] = [key >> 32, (key & 0xffff_ffff) >> 1].map(|i| mesh.vertices[i as usize]);
        nalgebra::center(&a, &b)
    };
    let mut faults: [Option<(usize, Point3<f64>)>; 2] = [None; 2];
    for sides in edges.chunk_by(|a, b| a >> 1 == b >> 1) {
        let back = sides.iter().filter(|side| **side & 1 == 1).count();
        if 2 * back != sides.len() {
            let fault = &mut faults[usize::from(sides.len() % 2 == 0)];
            *fault = Some(fault.map_or((1, middle(sides[0])), |(count, at)| (count + 1, at)));
        }
    }
    match faults {
        [Some((edges, at)), _] => Err(StlFault::Open { edges, at }),
        [None, Some((edges, at))] => Err(StlFault::Turned { edges, at }),
        [None, None] => Ok(()),
    }
}
