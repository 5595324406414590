//! From the points of the trace to the nodes of the boundary elements.

use faer::Mat;
use sprs::{CsMat, TriMat};
use steklov_algebra::Fault;
use steklov_bem_operators::{Mesh, Space};
use steklov_elastic::plane::{cross, distance, dot, minus};
use steklov_quadrature::{gauss_legendre, legendre_p};

use crate::dense::Definite;
use crate::{CouplingError, Trace};

/// Points within this part of an element's length are one.
const SAME: f64 = 1e-9;

/// The trace in the displacement space of the boundary elements, and its moments against their tractions.
#[derive(Debug, Clone)]
pub struct Transfer {
    /// Π: displacement of the boundary elements × unknowns of the trace (dimensionless; by columns). The values at the nodes
    /// where the trace is linear on each element; else the L² projection.
    pub projection: CsMat<f64>,
    /// B = ∫ ψ·v: tractions of the boundary elements × unknowns of the trace (length; by columns).
    pub mass: CsMat<f64>,
}

/// A part of an element between two points of the trace.
pub(crate) struct Overlap {
    /// The first of both points.
    pub point: usize,
    /// Reference coordinates of both points on the element; they may lie outside of it.
    ends: [f64; 2],
    /// The part, in reference coordinates.
    pub span: [f64; 2],
}

impl Overlap {
    /// Values of the two linear functions.
    pub fn hats(&self, t: f64) -> [f64; 2] {
        let s = (t - self.ends[0]) / (self.ends[1] - self.ends[0]);
        [1.0 - s, s]
    }
}

impl Transfer {
    /// Finds where the elements lie on the trace.
    ///
    /// # Errors
    /// [`CouplingError::Boundary`] unless mesh and trace are the same curve in the same direction.
    pub fn new(trace: &Trace, mesh: &Mesh, space: &Space) -> Result<Self, CouplingError> {
        let overlaps: Vec<Vec<Overlap>> =
            (0..mesh.len()).map(|e| overlaps(trace, mesh, e)).collect::<Result<_, _>>()?;
        let count = trace.points.len();
        let length: f64 = (0..mesh.len()).map(|e| mesh.length(e)).sum();
        let whole: f64 = (0..count).map(|k| distance(trace.points[k], trace.points[(k + 1) % count])).sum();
        if (length - whole).abs() > 1e-6 * whole {
            let what = format!("they have the length {length}, and the outer boundary has {whole}");
            return Err(CouplingError::Boundary { what });
        }
        let nested = overlaps.iter().all(|parts| parts.len() == 1);
        let nodal = if nested { interpolation(&overlaps, space, count) } else { l2(&overlaps, mesh, space, count)? };
        let moments = moments(&overlaps, mesh, space, count);
        let both = |scalar: CsMat<f64>| (&components(&scalar) * &trace.values).to_csc();
        Ok(Self { projection: both(nodal), mass: both(moments) })
    }
}

/// Parts of element e between points of the trace.
pub(crate) fn overlaps(trace: &Trace, mesh: &Mesh, e: usize) -> Result<Vec<Overlap>, CouplingError> {
    let ([a, b], length) = (mesh.ends(e), mesh.length(e));
    let d = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
    let count = trace.points.len();
    // along the element from -1 to 1, and across in parts of its length
    let place = |x: [f64; 2]| {
        let r = minus(x, a);
        let along = dot(r, d) / length;
        (2.0 * along - 1.0, cross(d, r) / length)
    };
    let snapped = |t: f64| if (t.abs() - 1.0).abs() < SAME { t.signum() } else { t };
    let mut found = Vec::new();
    for point in 0..count {
        let ends = [trace.points[point], trace.points[(point + 1) % count]].map(place);
        let near = ends.iter().all(|(along, across)| across.abs() < SAME * along.abs().max(1.0));
        let ends = ends.map(|(along, _)| snapped(along));
        let span = [ends[0].max(-1.0), ends[1].min(1.0)];
        if near && span[1] - span[0] > SAME {
            found.push(Overlap { point, ends, span });
        }
    }
    let covered: f64 = found.iter().map(|o| o.span[1] - o.span[0]).sum();
    if (covered - 2.0).abs() > 1e-6 {
        let what = format!(
            "element {e} from ({}, {}) to ({}, {}) is on it by {:.3} only",
            a[0],
            a[1],
            b[0],
            b[1],
            covered / 2.0
        );
        return Err(CouplingError::Boundary { what });
    }
    Ok(found)
}

/// Values at the nodes, where each element has one part.
fn interpolation(overlaps: &[Vec<Overlap>], space: &Space, count: usize) -> CsMat<f64> {
    let mut values = TriMat::new((space.nodes(), count));
    for (e, parts) in overlaps.iter().enumerate() {
        // the end belongs to the next element
        for (j, node) in space.element_nodes(e).take(space.degree(e)).enumerate() {
            let hats = parts[0].hats(space.basis(e).nodes[j]);
            for (hat, point) in hats.into_iter().zip([parts[0].point, (parts[0].point + 1) % count]) {
                if hat != 0.0 {
                    values.add_triplet(node, point, hat);
                }
            }
        }
    }
    values.to_csr()
}

/// Calls back with each element, its part, reference coordinate and weight (length) of a rule that is exact for degree p + 1.
fn integrate(overlaps: &[Vec<Overlap>], mesh: &Mesh, space: &Space, mut at: impl FnMut(usize, &Overlap, f64, f64)) {
    for (e, parts) in overlaps.iter().enumerate() {
        let rule = gauss_legendre(space.degree(e) / 2 + 2);
        for part in parts {
            let half = (part.span[1] - part.span[0]) / 2.0;
            let middle = (part.span[1] + part.span[0]) / 2.0;
            for (&s, w) in rule.points.iter().zip(&rule.weights) {
                at(e, part, middle + half * s, w * half * mesh.speed(e, middle + half * s));
            }
        }
    }
}

/// The projection in L².
fn l2(overlaps: &[Vec<Overlap>], mesh: &Mesh, space: &Space, count: usize) -> Result<CsMat<f64>, Fault> {
    let n = space.nodes();
    let mut right = Mat::<f64>::zeros(n, count);
    let mut phi = vec![0.0; Mesh::MAX_DEGREE + 1];
    integrate(overlaps, mesh, space, |e, part, t, weight| {
        let phi = &mut phi[..space.degree(e) + 1];
        space.basis(e).evaluate(t, phi);
        for (hat, point) in part.hats(t).into_iter().zip([part.point, (part.point + 1) % count]) {
            for (node, phi) in space.element_nodes(e).zip(&*phi) {
                right[(node, point)] += weight * phi * hat;
            }
        }
    });
    let mut mass = Mat::<f64>::zeros(n, n);
    for e in 0..mesh.len() {
        let p = space.degree(e);
        let rule = gauss_legendre(p + 1);
        for (&t, w) in rule.points.iter().zip(&rule.weights) {
            let phi = &mut phi[..p + 1];
            space.basis(e).evaluate(t, phi);
            for (i, a) in space.element_nodes(e).enumerate() {
                for (j, b) in space.element_nodes(e).enumerate() {
                    mass[(a, b)] += w * mesh.speed(e, t) * phi[i] * phi[j];
                }
            }
        }
    }
    let projection = Definite::new(mass)?
        .and_then(|factor| factor.solve(right))
        .unwrap_or_else(|| unreachable!("elements have a length: the mass matrix is definite"));
    let mut values = TriMat::new((n, count));
    for point in 0..count {
        (0..n).for_each(|node| values.add_triplet(node, point, projection[(node, point)]));
    }
    Ok(values.to_csr())
}

/// Moments of the linear functions against Legendre polynomials.
fn moments(overlaps: &[Vec<Overlap>], mesh: &Mesh, space: &Space, count: usize) -> CsMat<f64> {
    let mut values = TriMat::new((space.nodes(), count));
    let mut p = vec![0.0; Mesh::MAX_DEGREE];
    integrate(overlaps, mesh, space, |e, part, t, weight| {
        let p = &mut p[..space.degree(e)];
        legendre_p(t, p);
        for (hat, point) in part.hats(t).into_iter().zip([part.point, (part.point + 1) % count]) {
            for (m, p) in p.iter().enumerate() {
                values.add_triplet(space.offset[e] + m, point, weight * p * hat);
            }
        }
    });
    values.to_csr()
}

/// The same for both components, interleaved.
fn components(scalar: &CsMat<f64>) -> CsMat<f64> {
    let mut values = TriMat::new((2 * scalar.rows(), 2 * scalar.cols()));
    for (&value, (row, column)) in scalar {
        (0..2).for_each(|i| values.add_triplet(2 * row + i, 2 * column + i, value));
    }
    values.to_csr()
}
