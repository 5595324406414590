//! A field of `[random]`: its covariance, how it is made of germs, and where it lives.

use steklov_bem_operators::Polygon;
use steklov_expression::{Place, RandomField, Support};
use steklov_problem::{Cells, DataErrorKind, Problem, Side, field_cells};
use steklov_stochastic::{
    CellKarhunenLoeve, CellSamples, Covariance, Field as Expansion, FieldCells, Kernel, StochasticError, Truncation,
    Variable,
};

use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Field, Fields};
use super::keys;
use super::method::AUTO;
use super::random::{NORMAL, UNIFORM};
use super::tree::{Value, suggestion};

/// Every family of covariances and its word; a kernel that needs no further number is told with it.
pub(super) const FAMILIES: [(&str, Family); 5] = [
    ("exponential", Family::Kernel(Kernel::Exponential)),
    ("gaussian", Family::Kernel(Kernel::Gaussian)),
    ("matern32", Family::Kernel(Kernel::MATERN_32)),
    ("matern", Family::Matern),
    ("independent", Family::Independent),
];
/// Whether the modes of a field are uniform, by the word of their law.
pub(super) const VARIABLES: [(&str, bool); 2] = [(UNIFORM, true), (NORMAL, false)];
/// Share of the variance of a field that is kept.
pub(super) const CAPTURED: f64 = 0.95;
/// Draws a field as a whole, without truncation.
pub(super) const ALL: &str = "all";
/// Modes of a field that takes as many as there are.
const MANY_MODES: usize = 400;

#[derive(Debug, Clone, Copy)]
pub(super) enum Family {
    Kernel(Kernel),
    Matern,
    Independent,
}

/// A field as declared in the scene.
pub(super) struct DeclaredField {
    /// None: values of different cells are independent.
    covariance: Option<Covariance>,
    modes: Modes,
    pub(super) support: Support,
    uniform: bool,
    place: Place,
}

/// How many modes a field has.
#[derive(Clone, Copy, PartialEq)]
enum Modes {
    Truncated(Truncation),
    /// As many as there are.
    Most,
    /// None: it is drawn as a whole.
    Drawn,
}

impl DeclaredField {
    pub(super) fn read(field: &Field<'_>, polygon: &Polygon) -> Result<Self, ReadError> {
        let fields = Fields::new(field, &keys::FIELD)?;
        let family = fields.require("covariance", "covariance = \"exponential\"")?.choice(&FAMILIES)?;
        if let (Some(smoothness), false) = (fields.get("smoothness"), matches!(family, Family::Matern)) {
            let message = format!("{} stands beside another covariance than \"matern\"", smoothness.name);
            let help = "leave it out, or take covariance = \"matern\"";
            return Err(ReadError::new(DataErrorKind::Conflict, smoothness.item.place, message, help));
        }
        let kernel = match family {
            Family::Kernel(kernel) => Some(kernel),
            Family::Matern => {
                let smoothness = fields.require("smoothness", "smoothness = 1.5")?.number_in(&keys::SMOOTHNESS)?;
                Some(Kernel::Matern { smoothness })
            }
            Family::Independent => None,
        };
        let covariance = match kernel {
            Some(kernel) => Some(Covariance { kernel, correlation: correlation(&fields)? }),
            None => independent(&fields)?,
        };
        let support = support(&fields, polygon)?;
        let modes = modes(&fields, covariance.is_some())?;
        let uniform = fields.get("variables").map(|variables| variables.choice(&VARIABLES)).transpose()?;
        if let (Some(true), Modes::Drawn, Some(_), Some(variables)) =
            (uniform, modes, covariance, fields.get("variables"))
        {
            let message = format!("{} is {UNIFORM:?} beside modes = {ALL:?}", variables.name);
            let help = "a field without truncation is normal: leave variables out, or give a number of modes";
            return Err(ReadError::new(DataErrorKind::Conflict, variables.item.place, message, help));
        }
        let uniform = uniform.unwrap_or(modes != Modes::Drawn);
        Ok(Self { covariance, modes, support, uniform, place: field.item.place })
    }

    /// The field in a scene, and the law of its germs; its expansion is computed here.
    ///
    /// # Errors
    /// An expansion that is impossible; modes that only fields of cells have, in another one.
    pub(super) fn expanded(&self, name: String, problem: &Problem) -> Result<(RandomField, Variable), ReadError> {
        let refused = |e: StochasticError| {
            ReadError::new(DataErrorKind::Value, self.place, format!("the field {name}: {e}"), "change the field")
        };
        let cells = cells_of(problem, &name)?;
        let expansion = match (cells, self.covariance, self.modes) {
            (Some(cells), None, Modes::Drawn) => CellSamples::independent(cells, !self.uniform).map(Expansion::from),
            (Some(cells), None, _) => CellKarhunenLoeve::independent(cells).map(Into::into),
            (Some(cells), Some(covariance), Modes::Drawn) => CellSamples::new(&covariance, cells).map(Into::into),
            (Some(cells), Some(covariance), Modes::Truncated(truncation)) => {
                CellKarhunenLoeve::new(&covariance, cells, truncation).map(Into::into)
            }
            (Some(cells), Some(covariance), Modes::Most) => most_modes(&covariance, &cells).map(Into::into),
            (None, Some(covariance), Modes::Truncated(truncation)) => self.support.expansion(&covariance, truncation),
            (None, covariance, modes) => {
                let (what, help) = match (covariance, modes) {
                    (None, _) => ("is independent from cell to cell", "give it a correlation"),
                    (_, Modes::Drawn) => ("has modes = \"all\"", "give a number of modes, or captured"),
                    _ => ("has modes = \"auto\"", "give a number of modes, or captured"),
                };
                let message = format!("the field {name} {what}, and does not make the moduli of cells");
                return Err(ReadError::new(DataErrorKind::Value, self.place, message, help));
            }
        };
        let expansion = expansion.map_err(refused)?;
        let bound = 3.0f64.sqrt();
        let law = if self.uniform { Variable::uniform(-bound, bound) } else { Variable::normal(0.0, 1.0) };
        let law = law.map_err(refused)?;
        Ok((RandomField { name, expansion, support: self.support.clone() }, law))
    }

    /// A field with more modes than a method can take, while samples take `drawn`.
    pub(super) fn too_many(&self, field: &RandomField, most: usize, drawn: usize) -> ReadError {
        let (name, modes) = (&field.name, field.expansion.len());
        let longest = self.covariance.map_or(String::new(), |Covariance { correlation, .. }| {
            let sides = field.expansion.sides().into_iter().zip(correlation);
            let longest = sides.map(|(side, length)| side / length).fold(0.0, f64::max);
            format!("; its support is {longest} correlation lengths long")
        });
        let message = format!(
            "the field {name} has {modes} modes, more than the {most} germs that this stochastic.method can take{longest}"
        );
        let mut help = match self.covariance {
            Some(_) => "take a longer correlation, modes = 6, or a smaller captured".to_owned(),
            None => "take modes = \"all\", which monte-carlo and multilevel draw".to_owned(),
        };
        if most < drawn {
            help += &format!("; method = \"monte-carlo\" takes up to {drawn}");
        }
        ReadError::new(DataErrorKind::Value, self.place, message, &help)
    }
}

/// The correlation lengths.
fn correlation(fields: &Fields<'_>) -> Result<[f64; 2], ReadError> {
    let correlation = fields.require("correlation", "correlation = a length")?;
    let length = |field: &Field<'_>| field.number_in(&keys::LENGTHS);
    match correlation.item.value {
        Value::Array(_) => {
            let [x, y] = correlation.components()?;
            Ok([length(&x)?, length(&y)?])
        }
        _ => Ok([length(&correlation)?; 2]),
    }
}

/// Refuses what a field without covariance does not have.
fn independent(fields: &Fields<'_>) -> Result<Option<Covariance>, ReadError> {
    match fields.get("correlation").or(fields.get("captured")) {
        None => Ok(None),
        Some(field) => {
            let message = format!("{} stands beside covariance = \"independent\"", field.name);
            Err(ReadError::new(DataErrorKind::Conflict, field.item.place, message, "leave one of the two out"))
        }
    }
}

/// Where the field lives.
fn support(fields: &Fields<'_>, polygon: &Polygon) -> Result<Support, ReadError> {
    let on = fields.require("on", "on = the name of a side, or \"body\"")?;
    let names = polygon.side_names().iter().map(String::as_str).chain(["body"]);
    let word = on.text()?;
    if !names.clone().any(|name| name == word) {
        let message = format!("the body has no side {word:?}");
        return Err(ReadError::new(Kind::UnknownKey, on.item.place, message, suggestion(word, names)));
    }
    if word == "body" {
        return Ok(Support::body(polygon));
    }
    Support::side(polygon, word).map_err(|why| {
        let help = "name its connected parts as sides of their own and give each a field, or take on = \"body\"";
        on.problem(
            format!("{} = {word:?}: the side {why}; a field needs one chain of edges with two ends", on.name),
            help,
        )
    })
}

/// How many modes a field has; one without correlation as many as cells.
fn modes(fields: &Fields<'_>, correlated: bool) -> Result<Modes, ReadError> {
    let (captured, modes) = (fields.get("captured"), fields.get("modes"));
    if let (Some(_), Some(modes)) = (&captured, &modes) {
        let message = format!("{} stands beside captured", modes.name);
        let help = "keep captured or modes, not both";
        return Err(ReadError::new(DataErrorKind::Conflict, modes.item.place, message, help));
    }
    if let Some(modes) = modes {
        return match &modes.item.value {
            Value::Text(text) if text == AUTO => Ok(Modes::Most),
            Value::Text(text) if text == ALL => Ok(Modes::Drawn),
            _ if !correlated => {
                let message = format!("{} is a number beside covariance = \"independent\"", modes.name);
                let help = format!("leave it out: each cell has a germ, or take modes = {ALL:?}");
                Err(ReadError::new(DataErrorKind::Conflict, modes.item.place, message, &help))
            }
            _ => Ok(Modes::Truncated(Truncation::Modes(modes.whole(keys::MODES)?))),
        };
    }
    let captured = captured.map(|captured| captured.number_in(&keys::FRACTION)).transpose()?;
    Ok(match correlated {
        true => Modes::Truncated(Truncation::Captured(captured.unwrap_or(CAPTURED))),
        false => Modes::Most,
    })
}

/// The modes of a field of cells, as many as there are up to [`MANY_MODES`].
///
/// # Errors
/// Those of [`CellKarhunenLoeve::new`].
fn most_modes(covariance: &Covariance, cells: &FieldCells) -> Result<CellKarhunenLoeve, StochasticError> {
    let mut wanted = MANY_MODES;
    loop {
        match CellKarhunenLoeve::new(covariance, cells.clone(), Truncation::Modes(wanted)) {
            Err(StochasticError::Modes { available, .. }) if (1..wanted).contains(&available) => wanted = available,
            Err(StochasticError::Unconverged { .. }) if wanted > 1 => wanted /= 2,
            found => return found,
        }
    }
}

/// The modulus cells of which a field is the means: where it makes their moduli. `None` for other fields, and for cells that do
/// not fit the grid, which is refused later.
///
/// # Errors
/// A field that is elsewhere too, where it would have other values.
fn cells_of(problem: &Problem, name: &str) -> Result<Option<FieldCells>, ReadError> {
    let body = &problem.bodies[0];
    let Some(Cells { size, .. }) = body.cells() else { return Ok(None) };
    if !body.cell_expressions().any(|e| e.uses(name)) {
        return Ok(None);
    }
    let force = body.force.iter().flatten().map(|e| ("body force".to_owned(), e));
    let of_side = |(index, side): (usize, &Side)| {
        let data = problem.side_data(index).into_iter();
        let named = data.map(|(what, e)| (format!("{what} of side {:?}", side.name), e));
        named.collect::<Vec<_>>()
    };
    let sides = problem.sides.iter().enumerate().flat_map(of_side);
    if let Some((what, expression)) = force.chain(sides).find(|(_, e)| e.uses(name)) {
        let message = format!("the {what} uses the field {name}, whose values are means over the modulus cells");
        let help = "declare a second field for it";
        return Err(ReadError::new(DataErrorKind::Conflict, expression.place, message, help));
    }
    Ok(body.grid.as_ref().and_then(|grid| field_cells(&problem.outline, grid, *size)))
}
