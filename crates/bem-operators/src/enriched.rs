//! The Steklov-Poincaré matrix of the enriched spaces, by blocks on top of that of the base.

use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Col, Mat, Par};
use steklov_algebra::{Image, add_product, cholesky, dot, solve_lower};
use steklov_elastic::Material;

use crate::{BemError, Bubbles, Enrichment, Mesh, PairCache, Space, TractionMap};

/// S₊ of the spaces of one more degree, from the factors of S.
///
/// With b for the base and x for the extra unknowns (bubbles, top tractions), V₊ = L₊L₊ᵀ and X = L₊⁻¹H₊,
///
/// ```text
/// S₊ = [ S + X_xbᵀX_xb        C + X_xbᵀX_xx ]      C = W_bx + X_bbᵀX_bx
///      [ Cᵀ + X_xxᵀX_xb       D + X_xxᵀX_xx ]      D = W_xx + X_bxᵀX_bx
/// ```
/// and for a displacement u of the base with traction ψ = V⁻¹Hu the Galerkin residuals of the extra functions are
/// ⟨(K+½)u - Vψ, P_p⟩ = L_xx X_xb u and ⟨Wu + (K'+½)ψ, b⟩ = Cᵀu. The tractions of the enriched spaces, V₊ψ₊ = H₊u₊, are
///
/// ```text
/// ψ_x = L_xx⁻ᵀ (X_xb u_b + X_xx u_x)         ψ_b = L⁻ᵀ (X_bb u_b + X_bx u_x - L_xbᵀψ_x)
/// ```
/// If the displacement is bounded at infinity, L⁻¹H 1 = QR, the constant there is that of the base with L⁻¹(H₊u₊ - V_bx ψ_x) for L⁻¹Hu:
///
/// ```text
/// a = R⁻¹Qᵀ (L⁻¹H u_b + L⁻¹H_bx u_x - L⁻¹V_bx ψ_x)
/// ```
///
/// Source: Heuer, Mellado and Stephan (2001), two-level hp boundary elements.
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
    /// L_xbᵀ and X_bx, N×n, which tractions need.
    of_tractions: Option<[Mat<f64>; 2]>,
    /// R⁻¹QᵀL⁻¹H_bx and R⁻¹QᵀL⁻¹V_bx, 2×n, and L⁻ᵀQR⁻ᵀ, N×2, which the constant at infinity needs, if there is one and tractions are wanted.
    of_constant: Option<([Mat<f64>; 2], Mat<f64>)>,
    /// 2×2 blocks of V and W on the diagonal, one for each element.
    blocks: Vec<[[[f64; 2]; 2]; 2]>,
}

/// A vector of the enriched displacement space, or of that of tractions.
#[derive(Debug, Clone, PartialEq)]
pub struct Enriched {
    /// Nodal values, N entries; of tractions Legendre coefficients.
    pub base: Vec<f64>,
    /// Coefficients of the bubbles, n entries; of tractions those of the top degree.
    pub extra: Vec<f64>,
}

impl EnrichedSteklov {
    /// The blocks that S₊ needs besides S. The space has operators by [`crate::Operators::to_enrich`] with the same
    /// `material`, `length` and `cache`, which have become `traction`. If the displacement is bounded at infinity, the extra
    /// tractions, which have no resultant, are made V-orthogonal to the base tractions without resultant.
    ///
    /// `with_tractions`: [`EnrichedSteklov::traction`] is wanted.
    ///
    /// Cost: 6 N²n multiplications and additions for N unknowns and n extra ones; 4 Nn + 3 n² doubles, with tractions Nn more.
    /// # Errors
    /// [`BemError::SingleLayerIndefinite`] when V₊ has no Cholesky factor; as [`Enrichment::assemble`].
    pub fn new(
        mesh: &Mesh,
        space: &Space,
        material: &Material,
        length: f64,
        traction: &TractionMap,
        cache: &mut PairCache,
        with_tractions: bool,
    ) -> Result<Self, BemError> {
        let (enrichment, bubbles) = Enrichment::assemble(mesh, space, material, length, cache)?;
        let resultants = with_tractions.then(|| resultants(mesh, space));
        let layers = Layers::new(enrichment, traction, [length, mesh.diameter()], resultants.as_ref())?;
        let bubbles = match bubbles {
            Some(bubbles) => bubbles,
            None => Bubbles::assemble(mesh, space, material, length, cache)?,
        };
        layers.with(bubbles, traction)
    }
}

/// The part of [`EnrichedSteklov`] that follows from V₊ and H₊.
struct Layers {
    factor: Mat<f64>,
    top: Mat<f64>,
    corner: Mat<f64>,
    /// L_xbᵀ, N×n, if it is wanted.
    mixed: Option<Mat<f64>>,
    /// X_bx, N×n.
    x_bubble: Mat<f64>,
    /// Its image.
    of_bubble: Option<Image>,
    /// R⁻¹QᵀL⁻¹H_bx and R⁻¹QᵀL⁻¹V_bx, and L⁻ᵀQR⁻ᵀ.
    of_constant: Option<([Mat<f64>; 2], Mat<f64>)>,
    /// 2×2 blocks of V on the diagonal.
    blocks: Vec<[[f64; 2]; 2]>,
}

impl Layers {
    /// Builds the layers in the storage of the enrichment; with what tractions need if the resultants of the base tractions are given.
    fn new(
        enrichment: Enrichment,
        traction: &TractionMap,
        [length, diameter]: [f64; 2],
        resultants: Option<&Mat<f64>>,
    ) -> Result<Self, BemError> {
        let (l, x, of_x) = traction.factors();
        let n = x.nrows();
        let Enrichment {
            v: mut y, v_corner: mut factor, k: mut x_bubble, k_corner: mut corner, k_top: mut top, ..
        } = enrichment;
        let extra = top.nrows();
        let blocks = diagonal_blocks(&factor);
        if traction.domain().is_exterior() {
            x_bubble *= -1.0;
            corner *= -1.0;
            top *= -1.0;
        }
        for (&value, (row, column)) in &enrichment.mass {
            x_bubble[(row, column)] += 0.5 * value;
        }
        for (&value, (row, column)) in &enrichment.mass_top {
            top[(row, column)] += 0.5 * value;
        }
        // L_xb = Yᵀ with Y = L⁻¹V_bx
        let mut of_y = Some(solve_lower(l, y.as_mut(), None)?);
        let mut of_bubble = Some(solve_lower(l, x_bubble.as_mut(), None)?);
        let of_constant =
            resultants.and_then(|resultants| traction.constants(resultants, [x_bubble.as_ref(), y.as_ref()]));
        traction.balance(y.as_mut(), &mut of_y);
        traction.balance(x_bubble.as_mut(), &mut of_bubble);
        add_product(factor.as_mut(), y.transpose(), y.as_ref(), -1.0, of_y.as_ref())?;
        let size = n + extra;
        let indefinite = |pivot| BemError::SingleLayerIndefinite { pivot: n + pivot, size, length, diameter };
        cholesky(factor.as_mut()).map_err(|none| none.or(indefinite))?;
        let of_top = add_product(top.as_mut(), y.transpose(), x, -1.0, of_x)?;
        let of_corner = add_product(corner.as_mut(), y.transpose(), x_bubble.as_ref(), -1.0, of_bubble.as_ref())?;
        let mixed = resultants.is_some().then_some(y);
        solve_lower(factor.as_ref(), top.as_mut(), Some(&of_top))?;
        solve_lower(factor.as_ref(), corner.as_mut(), Some(&of_corner))?;
        Ok(Self { factor, top, corner, mixed, x_bubble, of_bubble, of_constant, blocks })
    }

    /// Works in the storage of the blocks of W.
    fn with(self, bubbles: Bubbles, traction: &TractionMap) -> Result<EnrichedSteklov, BemError> {
        let Self { factor, top, corner, mixed, x_bubble, of_bubble, of_constant, blocks } = self;
        let Bubbles { w: mut coupling, w_corner: mut bubble } = bubbles;
        let blocks = blocks.into_iter().zip(diagonal_blocks(&bubble)).map(|(v, w)| [v, w]).collect();
        let (_, x, _) = traction.factors();
        add_product(coupling.as_mut(), x.transpose(), x_bubble.as_ref(), 1.0, of_bubble.as_ref())?;
        add_product(bubble.as_mut(), x_bubble.transpose(), x_bubble.as_ref(), 1.0, of_bubble.as_ref())?;
        let of_tractions = mixed.map(|mixed| [mixed, x_bubble]);
        Ok(EnrichedSteklov { factor, top, corner, coupling, bubble, of_tractions, of_constant, blocks })
    }
}

/// The resultants ∫ ψ ds of the base tractions, traction × 2.
fn resultants(mesh: &Mesh, space: &Space) -> Mat<f64> {
    let mut all = Mat::zeros(2 * space.offset[mesh.len()], 2);
    for (e, i) in (0..mesh.len()).flat_map(|e| [(e, 0), (e, 1)]) {
        all[(2 * space.offset[e] + i, i)] = mesh.length(e);
    }
    all
}

/// The 2×2 blocks on the diagonal of a matrix.
fn diagonal_blocks(a: &Mat<f64>) -> Vec<[[f64; 2]; 2]> {
    let at = |e: usize, i: usize, j: usize| a[(2 * e + i, 2 * e + j)];
    (0..a.nrows() / 2).map(|e| [0, 1].map(|i| [0, 1].map(|j| at(e, i, j)))).collect()
}

impl EnrichedSteklov {
    /// Residuals ⟨(K+½)u - Vψ, P_p⟩ of the top tractions, two for each element.
    pub fn traction_residual(&self, u: &[f64]) -> Vec<f64> {
        let y = &self.top * column(u);
        let mut residual = vec![0.0; y.nrows()];
        // by columns, as they are stored
        for j in 0..y.nrows() {
            let below = &self.factor.col_as_slice(j)[j..];
            residual[j..].iter_mut().zip(below).for_each(|(r, l)| *r += l * y[j]);
        }
        residual
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

    /// Coefficients of the tractions ψ₊ of an enriched displacement; `of_base` maps those of the base. None if they were not wanted.
    pub fn traction(&self, of_base: &TractionMap, u: &Enriched) -> Option<Enriched> {
        let [mixed, of_bubble] = self.of_tractions.as_ref()?;
        let (b, x) = (column(&u.base), column(&u.extra));
        let mut top = &self.top * &b + &self.corner * &x;
        solve_upper_triangular_in_place(self.factor.transpose(), top.as_mat_mut(), Par::Seq);
        let correction = of_bubble * &x - mixed * &top;
        let sign = of_base.domain().sign();
        let base = of_base.with_correction(&u.base, &values(&correction));
        Some(Enriched { base, extra: top.iter().map(|t| sign * t).collect() })
    }

    /// The constant a to which an enriched displacement with these tractions tends at infinity; `of_base` has that of the base. 0 unless the
    /// domain asks for a constant.
    pub fn at_infinity(&self, of_base: &TractionMap, u: &Enriched, traction: &Enriched) -> [f64; 2] {
        let own = of_base.at_infinity(&u.base);
        let Some(([of_bubble, of_top], _)) = &self.of_constant else { return own };
        let sign = of_base.domain().sign();
        let (bubbles, tops) = (of_bubble * column(&u.extra), of_top * column(&traction.extra));
        [0, 1].map(|i| own[i] + bubbles[i] - sign * tops[i])
    }

    /// The right side of the dual problem of w·a, a the constant at infinity: on the nodes, on the bubbles and on the top tractions. None
    /// without a constant, or if tractions were not wanted.
    pub fn dual_of_constant(&self, of_base: &TractionMap, w: [f64; 2]) -> Option<[Vec<f64>; 3]> {
        let ([of_bubble, of_top], _) = self.of_constant.as_ref()?;
        let constant = &of_base.parts().translations.as_ref()?.constant;
        let along = |a: &Mat<f64>, sign: f64| a.col_iter().map(|a| sign * (w[0] * a[0] + w[1] * a[1])).collect();
        Some([along(constant, 1.0), along(of_bubble, 1.0), along(of_top, -1.0)])
    }

    /// ζ = V⁻¹(Hz - j): the traction (stress) of the dual solution z of a functional whose values of the base tractions are j and whose weights
    /// of the constant at infinity are w, which are the resultant -∮ζ out of the body; by Legendre coefficients.
    pub fn dual_traction(&self, of_base: &TractionMap, z: &[f64], (j, w): (&[f64], [f64; 2])) -> Vec<f64> {
        let mut zeta = of_base.apply_dual(z, j);
        if let Some((_, densities)) = &self.of_constant {
            let w = w.map(|w| of_base.domain().sign() * w);
            zeta.iter_mut().enumerate().for_each(|(k, t)| *t -= w[0] * densities[(k, 0)] + w[1] * densities[(k, 1)]);
        }
        zeta
    }

    /// The right side of the dual problem of a functional of the traction, by its values j of the tractions, in the form that has displacements
    /// alone: HᵀV⁻¹j on the nodes and on the bubbles, and on the top tractions j - V_xb V⁻¹j. None if tractions were not wanted.
    pub fn dual_of_traction(&self, of_base: &TractionMap, j: &Enriched) -> Option<[Vec<f64>; 3]> {
        let [mixed, of_bubble] = self.of_tractions.as_ref()?;
        let (factor, solved, _) = of_base.factors();
        let sign = of_base.domain().sign();
        let mut y = column(&j.base);
        y *= sign;
        solve_lower_triangular_in_place(factor, y.as_mat_mut(), Par::Seq);
        let top = mixed.transpose() * &y;
        let top = j.extra.iter().zip(top.iter()).map(|(j, of_base)| sign * j - of_base).collect();
        Some([values(&(solved.transpose() * &y)), values(&(of_bubble.transpose() * &y)), top])
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
        dot(&self.base, &other.base) + dot(&self.extra, &other.extra)
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
