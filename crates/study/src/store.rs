//! A study as one HDF5 file.
//!
//! ```text
//! /reference             J, its uncertainty, dofs and estimates of the fine meshes
//! /strategies/NAME       columns with an entry a step, `reason`, `message`
//!   fits/LAW             rate, r_squared, points
//!   steps/NNN/mesh       mesh and degrees of each step
//!   contact              contact table of the last step
//! ```

use steklov_io::{
    File, Group, IoError, Label, create_group, save, save_integers, save_number, save_points, save_text, save_texts,
    save_vector, write_integer_attribute, write_text_attribute,
};
use steklov_model::report::ContactRow;

use super::Study;
use super::strategy::{End, Strategy};
use super::table::{NUMBERS, json};

/// Writes a study into a new file.
///
/// # Errors
/// When the file cannot be written.
pub fn write(file: &File, study: &Study<'_>) -> Result<(), IoError> {
    write_text_attribute(file, "program", concat!("steklov ", env!("CARGO_PKG_VERSION")))?;
    write_text_attribute(file, "content", "study: strategies of refinement compared")?;
    write_integer_attribute(file, "threads", &[rayon::current_num_threads() as i64])?;
    let source = study.source;
    save_text(file, "scene", &source.text, "text of the scene file")?;
    save_texts(file, "overrides", &source.overrides, "settings of the study and of the user, KEY=VALUE", "override")?;
    save_text(file, "summary", &json(study).to_string(), "the JSON object of study --json, without its list of files")?;
    let names: Vec<String> = study.strategies.iter().map(|s| s.name.clone()).collect();
    save_texts(file, "strategy_names", &names, "groups of /strategies in the order of the study", "strategy")?;
    save_reference(&create_group(file, "reference")?, study)?;
    let all = create_group(file, "strategies")?;
    study.strategies.iter().try_for_each(|s| save_strategy(&create_group(&all, &s.name)?, s))
}

fn save_reference(at: &Group, study: &Study<'_>) -> Result<(), IoError> {
    let reference = study.reference;
    let energy = "force*length/thickness";
    save_number(at, "energy", reference.energy, energy, "J from which energy errors are taken")?;
    save_text(at, "energy_source", &study.energy_source(), "where that J comes from")?;
    save_number(at, "own_energy", reference.own_energy, energy, "J of the finest mesh")?;
    save_number(at, "uncertainty", reference.uncertainty, energy, "how far the exact J may be from that")?;
    let meaning = "(2 strain energy)^(1/2) of the finest mesh: what errors are relative to";
    save_number(at, "norm", reference.norm, "(force*length/thickness)^(1/2)", meaning)?;
    let axes = &["level"];
    let dofs: Vec<usize> = reference.levels.iter().map(|l| l.dofs).collect();
    let label = Label { unit: "1", meaning: "displacement unknowns of each fine mesh", axes };
    save_integers(at, "dofs", &dofs, &label)?;
    let estimates: Vec<f64> = reference.levels.iter().map(|l| l.estimate).collect();
    save_vector(at, "estimate", &estimates, &Label { unit: "1", meaning: "estimated relative error of each", axes })
}

fn save_strategy(at: &Group, strategy: &Strategy) -> Result<(), IoError> {
    let message = match &strategy.end {
        End::Failed(why) => why,
        End::Run(_) => "",
    };
    save_text(at, "reason", strategy.end.word(), "why it ended")?;
    save_text(at, "message", message, "the error with which it failed; empty if it did not")?;
    let (points, axes) = (&strategy.points, &["step"]);
    let count = |meaning| Label { unit: "1", meaning, axes };
    let dofs: Vec<usize> = points.iter().map(|p| p.dofs).collect();
    save_integers(at, "dofs", &dofs, &count("displacement unknowns"))?;
    let elements: Vec<usize> = points.iter().map(|p| p.mesh.len()).collect();
    save_integers(at, "elements", &elements, &count("elements"))?;
    let degrees: Vec<usize> = points.iter().map(|p| p.max_degree()).collect();
    save_integers(at, "max_degree", &degrees, &count("highest degree"))?;
    for (name, unit, meaning, value) in NUMBERS {
        let values: Vec<f64> = points.iter().map(value).collect();
        save_vector(at, name, &values, &Label { unit, meaning, axes })?;
    }
    for (k, part) in ["correction", "oscillation", "tips"].into_iter().enumerate() {
        let values: Vec<f64> = points.iter().map(|p| p.parts[k]).collect();
        let meaning = format!("part of the estimate: {part}");
        save_vector(at, &format!("estimate_{part}"), &values, &Label { unit: "1", meaning: &meaning, axes })?;
    }
    let doubts: Vec<String> = points.iter().map(|p| p.doubts.join(" ")).collect();
    save_texts(at, "doubts", &doubts, "why the estimate of a step is not reliable; empty if it is", "step")?;
    let fits = create_group(at, "fits")?;
    for fit in strategy.fits() {
        let at = create_group(&fits, fit.law.word())?;
        save_number(&at, "rate", fit.rate, "1", "r in error = C N^r, C exp(r N^(1/2)) or C exp(r N^(1/3))")?;
        save_number(&at, "r_squared", fit.r_squared, "1", "1 for a perfect fit")?;
        let points = Label { unit: "1", meaning: "steps that it is fitted to, the last ones", axes: &["value"] };
        save_integers(&at, "points", &[fit.points], &points)?;
    }
    let steps = create_group(at, "steps")?;
    for (k, p) in points.iter().enumerate() {
        save(&create_group(&steps, &format!("{k:03}"))?, "mesh", &p.mesh)?;
    }
    if strategy.contact.is_empty() { Ok(()) } else { save_contact(&create_group(at, "contact")?, &strategy.contact) }
}

/// A column of the contact table: name, unit, meaning, value.
type ContactColumn = (&'static str, &'static str, &'static str, fn(&ContactRow) -> f64);
const CONTACT: [ContactColumn; 4] = [
    ("pressure", "stress", "lambda_n,i, positive in compression", |r| r.pressure),
    ("shear", "stress", "lambda_t,i", |r| r.shear),
    ("bound", "stress", "friction bound F_i", |r| r.bound),
    ("weight", "length", "length that the node stands for", |r| r.weight),
];

fn save_contact(at: &Group, rows: &[ContactRow]) -> Result<(), IoError> {
    let points: Vec<[f64; 2]> = rows.iter().map(|r| r.point).collect();
    let label = Label { unit: "length", meaning: "contact nodes", axes: &["contact node", "component"] };
    save_points(at, "points", &points, &label)?;
    let axes = &["contact node"];
    for (name, unit, meaning, value) in CONTACT {
        let values: Vec<f64> = rows.iter().map(value).collect();
        save_vector(at, name, &values, &Label { unit, meaning, axes })?;
    }
    let status: Vec<usize> = rows.iter().map(|r| r.status).collect();
    let meaning = "0 apart, 1 stick, 2 slip along +t, 3 slip along -t";
    save_integers(at, "status", &status, &Label { unit: "1", meaning, axes })?;
    let side: Vec<usize> = rows.iter().map(|r| r.side).collect();
    save_integers(at, "side", &side, &Label { unit: "1", meaning: "index into side_names of a step's mesh", axes })
}
