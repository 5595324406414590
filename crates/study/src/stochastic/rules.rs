//! The stochastic rules of the study, and the finer rule that is their reference.

use steklov_plan::points;
use steklov_problem::{Random, Sampling, Scene, Stochastic};

/// Families of rules: the name, and the parameter that changes from rule to rule.
pub const FAMILIES: [(&str, &str); 6] = [
    ("one element of degree q", "degree"),
    ("elements of degree 1", "elements"),
    ("elements of degree 3", "elements"),
    ("adaptive stochastic mesh", "tolerance"),
    ("sparse grid", "level"),
    ("Monte Carlo", "samples"),
];
/// Number of Monte Carlo in [`FAMILIES`].
pub(super) const MONTE_CARLO: usize = 5;
/// Number of adaptive meshes in [`FAMILIES`].
pub(super) const ADAPTED: usize = 3;

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

/// Adaptive for one or two germs; else the tensor rule of the highest affordable degree, if that is two degrees above
/// the scene's; else the finest affordable sparse grid. All are collocation, the limit of every method here.
pub(super) fn reference(scene: &Scene, random: &Random) -> Finest {
    if random.germs.len() <= ADAPTIVE {
        let rule = |tolerance| adaptive(random, tolerance, REFERENCE);
        let name = "collocation on an adaptive stochastic mesh, tolerance 1e-8".into();
        return Finest { finest: rule(1e-8), before: rule(1e-7), name };
    }
    let largest = |least: usize, most: usize, rule: &dyn Fn(usize) -> Stochastic| {
        (least..=most).take_while(|&k| count(scene, random, &rule(k)) <= REFERENCE as f64).last()
    };
    let rule = |degree| Stochastic { method: Sampling::Collocation, ..tensor(random, 1, degree) };
    let least = random.stochastic.degree + 2;
    match largest(least, DEGREE.max(least), &rule) {
        Some(degree) => {
            let name = format!("collocation of degree {degree} on one element");
            Finest { finest: rule(degree), before: rule(degree - 1), name }
        }
        None => {
            let rule = |level| sparse(random, level);
            let level = largest(1, 6, &rule).unwrap_or(1);
            Finest { finest: rule(level), before: rule(level - 1), name: format!("sparse grid of level {level}") }
        }
    }
}

/// All rules, family by family from coarse to fine; rules that would take too long, or are as fine as the reference,
/// are left out. `coupled`: whether the nodes of the Galerkin method are coupled.
pub(super) fn rules(scene: &Scene, random: &Random, reference: &Stochastic, coupled: bool) -> Vec<Rule> {
    let germs = random.germs.len();
    let mut rules = Vec::new();
    let mut add = |family: usize, parameter: f64, settings: Stochastic| {
        let like = match settings.method {
            Sampling::Sparse => reference.method == Sampling::Sparse,
            _ => family == 0 && reference.method == Sampling::Collocation,
        };
        let finer = like && !reference.refine && count(scene, random, &settings) >= count(scene, random, reference);
        let cell = ((settings.degree + 1) as f64).powi(germs as i32);
        let large = coupled && settings.method == Sampling::Galerkin && cell > COUPLED;
        if !finer && !large && count(scene, random, &settings) <= LIMIT {
            rules.push(Rule { family, parameter, settings });
        }
    };
    for degree in 0..=8 {
        add(0, degree as f64, tensor(random, 1, degree));
    }
    for (family, degree) in [(1, 1), (2, 3)] {
        for elements in (0..8).map(|k| 1 << k) {
            add(family, elements as f64, tensor(random, elements, degree));
        }
    }
    for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
        add(ADAPTED, tolerance, adaptive(random, tolerance, (LIMIT as usize).min(random.stochastic.max_nodes)));
    }
    for level in 0..=5 {
        add(4, level as f64, sparse(random, level));
    }
    let most = if germs > FEW { LIMIT as usize } else { 10_000 };
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
                assert!(monotone && (germs > 3 || !of.is_empty()), "{germs}, {family}: {of:?}");
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
