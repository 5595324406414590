//! `/stochastic` of the result file, and back.

use faer::Mat;
use steklov_io::{
    Group, IoError, create_group, invalid, label, load_dense, load_integers, load_number, load_texts, load_vector,
    open_group, save_dense, save_integers, save_number, save_texts, save_vector,
};
use steklov_model::stochastic::{BodyMoments, Cells, End, FieldModes, Level, Quantity, StochasticResult};
use steklov_stochastic::{Histogram, Moments};

fn matrix(rows: &[Vec<f64>]) -> Mat<f64> {
    Mat::from_fn(rows.len(), rows.first().map_or(0, Vec::len), |i, j| rows[i][j])
}

fn rows(matrix: &Mat<f64>) -> Vec<Vec<f64>> {
    (0..matrix.nrows()).map(|i| (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect()).collect()
}

/// Writes the points, the quantities, the moments of the fields and the expansions of random fields.
///
/// # Errors
/// When the file cannot be written.
pub fn write(at: &Group, result: &StochasticResult) -> Result<(), IoError> {
    let germ = &["point", "germ"];
    save_texts(at, "germs", &result.labels, "independent random variables: the directions of the problem", "germ")?;
    save_dense(at, "points", matrix(&result.points).as_ref(), &label("1", "germs of each point", germ))?;
    save_vector(at, "weights", &result.weights, &label("1", "weights of the points, sum 1", &["point"]))?;
    save_vector(
        at,
        "young",
        &result.young,
        &label(
            "stress",
            "Young's modulus of each point, of several bodies that of the first one with a random modulus, on grids its mean over the body",
            &["point"],
        ),
    )?;
    save_moments(at, "displacement", "length", "nodal displacement, component fastest", &result.displacement)?;
    if !result.stress_displacement.is_empty() {
        let stressed = label("length", "mean of E/E0 u: the displacement of E0 with the mean stress", &["unknown"]);
        save_vector(at, "stress_displacement", &result.stress_displacement, &stressed)?;
    }
    if !result.moduli.is_empty() {
        let meaning = "Young's modulus of each cell of the body in the first samples of the seed";
        save_dense(at, "moduli", matrix(&result.moduli).as_ref(), &label("stress", meaning, &["sample", "cell"]))?;
    }
    if let Some(BodyMoments { displacement, stress, young }) = &result.in_body {
        let group = create_group(at, "body")?;
        save_moments(
            &group,
            "displacement",
            "length",
            "displacement of each fine node, component fastest",
            displacement,
        )?;
        save_moments(&group, "stress", "stress", "stress xx, yy, xy in the middle of each cell of the body", stress)?;
        save_moments(&group, "young", "stress", "Young's modulus of each cell of the body", young)?;
    }
    save_moments(at, "pressure", "stress", "lambda_n of each contact node", &result.pressure)?;
    save_moments(at, "shear", "stress", "lambda_t of each contact node", &result.shear)?;
    let contact = label("1", "probability of contact of each contact node", &["contact node"]);
    save_vector(at, "probability", &result.probability, &contact)?;
    if !result.displacements.is_empty() {
        let meaning = label("length", "nodal displacement of every point", &["point", "unknown"]);
        save_dense(at, "displacements", matrix(&result.displacements).as_ref(), &meaning)?;
    }
    let counts = [result.solved, result.iterations, result.unconverged, usize::from(result.coupled)];
    let checks = [result.checks, usize::from(result.overlooked)];
    let meaning = "outcomes solved to look between the points, 1 if they show what the points do not";
    save_integers(at, "checks", &checks, &label("1", meaning, &["what"]))?;
    if let Some(unseen) = result.unseen {
        save_number(at, "unseen", unseen, "1", "probability below which other data or contact cannot be excluded")?;
    }
    let meaning = "points solved, iterations of the contact solver, points without convergence, 1 for coupled nodes";
    save_integers(at, "counts", &counts, &label("1", meaning, &["what"]))?;
    save_texts(at, "reason", &[result.end.word().to_owned()], "why no more outcomes were solved", "what")?;
    save_number(at, "seconds", result.seconds, "second", "wall time")?;
    if let (Some(cells), Some(truncation)) = (&result.cells, result.truncation) {
        let group = create_group(at, "mesh")?;
        save_number(&group, "truncation", truncation, "1", "estimated truncation over the energy norm, mean square")?;
        if let Some(measured) = result.truncation_measured {
            save_number(&group, "truncation_measured", measured, "1", "that of fresh outcomes")?;
        }
        let by_germ = label("1", "its square, by germ", &["germ"]);
        save_vector(&group, "truncation_by_germ", &result.truncation_by_germ, &by_germ)?;
        let axes = &["cell", "germ"];
        save_dense(&group, "low", matrix(&cells.low).as_ref(), &label("1", "lower ends of the cells", axes))?;
        save_dense(&group, "high", matrix(&cells.high).as_ref(), &label("1", "upper ends of the cells", axes))?;
        let degree: Vec<Vec<f64>> = cells.degree.iter().map(|d| d.iter().map(|q| *q as f64).collect()).collect();
        save_dense(&group, "degree", matrix(&degree).as_ref(), &label("1", "polynomial degrees", axes))?;
    }
    if let Some((kept, left_out)) = &result.kept {
        let group = create_group(at, "kept")?;
        save_integers(&group, "germs", kept, &label("1", "numbers of the germs of the polynomials", &["germ"]))?;
        let meaning = "largest share of the other germs in the linear variance of a quantity";
        save_number(&group, "left_out", *left_out, "1", meaning)?;
    }
    if !result.levels.is_empty() {
        save_levels(&create_group(at, "levels")?, &result.levels)?;
    }
    let probabilities = label("1", "probabilities of the quantiles", &["probability"]);
    save_vector(at, "probabilities", &result.probabilities, &probabilities)?;
    let names: Vec<String> = result.quantities.iter().map(|q| q.name.clone()).collect();
    save_texts(at, "quantity_names", &names, "paths of the quantities in the JSON object", "quantity")?;
    let quantities = create_group(at, "quantities")?;
    for (k, quantity) in result.quantities.iter().enumerate() {
        save_quantity(&create_group(&quantities, &k.to_string())?, quantity)?;
    }
    let names: Vec<String> = result.fields.iter().map(|f| f.name.clone()).collect();
    save_texts(at, "field_names", &names, "random fields", "field")?;
    let fields = create_group(at, "fields")?;
    for (k, field) in result.fields.iter().enumerate() {
        let group = create_group(&fields, &k.to_string())?;
        let eigen = label("length^d", "eigenvalues of the covariance", &["mode"]);
        save_vector(&group, "eigenvalues", &field.eigenvalues, &eigen)?;
        save_number(&group, "captured", field.captured, "1", "share of the variance that is kept")?;
        if field.unresolved > 0.0 {
            save_number(&group, "unresolved", field.unresolved, "1", "share that means over cells cannot have")?;
        }
        let points = label("length", "arc length along the side, or points of the body", &["point", "component"]);
        save_dense(&group, "points", matrix(&field.points).as_ref(), &points)?;
        let modes = label("1", "square root of the eigenvalue times the mode", &["point", "mode"]);
        save_dense(&group, "modes", matrix(&field.modes).as_ref(), &modes)?;
    }
    Ok(())
}

fn save_moments(at: &Group, name: &str, unit: &str, meaning: &str, moments: &Moments) -> Result<(), IoError> {
    let group = create_group(at, name)?;
    save_vector(&group, "mean", &moments.mean, &label(unit, &format!("mean of the {meaning}"), &["entry"]))?;
    let squared = format!("{unit}^2");
    let meaning = format!("variance of the {meaning}");
    save_vector(&group, "variance", &moments.variance, &label(&squared, &meaning, &["entry"]))
}

fn save_quantity(at: &Group, q: &Quantity) -> Result<(), IoError> {
    save_vector(at, "values", &q.values, &label("of the quantity", "value at each point", &["point"]))?;
    let both = label("of the quantity", "mean and variance", &["moment"]);
    save_vector(at, "moments", &[q.mean, q.variance], &both)?;
    if let Some(error) = q.standard_error {
        save_number(at, "standard_error", error, "of the quantity", "standard error of the mean")?;
    }
    if let Some(error) = q.variance_error {
        save_number(at, "variance_error", error, "of the quantity, squared", "standard error of the variance")?;
    }
    if let Some(truncation) = q.truncation {
        save_number(at, "truncation", truncation, "of the quantity", "what polynomials leave out, root mean square")?;
    }
    if let Some(quantiles) = &q.quantiles {
        let meaning = label("of the quantity", "at the probabilities of the scene", &["probability"]);
        save_vector(at, "quantiles", quantiles, &meaning)?;
    }
    if let Some(bounds) = &q.bounds_left {
        let meaning = "values that the quantity cannot leave, and its mean does";
        save_vector(at, "bounds_left", bounds, &label("of the quantity", meaning, &["bound"]))?;
    }
    if let Some(density) = &q.density {
        save_vector(at, "bins", &density.edges, &label("of the quantity", "ends of the bins", &["end"]))?;
        save_vector(at, "density", &density.density, &label("1/quantity", "density of each bin", &["bin"]))?;
    }
    if let Some(effects) = &q.effects {
        let meaning = label("1", "total effect of each germ, as a share of the variance", &["germ"]);
        save_vector(at, "effects", effects, &meaning)?;
    }
    Ok(())
}

/// Reads what [`write()`] wrote.
///
/// # Errors
/// A file that is not one of this program's, truncated or altered.
pub fn read(at: &Group) -> Result<StochasticResult, IoError> {
    let counts = load_integers(at, "counts")?;
    let &[solved, iterations, unconverged, coupled] = &counts[..] else {
        return Err(invalid(at, "counts", "it does not have 4 numbers"));
    };
    let &[checks, overlooked] = &load_integers(at, "checks")?[..] else {
        return Err(invalid(at, "checks", "it does not have 2 numbers"));
    };
    let vectors = |group: &Group, name: &str| Ok::<_, IoError>(rows(&load_dense(group, name)?));
    let number = |group: &Group, name: &str| group.link_exists(name).then(|| load_number(group, name)).transpose();
    let (mut cells, mut truncation, mut truncation_measured, mut truncation_by_germ) = (None, None, None, Vec::new());
    if at.link_exists("mesh") {
        let group = open_group(at, "mesh")?;
        truncation = Some(load_number(&group, "truncation")?);
        truncation_measured = number(&group, "truncation_measured")?;
        truncation_by_germ = load_vector(&group, "truncation_by_germ")?;
        let degree = vectors(&group, "degree")?.iter().map(|d| d.iter().map(|q| *q as usize).collect()).collect();
        cells = Some(Cells { low: vectors(&group, "low")?, high: vectors(&group, "high")?, degree });
    }
    let mut quantities = Vec::new();
    for (k, name) in load_texts(at, "quantity_names")?.into_iter().enumerate() {
        quantities.push(load_quantity(&open_group(&open_group(at, "quantities")?, &k.to_string())?, name)?);
    }
    let mut fields = Vec::new();
    for (k, name) in load_texts(at, "field_names")?.into_iter().enumerate() {
        let group = open_group(&open_group(at, "fields")?, &k.to_string())?;
        fields.push(FieldModes {
            name,
            eigenvalues: load_vector(&group, "eigenvalues")?,
            captured: load_number(&group, "captured")?,
            unresolved: number(&group, "unresolved")?.unwrap_or(0.0),
            points: vectors(&group, "points")?,
            modes: vectors(&group, "modes")?,
        });
    }
    let word = load_texts(at, "reason")?;
    let end = End::ALL.into_iter().find(|e| word == [e.word()]);
    let result = StochasticResult {
        end: end.ok_or_else(|| invalid(at, "reason", "it is none of this program's words"))?,
        labels: load_texts(at, "germs")?,
        points: vectors(at, "points")?,
        weights: load_vector(at, "weights")?,
        young: load_vector(at, "young")?,
        probabilities: load_vector(at, "probabilities")?,
        quantities,
        displacement: load_moments(at, "displacement")?,
        stress_displacement: match at.link_exists("stress_displacement") {
            true => load_vector(at, "stress_displacement")?,
            false => Vec::new(),
        },
        kept: match at.link_exists("kept") {
            true => {
                let group = open_group(at, "kept")?;
                Some((load_integers(&group, "germs")?, load_number(&group, "left_out")?))
            }
            false => None,
        },
        levels: match at.link_exists("levels") {
            true => load_levels(&open_group(at, "levels")?)?,
            false => Vec::new(),
        },
        moduli: if at.link_exists("moduli") { vectors(at, "moduli")? } else { Vec::new() },
        in_body: at.link_exists("body").then(|| load_body(&open_group(at, "body")?)).transpose()?,
        pressure: load_moments(at, "pressure")?,
        shear: load_moments(at, "shear")?,
        probability: load_vector(at, "probability")?,
        displacements: if at.link_exists("displacements") { vectors(at, "displacements")? } else { Vec::new() },
        fields,
        cells,
        truncation,
        truncation_measured,
        // the estimator is in the JSON object
        estimator: None,
        truncation_by_germ,
        checks,
        overlooked: overlooked != 0,
        unseen: number(at, "unseen")?,
        coupled: coupled != 0,
        solved,
        iterations,
        unconverged,
        seconds: load_number(at, "seconds")?,
    };
    check(at, &result)?;
    Ok(result)
}

/// Whether the arrays fit each other.
fn check(at: &Group, result: &StochasticResult) -> Result<(), IoError> {
    let (points, germs) = (result.points.len(), result.labels.len());
    let demand = |holds: bool, name: &str, why: &str| if holds { Ok(()) } else { Err(invalid(at, name, why)) };
    let columns = |rows: &[Vec<f64>], width: usize| rows.iter().all(|row| row.len() == width);
    let weighted = result.weights.len() == points && result.young.len() == points;
    demand(weighted, "weights", "it does not have a number for each point")?;
    demand(columns(&result.points, germs), "points", "they do not have a number for each germ")?;
    let kept = &result.displacements;
    let fits = (kept.is_empty() || kept.len() == points) && columns(kept, result.displacement.mean.len());
    demand(fits, "displacements", "they are not one for each point and unknown")?;
    for q in &result.quantities {
        demand(q.values.len() == points, "quantities", "their values are not one for each point")?;
        let quantiles = q.quantiles.as_ref().is_none_or(|v| v.len() == result.probabilities.len());
        demand(quantiles, "quantities", "their quantiles are not one for each probability")?;
        let effects = q.effects.as_ref().is_none_or(|v| v.len() == germs);
        demand(effects, "quantities", "their effects are not one for each germ")?;
    }
    for field in &result.fields {
        let modes = field.modes.len() == field.points.len() && columns(&field.modes, field.eigenvalues.len());
        demand(modes, "fields", "their modes are not one for each point and eigenvalue")?;
        let width = field.points.first().map_or(0, Vec::len);
        demand((1..=2).contains(&width), "fields", "their points are neither of a side nor of the body")?;
    }
    if let Some(cells) = &result.cells {
        let count = cells.low.len();
        let degree = cells.degree.len() == count && cells.degree.iter().all(|d| d.len() == germs);
        let ends = cells.high.len() == count && columns(&cells.low, germs) && columns(&cells.high, germs);
        demand(degree && ends, "mesh", "its cells do not have ends and a degree for each germ")?;
    }
    let conditions = result.pressure.mean.len();
    let contact = result.shear.mean.len() == conditions && result.probability.len() == conditions;
    demand(contact, "probability", "it is not one for each contact node")
}

fn load_moments(at: &Group, name: &str) -> Result<Moments, IoError> {
    let group = open_group(at, name)?;
    let moments = Moments { mean: load_vector(&group, "mean")?, variance: load_vector(&group, "variance")? };
    if moments.mean.len() == moments.variance.len() {
        Ok(moments)
    } else {
        Err(invalid(&group, "variance", "means and variances differ in number"))
    }
}

fn save_levels(at: &Group, levels: &[Level]) -> Result<(), IoError> {
    let of = |value: &dyn Fn(&Level) -> f64| levels.iter().map(value).collect::<Vec<f64>>();
    let (cells, axis) = ("numbers of cells along x and y, from the coarsest grid on", &["level", "axis"]);
    let counts: Vec<Vec<f64>> = levels.iter().map(|l| l.cells.map(|n| n as f64).to_vec()).collect();
    save_dense(at, "cells", matrix(&counts).as_ref(), &label("1", cells, axis))?;
    let outcomes: Vec<usize> = levels.iter().map(|l| l.outcomes).collect();
    save_integers(at, "outcomes", &outcomes, &label("1", "outcomes of each level", &["level"]))?;
    let meaning = "cost of an outcome, as a part of a solution on the finest grid";
    save_vector(at, "cost", &of(&|l| l.cost), &label("1", meaning, &["level"]))?;
    let variances: Vec<Vec<f64>> = levels.iter().map(|l| l.variances.clone()).collect();
    let meaning = "variance of the difference from the coarser grid, of the first level that of the value";
    let axes = &["level", "quantity"];
    save_dense(at, "variance", matrix(&variances).as_ref(), &label("of the quantity, squared", meaning, axes))
}

fn load_levels(at: &Group) -> Result<Vec<Level>, IoError> {
    let (cells, variances) = (rows(&load_dense(at, "cells")?), rows(&load_dense(at, "variance")?));
    let (outcomes, cost) = (load_integers(at, "outcomes")?, load_vector(at, "cost")?);
    let lengths = [cells.len(), variances.len(), cost.len()];
    if lengths != [outcomes.len(); 3] || cells.iter().any(|c| c.len() != 2) {
        return Err(invalid(at, "outcomes", "its levels differ in number"));
    }
    let level = |l: usize| Level {
        cells: [0, 1].map(|k| cells[l][k] as usize),
        outcomes: outcomes[l],
        cost: cost[l],
        variances: variances[l].clone(),
    };
    Ok((0..outcomes.len()).map(level).collect())
}

fn load_body(at: &Group) -> Result<BodyMoments, IoError> {
    let of = |name: &str| load_moments(at, name);
    Ok(BodyMoments { displacement: of("displacement")?, stress: of("stress")?, young: of("young")? })
}

fn load_quantity(at: &Group, name: String) -> Result<Quantity, IoError> {
    let both = load_vector(at, "moments")?;
    let &[mean, variance] = &both[..] else { return Err(invalid(at, "moments", "it does not have 2 numbers")) };
    let optional = |name: &str| at.link_exists(name).then(|| load_vector(at, name)).transpose();
    let density = match (optional("bins")?, optional("density")?) {
        (Some(edges), Some(density)) if edges.len() == density.len() + 1 => Some(Histogram { edges, density }),
        (None, None) => None,
        _ => return Err(invalid(at, "bins", "they do not fit the density")),
    };
    Ok(Quantity {
        values: load_vector(at, "values")?,
        standard_error: at.link_exists("standard_error").then(|| load_number(at, "standard_error")).transpose()?,
        variance_error: at.link_exists("variance_error").then(|| load_number(at, "variance_error")).transpose()?,
        truncation: at.link_exists("truncation").then(|| load_number(at, "truncation")).transpose()?,
        quantiles: optional("quantiles")?,
        bounds_left: match optional("bounds_left")?.as_deref() {
            None => None,
            Some(&[low, high]) => Some([low, high]),
            Some(_) => return Err(invalid(at, "bounds_left", "it does not have 2 numbers")),
        },
        effects: optional("effects")?,
        name,
        mean,
        variance,
        density,
    })
}
