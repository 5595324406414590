//! The memory that a mesh needs.

use steklov_problem::Scene;

use crate::estimate::error_estimate::is_estimated;
use crate::mesh::layout::{Layout, Sizes};
use crate::quantities::needs_tractions;

/// Bytes of the matrices that a mesh needs at once: V, K, W and, for an estimate, six or eight blocks of the enriched spaces; of a body that
/// is cut those of all different subdomains, and the fronts of the unknowns on cuts.
pub fn memory_bytes(scene: &Scene, layout: &Layout) -> u64 {
    let estimated = is_estimated(scene, layout.dofs());
    let blocks = if needs_tractions(scene) { 5.0 } else { 3.0 };
    let bytes = |[elements, dofs]: [usize; 2]| {
        let (n, x) = (dofs as f64, if estimated { 2.0 * elements as f64 } else { 0.0 });
        (8.0 * (3.0 * n * n + blocks * n * x + 3.0 * x * x)) as u64
    };
    let Sizes { pieces, fronts } = layout.sizes(&scene.problem);
    let of_fronts = fronts.into_iter().map(|n| 8 * (n as u64).pow(2)).sum::<u64>();
    let all = pieces.into_iter().map(bytes).sum::<u64>() + of_fronts;
    if scene.is_inclusion() { 2 * all } else { all }
}

/// A mesh whose matrices do not fit into the memory that the method may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lack {
    /// Its displacement unknowns.
    pub dofs: usize,
    /// Bytes that it needs.
    pub needed: u64,
    /// Bytes that there are.
    pub left: u64,
}

/// The memory that a mesh lacks; none if it fits.
pub(crate) fn lack(scene: &Scene, layout: &Layout) -> Option<Lack> {
    let left = scene.method.memory?;
    let needed = memory_bytes(scene, layout);
    (needed > left).then_some(Lack { dofs: layout.dofs(), needed, left })
}
