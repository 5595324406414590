//! A pin pressed into a hole that is a little larger: half the width of contact is a = (4 P R / π E*)^½ with 1/R = 1/r - 1/r' and
//! E* = E/2(1-ν²) (Hertz), as long as it is small beside the pin.

use std::error::Error;
use std::f64::consts::PI;

use steklov_model::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    let (young, poisson, radius, larger, force): (f64, f64, f64, f64, f64) = (1000.0, 0.3, 1.0, 1.1, 0.2);
    let circle = |centre: [f64; 2], radius: f64, name: &str| Loop::circle(centre, radius, 4, name);
    let pin = Polygon::new(circle([0.0, 0.0], radius, "rim"), vec![])?;
    let corners = vec![[-6.0, -6.0], [6.0, -6.0], [6.0, 6.0], [-6.0, 6.0]];
    let sides = ["floor", "right", "top", "left"].map(str::to_owned).to_vec();
    let plate = Polygon::new(Loop::straight(corners, sides), vec![circle([0.0, larger - radius], larger, "hole")])?;
    let outline = Polygon::assembly(vec![pin.with_body_name("pin"), plate.with_body_name("plate")]);
    let material = Material::new(young, poisson, Plane::Strain)?;
    let mut bodies = ["pin", "plate"].map(|name| Body::new(name, Substance::Homogeneous(material))).to_vec();
    let weight = -force / (PI * radius * radius);
    bodies[0].force = Some([Expression::number(0.0), Expression::number(weight)]);
    let mut scene = Scene::of(Problem::of_bodies(outline, bodies));
    let [rim, hole, floor] =
        ["pin.rim", "plate.hole", "plate.floor"].map(|name| scene.problem.side(name).unwrap_or_default());
    scene.problem.sides[floor].condition = Condition::held();
    let law = Law::Contact(Contact { gap: Expression::number(0.0), friction: Friction::None });
    scene.problem.join(&[rim], &[hole], law, None)?;
    scene.method.tolerance = Some(1e-3);

    let told = solve(&scene)?.summary;
    let (found, width) = (told.interfaces[0].force, told.interfaces[0].length / 2.0);
    let relative = 1.0 / (1.0 / radius - 1.0 / larger);
    let hertz = (8.0 * force * relative * (1.0 - poisson * poisson) / (PI * young)).sqrt();
    println!("{} dofs: force {found:?}, half width {width:.6}, of Hertz {hertz:.6}", told.dofs);
    assert!(told.converged && (found[1].abs() / force - 1.0).abs() < 1e-6 && (width / hertz - 1.0).abs() < 2e-2);
    Ok(())
}
