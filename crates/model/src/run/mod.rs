//! From a scene to its answer: the adaptive loop, its models, and what ends it.

pub mod adaptive_loop;
pub mod answer;
pub mod boundary_elements;
mod boundary_report;
pub mod expect;
pub mod memory;
pub mod report;
