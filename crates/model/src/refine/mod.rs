//! The next mesh: which elements are refined and how, with vertices where contact ends and where gaps turn.

pub mod adapt;
pub(crate) mod asperities;
pub(crate) mod transitions;
pub(crate) mod translates;
