//! A mesh to be solved.

use std::sync::Arc;

use steklov_bem_operators::{Cuts, Piece, Subdivision};
use steklov_contact::Tip;
use steklov_problem::{DataError, DataErrorKind, Indicator, Multiplier, Problem, Refine, Scene};

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
    /// Whether a scene can be solved along these cuts.
    ///
    /// # Errors
    /// Several bodies, a medium, springs, random input, stabilised multipliers, residuals that steer, or refinement, which does not
    /// refine cuts.
    pub(crate) fn check(&self, scene: &Scene) -> Result<(), DataError> {
        let (problem, method) = (&scene.problem, &scene.method);
        let found = [
            (problem.bodies.len() > 1 || problem.bodies[0].far.is_some(), "body", "several bodies or a medium"),
            (problem.has_springs(), "sides", "springs"),
            (scene.random.is_some(), "random", "random input"),
            (method.multiplier != Multiplier::Biorthogonal, "method", "stabilised multipliers"),
            (method.indicator != Indicator::Bubble, "method", "a residual indicator"),
            (method.refine != Refine::None, "method", "refinement of the mesh"),
        ];
        match found.into_iter().find(|(is, ..)| *is) {
            None => Ok(()),
            Some((_, key, what)) => {
                let message = format!("a body that is cut into {} subdomains cannot have {what}", self.cuts.count());
                Err(DataError::at(DataErrorKind::Unsupported, &[vec![key]], message, "solve it without cuts"))
            }
        }
    }
}

/// Vertices of both sides of a cut that are closer than this (edge parameter) are one.
const SAME: f64 = 1e-9;

impl Layout {
    /// Displacement unknowns.
    pub fn dofs(&self) -> usize {
        self.subdivision.dofs()
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
