//! The options that say what pictures show.

use std::cmp::Ordering;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use steklov_figures::{Scalar, View};

use super::failure::Failure;

#[derive(Args)]
pub(super) struct ViewArgs {
    /// Colours of the pictures of the body's field from LOW to HIGH; values beyond have the colour of their end
    #[arg(long, value_name = "LOW:HIGH", value_parser = interval, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,
    /// What the pictures colour the body by; default: von-mises
    #[arg(long, value_name = "NAME", value_parser = scalars())]
    field: Option<Scalar>,
}

impl ViewArgs {
    /// What the pictures show.
    ///
    /// # Errors
    /// An option where no pictures are wanted.
    pub(super) fn view(&self, drawn: bool) -> Result<View, Failure> {
        let given = [("--range", self.range.is_some()), ("--field", self.field.is_some())];
        match given.into_iter().find(|(_, is_given)| *is_given && !drawn) {
            Some((option, _)) => {
                Err(Failure(format!("error: {option} says what pictures show, and none are drawn: add --plots DIR")))
            }
            None => Ok(View { scalar: self.field.unwrap_or_default(), range: self.range }),
        }
    }
}

/// The names of fields.
fn scalars() -> impl TypedValueParser<Value = Scalar> {
    PossibleValuesParser::new(Scalar::ALL.map(Scalar::name)).map(|name| Scalar::of_name(&name).unwrap_or_default())
}

/// A finite number.
fn number(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    number.ok_or_else(|| format!("{text:?} is no number"))
}

/// Two numbers with a colon between them, the smaller one first.
fn interval(text: &str) -> Result<[f64; 2], String> {
    let (low, high) = text.split_once(':').ok_or("write two numbers with a colon between them, such as 0:2.5")?;
    let [low, high] = [number(low)?, number(high)?];
    match low.partial_cmp(&high) {
        Some(Ordering::Less) => Ok([low, high]),
        Some(Ordering::Greater) => Err(format!("the smaller number stands first: {high}:{low}")),
        _ => Err("there is nothing between two equal numbers".to_owned()),
    }
}
