//! Polygons: what is refused and what is not, orientation, area, and where points lie.

use proptest::prelude::*;
use steklov_bem_operators::proptest::{loops, polygon};
use steklov_bem_operators::{EdgeName, Location, Loop, Polygon, PolygonError};

fn chain(corners: &[[f64; 2]]) -> Loop {
    Loop::straight(corners.to_vec(), (0..corners.len()).map(|k| format!("s{k}")).collect())
}

fn square(x: f64, y: f64, size: f64) -> Loop {
    chain(&[[x, y], [x + size, y], [x + size, y + size], [x, y + size]])
}

fn edge(loop_index: usize, corner: usize) -> EdgeName {
    EdgeName { loop_index, corner, side: format!("s{corner}") }
}

fn refuse(outer: Loop, holes: Vec<Loop>) -> PolygonError {
    Polygon::new(outer, holes).expect_err("must be refused")
}

/// Moves, turns and scales a loop.
fn similar(l: &Loop, angle: f64, scale: f64, shift: [f64; 2]) -> Loop {
    let (c, s) = (scale * angle.cos(), scale * angle.sin());
    let map = |x: &[f64; 2]| [c * x[0] - s * x[1] + shift[0], s * x[0] + c * x[1] + shift[1]];
    Loop::straight(l.corners.iter().map(map).collect(), l.sides.clone())
}

#[test]
fn lists_that_are_no_polygon_are_refused_with_their_place() {
    use PolygonError::*;
    let unit = || square(0.0, 0.0, 1.0);
    assert_eq!(refuse(chain(&[[0.0, 0.0], [1.0, 0.0]]), vec![]), TooFewCorners { loop_index: 0, corners: 2 });
    assert_eq!(refuse(unit(), vec![chain(&[])]), TooFewCorners { loop_index: 1, corners: 0 });
    let mut short = unit();
    short.sides.pop();
    assert_eq!(refuse(short, vec![]), SideCount { loop_index: 0, corners: 4, sides: 3 });
    let mut blank = square(0.2, 0.2, 0.1);
    blank.sides[2] = " ".into();
    assert_eq!(refuse(unit(), vec![blank]), EmptySide { loop_index: 1, edge: 2 });
    for bad in [f64::NAN, f64::INFINITY, -1e101] {
        let e = refuse(chain(&[[0.0, 0.0], [1.0, 0.0], [1.0, bad]]), vec![]);
        assert!(matches!(e, NotFinite { loop_index: 0, corner: 2, at } if at[1].to_bits() == bad.to_bits()), "{e}");
    }
    let e = refuse(chain(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1e-13], [0.0, 1.0]]), vec![]);
    assert!(matches!(&e, ZeroEdge { edge: k, length, .. } if *k == edge(0, 1) && *length == 1e-13), "{e}");
    let e = refuse(chain(&[[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]), vec![]);
    assert_eq!(e, Clockwise { area: -1.0 });
    assert!(matches!(refuse(chain(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]]), vec![]), ZeroArea { loop_index: 0, .. }));
    let flat = chain(&[[0.2, 0.2], [0.4, 0.2], [0.3, 0.2], [0.25, 0.2]]);
    assert!(matches!(refuse(unit(), vec![flat]), ZeroArea { loop_index: 1, .. }));
}

#[test]
fn chains_that_meet_themselves_or_each_other_are_refused_with_their_place() {
    use PolygonError::*;
    let bow = chain(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]);
    assert_eq!(refuse(bow, vec![]), Crossing { first: edge(0, 0), second: edge(0, 2), at: [1.0, 1.0] });
    // A square with a hair of no width: outwards (360 degrees outside) and inwards.
    for tip in [[0.5, 2.0], [0.5, 0.5]] {
        let hair = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 1.0], tip, [0.5, 1.0], [0.0, 1.0]];
        let mut wide = hair;
        assert_eq!(refuse(chain(&hair), vec![]), Spike { loop_index: 0, corner: 4, at: tip });
        wide[5][0] -= 1e-6; // the way back is to the left of the way out
        assert!(Polygon::new(chain(&wide), vec![]).is_ok());
    }
    let pinched = chain(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]]);
    assert_eq!(refuse(pinched, vec![]), Touching { loop_index: 0, corner: 3, at: [1.0, 0.0], edge: edge(0, 0) });
    let unit = || square(0.0, 0.0, 1.0);
    let hole = |x: f64, y: f64, h: f64| square(x, y, h);
    assert!(matches!(refuse(unit(), vec![hole(0.5, 0.25, 0.5)]), Touching { loop_index: 1, corner: 1, .. }));
    assert!(matches!(refuse(unit(), vec![hole(0.5, 0.25, 0.6)]), Crossing { .. }));
    assert!(matches!(refuse(unit(), vec![unit()]), Touching { .. }));
    assert!(matches!(refuse(unit(), vec![hole(0.1, 0.1, 0.3), hole(0.3, 0.3, 0.3)]), Crossing { .. }));
    assert_eq!(refuse(unit(), vec![hole(1.5, 0.0, 0.5)]), HoleOutside { loop_index: 1, at: [1.5, 0.0] });
    assert!(matches!(refuse(unit(), vec![hole(-1.0, -1.0, 3.0)]), HoleOutside { loop_index: 1, .. }));
    let nested = vec![hole(0.3, 0.3, 0.2), hole(0.2, 0.2, 0.5)];
    assert_eq!(refuse(unit(), nested), HoleInHole { loop_index: 1, within: 2, at: [0.3, 0.3] });
}

#[test]
fn errors_read_well() {
    let e = refuse(square(0.0, 0.0, 1.0), vec![square(0.5, 0.25, 0.6)]).to_string();
    assert_eq!(e, "edge 1 (\"s1\") of the outer loop and edge 0 (\"s0\") of hole 1 cross at (1, 0.25)");
}

/// A wall of thickness d between the outer loop and a hole, or between two arms: valid down to the tolerance.
#[test]
fn slivers_are_valid_and_contact_is_not() {
    for (d, valid) in [(1e-2, true), (1e-6, true), (1e-11, true), (1e-13, false), (0.0, false)] {
        let hole = square(d, 0.25, 0.5);
        let arms = chain(&[[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [1.0, 1.0], [0.0, 1.0], [0.5 - d, 0.5]]);
        for angle in [0.0, 0.3, 2.0] {
            let turned = |l: &Loop| similar(l, angle, 7.0, [0.1, -0.2]);
            assert_eq!(Polygon::new(turned(&square(0.0, 0.0, 1.0)), vec![turned(&hole)]).is_ok(), valid, "wall {d}");
            assert_eq!(Polygon::new(turned(&arms), vec![]).is_ok(), valid, "neck {d}");
        }
    }
    let degree = std::f64::consts::PI / 180.0;
    assert!(Polygon::new(chain(&[[0.0, 0.0], [1.0, 0.0], [1.0, degree.tan()]]), vec![]).is_ok());
    assert!(Polygon::new(square(0.0, 0.0, 1e-90), vec![]).is_ok());
    assert!(Polygon::new(square(1e6, -1e6, 1e-3), vec![]).is_ok());
}

#[test]
fn holes_are_traversed_clockwise_with_the_numbers_as_listed() {
    let hole = chain(&[[0.25, 0.25], [0.5, 0.25], [0.25, 0.75]]);
    let mut clockwise = hole.clone();
    clockwise.corners.reverse();
    let p = Polygon::new(square(0.0, 0.0, 1.0), vec![hole, clockwise_at(&clockwise, 0.4)]).unwrap();
    assert_eq!(p.loops(), [0..4, 4..7, 7..10]);
    assert_eq!(p.traversal(0), [0, 1, 2, 3]);
    assert_eq!(p.traversal(1), [6, 5, 4]);
    for (loop_index, listed) in [(0, vec![0, 1, 2, 3]), (1, vec![4, 5, 6]), (2, vec![7, 8, 9])] {
        for &k in &listed {
            let ends = |e: usize| [p.edges()[e].point(0.0), p.edges()[e].point(1.0)];
            for rising in [false, true] {
                let (next, on) = p.neighbour(k, rising);
                assert!(next != k && p.edges()[next].loop_index == loop_index, "{k} {rising}");
                assert_eq!(ends(k)[usize::from(rising)], ends(next)[usize::from(!on)], "{k} {rising}: {next} {on}");
            }
        }
    }
    assert_eq!(p.traversal(2), [7, 8, 9]);
    assert!(p.edges()[4..7].iter().all(|e| e.reversed) && !p.edges()[7].reversed);
    let first = &p.edges()[4];
    assert_eq!((first.start, first.end), ([0.5, 0.25], [0.25, 0.25]));
    assert_eq!((first.point(0.0), first.point(1.0)), ([0.25, 0.25], [0.5, 0.25]));
    assert_eq!(p.side_names(), ["s0", "s1", "s2", "s3"]);
    assert_eq!(p.edges()[8].side, 1);
}

fn clockwise_at(l: &Loop, dx: f64) -> Loop {
    similar(l, 0.0, 1.0, [dx, 0.0])
}

/// Closed forms: L-shape; square with a square hole, moments by subtraction; a body far from the origin.
#[test]
fn area_diameter_and_centroid() {
    let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    let p = Polygon::new(chain(&l), vec![]).unwrap();
    assert_eq!(p.area(), 4.0);
    assert_eq!(p.diameter(), 13f64.sqrt());
    assert_eq!(p.centroid(), [3.0 / 4.0, 5.0 / 4.0]);
    let p = Polygon::new(square(0.0, 0.0, 1.0), vec![square(0.5, 0.25, 0.25)]).unwrap();
    let area = 1.0 - 1.0 / 16.0;
    assert_eq!(p.area(), area);
    let exact = [(0.5 - 0.625 / 16.0) / area, (0.5 - 0.375 / 16.0) / area];
    assert!((0..2).all(|k| (p.centroid()[k] - exact[k]).abs() < 1e-15));
    let p = Polygon::new(square(1e6, 1e6, 1.0), vec![]).unwrap();
    assert_eq!((p.area(), p.centroid()), (1.0, [1e6 + 0.5, 1e6 + 0.5]));
}

/// A gear of 1000 teeth: every pair of its 2000 edges is looked at.
#[test]
fn two_thousand_edges() {
    let corner = |k: usize| {
        let (a, r) = (std::f64::consts::TAU * k as f64 / 2000.0, if k.is_multiple_of(2) { 1.0 } else { 0.99 });
        [r * a.cos(), r * a.sin()]
    };
    let mut corners: Vec<[f64; 2]> = (0..2000).map(corner).collect();
    let p = Polygon::new(chain(&corners), vec![]).unwrap();
    let exact = 1000.0 * 0.99 * (std::f64::consts::PI / 1000.0).sin();
    assert!((p.area() - exact).abs() < 1e-12 * exact);
    corners[1000] = [1.5, 0.0]; // a tooth that pierces the opposite side
    let verdict = Polygon::new(chain(&corners), vec![]).map(|p| p.area());
    assert!(matches!(verdict, Err(PolygonError::Crossing { .. })), "{verdict:?}");
}

#[test]
fn points_on_the_boundary_are_found_to_the_tolerance() {
    let p = Polygon::new(square(0.0, 0.0, 1.0), vec![square(0.25, 0.25, 0.5)]).unwrap();
    assert_eq!(p.contains([0.125, 0.0]), Location::Boundary { edge: 0, s: 0.125 });
    assert_eq!(p.contains([0.375, 0.25]), Location::Boundary { edge: 4, s: 0.25 });
    assert_eq!(p.contains([1.0, 1.0]), Location::Boundary { edge: 1, s: 1.0 });
    assert_eq!(p.contains([0.5, 1e-11]), Location::Inside);
    assert_eq!(p.contains([0.5, -1e-11]), Location::Outside);
    assert_eq!(p.contains([0.5, -1e-13]), Location::Boundary { edge: 0, s: 0.5 });
    assert_eq!(p.contains([0.5, 0.5]), Location::Outside);
    assert_eq!(p.contains([0.5, 0.2]), Location::Inside);
    assert_eq!(p.contains([f64::NAN, 0.5]), Location::Outside);
    assert_eq!(p.contains([f64::INFINITY, f64::NEG_INFINITY]), Location::Outside);
}

/// Sign of the turn a → b → c, exact in integers.
fn turn(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).signum()
}

/// Whether two closed segments share a point, in integers.
fn meet([a, b]: [[i64; 2]; 2], [c, d]: [[i64; 2]; 2]) -> bool {
    let within = |p: [i64; 2], q: [i64; 2], x: [i64; 2]| {
        turn(p, q, x) == 0 && (0..2).all(|k| p[k].min(q[k]) <= x[k] && x[k] <= p[k].max(q[k]))
    };
    let cross = turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
    cross || within(a, b, c) || within(a, b, d) || within(c, d, a) || within(c, d, b)
}

fn sides(l: &[[i64; 2]]) -> Vec<[[i64; 2]; 2]> {
    (0..l.len()).map(|k| [l[k], l[(k + 1) % l.len()]]).collect()
}

/// Simple: an edge meets its successor in one point and no other edge at all.
fn simple(l: &[[i64; 2]]) -> bool {
    let s = sides(l);
    let n = s.len();
    (0..n).all(|i| {
        let ([a, b], [_, c]) = (s[i], s[(i + 1) % n]);
        let folded = turn(a, b, c) == 0 && (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) <= 0;
        a != b && !folded && (0..n).all(|j| j == i || (i + 1) % n == j || (j + 1) % n == i || !meet(s[i], s[j]))
    })
}

fn twice_area(l: &[[i64; 2]]) -> i64 {
    sides(l).iter().map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum()
}

/// Strictly inside a simple loop that the point does not meet: even-odd on a ray that passes no lattice point.
fn inside(l: &[[i64; 2]], x: [i64; 2]) -> bool {
    let far = [x[0] + 100_003, x[1] + 1];
    sides(l).iter().filter(|s| meet(**s, [x, far])).count() % 2 == 1
}

fn float(l: &[[i64; 2]]) -> Loop {
    chain(&l.iter().map(|x| [x[0] as f64, x[1] as f64]).collect::<Vec<_>>())
}

fn lattice(n: i64, corners: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = Vec<[i64; 2]>> {
    prop::collection::vec([0..n, 0..n], corners)
}

/// A loop of three or four corners in a box of size 2 that may stick out of the square of size 8.
fn small() -> impl Strategy<Value = Vec<[i64; 2]>> {
    ([-1..8i64, -1..8i64], lattice(3, 3..=4)).prop_map(|(o, l)| l.iter().map(|x| [o[0] + x[0], o[1] + x[1]]).collect())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// On a small lattice, where every degenerate case is frequent, the verdict equals that of integer arithmetic,
    /// also after turning and scaling, which rounds every contact.
    #[test]
    fn validity_is_that_of_exact_arithmetic(l in lattice(4, 3..=6), angle in 0.0..6.0f64, scale in 0.1..10.0f64) {
        let valid = simple(&l) && twice_area(&l) > 0;
        let verdict = Polygon::new(float(&l), vec![]);
        prop_assert_eq!(verdict.is_ok(), valid, "{:?}", verdict);
        let turned = Polygon::new(similar(&float(&l), angle, scale, [0.3, -0.7]), vec![]);
        prop_assert_eq!(turned.is_ok(), valid, "{:?}", turned);
        if simple(&l) && twice_area(&l) < 0 {
            prop_assert_eq!(verdict, Err(PolygonError::Clockwise { area: twice_area(&l) as f64 / 2.0 }));
        }
    }

    #[test]
    fn validity_of_holes_is_that_of_exact_arithmetic(a in small(), b in small()) {
        let outer = [[0, 0], [4, 0], [8, 0], [8, 8], [0, 8]];
        let apart = |l: &[[i64; 2]], m: &[[i64; 2]]| sides(l).iter().all(|s| sides(m).iter().all(|t| !meet(*s, *t)));
        let valid = simple(&a) && simple(&b) && apart(&outer, &a) && apart(&outer, &b) && apart(&a, &b)
            && inside(&outer, a[0]) && inside(&outer, b[0]) && !inside(&a, b[0]) && !inside(&b, a[0]);
        let verdict = Polygon::new(float(&outer), vec![float(&a), float(&b)]);
        prop_assert_eq!(verdict.is_ok(), valid, "{:?}", verdict);
        if let Ok(p) = verdict {
            let holes = (twice_area(&a).abs() + twice_area(&b).abs()) as f64 / 2.0;
            prop_assert!((p.area() - (64.0 - holes)).abs() < 1e-12);
        }
    }
}

proptest! {
    #[test]
    fn star_shaped_polygons_are_valid_and_reversed_ones_not((outer, holes) in loops()) {
        let p = Polygon::new(outer.clone(), holes.clone()).unwrap();
        for (k, range) in p.loops().iter().enumerate() {
            let order = p.traversal(k);
            let turned = |i: usize| {
                let (e, f) = (&p.edges()[order[i]], &p.edges()[order[(i + 1) % order.len()]]);
                assert_eq!(e.end, f.start);
                e.start[0] * e.end[1] - e.start[1] * e.end[0]
            };
            let area: f64 = (0..range.len()).map(turned).sum();
            prop_assert_eq!(area > 0.0, k == 0);
        }
        // A hole may be listed either way; an outer loop may not.
        let reverse = |l: &Loop| Loop::straight(l.corners.iter().rev().copied().collect(), l.sides.clone());
        let q = Polygon::new(outer.clone(), holes.iter().map(reverse).collect()).unwrap();
        prop_assert!((p.area() - q.area()).abs() < 1e-14 && p.loops() == q.loops());
        for (e, f) in p.edges().iter().zip(q.edges()) {
            prop_assert_eq!(e.reversed != f.reversed, e.loop_index > 0);
        }
        let clockwise = Polygon::new(reverse(&outer), holes);
        prop_assert!(matches!(clockwise, Err(PolygonError::Clockwise { .. })), "{:?}", clockwise);
    }

    /// The winding number as the sum of the angles under which the edges are seen.
    #[test]
    fn inside_is_where_the_edges_are_seen_under_a_full_turn(p in polygon(), r in 0.0..0.7f64, angle in 0.0..6.3f64) {
        let c = p.centroid();
        let x = [c[0] + r * p.diameter() * angle.cos(), c[1] + r * p.diameter() * angle.sin()];
        let seen: f64 = p.edges().iter().map(|e| {
            let (a, b) = ([e.start[0] - x[0], e.start[1] - x[1]], [e.end[0] - x[0], e.end[1] - x[1]]);
            (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1])
        }).sum();
        let turns = seen / std::f64::consts::TAU;
        match p.contains(x) {
            Location::Inside => prop_assert!((turns - 1.0).abs() < 1e-9),
            Location::Outside => prop_assert!(turns.abs() < 1e-9),
            Location::Boundary { .. } => return Err(TestCaseError::reject("on the boundary")),
        }
    }

    #[test]
    fn points_of_edges_are_on_them_and_beside_them_not(p in polygon(), k in any::<prop::sample::Index>(), s in 0.01..0.99f64) {
        let k = k.index(p.edges().len());
        let e = &p.edges()[k];
        match p.contains(e.point(s)) {
            Location::Boundary { edge, s: found } => {
                prop_assert_eq!(edge, k);
                prop_assert!((found - s).abs() < 1e-10);
            }
            other => prop_assert!(false, "{:?}", other),
        }
        let (d, h) = ([e.end[0] - e.start[0], e.end[1] - e.start[1]], 1e-9 * p.diameter() / e.length());
        let (x, left) = (e.point(s), [-d[1] * h, d[0] * h]);
        prop_assert_eq!(p.contains([x[0] + left[0], x[1] + left[1]]), Location::Inside);
        prop_assert_eq!(p.contains([x[0] - left[0], x[1] - left[1]]), Location::Outside);
    }
}
