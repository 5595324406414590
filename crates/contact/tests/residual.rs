//! Residuals of contact conditions: zero for exact solutions, closed forms, units, rates.

use crate::solved::{Case, Field, square};
use proptest::prelude::*;
use steklov_bem_operators::{BoundaryField, Datum, Loop, Mesh, ParticularSolution, Polygon, Site, Space};
use steklov_contact::{
    ContactError, ContactResidual, ContactSolution, Multiplier, MultiplierDegree, MultiplierMesh, MultiplierSpace,
    SideData, contact_boundary, contact_residuals, multiplier_trace,
};
use steklov_elastic::{Material, Plane};

fn sum(residuals: &[ContactResidual], term: impl Fn(&ContactResidual) -> f64) -> f64 {
    residuals.iter().map(term).sum()
}

const STEEL: Material = Material { young: 2.5, poisson: 0.3, plane: Plane::Strain };

/// Pressed (σ_yy < 0) and sheared (σ_xy > 0), with u_x > 0 on the floor.
const SLIPPING: Field =
    Field { material: STEEL, shift: [1.0, 0.1], gradient: [[0.1, 0.6], [0.2, -1.0]], curved: 0.0, body_force: None };

/// Degrees 1 to 4 in any order on 8 elements.
fn degrees() -> impl Strategy<Value = Vec<usize>> {
    proptest::collection::vec(1..=4usize, 8)
}

fn mesh(angle: f64, degrees: &[usize]) -> Mesh {
    let mut mesh = Mesh::uniform(&square(angle), degrees.len(), 1);
    mesh.degree.copy_from_slice(degrees);
    mesh
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A linear field is pressed on an obstacle of its own shape and slips or sticks; the floor may meet a held side.
    #[test]
    fn the_contact_patch_leaves_nothing(
        degrees in degrees(), angle in -3.0..3.0f64, slips in any::<bool>(), held in any::<bool>()
    ) {
        let mesh = mesh(angle, &degrees);
        let held = [false, false, true, held];
        let case = if slips {
            Case::of_field(mesh, SLIPPING, angle, held, None)
        } else {
            let stuck = Field { shift: [0.3, 0.1], gradient: [[0.0, 0.6], [0.2, -1.0]], ..SLIPPING };
            Case::of_field(mesh, stuck, angle, held, Some(1.5))
        };
        let solved = case.solve();
        prop_assert!(solved.solution.converged());
        prop_assert!(solved.indicator() < 1e-10 * solved.size(), "{:e} {:?}", solved.indicator(), solved.contact);
    }

    /// A heavy block: the particular solution and a linear field are in the space from p = 2 on.
    #[test]
    fn a_body_force_is_counted(weight in 0.1..2.0f64, degrees in degrees()) {
        let degrees: Vec<usize> = degrees.iter().map(|p| p + 1).collect();
        let body_force = Some(ParticularSolution::of_body_force([0.0, -weight], [0.1, 0.6], &STEEL));
        let field = Field { body_force, ..SLIPPING };
        let solved = Case::of_field(mesh(0.0, &degrees), field, 0.0, [false, false, true, false], None).solve();
        prop_assert!(solved.indicator() < 1e-10 * solved.size(), "{:e} {:?}", solved.indicator(), solved.contact);
    }

    /// ∫ (λ_n n + λ_t t) φ_j over the contact boundary is what the boundary says of its nodal forces, at bends and held
    /// ends too.
    #[test]
    fn the_multiplier_has_the_nodal_forces_as_moments(
        degrees in proptest::collection::vec(2..=5usize, 9), angle in -3.0..3.0f64, holds in 0..4usize,
        values in proptest::collection::vec([-1.0..1.0f64, -1.0..1.0f64], 100)
    ) {
        let mesh = mesh(angle, &degrees);
        let space = Space::new(&mesh);
        let sides: Vec<SideData<'_>> = [0, 1].map(|side| SideData { side, gap: NONE, bound: None, coefficient: None, beyond: None }).to_vec();
        // the first corner, where the contact begins, is held wholly or in one component
        let held = |node: usize| {
            let at = |i: usize| if holds & (1 << i) != 0 && node == space.offset[0] { Some(0.1) } else { None };
            [at(0), at(1)]
        };
        let boundary = contact_boundary(&mesh, &space, &sides, &held).expect("a boundary");
        let count = boundary.contact.iter().map(|c| c.conditions.len()).sum::<usize>();
        let mut lambda = values[..count].to_vec();
        let conditions = boundary.contact.iter().flat_map(|c| &c.conditions);
        for (l, c) in lambda.iter_mut().zip(conditions) {
            // no multiplier where there is no weight
            l[0] *= f64::from(c.normal_weight > 0.0);
            l[1] *= f64::from(c.tangent_weight > 0.0);
        }
        let mut moments = vec![[0.0; 2]; space.nodes()];
        let rule = steklov_quadrature::gauss_legendre(8);
        for e in 0..mesh.len() {
            let trace = multiplier_trace(&mesh, &space, &boundary, &lambda, e);
            prop_assert!(mesh.side[e] < 2 || trace.iter().all(|l| *l == [0.0; 2]));
            let (basis, n, t) = (space.basis(e), mesh.normal(e, 0.0), mesh.tangent(e, 0.0));
            let mut phi = vec![0.0; basis.degree + 1];
            for (&x, &w) in rule.points.iter().zip(&rule.weights) {
                basis.evaluate(x, &mut phi);
                let value = |k: usize| trace.iter().zip(&phi).map(|(l, phi)| l[k] * phi).sum::<f64>();
                for (node, phi) in space.element_nodes(e).zip(&phi) {
                    (0..2).for_each(|i| moments[node][i] += w * mesh.length(e) / 2.0 * phi * (value(0) * n[i] + value(1) * t[i]));
                }
            }
        }
        for (node, force) in boundary.nodal_forces(&lambda) {
            (0..2).for_each(|i| moments[node][i] -= force[i]);
        }
        prop_assert!(moments.iter().flatten().all(|m| m.abs() < 1e-13), "{moments:?}");
    }

    /// Lengths times a, stresses times b: energies per thickness times b a².
    #[test]
    fn another_unit_changes_no_ratio(a in 1e-3..1e3f64, b in 1e-6..1e6f64) {
        let of = |size: f64, stress: f64| {
            let mut mesh = mesh(0.3, &[1, 2, 3, 1, 2, 1, 2, 3]);
            mesh.vertices.iter_mut().for_each(|v| *v = v.map(|x| size * x));
            let material = Material::new(2.5 * stress, 0.3, Plane::Strain).expect("valid");
            let u = |i: usize| 0.1 * size * (2.3 * i as f64 + 1.0).sin();
            let lambda = |i: usize| [stress * (1.9 * i as f64).cos(), stress * (1.3 * i as f64 + 2.0).sin()];
            rough(&mesh, &material, u, lambda, &|_: &Site| 0.01 * size, &|_: &Site| 0.4 * stress)
        };
        let (one, other) = (of(1.0, 1.0), of(a, b));
        for term in TERMS {
            let (x, y) = (sum(&one, term), sum(&other, term) / (b * a * a));
            prop_assert!(x > 1e-6 && (y / x - 1.0).abs() < 1e-9, "{x} {y}");
        }
    }
}

const NONE: Datum<'_> = Datum { name: "gap", value: &|_| 0.0, kinks: &|_| Vec::new(), rounding: None };

const TERMS: [fn(&ContactResidual) -> f64; 6] =
    [|r| r.contact, |r| r.complementarity, |r| r.tension, |r| r.penetration, |r| r.bound, |r| r.friction];

/// Residuals of a displacement and multipliers that solve nothing, in a field without stress.
fn rough(
    mesh: &Mesh,
    material: &Material,
    u: impl Fn(usize) -> f64,
    lambda: impl Fn(usize) -> [f64; 2],
    gap: &(dyn Fn(&Site) -> f64 + Sync),
    bound: &(dyn Fn(&Site) -> f64 + Sync),
) -> Vec<ContactResidual> {
    let space = Space::new(mesh);
    let kinks = |_: usize| Vec::new();
    let gap = Datum { name: "gap", value: gap, kinks: &kinks, rounding: None };
    let sides = [SideData {
        side: 0,
        gap,
        bound: Some(Datum { name: "bound", value: bound, kinks: &kinks, rounding: None }),
        coefficient: None,
        beyond: None,
    }];
    let boundary = contact_boundary(mesh, &space, &sides, &|_| [None, None]).expect("a boundary");
    let multipliers: Vec<[f64; 2]> = (0..boundary.nodes.len()).map(lambda).collect();
    let displacement: Vec<f64> = (0..space.dofs()).map(u).collect();
    let none = vec![0.0; space.dofs()];
    let field = BoundaryField::new(mesh, &space, material, &none, &none, mesh.diameter());
    let solution = ContactSolution {
        mesh,
        space: &space,
        displacement: &displacement,
        multiplier: Multiplier::Biorthogonal(&boundary, &multipliers),
        field: &field,
        body_force: None,
    };
    contact_residuals(&solution, &sides).expect("finite")
}

/// One violation at a time on a floor of one element, h = 1, E = 2.5: the term in closed form and the others 0.
#[test]
fn each_term_alone() {
    for p in [1, 2, 3] {
        let mesh = mesh(0.0, &[p, 1, 1, 1]);
        let space = Space::new(&mesh);
        let (degree, young) = (p as f64, 2.5);
        // u = (slip, overlap as a function of s) on the floor, whose normal is (0, -1)
        let of = |slip: f64, overlap: &dyn Fn(f64) -> f64, lambda: [f64; 2], gap: f64, bound: f64| {
            let u = |i: usize| if i.is_multiple_of(2) { slip } else { -overlap(space.points[i / 2][0] + 0.5) };
            rough(&mesh, &STEEL, u, |_| lambda, &|_| gap, &|_| bound)
        };
        // contact, complementarity, tension, penetration, bound, friction
        let check = |got: Vec<ContactResidual>, want: [f64; 6]| {
            assert_eq!((got.len(), got[0].element), (1, 0));
            for (k, (term, want)) in TERMS.iter().zip(want).enumerate() {
                assert!((term(&got[0]) - want).abs() < 1e-13 * (1.0 + want), "p = {p}, term {k}: {got:?} {want}");
            }
            assert!((got[0].total() - want.iter().sum::<f64>()).abs() < 1e-12);
        };
        let stress = |s: f64| s * s / (degree * young);
        let length = |u: f64| degree * young * u * u;
        let flat = |_: f64| 0.0;
        check(of(0.0, &flat, [0.0, 0.0], 0.0, 1.0), [0.0; 6]);
        check(of(0.0, &flat, [3.0, 0.0], 0.0, 1.0), [stress(3.0), 0.0, 0.0, 0.0, 0.0, 0.0]);
        check(of(0.0, &flat, [-3.0, 0.0], 0.0, 1.0), [stress(3.0), 0.0, stress(3.0), 0.0, 0.0, 0.0]);
        check(of(0.0, &flat, [0.0, -3.0], 0.0, 1.0), [stress(3.0), 0.0, 0.0, 0.0, stress(2.0), 0.0]);
        // w = 0.2 s - 0.1 + 0.1 = 0.2 s: ∫w² = 0.04/3, ∫w'² = 0.04
        let penetration = 0.5 * (degree * young * 0.04 / 3.0 + young / degree * 0.04);
        check(of(0.0, &|s| 0.2 * s - 0.1, [0.0; 2], -0.1, 1.0), [0.0, 0.0, 0.0, penetration, 0.0, 0.0]);
        check(of(0.0, &|s| 0.2 * s - 0.1, [3.0, 0.0], -0.1, 1.0), [stress(3.0), 0.0, 0.0, penetration, 0.0, 0.0]);
        // pressure 3 at a gap: the lesser energy of taking the pressure or the gap away
        check(of(0.0, &flat, [3.0, 0.0], 0.01, 1.0), [stress(3.0), length(0.01), 0.0, 0.0, 0.0, 0.0]);
        check(of(0.0, &flat, [3.0, 0.0], 100.0, 1.0), [stress(3.0), stress(3.0), 0.0, 0.0, 0.0, 0.0]);
        // slip 0.01 along a shear of 1 below the bound 4, and against it
        check(of(0.01, &flat, [0.0, 1.0], 0.0, 4.0), [stress(1.0), 0.0, 0.0, 0.0, 0.0, length(0.01)]);
        check(of(-0.01, &flat, [0.0, 1.0], 0.0, 4.0), [stress(1.0), 0.0, 0.0, 0.0, 0.0, 3.0 * length(0.01)]);
        check(of(100.0, &flat, [0.0, 1.0], 0.0, 4.0), [stress(1.0), 0.0, 0.0, 0.0, 0.0, stress(3.0)]);
        check(of(100.0, &flat, [0.0, 1.0], 0.0, 1.0), [stress(1.0), 0.0, 0.0, 0.0, 0.0, 0.0]);
        // a bound beyond any shear is full stick
        check(of(0.01, &flat, [0.0, 1.0], 0.0, 1e100), [stress(1.0), 0.0, 0.0, 0.0, 0.0, length(0.01)]);
    }
}

/// Coulomb's bound of stabilised multipliers is that of their own pressure, at least 0.
#[test]
fn coulomb_bounds_of_stabilised_multipliers() {
    for p in [1, 2, 3] {
        let mesh = mesh(0.0, &[p, 1, 1, 1]);
        let space = Space::new(&mesh);
        let multipliers =
            MultiplierSpace::new(&mesh, &[0], MultiplierMesh::Finer(3), MultiplierDegree::Relative(0)).expect("a side");
        let none = vec![0.0; space.dofs()];
        let field = BoundaryField::new(&mesh, &space, &STEEL, &none, &none, mesh.diameter());
        let slip: Vec<f64> = (0..space.dofs()).map(|i| if i % 2 == 0 { 0.01 } else { 0.0 }).collect();
        let [bound, coefficient] =
            [Datum { value: &|_: &Site| 0.25, ..NONE }, Datum { value: &|_: &Site| 0.5, ..NONE }];
        let sides = [SideData { side: 0, gap: NONE, bound: Some(bound), coefficient: Some(coefficient), beyond: None }];
        let (stress, length) = (|s: f64| s * s / (p as f64 * 2.5), |u: f64| p as f64 * 2.5 * u * u);
        // bound and friction under F = 0.25 + 0.5 λ_n⁺
        for (lambda, want) in [
            ([3.0, 1.0], [0.0, length(0.01)]),
            ([3.0, 1.75], [0.0, 0.0]),
            ([3.0, 2.0], [stress(0.25), 0.0]),
            ([-3.0, 1.0], [stress(0.75), 0.0]),
            ([0.0, 0.25], [0.0, 0.0]),
        ] {
            let values = vec![lambda; multipliers.nodes.len()];
            let solution = ContactSolution {
                mesh: &mesh,
                space: &space,
                displacement: &slip,
                multiplier: Multiplier::Stabilised(&multipliers, &values),
                field: &field,
                body_force: None,
            };
            let got = contact_residuals(&solution, &sides).expect("finite")[0];
            // σ^h = 0: the multiplier itself is left, and once more over p
            let whole = stress(lambda[0]) + stress(lambda[1]);
            assert!((got.contact - whole).abs() < 1e-13 * whole && whole > 0.0, "p = {p}, {lambda:?}: {got:?}");
            assert!((got.stabilisation - whole / p as f64).abs() < 1e-13 * whole, "p = {p}, {lambda:?}: {got:?}");
            let found = [got.bound, got.friction];
            assert!(
                found.iter().zip(want).all(|(f, w)| (f - w).abs() < 1e-13),
                "p = {p}, {lambda:?}: {got:?} {want:?}"
            );
        }
    }
}

/// A straight floor of which one part is in contact: the multiplier ends where that part ends.
#[test]
fn the_multiplier_stays_on_its_side() {
    let corners = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
    let sides = ["contact", "free", "right", "top", "left"].map(String::from).to_vec();
    let polygon = Polygon::new(Loop::straight(corners, sides), Vec::new()).expect("a rectangle");
    let mesh = Mesh::uniform(&polygon, 5, 3);
    let space = Space::new(&mesh);
    let boundary = contact_boundary(
        &mesh,
        &space,
        &[SideData { side: 0, gap: NONE, bound: None, coefficient: None, beyond: None }],
        &|_| [None, None],
    );
    let trace = |e: usize| {
        let boundary = boundary.as_ref().expect("a boundary");
        multiplier_trace(&mesh, &space, boundary, &vec![[2.0, -1.0]; boundary.nodes.len()], e)
    };
    assert!(trace(0).iter().all(|l| (l[0] - 2.0).abs() < 1e-14 && (l[1] + 1.0).abs() < 1e-14));
    assert!((1..mesh.len()).all(|e| trace(e) == [[0.0; 2]; 4]));
}

/// The gap counts with its slope, not with its values at nodes: u = 0, g = -s², so w = s² and w' = 2s.
#[test]
fn the_overlap_of_a_curved_obstacle() {
    let mesh = mesh(0.0, &[1, 1, 1, 1]);
    let got = rough(&mesh, &STEEL, |_| 0.0, |_| [0.0; 2], &|x| -x.s * x.s, &|_| 1.0);
    let want = 0.5 * 2.5 * (1.0 / 5.0 + 4.0 / 3.0);
    assert!((got[0].penetration - want).abs() < 1e-13 && got[0].total() == got[0].penetration, "{got:?} {want}");
}

#[test]
fn a_gap_that_is_not_finite_is_named() {
    let mesh = mesh(0.0, &[1, 1, 1, 1]);
    let space = Space::new(&mesh);
    let boundary = contact_boundary(
        &mesh,
        &space,
        &[SideData { side: 0, gap: NONE, bound: None, coefficient: None, beyond: None }],
        &|_| [None, None],
    );
    let (boundary, none) = (boundary.expect("a boundary"), vec![0.0; space.dofs()]);
    let field = BoundaryField::new(&mesh, &space, &STEEL, &none, &none, 2.0);
    let solution = ContactSolution {
        mesh: &mesh,
        space: &space,
        displacement: &none,
        multiplier: Multiplier::Biorthogonal(&boundary, &[[0.0; 2]; 2]),
        field: &field,
        body_force: None,
    };
    let gap = Datum { value: &|x: &Site| x.point[0].sqrt(), ..NONE };
    let error =
        contact_residuals(&solution, &[SideData { side: 0, gap, bound: None, coefficient: None, beyond: None }])
            .expect_err("not a number");
    assert!(matches!(error, ContactError::Data(_)) && error.to_string().contains("floor"), "{error}");
}

/// The body of the thesis' problem 2.7, which lifts at its corners and slips, against a fine solution: the indicator
/// stays above the error in the energy norm and by less than a factor of 5.
#[test]
fn the_indicator_bounds_the_error_of_a_contact_problem_on_both_sides() {
    let block = |elements, degree| Case::block(Mesh::uniform(&square(0.0), elements, degree)).solve();
    let fine = block(128, 4);
    for degree in [1, 2] {
        for elements in [16, 32, 64] {
            let coarse = block(elements, degree);
            let (error, eta) = (fine.distance(&coarse), coarse.indicator());
            println!("p = {degree}, {elements}: error {error:.3e}, η² {:.3e}, η/error {:.2}", eta * eta, eta / error);
            assert!((1.0..5.0).contains(&(eta / error)), "{eta} {error}");
        }
    }
}

/// A smooth field pressed on an obstacle of its own shape, slipping under a bound that varies: no term is worse than the
/// error, h^(p+½).
#[test]
fn all_terms_fall_like_the_error_of_a_smooth_contact() {
    let field = Field { curved: 0.1, ..SLIPPING };
    for degree in [1, 2] {
        let levels = [24, 48, 96].map(|elements| {
            let mesh = Mesh::uniform(&square(0.0), elements, degree);
            let solved = Case::of_field(mesh, field, 0.0, [false, false, true, false], None).solve();
            let terms = TERMS.map(|term| sum(&solved.contact, term).sqrt());
            println!("p = {degree}, {elements}: {:.3e}, contact terms {terms:?}", solved.indicator());
            (solved.indicator(), terms)
        });
        let rate = |a: f64, b: f64| (a / b).log2();
        let whole = rate(levels[1].0, levels[2].0);
        println!("rate {whole:.3}");
        assert!((whole - degree as f64 - 0.5).abs() < 0.15, "p = {degree}: {whole}");
        for (a, b) in levels[1].1.iter().zip(levels[2].1).filter(|(a, _)| **a > 0.0) {
            assert!(rate(*a, b) > degree as f64 + 0.3, "p = {degree}: {a:e} {b:e}");
        }
    }
}
