//! The enriched matrices of a body, and with a medium around it of both, as an estimate uses them.
//!
//! With u the displacement of the body and ξ = u - u0 that of the medium, the forces on the bubbles and their W_bb are sums over both,
//! and so is S₊; there are two traction residuals, of u inside and of ξ outside:
//!
//! ```text
//! ρ_u = t0(b) - ⟨W u + (K'+½)ψ_i, b⟩ - ⟨W ξ + (K'-½)ψ_e, b⟩        ρ_ψ = (⟨(K+½)u - Vψ_i, P_p⟩, ⟨(½-K)ξ - Vψ_e, P_p⟩)
//! ```
//! The part of u0 that the nodes miss is not included: its solution, which has no jump of tractions, is orthogonal in the
//! energy of body and medium to all that has no jump of displacements.

use std::ops::Range;
use std::sync::Arc;

use steklov_bem_operators::{BemError, Enriched, EnrichedSteklov, PairCache};
use steklov_elastic::plane::{dot, solve2};

use crate::data::parts::Assembled;
use crate::solve::body::{Body, Factors};

/// The blocks that S₊ of the enriched spaces needs besides S, for bodies and for the medium around one.
#[derive(Clone)]
pub struct EnrichedBody {
    bodies: Vec<EnrichedPiece>,
    outside: Option<Arc<EnrichedSteklov>>,
}

/// One of the bodies.
#[derive(Clone)]
struct EnrichedPiece {
    /// The operators of the modulus of its assembly.
    enriched: Arc<EnrichedSteklov>,
    /// Its modulus over that.
    modulus: f64,
    elements: Range<usize>,
    nodes: Range<usize>,
}

impl EnrichedBody {
    /// The enriched operators of a body whose operators come from the moments in `cache`: one solved with an estimate to
    /// follow.
    ///
    /// # Errors
    /// Those of [`EnrichedSteklov::new`].
    pub fn new(body: &Body, cache: &mut PairCache) -> Result<Self, BemError> {
        let outside =
            body.outside.as_ref().map(|outside| outside.enriched(&body.mesh, &body.space, cache)).transpose()?;
        let mut bodies = Vec::new();
        for Assembled { piece, length, traction_map, modulus, .. } in &body.pieces {
            let enriched =
                EnrichedSteklov::new(&piece.mesh, &piece.space, &piece.material, *length, traction_map, cache)?;
            let (elements, nodes) = (piece.elements.clone(), piece.nodes.clone());
            bodies.push(EnrichedPiece { enriched: Arc::new(enriched), modulus: *modulus, elements, nodes });
        }
        Ok(Self { bodies, outside: outside.map(Arc::new) })
    }

    /// The same operators with the moduli of a body.
    pub(crate) fn with_moduli(&self, body: &Body) -> Self {
        let of = |(own, piece): (&EnrichedPiece, &Assembled)| EnrichedPiece { modulus: piece.modulus, ..own.clone() };
        Self { bodies: self.bodies.iter().zip(&body.pieces).map(of).collect(), outside: self.outside.clone() }
    }
}

/// Displacements and the enriched matrices that they belong to: of each body, and of the medium around one.
pub(crate) struct Elastic<'a> {
    parts: Vec<Part<'a>>,
    elements: usize,
}

/// A body or a medium.
struct Part<'a> {
    enriched: &'a EnrichedSteklov,
    /// The factor of its operators.
    modulus: f64,
    /// Nodal displacement.
    u: &'a [f64],
    elements: Range<usize>,
    nodes: Range<usize>,
}

impl Part<'_> {
    /// The part of values of the elements, two each.
    fn extra<'v>(&self, extra: &'v [f64]) -> &'v [f64] {
        &extra[2 * self.elements.start..2 * self.elements.end]
    }

    /// The part of values of the nodes, two each.
    fn base<'v>(&self, base: &'v [f64]) -> &'v [f64] {
        &base[2 * self.nodes.start..2 * self.nodes.end]
    }
}

impl<'a> Elastic<'a> {
    pub(crate) fn new(enriched: &'a EnrichedBody, factors: &'a Factors) -> Self {
        let of_body = |EnrichedPiece { enriched, modulus, elements, nodes }: &'a EnrichedPiece| Part {
            enriched,
            modulus: *modulus,
            u: &factors.homogeneous[2 * nodes.start..2 * nodes.end],
            elements: elements.clone(),
            nodes: nodes.clone(),
        };
        let mut parts: Vec<Part<'a>> = enriched.bodies.iter().map(of_body).collect();
        let elements = parts.last().map_or(0, |part| part.elements.end);
        let outside = enriched.outside.as_ref().zip(factors.outside.as_deref());
        let of_medium = |(enriched, u): (&'a Arc<EnrichedSteklov>, &'a [f64])| Part {
            enriched,
            modulus: 1.0,
            u,
            elements: 0..elements,
            nodes: 0..u.len() / 2,
        };
        parts.extend(outside.map(of_medium));
        Self { parts, elements }
    }

    /// Forces on the bubbles, two for each element.
    pub(crate) fn bubble_force(&self) -> Vec<f64> {
        let mut forces = vec![0.0; 2 * self.elements];
        for part in &self.parts {
            add(&mut forces, 2 * part.elements.start, part.modulus, &part.enriched.bubble_force(part.u));
        }
        forces
    }

    /// η_ψ² = ρ_ψᵀ [V_PP]⁻¹ ρ_ψ of each element, summed over the parts.
    pub(crate) fn traction_indicators(&self, elements: usize) -> Vec<f64> {
        self.weighted_tractions(elements, [1.0; 2])
    }

    /// The part of them where a much stiffer medium or body practically holds the displacement: no correction of displacements
    /// has this energy.
    pub(crate) fn held_tractions(&self, elements: usize, moduli: Option<[f64; 2]>) -> f64 {
        let Some([body, medium]) = moduli else { return 0.0 };
        let weight = |own: f64, other: f64| (other / (own + other)).powi(4);
        let weights = [weight(body, medium), weight(medium, body)];
        self.weighted_tractions(elements, weights).iter().sum()
    }

    fn weighted_tractions(&self, elements: usize, weights: [f64; 2]) -> Vec<f64> {
        let mut indicators = vec![0.0; elements];
        for (k, part) in self.parts.iter().enumerate() {
            let residual = part.enriched.traction_residual(part.u);
            let weight = weights[k.min(1)];
            let own = &mut indicators[part.elements.clone()];
            for (e, (indicator, rho)) in own.iter_mut().zip(residual.chunks_exact(2)).enumerate() {
                let a = part.enriched.single_layer_block(e);
                let rho = [rho[0], rho[1]];
                *indicator += weight * part.modulus * dot(solve2(a, rho), rho).max(0.0);
            }
        }
        indicators
    }

    /// S₊u - (Su, 0), and its work on u: both summed over the parts.
    pub(crate) fn excess(&self) -> (Enriched, f64) {
        let nodes = self.parts.iter().map(|part| part.nodes.end).max().unwrap_or(0);
        let (mut all, mut gained) = (Enriched { base: vec![0.0; 2 * nodes], extra: vec![0.0; 2 * self.elements] }, 0.0);
        for part in &self.parts {
            let excess = part.enriched.excess(part.u);
            gained += part.modulus * part.u.iter().zip(&excess.base).map(|(u, s)| u * s).sum::<f64>();
            add(&mut all.base, 2 * part.nodes.start, part.modulus, &excess.base);
            add(&mut all.extra, 2 * part.elements.start, part.modulus, &excess.extra);
        }
        (all, gained)
    }

    /// S₊v, given S times the base part of v.
    pub(crate) fn multiply(&self, v: &Enriched, base_force: Vec<f64>) -> Enriched {
        let mut all = Enriched { base: base_force, extra: vec![0.0; v.extra.len()] };
        for part in &self.parts {
            let own = Enriched { base: part.base(&v.base).to_vec(), extra: part.extra(&v.extra).to_vec() };
            let base_force: Vec<f64> = part.base(&all.base).iter().map(|f| f / part.modulus).collect();
            let Enriched { base, extra } = part.enriched.multiply(&own, &base_force);
            let of_part = all.base[2 * part.nodes.start..2 * part.nodes.end].iter_mut();
            of_part.zip(base).for_each(|(all, own)| *all = part.modulus * own);
            add(&mut all.extra, 2 * part.elements.start, part.modulus, &extra);
        }
        all
    }

    /// ⟨W b e_i, b e_j⟩ of element e.
    pub(crate) fn hypersingular_block(&self, e: usize) -> [[f64; 2]; 2] {
        self.block(e, EnrichedSteklov::hypersingular_block)
    }

    /// ⟨S₊ b e_i, b e_j⟩ of element e.
    pub(crate) fn stiffness_block(&self, e: usize) -> [[f64; 2]; 2] {
        self.block(e, EnrichedSteklov::stiffness_block)
    }

    fn block(&self, e: usize, of: impl Fn(&EnrichedSteklov, usize) -> [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let here = self.parts.iter().filter(|part| part.elements.contains(&e));
        let blocks = here.map(|part| {
            let block = of(part.enriched, e - part.elements.start);
            block.map(|row| row.map(|entry| part.modulus * entry))
        });
        blocks.fold([[0.0; 2]; 2], |sum, a| [0, 1].map(|i| [0, 1].map(|j| sum[i][j] + a[i][j])))
    }
}

/// Adds a part times a factor to all, from a place on.
fn add(all: &mut [f64], first: usize, factor: f64, part: &[f64]) {
    all[first..].iter_mut().zip(part).for_each(|(a, b)| *a += factor * b);
}
