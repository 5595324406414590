//! The stored and printed results of the study.
//!
//! ```text
//! /reference             J, its uncertainty, dofs and estimates of the fine meshes
//! /strategies/NAME       columns with an entry per step, `reason`, `message`
//!   fits/LAW             rate, r_squared, points
//!   steps/NNN/mesh       mesh and degrees of each step
//!   contact              contact table of the last step
//! ```

use std::fmt::Write as _;

use serde_json::{Value, json};
use steklov_io::Label;
use steklov_model::estimators::ON_BOUNDARY;
use steklov_model::solve::contact_rows::ContactRow;

use super::strategy::{Constants, End, Point, Strategy};
use super::{MEASURED, Study};
use crate::fit::Fit;
use crate::reference::{Level, Reference};
use crate::report::{Part, Report, columns, counts, number, part, points, text, texts, told, vector};
use crate::show::{self, Shown, heads};
use crate::table::{Column, Table};

/// The numbers of a step.
const NUMBERS: [Column<Point>; 10] = [
    ("seconds", "seconds", "from the beginning of the run to the end of the step, median of the runs", |p| p.seconds),
    ("error", "1", "true error, energy norm, relative; NaN where it was not measured", |p| p.error),
    ("energy", "force*length/thickness", "J", |p| p.energy),
    ("energy_error", "1", "(|J - J_ref|/|J_ref|)^(1/2)", |p| p.energy_error),
    ("estimate", "1", "estimate of the error, relative to the same norm", |p| p.estimate),
    ("effectivity", "1", "estimate over true error; NaN where that was not measured", Point::effectivity),
    ("energy_extrapolated", "force*length/thickness", "J of the spaces of one degree more", |p| p.extrapolated[0]),
    ("energy_uncertainty", "force*length/thickness", "how far the exact J may be from that", |p| p.extrapolated[1]),
    ("residual", "1", "residual estimator, relative to the same norm; NaN where there is none", |p| {
        p.residual.as_ref().map_or(f64::NAN, |residual| residual.value)
    }),
    ("residual_effectivity", "1", "residual estimator over true error; NaN where one is not known", |p| {
        p.residual_effectivity()
    }),
];

/// A part of the residual estimator; NaN if it has no part of this name.
fn residual_part(p: &Point, name: &str) -> f64 {
    p.residual.as_ref().and_then(|residual| residual.parts.get(name)).copied().unwrap_or(f64::NAN)
}

/// The parts of the residual estimator.
const RESIDUAL_PARTS: [Column<Point>; ON_BOUNDARY.len()] = [
    ("residual_neumann", "1", ON_BOUNDARY[0].1, |p| residual_part(p, ON_BOUNDARY[0].0)),
    ("residual_equation", "1", ON_BOUNDARY[1].1, |p| residual_part(p, ON_BOUNDARY[1].0)),
    ("residual_contact", "1", ON_BOUNDARY[2].1, |p| residual_part(p, ON_BOUNDARY[2].0)),
    ("residual_stabilisation", "1", ON_BOUNDARY[3].1, |p| residual_part(p, ON_BOUNDARY[3].0)),
    ("residual_complementarity", "1", ON_BOUNDARY[4].1, |p| residual_part(p, ON_BOUNDARY[4].0)),
    ("residual_tension", "1", ON_BOUNDARY[5].1, |p| residual_part(p, ON_BOUNDARY[5].0)),
    ("residual_penetration", "1", ON_BOUNDARY[6].1, |p| residual_part(p, ON_BOUNDARY[6].0)),
    ("residual_bound", "1", ON_BOUNDARY[7].1, |p| residual_part(p, ON_BOUNDARY[7].0)),
    ("residual_friction", "1", ON_BOUNDARY[8].1, |p| residual_part(p, ON_BOUNDARY[8].0)),
    ("residual_held", "1", ON_BOUNDARY[9].1, |p| residual_part(p, ON_BOUNDARY[9].0)),
];

/// The parts of its estimate.
const PARTS: [Column<Point>; 3] = [
    ("estimate_correction", "1", "part of the estimate: correction", |p| p.parts[0]),
    ("estimate_oscillation", "1", "part of the estimate: oscillation", |p| p.parts[1]),
    ("estimate_tips", "1", "part of the estimate: tips", |p| p.parts[2]),
];

/// The numbers of a contact node.
const CONTACT: [Column<ContactRow>; 4] = [
    ("pressure", "stress", "lambda_n,i, positive in compression", |r| r.pressure),
    ("shear", "stress", "lambda_t,i", |r| r.shear),
    ("bound", "stress", "friction bound F_i", |r| r.bound),
    ("weight", "length", "length that the node stands for", |r| r.weight),
];

/// The results of the study.
pub fn report<'a>(study: &'a Study<'_>) -> Report<'a> {
    let names: Vec<String> = study.strategies.iter().map(|s| s.name.clone()).collect();
    let told_strategies = study.strategies.iter().map(told_strategy).collect::<Value>();
    let kept_strategies = study.strategies.iter().map(|s| part(&s.name, kept_strategy(s))).collect();
    let parts = vec![
        told("repeat", study.repeat),
        texts("strategy_names", names, "groups of /strategies in the order of the study", "strategy"),
        part("reference", reference(study)),
        told("strategies", told_strategies),
        part("strategies", kept_strategies).only_kept(),
    ];
    let all = || study.strategies.iter().flat_map(|s| s.points.iter().enumerate().map(move |(k, p)| (s, k, p)));
    // quoted if it has a comma
    let quoted = |name: &str| if name.contains(',') { format!("\"{name}\"") } else { name.into() };
    let steps = steps(&all().map(|(_, _, p)| p).collect::<Vec<_>>());
    let steps = steps.key("strategy,step", all().map(|(s, k, _)| format!("{},{k}", quoted(&s.name))));
    Report {
        content: "study: strategies of refinement compared",
        overrides: "settings of the study and of the user, KEY=VALUE",
        scene: study.scene,
        source: study.source,
        complete: study.complete(),
        interrupted: study.interrupted,
        parts,
        tables: vec![("study.csv", steps.csv())],
        body: body(study),
    }
}

fn reference(study: &Study<'_>) -> Vec<Part> {
    let Reference { energy, own_energy, uncertainty, norm, levels, .. } = &study.reference;
    let finest = study.reference.finest();
    let unit = "force*length/thickness";
    let meaning = "(2 strain energy)^(1/2) of the finest mesh: what errors are relative to";
    let of_meshes = |meaning| Label { unit: "1", meaning, axes: &["level"] };
    let dofs = levels.iter().map(|l| l.dofs).collect();
    let estimates: Vec<f64> = levels.iter().map(|l| l.estimate).collect();
    vec![
        number("energy", *energy, unit, "J from which energy errors are taken"),
        text("energy_source", &study.energy_source(), "where that J comes from"),
        number("own_energy", *own_energy, unit, "J of the finest mesh"),
        number("uncertainty", *uncertainty, unit, "how far the exact J may be from that"),
        number("norm", *norm, "(force*length/thickness)^(1/2)", meaning).only_kept(),
        told("dofs", finest.dofs),
        counts("dofs", dofs, of_meshes("displacement unknowns of each fine mesh")),
        told("estimate", finest.estimate),
        vector("estimate", &estimates, of_meshes("estimated relative error of each")).only_kept(),
    ]
}

/// The steps.
fn steps(points: &[&Point]) -> Table {
    let doubts = points.iter().map(|p| p.doubts.clone()).collect();
    Table::digits("step", points.iter().copied(), &NUMBERS)
        .words("doubts", "why the estimate of a step is not reliable; empty if it is", doubts)
        .counts("dofs", "displacement unknowns", points.iter().map(|p| p.dofs).collect())
        .counts("max_degree", "highest degree", points.iter().map(|p| p.max_degree()).collect())
        .counts("elements", "elements", points.iter().map(|p| p.mesh.len()).collect())
}

fn told_strategy(s: &Strategy) -> Value {
    let failure = match &s.end {
        End::Failed(why) => Some(why),
        End::Run(_) => None,
    };
    let fit = |f: Fit| json!({ "law": f.law.word(), "rate": f.rate, "r_squared": f.r_squared, "points": f.points });
    json!({
        "name": s.name,
        "reason": s.end.word(),
        "message": failure,
        "residual_constants": s.constants().map(|c| {
            json!({ "reliability": c.reliability, "efficiency": c.efficiency, "steps": c.steps })
        }),
        "fits": s.fits().into_iter().map(fit).collect::<Value>(),
        "steps": steps(&s.points.iter().collect::<Vec<_>>()).json(),
    })
}

fn kept_strategy(s: &Strategy) -> Vec<Part> {
    let message = match &s.end {
        End::Failed(why) => why,
        End::Run(_) => "",
    };
    let fit = |f: Fit| {
        let label = Label { unit: "1", meaning: "steps that it is fitted to, the last ones", axes: &["value"] };
        let rate = number("rate", f.rate, "1", "r in error = C N^r, C exp(r N^(1/2)) or C exp(r N^(1/3))");
        let r_squared = number("r_squared", f.r_squared, "1", "1 for a perfect fit");
        part(f.law.word(), vec![rate, r_squared, counts("points", vec![f.points], label)])
    };
    let mesh = |(k, p): (usize, &Point)| part(&format!("{k:03}"), vec![crate::report::mesh("mesh", &p.mesh)]);
    let mut parts = vec![
        text("reason", s.end.word(), "why it ended"),
        text("message", message, "the error with which it failed; empty if it did not"),
        columns("", steps(&s.points.iter().collect::<Vec<_>>())),
        columns("", Table::new("step", &s.points, &PARTS)),
        columns("", Table::new("step", &s.points, &RESIDUAL_PARTS)),
        part("fits", s.fits().into_iter().map(fit).collect()),
        part("steps", s.points.iter().enumerate().map(mesh).collect()),
    ];
    if let Some(c) = s.constants() {
        let steps = Label { unit: "1", meaning: "steps whose true error was measured", axes: &["value"] };
        parts.push(part(
            "residual_constants",
            vec![
                number("reliability", c.reliability, "1", "largest true error over residual estimator"),
                number("efficiency", c.efficiency, "1", "largest residual estimator over true error"),
                counts("steps", vec![c.steps], steps),
            ],
        ));
    }
    if !s.contact.is_empty() {
        let nodes = &s.contact;
        let meaning = "0 apart, 1 stick, 2 slip along +t, 3 slip along -t";
        let table = Table::new("contact node", nodes, &CONTACT)
            .counts("status", meaning, nodes.iter().map(|r| r.status).collect())
            .counts("side", "index into side_names of a step's mesh", nodes.iter().map(|r| r.side).collect());
        let label = Label { unit: "length", meaning: "contact nodes", axes: &["contact node", "component"] };
        let at = points("points", nodes.iter().map(|r| r.point).collect(), label);
        parts.push(part("contact", vec![at, columns("", table)]));
    }
    parts
}

/// The reference, some steps of each strategy, the fitted laws.
fn body(study: &Study<'_>) -> String {
    let Reference { energy, own_energy, uncertainty, .. } = &study.reference;
    let Level { dofs, estimate, .. } = study.reference.finest();
    let mut text = show::head(study.source, None);
    let _ = writeln!(
        text,
        "reference   {dofs} dofs, estimated error {estimate:.1e}, J = {own_energy:.12e} ± {uncertainty:.0e}"
    );
    let _ = writeln!(text, "            energy errors are taken from J = {energy:.12e}");
    let _ = writeln!(text, "            of {}", study.energy_source());
    let width = study.strategies.iter().map(|s| s.name.len()).fold(10, usize::max);
    text += "\n";
    let _ = write!(text, "{:<width$} {:>4}", "strategy", "step");
    heads(&mut text, ("", 0), &SHOWN);
    for strategy in &study.strategies {
        show_strategy(&mut text, strategy, width);
    }
    if study.strategies.iter().flat_map(|s| &s.points).any(|p| !p.doubts.is_empty()) {
        text += "?: the estimate is not reliable there, and says so\n";
    }
    text
}

/// The printed numbers of a step.
const SHOWN: [Shown<Point>; 9] = [
    ("elements", 8, |p| p.mesh.len().to_string()),
    ("degree", 6, |p| p.max_degree().to_string()),
    ("dofs", 5, |p| p.dofs.to_string()),
    ("seconds", 8, |p| format!("{:.3}", p.seconds)),
    ("error", 9, |p| small(p.error)),
    ("energy error", 12, |p| small(p.energy_error)),
    ("estimate", 9, |p| small(p.estimate)),
    ("est./error", 10, |p| show::number(p.effectivity(), |v| format!("{v:.2}"))),
    ("res./error", 10, |p| show::number(p.residual_effectivity(), |v| format!("{v:.2}"))),
];

fn small(value: f64) -> String {
    show::number(value, |v| format!("{v:.2e}"))
}

fn show_strategy(text: &mut String, strategy: &Strategy, width: usize) {
    let mut name = strategy.name.as_str();
    let points = &strategy.points;
    for k in strategy.some(MEASURED) {
        let mut row = String::new();
        show::rows(&mut row, (&format!("{name:<width$} {k:>4}"), 0), &SHOWN, std::iter::once(&points[k]));
        let doubt = if points[k].doubts.is_empty() { "" } else { " ?" };
        let _ = writeln!(text, "{}{doubt}", row.trim_end());
        name = "";
    }
    let unknown = points.iter().filter(|p| !p.error.is_finite()).count();
    let unknown = if unknown > 0 { format!("; true error not measured in {unknown} of them") } else { String::new() };
    let ended = match &strategy.end {
        End::Run(reason) => format!("ended: {}, {} steps{unknown}", reason.word(), points.len()),
        End::Failed(why) => format!("FAILED after {} steps{unknown}: {why}", points.len()),
    };
    let _ = writeln!(text, "{name:<width$} {ended}");
    for Fit { law, rate, r_squared, points } in strategy.fits() {
        let law = law.with_rate(rate);
        let _ = writeln!(text, "{:<width$} error ~ {law} (R² = {r_squared:.4}, last {points} points)", "");
    }
    if let Some(Constants { reliability, efficiency, steps }) = strategy.constants() {
        let _ = writeln!(
            text,
            "{:<width$} error <= {reliability:.2} of the residual estimator, which is <= {efficiency:.2} of the error ({steps} steps)",
            ""
        );
    }
}
