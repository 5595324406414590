//! A round inclusion in a medium pulled alike in all directions: the stress in it is p (κₘ+1) μᵢ / ((κᵢ-1) μₘ + 2 μᵢ), the same
//! everywhere.

use std::error::Error;
use std::f64::consts::TAU;

use steklov_bem_operators::{Loop, Polygon};
use steklov_elastic::{Material, Plane};
use steklov_model::run::boundary_elements::unobserved;
use steklov_problem::{FarField, Scene, Tie};

/// Corners of the polygon that stands for the circle: its area is that of the circle but for (2π/n)²/6.
const CORNERS: usize = 96;

fn main() -> Result<(), Box<dyn Error>> {
    let body = Material::new(500.0, 0.2, Plane::Strain)?;
    let medium = Material::new(100.0, 0.35, Plane::Strain)?;
    let corner = |k: usize| [(TAU * k as f64 / CORNERS as f64).cos(), (TAU * k as f64 / CORNERS as f64).sin()];
    let circle = Loop::straight((0..CORNERS).map(corner).collect(), vec!["rim".to_owned(); CORNERS]);
    let mut scene = Scene::new(Polygon::new(circle, vec![])?, body);
    let pull = 3.0;
    let far = FarField { remote_stress: [pull, pull, 0.0], ..FarField::default() };
    scene.problem.surround(medium, far, Tie::default())?;
    scene.method.tolerance = Some(1e-2);
    scene.check()?;

    let run = unobserved(&scene)?;
    let (_, [xx, yy, xy]) = run.last.inside(0, [0.2, -0.3]);
    let (mu, kappa) = (|m: &Material| m.young / (2.0 + 2.0 * m.poisson), |m: &Material| 3.0 - 4.0 * m.poisson);
    let exact = pull * (kappa(&medium) + 1.0) * mu(&body) / ((kappa(&body) - 1.0) * mu(&medium) + 2.0 * mu(&body));
    println!("{} dofs: σ = {xx:.5}, {yy:.5}, {xy:.1e}, of a circle {exact:.5}", run.step().dofs);
    assert!((xx / exact - 1.0).abs() < 2e-3 && (yy / exact - 1.0).abs() < 2e-3 && xy.abs() < 2e-3 * exact);
    Ok(())
}
