//! Error bars of numbers on a grid, by dual weighted residuals: that of the fine grid and that of the coarse cells apart.
//!
//! ```text
//! number              J(u) = j·u,  or Σ w·(K u - f) over the nodes of a support: the work of its forces on a field w
//! dual solution       K z = -j where nothing is held,  z = w at the support and 0 where else something holds the body
//! coarse cells        J(u_h) - J(u_H) = -ρ_z·c,  ρ_z = -j - K z,  c = u_h - u_H by conjugate gradients from the residual of u_H
//! fine grid           J(u) - J(u_h) ≈ Σ_T η_T of the bubbles of each fine cell, see `steklov_msfem::bubble_weighted_residuals`
//! ```
//! The difference of a number is max(|Σ η|, ½ Σ |η|), as sums cross zero by accident.
//!
//! *Fails when* the moduli differ by more than the estimate bears (doubt `contrast`), beside singular points, and where displacements
//! lock. *Cost*: a solution with the factor of K for each number, and its residuals.
//!
//! Source: Becker and Rannacher (2001), section 3.

use std::borrow::Cow;
use std::collections::HashMap;

use steklov_bem_operators::Space;
use steklov_elastic::principal;
use steklov_msfem::{
    Basis, BubbleResidual, CoarseMesh, Extra, HeterogeneousBody, Loads, MsfemError, Multiscale, bubble_values,
    bubble_weighted_residuals, fine_correction,
};
use steklov_problem::steklov_expression::Expression;
use steklov_problem::{Condition, Scene};

use super::solution::GridSolved;
use super::solve::{Acting, lift};
use super::system::Answer;
use super::trace::GridTrace;
use crate::answer::probes::slopes;
use crate::data::supports::{Held, Supports};
use crate::quantities;

/// The part of Σ |η_T| that a difference has at least.
const OF_WEIGHTED: f64 = 0.5;
/// Gain of energy at which u_h is near enough.
const ENOUGH: f64 = 1e-3;

/// A number on a grid, and how far the exact one may be by the parts of the error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridQuantity {
    /// J(u_h), or J(u_H) of coarse cells.
    pub value: f64,
    /// The difference to the exact solution that the fine grid makes.
    pub fine_grid: f64,
    /// The difference to the solution on the fine grid that coarse cells make; 0 without any.
    pub multiscale: f64,
}

/// A linear functional J, as the load of its dual problem.
#[derive(Debug, Clone, Default)]
pub(super) struct GridFunctional {
    /// J(u) as it is told.
    value: f64,
    /// -j: the moments against the bilinear functions of cells.
    pub load: Loads,
    /// The same against the bubbles of a cell.
    of_cell: Option<(usize, [f64; 10])>,
    /// Side whose forces do work on w, and w.
    pub of_forces: Option<(usize, [f64; 2])>,
}

/// The functionals of the numbers of a scene, and those that are told: each is a sum of functionals with weights.
pub(super) struct GridFunctionals {
    pub functionals: Vec<GridFunctional>,
    numbers: Vec<Number>,
}

/// A number that is told.
struct Number {
    value: f64,
    /// Its functionals with their weights.
    sum: Vec<(usize, f64)>,
}

/// The numbers of a scene and the solutions of their dual problems on the fine nodes.
pub(super) struct Duals {
    functionals: GridFunctionals,
    solutions: Vec<Vec<f64>>,
}

impl Duals {
    /// Those of a solution of bilinear elements on all cells; none where no error bars are known.
    pub fn on_fine(
        scene: &Scene,
        body: &HeterogeneousBody,
        answer: &Answer,
        (space, held): (&Space, &[Held]),
    ) -> Option<Self> {
        let known = are_known(scene) && answer.free_motions.is_empty();
        let functionals = known.then(|| GridFunctionals::new(scene, body, &answer.displacement, &answer.reactions))?;
        let loads: Vec<Vec<f64>> = functionals.functionals.iter().map(|f| f.load.nodal(body)).collect();
        let values = |f: &GridFunctional| Supports { space, held: &f.held(held) }.values();
        let values: Vec<Vec<f64>> = functionals.functionals.iter().map(values).collect();
        let solutions = answer.elimination.fields(&loads, &values);
        Some(Self { functionals, solutions })
    }

    /// Those of a solution of coarse cells; `fine` and `trace` are the boundaries of the fine and the coarse grid.
    ///
    /// # Errors
    /// Those of bases.
    pub fn on_coarse(
        scene: &Scene,
        problem: &Multiscale<'_>,
        (answer, displacement): (&Answer, &[f64]),
        [(fine, fine_held), (trace, held)]: [(&GridTrace, &[Held]); 2],
    ) -> Result<Option<Self>, MsfemError> {
        if !(are_known(scene) && answer.free_motions.is_empty() && problem.basis.is_conforming()) {
            return Ok(None);
        }
        let functionals = GridFunctionals::new(scene, problem.body, displacement, &answer.reactions);
        let (mut loads, mut values, mut extras) = (Vec::new(), Vec::new(), Vec::new());
        for functional in &functionals.functionals {
            let (own, own_fine) = (functional.held(held), functional.held(fine_held));
            let lift = lift(problem, fine, &own_fine, trace, &own);
            let extra = Extra { bubbles: problem.basis != Basis::Q1, lift };
            loads.push(problem.load(&functional.load, &extra)?);
            values.push(Supports { space: &trace.space, held: &own }.values());
            extras.push(extra);
        }
        let coarse = answer.elimination.fields(&loads, &values);
        let fields = coarse.iter().zip(&extras).zip(&functionals.functionals);
        let fine = |((coarse, extra), functional): ((&Vec<f64>, &Extra), &GridFunctional)| {
            problem.downscale(coarse, &functional.load, extra, &mut |_| true)
        };
        let solutions = fields.map(fine).collect::<Result<_, _>>()?;
        Ok(Some(Self { functionals, solutions }))
    }
}

/// Whether error bars of numbers are known: without contact, a medium and random input.
fn are_known(scene: &Scene) -> bool {
    scene.random.is_none() && scene.surroundings().is_none() && scene.contacts().next().is_none()
}

impl GridFunctional {
    /// What is held in the dual problem, at the nodes of a boundary.
    pub fn held(&self, held: &[Held]) -> Vec<Held> {
        let value = |k: usize, side: usize| match self.of_forces {
            Some((own, w)) if own == side => (w[k], side),
            _ => (0.0, side),
        };
        let of_node = |h: &Held| Held { components: [0, 1].map(|k| h.components[k].map(|(_, side)| value(k, side))) };
        held.iter().map(of_node).collect()
    }
}

impl GridFunctionals {
    /// Those of a solution, in the order of [`quantities::Bars`]: points, then forces of supports.
    pub fn new(scene: &Scene, body: &HeterogeneousBody, u: &[f64], reactions: &[(String, [f64; 2])]) -> Self {
        let mut this = Self { functionals: Vec::new(), numbers: Vec::new() };
        for &x in &scene.probe {
            this.add_point(body, u, x);
        }
        for (force, side) in quantities::forces(scene, reactions) {
            for i in 0..2 {
                let w = [0, 1].map(|k| f64::from(u8::from(i == k)));
                this.numbers.push(Number { value: force[i], sum: vec![(this.functionals.len(), 1.0)] });
                let of_forces = Some((side, w));
                this.functionals.push(GridFunctional { value: force[i], of_forces, ..GridFunctional::default() });
            }
        }
        this
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
            self.functionals.push(GridFunctional { value: values[k], load, of_cell, of_forces: None });
        }
        self.numbers.extend((0..5).map(|k| Number { value: values[k], sum: vec![(first + k, 1.0)] }));
        let [_, _, stress @ ..] = values;
        let invariants = |stress: [f64; 3]| {
            let [larger, smaller] = principal(stress);
            [body.elasticity_of(cell).von_mises(stress), larger, smaller]
        };
        for (invariant, slopes) in invariants(stress).into_iter().zip(slopes(stress, invariants)) {
            self.numbers.push(Number { value: invariant, sum: (0..3).map(|k| (first + 2 + k, slopes[k])).collect() });
        }
    }
}

impl Duals {
    /// The numbers with their differences; `held` says which fine unknowns are held.
    pub fn quantities(&self, scene: &Scene, solved: &GridSolved, acting: &Acting, held: &[bool]) -> Vec<GridQuantity> {
        let (mut u, mut of_coarse) = (Cow::Borrowed(&solved.displacement), Vec::new());
        if let Some(coarse) = &solved.coarse {
            let (load, forces) = (acting.loads.nodal(&solved.body), solved.body.forces(&solved.displacement));
            let residual: Vec<f64> = load.iter().zip(&forces).map(|(f, ku)| f - ku).collect();
            let c = fine_correction(&solved.body, &residual, held, ENOUGH);
            of_coarse = self.of_coarse_cells(solved, &coarse.mesh, &residual, &c);
            u.to_mut().iter_mut().zip(&c).for_each(|(u, c)| *u += c);
        }
        let of_cells = self.of_fine_cells(scene, &solved.body, &u, acting);
        let number = |Number { value, sum }: &Number| GridQuantity {
            value: *value,
            fine_grid: difference(sum, &of_cells),
            multiscale: if of_coarse.is_empty() { 0.0 } else { difference(sum, &of_coarse) },
        };
        self.functionals.numbers.iter().map(number).collect()
    }

    /// η_T of each fine cell, for each functional; u is the solution on the fine grid.
    fn of_fine_cells(&self, scene: &Scene, body: &HeterogeneousBody, u: &[f64], acting: &Acting) -> Vec<Vec<f64>> {
        let Acting { loads, tractions, fine, .. } = acting;
        let given = |cell: usize, side: usize| tractions.get(&(cell, side)).copied().unwrap_or([Some(0.0); 2]);
        let free = |cell: usize, side: usize| given(cell, side).map(|t| t.map(|_| 0.0));
        let missed = missed(scene, body, fine);
        let held = |cell: usize, side: usize| missed.get(&(cell, side)).copied().unwrap_or_default();
        let not_more = |_: usize, _: usize| [0.0; 2];
        let primal = BubbleResidual { body_force: &loads.body, u, traction: &given, held: &held, of_cell: None };
        let duals: Vec<BubbleResidual<'_>> = (self.functionals.functionals.iter().zip(&self.solutions))
            .map(|(functional, z)| BubbleResidual {
                body_force: &[],
                u: z,
                traction: &free,
                held: &not_more,
                of_cell: functional.of_cell,
            })
            .collect();
        bubble_weighted_residuals(body, &primal, &duals)
    }

    /// J(u_h) - J(u_H) by coarse cells, for each functional: -ρ_z·c with c = u_h - u_H at the nodes of each, and last what J of the fine
    /// field differs from the number that is told. `residual` is f - K u_H.
    fn of_coarse_cells(&self, solved: &GridSolved, mesh: &CoarseMesh, residual: &[f64], c: &[f64]) -> Vec<Vec<f64>> {
        let body = &solved.body;
        let mut count = vec![0.0; body.grid.nodes()];
        mesh.cells.iter().flat_map(|cell| cell.fine_nodes(&body.grid)).for_each(|node| count[node] += 1.0);
        let of = |(functional, z): (&GridFunctional, &Vec<f64>)| {
            let (load, forces) = (functional.load.nodal(body), body.forces(z));
            let at = |node: usize| -> f64 {
                [2 * node, 2 * node + 1].map(|i| (forces[i] - load[i]) * c[i]).iter().sum::<f64>() / count[node]
            };
            let mut all: Vec<f64> = mesh.cells.iter().map(|cell| cell.fine_nodes(&body.grid).map(at).sum()).collect();
            let of_field: f64 = load.iter().zip(&solved.displacement).map(|(f, u)| -f * u).sum();
            let of_forces: f64 = z.iter().zip(residual).map(|(z, r)| -z * r).sum();
            all.push(of_field + of_forces - functional.value);
            all
        };
        self.functionals.functionals.iter().zip(&self.solutions).map(of).collect()
    }
}

/// max(|Σ η|, ½ Σ |η|) of a sum of functionals.
fn difference(sum: &[(usize, f64)], of_functionals: &[Vec<f64>]) -> f64 {
    let cells = sum.first().map_or(0, |&(k, _)| of_functionals[k].len());
    let eta = |c: usize| sum.iter().map(|&(k, weight)| weight * of_functionals[k][c]).sum::<f64>();
    let (whole, size) = (0..cells).map(eta).fold((0.0, 0.0), |(whole, size), eta| (whole + eta, size + eta.abs()));
    f64::max(whole.abs(), OF_WEIGHTED * size)
}

/// What prescribed displacements have at the middles of fine sides beyond the mean of their ends.
fn missed(scene: &Scene, body: &HeterogeneousBody, fine: &GridTrace) -> HashMap<(usize, usize), [f64; 2]> {
    let mesh = &fine.mesh;
    let mut missed = HashMap::new();
    for e in 0..mesh.len() {
        let Condition::Displacement { values, .. } = &scene.problem.sides[mesh.side[e]].condition else { continue };
        let of_component = |value: &Option<Expression>| {
            let Some(expression) = value.as_ref().filter(|value| value.constant().is_none()) else { return 0.0 };
            let at = |t: f64| {
                let [x, y] = mesh.point(e, t);
                expression.eval(x, y, mesh.arc_fraction(e, t))
            };
            at(0.0) - (at(-1.0) + at(1.0)) / 2.0
        };
        missed.insert(fine.cell(&body.grid, e), values.each_ref().map(of_component));
    }
    missed
}
