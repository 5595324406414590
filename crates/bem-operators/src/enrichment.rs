//! One more degree on every element: the Galerkin matrices of bubbles and top tractions.

use faer::Mat;
use sprs::{CsMat, TriMat};
use steklov_elastic::Material;

use crate::cache::PairCache;
use crate::columns::Targets;
use crate::pass::{Pass, Purpose};
use crate::{BemError, Mesh, Space};

/// The blocks that two more functions (times x, y) on each element add to V, K and M: the displacement bubble b = ∫P_p =
/// (P_(p+1) - P_(p-1))/(2p+1) and the traction mode P_p. [`Bubbles`] has the blocks of W.
///
/// Extra unknown 2e+i belongs to element e, component i, and stands behind the N unknowns of the space: nodal functions
/// and bubbles span degree p+1, tractions degree p. With n = 2·elements:
///
/// Source: Heuer, Mellado and Stephan (2001), two-level hp boundary elements.
#[derive(Debug, Clone)]
pub struct Enrichment {
    /// Columns of V for the top tractions against the tractions of the space, N×n.
    pub v: Mat<f64>,
    /// V of the top tractions, n×n.
    pub v_corner: Mat<f64>,
    /// Columns of K for the bubbles against the tractions of the space, N×n.
    pub k: Mat<f64>,
    /// K of the bubbles against the top tractions, n×n.
    pub k_corner: Mat<f64>,
    /// Rows of K for the top tractions against the nodal functions, n×N.
    pub k_top: Mat<f64>,
    /// Columns of M for the bubbles, against the tractions of the space alone: they are orthogonal to the top ones; N×n.
    pub mass: CsMat<f64>,
    /// Rows of M for the top tractions against the nodal functions, n×N.
    pub mass_top: CsMat<f64>,
}

/// The blocks that the bubbles of an [`Enrichment`] add to W.
#[derive(Debug, Clone)]
pub struct Bubbles {
    /// W of the bubbles against the nodal functions, N×n.
    pub w: Mat<f64>,
    /// W of the bubbles, n×n.
    pub w_corner: Mat<f64>,
}

impl Enrichment {
    /// Assembles the enrichment of a space whose operators are those of [`crate::Operators::to_enrich`] with the same `length`
    /// and `cache`; with the bubbles of W if that takes little memory, since it saves a pass.
    ///
    /// Cost: as [`crate::Operators::assemble`] at degree p+1; memory 2(N+n)n + nN doubles.
    /// # Errors
    /// As [`crate::Operators::assemble`].
    pub fn assemble(
        mesh: &Mesh,
        space: &Space,
        material: &Material,
        length: f64,
        cache: &mut PairCache,
    ) -> Result<(Self, Option<Bubbles>), BemError> {
        mesh.check()?;
        let mut enrichment = Self::empty(mesh, space);
        let pass = Pass::new(mesh, space, material, length, Purpose::Extra);
        let mut bubbles = cache.holds(&pass).then(|| Bubbles::empty(mesh, space));
        pass.fill(Targets { operators: None, enrichment: Some(&mut enrichment), bubbles: bubbles.as_mut() }, cache);
        Ok((enrichment, bubbles))
    }

    fn empty(mesh: &Mesh, space: &Space) -> Self {
        let (n, x) = (space.dofs(), 2 * mesh.len());
        let (mass, mass_top) = extra_mass(mesh, space);
        Self {
            v: Mat::zeros(n, x),
            v_corner: Mat::zeros(x, x),
            k: Mat::zeros(n, x),
            k_corner: Mat::zeros(x, x),
            k_top: Mat::zeros(x, n),
            mass,
            mass_top,
        }
    }
}

impl Bubbles {
    /// Assembles the blocks that the bubbles add to W; as [`Enrichment::assemble`].
    ///
    /// # Errors
    /// As [`Enrichment::assemble`].
    pub fn assemble(
        mesh: &Mesh,
        space: &Space,
        material: &Material,
        length: f64,
        cache: &mut PairCache,
    ) -> Result<Self, BemError> {
        mesh.check()?;
        let mut bubbles = Self::empty(mesh, space);
        let pass = Pass::new(mesh, space, material, length, Purpose::Extra);
        pass.fill(Targets { bubbles: Some(&mut bubbles), ..Targets::default() }, cache);
        Ok(bubbles)
    }

    fn empty(mesh: &Mesh, space: &Space) -> Self {
        let (n, x) = (space.dofs(), 2 * mesh.len());
        Self { w: Mat::zeros(n, x), w_corner: Mat::zeros(x, x) }
    }
}

/// <b,P_m> of the bubbles (only m = p-1 is not orthogonal) and <φ_j,P_p> of the top tractions.
fn extra_mass(mesh: &Mesh, space: &Space) -> (CsMat<f64>, CsMat<f64>) {
    let (n, x) = (space.dofs(), 2 * mesh.len());
    let mut bubbles = TriMat::new((n, x));
    let mut top = TriMat::new((x, n));
    for e in 0..mesh.len() {
        let p = space.degree(e);
        let to_legendre = &space.basis(e).to_legendre;
        for i in 0..2 {
            let value = -mesh.length(e) / ((2 * p - 1) * (2 * p + 1)) as f64;
            bubbles.add_triplet(2 * (space.offset[e] + p - 1) + i, 2 * e + i, value);
            for (j, node) in space.element_nodes(e).enumerate() {
                let value = mesh.length(e) / (2 * p + 1) as f64 * to_legendre[(p, j)];
                top.add_triplet(2 * e + i, 2 * node + i, value);
            }
        }
    }
    (bubbles.to_csr(), top.to_csr())
}
