//! [`Persist`] for recurrences of orthogonal polynomials and the tensor bases of stochastic cells.

use faer::Mat;
use hdf5::Group;
use steklov_stochastic::{CellBasis, Recurrence};

use crate::array::{load_number, load_points, load_vector, save_number, save_points, save_vector};
use crate::dataset::label;
use crate::error::{IoError, invalid, mismatch};
use crate::matrix::{load_dense, save_dense};
use crate::persist::{Persist, create_group, load, open_group, save};

impl Persist for Recurrence {
    const KIND: &'static str = "recurrence of orthogonal polynomials";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let meaning = "ends of the interval of germs, infinite where it is not bounded";
        save_points(at, "interval", &[self.interval], &label("of the germ", meaning, &["value", "end"]))?;
        save_number(at, "probability", self.probability, "1", "probability of the interval")?;
        save_number(at, "shift", self.shift, "of the germ", "germ of t = 0, germ = shift + scale t")?;
        save_number(at, "scale", self.scale, "of the germ", "germs to a unit of t")?;
        let meaning = "alpha_k of pi_k+1(t) = (t - alpha_k) pi_k(t) - beta_k pi_k-1(t), pi_0 = 1, pi_-1 = 0";
        save_vector(at, "alpha", &self.alpha, &label("1", meaning, &["k"]))?;
        let meaning = "beta_k > 0, beta_0 = 1; p_k = pi_k / (beta_1 .. beta_k)^(1/2) are orthonormal: int p_k p_l d rho = delta_kl";
        save_vector(at, "beta", &self.beta, &label("1", meaning, &["k"]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let interval = match load_points(at, "interval")?[..] {
            [interval] => interval,
            ref rows => return Err(mismatch(at, "interval", "one row", format!("{} rows", rows.len()))),
        };
        let recurrence = Self {
            interval,
            probability: load_number(at, "probability")?,
            shift: load_number(at, "shift")?,
            scale: load_number(at, "scale")?,
            alpha: load_vector(at, "alpha")?,
            beta: load_vector(at, "beta")?,
        };
        recurrence.check().map_err(|e| invalid(at, "", e))?;
        Ok(recurrence)
    }
}

impl Persist for CellBasis {
    const KIND: &'static str = "tensor Lagrange basis of a stochastic cell";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        for (d, (recurrence, rule)) in self.axes().enumerate() {
            let axis = create_group(at, &format!("axis_{d}"))?;
            save(&axis, "recurrence", recurrence)?;
            save(&axis, "rule", rule)?;
        }
        let meaning = "nodes: germs, products of the rules of the axes, those of the last one fastest";
        let points = Mat::from_fn(self.points.len(), self.axes().len(), |i, d| self.points[i][d]);
        save_dense(at, "points", points.as_ref(), &label("of the germ", meaning, &["node", "axis"]))?;
        let meaning = "D_j = int theta_j d rho, product of the rules' weights and the axes' probabilities: their sum is the probability";
        save_vector(at, "weights", &self.weights, &label("1", meaning, &["node"]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let points = load_dense(at, "points")?;
        let axis = |d: usize| {
            let axis = open_group(at, &format!("axis_{d}"))?;
            Ok((load(&axis, "recurrence")?, load(&axis, "rule")?))
        };
        let axes = (0..points.ncols()).map(axis).collect::<Result<Vec<_>, IoError>>()?;
        if at.link_exists(&format!("axis_{}", axes.len())) {
            return Err(invalid(at, "points", format!("they have {} germs, but there are more axes", axes.len())));
        }
        let basis = CellBasis::from_axes(axes).map_err(|e| invalid(at, "", e))?;
        let same = points.nrows() == basis.points.len()
            && basis.points.iter().enumerate().all(|(i, x)| x.iter().enumerate().all(|(d, x)| *x == points[(i, d)]));
        if !same {
            return Err(invalid(at, "points", "they are not the products of the rules of the axes"));
        }
        if load_vector(at, "weights")? != basis.weights {
            return Err(invalid(
                at,
                "weights",
                "they are not the products of the rules' weights and the probabilities",
            ));
        }
        Ok(basis)
    }
}
