//! The error bars of the values of a run.
//!
//! With J_k the value of step k, J₊ that of the enriched spaces at the same contact sets, and E the estimate in the energy norm,
//! ```text
//! s = Σ_e |η_e|                                       dual weighted residuals, see `estimate/dual.rs`
//! d_k = max(|J₊ - J_k|, s/2),   uncertainty = 1.2 max(d_k, d_{k-1} q) + Σ |δJ| of ends of contact,      q = min(1, (E_k / E_{k-1})²)
//! ```
//! but not more than the sum of all changes to come, if each is q of the one before, or less than the last one, allows:
//! ```text
//! uncertainty ≤ 1.2 max(d_k, d_{k-1} q) + max(1, q/(1 - q)) |J_k - J_{k-1}|,      d_k = |J₊ - J_k|
//! ```
//! Without a dual problem, and in doubt, it is
//! ```text
//! uncertainty = 1.2 max(d_k, d_{k-1} q) + 0.3 |J_k - J_{k-1}|,      d_k = |J₊ - J_k|
//! ```
//! |J₊ - J_k| crosses zero by accident, hardly twice in a row and hardly in all components: without a dual that of a component is a quarter of
//! the largest one of its vector or tensor or more. The value of a pressure at a point is J₊, as tractions gain most of the enriched spaces.
//! It depends on the contact sets: what serves without a dual problem is three times as wide.
//! Of a single mesh, and of an exact solution, which has no step before it, that is max(5 |J₊ - J|, s). At corners and between sides J₊
//! removes less of the error: there stresses, and displacements where the stress is infinite, have three times the uncertainty, and the doubt
//! `coarse`; pressures within one element of an end of contact have the doubt `transition`. Where a body has contact
//! and data that vary between the nodes make a quarter of the squared error or more, all have the doubt `data`: the enriched spaces miss the
//! most of a narrow gap, though not of a smooth one.

use std::ops::Range;

use steklov_bem_operators::Location;
use steklov_problem::{Indicator, NamedQuantity, QuantityKind, Scene};

use crate::answer::singular_points::singular_points;
use crate::contact_length::extracts_ends;
use crate::doubt::Doubt;
use crate::estimate::error_estimate::{Bubble, Estimate, NOT_STATIONARY, ROUNDOFF, UNRESOLVED};
use crate::estimate::reaction_work::{has_friction_work, has_reaction_work};
use crate::estimate::strain_of_bodies::has_strain_of_bodies;
use crate::grid::{GridQuantity, GridSolved, doubts_of_contact, has_jump_work, knows_friction_work};
use crate::named::components;
use crate::quantities::{EstimatedQuantity, OF_POINT, forces, forces_between, has_contact, has_largest_stress, peaks};
use crate::reacting::shared;
use crate::solve::solution::OverOutcomes;

/// How far the exact value may be, over the part that the enriched spaces see.
pub(crate) const OF_DIFFERENCE: f64 = 1.2;
/// The same over the change since the step before.
pub(crate) const OF_CHANGE: f64 = 0.3;
/// How far the exact value may be, over the part that the enriched spaces see, without a step before.
const OF_SINGLE: f64 = 5.0;
/// The part of Σ |η_e| that a difference has at least.
const OF_WEIGHTED: f64 = 0.5;
/// How much wider the bars of a pressure, and with contact of the largest stress and of forces that sides share at a corner, are without a
/// dual problem: they depend on where contact ends, which frozen sets do not see.
const OF_PRESSURE: f64 = 3.0;
/// Least part of the other components' differences that a component has without a dual problem.
const OF_OTHERS: f64 = 0.25;
/// Relative errors of the energy norm that are rounding.
const EXACT: f64 = 1e-10;
/// Relative errors of the energy norm whose squares may be rounding errors of J.
const ENERGY_ROUNDED: f64 = 1e-5;
/// Rounding errors of a value, over the largest of its kind.
pub(crate) const ROUNDED: f64 = 1e-11;

/// What a value is, which tells the values that it rounds with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    Displacement,
    Stress,
    Force,
    Moment,
    Energy,
}

/// Where a value stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Of {
    /// A point of `[probe]`.
    Point(usize),
    /// The force of a side.
    Force(usize),
    /// The force of an interface between bodies.
    Interface(usize),
    /// One of the named quantities.
    Named(usize),
    /// The largest pressure of all contact, or of an interface between bodies.
    Peak(Option<usize>),
    /// The length of contact.
    Length,
    /// The work of reactions on what they prescribe.
    Reactions,
    /// The work against friction.
    Friction,
    /// The strain energy of one of several bodies.
    Strain,
    /// The energy of springs.
    Springs,
    /// The largest von Mises stress.
    LargestStress,
}

/// A value by its path.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub(crate) path: String,
    pub(crate) kind: Kind,
    pub(crate) of: Of,
    /// The components of its vector or tensor.
    pub(crate) group: Range<usize>,
    /// Whether the differences of the other components say nothing of its own: of forces whose corners other sides share along one axis.
    alone: bool,
}

/// The values of [`Estimate::quantities`] in their order: those at points, the forces of sides and of interfaces, the named quantities.
fn entries(scene: &Scene, reactions: &[(String, [f64; 2])]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    let mut add = |of: Of, kind: Kind, paths: Vec<String>| {
        let group = entries.len()..entries.len() + paths.len();
        let alone = match of {
            Of::Force(side) => shared(scene, &[side]) != [false; 2],
            Of::Interface(number) => {
                scene.problem.joints().nth(number).is_some_and(|own| shared(scene, &own.sides) != [false; 2])
            }
            _ => false,
        };
        entries.extend(paths.into_iter().map(|path| Entry { path, kind, of, group: group.clone(), alone }));
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
    for (number, _) in forces_between(scene) {
        add(Of::Interface(number), Kind::Force, ["x", "y"].map(|i| format!("interfaces.{number}.force.{i}")).to_vec());
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
    for peak in peaks(scene) {
        let of = peak.map_or("contact".to_owned(), |number| format!("interfaces.{number}"));
        add(Of::Peak(peak), Kind::Stress, vec![format!("{of}.max_pressure")]);
    }
    if extracts_ends(scene) {
        add(Of::Length, Kind::Displacement, vec!["contact.length".to_owned()]);
    }
    entries
}

/// The works of reactions and against friction, behind the other values of boundary elements.
fn add_works(scene: &Scene, entries: &mut Vec<Entry>) {
    let works = [
        (has_reaction_work(scene), Of::Reactions, "reaction_work"),
        (has_friction_work(scene), Of::Friction, "friction_work"),
    ];
    works.into_iter().filter(|(known, ..)| *known).for_each(|(_, of, path)| add_work(entries, of, path));
}

fn add_work(entries: &mut Vec<Entry>, of: Of, path: &str) {
    let group = entries.len()..entries.len() + 1;
    entries.push(Entry { path: path.to_owned(), kind: Kind::Energy, of, group, alone: false });
}

/// The strain energies of several bodies, behind the works.
fn add_strain_of_bodies(scene: &Scene, entries: &mut Vec<Entry>) {
    if has_strain_of_bodies(scene) {
        let bodies = 0..scene.problem.bodies.len();
        bodies.for_each(|body| add_work(entries, Of::Strain, &format!("bodies.{body}.strain_energy")));
    }
}

/// The energy of springs, behind those.
fn add_springs(scene: &Scene, entries: &mut Vec<Entry>) {
    if scene.problem.has_springs() {
        add_work(entries, Of::Springs, "spring_energy");
    }
}

/// The largest von Mises stress, behind the works.
fn add_largest_stress(scene: &Scene, entries: &mut Vec<Entry>) {
    if has_largest_stress(scene) {
        let group = entries.len()..entries.len() + 1;
        entries.push(Entry {
            path: MAX_VON_MISES.to_owned(),
            kind: Kind::Stress,
            of: Of::LargestStress,
            group,
            alone: true,
        });
    }
}

/// The path of the largest von Mises stress.
pub(crate) const MAX_VON_MISES: &str = "max_von_mises";

/// Values with their error bars.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bars {
    pub(crate) entries: Vec<Entry>,
    /// Value and uncertainty.
    pub(crate) values: Vec<[f64; 2]>,
    /// Displacement, stress, force, moment and energy of the size of the solution.
    pub(crate) sizes: [f64; 5],
    /// ½ Σ |η_e| of J, of an estimate without doubts, above rounding errors, where J is stationary.
    pub(crate) of_energy: Option<f64>,
    /// Doubts about all values: with contact whether data between the nodes make a good part of the error, which the enriched spaces miss too.
    pub(crate) doubts: Vec<Doubt>,
    /// On a grid the parts of each uncertainty: that of the fine grid, of its coarse cells and of a medium.
    pub(crate) parts: Vec<[f64; 3]>,
    /// On a grid the parts of the uncertainty of J.
    pub(crate) parts_of_energy: Option<[f64; 3]>,
    /// On a grid the points at which moduli jump, and those beside singular points.
    pub(crate) at_jumps: Vec<usize>,
    pub(crate) near_singular: Vec<usize>,
    /// Rounding errors of a value, over the largest of its kind.
    pub(crate) rounded: f64,
}

/// The names of the parts on a grid.
pub(crate) const ON_GRID: [&str; 3] = ["fine_grid", "multiscale", "medium"];

impl Bars {
    /// The values of the last of these steps.
    pub(crate) fn new(scene: &Scene, reactions: &[(String, [f64; 2])], estimates: &[&Estimate]) -> Self {
        let Some((last, before)) = estimates.split_last() else { return Self::default() };
        let mut entries = entries(scene, reactions);
        add_works(scene, &mut entries);
        add_strain_of_bodies(scene, &mut entries);
        add_springs(scene, &mut entries);
        add_largest_stress(scene, &mut entries);
        if last.quantities.len() != entries.len() {
            // of an altered file, or without any
            return Self::default();
        }
        // what was before an exact solution says nothing about it
        let before = before.last().filter(|before| before.quantities.len() == last.quantities.len());
        let before = before.filter(|_| last.relative > EXACT);
        let difference = |q: &EstimatedQuantity| (q.enriched - q.value).abs();
        let seen = |estimate: &Estimate, k: usize| {
            let own = difference(&estimate.quantities[k]);
            let group = estimate.quantities[entries[k].group.clone()].iter().map(difference);
            // what nothing bears is zero, and not by accident
            if own == 0.0 || entries[k].alone { own } else { own.max(OF_OTHERS * group.fold(0.0, f64::max)) }
        };
        let weighted = |quantity: &EstimatedQuantity| {
            quantity.weighted.map(|[sum, of_ends]| (difference(quantity).max(OF_WEIGHTED * sum), of_ends))
        };
        let has_contact = has_contact(scene);
        let of = |(k, quantity): (usize, &EstimatedQuantity)| {
            let &EstimatedQuantity { value, enriched, .. } = quantity;
            let is_pressure = matches!(entries[k], Entry { of: Of::Named(_) | Of::Peak(_), kind: Kind::Stress, .. });
            let of_sets = is_pressure || has_contact && (entries[k].of == Of::LargestStress || entries[k].alone);
            let wider = if of_sets { OF_PRESSURE } else { 1.0 };
            let before = before.map(|before| (before, &before.quantities[k])).filter(|(_, q)| q.value.is_finite());
            let own = weighted(quantity).filter(|_| last.doubts.is_empty());
            let uncertainty = match (before, own) {
                (Some((before, of_before)), own) => {
                    let fallen = if before.error > 0.0 { (last.error / before.error).powi(2).min(1.0) } else { 1.0 };
                    let change = (value - of_before.value).abs();
                    let d = seen(last, k).max(fallen * seen(before, k));
                    let with = |of_change: f64| wider * (OF_DIFFERENCE * d + of_change * change);
                    match own {
                        Some((own, of_ends)) => {
                            let own = own.max(fallen * weighted(of_before).map_or(0.0, |(d, _)| d));
                            let bar = OF_DIFFERENCE * own + of_ends;
                            if fallen < 1.0 { with((fallen / (1.0 - fallen)).max(1.0)).min(bar) } else { bar }
                        }
                        None => with(OF_CHANGE),
                    }
                }
                (None, Some((own, of_ends))) => OF_DIFFERENCE * own + of_ends,
                (None, None) => (OF_SINGLE * seen(last, k)).max(quantity.weighted.map_or(0.0, |[sum, _]| sum)),
            };
            [if is_pressure { enriched } else { value }, uncertainty]
        };
        let values = last.quantities.iter().enumerate().map(of).collect();
        // soft springs let bodies move far, and their matrices round with that
        let of_springs = entries.iter().zip(&last.quantities).find(|(entry, _)| entry.of == Of::Springs);
        let springs = of_springs.map_or(0.0, |(_, energy)| energy.value.max(0.0));
        let sizes = sizes(scene, (last.scale * last.scale + 2.0 * springs).sqrt());
        let coulomb = scene.contacts().any(|(_, contact)| contact.friction.coefficient().is_some());
        let is_plain = last.doubts.is_empty() && last.relative > ENERGY_ROUNDED && !coulomb;
        let of_energy = is_plain.then(|| OF_WEIGHTED * weighted_energy(last));
        let oscillation: f64 = last.indicators.iter().chain(&last.of_cuts).map(|bubble| bubble.oscillation).sum();
        let of_gaps = has_contact && last.relative > ROUNDOFF && oscillation > UNRESOLVED * last.error * last.error;
        let doubts = if of_gaps { vec![Doubt::Data] } else { Vec::new() };
        let mut all = Self { entries, values, sizes, of_energy, doubts, rounded: ROUNDED, ..Self::default() };
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
        over: &OverOutcomes,
    ) -> Self {
        let mean = &over.quantities;
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
        let mut all = Self::new(scene, reactions, &[before, &[&last]].concat());
        // outcomes tell the largest pressure of their nodes
        for ((entry, [_, uncertainty]), mean) in all.entries.iter().zip(&mut all.values).zip(mean) {
            *uncertainty += if entry.of == Of::Peak(None) { (over.peak - mean.enriched).abs() } else { 0.0 };
        }
        all
    }

    /// The values of a solution on a grid.
    pub(crate) fn on_grid(scene: &Scene, solved: &GridSolved) -> Self {
        let (quantities, mut entries) = (solved.quantities(scene), entries(scene, &solved.reactions));
        add_works(scene, &mut entries);
        entries.retain(|entry| entry.of != Of::Friction || knows_friction_work(scene));
        if has_jump_work(scene) {
            add_work(&mut entries, Of::Reactions, "reaction_work");
        }
        if quantities.len() != entries.len() {
            return Self::default();
        }
        let estimate = solved.estimate.as_ref();
        let of = |own: &GridQuantity| [own.fine_grid, own.multiscale, own.medium].map(|part| OF_DIFFERENCE * part);
        let parts: Vec<[f64; 3]> = quantities.iter().map(of).collect();
        let values = quantities.iter().zip(&parts).map(|(own, parts)| [own.value, parts.iter().sum()]).collect();
        let scale = (2.0 * solved.energies.strain).max(0.0).sqrt();
        let coulomb = scene.contacts().any(|(_, contact)| contact.friction.coefficient().is_some());
        let error = estimate.map_or(0.0, |estimate| estimate.error);
        let friction = solved.energies.friction_work;
        let parts_of_energy = solved.energy(scene).map(|energy| {
            // what the estimate sees of loads that cells do not resolve as well
            let fine =
                estimate.filter(|_| scene.method.indicator == Indicator::Bubble).map_or(0.0, |own| own.fine_grid / 2.0);
            // J is not stationary under Coulomb's law
            let bounds = if coulomb { NOT_STATIONARY * error * (2.0 * friction).sqrt() } else { 0.0 };
            [energy.fine_grid.max(fine) + bounds, energy.multiscale, energy.medium].map(|part| OF_DIFFERENCE * part)
        });
        let mut at_jumps = solved.at_jumps(&scene.probe);
        at_jumps.extend((0..scene.probe.len()).filter(|&k| is_in_contact(scene, scene.probe[k])));
        at_jumps.extend(solved.beside_medium(&scene.probe));
        let near_singular = solved.near_singular(&scene.probe, &singular_points(scene, solved.trace().mesh, &[]));
        let rounded = solved.digits().max(ROUNDED);
        let mut doubts = doubts_of_contact(scene, solved, error);
        // else the estimate has it
        doubts.extend((estimate.is_none() && solved.crosses()).then_some(Doubt::Contrast));
        doubts.extend(solved.has_coarse_medium().then_some(Doubt::Coarse));
        let mut all = Self {
            entries,
            values,
            sizes: sizes(scene, scale),
            of_energy: None,
            doubts,
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
        let parts = |of: &dyn Fn(&Self) -> [f64; 3]| [0, 1, 2].map(|part| mean(&|own| of(own)[part]));
        let value = |k: usize| [0, 1].map(|i| mean(&|own| own.values[k][i]));
        all.values = (0..all.values.len()).map(value).collect();
        all.parts = (0..all.parts.len()).map(|k| parts(&|own| own.parts[k])).collect();
        let known = of_outcomes.iter().all(|own| own.parts_of_energy.is_some());
        all.parts_of_energy = known.then(|| parts(&|own| own.parts_of_energy.unwrap_or_default()));
        all.at_jumps = of_outcomes.iter().flat_map(|own| own.at_jumps.clone()).collect();
        all.near_singular = of_outcomes.iter().flat_map(|own| own.near_singular.clone()).collect();
        Some(all)
    }

    /// Rounding errors of a value.
    pub(crate) fn rounding(&self, k: usize) -> f64 {
        let own = self.entries[k].kind;
        let of_kind = self.entries.iter().zip(&self.values).filter(|(entry, _)| entry.kind == own);
        let sizes = of_kind.map(|(_, [value, _])| value.abs());
        self.rounded * sizes.filter(|size| size.is_finite()).fold(self.sizes[own as usize], f64::max)
    }

    /// Whether the largest von Mises stress is known.
    pub(crate) fn know_largest_stress(&self) -> bool {
        let mut all = self.entries.iter().zip(&self.values);
        all.any(|(entry, [value, _])| entry.of == Of::LargestStress && value.is_finite())
    }

    /// Gives the named quantities their values, which are those of the enriched spaces for some of them.
    pub(crate) fn tell(&self, named: &mut [f64]) {
        let own = self.entries.iter().zip(&self.values).filter(|(entry, _)| matches!(entry.of, Of::Named(_)));
        named.iter_mut().zip(own).for_each(|(told, (_, [value, _]))| *told = *value);
    }
}

/// Whether a point is on a side in contact.
fn is_in_contact(scene: &Scene, x: [f64; 2]) -> bool {
    let outline = &scene.problem.outline;
    match outline.contains(x) {
        Location::Boundary { edge, .. } => scene.contact(outline.edges()[edge].side).is_some(),
        _ => false,
    }
}

/// Displacement, stress, force, moment and energy of a solution with this energy norm.
fn sizes(scene: &Scene, norm: f64) -> [f64; 5] {
    // energy² E = force², energy² / E = length²
    let modulus = scene.problem.bodies.iter().map(|body| body.material().young).fold(0.0, f64::max);
    let (force, diameter) = (norm * modulus.sqrt(), scene.problem.outline.diameter());
    [force / modulus, force / diameter, force, force * diameter, norm * norm]
}

/// Σ |η_e| of J, whose dual solution is u itself: the residuals of displacement and traction have opposite signs.
fn weighted_energy(estimate: &Estimate) -> f64 {
    let of = |bubble: &Bubble| 0.5 * ((bubble.displacement - bubble.traction).abs() + bubble.oscillation);
    estimate.indicators.iter().chain(&estimate.of_cuts).map(of).sum()
}
