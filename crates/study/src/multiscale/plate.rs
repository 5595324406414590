//! The plates of the studies: held on the left, sheared on the right, with moduli cell by cell.

use std::collections::BTreeMap;

use steklov_bem_operators::{Loop, Polygon};
use steklov_elastic::{Material, Plane};
use steklov_expression::Expression;
use steklov_model::error::SolveError;
use steklov_problem::{
    BasisInput, CellModuli, Cells, Condition, DataError, DataErrorKind, GridInput, Scene, Substance,
};

/// The laminate as a scene, so that users can solve it again; LAYERS stands for the expression of a laminate.
pub(super) const SQUARE: &str = r#"title = "Layers 1:10"
[body]
corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
poisson = 0.3
cells = { size = 0.00390625, young = "5.5 + 4.5*sign(LAYERS)" }
[parameters]
P = 4
[sides.left]
displacement = [0, 0]
[sides.right]
traction = [0, -1]
[grid]
coarse = [4, 4]
fine = [64, 64]
"#;

/// The plate with stiff parts as a scene; STIFF stands for the expression of the parts.
pub(super) const PLATE: &str = r#"title = "Stiff parts"
[body]
corners = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
poisson = 0.3
cells = { size = 0.015625, young = "(C + 1)/2 + (C - 1)/2*sign(STIFF)" }
[parameters]
C = 10
[sides.left]
displacement = [0, 0]
[sides.right]
traction = [0, -1]
[grid]
coarse = [8, 4]
fine = [16, 16]
"#;

/// A plate of a size on a grid [coarse, fine], with `along` square cells in a length of one, with a modulus that is an
/// expression of x, y and one name.
///
/// # Errors
/// Data that do not fit each other.
pub(super) fn plate(
    [width, height]: [f64; 2],
    young: &str,
    (name, value): (&str, f64),
    along: usize,
    [coarse, fine]: [[usize; 2]; 2],
) -> Result<Scene, SolveError> {
    let wrong = |message: String| DataError::at(DataErrorKind::Value, &[], message, "change the plate");
    let outline = Loop::straight(
        vec![[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]],
        ["bottom", "right", "top", "left"].map(str::to_owned).to_vec(),
    );
    let polygon = Polygon::new(outline, Vec::new()).map_err(|e| wrong(e.to_string()))?;
    let material = Material::new(1.0, 0.3, Plane::Strain).map_err(|e| wrong(e.to_string()))?;
    let young = Expression::parse(young, &BTreeMap::from([(name.to_owned(), value)])).map_err(|e| wrong(e.message))?;
    let mut scene = Scene::new(polygon, material);
    let body = scene.body_mut();
    let young = CellModuli::Expression(young);
    body.substance =
        Substance::Cells(Cells { size: 1.0 / along as f64, young, poisson: None, of_unit_modulus: material });
    body.grid = Some(GridInput { coarse, fine, basis: BasisInput::Coupled, oversample: None });
    for (side, condition) in
        [("left", Condition::held()), ("right", Condition::Traction([0.0, -1.0].map(Expression::number)))]
    {
        scene.problem.side_mut(side).ok_or_else(|| wrong(format!("no side {side}")))?.condition = condition;
    }
    scene.check()?;
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;
    use steklov_document::Document;
    use steklov_problem::{grid_of, moduli};

    #[test]
    fn the_plates_are_those_of_their_texts() {
        let cases = [
            (
                SQUARE.replace("LAYERS", "sin(2*pi*x*P)"),
                [1.0, 1.0],
                "5.5 + 4.5*sign(sin(2*pi*x*P))",
                ("P", 4.0),
                256,
                [[4; 2], [64; 2]],
            ),
            (
                PLATE.replace("STIFF", "x - y"),
                [2.0, 1.0],
                "(C + 1)/2 + (C - 1)/2*sign(x - y)",
                ("C", 10.0),
                64,
                [[8, 4], [16; 2]],
            ),
        ];
        for (text, size, young, name, along, grid) in cases {
            let read = Document::parse(&text, "plate", &[]).unwrap().scene;
            let made = plate(size, young, name, along, grid).unwrap();
            assert_eq!(
                (&read.problem.outline, read.body().grid, read.body().material().poisson),
                (&made.problem.outline, made.body().grid, made.body().material().poisson)
            );
            let young = |scene: &Scene| moduli(scene, &grid_of(scene).unwrap()).unwrap();
            assert_eq!(young(&read), young(&made));
            let data = |scene: &Scene| -> Vec<(String, Vec<Option<f64>>)> {
                let of = |side: usize| scene.problem.side_data(side).iter().map(|d| d.1.constant()).collect();
                scene.problem.sides.iter().enumerate().map(|(k, side)| (side.name.clone(), of(k))).collect()
            };
            assert_eq!(data(&read), data(&made));
        }
    }
}
