//! [`Persist`] for [`Method`]: a number or a word for each key, nothing if the program chooses.

use hdf5::Group;
use steklov_contact::{MultiplierDegree, MultiplierMesh};
use steklov_problem::{CUTTINGS, Cutting, INDICATORS, MODELS, MULTIPLIERS, Method, REFINES, SOLVERS};

use crate::array::{load_integers, load_number, save_integers, save_number};
use crate::dataset::label;
use crate::error::{IoError, invalid, mismatch};
use crate::persist::Persist;
use crate::words::{load_word, save_word};

const NO: [(&str, bool); 2] = [("no", false), ("yes", true)];
/// Words of multiplier meshes, each with a count of parts beside it.
const MESHES: [&str; 4] = ["same", "coarser", "finer", "shifted"];
/// Words of multiplier degrees, each with a degree beside it.
const DEGREES: [&str; 3] = ["relative", "fixed", "continuous"];

impl Persist for Method {
    const KIND: &'static str = "method";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_word(at, "model", &MODELS, &self.model, "discretisation")?;
        save_word(at, "refine", &REFINES, &self.refine, "refinement")?;
        save_word(at, "cuts", &CUTTINGS, &self.cuts, "whether the body is cut into subdomains")?;
        save_word(at, "indicator", &INDICATORS, &self.indicator, "indicator of the error")?;
        save_word(at, "multiplier", &MULTIPLIERS, &self.multiplier, "space of multipliers")?;
        save_word(at, "solver", &SOLVERS, &self.solver, "solver of contact")?;
        save_word(at, "estimators", &NO, &self.estimators, "whether residual estimators are told")?;
        for (name, value, unit, meaning) in [
            ("tolerance", self.tolerance, "1", "wanted relative error in the energy norm"),
            ("marking", self.marking, "1", "theta of Doerfler's marking"),
            ("smoothness", Some(self.smoothness), "1", "delta of the choice between h and p"),
            ("gamma", self.gamma, "1/stress", "gamma_0 of the stabilisation"),
        ] {
            value.map_or(Ok(()), |value| save_number(at, name, value, unit, meaning))?;
        }
        let bytes = self.memory.map(|bytes| usize::try_from(bytes).unwrap_or(usize::MAX));
        for (name, value, meaning) in [
            ("elements", self.elements, "elements of the first mesh at least"),
            ("degree", Some(self.degree), "degree of the first mesh"),
            ("max_dofs", self.max_dofs, "displacement unknowns at most"),
            ("memory", bytes, "bytes of the matrices of a mesh at most"),
            ("max_steps", Some(self.max_steps), "adaptive steps at most"),
        ] {
            value.map_or(Ok(()), |value| save_integers(at, name, &[value], &label("1", meaning, &["value"])))?;
        }
        let (mesh, parts) = match self.multiplier_mesh {
            MultiplierMesh::Same => (MESHES[0], 1),
            MultiplierMesh::Coarser(parts) => (MESHES[1], parts),
            MultiplierMesh::Finer(parts) => (MESHES[2], parts),
            MultiplierMesh::Shifted => (MESHES[3], 1),
        };
        save_word(at, "multiplier_mesh", &MESHES.map(|word| (word, word)), &mesh, "mesh of stabilised multipliers")?;
        let meaning = "elements that one of them takes, or parts of an element";
        save_integers(at, "multiplier_parts", &[parts], &label("1", meaning, &["value"]))?;
        let (kind, degree) = match self.multiplier_degree {
            MultiplierDegree::Relative(more) => (DEGREES[0], f64::from(more)),
            MultiplierDegree::Fixed(degree) => (DEGREES[1], degree as f64),
            MultiplierDegree::ContinuousLinear => (DEGREES[2], 1.0),
        };
        let meaning = "whether the degree is that of the displacement and more, fixed, or 1 and continuous";
        save_word(at, "multiplier_kind", &DEGREES.map(|word| (word, word)), &kind, meaning)?;
        save_number(at, "multiplier_degree", degree, "1", "degree of stabilised multipliers, or how much more it is")
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let optional = |name: &str| at.link_exists(name).then(|| load_number(at, name)).transpose();
        let count = |name: &str| match load_integers(at, name)?[..] {
            [value] => Ok(value),
            ref other => Err(mismatch(at, name, "one number", format!("{} numbers", other.len()))),
        };
        let optional_count = |name: &str| at.link_exists(name).then(|| count(name)).transpose();
        let method = Self {
            model: load_word(at, "model", &MODELS)?,
            tolerance: optional("tolerance")?,
            refine: load_word(at, "refine", &REFINES)?,
            elements: optional_count("elements")?,
            degree: count("degree")?,
            max_dofs: optional_count("max_dofs")?,
            memory: optional_count("memory")?.map(|bytes| bytes as u64),
            max_steps: count("max_steps")?,
            // files of earlier versions have none
            cuts: if at.link_exists("cuts") { load_word(at, "cuts", &CUTTINGS)? } else { Cutting::None },
            indicator: load_word(at, "indicator", &INDICATORS)?,
            estimators: load_word(at, "estimators", &NO)?,
            marking: optional("marking")?,
            smoothness: load_number(at, "smoothness")?,
            multiplier: load_word(at, "multiplier", &MULTIPLIERS)?,
            gamma: optional("gamma")?,
            multiplier_mesh: multiplier_mesh(at, count("multiplier_parts")?)?,
            multiplier_degree: multiplier_degree(at)?,
            solver: load_word(at, "solver", &SOLVERS)?,
        };
        check(&method).map_err(|(name, wanted)| invalid(at, name, format!("it must be {wanted}")))?;
        Ok(method)
    }
}

fn multiplier_mesh(at: &Group, parts: usize) -> Result<MultiplierMesh, IoError> {
    let table = MESHES.into_iter().zip([
        MultiplierMesh::Same,
        MultiplierMesh::Coarser(parts),
        MultiplierMesh::Finer(parts),
        MultiplierMesh::Shifted,
    ]);
    load_word(at, "multiplier_mesh", &table.collect::<Vec<_>>())
}

fn multiplier_degree(at: &Group) -> Result<MultiplierDegree, IoError> {
    let degree = load_number(at, "multiplier_degree")?;
    if degree.fract() != 0.0 || !(-64.0..=64.0).contains(&degree) {
        return Err(invalid(at, "multiplier_degree", format!("{degree} is no degree")));
    }
    let table = DEGREES.into_iter().zip([
        MultiplierDegree::Relative(degree as i32),
        MultiplierDegree::Fixed(degree.max(0.0) as usize),
        MultiplierDegree::ContinuousLinear,
    ]);
    load_word(at, "multiplier_kind", &table.collect::<Vec<_>>())
}

/// The first number outside of its range, and the range.
fn check(method: &Method) -> Result<(), (&'static str, &'static str)> {
    let part = |v: f64| v > 0.0 && v <= 1.0;
    for (name, holds, wanted) in [
        ("tolerance", method.tolerance.is_none_or(|v| v > 0.0 && v < 1.0), "above 0 and below 1"),
        ("marking", method.marking.is_none_or(part), "above 0 and at most 1"),
        ("smoothness", part(method.smoothness), "above 0 and at most 1"),
        ("gamma", method.gamma.is_none_or(|v| v > 0.0 && v.is_finite()), "above 0 and finite"),
        ("elements", method.elements.is_none_or(|n| (1..=1_000_000).contains(&n)), "1 to 1,000,000"),
        ("degree", (1..=64).contains(&method.degree), "1 to 64"),
        ("max_dofs", method.max_dofs.is_none_or(|n| (1..=100_000_000).contains(&n)), "1 to 100,000,000"),
        ("max_steps", (1..=1_000_000).contains(&method.max_steps), "1 to 1,000,000"),
        ("multiplier_parts", multiplier_parts(method) >= 1, "1 at least"),
    ] {
        if !holds {
            return Err((name, wanted));
        }
    }
    Ok(())
}

fn multiplier_parts(method: &Method) -> usize {
    match method.multiplier_mesh {
        MultiplierMesh::Coarser(parts) | MultiplierMesh::Finer(parts) => parts,
        _ => 1,
    }
}
