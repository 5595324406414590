//! Zeros of the switches of an expression along a path.

use super::interval::Interval;
use super::range::{Track, enclose, leaves};
use super::{Expression, Switch};

/// Number of equal steps of the first look at a switch; a power of two, so that t is exact.
const STEPS: usize = 64;
/// Two zeros closer than this are one (t runs from -1 to 1).
const SAME: f64 = 1e-14;
/// Two places at which a switch comes down to its rounding errors without a change of sign, closer than this, are one.
const SAME_TOUCH: f64 = 1e-6;
/// Stretches of a path on which a switch is enclosed at most.
const MOST_STRETCHES: usize = 20_000;
/// A stretch is not halved below this.
const SHORTEST: f64 = 4.0 * f64::EPSILON;
/// One on which nothing is known of a switch, such as one on which it has no value, is not halved below this.
const SHORTEST_UNDEFINED: f64 = 1.0 / 512.0;
/// Minima below this part of the largest value touch zero.
const TOUCH: f64 = 1e-15;

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
    /// Places t ∈ [-1, 1], rising, at which a switch changes sign, reaches or leaves zero along t ↦ (x, y, s), which is
    /// affine.
    ///
    /// Each switch is enclosed on stretches of the path, halved until it has no zero there, or one sign of its slope; a
    /// change of sign is then bisected to 2⁻⁵⁴. A switch that vanishes on the whole path (up to rounding) has no kink there.
    /// None is missed but where 20,000 stretches do not tell, and zeros of a switch that are closer than rounding.
    pub fn kinks(&self, path: impl Track) -> Vec<f64> {
        let mut kinks = Vec::new();
        for switch in &self.code.switches {
            self.zeros(switch, &path, &mut kinks);
        }
        kinks.sort_by(f64::total_cmp);
        kinks.dedup_by(|b, a| *b - *a <= SAME);
        kinks
    }

    /// The kinks that one switch makes.
    fn zeros(&self, switch: &Switch, path: &dyn Track, kinks: &mut Vec<f64>) {
        let value = |t: f64| {
            let (x, y, s) = path.at(t);
            self.switch_value(switch, x, y, s)
        };
        let points: Vec<(f64, f64)> =
            (0..=STEPS).map(|i| 2.0 * i as f64 / STEPS as f64 - 1.0).map(|t| (t, value(t))).collect();
        let largest = points.iter().filter(|p| !p.1.is_nan()).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let Some(&(t, size)) = largest else { return };
        let noise = self.rounding(switch, path.at(t), [path.at(-1.0), path.at(1.0)]);
        let vanishes = size.abs() <= noise;
        let most = if vanishes { MOST_STRETCHES / 20 } else { MOST_STRETCHES };
        let (mut found, mut touches) = (Vec::new(), Vec::new());
        let mut stretches = 0;
        let mut stack: Vec<[(f64, f64); 2]> = points.windows(2).rev().map(|p| [p[0], p[1]]).collect();
        while let Some([a, b]) = stack.pop() {
            stretches += 1;
            let enclosed = enclose([a.0, b.0], &|p, q| self.switch_range(switch, &leaves(path, p, q)));
            let middle = a.0 + (b.0 - a.0) / 2.0;
            let settled = enclosed.monotone || enclosed.value.single().is_some();
            let differ = state(a.1) != state(b.1);
            let last = match enclosed.value {
                Interval::ANY => differ || b.0 - a.0 < SHORTEST_UNDEFINED,
                v => settled || b.0 - a.0 < SHORTEST || v.magnitude() <= TOUCH * size.abs(),
            };
            match enclosed.value {
                v if !v.contains(0.0) => {}
                v if last || stretches > most => {
                    if differ {
                        change(&value, a, b, &mut found);
                    } else if !settled && v != Interval::ANY && stretches <= most {
                        touches.push(if value(middle).abs() <= a.1.abs().min(b.1.abs()) { middle } else { a.0 });
                    }
                }
                _ => {
                    let middle = (middle, value(middle));
                    stack.extend([[middle, b], [a, middle]]);
                }
            }
        }
        if vanishes && found.iter().all(|t| value(*t).abs() <= noise) {
            return;
        }
        touches.dedup_by(|b, a| *b - *a <= SAME_TOUCH);
        touches.retain(|t| found.iter().all(|f| (f - t).abs() > SAME_TOUCH));
        kinks.extend(found);
        kinks.extend(touches);
    }

    /// The effect on the switch at a point of rounding x, y, s to a few units in the last place of the path's ends: Σ |∂f/∂x|
    /// max|x| 8ε.
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

/// The change of state between two points that differ in it: the zero itself where it is met.
fn change(value: &impl Fn(f64) -> f64, mut a: (f64, f64), mut b: (f64, f64), kinks: &mut Vec<f64>) {
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
