//! Two blocks of one material, one upon the other, with friction between them, under a pressure p: both widen alike, so that nothing
//! slips, and J = -p² (1-ν²) A / 2E with the area A of both (plane strain).

use std::error::Error;

use steklov_model::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    let (young, poisson, pressure): (f64, f64, f64) = (200.0, 0.3, 1.5);
    let block = |name: &str, [low, high]: [f64; 2]| {
        let corners = vec![[0.0, low], [2.0, low], [2.0, high], [0.0, high]];
        let sides = ["bottom", "right", "top", "left"].map(str::to_owned).to_vec();
        Polygon::new(Loop::straight(corners, sides), vec![]).map(|outline| outline.with_body_name(name))
    };
    let outline = Polygon::assembly(vec![block("lower", [0.0, 1.0])?, block("upper", [1.0, 1.5])?]);
    let material = Material::new(young, poisson, Plane::Strain)?;
    let bodies = ["lower", "upper"].map(|name| Body::new(name, Substance::Homogeneous(material))).to_vec();
    let mut scene = Scene::of(Problem::of_bodies(outline, bodies));
    let [floor, below, above, top, wall, wall_above] =
        ["lower.bottom", "lower.top", "upper.bottom", "upper.top", "lower.left", "upper.left"]
            .map(|name| scene.problem.side(name).unwrap_or_default());
    let zero = || Some(Expression::number(0.0));
    scene.problem.sides[floor].condition = Condition::Displacement { values: [None, zero()], traction: None };
    for side in [wall, wall_above] {
        scene.problem.sides[side].condition = Condition::Displacement { values: [zero(), None], traction: None };
    }
    scene.problem.sides[top].condition = Condition::Pressure(Expression::number(pressure));
    let friction = Friction::Coulomb(Expression::number(0.3));
    scene.problem.join(&[above], &[below], Law::Contact(Contact { gap: Expression::number(0.0), friction }), None)?;

    let told = solve(&scene)?.summary;
    let exact = -0.5 * pressure * pressure * (1.0 - poisson * poisson) / young * 3.0;
    let force = told.interfaces[0].force[1];
    println!("{} dofs: J {:.12}, exact {exact:.12}; the lower block bears {force:.12}", told.dofs, told.energy);
    assert!(told.converged && (told.energy / exact - 1.0).abs() < 1e-10);
    assert!((force / (2.0 * pressure) - 1.0).abs() < 1e-10);
    Ok(())
}
