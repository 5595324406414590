//! A random field of covariance C(r) = exp(-r/ℓ) on [0, 1]: κ(x) = Σ √λ_m b_m(x) ξ_m with ∫ C(|x-y|) b_m(y) dy = λ_m b_m(x).
//!
//! λ_m = 2ℓ / (1 + ℓ²ω_m²), where θ_m = ω_m/2 is the root of θ tan θ = q (m = 0, 2, …) or θ + q tan θ = 0 (m = 1, 3, …) in
//! (mπ/2, (m+1)π/2), q = 1/2ℓ (Ghanem and Spanos, *Stochastic Finite Elements*, section 2.3).
//! For ℓ = ½ they are .5746552, .1954706, .0785246, .0397783, …

use std::error::Error;
use std::f64::consts::FRAC_PI_2;

use steklov_stochastic::{Covariance, KarhunenLoeve, Kernel, Truncation, Variable, sample};

/// Modes that are kept, and samples that are drawn.
const MODES: usize = 8;
const SAMPLES: u64 = 20_000;

fn main() -> Result<(), Box<dyn Error>> {
    let (length, q) = (0.5, 1.0);
    let eigenvalue = |m: usize| {
        let (mut low, mut high) = (m as f64 * FRAC_PI_2, (m + 1) as f64 * FRAC_PI_2);
        for _ in 0..60 {
            let theta = 0.5 * (low + high);
            let rising = if m.is_multiple_of(2) { theta * theta.tan() - q } else { theta + q * theta.tan() };
            if rising > 0.0 { high = theta } else { low = theta }
        }
        2.0 * length / (1.0 + (length * (low + high)).powi(2))
    };
    let covariance = Covariance { kernel: Kernel::Exponential, correlation: [length; 2] };
    let expansion = KarhunenLoeve::new(&covariance, 1.0, Truncation::Modes(MODES))?;
    for m in 0..MODES {
        println!("λ_{m} = {:.10}, by its equation {:.10}", expansion.eigenvalue(m), eigenvalue(m));
        assert!((expansion.eigenvalue(m) / eigenvalue(m) - 1.0).abs() < 1e-11);
    }
    for (m, published) in [0.5746552, 0.1954706, 0.0785246, 0.0397783].into_iter().enumerate() {
        assert!((expansion.eigenvalue(m) - published).abs() < 5.1e-8);
    }

    // samples at two points: their covariance is Σ λ_m b_m(x) b_m(y) but for five standard errors
    let (mut at_x, mut at_y) = ([0.0; MODES], [0.0; MODES]);
    expansion.modes(0.3, &mut at_x);
    expansion.modes(0.5, &mut at_y);
    let germs = vec![Variable::normal(0.0, 1.0)?; MODES];
    let value = |modes: &[f64; MODES], xi: &[f64]| -> f64 {
        (0..MODES).map(|m| expansion.eigenvalue(m).sqrt() * modes[m] * xi[m]).sum()
    };
    let drawn = (0..SAMPLES).map(|index| sample(&germs, 1, index)).map(|xi| value(&at_x, &xi) * value(&at_y, &xi));
    let (found, error) = (drawn.sum::<f64>() / SAMPLES as f64, 5.0 * (2.0 / SAMPLES as f64).sqrt());
    let exact: f64 = (0..MODES).map(|m| expansion.eigenvalue(m) * at_x[m] * at_y[m]).sum();
    println!(
        "covariance of samples {found:.4}, of {MODES} modes {exact:.4} ± {error:.4}, of all {:.4}",
        (-0.2f64 / length).exp()
    );
    assert!((found - exact).abs() < error);
    Ok(())
}
