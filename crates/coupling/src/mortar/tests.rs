use std::f64::consts::TAU;

use proptest::prelude::*;
use steklov_bem_operators::{Loop, Mesh, Polygon, Space};
use steklov_elastic::plane::{minus, norm};

use super::{Facing, cells, meet, mortar_rows};

/// A straight-sided body with a mesh of `parts` random pieces on its first side.
fn mesh(corners: Vec<[f64; 2]>, breaks: &[f64], degree: usize) -> (Mesh, Space) {
    let sides = ["face", "b", "c", "d"].map(String::from).to_vec();
    let polygon = Polygon::new(Loop::straight(corners, sides), vec![]).unwrap();
    let mut breaks = breaks.to_vec();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup_by(|b, a| *b - *a < 1e-3);
    let degrees = vec![vec![degree; breaks.len() + 1], vec![1], vec![1], vec![1]];
    let mesh = Mesh::from_breaks(&polygon, &[breaks, vec![], vec![], vec![]], &degrees).unwrap();
    let space = Space::new(&mesh);
    (mesh, space)
}

fn facing<'a>((mesh, space): &'a (Mesh, Space), elements: &'a [usize]) -> Facing<'a> {
    Facing { mesh, space, elements, modulus: &ALIKE[..mesh.len()] }
}

/// Moduli of bodies that are alike, and of one that gives way to all others.
const ALIKE: [f64; 64] = [1.0; 64];
const SOFT: [f64; 64] = [0.0; 64];

fn first_side(mesh: &Mesh) -> Vec<usize> {
    (0..mesh.len()).filter(|&e| mesh.side[e] == 0).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    /// Between straight sides, also inclined ones, rows sum to 1 and give π(x) of linear functions, x^k of polynomials; the side is
    /// seen along the normal of a body that does not give way.
    #[test]
    fn rows_reproduce_polynomials_on_straight_sides(
        upper in prop::collection::vec(0.01..0.99f64, 0..6),
        lower in prop::collection::vec(0.01..0.99f64, 0..6),
        (p, q) in (1usize..=8, 1usize..=8),
        slope in prop_oneof![Just(0.0), -0.2..0.2f64],
        gap in prop_oneof![Just(0.0), 0.0..0.3f64],
    ) {
        let own = mesh(vec![[-1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]], &upper, p);
        // its first side is the upper one and runs from right to left; it is wider
        let at = |x: f64| [x, -gap + slope * (x - if slope > 0.0 { 1.0 } else { -1.0 })];
        let other = mesh(vec![at(1.5), at(-1.5), [-1.5, -2.0], [1.5, -2.0]], &lower, q);
        let (mine, theirs) = (first_side(&own.0), first_side(&other.0));
        let (own, other) = (facing(&own, &mine), Facing { modulus: &SOFT, ..facing(&other, &theirs) });
        let cells = cells(own, other, [-1.0, 1.0], 0.0);
        for row in mortar_rows(own, other, &cells) {
            let [x, _] = own.space.points[row.node];
            let sum: f64 = row.other.iter().map(|entry| entry.1).sum();
            prop_assert!((sum - 1.0).abs() < 1e-12 && (row.covered - 1.0).abs() < 1e-12, "{sum} {}", row.covered);
            let distance = -at(x)[1];
            prop_assert!((row.distance - distance).abs() < 1e-12, "{} {distance}", row.distance);
            for k in 0..=p.min(q) {
                let found: f64 =
                    row.other.iter().map(|&(j, value)| value * other.space.points[j][0].powi(k as i32)).sum();
                prop_assert!((found - x.powi(k as i32)).abs() < 1e-11, "x^{k} at {x}: {found}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    /// A pair is the same from both sides, and its direction the weighted mean of both normals: of a disc beside a disc or in a hole,
    /// or on a line, of any moduli.
    #[test]
    fn pairs_are_the_same_from_both_sides(
        (radius, gap) in (1.0..3.0f64, 1e-6..0.1f64),
        (own_modulus, other_modulus) in (1e-3..1e3f64, 1e-3..1e3f64),
        (kind, t) in (0usize..3, -0.9..0.9f64),
    ) {
        // the disc touches the other body at its lowest point, up to the gap
        let disc = Polygon::new(Loop::circle([0.0, 1.0 + gap], 1.0, 6, "rim"), vec![]).unwrap();
        let square = |x: f64| Loop::straight(vec![[-x, -x], [x, -x], [x, x], [-x, x]], ["a", "b", "c", "d"].map(String::from).to_vec());
        let other = match kind {
            0 => Polygon::new(Loop::circle([0.0, -radius], radius, 6, "rim"), vec![]).unwrap(),
            1 => Polygon::new(square(20.0), vec![Loop::circle([0.0, 2.0 * radius + 1.0], 2.0 * radius + 1.0, 6, "rim")]).unwrap(),
            _ => Polygon::new(Loop::straight(vec![[5.0, 0.0], [-5.0, 0.0], [0.0, -3.0]], ["rim", "b", "c"].map(String::from).to_vec()), vec![])
                .unwrap(),
        };
        let of = |polygon: &Polygon| {
            let mesh = Mesh::uniform(polygon, 12, 1);
            let space = Space::new(&mesh);
            (mesh, space)
        };
        let (own, other) = (of(&disc), of(&other));
        let moduli = [own_modulus, other_modulus].map(|modulus| vec![modulus; 64]);
        let own = Facing { modulus: &moduli[0], ..facing(&own, &[]) };
        let other = Facing { modulus: &moduli[1], ..facing(&other, &[]) };
        let lowest = |side: &Facing<'_>, e: usize| side.mesh.point(e, 0.0)[1];
        let e = (0..own.mesh.len()).min_by(|&a, &b| lowest(&own, a).total_cmp(&lowest(&own, b))).unwrap();
        let mut found = 0;
        for m in (0..other.mesh.len()).filter(|&m| other.mesh.side_names[other.mesh.side[m]] == "rim") {
            let Some(there) = meet(own, (e, t), other, m).filter(|met| met.t.abs() <= 1.0 && met.distance > 0.0) else { continue };
            if super::dot(own.mesh.normal(e, t), other.mesh.normal(m, there.t)) > -0.2 {
                continue;
            }
            let (x, y) = (own.mesh.point(e, t), other.mesh.point(m, there.t));
            let [pull, push] = [own.pull(e, t), other.pull(m, there.t)];
            let along = minus(pull, push);
            let r = minus(y, x);
            let aside = super::cross(r, along).abs() / norm(along);
            // beyond an end of a curved element it is the end that is met
            if there.t.abs() == 1.0 && aside > 1e-12 {
                continue;
            }
            found += 1;
            prop_assert!(aside < 1e-12 && super::dot(r, along) > 0.0);
            let back = meet(other, (m, there.t), own, e).unwrap();
            prop_assert!((back.t - t).abs() < 1e-7, "{} {t}", back.t);
            prop_assert!((back.distance - there.distance).abs() < 1e-12);
            prop_assert!((0..2).all(|i| (back.direction[i] + there.direction[i]).abs() < 1e-9));
        }
        prop_assert!(found >= 1 || t.abs() > 0.5, "{found} pairs");
    }
}

#[test]
fn a_disc_sees_its_hole_along_the_radius() {
    let radius = 1.01;
    let disc = Polygon::new(Loop::circle([0.0; 2], 1.0, 3, "rim"), vec![]).unwrap();
    let outside = Loop::straight(vec![[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]], vec!["far".into(); 4]);
    let plate = Polygon::new(outside, vec![Loop::circle([0.0; 2], radius, 4, "hole")]).unwrap();
    for (elements, degree) in [(6, 8), (9, 12)] {
        let of = |polygon: &Polygon| {
            let mesh = Mesh::uniform(polygon, elements + 5, degree);
            let space = Space::new(&mesh);
            (mesh, space)
        };
        let (own, other) = (of(&disc), of(&plate));
        let hole = other.0.side_names.iter().position(|name| name == "hole").unwrap();
        let mine: Vec<usize> = (0..own.0.len()).collect();
        let theirs: Vec<usize> = (0..other.0.len()).filter(|&e| other.0.side[e] == hole).collect();
        let (own, other) = (facing(&own, &mine), facing(&other, &theirs));
        let rows = mortar_rows(own, other, &cells(own, other, [-0.1, 0.1], 0.0));
        let length: f64 = rows.iter().map(|row| row.weight).sum();
        assert!((length - TAU).abs() < 1e-13, "{length}");
        for row in &rows {
            let [x, y] = own.space.points[row.node];
            assert!((row.covered - 1.0).abs() < 1e-12, "{}", row.covered);
            assert!((row.distance - (radius - 1.0)).abs() < 1e-12, "{}", row.distance);
            // x of the point that is faced, up to what nodes leave of a cosine
            let seen: f64 = row.other.iter().map(|&(j, value)| value * other.space.points[j][0]).sum();
            assert!((seen - radius * x).abs() < 1e-8, "{seen} {x} {y}");
        }
    }
}

#[test]
fn parts_that_nothing_faces_are_not_covered() {
    let own = mesh(vec![[-1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]], &[0.25, 0.5], 3);
    let other = mesh(vec![[0.0, -0.1], [-3.0, -0.1], [-3.0, -2.0], [0.0, -2.0]], &[0.3], 2);
    let (mine, theirs) = (first_side(&own.0), first_side(&other.0));
    let (own, other) = (facing(&own, &mine), facing(&other, &theirs));
    let found = cells(own, other, [-1.0, 1.0], 0.0);
    for row in mortar_rows(own, other, &found) {
        let [x, _] = own.space.points[row.node];
        // at the end of the faced part only the element before the node is faced
        let expected = if x < -1e-9 {
            1.0
        } else if x > 1e-9 {
            0.0
        } else {
            row.covered
        };
        assert!((row.covered - expected).abs() < 1e-12, "{x}: {}", row.covered);
    }
    assert!(cells(own, other, [-0.05, 0.05], 0.0).is_empty(), "too far");
}
