//! A mesh to be solved.

use std::sync::Arc;

use steklov_bem_operators::{Cuts, Mark, Mesh, Piece, Space, Subdivision, Subdomain, front_sizes};
use steklov_contact::Tip;
use steklov_problem::{DataError, DataErrorKind, Problem, Scene};

use crate::mesh::automatic_cuts::hindrance;

/// A mesh to be solved: its elements, and the vertices that follow transitions of contact and stick.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// The elements of every edge.
    pub subdivision: Subdivision,
    /// The vertices at transitions.
    pub tips: Vec<Tip>,
    /// The cuts through the body and their elements, if it is cut.
    pub cuts: Option<MeshedCuts>,
}

/// The lines along which a body is cut into subdomains, and the elements of each part of them.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshedCuts {
    /// The cuts.
    pub cuts: Arc<Cuts>,
    /// The elements of [`Cuts::parts`].
    pub elements: Vec<Vec<Piece>>,
}

impl MeshedCuts {
    /// The cuts after refinement of the marked elements, in the order of their numbers: halved where they are rough, else raised by
    /// as many degrees.
    pub(crate) fn refined(&self, marks: &[Mark]) -> Self {
        let mut marks = marks.iter();
        let mut of_piece = |piece: &Piece| match marks.next() {
            Some(Mark::Refine { rough: true, .. }) => {
                let middle = (piece.start + piece.end) / 2.0;
                vec![Piece { end: middle, ..*piece }, Piece { start: middle, ..*piece }]
            }
            Some(Mark::Refine { degrees, .. }) => {
                vec![Piece { degree: (piece.degree + degrees).min(Mesh::MAX_DEGREE), ..*piece }]
            }
            _ => vec![*piece],
        };
        let elements = self.elements.iter().map(|pieces| pieces.iter().flat_map(&mut of_piece).collect()).collect();
        Self { cuts: self.cuts.clone(), elements }
    }

    /// Whether a scene can be solved along these cuts.
    ///
    /// # Errors
    /// Several bodies, a medium, springs, random input, stabilised multipliers, residuals that steer, or another
    /// refinement than that of the hp strategy.
    pub(crate) fn check(&self, scene: &Scene) -> Result<(), DataError> {
        match hindrance(scene) {
            None => Ok(()),
            Some((key, what)) => {
                let message = format!("a body that is cut into {} subdomains cannot have {what}", self.cuts.count());
                Err(DataError::at(DataErrorKind::Unsupported, &[vec![key]], message, "solve it without cuts"))
            }
        }
    }
}

/// The sizes of the matrices of a layout.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// Elements and displacement unknowns of every subdomain that is no translate of another one; of a body that is not cut those of all.
    pub pieces: Vec<[usize; 2]>,
    /// Unknowns of the fronts by which those on cuts are eliminated.
    pub fronts: Vec<usize>,
}

/// Vertices of both sides of a cut that are closer than this (edge parameter) are one.
const SAME: f64 = 1e-9;

impl Layout {
    /// Displacement unknowns, those on cuts included.
    pub fn dofs(&self) -> usize {
        let on_cuts = self.cuts.iter().flat_map(|cuts| &cuts.elements);
        // a part of a cut has one node less than degrees: its ends are nodes of the boundary or of other parts
        let inside = |pieces: &Vec<Piece>| 2 * (pieces.iter().map(|piece| piece.degree).sum::<usize>() - 1);
        self.subdivision.dofs() + on_cuts.map(inside).sum::<usize>()
    }

    /// Displacement unknowns on cuts, those at ends on the boundary apart.
    pub fn dofs_on_cuts(&self) -> usize {
        self.dofs() - self.subdivision.dofs()
    }

    /// The sizes of its matrices.
    pub fn sizes(&self, problem: &Problem) -> Sizes {
        let (Some(cuts), Ok(mesh)) = (&self.cuts, self.subdivision.mesh(&problem.outline)) else {
            return Sizes { pieces: vec![[self.subdivision.elements(), self.dofs()]], fronts: Vec::new() };
        };
        let (subdomains, _) = cuts.cuts.subdomains(&mesh, &Space::new(&mesh), &cuts.elements);
        let mut nodes: Vec<usize> = subdomains.iter().flat_map(|one| one.nodes.iter().copied()).collect();
        nodes.sort_unstable();
        let mut shared: Vec<usize> = nodes.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
        shared.dedup();
        let of =
            |one: &Subdomain| one.nodes.iter().copied().filter(|node| shared.binary_search(node).is_ok()).collect();
        let first = Subdomain::first_translates(&subdomains.iter().collect::<Vec<_>>());
        let different = subdomains.iter().enumerate().filter(|(k, _)| first[*k] == *k);
        Sizes {
            pieces: different.map(|(_, one)| [one.mesh.len(), one.space.dofs()]).collect(),
            fronts: front_sizes(subdomains.iter().map(of).collect()),
        }
    }

    /// The layout with the same elements on both sides of cuts: all vertices of both, and the higher degree. Both sides then
    /// have the same error in a singular field, and shears at the tip of a crack make no pressures.
    pub(crate) fn with_equal_cuts(mut self, problem: &Problem) -> Self {
        for [left, right] in problem.cut_edges() {
            let (own, other) = (&self.subdivision.edges[left], &self.subdivision.edges[right]);
            let mirrored = |piece: &Piece| Piece { start: 1.0 - piece.end, end: 1.0 - piece.start, ..*piece };
            let other: Vec<Piece> = other.iter().rev().map(mirrored).collect();
            let mut vertices: Vec<f64> = own.iter().map(|piece| piece.start).collect();
            for vertex in other.iter().map(|piece| piece.start) {
                if vertices.iter().all(|v| (v - vertex).abs() > SAME) {
                    vertices.push(vertex);
                }
            }
            vertices.sort_by(f64::total_cmp);
            let of = |pieces: &[Piece], s: f64| pieces.iter().rfind(|piece| piece.start <= s).map(|piece| piece.degree);
            let ends = vertices.iter().copied().skip(1).chain([1.0]);
            let both: Vec<Piece> = vertices
                .iter()
                .zip(ends)
                .map(|(&start, end)| {
                    let middle = (start + end) / 2.0;
                    let degree = of(own, middle).max(of(&other, middle)).unwrap_or(1);
                    Piece { start, end, degree, mark: Default::default() }
                })
                .collect();
            self.subdivision.edges[right] = both.iter().rev().map(mirrored).collect();
            self.subdivision.edges[left] = both;
        }
        self
    }
}
