//! Particular solutions: of a constant body force, and of a uniform stress far away.

use steklov_elastic::Material;
use steklov_elastic::plane::{dot, minus, norm};
use steklov_quadrature::legendre_p;

use crate::near::panel_rule;
use crate::{Mesh, Space};

/// Gauss points for a polynomial of the point times the normal on a curved element.
const CURVE_POINTS: usize = 24;

/// Particular solution of div σ(u) + b = 0 for a constant force b per area, with a uniform stress σ_∞ added:
///
/// ```text
/// u_p(x) = ε_∞ (x - x_0) - (ξ²/2) b/(λ+2μ),    ξ = b·(x - x_0)/|b|,    σ(ε_∞ x) = σ_∞
/// ```
/// The strain of the second part is uniaxial along b, so the solution turns with the scene, and it stays bounded as ν → ½. The
/// first part is the field of a stressed unbounded body far away from its holes.
#[derive(Debug, Clone, Copy)]
pub struct ParticularSolution {
    force: [f64; 2],
    /// ε_∞, without rotation: xx, yy, xy.
    strain: [f64; 3],
    centre: [f64; 2],
    material: Material,
}

impl ParticularSolution {
    /// The solution for a force per area; `centre` is the point x_0 at which the particular solution and its stress vanish.
    pub fn of_body_force(force: [f64; 2], centre: [f64; 2], material: &Material) -> Self {
        Self { force, strain: [0.0; 3], centre, material: *material }
    }

    /// The field of a uniform stress xx, yy, xy; `centre` is the point x_0 that does not move.
    pub fn of_uniform_stress([xx, yy, xy]: [f64; 3], centre: [f64; 2], material: &Material) -> Self {
        let (nu, mu) = (material.nu(), material.mu());
        let along = |a: f64, b: f64| ((1.0 - nu) * a - nu * b) / (2.0 * mu);
        let strain = [along(xx, yy), along(yy, xx), xy / (2.0 * mu)];
        Self { force: [0.0; 2], strain, centre, material: *material }
    }

    /// b/|b| and ξ; zero without a force.
    fn along(&self, x: [f64; 2]) -> ([f64; 2], f64) {
        let norm = norm(self.force);
        let unit = if norm > 0.0 { self.force.map(|b| b / norm) } else { [0.0; 2] };
        (unit, dot(unit, minus(x, self.centre)))
    }

    /// u_p.
    pub fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
        let modulus = self.material.lambda() + 2.0 * self.material.mu();
        let xi = self.along(x).1;
        let ([xx, yy, xy], d) = (self.strain, minus(x, self.centre));
        let uniform = [xx * d[0] + xy * d[1], xy * d[0] + yy * d[1]];
        [0, 1].map(|i| uniform[i] - 0.5 * xi * xi * self.force[i] / modulus)
    }

    /// Gradient [[∂x u_x, ∂y u_x], [∂x u_y, ∂y u_y]] of u_p.
    pub fn gradient(&self, x: [f64; 2]) -> [[f64; 2]; 2] {
        let modulus = self.material.lambda() + 2.0 * self.material.mu();
        let (unit, xi) = self.along(x);
        let [xx, yy, xy] = self.strain;
        let uniform = [[xx, xy], [xy, yy]];
        [0, 1].map(|i| [0, 1].map(|j| uniform[i][j] - xi * self.force[i] * unit[j] / modulus))
    }

    /// σ(u_p): σ_xx, σ_yy, σ_xy, linear in x.
    pub fn stress(&self, x: [f64; 2]) -> [f64; 3] {
        self.material.stress(self.gradient(x))
    }

    /// σ(u_p) n.
    pub fn traction(&self, x: [f64; 2], n: [f64; 2]) -> [f64; 2] {
        let [xx, yy, xy] = self.stress(x);
        [xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]]
    }

    /// ∫ σ(u_p) n · φ over the whole boundary, for each displacement unknown.
    pub fn traction_load(&self, mesh: &Mesh, space: &Space) -> Vec<f64> {
        self.traction_load_of(mesh, space, |_, _| true)
    }

    /// The same for those elements and components for which `of` holds.
    pub fn traction_load_of(&self, mesh: &Mesh, space: &Space, of: impl Fn(usize, usize) -> bool) -> Vec<f64> {
        let mut load = vec![0.0; space.dofs()];
        for e in 0..mesh.len() {
            let basis = space.basis(e);
            if !mesh.is_line(e) {
                let mut phi = vec![0.0; basis.degree + 1];
                self.on_curve(mesh, e, basis.degree, |t, traction| {
                    basis.evaluate(t, &mut phi);
                    for (phi, node) in phi.iter().zip(space.element_nodes(e)) {
                        (0..2).filter(|&i| of(e, i)).for_each(|i| load[2 * node + i] += phi * traction[i]);
                    }
                });
                continue;
            }
            let (n, half) = (mesh.normal(e, 0.0), mesh.length(e) / 2.0);
            // linear traction times φ: the Lobatto rule is exact from p = 2, Simpson's weights of φ_j for p = 1
            let ends = [-1.0, 1.0].map(|t| self.traction(mesh.point(e, t), n));
            for (j, node) in space.element_nodes(e).enumerate() {
                for i in (0..2).filter(|&i| of(e, i)) {
                    let (mean, slope) = ((ends[0][i] + ends[1][i]) / 2.0, (ends[1][i] - ends[0][i]) / 2.0);
                    // ∫φ_j dt = w_j and ∫ t φ_j dt = w_j t_j, or 1/3 of the sign for p = 1
                    let first =
                        if basis.degree == 1 { basis.nodes[j] / 3.0 } else { basis.weights[j] * basis.nodes[j] };
                    load[2 * node + i] += half * (mean * basis.weights[j] + slope * first);
                }
            }
        }
        load
    }

    /// ∫ σ(u_p) n · b over the bubbles b = (P_(p+1) - P_(p-1))/(2p+1), two for each element; 0 from p = 3 on
    /// where it is straight.
    pub fn bubble_load(&self, mesh: &Mesh, space: &Space) -> Vec<f64> {
        let mut load = vec![0.0; 2 * mesh.len()];
        for e in 0..mesh.len() {
            let (n, half, p) = (mesh.normal(e, 0.0), mesh.length(e) / 2.0, space.degree(e));
            if !mesh.is_line(e) {
                let mut legendre = vec![0.0; p + 2];
                self.on_curve(mesh, e, p, |t, traction| {
                    legendre_p(t, &mut legendre);
                    let bubble = (legendre[p + 1] - legendre[p - 1]) / (2 * p + 1) as f64;
                    (0..2).for_each(|i| load[2 * e + i] += bubble * traction[i]);
                });
                continue;
            }
            let ends = [-1.0, 1.0].map(|t| self.traction(mesh.point(e, t), n));
            for i in 0..2 {
                // P_(p-1) against mean + slope t
                let moment = match p {
                    1 => ends[0][i] + ends[1][i],
                    2 => (ends[1][i] - ends[0][i]) / 3.0,
                    _ => 0.0,
                };
                load[2 * e + i] = -half * moment / (2 * p + 1) as f64;
            }
        }
        load
    }

    /// Calls `f` with t and σ(u_p)n |γ'| w at the points of a rule that is exact to rounding on a curved element for a basis of
    /// this degree.
    fn on_curve(&self, mesh: &Mesh, e: usize, degree: usize, mut f: impl FnMut(f64, [f64; 2])) {
        let rule = panel_rule(CURVE_POINTS + degree / 2);
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            let traction = self.traction(mesh.point(e, t), mesh.normal(e, t));
            f(t, traction.map(|v| w * mesh.speed(e, t) * v));
        }
    }

    /// (a(u_p, u_p), ∫_Ω b·u_p) of a body force in a bounded body: twice the strain energy of u_p and the work of b on it, as
    /// boundary integrals.
    pub fn energies(&self, mesh: &Mesh) -> (f64, f64) {
        let mut work_of_force = 0.0;
        let mut work_of_traction = 0.0;
        let modulus = self.material.lambda() + 2.0 * self.material.mu();
        let b2 = self.force[0].powi(2) + self.force[1].powi(2);
        for e in 0..mesh.len() {
            let rule = panel_rule(if mesh.is_line(e) { 4 } else { CURVE_POINTS });
            for (&t, &w) in rule.points.iter().zip(&rule.weights) {
                let (x, n, half) = (mesh.point(e, t), mesh.normal(e, t), mesh.speed(e, t));
                let (unit, xi) = self.along(x);
                // ∫_Ω ξ² = ∮ ξ³/3 unit·n
                let flux = xi.powi(3) / 3.0 * dot(unit, n);
                work_of_force -= w * half * 0.5 * b2 / modulus * flux;
                let (t, u) = (self.traction(x, n), self.displacement(x));
                work_of_traction += w * half * dot(t, u);
            }
        }
        (work_of_traction + work_of_force, work_of_force)
    }
}
