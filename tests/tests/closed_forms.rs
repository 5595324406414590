//! Singular solutions of unbounded bodies: a crack, Hertz's contact, the flat punch. The bodies here are finite, so what
//! is judged besides the level is how the deviation shrinks with the size.

use std::f64::consts::PI;

use steklov_model::answer::report::contact_summary;
use steklov_model::run::adaptive_loop::{Reason, Run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::solve::contact_rows::{ContactRow, contact_rows};
use steklov_model::summary::ContactSummary;
use steklov_problem::Scene;
use steklov_tests::{adapt, line, parse, scene};

fn solved(scene: &Scene) -> Run<BoundaryElements> {
    let run = adapt(scene).unwrap_or_else(|e| panic!("{}: {e}", scene.title));
    assert_eq!(run.reason, Reason::Tolerance, "{}", scene.title);
    run
}

fn displacement(run: &Run<BoundaryElements>, at: [f64; 2]) -> [f64; 2] {
    let points = &run.last.space.points;
    let i = points.iter().position(|x| *x == at).expect("a node");
    [run.last.displacement[2 * i], run.last.displacement[2 * i + 1]]
}

/// Logarithms of numbers.
fn logs(numbers: &[f64]) -> Vec<f64> {
    numbers.iter().map(|x| x.ln()).collect()
}

/// Opening at the middle of a crack of half-length 1 and half-width h, in a square plate of half-size b, over that of the
/// crack in the unbounded plate, 2σa/E' = 0.01; less 1.
fn crack(b: f64, h: f64) -> f64 {
    let plate = format!("body.corners=[[-{b:?}, -{b:?}], [{b:?}, -{b:?}], [{b:?}, {b:?}], [-{b:?}, {b:?}]]");
    let names = r#"["crack", "crack", "crack", "crack"]"#;
    let slit = format!("body.holes=[{{corners=[[1, 0], [0, {h:?}], [-1, 0], [0, -{h:?}]], sides={names}}}]");
    let run = solved(&scene("crack", &[&plate, &slit, "probe.points=[]", "method.tolerance=1e-4"]));
    displacement(&run, [0.0, h])[1] / 0.01 - 1.0
}

/// The plate adds like (a/b)², the slit's width takes away like h/a; with both gone Griffith's opening is left.
#[test]
fn a_crack_opens_like_griffiths() {
    let thin = 1.0 / 16384.0;
    let sizes = [10.0, 20.0, 40.0];
    let plates = sizes.map(|b| crack(b, thin));
    let (rate, _) = line(&logs(&sizes), &logs(&plates));
    println!("plates {plates:.6?}, rate {rate:.3}");
    assert!((rate + 2.0).abs() < 0.05, "{rate}");
    let widths = [1024.0, 4096.0, 16384.0].map(|n: f64| crack(20.0, 1.0 / n));
    let ratio = (widths[1] - widths[0]) / (widths[2] - widths[1]);
    println!("widths {widths:.6?}, ratio of differences {ratio:.3}");
    assert!((ratio - 4.0).abs() < 0.2 && widths[0] < widths[1], "{ratio}");
    let left = (4.0 * plates[2] - plates[1]) / 3.0 + (widths[2] - widths[1]) / 3.0;
    println!("unbounded, without width: {left:.1e}");
    assert!(left.abs() < 3e-5, "{left:e}");
}

fn contact(scene: &Scene, run: &Run<BoundaryElements>) -> (Vec<ContactRow>, ContactSummary) {
    let contact = run.last.contact.as_ref().expect("contact");
    let rows = contact_rows(run.last.trace(), contact);
    let summary = contact_summary(
        scene,
        run.last.trace(),
        contact,
        &rows,
        steklov_model::answer::report::located(scene, &run.step().layout.located),
    );
    (rows, summary)
}

/// a and p0 = E* a/(2R) are those of the half-plane up to (a/size)²: the end lies a little too far out, the pressure is a
/// little too low.
#[test]
fn hertz_holds_the_better_the_smaller_the_contact() {
    let halves = [0.1, 0.05, 0.025, 0.0125];
    let deviations = halves.map(|a| {
        let scene = scene("hertz-block", &[&format!("parameters.a={a}"), "method.tolerance=1e-5"]);
        let (_, contact) = contact(&scene, &solved(&scene));
        let ends = contact.ends.expect("an end of contact");
        assert_eq!(ends.len(), 1, "{ends:?}");
        [ends[0][0] / a - 1.0, 1.0 - contact.max_pressure / (1000.0 * a / 2.0)]
    });
    for (i, what) in ["end of contact", "largest pressure"].into_iter().enumerate() {
        let of = deviations.map(|d| d[i]);
        let (rate, _) = line(&logs(&halves), &logs(&of));
        println!("{what}: {of:.6?}, rate {rate:.3}");
        assert!((rate - 2.0).abs() < 0.1 && of[3] < 1e-4, "{what}: rate {rate}, {of:?}");
    }
}

/// p = P/(π √(a²-x²)) below the punch: exponent -½ at its edge and the coefficient P/√(πa) of p √(2πd). Beside it
/// u_n = (2P/(πE*)) arcosh(x/a), exponent ½. And the error falls exponentially.
#[test]
fn a_flat_punch_has_its_singularity() {
    let (load, a, modulus) = (PI, 0.1, 1000.0);
    let scene = scene("flat-punch", &[]);
    let run = solved(&scene);
    let (rows, _) = contact(&scene, &run);

    // nodes on four decades below the edge, where a²-x² = 2ad
    let below: Vec<(f64, f64)> =
        rows.iter().map(|r| (a - r.point[0], r.pressure)).filter(|(d, _)| (1e-7..1e-3).contains(d)).collect();
    let (d, p): (Vec<f64>, Vec<f64>) = below.into_iter().unzip();
    let (exponent, _) = line(&logs(&d), &logs(&p));
    let intensities: Vec<f64> = d.iter().zip(&p).map(|(d, p)| p * (2.0 * PI * d).sqrt()).collect();
    let intensity = intensities.iter().sum::<f64>() / intensities.len() as f64;
    let exact = load / (PI * a).sqrt();
    println!("{} nodes: p ~ d^{exponent:.4}, intensity {intensity:.4}, exact {exact:.4}", d.len());
    assert!(d.len() >= 20 && (exponent + 0.5).abs() < 0.005, "{exponent}");
    assert!((intensity / exact - 1.0).abs() < 0.005, "{intensity} instead of {exact}");

    let edge =
        displacement(&run, *rows.iter().map(|r| &r.point).find(|x| (x[0] - a).abs() < 1e-12).expect("a node"))[1];
    let beside: Vec<f64> = rows.iter().map(|r| r.point[0]).filter(|x| (1e-4..1e-2).contains(&(x - a))).collect();
    let lift: Vec<f64> = beside.iter().map(|&x| edge - displacement(&run, [x, 0.0])[1]).collect();
    let distance: Vec<f64> = beside.iter().map(|x| x - a).collect();
    let (exponent, _) = line(&logs(&distance), &logs(&lift));
    let worst =
        beside.iter().zip(&lift).map(|(x, l)| (l / (2.0 * load / (PI * modulus) * (x / a).acosh()) - 1.0).abs());
    let worst = worst.fold(0.0, f64::max);
    println!("beside it: u_n ~ d^{exponent:.4}, off by {worst:.1e}");
    assert!((exponent - 0.5).abs() < 0.01 && worst < 5e-3, "{exponent}, {worst:e}");

    let steps = &run.progress.steps;
    let dofs: Vec<f64> = steps.iter().map(|s| (s.dofs as f64).sqrt()).collect();
    let (slope, straight) = line(&dofs, &steps.iter().map(|s| s.estimate().relative.ln()).collect::<Vec<_>>());
    println!("log estimate over dofs^½: slope {slope:.3}, R² {straight:.4}");
    assert!(slope < 0.0 && straight >= 0.97 && steps.len() >= 8);
}

/// A strip that is held at one end and pulled at the other: J = -(1-ν²) h/2E but for what its held end takes of it, as long as
/// bending leaves digits; then it is told that none are left, not that nothing holds it.
#[test]
fn strips_are_solved_or_told_to_be_thin() {
    let strip = |h: f64| {
        let text = format!(
            "body.corners = [[0,0],[1,0],[1,{h:?}],[0,{h:?}]]\nbody.sides = [\"bottom\",\"right\",\"top\",\"left\"]\n\
             material = {{ young = 100, poisson = 0.3 }}\nsides.left.displacement = [\"0\",\"0\"]\n\
             sides.right.traction = [\"1\",\"0\"]\n"
        );
        adapt(&parse(&text, &[]).unwrap())
    };
    for h in [1e-2, 1e-3] {
        let run = strip(h).unwrap();
        let [found, exact] = [run.step().energy, -0.91 * h / 200.0];
        assert!(run.converged() && (found / exact - 1.0).abs() < h, "{h}: {found} {exact}");
    }
    let later = strip(1e-4).unwrap().error.unwrap().to_string();
    assert!(later.contains("1.000e-4 thick over") && later.contains("takes 12 of the 16 digits"), "{later}");
    let error = strip(1e-6).err().unwrap().to_string();
    assert!(error.contains("1.000e-6 thick over a length of 1.000e0"), "{error}");
    assert!(error.contains("takes 16 of the 16 digits") && !error.contains("rigid motion"), "{error}");
}
