//! [`Persist`] for the types of `steklov-stochastic`.

use faer::Mat;
use hdf5::Group;
use steklov_stochastic::{
    Distribution, IntervalParts, KarhunenLoeve, ModeParts, Moments, Points, StochasticCell, StochasticMesh, Variable,
};

use crate::array::{load_integers, load_number, load_vector, save_integers, save_number, save_vector};
use crate::dataset::label;
use crate::error::{IoError, invalid};
use crate::matrix::{load_dense, save_dense};
use crate::persist::Persist;
use crate::text::{load_text, load_texts, save_text, save_texts};

fn matrix(rows: &[Vec<f64>]) -> Mat<f64> {
    Mat::from_fn(rows.len(), rows.first().map_or(0, Vec::len), |i, j| rows[i][j])
}

fn rows(at: &Group, name: &str) -> Result<Vec<Vec<f64>>, IoError> {
    let matrix = load_dense(at, name)?;
    Ok((0..matrix.nrows()).map(|i| (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect()).collect())
}

impl Persist for KarhunenLoeve {
    const KIND: &'static str = "Karhunen-Loeve expansion on an interval";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let IntervalParts { length, shares, modes } = self.parts();
        save_number(at, "length", length, "length", "length L of the interval")?;
        save_vector(at, "shares", &shares, &label("1", "eigenvalues over L, falling", &["mode"]))?;
        match modes {
            ModeParts::Exponential { q, roots } => {
                save_text(at, "form", "exponential", "closed form, or piecewise polynomials")?;
                save_number(at, "q", q, "1", "L over twice the correlation length")?;
                save_vector(at, "roots", &roots, &label("1", "z tan(theta) = q, z = m pi/2 + theta", &["mode"]))
            }
            ModeParts::Piecewise { elements, degree, coefficients } => {
                save_text(at, "form", "piecewise", "closed form, or piecewise polynomials")?;
                let sizes = label("1", "number of elements, degree", &["what"]);
                save_integers(at, "sizes", &[elements, degree], &sizes)?;
                let meaning = "coefficients in orthonormal Legendre polynomials of the elements of the unit interval";
                let axes = &["mode", "element and degree"];
                save_dense(at, "coefficients", matrix(&coefficients).as_ref(), &label("1", meaning, axes))
            }
        }
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let modes = match load_text(at, "form")?.as_str() {
            "exponential" => ModeParts::Exponential { q: load_number(at, "q")?, roots: load_vector(at, "roots")? },
            "piecewise" => match load_integers(at, "sizes")?[..] {
                [elements, degree] => {
                    ModeParts::Piecewise { elements, degree, coefficients: rows(at, "coefficients")? }
                }
                _ => return Err(invalid(at, "sizes", "it does not have 2 numbers")),
            },
            other => return Err(invalid(at, "form", format!("{other:?} is none"))),
        };
        let parts = IntervalParts { length: load_number(at, "length")?, shares: load_vector(at, "shares")?, modes };
        KarhunenLoeve::from_parts(parts).map_err(|e| invalid(at, "shares", e.to_string()))
    }
}

/// Name of a distribution and its two parameters.
fn law(distribution: Distribution) -> (&'static str, [f64; 2]) {
    match distribution {
        Distribution::Uniform => ("uniform", [0.0; 2]),
        Distribution::Normal { mean, deviation } => ("normal", [mean, deviation]),
        Distribution::Lognormal { mean, deviation } => ("lognormal", [mean, deviation]),
        Distribution::Beta { alpha, beta } => ("beta", [alpha, beta]),
    }
}

impl Persist for StochasticMesh {
    const KIND: &'static str = "stochastic mesh";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let laws: Vec<_> = self.variables.iter().map(|v| law(v.distribution())).collect();
        let names: Vec<String> = laws.iter().map(|l| l.0.to_owned()).collect();
        save_texts(at, "distributions", &names, "law of each variable", "germ")?;
        let parameters: Vec<Vec<f64>> = laws.iter().map(|l| l.1.to_vec()).collect();
        let meaning = "mean and deviation, or alpha and beta";
        save_dense(at, "parameters", matrix(&parameters).as_ref(), &label("1", meaning, &["germ", "parameter"]))?;
        let bounds: Vec<Vec<f64>> = self.variables.iter().map(|v| v.interval().to_vec()).collect();
        let meaning = label("1", "low and high of each variable", &["germ", "end"]);
        save_dense(at, "intervals", matrix(&bounds).as_ref(), &meaning)?;
        let axes = &["cell", "germ"];
        for (k, name, meaning) in [(0, "low", "lower ends of the cells"), (1, "high", "upper ends of the cells")] {
            let ends: Vec<Vec<f64>> = self.cells.iter().map(|c| c.bounds.iter().map(|b| b[k]).collect()).collect();
            save_dense(at, name, matrix(&ends).as_ref(), &label("1", meaning, axes))?;
        }
        let degree: Vec<usize> = self.cells.iter().flat_map(|c| c.degree.clone()).collect();
        save_integers(at, "degree", &degree, &label("1", "degrees, germ by germ within a cell", &["cell and germ"]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (names, parameters) = (load_texts(at, "distributions")?, rows(at, "parameters")?);
        let (intervals, low, high) = (rows(at, "intervals")?, rows(at, "low")?, rows(at, "high")?);
        let degree = load_integers(at, "degree")?;
        let germs = names.len();
        let fits = parameters.len() == germs
            && intervals.len() == germs
            && parameters.iter().chain(&intervals).all(|r| r.len() == 2)
            && low.len() == high.len()
            && low.iter().chain(&high).all(|r| r.len() == germs)
            && degree.len() == germs * low.len()
            && germs > 0;
        if !fits {
            return Err(invalid(at, "degree", "variables, cells and degrees differ in number"));
        }
        let variable = |((name, p), i): ((&String, &Vec<f64>), &Vec<f64>)| {
            let distribution = match name.as_str() {
                "uniform" => Distribution::Uniform,
                "normal" => Distribution::Normal { mean: p[0], deviation: p[1] },
                "lognormal" => Distribution::Lognormal { mean: p[0], deviation: p[1] },
                "beta" => Distribution::Beta { alpha: p[0], beta: p[1] },
                other => return Err(invalid(at, "distributions", format!("{other:?} is none"))),
            };
            Variable::new(distribution, i[0], i[1]).map_err(|e| invalid(at, "parameters", e.to_string()))
        };
        let variables =
            names.iter().zip(&parameters).zip(&intervals).map(variable).collect::<Result<Vec<Variable>, IoError>>()?;
        let cell = |(k, (low, high)): (usize, (&Vec<f64>, &Vec<f64>))| StochasticCell {
            bounds: low.iter().zip(high).map(|(a, b)| [*a, *b]).collect(),
            degree: degree[k * germs..(k + 1) * germs].to_vec(),
        };
        let cells: Vec<StochasticCell> = low.iter().zip(&high).enumerate().map(cell).collect();
        if let Some(bound) =
            cells.iter().flat_map(|c| &c.bounds).find(|b| b[0].is_nan() || b[1].is_nan() || b[0] >= b[1])
        {
            return Err(invalid(at, "low", format!("a cell from {} to {}", bound[0], bound[1])));
        }
        Ok(Self { variables, cells })
    }
}

impl Persist for Points {
    const KIND: &'static str = "points of random input";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let points = label("1", "germs of each point", &["point", "germ"]);
        save_dense(at, "points", matrix(&self.points).as_ref(), &points)?;
        save_vector(at, "weights", &self.weights, &label("1", "weights, sum 1", &["point"]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (points, weights) = (rows(at, "points")?, load_vector(at, "weights")?);
        if points.len() != weights.len() {
            return Err(invalid(at, "weights", format!("{} of {} points", weights.len(), points.len())));
        }
        Ok(Self { points, weights })
    }
}

impl Persist for Moments {
    const KIND: &'static str = "moments";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_vector(at, "mean", &self.mean, &label("of the answer", "means", &["component"]))?;
        save_vector(at, "variance", &self.variance, &label("of its square", "variances", &["component"]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (mean, variance) = (load_vector(at, "mean")?, load_vector(at, "variance")?);
        if mean.len() != variance.len() {
            return Err(invalid(at, "variance", format!("{} of {} means", variance.len(), mean.len())));
        }
        Ok(Self { mean, variance })
    }
}
