//! A homogeneous body in an unbounded medium, by boundary elements on both sides: closed forms, rates, the estimate.

use std::f64::consts::PI;
use std::fmt::Write;

use steklov_bem_operators::BemError;
use steklov_document::SceneErrorKind;
use steklov_model::error::SolveError;
use steklov_model::run::adaptive_loop::{Reason, Run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_problem::{DataErrorKind, Scene};
use steklov_tests::{Levels, adapt, line, parse, solved_beyond, solved_in_steps};

/// A material by Young's modulus and Poisson's ratio.
#[derive(Clone, Copy)]
struct Elastic {
    young: f64,
    poisson: f64,
    stress: bool,
}

impl Elastic {
    fn mu(self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// Kolosov's constant.
    fn kappa(self) -> f64 {
        if self.stress { (3.0 - self.poisson) / (1.0 + self.poisson) } else { 3.0 - 4.0 * self.poisson }
    }

    /// u_r/r under a uniform stress σ I.
    fn swelling(self) -> f64 {
        (self.kappa() - 1.0) / (4.0 * self.mu())
    }
}

const SQUARE: [[f64; 2]; 4] = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];

/// A regular polygon with its corners on the unit circle, the first of them at (1, 0).
fn circle(n: usize) -> Vec<[f64; 2]> {
    let angle = |k: usize| 2.0 * PI * k as f64 / n as f64;
    (0..n).map(|k| [angle(k).cos(), angle(k).sin()]).collect()
}

/// The scene of a body of one side in a medium; `rest` are the lines after the moduli of the medium.
fn text(corners: &[[f64; 2]], body: Elastic, medium: Elastic, rest: &str) -> String {
    let mut text = format!("title = \"inclusion\"\n[body]\ncorners = {corners:?}\nsides = [");
    corners.iter().for_each(|_| text.push_str("\"rim\", "));
    let plane = if body.stress { "stress" } else { "strain" };
    write!(
        text,
        "]\n[material]\nyoung = {:?}\npoisson = {:?}\nplane = {plane:?}\n[exterior]\nyoung = {:?}\npoisson = {:?}\n{rest}",
        body.young, body.poisson, medium.young, medium.poisson
    )
    .unwrap();
    text
}

fn scene(text: &str, overrides: &[&str]) -> Scene {
    parse(text, overrides).unwrap_or_else(|e| panic!("{}", e.render()))
}

fn solved(scene: &Scene) -> Run<BoundaryElements> {
    let run = adapt(scene).unwrap_or_else(|e| panic!("{e}"));
    assert!(run.converged(), "{:?}", run.reason);
    run
}

fn at(run: &Run<BoundaryElements>, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
    run.last.around.as_ref().expect("a medium").at(x)
}

/// The nodal displacement at a point.
fn node(run: &Run<BoundaryElements>, x: [f64; 2]) -> [f64; 2] {
    let near = |y: &[f64; 2]| (y[0] - x[0]).hypot(y[1] - x[1]) < 1e-12;
    let i = run.last.space.points.iter().position(near).expect("a node");
    [run.last.displacement[2 * i], run.last.displacement[2 * i + 1]]
}

fn off<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// With equal materials nothing is there: the remote stress inside and out, and no error to estimate.
#[test]
fn an_interface_between_equal_materials_is_invisible() {
    for (stress, infinity) in [(false, "decaying"), (true, "bounded")] {
        let m = Elastic { young: 2.0, poisson: 0.3, stress };
        let rest = format!("remote_stress = [1, 0.5, 0.25]\nat_infinity = {infinity:?}\n[method]\ndegree = 2");
        // its centroid is not where the remote displacement is zero
        let corners = [[0.3, -0.5], [0.9, -0.4], [1.2, 0.6], [0.4, 0.2], [-0.6, 0.3]];
        let scene = scene(&text(&corners, m, m, &rest), &[]);
        let run = solved(&scene);
        let along =
            |a: f64, b: f64| (m.kappa() + 1.0) / (8.0 * m.mu()) * (a - (3.0 - m.kappa()) / (1.0 + m.kappa()) * b);
        let strain = [[along(1.0, 0.5), 0.125 / m.mu()], [0.125 / m.mu(), along(0.5, 1.0)]];
        let shift = {
            // bounded: the mean of u over the interface is zero
            let (mut mean, mut length) = ([0.0; 2], 0.0);
            let mesh = &run.last.mesh;
            for e in 0..mesh.len() {
                length += mesh.length(e);
                let [x, y] = mesh.point(e, 0.0);
                (0..2).for_each(|i| mean[i] += mesh.length(e) * (strain[i][0] * x + strain[i][1] * y));
            }
            if infinity == "bounded" { mean.map(|m| m / length) } else { [0.0; 2] }
        };
        let want = |[x, y]: [f64; 2]| [0, 1].map(|i| strain[i][0] * x + strain[i][1] * y - shift[i]);
        for (x, inside) in [([0.3, 0.0], true), ([2.0, 1.0], false), ([-30.0, 40.0], false)] {
            let (u, sigma) = if inside { run.last.inside(0, x) } else { at(&run, x) };
            assert!(off(u, want(x)) < 1e-10 && off(sigma, [1.0, 0.5, 0.25]) < 1e-10, "{x:?}: {u:?} {sigma:?}");
        }
        let step = run.step();
        let estimate = step.estimate.as_ref().expect("an estimate");
        assert!(estimate.relative < 1e-10 && run.progress.steps.len() == 1, "{:e}", estimate.relative);
    }
}

/// Goodier's circular inclusion under tension S along x: uniform stress inside, (p + q, p - q, 0).
fn goodier(body: Elastic, medium: Elastic, s: f64) -> ([f64; 2], [f64; 3]) {
    let (m1, m2, k1, k2) = (body.mu(), medium.mu(), body.kappa(), medium.kappa());
    let p = s / 2.0 * (k2 + 1.0) * m1 / ((k1 - 1.0) * m2 + 2.0 * m1);
    let q = s / 2.0 * (k2 + 1.0) * m1 / (m2 + k2 * m1);
    let strain = [1.0, -1.0].map(|sign| (k1 - 1.0) * p / (4.0 * m1) + sign * q / (2.0 * m1));
    (strain, [p + q, p - q, 0.0])
}

#[test]
fn a_circular_inclusion_has_goodiers_uniform_stress() {
    for (stress, ratio) in [(false, 0.1), (false, 10.0), (true, 0.1), (true, 10.0)] {
        let medium = Elastic { young: 3.0, poisson: 0.25, stress };
        let body = Elastic { young: 3.0 * ratio, poisson: 0.35, stress };
        let (strain, sigma) = goodier(body, medium, 2.0);
        let sizes = [12, 24, 48];
        let errors = sizes.map(|n| {
            let method = format!("refine = \"none\"\nelements = {}\ndegree = 4", 2 * n);
            let rest = format!("remote_stress = [2, 0, 0]\n[method]\n{method}");
            let run = solved(&scene(&text(&circle(n), body, medium, &rest), &[]));
            let ([ux, _], [_, uy]) = (node(&run, [1.0, 0.0]), node(&run, [0.0, 1.0]));
            let displacement = (ux / strain[0] - 1.0).abs().max((uy - strain[1]).abs() / strain[0].abs());
            let (_, inside) = run.last.inside(0, [0.3, 0.2]);
            // far outside the perturbation falls like r^-2
            let (_, far) = at(&run, [200.0, 100.0]);
            assert!(off(far, [2.0, 0.0, 0.0]) < 2e-4, "{far:?}");
            [displacement, off(inside, sigma) / sigma[0]]
        });
        for k in 0..2 {
            let error = errors.map(|e| e[k]);
            let rates = [0, 1].map(|i| (error[i] / error[i + 1]).log2());
            println!("plane stress {stress}, E1/E2 {ratio}: {error:?}, rates {rates:.2?}");
            // the stress inside gains an order
            let order = if k == 0 { 2.0 } else { 3.0 };
            assert!(rates.iter().all(|r| (r - order).abs() < 0.3) && error[2] < 0.01, "{error:?}");
        }
    }
}

/// A disc of radius 1 + δ in a hole of radius 1: Lamé's pressure, uniform inside.
#[test]
fn a_shrink_fit_has_lames_pressure() {
    for stress in [false, true] {
        let body = Elastic { young: 5.0, poisson: 0.2, stress };
        let medium = Elastic { young: 1.0, poisson: 0.3, stress };
        let delta = 0.01;
        let p = delta / (body.swelling() + 1.0 / (2.0 * medium.mu()));
        let errors = [16, 32].map(|n| {
            let method = format!("refine = \"none\"\nelements = {}\ndegree = 4", 2 * n);
            let rest = format!("displacement_jump = [\"-0.01*x\", \"-0.01*y\"]\n[method]\n{method}");
            let run = solved(&scene(&text(&circle(n), body, medium, &rest), &[]));
            let (u, sigma) = at(&run, [3.0, 0.0]);
            let far = p / (2.0 * medium.mu() * 3.0);
            let inside = run.last.inside(0, [0.3, 0.2]).1;
            [off(inside, [-p, -p, 0.0]) / p, (u[0] / far - 1.0).abs(), off(sigma, [-p / 9.0, p / 9.0, 0.0]) / p]
        });
        println!("{errors:?}");
        for (coarse, fine) in errors[0].iter().zip(errors[1]) {
            assert!((coarse / fine).log2() > 1.7 && fine < 0.01, "{errors:?}");
        }
    }
}

/// Second derivatives Φ,xx and Φ,xy of ∫ log|x - y| dy over the square |x|, |y| < a; Φ,xx + Φ,yy is 2π inside and 0 outside.
fn potential(a: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let side = |d: f64| ((a - y) / d).atan() + ((a + y) / d).atan();
    let log = |d: f64| 0.5 * ((d * d + (a - y).powi(2)) / (d * d + (a + y).powi(2))).ln();
    [side(x + a) - side(x - a), log(x - a) - log(x + a)]
}

/// A square that is too large for its square hole by δ, of the same material: by a thermoelastic potential the trace of the
/// stress is uniform inside and zero outside, with logarithms at the corners.
#[test]
fn a_misfitting_square_has_the_stresses_of_its_potential() {
    let m = Elastic { young: 2.6, poisson: 0.3, stress: false };
    let (mu, lambda) = (m.mu(), 2.0 * m.mu() * 0.3 / 0.4);
    let delta = 0.02;
    let swollen = delta / (1.0 - 0.3);
    let rest = "displacement_jump = [\"-0.02*x\", \"-0.02*y\"]\n[method]\ntolerance = 1e-6\nmax_dofs = 2000\n";
    let run = solved(&scene(&text(&SQUARE, m, m, rest), &[]));
    assert_eq!(run.reason, Reason::Tolerance);
    for (x, inside) in [
        ([0.0, 0.0], true),
        ([0.3, -0.1], true),
        ([-0.45, 0.42], true),
        ([0.8, 0.1], false),
        ([0.55, 0.56], false),
        ([-3.0, 2.0], false),
    ] {
        let [xx, xy] = potential(0.5, x).map(|p| swollen / (2.0 * PI) * p);
        let trace = if inside { swollen } else { 0.0 };
        let own = if inside { lambda * swollen - 2.0 * (lambda + mu) * delta } else { 0.0 };
        let want = [own + 2.0 * mu * xx, own + 2.0 * mu * (trace - xx), 2.0 * mu * xy];
        let found = if inside { run.last.inside(0, x).1 } else { at(&run, x).1 };
        println!("{x:?}: {:.1e}", off(found, want) / (mu * delta));
        assert!(off(found, want) < 1e-5 * mu * delta, "{x:?}: {found:?} {want:?}");
    }
}

/// Inside u = ∇(e^x cos y), outside the difference of two Kelvin solutions with the force (8, 5) at points of the body: the scene
/// with these jumps on a square.
fn manufactured(method: &str) -> Scene {
    let body = Elastic { young: 20.0, poisson: 0.2, stress: false };
    let medium = Elastic { young: 2.0, poisson: 0.3, stress: false };
    let (mu, kappa) = (medium.mu(), medium.kappa());
    let c = 1.0 / (2.0 * PI * mu * (1.0 + kappa));
    let [f, g] = [8.0, 5.0];
    let sources = [([0.12, 0.07], 1.0), ([-0.1, -0.05], -1.0)];
    let mut u = ["exp(x)*cos(y)".to_owned(), "-exp(x)*sin(y)".to_owned()];
    let m = 2.0 * body.mu();
    let mut sigma = [format!("{m}*exp(x)*cos(y)"), format!("-{m}*exp(x)*cos(y)"), format!("-{m}*exp(x)*sin(y)")];
    for ([a, b], sign) in sources {
        let [x, y] = [format!("(x-({a}))"), format!("(y-({b}))")];
        let (r2, along) = (format!("({x}^2+{y}^2)"), format!("({f}*{x}+{g}*{y})"));
        for (u, (force, d)) in u.iter_mut().zip([(f, &x), (g, &y)]) {
            write!(u, "-({})*({}*log({r2})+{d}*{along}/{r2})", sign * c, -0.5 * kappa * force).unwrap();
        }
        // σ_ij = -q/r² [(κ-1)/2 (x_i F_j + x_j F_i - δ_ij x·F) + 2 x_i x_j x·F/r²]
        let q = 2.0 * mu * c * sign;
        let half = (kappa - 1.0) / 2.0;
        let parts = [
            format!("{half}*(2*{x}*{f}-{along})+2*{x}^2*{along}/{r2}"),
            format!("{half}*(2*{y}*{g}-{along})+2*{y}^2*{along}/{r2}"),
            format!("{half}*({x}*{g}+{y}*{f})+2*{x}*{y}*{along}/{r2}"),
        ];
        for (sigma, part) in sigma.iter_mut().zip(parts) {
            write!(sigma, "+({q})/{r2}*({part})").unwrap();
        }
    }
    let rest = format!("displacement_jump = {u:?}\nstress_jump = {sigma:?}\n[method]\n{method}");
    scene(&text(&SQUARE, body, medium, &rest), &[])
}

/// The exact displacement inside.
fn inner([x, y]: [f64; 2]) -> [f64; 2] {
    [x.exp() * y.cos(), -x.exp() * y.sin()]
}

/// J of [`manufactured`] from its tractions t inside and φ outside: ½ ∮ t·u - ½ ∮ φ·ξ - ∮ (t - φ)·u.
fn manufactured_energy() -> f64 {
    let body = Elastic { young: 20.0, poisson: 0.2, stress: false };
    let medium = Elastic { young: 2.0, poisson: 0.3, stress: false };
    let (mu, kappa) = (medium.mu(), medium.kappa());
    let (c, force) = (1.0 / (2.0 * PI * mu * (1.0 + kappa)), [8.0, 5.0]);
    let rule = steklov_quadrature::gauss_legendre(120).mapped(-0.5, 0.5);
    let density = |x: [f64; 2], n: [f64; 2]| {
        let (u, m) = (inner(x), 2.0 * body.mu());
        // σ = 2μ ε: the field is harmonic without a trace
        let t = [m * (u[0] * n[0] + u[1] * n[1]), m * (u[1] * n[0] - u[0] * n[1])];
        let (mut xi, mut phi) = ([0.0; 2], [0.0; 2]);
        for (at, sign) in [([0.12, 0.07], 1.0), ([-0.1, -0.05], -1.0)] {
            let d = [x[0] - at[0], x[1] - at[1]];
            let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
            let (r2, df, dn, nf) = (dot(d, d), dot(d, force), dot(d, n), dot(n, force));
            for i in 0..2 {
                xi[i] += sign * c * (-0.5 * kappa * force[i] * r2.ln() + d[i] * df / r2);
                let part = (kappa - 1.0) / 2.0 * (d[i] * nf + dn * force[i] - n[i] * df) + 2.0 * d[i] * dn * df / r2;
                phi[i] -= sign * 2.0 * mu * c / r2 * part;
            }
        }
        (0..2).map(|i| 0.5 * t[i] * u[i] - 0.5 * phi[i] * xi[i] - (t[i] - phi[i]) * u[i]).sum::<f64>()
    };
    let sides = [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];
    let point = |n: [f64; 2], s: f64| [0.5 * n[0] - s * n[1], 0.5 * n[1] + s * n[0]];
    sides.into_iter().map(|n| rule.integrate(|s| density(point(n, s), n))).sum()
}

/// The energy norm of the error falls like h^(p+½) and exponentially in p, and the estimate is near it all the way.
#[test]
fn a_manufactured_transmission_converges() {
    let fine = manufactured("tolerance = 1e-6");
    let run = solved(&fine);
    let levels = Levels::of(&run);
    for x in [[0.0, 0.0], [0.4, -0.3]] {
        assert!(off(run.last.inside(0, x).0, inner(x)) < 1e-6, "{x:?}");
    }
    // J extrapolated is right within what each step says, and much nearer than J itself
    let exact = manufactured_energy();
    let last = run.step().energy;
    assert!((last / exact - 1.0).abs() < 1e-10, "{last} {exact}");
    for step in run.progress.steps.iter().rev().skip(1) {
        let estimate = step.estimate.as_ref().unwrap();
        let (off, own) = ((estimate.energy - exact).abs(), (step.energy - exact).abs());
        println!("{} dofs: {own:.1e}, extrapolated {off:.1e}, uncertain {:.1e}", step.dofs, estimate.uncertainty);
        assert!(off <= estimate.uncertainty && off < 0.2 * own, "{off:e} {own:e}");
        assert!(estimate.uncertainty < 2.0 * own, "{:e} {own:e}", estimate.uncertainty);
    }
    let errors_of = |scene: &Scene| -> Vec<[f64; 3]> {
        let (run, displacements) = solved_in_steps(scene).unwrap();
        let steps = run.progress.steps.iter().zip(&displacements);
        steps
            .map(|(step, u)| {
                let truth = levels.true_error(scene, step, u).unwrap();
                [step.dofs as f64, truth.error / truth.norm, step.estimate.as_ref().unwrap().error / truth.error]
            })
            .collect()
    };
    for degree in 1..=3 {
        let method =
            format!("refine = \"uniform-h\"\ndegree = {degree}\nelements = 8\nmax_steps = 4\ntolerance = 1e-12");
        let found = errors_of(&manufactured(&method));
        let rates: Vec<f64> = found.windows(2).map(|s| (s[0][1] / s[1][1]).log2()).collect();
        println!("p = {degree}: rates {rates:?}, {found:?}");
        // from below: the sources are near
        assert!(rates.last() > Some(&(degree as f64 + 0.35)), "degree {degree}: {rates:?}");
        // what straight elements leave of a curved jump is bounded from above
        let most = if degree == 1 { 1.4 } else { 1.3 };
        assert!(found[1..].iter().all(|s| s[2] > 0.8 && s[2] < most), "{found:?}");
    }
    let found = errors_of(&manufactured("refine = \"uniform-p\"\nelements = 8\nmax_steps = 6\ntolerance = 1e-12"));
    println!("p: {found:?}");
    // by each degree a constant factor at least
    assert!(found.windows(2).all(|s| s[1][1] < 0.4 * s[0][1]), "{found:?}");
    assert!(found.iter().all(|s| s[2] > 0.7 && s[2] < 1.4), "{found:?}");
}

/// Bodies a thousand times as stiff as the medium, or as soft: the softer one is as good as held, and its error that of its traction,
/// which J knows. The estimate stays near the root of twice the error of J.
#[test]
fn the_estimate_is_the_error_of_j_at_any_contrast() {
    for ratio in [1e3, 1e-3] {
        let medium = Elastic { young: 1.0, poisson: 0.3, stress: false };
        let body = Elastic { young: ratio, poisson: 0.2, stress: false };
        let at = |tolerance: f64| {
            let rest = format!("remote_stress = [1, 0, 0.3]\n[method]\ntolerance = {tolerance}\nmax_dofs = 1500\n");
            adapt(&scene(&text(&SQUARE, body, medium, &rest), &[])).unwrap_or_else(|e| panic!("{e}"))
        };
        let exact = at(1e-5).step().energy;
        let run = at(2e-3);
        let effectivity: Vec<f64> = (run.progress.steps.iter())
            .map(|step| step.estimate().error / (2.0 * (step.energy - exact)).abs().sqrt())
            .collect();
        println!("E1/E2 = {ratio}: effectivity {effectivity:.2?}");
        assert!(effectivity.len() > 3 && effectivity.iter().all(|e| *e > 0.7 && *e < 1.4), "{ratio}: {effectivity:?}");
    }
}

/// A stiff square under tension: corners are singular, and the hp strategy converges like exp(-b N^½) all the same.
#[test]
fn a_stiff_square_converges_exponentially() {
    for ratio in [10.0, 0.1] {
        let medium = Elastic { young: 1.0, poisson: 0.3, stress: false };
        let body = Elastic { young: ratio, poisson: 0.2, stress: false };
        let rest = "remote_stress = [1, 0, 0.3]\n[method]\ntolerance = 2e-5\nmax_dofs = 1500\n";
        let scene = scene(&text(&SQUARE, body, medium, rest), &[]);
        let ((run, displacements), own) = solved_beyond(&scene, [1500; 2]).unwrap();
        let (steps, levels) = (&run.progress.steps[..own], Levels::of(&run));
        assert!(steps[own - 1].estimate().relative <= 2e-5);
        let (mut roots, mut errors, mut effectivity) = (Vec::new(), Vec::new(), Vec::new());
        for (step, u) in steps.iter().zip(&displacements) {
            let truth = levels.true_error(&scene, step, u).unwrap();
            roots.push((step.dofs as f64).sqrt());
            errors.push((truth.error / truth.norm).ln());
            effectivity.push(step.estimate.as_ref().unwrap().error / truth.error);
        }
        let (slope, r2) = line(&roots, &errors);
        println!("E1/E2 = {ratio}: {slope:.3}, R² {r2:.4}, effectivity {effectivity:.2?}");
        assert!(slope < -0.2 && r2 > 0.97, "{slope} {r2}");
        assert!(effectivity.iter().all(|e| *e > 0.8 && *e < 1.3), "{effectivity:?}");
        // the extrapolated energy is right within what it says
        let (last, uncertain) = (run.step().energy, &steps[own - 3]);
        let estimate = uncertain.estimate.as_ref().unwrap();
        assert!((estimate.energy - last).abs() <= estimate.uncertainty, "{estimate:?} {last}");
        // and that is no more than the square of the true error
        let truth = errors[errors.len() - 3].exp() * estimate.scale;
        assert!(estimate.uncertainty < truth * truth, "{:e} {truth:e}", estimate.uncertainty);
    }
}

/// Lengths in thousandths, stresses in other units: the same bits of information.
#[test]
fn units_do_not_matter() {
    let medium = Elastic { young: 1.0, poisson: 0.3, stress: false };
    let body = Elastic { young: 4.0, poisson: 0.2, stress: false };
    let found = [(1.0, 1.0), (1e3, 1.0), (1.0, 1e9), (1e-6, 1e-6)].map(|(length, stress): (f64, f64)| {
        let corners = SQUARE.map(|x| x.map(|x| length * x));
        let scaled = |m: Elastic| Elastic { young: stress * m.young, ..m };
        let rest = format!(
            "remote_stress = [{:?}, 0, 0]\ndisplacement_jump = [\"0.1*x\", \"0.2*y\"]\ntraction_jump = [\"{:?}*y\", 0]\n\
             [method]\nrefine = \"none\"\ndegree = 3\nelements = 8\n",
            0.5 * stress,
            stress / length
        );
        let run = solved(&scene(&text(&corners, scaled(body), scaled(medium), &rest), &[]));
        let (u, sigma) = at(&run, [0.9 * length, 0.4 * length]);
        let (v, tau) = run.last.inside(0, [0.1 * length, 0.3 * length]);
        let estimate = run.step().estimate.as_ref().unwrap().relative;
        [u[0] / length, u[1] / length, sigma[0] / stress, v[0] / length, tau[2] / stress, estimate]
    });
    for other in &found[1..] {
        assert!(off(found[0], *other) < 1e-9, "{found:?}");
    }
}

/// Of a net force the medium knows, and only the decaying solution takes it.
#[test]
fn a_net_force_needs_a_decaying_displacement() {
    let m = Elastic { young: 1.0, poisson: 0.3, stress: false };
    let rest = |infinity: &str| {
        format!("traction_jump = [1, 0]\nat_infinity = {infinity:?}\n[method]\nrefine = \"none\"\ndegree = 4\n")
    };
    let run = solved(&scene(&text(&SQUARE, m, m, &rest("decaying")), &[]));
    let around = run.last.around.as_ref().unwrap();
    assert!((around.balance.force[0] - 4.0).abs() < 1e-12 && !around.balance.is_balanced());
    // Kelvin's solution of the force 4 far away
    let (x, length) = ([3e3, 4e3], around.length);
    let c = 4.0 / (2.0 * PI * m.mu() * (1.0 + m.kappa()));
    let want = [c * (m.kappa() * (length / 5e3).ln() + 0.36), c * 0.48];
    assert!(off(around.at(x).0, want) < 1e-5 * c, "{:?} {want:?}", around.at(x).0);
    let error = adapt(&scene(&text(&SQUARE, m, m, &rest("bounded")), &[])).err().expect("nothing carries the force");
    assert!(matches!(error, SolveError::Bem(BemError::RigidMotion { .. })), "{error}");
}

/// Bounded at infinity with balanced loads: the same stresses, another translation, the mean over the interface zero.
#[test]
fn behaviour_at_infinity_is_a_translation() {
    let medium = Elastic { young: 1.0, poisson: 0.3, stress: false };
    let body = Elastic { young: 7.0, poisson: 0.2, stress: false };
    let corners = [[0.3, -0.5], [0.9, -0.4], [1.2, 0.6], [0.4, 0.2], [-0.6, 0.3]];
    let [a, b] = ["decaying", "bounded"].map(|infinity| {
        let rest =
            format!("remote_stress = [1, 2, 0]\nat_infinity = {infinity:?}\n[method]\nrefine = \"none\"\ndegree = 4\n");
        solved(&scene(&text(&corners, body, medium, &rest), &[]))
    });
    let (p, q) = (a.last.inside(0, [0.5, 0.0]), b.last.inside(0, [0.5, 0.0]));
    let shift = [0, 1].map(|i| q.0[i] - p.0[i]);
    for x in [[3.0, 1.0], [-1e4, 1e4]] {
        let ((u, sigma), (v, tau)) = (at(&a, x), at(&b, x));
        assert!(off(sigma, tau) < 1e-10 && off([0, 1].map(|i| v[i] - u[i]), shift) < 1e-10 * x[0].abs(), "{u:?} {v:?}");
    }
    assert!(off(p.1, q.1) < 1e-10 && off(b.last.around.as_ref().unwrap().constant, shift) < 1e-10);
    let (estimate, other) = (a.step().estimate.as_ref().unwrap(), b.step().estimate.as_ref().unwrap());
    // which counts the translation that is off at infinity, or does not
    let energies = [&a, &b].map(|run| run.last.energies.total);
    println!("{} {}, {energies:?}", estimate.error, other.error);
    assert!((estimate.error / other.error - 1.0).abs() < 0.02 && (energies[0] / energies[1] - 1.0).abs() < 1e-10);
    let (mut mean, mesh, space) = ([0.0; 2], &b.last.mesh, &b.last.space);
    for e in 0..mesh.len() {
        for (node, w) in space.element_nodes(e).zip(&space.basis(e).weights) {
            (0..2).for_each(|i| mean[i] += w * mesh.length(e) * b.last.displacement[2 * node + i]);
        }
    }
    assert!(off(mean, [0.0; 2]) < 1e-13, "{mean:?}");
}

#[test]
fn what_boundary_elements_on_both_sides_cannot_have_is_refused() {
    let m = Elastic { young: 1.0, poisson: 0.3, stress: false };
    let hole = "traction_jump = [1, 0]\n[[body.holes]]\ncorners = [[0, 0], [0.1, 0], [0, 0.1]]\nsides = [\"a\", \"a\", \"a\"]\n[method]\nmodel = \"bem\"\n";
    for (rest, word) in [
        ("traction_jump = [1, 0]\n[method]\nindicator = \"residual\"\n", "residual indicator"),
        ("[body_force]\nvalue = [0, \"x*y\"]\n[method]\nmodel = \"bem\"\n", "body force"),
        (&hole.replace("traction_jump = [1, 0]", "stress_jump = [1, 0, 0]"), "holes"),
    ] {
        let error = parse(&text(&SQUARE, m, m, rest), &[]).expect_err(word);
        assert!(
            error.kind == SceneErrorKind::Data(DataErrorKind::Unsupported) && error.to_string().contains(word),
            "{error}"
        );
    }
}
