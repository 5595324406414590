//! Quadrature rules, Legendre functions of both kinds, and the nodal bases of the hp elements.
//!
//! Everything lives on the reference interval [-1,1] unless a name says otherwise; elements are mapped by
//! `y(t) = c + d t`. Nothing here knows meshes or elasticity.
//!
//! | wanted | item |
//! |---|---|
//! | smooth integrand | [`gauss_legendre`], [`gauss_jacobi`], [`gauss_lobatto`] |
//! | log or algebraic singularity at an end | [`graded`], [`graded_unit`], [`substituted`] |
//! | Legendre polynomials and series | [`legendre_p`], [`legendre_dp`], [`Series`], [`project`] |
//! | integrals of P_n against 1/(z-t), log(z-t) | [`legendre_q`], [`legendre_q_cut`], [`legendre_dq`], [`bernstein`] |
//! | displacement basis of an element | [`LobattoBasis`] |
//! | contact multiplier basis of an element | [`BiorthogonalBasis`] |
//! | random numbers by seed and index | [`splitmix64`], [`unit_uniform`] |
//!
//! Symbols: P_n, Q_n Legendre functions of the first and second kind, ϱ parameter of the Bernstein ellipse
//! |z-1| + |z+1| = ϱ + 1/ϱ, φ_j Lagrange basis at the Gauss-Lobatto points x_j, w_j their weights, ψ_i dual basis.
//!
//! ```
//! use steklov_quadrature::{gauss_legendre, legendre_q_at};
//! let rule = gauss_legendre(5);
//! assert_eq!(rule.degree, 9);
//! assert!((rule.integrate(|x| x.powi(8)) - 2.0 / 9.0).abs() < 1e-15);
//!
//! // ∫ P_1(t) / (3 - t) dt = 2 Q_1(3), by Gauss and in closed form
//! let mut q = [Default::default(); 2];
//! legendre_q_at(3.0.into(), &mut q);
//! let by_gauss = gauss_legendre(20).integrate(|t| t / (3.0 - t));
//! assert!((by_gauss - 2.0 * q[1].re).abs() < 1e-15);
//! ```

mod rule;
mod gauss;
mod graded;
mod legendre;
mod legendre_q;
mod lobatto;
mod biorthogonal;
mod splitmix64;
#[cfg(any(test, feature = "proptest"))]
pub mod proptest;

// the crates whose types appear in the interface
pub use {faer, num_complex};

pub use biorthogonal::BiorthogonalBasis;
pub use gauss::{gauss_jacobi, gauss_legendre, gauss_lobatto};
pub use graded::{End, graded, graded_unit, substituted};
pub use legendre::{Series, legendre_dp, legendre_p, project};
pub use legendre_q::{
    bernstein, legendre_dq, legendre_q, legendre_q_at, legendre_q_cut, legendre_q_cut_from, log_bernstein,
};
pub use lobatto::LobattoBasis;
pub use rule::Rule;
pub use splitmix64::{splitmix64, unit_uniform};
