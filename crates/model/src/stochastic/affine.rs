//! All outcomes of a grid at once, where the moduli are affine in the germs: polynomials of total degree p from one system.
//!
//! ```text
//! E(ξ) ─► K_0, K_1, .. ─► u_a of binomial(d + p, p) polynomials ψ_a ─► of each number q its q_a: q(ξ) = Σ_a q_a ψ_a(ξ)
//! mean q_0, variance Σ_(a ≠ 0) q_a², effects; quantiles from samples of the polynomials; error from their decay and from outcomes
//! ```

use rayon::prelude::*;
use steklov_msfem::{Grid, HeterogeneousBody};
use steklov_problem::{AffineModuli, Random, Scene, Stochastic};
use steklov_stochastic::{Coupled, Moments, Points, TotalDegree, Variable, density, quantiles, sample, smolyak};

use super::check::{STREAM, wanted};
use super::in_body::BodyMoments;
use super::number::Number;
use super::on_grid::{OutcomesOnGrid, numbers_of};
use super::outcomes::Answer;
use super::result::{BINS, BLOCK, Cells, End, KEPT, OVERLOOKED, StochasticResult, bounds, of_grid};
use super::spread::is_rounding;
use super::unseen::SAFETY;
use super::watch::OutcomesWatch;
use crate::error::SolveError;
use crate::grid::{AffineGrid, GridLayout, OfBlock};

/// Residual of the equations, relative: spreads above 1e-10 are taken for real.
const SOLVED: f64 = 1e-12;
/// Most fresh outcomes beside the polynomials.
const FRESH: usize = 16;
/// Blocks whose fields are held at a time.
const TOGETHER: usize = 32;
/// The degree from which on a tolerance is sought: of the one before, no fall of the degrees is known.
const FIRST: usize = 2;
/// The highest degree that is tried, and the most polynomials.
const HIGHEST: usize = 64;
const POLYNOMIALS: f64 = 1e6;
/// Most coefficients of displacements that a degree is raised to: four gigabytes, with the directions of the solver.
const MEMORY: f64 = 1e8;
/// A loss of moduli is not taken as nearer to 1.
const SLOWEST: f64 = 1.0 - 1e-8;

/// The scene and what it asks for.
pub(super) struct Asked<'a> {
    pub(super) outcomes: &'a OutcomesOnGrid<'a>,
    pub(super) random: &'a Random,
    pub(super) layout: &'a GridLayout,
    pub(super) numbers: &'a [Number],
    /// The largest nominal value of those of one scale with each number.
    pub(super) scales: &'a [f64],
}

/// The polynomials of everything that is told.
struct Polynomials {
    basis: TotalDegree,
    /// Coefficients of each quantity.
    quantities: Vec<Vec<f64>>,
    /// u_a of all fine unknowns, one after the other.
    blocks: Vec<f64>,
    /// That of the boundary.
    boundary: Vec<Vec<f64>>,
    /// u_aᵀ K_0 u_a.
    energies: Vec<f64>,
    in_body: BodyMoments,
    iterations: usize,
}

/// A fresh outcome: its germs, quantities, displacement, and the body of its moduli.
struct Fresh {
    germs: Vec<f64>,
    quantities: Vec<f64>,
    displacement: Vec<f64>,
    body: HeterogeneousBody,
}

impl Fresh {
    fn solved(asked: &Asked<'_>, germs: Vec<f64>) -> Result<Self, SolveError> {
        let (scene, solved) = asked.outcomes.solve(&germs)?;
        let quantities = numbers_of(&scene, &solved, asked.numbers).quantities;
        Ok(Self { germs, quantities, displacement: solved.displacement, body: solved.body })
    }
}

/// What the polynomials leave out.
struct Truncation {
    /// Of each quantity, root mean square.
    quantities: Vec<f64>,
    /// Of the displacement over its size, in the energy norm and in mean square: estimated, and as fresh outcomes show it.
    estimated: f64,
    measured: f64,
}

/// Solves for all outcomes at once and gathers their statistics.
///
/// *Use when*: few bounded germs, of which E is an affine function, and a relative error of the variance below 1e-3. *Cost*: 10
/// to 25 back substitutions for each of the binomial(d + p, p) polynomials, and some fresh outcomes.
///
/// # Errors
/// Moduli that some outcome makes 0 or negative; an outcome that cannot be solved; [`SolveError::Interrupted`].
pub(super) fn of_affine(
    asked: &Asked<'_>,
    grid: &Grid,
    watch: &OutcomesWatch<'_>,
) -> Result<StochasticResult, SolveError> {
    let (scene, settings) = (&asked.outcomes.scene, &asked.random.stochastic);
    let variables: Vec<Variable> = asked.random.germs.iter().map(|g| g.variable.clone()).collect();
    let moduli = scene.affine_moduli(asked.random, grid)?;
    let means: Vec<f64> = variables.iter().map(Variable::mean).collect();
    let mean = scene.outcome(&means)?;
    let equations = AffineGrid::new(&mean, asked.layout, &moduli)?;
    let mut degree = if settings.of_deviation { FIRST } else { settings.degree };
    let (mut fresh, ends) = (Vec::new(), at_ends(asked, &variables, watch)?);
    let (polynomials, truncation, end) = loop {
        watch.check()?;
        let basis = TotalDegree::new(&variables, degree)?;
        let polynomials = polynomials(asked, basis, (&equations, &moduli), &variables, watch)?;
        draw(&mut fresh, polynomials.energies.len(), asked, &variables, watch)?;
        let truncation = polynomials.truncation(&fresh, &ends, moduli.largest_loss);
        if let Some(end) = polynomials.end(&truncation, asked) {
            break (polynomials, truncation, end);
        }
        degree += 1;
    };
    let points = points(&variables, degree, settings.max_nodes)?;
    let mut result = polynomials.at_points(asked, points, (&moduli, grid))?;
    polynomials.add_samples(scene, asked.random, &variables, &mut result, watch)?;
    polynomials.add_truncation(settings, &variables, &truncation, &mut result);
    (result.checks, result.end) = (fresh.len() + 2 * ends.len(), end);
    Ok(result)
}

/// The points of the sparse grid of the degree, whose rule gives means and variances of the polynomials, or of the highest level
/// below it with as few points as are allowed.
fn points(variables: &[Variable], degree: usize, most: usize) -> Result<Points, SolveError> {
    for level in (1..=degree).rev() {
        match smolyak(variables, level) {
            Ok(grid) if grid.points.len() <= most => return Ok(grid),
            _ => {}
        }
    }
    Ok(smolyak(variables, 0)?)
}

fn polynomials(
    asked: &Asked<'_>,
    basis: TotalDegree,
    (equations, moduli): (&AffineGrid<'_>, &AffineModuli),
    variables: &[Variable],
    watch: &OutcomesWatch<'_>,
) -> Result<Polynomials, SolveError> {
    let solved = equations.solve(&basis, SOLVED)?;
    let (count, n) = (basis.degrees().len(), solved.blocks.len() / basis.degrees().len());
    let rows: Vec<Vec<Coupled>> = basis.products();
    let mut made = Polynomials {
        quantities: vec![Vec::with_capacity(count); asked.numbers.len()],
        boundary: Vec::with_capacity(count),
        energies: Vec::with_capacity(count),
        in_body: BodyMoments::default(),
        iterations: solved.iterations,
        blocks: solved.blocks,
        basis,
    };
    for first in (0..count).step_by(TOGETHER) {
        watch.check()?;
        let part = first..count.min(first + TOGETHER);
        let of = |a: usize| equations.of_block(&made.basis, &rows[a], &made.blocks, a);
        let all: Vec<OfBlock> = part.clone().into_par_iter().map(of).collect();
        for (a, OfBlock { figures, stress, energy, boundary }) in part.zip(all) {
            made.quantities.iter_mut().zip(asked.numbers).for_each(|(q, number)| q.push(number.of(&figures)));
            made.energies.push(energy);
            made.boundary.push(boundary);
            add_square(&mut made.in_body.displacement, a, &made.blocks[a * n..(a + 1) * n]);
            add_square(&mut made.in_body.stress, a, &stress);
        }
        watch.tell(first + TOGETHER.min(count - first), count);
    }
    let cells: Vec<usize> = equations.body.grid.body_cells().collect();
    let deviations: Vec<f64> = variables.iter().map(|v| v.variance().sqrt()).collect();
    let square = |c: usize| moduli.parts[1..].iter().zip(&deviations).map(|(e, d)| (e[c] * d).powi(2)).sum();
    made.in_body.young.mean = cells.iter().map(|&c| moduli.parts[0][c]).collect();
    made.in_body.young.variance = cells.iter().map(|&c| square(c)).collect();
    Ok(made)
}

/// Takes the coefficients of ψ_a: the first ones are means.
fn add_square(moments: &mut Moments, a: usize, values: &[f64]) {
    if a == 0 {
        *moments = Moments { mean: values.to_vec(), variance: vec![0.0; values.len()] };
        return;
    }
    moments.variance.iter_mut().zip(values).for_each(|(sum, v)| *sum += v * v);
}

impl Polynomials {
    /// Σ_a c_a ψ_a.
    fn value(&self, psi: &[f64], coefficients: &[f64]) -> f64 {
        psi.iter().zip(coefficients).map(|(p, c)| p * c).sum()
    }

    /// Σ_a ψ_a v_a of vectors.
    fn field<'b>(&self, psi: &[f64], vectors: impl Iterator<Item = &'b [f64]>) -> Vec<f64> {
        let mut sum = Vec::new();
        for (p, v) in psi.iter().zip(vectors) {
            sum.resize(v.len(), 0.0);
            sum.iter_mut().zip(v).for_each(|(s, v)| *s += p * v);
        }
        sum
    }

    /// The values at points, and the moments from the coefficients.
    fn at_points(
        &self,
        asked: &Asked<'_>,
        Points { points, weights }: Points,
        (moduli, grid): (&AffineModuli, &Grid),
    ) -> Result<StochasticResult, SolveError> {
        let cells: Vec<usize> = grid.body_cells().collect();
        let means: Vec<f64> =
            moduli.parts.iter().map(|e| cells.iter().map(|&c| e[c]).sum::<f64>() / cells.len() as f64).collect();
        let keeps = points.len() * self.boundary[0].len() <= KEPT;
        let answer = |germs: &Vec<f64>| {
            let psi = self.basis.values(germs);
            let off = germs.iter().enumerate().map(|(m, xi)| (xi - self.basis.germ(m)[0]) * means[m + 1]);
            let displacement = match keeps {
                true => self.field(&psi, self.boundary.iter().map(Vec::as_slice)),
                false => Vec::new(),
            };
            let quantities = self.quantities.iter().map(|q| self.value(&psi, q)).collect();
            Answer {
                modulus: means[0] + off.sum::<f64>(),
                displacement,
                quantities,
                converged: true,
                ..Answer::default()
            }
        };
        let answers: Vec<Answer> = points.par_iter().map(answer).collect();
        let mut result = of_grid(points, weights, &answers, asked.numbers)?;
        if !keeps {
            result.displacements = Vec::new();
        }
        self.boundary.iter().enumerate().for_each(|(a, u)| add_square(&mut result.displacement, a, u));
        result.in_body = Some(self.in_body.clone());
        for (quantity, coefficients) in result.quantities.iter_mut().zip(&self.quantities) {
            quantity.mean = coefficients[0];
            quantity.variance = coefficients[1..].iter().map(|c| c * c).sum();
            quantity.effects = (quantity.variance > 0.0).then(|| self.basis.effects(coefficients));
        }
        (result.solved, result.iterations, result.coupled) = (self.basis.degrees().len(), self.iterations, true);
        Ok(result)
    }

    /// Quantiles and densities from samples of the polynomials.
    fn add_samples(
        &self,
        scene: &Scene,
        random: &Random,
        variables: &[Variable],
        result: &mut StochasticResult,
        watch: &OutcomesWatch<'_>,
    ) -> Result<(), SolveError> {
        let (settings, count) = (&random.stochastic, random.stochastic.samples);
        let mut samples = vec![Vec::with_capacity(count); self.quantities.len()];
        let at = |i: usize| -> Vec<f64> {
            let psi = self.basis.values(&sample(variables, settings.seed, i as u64));
            self.quantities.iter().map(|q| self.value(&psi, q)).collect()
        };
        for first in (0..count).step_by(BLOCK) {
            watch.check()?;
            let block: Vec<Vec<f64>> = (first..count.min(first + BLOCK)).into_par_iter().map(at).collect();
            block.into_iter().for_each(|one| samples.iter_mut().zip(one).for_each(|(all, v)| all.push(v)));
        }
        let equal = vec![1.0; count];
        for (quantity, samples) in result.quantities.iter_mut().zip(&mut samples) {
            let [low, high] = bounds(scene, &quantity.name);
            samples.iter_mut().for_each(|v| *v = v.clamp(low, high));
            quantity.quantiles = Some(quantiles(samples, &equal, &settings.quantiles)?);
            quantity.density = density(samples, &equal, BINS).ok(); // none of a constant
        }
        Ok(())
    }

    /// Σ of the squares of each total degree.
    fn by_degree(&self, squares: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut sums = vec![0.0; self.basis.degree() + 1];
        self.basis.totals().zip(squares).for_each(|(k, square)| sums[k] += square);
        sums
    }

    /// Mean squares of what fresh outcomes show to be left out: of each quantity, and of the displacement over its own.
    fn measured(&self, fresh: &[Fresh]) -> (Vec<f64>, f64) {
        let n = self.blocks.len() / self.energies.len();
        let of = |one: &Fresh| {
            let psi = self.basis.values(&one.germs);
            let foreseen = self.quantities.iter().map(|q| self.value(&psi, q));
            let squares: Vec<f64> = one.quantities.iter().zip(foreseen).map(|(v, f)| (v - f).powi(2)).collect();
            let mut off = self.field(&psi, self.blocks.chunks(n));
            off.iter_mut().zip(&one.displacement).for_each(|(e, u)| *e -= u);
            (squares, one.body.energy(&off, &off), one.body.energy(&one.displacement, &one.displacement))
        };
        let all: Vec<(Vec<f64>, f64, f64)> = fresh.par_iter().map(of).collect();
        let (error, size) = all.iter().fold((0.0, 0.0), |(error, size), one| (error + one.1, size + one.2));
        let square = |k: usize| all.iter().map(|(squares, ..)| squares[k]).sum::<f64>() / fresh.len() as f64;
        let relative = if size > 0.0 { (error / size).max(0.0) } else { 0.0 };
        ((0..self.quantities.len()).map(square).collect(), relative)
    }

    /// Mean squares of what the ends of the germs show to be left out of each quantity. With e = ψ_(p+1) A/(1 + c x) there, of one
    /// germ, c from the errors at both ends and at most the loss: E e² = A² (1 - c²)^(-3/2). Where moduli nearly vanish in a small
    /// part of the body, few outcomes and no coefficient of a low degree show it.
    fn at_ends(&self, ends: &[[Fresh; 2]], loss: f64) -> Vec<f64> {
        let mut squares = vec![0.0; self.quantities.len()];
        for (m, both) in ends.iter().enumerate() {
            let psi = [0, 1].map(|k| self.basis.values(&both[k].germs));
            let highest = self.basis.degrees().iter().position(|a| a[m] == self.basis.degree());
            for (k, square) in squares.iter_mut().enumerate() {
                let off = [0, 1].map(|e| (both[e].quantities[k] - self.value(&psi[e], &self.quantities[k])).abs());
                let (less, more) = (off[0].min(off[1]), off[0].max(off[1]));
                if more > 0.0 {
                    let c = ((more - less) / (more + less)).min(loss.min(SLOWEST));
                    let polynomial = highest.map_or(1.0, |a| psi[usize::from(off[1] > off[0])][a].abs());
                    *square += (more * (1.0 - c) / polynomial).powi(2) * (1.0 - c * c).powf(-1.5);
                }
            }
        }
        squares
    }

    /// What is left out, by T_p, the root mean square of the coefficients of degree p, or by fresh outcomes or the ends of the germs if
    /// they show more; half as much again.
    ///
    /// The equations of degree p give T_p = c/2 T_(p-1) for moduli 1 + c x, x in [-1, 1], and what is left out solves K(ξ) e = r
    /// with r = c/2 T_p ψ_(p+1): E e² = (c/2)² T_p² E ψ²_(p+1)/(1 + c x)², which tends to (c/2)² T_p² (1 - c²)^(-3/2). Several
    /// germs have the c of the last two degrees, which is at most the loss of the moduli.
    fn truncation(&self, fresh: &[Fresh], ends: &[[Fresh; 2]], loss: f64) -> Truncation {
        let p = self.basis.degree();
        let energies = self.by_degree(self.energies.iter().copied());
        let total: f64 = energies.iter().sum();
        let most = 0.5 * loss.min(SLOWEST);
        let fall = |above: f64, below: f64| if below > 0.0 { (above / below).sqrt().min(most) } else { 0.0 };
        let ratio = if p == 0 { most } else { fall(energies[p], energies[p - 1]) };
        let rest = ratio * (1.0 - 4.0 * ratio * ratio).powf(-0.75);
        let (mut squares, relative) = self.measured(fresh);
        squares.iter_mut().zip(self.at_ends(ends, loss)).for_each(|(square, at_ends)| *square = square.max(at_ends));
        let of = |(coefficients, squared): (&Vec<f64>, f64)| {
            let parts = self.by_degree(coefficients.iter().map(|c| c * c));
            // degrees of symmetric quantities alternate
            let before = if p > 1 { ratio * parts[p - 1].sqrt() } else { 0.0 };
            SAFETY * (parts[p].sqrt().max(before) * rest).max(squared.sqrt())
        };
        Truncation {
            quantities: self.quantities.iter().zip(squares).map(of).collect(),
            estimated: if total > 0.0 { SAFETY * rest * (energies[p] / total).sqrt() } else { 0.0 },
            measured: relative.sqrt(),
        }
    }

    /// Why no higher degree is solved, if none is: the degree is given, the means have the tolerance, or the next degree is too
    /// high or has too many polynomials.
    fn end(&self, truncation: &Truncation, asked: &Asked<'_>) -> Option<End> {
        let settings = &asked.random.stochastic;
        if !settings.of_deviation {
            return Some(End::Solved);
        }
        let varying = (self.energies[1..].iter().sum::<f64>() / self.energies[0].max(f64::MIN_POSITIVE)).sqrt();
        let allowed = settings.tolerance / (2.0 * varying).max(1.0);
        let mut all = self.quantities.iter().zip(&truncation.quantities).zip(asked.scales);
        if all.all(|((q, left_out), scale)| is_reached(q, *left_out, allowed, *scale)) {
            return Some(End::Tolerance);
        }
        let (p, d, count) = (self.basis.degree(), self.basis.degrees()[0].len(), self.energies.len() as f64);
        if p == HIGHEST {
            return Some(End::Rounds);
        }
        let growth = (d + p + 1) as f64 / (p + 1) as f64;
        let most = POLYNOMIALS.min(settings.max_nodes as f64);
        (count * growth > most || self.blocks.len() as f64 * growth > MEMORY).then_some(End::MaxNodes)
    }

    /// Adds what is left out, and the degree.
    fn add_truncation(
        &self,
        settings: &Stochastic,
        variables: &[Variable],
        truncation: &Truncation,
        result: &mut StochasticResult,
    ) {
        let (p, energies) = (self.basis.degree(), self.by_degree(self.energies.iter().copied()));
        for (quantity, left_out) in result.quantities.iter_mut().zip(&truncation.quantities) {
            quantity.truncation = Some(*left_out);
        }
        let share = |m: usize| {
            let of_germ = self.basis.degrees().iter().zip(self.basis.totals()).zip(&self.energies);
            let highest = of_germ.filter(|((_, k), _)| *k == p && p > 0);
            highest.map(|((a, _), e)| a[m] as f64 / p as f64 * e).sum::<f64>() / energies[p].max(f64::MIN_POSITIVE)
        };
        let Truncation { estimated, measured, .. } = *truncation;
        result.truncation = Some(estimated.max(measured));
        result.truncation_measured = Some(measured);
        result.truncation_by_germ = (0..variables.len()).map(|m| share(m) * estimated * estimated).collect();
        result.overlooked = measured > OVERLOOKED * estimated.max(settings.tolerance);
        let end = |k: usize| vec![variables.iter().map(|v| v.germ_support()[k]).collect()];
        result.cells = Some(Cells { low: end(0), high: end(1), degree: vec![vec![p; variables.len()]] });
    }
}

/// Whether (truncation/deviation)² of a quantity with these coefficients is allowed. By the orthogonality of Galerkin's equations
/// the error of its mean is the product of what the polynomials of the solution and of the quantity's dual leave out, in the
/// norm of K(ξ) ≤ 2 K_0: 2 V (truncation/deviation)² of the deviation for a solution that varies by V times its mean.
fn is_reached(coefficients: &[f64], left_out: f64, allowed: f64, scale: f64) -> bool {
    let variance: f64 = coefficients[1..].iter().map(|c| c * c).sum();
    is_rounding(variance.sqrt(), scale.max(coefficients[0].abs())) || left_out * left_out <= allowed * variance
}

/// The outcomes at both ends of each germ, the others at their means.
fn at_ends(
    asked: &Asked<'_>,
    variables: &[Variable],
    watch: &OutcomesWatch<'_>,
) -> Result<Vec<[Fresh; 2]>, SolveError> {
    let means: Vec<f64> = variables.iter().map(Variable::mean).collect();
    let at = |m: usize, end: usize| {
        watch.check()?;
        let mut germs = means.clone();
        germs[m] = variables[m].germ_support()[end];
        Fresh::solved(asked, germs)
    };
    (0..variables.len()).into_par_iter().map(|m| Ok([at(m, 0)?, at(m, 1)?])).collect()
}

/// Draws fresh outcomes beside `count` polynomials, as many as they need.
fn draw(
    fresh: &mut Vec<Fresh>,
    count: usize,
    asked: &Asked<'_>,
    variables: &[Variable],
    watch: &OutcomesWatch<'_>,
) -> Result<(), SolveError> {
    let settings = &asked.random.stochastic;
    let one = |i: usize| {
        watch.check()?;
        Fresh::solved(asked, sample(variables, settings.seed ^ STREAM, i as u64))
    };
    let more: Result<Vec<Fresh>, SolveError> =
        (fresh.len()..wanted(settings, count).min(FRESH)).into_par_iter().map(one).collect();
    fresh.extend(more?);
    Ok(())
}
