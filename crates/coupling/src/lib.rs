//! Symmetric coupling of finite elements with boundary elements: a heterogeneous body on a grid in an unbounded homogeneous
//! medium, with jumps of displacement and traction where they meet.
//!
//! ```text
//! HeterogeneousBody + Loads (f, t0) ─► Outline ─► Interior (A, F, Trace) ─┐
//!       or Multiscale                                                     ├─► Transmission (A_c, Transfer Π and B, Balance)
//! Mesh + Material (+ L) ──► Medium (V, K, W, M) ──────────────────────────┘          │
//!                                                                jump u0, Form, Radiation
//!                                                                                    ▼
//! Multiscale::downscale ◄── displacement, trace ◄───────────────────────────────── Coupled ──► ξ, φ, a ──► MediumField
//! ```
//! In the body -div σ(u) = f, around it the equations of the homogeneous medium without a force; on the interface Γ
//!
//! ```text
//! u - u_c = u0,        σ(u)n = σ(u_c)n + t0,        σ(u_c)n = -S u_c,   S = W + (K - ½M)ᵀ V⁻¹ (K - ½M)
//! ```
//! where n points **out of the body, into the medium**, so that S ≥ 0 is the stiffness of the medium. u_c = K ξ - V φ + a
//! around the body.
//!
//! | wanted | item |
//! |---|---|
//! | the outer boundary of a grid, jumps of tractions on it | [`Outline`] |
//! | the body: bilinear or multiscale elements | [`Interior`], [`Trace`] |
//! | boundary elements on a trace, also refined ones whose trace changes | [`Trace::mesh`], [`Trace::mesh_with`] |
//! | the medium: boundary elements of any size and degree on the same curve | [`Medium`] |
//! | the problem on the interface, its solution | [`Transmission`], [`Form`], [`Coupled`] |
//! | behaviour at infinity, resultants | [`Radiation`], [`Balance`] |
//! | displacement and stress around the body | [`MediumField`] |
//! | residuals on the interface and in the cells, the error of the traction | [`InterfaceIndicators`], [`CellIndicators`] |
//!
//! Boundary elements that are finer than the trace, of any degree, take it as it is; where the trace is finer, they take its
//! L² projection, and loads of the trace that they do not resolve stay with the body. Holes of the body are free of traction.
//!
//! Units: any consistent ones; everything is per unit thickness, body and medium in the same plane. Fields are interleaved x, y.
//!
//! ```
//! use steklov_coupling::steklov_elastic::{Material, Plane};
//! use steklov_coupling::steklov_msfem::{Elasticity, Grid, HeterogeneousBody, Loads};
//! use steklov_coupling::{Form, Interior, Medium, Outline, Radiation, Transmission};
//!
//! // u = (x, 0)/100 in a square and a medium at rest, with the jumps that belong to them
//! let grid = Grid::rectangle([1.0, 1.0], [8, 8])?;
//! let [xx, yy, _] = Material::new(5.0, 0.3, Plane::Strain)?.stress([[0.01, 0.0], [0.0, 0.0]]);
//! let mut loads = Loads::default();
//! Outline::new(&grid)?.add_traction_jump(&grid, &mut loads, |_, n| [xx * n[0], yy * n[1]]);
//! let body = HeterogeneousBody::new(grid, vec![5.0; 64], Elasticity::new(0.3, Plane::Strain)?)?;
//! let interior = Interior::fine(&body, &loads)?;
//! let medium = Medium::new(interior.trace.mesh(1, 1)?, Material::new(1.0, 0.3, Plane::Strain)?, None)?;
//! let problem = Transmission::new(interior, &medium)?;
//! let jump = medium.space.interpolate(|[x, _]| [0.01 * x, 0.0]);
//! let solved = problem.solve(&jump, Form::Schur, Radiation::Decaying)?;
//!
//! let end = body.grid.node(8, 4).expect("the middle of the right side");
//! assert!((solved.displacement[2 * end] - 0.01).abs() < 1e-14 && solved.displacement[2 * end + 1].abs() < 1e-14);
//! assert!(solved.traction.iter().chain(&solved.exterior_displacement).all(|v| v.abs() < 1e-14));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod outline;
mod trace;
mod interior;
mod transfer;
mod medium;
mod balance;
mod coupled;
mod transmission;
mod dense;
mod two_field;
mod three_field;
mod schur;
mod form;
mod factored;
mod medium_residuals;
mod subdivided;
mod far;
mod body_side;
mod mortar;
mod indicators;
mod cell_indicators;

// the crates whose types appear in the interface
pub use {faer, sprs, steklov_bem_operators, steklov_elastic, steklov_msfem};

pub use balance::{Balance, Radiation};
pub use cell_indicators::CellIndicators;
pub use coupled::Coupled;
pub use error::CouplingError;
pub use factored::{Factored, Response};
pub use form::Form;
pub use indicators::{InterfaceIndicators, Jumps};
pub use interior::Interior;
pub use medium::{Medium, MediumField};
pub use medium_residuals::{MediumLoad, MediumResiduals};
pub use mortar::{Cell, Facing, Met, MortarRow, cells, dual_moment, meet, mortar_rows};
pub use outline::Outline;
pub use schur::SchurFactor;
pub use trace::Trace;
pub use transfer::Transfer;
pub use transmission::Transmission;
