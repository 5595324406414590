//! Two bodies tied by mortar rows, against an independent finite element solution.

use faer::Mat;
use faer::prelude::*;
use steklov_algebra::Cholesky;
use steklov_bem_operators::{Domain, Loop, Mesh, Operators, Polygon, Space, Steklov};
use steklov_coupling::{Facing, cells, mortar_rows};
use steklov_elastic::{Material, Plane};
use steklov_quadrature::gauss_legendre;

const SIDES: [&str; 4] = ["bottom", "right", "top", "left"];

struct Body {
    mesh: Mesh,
    space: Space,
    stiffness: Mat<f64>,
}

/// A rectangle with `layers` of elements graded towards its corners, degrees linear in the layer, one of `highest` between.
fn body([low, high]: [[f64; 2]; 2], young: f64, poisson: f64, layers: i32, middle: usize) -> Body {
    let corners = vec![low, [high[0], low[1]], high, [low[0], high[1]]];
    let polygon = Polygon::new(Loop::straight(corners, SIDES.map(String::from).to_vec()), vec![]).unwrap();
    let inwards: Vec<f64> = (1..=layers).rev().map(|k| 0.5 * 0.15f64.powi(k)).collect();
    let even = (1..middle)
        .map(|k| inwards[inwards.len() - 1] * (1.0 - k as f64 / middle as f64) + k as f64 / middle as f64 * 0.5);
    let half: Vec<f64> = inwards.iter().copied().chain(even).collect();
    let mirrored = half.iter().rev().map(|s| 1.0 - s);
    let breaks: Vec<f64> = half.iter().copied().chain([0.5]).chain(mirrored).collect();
    let pieces = breaks.len() + 1;
    let degrees: Vec<usize> = (0..pieces).map(|k| (2 + k.min(pieces - 1 - k)).min(layers as usize + 3)).collect();
    let mesh = Mesh::from_breaks(&polygon, &vec![breaks; 4], &vec![degrees; 4]).unwrap();
    let space = Space::new(&mesh);
    let material = Material::new(young, poisson, Plane::Strain).unwrap();
    let operators = Operators::assemble(&mesh, &space, &material, None).unwrap();
    let stiffness = Steklov::new(operators, Domain::Interior).unwrap().matrix;
    Body { mesh, space, stiffness }
}

impl Body {
    fn side(&self, name: &str) -> Vec<usize> {
        (0..self.mesh.len()).filter(|&e| self.mesh.side_names[self.mesh.side[e]] == name).collect()
    }

    /// ∫ t·φ ds over a side.
    fn load(&self, side: &str, traction: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
        let mut load = vec![0.0; self.space.dofs()];
        for e in self.side(side) {
            let basis = self.space.basis(e);
            let mut phi = vec![0.0; basis.degree + 1];
            let rule = gauss_legendre(basis.degree + 3);
            for (&t, &w) in rule.points.iter().zip(&rule.weights) {
                basis.evaluate(t, &mut phi);
                let value = traction(self.mesh.point(e, t)).map(|v| v * w * self.mesh.speed(e, t));
                for (node, phi) in self.space.element_nodes(e).zip(&phi) {
                    (0..2).for_each(|i| load[2 * node + i] += value[i] * phi);
                }
            }
        }
        load
    }
}

/// J of two bodies, `own` tied to `other` along sides that face each other, the bottom of the lower one held.
fn tied_energy(own: (&Body, &str), other: (&Body, &str), [own_load, other_load]: [Vec<f64>; 2]) -> f64 {
    let (mine, theirs) = (own.0.side(own.1), other.0.side(other.1));
    let moduli = [own, other].map(|of| vec![1.0; of.0.mesh.len()]);
    let (a, b) = (
        Facing { mesh: &own.0.mesh, space: &own.0.space, elements: &mine, modulus: &moduli[0] },
        Facing { mesh: &other.0.mesh, space: &other.0.space, elements: &theirs, modulus: &moduli[1] },
    );
    let rows = mortar_rows(a, b, &cells(a, b, [-1e-9, 1e-9], 0.0));
    let (n, m) = (own.0.space.dofs(), other.0.space.dofs());
    let held = |body: &Body| -> Vec<usize> {
        let lowest = body.mesh.vertices.iter().fold(f64::INFINITY, |l, v| l.min(v[1]));
        if lowest > -0.5 {
            return Vec::new();
        }
        body.side("bottom").into_iter().flat_map(|e| body.space.element_nodes(e).collect::<Vec<_>>()).collect()
    };
    // U = T Z, Z the unknowns that are neither tied nor held
    let tied: Vec<usize> = rows.iter().map(|row| row.node).collect();
    let [own_held, other_held] = [held(own.0), held(other.0)];
    let own_free: Vec<usize> = (0..n / 2).filter(|i| !tied.contains(i) && !own_held.contains(i)).collect();
    let other_free: Vec<usize> = (0..m / 2).filter(|i| !other_held.contains(i)).collect();
    let size = 2 * (own_free.len() + other_free.len());
    let mut t = Mat::<f64>::zeros(n + m, size);
    for i in 0..2 {
        for (k, node) in own_free.iter().enumerate() {
            t[(2 * node + i, 2 * k + i)] = 1.0;
        }
        for (k, node) in other_free.iter().enumerate() {
            t[(n + 2 * node + i, 2 * (own_free.len() + k) + i)] = 1.0;
        }
        for row in &rows {
            for &(node, value) in &row.other {
                if let Ok(k) = other_free.binary_search(&node) {
                    t[(2 * row.node + i, 2 * (own_free.len() + k) + i)] += value;
                }
            }
        }
    }
    let mut s = Mat::<f64>::zeros(n + m, n + m);
    s.submatrix_mut(0, 0, n, n).copy_from(&own.0.stiffness);
    s.submatrix_mut(n, n, m, m).copy_from(&other.0.stiffness);
    let load: Vec<f64> = own_load.into_iter().chain(other_load).collect();
    let f = t.transpose() * Col::from_fn(n + m, |i| load[i]);
    let z = Cholesky::new((t.transpose() * &s * &t).as_ref()).unwrap().solve(f.as_mat());
    -0.5 * (f.transpose() * z.col(0))
}

#[test]
fn tied_blocks_have_the_energy_of_finite_elements() {
    let upper = body([[-0.5, 0.0], [0.5, 1.0]], 1000.0, 0.3, 6, 1);
    for (middle, layers) in [(1, 6), (2, 5)] {
        let lower = body([[-0.5, -1.0], [0.5, 0.0]], 200.0, 0.2, layers, middle);
        let pulled = upper.load("top", |[x, _]| [2.0, -7.0 * (1.0 + x)]);
        let none = vec![0.0; lower.space.dofs()];
        let carried_above = tied_energy((&upper, "bottom"), (&lower, "top"), [pulled.clone(), none.clone()]);
        let carried_below = tied_energy((&lower, "top"), (&upper, "bottom"), [none, pulled]);
        println!("{carried_above} {carried_below}");
        for energy in [carried_above, carried_below] {
            assert!((energy + 0.5647846263).abs() < 1e-8, "{energy}");
        }
    }
}
