//! The options that say what pictures show.

use std::cmp::Ordering;

use clap::Args;
use steklov_figures::View;

use super::failure::Failure;

#[derive(Args)]
pub(super) struct ViewArgs {
    /// Colours of the pictures of the body's field from LOW to HIGH; values beyond have the colour of their end
    #[arg(long, value_name = "LOW:HIGH", value_parser = interval, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,
}

impl ViewArgs {
    /// What the pictures show.
    ///
    /// # Errors
    /// An option where no pictures are wanted.
    pub(super) fn view(&self, drawn: bool) -> Result<View, Failure> {
        let given = [("--range", self.range.is_some())];
        match given.into_iter().find(|(_, is_given)| *is_given && !drawn) {
            Some((option, _)) => {
                Err(Failure(format!("error: {option} says what pictures show, and none are drawn: add --plots DIR")))
            }
            None => Ok(View { range: self.range }),
        }
    }
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
