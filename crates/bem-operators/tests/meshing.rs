//! Meshes: the rule for the number of elements, geometry, grading and refinement.

use proptest::prelude::*;
use steklov_bem_operators::proptest::{mesh, polygon, polygon_and_mesh};
use steklov_bem_operators::{BemError, Location, Loop, Mesh, Polygon};

fn chain(corners: Vec<[f64; 2]>) -> Loop {
    let sides = (0..corners.len()).map(|k| format!("s{k}")).collect();
    Loop::straight(corners, sides)
}

fn unit_square() -> Polygon {
    Polygon::new(chain(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), vec![]).unwrap()
}

fn turned(p: &[[f64; 2]], angle: f64, scale: f64) -> Vec<[f64; 2]> {
    let (c, s) = (scale * angle.cos(), scale * angle.sin());
    p.iter().map(|x| [c * x[0] - s * x[1] + 0.3 * scale, s * x[0] + c * x[1] - 0.1 * scale]).collect()
}

fn counts(mesh: &Mesh, edges: usize) -> Vec<usize> {
    (0..edges).map(|k| mesh.edge.iter().filter(|&&e| e == k).count()).collect()
}

/// Everything that a mesh of a polygon must satisfy.
fn check(p: &Polygon, m: &Mesh) -> Result<(), TestCaseError> {
    let tolerance = 10.0 * p.tolerance();
    let apart = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    prop_assert_eq!(&m.side_names, p.side_names());
    for (e, &k) in m.edge.iter().enumerate() {
        let (edge, n) = (&p.edges()[k], m.next[e]);
        prop_assert_eq!(m.side[e], edge.side);
        prop_assert!(m.length(e) > 0.0 && (m.span[e][0] < m.span[e][1]) != edge.reversed);
        for t in [-1.0, -0.4, 0.0, 0.7, 1.0] {
            prop_assert!(apart(m.point(e, t), edge.point(m.edge_parameter(e, t))) <= tolerance);
        }
        // Neighbours share a parameter on an edge, and exactly a corner of the polygon from edge to edge.
        if m.edge[n] == k {
            prop_assert_eq!(m.span[e][1], m.span[n][0]);
        } else {
            prop_assert_eq!(m.vertices[n], edge.end);
            prop_assert_eq!(m.vertices[n], p.edges()[m.edge[n]].start);
        }
        let last = e + 1 == m.len() || p.edges()[m.edge[e + 1]].loop_index != edge.loop_index;
        prop_assert_eq!(n == e + 1, !last);
        // The normal points out of the body.
        let (x, normal, h) = (m.point(e, 0.1), m.normal(e, 0.1), 1e-9 * p.diameter());
        prop_assert_eq!(p.contains([x[0] + h * normal[0], x[1] + h * normal[1]]), Location::Outside);
        prop_assert_eq!(p.contains([x[0] - h * normal[0], x[1] - h * normal[1]]), Location::Inside);
    }
    for (k, edge) in p.edges().iter().enumerate() {
        let length: f64 = (0..m.len()).filter(|&e| m.edge[e] == k).map(|e| m.length(e)).sum();
        prop_assert!((length - edge.length()).abs() <= tolerance);
    }
    Ok(())
}

/// The rule in integers, so that every tie is exact: one more to the edge with the largest length/count.
fn greedy(lengths: &[u64], elements: usize) -> Vec<usize> {
    let mut count = vec![1; lengths.len()];
    while count.iter().sum::<usize>() < elements {
        let longer = |i: usize, j: usize| lengths[i] * count[j] as u64 > lengths[j] * count[i] as u64;
        let k = (0..lengths.len()).find(|&i| (0..lengths.len()).all(|j| !longer(j, i))).unwrap();
        count[k] += 1;
    }
    count
}

/// A staircase from the origin to the right and back under it: all lengths are integers.
fn staircase(steps: &[(u64, u64)]) -> (Vec<[f64; 2]>, Vec<u64>) {
    let (width, height) = steps.iter().fold((0, 0), |s, d| (s.0 + d.0, s.1 + d.1));
    let (mut x, mut y) = (width, 0);
    let mut corners = vec![[0, 0], [x, 0]];
    let mut lengths = vec![width];
    for &(dx, dy) in steps {
        y += dy;
        corners.push([x, y]);
        x -= dx;
        corners.push([x, y]);
        lengths.extend([dy, dx]);
    }
    lengths.push(height);
    (corners.iter().map(|c| [c[0] as f64, c[1] as f64]).collect(), lengths)
}

#[test]
fn elements_by_hand() {
    let p = Polygon::new(chain(vec![[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]]), vec![]).unwrap();
    // 3 → 1.5, 1.5 → 1, 1 and then ties of 1: edge 0 first, then 1.
    for (elements, expected) in [
        (0, [1, 1, 1, 1]),
        (4, [1, 1, 1, 1]),
        (5, [2, 1, 1, 1]),
        (6, [2, 1, 2, 1]),
        (8, [3, 1, 3, 1]),
        (9, [4, 1, 3, 1]),
        (10, [4, 2, 3, 1]),
        (12, [4, 2, 4, 2]),
        (24, [9, 3, 9, 3]),
    ] {
        let m = Mesh::uniform(&p, elements, 3);
        assert_eq!(counts(&m, 4), expected, "{elements}");
        assert!(m.degree.iter().all(|&d| d == 3));
    }
    let m = Mesh::uniform(&p, 6, 1);
    assert_eq!(m.vertices, [[0.0, 0.0], [1.5, 0.0], [3.0, 0.0], [3.0, 1.0], [1.5, 1.0], [0.0, 1.0]]);
    assert_eq!(m.next, [1, 2, 3, 4, 5, 0]);
    assert_eq!(m.span[3], [0.0, 0.5]);
}

#[test]
fn breaks_run_with_the_edge_parameter_also_on_reversed_holes() {
    let hole = chain(vec![[0.25, 0.25], [0.75, 0.25], [0.25, 0.75]]);
    let p = Polygon::new(chain(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), vec![hole]).unwrap();
    let mut breaks = vec![vec![]; 7];
    let mut degree = vec![vec![1]; 7];
    breaks[4] = vec![0.25, 0.5];
    degree[4] = vec![2, 3, 4];
    let m = Mesh::from_breaks(&p, &breaks, &degree).unwrap();
    assert_eq!(m.edge, [0, 1, 2, 3, 6, 5, 4, 4, 4]);
    assert_eq!(m.next, [1, 2, 3, 0, 5, 6, 7, 8, 4]);
    assert_eq!(m.span[6..], [[1.0, 0.5], [0.5, 0.25], [0.25, 0.0]]);
    assert_eq!(m.degree[6..], [4, 3, 2]);
    assert_eq!(m.vertices[6..], [[0.75, 0.25], [0.5, 0.25], [0.375, 0.25]]);
}

#[test]
fn wrong_breaks_are_refused() {
    let p = unit_square();
    let with = |b: Vec<f64>, d: Vec<usize>| {
        let mut breaks = vec![vec![]; 4];
        let mut degree = vec![vec![1]; 4];
        (breaks[2], degree[2]) = (b, d);
        Mesh::from_breaks(&p, &breaks, &degree)
    };
    assert!(with(vec![0.5, 0.75], vec![1, 2, 3]).is_ok());
    for (b, d) in [
        (vec![0.5], vec![1]),
        (vec![0.5], vec![1, 0]),
        (vec![0.5, 0.5], vec![1, 1, 1]),
        (vec![0.75, 0.5], vec![1, 1, 1]),
        (vec![0.0], vec![1, 1]),
        (vec![1.0], vec![1, 1]),
        (vec![f64::NAN], vec![1, 1]),
        (vec![1e-17], vec![1, 1]),
    ] {
        let m = with(b.clone(), d);
        assert!(matches!(&m, Err(BemError::Mesh { what }) if what.contains("edge 2")), "{b:?} {m:?}");
    }
    assert!(Mesh::from_breaks(&p, &[], &[]).is_err());
}

#[test]
fn grading_is_geometric_with_linear_degrees() {
    let p = unit_square();
    let (layers, ratio) = (5, 0.15);
    // Towards corner 1, given on either of its edges, and towards an inner point of edge 2.
    for corner in [(0, 1.0), (1, 0.0)] {
        let m = Mesh::graded(&p, &[corner, (2, 0.25)], layers, ratio, |j| 1 + j).unwrap();
        check(&p, &m).unwrap();
        assert_eq!(counts(&m, 4), [6, 6, 12, 1]);
        assert_eq!(m.degree, [6, 5, 4, 3, 2, 1, 1, 2, 3, 4, 5, 6, 6, 5, 4, 3, 2, 1, 1, 2, 3, 4, 5, 6, 6]);
        for (piece, length) in [(6..12, 1.0), (18..24, 0.75)] {
            let exact = |k: i32| length * if k == 0 { ratio.powi(5) } else { ratio.powi(5 - k) * (1.0 - ratio) };
            for (k, e) in piece.enumerate() {
                assert!((m.length(e) / exact(k as i32) - 1.0).abs() < 1e-10);
            }
        }
        assert!((m.length(5) / m.length(6) - 1.0).abs() < 1e-10);
    }
    // Both ends of an edge: halved, then graded.
    let m = Mesh::graded(&p, &[(0, 0.0), (0, 1.0)], 2, 0.5, |_| 4).unwrap();
    assert_eq!(m.span[..6], [[0.0, 0.125], [0.125, 0.25], [0.25, 0.5], [0.5, 0.75], [0.75, 0.875], [0.875, 1.0]]);
    assert_eq!(m.len(), 6 + 3 + 1 + 3);
    assert_eq!(Mesh::graded(&p, &[], 7, 0.5, |_| 2), Ok(Mesh::uniform(&p, 4, 2)));
}

#[test]
fn wrong_gradings_are_refused() {
    let p = unit_square();
    let refused = |towards: &[(usize, f64)], layers: usize, ratio: f64, degree: usize| {
        matches!(Mesh::graded(&p, towards, layers, ratio, |_| degree), Err(BemError::Mesh { .. }))
    };
    assert!(!refused(&[(0, 0.5)], 15, 0.1, 1));
    assert!(refused(&[(0, 0.5)], 18, 0.1, 1)); // 1e-18 next to 0.5
    assert!(refused(&[(4, 0.5)], 1, 0.1, 1) && refused(&[(0, 1.5)], 1, 0.1, 1) && refused(&[(0, f64::NAN)], 1, 0.1, 1));
    assert!([0.0, 1.0, -1.0, f64::NAN].iter().all(|&r| refused(&[(0, 0.5)], 1, r, 1)));
    assert!(refused(&[(0, 0.5)], 1, 0.5, 0));
}

/// Halving towards one point ends before the elements have no length, and says so by the parents.
#[test]
fn elements_without_a_midpoint_stay_whole() {
    let corners = turned(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 0.4, 1.0);
    let p = Polygon::new(chain(corners), vec![]).unwrap();
    let mut m = Mesh::uniform(&p, 3, 1);
    let mut steps = 0;
    loop {
        let marked: Vec<bool> = (0..m.len()).map(|e| e == 0).collect();
        let (finer, parent) = m.bisected(&marked);
        assert!((0..finer.len()).all(|e| finer.length(e) > 0.0));
        if finer == m {
            assert_eq!(parent, (0..m.len()).collect::<Vec<_>>());
            break;
        }
        m = finer;
        steps += 1;
    }
    assert!((40..50).contains(&steps), "{steps} halvings");
}

proptest! {
    #[test]
    fn uniform_meshes_follow_the_rule(
        steps in prop::collection::vec((1..9u64, 1..9u64), 1..5),
        elements in 0..120usize,
        angle in 0.0..6.3f64,
        exponent in -6.0..6.0f64,
    ) {
        let (corners, lengths) = staircase(&steps);
        let expected = greedy(&lengths, elements);
        let p = Polygon::new(chain(corners.clone()), vec![]).unwrap();
        let m = Mesh::uniform(&p, elements, 2);
        prop_assert_eq!(&counts(&m, lengths.len()), &expected);
        prop_assert_eq!(m.len(), elements.max(lengths.len()));
        for e in 0..m.len() {
            let exact = lengths[m.edge[e]] as f64 / expected[m.edge[e]] as f64;
            prop_assert!((m.length(e) - exact).abs() < 1e-13 * exact * lengths[0] as f64);
        }
        // Ties are rounded differently when the body is turned and scaled; the mesh stays the same.
        let q = Polygon::new(chain(turned(&corners, angle, 10f64.powf(exponent))), vec![]).unwrap();
        let n = Mesh::uniform(&q, elements, 2);
        prop_assert_eq!(&m.edge, &n.edge);
        prop_assert_eq!(&m.span, &n.span);
    }

    #[test]
    fn uniform_meshes_fit_their_polygon(p in polygon(), elements in 0..60usize) {
        let m = Mesh::uniform(&p, elements, 1);
        prop_assert_eq!(m.len(), elements.max(p.edges().len()));
        check(&p, &m)?;
    }

    #[test]
    fn random_meshes_fit_their_polygon((p, m) in polygon_and_mesh(5)) {
        check(&p, &m)?;
    }

    #[test]
    fn bisected_meshes_fit_their_polygon((p, m) in polygon_and_mesh(5), bits in any::<u64>()) {
        let marked: Vec<bool> = (0..m.len()).map(|e| bits >> (e % 64) & 1 == 1).collect();
        let (finer, parent) = m.bisected(&marked);
        check(&p, &finer)?;
        prop_assert_eq!(finer.len(), m.len() + marked.iter().filter(|&&b| b).count());
        prop_assert_eq!(parent.len(), finer.len());
        for (f, &e) in parent.iter().enumerate() {
            prop_assert_eq!(finer.degree[f], m.degree[e]);
            let part = if marked[e] { 0.5 } else { 1.0 };
            prop_assert!((finer.length(f) - part * m.length(e)).abs() <= p.tolerance());
            prop_assert!(((finer.span[f][1] - finer.span[f][0]) - part * (m.span[e][1] - m.span[e][0])).abs() < 1e-15);
        }
        // Old vertices keep their bits.
        prop_assert!(m.vertices.iter().all(|v| finer.vertices.contains(v)));
    }

    #[test]
    fn raising_changes_nothing_but_the_degree(m in mesh(4), bits in any::<u64>()) {
        let marked: Vec<bool> = (0..m.len()).map(|e| bits >> (e % 64) & 1 == 1).collect();
        let raised = m.raised(&marked);
        for e in 0..m.len() {
            prop_assert_eq!(raised.degree[e], m.degree[e] + usize::from(marked[e]));
        }
        prop_assert_eq!(Mesh { degree: m.degree.clone(), ..raised }, m);
    }
}
