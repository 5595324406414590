//! A study as text: CSV, the table on stdout, the JSON object.

use std::fmt::Write as _;

use serde_json::{Value, json as object};

use super::fit::Fit;
use super::strategy::{End, Point};
use super::{MEASURED, Study};

/// A column that holds numbers: name, unit, meaning, value. What was not measured is NaN.
pub(super) type Column = (&'static str, &'static str, &'static str, fn(&Point) -> f64);
/// The numbers of a step.
pub(super) const NUMBERS: [Column; 8] = [
    ("seconds", "seconds", "from the beginning of the run to the end of the step, median of the runs", |p| p.seconds),
    ("error", "1", "true error, energy norm, relative; NaN where it was not measured", |p| p.error),
    ("energy", "force*length/thickness", "J", |p| p.energy),
    ("energy_error", "1", "(|J - J_ref|/|J_ref|)^(1/2)", |p| p.energy_error),
    ("estimate", "1", "estimate of the error, relative to the same norm", |p| p.estimate),
    ("effectivity", "1", "estimate over true error; NaN where that was not measured", Point::effectivity),
    ("energy_extrapolated", "force*length/thickness", "J of the spaces of one degree more", |p| p.extrapolated[0]),
    ("energy_uncertainty", "force*length/thickness", "how far the exact J may be from that", |p| p.extrapolated[1]),
];

/// The steps of all strategies as one table; what was not measured is left empty.
pub fn csv(study: &Study<'_>) -> String {
    let mut text = String::from("strategy,step,elements,max_degree,dofs");
    NUMBERS.iter().for_each(|c| text += &format!(",{}", c.0));
    text += ",doubts\n";
    for strategy in study.strategies {
        for (k, p) in strategy.points.iter().enumerate() {
            let _ = write!(text, "{},{k},{},{},{}", cell(&strategy.name), p.mesh.len(), p.max_degree(), p.dofs);
            for (.., value) in NUMBERS {
                let v = value(p);
                let _ = if v.is_finite() { write!(text, ",{v:?}") } else { write!(text, ",") };
            }
            let _ = writeln!(text, ",{}", p.doubts.join(" "));
        }
    }
    text
}

/// A text of a CSV table: in quotes where it has a comma.
fn cell(text: &str) -> String {
    if text.contains(',') { format!("\"{text}\"") } else { text.into() }
}

/// What is printed: the reference, some steps of each strategy, the fitted laws.
pub fn text(study: &Study<'_>) -> String {
    let reference = study.reference;
    let finest = reference.finest();
    let width = study.strategies.iter().map(|s| s.name.len()).fold(10, usize::max);
    let mut text = format!("{}\n", study.scene.title);
    let _ = writeln!(text, "settings    {} (--set changes them)", study.source.overrides.join(", "));
    let _ = writeln!(
        text,
        "reference   {} dofs, estimated error {:.1e}, J = {:.12e} ± {:.0e}",
        finest.dofs, finest.estimate, reference.own_energy, reference.uncertainty
    );
    let _ = writeln!(text, "            energy errors are taken from J = {:.12e}", reference.energy);
    let _ = writeln!(text, "            of {}", study.energy_source());
    let _ = writeln!(
        text,
        "\n{:<width$} {:>4} {:>8} {:>6} {:>5} {:>8} {:>9} {:>12} {:>9} {:>10}",
        "strategy", "step", "elements", "degree", "dofs", "seconds", "error", "energy error", "estimate", "est./error"
    );
    for strategy in study.strategies {
        let mut name = strategy.name.as_str();
        for k in strategy.some(MEASURED) {
            let p = &strategy.points[k];
            let doubt = if p.doubts.is_empty() { "" } else { " ?" };
            let row = format!(
                "{name:<width$} {k:>4} {:>8} {:>6} {:>5} {:>8.3} {:>9} {:>12} {:>9} {:>10}{doubt}",
                p.mesh.len(),
                p.max_degree(),
                p.dofs,
                p.seconds,
                number(p.error, |v| format!("{v:.2e}")),
                number(p.energy_error, |v| format!("{v:.2e}")),
                number(p.estimate, |v| format!("{v:.2e}")),
                number(p.effectivity(), |v| format!("{v:.2}")),
            );
            text += &format!("{}\n", row.trim_end());
            name = "";
        }
        let unknown = strategy.points.iter().filter(|p| !p.error.is_finite()).count();
        let unknown =
            if unknown > 0 { format!("; true error not measured in {unknown} of them") } else { String::new() };
        let ended = match &strategy.end {
            End::Run(reason) => format!("ended: {}, {} steps{unknown}", reason.word(), strategy.points.len()),
            End::Failed(why) => format!("FAILED after {} steps{unknown}: {why}", strategy.points.len()),
        };
        let _ = writeln!(text, "{name:<width$} {ended}");
        for fit in strategy.fits() {
            let _ = writeln!(text, "{:<width$} error ~ {}", "", law(&fit));
        }
    }
    if study.strategies.iter().flat_map(|s| &s.points).any(|p| !p.doubts.is_empty()) {
        text += "?: the estimate is not reliable there, and says so\n";
    }
    if study.interrupted {
        text += "interrupted: what was finished is here\n";
    }
    text
}

/// A number, or a dash for one that is not known.
fn number(value: f64, show: impl Fn(f64) -> String) -> String {
    if value.is_finite() { show(value) } else { "-".into() }
}

fn law(fit: &Fit) -> String {
    format!("{} (R² = {:.4}, last {} points)", fit.law.with_rate(fit.rate), fit.r_squared, fit.points)
}

/// The JSON object; numbers that are not known are null.
pub fn json(study: &Study<'_>) -> Value {
    let reference = study.reference;
    let strategies: Vec<Value> = study
        .strategies
        .iter()
        .map(|s| {
            let failure = match &s.end {
                End::Failed(why) => Some(why),
                End::Run(_) => None,
            };
            let fits = s.fits().into_iter().map(
                |f| object!({ "law": f.law.word(), "rate": f.rate, "r_squared": f.r_squared, "points": f.points }),
            );
            object!({
                "name": s.name,
                "reason": s.end.word(),
                "message": failure,
                "fits": fits.collect::<Vec<_>>(),
                "steps": s.points.iter().map(step).collect::<Vec<_>>(),
            })
        })
        .collect();
    object!({
        "title": study.scene.title,
        "settings": study.source.overrides,
        "complete": study.complete(),
        "interrupted": study.interrupted,
        "repeat": study.repeat,
        "reference": {
            "dofs": reference.finest().dofs,
            "estimate": reference.finest().estimate,
            "energy": reference.energy,
            "energy_source": study.energy_source(),
            "own_energy": reference.own_energy,
            "uncertainty": reference.uncertainty,
        },
        "strategies": strategies,
    })
}

fn step(p: &Point) -> Value {
    let mut step = object!({
        "elements": p.mesh.len(), "max_degree": p.max_degree(), "dofs": p.dofs, "doubts": p.doubts,
    });
    NUMBERS.iter().for_each(|(name, _, _, value)| step[*name] = object!(value(p)));
    step
}
