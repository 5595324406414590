//! What is known of an expression along an edge, found once.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use steklov_bem_operators::Edge;

use super::Expression;
use super::interval::Interval;
use super::range::{enclose, leaves};
use super::survey::{SHORTEST, Survey, Turn, turns};

/// An expression along an edge, by the edge parameter.
#[derive(Debug)]
pub struct Along {
    /// Its kinks, rising.
    pub kinks: Vec<f64>,
    /// Its values.
    pub survey: Survey,
    turns: OnceLock<Vec<Turn>>,
}

/// [`Along`] of the edges that were asked for, by the bits of their corners.
pub(super) type Known = Mutex<BTreeMap<[u64; 4], Arc<Along>>>;

impl Expression {
    /// What is known along an edge: found when it is asked for, and kept.
    pub fn along(&self, edge: &Edge) -> Arc<Along> {
        let [a, b] = edge.listed();
        let key = [a[0], a[1], b[0], b[1]].map(f64::to_bits);
        let mut known = self.code.known.lock().unwrap_or_else(PoisonError::into_inner);
        let new = || {
            let path = path(edge);
            let kinks: Vec<f64> = self.kinks(|t| path((1.0 + t) / 2.0)).into_iter().map(|t| (1.0 + t) / 2.0).collect();
            let survey = Survey::new(self, &path, [0.0, 1.0], &kinks);
            Arc::new(Along { kinks, survey, turns: OnceLock::new() })
        };
        known.entry(key).or_insert_with(new).clone()
    }

    /// Where it turns along an edge.
    pub fn turns(&self, edge: &Edge) -> Vec<Turn> {
        let along = self.along(edge);
        along.turns.get_or_init(|| turns(self, &path(edge), [0.0, 1.0], along.survey.sampled)).clone()
    }
}

/// Stretches at most that are halved to find values that are not possible.
const MOST_STRETCHES: usize = 2000;

impl Expression {
    /// An edge parameter at which the value is not finite, or below `least`, if one can be found between those that were looked at.
    pub fn impossible(&self, edge: &Edge, least: f64) -> Option<f64> {
        let (along, path) = (self.along(edge), path(edge));
        let allowed = |value: Interval| value.low >= least && value.is_bounded();
        let enclosed = |[a, b]: [f64; 2]| enclose([a, b], &|p, q| self.range(&leaves(&path, p, q))).value;
        let mut stretches: Vec<[f64; 2]> = along.survey.pieces.iter().map(|piece| piece.ends).collect();
        stretches.retain(|stretch| !allowed(enclosed(*stretch)));
        for _ in 0..MOST_STRETCHES {
            let [a, b] = stretches.pop()?;
            let m = a + (b - a) / 2.0;
            let (x, y, s) = path(m);
            let value = self.eval(x, y, s);
            if value < least || !value.is_finite() {
                return Some(m);
            }
            let halves = [[a, m], [m, b]].into_iter();
            stretches.extend(halves.filter(|[p, q]| q - p > SHORTEST && !allowed(enclosed([*p, *q]))));
        }
        None
    }
}

/// Point and edge parameter.
fn path(edge: &Edge) -> impl Fn(f64) -> (f64, f64, f64) {
    let edge = edge.clone();
    move |s| {
        let [x, y] = edge.point(s);
        (x, y, s)
    }
}
