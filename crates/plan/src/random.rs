//! The cost of random input, and the effect of its germs on the data.

use steklov_expression::{Expression, OnEdge, Track};
use steklov_model::stochastic::{intervals, is_coupled, method};
use steklov_problem::{Condition, Germ, Random, Sampling, Scene, grid_of, moduli};
use steklov_stochastic::{Field, smolyak};

use super::Decision;

/// Number of intervals along an edge, at whose ends data are compared.
const STEPS: usize = 32;
/// Share of a field's variance which cells may lose without a warning.
const UNRESOLVED: f64 = 0.1;
/// Largest number of germs that are named one by one.
const NAMED: usize = 8;

/// Number of points at which a scene is solved, before any refinement of the stochastic mesh.
pub fn points(scene: &Scene, random: &Random) -> f64 {
    let settings = &random.stochastic;
    let of = |(germ, cuts): (&Germ, Vec<f64>)| {
        intervals(&germ.variable, &cuts, settings.elements) as f64 * (settings.degree as f64 + 1.0)
    };
    match settings.method {
        Sampling::Galerkin | Sampling::Collocation => random.germs.iter().zip(scene.cuts(random)).map(of).product(),
        Sampling::Sparse => sparse(random).unwrap_or(f64::INFINITY),
        Sampling::MonteCarlo => settings.samples as f64,
        Sampling::Multilevel => settings.max_nodes as f64,
    }
}

/// Points of the sparse grid; None if it is too large to be made.
fn sparse(random: &Random) -> Option<f64> {
    let variables: Vec<_> = random.germs.iter().map(|g| g.variable.clone()).collect();
    smolyak(&variables, random.stochastic.level).ok().map(|grid| grid.points.len() as f64)
}

/// Adds the decisions about random input, or that there is none.
pub(crate) fn decide(scene: &Scene, modelled: &mut Vec<Decision>, left_out: &mut Vec<Decision>) {
    let decision = |what: &str, choice: String, why: String| Decision { what: what.into(), choice, why };
    let Some(random) = &scene.random else {
        left_out.push(decision("random input", "one solve".into(), "no random name is used".into()));
        return;
    };
    let settings = &random.stochastic;
    let count = points(scene, random);
    let germs = random.germs.len();
    let how = match settings.method {
        Sampling::Galerkin | Sampling::Collocation => format!(
            "{} of degree {} on {} element(s) in each of {germs} germ(s): {count} points{}",
            method(settings.method),
            settings.degree,
            settings.elements,
            if settings.refine { ", refined until their truncation is small" } else { "" }
        ),
        Sampling::Sparse => format!("sparse grid of level {} in {germs} germ(s): {count} points", settings.level),
        Sampling::MonteCarlo => format!("{count} samples of {germs} germ(s), seed {}", settings.seed),
        Sampling::Multilevel => format!(
            "samples of {germs} germ(s) on a family of grids, seed {}, until standard errors are {} of the deviations",
            settings.seed, settings.tolerance
        ),
    };
    let each = match scene.is_on_grid() {
        true => "each a body of its own, with a factorisation of the grid",
        false => "each a condensed contact solve with the one factorisation of the mesh",
    };
    let why = format!(
        "{each}{}",
        match (settings.method, sparse(random)) {
            (Sampling::Galerkin | Sampling::Collocation, Some(sparse)) if sparse < count =>
                format!("; method = \"sparse\" of level {} has {sparse} points", settings.level),
            _ => String::new(),
        }
    );
    let refused = settings.method != Sampling::MonteCarlo && count > settings.max_nodes as f64;
    let why = if refused {
        format!("more than stochastic.max_nodes = {}: solve refuses it", settings.max_nodes)
    } else {
        why
    };
    modelled.push(decision("random input", how, why));
    if scene.uses(random).young && settings.method == Sampling::Galerkin {
        let (choice, why) = match is_coupled(scene, random) {
            Ok(true) => ("coupled", "the modulus is not affine in its germs: the exact Galerkin system, cell by cell"),
            _ => (
                "one by one",
                "an affine modulus; or a body force, Coulomb friction or a body that only contact holds: node by node, which is collocation",
            ),
        };
        modelled.push(decision("stochastic nodes", choice.into(), why.into()));
    }
    for (field, _) in random.fields() {
        let (modes, captured) = (field.expansion.len(), field.expansion.captured());
        let choice = format!("{} by {modes} modes", field.name);
        modelled.push(decision(
            "random field",
            choice,
            format!("they carry {:.2} % of its variance{}", 100.0 * captured, coarse_cells(&field.expansion)),
        ));
    }
    for (germ, moved) in random.germs.iter().zip(sensitivities(scene, random)) {
        let lost = germ.variable.lost();
        let cut = if lost > 0.0 { format!("; its bounds cut off a probability of {lost:.1e}") } else { String::new() };
        let said = format!("{}{cut}", moved.text());
        modelled.push(decision("germ", germ.label.clone(), said));
    }
    if germs > NAMED {
        left_out.push(decision("germs", format!("{} more", germs - NAMED), "not named here".into()));
    }
}

/// A warning of cells that are too large for a field.
fn coarse_cells(field: &Field) -> String {
    let unresolved = field.unresolved();
    match unresolved > UNRESOLVED {
        true => format!(
            "; the means over its cells lose {:.0} %, however many modes: cells of less than a sixth of the correlation \
             length lose less than {:.0} %",
            100.0 * unresolved,
            100.0 * UNRESOLVED
        ),
        false => String::new(),
    }
}

/// Half of the change of the data from one deviation of a germ below its median to one above: between its quantiles
/// 0.159 and 0.841.
struct Moved {
    /// Change of E, relative, in mean square over cells.
    young: f64,
    /// Change of the tractions, relative to their size, both in mean square along the boundary.
    loads: f64,
    /// Largest changes of gap (length) and of friction (stress or 1).
    gap: f64,
    friction: f64,
    /// Largest change of prescribed displacements (length).
    held: f64,
}

impl Moved {
    fn text(&self) -> String {
        let mut parts = Vec::new();
        let mut percent = |what: &str, part: f64| {
            if part > 0.0 {
                parts.push(format!("{what} by {:.1} %", 100.0 * part));
            }
        };
        percent("moves Young's modulus", self.young);
        percent("moves the loads", self.loads);
        let mut size = |what: &str, size: f64| {
            if size > 0.0 {
                parts.push(format!("{what} by {size:.1e}"));
            }
        };
        size("moves the gap", self.gap);
        size("moves friction", self.friction);
        size("moves held displacements", self.held);
        if parts.is_empty() { "moves next to nothing: a number would do".into() } else { parts.join(", ") }
    }
}

/// Half of the change from one modulus to another, relative to a third: in mean square over cells.
fn change([low, high, nominal]: [Vec<f64>; 3]) -> f64 {
    let squares: f64 = low.iter().zip(&high).zip(&nominal).map(|((a, b), e)| (0.5 * (b - a) / e).powi(2)).sum();
    (squares / nominal.len().max(1) as f64).sqrt()
}

/// A cheap sensitivity of the data, not of the answers: each germ at its quantiles 0.159 and 0.841, the others at their
/// medians.
fn sensitivities(scene: &Scene, random: &Random) -> Vec<Moved> {
    let middle: Vec<f64> = random.germs.iter().map(|g| g.variable.quantile(0.5)).collect();
    let grid = if scene.is_on_grid() { grid_of(scene).ok() } else { None };
    let young = |s: &Scene| match &grid {
        Some(grid) => moduli(s, grid).map(|all| grid.body_cells().map(|c| all[c]).collect()).unwrap_or_default(),
        None => vec![s.body().material().young],
    };
    let one = |d: usize| {
        let outcome = |p: f64| {
            let mut germs = middle.clone();
            germs[d] = random.germs[d].variable.quantile(p);
            scene.outcome(&germs).unwrap_or_else(|_| scene.clone())
        };
        let (low, high) = (outcome(0.158_655), outcome(0.841_345));
        let mut moved = Moved { gap: 0.0, friction: 0.0, held: 0.0, loads: 0.0, young: 0.0 };
        moved.young = change([&low, &high, scene].map(young));
        let (mut change, mut size) = (0.0, 0.0);
        for edge in scene.problem.outline.edges() {
            for k in 0..=STEPS {
                let s = k as f64 / STEPS as f64;
                let value = |f: &Expression| {
                    let (x, y, s) = OnEdge::new(edge, f).at(s);
                    f.eval(x, y, s)
                };
                let pair = |a: &Expression, b: &Expression| (value(b) - value(a), 0.5 * (value(a) + value(b)));
                let (a, b) = (&low.problem.sides[edge.side].condition, &high.problem.sides[edge.side].condition);
                let mut load = |a: &Expression, b: &Expression| {
                    let (d, m) = pair(a, b);
                    change += 0.25 * d * d * edge.length();
                    size += m * m * edge.length();
                };
                let half = |a: &Expression, b: &Expression| 0.5 * pair(a, b).0.abs();
                if let (Some(a), Some(b)) = (low.contact(edge.side), high.contact(edge.side)) {
                    moved.gap = moved.gap.max(half(&a.gap, &b.gap));
                    for (f, g) in a.data().into_iter().zip(b.data()).skip(1) {
                        moved.friction = moved.friction.max(half(f.1, g.1));
                    }
                }
                match (a, b) {
                    (Condition::Traction(a), Condition::Traction(b)) => (0..2).for_each(|i| load(&a[i], &b[i])),
                    (Condition::Pressure(a), Condition::Pressure(b)) => load(a, b),
                    (Condition::Displacement { values: a, .. }, Condition::Displacement { values: b, .. }) => {
                        for (a, b) in a.iter().zip(b).filter_map(|(a, b)| a.as_ref().zip(b.as_ref())) {
                            moved.held = moved.held.max(half(a, b));
                        }
                    }
                    _ => {}
                }
            }
        }
        if let (Some(a), Some(b)) = (low.body().constant_force(), high.body().constant_force()) {
            for i in 0..2 {
                change += 0.25 * (b[i] - a[i]).powi(2) * scene.problem.outline.area();
                size += (0.5 * (a[i] + b[i])).powi(2) * scene.problem.outline.area();
            }
        }
        moved.loads = if change == 0.0 { 0.0 } else { (change / size).sqrt() };
        moved
    };
    (0..random.germs.len().min(NAMED)).map(one).collect()
}
