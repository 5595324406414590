//! The numbers of a scene on a grid as linear functionals J(u).

use std::collections::HashMap;

use steklov_bem_operators::{Enriched, Location};
use steklov_coupling::{MediumField, Radiation};
use steklov_elastic::principal;
use steklov_msfem::{HeterogeneousBody, Loads, bubble_values};
use steklov_problem::{Condition, QuantityKind, Scene};

use super::frozen_contact::{FrozenContact, conditions};
use super::in_medium::InMedium;
use super::solution::GridSolved;
use super::solve_coarse::weights_at;
use super::trace::GridTrace;
use crate::answer::probes::slopes;
use crate::data::supports::Held;
use crate::quantities::{self, peaks};
use crate::solve::medium::Around;

/// The part of the second difference of pressures by which their peak may be off between nodes: 1/8 for its place, 1/12 for the mean.
const OF_BEND: f64 = 0.25;

/// A linear functional J, as the load of its dual problem.
pub(super) struct GridFunctional<'a> {
    /// J(u) as it is told, NaN of a part of a number.
    pub value: f64,
    /// -j: the moments against the bilinear functions of cells.
    pub load: Loads,
    /// The same against the bubbles of a cell.
    pub of_cell: Option<(usize, [f64; 10])>,
    /// The same as a mean traction on sides of cells.
    pub traction: HashMap<(usize, usize), [f64; 2]>,
    /// The values of the functions of the medium's spaces of one more degree, displacements and tractions, where it is a number of the medium.
    pub outside: Option<[Enriched; 2]>,
    /// Side whose forces do work on w, and w.
    pub of_forces: Option<(usize, Weight<'a>)>,
}

/// A field at points.
pub(super) type Weight<'a> = Box<dyn Fn([f64; 2]) -> [f64; 2] + Sync + 'a>;

impl<'a> GridFunctional<'a> {
    pub fn of_load(value: f64, load: Loads) -> Self {
        Self { value, load, of_cell: None, traction: HashMap::new(), outside: None, of_forces: None }
    }

    pub fn of_forces(value: f64, side: usize, w: Weight<'a>) -> Self {
        Self { of_forces: Some((side, w)), ..Self::of_load(value, Loads::default()) }
    }

    /// -j at the fine nodes where it is not zero.
    pub fn nodal(&self, body: &HeterogeneousBody) -> HashMap<usize, [f64; 2]> {
        let mut nodal: HashMap<usize, [f64; 2]> = HashMap::new();
        for (&cell, load) in &self.load.boundary {
            for (node, load) in body.grid.cell_nodes(cell).into_iter().zip(load.chunks_exact(2)) {
                let sum = nodal.entry(node).or_default();
                (0..2).for_each(|k| sum[k] += load[k]);
            }
        }
        nodal
    }

    /// j·u of a field of the fine nodes.
    pub fn of(&self, body: &HeterogeneousBody, u: &[f64]) -> f64 {
        let of_cell = |(&cell, load): (&usize, &[f64; 8])| -> f64 {
            body.cell_values(u, cell).iter().zip(load).map(|(u, f)| -f * u).sum()
        };
        self.load.boundary.iter().map(of_cell).sum()
    }

    /// What is held in the dual problem, at the nodes of a boundary.
    pub fn held(&self, trace: &GridTrace, held: &[Held]) -> Vec<Held> {
        match &self.of_forces {
            Some((side, w)) => weights_at(trace, held, *side, w),
            None => weights_at(trace, held, usize::MAX, &|_| [0.0; 2]),
        }
    }
}

/// The functionals of the numbers of a scene, and those that are told: each is a sum of functionals with weights.
pub(super) struct GridFunctionals<'a> {
    pub functionals: Vec<GridFunctional<'a>>,
    pub numbers: Vec<Number>,
}

/// A number that is told.
pub(super) struct Number {
    pub value: f64,
    /// Its functionals with their weights.
    pub sum: Vec<(usize, f64)>,
    /// How far it is off where it is given.
    pub off: f64,
}

impl Number {
    fn new(value: f64, sum: Vec<(usize, f64)>) -> Self {
        Self { value, sum, off: 0.0 }
    }
}

impl<'a> GridFunctionals<'a> {
    /// Those of a solution, in the order of [`crate::bars::Bars`]: points, forces of supports, named numbers.
    pub fn new(
        scene: &'a Scene,
        solved: &GridSolved,
        fine: &GridTrace,
        (contact, medium): (&FrozenContact, Option<&InMedium>),
    ) -> Self {
        let mut this = Self { functionals: Vec::new(), numbers: Vec::new() };
        let outside = medium.map(InMedium::raised_field);
        let mean = medium.filter(|_| is_bounded(solved)).map(|_| this.add_mean_of_interface(scene, solved, fine));
        for &x in &scene.probe {
            let first = this.numbers.len();
            match (solved.body.grid.locate(x), &solved.around, &outside) {
                (None, Some(around), Some(field)) => this.add_point_of_medium(around, field, x),
                _ => this.add_point(&solved.body, &solved.displacement, x),
            }
            let lacking = solved.body.grid.locate(x).map_or([0.0; 2], |(cell, local)| contact.lacking_at(cell, local));
            for ((number, given), lacking) in this.numbers[first..].iter_mut().zip(given_at(scene, x)).zip(lacking) {
                number.off = given.map_or(0.0, |given| (number.value - given).abs()).max(lacking);
            }
            this.without_mean(first, mean);
        }
        for (force, side) in quantities::forces(scene, &solved.reactions) {
            let touches = scene.contact(side).is_some();
            for i in 0..2 {
                if touches || scene.problem.sides[side].holds(i) {
                    let w = [0, 1].map(|k| f64::from(u8::from(i == k)));
                    this.add(GridFunctional::of_forces(force[i], side, Box::new(move |_| w)));
                } else {
                    this.numbers.push(Number::new(force[i], Vec::new()));
                }
            }
        }
        let mut values = solved.named(scene, fine).into_iter();
        for quantity in &scene.quantities {
            let value = values.next().unwrap_or(f64::NAN);
            match quantity.kind {
                QuantityKind::MeanDisplacement(side) => {
                    let first = this.numbers.len();
                    let means = this.means(solved, fine, |e| fine.mesh.side[e] == side);
                    for (value, functional) in [value, values.next().unwrap_or(f64::NAN)].into_iter().zip(means) {
                        this.add(GridFunctional { value, ..functional });
                    }
                    this.without_mean(first, mean);
                }
                _ => match quantity.kind.weighted_side() {
                    Some((side, w)) => this.add(GridFunctional::of_forces(value, side, Box::new(w))),
                    None => this.numbers.push(Number::new(value, Vec::new())),
                },
            }
        }
        if !peaks(scene).is_empty() && this.add_peak(solved).is_none() {
            this.numbers.push(Number::new(f64::NAN, Vec::new()));
        }
        this.add_works(scene, solved, contact);
        if let Some(medium) = medium {
            this.add_jump_work(scene, solved, medium);
        }
        this
    }

    /// The largest pressure: the mean of the pressure about its node, with the hat function as weight.
    fn add_peak(&mut self, solved: &GridSolved) -> Option<()> {
        let mesh = &solved.trace.mesh;
        let contact = solved.contact.as_ref()?;
        let (conditions, multipliers) = (conditions(&contact.boundary), &contact.reported().multipliers);
        let peak = (0..conditions.len()).max_by(|&a, &b| multipliers[a][0].total_cmp(&multipliers[b][0]))?;
        let (node, condition) = conditions[peak];
        let weight: f64 = condition.shares.iter().map(|share| share.normal).sum();
        let side = condition.shares.first()?.side;
        let pressure = multipliers[peak][0];
        let beside = |other: usize| {
            let own = conditions.iter().position(|(at, c)| *at == other && c.normal == condition.normal);
            own.map(|k| multipliers[k][0])
        };
        // the pressure bends between the nodes
        let bend = match [mesh.previous()[node], mesh.next[node]].map(beside) {
            [Some(a), Some(b)] => (a - 2.0 * pressure + b).abs(),
            [Some(a), None] | [None, Some(a)] => (a - pressure).abs(),
            [None, None] => f64::NAN,
        };
        let (at, normal) = (mesh.vertices[node], condition.normal);
        let along = usize::from(normal[1] == 0.0);
        let reach = [mesh.previous()[node], mesh.next[node]].map(|other| mesh.vertices[other][along] - at[along]);
        let hat = move |x: [f64; 2]| {
            let off = x[along] - at[along];
            let reach = reach.into_iter().find(|reach| reach * off > 0.0).unwrap_or(1.0);
            let height = (1.0 - off / reach).max(0.0) / weight;
            normal.map(|n| -height * n)
        };
        self.add(GridFunctional::of_forces(pressure, side, Box::new(hat)));
        if let Some(number) = self.numbers.last_mut() {
            number.off = OF_BEND * bend;
        }
        Some(())
    }

    /// Adds a number that is one functional.
    pub fn add(&mut self, functional: GridFunctional<'a>) {
        self.numbers.push(Number::new(functional.value, vec![(self.functionals.len(), 1.0)]));
        self.functionals.push(functional);
    }

    /// The mean displacement of sides of fine cells.
    fn means(&self, solved: &GridSolved, fine: &GridTrace, is_own: impl Fn(usize) -> bool) -> [GridFunctional<'a>; 2] {
        let mesh = &fine.mesh;
        let elements: Vec<usize> = (0..mesh.len()).filter(|&e| is_own(e)).collect();
        let length: f64 = elements.iter().map(|&e| mesh.length(e)).sum();
        [0, 1].map(|k| {
            let mut functional = GridFunctional::of_load(f64::NAN, Loads::default());
            let mut traction = [0.0; 2];
            traction[k] = -1.0 / length;
            for &e in &elements {
                let (cell, number) = fine.cell(&solved.body.grid, e);
                functional.load.add_side(cell, number, [traction.map(|t| t * mesh.length(e) / 2.0); 2]);
                functional.traction.insert((cell, number), traction);
            }
            functional
        })
    }

    /// Adds the mean displacement of the interface to the functionals: the numbers of the first component and of the second.
    fn add_mean_of_interface(&mut self, scene: &Scene, solved: &GridSolved, fine: &GridTrace) -> usize {
        let edges = scene.problem.outline.edges();
        let means = self.means(solved, fine, |e| edges[fine.mesh.edge[e]].loop_index == 0);
        self.functionals.extend(means);
        self.functionals.len() - 2
    }

    /// Where the displacement is bounded at infinity, those from the number `first` on, which are two components, are without the mean of the
    /// interface.
    fn without_mean(&mut self, first: usize, mean: Option<usize>) {
        let Some(mean) = mean else { return };
        for k in 0..2 {
            self.numbers[first + k].sum.push((mean + k, -1.0));
        }
    }

    /// Displacement, stress and its invariants at a point.
    fn add_point(&mut self, body: &HeterogeneousBody, u: &[f64], x: [f64; 2]) {
        let first = self.functionals.len();
        let Some((cell, local)) = body.grid.locate(x) else { unreachable!("points are in the body") };
        let of_bubbles = bubble_values(body, cell, local);
        let unit = |a: usize| std::array::from_fn(|b| f64::from(u8::from(a == b)));
        let at = |values: &[f64; 8]| {
            let [x, y] = local;
            let hats = [(1.0 - x) * (1.0 - y), x * (1.0 - y), x * y, (1.0 - x) * y];
            let sum = |k: usize| (0..4).map(|node| hats[node] * values[2 * node + k]).sum::<f64>();
            let [xx, yy, xy] = body.stress(cell, values, local);
            [sum(0), sum(1), xx, yy, xy]
        };
        let values = at(&body.cell_values(u, cell));
        let of_nodes: [[f64; 5]; 8] = std::array::from_fn(|a| at(&unit(a)));
        for k in 0..5 {
            let mut load = Loads::default();
            load.boundary.insert(cell, of_nodes.map(|values| -values[k]));
            let of_cell = Some((cell, of_bubbles.map(|values| -values[k])));
            self.add(GridFunctional { of_cell, ..GridFunctional::of_load(values[k], load) });
        }
        let elasticity = body.elasticity_of(cell);
        self.add_invariants(first, values, |stress| elasticity.von_mises(stress));
    }

    /// The same at a point of the medium around the body.
    fn add_point_of_medium(&mut self, around: &Around, field: &MediumField, x: [f64; 2]) {
        let first = self.functionals.len();
        let ([ux, uy], [xx, yy, xy]) = around.at(x);
        let values = [ux, uy, xx, yy, xy];
        for (value, functional) in values.into_iter().zip(field.functionals_at(x)) {
            let of_body = GridFunctional::of_load(value, Loads::default());
            self.add(GridFunctional { outside: Some(functional.enriched(&around.space)), ..of_body });
        }
        self.add_invariants(first, values, |stress| around.material.von_mises(stress));
    }

    /// The invariants of a stress whose components are functionals behind the first two of a point.
    fn add_invariants(&mut self, first: usize, values: [f64; 5], von_mises: impl Fn([f64; 3]) -> f64) {
        let [_, _, stress @ ..] = values;
        let invariants = |stress: [f64; 3]| {
            let [larger, smaller] = principal(stress);
            [von_mises(stress), larger, smaller]
        };
        for (invariant, slopes) in invariants(stress).into_iter().zip(slopes(stress, invariants)) {
            self.numbers.push(Number::new(invariant, (0..3).map(|k| (first + 2 + k, slopes[k])).collect()));
        }
    }
}

/// The numbers of a point of the body in the order of [`GridFunctionals`] for a field of the fine nodes.
pub(super) fn at_point(body: &HeterogeneousBody, u: &[f64], x: [f64; 2]) -> Option<[f64; 8]> {
    let ((cell, _), ([ux, uy], stress)) = (body.grid.locate(x)?, body.at(u, x)?);
    let ([larger, smaller], [xx, yy, xy]) = (principal(stress), stress);
    Some([ux, uy, xx, yy, xy, body.elasticity_of(cell).von_mises(stress), larger, smaller])
}

/// Whether the solution is one that is bounded at infinity, whose mean on the interface is 0.
fn is_bounded(solved: &GridSolved) -> bool {
    solved.around.as_ref().is_some_and(|around| around.radiation == Radiation::Bounded)
}

/// The displacements that a support gives a point.
fn given_at(scene: &Scene, [x, y]: [f64; 2]) -> [Option<f64>; 2] {
    let Location::Boundary { edge, s } = scene.problem.outline.contains([x, y]) else { return [None; 2] };
    let own = &scene.problem.outline.edges()[edge];
    match &scene.problem.sides[own.side].condition {
        Condition::Displacement { values, .. } => {
            values.each_ref().map(|value| value.as_ref().map(|value| value.eval(x, y, own.drawn_fraction(s))))
        }
        _ => [None; 2],
    }
}
