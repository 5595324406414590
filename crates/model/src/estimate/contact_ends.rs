//! Where contact ends, by extraction: the amplitudes of the opening at a vertex are integrals over the whole boundary.
//!
//! ```text
//! opening g - u_n = A d^(1/2) + B d^(3/2) + …,     end = vertex - A/(1.5 B) towards the open side
//! A = w/c ∮ ((t - t_p)·u* - t*·(u - u_p)) ds       (u*, t*) of exponent -1/2, w the opening of that of 1/2, c the norm of both; B alike
//! u_p = (g' y + g'' x y, -(g + g' x + g'' (x² + αy²)/2)),  α = λ/(λ+2μ): a rigid motion, and a field without traction on y = 0
//! ```
//! Along the zone u_y is the gap: t* meets what is left of it beyond x². On the open side t* and the traction are zero. The nodes beside a
//! vertex tell its place to 2e-5 of the zone, this tells it with the double rate of all integrals.
//!
//! Tresca's friction adds ∫ t_x u*_x over the whole line, where contact is open too, and a logarithm that spoils B: that is then the one of
//! the fit of nodes.
//!
//! *Use when* a side touches an obstacle along a line, and its nodes are closed up to the vertex. *Fails when* a body force acts, under
//! Coulomb's law, whose exponents are others, or where the body goes on behind the line.
//!
//! Source: Bueckner (1970), weight functions.

use steklov_bem_operators::{Edge, SAME_PLACE, Site};
use steklov_contact::{ContactLine, LinePoint, Tip, TipFit, TipKind, TipVertex, tip_fits};
use steklov_elastic::plane::{distance, dot, minus, turned, unit};
use steklov_elastic::{TipField, TipFrame};
use steklov_expression::Expression;
use steklov_problem::Condition;
use steklov_quadrature::gauss_legendre;

use crate::answer::data_jumps::kinks;
use crate::contact_length::is_extractable;
use crate::data::on_mesh::{Function, OnMesh};
use crate::named::elements_at;
use crate::solve::contact::ContactFactors;
use crate::solve::fields::ElasticField;

/// An end of contact that was extracted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactEnd {
    /// Edge of the outline.
    pub edge: usize,
    /// Edge parameter of the vertex.
    pub s: f64,
    /// 1 if the open side has the larger edge parameter, -1 if the smaller one.
    pub regular: i8,
    /// How far the end is from that, of the solution.
    pub of_solution: TipFit,
    /// The same of that of the enriched spaces.
    pub enriched: TipFit,
}

/// Exponents of the opening.
const EXPONENTS: [f64; 2] = [0.5, 1.5];
/// Points of Gauss's rule on a panel, beyond the degree of its element.
const POINTS: usize = 12;
/// A panel is as long as this part of its distance from the tip at most.
const PANEL: f64 = 1.0;
/// Halvings of an element at most.
const HALVINGS: usize = 40;
/// Step of differences of the gap, over the distance to its next kink or the end of its edge.
const STEP: f64 = 1e-3;
/// The same of its higher derivatives, and the distance up to which its rest is that of its Taylor polynomial.
const NEAR: f64 = 1e-2;
/// Shift over the distance to the next end of the edge beyond which the vertex is not at the end yet.
const FARTHEST: f64 = 0.1;
/// The same where B is that of the nodes, which is not known before they are near the end.
const FARTHEST_WITH_FRICTION: f64 = 0.01;

/// The tip of a zone with what its integrals need.
struct Extraction<'a> {
    data: &'a OnMesh<'a>,
    tip: Tip,
    edge: &'a Edge,
    frame: TipFrame,
    gap: Function<'a>,
    /// The gap at the tip and four derivatives along x.
    taylor: [f64; 5],
    /// Distance to the next kink of the gap or end of the edge.
    smooth: f64,
    /// Elements of the edge all of whose nodes are closed.
    closed: Vec<usize>,
    /// The bound of Tresca's law.
    bound: Option<&'a Expression>,
    /// Elements of the edge that slip along the whole of them, and the direction of the traction on them along the tangent.
    slipping: Vec<(usize, f64)>,
    /// The fields of exponents -1/2 and -3/2, and w/c.
    duals: [(TipField, f64); 2],
    /// Elements of the body.
    elements: Vec<usize>,
}

impl OnMesh<'_> {
    /// The ends of contact at the tips of a mesh that can be extracted.
    pub(crate) fn contact_ends(
        &self,
        tips: &[Tip],
        part: &ContactFactors,
        fields: [&ElasticField<'_>; 2],
    ) -> Vec<ContactEnd> {
        let of = |tip: &Tip| {
            let extraction = Extraction::new(self, *tip, part)?;
            let curvature = match extraction.bound {
                Some(_) => Some(extraction.curvature_of_nodes(tips, part)?),
                None => None,
            };
            let [of_solution, enriched] = fields.map(|field| extraction.fit(field, curvature));
            let (edge, s, regular) = (tip.edge, tip.s, tip.regular);
            Some(ContactEnd { edge, s, regular, of_solution: of_solution?, enriched: enriched? })
        };
        tips.iter().filter(|tip| tip.kind == TipKind::ContactEnd).filter_map(of).collect()
    }
}

impl<'a> Extraction<'a> {
    fn new(data: &'a OnMesh<'a>, tip: Tip, part: &ContactFactors) -> Option<Self> {
        let problem = &data.scene.problem;
        let edge = &problem.outline.edges()[tip.edge];
        let contact = problem.contact(edge.side)?;
        if !is_extractable(data.scene, edge) {
            return None;
        }
        let body = problem.outline.body_of_loop(edge.loop_index);
        let frame = TipFrame {
            origin: edge.point(tip.s),
            along: unit(minus(edge.point(1.0), edge.point(0.0))).map(|c| -f64::from(tip.regular) * c),
            inward: edge.normal(tip.s).map(|n| -n),
        };
        let body_of = |e: usize| problem.outline.body_of_loop(problem.outline.edges()[data.mesh.edge[e]].loop_index);
        let elements: Vec<usize> = (0..data.mesh.len()).filter(|&e| body_of(e) == body).collect();
        let material = data.material_of(*elements.first()?);
        let duals = EXPONENTS.map(|exponent| {
            let own = TipField::new(&material, exponent);
            (TipField::new(&material, -exponent), own.opening() / own.norm())
        });
        let gap = data.gap(edge.side, &contact.gap);
        let bound = contact.friction.bound();
        let (smooth, taylor, closed, slipping) = (0.0, [0.0; 5], Vec::new(), Vec::new());
        let mut all = Self { data, tip, edge, frame, gap, smooth, taylor, closed, bound, slipping, duals, elements };
        all.closed = all.closed_elements(part)?;
        all.slipping = all.slipping_elements(part);
        if all.goes_on_behind() {
            return None;
        }
        all.smooth = all.distance_to_kink();
        all.taylor = all.derivatives();
        Some(all)
    }

    /// The points of the line within an element.
    fn points_of<'l>(&self, line: &'l ContactLine, e: usize) -> impl Iterator<Item = &'l LinePoint> {
        let [a, b] = self.data.mesh.span[e];
        line.points.iter().filter(move |p| a.min(b) - SAME_PLACE <= p.s && p.s <= a.max(b) + SAME_PLACE)
    }

    /// The elements of the edge that are closed; none if the nodes beside the vertex are not closed up to it.
    fn closed_elements(&self, part: &ContactFactors) -> Option<Vec<usize>> {
        let line = part.lines.iter().find(|line| line.edge == self.tip.edge)?;
        let own = self.elements.iter().copied().filter(|&e| self.data.mesh.edge[e] == self.tip.edge);
        let mut closed = Vec::new();
        for e in own {
            let states: Vec<(f64, bool)> = self.points_of(line, e).map(|p| (p.s, part.sets.closed(p.index))).collect();
            if states.is_empty() {
                return None;
            }
            let at_tip = |s: f64| (s - self.tip.s).abs() <= SAME_PLACE;
            // the node at the vertex may be either
            let is_closed = states.iter().all(|&(s, closed)| closed || at_tip(s));
            let [a, b] = self.data.mesh.span[e];
            if at_tip(a) || at_tip(b) {
                let is_open_side = ((a + b) / 2.0 - self.tip.s) * f64::from(self.tip.regular) > 0.0;
                let is_open = states.iter().all(|&(s, closed)| !closed || at_tip(s));
                if if is_open_side { !is_open } else { !is_closed } {
                    return None;
                }
            }
            closed.extend(is_closed.then_some(e));
        }
        Some(closed)
    }

    /// The elements of the edge that slip to one side, with -1 for a slip along the tangent and 1 for one against it.
    fn slipping_elements(&self, part: &ContactFactors) -> Vec<(usize, f64)> {
        let Some(line) = part.lines.iter().find(|line| line.edge == self.tip.edge) else { return Vec::new() };
        let of = |&e: &usize| {
            let slips: Vec<Option<i8>> = self.points_of(line, e).map(|p| part.sets.slip(p.index)).collect();
            let first = (*slips.first()?).filter(|slip| *slip != 0)?;
            slips.iter().all(|slip| *slip == Some(first)).then(|| (e, -f64::from(first)))
        };
        self.elements.iter().filter(|&&e| self.data.mesh.edge[e] == self.tip.edge).filter_map(of).collect()
    }

    /// B of the fit of the nodes on the open side.
    fn curvature_of_nodes(&self, tips: &[Tip], part: &ContactFactors) -> Option<f64> {
        let Tip { edge, s, kind, regular } = self.tip;
        let line = part.lines.iter().find(|line| line.edge == edge)?;
        let others = tips.iter().filter(|tip| tip.edge == edge && tip.s != s).map(|tip| tip.s);
        let singular = others.chain(kinks(self.data.scene, self.edge)).chain([0.0, 1.0]).collect();
        let vertex = TipVertex { line, kind, regular, s, singular, among_valleys: false };
        let fits = tip_fits(&[vertex], &part.problem, &part.sets).ok()?;
        fits.first().copied().flatten().map(|fit| fit.curvature)
    }

    /// Whether the boundary crosses the half line out of the body at the tip: the fields jump there.
    fn goes_on_behind(&self) -> bool {
        let crosses = |&e: &usize| {
            let [[x0, y0], [x1, y1]] = self.data.mesh.ends(e).map(|x| self.frame.coordinates(x));
            let small = SAME_PLACE * self.edge.length();
            x0.min(x1) <= small && x0.max(x1) >= -small && y0.min(y1) < -small
        };
        self.elements.iter().any(crosses)
    }

    /// The gap at the coordinate x.
    fn gap_at(&self, x: f64) -> f64 {
        let s = self.tip.s - f64::from(self.tip.regular) * x / self.edge.length();
        let Some(&(e, t)) = elements_at(self.data.mesh, self.tip.edge, s).first() else { return f64::NAN };
        (self.gap.value)(&Site { element: e, t, s, point: self.edge.point(s) })
    }

    /// Distance to the next kink of the gap or end of the edge.
    fn distance_to_kink(&self) -> f64 {
        let turns = kinks(self.data.scene, self.edge).into_iter().chain([0.0, 1.0]);
        let apart = turns.map(|s| (s - self.tip.s).abs()).filter(|d| *d > SAME_PLACE);
        self.edge.length() * apart.fold(f64::INFINITY, f64::min)
    }

    /// g and its derivatives at the tip by differences of five points. What g' and g'' are off by leaves the integrals exact.
    fn derivatives(&self) -> [f64; 5] {
        let around = |h: f64| [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| self.gap_at(k * h));
        let h = STEP * self.smooth;
        let [a, b, c, d, e] = around(h);
        let slope = (a - 8.0 * b + 8.0 * d - e) / (12.0 * h);
        let second = (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / (12.0 * h * h);
        let h = NEAR * self.smooth;
        let [a, b, c, d, e] = around(h);
        let third = (e - 2.0 * d + 2.0 * b - a) / (2.0 * h.powi(3));
        [c, slope, second, third, (a - 4.0 * b + 6.0 * c - 4.0 * d + e) / h.powi(4)]
    }

    /// What is left of the gap beyond x²; near the tip, where it is rounding, by its Taylor polynomial.
    fn rest(&self, x: f64) -> f64 {
        let [g, slope, second, third, fourth] = self.taylor;
        if x < NEAR * self.smooth {
            return x.powi(3) * (third / 6.0 + x * fourth / 24.0);
        }
        self.gap_at(x) - (g + slope * x + second * x * x / 2.0)
    }

    /// The shift of the end, and B, by a known B (edge parameter) or by its own.
    fn fit(&self, field: &ElasticField<'_>, curvature: Option<f64>) -> Option<TipFit> {
        let mut sums = [0.0; 2];
        for &e in &self.elements {
            self.add_element(field, e, &mut sums);
        }
        let [a, b] = [0, 1].map(|k| self.duals[k].1 * sums[k]);
        // d is an edge parameter there
        let length = self.edge.length();
        let b = curvature.map_or(b, |curvature| curvature / length.powf(1.5));
        let shift = -a / (1.5 * b) / length;
        let farthest = if curvature.is_some() { FARTHEST_WITH_FRICTION } else { FARTHEST };
        let near = shift.abs() * length < farthest * self.smooth;
        (b > 0.0 && near)
            .then(|| TipFit { shift: shift * f64::from(self.tip.regular), curvature: b * length.powf(1.5) })
    }

    /// Adds the integrals over an element.
    fn add_element(&self, field: &ElasticField<'_>, e: usize, sums: &mut [f64; 2]) {
        let (mesh, tip) = (self.data.mesh, self.tip);
        let rule = gauss_legendre(self.data.space.degree(e) + POINTS);
        let on_line = mesh.edge[e] == tip.edge;
        if on_line && mesh.span[e].iter().any(|s| (s - tip.s).abs() <= SAME_PLACE) {
            let starts = (mesh.span[e][0] - tip.s).abs() <= SAME_PLACE;
            for (q, w) in rule.points.iter().zip(&rule.weights) {
                let (tau, length) = ((1.0 + q) / 2.0, mesh.length(e));
                let (x, ds) = (tau.powi(3) * length, 3.0 * tau * tau * w / 2.0 * length);
                if self.closed.contains(&e) {
                    self.add_gap(x, ds, sums);
                }
                if self.bound.is_some() {
                    let t = if starts { 2.0 * tau.powi(3) - 1.0 } else { 1.0 - 2.0 * tau.powi(3) };
                    let x = if self.closed.contains(&e) { x } else { -x };
                    self.add_shear(x, ds * self.shear(field, e, t), sums);
                }
            }
            return;
        }
        let mut panels = vec![([-1.0, 1.0], 0)];
        while let Some(([t0, t1], level)) = panels.pop() {
            let ends = [t0, (t0 + t1) / 2.0, t1].map(|t| self.frame.coordinates(mesh.point(e, t)));
            let nearest = ends.iter().map(|[x, y]| x.hypot(*y)).fold(f64::INFINITY, f64::min);
            if level < HALVINGS && distance(ends[0], ends[2]) > PANEL * nearest {
                let middle = (t0 + t1) / 2.0;
                panels.extend([([t0, middle], level + 1), ([middle, t1], level + 1)]);
                continue;
            }
            for (q, w) in rule.points.iter().zip(&rule.weights) {
                let t = t0 + (t1 - t0) * (1.0 + q) / 2.0;
                let ds = w * (t1 - t0) / 2.0 * mesh.speed(e, t);
                let [x, _] = self.frame.coordinates(mesh.point(e, t));
                if on_line && self.closed.contains(&e) && x > 0.0 {
                    self.add_gap(x, ds, sums);
                    if self.bound.is_some() {
                        self.add_shear(x, ds * self.shear(field, e, t), sums);
                    }
                } else {
                    self.add_point(field, (e, t), ds, sums);
                }
            }
        }
    }

    /// Adds -t*·(u - u_p) ds at a closed point of the zone, where u_y = -g.
    fn add_gap(&self, x: f64, ds: f64, sums: &mut [f64; 2]) {
        let rest = self.rest(x);
        for (sum, (dual, _)) in sums.iter_mut().zip(&self.duals) {
            let (_, [_, normal, _]) = dual.at([x, 0.0]);
            // the traction on y = 0 is -σ_yy along y, and u_y - u_p,y is -rest
            *sum -= ds * normal * rest;
        }
    }

    /// Adds t_x u*_x ds on the line.
    fn add_shear(&self, x: f64, shear: f64, sums: &mut [f64; 2]) {
        for (sum, (dual, _)) in sums.iter_mut().zip(&self.duals) {
            *sum += shear * dual.at([x, 0.0]).0[0];
        }
    }

    /// The traction of friction along x: the bound where all of an element slips.
    fn shear(&self, field: &ElasticField<'_>, e: usize, t: f64) -> f64 {
        let tangent = turned(self.data.mesh.normal(e, t));
        let along = match (self.bound, self.slipping.iter().find(|(own, _)| *own == e)) {
            (None, _) => 0.0,
            (Some(bound), Some((_, sign))) => sign * self.data.value(bound, &Site::new(self.data.mesh, e, t)),
            (Some(_), None) => dot(field.traction(e, t), tangent),
        };
        along * dot(tangent, self.frame.along)
    }

    /// Adds ((t - t_p)·u* - t*·(u - u_p)) ds at a point of the boundary.
    fn add_point(&self, field: &ElasticField<'_>, (e, t): (usize, f64), ds: f64, sums: &mut [f64; 2]) {
        let frame = &self.frame;
        let (u, traction) = self.state(field, e, t);
        let (x, n) = (frame.coordinates(self.data.mesh.point(e, t)), frame.components(self.data.mesh.normal(e, t)));
        let (of_gap, stress) = self.of_gap(x, e);
        let on = |[xx, yy, xy]: [f64; 3]| [xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]];
        let (u, traction) = (frame.components(u), frame.components(traction));
        let u = [u[0] - of_gap[0], u[1] - of_gap[1]];
        let traction = [0, 1].map(|i| traction[i] - on(stress)[i]);
        for (sum, (dual, _)) in sums.iter_mut().zip(&self.duals) {
            let (v, sigma) = dual.at(x);
            *sum += ds * (dot(traction, v) - dot(on(sigma), u));
        }
    }

    /// u_p and its stress.
    fn of_gap(&self, [x, y]: [f64; 2], e: usize) -> ([f64; 2], [f64; 3]) {
        let material = self.data.material_of(e);
        let (lambda, mu) = (material.lambda(), material.mu());
        let alpha = lambda / (lambda + 2.0 * mu);
        let [g, slope, curvature, ..] = self.taylor;
        let u = [slope * y + curvature * x * y, -(g + slope * x + curvature * (x * x + alpha * y * y) / 2.0)];
        (u, [(lambda * (1.0 - alpha) + 2.0 * mu) * curvature * y, 0.0, 0.0])
    }

    /// Displacement and traction at a point of the boundary, those that the scene gives as they are given.
    fn state(&self, field: &ElasticField<'_>, e: usize, t: f64) -> ([f64; 2], [f64; 2]) {
        let data = self.data;
        let (mut u, mut traction) = (field.on_boundary(e, t).0, field.traction(e, t));
        let given = data.given_traction(e, t, u);
        (0..2).for_each(|i| traction[i] = given[i].unwrap_or(traction[i]));
        if let Condition::Displacement { values, .. } = &data.scene.problem.sides[data.mesh.side[e]].condition {
            let site = Site::new(data.mesh, e, t);
            for (u, value) in u.iter_mut().zip(values) {
                *u = value.as_ref().map_or(*u, |value| data.value(value, &site));
            }
        }
        // apart, the line has the traction of friction alone
        if data.mesh.edge[e] == self.tip.edge && !self.closed.contains(&e) {
            traction = self.frame.along.map(|c| c * self.shear(field, e, t));
        }
        (u, traction)
    }
}
