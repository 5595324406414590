//! Both Calderón identities for fields of point forces, on random bodies with holes, inside and outside.
//!
//! The force stands where the body is not: outside of the outer loop, in a hole, or inside for the exterior problem.

use crate::common::{Field, dot, max_abs, polygon, product};
use faer::Mat;
use proptest::prelude::*;
use steklov_bem_operators::proptest::{material, polygon as bodies};
use steklov_bem_operators::{Domain, Location, Mesh, Operators, Polygon, Space, Steklov};
use steklov_elastic::Material;

/// Place of the force of `Field::new("kelvin", …)`, and the force.
const SOURCE: [f64; 2] = [0.9, 0.35];
const FORCE: [f64; 2] = [1.0, 0.5];

/// The Kelvin field of a force at `source`: G F with L, moved from the place where `Field` has it.
struct PointForce {
    field: Field,
    shift: [f64; 2],
    constant: f64,
}

impl PointForce {
    fn new(material: &Material, source: [f64; 2], length: f64) -> Self {
        let c_v = 1.0 / (8.0 * std::f64::consts::PI * material.mu() * (1.0 - material.nu()));
        Self {
            field: Field::new("kelvin", material),
            shift: [source[0] - SOURCE[0], source[1] - SOURCE[1]],
            // the potentials give -κ log r F + r⊗r F/r² - F/2, times c_V
            constant: c_v * (material.kappa() * length.ln() + 0.5),
        }
    }

    fn at(&self, x: [f64; 2]) -> [f64; 2] {
        [x[0] - self.shift[0], x[1] - self.shift[1]]
    }

    fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
        let u = self.field.displacement(self.at(x));
        [u[0] + self.constant * FORCE[0], u[1] + self.constant * FORCE[1]]
    }

    /// Legendre coefficients of the traction, by 60 Gauss points an element.
    fn traction(&self, mesh: &Mesh, space: &Space) -> Vec<f64> {
        let rule = steklov_quadrature::gauss_legendre(60);
        let mut t = vec![0.0; space.dofs()];
        for e in 0..mesh.len() {
            let mut legendre = vec![0.0; space.degree(e)];
            for (&s, &w) in rule.points.iter().zip(&rule.weights) {
                steklov_quadrature::legendre_p(s, &mut legendre);
                let value = self.field.traction(self.at(mesh.point(e, s)), mesh.normal(e, 0.0));
                for (m, p) in legendre.iter().enumerate() {
                    for i in 0..2 {
                        t[2 * (space.offset[e] + m) + i] += w * (m as f64 + 0.5) * p * value[i];
                    }
                }
            }
        }
        t
    }
}

/// Elements of one degree, halved until none is longer than two thirds of the distance of its middle from the source.
fn mesh_around(polygon: &Polygon, source: [f64; 2], p: usize) -> Mesh {
    let mut mesh = Mesh::uniform(polygon, polygon.edges().len() + 6, p);
    loop {
        let far = |e: usize| {
            let y = mesh.point(e, 0.0);
            1.5 * mesh.length(e) <= (y[0] - source[0]).hypot(y[1] - source[1])
        };
        let marked: Vec<bool> = (0..mesh.len()).map(|e| !far(e)).collect();
        if marked.iter().all(|m| !m) {
            return mesh;
        }
        mesh = mesh.bisected(&marked).0;
    }
}

/// Residuals of both lines relative to their largest term: V t = (K ± ½) u and W u = (±½ - K') t, upper sign inside.
fn residuals(mesh: &Mesh, material: &Material, force: &PointForce, length: f64, domain: Domain) -> [f64; 2] {
    let space = Space::new(mesh);
    let operators = Operators::assemble(mesh, &space, material, Some(length)).expect("operators");
    let u = space.interpolate(|x| force.displacement(x));
    let t = force.traction(mesh, &space);
    let mut half = Mat::<f64>::zeros(space.dofs(), space.dofs());
    let sign = if domain == Domain::Interior { 0.5 } else { -0.5 };
    for (&value, (row, column)) in &operators.mass {
        half[(row, column)] = sign * value;
    }
    let relative = |left: Vec<f64>, right: Vec<f64>| {
        let difference: Vec<f64> = left.iter().zip(&right).map(|(l, r)| l - r).collect();
        max_abs(&difference) / max_abs(&left).max(max_abs(&right))
    };
    let first = relative(product(&operators.v, &t), product(&(&operators.k + &half), &u));
    let adjoint = (&half - &operators.k).transpose().to_owned();
    [first, relative(product(&operators.w, &u), product(&adjoint, &t))]
}

/// A point where the body is not: the middle of a hole's corners, or a point outside at a distance of the body's size.
fn outside(polygon: &Polygon, hole: bool, angle: f64) -> Option<[f64; 2]> {
    let source = match polygon.loops() {
        [_, hole_edges, ..] if hole => {
            let corners: Vec<[f64; 2]> = polygon.edges()[hole_edges.clone()].iter().map(|e| e.start).collect();
            [0, 1].map(|i| corners.iter().map(|x| x[i]).sum::<f64>() / corners.len() as f64)
        }
        _ => {
            let (c, d) = (polygon.centroid(), polygon.diameter());
            [c[0] + 0.8 * d * angle.cos(), c[1] + 0.8 * d * angle.sin()]
        }
    };
    (polygon.contains(source) == Location::Outside && gap(polygon, source) > 0.02 * polygon.diameter())
        .then_some(source)
}

/// Distance of a point from the boundary, from 64 points an edge.
fn gap(polygon: &Polygon, x: [f64; 2]) -> f64 {
    let points = polygon.edges().iter().flat_map(|e| (0..=64).map(|k| e.point(f64::from(k) / 64.0)));
    points.map(|y| (y[0] - x[0]).hypot(y[1] - x[1])).fold(f64::INFINITY, f64::min)
}

/// Residuals at p = 2, 6, 10 fall exponentially, line by line.
fn exponential(errors: [[f64; 2]; 3]) -> bool {
    (0..2).all(|line| {
        let [a, b, c] = errors.map(|e| e[line]);
        b < 0.1 * a && c < 0.1 * b.max(1e-9) && c < 1e-5
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// The force is outside, so the fields do not depend on L: neither does the residual.
    #[test]
    fn interior_identities(
        body in bodies(),
        material in material(),
        hole in any::<bool>(),
        angle in 0.0..6.3f64,
        length in 0.3..5.0f64,
    ) {
        let Some(source) = outside(&body, hole, angle) else {
            return Err(TestCaseError::reject("the source is too close"));
        };
        let force = PointForce::new(&material, source, 1.0);
        let length = length * body.diameter();
        let errors = [2, 6, 10]
            .map(|p| residuals(&mesh_around(&body, source, p), &material, &force, length, Domain::Interior));
        prop_assert!(exponential(errors), "{errors:?}");
    }

    /// The force is inside and is felt at infinity: only the field of the operators' own L satisfies the first line.
    #[test]
    fn exterior_identities(body in bodies(), material in material(), length in 0.3..5.0f64) {
        // without its holes; a source in the middle of the outer loop
        let corners: Vec<[f64; 2]> = body.edges()[body.loops()[0].clone()].iter().map(|e| e.start).collect();
        let body = polygon(&corners, &[]);
        let source = body.centroid();
        prop_assume!(body.contains(source) == Location::Inside && gap(&body, source) > 0.02 * body.diameter());
        let length = length * body.diameter();
        let force = PointForce::new(&material, source, length);
        let meshes = [2, 6, 10].map(|p| mesh_around(&body, source, p));
        let errors = meshes.each_ref().map(|mesh| residuals(mesh, &material, &force, length, Domain::Exterior));
        prop_assert!(exponential(errors), "{errors:?}");
        let [first, second] = residuals(&meshes[2], &material, &force, 1.5 * length, Domain::Exterior);
        prop_assert!(first > 1e-3 && second < 1e-5, "{first:e} {second:e}");
    }
}

#[test]
fn energies_converge_exponentially_in_the_degree() {
    // a force in the hole of a square: <S u,u> = ∫ t·u, the integral by Gauss points of the exact field
    let material = Material::new(2.5, 0.3, steklov_elastic::Plane::Strain).expect("material");
    let hole = [[-0.2, -0.1], [0.2, -0.15], [0.1, 0.2]];
    let body = polygon(&crate::common::SQUARE, &[&hole]);
    let source = [0.03, -0.02];
    let force = PointForce::new(&material, source, 1.0);
    let energy = |p: usize| {
        let mesh = mesh_around(&body, source, p);
        let space = Space::new(&mesh);
        let operators = Operators::assemble(&mesh, &space, &material, None).expect("operators");
        let steklov = Steklov::new(operators, Domain::Interior).expect("S");
        let u = space.interpolate(|x| force.displacement(x));
        let rule = steklov_quadrature::gauss_legendre(60);
        let mut exact = 0.0;
        for e in 0..mesh.len() {
            for (&s, &w) in rule.points.iter().zip(&rule.weights) {
                let x = mesh.point(e, s);
                let (t, v) = (force.field.traction(force.at(x), mesh.normal(e, 0.0)), force.displacement(x));
                exact += w * mesh.length(e) / 2.0 * (t[0] * v[0] + t[1] * v[1]);
            }
        }
        (dot(&u, &product(&steklov.matrix, &u)) / exact - 1.0).abs()
    };
    let errors: Vec<f64> = [2, 4, 6, 8, 10, 12].into_iter().map(energy).collect();
    println!("{errors:?}");
    assert!(errors.windows(2).all(|e| e[1] < 0.2 * e[0] || e[1] < 1e-11), "{errors:?}");
    assert!(errors[5] < 1e-9 && errors[0] > 1e-5, "{errors:?}");
}
