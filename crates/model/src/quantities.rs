//! Numbers that users quote, each with its error bar.
//!
//! With J_k the value of step k, J₊ that of the enriched spaces at the same contact sets, and E the estimate in the energy norm,
//! ```text
//! s = Σ_e |η_e|                                       dual weighted residuals, see `estimate/dual.rs`
//! d_k = max(|J₊ - J_k|, s/2),   uncertainty = 1.2 max(d_k, d_{k-1} q) + Σ |δJ| of ends of contact,      q = min(1, (E_k / E_{k-1})²)
//! ```
//! but not more than what serves without a dual problem, in doubt, and for the first two steps:
//! ```text
//! uncertainty = 1.2 max(d_k, d_{k-1} q) + 0.3 |J_k - J_{k-1}|,      d_k = |J₊ - J_k|
//! ```
//! |J₊ - J_k| crosses zero by accident, hardly twice in a row and hardly in all components: without a dual that of a component is a quarter of
//! the largest one of its vector or tensor or more. The value of a pressure at a point is J₊, as tractions gain most of the enriched spaces.
//! Of a single mesh, and of an exact solution, which has no step before it, the uncertainty is max(5 |J₊ - J|, s). At corners and between sides J₊
//! removes less of the error: there stresses, and displacements where the stress is infinite, have three times the uncertainty, and the doubt
//! `coarse`; pressures within one element of an end of contact have the doubt `transition`. Where a body has contact
//! and data that vary between the nodes make a quarter of the squared error or more, all have the doubt `data`: the enriched spaces miss the
//! most of a narrow gap, though not of a smooth one.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::{Deserialize, Serialize};
use steklov_bem_operators::{Location, SAME_PLACE};
use steklov_elastic::plane::distance;
use steklov_problem::{Indicator, Multiplier, NamedQuantity, QuantityKind, Scene};

use crate::answer::data_jumps::kinks;
use crate::answer::probes::invariants;
use crate::answer::singular_points::singular_points;
use crate::answer::wedges::is_straight;
use crate::contact_length::extracts_ends;
use crate::doubt::Doubt;
use crate::estimate::error_estimate::{Bubble, Estimate, ROUNDOFF, UNRESOLVED};
use crate::grid::{GridQuantity, GridSolved};
use crate::named::components;
use crate::reacting::{shared, works_alone};
use crate::solve::contact_rows::{ContactRow, TOUCHING};
use crate::solve::fields::ElasticField;
use crate::summary::{Named, Probe};

/// How far the exact value may be, over the part that the enriched spaces see.
const OF_DIFFERENCE: f64 = 1.2;
/// The same over the change since the step before.
const OF_CHANGE: f64 = 0.3;
/// How far the exact value may be, over the part that the enriched spaces see, without a step before.
const OF_SINGLE: f64 = 5.0;
/// The part of Σ |η_e| that a difference has at least.
const OF_WEIGHTED: f64 = 0.5;
/// Steps before the one whose dual problems are trusted: the first ones see little of crack tips and corners.
const LEAST_BEFORE: usize = 2;
/// Least part of the other components' differences that a component has without a dual problem.
const OF_OTHERS: f64 = 0.25;
/// Relative errors of the energy norm that are rounding.
const EXACT: f64 = 1e-10;
/// Relative errors of the energy norm whose squares may be rounding errors of J.
const ENERGY_ROUNDED: f64 = 1e-5;
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
    /// Its parts by their names, whose sum it is; empty where it has one only.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parts: BTreeMap<String, f64>,
}

/// A quantity on a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedQuantity {
    /// J(u).
    pub value: f64,
    /// J(u₊) of the enriched spaces.
    pub enriched: f64,
    /// Σ |η_e| of the dual weighted residuals, and what ends of contact add that are not at their vertices; where a dual problem is known.
    pub weighted: Option<[f64; 2]>,
}

/// The quantities of a result by their paths in the JSON object.
pub type Quantities = BTreeMap<String, Quantity>;

/// The components at a point, in the order of [`at_points`].
const OF_POINT: [&str; 8] = [
    "displacement.x",
    "displacement.y",
    "stress.xx",
    "stress.yy",
    "stress.xy",
    "von_mises",
    "max_principal",
    "min_principal",
];

/// Displacement and stress at a point.
pub(crate) type At<'a> = dyn Fn([f64; 2]) -> ([f64; 2], [f64; 3]) + 'a;

/// Displacement, stress and its invariants at the points of a scene, of a field and that of a medium around a body, if there is one.
pub(crate) fn at_points(scene: &Scene, field: &ElasticField<'_>, medium: Option<&At<'_>>) -> Vec<f64> {
    let outline = &scene.problem.outline;
    let at = |x: [f64; 2]| match (outline.contains(x), medium) {
        (Location::Boundary { edge, s }, _) => field.on_edge(edge, s),
        (Location::Outside, Some(medium)) => medium(x),
        _ => field.inside(outline.body_at(x).unwrap_or(0), x),
    };
    scene
        .probe
        .iter()
        .flat_map(|&x| {
            let ([u, v], stress) = at(x);
            let ([xx, yy, xy], [von_mises, larger, smaller]) = (stress, invariants(scene, x, stress));
            [u, v, xx, yy, xy, von_mises, larger, smaller]
        })
        .collect()
}

/// Whether quantities of a scene need the tractions of the enriched spaces.
pub(crate) fn needs_tractions(scene: &Scene) -> bool {
    !scene.probe.is_empty() || !scene.quantities.is_empty() || has_contact(scene)
}

/// Whether a scene has contact with biorthogonal multipliers, whose largest pressure is a quantity.
pub(crate) fn has_contact(scene: &Scene) -> bool {
    scene.contacts().next().is_some() && scene.method.multiplier == Multiplier::Biorthogonal
}

/// The forces of sides, with their numbers, whose error bars are known: of supports and rigid obstacles, without those of springs.
pub(crate) fn forces<'a>(
    scene: &'a Scene,
    reactions: &'a [(String, [f64; 2])],
) -> impl Iterator<Item = ([f64; 2], usize)> + 'a {
    let of = |(name, force): &'a (String, [f64; 2])| {
        Some((*force, scene.problem.sides.iter().position(|side| side.name == *name)?))
    };
    reactions.iter().filter_map(of).filter(|(_, side)| is_known(scene, *side))
}

/// Whether the enriched spaces tell how far the force of a side may be off: that of a support or a rigid obstacle.
fn is_known(scene: &Scene, side: usize) -> bool {
    let (problem, stabilised) = (&scene.problem, scene.method.multiplier == Multiplier::Stabilised);
    let touched = problem.contact(side).is_some();
    problem.sides[side].springs.is_none() && problem.joint(side).is_none() && !(stabilised && touched)
}

/// What a value is, which tells the values that it rounds with.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Displacement,
    Stress,
    Force,
    Moment,
}

/// Where a value stands.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Of {
    /// A point of `[probe]`.
    Point(usize),
    /// The force of a side.
    Force(usize),
    /// One of the named quantities.
    Named(usize),
    /// The largest pressure of contact.
    Peak,
    /// The length of contact.
    Length,
}

/// A value by its path.
#[derive(Debug, Clone, PartialEq)]
struct Entry {
    path: String,
    kind: Kind,
    of: Of,
    /// The components of its vector or tensor.
    group: Range<usize>,
}

/// The values of [`Estimate::quantities`] in their order: those at points, the forces of sides, the named quantities.
fn entries(scene: &Scene, reactions: &[(String, [f64; 2])]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    let mut add = |of: Of, kind: Kind, paths: Vec<String>| {
        let group = entries.len()..entries.len() + paths.len();
        entries.extend(paths.into_iter().map(|path| Entry { path, kind, of, group: group.clone() }));
    };
    for point in 0..scene.probe.len() {
        let paths = |of: Range<usize>| OF_POINT[of].iter().map(|name| format!("probe.{point}.{name}")).collect();
        add(Of::Point(point), Kind::Displacement, paths(0..2));
        add(Of::Point(point), Kind::Stress, paths(2..5));
        add(Of::Point(point), Kind::Stress, paths(5..6));
        add(Of::Point(point), Kind::Stress, paths(6..OF_POINT.len()));
    }
    for (_, side) in forces(scene, reactions) {
        let name = &scene.problem.sides[side].name;
        add(Of::Force(side), Kind::Force, ["x", "y"].map(|i| format!("reactions.{name}.{i}")).to_vec());
    }
    for (k, NamedQuantity { name, kind }) in scene.quantities.iter().enumerate() {
        let path = format!("{}.{name}", kind.group());
        let sort = match kind {
            QuantityKind::PressureAt(_) => Kind::Stress,
            QuantityKind::Moment { .. } => Kind::Moment,
            QuantityKind::WeightedForce { .. } => Kind::Force,
            QuantityKind::MeanDisplacement(_) | QuantityKind::OpeningAt(_) => Kind::Displacement,
        };
        let paths = if components(kind) == 2 { ["x", "y"].map(|i| format!("{path}.{i}")).to_vec() } else { vec![path] };
        add(Of::Named(k), sort, paths);
    }
    if has_contact(scene) {
        add(Of::Peak, Kind::Stress, vec!["contact.max_pressure".to_owned()]);
    }
    if extracts_ends(scene) {
        add(Of::Length, Kind::Displacement, vec!["contact.length".to_owned()]);
    }
    entries
}

/// Values with their error bars.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bars {
    entries: Vec<Entry>,
    /// Value and uncertainty.
    values: Vec<[f64; 2]>,
    /// Displacement, stress, force and moment of the size of the solution.
    sizes: [f64; 4],
    /// ½ Σ |η_e| of J, of an estimate without doubts, above rounding errors, where J is stationary.
    of_energy: Option<f64>,
    /// Whether data between the nodes, with contact those of its gaps, make a good part of the error: the enriched spaces miss them too.
    of_gaps: bool,
    /// On a grid the parts of each uncertainty: that of the fine grid and that of its coarse cells.
    parts: Vec<[f64; 2]>,
    /// On a grid the parts of the uncertainty of J.
    parts_of_energy: Option<[f64; 2]>,
    /// On a grid the points at which moduli jump, and those beside singular points.
    at_jumps: Vec<usize>,
    near_singular: Vec<usize>,
    /// Rounding errors of a value, over the largest of its kind.
    rounded: f64,
}

/// The names of the parts on a grid.
const ON_GRID: [&str; 2] = ["fine_grid", "multiscale"];

impl Bars {
    /// The values of the last of these steps.
    pub(crate) fn new(scene: &Scene, reactions: &[(String, [f64; 2])], estimates: &[&Estimate]) -> Self {
        let Some((last, before)) = estimates.split_last() else { return Self::default() };
        let entries = entries(scene, reactions);
        if last.quantities.len() != entries.len() {
            // of an altered file, or without any
            return Self::default();
        }
        // what was before an exact solution says nothing about it
        let is_early = before.len() < LEAST_BEFORE;
        let before = before.last().filter(|before| before.quantities.len() == last.quantities.len());
        let before = before.filter(|_| last.relative > EXACT);
        let difference = |q: &EstimatedQuantity| (q.enriched - q.value).abs();
        let seen = |estimate: &Estimate, k: usize| {
            let own = difference(&estimate.quantities[k]);
            let group = estimate.quantities[entries[k].group.clone()].iter().map(difference);
            // what nothing bears is zero, and not by accident
            if own == 0.0 { 0.0 } else { own.max(OF_OTHERS * group.fold(0.0, f64::max)) }
        };
        let weighted = |quantity: &EstimatedQuantity| {
            quantity.weighted.map(|[sum, of_ends]| (difference(quantity).max(OF_WEIGHTED * sum), of_ends))
        };
        let of = |(k, quantity): (usize, &EstimatedQuantity)| {
            let &EstimatedQuantity { value, enriched, .. } = quantity;
            let before = before.map(|before| (before, &before.quantities[k])).filter(|(_, q)| q.value.is_finite());
            let uncertainty = match before {
                Some((before, of_before)) => {
                    let fallen = if before.error > 0.0 { (last.error / before.error).powi(2).min(1.0) } else { 1.0 };
                    let change = (value - of_before.value).abs();
                    let d = seen(last, k).max(fallen * seen(before, k));
                    let wide = OF_DIFFERENCE * d + OF_CHANGE * change;
                    match weighted(quantity).filter(|_| last.doubts.is_empty() && !is_early) {
                        Some((d, of_ends)) => {
                            let d = d.max(fallen * weighted(of_before).map_or(0.0, |(d, _)| d));
                            wide.min(OF_DIFFERENCE * d + of_ends)
                        }
                        None => wide,
                    }
                }
                None => (OF_SINGLE * seen(last, k)).max(quantity.weighted.map_or(0.0, |[sum, _]| sum)),
            };
            let is_pressure = matches!(entries[k], Entry { of: Of::Named(_) | Of::Peak, kind: Kind::Stress, .. });
            [if is_pressure { enriched } else { value }, uncertainty]
        };
        let values = last.quantities.iter().enumerate().map(of).collect();
        let sizes = sizes(scene, last.scale);
        let coulomb = scene.contacts().any(|(_, contact)| contact.friction.coefficient().is_some());
        let is_plain = last.doubts.is_empty() && last.relative > ENERGY_ROUNDED && !coulomb;
        let of_energy = is_plain.then(|| OF_WEIGHTED * weighted_energy(last));
        let oscillation: f64 = last.indicators.iter().chain(&last.of_cuts).map(|bubble| bubble.oscillation).sum();
        let of_gaps =
            has_contact(scene) && last.relative > ROUNDOFF && oscillation > UNRESOLVED * last.error * last.error;
        let mut all = Self { entries, values, sizes, of_energy, of_gaps, rounded: ROUNDED, ..Self::default() };
        for k in 0..all.values.len() {
            all.values[k][1] = all.values[k][1].max(all.rounding(k));
        }
        all
    }

    /// The values of the last of these steps, with the differences of the enriched spaces in the mean over outcomes.
    pub(crate) fn over_outcomes(
        scene: &Scene,
        reactions: &[(String, [f64; 2])],
        estimates: &[&Estimate],
        mean: &[EstimatedQuantity],
    ) -> Self {
        let Some((last, before)) = estimates.split_last().filter(|(last, _)| last.quantities.len() == mean.len())
        else {
            return Self::default();
        };
        let with = |(own, mean): (&EstimatedQuantity, &EstimatedQuantity)| {
            let enriched = own.value + (mean.enriched - mean.value);
            EstimatedQuantity { value: own.value, enriched, weighted: mean.weighted }
        };
        let quantities = last.quantities.iter().zip(mean).map(with).collect();
        let last = Estimate { quantities, ..(*last).clone() };
        Self::new(scene, reactions, &[before, &[&last]].concat())
    }

    /// The values of a solution on a grid.
    pub(crate) fn on_grid(scene: &Scene, solved: &GridSolved) -> Self {
        let (quantities, entries) = (solved.quantities(scene), entries(scene, &solved.reactions));
        let Some(estimate) = solved.estimate.as_ref().filter(|_| quantities.len() == entries.len()) else {
            return Self::default();
        };
        let of = |own: &GridQuantity| [own.fine_grid, own.multiscale].map(|part| OF_DIFFERENCE * part);
        let parts: Vec<[f64; 2]> = quantities.iter().map(of).collect();
        let values = quantities.iter().zip(&parts).map(|(own, parts)| [own.value, parts.iter().sum()]).collect();
        let scale = if estimate.relative > 0.0 { estimate.error / estimate.relative } else { 0.0 };
        let parts_of_energy = solved.energy(scene).map(|energy| {
            // what the estimate sees of loads that cells do not resolve as well
            let fine = if scene.method.indicator == Indicator::Bubble { estimate.fine_grid / 2.0 } else { 0.0 };
            [energy.fine_grid.max(fine), energy.multiscale].map(|part| OF_DIFFERENCE * part)
        });
        let at_jumps = solved.at_jumps(&scene.probe);
        let near_singular = solved.near_singular(&scene.probe, &singular_points(scene, solved.trace().mesh, &[]));
        let rounded = solved.digits().max(ROUNDED);
        let mut all = Self {
            entries,
            values,
            sizes: sizes(scene, scale),
            of_energy: None,
            of_gaps: false,
            parts,
            parts_of_energy,
            at_jumps,
            near_singular,
            rounded,
        };
        for k in 0..all.values.len() {
            all.values[k][1] = all.values[k][1].max(all.rounding(k));
        }
        all
    }

    /// The means of the bars of outcomes on a grid; none without any.
    pub(crate) fn mean(of_outcomes: &[Self]) -> Option<Self> {
        let (mut all, count) = (of_outcomes.first()?.clone(), of_outcomes.len() as f64);
        if all.entries.is_empty() || of_outcomes.iter().any(|own| own.entries != all.entries) {
            return None;
        }
        let mean = |of: &dyn Fn(&Self) -> f64| of_outcomes.iter().map(of).sum::<f64>() / count;
        let pair = |of: &dyn Fn(&Self) -> [f64; 2]| [0, 1].map(|part| mean(&|own| of(own)[part]));
        all.values = (0..all.values.len()).map(|k| pair(&|own| own.values[k])).collect();
        all.parts = (0..all.parts.len()).map(|k| pair(&|own| own.parts[k])).collect();
        let known = of_outcomes.iter().all(|own| own.parts_of_energy.is_some());
        all.parts_of_energy = known.then(|| pair(&|own| own.parts_of_energy.unwrap_or_default()));
        all.at_jumps = of_outcomes.iter().flat_map(|own| own.at_jumps.clone()).collect();
        all.near_singular = of_outcomes.iter().flat_map(|own| own.near_singular.clone()).collect();
        Some(all)
    }

    /// Rounding errors of a value.
    fn rounding(&self, k: usize) -> f64 {
        let own = self.entries[k].kind;
        let of_kind = self.entries.iter().zip(&self.values).filter(|(entry, _)| entry.kind == own);
        let sizes = of_kind.map(|(_, [value, _])| value.abs());
        self.rounded * sizes.filter(|size| size.is_finite()).fold(self.sizes[own as usize], f64::max)
    }

    /// Gives the named quantities their values, which are those of the enriched spaces for some of them.
    pub(crate) fn tell(&self, named: &mut [f64]) {
        let own = self.entries.iter().zip(&self.values).filter(|(entry, _)| matches!(entry.of, Of::Named(_)));
        named.iter_mut().zip(own).for_each(|(told, (_, [value, _]))| *told = *value);
    }
}

/// Displacement, stress, force and moment of a solution with this energy norm.
fn sizes(scene: &Scene, norm: f64) -> [f64; 4] {
    // energy² E = force², energy² / E = length²
    let modulus = scene.problem.bodies.iter().map(|body| body.material().young).fold(0.0, f64::max);
    let (force, diameter) = (norm * modulus.sqrt(), scene.problem.outline.diameter());
    [force / modulus, force / diameter, force, force * diameter]
}

/// Σ |η_e| of J, whose dual solution is u itself: the residuals of displacement and traction have opposite signs.
fn weighted_energy(estimate: &Estimate) -> f64 {
    let of = |bubble: &Bubble| 0.5 * ((bubble.displacement - bubble.traction).abs() + bubble.oscillation);
    estimate.indicators.iter().chain(&estimate.of_cuts).map(of).sum()
}

/// Whether a point is a corner of the outline, between two of its sides, or where data of its side jump or have a kink.
fn is_corner(scene: &Scene, x: [f64; 2]) -> bool {
    let outline = &scene.problem.outline;
    let Location::Boundary { edge, s } = outline.contains(x) else { return false };
    let at_end = s >= 1.0 - SAME_PLACE;
    let edges = outline.edges();
    if !at_end && s > SAME_PLACE {
        return kinks(scene, &edges[edge]).iter().any(|kink| (kink - s).abs() <= SAME_PLACE);
    }
    let (other, _) = outline.neighbour(edge, at_end);
    // forward along the loop
    let before = at_end == edges[edge].reversed;
    let [first, second] = if before { [other, edge] } else { [edge, other] };
    edges[first].side != edges[second].side || !is_straight(&edges[first], &edges[second])
}

/// The named quantities by their names; pressures are NaN where they are infinite.
pub(crate) fn named(scene: &Scene, values: &[f64], infinite: impl Fn([f64; 2]) -> bool) -> Named {
    let mut named = Named::default();
    let mut values = values.iter().copied();
    for NamedQuantity { name, kind } in &scene.quantities {
        let Some(value) = values.next() else { break };
        let group = match kind {
            QuantityKind::PressureAt(x) => {
                named.pressure.insert(name.clone(), if infinite(*x) { f64::NAN } else { value });
                continue;
            }
            QuantityKind::MeanDisplacement(_) => {
                named.mean_displacement.insert(name.clone(), [value, values.next().unwrap_or(f64::NAN)]);
                continue;
            }
            QuantityKind::Moment { .. } => &mut named.moment,
            QuantityKind::WeightedForce { .. } => &mut named.weighted_force,
            QuantityKind::OpeningAt(_) => &mut named.opening,
        };
        group.insert(name.clone(), value);
    }
    named
}

/// What a result tells with the doubts of all of it.
#[derive(Clone, Copy)]
pub(crate) struct Told<'a> {
    /// J, and `[extrapolated, its uncertainty]`.
    pub energy: (f64, Option<[f64; 2]>),
    /// The points of the scene.
    pub probes: &'a [Probe],
    /// The named quantities.
    pub named: &'a Named,
    /// Which of them are near an end of contact.
    pub near: &'a [bool],
    /// The largest pressure of a node, if it is not zero and no stress on a side in contact infinite.
    pub peak: Option<f64>,
    /// The length of contact, and what misplaced vertices add to its uncertainty.
    pub length: Option<[f64; 2]>,
    /// The contact table.
    pub rows: &'a [ContactRow],
    /// Words of doubts.
    pub doubts: &'a [String],
}

/// J and the values with error bars by their paths; stresses that are infinite are left out, and what two sides share at a corner.
pub(crate) fn quantities(scene: &Scene, all: &Bars, told: Told<'_>) -> Quantities {
    let with =
        |value, uncertainty| Quantity { value, uncertainty, doubts: told.doubts.to_vec(), parts: BTreeMap::new() };
    let of_parts =
        |parts: &[f64; 2]| ON_GRID.iter().zip(parts).map(|(name, &part)| ((*name).to_owned(), part)).collect();
    let doubt = |quantity: &mut Quantity, doubt: Doubt| {
        let is_new = !quantity.doubts.iter().any(|word| word == doubt.word());
        quantity.doubts.extend(is_new.then(|| doubt.word().to_owned()));
    };
    let mut quantities = Quantities::new();
    let (energy, known) = told.energy;
    if let Some(parts) = all.parts_of_energy {
        let least = all.rounded * energy.abs();
        let quantity = with(energy, parts.iter().sum::<f64>().max(least));
        quantities.insert("energy".to_owned(), Quantity { parts: of_parts(&parts), ..quantity });
    } else if let Some([extrapolated, uncertainty]) = known {
        let d = (extrapolated - energy).abs();
        let wide = d + uncertainty;
        let uncertainty = all.of_energy.map_or(wide, |half| wide.min(OF_DIFFERENCE * d.max(half)));
        quantities.insert("energy".to_owned(), with(energy, uncertainty));
    }
    let first = all.entries.iter().position(|entry| matches!(entry.of, Of::Named(_))).unwrap_or(0);
    for (k, (entry, &[value, uncertainty])) in all.entries.iter().zip(&all.values).enumerate() {
        let mut quantity = with(value, uncertainty);
        if let Some(parts) = all.parts.get(k) {
            quantity.parts = of_parts(parts);
        }
        if all.of_gaps {
            doubt(&mut quantity, Doubt::Data);
        }
        match entry.of {
            Of::Peak => {
                let Some(at_node) = told.peak.filter(|_| value.is_finite() && uncertainty.is_finite()) else {
                    continue;
                };
                // an exact pressure has more digits at nodes than as a traction
                if (value - at_node).abs() <= SMALL * all.rounding(k) {
                    quantity.value = at_node;
                }
            }
            Of::Length => match told.length.filter(|_| value.is_finite() && uncertainty.is_finite()) {
                Some([length, of_vertices]) => {
                    (quantity.value, quantity.uncertainty) = (length, uncertainty + of_vertices);
                }
                None => continue,
            },
            Of::Point(point) => {
                let Probe { point: x, stress_unbounded, .. } = told.probes[point];
                let is_stress = entry.kind == Kind::Stress;
                if is_stress && stress_unbounded {
                    continue;
                }
                let is_weak = all.near_singular.contains(&point)
                    || if is_stress { is_corner(scene, x) || all.at_jumps.contains(&point) } else { stress_unbounded };
                if is_weak && uncertainty > SMALL * all.rounding(k) {
                    quantity.uncertainty *= OF_CORNER;
                    quantity.parts.values_mut().for_each(|part| *part *= OF_CORNER);
                    doubt(&mut quantity, Doubt::Coarse);
                }
            }
            Of::Force(side) => {
                if shared(scene, side)[k - entry.group.start] {
                    continue;
                }
            }
            Of::Named(of) => {
                let NamedQuantity { name, kind } = &scene.quantities[of];
                if let Some((side, w)) = kind.weighted_side()
                    && !(is_known(scene, side) && works_alone(scene, side, w))
                {
                    continue;
                }
                if told.named.pressure.get(name).is_some_and(|pressure| pressure.is_nan()) {
                    continue;
                }
                // between nodes that touch only the interpolation keeps the surfaces apart
                if let QuantityKind::OpeningAt(x) = *kind
                    && touches_at(told.rows, x)
                {
                    quantity.uncertainty = uncertainty.max(value.abs());
                }
                if told.near.get(k - first).copied().unwrap_or(false) {
                    doubt(&mut quantity, Doubt::Transition);
                }
            }
        }
        quantities.insert(entry.path.clone(), quantity);
    }
    quantities
}

/// Whether the node of contact that is nearest to a point touches.
fn touches_at(rows: &[ContactRow], x: [f64; 2]) -> bool {
    let nearest = rows.iter().min_by(|a, b| distance(a.point, x).total_cmp(&distance(b.point, x)));
    let largest = rows.iter().fold(0.0, |largest: f64, row| largest.max(row.pressure));
    nearest.is_some_and(|row| row.pressure > TOUCHING * largest)
}
