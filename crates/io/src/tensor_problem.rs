//! [`Persist`] for contact coupled over the nodes of a stochastic cell.

use faer::Mat;
use hdf5::Group;
use steklov_contact::{Condition, ContactNode};
use steklov_stochastic::TensorProblem;

use crate::array::{load_vector, save_vector};
use crate::contact::{load_nodes, save_nodes};
use crate::dataset::label;
use crate::error::{IoError, invalid, write_error};
use crate::matrix::{load_dense, save_dense};
use crate::persist::{Persist, create_group, open_group};
use crate::quadrature::{check_length, load_sized};

/// The data of a [`TensorProblem`], owned instead of borrowed, for reading.
#[derive(Debug, Clone)]
pub struct StoredTensorProblem {
    /// S.
    pub stiffness: Mat<f64>,
    /// M_E.
    pub mass: Mat<f64>,
    /// D_j.
    pub weights: Vec<f64>,
    /// F.
    pub load: Mat<f64>,
    /// The contact nodes of every stochastic node.
    pub nodes: Vec<Vec<ContactNode>>,
}

impl From<&TensorProblem<'_>> for StoredTensorProblem {
    fn from(problem: &TensorProblem<'_>) -> Self {
        Self {
            stiffness: problem.stiffness.clone(),
            mass: problem.mass.clone(),
            weights: problem.weights.to_vec(),
            load: problem.load.clone(),
            nodes: problem.nodes.to_vec(),
        }
    }
}

impl StoredTensorProblem {
    /// The problem, for the solvers.
    pub fn problem(&self) -> TensorProblem<'_> {
        let Self { stiffness, mass, weights, load, nodes } = self;
        TensorProblem { stiffness, mass, weights, load, nodes }
    }
}

/// A number of a condition.
type Number = fn(&mut Condition) -> &mut f64;

/// The numbers that differ between stochastic nodes: name, unit, meaning, place.
const VARYING: [(&str, &str, &str, Number); 3] = [
    ("gap", "length", "weighted gap g_j: B_n v_j <= g_j", |c| &mut c.gap),
    ("slip_offset", "length", "what a held neighbour adds to the tangential displacement", |c| &mut c.slip_offset),
    ("bound", "stress", "friction bound without pressure, infinite for full stick", |c| &mut c.bound),
];

const UNKNOWN: &str = "unknown";
const NODE: &str = "stochastic node";

impl Persist for StoredTensorProblem {
    const KIND: &'static str = "contact problem coupled over stochastic nodes";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        // equal numbers are written once
        self.problem().check().map_err(|e| write_error(at, "", e))?;
        let equation = "sum_k (M_E)_jk S v_k + D_j B^T W lambda_j = F_j";
        let matrix = |name, a: &Mat<f64>, unit, meaning: String, axes: &[&str]| {
            save_dense(at, name, a.as_ref(), &label(unit, &meaning, axes))
        };
        let meaning = format!("S of the modulus 1, {equation}");
        matrix("stiffness", &self.stiffness, "stress over that of M_E", meaning, &[UNKNOWN, UNKNOWN])?;
        let meaning = "(M_E)_jk = int E theta_j theta_k d rho, symmetric".to_owned();
        matrix("mass", &self.mass, "of E", meaning, &[NODE, NODE])?;
        let meaning = label("1", "D_j = int theta_j d rho > 0", &[NODE]);
        save_vector(at, "weights", &self.weights, &meaning)?;
        let meaning = "F_j = int f theta_j d rho".to_owned();
        matrix("load", &self.load, "force/length", meaning, &[UNKNOWN, NODE])?;

        let nodes = create_group(at, "nodes")?;
        save_nodes(&nodes, &self.nodes[0], &VARYING.map(|v| v.0))?;
        for (name, unit, meaning, number) in VARYING {
            let row = |nodes: &Vec<ContactNode>| -> Vec<f64> {
                nodes.iter().flat_map(|n| &n.conditions).map(|c| *number(&mut c.clone())).collect()
            };
            let rows: Vec<Vec<f64>> = self.nodes.iter().map(row).collect();
            let table = Mat::from_fn(rows.len(), rows[0].len(), |j, c| rows[j][c]);
            save_dense(&nodes, name, table.as_ref(), &label(unit, meaning, &[NODE, "condition"]))?;
        }
        Ok(())
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let weights = load_vector(at, "weights")?;
        let count = weights.len();
        let (stiffness, mass) = (load_dense(at, "stiffness")?, load_sized(at, "mass", count, count)?);
        check_length(at, "stiffness", stiffness.ncols(), stiffness.nrows())?;
        let load = load_sized(at, "load", stiffness.nrows(), count)?;
        for (name, a) in [("stiffness", &stiffness), ("load", &load)] {
            if !a.col_iter().all(|column| column.iter().all(|v| v.is_finite())) {
                return Err(invalid(at, name, "an entry is not finite"));
            }
        }
        let group = open_group(at, "nodes")?;
        let alike = load_nodes(&group, &VARYING.map(|v| v.0))?;
        let conditions = alike.iter().map(|n| n.conditions.len()).sum();
        let mut nodes = Vec::new();
        let tables =
            VARYING.iter().map(|v| load_sized(&group, v.0, count, conditions)).collect::<Result<Vec<_>, _>>()?;
        for j in 0..count {
            let mut own = alike.clone();
            for (c, condition) in own.iter_mut().flat_map(|n| &mut n.conditions).enumerate() {
                VARYING.iter().zip(&tables).for_each(|(v, table)| *(v.3)(condition) = table[(j, c)]);
            }
            nodes.push(own);
        }
        let problem = Self { stiffness, mass, weights, load, nodes };
        problem.problem().check().map_err(|e| invalid(at, "", e))?;
        Ok(problem)
    }
}
