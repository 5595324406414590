//! What is told of scenes on grids.

use steklov_model::summary::GridSummary;
use steklov_report::told::crossing_warning;

/// What is told of the grid of finite elements.
pub(super) fn grid_lines(grid: &GridSummary) -> Vec<String> {
    let mut lines = Vec::new();
    let parts = [
        (grid.estimate_multiscale, "by the coarse cells"),
        (grid.estimate_fine_grid, "by the fine grid itself"),
        (grid.estimate_medium, "by the boundary elements around it"),
    ];
    let parts: Vec<String> =
        parts.into_iter().filter_map(|(part, of)| part.map(|part| format!("{part:.3e} {of}"))).collect();
    if parts.len() > 1 {
        lines.push(format!("            of it {}", parts.join(", ")));
    }
    let [nx, ny] = grid.cells;
    lines.push(match (&grid.basis, grid.coarse_cells, grid.patterns) {
        (Some(basis), Some(coarse), Some(patterns)) => format!(
            "grid        {nx} by {ny} fine cells, {} unknowns; {coarse} coarse cells, basis {basis}, {patterns} local problem(s)",
            grid.fine_dofs
        ),
        _ => format!("grid        {nx} by {ny} cells"),
    });
    lines.extend(grid.boundary_elements.map(|n| format!("            {n} boundary elements of the medium around it")));
    lines.push(format!("            contrast of the moduli {:.4}", grid.contrast));
    lines.extend(crossing_warning(grid).map(|warning| format!("warning     {warning}")));
    lines
}
