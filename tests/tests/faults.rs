//! Linear algebra that goes wrong: factors, products and solutions are spoilt while scenes are solved.
//!
//! Each run ends with the right answer, or with an error or a doubt that names what is wrong. With `STEKLOV_FAULTS=full` a thousand
//! faults are made, else a hundred.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicUsize;

use steklov_algebra::{Spoiler, disarm, is_fault};
use steklov_model::error::SolveError;
use steklov_model::grid::OnGrid;
use steklov_model::run::adaptive_loop::{Model, Progress, Run, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::stochastic::OutcomesWatch;
use steklov_model::summary::Summary;
use steklov_problem::Scene;
use steklov_quadrature::{splitmix64, unit_uniform};
use steklov_tests::scene;

const SEED: u64 = 20_261_124;
/// Part of the energy that its rounding may be, where no uncertainty is told.
const ROUNDING: f64 = 1e-9;

/// A scene of every model, with less to do than in the gallery.
const SCENES: [(&str, &[&str]); 10] = [
    ("19-l-shape", &["method.tolerance=1e-2"]),
    ("12-hertz", &["method.tolerance=2e-2"]),
    ("15-block-on-floor", &["method.tolerance=2e-2"]),
    ("25-coulomb-wedge", &["method.tolerance=2e-2"]),
    ("60-two-cylinders", &["method.tolerance=5e-2"]),
    ("32-bar-on-a-grid", &[]),
    ("34-laminate", &[]),
    ("40-transmission", &[]),
    ("44-kirsch-in-the-plane", &["method.tolerance=1e-2"]),
    ("31-random-load-and-modulus", &["method.tolerance=5e-2", "stochastic.degree=1"]),
];

/// What a run with a fault came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    SameNumbers,
    WithinUncertainty,
    NamedFault,
    OtherError,
    Doubt,
    Silent,
}

fn summary_of<M: Model>(scene: &Scene, first: Progress<M>) -> Result<Summary, SolveError> {
    let never = AtomicUsize::new(0);
    let mut run: Run<M> = run(scene, first, &never, &mut |_, _| Ok(()))?;
    let outcomes = M::outcomes(scene, &mut run, &OutcomesWatch::NONE, &mut |_| Ok(()))?;
    if let Some(error) = run.error {
        return Err(error);
    }
    let mut summary = Summary::of_run(scene, &run, outcomes.as_ref());
    (summary.seconds, summary.peak_memory_bytes) = (Default::default(), 0);
    Ok(summary)
}

fn told(scene: &Scene) -> Result<Summary, SolveError> {
    match scene.is_on_grid() {
        true => summary_of::<OnGrid>(scene, Progress::<OnGrid>::new(scene, Vec::new())?),
        false => summary_of::<BoundaryElements>(scene, Progress::first(scene)),
    }
}

/// How far an answer is off, over what it tells of that.
fn off(told: &Summary, wanted: &Summary) -> f64 {
    let energy = |s: &Summary| s.energy_extrapolated.unwrap_or(s.energy);
    let uncertainty = |s: &Summary| s.energy_uncertainty.unwrap_or(0.0).max(ROUNDING * energy(s).abs());
    (energy(told) - energy(wanted)).abs() / uncertainty(told).max(uncertainty(wanted))
}

fn end(answer: Result<Summary, SolveError>, wanted: &Summary) -> End {
    match answer {
        Err(error) if is_fault(&error) => End::NamedFault,
        Err(_) => End::OtherError,
        Ok(told) if told == *wanted => End::SameNumbers,
        Ok(told) if told.converged == wanted.converged && off(&told, wanted) <= 1.0 => End::WithinUncertainty,
        Ok(told) if told.failure.is_some() || told.estimate_doubts.len() > wanted.estimate_doubts.len() => End::Doubt,
        Ok(_) => End::Silent,
    }
}

/// One of the bits of an exponent or of the first of a mantissa, NaN, or a column that ends in zeros.
fn kind(seed: u64) -> (&'static str, u32) {
    let draw = |n: u32| (unit_uniform(seed, 2) * f64::from(n)) as u32;
    match (unit_uniform(seed, 1) * 4.0) as u32 {
        0 => ("exponent", 52 + draw(11)),
        1 => ("mantissa", 46 + draw(6)),
        2 => ("NaN", 63),
        _ => ("zeros", 64),
    }
}

#[test]
fn no_fault_is_silent() {
    let full = std::env::var("STEKLOV_FAULTS").is_ok_and(|v| v == "full");
    let each = if full { 100 } else { 10 };
    let mut counts: BTreeMap<(&str, End), usize> = BTreeMap::new();
    let mut silent = Vec::new();
    for (number, (name, overrides)) in SCENES.into_iter().enumerate() {
        let scene = scene(name, overrides);
        Spoiler { after: usize::MAX, kind: 63, seed: 0, lasting: false }.arm();
        let wanted = told(&scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let (results, _) = disarm();
        assert!(results > 0, "{name}: nothing is checked");
        let clock = std::time::Instant::now();
        for fault in 0..each {
            let seed = splitmix64(SEED, 1000 * number as u64 + fault);
            let (word, kind) = kind(seed);
            let after = (unit_uniform(seed, 3) * results as f64) as usize;
            let lasting = unit_uniform(seed, 4) < 0.5;
            Spoiler { after, kind, seed, lasting }.arm();
            let answer = told(&scene);
            let (_, faults) = disarm();
            assert!(faults > 0, "{name}: fault {after} of {results} was not made");
            if let Err(error) = &answer
                && !is_fault(error)
            {
                println!("{name}, {word} in result {after} of {results}: {error}");
            }
            let end = end(answer, &wanted);
            *counts.entry((word, end)).or_default() += 1;
            if end == End::Silent {
                silent.push(format!("{name}: {word} ({kind}) in result {after} of {results}, lasting: {lasting}"));
            }
        }
        println!("{name}: {results} results, {:.2} s a run", clock.elapsed().as_secs_f64() / each as f64);
    }
    counts.iter().for_each(|((word, end), count)| println!("{word:10} {end:?}: {count}"));
    assert!(silent.is_empty(), "{silent:#?}");
    let of = |wanted: End| counts.iter().filter(|((_, end), _)| *end == wanted).map(|(_, n)| n).sum::<usize>();
    // what passes is repaired on one thread, what lasts is named
    assert!(of(End::SameNumbers) + of(End::WithinUncertainty) > 3 * each as usize, "{counts:?}");
    assert!(of(End::NamedFault) > 3 * each as usize, "{counts:?}");
}
