//! Contact on the displacement bubbles, and what data leave out, against closed forms.

use proptest::collection::vec;
use proptest::prelude::*;
use steklov_bem_operators::{Datum, Loop, Mesh, Polygon, Site, Space};
use steklov_quadrature::legendre_p;

use super::boundaries::{build, free};
use crate::{ContactBubble, Problem, Sets, contact_bubbles, oscillation};

/// A rectangle of the given width whose floor has four elements of the given degrees.
fn rectangle(width: f64, degrees: &[usize; 4]) -> (Mesh, Space) {
    let corners = vec![[0.0, 0.0], [width, 0.0], [width, 1.0], [0.0, 1.0]];
    let sides = ["floor", "right", "top", "left"].map(String::from).to_vec();
    let polygon = Polygon::new(Loop::straight(corners, sides), Vec::new()).unwrap();
    let breaks = [vec![0.1, 0.4, 0.8], vec![], vec![], vec![]];
    let degrees = [degrees.to_vec(), vec![1], vec![1], vec![1]];
    let mesh = Mesh::from_breaks(&polygon, &breaks, &degrees).unwrap();
    let space = Space::new(&mesh);
    (mesh, space)
}

/// P_n(t) of the reference coordinate t.
fn legendre(n: usize, t: f64) -> f64 {
    let mut values = vec![0.0; n + 1];
    legendre_p(t, &mut values);
    values[n]
}

fn datum(value: &(dyn Fn(&Site) -> f64 + Sync)) -> Datum<'_> {
    Datum { name: "datum", value, kinks: &|_| Vec::new(), rounding: None }
}

/// The bubbles of the floor with the given states of its conditions.
fn bubbles(
    m: &(Mesh, Space),
    states: &[(bool, i8)],
    gap: &(dyn Fn(&Site) -> f64 + Sync),
    bound: &(dyn Fn(&Site) -> f64 + Sync),
) -> Vec<ContactBubble> {
    bubbles_of_held(m, states, gap, bound, &free)
}

/// The same with held nodes; the states are those of the conditions that are left.
fn bubbles_of_held(
    m: &(Mesh, Space),
    states: &[(bool, i8)],
    gap: &(dyn Fn(&Site) -> f64 + Sync),
    bound: &(dyn Fn(&Site) -> f64 + Sync),
    held: &dyn Fn(usize) -> [Option<f64>; 2],
) -> Vec<ContactBubble> {
    let boundary = build(m, &["floor"], &|_| 0.1, &|_| 1.0, held).unwrap();
    let size = boundary.kept().len();
    let stiffness = faer::Mat::from_fn(size, size, |i, j| if i == j { 1.0 } else { 0.0 });
    let problem = Problem { stiffness: stiffness.into(), load: vec![0.0; size], nodes: boundary.contact.clone() };
    let solution = crate::active_set(&problem, None).unwrap();
    let mut sets = Sets::new(&problem, &solution).unwrap();
    for (i, &(closed, slip)) in states.iter().enumerate().take(boundary.contact.len()) {
        sets.set_closed(i, closed);
        sets.set_slip(i, slip);
    }
    contact_bubbles(&m.0, &m.1, &boundary, &sets, &|_| datum(gap), &|_| Some(datum(bound)), &|_| {
        Some(datum(&|x| 0.1 + x.point[0]))
    })
    .unwrap()
}

/// The element that ends in node i of the floor, in the order of the conditions, and those inside it.
fn nodes_of(degrees: &[usize; 4], e: usize) -> std::ops::RangeInclusive<usize> {
    let first: usize = degrees[..e].iter().sum();
    first..=first + degrees[e]
}

proptest! {
    #[test]
    fn the_states_of_the_nodes_decide_on_the_bubbles(
        degrees in [1..5usize, 1..5usize, 1..5usize, 1..5usize], width in 0.1..10.0f64,
        states in vec((prop::bool::weighted(0.7), prop_oneof![2 => Just(0i8), 2 => Just(1), 1 => Just(-1)]), 17)
    ) {
        let m = rectangle(width, &degrees);
        // F = 2 + 3 P_(p-1) - P_(p+1), of which the bubble (P_(p+1) - P_(p-1))/(2p+1) sees the last two terms
        let bound = |x: &Site| {
            let p = degrees[x.element];
            3.0 * legendre(p - 1, x.t) - legendre(p + 1, x.t) + if p == 1 { 0.0 } else { 2.0 }
        };
        let found = bubbles(&m, &states, &|_| 0.3, &bound);
        prop_assert_eq!(found.iter().map(|b| b.element).collect::<Vec<_>>(), [0, 1, 2, 3]);
        for (e, bubble) in found.iter().enumerate() {
            let nodes = &states[nodes_of(&degrees, e)];
            let p = degrees[e] as f64;
            prop_assert_eq!(bubble.free[0], nodes.iter().any(|s| !s.0));
            prop_assert_eq!(bubble.free[1], nodes.iter().any(|s| s.1 != 0));
            let inner = if nodes.len() > 2 { &nodes[1..nodes.len() - 1] } else { nodes };
            let plus = inner.iter().all(|s| s.1 > 0 || nodes.len() == 2 && s.1 == 0) && inner.iter().any(|s| s.1 > 0);
            let minus = inner.iter().all(|s| s.1 < 0 || nodes.len() == 2 && s.1 == 0) && inner.iter().any(|s| s.1 < 0);
            let sign = f64::from(i8::from(plus)) - f64::from(i8::from(minus));
            let against = (-2.0 / (2.0 * p + 3.0) - 6.0 / (2.0 * p - 1.0)) / (2.0 * p + 1.0) * m.0.length(e) / 2.0;
            prop_assert_eq!(bubble.load[0], 0.0);
            let middle = m.0.point(e, 0.0)[0];
            let coupling = if bubble.free[0] { 0.0 } else { sign * (0.1 + middle) };
            prop_assert!((bubble.coupling - coupling).abs() < 1e-14 * width, "{bubble:?} {coupling}");
            prop_assert!((bubble.load[1] + sign * against).abs() < 1e-13 * width, "{bubble:?} {}", sign * against);
        }
    }

    /// Open: the gap does not count. A single closed node at an end of an element of degree 2 or more closes nothing.
    #[test]
    fn only_where_it_touches_the_gap_counts(
        degrees in [1..5usize, 1..5usize, 1..5usize, 1..5usize], states in vec(prop::bool::weighted(0.4), 17)
    ) {
        let m = rectangle(1.0, &degrees);
        let states: Vec<(bool, i8)> = states.iter().map(|&closed| (closed, 0)).collect();
        let found = bubbles(&m, &states, &|x| (3.0 * x.point[0]).exp(), &|_| 1.0);
        for (e, bubble) in found.iter().enumerate() {
            let nodes = &states[nodes_of(&degrees, e)];
            let count = nodes.iter().filter(|s| s.0).count();
            let at_end = nodes[0].0 || nodes[nodes.len() - 1].0;
            let open = count == 0 || count == 1 && at_end && nodes.len() > 2;
            prop_assert_eq!(bubble.oscillation == 0.0, open);
        }
    }

    /// The gap a t^(p+1) less its interpolant is a κ (P_(p+1) - P_(p-1)), whose derivative is a κ (2p+1) P_p, where 1/κ is
    /// the leading coefficient of P_(p+1); lengths cancel. Twice the gap is four times that.
    #[test]
    fn the_first_power_beyond_the_degree_is_left_out(
        degrees in [1..7usize, 1..7usize, 1..7usize, 1..7usize], width in 0.1..10.0f64, a in 0.1..10.0f64
    ) {
        let m = rectangle(width, &degrees);
        let power = |x: &Site, by: i32| x.t.powi(degrees[x.element] as i32 + by);
        for e in 0..4 {
            let p = degrees[e] as f64;
            let leading = (1..=degrees[e] + 1).fold(1.0, |l, k| l * (2 * k - 1) as f64 / k as f64);
            let square = (2.0 / (2.0 * p + 3.0) + 2.0 / (2.0 * p - 1.0)) * (2.0 * (2.0 * p + 1.0));
            let exact = (a / leading).powi(2) * square.sqrt();
            let of = |value: &(dyn Fn(&Site) -> f64 + Sync)| oscillation(&m.0, &m.1, e, &datum(value)).unwrap();
            let found = of(&|x| a * power(x, 1) + power(x, 0) - 3.0);
            prop_assert!((found - exact).abs() < 1e-9 * exact, "{found} {exact}");
            prop_assert!((of(&|x| 2.0 * a * power(x, 1)) - 4.0 * exact).abs() < 1e-9 * exact);
            // polynomials of the element's degree are met, but that the nodes at the ends lie 1e-12 inside
            let met = of(&|x| a * power(x, 0) + power(x, -1) - 3.0);
            prop_assert!(met < 1e-22 * (p * (a + 1.0)).powi(2), "{met:e}");
        }
    }
}

/// A held end neither frees nor holds the bubble beside it: what is left of the element decides.
#[test]
fn a_held_end_takes_no_part() {
    let m = rectangle(1.0, &[3, 2, 2, 1]);
    let (gap, bound) = (|x: &Site| (3.0 * x.point[0]).exp(), |_: &Site| 1.0);
    let corner = m.1.node(0, 0);
    for components in [[Some(0.0), None], [None, Some(0.0)], [Some(0.0), Some(0.0)]] {
        let held = |node: usize| if node == corner { components } else { [None; 2] };
        // the held end has a condition only if it can move: 2 to 4 are the other nodes of the first element
        let end = usize::from(components != [Some(0.0); 2]);
        let of = |inner: [(bool, i8); 3]| {
            let mut states = vec![(true, 0); end];
            states.extend(inner);
            states.extend([(false, 1); 8]);
            bubbles_of_held(&m, &states, &gap, &bound, &held)[0]
        };
        assert_eq!(of([(true, 0); 3]).free, [false, false], "{components:?}");
        // the first node inside counts: it alone keeps the element from being open, and from sliding
        let touching = of([(true, 0), (false, 1), (false, 1)]);
        assert!(touching.oscillation > 0.0 && touching.load == [0.0; 2], "{components:?}: {touching:?}");
        let sliding = of([(false, 1), (false, 1), (false, 1)]);
        assert!(sliding.load[1] < 0.0 && sliding.free[1], "{components:?}: {sliding:?}");
    }
}

#[test]
fn data_that_are_not_finite_are_named() {
    let m = rectangle(1.0, &[2; 4]);
    let error = oscillation(&m.0, &m.1, 1, &datum(&|_| f64::NAN)).unwrap_err();
    assert!(error.to_string().contains("floor"), "{error}");
}

/// A kink that two functions of one expression share, up to rounding, is one kink.
#[test]
fn kinks_that_rounding_tells_apart_are_one() {
    let m = rectangle(1.0, &[2; 4]);
    let value = |x: &Site| (x.t - 0.3).abs().sqrt();
    let of = |kinks: &'static [f64]| {
        let once = |_: usize| kinks.to_vec();
        oscillation(&m.0, &m.1, 1, &Datum { name: "gap", value: &value, kinks: &once, rounding: None }).unwrap()
    };
    let one = of(&[0.3]);
    assert!(one > 0.0 && one.is_finite());
    for twice in [&[0.3, 0.3], &[0.3, 0.3 + 1e-16], &[0.3, 0.3 + 1e-13]] {
        assert_eq!(of(twice), one, "{twice:?}");
    }
}
