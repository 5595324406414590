//! Random fields on a side or over the body, as expressions use them.

use std::sync::Arc;

use steklov_stochastic::Field;

/// A field and where it lives.
#[derive(Debug, Clone)]
pub struct RandomField {
    /// Its name in expressions.
    pub name: String,
    /// Its Karhunen-Loève expansion.
    pub expansion: Field,
    /// What its coordinates are.
    pub support: Support,
}

/// Domain of a field.
#[derive(Debug, Clone, PartialEq)]
pub enum Support {
    /// The edges of a side, joined end to end in the order of the scene: the coordinate is the arc length.
    Side {
        /// Name of the side.
        name: String,
        /// Its edges.
        edges: Vec<[[f64; 2]; 2]>,
    },
    /// The bounding box of the body: coordinates from its lower left.
    Body {
        /// Lower left.
        corner: [f64; 2],
    },
}

impl Support {
    /// Coordinates of a point; of a point beside the side, of the nearest one on it.
    pub fn coordinates(&self, point: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Body { corner } => [point[0] - corner[0], point[1] - corner[1]],
            Self::Side { edges, .. } => {
                let (mut start, mut nearest, mut arc) = (0.0, f64::INFINITY, 0.0);
                for [a, b] in edges {
                    let d = [b[0] - a[0], b[1] - a[1]];
                    let length = d[0].hypot(d[1]);
                    let to = [point[0] - a[0], point[1] - a[1]];
                    let t = ((to[0] * d[0] + to[1] * d[1]) / (length * length)).clamp(0.0, 1.0);
                    let off = (to[0] - t * d[0]).hypot(to[1] - t * d[1]);
                    if off < nearest {
                        (nearest, arc) = (off, start + t * length);
                    }
                    start += length;
                }
                [arc, 0.0]
            }
        }
    }
}

/// One outcome of a field; without a field the mean outcome, 0.
#[derive(Debug, Clone, Default)]
pub struct FieldValue {
    outcome: Option<(Arc<RandomField>, Vec<f64>)>,
}

impl FieldValue {
    /// The outcome for the germs of the field's modes.
    pub fn new(field: Arc<RandomField>, germs: Vec<f64>) -> Self {
        Self { outcome: Some((field, germs)) }
    }

    /// Value at a point.
    pub fn value(&self, point: [f64; 2]) -> f64 {
        self.outcome
            .as_ref()
            .map_or(0.0, |(field, germs)| field.expansion.value(field.support.coordinates(point), germs))
    }
}
