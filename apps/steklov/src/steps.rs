//! The steps of a run in the result file, and back.

use steklov_bem_operators::BoundaryResidual;
use steklov_contact::{ContactResidual, Located, Tip, TipKind};
use steklov_io::{
    File, Group, IoError, Label, create_group, invalid, load, load_integers, load_number, load_texts, load_vector,
    open_group, save as save_as, save_integers, save_number, save_texts, save_vector,
};

use crate::estimate::{Bubble, Doubt, Estimate, Residual};
use crate::run::Step;

fn label<'a>(unit: &'a str, meaning: &'a str, axes: &'a [&'a str]) -> Label<'a> {
    Label { unit, meaning, axes }
}

/// A term of the indicators: name, meaning, value.
type Term<T> = (&'static str, &'static str, fn(&T) -> f64);
const RESIDUAL_TERMS: [Term<Residual>; 8] = [
    ("neumann", "h/(pE) |t - S u|^2 where t is prescribed", |r| r.boundary.neumann),
    ("equation", "hE/p |d/ds((K+1/2)u - V psi)|^2", |r| r.boundary.equation),
    ("contact", "h/(pE) |lambda + S u|^2", |r| r.contact.contact),
    ("complementarity", "pressure where the gap is open", |r| r.contact.complementarity),
    ("tension", "negative pressure", |r| r.contact.tension),
    ("penetration", "overlap", |r| r.contact.penetration),
    ("bound", "shear beyond the friction bound", |r| r.contact.bound),
    ("friction", "slip below the bound or against the shear", |r| r.contact.friction),
];
const BUBBLE_TERMS: [Term<Bubble>; 3] = [
    ("displacement", "eta_u squared of the displacement bubble", |b| b.displacement),
    ("traction", "eta_psi squared of the top traction", |b| b.traction),
    ("oscillation", "eta_g squared: data less their interpolants", |b| b.oscillation),
];

/// Writes a step into its group.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn save(at: &Group, step: &Step) -> Result<(), IoError> {
    save_as(at, "mesh", &step.mesh)?;
    save_integers(at, "dofs", &[step.dofs], &label("1", "displacement unknowns", &["value"]))?;
    save_number(at, "energy", step.energy, "force*length/thickness", "J")?;
    let history =
        label("1", "the contact solver's measure of the error before each iteration and at the end", &["iteration"]);
    save_vector(at, "history", &step.history, &history)?;
    let parts = label("seconds", "set-up, assembly, factorisation, solution, estimate", &["part"]);
    save_vector(at, "seconds", &step.seconds, &parts)?;
    save_number(at, "strain_energy", step.strain, "force*length/thickness", "half of a(u, u)")?;
    save_estimate(at, &step.estimate)?;
    save_tips(&create_group(at, "tips")?, &step.tips)?;
    save_transitions(&create_group(at, "transitions")?, &step.located)
}

const KINDS: &str = "0 end of contact, 1 end of stick, 2 reversal of slip";
const REGULAR: &str =
    "1 if the open or slipping side has the larger edge parameter, -1 if the smaller one, 0 for a reversal";

fn kind_number(kind: TipKind) -> usize {
    match kind {
        TipKind::ContactEnd => 0,
        TipKind::StickEnd => 1,
        TipKind::SlipReversal => 2,
    }
}

/// The vertices that follow transitions.
fn save_tips(at: &Group, tips: &[Tip]) -> Result<(), IoError> {
    let column = |f: fn(&Tip) -> usize| tips.iter().map(f).collect::<Vec<_>>();
    let axes = &["tip"];
    save_integers(at, "edge", &column(|t| t.edge), &label("1", "edge of the polygon", axes))?;
    save_integers(at, "kind", &column(|t| kind_number(t.kind)), &label("1", KINDS, axes))?;
    let places: Vec<f64> = tips.iter().map(|t| t.s).collect();
    save_vector(at, "s", &places, &label("1", "edge parameter of the vertex", axes))?;
    let regular: Vec<f64> = tips.iter().map(|t| f64::from(t.regular)).collect();
    save_vector(at, "regular", &regular, &label("1", REGULAR, axes))
}

/// Where transitions are believed to be.
fn save_transitions(at: &Group, located: &[Located]) -> Result<(), IoError> {
    let column = |f: fn(&Located) -> usize| located.iter().map(f).collect::<Vec<_>>();
    let numbers = |f: fn(&Located) -> f64| located.iter().map(f).collect::<Vec<_>>();
    let axes = &["transition"];
    save_integers(at, "edge", &column(|t| t.edge), &label("1", "edge of the polygon", axes))?;
    save_integers(at, "kind", &column(|t| kind_number(t.kind)), &label("1", KINDS, axes))?;
    let vertex = label("1", "1 if the mesh has a vertex for it", axes);
    save_integers(at, "at_vertex", &column(|t| usize::from(t.at_vertex)), &vertex)?;
    save_vector(at, "s", &numbers(|t| t.s), &label("1", "edge parameter", axes))?;
    let off = "how far that is from its vertex, or half of its bracket (edge parameter)";
    save_vector(at, "off", &numbers(|t| t.off), &label("1", off, axes))?;
    let curvature = "B of the gap or slip B d^(3/2), d in edge parameters; -1 where it was not fitted";
    save_vector(at, "curvature", &numbers(|t| t.curvature.unwrap_or(-1.0)), &label("length", curvature, axes))
}

fn save_estimate(at: &Group, estimate: &Estimate) -> Result<(), IoError> {
    let energy = "force*length/thickness";
    save_number(at, "estimate", estimate.error, "(force*length/thickness)^(1/2)", "estimated error, energy norm")?;
    save_number(at, "estimate_relative", estimate.relative, "1", "estimate over (2 strain energy)^(1/2)")?;
    save_number(at, "energy_extrapolated", estimate.energy, energy, "J of the spaces of one degree more")?;
    let meaning = "how far the exact J may be from the extrapolated one";
    save_number(at, "energy_uncertainty", estimate.uncertainty, energy, meaning)?;
    save_number(at, "correction", estimate.correction, energy, "energy of what the spaces of one degree more add")?;
    save_number(at, "tip_energy", estimate.tips, energy, "what the vertices miss of transitions of contact and stick")?;
    save_number(at, "scale", estimate.scale, "(force*length/thickness)^(1/2)", "(2 strain energy)^(1/2)")?;
    let doubts: Vec<String> = estimate.doubts.iter().map(|d| d.word().to_owned()).collect();
    save_texts(at, "doubts", &doubts, "why the estimate is not reliable", "doubt")?;
    let indicators = create_group(at, "indicators")?;
    for (name, meaning, term) in BUBBLE_TERMS {
        let values: Vec<f64> = estimate.indicators.iter().map(term).collect();
        save_vector(&indicators, name, &values, &label(energy, meaning, &["element"]))?;
    }
    if !estimate.residuals.is_empty() {
        for (name, meaning, term) in RESIDUAL_TERMS {
            let values: Vec<f64> = estimate.residuals.iter().map(term).collect();
            save_vector(&indicators, name, &values, &label(energy, meaning, &["element"]))?;
        }
    }
    Ok(())
}

/// Reads all steps of a result file.
///
/// # Errors
/// A file that is not one of this program's, truncated or altered.
pub(crate) fn load_all(file: &File) -> Result<Vec<Step>, IoError> {
    let steps = open_group(file, "steps")?;
    let mut names = steps.member_names().map_err(|e| invalid(&steps, "steps", e.to_string()))?;
    // 999 comes before 1000
    names.sort_by_key(|name| (name.len(), name.clone()));
    names.iter().map(|name| load_step(&open_group(&steps, name)?)).collect()
}

fn load_step(at: &Group) -> Result<Step, IoError> {
    let seconds = load_vector(at, "seconds")?;
    let dofs = load_integers(at, "dofs")?;
    let ([dofs], Ok(seconds)) = (dofs.as_slice(), <[f64; 5]>::try_from(seconds.as_slice())) else {
        return Err(invalid(at, "seconds", "one number of dofs and five of seconds belong here"));
    };
    let mesh: steklov_bem_operators::Mesh = load(at, "mesh")?;
    let estimate = load_estimate(at, mesh.len())?;
    Ok(Step {
        dofs: *dofs,
        energy: load_number(at, "energy")?,
        strain: load_number(at, "strain_energy")?,
        // a run never goes on from a step that did not converge
        converged: true,
        history: load_vector(at, "history")?,
        estimate,
        tips: load_tips(&open_group(at, "tips")?)?,
        located: load_transitions(&open_group(at, "transitions")?)?,
        seconds,
        mesh,
    })
}

fn load_estimate(at: &Group, elements: usize) -> Result<Estimate, IoError> {
    let group = open_group(at, "indicators")?;
    let column = |name: &str| -> Result<Vec<f64>, IoError> {
        let values = load_vector(&group, name)?;
        match values.len() {
            n if n == elements => Ok(values),
            n => Err(invalid(&group, name, format!("{n} indicators of {elements} elements"))),
        }
    };
    let [u, t, g] = BUBBLE_TERMS.map(|(name, ..)| column(name));
    let (u, t, g) = (u?, t?, g?);
    let indicators = (0..elements).map(|e| Bubble { displacement: u[e], traction: t[e], oscillation: g[e] }).collect();
    let residuals = if group.link_exists(RESIDUAL_TERMS[0].0) {
        let columns = RESIDUAL_TERMS.map(|(name, ..)| column(name));
        let mut terms = Vec::new();
        for column in columns {
            terms.push(column?);
        }
        let residual = |e: usize| Residual {
            boundary: BoundaryResidual { neumann: terms[0][e], equation: terms[1][e] },
            contact: ContactResidual {
                element: e,
                contact: terms[2][e],
                complementarity: terms[3][e],
                tension: terms[4][e],
                penetration: terms[5][e],
                bound: terms[6][e],
                friction: terms[7][e],
            },
        };
        (0..elements).map(residual).collect()
    } else {
        Vec::new()
    };
    let doubts = load_texts(at, "doubts")?.into_iter().map(|word| {
        let all = [Doubt::Transition, Doubt::Sets, Doubt::Roundoff];
        all.into_iter()
            .find(|d| d.word() == word)
            .ok_or_else(|| invalid(at, "doubts", format!("unknown doubt {word:?}")))
    });
    Ok(Estimate {
        indicators,
        residuals,
        correction: load_number(at, "correction")?,
        tips: load_number(at, "tip_energy")?,
        error: load_number(at, "estimate")?,
        relative: load_number(at, "estimate_relative")?,
        scale: load_number(at, "scale")?,
        energy: load_number(at, "energy_extrapolated")?,
        uncertainty: load_number(at, "energy_uncertainty")?,
        doubts: doubts.collect::<Result<_, _>>()?,
    })
}

fn kind(at: &Group, number: usize) -> Result<TipKind, IoError> {
    match number {
        0 => Ok(TipKind::ContactEnd),
        1 => Ok(TipKind::StickEnd),
        2 => Ok(TipKind::SlipReversal),
        _ => Err(invalid(at, "kind", format!("unknown kind {number}"))),
    }
}

fn load_tips(at: &Group) -> Result<Vec<Tip>, IoError> {
    let (edge, kinds, s) = (load_integers(at, "edge")?, load_integers(at, "kind")?, load_vector(at, "s")?);
    let regular = load_vector(at, "regular")?;
    if [kinds.len(), s.len(), regular.len()] != [edge.len(); 3] {
        return Err(invalid(at, "s", "the columns differ in length"));
    }
    let tip = |i: usize| Ok(Tip { edge: edge[i], s: s[i], kind: kind(at, kinds[i])?, regular: regular[i] as i8 });
    (0..edge.len()).map(tip).collect()
}

fn load_transitions(at: &Group) -> Result<Vec<Located>, IoError> {
    let (edge, kinds) = (load_integers(at, "edge")?, load_integers(at, "kind")?);
    let (vertex, s) = (load_integers(at, "at_vertex")?, load_vector(at, "s")?);
    let (off, curvature) = (load_vector(at, "off")?, load_vector(at, "curvature")?);
    if [kinds.len(), vertex.len(), s.len(), off.len(), curvature.len()] != [edge.len(); 5] {
        return Err(invalid(at, "s", "the columns differ in length"));
    }
    let transition = |i: usize| {
        Ok(Located {
            edge: edge[i],
            s: s[i],
            kind: kind(at, kinds[i])?,
            off: off[i],
            curvature: (curvature[i] >= 0.0).then_some(curvature[i]),
            at_vertex: vertex[i] == 1,
        })
    };
    (0..edge.len()).map(transition).collect()
}
