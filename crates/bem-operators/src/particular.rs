//! Particular solutions: of a body force that is constant or affine in the place, and of a uniform stress far away.

use steklov_elastic::Material;
use steklov_elastic::plane::{dot, minus, norm};
use steklov_quadrature::legendre_p;

use crate::near::panel_rule;
use crate::{Mesh, Space};

/// Gauss points for a polynomial of the point times the normal on a curved element.
const CURVE_POINTS: usize = 24;
/// Gauss points for the products of stress, displacement and force on a straight one, of degree 5.
const LINE_POINTS: usize = 3;
/// Degree from which the bubbles of a straight element do not see the tractions, which are quadratic.
const UNSEEN: usize = 4;

/// Particular solution of div σ(u) + b = 0 for a force per area b = b_0 + B d, d = x - x_0, with a uniform stress σ_∞ added:
///
/// ```text
/// u_p(x) = ε_∞ d - (ξ²/2) b_0/(λ+2μ) - ∇ψ/(λ+2μ) - w r² Jd/(8μ),    ξ = b_0·d/|b_0|,    r = |d|,    σ(ε_∞ x) = σ_∞
/// B = τ/2 I + D + w J,    D symmetric, tr D = 0,    J = [[0, -1], [1, 0]]
/// ψ = τ r⁴/64 + r² d·Dd/24,    ∇ψ = τ r² d/16 + (d·Dd d + r² Dd)/12
/// ```
/// The first part is the field of a stressed unbounded body far away from its holes; the strain of the second is uniaxial along
/// b_0. Those of B: the force τ d/2 + Dd is the gradient of φ = τ r²/4 + d·Dd/2, and Δψ = φ since Δr⁴ = 16 r² and
/// Δ(r² h) = 12 h for h harmonic of degree 2, so that (λ+2μ) ∇div u = -∇φ for u = -∇ψ/(λ+2μ); the rest w Jd has no divergence,
/// as r² Jd has none, and Δ(r² Jd) = 8 Jd. All parts are isotropic functions of b_0, B and d, so that the solution turns with
/// the scene, and bounded as ν → ½, with their stresses. u_p is a cubic polynomial, its stress a quadratic one.
#[derive(Debug, Clone, Copy)]
pub struct ParticularSolution {
    /// b_0.
    force: [f64; 2],
    affine: AffinePart,
    /// ε_∞, without rotation: xx, yy, xy.
    strain: [f64; 3],
    centre: [f64; 2],
    material: Material,
}

/// The parts of B and what belongs to them.
#[derive(Debug, Clone, Copy, Default)]
struct AffinePart {
    /// τ.
    trace: f64,
    /// D_xx = -D_yy and D_xy.
    deviator: [f64; 2],
    /// w.
    spin: f64,
}

impl AffinePart {
    fn new([[xx, xy], [yx, yy]]: [[f64; 2]; 2]) -> Self {
        Self { trace: xx + yy, deviator: [0.5 * (xx - yy), 0.5 * (xy + yx)], spin: 0.5 * (yx - xy) }
    }

    /// Dd.
    fn stretched(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [a, b] = self.deviator;
        [a * x + b * y, b * x - a * y]
    }

    /// B d.
    fn force(&self, d: [f64; 2]) -> [f64; 2] {
        let stretched = self.stretched(d);
        [0, 1].map(|i| 0.5 * self.trace * d[i] + stretched[i] + self.spin * turned(d)[i])
    }

    /// Its part of u_p; the moduli are λ+2μ and μ.
    fn displacement(&self, d: [f64; 2], [modulus, shear]: [f64; 2]) -> [f64; 2] {
        let (stretched, turned, r2) = (self.stretched(d), turned(d), dot(d, d));
        let q = dot(d, stretched);
        [0, 1].map(|i| {
            let gradient = self.trace * r2 * d[i] / 16.0 + (q * d[i] + r2 * stretched[i]) / 12.0;
            -gradient / modulus - self.spin * r2 * turned[i] / (8.0 * shear)
        })
    }

    /// The gradient of this part.
    fn gradient(&self, d: [f64; 2], [modulus, shear]: [f64; 2]) -> [[f64; 2]; 2] {
        let (stretched, turned, r2) = (self.stretched(d), turned(d), dot(d, d));
        let (q, [a, b]) = (dot(d, stretched), self.deviator);
        let (deviator, rotation) = ([[a, b], [b, -a]], [[0.0, -1.0], [1.0, 0.0]]);
        let entry = |i: usize, j: usize| {
            let same = if i == j { 1.0 } else { 0.0 };
            let of_trace = same * r2 + 2.0 * d[i] * d[j];
            let of_deviator = same * q + 2.0 * (d[i] * stretched[j] + stretched[i] * d[j]) + r2 * deviator[i][j];
            let of_spin = 2.0 * turned[i] * d[j] + r2 * rotation[i][j];
            -(self.trace * of_trace / 16.0 + of_deviator / 12.0) / modulus - self.spin * of_spin / (8.0 * shear)
        };
        [0, 1].map(|i| [0, 1].map(|j| entry(i, j)))
    }
}

/// J d.
fn turned([x, y]: [f64; 2]) -> [f64; 2] {
    [-y, x]
}

impl ParticularSolution {
    /// The solution for a constant force per area; `centre` is the point x_0 at which the particular solution and its stress
    /// vanish.
    pub fn of_body_force(force: [f64; 2], centre: [f64; 2], material: &Material) -> Self {
        Self::of_affine_force(force, [[0.0; 2]; 2], centre, material)
    }

    /// The solution for the force per area `force` + `gradient` (x - `centre`), with [[∂x b_x, ∂y b_x], [∂x b_y, ∂y b_y]]
    /// (stress/length²).
    pub fn of_affine_force(force: [f64; 2], gradient: [[f64; 2]; 2], centre: [f64; 2], material: &Material) -> Self {
        Self { force, affine: AffinePart::new(gradient), strain: [0.0; 3], centre, material: *material }
    }

    /// The field of a uniform stress xx, yy, xy; `centre` is the point x_0 that does not move.
    pub fn of_uniform_stress([xx, yy, xy]: [f64; 3], centre: [f64; 2], material: &Material) -> Self {
        let (nu, mu) = (material.nu(), material.mu());
        let along = |a: f64, b: f64| ((1.0 - nu) * a - nu * b) / (2.0 * mu);
        let strain = [along(xx, yy), along(yy, xx), xy / (2.0 * mu)];
        Self { force: [0.0; 2], affine: AffinePart::default(), strain, centre, material: *material }
    }

    /// λ+2μ and μ.
    fn moduli(&self) -> [f64; 2] {
        let mu = self.material.mu();
        [self.material.lambda() + 2.0 * mu, mu]
    }

    /// b_0/|b_0| and ξ; zero without a force.
    fn along(&self, d: [f64; 2]) -> ([f64; 2], f64) {
        let norm = norm(self.force);
        let unit = if norm > 0.0 { self.force.map(|b| b / norm) } else { [0.0; 2] };
        (unit, dot(unit, d))
    }

    /// The parts of u_p of degree 1, 2 and 3 in d.
    fn parts(&self, d: [f64; 2]) -> [[f64; 2]; 3] {
        let (moduli, xi, [xx, yy, xy]) = (self.moduli(), self.along(d).1, self.strain);
        let uniform = [xx * d[0] + xy * d[1], xy * d[0] + yy * d[1]];
        let constant = self.force.map(|b| -0.5 * xi * xi * b / moduli[0]);
        [uniform, constant, self.affine.displacement(d, moduli)]
    }

    /// u_p.
    pub fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
        let [uniform, constant, affine] = self.parts(minus(x, self.centre));
        [0, 1].map(|i| uniform[i] + constant[i] + affine[i])
    }

    /// Gradient [[∂x u_x, ∂y u_x], [∂x u_y, ∂y u_y]] of u_p.
    pub fn gradient(&self, x: [f64; 2]) -> [[f64; 2]; 2] {
        let (moduli, d) = (self.moduli(), minus(x, self.centre));
        let (unit, xi) = self.along(d);
        let [xx, yy, xy] = self.strain;
        let (uniform, affine) = ([[xx, xy], [xy, yy]], self.affine.gradient(d, moduli));
        [0, 1].map(|i| [0, 1].map(|j| uniform[i][j] - xi * self.force[i] * unit[j] / moduli[0] + affine[i][j]))
    }

    /// σ(u_p): σ_xx, σ_yy, σ_xy, quadratic in x.
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
            let mut phi = vec![0.0; basis.degree + 1];
            self.on_element(mesh, e, basis.degree, |t, traction| {
                basis.evaluate(t, &mut phi);
                for (phi, node) in phi.iter().zip(space.element_nodes(e)) {
                    (0..2).filter(|&i| of(e, i)).for_each(|i| load[2 * node + i] += phi * traction[i]);
                }
            });
        }
        load
    }

    /// ∫ σ(u_p) n · b over the bubbles b = (P_(p+1) - P_(p-1))/(2p+1), two for each element; 0 from p = 4 on
    /// where it is straight.
    pub fn bubble_load(&self, mesh: &Mesh, space: &Space) -> Vec<f64> {
        let mut load = vec![0.0; 2 * mesh.len()];
        for e in (0..mesh.len()).filter(|&e| space.degree(e) < UNSEEN || !mesh.is_line(e)) {
            let p = space.degree(e);
            let mut legendre = vec![0.0; p + 2];
            self.on_element(mesh, e, p + 1, |t, traction| {
                legendre_p(t, &mut legendre);
                let bubble = (legendre[p + 1] - legendre[p - 1]) / (2 * p + 1) as f64;
                (0..2).for_each(|i| load[2 * e + i] += bubble * traction[i]);
            });
        }
        load
    }

    /// Calls `f` with t and σ(u_p)n |γ'| w at the points of a rule for the products with functions of this degree: exact on a
    /// straight element, where σ(u_p)n is quadratic, and to rounding on a curved one.
    fn on_element(&self, mesh: &Mesh, e: usize, degree: usize, mut f: impl FnMut(f64, [f64; 2])) {
        let rule = panel_rule(degree / 2 + if mesh.is_line(e) { 2 } else { CURVE_POINTS });
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            let traction = self.traction(mesh.point(e, t), mesh.normal(e, t));
            f(t, traction.map(|v| w * mesh.speed(e, t) * v));
        }
    }

    /// (a(u_p, u_p), ∫_Ω b·u_p) of a body force in a bounded body: twice the strain energy of u_p and the work of b on it, as
    /// boundary integrals. A polynomial f of degree k in d alone is the divergence of f d/(k+2).
    pub fn energies(&self, mesh: &Mesh) -> (f64, f64) {
        let mut work_of_force = 0.0;
        let mut work_of_traction = 0.0;
        for e in 0..mesh.len() {
            let rule = panel_rule(if mesh.is_line(e) { LINE_POINTS } else { CURVE_POINTS });
            for (&t, &w) in rule.points.iter().zip(&rule.weights) {
                let (x, n, half) = (mesh.point(e, t), mesh.normal(e, t), mesh.speed(e, t));
                let d = minus(x, self.centre);
                let ([_, second, third], linear) = (self.parts(d), self.affine.force(d));
                let cubic = dot(self.force, third) + dot(linear, second);
                let divided = dot(self.force, second) / 4.0 + cubic / 5.0 + dot(linear, third) / 6.0;
                work_of_force += w * half * divided * dot(d, n);
                let (t, u) = (self.traction(x, n), self.displacement(x));
                work_of_traction += w * half * dot(t, u);
            }
        }
        (work_of_traction + work_of_force, work_of_force)
    }
}
