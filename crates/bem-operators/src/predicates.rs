//! A point and a segment: on which side it lies, how far from it.

use robust::{Coord, orient2d};

use steklov_elastic::plane::{cross, distance, dot, minus, norm, unit};

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

/// Largest distance of two points, `distance` of a and b that of two of them. Pairs that are too near to the middle of all are left
/// out.
pub(crate) fn diameter_of(points: &[[f64; 2]], distance: impl Fn([f64; 2], [f64; 2]) -> f64) -> f64 {
    let along = |i: usize| points.iter().map(move |x| x[i]);
    let middle = [0, 1].map(|i| {
        let [low, high] = [along(i).fold(f64::INFINITY, f64::min), along(i).fold(f64::NEG_INFINITY, f64::max)];
        low + (high - low) / 2.0
    });
    let mut far: Vec<(f64, [f64; 2])> = points.iter().map(|&x| (norm(minus(x, middle)), x)).collect();
    far.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut largest = 0.0;
    for (i, (a, x)) in far.iter().enumerate() {
        if (a + far[0].0) * (1.0 + 1e-12) < largest {
            break;
        }
        let reaching = far[..i].iter().take_while(|(b, _)| (a + b) * (1.0 + 1e-12) >= largest);
        largest = reaching.fold(largest, |largest, (_, y)| distance(*x, *y).max(largest));
    }
    largest
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
