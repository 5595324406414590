//! The memory that a mesh needs.

use steklov_problem::Scene;

use crate::estimate::error_estimate::is_estimated;

/// Bytes of the matrices that a mesh needs at once: V, K, W and, for an estimate, six blocks of the enriched spaces.
pub fn memory_bytes(scene: &Scene, elements: usize, dofs: usize) -> u64 {
    let x = if is_estimated(scene, dofs) { 2.0 * elements as f64 } else { 0.0 };
    let n = dofs as f64;
    let one = (8.0 * (3.0 * n * n + 3.0 * n * x + 3.0 * x * x)) as u64;
    if scene.is_inclusion() { 2 * one } else { one }
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
pub(crate) fn lack(scene: &Scene, elements: usize, dofs: usize) -> Option<Lack> {
    let (needed, left) = (memory_bytes(scene, elements, dofs), scene.method.memory?);
    (needed > left).then_some(Lack { dofs, needed, left })
}
