//! Contact conditions in the order of the edges.

use proptest::prelude::*;
use steklov_elastic::plane::{dot, minus};

use super::boundaries::{build, free, mesh, near};

/// Ends of the edges of the polygon of [`mesh`].
const CORNERS: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [3.5, 2.0], [-0.5, 1.5], [0.0, 0.0]];

proptest! {
    #[test]
    fn every_condition_is_on_its_line(elements in 7..20usize, degree in 1..5usize, first_held in any::<bool>()) {
        let m = mesh(["floor", "floor", "wall", "top", "top"], elements, degree);
        let held =
            |node: usize| if first_held && near(m.1.points[node], [0.0, 0.0]) { [Some(0.0); 2] } else { free(node) };
        let boundary = build(&m, &["floor", "wall"], &|_| 0.1, &|_| 1.0, &held).unwrap();
        let lines = boundary.lines(&m.0, &m.1);
        prop_assert_eq!(lines.iter().map(|l| l.edge).collect::<Vec<_>>(), [0, 1, 2]);
        let count: usize = boundary.contact.iter().map(|n| n.conditions.len()).sum();
        let mut seen = vec![0; count];
        for line in &lines {
            let [a, b] = [CORNERS[line.edge], CORNERS[line.edge + 1]];
            let degrees: usize = (0..m.0.len()).filter(|&e| m.0.edge[e] == line.edge).map(|e| m.0.degree[e]).sum();
            prop_assert_eq!(line.points.len(), degrees + 1 - usize::from(first_held && line.edge == 0));
            prop_assert!(line.points.windows(2).all(|p| p[0].s < p[1].s));
            for p in &line.points {
                seen[p.index] += 1;
                let at = [0, 1].map(|i| a[i] + p.s * (b[i] - a[i]));
                prop_assert!(near(boundary.nodes[p.node].point, at));
                let before: usize = boundary.contact[..p.node].iter().map(|n| n.conditions.len()).sum();
                prop_assert_eq!(p.index, before + p.condition);
                let normal = boundary.nodes[p.node].conditions[p.condition].normal;
                prop_assert!(dot(normal, minus(b, a)).abs() < 1e-12);
            }
        }
        // the straight joint of the edges 0 and 1 has one condition on two lines, the bend one for each line
        let joint = boundary.nodes.iter().position(|n| near(n.point, [1.0, 0.0])).unwrap();
        let before: usize = boundary.contact[..joint].iter().map(|n| n.conditions.len()).sum();
        prop_assert_eq!(seen.remove(before), 2);
        prop_assert!(seen.iter().all(|n| *n == 1));
    }

    #[test]
    fn an_element_has_the_conditions_of_its_nodes(elements in 7..20usize, degree in 1..5usize) {
        let m = mesh(["floor", "floor", "wall", "top", "top"], elements, degree);
        let held = |node: usize| if near(m.1.points[node], [3.5, 2.0]) { [Some(0.0); 2] } else { free(node) };
        let boundary = build(&m, &["floor", "wall"], &|_| 0.1, &|_| 1.0, &held).unwrap();
        let found = boundary.elements(&m.0, &m.1);
        let contact: Vec<usize> = (0..m.0.len()).filter(|&e| m.0.edge[e] < 3).collect();
        prop_assert_eq!(found.iter().map(|e| e.element).collect::<Vec<_>>(), contact);
        for element in &found {
            let nodes: Vec<usize> = m.1.element_nodes(element.element).collect();
            prop_assert_eq!(element.points.len(), nodes.len());
            for (point, node) in element.points.iter().zip(nodes) {
                prop_assert_eq!(point.is_none(), near(m.1.points[node], [3.5, 2.0]));
                prop_assert!(point.is_none_or(|p| boundary.nodes[p.node].node == node));
            }
        }
    }
}
