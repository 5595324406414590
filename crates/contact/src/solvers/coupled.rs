//! Coulomb's law on given pieces: linear systems in which slip carries the coefficient times the pressure.
//!
//! Where a condition is closed and slips, the force of the node is x (n ± μ D_t/D_n t) plus Tresca's part, x ≥ 0 unknown. The
//! displacement is free along the line n·v = g as ever, but equilibrium is required across that force: the trial direction is
//! perpendicular to n, the test direction to n ± μ D_t/D_n t, and the system is not symmetric.

use steklov_elastic::plane::{cross, dot, minus, turned, unit};

use crate::solvers::free::{Direction, Free, form, project};
use crate::solvers::law::{Branch, Law, Piece};
use crate::solvers::linear::{largest, solve_general};
use crate::solvers::multipliers::{node_multipliers, touching_distance};
use crate::solvers::pieces::Linear;
use crate::{ContactError, ContactNode, Problem};

/// Halvings of the difference between the pressures of a node with two conditions.
const INNER: usize = 100;

impl Problem {
    /// Whether Coulomb's law holds at some condition.
    pub fn is_coulomb(&self) -> bool {
        self.nodes.iter().flat_map(|n| &n.conditions).any(|c| c.is_coulomb())
    }

    /// The Tresca problem with the bounds that Coulomb's law gives under these multipliers. A solution under Coulomb's law
    /// is the solution of its own Tresca problem.
    ///
    /// # Panics
    /// If there are fewer multipliers than conditions.
    pub fn tresca(&self, multipliers: &[[f64; 2]]) -> Self {
        let mut tresca = self.clone();
        for (c, [pressure, _]) in tresca.nodes.iter_mut().flat_map(|n| &mut n.conditions).zip(multipliers) {
            (c.bound, c.coefficient) = (c.limit(*pressure), 0.0);
        }
        tresca
    }
}

/// Solution of the linear system of given pieces under Coulomb's law; if that leaves a motion free, a v near to `near`.
pub(crate) fn solve_coupled(
    problem: &Problem,
    laws: &[Law],
    pieces: &[Piece],
    near: &[f64],
) -> Result<Linear, ContactError> {
    let s = &problem.stiffness;
    let free = Free::new(problem, laws, pieces);
    let (known, tests) = tests(problem, laws, pieces, &free);
    let rest = |v: &[f64]| -> Vec<f64> {
        let elastic = s.times(v);
        (0..known.len()).map(|i| problem.load[i] - elastic[i] - known[i]).collect()
    };
    // the unknowns are the distances from `near`, so that a free motion stays as it is there
    let kept: Vec<f64> = free.fixed.iter().zip(free.expand(&free.project(near))).map(|(a, b)| a + b).collect();
    let moved = match tests.len() {
        0 => Vec::new(),
        _ => solve_general(&form(s, &tests, &free.directions), &project(&tests, &rest(&kept)))?,
    };
    let displacement: Vec<f64> = kept.iter().zip(free.expand(&moved)).map(|(a, b)| a + b).collect();
    let excess = rest(&displacement);
    let unbalanced = free.expand(&project(&tests, &excess));
    let force = excess.iter().zip(&known).map(|(r, k)| r + k).collect();
    Ok(Linear { displacement, force, unbalanced })
}

/// The forces that the pieces prescribe, m entries, and a test direction for each direction that they leave free.
pub(crate) fn tests(problem: &Problem, laws: &[Law], pieces: &[Piece], free: &Free) -> (Vec<f64>, Vec<Direction>) {
    let (mut known, mut tests): (_, Vec<Direction>) = (vec![0.0; problem.load.len()], Vec::new());
    let mut trials = free.directions.iter().peekable();
    for ((node, law), piece) in problem.nodes.iter().zip(laws).zip(pieces) {
        let (fixed, directions) = forces(node, law, piece);
        known[node.first..node.first + node.unknowns].copy_from_slice(&fixed[..node.unknowns]);
        while let Some(&&(first, k, e)) = trials.peek().filter(|d| d.0 == node.first) {
            let across = |r: &[f64; 2]| turned(unit(*r));
            tests.push((first, k, if k == 2 { directions.first().map_or(e, across) } else { e }));
            trials.next();
        }
    }
    (known, tests)
}

/// The force that a piece prescribes, and the direction of the force of each line that is on, slip that goes with it
/// included.
fn forces(node: &ContactNode, law: &Law, piece: &Piece) -> ([f64; 2], Vec<[f64; 2]>) {
    let on = law.on(piece);
    let mut directions: Vec<[f64; 2]> = on.iter().map(|&i| law.kinks[i].direction).collect();
    let mut known = [0.0; 2];
    for (kink, (&(k, tangential), branch)) in law.kinks.iter().zip(law.source.iter().zip(piece)) {
        let sign = match branch {
            Branch::Below if tangential => -1.0,
            Branch::Above if tangential => 1.0,
            _ => continue,
        };
        let c = &node.conditions[k];
        (0..2).for_each(|j| known[j] += sign * c.tangent_weight * c.bound * kink.direction[j]);
        let pressed = on.iter().position(|&i| law.source[i] == (k, false));
        if let Some(place) = pressed.filter(|_| c.is_coulomb()) {
            let ratio = sign * c.coefficient * c.tangent_weight / c.normal_weight;
            (0..2).for_each(|j| directions[place][j] += ratio * kink.direction[j]);
        }
    }
    (known, directions)
}

/// λ_n⁺ of each condition when the piece carries the whole force r.
fn pressures(node: &ContactNode, law: &Law, piece: &Piece, r: [f64; 2]) -> Vec<f64> {
    let (known, directions) = forces(node, law, piece);
    let rest = minus(r, known);
    let x: Vec<f64> = match *directions.as_slice() {
        [d] => vec![dot(d, rest) / dot(d, d)],
        [a, b] => vec![cross(rest, b) / cross(a, b), cross(a, rest) / cross(a, b)],
        _ => Vec::new(),
    };
    let mut pressures = vec![0.0; node.conditions.len()];
    for (i, x) in law.on(piece).into_iter().zip(x).filter(|(i, _)| !law.source[*i].1) {
        let k = law.source[i].0;
        pressures[k] = if x > 0.0 { x / node.conditions[k].normal_weight } else { 0.0 };
    }
    pressures
}

/// The laws with the friction bounds of the pressures λ_n + c (u_n - g) that v and R = f - S v have on the pieces.
pub(crate) fn renewed_laws(problem: &Problem, laws: &[Law], pieces: &[Piece], v: &[f64], r: &[f64]) -> Vec<Law> {
    let touch = touching_distance(laws, v);
    let nodes = problem.nodes.iter().zip(laws).zip(pieces);
    nodes.map(|((node, law), piece)| renewed(node, law, piece, node.pick(v), node.pick(r), touch)).collect()
}

fn renewed(node: &ContactNode, law: &Law, piece: &Piece, w: [f64; 2], r: [f64; 2], touch: f64) -> Law {
    let (mut law, c) = (law.clone(), law.metric);
    let mut carried = pressures(node, &law, piece, r);
    // where more lines meet than a piece has, two conditions share the force in another way
    for _ in 0..if node.conditions.len() > 1 { INNER } else { 0 } {
        law.set_limits(node, &carried);
        let shared = node_multipliers(node, &law, piece, w, r, touch);
        let moved = largest(carried.iter().zip(&shared).map(|(p, l)| p - l[0].max(0.0)));
        if moved <= 1e-15 * largest(carried.iter().copied()) {
            break;
        }
        carried.iter_mut().zip(&shared).for_each(|(p, l)| *p = (*p + l[0].max(0.0)) / 2.0);
    }
    for (condition, pressure) in node.conditions.iter().zip(&mut carried).filter(|(c, _)| c.normal_weight > 0.0) {
        let n = condition.normal;
        let stiffness = c[0] * n[0] * n[0] + c[1] * n[1] * n[1];
        *pressure += stiffness * (-condition.opening(w)).max(0.0) / condition.normal_weight;
    }
    law.set_limits(node, &carried);
    law
}
