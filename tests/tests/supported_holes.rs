//! Holes in an unbounded medium that supports or obstacles hold: no force may depend on the length in the logarithm.

use steklov_model::summary::Summary;
use steklov_tests::{adapt, parse};

/// A hole on a rigid insert that it touches below and above.
const INSERT: &str = r#"
[body]
corners = [[-1,-1],[1,-1],[1,1],[-1,1]]
sides = ["b","r","t","l"]
HOLE
[exterior]
young = 10.0
poisson = 0.3
remote_stress = [0,-0.5,0]
[probe]
points = [[2,0]]
[method]
refine = "none"
elements = ELEMENTS
degree = 3
"#;

const TOUCHED: &[&str] = &["sides.b.contact.gap = \"0.05*(s-0.5)^2\"", "sides.t.contact.gap = \"0.05\""];
const HELD: &[&str] = &["sides.b.displacement = [\"0\", \"0\"]", "sides.t.traction = [\"0\", \"0.3\"]"];
const PUSHED: &[&str] = &["sides.t.traction = [\"0\", \"0.3\"]"];

/// Solved with 64 elements on its sides, alone or with a small free hole at a distance, which has four of its own.
fn solved(sides: &[&str], far: Option<f64>, more: &[&str]) -> Summary {
    let hole = far.map_or(String::new(), |d| {
        let [a, b] = [d, d + 0.001];
        format!(
            "[[body.holes]]\ncorners = [[{a},0],[{b},0],[{b},0.001],[{a},0.001]]\nsides = [\"f\",\"f\",\"f\",\"f\"]"
        )
    });
    let elements = if far.is_some() { "68" } else { "64" };
    let text = INSERT.replace("HOLE", &hole).replace("ELEMENTS", elements);
    let text = sides.join("\n") + "\n" + &text;
    let scene = parse(&text, more).unwrap_or_else(|e| panic!("{}", e.render()));
    let run = adapt(&scene).unwrap_or_else(|e| panic!("{e}"));
    Summary::of_run(&scene, &run, None)
}

fn doubts_length(s: &Summary) -> bool {
    s.estimate_doubts.iter().any(|d| d == "length")
}

/// What a free hole does so far away is below (0.001/50)² of anything; it makes the length in the logarithm 18 to 360 times as
/// large.
#[test]
fn forces_on_inserts_do_not_know_holes_far_away() {
    for (name, sides) in [("touched", TOUCHED), ("held", HELD)] {
        let alone = solved(sides, None, &[]);
        assert!(!doubts_length(&alone) && alone.exterior.as_ref().is_some_and(|e| e.radiation == "bounded"));
        let total = alone.reactions.values().fold([0.0; 2], |s, f| [s[0] + f[0], s[1] + f[1]]);
        // what is held takes the traction, and an insert takes nothing
        let load = if name == "held" { 0.6 } else { 0.0 };
        assert!(total[0].abs() < 1e-9 && (total[1] + load).abs() < 1e-9, "{name}: {total:?}");
        for far in [50.0, 1000.0] {
            let other = solved(sides, Some(far), &[]);
            println!("{name} {far}: {:?} {:?} {:?}", alone.reactions, other.reactions, other.energy - alone.energy);
            for (side, force) in &alone.reactions {
                let off = (0..2).map(|i| (force[i] - other.reactions[side][i]).abs()).fold(0.0, f64::max);
                assert!(off < 1e-8, "{name}, {side}: {off:e}");
            }
            let stress = |s: &Summary| s.probe[0].stress;
            assert!((0..3).all(|k| (stress(&alone)[k] - stress(&other)[k]).abs() < 1e-8), "{name}");
        }
    }
    let [below, above] = ["b", "t"].map(|side| solved(TOUCHED, None, &[]).reactions[side][1]);
    assert!((below + 1.2206).abs() < 2e-3 && (above - 1.2206).abs() < 2e-3, "{below} {above}");
}

#[test]
fn what_depends_on_the_length_is_in_doubt() {
    let decaying = ["exterior.at_infinity=\"decaying\""];
    for (sides, more, doubted) in [
        (TOUCHED, &decaying[..], true),
        (HELD, &decaying, true),
        (PUSHED, &[], true),
        (HELD, &[], false),
        (&[], &[], false),
    ] {
        assert_eq!(doubts_length(&solved(sides, None, more)), doubted, "{sides:?} {more:?}");
    }
    // forces with decay do depend on it, stresses without supports do not
    let force = |far| solved(TOUCHED, far, &decaying).reactions["b"][1];
    assert!((force(None) - force(Some(1000.0))).abs() > 1e-2);
    let stress = |far| solved(PUSHED, far, &[]).probe[0].stress;
    assert!((0..3).all(|k| (stress(None)[k] - stress(Some(1000.0))[k]).abs() < 1e-8));
}
