//! Karhunen-Loève expansions on an interval.

use crate::covariance::check_length;
use crate::exponential::Exponential;
use crate::galerkin::{Piecewise, galerkin, nystrom};
use crate::{Covariance, Kernel, StochasticError};

/// Most modes.
pub(crate) const LIMIT: usize = 10_000;
/// Eigenvalues below this part of the largest are roundoff.
pub(crate) const ROUNDOFF: f64 = 1e-12;
/// Largest length over correlation length where eigenpairs are computed by discretisation.
const LONGEST: f64 = 256.0;
/// Most unknowns of a discrete eigenvalue problem.
const UNKNOWNS: usize = 4096;
/// Degree of the elements that [`KarhunenLoeve::new`] takes; two modes an element are resolved by it.
const DEGREE: usize = 15;
/// Most elements of that degree.
const ELEMENTS: usize = 128;

/// Where an expansion ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Truncation {
    /// After this many modes, at least 1.
    Modes(usize),
    /// After the fewest modes that carry this share of the variance, above 0 and below 1.
    Captured(f64),
}

/// Eigenpairs of a covariance C on the interval [0, L], largest first: ∫_0^L C(x-y) b_m(y) dy = λ_m b_m(x).
///
/// C has C(0) = 1, so all λ_m sum up to L. Modes are orthonormal in L²(0, L), in 1/√length, and start with a positive
/// value: for the kernels of [`Kernel`] b_m(0) never vanishes, so signs do not change with the data.
/// The field Σ √λ_m b_m(x) ξ_m of uncorrelated ξ_m with mean 0 and variance 1 has the covariance
/// Σ λ_m b_m(x) b_m(y), which is C up to truncation. Uncorrelated ξ_m are independent only if they are Gaussian; for
/// others independence is an assumption of the model.
///
/// ```
/// use steklov_stochastic::{Covariance, KarhunenLoeve, Kernel, Truncation};
/// let covariance = Covariance { kernel: Kernel::Exponential, correlation: [0.5; 2] };
/// let kl = KarhunenLoeve::new(&covariance, 1.0, Truncation::Captured(0.95))?;
/// assert_eq!(kl.len(), 9);
/// assert!(kl.captured() >= 0.95 && (kl.eigenvalue(0) - 0.5746552163).abs() < 1e-10);
/// # Ok::<(), steklov_stochastic::StochasticError>(())
/// ```
#[derive(Debug, Clone)]
pub struct KarhunenLoeve {
    length: f64,
    /// λ_m/L.
    pub(crate) shares: Vec<f64>,
    modes: Modes,
}

/// The parts of a [`KarhunenLoeve`].
#[derive(Debug, Clone, PartialEq)]
pub struct IntervalParts {
    /// L.
    pub length: f64,
    /// λ_m/L.
    pub shares: Vec<f64>,
    /// The modes of the unit interval.
    pub modes: ModeParts,
}

/// Modes of the unit interval, in closed form or by polynomials.
#[derive(Debug, Clone, PartialEq)]
pub enum ModeParts {
    /// Modes of the exponential covariance.
    Exponential {
        /// q = L/(2ℓ).
        q: f64,
        /// z_m of z tan θ = q.
        roots: Vec<f64>,
    },
    /// Orthonormal Legendre polynomials on equal elements.
    Piecewise {
        /// Number of elements.
        elements: usize,
        /// Their degree.
        degree: usize,
        /// A mode a row, degree + 1 coefficients an element.
        coefficients: Vec<Vec<f64>>,
    },
}

/// Modes of the unit interval.
#[derive(Debug, Clone)]
enum Modes {
    Exponential(Exponential),
    Piecewise(Piecewise),
}

impl KarhunenLoeve {
    /// Expansion of a covariance of [`Kernel`] on [0, `length`], by the method that suits it.
    ///
    /// *Exponential*: closed form, relative error of λ_m 1e-12 at any correlation length; up to 10 000 modes; O(1) a mode.
    /// *Gaussian*: Nyström's method at Gauss points, error 1e-14 λ_1. *Matérn*: [`galerkin`](Self::galerkin) with degree 15 and
    /// one element for two modes, up to 256 modes, relative error of λ_m 1e-11. Both of these need ℓ ≥ L/256;
    /// O(N³), N unknowns.
    ///
    /// # Errors
    /// [`StochasticError::Number`] if a length is not positive or the truncation senseless; [`StochasticError::Modes`] and
    /// [`StochasticError::Captured`] if there are not enough modes; [`StochasticError::Unresolved`] if ℓ < L/256.
    ///
    /// Source: Ghanem and Spanos, Stochastic Finite Elements (1991), section 2.3; Betz, Papaioannou and Straub, Comput.
    /// Methods Appl. Mech. Engrg. 271 (2014).
    pub fn new(covariance: &Covariance, length: f64, truncation: Truncation) -> Result<Self, StochasticError> {
        Self::along(covariance.kernel, covariance.correlation[0], length, truncation)
    }

    fn along(kernel: Kernel, correlation: f64, length: f64, truncation: Truncation) -> Result<Self, StochasticError> {
        kernel.check()?;
        if kernel.is_product() {
            let all = Self::all(kernel, correlation, length)?;
            let count = kept(&all.shares, truncation)?;
            return Ok(all.truncated(count));
        }
        check(length, truncation)?;
        let ratio = resolved(correlation, length)?;
        if let Truncation::Modes(wanted) = truncation
            && wanted > 2 * ELEMENTS
        {
            return Err(StochasticError::Modes { wanted, available: 2 * ELEMENTS });
        }
        // no element is longer than 2ℓ
        let mut elements = 2 * ((0.25 * ratio).ceil() as usize).max(4);
        loop {
            let (shares, piecewise) = galerkin(|r| kernel.value(r * ratio), elements, DEGREE)?;
            let all = Self::discrete(length, shares, piecewise)?.truncated(2 * elements);
            match kept(&all.shares, truncation) {
                Ok(count) => return Ok(all.truncated(count)),
                Err(error) if elements == ELEMENTS => return Err(error),
                Err(_) => elements = (2 * elements).min(ELEMENTS),
            }
        }
    }

    /// Every available mode of the exponential or the Gaussian covariance.
    pub(crate) fn all(kernel: Kernel, correlation: f64, length: f64) -> Result<Self, StochasticError> {
        check_length("the length of the interval", length)?;
        if kernel == Kernel::Exponential {
            check_length("the correlation length", correlation)?;
            let ratio = length / correlation;
            check_length("the length over the correlation length", ratio)?;
            let modes = Exponential::new(0.5 * ratio, LIMIT);
            let shares = (0..LIMIT).map(|k| modes.eigenvalue(k)).collect();
            return Ok(Self { length, shares, modes: Modes::Exponential(modes) });
        }
        let ratio = resolved(correlation, length)?;
        // exp(-(r/ℓ)²) has wave numbers up to 12/ℓ, so its Legendre series ends at 6 L/ℓ, or soon for long ℓ
        let points = 2 * (12 + (3.5 * ratio).ceil() as usize);
        let (shares, piecewise) = nystrom(|r| kernel.value(r * ratio), points)?;
        Self::discrete(length, shares, piecewise)
    }

    /// Expansion of any covariance of a distance, C(0) = 1, by Galerkin's method with discontinuous Legendre elements.
    ///
    /// *Use when*: C has a kink at distance 0 and is smooth elsewhere. The kink is integrated exactly. *Fails when*: an
    /// element is longer than the scale on which C changes, or than half a wave of the last mode at low degree; eigenvalues
    /// are too small then, by a part of the order (m h/L)^(2p+2) for degree p and elements of length h. *Cost*: eigenpairs of
    /// two matrices of size elements (degree + 1)/2, elements being rounded up to an even number.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`StochasticError::Number`] if C(0) ≠ 1, C is not positive semi-definite, or the unknowns
    /// are more than 4096.
    ///
    /// Source: Betz, Papaioannou and Straub (2014); Duffy (1982) for the triangles.
    pub fn galerkin(
        kernel: impl Fn(f64) -> f64 + Sync,
        length: f64,
        elements: usize,
        degree: usize,
        truncation: Truncation,
    ) -> Result<Self, StochasticError> {
        check(length, truncation)?;
        let elements = 2 * elements.div_ceil(2).max(1);
        check_kernel(&kernel, elements.saturating_mul(degree.saturating_add(1)))?;
        let (shares, piecewise) = galerkin(|r| kernel(r * length), elements, degree)?;
        let all = Self::discrete(length, shares, piecewise)?;
        let count = kept(&all.shares, truncation)?;
        Ok(all.truncated(count))
    }

    /// The eigenpairs above roundoff.
    fn discrete(length: f64, shares: Vec<f64>, modes: Piecewise) -> Result<Self, StochasticError> {
        if !shares.iter().all(|s| s.is_finite()) {
            return Err(StochasticError::Decomposition { size: shares.len() });
        }
        let smallest = shares[shares.len() - 1];
        if smallest < -1e-8 * shares[0] {
            let what = "the smallest eigenvalue of the covariance, over the length,".to_string();
            return Err(StochasticError::Number { what, value: smallest, wanted: "not negative" });
        }
        let count = shares.iter().take_while(|&&s| s > ROUNDOFF * shares[0]).count();
        Ok(Self { length, shares, modes: Modes::Piecewise(modes) }.truncated(count))
    }

    pub(crate) fn truncated(mut self, count: usize) -> Self {
        self.shares.truncate(count);
        match &mut self.modes {
            Modes::Exponential(e) => e.roots.truncate(count),
            Modes::Piecewise(p) => p.modes.truncate(count),
        }
        self
    }

    /// The parts of the expansion, to store it.
    pub fn parts(&self) -> IntervalParts {
        let modes = match &self.modes {
            Modes::Exponential(e) => ModeParts::Exponential { q: e.q, roots: e.roots.clone() },
            Modes::Piecewise(p) => {
                ModeParts::Piecewise { elements: p.elements, degree: p.degree, coefficients: p.modes.clone() }
            }
        };
        IntervalParts { length: self.length, shares: self.shares.clone(), modes }
    }

    /// The expansion of stored parts.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] for parts that do not fit together.
    pub fn from_parts(parts: IntervalParts) -> Result<Self, StochasticError> {
        let IntervalParts { length, shares, modes } = parts;
        let (count, fits) = match &modes {
            ModeParts::Exponential { q, roots } => (roots.len(), *q > 0.0 && roots.iter().all(|z| z.is_finite())),
            ModeParts::Piecewise { elements, degree, coefficients } => {
                let size = degree.checked_add(1).and_then(|n| n.checked_mul(*elements));
                (coefficients.len(), *elements > 0 && coefficients.iter().all(|c| Some(c.len()) == size))
            }
        };
        if !(fits && count == shares.len() && count > 0 && length > 0.0 && length.is_finite()) {
            let what = format!("{} eigenvalues and {count} modes on a length of {length} do not fit", shares.len());
            return Err(StochasticError::Inconsistent { what });
        }
        let modes = match modes {
            ModeParts::Exponential { q, roots } => Modes::Exponential(Exponential { q, roots }),
            ModeParts::Piecewise { elements, degree, coefficients } => {
                Modes::Piecewise(Piecewise { elements, degree, modes: coefficients })
            }
        };
        Ok(Self { length, shares, modes })
    }

    /// L.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Number of modes.
    pub fn len(&self) -> usize {
        self.shares.len()
    }

    /// Whether there are no modes; never true.
    pub fn is_empty(&self) -> bool {
        self.shares.is_empty()
    }

    /// λ_m, a length.
    ///
    /// # Panics
    /// If there is no mode m.
    pub fn eigenvalue(&self, m: usize) -> f64 {
        self.shares[m] * self.length
    }

    /// Share of the variance in the modes, Σ λ_m/L ≤ 1.
    pub fn captured(&self) -> f64 {
        captured(&self.shares)
    }

    /// b_m(x) of all modes; x is moved into [0, L].
    ///
    /// # Panics
    /// If `out` has another length than the expansion.
    pub fn modes(&self, x: f64, out: &mut [f64]) {
        assert_eq!(out.len(), self.len(), "one value a mode");
        let unit = (x / self.length).clamp(0.0, 1.0);
        match &self.modes {
            Modes::Exponential(e) => out.iter_mut().enumerate().for_each(|(k, b)| *b = e.mode(k, unit)),
            Modes::Piecewise(p) => p.evaluate(unit, out),
        }
        let scale = self.length.sqrt().recip();
        out.iter_mut().for_each(|b| *b *= scale);
    }
}

/// Σ λ_m/|D|, at most 1 in spite of rounding.
pub(crate) fn captured(shares: &[f64]) -> f64 {
    shares.iter().sum::<f64>().min(1.0)
}

/// Refuses a truncation that makes no sense, and a length.
pub(crate) fn check(length: f64, truncation: Truncation) -> Result<(), StochasticError> {
    check_length("the length of the interval", length)?;
    match truncation {
        Truncation::Modes(0) => {
            Err(StochasticError::Number { what: "the number of modes".to_string(), value: 0.0, wanted: "at least 1" })
        }
        Truncation::Captured(share) if !(share > 0.0 && share < 1.0) => Err(StochasticError::Number {
            what: "the captured share of the variance".to_string(),
            value: share,
            wanted: "above 0 and below 1 (all of it takes infinitely many modes)",
        }),
        _ => Ok(()),
    }
}

/// L/ℓ, if discretisation resolves it.
fn resolved(correlation: f64, length: f64) -> Result<f64, StochasticError> {
    check_length("the correlation length", correlation)?;
    let ratio = length / correlation;
    if ratio > LONGEST {
        return Err(StochasticError::Unresolved { correlation, length, shortest: length / LONGEST });
    }
    Ok(ratio)
}

/// Refuses a kernel that is not 1 at 0, and too many unknowns.
fn check_kernel(kernel: impl Fn(f64) -> f64, unknowns: usize) -> Result<(), StochasticError> {
    let (what, value) = ("the covariance at distance 0".to_string(), kernel(0.0));
    if value.is_nan() || (value - 1.0).abs() > 1e-12 {
        return Err(StochasticError::Number { what, value, wanted: "1" });
    }
    if unknowns > UNKNOWNS {
        let (what, value) = ("the number of unknowns".to_string(), unknowns as f64);
        return Err(StochasticError::Number { what, value, wanted: "at most 4096" });
    }
    Ok(())
}

/// How many of the descending `shares` a truncation keeps.
pub(crate) fn kept(shares: &[f64], truncation: Truncation) -> Result<usize, StochasticError> {
    check(1.0, truncation)?;
    let available = shares.len();
    match truncation {
        Truncation::Modes(wanted) if wanted > available => Err(StochasticError::Modes { wanted, available }),
        Truncation::Modes(wanted) => Ok(wanted),
        Truncation::Captured(wanted) => {
            let mut sum = 0.0;
            let reached = shares.iter().position(|s| {
                sum += s;
                sum >= wanted
            });
            let all = || StochasticError::Captured { wanted, captured: captured(shares), modes: available };
            reached.map(|m| m + 1).ok_or_else(all)
        }
    }
}
