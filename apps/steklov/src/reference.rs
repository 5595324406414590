//! True errors: the distance to a solution on a mesh that contains both the mesh in question and a fine one.

use steklov_bem_operators::{Mark, Mesh, PairCache, Piece, Space, Subdivision};
use steklov_quadrature::legendre_p;

use crate::scene::Scene;
use crate::solve::{SolveError, Solved, solve};

/// Vertices of the fine mesh closer to one of the mesh in question than this (edge parameter) are left out.
const CLOSE: f64 = 1e-7;

/// True error of a solved mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueError {
    /// ⟨S e, e⟩^½ of e = u_h - u, with u and S of the reference mesh.
    pub error: f64,
    /// ⟨S u, u⟩^½.
    pub norm: f64,
    /// J of the reference mesh.
    pub energy: f64,
    /// Displacement unknowns of the reference mesh.
    pub dofs: usize,
}

/// The true error of a nodal displacement on a mesh, measured on the common refinement with `fine`, each element with one
/// degree more than the higher of the two.
///
/// # Errors
/// As [`solve`].
pub fn true_error(
    scene: &Scene,
    mesh: &Mesh,
    displacement: &[f64],
    fine: &Subdivision,
) -> Result<TrueError, SolveError> {
    let coarse = Subdivision::new(mesh, &vec![Mark::Keep; mesh.len()]);
    let union = common_refinement(&coarse, fine).mesh(&scene.polygon)?;
    let (reference, factors) = solve(scene, union, &mut PairCache::default(), &mut |_| Ok(()))?;
    let prolonged = prolong(mesh, displacement, &reference);
    let mut difference: Vec<f64> = prolonged.iter().zip(&reference.displacement).map(|(a, b)| a - b).collect();
    // rigid motions that nothing resists are no error
    let mut motions: Vec<Vec<f64>> = Vec::new();
    for motion in &reference.free_motions {
        let mut r = motion.nodal(&reference.space.points);
        motions.iter().for_each(|other| remove(&mut r, other));
        let norm = dot(&r, &r).sqrt();
        r.iter_mut().for_each(|v| *v /= norm);
        motions.push(r);
    }
    motions.iter().for_each(|r| remove(&mut difference, r));
    let stiff = factors.condensation.multiply(&difference);
    Ok(TrueError {
        error: dot(&difference, &stiff).max(0.0).sqrt(),
        norm: (2.0 * reference.energies.strain).max(0.0).sqrt(),
        energy: reference.energies.total,
        dofs: reference.space.dofs(),
    })
}

/// The vertices of both, those of `fine` next to one of `coarse` left out.
fn common_refinement(coarse: &Subdivision, fine: &Subdivision) -> Subdivision {
    let edges = coarse.edges.iter().zip(&fine.edges).map(|(a, b)| {
        let mut knots: Vec<f64> = a.iter().map(|p| p.start).chain([1.0]).collect();
        let extra = b.iter().map(|p| p.start).filter(|s| a.iter().all(|p| (p.start - s).abs() > CLOSE));
        knots.extend(extra.filter(|s| *s < 1.0 - CLOSE));
        knots.sort_by(f64::total_cmp);
        let degree_at =
            |pieces: &[Piece], s: f64| pieces.iter().find(|p| p.start <= s && s < p.end).map_or(1, |p| p.degree);
        let pieces = knots.windows(2).map(|k| {
            let middle = (k[0] + k[1]) / 2.0;
            let degree = degree_at(a, middle).max(degree_at(b, middle)) + 1;
            Piece { start: k[0], end: k[1], degree, mark: Mark::Keep }
        });
        pieces.collect()
    });
    Subdivision { edges: edges.collect() }
}

/// The nodal values, on the reference's nodes, of a displacement on a mesh that the reference refines.
fn prolong(mesh: &Mesh, displacement: &[f64], reference: &Solved) -> Vec<f64> {
    let space = Space::new(mesh);
    let (fine, nodes) = (&reference.mesh, &reference.space);
    let mut values = vec![0.0; nodes.dofs()];
    for e in 0..fine.len() {
        let [a, b] = fine.span[e];
        let middle = (a + b) / 2.0;
        let contains = |c: &usize| {
            let [s0, s1] = mesh.span[*c];
            mesh.edge[*c] == fine.edge[e] && s0.min(s1) <= middle && middle <= s0.max(s1)
        };
        let Some(c) = (0..mesh.len()).find(contains) else { continue };
        let [s0, s1] = mesh.span[c];
        // reference coordinates of both ends within the coarse element, from the nearer of its ends
        let place = |s: f64| {
            if (s - s0).abs() < (s - s1).abs() {
                -1.0 + 2.0 * (s - s0) / (s1 - s0)
            } else {
                1.0 - 2.0 * (s1 - s) / (s1 - s0)
            }
        };
        let (t0, t1) = (place(a), place(b));
        let basis = space.basis(c);
        let mut legendre = vec![0.0; basis.degree + 1];
        for (j, node) in nodes.element_nodes(e).enumerate() {
            let x = nodes.basis(e).nodes[j];
            let t = (t0 * (1.0 - x) / 2.0 + t1 * (1.0 + x) / 2.0).clamp(-1.0, 1.0);
            legendre_p(t, &mut legendre);
            let mut sum = [0.0; 2];
            for (k, coarse) in space.element_nodes(c).enumerate() {
                let phi: f64 = (0..=basis.degree).map(|n| legendre[n] * basis.to_legendre[(n, k)]).sum();
                sum = [sum[0] + phi * displacement[2 * coarse], sum[1] + phi * displacement[2 * coarse + 1]];
            }
            values[2 * node..2 * node + 2].copy_from_slice(&sum);
        }
    }
    values
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn remove(v: &mut [f64], unit: &[f64]) {
    let part = dot(v, unit);
    v.iter_mut().zip(unit).for_each(|(v, u)| *v -= part * u);
}
