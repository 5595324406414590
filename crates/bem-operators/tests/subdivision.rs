//! Subdivisions: cuts and degrees where the rules put them, vertices that are never lost, the way to a mesh and back.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, subsequence};
use steklov_bem_operators::proptest::polygon_and_mesh;
use steklov_bem_operators::{Grading, Mark, Mesh, Piece, SAME_PLACE, Space, Subdivision};

/// Excess from which two degrees are added.
const TWO_DEGREES: f64 = 4.0;

/// Excess from which two layers are cut off.
fn two_layers(sigma: f64) -> f64 {
    sigma.powf(-0.8)
}

fn grading() -> impl Strategy<Value = Grading> {
    let shortest = prop_oneof![Just(1e-9), -6.0..-1.0f64].prop_map(|e: f64| if e > 0.0 { e } else { 10f64.powf(e) });
    (0.05..0.5f64, 1..=3usize, 4..=12usize, shortest).prop_map(|(sigma, tip_degree, max_degree, shortest)| Grading {
        sigma,
        tip_degree,
        max_degree,
        shortest,
    })
}

/// Marks whose excess lies on both sides of the limits.
fn mark(sigma: f64) -> impl Strategy<Value = Mark> {
    let layers = two_layers(sigma);
    let limits = [1.0, 1e3, TWO_DEGREES, TWO_DEGREES - 1e-9, layers * (1.0 + 1e-12), layers * (1.0 - 1e-12)];
    let excess = prop::sample::select(limits.to_vec());
    prop_oneof![
        1 => Just(Mark::Keep),
        2 => (any::<bool>(), excess).prop_map(|(rough, excess)| Mark::refine(rough, excess)),
    ]
}

/// Up to seven pieces of an edge, of lengths down to 1e-11.
fn pieces(sigma: f64) -> impl Strategy<Value = Vec<Piece>> {
    vec((-10.0..0.0f64, 1..15usize, mark(sigma)), 1..=7).prop_map(|parts| {
        let lengths: Vec<f64> = parts.iter().map(|p| 10f64.powf(p.0)).collect();
        let whole: f64 = lengths.iter().sum();
        let mut vertices = vec![0.0];
        vertices.extend(lengths[1..].iter().scan(lengths[0], |s, l| {
            let vertex = *s / whole;
            *s += l;
            Some(vertex)
        }));
        vertices.push(1.0);
        let piece = |(i, (_, degree, mark)): (usize, (f64, usize, Mark))| Piece {
            start: vertices[i],
            end: vertices[i + 1],
            degree,
            mark,
        };
        parts.into_iter().enumerate().map(piece).collect()
    })
}

fn vertices(pieces: &[Piece]) -> Vec<f64> {
    pieces.iter().map(|p| p.start).chain(pieces.last().map(|p| p.end)).collect()
}

/// Some of the vertices, rising, now and then off by less than what tells places apart.
fn some_vertices(pieces: &[Piece]) -> impl Strategy<Value = Vec<f64>> + use<> {
    let all = vertices(pieces);
    let off = prop_oneof![2 => Just(0.0), 1 => Just(0.9 * SAME_PLACE), 1 => Just(-0.9 * SAME_PLACE)];
    (subsequence(all.clone(), 0..=all.len()), off).prop_map(|(v, off)| v.into_iter().map(|v| v + off).collect())
}

/// The pieces cover [0, 1] without a gap, to the bit.
fn covers(pieces: &[Piece]) -> Result<(), TestCaseError> {
    prop_assert!(pieces[0].start == 0.0 && pieces[pieces.len() - 1].end == 1.0);
    prop_assert!(pieces.windows(2).all(|p| p[0].end == p[1].start), "{pieces:?}");
    prop_assert!(pieces.iter().all(|p| p.start < p.end), "{pieces:?}");
    Ok(())
}

/// What [`Subdivision::refined`] makes of one piece, from the point outwards if only its end is singular: ends and degrees.
fn parts(piece: &Piece, ends: [bool; 2], grading: &Grading) -> Vec<([f64; 2], usize)> {
    let Grading { sigma, tip_degree, max_degree, shortest } = *grading;
    let (a, b, p) = (piece.start, piece.end, piece.degree);
    let Mark::Refine { rough, excess, .. } = piece.mark else { return vec![([a, b], p)] };
    let raised = |by: usize| if p >= max_degree { p } else { (p + by).min(max_degree) };
    let divisible = b - a >= shortest;
    let middle = (a + b) / 2.0;
    let halves = vec![([a, middle], p), ([middle, b], p)];
    match ends {
        [false, false] if divisible && (rough || p >= max_degree) => halves,
        [false, false] => vec![([a, b], raised(if excess >= TWO_DEGREES { 2 } else { 1 }))],
        _ if p < tip_degree || !divisible => vec![([a, b], raised(1))],
        [true, true] => halves,
        [at_start, _] => {
            let layers = if excess >= two_layers(sigma) { 2 } else { 1 };
            let distance = |j: i32| if j == 0 { 0.0 } else { (b - a) * sigma.powi(layers + 1 - j) };
            let place = |j: i32| if at_start { a + distance(j) } else { b - distance(j) };
            let part = |j: i32| {
                let (near, far) = (place(j), place(j + 1));
                ([near.min(far), near.max(far)], raised(j as usize))
            };
            (0..=layers).map(part).collect()
        }
    }
}

proptest! {
    #[test]
    fn pieces_become_what_their_marks_and_points_say(
        (grading, pieces, points) in grading().prop_flat_map(|g| (Just(g), pieces(g.sigma))).prop_flat_map(|(g, p)| {
            let points = some_vertices(&p);
            (Just(g), Just(p), points)
        }),
    ) {
        let before = Subdivision { edges: vec![pieces.clone(), pieces.clone()] };
        let after = before.refined(&[points.clone(), Vec::new()], &grading);
        prop_assert_eq!(&after.edges[1], &before.refined_by_mark(&grading).edges[1]);
        for (edge, points) in after.edges.iter().zip([&points, &Vec::new()]) {
            covers(edge)?;
            let (old, new) = (vertices(&pieces), vertices(edge));
            prop_assert!(old.iter().all(|v| new.contains(v)), "a vertex of {old:?} is not in {new:?}");
            let at = |s: f64| points.iter().any(|p| (p - s).abs() < SAME_PLACE);
            for piece in &pieces {
                let inside = |p: &&Piece| piece.start <= p.start && p.end <= piece.end;
                let mut got: Vec<&Piece> = edge.iter().filter(inside).collect();
                if piece.mark == Mark::Keep {
                    prop_assert_eq!(got, [piece]);
                    continue;
                }
                prop_assert!(got.iter().all(|p| p.mark == Mark::Keep));
                let ends = [at(piece.start), at(piece.end)];
                let want = parts(piece, ends, &grading);
                prop_assert_eq!(got.len(), want.len(), "{:?} of {:?}", got, piece);
                if ends == [false, true] {
                    got.reverse();
                }
                for (got, (span, degree)) in got.iter().zip(want) {
                    prop_assert!((got.start - span[0]).abs() < 1e-15 && (got.end - span[1]).abs() < 1e-15);
                    prop_assert_eq!(got.degree, degree);
                    prop_assert!(got.degree >= piece.degree && got.degree <= grading.max_degree.max(piece.degree));
                }
                let shorter = got.len() > 1;
                prop_assert!(!shorter || piece.end - piece.start >= grading.shortest);
            }
        }
    }

    /// n rounds with all pieces marked cut at σ^n, .., σ from the point, with degrees p, p+1, .., p+n.
    #[test]
    fn degrees_become_linear_in_the_layer(sigma in 0.1..0.5f64, tip_degree in 1..4usize, rounds in 1..6usize, at_end: bool) {
        let grading = Grading { sigma, tip_degree, ..Grading::default() };
        let marked = |excess: f64, degree: usize| Piece { start: 0.0, end: 1.0, degree, mark: Mark::refine(false, excess) };
        let singular = [vec![if at_end { 1.0 } else { 0.0 }]];
        let round = |s: Subdivision| {
            let mut s = s.refined(&singular, &grading);
            s.edges[0].iter_mut().for_each(|p| p.mark = Mark::refine(false, 1.0));
            s
        };
        let run = |rounds: usize, degree: usize| {
            (0..rounds).fold(Subdivision { edges: vec![vec![marked(1.0, degree)]] }, |s, _| round(s))
        };
        // the degree of the point first
        let mut graded = run(tip_degree - 1 + rounds, 1);
        prop_assert_eq!(&graded, &run(rounds, tip_degree));
        let pieces = &mut graded.edges[0];
        prop_assert_eq!(pieces.len(), rounds + 1);
        if at_end {
            pieces.reverse();
        }
        for (j, piece) in pieces.iter().enumerate() {
            prop_assert_eq!(piece.degree, tip_degree + j);
            let outer = sigma.powi((rounds - j) as i32);
            let end = if at_end { 1.0 - piece.start } else { piece.end };
            prop_assert!((end - outer).abs() < 1e-14);
        }
        // two rounds at once
        let far = Subdivision { edges: vec![vec![marked(1e3, tip_degree)]] }.refined(&singular, &grading);
        for (one, two) in far.edges[0].iter().zip(&run(2, tip_degree).edges[0]) {
            prop_assert!((one.start - two.start).abs() < 1e-15 && one.degree == two.degree);
        }
        prop_assert_eq!(far.edges[0].len(), 3);
    }

    #[test]
    fn an_inserted_vertex_is_there_and_fixed_ones_stay(
        (pieces, fixed) in pieces(0.15).prop_flat_map(|p| { let v = some_vertices(&p); (Just(p), v) }),
        (which, part, snap) in (any::<Index>(), prop_oneof![0.0..1.0f64, Just(1e-13), Just(0.19), Just(0.21)], 0.0..0.45f64),
    ) {
        let piece = pieces[which.index(pieces.len())];
        let length = piece.end - piece.start;
        let s = piece.start + part * length;
        let mut after = Subdivision { edges: vec![pieces.clone(), pieces.clone()] };
        after.insert(0, s, &fixed, snap);
        prop_assert_eq!(&after.edges[1], &pieces);
        let edge = after.edges[0].clone();
        covers(&edge)?;
        let (old, new) = (vertices(&pieces), vertices(&edge));
        let is_fixed = |v: f64| v == 0.0 || v == 1.0 || fixed.iter().any(|f| (f - v).abs() < SAME_PLACE);
        prop_assert!(old.iter().all(|&v| !is_fixed(v) || new.contains(&v)));
        prop_assert!(new.iter().any(|v| (v - s).abs() < SAME_PLACE));
        // what happens does so for a reason
        let (left, right) = (s - piece.start, piece.end - s);
        let there = left < SAME_PLACE || right < SAME_PLACE;
        let moved = [(left, piece.start), (right, piece.end)]
            .into_iter()
            .find(|&(d, v)| d < snap * length && !is_fixed(v))
            .map(|(_, v)| v);
        match moved {
            _ if there => prop_assert_eq!(&edge, &pieces),
            Some(v) => {
                let want: Vec<f64> = old.iter().map(|&w| if w == v { s } else { w }).collect();
                prop_assert_eq!(&new, &want);
                prop_assert!(edge.iter().zip(&pieces).all(|(a, b)| a.degree == b.degree && a.mark == b.mark));
            }
            None => {
                let mut want = old;
                want.push(s);
                want.sort_by(f64::total_cmp);
                prop_assert_eq!(&new, &want);
                for p in &edge {
                    let parent = pieces.iter().find(|q| q.start <= p.start && p.end <= q.end).expect("a parent");
                    prop_assert!(p.degree == parent.degree && p.mark == parent.mark);
                }
            }
        }
        // once is enough
        after.insert(0, s, &fixed, snap);
        prop_assert_eq!(&after.edges[0], &edge);
    }

    #[test]
    fn a_shifted_vertex_takes_its_neighbours_along_and_fixed_ones_stay(
        (pieces, fixed) in pieces(0.15)
            .prop_filter("an inner vertex", |p| p.len() > 1)
            .prop_flat_map(|p| { let v = some_vertices(&p); (Just(p), v) }),
        which: Index,
        part in -0.45..0.45f64,
        off in prop_oneof![Just(0.0), -0.9 * SAME_PLACE..0.9 * SAME_PLACE],
    ) {
        let i = 1 + which.index(pieces.len() - 1);
        let from = pieces[i].start;
        let before = fixed.iter().copied().filter(|f| *f < from - SAME_PLACE).fold(0.0, f64::max);
        let after = fixed.iter().copied().filter(|f| *f > from + SAME_PLACE).fold(1.0, f64::min);
        let to = from + part * if part < 0.0 { from - before } else { after - from };
        let mut shifted = Subdivision { edges: vec![pieces.clone(), pieces.clone()] };
        shifted.shift(0, from + off, to, &fixed);
        prop_assert_eq!(&shifted.edges[1], &pieces);
        let edge = &shifted.edges[0];
        covers(edge)?;
        prop_assert!(edge.iter().zip(&pieces).all(|(a, b)| a.degree == b.degree && a.mark == b.mark));
        let (old, new) = (vertices(&pieces), vertices(edge));
        prop_assert_eq!(new[i], to);
        let alone = (to - from).abs() < 0.3 * if part < 0.0 { from - old[i - 1] } else { old[i + 1] - from };
        for (j, (&v, &w)) in old.iter().zip(&new).enumerate() {
            let fixed_here = fixed.iter().any(|f| (f - v).abs() < SAME_PLACE) && j != i;
            if fixed_here || v <= before || v >= after || (alone && j != i) {
                prop_assert_eq!(v, w);
            } else if v < from {
                prop_assert!((w - before - (v - before) / (from - before) * (to - before)).abs() < 1e-15);
            } else {
                prop_assert!((after - w - (after - v) / (after - from) * (after - to)).abs() < 1e-15);
            }
        }
    }
}

proptest! {
    /// A vertex that goes nearer and nearer to a point, with graded pieces before it, never overtakes another one.
    #[test]
    fn a_vertex_that_runs_into_an_end_leaves_a_mesh(
        start in 0.2..0.8f64, parts in vec(0.0..0.999f64, 60), layers in 0..12i32, at_end: bool
    ) {
        let place = |distance: f64| if at_end { 1.0 - distance } else { distance };
        let mut points: Vec<f64> = (0..=layers).map(|k| start * 0.15f64.powi(k)).map(place).chain([0.0, 1.0]).collect();
        points.sort_by(f64::total_cmp);
        let piece = |w: &[f64]| Piece { start: w[0], end: w[1], degree: 2, mark: Mark::Keep };
        let mut mesh = Subdivision { edges: vec![points.windows(2).map(piece).collect()] };
        let mut distance = start;
        for part in parts {
            let next = (distance * (1.0 - part)).max(1e-11);
            mesh.shift(0, place(distance), place(next), &[]);
            distance = next;
            covers(&mesh.edges[0])?;
            prop_assert!(mesh.edges[0].iter().all(|p| p.end - p.start > SAME_PLACE), "{mesh:?}");
            prop_assert!(mesh.edges[0].iter().any(|p| p.start == place(distance)));
        }
    }
}

/// What is done to a subdivision.
#[derive(Debug, Clone)]
enum Step {
    Insert(Index, f64),
    Shift(Index, Index, f64),
    Refine(Vec<(bool, bool, f64)>),
}

fn step() -> impl Strategy<Value = Step> {
    let mark = (any::<bool>(), any::<bool>(), 1.0..8.0f64);
    prop_oneof![
        (any::<Index>(), 0.0..1.0f64).prop_map(|(edge, s)| Step::Insert(edge, s)),
        (any::<Index>(), any::<Index>(), -0.45..0.45f64).prop_map(|(edge, i, part)| Step::Shift(edge, i, part)),
        vec(mark, 1..9).prop_map(Step::Refine),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// The way of an adaptive run: corners stay, and every subdivision is that of its mesh, also on holes listed backwards.
    #[test]
    fn a_mesh_gives_its_subdivision_back((polygon, mesh) in polygon_and_mesh(4), steps in vec(step(), 0..6)) {
        let mut now = Subdivision::new(&mesh, &vec![Mark::Keep; mesh.len()]);
        prop_assert_eq!(&now.mesh(&polygon).expect("a mesh"), &mesh);
        for step in steps {
            match step {
                Step::Insert(edge, s) => now.insert(edge.index(now.edges.len()), s, &[], 0.2),
                Step::Shift(edge, i, part) => {
                    let edge = edge.index(now.edges.len());
                    let from = now.edges[edge][i.index(now.edges[edge].len())].start;
                    now.shift(edge, from, from + part * if part < 0.0 { from } else { 1.0 - from }, &[]);
                }
                Step::Refine(marks) => {
                    let marks = marks.iter().cycle();
                    for (piece, &(keep, rough, excess)) in now.edges.iter_mut().flatten().zip(marks) {
                        piece.mark = if keep { Mark::Keep } else { Mark::refine(rough, excess) };
                    }
                    now = now.refined(&vec![vec![0.0, 1.0]; now.edges.len()], &Grading::default());
                }
            }
            now.edges.iter_mut().flatten().for_each(|p| p.mark = Mark::Keep);
            let mesh = now.mesh(&polygon).expect("a mesh");
            prop_assert_eq!(&Subdivision::new(&mesh, &vec![Mark::Keep; mesh.len()]), &now);
            prop_assert_eq!(now.dofs(), Space::new(&mesh).dofs());
        }
    }

    /// The mark of an element is that of the piece with its ends.
    #[test]
    fn marks_follow_their_elements((_, mesh) in polygon_and_mesh(3)) {
        let of = |e: usize| Mark::refine(e.is_multiple_of(2), 1.0 + e as f64);
        let subdivision = Subdivision::new(&mesh, &(0..mesh.len()).map(of).collect::<Vec<_>>());
        prop_assert_eq!(subdivision.edges.iter().map(Vec::len).sum::<usize>(), mesh.len());
        for e in 0..mesh.len() {
            let [a, b] = mesh.span[e];
            let want = Piece { start: a.min(b), end: a.max(b), degree: mesh.degree[e], mark: of(e) };
            prop_assert!(subdivision.edges[mesh.edge[e]].contains(&want));
        }
    }
}

#[test]
fn the_highest_degree_of_a_mesh_is_no_limit() {
    let mesh = Mesh::uniform(&crate::common::polygon(&crate::common::SQUARE, &[]), 4, Mesh::MAX_DEGREE);
    let marks = [true, false, true, false].map(|rough| Mark::refine(rough, 9.0));
    let after = Subdivision::new(&mesh, &marks).refined(&vec![vec![0.0]; 4], &Grading::default());
    assert!(after.edges.iter().flatten().all(|p| p.degree == Mesh::MAX_DEGREE));
}
