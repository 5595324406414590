//! One pass over the unordered pairs of elements gives V, K and W.
//!
//! The pass works on blocks of rows of pairs so that the moments of a block fit a small buffer. In a block, first all
//! moments are computed, in parallel over pairs; then every element adds what it contributes to its own columns of V,
//! K and W, in parallel over columns and in a fixed order within each: the matrices have the same bits for any number
//! of threads.

use faer::Mat;
use rayon::prelude::*;
use sprs::{CsMat, TriMat};
use steklov_elastic::Material;

use crate::cache::PairCache;
use crate::columns::{Columns, Scratch, Targets};
use crate::pass::{Block, Pass, Purpose};
use crate::{BemError, Mesh, Space};

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
    ///
    /// Source: Hsiao, Wendland, *Boundary Integral Equations*, 2008, chapter 2 (kernels); integration by parts after Maue
    /// 1949 and Günter; Steinbach (2004) for the sizes at which V is positive definite.
    pub fn assemble(mesh: &Mesh, space: &Space, material: &Material, length: Option<f64>) -> Result<Self, BemError> {
        let mut operators = Self::empty(mesh, space, length)?;
        let pass = Pass::new(mesh, space, material, operators.length, Purpose::Plain);
        pass.fill(Targets { operators: Some(&mut operators), ..Targets::default() }, &mut PairCache::default());
        Ok(operators)
    }

    /// As [`Self::assemble`], for a space that gets an [`crate::Enrichment`]: both use the same moments, which stay in `cache`
    /// unless they are too many. The moments of pairs with unchanged end points are taken from the cache.
    ///
    /// # Errors
    /// As [`Self::assemble`].
    pub fn to_enrich(
        mesh: &Mesh,
        space: &Space,
        material: &Material,
        length: Option<f64>,
        cache: &mut PairCache,
    ) -> Result<Self, BemError> {
        let mut operators = Self::empty(mesh, space, length)?;
        let pass = Pass::new(mesh, space, material, operators.length, Purpose::Base);
        cache.count(&pass);
        pass.fill(Targets { operators: Some(&mut operators), ..Targets::default() }, cache);
        Ok(operators)
    }

    /// The mass matrix, and V, K, W still zero.
    fn empty(mesh: &Mesh, space: &Space, length: Option<f64>) -> Result<Self, BemError> {
        mesh.check()?;
        let diameter = mesh.diameter();
        let n = space.dofs();
        let zeros = || Mat::zeros(n, n);
        let mass = mass(mesh, space);
        Ok(Self { v: zeros(), k: zeros(), w: zeros(), mass, length: length.unwrap_or(diameter), diameter })
    }
}

impl Pass<'_> {
    /// Adds all pairs of elements to the matrices.
    pub(crate) fn fill(&self, targets: Targets<'_>, cache: &mut PairCache) {
        let mut owners = self.columns(targets);
        let arch = pulp::Arch::new();
        let mut add = |rows: std::ops::Range<usize>, moments: &[f64]| {
            let block = Block { base: self.pair_base(rows.clone()), rows, moments };
            owners.par_iter_mut().for_each_init(Scratch::default, |scratch, columns| {
                arch.dispatch(Addition { pass: self, columns, block: &block, scratch });
            });
        };
        if let Some(moments) = cache.moments(self) {
            add(0..self.len(), moments);
        } else {
            let (blocks, largest) = self.blocks();
            let mut buffer = Vec::with_capacity(largest);
            for rows in blocks {
                self.moments(rows.clone(), &mut buffer, &|_, _| None);
                add(rows, &buffer);
            }
        }
    }
}

/// The argument of [`Pass::add`]: a closure of this size would not be compiled for the instructions at hand.
struct Addition<'a, 'c> {
    pass: &'a Pass<'a>,
    columns: &'a mut Columns<'c>,
    block: &'a Block<'a>,
    scratch: &'a mut Scratch,
}

impl pulp::NullaryFnOnce for Addition<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.pass.add(self.columns, self.block, self.scratch);
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
