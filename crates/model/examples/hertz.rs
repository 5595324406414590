//! A round punch pressed into a block: half the width of contact is a = (4 P R / π E*)^½ (Hertz), E* = E/(1-ν²) in plane strain.

use std::error::Error;
use std::f64::consts::PI;

use steklov_bem_operators::{Loop, Polygon};
use steklov_elastic::{Material, Plane};
use steklov_expression::Expression;
use steklov_model::answer::report::{contact_summary, located};
use steklov_model::run::boundary_elements::unobserved;
use steklov_model::solve::contact_rows::contact_rows;
use steklov_problem::{Condition, Contact, Friction, Scene};

fn main() -> Result<(), Box<dyn Error>> {
    let (young, poisson, radius, overlap): (f64, f64, f64, f64) = (1000.0, 0.3, 1.0, 1e-3);
    let corners = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let sides = ["floor", "right", "top", "left"].map(str::to_owned).to_vec();
    let block = Polygon::new(Loop::straight(corners, sides), vec![])?;
    let mut scene = Scene::new(block, Material::new(young, poisson, Plane::Strain)?);
    let names = [("R".to_owned(), radius), ("d".to_owned(), overlap)].into();
    let gap = Expression::parse("(x - 0.5)^2/(2*R) - d", &names)?;
    scene.problem.touch(0, Contact { gap, friction: Friction::None });
    scene.problem.sides[2].condition = Condition::held();
    scene.method.tolerance = Some(1e-4);
    scene.check()?;

    let run = unobserved(&scene)?;
    let Some(contact) = &run.last.contact else { return Err("nothing touches".into()) };
    let trace = run.last.trace();
    let found = contact_summary(
        &scene,
        trace,
        contact,
        &contact_rows(trace, contact),
        located(&scene, &run.step().layout.located),
    );
    let (force, width) = (found.force[1], found.length / 2.0);
    let hertz = (4.0 * force * radius * (1.0 - poisson * poisson) / (PI * young)).sqrt();
    println!("{} dofs: force {force:.6}, half width {width:.6}, of Hertz {hertz:.6}", run.step().dofs);
    // the block is 20 times as wide as the contact, not a half-plane
    assert!(run.converged() && (width / hertz - 1.0).abs() < 3e-3);
    Ok(())
}
