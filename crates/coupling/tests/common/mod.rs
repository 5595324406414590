//! The manufactured transmission problem: a smooth field in the unit square, two opposite forces in the medium around it.

use faer::{Mat, MatRef};
use sprs::CsMat;
use steklov_algebra::Lu;
use steklov_coupling::{Interior, Jumps, Medium, Outline, Transmission};
use steklov_elastic::{Material, Plane};
use steklov_msfem::{Elasticity, Grid, HeterogeneousBody, Loads};
use steklov_quadrature::gauss_legendre;

/// A part of the reference file.
pub fn reference(key: &str) -> serde_json::Value {
    let text = include_str!("../data/transmission.json");
    let all: serde_json::Value = serde_json::from_str(text).unwrap();
    all[key].clone()
}

pub fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[track_caller]
pub fn close(what: &str, value: f64, wanted: f64, tolerance: f64) {
    assert!((value - wanted).abs() <= tolerance * wanted.abs(), "{what}: {value} instead of {wanted}");
}

/// Largest difference over the largest value.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = b.iter().fold(0.0f64, |m, b| m.max(b.abs()));
    a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs())) / largest
}

/// Body and medium of the reference file.
pub const PAIRS: [(&str, [f64; 2], [f64; 2]); 3] =
    [("same", [2.0, 0.3], [2.0, 0.3]), ("stiff_in", [20.0, 0.25], [2.0, 0.3]), ("soft_in", [1.0, 0.35], [50.0, 0.2])];

pub fn material([young, poisson]: [f64; 2]) -> Material {
    Material::new(young, poisson, Plane::Strain).unwrap()
}

/// Stress times normal.
pub fn traction([xx, yy, xy]: [f64; 3], n: [f64; 2]) -> [f64; 2] {
    [xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]]
}

/// u = (sin(x+2y), x²y - y²/2) in the body.
pub fn inner([x, y]: [f64; 2]) -> [f64; 2] {
    [(x + 2.0 * y).sin(), x * x * y - 0.5 * y * y]
}

pub fn inner_gradient([x, y]: [f64; 2]) -> [[f64; 2]; 2] {
    let c = (x + 2.0 * y).cos();
    [[c, 2.0 * c], [2.0 * x * y, x * x - y]]
}

/// -div σ of that.
pub fn body_force(m: &Material, [x, y]: [f64; 2]) -> [f64; 2] {
    let s = (x + 2.0 * y).sin();
    let (mu, lm) = (m.mu(), m.lambda() + m.mu());
    [mu * 5.0 * s - lm * (2.0 * x - s), -mu * (2.0 * y - 1.0) + lm * (2.0 * s + 1.0)]
}

/// Displacement and stress of a force b at p.
fn kelvin(m: &Material, x: [f64; 2], p: [f64; 2], b: [f64; 2]) -> ([f64; 2], [f64; 3]) {
    let nu = m.nu();
    let r = [x[0] - p[0], x[1] - p[1]];
    let r2 = r[0] * r[0] + r[1] * r[1];
    let along = r[0] * b[0] + r[1] * b[1];
    let c = 1.0 / (8.0 * std::f64::consts::PI * m.mu() * (1.0 - nu));
    let u = [0, 1].map(|i| c * (-(3.0 - 4.0 * nu) * 0.5 * r2.ln() * b[i] + r[i] * along / r2));
    let q = -1.0 / (4.0 * std::f64::consts::PI * (1.0 - nu) * r2);
    let stress = [(0, 0), (1, 1), (0, 1)].map(|(i, j)| {
        let trace = if i == j { along } else { 0.0 };
        q * ((1.0 - 2.0 * nu) * (r[i] * b[j] + r[j] * b[i] - trace) + 2.0 * along / r2 * r[i] * r[j])
    });
    (u, stress)
}

/// Two opposite forces in the body: displacement and stress around it.
pub fn outer(m: &Material, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
    let b = [8.0, 5.0];
    let ((u, s), (v, t)) = (kelvin(m, x, [0.12, 0.07], b), kelvin(m, x, [-0.1, -0.05], b));
    ([u[0] - v[0], u[1] - v[1]], [s[0] - t[0], s[1] - t[1], s[2] - t[2]])
}

/// u0 on the interface.
pub fn jump(around: &Material, x: [f64; 2]) -> [f64; 2] {
    let (u, v) = (inner(x), outer(around, x).0);
    [u[0] - v[0], u[1] - v[1]]
}

/// The body of the manufactured problem on n × n cells, with f by 4×4 points a cell and t0.
pub fn manufactured(n: usize, body: [f64; 2], around: [f64; 2]) -> (HeterogeneousBody, Loads) {
    let h = 1.0 / n as f64;
    let grid = Grid::new([-0.5; 2], [h; 2], [n; 2], |_, _| true).unwrap();
    let elasticity = Elasticity::new(body[1], steklov_elastic::Plane::Strain).unwrap();
    let medium = HeterogeneousBody::new(grid, vec![body[0]; n * n], elasticity).unwrap();
    let (body, around) = (material(body), material(around));
    let mut loads = Loads { body: vec![[0.0; 8]; n * n], ..Loads::default() };
    let rule = gauss_legendre(4);
    for cell in 0..n * n {
        let [x, y] = medium.grid.lattice_point(medium.grid.cell(cell));
        for (a, wa) in rule.points.iter().zip(&rule.weights) {
            for (b, wb) in rule.points.iter().zip(&rule.weights) {
                let (s, t) = ((1.0 + a) / 2.0, (1.0 + b) / 2.0);
                let f = body_force(&body, [x + s * h, y + t * h]);
                let shape = [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t];
                for k in 0..8 {
                    loads.body[cell][k] += 0.25 * h * h * wa * wb * shape[k / 2] * f[k % 2];
                }
            }
        }
    }
    let outline = Outline::new(&medium.grid).unwrap();
    outline.add_traction_jump(&medium.grid, &mut loads, |x, n| {
        let (t, c) = (traction(body.stress(inner_gradient(x)), n), traction(outer(&around, x).1, n));
        [t[0] - c[0], t[1] - c[1]]
    });
    (medium, loads)
}

/// Boundary elements between the points of the trace; L as in the reference file.
pub fn around(interior: &Interior, parts: usize, degree: usize, medium: [f64; 2]) -> Medium {
    Medium::new(interior.trace.mesh(parts, degree).unwrap(), material(medium), Some(1.0)).unwrap()
}

/// <C ε(e), ε(e)>^½ of the error in the body by 3×3 points a cell.
pub fn energy_error(medium: &HeterogeneousBody, body: [f64; 2], u: &[f64]) -> f64 {
    let (rule, m, grid) = (gauss_legendre(3), material(body), &medium.grid);
    let mut sum = 0.0;
    for cell in grid.body_cells() {
        let [x, y] = grid.lattice_point(grid.cell(cell));
        let v = medium.cell_values(u, cell);
        for (a, wa) in rule.points.iter().zip(&rule.weights) {
            for (b, wb) in rule.points.iter().zip(&rule.weights) {
                let at = [(1.0 + a) / 2.0, (1.0 + b) / 2.0];
                let exact = m.stress(inner_gradient([x + at[0] * grid.spacing[0], y + at[1] * grid.spacing[1]]));
                let found = medium.elasticity.stress(medium.young[cell], &v, at, grid.spacing);
                let [xx, yy, xy] = [0, 1, 2].map(|k| found[k] - exact[k]);
                // σ : C⁻¹ σ in plane strain
                let density = ((xx * xx + yy * yy + 2.0 * xy * xy) - m.nu() * (xx + yy).powi(2)) / (2.0 * m.mu());
                sum += 0.25 * wa * wb * grid.spacing[0] * grid.spacing[1] * density;
            }
        }
    }
    sum.sqrt()
}

/// ⟨V e, e⟩^½ of the error of the traction to its mean on each element (degree 1).
pub fn traction_error(exterior: &Medium, found: &[f64]) -> f64 {
    let rule = gauss_legendre(8);
    let mut error = found.to_vec();
    for e in 0..exterior.mesh.len() {
        for (&t, w) in rule.points.iter().zip(&rule.weights) {
            let exact = traction(outer(&exterior.material, exterior.mesh.point(e, t)).1, exterior.mesh.normal(e, 0.0));
            (0..2).for_each(|i| error[2 * e + i] -= 0.5 * w * exact[i]);
        }
    }
    let n = error.len();
    let v = &exterior.operators.v;
    (0..n).map(|i| (0..n).map(|j| error[i] * v[(i, j)] * error[j]).sum::<f64>()).sum::<f64>().sqrt()
}

/// X E for a matrix stored by columns.
pub fn dense(e: &CsMat<f64>) -> Mat<f64> {
    let mut full = Mat::zeros(e.rows(), e.cols());
    for (&value, (i, j)) in e {
        full[(i, j)] = value;
    }
    full
}

/// Solves by LU.
pub fn lu(matrix: MatRef<'_, f64>, right: &[f64]) -> Vec<f64> {
    let b = Mat::from_fn(right.len(), 1, |i, _| right[i]);
    Lu::new(matrix).solve(b.as_ref()).col_as_slice(0).to_vec()
}

/// K - ½M and K + ½M.
pub fn double_layers(exterior: &Medium) -> [Mat<f64>; 2] {
    let mass = dense(&exterior.operators.mass);
    [-0.5, 0.5].map(|half| &exterior.operators.k + faer::Scale(half) * &mass)
}

/// The manufactured problem, ready to solve, and its jump of displacements.
pub fn problem<'a>(interior: Interior, exterior: &'a Medium) -> (Transmission<'a>, Vec<f64>) {
    let u0 = exterior.space.interpolate(|x| jump(&exterior.material, x));
    (Transmission::new(interior, exterior).unwrap(), u0)
}

/// The jumps of the manufactured problem.
pub fn with_jumps<T>(body: [f64; 2], around: [f64; 2], halvings: usize, then: impl FnOnce(&Jumps<'_>) -> T) -> T {
    let (body, around) = (material(body), material(around));
    let displacement = |x: [f64; 2]| jump(&around, x);
    let t0 = |x: [f64; 2], n: [f64; 2]| {
        let (t, c) = (traction(body.stress(inner_gradient(x)), n), traction(outer(&around, x).1, n));
        [t[0] - c[0], t[1] - c[1]]
    };
    then(&Jumps { displacement: &displacement, traction: &t0, halvings })
}
