//! Panels, spreads, tiles, boxes and bars of made-up values, from plain to extreme.

use crate::frame::{check, check_up_to, loops, rectangle};
use steklov_fields::triangulate::triangulate;
use steklov_picture::{
    BarGroup, DegreeBox, Ends, Layer, Obstacle, Panel, Shape, Spread, SpreadLoop, Tile, bars, boxes, panels, spread,
    tiles,
};

fn pressed([x, y]: [f64; 2]) -> [f64; 2] {
    [0.05 * x * (1.0 + 0.8 * y), -0.07 * (y + 0.5) * (1.0 - x * x) - 0.02 * x * x * (0.5 - y)]
}

#[test]
fn panels_of_plain_and_extreme_values() {
    let x: Vec<f64> = (0..60).map(|i| f64::from(i) / 59.0).collect();
    let layer = |name: &str, shape: Shape| Layer { name: name.to_owned(), shape };
    let panel = |y: &str, ends: Ends, layers: Vec<Layer>| Panel { x: "x".into(), y: y.into(), ends, layers };
    for (name, unit) in [("plain", 1.0), ("huge", 1e250), ("tiny", 1e-250)] {
        let curve = |k: usize| x.iter().map(|&x| [x, unit * (x * (k + 1) as f64).sin()]).collect::<Vec<_>>();
        let between = x.iter().map(|&x| [x, 0.0, unit * (1.0 + x)]).collect();
        let bars = (0..5).map(|i| [f64::from(i), f64::from(i + 1), unit * f64::from(i * i)]).collect();
        let eigenvalues = (1..9).map(|m| [f64::from(m), unit * (-f64::from(m)).exp()]).collect();
        let mut modes: Vec<Layer> = (0..6).map(|k| layer(&format!("mode {k}"), Shape::Curve(curve(k), k))).collect();
        modes.insert(0, layer("a band", Shape::Between(between)));
        let picture = panels(
            &format!("Panels of {name} values"),
            &[
                panel("modes", Ends::Zero, modes),
                panel("density", Ends::Zero, vec![layer("density", Shape::Bars(bars))]),
                panel("eigenvalues", Ends::Log, vec![layer("a", Shape::Points(eigenvalues, 2))]),
                panel("values", Ends::Values, vec![layer("", Shape::Across(vec![0.2, f64::NAN, 0.9], 1))]),
                panel("unit", Ends::Unit, vec![layer("gap", Shape::Curve(vec![[0.0, 0.0], [0.5, f64::NAN]], 0))]),
            ],
        )
        .unwrap();
        check_up_to(&format!("panels-{name}"), &picture, 2000.0);
        assert!(picture.svg.contains(">mode 5<") && picture.svg.contains(">a band<"));
    }
    check("panels-none", &panels("No panels", &[]).unwrap());
}

#[test]
fn spreads_of_a_body_with_a_hole() {
    let outside = rectangle([-1.0, -0.5], [1.0, 0.5]).to_vec();
    let inside: Vec<_> = (0..24).map(|i| -f64::from(i) * std::f64::consts::TAU / 24.0).collect();
    let inside: Vec<_> = inside.iter().map(|a| [0.3 * a.cos(), 0.3 * a.sin()]).collect();
    let foot = [[-1.0, -0.5], [1.0, -0.5]];
    let wall = Obstacle { points: &foot, gap: &[[0.0, -0.01], [0.0, -0.02]] };
    for (name, unit, off) in [("plain", 1.0, 0.2), ("small", 1e-9, 0.2), ("certain", 1.0, 0.0), ("wild", 1e-3, 50.0)] {
        let of = |points: &Vec<[f64; 2]>| SpreadLoop {
            points: points.clone(),
            mean: points.iter().map(|&p| pressed(p).map(|u| unit * u)).collect(),
            covariance: points
                .iter()
                .map(|p| [p[0] * p[0], 1.0, p[0]].map(|c| (0.05 * unit * off).powi(2) * c))
                .collect(),
        };
        let loops = [of(&outside), of(&inside)];
        let title = format!("A {name} spread");
        let obstacles = [wall];
        let all =
            Spread { title: &title, loops: &loops, obstacles: &obstacles, window: None, enlarge: None, unit: None };
        let part = Spread { window: Some([[-0.2, -0.6], [0.7, 0.1]]), enlarge: Some(unit), unit: Some("mm"), ..all };
        let picture = spread(&part).unwrap();
        check(&format!("spread-{name}-part"), &picture);
        assert!(picture.svg.contains(">x in mm<") && picture.svg.contains("largest mean"), "{}", picture.svg);
        let picture = spread(&all).unwrap();
        check(&format!("spread-{name}"), &picture);
        assert!(picture.svg.contains("deviation") && picture.svg.contains(">obstacle of the mean input<"));
    }
}

#[test]
fn tiles_boxes_and_bars() {
    let t = triangulate(&loops(&[&rectangle([0.0, 0.0], [2.0, 1.0])]), 300).unwrap();
    for count in [1, 2, 6] {
        let tile = |m: usize| Tile {
            caption: format!("mode {m}"),
            values: t.points.iter().map(|p| (m as f64 * p[0]).cos() * p[1]).collect(),
        };
        let all: Vec<Tile> = (1..=count).map(tile).collect();
        let picture = tiles("Modes", "mode", &t.points, &t.triangles, &t.outline, &all).unwrap();
        check(&format!("tiles-{count}"), &picture);
        assert_eq!(picture.svg.matches(">mode ").count(), count);
    }
    let flat = triangulate(&loops(&[&rectangle([0.0, 0.0], [20.0, 0.1])]), 300).unwrap();
    let still = Tile { caption: "nothing".into(), values: vec![0.0; flat.points.len()] };
    check("tiles-flat", &tiles("Flat", "mode", &flat.points, &flat.triangles, &flat.outline, &[still]).unwrap());

    let square = |i: usize, j: usize| {
        let low = [0.25 * i as f64 - 1.0, 1e-3 * j as f64];
        DegreeBox { corners: [low, [low[0] + 0.25, low[1] + 1e-3]], degree: [i + 1, j] }
    };
    let grid: Vec<DegreeBox> = (0..8).flat_map(|i| (0..4).map(move |j| square(i, j))).collect();
    let picture =
        boxes("Cells", ["tilt", "the load on a side with quite a long name"], &grid, &[[-0.9, 5e-4], [f64::NAN, 0.0]])
            .unwrap();
    check("boxes", &picture);
    assert!(picture.svg.contains(">8 × 3<") && picture.svg.contains(">tilt<"));

    let names: Vec<String> = (0..12).map(|i| format!("germ {i} of a field with quite a long name")).collect();
    let group = |k: usize| BarGroup {
        caption: format!("quantity {k}"),
        values: (0..12).map(|i| if i == 3 { f64::NAN } else { 0.1f64.powi(2 * i) * k as f64 }).collect(),
    };
    let picture = bars("Effects", "total effect", &names, &[group(0), group(1), group(2)]).unwrap();
    check_up_to("bars", &picture, 1200.0);
    assert!(picture.svg.contains(">quantity 2<") && picture.svg.contains(">total effect<"));
}
