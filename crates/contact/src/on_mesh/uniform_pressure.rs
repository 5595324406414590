//! The uniform pressure in the stabilisation: what ν → ½ does to it, and its damping.
//!
//! With ∫_Γ u·n = V the strain energy is at least λ V²/(2|Ω|), λ Lamé's constant, and σ^h(u) has the constant pressure -λ V/|Ω| in
//! it. Along this one direction
//!
//! ```text
//! ∫ γ |σ^h|² / <S u, u>  →  (γ₀λ/|Ω|) ∫_Γc h/p² = γ₀E x,     x = (λ/E) Σ (h/p²)|J| / |Ω|
//! ```
//! and the critical γ₀ is 1/(xE) at most: it falls like 1-2ν, though all other directions are as coercive as ever. With the weights
//! w h/p² of the rule, π_i = (w h/p²)^½ of norm 1 is the constant pressure. Normal stresses, not shears, are multiplied by
//!
//! ```text
//! Q = I - (1-√ρ) π πᵀ,     ρ = 1/(1+x)
//! ∫ γ r_n v_n   becomes   ∫ γ r_n v_n - (1-ρ) ∫γ r_n ∫γ v_n / ∫γ                  r_n = λ_n + n·σ^h(u) + τ_n
//! ```
//! The form stays symmetric, consistent (r = 0 for the solution) and a sum of squares, on which the critical γ₀ and the elimination
//! rest; along the constant it is at most γ₀E x/(1+x) < γ₀E. Q is regular: λ_n's constant is kept, by b(λ, v) alone where ρ → 0.
//! That is enough: every displacement space
//! has motions that press all of Γ_c, so that β is as without the constant (0.75 and more where it was 0.02 at ν = 0.49999).
//!
//! x falls with h and with p^-2: away from ν = ½ nothing changes but on the coarsest meshes. In plane stress λ = E ν/(1-ν²) is at
//! most ⅔ E. In an exterior domain the body gives way to any V: ρ = 1.
//!
//! *Fails when* a wall of an almost incompressible body is no thicker than a few elements are long: σ^h has more pressures there
//! that cost little energy. Of p = 1 and ν = 0.49999 critical γ₀E is 0.1 at four elements across and 0.03 at one, in place of 0.5.
//!
//! The bound of the energy is Cauchy's inequality for ∫ div u = V.

use faer::Mat;
use steklov_bem_operators::Mesh;
use steklov_elastic::Material;
use steklov_elastic::plane::cross;

/// Q on the points of the stabilisation's rule.
pub(crate) struct UniformPressure {
    /// π.
    direction: Vec<f64>,
    /// 1-√ρ.
    pub(crate) part: f64,
}

impl UniformPressure {
    /// `weights`: (w h/p²)^½ at the points.
    pub(crate) fn new(mesh: &Mesh, material: &Material, weights: &[f64]) -> Self {
        let total: f64 = weights.iter().map(|w| w * w).sum();
        let area = area(mesh);
        let x = if area > 0.0 { material.lambda() / material.young * total / area } else { 0.0 };
        Self::of(weights, 1.0 - (1.0 + x.max(0.0)).powf(-0.5))
    }

    /// With `part` for 1-√ρ.
    pub(crate) fn of(weights: &[f64], part: f64) -> Self {
        let total: f64 = weights.iter().map(|w| w * w).sum();
        Self { direction: weights.iter().map(|w| w / total.sqrt()).collect(), part }
    }

    /// Q v of one function at the points.
    pub(crate) fn damp(&self, v: &mut [f64]) {
        let mean: f64 = v.iter().zip(&self.direction).map(|(v, d)| v * d).sum();
        v.iter_mut().zip(&self.direction).for_each(|(v, d)| *v -= self.part * mean * d);
    }

    /// Q A: points × unknowns.
    pub(crate) fn damp_columns(&self, a: &mut Mat<f64>) {
        (0..a.ncols()).for_each(|j| self.damp(a.col_as_slice_mut(j)));
    }
}

/// Signed area within a mesh: less its holes, negative outside of one.
fn area(mesh: &Mesh) -> f64 {
    let triangle = |e: usize| {
        let [a, b] = mesh.ends(e);
        0.5 * cross(a, b)
    };
    (0..mesh.len()).map(triangle).sum()
}
