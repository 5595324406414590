//! Spaces of multipliers on a mesh T_H of the contact boundary, which need not be that of the displacements.
//!
//! ```text
//! W_Hq = { μ in L2(Γ_C) : μ of degree q_J on every J of T_H }     nodes: Lobatto points of J, the middle for q = 0
//! P1    continuous on every straight edge, linear on every J      nodes: the ends of the J
//! ```
//! A multiplier is given by its values at the nodes, where its sign conditions are imposed too. λ_n and λ_t are of the same
//! space.

use steklov_bem_operators::Mesh;
use steklov_quadrature::{LobattoBasis, gauss_legendre};

use crate::ContactError;

/// How T_H follows from the displacement mesh T_h of the contact sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MultiplierMesh {
    /// T_H = T_h.
    Same,
    /// This many neighbours on an edge make one element.
    Coarser(usize),
    /// Every element is divided into this many parts.
    Finer(usize),
    /// Elements begin and end in the middle of those of T_h, or at the ends of an edge.
    Shifted,
}

/// Degree and continuity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MultiplierDegree {
    /// Discontinuous, of the degree of the displacement plus this, but at least 0; of several elements of T_h the largest counts.
    Relative(i32),
    /// Discontinuous, of this degree.
    Fixed(usize),
    /// Continuous piecewise linear.
    ContinuousLinear,
}

/// An element J of T_H.
#[derive(Debug, Clone, PartialEq)]
pub struct MultiplierElement {
    /// Edge of the polygon.
    pub edge: usize,
    /// Side to which the edge belongs.
    pub side: usize,
    /// Edge parameters of its ends, rising.
    pub span: [f64; 2],
    /// Degree q.
    pub degree: usize,
    /// Its nodes, q+1 of them, by rising edge parameter.
    pub nodes: Vec<usize>,
}

/// A node of the space.
#[derive(Debug, Clone, PartialEq)]
pub struct MultiplierNode {
    /// Edge of the polygon.
    pub edge: usize,
    /// Side to which the edge belongs.
    pub side: usize,
    /// Edge parameter.
    pub s: f64,
    /// The point.
    pub point: [f64; 2],
    /// Outward unit normal, and the normal turned by +90°.
    pub frame: [[f64; 2]; 2],
    /// ∫ of its basis function (length), positive.
    pub weight: f64,
    /// ∫ of its basis function times normal and tangent, on a curved edge: elsewhere they are the weight times the frame.
    pub resultant: Option<[[f64; 2]; 2]>,
}

/// A space of multipliers.
///
/// Source: Issaoui (2014), section 3.2.
#[derive(Debug, Clone, PartialEq)]
pub struct MultiplierSpace {
    /// T_H, edge by edge, edge parameters rising.
    pub elements: Vec<MultiplierElement>,
    /// The nodes, in the order of the elements.
    pub nodes: Vec<MultiplierNode>,
}

/// A part of an element of T_h that lies in one element of T_H.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MultiplierCell {
    /// Element of T_h.
    pub element: usize,
    /// Element of T_H.
    pub multiplier: usize,
    /// Reference coordinates in the element of T_h, rising.
    pub span: [f64; 2],
}

/// Ends closer than this part of an edge are one.
const SAME: f64 = 1e-12;
/// Rounding error of a frame.
const FRAME: f64 = 1e-9;

impl MultiplierSpace {
    /// The space on the given sides of a mesh.
    ///
    /// # Errors
    /// [`ContactError::Inconsistent`] for no elements, or parts or neighbours numbered 0.
    pub fn new(
        mesh: &Mesh,
        sides: &[usize],
        kind: MultiplierMesh,
        degree: MultiplierDegree,
    ) -> Result<Self, ContactError> {
        if matches!(kind, MultiplierMesh::Coarser(0) | MultiplierMesh::Finer(0)) {
            return Err(ContactError::Inconsistent { what: format!("a multiplier mesh {kind:?} has no elements") });
        }
        let mut edges: Vec<usize> =
            (0..mesh.len()).filter(|&e| sides.contains(&mesh.side[e])).map(|e| mesh.edge[e]).collect();
        edges.sort_unstable();
        edges.dedup();
        let mut space = Self { elements: Vec::new(), nodes: Vec::new() };
        for edge in edges {
            let mut own: Vec<usize> = (0..mesh.len()).filter(|&e| mesh.edge[e] == edge).collect();
            let start = |e: usize| mesh.span[e][0].min(mesh.span[e][1]);
            own.sort_by(|&a, &b| start(a).total_cmp(&start(b)));
            let breaks = kind.breaks(&own.iter().map(|&e| sorted(mesh.span[e])).collect::<Vec<_>>());
            let place = Place { mesh, own: &own };
            let first = space.nodes.len();
            for span in breaks.windows(2) {
                let span = [span[0], span[1]];
                let within = |e: &&usize| {
                    let [a, b] = sorted(mesh.span[**e]);
                    a < span[1] - SAME && b > span[0] + SAME
                };
                let largest = own.iter().filter(within).map(|&e| mesh.degree[e]).max().unwrap_or(1);
                match degree {
                    MultiplierDegree::ContinuousLinear => space.add_linear(&place, span, first),
                    MultiplierDegree::Fixed(q) => space.add(&place, span, q),
                    MultiplierDegree::Relative(d) => {
                        space.add(&place, span, (largest as i64 + i64::from(d)).max(0) as usize);
                    }
                }
            }
        }
        if space.elements.is_empty() {
            return Err(ContactError::Inconsistent { what: "no side is in contact: there are no multipliers".into() });
        }
        space.integrate_on_curves(mesh);
        Ok(space)
    }

    /// Whether elements and nodes fit together.
    ///
    /// # Errors
    /// [`ContactError::Inconsistent`] for an element without rising span or whose nodes are not its Lobatto points, or on another
    /// edge; a node of no element; a weight that is not positive; a frame that is not orthonormal and
    /// counter-clockwise; a number that is not finite.
    pub fn check(&self) -> Result<(), ContactError> {
        let wrong = |what: String| Err(ContactError::Inconsistent { what });
        let mut used = vec![false; self.nodes.len()];
        for (j, element) in self.elements.iter().enumerate() {
            let ([a, b], count) = (element.span, element.nodes.len());
            if !(a < b && a.is_finite() && b.is_finite()) {
                return wrong(format!("multiplier element {j} has the span [{a}, {b}]"));
            }
            if element.degree.checked_add(1) != Some(count) {
                return wrong(format!("multiplier element {j} of degree {} has {count} nodes", element.degree));
            }
            for (&k, t) in element.nodes.iter().zip(rule(element.degree).0) {
                let Some(node) = self.nodes.get(k) else {
                    return wrong(format!("multiplier element {j} has the node {k} of {}", self.nodes.len()));
                };
                let s = a + (b - a) / 2.0 * (1.0 + t);
                let there = (node.s - s).abs() <= SAME * (a.abs() + b.abs());
                if !there || (node.edge, node.side) != (element.edge, element.side) {
                    return wrong(format!(
                        "node {k} at {} on edge {} of side {} is not at {s} on edge {} of side {}, in multiplier element {j}",
                        node.s, node.edge, node.side, element.edge, element.side
                    ));
                }
                used[k] = true;
            }
        }
        for (k, node) in self.nodes.iter().enumerate() {
            let [n, t] = node.frame;
            let unit = n[0] * n[0] + n[1] * n[1] - 1.0;
            let turned = [t[0] + n[1], t[1] - n[0]];
            if ![unit, turned[0], turned[1]].iter().all(|v| v.abs() <= FRAME) {
                return wrong(format!("node {k} of the multipliers has the frame {n:?}, {t:?}"));
            }
            let finite = node.resultant.iter().flatten().flatten().chain(&node.point).all(|v| v.is_finite());
            if !(node.weight > 0.0 && node.weight.is_finite() && finite && used[k]) {
                return wrong(format!(
                    "node {k} of the multipliers at {:?} has the weight {} and the resultant {:?}, and is {}",
                    node.point,
                    node.weight,
                    node.resultant,
                    if used[k] { "of an element" } else { "of no element" }
                ));
            }
        }
        Ok(())
    }

    /// Weights and resultants of the nodes on curved edges.
    fn integrate_on_curves(&mut self, mesh: &Mesh) {
        let cells: Vec<MultiplierCell> =
            (0..mesh.len()).filter(|&e| !mesh.is_line(e)).flat_map(|e| self.cells_of(mesh, e)).collect();
        for cell in &cells {
            for &k in &self.elements[cell.multiplier].nodes {
                (self.nodes[k].weight, self.nodes[k].resultant) = (0.0, Some([[0.0; 2]; 2]));
            }
        }
        for MultiplierCell { element: e, multiplier, span } in cells {
            let points = self.elements[multiplier].degree / 2 + CURVE_POINTS;
            let rule = gauss_legendre(points).mapped(span[0], span[1]);
            for (&t, &w) in rule.points.iter().zip(&rule.weights) {
                let mu = self.basis(multiplier, mesh.edge_parameter(e, t));
                let (frame, speed) = (frame(mesh, e, t), mesh.speed(e, t));
                for (k, mu) in self.elements[multiplier].nodes.clone().into_iter().zip(mu) {
                    let node = &mut self.nodes[k];
                    node.weight += w * speed * mu;
                    for (sum, d) in node.resultant.iter_mut().flatten().zip(frame) {
                        (0..2).for_each(|i| sum[i] += w * speed * mu * d[i]);
                    }
                }
            }
        }
    }

    fn add(&mut self, place: &Place<'_>, span: [f64; 2], degree: usize) {
        let (points, weights) = rule(degree);
        let half = (span[1] - span[0]) / 2.0;
        let first = self.nodes.len();
        for (&t, &w) in points.iter().zip(&weights) {
            let s = if t == 1.0 { span[1] } else { span[0] + half * (1.0 + t) };
            self.nodes.push(place.node(s, w * half * place.length()));
        }
        self.push(place, span, degree, (first..self.nodes.len()).collect());
    }

    /// `first`: the first node of the edge.
    fn add_linear(&mut self, place: &Place<'_>, span: [f64; 2], first: usize) {
        let weight = (span[1] - span[0]) / 2.0 * place.length();
        if self.nodes.len() == first {
            self.nodes.push(place.node(span[0], 0.0));
        }
        let last = self.nodes.len();
        self.nodes[last - 1].weight += weight;
        self.nodes.push(place.node(span[1], weight));
        self.push(place, span, 1, vec![last - 1, last]);
    }

    fn push(&mut self, place: &Place<'_>, span: [f64; 2], degree: usize, nodes: Vec<usize>) {
        let (edge, side) = (place.mesh.edge[place.own[0]], place.mesh.side[place.own[0]]);
        self.elements.push(MultiplierElement { edge, side, span, degree, nodes });
    }

    /// The parts in which both meshes are smooth, by rising element of T_h and along it.
    pub fn cells(&self, mesh: &Mesh) -> Vec<MultiplierCell> {
        (0..mesh.len()).flat_map(|element| self.cells_of(mesh, element)).collect()
    }

    /// The parts of one element of T_h, along it.
    pub fn cells_of(&self, mesh: &Mesh, element: usize) -> Vec<MultiplierCell> {
        let [s0, s1] = mesh.span[element];
        let t = |s: f64| (2.0 * (s - s0) / (s1 - s0) - 1.0).clamp(-1.0, 1.0);
        let mut own: Vec<MultiplierCell> = Vec::new();
        for (multiplier, m) in self.elements.iter().enumerate().filter(|(_, m)| m.edge == mesh.edge[element]) {
            let span = sorted([t(m.span[0]), t(m.span[1])]);
            if span[1] - span[0] > 1e-9 {
                own.push(MultiplierCell { element, multiplier, span });
            }
        }
        own.sort_by(|a, b| a.span[0].total_cmp(&b.span[0]));
        own
    }

    /// Values of the basis functions of element `multiplier` at the edge parameter s, in the order of its nodes.
    pub fn basis(&self, multiplier: usize, s: f64) -> Vec<f64> {
        let element = &self.elements[multiplier];
        let [a, b] = element.span;
        let t = 2.0 * (s - a) / (b - a) - 1.0;
        match element.degree {
            0 => vec![1.0],
            q => {
                let mut values = vec![0.0; q + 1];
                LobattoBasis::new(q).evaluate(t, &mut values);
                values
            }
        }
    }

    /// `[λ_n, λ_t]` at the edge parameter s in element `multiplier`, of the values at all nodes.
    pub fn value(&self, multiplier: usize, s: f64, multipliers: &[[f64; 2]]) -> [f64; 2] {
        let basis = self.basis(multiplier, s);
        self.elements[multiplier]
            .nodes
            .iter()
            .zip(&basis)
            .fold([0.0; 2], |v, (&k, b)| [v[0] + b * multipliers[k][0], v[1] + b * multipliers[k][1]])
    }

    /// Force of the obstacle on the body over one side, -∫ (λ_n n + λ_t t) ds (force per thickness).
    pub fn force(&self, side: usize, multipliers: &[[f64; 2]]) -> [f64; 2] {
        let mut force = [0.0; 2];
        for (node, [pressure, shear]) in self.nodes.iter().zip(multipliers).filter(|(n, _)| n.side == side) {
            if let Some([n, t]) = node.resultant {
                (0..2).for_each(|i| force[i] -= pressure * n[i] + shear * t[i]);
                continue;
            }
            let [n, t] = node.frame;
            (0..2).for_each(|i| force[i] -= node.weight * (pressure * n[i] + shear * t[i]));
        }
        force
    }
}

impl MultiplierMesh {
    /// Ends of the elements of T_H on an edge, from the spans of those of T_h, rising.
    fn breaks(self, spans: &[[f64; 2]]) -> Vec<f64> {
        let (first, last) = (spans[0][0], spans[spans.len() - 1][1]);
        let mut breaks = vec![first];
        match self {
            Self::Same => breaks.extend(spans[1..].iter().map(|s| s[0])),
            Self::Coarser(k) => breaks.extend(spans.iter().skip(k).step_by(k).map(|s| s[0])),
            Self::Finer(k) => {
                let part = |s: &[f64; 2], i: usize| s[0] + (s[1] - s[0]) * i as f64 / k as f64;
                breaks.extend(spans.iter().flat_map(|s| (0..k).map(move |i| part(s, i))).skip(1));
            }
            Self::Shifted => breaks.extend(spans.iter().map(|s| (s[0] + s[1]) / 2.0)),
        }
        breaks.push(last);
        breaks
    }
}

/// An edge of the contact boundary.
struct Place<'a> {
    mesh: &'a Mesh,
    /// Its elements of T_h by rising edge parameter.
    own: &'a [usize],
}

impl Place<'_> {
    /// Length for a unit of the edge parameter.
    fn length(&self) -> f64 {
        let e = self.own[0];
        self.mesh.length(e) / (self.mesh.span[e][1] - self.mesh.span[e][0]).abs()
    }

    fn node(&self, s: f64, weight: f64) -> MultiplierNode {
        let mesh = self.mesh;
        let contains = |e: &&usize| sorted(mesh.span[**e])[1] >= s;
        let e = *self.own.iter().find(contains).unwrap_or(&self.own[self.own.len() - 1]);
        let [s0, s1] = mesh.span[e];
        let t = (2.0 * (s - s0) / (s1 - s0) - 1.0).clamp(-1.0, 1.0);
        let frame = [mesh.normal(e, t), mesh.tangent(e, t)];
        let point = mesh.point(e, t);
        MultiplierNode { edge: mesh.edge[e], side: mesh.side[e], s, point, frame, weight, resultant: None }
    }
}

/// Nodes and weights of degree q on [-1, 1].
fn rule(degree: usize) -> (Vec<f64>, Vec<f64>) {
    if degree == 0 {
        return (vec![0.0], vec![2.0]);
    }
    let basis = LobattoBasis::new(degree);
    (basis.nodes, basis.weights)
}

fn sorted([a, b]: [f64; 2]) -> [f64; 2] {
    [a.min(b), a.max(b)]
}

/// Outward normal and tangent at a point of an element.
pub(crate) fn frame(mesh: &Mesh, e: usize, t: f64) -> [[f64; 2]; 2] {
    [mesh.normal(e, t), mesh.tangent(e, t)]
}

/// More Gauss points where normal and |γ'| change along an element.
pub(crate) const CURVE_POINTS: usize = 14;
