//! A body with holes or a force in an unbounded medium, by boundary elements: the medium is a body of its own.

use std::f64::consts::PI;

use steklov_problem::Model;
use steklov_tests::{on_grid, parse, summary};

fn scene(text: &str) -> steklov_problem::Scene {
    parse(text, &[]).unwrap_or_else(|e| panic!("{}\n{text}", e.render()))
}

/// The solution of a linear system by elimination.
fn solve(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let n = rows.len();
    for i in 0..n {
        let pivot = (i..n).max_by(|&a, &b| rows[a][i].abs().total_cmp(&rows[b][i].abs())).expect("a row");
        rows.swap(i, pivot);
        let own = rows[i].clone();
        for (k, row) in rows.iter_mut().enumerate().filter(|(k, _)| *k != i) {
            let factor = row[i] / own[i];
            assert!(factor.is_finite(), "row {k} of a singular system");
            row.iter_mut().zip(&own).for_each(|(a, b)| *a -= factor * b);
        }
    }
    rows.iter().enumerate().map(|(i, row)| row[n] / row[i]).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A ring of the radii a and b in a medium under the stresses [xx, yy] far away and the pressure p inside, by Michell's series: of each
/// part [M, A] of σ_r = M + A/r² and [a, b, c, d] of φ = (a r² + b r⁴ + c/r² + d) cos 2θ.
struct Lining {
    radius: f64,
    ring: ([f64; 2], [f64; 2], Vec<f64>),
    medium: ([f64; 2], [f64; 2], Vec<f64>),
}

/// σ_r/cos 2θ and σ_rθ/sin 2θ of the four functions.
fn stresses(r: f64) -> [[f64; 4]; 2] {
    [[-2.0, 0.0, -6.0 / r.powi(4), -4.0 / r.powi(2)], [2.0, 6.0 * r * r, -6.0 / r.powi(4), -2.0 / r.powi(2)]]
}

/// u_r/cos 2θ and u_θ/sin 2θ.
fn displacements(r: f64, [mu, kappa]: [f64; 2]) -> [[f64; 4]; 2] {
    let [radial, hoop] = [
        [-2.0 * r, (kappa - 3.0) * r.powi(3), 2.0 / r.powi(3), (kappa + 1.0) / r],
        [2.0 * r, (kappa + 3.0) * r.powi(3), 2.0 / r.powi(3), (1.0 - kappa) / r],
    ];
    [radial, hoop].map(|of| of.map(|u| u / (2.0 * mu)))
}

impl Lining {
    fn new([a, b]: [f64; 2], ring: [f64; 2], medium: [f64; 2], [xx, yy]: [f64; 2], p: f64) -> Self {
        let [ring, medium] = [ring, medium].map(|[e, nu]| [e / (2.0 * (1.0 + nu)), 3.0 - 4.0 * nu]);
        let mean = 0.5 * (xx + yy);
        let even = |[mu, kappa]: [f64; 2]| [(kappa - 1.0) / 2.0 * b / (2.0 * mu), -1.0 / (2.0 * mu * b)];
        let (own, other) = (even(ring), even(medium));
        let round = solve(vec![
            vec![1.0, 1.0 / (a * a), 0.0, -p],
            vec![1.0, 1.0 / (b * b), -1.0 / (b * b), mean],
            vec![own[0], own[1], -other[1], other[0] * mean],
        ]);
        let far = -(xx - yy) / 4.0;
        let inner = stresses(a).map(|s| [&s[..], &[0.0; 3]].concat());
        let meet = |own: [f64; 4], other: [f64; 4]| [&own[..], &[-other[2], -other[3], far * other[0]]].concat();
        let [u, v] = [displacements(b, ring), displacements(b, medium)];
        let outer = [0, 1].map(|k| meet(stresses(b)[k], stresses(b)[k])).into_iter();
        let outer = outer.chain([0, 1].map(|k| meet(u[k], v[k])));
        let c = solve(inner.into_iter().chain(outer).collect());
        Self {
            radius: b,
            ring: (ring, [round[0], round[1]], c[..4].to_vec()),
            medium: (medium, [mean, round[2]], vec![far, 0.0, c[4], c[5]]),
        }
    }

    /// Displacement, and stress xx, yy, xy.
    fn at(&self, [x, y]: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        let (r, angle) = (x.hypot(y), y.atan2(x));
        let ([mu, kappa], [mean, round], c) = if r <= self.radius { &self.ring } else { &self.medium };
        let ((sin, cos), (s, k)) = ((2.0 * angle).sin_cos(), angle.sin_cos());
        let [radial, shear] = stresses(r).map(|f| dot(&f, c));
        let hoop = 2.0 * c[0] + 12.0 * c[1] * r * r + 6.0 * c[2] / r.powi(4);
        let [u, v] = displacements(r, [*mu, *kappa]).map(|f| dot(&f, c));
        let (u, v) = (u * cos + ((kappa - 1.0) / 2.0 * mean * r - round / r) / (2.0 * mu), v * sin);
        let (radial, hoop, shear) =
            (radial * cos + mean + round / (r * r), hoop * cos + mean - round / (r * r), shear * sin);
        let stress = [
            radial * k * k + hoop * s * s - 2.0 * shear * s * k,
            radial * s * s + hoop * k * k + 2.0 * shear * s * k,
            (radial - hoop) * s * k + shear * (k * k - s * s),
        ];
        ([u * k - v * s, u * s + v * k], stress)
    }
}

/// A round tunnel with a lining, of `[exterior]` and as two bodies.
fn tunnel(method: &str) -> [String; 2] {
    let ring = "circle = { centre = [0, 0], radius = 1.25 }\nside = \"rock\"\n[[body.holes]]\ncircle = { centre = [0, 0], radius = 1 }\nside = \"wall\"\n";
    let probe = "[probe]\npoints = [[1, 0], [0, 1.1], [0.9, 0.8], [2, 1], [-0.3, 4]]\n";
    let one = format!(
        "[body]\n{ring}[material]\nyoung = 30\npoisson = 0.2\n[exterior]\nyoung = 5\npoisson = 0.3\nremote_stress = [-0.005, -0.01, 0]\n\
         [sides.wall]\npressure = 0.002\n{probe}{method}"
    );
    let two = format!(
        "[[body]]\nname = \"ring\"\nmaterial = {{ young = 30, poisson = 0.2 }}\n{ring}[[body]]\nname = \"medium\"\n\
         medium = {{ remote_stress = [-0.005, -0.01, 0] }}\nmaterial = {{ young = 5, poisson = 0.3 }}\n[[body.holes]]\n\
         circle = {{ centre = [0, 0], radius = 1.25 }}\nside = \"rock\"\n[sides.ring.wall]\npressure = 0.002\n\
         [[interface]]\nbetween = [\"ring.rock\", \"medium.rock\"]\ntied = true\n{probe}{method}"
    );
    [one, two]
}

#[test]
fn a_lined_tunnel_has_michells_solution() {
    let exact = Lining::new([1.0, 1.25], [30.0, 0.2], [5.0, 0.3], [-0.005, -0.01], 0.002);
    let [one, two] = tunnel("[method]\ntolerance = 1e-7\n").map(|text| summary(&scene(&text)));
    assert!(one.converged && one.model == "bem");
    for (probe, other) in one.probe.iter().zip(&two.probe) {
        let (u, stress) = exact.at(probe.point);
        let on_boundary = probe.point == [1.0, 0.0];
        println!("{:?}: {:?} {u:?}, {:?} {stress:?}", probe.point, probe.displacement, probe.stress);
        for i in 0..2 {
            assert!((probe.displacement[i] - u[i]).abs() < 1e-8 * 2.5e-3, "{probe:?} {u:?}");
            assert_eq!(probe.displacement[i].to_bits(), other.displacement[i].to_bits());
        }
        for i in 0..3 {
            let tolerance = if on_boundary { 1e-5 } else { 1e-8 };
            assert!((probe.stress[i] - stress[i]).abs() < tolerance * 0.06, "{probe:?} {stress:?}");
        }
    }
    assert_eq!(one.energy.to_bits(), two.energy.to_bits());
    assert_eq!(one.estimate.map(f64::to_bits), two.estimate.map(f64::to_bits));
    assert!(one.exterior.is_some_and(|around| around.balanced));
}

/// Bilinear elements in a square lining, asked for, are within the error that they tell.
#[test]
fn a_square_lining_agrees_with_a_grid() {
    let with = |more: &str| {
        format!(
            "[body]\ncorners = [[-1.5, -1.5], [1.5, -1.5], [1.5, 1.5], [-1.5, 1.5]]\nsides = [\"rock\", \"rock\", \"rock\", \"rock\"]\n\
             [[body.holes]]\ncorners = [[-1, -1], [1, -1], [1, 1], [-1, 1]]\nsides = [\"wall\", \"wall\", \"wall\", \"wall\"]\n\
             [material]\nyoung = 30.0\npoisson = 0.2\n[exterior]\nyoung = 5.0\npoisson = 0.3\nremote_stress = [-0.005, -0.01, 0]\n\
             [sides.wall]\npressure = \"0.002\"\n[body_force]\nvalue = [\"0.001*x\", \"-0.002*y\"]\n\
             [probe]\npoints = [[1.2, 0.3], [-0.4, 1.3], [3, 1]]\n{more}"
        )
    };
    // a grid that boundary elements do not use is left out
    let grid = "[grid]\ncoarse = [48, 48]\nfine = [1, 1]\n";
    let told = summary(&scene(&with(&format!("{grid}[method]\ntolerance = 1e-4\n"))));
    assert!(told.model == "bem" && told.converged);
    let on_cells = on_grid(&scene(&with(&format!("{grid}[method]\nmodel = \"fem-bem\"\nrefine = \"none\"\n"))));
    // the medium as a body has the work of the remote stress on its own displacement besides, 9 σ:ε over the area of the square
    let error = on_cells.estimate.expect("an estimate");
    let strain = |a: f64, b: f64| (0.7 * a - 0.3 * b) / (5.0 / 1.3);
    let remote = 9.0 * (0.005 * strain(0.005, 0.01) + 0.01 * strain(0.01, 0.005));
    let off = on_cells.energy + remote - told.energy;
    println!("J off by {off:e}, half of the squared estimate {:e}", 0.5 * error * error);
    assert!(0.0 < off && off < error * error, "{off:e} {error:e}");
    for (a, b) in told.probe.iter().zip(&on_cells.probe) {
        for i in 0..2 {
            assert!((a.displacement[i] - b.displacement[i]).abs() < 3e-5, "{a:?} {b:?}");
        }
    }
}

/// A disc of the medium's own material under a constant force: outside it has the integral of Kelvin's stresses over the disc.
#[test]
fn a_heavy_disc_in_its_own_material_pulls_at_the_plane() {
    let (young, nu, radius, b) = (3.0, 0.25, 0.8_f64, -0.7);
    let text = format!(
        "[body]\ncircle = {{ centre = [0, 0], radius = {radius} }}\nside = \"rim\"\n[material]\nyoung = {young}\npoisson = {nu}\n\
         [exterior]\nyoung = {young}\npoisson = {nu}\n[body_force]\nvalue = [0, {b}]\n\
         [probe]\npoints = [[0, 1.6], [1.5, 0.5]]\n[method]\ntolerance = 1e-7\n"
    );
    let told = summary(&scene(&text));
    let around = told.exterior.expect("a medium");
    let resultant = b * PI * radius * radius;
    assert!(!around.balanced && (around.resultant[1] - resultant).abs() < 1e-9, "{around:?}");
    let kelvin = |[x, y]: [f64; 2]| {
        let r2 = x * x + y * y;
        let h = 1.0 - 2.0 * nu;
        let factor = -b / (4.0 * PI * (1.0 - nu) * r2);
        [factor * y * (2.0 * x * x / r2 - h), factor * y * (2.0 * y * y / r2 + h), factor * x * (2.0 * y * y / r2 + h)]
    };
    for probe in &told.probe {
        let (rings, turns) = (steklov_quadrature::gauss_legendre(24).mapped(0.0, radius), 96);
        let mut stress = [0.0; 3];
        for (r, w) in rings.points.iter().zip(&rings.weights) {
            for k in 0..turns {
                let (s, c) = (2.0 * PI * k as f64 / turns as f64).sin_cos();
                let at = kelvin([probe.point[0] - r * c, probe.point[1] - r * s]);
                (0..3).for_each(|i| stress[i] += w * r * 2.0 * PI / turns as f64 * at[i]);
            }
        }
        for i in 0..3 {
            assert!((probe.stress[i] - stress[i]).abs() < 1e-8, "{probe:?} {stress:?}");
        }
    }
}

/// What is not made two bodies is refused by name, or is on the grid as before.
#[test]
fn what_needs_a_grid_in_a_medium_keeps_it() {
    let body = "[body]\ncorners = [[-1, -1], [1, -1], [1, 1], [-1, 1]]\nsides = [\"rock\", \"rock\", \"rock\", \"rock\"]\n\
                [material]\nyoung = 3.0\npoisson = 0.2\n[exterior]\nyoung = 5.0\npoisson = 0.3\nremote_stress = [1, 0, 0]\n";
    let grid = "[grid]\ncoarse = [4, 4]\nfine = [1, 1]\n";
    let heavy = |force: &str| format!("{body}[body_force]\nvalue = [0, \"{force}\"]\n");
    assert_eq!(scene(&(heavy("-y") + grid)).model(), Model::Bem);
    assert!(scene(&heavy("-y")).problem.has_several_bodies());
    assert_eq!(scene(&(heavy("-y*y") + grid)).model(), Model::FemBem);
    let jump = heavy("-1").replace("remote_stress", "stress_jump = [\"x\", 0, 0]\nremote_stress");
    assert_eq!(scene(&(jump.clone() + grid)).model(), Model::FemBem);
    for (text, word) in [
        (heavy("-y*y"), "give a force a + b*x + c*y, or add [grid]"),
        (jump, "write exterior.stress_jump as exterior.traction_jump"),
        (heavy("-1") + "[sides.rock]\npressure = 1\n", "meets the medium"),
    ] {
        let error = parse(&text, &[]).expect_err(word).render();
        assert!(error.contains(word), "{error}");
    }
}
