//! The symmetric Steklov-Poincaré matrix.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::prelude::*;
use faer::{Accum, Col, Mat, MatMut, MatRef, Par};
use steklov_algebra::{Image, add_to_lower, check_cholesky, cholesky, parts, solve_lower};

use crate::{BemError, Operators};

/// On which side of the boundary the elastic body lies, and how its displacement behaves at infinity.
///
/// Source: Hsiao and Wendland (2008), section 2.2.
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

    /// The sign of the traction V⁻¹Hu: -1 where n points into the body.
    pub(crate) fn sign(self) -> f64 {
        if self.is_exterior() { -1.0 } else { 1.0 }
    }

    /// Whether the displacement tends to an unknown constant at infinity.
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
///
/// Source: Issaoui (2014), equations (2.33) for the body and (5.95) for the medium around it.
#[derive(Debug, Clone)]
pub struct Steklov {
    /// S, full storage.
    pub matrix: Mat<f64>,
    /// The map from displacement to traction.
    pub traction: TractionMap,
}

/// ψ = V⁻¹ H u by the Cholesky factor of V, with the sign of the domain.
#[derive(Debug, Clone)]
pub struct TractionMap {
    parts: TractionParts,
    /// The image of L⁻¹ H; none if a part was removed from it or if it was read.
    image: Option<Image>,
}

/// The parts of a [`TractionMap`].
#[derive(Debug, Clone)]
pub struct TractionParts {
    /// On which side of the boundary the body lies.
    pub domain: Domain,
    /// L of V = L Lᵀ in the lower triangle; what stands above it is V.
    pub factor: Mat<f64>,
    /// L⁻¹ H, traction × displacement; bounded at infinity, without its part along L⁻¹ H 1.
    pub solved: Mat<f64>,
    /// The part that was removed, if the displacement is bounded at infinity.
    pub translations: Option<Translations>,
}

/// The part that is removed from L⁻¹ H if the displacement is bounded at infinity: L⁻¹ H 1 = Q R, QᵀQ = 1.
#[derive(Debug, Clone)]
pub struct Translations {
    /// Q, traction × 2.
    pub basis: Mat<f64>,
    /// The constant at infinity, a = R⁻¹ Qᵀ L⁻¹ H u: 2 × displacement; a translation has itself as its constant.
    pub constant: Mat<f64>,
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
    ///
    /// Source: Costabel, *Symmetric methods for the coupling of finite elements and boundary elements*, 1987 (the symmetric
    /// form).
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
        Ok(Self {
            matrix,
            traction: TractionMap { parts: TractionParts { domain, factor, solved, translations }, image },
        })
    }

    /// S with a traction map of these parts.
    ///
    /// Besides extents and signs, N² operations check that L Lᵀ is V on a vector, that S is symmetric, and that W = S -
    /// (L⁻¹H)ᵀ(L⁻¹H) takes translations to 0; if bounded at infinity, also that QᵀQ = 1, that QᵀL⁻¹H = 0, and that
    /// translations have themselves as constants.
    ///
    /// # Errors
    /// [`BemError::Part`] for a part that does not fit.
    pub fn from_parts(matrix: Mat<f64>, parts: TractionParts) -> Result<Self, BemError> {
        parts.check()?;
        let (n, wrong) = (parts.solved.ncols(), |what| Err(BemError::Part { part: "S", what }));
        if (matrix.nrows(), matrix.ncols()) != (n, n) {
            return wrong(format!("it is {}×{}, not {n}×{n}", matrix.nrows(), matrix.ncols()));
        }
        for (i, j) in (0..n).flat_map(|j| (0..=j).map(move |i| (i, j))) {
            if !matrix[(i, j)].is_finite() || matrix[(i, j)] != matrix[(j, i)] {
                return wrong(format!("it is {} at ({i}, {j}), {} at ({j}, {i})", matrix[(i, j)], matrix[(j, i)]));
            }
        }
        let sum = |a: MatRef<'_, f64>, of: fn(f64) -> f64| {
            let mut sums = Mat::<f64>::zeros(a.nrows(), 2);
            for (j, column) in a.col_iter().enumerate() {
                (0..a.nrows()).for_each(|i| sums[(i, j % 2)] += of(column[i]));
            }
            sums
        };
        let (moved, terms) = (sum(parts.solved.as_ref(), |v| v), sum(parts.solved.as_ref(), f64::abs));
        let rest = sum(matrix.as_ref(), |v| v) - parts.solved.transpose() * moved;
        let scale = sum(matrix.as_ref(), f64::abs);
        for (i, j) in (0..n).flat_map(|i| [(i, 0), (i, 1)]) {
            let single: f64 = parts.solved.col(i).iter().zip(terms.col(j).iter()).map(|(x, t)| x.abs() * t).sum();
            if rest[(i, j)].abs() > SAME * (scale[(i, j)] + single) {
                return wrong(format!(
                    "S - X^T X, X the part solved, makes {} of translation {j} at {i}",
                    rest[(i, j)]
                ));
            }
        }
        Ok(Self { matrix, traction: TractionMap { parts, image: None } })
    }
}

/// Largest rounding error in identities of stored parts, relative to their terms.
const SAME: f64 = 1e-9;

impl TractionParts {
    fn check(&self) -> Result<(), BemError> {
        let wrong = |part: &'static str, what: String| Err(BemError::Part { part, what });
        let (p, n) = (self.factor.nrows(), self.solved.ncols());
        if p == 0 || self.factor.ncols() != p {
            return wrong("factor", format!("it is {p}×{}, not square", self.factor.ncols()));
        }
        if self.solved.nrows() != p || n == 0 || n % 2 != 0 {
            return wrong("solved", format!("it is {}×{n} for {p} tractions and two components", self.solved.nrows()));
        }
        for (part, matrix) in [("factor", &self.factor), ("solved", &self.solved)] {
            if !is_finite(matrix) {
                return wrong(part, "an entry is not finite".into());
            }
        }
        let factor = &self.factor;
        if let Some(i) = (0..p).find(|&i| factor[(i, i)] <= 0.0) {
            return wrong("factor", format!("pivot {i} is {}", factor[(i, i)]));
        }
        let single_layer = of_factor(factor.as_ref());
        if let Err(fault) = check_cholesky(single_layer.as_ref(), factor.as_ref()) {
            return wrong("factor", format!("L L^T is not V above the diagonal: {fault}"));
        }
        match (&self.translations, self.domain.is_bounded_at_infinity()) {
            (None, false) => Ok(()),
            (Some(translations), true) => translations.check(&self.solved),
            _ => wrong("domain", format!("{:?} with other parts than it has", self.domain)),
        }
    }
}

impl Translations {
    fn check(&self, solved: &Mat<f64>) -> Result<(), BemError> {
        let wrong = |part: &'static str, what: String| Err(BemError::Part { part, what });
        let (p, n) = (solved.nrows(), solved.ncols());
        let (basis, constant) = (&self.basis, &self.constant);
        if (basis.nrows(), basis.ncols()) != (p, 2) {
            return wrong("basis", format!("it is {}×{}, not {p}×2", basis.nrows(), basis.ncols()));
        }
        if (constant.nrows(), constant.ncols()) != (2, n) {
            return wrong("constant", format!("it is {}×{}, not 2×{n}", constant.nrows(), constant.ncols()));
        }
        let unit = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let product = basis.col(i).transpose() * basis.col(j);
            if product.is_nan() || (product - unit(i, j)).abs() > SAME {
                return wrong("basis", format!("columns {i} and {j} have the product {product}"));
            }
            let at_infinity: f64 = (0..n / 2).map(|node| constant[(i, 2 * node + j)]).sum();
            let terms: f64 = (0..n / 2).map(|node| constant[(i, 2 * node + j)].abs()).sum();
            if !at_infinity.is_finite() || (at_infinity - unit(i, j)).abs() > SAME * (1.0 + terms) {
                return wrong("constant", format!("translation {j} has {at_infinity} at infinity along {i}"));
            }
        }
        let largest = solved.col_iter().fold(0.0f64, |m, column| m.max(column.norm_l2()));
        let rest = along(basis, solved.as_ref()).norm_max();
        if rest > SAME * largest {
            return wrong("solved", format!("it has a part {rest} along the basis, of columns up to {largest}"));
        }
        Ok(())
    }
}

pub(crate) fn is_finite(a: &Mat<f64>) -> bool {
    a.col_iter().all(|column| column.iter().all(|v| v.is_finite()))
}

/// The matrix, in the lower triangle, of a factor that has its entries above the diagonal.
pub(crate) fn of_factor(factor: MatRef<'_, f64>) -> Mat<f64> {
    let entry = |i: usize, j: usize| match i.cmp(&j) {
        std::cmp::Ordering::Greater => factor[(j, i)],
        std::cmp::Ordering::Equal => factor.row(i).subcols(0, i + 1).squared_norm_l2(),
        std::cmp::Ordering::Less => 0.0,
    };
    Mat::from_fn(factor.nrows(), factor.nrows(), entry)
}

impl TractionMap {
    /// Its parts.
    pub fn parts(&self) -> &TractionParts {
        &self.parts
    }

    /// L of V = L Lᵀ (in the lower triangle), and L⁻¹H with its image.
    pub(crate) fn factors(&self) -> (MatRef<'_, f64>, MatRef<'_, f64>, Option<&Image>) {
        (self.parts.factor.as_ref(), self.parts.solved.as_ref(), self.image.as_ref())
    }

    /// On which side of the boundary the body lies.
    pub(crate) fn domain(&self) -> Domain {
        self.parts.domain
    }

    /// Removes the part of the displacement at infinity from L⁻¹ times a matrix of tractions, and from its image; does nothing
    /// unless the displacement is bounded there.
    pub(crate) fn balance(&self, a: MatMut<'_, f64>, image: &mut Option<Image>) {
        if let Some(translations) = &self.parts.translations {
            translations.remove(a);
            *image = None;
        }
    }

    /// R⁻¹Qᵀ times matrices and L⁻ᵀQR⁻ᵀ, L⁻¹H 1 = L⁻¹ times the resultants of the tractions = QR; None unless the displacement is bounded
    /// at infinity.
    pub(crate) fn constants(
        &self,
        resultants: &Mat<f64>,
        of: [MatRef<'_, f64>; 2],
    ) -> Option<([Mat<f64>; 2], Mat<f64>)> {
        let basis = &self.parts.translations.as_ref()?.basis;
        let factor = self.parts.factor.as_ref();
        let mut moved = resultants.clone();
        solve_lower_triangular_in_place(factor, moved.as_mut(), Par::Seq);
        let upper = along(basis, moved.as_ref());
        let [a, b] = of.map(|a| {
            let mut constant = along(basis, a);
            solve_upper_triangular_in_place(upper.as_ref(), constant.as_mut(), Par::Seq);
            constant
        });
        // (R⁻¹Qᵀ)ᵀ
        let mut densities = basis.transpose().to_owned();
        solve_upper_triangular_in_place(upper.as_ref(), densities.as_mut(), Par::Seq);
        let mut densities = densities.transpose().to_owned();
        solve_upper_triangular_in_place(factor.transpose(), densities.as_mut(), Par::Seq);
        Some(([a, b], densities))
    }

    /// The constant a to which the displacement tends at infinity, from a nodal displacement on the boundary; 0 unless the
    /// domain asks for a constant.
    pub fn at_infinity(&self, displacement: &[f64]) -> [f64; 2] {
        self.parts.translations.as_ref().map_or([0.0; 2], |t| {
            let a = &t.constant * Col::from_fn(displacement.len(), |i| displacement[i]);
            [a[0], a[1]]
        })
    }

    /// Legendre coefficients of the traction t = σ(u)n of a nodal displacement, interleaved as [`crate::Space`] says.
    pub fn apply(&self, displacement: &[f64]) -> Vec<f64> {
        self.with_correction(displacement, &[])
    }

    /// ζ = V⁻¹(Hz - j): the traction of the dual solution z of a functional whose values of the tractions are j.
    pub(crate) fn apply_dual(&self, z: &[f64], j: &[f64]) -> Vec<f64> {
        let sign = self.parts.domain.sign();
        let mut y = Mat::from_fn(j.len(), 1, |i, _| -sign * j[i]);
        solve_lower_triangular_in_place(self.parts.factor.as_ref(), y.as_mut(), Par::Seq);
        self.balance(y.as_mut(), &mut None);
        self.with_correction(z, y.col_as_slice(0))
    }

    /// The same of L⁻¹H u with a correction, or without one.
    pub(crate) fn with_correction(&self, displacement: &[f64], correction: &[f64]) -> Vec<f64> {
        let u = Col::from_fn(displacement.len(), |i| displacement[i]);
        let mut t = &self.parts.solved * &u;
        correction.iter().enumerate().for_each(|(i, c)| t[i] += c);
        if self.parts.domain.is_exterior() {
            t *= -1.0;
        }
        solve_upper_triangular_in_place(self.parts.factor.as_ref().transpose(), t.as_mat_mut(), Par::Seq);
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
