//! Condensed contact problems, their solvers and their judge.

use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use steklov_algebra::faer::Mat;
use steklov_contact::{
    Condition, ContactNode, Outcome, Problem, Solution, Start, Status, active_set, contraction, fixed_point,
    interior_point, kkt, newton, uzawa,
};

use crate::blocks::{array, failed, unknown, work, wrong};

/// S u + Bᵀλ = f with the conditions at the nodes.
#[pyclass(frozen)]
pub struct ContactProblem(Problem);

#[pymethods]
impl ContactProblem {
    /// Node i has `unknowns[i]` of them, 1 or 2. Condition k belongs to node `node[k]`, rising, and has a row of `conditions`:
    /// normal (2), tangent (2), weights (2), gap, offset of the slip, bound, coefficient.
    #[new]
    fn new(
        py: Python<'_>,
        stiffness: PyReadonlyArray2<'_, f64>,
        load: Vec<f64>,
        unknowns: Vec<usize>,
        node: Vec<usize>,
        conditions: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Self> {
        let (stiffness, rows) = (stiffness.as_array(), conditions.as_array());
        let (m, columns) = stiffness.dim();
        let all = unknowns.iter().try_fold(0usize, |sum, &n| (1..=2).contains(&n).then_some(sum + n));
        if m == 0 || all != Some(m) {
            return Err(wrong(py, format!("unknowns are not those of {m} rows: each node has 1 or 2, together {m}")));
        }
        if rows.dim() != (node.len(), 10) {
            return Err(wrong(py, format!("{:?} numbers of {} conditions: each has 10", rows.dim(), node.len())));
        }
        let mut first = 0;
        let mut own = |unknowns: usize| {
            first += unknowns;
            ContactNode { first: first - unknowns, unknowns, conditions: vec![] }
        };
        let mut nodes: Vec<ContactNode> = unknowns.into_iter().map(&mut own).collect();
        for (k, &i) in node.iter().enumerate() {
            if i >= nodes.len() || k > 0 && i < node[k - 1] {
                let what = format!("node[{k}] is {i}: nodes count from 0 below {} and rise", nodes.len());
                return Err(wrong(py, what));
            }
            let c = rows.row(k);
            nodes[i].conditions.push(Condition {
                normal: [c[0], c[1]],
                tangent: [c[2], c[3]],
                normal_weight: c[4],
                tangent_weight: c[5],
                gap: c[6],
                slip_offset: c[7],
                bound: c[8],
                coefficient: c[9],
            });
        }
        let stiffness = Mat::from_fn(m, columns, |i, j| stiffness[[i, j]]).into();
        let problem = Problem { stiffness, load, nodes };
        work(py, || problem.check().map(|()| problem))?.map(Self).map_err(|error| failed(py, error))
    }

    /// The answer of a solver, from a start where it takes one, with a step where it has one.
    fn solve(
        &self,
        py: Python<'_>,
        solver: &str,
        start: Option<(Vec<f64>, Vec<[f64; 2]>)>,
        step: Option<f64>,
    ) -> PyResult<Answer> {
        let solved = work(py, || {
            let start = start.as_ref().map(|(displacement, multipliers)| Start { displacement, multipliers });
            Some(match solver {
                "interior-point" => interior_point(&self.0),
                "newton" => newton(&self.0, start),
                "active-set" => active_set(&self.0, start),
                "uzawa" => uzawa(&self.0, step, start),
                "fixed-point" => fixed_point(&self.0, start),
                _ => return None,
            })
        })?;
        let Some(solved) = solved else { return Err(unknown(py, "solver", solver)) };
        solved.map(Answer).map_err(|error| failed(py, error))
    }

    /// The judge's measures of a displacement and multipliers, whatever computed them.
    fn kkt<'py>(
        &self,
        py: Python<'py>,
        displacement: Vec<f64>,
        multipliers: Vec<[f64; 2]>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let solution = self.candidate(py, displacement, multipliers)?;
        let judged = work(py, || kkt(&self.0, &solution))?;
        let measures = PyDict::new(py);
        measures.set_item("equilibrium", judged.equilibrium)?;
        measures.set_item("penetration", judged.penetration)?;
        measures.set_item("tension", judged.tension)?;
        measures.set_item("complementarity", judged.complementarity)?;
        measures.set_item("friction", judged.friction)?;
        measures.set_item("worst", judged.worst())?;
        Ok(measures)
    }

    /// ½ vᵀSv - fᵀv and the work of friction.
    fn energy(&self, py: Python<'_>, displacement: Vec<f64>, multipliers: Vec<[f64; 2]>) -> PyResult<f64> {
        let solution = self.candidate(py, displacement, multipliers)?;
        work(py, || self.0.energy(&solution.displacement, &solution.multipliers))
    }

    /// The contraction of the fixed point at an answer: the largest modulus of an eigenvalue, the largest positive real one.
    fn contraction(&self, py: Python<'_>, answer: &Bound<'_, Answer>) -> PyResult<(f64, f64)> {
        let answer = &answer.get().0;
        let found = work(py, || contraction(&self.0, answer))?.map_err(|error| failed(py, error))?;
        Ok((found.factor, found.real))
    }
}

impl ContactProblem {
    fn candidate(&self, py: Python<'_>, displacement: Vec<f64>, multipliers: Vec<[f64; 2]>) -> PyResult<Solution> {
        let conditions: usize = self.0.nodes.iter().map(|node| node.conditions.len()).sum();
        if displacement.len() != self.0.load.len() || multipliers.len() != conditions {
            let (v, l, m) = (displacement.len(), multipliers.len(), self.0.load.len());
            let what = format!(
                "{v} displacements and {l} multipliers: the problem has {m} unknowns and {conditions} conditions"
            );
            return Err(wrong(py, what));
        }
        let (status, outcome) = (vec![Status::Apart; conditions], Outcome::Converged);
        Ok(Solution { displacement, multipliers, status, iterations: 0, outcome, history: vec![] })
    }
}

/// What a solver returned.
#[pyclass(frozen)]
pub struct Answer(Solution);

#[pymethods]
impl Answer {
    /// Its parts as arrays and numbers.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Solution { displacement, multipliers, status, iterations, outcome, history } = &self.0;
        let code = |status: &Status| match status {
            Status::Apart => 0u8,
            Status::Stick => 1,
            Status::SlipPlus => 2,
            Status::SlipMinus => 3,
        };
        let outcome = match outcome {
            Outcome::Converged => "converged",
            Outcome::IterationLimit => "iteration limit",
            Outcome::Diverged => "diverged",
        };
        let parts = PyDict::new(py);
        parts.set_item("displacement", PyArray1::from_slice(py, displacement))?;
        parts.set_item("multipliers", array(py, multipliers.as_flattened().to_vec(), &[multipliers.len(), 2])?)?;
        parts.set_item("status", PyArray1::from_iter(py, status.iter().map(code)))?;
        parts.set_item("iterations", iterations)?;
        parts.set_item("outcome", outcome)?;
        parts.set_item("history", PyArray1::from_slice(py, history))?;
        Ok(parts)
    }
}
