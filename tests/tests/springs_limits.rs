//! Springs on sides that are much stiffer or softer than the body.

use steklov_model::doubt::Doubt;
use steklov_model::run::adaptive_loop::Reason;

use crate::on_springs::{block, close, force, solved};

/// Stiff springs tend to a held side, J from below with 1/k; soft ones to a free side, J from above with k.
#[test]
fn limits_of_stiff_and_soft_springs() {
    let energy = |floor: &str, rest: &str| {
        let run =
            solved(&block(&format!("{floor}sides.top.traction = [1, \"-1-x\"]\n{rest}method.tolerance = 1e-5\n")));
        run.step().estimate().energy
    };
    let held = energy("sides.floor.displacement = [0, 0]\n", "");
    let mut before = f64::NAN;
    for k in ["1e6", "1e7", "1e8", "1e10", "1e13"] {
        let off = energy(&format!("sides.floor.springs = \"{k}\"\n"), "") - held;
        println!("k = {k}: J less that of the held side {off:e}, {}", before / off);
        if k == "1e7" || k == "1e8" {
            assert!((before / off - 10.0).abs() < 0.15, "{}", before / off);
        }
        assert!(off < 1e-10);
        before = off;
    }
    assert!(before.abs() < 1e-10 * held.abs());
    let left = "sides.left.displacement = [0, 0]\n";
    let free = energy("", left);
    let mut before = f64::NAN;
    for k in ["1e-2", "1e-3", "1e-4", "1e-9"] {
        let off = energy(&format!("sides.floor.springs = \"{k}\"\n"), left) - free;
        println!("k = {k}: J less that of the free side {off:e}, {}", before / off);
        if k == "1e-3" || k == "1e-4" {
            assert!((before / off - 10.0).abs() < 0.05, "{}", before / off);
        }
        assert!(off > -1e-9);
        before = off;
    }
    assert!(before.abs() < 1e-9 * free.abs());
}

/// The block turned by 0.4 with stiff springs along the normal and soft ones along the floor, on which it slides far: forces have
/// the digits that k leaves of d·u, or the run ends as one whose forces do not balance.
#[test]
fn stiff_normals_of_turned_sides() {
    let (s, c) = 0.4f64.sin_cos();
    let at = |x: f64, y: f64| format!("[{:?},{:?}]", c * x - s * y, s * x + c * y);
    let turned = [at(0.0, 0.0), at(2.0, 0.0), at(2.0, 1.0), at(0.0, 1.0)].join(",");
    let text = |corners: &str, k: f64, [x, y]: [f64; 2]| {
        format!(
            "body.corners = [{corners}]\nbody.sides = [\"floor\",\"right\",\"top\",\"left\"]\n\
             material = {{ young = 100.0, poisson = 0.3, plane = \"stress\" }}\n\
             sides.floor.springs = {{ normal = \"{k:e}\", tangential = \"1\" }}\n\
             sides.top.traction = [\"{x:?}\", \"{y:?}\"]\nmethod.tolerance = 1e-4\n"
        )
    };
    for k in [1e3, 1e6, 1e8, 1e10, 4e10] {
        let plain = solved(&text("[0,0],[2,0],[2,1],[0,1]", k, [1.0, -1.0]));
        let run = solved(&text(&turned, k, [c + s, s - c]));
        assert!(plain.last.equilibrium < 1e-12 && plain.reason == Reason::Tolerance);
        let [x, y] = force(&run, "floor");
        let off = (c * x + s * y + 2.0).hypot(c * y - s * x - 2.0);
        println!("k = {k:e}: forces off by {off:.1e}, {:?}, {:.1e}", run.reason, run.last.equilibrium);
        assert!(off < 1e-12 + 1e-16 * k);
        if run.reason == Reason::Tolerance {
            close(run.last.energies.strain, plain.last.energies.strain, 1e-8, "strain energy");
            close(run.last.energies.total, plain.last.energies.total, 1e-9, "J");
        } else {
            assert!(run.reason == Reason::Solver && run.last.equilibrium > 1e-7 && k > 1e9);
        }
    }
}

/// A body that presses on an obstacle and that soft springs alone hold along it: forces balance.
#[test]
fn soft_springs_beside_contact() {
    for k in [1e-2, 1e-4, 1e-6, 1e-7] {
        let run = solved(&block(&format!(
            "sides.left.springs = [\"{k:e}\", \"{k:e}\"]\nsides.right.springs = [\"{k:e}\", 0]\n\
             sides.floor.contact = {{ gap = \"0.01*x\" }}\nsides.top.traction = [\"1e-3\", \"-1\"]\nmethod.tolerance = 1e-4\n"
        )));
        let sum = run.last.reactions.iter().fold([0.0; 2], |s, (_, f)| [s[0] + f[0], s[1] + f[1]]);
        println!("k = {k:e}: {:?} {:?} {:e}", run.reason, run.last.reactions, run.last.equilibrium);
        assert!((sum[0] + 2e-3).hypot(sum[1] - 2.0) < 1e-13 + 1e-15 / k && run.reason == Reason::Tolerance);
    }
}

/// A disc whose rim, on springs k, has the traction (-y, x) - (x, y): it turns by 1/k, as far as 2e5 where springs are soft, and
/// u_r = c r with c = -2/(E/((1+ν)(1-2ν)) + k R). Where rounding has the strain energy, the estimate is doubted.
#[test]
fn a_disc_turns_far_on_soft_springs() {
    for k in [1e4, 1.0, 1e-3, 1e-5] {
        let run = solved(&format!(
            "body = {{ circle = {{ centre = [0, 0], radius = 2 }}, side = \"rim\" }}\nmaterial = {{ young = 100.0, poisson = 0.3 }}\n\
             sides.rim = {{ springs = \"{k:e}\", traction = [\"-y-x\", \"x-y\"] }}\nmethod.tolerance = 1e-5\n"
        ));
        let (stiffness, rim) = (100.0 / (1.3 * 0.4), 4.0 * std::f64::consts::PI);
        let c = -2.0 / (stiffness + 2.0 * k);
        let (strain, springs) = (stiffness * c * c * rim, 0.5 * k * rim * 4.0 * (c * c + 1.0 / k / k));
        let energies = run.last.energies;
        println!("k = {k:e}: {} dofs, {:?}", run.step().dofs, run.reason);
        let (estimate, exact) = (run.step().estimate(), -strain - springs);
        let doubted = estimate.doubts.contains(&Doubt::Roundoff);
        println!("strain energy off by {:.1e}, {doubted}", energies.strain / strain - 1.0);
        assert!((energies.strain / strain - 1.0).abs() < 3e-5 || doubted && k < 1e-4);
        close(energies.springs, springs, 1e-6, "spring energy");
        println!("J off by {:e} ± {:e}", estimate.energy - exact, estimate.uncertainty);
        assert!((estimate.energy - exact).abs() <= estimate.uncertainty + 1e-13 * exact.abs());
    }
}
