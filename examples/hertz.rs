//! A round punch pressed into a block: half the width of contact is a = (4 P R / π E*)^½ (Hertz), E* = E/(1-ν²) in plane strain.

use std::error::Error;
use std::f64::consts::PI;

use steklov_model::prelude::*;

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

    let told = solve(&scene)?.summary;
    let Some(found) = told.contact else { return Err("nothing touches".into()) };
    let (force, width) = (found.force[1], found.length / 2.0);
    let hertz = (4.0 * force * radius * (1.0 - poisson * poisson) / (PI * young)).sqrt();
    println!("{} dofs: force {force:.6}, half width {width:.6}, of Hertz {hertz:.6}", told.dofs);
    // the block is 20 times as wide as the contact, not a half-plane
    assert!(told.converged && (width / hertz - 1.0).abs() < 3e-3);
    Ok(())
}
