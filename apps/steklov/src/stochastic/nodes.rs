//! Answers at the nodes of a stochastic mesh, cell by cell, refined until the truncation is small.

use std::sync::atomic::{AtomicUsize, Ordering};

use steklov_contact::Solution;
use steklov_stochastic::{CellBasis, DirectionError, Nodes, StochasticMesh, changes, refine, solve_points, truncation};

use super::coupled::solve_cell;
use super::outcomes::{Answer, Outcomes};
use super::result::Watch;
use crate::plan::free_of_supports;
use crate::scene::{Condition, Friction, Random, Sampling, Scene, SceneError, Side};
use crate::solve::SolveError;

/// Part of the squared error whose directions are refined at a time.
const SHARE: f64 = 0.7;
/// Most rounds of refinement.
const ROUNDS: usize = 60;
/// Largest deviation of the modulus from an affine function of its germs, relative, that rounding explains.
const AFFINE: f64 = 1e-12;
/// Places between the ends of a germ at which that is looked at.
const PLACES: usize = 12;

/// Why no more outcomes were solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Those that were asked for are solved.
    Solved,
    /// The estimated truncation is down at the tolerance.
    Tolerance,
    /// The stochastic mesh has as many nodes as allowed.
    MaxNodes,
    /// Refinement does not lead to the tolerance.
    Rounds,
}

impl End {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Solved, Self::Tolerance, Self::MaxNodes, Self::Rounds];

    /// The word of the JSON object.
    pub fn word(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Tolerance => "tolerance",
            Self::MaxNodes => "max_nodes",
            Self::Rounds => "rounds",
        }
    }
}

/// A stochastic mesh and the answers at its nodes.
pub(crate) struct Surrogate {
    pub(crate) mesh: StochasticMesh,
    pub(crate) cells: Vec<Cell>,
    /// Whether the nodes of a cell are coupled.
    pub(crate) coupled: bool,
    /// (Σ of the squared errors)^½ over the mean energy norm.
    pub(crate) relative: f64,
    pub(crate) end: End,
    /// Points that were solved, those of cells that were refined later included.
    pub(crate) solved: usize,
}

/// A cell with its answers.
pub(crate) struct Cell {
    pub(crate) basis: CellBasis,
    pub(crate) answers: Vec<Answer>,
    pub(crate) errors: Vec<DirectionError>,
}

/// Whether the exact Galerkin equations couple the nodes of a cell and can be solved so: E is not affine in its germs, supports
/// hold the body, and there is neither a body force, a remote stress nor Coulomb friction. Others are solved node by node, which is collocation.
pub(crate) fn is_coupled(scene: &Scene, random: &Random) -> Result<bool, SceneError> {
    let galerkin = random.stochastic.method == Sampling::Galerkin && random.uses.young;
    let coulomb = |side: &Side| matches!(side.condition, Condition::Contact { friction: Friction::Coulomb(_), .. });
    let simple = scene.particular_solution(1.0).is_none() && !scene.sides.iter().any(coulomb);
    Ok(galerkin && simple && scene.unresisted(free_of_supports(scene)).is_empty() && !is_affine(scene, random)?)
}

/// Whether E is affine in each germ where the others are kept: then the Galerkin equations of the nodes decouple.
fn is_affine(scene: &Scene, random: &Random) -> Result<bool, SceneError> {
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
                Ok::<f64, SceneError>(scene.outcome(&germs)?.material.young)
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
    paths: &[String],
    watch: &Watch<'_>,
) -> Result<Surrogate, SolveError> {
    let settings = &random.stochastic;
    let variables = random.germs.iter().map(|g| g.variable.clone()).collect();
    let (elements, degree) = (vec![settings.elements; random.germs.len()], vec![settings.degree; random.germs.len()]);
    let mut mesh = StochasticMesh::uniform(variables, &elements, &degree)?;
    let mut cells: Vec<Option<Cell>> = Vec::new();
    let mut solved = 0;
    for round in 0.. {
        cells.resize_with(mesh.cells.len(), || None);
        let todo: Vec<usize> = (0..cells.len()).filter(|&c| cells[c].is_none()).collect();
        let bases: Vec<CellBasis> = todo.iter().map(|&c| mesh.basis(c, Nodes::Gauss)).collect::<Result<_, _>>()?;
        let answers = solve_cells(scene, outcomes, coupled, &bases, paths, watch)?;
        solved += answers.iter().map(Vec::len).sum::<usize>();
        for ((c, basis), answers) in todo.into_iter().zip(bases).zip(answers) {
            let errors = errors(outcomes, &basis, &answers);
            cells[c] = Some(Cell { basis, answers, errors });
        }
        let all: Vec<&Cell> = cells.iter().flatten().collect();
        let energy: f64 =
            all.iter().flat_map(|c| c.basis.weights.iter().zip(&c.answers)).map(|(w, a)| w * 2.0 * a.strain).sum();
        let squared: f64 = all.iter().flat_map(|c| &c.errors).map(|e| e.error).sum();
        let relative = if squared == 0.0 { 0.0 } else { (squared / energy).sqrt() };
        let nodes: usize = all.iter().map(|c| c.answers.len()).sum();
        let end = match () {
            () if !settings.refine => Some(End::Solved),
            () if relative <= settings.tolerance => Some(End::Tolerance),
            () if nodes >= settings.max_nodes => Some(End::MaxNodes),
            () if round == ROUNDS => Some(End::Rounds),
            () => None,
        };
        if let Some(end) = end {
            let cells = cells.into_iter().flatten().collect();
            return Ok(Surrogate { mesh, cells, coupled, relative, end, solved });
        }
        let marks: Vec<Vec<DirectionError>> = all.iter().map(|c| c.errors.clone()).collect();
        let at = |cell: usize, direction: usize| {
            let cell = all[cell];
            changes(&cell.basis, direction, &events(&cell.answers))
                .or_else(|| changes(&cell.basis, direction, &slips(&cell.answers)))
        };
        let changed = refine(&mut mesh, &marks, SHARE, &at)?;
        let known = cells.len();
        changed.into_iter().filter(|&c| c < known).for_each(|c| cells[c] = None);
    }
    unreachable!("the rounds are limited")
}

/// Answers at the nodes of the cells.
fn solve_cells(
    scene: &Scene,
    outcomes: &Outcomes<'_>,
    coupled: bool,
    bases: &[CellBasis],
    paths: &[String],
    watch: &Watch<'_>,
) -> Result<Vec<Vec<Answer>>, SolveError> {
    if coupled {
        let nominal = scene.material.young;
        let modulus = |germs: &[f64]| scene.outcome(germs).map_or(f64::NAN, |s| s.material.young / nominal);
        return bases
            .iter()
            .map(|basis| {
                watch.check()?;
                solve_cell(outcomes, basis, &modulus, paths, watch)
            })
            .collect();
    }
    let points: Vec<&Vec<f64>> = bases.iter().flat_map(|b| &b.points).collect();
    let done = AtomicUsize::new(0);
    let mut answers = solve_points(points.len(), |i, warm: &mut Option<Solution>| {
        watch.check()?;
        let answer = outcomes.answer(points[i], paths, warm);
        watch.tell(done.fetch_add(1, Ordering::Relaxed) + 1, points.len());
        answer
    })?
    .into_iter();
    Ok(bases.iter().map(|b| answers.by_ref().take(b.points.len()).collect()).collect())
}

/// Pressures below this part of the largest, and openings below this part of the displacements and gaps, are roundoff.
const ROUNDOFF: f64 = 1e-9;

/// λ_n where a condition is closed, less the opening in the scale of the pressures where it is open: changes sign where contact
/// does.
pub(crate) fn events(answers: &[Answer]) -> Vec<Vec<f64>> {
    differences(answers, &|a| &a.pressure, &|a| &a.opening)
}

/// F - |λ_t| where a condition sticks, less |u_t| in the scale of that where it slips: changes sign where stick does.
fn slips(answers: &[Answer]) -> Vec<Vec<f64>> {
    differences(answers, &|a| &a.reserve, &|a| &a.slip)
}

/// Two numbers of each condition of which one is 0, a stress and a length, as one function with the sign of that which is not.
fn differences(
    answers: &[Answer],
    stress: &dyn Fn(&Answer) -> &Vec<f64>,
    length: &dyn Fn(&Answer) -> &Vec<f64>,
) -> Vec<Vec<f64>> {
    let largest =
        |values: &dyn Fn(&Answer) -> &Vec<f64>| answers.iter().flat_map(values).fold(0.0, |m: f64, v| m.max(v.abs()));
    let beyond = |value: f64, scale: f64| if value > ROUNDOFF * scale { value } else { 0.0 };
    let stresses = largest(stress).max(largest(&|a| &a.pressure));
    let longest = largest(length);
    let lengths = longest.max(largest(&|a| &a.displacement));
    let open = beyond(longest, lengths);
    let scale = if open > 0.0 && stresses > 0.0 { stresses / open } else { 1.0 };
    let difference = |a: &Answer| {
        let both = stress(a).iter().zip(length(a));
        both.map(|(p, g)| beyond(*p, stresses) - scale * beyond(*g, lengths)).collect()
    };
    answers.iter().map(difference).collect()
}

/// The truncation of displacements and of stresses, whichever is larger: in the energy norms of the mean modulus.
fn errors(outcomes: &Outcomes<'_>, basis: &CellBasis, answers: &[Answer]) -> Vec<DirectionError> {
    let mean: f64 = answers.iter().map(|a| a.modulus).sum::<f64>() / answers.len() as f64;
    let (events, slips) = (events(answers), slips(answers));
    let kinked: Vec<bool> = (0..basis.degrees().len())
        .map(|d| changes(basis, d, &events).is_some() || changes(basis, d, &slips).is_some())
        .collect();
    let of = |value: &dyn Fn(&Answer) -> Vec<f64>, factor: f64| {
        truncation(basis, &answers.iter().map(value).collect::<Vec<_>>(), &kinked, &|u| {
            factor * outcomes.body.condensation.multiply(u).iter().zip(u).map(|(s, u)| s * u).sum::<f64>()
        })
    };
    let strains = of(&|a| a.displacement.clone(), mean);
    let stresses = of(&|a| a.stressed.clone(), 1.0 / mean);
    strains.into_iter().zip(stresses).map(|(a, b)| if b.error > a.error { b } else { a }).collect()
}
