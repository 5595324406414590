//! `[[body]]` and `[[interface]]`: several bodies and the interfaces between them.

use steklov_bem_operators::Polygon;
use steklov_elastic::Plane;
use steklov_expression::{Expression, nearest};
use steklov_problem::{
    About, Body, Contact, DataError, DataErrorKind, Law, Place, Problem, RandomConstants, Substance, Tie,
};

use super::body::{body, body_force, force, material, medium};
use super::cracks::Cracks;
use super::error::{ReadError, SceneErrorKind as Kind};
use super::exterior::far_field;
use super::fields::{Context, Field, Fields};
use super::tree::{Value, suggestion};
use super::{Read, keys, random, sides};

/// Whether `body` is a list of tables.
pub(super) fn are_several(field: &Field<'_>) -> bool {
    matches!(&field.item.value, Value::Array(_))
}

/// The outline of a body and its tables.
struct Outlined<'a> {
    of_body: Fields<'a>,
    name: &'a str,
    /// Its pieces along cracks.
    count: usize,
}

/// The outlines of several bodies, and their cracks.
fn outlines<'a>(tables: &[Field<'a>], cracks: &mut Cracks) -> Result<(Vec<Outlined<'a>>, Polygon), ReadError> {
    let (mut bodies, mut outlines): (Vec<Outlined<'a>>, Vec<Polygon>) = (Vec::new(), Vec::new());
    for table in tables {
        let of_body = Fields::new(table, &keys::BODIES)?;
        let field = of_body.require("name", "name = \"upper\"")?;
        let name = field.text()?;
        if name.is_empty() || name.contains('.') {
            return Err(field.problem(format!("{} is {name:?}", field.name), "a name has no dots and is not empty"));
        }
        if bodies.iter().any(|body| body.name == name) {
            return Err(field.problem(format!("two bodies have the name {name:?}"), "give each body its own name"));
        }
        if let Some(field) = of_body.get("grid") {
            let message = format!("{} cannot be solved among several bodies", field.name);
            return Err(ReadError::new(DataErrorKind::Unsupported, field.item.place, message, "leave it out"));
        }
        let outline = match of_body.get("medium") {
            Some(field_of_medium) => {
                Fields::new(&field_of_medium, &keys::MEDIUM)?;
                check_medium(&of_body, (name, &field), &bodies)?;
                medium(&of_body)?
            }
            None => body(&of_body, false)?,
        };
        let outline = cracks.cut(&of_body, &format!("{name}."), outline.with_body_name(name))?;
        bodies.push(Outlined { of_body, name, count: outline.bodies().len() });
        outlines.push(outline);
    }
    Ok((bodies, Polygon::assembly(outlines)))
}

/// The problem of several bodies: `[[body]]`, `[sides.BODY.SIDE]`, `[[interface]]`.
pub(super) fn problem(fields: &Fields<'_>, context: &mut Context<'_>) -> Result<Read, ReadError> {
    let list = fields.require("body", "[[body]] with name, corners and sides")?;
    let tables = list.list()?;
    if tables.is_empty() {
        return Err(list.problem("body lists no body", "write a table [[body]] with name, corners and sides for each"));
    }
    for key in ["exterior", "grid"] {
        if let Some(field) = fields.get(key) {
            let message = format!("{} and several bodies cannot be solved together", field.name);
            let help = match key {
                "exterior" => "write the medium as a [[body]] with a name, medium = {} and [[body.holes]]",
                _ => "leave it out, or solve one body",
            };
            return Err(ReadError::new(DataErrorKind::Unsupported, field.item.place, message, help));
        }
    }
    let mut cracks = Cracks::default();
    let (outlined, outline) = outlines(&tables, &mut cracks)?;
    let declared = match fields.get("random") {
        Some(field) => random::random(&field, &outline, context)?,
        None => Vec::new(),
    };
    context.used.take();
    let context = &*context;
    let mut constants = RandomConstants::default();
    let mut bodies: Vec<Body> = Vec::new();
    for (of, table) in outlined.iter().zip(&tables) {
        let own = Body::new(of.name, Substance::Homogeneous(own_material(&of.of_body, fields, &declared, context)?));
        let far = of.of_body.get("medium").map(|field| Fields::new(&field, &keys::MEDIUM)).transpose()?;
        if let Some(medium) = &far {
            constants.remote_stress = random::varying_stress(medium, &declared, context)?;
        }
        let own = Body { far: far.map(|medium| far_field(&medium, context)).transpose()?, ..own };
        let plane = |body: &Body| body.material().plane;
        if let Some(first) = bodies.first().filter(|first| plane(first) != plane(&own)) {
            let word = |body: &Body| if plane(body) == Plane::Strain { "strain" } else { "stress" };
            let message =
                format!("{:?} is in plane {}, {:?} in plane {}", first.name, word(first), of.name, word(&own));
            return Err(table.problem(message, "bodies that meet are all in plane strain, or all in plane stress"));
        }
        if let Some(young) =
            random::varying(&Fields::open(&material_of(&of.of_body, fields)?)?, "young", &declared, context)?
        {
            constants.young.extend((bodies.len()..bodies.len() + of.count).map(|body| (body, young.clone())));
        }
        bodies.extend(pieces(&own, of.count));
    }
    let in_material = context.used.take();
    let forces = fields.get("body_force").map(|f| body_force(&f, context)).transpose()?;
    let mut first = 0;
    for of in &outlined {
        let own = of.of_body.get("body_force").map(|f| force(&f, context)).transpose()?;
        for body in bodies[first..first + of.count].iter_mut().filter(|body| body.far.is_none()) {
            body.force = own.clone().or_else(|| forces.clone());
        }
        first += of.count;
    }
    context.used.take();
    let names: Vec<&str> = outlined.iter().map(|of| of.name).collect();
    let mut problem = Problem::of_bodies(outline, bodies);
    if let Some(field) = fields.get("sides") {
        conditions(&field, &names, (&mut problem, &mut cracks), context)?;
    }
    if let Some(field) = fields.get("interface") {
        for table in field.list()? {
            if !cracks.interface(&table, context)? {
                interface(&table, &mut problem, context)?;
            }
        }
    }
    cracks.join(&mut problem);
    Ok(Read { problem, declared, constants, in_material })
}

/// Refuses a medium beside another one of the `others`, and what it cannot have.
fn check_medium(
    of_body: &Fields<'_>,
    (name, field): (&str, &Field<'_>),
    others: &[Outlined<'_>],
) -> Result<(), ReadError> {
    if let Some(other) = others.iter().find(|other| other.of_body.get("medium").is_some()) {
        let message = format!("{name:?} and {:?} are both media, and both would fill the plane", other.name);
        return Err(field.problem(message, "give one of them corners and sides: a bounded body"));
    }
    let refused = [
        (
            "body_force",
            "an unbounded medium cannot carry a body force",
            "give the stress that it makes as medium.remote_stress",
        ),
        ("cracks", "a medium cannot have cracks", "write a bounded body around the crack that is tied to the medium"),
    ];
    for (key, message, help) in refused {
        if let Some(field) = of_body.get(key) {
            return Err(ReadError::new(DataErrorKind::Unsupported, field.item.place, message, help));
        }
    }
    Ok(())
}

/// A body in `count` pieces.
pub(super) fn pieces(body: &Body, count: usize) -> Vec<Body> {
    let name = |k: usize| if count == 1 { body.name.clone() } else { format!("{} {}", body.name, k + 1) };
    (0..count).map(|k| Body { name: name(k), ..body.clone() }).collect()
}

/// The table of the material of a body, or else of the scene.
fn material_of<'a>(of_body: &Fields<'a>, fields: &Fields<'a>) -> Result<Field<'a>, ReadError> {
    match of_body.get("material") {
        Some(field) => Ok(field),
        None => fields
            .require("material", "material = { young = 200.0, poisson = 0.3 } in each [[body]], or one [material]"),
    }
}

/// The nominal material of a body.
fn own_material<'a>(
    of_body: &Fields<'a>,
    fields: &Fields<'a>,
    declared: &[(String, random::Declared)],
    context: &Context<'_>,
) -> Result<steklov_elastic::Material, ReadError> {
    let field = material_of(of_body, fields)?;
    let of_material = Fields::new(&field, &keys::MATERIAL)?;
    if let Some(cells) = of_material.get("cells") {
        let message = format!("{} cannot be solved among several bodies", cells.name);
        return Err(ReadError::new(DataErrorKind::Unsupported, cells.item.place, message, "give one Young's modulus"));
    }
    random::check_poisson(&field, declared, context)?;
    let young = of_material.require("young", "young = 200.0, in the scene's unit of stress")?.constant(context)?;
    material(&of_material, context, young)
}

/// `[sides.BODY.SIDE]`.
fn conditions(
    field: &Field<'_>,
    names: &[&str],
    (problem, cracks): (&mut Problem, &mut Cracks),
    context: &Context<'_>,
) -> Result<(), ReadError> {
    for (name, place, of_body) in Fields::open(field)?.all() {
        if !names.contains(&name) {
            let message = format!("there is no body {name:?}");
            let help = suggestion(name, names.iter().copied());
            return Err(ReadError::new(Kind::UnknownKey, place, message, help));
        }
        for (side, place, table) in Fields::open(&of_body)?.all() {
            let full = format!("{name}.{side}");
            if cracks.load(&full, &table, problem, context)? {
                continue;
            }
            let Some(index) = problem.side(&full) else {
                let own = problem.sides.iter().filter_map(|side| side.name.strip_prefix(&format!("{name}.")));
                let help = suggestion(side, own.collect::<Vec<_>>().into_iter());
                return Err(ReadError::new(
                    Kind::UnknownKey,
                    place,
                    format!("the body {name:?} has no side {side:?}"),
                    help,
                ));
            };
            sides::given(&table, context)?.to(problem, index);
        }
    }
    Ok(())
}

/// Help for a name that no side has: a similar name on the named body, else the sides of that body; without such a
/// body, the most similar whole name.
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

/// The sides of a name or a list of names, and these names.
fn named_sides<'a>(field: &Field<'a>, problem: &Problem) -> Result<(Vec<usize>, Vec<Field<'a>>), ReadError> {
    let names = if matches!(field.item.value, Value::Array(_)) {
        field.list()?
    } else {
        vec![Field { name: field.name.clone(), item: field.item }]
    };
    if names.is_empty() {
        return Err(field.problem(format!("{} names no side", field.name), "write \"BODY.SIDE\""));
    }
    let side = |name: &Field<'_>| {
        let text = name.text()?;
        problem.side(text).ok_or_else(|| {
            let message = format!("there is no side {text:?}");
            ReadError::new(Kind::UnknownKey, name.item.place, message, side_like(text, problem))
        })
    };
    Ok((names.iter().map(side).collect::<Result<_, _>>()?, names))
}

/// The error of an interface at its place: at the last name that it is about, else at the list of joined sides.
fn placed(error: DataError, between: &Field<'_>, names: &[&Field<'_>]) -> ReadError {
    let About::Keys(keys) = &error.about else { return error.into() };
    let place = match keys[0].iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["interface", side] => {
            names
                .iter()
                .rfind(|name| name.text().is_ok_and(|text| text == side))
                .map_or(between, |name| name)
                .item
                .place
        }
        ["interface"] => between.item.place,
        _ => return error.into(),
    };
    DataError { about: About::Text(place), ..error }.into()
}

/// A table of `[[interface]]`.
fn interface(field: &Field<'_>, problem: &mut Problem, context: &Context<'_>) -> Result<(), ReadError> {
    let fields = Fields::new(field, &keys::INTERFACE)?;
    let between = fields.require("between", "between = [\"a.top\", \"b.bottom\"]")?;
    let [first, second] = between.pair("one for each of the two bodies that meet")?;
    let ((a, of_a), (b, of_b)) = (named_sides(&first, problem)?, named_sides(&second, problem)?);
    let law = law(&fields, context)?;
    let carrier = fields.get("multiplier").map(|field| {
        let text = field.text()?;
        let place = |(sides, place): (&[usize], Place)| {
            sides.iter().any(|&side| problem.sides[side].name == text).then_some(place)
        };
        [(&a[..], Place::First), (&b, Place::Second)].into_iter().find_map(place).ok_or_else(|| {
            let message = format!("{} is {text:?}, which is no side of the interface", field.name);
            field.problem(message, "name one of the two sides")
        })
    });
    let names: Vec<&Field<'_>> = of_a.iter().chain(&of_b).collect();
    let joined = problem.join(&a, &b, law, carrier.transpose()?).map_err(|error| placed(error, &between, &names))?;
    if let Some(name) = fields.get("name") {
        joined.name = name.text()?.to_owned();
    }
    Ok(())
}

/// The law of an interface.
fn law(fields: &Fields<'_>, context: &Context<'_>) -> Result<Law, ReadError> {
    match (fields.get("contact"), fields.get("tied")) {
        (Some(_), Some(tied)) => Err(ReadError::new(
            DataErrorKind::Conflict,
            tied.item.place,
            "an interface is either in contact or tied".to_owned(),
            "remove contact or tied",
        )),
        (None, None) => Err(ReadError::new(
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
