//! Error bars of numbers on a grid, by dual weighted residuals: that of the fine grid and that of the coarse cells apart.
//!
//! ```text
//! number              J(u) = j·u,  or Σ w·(K u - f) over the nodes of a support: the work of its forces on a field w
//! dual solution       K z = -j where nothing is held,  z = w at the support and 0 where else something holds the body
//! contact             held where its sets hold u_h, see `frozen_contact.rs`; ½ of what an end changes that moves by a node
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
use std::sync::{Mutex, PoisonError};

use steklov_elastic::plane::dot;
use steklov_msfem::{
    Basis, BubbleDual, BubbleResidual, CoarseCell, HeterogeneousBody, bubble_energies, bubble_weighted_residuals,
    fine_correction,
};
use steklov_problem::steklov_expression::Expression;
use steklov_problem::{Condition, Scene};

use super::dual_solutions::{Equations, Factors, Solutions, solutions};
use super::frozen_contact::FrozenContact;
use super::functionals::{GridFunctional, GridFunctionals, Number, Weight, at_point};
use super::in_medium::MediumPart;
use super::loads::Tractions;
use super::solution::{CoarseSolved, GridSolved};
use super::solve::Acting;
use super::trace::GridTrace;
use crate::error::SolveError;

/// The part of Σ |η_T| that a difference has at least.
const OF_WEIGHTED: f64 = 0.5;
/// The part of what an end changes that moves by a whole node: it is nearer to where the sets have it.
pub(super) const OF_NODE: f64 = 0.5;
/// Gain of energy at which u_h is near enough, and the same from a field that does not conform, whose error is not of the edges alone.
const ENOUGH: f64 = 3e-2;
const ENOUGH_OF_ROUGH: f64 = 1e-6;

/// A number on a grid, and how far the exact one may be by the parts of the error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridQuantity {
    /// J(u_h), or J(u_H) of coarse cells.
    pub value: f64,
    /// The difference to the exact solution that the fine grid makes.
    pub fine_grid: f64,
    /// The difference to the solution on the fine grid that coarse cells make; 0 without any.
    pub multiscale: f64,
    /// The difference that the boundary elements of a medium make; 0 without one.
    pub medium: f64,
}

/// What the dual problems of a solution take from it.
pub(crate) struct DualData {
    /// What acts on the grid.
    pub acting: Acting,
    /// Which fine unknowns are held.
    pub is_held: Vec<bool>,
    pub factors: Factors,
}

impl GridSolved {
    /// The numbers of the scene with the parts of their errors, in the order of the error bars; none where they are not known:
    /// of a body that can move as a whole, of bases that do not conform with contact, and once a next step has begun.
    ///
    /// *Cost*: at the first call a solution with the factor for each number, and one of the fine grid by conjugate gradients.
    pub fn quantities(&self, scene: &Scene) -> &[GridQuantity] {
        &self.numbers(scene).0
    }

    /// J with the parts of its error, where the error bars of the other numbers are known.
    pub fn energy(&self, scene: &Scene) -> Option<GridQuantity> {
        self.numbers(scene).1
    }

    fn numbers(&self, scene: &Scene) -> &(Vec<GridQuantity>, Option<GridQuantity>) {
        let found = || {
            let data = self.dual_data.lock().unwrap_or_else(PoisonError::into_inner).take()?;
            // contact holds nodes where a basis that does not conform has two displacements
            let known = self.contact.is_none() || self.coarse.as_ref().is_none_or(|own| own.basis.is_conforming());
            let known = known && self.free_motions.is_empty() && self.converged();
            // what the moduli do not allow has no error bars
            known.then(|| Duals::new(scene, self, data).ok())?
        };
        self.quantities.get_or_init(|| found().map_or((Vec::new(), None), |duals| duals.quantities(scene, self)))
    }

    /// Frees what [`Self::quantities`] needs.
    pub(super) fn without_duals(&mut self) {
        self.dual_data = Mutex::new(None);
    }
}

/// The numbers of a scene and the solutions of their dual problems on the fine nodes.
struct Duals<'a> {
    functionals: GridFunctionals<'a>,
    solutions: Vec<Vec<f64>>,
    /// How the functionals change where an end of contact or stick moves, by ends and sides, and J.
    of_ends: Vec<Vec<[f64; 2]>>,
    energy_of_ends: f64,
    acting: Acting,
    is_held: Vec<bool>,
    contact: FrozenContact,
    medium: Option<MediumPart>,
}

impl<'a> Duals<'a> {
    fn new(scene: &'a Scene, solved: &GridSolved, data: DualData) -> Result<Self, SolveError> {
        let DualData { acting, mut is_held, factors } = data;
        let (sets, medium) = match &factors.equations {
            Equations::Supported(own) => (own.contact.as_ref().map(|condensed| &condensed.factors.sets), None),
            Equations::InMedium(medium) => (None, Some(&**medium)),
        };
        let mut contact = FrozenContact::new(scene, solved, sets);
        if let (Some(_), Equations::Supported(own)) = (rough(solved), &factors.equations) {
            contact.held.extend(own.held_unknowns(&acting.fine, solved));
        }
        let functionals = GridFunctionals::new(scene, solved, &acting.fine, (&contact, medium));
        contact.held.keys().for_each(|&unknown| is_held[unknown] = true);
        let Solutions { solutions, of_ends, energy_of_ends, medium } =
            solutions(&functionals.functionals, (scene, solved), &acting, factors)?;
        Ok(Self { functionals, solutions, of_ends, energy_of_ends, acting, is_held, contact, medium })
    }
}

/// The coarse cells of a solution whose basis does not conform.
pub(super) fn rough(solved: &GridSolved) -> Option<&CoarseSolved> {
    solved.coarse.as_ref().filter(|coarse| !coarse.basis.is_conforming())
}

impl Duals<'_> {
    /// The numbers with their differences, and J.
    fn quantities(&self, scene: &Scene, solved: &GridSolved) -> (Vec<GridQuantity>, Option<GridQuantity>) {
        let (mut u, mut of_coarse) = (Cow::Borrowed(&solved.displacement), Vec::new());
        let mut energy = GridQuantity { value: solved.energies.total, fine_grid: 0.0, multiscale: 0.0, medium: 0.0 };
        if let Some(coarse) = &solved.coarse {
            let (residual, with_shear) = self.residuals(solved);
            let resist =
                self.medium.as_ref().map_or(Vec::new(), |medium| medium.resistance(&solved.body, &coarse.mesh));
            let enough = if rough(solved).is_some() { ENOUGH_OF_ROUGH } else { ENOUGH };
            let c = self.correction(&solved.body, &with_shear, &resist, enough);
            of_coarse = match rough(solved) {
                Some(_) => self.of_rough_cells(solved, &residual, &c),
                None => self.of_coarse_cells(solved, coarse, &residual, &c),
            };
            // J(u_H) - J(u_h) = r·c - ½ a(c, c)
            let work: f64 = with_shear.iter().zip(&c).map(|(r, c)| r * c).sum();
            let of_medium: f64 = resist.iter().zip(&c).map(|(d, c)| d * c * c).sum();
            let strain = solved.body.energy(&c, &c) + of_medium;
            // cells apart have another energy than the field that is told
            let apart = rough(solved).map_or(0.0, |_| energy.value - self.energy_of_field(solved));
            energy.multiscale = (apart + work - strain / 2.0).abs() + self.energy_of_ends;
            u.to_mut().iter_mut().zip(&c).for_each(|(u, c)| *u += c);
        }
        let (of_cells, of_energy) = self.of_fine_cells(scene, &solved.body, &u);
        energy.fine_grid = difference(&[(0, 1.0)], &of_energy, 1);
        energy.fine_grid += if solved.coarse.is_none() { self.energy_of_ends } else { 0.0 };
        let count = self.solutions.len();
        let of_loads = self.of_loads(&solved.body);
        let of_elements = self.medium.as_ref().map_or(Vec::new(), MediumPart::of_elements);
        if let Some(medium) = &self.medium {
            energy.medium = difference(&[(0, 1.0)], &medium.of_energy, 1);
        }
        let number = |Number { value, sum, off }: &Number| {
            let mut own = GridQuantity {
                value: *value,
                fine_grid: difference(sum, &of_cells, count).max(*off)
                    + sum.iter().map(|&(k, weight)| weight.abs() * of_loads[k]).sum::<f64>(),
                multiscale: difference(sum, &of_coarse, count),
                medium: difference(sum, &of_elements, count),
            };
            // ends lie between the nodes of contact
            let part = if solved.coarse.is_some() { &mut own.multiscale } else { &mut own.fine_grid };
            *part += self.of_moved_ends(sum);
            own
        };
        let mut numbers: Vec<GridQuantity> = self.functionals.numbers.iter().map(number).collect();
        if rough(solved).is_some() {
            // invariants of stresses are not linear in what cells do not tell
            let at = |x: &[f64; 2]| at_point(&solved.body, &u, *x).unwrap_or([f64::NAN; 8]);
            for (own, exact) in numbers.iter_mut().zip(scene.probe.iter().flat_map(at)) {
                own.multiscale = (exact - own.value).abs();
            }
        }
        (numbers, Some(energy))
    }

    /// ½ a(u, u) - f·u of the displacement of the fine nodes.
    fn energy_of_field(&self, solved: &GridSolved) -> f64 {
        let (body, u) = (&solved.body, &solved.displacement);
        let work: f64 = self.acting.loads.nodal(body).iter().zip(u).map(|(f, u)| f * u).sum();
        body.energy(u, u) / 2.0 - work
    }

    /// f - K u_H with the tractions of the medium and the shear that is given, and with that which follows the pressure.
    fn residuals(&self, solved: &GridSolved) -> (Vec<f64>, Vec<f64>) {
        let (load, forces) = (self.acting.loads.nodal(&solved.body), solved.body.forces(&solved.displacement));
        let mut residual: Vec<f64> = load.iter().zip(&forces).map(|(f, ku)| f - ku).collect();
        if let Some(medium) = &self.medium {
            medium.sides.add(&medium.moments, &mut residual);
        }
        let add_shear = |residual: &mut Vec<f64>, follows: bool| {
            for own in self.contact.shear.iter().filter(|own| own.follows == follows) {
                (0..2).for_each(|k| residual[2 * own.node + k] += own.force[k]);
            }
        };
        add_shear(&mut residual, false);
        let mut with_shear = residual.clone();
        add_shear(&mut with_shear, true);
        (residual, with_shear)
    }

    /// The change of a sum of functionals where the ends of contact and stick move, over all of them.
    fn of_moved_ends(&self, sum: &[(usize, f64)]) -> f64 {
        let ends = self.of_ends.first().map_or(0, Vec::len);
        let of = |end: usize, k: usize| -> f64 { sum.iter().map(|&(of, by)| by * self.of_ends[of][end][k]).sum() };
        OF_NODE * (0..ends).map(|end| of(end, 0).abs().max(of(end, 1).abs())).sum::<f64>()
    }

    /// u_h - u_H from the residual f - K u_H, with the gap where contact holds u_h, and the resistance of a medium.
    fn correction(&self, body: &HeterogeneousBody, residual: &[f64], resist: &[f64], enough: f64) -> Vec<f64> {
        let mut c = vec![0.0; residual.len()];
        self.contact.held.iter().for_each(|(&unknown, &lacks)| c[unknown] = lacks);
        let of_gap = if self.contact.held.is_empty() { c.clone() } else { body.forces(&c) };
        let rest: Vec<f64> = residual.iter().zip(of_gap).map(|(r, f)| r - f).collect();
        let free = fine_correction(body, &rest, &self.is_held, resist, enough);
        c.iter_mut().zip(free).for_each(|(c, free)| *c += free);
        c
    }

    /// The work of what is uncertain in body forces on each dual solution, at most.
    fn of_loads(&self, body: &HeterogeneousBody) -> Vec<f64> {
        let largest = |cell: usize, z: &[f64]| body.cell_values(z, cell).iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let of = |z: &Vec<f64>| self.acting.uncertain.iter().map(|&(cell, force)| force * largest(cell, z)).sum();
        self.solutions.iter().map(of).collect()
    }

    /// η_T of the functionals in each fine cell, one cell after the other, and the changes of J; u is the solution on the fine grid.
    fn of_fine_cells(&self, scene: &Scene, body: &HeterogeneousBody, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let Acting { loads, tractions, fine, .. } = &self.acting;
        let contact = &self.contact;
        let given = |cell: usize, side: usize| {
            let own = contact.tractions.get(&(cell, side)).or(tractions.get(&(cell, side)));
            own.copied().unwrap_or([Some(0.0); 2])
        };
        let mut missed = missed(scene, body, fine);
        missed.extend(&contact.missed);
        let held = |cell: usize, side: usize| missed.get(&(cell, side)).copied().unwrap_or_default();
        let of_medium: Tractions = match &self.medium {
            Some(medium) => medium.sides.tractions(body, u, &medium.moments, |(cell, side)| given(cell, side)),
            None => Tractions::new(),
        };
        let given =
            |cell: usize, side: usize| of_medium.get(&(cell, side)).map_or_else(|| given(cell, side), |own| *own);
        let primal = BubbleResidual { body_force: &loads.body, u, traction: &given, held: &held };
        let (nothing, functionals) = (|_: usize, _: usize| [0.0; 2], &self.functionals.functionals);
        let of_side = |values: HashMap<(usize, usize), [f64; 2]>| {
            move |cell: usize, side: usize| values.get(&(cell, side)).copied().unwrap_or_default()
        };
        let tractions: Vec<_> = (0..functionals.len()).map(|k| of_side(self.tractions_of_dual(body, k))).collect();
        let of_weight = |f: &GridFunctional<'_>| match &f.of_forces {
            Some((own, w)) => beyond_ends(body, fine, |side| (side == *own).then_some(w)),
            None => HashMap::new(),
        };
        let weights: Vec<_> = functionals.iter().map(|f| of_side(of_weight(f))).collect();
        let duals: Vec<BubbleDual<'_>> = (functionals.iter().zip(&self.solutions).zip(tractions.iter().zip(&weights)))
            .map(|((functional, z), (traction, held))| BubbleDual {
                z,
                traction: if functional.traction.is_empty() && self.medium.is_none() { &nothing } else { traction },
                held: if functional.of_forces.is_none() { &nothing } else { held },
                of_cell: functional.of_cell,
            })
            .collect();
        (bubble_weighted_residuals(body, &primal, &duals), bubble_energies(body, &primal))
    }

    /// The tractions of a dual solution on the sides where there are any: those of its load, and of the medium.
    fn tractions_of_dual(&self, body: &HeterogeneousBody, k: usize) -> HashMap<(usize, usize), [f64; 2]> {
        let mut tractions = self.functionals.functionals[k].traction.clone();
        if let Some(medium) = &self.medium {
            let given = |side: (usize, usize)| tractions.get(&side).copied().unwrap_or_default().map(Some);
            let own = medium.sides.tractions(body, &self.solutions[k], &medium.duals[k].moments, given);
            tractions.extend(own.into_iter().map(|(side, t)| (side, t.map(Option::unwrap_or_default))));
        }
        tractions
    }

    /// The load of a functional at the fine nodes, with the tractions of the medium in its dual problem.
    fn load_of_dual(&self, body: &HeterogeneousBody, k: usize) -> HashMap<usize, [f64; 2]> {
        let mut load = self.functionals.functionals[k].nodal(body);
        if let Some(medium) = &self.medium {
            for (node, moment) in medium.sides.forces(&medium.duals[k].moments) {
                let sum = load.entry(node).or_default();
                (0..2).for_each(|i| sum[i] += moment[i]);
            }
        }
        load
    }

    /// J(u_h) - J(u_H) of the functionals in each coarse cell, one cell after the other: -ρ_z·c at its nodes with c = u_h - u_H; and last what
    /// J of the fine field differs from the number that is told. `residual` is f - K u_H.
    fn of_coarse_cells(&self, solved: &GridSolved, coarse: &CoarseSolved, residual: &[f64], c: &[f64]) -> Vec<f64> {
        let body = &solved.body;
        let functionals = || self.functionals.functionals.iter().zip(&self.solutions);
        let loads: Vec<HashMap<usize, [f64; 2]>> =
            (0..self.solutions.len()).map(|k| self.load_of_dual(body, k)).collect();
        let mut all = Vec::new();
        for nodes in residual_nodes(body, coarse) {
            let mut etas = vec![0.0; self.solutions.len()];
            for (node, share) in nodes {
                let own = [0, 1].map(|k| share * c[2 * node + k]);
                let weights = body.weights_at(node, own);
                for ((z, load), eta) in self.solutions.iter().zip(&loads).zip(&mut etas) {
                    let of_cell = |(nodes, weights): &([usize; 4], [f64; 8])| -> f64 {
                        (0..8).map(|a| weights[a] * z[2 * nodes[a / 2] + a % 2]).sum()
                    };
                    *eta += weights.iter().map(of_cell).sum::<f64>();
                    *eta -= load.get(&node).map_or(0.0, |load| dot(*load, own));
                }
            }
            all.append(&mut etas);
        }
        // the medium has a part in the balance
        if self.medium.is_some() {
            return all;
        }
        for (functional, z) in functionals() {
            let of_field = functional.of(body, &solved.displacement);
            let of_forces: f64 = z.iter().zip(residual).map(|(z, r)| -z * r).sum();
            let of_shear = functional
                .of_forces
                .as_ref()
                .map_or(0.0, |(side, w)| self.contact.work(*side, |node| body.grid.point(node), w));
            // a part of a number is that of the field
            let off = of_field + of_forces + of_shear - functional.value;
            all.push(if off.is_nan() { 0.0 } else { off });
        }
        all
    }

    /// J(u_h) less the number that is told of each functional, u_h = u + c: by c alone, as the residual of cells that do not conform is not of
    /// their edges. `residual` is f - K u.
    fn of_rough_cells(&self, solved: &GridSolved, residual: &[f64], c: &[f64]) -> Vec<f64> {
        let body = &solved.body;
        let left: Vec<f64> = residual.iter().zip(body.forces(c)).map(|(r, f)| r - f).collect();
        let of = |(functional, z): (&GridFunctional<'_>, &Vec<f64>)| match functional.of_forces {
            Some(_) => -z.iter().zip(&left).map(|(z, r)| z * r).sum::<f64>() - functional.value,
            None => functional.of(body, &solved.displacement) + functional.of(body, c) - functional.value,
        };
        self.functionals.functionals.iter().zip(&self.solutions).map(of).collect()
    }
}

/// The nodes of each coarse cell at which a dual solution has a residual, with the share that the cell has in it: those on its edges if the
/// basis solves the equations inside.
fn residual_nodes(body: &HeterogeneousBody, coarse: &CoarseSolved) -> Vec<Vec<(usize, f64)>> {
    let on_edges = matches!(coarse.basis, Basis::Coupled | Basis::Oscillatory);
    let of_cell = |cell: &CoarseCell| -> Vec<usize> {
        let [m, n] = cell.size;
        let on_edge = |k: usize| [0, m].contains(&(k % (m + 1))) || [0, n].contains(&(k / (m + 1)));
        let nodes = cell.fine_nodes(&body.grid).enumerate();
        nodes.filter(|(k, _)| !on_edges || on_edge(*k)).map(|(_, node)| node).collect()
    };
    let nodes: Vec<Vec<usize>> = coarse.mesh.cells.iter().map(of_cell).collect();
    let mut count = vec![0.0; body.grid.nodes()];
    nodes.iter().flatten().for_each(|&node| count[node] += 1.0);
    nodes.into_iter().map(|own| own.into_iter().map(|node| (node, 1.0 / count[node])).collect()).collect()
}

/// max(|Σ η|, ½ Σ |η|) of a sum of functionals, of which each cell has `count`.
fn difference(sum: &[(usize, f64)], of_cells: &[f64], count: usize) -> f64 {
    let cells = of_cells.chunks_exact(count.max(1));
    let etas = cells.map(|etas| sum.iter().map(|&(k, weight)| weight * etas[k]).sum::<f64>());
    let (whole, size) = etas.fold((0.0, 0.0), |(whole, size), eta| (whole + eta, size + eta.abs()));
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

/// The same of a field on the sides that have one.
fn beyond_ends<'w, 'a: 'w>(
    body: &HeterogeneousBody,
    fine: &GridTrace,
    of: impl Fn(usize) -> Option<&'w Weight<'a>>,
) -> HashMap<(usize, usize), [f64; 2]> {
    let mesh = &fine.mesh;
    let beyond = |e: usize| {
        let w = of(mesh.side[e])?;
        let [a, b, middle] = [-1.0, 1.0, 0.0].map(|t| w(mesh.point(e, t)));
        Some((fine.cell(&body.grid, e), [0, 1].map(|k| middle[k] - (a[k] + b[k]) / 2.0)))
    };
    (0..mesh.len()).filter_map(beyond).collect()
}
