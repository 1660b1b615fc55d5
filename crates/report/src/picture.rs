//! A picture of the part with its tool paths: a z-buffer of shaded surface patches, and lines over it.

use ir::{Motion, MoveKind, Program};
use nalgebra::{Point3, Vector3};
use wheel::part::{Face, Part, Surface};

/// Twice the area of a triangle below which it has no normal, mm2.
const NO_AREA: f64 = 1e-12;

/// Twice the area of a triangle in pixels below which it covers none.
const NO_PIXELS: f64 = 1e-9;

/// Size of the picture in pixels.
pub const SIZE: [usize; 2] = [1400, 1000];

/// Each pixel is the mean over a square of this many samples on each side.
const SUPERSAMPLING: usize = 2;

/// Steps of the surface patches along and across.
const PATCH_STEPS: [usize; 2] = [60, 12];

/// Distance by which lines are moved towards the eye, mm: paths of finishing lie on their surfaces.
const LINE_LIFT: f64 = 1.2;

const BACKGROUND: [f64; 3] = [1.0, 1.0, 1.0];
const METAL: [f64; 3] = [0.70, 0.74, 0.80];
const VANE: [f64; 3] = [0.80, 0.82, 0.86];

/// Colours of operations, in order.
const COLOURS: [[f64; 3]; 6] = [
    [0.85, 0.33, 0.10],
    [0.93, 0.63, 0.13],
    [0.64, 0.08, 0.18],
    [0.49, 0.18, 0.56],
    [0.00, 0.45, 0.74],
    [0.20, 0.55, 0.20],
];

/// Pixels with their depth.
struct Canvas {
    width: usize,
    height: usize,
    colour: Vec<[f64; 3]>,
    depth: Vec<f64>,
    right: Vector3<f64>,
    up: Vector3<f64>,
    toward: Vector3<f64>,
    scale: f64,
    middle: Point3<f64>,
}

impl Canvas {
    fn new(middle: Point3<f64>, radius: f64) -> Self {
        let (width, height) = (SIZE[0] * SUPERSAMPLING, SIZE[1] * SUPERSAMPLING);
        let toward = Vector3::new(0.35, -0.75, 0.95).normalize();
        let right = Vector3::z().cross(&toward).normalize();
        let up = toward.cross(&right);
        let scale = 0.5 * (width as f64 / 1.25).min(height as f64 / 0.95) / radius;
        let pixels = width * height;
        Self {
            width,
            height,
            colour: vec![BACKGROUND; pixels],
            depth: vec![f64::NEG_INFINITY; pixels],
            right,
            up,
            toward,
            scale,
            middle,
        }
    }

    /// Column, row and nearness to the eye of a point.
    fn project(&self, p: &Point3<f64>) -> [f64; 3] {
        let d = p - self.middle;
        [
            0.5 * self.width as f64 + d.dot(&self.right) * self.scale,
            0.5 * self.height as f64 - d.dot(&self.up) * self.scale,
            d.dot(&self.toward),
        ]
    }

    fn dot(&mut self, x: f64, y: f64, near: f64, colour: [f64; 3]) {
        if x < 0.0 || y < 0.0 || x >= self.width as f64 || y >= self.height as f64 {
            return;
        }
        let at = y as usize * self.width + x as usize;
        if near > self.depth[at] {
            self.depth[at] = near;
            self.colour[at] = colour;
        }
    }

    /// A triangle, lit from the eye and from above.
    fn triangle(&mut self, corners: [Point3<f64>; 3], base: [f64; 3]) {
        let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        let Some(normal) = normal.try_normalize(NO_AREA) else { return };
        let facing = normal.dot(&self.toward).abs();
        let light = normal.dot(&Vector3::new(-0.4, -0.2, 0.9).normalize()).abs();
        let shade = 0.25 + 0.45 * facing + 0.30 * light;
        let colour = base.map(|c| (c * shade).min(1.0));
        let [a, b, c] = corners.map(|p| self.project(&p));
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area.abs() < NO_PIXELS {
            return;
        }
        let bounds = |k: usize, limit: usize| {
            let low = a[k].min(b[k]).min(c[k]).floor().max(0.0);
            let high = a[k].max(b[k]).max(c[k]).ceil().min(limit as f64 - 1.0);
            (low as usize, if high < 0.0 { 0 } else { high as usize })
        };
        let ((x0, x1), (y0, y1)) = (bounds(0, self.width), bounds(1, self.height));
        for y in y0..=y1 {
            for x in x0..=x1 {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let wb = ((px - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (py - a[1])) / area;
                let wc = ((b[0] - a[0]) * (py - a[1]) - (px - a[0]) * (b[1] - a[1])) / area;
                if wb >= 0.0 && wc >= 0.0 && wb + wc <= 1.0 {
                    let near = a[2] + wb * (b[2] - a[2]) + wc * (c[2] - a[2]);
                    self.dot(px, py, near, colour);
                }
            }
        }
    }

    /// A grid of points as two triangles per cell.
    fn patch(&mut self, steps: [usize; 2], colour: [f64; 3], point: impl Fn(f64, f64) -> Point3<f64>) {
        for i in 0..steps[0] {
            for j in 0..steps[1] {
                let at = |k: usize, l: usize| point((i + k) as f64 / steps[0] as f64, (j + l) as f64 / steps[1] as f64);
                let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                self.triangle([a, b, c], colour);
                self.triangle([a, c, d], colour);
            }
        }
    }

    fn line(&mut self, from: &Point3<f64>, to: &Point3<f64>, colour: [f64; 3]) {
        let (a, b) = (self.project(from), self.project(to));
        let steps = (b[0] - a[0]).abs().max((b[1] - a[1]).abs()).ceil().clamp(1.0, 20_000.0);
        for k in 0..=steps as usize {
            let t = k as f64 / steps;
            let mix = |i: usize| a[i] + (b[i] - a[i]) * t;
            let near = mix(2) + LINE_LIFT;
            self.dot(mix(0), mix(1), near, colour);
            self.dot(mix(0) + 1.0, mix(1), near, colour);
        }
    }

    fn png(&self) -> Vec<u8> {
        let mut pixels = Vec::with_capacity(SIZE[0] * SIZE[1] * 3);
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                let mut sum = [0.0; 3];
                for dy in 0..SUPERSAMPLING {
                    for dx in 0..SUPERSAMPLING {
                        let c = self.colour[(y * SUPERSAMPLING + dy) * self.width + x * SUPERSAMPLING + dx];
                        for k in 0..3 {
                            sum[k] += c[k];
                        }
                    }
                }
                let count = (SUPERSAMPLING * SUPERSAMPLING) as f64;
                pixels.extend(sum.map(|c| (c / count * 255.0).round().clamp(0.0, 255.0) as u8));
            }
        }
        encode(&pixels).unwrap_or_default()
    }
}

/// PNG bytes of the pixels; writing to memory does not fail.
fn encode(pixels: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let size = SIZE.map(|n| u32::try_from(n).unwrap_or(u32::MAX));
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(bytes)
}

/// The part with the cuts of every operation in its own colour, as PNG.
pub fn picture(program: &Program, motion: &Motion) -> Vec<u8> {
    let part = &program.part;
    let outlet = part.hub.meridian(1.0).point;
    let middle = Point3::new(0.0, 0.0, 0.5 * (outlet.y + part.shroud.meridian(0.0).point.y));
    let mut canvas = Canvas::new(middle, 1.12 * outlet.x);
    draw_part(part, program.stock.back.get(), &mut canvas);
    for (index, operation) in motion.operations.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let mut before: Option<Point3<f64>> = None;
        for m in &operation.moves {
            let tip = program.machine.forward(&m.joints).tip;
            // Tip positions outside of the part would hide it.
            let inside = libm::hypot(tip.x, tip.y) <= outlet.x + 1.0;
            if let (Some(from), MoveKind::Cut, true) = (before, m.kind, inside) {
                canvas.line(&from, &tip, colour);
            }
            before = Some(tip);
        }
    }
    canvas.png()
}

fn draw_part(part: &Part, back: f64, canvas: &mut Canvas) {
    let around = [200, 40];
    canvas.patch(around, METAL, |a, u| part.hub.point(u, a * std::f64::consts::TAU));
    let outlet = part.hub.meridian(1.0).point;
    let ring = |r: f64, z: f64, a: f64| {
        let angle = a * std::f64::consts::TAU;
        Point3::new(r * libm::cos(angle), r * libm::sin(angle), z)
    };
    canvas.patch([200, 1], METAL, |a, t| ring(outlet.x, outlet.y + (back - outlet.y) * t, a));
    let inlet = part.hub.meridian(0.0).point;
    canvas.patch([200, 1], METAL, |a, t| ring(inlet.x * (1.0 - 0.7 * t), inlet.y, a));
    for sector in 0..part.vane_count {
        let turn = part.sector_rotation(sector);
        let point = |face: &Face, u: f64, v: f64| turn * face.surface.point(u, v);
        for blade in part.blade_ids() {
            for side in part.sides(blade) {
                canvas.patch(PATCH_STEPS, VANE, |u, v| point(part.face(side), u, v));
            }
            let [p, s] = blade.faces().map(|face| part.face(face));
            let between = |u: f64, v: f64, t: f64| {
                let (a, b) = (point(p, u, v), point(s, u, v));
                a + (b - a) * t
            };
            canvas.patch([PATCH_STEPS[0], 2], VANE, |u, t| between(u, 1.0, t));
            for end in [0, 1].into_iter().filter(|end| part.edge(blade, *end).is_none()) {
                canvas.patch([PATCH_STEPS[1], 2], VANE, |v, t| between(end as f64, v, t));
            }
        }
    }
}
