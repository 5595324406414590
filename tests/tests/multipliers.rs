//! Stabilised multipliers beside biorthogonal ones: the same answers, on any mesh of the multipliers, and what happens without
//! stabilisation.

use steklov_contact::{ContactError, MultiplierDegree, MultiplierMesh};
use steklov_model::answer::report::contact_summary;
use steklov_model::error::SolveError;
use steklov_model::solve::contact_rows::contact_rows;
use steklov_model::solve::solution::Solved;
use steklov_problem::{Multiplier, Refine, Scene};
use steklov_quadrature::gauss_legendre;
use steklov_tests::{adapt, answer, gallery, line, parse, scene};

fn stabilised(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.method.multiplier = Multiplier::Stabilised;
    scene
}

/// Every scene with contact reaches its tolerance with the default γ, at the energy that its file knows, the energy, the stick and
/// the force of biorthogonal multipliers and, where it is finite, their largest pressure. Scenes with random input are left out: J is a mean there;
/// so are several bodies, which have biorthogonal multipliers only.
#[test]
fn every_scene_of_the_gallery_is_solved() {
    let mut judged = 0;
    let one = |s: &Scene| !s.problem.has_several_bodies() && s.random.is_none() && s.contacts().next().is_some();
    // whose ridge by points is that of the wedge gap
    let again = |name: &str| name.starts_with("75-");
    for (name, scene) in gallery().into_iter().filter(|(name, scene)| one(scene) && !again(name)) {
        let [a, b] = [scene.clone(), stabilised(&scene)].map(|s| adapt(&s).unwrap_or_else(|e| panic!("{name}: {e}")));
        let [x, y] = [&a, &b].map(|run| (run.step().energy, run.step().estimate.as_ref().map_or(0.0, |e| e.relative)));
        let off = ((x.0 - y.0) / x.0).abs();
        println!(
            "{name:24} {:4} and {:4} dofs, J off by {off:.1e}, estimates {:.1e} {:.1e}",
            a.step().dofs,
            b.step().dofs,
            x.1,
            y.1
        );
        assert!(b.converged() == a.converged(), "{name}: {:?}", b.reason);
        // stabilised multipliers let u_n exceed the gap a little, to which J is of first order
        let allowed = match name.as_str() {
            "26-ssnv128" => 7e-7,
            _ if scene.method.refine == Refine::None => 1e-11,
            _ => 1e-7,
        };
        assert!(off <= allowed, "{name}: {off:e} {allowed:e}");
        for known in scene.expect.iter().filter(|e| e.path == "energy") {
            let error = (y.0 - known.value).abs();
            assert!(error <= known.tol, "{name}: J is {}, off by {error:e} of {:e}", y.0, known.tol);
            judged += 1;
        }
        let [x, y] = [&a, &b].map(|run| {
            let contact = run.last.contact.as_ref().expect("contact");
            contact_summary(&scene, run.last.trace(), contact, &contact_rows(run.last.trace(), contact), None)
        });
        let force = |f: [f64; 2]| f[0].hypot(f[1]);
        let apart = [
            (x.stick - y.stick).abs() / x.length.max(f64::MIN_POSITIVE),
            (x.max_pressure - y.max_pressure).abs() / x.max_pressure.max(f64::MIN_POSITIVE),
            force([x.force[0] - y.force[0], x.force[1] - y.force[1]]) / force(x.force).max(f64::MIN_POSITIVE),
        ];
        // a mesh of a few elements has no more than a tenth of its floor to each node
        let [stick, force_off] = if a.step().dofs > 100 { [0.01, 1e-4] } else { [0.1, 3e-3] };
        let [_, pressure, _] = apart;
        assert!(apart[0] < stick && apart[2] < force_off, "{name}: {apart:?}");
        assert!(x.max_pressure_unbounded || pressure < 3e-3, "{name}: {apart:?}");
        let contact = b.last.contact.as_ref().expect("contact");
        assert!(
            contact.stabilised.as_ref().is_some_and(|s| s.gamma < 0.51 * s.critical && s.gamma > 0.49 * s.critical)
        );
    }
    assert!(judged >= 10, "{judged} energies are known");
}

/// J of the wedge gap, thirteen digits by several adaptive meshes of biorthogonal multipliers.
#[test]
fn both_multipliers_converge_to_the_energy_of_the_wedge() {
    for multiplier in [Multiplier::Biorthogonal, Multiplier::Stabilised] {
        let mut wedge = scene("wedge-gap", &["method.tolerance=1e-4"]);
        wedge.method.multiplier = multiplier;
        let energy = adapt(&wedge).expect("it is solved").step().energy;
        println!("{multiplier:?}: {energy:.12}");
        assert!((energy - 0.647_194_015_986_9).abs() < 1e-6 * energy, "{multiplier:?}: {energy}");
    }
}

/// Coulomb friction: displacements of the floor to five digits by two kinds of multipliers.
#[test]
fn ssnv128_has_the_digits_of_both_multipliers() {
    let scene = scene("ssnv128", &["method.tolerance=3e-6"]);
    let floor = |scene: &Scene| -> Vec<f64> {
        let last = adapt(scene).expect("it is solved").last;
        let at = |x: f64| {
            let s = x / 40.0;
            let inside =
                |e: &usize| last.mesh.edge[*e] == 0 && last.mesh.span[*e][0] <= s && s <= last.mesh.span[*e][1];
            let e = (0..last.mesh.len()).find(inside).expect("an element of the floor");
            let [a, b] = last.mesh.span[e];
            last.field.trace(e, 2.0 * (s - a) / (b - a) - 1.0).displacement[0]
        };
        [0.0, 1.25, 5.0, 7.5, 11.25].map(at).to_vec()
    };
    for (a, b) in floor(&scene).into_iter().zip(floor(&stabilised(&scene))) {
        println!("{a:.7e} {b:.7e}");
        assert!((a - b).abs() < 1e-5 * a.abs(), "{a} {b}");
    }
}

/// ‖(h/p²)^½ (λ_n - λ_ref)‖ of uniform meshes against an adaptive solution.
fn pressure_errors(scene: &Scene, fine: &Solved, elements: &[usize]) -> Vec<f64> {
    let reference = fine.contact.as_ref().and_then(|c| c.stabilised.as_ref()).expect("stabilised");
    let error = |n: usize| {
        let mut scene = stabilised(scene);
        (scene.method.refine, scene.method.elements) = (Refine::None, Some(n));
        let solved = answer(&scene).solved;
        let s = solved.contact.as_ref().and_then(|c| c.stabilised.as_ref()).expect("stabilised");
        let mut sum = 0.0;
        for cell in s.space.cells(&solved.mesh) {
            let (e, mesh) = (cell.element, &solved.mesh);
            for part in 0..8 {
                let at = |k: usize| cell.span[0] + (cell.span[1] - cell.span[0]) * k as f64 / 8.0;
                let rule = gauss_legendre(6).mapped(at(part), at(part + 1));
                for (&t, &w) in rule.points.iter().zip(&rule.weights) {
                    let position = mesh.edge_parameter(e, t);
                    let found = s.space.value(cell.multiplier, position, &s.solution.multipliers)[0];
                    let own = |m: &&steklov_contact::MultiplierElement| {
                        m.edge == mesh.edge[e] && m.span[0] <= position && position <= m.span[1]
                    };
                    let place = reference.space.elements.iter().position(|m| own(&m)).expect("an element");
                    let exact = reference.space.value(place, position, &reference.solution.multipliers)[0];
                    let h = mesh.length(e);
                    sum += w * h / 2.0 * h / (mesh.degree[e] as f64).powi(2) * (found - exact).powi(2);
                }
            }
        }
        sum.sqrt()
    };
    elements.iter().map(|&n| error(n)).collect()
}

/// The pressure on a parabola has roots at its ends: λ_n is of order just below 1, and the error falls like h^(3/2). Multiplier
/// meshes finer than the displacement's are unstable by themselves: without stabilisation pressures that no displacement
/// sees take what the parabola leaves over its interpolant.
#[test]
fn mismatched_multipliers_converge_with_stabilisation_only() {
    let elements = [32, 64, 128, 256];
    let sizes: Vec<f64> = elements.iter().map(|&n| (n as f64).ln()).collect();
    let block = scene("block-on-floor", &["sides.floor.contact.gap=\"0.1*x^2\""]);
    let mut fine = stabilised(&block);
    (fine.method.refine, fine.method.tolerance, fine.method.gamma) = (Refine::Hp, Some(1e-5), None);
    (fine.method.multiplier_mesh, fine.method.multiplier_degree) =
        (MultiplierMesh::Same, MultiplierDegree::Relative(0));
    let fine = adapt(&fine).expect("it is solved").last;
    for (mesh, degree) in [
        (MultiplierMesh::Same, MultiplierDegree::Relative(0)),
        (MultiplierMesh::Finer(2), MultiplierDegree::Relative(0)),
        (MultiplierMesh::Shifted, MultiplierDegree::Relative(0)),
        (MultiplierMesh::Same, MultiplierDegree::ContinuousLinear),
    ] {
        let mut block = block.clone();
        (block.method.multiplier_mesh, block.method.multiplier_degree) = (mesh, degree);
        let errors = pressure_errors(&block, &fine, &elements);
        let (rate, _) = line(&sizes, &errors.iter().map(|e| e.ln()).collect::<Vec<f64>>());
        println!("{mesh:?} {degree:?}: rate {:.2} of {errors:?}", -rate);
        assert!((1.2..1.9).contains(&-rate), "{mesh:?} {degree:?}: {rate}");
        if mesh == MultiplierMesh::Finer(2) {
            block.method.gamma = Some(1e-5 / block.body().material().young);
            let without = pressure_errors(&block, &fine, &elements[..2]);
            println!("without: {without:?}");
            assert!(without[1] > 5.0 * errors[1], "{without:?} {errors:?}");
        }
    }
}

/// γ₀ 5 % beyond its critical value is refused with both numbers, 5 % below it is solved.
#[test]
fn gamma_beyond_the_critical_value_is_refused() {
    let mut wedge = stabilised(&scene("wedge-gap", &["method.refine=\"none\"", "method.degree=2"]));
    let critical = {
        let solved = answer(&wedge).solved;
        solved.contact.as_ref().and_then(|c| c.stabilised.as_ref()).expect("stabilised").critical
    };
    wedge.method.gamma = Some(1.05 * critical);
    match adapt(&wedge) {
        Err(SolveError::Contact(ContactError::StabilisationNotCoercive { gamma, critical: found })) => {
            assert!(gamma == 1.05 * critical && (found / critical - 1.0).abs() < 1e-12);
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("it was solved"),
    }
    wedge.method.gamma = Some(0.95 * critical);
    assert!(adapt(&wedge).expect("it is solved").converged());
}

/// A block pressed onto a parabola as ν → ½: the largest pressure is that of biorthogonal multipliers.
#[test]
fn nearly_incompressible_bodies_keep_their_pressure() {
    for (poisson, want, near) in
        [("0.3", 18.74, 0.05), ("0.499", 19.01, 3e-3), ("0.4999", 19.01, 3e-3), ("0.49999", 19.01, 3e-3)]
    {
        let block = scene(
            "block-on-floor",
            &[
                "sides.floor.contact.gap=\"0.1*x^2\"",
                &format!("material.poisson={poisson}"),
                "method.refine=\"none\"",
                "method.elements=128",
                "method.degree=2",
            ],
        );
        let [a, b] = [block.clone(), stabilised(&block)].map(|s| answer(&s));
        let [x, y] = [&a, &b].map(|a| a.rows.iter().fold(0.0f64, |m, r| m.max(r.pressure)));
        let energies = [&a, &b].map(|a| a.solved.energies.total);
        let contact = b.solved.contact.as_ref().and_then(|c| c.stabilised.as_ref()).expect("stabilised");
        let critical = contact.critical * block.body().material().young;
        println!("ν = {poisson}: {x:.3} {y:.3}, critical γ₀E {critical:.3}, J {energies:?}");
        assert!((x - want).abs() < 0.02 && (y - x).abs() < near * x, "ν = {poisson}: {x} {y}");
        assert!((0.4..1.2).contains(&critical), "ν = {poisson}: {critical}");
        assert!((energies[0] / energies[1] - 1.0).abs() < 5e-5, "ν = {poisson}: {energies:?}");
    }
}

/// Weight sideways and a squeeze between smooth walls: u is quadratic, λ_n linear, and both in the spaces of degree 2, whatever
/// the mesh of the multipliers.
#[test]
fn a_body_force_is_met_by_any_multipliers() {
    for mesh in ["same", "shifted", "coarser", "finer"] {
        for degree in ["\"auto\"", "1", "\"continuous\"", "4"] {
            let text = format!(
                r#"
[body]
corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["floor", "right", "top", "left"]
[material]
young = 1.0
poisson = 0.3
[body_force]
value = ["0.01", "0"]
[sides]
floor = {{ contact = {{ gap = "-0.01" }} }}
right = {{ displacement = ["0", "free"] }}
left = {{ displacement = ["0", "free"] }}
top = {{ displacement = ["free", "0"] }}
[method]
refine = "none"
elements = 16
degree = 2
multiplier = "stabilised"
multiplier_mesh = "{mesh}"
multiplier_degree = {degree}
"#
            );
            let found = answer(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render())));
            // u_x = b x (1-x)/(2M), u_y = 0.01 (1-y), M = λ+2μ
            let (wave, lambda) = (0.7 / (1.3 * 0.4), 0.3 / (1.3 * 0.4));
            let mut worst = 0.0f64;
            for row in &found.rows {
                let want = wave * 0.01 - lambda * 0.01 / (2.0 * wave) * (1.0 - 2.0 * row.point[0]);
                worst = worst.max((row.pressure - want).abs()).max(row.shear.abs());
            }
            println!("{mesh} {degree}: {worst:.1e}");
            assert!(!found.rows.is_empty() && worst < 2e-14, "{mesh} {degree}: {worst:e}");
        }
    }
}

/// Multipliers of a degree of their own, lower than the displacement's, limit the accuracy where it is high: these elements are
/// halved, and the tolerance is reached.
#[test]
fn refinement_follows_the_multipliers() {
    for (name, degree) in [("wedge-gap", "0"), ("block-on-floor", "0"), ("hertz-block", "\"continuous\"")] {
        let scene = scene(
            name,
            &[
                "method.tolerance=2e-3",
                "method.max_dofs=900",
                "method.multiplier=\"stabilised\"",
                &format!("method.multiplier_degree={degree}"),
            ],
        );
        let run = adapt(&scene).expect("it is solved");
        let relative = run.step().estimate().relative;
        println!("{name} {degree}: {} dofs, {relative:.1e}", run.step().dofs);
        assert!(run.converged() && relative < 2e-3, "{name} {degree}: {:?} {relative:e}", run.reason);
    }
}
