//! The tests of the crate, one program.

mod cache;
mod calderon;
mod circle;
mod common;
mod condense;
mod curves;
mod cut;
mod enrichment;
mod functional;
mod gold;
mod load;
mod marking;
mod meshing;
mod moments;
mod operators;
mod particular;
mod polygon;
mod potential;
mod residual;
mod stability;
mod subdivision;
mod substructures;
mod trace_rows;
mod unbounded;
