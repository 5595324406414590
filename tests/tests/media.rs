//! Body forces and an unbounded medium among several bodies, against one body, one path of the other kind and closed forms.

use faer::Mat;
use steklov_algebra::solve_full_lu;
use steklov_model::summary::Summary;
use steklov_problem::Scene;
use steklov_tests::summary;

fn parse(text: &str, overrides: &[&str]) -> Scene {
    steklov_tests::parse(text, overrides).unwrap_or_else(|e| panic!("{}", e.render()))
}

fn solved(text: &str, overrides: &[&str]) -> Summary {
    summary(&parse(text, overrides))
}

/// Two blocks that are tied are one, under forces on both.
#[test]
fn weights_of_tied_blocks_are_that_of_one() {
    let probe = "[probe]\npoints = [[0.3, 0.5], [0.2, -0.4], [-0.8, 0.2]]\n[method]\ntolerance = 1e-6\n";
    let block = |low: f64, high: f64| {
        format!(
            "corners = [[-1, {low:?}], [1, {low:?}], [1, {high:?}], [-1, {high:?}]]\nsides = [\"bottom\", \"side\", \"top\", \"side\"]\n"
        )
    };
    let material = "material = { young = 100.0, poisson = 0.3 }\n";
    let one = format!(
        "{material}[body]\n{}[body_force]\nvalue = [\"0.3\", \"-1\"]\n[sides.bottom]\ndisplacement = [\"0\", \"0\"]\n{probe}",
        block(-1.0, 1.0)
    );
    let two = format!(
        "{material}[[body]]\nname = \"a\"\n{}[[body]]\nname = \"b\"\n{}body_force = [\"0.3\", \"-1\"]\n\
         [body_force]\nvalue = [\"0.3\", \"-1\"]\n[sides.a.bottom]\ndisplacement = [\"0\", \"0\"]\n\
         [[interface]]\nbetween = [\"a.top\", \"b.bottom\"]\ntied = true\n{probe}",
        block(-1.0, 0.0),
        block(0.0, 1.0)
    );
    let [one, two] = [one, two].map(|text| solved(&text, &[]));
    let [a, b] = [&one, &two].map(|told| told.energy_extrapolated.unwrap());
    println!("{a:.14} {b:.14}, {} and {} dofs", one.dofs, two.dofs);
    assert!((a - b).abs() < one.energy_uncertainty.unwrap() + two.energy_uncertainty.unwrap());
    assert!((one.strain_energy / two.bodies.iter().map(|b| b.strain_energy).sum::<f64>() - 1.0).abs() < 1e-9);
    for (a, b) in one.probe.iter().zip(&two.probe) {
        (0..2).for_each(|i| assert!((a.displacement[i] - b.displacement[i]).abs() < 1e-10, "{a:?} {b:?}"));
        (0..3).for_each(|i| assert!((a.stress[i] - b.stress[i]).abs() < 1e-7, "{a:?} {b:?}"));
    }
    // the weight of the upper block
    let force = two.interfaces[0].force;
    assert!((force[0] - 0.6).abs() < 1e-10 && (force[1] + 2.0).abs() < 1e-10, "{force:?}");
}

/// A body that is tied to a medium, both with boundaries of their own, and the same as an inclusion on one mesh. Their energies
/// are counted from different states: by σ:ε of the remote field over the ellipse, ½ of it twice.
#[test]
fn an_inclusion_is_a_body_that_is_tied_to_a_medium() {
    let wall = "ellipse = { centre = [0.2, 0.1], radii = [1, 0.6], angle = 20 }\nside = \"wall\"\n";
    let rest = "[probe]\npoints = [[0.3, 0.2], [2, 0.4], [0.2, 0.1], [-1.5, -2]]\n[method]\ntolerance = 1e-6\n";
    let stress = "remote_stress = [1, 0.2, 0.3]";
    let inclusion = format!(
        "material = {{ young = 300, poisson = 0.2 }}\n[body]\n{wall}[exterior]\nyoung = 100\npoisson = 0.3\n{stress}\n{rest}"
    );
    let bodies = |first: &str, second: &str| {
        format!(
            "[[body]]\nname = \"core\"\nmaterial = {{ young = 300, poisson = 0.2 }}\n{wall}[[body]]\nname = \"rock\"\n\
             material = {{ young = 100, poisson = 0.3 }}\nmedium = {{ {stress} }}\n[[body.holes]]\n{wall}\
             [[interface]]\nbetween = [\"{first}.wall\", \"{second}.wall\"]\ntied = true\n{rest}"
        )
    };
    let one = solved(&inclusion, &[]);
    for (first, second) in [("core", "rock"), ("rock", "core")] {
        let two = solved(&bodies(first, second), &[]);
        let (nu, mu, [xx, yy, xy]) = (0.3, 100.0 / 2.6, [1.0, 0.2, 0.3]);
        let strain = [(1.0 - nu) * xx - nu * yy, (1.0 - nu) * yy - nu * xx, 2.0 * xy].map(|e| e / (2.0 * mu));
        let of_remote = std::f64::consts::PI * 0.6 * (xx * strain[0] + yy * strain[1] + xy * strain[2]);
        let [a, b] = [&one, &two].map(|told| told.energy_extrapolated.unwrap());
        println!("{a:.14} {:.14} {} {} dofs", b - of_remote, one.dofs, two.dofs);
        assert!((a - b + of_remote).abs() < one.energy_uncertainty.unwrap() + two.energy_uncertainty.unwrap() + 1e-14);
        for (a, b) in one.probe.iter().zip(&two.probe) {
            (0..2).for_each(|i| assert!((a.displacement[i] - b.displacement[i]).abs() < 1e-10, "{a:?} {b:?}"));
            (0..3).for_each(|i| assert!((a.stress[i] - b.stress[i]).abs() < 3e-8, "{a:?} {b:?}"));
        }
        assert_eq!(two.exterior.as_ref().unwrap().radiation, "decaying");
        assert!(two.exterior.unwrap().balanced && two.estimate_doubts.is_empty(), "{:?}", two.estimate_doubts);
    }
}

/// Stress and displacement of Michell's solution with cos 2θ: A r², B r⁴, C r⁻², D.
#[derive(Clone, Copy)]
struct Michell {
    kolosov: f64,
    twice_mu: f64,
}

impl Michell {
    fn of(young: f64, poisson: f64) -> Self {
        Self { kolosov: 3.0 - 4.0 * poisson, twice_mu: young / (1.0 + poisson) }
    }

    /// σ_rr, σ_rθ, u_r and u_θ of A, B, C and D = 1.
    fn terms(&self, r: f64) -> [[f64; 4]; 4] {
        let (k, m) = (self.kolosov, self.twice_mu);
        [
            [-2.0, 0.0, -6.0 / r.powi(4), -4.0 / (r * r)],
            [2.0, 6.0 * r * r, -6.0 / r.powi(4), -2.0 / (r * r)],
            [-2.0 * r / m, (k - 3.0) * r.powi(3) / m, 2.0 / r.powi(3) / m, (k + 1.0) / r / m],
            [2.0 * r / m, (k + 3.0) * r.powi(3) / m, 2.0 / r.powi(3) / m, (1.0 - k) / r / m],
        ]
    }
}

/// A lining that slips without friction in rock under remote stress, by Michell's solution: pressure and displacement.
#[test]
fn a_lining_that_slips_is_michells() {
    let (inner, [sx, sy]) = (0.85, [-2.0, -3.0]);
    let (young, poisson) = ([3000.0, 1000.0], [0.2, 0.3]);
    let [lining, rock] = [0, 1].map(|k| Michell::of(young[k], poisson[k]));
    let (mean, half) = ((sx + sy) / 2.0, (sx - sy) / 2.0);
    // what is even: A/r² + 2C, 2C = mean in the rock
    let even = |of: &Michell, r: f64| [-1.0 / r / of.twice_mu, (of.kolosov - 1.0) * r / of.twice_mu];
    let ([ra, rc], [la, lc]) = (even(&rock, 1.0), even(&lining, 1.0));
    let rows = [[1.0, -1.0, -2.0], [ra, -la, -lc], [0.0, 1.0 / (inner * inner), 2.0]];
    let right = [-mean, -rc * mean / 2.0, 0.0];
    let (a, b) = (Mat::from_fn(3, 3, |i, j| rows[i][j]), Mat::from_fn(3, 1, |i, _| right[i]));
    let e = solve_full_lu(a.as_ref(), b.as_ref());
    // what goes with cos 2θ: C, D of the rock, A to D of the lining
    let (r, l, i) = (rock.terms(1.0), lining.terms(1.0), lining.terms(inner));
    let remote = |k: usize| -half / 2.0 * r[k][0];
    let row = |rock: Option<usize>, lining: Option<&[f64; 4]>, sign: f64| -> [f64; 6] {
        let of_rock = rock.map_or([0.0; 2], |k| [r[k][2], r[k][3]]);
        let of_lining = lining.map_or([0.0; 4], |l| l.map(|v| sign * v));
        [of_rock[0], of_rock[1], of_lining[0], of_lining[1], of_lining[2], of_lining[3]]
    };
    let rows = [
        row(Some(0), Some(&l[0]), -1.0),
        row(Some(1), None, 0.0),
        row(None, Some(&l[1]), 1.0),
        row(Some(2), Some(&l[2]), -1.0),
        row(None, Some(&i[0]), 1.0),
        row(None, Some(&i[1]), 1.0),
    ];
    let right = [-remote(0), -remote(1), 0.0, -remote(2), 0.0, 0.0];
    let (a, b) = (Mat::from_fn(6, 6, |i, j| rows[i][j]), Mat::from_fn(6, 1, |i, _| right[i]));
    let x = solve_full_lu(a.as_ref(), b.as_ref());
    let pressure = |cos: f64| {
        let second: f64 = l[0].iter().enumerate().map(|(k, v)| v * x[(2 + k, 0)]).sum();
        -(e[(1, 0)] + 2.0 * e[(2, 0)]) - second * cos
    };
    let largest = pressure(1.0).max(pressure(-1.0));
    assert!(pressure(1.0).min(pressure(-1.0)) > 0.0);
    // u_x of the lining on the x axis, u_y of the rock on the y axis
    let (a, b) = (0.9, 1.4);
    let [ea, eb] = [even(&lining, a), even(&rock, b)];
    let second = |terms: [f64; 4], of: [f64; 4]| terms.iter().zip(of).map(|(t, c)| t * c).sum::<f64>();
    let in_lining = ea[0] * e[(1, 0)] + ea[1] * e[(2, 0)] + second(lining.terms(a)[2], [2, 3, 4, 5].map(|k| x[(k, 0)]));
    let in_rock =
        eb[0] * e[(0, 0)] + eb[1] * mean / 2.0 - second(rock.terms(b)[2], [-half / 2.0, 0.0, x[(0, 0)], x[(1, 0)]]);
    for carrier in ["lining.outside", "rock.wall"] {
        let text = format!(
            "[[body]]\nname = \"lining\"\nmaterial = {{ young = 3000, poisson = 0.2 }}\n\
             circle = {{ centre = [0, 0], radius = 1 }}\nside = \"outside\"\n\
             [[body.holes]]\ncircle = {{ centre = [0, 0], radius = {inner:?} }}\nside = \"inside\"\n\
             [[body]]\nname = \"rock\"\nmaterial = {{ young = 1000, poisson = 0.3 }}\n\
             medium = {{ remote_stress = [{sx:?}, {sy:?}, 0] }}\n\
             [[body.holes]]\ncircle = {{ centre = [0, 0], radius = 1 }}\nside = \"wall\"\n\
             [[interface]]\nbetween = [\"lining.outside\", \"rock.wall\"]\ncontact = {{}}\nmultiplier = \"{carrier}\"\n\
             [probe]\npoints = [[{a:?}, 0], [0, {b:?}]]\n"
        );
        let told = solved(&text, &["method.tolerance=1e-6"]);
        let found = [told.contact.unwrap().max_pressure, told.probe[0].displacement[0], told.probe[1].displacement[1]];
        println!("{carrier}: {found:?} {largest} {in_lining} {in_rock}, {} dofs", told.dofs);
        assert!((found[0] / largest - 1.0).abs() < 1e-5);
        assert!((found[1] / in_lining - 1.0).abs() < 1e-7 && (found[2] / in_rock - 1.0).abs() < 1e-7);
    }
}

/// Persson's pin in a hole: pressure and angle of contact, extrapolated in the square of the bore through which the force enters.
#[test]
fn a_pin_in_a_hole_is_perssons() {
    let (poisson, young) = (0.3, 1e6);
    let half = 45f64.to_radians();
    let (b, pi) = ((half / 2.0).tan(), std::f64::consts::PI);
    let root = (b * b + 1.0).sqrt();
    let pressure = 2.0 * b / (pi * root) + ((root + b) / (root - b)).ln() / (2.0 * pi * b * b * (1.0 + b * b));
    let clearance =
        (2.0 - (b * b + 1.0).ln() - 2.0 * b.powi(4)) / (pi * b * b * (b * b + 1.0)) * (1.0 - poisson * poisson) / young;
    let figures = |bore: f64| {
        let k = 1.0 / (4.0 * pi * (1.0 - poisson) * bore);
        let text = format!(
            "material = {{ young = {young:?}, poisson = {poisson:?} }}\n[[body]]\nname = \"pin\"\n\
             circle = {{ centre = [0, 0], radius = 1 }}\nside = \"wall\"\n\
             [[body.holes]]\ncircle = {{ centre = [0, 0], radius = {bore:?} }}\nside = \"bore\"\n\
             [[body]]\nname = \"plate\"\nmedium = {{}}\n\
             [[body.holes]]\ncircle = {{ centre = [0, {clearance:?}], radius = {:?} }}\nside = \"wall\"\n\
             [sides.pin.bore]\ntraction = [\"{:?}*x*y\", \"{:?} - {:?}*y*y\"]\n\
             [[interface]]\nbetween = [\"pin.wall\", \"plate.wall\"]\ncontact = {{}}\n",
            1.0 + clearance,
            -2.0 * k / (bore * bore),
            -k * (1.0 - 2.0 * poisson),
            2.0 * k / (bore * bore),
        );
        let told = solved(&text, &["method.tolerance=1e-6"]);
        assert_eq!(told.estimate_doubts, ["length"]);
        let contact = told.contact.unwrap();
        let ends = told.interfaces[0].ends.clone().unwrap();
        let angle = ends.iter().map(|[x, y]| x.abs().atan2(-y)).sum::<f64>() / 2.0;
        println!("bore {bore}: {} {} {}, {} dofs", contact.max_pressure, contact.length / 2.0, angle, told.dofs);
        [contact.max_pressure / pressure - 1.0, angle - half]
    };
    let [coarse, middle, fine] = [0.1, 0.05, 0.025].map(figures);
    for (i, tolerance) in [(0, 5e-6), (1, 2e-6)] {
        let [a, b] = [[coarse, middle], [middle, fine]].map(|[c, f]| (4.0 * f[i] - c[i]) / 3.0);
        let at_zero = (16.0 * b - a) / 15.0;
        println!("{at_zero:e}");
        assert!(at_zero.abs() < tolerance, "{i}: {at_zero:e}");
    }
}
