//! Moments against values computed with 60 digits from the definition (`tests/data/curved.json`), and against panels.

use std::f64::consts::PI;

use num_complex::Complex64;
use serde_json::Value;

use super::{moments, own};
use crate::curve::{Curve, Shape};
use crate::moments::Segment;

fn complex(v: &Value) -> Complex64 {
    match v.as_array() {
        Some(v) => Complex64::new(v[0].as_f64().unwrap(), v[1].as_f64().unwrap()),
        None => v.as_f64().unwrap().into(),
    }
}

/// The cubic Bézier curve with these control points, t = 2u - 1.
fn bezier([p0, p1, p2, p3]: [Complex64; 4]) -> Curve {
    let slope = (3.0 * (p3 - p0) + 3.0 * (p2 - p1)) / 8.0;
    let b2 = 3.0 * (p0 - p1 - p2 + p3) / 8.0 / slope;
    let b3 = (p3 - p0 - 3.0 * (p2 - p1)) / 8.0 / slope;
    Curve::new(Segment { start: p0, end: p3 }, &Shape::of_coefficients([b2, b3].into_iter()))
}

fn element(v: &Value) -> Curve {
    match v[0].as_str().unwrap() {
        "arc" => {
            let (c, r) = (complex(&v[1]), v[2].as_f64().unwrap());
            let [a, b] = [3, 4].map(|i| v[i].as_f64().unwrap());
            let ends = Segment { start: c + r * Complex64::cis(a), end: c + r * Complex64::cis(b) };
            Curve::new(ends, &Shape::Arc((b - a) / 2.0))
        }
        "line" => Curve::new(Segment { start: complex(&v[1]), end: complex(&v[2]) }, &Shape::Line),
        _ => bezier([0, 1, 2, 3].map(|i| complex(&v[1][i]))),
    }
}

/// Moves the start of `b` onto the end of `a`, or its end onto the start, where rounding has parted them.
fn joined(a: &Curve, b: Curve) -> Curve {
    let Segment { mut start, mut end } = b.ends();
    if (a.ends().end - start).norm() < 1e-12 {
        start = a.ends().end;
    }
    if (a.ends().start - end).norm() < 1e-12 {
        end = a.ends().start;
    }
    let ends = Segment { start, end };
    match b {
        Curve::Line(_) => Curve::Line(ends),
        Curve::Arc(arc) => Curve::new(ends, &Shape::Arc(arc.half_opening)),
        Curve::Polynomial(curve) => Curve::new(ends, &Shape::Polynomial(curve.of)),
    }
}

#[test]
fn moments_agree_with_the_definition_to_1e_13_of_the_block_maximum() {
    const ROWS: usize = 9;
    let gold: Value = serde_json::from_str(include_str!("../../tests/data/curved.json")).unwrap();
    let mut worst: f64 = 0.0;
    for (name, case) in gold["moments"].as_object().unwrap() {
        let a = element(&case["a"]);
        let b = joined(&a, element(&case["b"]));
        let mut out = vec![0.0; super::storage(ROWS, ROWS)];
        if name.starts_with("self") {
            own(&a, ROWS, &mut out);
        } else {
            moments(&a, &b, ROWS, ROWS, &mut out);
        }
        let table = |part: usize| &out[part * ROWS * ROWS..][..ROWS * ROWS];
        let largest = |part: usize| table(part).iter().fold(1e-3f64, |l, v| l.max(v.abs()));
        let e_scale = largest(1).max(largest(2)).max(4.0);
        for (key, values) in case["moments"].as_object().unwrap() {
            let (m, n) = key.split_once(',').unwrap();
            let at = m.parse::<usize>().unwrap() * ROWS + n.parse::<usize>().unwrap();
            let want = [0, 1, 2, 3].map(|i| values[i].as_str().unwrap().parse::<f64>().unwrap());
            let one = if at == 0 { 4.0 } else { 0.0 };
            let got = [table(0)[at], (one + table(1)[at]) / 2.0, table(2)[at] / 2.0, table(3)[at]];
            let scales = [largest(0), e_scale, e_scale, largest(3)];
            for i in 0..4 {
                let error = (got[i] - want[i]).abs() / scales[i];
                worst = worst.max(error);
                assert!(error < 1e-13, "{name} {key} {i}: {} for {}", got[i], want[i]);
            }
        }
    }
    println!("worst {worst:.1e}");
}

#[test]
fn bezier_keeps_its_points() {
    let p = [0.0.into(), Complex64::new(0.4, 0.1), Complex64::new(0.8, 0.25), Complex64::new(1.0, 0.5)];
    let curve = bezier(p);
    for u in [0.0, 0.1, 0.37, 0.5, 0.81, 1.0f64] {
        let v = 1.0 - u;
        let want = v * v * v * p[0] + 3.0 * u * v * v * p[1] + 3.0 * u * u * v * p[2] + u * u * u * p[3];
        assert!((curve.point(2.0 * u - 1.0) - want).norm() < 1e-15);
    }
    let arc = Curve::new(Segment { start: 1.0.into(), end: Complex64::I }, &Shape::Arc(PI / 4.0));
    assert!((arc.point(0.0) - Complex64::cis(PI / 4.0)).norm() < 1e-15 && (arc.half_length() - PI / 4.0).abs() < 1e-15);
}
