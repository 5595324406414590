//! [`Persist`] for the types of `steklov-stochastic`.

use faer::Mat;
use hdf5::Group;
use steklov_stochastic::{
    Distribution, IntervalParts, KarhunenLoeve, ModeParts, Moments, Points, StochasticCell, StochasticMesh, Truncation,
    Variable,
};

use crate::array::{load_integers, load_number, load_vector, save_integers, save_number, save_vector};
use crate::dataset::label;
use crate::error::{IoError, invalid, missing};
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

/// The variable of a stored law, its parameters and its interval.
fn variable(name: &str, parameters: &[f64], interval: &[f64]) -> Result<Variable, String> {
    let (&[p, q], &[low, high]) = (parameters, interval) else {
        return Err(format!("{} parameters and {} ends, not 2 each", parameters.len(), interval.len()));
    };
    let distribution = match name {
        "uniform" if [p, q] != [0.0; 2] => return Err(format!("{p} and {q} of a uniform law, which has none: 0")),
        "uniform" => Distribution::Uniform,
        "normal" => Distribution::Normal { mean: p, deviation: q },
        "lognormal" => Distribution::Lognormal { mean: p, deviation: q },
        "beta" => Distribution::Beta { alpha: p, beta: q },
        other => return Err(format!("the distribution {other:?} is none")),
    };
    Variable::new(distribution, low, high).map_err(|e| e.to_string())
}

impl Persist for Variable {
    const KIND: &'static str = "random variable";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let (name, parameters) = law(self.distribution());
        save_text(at, "distribution", name, "law before the restriction: uniform, normal, lognormal or beta")?;
        let meaning = label("of the law", "mean and deviation, or alpha and beta; 0 of a uniform one", &["parameter"]);
        save_vector(at, "parameters", &parameters, &meaning)?;
        let meaning = "low and high, on which the law is conditioned: density / (F(high) - F(low))";
        save_vector(at, "interval", &self.interval(), &label("of the variable", meaning, &["end"]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (name, parameters) = (load_text(at, "distribution")?, load_vector(at, "parameters")?);
        variable(&name, &parameters, &load_vector(at, "interval")?).map_err(|why| invalid(at, "parameters", why))
    }
}

impl Persist for Truncation {
    const KIND: &'static str = "end of an expansion";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        match *self {
            Self::Modes(modes) => {
                save_integers(at, "modes", &[modes], &label("1", "number of modes, 1 or more", &["value"]))
            }
            Self::Captured(share) => {
                let meaning = "share of the variance that the modes carry: sum of lambda_m / L >= captured, in (0, 1)";
                save_number(at, "captured", share, "1", meaning)
            }
        }
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        match (at.link_exists("modes"), at.link_exists("captured")) {
            (true, true) => Err(invalid(at, "captured", "there are modes, too")),
            (false, true) => match load_number(at, "captured")? {
                share if share > 0.0 && share < 1.0 => Ok(Self::Captured(share)),
                share => Err(invalid(at, "captured", format!("{share} is no share above 0 and below 1"))),
            },
            (false, false) => Err(missing(at, "modes, nor captured")),
            (true, false) => match load_integers(at, "modes")?[..] {
                [modes] if modes > 0 => Ok(Self::Modes(modes)),
                ref other => Err(invalid(at, "modes", format!("{other:?} is no number of modes, 1 or more"))),
            },
        }
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
        let laws = names.iter().zip(&parameters).zip(&intervals);
        let variables: Result<Vec<Variable>, String> = laws.map(|((name, p), i)| variable(name, p, i)).collect();
        let variables = variables.map_err(|why| invalid(at, "parameters", why))?;
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
