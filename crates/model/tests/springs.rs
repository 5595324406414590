//! Springs on sides of problems that a program makes.

use steklov_model::prelude::*;

/// A block 0 ≤ x ≤ 2, 0 ≤ y ≤ 1 of E = 100, ν = 0.3 in plane stress, with a pressure on its top.
fn block() -> Scene {
    let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
    let sides = ["floor", "right", "top", "left"].map(str::to_owned).to_vec();
    let outline = Polygon::new(Loop::straight(corners, sides), vec![]).expect("an outline");
    let mut scene = Scene::new(outline, Material::new(100.0, 0.3, Plane::Stress).expect("a material"));
    scene.problem.sides[2].condition = Condition::Pressure(Expression::number(4.0));
    scene
}

fn foundation(normal: f64, tangential: f64) -> Option<Springs> {
    let [normal, tangential] = [normal, tangential].map(Expression::number);
    Some(Springs::Normal { normal, tangential })
}

/// u_y = -p/k - p y/E, u_x = ν p (x - 1)/E; the energies are p²/k and p²/E, half of each times 2.
#[test]
fn a_block_rests_on_a_foundation() {
    let mut scene = block();
    scene.problem.sides[0].springs = foundation(40.0, 0.0);
    scene.problem.sides[3].condition =
        Condition::Displacement { values: [Some(Expression::number(-0.012)), None], traction: None };
    scene.probe = vec![[1.0, 0.5], [2.0, 1.0]];
    let summary = solve(&scene).expect("a solution").summary;
    assert!(summary.converged);
    let near = |found: f64, exact: f64| assert!((found - exact).abs() < 1e-12, "{found}, not {exact}");
    near(summary.probe[0].displacement[0], 0.0);
    near(summary.probe[0].displacement[1], -0.12);
    near(summary.probe[1].displacement[0], 0.012);
    near(summary.probe[1].displacement[1], -0.14);
    near(summary.spring_energy.expect("springs"), 0.5 * 16.0 / 40.0 * 2.0);
    near(summary.strain_energy, 0.5 * 16.0 / 100.0 * 2.0);
    near(summary.energy, summary.strain_energy + summary.spring_energy.unwrap_or_default() - summary.load_work);
    near(summary.reactions["floor"][1], 8.0);
}

/// A pressure on the side that rests on springs moves the body by p/k = 0.1 and strains it nowhere: J = -p²/(2k) times the length.
#[test]
fn a_body_that_springs_only_move_is_solved_on_its_first_mesh() {
    let mut scene = block();
    scene.problem.sides[2].condition = Condition::Free;
    scene.problem.sides[0].springs = Some(Springs::both(Expression::number(40.0)));
    scene.problem.sides[0].condition = Condition::Pressure(Expression::number(4.0));
    let summary = solve(&scene).expect("a solution").summary;
    assert!(summary.converged && summary.steps == 1, "{} steps: {}", summary.steps, summary.reason);
    assert!((summary.energy + 0.5 * 16.0 / 40.0 * 2.0).abs() < 1e-12, "{}", summary.energy);
    assert!(summary.estimate_doubts.is_empty(), "{:?}", summary.estimate_doubts);
}

type Change<'a> = &'a dyn Fn(&mut Scene);

/// A program is refused what a scene file is refused.
#[test]
fn programs_are_protected_as_files_are() {
    let refused = |change: Change<'_>| {
        let mut scene = block();
        scene.problem.sides[0].springs = foundation(40.0, 1.0);
        change(&mut scene);
        solve(&scene).expect_err("it is refused").to_string()
    };
    let cases: [(Change<'_>, &str); 5] = [
        (&|scene| scene.problem.sides[0].condition = Condition::held(), "has springs and a displacement"),
        (
            &|scene| {
                scene.problem.touch(0, Contact { gap: Expression::number(0.0), friction: Friction::None });
                scene.problem.sides[0].springs = foundation(40.0, 1.0);
            },
            "has springs and is in contact",
        ),
        (
            &|scene| scene.problem.sides[0].springs = foundation(40.0, -1.0),
            "stiffness of springs of side \"floor\" is -1",
        ),
        (&|scene| scene.problem.sides[0].springs = foundation(f64::INFINITY, 1.0), "is inf"),
        (&|scene| scene.problem.sides[0].springs = foundation(1e18, 0.0), "more than 1e15 times"),
    ];
    for (change, why) in cases {
        let told = refused(change);
        assert!(told.contains(why), "{told}");
    }
}

/// Contact takes the place of springs, and springs of 0 hold nothing.
#[test]
fn contact_takes_the_place_of_springs() {
    let mut scene = block();
    scene.problem.sides[0].springs = foundation(40.0, 1.0);
    scene.problem.touch(0, Contact { gap: Expression::number(0.0), friction: Friction::None });
    assert!(!scene.problem.has_springs() && scene.check().is_ok());
    let mut scene = block();
    scene.problem.sides[0].springs = foundation(0.0, 0.0);
    let told = solve(&scene).expect_err("nothing holds it").to_string();
    assert!(told.contains("translation"), "{told}");
}
