//! The steps of a run in the result file, and back.

mod check;
mod cuts;

use faer::Mat;
use steklov_bem_operators::Mesh;
use steklov_contact::{Located, Tip, TipKind};
use steklov_io::{
    File, Group, IoError, create_group, invalid, label, load, load_dense, load_integers, load_number, load_points,
    load_texts, load_vector, open_group, save as save_as, save_dense, save_integers, save_number, save_points,
    save_texts, save_vector,
};
use steklov_model::doubt::Doubt;
use steklov_model::estimate::error_estimate::{Bubble, Estimate};
use steklov_model::estimate::residual::Residual;
use steklov_model::estimators::ON_BOUNDARY;
use steklov_model::quantities::EstimatedQuantity;
use steklov_model::run::adaptive_loop::Step;
use steklov_model::run::boundary_elements::{BoundaryElements, RefinedMesh};
use steklov_problem::Scene;

/// A term of the indicators: name, meaning, value.
type Term<T> = (&'static str, &'static str, fn(&T) -> f64);
const BUBBLE_TERMS: [Term<Bubble>; 3] = [
    ("displacement", "eta_u squared of the displacement bubble", |b| b.displacement),
    ("traction", "eta_psi squared of the top traction", |b| b.traction),
    ("oscillation", "eta_g squared: data less their interpolants", |b| b.oscillation),
];

/// Writes a step into its group.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn save(at: &Group, step: &Step<BoundaryElements>) -> Result<(), IoError> {
    save_as(at, "mesh", &step.layout.mesh)?;
    save_integers(at, "dofs", &[step.dofs], &label("1", "displacement unknowns", &["value"]))?;
    save_number(at, "energy", step.energy, "force*length/thickness", "J")?;
    let history =
        label("1", "the contact solver's measure of the error before each iteration and at the end", &["iteration"]);
    save_vector(at, "history", &step.history, &history)?;
    let parts = label("seconds", "set-up, assembly, factorisation, solution, estimate", &["part"]);
    save_vector(at, "seconds", &step.seconds, &parts)?;
    save_number(at, "strain_energy", step.strain, "force*length/thickness", "half of a(u, u)")?;
    if let Some(estimate) = &step.estimate {
        save_estimate(at, estimate)?;
    }
    let of_cuts = step.estimate.as_ref().map_or(&[][..], |estimate| &estimate.of_cuts);
    cuts::save(at, step.layout.cuts.as_ref(), of_cuts)?;
    save_tips(at, &step.layout.tips)?;
    save_transitions(at, &step.layout.located)
}

fn kind_number(kind: TipKind) -> usize {
    match kind {
        TipKind::ContactEnd => 0,
        TipKind::StickEnd => 1,
        TipKind::SlipReversal => 2,
    }
}

/// The vertices that follow transitions.
fn save_tips(at: &Group, tips: &[Tip]) -> Result<(), IoError> {
    let rows: Vec<_> =
        tips.iter().map(|t| [t.edge as f64, kind_number(t.kind) as f64, t.s, f64::from(t.regular)]).collect();
    let meaning = "vertices that follow transitions; kind: 0 end of contact, 1 end of stick, 2 reversal of slip; regular: \
                   1 if the open or slipping side has the larger edge parameter, -1 if the smaller one, 0 for a reversal";
    let columns = "edge of the polygon, kind, edge parameter, regular";
    save_table(at, "tips", &rows, meaning, &["tip", columns])
}

/// The located transitions.
fn save_transitions(at: &Group, located: &[Located]) -> Result<(), IoError> {
    let row = |t: &Located| {
        let (edge, kind, curvature) = (t.edge as f64, kind_number(t.kind) as f64, t.curvature.unwrap_or(-1.0));
        [edge, kind, t.s, t.off, curvature, f64::from(u8::from(t.at_vertex))]
    };
    let rows: Vec<_> = located.iter().map(row).collect();
    let meaning = "transitions of contact and stick; kind: 0 end of contact, 1 end of stick, 2 reversal of slip; off: how \
                   far from its vertex, or half of its bracket (edge parameter); curvature: B (length) of the gap or slip \
                   B d^(3/2), d in edge parameters, -1 where it was not fitted; vertex: 1 if the mesh has one for it";
    let columns = "edge of the polygon, kind, edge parameter, off, curvature, vertex";
    save_table(at, "transitions", &rows, meaning, &["transition", columns])
}

fn save_table<const M: usize>(
    at: &Group,
    name: &str,
    rows: &[[f64; M]],
    meaning: &str,
    axes: &[&str],
) -> Result<(), IoError> {
    let table = Mat::from_fn(rows.len(), M, |i, j| rows[i][j]);
    save_dense(at, name, table.as_ref(), &label("1", meaning, axes))
}

const ESTIMATE_TERMS: &str = "estimate over (2 strain energy)^(1/2), that scale ((force*length/thickness)^(1/2)), energy that the spaces of \
                              one degree more add, energy that vertices miss of transitions, J extrapolated, its uncertainty";

fn save_estimate(at: &Group, estimate: &Estimate) -> Result<(), IoError> {
    let energy = "force*length/thickness";
    save_number(at, "estimate", estimate.error, "(force*length/thickness)^(1/2)", "estimated error, energy norm")?;
    let terms =
        [estimate.relative, estimate.scale, estimate.correction, estimate.tips, estimate.energy, estimate.uncertainty];
    save_vector(at, "estimate_terms", &terms, &label("as named", "what belongs to the estimate", &[ESTIMATE_TERMS]))?;
    let doubts: Vec<String> = estimate.doubts.iter().map(|d| d.word().to_owned()).collect();
    save_texts(at, "doubts", &doubts, "why the estimate is not reliable", "doubt")?;
    if !estimate.quantities.is_empty() {
        let meaning = "values of quantities, and those of the spaces of one degree more";
        let pairs: Vec<[f64; 2]> = estimate.quantities.iter().map(|q| [q.value, q.enriched]).collect();
        save_points(at, "quantities", &pairs, &label("as each", meaning, &["quantity", "space"]))?;
        let meaning = "sums of the absolute dual weighted residuals of the elements, and what ends of contact add that are not at their \
                       vertices; NaN where there is no dual problem";
        let weighted: Vec<[f64; 2]> = estimate.quantities.iter().map(|q| q.weighted.unwrap_or([f64::NAN; 2])).collect();
        save_points(at, "quantities_weighted", &weighted, &label("as each", meaning, &["quantity", "part"]))?;
    }
    let indicators = create_group(at, "indicators")?;
    for (name, meaning, term) in BUBBLE_TERMS {
        let values: Vec<f64> = estimate.indicators.iter().map(term).collect();
        save_vector(&indicators, name, &values, &label(energy, meaning, &["element"]))?;
    }
    if !estimate.residuals.is_empty() {
        for (k, (name, meaning)) in ON_BOUNDARY.into_iter().enumerate() {
            let values: Vec<f64> = estimate.residuals.iter().map(|residual| residual.terms()[k]).collect();
            save_vector(&indicators, name, &values, &label(energy, meaning, &["element"]))?;
        }
    }
    Ok(())
}

/// Name of a step's group.
pub(crate) fn name(number: usize) -> String {
    format!("{number:03}")
}

/// Reads all steps of a result file, at least one, and checks that they are steps of this scene.
///
/// # Errors
/// A file that is not one of this program's, truncated or altered, or of another scene.
pub(crate) fn load_all(file: &File, scene: &Scene) -> Result<Vec<Step<BoundaryElements>>, IoError> {
    let groups = groups(file)?;
    let load = |at: &Group| {
        let step = load_step(at, scene)?;
        check::check(at, &step, scene)?;
        Ok(step)
    };
    groups.iter().map(load).collect()
}

/// The groups of all steps, at least one, in their order.
///
/// # Errors
/// A file without steps, or whose steps are not 0, 1, 2, ...
pub(crate) fn groups(file: &File) -> Result<Vec<Group>, IoError> {
    let steps = open_group(file, "steps")?;
    let mut names = steps.member_names().map_err(|e| invalid(&steps, "", e.to_string()))?;
    // 999 comes before 1000
    names.sort_by_key(|name| (name.len(), name.clone()));
    if let Some((number, found)) = names.iter().enumerate().find(|(number, found)| **found != name(*number)) {
        return Err(invalid(&steps, "", format!("{found:?} is where step {:?} should be", name(number))));
    }
    if names.is_empty() {
        return Err(invalid(&steps, "", "there is no step"));
    }
    names.iter().map(|name| open_group(&steps, name)).collect()
}

/// The number of displacement unknowns and the mesh of each step; no entry on a grid.
///
/// # Errors
/// A file without steps, or whose steps are not 0, 1, 2, ...
pub fn meshes(file: &File) -> Result<Vec<(usize, Mesh)>, IoError> {
    let load = |at: &Group| {
        let dofs = load_integers(at, "dofs")?;
        let [dofs] = dofs.as_slice() else { return Err(invalid(at, "dofs", "one number belongs here")) };
        Ok((*dofs, load(at, "mesh")?))
    };
    groups(file)?.iter().filter(|at| at.link_exists("mesh")).map(load).collect()
}

fn load_step(at: &Group, scene: &Scene) -> Result<Step<BoundaryElements>, IoError> {
    let seconds = load_vector(at, "seconds")?;
    let dofs = load_integers(at, "dofs")?;
    let ([dofs], Ok(seconds)) = (dofs.as_slice(), <[f64; 5]>::try_from(seconds.as_slice())) else {
        return Err(invalid(at, "seconds", "one number of dofs and five of seconds belong here"));
    };
    let mesh: Mesh = load(at, "mesh")?;
    let (cuts, of_cuts) = cuts::load(at, scene)?;
    let estimate = if at.link_exists("estimate") { Some(load_estimate(at, mesh.len(), of_cuts)?) } else { None };
    Ok(Step {
        dofs: *dofs,
        energy: load_number(at, "energy")?,
        strain: load_number(at, "strain_energy")?,
        // a run never goes on from a step that did not converge
        converged: true,
        history: load_vector(at, "history")?,
        estimate,
        layout: RefinedMesh { mesh, tips: load_tips(at)?, located: load_transitions(at)?, cuts },
        seconds,
    })
}

fn load_estimate(at: &Group, elements: usize, of_cuts: Vec<Bubble>) -> Result<Estimate, IoError> {
    let group = open_group(at, "indicators")?;
    let column = |name: &str| -> Result<Vec<f64>, IoError> {
        let values = load_vector(&group, name)?;
        match values.len() {
            n if n == elements => Ok(values),
            n => Err(invalid(&group, name, format!("{n} indicators of {elements} elements"))),
        }
    };
    let indicators = cuts::indicators(&group, elements)?;
    let residuals = if group.link_exists(ON_BOUNDARY[0].0) {
        let mut columns = Vec::new();
        for (name, _) in ON_BOUNDARY {
            // older files have no term of held displacements
            columns.push(if group.link_exists(name) { column(name)? } else { vec![0.0; elements] });
        }
        (0..elements).map(|e| Residual::of_terms(e, [0, 1, 2, 3, 4, 5, 6, 7, 8, 9].map(|k| columns[k][e]))).collect()
    } else {
        Vec::new()
    };
    let terms = load_vector(at, "estimate_terms")?;
    let &[relative, scale, correction, tips, energy, uncertainty] = terms.as_slice() else {
        return Err(invalid(at, "estimate_terms", format!("{} numbers, not 6", terms.len())));
    };
    let doubts = load_texts(at, "doubts")?
        .into_iter()
        .map(|word| Doubt::of_word(&word).ok_or_else(|| invalid(at, "doubts", format!("unknown doubt {word:?}"))));
    Ok(Estimate {
        indicators,
        of_cuts,
        residuals,
        correction,
        tips,
        error: load_number(at, "estimate")?,
        relative,
        scale,
        energy,
        uncertainty,
        doubts: doubts.collect::<Result<_, _>>()?,
        quantities: load_quantities(at)?,
    })
}

/// The quantities of a step; older files have none, or none with dual weighted residuals.
fn load_quantities(at: &Group) -> Result<Vec<EstimatedQuantity>, IoError> {
    if !at.link_exists("quantities") {
        return Ok(Vec::new());
    }
    let pairs: Vec<[f64; 2]> = load_points(at, "quantities")?;
    let name = "quantities_weighted";
    let weighted = if at.link_exists(name) { load_points(at, name)? } else { vec![[f64::NAN; 2]; pairs.len()] };
    if weighted.len() != pairs.len() {
        return Err(invalid(at, name, format!("{} sums of {} quantities", weighted.len(), pairs.len())));
    }
    let of = |([value, enriched], weighted): ([f64; 2], [f64; 2])| EstimatedQuantity {
        value,
        enriched,
        weighted: Some(weighted).filter(|[sum, _]| sum.is_finite()),
    };
    Ok(pairs.into_iter().zip(weighted).map(of).collect())
}

/// A whole number, not negative.
fn whole(at: &Group, name: &str, number: f64) -> Result<usize, IoError> {
    let whole = number as usize; // NaN becomes 0, and large numbers become the largest usize
    if whole as f64 == number { Ok(whole) } else { Err(invalid(at, name, format!("{number} is no edge"))) }
}

fn kind(at: &Group, name: &str, number: f64) -> Result<TipKind, IoError> {
    let kinds = [TipKind::ContactEnd, TipKind::StickEnd, TipKind::SlipReversal];
    let found = kinds.into_iter().find(|k| kind_number(*k) as f64 == number);
    found.ok_or_else(|| invalid(at, name, format!("unknown kind {number}")))
}

/// The rows of a table of M columns.
fn load_table<const M: usize>(at: &Group, name: &str) -> Result<Vec<[f64; M]>, IoError> {
    let table = load_dense(at, name)?;
    if table.ncols() != M {
        return Err(invalid(at, name, format!("{} columns, not {M}", table.ncols())));
    }
    Ok((0..table.nrows()).map(|i| std::array::from_fn(|j| table[(i, j)])).collect())
}

fn load_tips(at: &Group) -> Result<Vec<Tip>, IoError> {
    let tip = |[edge, number, s, regular]: [f64; 4]| {
        let direction = [-1, 0, 1].into_iter().find(|d| f64::from(*d) == regular);
        let regular = direction.ok_or_else(|| invalid(at, "tips", format!("regular is {regular}, not -1, 0 or 1")))?;
        Ok(Tip { edge: whole(at, "tips", edge)?, s, kind: kind(at, "tips", number)?, regular })
    };
    load_table(at, "tips")?.into_iter().map(tip).collect()
}

fn load_transitions(at: &Group) -> Result<Vec<Located>, IoError> {
    let transition = |[edge, number, s, off, curvature, vertex]: [f64; 6]| {
        Ok(Located {
            edge: whole(at, "transitions", edge)?,
            s,
            kind: kind(at, "transitions", number)?,
            off,
            curvature: (curvature >= 0.0).then_some(curvature),
            at_vertex: vertex == 1.0,
        })
    };
    load_table(at, "transitions")?.into_iter().map(transition).collect()
}
