//! Where two curved edges meet, or one meets itself: pieces are chords with a width, halved until they are apart.

use steklov_elastic::plane::distance;

use crate::edge::{Edge, Path, angle};
use crate::predicates::{nearest_on_segment, orientation};

/// Number of pairs of pieces examined before two edges count as too close to distinguish.
const MOST_PAIRS: usize = 400_000;
/// Smallest distance of an interior angle between curves from 0 and from 360°: 0.1°.
pub(crate) const LEAST_ANGLE: f64 = 0.1 * std::f64::consts::PI / 180.0;

/// A piece of an edge between two parameters.
#[derive(Clone, Copy)]
struct Piece<'a> {
    edge: &'a Edge,
    ends: [f64; 2],
    points: [[f64; 2]; 2],
    deviation: f64,
}

impl<'a> Piece<'a> {
    fn whole(edge: &'a Edge) -> Self {
        Self { edge, ends: [0.0, 1.0], points: edge.listed(), deviation: edge.deviation(0.0, 1.0) }
    }

    fn halves(&self) -> [Self; 2] {
        let [low, high] = self.ends;
        let middle = (low + high) / 2.0;
        let m = self.edge.point(middle);
        let half =
            |ends: [f64; 2], points| Self { ends, points, deviation: self.edge.deviation(ends[0], ends[1]), ..*self };
        [half([low, middle], [self.points[0], m]), half([middle, high], [m, self.points[1]])]
    }

    /// Upper bound of the angle between two tangents of the piece; infinite if a point has no tangent.
    fn turning(&self) -> f64 {
        let [low, high] = self.ends;
        // 8 deviation/Δs² bounds |γ''|
        let change = 8.0 * self.deviation / (high - low);
        let [x, y] = self.edge.derivative((low + high) / 2.0);
        let least = x.hypot(y) - change / 2.0;
        if self.deviation == 0.0 {
            0.0
        } else if least > 0.0 {
            change / least
        } else {
            f64::INFINITY
        }
    }
}

/// A point where two different edges come within `tolerance`, except at the corners they share: `shared` has their
/// parameters on both.
pub(crate) fn meeting(first: &Edge, second: &Edge, shared: &[[f64; 2]], tolerance: f64) -> Option<[f64; 2]> {
    meeting_of(Piece::whole(first), Piece::whole(second), shared, tolerance)
}

fn meeting_of(first: Piece<'_>, second: Piece<'_>, shared: &[[f64; 2]], tolerance: f64) -> Option<[f64; 2]> {
    let mut stack = vec![(first, second)];
    for _ in 0..MOST_PAIRS {
        let (a, b) = stack.pop()?;
        let gap = gap(a.points, b.points);
        let width = a.deviation + b.deviation;
        if gap > width + tolerance {
            continue;
        }
        let corner = shared.iter().find(|[s, t]| a.ends.contains(s) && b.ends.contains(t));
        if let Some(&[s, t]) = corner {
            let away = |edge: &Edge, s: f64| {
                let [x, y] = edge.derivative(s);
                if s == 0.0 { [x, y] } else { [-x, -y] }
            };
            let between = angle(away(a.edge, s), away(b.edge, t)).abs();
            if between > a.turning() + b.turning() {
                continue;
            }
            let small = |p: &Piece<'_>| distance(p.points[0], p.points[1]) <= tolerance;
            if small(&a) && small(&b) {
                return Some(a.edge.point(s));
            }
        } else if width <= 0.25 * tolerance {
            return Some(shorter(&a, &b).points[0]);
        }
        // the wider one is halved, or the longer one where both are straight
        let size = |p: &Piece<'_>| (p.deviation, distance(p.points[0], p.points[1]));
        if corner.is_some() {
            for a in a.halves() {
                stack.extend(b.halves().map(|b| (a, b)));
            }
        } else if size(&a) >= size(&b) {
            stack.extend(a.halves().map(|a| (a, b)));
        } else {
            stack.extend(b.halves().map(|b| (a, b)));
        }
    }
    stack.pop().map(|(a, b)| shorter(&a, &b).points[0])
}

/// The shorter of two pieces, which locates their meeting point better.
fn shorter<'p, 'e>(a: &'p Piece<'e>, b: &'p Piece<'e>) -> &'p Piece<'e> {
    let length = |p: &Piece<'_>| distance(p.points[0], p.points[1]);
    if length(a) <= length(b) { a } else { b }
}

/// Distance of two segments, 0 if they cross.
fn gap([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> f64 {
    let crosses = (orientation(a, b, c) > 0.0) != (orientation(a, b, d) > 0.0)
        && (orientation(c, d, a) > 0.0) != (orientation(c, d, b) > 0.0);
    if crosses {
        return 0.0;
    }
    let to =
        |x: [f64; 2], a: [f64; 2], b: [f64; 2]| if a == b { distance(x, a) } else { nearest_on_segment(x, a, b).0 };
    to(a, c, d).min(to(b, c, d)).min(to(c, a, b)).min(to(d, a, b))
}

/// A point where an edge crosses or touches itself. A curve that turns by less than 180° does not.
pub(crate) fn own_meeting(edge: &Edge, tolerance: f64) -> Option<[f64; 2]> {
    let Path::Cubic { .. } = edge.path else { return None };
    let mut pieces = Vec::new();
    let mut stack = vec![Piece::whole(edge)];
    while let Some(piece) = stack.pop() {
        if piece.turning() < std::f64::consts::FRAC_PI_2 {
            pieces.push(piece);
        } else if piece.ends[1] - piece.ends[0] < 1e-6 {
            return Some(piece.points[0]);
        } else {
            let [a, b] = piece.halves();
            stack.extend([b, a]);
        }
    }
    for (i, a) in pieces.iter().enumerate() {
        for b in pieces.iter().skip(i + 2) {
            if let Some(at) = meeting_of(*a, *b, &[], tolerance) {
                return Some(at);
            }
        }
    }
    None
}
