//! Bodies on grids: what does not depend on the moduli, the units, the place or the number of threads.

use std::fmt::Write as _;

use proptest::prelude::*;
use steklov_model::summary::Summary;
use steklov_problem::Scene;
use steklov_tests::{adapt, attempt_grid, on_grid, parse};

const CONFORMING: [&str; 5] = ["fem", "linear", "coupled", "oscillatory", "q1"];
const ALL: [&str; 7] = ["fem", "linear", "coupled", "oscillatory", "q1", "oversampled", "periodic"];

/// A rectangle of 4 × 3 coarse cells of 4 × 4 fine ones.
#[derive(Clone)]
struct Body {
    low: [f64; 2],
    size: [f64; 2],
    /// Lines of `[material]`.
    material: String,
    /// Tables of the sides a (lower), b (right), c (upper), d (left).
    sides: String,
    probes: Vec<[f64; 2]>,
}

impl Body {
    fn new(size: [f64; 2], material: &str, sides: &str) -> Self {
        let inner = [[0.3, 0.2], [0.25, 0.1], [0.5, 1.0 / 3.0], [1.0, 1.0], [0.0, 0.4], [0.6, 0.0], [0.13, 0.77]];
        let probes = inner.map(|[x, y]| [x * size[0], y * size[1]]).to_vec();
        Self { low: [0.0; 2], size, material: material.into(), sides: sides.into(), probes }
    }

    fn scene(&self, basis: &str) -> Scene {
        let [x0, y0] = self.low;
        let [x1, y1] = [x0 + self.size[0], y0 + self.size[1]];
        let (model, basis) = if basis == "fem" { ("fem", "coupled") } else { ("msfem", basis) };
        let probes: Vec<_> = self.probes.iter().map(|p| [x0 + p[0], y0 + p[1]]).collect();
        let text = format!(
            "title = \"grid\"\n[body]\ncorners = [[{x0:?}, {y0:?}], [{x1:?}, {y0:?}], [{x1:?}, {y1:?}], [{x0:?}, {y1:?}]]\n\
             sides = [\"a\", \"b\", \"c\", \"d\"]\n[material]\n{}\n{}\n[grid]\ncoarse = [4, 3]\nfine = [4, 4]\nbasis = \"{basis}\"\n\
             [probe]\npoints = {probes:?}\n[method]\nmodel = \"{model}\"\nrefine = \"none\"\n",
            self.material, self.sides
        );
        parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
    }

    fn solved(&self, basis: &str) -> Summary {
        let summary = on_grid(&self.scene(basis));
        assert!(summary.converged, "{basis}: {}", summary.reason);
        summary
    }
}

/// The same displacement on the sides that are named.
fn held(sides: &str, [x, y]: [&str; 2]) -> String {
    sides.chars().fold(String::new(), |mut text, side| {
        writeln!(text, "[sides.{side}]\ndisplacement = [\"{x}\", \"{y}\"]").expect("text");
        text
    })
}

fn pulled(side: char, [x, y]: [&str; 2]) -> String {
    format!("[sides.{side}]\ntraction = [\"{x}\", \"{y}\"]\n")
}

const RANDOM: &str = "poisson = 0.3\n[material.cells]\nsize = 0.125\nyoung = { uniform = [1, 10], seed = 3 }";

/// Largest difference of stresses over `scale`.
fn stress_error(summary: &Summary, exact: [f64; 3], scale: f64) -> f64 {
    let errors = summary.probe.iter().flat_map(|p| (0..3).map(|k| (p.stress[k] - exact[k]).abs()).collect::<Vec<_>>());
    errors.fold(0.0, f64::max) / scale
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// u = A x + b on the boundary of one material is u inside, with the forces of its stress on each side. Cells that are enlarged
    /// less at the boundary than inside have other traces than their neighbours: those bases do not pass.
    #[test]
    fn affine_patch(a in prop::array::uniform4(-1.0..1.0_f64), b in prop::array::uniform2(-3.0..3.0_f64), nu in 0.0..0.45_f64, young in 0.1..1e3_f64, w in 0.3..3.0_f64) {
        let [xx, xy, yx, yy] = a;
        let (x, y) = (format!("{xx}*x+{xy}*y+{}", b[0]), format!("{yx}*x+{yy}*y+{}", b[1]));
        let size = [w, 1.0];
        let body = Body::new(size, &format!("young = {young}\npoisson = {nu}"), &held("abcd", [&x, &y]));
        let (lambda, mu) = (young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), young / (2.0 * (1.0 + nu)));
        let trace = lambda * (xx + yy);
        let [sx, sy, sxy] = [trace + 2.0 * mu * xx, trace + 2.0 * mu * yy, mu * (xy + yx)];
        let scale = young * a.iter().fold(0.0, |m: f64, v| m.max(v.abs())) / (1.0 - 2.0 * nu);
        for basis in ALL {
            let s = body.solved(basis);
            let error = stress_error(&s, [sx, sy, sxy], scale);
            if basis == "oversampled" {
                continue;
            }
            prop_assert!(error <= 1e-11, "{basis}: stress {error:e}");
            for p in &s.probe {
                let exact = [xx * p.point[0] + xy * p.point[1] + b[0], yx * p.point[0] + yy * p.point[1] + b[1]];
                prop_assert!((0..2).all(|k| (p.displacement[k] - exact[k]).abs() <= 1e-12 * 10.0), "{basis}: {:?}", p);
            }
            for (side, n, length) in [("a", [0.0, -1.0], w), ("b", [1.0, 0.0], 1.0), ("c", [0.0, 1.0], w), ("d", [-1.0, 0.0], 1.0)] {
                let exact = [sx * n[0] + sxy * n[1], sxy * n[0] + sy * n[1]].map(|t| t * length);
                let got = s.reactions[side];
                prop_assert!((0..2).all(|k| (got[k] - exact[k]).abs() <= 1e-10 * scale * (1.0 + w)), "{basis} {side}: {got:?} instead of {exact:?}");
            }
        }
    }

    /// Prescribed on one side, a rigid motion moves any material without stress.
    #[test]
    fn rigid_motions(c in prop::array::uniform3(-2.0..2.0_f64), seed in 0..1000_u32) {
        let sides = held("d", [&format!("{}-{}*y", c[0], c[2]), &format!("{}+{}*x", c[1], c[2])]);
        let material = RANDOM.replace("seed = 3", &format!("seed = {seed}"));
        let body = Body::new([2.0, 1.5], &material, &sides);
        for basis in ALL {
            let s = body.solved(basis);
            for p in &s.probe {
                let exact = [c[0] - c[2] * p.point[1], c[1] + c[2] * p.point[0]];
                prop_assert!((0..2).all(|k| (p.displacement[k] - exact[k]).abs() <= 1e-11), "{basis}: {:?} instead of {exact:?}", p);
                prop_assert!(p.stress.iter().all(|s| s.abs() <= 1e-9), "{basis}: {:?}", p);
            }
        }
    }

    /// Other units and another origin: the same answer without units. Mirrored: the mirrored answer.
    #[test]
    fn units_origin_and_mirror(length in 1e-3..1e3_f64, stress in 1e-6..1e9_f64, at in prop::array::uniform2(-1.0..1.0_f64), which in 0..ALL.len()) {
        let basis = ALL[which];
        // moduli by an expression of (x - x0)/length, so that it moves with the body
        let body = |l: f64, e: f64, at: [f64; 2], mirror: f64| {
            let x = if mirror < 0.0 { format!("({}-x)/{l}", at[0] + 2.0 * l) } else { format!("(x-({}))/{l}", at[0]) };
            let y = format!("(y-({}))/{l}", at[1]);
            let material = format!(
                "poisson = 0.3\n[material.cells]\nsize = {:?}\nyoung = \"{e}*(5.5+4*sin(11*{x})*cos(7*{y}))\"",
                0.125 * l
            );
            let (held_side, free_side) = if mirror < 0.0 { ('b', 'd') } else { ('d', 'b') };
            let sides = held(&held_side.to_string(), ["0", "0"])
                + &pulled(free_side, [&format!("{}*{y}", e * mirror), &format!("{}", -0.3 * e)])
                + &pulled('c', ["0", &format!("{e}*{x}*{x}")]);
            let mut body = Body::new([2.0 * l, 1.5 * l], &material, &sides);
            if mirror < 0.0 {
                body.probes.iter_mut().for_each(|p| p[0] = 2.0 * l - p[0]);
            }
            body.low = at;
            body
        };
        let one = body(1.0, 1.0, [0.0; 2], 1.0).solved(basis);
        let at = at.map(|a| a * length);
        for mirror in [1.0, -1.0] {
            let other = body(length, stress, at, mirror).solved(basis);
            let scaled = other.energy / (stress * length * length);
            prop_assert!((scaled - one.energy).abs() <= 1e-9 * one.energy.abs(), "{basis}: {scaled} and {}", one.energy);
            let estimates = (one.estimate_relative.unwrap_or(0.0), other.estimate_relative.unwrap_or(0.0));
            prop_assert!((estimates.0 - estimates.1).abs() <= 1e-8, "{basis}: {estimates:?}");
            let largest = one.probe.iter().flat_map(|p| p.displacement).fold(0.0, |m: f64, u| m.max(u.abs()));
            // inside of cells only: on their edges stresses are those of one of the cells
            for k in [0, 2, 3, 6] {
                let (p, q) = (&one.probe[k], &other.probe[k]);
                let [x, y] = [q.displacement[0] * mirror / length, q.displacement[1] / length];
                prop_assert!((x - p.displacement[0]).abs().max((y - p.displacement[1]).abs()) <= 1e-9 * largest, "{basis}: {p:?} and {q:?}");
            }
        }
    }

    /// Forces of supports and loads balance, whatever the basis; so does their moment along a lever.
    #[test]
    fn reactions_balance(t in prop::array::uniform4(-1.0..1.0_f64), seed in 0..1000_u32, which in 0..ALL.len()) {
        let basis = ALL[which];
        let weight = format!("[body_force]\nvalue = [\"0\", \"{}*x\"]\n", t[3]);
        let sides = held("ad", ["0", "0"]) + &pulled('b', [&format!("{}*y", t[0]), &t[1].to_string()]) + &pulled('c', ["0", &t[2].to_string()]) + &weight;
        let body = Body::new([2.0, 1.5], &RANDOM.replace("seed = 3", &format!("seed = {seed}")), &sides);
        let s = body.solved(basis);
        let load = [t[0] * 1.125, t[1] * 1.5 + t[2] * 2.0 + t[3] * 3.0];
        for k in 0..2 {
            let total: f64 = s.reactions.values().map(|r| r[k]).sum();
            prop_assert!((total + load[k]).abs() <= 1e-10, "{basis}: {total} and {}", load[k]);
        }
    }
}

#[test]
fn bases_of_enlarged_cells_fail_the_patch_test() {
    let body = Body::new([2.0, 1.0], "young = 7\npoisson = 0.3", &held("abcd", ["0.3*x+0.2*y", "0.5*x-0.7*y"]));
    let [lambda, mu] = [7.0 * 0.3 / (1.3 * 0.4), 7.0 / 2.6];
    let exact = [-0.4 * lambda + 0.6 * mu, -0.4 * lambda - 1.4 * mu, 0.7 * mu];
    let errors = ["coupled", "periodic", "oversampled"].map(|basis| stress_error(&body.solved(basis), exact, 7.0));
    println!("{errors:?}");
    assert!(errors[0] < 1e-12 && errors[1] < 1e-12 && (1e-3..0.1).contains(&errors[2]), "{errors:?}");
}

/// E and ν of plane stress are E (1+2ν)/(1+ν)² and ν/(1+ν) of plane strain.
#[test]
fn plane_stress_is_plane_strain_of_other_constants() {
    let sides = held("d", ["0", "0"]) + &pulled('b', ["1", "-2*y"]);
    let (young, nu) = (7.0, 0.3);
    let stress = format!("young = {young}\npoisson = {nu}\nplane = \"stress\"");
    let strain = |young: f64, nu: f64| format!("young = {young}\npoisson = {nu}");
    let other = strain(young * (1.0 + 2.0 * nu) / ((1.0 + nu) * (1.0 + nu)), nu / (1.0 + nu));
    for basis in ALL {
        let [a, b, same] = [stress.clone(), other.clone(), strain(young, nu)]
            .map(|m| Body::new([2.0, 1.0], &m, &sides).solved(basis).energy);
        assert!((a - b).abs() <= 1e-12 * a.abs(), "{basis}: {a} and {b}");
        assert!((a - same).abs() >= 1e-2 * a.abs(), "{basis}: plane strain is the same");
    }
}

/// Bending, u = (x y, -x²/2 - ν y²/(2(1-ν))), prescribed on all sides: data between vertices are not linear. The coarse cells'
/// part of the energy's error, against the fine grid, falls like H².
#[test]
fn displacements_that_are_not_linear_between_vertices() {
    let sides = held("abcd", ["x*y", "-x^2/2-0.3*y^2/(2*0.7)"]);
    let body = Body::new([2.0, 1.0], "young = 7\npoisson = 0.3", &sides);
    let exact = 0.5 * 7.0 / (1.0 - 0.09) * 2.0 / 3.0;
    let energy = |basis: &str, n: i64| {
        let mut scene = body.scene(basis);
        let grid = scene.body_mut().grid.as_mut().expect("a grid");
        (grid.coarse, grid.fine) = ([2 * n as usize, n as usize], [32 / n as usize; 2]);
        on_grid(&scene).strain_energy
    };
    let fine = energy("fem", 32);
    assert!((fine / exact - 1.0).abs() < 3e-4, "{fine} and {exact}");
    for basis in CONFORMING.into_iter().filter(|&b| b != "fem") {
        let errors = [2, 4, 8].map(|n| energy(basis, n) / fine - 1.0);
        let rates = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
        println!("{basis}: {errors:?}, rates {rates:.2?}");
        assert!(
            errors[2] > 0.0 && errors[2] < 5e-3 && rates.iter().all(|r| (1.4..2.2).contains(r)),
            "{basis}: {errors:?}"
        );
    }
}

/// What nothing holds: solved where the loads are balanced, refused where they are not.
#[test]
fn bodies_that_are_free() {
    let rest = "[sides.a]\ntraction = [\"0\", \"0\"]\n";
    let roller = held("d", ["0", "free"]);
    for basis in ALL {
        let solve = |sides: &str| attempt_grid(&Body::new([2.0, 1.5], RANDOM, sides).scene(basis));
        let balanced = solve(&(pulled('b', ["1", "0"]) + &pulled('d', ["-1", "0"])));
        let balanced = balanced.unwrap_or_else(|e| panic!("{basis}: {e}")).last;
        assert!(balanced.converged() && balanced.free_motions.len() == 3 && balanced.energies.total < 0.0, "{basis}");
        let u = &balanced.displacement;
        // neither moved nor turned, node by node
        let mean = [0, 1].map(|k| u.iter().skip(k).step_by(2).sum::<f64>());
        let points = (0..u.len() / 2).map(|n| balanced.body.grid.point(n));
        let turned: f64 = points.zip(u.chunks_exact(2)).map(|(p, u)| (p[0] - 1.0) * u[1] - (p[1] - 0.75) * u[0]).sum();
        if basis == "fem" {
            assert!(mean.iter().chain([&turned]).all(|v| v.abs() < 1e-10), "{basis}: {mean:?} {turned}");
        }
        let rolling =
            solve(&(roller.clone() + &pulled('b', ["1", "0"]))).unwrap_or_else(|e| panic!("{basis}: {e}")).last;
        assert!(rolling.converged() && rolling.free_motions.len() == 1, "{basis}");
        assert!((rolling.reactions[0].1[0] + 1.5).abs() < 1e-10, "{basis}: {:?}", rolling.reactions);
        for (sides, motion) in [
            (pulled('b', ["1", "0"]), "translation along (1, 0)"),
            (pulled('b', ["0", "1"]) + &pulled('d', ["0", "-1"]), "rotation"),
            (roller.clone() + &pulled('b', ["1", "0.1"]), "translation along (0, 1)"),
        ] {
            let error = solve(&sides).err().unwrap_or_else(|| panic!("{basis}: {sides} is solved")).to_string();
            assert!(error.contains(motion), "{basis}: {error}");
        }
        let unloaded = solve(rest).unwrap_or_else(|e| panic!("{basis}: {e}")).last;
        assert!(unloaded.converged() && unloaded.displacement.iter().all(|&u| u == 0.0), "{basis}");
    }
}

/// The same bits from one thread and from two.
#[test]
fn threads_change_no_bit() {
    let sides = held("d", ["0", "0"]) + &pulled('b', ["1", "-2*y"]) + "[body_force]\nvalue = [\"x\", \"-1\"]\n";
    let touching = "[sides.a]\ncontact = { gap = \"0\", friction = { tresca = \"0.3\" } }\n[sides.c]\ntraction = [\"0.1\", \"-1\"]\n";
    for (sides, basis) in ALL.iter().flat_map(|b| [(sides.as_str(), b), (touching, b)]) {
        let scene = Body::new([2.0, 1.5], RANDOM, sides).scene(basis);
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| attempt_grid(&scene)).unwrap_or_else(|e| panic!("{basis}: {e}")).last
        };
        let (one, two) = (on(1), on(2));
        let bits = |u: &[f64]| u.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&one.displacement), bits(&two.displacement), "{basis}");
        assert_eq!(one.energies.total.to_bits(), two.energies.total.to_bits(), "{basis}");
        assert_eq!(one.estimate, two.estimate, "{basis}");
        assert_eq!(one.reactions, two.reactions, "{basis}");
    }
}

/// A jump x² of the displacement leaves a²(t² - 1) of its linear interpolant on elements of half length a: half of its norm times that
/// of its slope over both compliances, 1/E* = (1-ν²)/E, on the elements along x, and nothing on those along y.
#[test]
fn what_elements_leave_of_a_jump_has_the_energy_of_both_compliances() {
    let text = "[body]\ncorners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]\nsides = [\"a\", \"b\", \"c\", \"d\"]\n\
                [material]\nyoung = 3.0\npoisson = 0.4\n[exterior]\nyoung = 5.0\npoisson = 0.2\n\
                displacement_jump = [\"x^2\", \"0\"]\n[grid]\ncoarse = [4, 4]\nfine = [1, 1]\n[method]\nmodel = \"fem-bem\"\n\
                refine = \"none\"\n";
    let scene = parse(text, &[]).unwrap_or_else(|e| panic!("{}", e.render()));
    let run = attempt_grid(&scene).unwrap_or_else(|e| panic!("{e}"));
    let jump = run.last.estimate.expect("an estimate").jump;
    let wanted = 0.125f64.powi(4) * (128.0f64 / 45.0).sqrt() / (2.0 * ((1.0 - 0.16) / 3.0 + (1.0 - 0.04) / 5.0));
    assert_eq!(jump.len(), 16);
    assert_eq!(jump.iter().filter(|energy| (*energy / wanted - 1.0).abs() < 1e-10).count(), 8, "{jump:?} {wanted}");
    assert_eq!(jump.iter().filter(|energy| **energy == 0.0).count(), 8, "{jump:?}");
}

/// Cells that differ in ν: the work of multiscale elements approaches that of bilinear ones from below as coarse cells shrink,
/// and the estimate bounds what is missing.
#[test]
fn ratios_from_cell_to_cell_in_multiscale_elements() {
    let cells = "[material.cells]\nsize = 0.125\nyoung = { uniform = [1.0, 3.0], seed = 3 }\n\
                 poisson = { uniform = [0.0, 0.45], seed = 4 }";
    let sides = held("d", ["0", "0"]) + &pulled('b', ["0", "-1"]);
    let solved = |basis: &str, coarse: [usize; 2], fine: usize| {
        let (model, basis) = if basis == "fem" { ("fem", "coupled") } else { ("msfem", basis) };
        let text = format!(
            "title = \"ratios\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"a\", \"b\", \"c\", \"d\"]\n\
             {cells}\n{sides}\n[grid]\ncoarse = {coarse:?}\nfine = [{fine}, {fine}]\nbasis = \"{basis}\"\n\
             [method]\nmodel = \"{model}\"\nrefine = \"none\"\n"
        );
        on_grid(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render())))
    };
    let exact = solved("fem", [32, 16], 1).strain_energy;
    for basis in ["q1", "linear", "coupled", "oscillatory"] {
        let mut last = f64::INFINITY;
        for fine in [8, 4, 2] {
            let summary = solved(basis, [32 / fine, 16 / fine], fine);
            let error = f64::sqrt(2.0 * (exact - summary.strain_energy));
            let estimate = summary.grid.expect("a grid").estimate_multiscale.expect("an estimate");
            assert!(error < last && (1.0..5.0).contains(&(estimate / error)), "{basis} {fine}: {error}, {estimate}");
            last = error;
        }
    }
    let same = solved("coupled", [32, 16], 1).strain_energy;
    assert!((same / exact - 1.0).abs() < 1e-12, "{same} and {exact}");
}

/// The part of a body that has the material of the medium may be body or medium: an inclusion of other E and ν in both.
#[test]
fn ratios_from_cell_to_cell_in_a_medium() {
    let cells = "[material.cells]\nsize = 0.125\nyoung = \"if(max(abs(x), abs(y)) < 0.5, 2, 1)\"\n\
                 poisson = \"if(max(abs(x), abs(y)) < 0.5, 0.4, 0.25)\"";
    let solved = |half: f64, coarse: usize, model: &str, fine: usize| {
        let text = format!(
            "title = \"inclusion\"\n[body]\ncorners = [[-{half:?}, -{half:?}], [{half:?}, -{half:?}], [{half:?}, {half:?}], [-{half:?}, {half:?}]]\n\
             sides = [\"a\", \"b\", \"c\", \"d\"]\n{cells}\n[exterior]\nyoung = 1.0\npoisson = 0.25\nremote_stress = [1, 0, 0]\n\
             [grid]\ncoarse = [{coarse}, {coarse}]\nfine = [{fine}, {fine}]\n[method]\nmodel = \"{model}\"\nrefine = \"none\"\n\
             [probe]\npoints = [[0, 0], [0.25, 0.25]]\n"
        );
        on_grid(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render())))
    };
    let (alone, within) = (solved(0.5, 16, "fem-bem", 1), solved(1.0, 32, "fem-bem", 1));
    let multiscale = solved(1.0, 16, "msfem-bem", 2);
    for (other, bound) in [(&within, 2e-3), (&multiscale, 5e-2)] {
        for (a, b) in alone.probe.iter().zip(&other.probe) {
            // stresses of 1, displacements of .1; the estimate of the multiscale elements is 5 %
            for k in 0..2 {
                let difference = (a.displacement[k] - b.displacement[k]).abs();
                assert!(difference <= 0.1 * bound, "{:?} and {:?}", a.displacement, b.displacement);
            }
            for k in 0..3 {
                let difference = (a.stress[k] - b.stress[k]).abs();
                assert!(difference <= bound, "{:?} and {:?}", a.stress, b.stress);
            }
        }
    }
}

/// Cells that do not differ are one material, which boundary elements solve; a grid solves it where the scene asks for one.
#[test]
fn cells_of_one_material_are_one_material() {
    let body = "title = \"one\"\n[body]\ncorners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"a\", \"b\", \"c\", \"d\"]\n\
                [sides.d]\ndisplacement = [0, 0]\n[sides.b]\ntraction = [0, -1]\n[method]\ntolerance = 1e-3\n";
    let read = |material: &str, set: &[&str]| {
        let text = format!("{body}[material]\n{material}\n");
        parse(&text, set).unwrap_or_else(|e| panic!("{}", e.render()))
    };
    let plain = read("young = 7.0\npoisson = 0.2", &[]);
    for cells in [
        "cells = { size = 0.25, young = \"7\", poisson = \"0.2\" }",
        "poisson = 0.2\ncells = { size = 0.25, young = { uniform = [7, 7] } }",
    ] {
        let scene = read(cells, &[]);
        assert!(!scene.is_on_grid());
        assert_eq!(scene.body().material(), plain.body().material());
        let asked =
            read(cells, &["method.model=\"fem\"", "grid={coarse=[8, 4], fine=[1, 1]}", "method.refine=\"none\""]);
        assert!(asked.is_on_grid());
        let [fem, bem] = [on_grid(&asked).energy, adapt(&scene).expect("boundary elements").step().energy];
        assert!(bem < fem && (fem / bem - 1.0).abs() < 0.1, "{fem} and {bem}");
    }
}
