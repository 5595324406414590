//! Particular solutions of forces that are affine in the place.

use crate::common::*;
use proptest::prelude::*;
use steklov_bem_operators::proptest::{material, polygon_and_mesh};
use steklov_bem_operators::{Loop, Mesh, ParticularSolution, Polygon, Space};
use steklov_elastic::{Material, Plane};
use steklov_quadrature::gauss_legendre;

type Matrix = [[f64; 2]; 2];

fn gradient() -> impl Strategy<Value = Matrix> {
    [[-3.0..3.0f64, -3.0..3.0f64], [-3.0..3.0f64, -3.0..3.0f64]]
}

fn times(a: Matrix, x: [f64; 2]) -> [f64; 2] {
    a.map(|row| row[0] * x[0] + row[1] * x[1])
}

/// The derivative of a polynomial of degree 4 along an axis, by differences that are exact for it.
fn derivative<const N: usize>(f: impl Fn([f64; 2]) -> [f64; N], x: [f64; 2], axis: usize, h: f64) -> [f64; N] {
    let at = |k: f64| {
        let mut y = x;
        y[axis] += k * h;
        f(y)
    };
    let [far, near] = [2.0, 1.0].map(|k| (at(k), at(-k)));
    std::array::from_fn(|i| (8.0 * (near.0[i] - near.1[i]) - (far.0[i] - far.1[i])) / (12.0 * h))
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// div σ(u_p) + b = 0 and the gradient is that of u_p, of all matrices B and of their symmetric, skew and spherical parts.
    #[test]
    fn an_affine_force_is_in_equilibrium(
        material in material(),
        force in [-3.0..3.0f64, -3.0..3.0f64],
        [row, other] in gradient(),
        centre in [-2.0..2.0f64, -2.0..2.0f64],
        x in [-2.0..2.0f64, -2.0..2.0f64],
        part in 0..5usize,
    ) {
        let [[a, b], [c, d]] = [row, other];
        let slopes = [[row, other], [[a, b], [b, -a]], [[0.0, -c], [c, 0.0]], [[d, 0.0], [0.0, d]], [[0.0; 2]; 2]][part];
        let particular = ParticularSolution::of_affine_force(force, slopes, centre, &material);
        // the differences are exact: of a step of the size of the field
        let by = |axis| derivative(|x| particular.displacement(x), x, axis, 1.0);
        let (dx, dy) = (by(0), by(1));
        let gradient = particular.gradient(x);
        let size = largest(gradient.as_flattened()).max(largest(&particular.displacement(x))) + 9.0 * 64.0 / material.mu();
        for i in 0..2 {
            for (found, want) in [(dx[i], gradient[i][0]), (dy[i], gradient[i][1])] {
                prop_assert!((found - want).abs() < 1e-13 * size, "{found} {want}");
            }
        }
        let [dx, dy] = [0, 1].map(|axis| derivative(|x| particular.stress(x), x, axis, 1.0));
        let value = times(slopes, [x[0] - centre[0], x[1] - centre[1]]);
        // the stress takes the digits of 1 - 2ν
        let size = 9.0 * 64.0 / (1.0 - 2.0 * material.nu());
        for (found, i) in [(dx[0] + dy[2], 0), (dx[2] + dy[1], 1)] {
            prop_assert!((found + force[i] + value[i]).abs() < 1e-13 * size, "{found} {} {}", force[i], value[i]);
        }
    }

    /// A turned force has the turned displacement and stress.
    #[test]
    fn the_solution_turns_with_the_scene(
        material in material(), force in [-3.0..3.0f64, -3.0..3.0f64], slopes in gradient(),
        x in [-2.0..2.0f64, -2.0..2.0f64], angle in 0.0..6.3f64, mirrored in any::<bool>(),
    ) {
        let ((s, c), m) = (f64::sin_cos(angle), if mirrored { -1.0 } else { 1.0 });
        let turn = [[c, -m * s], [s, m * c]];
        let product = |a: Matrix, b: Matrix| a.map(|row| [0, 1].map(|j| row[0] * b[0][j] + row[1] * b[1][j]));
        let back = [[turn[0][0], turn[1][0]], [turn[0][1], turn[1][1]]];
        let turned = product(product(turn, slopes), back);
        let own = ParticularSolution::of_affine_force(force, slopes, [0.0; 2], &material);
        let other = ParticularSolution::of_affine_force(times(turn, force), turned, [0.0; 2], &material);
        let (u, v) = (times(turn, own.displacement(x)), other.displacement(times(turn, x)));
        let size = 9.0 * 64.0 / material.mu();
        (0..2).for_each(|i| assert!((u[i] - v[i]).abs() < 1e-13 * size, "{u:?} {v:?}"));
        let [n, normal] = [[0.6, 0.8], times(turn, [0.6, 0.8])];
        let (t, r) = (times(turn, own.traction(x, n)), other.traction(times(turn, x), normal));
        let size = 9.0 * 64.0 / (1.0 - 2.0 * material.nu());
        (0..2).for_each(|i| assert!((t[i] - r[i]).abs() < 1e-13 * size, "{t:?} {r:?}"));
    }

    /// Resultant and moment of the tractions are those of the force: ∫ b and ∫ d × b over the body.
    #[test]
    fn the_tractions_balance_the_force(
        (polygon, mesh) in polygon_and_mesh(4), material in material(), slopes in gradient(),
    ) {
        let centre = polygon.centroid();
        let particular = ParticularSolution::of_affine_force([0.0; 2], slopes, centre, &material);
        let space = Space::new(&mesh);
        let load = particular.traction_load(&mesh, &space);
        let size = mesh.diameter().powi(3) * largest(slopes.as_flattened()) / (1.0 - 2.0 * material.nu());
        // the centroid has no first moments
        for i in 0..2 {
            let sum: f64 = load.iter().skip(i).step_by(2).sum();
            prop_assert!(sum.abs() < 1e-12 * size, "{sum:e} of {size:e}");
        }
        // ∫ d × Bd by triangles from the centroid: exact from three points of degree 2
        let mut moment = 0.0;
        for edge in polygon.edges() {
            let [a, b] = [edge.start, edge.end].map(|p| [p[0] - centre[0], p[1] - centre[1]]);
            let area = 0.5 * (a[0] * b[1] - a[1] * b[0]);
            for middle in [[0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])], a.map(|v| 0.5 * v), b.map(|v| 0.5 * v)] {
                let f = times(slopes, middle);
                moment += area / 3.0 * (middle[0] * f[1] - middle[1] * f[0]);
            }
        }
        let r = steklov_elastic::RigidMotion::about(centre, 1.0).nodal(&space.points);
        let found = dot(&load, &r);
        prop_assert!((found + moment).abs() < 1e-12 * size * mesh.diameter(), "{found:e} {moment:e} of {size:e}");
    }

    /// ∫ σ_p n φ and ∫ σ_p n b of the bubbles by quadrature, of degrees 1 to 5: tractions are quadratic.
    #[test]
    fn the_loads_of_an_affine_force_are_integrals(
        (polygon, mesh) in polygon_and_mesh(5), material in material(), force in [-3.0..3.0f64, -3.0..3.0f64],
        slopes in gradient(),
    ) {
        let particular = ParticularSolution::of_affine_force(force, slopes, polygon.centroid(), &material);
        let space = Space::new(&mesh);
        let (mut nodal, mut bubbles) = (vec![0.0; space.dofs()], vec![0.0; 2 * mesh.len()]);
        let rule = gauss_legendre(10);
        for e in 0..mesh.len() {
            let (p, n) = (space.degree(e), mesh.normal(e, 0.0));
            let (mut phi, mut legendre) = (vec![0.0; p + 1], vec![0.0; p + 2]);
            for (&t, w) in rule.points.iter().zip(&rule.weights) {
                space.basis(e).evaluate(t, &mut phi);
                steklov_quadrature::legendre_p(t, &mut legendre);
                let bubble = (legendre[p + 1] - legendre[p - 1]) / (2 * p + 1) as f64;
                let traction = particular.traction(mesh.point(e, t), n).map(|t| w * mesh.length(e) / 2.0 * t);
                for i in 0..2 {
                    bubbles[2 * e + i] += traction[i] * bubble;
                    space.element_nodes(e).zip(&phi).for_each(|(node, phi)| nodal[2 * node + i] += traction[i] * phi);
                }
            }
        }
        let size = mesh.diameter();
        let scale = size.powi(2) * (largest(&force) + size * largest(slopes.as_flattened())) / (1.0 - 2.0 * material.nu());
        for (found, wanted) in [(particular.traction_load(&mesh, &space), nodal), (particular.bubble_load(&mesh, &space), bubbles)] {
            let off = found.iter().zip(&wanted).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            prop_assert!(off < 1e-13 * scale.max(1e-3), "{off:e} of {scale}");
        }
    }

    /// a(u_p, u_p) and ∫ b·u_p against quadrature over a rectangle.
    #[test]
    fn energies_are_the_integrals_over_a_rectangle(
        material in material(), force in [-3.0..3.0f64, -3.0..3.0f64], slopes in gradient(),
        low in [-2.0..2.0f64, -2.0..2.0f64], size in [0.2..3.0f64, 0.2..3.0f64],
    ) {
        let high = [low[0] + size[0], low[1] + size[1]];
        let mesh = Mesh::uniform(&polygon(&[low, [high[0], low[1]], high, [low[0], high[1]]], &[]), 4, 1);
        let centre = [0.3, -0.2];
        let particular = ParticularSolution::of_affine_force(force, slopes, centre, &material);
        let (mut energy, mut work, mut largest) = (0.0, 0.0, 0.0);
        let [along_x, along_y] = [0, 1].map(|k| gauss_legendre(4).mapped(low[k], high[k]));
        for (&x, wx) in along_x.points.iter().zip(&along_x.weights) {
            for (&y, wy) in along_y.points.iter().zip(&along_y.weights) {
                let (g, [xx, yy, xy], u) = (particular.gradient([x, y]), particular.stress([x, y]), particular.displacement([x, y]));
                let b = times(slopes, [x - centre[0], y - centre[1]]);
                energy += wx * wy * (xx * g[0][0] + yy * g[1][1] + xy * (g[0][1] + g[1][0]));
                work += wx * wy * ((force[0] + b[0]) * u[0] + (force[1] + b[1]) * u[1]);
                largest += wx * wy * ((force[0] + b[0]).hypot(force[1] + b[1]) * u[0].hypot(u[1]));
            }
        }
        let (found_energy, found_work) = particular.energies(&mesh);
        // boundary integrals of a rectangle far from the centre cancel
        let scale = 1e4 * (largest + energy);
        prop_assert!((found_work - work).abs() < 1e-13 * scale, "{found_work} {work}");
        prop_assert!((found_energy - energy).abs() < 1e-13 * scale / (1.0 - 2.0 * material.nu()), "{found_energy} {energy}");
    }
}

/// Stress and displacement stay bounded as ν → ½: the displacement of a pressure's gradient vanishes there.
#[test]
fn the_solution_is_bounded_at_the_incompressible_limit() {
    let at = |poisson: f64, slopes: Matrix| {
        let material = Material::new(3.0, poisson, Plane::Strain).expect("material");
        let particular = ParticularSolution::of_affine_force([0.0; 2], slopes, [0.0; 2], &material);
        (largest(&particular.displacement([0.7, -0.4])), largest(&particular.stress([0.7, -0.4])))
    };
    for slopes in [[[1.0, 0.0], [0.0, 1.0]], [[1.0, 0.5], [0.5, -1.0]], [[0.0, -1.0], [1.0, 0.0]]] {
        let (u, stress) = at(0.5 - 1e-7, slopes);
        let skew = slopes[0][1] != slopes[1][0];
        assert!(stress < 1.0, "{slopes:?}: {stress}");
        assert!(if skew { u < 1.0 } else { u < 1e-6 }, "{slopes:?}: {u}");
    }
}

/// A disc under b = x: by symmetry u_p = -r² x/(8M), ∫ b·u_p = -2π R⁶/(48 M), and σ_p n = -R² (3M + λ)/(8M) n.
#[test]
fn a_disc_has_the_closed_form() {
    let material = Material::new(2.0, 0.3, Plane::Strain).expect("material");
    let (lambda, mu, radius) = (material.lambda(), material.mu(), 1.5f64);
    let modulus = lambda + 2.0 * mu;
    let outer = Loop::circle([0.2, -0.1], radius, 4, "rim");
    let disc = Polygon::new(outer, vec![]).expect("disc");
    let particular = ParticularSolution::of_affine_force([0.0; 2], [[1.0, 0.0], [0.0, 1.0]], [0.2, -0.1], &material);
    for degree in [1, 4] {
        let mesh = Mesh::uniform(&disc, 4, degree);
        let (energy, work) = particular.energies(&mesh);
        let want = -std::f64::consts::PI * radius.powi(6) / (24.0 * modulus);
        assert!((work / want - 1.0).abs() < 1e-13, "{work} {want}");
        // a(u, u) = ∮ t·u + ∫ b·u
        let tractions = radius.powi(2) * (3.0 * modulus + lambda) / (8.0 * modulus) * radius.powi(3) / (8.0 * modulus);
        let want = 2.0 * std::f64::consts::PI * radius * tractions + want;
        assert!((energy / want - 1.0).abs() < 1e-13, "{energy} {want}");
    }
}
