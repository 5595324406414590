//! Karhunen-Loève expansions of random fields on intervals and rectangles.

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use rayon::prelude::*;
use steklov_stochastic::{Covariance, Kernel, RectangleKarhunenLoeve, Truncation};

use crate::blocks::{array, failed, unknown, work, wrong};

/// Most values of modes at a time.
const MOST: usize = 1 << 28;

enum Expansion {
    Interval(steklov_stochastic::KarhunenLoeve),
    Rectangle(RectangleKarhunenLoeve),
}

/// Eigenpairs of a covariance.
#[pyclass(frozen)]
pub struct KarhunenLoeve {
    covariance: Covariance,
    expansion: Expansion,
}

#[pymethods]
impl KarhunenLoeve {
    /// One side for an interval, two for a rectangle; so many modes, or those that carry a share.
    #[new]
    fn new(
        py: Python<'_>,
        kernel: &str,
        smoothness: f64,
        correlation: [f64; 2],
        sides: Vec<f64>,
        modes: Option<usize>,
        captured: Option<f64>,
    ) -> PyResult<Self> {
        let kernel = match kernel {
            "exponential" => Kernel::Exponential,
            "gaussian" => Kernel::Gaussian,
            "matern" => Kernel::Matern { smoothness },
            _ => return Err(unknown(py, "kernel", kernel)),
        };
        let truncation = match (modes, captured) {
            (Some(modes), None) => Truncation::Modes(modes),
            (None, Some(share)) => Truncation::Captured(share),
            _ => return Err(wrong(py, "an expansion ends by modes or by captured: give one of both")),
        };
        let covariance = Covariance { kernel, correlation };
        let made = work(py, || match sides[..] {
            [length] => {
                Some(steklov_stochastic::KarhunenLoeve::new(&covariance, length, truncation).map(Expansion::Interval))
            }
            [x, y] => Some(RectangleKarhunenLoeve::new(&covariance, [x, y], truncation).map(Expansion::Rectangle)),
            _ => None,
        })?;
        let Some(made) = made else {
            return Err(wrong(py, format!("{} sides: an interval has 1 and a rectangle 2", sides.len())));
        };
        made.map(|expansion| Self { covariance, expansion }).map_err(|error| failed(py, error))
    }

    fn eigenvalues<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let eigenvalue = |m: usize| match &self.expansion {
            Expansion::Interval(of) => of.eigenvalue(m),
            Expansion::Rectangle(of) => of.eigenvalue(m),
        };
        array(py, (0..self.len()).map(eigenvalue).collect(), &[self.len()])
    }

    fn captured(&self) -> f64 {
        match &self.expansion {
            Expansion::Interval(of) => of.captured(),
            Expansion::Rectangle(of) => of.captured(),
        }
    }

    /// All modes at points, a row for each; as many columns of coordinates as sides.
    fn modes<'py>(&self, py: Python<'py>, points: PyReadonlyArray2<'_, f64>) -> PyResult<Bound<'py, PyAny>> {
        let (points, count) = (points.as_array(), self.len());
        if points.ncols() != self.dimensions() || points.iter().any(|x| !x.is_finite()) {
            return Err(wrong(py, format!("points have {} finite coordinates", self.dimensions())));
        }
        let rows = points.nrows();
        if rows.saturating_mul(count) > MOST {
            let what =
                format!("{rows} points with {count} modes are more than {MOST} values: take fewer points at a time");
            return Err(wrong(py, what));
        }
        let points: Vec<[f64; 2]> = points.rows().into_iter().map(|row| [row[0], row[row.len() - 1]]).collect();
        let values = work(py, || {
            let mut values = vec![0.0; rows * count];
            values.par_chunks_mut(count).zip(&points).for_each(|(row, &point)| match &self.expansion {
                Expansion::Interval(of) => of.modes(point[0], row),
                Expansion::Rectangle(of) => of.modes(point, row),
            });
            values
        })?;
        array(py, values, &[rows, count])
    }

    /// The covariance of points that are these distances apart, as many columns as sides.
    fn covariance<'py>(&self, py: Python<'py>, distances: PyReadonlyArray2<'_, f64>) -> PyResult<Bound<'py, PyAny>> {
        let distances = distances.as_array();
        if distances.ncols() != self.dimensions() {
            return Err(wrong(py, format!("distances have {} coordinates", self.dimensions())));
        }
        let value = |[x, y]: [f64; 2]| match &self.expansion {
            Expansion::Interval(_) => self.covariance.on_interval(x),
            Expansion::Rectangle(_) => self.covariance.on_rectangle(x, y),
        };
        let values: Vec<f64> = distances.rows().into_iter().map(|row| value([row[0], row[row.len() - 1]])).collect();
        let count = values.len();
        array(py, values, &[count])
    }
}

impl KarhunenLoeve {
    fn len(&self) -> usize {
        match &self.expansion {
            Expansion::Interval(of) => of.len(),
            Expansion::Rectangle(of) => of.len(),
        }
    }

    fn dimensions(&self) -> usize {
        match self.expansion {
            Expansion::Interval(_) => 1,
            Expansion::Rectangle(_) => 2,
        }
    }
}
