//! Interfaces between sides of two bodies: which of them carries the multipliers, and to which the data belong.
//!
//! Displacements and tractions of both places are one another's mirror image, and so is the mesh that carries the multipliers a
//! choice of the discretisation. Data are not: jumps have a sign, s runs along one side, and where the sides are drawn apart what is
//! given in x and y, or per length, differs from one side to the other. Such data are those of the first place, which then carries.

use super::spans::Span;
use super::{DataError, DataErrorKind as Kind, Faces, Friction, Interface, Law, Other, Place, Problem, Side};

/// Number of parts of a visible stretch at whose ends the distance of the other side is tested.
const PARTS: usize = 16;
/// Sine of the angle below which edges are parallel: lengths on both are the same to rounding then.
const PARALLEL: f64 = 1e-8;

impl Problem {
    /// Joins sides of two bodies by a law; `carrier` is the place whose sides carry the multipliers, the better one if none is given.
    /// The interface is the last one then.
    ///
    /// # Errors
    /// Sides that are not there, or have another condition already; sides of one body; sides that do not face each other, or are
    /// tied and do not meet; data that are those of the first place where the second one is to carry.
    pub fn join(
        &mut self,
        first: &[usize],
        second: &[usize],
        law: Law,
        carrier: Option<Place>,
    ) -> Result<&mut Interface, DataError> {
        self.check_places([first, second])?;
        let name = format!("{}-{}", self.sides[first[0]].name, self.sides[second[0]].name);
        let with = |own: &[usize], other: &[usize], place: Place| Interface {
            name: name.clone(),
            sides: own.to_vec(),
            other: Other::Sides(other.to_vec()),
            law: law.clone(),
            place,
            faces: Faces::Own,
        };
        let (forward, backward) = (with(first, second, Place::First), with(second, first, Place::Second));
        let one_body = [first, second].map(|sides| self.bodies_of(sides).len() == 1);
        let of_first = self.data_of_first(&forward);
        let refuse = |place: Place, why: &str, help: &str| {
            let place = if place == Place::First { "first" } else { "second" };
            let message = format!("the {place} place of {name} cannot carry the multipliers: {why}");
            Err(DataError::at(Kind::Conflict, &[vec!["interface"]], message, help))
        };
        let of_several = "it has sides of several bodies";
        let forward_carries = match (carrier, of_first) {
            (Some(Place::Second), Some(what)) => {
                let why = format!("{what} are those of the first one");
                return refuse(Place::Second, &why, "leave multiplier out, or exchange the two places of between");
            }
            (_, Some(what)) if !one_body[0] => {
                let why = format!("{of_several}, and {what} are its own");
                return refuse(Place::First, &why, "exchange the two places of between");
            }
            (Some(place), None) if !one_body[place as usize] => {
                return refuse(place, of_several, "leave multiplier out");
            }
            (_, Some(_)) => true,
            (Some(place), None) => place == Place::First,
            (None, None) if one_body[0] != one_body[1] => one_body[0],
            (None, None) => self.carries_rather(&forward, &backward),
        };
        let chosen = if forward_carries { forward } else { backward };
        // bodies that overlap as they are drawn may be why
        self.check_facing(&chosen).map_err(|(message, help)| match self.check_overlaps() {
            Err((message, help)) => DataError::at(Kind::Geometry, &[vec!["body"]], message, help),
            Ok(()) => DataError::at(Kind::Geometry, &[vec!["interface"]], message, help),
        })?;
        let last = self.interfaces.len();
        self.interfaces.push(chosen);
        Ok(&mut self.interfaces[last])
    }

    /// An interface as another problem has it, the last one then. [`Problem::check_bodies`] judges all of them.
    ///
    /// # Errors
    /// Sides that are not there; with a medium others than all of the outer loop; between bodies as [`Problem::join`], the place that
    /// the interface names carrying.
    pub fn join_as(&mut self, interface: Interface) -> Result<(), DataError> {
        if let Other::Sides(facing) = &interface.other {
            let places = match interface.place {
                Place::First => [&interface.sides, facing],
                Place::Second => [facing, &interface.sides],
            };
            let joined = self.join(places[0], places[1], interface.law, Some(interface.place))?;
            joined.name = interface.name;
            return Ok(());
        }
        if interface.other == Other::Medium && interface.sides != self.outer_sides() {
            let message = "a medium meets some sides of the outer loop only, or others".to_owned();
            let help = "surround the body: a medium is tied to all of its outer loop";
            return Err(DataError::at(Kind::Value, &[vec!["exterior"]], message, help));
        }
        if interface.other == Other::Obstacle {
            self.check_once(interface.sides.iter())?;
        }
        self.interfaces.push(interface);
        Ok(())
    }

    /// Checks that no side of an interface between bodies, or with an obstacle, is in another one or has a condition besides.
    pub(super) fn check_conditions(&self) -> Result<(), DataError> {
        let met = self.interfaces.iter().filter(|interface| interface.other != Other::Medium);
        let sides = met.flat_map(|interface| interface.sides.iter().chain(self.facing_sides(interface)));
        self.check_once(sides)
    }

    /// Checks that sides exist, are free, and are each named once.
    fn check_once<'a>(&self, sides: impl Iterator<Item = &'a usize>) -> Result<(), DataError> {
        let mut found = Vec::new();
        for &side in sides {
            let Some(of_side @ Side { name, .. }) = self.sides.get(side) else {
                let message = format!("there is no side {side}: the problem has {}", self.sides.len());
                return Err(DataError::at(Kind::Value, &[vec!["interface"]], message, "sides are numbered from 0"));
            };
            let refuse = |message: String, help: &str| {
                Err(DataError::at(Kind::Conflict, &[vec!["interface", name], vec!["sides", name]], message, help))
            };
            if found.contains(&side) {
                let message = format!("the side {name:?} is in two conditions of contact or ties");
                let help = "name it once; a side that faces several bodies lists them: between = [\"a.top\", [\"b.bottom\", \"c.bottom\"]]";
                return refuse(message, help);
            }
            if !of_side.is_free() {
                let message = format!("the side {name:?} has a condition in [sides] too");
                let help = "a side of an interface has no other condition: divide the side where the interface ends";
                return refuse(message, help);
            }
            found.push(side);
        }
        Ok(())
    }

    /// Checks that both places are sides of two bodies, free and in no other interface.
    fn check_places(&self, places: [&[usize]; 2]) -> Result<(), DataError> {
        let known = self.interfaces.iter().flat_map(|i| i.sides.iter().chain(self.facing_sides(i)));
        self.check_once(known.chain(places.into_iter().flatten()))?;
        let refuse = |message: String, help: &str| Err(DataError::at(Kind::Value, &[vec!["interface"]], message, help));
        if places.iter().any(|place| place.is_empty()) {
            return refuse("an interface names no side".into(), "name a side of each of two bodies");
        }
        let [of_first, of_second] = places.map(|sides| self.bodies_of(sides));
        let names = || places.map(|sides| self.names(sides)).join(" and ");
        if let Some(&body) = of_first.iter().find(|body| of_second.contains(body)) {
            let message = format!("{} are sides of one body, {:?}", names(), self.bodies[body].name);
            return refuse(message, "an interface lies between two bodies");
        }
        if of_first.len() > 1 && of_second.len() > 1 {
            let message = format!("{} are sides of several bodies on both places", names());
            return refuse(message, "one of the two places has sides of one body: write several interfaces");
        }
        Ok(())
    }

    /// The bodies of sides, rising.
    fn bodies_of(&self, sides: &[usize]) -> Vec<usize> {
        let mut bodies: Vec<usize> = sides.iter().map(|&side| self.body_of_side(side)).collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    }

    /// The data of an interface between sides of bodies that are those of its first place, in words.
    fn data_of_first(&self, interface: &Interface) -> Option<&'static str> {
        let contact = match &interface.law {
            Law::Tied(tie) => {
                return (tie.displacement_jump.is_some() || tie.traction_jump.is_some()).then_some("jumps");
            }
            Law::Contact(contact) => contact,
        };
        let data = contact.data();
        if data.iter().any(|(_, datum)| datum.uses_edge()) {
            return Some("data in s");
        }
        let varies = data.iter().any(|(_, datum)| datum.constant().is_none());
        let bound = matches!(&contact.friction, Friction::Tresca(bound) if bound.constant() != Some(0.0));
        if varies && self.is_apart(interface) {
            return Some("data in x and y of sides that are drawn apart");
        }
        (bound && !self.is_parallel(interface) && self.is_apart(interface))
            .then_some("friction bounds, which are per length, of sides that are drawn apart")
    }

    /// Whether sides that see each other are apart somewhere, farther than what coincides.
    fn is_apart(&self, interface: &Interface) -> bool {
        let near = self.coincidence(interface);
        let beyond = self.mirrored(interface);
        let is_far = |of: &Interface, span: &Span| {
            let at = |k: usize| span.s[0] + (span.s[1] - span.s[0]) * (0.5 + k as f64) / PARTS as f64;
            (0..PARTS).filter_map(|k| self.seen(of, span.edge, at(k))).any(|seen| seen.distance.abs() > near)
        };
        [interface, &beyond].into_iter().any(|of| self.spans(of).iter().any(|span| is_far(of, span)))
    }

    /// Whether all edges of both places are straight and parallel: a length is then the same on both.
    fn is_parallel(&self, interface: &Interface) -> bool {
        let both = self.edges_of(&interface.sides).chain(self.edges_of(self.facing_sides(interface)));
        let edges: Vec<_> = both.map(|(_, edge)| edge).collect();
        let [x, y] = edges[0].normal(0.5);
        let turned = |[a, b]: [f64; 2]| (x * b - y * a).abs() < PARALLEL;
        edges.iter().all(|edge| edge.is_line() && turned(edge.normal(0.5)))
    }
}
