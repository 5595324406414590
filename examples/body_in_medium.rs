//! A square on a grid in an unbounded medium, by the crate of the coupling alone. On the interface Γ of body and medium
//!
//! u - u_c = u0,   σ(u)n = σ(u_c)n + t0,   σ(u_c)n = -S u_c,   S = W + (K - ½M)ᵀ V⁻¹ (K - ½M)
//!
//! (Costabel and Stephan, SIAM J. Numer. Anal. 27, 1990). The known solution is linear in the body, u = (x + y, y)/10; around it
//! u_c = X/|X|² with X = (x, y) - centre, which has neither divergence nor curl, so that it is in equilibrium for all moduli:
//! σ(u_c) = 2μ ∇u_c = 2μ (I/|X|² - 2 X Xᵀ/|X|⁴).

use std::error::Error;

use steklov_coupling::steklov_elastic::{Material, Plane};
use steklov_coupling::steklov_msfem::{Elasticity, Grid, HeterogeneousBody, Loads};
use steklov_coupling::{Form, Interior, Medium, Outline, Radiation, Transmission};

/// The displacement of the medium, and its gradient.
fn outer([x, y]: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
    let r = [x - 0.5, y - 0.5];
    let squared = r[0] * r[0] + r[1] * r[1];
    let entry = |i: usize, j: usize| (if i == j { 1.0 } else { 0.0 } - 2.0 * r[i] * r[j] / squared) / squared;
    (r.map(|r| r / squared), [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]])
}

/// The largest errors of the displacement of the body and of the medium at a point outside, with n × n cells.
fn errors(n: usize) -> Result<[f64; 2], Box<dyn Error>> {
    let (of_body, of_medium) = (Material::new(5.0, 0.2, Plane::Strain)?, Material::new(1.0, 0.4, Plane::Strain)?);
    let inner = |[x, y]: [f64; 2]| [0.1 * (x + y), 0.1 * y];
    let traction = |[xx, yy, xy]: [f64; 3], n: [f64; 2]| [xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]];
    let jump_of_traction = |x: [f64; 2], n: [f64; 2]| {
        let body = traction(of_body.stress([[0.1, 0.1], [0.0, 0.1]]), n);
        let medium = traction(of_medium.stress(outer(x).1), n);
        [body[0] - medium[0], body[1] - medium[1]]
    };
    let (grid, mut loads) = (Grid::rectangle([1.0, 1.0], [n, n])?, Loads::default());
    Outline::new(&grid)?.add_traction_jump(&grid, &mut loads, jump_of_traction);
    let body = HeterogeneousBody::new(grid, vec![5.0; n * n], Elasticity::new(0.2, Plane::Strain)?)?;
    let interior = Interior::fine(&body, &loads)?;
    let medium = Medium::new(interior.trace.mesh(1, 1)?, of_medium, None)?;
    let jump = medium.space.interpolate(|x| [inner(x)[0] - outer(x).0[0], inner(x)[1] - outer(x).0[1]]);
    let solved = Transmission::new(interior, &medium)?.solve(&jump, Form::Schur, Radiation::Decaying)?;

    let off = |found: [f64; 2], exact: [f64; 2]| (found[0] - exact[0]).hypot(found[1] - exact[1]);
    let at = |node: usize| {
        off([solved.displacement[2 * node], solved.displacement[2 * node + 1]], inner(body.grid.point(node)))
    };
    let far = [1.7, 0.9];
    Ok([
        (0..body.grid.nodes()).map(at).fold(0.0, f64::max),
        off(medium.field(&solved).at(far).displacement, outer(far).0),
    ])
}

fn main() -> Result<(), Box<dyn Error>> {
    let [coarse, fine] = [errors(16)?, errors(32)?];
    println!(
        "errors in the body {:.2e}, {:.2e}; at a point of the medium {:.2e}, {:.2e}",
        coarse[0], fine[0], coarse[1], fine[1]
    );
    assert!(fine[0] < 3e-4 && fine[1] < 2e-4 && (0..2).all(|k| (3.8..4.2).contains(&(coarse[k] / fine[k]))));
    Ok(())
}
