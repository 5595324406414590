//! Stabilised multipliers: the coercivity limit, agreement with closed forms and with biorthogonal multipliers.

use steklov_bem_operators::{Datum, Domain, Loop, Mesh, Operators, Polygon, Site, Steklov};
use steklov_contact::{
    ContactError, Loading, MultiplierDegree, MultiplierMesh, MultiplierSpace, SideData, Stabilised, StabilisedForms,
    active_set, dual_form, inf_sup, interior_point, kkt, newton, pairing,
};
use steklov_elastic::{Material, Plane};

use crate::clamped::Clamped;

const J: f64 = 0.647_194_015_986_9;

fn square(elements_a_side: usize, degree: usize, young: f64) -> Clamped {
    let corners = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    let sides = ["floor", "right", "top", "left"].map(String::from).to_vec();
    let polygon = Polygon::new(Loop::straight(corners, sides), vec![]).unwrap();
    let material = Material::new(young, 0.3, Plane::Strain).unwrap();
    Clamped::on(Mesh::uniform(&polygon, 4 * elements_a_side, degree), material)
}

/// The wedge gap under Tresca friction, γ₀ half of the critical one; J of its solution, and the multipliers.
fn wedge(body: &Clamped, multipliers: &MultiplierSpace) -> (f64, Vec<[f64; 2]>, Stabilised) {
    let (gap, bound) = (|s: &Site| s.point[0].abs() / 10.0 - 0.05, |_: &Site| 0.3);
    let kinks = |e: usize| {
        let [a, b] = body.mesh.ends(e).map(|x| x[0]);
        if a < -1e-12 && b > 1e-12 { vec![-(a + b) / (b - a)] } else { vec![] }
    };
    let side = SideData {
        side: 0,
        gap: Datum { name: "gap", value: &gap, kinks: &kinks, rounding: None },
        bound: Some(Datum { name: "friction", value: &bound, kinks: &kinks, rounding: None }),
        coefficient: None,
        beyond: None,
    };
    let forms = body.forms(multipliers);
    let critical = forms.critical_gamma(&body.stiffness, &body.held, &[]).unwrap();
    let load = vec![0.0; body.space.dofs()];
    let loading = Loading { stiffness: &body.stiffness, load: &load, held: &body.held, motions: &[], particular: None };
    let stabilised = forms.condense(&body.mesh, multipliers, &[side], &loading, 0.5 * critical, critical).unwrap();
    let solution = active_set(&stabilised.problem, None).unwrap();
    assert!(solution.converged() && kkt(&stabilised.problem, &solution).worst() < 1e-9);
    let u = stabilised.displacement(&solution.displacement);
    let strain: f64 =
        (0..u.len()).map(|i| (0..u.len()).map(|j| 0.5 * u[i] * body.stiffness[(i, j)] * u[j]).sum::<f64>()).sum();
    let mut friction = 0.0;
    for e in (0..body.mesh.len()).filter(|&e| body.mesh.side[e] == 0) {
        let basis = body.space.basis(e);
        for (w, node) in basis.weights.iter().zip(body.space.element_nodes(e)) {
            friction += 0.3 * w * body.mesh.length(e) / 2.0 * u[2 * node].abs();
        }
    }
    (strain + friction, solution.multipliers, stabilised)
}

/// Critical γ₀E of γ = γ₀ h/p² with p = 1, 2, 4, 12, computed beforehand by another code; their limits for many elements.
#[test]
fn the_critical_gamma_is_that_of_the_form() {
    for (n, p, want) in [(8, 1, 0.644), (16, 1, 0.627), (8, 2, 0.99), (2, 4, 1.49), (2, 12, 1.95)] {
        let body = square(n, p, 7.0);
        let multipliers = body.multipliers(MultiplierMesh::Same, MultiplierDegree::Relative(0));
        let critical = body.forms(&multipliers).critical_gamma(&body.stiffness, &body.held, &[]).unwrap();
        println!("n = {n}, p = {p}: {:.4}", 7.0 * critical);
        assert!((7.0 * critical / want - 1.0).abs() < 0.02, "n = {n}, p = {p}: {} not {want}", 7.0 * critical);
    }
}

#[test]
fn the_wedge_converges_to_its_energy() {
    // relative error of J on the finest mesh, p = 1, 2, 3
    for (degree, levels) in [
        (MultiplierDegree::Relative(0), [1.5e-3, 4.5e-5, 2e-5]),
        (MultiplierDegree::Relative(-1), [4.2e-3, 3.5e-4, 2.5e-5]),
        (MultiplierDegree::ContinuousLinear, [1.7e-3, 7.5e-4, 8e-4]),
    ] {
        for p in [1, 2, 3] {
            let mut errors = vec![];
            for n in [4, 8, 16] {
                let body = square(n, p, 1000.0);
                let multipliers = body.multipliers(MultiplierMesh::Same, degree);
                let (energy, ..) = wedge(&body, &multipliers);
                errors.push((energy - J) / J);
            }
            println!("{degree:?} p = {p}: {errors:?}");
            // J of p = 1 falls like h², the ends of contact and of the held side keep that of higher degrees near it
            let [coarse, _, fine] = [errors[0], errors[1], errors[2]].map(f64::abs);
            assert!(p > 1 || (14.0..32.0).contains(&(coarse / fine)), "{degree:?}: {errors:?}");
            let level = levels[p - 1];
            assert!((0.2 * level..level).contains(&fine), "{degree:?} p = {p}: {errors:?}");
        }
    }
}

#[test]
fn a_gamma_beyond_the_critical_one_is_refused() {
    let body = square(4, 2, 1000.0);
    let multipliers = body.multipliers(MultiplierMesh::Same, MultiplierDegree::Relative(0));
    let forms = body.forms(&multipliers);
    let critical = forms.critical_gamma(&body.stiffness, &body.held, &[]).unwrap();
    let (zero, kinks) = (|_: &Site| 0.0, |_: usize| vec![]);
    let side = SideData {
        side: 0,
        gap: Datum { name: "gap", value: &zero, kinks: &kinks, rounding: None },
        bound: None,
        coefficient: None,
        beyond: None,
    };
    let load = vec![1.0; body.space.dofs()];
    let loading = Loading { stiffness: &body.stiffness, load: &load, held: &body.held, motions: &[], particular: None };
    for factor in [1.05, 1.0, 0.0, -1.0, f64::NAN] {
        let gamma = factor * critical;
        let refused = forms.condense(&body.mesh, &multipliers, &[side], &loading, gamma, critical).err();
        assert!(matches!(refused, Some(ContactError::StabilisationNotCoercive { .. })), "{factor}: {refused:?}");
    }
    let accepted = forms.condense(&body.mesh, &multipliers, &[side], &loading, 0.95 * critical, critical).unwrap();
    let [a, b] = [newton(&accepted.problem, None).unwrap(), interior_point(&accepted.problem).unwrap()];
    for (a, b) in a.multipliers.iter().zip(&b.multipliers) {
        assert!((a[0] - b[0]).abs() < 1e-7 && (a[1] - b[1]).abs() < 1e-7, "{a:?} {b:?}");
    }
}

/// β of discontinuous multipliers with and without stabilisation, of the same mesh and of one that is finer.
#[test]
fn the_inf_sup_constant_tells_which_pairs_are_stable() {
    let beta = |n: usize, p: usize, mesh: MultiplierMesh, degree: MultiplierDegree| {
        let body = square(n, p, 1.0);
        let fine = square(4 * n, p + 3, 1.0);
        let multipliers = body.multipliers(mesh, degree);
        let of =
            |b: &Clamped| dual_form(&pairing(&b.mesh, &b.space, &multipliers), &b.stiffness, &b.held, &[]).unwrap();
        let reference = of(&fine);
        let plain = inf_sup(&of(&body), &reference).unwrap().beta;
        let forms = body.forms(&multipliers);
        let critical = forms.critical_gamma(&body.stiffness, &body.held, &[]).unwrap();
        let dual = forms.dual_form(&body.stiffness, &body.held, &[], 0.5 * critical).unwrap();
        [plain, inf_sup(&dual, &reference).unwrap().beta]
    };
    for (mesh, degree) in [
        (MultiplierMesh::Same, MultiplierDegree::Relative(0)),
        (MultiplierMesh::Same, MultiplierDegree::Relative(-1)),
        (MultiplierMesh::Same, MultiplierDegree::ContinuousLinear),
        (MultiplierMesh::Coarser(2), MultiplierDegree::Relative(0)),
        (MultiplierMesh::Finer(2), MultiplierDegree::Relative(0)),
        (MultiplierMesh::Shifted, MultiplierDegree::Relative(-1)),
    ] {
        for (n, p) in [(2, 1), (4, 1), (8, 1), (2, 2), (4, 2), (2, 4)] {
            let [plain, stabilised] = beta(n, p, mesh, degree);
            println!("{mesh:?} {degree:?} n = {n}, p = {p}: {plain:.4} {stabilised:.4}");
            assert!(stabilised > 0.5 && stabilised < 1.0 + 1e-6, "{mesh:?} {degree:?} n = {n}, p = {p}: {stabilised}");
            assert!(plain < stabilised, "{mesh:?} {degree:?} n = {n}, p = {p}: {plain} {stabilised}");
            let unstable = mesh == MultiplierMesh::Finer(2)
                || mesh == MultiplierMesh::Same && degree == MultiplierDegree::Relative(0);
            assert!(!unstable || plain < 1e-6, "{mesh:?} {degree:?} n = {n}, p = {p}: {plain}");
            let stable = degree == MultiplierDegree::ContinuousLinear;
            assert!(!stable || plain > 0.75, "{mesh:?} {degree:?} n = {n}, p = {p}: {plain}");
        }
    }
}

/// A uniform pressure over the whole floor and a body force: the patch test, whatever the meshes of the multipliers.
#[test]
fn a_uniform_pressure_is_met_by_any_multipliers() {
    let body = square(3, 2, 5.0);
    // u = 0 on the top, free sides at nu = 0: compression along y alone
    let material = Material::new(5.0, 0.0, Plane::Strain).unwrap();
    let operators = Operators::assemble(&body.mesh, &body.space, &material, None).unwrap();
    let Steklov { matrix: stiffness, traction } = Steklov::new(operators, Domain::Interior).unwrap();
    let (gap, kinks) = (|_: &Site| -0.1, |_: usize| vec![]);
    let side = SideData {
        side: 0,
        gap: Datum { name: "gap", value: &gap, kinks: &kinks, rounding: None },
        bound: None,
        coefficient: None,
        beyond: None,
    };
    let load = vec![0.0; body.space.dofs()];
    let loading = Loading { stiffness: &stiffness, load: &load, held: &body.held, motions: &[], particular: None };
    for mesh in [MultiplierMesh::Same, MultiplierMesh::Coarser(2), MultiplierMesh::Finer(3), MultiplierMesh::Shifted] {
        for degree in [
            MultiplierDegree::Fixed(0),
            MultiplierDegree::Relative(-1),
            MultiplierDegree::Relative(2),
            MultiplierDegree::ContinuousLinear,
        ] {
            let multipliers = body.multipliers(mesh, degree);
            let forms =
                StabilisedForms::new(&body.mesh, &body.space, &material, &traction, &multipliers).expect("no fault");
            let critical = forms.critical_gamma(&stiffness, &body.held, &[]).unwrap();
            let stabilised =
                forms.condense(&body.mesh, &multipliers, &[side], &loading, 0.5 * critical, critical).unwrap();
            let solution = newton(&stabilised.problem, None).unwrap();
            for [pressure, shear] in &solution.multipliers {
                assert!(
                    (pressure - 0.5).abs() < 1e-11 && shear.abs() < 1e-11,
                    "{mesh:?} {degree:?}: {pressure} {shear}"
                );
            }
            let u = stabilised.displacement(&solution.displacement);
            for (i, x) in body.space.points.iter().enumerate() {
                let want = 0.1 * (0.5 - x[1]);
                assert!(u[2 * i].abs() < 1e-12 && (u[2 * i + 1] - want).abs() < 1e-12, "{mesh:?} {degree:?}: {x:?}");
            }
            // what contact and stabilisation add balances S u wherever nothing is held
            let forces = forms.nodal_forces(&body.mesh, stabilised.gamma, &solution.multipliers, &u, None);
            for i in (0..u.len()).filter(|i| body.held.iter().all(|h| h.0 != *i)) {
                let rest: f64 = (0..u.len()).map(|j| stiffness[(i, j)] * u[j]).sum::<f64>() + forces[i];
                assert!(rest.abs() < 1e-12, "{mesh:?} {degree:?}: {rest} at unknown {i}");
            }
        }
    }
}

/// The problem of a floor without a gap under the given bound, condensed at half of the critical γ₀, and the critical one.
fn slipping(body: &Clamped, multipliers: &MultiplierSpace, bound: &(dyn Fn(&Site) -> f64 + Sync)) -> Stabilised {
    let (gap, kinks) = (|_: &Site| -0.01, |_: usize| vec![]);
    let side = SideData {
        side: 0,
        gap: Datum { name: "gap", value: &gap, kinks: &kinks, rounding: None },
        bound: Some(Datum { name: "friction", value: bound, kinks: &kinks, rounding: None }),
        coefficient: None,
        beyond: None,
    };
    let forms = body.forms(multipliers);
    let critical = forms.critical_gamma(&body.stiffness, &body.held, &[]).unwrap();
    let load = vec![0.0; body.space.dofs()];
    let loading = Loading { stiffness: &body.stiffness, load: &load, held: &body.held, motions: &[], particular: None };
    forms.condense(&body.mesh, multipliers, &[side], &loading, 0.5 * critical, critical).unwrap()
}

/// Of continuous multipliers two elements share a node: one bound there, not two.
#[test]
fn a_constant_bound_is_that_bound_at_every_node() {
    let body = square(4, 2, 5.0);
    for degree in [MultiplierDegree::ContinuousLinear, MultiplierDegree::Relative(0)] {
        let multipliers = body.multipliers(MultiplierMesh::Same, degree);
        let stabilised = slipping(&body, &multipliers, &|_| 1e-3);
        let solution = active_set(&stabilised.problem, None).unwrap();
        assert!(solution.converged());
        let slips = solution.multipliers.iter().filter(|l| (l[1].abs() - 1e-3).abs() < 1e-15).count();
        // all but the middle, where the floor's expansion changes its sign
        assert!(slips + 2 >= multipliers.nodes.len() && slips > 3, "{degree:?}: {:?}", solution.multipliers);
        assert!(solution.multipliers.iter().all(|l| l[1].abs() < 1e-3 + 1e-15), "{degree:?}");
    }
}

/// The mean of the limits where a bound jumps: between elements of continuous multipliers, and inside one of discontinuous
/// multipliers that has several elements of the displacement.
#[test]
fn a_bound_that_jumps_at_a_node_counts_with_its_mean() {
    let body = square(4, 2, 5.0);
    let step = |at: &Site| if at.point[0] < -1e-11 { 0.2 } else { 0.6 };
    for (mesh, degree, at_jump) in [
        (MultiplierMesh::Same, MultiplierDegree::ContinuousLinear, vec![0.4]),
        (MultiplierMesh::Coarser(4), MultiplierDegree::Relative(0), vec![0.4]),
        (MultiplierMesh::Same, MultiplierDegree::Relative(0), vec![0.2, 0.6]),
    ] {
        let multipliers = body.multipliers(mesh, degree);
        let stabilised = slipping(&body, &multipliers, &step);
        let mut found = vec![];
        for (node, place) in stabilised.problem.nodes.iter().zip(&multipliers.nodes) {
            let (bound, x) = (node.conditions[0].bound, place.point[0]);
            if x.abs() < 1e-12 {
                found.push(bound);
            } else {
                assert!((bound - if x < 0.0 { 0.2 } else { 0.6 }).abs() < 1e-15, "{mesh:?} {degree:?} {x}: {bound}");
            }
        }
        assert!(found.len() == at_jump.len(), "{mesh:?} {degree:?}: {found:?}");
        assert!(found.iter().zip(&at_jump).all(|(f, w)| (f - w).abs() < 1e-15), "{mesh:?} {degree:?}: {found:?}");
    }
}
