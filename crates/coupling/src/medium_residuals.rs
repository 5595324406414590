//! Dual weighted residuals of the equations of the medium.
//!
//! With z the dual solution of a number J of the displacement ξ and the traction φ, loaded by -J, H = ½M - K, β the bubbles of the jump u0
//! that its nodal values miss, S₊ of the spaces of one more degree, and P_p the Legendre polynomial of the lowest degree that φ lacks,
//! ```text
//! J(u₊) - J(u) ≈ Σ_e η_e,      η_e = ρ·[V_ee]⁻¹ (ρ_z + j)_e - β_e·(S₊ z + j)_e,      ρ = ⟨Hξ + Vφ, P_p⟩
//! ```
//! *Fails when* few elements resolve the medium: the residuals of both solutions then have parts of higher degrees. *Cost*: the matrices of
//! the spaces of one more degree, 7 N² doubles for N unknowns of degree 1; and N² operations for each number.
//!
//! Source: Becker and Rannacher (2001), section 3, for the two-field form of Costabel (1987).

use steklov_bem_operators::{BemError, Enriched, EnrichedSteklov, Mesh, PairCache, TractionMap};
use steklov_elastic::plane::{dot, solve2};
use steklov_quadrature::{gauss_legendre, legendre_p};

use crate::{Coupled, Medium};

/// Gauss points for the bubbles of a jump, more than the degree.
const MORE_POINTS: usize = 6;

/// The residuals of a solution in the medium.
#[derive(Debug)]
pub struct MediumResiduals {
    enriched: EnrichedSteklov,
    /// ρ, two for each element.
    residual: Vec<f64>,
    /// β, two for each element.
    jump: Vec<f64>,
}

/// The load of a number of displacement and traction of the medium, of the form that has displacements alone.
#[derive(Debug, Clone)]
pub struct MediumLoad {
    /// Forces at the nodes, on the bubbles, and values of the top tractions.
    nodes: Vec<f64>,
    bubbles: Vec<f64>,
    top: Vec<f64>,
}

impl MediumLoad {
    /// The load -J of the dual problem at the nodes of the boundary elements.
    pub fn opposite(&self) -> Vec<f64> {
        self.nodes.iter().map(|f| -f).collect()
    }
}

impl MediumResiduals {
    /// Those of a solution with the jump u0; `traction` is the map of its medium, `outside` whether numbers of the medium follow.
    ///
    /// # Errors
    /// As [`EnrichedSteklov::new`].
    pub fn new(
        medium: &Medium,
        traction: &TractionMap,
        solved: &Coupled,
        jump: &dyn Fn([f64; 2]) -> [f64; 2],
        outside: bool,
    ) -> Result<Self, BemError> {
        let Medium { mesh, space, material, operators } = medium;
        let cache = &mut PairCache::default();
        let enriched = EnrichedSteklov::new(mesh, space, material, operators.length, traction, cache, outside)?;
        let residual = enriched.traction_residual(&without_constant(solved));
        let jump = (0..mesh.len()).flat_map(|e| bubble(mesh, medium, e, jump)).collect();
        Ok(Self { enriched, residual, jump })
    }

    /// The load of a number by its values of the functions of the enriched spaces: of displacements, and of tractions.
    ///
    /// # Panics
    /// Unless numbers of the medium were announced.
    pub fn load(&self, traction: &TractionMap, [of_displacement, of_traction]: &[Enriched; 2]) -> MediumLoad {
        let Some([nodes, bubbles, top]) = self.enriched.dual_of_traction(traction, of_traction) else {
            panic!("the residuals are those of the body alone")
        };
        let sum = |a: &[f64], b: Vec<f64>| a.iter().zip(b).map(|(a, b)| a + b).collect::<Vec<f64>>();
        MediumLoad { nodes: sum(&of_displacement.base, nodes), bubbles: sum(&of_displacement.extra, bubbles), top }
    }

    /// How much the energy J = ½ a(u, u) + ½ ⟨Sξ, ξ⟩ - f·u changes: ½ ρ·V_ee⁻¹ ρ - β·S₊ξ of each element.
    pub fn of_energy(&self, solved: &Coupled) -> Vec<f64> {
        let force = self.enriched.excess(&without_constant(solved)).extra;
        let at = |of: &[f64], e: usize| [of[2 * e], of[2 * e + 1]];
        let change = |e: usize| {
            let rho = at(&self.residual, e);
            let gain = dot(rho, solve2(self.enriched.single_layer_block(e), rho)) / 2.0;
            gain - dot(at(&self.jump, e), at(&force, e))
        };
        (0..self.residual.len() / 2).map(change).collect()
    }

    /// η_e of a number, from the trace of its dual solution at the nodes, and its load if it is one of the medium.
    pub fn weighted(&self, trace: &[f64], load: Option<&MediumLoad>) -> Vec<f64> {
        let (mut of_traction, mut force) = (self.enriched.traction_residual(trace), self.enriched.excess(trace).extra);
        if let Some(load) = load {
            of_traction.iter_mut().zip(&load.top).for_each(|(r, j)| *r += j);
            force.iter_mut().zip(&load.bubbles).for_each(|(f, j)| *f += j);
        }
        let at = |of: &[f64], e: usize| [of[2 * e], of[2 * e + 1]];
        let eta = |e: usize| {
            let x = solve2(self.enriched.single_layer_block(e), at(&of_traction, e));
            dot(at(&self.residual, e), x) - dot(at(&self.jump, e), at(&force, e))
        };
        (0..self.residual.len() / 2).map(eta).collect()
    }
}

/// ξ - a at the nodes.
fn without_constant(solved: &Coupled) -> Vec<f64> {
    solved.exterior_displacement.iter().enumerate().map(|(k, u)| u - solved.constant[k % 2]).collect()
}

/// The coefficient of (P_(p+1) - P_(p-1))/(2p+1) in u0 less its nodal interpolant on element e: its slope is P_p.
fn bubble(mesh: &Mesh, medium: &Medium, e: usize, jump: &dyn Fn([f64; 2]) -> [f64; 2]) -> [f64; 2] {
    let basis = medium.space.basis(e);
    let p = basis.degree;
    let nodal: Vec<[f64; 2]> = basis.nodes.iter().map(|&t| jump(mesh.point(e, t))).collect();
    let (mut phi, mut legendre, mut sum) = (vec![0.0; p + 1], vec![0.0; p + 1], [0.0; 2]);
    let rule = gauss_legendre(p + MORE_POINTS);
    for (&t, w) in rule.points.iter().zip(&rule.weights) {
        basis.evaluate(t, &mut phi);
        legendre_p(t, &mut legendre);
        // P_p' = Σ (2n+1) P_n over n = p - 1, p - 3, ...
        let slope: f64 = (0..p).rev().step_by(2).map(|n| (2 * n + 1) as f64 * legendre[n]).sum();
        let value = jump(mesh.point(e, t));
        for i in 0..2 {
            let interpolant: f64 = phi.iter().zip(&nodal).map(|(phi, u)| phi * u[i]).sum();
            // ∫ (u0 - I u0)' P_p by parts
            sum[i] -= w * (value[i] - interpolant) * slope;
        }
    }
    sum.map(|moment| moment * (2 * p + 1) as f64 / 2.0)
}
