//! Charts of made-up studies, from plain to extreme. With `STEKLOV_PICTURES=DIR` the files stay in DIR to be looked at.

use crate::frame::{check, check_up_to};
use steklov_picture::{Axis, Band, Chart, ContactSide, Curve, Guide, Scale, Series, chart, contact};

const DOFS: Axis<'_> = Axis { label: "degrees of freedom", scale: Scale::Log };
const ERROR: Axis<'_> = Axis { label: "relative error in the energy norm", scale: Scale::Log };

const BARE: Chart<'_> = Chart {
    title: "",
    x: DOFS,
    y: ERROR,
    quantities: &["error"],
    series: &[],
    flag: "not reliable",
    guides: &[],
    band: None,
};

/// Errors and estimates of made-up strategies over 12 dofs: algebraic for even k, exponential in √N for odd k.
fn histories(count: usize) -> Vec<[Vec<[f64; 2]>; 2]> {
    let dofs = |i: usize| 32.0 * 1.35f64.powi(i as i32);
    let error = |k: usize, n: f64| match (k.is_multiple_of(2), k as f64) {
        (true, k) => 2.0 * n.powf(-0.5 - 0.1 * k),
        (false, k) => (-(0.2 + 0.04 * k) * n.sqrt()).exp(),
    };
    let history = |k: usize| {
        let error = |i: usize| [dofs(i), error(k, dofs(i)) * (1.0 + 0.2 * ((i * (k + 3)) as f64).sin())];
        let estimate = |i: usize| [dofs(i), error(i)[1] * (0.8 + 0.1 * k as f64 + 0.8 / (1.0 + i as f64))];
        [(0..12).map(error).collect(), (0..12).map(estimate).collect()]
    };
    (0..count).map(history).collect()
}

#[test]
fn convergence_of_strategies_with_estimates() {
    let data = histories(5);
    let flags: Vec<bool> = (0..12).map(|i| i < 3).collect();
    let curves: Vec<[Curve<'_>; 2]> =
        data.iter().map(|[e, f]| [Curve { points: e, flagged: &[] }, Curve { points: f, flagged: &flags }]).collect();
    let names = ["uniform h", "uniform p", "h-adaptive", "hp by Legendre decay", "hp, geometric towards found ends"];
    let series: Vec<Series<'_>> = names.iter().zip(&curves).map(|(name, curves)| Series { name, curves }).collect();
    let guides = [Guide { label: "N^-0.5", slope: -0.5 }, Guide { label: "N^-1.5", slope: -1.5 }];
    let all = Chart {
        title: "Block on a floor: five strategies",
        quantities: &["error", "estimate"],
        series: &series,
        guides: &guides,
        ..BARE
    };
    let picture = chart(&all).unwrap();
    check("chart-loglog", &picture);
    for text in [DOFS.label, ERROR.label, "estimate", "not reliable", "N^-0.5", "10⁻³", names[0], names[3]] {
        assert!(picture.svg.contains(&format!(">{text}<")), "{text}");
    }
    assert!(!picture.svg.contains("left out"));
    // Open markers: three flags of each strategy and the key. The others of each strategy: 12 errors, 9 estimates, key.
    assert_eq!(picture.svg.matches("fill=\"#ffffff\"").count(), 3 * 5 + 1);
    assert_eq!(picture.svg.matches("fill=\"#005493\"").count(), 12 + 9 + 1);

    let root = Axis { scale: Scale::SquareRoot, ..DOFS };
    let guides = [Guide { label: "exp(−0.3 √N)", slope: -0.3 }];
    let picture = chart(&Chart { x: root, guides: &guides, ..all }).unwrap();
    check("chart-root", &picture);
    assert!(picture.svg.contains(">degrees of freedom (square-root scale)<") && picture.svg.contains(">100<"));
    let one = Chart { x: Axis { label: "time in s", ..DOFS }, series: &series[3..4], guides: &[], ..all };
    check("chart-one", &chart(&one).unwrap());
}

#[test]
fn effectivity_with_its_band() {
    let ratio = |[e, f]: [Vec<[f64; 2]>; 2]| e.iter().zip(f).map(|(e, f)| [e[0], f[1] / e[1]]).collect();
    let mut ratios: Vec<Vec<[f64; 2]>> = histories(4).into_iter().map(ratio).collect();
    ratios[0][0][1] = 60.0;
    let curves: Vec<[Curve<'_>; 1]> = ratios.iter().map(|points| [Curve { points, flagged: &[] }]).collect();
    let names = ["P1", "P2", "P1u", "L"];
    let series: Vec<Series<'_>> = names.iter().zip(&curves).map(|(name, curves)| Series { name, curves }).collect();
    let picture = chart(&Chart {
        title: "Estimate over error",
        y: Axis { label: "estimate / error", scale: Scale::Linear },
        series: &series,
        band: Some(Band { label: "0.9 to 1.3", y: [0.9, 1.3] }),
        ..BARE
    })
    .unwrap();
    check("chart-effectivity", &picture);
    for text in [">estimate / error<", ">0.9 to 1.3<", ">1 point lies above the frame.<", ">1.0<"] {
        assert!(picture.svg.contains(text), "{text}");
    }
    assert!(!picture.svg.contains(">error<"), "a single quantity is not in the key");
}

#[test]
fn twelve_and_thirty_strategies() {
    for count in [12, 30] {
        let data = histories(count);
        let curves: Vec<[Curve<'_>; 1]> = data.iter().map(|d| [Curve { points: &d[0], flagged: &[] }]).collect();
        let names: Vec<String> =
            (0..count).map(|k| format!("strategy {k} with a name of more than one line")).collect();
        let series: Vec<Series<'_>> = names.iter().zip(&curves).map(|(name, curves)| Series { name, curves }).collect();
        let many = Chart { title: "Many", series: &series, guides: &[Guide { label: "N^-1", slope: -1.0 }], ..BARE };
        check_up_to(&format!("chart-{count}"), &chart(&many).unwrap(), 1500.0);
    }
}

#[test]
fn charts_of_extreme_values() {
    let draw = |name: &str, x: Scale, y: Scale, points: &[[f64; 2]], flagged: &[bool]| {
        let (x, y) = (Axis { scale: x, ..DOFS }, Axis { scale: y, ..ERROR });
        let series = [Series { name: "s", curves: &[Curve { points, flagged }] }];
        let guides = [Guide { label: "N^-1", slope: -1.0 }, Guide { label: "∞", slope: f64::INFINITY }];
        let picture = chart(&Chart { x, y, title: name, series: &series, guides: &guides, ..BARE }).unwrap();
        check(name, &picture);
        picture.svg
    };
    let (log, linear, root) = (Scale::Log, Scale::Linear, Scale::SquareRoot);
    for (name, x, y) in [("log", log, log), ("root", root, log), ("linear", linear, linear), ("mixed", linear, log)] {
        let draw = |case: &str, points: &[[f64; 2]]| draw(&format!("chart-{name}-{case}"), x, y, points, &[]);
        draw("none", &[]);
        assert!(!draw("point", &[[100.0, 1e-3]]).contains("left out"));
        draw("wide", &[[1.0, 1e3], [10.0, 1e-14], [1e5, 1.0]]);
        draw("upright", &[[100.0, 1.0], [100.0, 1e-3], [100.0, 1e-6]]);
        draw("level", &[[10.0, 0.1], [1000.0, 0.1], [1e5, 0.1 + 1e-15]]);
        draw("widest", &[[f64::MIN_POSITIVE, 1e-300], [1e299, 1e299]]);
        draw("close", &[[1e6, 1.0], [1e6 + 1.0, 1.0 + 1e-9]]);
        let bad = [[10.0, 0.1], [20.0, f64::NAN], [30.0, f64::INFINITY], [f64::NAN, 0.1], [40.0, 0.05]];
        assert!(draw("bad", &bad).contains(">3 points are left out"));
    }
    let negative = draw("chart-negative", log, log, &[[10.0, 0.1], [20.0, 0.0], [-1.0, 1.0]], &[false, true, true]);
    assert!(negative.contains(">2 points are left out"));
    assert!(negative.contains(">N^-1<") != negative.contains("slope N^-1"), "a slope is drawn or excused");
    assert!(negative.contains("No room for the slope ∞."));
    check("chart-empty", &chart(&BARE).unwrap());
}

/// A pressure that is infinite at one place leaves the panel, and the key says how far; no line goes over a place without values.
#[test]
fn usual_pressures_can_be_read_beside_an_infinite_one() {
    let position: Vec<f64> = (0..=200).map(|i| f64::from(i) / 200.0).collect();
    let pressure: Vec<f64> = position.iter().map(|x| 10.0 + 1e5 * (-((x - 0.5) / 1e-4).powi(2)).exp()).collect();
    let part = ContactSide {
        title: "a ridge",
        x_label: "x",
        stress: None,
        position: &position,
        pressure: &pressure,
        shear: &vec![0.0; position.len()],
        bound: &[],
    };
    let picture = contact(&part).unwrap();
    assert!(picture.svg.contains("(to 100010 beyond this panel)"), "the largest one is in the key");
    assert!(picture.svg.contains(">20<") && !picture.svg.contains(">100000<"), "ticks are those of usual pressures");
    let flat = contact(&ContactSide { pressure: &vec![10.0; position.len()], ..part }).unwrap();
    assert!(!flat.svg.contains("beyond this panel"));
}
