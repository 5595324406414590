//! Functions of the enriched spaces as functions of a mesh of one degree more.

use steklov_quadrature::legendre_p;

use crate::{Enriched, Mesh, Space};

/// A mesh of one degree more on every element, with displacement and traction on it.
#[derive(Debug, Clone)]
pub struct Raised {
    /// The mesh.
    pub mesh: Mesh,
    /// Its unknowns.
    pub space: Space,
    /// Nodal displacement, interleaved.
    pub displacement: Vec<f64>,
    /// Legendre coefficients of the traction.
    pub traction: Vec<f64>,
}

impl Raised {
    /// The functions of a displacement and a traction of the enriched spaces of a mesh.
    ///
    /// # Panics
    /// If they have other numbers of coefficients than the spaces.
    pub fn new(mesh: &Mesh, space: &Space, displacement: &Enriched, traction: &Enriched) -> Self {
        for (given, extra) in [(displacement, "bubbles"), (traction, "top tractions")] {
            assert_eq!(given.base.len(), space.dofs(), "a coefficient for each unknown");
            assert_eq!(given.extra.len(), 2 * mesh.len(), "{extra}: two for each element");
        }
        let mesh = mesh.raised(&vec![true; mesh.len()]);
        let raised = Space::new(&mesh);
        let mut nodal = vec![0.0; raised.dofs()];
        let mut coefficients = Vec::with_capacity(raised.dofs());
        for e in 0..mesh.len() {
            let p = space.degree(e);
            let own = 2 * space.offset[e]..2 * space.offset[e + 1];
            coefficients.extend_from_slice(&traction.base[own]);
            coefficients.extend_from_slice(&traction.extra[2 * e..2 * e + 2]);
            let (mut phi, mut legendre) = (vec![0.0; p + 1], vec![0.0; p + 2]);
            // the end belongs to the next element
            for (k, t) in raised.basis(e).nodes[..=p].iter().enumerate() {
                space.basis(e).evaluate(*t, &mut phi);
                legendre_p(*t, &mut legendre);
                let bubble = (legendre[p + 1] - legendre[p - 1]) / (2 * p + 1) as f64;
                for i in 0..2 {
                    let base: f64 =
                        space.element_nodes(e).zip(&phi).map(|(n, f)| f * displacement.base[2 * n + i]).sum();
                    nodal[2 * raised.node(e, k) + i] = base + bubble * displacement.extra[2 * e + i];
                }
            }
        }
        Self { mesh, space: raised, displacement: nodal, traction: coefficients }
    }
}
