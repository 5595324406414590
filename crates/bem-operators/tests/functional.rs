//! Linear functionals of boundary fields against the fields themselves, and the right side of dual problems.

use proptest::collection::vec;
use proptest::prelude::*;
use steklov_bem_operators::{
    BoundaryField, Domain, Enriched, EnrichedSteklov, Functional, Loop, Mesh, Operators, PairCache, Polygon, Raised,
    Space, Steklov, Trace,
};
use steklov_elastic::{Material, Plane};

/// A square with a circular hole: lines and arcs.
fn polygon() -> Polygon {
    let corners = vec![[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let square = Loop::straight(corners, vec!["s".to_owned(); 4]);
    Polygon::new(square, vec![Loop::circle([0.2, 0.1], 0.4, 4, "c")]).unwrap()
}

fn material() -> Material {
    Material::new(3.0, 0.3, Plane::Strain).unwrap()
}

/// A displacement and a traction of the enriched spaces of a mesh.
fn enriched(mesh: &Mesh, space: &Space, values: &[f64]) -> [Enriched; 2] {
    let of = |from: usize| {
        let at = |k: usize| values[(from + 7 * k) % values.len()];
        let n = space.dofs();
        Enriched { base: (0..n).map(at).collect(), extra: (n..n + 2 * mesh.len()).map(at).collect() }
    };
    [of(0), of(3)]
}

fn dot(functional: &[Enriched; 2], of: &[Enriched; 2]) -> f64 {
    functional.iter().zip(of).map(|(a, b)| a.dot(b)).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn functionals_have_the_values_of_fields(
        degree in 1usize..5,
        values in vec(-1.0f64..1.0, 211),
        x in [-0.95f64..0.95, -0.95f64..0.95],
        (place, t) in (0usize..16, -0.99f64..0.99),
        weights in vec(-1.0f64..1.0, 7),
    ) {
        prop_assume!((x[0] - 0.2).hypot(x[1] - 0.1) > 0.43);
        let mesh = Mesh::uniform(&polygon(), 16, degree);
        let space = Space::new(&mesh);
        let own = enriched(&mesh, &space, &values);
        let raised = Raised::new(&mesh, &space, &own[0], &own[1]);
        let field = BoundaryField::new(
            &raised.mesh, &raised.space, &material(), &raised.displacement, &raised.traction, 1.0,
        );
        let inside = field.inside(x);
        let exact = [inside.displacement[0], inside.displacement[1], inside.stress[0], inside.stress[1], inside.stress[2]];
        let functionals = field.functionals_inside(x);
        let size = exact.iter().fold(1.0f64, |m, v| m.max(v.abs()));
        for (functional, exact) in functionals.iter().zip(exact) {
            // far elements by rules in the one, by exact integrals in the other
            prop_assert!((functional.of(&field) - exact).abs() < 1e-10 * size, "{} {exact}", functional.of(&field));
            let by_functions = dot(&functional.enriched(&space), &own);
            prop_assert!((by_functions - exact).abs() < 1e-10 * size, "{by_functions} {exact}");
        }
        let e = place % mesh.len();
        let [a, b, c, d, xx, yy, xy] = weights[..] else { unreachable!("seven weights") };
        let by = Trace { displacement: [a, b], traction: [c, d], stress: [xx, yy, xy] };
        let mut functional = Functional::zero(mesh.len());
        functional.add_trace(&field, (e, t), &by);
        let of = field.trace(e, t);
        let exact = a * of.displacement[0] + b * of.displacement[1] + c * of.traction[0] + d * of.traction[1]
            + xx * of.stress[0] + yy * of.stress[1] + xy * of.stress[2];
        let scale = 1.0 + of.stress.iter().fold(0.0f64, |m, s| m.max(s.abs()));
        prop_assert!((functional.of(&field) - exact).abs() < 1e-12 * scale);
        let by_functions = dot(&functional.enriched(&space), &own);
        prop_assert!((by_functions - exact).abs() < 1e-12 * scale, "{by_functions} {exact}");
    }
}

/// j·ψ₊ and w·a of an enriched displacement v, a the constant at infinity, are those of the right side on nodes and bubbles, and on the top
/// tractions of ψ₊.
#[test]
fn the_dual_right_side_has_the_values_of_tractions_and_of_the_constant() {
    let outside = || Polygon::outside(vec![Loop::circle([0.0, 0.0], 1.0, 4, "c")]).unwrap();
    for (polygon, domain) in [
        (polygon(), Domain::Interior),
        (polygon(), Domain::Exterior),
        (outside(), Domain::Interior),
        (outside(), Domain::BoundedAtInfinity),
        (polygon(), Domain::ExteriorBoundedAtInfinity),
    ] {
        let mesh = Mesh::uniform(&polygon, 16, 2);
        let space = Space::new(&mesh);
        let mut cache = PairCache::default();
        let operators = Operators::to_enrich(&mesh, &space, &material(), None, &mut cache).unwrap();
        let length = operators.length;
        let steklov = Steklov::new(operators, domain).unwrap();
        let map = &steklov.traction;
        let plus = EnrichedSteklov::new(&mesh, &space, &material(), length, map, &mut cache, true).unwrap();
        let values: Vec<f64> = (0..211).map(|k| (1.3 * k as f64).sin()).collect();
        let [v, j] = enriched(&mesh, &space, &values);
        let traction = plus.traction(map, &v).unwrap();
        let sign = if matches!(domain, Domain::Exterior | Domain::ExteriorBoundedAtInfinity) { -1.0 } else { 1.0 };
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let of = |[nodes, bubbles, top]: [Vec<f64>; 3]| {
            sum(&nodes, &v.base) + sum(&bubbles, &v.extra) + sign * sum(&top, &traction.extra)
        };
        let (found, exact) = (of(plus.dual_of_traction(map, &j).unwrap()), j.dot(&traction));
        assert!((found - exact).abs() < 1e-9 * (1.0 + exact.abs()), "{domain:?}: {found} {exact}");
        let ([x, y], w) = (plus.at_infinity(map, &v, &traction), [0.7, -1.1]);
        let of_constant = plus.dual_of_constant(map, w);
        let bounded = matches!(domain, Domain::BoundedAtInfinity | Domain::ExteriorBoundedAtInfinity);
        assert_eq!(of_constant.is_some(), bounded, "{domain:?}");
        let (found, exact) = (of_constant.map_or(0.0, of), w[0] * x + w[1] * y);
        assert!((found - exact).abs() < 1e-11 && bounded == (exact != 0.0), "{domain:?}: {found} {exact}");
    }
}

/// V ζ = Hz - j of the traction of a dual solution; bounded at infinity with the resultant -w, and up to one constant for each component.
#[test]
fn tractions_of_dual_solutions_solve_their_equation() {
    let outside = || Polygon::outside(vec![Loop::circle([0.0, 0.0], 1.0, 4, "c")]).unwrap();
    for (polygon, domain, sign) in [
        (polygon(), Domain::Interior, 1.0),
        (polygon(), Domain::Exterior, -1.0),
        (outside(), Domain::BoundedAtInfinity, 1.0),
        (polygon(), Domain::ExteriorBoundedAtInfinity, -1.0),
    ] {
        let mesh = Mesh::uniform(&polygon, 16, 2);
        let space = Space::new(&mesh);
        let mut cache = PairCache::default();
        let operators = Operators::to_enrich(&mesh, &space, &material(), None, &mut cache).unwrap();
        let (v, k, mass, length) = (operators.v.clone(), operators.k.clone(), operators.mass.clone(), operators.length);
        let map = Steklov::new(operators, domain).unwrap().traction;
        let plus = EnrichedSteklov::new(&mesh, &space, &material(), length, &map, &mut cache, true).unwrap();
        let n = space.dofs();
        let [z, j] = [1.3, 0.7].map(|f| (0..n).map(|k| (f * k as f64).sin()).collect::<Vec<f64>>());
        let w = [0.7, -1.1];
        let zeta = plus.dual_traction(&map, &z, (&j, w));
        // sign Hz = ½M z + sign K z, of tractions with the sign
        let symmetric = |a: usize, b: usize| v[(a.max(b), a.min(b))];
        let mut rest: Vec<f64> = (0..n)
            .map(|a| {
                let of_zeta: f64 = (0..n).map(|b| symmetric(a, b) * zeta[b]).sum();
                of_zeta + j[a] - (0..n).map(|b| k[(a, b)] * z[b]).sum::<f64>()
            })
            .collect();
        for (&value, (row, column)) in &mass {
            rest[row] -= sign * 0.5 * value * z[column];
        }
        let bounded = matches!(domain, Domain::BoundedAtInfinity | Domain::ExteriorBoundedAtInfinity);
        for i in 0..2 {
            let at = |e: usize| 2 * space.offset[e] + i;
            let constant = if bounded { rest[at(0)] / mesh.length(0) } else { 0.0 };
            (0..mesh.len()).for_each(|e| rest[at(e)] -= constant * mesh.length(e));
            let resultant: f64 = (0..mesh.len()).map(|e| mesh.length(e) * zeta[at(e)]).sum();
            assert!(!bounded || (resultant + sign * w[i]).abs() < 1e-10, "{domain:?}: {resultant} for {}", w[i]);
        }
        let largest = rest.iter().fold(0.0f64, |m, r| m.max(r.abs()));
        assert!(largest < 1e-10, "{domain:?}: {largest:e}");
    }
}
