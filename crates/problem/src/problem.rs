//! Bodies and what acts between them.
//!
//! ```text
//! a part held and loaded         one body
//! on a rigid obstacle            one body, an interface of contact with the obstacle
//! a hole in the plane            one body that is a medium
//! a body in a medium             a body, a medium, an interface that ties them
//! ```

use steklov_bem_operators::{Loop, Polygon, PolygonError};
use steklov_elastic::Material;
use steklov_expression::Expression;

use super::{Cells, Condition, Contact, DataError, DataErrorKind as Kind, FarField, GridInput, Side, Tie};

/// Bodies and what acts between them.
#[derive(Debug, Clone)]
pub struct Problem {
    /// The bodies. The first one is solved; a second one may be the medium around it.
    pub bodies: Vec<Body>,
    /// What acts between them, and between them and rigid obstacles.
    pub interfaces: Vec<Interface>,
}

/// A body: where it is, what it is made of, what holds and loads it.
#[derive(Debug, Clone)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// What it occupies: the inside of its outline, or the plane outside of holes, which makes it a medium.
    pub outline: Polygon,
    /// What it is made of.
    pub substance: Substance,
    /// The grid over it, of finite elements.
    pub grid: Option<GridInput>,
    /// The sides in the order of [`Polygon::side_names`].
    pub sides: Vec<Side>,
    /// Force per area; constant with boundary elements.
    pub force: Option<[Expression; 2]>,
    /// What a medium does far away; `None` of a bounded body.
    pub far: Option<FarField>,
}

/// What a body is made of.
#[derive(Debug, Clone)]
pub enum Substance {
    /// One material.
    Homogeneous(Material),
    /// A modulus for each cell.
    Cells(Cells),
}

/// Sides of a body and what they meet.
#[derive(Debug, Clone)]
pub struct Interface {
    /// Number of the body.
    pub body: usize,
    /// Its sides.
    pub sides: Vec<usize>,
    /// What they meet.
    pub other: Other,
    /// The law that holds there.
    pub law: Law,
}

/// What sides of a body meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Other {
    /// A rigid obstacle.
    Obstacle,
    /// The body of a number.
    Body(usize),
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
    /// A body of one material, a medium without a far field where its outline is that of holes, whose sides are all free.
    pub fn new(name: &str, outline: Polygon, substance: Substance) -> Self {
        let free = |name: &String| Side { name: name.clone(), condition: Condition::Free };
        Self {
            name: name.to_owned(),
            sides: outline.side_names().iter().map(free).collect(),
            far: (!outline.is_bounded()).then(FarField::default),
            outline,
            substance,
            grid: None,
            force: None,
        }
    }

    /// Its material; of cells with moduli of their own that of the modulus 1.
    pub fn material(&self) -> Material {
        match &self.substance {
            Substance::Homogeneous(material) => *material,
            Substance::Cells(cells) => cells.of_unit_modulus,
        }
    }

    /// Its cells, where they have moduli of their own.
    pub fn cells(&self) -> Option<&Cells> {
        if let Substance::Cells(cells) = &self.substance { Some(cells) } else { None }
    }

    /// The side of a name.
    pub fn side_mut(&mut self, name: &str) -> Option<&mut Side> {
        self.sides.iter_mut().find(|side| side.name == name)
    }

    /// Its outer loop as that of a hole.
    fn hole(&self) -> Loop {
        let edges = &self.outline.edges()[self.outline.loops()[0].clone()];
        let (corners, sides) = edges.iter().map(|e| (e.listed()[0], self.sides[e.side].name.clone())).unzip();
        Loop { paths: edges.iter().map(|e| e.path).collect(), ..Loop::straight(corners, sides) }
    }
}

impl Problem {
    /// One body, whose sides are all free.
    pub fn new(outline: Polygon, substance: Substance) -> Self {
        Self { bodies: vec![Body::new("body", outline, substance)], interfaces: Vec::new() }
    }

    /// Contact of a side of the first body with a rigid obstacle, in the place of what was there.
    pub fn touch(&mut self, side: usize, contact: Contact) {
        self.interfaces.retain(|i| !(i.body == 0 && i.sides == [side]));
        self.bodies[0].sides[side].condition = Condition::Free;
        let law = Law::Contact(contact);
        self.interfaces.push(Interface { body: 0, sides: vec![side], other: Other::Obstacle, law });
    }

    /// An unbounded medium around the first body, tied to its outer loop.
    ///
    /// # Errors
    /// A loop that outlines no hole.
    pub fn surround(&mut self, material: Material, far: FarField, tie: Tie) -> Result<(), PolygonError> {
        let body = &self.bodies[0];
        let outline = Polygon::outside(vec![body.hole()])?;
        let mut sides: Vec<usize> =
            body.outline.edges()[body.outline.loops()[0].clone()].iter().map(|e| e.side).collect();
        sides.sort_unstable();
        sides.dedup();
        let medium = Body { far: Some(far), ..Body::new("medium", outline, Substance::Homogeneous(material)) };
        self.bodies.truncate(1);
        self.bodies.push(medium);
        self.interfaces.push(Interface { body: 0, sides, other: Other::Body(1), law: Law::Tied(tie) });
        Ok(())
    }

    /// The contact of a side of the first body with a rigid obstacle.
    pub fn contact(&self, side: usize) -> Option<&Contact> {
        self.interfaces.iter().find_map(|interface| match &interface.law {
            Law::Contact(contact) if interface.body == 0 && interface.sides.contains(&side) => Some(contact),
            _ => None,
        })
    }

    /// The unbounded medium, if a body is one.
    pub fn medium(&self) -> Option<&Body> {
        self.bodies.iter().find(|body| body.far.is_some())
    }

    /// What ties the first body to a medium around it.
    pub fn tie(&self) -> Option<&Tie> {
        self.interfaces.iter().find_map(|i| if let Law::Tied(tie) = &i.law { Some(tie) } else { None })
    }

    /// Whether the bodies are those that can be solved: one, or one and the medium around it.
    pub(super) fn check_bodies(&self) -> Result<(), DataError> {
        let refuse =
            |message: String, help: &str| Err(DataError::at(Kind::Unsupported, &[vec!["body"]], message, help));
        let Some(first) = self.bodies.first() else {
            return refuse("there is no body".to_owned(), "give a problem a body");
        };
        for body in &self.bodies {
            if body.outline.is_bounded() == body.far.is_some() || body.sides.len() != body.outline.side_names().len() {
                let message =
                    format!("the body {:?} has not the sides, or not the far field, of its outline", body.name);
                return refuse(message, "make it by Body::new: holes outline a medium, which has a far field");
            }
        }
        let ties = self.interfaces.iter().filter(|i| matches!(i.law, Law::Tied(_))).count();
        let around = match &self.bodies[1..] {
            [] => ties == 0,
            [medium] => {
                let same = medium.outline.loops().len() == 1 && medium.hole().corners == first.hole().corners;
                ties == 1 && medium.far.is_some() && first.far.is_none() && same
            }
            _ => false,
        };
        if !around {
            let names: Vec<&str> = self.bodies.iter().map(|body| body.name.as_str()).collect();
            let message = format!("the bodies {} and {ties} ties cannot be solved at once", names.join(", "));
            return refuse(message, "one body is solved, alone or tied to a medium around its outer loop");
        }
        for interface in &self.interfaces {
            let other = match interface.law {
                Law::Contact(_) => interface.other == Other::Obstacle,
                Law::Tied(_) => interface.other == Other::Body(1),
            };
            if interface.body != 0 || !other || interface.sides.iter().any(|&side| side >= first.sides.len()) {
                let message = format!("an interface of body {} meets {:?}", interface.body, interface.other);
                return refuse(message, "the first body touches obstacles, and is tied to the medium around it");
            }
        }
        Ok(())
    }
}
