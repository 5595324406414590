//! The cuts through the body of a step, their elements and indicators.

use std::sync::Arc;

use steklov_bem_operators::{Cuts, Mark, Mesh, Piece};
use steklov_io::{Group, IoError, create_group, invalid, label, load_vector, open_group, save_dense, save_vector};
use steklov_model::estimate::error_estimate::Bubble;
use steklov_model::mesh::layout::MeshedCuts;
use steklov_problem::Scene;

use super::{BUBBLE_TERMS, load_table, save_table, whole};

const GROUP: &str = "cuts";

/// Writes the cuts of a step, if its body is cut, and the indicators of their elements.
pub(super) fn save(at: &Group, cuts: Option<&MeshedCuts>, indicators: &[Bubble]) -> Result<(), IoError> {
    let Some(MeshedCuts { cuts, elements }) = cuts else { return Ok(()) };
    let at = create_group(at, GROUP)?;
    let lines: Vec<[f64; 4]> = cuts.lines.iter().map(|[a, b]| [a[0], a[1], b[0], b[1]]).collect();
    let meaning = "lines along which the body is cut into subdomains";
    let table = faer::Mat::from_fn(lines.len(), 4, |i, j| lines[i][j]);
    save_dense(&at, "lines", table.as_ref(), &label("length", meaning, &["line", "x and y of both ends"]))?;
    let of_part = |(part, pieces): (usize, &Vec<Piece>)| {
        pieces.iter().map(|p| [part as f64, p.start, p.end, p.degree as f64]).collect::<Vec<_>>()
    };
    let rows: Vec<[f64; 4]> = elements.iter().enumerate().flat_map(of_part).collect();
    let meaning = "elements of the parts of these lines between boundary and lines";
    save_table(&at, "elements", &rows, meaning, &["element", "part, where it begins and ends along it, degree"])?;
    if indicators.is_empty() {
        return Ok(());
    }
    for (name, meaning, term) in BUBBLE_TERMS {
        let values: Vec<f64> = indicators.iter().map(term).collect();
        let axes = ["element of a cut"];
        save_vector(&at, name, &values, &label("force*length/thickness", meaning, &axes))?;
    }
    Ok(())
}

/// Reads the cuts of a step, if its body is cut, and the indicators of their elements.
///
/// # Errors
/// Cuts that are none of the scene's body, or elements that do not cover them.
pub(super) fn load(at: &Group, scene: &Scene) -> Result<(Option<MeshedCuts>, Vec<Bubble>), IoError> {
    if !at.link_exists(GROUP) {
        return Ok((None, Vec::new()));
    }
    let at = open_group(at, GROUP)?;
    let outline = &scene.problem.outline;
    if outline.bodies().len() != 1 || !outline.is_bounded() {
        return Err(invalid(&at, "lines", "the scene has not one bounded body"));
    }
    let lines: Vec<_> = load_table(&at, "lines")?.into_iter().map(|[a, b, c, d]| [[a, b], [c, d]]).collect();
    if lines.iter().flatten().flatten().any(|x| !x.is_finite()) {
        return Err(invalid(&at, "lines", "a number is not finite"));
    }
    let cuts = Cuts::new(outline, &lines).map_err(|e| invalid(&at, "lines", e))?;
    let mut elements = vec![Vec::new(); cuts.parts().len()];
    for [part, start, end, degree] in load_table(&at, "elements")? {
        let (number, degree) = (whole(&at, "elements", part)?, whole(&at, "elements", degree)?);
        let parts = elements.len();
        let pieces: &mut Vec<Piece> =
            elements.get_mut(number).ok_or_else(|| invalid(&at, "elements", format!("part {part} of {parts}")))?;
        let follows = pieces.last().map_or(0.0, |last| last.end) == start && start < end;
        if !follows || !(1..=Mesh::MAX_DEGREE).contains(&degree) {
            return Err(invalid(&at, "elements", format!("part {part}: [{start}, {end}] of degree {degree}")));
        }
        pieces.push(Piece { start, end, degree, mark: Mark::Keep });
    }
    if elements.iter().any(|pieces| pieces.last().is_none_or(|last| last.end != 1.0)) {
        return Err(invalid(&at, "elements", "they do not cover all parts from 0 to 1"));
    }
    let number = elements.iter().map(Vec::len).sum();
    let indicators = if at.link_exists(BUBBLE_TERMS[0].0) { indicators(&at, number)? } else { Vec::new() };
    Ok((Some(MeshedCuts { cuts: Arc::new(cuts), elements }), indicators))
}

/// The squared indicators of a number of elements, from their terms.
pub(super) fn indicators(at: &Group, elements: usize) -> Result<Vec<Bubble>, IoError> {
    let column = |name: &str| -> Result<Vec<f64>, IoError> {
        let values = load_vector(at, name)?;
        match values.len() {
            n if n == elements => Ok(values),
            n => Err(invalid(at, name, format!("{n} indicators of {elements} elements"))),
        }
    };
    let [u, t, g] = BUBBLE_TERMS.map(|(name, ..)| column(name));
    let (u, t, g) = (u?, t?, g?);
    Ok((0..elements).map(|e| Bubble { displacement: u[e], traction: t[e], oscillation: g[e] }).collect())
}
