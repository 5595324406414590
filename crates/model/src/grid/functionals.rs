//! The numbers of a scene on a grid as linear functionals J(u).

use std::collections::HashMap;

use steklov_bem_operators::Location;
use steklov_elastic::principal;
use steklov_msfem::{HeterogeneousBody, Loads, bubble_values};
use steklov_problem::{Condition, QuantityKind, Scene};

use super::frozen_contact::{FrozenContact, conditions};
use super::solution::GridSolved;
use super::solve_coarse::weights_at;
use super::trace::GridTrace;
use crate::answer::probes::slopes;
use crate::data::supports::Held;
use crate::quantities::{self, peaks};

/// The part of the second difference of pressures by which their peak may be off between nodes: 1/8 for its place, 1/12 for the mean.
const OF_BEND: f64 = 0.25;

/// A linear functional J, as the load of its dual problem.
pub(super) struct GridFunctional<'a> {
    /// J(u) as it is told.
    pub value: f64,
    /// -j: the moments against the bilinear functions of cells.
    pub load: Loads,
    /// The same against the bubbles of a cell.
    pub of_cell: Option<(usize, [f64; 10])>,
    /// The same as a mean traction on sides of cells.
    pub traction: HashMap<(usize, usize), [f64; 2]>,
    /// Side whose forces do work on w, and w.
    pub of_forces: Option<(usize, Weight<'a>)>,
}

/// A field at points.
pub(super) type Weight<'a> = Box<dyn Fn([f64; 2]) -> [f64; 2] + Sync + 'a>;

impl<'a> GridFunctional<'a> {
    fn of_load(value: f64, load: Loads) -> Self {
        Self { value, load, of_cell: None, traction: HashMap::new(), of_forces: None }
    }

    fn of_forces(value: f64, side: usize, w: Weight<'a>) -> Self {
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
    pub fn new(scene: &'a Scene, solved: &GridSolved, fine: &GridTrace, contact: &FrozenContact) -> Self {
        let mut this = Self { functionals: Vec::new(), numbers: Vec::new() };
        for &x in &scene.probe {
            let first = this.numbers.len();
            this.add_point(&solved.body, &solved.displacement, x);
            let lacking = solved.body.grid.locate(x).map_or([0.0; 2], |(cell, local)| contact.lacking_at(cell, local));
            for ((number, given), lacking) in this.numbers[first..].iter_mut().zip(given_at(scene, x)).zip(lacking) {
                number.off = given.map_or(0.0, |given| (number.value - given).abs()).max(lacking);
            }
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
                    this.add_mean(solved, fine, side, [value, values.next().unwrap_or(f64::NAN)]);
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
    fn add(&mut self, functional: GridFunctional<'a>) {
        self.numbers.push(Number::new(functional.value, vec![(self.functionals.len(), 1.0)]));
        self.functionals.push(functional);
    }

    /// The mean displacement of a side.
    fn add_mean(&mut self, solved: &GridSolved, fine: &GridTrace, side: usize, value: [f64; 2]) {
        let mesh = &fine.mesh;
        let elements: Vec<usize> = (0..mesh.len()).filter(|&e| mesh.side[e] == side).collect();
        let length: f64 = elements.iter().map(|&e| mesh.length(e)).sum();
        for k in 0..2 {
            let mut functional = GridFunctional::of_load(value[k], Loads::default());
            let mut traction = [0.0; 2];
            traction[k] = -1.0 / length;
            for &e in &elements {
                let (cell, number) = fine.cell(&solved.body.grid, e);
                functional.load.add_side(cell, number, [traction.map(|t| t * mesh.length(e) / 2.0); 2]);
                functional.traction.insert((cell, number), traction);
            }
            self.add(functional);
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
        let [_, _, stress @ ..] = values;
        let invariants = |stress: [f64; 3]| {
            let [larger, smaller] = principal(stress);
            [body.elasticity_of(cell).von_mises(stress), larger, smaller]
        };
        for (invariant, slopes) in invariants(stress).into_iter().zip(slopes(stress, invariants)) {
            self.numbers.push(Number::new(invariant, (0..3).map(|k| (first + 2 + k, slopes[k])).collect()));
        }
    }
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
