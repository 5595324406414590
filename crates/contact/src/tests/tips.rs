//! Mesh vertices that follow transitions, on rows of springs.

use proptest::collection::vec;
use proptest::prelude::*;
use steklov_bem_operators::{Mark, Piece, Subdivision};

use super::rows::Row;
use crate::TipKind::{ContactEnd, SlipReversal, StickEnd};
use crate::{Located, Obstacle, Solution, Solved, Tip, TipKind, active_set, relocate};
use crate::{Sets, transitions};

/// Degree of all pieces.
const DEGREE: usize = 3;

/// k of λ_n = 6 k (a - s)^½.
const ROOT: f64 = 0.05;

/// Pieces of one edge between the given points.
fn subdivision(points: &[f64]) -> Subdivision {
    let piece = |w: &[f64]| Piece { start: w[0], end: w[1], degree: DEGREE, mark: Mark::Keep };
    Subdivision { edges: vec![points.windows(2).map(piece).collect()] }
}

fn vertices(subdivision: &Subdivision) -> Vec<f64> {
    let pieces = &subdivision.edges[0];
    pieces.iter().map(|p| p.start).chain(pieces.last().map(|p| p.end)).collect()
}

/// Nodes of the pieces, equally spaced.
fn nodes(subdivision: &Subdivision) -> Vec<f64> {
    let within = |p: &Piece| {
        let (start, length) = (p.start, p.end - p.start);
        (0..DEGREE).map(move |j| start + length * j as f64 / DEGREE as f64)
    };
    subdivision.edges[0].iter().flat_map(within).chain([subdivision.edges[0].last().unwrap().end]).collect()
}

/// One step on given sets.
fn step(
    row: &Row,
    sets: &Sets,
    solution: &Solution,
    tips: &mut Vec<Tip>,
    mesh: &mut Subdivision,
    singular: &[f64],
) -> Vec<Located> {
    let lines = [row.line.clone()];
    let transitions = [transitions(&row.line, sets)];
    let solved = Solved { problem: &row.problem, solution, sets, lines: &lines, transitions: &transitions };
    relocate(tips, mesh, solved, &[singular.to_vec()], (&[Obstacle::default()], &[])).unwrap()
}

/// A contact or stick end at `a`: λ_n or F - |λ_t| is 6 k (a - s)^½, the gap or slip (s - a)^(3/2), mirrored where the
/// regular side is the lower one.
fn end(mesh: &Subdivision, kind: TipKind, regular: i8, a: f64) -> (Row, Solution, Sets) {
    let mut row = Row::new(&nodes(mesh), 0.4, 0.7);
    let w = |s: f64| match (s - a) * f64::from(regular) {
        beyond if beyond > 0.0 => beyond.powf(1.5),
        beyond => -ROOT * (-beyond).sqrt(),
    };
    row.opening(|s| if kind == ContactEnd { w(s) } else { -1.0 });
    row.slip(-1.0, |s| if kind == StickEnd { w(s) } else { -0.05 });
    let solution = active_set(&row.problem, None).unwrap();
    let sets = Sets::new(&row.problem, &solution).unwrap();
    (row, solution, sets)
}

fn end_kind() -> impl Strategy<Value = (TipKind, i8)> {
    (prop_oneof![Just(ContactEnd), Just(StickEnd)], prop_oneof![Just(-1i8), Just(1)])
}

proptest! {
    /// A tip at its transition stays, one beside it comes to it.
    #[test]
    fn a_tip_finds_its_transition((kind, regular) in end_kind(), a in 0.4..0.6f64, off in 0.001..0.08f64) {
        let s = a + off * f64::from(regular);
        let mut mesh = subdivision(&[0.0, 0.15, 0.3, s, 0.7, 0.85, 1.0]);
        let mut tips = vec![Tip { edge: 0, s, kind, regular }];
        let mut offs = vec![off];
        for _ in 0..10 {
            let (row, solution, sets) = end(&mesh, kind, regular, a);
            let was = tips[0].s;
            let located = step(&row, &sets, &solution, &mut tips, &mut mesh, &[0.0, 1.0]);
            prop_assert_eq!((tips.len(), located.len()), (1, 1));
            prop_assert!(located[0].at_vertex && located[0].kind == kind && located[0].edge == 0);
            prop_assert!((located[0].s - located[0].off - was).abs() < 1e-14 && vertices(&mesh).contains(&tips[0].s));
            offs.push((tips[0].s - a).abs());
        }
        prop_assert!(*offs.last().unwrap() < 1e-9, "{offs:?}");
        // there it stays, to the last bit
        let (row, solution, sets) = end(&mesh, kind, regular, tips[0].s);
        let (at, before) = (tips.clone(), mesh.clone());
        let located = step(&row, &sets, &solution, &mut tips, &mut mesh, &[0.0, 1.0]);
        prop_assert_eq!((&tips, &mesh), (&at, &before));
        prop_assert!(located[0].off.abs() < 1e-10 && (located[0].curvature.unwrap() - 1.0).abs() < 1e-8, "{located:?}");
    }

    /// A transition nearer to an end of the edge than can be resolved draws its tip near, and neither makes a vertex there.
    #[test]
    fn a_tip_stays_off_the_end_of_its_edge((kind, regular) in end_kind(), exponent in -13.0..-9.5f64, upper: bool) {
        let near = 10f64.powf(exponent);
        let a = if upper { 1.0 - near } else { near };
        let points = [1e-8, 1e-4, 0.5, 1.0 - 1e-4, 1.0 - 1e-8];
        let mut mesh = subdivision(&[&[0.0][..], &points, &[1.0]].concat());
        let mut tips = vec![Tip { edge: 0, s: if upper { 1.0 - 1e-8 } else { 1e-8 }, kind, regular }];
        for _ in 0..12 {
            let (row, solution, sets) = end(&mesh, kind, regular, a);
            step(&row, &sets, &solution, &mut tips, &mut mesh, &[0.0, 1.0]);
            prop_assert!(mesh.edges[0].iter().all(|p| p.end - p.start > 1e-12), "{mesh:?}");
            prop_assert!(tips.iter().all(|t| t.s.min(1.0 - t.s) > 0.99e-9), "{tips:?}");
        }
    }

    #[test]
    fn a_new_transition_gets_a_vertex_near_it((kind, regular) in end_kind(), a in 0.2..0.8f64) {
        let mut mesh = subdivision(&[0.0, 0.17, 0.35, 0.52, 0.7, 0.85, 1.0]);
        let (row, solution, sets) = end(&mesh, kind, regular, a);
        let found = transitions(&row.line, &sets);
        prop_assert_eq!(found.len(), 1);
        let [low, high] = found[0].bracket;
        let mut tips = Vec::new();
        let located = step(&row, &sets, &solution, &mut tips, &mut mesh, &[0.0, 1.0]);
        // λ ~ (a - s)^½ is continued to its zero without error, but within the middle of the bracket
        let margin = 0.15 * (high - low);
        let guess = a.clamp(low + margin, high - margin);
        prop_assert!(tips.len() == 1 && (tips[0].s - guess).abs() < 1e-9);
        prop_assert_eq!((tips[0].kind, tips[0].regular), (kind, regular));
        prop_assert!(located.len() == 1 && !located[0].at_vertex && located[0].s == tips[0].s);
        prop_assert!((located[0].off - (high - low) / 2.0).abs() < 1e-15);
        prop_assert!(vertices(&mesh).contains(&tips[0].s));
        // at the vertex the next step has nothing to do
        let (row, solution, sets) = end(&mesh, kind, regular, a);
        let before = mesh.clone();
        step(&row, &sets, &solution, &mut tips, &mut mesh, &[0.0, 1.0]);
        prop_assert!(guess != a || (tips[0].s - a).abs() < 1e-8);
        prop_assert!(mesh.edges[0].len() == before.edges[0].len());
    }

    #[test]
    fn a_tip_without_a_transition_goes_and_its_vertex_stays((kind, regular) in end_kind(), s in 0.3..0.7f64) {
        let mut mesh = subdivision(&[0.0, 0.2, s, 0.8, 1.0]);
        let before = mesh.clone();
        let mut tips = vec![Tip { edge: 0, s, kind, regular }];
        let row = Row::new(&nodes(&mesh), 0.4, 0.7);
        let states = vec![(false, 0); row.line.points.len()];
        let located = step(&row, &row.sets(&states), &row.at_rest(), &mut tips, &mut mesh, &[0.0, 1.0]);
        prop_assert!(tips.is_empty() && located.is_empty() && mesh == before);
    }

    /// Whatever the states, the loads and the tips are: pieces stay in order, fixed vertices where they are, and every
    /// tip has a vertex.
    #[test]
    fn any_step_leaves_a_mesh(
        gaps in vec(0.05..1.0f64, 4..9), states in vec((any::<bool>(), -1..=1i8), 28),
        loads in vec(-1.0..1.0f64, 56), kinds in vec((0..4usize, any::<bool>()), 8), fixed in vec(any::<bool>(), 8)
    ) {
        let total: f64 = gaps.iter().sum();
        let mut points = vec![0.0];
        gaps.iter().for_each(|g| points.push(points.last().unwrap() + g / total));
        *points.last_mut().unwrap() = 1.0;
        let mut mesh = subdivision(&points);
        let (mut tips, mut singular) = (Vec::new(), vec![0.0, 1.0]);
        for ((&s, &(kind, up)), &fixed) in points[1..points.len() - 1].iter().zip(&kinds).zip(&fixed) {
            let regular = if up { 1 } else { -1 };
            match kind {
                0 if fixed => singular.push(s),
                0 => {}
                1 => tips.push(Tip { edge: 0, s, kind: ContactEnd, regular }),
                2 => tips.push(Tip { edge: 0, s, kind: StickEnd, regular }),
                _ => tips.push(Tip { edge: 0, s, kind: SlipReversal, regular: 0 }),
            }
        }
        let mut row = Row::new(&nodes(&mesh), 0.1, 0.3);
        let m = row.problem.load.len();
        row.problem.load.copy_from_slice(&loads[..m]);
        let mut solution = row.at_rest();
        solution.displacement.iter_mut().zip(loads.iter().rev()).for_each(|(v, f)| *v = *f);
        let sets = row.sets(&states[..m / 2]);
        let located = step(&row, &sets, &solution, &mut tips, &mut mesh, &singular);
        let after = vertices(&mesh);
        prop_assert!(after.windows(2).all(|w| w[0] < w[1]), "{after:?}");
        prop_assert!(mesh.edges[0].windows(2).all(|w| w[0].end == w[1].start));
        prop_assert!(singular.iter().all(|s| after.contains(s)), "{singular:?} {after:?}");
        prop_assert!(tips.iter().all(|t| after.contains(&t.s)), "{tips:?} {after:?}");
        prop_assert!(tips.windows(2).all(|t| t[0].s < t[1].s), "{tips:?}");
        prop_assert!(after.len() >= points.len() && located.len() == tips.len());
    }
}

/// Contact up to 0.5 except at some nodes, which are open.
fn islands(open: &[f64]) -> (Row, Sets) {
    let s: Vec<f64> = (0..=100).map(|i| f64::from(i) / 100.0).collect();
    let row = Row::new(&s, 0.4, 0.0);
    let states: Vec<(bool, i8)> = s.iter().map(|s| (*s < 0.495 && !open.contains(s), 0)).collect();
    let sets = row.sets(&states);
    (row, sets)
}

#[test]
fn single_nodes_that_flicker_next_to_a_tip_make_no_transitions() {
    let tip = Tip { edge: 0, s: 0.46, kind: ContactEnd, regular: 1 };
    let after = |open: &[f64], mut tips: Vec<Tip>| {
        let (row, sets) = islands(open);
        let mut mesh = subdivision(&[0.0, 0.25, 0.46, 0.75, 1.0]);
        step(&row, &sets, &row.at_rest(), &mut tips, &mut mesh, &[0.0, 1.0]);
        tips.len()
    };
    assert_eq!(after(&[], vec![tip]), 1);
    // one node open at 0.44, five closed between it and the end at 0.495
    assert_eq!(after(&[0.44], vec![tip]), 1);
    // without a tip there, or a tip of another kind, it is a gap
    assert_eq!(after(&[0.44], vec![]), 3);
    assert_eq!(after(&[0.44], vec![Tip { kind: SlipReversal, regular: 0, ..tip }]), 3);
    // so it is far from the tip, and where it is as long as what lies beside it
    assert_eq!(after(&[0.14], vec![tip]), 3);
    assert_eq!(after(&[0.42, 0.43, 0.44], vec![tip]), 3);
}

/// Slip to both sides of 0.5, where one node sticks.
#[test]
fn a_reversal_keeps_its_vertex_until_it_is_gone() {
    let turned = |middle: f64, mut tips: Vec<Tip>| {
        let mut mesh = subdivision(&[0.0, 0.25, 0.5, 0.75, 1.0]);
        let row = Row::new(&nodes(&mesh), 0.4, 0.7);
        let side = |s: f64| (true, if (s - middle).abs() < 1e-9 { 0 } else { (s - middle).signum() as i8 });
        let states: Vec<(bool, i8)> = row.line.points.iter().map(|p| side(p.s)).collect();
        step(&row, &row.sets(&states), &row.at_rest(), &mut tips, &mut mesh, &[0.0, 1.0]);
        (tips, mesh)
    };
    let (tips, mesh) = turned(0.5, Vec::new());
    let reversal = Tip { edge: 0, s: 0.5, kind: SlipReversal, regular: 0 };
    assert_eq!((tips, vertices(&mesh)), (vec![reversal], vec![0.0, 0.25, 0.5, 0.75, 1.0]));
    assert_eq!(turned(0.5, vec![reversal]).0, [reversal]);
    // two nodes on it has left the tip, and gets a vertex of its own
    let (tips, mesh) = turned(0.75, vec![reversal]);
    assert_eq!(tips, [Tip { s: 0.75, ..reversal }]);
    assert!(vertices(&mesh).contains(&0.5));
}
