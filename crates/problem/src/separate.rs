//! The medium around a body as a body of its own.

use steklov_bem_operators::{Loop, Polygon, PolygonError};

use super::{Body, DataError, DataErrorKind as Kind, Other, Problem};

impl Problem {
    /// The hole of the medium around the first body: its outer loop.
    pub(super) fn outer_hole(&self) -> Loop {
        let edges = &self.outline.edges()[self.outline.loops()[0].clone()];
        let (corners, names) = edges.iter().map(|e| (e.listed()[0], self.sides[e.side].name.clone())).unzip();
        Loop { paths: edges.iter().map(|e| e.path).collect(), ..Loop::straight(corners, names) }
    }

    /// Whether boundary elements need the medium around the body as a body of its own, and can have it so: the body has holes or
    /// a force.
    pub fn needs_separate_medium(&self) -> bool {
        self.takes_separate_medium() && (self.bodies[0].force.is_some() || self.outline.loops().len() > 1)
    }

    /// Whether boundary elements can have the medium around the body as a body of its own: the body has one material, no force or
    /// one that is affine in the place, nothing but the medium on its outer loop, and no jump of the stress.
    pub fn takes_separate_medium(&self) -> bool {
        let (Some(tie), [body, _]) = (self.tie(), &self.bodies[..]) else { return false };
        let is_affine = body.force.is_none() || body.force_gradient().is_some();
        let is_bare = |&side: &usize| self.sides[side].is_free() && self.contact(side).is_none();
        is_affine && body.cells().is_none() && tie.stress_jump.is_none() && self.outer_sides().iter().all(is_bare)
    }

    /// The same problem with the medium around the body as the last body, tied to it and without a grid: its sides are those of the
    /// outer loop, with `medium.` before their names. Boundary elements solve it whatever holes the body has. The problem itself
    /// without a medium around the body.
    ///
    /// # Errors
    /// An outer loop that outlines no hole; as [`Problem::join`].
    pub fn with_separate_medium(&self) -> Result<Self, DataError> {
        let Some(tied) = self.interfaces.iter().find(|interface| interface.other == Other::Medium) else {
            return Ok(self.clone());
        };
        let refuse = |e: PolygonError| {
            let help = "a medium surrounds a body whose outer loop is the outline of a hole";
            DataError::at(Kind::Geometry, &[vec!["body", "corners"]], e.to_string(), help)
        };
        let medium = &self.bodies[self.bodies.len() - 1];
        let around = Polygon::outside(vec![self.outer_hole()]).map_err(refuse)?.with_body_name(&medium.name);
        let bodies = self.bodies.iter().map(|body| Body { grid: None, ..body.clone() }).collect();
        let mut separate = Self::of_bodies(Polygon::assembly(vec![self.outline.clone(), around]), bodies);
        let own = self.sides.len();
        separate.sides[..own].clone_from_slice(&self.sides);
        for interface in self.interfaces.iter().filter(|interface| interface.other != Other::Medium) {
            separate.join_as(interface.clone())?;
        }
        let beyond: Vec<usize> = (own..separate.sides.len()).collect();
        let joined = separate.join(&tied.sides, &beyond, tied.law.clone(), None)?;
        joined.name.clone_from(&tied.name);
        Ok(separate)
    }
}
