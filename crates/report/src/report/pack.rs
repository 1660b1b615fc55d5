//! Numbers in the form of the page: little-endian typed arrays in base64, deflated where they are large, and the functions
//! that round them.

use flate2::{Compress, Compression, FlushCompress, Status};
use nalgebra::Vector3;

/// Least side of a frame, mm: a flat one has no other to scale by.
const MIN_FRAME_SIDE: f64 = 1e-6;

/// Deviation below which codes are spaced evenly, mm; above it their spacing grows with the deviation.
const DEVIATION_KNEE: f64 = 1e-3;

/// Codes for each unit of the inverse hyperbolic sine: 0.33 nm near zero, 0.03 % of large deviations.
const DEVIATION_STEPS: f64 = 3000.0;

/// Code of a point that no cutter reaches.
pub(super) const NOT_REACHED: i16 = i16::MAX;

/// Code of a point on a surface that is not milled.
pub(super) const NOT_MILLED: i16 = i16::MIN;

/// Parameters of the deviation codes for the page: knee in mm, and codes for each unit.
pub(super) fn deviation_law() -> [f64; 2] {
    [DEVIATION_KNEE, DEVIATION_STEPS]
}

/// Code of a deviation in mm.
pub(super) fn deviation(g: f64) -> i16 {
    let code = (libm::asinh(g / DEVIATION_KNEE) * DEVIATION_STEPS).round();
    code.clamp(f64::from(NOT_MILLED + 1), f64::from(NOT_REACHED - 1)) as i16
}

/// A unit vector as a point on an octahedron that is unfolded to a square: two signed shares.
pub(super) fn direction(n: &Vector3<f64>) -> [i16; 2] {
    let sum = (n.x.abs() + n.y.abs() + n.z.abs()).max(f64::MIN_POSITIVE);
    let (x, y) = (n.x / sum, n.y / sum);
    let sign = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
    let (x, y) = if n.z < 0.0 { ((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y)) } else { (x, y) };
    [x, y].map(|v| (v * f64::from(i16::MAX)).round() as i16)
}

/// The box in which positions are rounded to 16 bit.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub(super) struct Frame {
    /// Least corner, mm.
    pub(super) low: [f64; 3],
    /// Sizes, mm.
    pub(super) size: [f64; 3],
}

impl Frame {
    /// The box around points.
    pub(super) fn around(points: impl Iterator<Item = [f64; 3]>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in points.filter(|p| p.iter().all(|x| x.is_finite())) {
            for k in 0..3 {
                (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
            }
        }
        if low[0] > high[0] {
            return Self { low: [0.0; 3], size: [1.0; 3] };
        }
        Self { low, size: [0, 1, 2].map(|k| (high[k] - low[k]).max(MIN_FRAME_SIDE)) }
    }

    /// Coordinates of a point as shares of the box, in 1/65535.
    pub(super) fn place(&self, p: [f64; 3]) -> [u16; 3] {
        [0, 1, 2].map(|k| ((p[k] - self.low[k]) / self.size[k] * f64::from(u16::MAX)).round() as u16)
    }

    /// Largest rounding of a coordinate, mm.
    pub(super) fn rounding(&self) -> f64 {
        0.5 * self.size.iter().fold(0.0_f64, |a, b| a.max(*b)) / f64::from(u16::MAX)
    }
}

/// A typed array as text.
#[derive(Default)]
pub(super) struct Bytes(Vec<u8>);

impl Bytes {
    pub(super) fn u8(&mut self, v: u8) {
        self.0.push(v);
    }

    pub(super) fn u16(&mut self, v: u16) {
        self.0.extend(v.to_le_bytes());
    }

    pub(super) fn i16(&mut self, v: i16) {
        self.0.extend(v.to_le_bytes());
    }

    pub(super) fn u32(&mut self, v: u32) {
        self.0.extend(v.to_le_bytes());
    }

    pub(super) fn f32(&mut self, v: f64) {
        self.0.extend((v as f32).to_le_bytes());
    }

    /// The bytes of a text.
    pub(super) fn of_text(text: &str) -> Self {
        Self(text.as_bytes().to_vec())
    }

    /// Number of bytes.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Deflated, in the zlib format (RFC 1950). Nothing stays nothing.
    pub(super) fn deflated(&self) -> Self {
        if self.0.is_empty() {
            return Self::default();
        }
        let mut deflater = Compress::new(Compression::default(), true);
        let mut out = Vec::with_capacity(self.0.len() / 2 + MIN_STREAM_BYTES);
        loop {
            let done = usize::try_from(deflater.total_in()).unwrap_or(self.0.len());
            let rest = self.0.get(done..).unwrap_or_default();
            // Deflating from memory to memory does not fail.
            match deflater.compress_vec(rest, &mut out, FlushCompress::Finish) {
                Ok(Status::Ok | Status::BufError) => out.reserve(out.capacity()),
                Ok(Status::StreamEnd) | Err(_) => return Self(out),
            }
        }
    }

    /// Base64 with padding (RFC 4648).
    pub(super) fn base64(&self) -> String {
        const BASE64_DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let mut text = String::with_capacity(self.0.len().div_ceil(3) * 4);
        for three in self.0.chunks(3) {
            let byte = |k: usize| u32::from(three.get(k).copied().unwrap_or(0));
            let word = byte(0) << 16 | byte(1) << 8 | byte(2);
            for k in 0..4 {
                let digit = BASE64_DIGITS[(word >> (18 - 6 * k) & 63) as usize];
                text.push(if k <= three.len() { char::from(digit) } else { '=' });
            }
        }
        text
    }
}

/// Room for the frame of an empty stream, bytes.
const MIN_STREAM_BYTES: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Read as _;

    #[test]
    fn base64_is_that_of_the_standard() {
        let encoded = |text: &str| Bytes(text.as_bytes().to_vec()).base64();
        for (text, expected) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(encoded(text), expected);
        }
    }

    #[test]
    fn deflated_bytes_come_back() {
        let text = "N10 G1 X1.5 Y2.5\n".repeat(500);
        let small = Bytes::of_text(&text).deflated();
        assert!(small.len() * 10 < text.len(), "{} of {} bytes", small.len(), text.len());
        let mut back = String::new();
        flate2::read::ZlibDecoder::new(small.0.as_slice()).read_to_string(&mut back).unwrap();
        assert_eq!(back, text);
        assert_eq!(Bytes::default().deflated().len(), 0);
    }

    proptest! {
        #[test]
        fn a_deviation_comes_back(g in -20.0..20.0_f64) {
            let [knee, steps] = deviation_law();
            let back = knee * (f64::from(deviation(g)) / steps).sinh();
            prop_assert!((back - g).abs() <= 2e-7 + 2e-4 * g.abs());
        }

        #[test]
        fn a_direction_comes_back(x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64) {
            let n = Vector3::new(x, y, z);
            prop_assume!(n.norm() > 1e-3);
            let n = n.normalize();
            let [a, b] = direction(&n).map(|v| f64::from(v) / f64::from(i16::MAX));
            let z = 1.0 - a.abs() - b.abs();
            let t = (-z).max(0.0);
            let fold = |v: f64| if v < 0.0 { v + t } else { v - t };
            let back = Vector3::new(fold(a), fold(b), z).normalize();
            prop_assert!((back - n).norm() < 1e-4);
        }
    }
}
