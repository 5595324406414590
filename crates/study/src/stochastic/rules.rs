//! The stochastic rules of the study, and the finer rule that is their reference.

use std::ops::RangeInclusive;

use steklov_plan::points;
use steklov_problem::{Random, Sampling, Scene, Stochastic};

/// A family of rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Family {
    /// Its name.
    pub name: &'static str,
    /// What changes from rule to rule.
    pub parameter: &'static str,
    /// How a rule of it ends.
    pub kind: Kind,
}

/// How a rule ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// With its points.
    Points,
    /// At its tolerance, or with as many outcomes as allowed.
    ToTolerance,
    /// With its samples, the first of which are a shorter rule.
    Samples,
}

const fn family(name: &'static str, parameter: &'static str, kind: Kind) -> Family {
    Family { name, parameter, kind }
}

/// All families.
pub const FAMILIES: [Family; 9] = [
    family("one element of degree q", "degree", Kind::Points),
    family("elements of degree 1", "elements", Kind::Points),
    family("elements of degree 3", "elements", Kind::Points),
    family("adaptive stochastic mesh", "tolerance", Kind::ToTolerance),
    family("sparse grid", "level", Kind::Points),
    family("Monte Carlo", "samples", Kind::Samples),
    family("Galerkin, total degree", "degree", Kind::Points),
    family("corrected polynomials", "tolerance", Kind::ToTolerance),
    family("multilevel Monte Carlo", "tolerance", Kind::ToTolerance),
];
/// Numbers of families in [`FAMILIES`].
const ADAPTED: usize = 3;
const SPARSE: usize = 4;
pub(super) const MONTE_CARLO: usize = 5;
const AT_ONCE: usize = 6;
const CORRECTED: usize = 7;
const MULTILEVEL: usize = 8;

/// Largest number of solves of a rule.
pub(super) const LIMIT: f64 = 2000.0;
/// With more germs than this, Monte Carlo has the same limit.
const FEW: usize = 3;
/// Largest number of nodes of a stochastic element if they are coupled.
const COUPLED: f64 = 32.0;
/// Largest number of nodes of a reference, of germs of an adaptive reference, and the largest degree of one on one
/// element.
const REFERENCE: usize = 5000;
const ADAPTIVE: usize = 2;
const DEGREE: usize = 11;
/// Most germs of a reference by a sparse grid on grids.
const SMOOTH: usize = 10;
/// Most polynomials of Galerkin on a grid.
const POLYNOMIALS: usize = 1000;
/// Tolerance of a reference that samples, and most outcomes of one by differences between grids.
const SAMPLED: f64 = 0.002;
const OF_LEVELS: usize = 50_000;

/// A rule.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rule {
    /// Number of its family.
    pub(super) family: usize,
    /// Its degree, elements, tolerance, level or samples.
    pub(super) parameter: f64,
    /// Its settings.
    pub(super) settings: Stochastic,
}

/// A reference: the rule, the one before it, which shows how far it can be trusted, and its name.
pub(super) struct Finest {
    pub(super) finest: Stochastic,
    pub(super) before: Stochastic,
    pub(super) name: String,
}

/// A stochastic mesh that is not refined.
fn tensor(random: &Random, elements: usize, degree: usize) -> Stochastic {
    let method = match random.stochastic.method {
        Sampling::Galerkin => Sampling::Galerkin,
        _ => Sampling::Collocation,
    };
    // no quantiles are needed: one sample of the surrogate
    Stochastic { method, elements, degree, refine: false, samples: 1, ..random.stochastic.clone() }
}

fn adaptive(random: &Random, tolerance: f64, max_nodes: usize) -> Stochastic {
    let degree = random.stochastic.degree.min(1);
    let method = Sampling::Collocation;
    Stochastic { method, refine: true, of_deviation: false, tolerance, max_nodes, ..tensor(random, 1, degree) }
}

/// Solved to a tolerance by outcomes.
fn to_tolerance(random: &Random, method: Sampling, tolerance: f64, max_nodes: usize) -> Stochastic {
    Stochastic { method, tolerance, max_nodes, samples: 1, ..random.stochastic.clone() }
}

/// Galerkin on a grid, of a total degree.
fn at_once(random: &Random, degree: usize) -> Stochastic {
    Stochastic { of_deviation: false, method: Sampling::Galerkin, ..tensor(random, 1, degree) }
}

fn sparse(random: &Random, level: usize) -> Stochastic {
    Stochastic { method: Sampling::Sparse, level, ..random.stochastic.clone() }
}

/// The random input with other settings.
pub(super) fn with(random: &Random, settings: Stochastic) -> Random {
    let mut random = random.clone();
    random.stochastic = settings;
    random
}

/// Number of points of some settings.
pub(super) fn count(scene: &Scene, random: &Random, settings: &Stochastic) -> f64 {
    points(scene, &with(random, settings.clone()))
}

/// On boundary elements adaptive for one or two germs; else the tensor rule of the highest affordable degree, if that is two
/// degrees above the scene's; else the finest affordable sparse grid. All are collocation, the limit of every method there.
pub(super) fn reference(scene: &Scene, random: &Random) -> Finest {
    if scene.is_on_grid() {
        return on_grid(scene, random);
    }
    if random.germs.len() <= ADAPTIVE {
        let rule = |tolerance| adaptive(random, tolerance, REFERENCE);
        let name = "collocation on an adaptive stochastic mesh, tolerance 1e-8".into();
        return Finest { finest: rule(1e-8), before: rule(1e-7), name };
    }
    let rule = |degree| Stochastic { method: Sampling::Collocation, ..tensor(random, 1, degree) };
    let least = random.stochastic.degree + 2;
    match largest((scene, random), least..=DEGREE.max(least), REFERENCE, &rule) {
        Some(degree) => {
            let name = format!("collocation of degree {degree} on one element");
            Finest { finest: rule(degree), before: rule(degree - 1), name }
        }
        None => finest_sparse(scene, random),
    }
}

/// The largest number that gives a rule of at most so many points.
fn largest(
    (scene, random): (&Scene, &Random),
    numbers: RangeInclusive<usize>,
    most: usize,
    rule: &dyn Fn(usize) -> Stochastic,
) -> Option<usize> {
    numbers.take_while(|&k| count(scene, random, &rule(k)) <= most as f64).last()
}

fn finest_sparse(scene: &Scene, random: &Random) -> Finest {
    let rule = |level| sparse(random, level);
    let level = largest((scene, random), 1..=6, REFERENCE, &rule).unwrap_or(1);
    Finest { finest: rule(level), before: rule(level - 1), name: format!("sparse grid of level {level}") }
}

/// On grids Galerkin of the highest affordable degree where it solves the scene; a sparse grid for few germs without contact;
/// else outcomes that are drawn, as differences between grids where polynomials have nothing to say.
fn on_grid(scene: &Scene, random: &Random) -> Finest {
    if scene.takes_galerkin() {
        let rule = |degree| at_once(random, degree);
        if let Some(degree) = largest((scene, random), 2..=DEGREE, POLYNOMIALS, &rule) {
            let name = format!("Galerkin of total degree {degree}");
            return Finest { finest: rule(degree), before: rule(degree - 1), name };
        }
    }
    let drawn = !random.drawn_germs().is_empty();
    if random.germs.len() <= SMOOTH && !drawn && scene.contacts().next().is_none() {
        return finest_sparse(scene, random);
    }
    let rule = |tolerance| match drawn && is_possible(scene, random, &levels(random, tolerance)) {
        true => levels(random, tolerance),
        false => to_tolerance(random, Sampling::Corrected, tolerance, 2 * REFERENCE),
    };
    let (mut finest, before) = (rule(SAMPLED), rule(0.1));
    // outcomes of its own: errors against those that it shares would look too small
    finest.seed = !finest.seed;
    let what = if finest.method == Sampling::Multilevel { "multilevel Monte Carlo" } else { "corrected polynomials" };
    let name = format!("{what}, tolerance {SAMPLED}, at most {} outcomes", finest.max_nodes);
    Finest { finest, before, name }
}

fn levels(random: &Random, tolerance: f64) -> Stochastic {
    to_tolerance(random, Sampling::Multilevel, tolerance, OF_LEVELS)
}

/// Whether the scene can be solved by some settings.
fn is_possible(scene: &Scene, random: &Random, settings: &Stochastic) -> bool {
    let scene = Scene { random: Some(with(random, settings.clone())), ..scene.clone() };
    scene.check().is_ok() && (settings.method != Sampling::Galerkin || !scene.is_on_grid() || scene.takes_galerkin())
}

/// All rules, family by family from coarse to fine; rules that would take too long, are as fine as the reference, or cannot
/// solve the scene are left out. `coupled`: whether the nodes of the Galerkin method are coupled.
pub(super) fn rules(scene: &Scene, random: &Random, reference: &Stochastic, coupled: bool) -> Vec<Rule> {
    let germs = random.germs.len();
    let mut rules = Vec::new();
    let mut add = |family: usize, all: &mut dyn Iterator<Item = (f64, Stochastic)>| {
        for (parameter, settings) in all {
            let Stochastic { method, degree, .. } = settings;
            let like = match method {
                Sampling::Sparse => reference.method == Sampling::Sparse,
                Sampling::Galerkin if family == AT_ONCE => reference.method == Sampling::Galerkin,
                _ => family == 0 && reference.method == Sampling::Collocation,
            };
            let points = count(scene, random, &settings);
            let finer = like && !reference.refine && points >= count(scene, random, reference);
            let cell = ((degree + 1) as f64).powi(germs as i32);
            let large = coupled && method == Sampling::Galerkin && cell > COUPLED;
            let fits = points <= LIMIT || method == Sampling::Multilevel;
            if !finer && !large && fits && is_possible(scene, random, &settings) {
                rules.push(Rule { family, parameter, settings });
            }
        }
    };
    let meshes = !scene.is_on_grid();
    if meshes {
        add(0, &mut (0..=8).map(|degree| (degree as f64, tensor(random, 1, degree))));
        for (family, degree) in [(1, 1), (2, 3)] {
            add(family, &mut (0..8).map(|k| 1 << k).map(|n| (n as f64, tensor(random, n, degree))));
        }
        let most = (LIMIT as usize).min(random.stochastic.max_nodes);
        let tolerances = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
        add(ADAPTED, &mut tolerances.into_iter().map(|t| (t, adaptive(random, t, most))));
    }
    add(SPARSE, &mut (0..=5).map(|level| (level as f64, sparse(random, level))));
    if !meshes {
        let tolerances = [0.3, 0.1, 0.03, 0.01, 0.003];
        let corrected = |t| (t, to_tolerance(random, Sampling::Corrected, t, LIMIT as usize));
        add(AT_ONCE, &mut (0..=8).map(|degree| (degree as f64, at_once(random, degree))));
        add(CORRECTED, &mut tolerances.into_iter().map(corrected));
        add(MULTILEVEL, &mut tolerances.into_iter().map(|t| (t, levels(random, t))));
    }
    let most = if germs > FEW || !meshes { LIMIT as usize } else { 10_000 };
    let samples = random.stochastic.samples.min(most);
    let settings = Stochastic { method: Sampling::MonteCarlo, samples, ..random.stochastic.clone() };
    rules.push(Rule { family: MONTE_CARLO, parameter: samples as f64, settings });
    rules
}

/// The numbers of samples at which Monte Carlo is evaluated: 10, 30, 100, ... and the last.
pub(super) fn prefixes(samples: usize) -> Vec<usize> {
    let all = (1..).flat_map(|k| [10usize.pow(k), 3 * 10usize.pow(k)]);
    all.take_while(|n| *n < samples).chain([samples]).collect()
}

/// One outcome: the middle of every germ.
pub(super) fn single(random: &Random) -> Stochastic {
    tensor(random, 1, 0)
}

/// The rule for errors in space, and its name: the scene's own, but a sparse grid of level 2 in place of samples or of
/// too many points.
pub(super) fn settled(scene: &Scene, random: &Random) -> (Stochastic, String) {
    let own = &random.stochastic;
    if own.method == Sampling::MonteCarlo || count(scene, random, own) > LIMIT {
        return (sparse(random, 2), "sparse grid of level 2".into());
    }
    (Stochastic { samples: 1, ..own.clone() }, "the scene's rule".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\nsides = [\"floor\", \"right\", \"top\", \"left\"]\n\
                         [material]\nyoung = 1\npoisson = 0.3\n[sides.floor]\ndisplacement = [\"0\", \"0\"]\n";

    /// A scene with `germs` uniform loads, and its rules.
    fn studied(germs: usize, method: &str) -> (Finest, Vec<Rule>) {
        let load = (0..germs).map(|k| format!("a{k}")).collect::<Vec<_>>().join(" + ");
        let names = (0..germs).map(|k| format!("[random.a{k}]\ndistribution = \"uniform\"\nlow = 0.0\nhigh = 1.0\n"));
        let text = format!(
            "{SCENE}[sides.top]\ntraction = [\"0\", \"{load}\"]\n{}[stochastic]\nmethod = \"{method}\"\ndegree = 1\n",
            names.collect::<String>()
        );
        let scene = steklov_document::parse(&text, "scene", &[]).unwrap_or_else(|e| panic!("{}", e.render()));
        let random = scene.random.as_ref().unwrap();
        let finest = reference(&scene, random);
        let rules = rules(&scene, random, &finest.finest, false);
        (finest, rules)
    }

    #[test]
    fn references_are_finer_than_rules_and_rules_affordable() {
        for (germs, name) in [(1, "adaptive"), (2, "adaptive"), (3, "degree 11"), (6, "degree 3"), (9, "level")] {
            let (Finest { finest, name: found, .. }, rules) = studied(germs, "galerkin");
            assert!(found.contains(name), "{germs}: {found}");
            for rule in &rules {
                let same = rule.settings.method == Sampling::Galerkin && rule.settings.elements == 1;
                let judged = finest.method == Sampling::Collocation && !finest.refine;
                assert!(!same || !judged || rule.settings.degree < finest.degree, "{germs}: {rule:?}");
                let sparse = [finest.method, rule.settings.method].map(|m| m == Sampling::Sparse);
                assert!(sparse != [true; 2] || rule.settings.level < finest.level, "{germs}: {rule:?}");
            }
            for family in 0..FAMILIES.len() {
                let of: Vec<f64> = rules.iter().filter(|r| r.family == family).map(|r| r.parameter).collect();
                let monotone = of.windows(2).all(|p| if family == ADAPTED { p[1] < p[0] } else { p[1] > p[0] });
                // those after Monte Carlo are of grids alone
                let has_rules = if family > MONTE_CARLO { of.is_empty() } else { germs > 3 || !of.is_empty() };
                assert!(monotone && has_rules, "{germs}, {family}: {of:?}");
            }
            let samples = rules.iter().find(|r| r.family == MONTE_CARLO).unwrap().settings.samples;
            assert_eq!(samples, if germs > 3 { 2000 } else { 10_000 });
        }
    }

    #[test]
    fn samples_are_judged_at_rising_numbers() {
        assert_eq!(prefixes(5), [5]);
        assert_eq!(prefixes(100), [10, 30, 100]);
        assert_eq!(prefixes(2000), [10, 30, 100, 300, 1000, 2000]);
    }
}
