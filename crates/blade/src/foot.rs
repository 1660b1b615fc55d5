//! Whether the sections of a blade hold the fillet at its foot.
//!
//! A blade widens slowly from the shroud to the hub. A fillet widens it within a few millimetres over the hub, faster and faster.
//! Such sections make a part twice wide at its foot where the job states a fillet too, and no ruled or lofted face without waves.

use super::outline::DividedSection;
use nalgebra::{Point3, Vector3};

/// Growth of the thickness towards the hub, mm for each mm of height, from which a foot may be a fillet: both faces are inclined by 8.5 deg.
const FOOT_GROWTH: f64 = 0.3;

/// A foot grows this many times faster than the middle of the blade.
const FASTER: f64 = 3.0;

/// Least share by which a fillet widens the blade.
const MIN_GROWTH: f64 = 0.3;

/// A foot that widens as a fillet does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilletedFoot {
    /// Lowest section, from 0, above the wide ones.
    pub above: usize,
    /// Thickness of the lowest section, and of the one above the foot, mm.
    pub thickness: [f64; 2],
    /// Distance between these two, mm.
    pub height: f64,
}

/// The wide foot of a blade, of its sections from hub to shroud; `None` where it widens evenly, and with fewer than four sections.
pub fn filleted_foot(sections: &[DividedSection]) -> Option<FilletedFoot> {
    if sections.len() < 4 {
        return None;
    }
    let middles: Vec<Point3<f64>> = sections.iter().map(middle).collect();
    let heights: Vec<f64> = middles.windows(2).map(|pair| nalgebra::distance(&pair[0], &pair[1])).collect();
    let growths =
        sections.windows(2).zip(&heights).map(|(pair, height)| (pair[0].thickness - pair[1].thickness) / height);
    let growths: Vec<f64> = growths.collect();
    let mut sorted = growths[growths.len() / 2..].to_vec();
    sorted.sort_by(f64::total_cmp);
    let limit = FOOT_GROWTH.max(FASTER * sorted[sorted.len() / 2]);
    let above = growths.iter().take_while(|growth| **growth > limit).count();
    let thickness = [sections[0].thickness, sections[above].thickness];
    let found = above > 0 && 2 * above <= growths.len() && thickness[0] > (1.0 + MIN_GROWTH) * thickness[1];
    found.then(|| FilletedFoot { above, thickness, height: heights[..above].iter().sum() })
}

/// Middle of the points of both faces.
fn middle(section: &DividedSection) -> Point3<f64> {
    let points = section.outline.faces.iter().flatten();
    let (sum, count) = points.fold((Vector3::zeros(), 0.0_f64), |(sum, count), p| (sum + p.coords, count + 1.0));
    Point3::from(sum / count.max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outline::{Inlet, Known, Side, outline};
    use crate::{Section, SectionForm};

    /// Ellipses of 20 mm length at heights over the hub, with their thickness.
    fn blade(sections: &[(f64, f64)]) -> Vec<DividedSection> {
        let known = Known { inlet: Inlet::Meridian(&[[30.0, 10.0], [30.0, -10.0]]), pressure: Side::Greater };
        let divided = sections.iter().map(|(height, thickness)| {
            let at = |k: u32| {
                let (sin, cos) = libm::sincos(f64::from(k) * std::f64::consts::TAU / 120.0);
                Point3::new(30.0 + height, 0.5 * thickness * sin, 10.0 * cos)
            };
            let form = SectionForm::Loop((0..120).map(at).collect());
            outline(&Section { span: None, form }, &known).unwrap()
        });
        divided.collect()
    }

    #[test]
    fn a_fillet_in_the_sections_is_found() {
        let taper = |height: f64| 2.0 - 0.05 * height;
        // A fillet of 3 mm: at a height it adds its distance from the vertical on both sides.
        let filleted = |height: f64| {
            let d: f64 = 3.0 - height;
            taper(height) + if d > 0.0 { 2.0 * (3.0 - (9.0 - d * d).sqrt()) } else { 0.0 }
        };
        let at =
            |heights: &[f64], of: &dyn Fn(f64) -> f64| blade(&heights.iter().map(|h| (*h, of(*h))).collect::<Vec<_>>());
        let close = [0.2, 0.6, 1.2, 2.0, 3.0, 5.0, 8.0, 12.0, 16.0];
        let found = filleted_foot(&at(&close, &filleted)).expect("a fillet");
        assert!(found.above >= 2 && found.thickness[0] > 5.0 && found.thickness[1] < 3.0, "{found:?}");
        assert!((found.height - (close[found.above] - close[0])).abs() < 0.01, "{found:?}");
        // Few sections, of which the lowest alone lies in the fillet.
        let far = [0.2, 4.0, 8.0, 12.0, 16.0];
        assert_eq!(filleted_foot(&at(&far, &filleted)).expect("a fillet").above, 1);
        assert_eq!(filleted_foot(&at(&close, &taper)), None);
        assert_eq!(filleted_foot(&at(&far, &|height| 6.0 - 0.33 * height)), None, "an even taper, however strong");
        assert_eq!(filleted_foot(&at(&[0.2, 8.0, 16.0], &filleted)), None, "too few sections to say so");
    }
}
