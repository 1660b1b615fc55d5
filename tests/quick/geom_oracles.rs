//! Oracles of the geometry: finite differences, exact shapes, invariance, and two independent implementations.

use crate::support;
use impellerc::nurbs::interpolate::chord_parameters;
use impellerc::nurbs::knots::merge_knots;
use impellerc::nurbs::proximity::Patch;
use impellerc::nurbs::range::{Interval, Jet};
use impellerc::nurbs::{GeomError, LoftedSurface, NurbsCurve, NurbsSurface, Revolution, RuledSurface, interpolate};
use nalgebra::{Point3, Point4, Rotation3, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};
use support::{ROOT_PRESSURE, ROOT_SUCTION, TIP_PRESSURE, TIP_SUCTION, curve};

/// Values of scipy 1.17.1 on numpy 2.4.6: `make_interp_spline(t, q, k=3, t=knots)` with the chord parameters of
/// formula 14 and the knots of formula 16 computed in numpy; length by `scipy.integrate.quad` on each knot span.
struct Reference {
    points: &'static [[f64; 3]],
    inner_knots: [f64; 3],
    length: f64,
    /// u, then x y z of the point, the first and the second derivative.
    rows: &'static [[f64; 10]],
}

const REFERENCES: [Reference; 4] = [
    Reference {
        points: &ROOT_PRESSURE,
        inner_knots: [0.33512165347042105, 0.501175840191133, 0.667354486938372],
        length: 54.060877779941556,
        rows: &[
            [
                0.0,
                5.8562,
                -15.8937,
                -10.0,
                -25.77823859680187,
                -23.48835887119938,
                -39.994136923248504,
                36.243376198264436,
                -5.79153770634548,
                -43.031444921490106,
            ],
            [
                0.085,
                3.7976520207549527,
                -17.934684977902766,
                -13.520938517101378,
                -22.638500856412357,
                -24.811905831061562,
                -42.45130799497654,
                37.63280592854763,
                -25.350743702176857,
                -14.784345001522894,
            ],
            [
                0.25,
                0.5868141698103437,
                -22.54601565089738,
                -20.477853284119497,
                -16.206574793455182,
                -32.12712785507667,
                -40.36703494775074,
                40.32993422850909,
                -63.318614164672965,
                40.04826072547195,
            ],
            [
                0.4375,
                -1.7584930203149969,
                -29.846767065732003,
                -27.015537192271914,
                -9.337784945273686,
                -45.43884272898071,
                -28.128043122040904,
                24.242190798749874,
                -55.566482083655956,
                80.64253270160702,
            ],
            [
                0.7,
                -3.8385270763470003,
                -43.00283333434299,
                -31.68338781764084,
                -8.136229197375751,
                -52.64853413449113,
                -9.177234679417772,
                -15.990887197958543,
                -5.58150484088776,
                51.50352205608752,
            ],
            [
                1.0,
                -8.0303,
                -58.5456,
                -32.5,
                -23.246637762084717,
                -49.29337266145467,
                2.4628192268307885,
                -84.74516990010119,
                27.949247994464713,
                26.096837318903,
            ],
        ],
    },
    Reference {
        points: &ROOT_SUCTION,
        inner_knots: [0.33510956708691736, 0.5012169877804752, 0.6674214756112895],
        length: 54.700630928474084,
        rows: &[
            [
                0.0,
                8.5272,
                -14.6354,
                -10.0,
                -21.25295787356231,
                -28.48049337689713,
                -40.34491272265686,
                17.689071309210533,
                7.044255209400603,
                -35.796314150395574,
            ],
            [
                0.085,
                6.790990929125674,
                -17.05560287823024,
                -13.527984805999589,
                -19.523836990845986,
                -28.757319206613822,
                -42.30594200327997,
                22.996125931173417,
                -13.557804143911227,
                -10.345551276030534,
            ],
            [
                0.25,
                3.929337595253959,
                -22.16658091284325,
                -20.42512148823279,
                -14.879567023479217,
                -34.293716101499825,
                -39.93709314468032,
                33.29805549145412,
                -53.550037006222055,
                39.058870774208,
            ],
            [
                0.4375,
                1.7359683020020513,
                -29.719725096924012,
                -26.928734445698463,
                -9.219360071599892,
                -46.11847101039324,
                -28.256922134317904,
                12.175844569799919,
                -50.62379150818663,
                77.49113520636661,
            ],
            [
                0.7,
                -0.5565171104995571,
                -42.99704148907351,
                -31.677734643964754,
                -7.755658786505127,
                -53.31675205380595,
                -9.306539602321301,
                5.513621390170705,
                -9.658125922201918,
                54.465167362224264,
            ],
            [
                1.0,
                -3.9268,
                -58.9631,
                -32.5,
                -19.018554530519783,
                -51.57836211332267,
                2.220650539956466,
                -80.59959301693505,
                21.247392192090047,
                22.382766919627556,
            ],
        ],
    },
    Reference {
        points: &TIP_PRESSURE,
        inner_knots: [0.33685914806232736, 0.5042496623796291, 0.6714615008342296],
        length: 41.50900519339924,
        rows: &[
            [
                0.0,
                15.0578,
                -38.5221,
                0.0,
                -35.24935530903889,
                -13.73237279007742,
                -19.67296389337978,
                53.00484156357126,
                30.813566305791255,
                -60.4034165298396,
            ],
            [
                0.085,
                12.230437761817388,
                -39.587733219651895,
                -1.8687304444505235,
                -31.54325061364267,
                -11.45541521084914,
                -24.042119167799555,
                34.19762185751604,
                22.76190614663824,
                -42.40023698591985,
            ],
            [
                0.25,
                7.325660887470288,
                -41.23895001514332,
                -6.254279739169597,
                -28.912563927725206,
                -8.989150389788762,
                -28.155002017045653,
                -2.3105105130617796,
                7.132212896517672,
                -7.45288845948744,
            ],
            [
                0.4375,
                1.8057797041842019,
                -42.96726771589185,
                -11.528658808079145,
                -27.722750458822773,
                -11.229334661783618,
                -28.720838422091788,
                65.74884625344293,
                -48.63283316142099,
                -25.201823624717974,
            ],
            [
                0.7,
                -2.803257047692819,
                -48.27472541429576,
                -19.60150750799761,
                -14.106392493298655,
                -28.911923023792333,
                -26.29731465330516,
                -23.131549563166864,
                -55.17335109593205,
                77.62599674472541,
            ],
            [
                1.0,
                -7.3561,
                -58.6341,
                -24.5,
                -13.845912101999446,
                -37.49389714506776,
                -8.03419512512238,
                24.868085505161616,
                -2.0398097125703316,
                44.12813344315987,
            ],
        ],
    },
    Reference {
        points: &TIP_SUCTION,
        inner_knots: [0.3341867625405346, 0.5008778335259909, 0.6673899948390725],
        length: 41.3117569283646,
        rows: &[
            [
                0.0,
                17.0533,
                -37.6813,
                0.0,
                -31.637425409816203,
                -16.163655583414197,
                -21.311032732299644,
                2.4477047763030555,
                45.29559422685361,
                -29.03012660455269,
            ],
            [
                0.085,
                14.380788420301263,
                -38.909677983763416,
                -1.913800660360359,
                -31.153114740374633,
                -12.952268661815591,
                -23.690059814484588,
                8.94784038702875,
                30.266450987230314,
                -26.94698121156368,
            ],
            [
                0.25,
                9.41958073340853,
                -40.76717826865479,
                -6.171127783064331,
                -28.63574347650306,
                -10.365177335385937,
                -27.802702106603615,
                21.565750690202307,
                1.0922317573716782,
                -22.903228389879104,
            ],
            [
                0.4375,
                4.510616016549015,
                -42.898660682302804,
                -11.742895983981612,
                -23.331066816931177,
                -13.644705745367446,
                -31.175246055332202,
                34.29482635332327,
                -39.344408763480146,
                -8.802712417881992,
            ],
            [
                0.7,
                -0.36531541850177424,
                -48.38023100506964,
                -19.59922405756485,
                -14.0662812019227,
                -29.311902007132762,
                -25.388892472446795,
                27.063880068863707,
                -63.16609393783574,
                55.19890668047546,
            ],
            [
                1.0,
                -4.2774,
                -58.9387,
                -24.5,
                -15.047865421466412,
                -37.48597184436272,
                -6.5098104815292,
                -33.60777486582177,
                8.672295022969138,
                70.66163992564157,
            ],
        ],
    },
];

#[test]
fn curves_agree_with_scipy() {
    for r in &REFERENCES {
        let c = curve(r.points);
        for (own, other) in c.knots()[4..7].iter().zip(&r.inner_knots) {
            assert!((own - other).abs() < 1e-15, "knot {own} {other}");
        }
        assert!((c.length(0.0, 1.0) - r.length).abs() < 1e-9, "length {}", c.length(0.0, 1.0));
        assert!((c.length(0.1, 0.35) + c.length(0.35, 0.8) - c.length(0.1, 0.8)).abs() < 1e-9);
        assert_eq!(c.length(0.8, 0.1), -c.length(0.1, 0.8));
        for row in r.rows {
            let d = c.derivatives(row[0]);
            let vector = |i: usize| Vector3::new(row[i], row[i + 1], row[i + 2]);
            assert!((d.point.coords - vector(1)).norm() < 1e-12, "point at {}", row[0]);
            assert!((d.first - vector(4)).norm() < 1e-11, "first at {}", row[0]);
            assert!((d.second - vector(7)).norm() < 1e-9, "second at {}", row[0]);
            assert_eq!(d.point, c.point(row[0]));
        }
    }
}

#[test]
fn interpolation_leaves_no_residual() {
    for r in &REFERENCES {
        let points: Vec<_> = r.points.iter().map(|p| Point3::from(*p)).collect();
        for degree in 1..=3 {
            let c = interpolate(&points, degree).unwrap();
            for (u, p) in chord_parameters(&points).unwrap().iter().zip(&points) {
                assert!((c.point(*u) - p).norm() < 2e-14 * 60.0, "{}", (c.point(*u) - p).norm());
            }
        }
    }
}

// Random curves and surfaces.

/// Clamped knots from gaps, some of them doubled.
fn knots_of(degree: usize, gaps: &[(f64, bool)]) -> Vec<f64> {
    let total: f64 = gaps.iter().map(|g| g.0).sum();
    let mut knots = vec![0.0; degree + 1];
    let mut sum = 0.0;
    for (gap, doubled) in &gaps[..gaps.len() - 1] {
        sum += gap / total;
        knots.push(sum);
        if *doubled && degree > 1 {
            knots.push(sum);
        }
    }
    knots.extend(vec![1.0; degree + 1]);
    knots
}

fn axis() -> impl Strategy<Value = (usize, Vec<f64>)> {
    (1..=3usize, prop::collection::vec((0.2..1.0f64, prop::bool::weighted(0.2)), 1..6))
        .prop_map(|(degree, gaps)| (degree, knots_of(degree, &gaps)))
}

fn net(count: usize) -> impl Strategy<Value = (Vec<Point3<f64>>, Vec<f64>)> {
    let coordinate = || -50.0..50.0f64;
    let point = (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Point3::new(x, y, z));
    (prop::collection::vec(point, count), prop::collection::vec(0.3..3.0f64, count))
}

fn random_curve(rational: bool) -> impl Strategy<Value = NurbsCurve> {
    axis().prop_flat_map(move |(degree, knots)| {
        net(knots.len() - degree - 1).prop_map(move |(points, weights)| {
            NurbsCurve::try_new(degree, knots.clone(), &points, rational.then_some(&weights[..])).unwrap()
        })
    })
}

fn random_surface() -> impl Strategy<Value = NurbsSurface> {
    (axis(), axis()).prop_flat_map(|((p, u), (q, v))| {
        net((u.len() - p - 1) * (v.len() - q - 1)).prop_map(move |(points, weights)| {
            NurbsSurface::try_new([p, q], [u.clone(), v.clone()], &points, Some(&weights)).unwrap()
        })
    })
}

/// A parameter well inside of a knot span, and a difference step that stays inside.
fn inside(knots: &[f64], choice: f64, fraction: f64) -> (f64, f64) {
    let spans: Vec<_> = knots.windows(2).filter(|k| k[1] > k[0]).collect();
    let span = spans[((choice * spans.len() as f64) as usize).min(spans.len() - 1)];
    let width = span[1] - span[0];
    (span[0] + width * (0.1 + 0.8 * fraction), width * 2e-3)
}

/// Central difference of fourth order.
fn difference<T>(f: impl Fn(f64) -> T, x: f64, h: f64) -> T
where
    T: std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let near = (f(x + h) - f(x - h)) * (8.0 / (12.0 * h));
    let far = (f(x + 2.0 * h) - f(x - 2.0 * h)) * (1.0 / (12.0 * h));
    near - far
}

/// The ranges of a jet hold derivatives of a place, but for rounding.
fn held(jet: &Jet, derivatives: &[f64; 3], at: f64) -> Result<(), TestCaseError> {
    for (range, value) in jet.orders.iter().zip(derivatives) {
        let rounding = 1e-9 * (1.0 + value.abs() + range.high.abs().min(1e9));
        let held = (range.low - rounding..=range.high + rounding).contains(value);
        prop_assert!(held, "{value} at {at}: {range:?}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn curve_derivatives_are_limits_of_differences(
        c in random_curve(true), choice in 0.0..1.0f64, fraction in 0.0..1.0f64,
    ) {
        let (u, h) = inside(c.knots(), choice, fraction);
        let d = c.derivatives(u);
        let first = difference(|x| c.derivatives(x).point.coords, u, h);
        let second = difference(|x| c.derivatives(x).first, u, h);
        prop_assert!((d.first - first).norm() < 1e-6 * (1.0 + d.first.norm()), "{} {}", d.first, first);
        prop_assert!((d.second - second).norm() < 1e-5 * (1.0 + d.second.norm()), "{} {}", d.second, second);
    }

    #[test]
    fn surface_derivatives_are_limits_of_differences(
        s in random_surface(), cu in 0.0..1.0f64, fu in 0.0..1.0f64, cv in 0.0..1.0f64, fv in 0.0..1.0f64,
    ) {
        let (u, hu) = inside(&s.knots()[0], cu, fu);
        let (v, hv) = inside(&s.knots()[1], cv, fv);
        let d = s.derivatives(u, v);
        prop_assert!((d.point - s.point(u, v)).norm() < 1e-12);
        let check = |own: Vector3<f64>, other: Vector3<f64>, scale: f64| (own - other).norm() < 1e-5 * (1.0 + scale);
        prop_assert!(check(d.su, difference(|x| s.point(x, v).coords, u, hu), d.su.norm()));
        prop_assert!(check(d.sv, difference(|x| s.point(u, x).coords, v, hv), d.sv.norm()));
        prop_assert!(check(d.suu, difference(|x| s.derivatives(x, v).su, u, hu), d.suu.norm() + d.su.norm()));
        prop_assert!(check(d.svv, difference(|x| s.derivatives(u, x).sv, v, hv), d.svv.norm() + d.sv.norm()));
        prop_assert!(check(d.suv, difference(|x| s.derivatives(u, x).su, v, hv), d.suv.norm() + d.su.norm()));
        prop_assert!(check(d.suv, difference(|x| s.derivatives(x, v).sv, u, hu), d.suv.norm() + d.sv.norm()));
    }

    /// Ranges over a part of a curve hold every value and derivative in it.
    #[test]
    fn ranges_of_a_curve_hold_its_derivatives(c in random_curve(true), from in 0.0..=1.0f64, width in 0.0..0.5f64) {
        let to = (from + width).min(1.0);
        let jets = c.jets([from, to]);
        for t in (0..=20).map(|k| from + (to - from) * f64::from(k) / 20.0) {
            let d = c.derivatives(t);
            // Differences of the second derivative do not reach over its jumps.
            let near = c.knots().iter().any(|knot| (knot - t).abs() < 1e-4);
            for (k, jet) in jets.iter().enumerate() {
                held(jet, &[d.point[k], d.first[k], d.second[k]], t)?;
                let third = difference(|u| c.derivatives(u.clamp(0.0, 1.0)).second[k], t, 1e-5);
                let (range, reserve) = (jet.orders[3], 1e-3 * (1.0 + third.abs() + d.second.norm()));
                prop_assert!(near || (range.low - reserve..=range.high + reserve).contains(&third), "{third} at {t}: {range:?}");
            }
        }
    }

    /// The same for the meridian of a turned curve, also beyond its ends, for a parameter that moves twice as fast.
    #[test]
    fn ranges_of_a_meridian_hold_its_derivatives(c in random_curve(true), from in -0.3..1.1f64, width in 0.0..0.4f64) {
        let surface = Revolution::new(c, Vector2::new(100.0, 0.0));
        let jets = surface.meridian_jets(&(Jet::parameter([0.5 * from, 0.5 * (from + width)]) * 2.0));
        for u in (0..=20).map(|k| from + width * f64::from(k) / 20.0) {
            let m = surface.meridian(u);
            for (k, jet) in jets.iter().enumerate() {
                held(jet, &[m.point[k], 2.0 * m.first[k], 4.0 * m.second[k]], u)?;
            }
        }
    }

    /// The same along a slanted line of a lofted surface, also beyond its first and last section.
    #[test]
    fn ranges_of_a_lofted_surface_hold_its_derivatives(
        sections in prop::collection::vec(random_curve(false), 2..6), from in 0.0..=0.9f64, width in 0.0..0.1f64,
        v in -0.3..1.2f64, slope in -2.0..2.0f64,
    ) {
        let Ok(surface) = LoftedSurface::through(sections) else { return Ok(()) };
        let u = Jet::parameter([from, from + width]);
        let line = u * slope + Jet::constant(Interval::of(v - slope * from));
        let jets = surface.partials([from, from + width], line.orders[0].into()).along(&u, &line);
        for u in (0..=20).map(|k| from + width * f64::from(k) / 20.0) {
            let d = surface.derivatives(u, v + slope * (u - from));
            let second = d.suu + d.suv * (2.0 * slope) + d.svv * (slope * slope);
            for (k, jet) in jets.iter().enumerate() {
                held(jet, &[d.point[k], d.su[k] + d.sv[k] * slope, second[k]], u)?;
            }
        }
    }

    #[test]
    fn knot_insertion_and_elevation_keep_the_curve(
        c in random_curve(true), more in prop::collection::vec(0.01..0.99f64, 0..4), at in 0.0..=1.0f64,
    ) {
        let mut knots = c.knots().to_vec();
        for u in &more {
            let place = knots.partition_point(|k| k <= u);
            knots.insert(place, *u);
        }
        let fine = c.refined(&knots);
        prop_assert_eq!(fine.knots(), &knots[..]);
        prop_assert_eq!(fine.control().len(), c.control().len() + more.len());
        let high = c.elevated();
        prop_assert_eq!(high.degree(), (c.degree() + 1).min(3));
        for u in [0.0, at, 1.0] {
            prop_assert!((fine.point(u) - c.point(u)).norm() < 1e-11);
            prop_assert!((high.point(u) - c.point(u)).norm() < 1e-11);
        }
        let inner = (!c.knots().contains(&at)).then(|| (c.derivatives(at), high.derivatives(at)));
        if let Some((a, b)) = inner {
            prop_assert!((a.first - b.first).norm() < 1e-9 * (1.0 + a.first.norm()));
        }
    }

    #[test]
    fn ruled_surface_is_the_blend_of_its_guides(
        root in random_curve(false), tip in random_curve(false), u in 0.0..=1.0f64, v in 0.0..=1.0f64,
    ) {
        let ruled = RuledSurface { root: root.clone(), tip: tip.clone() };
        let s = ruled.to_surface().unwrap();
        let degree = root.degree().max(tip.degree());
        prop_assert_eq!(s.degree(), [degree, 1]);
        let blend = root.point(u).coords * (1.0 - v) + tip.point(u).coords * v;
        prop_assert!((s.point(u, v).coords - blend).norm() < 1e-11);
        prop_assert!((ruled.point(u, v).coords - blend).norm() < 1e-12);
        prop_assert!((s.border(false).point(u) - root.point(u)).norm() < 1e-11);
        prop_assert!((s.border(true).point(u) - tip.point(u)).norm() < 1e-11);
    }

    #[test]
    fn revolution_is_the_turned_generator(c in random_curve(true), u in 0.0..=1.0f64, quarter in 0..4usize, t in 0.0..=1.0f64) {
        let s = Revolution::new(c.clone(), Vector2::new(1000.0, 0.0)).to_surface();
        // On the quarter arc with weights 1, w, 1 the angle at t has this tangent.
        let (a, b, e) = ((1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t) * FRAC_1_SQRT_2, t * t);
        let angle = PI / 2.0 * quarter as f64 + (b + e).atan2(a + b);
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), angle) * c.point(u);
        let own = s.point(u, (quarter as f64 + t) / 4.0);
        prop_assert!((own - turned).norm() < 1e-11, "{own} {turned}");
        prop_assert!((c.rotated(angle).point(u) - turned).norm() < 1e-11);
        prop_assert!((s.rotated(0.3).point(u, 0.1) - Rotation3::from_axis_angle(&Vector3::z_axis(), 0.3) * s.point(u, 0.1)).norm() < 1e-11);
    }

    #[test]
    fn curves_and_surfaces_agree_with_curvo(c in random_curve(true), s in random_surface(), u in 0.001..0.999f64, v in 0.001..0.999f64) {
        let homogeneous = |x: &nalgebra::Vector4<f64>| Point4::new(x.x, x.y, x.z, x.w);
        let other = curvo::prelude::NurbsCurve3D::try_new(
            c.degree(), c.control().iter().map(homogeneous).collect(), c.knots().to_vec()).unwrap();
        let d = c.derivatives(u);
        let e = other.rational_derivatives(u, 2);
        prop_assert!((d.point.coords - e[0]).norm() < 1e-11);
        prop_assert!((d.first - e[1]).norm() < 1e-10 * (1.0 + e[1].norm()));
        prop_assert!((d.second - e[2]).norm() < 1e-9 * (1.0 + e[2].norm() + e[1].norm()));

        let [_, columns] = s.counts();
        let [ku, kv] = s.knots().clone();
        let other = curvo::prelude::NurbsSurface3D::new(
            s.degree()[0], s.degree()[1], ku, kv,
            s.control().chunks(columns).map(|row| row.iter().map(homogeneous).collect()).collect());
        let d = s.derivatives(u, v);
        let e = other.rational_derivatives(u, v, 2);
        for (own, other) in [(d.point.coords, e[0][0]), (d.su, e[1][0]), (d.sv, e[0][1]), (d.suu, e[2][0]), (d.suv, e[1][1]), (d.svv, e[0][2])] {
            let scale = 1.0 + other.norm() + d.su.norm() + d.sv.norm();
            prop_assert!((own - other).norm() < 1e-9 * scale, "{own} {other}");
        }
    }

    #[test]
    fn closest_point_of_a_ruled_surface_beats_a_dense_search(x in -20.0..30.0f64, y in -70.0..-10.0f64, z in -45.0..10.0f64) {
        let ruled = RuledSurface { root: curve(&ROOT_PRESSURE), tip: curve(&TIP_PRESSURE) };
        let p = Point3::new(x, y, z);
        let found = ruled.closest(&p, Patch::WHOLE);
        prop_assert!((0.0..=1.0).contains(&found.u) && (0.0..=1.0).contains(&found.v));
        prop_assert!((ruled.point(found.u, found.v) - found.point).norm() < 1e-12);
        let mut dense = f64::INFINITY;
        for i in 0..=400 {
            for j in 0..=100 {
                dense = dense.min((ruled.point(f64::from(i) / 400.0, f64::from(j) / 100.0) - p).norm());
            }
        }
        prop_assert!(found.distance <= dense + 1e-12, "{} {dense}", found.distance);
        prop_assert!(dense - found.distance < 0.15, "{} {dense}", found.distance);
        // Inside of the patch the gap is perpendicular to the surface.
        let inner = |t: f64| (1e-9..=1.0 - 1e-9).contains(&t);
        if inner(found.u) && inner(found.v) && found.distance > 1e-6 {
            let (_, su, sv) = ruled.tangents(found.u, found.v);
            let gap = (p - found.point).normalize();
            prop_assert!(gap.dot(&su.normalize()).abs() < 1e-7 && gap.dot(&sv.normalize()).abs() < 1e-7);
        }
    }

    #[test]
    fn closest_point_of_a_meridian_beats_a_dense_search(r in 1.0..80.0f64, z in -60.0..20.0f64) {
        let hub = Revolution::new(curve(&ROOT_PRESSURE), Vector2::new(50.0, 0.0));
        let at = Vector2::new(r, z);
        let (u, distance) = hub.closest(at);
        let mut dense = f64::INFINITY;
        for i in -2000..=4000 {
            dense = dense.min((hub.meridian(f64::from(i) / 2000.0).point - at).norm());
        }
        prop_assert!(distance.abs() <= dense + 1e-12, "{distance} {dense} at {u}");
        prop_assert!(((hub.meridian(u).point - at).norm() - distance.abs()).abs() < 1e-12);
    }
}

// Exact shapes.

/// Quarter of a circle in the meridian plane y = 0.
fn arc(centre: [f64; 2], radius: f64, from: f64) -> NurbsCurve {
    let at = |angle: f64, r: f64| Point3::new(centre[0] + r * angle.cos(), 0.0, centre[1] + r * angle.sin());
    let points = [at(from, radius), at(from + PI / 4.0, radius / FRAC_1_SQRT_2), at(from + PI / 2.0, radius)];
    NurbsCurve::try_new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], &points, Some(&[1.0, FRAC_1_SQRT_2, 1.0])).unwrap()
}

fn line(a: [f64; 3], b: [f64; 3]) -> NurbsCurve {
    NurbsCurve::try_new(1, vec![0.0, 0.0, 1.0, 1.0], &[Point3::from(a), Point3::from(b)], None).unwrap()
}

fn each_parameter(mut f: impl FnMut(f64, f64)) {
    for i in 0..=20 {
        for j in 0..=37 {
            f(f64::from(i) / 20.0, f64::from(j) / 37.0);
        }
    }
}

#[test]
fn circle_is_exact() {
    let c = arc([3.0, -2.0], 7.0, 0.4);
    for i in 0..=100 {
        let u = f64::from(i) / 100.0;
        let p = c.point(u);
        assert!(((p.x - 3.0).hypot(p.z + 2.0) - 7.0).abs() < 1e-13 * 7.0);
        assert!((c.curvature(u) - 1.0 / 7.0).abs() < 1e-13);
    }
    assert!((c.length(0.0, 1.0) - 7.0 * PI / 2.0).abs() < 1e-9);
}

#[test]
fn cylinder_cone_sphere_torus_have_exact_curvatures() {
    let cylinder = Revolution::new(line([5.0, 0.0, 0.0], [5.0, 0.0, 12.0]), Vector2::new(9.0, 3.0));
    each_parameter(|u, v| {
        let k = cylinder.to_surface().derivatives(u, v).curvature().unwrap();
        assert!(k.gauss.abs() < 1e-13 && (k.mean.abs() - 0.1).abs() < 1e-12);
        assert!((cylinder.ring_curvature(u) - 0.2).abs() < 1e-14 && cylinder.meridian_curvature(u).abs() < 1e-14);
        // The curved direction runs around, the straight one along Z.
        let straight = k.directions[usize::from(k.principal[0].abs() > k.principal[1].abs())];
        assert!((straight.z.abs() - 1.0).abs() < 1e-12);
    });
    // Cone with r = 2 + z: at r the curvature across the line is cos(45 deg) / r.
    let cone = Revolution::new(line([2.0, 0.0, 0.0], [12.0, 0.0, 10.0]), Vector2::new(20.0, 0.0));
    each_parameter(|u, v| {
        let s = cone.to_surface().derivatives(u, v);
        let r = s.point.x.hypot(s.point.y);
        let k = s.curvature().unwrap();
        assert!(k.gauss.abs() < 1e-12);
        assert!((k.mean.abs() - 0.5 * FRAC_1_SQRT_2 / r).abs() < 1e-12);
        assert!((cone.ring_curvature(u) - FRAC_1_SQRT_2 / r).abs() < 1e-12);
    });
    // From the equator to short of the pole.
    let sphere = Revolution::new(arc([0.0, 1.0], 8.0, -0.6), Vector2::new(30.0, 1.0));
    each_parameter(|u, v| {
        let s = sphere.to_surface().derivatives(u, v);
        assert!(((s.point - Point3::new(0.0, 0.0, 1.0)).norm() - 8.0).abs() < 1e-12);
        let k = s.curvature().unwrap();
        assert!((k.gauss - 1.0 / 64.0).abs() < 1e-12 && (k.mean.abs() - 0.125).abs() < 1e-12);
        assert!((k.principal[0] - k.principal[1]).abs() < 1e-7);
        assert!((sphere.ring_curvature(u) - 0.125).abs() < 1e-12);
        assert!((sphere.meridian_curvature(u) - 0.125).abs() < 1e-12);
    });
    let (big, small) = (20.0, 3.0);
    let torus = Revolution::new(arc([big, 0.0], small, 0.5), Vector2::new(20.0, 40.0));
    each_parameter(|u, v| {
        let s = torus.to_surface().derivatives(u, v);
        let rho = s.point.x.hypot(s.point.y);
        assert!(((rho - big).hypot(s.point.z) - small).abs() < 1e-12);
        let cos = (rho - big) / small;
        let expected = [1.0 / small, cos / (big + small * cos)];
        let k = s.curvature().unwrap();
        assert!((k.gauss - expected[0] * expected[1]).abs() < 1e-12);
        assert!((k.mean.abs() - 0.5 * (expected[0] + expected[1])).abs() < 1e-12);
        assert!((torus.meridian_curvature(u) - expected[0]).abs() < 1e-12);
        assert!((torus.ring_curvature(u) - expected[1]).abs() < 1e-12);
    });
}

#[test]
fn curvature_signs_follow_the_normal() {
    // The groove inside of a torus: seen from the axis of the tube, the surface bends towards the normal.
    let tube = arc([20.0, 0.0], 3.0, PI);
    let inside = Revolution::new(tube, Vector2::new(20.0, 0.0));
    assert!((inside.meridian_curvature(0.4) + 1.0 / 3.0).abs() < 1e-12);
    // Its centre lies 3 mm out of the material.
    assert!((inside.closest(Vector2::new(20.0, 0.0)).1 - 3.0).abs() < 1e-12);
    let s = inside.to_surface().derivatives(0.4, 0.2);
    let k = s.curvature().unwrap();
    let towards_axis = Point3::new(s.point.x, s.point.y, 0.0).coords.normalize() * 20.0;
    let to_centre = Point3::from(towards_axis) - s.point;
    let sign = k.normal.dot(&to_centre).signum();
    let along_tube = k.along(&s.su);
    assert!((along_tube - sign / 3.0).abs() < 1e-12, "{along_tube} {sign}");
    // Euler: the principal directions give the principal curvatures, and are perpendicular tangents.
    for (d, p) in k.directions.iter().zip(k.principal) {
        assert!((k.along(d) - p).abs() < 1e-14 && d.dot(&k.normal).abs() < 1e-14);
    }
    assert!(k.directions[0].dot(&k.directions[1]).abs() < 1e-14);
    let [[e, f, g], [l, m, n]] = [k.first_form, k.second_form];
    let det = e * g - f * f;
    assert!((k.gauss - (l * n - m * m) / det).abs() < 1e-12, "formula 5 of Xu");
    assert!((k.mean - 0.5 * (e * n - 2.0 * f * m + g * l) / det).abs() < 1e-12, "formula 5 of Xu");
}

#[test]
fn hyperbolic_paraboloid_and_helicoid_have_exact_curvatures() {
    // z = x y, a ruled surface: K = -1 / (1 + x^2 + y^2)^2.
    let saddle =
        RuledSurface { root: line([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]), tip: line([0.0, 1.0, 0.0], [1.0, 1.0, 1.0]) };
    each_parameter(|u, v| {
        let k = saddle.derivatives(u, v).curvature().unwrap();
        let w = 1.0 + u * u + v * v;
        assert!((k.gauss + 1.0 / (w * w)).abs() < 1e-13);
        assert!((k.mean.abs() - u * v / w.powf(1.5)).abs() < 1e-13);
        let nurbs = saddle.to_surface().unwrap().derivatives(u, v);
        assert!((nurbs.curvature().unwrap().gauss - k.gauss).abs() < 1e-13);
    });
    assert_eq!(saddle.to_surface().unwrap().degree(), [1, 1]);
}

#[test]
fn ruled_surface_of_the_paper_stands_on_merged_knots() {
    let ruled = RuledSurface { root: curve(&ROOT_PRESSURE), tip: curve(&TIP_PRESSURE) };
    let s = ruled.to_surface().unwrap();
    // Three inner knots each, all different.
    assert_eq!(s.counts(), [10, 2]);
    assert_eq!(merge_knots(ruled.root.knots(), ruled.tip.knots()).len(), 14);
    each_parameter(|u, v| {
        let (a, b) = (s.derivatives(u, v), ruled.derivatives(u, v));
        assert!((a.point - b.point).norm() < 1e-12 && (a.su - b.su).norm() < 1e-11 && (a.suv - b.suv).norm() < 1e-10);
        assert!((a.suu - b.suu).norm() < 1e-8 && a.svv.norm() < 1e-11);
    });
    let turned = ruled.rotated(TAU / 8.0);
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), TAU / 8.0);
    assert!((turned.point(0.3, 0.6) - turn * ruled.point(0.3, 0.6)).norm() < 1e-13);
}

/// Figures of an independent computation in numpy and scipy.
#[test]
fn faces_of_the_paper_have_the_reference_figures() {
    let pressure = RuledSurface { root: curve(&ROOT_PRESSURE), tip: curve(&TIP_PRESSURE) };
    let suction = RuledSurface { root: curve(&ROOT_SUCTION), tip: curve(&TIP_SUCTION) };
    // Twist largest and mean in degrees, ruling length shortest and longest in mm: scipy 1.17.1 as above, 41 rulings.
    let figures = [
        (&pressure, [32.716_734_535_661_956, 17.595_508_936_745_198, 8.028_846_610_192_526, 26.395_339_155_237_238]),
        (&suction, [26.475_431_710_721_81, 17.875_335_944_776_303, 8.007_716_011_447_96, 26.529_377_829_493_1]),
    ];
    for (face, [largest, mean, shortest, longest]) in figures {
        let rulings: Vec<_> = (0..=40).map(|i| f64::from(i) / 40.0).collect();
        let twists: Vec<_> =
            rulings.iter().map(|u| face.normal(*u, 0.0).angle(&face.normal(*u, 1.0)).to_degrees()).collect();
        let lengths: Vec<_> = rulings.iter().map(|u| (face.point(*u, 1.0) - face.point(*u, 0.0)).norm()).collect();
        assert!((twists.iter().copied().fold(0.0, f64::max) - largest).abs() < 1e-9);
        assert!((twists.iter().sum::<f64>() / 41.0 - mean).abs() < 1e-9);
        assert!((lengths.iter().copied().fold(f64::INFINITY, f64::min) - shortest).abs() < 1e-9);
        assert!((lengths.iter().copied().fold(0.0, f64::max) - longest).abs() < 1e-9);
    }
    // Mean surface of the vane, and the gap between the faces along its normal. Area by Gauss and Legendre in numpy,
    // 20 nodes on each knot span and 40 along the ruling: 828.1207 mm2. (A sum over all nodes of a 201 x 41 grid
    // counts a row and a column too many and gives 853.) Thickness in numpy on the same nodes as here.
    let mean = |u: f64, v: f64| {
        let (a, b) = (pressure.derivatives(u, v), suction.derivatives(u, v));
        ((a.su + b.su) * 0.5, (a.sv + b.sv) * 0.5, a.point - b.point)
    };
    let area: f64 = (0..200 * 40)
        .map(|k| mean((f64::from(k / 40) + 0.5) / 200.0, (f64::from(k % 40) + 0.5) / 40.0))
        .map(|(su, sv, _)| su.cross(&sv).norm() / 8000.0)
        .sum();
    assert!((area - 828.120_723_118_105_5).abs() < 0.01, "{area}");
    let mut thickness = [f64::INFINITY, 0.0f64];
    for k in 0..201 * 41 {
        let (su, sv, gap) = mean(f64::from(k / 41) / 200.0, f64::from(k % 41) / 40.0);
        let t = gap.dot(&su.cross(&sv).normalize()).abs();
        thickness = [thickness[0].min(t), thickness[1].max(t)];
    }
    assert!((thickness[0] - 1.004_221_906_253_840_2).abs() < 1e-9, "{thickness:?}");
    assert!((thickness[1] - 3.944_201_725_488_929).abs() < 1e-9, "{thickness:?}");
    // Neighbouring vanes.
    let next = suction.rotated(-TAU / 8.0);
    let pair = pressure.closest_pair(Patch::WHOLE, &next, Patch::WHOLE);
    assert!((pair.distance - 8.98).abs() < 0.01, "{pair:?}");
    assert!(pair.first.v < 1e-9 && (pair.first.u - 0.085).abs() < 0.01, "{pair:?}");
}

#[test]
fn closest_pair_beats_a_dense_search() {
    let pressure = RuledSurface { root: curve(&ROOT_PRESSURE), tip: curve(&TIP_PRESSURE) };
    for angle in [-0.9, -TAU / 8.0, 0.5, 1.3] {
        let other = RuledSurface { root: curve(&ROOT_SUCTION), tip: curve(&TIP_SUCTION) }.rotated(angle);
        let pair = pressure.closest_pair(Patch::WHOLE, &other, Patch::WHOLE);
        let mut dense = f64::INFINITY;
        for i in 0..=200 {
            for j in 0..=50 {
                let p = pressure.point(f64::from(i) / 200.0, f64::from(j) / 50.0);
                dense = dense.min(other.closest(&p, Patch::WHOLE).distance);
            }
        }
        assert!(pair.distance <= dense + 1e-9 && dense - pair.distance < 0.02, "{} {dense}", pair.distance);
        assert!((pair.first.point - pair.second.point).norm() == pair.distance);
    }
}

#[test]
fn meridian_goes_on_along_its_end_tangents() {
    let hub = Revolution::new(curve(&ROOT_PRESSURE), Vector2::new(50.0, 0.0));
    for (end, out) in [(0.0, -0.2), (1.0, 1.2)] {
        let (a, b) = (hub.meridian(end), hub.meridian(out));
        assert!((b.point - a.point - a.first * (out - end)).norm() < 1e-12);
        let at = b.point + hub.meridian_normal(end) * 0.7;
        let (u, distance) = hub.closest(at);
        assert!((u - out).abs() < 1e-9 && (distance - 0.7).abs() < 1e-12, "{u} {distance}");
    }
}

#[test]
fn what_cannot_be_evaluated_is_refused() {
    let points: Vec<_> = (0..4).map(|i| Point3::new(f64::from(i), 0.0, 0.0)).collect();
    let clamped = || vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let bad = |degree, knots: Vec<f64>, weights: Option<&[f64]>| {
        NurbsCurve::try_new(degree, knots, &points, weights).unwrap_err()
    };
    assert!(NurbsCurve::try_new(3, clamped(), &points, None).is_ok());
    assert_eq!(bad(4, clamped(), None), GeomError::Degree(4));
    assert_eq!(bad(0, clamped(), None), GeomError::Degree(0));
    assert_eq!(bad(3, vec![0.0; 8], None), GeomError::Knots);
    assert_eq!(bad(3, vec![0.0, 1.0], None), GeomError::Knots);
    assert_eq!(bad(3, vec![0.0, 0.1, 0.2, 0.3, 0.7, 0.8, 0.9, 1.0], None), GeomError::Knots);
    assert_eq!(bad(1, vec![0.0, 0.0, 0.5, 0.5, 1.0, 1.0], None), GeomError::Knots);
    assert_eq!(bad(1, vec![0.0, 0.0, f64::NAN, 0.5, 1.0, 1.0], None), GeomError::Knots);
    assert_eq!(bad(3, clamped(), Some(&[1.0, 0.0, 1.0, 1.0])), GeomError::Weight(1));
    assert_eq!(bad(3, clamped(), Some(&[1.0, 1.0, f64::NAN, 1.0])), GeomError::Weight(2));
    let surface = |knots: [Vec<f64>; 2], points: &[Point3<f64>]| NurbsSurface::try_new([1, 1], knots, points, None);
    let flat = || [vec![0.0, 0.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    assert!(surface(flat(), &points).is_ok());
    assert!(surface(flat(), &points[..3]).is_err());
    assert_eq!(surface([vec![], vec![]], &points), Err(GeomError::Knots));
    let mut far = points.clone();
    far[2].x = f64::INFINITY;
    assert_eq!(surface(flat(), &far), Err(GeomError::NotFinite(2)));
    // Guides with different weights have no ruled surface of degree 1 across.
    let ruled = RuledSurface { root: arc([9.0, 0.0], 3.0, 0.0), tip: line([1.0, 1.0, 1.0], [2.0, 2.0, 2.0]) };
    assert_eq!(ruled.to_surface(), Err(GeomError::GuideWeights));
    let ruled = RuledSurface { root: arc([9.0, 0.0], 3.0, 0.0), tip: arc([9.0, 4.0], 2.0, 0.0) };
    assert!((ruled.to_surface().unwrap().point(0.3, 0.4) - ruled.point(0.3, 0.4)).norm() < 1e-12);
}

/// `cargo test --release --test quick evaluation_speed -- --ignored --nocapture` prints the time of one evaluation.
#[test]
#[ignore = "a measurement, not a check"]
#[allow(clippy::print_stdout, reason = "it prints what it measures")]
fn evaluation_speed() {
    let c = curve(&ROOT_PRESSURE);
    let ruled = RuledSurface { root: c.clone(), tip: curve(&TIP_PRESSURE) };
    let s = ruled.to_surface().unwrap();
    let hub = Revolution::new(c.clone(), Vector2::new(50.0, 0.0));
    let time = |name: &str, f: &dyn Fn(f64) -> f64| {
        let start = std::time::Instant::now();
        let sum: f64 = (0..400_000).map(|i| f(f64::from(i) / 400_000.0)).sum();
        println!("{name}: {:.0} ns ({sum:.3})", start.elapsed().as_secs_f64() * 1e9 / 4e5);
    };
    time("curve with two derivatives", &|u| c.derivatives(u).second.x);
    time("surface with two derivatives", &|u| s.derivatives(u, 0.4).suv.x);
    time("closest point of the meridian", &|u| hub.closest(Vector2::new(20.0 + 40.0 * u, -20.0)).1);
    time("closest point of a face", &|u| ruled.closest(&Point3::new(3.0, -20.0 - 30.0 * u, -15.0), Patch::WHOLE).u);
}
