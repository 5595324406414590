//! The bodies of a mesh one by one: what each of them is of the nodes and elements of all.

use std::ops::Range;

use steklov_bem_operators::{Mesh, Space, TractionMap};
use steklov_elastic::Material;
use steklov_problem::Problem;

/// A body of a mesh.
#[derive(Debug, Clone)]
pub struct Piece {
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
}
