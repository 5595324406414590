//! One pass over the unordered pairs of elements gives V, K and W.
//!
//! The pass works on blocks of rows of pairs so that the moments of a block fit a small buffer. In a block, first all
//! moments are computed, in parallel over pairs; then every element adds what it contributes to its own columns of V,
//! K and W, in parallel over columns and in a fixed order within each: the matrices have the same bits for any number
//! of threads.

use faer::Mat;
use sprs::{CsMat, TriMat};

use crate::cache::PairCache;
use crate::pass::Pass;
use crate::{BemError, Material, Mesh, Space};

/// Galerkin matrices of the single layer V, the double layer K and the hypersingular operator W, and the mass matrix M.
///
/// ```text
/// V: traction × traction          <Vφ,ψ>      (length²/stress)
/// K: traction × displacement      <Ku,ψ>      (length), principal value
/// W: displacement × displacement  <Wu,v>      (stress)
/// M: traction × displacement      <u,ψ>       (length), sparse
/// ```
/// Traction unknowns are Legendre coefficients by element, component fastest; displacement unknowns are nodal, component
/// fastest (see [`Space`]).
#[derive(Debug, Clone)]
pub struct Operators {
    /// Single layer matrix, symmetric.
    pub v: Mat<f64>,
    /// Double layer matrix.
    pub k: Mat<f64>,
    /// Hypersingular matrix, symmetric.
    pub w: Mat<f64>,
    /// Mass matrix.
    pub mass: CsMat<f64>,
    /// Length L in log(L/r).
    pub length: f64,
    /// Diameter of the boundary.
    pub diameter: f64,
}

impl Operators {
    /// Assembles V, K, W and M; `length` is L in log(L/r), by default the diameter of the boundary, which keeps V positive
    /// definite at any size of the body.
    ///
    /// Cost: N²/(8p²) pairs of 0.1 to 1 µs for N unknowns of degree p; memory 3 N² doubles and a small buffer.
    /// # Errors
    /// [`BemError::Mesh`] when elements are not closed loops or have no length.
    /// # Source
    /// Hsiao, Wendland, *Boundary Integral Equations*, 2008, chapter 2 (kernels); integration by parts after Maue 1949 and Günter.
    pub fn assemble(mesh: &Mesh, space: &Space, material: &Material, length: Option<f64>) -> Result<Self, BemError> {
        let mut operators = Self::empty(mesh, space, length)?;
        let pass = Pass::new(mesh, space, material, operators.length, false);
        pass.fill(&mut operators, None, &mut PairCache::default());
        Ok(operators)
    }

    /// The mass matrix, and V, K, W still zero.
    pub(crate) fn empty(mesh: &Mesh, space: &Space, length: Option<f64>) -> Result<Self, BemError> {
        mesh.check()?;
        let diameter = mesh.diameter();
        let n = space.dofs();
        let zeros = || Mat::zeros(n, n);
        let mass = mass(mesh, space);
        Ok(Self { v: zeros(), k: zeros(), w: zeros(), mass, length: length.unwrap_or(diameter), diameter })
    }
}

/// <u,ψ> = Σ_a |d_a| 2/(2m+1) ψ_a[m]·û_a[m].
fn mass(mesh: &Mesh, space: &Space) -> CsMat<f64> {
    let n = space.dofs();
    let mut triplets = TriMat::new((n, n));
    for e in 0..mesh.len() {
        let to_legendre = &space.basis(e).to_legendre;
        for m in 0..space.degree(e) {
            let scale = mesh.length(e) / (2 * m + 1) as f64;
            for (j, node) in space.element_nodes(e).enumerate() {
                for i in 0..2 {
                    triplets.add_triplet(2 * (space.offset[e] + m) + i, 2 * node + i, scale * to_legendre[(m, j)]);
                }
            }
        }
    }
    triplets.to_csr()
}
