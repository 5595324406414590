//! A mesh to be solved.

use steklov_bem_operators::Subdivision;
use steklov_contact::Tip;

/// A mesh to be solved: its elements, and the vertices that follow transitions of contact and stick.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// The elements of every edge.
    pub subdivision: Subdivision,
    /// The vertices at transitions.
    pub tips: Vec<Tip>,
}

impl Layout {
    /// Displacement unknowns.
    pub fn dofs(&self) -> usize {
        self.subdivision.dofs()
    }
}
