//! The nodes of a stochastic cell coupled by a modulus that is not affine in its germs: the exact Galerkin system.
//!
//! ```text
//! Σ_k (M_E)_jk S u_k + D_j Bᵀ W λ_j = D_j f_j        M_E = ∫ E/E₀ θ_j θ_k ρ
//! with f̃_j = Σ_k (M_E⁻¹)_jk D_k f_k and λ̃_j likewise:  S u_j + Bᵀ W λ̃_j = f̃_j
//! ```
//! so that a node's displacement is the answer of the body of the nominal modulus to f̃_j and λ̃_j.
//!
//! Source: Issaoui (2014), equation (4.44).

use faer::Mat;
use steklov_algebra::llt;
use steklov_contact::{Outcome, Solution};
use steklov_problem::Scene;
use steklov_stochastic::{CellBasis, StochasticError, TensorProblem, scale_bounds, tensor_active_set};

use super::outcomes::{Answer, Given, Outcomes};
use super::watch::OutcomesWatch;

use crate::error::SolveError;
use crate::solve::contact_rows::{ContactRow, contact_rows};
use crate::solve::solution::Solved;
use crate::summary::Summary;

/// A node's part of the solution, with the multipliers λ̃.
struct NodeSolution {
    displacement: Vec<f64>,
    multipliers: Vec<[f64; 2]>,
    outcome: Outcome,
    history: Vec<f64>,
}

/// Answers of all nodes of a cell.
pub(crate) fn solve_cell(
    outcomes: &Outcomes<'_>,
    basis: &CellBasis,
    modulus: &dyn Fn(&[f64]) -> f64,
    watch: &OutcomesWatch<'_>,
) -> Result<Vec<Answer>, SolveError> {
    let mass = basis.mass(modulus)?;
    let size = mass.nrows();
    let factor = llt(&mass).map_err(|none| none.or(|_| StochasticError::Decomposition { size }))?;
    let weights = Mat::from_fn(size, size, |j, k| if j == k { basis.weights[j] } else { 0.0 });
    let mixing = factor.solve(weights.as_ref()); // M_E⁻¹ D
    let mut given: Vec<Given> = Vec::with_capacity(size);
    for point in &basis.points {
        watch.check()?;
        given.push(outcomes.given(point)?);
    }
    let mixed = |values: &dyn Fn(usize) -> Vec<f64>| -> Vec<Vec<f64>> {
        let all: Vec<Vec<f64>> = (0..size).map(values).collect();
        let entry = |j: usize, i: usize| (0..size).map(|k| mixing[(j, k)] * all[k][i]).sum();
        (0..size).map(|j| (0..all[0].len()).map(|i| entry(j, i)).collect()).collect()
    };
    let loads = mixed(&|k| given[k].loading.load.clone());
    let contact = given[0].loading.boundary.is_some();
    let condensed: Vec<Vec<f64>> =
        (0..size).map(|j| outcomes.body.condensation.load_held(&loads[j], &given[j].loading.held).kept).collect();
    let mut solutions: Vec<Option<NodeSolution>> = (0..size).map(|_| None).collect();
    let mut physical = vec![Vec::new(); size];
    if contact {
        // F = M_E f̃: what the held values press is already in it, as they do for every node
        let load = Mat::from_fn(condensed[0].len(), size, |i, j| {
            (0..size).map(|k| mass[(j, k)] * condensed[k][i]).sum::<f64>()
        });
        let of_outcome = |g: &Given| g.loading.boundary.as_ref().map_or(Vec::new(), |b| b.contact.clone());
        let nodes: Vec<_> = given.iter().map(of_outcome).collect();
        let stiffness = &*outcomes.body.stiffness.full();
        let problem = TensorProblem { stiffness, mass: &mass, weights: &basis.weights, load: &load, nodes: &nodes };
        let solved = tensor_active_set(&problem)?;
        for j in 0..size {
            let count = solved.multipliers[j].len();
            let mixed = |i: usize, c: usize| (0..size).map(|k| mixing[(j, k)] * solved.multipliers[k][i][c]).sum();
            solutions[j] = Some(NodeSolution {
                displacement: solved.displacement.col_as_slice(j).to_vec(),
                multipliers: (0..count).map(|i| [mixed(i, 0), mixed(i, 1)]).collect(),
                outcome: solved.outcome,
                history: solved.history.clone(),
            });
        }
        physical.clone_from(&solved.multipliers);
    }
    let mut nodes = Vec::with_capacity(size);
    for (j, Given { scene, mut loading, .. }) in given.into_iter().enumerate() {
        watch.check()?;
        let modulus = modulus(&basis.points[j]);
        // the answer is that of the nominal modulus
        loading.loads.scale(1.0 / modulus);
        loading.boundary.iter_mut().for_each(|boundary| scale_bounds(&mut boundary.contact, 1.0 / modulus));
        loading.load.clone_from(&loads[j]);
        loading.liftable = false; // the nodes are solved at once
        let (solved, _) = outcomes.body.answer(&scene, loading, &mut |problem| {
            let NodeSolution { displacement, multipliers, outcome, history } =
                solutions[j].take().unwrap_or_else(|| unreachable!("contact is solved for every node"));
            Ok(Solution::new(problem, displacement, multipliers, outcome, history))
        })?;
        let mut rows = solved.contact.as_ref().map_or(Vec::new(), |contact| contact_rows(solved.trace(), contact));
        for (row, &[pressure, shear]) in rows.iter_mut().zip(&physical[j]) {
            *row = ContactRow { pressure, shear, bound: row.bound * modulus, ..*row };
        }
        let figures = outcomes.figures(&scene, &solved, &rows);
        let stiff = outcomes.body.condensation.multiply(&solved.displacement);
        nodes.push(Node { scene, solved, modulus, rows, figures, stiff });
    }
    let share = |j: usize, k: usize| mass[(j, k)] / basis.weights[j];
    Ok((0..size).map(|j| projected(outcomes, &nodes, j, &|k| share(j, k), &physical[j])).collect())
}

/// A node's answer of the nominal modulus.
struct Node {
    scene: Scene,
    solved: Solved,
    /// E/E₀ of the node.
    modulus: f64,
    /// Its contact with the stresses of the Galerkin solution.
    rows: Vec<ContactRow>,
    figures: Summary,
    /// S u.
    stiff: Vec<f64>,
}

/// The answer at node j with all stresses those of the Galerkin solution: E u is Σ_k D_j⁻¹ (M_E)_jk u_k there, `share` times u_k,
/// and with it reactions, stresses and the elastic energy.
fn projected(
    outcomes: &Outcomes<'_>,
    nodes: &[Node],
    j: usize,
    share: &dyn Fn(usize) -> f64,
    multipliers: &[[f64; 2]],
) -> Answer {
    let own = &nodes[j];
    let sum = |value: &dyn Fn(&Node) -> f64| nodes.iter().enumerate().map(|(k, n)| share(k) * value(n)).sum::<f64>();
    let mut figures = own.figures.clone();
    for (side, force) in &mut figures.reactions {
        *force = [0, 1].map(|i| sum(&|n| n.figures.reactions[side][i]));
    }
    for (p, probe) in figures.probe.iter_mut().enumerate() {
        probe.stress = [0, 1, 2].map(|i| sum(&|n| n.figures.probe[p].stress[i]));
    }
    let u = &own.solved.displacement;
    figures.strain_energy = 0.5 * sum(&|n| n.stiff.iter().zip(u).map(|(s, u)| s * u).sum());
    figures.load_work *= own.modulus;
    figures.friction_work *= own.modulus;
    figures.energy = figures.strain_energy - figures.load_work + figures.friction_work;
    if let (Some(contact), Some(figures_of_contact)) = (&own.solved.contact, &mut figures.contact) {
        let mut total = [0.0; 2];
        for (side, _) in own.scene.contacts() {
            let force = contact.boundary.force(side, multipliers);
            total = [total[0] + force[0], total[1] + force[1]];
            figures.reactions.insert(own.scene.problem.sides[side].name.clone(), force);
        }
        figures_of_contact.force = total;
    }
    let mut answer = outcomes.kept(&own.scene, &own.solved, &own.rows, &figures);
    answer.stressed = (0..u.len()).map(|i| sum(&|n| n.solved.displacement[i])).collect();
    answer
}
