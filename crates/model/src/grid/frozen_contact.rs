//! Contact on a grid at the sets of its solution, for the dual problems of numbers.
//!
//! ```text
//! closed between two nodes     u_n = g held, in the mean over a fine side
//! stick between two nodes      u_t held
//! slip, and apart              the tractions of the multipliers given, linear between the nodes
//! an end of a set              moved by one node to either side: the sets say no more of it
//! ```

use std::collections::HashMap;

use steklov_bem_operators::Site;
use steklov_contact::{
    BoundaryCondition, ContactBoundary, ContactError, Frozen, FrozenDual, MovedEnd, Sets, Solution, moved_ends,
};
use steklov_elastic::plane::dot;
use steklov_msfem::{Elimination, ReducedLoad};
use steklov_problem::Scene;

use super::estimate::contact_sides;
use super::loads::Tractions;
use super::solution::GridSolved;
use super::system::CondensedContact;
use crate::doubt::Doubt;
use crate::estimate::error_estimate::UNRESOLVED;
use crate::solve::contact::ContactFactors;
use crate::solve::contact_rows::contact_rows;

/// Part of a cell within which a point is on its side.
const BESIDE: f64 = 1e-9;

/// What contact holds and gives on the fine grid.
#[derive(Default)]
pub(super) struct FrozenContact {
    /// Mean tractions on fine sides (cell, side); None in components that contact holds.
    pub tractions: Tractions,
    /// What these components have at the middle of a side beyond the mean of its ends.
    pub missed: HashMap<(usize, usize), [f64; 2]>,
    /// Fine unknowns that contact holds, and what they lack of the gap.
    pub held: HashMap<usize, f64>,
    /// How much the displacement lacks of the gap on a side that contact holds, at most.
    lacking: HashMap<(usize, usize), [f64; 2]>,
    /// Shear where contact does not stick.
    pub shear: Vec<Shear>,
}

/// The shear force at a fine node.
pub(super) struct Shear {
    pub node: usize,
    pub force: [f64; 2],
    /// The side of the body.
    side: usize,
    /// Whether it follows the pressure.
    pub follows: bool,
}

/// The state of a condition.
#[derive(Clone, Copy)]
struct State {
    normal: [f64; 2],
    closed: bool,
    sticks: bool,
}

impl FrozenContact {
    /// That of a solution at these sets; nothing without contact.
    pub fn new(scene: &Scene, solved: &GridSolved, sets: Option<&Sets>) -> Self {
        let mut this = Self::default();
        let (Some(contact), Some(sets)) = (&solved.contact, sets) else { return this };
        let states = states(&contact.boundary, sets);
        let (mesh, u) = (&solved.trace.mesh, &solved.displacement);
        for pressed in contact_sides(solved) {
            let e = pressed.element;
            let side = mesh.side[e];
            let at_ends = [e, mesh.next[e]].map(|node| states.get(&(node, side)).copied());
            let own: Vec<State> = at_ends.into_iter().flatten().collect();
            let (Some(State { normal, .. }), Some(given)) = (own.first().copied(), scene.contact(side)) else {
                continue;
            };
            let axis = usize::from(normal[0] == 0.0);
            let closed = own.iter().all(|state| state.closed);
            let sticks = own.iter().all(|state| state.sticks);
            let gap = |t: f64| {
                let Site { point: [x, y], s, .. } = Site::new(mesh, e, t);
                normal[axis] * given.gap.eval(x, y, s)
            };
            let ends = pressed.t.map(gap);
            let lacks = [0, 1].map(|k| ends[k] - u[2 * pressed.nodes[k] + axis]);
            for (k, node) in pressed.nodes.into_iter().enumerate() {
                // the nodes of the contact conditions have their own states
                let own = at_ends[k].filter(|_| pressed.t[k].abs() == 1.0);
                if own.map_or(closed, |own| own.closed) {
                    this.held.insert(2 * node + axis, lacks[k]);
                }
                if own.map_or(sticks, |own| own.sticks) {
                    // a held neighbour that moves takes a part in the mean
                    this.held.insert(2 * node + 1 - axis, -u[2 * node + 1 - axis]);
                }
            }
            let mut lacking = [0.0; 2];
            let slides = |node: usize| this.held.get(&(2 * node + 1 - axis)).map_or(0.0, |lacks| lacks.abs());
            lacking[1 - axis] = slides(pressed.nodes[0]).max(slides(pressed.nodes[1]));
            let of_held =
                |k: usize| if this.held.contains_key(&(2 * pressed.nodes[k] + axis)) { lacks[k].abs() } else { 0.0 };
            lacking[axis] = of_held(0).max(of_held(1));
            let mut traction = [None; 2];
            if closed {
                let beyond = gap((pressed.t[0] + pressed.t[1]) / 2.0) - (ends[0] + ends[1]) / 2.0;
                let mut missed = [0.0; 2];
                // the mean of a bubble is 2/3, as that of a parabola beyond its ends
                missed[axis] = 1.5 * (lacks[0] + lacks[1]) / 2.0 + beyond;
                this.missed.insert(pressed.side, missed);
                lacking[axis] += beyond.abs();
            } else {
                traction[axis] = Some(0.0);
            }
            if !sticks {
                traction[1 - axis] = Some((pressed.tractions[0][1 - axis] + pressed.tractions[1][1 - axis]) / 2.0);
                for (node, mut force) in pressed.nodal_forces() {
                    force[axis] = 0.0;
                    let follows = given.friction.coefficient().is_some();
                    this.shear.push(Shear { node, force, side, follows });
                }
            }
            this.tractions.insert(pressed.side, traction);
            this.lacking.insert(pressed.side, lacking);
        }
        this
    }

    /// What the displacement lacks of the gap at a local point of a cell, where contact holds it, at most.
    pub fn lacking_at(&self, cell: usize, [x, y]: [f64; 2]) -> [f64; 2] {
        let of_sides = [(0, y <= BESIDE), (1, x >= 1.0 - BESIDE), (2, y >= 1.0 - BESIDE), (3, x <= BESIDE)];
        let own =
            of_sides.into_iter().filter(|&(_, is_at)| is_at).filter_map(|(side, _)| self.lacking.get(&(cell, side)));
        own.fold([0.0; 2], |most: [f64; 2], lacking| [0, 1].map(|k| most[k].max(lacking[k])))
    }

    /// The work of given shear on a field w along a side; `at` has the points of the fine nodes.
    pub fn work(&self, side: usize, at: impl Fn(usize) -> [f64; 2], w: impl Fn([f64; 2]) -> [f64; 2]) -> f64 {
        let own = self.shear.iter().filter(|own| own.side == side && !own.follows);
        own.map(|own| dot(w(at(own.node)), own.force)).sum()
    }
}

/// The conditions with their nodes, in the order of the multipliers.
pub(super) fn conditions(boundary: &ContactBoundary) -> Vec<(usize, &BoundaryCondition)> {
    boundary.nodes.iter().flat_map(|node| node.conditions.iter().map(move |c| (node.node, c))).collect()
}

/// The states of conditions by node and side.
fn states(boundary: &ContactBoundary, sets: &Sets) -> HashMap<(usize, usize), State> {
    let mut states = HashMap::new();
    for (k, (node, condition)) in conditions(boundary).into_iter().enumerate() {
        let (closed, sticks) = (sets.closed(k), sets.slip(k) == Some(0));
        for share in &condition.shares {
            states.insert((node, share.side), State { normal: condition.normal, closed, sticks });
        }
    }
    states
}

/// Dual problems with the contact of a grid frozen.
pub(super) struct FrozenProblem<'a> {
    elimination: &'a Elimination,
    condensed: &'a CondensedContact,
    dual: FrozenDual<'a>,
    /// The changes of the solution where an end moves.
    moved: &'a [[MovedEnd; 2]],
}

impl FrozenProblem<'_> {
    /// The dual solution of a load and of held displacements, `w` what it is at the contact nodes in their unknowns where contact holds them;
    /// and how J changes where an end moves, by ends and sides.
    pub fn field(&self, load: &[f64], held: &[f64], w: &[f64]) -> (Vec<f64>, Vec<[f64; 2]>) {
        let reduced: ReducedLoad = self.elimination.reduce(load, held);
        let (problem, frames) = (&self.condensed.factors.problem, &self.condensed.frames);
        let mut rest = reduced.kept.clone();
        frames.turn_in(&mut rest);
        let known = problem.stiffness.times(w);
        rest.iter_mut().zip(known).for_each(|(f, known)| *f -= known);
        let y = self.dual.solution(&rest);
        let of_ends = self.moved.iter().map(|both| both.each_ref().map(|end| -end.change_of(&rest, &y))).collect();
        let mut v: Vec<f64> = y.iter().zip(w).map(|(y, w)| y + w).collect();
        frames.turn_back(&mut v);
        (self.elimination.expand(&reduced, &v), of_ends)
    }
}

/// Calls `call` with the dual problems of a grid and the ends of its contact.
///
/// # Errors
/// [`ContactError::Decomposition`].
pub(super) fn with_frozen<T>(
    elimination: &Elimination,
    condensed: &CondensedContact,
    (solution, may_open): (&Solution, bool),
    call: impl FnOnce(&FrozenProblem<'_>, &[[MovedEnd; 2]]) -> T,
) -> Result<T, ContactError> {
    let ContactFactors { problem, sets, lines } = &condensed.factors;
    let frozen = Frozen::new(problem, sets)?;
    let moved = moved_ends((problem, solution), (sets, &frozen), (lines, may_open));
    let dual = FrozenDual::new(&frozen, sets);
    Ok(call(&FrozenProblem { elimination, condensed, dual, moved: &moved }, &moved))
}

/// A field w on a side in contact in the unknowns of the contact nodes, in the parts that the side has in them.
pub(super) fn on_contact(boundary: &ContactBoundary, side: usize, w: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
    let mut all = Vec::new();
    for node in &boundary.nodes {
        let w = w(node.point);
        for &direction in &node.directions {
            let (mut own, mut whole) = (0.0, 0.0);
            for condition in &node.conditions {
                let is_normal = dot(condition.normal, direction).abs() > 0.5;
                let only = node.conditions.len() == 1;
                for share in condition.shares.iter().filter(|_| is_normal || only) {
                    let weight = if is_normal { share.normal } else { share.tangent };
                    whole += weight;
                    own += if share.side == side { weight } else { 0.0 };
                }
            }
            all.push(if whole > 0.0 { dot(w, direction) * own / whole } else { 0.0 });
        }
    }
    all
}

/// Elements of a side in contact, up to which there are few.
const FEW: usize = 4;

/// Why numbers of a grid with contact are in doubt: few elements on a side in contact, or a gap that varies within elements more than a parabola
/// follows. `error` is the estimate (energy norm).
pub(crate) fn doubts_of_contact(scene: &Scene, solved: &GridSolved, error: f64) -> Vec<Doubt> {
    let Some(contact) = &solved.contact else { return Vec::new() };
    let (mesh, trace) = (&solved.trace.mesh, solved.trace());
    let mut counts: HashMap<usize, usize> = HashMap::new();
    (0..mesh.len()).for_each(|e| *counts.entry(mesh.side[e]).or_default() += 1);
    let few = scene.contacts().any(|(side, _)| counts.get(&side).is_some_and(|count| *count <= FEW));
    // the smallest opening at the nodes of each side
    let mut openings: HashMap<(usize, usize), f64> = HashMap::new();
    for ((node, condition), row) in conditions(&contact.boundary).into_iter().zip(contact_rows(trace, contact)) {
        for share in &condition.shares {
            openings.insert((node, share.side), row.gap - row.normal_displacement);
        }
    }
    let mut unresolved = 0.0;
    for e in 0..mesh.len() {
        let Some(given) = scene.contact(mesh.side[e]) else { continue };
        let gap = |t: f64| {
            let Site { point: [x, y], s, .. } = Site::new(mesh, e, t);
            given.gap.eval(x, y, s)
        };
        let [a, middle, b] = [-1.0, 0.0, 1.0].map(gap);
        let parabola = |t: f64| middle + t * (b - a) / 2.0 + t * t * ((a + b) / 2.0 - middle);
        let off = BETWEEN.into_iter().map(|t| (gap(t) - parabola(t)).abs()).fold(0.0, f64::max);
        let opening = [e, mesh.next[e]]
            .iter()
            .filter_map(|&node| openings.get(&(node, mesh.side[e])))
            .fold(f64::INFINITY, |m, o| m.min(*o));
        if opening <= off + (a - b).abs() {
            unresolved += scene.problem.contact_modulus(mesh.edge[e]) / 2.0 * off * off;
        }
    }
    let found = [(Doubt::Coarse, few), (Doubt::Data, unresolved > UNRESOLVED * error * error)];
    found.into_iter().filter(|(_, is)| *is).map(|(doubt, _)| doubt).collect()
}

/// Places on an element at which a gap is compared with a parabola.
const BETWEEN: [f64; 6] = [-0.75, -0.5, -0.25, 0.25, 0.5, 0.75];
