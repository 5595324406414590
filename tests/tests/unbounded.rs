//! Holes in an unbounded medium: closed forms, and answers that must be those of another way to ask.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use steklov_bem_operators::{BemError, Mesh, PairCache};
use steklov_model::error::SolveError;
use steklov_model::solve::one_mesh::solve;
use steklov_problem::Scene;
use steklov_tests::{adapt, parse, scene, summary};

/// A scene with holes in the plane: corners and the side names of each.
fn text(holes: &[(&[[f64; 2]], &str)], exterior: &str, rest: &str) -> String {
    let mut text = String::new();
    for (k, (corners, name)) in holes.iter().enumerate() {
        let table = if k == 0 { "[body]" } else { "[[body.holes]]" };
        let _ = writeln!(text, "{table}\ncorners = {corners:?}\nsides = {:?}", vec![name; corners.len()]);
    }
    let _ = write!(text, "[exterior]\nyoung = 8.0\npoisson = 0.3\n{exterior}\n{rest}");
    text
}

const MU: f64 = 8.0 / 2.6;

fn read(text: &str) -> Scene {
    parse(text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

fn ring(n: usize) -> Vec<[f64; 2]> {
    (0..n).map(|k| TAU * k as f64 / n as f64).map(|a| [a.cos(), a.sin()]).collect()
}

const SQUARE: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Remote stress is the same as tractions -σ_∞n on the holes, but for u_∞ = ε_∞ x: energies, estimates and what is added are
/// the same to the last digits, on every mesh of a run.
#[test]
fn remote_stress_is_a_traction_and_a_uniform_strain() {
    let other = [[2.5, 0.0], [3.5, 0.2], [3.0, 1.5]];
    let holes: [(&[[f64; 2]], &str); 2] = [(&SQUARE, "square"), (&other, "triangle")];
    let probe =
        "[probe]\npoints = [[0, 3], [1.8, 0.5], [1, 0.25]]\n[method]\nrefine = \"uniform-h\"\ntolerance = 0.1\n";
    let stressed = summary(&read(&text(&holes, "remote_stress = [-1.0, -2.5, 0.7]", probe)));
    // tractions are constants on an edge: a side for each
    let mut loads = String::new();
    let mut body = text(&holes, "", "");
    for (name, corners) in [("square", &SQUARE[..]), ("triangle", &other)] {
        let names: Vec<String> = (0..corners.len()).map(|k| format!("{name}{k}")).collect();
        body = body.replace(&format!("{:?}", vec![name; corners.len()]), &format!("{names:?}"));
        for (k, a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            // listed counter-clockwise: n into the hole is the edge turned by +90 degrees
            let n = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
            let t = [n[0] - 0.7 * n[1], -0.7 * n[0] + 2.5 * n[1]];
            let _ = writeln!(loads, "[sides.{}]\ntraction = [{:?}, {:?}]", names[k], t[0], t[1]);
        }
    }
    let loaded = summary(&read(&format!("{body}{loads}{probe}")));
    assert_eq!((stressed.dofs, stressed.steps, stressed.converged), (loaded.dofs, loaded.steps, true));
    assert!(stressed.steps > 2);
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-10 * b.abs().max(1e-3), "{a} {b}");
    for (a, b) in [
        (stressed.energy, loaded.energy),
        (stressed.strain_energy, loaded.strain_energy),
        (stressed.load_work, loaded.load_work),
        (stressed.estimate.unwrap(), loaded.estimate.unwrap()),
    ] {
        close(a, b);
    }
    close(stressed.energy_extrapolated.unwrap(), loaded.energy_extrapolated.unwrap());
    // plane strain: ε_xx = ((1-ν)σ_xx - νσ_yy)/2μ
    let strain = |a: f64, b: f64| (0.7 * a - 0.3 * b) / (2.0 * MU);
    let (xx, yy, xy) = (strain(-1.0, -2.5), strain(-2.5, -1.0), 0.7 / (2.0 * MU));
    for (a, b) in stressed.probe.iter().zip(&loaded.probe) {
        let [x, y] = a.point;
        close(a.displacement[0], b.displacement[0] + xx * x + xy * y);
        close(a.displacement[1], b.displacement[1] + xy * x + yy * y);
        for (i, remote) in [-1.0, -2.5, 0.7].into_iter().enumerate() {
            assert!((a.stress[i] - b.stress[i] - remote).abs() < 1e-8, "{a:?} {b:?}");
        }
    }
    let exterior = stressed.exterior.expect("what happens far away");
    assert!(exterior.balanced && exterior.radiation == "decaying" && exterior.constant == [0.0; 2]);
}

/// Balanced loads: bounded at infinity is the decaying answer but for a translation, and does not know the unit of length.
/// Loads that are not balanced have an answer only with a displacement that may grow, or with supports.
#[test]
fn translations_are_free_where_the_displacement_is_bounded() {
    let sides = ["floor", "right", "roof", "left"];
    let body = |exterior: &str, rest: &str| {
        let text = text(&[(&SQUARE, "x")], exterior, rest);
        text.replace(&format!("{:?}", ["x"; 4]), &format!("{sides:?}"))
    };
    let method = "[probe]\npoints = [[0, 3], [2, 0.3]]\n[method]\nrefine = \"none\"\nelements = 24\ndegree = 3\n";
    let balanced = "[sides.floor]\ntraction = [\"0.5\", \"-3\"]\n[sides.roof]\ntraction = [\"-0.5\", \"3*(1+x)\"]\n";
    let bounded = "at_infinity = \"bounded\"";
    let decaying = summary(&read(&body("", &format!("{balanced}{method}"))));
    let free = summary(&read(&body(bounded, &format!("{balanced}{method}"))));
    assert!((decaying.energy - free.energy).abs() < 1e-11 * free.energy.abs());
    let shift = |k: usize| [0, 1].map(|i| free.probe[k].displacement[i] - decaying.probe[k].displacement[i]);
    let constant = free.exterior.as_ref().expect("what happens far away").constant;
    for k in 0..2 {
        assert!((0..2).all(|i| (shift(k)[i] - constant[i]).abs() < 1e-11), "{:?} {constant:?}", shift(k));
        assert!((0..3).all(|i| (free.probe[k].stress[i] - decaying.probe[k].stress[i]).abs() < 1e-9));
    }
    assert!(constant[0].hypot(constant[1]) > 1e-3, "{constant:?}");

    let pushed = format!("[sides.roof]\ntraction = [\"0\", \"3\"]\n{method}");
    let error = adapt(&read(&body(bounded, &pushed))).err().expect("nothing holds it");
    let SolveError::Bem(BemError::RigidMotion { modes, work, .. }) = &error else { panic!("{error}") };
    assert!(modes.len() == 2 && modes.iter().all(|m| m.rotation == 0.0) && (work - 6.0).abs() < 1e-9, "{error}");
    let grows = summary(&read(&body("", &pushed))).exterior.expect("what happens far away");
    assert!(!grows.balanced && (grows.resultant[1] - 6.0).abs() < 1e-9 && grows.resultant[0].abs() < 1e-9, "{grows:?}");
    // with a support the whole load is its reaction
    let held = format!("[sides.floor]\ndisplacement = [\"0\", \"0\"]\n{pushed}");
    let held = summary(&read(&body(bounded, &held)));
    let [x, y] = held.reactions["floor"];
    assert!((y + 6.0).abs() < 1e-9 && x.abs() < 1e-9 && held.exterior.expect("far away").balanced);
}

/// A slit under tension across it: Griffith's energy -πσ²a²/E', of a rectangular hole 1e-5 high.
#[test]
fn a_slit_in_the_stretched_plane_releases_griffiths_energy() {
    let slit = [[-1.0, 0.0], [1.0, 0.0], [1.0, 1e-5], [-1.0, 1e-5]];
    let scene = read(&text(&[(&slit, "slit")], "remote_stress = [0, 2, 0]", "[method]\ntolerance = 1e-3\n"));
    let found = summary(&scene);
    let exact = -PI * 4.0 / (8.0 / 0.91);
    println!("{} dofs: {:.8} for {exact:.8}, estimate {:?}", found.dofs, found.energy, found.estimate_relative);
    assert!(found.converged && (found.energy / exact - 1.0).abs() < 1e-4);
}

/// A rigid core of radius a - g in a hole of radius a under pressure p all around: it closes by (1-ν)pa/μ - g less what the
/// core's pressure q = (2μ/a)((1-ν)pa/μ - g) holds up.
#[test]
fn a_hole_that_closes_on_a_rigid_core() {
    let (p, gap) = (0.4, 0.05);
    let free = 0.7 * p / MU;
    let pressure = 2.0 * MU * (free - gap);
    assert!(free > 1.5 * gap);
    let mut errors = Vec::new();
    for n in [32, 64] {
        let contact = format!(
            "[sides.hole]\ncontact = {{ gap = \"{gap}\" }}\n[method]\nrefine = \"none\"\nelements = {n}\n[probe]\npoints = [[2, 0]]\n"
        );
        let corners = ring(n);
        let text = text(&[(&corners, "hole")], &format!("remote_stress = [-{p}, -{p}, 0]"), &contact);
        let found = summary(&read(&text));
        let contact = found.contact.expect("contact");
        // σ_rr = -p + (p - q)/r², the hole as if under q
        let radial = (found.probe[0].stress[0] + p - (p - pressure) / 4.0).abs();
        let length = 2.0 * n as f64 * (PI / n as f64).sin();
        assert!((contact.length - length).abs() < 1e-9 && contact.force[0].hypot(contact.force[1]) < 1e-9);
        errors.push([(contact.max_pressure / pressure - 1.0).abs(), radial]);
    }
    println!("{errors:?}");
    assert!((0..2).all(|k| errors[1][k] < 5e-3 && errors[0][k] / errors[1][k] > 2.5), "{errors:?}");
    // wider than the hole closes: no contact
    let corners = ring(32);
    let contact = format!("[sides.hole]\ncontact = {{ gap = \"{}\" }}\n[method]\nrefine = \"none\"\n", 1.2 * free);
    let apart = summary(&read(&text(&[(&corners, "hole")], &format!("remote_stress = [-{p}, -{p}, 0]"), &contact)));
    assert!(apart.contact.expect("contact").length == 0.0);
}

/// The tunnel's energy on a geometric mesh with rising degrees, and the estimated errors of the adaptive ones against it.
#[test]
fn the_tunnels_energy_by_geometric_meshes_and_its_estimated_error() {
    let tunnel = scene("tunnel", &[]);
    let expected = tunnel.expect.iter().find(|e| e.path == "energy").expect("its energy").value;
    let towards: Vec<(usize, f64)> = (0..4).map(|k| (k, 0.0)).collect();
    let mesh = Mesh::graded(&tunnel.problem.outline, &towards, 16, 0.17, |layer| 2 + layer).expect("a mesh");
    let (solved, ..) =
        solve(&tunnel, (mesh, None), false, &mut PairCache::default(), &mut |_| Ok(())).expect("an answer");
    let energy = solved.energies.total;
    assert!((energy / expected - 1.0).abs() < 3e-10, "{energy} {expected}");
    let run = adapt(&tunnel).expect("an answer");
    let mut judged = 0;
    for step in &run.progress.steps {
        // J_h > J, and twice the difference is the squared error
        let error = (2.0 * (step.energy - expected)).abs().sqrt();
        let estimate = step.estimate().error;
        println!("{} dofs: error {error:.3e}, estimate {estimate:.3e}, ratio {:.3}", step.dofs, estimate / error);
        if error > 1e-4 * (2.0 * expected.abs()).sqrt() {
            judged += 1;
            assert!((0.7..1.4).contains(&(estimate / error)), "{error:e} {estimate:e}");
        }
    }
    assert!(judged > 4);
}

/// Metres or millimetres, holes listed in either order, in another order of holes: the same numbers.
#[test]
fn neither_unit_nor_order_matters() {
    let other = [[2.5, 0.0], [3.5, 0.2], [3.0, 1.5]];
    let of = |scale: f64, flip: bool| {
        let mut holes =
            [SQUARE.to_vec(), other.to_vec()].map(|l| l.iter().map(|x| x.map(|c| scale * c)).collect::<Vec<_>>());
        if flip {
            holes.reverse();
            holes[0].reverse();
        }
        let names = if flip { ["b", "a"] } else { ["a", "b"] };
        let method = format!(
            "[probe]\npoints = [[{0}, {0}]]\n[method]\nrefine = \"none\"\nelements = 30\ndegree = 2\n",
            2.0 * scale
        );
        let exterior = format!("remote_stress = [{}, 0, 0]", 1.0 / scale / scale);
        let holes: Vec<_> = holes.iter().map(Vec::as_slice).zip(names).collect();
        let pressed = format!("[sides.b]\npressure = \"{}\"\n{method}", 0.3 / scale / scale);
        let text =
            text(&holes, &exterior, &pressed).replace("young = 8.0", &format!("young = {}", 8.0 / scale / scale));
        summary(&read(&text))
    };
    let one = of(1.0, false);
    for (scale, flip) in [(1000.0, false), (1.0, true), (1e-3, true)] {
        let found = of(scale, flip);
        assert!((found.energy - one.energy).abs() < 1e-11 * one.energy.abs(), "{scale} {flip}: {}", found.energy);
        let [u, v] = [&found, &one].map(|s| s.probe[0].displacement);
        assert!((0..2).all(|i| (u[i] / scale - v[i]).abs() < 1e-11), "{u:?} {v:?}");
    }
}
