//! `[[body.cracks]]` and the interfaces on them.

use steklov_bem_operators::Polygon;
use steklov_expression::{Expression, Place};
use steklov_problem::{Condition, Contact, Crack, DataErrorKind, Friction, Problem, cut_by_cracks};

use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::keys;
use super::sides::{self, Given};
use super::tree::{Value, suggestion};

/// The cracks that were read: each with its place and the law of its faces, frictionless contact unless the scene gives
/// another law.
#[derive(Default)]
pub(super) struct Cracks {
    all: Vec<(Crack, Place, Option<Contact>)>,
}

impl Cracks {
    /// Reads the cracks of a body and returns its pieces along them; `prefix` begins the names of its sides.
    pub(super) fn cut(&mut self, of_body: &Fields<'_>, prefix: &str, outline: Polygon) -> Result<Polygon, ReadError> {
        let Some(list) = of_body.get("cracks") else { return Ok(outline) };
        let mut own = Vec::new();
        for table in list.list()? {
            let fields = Fields::new(&table, &keys::CRACK)?;
            let points = fields.require("points", "points = [[x, y], [x, y]]")?;
            let points: Vec<[f64; 2]> = points.list()?.iter().map(Field::point).collect::<Result<_, _>>()?;
            if let Some([x, y]) = points.iter().find(|x| !x.iter().all(|c| c.is_finite())) {
                return Err(table.problem(format!("the crack has the point ({x}, {y})"), "write finite coordinates"));
            }
            let name = match fields.get("side") {
                Some(side) => side.text()?.to_owned(),
                None if own.is_empty() => "crack".to_owned(),
                None => format!("crack-{}", own.len() + 1),
            };
            let side = format!("{prefix}{name}");
            let used = outline.side_names().contains(&side) || own.iter().any(|(of, _): &(Crack, _)| of.side == side);
            if used || name.is_empty() || name.contains('.') {
                let message = format!("a crack has the name {name:?}");
                return Err(table.problem(message, "give it a name that no other side has, without dots"));
            }
            own.push((Crack { side, points }, table.item.place));
        }
        let cracks: Vec<Crack> = own.iter().map(|(crack, _)| crack.clone()).collect();
        let pieces = cut_by_cracks(&outline, &cracks)
            .map_err(|(k, message, help)| ReadError::new(DataErrorKind::Geometry, own[k].1, message, help))?;
        let closed = Contact { gap: Expression::number(0.0), friction: Friction::None };
        self.all.extend(own.into_iter().map(|(crack, place)| (crack, place, Some(closed.clone()))));
        Ok(pieces)
    }

    /// Loads both faces of a crack by a pressure, which replaces their contact; returns whether the name is that of a
    /// crack.
    pub(super) fn load(
        &mut self,
        name: &str,
        table: &Field<'_>,
        problem: &mut Problem,
        context: &Context<'_>,
    ) -> Result<bool, ReadError> {
        let Some((_, _, contact)) = self.all.iter_mut().find(|(crack, ..)| crack.side == name) else {
            return Ok(false);
        };
        let Given { condition: Condition::Pressure(pressure), springs: None, .. } = sides::given(table, context)?
        else {
            let message = format!("{name:?} is a crack, and the condition is no pressure");
            let help = "give it a pressure, or write contact in a table [[interface]] with on";
            return Err(ReadError::new(DataErrorKind::Unsupported, table.item.place, message, help));
        };
        *contact = None;
        for face in ["left", "right"] {
            if let Some(side) = problem.side_mut(&format!("{name}.{face}")) {
                side.condition = Condition::Pressure(pressure.clone());
            }
        }
        Ok(true)
    }

    /// Reads a table of `[[interface]]` with `on`; returns whether it is one.
    pub(super) fn interface(&mut self, table: &Field<'_>, context: &Context<'_>) -> Result<bool, ReadError> {
        let fields = Fields::new(table, &keys::INTERFACE)?;
        let Some(on) = fields.get("on") else { return Ok(false) };
        for key in ["between", "tied", "multiplier", "name"] {
            if let Some(field) = fields.get(key) {
                let message = format!("{} stands beside {}", field.name, on.name);
                return Err(ReadError::new(
                    DataErrorKind::Conflict,
                    field.item.place,
                    message,
                    "the faces of a crack are in contact: leave it out",
                ));
            }
        }
        let name = on.text()?;
        let known: Vec<String> = self.all.iter().map(|(crack, ..)| crack.side.clone()).collect();
        let Some((_, _, contact)) = self.all.iter_mut().find(|(crack, ..)| crack.side == name) else {
            let help = suggestion(name, known.iter().map(String::as_str));
            return Err(ReadError::new(Kind::UnknownKey, on.item.place, format!("there is no crack {name:?}"), help));
        };
        let Some(contact) = contact else {
            let help = "leave out one of both: faces that are loaded are not in contact";
            return Err(ReadError::new(
                DataErrorKind::Conflict,
                on.item.place,
                format!("the crack {name:?} has a pressure in [sides] too"),
                help,
            ));
        };
        let law = fields.require("contact", "contact = { friction = { coulomb = \"0.3\" } }")?;
        if !matches!(law.item.value, Value::Boolean(true)) {
            *contact = sides::contact(&law, context)?;
        }
        Ok(true)
    }

    /// Joins the faces, and the pieces beyond the tips.
    pub(super) fn join(self, problem: &mut Problem) {
        problem.join_cracks(self.all.into_iter().map(|(crack, _, contact)| (crack, contact)).collect());
    }
}
