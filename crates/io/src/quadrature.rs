//! [`Persist`] for the types of `steklov-quadrature`.

use faer::Mat;
use hdf5::Group;
use steklov_quadrature::{BiorthogonalBasis, LobattoBasis, Rule, Series};

use crate::array::{load_integers, load_vector, save_integers, save_vector};
use crate::dataset::Label;
use crate::error::{IoError, invalid, mismatch};
use crate::matrix::{load_dense, save_dense};
use crate::persist::Persist;

fn number<'a>(meaning: &'a str, axes: &'a [&'a str]) -> Label<'a> {
    Label { unit: "1", meaning, axes }
}

fn save_degree(at: &Group, degree: usize) -> Result<(), IoError> {
    save_integers(at, "degree", &[degree], &number("polynomial degree", &["value"]))
}

fn load_degree(at: &Group) -> Result<usize, IoError> {
    match load_integers(at, "degree")?[..] {
        [degree] => Ok(degree),
        ref other => Err(mismatch(at, "degree", "one degree", format!("{} numbers", other.len()))),
    }
}

/// The matrix `name`, which must be n×m.
pub(crate) fn load_sized(at: &Group, name: &str, n: usize, m: usize) -> Result<Mat<f64>, IoError> {
    let a = load_dense(at, name)?;
    if (a.nrows(), a.ncols()) != (n, m) {
        return Err(mismatch(at, name, format!("a {n}×{m} matrix"), format!("{}×{}", a.nrows(), a.ncols())));
    }
    Ok(a)
}

/// Demands `n` entries of a list.
pub(crate) fn check_length(at: &Group, name: &str, found: usize, n: usize) -> Result<(), IoError> {
    if found == n { Ok(()) } else { Err(invalid(at, name, format!("{found} entries where {n} are needed"))) }
}

impl Persist for Rule {
    const KIND: &'static str = "quadrature rule";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_vector(at, "points", &self.points, &number("points", &["point"]))?;
        save_vector(at, "weights", &self.weights, &number("weights", &["point"]))?;
        save_degree(at, self.degree)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (points, weights) = (load_vector(at, "points")?, load_vector(at, "weights")?);
        check_length(at, "weights", weights.len(), points.len())?;
        Ok(Self { points, weights, degree: load_degree(at)? })
    }
}

impl Persist for Series {
    const KIND: &'static str = "Legendre series";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_vector(at, "coefficients", &self.coefficients, &number("a_n of P_n", &["n"]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        Ok(Self { coefficients: load_vector(at, "coefficients")? })
    }
}

impl Persist for LobattoBasis {
    const KIND: &'static str = "Lobatto basis";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_degree(at, self.degree)?;
        save_vector(at, "nodes", &self.nodes, &number("Gauss-Lobatto points", &["node"]))?;
        save_vector(at, "weights", &self.weights, &number("integral of each basis function", &["node"]))?;
        let matrix =
            |name, a: &Mat<f64>, meaning, axes: &[&str]| save_dense(at, name, a.as_ref(), &number(meaning, axes));
        matrix("vandermonde", &self.vandermonde, "P_n at the nodes", &["node", "n"])?;
        matrix("to_legendre", &self.to_legendre, "nodal values to coefficients", &["n", "node"])?;
        matrix("differentiation", &self.differentiation, "nodal values to those of du/dt", &["node", "node"])?;
        let meaning = "nodal values to coefficients of du/dt";
        matrix("derivative_to_legendre", &self.derivative_to_legendre, meaning, &["n", "node"])
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (degree, nodes, weights) = (load_degree(at)?, load_vector(at, "nodes")?, load_vector(at, "weights")?);
        let n = nodes.len();
        if degree == 0 || n.checked_sub(1) != Some(degree) {
            return Err(invalid(at, "nodes", format!("{n} of them for the degree {degree}")));
        }
        check_length(at, "weights", weights.len(), n)?;
        Ok(Self {
            degree,
            nodes,
            weights,
            vandermonde: load_sized(at, "vandermonde", n, n)?,
            to_legendre: load_sized(at, "to_legendre", n, n)?,
            differentiation: load_sized(at, "differentiation", n, n)?,
            derivative_to_legendre: load_sized(at, "derivative_to_legendre", degree, n)?,
        })
    }
}

impl Persist for BiorthogonalBasis {
    const KIND: &'static str = "biorthogonal basis";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let label = number("values of the dual functions at the Lobatto points", &["function", "node"]);
        save_dense(at, "coefficients", self.coefficients.as_ref(), &label)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let coefficients = load_dense(at, "coefficients")?;
        let n = coefficients.nrows();
        if n < 2 || coefficients.ncols() != n {
            let found = format!("{n}×{}", coefficients.ncols());
            return Err(mismatch(at, "coefficients", "a square matrix of 2 or more rows", found));
        }
        Ok(Self { degree: n - 1, coefficients })
    }
}
