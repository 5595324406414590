//! Eigenvalues of the single layer matrix V over the size of the body: with log(1/r) in the kernel, a number that depends
//! on the unit of length, V is singular at two degenerate sizes and indefinite beyond; with log(L/r) and L the diameter
//! it is positive at every size.
//!
//! V depends on L through the constants alone: V_L = V_d + c_V κ log(L/d) B Bᵀ, d the diameter and B the moments of the
//! two unit vectors. With γ the eigenvalues of Bᵀ V_d⁻¹ B, which no size changes, V_L is singular where
//! 1 + c_V κ log(L/d) γ = 0: for L = 1 at the diameters d = exp(1/(c_V κ γ)).
//!
//! Eigenvalues belong to V with rows and columns divided by the square roots of the diagonal of V_d: dimensionless
//! numbers of the same signs, which do not become small with the elements.
//!
//! Source: Steinbach (2004).

use faer::Mat;
use steklov_algebra::{Cholesky, symmetric_eigenvalues};
use steklov_bem_operators::{BemError, Mesh, Operators, Polygon, Space};
use steklov_elastic::Material;
use steklov_problem::Scene;

use crate::table::Column;
use crate::watch::Watch;

/// Approximate largest number of traction unknowns of the mesh; a body with many edges gets fewer layers at its
/// corners.
const UNKNOWNS: usize = 720;
/// Ratio of the layers; degrees rise by one from each to the next.
const RATIO: f64 = 0.15;
/// Largest number of layers, which gives degenerate sizes to eight digits.
const LAYERS: usize = 8;

/// Diameters: `PER_OCTAVE` per octave, for `OCTAVES` octaves on either side of the first degenerate diameter.
const PER_OCTAVE: i32 = 6;
const OCTAVES: i32 = 3;

/// The matrix at one size of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum {
    /// Diameter d of the body, in its unit of length.
    pub diameter: f64,
    /// The two smallest eigenvalues of the scaled V for L = 1.
    pub unit: [f64; 2],
    /// The smallest eigenvalue for L = d.
    pub own: f64,
}

/// Eigenvalues over the size of a body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SingleLayer {
    /// Elements of its mesh, graded towards all corners.
    pub elements: usize,
    /// Traction unknowns.
    pub unknowns: usize,
    /// Diameter of the scene's own body.
    pub diameter: f64,
    /// Diameters at which V is singular for L = 1, rising.
    pub degenerate: [f64; 2],
    /// Bodies of the same shape, diameters rising.
    pub points: Vec<Spectrum>,
}

/// Columns of the sizes.
pub(super) const SPECTRA: [Column<Spectrum>; 4] = [
    ("diameter", "length", "diameter d of the body", |s| s.diameter),
    ("smallest_unit", "1", "smallest eigenvalue of the scaled V for L = 1", |s| s.unit[0]),
    ("second_unit", "1", "the second smallest for L = 1", |s| s.unit[1]),
    ("smallest_diameter", "1", "smallest eigenvalue of the scaled V for L = d", |s| s.own),
];

impl SingleLayer {
    /// Range of the smallest eigenvalue for L = d over all sizes: two equal numbers up to rounding.
    pub fn own(&self) -> [f64; 2] {
        self.points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], p| [a.min(p.own), b.max(p.own)])
    }
}

/// Eigenvalues for bodies of the scene's shape and material. After a request to stop no more sizes are done.
///
/// # Errors
/// [`BemError::SingleLayerIndefinite`] if V is not positive definite for L = d: too many digits are lost.
pub fn single_layer(scene: &Scene, watch: &mut Watch<'_>) -> Result<SingleLayer, BemError> {
    let what = "single layer";
    watch.tell(what, "degenerate sizes");
    let mesh = mesh(&scene.problem.outline);
    let space = Space::new(&mesh);
    let degenerate = degenerate(&mesh, &space, &scene.body().material())?;
    let (elements, unknowns, diameter) = (mesh.len(), space.dofs(), mesh.diameter());
    let mut all = SingleLayer { elements, unknowns, diameter, degenerate, points: Vec::new() };
    for d in diameters(degenerate) {
        if watch.stopped() {
            break;
        }
        watch.tell(what, &format!("diameter {d:.3e}"));
        let (unit, own) = smallest(&scaled(&mesh, d / diameter), &scene.body().material())?;
        all.points.push(Spectrum { diameter: d, unit, own });
    }
    Ok(all)
}

/// A mesh graded towards all corners, as far as the number of unknowns and the shortest edges allow.
fn mesh(polygon: &Polygon) -> Mesh {
    let edges = polygon.edges().len();
    // an edge has a corner at both ends, and two unknowns per degree
    let unknowns = |layers: usize| 2 * edges * (layers + 1) * (layers + 2);
    let layers = (0..LAYERS).take_while(|layers| unknowns(layers + 1) <= UNKNOWNS).count();
    let corners: Vec<(usize, f64)> = (0..edges).map(|k| (k, 0.0)).collect();
    let graded = Mesh::graded(polygon, &corners, layers, RATIO, |layer| 1 + layer);
    graded.unwrap_or_else(|_| Mesh::uniform(polygon, edges, 1))
}

/// The same mesh of a larger body.
fn scaled(mesh: &Mesh, factor: f64) -> Mesh {
    let mut mesh = mesh.clone();
    mesh.vertices.iter_mut().flatten().for_each(|x| *x *= factor);
    mesh
}

/// Some diameters in each octave, and some close to the degenerate ones.
fn diameters(degenerate: [f64; 2]) -> Vec<f64> {
    let steps = PER_OCTAVE * OCTAVES;
    let around = |k: i32| degenerate[0] * 2f64.powf((f64::from(k) + 0.5) / f64::from(PER_OCTAVE));
    let mut all: Vec<f64> = (-steps..steps).map(around).collect();
    for d in degenerate {
        all.extend([1, 2, 3, 4].into_iter().flat_map(|j| [d * (1.0 - 0.1f64.powi(j)), d * (1.0 + 0.1f64.powi(j))]));
    }
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| *a - *b < 1e-7 * *b);
    all
}

/// The two smallest eigenvalues of the scaled V for L = 1, and the smallest for L = d.
fn smallest(mesh: &Mesh, material: &Material) -> Result<([f64; 2], f64), BemError> {
    let space = Space::new(mesh);
    let assemble = |length| Operators::assemble(mesh, &space, material, length).map(|o| o.v);
    let (own, unit) = (assemble(None)?, assemble(Some(1.0))?);
    let values = |v: &Mat<f64>| {
        let scaled = Mat::from_fn(v.nrows(), v.ncols(), |i, j| v[(i, j)] / (own[(i, i)] * own[(j, j)]).sqrt());
        // a decomposition that fails leaves the size unknown
        symmetric_eigenvalues(scaled.as_ref()).map_or([f64::NAN; 2], |values| [values[0], values[1]])
    };
    Ok((values(&unit), values(&own)[0]))
}

/// The diameters exp(1/(c_V κ γ)) at which V is singular for L = 1, rising.
fn degenerate(mesh: &Mesh, space: &Space, material: &Material) -> Result<[f64; 2], BemError> {
    let operators = Operators::assemble(mesh, space, material, None)?;
    let mut moments = Mat::zeros(space.dofs(), 2);
    for e in 0..mesh.len() {
        for i in 0..2 {
            moments[(2 * space.offset[e] + i, i)] = mesh.length(e);
        }
    }
    let factor = Cholesky::new(operators.v.as_ref()).map_err(|pivot| {
        let (size, length, diameter) = (space.dofs(), operators.length, operators.diameter);
        BemError::SingleLayerIndefinite { pivot, size, length, diameter }
    })?;
    let c = moments.transpose() * factor.solve(moments.as_ref());
    let (mean, half) = ((c[(0, 0)] + c[(1, 1)]) / 2.0, (c[(0, 0)] - c[(1, 1)]) / 2.0);
    let radius = half.hypot((c[(0, 1)] + c[(1, 0)]) / 2.0);
    let c_v = 1.0 / (8.0 * std::f64::consts::PI * material.mu() * (1.0 - material.nu()));
    Ok([mean + radius, mean - radius].map(|gamma| (1.0 / (c_v * material.kappa() * gamma)).exp()))
}

#[cfg(test)]
mod tests {
    use steklov_bem_operators::Loop;
    use steklov_elastic::Plane;

    use super::*;

    fn polygon(corners: &[[f64; 2]]) -> Polygon {
        let named = Loop::straight(corners.to_vec(), vec!["side".into(); corners.len()]);
        Polygon::new(named, Vec::new()).unwrap()
    }

    fn found(polygon: &Polygon, poisson: f64) -> [f64; 2] {
        let mesh = mesh(polygon);
        degenerate(&mesh, &Space::new(&mesh), &Material::new(7.0, poisson, Plane::Strain).unwrap()).unwrap()
    }

    /// Values of root finding in a prototype on graded meshes: side 2.21318821 of a square, twice; 2.3124252 and
    /// 2.5038137 of an L.
    #[test]
    fn degenerate_sizes_are_those_of_root_finding() {
        let square = polygon(&[[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]]);
        for d in found(&square, 0.3) {
            println!("square {:.9}", d / 2f64.sqrt());
            assert!((d / 2f64.sqrt() / 2.21318821 - 1.0).abs() < 5e-9, "{d}");
        }
        let l = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.5], [0.5, 1.0], [0.0, 1.0]];
        let found = found(&polygon(&l), 0.3);
        let diameter = 2f64.sqrt(); // from corner (1, 0) to (0, 1)
        for (d, side) in found.into_iter().zip([2.3124252, 2.5038137]) {
            println!("L {:.9}", d / diameter);
            assert!((d / diameter / side - 1.0).abs() < 5e-8, "{d} for {side}");
        }
    }

    /// A circle of radius R: V c = R/(4μ(1-ν)) (½ - κ ln R) c = 0 at R = exp(1/(2κ)); polygons tend to it.
    #[test]
    fn degenerate_sizes_of_a_circle() {
        for poisson in [0.0, 0.3, 0.49] {
            let kappa = 3.0 - 4.0 * poisson;
            let off = [64, 128].map(|n| {
                let angles = (0..n).map(|k| std::f64::consts::TAU * f64::from(k) / f64::from(n));
                let corners: Vec<[f64; 2]> = angles.map(|t| [t.cos(), t.sin()]).collect();
                let [a, b] = found(&polygon(&corners), poisson);
                assert!((a / b - 1.0).abs() < 1e-10);
                a / (2.0 * (0.5 / kappa).exp()) - 1.0
            });
            // an inscribed polygon is smaller than its circle by O(1/n²)
            println!("ν = {poisson}: {off:?}");
            assert!(off[1] > 0.0 && off[1] < 1e-3 && (off[0] / off[1] - 4.0).abs() < 0.1, "{off:?}");
        }
    }

    /// The smallest eigenvalue changes its sign at the first degenerate size, the second at the other one.
    #[test]
    fn eigenvalues_change_sign_where_the_formula_says() {
        let kite = polygon(&[[0.0, 0.0], [1.0, -0.2], [2.0, 0.0], [1.0, 0.9]]);
        let material = Material::new(3.0, 0.2, Plane::Stress).unwrap();
        let mesh = mesh(&kite);
        let sizes = degenerate(&mesh, &Space::new(&mesh), &material).unwrap();
        assert!(sizes[1] > 1.001 * sizes[0], "{sizes:?}");
        let of = |d: f64| smallest(&scaled(&mesh, d / mesh.diameter()), &material).unwrap().0;
        for i in 0..2 {
            assert!(of(sizes[i] * (1.0 - 1e-7))[i] > 0.0 && of(sizes[i] * (1.0 + 1e-7))[i] < 0.0);
        }
    }

    #[test]
    fn sizes_rise_and_none_is_degenerate() {
        let all = diameters([3.0, 3.0]);
        assert!(all.windows(2).all(|d| d[0] < d[1]) && all.iter().all(|d| (d / 3.0 - 1.0).abs() > 9e-5));
        assert!(all[0] < 0.4 && all[all.len() - 1] > 22.0);
    }
}
