//! The data of contact sides on a mesh: gaps, friction bounds and coefficients.

use steklov_bem_operators::{BemError, Site};
use steklov_contact::{Beyond, ContactBoundary, ContactBubble, Sets, SideData, contact_boundary, contact_bubbles};
use steklov_expression::Expression;
use steklov_problem::{Contact, DataError, DataErrorKind, Friction};

use crate::data::body_load::Particulars;
use crate::data::joints::Joint;
use crate::data::on_mesh::{Function, OnMesh};
use crate::data::supports::Held;
use crate::error::SolveError;

impl OnMesh<'_> {
    /// Contact on the bubbles; gap and held displacements are those of the field without the particular solution.
    pub(crate) fn contact_bubbles(
        &self,
        boundary: &ContactBoundary,
        sets: &Sets,
        particular: &Particulars,
    ) -> Result<Vec<ContactBubble>, SolveError> {
        let of_side = |side: usize| {
            let Contact { gap, friction } = self.scene.contact(side)?;
            let [bound, coefficient] = [friction.bound(), friction.coefficient()].map(|f| f.map(|f| self.function(f)));
            let gap = match self.scene.problem.joint(side) {
                Some(_) => self.gap(side, gap),
                None => {
                    let body = self.particular_of_side(particular, side);
                    self.less_particular(gap, body, |site| self.mesh.normal(site.element, site.t))
                }
            };
            Some((gap, bound, coefficient))
        };
        let functions: Vec<_> = (0..self.scene.problem.sides.len()).map(of_side).collect();
        let none = Function { value: Box::new(|_| 0.0), kinks: Box::new(|_| Vec::new()), rounding: None };
        let gap = |side: usize| functions[side].as_ref().map_or(&none, |f| &f.0).datum("gap");
        let bound =
            |side: usize| functions[side].as_ref().and_then(|f| f.1.as_ref()).map(|b| b.datum("friction bound"));
        let coefficient =
            |side: usize| functions[side].as_ref().and_then(|f| f.2.as_ref()).map(|b| b.datum("friction coefficient"));
        Ok(contact_bubbles(self.mesh, self.space, boundary, sets, &gap, &bound, &coefficient)?)
    }

    pub(crate) fn contact_sides(&self) -> Vec<ContactSide<'_>> {
        let sides = self.scene.contacts();
        sides
            .map(|(index, Contact { gap, friction })| ContactSide {
                index,
                gap,
                bound: friction.bound(),
                coefficient: friction.coefficient(),
            })
            .collect()
    }

    /// Gap, bound and coefficient of contact sides.
    fn contact_functions<'s>(&'s self, sides: &[ContactSide<'s>]) -> Vec<(usize, [Option<Function<'s>>; 3])> {
        let of = |s: &ContactSide<'s>| {
            let [bound, coefficient] = [s.bound, s.coefficient].map(|f| f.map(|f| self.function(f)));
            [Some(self.gap(s.index, s.gap)), bound, coefficient]
        };
        sides.iter().map(|s| (s.index, of(s))).collect()
    }

    /// Calls `call` with gap, bound and coefficient of every contact side, and the elements that face other bodies.
    pub(crate) fn with_contact_data<T>(&self, joints: &[Joint], call: impl FnOnce(&[SideData<'_>]) -> T) -> T {
        let sides = self.contact_sides();
        let functions = self.contact_functions(&sides);
        let of_joint = |side: usize| {
            let interface = self.scene.problem.joint(side)?;
            joints.iter().find(|j| std::ptr::eq(&raw const self.scene.problem.interfaces()[j.interface], interface))
        };
        let direction = |e: usize, t: f64| self.direction(e, t);
        let beyond =
            |side: usize| of_joint(side).map(|joint| Beyond { elements: joint.own.as_slice(), direction: &direction });
        let sides: Vec<SideData<'_>> =
            functions.iter().filter_map(|f| Some(SideData { beyond: beyond(f.0), ..side_data(f)? })).collect();
        call(&sides)
    }

    /// [`Self::contact`] with only those unknowns that its conditions need.
    pub(crate) fn condensed_contact(
        &self,
        held: &[Held],
        joints: &[Joint],
    ) -> Result<Option<ContactBoundary>, SolveError> {
        let frictionless = |side: usize| self.scene.contact(side).is_some_and(|c| matches!(c.friction, Friction::None));
        // with no more unknowns than rigid motions there may be no stiffness left
        let enough = |boundary: &ContactBoundary| boundary.kept().len() > 3 && boundary.rows.is_empty();
        let boundary = self.contact(held, joints)?;
        Ok(boundary.map(|whole| Some(whole.clone().without_tangents(&frictionless)).filter(enough).unwrap_or(whole)))
    }

    /// Contact nodes, weights and conditions; none without a contact side.
    ///
    /// # Errors
    /// [`SolveError::Data`] for a gap, friction bound or coefficient without a finite value or with a negative friction, and
    /// for a held end of a contact side inside the obstacle: correct the expression, or the displacement that holds the end.
    /// [`SolveError::Contact`] if the contact side has no usable conditions.
    pub fn contact(&self, held: &[Held], joints: &[Joint]) -> Result<Option<ContactBoundary>, SolveError> {
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
        for side in sides.iter().filter(|side| self.scene.problem.joint(side.index).is_none()) {
            self.check_held_ends(side.index, side.gap, held)?;
        }
        let values = |node: usize| held[node].components.map(|c| c.map(|(value, _)| value));
        let boundary = self.with_contact_data(joints, |sides| contact_boundary(self.mesh, self.space, sides, &values));
        let mut boundary = boundary.map_err(|error| match error {
            steklov_contact::ContactError::Data(error) => match self.contact_expression(&error) {
                Some(expression) => self.located(error, expression),
                None => error.into(),
            },
            error => SolveError::from(error),
        })?;
        self.join_contact(&mut boundary, joints, held)?;
        Ok(Some(boundary))
    }

    /// A held end of a contact side must not be held inside the obstacle: no traction could do that at a point.
    fn check_held_ends(&self, side: usize, gap: &Expression, held: &[Held]) -> Result<(), SolveError> {
        for e in (0..self.mesh.len()).filter(|&e| self.mesh.side[e] == side) {
            for (t, node) in [(-1.0, self.space.node(e, 0)), (1.0, self.space.node(e, self.space.degree(e)))] {
                let (components, n) = (held[node].components, self.mesh.normal(e, t));
                let movable = (0..2).any(|i| components[i].is_none() && n[i].abs() > 1e-12);
                let Some((_, holder)) = components.iter().flatten().next() else { continue };
                let site = Site::new(self.mesh, e, t);
                let gap = self.value(gap, &site);
                let parts = [0, 1].map(|i| components[i].map_or(0.0, |(value, _)| n[i] * value));
                let (u_n, size) = (parts[0] + parts[1], parts[0].abs() + parts[1].abs());
                if !movable && u_n - gap > 1e-9 * size.max(gap.abs()) {
                    let (name, holder) = (&self.mesh.side_names[side], &self.mesh.side_names[*holder]);
                    let [x, y] = site.point;
                    let message = format!(
                        "the point ({x}, {y}) at the end of side {name:?} is held at u_n = {u_n}, inside the obstacle, \
                         whose gap there is {gap}"
                    );
                    let keys = [vec!["sides", holder, "displacement"]];
                    let help =
                        "hold it outside of the obstacle, free the component along the normal, or change the gap";
                    return Err(DataError::at(DataErrorKind::Conflict, &keys, message, help).into());
                }
            }
        }
        Ok(())
    }

    /// The gap, friction bound or coefficient to which an error refers.
    fn contact_expression(&self, error: &BemError) -> Option<&Expression> {
        let (BemError::DataNotFinite { name, side, .. } | BemError::DataRough { name, side, .. }) = error else {
            return None;
        };
        let side = self.scene.problem.sides.iter().position(|s| s.name == *side)?;
        self.scene.contact(side)?.data().into_iter().find(|(what, _)| what == name).map(|(_, expression)| expression)
    }

    /// Bounds and coefficients of friction are used at the nodes, from both sides of each.
    fn check_at_nodes(&self, side: usize, what: &str, expression: &Expression) -> Result<(), SolveError> {
        for e in (0..self.mesh.len()).filter(|&e| self.mesh.side[e] == side) {
            for &t in &self.space.basis(e).nodes {
                let site = Site::new(self.mesh, e, t);
                let at = (site.point[0], site.point[1], self.mesh.arc_fraction(site.element, site.t));
                self.scene.check_value(&self.mesh.side_names[side], what, expression, at)?;
            }
        }
        Ok(())
    }
}

/// A contact side of the scene.
pub(crate) struct ContactSide<'a> {
    pub(crate) index: usize,
    pub(crate) gap: &'a Expression,
    pub(crate) bound: Option<&'a Expression>,
    pub(crate) coefficient: Option<&'a Expression>,
}

fn side_data<'a>((side, functions): &'a (usize, [Option<Function<'_>>; 3])) -> Option<SideData<'a>> {
    let [gap, bound, coefficient] = functions;
    Some(SideData {
        side: *side,
        gap: gap.as_ref()?.datum("gap"),
        bound: bound.as_ref().map(|b| b.datum("friction bound")),
        coefficient: coefficient.as_ref().map(|c| c.datum("friction coefficient")),
        beyond: None,
    })
}
