//! Answers at the nodes of a stochastic mesh, cell by cell, refined until the truncation is small.

use std::sync::atomic::{AtomicUsize, Ordering};

use steklov_contact::Solution;
use steklov_problem::{DataError, Random, Sampling, Scene};
use steklov_stochastic::{CellBasis, DirectionError, Nodes, StochasticMesh, changes, refine, solve_points, truncation};

use super::check::{Check, check};
use super::coupled::solve_cell;
use super::events::{events, slips};
use super::jumps::split_at_cuts;
use super::outcome_checks::{Look, Looked, look, mean_modulus};
use super::outcomes::{Answer, Outcomes};
use super::result::End;
use super::surrogate::{Cell, Surrogate, Told};
use super::watch::OutcomesWatch;
use crate::error::SolveError;

/// Part of the squared error whose directions are refined at a time.
const SHARE: f64 = 0.7;
/// Most rounds of refinement.
const ROUNDS: usize = 60;
/// Largest deviation of the modulus from an affine function of its germs, relative, that rounding explains.
const AFFINE: f64 = 1e-12;
/// Truncations below this part of the energy norm are rounding.
const ROUNDED: f64 = 1e-9;
/// Number of places between the ends of a germ at which this is checked.
const PLACES: usize = 12;

/// Whether the exact Galerkin equations couple the nodes of a cell and can be solved so: E of a single body is not affine in its
/// germs, supports hold the body, and there is neither a body force, a remote stress nor Coulomb friction. Others are solved node by node, which is collocation.
///
/// # Errors
/// [`DataError`] if the scene has no outcome at one of the examined germs: correct the expression of the random modulus.
pub fn is_coupled(scene: &Scene, random: &Random) -> Result<bool, DataError> {
    let galerkin = random.stochastic.method == Sampling::Galerkin && scene.uses(random).young;
    let galerkin = galerkin && !scene.problem.has_several_bodies();
    let coulomb = scene.contacts().any(|(_, contact)| contact.friction.coefficient().is_some());
    let simple = scene.particular_solution(0).is_none() && !coulomb;
    Ok(galerkin && simple && scene.unresisted(0, scene.free_of_supports(None)).is_empty() && !is_affine(scene, random)?)
}

/// Whether E is affine in each germ while the others are fixed: then the Galerkin equations of the nodes decouple.
fn is_affine(scene: &Scene, random: &Random) -> Result<bool, DataError> {
    let quantile = |d: usize, p: f64| random.germs[d].variable.quantile(p);
    for (k, others) in [0.5, 0.2, 0.9, 0.35].into_iter().enumerate() {
        for d in 0..random.germs.len() {
            let mut germs: Vec<f64> = (0..random.germs.len()).map(|c| quantile(c, others)).collect();
            let [low, high] = random.germs[d].variable.germ_support();
            // E is clipped or steps where it would leave its range: out at the ends
            let rare = |bound: f64| if bound.is_finite() { 1e-9 } else { 1e-6 };
            let ends = [quantile(d, rare(low)), quantile(d, 1.0 - rare(high))];
            let mut at = |part: f64| {
                germs[d] = ends[0] + part * (ends[1] - ends[0]);
                Ok::<f64, DataError>(scene.outcome(&germs)?.body().material().young)
            };
            let (a, b) = (at(0.0)?, at(1.0)?);
            for place in 0..PLACES {
                let part = (place as f64 + 0.2 * (k + 1) as f64) / PLACES as f64;
                let value = at(part)?;
                if (value - a - part * (b - a)).abs() > AFFINE * a.abs().max(b.abs()) {
                    return Ok(false);
                }
            }
        }
    }
    Ok(true)
}

/// Solves at the nodes of the scene's stochastic mesh.
pub(crate) fn solve_nodes(
    scene: &Scene,
    random: &Random,
    outcomes: &Outcomes<'_>,
    coupled: bool,
    watch: &OutcomesWatch<'_>,
) -> Result<Surrogate, SolveError> {
    let settings = &random.stochastic;
    let variables = random.germs.iter().map(|g| g.variable.clone()).collect();
    let (elements, degree) = (vec![settings.elements; random.germs.len()], vec![settings.degree; random.germs.len()]);
    let mut mesh = StochasticMesh::uniform(variables, &elements, &degree)?;
    split_at_cuts(&mut mesh, scene.cuts(random))?;
    let mut cells: Vec<Option<Cell>> = Vec::new();
    let (mut solved, mut checks, mut samples) = (0, 0, 0);
    for round in 0.. {
        cells.resize_with(mesh.cells.len(), || None);
        let todo: Vec<usize> = (0..cells.len()).filter(|&c| cells[c].is_none()).collect();
        let (nodes, looks) = solve_todo(scene, outcomes, coupled, &mesh, (&todo, &mut cells), watch)?;
        (solved, checks) = (solved + nodes, checks + looks);
        let all: Vec<&Cell> = cells.iter().flatten().collect();
        let nodes: usize = all.iter().map(|c| c.answers.len()).sum();
        let measured = Size::of(&all);
        let scale = if settings.of_deviation { deviation(outcomes, &all) } else { 1.0 };
        // of displacements without a deviation rounding is all that is left
        let enough = (settings.tolerance * scale).max(ROUNDED);
        let settled = !settings.refine || nodes >= settings.max_nodes || round == ROUNDS;
        let mut sample: Option<Check> = None;
        if settled || measured.relative() <= enough {
            let drawn = check(outcomes, &mesh, &all, settings, samples, watch)?;
            (checks, samples) = (checks + drawn.outcomes, samples + 1);
            sample = Some(drawn);
        }
        let told = sample.as_ref().map_or(f64::INFINITY, |s| measured.with(s).relative());
        let end = match () {
            () if !settings.refine => Some(End::Solved),
            () if told <= enough => Some(End::Tolerance),
            () if nodes >= settings.max_nodes => Some(End::MaxNodes),
            () if round == ROUNDS => Some(End::Rounds),
            () => None,
        };
        if let (Some(end), Some(sample)) = (end, &sample) {
            let with = measured.with(sample);
            let seen: f64 = all.iter().flat_map(|c| &c.errors).map(|e| e.error).sum();
            let (by_nodes, relative) = (Size { squared: seen, ..with }.relative(), with.relative());
            let quantity = |k: usize| {
                let missed =
                    |c: &&Cell| c.misses.iter().map(|m| m.residual.quantities[k]).fold(c.quantities[k], f64::max);
                all.iter().map(missed).sum::<f64>().max(sample.residual.quantities[k])
            };
            let quantities = (0..outcomes.numbers.len()).map(quantity).collect();
            let measured = Size { squared: sample.residual.squared, ..with }.relative();
            // 95 % of such samples would have seen more
            let undecided = all.iter().map(|c| c.undecided).sum::<f64>().min(3.0 / sample.outcomes as f64);
            let cells = cells.into_iter().flatten().collect();
            let told = Told { by_nodes, relative, measured, quantities, checks, undecided };
            return Ok(Surrogate { mesh, cells, coupled, told, end, solved });
        }
        if let Some(sample) = sample {
            let (misses, count) = sample.misses(outcomes, &all, SHARE)?;
            checks += count;
            for (c, miss) in misses {
                if let Some(cell) = &mut cells[c] {
                    cell.misses.push(miss);
                }
            }
        }
        let all: Vec<&Cell> = cells.iter().flatten().collect();
        let marks: Vec<Vec<DirectionError>> = all.iter().map(|c| c.errors()).collect();
        let changed = refine(&mut mesh, &marks, SHARE, &|cell, direction| all[cell].cut(direction))?;
        let known = cells.len();
        changed.into_iter().filter(|&c| c < known).for_each(|c| cells[c] = None);
    }
    unreachable!("the rounds are limited")
}

/// The deviation of the displacements over the root of their mean square, in the energy norm.
fn deviation(outcomes: &Outcomes<'_>, cells: &[&Cell]) -> f64 {
    let nodes = || cells.iter().flat_map(|c| c.basis.weights.iter().zip(&c.answers));
    let mut mean = vec![0.0; outcomes.body.space.dofs()];
    for (weight, answer) in nodes() {
        mean.iter_mut().zip(&answer.displacement).for_each(|(m, u)| *m += weight * u);
    }
    let (mut about, mut all) = (0.0, 0.0);
    for (weight, answer) in nodes() {
        let apart: Vec<f64> = answer.displacement.iter().zip(&mean).map(|(u, m)| u - m).collect();
        about += weight * outcomes.energy(&apart);
        all += weight * outcomes.energy(&answer.displacement);
    }
    if all > 0.0 { (about.max(0.0) / all).sqrt().min(1.0) } else { 1.0 }
}

/// A squared error and the mean of the squared energy norm.
#[derive(Clone, Copy)]
struct Size {
    squared: f64,
    energy: f64,
}

impl Size {
    fn of(cells: &[&Cell]) -> Self {
        let nodes = cells.iter().flat_map(|c| c.basis.weights.iter().zip(&c.answers));
        Self {
            squared: cells.iter().flat_map(|c| c.errors()).map(|e| e.error).sum(),
            energy: nodes.map(|(w, a)| w * 2.0 * a.strain).sum(),
        }
    }

    /// The larger ones: no node may see what has an energy at all.
    fn with(self, sample: &Check) -> Self {
        Self { squared: self.squared.max(sample.residual.squared), energy: self.energy.max(sample.energy) }
    }

    fn relative(self) -> f64 {
        if self.squared == 0.0 { 0.0 } else { (self.squared / self.energy).sqrt() }
    }
}

/// Solves at the nodes of the cells that have no answers, and looks at their ends. Gives both numbers of outcomes.
fn solve_todo(
    scene: &Scene,
    outcomes: &Outcomes<'_>,
    coupled: bool,
    mesh: &StochasticMesh,
    (todo, cells): (&[usize], &mut [Option<Cell>]),
    watch: &OutcomesWatch<'_>,
) -> Result<(usize, usize), SolveError> {
    let bases: Vec<CellBasis> = todo.iter().map(|&c| mesh.basis(c, Nodes::Gauss)).collect::<Result<_, _>>()?;
    let answers = solve_cells(scene, outcomes, coupled, &bases, watch)?;
    let each = || todo.iter().zip(&bases).zip(&answers);
    let looked: Vec<Looked<'_>> = each().map(|((&cell, basis), nodes)| Looked { cell, basis, nodes }).collect();
    let Look { misses, undecided, outcomes: looks } = look(outcomes, mesh, &looked, watch)?;
    drop(looked);
    let solved = answers.iter().map(Vec::len).sum();
    for ((((&c, basis), answers), misses), open) in todo.iter().zip(bases).zip(answers).zip(misses).zip(undecided) {
        let (errors, quantities) = errors(outcomes, &basis, &answers, outcomes.numbers.len());
        let undecided = open * mesh.probability(c);
        cells[c] = Some(Cell { basis, answers, errors, quantities, misses, undecided });
    }
    Ok((solved, looks))
}

/// Answers at the nodes of the cells.
fn solve_cells(
    scene: &Scene,
    outcomes: &Outcomes<'_>,
    coupled: bool,
    bases: &[CellBasis],
    watch: &OutcomesWatch<'_>,
) -> Result<Vec<Vec<Answer>>, SolveError> {
    if coupled {
        let nominal = scene.body().material().young;
        let modulus = |germs: &[f64]| scene.outcome(germs).map_or(f64::NAN, |s| s.body().material().young / nominal);
        return bases
            .iter()
            .map(|basis| {
                watch.check()?;
                solve_cell(outcomes, basis, &modulus, watch)
            })
            .collect();
    }
    let points: Vec<&Vec<f64>> = bases.iter().flat_map(|b| &b.points).collect();
    let done = AtomicUsize::new(0);
    let mut answers = solve_points(points.len(), |i, warm: &mut Option<Solution>| {
        watch.check()?;
        let answer = outcomes.answer(points[i], warm);
        watch.tell(done.fetch_add(1, Ordering::Relaxed) + 1, points.len());
        answer
    })?
    .into_iter();
    Ok(bases.iter().map(|b| answers.by_ref().take(b.points.len()).collect()).collect())
}

/// The larger of the truncations of displacements and of stresses, in the energy norms of the mean modulus, and those of the
/// quantities, all directions together.
fn errors(
    outcomes: &Outcomes<'_>,
    basis: &CellBasis,
    answers: &[Answer],
    quantities: usize,
) -> (Vec<DirectionError>, Vec<f64>) {
    let mean = mean_modulus(answers);
    let all: Vec<&Answer> = answers.iter().collect();
    let (events, slips) = (events(&all), slips(&all));
    let kinked: Vec<bool> = (0..basis.degrees().len())
        .map(|d| changes(basis, d, &events).is_some() || changes(basis, d, &slips).is_some())
        .collect();
    let of = |value: &dyn Fn(&Answer) -> Vec<f64>, energy: &(dyn Fn(&[f64]) -> f64 + Sync)| {
        truncation(basis, &answers.iter().map(value).collect::<Vec<_>>(), &kinked, energy)
    };
    let strains = of(&|a| a.displacement.clone(), &|u| mean * outcomes.energy(u));
    let stresses = of(&|a| a.stressed.clone(), &|u| outcomes.energy(u) / mean);
    let directions = strains.into_iter().zip(stresses).map(|(a, b)| if b.error > a.error { b } else { a }).collect();
    let quantity = |k: usize| of(&|a| vec![a.quantities[k]], &|v| v[0] * v[0]).iter().map(|e| e.error).sum();
    (directions, (0..quantities).map(quantity).collect())
}
