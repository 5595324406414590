//! The pictures of a body on a grid.

use std::cmp::Reverse;

use steklov_io::vtkhdf;
use steklov_msfem::{Basis, CellBasis, CoarseCell, CoarseMesh, Grid, HeterogeneousBody, Multiscale};
use steklov_picture::{
    Axis, BasisFunction, CellField, Chart, Colours, Curve, Picture, PictureError, Scale, Series, basis, cell_fields,
    chart, deformed_cells, in_unit, lattice_triangles,
};
use steklov_result::grid::GridRecord;
use steklov_result::grid::of_quads;
use steklov_result::record::Record;

use super::shown_cells;
use crate::draw::units;
use crate::view::{Scalar, Unit, View};

/// Approximate largest number of points of the deformed body.
const POINTS: usize = 20_000;

/// Moduli with this ratio or a larger one are drawn by their logarithms.
const CONTRAST: f64 = 100.0;

/// Of moduli of outcomes one in so many at either end has an outer colour.
const OUTER: usize = 200;

/// Indicators below this part of the largest one have the colour of this part.
const SMALLEST: f64 = 1e-4;

/// Bases of coarse cells with more fine cells than this are not drawn.
const LARGEST_BASIS: usize = 1 << 16;

/// Largest number of fine cells by which a coarse cell is enlarged for its oversampled basis in the picture.
const LARGEST_HALO: usize = 64;

/// A deformed body.
pub(crate) struct DeformedBody {
    /// Points and their displacement.
    pub points: Vec<[f64; 2]>,
    pub displacement: Vec<[f64; 2]>,
    /// Triangles and boundary segments between them.
    pub triangles: Vec<[usize; 3]>,
    pub outline: Vec<[usize; 2]>,
    /// The value that colours each point; for a stress, the mean around the point.
    pub values: Vec<f64>,
}

/// The deformed body as few triangles; `displacement` belongs to the nodes.
pub(crate) fn deformed(
    stored: &Record,
    record: &GridRecord,
    displacement: &[[f64; 2]],
    scalar: Scalar,
) -> DeformedBody {
    let grid = &record.body.grid;
    let lattice = lattice_triangles(grid.spacing, grid.cells, |ix, iy| grid.inside(ix, iy), POINTS);
    let of_cells = on_cells(stored, record, scalar);
    let [nx, ny] = grid.cells;
    let around = |&[i, j]: &[usize; 2]| {
        let near = |k: usize, n: usize| k.saturating_sub(1)..(k + 1).min(n);
        let cells = near(i, nx).flat_map(|ix| near(j, ny).map(move |iy| ix * ny + iy));
        let values = cells.map(|cell| of_cells[cell]).filter(|v| !v.is_nan());
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
        sum / count
    };
    // each point is the corner of a cell of the body
    let node = |&[i, j]: &[usize; 2]| grid.node(i, j).map_or([0.0; 2], |node| displacement[node]);
    let at_node = |p: &[usize; 2]| match scalar.unit() {
        Unit::Stress => around(p),
        Unit::Length => scalar.of(node(p), [f64::NAN; 3], f64::NAN),
    };
    DeformedBody {
        points: lattice.points.iter().map(|&p| grid.lattice_point(p)).collect(),
        displacement: lattice.points.iter().map(node).collect(),
        values: lattice.points.iter().map(at_node).collect(),
        triangles: lattice.triangles,
        outline: lattice.outline,
    }
}

/// Values in all cells of the bounding box, for displacements at the mean of the corners; NaN outside of the body.
pub(super) fn on_cells(stored: &Record, record: &GridRecord, scalar: Scalar) -> Vec<f64> {
    let grid = &record.body.grid;
    let mut all = vec![f64::NAN; grid.cells[0] * grid.cells[1]];
    let stress = of_quads(&stored.grid, "stress", 3).unwrap_or_default().as_chunks().0;
    let von_mises = of_quads(&stored.grid, "von_mises", 1).unwrap_or_default();
    let displacement = vtkhdf::Grid::field(&stored.grid.point_data, "displacement", 3);
    let displacement: &[[f64; 3]] = displacement.map_or(&[], |f| f.values.as_chunks().0);
    let mean = |cell: usize, i: usize| grid.cell_nodes(cell).map(|n| displacement[n][i]).iter().sum::<f64>() / 4.0;
    for ((cell, stress), von_mises) in grid.body_cells().zip(stress).zip(von_mises) {
        let u = match scalar.unit() {
            Unit::Stress => [f64::NAN; 2],
            Unit::Length => [0, 1].map(|i| mean(cell, i)),
        };
        all[cell] = scalar.of(u, *stress, *von_mises);
    }
    all
}

/// The pictures of a stored result on a grid, except that of the deformed body, each with its name; none for other
/// results.
///
/// `moduli` and `stress` (or `displacement`, if the view shows it) on the cells of the undeformed body, `estimate` with
/// the indicators of the last coarse cells, `steps` with the estimates of several steps, `basis` and `basis-deformed`
/// with multiscale basis functions of one coarse cell.
///
/// # Errors
/// A picture that cannot be drawn.
pub(crate) fn pictures(stored: &Record, view: &View) -> Result<Vec<(String, Picture)>, PictureError> {
    let Some(record) = &stored.on_grid else { return Ok(Vec::new()) };
    let (body, title) = (&record.body, &stored.summary.title);
    let grid = &body.grid;
    let coarse = if view.hides_cells { Vec::new() } else { rectangles(record) };
    let [length, unit] = units(stored, view.scalar);
    let mut pictures = Vec::new();
    let mut add = |name: &str, label: &str, values: &[f64], colours: Colours| -> Result<(), PictureError> {
        let picture = shown_cells::picture((title, label, length), grid, (values, colours), &coarse, view.window)?;
        pictures.extend(picture.map(|picture| (name.to_owned(), picture)));
        Ok(())
    };
    let [low, high] = ends(grid.body_cells().map(|cell| &body.young[cell]));
    if high > low {
        let logarithmic = high >= CONTRAST * low;
        let label = if logarithmic { "log10 of Young's modulus" } else { "Young's modulus" };
        let label = in_unit(label, stored.summary.units.stress.as_deref());
        let values: Vec<f64> = body.young.iter().map(|e| if logarithmic { e.log10() } else { *e }).collect();
        // the moduli of a scene have values outside of the body too
        let values = values.into_iter().enumerate();
        let [_, ny] = grid.cells;
        let values: Vec<f64> = values.map(|(c, v)| if grid.inside(c / ny, c % ny) { v } else { f64::NAN }).collect();
        add("moduli", &label, &values, Colours::Automatic)?;
    }
    if let Some(ratios) = body.poisson() {
        let [_, ny] = grid.cells;
        let inside = |(c, v): (usize, &f64)| if grid.inside(c / ny, c % ny) { *v } else { f64::NAN };
        let ratios: Vec<f64> = ratios.iter().enumerate().map(inside).collect();
        add("ratios", "Poisson's ratio", &ratios, Colours::Automatic)?;
    }
    let of_cells = on_cells(stored, record, view.scalar);
    add(view.scalar.noun(), &in_unit(view.scalar.label(), unit), &of_cells, view.colours())?;
    if let Some(values) = indicators(record) {
        add("estimate", "log10 of the indicator over the largest", &values, Colours::Automatic)?;
    }
    pictures.extend(spread(stored, record)?.map(|picture| ("spread".to_owned(), picture)));
    pictures.extend(outcomes_of_moduli(stored, record)?.map(|picture| ("moduli-outcomes".to_owned(), picture)));
    pictures.extend(steps(title, record)?.map(|picture| ("steps".to_owned(), picture)));
    if let Some(mesh) = &record.coarse {
        pictures.extend(bases(title, body, mesh)?.map(|picture| ("basis".to_owned(), picture)));
        pictures.extend(deformed_basis(title, body, mesh)?.map(|picture| ("basis-deformed".to_owned(), picture)));
    }
    Ok(pictures)
}

/// Mean and standard deviation of modulus and stresses over all outcomes of random input, cell by cell; none without them.
fn spread(stored: &Record, record: &GridRecord) -> Result<Option<Picture>, PictureError> {
    let grid = &record.body.grid;
    let on_cells = |name: &str, components: usize, k: usize| -> Option<Vec<f64>> {
        let values = of_quads(&stored.grid, name, components)?;
        let mut all = vec![f64::NAN; grid.cells[0] * grid.cells[1]];
        grid.body_cells().zip(values.chunks_exact(components)).for_each(|(cell, v)| all[cell] = v[k]);
        Some(all)
    };
    let unit = stored.summary.units.stress.as_deref();
    let mut panels: Vec<(String, Vec<f64>)> = Vec::new();
    let shown =
        [("young", 1, 0, "Young's modulus"), ("stress", 3, 0, "σxx"), ("stress", 3, 1, "σyy"), ("stress", 3, 2, "σxy")];
    for (name, components, k, word) in shown {
        for (of, told) in [("mean", "mean of"), ("deviation", "deviation of")] {
            let Some(values) = on_cells(&format!("{of}_{name}"), components, k) else { return Ok(None) };
            panels.push((in_unit(&format!("{told} {word}"), unit), values));
        }
    }
    let field = |k: usize| CellField {
        caption: "",
        label: &panels[k].0,
        length: stored.summary.units.length.as_deref(),
        origin: grid.origin,
        spacing: grid.spacing,
        cells: grid.cells,
        values: &panels[k].1,
        colours: Colours::Automatic,
        coarse: &[],
    };
    let fields: Vec<CellField<'_>> = (0..panels.len()).map(field).collect();
    cell_fields(&format!("{}: mean and deviation", stored.summary.title), &fields, false).map(Some)
}

/// Young's moduli of a few outcomes of random input in the same colours; none where they do not vary.
fn outcomes_of_moduli(stored: &Record, record: &GridRecord) -> Result<Option<Picture>, PictureError> {
    let (grid, unit) = (&record.body.grid, stored.summary.units.stress.as_deref());
    let outcomes = stored.stochastic.as_ref().map_or(&[][..], |result| &result.moduli);
    let [low, high] = ends(outcomes.iter().flatten());
    if low >= high {
        return Ok(None);
    }
    let logarithmic = high >= CONTRAST * low;
    let label = in_unit(if logarithmic { "log10 of Young's modulus" } else { "Young's modulus" }, unit);
    let over_box = |moduli: &Vec<f64>| {
        let mut all = vec![f64::NAN; grid.cells[0] * grid.cells[1]];
        let shown = moduli.iter().map(|e| if logarithmic { e.log10() } else { *e });
        grid.body_cells().zip(shown).for_each(|(cell, value)| all[cell] = value);
        all
    };
    let values: Vec<Vec<f64>> = outcomes.iter().map(over_box).collect();
    let mut sorted: Vec<f64> = values.iter().flatten().copied().filter(|v| !v.is_nan()).collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len() - 1;
    let colours = Colours::Range([sorted[last / OUTER], sorted[last - last / OUTER]]);
    let captions: Vec<String> = (1..=values.len()).map(|k| format!("outcome {k}")).collect();
    let field = |k: usize| CellField {
        caption: &captions[k],
        label: &label,
        length: stored.summary.units.length.as_deref(),
        origin: grid.origin,
        spacing: grid.spacing,
        cells: grid.cells,
        values: &values[k],
        colours,
        coarse: &[],
    };
    let fields: Vec<CellField<'_>> = (0..values.len()).map(field).collect();
    cell_fields(&format!("{}: outcomes of the modulus", stored.summary.title), &fields, true).map(Some)
}

/// Smallest and largest of positive numbers.
fn ends<'a>(values: impl Iterator<Item = &'a f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, 0.0], |[low, high], v| [low.min(*v), high.max(*v)])
}

/// Lower left and upper right corners of the coarse cells.
fn rectangles(record: &GridRecord) -> Vec<[[f64; 2]; 2]> {
    let cells = record.coarse.as_ref().map_or(&[][..], |mesh| &mesh.cells);
    let corners = |cell: &CoarseCell| [cell.corners()[0], cell.corners()[2]].map(|p| record.body.grid.lattice_point(p));
    cells.iter().map(corners).collect()
}

/// log10 of η_T / max η on the fine cells of each coarse cell.
fn indicators(record: &GridRecord) -> Option<Vec<f64>> {
    let (grid, mesh) = (&record.body.grid, record.coarse.as_ref()?);
    let squared = &record.steps.last()?.estimate.as_ref()?.indicators;
    let largest = squared.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return None;
    }
    let mut values = vec![f64::NAN; grid.cells[0] * grid.cells[1]];
    for (cell, squared) in mesh.cells.iter().zip(squared) {
        let value = (squared / largest).sqrt().max(SMALLEST).log10();
        cell.fine_cells(grid).for_each(|fine| values[fine] = value);
    }
    Some(values)
}

/// The estimates of several steps and their parts against the unknowns; None for fewer than two steps with an estimate.
fn steps(title: &str, record: &GridRecord) -> Result<Option<Picture>, PictureError> {
    let estimates: Vec<_> = record.steps.iter().filter_map(|s| Some((s.dofs as f64, s.estimate.as_ref()?))).collect();
    if estimates.len() < 2 {
        return Ok(None);
    }
    let column = |value: fn(&steklov_model::grid::GridEstimate) -> f64| -> Vec<[f64; 2]> {
        estimates.iter().map(|(dofs, estimate)| [*dofs, value(estimate)]).collect()
    };
    let columns = [
        ("whole estimate", column(|e| e.error)),
        ("part of coarse cells", column(|e| e.multiscale.sqrt())),
        ("part of the fine grid", column(|e| e.fine_grid.sqrt())),
    ];
    // without coarse cells their part is zero, and without an estimate of the fine grid the whole is zero
    let drawn: Vec<_> = columns.iter().filter(|(_, points)| points.iter().any(|p| p[1] > 0.0)).collect();
    let curves: Vec<[Curve<'_>; 1]> = drawn.iter().map(|(_, points)| [Curve { points, flagged: &[] }]).collect();
    let series: Vec<Series<'_>> =
        drawn.iter().zip(&curves).map(|((name, _), curves)| Series { name, curves }).collect();
    let picture = chart(&Chart {
        title,
        x: Axis { label: "degrees of freedom N", scale: Scale::Log },
        y: Axis { label: "estimated error, energy norm", scale: Scale::Log },
        quantities: &["estimate"],
        series: &series,
        flag: "",
        guides: &[],
        band: None,
    })?;
    Ok(Some(picture))
}

/// Φ_(0,x) of one coarse cell, a row for each kind of basis; None for a cell of one fine cell, or of very many.
fn bases(title: &str, body: &HeterogeneousBody, mesh: &CoarseMesh) -> Result<Option<Picture>, PictureError> {
    let Some(cell) = example(body, mesh) else { return Ok(None) };
    let [m, n] = cell.size;
    if m * n == 1 || m * n > LARGEST_BASIS {
        return Ok(None);
    }
    let halo = m.max(n).min(LARGEST_HALO);
    let oversampled = format!("oversampled by {halo} cells");
    let kinds = [
        ("linear", Basis::Linear),
        ("coupled", Basis::Coupled),
        ("oscillatory", Basis::Oscillatory),
        (&oversampled, Basis::Oversampled(halo)),
        ("periodic", Basis::Periodic),
    ];
    // a kind whose local problem has no solution is left out
    let solved = kinds.into_iter().filter_map(|(name, kind)| Some((name, basis_in(body, cell, kind)?)));
    let functions: Vec<(&str, [Vec<f64>; 2])> = solved
        .map(|(name, basis)| (name, [0, 1].map(|k| basis.values.iter().skip(k).step_by(2).map(|row| row[0]).collect())))
        .collect();
    if functions.is_empty() {
        return Ok(None);
    }
    let size = [m as f64 * body.grid.spacing[0], n as f64 * body.grid.spacing[1]];
    let rows: Vec<BasisFunction<'_>> =
        functions.iter().map(|(name, [x, y])| BasisFunction { name, size, cells: [m, n], x, y }).collect();
    let [x, y] = body.grid.lattice_point(cell.first);
    let title = format!("{title}: x function of the corner ({x},{y})");
    Ok(Some(basis(&title, &rows)?))
}

/// A coarse cell, displaced by each of the eight functions of the bases with linear and with coupled data.
fn deformed_basis(title: &str, body: &HeterogeneousBody, mesh: &CoarseMesh) -> Result<Option<Picture>, PictureError> {
    let Some(cell) = example(body, mesh).filter(|cell| (2..=LARGEST_BASIS).contains(&(cell.size[0] * cell.size[1])))
    else {
        return Ok(None);
    };
    let kinds = [("linear", Basis::Linear), ("coupled", Basis::Coupled)];
    let functions = kinds.into_iter().filter_map(|(kind, of)| Some((kind, basis_in(body, cell, of)?)));
    let functions: Vec<(String, [Vec<f64>; 2])> = functions
        .flat_map(|(kind, basis)| {
            let of = move |column: usize| {
                let component = |k: usize| basis.values.iter().skip(k).step_by(2).map(|row| row[column]).collect();
                let name = format!("{kind}: corner {}, {}", column / 2 + 1, ["x", "y"][column % 2]);
                (name, [component(0), component(1)])
            };
            (0..8).map(of).collect::<Vec<_>>()
        })
        .collect();
    if functions.is_empty() {
        return Ok(None);
    }
    let size = [0, 1].map(|k| cell.size[k] as f64 * body.grid.spacing[k]);
    let functions: Vec<BasisFunction<'_>> =
        functions.iter().map(|(name, [x, y])| BasisFunction { name, size, cells: cell.size, x, y }).collect();
    deformed_cells(&format!("{title}: a coarse cell as its basis functions displace it"), &functions, 4).map(Some)
}

/// The coarse cell whose basis is drawn: among cells with varying moduli, if there are any, the largest ones, and among
/// these the one nearest to the middle of the bounding box.
fn example(body: &HeterogeneousBody, mesh: &CoarseMesh) -> Option<CoarseCell> {
    let grid = &body.grid;
    let rank = |cell: &CoarseCell| {
        let first = body.young[cell.first[0] * grid.cells[1] + cell.first[1]];
        let is_uniform = cell.fine_cells(grid).all(|c| body.young[c] == first);
        let off = |k: usize| (2 * cell.first[k] + cell.size[k]).abs_diff(grid.cells[k]) as f64 * grid.spacing[k];
        (is_uniform, Reverse(cell.size[0] * cell.size[1]), off(0).hypot(off(1)))
    };
    let ranked = mesh.cells.iter().map(|cell| (rank(cell), *cell));
    let least = ranked.min_by(|(a, _), (b, _)| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
    least.map(|(_, cell)| cell)
}

/// The basis of a coarse cell with neighbours of its size, as far as these are in the body.
fn basis_in(body: &HeterogeneousBody, cell: CoarseCell, kind: Basis) -> Option<CellBasis> {
    let grid = &body.grid;
    let ([m, n], [nx, ny]) = (cell.size, grid.cells);
    // the fine cell of the body at a place of the neighbourhood, 3m × 3n fine cells
    let fine = |ix: usize, iy: usize| {
        let (i, j) = ((cell.first[0] + ix).checked_sub(m)?, (cell.first[1] + iy).checked_sub(n)?);
        (i < nx && j < ny).then_some([i, j])
    };
    let is_inside = |ix: usize, iy: usize| fine(ix, iy).is_some_and(|[i, j]| grid.inside(i, j));
    let whole: Vec<bool> =
        (0..9).map(|b| (0..m * n).all(|c| is_inside(b / 3 * m + c / n, b % 3 * n + c % n))).collect();
    let near = Grid::new([0.0; 2], grid.spacing, [3 * m, 3 * n], |ix, iy| whole[ix / m * 3 + iy / n]).ok()?;
    let young = |c: usize| fine(c / (3 * n), c % (3 * n)).map_or(f64::NAN, |[i, j]| body.young[i * ny + j]);
    let near = HeterogeneousBody::new(near, (0..9 * m * n).map(young).collect(), body.elasticity).ok()?;
    let mesh = CoarseMesh::uniform(&near.grid, cell.size).ok()?;
    let number = mesh.cells.iter().position(|c| c.first == [m, n])?;
    Multiscale::new(&near, mesh, kind).ok()?.cell_basis(number).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use steklov_elastic::Plane;
    use steklov_msfem::Elasticity;

    /// A medium of rough moduli without the upper right quarter.
    fn rough() -> HeterogeneousBody {
        let grid = Grid::new([1.0, -2.0], [0.25, 0.125], [16, 12], |ix, iy| ix < 8 || iy < 6).unwrap();
        let young = (0..16 * 12).map(|c| 1.0 + ((c * c) % 11) as f64).collect();
        HeterogeneousBody::new(grid, young, Elasticity::new(0.3, Plane::Strain).unwrap()).unwrap()
    }

    #[test]
    fn the_drawn_functions_are_those_of_the_whole_body() {
        let body = rough();
        let mesh = CoarseMesh::uniform(&body.grid, [4, 3]).unwrap();
        for kind in [Basis::Linear, Basis::Coupled, Basis::Oscillatory, Basis::Oversampled(3), Basis::Periodic] {
            let whole = Multiscale::new(&body, mesh.clone(), kind).unwrap();
            for (number, &cell) in mesh.cells.iter().enumerate() {
                let drawn = basis_in(&body, cell, kind).unwrap();
                let wanted = whole.cell_basis(number).unwrap();
                let both = drawn.values.as_flattened().iter().zip(wanted.values.as_flattened());
                let off = both.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
                assert!(drawn.size == wanted.size && off < 1e-12, "{kind:?} of cell {number}: {off}");
            }
        }
    }

    #[test]
    fn the_example_varies_then_is_large_then_in_the_middle() {
        let mut body = rough();
        let cells = |sizes: &[([usize; 2], [usize; 2])]| -> Vec<CoarseCell> {
            sizes.iter().map(|&(first, size)| CoarseCell { first, size }).collect()
        };
        let mut layout = cells(&[([0, 0], [8, 6]), ([0, 6], [4, 6]), ([4, 6], [4, 6]), ([8, 0], [8, 6])]);
        let mesh =
            |layout: &[CoarseCell], body: &HeterogeneousBody| CoarseMesh::new(&body.grid, layout.to_vec()).unwrap();
        // both large cells are equally far from the middle: the first one
        assert_eq!(example(&body, &mesh(&layout, &body)), Some(layout[0]));
        layout[0].fine_cells(&body.grid.clone()).for_each(|c| body.young[c] = 7.0);
        assert_eq!(example(&body, &mesh(&layout, &body)), Some(layout[3]));
        layout[3].fine_cells(&body.grid.clone()).for_each(|c| body.young[c] = 5.0);
        assert_eq!(example(&body, &mesh(&layout, &body)), Some(layout[2]));
        body.young.fill(1.0);
        layout.swap(0, 3);
        assert_eq!(example(&body, &mesh(&layout, &body)), Some(layout[0]));
    }
}
