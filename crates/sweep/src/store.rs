//! The file of a sweep.

use std::path::Path;

use faer::Mat;
use steklov_io::{
    IoError, create_atomically, create_group, invalid, label, load_dense, load_integers, load_text, load_texts, open,
    open_group, read_text_attribute, save_dense, save_integers, save_text, save_texts, write_text_attribute,
};

use crate::solve::Outcome;
use crate::{Points, Sweep, SweepError};

/// Content of the file, by its attribute.
const CONTENT: &str = "sweep";

/// States of points in the file.
const MISSING: usize = 0;
const SOLVED: usize = 1;
const FAILED: usize = 2;

/// Writes a sweep into the file `path`: equal sweeps give equal bytes.
///
/// # Errors
/// [`SweepError::Io`] when it exists and is not to be replaced, or cannot be written; an existing one is untouched then.
pub fn write(sweep: &Sweep, path: &Path, replace: bool) -> Result<(), SweepError> {
    let Sweep { title, scene, overrides, points, outcomes } = sweep;
    let all = 0..points.len();
    let answers: Vec<String> =
        texts(outcomes, |outcome| if let Outcome::Solved(text) = outcome { Some(text) } else { None });
    let messages: Vec<String> =
        texts(outcomes, |outcome| if let Outcome::Failed(text) = outcome { Some(text) } else { None });
    let state = |outcome: &Option<Outcome>| match outcome {
        None => MISSING,
        Some(Outcome::Solved(_)) => SOLVED,
        Some(Outcome::Failed(_)) => FAILED,
    };
    let states: Vec<usize> = outcomes.iter().map(state).collect();
    let settings: Vec<String> = all.clone().map(|point| points.settings(point).join("\n")).collect();
    let values = Mat::from_fn(points.len(), points.keys().len(), |point, key| points.number(point, key));
    let quantities = sweep.quantities();
    let numbers = Mat::from_fn(points.len(), quantities.paths.len(), |point, k| quantities.rows[point][k]);
    create_atomically(path, replace, |file| -> Result<(), IoError> {
        write_text_attribute(file, "program", concat!("steklov ", env!("CARGO_PKG_VERSION")))?;
        write_text_attribute(file, "content", CONTENT)?;
        save_text(file, "title", title, "title of the scene")?;
        save_text(file, "scene", scene, "text of the scene file")?;
        save_texts(file, "overrides", overrides, "settings KEY=VALUE of all points", "override")?;
        let at = create_group(file, "points")?;
        save_texts(&at, "keys", points.keys(), "the varied keys", "key")?;
        save_texts(&at, "settings", &settings, "settings KEY=VALUE of each point, one a line", "point")?;
        let meaning = "values of the varied keys, NaN for words";
        save_dense(&at, "values", values.as_ref(), &label("that of the key", meaning, &["point", "key"]))?;
        let meaning = "0 not solved yet, 1 solved, 2 failed";
        save_integers(&at, "state", &states, &label("1", meaning, &["point"]))?;
        save_texts(&at, "messages", &messages, "why a point failed", "point")?;
        save_texts(&at, "answers", &answers, "JSON object of each point that is solved", "point")?;
        let at = create_group(file, "quantities")?;
        save_texts(&at, "paths", &quantities.paths, "paths of the numbers in the JSON object", "path")?;
        let meaning = "the numbers, NaN where a point has none";
        save_dense(&at, "values", numbers.as_ref(), &label("that of the path", meaning, &["point", "path"]))
    })?;
    Ok(())
}

fn texts(outcomes: &[Option<Outcome>], text: impl Fn(&Outcome) -> Option<&String>) -> Vec<String> {
    outcomes.iter().map(|outcome| outcome.as_ref().and_then(&text).cloned().unwrap_or_default()).collect()
}

/// Reads what [`write()`] wrote.
///
/// # Errors
/// [`SweepError::Io`] of a file that is none, or altered.
pub fn read(path: &Path) -> Result<Sweep, SweepError> {
    let file = open(path)?;
    let content = read_text_attribute(&file, "content").ok().filter(|content| content == CONTENT);
    if content.is_none() {
        return Err(invalid(&file, "content", "it is no sweep").into());
    }
    let at = open_group(&file, "points")?;
    let keys = load_texts(&at, "keys")?;
    let settings = load_texts(&at, "settings")?;
    let settings: Vec<Vec<String>> =
        settings.iter().map(|lines| lines.split('\n').map(str::to_owned).collect()).collect();
    let points =
        Points::of_settings(keys, &settings).ok_or_else(|| invalid(&at, "settings", "they are not of the keys"))?;
    let (states, messages, answers) =
        (load_integers(&at, "state")?, load_texts(&at, "messages")?, load_texts(&at, "answers")?);
    load_dense(&at, "values")?;
    if [states.len(), messages.len(), answers.len()] != [points.len(); 3] {
        return Err(invalid(&at, "state", "it has not a number for each point").into());
    }
    let outcome = |((state, message), answer): ((usize, String), String)| match state {
        SOLVED => Some(Outcome::Solved(answer)),
        FAILED => Some(Outcome::Failed(message)),
        _ => None,
    };
    let outcomes = states.into_iter().zip(messages).zip(answers).map(outcome).collect();
    let (title, scene, overrides) =
        (load_text(&file, "title")?, load_text(&file, "scene")?, load_texts(&file, "overrides")?);
    Ok(Sweep { title, scene, overrides, points, outcomes })
}
