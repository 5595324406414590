//! What all models of plane elasticity share: an isotropic [`Material`] in plane strain or plane stress ([`Plane`]), its stresses,
//! the rigid motions that supports leave free ([`RigidMotion`], [`free_motions`]), how fields behave at vertices ([`Wedge`]) and at ends of contact ([`TipField`]), and the
//! algebra of vectors ([`plane`]).
//!
//! Stresses are `[σ_xx, σ_yy, σ_xy]`, vectors `[x, y]`; units are the caller's own.
//!
//! ```
//! use steklov_elastic::{Material, Plane, RigidMotion, free_motions};
//!
//! // pulled along x in plane strain: σ_yy = 0 needs ε_yy = -ν/(1-ν) ε_xx
//! let steel = Material::new(210e3, 0.3, Plane::Strain)?;
//! let stress = steel.stress([[1e-3, 0.0], [0.0, -0.3 / 0.7 * 1e-3]]);
//! assert!((stress[0] - 210.0 / (1.0 - 0.3 * 0.3)).abs() < 1e-9 && stress[1].abs() < 1e-9);
//!
//! // two rollers on the x axis leave a translation
//! let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
//! let rollers = [([0.0, 0.0], [0.0, 1.0]), ([2.0, 0.0], [0.0, 1.0])];
//! assert_eq!(RigidMotion::names(&free_motions(&corners, &rollers)), "translation along (1, 0)");
//! # Ok::<(), steklov_elastic::MaterialError>(())
//! ```

mod logarithm;
mod material;
pub mod plane;
mod rigid;
mod tip;
mod wedge;

pub use logarithm::Datum;
pub use material::{Material, MaterialError, Plane, principal, von_mises};
pub use rigid::{RigidMotion, free_motions};
pub use tip::{TipField, TipFrame};
pub use wedge::{Face, Joint, Sector, Wedge};
