//! The Steklov-Poincaré matrix of the enriched spaces, by blocks on top of that of the base.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::prelude::*;
use faer::{Accum, Col, Mat};

use crate::steklov::{cholesky, parts};
use crate::{BemError, Domain, Enrichment, Operators, Steklov};

/// S₊ of the spaces of one more degree, from the factors of S.
///
/// With b for the base and x for the extra unknowns (bubbles, top tractions), V₊ = L₊L₊ᵀ and X = L₊⁻¹H₊,
///
/// ```text
/// S₊ = [ S + X_xbᵀX_xb        C + X_xbᵀX_xx ]      C = W_bx + X_bbᵀX_bx
///      [ Cᵀ + X_xxᵀX_xb       D + X_xxᵀX_xx ]      D = W_xx + X_bxᵀX_bx
/// ```
/// and for a displacement u of the base with traction ψ = V⁻¹Hu the Galerkin residuals of the extra functions are
/// ⟨(K+½)u - Vψ, P_p⟩ = L_xx X_xb u and ⟨Wu + (K'+½)ψ, b⟩ = Cᵀu.
#[derive(Debug, Clone)]
pub struct EnrichedSteklov {
    /// L_xx, n×n.
    factor: Mat<f64>,
    /// X_xb, n×N.
    top: Mat<f64>,
    /// X_xx, n×n.
    corner: Mat<f64>,
    /// C, N×n.
    coupling: Mat<f64>,
    /// D, n×n.
    bubble: Mat<f64>,
    /// 2×2 blocks of V and W on the diagonal, one for each element.
    blocks: Vec<[[[f64; 2]; 2]; 2]>,
}

/// A vector of the enriched displacement space.
#[derive(Debug, Clone, PartialEq)]
pub struct Enriched {
    /// Nodal values, N entries.
    pub base: Vec<f64>,
    /// Coefficients of the bubbles, n entries.
    pub extra: Vec<f64>,
}

impl Steklov {
    /// S of the base and what S₊ needs besides. Bounded at infinity the extra tractions, which have no resultant, are made
    /// V-orthogonal to the base tractions without one.
    ///
    /// Cost: besides [`Steklov::new`] 6 N²n multiplications and additions for n extra unknowns.
    /// # Errors
    /// As [`Steklov::new`].
    pub fn enriched(
        operators: Operators,
        enrichment: Enrichment,
        domain: Domain,
    ) -> Result<(Self, EnrichedSteklov), BemError> {
        let (length, diameter) = (operators.length, operators.diameter);
        let steklov = Self::new(operators, domain)?;
        let (l, x) = steklov.traction.factors();
        let n = x.nrows();
        let par = parts();
        let Enrichment { mut v, mut k, k_top: mut top, w, mass, mass_top } = enrichment;
        let extra = top.nrows();
        let block = |a: &Mat<f64>, first: usize, e: usize| {
            let at = |i: usize, j: usize| a[(first + 2 * e + i, 2 * e + j)];
            [[at(0, 0), at(0, 1)], [at(1, 0), at(1, 1)]]
        };
        let blocks = (0..extra / 2).map(|e| [block(&v, n, e), block(&w, n, e)]).collect();
        if domain.is_exterior() {
            k *= -1.0;
            top *= -1.0;
        }
        for (&value, (row, column)) in &mass {
            k[(row, column)] += 0.5 * value;
        }
        for (&value, (row, column)) in &mass_top {
            top[(row, column)] += 0.5 * value;
        }
        // L_xb = Yᵀ with Y = L⁻¹V_bx, and X_bx, in the storage of V_bx and H_bx
        let (mut y, mut factor) = v.as_mut().split_at_row_mut(n);
        let (mut x_bubble, mut corner) = k.as_mut().split_at_row_mut(n);
        solve_lower_triangular_in_place(l, y.rb_mut(), par);
        solve_lower_triangular_in_place(l, x_bubble.rb_mut(), par);
        steklov.traction.balance(y.rb_mut());
        steklov.traction.balance(x_bubble.rb_mut());
        let (y, x_bubble) = (y.rb(), x_bubble.rb());
        matmul(factor.rb_mut(), Accum::Add, y.transpose(), y, -1.0, par);
        cholesky(factor.rb_mut(), par).map_err(|pivot| BemError::SingleLayerIndefinite {
            pivot: n + pivot,
            size: n + extra,
            length,
            diameter,
        })?;
        matmul(top.as_mut(), Accum::Add, y.transpose(), x, -1.0, par);
        matmul(corner.rb_mut(), Accum::Add, y.transpose(), x_bubble, -1.0, par);
        solve_lower_triangular_in_place(factor.rb(), top.as_mut(), par);
        solve_lower_triangular_in_place(factor.rb(), corner.rb_mut(), par);
        let (w_coupling, w_bubble) = w.split_at_row(n);
        let (mut coupling, mut bubble) = (w_coupling.to_owned(), w_bubble.to_owned());
        matmul(coupling.as_mut(), Accum::Add, x.transpose(), x_bubble, 1.0, par);
        matmul(bubble.as_mut(), Accum::Add, x_bubble.transpose(), x_bubble, 1.0, par);
        let (factor, corner) = (factor.to_owned(), corner.to_owned());
        Ok((steklov, EnrichedSteklov { factor, top, corner, coupling, bubble, blocks }))
    }
}

impl EnrichedSteklov {
    /// Residuals ⟨(K+½)u - Vψ, P_p⟩ of the top tractions, two for each element.
    pub fn traction_residual(&self, u: &[f64]) -> Vec<f64> {
        let y = &self.top * column(u);
        let l = &self.factor;
        (0..y.nrows()).map(|i| (0..=i).map(|j| l[(i, j)] * y[j]).sum()).collect()
    }

    /// ⟨Wu + (K'+½)ψ, b⟩ of the bubbles, two for each element.
    pub fn bubble_force(&self, u: &[f64]) -> Vec<f64> {
        values(&(self.coupling.transpose() * column(u)))
    }

    /// S₊u - (Su, 0) of a displacement of the base.
    pub fn excess(&self, u: &[f64]) -> Enriched {
        let y = &self.top * column(u);
        Enriched {
            base: values(&(self.top.transpose() * &y)),
            extra: values(&(self.coupling.transpose() * column(u) + self.corner.transpose() * &y)),
        }
    }

    /// S₊v, given S times the base part of v.
    pub fn multiply(&self, v: &Enriched, base_force: &[f64]) -> Enriched {
        let (b, x) = (column(&v.base), column(&v.extra));
        let y = &self.top * &b + &self.corner * &x;
        let base = column(base_force) + &self.coupling * &x + self.top.transpose() * &y;
        let extra = self.coupling.transpose() * &b + &self.bubble * &x + self.corner.transpose() * &y;
        Enriched { base: values(&base), extra: values(&extra) }
    }

    /// ⟨V P_p e_i, P_p e_j⟩ of element e.
    pub fn single_layer_block(&self, e: usize) -> [[f64; 2]; 2] {
        self.blocks[e][0]
    }

    /// ⟨W b e_i, b e_j⟩ of element e.
    pub fn hypersingular_block(&self, e: usize) -> [[f64; 2]; 2] {
        self.blocks[e][1]
    }

    /// ⟨S₊ b e_i, b e_j⟩ of element e.
    pub fn stiffness_block(&self, e: usize) -> [[f64; 2]; 2] {
        let mut block = [[0.0; 2]; 2];
        for i in 0..2 {
            for j in 0..2 {
                let (ci, cj) = (self.corner.col(2 * e + i), self.corner.col(2 * e + j));
                block[i][j] = self.bubble[(2 * e + i, 2 * e + j)] + ci.transpose() * cj;
            }
        }
        block
    }
}

impl Enriched {
    /// Σ a·b over all unknowns.
    pub fn dot(&self, other: &Self) -> f64 {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        sum(&self.base, &other.base) + sum(&self.extra, &other.extra)
    }

    /// Adds `factor` times another vector.
    pub fn add(&mut self, factor: f64, other: &Self) {
        self.base.iter_mut().zip(&other.base).for_each(|(a, b)| *a += factor * b);
        self.extra.iter_mut().zip(&other.extra).for_each(|(a, b)| *a += factor * b);
    }
}

fn column(v: &[f64]) -> Col<f64> {
    Col::from_fn(v.len(), |i| v[i])
}

fn values(v: &Col<f64>) -> Vec<f64> {
    v.iter().copied().collect()
}
