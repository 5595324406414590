//! Where contact ends, judged by Westergaard's wave: a strip that is pressed on cosines touches them from -a to a.

use std::f64::consts::PI;

use steklov_model::quantities::Quantity;
use steklov_model::summary::Summary;
use steklov_problem::Scene;
use steklov_tests::{parse, scene, summary as solved};

/// The whole wave of length 1 or the half of it that `from` and `to` have, in a frame that is turned by 0 or ±90°, and mirrored.
fn wave([from, to]: [f64; 2], a: f64, (angle, mirrored): (f64, bool), more: &str) -> Scene {
    let pressure = 0.03452299619329442 * (PI * a).sin().powi(2);
    let (sin, cos) = f64::sin_cos(angle);
    let place = |[x, y]: [f64; 2]| {
        let x = if mirrored { -x } else { x };
        format!("[{:?}, {:?}]", cos * x - sin * y, sin * x + cos * y)
    };
    let (mut corners, mut sides) =
        ([[from, 0.0], [to, 0.0], [to, 3.0], [from, 3.0]], ["floor", "right", "top", "left"]);
    if mirrored {
        corners = [corners[1], corners[0], corners[3], corners[2]];
        sides = ["floor", "left", "top", "right"];
    }
    let places = corners.map(place).join(", ");
    let held = if angle == 0.0 { "[0, \"free\"]" } else { "[\"free\", 0]" };
    let walls = format!("sides.left.displacement = {held}\nsides.right.displacement = {held}\n");
    // s runs along the floor
    let x = if mirrored { format!("({to:?} - {:?}*s)", to - from) } else { format!("({from:?} + {:?}*s)", to - from) };
    parse(
        &format!(
            "body = {{ corners = [{places}], sides = {sides:?} }}\nmaterial = {{ young = 1, poisson = 0.3 }}\n{walls}\
             sides.top.pressure = {pressure:?}\nsides.floor.contact.gap = \"0.01*(1 - cos(2*pi*{x}))\"\n{more}"
        ),
        &[],
    )
    .unwrap_or_else(|e| panic!("{}", e.render()))
}

fn length(summary: &Summary) -> &Quantity {
    summary.quantities.get("contact.length").unwrap_or_else(|| panic!("{:?}", summary.quantities))
}

/// Source: Westergaard (1939), bearing pressures and cracks.
#[test]
fn ends_of_contact_are_known_to_ten_digits() {
    for a in [0.1, 0.25, 0.4] {
        for tolerance in ["1e-2", "1e-3", "1e-4", "1e-5", "1e-6"] {
            let summary = solved(&wave([0.0, 0.5], a, (0.0, false), &format!("method.tolerance = {tolerance}\n")));
            let Quantity { value, uncertainty, doubts, .. } = length(&summary);
            let error = (value - a).abs();
            println!("{a} {tolerance}, {} dofs: {value} ± {uncertainty:.1e}, off by {error:.1e}", summary.dofs);
            assert!(error <= *uncertainty && doubts.is_empty(), "{a} at {tolerance}: {error:e} and {uncertainty:e}");
            assert_eq!(*value, summary.contact.as_ref().unwrap().length);
            let rate = tolerance.parse::<f64>().unwrap();
            assert!(*uncertainty < 5e-2 * rate, "{a} at {tolerance}: {uncertainty:e}");
        }
    }
}

/// The other half of the wave, all of it, and both in other places: the ends are the same.
#[test]
fn ends_do_not_depend_on_the_frame() {
    let ways = [
        ([0.5, 1.0], (0.0, false), 1.0),
        ([0.0, 0.5], (0.0, true), 1.0),
        ([-0.5, 0.5], (0.0, false), 2.0),
        ([0.0, 1.0], (0.0, false), 2.0),
        ([0.0, 0.5], (PI / 2.0, false), 1.0),
        ([0.0, 0.5], (-PI / 2.0, true), 1.0),
    ];
    for (ends, frame, zones) in ways {
        let summary = solved(&wave(ends, 0.25, frame, "method.tolerance = 1e-5\n"));
        let Quantity { value, uncertainty, .. } = length(&summary);
        let error = (value - zones * 0.25).abs();
        println!("{ends:?} {frame:?}: {value} ± {uncertainty:.1e}, off by {error:.1e}");
        assert!(error <= *uncertainty && *uncertainty < 2e-6, "{ends:?} {frame:?}: {error:e} and {uncertainty:e}");
    }
}

/// A block that touches with all of a side has an exact length; with friction a piece beside the free corner may be open between nodes.
#[test]
fn contact_all_along_a_side_is_exact() {
    let block = |friction: &str| {
        let text = format!(
            "body = {{ corners = [[0, 0], [1, 0], [1, 1], [0, 1]], sides = [\"floor\", \"right\", \"top\", \"axis\"] }}\n\
             material = {{ young = 100, poisson = 0.25 }}\nsides.axis.displacement = [0, \"free\"]\nsides.top.pressure = \"1 + x\"\n\
             sides.floor.contact = {{ gap = 0{friction} }}\nmethod.tolerance = 1e-3\n"
        );
        solved(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render())))
    };
    let summary = block("");
    let Quantity { value, uncertainty, doubts, .. } = length(&summary);
    assert!((value - 1.0).abs() < 1e-12 && *uncertainty < 1e-10 && doubts.is_empty(), "{value} ± {uncertainty}");
    let summary = block(", friction = { coulomb = 0.1 }");
    let Quantity { value, uncertainty, .. } = length(&summary);
    assert!((value - 1.0).abs() < 1e-12 && *uncertainty > 1e-6 && *uncertainty < 0.1, "{value} ± {uncertainty}");
}

/// Tresca's friction: ends that were extrapolated by another code, to what is known of them.
#[test]
fn ends_with_friction_are_those_of_another_code() {
    // (scene, length, how well that is known)
    let known = [
        ("15-block-on-floor", 0.85802928, 4e-8),
        ("17-wedge-gap", 0.51998462, 6e-8),
        ("24-kink-in-an-element", 0.5028999, 4e-7),
    ];
    for (name, exact, known) in known {
        for tolerance in ["1e-4", "1e-5", "1e-6"] {
            let summary = solved(&scene(name, &[&format!("method.tolerance={tolerance}")]));
            let Quantity { value, uncertainty, .. } = length(&summary);
            let error = (value - exact).abs();
            println!("{name} {tolerance}: {value} ± {uncertainty:.1e}, off by {error:.1e}");
            assert!(error <= uncertainty + known, "{name} at {tolerance}: {error:e} and {uncertainty:e}");
            let rate = tolerance.parse::<f64>().unwrap();
            assert!(*uncertainty < 0.3 * rate, "{name} at {tolerance}: {uncertainty:e}");
        }
    }
}

/// Where contact reaches a corner by nodes alone, and a short piece beside it may be open, the bar has the distance to the next node.
#[test]
fn contact_that_may_end_beside_a_corner_is_inside_its_bar() {
    let strip = |gap: &str, width: f64, held: &str, load: &str, tolerance: &str| {
        let text = format!(
            "body = {{ corners = [[0, 0], [{width}, 0], [{width}, 1], [0, 1]], sides = [\"floor\", \"right\", \"top\", \"left\"] }}\n\
             material = {{ young = 100, poisson = 0.3 }}\nsides.left.displacement = [0, {held}]\nsides.top.pressure = \"{load}\"\n\
             sides.floor.contact.gap = \"{gap}\"\nmethod.tolerance = {tolerance}\n"
        );
        solved(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render())))
    };
    // (gap, width, left side along y, pressure, tolerance): ends at 0.0074 from a corner, between nodes, and all nodes closed
    let scenes = [
        ("0.0085*abs(x - 1.456)", 1.931, "0", "0.222 + 0.172*x", "1e-2"),
        ("0.0033*(x - 0.724)^2*(1 + 0.26*(x - 0.724))", 1.528, "\"free\"", "0.133 + 0.221*x", "3e-3"),
        ("0.0033*(x - 0.394)^2*(1 + 0.102*(x - 0.394))", 1.145, "\"free\"", "0.177 + 0.215*x", "5e-2"),
    ];
    for (gap, width, held, load, tolerance) in scenes {
        let summary = strip(gap, width, held, load, tolerance);
        let Quantity { value, uncertainty, .. } = length(&summary);
        let exact = strip(gap, width, held, load, "1e-6").contact.expect("contact").length;
        println!("{gap}: {value} ± {uncertainty:.1e} for {exact}");
        assert!(
            (value - exact).abs() <= *uncertainty && *uncertainty < 0.3 * width,
            "{value} ± {uncertainty:e} for {exact}"
        );
    }
}
