//! A block that nothing but contact and friction holds, on unsymmetric strongly graded meshes: the interior point method
//! against the balance of forces.

use steklov_bem_operators::{
    Condensation, Datum, Domain, Loop, Mesh, Operators, Partition, Polygon, Site, Space, Steklov, add_load,
    side_moments,
};
use steklov_contact::{ContactError, Problem, SideData, contact_boundary, interior_point, kkt};
use steklov_elastic::{Material, Plane};

/// Breaks and degrees of a side of length 1 graded with ratio 0.15 towards each of the points: layers before and after it.
fn graded(points: &[(f64, usize, usize)], slope: usize) -> (Vec<f64>, Vec<usize>) {
    let mut starts = Vec::new();
    for pair in points.windows(2) {
        let [(a, _, after), (b, before, _)] = [pair[0], pair[1]];
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let cut = |layer: usize| half * 0.15f64.powi(layer as i32);
        starts.push((a, 2));
        starts.extend((1..=after).rev().map(|j| (a + cut(j), 2 + slope * (after + 1 - j).min(8))));
        starts.push((middle, 2 + slope * before.min(8)));
        starts.extend((1..=before).map(|j| (b - cut(j), 2 + slope * (before - j).min(8))));
    }
    (starts[1..].iter().map(|s| s.0).collect(), starts.iter().map(|s| s.1).collect())
}

/// The unit square on the floor y = 0, pressed down by 1 + x and pulled along x by `pull`, on its top.
fn block(floor: (Vec<f64>, Vec<usize>), friction: f64, pull: f64) -> Problem {
    let corners = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let sides = ["floor", "right", "top", "left"].map(String::from).to_vec();
    let polygon = Polygon::new(Loop::straight(corners, sides), vec![]).unwrap();
    let thirds = (vec![1.0 / 3.0, 2.0 / 3.0], vec![3; 3]);
    let (breaks, degrees): (Vec<_>, Vec<_>) = [floor, thirds.clone(), thirds.clone(), thirds].into_iter().unzip();
    let mesh = Mesh::from_breaks(&polygon, &breaks, &degrees).unwrap();
    let space = Space::new(&mesh);
    let material = Material::new(200.0, 0.3, Plane::Strain).unwrap();
    let operators = Operators::assemble(&mesh, &space, &material, None).unwrap();
    let steklov = Steklov::new(operators, Domain::Interior).unwrap();
    let kinks = |_: usize| vec![];
    let mut load = vec![0.0; space.dofs()];
    let (down, along) = (|s: &Site| -1.0 - s.point[0], |_: &Site| pull);
    for (value, direction) in [(&down as &(dyn Fn(&Site) -> f64 + Sync), [0.0, 1.0]), (&along, [1.0, 0.0])] {
        let datum = Datum { name: "traction", value, kinks: &kinks, rounding: None };
        add_load(&mut load, &space, &side_moments(&mesh, &space, 2, &datum).unwrap(), |_| direction);
    }
    let (gap, bound) = (|_: &Site| 0.0, |_: &Site| friction);
    let data = SideData {
        side: 0,
        gap: Datum { name: "gap", value: &gap, kinks: &kinks, rounding: None },
        bound: Some(Datum { name: "friction", value: &bound, kinks: &kinks, rounding: None }),
        coefficient: None,
        beyond: None,
    };
    let boundary = contact_boundary(&mesh, &space, &[data], &|_| [None; 2]).unwrap();
    let partition = Partition { kept: boundary.kept(), held: Vec::new(), frames: boundary.frames() };
    let condensation = Condensation::new(steklov.matrix, &partition, &[]).unwrap();
    let kept = condensation.load(&load).kept;
    Problem { stiffness: condensation.stiffness().expect("no fault").into(), load: kept, nodes: boundary.contact }
}

#[test]
fn friction_alone_holds_a_block_on_any_mesh() {
    let meshes: [&[(f64, usize, usize)]; 4] = [
        &[(0.0, 0, 5), (0.07, 8, 5), (0.6, 2, 3), (0.93, 11, 4), (1.0, 4, 0)],
        &[(0.0, 0, 11), (0.07, 11, 0), (0.6, 4, 11), (0.9, 0, 2), (1.0, 11, 0)],
        &[(0.0, 0, 1), (0.22, 7, 11), (0.24, 6, 6), (0.5, 11, 3), (0.76, 0, 5), (1.0, 0, 0)],
        &[(0.0, 0, 1), (0.071, 6, 6), (0.178, 3, 3), (0.5, 0, 4), (0.929, 11, 11), (1.0, 4, 0)],
    ];
    for (points, slope) in meshes.into_iter().flat_map(|m| [(m, 0), (m, 1)]) {
        // the floor carries ∫ (1 + x) = 3/2 down and the pull along x, up to all of what friction can hold
        for (friction, pull) in [(0.3, 0.0), (0.3, 0.1), (0.3, 0.2999), (0.02, -0.01)] {
            let problem = block(graded(points, slope), friction, pull);
            let answer = interior_point(&problem).unwrap();
            let judged = kkt(&problem, &answer);
            let conditions = problem.nodes.iter().map(|n| &n.conditions[0]);
            let [down, along] = conditions.zip(&answer.multipliers).fold([0.0; 2], |[n, t], (c, [pressure, shear])| {
                [n + c.normal_weight * pressure, t + c.tangent_weight * shear]
            });
            assert!(answer.converged() && judged.worst() <= 1e-10, "{judged:?} {:?}", answer.history);
            assert!((down - 1.5).abs() < 1e-9 && (along - pull).abs() < 1e-9, "{down} {along} {pull}");
            assert!(answer.iterations <= 40, "{:?}", answer.history);
        }
        let pulled = interior_point(&block(graded(points, slope), 0.3, 0.3001));
        assert!(matches!(pulled, Err(ContactError::NotHeld { .. })), "{pulled:?}");
    }
}

/// Three quarters of the floor slip against the pull and one with it: (3/4 - 1/4) 0.02 is the pull. With 50 elements that is
/// between two nodes: all slip, and the body may lie anywhere between two changes of direction.
#[test]
fn friction_that_is_used_up_balances_the_pull() {
    for elements in [12, 50] {
        let breaks = (1..elements).map(|i| f64::from(i) / f64::from(elements)).collect();
        let problem = block((breaks, vec![1; elements as usize]), 0.02, -0.01);
        let answer = interior_point(&problem).unwrap();
        assert!(answer.converged() && kkt(&problem, &answer).worst() <= 1e-10, "{:?}", answer.history);
        let all_slip = answer.multipliers.iter().all(|l| (l[1].abs() - 0.02).abs() < 1e-9);
        assert!(all_slip == (elements == 50), "{:?}", answer.multipliers);
        assert!(answer.iterations <= 20, "{:?}", answer.history);
    }
}
