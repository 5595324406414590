//! The cost of random input, and the effect of its germs on the data.

use steklov_expression::{Expression, OnEdge, Track};
use steklov_model::stochastic::{intervals, is_coupled, method};
use steklov_problem::{Germ, Random, Sampling, Scene, grid_of, moduli};
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
        Sampling::Galerkin if scene.is_on_grid() => blocks(random),
        Sampling::Galerkin | Sampling::Collocation => random.germs.iter().zip(scene.cuts(random)).map(of).product(),
        Sampling::Sparse => sparse(random).unwrap_or(f64::INFINITY),
        // the first grid, or the first samples
        Sampling::Corrected => (2 * random.germs.len() + 1).min(settings.max_nodes) as f64,
        Sampling::MonteCarlo => settings.samples as f64,
        Sampling::Multilevel => settings.max_nodes as f64,
    }
}

/// Polynomials of total degree p in d germs: binomial(d + p, p).
fn blocks(random: &Random) -> f64 {
    (1..=random.stochastic.degree).fold(1.0, |count, k| count * (random.germs.len() + k) as f64 / k as f64).round()
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
    let at_once = scene.is_of_all_outcomes(random);
    let how = match settings.method {
        Sampling::Galerkin if at_once => {
            format!("galerkin in {count} polynomials of total degree {} in {germs} germ(s)", settings.degree)
        }
        Sampling::Galerkin | Sampling::Collocation => format!(
            "{} of degree {} on {} element(s) in each of {germs} germ(s): {count} points{}",
            method(settings.method),
            settings.degree,
            settings.elements,
            if settings.refine { ", refined until their truncation is small" } else { "" }
        ),
        Sampling::Sparse => format!("sparse grid of level {} in {germs} germ(s): {count} points", settings.level),
        Sampling::Corrected => format!(
            "a sparse grid in {germs} germ(s), corrected by fresh outcomes, seed {}: as many as standard errors of {} of the deviations need",
            settings.seed, settings.tolerance
        ),
        Sampling::MonteCarlo => format!("{count} samples of {germs} germ(s), seed {}", settings.seed),
        Sampling::Multilevel => format!(
            "samples of {germs} germ(s) on a family of grids, seed {}, until standard errors are {} of the deviations",
            settings.seed, settings.tolerance
        ),
    };
    let each = match scene.is_on_grid() {
        true if at_once => {
            "one system for all of them, solved with the factor of the mean moduli, and fresh outcomes beside it"
        }
        true => "each a body of its own, with a factorisation of the grid",
        false if scene.problem.has_several_bodies() => "each a solve of the interfaces: every body is factorised once",
        false => "each a condensed contact solve with the one factorisation of the mesh",
    };
    let why = format!(
        "{each}{}",
        match (settings.method, sparse(random)) {
            (Sampling::Galerkin | Sampling::Collocation, Some(sparse)) if sparse < count && !at_once =>
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
    if scene.uses(random).young && settings.method == Sampling::Galerkin && !at_once {
        let (choice, why) = match is_coupled(scene, random) {
            Ok(true) => ("coupled", "the modulus is not affine in its germs: the exact Galerkin system, cell by cell"),
            _ => (
                "one by one",
                "an affine modulus; or several bodies, a body force, Coulomb friction or a body that only contact holds: node by node, which is collocation",
            ),
        };
        modelled.push(decision("stochastic nodes", choice.into(), why.into()));
    }
    for (field, _) in random.fields() {
        let (modes, captured) = (field.expansion.len(), field.expansion.captured());
        let (choice, why) = match field.expansion.is_drawn() {
            true => (
                format!("{} without truncation", field.name),
                format!("drawn as a whole, with {:.2} % of its variance", 100.0 * captured),
            ),
            false => (
                format!("{} by {modes} modes", field.name),
                format!("they carry {:.2} % of its variance", 100.0 * captured),
            ),
        };
        modelled.push(decision("random field", choice, why + &coarse_cells(&field.expansion)));
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
#[derive(Default)]
struct Moved {
    /// Largest change of E of a body, relative, in mean square over cells.
    young: f64,
    /// Change of the tractions and body forces, relative to their size, both in mean square.
    loads: f64,
    /// Change of the stress far away, relative to the largest entry.
    remote: f64,
    /// Largest changes of gap (length) and of friction (stress or 1).
    gap: f64,
    friction: f64,
    /// Largest change of prescribed displacements (length).
    held: f64,
    /// Largest change of jumps across ties (length or stress).
    jumps: f64,
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
        percent("moves the stress far away", self.remote);
        let mut size = |what: &str, size: f64| {
            if size > 0.0 {
                parts.push(format!("{what} by {size:.1e}"));
            }
        };
        size("moves the gap", self.gap);
        size("moves friction", self.friction);
        size("moves held displacements", self.held);
        size("moves jumps of ties", self.jumps);
        if parts.is_empty() { "moves next to nothing: a number would do".into() } else { parts.join(", ") }
    }
}

/// Half of the change from one modulus to another, relative to a third: in mean square over cells.
fn change([low, high, nominal]: [&[f64]; 3]) -> f64 {
    let squares: f64 = low.iter().zip(high).zip(nominal).map(|((a, b), e)| (0.5 * (b - a) / e).powi(2)).sum();
    (squares / nominal.len().max(1) as f64).sqrt()
}

/// A cheap sensitivity of the data, not of the answers: each germ at its quantiles 0.159 and 0.841, the others at their
/// medians.
fn sensitivities(scene: &Scene, random: &Random) -> Vec<Moved> {
    let middle: Vec<f64> = random.germs.iter().map(|g| g.variable.quantile(0.5)).collect();
    let grid = if scene.is_on_grid() { grid_of(scene).ok() } else { None };
    // of each body, or of each cell of a body on a grid
    let moduli_of = |scene: &Scene| -> Vec<Vec<f64>> {
        match &grid {
            Some(grid) => {
                let cells = moduli(scene, grid).map(|all| grid.body_cells().map(|c| all[c]).collect());
                vec![cells.unwrap_or_default()]
            }
            None => scene.problem.bodies.iter().map(|body| vec![body.material().young]).collect(),
        }
    };
    let one = |d: usize| {
        let outcome = |p: f64| {
            let mut germs = middle.clone();
            germs[d] = random.germs[d].variable.quantile(p);
            scene.outcome(&germs).unwrap_or_else(|_| scene.clone())
        };
        let (low, high) = (outcome(0.158_655), outcome(0.841_345));
        let [a, b, nominal] = [&low, &high, scene].map(moduli_of);
        let of_body = |k: usize| change([&a[k], &b[k], &nominal[k]]);
        let mut moved = Moved { young: (0..nominal.len()).map(of_body).fold(0.0, f64::max), ..Moved::default() };
        let mut loads = [0.0; 2];
        of_sides(&low, &high, &mut moved, &mut loads);
        of_bodies(&low, &high, &mut moved, &mut loads);
        let [change, size] = loads;
        moved.loads = if change == 0.0 { 0.0 } else { (change / size).sqrt() };
        moved
    };
    (0..random.germs.len().min(NAMED)).map(one).collect()
}

/// What changes along sides from one outcome to another; `loads`: squares of half the change of tractions, and of their mean.
fn of_sides(low: &Scene, high: &Scene, moved: &mut Moved, [change, size]: &mut [f64; 2]) {
    let jumps = |scene: &Scene, side: usize| -> Vec<(&'static str, Expression)> {
        let of_side = scene.problem.jumps_of_ties().filter(|(on, ..)| *on == side);
        of_side.map(|(_, _, jump)| ("jump", jump.clone())).collect()
    };
    let data = |scene: &Scene, side: usize| -> Vec<(&'static str, Expression)> {
        let own = scene.problem.side_data(side).into_iter().map(|(what, datum)| (what, datum.clone()));
        own.chain(jumps(scene, side)).collect()
    };
    for edge in low.problem.outline.edges() {
        for ((what, a), (_, b)) in data(low, edge.side).iter().zip(&data(high, edge.side)) {
            for k in 0..=STEPS {
                let value = |f: &Expression| {
                    let (x, y, s) = OnEdge::new(edge, f).at(k as f64 / STEPS as f64);
                    f.eval(x, y, s)
                };
                let (half, mean) = (0.5 * (value(b) - value(a)), 0.5 * (value(a) + value(b)));
                match *what {
                    "traction" | "pressure" => {
                        *change += half * half * edge.length();
                        *size += mean * mean * edge.length();
                    }
                    "gap" => moved.gap = moved.gap.max(half.abs()),
                    "displacement" => moved.held = moved.held.max(half.abs()),
                    "jump" => moved.jumps = moved.jumps.max(half.abs()),
                    _ => moved.friction = moved.friction.max(half.abs()),
                }
            }
        }
    }
}

/// The same of body forces, in the mean over the boundary, and the stress far away.
fn of_bodies(low: &Scene, high: &Scene, moved: &mut Moved, [change, size]: &mut [f64; 2]) {
    let outline = &low.problem.outline;
    let points = outline.edges().iter().flat_map(|edge| {
        let weight = edge.length() / (STEPS + 1) as f64;
        (0..=STEPS).map(move |k| (edge.point(k as f64 / STEPS as f64), weight))
    });
    let points: Vec<([f64; 2], f64)> = points.collect();
    let area_of = outline.area() / points.iter().map(|(_, weight)| weight).sum::<f64>();
    for (a, b) in low.problem.bodies.iter().zip(&high.problem.bodies) {
        for (a, b) in a.force.iter().flatten().zip(b.force.iter().flatten()) {
            for &([x, y], weight) in &points {
                let [a, b] = [a, b].map(|f| f.eval(x, y, 0.0));
                *change += 0.25 * (b - a).powi(2) * weight * area_of;
                *size += (0.5 * (a + b)).powi(2) * weight * area_of;
            }
        }
        if let (Some(a), Some(b)) = (&a.far, &b.far) {
            let both = || a.remote_stress.iter().zip(&b.remote_stress);
            let largest = both().fold(0.0, |m: f64, (a, b)| m.max(0.5 * (a + b).abs()));
            let half = both().fold(0.0, |m: f64, (a, b)| m.max(0.5 * (b - a).abs()));
            moved.remote = if half == 0.0 { 0.0 } else { half / largest };
        }
    }
}
