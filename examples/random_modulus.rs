//! A block whose Young's modulus E is uniform in [a, b]: its energy is J₁/E with J₁ that of E = 1, the mean of which is
//! J₁ ln(b/a)/(b-a).

use std::error::Error;

use steklov_model::prelude::*;
use steklov_model::steklov_stochastic::Variable;

fn main() -> Result<(), Box<dyn Error>> {
    let (low, high): (f64, f64) = (50.0, 150.0);
    let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
    let sides = ["floor", "right", "top", "left"].map(str::to_owned).to_vec();
    let block = Polygon::new(Loop::straight(corners, sides), vec![])?;
    let mut scene = Scene::new(block, Material::new((low + high) / 2.0, 0.3, Plane::Strain)?);
    scene.problem.sides[0].condition = Condition::held();
    scene.problem.sides[2].condition = Condition::Pressure(Expression::number(1.0));
    let variable = Variable::uniform(low, high)?;
    let young = Expression::parse("E", &[("E".to_owned(), variable.mean())].into())?;
    scene.random = Some(Random {
        names: vec![RandomName::Variable { name: "E".to_owned(), germ: 0 }],
        germs: vec![Germ { label: "E".to_owned(), variable }],
        stochastic: Stochastic { degree: 8, quantities: Some(vec!["energy".to_owned()]), ..Stochastic::default() },
        constants: RandomConstants { young: [(0, young)].into(), remote_stress: None },
    });

    let answer = solve(&scene)?;
    let Some(outcomes) = answer.outcomes else { return Err("no outcomes".into()) };
    let nominal = answer.summary.energy * scene.body().material().young;
    let exact = nominal * (high / low).ln() / (high - low);
    let mean = outcomes.quantities[0].mean;
    println!("mean of J: {mean:.10}, exact {exact:.10}");
    assert!((mean / exact - 1.0).abs() < 1e-8);
    Ok(())
}
