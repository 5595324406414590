//! Condensation against full solutions, bodies without supports, and the particular solution of a body force.

use crate::common::*;
use faer::{Col, Mat};
use proptest::prelude::*;
use steklov_algebra::{Cholesky, Lu};
use steklov_bem_operators::proptest::{material, mesh, polygon_and_mesh};
use steklov_bem_operators::{Condensation, Domain, Mesh, Operators, ParticularSolution, Partition, Space, Steklov};
use steklov_elastic::{Plane, RigidMotion};

/// A random symmetric positive definite matrix AᵀA + n I from proptest's numbers.
fn spd(n: usize, values: &[f64]) -> Mat<f64> {
    let a = Mat::from_fn(n, n, |i, j| values[(i * n + j) % values.len()]);
    a.transpose() * &a + Mat::<f64>::identity(n, n) * n as f64
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn condensed_solution_equals_the_full_one(
        values in proptest::collection::vec(-1.0..1.0f64, 997),
        roles in proptest::collection::vec(0..4usize, 12),
        angle in 0.0..6.3f64,
    ) {
        // roles of the unknowns: 0, 1 eliminated, 2 kept, 3 held; node 0 is turned by an angle and all kept
        let n = 2 * roles.len();
        let s = spd(n, &values);
        let f: Vec<f64> = values[..n].to_vec();
        let (c, si) = (angle.cos(), angle.sin());
        let mut partition = Partition { frames: vec![(0, [[c, si], [-si, c]])], ..Default::default() };
        partition.kept.extend([1, 0]);
        for dof in 2..n {
            match roles[dof / 2] {
                2 => partition.kept.push(dof),
                3 => partition.held.push((dof, values[dof + 40])),
                _ => {}
            }
        }
        let condensation = Condensation::new(s.clone(), &partition, &[]).expect("condensation");
        let load = condensation.load(&f);
        let kept = Mat::from_fn(load.kept.len(), 1, |i, _| load.kept[i]);
        let stiffness = condensation.stiffness().expect("no fault");
        prop_assert_eq!(&stiffness, &stiffness.transpose().to_owned());
        let v = Cholesky::new(stiffness.as_ref()).expect("positive definite").solve(kept.as_ref());
        let u = condensation.expand(&load, v.col_as_slice(0));
        // S u = f at every unknown that is not held, u = value where it is held
        let residual = product(&s, &u);
        let product = condensation.multiply(&u);
        let scale = max_abs(&residual) + 1.0;
        for dof in 0..n {
            prop_assert!((product[dof] - residual[dof]).abs() < 1e-12 * scale);
            match partition.held.iter().find(|h| h.0 == dof) {
                Some(h) => prop_assert!((u[dof] - h.1).abs() < 1e-14),
                None => prop_assert!((residual[dof] - f[dof]).abs() < 1e-11 * scale, "{dof}"),
            }
        }
        // the kept unknowns of node 0 are its components along the turned directions
        prop_assert!((v[(0, 0)] - (-si * u[0] + c * u[1])).abs() < 1e-12);
        prop_assert!((v[(1, 0)] - (c * u[0] + si * u[1])).abs() < 1e-12);
    }

    #[test]
    fn floating_body_is_solved_up_to_rigid_motions((_, mesh) in polygon_and_mesh(4), material in material()) {
        // tractions of a uniform stress are balanced; the solution is the linear field less its rigid part
        let space = Space::new(&mesh);
        let operators = Operators::assemble(&mesh, &space, &material, None).expect("operators");
        let s = Steklov::new(operators, Domain::Interior).expect("S").matrix;
        let field = Field::new("linear", &material);
        let exact = space.interpolate(|x| field.displacement(x));
        let f = product(&s, &exact);
        let motions = [RigidMotion::along([1.0, 0.0]), RigidMotion::along([0.0, 1.0]), RigidMotion::about([0.0, 0.0], 1.0)];
        let motions = motions.map(|m| m.nodal(&space.points)).to_vec();
        prop_assert!(Condensation::new(s.clone(), &Partition::default(), &[]).is_err());
        let condensation = Condensation::new(s.clone(), &Partition::default(), &motions).expect("condensation");
        let u = condensation.expand(&condensation.load(&f), &[]);
        let got = product(&s, &u);
        let error = got.iter().zip(&f).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        prop_assert!(error < 1e-10 * max_abs(&f), "{error:e} {:e}", max_abs(&f));
        for r in &motions {
            prop_assert!(dot(&u, r).abs() < 1e-8 * dot(&u, &u).sqrt() * dot(r, r).sqrt());
        }
    }

    #[test]
    fn body_force_is_in_equilibrium_with_its_particular_solution(
        (polygon, mesh) in polygon_and_mesh(3),
        material in material(),
        force in [-3.0..3.0f64, -3.0..3.0f64],
    ) {
        let centre = polygon.centroid();
        let particular = ParticularSolution::of_body_force(force, centre, &material);
        let space = Space::new(&mesh);
        // resultant: ∮ σ_p n = ∫ div σ_p = -b·area
        let load = particular.traction_load(&mesh, &space);
        for i in 0..2 {
            let sum: f64 = load.iter().skip(i).step_by(2).sum();
            prop_assert!((sum + force[i] * polygon.area()).abs() < 1e-11 * polygon.area() * (force[0].hypot(force[1])));
        }
        // moment about the centroid vanishes
        let r = RigidMotion::about(centre, 1.0).nodal(&space.points);
        prop_assert!(dot(&load, &r).abs() < 1e-10 * polygon.area() * force[0].hypot(force[1]) * mesh.diameter());
        // a(u_p, u_p) is positive and the gradient is that of the displacement
        let (energy, _) = particular.energies(&mesh);
        prop_assert!(energy > 0.0);
        let (x, h) = (mesh.vertices[0], 1e-4 * mesh.diameter());
        let g = particular.gradient(x);
        for (axis, step) in [[h, 0.0], [0.0, h]].into_iter().enumerate() {
            let ahead = particular.displacement([x[0] + step[0], x[1] + step[1]]);
            let behind = particular.displacement([x[0] - step[0], x[1] - step[1]]);
            for i in 0..2 {
                let slope = (ahead[i] - behind[i]) / (2.0 * h);
                prop_assert!((slope - g[i][axis]).abs() < 1e-8 * (g[i][axis].abs() + ahead[i].abs() / h));
            }
        }
    }

    /// ∫ σ_p n φ and ∫ σ_p n b of the bubbles by quadrature, element by element, of degrees 1 to 4.
    #[test]
    fn the_loads_of_a_particular_solution_are_integrals(
        (polygon, mesh) in polygon_and_mesh(4), material in material(), force in [-3.0..3.0f64, -3.0..3.0f64],
    ) {
        let particular = ParticularSolution::of_body_force(force, polygon.centroid(), &material);
        let space = Space::new(&mesh);
        let chosen = |e: usize, i: usize| (e + i).is_multiple_of(2);
        let (mut nodal, mut bubbles) = (vec![0.0; space.dofs()], vec![0.0; 2 * mesh.len()]);
        let rule = steklov_quadrature::gauss_legendre(8);
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
                    for (node, phi) in space.element_nodes(e).zip(&phi).filter(|_| chosen(e, i)) {
                        nodal[2 * node + i] += traction[i] * phi;
                    }
                }
            }
        }
        let scale = force[0].hypot(force[1]) * mesh.diameter().powi(2) / (1.0 - 2.0 * material.nu());
        for (found, wanted) in [
            (particular.traction_load_of(&mesh, &space, chosen), nodal),
            (particular.bubble_load(&mesh, &space), bubbles),
        ] {
            let off = found.iter().zip(&wanted).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            prop_assert!(off < 1e-13 * scale.max(1e-3), "{off:e} of {scale}");
        }
    }

    /// A uniform stress and its displacement: Hooke's law back, and nothing to balance on a closed boundary.
    #[test]
    fn a_uniform_stress_is_its_own_particular_solution(
        (polygon, mesh) in polygon_and_mesh(3), material in material(), stress in [-3.0..3.0f64, -3.0..3.0f64, -3.0..3.0f64],
    ) {
        let particular = ParticularSolution::of_uniform_stress(stress, polygon.centroid(), &material);
        let (space, size) = (Space::new(&mesh), mesh.diameter());
        prop_assert_eq!(particular.displacement(polygon.centroid()), [0.0; 2]);
        let (a, b) = (mesh.vertices[0], mesh.vertices[1]);
        let g = particular.gradient(a);
        let [u, v] = [a, b].map(|x| particular.displacement(x));
        let largest = g.as_flattened().iter().fold(0.0, |m: f64, g| m.max(g.abs()));
        for i in 0..2 {
            let step = g[i][0] * (b[0] - a[0]) + g[i][1] * (b[1] - a[1]);
            prop_assert!((v[i] - u[i] - step).abs() < 1e-12 * largest * size);
        }
        // Hooke's law takes the digits of 1 - 2ν
        let scale = material.young * largest / (1.0 - 2.0 * material.nu());
        for (found, want) in particular.stress(b).into_iter().zip(stress) {
            prop_assert!((found - want).abs() < 1e-13 * scale.max(1.0), "{} {}", found, want);
        }
        let load = particular.traction_load(&mesh, &space);
        let motions = [RigidMotion::along([1.0, 0.0]), RigidMotion::along([0.0, 1.0]), RigidMotion::about(a, 1.0 / size)];
        for motion in motions {
            let work = dot(&load, &motion.nodal(&space.points));
            prop_assert!(work.abs() < 1e-12 * scale.max(10.0) * size, "{motion}: {work}");
        }
        // the displacement of a body under the tractions of the stress is the particular one
        let operators = Operators::assemble(&mesh, &space, &material, None).expect("operators");
        let matrix = Steklov::new(operators, Domain::Interior).expect("S").matrix;
        let force = product(&matrix, &space.interpolate(|x| particular.displacement(x)));
        let error = force.iter().zip(&load).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        prop_assert!(error < 1e-9 * scale.max(10.0) * size, "{error:e}");
    }
}

#[test]
fn body_force_energies_of_a_unit_square_are_those_of_the_integrals() {
    // b = (0,-1), x_0 = 0, square [-1/2,1/2]²: u_y = y²/(2M), ∫b·u = -∫y²/(2M) = -1/(24 M), a = ∫ M (y/M)² = 1/(12 M)
    let material = steklov_elastic::Material::new(2.0, 0.3, Plane::Stress).expect("material");
    let mesh = Mesh::uniform(&polygon(&SQUARE, &[]), 4, 1);
    let modulus = material.lambda() + 2.0 * material.mu();
    let (energy, work) = ParticularSolution::of_body_force([0.0, -1.0], [0.0, 0.0], &material).energies(&mesh);
    assert!((energy * 12.0 * modulus - 1.0).abs() < 1e-14, "{energy}");
    assert!((work * -24.0 * modulus - 1.0).abs() < 1e-14, "{work}");
}

#[test]
fn a_held_quarter_reproduces_a_linear_field() {
    // mixed data by component: u_x held on the left, u_y at the bottom, inhomogeneous; tractions elsewhere
    let material = Gold::read().material();
    let field = Field::new("linear", &material);
    for p in [1, 3] {
        let mesh = Mesh::uniform(&polygon(&SQUARE, &[]), 12, p);
        let space = Space::new(&mesh);
        let operators = Operators::assemble(&mesh, &space, &material, None).expect("operators");
        let s = Steklov::new(operators, Domain::Interior).expect("S").matrix;
        let exact = space.interpolate(|x| field.displacement(x));
        let f = product(&s, &exact);
        let mut partition = Partition::default();
        for (node, x) in space.points.iter().enumerate() {
            for (i, on) in [(0, x[0] == -0.5), (1, x[1] == -0.5)] {
                if on {
                    partition.held.push((2 * node + i, exact[2 * node + i]));
                }
            }
        }
        let condensation = Condensation::new(s, &partition, &[]).expect("condensation");
        // one rotation is left free by nothing: x and y are held on two sides
        let u = condensation.expand(&condensation.load(&f), &[]);
        let error = u.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-12 * max_abs(&exact), "p = {p}: {error:e}");
    }
}

#[test]
fn held_meshes_of_random_bodies_are_not_singular() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    for _ in 0..10 {
        let mesh = mesh(3).new_tree(&mut runner).expect("a mesh").current();
        let material = material().new_tree(&mut runner).expect("a material").current();
        let space = Space::new(&mesh);
        let operators = Operators::assemble(&mesh, &space, &material, None).expect("operators");
        let s = Steklov::new(operators, Domain::Interior).expect("S").matrix;
        let (a, b) = (space.node(0, 0), space.node(0, space.degree(0)));
        // two points hold all rigid motions, one point does not
        let hold = |nodes: &[usize]| Partition {
            held: nodes.iter().flat_map(|n| [(2 * n, 0.0), (2 * n + 1, 0.0)]).collect(),
            ..Default::default()
        };
        assert!(Condensation::new(s.clone(), &hold(&[a, b]), &[]).is_ok());
        assert!(Condensation::new(s, &hold(&[a]), &[]).is_err());
    }
}

#[test]
fn several_panels_of_columns_multiply_and_expand_like_the_full_matrix() {
    // 702 unknowns: the factorisation of the eliminated ones goes over three panels of 256 columns
    let mesh = Mesh::uniform(&polygon(&L_SHAPE, &[&[[0.2, 0.1], [0.3, 0.1], [0.25, 0.3]]]), 117, 3);
    let space = Space::new(&mesh);
    let n = space.dofs();
    assert_eq!(n, 702);
    let operators = Operators::assemble(&mesh, &space, &Gold::read().material(), None).expect("operators");
    let s = Steklov::new(operators, Domain::Interior).expect("S").matrix;
    // held, kept, turned and eliminated nodes all over the numbering
    let mut partition = Partition::default();
    for node in 0..n / 2 {
        let (si, c) = (node as f64).sin_cos();
        match node % 9 {
            0 => partition.held.push((2 * node + node / 9 % 2, 0.1 * c)),
            1 => {
                partition.frames.push((node, [[c, si], [-si, c]]));
                partition.kept.extend([2 * node + 1, 2 * node]);
            }
            _ => {}
        }
    }
    let eliminated = n - partition.held.len() - partition.kept.len();
    assert!(eliminated > 512, "{eliminated}");
    let f: Vec<f64> = (0..n).map(|i| (0.7 * i as f64).sin()).collect();
    let condensation = Condensation::new(s.clone(), &partition, &[]).expect("condensation");
    let load = condensation.load(&f);
    let kept = Mat::from_fn(load.kept.len(), 1, |i, _| load.kept[i]);
    let stiffness = condensation.stiffness().expect("no fault");
    let v = Cholesky::new(stiffness.as_ref()).expect("positive definite").solve(kept.as_ref());
    let u = condensation.expand(&load, v.col_as_slice(0));

    // the full system without the held unknowns, by another factorisation
    let held: std::collections::BTreeMap<usize, f64> = partition.held.iter().copied().collect();
    let free: Vec<usize> = (0..n).filter(|dof| !held.contains_key(dof)).collect();
    let matrix = Mat::from_fn(free.len(), free.len(), |i, j| s[(free[i], free[j])]);
    let right = Col::from_fn(free.len(), |i| f[free[i]] - held.iter().map(|(&h, v)| s[(free[i], h)] * v).sum::<f64>());
    let want = Lu::new(matrix.as_ref()).solve(right.as_mat());
    let scale = max_abs(&u);
    let error = (0..free.len()).map(|i| (u[free[i]] - want[(i, 0)]).abs()).fold(0.0, f64::max) / scale;
    println!("expand {error:e}");
    assert!(error < 1e-10, "{error:e}");
    assert!(held.iter().all(|(&h, v)| (u[h] - v).abs() < 1e-15));

    let (got, want) = (condensation.multiply(&u), product(&s, &u));
    let error = got.iter().zip(&want).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / (s.norm_max() * scale);
    println!("multiply {error:e}");
    assert!(error < 1e-13, "{error:e}");
}
