//! Energy of a correction that tractions of one degree more do not see, on elements of degree 1.
//!
//! A smooth error of linear elements of length h is, up to terms of higher order, v = Σ c b of the bubbles b = (t²-1)/2 less
//! its mean: even about the middle of each element, so that tractions of degrees 0 and 1 are orthogonal to it. Of ⟨Sv, v⟩ =
//! ⟨Wv, v⟩ + ⟨V⁻¹(½+K)v, (½+K)v⟩ enriched spaces see the first term alone. With the symbols of a half plane,
//!
//! ```text
//! S = a |k|,  a = 4μ(1-ν)/(3-4ν)        W = w |k|,  w = μ/(2(1-ν))        along each component
//! v = Σ_n 2(-1)ⁿ/(n²π²) cos nπt         ⟨|k| v, v⟩ = Σ_n nπ (2/(n²π²))² = 4ζ(3)/π³ on each element
//! ```
//! the part that they do not see is (a - w) 4ζ(3)/π³ |c|², where c varies slowly from element to element. From degree 2 on
//! they see most. Where loads vary within an element more than its degree follows, c is theirs and varies as they do: it does
//! not count.

use std::f64::consts::PI;

use steklov_bem_operators::{Enriched, Mesh};
use steklov_elastic::Material;

/// ζ(3).
const ZETA: f64 = 1.202_056_903_159_594;

/// The sum of (a - w) 4ζ(3)/π³ |c|² over the elements of degree 1, of bodies and media on both sides of the mesh (energy:
/// force/thickness times length); `unresolved(e)`: whether loads vary so within element e.
pub(crate) fn unseen_by_tractions(
    mesh: &Mesh,
    correction: &Enriched,
    materials: &[Material],
    unresolved: &dyn Fn(usize) -> bool,
) -> f64 {
    let rest = |m: &Material| m.mu() * (4.0 * (1.0 - m.nu()) / (3.0 - 4.0 * m.nu()) - 0.5 / (1.0 - m.nu()));
    let stiffness: f64 = materials.iter().map(rest).sum();
    // the squares of displacements alone may leave the range of floating point
    let root = (4.0 * ZETA / PI.powi(3) * stiffness).sqrt();
    let linear = (0..mesh.len()).filter(|&e| mesh.degree[e] == 1 && !unresolved(e));
    linear.map(|e| (root * correction.extra[2 * e]).powi(2) + (root * correction.extra[2 * e + 1]).powi(2)).sum()
}

/// Energy that one degree more does not see on the elements at vertices of the exponents λ, of the energies that it sees
/// there: the error of r^λ falls as e_p² ~ p^(-4λ), so that the part 1 - (p/(p+1))^(4λ) of it is seen. `vertices`: the edges
/// before and behind, and λ.
pub(crate) fn unseen_at_vertices(mesh: &Mesh, vertices: &[([usize; 2], f64)], seen: &dyn Fn(usize) -> f64) -> f64 {
    let mut unseen = 0.0;
    for &([a, b], exponent) in vertices {
        for e in (0..mesh.len()).filter(|&e| mesh.edge[e] == a && mesh.edge[mesh.next[e]] == b) {
            for e in [e, mesh.next[e]] {
                let p = mesh.degree[e] as f64;
                let part = 1.0 - (p / (p + 1.0)).powf(4.0 * exponent);
                unseen += seen(e) * (1.0 / part - 1.0);
            }
        }
    }
    unseen
}

#[cfg(test)]
mod tests {
    use super::*;
    use steklov_quadrature::gauss_legendre;

    /// The cosines of the bubble less its mean, and the sum of their energies.
    #[test]
    fn the_energy_of_bubbles_is_that_of_their_cosines() {
        let rule = gauss_legendre(40);
        let mut sum = 0.0;
        for n in 1..=2000_i32 {
            let part = 2.0 * (-1.0_f64).powi(n) / f64::from(n * n) / PI.powi(2);
            if n <= 8 {
                let of = |t: f64| ((t * t - 1.0) / 2.0 + 1.0 / 3.0) * (f64::from(n) * PI * t).cos();
                let found: f64 = rule.points.iter().zip(&rule.weights).map(|(&t, w)| w * of(t)).sum();
                assert!((found - part).abs() < 1e-12, "{n}: {found} {part}");
            }
            sum += f64::from(n) * PI * part * part;
        }
        let whole = 4.0 * ZETA / PI.powi(3);
        assert!((sum - whole).abs() < 1e-6 * whole, "{sum} {whole}");
    }
}
