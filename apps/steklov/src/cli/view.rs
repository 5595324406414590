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
    /// Part of the undeformed body that the pictures show
    #[arg(long, value_name = "X0:X1,Y0:Y1", value_parser = window, allow_hyphen_values = true)]
    window: Option<[[f64; 2]; 2]>,
    /// How many times as large as they are displacements are drawn, 1 to scale; default: so that they are visible
    #[arg(long, value_name = "FACTOR", value_parser = factor, allow_hyphen_values = true)]
    enlarge: Option<f64>,
    /// Fields on grids without the lines of coarse cells
    #[arg(long)]
    hide_cells: bool,
    /// Steps whose meshes are drawn too, separated by commas, 0 the first; of boundary elements
    #[arg(long, value_name = "STEPS", value_delimiter = ',')]
    pub(super) steps: Vec<usize>,
}

impl ViewArgs {
    /// What the pictures show.
    ///
    /// # Errors
    /// An option where no pictures are wanted.
    pub(super) fn view(&self, drawn: bool) -> Result<View, Failure> {
        let given = [
            ("--range", self.range.is_some()),
            ("--field", self.field.is_some()),
            ("--window", self.window.is_some()),
            ("--enlarge", self.enlarge.is_some()),
            ("--hide-cells", self.hide_cells),
            ("--steps", !self.steps.is_empty()),
        ];
        match given.into_iter().find(|(_, is_given)| *is_given && !drawn) {
            Some((option, _)) => {
                Err(Failure(format!("error: {option} says what pictures show, and none are drawn: add --plots DIR")))
            }
            None => {
                let Self { range, window, enlarge, hide_cells: hides_cells, .. } = *self;
                Ok(View { scalar: self.field.unwrap_or_default(), range, window, enlarge, hides_cells })
            }
        }
    }
}

/// A window beside all points of a body shows nothing of it.
///
/// # Errors
/// It is one.
pub(super) fn check_window(view: &View, points: impl Iterator<Item = [f64; 2]>) -> Result<(), Failure> {
    let Some([low, high]) = view.window else { return Ok(()) };
    let none = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    let [least, most] = points.fold(none, |[l, h], p| [[0, 1].map(|i| p[i].min(l[i])), [0, 1].map(|i| p[i].max(h[i]))]);
    if (0..2).all(|i| low[i] < most[i] && high[i] > least[i]) {
        return Ok(());
    }
    let text = |[low, high]: [[f64; 2]; 2]| format!("{}:{},{}:{}", low[0], high[0], low[1], high[1]);
    let (window, body) = (text([low, high]), text([least, most]));
    Err(Failure(format!("error: --window {window} shows nothing: the body lies in {body}, choose a part of that")))
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

/// Two intervals, of x and of y, as lower left and upper right corner.
fn window(text: &str) -> Result<[[f64; 2]; 2], String> {
    let (x, y) = text.split_once(',').ok_or("write an interval of x and one of y, such as 0:1,-0.5:0")?;
    let [x, y] = [interval(x)?, interval(y)?];
    Ok([[x[0], y[0]], [x[1], y[1]]])
}

/// A positive number.
fn factor(text: &str) -> Result<f64, String> {
    let factor = number(text)?;
    if factor > 0.0 { Ok(factor) } else { Err("it must be positive; 1 draws to scale".to_owned()) }
}
