//! Rates of the errors: over the size H of coarse cells on the scene, over the period ε of layers on coarse cells of one size.
//!
//! Theorems of the kind ‖u - u_H‖ ≤ C H and ≤ C H² for energy and L² norm hold for H below the scale of the moduli;
//! above it C₁ H + C₂ (ε/H)^½ and C₁ H² + C₂ ε/H bound both. At least the last three errors are fitted; fewer give no
//! rate.

use super::laminates::LAMINATES;
use super::measure::{BASES, FITTED};
use super::{Convergence, Laminates};
use crate::fit::{Fit, Law, fit};
use crate::table::Column;

/// The rates of the errors of a basis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// 0 over H on the scene; 1 and 2 over ε on the laminates.
    pub over: usize,
    /// Number in [`BASES`].
    pub basis: usize,
    /// r of error = C H^r or C ε^r in the energy norm, and of the displacement in the L² norm; NaN if too few errors
    /// are known.
    pub rates: [f64; 2],
    /// R² of both fits.
    pub r_squared: [f64; 2],
}

/// Columns of the rates.
pub(super) const RATES: [Column<Rate>; 6] = [
    ("over", "1", "0 over H on the scene; over the period of straight (1) and diagonal (2) layers", |r| r.over as f64),
    ("basis", "1", "0 q1, 1 linear, 2 coupled, 3 oscillatory, 4 oversampled", |r| r.basis as f64),
    ("rate", "1", "r of error ~ H^r or period^r, energy norm", |r| r.rates[0]),
    ("displacement_rate", "1", "the same of the displacement, L2 norm", |r| r.rates[1]),
    ("r_squared", "1", "R^2 of the first, 1 for a perfect fit", |r| r.r_squared[0]),
    ("displacement_r_squared", "1", "R^2 of the second", |r| r.r_squared[1]),
];

/// The rates of all bases on the scene, then on both laminates.
pub fn rates(convergence: &Convergence, laminates: &Laminates) -> Vec<Rate> {
    let on_scene = (0..BASES.len()).filter_map(|basis| {
        let of = |p: &super::Point| (p.coarse[0], [p.error, p.displacement]);
        rate(0, basis, convergence.of(basis).map(of).collect())
    });
    let on_layers = (0..LAMINATES.len()).flat_map(|laminate| {
        (0..FITTED.len()).filter_map(move |fitted| {
            let basis = BASES.iter().position(|b| b == &FITTED[fitted])?;
            let of = |l: &super::Layers| (l.periods, [l.error, l.displacement]);
            rate(1 + laminate, basis, laminates.over_periods(laminate, fitted).map(of).collect())
        })
    });
    on_scene.chain(on_layers).collect()
}

/// The rates of errors over the number of cells or layers along x; None if neither is known.
fn rate(over: usize, basis: usize, errors: Vec<(usize, [f64; 2])>) -> Option<Rate> {
    let of = |k: usize| fit(Law::Algebraic, &errors.iter().map(|&(n, e)| (n, e[k])).collect::<Vec<_>>());
    let fits = [of(0), of(1)];
    let known = |value: fn(&Fit) -> f64| fits.map(|fit| fit.as_ref().map_or(f64::NAN, value));
    // n cells have the width 1/n
    let (rates, r_squared) = (known(|f| -f.rate), known(|f| f.r_squared));
    fits.iter().any(Option::is_some).then_some(Rate { over, basis, rates, r_squared })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_the_width_are_found() {
        let power = |n: usize| (n, [3.0 * (n as f64).powf(-0.75), 0.2 * (n as f64).powf(-1.5)]);
        let found = rate(0, 2, [12, 24, 48, 96].map(power).to_vec()).unwrap();
        assert!((found.rates[0] - 0.75).abs() < 1e-12 && (found.rates[1] - 1.5).abs() < 1e-12, "{found:?}");
        assert!(found.r_squared.iter().all(|r| (r - 1.0).abs() < 1e-12));
        assert_eq!(rate(0, 2, [12, 24].map(power).to_vec()), None);
        // one of the two rates may be unknown
        let one = rate(0, 2, [12, 24, 48].map(|n| (n, [f64::NAN, power(n).1[1]])).to_vec()).unwrap();
        assert!(one.rates[0].is_nan() && (one.rates[1] - 1.5).abs() < 1e-12, "{one:?}");
    }
}
