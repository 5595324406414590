//! Bodies and the interfaces between them.
//!
//! ```text
//! a part held and loaded         one body
//! on a rigid obstacle            one body, an interface of contact with the obstacle
//! a hole in the plane            one body that is a medium
//! a body in a medium             a body, a medium, an interface that ties them
//! ```

use steklov_bem_operators::{Edge, Polygon, PolygonError};
use steklov_elastic::Material;
use steklov_expression::Expression;

use super::spans::KnownSpans;
use super::{Cells, Contact, DataError, DataErrorKind as Kind, FarField, GridInput, Side, Tie};

/// Bodies and the interfaces between them.
#[derive(Debug, Clone)]
pub struct Problem {
    /// The boundary of all bodies that have one, body after body: loops, edges and sides are numbered through all of them.
    pub outline: Polygon,
    /// The sides in the order of [`Polygon::side_names`].
    pub sides: Vec<Side>,
    /// The bodies in the order of [`Polygon::bodies`]. Behind the first one there may be the medium around it, which has no
    /// boundary of its own.
    pub bodies: Vec<Body>,
    /// The interfaces between them, and between them and rigid obstacles.
    pub(super) interfaces: Vec<Interface>,
    /// E* of each body by which sides are paired; none are their own.
    pub(super) paired_by: Vec<f64>,
    /// Where their sides see one another, once it is computed.
    pub(crate) known_spans: KnownSpans,
}

/// A body: its substance and the load on all of it. The region that it occupies, the inside of its loops or the plane outside
/// of them, is in the outline of its problem.
#[derive(Debug, Clone)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// Its substance.
    pub substance: Substance,
    /// The grid over it, of finite elements.
    pub grid: Option<GridInput>,
    /// Force per area; constant with boundary elements.
    pub force: Option<[Expression; 2]>,
    /// The far field of a medium; `None` for a bounded body.
    pub far: Option<FarField>,
}

/// The substance of a body.
#[derive(Debug, Clone)]
pub enum Substance {
    /// One material.
    Homogeneous(Material),
    /// A modulus for each cell.
    Cells(Cells),
}

/// The sides of an interface and what lies opposite. They carry the multipliers of the law: pressures, shears, tractions.
#[derive(Debug, Clone)]
pub struct Interface {
    /// Its name.
    pub name: String,
    /// The sides of one body.
    pub sides: Vec<usize>,
    /// The other side of the interface.
    pub other: Other,
    /// The law that holds there.
    pub law: Law,
    /// Where they are named; forces are reported for the first place.
    pub place: Place,
    /// The kind of both sides.
    pub faces: Faces,
}

/// The places of the two sides of an interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Named first.
    First,
    /// Named second.
    Second,
}

/// The kind of both sides of an interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Faces {
    /// Sides of two outlines, each with a mesh of its own.
    Own,
    /// Both faces of a cut through one body: their meshes are the same.
    Cut,
}

/// The other side of an interface of a body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Other {
    /// A rigid obstacle.
    Obstacle,
    /// The medium around the first body, on the same boundary.
    Medium,
    /// Sides of other bodies.
    Sides(Vec<usize>),
}

/// The law of an interface.
#[derive(Debug, Clone)]
pub enum Law {
    /// Unilateral contact.
    Contact(Contact),
    /// Displacement and traction go through, up to given jumps.
    Tied(Tie),
}

impl Body {
    /// A bounded body without a load.
    pub fn new(name: &str, substance: Substance) -> Self {
        Self { name: name.to_owned(), substance, grid: None, force: None, far: None }
    }

    /// Its material; for cells with moduli of their own that of the modulus 1.
    pub fn material(&self) -> Material {
        match &self.substance {
            Substance::Homogeneous(material) => *material,
            Substance::Cells(cells) => cells.of_unit_modulus,
        }
    }

    /// The force on it (force/area), if it is the same everywhere.
    pub fn constant_force(&self) -> Option<[f64; 2]> {
        let [x, y] = self.force.as_ref()?;
        Some([x.constant()?, y.constant()?])
    }

    /// The derivatives [[∂x b_x, ∂y b_x], [∂x b_y, ∂y b_y]] of the force on it (stress/length²), if that is affine in the place by
    /// its form: zero if it is the same everywhere.
    pub fn force_gradient(&self) -> Option<[[f64; 2]; 2]> {
        let [x, y] = self.force.as_ref()?;
        let ([_, xx, xy], [_, yx, yy]) = (x.affine_in_place()?, y.affine_in_place()?);
        Some([[xx, xy], [yx, yy]])
    }

    /// Its cells, where they have moduli of their own.
    pub fn cells(&self) -> Option<&Cells> {
        if let Substance::Cells(cells) = &self.substance { Some(cells) } else { None }
    }

    /// Young's modulus and Poisson's ratio of its cells, where they are expressions.
    pub fn cell_expressions(&self) -> impl Iterator<Item = &Expression> {
        self.cells().into_iter().flat_map(Cells::expressions)
    }
}

impl Problem {
    /// One body, whose sides are all free: a medium without a far field where its outline is that of holes.
    pub fn new(outline: Polygon, substance: Substance) -> Self {
        let far = (!outline.is_bounded()).then(FarField::default);
        Self::of_bodies(outline, vec![Body { far, ..Body::new("body", substance) }])
    }

    /// Bodies whose sides are all free, in the order of [`Polygon::bodies`].
    pub fn of_bodies(outline: Polygon, bodies: Vec<Body>) -> Self {
        Self {
            sides: outline.side_names().iter().map(|name| Side::free(name)).collect(),
            outline,
            bodies,
            interfaces: Vec::new(),
            paired_by: Vec::new(),
            known_spans: KnownSpans::default(),
        }
    }

    /// The interfaces between bodies, and between them and rigid obstacles.
    pub fn interfaces(&self) -> &[Interface] {
        &self.interfaces
    }

    /// The laws of all interfaces.
    pub fn laws_mut(&mut self) -> impl Iterator<Item = &mut Law> {
        self.interfaces.iter_mut().map(|interface| &mut interface.law)
    }

    /// The number of the side of a name, `BODY.SIDE` among several bodies.
    pub fn side(&self, name: &str) -> Option<usize> {
        self.sides.iter().position(|side| side.name == name)
    }

    /// The side of a name.
    pub fn side_mut(&mut self, name: &str) -> Option<&mut Side> {
        self.sides.iter_mut().find(|side| side.name == name)
    }

    /// Puts a side in contact with a rigid obstacle, in place of its former interface.
    pub fn touch(&mut self, side: usize, contact: Contact) {
        self.interfaces.retain(|i| i.sides != [side]);
        self.sides[side] = Side::free(&self.sides[side].name);
        let (name, law) = (self.sides[side].name.clone(), Law::Contact(contact));
        self.interfaces.push(Interface {
            name,
            sides: vec![side],
            other: Other::Obstacle,
            law,
            place: Place::First,
            faces: Faces::Own,
        });
    }

    /// An unbounded medium around the first body, tied to its outer loop.
    ///
    /// # Errors
    /// A loop that outlines no hole.
    pub fn surround(&mut self, material: Material, far: FarField, tie: Tie) -> Result<(), PolygonError> {
        Polygon::outside(vec![self.outer_hole()])?;
        let sides = self.outer_sides();
        self.bodies.truncate(1);
        self.bodies.push(Body { far: Some(far), ..Body::new("medium", Substance::Homogeneous(material)) });
        self.interfaces.push(Interface {
            name: "medium".into(),
            sides,
            other: Other::Medium,
            law: Law::Tied(tie),
            place: Place::First,
            faces: Faces::Own,
        });
        Ok(())
    }

    /// The jumps across ties between bodies: the side along which each is given, its name, its expression.
    pub fn jumps_of_ties(&self) -> impl Iterator<Item = (usize, &'static str, &Expression)> {
        let ties = self.joints().filter_map(|interface| match &interface.law {
            Law::Tied(tie) => Some((interface, tie)),
            Law::Contact(_) => None,
        });
        ties.flat_map(|(interface, tie)| {
            interface.sides.iter().flat_map(|&side| tie.jumps().map(move |(what, jump)| (side, what, jump)))
        })
    }

    /// The sides of the outer loop of the first body, rising.
    pub(super) fn outer_sides(&self) -> Vec<usize> {
        let edges = &self.outline.edges()[self.outline.loops()[0].clone()];
        let mut sides: Vec<usize> = edges.iter().map(|e| e.side).collect();
        sides.sort_unstable();
        sides.dedup();
        sides
    }

    /// The contact whose multipliers a side carries.
    pub fn contact(&self, side: usize) -> Option<&Contact> {
        self.interfaces.iter().find_map(|interface| match &interface.law {
            Law::Contact(contact) if interface.sides.contains(&side) => Some(contact),
            _ => None,
        })
    }

    /// The body to which an edge of the outline belongs.
    pub fn body_of(&self, edge: &Edge) -> &Body {
        &self.bodies[self.outline.body_of_loop(edge.loop_index)]
    }

    /// The body to which a side belongs.
    pub fn body_of_side(&self, side: usize) -> usize {
        let edge = self.outline.edges().iter().find(|edge| edge.side == side);
        edge.map_or(0, |edge| self.outline.body_of_loop(edge.loop_index))
    }

    /// Whether a side is on springs.
    pub fn has_springs(&self) -> bool {
        self.sides.iter().any(|side| side.springs.is_some())
    }

    /// Whether sides of several bodies meet.
    pub fn has_several_bodies(&self) -> bool {
        self.outline.bodies().len() > 1
    }

    /// The unbounded medium, if the only body is one, or around the only body.
    pub fn medium(&self) -> Option<&Body> {
        self.bodies.iter().find(|body| body.far.is_some()).filter(|_| !self.has_several_bodies())
    }

    /// The tie of the first body to a medium around it.
    pub fn tie(&self) -> Option<&Tie> {
        self.interfaces.iter().find_map(|interface| match (&interface.law, &interface.other) {
            (Law::Tied(tie), Other::Medium) => Some(tie),
            _ => None,
        })
    }

    /// Whether the bodies are those that can be solved: bounded ones, one medium, or one body and the medium around it;
    /// whether they do not overlap, and no side is in two interfaces or has a condition besides its interface.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check_bodies(&self) -> Result<(), DataError> {
        let refuse =
            |message: String, help: &str| Err(DataError::at(Kind::Unsupported, &[vec!["body"]], message, help));
        let bounded = self.bodies.iter().filter(|body| body.far.is_none()).count();
        let parts = self.outline.bodies().len();
        let around = self.interfaces.iter().filter(|i| i.other == Other::Medium).count();
        let fits = |(k, body): (usize, &Body)| k >= parts || self.outline.is_body_bounded(k) == body.far.is_none();
        let known = match self.bodies.len() - bounded {
            media if parts > 1 => around == 0 && parts == self.bodies.len() && media <= 1,
            0 => around == 0 && bounded == parts && self.outline.is_bounded(),
            1 if bounded == 0 => around == 0 && parts == 1 && !self.outline.is_bounded(),
            1 => around == 1 && bounded == 1 && parts == 1 && self.outline.is_bounded(),
            _ => false,
        };
        let known = known && self.bodies.iter().enumerate().all(fits);
        if !known || self.bodies.is_empty() || self.sides.len() != self.outline.side_names().len() {
            let names: Vec<&str> = self.bodies.iter().map(|body| body.name.as_str()).collect();
            let message = format!(
                "{parts} outlines with {} sides, the bodies {:?} and {around} media around one cannot be solved at once",
                self.sides.len(),
                names.join(", ")
            );
            return refuse(
                message,
                "bounded bodies are solved, with one medium among them at most, or one hole, or one body tied to a medium around it",
            );
        }
        if let Err((message, help)) = self.check_overlaps() {
            return Err(DataError::at(Kind::Geometry, &[vec!["body"]], message, help));
        }
        self.check_conditions()
    }
}
