//! The kinks and values of an expression along an edge, found once.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use steklov_bem_operators::Edge;

use super::Expression;
use super::interval::Interval;
use super::range::{Track, enclose, leaves};
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

/// [`Along`] of the requested edges, by the bits of their numbers.
pub(super) type Known = Mutex<BTreeMap<Vec<u64>, Arc<Along>>>;

impl Expression {
    /// The kinks and values along an edge, found on demand and kept.
    pub fn along(&self, edge: &Edge) -> Arc<Along> {
        let key = edge.listed_bits();
        let mut known = self.code.known.lock().unwrap_or_else(PoisonError::into_inner);
        let new = || {
            let path = OnEdge::new(edge, self);
            let kinks: Vec<f64> =
                self.kinks(OnEdge::two_sided(edge, self)).into_iter().map(|t| (1.0 + t) / 2.0).collect();
            let survey = Survey::new(self, &path, [0.0, 1.0], &kinks);
            Arc::new(Along { kinks, survey, turns: OnceLock::new() })
        };
        known.entry(key).or_insert_with(new).clone()
    }

    /// Where it turns along an edge.
    pub fn turns(&self, edge: &Edge) -> Vec<Turn> {
        let along = self.along(edge);
        along.turns.get_or_init(|| turns(self, &OnEdge::new(edge, self), [0.0, 1.0], along.survey.sampled)).clone()
    }
}

/// Largest number of stretches that are halved to find impossible values.
const MOST_STRETCHES: usize = 2000;

impl Expression {
    /// An edge parameter at which the value is not finite, or below `least`, if the search finds one.
    pub fn impossible(&self, edge: &Edge, least: f64) -> Option<f64> {
        let (along, path) = (self.along(edge), OnEdge::new(edge, self));
        let allowed = |value: Interval| value.low >= least && value.is_bounded();
        let enclosed = |[a, b]: [f64; 2]| enclose([a, b], &|p, q| self.range(&leaves(&path, p, q))).value;
        let mut stretches: Vec<[f64; 2]> = along.survey.pieces.iter().map(|piece| piece.ends).collect();
        stretches.retain(|stretch| !allowed(enclosed(*stretch)));
        for _ in 0..MOST_STRETCHES {
            let [a, b] = stretches.pop()?;
            let m = a + (b - a) / 2.0;
            let (x, y, s) = path.at(m);
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

/// An edge as a path of an expression: point, and fraction of the length up to there where the expression uses it.
#[derive(Debug, Clone, Copy)]
pub struct OnEdge<'a> {
    edge: &'a Edge,
    /// Edge parameter at t = 0, and the change of it with t.
    of: [f64; 2],
    uses_edge: bool,
}

impl<'a> OnEdge<'a> {
    /// The whole edge, 0 ≤ t ≤ 1.
    pub fn new(edge: &'a Edge, expression: &Expression) -> Self {
        Self { edge, of: [0.0, 1.0], uses_edge: expression.uses_edge() }
    }

    /// The whole edge, -1 ≤ t ≤ 1.
    pub fn two_sided(edge: &'a Edge, expression: &Expression) -> Self {
        Self { of: [0.5, 0.5], ..Self::new(edge, expression) }
    }
}

impl Track for OnEdge<'_> {
    fn at(&self, t: f64) -> (f64, f64, f64) {
        let parameter = match self.of {
            [start, step] if start == step => (1.0 + t) * start,
            [start, step] => start + step * t,
        };
        let [x, y] = self.edge.point(parameter);
        (x, y, if self.uses_edge { self.edge.drawn_fraction(parameter) } else { parameter })
    }

    fn bend(&self) -> [f64; 2] {
        let step = self.of[1] * self.of[1];
        let bend = self.edge.bend();
        [bend * step, if self.edge.is_arc_length() || !self.uses_edge { 0.0 } else { bend * step / self.edge.length() }]
    }
}
