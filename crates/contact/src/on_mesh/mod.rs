//! Contact on a mesh: nodes, weights and data of contact sides, ends of contact and stick, bubbles, residuals, stabilised multipliers.

pub(crate) mod boundary;
pub(crate) mod bubbles;
pub(crate) mod conditions;
pub(crate) mod decided;
pub(crate) mod inf_sup;
pub(crate) mod lines;
pub(crate) mod moved_ends;
pub(crate) mod multiplier_space;
pub(crate) mod multiplier_trace;
pub(crate) mod node_data;
pub(crate) mod residual;
pub(crate) mod sides;
pub(crate) mod stabilised;
pub(crate) mod stabilised_parts;
pub(crate) mod tips;
pub(crate) mod transitions;
pub(crate) mod uniform_pressure;
