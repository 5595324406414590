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
//!
//! Where S of a body or subdomain is PSP, P the projection off its rigid motions (see [`crate::solve::rotations`]), S₊ is
//! `[P 0; 0 I] S₊ [P 0; 0 I]`: what nodal values miss of a rotation on curves is no error.

use std::sync::Arc;

use steklov_bem_operators::{BemError, Enriched, EnrichedSteklov, PairCache, Subdomain, TractionMap};
use steklov_elastic::RigidMotion;
use steklov_elastic::plane::{dot, solve2};

use crate::data::parts::Assembled;
use crate::solve::body::{Body, Factors};
use crate::solve::rotations::{orthonormal, project_off_basis};

/// The blocks that S₊ of the enriched spaces needs besides S, for bodies and for the medium around one.
#[derive(Clone)]
pub struct EnrichedBody {
    bodies: Vec<EnrichedPiece>,
    outside: Option<Arc<EnrichedSteklov>>,
}

/// One of the bodies, or a subdomain.
#[derive(Clone)]
struct EnrichedPiece {
    /// The operators of the modulus of its assembly.
    enriched: Arc<EnrichedSteklov>,
    /// Its modulus over that.
    modulus: f64,
    place: Arc<Place>,
}

/// The numbers of nodes and elements among all.
struct Place {
    nodes: Vec<usize>,
    elements: Vec<usize>,
    /// The signs of the bubbles relative to those of all.
    signs: Vec<f64>,
    /// The rigid motions that P projects off, an orthonormal basis of nodal values.
    motions: Vec<Vec<f64>>,
}

impl Place {
    fn of(part: &Subdomain, turning: &[RigidMotion]) -> Self {
        let motions: Vec<Vec<f64>> = turning.iter().map(|motion| motion.nodal(&part.space.points)).collect();
        Self {
            nodes: part.nodes.clone(),
            elements: part.elements.clone(),
            signs: part.bubble_signs(),
            motions: orthonormal(&motions),
        }
    }
}

impl EnrichedBody {
    /// The enriched operators of a body solved with an estimate to follow: those of subdomains are there, others come from the
    /// moments in `cache`, with what `tractions` need where they are wanted.
    ///
    /// # Errors
    /// Those of [`EnrichedSteklov::new`].
    pub fn new(body: &mut Body, cache: &mut PairCache, tractions: bool) -> Result<Self, BemError> {
        let outside = body
            .outside
            .as_ref()
            .map(|outside| outside.enriched(&body.mesh, &body.space, cache, tractions))
            .transpose()?;
        let mut bodies = Vec::new();
        for Assembled { piece, length, traction_map, enriched, modulus, turning, .. } in &mut body.pieces {
            let part = &piece.part;
            let enriched = match enriched.take() {
                Some(enriched) => enriched,
                None => {
                    let (mesh, space) = (&part.mesh, &part.space);
                    let material = &piece.material;
                    Arc::new(EnrichedSteklov::new(mesh, space, material, *length, traction_map, cache, tractions)?)
                }
            };
            bodies.push(EnrichedPiece { enriched, modulus: *modulus, place: Arc::new(Place::of(part, turning)) });
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
    /// Number of nodes and elements.
    nodes: usize,
    elements: usize,
}

/// A body, a subdomain or a medium.
struct Part<'a> {
    enriched: &'a EnrichedSteklov,
    /// The factor of its operators.
    modulus: f64,
    /// P times the nodal displacement.
    u: Vec<f64>,
    place: Arc<Place>,
}

impl Part<'_> {
    /// The part of values of the bubbles, two each.
    fn extra(&self, all: &[f64]) -> Vec<f64> {
        let Place { elements, signs, .. } = &*self.place;
        elements.iter().zip(signs).flat_map(|(e, sign)| [sign * all[2 * e], sign * all[2 * e + 1]]).collect()
    }

    /// Adds forces on its bubbles, times its modulus, to those of all.
    fn add_extra(&self, all: &mut [f64], own: &[f64]) {
        let Place { elements, signs, .. } = &*self.place;
        for ((e, sign), own) in elements.iter().zip(signs).zip(own.chunks_exact(2)) {
            (0..2).for_each(|i| all[2 * e + i] += self.modulus * sign * own[i]);
        }
    }

    /// Adds P times forces on its nodes, times its modulus, to those of all.
    fn add_base(&self, all: &mut [f64], mut own: Vec<f64>) {
        project_off_basis(&mut own, &self.place.motions);
        for (node, own) in self.place.nodes.iter().zip(own.chunks_exact(2)) {
            (0..2).for_each(|i| all[2 * node + i] += self.modulus * own[i]);
        }
    }
}

impl Place {
    /// P times the part of values of the nodes, two each.
    fn base(&self, all: &[f64]) -> Vec<f64> {
        let mut own: Vec<f64> = self.nodes.iter().flat_map(|node| [all[2 * node], all[2 * node + 1]]).collect();
        project_off_basis(&mut own, &self.motions);
        own
    }
}

impl<'a> Elastic<'a> {
    pub(crate) fn new(enriched: &'a EnrichedBody, factors: &'a Factors) -> Self {
        let of_body = |EnrichedPiece { enriched, modulus, place }: &'a EnrichedPiece| Part {
            enriched,
            modulus: *modulus,
            u: place.base(&factors.homogeneous),
            place: place.clone(),
        };
        let mut parts: Vec<Part<'a>> = enriched.bodies.iter().map(of_body).collect();
        let elements = parts.iter().flat_map(|part| &part.place.elements).max().map_or(0, |e| e + 1);
        let outside = enriched.outside.as_ref().zip(factors.outside.as_ref());
        let of_medium = |(enriched, u): (&'a Arc<EnrichedSteklov>, &'a Vec<f64>)| Part {
            enriched,
            modulus: 1.0,
            u: u.clone(),
            place: Arc::new(Place {
                nodes: (0..u.len() / 2).collect(),
                elements: (0..elements).collect(),
                signs: vec![1.0; elements],
                motions: Vec::new(),
            }),
        };
        parts.extend(outside.map(of_medium));
        Self { parts, nodes: factors.homogeneous.len() / 2, elements }
    }

    /// The enriched operators of a body or subdomain.
    pub(crate) fn enriched(&self, piece: usize) -> &EnrichedSteklov {
        self.parts[piece].enriched
    }

    /// The bubbles of a body or subdomain, of those of all.
    pub(crate) fn bubbles_of(&self, piece: usize, all: &[f64]) -> Vec<f64> {
        self.parts[piece].extra(all)
    }

    /// Number of elements, those of cuts included.
    pub(crate) fn elements(&self) -> usize {
        self.elements
    }

    /// No displacement, or load, on all nodes and bubbles.
    pub(crate) fn zero(&self) -> Enriched {
        Enriched { base: vec![0.0; 2 * self.nodes], extra: vec![0.0; 2 * self.elements] }
    }

    /// The number of the medium among the parts, if there is one around a body.
    pub(crate) fn medium(&self, body: &Body) -> Option<usize> {
        body.outside.is_some().then_some(body.pieces.len())
    }

    /// The nodal displacement of a part, and what a correction of all makes of it.
    pub(crate) fn with_correction(&self, part: usize, correction: &Enriched) -> Enriched {
        let own = &self.parts[part];
        let base = own.place.base(&correction.base).iter().zip(&own.u).map(|(e, u)| u + e).collect();
        Enriched { base, extra: own.extra(&correction.extra) }
    }

    /// S₊v of a part, given S times the base part of v.
    pub(crate) fn forces_of(&self, part: usize, v: &Enriched, stiff: Vec<f64>) -> Enriched {
        let Part { enriched, modulus, .. } = &self.parts[part];
        let Enriched { base, extra } = enriched.multiply(v, &vec![0.0; v.base.len()]);
        let base = stiff.iter().zip(base).map(|(s, own)| s + modulus * own).collect();
        Enriched { base, extra: extra.into_iter().map(|own| modulus * own).collect() }
    }

    /// The loads of the dual problem of ⟨S₊u, v⟩ of a part, v of the base, given Sv: on nodes and bubbles, and on top tractions.
    pub(crate) fn dual_load_of_forces(&self, part: usize, v: &[f64], stiff: &[f64]) -> (Enriched, Vec<f64>) {
        let (own, mut all) = (&self.parts[part], self.zero());
        own.add_base(&mut all.base, stiff.iter().map(|s| s / own.modulus).collect());
        own.add_extra(&mut all.extra, &own.enriched.bubble_force(v));
        (all, own.enriched.traction_residual(v))
    }

    /// S₊ of the medium times bubbles.
    pub(crate) fn forces_of_medium(&self, medium: usize, bubbles: &[f64]) -> Enriched {
        let own = Enriched { base: vec![0.0; 2 * self.nodes], extra: bubbles.to_vec() };
        self.parts[medium].enriched.multiply(&own, &vec![0.0; 2 * self.nodes])
    }

    /// Forces on the bubbles, two for each element.
    pub(crate) fn bubble_force(&self) -> Vec<f64> {
        let mut forces = vec![0.0; 2 * self.elements];
        for part in &self.parts {
            part.add_extra(&mut forces, &part.enriched.bubble_force(&part.u));
        }
        forces
    }

    /// The loads of the dual problem of a functional of the field of a piece with this traction map, by its values j of the enriched
    /// functions and of the constant at infinity: on nodes and bubbles, and on the top tractions of the piece; None without tractions.
    pub(crate) fn dual_load(
        &self,
        piece: usize,
        of_base: &TractionMap,
        ([displacement, traction], constant): (&[Enriched; 2], [f64; 2]),
    ) -> Option<(Enriched, Vec<f64>)> {
        let part = &self.parts[piece];
        let mut all = part.enriched.dual_of_traction(of_base, traction)?;
        // the tractions are those of the map times the modulus
        let mut add = |k: usize, own: &[f64]| all[k].iter_mut().zip(own).for_each(|(t, u)| *t += u / part.modulus);
        add(0, &displacement.base);
        add(1, &displacement.extra);
        if let Some(own) = part.enriched.dual_of_constant(of_base, constant) {
            own.iter().enumerate().for_each(|(k, own)| add(k, own));
        }
        let ([base, extra, top], mut load) = (all, self.zero());
        part.add_base(&mut load.base, base);
        part.add_extra(&mut load.extra, &extra);
        Some((load, top))
    }

    /// The traction of the nodal displacement of a part that a dual solution z has, less `v`: that z of a functional with the values j of the
    /// base tractions and w of the constant at infinity.
    pub(crate) fn dual_traction(
        &self,
        piece: usize,
        of_base: &TractionMap,
        (z, v): (&[f64], Option<&[f64]>),
        (j, w): (&[f64], [f64; 2]),
    ) -> Vec<f64> {
        let Part { enriched, modulus, place, .. } = &self.parts[piece];
        let mut own = place.base(z);
        own.iter_mut().zip(v.unwrap_or_default()).for_each(|(z, v)| *z -= v);
        // of displacements the constant has no modulus
        let mut zeta = enriched.dual_traction(of_base, &own, (j, w.map(|w| w / modulus)));
        zeta.iter_mut().for_each(|t| *t *= modulus);
        zeta
    }

    /// The residual of a dual solution z on the bubbles, given the load there, and ρ_ψ·x_ψ of each element, ρ_ψ the traction residual of u and
    /// x_ψ that of z over V; `tops` are the loads of top tractions by pieces.
    pub(crate) fn dual_residual(&self, z: &[f64], load: &[f64], tops: &[(usize, Vec<f64>)]) -> (Vec<f64>, Vec<f64>) {
        let (mut bubbles, mut of_tractions) = (vec![0.0; 2 * self.elements], vec![0.0; self.elements]);
        for (k, part) in self.parts.iter().enumerate() {
            let own = part.place.base(z);
            part.add_extra(&mut bubbles, &part.enriched.bubble_force(&own));
            let mut residual: Vec<f64> = part.enriched.traction_residual(&own).iter().map(|r| -r).collect();
            for (_, top) in tops.iter().filter(|(piece, _)| *piece == k) {
                residual.iter_mut().zip(top).for_each(|(r, top)| *r += top);
            }
            let primal = part.enriched.traction_residual(&part.u);
            for (local, &e) in part.place.elements.iter().enumerate() {
                let at = |of: &[f64]| [of[2 * local], of[2 * local + 1]];
                let x = solve2(part.enriched.single_layer_block(local), at(&residual));
                of_tractions[e] += part.modulus * dot(at(&primal), x);
            }
        }
        let residual = load.iter().zip(&bubbles).map(|(load, force)| load - force).collect();
        (residual, of_tractions)
    }

    /// η_ψ² = ρ_ψᵀ [V_PP]⁻¹ ρ_ψ of each element, summed over the parts.
    pub(crate) fn traction_indicators(&self) -> Vec<f64> {
        self.weighted_tractions([1.0; 2])
    }

    /// The part of them where a much stiffer medium or body practically holds the displacement: no correction of displacements
    /// has this energy.
    pub(crate) fn held_tractions(&self, moduli: Option<[f64; 2]>) -> f64 {
        let Some([body, medium]) = moduli else { return 0.0 };
        let weight = |own: f64, other: f64| (other / (own + other)).powi(4);
        let weights = [weight(body, medium), weight(medium, body)];
        self.weighted_tractions(weights).iter().sum()
    }

    fn weighted_tractions(&self, weights: [f64; 2]) -> Vec<f64> {
        let mut indicators = vec![0.0; self.elements];
        for (k, part) in self.parts.iter().enumerate() {
            let residual = part.enriched.traction_residual(&part.u);
            let weight = weights[k.min(1)];
            for (local, (&e, rho)) in part.place.elements.iter().zip(residual.chunks_exact(2)).enumerate() {
                let a = part.enriched.single_layer_block(local);
                let rho = [rho[0], rho[1]];
                indicators[e] += weight * part.modulus * dot(solve2(a, rho), rho).max(0.0);
            }
        }
        indicators
    }

    /// S₊u - (Su, 0), and its work on u: both summed over the parts.
    pub(crate) fn excess(&self) -> (Enriched, f64) {
        let mut all = self.zero();
        let mut gained = 0.0;
        for part in &self.parts {
            let excess = part.enriched.excess(&part.u);
            gained += part.modulus * part.u.iter().zip(&excess.base).map(|(u, s)| u * s).sum::<f64>();
            part.add_base(&mut all.base, excess.base);
            part.add_extra(&mut all.extra, &excess.extra);
        }
        (all, gained)
    }

    /// S₊v, given Σ S times the base part of v.
    pub(crate) fn multiply(&self, v: &Enriched, base_force: Vec<f64>) -> Enriched {
        let mut all = Enriched { base: base_force, extra: vec![0.0; v.extra.len()] };
        for part in &self.parts {
            let own = Enriched { base: part.place.base(&v.base), extra: part.extra(&v.extra) };
            // what it adds to S times the base part
            let Enriched { base, extra } = part.enriched.multiply(&own, &vec![0.0; own.base.len()]);
            part.add_base(&mut all.base, base);
            part.add_extra(&mut all.extra, &extra);
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
        let mut sum = [[0.0; 2]; 2];
        for part in &self.parts {
            // elements are few and their numbers rise, except in subdomains
            let Some(local) = part.place.elements.iter().position(|&own| own == e) else { continue };
            let block = of(part.enriched, local);
            (0..2).for_each(|i| (0..2).for_each(|j| sum[i][j] += part.modulus * block[i][j]));
        }
        sum
    }
}
