//! The largest von Mises stress with its place and its error bar, judged by closed forms and by many points.

use steklov_model::quantities::Quantity;
use steklov_model::summary::Summary;
use steklov_tests::{parse, scene, summary};

/// Value, uncertainty and place.
fn largest(summary: &Summary) -> (f64, f64, [f64; 2]) {
    let Quantity { value, uncertainty, .. } = summary.quantities["max_von_mises"];
    let told = summary.max_von_mises.zip(summary.max_von_mises_at);
    let (told, place) = told.expect("where there is a bar there is a value");
    assert_eq!(value, told);
    (value, uncertainty, place)
}

/// Von Mises stress in plane strain of principal stresses in the plane.
fn von_mises([a, b]: [f64; 2], poisson: f64) -> f64 {
    let c = poisson * (a + b);
    (((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2)) / 2.0).sqrt()
}

/// Lamé's tube at its inner radius, Kirsch's hole beside the tension, NAFEMS LE1 at its point D, where the hoop stress is 92.65818.
#[test]
fn closed_forms_are_inside_their_bars() {
    let all = [
        ("lame-tube", von_mises([-1.0, 5.0 / 3.0], 0.3), 1.0),
        ("kirsch-on-a-circle", von_mises([3.0, 0.0], 0.3), 1.0),
        ("nafems-le1", 92.658_182, 2.0),
    ];
    for (name, exact, radius) in all {
        for tolerance in ["1e-1", "1e-2", "1e-3", "1e-5"] {
            let summary = summary(&scene(name, &[&format!("method.tolerance={tolerance}")]));
            let (value, bar, place) = largest(&summary);
            let error = (value - exact).abs();
            println!("{name} {tolerance}: {value} ± {bar:.1e}, off by {error:.1e}, at {place:?}");
            assert!(error <= 2.0 * bar + 1e-6 * exact && bar <= 0.2 * exact, "{name} {tolerance}: {value} ± {bar:e}");
            assert!((place[0].hypot(place[1]) - radius).abs() < 1e-6, "{name} {tolerance}: {place:?}");
        }
    }
}

/// At a corner of a side with stiff springs, or so near to it that elements do not show it, it is in doubt.
#[test]
fn corners_of_springs_are_in_doubt() {
    let at = |tolerance: &str| {
        let text = format!(
            "body = {{ corners = [[-2, -2], [2, -2], [2, 2], [-2, 2]], sides = [\"bottom\", \"right\", \"top\", \"left\"] }}\n\
             material = {{ young = 1635, poisson = 0.155 }}\nsides.bottom.springs = [2.65e5, 4.719e5]\n\
             sides.top.traction = [\"-0.11 + 0.3*x\", \"-1.86 + 0.5*x\"]\nmethod.tolerance = {tolerance}\n\
             quantities.m = {{ moment = \"bottom\", about = [0, 0] }}\n"
        );
        summary(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render())))
    };
    let (exact, _, _) = largest(&at("1e-7"));
    for tolerance in ["3e-2", "3e-3", "1e-3", "1e-6"] {
        let own = at(tolerance);
        let (value, bar, place) = largest(&own);
        println!("{tolerance}: {value} ± {bar:.1e} for {exact}, at {place:?}");
        assert!((value - exact).abs() <= 2.0 * bar, "{value} ± {bar} for {exact}, at {place:?}");
        assert!(!own.quantities["max_von_mises"].doubts.is_empty(), "{tolerance}");
    }
}

/// Below contact it is larger than anywhere on the boundary: no point of a lattice is above it, and one is near.
#[test]
fn the_largest_stress_below_contact_is_no_less_than_at_any_point() {
    for (name, [low, high]) in [("numbers-by-names", [0.0, 0.3]), ("hertz-block", [1e-3, 0.05])] {
        let own = summary(&scene(name, &["method.tolerance=1e-4"]));
        let (value, bar, [x, y]) = largest(&own);
        let points: Vec<String> = (0..=40)
            .flat_map(|i| (0..=10).map(move |k| (i, k)))
            .map(|(i, k)| {
                format!("[{}, {}]", (high - low) * f64::from(k) / 40.0 + 1e-6, low + (high - low) * f64::from(i) / 40.0)
            })
            .collect();
        let points = format!("probe.points=[{}]", points.join(", "));
        let sampled = summary(&scene(name, &["method.tolerance=1e-4", &points]));
        let best = sampled.probe.iter().filter_map(|probe| probe.von_mises).fold(0.0, f64::max);
        println!("{name}: {value} ± {bar:.1e} at ({x}, {y}), {best} at the points");
        assert!(best <= value * (1.0 + 1e-9) && best >= 0.99 * value, "{name}: {best} of {value}");
        assert!(x.abs() < 1e-3 && (low..high).contains(&y), "{name}: ({x}, {y})");
        let finer = summary(&scene(name, &["method.tolerance=1e-6"]));
        let (reference, ..) = largest(&finer);
        assert!((value - reference).abs() <= 2.0 * bar && bar <= 1e-2 * value, "{name}: {value} {reference} {bar}");
    }
}

#[test]
fn it_is_not_told_where_a_stress_is_infinite() {
    for name in ["wedge-gap", "l-shape"] {
        let summary = summary(&scene(name, &["method.tolerance=1e-1", "probe.points=[[0.1, 0.1]]"]));
        let told = summary.max_von_mises.is_some() || summary.quantities.contains_key("max_von_mises");
        assert!(!told && !summary.infinite_stress.is_empty(), "{name}: {:?}", summary.max_von_mises);
    }
}

/// The medium about a soft inclusion is stressed more than that; that about a lining is a body of its own.
#[test]
fn it_is_not_told_of_an_inclusion() {
    let inclusion = "body = { circle = { centre = [0, 0], radius = 1 }, side = \"rim\" }\n\
                     material = { young = 1, poisson = 0.3 }\nprobe.points = [[0, 0]]\n\
                     exterior = { young = 5, poisson = 0.3, remote_stress = [1, 0, 0] }\n";
    let own = summary(&parse(inclusion, &[]).unwrap_or_else(|e| panic!("{}", e.render())));
    assert!(own.max_von_mises.is_none() && !own.quantities.contains_key("max_von_mises"));
    assert!(own.infinite_stress.is_empty() && own.quantities.contains_key("probe.0.von_mises"));

    let soft = ["material.young=0.05", "method.tolerance=1e-4", "probe.points=[[1.3, 0]]"];
    let lining = summary(&scene("round-lining", &soft));
    let (value, _, place) = largest(&lining);
    let beside = lining.probe[0].von_mises.expect("a finite stress");
    assert!((place[0].hypot(place[1]) - 1.25).abs() < 1e-6 && value > beside, "{value} at {place:?}, {beside}");
}

/// A hole of which a part lifts off what fills it, in a medium in which the stress rises from its sides to that far away: the largest one is
/// at the hole. Under tractions of the uniform stress it is that everywhere.
#[test]
fn the_largest_stress_of_a_medium_is_near_its_holes() {
    let text = |sides: &str| {
        format!(
            "body = {{ circle = {{ centre = [2, 1], radius = 3 }}, side = \"w\" }}\n\
             exterior = {{ young = 100, poisson = 0.3, remote_stress = [0, -3, 0], at_infinity = \"bounded\" }}\n{sides}\
             probe.points = [[4.2, 3.2], [2, 4.5], [5.5, 1], [2, 9]]\nmethod.tolerance = 1e-2\n"
        )
    };
    let own = summary(&parse(&text("sides.w.contact.gap = \"-0.03\"\n"), &[]).unwrap());
    let (value, _, [x, y]) = largest(&own);
    let best = own.probe.iter().filter_map(|probe| probe.von_mises).fold(von_mises([0.0, -3.0], 0.3), f64::max);
    println!("{value} at ({x}, {y}), {best} at points and far away");
    assert!(best < value && ((x - 2.0).hypot(y - 1.0) - 3.0).abs() < 1.0, "{value} at ({x}, {y}), {best} elsewhere");
    // tractions of the uniform stress
    let uniform = "sides.w.traction = [0, \"-3*(-(y - 1)/3)\"]\n";
    let (value, ..) = largest(&summary(&parse(&text(uniform), &[]).unwrap()));
    assert!((value / von_mises([0.0, -3.0], 0.3) - 1.0).abs() < 1e-12, "{value}");
}
