//! Random input that a program gives: which data it moves is read from their expressions, and names that are not there are refused, so
//! that nothing is solved with nominal values.

use steklov_model::prelude::*;
use steklov_model::run::boundary_elements::unobserved;
use steklov_model::steklov_stochastic::Variable;
use steklov_model::stochastic::{OutcomesWatch, solve_stochastic};
use steklov_problem::DataErrorKind;

/// Names with random values, and the values of the nominal outcome.
const NOMINAL: [(&str, f64); 2] = [("Q", 2.0), ("R", 3.0)];

fn read(text: &str) -> Expression {
    Expression::parse(text, &NOMINAL.map(|(name, value)| (name.to_owned(), value)).into()).expect("an expression")
}

/// A square with lower left corner at `low`, and the names of its sides.
fn square(low: [f64; 2], names: [&str; 4]) -> Polygon {
    let [x, y] = low;
    let corners = vec![[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]];
    Polygon::new(Loop::straight(corners, names.map(str::to_owned).to_vec()), vec![]).expect("a square")
}

/// A square on a floor whose modulus, gap, friction, support and load are given.
fn scene([young, gap, friction, held, load]: [&str; 5]) -> Scene {
    let young = read(young);
    let material = Material::new(young.eval(0.0, 0.0, 0.0), 0.3, Plane::Strain).expect("a material");
    let mut scene = Scene::new(square([-0.5, -0.5], ["floor", "right", "top", "left"]), material);
    scene.problem.touch(0, Contact { gap: read(gap), friction: Friction::Tresca(read(friction)) });
    scene.problem.sides[2].condition =
        Condition::Displacement { values: [read("0"), read(held)].map(Some), traction: None };
    scene.problem.sides[3].condition = Condition::Traction([read(load), read("0")]);
    let used = |name: &str| [young.text(), gap, friction, held, load].iter().any(|text| text.contains(name));
    let all = [Variable::uniform(1.5, 2.5), Variable::normal(3.0, 0.1)].map(|variable| variable.expect("a variable"));
    let germs: Vec<Germ> = NOMINAL
        .into_iter()
        .zip(all)
        .filter(|((name, _), _)| used(name))
        .map(|((name, _), variable)| Germ { label: name.to_owned(), variable })
        .collect();
    let names = germs.iter().enumerate().map(|(germ, of)| RandomName::Variable { name: of.label.clone(), germ });
    let young = NOMINAL.iter().any(|(name, _)| young.text().contains(name)).then_some((0, young));
    scene.random = Some(Random {
        names: names.collect(),
        germs,
        stochastic: Stochastic::default(),
        constants: RandomConstants { young: young.into_iter().collect(), remote_stress: None },
    });
    scene
}

const PLAIN: [&str; 5] = ["1e3", "1e-3", "0.1", "-1e-2", "1"];
/// The same with the variable in one datum.
const VARYING: [(usize, &str); 5] = [(0, "500*Q"), (1, "1e-3*Q"), (2, "0.1*Q"), (3, "-1e-2*Q"), (4, "Q")];

fn with((datum, text): (usize, &str)) -> Scene {
    let mut data = PLAIN;
    data[datum] = text;
    scene(data)
}

fn random(scene: &mut Scene) -> &mut Random {
    scene.random.as_mut().expect("random input")
}

/// What a scene is refused with.
fn refusal(scene: &Scene) -> String {
    let error = scene.check().expect_err("a scene that does not fit");
    assert_eq!(error.kind, DataErrorKind::Conflict, "{error}");
    error.message
}

#[test]
fn what_data_use_is_what_their_expressions_say_also_after_they_were_changed() {
    for (k, varying) in VARYING.into_iter().enumerate() {
        let mut given = with(varying);
        given.check().expect("a scene that fits");
        let random = given.random.clone().expect("random input");
        let uses = |scene: &Scene| {
            let uses = scene.uses(&random);
            [uses.young, uses.contact, uses.held, uses.loads]
        };
        let of_datum = [k == 0, k == 1 || k == 2, k == 3, k == 4];
        assert_eq!(uses(&given), of_datum);
        let pressure = Expression::parse("2*Q", &[("Q".to_owned(), 2.0)].into()).expect("a pressure");
        given.problem.sides[1].condition = Condition::Pressure(pressure);
        given.check().expect("a scene that fits");
        assert_eq!(uses(&given), [of_datum[0], of_datum[1], of_datum[2], true]);
    }
}

/// J of a held block under the load Q is Q² times that of Q = 1, and the mean of Q² is 1 + 1/12 for Q uniform in [1/2, 3/2].
#[test]
fn a_random_load_of_a_program_is_random_in_every_outcome() {
    let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
    let sides = ["floor", "right", "top", "left"].map(str::to_owned).to_vec();
    let block = Polygon::new(Loop::straight(corners, sides), vec![]).expect("a block");
    let mut scene = Scene::new(block, Material::new(100.0, 0.3, Plane::Strain).expect("a material"));
    scene.problem.sides[0].condition = Condition::held();
    let load = Expression::parse("Q", &[("Q".to_owned(), 1.0)].into()).expect("a load");
    scene.problem.sides[2].condition = Condition::Pressure(load);
    scene.method.tolerance = Some(1e-2);
    let stochastic = Stochastic { quantities: Some(vec!["energy".to_owned()]), ..Stochastic::default() };
    let variable = Variable::uniform(0.5, 1.5).expect("a variable");
    let germs = vec![Germ { label: "Q".to_owned(), variable }];
    let names = vec![RandomName::Variable { name: "Q".to_owned(), germ: 0 }];
    scene.random = Some(Random { names, germs, stochastic, constants: RandomConstants::default() });
    scene.check().expect("a scene that fits");
    let run = unobserved(&scene).expect("a run");
    let (random, body) = (scene.random.as_ref().expect("random input"), run.matrices.as_ref().expect("matrices"));
    let outcomes = solve_stochastic(&scene, random, body, &OutcomesWatch::NONE, &mut |_| Ok(())).expect("outcomes");
    let (of_one, energy) = (run.last.energies.total, &outcomes.quantities[0]);
    assert!((energy.mean / of_one - 13.0 / 12.0).abs() < 1e-10, "{} of {of_one}", energy.mean);
    // E[Q⁴] - E[Q²]² = 121/80 - 169/144
    let variance = of_one * of_one * (121.0 / 80.0 - 169.0 / 144.0);
    assert!((energy.variance / variance - 1.0).abs() < 1e-10, "{} of {variance}", energy.variance);
}

#[test]
fn names_and_germs_that_are_not_there_are_refused() {
    let mut given = with((0, "400*Q + if(R > 3, 1, 0)"));
    assert_eq!(random(&mut given).germs.len(), 2);
    for (k, name) in [(0, "Q"), (1, "R")] {
        let mut wrong = given.clone();
        random(&mut wrong).names.remove(k);
        let expected = format!("\"400*Q + if(R > 3, 1, 0)\" uses {name}, which is neither random nor a parameter");
        assert_eq!(refusal(&wrong), expected);
    }
    if let RandomName::Variable { germ, .. } = &mut random(&mut given).names[1] {
        *germ = 2;
    }
    assert_eq!(refusal(&given), "R has the germs 2..3, and random.germs has 2");
}

#[test]
fn jumps_are_found_in_the_expressions_also_after_they_were_changed() {
    let mut given = with((4, "if(Q > 2.25, 1, 0)"));
    let random = given.random.clone().expect("random input");
    let jumps = |scene: &Scene| -> Vec<f64> {
        let cuts = scene.cuts(&random);
        assert_eq!(cuts.len(), 1);
        cuts[0].iter().map(|&cut| random.germs[0].variable.value(cut)).collect()
    };
    assert!(matches!(jumps(&given)[..], [q] if (q - 2.25).abs() < 1e-12), "{:?}", jumps(&given));
    let load = Expression::parse("if(Q < 1.75, 1, 0)", &[("Q".to_owned(), 2.0)].into()).expect("a load");
    given.problem.sides[1].condition = Condition::Pressure(load);
    given.check().expect("a scene that fits");
    let [a, b] = jumps(&given)[..] else { panic!("two jumps: {:?}", jumps(&given)) };
    assert!((a - 1.75).abs() < 1e-12 && (b - 2.25).abs() < 1e-12, "{a} {b}");
}

#[test]
fn random_moduli_are_those_of_bodies_that_exist() {
    let outline = Polygon::assembly(vec![
        square([0.0, 0.0], ["low.bottom", "low.right", "low.top", "low.left"]),
        square([0.0, 1.0], ["high.bottom", "high.right", "high.top", "high.left"]),
    ]);
    let material = Material::new(1e3, 0.3, Plane::Strain).expect("a material");
    let body = |name| Body::new(name, Substance::Homogeneous(material));
    let mut problem = Problem::of_bodies(outline, vec![body("low"), body("high")]);
    problem.sides[0].condition = Condition::held();
    problem.sides[6].condition =
        Condition::Displacement { values: [read("0"), read("-0.01")].map(Some), traction: None };
    let law = Law::Contact(Contact { gap: read("0"), friction: Friction::None });
    problem.join(&[2], &[4], law, None).expect("sides that face each other");
    let mut several = Scene::of(problem);
    several.check().expect("two bodies");
    several.random = with(VARYING[1]).random;
    let constants = |scene: &mut Scene, body: usize| {
        let random = scene.random.as_mut().expect("random input");
        random.constants.young = [(body, read("500*Q"))].into();
    };
    constants(&mut several, 2);
    let error = several.check().expect_err("a modulus of no body");
    assert_eq!(error.message, "random.constants.young has the body 2, and the problem has 2");
    constants(&mut several, 1);
    several.check().expect("a modulus of the second body");
    let outcome = several.outcome(&[1.0]).expect("an outcome");
    let young = |body: usize| outcome.problem.bodies[body].material().young;
    assert_eq!(young(0), 1e3);
    assert!((young(1) - 500.0 * several.random.expect("random").germs[0].variable.value(1.0)).abs() < 1e-10);
}
