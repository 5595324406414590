//! Residuals of a discrete solution in the contact conditions, element by element: the contact part of a residual error
//! indicator.
//!
//! With λ^hp the multiplier as a function ([`multiplier_trace`]), σ^h = S_hp u taken pointwise, h and p length and degree
//! of an element I, v⁺ = max(v, 0), v⁻ = min(v, 0), E Young's modulus, and for a stress and a displacement the energies
//!
//! ```text
//! |λ|² := h/(pE) λ²,     |u|² := (pE/h) u²          (force per thickness and length)
//!
//! contact         ∫ |λ^hp + σ^h|²
//! stabilisation   (1/p) ∫ |λ^hp + σ^h|², of stabilised multipliers only
//! tension         ∫ |λ_n⁻|²
//! penetration     ½ ∫ |w|² + |(h/p) w'|²,    w = (u_n - g)⁺
//! complementarity ∫ min(|λ_n⁺|², |(g - u_n)⁺|²)
//! bound           ∫ |(|λ_t| - F)⁺|²
//! friction        ∫ min(|(F - |λ_t|)⁺|², |u_t|²),  and 2 min(|λ_t|², |u_t|²) where λ_t u_t < 0
//! ```
//! with F = μ (λ_n^hp)⁺ under Coulomb's law. Each is an energy (force per thickness times length), local in place of norms of order ±½. By interpolation
//! ‖w‖²_½ ≤ ‖w‖ ‖w'‖ ≤ ½ ((p/h) ‖w‖² + (h/p) ‖w'‖²); the sum, unlike the product, sees a constant w, and the two parts
//! are of one size for a w that lives between the nodes of an element.
//!
//! Where one of two numbers must vanish, the smaller of the energies of making either vanish counts. It is at most the product
//! of the two, λ_n⁺ (g - u_n)⁺ say, which is the geometric mean of these energies and bounds the error too, but falls like
//! h^(p+1) (normal) and h^p (tangential) only, not h^(2p+1), where gap or bound are no polynomials, and it has no digits if
//! the bound exceeds all shears.

use std::ops::Range;

use rayon::prelude::*;
use steklov_bem_operators::{BoundaryField, Datum, Look, Mesh, ParticularSolution, Site, Space};
use steklov_elastic::plane::dot;
use steklov_quadrature::{gauss_legendre, project};

use crate::on_mesh::multiplier_space::MultiplierCell;
use crate::{ContactBoundary, ContactError, MultiplierSpace, SideData, multiplier_trace};

/// Squared residuals of one contact element (energy: force per thickness times length).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactResidual {
    /// The element.
    pub element: usize,
    /// Multiplier against traction.
    pub contact: f64,
    /// The same once more over p, of stabilised multipliers; 0 of biorthogonal ones.
    pub stabilisation: f64,
    /// Pressure where the gap is open.
    pub complementarity: f64,
    /// Negative pressure.
    pub tension: f64,
    /// Overlap.
    pub penetration: f64,
    /// Shear beyond the friction bound.
    pub bound: f64,
    /// Slip where the shear is below the bound, and slip against the shear.
    pub friction: f64,
}

impl ContactResidual {
    /// Sum of the terms.
    pub fn total(&self) -> f64 {
        self.contact
            + self.stabilisation
            + self.complementarity
            + self.tension
            + self.penetration
            + self.bound
            + self.friction
    }
}

/// A discrete multiplier.
#[derive(Clone, Copy)]
pub enum Multiplier<'a> {
    /// Nodes and conditions, and `[λ_n, λ_t]` of all conditions in the order of the nodes.
    Biorthogonal(&'a ContactBoundary, &'a [[f64; 2]]),
    /// The space, and `[λ_n, λ_t]` at its nodes.
    Stabilised(&'a MultiplierSpace, &'a [[f64; 2]]),
}

/// A discrete solution of a contact problem.
#[derive(Clone, Copy)]
pub struct ContactSolution<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Its unknowns.
    pub space: &'a Space,
    /// Nodal displacement, interleaved x, y.
    pub displacement: &'a [f64],
    /// The multiplier as a function.
    pub multiplier: Multiplier<'a>,
    /// The elastic field without the particular solution of a body force.
    pub field: &'a BoundaryField,
    /// That particular solution.
    pub body_force: Option<&'a ParticularSolution>,
}

/// Residuals of the elements of the given contact sides, in the order of the mesh.
///
/// To be added to [`steklov_bem_operators::boundary_residuals`] of the same elements (with no prescribed traction there).
///
/// *Use when* an indicator is needed that has no unknowns of higher degree and names the violated condition. *Fails when* data
/// are rough on the scale of an element: kinks that a datum names are cut at, others are integrated to about 10 %. *Cost*:
/// points × elements of the whole boundary, for each contact element. Parallel over elements, the same bits for any number of
/// threads.
///
/// # Errors
/// [`ContactError::Data`] where a gap or bound is not finite.
///
/// Source: Banz, Gimperlein, Issaoui and Stephan, Numer. Math. 135 (2017), with products in place of the lesser energies;
/// Issaoui (2014), theorems 2.6 (biorthogonal) and 3.5 (stabilised).
pub fn contact_residuals(
    solution: &ContactSolution<'_>,
    sides: &[SideData<'_>],
) -> Result<Vec<ContactResidual>, ContactError> {
    contact_residuals_of(solution, sides, 0..solution.mesh.len(), Look::Close)
}

/// [`contact_residuals`] of some elements, with the accuracy of `look`.
///
/// # Errors
/// As [`contact_residuals`].
pub fn contact_residuals_of(
    solution: &ContactSolution<'_>,
    sides: &[SideData<'_>],
    elements: Range<usize>,
    look: Look,
) -> Result<Vec<ContactResidual>, ContactError> {
    let mesh = solution.mesh;
    let data = |e: usize| sides.iter().find(|s| s.side == mesh.side[e]).map(|s| (e, s));
    let elements: Vec<_> = elements.filter_map(data).collect();
    let all: Vec<_> = elements.par_iter().map(|&(e, data)| element_residual(solution, data, look, e)).collect();
    all.into_iter().collect()
}

/// A point of a contact element.
struct Sample {
    /// Quadrature weight (length).
    weight: f64,
    /// u_n - g and its derivative by arc length.
    overlap: f64,
    overlap_slope: f64,
    /// u_t.
    slip: f64,
    /// λ_n, λ_t.
    multiplier: [f64; 2],
    /// σ(u)n along n and t.
    traction: [f64; 2],
    /// F.
    bound: f64,
}

impl ContactResidual {
    /// `scale` is h/p.
    fn add(&mut self, at: &Sample, scale: f64, young: f64) {
        let stress = |s: f64| at.weight * scale / young * s * s;
        let length = |u: f64| at.weight * young / scale * u * u;
        let [pressure, shear] = at.multiplier;
        let missing = (at.bound - shear.abs()).max(0.0);
        self.contact += stress(pressure + at.traction[0]) + stress(shear + at.traction[1]);
        self.tension += stress(pressure.min(0.0));
        self.complementarity += stress(pressure.max(0.0)).min(length(at.overlap.min(0.0)));
        if at.overlap > 0.0 {
            self.penetration += 0.5 * (length(at.overlap) + length(scale * at.overlap_slope));
        }
        self.bound += stress((shear.abs() - at.bound).max(0.0));
        self.friction += stress(missing).min(length(at.slip));
        if shear * at.slip < 0.0 {
            self.friction += 2.0 * stress(shear).min(length(at.slip));
        }
    }
}

/// u_n, u_t, λ_n, λ_t at the nodes of an element; for a curved element the vectors u and λ, since normals differ from node to
/// node.
fn nodal_traces(solution: &ContactSolution<'_>, e: usize, lambda: &[[f64; 2]]) -> Vec<[f64; 4]> {
    let ContactSolution { mesh, space, displacement, .. } = *solution;
    let nodes = space.element_nodes(e).map(|i| [displacement[2 * i], displacement[2 * i + 1]]);
    let components = |((u, l), &t): (([f64; 2], &[f64; 2]), &f64)| {
        let place = if mesh.is_line(e) { 0.0 } else { t };
        let [n, t] = [mesh.normal(e, place), mesh.tangent(e, place)];
        match mesh.is_line(e) {
            true => [dot(u, n), dot(u, t), l[0], l[1]],
            false => [u[0], u[1], l[0] * n[0] + l[1] * t[0], l[0] * n[1] + l[1] * t[1]],
        }
    };
    nodes.zip(lambda).zip(&space.basis(e).nodes).map(components).collect()
}

/// Where the data of an element or its stabilised multipliers have kinks or jumps, rising.
fn kinks(data: &SideData<'_>, mesh: &Mesh, e: usize, cells: &[MultiplierCell]) -> Vec<f64> {
    let mut kinks = (data.gap.kinks)(e);
    kinks.extend(data.bound.iter().chain(&data.coefficient).flat_map(|b| (b.kinks)(e)));
    kinks.extend(cells.iter().map(|c| c.span[0]));
    // one that rounding put beside an end or another one is there
    kinks.retain(|t| t.abs() < 1.0 - mesh.resolution(e));
    kinks.sort_by(f64::total_cmp);
    kinks.dedup_by(|b, a| *b - *a <= mesh.resolution(e));
    kinks
}

fn element_residual(
    solution: &ContactSolution<'_>,
    data: &SideData<'_>,
    look: Look,
    e: usize,
) -> Result<ContactResidual, ContactError> {
    let ContactSolution { mesh, space, .. } = *solution;
    let basis = space.basis(e);
    let frame = |t: f64| [mesh.normal(e, t), mesh.tangent(e, t)];
    let [normal, tangent] = frame(0.0);
    let scale = mesh.length(e) / basis.degree as f64;
    let lambda = match solution.multiplier {
        Multiplier::Biorthogonal(boundary, multipliers) => multiplier_trace(mesh, space, boundary, multipliers, e),
        Multiplier::Stabilised(..) => vec![[0.0; 2]; basis.degree + 1],
    };
    let cells = match solution.multiplier {
        Multiplier::Biorthogonal(..) => Vec::new(),
        Multiplier::Stabilised(multipliers, _) => multipliers.cells_of(mesh, e),
    };
    let at_point = |t: f64| match solution.multiplier {
        Multiplier::Biorthogonal(..) => None,
        Multiplier::Stabilised(multipliers, values) => {
            let cell = cells.iter().find(|c| t <= c.span[1])?;
            Some(multipliers.value(cell.multiplier, mesh.edge_parameter(e, t), values))
        }
    };
    let straight = mesh.is_line(e);
    let nodal = nodal_traces(solution, e, &lambda);
    let mut phi = vec![0.0; nodal.len()];
    let kinks = kinks(data, mesh, e, &cells);
    let mut residual = ContactResidual { element: e, ..ContactResidual::default() };
    for panel in look.panels(basis.degree, &kinks) {
        let mut samples = Vec::with_capacity(panel.len());
        for (&t, &w) in panel.points.iter().zip(&panel.weights) {
            let site = Site::new(mesh, e, t);
            let datum = |d: &Option<Datum<'_>>| d.map_or(Ok(0.0), |d| d.at(mesh, &site));
            basis.evaluate(t, &mut phi);
            let nodal = |k: usize| nodal.iter().zip(&phi).map(|(v, phi)| v[k] * phi).sum::<f64>();
            let [normal, tangent] = if straight { [normal, tangent] } else { frame(t) };
            let value = |k: usize| match straight {
                true => nodal(k),
                false => {
                    let direction = if k.is_multiple_of(2) { normal } else { tangent };
                    dot([nodal(k & 2), nodal((k & 2) + 1)], direction)
                }
            };
            let mut traction = solution.field.steklov_trace(e, t);
            if let Some(b) = solution.body_force {
                let particular = b.traction(site.point, normal);
                traction = [traction[0] + particular[0], traction[1] + particular[1]];
            }
            let multiplier = at_point(t).unwrap_or([value(2), value(3)]);
            samples.push(Sample {
                weight: w * mesh.speed(e, t),
                overlap: value(0) - data.gap.at(mesh, &site)?,
                overlap_slope: 0.0,
                slip: value(1),
                multiplier,
                traction: [dot(traction, normal), dot(traction, tangent)],
                bound: datum(&data.bound)? + datum(&data.coefficient)? * multiplier[0].max(0.0),
            });
        }
        let length: f64 = samples.iter().map(|s| s.weight).sum();
        let slopes = slopes(&samples.iter().map(|s| s.overlap).collect::<Vec<f64>>());
        for (sample, slope) in samples.iter_mut().zip(slopes) {
            sample.overlap_slope = slope * 2.0 / length;
            residual.add(sample, scale, solution.field.material().young);
        }
    }
    if matches!(solution.multiplier, Multiplier::Stabilised(..)) {
        residual.stabilisation = residual.contact / basis.degree as f64;
    }
    Ok(residual)
}

/// Derivative on [-1, 1] of the polynomial through values at the Gauss points, at these points.
fn slopes(values: &[f64]) -> Vec<f64> {
    let rule = gauss_legendre(values.len());
    let mut next = values.iter();
    let series = project(|_| *next.next().expect("one value for each point"), values.len() - 1, &rule);
    let derivative = series.derivative();
    rule.points.iter().map(|&x| derivative.eval(x)).collect()
}
