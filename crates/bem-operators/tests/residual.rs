//! Residual indicators: zero, closed forms, units, rates.

use crate::common::*;
use proptest::prelude::*;
use steklov_bem_operators::proptest::{material, mesh};
use steklov_bem_operators::{
    BemError, BoundaryField, BoundaryResidual, Condensation, Datum, Domain, Look, Mesh, Operators, Partition, Site,
    Space, Steklov, add_load, boundary_residuals, boundary_residuals_of, residual_panels, side_moments,
};
use steklov_elastic::{Material, Plane};

/// Field of a nodal displacement with the traction that the operators give to it.
fn with_traction(mesh: &Mesh, space: &Space, material: &Material, displacement: &[f64]) -> BoundaryField {
    let operators = Operators::assemble(mesh, space, material, None).expect("operators");
    let length = operators.length;
    let traction = Steklov::new(operators, Domain::Interior).expect("S").traction.apply(displacement);
    BoundaryField::new(mesh, space, material, displacement, &traction, length)
}

fn sum(residuals: &[BoundaryResidual]) -> f64 {
    residuals.iter().map(BoundaryResidual::total).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn linear_fields_and_rigid_motions_leave_nothing(mesh in mesh(4), material in material()) {
        let (space, field) = (Space::new(&mesh), Field::new("linear", &material));
        let size = mesh.diameter();
        let stress = max_abs(&field.stress([0.0, 0.0]));
        let linear = with_traction(&mesh, &space, &material, &space.interpolate(|x| field.displacement(x)));
        let given = |x: &Site| field.traction(x.point, mesh.normal(x.element, x.t)).map(Some);
        let left = sum(&boundary_residuals(&mesh, &linear, &given).expect("finite"));
        prop_assert!(left < 1e-16 * (stress * size).powi(2) / material.young, "{left:e}");
        let turned = space.interpolate(|[x, y]| [1e-3 * (size - y), 1e-3 * (x + size)]);
        let rigid = with_traction(&mesh, &space, &material, &turned);
        let left = sum(&boundary_residuals(&mesh, &rigid, &|_| [Some(0.0); 2]).expect("finite"));
        prop_assert!(left < 1e-16 * material.lambda().abs().max(material.mu()).powi(2) / material.young * size * size, "{left:e}");
    }

    /// Lengths times a, stresses times b: energies per thickness times b a².
    #[test]
    fn another_unit_changes_no_ratio(mesh in mesh(3), a in 1e-3..1e3f64, b in 1e-6..1e6f64, poisson in -0.5..0.45f64) {
        let of = |mesh: &Mesh, size: f64, stress: f64| {
            let material = Material::new(stress, poisson, Plane::Strain).expect("valid");
            let space = Space::new(mesh);
            let u = space.interpolate(|[x, y]| [(x / size).sin() * y, (y / size).cos() * x]);
            let field = with_traction(mesh, &space, &material, &u);
            boundary_residuals(mesh, &field, &|x: &Site| [Some(stress * x.point[0] / size), None]).expect("finite")
        };
        let unit = mesh.diameter();
        let mut scaled = mesh.clone();
        scaled.vertices.iter_mut().for_each(|v| *v = v.map(|x| a * x));
        let (one, other) = (of(&mesh, unit, 1.0), of(&scaled, a * unit, b));
        let factor = b * a * a;
        for (x, y) in one.iter().zip(&other) {
            prop_assert!((y.neumann / factor / x.neumann - 1.0).abs() < 1e-6, "{x:?} {y:?}");
            prop_assert!((y.equation / factor / x.equation - 1.0).abs() < 1e-6, "{x:?} {y:?}");
        }
    }
}

/// A linear field whose traction is prescribed with an error of s and 2: ∫ (s² + 4) ds on each side of unit length.
#[test]
fn a_wrong_traction_counts_by_its_components() {
    let material = Material::new(3.0, 0.3, Plane::Strain).expect("valid");
    let mesh = Mesh::uniform(&polygon(&SQUARE, &[]), 4, 2);
    let (space, exact) = (Space::new(&mesh), Field::new("linear", &material));
    let field = with_traction(&mesh, &space, &material, &space.interpolate(|x| exact.displacement(x)));
    let t = |x: &Site| exact.traction(x.point, mesh.normal(x.element, x.t));
    let got = boundary_residuals(&mesh, &field, &|x| match x.element {
        0 => [Some(t(x)[0] + x.s), Some(t(x)[1] - 2.0)],
        1 => [Some(t(x)[0] + x.s), None],
        2 => [None, Some(t(x)[1] - 2.0)],
        _ => [None, None],
    });
    let want = [1.0 / 3.0 + 4.0, 1.0 / 3.0, 4.0, 0.0];
    for (got, want) in got.expect("finite").iter().zip(want) {
        assert!((got.neumann - want / (2.0 * 3.0)).abs() < 1e-12 && got.equation < 1e-24, "{got:?} {want}");
    }
}

/// A constant traction c on one element alone: on it w' = c_V κ c log((1+t)/(1-t)), whose square integrates to 2π²/3.
#[test]
fn the_single_layer_of_one_element_in_closed_form() {
    let material = Material::new(2.5, 0.3, Plane::Strain).expect("valid");
    let mut mesh = Mesh::uniform(&polygon(&L_SHAPE, &[]), 6, 1);
    mesh.degree[2] = 3;
    let space = Space::new(&mesh);
    let (mut traction, c) = (vec![0.0; space.dofs()], [0.7, -0.4]);
    traction[2 * space.offset[2]..][..2].copy_from_slice(&c);
    let field = BoundaryField::new(&mesh, &space, &material, &vec![0.0; space.dofs()], &traction, 1.0);
    let got = boundary_residuals(&mesh, &field, &|_| [None, None]).expect("finite")[2];
    let pi = std::f64::consts::PI;
    let c_v = 1.0 / (8.0 * pi * material.mu() * 0.7);
    let slope = (c_v * material.kappa()).powi(2) * (c[0] * c[0] + c[1] * c[1]) * 2.0 * pi * pi / 3.0;
    let h = mesh.length(2);
    let want = h * 2.5 / 3.0 * (h / 2.0) * slope;
    println!("{:.5}", got.equation / want);
    assert!((got.equation / want - 1.0).abs() < 0.02 && got.neumann == 0.0);
}

/// The rule against one with many layers, on elements of all degrees: squares of one element to 10 %, sums to 3 %.
#[test]
fn few_layers_give_the_norms() {
    let material = Gold::read().material();
    for degree in [1, 2, 4, 8, 12] {
        let mesh = Mesh::uniform(&polygon(&L_SHAPE, &[]), 12, degree);
        let (space, exact) = (Space::new(&mesh), Field::new("kelvin", &material));
        let field = with_traction(&mesh, &space, &material, &space.interpolate(|x| exact.displacement(x)));
        let square = |e: usize, t: f64| {
            let (d, s) = (field.equation_slope(e, t), field.steklov_trace(e, t));
            let given = exact.traction(mesh.point(e, t), mesh.normal(e, 0.0));
            [d[0] * d[0] + d[1] * d[1], (given[0] - s[0]).powi(2) + (given[1] - s[1]).powi(2)]
        };
        let (gauss, both) = (steklov_quadrature::gauss_legendre(20), steklov_quadrature::End::Both);
        let (fine, coarse) = (vec![steklov_quadrature::graded(&gauss, 10, 0.15, both)], residual_panels(degree, &[]));
        let of = |panels: &[steklov_quadrature::Rule], e: usize, k: usize| -> f64 {
            panels.iter().map(|r| r.integrate(|t| square(e, t)[k])).sum()
        };
        for k in 0..2 {
            let (mut total, mut reference, mut worst) = (0.0, 0.0, 0.0f64);
            for e in 0..mesh.len() {
                let (c, f) = (of(&coarse, e, k), of(&fine, e, k));
                (total, reference, worst) = (total + c, reference + f, worst.max((c / f - 1.0).abs()));
            }
            println!("p = {degree}: one element {worst:.1e}, sum {:.1e}", total / reference - 1.0);
            assert!(worst < 0.1 && (total / reference - 1.0).abs() < 0.03);
        }
    }
}

#[test]
fn panels_cover_the_element_and_stop_at_kinks() {
    for kinks in [vec![], vec![0.3, -0.999, 0.3, 1.0, -7.0]] {
        let panels = residual_panels(4, &kinks);
        let all = |f: &dyn Fn(f64) -> f64| panels.iter().map(|r| r.integrate(f)).sum::<f64>();
        assert!((all(&|_| 1.0) - 2.0).abs() < 1e-15);
        let exact = (1.3f64.powi(2) + 0.7f64.powi(2)) / 2.0; // ∫ |t - 0.3|
        let error = (all(&|t| (t - 0.3).abs()) - exact).abs();
        assert!(if kinks.is_empty() { error > 1e-4 } else { error < 1e-15 }, "{error:e}");
        // a jump anywhere is integrated to 10 % of the element
        let jump = |a: f64| (all(&|t| f64::from(t > a)) - (1.0 - a)).abs() / 2.0;
        assert!((-99..100).all(|k| jump(f64::from(k) / 100.0) < 0.1));
    }
}

#[test]
fn a_traction_that_is_not_finite_is_named() {
    let material = Gold::read().material();
    let mesh = Mesh::uniform(&polygon(&SQUARE, &[]), 4, 1);
    let space = Space::new(&mesh);
    let field = with_traction(&mesh, &space, &material, &vec![0.0; space.dofs()]);
    let given = |x: &Site| [None, (x.element == 2).then(|| (x.point[0] - 0.1).sqrt())];
    let error = boundary_residuals(&mesh, &field, &given).expect_err("not a number");
    assert!(matches!(&error, BemError::DataNotFinite { side, .. } if side == "side2"), "{error}");
}

/// The square with its left side held: exact data of a smooth field. The nodal solution, residuals, and the energy norm
/// of the error from interpolation by four more degrees.
fn smooth_problem(elements: usize, degree: usize, poisson: f64) -> (Vec<BoundaryResidual>, f64) {
    let material = Material::new(2.5, poisson, Plane::Strain).expect("valid");
    let exact = Field::new("exp", &material);
    let mesh = Mesh::uniform(&polygon(&SQUARE, &[]), elements, degree);
    let space = Space::new(&mesh);
    let given = |x: &Site| exact.traction(x.point, mesh.normal(x.element, x.t));
    let mut load = vec![0.0; space.dofs()];
    for side in 0..3 {
        for (i, direction) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
            let value = |x: &Site| given(x)[i];
            let datum = Datum { name: "traction", value: &value, kinks: &|_| Vec::new(), rounding: None };
            add_load(&mut load, &space, &side_moments(&mesh, &space, side, &datum).expect("smooth"), |_| direction);
        }
    }
    let nodal = space.interpolate(|x| exact.displacement(x));
    let held = (0..space.dofs()).filter(|d| space.points[d / 2][0] == -0.5).map(|d| (d, nodal[d])).collect();
    let operators = Operators::assemble(&mesh, &space, &material, None).expect("operators");
    let length = operators.length;
    let steklov = Steklov::new(operators, Domain::Interior).expect("S");
    let partition = Partition { held, ..Partition::default() };
    let condensation = Condensation::new(steklov.matrix, &partition, &[]).expect("held");
    let u = condensation.expand(&condensation.load(&load), &[]);
    let field = BoundaryField::new(&mesh, &space, &material, &u, &steklov.traction.apply(&u), length);
    let residuals =
        boundary_residuals(&mesh, &field, &|x| if x.point[0] == -0.5 { [None; 2] } else { given(x).map(Some) });

    let mut fine = mesh.clone();
    fine.degree.iter_mut().for_each(|p| *p += 4);
    let rich = Space::new(&fine);
    let mut error = rich.interpolate(|x| exact.displacement(x));
    for e in 0..mesh.len() {
        for (node, &t) in rich.element_nodes(e).zip(&rich.basis(e).nodes) {
            if t < 1.0 {
                let got = field.trace(e, t).displacement;
                (0..2).for_each(|i| error[2 * node + i] -= got[i]);
            }
        }
    }
    let operators = Operators::assemble(&fine, &rich, &material, None).expect("operators");
    let matrix = Steklov::new(operators, Domain::Interior).expect("S").matrix;
    (residuals.expect("finite"), dot(&error, &product(&matrix, &error)).sqrt())
}

#[test]
fn the_indicator_falls_like_the_error_of_a_smooth_solution() {
    for degree in [1, 2] {
        let levels = [24, 48, 96].map(|n| {
            let (residuals, error) = smooth_problem(n, degree, 0.3);
            let part = |f: fn(&BoundaryResidual) -> f64| residuals.iter().map(f).sum::<f64>().sqrt();
            let [neumann, equation] = [part(|r| r.neumann), part(|r| r.equation)];
            let total = sum(&residuals).sqrt();
            println!("p = {degree}, {n}: {neumann:.3e} {equation:.3e}, {:.3} of the error {error:.3e}", total / error);
            (total, error)
        });
        let rate = (levels[1].0 / levels[2].0).log2();
        assert!((rate - degree as f64 - 0.5).abs() < 0.1, "degree {degree}: rate {rate}");
        // above the error, and by the same factor everywhere
        let ratios = levels.map(|(total, error)| total / error);
        assert!(ratios.iter().all(|r| (1.0..6.0).contains(r) && (r / ratios[2] - 1.0).abs() < 0.1), "{ratios:?}");
    }
}

/// The factor between indicator and error is of one size for all ν and p: a power of p too much would show at p = 8.
#[test]
fn neither_poissons_ratio_nor_the_degree_spoils_the_indicator() {
    for (elements, degree, poisson) in
        [(24, 1, -0.5), (24, 1, 0.4999999), (24, 2, -0.5), (24, 2, 0.4999999), (8, 4, 0.3), (8, 6, 0.3), (4, 8, 0.3)]
    {
        let (residuals, error) = smooth_problem(elements, degree, poisson);
        let ratio = sum(&residuals).sqrt() / error;
        println!("{elements} elements of degree {degree}, nu = {poisson}: {ratio:.2} of the error {error:.1e}");
        assert!((1.7..3.5).contains(&ratio), "{ratio}");
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let material = Gold::read().material();
    let mesh = Mesh::uniform(&polygon(&L_SHAPE, &[]), 20, 3);
    let space = Space::new(&mesh);
    let field = with_traction(&mesh, &space, &material, &space.interpolate(|[x, y]| [x * x * y, (5.0 * y).sin()]));
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| boundary_residuals(&mesh, &field, &|_| [Some(1.0), None]).expect("finite"))
    };
    assert_eq!(on(1), on(4));
}

/// By few points residuals (squares) are those of the close look to a factor of two; groups of elements have the bits of all.
#[test]
fn a_quick_look_sees_what_a_close_one_does() {
    let material = Gold::read().material();
    let mesh = Mesh::uniform(&polygon(&L_SHAPE, &[]), 20, 3);
    let space = Space::new(&mesh);
    let field = with_traction(&mesh, &space, &material, &space.interpolate(|[x, y]| [x * x * y, (5.0 * y).sin()]));
    let given = |_: &Site| [Some(1.0), None];
    let of = |elements, look| boundary_residuals_of(&mesh, &field, &given, elements, look).expect("finite");
    let (close, quick) = (of(0..mesh.len(), Look::Close), of(0..mesh.len(), Look::Quick));
    assert_eq!(close, boundary_residuals(&mesh, &field, &given).expect("finite"));
    for (close, quick) in close.iter().zip(&quick) {
        for (close, quick) in [(close.neumann, quick.neumann), (close.equation, quick.equation)] {
            assert!(quick < 2.0 * close && close < 2.0 * quick, "{quick} {close}");
        }
    }
    assert_eq!([of(0..7, Look::Quick), of(7..mesh.len(), Look::Quick)].concat(), quick);
}
