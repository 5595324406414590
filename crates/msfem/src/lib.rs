//! Plane elasticity of heterogeneous bodies on grids of rectangles: bilinear and extended multiscale finite elements.
//!
//! ```text
//! Grid (cells inside of a body) + Young's moduli + Elasticity ─► HeterogeneousBody   Loads, cell by cell
//!                                                                  │             │
//! all fine nodes:   HeterogeneousBody::stiffness, Loads::nodal ────┼─────────────┤
//!                                                                  │             │
//! coarse vertices:  CoarseMesh + Basis ─► Multiscale ─► CellBasis R_T, K_T^H = R_Tᵀ K_T R_T ─► CoarseSystem
//!                      ▲                                                         │
//!                      │                                  Elimination (sparse Cholesky, down to the contact nodes)
//!                   refine ◄── mark ◄── indicators ◄── fine field ◄── downscale ◄┘
//! ```
//! A coarse cell T of m × n fine cells has eight functions Φ_(p,k), one for each corner p and direction k, which solve the
//! equations on its fine cells; coarse unknowns are displacements of vertices. The coarse matrix is as small as that of
//! bilinear elements on the coarse cells, but it knows the moduli of the fine ones. Cells with moduli of one pattern, up to a
//! factor, share a basis: a homogeneous or periodic body needs one local problem. Nothing holds the matrix of the whole fine
//! grid, so that this can have ten million unknowns and more.
//!
//! | wanted | item |
//! |---|---|
//! | cells, nodes, places | [`Grid`], [`CoarseMesh`] |
//! | moduli, stiffness, stresses, fields at points | [`HeterogeneousBody`], [`Elasticity`] |
//! | tractions, body forces | [`Loads`] |
//! | bases: boundary data, homogenised tensor | [`Basis`], [`CellBasis`] |
//! | the coarse problem and the way back | [`Multiscale`], [`CoarseSystem`], [`Extra`] |
//! | solution, supports, reduction to few unknowns | [`Elimination`] |
//! | the multiscale error | [`nodal_indicators`], [`Indicators`] |
//! | the error of the fine grid itself | [`bubble_indicators`] |
//! | that of numbers, and what coarse cells lack of the fine grid | [`bubble_weighted_residuals`], [`fine_correction`] |
//! | where multiscale bases fail | [`crossing_contrast`] |
//! | smaller coarse cells | [`mark`], [`refine`] |
//!
//! *Use when* moduli differ from place to place on a scale that few elements resolve, or over and over by one pattern.
//! *Fails when* stiff parts cross the edges of coarse cells (contrast 100 or more: the error is that of doing nothing), and
//! where coarse cells are as large as the heterogeneities: the error grows as H comes down to their size, and falls below it.
//! A multiscale field is one of the fine grid: it is never nearer to the exact solution than bilinear elements on that grid.
//!
//! Units: any consistent ones; everything is per unit thickness. Unknown 2·node + component is a displacement. The bits are
//! the same for any number of threads, except for matrices so large that their factorisation uses several.
//!
//! ```
//! use steklov_msfem::steklov_elastic::Plane;
//! use steklov_msfem::{Basis, CoarseMesh, Elasticity, Elimination, Extra, Grid, Loads, HeterogeneousBody, Multiscale};
//!
//! // a strip of 64 × 16 cells, every other column stiffer, pulled at its right end; the left end is held
//! let grid = Grid::rectangle([4.0, 1.0], [64, 16])?;
//! let young = (0..64 * 16).map(|cell| if cell / 16 % 2 == 0 { 1.0 } else { 3.0 }).collect();
//! let body = HeterogeneousBody::new(grid, young, Elasticity::new(0.0, Plane::Strain)?)?;
//! let mut loads = Loads::default();
//! for (cell, side) in body.grid.boundary().into_iter().filter(|(_, side)| *side == 1) {
//!     let half = body.grid.spacing[1] / 2.0;
//!     loads.add_side(cell, side, [[half, 0.0]; 2]);
//! }
//!
//! let mut coarse = Multiscale::new(&body, CoarseMesh::uniform(&body.grid, [8, 8])?, Basis::Oscillatory)?;
//! let system = coarse.assemble(&loads, &Extra::default(), &mut |_| true)?;
//! let held: Vec<usize> = (0..coarse.mesh.vertices.len())
//!     .filter(|&v| coarse.mesh.vertices[v][0] == 0)
//!     .filter_map(|v| coarse.unknown[v])
//!     .flat_map(|x| [x, x + 1])
//!     .collect();
//! let solver = Elimination::new(system.stiffness, &coarse.elimination_order(), &[], &held)?;
//! let u = solver.expand(&solver.reduce(&system.load, &vec![0.0; held.len()]), &[]);
//! let fine = coarse.downscale(&u, &loads, &Extra::default(), &mut |_| true)?;
//!
//! // without Poisson's effect a bar: u = F ∫ 1/E = 4 (1/1 + 1/3) / 2, at every point of the end
//! let corner = body.grid.node(64, 0).expect("a corner of the strip");
//! assert!((fine[2 * corner] - 8.0 / 3.0).abs() < 1e-12);
//! assert_eq!(coarse.patterns(), 3); // cells inside, and those at either end, whose edges there have one neighbour
//! # Ok::<(), steklov_msfem::MsfemError>(())
//! ```

mod error;
mod grid;
mod elasticity;
mod body;
mod affine;
mod load;
mod ordering;
mod local;
mod basis;
mod coarse_mesh;
mod multiscale;
mod patterns;
mod prolongation;
mod elimination;
mod indicators;
mod fine_correction;
mod fine_error;
mod refinement;
mod stiffness_product;
mod contrast;

// the crates whose types appear in the interface
pub use {faer, sprs, steklov_elastic};

pub use basis::{Basis, CellBasis};
pub use body::HeterogeneousBody;
pub use coarse_mesh::{CoarseCell, CoarseMesh, Hanging};
pub use contrast::{CrossingContrast, crossing_contrast};
pub use elasticity::Elasticity;
pub use elimination::{Elimination, ReducedLoad};
pub use error::MsfemError;
pub use fine_correction::fine_correction;
pub use fine_error::{
    BubbleDual, BubbleResidual, OfSide, bubble_energies, bubble_indicators, bubble_values, bubble_weighted_residuals,
};
pub use grid::Grid;
pub use indicators::{Indicators, SideTraction, nodal_indicators};
pub use load::Loads;
pub use multiscale::{Bases, CoarseSystem, Extra, Multiscale};
pub use refinement::{mark, refine};
