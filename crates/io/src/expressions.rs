//! A list of expressions, to which the parts of a problem refer by number.

use std::collections::BTreeMap;

use hdf5::Group;
use steklov_problem::steklov_expression::{Expression, Value};

use crate::array::{load_integers, load_vector, save_integers, save_vector};
use crate::dataset::label;
use crate::error::{IoError, invalid};
use crate::persist::{create_group, open_group};
use crate::problem::check_finite;
use crate::quadrature::check_length;
use crate::text::{load_texts, save_texts};

/// Name of their group.
const EXPRESSIONS: &str = "expressions";

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
        for expression in &self.0 {
            for (name, value) in expression.names().iter().zip(expression.values()) {
                let Value::Constant(value) = value else {
                    let why = format!("{name} of {:?} is a random field, which is not stored", expression.text());
                    return Err(invalid(&at, "values", why));
                };
                names.push(name.clone());
                values.push(*value);
            }
            texts.push(expression.text().to_owned());
            first.push(names.len());
        }
        save_texts(&at, "texts", &texts, "expressions of x, y, s and names", "expression")?;
        let meaning = "where the names of each expression begin among names and values, and the end";
        save_integers(&at, "first", &first, &label("1", meaning, &["expression"]))?;
        save_texts(&at, "names", &names, "names of parameters and random input that it uses", "name")?;
        save_vector(&at, "values", &values, &label("1", "values of these names; random input at its mean", &["name"]))
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
        let parsed = texts.iter().zip(first.windows(2)).map(|(text, part)| {
            let range = part[0]..part[1];
            let (Some(names), Some(values)) = (names.get(range.clone()), values.get(range)) else {
                return Err(invalid(&at, "first", format!("no names {} to {} of {}", part[0], part[1], names.len())));
            };
            let constants: BTreeMap<String, f64> = names.iter().cloned().zip(values.iter().copied()).collect();
            let expression = Expression::parse(text, &constants);
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
