//! Profiles in expressions: values, kinks at their knots, enclosures that hold all values and slopes.

use std::collections::BTreeMap;
use std::sync::Arc;

use proptest::prelude::*;
use steklov_expression::{Expression, Interval, Profile, ProfileError, enclose, leaves};

/// Knots at rising positions from about -1 to 1, some of them on a line with their neighbours.
fn knots() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    let steps = prop::collection::vec((0.01..1.0f64, -1.0..1.0f64, prop::bool::weighted(0.2)), 2..40);
    steps.prop_map(|steps| {
        let whole: f64 = steps.iter().map(|step| step.0).sum();
        let (mut at, mut value, mut before) = (vec![-1.0], vec![0.5], 1.0);
        for (length, slope, straight) in steps {
            let (t, v) = (at[at.len() - 1], value[value.len() - 1]);
            // powers of two, so that points on a line are so to the last bit
            let length = (2.0 * length / whole * 1024.0).ceil() / 1024.0;
            before = if straight { before } else { (slope * 64.0f64).round() / 64.0 };
            at.push(t + length);
            value.push(v + before * length);
        }
        (at, value)
    })
}

fn read(text: &str, at: &[f64], value: &[f64]) -> Expression {
    of_profile(text, Profile::new(at.to_vec(), value.to_vec()).expect("a profile"))
}

fn of_profile(text: &str, profile: Profile) -> Expression {
    let profiles = BTreeMap::from([("rough".to_owned(), Arc::new(profile))]);
    Expression::with_profiles(text, &BTreeMap::new(), &BTreeMap::new(), &profiles).expect("an expression")
}

/// The value by a search from the left.
fn interpolated(at: &[f64], value: &[f64], t: f64) -> f64 {
    let k = (1..at.len() - 1).find(|&k| t < at[k]).unwrap_or(at.len() - 1);
    value[k - 1] + (value[k] - value[k - 1]) / (at[k] - at[k - 1]) * (t - at[k - 1])
}

proptest! {
    #[test]
    fn values_are_those_of_straight_lines_between_the_knots((at, value) in knots(), part in 0.0..1.0f64) {
        let f = read("rough(x)", &at, &value);
        for (t, v) in at.iter().zip(&value) {
            prop_assert_eq!(f.eval(*t, 0.0, 0.0), *v);
        }
        let [first, last] = [at[0], at[at.len() - 1]];
        let t = first + part * (last - first);
        prop_assert!((f.eval(t, 0.0, 0.0) - interpolated(&at, &value, t)).abs() < 1e-13);
        prop_assert!(f.eval(first - 0.01, 0.0, 0.0).is_nan() && f.eval(last + 0.01, 0.0, 0.0).is_nan());
        prop_assert_eq!(f.eval(last + 1e-12, 0.0, 0.0), value[value.len() - 1]);
    }

    /// Along x = a + b t the kinks are the knots at which the slope changes, each once, and no others.
    #[test]
    fn kinks_are_the_knots_at_which_the_slope_changes((at, value) in knots(), turned in any::<bool>()) {
        let [first, last] = [at[0], at[at.len() - 1]];
        let (middle, half) = ((first + last) / 2.0, (last - first) / 2.0 * if turned { -1.0 } else { 1.0 });
        let found = read("3*rough(x) - x^2", &at, &value).kinks(|t: f64| (middle + half * t, 0.0, 0.0));
        let slope = |k: usize| (value[k + 1] - value[k]) / (at[k + 1] - at[k]);
        let bends = (1..at.len() - 1).filter(|&k| slope(k) != slope(k - 1));
        let mut expected: Vec<f64> = bends.map(|k| (at[k] - middle) / half).collect();
        expected.sort_by(f64::total_cmp);
        prop_assert_eq!(found.len(), expected.len(), "{:?} {:?}", found, expected);
        for (found, expected) in found.iter().zip(&expected) {
            prop_assert!((found - expected).abs() < 1e-13, "{} {}", found, expected);
        }
    }

    /// A cubic is its own interpolant by values and slopes, whatever the knots, and has no bends.
    #[test]
    fn a_cubic_comes_back((at, _) in knots(), c in prop::array::uniform4(-1.0..1.0f64), part in 0.0..1.0f64) {
        let cubic = |t: f64| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
        let slope = |t: f64| c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]);
        let (value, slopes) = at.iter().map(|&t| (cubic(t), [slope(t); 2])).unzip();
        let f = of_profile("rough(x)", Profile::with_slopes(at.clone(), value, slopes).unwrap());
        let t = at[0] + part * (at[at.len() - 1] - at[0]);
        prop_assert!((f.eval(t, 0.0, 0.0) - cubic(t)).abs() < 1e-13);
        let half = at[at.len() - 1];
        prop_assert_eq!(f.kinks(|t: f64| (half * t, 0.0, 0.0)), Vec::<f64>::new());
    }

    /// A smooth profile lies between the values at the ends of each piece, and its slope is continuous.
    #[test]
    fn a_smooth_profile_turns_only_where_its_values_do((at, value) in knots(), pick in any::<prop::sample::Index>()) {
        let smooth = Profile::smooth(at.clone(), value.clone()).unwrap();
        prop_assert!(smooth.slopes().iter().all(|[before, behind]| before == behind));
        let k = 1 + pick.index(at.len() - 1);
        let f = of_profile("rough(x)", smooth);
        let [low, high] = [value[k - 1].min(value[k]) - 1e-15, value[k - 1].max(value[k]) + 1e-15];
        for j in 0..=50 {
            let v = f.eval(at[k - 1] + (at[k] - at[k - 1]) * f64::from(j) / 50.0, 0.0, 0.0);
            prop_assert!(low <= v && v <= high, "{} {} {}", low, v, high);
        }
    }

    /// Enclosures hold the values at sampled places and the slopes between them, and are not much wider than need be.
    #[test]
    fn enclosures_hold_all_values_and_slopes(
        (at, value) in knots(), slopes in prop::collection::vec(prop::array::uniform2(-3.0..3.0f64), 41), kind in 0..3_u8,
        a in 0.0..1.0f64, b in 0.0..1.0f64,
    ) {
        prop_assume!((a - b).abs() > 1e-6);
        let [first, last] = [at[0], at[at.len() - 1]];
        let x = |t: f64| (first + t * (last - first)).clamp(first, last);
        let path = |t: f64| (x(t), 0.0, 0.0);
        let profile = match kind {
            0 => Profile::new(at.clone(), value.clone()),
            1 => Profile::smooth(at.clone(), value.clone()),
            _ => Profile::with_slopes(at.clone(), value.clone(), slopes[..at.len()].to_vec()),
        };
        let f = of_profile("rough(x)", profile.unwrap());
        let [low, high] = [a.min(b), a.max(b)];
        let enclosed = enclose([low, high], &|p, q| f.range(&leaves(&path, p, q)));
        let places: Vec<f64> = (0..=200).map(|k| low + (high - low) * f64::from(k) / 200.0).collect();
        let values: Vec<f64> = places.iter().map(|t| f.eval(x(*t), 0.0, 0.0)).collect();
        let tiny = 1e-12;
        for (k, v) in values.iter().enumerate() {
            prop_assert!(enclosed.value.low - tiny <= *v && *v <= enclosed.value.high + tiny);
            if k > 0 {
                let slope = (v - values[k - 1]) / (places[k] - places[k - 1]);
                prop_assert!(enclosed.slope.low - 1e-6 <= slope && slope <= enclosed.slope.high + 1e-6);
            }
        }
        // the extrema of straight lines are at the ends and at knots, those of cubics at places between them too
        let mut seen = Interval::point(values[0]).hull(Interval::point(values[200]));
        let fine = (0..=40_000).map(|k| low + (high - low) * f64::from(k) / 40_000.0);
        let cubic: Vec<f64> = fine.filter(|_| kind == 2).map(|t| f.eval(x(t), 0.0, 0.0)).collect();
        let knots = at.iter().zip(&value).filter(|(t, _)| x(low) <= **t && **t <= x(high)).map(|(_, v)| v);
        knots.chain(&cubic).for_each(|v| seen = seen.hull(Interval::point(*v)));
        let slack = if kind == 2 { 1e-6 } else { 1e-9 };
        prop_assert!(enclosed.value.width() <= seen.width() * (1.0 + slack) + 1e-12, "{:?} {:?}", enclosed, seen);
    }
}

/// Interpolated smoothly, a sine is off by a power of the distance of its knots: the second where it turns, the third elsewhere.
#[test]
fn a_smooth_profile_converges() {
    let error = |n: usize, on: [f64; 2]| {
        let at: Vec<f64> = (0..=n).map(|k| 3.0 * k as f64 / n as f64).collect();
        let value = at.iter().map(|t| (2.0 * t).sin()).collect();
        let f = of_profile("rough(x)", Profile::smooth(at, value).unwrap());
        let places = (0..=5000).map(|k| on[0] + (on[1] - on[0]) * f64::from(k) / 5000.0);
        places.map(|t| (f.eval(t, 0.0, 0.0) - (2.0 * t).sin()).abs()).fold(0.0, f64::max)
    };
    for (on, order) in [([0.0, 3.0], 2.0), ([1.2, 1.9], 3.0)] {
        // where a sine turns the error depends on where its top lies among the knots: over three halvings it evens out
        let rate = (error(50, on) / error(400, on)).log2() / 3.0;
        println!("{on:?}: {rate}");
        assert!((rate - order).abs() < 0.3, "{on:?}: {rate}");
    }
}

#[test]
fn profiles_may_be_composed_and_have_constants() {
    let (at, value) = (vec![0.0, 1.0, 2.0], vec![0.0, 3.0, 1.0]);
    let f = read("2*rough(abs(x)) + y", &at, &value);
    assert_eq!(f.eval(-1.5, 10.0, 0.0), 14.0);
    assert_eq!(f.kinks(|t: f64| (1.75 * t, 0.0, 0.0)), [-1.0 / 1.75, 0.0, 1.0 / 1.75]);
    assert_eq!(read("rough(0.5)", &at, &value).constant(), Some(1.5));
    assert_eq!(f.names(), ["rough"]);
    assert!(read("rough(s)", &at, &value).uses_edge() && f.affine_in_place().is_none());
    // two knots make a straight line, which has no kink
    assert!(read("rough(x)", &[0.0, 1.0], &[0.0, 1.0]).switches().is_empty());
}

#[test]
fn wrong_knots_and_calls_are_refused() {
    let profile = |at: &[f64], value: &[f64]| Profile::new(at.to_vec(), value.to_vec()).expect_err("it is refused");
    assert_eq!(profile(&[0.0], &[1.0]), ProfileError::Count { positions: 1, values: 1 });
    assert_eq!(profile(&[0.0, 1.0], &[1.0]), ProfileError::Count { positions: 2, values: 1 });
    assert_eq!(profile(&[0.0, 0.0], &[1.0, 2.0]), ProfileError::NotRising { knot: 1, position: 0.0, before: 0.0 });
    assert!(matches!(profile(&[0.0, 1.0], &[1.0, f64::NAN]), ProfileError::NotFinite { knot: 1, .. }));
    let steep =
        |slopes: &[[f64; 2]]| Profile::with_slopes(vec![0.0, 1.0], vec![0.0, 1.0], slopes.to_vec()).unwrap_err();
    assert_eq!(steep(&[[0.0; 2]]), ProfileError::Slopes { slopes: 1, knots: 2 });
    assert!(matches!(steep(&[[0.0; 2], [0.0, f64::INFINITY]]), ProfileError::Steep { knot: 1, .. }));
    assert!(matches!(profile(&[0.0, 1e-320], &[0.0, 1.0]), ProfileError::Steep { knot: 0, .. }));
    let profiles =
        BTreeMap::from([("rough".to_owned(), Arc::new(Profile::new(vec![0.0, 1.0], vec![0.0, 1.0]).unwrap()))]);
    let read = |text: &str| Expression::with_profiles(text, &BTreeMap::new(), &BTreeMap::new(), &profiles).unwrap_err();
    for (text, message, help) in [
        ("rough", "the profile rough needs its argument", "rough(x)"),
        ("rough(x, y)", "where \")\" is expected", "one argument"),
        ("rogh(x)", "unknown function rogh", "did you mean rough?"),
        ("rough()", "a value is missing", ""),
    ] {
        let error = read(text);
        assert!(error.message.contains(message) && error.help.contains(help), "{text}: {error:?}");
    }
}
