//! Points of a smooth boundary near which stresses grow like log(1/r), because the data jump or have a kink there.
//!
//! ```text
//! jump of the tangential traction, of a stiffness against tangential displacement or of Tresca's bound     stress ~ log(1/r)
//! kink of a prescribed displacement, convex kink of a gap that is closed there                             stress ~ log(1/r)
//! step of a gap that is closed beside it: the edge of an obstacle                                          stress ~ r^-½
//! ```
//! A jump of the normal traction leaves stresses bounded.
//!
//! Source: Johnson, Contact Mechanics (1985), sections 2.5 (uniform tractions on a part of a half plane) and 5.2 (wedges).

use steklov_bem_operators::{Edge, Mesh};
use steklov_elastic::plane::{distance, dot};
use steklov_expression::{Expression, OnEdge, Track};
use steklov_problem::{Condition, Friction, Scene};

use crate::answer::wedges::is_straight;
use crate::solve::contact_rows::{ContactRow, TOUCHING, max_pressure};

/// Distance from a point, as part of the edge, at which data are examined.
const NEAR: f64 = 1e-6;
/// Slopes that differ by less than this part of the largest are no kink, and jumps below this part of the largest value no jump.
const SMOOTH: f64 = 1e-4;
/// Parts of an edge between which its data are sampled for their size.
const PARTS: u32 = 64;

/// A point of infinite stress.
pub(crate) struct Jump {
    pub point: [f64; 2],
    /// Whether the pressure of contact is infinite there.
    pub is_pressed: bool,
}

/// The part of an edge that leaves a point with rising or falling parameter.
#[derive(Clone, Copy)]
struct Way<'a> {
    edge: &'a Edge,
    s: f64,
    rising: bool,
}

/// These points, on boundaries that are smooth there.
pub(crate) fn data_jumps(scene: &Scene, mesh: &Mesh, rows: &[ContactRow]) -> Vec<Jump> {
    let outline = &scene.problem.outline;
    let edges = outline.edges();
    let inside = edges.iter().flat_map(|edge| {
        let at = move |s: f64| [false, true].map(|rising| Way { edge, s, rising });
        kinks(scene, edge).into_iter().map(at)
    });
    let at_end = |edge, rising| Way { edge, s: if rising { 0.0 } else { 1.0 }, rising };
    let at_vertices = (0..edges.len()).filter_map(|k| {
        let (behind, rising) = outline.neighbour(k, !edges[k].reversed);
        let (a, b) = (&edges[k], &edges[behind]);
        is_straight(a, b).then(|| [at_end(a, a.reversed), at_end(b, rising)])
    });
    let largest = max_pressure(rows);
    let longest = |edge: &Edge| {
        let on_edge = (0..mesh.len()).filter(|&e| std::ptr::eq(&edges[mesh.edge[e]], edge));
        on_edge.map(|e| mesh.length(e)).fold(0.0, f64::max)
    };
    let jump = |ways: [Way<'_>; 2]| {
        let point = ways[1].edge.point(ways[1].s);
        let is_touched = || {
            let reach = 0.51 * longest(ways[0].edge).max(longest(ways[1].edge));
            rows.iter().any(|r| r.pressure > TOUCHING * largest && distance(r.point, point) <= reach)
        };
        let is_pressed = is_ridge(scene, ways) && is_touched();
        (is_pressed || shear_jumps(scene, ways) || displacement_bends(scene, ways))
            .then_some(Jump { point, is_pressed })
    };
    inside.chain(at_vertices).filter_map(jump).collect()
}

/// The kinks of the data along an edge, its ends apart.
pub(crate) fn kinks(scene: &Scene, edge: &Edge) -> Vec<f64> {
    let data = scene.problem.side_data(edge.side).into_iter().map(|(_, datum)| datum).chain(scene.jumps_on(edge));
    let mut kinks: Vec<f64> = data.flat_map(|datum| datum.along(edge).kinks.clone()).collect();
    kinks.retain(|s| (3.0 * NEAR..=1.0 - 3.0 * NEAR).contains(s));
    kinks.sort_by(f64::total_cmp);
    kinks.dedup();
    kinks
}

impl Way<'_> {
    /// The limit of a function of the edge parameter at the point.
    fn limit(&self, f: impl Fn(f64) -> f64) -> f64 {
        let [near, far] = self.beside();
        2.0 * f(near) - f(far)
    }

    /// The slope along the way, by the length.
    fn slope(&self, f: impl Fn(f64) -> f64) -> f64 {
        let [near, far] = self.beside();
        (f(far) - f(near)) / (NEAR * self.edge.length())
    }

    fn beside(&self) -> [f64; 2] {
        let step = if self.rising { NEAR } else { -NEAR };
        [self.s + step, self.s + 2.0 * step]
    }

    /// A datum of the edge by its parameter.
    fn datum<'b>(&'b self, datum: &'b Expression) -> impl Fn(f64) -> f64 + Copy + 'b {
        |s| {
            let (x, y, s) = OnEdge::new(self.edge, datum).at(s);
            datum.eval(x, y, s)
        }
    }
}

/// The smallest and the largest value on the whole edges.
fn range(values: [&dyn Fn(f64) -> f64; 2]) -> [f64; 2] {
    let samples = (0..=PARTS).flat_map(|i| values.map(|f| f(f64::from(i) / f64::from(PARTS))));
    samples.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

/// By how much a datum jumps, and its slopes away from the point, over the size of the datum; none where it is constant.
fn jump_and_slopes(ways: [Way<'_>; 2], data: [&Expression; 2]) -> Option<(f64, [f64; 2])> {
    let [f, g] = [ways[0].datum(data[0]), ways[1].datum(data[1])];
    let [low, high] = range([&f, &g]);
    let slopes = [ways[0].slope(f), ways[1].slope(g)];
    let length = ways[0].edge.length().min(ways[1].edge.length());
    let steepest = slopes[0].abs().max(slopes[1].abs()).max((high - low) / length);
    let rounding = f64::EPSILON * low.abs().max(high.abs());
    if high - low <= 8.0 * rounding {
        return None;
    }
    // digits that are lost in differences
    let steepest = steepest.max(rounding / (SMOOTH * NEAR * length));
    Some(((ways[1].limit(g) - ways[0].limit(f)).abs() / (high - low), slopes.map(|slope| slope / steepest)))
}

/// Whether the gap has a step or bends towards the body.
fn is_ridge(scene: &Scene, ways: [Way<'_>; 2]) -> bool {
    let [Some(a), Some(b)] = ways.map(|way| scene.contact(way.edge.side)) else { return false };
    let of_data = jump_and_slopes(ways, [&a.gap, &b.gap]);
    of_data.is_some_and(|(jump, slopes)| jump > SMOOTH || slopes[0] + slopes[1] > SMOOTH)
}

/// Whether a component of the displacement that is prescribed on both sides has a kink or jumps.
fn displacement_bends(scene: &Scene, ways: [Way<'_>; 2]) -> bool {
    let values = |way: Way<'_>| match &scene.problem.sides[way.edge.side].condition {
        Condition::Displacement { values, .. } => values.each_ref().map(Option::as_ref),
        _ => [None; 2],
    };
    let [a, b] = ways.map(values);
    (0..2).filter_map(|i| a[i].zip(b[i])).any(|(a, b)| {
        let of_data = jump_and_slopes(ways, [a, b]);
        of_data.is_some_and(|(jump, slopes)| jump > SMOOTH || (slopes[0] + slopes[1]).abs() > SMOOTH)
    })
}

/// Whether the tangential traction jumps, or a stiffness that gives one.
fn shear_jumps(scene: &Scene, ways: [Way<'_>; 2]) -> bool {
    let [Some(_), Some(_)] = ways.map(|way| shear(scene, way.edge, way.s)) else { return false };
    (0..3).any(|i| {
        let [f, g] = ways.map(|way| move |s: f64| shear(scene, way.edge, s).map_or(0.0, |shear| shear[i]));
        let size = range([&f, &g]).into_iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        (ways[1].limit(g) - ways[0].limit(f)).abs() > SMOOTH * size
    })
}

/// The tangential traction that is given on an edge, and the stiffnesses against tangential and normal displacement that add to
/// it; none where the traction is unknown.
fn shear(scene: &Scene, edge: &Edge, s: f64) -> Option<[f64; 3]> {
    let meets = |i: &steklov_problem::Interface| scene.problem.facing_sides(i).contains(&edge.side);
    if scene.problem.joint(edge.side).is_some() || scene.problem.joints().any(meets) {
        return None;
    }
    let at = |datum: &Expression| {
        let (x, y, s) = OnEdge::new(edge, datum).at(s);
        datum.eval(x, y, s)
    };
    if let Some(contact) = scene.contact(edge.side) {
        // of Tresca's bound the sign is not known, and pressure with a coefficient is judged by exponents
        return Some([if let Friction::Tresca(bound) = &contact.friction { at(bound) } else { 0.0 }, 0.0, 0.0]);
    }
    let side = &scene.problem.sides[edge.side];
    let (normal, tangent) = (edge.normal(s), edge.tangent(s));
    let along = |t: &[Expression; 2]| dot([at(&t[0]), at(&t[1])], tangent);
    let given = match &side.condition {
        Condition::Traction(t) => along(t),
        Condition::Free | Condition::Pressure(_) => 0.0,
        Condition::Displacement { values: [Some(_), Some(_)], .. } => return None,
        Condition::Displacement { traction, .. } => traction.as_ref().map_or(0.0, along),
    };
    let mut stiffness = [0.0; 2];
    if let Some(springs) = &side.springs {
        for (k, direction) in springs.stiffnesses().into_iter().zip(springs.directions(normal)) {
            let pull = at(k) * dot(direction, tangent);
            stiffness = [stiffness[0] + pull * dot(direction, tangent), stiffness[1] + pull * dot(direction, normal)];
        }
    }
    Some([given, stiffness[0], stiffness[1]])
}
