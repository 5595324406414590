//! Error bars of forces that two sides share at a corner.

use steklov_model::quantities::Quantity;
use steklov_tests::{parse, summary as solved};

use crate::error_bars::quantity;

/// Two clamped sides meet at a corner, at which no mesh knows what is whose: the bars are those of the tractions.
#[test]
fn forces_that_two_sides_share_at_a_corner_are_inside_their_bars() {
    let text = |outline: &str, tolerance: f64| {
        format!(
            "{outline}\nmaterial = {{ young = 100, poisson = 0.3 }}\nsides.a.displacement = [0, 0]\nsides.b.displacement = [0, 0]\n\
             sides.top.traction = [\"1 + x\", \"-2*x\"]\nmethod.tolerance = {tolerance}\n[quantities]\n\
             m = {{ moment = \"a\", about = [1, 3] }}\nw = {{ weighted_force = \"b\", weight = [\"1 + y\", \"y\"] }}\n"
        )
    };
    let outlines = [
        "body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = [\"a\", \"right\", \"top\", \"b\"] }",
        "body = { corners = [[0, 0], [1, 0], [1, 1], [2, 1], [2, 2], [0, 2]], sides = [\"low\", \"a\", \"b\", \"right\", \"top\", \"left\"] }",
    ];
    let (mut count, mut inside) = (0, 0);
    for outline in outlines {
        let at =
            |tolerance| solved(&parse(&text(outline, tolerance), &[]).unwrap_or_else(|e| panic!("{}", e.render())));
        let known = at(1e-6);
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
            let own = at(tolerance);
            for path in
                ["reactions.a.x", "reactions.a.y", "reactions.b.x", "reactions.b.y", "moment.m", "weighted_force.w"]
            {
                let Quantity { value, uncertainty, .. } = quantity(&own, path);
                let error = (value - quantity(&known, path).value).abs();
                println!("{tolerance:e} {path}: {value} ± {uncertainty:.1e}, off by {error:.1e}");
                assert!(error <= 2.0 * uncertainty, "{path} at {tolerance:e}: {error:e} and {uncertainty:e}");
                assert!(*uncertainty <= 3.0 * tolerance * 4.0, "{path} at {tolerance:e}: {uncertainty:e}");
                (count, inside) = (count + 1, inside + usize::from(error <= *uncertainty));
            }
        }
    }
    assert!(10 * inside >= 9 * count, "{inside} of {count}");
}

/// Wall and floor meet at a corner, whose part along the wall's normal is friction of the floor or force of the wall: beside a free corner that
/// friction may open it is in doubt.
#[test]
fn forces_shared_with_friction_at_a_free_corner_have_no_bars() {
    let text = "body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = [\"floor\", \"right\", \"top\", \"wall\"] }\n\
                material = { young = 100, poisson = 0.3 }\nsides.wall.displacement = [0, \"free\"]\n\
                sides.floor.contact = { gap = 0, friction = { coulomb = \"0.2\" } }\nsides.top.traction = [1, -3]\n\
                method.tolerance = 1e-2\n";
    let doubted = |overrides: &[&str]| {
        let summary = solved(&parse(text, overrides).expect("a scene"));
        let of_forces = summary.quantities.into_iter().filter(|(path, _)| path.starts_with("reactions."));
        let is_doubted = |own: &Quantity| own.doubts.contains(&"transition".to_owned());
        of_forces.map(|(path, own)| (path, is_doubted(&own))).collect::<Vec<_>>()
    };
    let paths = ["reactions.floor.x", "reactions.floor.y", "reactions.wall.x", "reactions.wall.y"].map(str::to_owned);
    let with = |along_x: bool| paths.clone().into_iter().zip([along_x, false, along_x, false]).collect::<Vec<_>>();
    assert_eq!(doubted(&[]), with(true));
    assert_eq!(doubted(&["sides.floor.contact={gap=0}"]), with(false));
}
