//! The first-order gain of J from the part of the data that the nodes of a mesh miss.
//!
//! ```text
//! held displacements    ∫ t·w,  w = u_D - I_p u_D              t: traction of the solution
//! contact               ∫ t·w,  w = I_p u_p - u_p              u_p: particular solution, with which nodes are in contact
//! closed on obstacles   -∫ t·w,  w = (u_n - g) n, and u_t t     u: interpolant of the displacement; u_t where the side sticks
//! Tresca's bounds       ∫ F r u_t - Σ D_i F_i |u_t,i|          λ_t = F r, |r| ≤ 1
//! ```
//! J is the minimum over u of the maximum over r of ½⟨S u, u⟩ - l(u) + ∫ F r u_t, so that its derivative by data is that of
//! this form at the saddle point. The rest is of second order: for held displacements from 0 to ½⟨S w, w⟩, as J is convex in
//! them, and the error of t against w. Loads need nothing: their integrals against displacements are exact.

use steklov_bem_operators::{Datum, Site, side_moments};
use steklov_contact::{ContactBubble, LinePoint, Solution};
use steklov_elastic::plane::dot;
use steklov_expression::Expression;
use steklov_problem::Condition;
use steklov_quadrature::gauss_legendre;

use crate::data::on_mesh::OnMesh;
use crate::error::SolveError;
use crate::estimate::nonconformity::POINTS;
use crate::solve::body::Factors;
use crate::solve::contact::{ContactFactors, ContactResult};
use crate::solve::solution::Solved;

impl OnMesh<'_> {
    /// ∫ t·w over the held sides, without the particular solution in w, over those that touch obstacles, where w is that of
    /// the particular solution alone, and over elements that are closed there, `bubbles` being those of the contact elements
    /// (energy: force/thickness times length).
    pub(crate) fn held_work(
        &self,
        solved: &Solved,
        factors: &Factors,
        bubbles: &[ContactBubble],
    ) -> Result<f64, SolveError> {
        let (mut work, none) = (self.closed_work(solved, &factors.homogeneous, bubbles), Expression::number(0.0));
        for (side, condition) in self.scene.problem.sides.iter().enumerate() {
            let touches = self.scene.contact(side).is_some() && self.scene.problem.joint(side).is_none();
            let values = match &condition.condition {
                Condition::Displacement { values, .. } => values.each_ref().map(Option::as_ref),
                _ if touches => [Some(&none); 2],
                _ => continue,
            };
            let body = self.particular_of_side(&solved.particular, side);
            for (i, expression) in values.into_iter().enumerate() {
                let Some(expression) = expression.filter(|e| e.constant().is_none() || body.is_some()) else {
                    continue;
                };
                let mut direction = [0.0; 2];
                direction[i] = 1.0;
                let function = self.less_particular(expression, body, |_| direction);
                let traction = |e: usize, t: f64| self.working_traction(solved, (e, t))[i];
                work += self.work_on_rest(side, Some(expression), &function.datum("displacement"), &traction)?;
            }
        }
        Ok(work)
    }

    /// -∫ t·w over the elements that are closed on obstacles (energy), of nodal displacements without the particular solution.
    fn closed_work(&self, solved: &Solved, displacement: &[f64], bubbles: &[ContactBubble]) -> f64 {
        let (mesh, rule) = (self.mesh, gauss_legendre(POINTS));
        let of_element = |(e, sticks): (usize, bool)| {
            let basis = self.space.basis(e);
            let mut phi = vec![0.0; basis.degree + 1];
            let nodal: Vec<[f64; 2]> = self
                .space
                .element_nodes(e)
                .map(|node| {
                    let of_body = solved.particular.of(e).map_or([0.0; 2], |b| b.displacement(self.space.points[node]));
                    [0, 1].map(|i| displacement[2 * node + i] + of_body[i])
                })
                .collect();
            let at = |(&t, weight): (&f64, &f64)| {
                basis.evaluate(t, &mut phi);
                let u = [0, 1].map(|i| phi.iter().zip(&nodal).map(|(phi, u)| phi * u[i]).sum());
                let left = self.off_obstacle(u, sticks, (e, t));
                weight * mesh.speed(e, t) * dot(self.working_traction(solved, (e, t)), left)
            };
            rule.points.iter().zip(&rule.weights).map(at).sum::<f64>()
        };
        -self.closed_on_obstacles(bubbles).into_iter().map(of_element).sum::<f64>()
    }

    /// The traction whose work is in the energies: of an unbounded body that of the field without the particular solution.
    fn working_traction(&self, solved: &Solved, (e, t): (usize, f64)) -> [f64; 2] {
        let is_bounded = self.scene.problem.bodies[self.scene.problem.body_of_side(self.mesh.side[e])].far.is_none();
        if is_bounded { solved.elastic_field().traction(e, t) } else { solved.field.trace(e, t).traction }
    }

    /// ∫ I_pφ (f - I_p f) over a side, φ(e, t) a function on element e.
    pub(crate) fn work_on_rest(
        &self,
        side: usize,
        expression: Option<&Expression>,
        f: &Datum<'_>,
        phi: &dyn Fn(usize, f64) -> f64,
    ) -> Result<f64, SolveError> {
        let (mesh, space) = (self.mesh, self.space);
        let mut work = 0.0;
        for (e, moments) in side_moments(mesh, space, side, f)
            .map_err(|error| expression.map_or(error.clone().into(), |expression| self.located(error, expression)))?
        {
            let basis = space.basis(e);
            let (mut nodal, mut weights) = (Vec::new(), Vec::new());
            for (&t, moment) in basis.nodes.iter().zip(moments) {
                nodal.push(f.at(mesh, &Site::new(mesh, e, t))?);
                weights.push(phi(e, t));
                work += phi(e, t) * moment;
            }
            let more = if mesh.is_line(e) { 1 } else { 12 };
            let rule = gauss_legendre(basis.degree + more);
            let mut values = vec![0.0; basis.degree + 1];
            for (&t, weight) in rule.points.iter().zip(&rule.weights) {
                basis.evaluate(t, &mut values);
                let interpolant = |nodal: &[f64]| values.iter().zip(nodal).map(|(v, f)| v * f).sum::<f64>();
                // the moments are those of the interpolant of φ
                work -= mesh.speed(e, t) * weight * interpolant(&weights) * interpolant(&nodal);
            }
        }
        Ok(work)
    }

    /// ∫ F r u_t - Σ D_i F_i |u_t,i| over the sides with Tresca's bounds (energy), of biorthogonal multipliers.
    pub(crate) fn friction_work_left(&self, solved: &Solved, factors: &Factors) -> Result<f64, SolveError> {
        let (Some(result), Some(part)) = (&solved.contact, &factors.contact) else { return Ok(0.0) };
        let mut work = 0.0;
        let mut slips = None;
        for (side, contact) in self.scene.contacts() {
            let Some(bound) = contact.friction.bound().filter(|b| b.constant() != Some(0.0)) else { continue };
            let slips = slips.get_or_insert_with(|| self.slips(solved, factors, result, part));
            let function = self.function(bound);
            let of_bound = function.datum("friction bound");
            let value = |site: &Site| (of_bound.value)(site) * self.turned_slip(&slips[site.element], site);
            let datum = Datum { name: "friction bound", value: &value, kinks: of_bound.kinks, rounding: None };
            let moments =
                side_moments(self.mesh, self.space, side, &datum).map_err(|error| self.located(error, bound))?;
            work += moments.iter().flat_map(|(_, m)| m).sum::<f64>();
        }
        let Solution { displacement, multipliers, .. } = &result.solution;
        Ok(if slips.is_some() { work - part.problem.friction_work(displacement, multipliers) } else { 0.0 })
    }

    /// u_t and r at the nodes of every element: r is ±1 where a node slips, the part λ_t/F of its bound where it sticks.
    fn slips(
        &self,
        solved: &Solved,
        factors: &Factors,
        contact: &ContactResult,
        part: &ContactFactors,
    ) -> Vec<Vec<[f64; 2]>> {
        let (mesh, space) = (self.mesh, self.space);
        let mut slips = vec![Vec::new(); mesh.len()];
        let relative = contact.boundary.relative(&factors.homogeneous);
        for element in contact.boundary.elements(mesh, space) {
            let e = element.element;
            let slip = |((node, at), &place): ((usize, &Option<LinePoint>), &f64)| {
                let [x, y] = self.direction(e, place);
                let t = [-y, x];
                let own = solved.particular.of(e).map_or([0.0; 2], |b| b.displacement(space.points[node]));
                let u: f64 = (0..2).map(|i| (relative[2 * node + i] + own[i]) * t[i]).sum();
                let turned = match at.map(|at| (at, part.sets.slip(at.index))) {
                    Some((at, Some(0))) => {
                        let bound = part.problem.nodes[at.node].conditions[at.condition].bound;
                        (contact.solution.multipliers[at.index][1] / bound).clamp(-1.0, 1.0)
                    }
                    Some((_, Some(slip))) => f64::from(slip),
                    _ if u == 0.0 => 0.0,
                    _ => u.signum(),
                };
                [u, turned]
            };
            slips[e] = space.element_nodes(e).zip(&element.points).zip(&space.basis(e).nodes).map(slip).collect();
        }
        slips
    }

    /// r u_t at a point of an element: u_t of its polynomial, r linear between the nodes.
    fn turned_slip(&self, nodal: &[[f64; 2]], site: &Site) -> f64 {
        // a part of the side that faces nothing
        if nodal.is_empty() {
            return 0.0;
        }
        let basis = self.space.basis(site.element);
        let mut phi = vec![0.0; basis.degree + 1];
        basis.evaluate(site.t, &mut phi);
        let slip: f64 = nodal.iter().zip(&phi).map(|([u, _], phi)| u * phi).sum();
        let k = basis.nodes.partition_point(|t| *t < site.t).clamp(1, basis.degree);
        let (a, b) = (basis.nodes[k - 1], basis.nodes[k]);
        let part = (site.t - a) / (b - a);
        slip * (nodal[k - 1][1] * (1.0 - part) + nodal[k][1] * part)
    }
}
