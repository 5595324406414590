//! Dual weighted residuals of quantities: how much of the error of each comes from where.
//!
//! ```text
//! dual problem        S z = j_u + HᵀV⁻¹j_ψ  in the base space at the contact sets of u,    ζ = V⁻¹(Hz - j_ψ)
//! two-level residual  η_e = ρ_u·[W_ee]⁻¹ρ_z + ρ_ψ·[V_ee]⁻¹(j_ψ - Hz + Vζ)_e + β·ρ_z,       ρ_ψ = (Hu - Vψ)_e,  ρ_z = (j_u - Wz - Hᵀζ)_e
//! ```
//! β is what data hold a bubble at. Σ η_e is near J(u₊) - J(u), and may cross zero by accident; Σ |η_e| does not. A vertex that is off its end of contact by δ, where the
//! opening is B d^(3/2) and that of z is A d^(1/2) beside it, changes J by (3π/32) E' A B δ², from dJ/dδ = -K_u K_z/E' of the half body.
//!
//! *Fails when* the bounds of friction depend on the pressure, as under Coulomb's law: the dual problem is another one. *Cost*: for each
//! quantity one solution with the factors of S and two with those of V, N² each.
//!
//! Source: Becker and Rannacher (2001), section 3.

use std::f64::consts::PI;

use faer::Mat;
use steklov_algebra::least_squares;
use steklov_bem_operators::SAME_PLACE;
use steklov_contact::TipFit;
use steklov_elastic::plane::dot;
use steklov_quadrature::legendre_p;

use crate::data::on_mesh::OnMesh;
use crate::estimate::contact_ends::ContactEnd;
use crate::estimate::enriched_problem::System;
use crate::estimate::functionals::{LinearFunctional, OfEnergy};
use crate::estimate::nonconformity::{Left, Nonconformity};
use crate::estimate::slip_reversals::SlipReversal;
use crate::solve::body::Body;
use crate::solve::fields::ElasticField;
use crate::solve::free_bodies::Normalised;
use crate::solve::rotations::{orthonormal, project_off_basis};
use crate::solve::solution::Solved;

/// Terms of the opening of a dual solution beside an end of contact.
const TERMS: usize = 3;

/// The dual problems of quantities on the base space.
pub(crate) struct Duals<'a> {
    data: &'a OnMesh<'a>,
    pub(crate) body: &'a Body,
    pub(crate) system: &'a System<'a>,
    /// W_ee of each bubble, with springs.
    blocks: Vec<[[f64; 2]; 2]>,
    /// ρ_u, two for each element.
    residual: &'a [f64],
    /// An orthonormal basis of the motions that nothing resists.
    motions: Vec<Vec<f64>>,
    /// Those that are taken out of displacements.
    pub(crate) normalised: Vec<Normalised>,
}

impl<'a> Duals<'a> {
    /// Those of a solved mesh with the residual ρ_u; `of_springs` are the blocks of springs on the bubbles.
    pub(crate) fn new(
        data: &'a OnMesh<'a>,
        (solved, body): (&Solved, &'a Body),
        system: &'a System<'a>,
        of_springs: &[[[f64; 2]; 2]],
        residual: &'a [f64],
    ) -> Self {
        let block = |(e, springs): (usize, &[[f64; 2]; 2])| {
            let w = system.elastic.hypersingular_block(e);
            [0, 1].map(|i| [0, 1].map(|j| w[i][j] + springs[i][j]))
        };
        let blocks = of_springs.iter().enumerate().map(block).collect();
        let motions: Vec<Vec<f64>> = solved.free_motions.iter().map(|motion| motion.nodal(&body.points)).collect();
        let boundary = solved.contact.as_ref().map(|contact| &contact.boundary);
        let normalised = body.loose.normalised((&body.mesh, &body.space), boundary);
        Self { data, body, system, blocks, residual, motions: orthonormal(&motions), normalised }
    }
}

/// The dual solution of a functional.
struct Dual {
    /// z, nodal values.
    z: Vec<f64>,
    /// The part of z that is free: z - w of a functional of forces.
    free: Vec<f64>,
    /// The loads on bubbles, and on the top tractions of pieces.
    bubbles: Vec<f64>,
    tops: Vec<(usize, Vec<f64>)>,
}

/// What u₊ leaves over.
#[derive(Clone, Copy)]
pub(crate) struct LeftOver<'a> {
    /// What it leaves of the load on the nodes.
    pub(crate) rest: &'a [f64],
    /// β on the bubbles.
    pub(crate) missed: &'a [f64],
    /// Where displacements do not agree, and the field of u₊.
    pub(crate) nonconformity: Option<(ElasticField<'a>, &'a Nonconformity)>,
    /// Where slip turns between nodes.
    pub(crate) reversals: &'a [SlipReversal],
}

/// What the dual solution of a functional tells.
pub(crate) struct Weighted {
    /// Σ |η_e|.
    pub(crate) sum: f64,
    /// What J(u₊) lacks where u₊ leaves a residual, that times z, and where displacements of bodies do not agree.
    pub(crate) of_rest: f64,
    /// How much J changes by ends of contact that are not at their vertices.
    pub(crate) of_ends: f64,
}

impl Duals<'_> {
    /// Σ |η_e| of a functional, its value of what is left over, and the changes by ends of contact; None without tractions.
    pub(crate) fn weighted(
        &self,
        functional: &LinearFunctional,
        left: LeftOver<'_>,
        ends: &[ContactEnd],
    ) -> Option<Weighted> {
        let LeftOver { rest, missed, nonconformity, reversals } = left;
        let dual = self.dual(functional)?;
        // a force is the opposite of what its dual solution weighs
        let sign = if functional.of_forces.is_empty() { 1.0 } else { -1.0 };
        let of_rest = sign * dual.free.iter().zip(rest).map(|(z, r)| z * r).sum::<f64>();
        let work =
            nonconformity.map_or(0.0, |(field, left)| self.work_on_nonconformity(functional, &dual, (field, left)));
        let of_reversals: f64 = reversals.iter().map(|reversal| self.of_reversal(reversal, &dual.z)).sum();
        let of_sides = sign * (work + of_reversals);
        let sum = self.residuals(&dual, missed).iter().map(|eta| eta.abs()).sum::<f64>() + of_sides.abs();
        let of_ends = ends.iter().map(|end| self.of_end(end, &dual.z)).sum();
        Some(Weighted { sum, of_rest: of_rest + of_sides, of_ends })
    }

    /// ∫ τ·w, τ the traction of the dual solution on the side that carries multipliers or is held; 0 where the functional weighs tractions or
    /// stresses there, or displacements of two sides, with which that of z jumps.
    fn work_on_nonconformity(
        &self,
        functional: &LinearFunctional,
        dual: &Dual,
        (plus, nonconformity): (ElasticField<'_>, &Nonconformity),
    ) -> f64 {
        let mut of_weights = 0.0;
        for &(e, t, by) in functional.traces.iter().filter(|(e, ..)| nonconformity.has(*e)) {
            let is_of_one = self.data.is_held(e) || nonconformity.is_on_obstacle(e);
            if !is_of_one || by.traction != [0.0; 2] || by.stress != [0.0; 3] {
                return 0.0;
            }
            of_weights += dot(by.displacement, self.data.off_side(nonconformity, plus.on_boundary(e, t).0, (e, t)));
        }
        let mesh = &self.body.mesh;
        let mut tractions: Vec<Option<Vec<f64>>> = vec![None; self.body.pieces.len()];
        let mut legendre = Vec::new();
        let on = |left: &Left| {
            let (e, t) = left.places[0];
            let (piece, local) = plus.field.place(e);
            let own = tractions[piece].get_or_insert_with(|| self.traction(functional, dual, piece));
            let space = &self.body.pieces[piece].piece.part.space;
            legendre.resize(space.degree(local), 0.0);
            legendre_p(t, &mut legendre);
            let w = left.vector();
            let along = |m: usize| own[2 * m] * w[0] + own[2 * m + 1] * w[1];
            let sum: f64 = legendre.iter().zip(space.offset[local]..).map(|(p, m)| p * along(m)).sum();
            // coefficients are those of traction times length on curves
            left.ds * mesh.length(e) / 2.0 / mesh.speed(e, t) * sum
        };
        nonconformity.points.iter().map(on).sum::<f64>() - of_weights
    }

    /// The traction of the dual solution on a piece, without what the functional loads it with.
    fn traction(&self, functional: &LinearFunctional, dual: &Dual, piece: usize) -> Vec<f64> {
        let assembled = &self.body.pieces[piece];
        let mut j = vec![0.0; assembled.piece.part.space.dofs()];
        let mut constant = [0.0; 2];
        for (_, own) in functional.of_fields.iter().filter(|(own, _)| *own == piece) {
            let [_, values] = own.enriched(&assembled.piece.part.space);
            j.iter_mut().zip(&values.base).for_each(|(j, own)| *j += own);
            (0..2).for_each(|i| constant[i] += own.of_constant()[i]);
        }
        let of_energy = functional.of_energy.as_ref().filter(|of| of.piece == piece).map(|of| &of.of[..]);
        self.system.elastic.dual_traction(piece, &assembled.traction_map, (&dual.z, of_energy), (&j, constant))
    }

    fn dual(&self, functional: &LinearFunctional) -> Option<Dual> {
        let mut load = self.system.elastic.zero();
        let mut tops = Vec::new();
        for (piece, of_field) in &functional.of_fields {
            let (space, traction_map) = match self.body.pieces.get(*piece) {
                Some(assembled) => (&assembled.piece.part.space, &*assembled.traction_map),
                None => (&self.body.space, &self.body.outside.as_ref()?.traction_map),
            };
            let values = (&of_field.enriched(space), of_field.of_constant());
            let (own, top) = self.system.elastic.dual_load(*piece, traction_map, values)?;
            load.add(1.0, &own);
            tops.push((*piece, top));
        }
        if let Some(OfEnergy { piece, load: own, top, .. }) = &functional.of_energy {
            load.add(1.0, own);
            tops.push((*piece, top.clone()));
        }
        // nodes of cuts are behind those of the boundary
        let mut w = functional.of_forces.clone();
        if !w.is_empty() {
            w.resize(load.base.len(), 0.0);
            load.base.iter_mut().zip(self.system.condensation.multiply(&w)).for_each(|(load, force)| *load -= force);
        }
        // displacements are without the motions that nothing resists, of which bubbles have a part
        for Normalised { motion, on_nodes, on_bubbles } in &self.normalised {
            let part: f64 = load.base.iter().zip(motion).map(|(load, r)| load * r).sum();
            load.base.iter_mut().zip(on_nodes).for_each(|(load, m)| *load -= part * m);
            load.extra.iter_mut().zip(on_bubbles).for_each(|(load, m)| *load -= part * m);
        }
        project_off_basis(&mut load.base, &self.motions);
        let free = self.system.solve_base(&load.base);
        let z = if w.is_empty() { free.clone() } else { free.iter().zip(&w).map(|(z, w)| z + w).collect() };
        Some(Dual { z, free, bubbles: load.extra, tops })
    }

    /// The work of the friction that a reversal of slip leaves out on z.
    fn of_reversal(&self, reversal: &SlipReversal, z: &[f64]) -> f64 {
        let space = &self.body.space;
        let at = |(e, t): (usize, f64)| {
            let mut phi = vec![0.0; space.degree(e) + 1];
            space.basis(e).evaluate(t, &mut phi);
            space
                .element_nodes(e)
                .zip(phi)
                .map(|(node, phi)| phi * dot(reversal.force, [z[2 * node], z[2 * node + 1]]))
                .sum::<f64>()
        };
        at(reversal.place) - reversal.faced.map_or(0.0, at)
    }

    /// |δJ| of an end of contact.
    fn of_end(&self, end: &ContactEnd, z: &[f64]) -> f64 {
        let (mesh, space) = (&self.body.mesh, &self.body.space);
        let is_beside = |e: usize| {
            let [a, b] = mesh.span[e].map(|s| f64::from(end.regular) * (s - end.s));
            mesh.edge[e] == end.edge && a.min(b).abs() <= SAME_PLACE
        };
        let Some(e) = (0..mesh.len()).find(|&e| is_beside(e)) else { return 0.0 };
        let [a, b] = mesh.span[e];
        // d, and the opening of z there
        let opening = |(node, t): (usize, &f64)| {
            let d = (a + (b - a) * (1.0 + t) / 2.0 - end.s).abs();
            (d > SAME_PLACE).then(|| (d, dot([z[2 * node], z[2 * node + 1]], mesh.normal(e, *t))))
        };
        let nodes: Vec<(f64, f64)> = space.element_nodes(e).zip(&space.basis(e).nodes).filter_map(opening).collect();
        let terms = nodes.len().min(TERMS);
        let matrix = Mat::from_fn(nodes.len(), terms, |i, j| nodes[i].0.powf(0.5 + j as f64));
        let amplitude =
            least_squares(matrix.as_ref(), Mat::from_fn(nodes.len(), 1, |i, _| nodes[i].1).as_ref())[(0, 0)];
        let modulus = self.data.material_of(e).plane_modulus();
        let TipFit { shift, curvature } = end.of_solution;
        3.0 * PI / 32.0 * modulus * (amplitude * curvature).abs() * shift * shift
    }

    /// η_e of all elements; `missed` are the bubbles β that data hold.
    fn residuals(&self, dual: &Dual, missed: &[f64]) -> Vec<f64> {
        let elements = self.blocks.len();
        let (mut residual, of_tractions) = self.system.elastic.dual_residual(&dual.z, &dual.bubbles, &dual.tops);
        let springs = self.system.springs;
        if !springs.is_empty() {
            let pull = springs.pull(self.system.space, elements, &dual.z).extra;
            residual.iter_mut().zip(pull).for_each(|(r, pull)| *r -= pull);
        }
        let of_element = |e: usize| {
            let at = |of: &[f64]| [of[2 * e], of[2 * e + 1]];
            let x = self.system.frames[e].solve(self.blocks[e], at(&residual));
            dot(at(self.residual), x) + of_tractions[e] + dot(at(missed), at(&residual))
        };
        (0..elements).map(of_element).collect()
    }
}
