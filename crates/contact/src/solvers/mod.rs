//! Contact problems of nodes with their conditions, their solvers and their judge: no file here knows a mesh.

pub(crate) mod active_set;
pub(crate) mod barrier;
pub(crate) mod coupled;
pub(crate) mod fixed_point;
pub(crate) mod free;
pub(crate) mod frozen;
pub(crate) mod interior_point;
pub(crate) mod kkt;
pub(crate) mod lanczos;
pub(crate) mod law;
pub(crate) mod linear;
pub(crate) mod motions;
pub(crate) mod multipliers;
pub(crate) mod newton;
pub(crate) mod newton_matrix;
pub(crate) mod pieces;
pub(crate) mod problem;
pub(crate) mod rows;
pub(crate) mod settle;
pub(crate) mod several;
pub(crate) mod start;
pub(crate) mod stopped;
pub(crate) mod uzawa;
