//! Subdomains that are translates of each other.
//!
//! V, K, W, S and the blocks of S₊ do not change when a body is moved: one of such subdomains is assembled for all.

use steklov_elastic::plane::{distance, minus, norm};

use crate::Subdomain;
use crate::curve::Shape;

/// Largest difference of directions, openings and coefficients of curves.
const SAME_SHAPE: f64 = 1e-13;
/// Largest difference of coordinates, in roundings of the largest of them.
const ROUNDINGS: f64 = 16.0;

fn is_same_shape(a: &Shape, b: &Shape) -> bool {
    match (a, b) {
        (Shape::Line, Shape::Line) => true,
        (Shape::Arc(a), Shape::Arc(b)) => (a - b).abs() <= SAME_SHAPE,
        (Shape::Polynomial(a), Shape::Polynomial(b)) => {
            let pairs = || a.middle.iter().zip(&b.middle);
            a.middle.len() == b.middle.len() && pairs().all(|(a, b)| (a - b).norm() <= SAME_SHAPE)
        }
        _ => false,
    }
}

impl Subdomain {
    /// Whether its mesh is that of another one, moved: elements and nodes correspond in their order, and coordinates differ by
    /// what rounds in them.
    pub fn is_translate_of(&self, other: &Self) -> bool {
        let (a, b) = (&self.mesh, &other.mesh);
        if a.next != b.next || a.degree != b.degree {
            return false;
        }
        let largest = a.vertices.iter().chain(&b.vertices).map(|x| norm(*x)).fold(0.0, f64::max);
        let near = ROUNDINGS * f64::EPSILON * largest;
        let shift = minus(b.vertices[0], a.vertices[0]);
        let same = |e: usize| {
            distance(minus(b.vertices[e], a.vertices[e]), shift) <= near
                && distance(a.heading[e], b.heading[e]) <= SAME_SHAPE
                && is_same_shape(&a.shape[e], &b.shape[e])
        };
        (0..a.len()).all(same)
    }

    /// For each subdomain the number of the first one of which it is a translate: its own, if there is none.
    pub fn first_translates(all: &[&Self]) -> Vec<usize> {
        let mut first: Vec<usize> = Vec::with_capacity(all.len());
        for (k, one) in all.iter().enumerate() {
            let found = (0..k).find(|&j| first[j] == j && one.is_translate_of(all[j]));
            first.push(found.unwrap_or(k));
        }
        first
    }
}
