//! The bodies of a mesh one by one: what each of them is of the nodes and elements of all.

use std::ops::Range;

use faer::Mat;
use faer::linalg::solvers::Solve;
use steklov_algebra::dot;
use steklov_bem_operators::{Mesh, Space, TractionMap};
use steklov_elastic::{Material, RigidMotion};
use steklov_problem::Problem;

/// A body of a mesh.
#[derive(Debug, Clone)]
pub struct Piece {
    /// Its number.
    pub body: usize,
    /// Its elements.
    pub elements: Range<usize>,
    /// Its nodes.
    pub nodes: Range<usize>,
    /// Its mesh, elements and nodes counted from 0.
    pub mesh: Mesh,
    /// Its unknowns.
    pub space: Space,
    /// Its material.
    pub material: Material,
}

impl Piece {
    /// The part of a vector of all nodes or traction coefficients, interleaved, that is its own.
    pub fn own<'v>(&self, nodal: &'v [f64]) -> &'v [f64] {
        &nodal[2 * self.nodes.start..2 * self.nodes.end]
    }

    /// The same to be changed.
    pub fn own_mut<'v>(&self, nodal: &'v mut [f64]) -> &'v mut [f64] {
        &mut nodal[2 * self.nodes.start..2 * self.nodes.end]
    }
}

/// The bodies in the order of their elements.
pub fn pieces(problem: &Problem, mesh: &Mesh, space: &Space) -> Vec<Piece> {
    let edges = problem.outline.edges();
    let body_of = |e: usize| problem.outline.body_of_loop(edges[mesh.edge[e]].loop_index);
    let mut pieces: Vec<Piece> = Vec::new();
    let mut first = 0;
    for e in 1..=mesh.len() {
        if e < mesh.len() && body_of(e) == body_of(first) {
            continue;
        }
        let elements = first..e;
        let part = mesh.part(elements.clone());
        pieces.push(Piece {
            body: body_of(first),
            nodes: space.offset[first]..space.offset[e],
            space: Space::new(&part),
            mesh: part,
            material: problem.bodies[body_of(first)].material(),
            elements,
        });
        first = e;
    }
    pieces
}

/// A body with what assembly leaves.
pub struct Assembled {
    /// The body.
    pub piece: Piece,
    /// Length in the logarithm of the kernel.
    pub length: f64,
    /// From displacements to tractions.
    pub traction_map: TractionMap,
    /// Of one of several bodies with curves the motions that its supports leave free: what nodal values miss of them does not
    /// resist them, and is no part of its displacement.
    pub(crate) turning: Vec<RigidMotion>,
}

impl Assembled {
    /// The part of a nodal displacement of the body that is a motion, least squares.
    pub(crate) fn motion(&self, own: &[f64]) -> Option<RigidMotion> {
        let points = &self.piece.space.points;
        let motions: Vec<Vec<f64>> = self.turning.iter().map(|motion| motion.nodal(points)).collect();
        if motions.is_empty() {
            return None;
        }
        let gram = Mat::from_fn(motions.len(), motions.len(), |i, j| dot(&motions[i], &motions[j]));
        let right = Mat::from_fn(motions.len(), 1, |i, _| dot(&motions[i], own));
        let parts = gram.full_piv_lu().solve(right);
        let mut sum = RigidMotion::along([0.0; 2]);
        for (k, motion) in self.turning.iter().enumerate() {
            // about the origin
            let at = motion.at([0.0; 2]);
            (0..2).for_each(|i| sum.translation[i] += parts[(k, 0)] * at[i]);
            sum.rotation += parts[(k, 0)] * motion.rotation;
        }
        Some(sum)
    }
}
