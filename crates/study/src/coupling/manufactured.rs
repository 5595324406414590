//! Transmission problems with known solutions: a smooth field in the body, and the field of two opposite forces in the
//! medium around it.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use steklov_bem_operators::{Location, Polygon, distance_to_segment};
use steklov_coupling::{CouplingError, Interior, Medium, Outline};
use steklov_elastic::Material;
use steklov_elastic::plane::{distance, dot, minus};
use steklov_msfem::{Elasticity, Grid, HeterogeneousBody, Loads};
use steklov_quadrature::gauss_legendre;

use super::grids::sides;
use crate::quadratic;

/// Number of steps along each side of the bounding box in the search for the deepest point of a body.
const STEPS: usize = 128;
/// The points where the forces act, from the deepest point, in units of twice its depth.
const POLES: [[f64; 2]; 2] = [[0.12, 0.07], [-0.1, -0.05]];

/// A homogeneous body and the medium around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// Their common name.
    pub name: String,
    /// The body.
    pub body: Material,
    /// The medium.
    pub medium: Material,
    /// The force at the first point, its opposite at the second one, over twice the depth of the body (stress).
    pub force: [f64; 2],
}

/// A pair and its solution on a body.
///
/// With X = (x - c)/D, c the deepest point of the body and D the longer side of its bounding box, the field of the body
/// is u = D (sin(X₁ + 2 X₂), X₁² X₂ - X₂²/2); the field of the medium is that of two opposite forces inside the body,
/// without a resultant. Body force and jumps follow from them.
#[derive(Debug, Clone)]
pub struct Manufactured<'a> {
    /// The materials.
    pub pair: &'a Pair,
    centre: [f64; 2],
    /// D.
    size: f64,
    /// Twice the depth of c.
    depth: f64,
}

/// A manufactured problem on a grid.
pub struct Problem {
    /// The body.
    pub body: HeterogeneousBody,
    /// Its loads.
    pub loads: Loads,
}

/// The deepest point in a polygon, of equally deep points the one nearest to the middle, and its depth.
fn deepest(polygon: &Polygon, low: [f64; 2], size: [f64; 2]) -> ([f64; 2], f64) {
    let mut best = ([f64::NAN; 2], 0.0, f64::NEG_INFINITY);
    for (i, j) in (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| (i, j))) {
        let share = [i, j].map(|k| k as f64 / STEPS as f64);
        let x = [0, 1].map(|k| low[k] + size[k] * share[k]);
        let depth =
            polygon.edges().iter().map(|e| distance_to_segment(x, [e.start, e.end])).fold(f64::INFINITY, f64::min);
        let rank = depth / (size[0] + size[1]) - 1e-6 * (share[0] - 0.5).hypot(share[1] - 0.5);
        if rank > best.2 && polygon.contains(x) == Location::Inside {
            best = (x, depth, rank);
        }
    }
    (best.0, best.1)
}

/// Stress times normal.
fn traction([xx, yy, xy]: [f64; 3], n: [f64; 2]) -> [f64; 2] {
    [xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]]
}

/// Displacement and stress of a force b at p in the whole plane.
fn kelvin(m: &Material, x: [f64; 2], p: [f64; 2], b: [f64; 2]) -> ([f64; 2], [f64; 3]) {
    let nu = m.nu();
    let r = minus(x, p);
    let (squared, along) = (dot(r, r), dot(r, b));
    let c = 1.0 / (8.0 * PI * m.mu() * (1.0 - nu));
    let u = [0, 1].map(|i| c * (-(3.0 - 4.0 * nu) * 0.5 * squared.ln() * b[i] + r[i] * along / squared));
    let q = -1.0 / (4.0 * PI * (1.0 - nu) * squared);
    let stress = [(0, 0), (1, 1), (0, 1)].map(|(i, j)| {
        let trace = if i == j { along } else { 0.0 };
        q * ((1.0 - 2.0 * nu) * (r[i] * b[j] + r[j] * b[i] - trace) + 2.0 * along / squared * r[i] * r[j])
    });
    (u, stress)
}

impl<'a> Manufactured<'a> {
    /// Scales the solution to a body.
    pub fn new(polygon: &Polygon, pair: &'a Pair) -> Self {
        let corner = |f: fn(f64, f64) -> f64, start: f64| {
            [0, 1].map(|k| polygon.edges().iter().map(|e| e.start[k]).fold(start, f))
        };
        let (low, high) = (corner(f64::min, f64::INFINITY), corner(f64::max, f64::NEG_INFINITY));
        let size = [0, 1].map(|k| high[k] - low[k]);
        let (centre, depth) = deepest(polygon, low, size);
        Self { pair, centre, size: size[0].max(size[1]), depth: 2.0 * depth }
    }

    fn scaled(&self, x: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (x[k] - self.centre[k]) / self.size)
    }

    /// Displacement of the body (length).
    pub fn inner(&self, x: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.scaled(x);
        [self.size * (x + 2.0 * y).sin(), self.size * (x * x * y - 0.5 * y * y)]
    }

    fn inner_gradient(&self, x: [f64; 2]) -> [[f64; 2]; 2] {
        let [x, y] = self.scaled(x);
        let c = (x + 2.0 * y).cos();
        [[c, 2.0 * c], [2.0 * x * y, x * x - y]]
    }

    /// Stress of the body.
    pub fn inner_stress(&self, x: [f64; 2]) -> [f64; 3] {
        self.pair.body.stress(self.inner_gradient(x))
    }

    /// f = -div σ (force per area).
    pub fn body_force(&self, x: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.scaled(x);
        let (s, m) = ((x + 2.0 * y).sin(), &self.pair.body);
        let (mu, both) = (m.mu() / self.size, (m.lambda() + m.mu()) / self.size);
        [mu * 5.0 * s - both * (2.0 * x - s), -mu * (2.0 * y - 1.0) + both * (2.0 * s + 1.0)]
    }

    /// Displacement and stress of the medium.
    pub fn outer(&self, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        let pole = |p: [f64; 2]| [0, 1].map(|k| self.centre[k] + self.depth * p[k]);
        let b = self.pair.force.map(|f| f * self.depth);
        let [(u, s), (v, t)] = POLES.map(|p| kelvin(&self.pair.medium, x, pole(p), b));
        (minus(u, v), [s[0] - t[0], s[1] - t[1], s[2] - t[2]])
    }

    /// u0 = u - u_c (length).
    pub fn jump(&self, x: [f64; 2]) -> [f64; 2] {
        let (u, v) = (self.inner(x), self.outer(x).0);
        minus(u, v)
    }

    /// t0 = σ(u)n - σ(u_c)n (stress), n out of the body.
    pub fn traction_jump(&self, x: [f64; 2], n: [f64; 2]) -> [f64; 2] {
        let (t, c) = (traction(self.inner_stress(x), n), traction(self.outer(x).1, n));
        minus(t, c)
    }

    /// The body on a grid, with its loads; sides of holes are loaded by the traction of its field.
    ///
    /// # Errors
    /// The errors of the grid.
    pub fn problem(&self, grid: &Grid) -> Result<Problem, CouplingError> {
        let elasticity = Elasticity::new(self.pair.body.poisson, self.pair.body.plane)?;
        let count = grid.cells[0] * grid.cells[1];
        let body = HeterogeneousBody::new(grid.clone(), vec![self.pair.body.young; count], elasticity)?;
        let mut loads = Loads::default();
        loads.set_body_force(&body, |x| self.body_force(x))?;
        let outline = Outline::new(grid)?;
        outline.add_traction_jump(grid, &mut loads, |x, n| self.traction_jump(x, n));
        let outer: BTreeSet<(usize, usize)> = outline.sides.iter().copied().collect();
        let rule = gauss_legendre(4);
        for (cell, side) in grid.boundary().into_iter().filter(|s| !outer.contains(s)) {
            let ([a, b], n) = sides(grid, cell, side);
            let length = distance(b, a);
            let mut moments = [[0.0; 2]; 2];
            for (&t, w) in rule.points.iter().zip(&rule.weights) {
                let s = (1.0 + t) / 2.0;
                let value = traction(self.inner_stress([0, 1].map(|k| a[k] + s * (b[k] - a[k]))), n);
                for i in 0..2 {
                    moments[0][i] += 0.5 * length * w * (1.0 - s) * value[i];
                    moments[1][i] += 0.5 * length * w * s * value[i];
                }
            }
            loads.add_side(cell, side, moments);
        }
        Ok(Problem { body, loads })
    }

    /// Boundary elements of degree 1 between the nodes of the boundary; L is the size of the body.
    ///
    /// # Errors
    /// The errors of the boundary elements.
    pub fn exterior(&self, interior: &Interior) -> Result<Medium, CouplingError> {
        Medium::new(interior.trace.mesh(1, 1)?, self.pair.medium, Some(self.size))
    }

    /// ⟨C ε(e), ε(e)⟩^½ of the error in the body and of the field itself, by 3 × 3 points per cell ((force
    /// length/thickness)^½).
    pub fn energy_error(&self, body: &HeterogeneousBody, u: &[f64]) -> [f64; 2] {
        let (rule, m, grid) = (gauss_legendre(3), &self.pair.body, &body.grid);
        // σ : C⁻¹ σ, in equivalent plane strain
        let density = |[xx, yy, xy]: [f64; 3]| {
            ((xx * xx + yy * yy + 2.0 * xy * xy) - m.nu() * (xx + yy).powi(2)) / (2.0 * m.mu())
        };
        let mut sums = [0.0; 2];
        for cell in grid.body_cells() {
            let [x, y] = grid.lattice_point(grid.cell(cell));
            let v = body.cell_values(u, cell);
            for (a, wa) in rule.points.iter().zip(&rule.weights) {
                for (b, wb) in rule.points.iter().zip(&rule.weights) {
                    let at = [(1.0 + a) / 2.0, (1.0 + b) / 2.0];
                    let exact = self.inner_stress([x + at[0] * grid.spacing[0], y + at[1] * grid.spacing[1]]);
                    let found = body.elasticity.stress(body.young[cell], &v, at, grid.spacing);
                    let weight = 0.25 * wa * wb * grid.spacing[0] * grid.spacing[1];
                    sums[0] += weight * density([0, 1, 2].map(|k| found[k] - exact[k]));
                    sums[1] += weight * density(exact);
                }
            }
        }
        sums.map(f64::sqrt)
    }

    /// ⟨V e, e⟩^½ of the error of the medium's traction against its mean on each element ((force length/thickness)^½).
    pub fn traction_error(&self, exterior: &Medium, found: &[f64]) -> f64 {
        let (rule, mesh) = (gauss_legendre(8), &exterior.mesh);
        let mut error = found.to_vec();
        for e in 0..mesh.len() {
            for (&t, w) in rule.points.iter().zip(&rule.weights) {
                let exact = traction(self.outer(mesh.point(e, t)).1, mesh.normal(e, t));
                (0..2).for_each(|i| error[2 * e + i] -= 0.5 * w * exact[i]);
            }
        }
        quadratic(&exterior.operators.v, &error).max(0.0).sqrt()
    }
}
