//! What is told of a result on stdout, and advice where it did not converge.

use steklov_document::STOCHASTIC;
use steklov_figures::stochastic;
use steklov_model::doubt::Doubt;
use steklov_model::estimators::Estimators;
use steklov_model::run::adaptive_loop::Reason;
use steklov_model::summary::Expected;
use steklov_model::summary::{LineProbe, MediumSummary, SideProbe, Summary};
use steklov_plan::MODULI;
use steklov_problem::{Law, Scene};
use steklov_report::told::{advice, untouched};
use steklov_result::record::Record;

use super::failure::say;
use super::grid::grid_lines;

/// Coefficient of friction beyond those of all known materials.
const ROUGHEST: f64 = 5.0;

/// What is legal in a scene, and hardly meant.
pub(super) fn cautions(scene: &Scene) -> Vec<String> {
    let is_random = |name: &&String| !scene.parameters.contains_key(*name);
    let (tables, names): (Vec<_>, Vec<_>) = scene.unused.iter().filter(is_random).partition(|name| *name == STOCHASTIC);
    let mut told = Vec::new();
    if !names.is_empty() {
        let names = names.into_iter().map(String::as_str).collect::<Vec<_>>().join(", ");
        told.push(format!(
            "no datum uses the random {names}, which has no effect: write the name where it belongs, as in young = \"NAME\""
        ));
    }
    if !tables.is_empty() {
        told.push(format!(
            "nothing is random, so that {STOCHASTIC} has no effect: declare names in [random] and use them"
        ));
    }
    let laws = scene.problem.interfaces().iter().filter_map(|interface| match &interface.law {
        Law::Contact(contact) => contact.friction.coefficient()?.constant(),
        Law::Tied(_) => None,
    });
    if let Some(coefficient) = laws.filter(|c| *c > ROUGHEST).max_by(f64::total_cmp) {
        told.push(format!(
            "a friction coefficient of {coefficient} is larger than any known one: it is the tangent of the angle of friction, \
             for degrees coulomb = \"tan({coefficient}*pi/180)\""
        ));
    }
    told
}

/// What the medium does far away; with a net force also that its displacement depends on a length.
fn far_away(exterior: &MediumSummary) -> Vec<String> {
    let MediumSummary { radiation, resultant: [x, y], balanced, constant: [a, b], length } = exterior;
    let mut lines = vec![match (radiation.as_str(), balanced) {
        ("bounded", _) => format!("at infinity bounded, displacement ({a:.6e}, {b:.6e})"),
        (_, true) => "at infinity decaying: the forces on the medium are balanced".to_owned(),
        (_, false) => format!("at infinity net force ({x:.6e}, {y:.6e}) on the medium, which does not vanish far away"),
    }];
    if !balanced && radiation != "bounded" {
        lines.push(format!(
            "            the displacement grows as log(L/r), and its translation depends on the length L = {length:.6e}:"
        ));
        lines.push(
            "            compare displacements of two points, or hold a point that is known not to move".to_owned(),
        );
    }
    lines
}

/// An entry of `[expect]` and whether it holds.
pub(super) fn expectation(entry: &Expected) -> String {
    let Expected { path, value, expected, tol, holds } = entry;
    let word = if *holds { "holds" } else { "DOES NOT HOLD" };
    match value {
        Some(value) => format!(
            "expected    {path} = {expected} ± {tol:e}: {value:?}, off by {:.1e}: {word}",
            (value - expected).abs()
        ),
        None => format!("expected    {path} = {expected} ± {tol:e}: this result has no such number: {word}"),
    }
}

/// The interfaces between several bodies, the places where these lie in each other, and the bodies.
fn of_several(s: &Summary) -> Vec<String> {
    let doubted = |doubt: &str| s.estimate_doubts.iter().any(|of| of == doubt);
    let mut lines = Vec::new();
    let mut say = |line: &str| lines.push(line.to_owned());
    for i in &s.interfaces {
        let stick = i.stick.map_or(String::new(), |stick| format!(", stick {stick:.6e}"));
        let [x, y] = i.force;
        say(&format!("interface   {}: {}, length {:.6e}{stick}, force ({x:.6e}, {y:.6e})", i.name, i.kind, i.length));
        if let Some(n) = i.normals.filter(|_| doubted("normals")) {
            say(&format!(
                "            normals of the two sides differ by up to {:.2}°: J is uncertain by {:.1e} for that",
                n.angle.to_degrees(),
                n.energy_change
            ));
        }
    }
    for r in &s.reach {
        let ([a, b], [x, y]) = (&r.bodies, r.point);
        say(&format!(
            "reach       {a} and {b} lie {:.3e} in each other at ({x:.6e}, {y:.6e}): name the sides that meet there in an interface",
            r.depth
        ));
    }
    for body in &s.bodies {
        say(&format!("body        {}: {} dofs, strain energy {:.6e}", body.name, body.dofs, body.strain_energy));
    }
    lines
}

/// The names of the units, if there are any.
fn units(s: &Summary) -> Option<String> {
    let named = [("length", &s.units.length), ("stress", &s.units.stress)];
    let named: Vec<String> = named.iter().filter_map(|(of, name)| Some(format!("{of} {}", name.as_ref()?))).collect();
    (!named.is_empty()).then(|| format!("units       {}", named.join(", ")))
}

/// Prints the summary of a result.
pub(super) fn print_summary(stored: &Record) {
    let Record { summary: s, plan, .. } = stored;
    // no control letter of a title reaches the terminal
    say(&s.title.replace(char::is_control, " "));
    units(s).iter().for_each(|line| say(line));
    say(&format!("{} dofs, {} step(s): {}", s.dofs, s.steps, if s.converged { &s.reason } else { "NOT CONVERGED" }));
    if !s.converged {
        say(&format!("reason      {}", s.reason));
        advice(s, plan).iter().for_each(|advice| say(&format!("            {advice}")));
    }
    if let Some(failure) = s.failure.as_ref().filter(|_| s.reason == Reason::Failed.word()) {
        say(&format!("            in the step after these: {failure}"));
    }
    if stored.stochastic.is_some() {
        say(
            "mean input  what follows is one solution, of the mean of the random input; means of all outcomes stand under `outcomes`",
        );
    }
    say(&format!("energy J    {:.12e}", s.energy));
    let springs = s.spring_energy.map_or(String::new(), |energy| format!("springs {energy:.6e}, "));
    say(&format!(
        "            strain {:.6e}, {springs}load work {:.6e}, friction work {:.6e}",
        s.strain_energy, s.load_work, s.friction_work
    ));
    if let (Some(error), Some(relative)) = (s.estimate, s.estimate_relative) {
        let doubts = if s.estimate_doubts.is_empty() {
            String::new()
        } else {
            format!(" (not reliable: {})", s.estimate_doubts.join(", "))
        };
        say(&format!("error       {error:.3e} estimated in the energy norm, relative {relative:.3e}{doubts}"));
    }
    if let (Some(energy), Some(uncertainty)) = (s.energy_extrapolated, s.energy_uncertainty) {
        say(&format!("            J extrapolated {energy:.12e} ± {uncertainty:.1e}"));
    }
    s.estimators.iter().flat_map(estimator_lines).for_each(|line| say(&line));
    s.estimate_doubts
        .iter()
        .filter_map(|word| Doubt::of_word(word))
        .for_each(|doubt| say(&format!("doubt       {doubt}")));
    s.exterior.iter().flat_map(far_away).for_each(|line| say(&line));
    if let Some(grid) = &s.grid {
        grid_lines(grid).iter().for_each(|line| say(line));
        plan.modelled
            .iter()
            .filter(|d| d.what == MODULI)
            .for_each(|d| say(&format!("            modulus {}", d.choice)));
    }
    if let Some(c) = &s.contact {
        let note =
            if c.max_pressure_unbounded { " (the exact one is infinite: this is a number of the mesh)" } else { "" };
        say(&format!(
            "contact     length {:.6e}, stick {:.6e}, slip {:.6e}, {} iterations",
            c.length, c.stick, c.slip, s.iterations
        ));
        say(&format!("            largest pressure {:.6e}{note}", c.max_pressure));
        if let Some(factor) = c.contraction {
            let note = if factor < 1.0 { "" } else { ": the fixed point of Tresca problems does not settle" };
            say(&format!("            Coulomb friction, contraction {factor:.3}{note}"));
        }
        say(&format!("            force on the body ({:.6e}, {:.6e})", c.force[0], c.force[1]));
        let tension = if s.exterior.is_some() { ": stresses far away are negative in compression" } else { "" };
        untouched(stored).iter().for_each(|side| say(&format!("            nothing touches side {side}{tension}")));
    }
    of_several(s).iter().for_each(|line| say(line));
    if let Some(a) = &s.audit {
        say(&format!(
            "audit       equilibrium {:.1e}, penetration {:.1e}, tension {:.1e}, complementarity {:.1e}, friction {:.1e}",
            a.equilibrium, a.penetration, a.tension, a.complementarity, a.friction
        ));
    }
    for (side, [x, y]) in &s.reactions {
        say(&format!("reaction    {side}: ({x:.6e}, {y:.6e})"));
    }
    for p in &s.probe {
        let ([x, y], [u, v], [xx, yy, xy]) = (p.point, p.displacement, p.stress);
        let stress = match p.stress_unbounded {
            true => "stress unbounded: infinite at this vertex, whatever the mesh".to_owned(),
            false => format!("stress = ({xx:.6e}, {yy:.6e}, {xy:.6e})"),
        };
        say(&format!("probe       ({x}, {y}): u = ({u:.6e}, {v:.6e}), {stress}"));
    }
    probed(s).iter().for_each(|line| say(line));
    stochastic::lines(stored).iter().for_each(|line| say(line));
    s.expect.iter().for_each(|entry| say(&expectation(entry)));
    say(&format!(
        "seconds     {:.3}, peak memory {:.1} MiB",
        s.seconds.total,
        s.peak_memory_bytes as f64 / f64::from(1 << 20)
    ));
    say(&format!("result      {}", s.file));
}

/// The lines and sides of `[probe]`, each with the largest von Mises stress at its points, or where stresses are infinite.
fn probed(s: &Summary) -> Vec<String> {
    let peak = |points: &[(bool, f64, [f64; 2])]| {
        let largest = || points.iter().filter(|p| p.1.is_finite()).max_by(|a, b| a.1.total_cmp(&b.1));
        match (points.iter().find(|p| p.0), largest()) {
            (Some((.., [x, y])), _) => format!(", stress unbounded at ({x}, {y})"),
            (None, Some((_, value, [x, y]))) => format!(", von Mises stress up to {value:.6e} at ({x:.6}, {y:.6})"),
            (None, None) => String::new(),
        }
    };
    let line = |(k, line): (usize, &LineProbe)| {
        let ([x, y], [u, v], points) = (line.from, line.to, &line.points);
        let inside = points.iter().filter(|p| !p.displacement[0].is_nan()).count();
        let all: Vec<_> = points.iter().map(|p| (p.stress_unbounded, p.von_mises, p.point)).collect();
        format!("line {k:<6} ({x}, {y}) to ({u}, {v}): {inside} of {} points in a body{}", points.len(), peak(&all))
    };
    let side = |side: &SideProbe| {
        let all: Vec<_> = side.points.iter().map(|p| (p.stress_unbounded, p.von_mises, p.point)).collect();
        format!("side        {}: {} points{}", side.side, side.points.len(), peak(&all))
    };
    (1..).zip(&s.probe_lines).map(line).chain(s.probe_sides.iter().map(side)).collect()
}

/// Parts of an estimator below this part of it are not told.
const SMALL_PART: f64 = 1e-3;

/// The residual estimators, the largest parts first.
fn estimator_lines(estimators: &Estimators) -> Vec<String> {
    let mut lines = Vec::new();
    for (name, estimator) in estimators.named() {
        let Some(estimator) = estimator else { continue };
        lines.push(format!("residual    {:.3e} by {name}, relative {:.3e}", estimator.value, estimator.relative));
        let mut parts: Vec<_> =
            estimator.parts.iter().filter(|(_, part)| **part > SMALL_PART * estimator.value).collect();
        parts.sort_by(|a, b| b.1.total_cmp(a.1));
        let parts: Vec<String> = parts.iter().map(|(name, part)| format!("{name} {part:.1e}")).collect();
        if !parts.is_empty() {
            lines.push(format!("            {}", parts.join(", ")));
        }
    }
    lines
}
