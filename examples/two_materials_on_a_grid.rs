//! A bar of two materials in a row, pulled by σ: with ν = 0 its energy is J = -½ σ² h (L₁/E₁ + L₂/E₂), on any grid.

use std::error::Error;
use std::sync::atomic::AtomicUsize;

use steklov_bem_operators::{Loop, Polygon};
use steklov_elastic::{Material, Plane};
use steklov_expression::Expression;
use steklov_model::grid::OnGrid;
use steklov_model::run::adaptive_loop::{Progress, run};
use steklov_problem::{BasisInput, CellModuli, Cells, Condition, GridInput, Scene, Substance};

fn main() -> Result<(), Box<dyn Error>> {
    let (soft, stiff, stress) = (100.0, 300.0, 2.0);
    let corners = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]];
    let sides = ["below", "right", "above", "left"].map(str::to_owned).to_vec();
    let bar = Polygon::new(Loop::straight(corners, sides), vec![])?;
    let names = [("A".to_owned(), soft), ("B".to_owned(), stiff)].into();
    let young = Expression::parse("if(x < 1, A, B)", &names)?;
    let of_unit_modulus = Material::new(1.0, 0.0, Plane::Strain)?;
    let mut scene = Scene::new(bar, of_unit_modulus);
    let body = scene.body_mut();
    body.substance =
        Substance::Cells(Cells { size: 0.5, young: CellModuli::Expression(young), poisson: None, of_unit_modulus });
    body.grid = Some(GridInput { coarse: [8, 2], fine: [4, 4], basis: BasisInput::Coupled, oversample: None });
    scene.problem.sides[1].condition = Condition::Traction([stress, 0.0].map(Expression::number));
    scene.problem.sides[3].condition = Condition::held();
    scene.check()?;

    let progress = Progress::<OnGrid>::new(&scene, vec![])?;
    let run = run(&scene, progress, &AtomicUsize::new(0), &mut |_, _| Ok(()))?;
    let energy = run.last.energies.total;
    let exact = -0.5 * stress * stress * (1.0 / soft + 3.0 / stiff);
    println!("{}: {} dofs, J = {energy:.12}, exact {exact:.12}", scene.model().word(), run.last.dofs);
    assert!(run.converged() && (energy / exact - 1.0).abs() < 1e-12);
    Ok(())
}
