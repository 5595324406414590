//! Random input of contact problems: variables and fields, bases in them, solutions at all their values, statistics.
//!
//! ```text
//! Variable ──► Recurrence of its density on an interval ──► Gauss and Lobatto rules, orthonormal polynomials
//!    │                                                          │
//!    │       Covariance ─► KarhunenLoeve ─► Field               ▼
//!    └──────────────────────────┴──► StochasticMesh: cells × degrees ──► CellBasis: points, weights, M_E
//!                                    smolyak, Samples ──► points, weights
//! Family (S, and what of E, load, gap, bound depends on ξ) + points ──► solve_nodes: node by node
//!                                                         └─────────► TensorProblem: active set
//! answers + weights ──► Moments, quantiles, densities, probabilities; indicator ──► cells to split, degrees to raise
//! ```
//!
//! Every random input is a function of independent *germs* ξ_d, one for each direction of the stochastic mesh. The germ of a
//! variable is the variable itself, except for a lognormal one, whose germ is its logarithm. Densities, rules and polynomials
//! are those of germs.
//!
//! Same bits for any number of threads: random numbers are functions of seed, sample and direction, and sums are taken in
//! a fixed order.
//!
//! ```
//! use steklov_stochastic::{Distribution, Variable, moments, smolyak};
//!
//! // a spring k, uniform on [1, 2], under a unit load: E[1/k] = ln 2, E[1/k²] = 1/2
//! let k = Variable::new(Distribution::Uniform, 1.0, 2.0)?;
//! let grid = smolyak(&[k], 6)?;
//! let answers: Vec<Vec<f64>> = grid.points.iter().map(|germ| vec![1.0 / germ[0]]).collect();
//! let told = moments(&grid.weights, &answers)?;
//! let exact = std::f64::consts::LN_2;
//! assert!((told.mean[0] - exact).abs() < 1e-12 && (told.variance[0] - (0.5 - exact * exact)).abs() < 1e-12);
//! # Ok::<(), steklov_stochastic::StochasticError>(())
//! ```

mod error;
mod discrete;
mod variable;
mod orthogonal;
mod covariance;
mod exponential;
mod spectrum;
mod galerkin;
mod karhunen_loeve;
mod rectangle;
mod lanczos;
mod circulant;
mod cell_covariance;
mod cell_karhunen_loeve;
mod cell_samples;
mod field;
mod stochastic_mesh;
mod cell_basis;
mod total_degree;
mod smolyak;
mod affine_galerkin;
mod sampling;
mod truncation;
mod chains;
mod multilevel;
mod tensor_problem;
mod tensor_solvers;
mod statistics;
mod moments;

// the crates whose types appear in the interface
pub use {faer, steklov_contact, steklov_quadrature};

pub use affine_galerkin::{AffineFamily, AffineProduct, AffineSolution, MeanSolve};
pub use cell_basis::{CellBasis, Nodes};
pub use cell_covariance::FieldCells;
pub use cell_karhunen_loeve::CellKarhunenLoeve;
pub use cell_samples::CellSamples;
pub use chains::{CHAIN, scale_bounds, solve_points, solve_warm};
pub use covariance::{Covariance, Kernel};
pub use error::StochasticError;
pub use field::Field;
pub use karhunen_loeve::{IntervalParts, KarhunenLoeve, ModeParts, Truncation};
pub use moments::{Accumulator, Moments, moments};
pub use multilevel::{cost_of_levels, outcomes_of_levels};
pub use orthogonal::Recurrence;
pub use rectangle::RectangleKarhunenLoeve;
pub use sampling::{latin_hypercube, sample, uniform};
pub use smolyak::{Points, SparsePolynomials, smolyak};
pub use statistics::{Histogram, density, quantiles};
pub use stochastic_mesh::{StochasticCell, StochasticMesh};
pub use tensor_problem::{TensorProblem, TensorSolution};
pub use tensor_solvers::tensor_active_set;
pub use total_degree::{Coupled, TotalDegree};
pub use truncation::{DirectionError, changes, refine, truncation};
pub use variable::{Distribution, Variable};
