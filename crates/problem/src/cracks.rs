//! Cracks, which cut a body into pieces that are tied beyond their tips.
//!
//! ```text
//!   ───────────────┐
//!        left      │      crack   faces `NAME.left` and `NAME.right`: contact, or loads
//!   ┄┄┄┄────────┄┄┄│      ┄┄┄┄    prolonged to the outer boundary, `NAME.beyond.left` and `.right`: tied
//!        right     │
//! ```
//! Left and right are those of somebody who walks along the points of the crack. Tied parts have the same material on both
//! sides, so that the course of the prolongation changes nothing but the meshes: it leaves the tip straight on, and farther
//! out turns just enough to stay away from corners, other cracks and grazing hits. About the tip the pieces are then mirror
//! images, and so are the errors of their meshes in the singular shears there: between unequal pieces these errors would be a
//! pressure on the faces, and grow with the layers of the mesh.

use steklov_bem_operators::{Cut, CutError, Polygon, distance_to_segment};
use steklov_elastic::plane::{cross, distance, minus, norm, unit};

use crate::{Contact, Faces, Interface, Law, Other, Place, Problem, Tie};

/// A crack in a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Crack {
    /// Its name.
    pub side: String,
    /// Its points, from one end to the other.
    pub points: Vec<[f64; 2]>,
}

/// What is wrong with a crack, and what to do; the number of the crack is first.
pub type CrackError = (usize, String, &'static str);

/// Part of the extent of the body below which an end is on the boundary.
const ON_BOUNDARY: f64 = 1e-6;
/// Distances from corners, cracks and holes below this part of the extent count against a prolongation.
const CLEARANCE: f64 = 0.05;
/// Turns of a prolongation that are tried (degrees), and what the largest costs.
const TURNS: [f64; 25] = [
    0.0, 5.0, -5.0, 10.0, -10.0, 15.0, -15.0, 20.0, -20.0, 25.0, -25.0, 30.0, -30.0, 35.0, -35.0, 40.0, -40.0, 45.0,
    -45.0, 50.0, -50.0, 55.0, -55.0, 60.0, -60.0,
];
const COST_OF_TURN: f64 = 0.3;
/// Quality below which no prolongation is taken.
const LEAST: f64 = 1e-3;

/// The pieces of a body along its cracks.
///
/// # Errors
/// A crack of one point, that leaves the body, or meets another one; one that cannot be prolonged.
pub fn cut_by_cracks(outline: &Polygon, cracks: &[Crack]) -> Result<Polygon, CrackError> {
    let cuts = cuts_of(outline, cracks)?;
    outline.cut(&cuts).map_err(|error| {
        let at = match error {
            CutError::EndsInside { at } | CutError::SamePiece { at } | CutError::NextToCorner { at } => at,
        };
        let off = |crack: &Crack| crack.points.iter().map(|x| distance(*x, at)).fold(f64::INFINITY, f64::min);
        let nearest = (0..cracks.len()).min_by(|&a, &b| off(&cracks[a]).total_cmp(&off(&cracks[b])));
        (nearest.unwrap_or(0), error.to_string(), "move the crack a little")
    })
}

impl Problem {
    /// The interfaces of cracks along which [`cut_by_cracks`] has cut bodies: the laws of their faces, none where the faces
    /// are loaded, and the ties beyond their tips.
    pub fn join_cracks(&mut self, cracks: Vec<(Crack, Option<Contact>)>) {
        let side = |problem: &Self, name: String| problem.side(&name);
        let mut joined = Vec::new();
        for (crack, contact) in cracks {
            let beyond = (".beyond", Some(Law::Tied(Tie::default())));
            for (end, law) in [("", contact.map(Law::Contact)), beyond] {
                let [left, right] = ["left", "right"].map(|face| side(self, format!("{}{end}.{face}", crack.side)));
                let (Some(left), Some(right), Some(law)) = (left, right, law) else { continue };
                let name = if end.is_empty() { crack.side.clone() } else { format!("{} beyond", crack.side) };
                joined.push(Interface {
                    name,
                    sides: vec![left],
                    other: Other::Sides(vec![right]),
                    law,
                    place: Place::First,
                    faces: Faces::Cut,
                });
            }
        }
        // the faces before the parts beyond them
        joined.sort_by_key(|interface| matches!(interface.law, Law::Tied(_)));
        self.interfaces.extend(joined);
    }

    /// The left and the right face of the crack beyond whose tips an interface ties a body; none of other interfaces.
    pub fn crack_before(&self, beyond: &Interface) -> Option<[usize; 2]> {
        let crack = beyond.name.strip_suffix(" beyond").filter(|_| beyond.faces == Faces::Cut)?;
        Some([self.side(&format!("{crack}.left"))?, self.side(&format!("{crack}.right"))?])
    }
}

/// The cuts along cracks and their prolongations.
fn cuts_of(outline: &Polygon, cracks: &[Crack]) -> Result<Vec<Cut>, CrackError> {
    let extent = outline.diameter();
    let mut cuts = Vec::new();
    let cracks: Vec<Crack> = cracks.iter().map(|crack| on_boundary(outline, crack, extent)).collect();
    for (k, crack) in cracks.iter().enumerate() {
        check(outline, &cracks, k, extent)?;
        let named = |end: &str| ["left", "right"].map(|face| format!("{}{end}.{face}", crack.side));
        let points = &crack.points;
        for ends in points.windows(2) {
            cuts.push(Cut { ends: [ends[0], ends[1]], sides: named("") });
        }
        let last = points.len() - 1;
        for (tip, before, into) in [(points[0], points[1], true), (points[last], points[last - 1], false)] {
            if on_outer_loop(outline, tip, extent) {
                continue;
            }
            let Some(ahead) = prolongation(outline, &cracks, (tip, before), extent) else {
                let [x, y] = tip;
                let message =
                    format!("the crack cannot be prolonged from its end ({x}, {y}) to the boundary of the body");
                return Err((k, message, "move the end away from corners, holes and other cracks"));
            };
            for [a, b] in ahead.windows(2).map(|pair| [pair[0], pair[1]]) {
                let ends = if into { [b, a] } else { [a, b] };
                cuts.push(Cut { ends, sides: named(".beyond") });
            }
        }
    }
    Ok(cuts)
}

/// A crack whose ends near the boundary are on it.
fn on_boundary(outline: &Polygon, crack: &Crack, extent: f64) -> Crack {
    let mut crack = crack.clone();
    let last = crack.points.len().saturating_sub(1);
    for k in [0, last] {
        let Some(x) = crack.points.get(k).copied() else { continue };
        let near = outline.edges().iter().filter_map(|edge| {
            let (gap, s) = edge.nearest(x, ON_BOUNDARY * extent)?;
            Some((gap, edge.point(s)))
        });
        if let Some((_, on)) = near.min_by(|a, b| a.0.total_cmp(&b.0)) {
            crack.points[k] = on;
        }
    }
    crack
}

fn on_outer_loop(outline: &Polygon, x: [f64; 2], extent: f64) -> bool {
    let outer = &outline.edges()[outline.loops()[0].clone()];
    outer.iter().any(|edge| edge.nearest(x, 1e-9 * extent).is_some())
}

/// Whether a crack lies in the body and meets no other one.
fn check(outline: &Polygon, cracks: &[Crack], k: usize, extent: f64) -> Result<(), CrackError> {
    let points = &cracks[k].points;
    let refuse = |message: String, help: &'static str| Err((k, message, help));
    if points.len() < 2 || points.windows(2).any(|p| distance(p[0], p[1]) <= ON_BOUNDARY * extent) {
        return refuse(
            format!("the crack has {} points, or some that are one", points.len()),
            "list at least two points",
        );
    }
    let last = points.len() - 2;
    for (i, ends) in points.windows(2).enumerate() {
        let [a, b] = [ends[0], ends[1]];
        let length = distance(a, b);
        let n = unit(minus(b, a));
        let mouth = |d: f64| i == 0 && d < 1e-9 * extent || i == last && d > length - 1e-9 * extent;
        let hits = outline.edges().iter().flat_map(|edge| edge.met_by(a, n));
        let crossed = hits.map(|(_, d)| d).find(|&d| d > -1e-9 * extent && d < length + 1e-9 * extent && !mouth(d));
        let middle = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
        if let Some(d) = crossed {
            let [x, y] = [a[0] + d * n[0], a[1] + d * n[1]];
            return refuse(
                format!("the crack meets the boundary at ({x}, {y})"),
                "end it there, or move it into the body",
            );
        }
        let on_boundary = || outline.edges().iter().any(|edge| edge.nearest(middle, ON_BOUNDARY * extent).is_some());
        if !outline.is_in_body(0, middle) || on_boundary() {
            let [x, y] = middle;
            return refuse(
                format!("the point ({x}, {y}) of the crack is not inside of the body"),
                "move it into the body",
            );
        }
        for (j, other) in cracks.iter().enumerate() {
            for (m, pair) in other.points.windows(2).enumerate() {
                if j > k || j == k && m + 1 >= i {
                    break;
                }
                if apart([a, b], [pair[0], pair[1]]) <= ON_BOUNDARY * extent {
                    let [x, y] = common([a, b], [pair[0], pair[1]]);
                    let met = format!("{}{}", other.side, if j == k { ", itself," } else { "" });
                    let help = "leave a distance between them, or shorten one: cracks do not branch";
                    return refuse(format!("the crack meets {met} at ({x}, {y})"), help);
                }
            }
        }
    }
    Ok(())
}

/// Distance of two segments.
fn apart([a, b]: [[f64; 2]; 2], [p, q]: [[f64; 2]; 2]) -> f64 {
    let side = |x: [f64; 2], [u, v]: [[f64; 2]; 2]| cross(minus(v, u), minus(x, u));
    if side(a, [p, q]) * side(b, [p, q]) < 0.0 && side(p, [a, b]) * side(q, [a, b]) < 0.0 {
        return 0.0;
    }
    let ends = [(a, [p, q]), (b, [p, q]), (p, [a, b]), (q, [a, b])];
    ends.into_iter().map(|(x, of)| distance_to_segment(x, of)).fold(f64::INFINITY, f64::min)
}

/// The point that two segments have in common; for segments that only come near each other the nearest end.
fn common(own: [[f64; 2]; 2], other: [[f64; 2]; 2]) -> [f64; 2] {
    let [d, e] = [own, other].map(|[a, b]| minus(b, a));
    let to = minus(other[0], own[0]);
    let (s, t) = (cross(to, e) / cross(d, e), cross(to, d) / cross(d, e));
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        // to six digits of the segment
        let digits = 10f64.powf(6.0 - norm(d).log10().floor());
        return [0, 1].map(|i| ((own[0][i] + s * d[i]) * digits).round() / digits + 0.0);
    }
    let off = |x: &[f64; 2], of| distance_to_segment(*x, of);
    let ends = own.map(|x| (off(&x, other), x)).into_iter().chain(other.map(|x| (off(&x, own), x)));
    ends.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(own[0], |(_, x)| x)
}

/// The way of a crack from its tip to the outer loop: straight on, or with one turn.
fn prolongation(
    outline: &Polygon,
    cracks: &[Crack],
    (tip, before): ([f64; 2], [f64; 2]),
    extent: f64,
) -> Option<Vec<[f64; 2]>> {
    let ahead = unit(minus(tip, before));
    let own = |pair: &[[f64; 2]]| pair[0] == tip || pair[1] == tip;
    let others: Vec<[[f64; 2]; 2]> = cracks
        .iter()
        .flat_map(|crack| crack.points.windows(2))
        .filter(|pair| !own(pair))
        .map(|pair| [pair[0], pair[1]])
        .collect();
    let turning = turning_point(outline, &others, (tip, ahead), extent)?;
    let outer = outline.loops()[0].clone();
    let tried = TURNS.iter().filter_map(|turn| {
        let (sin, cos) = turn.to_radians().sin_cos();
        let n = [cos * ahead[0] - sin * ahead[1], sin * ahead[0] + cos * ahead[1]];
        let from = if *turn == 0.0 { tip } else { turning };
        let mut hits: Vec<(f64, usize, f64)> = Vec::new();
        for (k, edge) in outline.edges().iter().enumerate() {
            hits.extend(edge.met_by(from, n).into_iter().filter(|(_, d)| *d > 1e-9 * extent).map(|(s, d)| (d, k, s)));
        }
        hits.sort_by(|a, b| a.0.total_cmp(&b.0));
        let last = hits.iter().position(|(_, k, _)| outer.contains(k))?;
        hits.truncate(last + 1);
        let &(_, k, s) = hits.last()?;
        let to = outline.edges()[k].point(s);
        let of_hit = |&(_, k, s): &(f64, usize, f64)| {
            let edge = &outline.edges()[k];
            let (x, t) = (edge.point(s), edge.tangent(s));
            let steep = cross(n, t).abs() / 0.5;
            let corner = distance(x, edge.start).min(distance(x, edge.end)) / (CLEARANCE * extent);
            steep.min(corner)
        };
        let clear = others.iter().map(|pair| apart([from, to], *pair) / (CLEARANCE * extent));
        // corners that are passed nearby, as those of holes
        let corners = outline.edges().iter().map(|e| e.start).filter(|x| distance(*x, from) > CLEARANCE * extent);
        let passed = corners.map(|x| distance_to_segment(x, [from, to]) / (CLEARANCE * extent));
        let quality = hits.iter().map(of_hit).chain(clear).chain(passed).fold(1.0, f64::min);
        let way = if from == tip { vec![tip, to] } else { vec![tip, turning, to] };
        Some((quality - COST_OF_TURN * turn.abs() / 60.0, quality, way))
    });
    let (_, quality, way) = tried.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (quality > LEAST).then_some(way)
}

/// Where a prolongation may turn: half way to what lies straight ahead of the tip.
fn turning_point(
    outline: &Polygon,
    others: &[[[f64; 2]; 2]],
    (tip, ahead): ([f64; 2], [f64; 2]),
    extent: f64,
) -> Option<[f64; 2]> {
    let hits = outline.edges().iter().flat_map(|edge| edge.met_by(tip, ahead)).map(|(_, d)| d);
    let wall = hits.filter(|d| *d > 1e-9 * extent).fold(f64::INFINITY, f64::min);
    let free = |way: f64| {
        let to = [tip[0] + way * ahead[0], tip[1] + way * ahead[1]];
        others.iter().all(|pair| apart([tip, to], *pair) > 0.5 * way)
    };
    let mut way = 0.5 * wall;
    while way > ON_BOUNDARY * extent && !free(way) {
        way *= 0.5;
    }
    (way.is_finite() && way > ON_BOUNDARY * extent).then(|| [tip[0] + way * ahead[0], tip[1] + way * ahead[1]])
}
