//! Random fields of finitely many germs.

use std::sync::OnceLock;

use crate::{
    CellKarhunenLoeve, CellSamples, Covariance, FieldCells, KarhunenLoeve, RectangleKarhunenLoeve, StochasticError,
    Truncation,
};

/// Samples a half wave where the steepness is looked for.
const SAMPLES: usize = 12;

/// The random field g(x, ξ) = Σ_m √λ_m b_m(x) ξ_m of mean 0 and, up to truncation, variance 1, for germs ξ_m with mean 0
/// and variance 1 that are not correlated.
///
/// Points are [x, y] in the rectangle, or [s, anything] on an interval with the arc length s. A field of cells has one value
/// in each, the mean over it, and 0 in cells that do not belong to the body; x, y are measured from the lower left of the grid.
///
/// A field of cells that is *drawn* as a whole has no expansion, but one germ that any method can draw: see [`CellSamples`].
///
/// Source: Issaoui (2014), equation (4.6).
#[derive(Debug, Clone)]
pub struct Field {
    expansion: Expansion,
    /// √λ_m.
    roots: Vec<f64>,
    /// [`Field::steepness`], once it was computed.
    steepness: OnceLock<Vec<f64>>,
}

#[derive(Debug, Clone)]
enum Expansion {
    Interval(KarhunenLoeve),
    Rectangle(RectangleKarhunenLoeve),
    Cells(CellKarhunenLoeve),
    Drawn(CellSamples),
}

impl From<CellSamples> for Field {
    fn from(samples: CellSamples) -> Self {
        Self { expansion: Expansion::Drawn(samples), roots: Vec::new(), steepness: OnceLock::new() }
    }
}

impl From<CellKarhunenLoeve> for Field {
    fn from(kl: CellKarhunenLoeve) -> Self {
        let roots = kl.eigenvalues().iter().map(|value| value.sqrt()).collect();
        Self { expansion: Expansion::Cells(kl), roots, steepness: OnceLock::new() }
    }
}

impl From<KarhunenLoeve> for Field {
    fn from(kl: KarhunenLoeve) -> Self {
        let roots = (0..kl.len()).map(|m| kl.eigenvalue(m).sqrt()).collect();
        Self { expansion: Expansion::Interval(kl), roots, steepness: OnceLock::new() }
    }
}

impl From<RectangleKarhunenLoeve> for Field {
    fn from(kl: RectangleKarhunenLoeve) -> Self {
        let roots = (0..kl.len()).map(|m| kl.eigenvalue(m).sqrt()).collect();
        Self { expansion: Expansion::Rectangle(kl), roots, steepness: OnceLock::new() }
    }
}

impl Field {
    /// Field on [0, `length`], the arc length of a side.
    ///
    /// # Errors
    /// Those of [`KarhunenLoeve::new`].
    pub fn interval(covariance: &Covariance, length: f64, truncation: Truncation) -> Result<Self, StochasticError> {
        Ok(KarhunenLoeve::new(covariance, length, truncation)?.into())
    }

    /// Field on [0, L_1] × [0, L_2].
    ///
    /// # Errors
    /// Those of [`RectangleKarhunenLoeve::new`].
    pub fn rectangle(
        covariance: &Covariance,
        sides: [f64; 2],
        truncation: Truncation,
    ) -> Result<Self, StochasticError> {
        Ok(RectangleKarhunenLoeve::new(covariance, sides, truncation)?.into())
    }

    /// Number of germs.
    pub fn len(&self) -> usize {
        if self.is_drawn() { 1 } else { self.roots.len() }
    }

    /// Whether it is drawn as a whole: its germ is no coordinate in which answers are smooth.
    pub fn is_drawn(&self) -> bool {
        matches!(self.expansion, Expansion::Drawn(_))
    }

    /// Whether there are no germs; never true.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Eigenvalues of the covariance, falling; none of a field that is drawn.
    pub fn eigenvalues(&self) -> Vec<f64> {
        self.roots.iter().map(|r| r * r).collect()
    }

    /// Lengths of the domain: one of an interval, two of a rectangle.
    pub fn sides(&self) -> Vec<f64> {
        match &self.expansion {
            Expansion::Interval(kl) => vec![kl.length()],
            Expansion::Rectangle(kl) => kl.sides().to_vec(),
            Expansion::Cells(_) | Expansion::Drawn(_) => {
                self.cells().map_or(Vec::new(), |FieldCells { cells, size, .. }| {
                    [0, 1].map(|d| size[d] * cells[d] as f64).to_vec()
                })
            }
        }
    }

    /// Share of the variance that is kept: the mean variance of the truncated field over the domain.
    pub fn captured(&self) -> f64 {
        match &self.expansion {
            Expansion::Interval(kl) => kl.captured(),
            Expansion::Rectangle(kl) => kl.captured(),
            Expansion::Cells(kl) => kl.captured(),
            Expansion::Drawn(samples) => 1.0 - samples.unresolved(),
        }
    }

    /// Share of the variance that the values cannot have, however many modes there are: of means over cells, else 0.
    pub fn unresolved(&self) -> f64 {
        match &self.expansion {
            Expansion::Cells(kl) => kl.unresolved(),
            Expansion::Drawn(samples) => samples.unresolved(),
            Expansion::Interval(_) | Expansion::Rectangle(_) => 0.0,
        }
    }

    /// The cells of a field that has one value in each.
    pub fn cells(&self) -> Option<&FieldCells> {
        match &self.expansion {
            Expansion::Cells(kl) => Some(kl.cells()),
            Expansion::Drawn(samples) => Some(samples.cells()),
            Expansion::Interval(_) | Expansion::Rectangle(_) => None,
        }
    }

    /// The values in all cells of a field that has one in each, for its germs.
    ///
    /// # Panics
    /// If there is not one germ a mode.
    pub fn cell_values(&self, germs: &[f64]) -> Option<Vec<f64>> {
        match &self.expansion {
            Expansion::Cells(kl) => Some(kl.values(germs)),
            Expansion::Drawn(samples) => Some(samples.values(germs[0])),
            Expansion::Interval(_) | Expansion::Rectangle(_) => None,
        }
    }

    /// The field with the means over cells twice as large, for the same germs; a field without cells stays. None where cells do
    /// not fit together.
    pub fn coarsened(&self) -> Option<Self> {
        match &self.expansion {
            Expansion::Cells(kl) => Some(kl.coarsened()?.into()),
            Expansion::Drawn(samples) => Some(samples.coarsened()?.into()),
            Expansion::Interval(_) | Expansion::Rectangle(_) => Some(self.clone()),
        }
    }

    /// The field with other outcomes of its germs, but the same law, where they cost less: see [`CellSamples::redrawn`].
    pub fn redrawn(&self) -> Option<Self> {
        match &self.expansion {
            Expansion::Drawn(samples) => samples.redrawn().map(Into::into),
            _ => None,
        }
    }

    /// √λ_m b_m(x) of all modes; x is moved into the domain. Of a field that is drawn its deviation.
    pub fn modes(&self, x: [f64; 2]) -> Vec<f64> {
        let mut out = vec![0.0; self.len()];
        match &self.expansion {
            Expansion::Interval(kl) => kl.modes(x[0], &mut out),
            Expansion::Rectangle(kl) => kl.modes(x, &mut out),
            Expansion::Cells(kl) => {
                let cell = kl.cells().containing(x);
                out.iter_mut().enumerate().for_each(|(m, b)| *b = kl.mode(m)[cell]);
            }
            Expansion::Drawn(samples) => return vec![(1.0 - samples.unresolved()).sqrt()],
        }
        out.iter_mut().zip(&self.roots).for_each(|(b, root)| *b *= root);
        out
    }

    /// g(x, ξ).
    ///
    /// # Panics
    /// If there is not one germ a mode.
    pub fn value(&self, x: [f64; 2], germs: &[f64]) -> f64 {
        assert_eq!(germs.len(), self.len(), "one germ a mode");
        if let Expansion::Drawn(samples) = &self.expansion {
            return samples.values(germs[0])[samples.cells().containing(x)];
        }
        self.modes(x).iter().zip(germs).map(|(b, xi)| b * xi).sum()
    }

    /// Largest steepness max |∂_x √λ_m b_m|, |∂_y √λ_m b_m| of each mode (1/length), from differences of samples at 12 points
    /// a half wave of the last mode, and a tenth more. *Cost*: M values of modes at 12 (M + 4) points on an interval, at the
    /// product of those of both directions on a rectangle; taken once. Values that jump from cell to cell are infinitely steep.
    pub fn steepness(&self) -> &[f64] {
        self.steepness.get_or_init(|| {
            let (sides, waves) = match &self.expansion {
                Expansion::Interval(kl) => ([kl.length(), 0.0], [kl.len(), 0]),
                Expansion::Rectangle(kl) => (kl.sides(), kl.waves()),
                Expansion::Cells(_) | Expansion::Drawn(_) => return vec![f64::INFINITY; self.len()],
            };
            let samples = waves.map(|w| if w == 0 { 1 } else { SAMPLES * (w + 4) });
            let step = [0, 1].map(|d| sides[d] / samples[d] as f64);
            let row = |i: usize| -> Vec<Vec<f64>> {
                let x = i as f64 * step[0];
                (0..=samples[1]).map(|j| self.modes([x, j as f64 * step[1]])).collect()
            };
            let mut steepest = vec![0.0f64; self.len()];
            let mut take = |a: &[f64], b: &[f64], step: f64| {
                if step > 0.0 {
                    let slopes = a.iter().zip(b).map(|(a, b)| 1.1 * (a - b).abs() / step);
                    steepest.iter_mut().zip(slopes).for_each(|(s, slope)| *s = s.max(slope));
                }
            };
            let mut before = row(0);
            for i in 1..=samples[0] {
                let here = row(i);
                before.iter().zip(&here).for_each(|(a, b)| take(a, b, step[0]));
                here.windows(2).for_each(|pair| take(&pair[0], &pair[1], step[1]));
                before = here;
            }
            steepest
        })
    }
}
