//! Sides of bodies can only be joined in ways that can be solved.

use std::collections::BTreeMap;

use steklov_bem_operators::{Loop, Polygon};
use steklov_elastic::{Material, Plane};
use steklov_expression::Expression;
use steklov_problem::{Body, Condition, Contact, Friction, Law, Place, Problem, Scene, Side, Span, Substance, Tie};

/// Blocks of width 1, each `distance` above the one before; the sides of the k-th are 4k (bottom), 4k + 1, 4k + 2 (top), 4k + 3.
fn stack(count: usize, distance: f64) -> Problem {
    let names = |k: usize| ["bottom", "right", "top", "left"].map(|side| format!("{k}.{side}")).to_vec();
    let outline = |k: usize| {
        let y = k as f64 * (1.0 + distance);
        Polygon::new(Loop::straight(vec![[0.0, y], [1.0, y], [1.0, y + 1.0], [0.0, y + 1.0]], names(k)), vec![])
            .unwrap()
    };
    let material = Material::new(100.0, 0.3, Plane::Strain).unwrap();
    let body = |k: usize| Body::new(&format!("{k}"), Substance::Homogeneous(material));
    Problem::of_bodies(Polygon::assembly((0..count).map(outline).collect()), (0..count).map(body).collect())
}

fn read(text: &str) -> Expression {
    Expression::parse(text, &BTreeMap::new()).unwrap()
}

fn contact(gap: &str, friction: Friction) -> Law {
    Law::Contact(Contact { gap: read(gap), friction })
}

#[test]
fn sides_are_joined_once_and_have_no_other_condition() {
    let mut problem = stack(3, 0.0);
    let tied = || Law::Tied(Tie::default());
    problem.join(&[4], &[2], tied(), None).unwrap().name = "lower".into();
    let refused = |problem: &mut Problem, first: &[usize], second: &[usize]| {
        problem.join(first, second, tied(), None).map(|_| ()).unwrap_err().message
    };
    for (first, second, why) in [
        (vec![8], vec![4], "in two conditions"),
        (vec![8, 8], vec![6], "in two conditions"),
        (vec![5], vec![7], "sides of one body"),
        (vec![8], vec![], "names no side"),
        (vec![8], vec![77], "there is no side 77"),
        (vec![8, 5], vec![6, 9], "sides of one body"),
        (vec![9], vec![6], "do not face each other"),
    ] {
        let told = refused(&mut problem, &first, &second);
        assert!(told.contains(why), "{first:?} {second:?}: {told}");
    }
    problem.sides[8].condition = Condition::held();
    assert!(refused(&mut problem, &[8], &[6]).contains("a condition in [sides] too"));
    problem.sides[8].condition = Condition::Free;
    problem.join(&[8], &[6], tied(), None).unwrap();
    assert_eq!(problem.interfaces().iter().map(|i| i.name.as_str()).collect::<Vec<_>>(), ["lower", "2.bottom-1.top"]);
    // what is given later is seen by the check
    let outline = stack(3, 0.0).outline;
    let mut scene = Scene::new(outline, Material::new(100.0, 0.3, Plane::Strain).unwrap());
    scene.problem = problem;
    scene.problem.sides[0].condition = Condition::held();
    scene.check().unwrap();
    scene.problem.sides[6].condition = Condition::held();
    assert!(scene.check().unwrap_err().message.contains("a condition in [sides] too"));
    scene.problem.touch(6, Contact { gap: read("0"), friction: Friction::None });
    assert!(scene.check().unwrap_err().message.contains("in two conditions"));
}

/// Who carries changes the discretisation and nothing else: data that are not the same on both sides are those of the first place.
#[test]
fn data_that_differ_on_both_sides_are_those_of_the_first_place() {
    let vary = |gap: &str| contact(gap, Friction::None);
    let rub = |coefficient: &str| contact("0", Friction::Coulomb(read(coefficient)));
    let apart = [0.0, 1e-9, 1e-5, 0.2];
    for (law, of_first) in [
        (vary("-0.1"), [false; 4]),
        (vary("-0.1*x"), [false, false, true, true]),
        (vary("-0.1*s"), [true; 4]),
        (rub("0.3"), [false; 4]),
        (rub("0.3+y"), [false, false, true, true]),
        // lengths are the same on parallel lines
        (contact("0", Friction::Tresca(read("0.3"))), [false; 4]),
        (contact("0", Friction::Tresca(read("0.3+x"))), [false, false, true, true]),
    ] {
        for (distance, of_first) in apart.into_iter().zip(of_first) {
            let join = |places: [usize; 2], carrier: Option<Place>| {
                stack(2, distance)
                    .join(&[places[0]], &[places[1]], law.clone(), carrier)
                    .map(|i| (i.place, i.sides.clone()))
            };
            for places in [[4, 2], [2, 4]] {
                assert_eq!(join(places, Some(Place::First)).unwrap(), (Place::First, vec![places[0]]));
                let second = join(places, Some(Place::Second));
                match of_first {
                    false => assert_eq!(second.unwrap(), (Place::Second, vec![places[1]])),
                    true => {
                        let error = second.unwrap_err();
                        assert!(error.message.contains("are those of the first one"), "{}", error.message);
                        assert!(error.help.contains("exchange"), "{}", error.help);
                        assert_eq!(join(places, None).unwrap().0, Place::First, "{law:?} {distance}");
                    }
                }
            }
        }
    }
}

/// On circles lengths differ as much as radii.
#[test]
fn bounds_per_length_are_those_of_the_first_place_on_circles() {
    for (radius, is_free) in [(1.0 + 1e-9, true), (1.01, false)] {
        let disc = Polygon::new(Loop::circle([0.0, 0.0], 1.0, 4, "out"), vec![]).unwrap();
        let ring =
            Polygon::new(Loop::circle([0.0, 0.0], 2.0, 4, "out"), vec![Loop::circle([0.0, 0.0], radius, 4, "in")])
                .unwrap();
        let material = Material::new(100.0, 0.3, Plane::Strain).unwrap();
        let bodies = ["disc", "ring"].map(|name| Body::new(name, Substance::Homogeneous(material))).to_vec();
        let outlines = vec![disc.with_body_name("disc"), ring.with_body_name("ring")];
        let mut problem = Problem::of_bodies(Polygon::assembly(outlines), bodies);
        let side = |name: &str| problem.sides.iter().position(|side| side.name == name).unwrap();
        let (rim, hole) = (side("disc.out"), side("ring.in"));
        let law = contact("0", Friction::Tresca(read("0.3")));
        let joined = problem.join(&[rim], &[hole], law, Some(Place::Second)).map(|_| ());
        assert_eq!(joined.is_ok(), is_free, "{radius}");
    }
}

/// Where bodies see one another depends on shapes and moduli: a problem that is changed is not answered from memory.
#[test]
fn a_changed_problem_sees_anew() {
    let mut problem = stack(2, 0.25);
    problem.join(&[4], &[2], contact("0", Friction::None), None).unwrap();
    let spans = |problem: &Problem| problem.spans(&problem.interfaces()[0]);
    let before = spans(&problem);
    assert_eq!(before.len(), 1);
    assert_eq!((spans(&problem), spans(&problem.clone())), (before.clone(), before.clone()));
    // the upper block moves to the right by half of its width
    let mut moved = problem.clone();
    let corners = |x: f64, y: f64| vec![[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]];
    let block = |x, y, sides: &[Side]| {
        let names = sides.iter().map(|side| side.name.clone()).collect();
        Polygon::new(Loop::straight(corners(x, y), names), vec![]).unwrap()
    };
    let blocks = vec![block(0.0, 0.0, &problem.sides[..4]), block(0.5, 1.25, &problem.sides[4..])];
    moved.outline = Polygon::assembly(blocks);
    let after = spans(&moved);
    let length = |spans: &[Span]| spans.iter().map(|span| span.s[1] - span.s[0]).sum::<f64>();
    assert!((length(&before) - 1.0).abs() < 1e-9 && (length(&after) - 0.5).abs() < 1e-9, "{before:?} {after:?}");
}

/// Dundurs' β along the carrying side: 0 between bodies of one material, the same whichever carries, and beside a body that is a million times as
/// stiff that of an obstacle, (1-2ν)/(2(1-ν)).
#[test]
fn the_mismatch_of_materials_is_that_of_dundurs() {
    let beta = |young: f64, poisson: f64, other: usize| {
        let mut problem = stack(2, 0.0);
        let material = Material::new(young, poisson, Plane::Strain).unwrap();
        problem.bodies[other] = Body::new(&format!("{other}"), Substance::Homogeneous(material));
        let carrying = problem.join(&[4], &[2], contact("0", Friction::None), None).unwrap().sides[0];
        problem.dundurs_beta(problem.outline.edges().iter().position(|edge| edge.side == carrying).unwrap())
    };
    assert!(beta(100.0, 0.3, 0) < 1e-15);
    let obstacle = (1.0 - 2.0 * 0.3) / (2.0 * (1.0 - 0.3));
    for other in [0, 1] {
        let found = beta(1e8, 0.2, other);
        assert!((found / obstacle - 1.0).abs() < 1e-5, "{found} {obstacle}");
        // by Young's moduli and Poisson's ratios, E = 300, 0.1 and 100, 0.3
        let of = |e: f64, nu: f64| [(1.0 + nu) * (1.0 - 2.0 * nu) / e, 2.0 * (1.0 - nu * nu) / e];
        let (soft, stiff) = (of(100.0, 0.3), of(300.0, 0.1));
        let exact = (soft[0] - stiff[0]).abs() / (soft[1] + stiff[1]);
        assert!((beta(300.0, 0.1, other) / exact - 1.0).abs() < 1e-13);
    }
    let alone = stack(1, 0.0).dundurs_beta(0);
    assert!((alone / obstacle - 1.0).abs() < 1e-14, "{alone} {obstacle}");
}
