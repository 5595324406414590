//! The enriched matrices of a body, and with a medium around it of both, as an estimate uses them.
//!
//! With u the displacement of the body and ξ = u - u0 that of the medium, the forces on the bubbles and their W_bb are sums over both,
//! and so is S₊; there are two traction residuals, of u inside and of ξ outside:
//!
//! ```text
//! ρ_u = t0(b) - ⟨W u + (K'+½)ψ_i, b⟩ - ⟨W ξ + (K'-½)ψ_e, b⟩        ρ_ψ = (⟨(K+½)u - Vψ_i, P_p⟩, ⟨(½-K)ξ - Vψ_e, P_p⟩)
//! ```
//! What the nodes leave of u0 is no part of that: its solution, which has no jump of tractions, is orthogonal in the energy of
//! body and medium to all that has no jump of displacements.

use steklov_bem_operators::{BemError, Enriched, EnrichedSteklov, PairCache};

use crate::body::{Body, Factors};

/// What S₊ of the enriched spaces needs besides S, of a body and of the medium around it.
pub struct EnrichedBody {
    body: EnrichedSteklov,
    outside: Option<EnrichedSteklov>,
}

impl EnrichedBody {
    /// Of a body whose operators are of the moments in `cache`: solved as one that is to be estimated.
    ///
    /// # Errors
    /// Those of [`EnrichedSteklov::new`].
    pub fn new(body: &Body, cache: &mut PairCache) -> Result<Self, BemError> {
        let of_mesh = (&body.mesh, &body.space);
        let outside = body.outside.as_ref().map(|outside| outside.enriched(of_mesh, cache)).transpose()?;
        let body = EnrichedSteklov::new(of_mesh, &body.material, body.length, &body.traction_map, cache)?;
        Ok(Self { body, outside })
    }
}

/// Displacements and the enriched matrices that they belong to: of the body, and of the medium around it.
pub(crate) struct Elastic<'a> {
    parts: Vec<(&'a EnrichedSteklov, &'a [f64])>,
}

impl<'a> Elastic<'a> {
    pub(crate) fn new(enriched: &'a EnrichedBody, factors: &'a Factors) -> Self {
        let mut parts = vec![(&enriched.body, factors.homogeneous.as_slice())];
        parts.extend(enriched.outside.as_ref().zip(factors.outside.as_deref()));
        Self { parts }
    }

    /// Forces on the bubbles, two for each element.
    pub(crate) fn bubble_force(&self) -> Vec<f64> {
        let forces = self.parts.iter().map(|(enriched, u)| enriched.bubble_force(u));
        forces.reduce(sum).unwrap_or_default()
    }

    /// η_ψ² = ρ_ψᵀ [V_PP]⁻¹ ρ_ψ of each element, summed over the parts.
    pub(crate) fn traction_indicators(&self, elements: usize) -> Vec<f64> {
        self.weighted_tractions(elements, [1.0; 2])
    }

    /// The part of them for which the displacement is as good as held, by a medium or a body that is much stiffer: no correction of
    /// displacements has the energy of this.
    pub(crate) fn held_tractions(&self, elements: usize, moduli: Option<[f64; 2]>) -> f64 {
        let Some([body, medium]) = moduli else { return 0.0 };
        let weight = |own: f64, other: f64| (other / (own + other)).powi(4);
        let weights = [weight(body, medium), weight(medium, body)];
        self.weighted_tractions(elements, weights).iter().sum()
    }

    fn weighted_tractions(&self, elements: usize, weights: [f64; 2]) -> Vec<f64> {
        let mut indicators = vec![0.0; elements];
        for ((enriched, u), weight) in self.parts.iter().zip(weights) {
            let residual = enriched.traction_residual(u);
            for (e, (indicator, rho)) in indicators.iter_mut().zip(residual.chunks_exact(2)).enumerate() {
                let a = enriched.single_layer_block(e);
                let det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
                let x = [(a[1][1] * rho[0] - a[0][1] * rho[1]) / det, (a[0][0] * rho[1] - a[1][0] * rho[0]) / det];
                *indicator += weight * (x[0] * rho[0] + x[1] * rho[1]).max(0.0);
            }
        }
        indicators
    }

    /// S₊u - (Su, 0), and its work on u: both summed over the parts.
    pub(crate) fn excess(&self) -> (Enriched, f64) {
        let (mut all, mut gained): (Option<Enriched>, _) = (None, 0.0);
        for (enriched, u) in &self.parts {
            let part = enriched.excess(u);
            gained += u.iter().zip(&part.base).map(|(u, s)| u * s).sum::<f64>();
            match &mut all {
                Some(all) => all.add(1.0, &part),
                None => all = Some(part),
            }
        }
        (all.unwrap_or(Enriched { base: Vec::new(), extra: Vec::new() }), gained)
    }

    /// S₊v, given S times the base part of v.
    pub(crate) fn multiply(&self, v: &Enriched, base_force: Vec<f64>) -> Enriched {
        let start = Enriched { base: base_force, extra: vec![0.0; v.extra.len()] };
        self.parts.iter().fold(start, |before, (enriched, _)| {
            let Enriched { base, extra } = enriched.multiply(v, &before.base);
            Enriched { base, extra: sum(before.extra, extra) }
        })
    }

    /// ⟨W b e_i, b e_j⟩ of element e.
    pub(crate) fn hypersingular_block(&self, e: usize) -> [[f64; 2]; 2] {
        self.block(|enriched| enriched.hypersingular_block(e))
    }

    /// ⟨S₊ b e_i, b e_j⟩ of element e.
    pub(crate) fn stiffness_block(&self, e: usize) -> [[f64; 2]; 2] {
        self.block(|enriched| enriched.stiffness_block(e))
    }

    fn block(&self, of: impl Fn(&EnrichedSteklov) -> [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let blocks = self.parts.iter().map(|(enriched, _)| of(enriched));
        blocks.fold([[0.0; 2]; 2], |sum, a| [0, 1].map(|i| [0, 1].map(|j| sum[i][j] + a[i][j])))
    }
}

fn sum(mut a: Vec<f64>, b: Vec<f64>) -> Vec<f64> {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
    a
}
