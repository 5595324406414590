//! Parts of edges that see another side, kept for the next question.

use std::sync::{Mutex, PoisonError};

/// A part of an edge that sees another side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// The edge.
    pub edge: usize,
    /// Its part, s rising.
    pub s: [f64; 2],
}

/// Spans that are known, by the bits of all that they depend on: of a problem that was changed since, nothing is known.
#[derive(Debug, Default)]
pub struct KnownSpans(Mutex<Vec<(Vec<u64>, Vec<Span>)>>);

impl KnownSpans {
    /// The spans of `key`, found where they are not known.
    pub(super) fn get_or(&self, key: Vec<u64>, find: impl FnOnce() -> Vec<Span>) -> Vec<Span> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, spans)) = known.iter().find(|(of, _)| *of == key) {
            return spans.clone();
        }
        let spans = find();
        known.push((key, spans.clone()));
        spans
    }
}

impl Clone for KnownSpans {
    fn clone(&self) -> Self {
        Self(Mutex::new(self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()))
    }
}
