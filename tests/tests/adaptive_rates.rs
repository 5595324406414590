//! Rates: uniform meshes converge as the strongest singularity lets them, adaptive ones faster.
//!
//! The energy error is like h^λ with u ~ r^λ at the strongest singularity that h > 0 sees.

use steklov_problem::{Indicator, Refine};
use steklov_tests::{Judged, adapt, full, judged, line, step_below};

fn problem(name: &str) -> Judged {
    judged().into_iter().find(|p| p.name == name).expect("a problem of that name")
}

/// The root of a function that changes its sign once between two numbers.
fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let rises = f(high) > 0.0;
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if (f(middle) > 0.0) == rises {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

/// λ of a corner ω between free sides: sin²(λω) = λ² sin²ω (Williams 1952).
fn free_corner(omega: f64) -> f64 {
    root(|l| (l * omega).sin().powi(2) - (l * omega.sin()).powi(2), 0.51, 0.9)
}

/// λ of a corner ω between a held and a free side in plane strain: sin²(λω) = ((κ+1)² - 4 λ² sin²ω)/(4κ), κ = 3 - 4ν.
fn held_corner(omega: f64, poisson: f64) -> f64 {
    let kappa = 3.0 - 4.0 * poisson;
    let f =
        |l: f64| (l * omega).sin().powi(2) - ((kappa + 1.0).powi(2) - 4.0 * (l * omega.sin()).powi(2)) / (4.0 * kappa);
    root(f, 0.1, 0.99)
}

/// Root mean squares, over some uniform meshes an octave, of the energy's error and of the estimate. The mean levels where
/// the ends of contact happen to lie in their elements.
fn octaves(problem: &Judged, degree: usize, sides: &[usize], meshes: usize) -> Vec<[f64; 2]> {
    let octave = |&side: &usize| {
        let mut sums = [0.0; 2];
        for k in 0..meshes {
            let mut scene = problem.scene.clone();
            scene.method.refine = Refine::None;
            scene.method.degree = degree;
            scene.method.elements = Some(4 * (side + k * side / meshes));
            let run = adapt(&scene).unwrap_or_else(|e| panic!("{}: {e}", problem.name));
            sums[0] += problem.energy_error(run.step()).powi(2);
            sums[1] += run.step().estimate().relative.powi(2);
        }
        sums.map(|s| (s / meshes as f64).sqrt())
    };
    sides.iter().map(octave).collect()
}

/// Slopes of log error on log h, of the energy's error and of the estimate.
fn slopes(name: &str, degree: usize, meshes: usize) -> [f64; 2] {
    let sides: &[usize] = if degree == 1 { &[16, 32, 64] } else { &[8, 16, 32] };
    let errors = octaves(&problem(name), degree, sides, meshes);
    let h: Vec<f64> = sides.iter().map(|&n| -(n as f64).ln()).collect();
    let slopes = [0, 1].map(|i| line(&h, &errors.iter().map(|e| e[i].ln()).collect::<Vec<_>>()).0);
    let [of_energy, estimated] = slopes;
    println!("{name} p {degree}: {of_energy:.3} (energy), {estimated:.3} (estimate)");
    slopes
}

/// λ = 0.5445 at the re-entrant corner, for every degree.
#[test]
fn uniform_meshes_of_the_l_shape_converge_like_its_corner() {
    let lambda = free_corner(1.5 * std::f64::consts::PI);
    assert!((lambda - 0.544_483_736_782_464).abs() < 1e-12, "{lambda}");
    for degree in 1..=3 {
        let [of_energy, _] = slopes("L", degree, 1);
        assert!((of_energy / lambda - 1.0).abs() <= 0.1, "p = {degree}: {of_energy}, not {lambda}");
    }
}

/// u_n ~ r^(3/2) at the ends of contact, and p + ½ is no less.
#[test]
fn uniform_meshes_of_the_block_converge_like_its_ends_of_contact() {
    let slopes = [1, 2, 3].map(|degree| slopes("block", degree, 8));
    let pooled = slopes.iter().map(|s| s[0]).sum::<f64>() / 3.0;
    println!("block: {pooled:.3} (energy), all degrees together");
    assert!((pooled / 1.5 - 1.0).abs() <= 0.1, "{pooled}");
    for [_, estimated] in slopes {
        assert!((estimated / 1.5 - 1.0).abs() <= 0.1, "{estimated}");
    }
}

/// Between λ = 0.71 at the held corners, which is what remains, and λ = 1 (with a logarithm) at the ridge, which prevails on
/// such meshes.
#[test]
fn uniform_meshes_of_the_wedge_converge_like_corners_and_ridge() {
    let lambda = held_corner(std::f64::consts::FRAC_PI_2, 0.3);
    assert!((lambda - 0.711).abs() < 1e-3, "{lambda}");
    for degree in 1..=3 {
        let [_, estimated] = slopes("wedge", degree, 2);
        assert!(0.9 * lambda <= estimated && estimated <= 1.1, "p = {degree}: {estimated}");
    }
}

/// Unknowns from which the energy error stays at most so large; infinite if 600 are not enough.
fn dofs(problem: &Judged, refine: Refine, indicator: Indicator, level: f64) -> f64 {
    let mut scene = problem.scene.clone();
    scene.method.refine = refine;
    scene.method.indicator = indicator;
    // what comes after it has no say
    (scene.method.tolerance, scene.method.max_dofs) = (Some(0.3 * level), Some(600));
    let run = adapt(&scene).unwrap_or_else(|e| panic!("{}: {e}", problem.name));
    let steps = &run.progress.steps;
    let errors: Vec<f64> = steps.iter().map(|s| problem.energy_error(s)).collect();
    step_below(&errors, level).map_or(f64::INFINITY, |k| steps[k].dofs as f64)
}

/// The fewer unknowns the more is decided: halving or raising by the decay of coefficients, halving where it helps, halving
/// all.
#[test]
fn hp_beats_h_beats_uniform() {
    let both = &[Indicator::Bubble, Indicator::Residual][..];
    let of_wedge = if full() { both } else { &both[..1] };
    for (name, level, indicators) in [("block", 1e-3, both), ("wedge", 1e-3, of_wedge), ("L", 3e-3, both)] {
        let problem = problem(name);
        let uniform = dofs(&problem, Refine::UniformH, Indicator::Bubble, level);
        for &indicator in indicators {
            let [hp, h] = [Refine::HpDecay, Refine::H].map(|refine| dofs(&problem, refine, indicator, level));
            println!("{name} {level:e} {indicator:?}: hp-decay {hp}, h {h}, uniform-h {uniform}");
            assert!(hp < h && h < uniform, "{name} {indicator:?}: {hp}, {h}, {uniform}");
        }
    }
}
