//! How far bodies on grids are from equilibrium, by forces that are computed here: from displacements, moduli and the scene's
//! data, without the matrices and loads of the solver.

use steklov_bem_operators::{Mesh, Site};
use steklov_elastic::Plane;
use steklov_model::grid::GridSolved;
use steklov_problem::{Condition, Scene};
use steklov_quadrature::{gauss_legendre, legendre_p};

/// Elements of the boundary on which tractions are integrated, about, and points on each.
const ELEMENTS: usize = 256;
const POINTS: usize = 8;

/// The resultant of loads, reactions and the medium around the body, over the integral of their absolute values.
///
/// The medium's traction φ = σ(u_c)n pulls with ∮ φ.
pub fn unbalanced_forces(scene: &Scene, solved: &GridSolved) -> f64 {
    let (mut sum, mut scale) = ([0.0; 2], 0.0);
    let mut add = |force: [f64; 2]| {
        (0..2).for_each(|i| sum[i] += force[i]);
        scale += force[0].abs() + force[1].abs();
    };
    let rule = gauss_legendre(POINTS);
    let mesh = Mesh::uniform(&scene.problem.outline, ELEMENTS, 1);
    let outer = |e: usize| scene.problem.outline.edges()[mesh.edge[e]].loop_index == 0;
    for e in 0..mesh.len() {
        for (&t, w) in rule.points.iter().zip(&rule.weights) {
            let Site { s, point: [x, y], .. } = Site::new(&mesh, e, t);
            let [mut tx, mut ty] = match &scene.problem.sides[mesh.side[e]].condition {
                Condition::Traction(t) | Condition::Displacement { traction: Some(t), .. } => {
                    [t[0].eval(x, y, s), t[1].eval(x, y, s)]
                }
                Condition::Pressure(p) => mesh.normal(e, 0.0).map(|n| -n * p.eval(x, y, s)),
                _ => [0.0; 2],
            };
            if scene.problem.medium().is_some() && outer(e) {
                let jump = scene.traction_jump(mesh.edge[e], s, mesh.normal(e, 0.0));
                (tx, ty) = (tx + jump[0], ty + jump[1]);
            }
            add([tx, ty].map(|t| w * mesh.length(e) / 2.0 * t));
        }
    }
    let grid = &solved.body.grid;
    for cell in grid.body_cells() {
        let at = grid.lattice_point(grid.cell(cell));
        each_point(at, grid.spacing, |x, _, area| {
            add(scene.force_at(x).expect("a finite force").map(|b| area * b));
        });
    }
    solved.reactions.iter().for_each(|(_, force)| add(*force));
    if let Some(around) = &solved.around {
        for e in 0..around.mesh.len() {
            let mut p = vec![0.0; around.space.degree(e)];
            for (&t, w) in rule.points.iter().zip(&rule.weights) {
                legendre_p(t, &mut p);
                let coefficient = |m: usize, i: usize| around.traction[2 * (around.space.offset[e] + m) + i];
                let phi = [0, 1].map(|i| p.iter().enumerate().map(|(m, p)| p * coefficient(m, i)).sum::<f64>());
                add(phi.map(|phi| w * around.mesh.length(e) / 2.0 * phi));
            }
        }
    }
    sum[0].hypot(sum[1]) / scale
}

/// The largest force that is left at a node inside the body (of multiscale elements inside a coarse cell, where their basis
/// solves the equations), over the largest force of a cell on one of its nodes; none for a basis that does not conform, which
/// has several displacements where cells meet.
///
/// # Panics
/// If there is no such node.
pub fn unbalanced_nodes(scene: &Scene, solved: &GridSolved) -> Option<f64> {
    let body = &solved.body;
    if solved.coarse.as_ref().is_some_and(|coarse| !coarse.basis.is_conforming()) {
        return None;
    }
    let grid = &body.grid;
    let mut forces = vec![[0.0; 2]; grid.nodes()];
    let mut cells_at = vec![0; grid.nodes()];
    let mut largest = 0.0f64;
    for cell in grid.body_cells() {
        let u = body.cell_values(&solved.displacement, cell);
        let nodes = grid.cell_nodes(cell);
        let mut own = [[0.0; 2]; 4];
        each_point(grid.lattice_point(grid.cell(cell)), grid.spacing, |x, [xi, eta], area| {
            let hats = [(1.0 - xi) * (1.0 - eta), xi * (1.0 - eta), xi * eta, (1.0 - xi) * eta];
            let dx = [eta - 1.0, 1.0 - eta, eta, -eta].map(|d| d / grid.spacing[0]);
            let dy = [xi - 1.0, -xi, xi, 1.0 - xi].map(|d| d / grid.spacing[1]);
            let gradient = |i: usize, d: &[f64; 4]| (0..4).map(|a| d[a] * u[2 * a + i]).sum::<f64>();
            let nu = body.poisson().map_or(scene.body().material().poisson, |ratios| ratios[cell]);
            let [xx, yy, xy] = stress(
                scene,
                [body.young[cell], nu],
                [gradient(0, &dx), gradient(1, &dy), gradient(0, &dy) + gradient(1, &dx)],
            );
            let b = scene.force_at(x).expect("a finite force");
            for a in 0..4 {
                own[a][0] += area * (dx[a] * xx + dy[a] * xy - hats[a] * b[0]);
                own[a][1] += area * (dx[a] * xy + dy[a] * yy - hats[a] * b[1]);
            }
        });
        for (node, own) in nodes.into_iter().zip(own) {
            largest = largest.max(own[0].abs()).max(own[1].abs());
            (0..2).for_each(|i| forces[node][i] += own[i]);
            cells_at[node] += 1;
        }
    }
    let mut inside: Vec<bool> = cells_at.iter().map(|&cells| cells == 4).collect();
    for cell in solved.coarse.iter().flat_map(|coarse| &coarse.mesh.cells) {
        let ([i, j], [m, n]) = (cell.first, cell.size);
        for (i, j) in (i..=i + m).flat_map(|k| (j..=j + n).map(move |l| (k, l))) {
            let edge =
                [cell.first[0], cell.first[0] + m].contains(&i) || [cell.first[1], cell.first[1] + n].contains(&j);
            if edge && let Some(node) = grid.node(i, j) {
                inside[node] = false;
            }
        }
    }
    let judged = forces.iter().zip(&inside).filter(|(_, inside)| **inside);
    let worst = judged.clone().fold(0.0f64, |m, (f, _)| m.max(f[0].abs()).max(f[1].abs()));
    assert!(judged.count() > 0, "{}: no node is inside", scene.title);
    Some(worst / largest)
}

/// Stress xx, yy, xy of a strain xx, yy, 2xy for Young's modulus and Poisson's ratio.
fn stress(scene: &Scene, [young, nu]: [f64; 2], [xx, yy, xy]: [f64; 3]) -> [f64; 3] {
    let factor = match scene.body().material().plane {
        Plane::Strain => young / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        Plane::Stress => young / (1.0 - nu * nu),
    };
    let (direct, cross) = match scene.body().material().plane {
        Plane::Strain => (1.0 - nu, nu),
        Plane::Stress => (1.0, nu),
    };
    [factor * (direct * xx + cross * yy), factor * (cross * xx + direct * yy), young / (2.0 * (1.0 + nu)) * xy]
}

/// Calls with the point, its place in [0, 1]² and its area for the 3 × 3 Gauss points of a cell.
fn each_point(at: [f64; 2], size: [f64; 2], mut call: impl FnMut([f64; 2], [f64; 2], f64)) {
    let rule = gauss_legendre(3).mapped(0.0, 1.0);
    for (&xi, v) in rule.points.iter().zip(&rule.weights) {
        for (&eta, w) in rule.points.iter().zip(&rule.weights) {
            call([at[0] + xi * size[0], at[1] + eta * size[1]], [xi, eta], v * w * size[0] * size[1]);
        }
    }
}
