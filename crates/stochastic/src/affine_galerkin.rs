//! Linear equations whose matrix is affine in the germs, solved for all germs at once in polynomials of total degree p.
//!
//! ```text
//! (K_0 + Σ_m (ξ_m - E ξ_m) K_m) u(ξ) = f_0 + Σ_m (ξ_m - E ξ_m) f_m,    u(ξ) = Σ_a u_a ψ_a(ξ)
//! tested by each ψ_a:  K_0 u_a + Σ_m K_m Σ_b G_m[a, b] u_b = f_a,    G_m[a, b] = E[(ξ_m - E ξ_m) ψ_a ψ_b]
//! ```
//! Conjugate gradients with K_0⁻¹ of each block as preconditioner: no matrix is made but the factor of K_0.

use rayon::prelude::*;

use crate::total_degree::Coupled;
use crate::{StochasticError, TotalDegree};

/// Blocks that are solved with K_0 together, whatever the number of threads.
const TOGETHER: usize = 8;
/// Most iterations: they are bounded by the square root of the condition, not by the number of blocks.
const MOST: usize = 1000;

/// Sets the last argument to Σ_m K_m v_m, v_0 first, then those of the germs.
pub type AffineProduct<'a> = dyn Fn(&[&[f64]], &mut [f64]) + Sync + 'a;
/// Replaces vectors, one after the other in memory, by K_0⁻¹ times them.
pub type MeanSolve<'a> = dyn Fn(&mut [f64]) + Sync + 'a;

/// A family of symmetric matrices K_0 + Σ_m (ξ_m - E ξ_m) K_m, positive definite for all values of the germs, with loads.
pub struct AffineFamily<'a> {
    /// Σ_m K_m v_m.
    pub product: &'a AffineProduct<'a>,
    /// K_0⁻¹.
    pub solve: &'a MeanSolve<'a>,
    /// f_0 and the load of each germ; no numbers for one that is zero.
    pub loads: Vec<Vec<f64>>,
}

/// The solution of a family.
#[derive(Debug, Clone)]
pub struct AffineSolution {
    /// u_a, one after the other.
    pub blocks: Vec<f64>,
    /// Iterations of the conjugate gradients.
    pub iterations: usize,
    /// The residual left, relative to that of u = 0, both in the norm of K_0⁻¹.
    pub residual: f64,
}

impl TotalDegree {
    /// Σ_m K_m Σ_b G_m[a, b] u_b of each block, `beside` being [`TotalDegree::products`]; `blocks` holds the u_a one after
    /// the other, n numbers each. Projected onto the polynomials: what is of degree p + 1 is dropped.
    ///
    /// # Panics
    /// If `blocks` is not made of one vector for each polynomial.
    pub fn apply(&self, product: &AffineProduct<'_>, beside: &[Vec<Coupled>], blocks: &[f64]) -> Vec<f64> {
        let n = blocks.len() / self.degrees().len();
        assert_eq!(n * self.degrees().len(), blocks.len(), "a vector for each polynomial");
        let mut all = vec![0.0; blocks.len()];
        all.par_chunks_mut(n.max(1)).enumerate().for_each(|(a, out)| {
            let mixed = self.mixed(&beside[a], blocks);
            let own = &blocks[a * n..(a + 1) * n];
            let vectors: Vec<&[f64]> = std::iter::once(own).chain(mixed.iter().map(Vec::as_slice)).collect();
            product(&vectors, out);
        });
        all
    }

    /// Σ_b G_m[a, b] u_b for each germ, `row` being that of a in [`TotalDegree::products`].
    pub fn mixed(&self, row: &[Coupled], blocks: &[f64]) -> Vec<Vec<f64>> {
        let n = blocks.len() / self.degrees().len();
        let mut mixed = vec![vec![0.0; n]; self.degrees()[0].len()];
        for Coupled { germ, other, value } in row {
            let u = &blocks[other * n..(other + 1) * n];
            mixed[*germ].iter_mut().zip(u).for_each(|(v, u)| *v += value * u);
        }
        mixed
    }

    /// Solves a family for all germs until the residual, in the norm of K_0⁻¹, is `tolerance` times that of u = 0.
    ///
    /// *Use when*: the matrix is affine in a few bounded germs and more than a rough answer is wanted. *Fails when*: the matrix
    /// of some outcome is not positive definite. *Cost*: an iteration takes binomial(d + p, p) solves with K_0 and as many
    /// products; with r the largest Σ_m |ξ_m - E ξ_m| |K_m| over K_0 their number grows as √((1 + r)/(1 - r)), whatever the
    /// size of the matrix and, nearly, the degree.
    ///
    /// Same bits for any number of threads.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] for another number of loads than germs and the mean, or loads of different lengths;
    /// [`StochasticError::Number`] for loads that are not finite, for an energy that is not positive, or if 1000 iterations do not reach the tolerance.
    ///
    /// Source: Ghanem and Spanos (1991), section 3.3; Powell and Elman, IMA J. Numer. Anal. 29 (2009) for the preconditioner.
    pub fn solve(&self, family: &AffineFamily<'_>, tolerance: f64) -> Result<AffineSolution, StochasticError> {
        let mut r = self.projected_loads(&family.loads)?;
        let n = r.len() / self.degrees().len();
        let beside = self.products();
        let preconditioned = |r: &[f64]| {
            let mut z = r.to_vec();
            z.par_chunks_mut((TOGETHER * n).max(1)).for_each(|part| (family.solve)(part));
            z
        };
        let mut u = vec![0.0; r.len()];
        let mut z = preconditioned(&r);
        let mut d = z.clone();
        let first = dot(&r, &z, n);
        if !(first >= 0.0 && first.is_finite()) {
            let what = "the square of the loads in the norm of the inverse mean matrix".into();
            return Err(StochasticError::Number { what, value: first, wanted: "0 or above and finite" });
        }
        let (mut square, mut iterations) = (first, 0);
        while square > tolerance * tolerance * first {
            let q = self.apply(family.product, &beside, &d);
            let energy = dot(&d, &q, n);
            if energy.is_nan() || energy <= 0.0 {
                let what = "the energy of a displacement, over all outcomes together,".into();
                let wanted = "above 0: the matrix of some outcome is not positive definite";
                return Err(StochasticError::Number { what, value: energy, wanted });
            }
            if iterations == MOST {
                let what = format!("the residual after {MOST} iterations, over that of no displacement,");
                let wanted = "below the tolerance: keep the moduli of all outcomes further from 0";
                return Err(StochasticError::Number { what, value: (square / first).sqrt(), wanted });
            }
            let step = square / energy;
            u.par_iter_mut().zip(&d).for_each(|(u, d)| *u += step * d);
            r.par_iter_mut().zip(&q).for_each(|(r, q)| *r -= step * q);
            z = preconditioned(&r);
            let next = dot(&r, &z, n);
            d.par_iter_mut().zip(&z).for_each(|(d, z)| *d = z + next / square * *d);
            square = next;
            iterations += 1;
        }
        let residual = if first > 0.0 { (square / first).sqrt() } else { 0.0 };
        Ok(AffineSolution { blocks: u, iterations, residual })
    }

    /// E[f ψ_a] of each polynomial: f_0 at ψ_0, the deviation of ξ_m times f_m at the polynomial ξ_m alone.
    fn projected_loads(&self, loads: &[Vec<f64>]) -> Result<Vec<f64>, StochasticError> {
        let (germs, n) = (self.degrees()[0].len(), loads.iter().map(Vec::len).max().unwrap_or(0));
        if loads.len() != germs + 1 || loads.iter().any(|f| !f.is_empty() && f.len() != n) {
            let lengths: Vec<usize> = loads.iter().map(Vec::len).collect();
            let what = format!("loads of the lengths {lengths:?} for the mean and {germs} germs");
            return Err(StochasticError::Inconsistent { what });
        }
        let mut all = vec![0.0; n * self.degrees().len()];
        all[..loads[0].len()].copy_from_slice(&loads[0]);
        for (m, load) in loads[1..].iter().enumerate() {
            let alone: Vec<usize> = (0..germs).map(|other| usize::from(other == m)).collect();
            if let Ok(a) = self.degrees().binary_search(&alone) {
                let [_, deviation] = self.germ(m);
                all[a * n..].iter_mut().zip(load).for_each(|(out, f)| *out = deviation * f);
            }
        }
        Ok(all)
    }
}

/// Σ of the products, block by block in their order.
fn dot(a: &[f64], b: &[f64], n: usize) -> f64 {
    let of_blocks = a.par_chunks(n.max(1)).zip(b.par_chunks(n.max(1)));
    let parts: Vec<f64> = of_blocks.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()).collect();
    parts.iter().sum()
}
