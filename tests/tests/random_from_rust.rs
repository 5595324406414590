//! Random input that a program gives: what does not say the same as the expressions is refused, and not solved with nominal values.

use steklov_problem::{DataErrorKind, Random, RandomName, Scene};
use steklov_tests::parse;

/// A square on a floor whose modulus, gap, friction, support and load are given.
fn scene([young, gap, friction, held, load]: [&str; 5]) -> Scene {
    let text = format!(
        "[body]\ncorners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]\n\
         sides = [\"floor\", \"right\", \"top\", \"left\"]\n[material]\nyoung = \"{young}\"\npoisson = 0.3\n\
         [sides.floor]\ncontact = {{ gap = \"{gap}\", friction = {{ tresca = \"{friction}\" }} }}\n\
         [sides.top]\ndisplacement = [\"0\", \"{held}\"]\n[sides.left]\ntraction = [\"{load}\", \"0\"]\n\
         [random.Q]\ndistribution = \"uniform\"\nlow = 1.5\nhigh = 2.5\n\
         [random.R]\ndistribution = \"normal\"\nmean = 3\ndeviation = 0.1\n"
    );
    parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))
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
fn data_that_use_random_names_without_saying_so_are_refused() {
    for (k, varying) in VARYING.into_iter().enumerate() {
        let given = with(varying);
        given.check().expect("a scene that fits");
        let uses = given.random.as_ref().expect("random input").uses;
        assert_eq!([uses.young, uses.contact, uses.held, uses.loads], [k == 0, k == 1 || k == 2, k == 3, k == 4]);
        for flag in 0..4 {
            let mut wrong = given.clone();
            let uses = &mut random(&mut wrong).uses;
            let flag = [&mut uses.young, &mut uses.contact, &mut uses.held, &mut uses.loads].into_iter().nth(flag);
            flag.map(|flag| *flag = !*flag).expect("a flag");
            assert!(refusal(&wrong).starts_with("random.uses is Uses { young: "), "{}", refusal(&wrong));
        }
    }
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
fn jumps_at_which_stochastic_elements_do_not_end_are_refused() {
    let given = with((4, "if(Q > 2.25, 1, 0)"));
    given.check().expect("a scene that fits");
    let cuts = given.random.as_ref().expect("random input").cuts.clone();
    assert!(cuts.len() == 1 && cuts[0].len() == 1, "{cuts:?}");
    assert!((given.random.as_ref().expect("random input").germs[0].variable.value(cuts[0][0]) - 2.25).abs() < 1e-12);
    for wrong_cuts in [vec![], vec![vec![]], vec![vec![0.0]], vec![cuts[0].clone(), vec![]]] {
        let mut wrong = given.clone();
        random(&mut wrong).cuts = wrong_cuts;
        assert!(refusal(&wrong).starts_with("random.cuts is ["), "{}", refusal(&wrong));
    }
}

#[test]
fn random_input_of_several_bodies_is_refused() {
    let body = |name: &str, y: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\ncorners = [[0, {y}], [1, {y}], [1, {}], [0, {}]]\n\
             sides = [\"bottom\", \"right\", \"top\", \"left\"]\nmaterial = {{ young = 1e3, poisson = 0.3 }}\n",
            y + 1.0,
            y + 1.0
        )
    };
    let text = format!(
        "{}{}[sides.low.bottom]\ndisplacement = [\"0\", \"0\"]\n[sides.high.top]\ndisplacement = [\"0\", \"-0.01\"]\n\
         [[interface]]\nbetween = [\"low.top\", \"high.bottom\"]\ncontact = true\n",
        body("low", 0.0),
        body("high", 1.0)
    );
    let mut several = parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render()));
    several.check().expect("two bodies");
    let mut random = with(VARYING[0]).random;
    random.as_mut().expect("random input").constants.young = None;
    several.random = random;
    let error = several.check().expect_err("random input of two bodies");
    assert_eq!(error.kind, DataErrorKind::Unsupported);
    assert_eq!(error.message, "random input is for one body, and there are several");
}
