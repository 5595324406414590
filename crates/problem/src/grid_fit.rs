//! A polygon as a union of grid cells.

use steklov_bem_operators::{Edge, Location, Polygon};
use steklov_msfem::{Grid, MsfemError};

use super::cells::bounding_box;
use super::moduli::whole;
use super::{About, DataError, DataErrorKind as Kind, GridInput, Scene};

/// A corner this close to a grid point, in sides of the bounding box, is that point.
const ON_GRID: f64 = 1e-9;

/// The fine grid of a scene: coarse × fine equal rectangles over the bounding box of the body. A cell belongs to the body
/// if its centre does.
///
/// # Errors
/// A scene without `[grid]`; a grid that rounding errors leave without a cell in the body.
pub fn grid_of(scene: &Scene) -> Result<Grid, DataError> {
    let Some(input) = &scene.body().grid else { return Err(scene.grid_error()) };
    grid_over(&scene.problem.outline, input)
        .map_err(|e| DataError::at(Kind::Value, &[vec!["grid"]], e.to_string(), "take fewer cells"))
}

/// The fine grid over the bounding box of an outline.
pub(super) fn grid_over(outline: &Polygon, input: &GridInput) -> Result<Grid, MsfemError> {
    let (low, size) = bounding_box(outline);
    let cells = input.cells();
    let spacing = [0, 1].map(|k| size[k] / cells[k] as f64);
    let inside = |ix: usize, iy: usize| {
        let centre = [low[0] + spacing[0] * (ix as f64 + 0.5), low[1] + spacing[1] * (iy as f64 + 0.5)];
        outline.contains(centre) == Location::Inside
    };
    Grid::new(low, spacing, cells, inside)
}

/// The grid point next to a point, by its numbers along x and y, and whether it is that point.
fn nearest((low, size): ([f64; 2], [f64; 2]), cells: [usize; 2], point: [f64; 2]) -> ([f64; 2], bool) {
    let at = [0, 1].map(|k| (point[k] - low[k]) / size[k] * cells[k] as f64);
    let near = at.map(f64::round);
    (near, (0..2).all(|k| (at[k] - near[k]).abs() <= ON_GRID * cells[k] as f64))
}

/// Whether all corners are points of a grid, no two neighbours the same one.
fn fits(polygon: &Polygon, cells: [usize; 2]) -> bool {
    let bounds = bounding_box(polygon);
    polygon.edges().iter().all(|edge| {
        let ((a, on), (b, _)) = (nearest(bounds, cells, edge.start), nearest(bounds, cells, edge.end));
        on && a != b
    })
}

/// The edges of all loops with the keys of the corner at which each begins, as the scene lists them.
fn listed_edges(polygon: &Polygon) -> impl Iterator<Item = (Vec<Vec<String>>, &Edge)> {
    let key = |loop_index: usize, corner: usize| {
        let of_loop = match loop_index {
            0 => vec!["body".to_owned()],
            _ => vec!["body".to_owned(), "holes".to_owned(), (loop_index - 1).to_string()],
        };
        let of_corner = [&of_loop[..], &["corners".to_owned(), corner.to_string()]].concat();
        vec![of_corner, of_loop]
    };
    polygon.loops().iter().enumerate().flat_map(move |(l, range)| {
        polygon.edges()[range.clone()].iter().enumerate().map(move |(corner, edge)| (key(l, corner), edge))
    })
}

/// Checks that the edges of the body are parallel to the axes, as those of grid cells are.
///
/// # Errors
/// The first edge, as the scene lists them, that is not.
pub(super) fn check_edges(scene: &Scene) -> Result<(), DataError> {
    let polygon = &scene.problem.outline;
    let (_, size) = bounding_box(polygon);
    for (keys, edge) in listed_edges(polygon) {
        let [a, b] = edge.listed();
        let oblique = (0..2).all(|k| (b[k] - a[k]).abs() > ON_GRID * size[k]);
        let how = match (edge.is_line(), oblique) {
            (false, _) => "curved",
            (true, true) => "neither horizontal nor vertical",
            (true, false) => continue,
        };
        let message = format!(
            "the edge from ({}, {}) to ({}, {}) is {how}, and a grid of rectangles has none like it",
            a[0], a[1], b[0], b[1]
        );
        let help = format!("replace it by steps along the axes; or {}", without_grid(scene));
        return Err(DataError { kind: Kind::Geometry, message, help, about: About::Keys(keys) });
    }
    Ok(())
}

/// How a body in a medium is solved by boundary elements alone, whatever its outline, holes and affine force.
const AS_TWO_BODIES: &str = "write the body and the medium as two [[body]] tables, the medium with medium = {} and the outline \
                                        of the body as one of its [[body.holes]], and an [[interface]] with tied = true";

/// How boundary elements alone solve a body in a medium that is not made a body of its own.
pub(super) fn without_medium_around(scene: &Scene) -> &'static str {
    if force_varies(scene) {
        AFFINE
    } else if scene.problem.tie().is_some_and(|tie| tie.stress_jump.is_some()) {
        "write exterior.stress_jump as exterior.traction_jump"
    } else {
        AS_TWO_BODIES
    }
}

/// Which forces boundary elements take.
const AFFINE: &str = "give a body force that is affine in x and y, a + b*x + c*y";

fn force_varies(scene: &Scene) -> bool {
    scene.body().force.is_some() && scene.body().force_gradient().is_none()
}

/// How a body is solved without a grid.
pub(super) fn without_grid(scene: &Scene) -> String {
    let what = if scene.body().cells().is_some() {
        "give one Young's modulus, material.young"
    } else if force_varies(scene) {
        AFFINE
    } else if scene.problem.medium().is_some() {
        without_medium_around(scene)
    } else {
        "leave method.model at \"auto\""
    };
    format!("{what}, without [grid]: boundary elements take any outline")
}

/// Checks that the body is a union of cells: its edges are parallel to the axes, its corners points of the grid that
/// `name` names ("coarse", "fine").
///
/// # Errors
/// The first corner, as the scene lists them, at which it is not: with the nearest grid point and the spacing.
pub fn check_body(scene: &Scene, cells: [usize; 2], name: &str) -> Result<(), DataError> {
    check_edges(scene)?;
    let polygon = &scene.problem.outline;
    let (low, size) = bounding_box(polygon);
    for (keys, edge) in listed_edges(polygon) {
        let [a, b] = edge.listed();
        let [(near, on), (near_end, end_on)] = [a, b].map(|x| nearest((low, size), cells, x));
        if !on || near == near_end {
            // of two corners at one point of the grid the one that is off it
            let a = if on && !end_on { b } else { a };
            let spacing = [0, 1].map(|k| size[k] / cells[k] as f64);
            let point = [0, 1].map(|k| low[k] + size[k] * near[k] / cells[k] as f64);
            let message = format!(
                "the corner ({}, {}) is no point of the {name} grid: the nearest one is ({}, {}), the spacing is {} by {}",
                a[0], a[1], point[0], point[1], spacing[0], spacing[1]
            );
            let help = match fitting_grid(scene) {
                Some(grid) => format!("move the corner there, or change [grid], such as to {grid}"),
                None => {
                    "move the corner there: no [grid] of up to 1024 cells along each side has all corners".to_owned()
                }
            };
            return Err(DataError { kind: Kind::Geometry, message, help, about: About::Keys(keys) });
        }
    }
    Ok(())
}

/// Most cells along a side of a grid that is proposed.
const PROPOSED: usize = 1024;

/// An example of a `[grid]` for the body and its modulus cells, as text: coarse cells that are about square and have the
/// corners of the body among their points, 2 to 64 along the shorter side; else the fewest cells that have the corners.
pub(super) fn fitting_grid(scene: &Scene) -> Option<String> {
    let outline = &scene.problem.outline;
    let (low, size) = bounding_box(outline);
    let shorter = size[0].min(size[1]);
    // a long body is not cut into more cells along it
    let along = |n: usize| size.map(|side| (n as f64 * side / shorter).round().clamp(1.0, PROPOSED as f64) as usize);
    let on = |k: usize, n: usize| {
        let cells = size.map(|_| n);
        outline.edges().iter().all(|edge| {
            let mut corner = low;
            corner[k] = edge.start[k];
            nearest((low, size), cells, corner).1
        })
    };
    let fewest = |k: usize| (2..=PROPOSED).find(|&n| on(k, n));
    let either = || Some([fewest(0)?, fewest(1)?]).filter(|&cells| fits(outline, cells));
    let coarse = (2..=64).map(along).find(|&cells| fits(outline, cells)).or_else(either)?;
    let fine = [0, 1].map(|k| {
        let moduli = scene.body().cells().and_then(|cells| whole(size[k] / cells.size));
        moduli.map_or(8, |moduli| super::moduli::fitting_fine(moduli, coarse[k], 2))
    });
    Some(format!("[grid] coarse = [{}, {}], fine = [{}, {}]", coarse[0], coarse[1], fine[0], fine[1]))
}
