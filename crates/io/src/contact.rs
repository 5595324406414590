//! [`Persist`] for the types of `steklov-contact`: flat arrays with a row for each node or condition.

use hdf5::Group;
use sprs::CsMat;
use steklov_algebra::{Pattern, SparseSymmetric, Symmetric};
use steklov_contact::{Condition, ContactNode, Kkt, Outcome, Problem, Solution, Status};

use crate::array::{
    load_integers, load_number, load_points, load_vector, save_integers, save_number, save_points, save_vector,
};
use crate::dataset::label;
use crate::error::{IoError, invalid, mismatch};
use crate::matrix::{load_sparse, save_dense, save_sparse};
use crate::persist::Persist;
use crate::quadrature::{check_length, load_sized};
use crate::text::{load_text, save_text};

/// One number of each condition: name, unit, meaning.
const OF_CONDITION: [(&str, &str, &str); 6] = [
    ("normal_weight", "length", "D_n, 0 without a normal multiplier"),
    ("tangent_weight", "length", "D_t, 0 without a tangential multiplier"),
    ("gap", "length", "weighted gap g"),
    ("slip_offset", "length", "what a held neighbour adds to the tangential displacement"),
    ("bound", "stress", "friction bound F without pressure, infinite for full stick"),
    ("coefficient", "1", "Coulomb's coefficient of friction"),
];

/// Contact nodes and their conditions, without the numbers `except`.
pub(crate) fn save_nodes(at: &Group, nodes: &[ContactNode], except: &[&str]) -> Result<(), IoError> {
    let integers = |name, meaning, value: &dyn Fn(&ContactNode) -> usize| {
        let values: Vec<usize> = nodes.iter().map(value).collect();
        save_integers(at, name, &values, &label("1", meaning, &["node"]))
    };
    integers("first", "first unknown of each node", &|n| n.first)?;
    integers("unknowns", "number of its unknowns", &|n| n.unknowns)?;
    integers("conditions", "number of its conditions", &|n| n.conditions.len())?;

    let conditions: Vec<&Condition> = nodes.iter().flat_map(|n| &n.conditions).collect();
    let pair = |name, meaning, value: &dyn Fn(&Condition) -> [f64; 2]| {
        let values: Vec<[f64; 2]> = conditions.iter().map(|c| value(c)).collect();
        save_points(at, name, &values, &label("1", meaning, &["condition", "unknown of the node"]))
    };
    pair("normal", "coefficients of the normal displacement", &|c| c.normal)?;
    pair("tangent", "coefficients of the tangential displacement", &|c| c.tangent)?;
    for (i, (name, unit, meaning)) in OF_CONDITION.into_iter().enumerate().filter(|(_, n)| !except.contains(&n.0)) {
        let value =
            |c: &&Condition| [c.normal_weight, c.tangent_weight, c.gap, c.slip_offset, c.bound, c.coefficient][i];
        let values: Vec<f64> = conditions.iter().map(value).collect();
        save_vector(at, name, &values, &label(unit, meaning, &["condition"]))?;
    }
    Ok(())
}

/// Reads what [`save_nodes`] wrote, with 0 for the numbers `except`.
pub(crate) fn load_nodes(at: &Group, except: &[&str]) -> Result<Vec<ContactNode>, IoError> {
    let (first, unknowns, counts) =
        (load_integers(at, "first")?, load_integers(at, "unknowns")?, load_integers(at, "conditions")?);
    check_length(at, "unknowns", unknowns.len(), first.len())?;
    check_length(at, "conditions", counts.len(), first.len())?;

    let (normal, tangent) = (load_points(at, "normal")?, load_points(at, "tangent")?);
    check_length(at, "tangent", tangent.len(), normal.len())?;
    let mut columns = Vec::new();
    for (name, _, _) in OF_CONDITION {
        let column = if except.contains(&name) { vec![0.0; normal.len()] } else { load_vector(at, name)? };
        check_length(at, name, column.len(), normal.len())?;
        columns.push(column);
    }
    let mut conditions = (0..normal.len()).map(|i| Condition {
        normal: normal[i],
        tangent: tangent[i],
        normal_weight: columns[0][i],
        tangent_weight: columns[1][i],
        gap: columns[2][i],
        slip_offset: columns[3][i],
        bound: columns[4][i],
        coefficient: columns[5][i],
    });
    let mut nodes = Vec::new();
    for (i, &first) in first.iter().enumerate() {
        let conditions: Vec<Condition> = conditions.by_ref().take(counts[i]).collect();
        check_length(at, "conditions", conditions.len(), counts[i])?;
        nodes.push(ContactNode { first, unknowns: unknowns[i], conditions });
    }
    check_length(at, "normal", normal.len(), normal.len() - conditions.len())?;
    Ok(nodes)
}

impl Persist for Problem {
    const KIND: &'static str = "condensed contact problem";
    const VERSION: u32 = 2;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let of_stiffness = label("stress", "S", &["unknown", "unknown"]);
        match &self.stiffness {
            Symmetric::Full(full) => save_dense(at, "stiffness", full.as_ref(), &of_stiffness)?,
            Symmetric::Sparse(SparseSymmetric { pattern, entries, .. }) => {
                let size = pattern.size();
                let rows = CsMat::new((size, size), pattern.start.clone(), pattern.rows.clone(), entries.clone());
                save_sparse(at, "stiffness", &rows, &of_stiffness)?;
            }
        }
        save_vector(at, "load", &self.load, &label("force/length", "f", &["unknown"]))?;
        save_nodes(at, &self.nodes, &[])
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let load = load_vector(at, "load")?;
        let m = load.len();
        let stiffness = match at.group("stiffness") {
            Err(_) => load_sized(at, "stiffness", m, m)?.into(),
            Ok(_) => sparse_stiffness(at, m)?,
        };
        let nodes = load_nodes(at, &[])?;
        let problem = Self { stiffness, load, nodes };
        problem.check().map_err(|e| invalid(at, "", e))?;
        Ok(problem)
    }
}

/// The m×m stiffness of a group of sparse rows.
fn sparse_stiffness(at: &Group, m: usize) -> Result<Symmetric, IoError> {
    let rows = load_sparse(at, "stiffness")?;
    if rows.shape() != (m, m) {
        return Err(mismatch(at, "stiffness", format!("{m} by {m} entries"), format!("{:?}", rows.shape())));
    }
    let (start, rows, entries) = rows.into_raw_storage();
    let pattern = Pattern { start, rows };
    if let Some(i) = (0..m).find(|&i| pattern.place(i, i).is_none()) {
        return Err(invalid(at, "stiffness", format!("row {i} has no entry on the diagonal")));
    }
    let sum = SparseSymmetric::new(pattern, entries);
    Ok(Symmetric::Sparse(sum.map_err(|_| invalid(at, "stiffness", "its factor does not fit into memory"))?))
}

impl Persist for Solution {
    const KIND: &'static str = "contact solution";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_vector(at, "displacement", &self.displacement, &label("length", "unknowns v", &["unknown"]))?;
        let axes = ["condition", "normal, tangential"];
        save_points(at, "multipliers", &self.multipliers, &label("stress", "pressure and shear", &axes))?;
        let code = |status: &Status| match status {
            Status::Apart => 0,
            Status::Stick => 1,
            Status::SlipPlus => 2,
            Status::SlipMinus => 3,
        };
        let status: Vec<usize> = self.status.iter().map(code).collect();
        let meaning = "0 apart, 1 stick, 2 slip along +t, 3 slip along -t";
        save_integers(at, "status", &status, &label("1", meaning, &["condition"]))?;
        save_integers(at, "iterations", &[self.iterations], &label("1", "iterations done", &["value"]))?;
        let outcome = match self.outcome {
            Outcome::Converged => "converged",
            Outcome::IterationLimit => "iteration limit",
            Outcome::Diverged => "diverged",
        };
        save_text(at, "outcome", outcome, "how the solver ended")?;
        save_vector(at, "history", &self.history, &label("1", "error measure before each iteration", &["iteration"]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let multipliers = load_points(at, "multipliers")?;
        let status = |code: usize| match code {
            0 => Ok(Status::Apart),
            1 => Ok(Status::Stick),
            2 => Ok(Status::SlipPlus),
            3 => Ok(Status::SlipMinus),
            _ => Err(invalid(at, "status", format!("{code} is no status"))),
        };
        let status: Vec<Status> = load_integers(at, "status")?.into_iter().map(status).collect::<Result<_, _>>()?;
        check_length(at, "status", status.len(), multipliers.len())?;
        let iterations = match load_integers(at, "iterations")?[..] {
            [iterations] => iterations,
            ref other => return Err(mismatch(at, "iterations", "one number", format!("{} numbers", other.len()))),
        };
        let outcome = match load_text(at, "outcome")?.as_str() {
            "converged" => Outcome::Converged,
            "iteration limit" => Outcome::IterationLimit,
            "diverged" => Outcome::Diverged,
            other => return Err(mismatch(at, "outcome", "converged, iteration limit or diverged", other)),
        };
        let (displacement, history) = (load_vector(at, "displacement")?, load_vector(at, "history")?);
        Ok(Self { displacement, multipliers, status, iterations, outcome, history })
    }
}

impl Persist for Kkt {
    const KIND: &'static str = "audit of a contact solution";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let violation = |name, value| save_number(at, name, value, "1", "relative violation");
        violation("equilibrium", self.equilibrium)?;
        violation("penetration", self.penetration)?;
        violation("tension", self.tension)?;
        violation("complementarity", self.complementarity)?;
        violation("friction", self.friction)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        Ok(Self {
            equilibrium: load_number(at, "equilibrium")?,
            penetration: load_number(at, "penetration")?,
            tension: load_number(at, "tension")?,
            complementarity: load_number(at, "complementarity")?,
            friction: load_number(at, "friction")?,
        })
    }
}
