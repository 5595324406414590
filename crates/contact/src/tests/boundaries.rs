//! Conditions of contact sides: weights, gaps, bounds, held ends, corners, closed loops.

use proptest::prelude::*;
use steklov_bem_operators::{Datum, Loop, Mesh, Polygon, Site, Space};
use steklov_elastic::plane::distance;

use crate::{ContactBoundary, ContactError, SideData, contact_boundary};

/// Corners of a kite-like quadrilateral none of whose sides is along an axis but the first, and its sides' names.
pub fn mesh(names: [&str; 5], elements: usize, degree: usize) -> (Mesh, Space) {
    // the first two edges are one straight line
    let corners = vec![[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [3.5, 2.0], [-0.5, 1.5]];
    let outer = Loop::straight(corners, names.map(String::from).to_vec());
    let mut mesh = Mesh::uniform(&Polygon::new(outer, Vec::new()).unwrap(), elements, degree);
    let n = mesh.len();
    for (e, p) in mesh.degree.iter_mut().enumerate() {
        *p += (e * 7 + n) % 3; // mixed degrees
    }
    let space = Space::new(&mesh);
    (mesh, space)
}

pub type Field<'a> = &'a (dyn Fn(&Site) -> f64 + Sync);

pub fn build(
    (mesh, space): &(Mesh, Space),
    sides: &[&str],
    gap: Field<'_>,
    bound: Field<'_>,
    held: &dyn Fn(usize) -> [Option<f64>; 2],
) -> Result<ContactBoundary, ContactError> {
    let kinks = |_: usize| Vec::new();
    let datum = |name, value| Datum { name, value, kinks: &kinks, rounding: None };
    let index = |name: &str| mesh.side_names.iter().position(|s| s == name).unwrap();
    let sides: Vec<SideData<'_>> = sides
        .iter()
        .map(|s| SideData {
            side: index(s),
            gap: datum("gap", gap),
            bound: Some(datum("bound", bound)),
            coefficient: None,
            beyond: None,
        })
        .collect();
    contact_boundary(mesh, space, &sides, held)
}

pub fn free(_: usize) -> [Option<f64>; 2] {
    [None, None]
}

/// Σ over all conditions of the shares of a side.
fn lengths(boundary: &ContactBoundary, side: usize) -> [f64; 2] {
    let shares = boundary.nodes.iter().flat_map(|n| &n.conditions).flat_map(|c| &c.shares).filter(|s| s.side == side);
    shares.fold([0.0; 2], |sum, s| [sum[0] + s.normal, sum[1] + s.tangent])
}

pub fn near(x: [f64; 2], a: [f64; 2]) -> bool {
    distance(x, a) < 1e-12
}

proptest! {
    #[test]
    fn weights_add_up_and_polynomial_gaps_are_met(
        elements in 5..20usize, degree in 1..6usize, a in -1.0..1.0f64, b in -1.0..1.0f64
    ) {
        let m = mesh(["floor", "floor", "wall", "top", "top"], elements, degree);
        // of degree `degree` on each element: weighted gaps are values; bounds are always values
        let gap = |x: &Site| a + b * x.point[0].powi(degree as i32) - x.point[1];
        let bound = |x: &Site| 1.0 + x.point[0].abs();
        let boundary = build(&m, &["floor"], &gap, &bound, &free).unwrap();
        let [n, t] = lengths(&boundary, 0);
        prop_assert!((n - 3.0).abs() < 1e-13 && (t - 3.0).abs() < 1e-13);
        for (node, contact) in boundary.nodes.iter().zip(&boundary.contact) {
            let c = &contact.conditions[0];
            let exact = a + b * node.point[0].powi(degree as i32);
            prop_assert!((c.gap - exact).abs() < 1e-11 * 3f64.powi(degree as i32));
            prop_assert!((c.bound - 1.0 - node.point[0]).abs() < 1e-14);
            prop_assert_eq!((node.directions[0], node.directions[1]), ([0.0, -1.0], [1.0, 0.0]));
            prop_assert!(c.normal_weight > 0.0 && c.normal_weight == c.tangent_weight);
        }
        prop_assert_eq!(boundary.kept().len(), boundary.contact.iter().map(|c| c.unknowns).sum::<usize>());
        // uniform pressure 2 and shear 3: resultants 6 up and 9 backwards
        let force = boundary.force(0, &vec![[2.0, 3.0]; boundary.nodes.len()]);
        prop_assert!((force[0] + 9.0).abs() < 1e-12 && (force[1] - 6.0).abs() < 1e-12);
    }

    #[test]
    fn a_gap_of_higher_degree_is_a_weighted_mean(degree in 1..5usize) {
        // Σ D_i g_i = ∫ g for every g as Σψ_i = 1, but one degree more than the elements have is no longer met at the
        // nodes
        let m = mesh(["floor", "floor", "wall", "top", "top"], 5, degree);
        let degrees = m.0.degree.iter().zip(&m.0.side).filter(|(_, s)| **s == 0).map(|(p, _)| *p);
        let power = degrees.max().unwrap() as i32 + 1;
        let boundary = build(&m, &["floor"], &|x| x.point[0].powi(power), &|_| 0.0, &free).unwrap();
        let mean: f64 = boundary.contact.iter().map(|c| c.conditions[0].normal_weight * c.conditions[0].gap).sum();
        let exact = 3f64.powi(power + 1) / f64::from(power + 1);
        prop_assert!((mean - exact).abs() < 1e-12 * exact);
        let off = boundary.nodes.iter().zip(&boundary.contact)
            .fold(0.0f64, |m, (n, c)| m.max((c.conditions[0].gap - n.point[0].powi(power)).abs()));
        prop_assert!(off > 1e-4);
    }

    #[test]
    fn held_ends_hand_their_share_on(
        elements in 10..20usize, degree in 1..5usize, ux in -0.1..0.1f64, uy in -0.1..0.1f64
    ) {
        let m = mesh(["floor", "floor", "wall", "top", "top"], elements, degree);
        let end = |node: usize| near(m.1.points[node], [0.0, 0.0]) || near(m.1.points[node], [3.0, 0.0]);
        let held = |node: usize| if end(node) { [Some(ux), Some(uy)] } else { [None, None] };
        let gap = |x: &Site| 0.3 + 0.2 * x.point[0];
        let boundary = build(&m, &["floor"], &gap, &|_| 1.0, &held).unwrap();
        let all = build(&m, &["floor"], &gap, &|_| 1.0, &free).unwrap();
        prop_assert_eq!(boundary.nodes.len() + 2, all.nodes.len());
        let [n, t] = lengths(&boundary, 0);
        prop_assert!((n - 3.0).abs() < 1e-13 && (t - 3.0).abs() < 1e-13);
        // the field u = (ux, uy) everywhere: Σ D g - Σ D u_n is ∫ (g - u_n), and all of Σ D (u_t + offset) is 3 ux
        let (mut opening, mut slip) = (0.0, 0.0);
        for (node, contact) in boundary.nodes.iter().zip(&boundary.contact) {
            let along = |d: [f64; 2]| d[0] * ux + d[1] * uy;
            let w = [along(node.directions[0]), along(node.directions[1])];
            let c = &contact.conditions[0];
            opening += c.normal_weight * c.opening(w);
            slip += c.tangent_weight * c.slip(w);
        }
        prop_assert!((opening - (0.9 + 0.9 + 3.0 * uy)).abs() < 1e-12 && (slip - 3.0 * ux).abs() < 1e-12);
    }

    #[test]
    fn a_roller_takes_the_multiplier_of_its_direction_only(
        elements in 10..20usize, degree in 1..5usize, value in -0.1..0.1f64
    ) {
        let m = mesh(["floor", "floor", "wall", "top", "top"], elements, degree);
        let corner = |node: usize| near(m.1.points[node], [0.0, 0.0]);
        // u_x held at an end of the floor: u_t is known there, u_n is not
        let held = |node: usize| if corner(node) { [Some(value), None] } else { [None, None] };
        let boundary = build(&m, &["floor"], &|x| 0.1 + x.point[0], &|_| 1.0, &held).unwrap();
        let c = &boundary.contact[0];
        let node = boundary.nodes[0].node;
        prop_assert!(corner(node) && c.unknowns == 1 && boundary.kept()[0] == 2 * node + 1);
        prop_assert!(c.conditions[0].normal == [-1.0, 0.0] && c.conditions[0].tangent_weight == 0.0);
        prop_assert!(c.conditions[0].normal_weight > 0.0 && (c.conditions[0].gap - 0.1).abs() < 1e-13);
        let next = &boundary.contact[1].conditions[0];
        let first = c.conditions[0].normal_weight;
        prop_assert!((next.slip_offset - first * value / next.tangent_weight).abs() < 1e-14);
        prop_assert!((next.gap - (0.1 + boundary.nodes[1].point[0])).abs() < 1e-12);
        let [n, t] = lengths(&boundary, 0);
        prop_assert!((n - 3.0).abs() < 1e-13 && (t - 3.0).abs() < 1e-13);
        // at an end of the oblique wall both stay, on the one unknown
        let held = |node: usize| if near(m.1.points[node], [3.5, 2.0]) { [Some(value), None] } else { [None, None] };
        let boundary = build(&m, &["wall"], &|_| 0.1, &|_| 1.0, &held).unwrap();
        let (node, contact) = (boundary.nodes.last().unwrap(), boundary.contact.last().unwrap());
        let (b, c) = (&node.conditions[0], &contact.conditions[0]);
        prop_assert!(contact.unknowns == 1 && c.normal_weight > 0.0 && c.tangent_weight > 0.0);
        // u = (value, w): the condition sees n·u and t·u
        let w = 0.37;
        prop_assert!((c.opening([w, 0.0]) - (0.1 - b.normal[0] * value - b.normal[1] * w)).abs() < 1e-14);
        prop_assert!((c.slip([w, 0.0]) - (b.tangent[0] * value + b.tangent[1] * w)).abs() < 1e-14);
    }
}

#[test]
fn a_bend_has_two_conditions_and_a_straight_joint_one() {
    let m = mesh(["left", "right", "wall", "top", "top"], 12, 2);
    let step = |x: &Site| if x.point[0] < 1.0 { 2.0 } else { 5.0 };
    let boundary = build(&m, &["left", "right", "wall"], &|_| 0.0, &step, &free).unwrap();
    let at = |x| boundary.nodes.iter().position(|n| near(n.point, x)).unwrap();
    let (joint, bend) = (at([1.0, 0.0]), at([3.0, 0.0]));
    for (i, c) in boundary.contact.iter().enumerate() {
        assert_eq!(c.conditions.len(), if i == bend { 2 } else { 1 });
    }
    assert_eq!(boundary.nodes[bend].directions, [[1.0, 0.0], [0.0, 1.0]]);
    assert_eq!(boundary.contact[bend].conditions[0].normal, [0.0, -1.0]);
    // the joint of two straight sides: one condition with both shares, and the bound's limits from both sides by weight
    let shares = &boundary.nodes[joint].conditions[0].shares;
    let condition = &boundary.contact[joint].conditions[0];
    assert!(shares.len() == 2 && (shares[0].normal + shares[1].normal - condition.normal_weight).abs() < 1e-15);
    let mean = (2.0 * shares[0].normal + 5.0 * shares[1].normal) / condition.normal_weight;
    assert!((condition.bound - mean).abs() < 1e-12, "{} {mean}", condition.bound);
    for (side, length) in [(0, 1.0), (1, 2.0), (2, 0.5f64.hypot(2.0))] {
        assert!(lengths(&boundary, side).iter().all(|l| (l - length).abs() < 1e-13));
    }
    // the nodes follow each other
    let x: Vec<f64> = boundary.nodes[..bend].iter().map(|n| n.point[0]).collect();
    assert!(x.windows(2).all(|w| w[0] < w[1]));
}

#[test]
fn contact_all_around_closes() {
    let m = mesh(["all", "all", "all", "all", "all"], 9, 3);
    let boundary = build(&m, &["all"], &|_| 0.1, &|_| 0.0, &free).unwrap();
    assert_eq!(boundary.nodes.len(), m.1.nodes());
    assert_eq!(boundary.contact.iter().filter(|c| c.conditions.len() == 2).count(), 4);
    let perimeter: f64 = (0..m.0.len()).map(|e| m.0.length(e)).sum();
    assert!((lengths(&boundary, 0)[0] - perimeter).abs() < 1e-12);
    // a uniform pressure has no resultant
    let count = boundary.contact.iter().map(|c| c.conditions.len()).sum();
    let force = boundary.force(0, &vec![[1.0, 0.0]; count]);
    assert!(force[0].abs() < 1e-12 && force[1].abs() < 1e-12);
}

#[test]
fn what_cannot_carry_contact_is_refused() {
    let corners = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let names = ["floor", "right", "top", "left"].map(String::from).to_vec();
    let polygon = Polygon::new(Loop::straight(corners, names), Vec::new()).unwrap();
    let floor_only = |degree: usize, value: f64, bound: f64| {
        let mesh = Mesh::uniform(&polygon, 4, degree);
        let space = Space::new(&mesh);
        let points = space.points.clone();
        let held = move |n: usize| {
            if points[n][1] == 0.0 && (points[n][0] == 0.0 || points[n][0] == 1.0) { [Some(0.0); 2] } else { [None; 2] }
        };
        build(&(mesh, space), &["floor"], &|_| value, &|_| bound, &held)
    };
    let message = floor_only(1, 0.0, 1.0).unwrap_err().to_string();
    assert!(message.contains("degree 1") && message.contains("floor"), "{message}");
    let one = floor_only(2, 0.5, 1.0).unwrap();
    let c = &one.contact[0].conditions[0];
    assert!(one.nodes.len() == 1 && (lengths(&one, 0)[0] - 1.0).abs() < 1e-15);
    assert!((c.normal_weight - 2.0 / 3.0).abs() < 1e-15 && (c.gap - 0.75).abs() < 1e-14); // (∫ g)/D_next
    assert!(matches!(floor_only(2, f64::NAN, 1.0), Err(ContactError::Data(_))));
    let message = floor_only(2, 0.0, -1.0).unwrap_err().to_string();
    assert!(message.contains("at least 0") && message.contains("floor"), "{message}");
}
