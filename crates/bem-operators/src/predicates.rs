//! A point and a segment: on which side it lies, how far from it.

use robust::{Coord, orient2d};

use steklov_elastic::plane::{cross, distance, dot, minus, unit};

/// Twice the area of the triangle a, b, c: its sign is exact, positive when c is to the left of a → b.
pub(crate) fn orientation(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let coord = |p: [f64; 2]| Coord { x: p[0], y: p[1] };
    orient2d(coord(a), coord(b), coord(c))
}

/// Distance of a point from a segment.
pub fn distance_to_segment(x: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let (d, r) = (minus(b, a), minus(x, a));
    let s = (dot(r, d) / dot(d, d)).clamp(0.0, 1.0);
    distance(r, d.map(|d| s * d))
}

/// Distance of x from the segment a → b, and the parameter s ∈ [0, 1] of the nearest point.
pub(crate) fn nearest_on_segment(x: [f64; 2], a: [f64; 2], b: [f64; 2]) -> (f64, f64) {
    let (length, t) = (distance(a, b), unit(minus(b, a)));
    let (from_a, from_b) = (minus(x, a), minus(x, b));
    let (along, short) = (dot(from_a, t), -dot(from_b, t));
    if along <= 0.0 {
        (distance(x, a), 0.0)
    } else if short <= 0.0 {
        (distance(x, b), 1.0)
    } else if along <= short {
        (cross(t, from_a).abs(), along / length)
    } else {
        (cross(t, from_b).abs(), 1.0 - short / length)
    }
}
