//! The body at a point of the interface, by the cells of its grid.

use steklov_bem_operators::{Mesh, Space};
use steklov_msfem::HeterogeneousBody;
use steklov_quadrature::legendre_p;

use crate::transfer::{Overlap, overlaps};
use crate::{CouplingError, Outline, Trace};

/// Where displacement and stress of the body come from.
pub(crate) struct Body<'a> {
    body: &'a HeterogeneousBody,
    fine: &'a [f64],
    outline: Outline,
    trace: Trace,
}

/// The body at a point.
pub(crate) struct Side {
    /// σ(u)n.
    pub traction: [f64; 2],
    /// du/ds.
    pub slope: [f64; 2],
    /// E.
    pub young: f64,
}

impl<'a> Body<'a> {
    /// The body with its outer boundary and the fine displacements `fine` of all nodes (length).
    ///
    /// # Errors
    /// As [`Outline::new`]: a body of several parts, or one that touches itself in a point.
    pub fn new(body: &'a HeterogeneousBody, fine: &'a [f64]) -> Result<Self, CouplingError> {
        let outline = Outline::new(&body.grid)?;
        let trace = Trace::fine(&body.grid, &outline);
        Ok(Self { body, fine, outline, trace })
    }

    /// The sides of cells on an element.
    ///
    /// # Errors
    /// [`CouplingError::Boundary`] for an element that sides of cells do not cover: make the mesh from the outline of the
    /// grid.
    pub fn overlaps(&self, mesh: &Mesh, e: usize) -> Result<Vec<Overlap>, CouplingError> {
        overlaps(&self.trace, mesh, e)
    }

    /// The body at the point t of an element that these sides of cells cover.
    pub fn at(&self, t: f64, overlaps: &[Overlap]) -> Side {
        let Self { body, fine, outline, .. } = self;
        let Some(overlap) = overlaps.iter().find(|o| t <= o.span[1] + SAME) else {
            unreachable!("the element is covered by sides of cells")
        };
        let (cell, number) = outline.sides[overlap.point];
        // along the side with the body to the left
        let s = overlap.hats(t)[1].clamp(0.0, 1.0);
        let local = [[s, 0.0], [1.0, s], [1.0 - s, 1.0], [0.0, 1.0 - s]][number];
        let (u, young, spacing) = (body.cell_values(fine, cell), body.young[cell], body.grid.spacing);
        let [xx, yy, xy] = body.stress(cell, &u, local);
        let traction = [[-xy, -yy], [xx, xy], [xy, yy], [-xx, -xy]][number];
        let (a, b, length) = (number, (number + 1) % 4, spacing[number % 2]);
        let slope = [0, 1].map(|i| (u[2 * b + i] - u[2 * a + i]) / length);
        Side { traction, slope, young }
    }
}

/// Rounding of reference coordinates.
const SAME: f64 = 1e-9;

/// d/ds of a nodal field at the reference coordinate t of element e.
pub(crate) fn derivative(mesh: &Mesh, space: &Space, e: usize, t: f64, nodal: &[f64]) -> [f64; 2] {
    let basis = space.basis(e);
    let mut legendre = vec![0.0; basis.degree];
    legendre_p(t, &mut legendre);
    let mut sum = [0.0; 2];
    for (j, node) in space.element_nodes(e).enumerate() {
        let slope: f64 = legendre.iter().enumerate().map(|(n, l)| basis.derivative_to_legendre[(n, j)] * l).sum();
        (0..2).for_each(|i| sum[i] += slope * 2.0 / mesh.length(e) * nodal[2 * node + i]);
    }
    sum
}
