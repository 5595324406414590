//! The summary of a result in lines of a terminal, in the order in which readers ask: what was solved and what is in doubt; forces,
//! contact, stresses, points and lines; then the energies and how well all of it holds.

use steklov_figures::stochastic;
use steklov_io::vtkhdf::Field;
use steklov_model::doubt::Doubt;
use steklov_model::estimators::Estimators;
use steklov_model::run::adaptive_loop::Reason;
use steklov_model::summary::{
    Audit, ContactSummary, Expected, GridSummary, LineProbe, MediumSummary, Named, SideProbe, Summary,
};
use steklov_picture::plain;
use steklov_plan::{MODULI, RATIOS};
use steklov_result::record::Record;

use crate::numbers::{DIGITS, beside, digits};
use crate::told::{advice, crossing_warning, untouched};

/// Digits of the energy J, which the smallest estimates need.
const ENERGY_DIGITS: usize = 12;

/// Stresses that differ by less than this part of the largest one are the same but for rounding.
const UNIFORM: f64 = 1e-9;

/// Points of infinite stress that are named at most.
const NAMED: usize = 4;

/// Parts of an estimator below this part of it are not told.
const SMALL_PART: f64 = 1e-3;

/// Lines that are gathered: a word of at most eleven letters, or blanks, and what is told.
#[derive(Default)]
struct Lines(Vec<String>);

impl Lines {
    fn say(&mut self, word: &str, text: impl AsRef<str>) {
        self.0.push(format!("{word:<11} {}", text.as_ref()));
    }
}

/// A number with the usual digits.
fn usual(value: f64) -> String {
    plain(value, DIGITS)
}

/// Digits of an uncertainty.
const DIGITS_OF_BARS: usize = 2;

/// A number that is at most `largest`.
fn part(value: f64, largest: f64) -> String {
    usual(beside(value, largest))
}

/// Components in parentheses.
fn vector<const N: usize>(components: [f64; N]) -> String {
    vector_beside(components, 0.0)
}

/// The same of a field, of which `largest` is the largest value.
fn vector_beside<const N: usize>(components: [f64; N], largest: f64) -> String {
    let largest = components.iter().fold(largest, |largest, c| largest.max(c.abs()));
    format!("({})", components.map(|c| part(c, largest)).join(", "))
}

/// The same with the uncertainties that are known, and the digits that these leave.
fn with_bars<const N: usize>(components: [f64; N], uncertainties: [Option<f64>; N], largest: f64) -> String {
    let largest = components.iter().fold(largest, |largest, c| largest.max(c.abs()));
    let told =
        components.iter().zip(uncertainties).map(|(&value, uncertainty)| one_with_bar(value, uncertainty, largest));
    format!("({})", told.collect::<Vec<_>>().join(", "))
}

/// A number with its uncertainty, if that is known, and the digits that it leaves; without one a part of the largest of its kind.
fn one_with_bar(value: f64, uncertainty: Option<f64>, largest: f64) -> String {
    match uncertainty {
        Some(bar) if bar > 0.0 => {
            let value = if value.abs() < bar { 0.0 } else { value };
            format!("{} ± {}", plain(value, digits(value, bar)), plain(bar, DIGITS_OF_BARS))
        }
        _ => part(value, largest),
    }
}

/// A length of contact with its uncertainty, if that is known, beside all of the contact.
fn length_with_bar(s: &Summary, of: &str, name: &str, [value, all]: [f64; 2]) -> String {
    one_with_bar(value, s.quantities.get(&format!("{of}.{name}")).map(|told| told.uncertainty), all)
}

/// A force with the uncertainties of its components, if those at a path of the result are known.
fn force_with_bars(s: &Summary, force: [f64; 2], path: &str, largest: f64) -> String {
    let uncertainty = |component| Some(s.quantities.get(&format!("{path}.{component}"))?.uncertainty);
    with_bars(force, ["x", "y"].map(uncertainty), largest)
}

/// The lines of a result.
pub fn lines(stored: &Record) -> Vec<String> {
    let s = &stored.summary;
    let mut lines = Lines::default();
    solved(stored, &mut lines);
    let largest = s.reactions.values().flatten().fold(0.0, |largest: f64, force| largest.max(force.abs()));
    for (side, force) in &s.reactions {
        let path = format!("reactions.{side}");
        lines.say("reaction", format!("{side}: {}", force_with_bars(s, *force, &path, largest)));
    }
    if let Some(c) = &s.contact {
        contact(stored, c, &mut lines);
    }
    interfaces(s, &mut lines);
    stress(stored, &mut lines);
    probes(stored, &mut lines);
    named(s, &mut lines);
    if let Some(exterior) = &s.exterior {
        far_away(exterior, &mut lines);
    }
    energies(s, &mut lines);
    if let Some(grid) = &s.grid {
        on_grid(stored, grid, &mut lines);
    }
    for (k, body) in s.bodies.iter().enumerate() {
        let energy = energy_with_bar(s, body.strain_energy, &format!("bodies.{k}.strain_energy"));
        lines.say("body", format!("{}: {} dofs, strain energy {energy}", body.name, body.dofs));
    }
    if let Some(a) = &s.audit {
        audit(a, &mut lines);
    }
    lines.0.extend(stochastic::lines(stored));
    lines.0.extend(s.expect.iter().map(expectation));
    let memory = s.peak_memory_bytes as f64 / f64::from(1 << 20);
    lines.say("seconds", format!("{:.3}, peak memory {memory:.1} MiB", s.seconds.total));
    lines.say("result", &s.file);
    lines.0
}

/// What was solved, why the run ended, and what is in doubt.
fn solved(stored: &Record, lines: &mut Lines) {
    let Record { summary: s, plan, .. } = stored;
    // no control letter of a title reaches the terminal
    lines.0.push(s.title.replace(char::is_control, " "));
    let named = [("length", &s.units.length), ("stress", &s.units.stress)];
    let named: Vec<String> = named.iter().filter_map(|(of, name)| Some(format!("{of} {}", name.as_ref()?))).collect();
    if !named.is_empty() {
        lines.say("units", named.join(", "));
    }
    let steps = if s.steps == 1 { "step" } else { "steps" };
    let ended = if s.converged { &s.reason } else { "NOT CONVERGED" };
    lines.0.push(format!("{} dofs, {} {steps}: {ended}", s.dofs, s.steps));
    if !s.converged {
        lines.say("reason", &s.reason);
        advice(s, plan).iter().for_each(|advice| lines.say("", advice));
    }
    if let Some(failure) = s.failure.as_ref().filter(|_| s.reason == Reason::Failed.word()) {
        lines.say("", format!("in the step after these: {failure}"));
    }
    let doubts = s.estimate_doubts.iter().filter_map(|word| Doubt::of_word(word));
    doubts.for_each(|doubt| lines.say("doubt", doubt.to_string()));
    for r in &s.reach {
        let ([a, b], depth, place) = (&r.bodies, plain(r.depth, 4), vector(r.point));
        lines.say(
            "reach",
            format!("{a} and {b} lie {depth} in each other at {place}: name the sides that meet there in an interface"),
        );
    }
    s.grid.iter().filter_map(crossing_warning).for_each(|warning| lines.say("warning", warning));
    if stored.stochastic.is_some() {
        let text = "what follows is one solution, of the mean of the random input; means of all outcomes stand under `outcomes`";
        lines.say("mean input", text);
    }
}

fn contact(stored: &Record, c: &ContactSummary, lines: &mut Lines) {
    let s = &stored.summary;
    let count = s.iterations;
    let with_bar =
        |value: f64, path: &str| one_with_bar(value, s.quantities.get(path).map(|told| told.uncertainty), value);
    let of_length = |value: f64, name: &str| length_with_bar(s, "contact", name, [value, c.length]);
    let (length, stick, slip) = (of_length(c.length, "length"), of_length(c.stick, "stick"), of_length(c.slip, "slip"));
    lines.say("contact", format!("length {length}, stick {stick}, slip {slip}, {count} iterations"));
    let largest = stored.contact.iter().max_by(|a, b| a.pressure.total_cmp(&b.pressure));
    let place =
        largest.filter(|row| row.pressure > 0.0).map_or(String::new(), |row| format!(" at {}", vector(row.point)));
    let note = if c.max_pressure_unbounded { " (the exact one is infinite: this is a number of the mesh)" } else { "" };
    lines.say("", format!("largest pressure {}{place}{note}", with_bar(c.max_pressure, "contact.max_pressure")));
    lines.say("", format!("force on the body {}", force_with_bars(s, c.force, "contact.force", 0.0)));
    if let Some(factor) = c.contraction {
        let note = if factor < 1.0 { "" } else { ": the fixed point of Tresca problems does not settle" };
        lines.say("", format!("Coulomb friction, contraction {factor:.3}{note}"));
    }
    let tension = if s.exterior.is_some() { ": stresses far away are negative in compression" } else { "" };
    untouched(stored).iter().for_each(|side| lines.say("", format!("nothing touches side {side}{tension}")));
}

/// The interfaces between several bodies.
fn interfaces(s: &Summary, lines: &mut Lines) {
    let in_doubt = s.estimate_doubts.iter().any(|word| word == Doubt::Normals.word());
    for (number, i) in s.interfaces.iter().enumerate() {
        let path = format!("interfaces.{number}");
        let of_length = |value: f64, name: &str| length_with_bar(s, &path, name, [value, i.length]);
        let stick = i.stick.map_or(String::new(), |stick| format!(", stick {}", of_length(stick, "stick")));
        // where the largest one is infinite, the line above says so
        let bounded = s.contact.as_ref().is_some_and(|contact| !contact.max_pressure_unbounded);
        let bar = s.quantities.get(&format!("interfaces.{number}.max_pressure")).map(|told| told.uncertainty);
        let told = |p| format!(", largest pressure {}", one_with_bar(p, bar, p));
        let pressure = i.max_pressure.filter(|_| bounded).map_or(String::new(), told);
        let (length, force) =
            (of_length(i.length, "length"), force_with_bars(s, i.force, &format!("{path}.force"), 0.0));
        lines.say("interface", format!("{}: {}, length {length}{stick}{pressure}, force {force}", i.name, i.kind));
        if let Some(n) = i.normals.filter(|_| in_doubt) {
            let (angle, change) = (n.angle.to_degrees(), plain(n.energy_change, 2));
            let text =
                format!("normals of the two sides differ by up to {angle:.2}°: J is uncertain by {change} for that");
            lines.say("", text);
        }
    }
}

/// The largest von Mises stress of the points, or cells, of the result file, and where the exact one is infinite.
fn stress(stored: &Record, lines: &mut Lines) {
    let grid = &stored.grid;
    let corners = |cell: &[usize]| {
        let sum = |i: usize| cell.iter().map(|&p| grid.points[p][i]).sum::<f64>() / cell.len() as f64;
        [sum(0), sum(1)]
    };
    let cells = || {
        let triangles = grid.triangles.iter().map(|cell| cell.as_slice());
        triangles.chain(grid.quads.iter().map(|cell| cell.as_slice())).map(corners)
    };
    let of = |fields: &'_ [Field]| fields.iter().position(|f| f.name == "von_mises");
    let largest = |values: &[f64], places: &mut dyn Iterator<Item = [f64; 2]>, of: String| {
        let smallest = values.iter().copied().filter(|value| value.is_finite()).fold(f64::INFINITY, f64::min);
        let known = values.iter().copied().zip(places).filter(|(value, _)| value.is_finite());
        let (value, place) = known.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(match (value - smallest <= UNIFORM * value, largest_von_mises(&stored.summary)) {
            (true, _) => format!("von Mises {} at all {of}", usual(value)),
            (false, Some((value, place))) => format!("von Mises up to {value} at {place}"),
            (false, None) => format!("von Mises up to {} at {}, the largest at {of}", usual(value), vector(place)),
        })
    };
    let found = match (of(&grid.point_data), of(&grid.cell_data)) {
        (Some(k), _) => {
            let all = format!("{} points of the result file", grid.points.len());
            largest(&grid.point_data[k].values, &mut grid.points.iter().copied(), all)
        }
        (None, Some(k)) => {
            let all = format!("{} cells, in their middle, of the result file", grid.triangles.len() + grid.quads.len());
            largest(&grid.cell_data[k].values[grid.lines.len()..], &mut cells(), all)
        }
        (None, None) => None,
    };
    let infinite = &stored.summary.infinite_stress;
    if !infinite.is_empty() {
        let more = if infinite.len() > NAMED { format!(" and {} more", infinite.len() - NAMED) } else { String::new() };
        let places: Vec<String> = infinite.iter().take(NAMED).map(|place| vector(*place)).collect();
        lines.say("stress", format!("infinite at {}{more}", places.join(", ")));
    } else if let Some(told) = found {
        lines.say("stress", told);
    }
}

/// The largest von Mises stress with its uncertainty and its place, where it is known.
fn largest_von_mises(s: &Summary) -> Option<(String, String)> {
    let (value, place) = s.max_von_mises.zip(s.max_von_mises_at)?;
    let uncertainty = s.quantities.get("max_von_mises")?.uncertainty;
    Some((one_with_bar(value, Some(uncertainty), value), vector(place)))
}

/// Points, lines and sides of `[probe]`, each with its stress, or the largest one at its points, or where it is infinite.
fn probes(stored: &Record, lines: &mut Lines) {
    let s = &stored.summary;
    let largest = stored.displacement.as_flattened().iter().fold(0.0, |largest: f64, u| largest.max(u.abs()));
    for (k, p) in s.probe.iter().enumerate() {
        let uncertainty = |name: &str| Some(s.quantities.get(&format!("probe.{k}.{name}"))?.uncertainty);
        let of_displacement = ["displacement.x", "displacement.y"].map(uncertainty);
        let ([x, y], u) = (p.point, with_bars(p.displacement, of_displacement, largest));
        let of_stress = ["stress.xx", "stress.yy", "stress.xy"].map(uncertainty);
        let stress = match p.stress_unbounded {
            true => "stress unbounded: infinite at this vertex, whatever the mesh".to_owned(),
            false => format!("stress = {}", with_bars(p.stress, of_stress, 0.0)),
        };
        lines.say("probe", format!("({x}, {y}): u = {u}, {stress}"));
    }
    let peak = |points: &[(bool, f64, [f64; 2])]| {
        let largest = || points.iter().filter(|p| p.1.is_finite()).max_by(|a, b| a.1.total_cmp(&b.1));
        match (points.iter().find(|p| p.0), largest()) {
            (Some((.., [x, y])), _) => format!(", stress unbounded at ({x}, {y})"),
            (None, Some((_, value, place))) => {
                format!(", von Mises stress up to {} at {}", usual(*value), vector(*place))
            }
            (None, None) => String::new(),
        }
    };
    for (k, line) in (1..).zip(&s.probe_lines) {
        let LineProbe { from: [x, y], to: [u, v], points } = line;
        let inside = points.iter().filter(|p| !p.displacement[0].is_nan()).count();
        let all: Vec<_> = points.iter().map(|p| (p.stress_unbounded, p.von_mises, p.point)).collect();
        let count = points.len();
        lines.say(
            &format!("line {k}"),
            format!("({x}, {y}) to ({u}, {v}): {inside} of {count} points in a body{}", peak(&all)),
        );
    }
    for SideProbe { side, points } in &s.probe_sides {
        let all: Vec<_> = points.iter().map(|p| (p.stress_unbounded, p.von_mises, p.point)).collect();
        lines.say("side", format!("{side}: {} points{}", points.len(), peak(&all)));
    }
}

/// The numbers that the scene asks for by names.
fn named(s: &Summary, lines: &mut Lines) {
    let Named { pressure, mean_displacement, moment, weighted_force, opening } = &s.named;
    let uncertainty = |path: String| Some(s.quantities.get(&path)?.uncertainty);
    for (group, what, all) in [
        ("pressure", "pressure", pressure),
        ("moment", "moment", moment),
        ("weighted_force", "weighted", weighted_force),
        ("opening", "opening", opening),
    ] {
        for (name, &value) in all {
            let told = match value.is_nan() {
                true => "infinite, whatever the mesh".to_owned(),
                false => one_with_bar(value, uncertainty(format!("{group}.{name}")), value.abs()),
            };
            lines.say(what, format!("{name} = {told}"));
        }
    }
    for (name, mean) in mean_displacement {
        let uncertainties = ["x", "y"].map(|i| uncertainty(format!("mean_displacement.{name}.{i}")));
        lines.say("mean", format!("{name}: u = {}", with_bars(*mean, uncertainties, 0.0)));
    }
}

/// What the medium does far away; with a net force also that its displacement depends on a length.
fn far_away(exterior: &MediumSummary, lines: &mut Lines) {
    let MediumSummary { radiation, resultant, balanced, constant, length } = exterior;
    match (radiation.as_str(), balanced) {
        ("bounded", _) => lines.say("at infinity", format!("bounded, displacement {}", vector(*constant))),
        (_, true) => lines.say("at infinity", "decaying: the forces on the medium are balanced"),
        (_, false) => {
            let (force, length) = (vector(*resultant), usual(*length));
            lines.say("at infinity", format!("net force {force} on the medium, which does not vanish far away"));
            let text = "the displacement grows as log(L/r), and its translation depends on the length L";
            lines.say("", format!("{text} = {length}:"));
            lines.say("", "compare displacements of two points, or hold a point that is known not to move");
        }
    }
}

/// An energy with the error bar of a path, if there is one.
fn energy_with_bar(s: &Summary, value: f64, path: &str) -> String {
    one_with_bar(value, s.quantities.get(path).map(|told| told.uncertainty), value)
}

/// The energy J with its parts and its error.
fn energies(s: &Summary, lines: &mut Lines) {
    // else the extrapolated one has the bar
    let told = s.quantities.get("energy").filter(|_| s.energy_extrapolated.is_none());
    let bar = told.map_or(String::new(), |told| format!(" ± {}", plain(told.uncertainty, 2)));
    lines.say("energy J", plain(s.energy, ENERGY_DIGITS) + &bar);
    let springs = |energy| format!("springs {}, ", energy_with_bar(s, energy, "spring_energy"));
    let springs = s.spring_energy.map_or(String::new(), springs);
    let friction = part(s.friction_work, s.strain_energy.abs().max(s.load_work.abs()));
    let with_bar = |value: f64, path: &str| energy_with_bar(s, value, path);
    let (strain, work) = (with_bar(s.strain_energy, "strain_energy"), with_bar(s.load_work, "load_work"));
    let friction = match s.quantities.get("friction_work") {
        Some(told) if told.uncertainty < told.value.abs() => with_bar(s.friction_work, "friction_work"),
        _ => friction,
    };
    lines.say("", format!("strain {strain}, {springs}load work {work}, friction work {friction}"));
    if let (Some(energy), Some(uncertainty)) = (s.energy_extrapolated, s.energy_uncertainty) {
        let value = plain(energy, digits(energy, uncertainty));
        lines.say("", format!("J extrapolated {value} ± {}", plain(uncertainty, 2)));
    }
    if let (Some(error), Some(relative)) = (s.estimate, s.estimate_relative) {
        let doubts = match s.estimate_doubts.as_slice() {
            [] => String::new(),
            doubts => format!(" (not reliable: {})", doubts.join(", ")),
        };
        let (error, relative) = (plain(error, 4), plain(relative, 4));
        lines.say("error", format!("{error} estimated in the energy norm, relative {relative}{doubts}"));
    }
    if let Some(grid) = &s.grid {
        let parts = [
            (grid.estimate_multiscale, "by the coarse cells"),
            (grid.estimate_fine_grid, "by the fine grid itself"),
            (grid.estimate_medium, "by the boundary elements around it"),
        ];
        let parts: Vec<String> =
            parts.into_iter().filter_map(|(part, of)| Some(format!("{} {of}", plain(part?, 4)))).collect();
        if parts.len() > 1 {
            lines.say("", format!("of it {}", parts.join(", ")));
        }
    }
    s.estimators.iter().for_each(|estimators| residuals(estimators, lines));
}

/// The residual estimators, the largest parts first.
fn residuals(estimators: &Estimators, lines: &mut Lines) {
    for (name, estimator) in estimators.named() {
        let Some(estimator) = estimator else { continue };
        let (value, relative) = (plain(estimator.value, 4), plain(estimator.relative, 4));
        lines.say("residual", format!("{value} by {name}, relative {relative}"));
        let mut parts: Vec<_> =
            estimator.parts.iter().filter(|(_, part)| **part > SMALL_PART * estimator.value).collect();
        parts.sort_by(|a, b| b.1.total_cmp(a.1));
        let parts: Vec<String> = parts.iter().map(|(name, part)| format!("{name} {}", plain(**part, 2))).collect();
        if !parts.is_empty() {
            lines.say("", parts.join(", "));
        }
    }
}

/// The grid of finite elements.
fn on_grid(stored: &Record, grid: &GridSummary, lines: &mut Lines) {
    let ([nx, ny], unknowns) = (grid.cells, grid.fine_dofs);
    let cells = match (&grid.basis, grid.coarse_cells, grid.patterns) {
        (Some(basis), Some(coarse), Some(patterns)) => format!(
            "{nx} by {ny} fine cells, {unknowns} unknowns; {coarse} coarse cells, basis {basis}, {patterns} local problem(s)"
        ),
        _ => format!("{nx} by {ny} cells"),
    };
    lines.say("grid", cells);
    if let Some(n) = grid.boundary_elements {
        lines.say("", format!("{n} boundary elements of the medium around it"));
    }
    lines.say("", format!("contrast of the moduli {}", plain(grid.contrast, 5)));
    for (what, word) in [(MODULI, "modulus"), (RATIOS, "Poisson's ratio")] {
        let told = stored.plan.modelled.iter().filter(|d| d.what == what);
        told.for_each(|d| lines.say("", format!("{word} {}", d.choice)));
    }
}

fn audit(a: &Audit, lines: &mut Lines) {
    let conditions = [
        ("equilibrium", a.equilibrium),
        ("penetration", a.penetration),
        ("tension", a.tension),
        ("complementarity", a.complementarity),
        ("friction", a.friction),
    ];
    lines.say("audit", conditions.map(|(name, value)| format!("{name} {}", plain(value, 2))).join(", "));
}

/// An entry of `[expect]` and whether it holds.
pub fn expectation(entry: &Expected) -> String {
    let Expected { path, value, expected, tol, holds } = entry;
    let word = if *holds { "holds" } else { "DOES NOT HOLD" };
    match value {
        Some(value) => format!(
            "expected    {path} = {expected} ± {tol:e}: {value:?}, off by {}: {word}",
            plain((value - expected).abs(), 2)
        ),
        None => format!("expected    {path} = {expected} ± {tol:e}: this result has no such number: {word}"),
    }
}
