//! A list of expressions, to which the parts of a problem refer by number.

use std::collections::BTreeMap;
use std::sync::Arc;

use hdf5::Group;
use steklov_problem::steklov_expression::{Expression, Profile, Value};

use crate::array::{load_integers, load_points, load_vector, save_integers, save_points, save_vector};
use crate::dataset::label;
use crate::error::{IoError, invalid};
use crate::persist::{create_group, open_group};
use crate::problem::check_finite;
use crate::quadrature::check_length;
use crate::text::{load_texts, save_texts};

/// Name of their group.
const EXPRESSIONS: &str = "expressions";
/// Name of the group of profiles in it.
const PROFILES: &str = "profiles";

/// Expressions, numbered in the order in which they come, from 1; 0 is none.
#[derive(Default)]
pub(crate) struct Numbering<'a>(Vec<&'a Expression>);

impl<'a> Numbering<'a> {
    /// The number of an expression.
    pub(crate) fn of(&mut self, expression: Option<&'a Expression>) -> usize {
        let Some(expression) = expression else { return 0 };
        self.0.push(expression);
        self.0.len()
    }

    /// The numbers of both components, 0 for both if there are none.
    pub(crate) fn of_pair(&mut self, pair: Option<&'a [Expression; 2]>) -> [usize; 2] {
        [0, 1].map(|k| self.of(pair.map(|pair| &pair[k])))
    }

    /// Writes texts, names and values.
    pub(crate) fn save(&self, at: &Group) -> Result<(), IoError> {
        let at = create_group(at, EXPRESSIONS)?;
        let (mut texts, mut first, mut names, mut values) = (Vec::new(), vec![0], Vec::new(), Vec::new());
        let mut profiles = Profiles::default();
        for expression in &self.0 {
            for (name, value) in expression.names().iter().zip(expression.values()) {
                let (number, value) = match value {
                    Value::Constant(value) => (0, *value),
                    Value::Profile(profile) => (profiles.number(profile), 0.0),
                    Value::Field(_) | Value::Free(_) => {
                        let why = format!("{name} of {:?} is a random field, which is not stored", expression.text());
                        return Err(invalid(&at, "values", why));
                    }
                };
                profiles.of_names.push(number);
                names.push(name.clone());
                values.push(value);
            }
            texts.push(expression.text().to_owned());
            first.push(names.len());
        }
        save_texts(&at, "texts", &texts, "expressions of x, y, s and names", "expression")?;
        let meaning = "where the names of each expression begin among names and values, and the end";
        save_integers(&at, "first", &first, &label("1", meaning, &["expression"]))?;
        save_texts(&at, "names", &names, "names of parameters, random input and profiles that it uses", "name")?;
        let meaning = "values of these names; random input at its mean, profiles 0";
        save_vector(&at, "values", &values, &label("1", meaning, &["name"]))?;
        if profiles.all.is_empty() { Ok(()) } else { profiles.save(&at) }
    }
}

/// The profiles of expressions, each once, numbered from 1; 0 is none.
#[derive(Default)]
struct Profiles {
    all: Vec<Arc<Profile>>,
    /// The numbers of the names of all expressions.
    of_names: Vec<usize>,
}

impl Profiles {
    /// The number of a profile.
    fn number(&mut self, profile: &Arc<Profile>) -> usize {
        let known = self.all.iter().position(|other| other == profile);
        1 + known.unwrap_or_else(|| {
            self.all.push(profile.clone());
            self.all.len() - 1
        })
    }

    /// Writes the knots of all, one after the other.
    fn save(&self, at: &Group) -> Result<(), IoError> {
        let at = create_group(at, PROFILES)?;
        let meaning = "number of the profile of each name of expressions, from 1; 0 is none";
        save_integers(&at, "of_names", &self.of_names, &label("1", meaning, &["name"]))?;
        let (mut first, mut positions, mut values, mut slopes) = (vec![0], Vec::new(), Vec::new(), Vec::new());
        for profile in &self.all {
            positions.extend_from_slice(profile.positions());
            values.extend_from_slice(profile.values());
            slopes.extend_from_slice(profile.slopes());
            first.push(positions.len());
        }
        let meaning = "where the knots of each profile begin among positions and values, and the end";
        save_integers(&at, "first", &first, &label("1", meaning, &["profile"]))?;
        save_vector(&at, "positions", &positions, &label("1", "positions of the knots, rising", &["knot"]))?;
        save_vector(&at, "values", &values, &label("1", "values at the knots", &["knot"]))?;
        save_points(&at, "slopes", &slopes, &label("1", "slopes before and behind each knot", &["knot", "side"]))
    }

    /// Reads what [`Profiles::save`] wrote; none in a file without them.
    fn load(at: &Group, names: usize) -> Result<Self, IoError> {
        if !at.link_exists(PROFILES) {
            return Ok(Self { all: Vec::new(), of_names: vec![0; names] });
        }
        let at = open_group(at, PROFILES)?;
        let (of_names, first) = (load_integers(&at, "of_names")?, load_integers(&at, "first")?);
        let (positions, values) = (load_vector(&at, "positions")?, load_vector(&at, "values")?);
        let slopes = load_points(&at, "slopes")?;
        check_length(&at, "slopes", slopes.len(), positions.len())?;
        check_length(&at, "of_names", of_names.len(), names)?;
        check_length(&at, "values", values.len(), positions.len())?;
        let read = |part: &[usize]| {
            let knots = part[0]..part[1];
            let (Some(at_knots), Some(values), Some(slopes)) =
                (positions.get(knots.clone()), values.get(knots.clone()), slopes.get(knots.clone()))
            else {
                return Err(invalid(&at, "first", format!("no knots {knots:?} of {}", positions.len())));
            };
            let profile = Profile::with_slopes(at_knots.to_vec(), values.to_vec(), slopes.to_vec());
            profile.map(Arc::new).map_err(|e| invalid(&at, "positions", e.to_string()))
        };
        let all = first.windows(2).map(read).collect::<Result<Vec<_>, _>>()?;
        match of_names.iter().find(|number| **number > all.len()) {
            Some(number) => Err(invalid(&at, "of_names", format!("there is no profile {number} of {}", all.len()))),
            None => Ok(Self { all, of_names }),
        }
    }
}

/// The expressions of a group by their numbers.
pub(crate) struct Numbered(Vec<Expression>);

impl Numbered {
    /// Reads and parses all of them.
    pub(crate) fn load(at: &Group) -> Result<Self, IoError> {
        let at = open_group(at, EXPRESSIONS)?;
        let (texts, first) = (load_texts(&at, "texts")?, load_integers(&at, "first")?);
        let (names, values) = (load_texts(&at, "names")?, load_vector(&at, "values")?);
        check_length(&at, "first", first.len(), texts.len() + 1)?;
        check_length(&at, "values", values.len(), names.len())?;
        check_finite(&at, "values", &values)?;
        if first.last() != Some(&names.len()) {
            return Err(invalid(&at, "first", format!("it does not end at {}", names.len())));
        }
        let stored = Profiles::load(&at, names.len())?;
        let parsed = texts.iter().zip(first.windows(2)).map(|(text, part)| {
            let range = part[0]..part[1];
            let (Some(names), Some(values)) = (names.get(range.clone()), values.get(range.clone())) else {
                return Err(invalid(&at, "first", format!("no names {} to {} of {}", part[0], part[1], names.len())));
            };
            let (mut constants, mut profiles) = (BTreeMap::new(), BTreeMap::new());
            for ((name, value), number) in names.iter().zip(values).zip(&stored.of_names[range]) {
                match number.checked_sub(1) {
                    None => drop(constants.insert(name.clone(), *value)),
                    Some(profile) => drop(profiles.insert(name.clone(), stored.all[profile].clone())),
                }
            }
            let expression = Expression::with_profiles(text, &constants, &BTreeMap::new(), &profiles);
            let expression = expression.map_err(|e| invalid(&at, "texts", format!("{text:?}: {}", e.message)))?;
            match expression.names() == names {
                true => Ok(expression),
                false => Err(invalid(&at, "names", format!("{names:?} are not those of {text:?}"))),
            }
        });
        Ok(Self(parsed.collect::<Result<_, _>>()?))
    }

    /// The expression with a number from the dataset `name`.
    pub(crate) fn get(&self, at: &Group, name: &str, number: usize) -> Result<Option<Expression>, IoError> {
        let Some(index) = number.checked_sub(1) else { return Ok(None) };
        let found = self.0.get(index).cloned().map(Some);
        found.ok_or_else(|| invalid(at, name, format!("there is no expression {number} of {}", self.0.len())))
    }

    /// The expression with a number, which must not be 0.
    pub(crate) fn require(&self, at: &Group, name: &str, number: usize) -> Result<Expression, IoError> {
        self.get(at, name, number)?.ok_or_else(|| invalid(at, name, "an expression is wanted"))
    }

    /// Both components; None if both numbers are 0.
    pub(crate) fn pair(&self, at: &Group, name: &str, pair: [usize; 2]) -> Result<Option<[Expression; 2]>, IoError> {
        match pair {
            [0, 0] => Ok(None),
            [x, y] => Ok(Some([self.require(at, name, x)?, self.require(at, name, y)?])),
        }
    }
}
