//! Contact problems with given sets: which conditions are closed, which stick, which slip.

use steklov_algebra::Lu;

use crate::solvers::coupled::tests;
use crate::solvers::free::{Direction, Free, expand, form, off_forces, project};
use crate::solvers::law::{Branch, Law, Piece};
use crate::solvers::linear::{Semidefinite, is_regular, solve_with};
use crate::solvers::pieces::{laws, nearest_pieces};
use crate::{ContactError, Problem, Solution, Start};

/// State of each condition, in the order of the multipliers. Under Coulomb's law the friction bounds are those of the
/// solution, whatever changes afterwards.
#[derive(Debug, Clone)]
pub struct Sets {
    laws: Vec<Law>,
    pieces: Vec<Piece>,
    /// Node and number within the node of each condition.
    place: Vec<(usize, usize)>,
}

impl Sets {
    /// The sets of a solution: a condition is closed where λ_n + c(u_n - g) > 0 and slips where |λ_t + c u_t| > F.
    ///
    /// # Errors
    /// [`ContactError::Inconsistent`] when the solution is not one of this problem.
    pub fn new(problem: &Problem, solution: &Solution) -> Result<Self, ContactError> {
        let start = Start { displacement: &solution.displacement, multipliers: &solution.multipliers };
        let force = start.nodal_force(problem)?;
        let laws = laws(problem, &solution.multipliers);
        let pieces = nearest_pieces(problem, &laws, &solution.displacement, &force);
        let nodes = problem.nodes.iter().enumerate();
        let place = nodes.flat_map(|(n, node)| (0..node.conditions.len()).map(move |c| (n, c))).collect();
        Ok(Self { laws, pieces, place })
    }

    /// Whether u_n = g at a condition.
    pub fn closed(&self, condition: usize) -> bool {
        self.branch(condition, false).is_some_and(|b| b == Branch::On)
    }

    /// 0 where a condition sticks, 1 or -1 where it slips along ±t; None without friction, under Coulomb's law also where
    /// it is open.
    pub fn slip(&self, condition: usize) -> Option<i8> {
        let (n, c) = self.place[condition];
        if self.laws[n].limit(c) == Some(0.0) {
            return None;
        }
        self.branch(condition, true).map(|b| match b {
            Branch::Below => -1,
            Branch::On => 0,
            Branch::Above => 1,
        })
    }

    /// Closes or opens a condition; nothing happens where that is not one of the node's states.
    pub fn set_closed(&mut self, condition: usize, closed: bool) {
        self.change(condition, false, if closed { Branch::On } else { Branch::Below });
    }

    /// Lets a condition stick (0) or slip (1, -1); nothing happens where that is not one of the node's states.
    pub fn set_slip(&mut self, condition: usize, slip: i8) {
        self.change(
            condition,
            true,
            match slip {
                0 => Branch::On,
                1.. => Branch::Above,
                _ => Branch::Below,
            },
        );
    }

    fn branch(&self, condition: usize, tangential: bool) -> Option<Branch> {
        let (n, c) = self.place[condition];
        let kink = self.laws[n].source.iter().position(|&s| s == (c, tangential))?;
        Some(self.pieces[n][kink])
    }

    fn change(&mut self, condition: usize, tangential: bool, branch: Branch) {
        let (n, c) = self.place[condition];
        if let Some(kink) = self.laws[n].source.iter().position(|&s| s == (c, tangential)) {
            let mut piece = self.pieces[n].clone();
            piece[kink] = branch;
            if self.laws[n].allows(&piece) {
                self.pieces[n] = piece;
            }
        }
    }
}

/// The linear problem of given sets: u_n = g where closed, u_t = 0 where sticking, λ_t = ±F where slipping.
///
/// F is a number, under Coulomb's law that of the solution to which the sets belong: its change with the pressure is left out,
/// so that the problem stays symmetric.
pub struct Frozen<'a> {
    problem: &'a Problem,
    free: Free,
    /// Forces of the kinks that are off their lines.
    known: Vec<f64>,
    factor: Option<Semidefinite>,
}

impl<'a> Frozen<'a> {
    /// Factorises the stiffness of the displacements that the sets leave free.
    ///
    /// # Errors
    /// [`ContactError::Decomposition`].
    pub fn new(problem: &'a Problem, sets: &Sets) -> Result<Self, ContactError> {
        let free = Free::new(problem, &sets.laws, &sets.pieces);
        let known = off_forces(problem, &sets.laws, &sets.pieces);
        let stiffness = free.stiffness(&problem.stiffness);
        let factor = if stiffness.size() == 0 { None } else { Some(Semidefinite::new(&stiffness)?) };
        Ok(Self { problem, free, known, factor })
    }

    /// The displacement under the problem's load.
    pub fn displacement(&self) -> Vec<f64> {
        let elastic = self.problem.stiffness.times(&self.free.fixed);
        let rest: Vec<f64> = (0..elastic.len()).map(|i| self.problem.load[i] - elastic[i] - self.known[i]).collect();
        self.correction(&rest).iter().zip(&self.free.fixed).map(|(a, b)| a + b).collect()
    }

    /// The change of the displacement under an additional load, with the sets as they are.
    pub fn correction(&self, load: &[f64]) -> Vec<f64> {
        match &self.factor {
            Some(factor) => {
                let load = self.free.project(load);
                self.free.expand(&factor.solve(&load, &vec![0.0; load.len()]))
            }
            None => vec![0.0; load.len()],
        }
    }
}

/// Dual problems at given sets.
///
/// ```text
/// z = y in the test directions,   δv·(S z - j) = 0 for all δv in the trial directions
/// ```
/// A condition that slips under Coulomb's law has the test direction t - ±μ D_t/D_n n, as its shear follows its pressure: j·v then changes by
/// z·δf where the load changes by δf. Else both directions are the same.
pub struct FrozenDual<'a> {
    frozen: &'a Frozen<'a>,
    coupled: Option<(Vec<Direction>, Lu)>,
}

impl<'a> FrozenDual<'a> {
    /// Factorises the transposed matrix under Coulomb's law; `sets` are those of `frozen`.
    pub fn new(frozen: &'a Frozen<'a>, sets: &Sets) -> Self {
        let (problem, free) = (frozen.problem, &frozen.free);
        let coupled = (problem.is_coulomb() && !free.directions.is_empty()).then(|| {
            let (_, tests) = tests(problem, &sets.laws, &sets.pieces, free);
            let factor = Lu::new(form(&problem.stiffness, &free.directions, &tests).as_ref());
            (tests, factor)
        });
        Self { frozen, coupled: coupled.filter(|(_, factor)| is_regular(factor)) }
    }

    /// y for the load j.
    pub fn solution(&self, load: &[f64]) -> Vec<f64> {
        match &self.coupled {
            Some((tests, factor)) => {
                let x = solve_with(factor, &project(&self.frozen.free.directions, load));
                expand(tests, &x, load.len())
            }
            None => self.frozen.correction(load),
        }
    }
}
