//! Numbers that users quote, each with its error bar.
//!
//! With J_k the value of step k and J₊ that of the enriched spaces at the same contact sets,
//! ```text
//! d_k = max(|J₊ - J_k|, d_{k-1} min(1, (E_k / E_{k-1})²)),      uncertainty = 1.2 d_k + 0.3 |J_k - J_{k-1}|
//! ```
//! E the estimate in the energy norm: |J₊ - J_k| crosses zero by accident, hardly twice in a row and hardly in all components: that of a
//! component is a quarter of the largest one of its vector or tensor or more. Of a single mesh, and of an exact solution, which has no step
//! before it, the uncertainty is 5 |J₊ - J|. At corners and between sides J₊ removes less of the error: there stresses, and displacements where
//! the stress is infinite, have three times the uncertainty, and the doubt `coarse`.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::{Deserialize, Serialize};
use steklov_bem_operators::{Edge, Location, SAME_PLACE};
use steklov_problem::{Condition, Friction, Multiplier, Scene};

use crate::answer::wedges::is_straight;
use crate::doubt::Doubt;
use crate::estimate::error_estimate::Estimate;
use crate::solve::fields::ElasticField;
use crate::summary::Probe;

/// How far the exact value may be, over the part that the enriched spaces see.
const OF_DIFFERENCE: f64 = 1.2;
/// The same over the change since the step before.
const OF_CHANGE: f64 = 0.3;
/// How far the exact value may be, over the part that the enriched spaces see, without a step before.
const OF_SINGLE: f64 = 5.0;
/// Least part of the other components' differences that a component has: one of them crosses zero by accident.
const OF_OTHERS: f64 = 0.25;
/// Relative errors of the energy norm that are rounding.
const EXACT: f64 = 1e-10;
/// Rounding errors of a value, over the largest of its kind.
const ROUNDED: f64 = 1e-11;
/// Uncertainties below this many rounding errors are of no concern at corners.
const SMALL: f64 = 100.0;
/// How much larger the uncertainty is at corners.
const OF_CORNER: f64 = 3.0;

/// A number with its error bar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Its value.
    pub value: f64,
    /// How far the exact value may be from that, to both sides, in the same unit.
    pub uncertainty: f64,
    /// Why the uncertainty is not to be trusted, words of [`crate::doubt::Doubt`]; empty if it is.
    pub doubts: Vec<String>,
}

/// The quantities of a result by their paths in the JSON object.
pub type Quantities = BTreeMap<String, Quantity>;

/// The components at a point, in the order of [`values`].
const OF_POINT: [&str; 5] = ["displacement.x", "displacement.y", "stress.xx", "stress.yy", "stress.xy"];

/// Displacement and stress at the points of a scene, five numbers for each.
pub(crate) fn values(scene: &Scene, field: &ElasticField<'_>) -> Vec<f64> {
    let outline = &scene.problem.outline;
    let at = |x: [f64; 2]| match outline.contains(x) {
        Location::Boundary { edge, s } => field.on_edge(edge, s),
        _ => field.inside(outline.body_at(x).unwrap_or(0), x),
    };
    scene
        .probe
        .iter()
        .flat_map(|&x| {
            let ([u, v], [xx, yy, xy]) = at(x);
            [u, v, xx, yy, xy]
        })
        .collect()
}

/// Whether quantities of a scene need the tractions of the enriched spaces.
pub(crate) fn needs_tractions(scene: &Scene) -> bool {
    !scene.probe.is_empty() && scene.random.is_none()
}

/// The forces of sides, with their numbers, whose error bars are known: of supports and rigid obstacles, without those of springs.
pub(crate) fn forces<'a>(
    scene: &'a Scene,
    reactions: &'a [(String, [f64; 2])],
) -> impl Iterator<Item = ([f64; 2], usize)> + 'a {
    let problem = &scene.problem;
    let of = |(name, force): &'a (String, [f64; 2])| {
        Some((*force, problem.sides.iter().position(|side| side.name == *name)?))
    };
    let known =
        |(_, side): &([f64; 2], usize)| problem.sides[*side].springs.is_none() && problem.joint(*side).is_none();
    let stabilised = scene.method.multiplier == Multiplier::Stabilised;
    reactions
        .iter()
        .filter_map(of)
        .filter(known)
        .filter(move |(_, side)| !(stabilised && problem.contact(*side).is_some()))
}

/// What a value is, which tells the values that it rounds with.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Displacement,
    Stress,
    Force,
}

/// The kinds of the values of `points` points, and of forces.
fn kind(k: usize, points: usize) -> Kind {
    match k % OF_POINT.len() {
        _ if k >= OF_POINT.len() * points => Kind::Force,
        0 | 1 => Kind::Displacement,
        _ => Kind::Stress,
    }
}

/// The components of the vector or tensor that a value belongs to.
fn group(k: usize, points: usize) -> Range<usize> {
    let first = k - k % OF_POINT.len();
    match kind(k, points) {
        Kind::Displacement => first..first + 2,
        Kind::Stress => first + 2..first + OF_POINT.len(),
        Kind::Force => {
            let of_points = OF_POINT.len() * points;
            let first = k - (k - of_points) % 2;
            first..first + 2
        }
    }
}

/// Values with their uncertainties: five for each of the points, then two for each force.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WithUncertainties {
    /// Number of points.
    points: usize,
    /// Value and uncertainty.
    values: Vec<[f64; 2]>,
    /// Displacement, stress and force of the size of the solution.
    sizes: [f64; 3],
}

impl WithUncertainties {
    /// The values of the last of these steps.
    pub(crate) fn new(scene: &Scene, estimates: &[&Estimate]) -> Self {
        let Some((last, before)) = estimates.split_last() else { return Self::default() };
        let points = scene.probe.len();
        let forces = last.quantities.len().checked_sub(OF_POINT.len() * points);
        if forces.is_none_or(|forces| forces % 2 != 0) {
            // of an altered file, or without any
            return Self::default();
        }
        // what was before an exact solution says nothing about it
        let before = before.last().filter(|before| before.quantities.len() == last.quantities.len());
        let before = before.filter(|_| last.relative > EXACT);
        let seen = |estimate: &Estimate, k: usize| {
            let group = group(k, points).map(|k| estimate.quantities[k]);
            let largest = group.map(|[value, plus]| (plus - value).abs()).fold(0.0, f64::max);
            let [value, plus] = estimate.quantities[k];
            (plus - value).abs().max(OF_OTHERS * largest)
        };
        let of = |(k, [value, _]): (usize, &[f64; 2])| {
            let d = seen(last, k);
            let uncertainty = match before {
                None => OF_SINGLE * d,
                Some(before) => {
                    let fallen = if before.error > 0.0 { (last.error / before.error).powi(2).min(1.0) } else { 1.0 };
                    let d = d.max(fallen * seen(before, k));
                    OF_DIFFERENCE * d + OF_CHANGE * (value - before.quantities[k][0]).abs()
                }
            };
            [*value, uncertainty]
        };
        let values = last.quantities.iter().enumerate().map(of).collect();
        // energy² E = force², energy² / E = length²
        let modulus = scene.problem.bodies.iter().map(|body| body.material().young).fold(0.0, f64::max);
        let force = last.scale * modulus.sqrt();
        let sizes = [force / modulus, force / scene.problem.outline.diameter(), force];
        let mut all = Self { points, values, sizes };
        for k in 0..all.values.len() {
            all.values[k][1] = all.values[k][1].max(all.rounding(k));
        }
        all
    }

    /// Rounding errors of a value.
    fn rounding(&self, k: usize) -> f64 {
        let own = kind(k, self.points);
        let of_kind = |other: &usize| kind(*other, self.points) == own;
        let sizes = (0..self.values.len()).filter(of_kind).map(|other| self.values[other][0].abs());
        ROUNDED * sizes.filter(|size| size.is_finite()).fold(self.sizes[own as usize], f64::max)
    }
}

/// Whether a point is a corner of the outline, or between two of its sides.
fn is_corner(scene: &Scene, x: [f64; 2]) -> bool {
    let outline = &scene.problem.outline;
    let Location::Boundary { edge, s } = outline.contains(x) else { return false };
    let at_end = s >= 1.0 - SAME_PLACE;
    if !at_end && s > SAME_PLACE {
        return false;
    }
    let edges = outline.edges();
    let (other, _) = outline.neighbour(edge, at_end);
    // forward along the loop
    let before = at_end == edges[edge].reversed;
    let [first, second] = if before { [other, edge] } else { [edge, other] };
    edges[first].side != edges[second].side || !is_straight(&edges[first], &edges[second])
}

/// J with `[extrapolated, its uncertainty]`, what the points have, and the forces, by their paths; stresses that are infinite are left out,
/// and components of forces that two sides share at a corner.
pub(crate) fn quantities(
    scene: &Scene,
    (energy, known): (f64, Option<[f64; 2]>),
    (all, probes): (&WithUncertainties, &[Probe]),
    reactions: &[(String, [f64; 2])],
    doubts: &[String],
) -> Quantities {
    let with = |value, uncertainty| Quantity { value, uncertainty, doubts: doubts.to_vec() };
    let mut told = Quantities::new();
    if let Some([extrapolated, uncertainty]) = known {
        told.insert("energy".to_owned(), with(energy, (extrapolated - energy).abs() + uncertainty));
    }
    let coarse = Doubt::Coarse.word();
    let of_points = OF_POINT.len() * all.points;
    for (k, &[value, uncertainty]) in all.values.iter().enumerate().take(of_points) {
        let point = k / OF_POINT.len();
        let Probe { point: x, stress_unbounded, .. } = probes[point];
        let is_stress = kind(k, all.points) == Kind::Stress;
        if is_stress && stress_unbounded {
            continue;
        }
        let mut quantity = with(value, uncertainty);
        let is_weak = if is_stress { is_corner(scene, x) } else { stress_unbounded };
        if is_weak && uncertainty > SMALL * all.rounding(k) {
            quantity.uncertainty *= OF_CORNER;
            quantity.doubts.extend((!doubts.iter().any(|doubt| doubt == coarse)).then(|| coarse.to_owned()));
        }
        told.insert(format!("probe.{point}.{}", OF_POINT[k % OF_POINT.len()]), quantity);
    }
    let of_forces = all.values.get(of_points..).unwrap_or_default().chunks_exact(2);
    for ((_, side), components) in forces(scene, reactions).zip(of_forces) {
        let shared = shared(scene, side);
        for (k, &[value, uncertainty]) in components.iter().enumerate().filter(|(k, _)| !shared[*k]) {
            let path = format!("reactions.{}.{}", scene.problem.sides[side].name, ["x", "y"][k]);
            told.insert(path, with(value, uncertainty));
        }
    }
    told
}

/// The components of the force that a support or an obstacle may have along an edge.
fn reacts(scene: &Scene, edge: &Edge) -> [bool; 2] {
    let side = &scene.problem.sides[edge.side];
    let held = match &side.condition {
        Condition::Displacement { values, .. } => values.each_ref().map(Option::is_some),
        _ => [false; 2],
    };
    let touched = match scene.problem.contact(edge.side) {
        None => [false; 2],
        Some(contact) if matches!(contact.friction, Friction::None) && edge.is_line() => {
            edge.normal(0.5).map(|n| n.abs() > SAME_PLACE)
        }
        Some(_) => [true; 2],
    };
    [0, 1].map(|k| held[k] || touched[k] || side.springs.is_some())
}

/// The components of the force of a side of which a corner has a part that is another side's as well: how much is whose is known to the
/// mesh alone.
fn shared(scene: &Scene, side: usize) -> [bool; 2] {
    let outline = &scene.problem.outline;
    let edges = outline.edges();
    let mut shared = [false; 2];
    for k in (0..edges.len()).filter(|&k| edges[k].side == side) {
        for (other, _) in [false, true].map(|rising| outline.neighbour(k, rising)) {
            if edges[other].side != side {
                let (own, others) = (reacts(scene, &edges[k]), reacts(scene, &edges[other]));
                (0..2).for_each(|i| shared[i] |= own[i] && others[i]);
            }
        }
    }
    shared
}
