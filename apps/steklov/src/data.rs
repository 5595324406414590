//! The scene's data on a mesh: prescribed displacements, loads, gaps and friction bounds.

use std::ops::Range;

use steklov_bem_operators::{
    BemError, BoundaryField, Datum, Location, Look, Mesh, ParticularSolution, Site, Space, add_load,
    boundary_residuals_of, side_moments, side_moments_and_squares,
};
use steklov_contact::{
    ContactBoundary, ContactBubble, ContactSolution, Multiplier, Sets, SideData, contact_boundary, contact_bubbles,
    contact_residuals_of, oscillation,
};
use steklov_quadrature::{LobattoBasis, legendre_p};

use crate::estimate::Residual;
use crate::expression::{Expression, Piece};
use crate::scene::{Condition, Friction, Scene, SceneErrorKind};
use crate::solve::{SolveError, Solved};
use crate::supports::Held;

/// A scene on a mesh.
pub(crate) struct Data<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) mesh: &'a Mesh,
    pub(crate) space: &'a Space,
}

/// Integrals of the tractions and pressures.
#[derive(Debug, Clone)]
pub(crate) struct Loads {
    /// ∫ t·φ of the nodal functions, interleaved.
    pub(crate) nodal: Vec<f64>,
    /// ∫ t·b of the bubbles, two for each element.
    pub(crate) bubbles: Vec<f64>,
    /// h/(p+2) ‖t - Π_(p+1) t‖² of each element (force²): over E* the energy of what its degree, raised by one, does not
    /// follow.
    pub(crate) unresolved: Vec<f64>,
}

impl Loads {
    /// The integrals of the tractions times a factor.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.nodal.iter_mut().chain(&mut self.bubbles).for_each(|t| *t *= factor);
        self.unresolved.iter_mut().for_each(|t| *t *= factor * factor);
    }
}

/// What is done with each traction: side, name, expression, direction on an element.
pub(crate) type OfTraction<'a> =
    dyn FnMut(usize, &str, &Expression, &dyn Fn(usize) -> [f64; 2]) -> Result<(), SolveError> + 'a;

/// What changes within less than these parts of an edge and of an element is integrated by itself.
const NARROW: f64 = 1.0 / 128.0;
const NARROW_IN_ELEMENT: f64 = 1.0 / 8.0;
/// Changes below this part of the largest value do not.
const SMALL: f64 = 1e-3;
/// Part of ∫ t² that rounding leaves of what is followed.
const ROUNDING: f64 = 1e-14;

/// An element of degree 1 and the moments of its traction against the functions of its ends.
pub(crate) type SideLoad = (usize, [[f64; 2]; 2]);

impl Data<'_> {
    /// Prescribed displacement of every node.
    pub(crate) fn held(&self) -> Result<Vec<Held>, SolveError> {
        let (mesh, space) = (self.mesh, self.space);
        let mut held = vec![Held::default(); space.nodes()];
        for (index, side) in self.scene.sides.iter().enumerate() {
            let Condition::Displacement { values, .. } = &side.condition else { continue };
            for expression in values.iter().flatten().filter(|e| e.constant().is_none()) {
                // only for its errors: the nodes alone do not see a pole between them
                let function = self.function(expression);
                let moments = side_moments(mesh, space, index, &function.datum("displacement"));
                moments.map_err(|error| self.located(error, expression))?;
            }
        }
        let mut prescribed = Vec::new();
        for e in 0..mesh.len() {
            let side = &self.scene.sides[mesh.side[e]];
            let Condition::Displacement { values, .. } = &side.condition else { continue };
            for (j, node) in space.element_nodes(e).enumerate() {
                let site = Site::new(mesh, e, space.basis(e).nodes[j]);
                for (component, value) in values.iter().enumerate() {
                    let Some(expression) = value else { continue };
                    let at = (site.point[0], site.point[1], site.s);
                    let value = self.scene.check_value(&side.name, "displacement", expression, at)?;
                    prescribed.push((node, component, value, mesh.side[e]));
                }
            }
        }
        let largest = prescribed.iter().fold(0.0, |m: f64, p| m.max(p.2.abs()));
        for (node, component, value, side) in prescribed {
            // where two sides hold a node they must agree up to rounding
            let (first_value, first) = *held[node].components[component].get_or_insert((value, side));
            if (first_value - value).abs() > 1e-9 * largest {
                let name = |side: usize| mesh.side_names[side].clone();
                return Err(SolveError::Incompatible {
                    first: name(first),
                    second: name(side),
                    point: space.points[node],
                    component: ['x', 'y'][component],
                    a: first_value,
                    b: value,
                });
            }
        }
        Ok(held)
    }

    /// The tractions and pressures, and where a medium is around the body the jump of the traction, that of the remote stress
    /// included.
    pub(crate) fn load(&self) -> Result<Loads, SolveError> {
        let mut unresolved = vec![0.0; self.mesh.len()];
        let (mut load, mut extra) = (vec![0.0; self.space.dofs()], vec![0.0; 2 * self.mesh.len()]);
        let raised = Space::new(&self.mesh.raised(&vec![true; self.mesh.len()]));
        self.each_traction(&mut |index, name, expression, direction| {
            let followed = self.followed(&raised, index, name, expression)?;
            let mut moments = Vec::with_capacity(followed.len());
            for Followed { element: e, moments: of_element, bubble, rest } in followed {
                let d = direction(e);
                unresolved[e] += rest * (d[0] * d[0] + d[1] * d[1]);
                (0..2).for_each(|i| extra[2 * e + i] += d[i] * bubble);
                moments.push((e, of_element));
            }
            add_load(&mut load, self.space, &moments, direction);
            Ok(())
        })?;
        if let Some(remote) = self.scene.remote_stress() {
            load.iter_mut().zip(remote.traction_load(self.mesh, self.space)).for_each(|(f, t)| *f += t);
            extra.iter_mut().zip(remote.bubble_load(self.mesh, self.space)).for_each(|(f, t)| *f += t);
        }
        Ok(Loads { nodal: load, bubbles: extra, unresolved })
    }

    /// What the elements of a side follow of a datum, `raised` having their degrees and one more.
    fn followed(
        &self,
        raised: &Space,
        side: usize,
        name: &str,
        expression: &Expression,
    ) -> Result<Vec<Followed>, SolveError> {
        let function = self.function(expression);
        let found = side_moments_and_squares(self.mesh, raised, side, &function.datum(name));
        let (moments, squares) = found.map_err(|error| self.located(error, expression))?;
        let of = |((element, mut moments), square): ((usize, Vec<f64>), f64)| {
            let (bubble, followed) = to_hierarchical(self.space.basis(element), raised.basis(element), &mut moments);
            let (h, p) = (self.mesh.length(element), self.space.degree(element));
            let rest = h / (p + 2) as f64 * (square - followed / h - ROUNDING * square).max(0.0);
            Followed { element, moments, bubble, rest }
        };
        Ok(moments.into_iter().zip(squares).map(of).collect())
    }

    /// Adds what elements that may slip do not follow of their friction bounds, under Coulomb's law those of the largest pressure.
    pub(crate) fn add_unresolved_bounds(
        &self,
        unresolved: &mut [f64],
        pressure: f64,
        slips: &dyn Fn(usize) -> bool,
    ) -> Result<(), SolveError> {
        let sides = self.contact_sides();
        let bounds = sides.iter().flat_map(|s| {
            [(s.index, "friction bound", s.bound, 1.0), (s.index, "friction coefficient", s.coefficient, pressure)]
        });
        let raised = Space::new(&self.mesh.raised(&vec![true; self.mesh.len()]));
        for (side, name, bound, factor) in bounds {
            let Some(bound) = bound.filter(|b| b.constant().is_none()) else { continue };
            for part in self.followed(&raised, side, name, bound)?.into_iter().filter(|part| slips(part.element)) {
                unresolved[part.element] += part.rest * factor * factor;
            }
        }
        Ok(())
    }

    /// Moments of tractions, pressures and jumps of the traction on each element of degree 1, elements of several data several
    /// times; without the remote stress.
    pub(crate) fn side_loads(&self) -> Result<Vec<SideLoad>, SolveError> {
        let mut loads = Vec::new();
        self.each_traction(&mut |index, name, expression, direction| {
            let function = self.function(expression);
            let moments = side_moments(self.mesh, self.space, index, &function.datum(name));
            for (e, moments) in moments.map_err(|error| self.located(error, expression))? {
                let d = direction(e);
                loads.push((e, [moments[0], moments[1]].map(|m| d.map(|d| d * m))));
            }
            Ok(())
        })?;
        Ok(loads)
    }

    /// Calls with the side, name, expression and direction on each element of every traction, pressure and jump of the
    /// traction.
    pub(crate) fn each_traction(&self, call: &mut OfTraction<'_>) -> Result<(), SolveError> {
        for (index, side) in self.scene.sides.iter().enumerate() {
            match &side.condition {
                Condition::Traction(traction) | Condition::Displacement { traction: Some(traction), .. } => {
                    for (expression, direction) in traction.iter().zip([[1.0, 0.0], [0.0, 1.0]]) {
                        if expression.constant() != Some(0.0) {
                            call(index, "traction", expression, &|_| direction)?;
                        }
                    }
                }
                Condition::Pressure(pressure) => {
                    call(index, "pressure", pressure, &|e| self.mesh.normal(e).map(|n| -n))?;
                }
                _ => {}
            }
        }
        let edges = self.scene.polygon.edges();
        for (name, expression, direction) in self.scene.traction_jumps() {
            for side in self.interface_sides() {
                call(side, name, expression, &|e| match edges[self.mesh.edge[e]].loop_index {
                    0 => direction(self.mesh.normal(e)),
                    _ => [0.0; 2],
                })?;
            }
        }
        Ok(())
    }

    /// Contact on the bubbles; gap and held displacements are those of the field without the particular solution.
    pub(crate) fn contact_bubbles(
        &self,
        boundary: &ContactBoundary,
        sets: &Sets,
        body: Option<&ParticularSolution>,
    ) -> Result<Vec<ContactBubble>, SolveError> {
        let functions: Vec<_> = self
            .scene
            .sides
            .iter()
            .map(|side| match &side.condition {
                Condition::Contact { gap, friction } => {
                    let [bound, coefficient] =
                        [friction.bound(), friction.coefficient()].map(|f| f.map(|f| self.function(f)));
                    Some((self.less_particular(gap, body, |e| self.mesh.normal(e)), bound, coefficient))
                }
                _ => None,
            })
            .collect();
        let none = Function { value: Box::new(|_| 0.0), kinks: Box::new(|_| Vec::new()) };
        let gap = |side: usize| functions[side].as_ref().map_or(&none, |f| &f.0).datum("gap");
        let bound =
            |side: usize| functions[side].as_ref().and_then(|f| f.1.as_ref()).map(|b| b.datum("friction bound"));
        let coefficient =
            |side: usize| functions[side].as_ref().and_then(|f| f.2.as_ref()).map(|b| b.datum("friction coefficient"));
        Ok(contact_bubbles(self.mesh, self.space, boundary, sets, &gap, &bound, &coefficient)?)
    }

    /// ‖w‖ ‖dw/ds‖ of the held displacements less their interpolants, summed over the components: (element, length²).
    pub(crate) fn held_oscillation(&self, body: Option<&ParticularSolution>) -> Result<Vec<(usize, f64)>, SolveError> {
        let mut found = Vec::new();
        for (index, side) in self.scene.sides.iter().enumerate() {
            let Condition::Displacement { values, .. } = &side.condition else { continue };
            for (expression, direction) in values.iter().zip([[1.0, 0.0], [0.0, 1.0]]) {
                let Some(expression) = expression else { continue };
                if expression.constant().is_some() && body.is_none() {
                    continue;
                }
                let function = self.less_particular(expression, body, |_| direction);
                for e in (0..self.mesh.len()).filter(|&e| self.mesh.side[e] == index) {
                    found.push((e, oscillation(self.mesh, self.space, e, &function.datum("displacement"))?));
                }
            }
        }
        Ok(found)
    }

    /// An expression less the particular solution along a direction.
    pub(crate) fn less_particular<'e>(
        &'e self,
        expression: &'e Expression,
        body: Option<&'e ParticularSolution>,
        direction: impl Fn(usize) -> [f64; 2] + Sync + 'e,
    ) -> Function<'e> {
        let plain = self.function(expression);
        let Some(body) = body else { return plain };
        let value = move |site: &Site| {
            let (u, d) = (body.displacement(site.point), direction(site.element));
            (plain.value)(site) - u[0] * d[0] - u[1] * d[1]
        };
        Function { value: Box::new(value), kinks: plain.kinks }
    }

    fn contact_sides(&self) -> Vec<ContactSide<'_>> {
        let sides = self.scene.sides.iter().enumerate();
        sides
            .filter_map(|(index, side)| match &side.condition {
                Condition::Contact { gap, friction } => {
                    Some(ContactSide { index, gap, bound: friction.bound(), coefficient: friction.coefficient() })
                }
                _ => None,
            })
            .collect()
    }

    /// Gap, bound and coefficient of contact sides.
    fn contact_functions<'s>(&'s self, sides: &[ContactSide<'s>]) -> Vec<(usize, [Option<Function<'s>>; 3])> {
        let of = |s: &ContactSide<'s>| [Some(s.gap), s.bound, s.coefficient].map(|f| f.map(|f| self.function(f)));
        sides.iter().map(|s| (s.index, of(s))).collect()
    }

    /// Calls with gap, bound and coefficient of every contact side.
    pub(crate) fn with_contact_data<T>(&self, call: impl FnOnce(&[SideData<'_>]) -> T) -> T {
        let sides = self.contact_sides();
        let functions = self.contact_functions(&sides);
        let sides: Vec<SideData<'_>> = functions.iter().filter_map(side_data).collect();
        call(&sides)
    }

    /// Residual indicators of some elements.
    pub(crate) fn residuals(
        &self,
        solved: &Solved,
        elements: Range<usize>,
        look: Look,
    ) -> Result<Vec<Residual>, SolveError> {
        let body = solved.particular.as_ref();
        let traction = |site: &Site| -> [Option<f64>; 2] {
            let e = site.element;
            let value = |f: &Expression| f.eval(site.point[0], site.point[1], site.s);
            let given = match &self.scene.sides[self.mesh.side[e]].condition {
                Condition::Contact { .. } => return [None; 2],
                Condition::Free => [Some(0.0); 2],
                Condition::Traction(t) => [Some(value(&t[0])), Some(value(&t[1]))],
                Condition::Pressure(p) => self.mesh.normal(e).map(|n| Some(-n * value(p))),
                Condition::Displacement { values, traction } => [0, 1].map(|i| match (&values[i], traction) {
                    (Some(_), _) => None,
                    (None, Some(t)) => Some(value(&t[i])),
                    (None, None) => Some(0.0),
                }),
            };
            let particular = body.map_or([0.0; 2], |b| b.traction(site.point, self.mesh.normal(e)));
            [0, 1].map(|i| given[i].map(|t| t - particular[i]))
        };
        let first = elements.start;
        let boundary = boundary_residuals_of(self.mesh, &solved.field, &traction, elements.clone(), look)?;
        let mut residuals: Vec<Residual> =
            boundary.into_iter().map(|boundary| Residual { boundary, ..Default::default() }).collect();
        if let Some(contact) = &solved.contact {
            let solution = ContactSolution {
                mesh: self.mesh,
                space: self.space,
                displacement: &solved.displacement,
                multiplier: match &contact.stabilised {
                    Some(s) => Multiplier::Stabilised(&s.space, &s.solution.multipliers),
                    None => Multiplier::Biorthogonal(&contact.boundary, &contact.solution.multipliers),
                },
                field: &solved.field,
                body_force: body,
            };
            for residual in self.with_contact_data(|sides| contact_residuals_of(&solution, sides, elements, look))? {
                residuals[residual.element - first].contact = residual;
            }
        }
        Ok(residuals)
    }

    /// [`Self::contact`] with the unknowns only that its conditions need.
    pub(crate) fn condensed_contact(&self, held: &[Held]) -> Result<Option<ContactBoundary>, SolveError> {
        let frictionless = |side: usize| {
            matches!(self.scene.sides[side].condition, Condition::Contact { friction: Friction::None, .. })
        };
        // of as few unknowns as rigid motions there may be no stiffness left
        let enough = |boundary: &ContactBoundary| boundary.kept().len() > 3;
        let boundary = self.contact(held)?;
        Ok(boundary.map(|whole| Some(whole.clone().without_tangents(&frictionless)).filter(enough).unwrap_or(whole)))
    }

    /// Contact nodes, weights and conditions; none without a contact side.
    pub(crate) fn contact(&self, held: &[Held]) -> Result<Option<ContactBoundary>, SolveError> {
        let sides = self.contact_sides();
        if sides.is_empty() {
            return Ok(None);
        }
        for side in &sides {
            for (name, friction) in [("friction bound", side.bound), ("friction coefficient", side.coefficient)] {
                if let Some(friction) = friction {
                    self.check_at_nodes(side.index, name, friction)?;
                }
            }
        }
        for side in &sides {
            self.check_held_ends(side.index, side.gap, held)?;
        }
        let values = |node: usize| held[node].components.map(|c| c.map(|(value, _)| value));
        let boundary = self.with_contact_data(|sides| contact_boundary(self.mesh, self.space, sides, &values));
        boundary.map(Some).map_err(|error| match error {
            steklov_contact::ContactError::Data(error) => match self.contact_expression(&error) {
                Some(expression) => self.located(error, expression),
                None => error.into(),
            },
            error => error.into(),
        })
    }

    /// A held end of a contact side must not be held inside the obstacle: no traction could do that at a point.
    fn check_held_ends(&self, side: usize, gap: &Expression, held: &[Held]) -> Result<(), SolveError> {
        for e in (0..self.mesh.len()).filter(|&e| self.mesh.side[e] == side) {
            let n = self.mesh.normal(e);
            for (t, node) in [(-1.0, self.space.node(e, 0)), (1.0, self.space.node(e, self.space.degree(e)))] {
                let components = held[node].components;
                let movable = (0..2).any(|i| components[i].is_none() && n[i].abs() > 1e-12);
                let Some((_, holder)) = components.iter().flatten().next() else { continue };
                let site = Site::new(self.mesh, e, t);
                let gap = gap.eval(site.point[0], site.point[1], site.s);
                let u_n: f64 = (0..2).map(|i| components[i].map_or(0.0, |(value, _)| n[i] * value)).sum();
                if !movable && u_n - gap > 1e-9 * u_n.abs().max(gap.abs()) {
                    let (name, holder) = (&self.mesh.side_names[side], &self.mesh.side_names[*holder]);
                    let [x, y] = site.point;
                    let message = format!(
                        "the point ({x}, {y}) at the end of side {name:?} is held at u_n = {u_n}, inside the obstacle, \
                         whose gap there is {gap}"
                    );
                    let keys = [vec!["sides", holder, "displacement"]];
                    let help =
                        "hold it outside of the obstacle, free the component along the normal, or change the gap";
                    return Err(self.scene.error_at(SceneErrorKind::Conflict, &keys, message, help).into());
                }
            }
        }
        Ok(())
    }

    /// The gap, friction bound or coefficient that an error is about.
    fn contact_expression(&self, error: &BemError) -> Option<&Expression> {
        let (BemError::DataNotFinite { name, side, .. } | BemError::DataRough { name, side, .. }) = error else {
            return None;
        };
        match &self.scene.sides.iter().find(|s| s.name == *side)?.condition {
            Condition::Contact { gap, .. } if name == "gap" => Some(gap),
            Condition::Contact { friction, .. } => friction.bound().or(friction.coefficient()),
            _ => None,
        }
    }

    /// Bounds and coefficients of friction are used at the nodes, from both sides of each.
    fn check_at_nodes(&self, side: usize, what: &str, expression: &Expression) -> Result<(), SolveError> {
        for e in (0..self.mesh.len()).filter(|&e| self.mesh.side[e] == side) {
            for &t in &self.space.basis(e).nodes {
                let site = Site::new(self.mesh, e, t);
                let at = (site.point[0], site.point[1], site.s);
                self.scene.check_value(&self.mesh.side_names[side], what, expression, at)?;
            }
        }
        Ok(())
    }

    pub(crate) fn function<'e>(&'e self, expression: &'e Expression) -> Function<'e> {
        Function {
            value: Box::new(move |site: &Site| expression.eval(site.point[0], site.point[1], site.s)),
            kinks: Box::new(move |e: usize| self.breaks(expression, e)),
        }
    }

    /// Whether an expression changes within a small part of an element, or is not known there.
    pub(crate) fn is_narrow(&self, expression: &Expression, e: usize) -> bool {
        let [a, b] = self.mesh.span[e];
        let (low, high) = (a.min(b), a.max(b));
        let along = expression.along(&self.scene.polygon.edges()[self.mesh.edge[e]]);
        let inside = |p: &&Piece| p.ends[0] < high && p.ends[1] > low;
        let unknown = along.survey.pieces.iter().filter(inside).any(|p| !p.known);
        unknown || !along.survey.narrow([low, high], NARROW_IN_ELEMENT * (high - low), SMALL).is_empty()
    }

    /// Reference coordinates inside of an element at which an expression has kinks, and those that part what is too narrow
    /// there for rules over the whole element to see.
    fn breaks(&self, expression: &Expression, e: usize) -> Vec<f64> {
        if expression.constant().is_some() {
            return Vec::new();
        }
        let [a, b] = self.mesh.span[e];
        let along = expression.along(&self.scene.polygon.edges()[self.mesh.edge[e]]);
        let (low, high) = (a.min(b), a.max(b));
        let kinks = along.kinks.iter().copied().filter(|s| low < *s && *s < high);
        let narrow = along.survey.narrow([low, high], NARROW.min(NARROW_IN_ELEMENT * (high - low)), SMALL);
        let mut breaks: Vec<f64> = kinks.chain(narrow).map(|s| (2.0 * s - a - b) / (b - a)).collect();
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        breaks
    }

    /// An error of the numerics about an expression, told with its place in the scene.
    pub(crate) fn located(&self, error: BemError, expression: &Expression) -> SolveError {
        match &error {
            BemError::DataNotFinite { name, side, point, .. } => {
                let Location::Boundary { s, .. } = self.scene.polygon.contains(*point) else { return error.into() };
                match self.scene.check_value(side, name, expression, (point[0], point[1], s)) {
                    Err(error) => error.into(),
                    // rounding of s or of the point: the value was not finite all the same
                    Ok(_) => self.scene.data_error(expression, &error.to_string()).into(),
                }
            }
            BemError::DataRough { .. } => self.scene.data_error(expression, &error.to_string()).into(),
            _ => error.into(),
        }
    }

    /// ∫ t φ_j over element e of the whole traction, for its local node j.
    pub(crate) fn traction_moment(
        &self,
        field: &BoundaryField,
        body: Option<&ParticularSolution>,
        e: usize,
        j: usize,
    ) -> [f64; 2] {
        let basis = self.space.basis(e);
        let rule = steklov_quadrature::gauss_legendre(basis.degree + 2);
        let mut phi = vec![0.0; basis.degree + 1];
        let mut sum = [0.0; 2];
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            basis.evaluate(t, &mut phi);
            let mut traction = field.trace(e, t).traction;
            if let Some(body) = body {
                let extra = body.traction(self.mesh.point(e, t), self.mesh.normal(e));
                traction = [traction[0] + extra[0], traction[1] + extra[1]];
            }
            for i in 0..2 {
                sum[i] += w * self.mesh.length(e) / 2.0 * phi[j] * traction[i];
            }
        }
        sum
    }
}

/// Moments against the nodal functions of degree p+1 become those against the nodal functions of degree p; returns that
/// against the bubble (P_(p+1) - P_(p-1))/(2p+1), and Σ (2k+1) m_k² of those against P_0, .., P_(p+1): the length of the
/// element times the square of the part of the datum that degree p+1 follows.
fn to_hierarchical(basis: &LobattoBasis, raised: &LobattoBasis, moments: &mut Vec<f64>) -> (f64, f64) {
    let p = basis.degree;
    let (mut phi, mut legendre) = (vec![0.0; p + 1], vec![0.0; p + 2]);
    let (mut nodal, mut against) = (vec![0.0; p + 1], vec![0.0; p + 2]);
    for (&t, &moment) in raised.nodes.iter().zip(moments.iter()) {
        basis.evaluate(t, &mut phi);
        legendre_p(t, &mut legendre);
        nodal.iter_mut().zip(&phi).for_each(|(sum, phi)| *sum += phi * moment);
        against.iter_mut().zip(&legendre).for_each(|(sum, p)| *sum += p * moment);
    }
    *moments = nodal;
    let followed = against.iter().enumerate().map(|(k, m)| (2 * k + 1) as f64 * m * m).sum();
    ((against[p + 1] - against[p - 1]) / (2 * p + 1) as f64, followed)
}

/// What an element follows of a datum.
struct Followed {
    element: usize,
    /// Against its nodal functions.
    moments: Vec<f64>,
    /// Against its bubble.
    bubble: f64,
    /// h/(p+2) ‖t - Π_(p+1) t‖² of the rest.
    rest: f64,
}

/// A contact side of the scene.
struct ContactSide<'a> {
    index: usize,
    gap: &'a Expression,
    bound: Option<&'a Expression>,
    coefficient: Option<&'a Expression>,
}

fn side_data<'a>((side, functions): &'a (usize, [Option<Function<'_>>; 3])) -> Option<SideData<'a>> {
    let [gap, bound, coefficient] = functions;
    Some(SideData {
        side: *side,
        gap: gap.as_ref()?.datum("gap"),
        bound: bound.as_ref().map(|b| b.datum("friction bound")),
        coefficient: coefficient.as_ref().map(|c| c.datum("friction coefficient")),
    })
}

/// An expression as a datum of the numerics.
pub(crate) struct Function<'a> {
    value: Box<dyn Fn(&Site) -> f64 + Sync + 'a>,
    kinks: Box<dyn Fn(usize) -> Vec<f64> + Sync + 'a>,
}

impl Function<'_> {
    pub(crate) fn datum<'a>(&'a self, name: &'a str) -> Datum<'a> {
        Datum { name, value: &*self.value, kinks: &*self.kinks }
    }
}
