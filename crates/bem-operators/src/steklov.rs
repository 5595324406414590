//! The symmetric Steklov-Poincaré matrix.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::prelude::*;
use faer::{Accum, Col, Mat, MatMut, MatRef, Par};
use steklov_algebra::{Image, add_to_lower, cholesky, parts, solve_lower};

use crate::{BemError, Operators};

/// On which side of the boundary the elastic body lies, and what its displacement does at infinity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Domain {
    /// The body is to the left of the boundary, n points out of it: V t = (½ + K) u. Of an unbounded body
    /// ([`crate::Polygon::outside`]) the displacement decays, or with a net force R on the boundary is
    /// κ c_V R log(L/r) + O(1/r) with c_V = 1/(8πμ(1-ν)), so that L matters.
    Interior,
    /// The body is the rest of the plane, n still points out of the polygon: V t = (K - ½) u.
    Exterior,
    /// As `Interior` for an unbounded body whose displacement tends to some constant a at infinity: V t = (½ + K)(u - a)
    /// with ∮ t = 0. Nothing resists translations, and L does not matter.
    BoundedAtInfinity,
    /// As `Exterior` with a displacement that tends to some constant a at infinity: V t = (K - ½)(u - a) with ∮ t = 0.
    ExteriorBoundedAtInfinity,
}

impl Domain {
    /// Whether n points into the body.
    pub(crate) fn is_exterior(self) -> bool {
        matches!(self, Self::Exterior | Self::ExteriorBoundedAtInfinity)
    }

    /// Whether the displacement tends to a constant at infinity that is not given.
    pub(crate) fn is_bounded_at_infinity(self) -> bool {
        matches!(self, Self::BoundedAtInfinity | Self::ExteriorBoundedAtInfinity)
    }
}

/// Steklov-Poincaré matrix S = W + Hᵀ V⁻¹ H with H = ½M + K (interior) or H = ½M - K (exterior).
///
/// S is displacement × displacement (stress), symmetric and positive semi-definite. Interior: t = S u; of a bounded body
/// rigid motions span the kernel and S does not depend on L; of an unbounded one S is positive definite and depends on L,
/// which selects the condition at infinity. Exterior: t = -S u with n out of the polygon; otherwise the same as the
/// unbounded body. Bounded at infinity, with 1 the two translations:
///
/// ```text
/// S_B u = S (u - a) = S u - S 1 (1ᵀ S 1)⁻¹ 1ᵀ S u,     1ᵀ S_B = 0,     V_B⁻¹ = V⁻¹ on tractions without resultant
/// ```
#[derive(Debug, Clone)]
pub struct Steklov {
    /// S, full storage.
    pub matrix: Mat<f64>,
    /// From displacement to traction.
    pub traction: TractionMap,
}

/// ψ = V⁻¹ H u by the Cholesky factor of V, with the sign of the domain.
#[derive(Debug, Clone)]
pub struct TractionMap {
    /// L of V = L Lᵀ in the lower triangle; what stands above it is V.
    factor: Mat<f64>,
    /// L⁻¹ H, traction × displacement; bounded at infinity, without its part along L⁻¹ H 1.
    solved: Mat<f64>,
    /// The image of that, unless a part has been taken out of it.
    image: Option<Image>,
    domain: Domain,
    translations: Option<Translations>,
}

/// What is taken out of L⁻¹ H where the displacement is bounded at infinity: L⁻¹ H 1 = Q R, QᵀQ = 1.
#[derive(Debug, Clone)]
struct Translations {
    /// Q, traction × 2.
    basis: Mat<f64>,
    /// The constant at infinity, a = R⁻¹ Qᵀ L⁻¹ H u: 2 × displacement.
    constant: Mat<f64>,
}

impl Translations {
    fn new(solved: MatRef<'_, f64>) -> Self {
        let nodes = solved.ncols() / 2;
        let mut basis = Mat::zeros(solved.nrows(), 2);
        for node in 0..nodes {
            basis += solved.subcols(2 * node, 2);
        }
        let mut upper = Mat::<f64>::zeros(2, 2);
        upper[(0, 0)] = basis.col(0).norm_l2();
        let first = basis.col(0) / upper[(0, 0)];
        upper[(0, 1)] = first.transpose() * basis.col(1);
        let second = basis.col(1) - &first * upper[(0, 1)];
        upper[(1, 1)] = second.norm_l2();
        let basis = Mat::from_fn(basis.nrows(), 2, |i, j| if j == 0 { first[i] } else { second[i] / upper[(1, 1)] });
        let mut constant = along(&basis, solved);
        solve_upper_triangular_in_place(upper.as_ref(), constant.as_mut(), Par::Seq);
        Self { basis, constant }
    }

    /// A := A - Q Qᵀ A.
    fn remove(&self, mut a: MatMut<'_, f64>) {
        let (part, par) = (along(&self.basis, a.rb()), parts(a.nrows()));
        matmul(a.rb_mut(), Accum::Add, &self.basis, &part, -1.0, par);
    }
}

/// Qᵀ A.
fn along(basis: &Mat<f64>, a: MatRef<'_, f64>) -> Mat<f64> {
    let mut part = Mat::zeros(2, a.ncols());
    matmul(part.as_mut(), Accum::Replace, basis.transpose(), a, 1.0, parts(a.nrows()));
    part
}

impl Steklov {
    /// Takes the operators apart and works in their storage: no other N² memory is used.
    ///
    /// Cost: N³/3 for V, N³ for L⁻¹H, N³ for (L⁻¹H)ᵀ(L⁻¹H) (one triangle), N unknowns.
    /// # Errors
    /// [`BemError::SingleLayerIndefinite`] when V has no Cholesky factor (L too small), [`BemError::Fault`].
    /// # Source
    /// Costabel, *Symmetric methods for the coupling of finite elements and boundary elements*, 1987 (the symmetric form).
    pub fn new(operators: Operators, domain: Domain) -> Result<Self, BemError> {
        let Operators { v: mut factor, k: mut solved, w: mut matrix, mass, length, diameter } = operators;
        if domain.is_exterior() {
            solved *= -1.0;
        }
        for (&value, (row, column)) in &mass {
            solved[(row, column)] += 0.5 * value;
        }
        let size = factor.nrows();
        let indefinite = |pivot| BemError::SingleLayerIndefinite { pivot, size, length, diameter };
        cholesky(factor.as_mut()).map_err(|none| none.or(indefinite))?;
        let mut image = Some(solve_lower(factor.as_ref(), solved.as_mut(), None)?);
        let translations = domain.is_bounded_at_infinity().then(|| Translations::new(solved.as_ref()));
        if let Some(translations) = &translations {
            translations.remove(solved.as_mut());
            image = None;
        }
        add_to_lower(matrix.as_mut(), solved.transpose(), solved.as_ref(), 1.0, image.as_ref())?;
        mirror_lower(matrix.as_mut());
        Ok(Self { matrix, traction: TractionMap { factor, solved, image, domain, translations } })
    }
}

impl TractionMap {
    /// L of V = L Lᵀ (in the lower triangle), and L⁻¹H with its image.
    pub(crate) fn factors(&self) -> (MatRef<'_, f64>, MatRef<'_, f64>, Option<&Image>) {
        (self.factor.as_ref(), self.solved.as_ref(), self.image.as_ref())
    }

    /// On which side of the boundary the body lies.
    pub(crate) fn domain(&self) -> Domain {
        self.domain
    }

    /// Takes out of L⁻¹ times a matrix of tractions, and its image, what the displacement at infinity takes; nothing unless it is
    /// bounded there.
    pub(crate) fn balance(&self, a: MatMut<'_, f64>, image: &mut Option<Image>) {
        if let Some(translations) = &self.translations {
            translations.remove(a);
            *image = None;
        }
    }

    /// The constant a to which the displacement tends at infinity, of a nodal displacement on the boundary; 0 unless that is
    /// what the domain asks for.
    pub fn at_infinity(&self, displacement: &[f64]) -> [f64; 2] {
        self.translations.as_ref().map_or([0.0; 2], |t| {
            let a = &t.constant * Col::from_fn(displacement.len(), |i| displacement[i]);
            [a[0], a[1]]
        })
    }

    /// Legendre coefficients of the traction t = σ(u)n of a nodal displacement, interleaved as [`crate::Space`] says.
    pub fn apply(&self, displacement: &[f64]) -> Vec<f64> {
        let u = Col::from_fn(displacement.len(), |i| displacement[i]);
        let mut t = &self.solved * &u;
        if self.domain.is_exterior() {
            t *= -1.0;
        }
        solve_upper_triangular_in_place(self.factor.as_ref().transpose(), t.as_mat_mut(), Par::Seq);
        t.iter().copied().collect()
    }
}

/// Copies the lower triangle onto the upper one, by tiles.
pub(crate) fn mirror_lower(mut a: MatMut<'_, f64>) {
    const TILE: usize = 64;
    let n = a.nrows();
    for j0 in (0..n).step_by(TILE) {
        for i0 in (j0..n).step_by(TILE) {
            for j in j0..(j0 + TILE).min(n) {
                for i in i0.max(j + 1)..(i0 + TILE).min(n) {
                    a[(j, i)] = a[(i, j)];
                }
            }
        }
    }
}
