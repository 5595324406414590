//! Zeros of the switches of an expression along a path.

use super::{Expression, Switch};

/// Number of equal steps of the first look at a switch; a power of two, so that t is exact.
const STEPS: usize = 128;
/// Two zeros closer than this are one (t runs from -1 to 1).
const SAME: f64 = 1e-14;

/// State of a switch; a change of it is a kink.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Negative,
    Zero,
    Positive,
    Undefined,
}

fn state(value: f64) -> State {
    match value {
        v if v < 0.0 => State::Negative,
        v if v > 0.0 => State::Positive,
        0.0 => State::Zero,
        _ => State::Undefined,
    }
}

impl Expression {
    /// Places t ∈ [-1, 1], rising, at which a switch changes sign, reaches or leaves zero along t ↦ (x, y, s).
    ///
    /// Each switch is looked at in 129 points and wherever its modulus has a minimum between them; a change is then
    /// bisected to 2⁻⁵⁴. A switch that vanishes on the whole path (up to rounding) has no kink there. Missed are zeros
    /// closer to each other than 1/64 with no minimum seen between them.
    pub fn kinks(&self, path: impl Fn(f64) -> (f64, f64, f64)) -> Vec<f64> {
        let mut kinks = Vec::new();
        for switch in &self.code.switches {
            let value = |t: f64| {
                let (x, y, s) = path(t);
                self.switch_value(switch, x, y, s)
            };
            let points: Vec<(f64, f64)> =
                (0..=STEPS).map(|i| 2.0 * i as f64 / STEPS as f64 - 1.0).map(|t| (t, value(t))).collect();
            let largest = points.iter().filter(|p| !p.1.is_nan()).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
            let Some(&(t, size)) = largest else { continue };
            if size.abs() <= self.rounding(switch, path(t), [path(-1.0), path(1.0)]) {
                continue;
            }
            for pair in points.windows(2) {
                change(&value, pair[0], pair[1], &mut kinks);
            }
            for triple in points.windows(3) {
                hidden(&value, [triple[0], triple[1], triple[2]], &mut kinks);
            }
        }
        kinks.sort_by(f64::total_cmp);
        kinks.dedup_by(|b, a| *b - *a <= SAME);
        kinks
    }

    /// What rounding of x, y, s to a few units in the last place of the path's ends does to the switch at a point:
    /// Σ |∂f/∂x| max|x| 8ε.
    fn rounding(&self, switch: &Switch, (x, y, s): (f64, f64, f64), ends: [(f64, f64, f64); 2]) -> f64 {
        const STEP: f64 = 1e-6;
        let [a, b] = ends;
        let scale = (a.0.abs().max(b.0.abs()), a.1.abs().max(b.1.abs()), a.2.abs().max(b.2.abs()));
        let difference = |dx: f64, dy: f64, ds: f64| {
            let value = |sign: f64| self.switch_value(switch, x + sign * dx, y + sign * dy, s + sign * ds);
            (value(STEP) - value(-STEP)).abs() / (2.0 * STEP)
        };
        let sum = difference(scale.0, 0.0, 0.0) + difference(0.0, scale.1, 0.0) + difference(0.0, 0.0, scale.2);
        if sum.is_finite() { 8.0 * f64::EPSILON * sum } else { 0.0 }
    }
}

/// The change of state between two points, if there is one: the zero itself where it is met.
fn change(value: &impl Fn(f64) -> f64, mut a: (f64, f64), mut b: (f64, f64), kinks: &mut Vec<f64>) {
    if state(a.1) == state(b.1) {
        return;
    }
    while b.0 - a.0 > f64::EPSILON / 4.0 {
        let t = a.0 + (b.0 - a.0) / 2.0;
        if t <= a.0 || t >= b.0 {
            break;
        }
        let mid = (t, value(t));
        if state(mid.1) == state(a.1) { a = mid } else { b = mid }
    }
    let at_a = a.1.abs() < b.1.abs() || b.1.is_nan();
    kinks.push(if at_a { a.0 } else { b.0 });
}

/// Zeros between three points of one sign of which the middle one is nearest to zero.
fn hidden(value: &impl Fn(f64) -> f64, [a, m, b]: [(f64, f64); 3], kinks: &mut Vec<f64>) {
    let sign = state(m.1);
    let same = state(a.1) == sign && state(b.1) == sign && matches!(sign, State::Negative | State::Positive);
    let (low, mid, high) = (a.1.abs(), m.1.abs(), b.1.abs());
    if !same || mid > low || mid > high || (mid == low && mid == high) {
        return;
    }
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let modulus = |t: f64| (t, value(t));
    let (mut left, mut right) = (a.0, b.0);
    let mut inner = modulus(right - GOLDEN * (right - left));
    let mut outer = modulus(left + GOLDEN * (right - left));
    while right - left > 1e-9 {
        let found = [inner, outer].into_iter().find(|p| state(p.1) != sign);
        if let Some(zero) = found {
            change(value, a, zero, kinks);
            change(value, zero, b, kinks);
            return;
        }
        if inner.1.abs() <= outer.1.abs() {
            (right, outer) = (outer.0, inner);
            inner = modulus(right - GOLDEN * (right - left));
        } else {
            (left, inner) = (inner.0, outer);
            outer = modulus(left + GOLDEN * (right - left));
        }
    }
    // It touches zero to rounding, as (x - 0.3)^2 does: its root has a kink there.
    if inner.1.abs() <= 1e-15 * low.max(high) {
        kinks.push(inner.0);
    }
}
