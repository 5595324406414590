//! Where nothing resists sliding, the tangential unknowns are eliminated before contact is solved: the answer is the same.

use faer::Mat;
use proptest::prelude::*;
use steklov_bem_operators::{
    Condensation, Datum, Domain, Loop, Mesh, Operators, Partition, Polygon, Site, Space, Steklov, add_load,
    side_moments,
};
use steklov_contact::{ContactBoundary, Problem, SideData, Solution, contact_boundary, interior_point};
use steklov_elastic::{Material, Plane};

fn turned(angle: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    [x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos()]
}

/// All displacements and the answer of the condensed problem.
fn solved(
    stiffness: &Mat<f64>,
    load: &[f64],
    held: &[(usize, f64)],
    boundary: &ContactBoundary,
) -> (Vec<f64>, Solution) {
    let partition = Partition { kept: boundary.kept(), held: held.to_vec(), frames: boundary.frames() };
    let condensation = Condensation::new(stiffness.clone(), &partition, &[]).expect("held");
    let condensed = condensation.load(load);
    let (nodes, load) = (boundary.contact.clone(), condensed.kept.clone());
    let problem = Problem { stiffness: condensation.stiffness().expect("no fault").into(), load, nodes };
    let mut solution = interior_point(&problem).expect("a solution");
    assert!(solution.converged());
    let displacement = condensation.expand(&condensed, &solution.displacement);
    boundary.tell_slip(&displacement, &mut solution.status);
    (displacement, solution)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A square, turned, whose top is held and pushed down; floor and right side may touch, the floor with friction or without.
    #[test]
    fn without_tangents_the_answer_is_the_same(
        angle in -3.0..3.0f64,
        degree in 1..4usize,
        gaps in prop::array::uniform2(-0.01..0.02f64),
        pushed in prop::array::uniform2(-0.03..0.03f64),
        bound in prop::option::of(0.01..1.0f64),
    ) {
        let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|x| turned(angle, x)).to_vec();
        let names = ["floor", "right", "top", "left"].map(String::from).to_vec();
        let polygon = Polygon::new(Loop::straight(corners, names), Vec::new()).expect("a square");
        let mesh = Mesh::uniform(&polygon, 16, degree);
        let space = Space::new(&mesh);
        let kinks = |_: usize| Vec::new();
        let mut load = vec![0.0; space.dofs()];
        let pressure = |x: &Site| 3.0 * x.s;
        let datum = Datum { name: "traction", value: &pressure, kinks: &kinks, rounding: None };
        let moments = side_moments(&mesh, &space, 3, &datum).expect("smooth");
        add_load(&mut load, &space, &moments, |_| turned(angle, [1.0, 0.3]));
        let mut held = vec![None; space.nodes()];
        for e in (0..mesh.len()).filter(|&e| mesh.side[e] == 2) {
            space.element_nodes(e).for_each(|node| held[node] = Some(turned(angle, pushed)));
        }
        let values = [0, 1].map(|side| move |x: &Site| gaps[side] * (1.0 + x.s));
        let friction = |_: &Site| bound.unwrap_or(0.0);
        let sides = [0, 1].map(|side| SideData {
            side,
            gap: Datum { name: "gap", value: &values[side], kinks: &kinks, rounding: None },
            bound: (side == 0 && bound.is_some()).then_some(Datum { name: "bound", value: &friction, kinks: &kinks, rounding: None }),
            coefficient: None, beyond: None });
        let whole = contact_boundary(&mesh, &space, &sides, &|i| held[i].map_or([None; 2], |u| u.map(Some)));
        let whole = whole.expect("contact sides");
        let small = whole.clone().without_tangents(&|side| side == 1 || bound.is_none());
        let unknowns = |boundary: &ContactBoundary| boundary.kept().len();
        // the corner keeps both of its unknowns
        let ordinary = whole.nodes.iter().filter(|n| n.frame.is_some());
        let free = ordinary.filter(|n| n.conditions[0].shares.iter().all(|s| s.side == 1 || bound.is_none())).count();
        prop_assert!(free > 0 && unknowns(&whole) - unknowns(&small) == free);

        let material = Material::new(1.0, 0.3, Plane::Strain).expect("valid");
        let operators = Operators::assemble(&mesh, &space, &material, None).expect("operators");
        let stiffness = Steklov::new(operators, Domain::Interior).expect("S").matrix;
        let known = held.iter().enumerate().filter_map(|(i, u)| u.map(|u| [(2 * i, u[0]), (2 * i + 1, u[1])]));
        let held: Vec<(usize, f64)> = known.flatten().collect();
        let [(u, a), (v, b)] = [&whole, &small].map(|boundary| solved(&stiffness, &load, &held, boundary));
        let largest = u.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        for (u, v) in u.iter().zip(&v) {
            prop_assert!((u - v).abs() < 1e-9 * largest, "{u} {v}");
        }
        let pressure = a.multipliers.iter().fold(1e-12, |m: f64, l| m.max(l[0]));
        for (i, (a, b)) in a.multipliers.iter().zip(&b.multipliers).enumerate() {
            let off = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
            prop_assert!(off < 1e-7 * pressure, "{i}: {a:?} {b:?}");
        }
        // which way a node slips that does not move is a matter of rounding
        let nodes = whole.nodes.iter().zip(&whole.contact);
        let conditions = nodes.flat_map(|(node, contact)| {
            node.conditions.iter().zip(&contact.conditions).map(move |(plane, c)| (node.node, plane.tangent, c.slip_offset))
        });
        for (i, (node, t, offset)) in conditions.enumerate() {
            let slip = u[2 * node] * t[0] + u[2 * node + 1] * t[1] + offset;
            let moves = slip.abs() > 1e-8 * largest && a.multipliers[i][0] > 1e-6 * pressure;
            prop_assert!(!moves || a.status[i] == b.status[i], "{i}: {:?} {:?}", a.status[i], b.status[i]);
        }
    }
}
