//! One more degree on every element: the Galerkin matrices of bubbles and top tractions.

use faer::Mat;
use rayon::prelude::*;
use sprs::{CsMat, TriMat};

use crate::cache::PairCache;
use crate::columns::Scratch;
use crate::pass::{Block, Pass};
use crate::{BemError, Material, Mesh, Operators, Space};

/// What V, K, W and M gain from two functions (times x, y) for each element: the displacement bubble
/// b = ∫P_p = (P_(p+1) - P_(p-1))/(2p+1) and the traction mode P_p.
///
/// Extra unknown 2e+i belongs to element e, component i, and stands behind the N unknowns of the space: nodal functions
/// and bubbles span degree p+1, tractions degree p. With n = 2·elements:
#[derive(Debug, Clone)]
pub struct Enrichment {
    /// Columns of V for the top tractions, (N+n)×n.
    pub v: Mat<f64>,
    /// Columns of K for the bubbles, (N+n)×n.
    pub k: Mat<f64>,
    /// Rows of K for the top tractions against the nodal functions, n×N.
    pub k_top: Mat<f64>,
    /// Columns of W for the bubbles, (N+n)×n.
    pub w: Mat<f64>,
    /// Columns of M for the bubbles, (N+n)×n.
    pub mass: CsMat<f64>,
    /// Rows of M for the top tractions against the nodal functions, n×N.
    pub mass_top: CsMat<f64>,
}

impl Enrichment {
    /// Assembles the operators of a space and of its enrichment in one pass; moments of pairs of elements that `cache`
    /// has seen with the same end points are taken from it.
    ///
    /// Cost: as [`Operators::assemble`] at degree p+1; memory besides the operators 3(N+n)n + nN doubles.
    /// # Errors
    /// As [`Operators::assemble`].
    pub fn assemble(
        mesh: &Mesh,
        space: &Space,
        material: &Material,
        length: Option<f64>,
        cache: &mut PairCache,
    ) -> Result<(Operators, Self), BemError> {
        let mut operators = Operators::empty(mesh, space, length)?;
        let (n, x) = (space.dofs(), 2 * mesh.len());
        let (mass, mass_top) = extra_mass(mesh, space);
        let zeros = || Mat::zeros(n + x, x);
        let mut enrichment = Self { v: zeros(), k: zeros(), k_top: Mat::zeros(x, n), w: zeros(), mass, mass_top };
        let pass = Pass::new(mesh, space, material, operators.length, true);
        pass.fill(&mut operators, Some(&mut enrichment), cache);
        Ok((operators, enrichment))
    }
}

impl Pass<'_> {
    /// Adds all pairs of elements to the matrices.
    pub(crate) fn fill(&self, operators: &mut Operators, enrichment: Option<&mut Enrichment>, cache: &mut PairCache) {
        let mut owners = self.columns(operators, enrichment);
        let arch = pulp::Arch::new();
        let mut add = |rows: std::ops::Range<usize>, moments: &[f64]| {
            let block = Block { base: self.pair_base(rows.clone()), rows, moments };
            owners.par_iter_mut().for_each_init(Scratch::default, |scratch, columns| {
                arch.dispatch(|| self.add(columns, &block, scratch));
            });
        };
        if self.enriched && cache.holds(self) {
            cache.update(self);
            add(0..self.len(), cache.moments());
        } else {
            let mut buffer = Vec::new();
            for rows in self.blocks() {
                self.moments(rows.clone(), &mut buffer, &|_, _| None);
                add(rows, &buffer);
            }
        }
    }
}

/// <b,P_m> of the bubbles (only m = p-1 is not orthogonal) and <φ_j,P_p> of the top tractions.
fn extra_mass(mesh: &Mesh, space: &Space) -> (CsMat<f64>, CsMat<f64>) {
    let (n, x) = (space.dofs(), 2 * mesh.len());
    let mut bubbles = TriMat::new((n + x, x));
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
