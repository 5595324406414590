//! Seconds beside error for the bar 6 × 1: bilinear elements, multiscale elements, and fine grids that are streamed.
//!
//! `cargo bench -p steklov-msfem --bench bar`

use std::time::Instant;

use steklov_elastic::Plane;
use steklov_msfem::{
    Basis, CoarseMesh, Elasticity, Elimination, Extra, Grid, HeterogeneousBody, Loads, MsfemError, Multiscale,
};
use steklov_quadrature::unit_uniform;

/// Twice the strain energy of the homogeneous bar on ever finer meshes.
const LIMIT: f64 = 2.0 * 0.200_110;

fn bar(cells: [usize; 2], random: bool) -> Result<(HeterogeneousBody, Loads), MsfemError> {
    let grid = Grid::rectangle([6.0, 1.0], cells)?;
    let young = |c: usize| 2000.0 + if random { 1000.0 * unit_uniform(2014, c as u64) } else { 0.0 };
    let moduli = (0..cells[0] * cells[1]).map(young).collect();
    let body = HeterogeneousBody::new(grid, moduli, Elasticity::new(0.3, Plane::Strain)?)?;
    let mut loads = Loads::default();
    let half = -body.grid.spacing[1] / 2.0;
    for (cell, side) in body.grid.boundary().into_iter().filter(|(_, side)| *side == 1) {
        loads.add_side(cell, side, [[0.0, half]; 2]);
    }
    Ok((body, loads))
}

fn fine(cells: [usize; 2]) -> Result<(), MsfemError> {
    let (body, loads) = bar(cells, false)?;
    let clock = Instant::now();
    let mut lap = clock;
    let mut part = || {
        let seconds = lap.elapsed().as_secs_f64();
        lap = Instant::now();
        seconds
    };
    let stiffness = body.stiffness();
    let assembly = part();
    let order = body.elimination_order();
    let ordering = part();
    let held: Vec<usize> =
        (0..body.grid.nodes()).filter(|&n| body.grid.lattice(n)[0] == 0).flat_map(|n| [2 * n, 2 * n + 1]).collect();
    let solver = Elimination::new(stiffness, &order, &[], &held)?;
    let factorisation = part();
    let load = loads.nodal(&body);
    let u = solver.expand(&solver.reduce(&load, &vec![0.0; held.len()]), &[]);
    let solution = part();
    let total = clock.elapsed().as_secs_f64();
    let work: f64 = u.iter().zip(&load).map(|(u, f)| u * f).sum();
    println!(
        "{:>9} dofs: assembly {assembly:.3}, ordering {ordering:.3}, factor {factorisation:.3}, solution {solution:.3}, \
         total {total:.3} s; energy error {:.2e}",
        body.grid.dofs(),
        ((LIMIT - work) / LIMIT).abs().sqrt(),
    );
    Ok(())
}

fn multiscale(cells: [usize; 2], fine: usize, random: bool) -> Result<(), MsfemError> {
    let (body, loads) = bar(cells, random)?;
    let clock = Instant::now();
    let mesh = CoarseMesh::uniform(&body.grid, [fine; 2])?;
    let mut problem = Multiscale::new(&body, mesh, Basis::Coupled)?;
    let patterns = clock.elapsed().as_secs_f64();
    let system = problem.assemble(&loads, &Extra::default(), &mut |_| true)?;
    let assembly = clock.elapsed().as_secs_f64();
    let clamped = (0..problem.mesh.vertices.len()).filter(|&v| problem.mesh.vertices[v][0] == 0);
    let held: Vec<usize> = clamped.filter_map(|v| problem.unknown[v]).flat_map(|u| [u, u + 1]).collect();
    let solver = Elimination::new(system.stiffness, &problem.elimination_order(), &[], &held)?;
    let coarse = solver.expand(&solver.reduce(&system.load, &vec![0.0; held.len()]), &[]);
    let solved = clock.elapsed().as_secs_f64();
    let u = problem.downscale(&coarse, &loads, &Extra::default(), &mut |_| true)?;
    let downscaled = clock.elapsed().as_secs_f64();
    let stresses = body.stresses(&u);
    let total = clock.elapsed().as_secs_f64();
    let work: f64 = coarse.iter().zip(&system.load).map(|(u, f)| u * f).sum();
    let largest = stresses.iter().fold(0.0, |m: f64, s| m.max(body.elasticity.von_mises(*s)));
    println!(
        "{:>9} fine dofs, {:>6} coarse, {:>5} patterns: patterns {patterns:.3}, bases {:.3}, coarse {:.3}, downscale {:.3}, \
         stresses {:.3}, total {total:.3} s; compliance {work:.6}, von Mises {largest:.2}, peak {} MiB",
        body.grid.dofs(),
        problem.dofs(),
        problem.patterns(),
        assembly - patterns,
        solved - assembly,
        downscaled - solved,
        total - downscaled,
        peak() >> 10,
    );
    Ok(())
}

/// Largest resident memory so far in KiB.
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|l| l.starts_with("VmHWM:"));
    line.and_then(|l| l.split_whitespace().nth(1)).and_then(|n| n.parse().ok()).unwrap_or(0)
}

fn main() -> Result<(), MsfemError> {
    println!("bilinear elements, homogeneous: seconds, and error against the limit of fine meshes");
    for n in [8, 32, 64, 128, 256] {
        fine([6 * n, n])?;
    }
    println!("multiscale elements, 96 × 16 coarse cells");
    multiscale([96 * 16, 16 * 16], 16, false)?;
    multiscale([96 * 16, 16 * 16], 16, true)?;
    if std::env::args().any(|a| a == "--streamed") {
        println!("a fine grid that is streamed");
        multiscale([5472, 912], 16, true)?;
    }
    Ok(())
}
