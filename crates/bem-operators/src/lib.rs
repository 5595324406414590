//! hp boundary elements of two-dimensional linear elasticity.
//!
//! ```text
//! Polygon ─► Mesh ─► Space ─┐
//!                 Material ─┴─► moments ─► Operators (V, K, W, M) ─► Steklov (S) ─► Condensation ─► displacement
//!                                                                        └─► traction ─► BoundaryField (inside, traces)
//! ```
//! A [`Polygon`] (with holes, or the plane around holes; its edges may be arcs, ellipses or Bézier curves) is cut into a [`Mesh`]
//! of elements with a polynomial degree each. The [`Space`] numbers the unknowns: displacement, continuous of degree p at Gauss-Lobatto points, and
//! traction, discontinuous of degree p-1 in Legendre coefficients. [`Operators::assemble`] computes for every unordered
//! pair of elements one complex table of moments of Legendre functions of the second kind, and from it V, K and W at once.
//! [`Steklov`] is the symmetric Steklov-Poincaré matrix, [`Condensation`] eliminates what is neither held nor kept.
//!
//! Conventions: the boundary is traversed with the body to the left (outer loop counter-clockwise, holes clockwise);
//! n points out of the body, the tangent is n turned by +90°; points are `[f64; 2]`; nodal fields are interleaved x, y;
//! plane strain unless [`steklov_elastic::Plane::Stress`] is chosen; everything is per unit thickness.
//!
//! ```
//! use steklov_bem_operators::steklov_elastic::{Material, Plane};
//! use steklov_bem_operators::{Domain, Loop, Mesh, Operators, Polygon, Space, Steklov};
//!
//! // a rectangle of 2 by 1, each side cut into elements of degree 2
//! let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
//! let polygon = Polygon::new(Loop::straight(corners, vec!["all".to_owned(); 4]), vec![])?;
//! let mesh = Mesh::uniform(&polygon, 6, 2);
//! let space = Space::new(&mesh);
//! let material = Material::new(70e3, 0.33, Plane::Stress)?;
//! let steklov = Steklov::new(Operators::assemble(&mesh, &space, &material, None)?, Domain::Interior)?;
//!
//! // stretched along x by 1e-3: twice the strain energy is σ_xx ε_xx times the area, whatever the mesh
//! let u = space.interpolate(|[x, _]| [1e-3 * x, 0.0]);
//! let twice: f64 = (0..u.len()).map(|i| u[i] * (0..u.len()).map(|j| steklov.matrix[(i, j)] * u[j]).sum::<f64>()).sum();
//! let stress = material.stress([[1e-3, 0.0], [0.0, 0.0]]);
//! assert!((twice / (stress[0] * 1e-3 * 2.0) - 1.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod cut;
mod edge;
mod edge_check;
mod edge_queries;
mod plan_cuts;
mod cut_lines;
mod continuation;
mod polygon;
mod polygon_check;
mod predicates;
mod mesh;
mod meshing;
mod space;
mod subdivision;
mod subdomains;
mod translates;
mod marking;
mod moments;
mod near;
mod curve;
mod inner;
mod curved_pair;
mod far;
mod far_curved;
mod far_potential;
mod fronts;
mod kernel;
mod local_functions;
mod pass;
mod columns;
mod assemble;
mod assembly;
mod skeleton;
mod blocks;
mod cache;
mod enrichment;
mod steklov;
mod enriched;
mod raised;
mod condense;
mod load;
mod potential;
mod functional;
mod trace_rows;
mod particular;
mod residual;

#[cfg(feature = "proptest")]
pub mod proptest;

// the crates whose types appear in the interface
pub use {faer, num_complex, sprs, steklov_algebra, steklov_elastic, steklov_quadrature};

pub use assemble::Operators;
pub use assembly::{AssembledLoad, Assembly, Relative, order_of_rows, relative_displacement};
pub use cache::PairCache;
pub use condense::{Condensation, CondensationParts, CondensedLoad, Partition};
pub use continuation::{Continuation, continued_radius};
pub use curve::{CircularArc, Curve, PolynomialCurve, Shape};
pub use cut::{Cut, CutError};
pub use edge::{Edge, LARGEST_OPENING, Path};
pub use enriched::{Enriched, EnrichedSteklov};
pub use enrichment::{Bubbles, Enrichment};
pub use error::BemError;
pub use fronts::front_sizes;
pub use functional::Functional;
pub use load::{Datum, ElementMoments, Site, add_load, side_moments, side_moments_and_squares};
pub use marking::{doerfler, legendre_decay};
pub use mesh::{Mesh, edge_tangents};
pub use moments::{PairMoments, Segment, Tables};
pub use particular::ParticularSolution;
pub use plan_cuts::{CutPlan, CutRules};
pub use polygon::{Location, Loop, Polygon};
pub use polygon_check::{EdgeName, PolygonError};
pub use potential::{BoundaryField, Inside, Trace};
pub use predicates::distance_to_segment;
pub use raised::Raised;
pub use residual::{BoundaryResidual, Look, boundary_residuals, boundary_residuals_of, graded_panels, residual_panels};
pub use space::{Dof, Space};
pub use steklov::{Domain, Steklov, TractionMap, TractionParts, Translations};
pub use subdivision::{Grading, Mark, Piece, SAME_PLACE, Subdivision};
pub use subdomains::{CutElements, Cuts, Subdomain};
pub use trace_rows::steklov_trace_rows;
