//! Whether a problem under Coulomb's law has other solutions than a given one.
//!
//! A solution is a fixed point p = Φ(p) of its pressures, Φ(p) = λ_n⁺ of the Tresca problem with the bounds μ p. With the sets
//! of contact, stick and slip as they are, Φ is linear; T is its derivative.
//!
//! ```text
//! det(I - T) = Π (1 - τ_i)   over the eigenvalues τ_i of T: negative where an odd number of real ones is above 1
//! ```
//! A body that is held has solutions for all coefficients, and they stay bounded as these fall to 0, where there is one. So
//! the signs of det(I - T) at all solutions add up to 1 (the degree of p - Φ(p), if no det is 0): a negative one means at
//! least two other solutions, and one of several is always negative. A positive one says nothing about the others. Complex or
//! negative τ_i, however large, show only that the fixed point does not settle.

use faer::Mat;
use steklov_algebra::eigenvalues;
use steklov_elastic::plane::dot;

use crate::solvers::fixed_point::{body_force, settled};
use crate::solvers::frozen::{Frozen, Sets};
use crate::solvers::law::{Branch, Law, Piece};
use crate::solvers::linear::largest;
use crate::solvers::pieces::{laws, nearest_pieces};
use crate::{ContactError, Problem, Solution};

/// Solutions farther apart than this part of the largest displacement and gap are different.
const DIFFERENT: f64 = 1e-6;
/// An eigenvalue is real if its imaginary part is smaller than this part of it.
const REAL: f64 = 1e-9;

/// Eigenvalues of the derivative T of the fixed point at a solution, 0 where nothing slips under pressure.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Contraction {
    /// The largest modulus: the factor by which changes of the pressure shrink from one Tresca problem to the next. Below 1
    /// [`crate::fixed_point`] finds the solution from nearby.
    pub factor: f64,
    /// The largest positive real one, or 0: above 1 other solutions are to be expected.
    pub real: f64,
}

/// The contraction of the fixed point of Tresca problems at a solution, with the sets as they are.
///
/// *Cost*: one factorisation, k solutions and the eigenvalues of a k × k matrix for k conditions that slip under pressure.
///
/// # Errors
/// [`ContactError::Inconsistent`] when the solution is not one of this problem, [`ContactError::Decomposition`].
pub fn contraction(problem: &Problem, answer: &Solution) -> Result<Contraction, ContactError> {
    let sets = Sets::new(problem, answer)?;
    let frozen = Frozen::new(problem, &sets)?;
    let conditions: Vec<_> = problem.nodes.iter().flat_map(|n| n.conditions.iter().map(move |c| (n, c))).collect();
    // the slipping conditions: direction of slip times μ D_t
    let sliding: Vec<(usize, f64)> = (0..conditions.len())
        .filter(|&i| sets.closed(i) && conditions[i].1.is_coulomb())
        .filter_map(|i| {
            let c = conditions[i].1;
            sets.slip(i).filter(|s| *s != 0).map(|s| (i, f64::from(s) * c.coefficient * c.tangent_weight))
        })
        .collect();
    if sliding.is_empty() {
        return Ok(Contraction::default());
    }
    let mut derivative = Mat::zeros(sliding.len(), sliding.len());
    for (column, &(i, friction)) in sliding.iter().enumerate() {
        let (node, c) = conditions[i];
        let mut load = vec![0.0; problem.load.len()];
        (0..node.unknowns).for_each(|j| load[node.first + j] -= friction * c.tangent[j]);
        let elastic = problem.stiffness.times(&frozen.correction(&load));
        for (row, &(i, _)) in sliding.iter().enumerate() {
            let (node, c) = conditions[i];
            let force = node.pick(&elastic);
            let square = dot(c.normal, c.normal);
            derivative[(row, column)] = -dot(c.normal, force) / (square * c.normal_weight);
        }
    }
    let values = eigenvalues(derivative.as_ref()).map_err(|_| ContactError::Decomposition { size: sliding.len() })?;
    let mut found = Contraction::default();
    for z in values {
        found.factor = found.factor.max(z.norm());
        if z.im.abs() <= REAL * z.norm() {
            found.real = found.real.max(z.re);
        }
    }
    Ok(found)
}

/// A solution that differs from the given one, if the active set method finds one from full stick, from no friction, or from
/// slip of all conditions either way.
///
/// That none is found proves nothing: of random problems of four nodes with several solutions about one in ten is missed. *Cost*: a
/// few factorisations from each start.
///
/// # Errors
/// [`ContactError::Inconsistent`] from [`Problem::check`].
pub fn other_solution(problem: &Problem, answer: &Solution) -> Result<Option<Solution>, ContactError> {
    problem.check()?;
    if !problem.is_coulomb() {
        return Ok(None);
    }
    let gaps = problem.nodes.iter().flat_map(|node| &node.conditions).map(|c| c.gap);
    let scale = largest(answer.displacement.iter().copied()) + largest(gaps);
    let differs = |other: &Solution| {
        largest(other.displacement.iter().zip(&answer.displacement).map(|(a, b)| a - b)) > DIFFERENT * scale
    };
    let origin = vec![0.0; problem.load.len()];
    let from = |laws: &[Law], pieces, near: &[f64]| settled(problem, laws, pieces, near, &mut Vec::new());
    let closed = |laws: &[Law]| laws.iter().map(|law| law.closed().clone()).collect::<Vec<Piece>>();
    let stick = laws(problem, &[]);
    let slips = |branch: Branch| stick.iter().map(|law| slipping(law, branch)).collect::<Vec<Piece>>();
    let without_friction = || {
        let none = problem.tresca(&vec![[0.0; 2]; answer.multipliers.len()]);
        let smooth = laws(&none, &[]);
        let start = settled(&none, &smooth, closed(&smooth), &origin, &mut Vec::new())?;
        let (laws, v) = (laws(problem, &start.multipliers), &start.displacement);
        from(&laws, nearest_pieces(problem, &laws, v, &body_force(problem, v)), v)
    };
    let starts: [&dyn Fn() -> Option<Solution>; 4] = [
        &|| from(&stick, closed(&stick), &origin),
        &without_friction,
        &|| from(&stick, slips(Branch::Above), &origin),
        &|| from(&stick, slips(Branch::Below), &origin),
    ];
    Ok(starts.iter().filter_map(|start| start()).find(differs))
}

/// The piece of contact in which all friction slips one way, if the node has it, else that of contact and stick.
fn slipping(law: &Law, branch: Branch) -> Piece {
    let mut piece = law.closed().clone();
    piece.iter_mut().zip(&law.source).filter(|(_, source)| source.1).for_each(|(b, _)| *b = branch);
    if law.allows(&piece) { piece } else { law.closed().clone() }
}
