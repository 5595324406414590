//! What a valid polygon is, and the errors that say where one is not.

use std::fmt;

use steklov_elastic::plane::{cross, distance, minus, unit};

use crate::edge::{Edge, LARGEST_OPENING, Path, angle};
use crate::edge_check::{LEAST_ANGLE, meeting, own_meeting};
use crate::polygon::{Loop, area_of, listed_edges};
use crate::predicates::{diameter_of, nearest_on_segment, orientation};

/// An edge as the user lists it; corners count from 0.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeName {
    /// 0 for the outer loop, k for the k-th hole.
    pub loop_index: usize,
    /// The edge runs from this corner of the loop to the next.
    pub corner: usize,
    /// Name of its side.
    pub side: String,
}

impl fmt::Display for EdgeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "edge {} (\"{}\") of {}", self.corner, self.side, name(&self.loop_index))
    }
}

fn name(loop_index: &usize) -> String {
    match loop_index {
        0 => "the outer loop".into(),
        k => format!("hole {k}"),
    }
}

/// What is wrong with a list of corners. Corners and edges count from 0, holes from 1, also those of an unbounded body; loop 0
/// is the outer one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolygonError {
    /// An unbounded body without a hole has no boundary.
    #[error("the plane has no hole: list the corners of at least one")]
    NoHole,
    /// A loop of fewer than three corners.
    #[error("{} has {corners} corners; it needs at least 3, or 2 with a curved edge", name(.loop_index))]
    TooFewCorners {
        /// The loop.
        loop_index: usize,
        /// Its number of corners.
        corners: usize,
    },
    /// As many names of sides as corners are needed.
    #[error("{} has {corners} corners but {sides} sides; name one side for each edge", name(.loop_index))]
    SideCount {
        /// The loop.
        loop_index: usize,
        /// Its number of corners.
        corners: usize,
        /// Its number of names.
        sides: usize,
    },
    /// A side without a name.
    #[error("side {edge} of {} has an empty name", name(.loop_index))]
    EmptySide {
        /// The loop.
        loop_index: usize,
        /// Index of the edge in the loop.
        edge: usize,
    },
    /// A coordinate is NaN, infinite or beyond ±1e100.
    #[error("corner {corner} of {} is ({}, {}); coordinates must be finite and within ±1e100", name(.loop_index), .at[0], .at[1])]
    NotFinite {
        /// The loop.
        loop_index: usize,
        /// Index of the corner in the loop.
        corner: usize,
        /// Its coordinates.
        at: [f64; 2],
    },
    /// The body is so far from the origin that its coordinates have lost its shape in rounding.
    #[error(
        "the body lies {distance:e} from the origin but is only {diameter:e} wide: its shape drowns in the rounding of its \
         coordinates; move the origin of the coordinates to the body"
    )]
    FarFromOrigin {
        /// Largest coordinate.
        distance: f64,
        /// Diameter of the corners.
        diameter: f64,
    },
    /// Two successive corners are the same point.
    #[error("{edge} at ({}, {}) has length {length:e}, below the resolution {tolerance:e}; remove one of its two corners", .at[0], .at[1])]
    ZeroEdge {
        /// The edge.
        edge: EdgeName,
        /// Its first corner.
        at: [f64; 2],
        /// Its length.
        length: f64,
        /// The least length, relative to the diameter.
        tolerance: f64,
    },
    /// All corners of a loop lie on a line.
    #[error("the corners of {} lie on one line (width {width:e} of a length of {length:e}): it has no area", name(.loop_index))]
    ZeroArea {
        /// The loop.
        loop_index: usize,
        /// Largest distance of a corner from the line.
        width: f64,
        /// Extent of the loop along the line.
        length: f64,
    },
    /// The outer loop must be counter-clockwise.
    #[error("the corners of the outer loop are listed clockwise (signed area {area}); list them counter-clockwise")]
    Clockwise {
        /// Signed area of the outer loop.
        area: f64,
    },
    /// Two successive edges fold back on each other: an interior angle of 0 or 360 degrees.
    #[error("the edges at corner {corner} of {}, ({}, {}), fold back on each other; give the spike a width or remove it", name(.loop_index), .at[0], .at[1])]
    Spike {
        /// The loop.
        loop_index: usize,
        /// Index of the corner at the tip.
        corner: usize,
        /// Its coordinates.
        at: [f64; 2],
    },
    /// A corner lies on an edge or corner that is not its own.
    #[error("corner {corner} of {}, ({}, {}), touches {edge}; keep them apart", name(.loop_index), .at[0], .at[1])]
    Touching {
        /// The loop of the corner.
        loop_index: usize,
        /// Index of the corner in its loop.
        corner: usize,
        /// Its coordinates.
        at: [f64; 2],
        /// The edge that it touches.
        edge: EdgeName,
    },
    /// Two edges cross.
    #[error("{first} and {second} cross at ({}, {})", .at[0], .at[1])]
    Crossing {
        /// The edge with the lower number.
        first: EdgeName,
        /// The other one.
        second: EdgeName,
        /// The point of intersection.
        at: [f64; 2],
    },
    /// An edge whose numbers make no curve.
    #[error("{edge}: {what}")]
    NoCurve {
        /// The edge.
        edge: EdgeName,
        /// What is wrong with it, with the numbers, and what to change.
        what: String,
    },
    /// A curved edge crosses or touches itself.
    #[error("{edge} crosses or touches itself at ({}, {}); move its control points apart or cut it in two", .at[0], .at[1])]
    OwnCrossing {
        /// The edge.
        edge: EdgeName,
        /// Where.
        at: [f64; 2],
    },
    /// A hole that is not in the outer loop.
    #[error("hole {loop_index}, with a corner at ({}, {}), lies outside of the outer loop", .at[0], .at[1])]
    HoleOutside {
        /// Number of the hole, from 1.
        loop_index: usize,
        /// Its first corner.
        at: [f64; 2],
    },
    /// A hole in another hole.
    #[error("hole {loop_index}, with a corner at ({}, {}), lies in hole {within}", .at[0], .at[1])]
    HoleInHole {
        /// Number of the hole, from 1.
        loop_index: usize,
        /// Number of the hole around it, from 1.
        within: usize,
        /// Its first corner.
        at: [f64; 2],
    },
}

/// Diameter of all corners, and the distance below which points count as equal.
pub(crate) fn tolerance(loops: &[Loop]) -> (f64, f64) {
    let points = |l: &Loop| match l.paths.is_empty() {
        true => l.corners.clone(),
        false => listed_edges(l).iter().flat_map(Edge::extent).collect(),
    };
    let corners: Vec<[f64; 2]> = loops.iter().flat_map(points).collect();
    let diameter = diameter_of(&corners, |a, b| ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt());
    let far = corners.iter().flatten().fold(0.0, |m: f64, c| m.max(c.abs()));
    (diameter, (1e-12 * diameter).max(4.0 * f64::EPSILON * far))
}

/// Diameters from the origin at which a body still has six digits of its shape, and beyond which it is refused.
const FARTHEST: f64 = 1e10;

/// Loops with the number of the first one in errors: 0 for an outer loop, 1 if all are holes.
struct Listed<'a> {
    loops: &'a [Loop],
    first: usize,
}

impl Listed<'_> {
    /// The loops with their numbers in errors.
    fn numbered(&self) -> impl Iterator<Item = (usize, &Loop)> {
        (self.first..).zip(self.loops)
    }

    fn holes(&self) -> impl Iterator<Item = (usize, &Loop)> {
        self.numbered().filter(|l| l.0 > 0)
    }
}

/// Accepts exactly the loops that bound a polygon with holes, the outer one counter-clockwise and first.
pub(crate) fn check(loops: &[Loop]) -> Result<(), PolygonError> {
    check_loops(&Listed { loops, first: 0 })?;
    let area = area_of(&loops[0]);
    if area < 0.0 {
        return Err(PolygonError::Clockwise { area });
    }
    for (loop_index, hole) in loops.iter().enumerate().skip(1) {
        let at = hole.corners[0];
        if !surrounds(&loops[0], at) {
            return Err(PolygonError::HoleOutside { loop_index, at });
        }
    }
    check_nesting(&Listed { loops, first: 0 })
}

/// Accepts exactly the loops that are holes in the plane, at least one.
pub(crate) fn check_holes(holes: &[Loop]) -> Result<(), PolygonError> {
    if holes.is_empty() {
        return Err(PolygonError::NoHole);
    }
    let listed = Listed { loops: holes, first: 1 };
    check_loops(&listed)?;
    check_nesting(&listed)
}

/// Every loop is simple, and no two of them meet.
fn check_loops(listed: &Listed<'_>) -> Result<(), PolygonError> {
    let loops = listed.loops;
    for (loop_index, l) in listed.numbered() {
        check_list(loop_index, l)?;
    }
    let (diameter, tolerance) = tolerance(loops);
    let coordinates = loops.iter().flat_map(|l| l.corners.iter().flatten());
    let distance_to_origin = coordinates.fold(0.0, |m: f64, c| m.max(c.abs()));
    if distance_to_origin > FARTHEST * diameter && diameter > 0.0 {
        return Err(PolygonError::FarFromOrigin { distance: distance_to_origin, diameter });
    }
    let segments = segments(listed);
    for s in &segments {
        let length = distance(s.a, s.b);
        check_curve(s, tolerance, listed)?;
        if length <= tolerance {
            return Err(PolygonError::ZeroEdge { edge: s.name(listed), at: s.a, length, tolerance });
        }
    }
    for (loop_index, l) in listed.numbered().filter(|(_, l)| l.paths.iter().all(|p| *p == Path::Line)) {
        check_width(loop_index, &l.corners)?;
    }
    for (i, s) in segments.iter().enumerate() {
        check_corner(i, s, &segments[s.follower], tolerance, listed)?;
    }
    for (i, s) in segments.iter().enumerate() {
        for (j, t) in segments.iter().enumerate().skip(i + 1) {
            if s.follower != j && t.follower != i {
                check_pair(s, t, tolerance, listed)?;
            }
        }
    }
    Ok(())
}

fn check_list(loop_index: usize, Loop { corners, sides, paths }: &Loop) -> Result<(), PolygonError> {
    let curved = paths.iter().any(|p| *p != Path::Line);
    if corners.len() < if curved { 2 } else { 3 } {
        return Err(PolygonError::TooFewCorners { loop_index, corners: corners.len() });
    }
    if sides.len() != corners.len() {
        return Err(PolygonError::SideCount { loop_index, corners: corners.len(), sides: sides.len() });
    }
    if let Some(edge) = sides.iter().position(|s| s.trim().is_empty()) {
        return Err(PolygonError::EmptySide { loop_index, edge });
    }
    // Squares and fourth powers of lengths must not overflow; NaN fails the comparison too.
    let bad = |p: &[f64; 2]| !p.iter().all(|c| c.abs() <= 1e100);
    match corners.iter().position(bad) {
        Some(corner) => Err(PolygonError::NotFinite { loop_index, corner, at: corners[corner] }),
        None => Ok(()),
    }
}

fn check_width(loop_index: usize, corners: &[[f64; 2]]) -> Result<(), PolygonError> {
    let a = corners[0];
    let b = corners.iter().fold(a, |far, &c| if distance(a, c) > distance(a, far) { c } else { far });
    let length = distance(a, b);
    let t = unit(minus(b, a));
    let width = corners.iter().map(|c| cross(t, minus(*c, a)).abs()).fold(0.0, f64::max);
    if width <= 1e-12 * length {
        return Err(PolygonError::ZeroArea { loop_index, width, length });
    }
    Ok(())
}

/// An edge from corner a to corner b of a loop, `corner` and `next` their indices.
struct ListedEdge {
    edge: Edge,
    a: [f64; 2],
    b: [f64; 2],
    loop_index: usize,
    corner: usize,
    next: usize,
    /// Number of the edge that begins at b.
    follower: usize,
}

impl ListedEdge {
    fn meets(&self, x: [f64; 2], tolerance: f64) -> bool {
        nearest_on_segment(x, self.a, self.b).0 <= tolerance
    }

    fn name(&self, listed: &Listed<'_>) -> EdgeName {
        let ListedEdge { loop_index, corner, .. } = *self;
        EdgeName { loop_index, corner, side: listed.loops[loop_index - listed.first].sides[corner].clone() }
    }
}

fn segments(listed: &Listed<'_>) -> Vec<ListedEdge> {
    let mut segments = Vec::new();
    for (loop_index, l) in listed.numbered() {
        let (first, corners) = (segments.len(), &l.corners);
        for (corner, edge) in listed_edges(l).into_iter().enumerate() {
            let next = (corner + 1) % corners.len();
            let (a, b) = (corners[corner], corners[next]);
            segments.push(ListedEdge { edge, a, b, loop_index, corner, next, follower: first + next });
        }
    }
    segments
}

/// The numbers of a curved edge make a curve, with a tangent everywhere, that does not meet itself.
fn check_curve(s: &ListedEdge, tolerance: f64, listed: &Listed<'_>) -> Result<(), PolygonError> {
    let fault = |what: String| Err(PolygonError::NoCurve { edge: s.name(listed), what });
    match s.edge.path {
        Path::Line => return Ok(()),
        Path::Arc { opening } if opening.is_nan() || opening.abs() > LARGEST_OPENING => {
            return fault(format!(
                "the arc opens by {}°; cut it in two where it opens by more than {}°",
                opening.to_degrees(),
                LARGEST_OPENING.to_degrees()
            ));
        }
        Path::Arc { opening: 0.0 } => return fault("an arc of 0° is a line: leave the arc out".into()),
        Path::Ellipse { radii: [a, b], opening, angle, start } => {
            if !(a > tolerance && b > tolerance && a.max(b) <= 1e100) {
                return fault(format!("the half axes {a} and {b} must be positive and finite"));
            }
            if !(opening.abs() <= LARGEST_OPENING && opening != 0.0 && angle.is_finite() && start.is_finite()) {
                return fault(format!("the elliptic arc opens by {}°", opening.to_degrees()));
            }
            let missed = distance(s.edge.point(0.5 - 1e-16), s.edge.point(0.5 + 1e-15));
            if missed > 1e-9 * a.max(b) {
                return fault(format!("its corners lie off the ellipse by {missed:e}"));
            }
        }
        Path::Cubic { control } if !control.iter().flatten().all(|c| c.abs() <= 1e100) => {
            return fault(format!("the control points are {control:?}; they must be finite and within ±1e100"));
        }
        _ => {}
    }
    if s.edge.length() <= tolerance || distance(s.a, s.b) <= tolerance {
        return Ok(());
    }
    let least =
        (0..=256).map(|k| s.edge.derivative(k as f64 / 256.0)).map(|[x, y]| x.hypot(y)).fold(f64::INFINITY, f64::min);
    if least <= 1e-6 * s.edge.length() || s.edge.needed_cuts([0.0, 1.0], SHORTEST_PIECE).len() >= MOST_PIECES {
        return fault(
            "it comes to a cusp or turns too sharply to be divided into elements; cut it in two at a corner there"
                .into(),
        );
    }
    match own_meeting(&s.edge, tolerance) {
        Some(at) => Err(PolygonError::OwnCrossing { edge: s.name(listed), at }),
        None => Ok(()),
    }
}

/// Largest number of elements that the turns of an edge may need, and the shortest of them as a part of the edge.
const MOST_PIECES: usize = 1 << 8;
const SHORTEST_PIECE: f64 = 1e-7;

/// Two successive edges share their corner and no other point.
fn check_corner(
    number: usize,
    s: &ListedEdge,
    t: &ListedEdge,
    tolerance: f64,
    listed: &Listed<'_>,
) -> Result<(), PolygonError> {
    let spike = PolygonError::Spike { loop_index: t.loop_index, corner: t.corner, at: t.a };
    if s.edge.is_line() && t.edge.is_line() {
        return if s.meets(t.b, tolerance) || t.meets(s.a, tolerance) { Err(spike) } else { Ok(()) };
    }
    let turn = angle(s.edge.derivative(1.0), t.edge.derivative(0.0)).abs();
    if std::f64::consts::PI - turn < LEAST_ANGLE {
        return Err(spike);
    }
    let mut shared = vec![[1.0, 0.0]];
    if t.follower == number {
        shared.push([0.0, 1.0]);
    }
    match meeting(&s.edge, &t.edge, &shared, tolerance) {
        Some(at) => Err(PolygonError::Crossing { first: s.name(listed), second: t.name(listed), at }),
        None => Ok(()),
    }
}

/// Two edges that do not follow each other share no point.
fn check_pair(s: &ListedEdge, t: &ListedEdge, tolerance: f64, listed: &Listed<'_>) -> Result<(), PolygonError> {
    if !(s.edge.is_line() && t.edge.is_line()) {
        return match meeting(&s.edge, &t.edge, &[], tolerance) {
            Some(at) => Err(PolygonError::Crossing { first: s.name(listed), second: t.name(listed), at }),
            None => Ok(()),
        };
    }
    let apart = |c: usize| {
        s.a[c].max(s.b[c]) + tolerance < t.a[c].min(t.b[c]) || t.a[c].max(t.b[c]) + tolerance < s.a[c].min(s.b[c])
    };
    if apart(0) || apart(1) {
        return Ok(());
    }
    for (own, other) in [(t, s), (s, t)] {
        for (corner, at) in [(own.corner, own.a), (own.next, own.b)] {
            if other.meets(at, tolerance) {
                return Err(PolygonError::Touching {
                    loop_index: own.loop_index,
                    corner,
                    at,
                    edge: other.name(listed),
                });
            }
        }
    }
    let (sa, sb) = (orientation(t.a, t.b, s.a), orientation(t.a, t.b, s.b));
    let (ta, tb) = (orientation(s.a, s.b, t.a), orientation(s.a, s.b, t.b));
    if (sa > 0.0) != (sb > 0.0) && (ta > 0.0) != (tb > 0.0) {
        let r = sa / (sa - sb);
        let at = [s.a[0] + r * (s.b[0] - s.a[0]), s.a[1] + r * (s.b[1] - s.a[1])];
        return Err(PolygonError::Crossing { first: s.name(listed), second: t.name(listed), at });
    }
    Ok(())
}

/// Loops that do not meet are nested or apart, and one corner tells which.
fn check_nesting(listed: &Listed<'_>) -> Result<(), PolygonError> {
    for (loop_index, hole) in listed.holes() {
        let at = hole.corners[0];
        for (within, other) in listed.holes() {
            if within != loop_index && surrounds(other, at) {
                return Err(PolygonError::HoleInHole { loop_index, within, at });
            }
        }
    }
    Ok(())
}

/// Whether a simple loop, in either order, has x in its inside; x is not on it.
fn surrounds(listed: &Loop, x: [f64; 2]) -> bool {
    let edges = listed_edges(listed);
    if !edges.iter().all(Edge::is_line) {
        return edges.iter().map(|edge| edge.crossings(x)).sum::<i32>() != 0;
    }
    let corners = &listed.corners;
    let mut inside = false;
    for (k, &a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        let (low, high) = if a[1] <= b[1] { (a, b) } else { (b, a) };
        if low[1] <= x[1] && x[1] < high[1] && orientation(low, high, x) > 0.0 {
            inside = !inside;
        }
    }
    inside
}
