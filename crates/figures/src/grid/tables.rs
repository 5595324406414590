//! The tables of a body on a grid.

use std::fmt::Write as _;

use steklov_io::vtkhdf::Grid;
use steklov_result::grid::of_quads;
use steklov_result::record::Record;

/// The tables of a stored result on a grid: name and text of each. None for other results.
///
/// `cells`: centre, modulus and stresses of each fine cell; `nodes`: displacement of each fine node; `coarse`: corners of each
/// coarse cell and its η² in the last step, empty without an estimate.
pub(crate) fn tables(stored: &Record) -> Vec<(&'static str, String)> {
    let Some(record) = &stored.on_grid else { return Vec::new() };
    let (body, fields) = (&record.body, &stored.grid);
    let grid = &body.grid;
    let mut tables = Vec::new();
    if let (Some(stress), Some(von_mises)) = (of_quads(fields, "stress", 3), of_quads(fields, "von_mises", 1)) {
        let mut text = String::from("x,y,young,sigma_xx,sigma_yy,sigma_xy,von_mises\n");
        for ((cell, s), von_mises) in grid.body_cells().zip(stress.chunks_exact(3)).zip(von_mises) {
            let [x, y] = grid.centre(cell);
            row(&mut text, &[x, y, body.young[cell], s[0], s[1], s[2], *von_mises]);
        }
        tables.push(("cells", text));
    }
    if let Some(u) = Grid::field(&fields.point_data, "displacement", 3) {
        let mut text = String::from("x,y,ux,uy\n");
        for (x, u) in fields.points.iter().zip(u.values.chunks_exact(3)) {
            row(&mut text, &[x[0], x[1], u[0], u[1]]);
        }
        tables.push(("nodes", text));
    }
    if let Some(mesh) = &record.coarse {
        let estimate = record.steps.last().and_then(|step| step.estimate.as_ref());
        let mut text = String::from("x0,y0,x1,y1,indicator\n");
        for (number, cell) in mesh.cells.iter().enumerate() {
            let [[x0, y0], _, [x1, y1], _] = cell.corners().map(|p| grid.lattice_point(p));
            let _ = write!(text, "{x0:?},{y0:?},{x1:?},{y1:?},");
            let squared = estimate.map_or(String::new(), |e| format!("{:?}", e.indicators[number]));
            let _ = writeln!(text, "{squared}");
        }
        tables.push(("coarse", text));
    }
    tables
}

fn row(text: &mut String, values: &[f64]) {
    for (k, value) in values.iter().enumerate() {
        let _ = write!(text, "{}{value:?}", if k == 0 { "" } else { "," });
    }
    text.push('\n');
}
