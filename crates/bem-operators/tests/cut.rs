//! Bodies cut into pieces: areas, sides and what is drawn on them stay.

use std::f64::consts::TAU;

use proptest::prelude::*;
use steklov_bem_operators::{Cut, CutError, Edge, Loop, Path, Polygon};
use steklov_quadrature::gauss_legendre;

/// ½ ∮ x × dx.
fn area(edges: &[Edge]) -> f64 {
    let rule = gauss_legendre(24);
    let of = |edge: &Edge| {
        let sign = if edge.reversed { -0.5 } else { 0.5 };
        let cross = |s: f64| {
            let (x, d) = (edge.point(s), edge.derivative(s));
            sign * (x[0] * d[1] - x[1] * d[0])
        };
        (0..4).map(|k| rule.mapped(k as f64 / 4.0, (k + 1) as f64 / 4.0).integrate(cross)).sum::<f64>()
    };
    edges.iter().map(of).sum()
}

fn line(a: [f64; 2], b: [f64; 2], name: &str) -> Cut {
    Cut { ends: [a, b], sides: ["+", "-"].map(|sign| format!("{name}{sign}")) }
}

/// A star with arcs, cubics or lines, two holes and two lines across all of it.
fn star() -> impl Strategy<Value = (Polygon, Vec<Cut>)> {
    let radii = prop::collection::vec(2.0..3.0f64, 7);
    let bulges = prop::collection::vec((0..3u8, -0.5..0.5f64), 7);
    (radii, bulges, 0.0..TAU, -0.6..0.6f64, 0.8..2.2f64, any::<bool>()).prop_map(
        |(radii, bulges, angle, off, turn, flip)| {
            let corner = |k: usize| {
                let (sin, cos) = (TAU * k as f64 / 7.0).sin_cos();
                [radii[k] * cos, radii[k] * sin]
            };
            let corners: Vec<[f64; 2]> = (0..7).map(corner).collect();
            let path = |k: usize| {
                let ([a, b], (kind, bulge)) = ([corners[k], corners[(k + 1) % 7]], bulges[k]);
                let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
                let control = |part: f64| [a[0] + part * dx + bulge * dy * 0.4, a[1] + part * dy - bulge * dx * 0.4];
                match kind {
                    0 => Path::Line,
                    1 => Path::Arc { opening: bulge },
                    _ => Path::Cubic { control: [control(0.3), control(0.6)] },
                }
            };
            let outer = Loop {
                paths: (0..7).map(path).collect(),
                ..Loop::straight(corners.clone(), (0..7).map(|k| format!("side {k}")).collect())
            };
            let mut square = vec![[0.3, 0.2], [0.7, 0.2], [0.7, 0.6], [0.3, 0.6]];
            if flip {
                square.reverse();
            }
            let hole = Loop::straight(square, vec!["hole".into(); 4]);
            let round = Loop::ellipse([-0.6, -0.2], [0.4, 0.25], 0.3, 4, "round");
            let polygon = Polygon::new(outer, vec![hole, round]).unwrap();
            let across = |angle: f64, off: f64, name: &str| {
                let (sin, cos) = angle.sin_cos();
                line(
                    [-5.0 * cos - off * sin, -5.0 * sin + off * cos],
                    [5.0 * cos - off * sin, 5.0 * sin + off * cos],
                    name,
                )
            };
            (polygon, vec![across(angle, off, "one"), across(angle + turn, -off / 2.0, "two")])
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn pieces_are_the_body((polygon, cuts) in star()) {
        let cut = match polygon.cut(&cuts) {
            Ok(cut) => cut,
            Err(CutError::NextToCorner { .. }) => return Ok(()),
            Err(error) => panic!("{error}"),
        };
        prop_assert!(cut.bodies().len() >= 3);
        let whole = area(polygon.edges());
        let pieces: Vec<f64> = cut.bodies().iter().map(|loops| {
            let edges = cut.loops()[loops.start].start..cut.loops()[loops.end - 1].end;
            area(&cut.edges()[edges])
        }).collect();
        prop_assert!(pieces.iter().all(|area| *area > 0.0));
        prop_assert!((pieces.iter().sum::<f64>() / whole - 1.0).abs() < 1e-12);
        // loops are closed, bit by bit
        for one in cut.loops() {
            let edges = &cut.edges()[one.clone()];
            prop_assert!((0..edges.len()).all(|k| edges[k].end == edges[(k + 1) % edges.len()].start));
        }
        // every side has the length that it had, and its points the fraction of their edge that they had
        for (side, name) in polygon.side_names().iter().enumerate() {
            let length = |of: &Polygon| of.edges().iter().filter(|e| e.side == side).map(Edge::length).sum::<f64>();
            prop_assert!((length(&cut) / length(&polygon) - 1.0).abs() < 1e-9, "{name}");
        }
        for edge in cut.edges().iter().filter(|edge| edge.side < polygon.side_names().len()) {
            for s in [0.0, 0.3, 0.5, 0.9, 1.0] {
                let x = edge.point(s);
                let of_side = polygon.edges().iter().filter(|old| old.side == edge.side);
                let near = of_side.filter_map(|old| old.nearest(x, 1e-9).map(|(_, s)| old.drawn_fraction(s)));
                prop_assert!(near.into_iter().any(|old| (old - edge.drawn_fraction(s)).abs() < 1e-8), "{x:?} {edge:?}");
            }
        }
        // both sides of each cut run along the same points
        for names in cuts.iter().map(|cut| cut.sides.clone()) {
            let length = |name: &String| {
                let side = cut.side_names().iter().position(|n| n == name).unwrap();
                cut.edges().iter().filter(|e| e.side == side).map(Edge::length).sum::<f64>()
            };
            prop_assert!((length(&names[0]) - length(&names[1])).abs() < 1e-12);
        }
    }
}

/// A cut that ends inside, or that goes from the boundary to a hole, leaves one piece.
#[test]
fn cuts_that_cut_nothing_are_refused() {
    let square = |x: f64| vec![[-x, -x], [x, -x], [x, x], [-x, x]];
    let outer = Loop::straight(square(1.0), vec!["outer".into(); 4]);
    let hole = Loop::straight(square(0.25), vec!["hole".into(); 4]);
    let body = Polygon::new(outer, vec![hole]).unwrap();
    let inside = body.cut(&[line([-2.0, 0.1], [-0.5, 0.1], "c")]);
    assert_eq!(inside.unwrap_err(), CutError::EndsInside { at: [-0.5, 0.1] });
    assert!(matches!(body.cut(&[line([-2.0, 0.1], [0.0, 0.1], "c")]), Err(CutError::SamePiece { .. })));
    assert!(matches!(
        body.cut(&[line([-2.0, 1.0 - 1e-8], [2.0, 1.0 - 1e-8], "c")]),
        Err(CutError::NextToCorner { .. })
    ));
    let halves = body.cut(&[line([-2.0, 0.1], [2.0, 0.1], "c")]).unwrap();
    assert_eq!((halves.bodies().len(), halves.loops().len()), (2, 2));
    let four = body.cut(&[line([-2.0, 0.5], [2.0, 0.5], "c"), line([0.5, -2.0], [0.5, 2.0], "d")]).unwrap();
    assert_eq!((four.bodies().len(), four.loops().len()), (4, 5));
}
