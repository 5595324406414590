//! What a result tells in words: why its run ended, what to do about that, what else a reader has to know.

use steklov_model::grid::FAILING;
use steklov_model::run::adaptive_loop::Reason;
use steklov_model::solve::contact_rows::TOUCHING;
use steklov_model::summary::{GridSummary, Summary};
use steklov_plan::{NEXT_MESH, Plan};
use steklov_result::record::Record;

/// What to do about a run whose contact solver did not reach its criterion, or that memory ended.
pub fn advice(summary: &Summary, plan: &Plan) -> Option<String> {
    if summary.reason == Reason::Interrupted.word() {
        return Some("the same command with --resume goes on from the last step".to_owned());
    }
    if summary.reason == Reason::MaxDofs.word() {
        let next = plan.left_out.iter().find(|d| d.what == NEXT_MESH)?;
        return Some(format!("{}: {}", next.what, next.why));
    }
    summary.failure.clone().filter(|_| summary.reason == Reason::Solver.word())
}

/// Why a run ended, by the word of the JSON object.
pub fn ending(reason: &str) -> &'static str {
    const ENDINGS: [(Reason, &str); 10] = [
        (Reason::Solved, "The one mesh that was asked for is solved"),
        (Reason::Tolerance, "The estimated error is down at the tolerance"),
        (Reason::MaxDofs, "The next mesh would have more unknowns than allowed, or need more memory"),
        (Reason::MaxSteps, "As many steps as allowed are done"),
        (Reason::MaxNodes, "The stochastic mesh has as many nodes as allowed, and is not down at its tolerance"),
        (
            Reason::FineGrid,
            "Coarse cells need not, or cannot, be split any more: what is left is the error of the fine grid",
        ),
        (Reason::Roundoff, "Rounding errors leave nothing to refine"),
        (Reason::Solver, "The contact solver did not reach its criterion"),
        (Reason::Interrupted, "The user stopped it"),
        (Reason::Failed, "The step after the last one failed"),
    ];
    ENDINGS.iter().find(|(known, _)| known.word() == reason).map_or("", |(_, text)| text)
}

/// Where multiscale bases fail.
pub fn crossing_warning(grid: &GridSummary) -> Option<String> {
    let (contrast, [x, y], share) = (grid.crossing_contrast?, grid.crossing_at?, grid.crossing_share?);
    let fem = if grid.boundary_elements.is_some() { "fem-bem" } else { "fem" };
    (contrast >= FAILING).then(|| {
        format!(
            "moduli differ by {contrast:.1e} along a coarse edge at ({x}, {y}), and by 100 or more on {:.0} % of them: \
             multiscale elements fail there, and their estimate is too small; align the coarse cells with the inclusions, or use model = \"{fem}\" with method.max_dofs = {} or more",
            100.0 * share,
            grid.fine_dofs
        )
    })
}

/// Names of the contact sides without any pressure.
pub fn untouched(stored: &Record) -> Vec<&str> {
    let Record { contact, mesh, .. } = stored;
    let largest = contact.iter().fold(0.0, |m: f64, r| m.max(r.pressure));
    let has = |side: usize, least: f64| contact.iter().any(|r| r.side == side && r.pressure > least);
    let sides = (0..mesh.side_names.len()).filter(|&k| has(k, f64::NEG_INFINITY) && !has(k, TOUCHING * largest));
    sides.map(|k| mesh.side_names[k].as_str()).collect()
}
