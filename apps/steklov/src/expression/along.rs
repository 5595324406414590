//! What is known of an expression along an edge, found once.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use steklov_bem_operators::Edge;

use super::Expression;
use super::survey::Survey;

/// An expression along an edge, by the edge parameter.
#[derive(Debug)]
pub struct Along {
    /// Its kinks, rising.
    pub kinks: Vec<f64>,
    /// Its values.
    pub survey: Survey,
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
            let path = |s: f64| {
                let [x, y] = edge.point(s);
                (x, y, s)
            };
            let kinks: Vec<f64> = self.kinks(|t| path((1.0 + t) / 2.0)).into_iter().map(|t| (1.0 + t) / 2.0).collect();
            let survey = Survey::new(self, &path, [0.0, 1.0], &kinks);
            Arc::new(Along { kinks, survey })
        };
        known.entry(key).or_insert_with(new).clone()
    }
}
