//! How numbers of a solution change with the modulus of each cell: one adjoint solution a number.
//!
//! ```text
//! K(E) u = f,  Q = Q(u, E):     dQ/dE_c = ∂Q/∂E_c + wᵀ K_c u,     K w = -∂Q/∂u where nothing is held
//! ```
//! K_c is the stiffness of cell c for E = 1. The force of a support is the work of the other forces on a field w that moves the
//! support by one, and nothing else.
//!
//! Source: Haug, Choi and Komkov (1986), section 1.2.

use rayon::prelude::*;
use steklov_problem::Scene;

use super::loads::loads;
use super::solution::GridSolved;
use super::system::System;
use super::trace::node_at;
use crate::data::on_mesh::OnMesh;
use crate::data::supports::Held;
use crate::error::SolveError;
use crate::summary::Summary;

/// What a number is of displacements and moduli.
#[derive(Default)]
struct Functional {
    /// -∂Q/∂u; empty if it is 0.
    load: Vec<f64>,
    /// Side and component of a support whose force it is.
    support: Option<(usize, usize)>,
    /// Q has this part of uᵀ K u.
    energy: f64,
    /// A cell and the derivative by its modulus with u held fast.
    cell: Option<(usize, f64)>,
}

/// dQ/dE_c of the numbers at some paths of the JSON object (their unit over stress), for all cells of the grid (0 in dropped
/// ones), at a solution of a scene; `None` where the derivative of one of them is not known: with contact, with a medium, on
/// coarse cells, of a body that can move as a whole, and for other numbers than energies, displacements and stresses at probes,
/// and forces of supports that do not meet another one.
///
/// *Cost*: one solution of the grid a number.
///
/// # Errors
/// Those of a solution.
pub fn modulus_derivatives(
    scene: &Scene,
    solved: &GridSolved,
    paths: &[&str],
) -> Result<Option<Vec<Vec<f64>>>, SolveError> {
    let known = solved.coarse.is_none() && solved.around.is_none() && solved.free_motions.is_empty();
    if !known || scene.contacts().next().is_some() {
        return Ok(None);
    }
    let trace = &solved.trace;
    let load = loads(scene, &solved.body, trace)?.loads.nodal(&solved.body);
    let held = OnMesh { scene, mesh: &trace.mesh, space: &trace.space }.held()?;
    let functionals: Option<Vec<Functional>> =
        paths.iter().map(|path| functional(scene, &load, solved, path)).collect();
    let Some(functionals) = functionals else { return Ok(None) };
    functionals
        .iter()
        .map(|functional| derivative(scene, &held, solved, functional))
        .collect::<Result<_, _>>()
        .map(Some)
}

/// The number at a path; `None` if its derivative is not known.
fn functional(scene: &Scene, load: &[f64], solved: &GridSolved, path: &str) -> Option<Functional> {
    let body = &solved.body;
    let against_loads = || load.iter().map(|f| -f).collect();
    let functional = match path.split('.').collect::<Vec<_>>()[..] {
        ["energy"] => Functional { energy: 0.5, ..Functional::default() },
        ["strain_energy"] => Functional { energy: 0.5, load: against_loads(), ..Functional::default() },
        ["load_work"] => Functional { load: against_loads(), ..Functional::default() },
        ["reactions", ref side @ .., k] => {
            let (name, k) = (side.join("."), Summary::component(k)?);
            let side = scene.problem.sides.iter().position(|side| side.name == name)?;
            (scene.problem.sides[side].holds(k) && !meets_support(scene, solved, side, k)).then_some(())?;
            Functional { support: Some((side, k)), ..Functional::default() }
        }
        ["probe", point, of, k] => {
            let (at, k) = (*scene.probe.get(Summary::component(point)?)?, Summary::component(k)?);
            let (cell, local) = body.grid.locate(at)?;
            let unit = |a: usize| std::array::from_fn(|b| f64::from(u8::from(a == b)));
            let (weights, own): ([f64; 8], _) = match of {
                "displacement" if k < 2 => {
                    let [x, y] = local;
                    let hats = [(1.0 - x) * (1.0 - y), x * (1.0 - y), x * y, (1.0 - x) * y];
                    (std::array::from_fn(|a| if a % 2 == k { hats[a / 2] } else { 0.0 }), None)
                }
                "stress" if k < 3 => {
                    let stress = body.stress(cell, &body.cell_values(&solved.displacement, cell), local)[k];
                    let of_unit = |a: usize| body.stress(cell, &unit(a), local)[k];
                    (std::array::from_fn(of_unit), Some((cell, stress / body.young[cell])))
                }
                _ => return None,
            };
            let mut load = vec![0.0; body.grid.dofs()];
            let nodes = body.grid.cell_nodes(cell);
            (0..8).for_each(|a| load[2 * nodes[a / 2] + a % 2] -= weights[a]);
            Functional { load, cell: own, ..Functional::default() }
        }
        _ => return None,
    };
    Some(functional)
}

/// Whether a support has a node in common with another one that holds the same component: the stress there parts their forces.
fn meets_support(scene: &Scene, solved: &GridSolved, side: usize, k: usize) -> bool {
    let mesh = &solved.trace.mesh;
    let holds = |other: usize| other != side && scene.problem.sides[other].holds(k);
    let pairs = (0..mesh.len()).map(|e| [mesh.side[e], mesh.side[mesh.next[e]]]);
    pairs.into_iter().any(|[a, b]| a == side && holds(b) || b == side && holds(a))
}

/// dQ/dE_c of all cells.
fn derivative(
    scene: &Scene,
    held: &[Held],
    solved: &GridSolved,
    functional: &Functional,
) -> Result<Vec<f64>, SolveError> {
    let (body, u) = (&solved.body, &solved.displacement);
    let grid = &body.grid;
    let Functional { load, support, energy, cell } = functional;
    let w = if load.is_empty() && support.is_none() {
        vec![0.0; grid.dofs()]
    } else {
        let of_component = |k: usize, (_, side): (f64, usize)| (f64::from(u8::from(Some((side, k)) == *support)), side);
        let held: Vec<Held> = held
            .iter()
            .map(|h| Held { components: [0, 1].map(|k| h.components[k].map(|held| of_component(k, held))) })
            .collect();
        let system = System {
            stiffness: body.stiffness(),
            load: if load.is_empty() { vec![0.0; grid.dofs()] } else { load.clone() },
            points: (0..grid.nodes()).map(|n| grid.point(n)).collect(),
            order: body.elimination_order(),
            at_boundary: solved.trace.lattice.iter().map(|&p| node_at(grid, p)).collect(),
        };
        system.solve(scene, &solved.trace, &held, None, &|_, _, _| [0.0; 2], &mut |_| Ok(()))?.displacement
    };
    let of_cell = |c: usize| {
        if !grid.inside(grid.cell(c)[0], grid.cell(c)[1]) {
            return 0.0;
        }
        let (u, w) = (body.cell_values(u, c), body.cell_values(&w, c));
        let own = cell.filter(|(cell, _)| *cell == c).map_or(0.0, |(_, derivative)| derivative);
        own + (energy * body.cell_energy(c, &u) + body.cell_work(c, &u, &w)) / body.young[c]
    };
    Ok((0..body.young.len()).into_par_iter().map(of_cell).collect())
}
