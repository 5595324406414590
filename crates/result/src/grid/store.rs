//! Grids in the result file, and back.

use faer::Mat;
use steklov_io::{
    File, Group, IoError, create_group, invalid, label, load, load_dense, load_integers, load_number, load_points,
    load_vector, open_group, save, save_dense, save_integers, save_number, save_points, save_vector, vtkhdf,
};
use steklov_model::estimators::IN_COARSE_CELLS;
use steklov_model::grid::{GridEstimate, GridLayout, OnGrid};
use steklov_model::run::adaptive_loop::Step;
use steklov_msfem::{CoarseCell, CoarseMesh, CrossingContrast, Grid, HeterogeneousBody, Indicators};

use super::record::GridRecord;

/// Boundary elements of the medium around the body.
const AROUND: &str = "boundary_elements";
/// Residuals of the equations between body and medium.
const INTERFACE: &str = "interface";
const IN_CELLS: &str = "cell_residuals";
const JUMP: &str = "interface_jump";
const COARSE: &str = "first fine cell along x and y, fine cells along x and y";

fn save_cells(at: &Group, cells: &[CoarseCell]) -> Result<(), IoError> {
    let number =
        |i: usize, j: usize| [cells[i].first[0], cells[i].first[1], cells[i].size[0], cells[i].size[1]][j] as f64;
    let table = Mat::from_fn(cells.len(), 4, number);
    save_dense(at, "coarse_cells", table.as_ref(), &label("1", "coarse cells", &["coarse cell", COARSE]))
}

fn load_cells(at: &Group) -> Result<Vec<CoarseCell>, IoError> {
    let table = load_dense(at, "coarse_cells")?;
    if table.ncols() != 4 {
        return Err(invalid(at, "coarse_cells", format!("{} columns, not 4", table.ncols())));
    }
    let cell = |i: usize| {
        let mut numbers = [0; 4];
        for (j, number) in numbers.iter_mut().enumerate() {
            let value = table[(i, j)];
            *number = value as usize; // NaN becomes 0, and large numbers become the largest usize
            if *number as f64 != value || value > f64::from(u32::MAX) {
                return Err(invalid(at, "coarse_cells", format!("{value} is no number of cells")));
            }
        }
        let [i, j, m, n] = numbers;
        Ok(CoarseCell { first: [i, j], size: [m, n] })
    };
    (0..table.nrows()).map(cell).collect()
}

/// Writes `/multiscale`.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn write(file: &File, record: &GridRecord) -> Result<(), IoError> {
    let at = create_group(file, "multiscale")?;
    let axis = &["axis"];
    let HeterogeneousBody { grid, elasticity, .. } = &record.body;
    save_vector(&at, "origin", &grid.origin, &label("length", "lower left corner of the grid", axis))?;
    save_vector(&at, "spacing", &grid.spacing, &label("length", "sides of a fine cell", axis))?;
    save_integers(&at, "cells", &grid.cells, &label("1", "fine cells along x and y", axis))?;
    let mut rows = vec![0; grid.cells[0] * grid.cells[1]];
    grid.body_cells().zip(1..).for_each(|(cell, row)| rows[cell] = row);
    let meaning = "1 + row of fine cell (ix, iy), number ix ny + iy, among the quadrilaterals of /VTKHDF, whose values follow \
                   those of the lines in CellData; 0 outside of the body";
    save_integers(&at, "rows", &rows, &label("1", meaning, &["fine cell"]))?;
    save(&at, "elasticity", elasticity)?;
    if let Some(coarse) = &record.coarse {
        save_cells(&at, &coarse.cells)?;
        let vertex = &["coarse vertex", "component"];
        let points: Vec<[f64; 2]> = coarse.vertices.iter().map(|&v| grid.lattice_point(v)).collect();
        save_points(&at, "vertices", &points, &label("length", "vertices of the coarse cells", vertex))?;
        let displacement = label("length", "their displacement", vertex);
        save_points(&at, "vertex_displacement", &record.vertex_displacement, &displacement)?;
    }
    Ok(())
}

/// Writes a step into its group.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn save_step(at: &Group, step: &Step<OnGrid>) -> Result<(), IoError> {
    let value = &["value"];
    save_integers(at, "dofs", &[step.dofs], &label("1", "displacement unknowns", value))?;
    save_number(at, "energy", step.energy, "force*length/thickness", "J")?;
    save_number(at, "strain_energy", step.strain, "force*length/thickness", "half of a(u, u)")?;
    let history =
        label("1", "the contact solver's measure of the error before each iteration and at the end", &["iteration"]);
    save_vector(at, "history", &step.history, &history)?;
    let parts = label("seconds", "set-up, assembly, factorisation, solution, estimate", &["part"]);
    save_vector(at, "seconds", &step.seconds, &parts)?;
    let parts = label("1", "parts of each fine cell of the scene along x and y", value);
    save_integers(at, "parts", &[step.layout.parts], &parts)?;
    if let Some(cells) = &step.layout.coarse {
        save_cells(at, cells)?;
    }
    if let Some(mesh) = &step.layout.around {
        save(at, AROUND, mesh)?;
    }
    let Some(estimate) = &step.estimate else { return Ok(()) };
    save_number(at, "estimate", estimate.error, "(force*length/thickness)^(1/2)", "estimated error, energy norm")?;
    let names = "multiscale: squared error of the coarse cells; fine grid: its own squared error (force*length/thickness); \
                 estimate over (2 strain energy)^(1/2); largest ratio of moduli in a coarse cell of basis q1, else 1; largest ratio between pairs of opposite cells at a node; \
                 squared error of the medium around the body";
    let GridEstimate { multiscale, fine_grid, relative, inside, crossed, medium, .. } = *estimate;
    let terms = [multiscale, fine_grid, relative, inside, crossed, medium];
    save_vector(at, "estimate_terms", &terms, &label("as named", "what belongs to the estimate", &[names]))?;
    let indicators = create_group(at, "indicators")?;
    let cell = &["coarse cell"];
    let energy = |meaning| label("force*length/thickness", meaning, cell);
    let whole = energy("squared indicators: those of nodal residuals, or the sum of the other terms here");
    save_vector(&indicators, "squared", &estimate.indicators, &whole)?;
    if let Some(terms) = &estimate.residual {
        for ((name, meaning), values) in IN_COARSE_CELLS.into_iter().zip(terms.parts()) {
            save_vector(&indicators, name, values, &energy(meaning))?;
        }
    }
    if let Some(sums) = &estimate.in_cells {
        let names = "volume, jumps between cells, tractions";
        let meaning = "sums of the residuals of all fine cells against the exact solution";
        save_vector(at, IN_CELLS, sums, &label("force*length/thickness", meaning, &[names]))?;
    }
    if !estimate.jump.is_empty() {
        let meaning = "what the nodes leave of the jump of the displacement";
        let jump = label("force*length/thickness", meaning, &["boundary element"]);
        save_vector(at, JUMP, &estimate.jump, &jump)?;
    }
    if let Some(terms) = &estimate.interface {
        save(at, INTERFACE, terms)?;
    }
    let Some(crossing) = &estimate.crossing else { return Ok(()) };
    let names = "largest ratio of moduli along a coarse edge, x and y of its middle, share of edges with a ratio of 100 or more";
    let numbers = [crossing.largest, crossing.at[0], crossing.at[1], crossing.share];
    save_vector(at, "crossing", &numbers, &label("as named", "contrast along coarse edges", &[names]))
}

/// Reads `/multiscale` and the steps, and checks that they fit the fields of the result.
///
/// # Errors
/// A file that is not one of this program's, truncated or altered.
pub(crate) fn read(file: &File, fields: &vtkhdf::Grid) -> Result<GridRecord, IoError> {
    let at = open_group(file, "multiscale")?;
    let body = load_body(&at, fields)?;
    let steps = read_steps(file)?;
    let last = steps.last().and_then(|step| step.layout.coarse.as_ref());
    let (mut coarse, mut vertex_displacement) = (None, Vec::new());
    if at.link_exists("coarse_cells") {
        let mesh = CoarseMesh::new(&body.grid, load_cells(&at)?).map_err(|e| invalid(&at, "coarse_cells", e))?;
        vertex_displacement = load_points(&at, "vertex_displacement")?;
        if vertex_displacement.len() != mesh.vertices.len() {
            let why = format!("{} of {} vertices", vertex_displacement.len(), mesh.vertices.len());
            return Err(invalid(&at, "vertex_displacement", why));
        }
        coarse = Some(mesh);
    }
    if coarse.as_ref().map(|mesh| &mesh.cells) != last {
        return Err(invalid(&at, "", "its coarse cells are not those of the last step"));
    }
    Ok(GridRecord { body, coarse, vertex_displacement, steps })
}

/// Cells, moduli and material; the moduli come from the fields.
fn load_body(at: &Group, fields: &vtkhdf::Grid) -> Result<HeterogeneousBody, IoError> {
    let pair = |name: &str| -> Result<[f64; 2], IoError> {
        let values = load_vector(at, name)?;
        values.as_slice().try_into().map_err(|_| invalid(at, name, format!("{} numbers, not 2", values.len())))
    };
    let cells = load_integers(at, "cells")?;
    let &[nx, ny] = cells.as_slice() else {
        return Err(invalid(at, "cells", format!("{} numbers, not 2", cells.len())));
    };
    let rows = load_integers(at, "rows")?;
    if nx.checked_mul(ny) != Some(rows.len()) {
        return Err(invalid(at, "rows", format!("{} numbers for {nx} by {ny} cells", rows.len())));
    }
    let grid = Grid::new(pair("origin")?, pair("spacing")?, [nx, ny], |ix, iy| rows[ix * ny + iy] > 0)
        .map_err(|e| invalid(at, "rows", e))?;
    // points and triangles of the medium around the body follow
    let same = grid.nodes() <= fields.points.len()
        && fields.triangles.iter().flatten().all(|&corner| corner >= grid.nodes())
        && grid.body_cells().zip(1..).all(|(cell, row)| rows[cell] == row)
        && grid.body_cells().map(|cell| grid.cell_nodes(cell)).eq(fields.quads.iter().copied());
    if !same {
        return Err(invalid(at, "rows", "its cells are not the quadrilaterals of /VTKHDF"));
    }
    let values = of_quads(fields, "young", 1).ok_or_else(|| invalid(at, "", "/VTKHDF has no modulus for each cell"))?;
    let mut young = vec![f64::NAN; rows.len()];
    grid.body_cells().zip(values).for_each(|(cell, value)| young[cell] = *value);
    let ratios = of_quads(fields, "poisson", 1).map(|values| {
        let mut poisson = vec![f64::NAN; rows.len()];
        grid.body_cells().zip(values).for_each(|(cell, value)| poisson[cell] = *value);
        poisson
    });
    let body = HeterogeneousBody::new(grid, young, load(at, "elasticity")?).map_err(|e| invalid(at, "", e))?;
    match ratios {
        Some(poisson) => body.with_poisson(poisson).map_err(|e| invalid(at, "", e)),
        None => Ok(body),
    }
}

/// The values of a field in the quadrilaterals, if there is such a field.
pub fn of_quads<'a>(fields: &'a vtkhdf::Grid, name: &str, components: usize) -> Option<&'a [f64]> {
    let field = vtkhdf::Grid::field(&fields.cell_data, name, components)?;
    field.values.get(components * (fields.lines.len() + fields.triangles.len())..)
}

/// Reads all steps, at least one.
///
/// # Errors
/// As [`read`].
pub(crate) fn read_steps(file: &File) -> Result<Vec<Step<OnGrid>>, IoError> {
    let groups = crate::steps::groups(file)?;
    groups.iter().map(load_step).collect()
}

fn load_step(at: &Group) -> Result<Step<OnGrid>, IoError> {
    let whole = |name: &str| -> Result<usize, IoError> {
        match load_integers(at, name)?.as_slice() {
            &[value] => Ok(value),
            values => Err(invalid(at, name, format!("{} numbers, not 1", values.len()))),
        }
    };
    let seconds = load_vector(at, "seconds")?;
    let Ok(seconds) = <[f64; 5]>::try_from(seconds.as_slice()) else {
        return Err(invalid(at, "seconds", format!("{} numbers, not 5", seconds.len())));
    };
    let parts = whole("parts")?;
    if !(1..=1 << 16).contains(&parts) {
        return Err(invalid(at, "parts", format!("{parts} parts of a cell")));
    }
    let coarse = if at.link_exists("coarse_cells") { Some(load_cells(at)?) } else { None };
    let around = if at.link_exists(AROUND) { Some(load(at, AROUND)?) } else { None };
    let estimate =
        if at.link_exists("estimate") { Some(load_estimate(at, coarse.as_ref().map_or(0, Vec::len))?) } else { None };
    Ok(Step {
        layout: GridLayout { parts, coarse, around },
        dofs: whole("dofs")?,
        energy: load_number(at, "energy")?,
        strain: load_number(at, "strain_energy")?,
        // a run never goes on from a step that did not converge
        converged: true,
        history: load_vector(at, "history")?,
        estimate,
        seconds,
    })
}

/// The estimate of a step that has one, on `cells` coarse cells.
fn load_estimate(at: &Group, cells: usize) -> Result<GridEstimate, IoError> {
    let terms = load_vector(at, "estimate_terms")?;
    // earlier files have no medium
    let (&[multiscale, fine_grid, relative, inside, crossed] | &[multiscale, fine_grid, relative, inside, crossed, _]) =
        terms.as_slice()
    else {
        return Err(invalid(at, "estimate_terms", format!("{} numbers, not 6", terms.len())));
    };
    let medium = terms.get(5).copied().unwrap_or(0.0);
    let jump = if at.link_exists(JUMP) { load_vector(at, JUMP)? } else { Vec::new() };
    let interface = if at.link_exists(INTERFACE) { Some(load(at, INTERFACE)?) } else { None };
    let in_cells = match at.link_exists(IN_CELLS) {
        true => {
            let sums = load_vector(at, IN_CELLS)?;
            Some(<[f64; 3]>::try_from(sums.as_slice()).map_err(|_| invalid(at, IN_CELLS, "three sums belong here"))?)
        }
        false => None,
    };
    let group = open_group(at, "indicators")?;
    let column = |name: &str| -> Result<Vec<f64>, IoError> {
        let values = load_vector(&group, name)?;
        match values.len() {
            n if n == cells => Ok(values),
            n => Err(invalid(&group, name, format!("{n} indicators of {cells} coarse cells"))),
        }
    };
    let residual = if group.link_exists(IN_COARSE_CELLS[0].0) {
        let [volume_mean, volume_oscillation, jump_mean, jump_oscillation, neumann] =
            IN_COARSE_CELLS.map(|(name, _)| column(name));
        Some(Indicators {
            volume_mean: volume_mean?,
            volume_oscillation: volume_oscillation?,
            jump_mean: jump_mean?,
            jump_oscillation: jump_oscillation?,
            neumann: neumann?,
        })
    } else {
        None
    };
    let crossing = if at.link_exists("crossing") {
        let numbers = load_vector(at, "crossing")?;
        let &[largest, x, y, share] = numbers.as_slice() else {
            return Err(invalid(at, "crossing", format!("{} numbers, not 4", numbers.len())));
        };
        Some(CrossingContrast { largest, at: [x, y], share })
    } else {
        None
    };
    let (indicators, error) = (column("squared")?, load_number(at, "estimate")?);
    Ok(GridEstimate {
        indicators,
        residual,
        in_cells,
        multiscale,
        fine_grid,
        interface,
        jump,
        medium,
        error,
        relative,
        crossing,
        inside,
        crossed,
    })
}
