//! `[[body]]` and `[[interface]]`: several bodies and what acts between them.

use steklov_bem_operators::Polygon;
use steklov_elastic::Plane;
use steklov_expression::{Expression, nearest};
use steklov_problem::{
    Body, Condition, Contact, DataError, DataErrorKind as Kind, FarField, Interface, Law, Other, Problem, Substance,
    Tie,
};

use super::body::{body, body_force, force, material, medium};
use super::cracks::Cracks;
use super::exterior::far_field;
use super::fields::{Context, Field, Fields};
use super::keys;
use super::sides::{self, Given};
use super::tree::{Value, suggestion};

/// Whether `body` is a list of tables.
pub(super) fn are_several(field: &Field<'_>) -> bool {
    matches!(&field.item.value, Value::Array(_))
}

/// The problem of several bodies: `[[body]]`, `[sides.BODY.SIDE]`, `[[interface]]`.
pub(super) fn problem(fields: &Fields<'_>, context: &Context<'_>) -> Result<Problem, DataError> {
    let tables = fields.require("body", "[[body]] with name, corners and sides")?.list()?;
    for key in ["exterior", "grid", "random"] {
        if let Some(field) = fields.get(key) {
            let message = format!("{} and several bodies cannot be solved together", field.name);
            let help = match key {
                "exterior" => "write the medium as a [[body]] with a name, medium = {} and [[body.holes]]",
                _ => "leave it out, or solve one body",
            };
            return Err(DataError::new(Kind::Unsupported, field.item.place, message, help));
        }
    }
    let forces = fields.get("body_force").map(|f| body_force(&f, context)).transpose()?;
    let (mut bodies, mut outlines): (Vec<Body>, Vec<Polygon>) = (Vec::new(), Vec::new());
    let (mut names, mut cracks): (Vec<&str>, Cracks) = (Vec::new(), Cracks::default());
    for table in &tables {
        let of_body = Fields::new(table, &keys::BODIES)?;
        let field = of_body.require("name", "name = \"upper\"")?;
        let name = field.text()?;
        if name.is_empty() || name.contains('.') {
            return Err(field.problem(format!("{} is {name:?}", field.name), "a name has no dots and is not empty"));
        }
        if names.contains(&name) {
            return Err(field.problem(format!("two bodies have the name {name:?}"), "give each body its own name"));
        }
        names.push(name);
        if let Some(field) = of_body.get("grid") {
            let message = format!("{} cannot be solved among several bodies", field.name);
            return Err(DataError::new(Kind::Unsupported, field.item.place, message, "leave it out"));
        }
        let far = far(&of_body, (name, &field), &bodies, context)?;
        let own_force = of_body.get("body_force").map(|f| force(&f, context)).transpose()?;
        let outline = if far.is_some() { medium(&of_body)? } else { body(&of_body, false)? };
        let outline = cracks.cut(&of_body, &format!("{name}."), outline.with_body_name(name))?;
        let force = own_force.or_else(|| forces.clone()).filter(|_| far.is_none());
        let substance = Substance::Homogeneous(own_material(&of_body, fields, context)?);
        let own = Body { force, far, ..Body::new(name, substance) };
        let plane = |body: &Body| body.material().plane;
        if let Some(first) = bodies.first().filter(|first| plane(first) != plane(&own)) {
            let word = |body: &Body| if plane(body) == Plane::Strain { "strain" } else { "stress" };
            let message = format!("{:?} is in plane {}, {name:?} in plane {}", first.name, word(first), word(&own));
            return Err(table.problem(message, "bodies that meet are all in plane strain, or all in plane stress"));
        }
        bodies.extend(pieces(&own, outline.bodies().len()));
        outlines.push(outline);
    }
    let mut problem = Problem::of_bodies(Polygon::assembly(outlines), bodies);
    if let Some(field) = fields.get("sides") {
        conditions(&field, &names, (&mut problem, &mut cracks), context)?;
    }
    hold_media(&mut problem);
    if let Some(field) = fields.get("interface") {
        for table in field.list()? {
            if !cracks.interface(&table, context)? {
                let interface = interface(&table, &problem, context)?;
                problem.interfaces.push(interface);
            }
        }
    }
    cracks.join(&mut problem);
    Ok(problem)
}

/// What a body does far away, if it is a medium: none among the `others` is one.
fn far(
    of_body: &Fields<'_>,
    (name, field): (&str, &Field<'_>),
    others: &[Body],
    context: &Context<'_>,
) -> Result<Option<FarField>, DataError> {
    let far = match of_body.get("medium") {
        Some(field) => Some(far_field(&Fields::new(&field, &keys::MEDIUM)?, context)?),
        None => return Ok(None),
    };
    if let Some(other) = others.iter().find(|body| body.far.is_some()) {
        let message = format!("{name:?} and {:?} are both media, and both would fill the plane", other.name);
        return Err(field.problem(message, "give one of them corners and sides: a bounded body"));
    }
    if let Some(field) = of_body.get("body_force") {
        let help = "give the stress that it makes as medium.remote_stress";
        return Err(DataError::new(
            Kind::Unsupported,
            field.item.place,
            "an unbounded medium cannot carry a body force",
            help,
        ));
    }
    if let Some(field) = of_body.get("cracks") {
        let help = "write a bounded body around the crack that is tied to the medium";
        return Err(DataError::new(Kind::Unsupported, field.item.place, "a medium cannot have cracks", help));
    }
    Ok(far)
}

/// A body in as many pieces.
pub(super) fn pieces(body: &Body, count: usize) -> Vec<Body> {
    let name = |k: usize| if count == 1 { body.name.clone() } else { format!("{} {}", body.name, k + 1) };
    (0..count).map(|k| Body { name: name(k), ..body.clone() }).collect()
}

/// A medium that supports or obstacles hold is bounded at infinity, unless the scene states what it does.
fn hold_media(problem: &mut Problem) {
    let holds = |side: usize| {
        matches!(problem.sides[side].condition, Condition::Displacement { .. }) || problem.contact(side).is_some()
    };
    let held: Vec<bool> = (0..problem.bodies.len())
        .map(|body| (0..problem.sides.len()).any(|side| problem.body_of_side(side) == body && holds(side)))
        .collect();
    for (body, _) in problem.bodies.iter_mut().zip(held).filter(|(_, held)| *held) {
        body.far.iter_mut().for_each(FarField::bounded_by_supports);
    }
}

/// The material of a body, or that of the scene.
fn own_material(
    of_body: &Fields<'_>,
    fields: &Fields<'_>,
    context: &Context<'_>,
) -> Result<steklov_elastic::Material, DataError> {
    let field = match of_body.get("material") {
        Some(field) => field,
        None => fields
            .require("material", "material = { young = 200.0, poisson = 0.3 } in each [[body]], or one [material]")?,
    };
    if let Some(cells) = Fields::new(&field, &keys::MATERIAL)?.get("cells") {
        let message = format!("{} cannot be solved among several bodies", cells.name);
        return Err(DataError::new(Kind::Unsupported, cells.item.place, message, "give one Young's modulus"));
    }
    let fields = Fields::new(&field, &keys::MATERIAL)?;
    let young = fields.require("young", "young = 200.0, in the scene's unit of stress")?.constant(context)?;
    material(&fields, context, young)
}

/// `[sides.BODY.SIDE]`.
fn conditions(
    field: &Field<'_>,
    names: &[&str],
    (problem, cracks): (&mut Problem, &mut Cracks),
    context: &Context<'_>,
) -> Result<(), DataError> {
    for (name, place, of_body) in Fields::open(field)?.all() {
        if !names.contains(&name) {
            let message = format!("there is no body {name:?}");
            let help = suggestion(name, names.iter().copied());
            return Err(DataError::new(Kind::UnknownKey, place, message, help));
        }
        for (side, place, table) in Fields::open(&of_body)?.all() {
            let full = format!("{name}.{side}");
            if cracks.load(&full, &table, problem, context)? {
                continue;
            }
            let Some(index) = problem.sides.iter().position(|side| side.name == full) else {
                let own = problem.sides.iter().filter_map(|side| side.name.strip_prefix(&format!("{name}.")));
                let help = suggestion(side, own.collect::<Vec<_>>().into_iter());
                return Err(DataError::new(
                    Kind::UnknownKey,
                    place,
                    format!("the body {name:?} has no side {side:?}"),
                    help,
                ));
            };
            match sides::given(&table, context)? {
                Given::Condition(condition) => problem.sides[index].condition = condition,
                Given::Contact(contact) => problem.touch(index, contact),
            }
        }
    }
    Ok(())
}

/// Help for a name that no side has: one like it on the body that is named, else the sides of that body; without that body the
/// whole name most like it.
fn side_like(text: &str, problem: &Problem) -> String {
    let names = problem.sides.iter().map(|side| side.name.as_str());
    let Some((body, side)) = text.rsplit_once('.') else { return suggestion(text, names) };
    let own: Vec<&str> = names.clone().filter_map(|name| name.strip_prefix(body)?.strip_prefix('.')).collect();
    match (nearest(side, own.iter().copied()), own.is_empty()) {
        (Some(near), _) => format!("did you mean {body}.{near}?"),
        (None, true) => suggestion(text, names),
        (None, false) => format!("the sides of {body} are {}", own.join(", ")),
    }
}

/// The sides that a name or a list of names means, all of one body or, where `several`, of some.
fn named_sides(field: &Field<'_>, problem: &Problem) -> Result<Vec<usize>, DataError> {
    let names = if matches!(field.item.value, Value::Array(_)) {
        field.list()?
    } else {
        vec![Field { name: field.name.clone(), item: field.item }]
    };
    let mut found = Vec::new();
    for name in &names {
        let text = name.text()?;
        let Some(side) = problem.sides.iter().position(|side| side.name == text) else {
            let message = format!("there is no side {text:?}");
            return Err(DataError::new(Kind::UnknownKey, name.item.place, message, side_like(text, problem)));
        };
        let twice =
            problem.interfaces.iter().any(|i| i.sides.contains(&side) || problem.facing_sides(i).contains(&side));
        if twice || found.contains(&side) {
            let message = format!("the side {text:?} is in two conditions of contact or ties");
            let help = "name it once; a side that faces several bodies lists them: between = [\"a.top\", [\"b.bottom\", \"c.bottom\"]]";
            return Err(DataError::new(Kind::Conflict, name.item.place, message, help));
        }
        if !matches!(problem.sides[side].condition, Condition::Free) {
            let message = format!("the side {text:?} has a condition in [sides] too");
            let help = "a side of an interface has no other condition: divide the side where the interface ends";
            return Err(DataError::new(Kind::Conflict, name.item.place, message, help));
        }
        found.push(side);
    }
    if found.is_empty() {
        return Err(field.problem(format!("{} names no side", field.name), "write \"BODY.SIDE\""));
    }
    Ok(found)
}

/// A table of `[[interface]]`.
fn interface(field: &Field<'_>, problem: &Problem, context: &Context<'_>) -> Result<Interface, DataError> {
    let fields = Fields::new(field, &keys::INTERFACE)?;
    let between = fields.require("between", "between = [\"a.top\", \"b.bottom\"]")?;
    let [first, second] = between.pair("one for each of the two bodies that meet")?;
    let [a, b] = [named_sides(&first, problem)?, named_sides(&second, problem)?];
    let bodies = |sides: &[usize]| {
        let mut bodies: Vec<usize> = sides.iter().map(|&side| problem.body_of_side(side)).collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    };
    let [of_a, of_b] = [bodies(&a), bodies(&b)];
    if let Some(&body) = of_a.iter().find(|body| of_b.contains(body)) {
        let message = format!("{} are sides of one body, {:?}", between.name, problem.bodies[body].name);
        return Err(between.problem(message, "an interface lies between two bodies"));
    }
    if of_a.len() > 1 && of_b.len() > 1 {
        let message = format!("{} lists sides of several bodies on both places", between.name);
        return Err(between.problem(message, "one of the two places has sides of one body: write several interfaces"));
    }
    let law = law(&fields, context)?;
    let name = match fields.get("name") {
        Some(name) => name.text()?.to_owned(),
        None => format!("{}-{}", problem.sides[a[0]].name, problem.sides[b[0]].name),
    };
    let with = |own: &[usize], other: &[usize], second: bool| Interface {
        name: name.clone(),
        sides: own.to_vec(),
        other: Other::Sides(other.to_vec()),
        law: law.clone(),
        second,
        cut: false,
    };
    let (forward, backward) = (with(&a, &b, false), with(&b, &a, true));
    let carrier = fields.get("multiplier").map(|field| {
        let text = field.text()?;
        let named = |sides: &[usize]| sides.iter().any(|&side| problem.sides[side].name == text);
        match (named(&a), named(&b)) {
            (true, _) => Ok(true),
            (_, true) => Ok(false),
            _ => Err(field.problem(
                format!("{} is {text:?}, which is no side of the interface", field.name),
                "name one of the two sides",
            )),
        }
    });
    let one_body = [of_a.len() == 1, of_b.len() == 1];
    // jumps have a sign, and s a side
    let of_first = match &law {
        Law::Tied(tie) => tie.displacement_jump.is_some() || tie.traction_jump.is_some(),
        Law::Contact(contact) => contact.data().iter().any(|(_, datum)| datum.uses_edge()),
    };
    let forward_carries = match carrier.transpose()? {
        Some(true) if one_body[0] => true,
        Some(false) if one_body[1] && !of_first => false,
        Some(_) => {
            let message = "this side cannot carry the multipliers: it is of several bodies, or jumps, or data in s, are those of the other one";
            return Err(between.problem(message, "leave multiplier out, or exchange the two places of between"));
        }
        None if of_first && !one_body[0] => {
            return Err(between.problem(
                "jumps and data in s are those of the first place, which has sides of several bodies",
                "exchange the two places of between",
            ));
        }
        None if one_body == [true, false] || of_first => true,
        None if one_body == [false, true] => false,
        None => problem.carries_rather(&forward, &backward),
    };
    let chosen = if forward_carries { forward } else { backward };
    // bodies that overlap as they are drawn may be why
    problem.check_facing(&chosen).map_err(|(message, help)| match problem.check_overlaps() {
        Err((message, help)) => DataError::at(Kind::Geometry, &[vec!["body"]], message, help),
        Ok(()) => DataError::new(Kind::Geometry, between.item.place, message, help),
    })?;
    Ok(chosen)
}

/// The law of an interface.
fn law(fields: &Fields<'_>, context: &Context<'_>) -> Result<Law, DataError> {
    match (fields.get("contact"), fields.get("tied")) {
        (Some(_), Some(tied)) => Err(DataError::new(
            Kind::Conflict,
            tied.item.place,
            "an interface is either in contact or tied".to_owned(),
            "remove contact or tied",
        )),
        (None, None) => Err(DataError::new(
            Kind::MissingKey,
            fields.place,
            "the interface has no law".to_owned(),
            "add tied = true, or contact = { gap = \"0\", friction = { coulomb = \"0.3\" } }",
        )),
        (Some(contact), None) => {
            let contact: Contact = match &contact.item.value {
                Value::Boolean(true) => {
                    Contact { gap: Expression::number(0.0), friction: steklov_problem::Friction::None }
                }
                _ => sides::contact(&contact, context)?,
            };
            Ok(Law::Contact(contact))
        }
        (None, Some(tied)) => {
            let tie = match &tied.item.value {
                Value::Boolean(true) => Tie::default(),
                Value::Table(_) => {
                    let of = Fields::new(&tied, &keys::TIED)?;
                    let pair = |key: &str| of.get(key).map(|field| field.expressions(context)).transpose();
                    Tie {
                        displacement_jump: pair("displacement_jump")?,
                        traction_jump: pair("traction_jump")?,
                        stress_jump: None,
                    }
                }
                _ => return Err(tied.wrong_type("true, or a table with displacement_jump and traction_jump")),
            };
            Ok(Law::Tied(tie))
        }
    }
}
