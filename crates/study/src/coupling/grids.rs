//! The pairs of materials and the grids of the study.

use steklov_coupling::Outline;
use steklov_elastic::{Material, Plane};
use steklov_msfem::Grid;
use steklov_problem::{DataError, DataErrorKind, GridInput, Method, Scene, check_body, grid_of, moduli};

use super::manufactured::Pair;
use crate::settings::Setting;

/// Smallest number of cells of a grid along the shorter side of the body.
pub(super) const FEWEST: usize = 4;

/// Largest number of unknowns of a body, if the scene sets no other limit.
const MOST_DOFS: usize = 100_000;

/// Largest numbers of unknowns on the boundary of grids: for errors, for eigenvalues, for indicators, for costs.
const TRACE: [usize; 4] = [1100, 560, 280, usize::MAX];

/// Three pairs that every study has: E and ν of the body and of the medium, plane strain.
const GIVEN: [(&str, [f64; 2], [f64; 2]); 3] = [
    ("same (2, 0.3 | 2, 0.3)", [2.0, 0.3], [2.0, 0.3]),
    ("stiff (20, 0.25 | 2, 0.3)", [20.0, 0.25], [2.0, 0.3]),
    ("soft (1, 0.35 | 50, 0.2)", [1.0, 0.35], [50.0, 0.2]),
];

/// Three given pairs and the scene's own, the last one; a body with many moduli has their mean.
///
/// # Errors
/// A scene without a grid or without a body in a medium; moduli that cannot be read.
pub fn pairs(scene: &Scene) -> Result<Vec<Pair>, DataError> {
    let medium = match scene.surroundings() {
        Some(around) => around.material,
        None => {
            let message =
                "the study is about a body in an unbounded medium, and the scene does not have both".to_owned();
            let help = "add a table [exterior] with young and poisson, and a [material] of the body";
            return Err(DataError::at(DataErrorKind::Unsupported, &[vec!["exterior"], vec!["body"]], message, help));
        }
    };
    let grid = grid_of(scene)?;
    let young = moduli(scene, &grid)?;
    let (sum, count) = grid.body_cells().fold((0.0, 0.0), |(sum, count), cell| (sum + young[cell], count + 1.0));
    let body = Material { young: sum / count, ..scene.body().material() };
    let material = |[young, poisson]: [f64; 2]| Material { young, poisson, plane: Plane::Strain };
    let given = GIVEN.map(|(name, body, medium)| Pair {
        name: name.to_owned(),
        body: material(body),
        medium: material(medium),
        force: [8.0, 5.0],
    });
    let name =
        format!("scene ({}, {} | {}, {})", rounded(body.young), body.poisson, rounded(medium.young), medium.poisson);
    // the strains are as large as in the body
    let own = Pair { name, body, medium, force: [4.0 * medium.young, 2.5 * medium.young] };
    Ok(given.into_iter().chain([own]).collect())
}

/// A modulus as part of a name.
fn rounded(young: f64) -> String {
    steklov_picture::short(young, 3)
}

/// The coarsest grid of the body: the scene's fine cells, joined two by two along x and y as long as the body consists
/// of such cells and has at least four of them along its shorter side.
///
/// # Errors
/// As [`grid_of`].
pub fn coarsest(scene: &Scene) -> Result<[usize; 2], DataError> {
    let mut cells = grid_of(scene)?.cells;
    loop {
        let half = cells.map(|n| n / 2);
        let whole = cells.iter().all(|n| n.is_multiple_of(2)) && half[0].min(half[1]) >= FEWEST;
        if !whole || check_body(scene, half, "coarse").is_err() {
            return Ok(cells);
        }
        cells = half;
    }
}

/// The largest whole multiple of the coarsest grid that has at most `most_dofs` unknowns, counted on the whole bounding
/// box; None unless it has more than `dofs`.
///
/// # Errors
/// As [`grid_of`].
pub fn largest(scene: &Scene, most_dofs: usize, dofs: usize) -> Result<Option<Level>, DataError> {
    let first = coarsest(scene)?;
    let unknowns = |times: usize| 2 * (first[0] * times + 1) * (first[1] * times + 1);
    let times = (1..).take_while(|&times| unknowns(times) <= most_dofs).last();
    let found = times.map(|times| level(scene, first.map(|n| n * times))).transpose()?;
    Ok(found.filter(|level| level.grid.dofs() > dofs))
}

/// The settings of the study: a limit of unknowns, if neither the scene nor the user sets another. `method` is the
/// method of the scene, overrides included.
pub fn settings(method: &Method) -> Vec<Setting> {
    if method.max_dofs.is_some() { Vec::new() } else { vec![Setting::MaxDofs(MOST_DOFS)] }
}

/// The grids for errors, for eigenvalues, for indicators: [`levels`] with no more unknowns than the scene allows, and few on
/// the boundary; then those for costs, with any number on the boundary, and the [`largest`] one.
///
/// # Errors
/// As [`levels`].
pub fn grids(scene: &Scene) -> Result<[Vec<Level>; 4], DataError> {
    let most = scene.method.max_dofs();
    let [fine, middle, coarse, all] = TRACE.map(|trace| levels(scene, most, trace));
    let (fine, middle, coarse, mut all) = (fine?, middle?, coarse?, all?);
    let dofs = all.last().map_or(0, |level| level.grid.dofs());
    all.extend(largest(scene, most, dofs)?);
    Ok([fine, middle, coarse, all])
}

/// A grid of the body of the study.
#[derive(Debug, Clone)]
pub struct Level {
    /// The cells.
    pub grid: Grid,
    /// Displacement unknowns on the outer boundary.
    pub trace: usize,
}

/// The coarsest grid and those with 2, 4, 8 ... times as many cells along x and y, with at most `most_dofs` unknowns in
/// the body and `most_trace` on its boundary.
///
/// # Errors
/// A body that fits no such grid, or whose coarsest grid has more unknowns.
pub fn levels(scene: &Scene, most_dofs: usize, most_trace: usize) -> Result<Vec<Level>, DataError> {
    let first = coarsest(scene)?;
    let mut levels = Vec::new();
    for times in (0..12).map(|k| 1 << k) {
        let level = level(scene, first.map(|n| n * times))?;
        if level.grid.dofs() > most_dofs || level.trace > most_trace {
            break;
        }
        levels.push(level);
    }
    if levels.is_empty() {
        let message = format!(
            "the coarsest grid of the study has {} by {} cells, more than {most_dofs} dofs or {most_trace} on the boundary",
            first[0], first[1]
        );
        let help = "raise method.max_dofs, or take numbers of cells that can be halved: grid.coarse = [4, 4], grid.fine = [8, 8]";
        return Err(DataError::at(DataErrorKind::Value, &[vec!["grid", "fine"]], message, help));
    }
    Ok(levels)
}

/// The grid of the body with these cells.
///
/// # Errors
/// As [`grid_of`], and a body whose outer boundary is not one curve.
pub fn level(scene: &Scene, cells: [usize; 2]) -> Result<Level, DataError> {
    let mut scene = scene.clone();
    scene.body_mut().grid = scene.body().grid.map(|grid| GridInput { coarse: cells, fine: [1, 1], ..grid });
    let grid = grid_of(&scene)?;
    let outline = Outline::new(&grid).map_err(|error| {
        let help = "the medium meets one closed curve: part the body, or join its pieces by more than a point";
        DataError::at(DataErrorKind::Geometry, &[vec!["body"]], error.to_string(), help)
    })?;
    Ok(Level { grid, trace: 2 * outline.nodes.len() })
}

/// Ends of a side of a cell, counter-clockwise, and its normal out of the cell.
pub(super) fn sides(grid: &Grid, cell: usize, side: usize) -> ([[f64; 2]; 2], [f64; 2]) {
    let nodes = grid.cell_nodes(cell);
    let ends = [side, (side + 1) % 4].map(|k| grid.point(nodes[k]));
    (ends, [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]][side])
}
