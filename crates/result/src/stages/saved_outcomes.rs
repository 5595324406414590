//! All outcomes of random input, the bases and masses of stochastic cells, and the eigenpairs of random fields.

use faer::Mat;
use steklov_io::{
    File, Group, IoError, Rows, copy, create_group, invalid, label, load_dense, open_group, save, save_dense,
    save_integers, save_rows, save_text, save_vector,
};
use steklov_model::stochastic::{Answer, Modulus, OutcomeStage};
use steklov_problem::DataError;
use steklov_quadrature::gauss_legendre;
use steklov_stochastic::{CellBasis, Field, StochasticError};

use super::unlink;

const OUTCOMES: &str = "outcomes";
const CELLS: &str = "cells";
const EIGENPAIRS: &str = "eigenpairs";
/// Largest number of operations for which a mass matrix with the modulus is computed.
const WORK: f64 = 2e9;
/// Largest number of stored values of the modes of a field at points of integration: 160 MB.
const MODES: usize = 20_000_000;

/// Writes outcomes into `/stochastic`, block by block.
pub struct SavedOutcomes<'a> {
    file: &'a File,
    /// Tables of displacement, pressure and shear, and their number of outcomes.
    tables: Option<([Rows; 3], usize)>,
}

/// `/stochastic`, created if missing.
pub(crate) fn stochastic(file: &File) -> Result<Group, IoError> {
    if file.link_exists("stochastic") { open_group(file, "stochastic") } else { create_group(file, "stochastic") }
}

impl<'a> SavedOutcomes<'a> {
    /// No outcome yet.
    pub fn new(file: &'a File) -> Self {
        Self { file, tables: None }
    }

    /// Stores a stage of the outcomes.
    ///
    /// # Errors
    /// When the file cannot be written, or the modulus of an outcome is impossible.
    pub fn take(&mut self, stage: &OutcomeStage<'_>) -> Result<(), IoError> {
        match *stage {
            OutcomeStage::Begin(random) => {
                self.tables = None;
                let at = stochastic(self.file)?;
                [OUTCOMES, CELLS, EIGENPAIRS].iter().try_for_each(|name| unlink(&at, name))?;
                let expanded = random.fields().filter(|(field, _)| !field.expansion.is_drawn());
                for (k, (field, _)) in expanded.enumerate() {
                    let all = if k == 0 { create_group(&at, EIGENPAIRS)? } else { open_group(&at, EIGENPAIRS)? };
                    save_eigenpairs(&create_group(&all, &k.to_string())?, &field.name, &field.expansion)?;
                }
                Ok(())
            }
            OutcomeStage::Answers { first, count, answers } => self.push(first, count, answers),
            OutcomeStage::Cells { bases, modulus } => {
                let at = create_group(&stochastic(self.file)?, CELLS)?;
                for (k, basis) in bases.iter().enumerate() {
                    save_cell(&create_group(&at, &format!("{k:05}"))?, basis, modulus)?;
                }
                Ok(())
            }
        }
    }

    /// Stores the next outcomes.
    fn push(&mut self, first: usize, count: usize, answers: &[Answer]) -> Result<(), IoError> {
        let Some(answer) = answers.first() else { return Ok(()) };
        if first == 0 {
            let at = create_group(&stochastic(self.file)?, OUTCOMES)?;
            let begin = |name, unit, meaning: &str, axis, columns| {
                let meaning = format!("{meaning} of the outcome at /stochastic/points, of weight /stochastic/weights");
                save_rows(&at, name, [count, columns], &label(unit, &meaning, &["point", axis]))
            };
            let unknown = "displacement unknown: nodes in the order of /solution/points, component fastest";
            let condition = "contact condition, in the order of /contact";
            let tables = [
                begin("displacement", "length", "nodal displacement", unknown, answer.displacement.len())?,
                begin("pressure", "stress", "lambda_n", condition, answer.pressure.len())?,
                begin("shear", "stress", "lambda_t", condition, answer.shear.len())?,
            ];
            self.tables = Some((tables, 0));
        }
        let Some((tables, stored)) = &mut self.tables else {
            return Err(invalid(self.file, "stochastic", "outcomes before the first one"));
        };
        for answer in answers {
            let parts = [&answer.displacement, &answer.pressure, &answer.shear];
            tables.iter_mut().zip(parts).try_for_each(|(table, part)| table.push(part))?;
        }
        *stored += answers.len();
        if *stored == count
            && let Some((tables, _)) = self.tables.take()
        {
            tables.into_iter().try_for_each(Rows::finish)?;
        }
        Ok(())
    }
}

/// Points with weights at which the modes of a field are stored: Gauss points of a side or of the rectangle around the body, or
/// the middles of its cells.
fn mode_points(field: &Field) -> (Vec<Vec<f64>>, Vec<f64>) {
    if let Some(cells) = field.cells() {
        let middle =
            |c: usize| [0, 1].map(|k| cells.size[k] * ([c / cells.cells[1], c % cells.cells[1]][k] as f64 + 0.5));
        return cells.body().into_iter().map(|c| (middle(c).to_vec(), cells.area())).unzip();
    }
    let rule = gauss_legendre(32 + 4 * field.len().min(100));
    let sides = field.sides();
    let mut points = vec![(vec![], 1.0)];
    for side in &sides {
        let rule = rule.mapped(0.0, *side);
        let along = |(x, w): &(Vec<f64>, f64)| -> Vec<(Vec<f64>, f64)> {
            let next = rule.points.iter().zip(&rule.weights);
            next.map(|(t, v)| ([&x[..], &[*t]].concat(), w * v)).collect()
        };
        points = points.iter().flat_map(along).collect();
    }
    points.into_iter().unzip()
}

/// Modes of a field and where they are.
fn save_eigenpairs(at: &Group, name: &str, field: &Field) -> Result<(), IoError> {
    let (points, weights) = mode_points(field);
    save_text(at, "name", name, "name of the random field")?;
    if let Some(cells) = field.cells() {
        let meaning = "numbers of cells along x and y, in each of which the field is constant";
        save_integers(at, "cells", &cells.cells, &label("1", meaning, &["axis"]))?;
    }
    let meaning = "lambda_m of the covariance, falling";
    save_vector(at, "eigenvalues", &field.eigenvalues(), &label("length^d", meaning, &["mode"]))?;
    if points.len() * field.len() > MODES {
        return save_text(at, "left_out", "modes: too many at too many points", "what is not stored, and why");
    }
    let table = Mat::from_fn(points.len(), field.sides().len(), |i, j| points[i][j]);
    let meaning = "points of integration: arc length along the side, or places in the rectangle around the body";
    save_dense(at, "points", table.as_ref(), &label("length", meaning, &["point", "component"]))?;
    save_vector(at, "weights", &weights, &label("length^d", "their weights w", &["point"]))?;
    let modes: Vec<Vec<f64>> = points.iter().map(|p| field.modes([p[0], p.get(1).copied().unwrap_or(0.0)])).collect();
    let table = Mat::from_fn(points.len(), field.len(), |i, j| modes[i][j]);
    let meaning = "phi_m = lambda_m^(1/2) b_m: sum over the points of w phi_m phi_n = lambda_m delta_mn; the field is \
                   sum of phi_m germ_m";
    save_dense(at, "modes", table.as_ref(), &label("1", meaning, &["point", "mode"]))
}

/// The basis of a cell, its mass matrices and their quadrature.
fn save_cell(at: &Group, basis: &CellBasis, modulus: Option<&Modulus<'_>>) -> Result<(), IoError> {
    let failed = |name: &str, e: &StochasticError| invalid(at, name, e.to_string());
    save(at, "basis", basis)?;
    let axes = basis.mass_axes().map_err(|e| failed("basis", &e))?;
    for (d, (rule, values)) in axes.iter().enumerate() {
        let axis = create_group(at, &format!("axis_{d}"))?;
        let point = &["point of the axis"];
        save_vector(&axis, "points", &rule.points, &label("of the germ", "points of integration", point))?;
        let meaning = "their weights, sum the probability of the cell in this germ";
        save_vector(&axis, "weights", &rule.weights, &label("1", meaning, point))?;
        let meaning =
            "Lagrange polynomials of the nodes of the axis; theta_j is their product over the axes, last axis fastest";
        save_dense(&axis, "values", values.as_ref(), &label("1", meaning, &["point of the axis", "node of the axis"]))?;
    }
    let (n, count) = (basis.points.len() as f64, axes.iter().map(|(rule, _)| rule.len() as f64).product::<f64>());
    if n * n * count > WORK {
        let why = "mass, M_E and modulus: they take the square of the nodes times the points of integration";
        return save_text(at, "left_out", why, "what is not stored, and why");
    }
    let nodes = &["node", "node"];
    let mass = basis.mass(&|_| 1.0).map_err(|e| failed("mass", &e))?;
    let meaning = "M_jk = int theta_j theta_k d rho = sum of the products of the axes' weights times theta_j theta_k; \
                   diagonal with D_j = basis/weights of Gauss nodes";
    save_dense(at, "mass", mass.as_ref(), &label("1", meaning, nodes))?;
    let Some(modulus) = modulus else { return Ok(()) };
    let values = all_points(&axes).iter().map(|germ| modulus(germ)).collect::<Result<Vec<f64>, DataError>>();
    let values = values.map_err(|e| invalid(at, "modulus", e.to_string()))?;
    let meaning = "E over that of the mean input at the products of the axes' points, those of the last axis fastest";
    save_vector(at, "modulus", &values, &label("1", meaning, &["point"]))?;
    let of_germ = |germ: &[f64]| modulus(germ).unwrap_or(f64::NAN);
    let mass = basis.mass(&of_germ).map_err(|e| failed("M_E", &e))?;
    let meaning = "(M_E)_jk = int E/E_0 theta_j theta_k d rho = sum of the products of the axes' weights times modulus theta_j theta_k";
    save_dense(at, "M_E", mass.as_ref(), &label("1", meaning, nodes))
}

/// Tensor product of the points of the axes; the last axis runs fastest.
fn all_points(axes: &[(steklov_quadrature::Rule, Mat<f64>)]) -> Vec<Vec<f64>> {
    axes.iter().fold(vec![vec![]], |points, (rule, _)| {
        let next = |x: &Vec<f64>| -> Vec<Vec<f64>> { rule.points.iter().map(|t| [&x[..], &[*t]].concat()).collect() };
        points.iter().flat_map(next).collect()
    })
}

/// Copies the saved outcomes from another file if this file has none, but the same points and as many steps.
///
/// # Errors
/// When one of the files cannot be read or written.
pub fn copy_outcomes(from: &File, file: &File) -> Result<(), IoError> {
    const NAME: &str = "stochastic";
    let steps = |file: &File| open_group(file, "steps").map(|steps| steps.len());
    if !from.link_exists(NAME) || !file.link_exists(NAME) || steps(from)? != steps(file)? {
        return Ok(());
    }
    let (old, new) = (open_group(from, NAME)?, open_group(file, NAME)?);
    if load_dense(&old, "points")? != load_dense(&new, "points")? {
        return Ok(());
    }
    let missing = |name: &&str| old.link_exists(name) && !new.link_exists(name);
    [OUTCOMES, CELLS, EIGENPAIRS].iter().filter(|name| missing(name)).try_for_each(|name| copy(&old, name, &new))
}
