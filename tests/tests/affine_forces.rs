//! Body forces that are affine in the place: closed forms, other discretisations, and the estimate.

use steklov_study::reference::true_error;
use steklov_tests::{adapt, answer, finer, on_grid, parse, rotated, solved_in_steps, summary};

fn scene(text: &str) -> steklov_problem::Scene {
    parse(text, &[]).unwrap_or_else(|e| panic!("{}\n{text}", e.render()))
}

/// The force B (x - at) as a table.
fn force(slopes: [[f64; 2]; 2], at: [f64; 2]) -> String {
    let [x, y] = slopes.map(|row| format!("\"{}*(x - {}) + {}*(y - {})\"", row[0], at[0], row[1], at[1]));
    format!("[body_force]\nvalue = [{x}, {y}]\n")
}

/// A bar of the length L and the width w that turns about its root with ρω² = F, ν = 0: u = F (L² x/2 - x³/6)/E, cubic, and
/// J = -F² w L⁵/(15 E); drawn anywhere, in any direction and mirrored.
#[test]
fn a_rotating_bar_has_its_closed_form() {
    let (f, l, w, e) = (0.3, 2.0, 0.5, 10.0);
    for (angle, [x, y], mirror) in [(0.0, [0.0, 0.0], 1.0), (0.7, [3.0, -1.0], 1.0), (2.0, [-0.4, 5.0], -1.0)] {
        let at = |p: [f64; 2]| {
            let [a, b] = rotated([p[0], mirror * p[1]], angle);
            [a + x, b + y]
        };
        let mut corners = [[0.0, 0.0], [l, 0.0], [l, w], [0.0, w]].map(at);
        let mut sides = ["low", "end", "high", "root"];
        if mirror < 0.0 {
            corners.reverse();
            sides = ["high", "end", "low", "root"];
        }
        let (s, c) = f64::sin_cos(angle);
        let text = format!(
            "[body]\ncorners = {corners:?}\nsides = {sides:?}\n[material]\nyoung = {e}\npoisson = 0.0\n{}\
             [sides.root]\ndisplacement = [\"0\", \"0\"]\n[probe]\npoints = [{:?}, {:?}]\n\
             [method]\nrefine = \"none\"\nelements = 12\ndegree = 3\n",
            force([[f * c * c, f * c * s], [f * c * s, f * s * s]], [x, y]),
            at([1.0, 0.2]),
            at([1.7, 0.4]),
        );
        let told = summary(&scene(&text));
        let energy = -f * f * w * l.powi(5) / (15.0 * e);
        assert!((told.energy / energy - 1.0).abs() < 1e-11, "{angle}: {} of {energy}", told.energy);
        assert!((told.load_work / (-2.0 * energy) - 1.0).abs() < 1e-11, "{angle}: {}", told.load_work);
        let root = told.reactions["root"];
        let want = [c, s].map(|d| -0.5 * f * l * l * w * d);
        (0..2).for_each(|i| assert!((root[i] - want[i]).abs() < 1e-11, "{root:?} {want:?}"));
        for (probe, place) in told.probe.iter().zip([1.0, 1.7]) {
            let u = f * (l * l * place / 2.0 - place.powi(3) / 6.0) / e;
            let want = [u * c, u * s];
            (0..2).for_each(|i| assert!((probe.displacement[i] - want[i]).abs() < 1e-12, "{probe:?} {want:?}"));
            let stress = f * (l * l - place * place) / 2.0;
            assert!((probe.stress[0] + probe.stress[1] - stress).abs() < 1e-10, "{probe:?} {stress}");
        }
        assert!(told.estimate_relative.is_some_and(|e| e < 1e-10), "{:?}", told.estimate_relative);
    }
}

/// A column of two parts, or one, between smooth walls under the weight 12 (H - y): u_y = -2 (H³ - (H-y)³)/M and
/// J = -18 H⁵/(5M); its J within the bar that is told where the degree misses the cubic.
#[test]
fn a_column_under_growing_weight_has_its_closed_form() {
    let (young, nu, h) = (1000.0, 0.25, 2.0_f64);
    let m = young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let exact = -18.0 * h.powi(5) / (5.0 * m);
    let one = "[body]\ncorners = [[0, 0], [1, 0], [1, 2], [0, 2]]\nsides = [\"floor\", \"wall\", \"top\", \"wall\"]\n\
               [sides.floor]\ndisplacement = [\"free\", 0]\n[sides.wall]\ndisplacement = [0, \"free\"]\n";
    let walls = "[sides.low]\nfloor = { displacement = [\"free\", 0] }\nwall = { displacement = [0, \"free\"] }\n\
                 [sides.high]\nwall = { displacement = [0, \"free\"] }\n";
    let of_law = |law: &str| {
        format!(
            "[[body]]\nname = \"low\"\ncorners = [[0, 0], [1, 0], [1, 0.7], [0, 0.7]]\nsides = [\"floor\", \"wall\", \"top\", \"wall\"]\n\
             [[body]]\nname = \"high\"\ncorners = [[0, 0.7], [1, 0.7], [1, 2], [0, 2]]\nsides = [\"foot\", \"wall\", \"top\", \"wall\"]\n\
             {walls}[[interface]]\nbetween = [\"low.top\", \"high.foot\"]\n{law}\n"
        )
    };
    let touching =
        one.replace("displacement = [\"free\", 0]", "contact = { gap = \"0\", friction = { tresca = \"1\" } }");
    for (name, body) in [
        ("one", one.to_owned()),
        ("touching", touching),
        ("tied", of_law("tied = true")),
        ("in contact", of_law("contact = { gap = \"0\", friction = { coulomb = \"0.3\" } }")),
    ] {
        for degree in 1..=4 {
            let text = format!(
                "{body}[material]\nyoung = {young}\npoisson = {nu}\n[body_force]\nvalue = [\"0\", \"-12*(2-y)\"]\n\
                 [method]\nrefine = \"none\"\nelements = 16\ndegree = {degree}\n"
            );
            let told = summary(&scene(&text));
            let off = (told.energy / exact - 1.0).abs();
            let extrapolated = told.energy_extrapolated.expect("J");
            let bar = told.energy_uncertainty.expect("a bar");
            println!("{name} {degree}: {off:.1e}, {:.1e} with {bar:.1e}", extrapolated - exact);
            assert!(degree < 3 || off < 1e-10, "{name}, degree {degree}: {off:e}");
            assert!((extrapolated - exact).abs() <= bar, "{name}, degree {degree}: {extrapolated} ± {bar:e}");
        }
    }
}

/// A disc that turns, in plane strain: σ_r = k (R² - r²), k = (3+ν')/8 ρω², ν' = ν/(1-ν) (Timoshenko and Goodier, article 32), with a
/// skew force besides that a pull along the rim balances: u_θ = w (R² r - r³)/(8μ), which has the shear w r²/4 against d × b.
#[test]
fn a_rotating_disc_has_timoshenkos_stresses() {
    let (young, nu, radius, pull, twist) = (3.0, 0.3, 1.3_f64, 0.7, 0.4);
    let ([x, y], k) = ([0.4, -0.2], (3.0 + nu / (1.0 - nu)) / 8.0 * pull);
    let slopes = [[pull, -twist], [twist, pull]];
    // the couple of the force is -∮ r σ_rθ = ∫ w r²: σ_rθ = -w R²/4
    let shear = -twist * radius / 4.0;
    let text = format!(
        "[body]\ncircle = {{ centre = [{x}, {y}], radius = {radius} }}\nside = \"rim\"\n[material]\nyoung = {young}\npoisson = {nu}\n{}\
         [sides.rim]\ntraction = [\"{}*(y - {y})\", \"{shear}*(x - {x})\"]\n[probe]\npoints = [[{x}, {y}], [{}, {y}]]\n\
         [method]\ntolerance = 1e-10\nelements = 16\ndegree = 4\n",
        force(slopes, [x, y]),
        -shear,
        x + 0.8
    );
    let told = summary(&scene(&text));
    let off = nu / (1.0 - nu);
    let hoop = |r: f64| k * (radius.powi(2) - (1.0 + 3.0 * off) / (3.0 + off) * r * r);
    let want = [[k * radius.powi(2), hoop(0.0), 0.0], [k * (radius.powi(2) - 0.64), hoop(0.8), -twist * 0.64 / 4.0]];
    for (probe, want) in told.probe.iter().zip(want) {
        for (found, want) in probe.stress.iter().zip(want) {
            assert!((found - want).abs() < 1e-9, "{probe:?} {want}");
        }
    }
    assert!(told.converged);
}

/// Bilinear elements on finer and finer grids tend to the boundary elements, as h².
#[test]
fn grids_tend_to_boundary_elements() {
    let with = |more: &str| {
        format!(
            "[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"floor\", \"right\", \"top\", \"left\"]\n\
             [material]\nyoung = 5.0\npoisson = 0.3\n[body_force]\nvalue = [\"0.3*x - 0.2*y\", \"0.1 - 0.4*(y - 2*x)\"]\n\
             [sides.floor]\ndisplacement = [\"free\", 0]\n[sides.left]\ndisplacement = [0, \"free\"]\n\
             [sides.right]\ndisplacement = [0.01, \"free\"]\n{more}"
        )
    };
    let exact = summary(&scene(&with("[method]\ntolerance = 1e-8\n")));
    assert_eq!(exact.model, "bem");
    let errors: Vec<f64> = [4, 8, 16]
        .into_iter()
        .map(|cells| {
            let grid = format!("[grid]\ncoarse = [{}, {cells}]\nfine = [1, 1]\n", 2 * cells);
            let told = on_grid(&scene(&with(&format!("[method]\nmodel = \"fem\"\nrefine = \"none\"\n{grid}"))));
            for (side, reaction) in &told.reactions {
                let want = exact.reactions[side];
                (0..2).for_each(|i| assert!((reaction[i] - want[i]).abs() < 2e-2, "{side}: {reaction:?} {want:?}"));
            }
            told.energy - exact.energy
        })
        .collect();
    println!("{errors:?}");
    // and extrapolated from two grids
    assert!((errors[2] - (errors[1] - errors[2]) / 3.0).abs() < 0.01 * errors[2], "{errors:?}");
    for pair in errors.windows(2) {
        assert!((3.7..4.3).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

/// Reactions and contact take minus the integral of the force, in a body with a hole and curved sides, with either multiplier;
/// forces that are mirrored have the mirrored answer.
#[test]
fn what_holds_a_body_takes_the_whole_force() {
    for multiplier in ["biorthogonal", "stabilised"] {
        let told = |mirror: f64| {
            let corners = match mirror {
                1.0 => "[[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"floor\", \"right\", \"top\", \"left\"]",
                _ => "[[0, 0], [0, 1], [-2, 1], [-2, 0]]\nsides = [\"left\", \"top\", \"right\", \"floor\"]",
            };
            let text = format!(
                "[body]\ncorners = {corners}\n[[body.holes]]\ncircle = {{ centre = [{}, 0.6], radius = 0.2 }}\nside = \"hole\"\n\
                 [material]\nyoung = 5.0\npoisson = 0.3\n[body_force]\nvalue = [\"{}*(0.3 + 0.2*y) + 0.1*x\", \"-1 + {}*x - 0.4*y\"]\n\
                 [sides.floor]\ncontact = {{ gap = \"0\", friction = {{ tresca = \"0.02\" }} }}\n[sides.left]\ndisplacement = [0, \"free\"]\n\
                 [method]\ntolerance = 1e-3\nmultiplier = \"{multiplier}\"\n",
                mirror * 0.7,
                mirror,
                mirror * 0.1,
            );
            summary(&scene(&text))
        };
        let (told, other) = (told(1.0), told(-1.0));
        let (hole, area) = (std::f64::consts::PI * 0.04, 2.0);
        let (of_x, of_y) = (area * 1.0 - hole * 0.7, area * 0.5 - hole * 0.6);
        let force = [0.3 * (area - hole) + 0.2 * of_y + 0.1 * of_x, -(area - hole) + 0.1 * of_x - 0.4 * of_y];
        let contact = told.contact.as_ref().expect("contact").force;
        for i in 0..2 {
            let sum = told.reactions["left"][i] + contact[i];
            assert!((sum + force[i]).abs() < 1e-9, "{multiplier}: {sum} against {}", force[i]);
        }
        let bar = told.energy_uncertainty.expect("a bar") + other.energy_uncertainty.expect("a bar");
        let off = told.energy_extrapolated.expect("J") - other.energy_extrapolated.expect("J");
        println!("{multiplier}: {} dofs, J {} ± {bar:.1e}, mirrored {off:.1e}", told.dofs, told.energy);
        assert!(off.abs() <= bar, "{multiplier}: {off:e} {bar:e}");
    }
}

/// The estimate is near the true error from linear elements on, along straight and curved sides.
#[test]
fn the_estimate_is_near_the_error() {
    let material =
        "[material]\nyoung = 5.0\npoisson = 0.3\n[body_force]\nvalue = [\"0.3*x - 2*y\", \"-1 + 1.5*x - 0.4*y\"]\n";
    for (name, body) in [
        (
            "trapezium",
            "[body]\ncorners = [[0, 0], [2, 0], [1.5, 1], [0, 1]]\nsides = [\"floor\", \"right\", \"top\", \"left\"]\n\
             [sides.left]\ndisplacement = [0, 0]\n",
        ),
        (
            "lens",
            "[body]\ncorners = [[0.68, 0.48], [-0.63, -0.35]]\nsides = [\"held\", \"loaded\"]\n\
             arcs = [{ edge = 0, bulge = 0.9 }]\ncurves = [{ edge = 1, control = [[-0.2, -0.8], [0.7, -0.4]] }]\n\
             [sides.held]\ndisplacement = [\"0.1*y\", \"-0.1*x\"]\n",
        ),
    ] {
        let scene = scene(&format!("{body}{material}[method]\nmax_dofs = 400\ntolerance = 1e-7\n"));
        let (run, displacements) = solved_in_steps(&scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let fine = finer(&scene, 900).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut measured = 0;
        for (k, (step, displacement)) in run.progress.steps.iter().zip(&displacements).enumerate() {
            let truth =
                true_error(&scene, &step.layout.mesh, displacement, &fine).unwrap_or_else(|e| panic!("{name}: {e}"));
            let ratio = step.estimate().error / truth.error;
            println!(
                "{name} {k}: {} dofs, {:.1e}, {ratio:.2}, {:?}",
                step.dofs,
                truth.error / truth.norm,
                step.estimate().doubts
            );
            if step.estimate().doubts.is_empty() && truth.error > 1e-6 * truth.norm {
                measured += 1;
                assert!((0.8..if k < 4 { 4.0 } else { 1.4 }).contains(&ratio), "{name}, step {k}: {ratio}");
            }
        }
        assert!(measured >= 3, "{name}");
    }
}

/// J of coarse meshes of low degree lies within its bar: held arcs miss a part of the cubic displacement.
#[test]
fn energies_are_within_their_bars_on_held_curves() {
    let told = |more: &str| {
        summary(&scene(&format!(
            "[body]\ncorners = [[0.68, 0.48], [-0.63, -0.35]]\nsides = [\"held\", \"loaded\"]\n\
             arcs = [{{ edge = 0, bulge = 0.9 }}]\ncurves = [{{ edge = 1, control = [[-0.2, -0.8], [0.7, -0.4]] }}]\n\
             [material]\nyoung = 1.0\npoisson = 0.2\n[sides.held]\ndisplacement = [\"0.1*y\", \"-0.1*x\"]\n\
             [sides.loaded]\npressure = \"0.1*cos(3*s)\"\n[body_force]\nvalue = [\"0.2*y\", \"0.3*x - 0.1\"]\n[method]\n{more}\n"
        )))
    };
    let exact = told("tolerance = 1e-6").energy_extrapolated.expect("J");
    for more in ["tolerance = 1e-3", "tolerance = 1e-4"] {
        let told = told(more);
        let (off, bar) = (told.energy_extrapolated.expect("J") - exact, told.energy_uncertainty.expect("a bar"));
        println!("{more}: {off:.1e} with {bar:.1e}");
        assert!(off.abs() < bar, "{more}: {off:e} {bar:e}");
    }
}

/// Twice J, the strain energy and the loads' work agree where supports do not move (Clapeyron).
#[test]
fn half_of_the_work_is_strain_energy() {
    let text = "[body]\ncorners = [[1, -3], [3, -2.5], [2.5, -1], [1, -2]]\nsides = [\"low\", \"far\", \"high\", \"wall\"]\n\
                [material]\nyoung = 10.0\npoisson = 0.3\n[body_force]\nvalue = [\"y - 2*x\", \"0.4*x + 3*y\"]\n\
                [sides.wall]\ndisplacement = [\"0\", \"0\"]\n[sides.far]\ntraction = [\"0.1\", \"-0.2*s\"]\n[method]\ntolerance = 1e-4\n";
    let found = adapt(&scene(text)).unwrap_or_else(|e| panic!("{e}")).last.energies;
    assert!((found.strain / (0.5 * found.load_work) - 1.0).abs() < 1e-6, "{found:?}");
    assert!((found.total / (-0.5 * found.load_work) - 1.0).abs() < 1e-6, "{found:?}");
    // and a force that is written as an affine one without slopes is the constant one
    let constant = text.replace("y - 2*x", "3").replace("0.4*x + 3*y", "-1");
    let affine = text.replace("y - 2*x", "3 + 0*x").replace("0.4*x + 3*y", "y - y - 1");
    let [a, b] = [constant, affine].map(|text| answer(&scene(&text)).solved.energies);
    assert_eq!(a.total.to_bits(), b.total.to_bits());
}
