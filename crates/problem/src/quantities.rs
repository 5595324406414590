//! Numbers that a scene asks for by names of its own.

use steklov_bem_operators::{Edge, Location, SAME_PLACE};
use steklov_elastic::plane::{cross, dot};
use steklov_expression::Expression;

use super::{DataError, DataErrorKind, Law, Problem, Scene};

/// A number with a name.
#[derive(Debug, Clone)]
pub struct NamedQuantity {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: QuantityKind,
}

/// What a named number is.
#[derive(Debug, Clone)]
pub enum QuantityKind {
    /// -n·σn at a point of the boundary (stress).
    PressureAt([f64; 2]),
    /// (1/L) ∫ u ds over a side of length L: two components (length).
    MeanDisplacement(usize),
    /// ∫ (x - c) × t ds of the traction t with which a support, springs, an obstacle or another body act on a side (force).
    Moment {
        /// The side.
        side: usize,
        /// The point c.
        about: [f64; 2],
    },
    /// ∫ w·t ds of the same traction (stress times length), w two expressions of x and y.
    WeightedForce {
        /// The side.
        side: usize,
        /// Both components of w.
        weight: [Expression; 2],
    },
    /// The distance of the two faces of a crack, or of two surfaces that may touch, in the deformed state (length).
    OpeningAt([f64; 2]),
}

impl QuantityKind {
    /// The group of the JSON object that has it.
    pub fn group(&self) -> &'static str {
        match self {
            Self::PressureAt(_) => "pressure",
            Self::MeanDisplacement(_) => "mean_displacement",
            Self::Moment { .. } => "moment",
            Self::WeightedForce { .. } => "weighted_force",
            Self::OpeningAt(_) => "opening",
        }
    }

    /// The key of a scene by which it is asked for.
    fn key(&self) -> &'static str {
        match self {
            Self::PressureAt(_) => "pressure_at",
            Self::MeanDisplacement(_) => "mean_displacement",
            Self::Moment { .. } => "moment",
            Self::WeightedForce { .. } => "weighted_force",
            Self::OpeningAt(_) => "opening_at",
        }
    }

    /// The side whose force does work, and the field w at a point on which it does: of moments and weighted forces.
    pub fn weighted_side(&self) -> Option<(usize, impl Fn([f64; 2]) -> [f64; 2] + Sync + '_)> {
        let side = match self {
            Self::Moment { side, .. } | Self::WeightedForce { side, .. } => *side,
            _ => return None,
        };
        let w = move |[x, y]: [f64; 2]| match self {
            Self::Moment { about: [u, v], .. } => [v - y, x - u],
            Self::WeightedForce { weight, .. } => weight.each_ref().map(|w| w.eval(x, y, 0.0)),
            _ => [0.0; 2],
        };
        Some((side, w))
    }
}

/// The two surfaces between which a distance is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Surfaces {
    /// A point of a side that may touch an obstacle or another body, by its edge and the parameter there.
    Contact(usize, f64),
    /// A point of both faces of a crack, or of two sides that lie on each other.
    Faces([(usize, f64); 2]),
}

impl Problem {
    /// The edges on which a point lies, with its parameters there.
    pub fn edges_at(&self, x: [f64; 2]) -> Vec<(usize, f64)> {
        let on = |body| match self.outline.location_in(body, x) {
            Location::Boundary { edge, s } => Some((edge, s)),
            _ => None,
        };
        (0..self.outline.bodies().len()).filter_map(on).collect()
    }

    /// The edge whose pressure is meant at a point, with its parameter there: at a corner that of the only side in contact.
    ///
    /// # Errors
    /// None of the point is on the boundary, or two sides with pressures of their own meet there: what is wrong, and what to do.
    pub fn pressed_at(&self, x: [f64; 2]) -> Result<(usize, f64), (String, String)> {
        let edges = self.outline.edges();
        let [u, v] = x;
        let places = self.edges_at(x);
        let Some(&(edge, s)) = places.first() else {
            let message = format!("the point ({u}, {v}) is not on the boundary of a body");
            return Err((message, "a pressure is one of a side: move the point onto it".to_owned()));
        };
        let Some((other, start)) = self.beyond_corner(edge, s) else { return Ok((edge, s)) };
        let touches = |edge: usize| self.contact(edges[edge].side).is_some();
        match [touches(edge), touches(other)] {
            [true, false] => Ok((edge, s)),
            [false, true] => Ok((other, start)),
            _ => {
                let message = format!("at the point ({u}, {v}) two sides meet, each with a pressure of its own");
                Err((message, "move the point a little along the side that is meant".to_owned()))
            }
        }
    }

    /// The edge beyond an end of an edge at which the normal turns, with its parameter there.
    fn beyond_corner(&self, edge: usize, s: f64) -> Option<(usize, f64)> {
        let edges = self.outline.edges();
        let at_end = s >= 1.0 - SAME_PLACE;
        if !at_end && s > SAME_PLACE {
            return None;
        }
        let (other, rising) = self.outline.neighbour(edge, at_end);
        let start = if rising { 0.0 } else { 1.0 };
        let (own, others) = (edges[edge].normal(s), edges[other].normal(start));
        (cross(own, others).abs() > ALIGNED || dot(own, others) < 0.0).then_some((other, start))
    }

    /// Whether a side has a corner at a point.
    fn turns_at(&self, x: [f64; 2]) -> bool {
        let edges = self.outline.edges();
        let beyond = |&(edge, s): &(usize, f64)| Some((edge, self.beyond_corner(edge, s)?.0));
        self.edges_at(x).iter().filter_map(beyond).any(|(edge, other)| edges[edge].side == edges[other].side)
    }

    /// The surfaces whose distance at a point is that of its two sides; none where there is one surface only.
    pub fn surfaces_at(&self, x: [f64; 2]) -> Option<Surfaces> {
        let (mut places, edges) = (self.edges_at(x), self.outline.edges());
        let beyond: Vec<_> = places.iter().filter_map(|&(edge, s)| self.beyond_corner(edge, s)).collect();
        places.extend(beyond);
        let is_seen = |edge: usize, s: f64| {
            let side = edges[edge].side;
            self.contact(side).is_some()
                && self.joint(side).is_none_or(|interface| self.seen(interface, edge, s).is_some())
        };
        if let Some(&(edge, s)) = places.iter().find(|&&(edge, s)| is_seen(edge, s)) {
            return Some(Surfaces::Contact(edge, s));
        }
        let faced = |&(edge, s): &(usize, f64)| {
            let faces = |side: &usize| *side == edges[edge].side;
            let mut of_contact = self.joints().filter(|interface| matches!(interface.law, Law::Contact(_)));
            let interface = of_contact.find(|interface| self.facing_sides(interface).iter().any(faces))?;
            self.seen_from(interface, edge, s).first().copied()
        };
        if let Some((edge, s)) = places.iter().find_map(faced) {
            return Some(Surfaces::Contact(edge, s));
        }
        let opposite = |&[a, b]: &[(usize, f64); 2]| {
            let [m, n] = [a, b].map(|(edge, s): (usize, f64)| edges[edge].normal(s));
            dot(m, n) < 0.0 && cross(m, n).abs() < ALIGNED && !self.is_whole_across(edges[a.0].side)
        };
        let pairs = (1..places.len()).flat_map(|k| (0..k).map(move |i| [i, k]));
        pairs.map(|[i, k]| [places[i], places[k]]).find(opposite).map(Surfaces::Faces)
    }
}

/// Places of an edge less one at which a weight is looked at first.
const WEIGHED: usize = 64;

/// What is wrong with a weight along an edge, and what to do: elements see smooth weights only.
fn wrong_weight(weight: &[Expression; 2], edge: &Edge) -> Option<(String, String)> {
    let at = |s: f64| format!("({}, {})", edge.point(s)[0], edge.point(s)[1]);
    for w in weight {
        let mut places = (0..=WEIGHED).map(|k| k as f64 / WEIGHED as f64);
        let is_wrong = |s: &f64| {
            let [x, y] = edge.point(*s);
            !w.eval(x, y, 0.0).is_finite()
        };
        if let Some(s) = places.find(is_wrong).or_else(|| w.impossible(edge, f64::NEG_INFINITY)) {
            let help = "write a weight that is finite on the whole side".to_owned();
            return Some((format!("its weight is not finite at {}", at(s)), help));
        }
        let inside = |s: &&f64| **s > SAME_PLACE && **s < 1.0 - SAME_PLACE;
        if let Some(&s) = w.along(edge).kinks.iter().find(inside) {
            let help = "write a smooth weight, or cut the side there by a corner of [body] with a name for each part";
            return Some((format!("its weight has a kink or a jump at {}", at(s)), help.to_owned()));
        }
    }
    None
}

/// Sine of the angle up to which two faces lie on each other.
const ALIGNED: f64 = 1e-6;

impl Scene {
    /// Whether the numbers that a scene asks for exist.
    ///
    /// # Errors
    /// The first that does not, with what to change.
    pub(crate) fn check_quantities(&self) -> Result<(), DataError> {
        for NamedQuantity { name, kind } in &self.quantities {
            let refuse = |sort, message: String, help: String| {
                let keys = [vec!["quantities", name, kind.key()], vec!["quantities", name], vec!["quantities"]];
                Err(DataError::at(sort, &keys, message, help))
            };
            let needs_elements = matches!(kind, QuantityKind::PressureAt(_) | QuantityKind::OpeningAt(_));
            if self.is_on_grid() && needs_elements {
                let message = format!("the quantity {name:?} is one of boundary elements, and the body is on a grid");
                let help = "remove it, and ask for points and sides in [probe]".to_owned();
                return refuse(DataErrorKind::Unsupported, message, help);
            }
            if let QuantityKind::WeightedForce { side, .. } = kind
                && self.is_on_grid()
                && !self.problem.sides.get(*side).is_none_or(|own| own.holds(0) || own.holds(1))
            {
                let message = format!("the quantity {name:?}: on a grid a weighted force is that of a support");
                let help = "take a side whose displacement is given, or model = \"bem\"".to_owned();
                return refuse(DataErrorKind::Unsupported, message, help);
            }
            if let Some((message, help)) = self.wrong(kind) {
                return refuse(DataErrorKind::Value, format!("the quantity {name:?}: {message}"), help);
            }
        }
        Ok(())
    }

    /// What is wrong with a quantity, and what to do.
    fn wrong(&self, kind: &QuantityKind) -> Option<(String, String)> {
        let problem = &self.problem;
        let (points, side) = match *kind {
            QuantityKind::PressureAt(x) | QuantityKind::OpeningAt(x) => (Some(x), None),
            QuantityKind::MeanDisplacement(side) | QuantityKind::WeightedForce { side, .. } => (None, Some(side)),
            QuantityKind::Moment { side, about } => (Some(about), Some(side)),
        };
        if let Some([x, y]) = points.filter(|x| x.iter().any(|c| !c.is_finite())) {
            return Some((format!("its point is ({x}, {y})"), "write finite coordinates".to_owned()));
        }
        let count = problem.sides.len();
        if let Some(side) = side.filter(|side| *side >= count) {
            return Some((
                format!("there is no side {side}"),
                format!("sides are numbered from 0, and there are {count}"),
            ));
        }
        match *kind {
            QuantityKind::PressureAt(x) => problem.pressed_at(x).err(),
            QuantityKind::OpeningAt(x) if problem.surfaces_at(x).is_none() => {
                let message = format!("at the point ({}, {}) no second surface faces the first one", x[0], x[1]);
                Some((message, "move the point onto a crack, a contact side or an interface with contact".to_owned()))
            }
            QuantityKind::OpeningAt(x) if problem.turns_at(x) => {
                let message = format!("at the point ({}, {}) the surface turns, and opens by two numbers", x[0], x[1]);
                Some((message, "move the point a little along the part that is meant".to_owned()))
            }
            QuantityKind::Moment { side, .. } | QuantityKind::WeightedForce { side, .. }
                if !self.has_reaction(side) =>
            {
                let name = &problem.sides[side].name;
                let help = "take a side with a support, springs, contact or another body";
                Some((format!("nothing but given loads acts on the side {name:?}"), help.to_owned()))
            }
            QuantityKind::WeightedForce { side, ref weight } => {
                let edges = problem.outline.edges();
                edges.iter().filter(|edge| edge.side == side).find_map(|edge| wrong_weight(weight, edge))
            }
            _ => None,
        }
    }

    /// Whether a support, springs, an obstacle or another body act on a side.
    fn has_reaction(&self, side: usize) -> bool {
        let problem = &self.problem;
        let own = &problem.sides[side];
        let joined =
            || problem.joints().any(|joint| joint.sides.contains(&side) || problem.facing_sides(joint).contains(&side));
        own.holds(0) || own.holds(1) || own.springs.is_some() || problem.contact(side).is_some() || joined()
    }
}
