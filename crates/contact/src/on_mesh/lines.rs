//! The conditions of a contact boundary along the edges of the body.

use std::collections::HashMap;

use steklov_bem_operators::{Mesh, Space};
use steklov_elastic::plane::dot;

use crate::{BoundaryCondition, ContactBoundary};

/// A condition on an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinePoint {
    /// Edge parameter of the node.
    pub s: f64,
    /// Node, an index into [`ContactBoundary::nodes`].
    pub node: usize,
    /// Number of the condition within the node.
    pub condition: usize,
    /// Number of the condition in the order of the multipliers.
    pub index: usize,
}

/// The conditions of an edge in the order of its parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLine {
    /// Edge of the polygon.
    pub edge: usize,
    /// Its conditions, s rising.
    pub points: Vec<LinePoint>,
}

/// A contact element and the conditions at its nodes from start to end; none at a held node without multipliers.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementConditions {
    /// Element of the mesh.
    pub element: usize,
    /// One entry for each of the p+1 nodes.
    pub points: Vec<Option<LinePoint>>,
}

impl ContactBoundary {
    /// The conditions at the nodes of every contact element.
    pub fn elements(&self, mesh: &Mesh, space: &Space) -> Vec<ElementConditions> {
        let mut first = 0;
        let mut of_node = HashMap::new();
        for (i, node) in self.nodes.iter().enumerate() {
            of_node.insert(node.node, (i, first));
            first += node.conditions.len();
        }
        self.elements
            .iter()
            .map(|&e| {
                let nodes = space.element_nodes(e).enumerate();
                let points = nodes.map(|(j, node)| {
                    let &(i, first) = of_node.get(&node)?;
                    let conditions = &self.nodes[i].conditions;
                    let normal = mesh.normal(e, space.basis(e).nodes[j]);
                    let along = |c: &BoundaryCondition| dot(c.normal, normal);
                    let nearest = conditions.iter().enumerate().max_by(|a, b| along(a.1).total_cmp(&along(b.1)));
                    let (condition, _) = nearest.filter(|(_, c)| along(c) > 0.0)?;
                    let s = mesh.edge_parameter(e, space.basis(e).nodes[j]);
                    Some(LinePoint { s, node: i, condition, index: first + condition })
                });
                ElementConditions { element: e, points: points.collect() }
            })
            .collect()
    }

    /// The conditions of every edge that has some, by rising edge.
    pub fn lines(&self, mesh: &Mesh, space: &Space) -> Vec<ContactLine> {
        let mut lines: Vec<ContactLine> = Vec::new();
        for element in self.elements(mesh, space) {
            let edge = mesh.edge[element.element];
            let at = lines.iter().position(|l| l.edge == edge).unwrap_or_else(|| {
                lines.push(ContactLine { edge, points: Vec::new() });
                lines.len() - 1
            });
            lines[at].points.extend(element.points.into_iter().flatten());
        }
        for line in &mut lines {
            line.points.sort_by(|a, b| a.s.total_cmp(&b.s));
            line.points.dedup_by_key(|p| p.index);
        }
        lines.sort_by_key(|l| l.edge);
        lines
    }
}
