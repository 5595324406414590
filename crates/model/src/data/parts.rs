//! The bodies of a mesh one by one, or the subdomains into which they are cut: the nodes and elements of each.

use std::sync::Arc;

use faer::Mat;
use steklov_algebra::{dot, solve_full_lu};
use steklov_bem_operators::{CutElements, EnrichedSteklov, Mesh, Space, Subdomain, TractionMap};
use steklov_elastic::{Material, RigidMotion};
use steklov_problem::Problem;

use crate::mesh::layout::MeshedCuts;

/// A body of a mesh, or a subdomain of one.
#[derive(Debug, Clone)]
pub struct Piece {
    /// The number of the body.
    pub body: usize,
    /// Its mesh, its unknowns, and their numbers among all.
    pub part: Subdomain,
    /// Its material.
    pub material: Material,
}

/// The bodies in the order of their elements; one that is cut as its subdomains, with the elements of the cuts.
pub fn pieces(problem: &Problem, mesh: &Mesh, space: &Space, cuts: Option<&MeshedCuts>) -> (Vec<Piece>, CutElements) {
    let edges = problem.outline.edges();
    let body_of = |e: usize| problem.outline.body_of_loop(edges[mesh.edge[e]].loop_index);
    let piece = |body: usize, part: Subdomain| Piece { body, part, material: problem.bodies[body].material() };
    if let Some(MeshedCuts { cuts, elements }) = cuts.filter(|cuts| cuts.cuts.count() > 1) {
        let (parts, cut) = cuts.subdomains(mesh, space, elements);
        return (parts.into_iter().map(|part| piece(0, part)).collect(), cut);
    }
    let mut pieces: Vec<Piece> = Vec::new();
    let mut first = 0;
    for e in 1..=mesh.len() {
        if e < mesh.len() && body_of(e) == body_of(first) {
            continue;
        }
        pieces.push(piece(body_of(first), Subdomain::whole(mesh, space, first..e)));
        first = e;
    }
    (pieces, CutElements::default())
}

/// A body with the results of its assembly.
#[derive(Clone)]
pub struct Assembled {
    /// The body.
    pub piece: Piece,
    /// Length in the logarithm of the kernel.
    pub length: f64,
    /// The map from displacements to tractions of the modulus of its assembly.
    pub traction_map: Arc<TractionMap>,
    /// The blocks that S₊ of the enriched spaces needs besides S; of a subdomain, if an estimate is to follow.
    pub enriched: Option<Arc<EnrichedSteklov>>,
    /// Its modulus over that of its assembly.
    pub modulus: f64,
    /// The motions that its supports leave free, for one of several bodies with curves: the part of them that nodal values
    /// miss does not resist them, and is no part of its displacement.
    pub(crate) turning: Vec<RigidMotion>,
    /// The motions that the springs carry, for a body on springs.
    pub(crate) carried: Option<Carried>,
}

/// Motions that the supports of a body leave free and its nodal values represent: on soft springs they may be much larger than
/// the displacements that strain it. The motion of a displacement u is the r with the smallest |u - r|² in the norm of σ + M,
/// M that of springs: stiff springs then pull at little of u - r, whatever it is elsewhere.
#[derive(Clone)]
pub(crate) struct Carried {
    motions: Vec<RigidMotion>,
    /// (σ + M) r of their nodal values, over the square root of the energy of each.
    weighted: Vec<Vec<f64>>,
    gram: Mat<f64>,
    scale: Vec<f64>,
}

impl Carried {
    /// `pull` is M of nodal values, `sigma` a stiffness of the body.
    pub(crate) fn new(
        motions: Vec<RigidMotion>,
        points: &[[f64; 2]],
        sigma: f64,
        pull: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Self {
        let nodal: Vec<Vec<f64>> = motions.iter().map(|motion| motion.nodal(points)).collect();
        let of = |r: &Vec<f64>| -> Vec<f64> { r.iter().zip(pull(r)).map(|(r, pull)| sigma * r + pull).collect() };
        let mut weighted: Vec<Vec<f64>> = nodal.iter().map(of).collect();
        let scale: Vec<f64> = nodal.iter().zip(&weighted).map(|(r, w)| dot(r, w).sqrt().recip()).collect();
        weighted.iter_mut().zip(&scale).for_each(|(w, scale)| w.iter_mut().for_each(|w| *w *= scale));
        let gram = Mat::from_fn(motions.len(), motions.len(), |i, j| dot(&weighted[i], &nodal[j]) * scale[j]);
        Self { motions, weighted, gram, scale }
    }

    /// The motion of a nodal displacement.
    fn of(&self, own: &[f64]) -> RigidMotion {
        let right = Mat::from_fn(self.motions.len(), 1, |i, _| dot(&self.weighted[i], own));
        let parts = solve_full_lu(self.gram.as_ref(), right.as_ref());
        let parts: Vec<f64> = self.scale.iter().enumerate().map(|(k, scale)| parts[(k, 0)] * scale).collect();
        sum_of(&self.motions, &parts)
    }
}

/// The sum of motions times their parts.
fn sum_of(motions: &[RigidMotion], parts: &[f64]) -> RigidMotion {
    let mut sum = RigidMotion::along([0.0; 2]);
    for (motion, part) in motions.iter().zip(parts) {
        // about the origin
        let at = motion.at([0.0; 2]);
        (0..2).for_each(|i| sum.translation[i] += part * at[i]);
        sum.rotation += part * motion.rotation;
    }
    sum
}

impl Assembled {
    /// The same body with another material of the same Poisson's ratio.
    pub(crate) fn with_material(&self, material: Material) -> Self {
        let modulus = self.modulus * material.young / self.piece.material.young;
        Self { modulus, piece: Piece { material, ..self.piece.clone() }, ..self.clone() }
    }

    /// Legendre coefficients of the tractions of a nodal displacement of the body.
    pub(crate) fn traction(&self, own: &[f64]) -> Vec<f64> {
        let mut traction = self.traction_map.apply(own);
        traction.iter_mut().for_each(|t| *t *= self.modulus);
        traction
    }

    /// Removes the motion that springs carry from a nodal displacement of the body, and returns it.
    pub(crate) fn settle(&self, own: &mut [f64]) -> Option<RigidMotion> {
        let motion = self.carried.as_ref()?.of(own);
        own.iter_mut().zip(motion.nodal(&self.piece.part.space.points)).for_each(|(u, r)| *u -= r);
        Some(motion)
    }

    /// The motion that nodal values miss in a nodal displacement of the body, by least squares.
    pub(crate) fn motion(&self, own: &[f64]) -> Option<RigidMotion> {
        let points = &self.piece.part.space.points;
        let motions: Vec<Vec<f64>> = self.turning.iter().map(|motion| motion.nodal(points)).collect();
        if motions.is_empty() {
            return None;
        }
        let gram = Mat::from_fn(motions.len(), motions.len(), |i, j| dot(&motions[i], &motions[j]));
        let right = Mat::from_fn(motions.len(), 1, |i, _| dot(&motions[i], own));
        let parts = solve_full_lu(gram.as_ref(), right.as_ref());
        let parts: Vec<f64> = (0..motions.len()).map(|k| parts[(k, 0)]).collect();
        Some(sum_of(&self.turning, &parts))
    }
}
