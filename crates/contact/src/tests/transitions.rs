//! Changes of state along a line, first guesses of their places, and fits on closed forms.

use proptest::collection::vec;
use proptest::prelude::*;

use super::rows::Row;
use crate::TipKind::{ContactEnd, SlipReversal, StickEnd};
use crate::{
    ContactLine, Decided, Least, TipFit, TipKind, TipVertex, Transition, decided, first_guess, tip_fits, transitions,
};

fn numbered(states: &[(bool, i8)]) -> Row {
    Row::new(&(0..states.len()).map(|i| i as f64).collect::<Vec<_>>(), 0.3, 0.7)
}

fn found(states: &[(bool, i8)]) -> Vec<Transition> {
    let row = numbered(states);
    transitions(&row.line, &row.sets(states))
}

proptest! {
    #[test]
    fn every_change_of_contact_is_found_once(states in vec((any::<bool>(), -1..=1i8), 1..12)) {
        let ends: Vec<Transition> = found(&states).into_iter().filter(|t| t.kind == ContactEnd).collect();
        let mut at = ends.iter();
        for i in 1..states.len() {
            if states[i - 1].0 != states[i].0 {
                let regular = if states[i].0 { -1 } else { 1 };
                let bracket = [(i - 1) as f64, i as f64];
                prop_assert_eq!(at.next(), Some(&Transition { bracket, kind: ContactEnd, regular, point: i - 1 }));
            }
        }
        prop_assert_eq!(at.next(), None);
    }

    /// Every change of slip is in the bracket of exactly one transition, which is what its ends say.
    #[test]
    fn every_change_of_slip_is_found_once(states in vec((any::<bool>(), -1..=1i8), 1..12)) {
        let slip = |i: usize| states[i].1;
        let mut covered = vec![0; states.len()];
        for t in found(&states).iter().filter(|t| t.kind != ContactEnd) {
            let (a, b) = (t.bracket[0] as usize, t.bracket[1] as usize);
            prop_assert_eq!(a, t.point);
            (a..b).for_each(|i| covered[i] += 1);
            match t.kind {
                StickEnd => {
                    let (stick, slips) = if t.regular > 0 { (a, b) } else { (b, a) };
                    prop_assert!(b == a + 1 && slip(stick) == 0 && slip(slips) != 0);
                    // a single node that sticks between both directions would be a reversal
                    let next = Some(b + 1).filter(|&i| i < states.len());
                    let beyond = if t.regular > 0 { a.checked_sub(1) } else { next };
                    prop_assert!(beyond.is_none_or(|i| slip(i) * slip(slips) >= 0));
                }
                _ => {
                    prop_assert!(slip(a) * slip(b) < 0 && t.regular == 0);
                    prop_assert!(b == a + 1 || b == a + 2 && slip(a + 1) == 0);
                }
            }
        }
        for i in 1..states.len() {
            prop_assert_eq!(covered[i - 1], i32::from(slip(i - 1) != slip(i)));
        }
    }

    #[test]
    fn a_mirrored_line_has_the_mirrored_transitions(states in vec((any::<bool>(), -1..=1i8), 1..12)) {
        let last = (states.len() - 1) as f64;
        let mirrored: Vec<(bool, i8)> = states.iter().rev().copied().collect();
        let key = |t: &Transition| (t.bracket.map(|s| s as i64), t.kind as i32, t.regular);
        let mut one: Vec<_> = found(&states).iter().map(key).collect();
        let back = |t: &Transition| {
            let bracket = [last - t.bracket[1], last - t.bracket[0]];
            key(&Transition { bracket, regular: -t.regular, ..*t })
        };
        let mut other: Vec<_> = found(&mirrored).iter().map(back).collect();
        one.sort();
        other.sort();
        prop_assert_eq!(one, other);
    }

    /// λ_n = K (a - s)^½ and F - |λ_t| = K (a - s)^½ vanish at a; far from the bracket it is clipped.
    #[test]
    fn a_square_root_is_continued_to_its_zero(
        a in 0.05..1.95f64, k in 0.01..0.2f64, kind in prop_oneof![Just(ContactEnd), Just(StickEnd)],
        right in any::<bool>(), slip in prop_oneof![Just(-1i8), Just(1)]
    ) {
        let regular: i8 = if right { 1 } else { -1 };
        let row = Row::new(&[0.0, 1.0, 2.0, 3.0], 0.0, 0.7);
        let mut solution = row.at_rest();
        // the zero lies at 1 + a from the end where it is closed, the last closed node at 1
        let zero = if right { 1.0 + a } else { 2.0 - a };
        for (i, l) in solution.multipliers.iter_mut().enumerate() {
            let root = k * (f64::from(regular) * (zero - i as f64)).max(0.0).sqrt();
            *l = [root, f64::from(slip) * (0.7 - root)];
        }
        let (bracket, point) = ([1.0, 2.0], 1);
        let transition = Transition { bracket, kind, regular, point };
        let guess = first_guess(&row.line, &transition, &row.problem, &solution);
        prop_assert!((guess - zero.clamp(1.15, 1.85)).abs() < 1e-9, "{guess} {zero}");
    }

    #[test]
    fn slip_turns_where_it_vanishes(a in 0.1..1.0f64, b in 0.1..1.0f64) {
        let row = Row::new(&[0.0, 1.0, 3.0], 0.0, 0.7);
        let mut solution = row.at_rest();
        (solution.displacement[3], solution.displacement[5]) = (-a, b);
        let transition = Transition { bracket: [1.0, 3.0], kind: SlipReversal, regular: 0, point: 1 };
        let guess = first_guess(&row.line, &transition, &row.problem, &solution);
        prop_assert!((guess - (1.0 + 2.0 * a / (a + b))).abs() < 1e-14);
        // a single node that sticks is the place
        let transition = Transition { bracket: [0.0, 3.0], kind: SlipReversal, regular: 0, point: 0 };
        prop_assert_eq!(first_guess(&row.line, &transition, &row.problem, &solution), 1.0);
    }
}

#[test]
fn one_state_has_no_transition() {
    for states in [[(true, 0); 9], [(false, 0); 9], [(true, 1); 9], [(false, -1); 9]] {
        assert_eq!(found(&states), []);
    }
    // without friction there is no slip
    let row = Row::new(&[0.0, 1.0, 2.0], 0.3, 0.0);
    let sets = row.sets(&[(true, 1), (true, 0), (false, -1)]);
    let kinds: Vec<TipKind> = transitions(&row.line, &sets).iter().map(|t| t.kind).collect();
    assert_eq!(kinds, [ContactEnd]);
}

#[test]
fn an_end_of_a_single_closed_node_is_guessed_in_the_middle() {
    let row = Row::new(&[0.0, 1.0], 0.0, 0.7);
    let mut solution = row.at_rest();
    solution.multipliers[0] = [2.0, 0.1];
    let transition = Transition { bracket: [0.0, 1.0], kind: ContactEnd, regular: 1, point: 0 };
    assert_eq!(first_guess(&row.line, &transition, &row.problem, &solution), 0.5);
}

/// A vertex for a contact or stick end.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    s: f64,
    kind: TipKind,
    regular: i8,
    /// Sign of the slip at stick ends.
    turn: f64,
}

impl Vertex {
    fn distance(&self, s: f64) -> f64 {
        (s - self.s) * f64::from(self.regular)
    }

    /// Nodes whose gap or slip is w(d) at their distance d if the sets let them.
    fn row(&self, d: &[f64], w: impl Fn(f64) -> f64) -> Row {
        let mut s: Vec<f64> = d.iter().map(|d| self.s + d * f64::from(self.regular)).collect();
        s.extend([0.0, 0.05, 0.1].map(|d| self.s - d * f64::from(self.regular)));
        s.sort_by(f64::total_cmp);
        let mut row = Row::new(&s, 0.4, 0.7);
        let beside = |s: f64| self.distance(s).max(0.0);
        row.opening(|s| w(beside(s)));
        row.slip(self.turn, |s| w(beside(s)));
        row
    }

    fn fit(&self, row: &Row, states: &[(bool, i8)], singular: &[f64]) -> Option<TipFit> {
        let Self { s, kind, regular, .. } = *self;
        let vertex = TipVertex { line: &row.line, kind, regular, s, singular: singular.to_vec(), among_valleys: false };
        tip_fits(&[vertex], &row.problem, &row.sets(states)).unwrap()[0]
    }

    /// From the sets of the vertex itself, the ends 0 and 1 of the edge being the singular points.
    fn fit_closed_form(&self, d: &[f64], w: impl Fn(f64) -> f64) -> Option<TipFit> {
        let row = self.row(d, w);
        self.fit(&row, &self.states(&row), &[0.0, 1.0])
    }

    fn states(&self, row: &Row) -> Vec<(bool, i8)> {
        let regular = row.line.points.iter().map(|p| self.distance(p.s) > 0.0);
        regular.map(|r| if r { (false, self.turn as i8) } else { (true, 0) }).collect()
    }
}

fn vertex() -> impl Strategy<Value = Vertex> {
    let kind = prop_oneof![Just(ContactEnd), Just(StickEnd)];
    (0.4..0.6f64, kind, prop_oneof![Just(-1i8), Just(1)], prop_oneof![Just(-1.0), Just(1.0)])
        .prop_map(|(s, kind, regular, turn)| Vertex { s, kind, regular, turn })
}

const GRADED: [f64; 8] = [0.001, 0.003, 0.006, 0.015, 0.04, 0.08, 0.12, 0.19];

proptest! {
    /// The three terms of the fit: δ = -A/(1.5 B), B, to rounding.
    #[test]
    fn the_terms_of_the_fit_are_recovered(v in vertex(), delta in -0.01..0.01f64, b in 0.1..10.0f64, c in -1.0..1.0f64) {
        let w = |d: f64| d.sqrt() * (-1.5 * b * delta + b * d + c * d * d);
        let fit = v.fit_closed_form(&GRADED, w).unwrap();
        prop_assert!((fit.shift * f64::from(v.regular) - delta).abs() < 1e-11, "{fit:?}");
        prop_assert!((fit.curvature - b).abs() < 1e-9 * b, "{fit:?}");
        // two or three nodes determine two terms, and only these
        for few in [2, 3] {
            let nodes = &GRADED[4..4 + few];
            let fit = v.fit_closed_form(nodes, |d| d.sqrt() * (-1.5 * b * delta + b * d)).unwrap();
            prop_assert!((fit.shift * f64::from(v.regular) - delta).abs() < 1e-11, "{fit:?}");
        }
        prop_assert_eq!(v.fit_closed_form(&GRADED[..1], w), None);
        prop_assert_eq!(v.fit_closed_form(&GRADED, |d| -b * d.powf(1.5)), None);
    }

    /// w = B (d - δ)^(3/2): right to first order, so that half of δ leaves a quarter of the error.
    #[test]
    fn a_small_shift_is_right_to_first_order(
        v in vertex(), delta in 1e-5..2e-5f64, b in 0.1..10.0f64, left in any::<bool>()
    ) {
        let error = |delta: f64| {
            let fit = v.fit_closed_form(&GRADED, |d| b * (d - delta).max(0.0).powf(1.5)).unwrap();
            (fit.shift * f64::from(v.regular) - delta).abs()
        };
        let delta = if left { -delta } else { delta };
        let (whole, half) = (error(delta), error(delta / 2.0));
        prop_assert!(whole < 0.05 * delta.abs(), "{whole} {delta}");
        prop_assert!((3.7..4.3).contains(&(whole / half)), "{whole:e} {half:e}");
    }

    /// At most 0.4 of the way to the next singular point.
    #[test]
    fn a_shift_ends_before_the_next_singular_point(v in vertex()) {
        let far = |a: f64| v.fit_closed_form(&GRADED, |d| d.sqrt() * (a + d)).unwrap().shift * f64::from(v.regular);
        let (next, previous) = if v.regular > 0 { (1.0 - v.s, v.s) } else { (v.s, 1.0 - v.s) };
        prop_assert!((far(-10.0) - 0.4 * next).abs() < 1e-14 && (far(10.0) + 0.4 * previous).abs() < 1e-14);
    }

    /// Half of the way to the nearer one of the two neighbouring singular points.
    #[test]
    fn nodes_count_up_to_half_of_the_nearest_singular_point(
        v in vertex(), near in 0.05..0.1f64, before in any::<bool>()
    ) {
        let side = if before { -1.0 } else { 1.0 } * f64::from(v.regular);
        let singular = [0.0, 1.0, v.s + side * near];
        let fit = |at: f64| {
            let row = v.row(&GRADED, |d| d.powf(1.5) * if d > at { 2.0 } else { 1.0 });
            v.fit(&row, &v.states(&row), &singular).unwrap()
        };
        let same = fit(f64::INFINITY);
        prop_assert!(same.shift.abs() < 1e-12 && (same.curvature - 1.0).abs() < 1e-10);
        prop_assert_eq!(fit(0.5 * near), same);
        let last = GRADED.iter().copied().filter(|d| *d < 0.5 * near).fold(0.0, f64::max);
        prop_assert!((fit(last - 1e-6).curvature - 1.0).abs() > 1e-3);
    }

    /// The sets within 0.6 of the way to the neighbouring singular points do not count, those beyond do; the slip goes
    /// where most of the nodes beyond the vertex go.
    #[test]
    fn the_sets_near_the_vertex_are_those_of_the_vertex(v in vertex(), drawn in vec(any::<bool>(), 11)) {
        let mut row = v.row(&GRADED, |d| d.powf(1.5));
        // neighbours feel each other
        let mut stiffness = row.problem.stiffness.full().into_owned();
        for i in 2..row.problem.load.len() {
            stiffness[(i, i - 2)] = -1.0;
            stiffness[(i - 2, i)] = -1.0;
        }
        row.problem.stiffness = stiffness.into();
        let states = v.states(&row);
        let exact = v.fit(&row, &states, &[0.0, 1.0]);
        let farthest = if v.regular > 0 { 10 } else { 0 };
        let wrong = |i: usize| match v.kind {
            ContactEnd => (drawn[i], states[i].1),
            _ => (states[i].0, if drawn[i] && i != farthest { 0 } else { v.turn as i8 }),
        };
        prop_assert_eq!(v.fit(&row, &(0..11).map(wrong).collect::<Vec<_>>(), &[0.0, 1.0]), exact);
        // a singular point so near that some nodes beyond it keep their states
        let near = [0.0, 1.0, v.s + 0.02 * f64::from(v.regular)];
        let beyond = states.iter().zip(&row.line.points).map(|(&(closed, slip), p)| match v.kind {
            _ if v.distance(p.s) < 0.012 => (closed, slip),
            ContactEnd => (true, slip),
            _ => (closed, 0),
        });
        prop_assert!(v.fit(&row, &beyond.collect::<Vec<_>>(), &near) != v.fit(&row, &states, &near));
    }
}

/// What is decided of lines of the given nodes: of each node its pressure, or less its gap. A force and a gap of 1 decide.
fn decided_of(values: &[f64], lines: &[[usize; 2]]) -> Decided {
    let s: Vec<f64> = (0..values.len()).map(|i| i as f64).collect();
    let row = Row::new(&s, 0.0, 0.0);
    let sets = row.sets(&values.iter().map(|v| (*v > 0.0, 0)).collect::<Vec<_>>());
    let mut solution = row.at_rest();
    for (i, value) in values.iter().enumerate() {
        solution.multipliers[i] = [value.max(0.0), 0.0];
        solution.displacement[2 * i] = value.min(0.0);
    }
    let line =
        |(edge, &[from, to]): (usize, &[usize; 2])| ContactLine { edge, points: row.line.points[from..to].to_vec() };
    let lines: Vec<ContactLine> = lines.iter().enumerate().map(line).collect();
    decided(&lines, &row.problem, &solution, &sets, &|_| Least { force: 1.0, gap: 1.0 })
}

/// Changes of state between zones that neither press nor open are none, but those to zones that do stay; so do zones that press
/// little between gaps, with a length that is undecided.
#[test]
fn zones_of_rounding_have_no_transitions() {
    let (a, b) = (1e-3, -1e-3);
    let cases: [(&[f64], &[usize], f64); 6] = [
        (&[5.0, 5.0, -5.0, -5.0], &[1], 0.0),
        (&[a, b, a, b, a], &[], 1.5),
        (&[b, b, b, a, b, b], &[], 0.5),
        (&[5.0, 5.0, b, a, b, a, b], &[1], 1.0),
        (&[5.0, 5.0, b, a, -5.0, -5.0], &[1], 0.5),
        (&[5.0, -5.0, a, -5.0, 5.0], &[0, 1, 2, 3], 0.5),
    ];
    for (values, points, undecided) in cases {
        let found = decided_of(values, &[[0, values.len()]]);
        assert_eq!(found.transitions[0].iter().map(|t| t.point).collect::<Vec<_>>(), points, "{values:?}");
        assert_eq!((found.undecided, found.length), (undecided, 0.5 * values.len() as f64), "{values:?}");
    }
}

/// A zone goes on over the end of an edge: each part of it presses too little, both together do not.
#[test]
fn zones_go_on_over_corners() {
    let values = [-1e-3, 0.5, 0.5, 0.5, 0.5, 0.5, -1e-3];
    let count = |lines: &[[usize; 2]]| decided_of(&values, lines).transitions.iter().map(Vec::len).collect::<Vec<_>>();
    assert_eq!(count(&[[0, 4], [3, 7]]), [1, 1]);
    assert_eq!(count(&[[0, 4]]), [0]);
    assert_eq!(count(&[[0, 7]]), [2]);
}
