//! `[profiles]`: functions of one value by their values at points, from tables or from files with two columns.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use steklov_expression::{MOST_KNOTS, Place, Profile};
use steklov_problem::DataErrorKind;

use super::body::check_name;
use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::keys;

/// Separators of columns that a file may have, the first that its first line has.
const SEPARATORS: [u8; 3] = *b";\t,";

/// Positions and values at the knots, and where each of them stands, for messages.
type Knots = (Vec<[f64; 2]>, Vec<String>);

/// Reads `[profiles]`; its names become functions of one value in expressions.
pub(super) fn profiles(field: &Field<'_>, context: &Context<'_>) -> Result<BTreeMap<String, Arc<Profile>>, ReadError> {
    let mut profiles = BTreeMap::new();
    for (name, place, table) in Fields::open(field)?.all() {
        check_name(name, place)?;
        if context.constants.contains_key(name) {
            return Err(twice(name, "parameter", place));
        }
        profiles.insert(name.to_owned(), Arc::new(profile(&table, context)?));
    }
    Ok(profiles)
}

/// A name that is a profile and something else.
pub(super) fn twice(name: &str, other: &str, place: Place) -> ReadError {
    let message = format!("{name} is a {other} as well as a profile");
    ReadError::new(DataErrorKind::Conflict, place, message, "rename one of the two")
}

/// A profile, from its points or from its file.
fn profile(table: &Field<'_>, context: &Context<'_>) -> Result<Profile, ReadError> {
    let fields = Fields::new(table, &keys::PROFILE)?;
    let (of, (knots, stand)) = match (fields.get("file"), fields.get("points")) {
        (Some(file), None) => (file.name.clone(), from_file(&file, context)?),
        (None, Some(points)) => (points.name.clone(), from_points(&points)?),
        (Some(file), Some(_)) => {
            let message = format!("{} has both file and points", table.name);
            return Err(ReadError::new(DataErrorKind::Conflict, file.item.place, message, "keep one of the two"));
        }
        (None, None) => {
            let message = format!("{} has neither file nor points", table.name);
            let help = "write file = \"heights.csv\" or points = [[0, 0], [1, 0.01]]: position and value of each knot";
            return Err(ReadError::new(Kind::MissingKey, fields.place, message, help));
        }
    };
    let (at, value) = knots.iter().map(|[at, value]| (*at, *value)).unzip();
    let smooth = fields.get("smooth").map_or(Ok(false), |field| field.flag())?;
    let slopes = fields.get("slopes");
    if let (Some(slopes), true) = (&slopes, smooth || fields.get("file").is_some()) {
        let message = format!("{} stands beside {}", slopes.name, if smooth { "smooth" } else { "file" });
        return Err(ReadError::new(DataErrorKind::Conflict, slopes.item.place, message, "keep one of the two"));
    }
    let profile = match slopes {
        Some(slopes) => {
            Profile::with_slopes(at, value, slopes.list()?.iter().map(Field::point).collect::<Result<_, _>>()?)
        }
        None if smooth => Profile::smooth(at, value),
        None => Profile::new(at, value),
    };
    profile.map_err(|error| {
        let stands = error.knot().and_then(|knot| stand.get(knot)).map(|at| format!(" ({at})")).unwrap_or_default();
        let help = format!("a profile takes 2 to {MOST_KNOTS} knots, pairs of finite numbers, by rising positions");
        table.problem(format!("{of}: {error}{stands}"), help)
    })
}

/// The knots of a list of points.
fn from_points(points: &Field<'_>) -> Result<Knots, ReadError> {
    let list = points.list()?;
    let knots = list.iter().map(Field::point).collect::<Result<_, _>>()?;
    Ok((knots, list.into_iter().map(|point| point.name).collect()))
}

/// The knots of a file with a column of positions and one of values; a first line without numbers names them.
fn from_file(file: &Field<'_>, context: &Context<'_>) -> Result<Knots, ReadError> {
    let at = file.text()?;
    let path = Path::new(&context.source.name).parent().unwrap_or(Path::new("")).join(at);
    let refused = |why: String, help: &str| ReadError::new(Kind::Read, file.item.place, format!("{at}: {why}"), help);
    let columns = "a line for each knot: its position, a comma, its value; a line of names may come first";
    let text = std::fs::read_to_string(&path)
        .map_err(|e| refused(e.to_string(), "write a text file; the path is relative to the folder of the scene"))?;
    let text = text.trim_start_matches('\u{feff}');
    let first = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
    let separator = SEPARATORS.into_iter().find(|separator| first.as_bytes().contains(separator)).unwrap_or(b',');
    let mut reader = csv::ReaderBuilder::new();
    reader.trim(csv::Trim::All).comment(Some(b'#')).has_headers(false).flexible(true).delimiter(separator);
    let (mut knots, mut stand) = (Vec::new(), Vec::new());
    for (row, record) in reader.from_reader(text.as_bytes()).records().enumerate() {
        let record = record.map_err(|e| refused(e.to_string(), columns))?;
        let line = record.position().map_or(row as u64 + 1, csv::Position::line);
        if record.len() != 2 {
            let entries = if record.len() == 1 { "entry" } else { "entries" };
            return Err(refused(format!("line {line} has {} {entries}, not 2", record.len()), columns));
        }
        let numbers = [0, 1].map(|column| record[column].parse::<f64>());
        match numbers {
            [Ok(position), Ok(value)] => knots.push([position, value]),
            [Err(_), Err(_)] if row == 0 => continue,
            _ => {
                let entry = if numbers[0].is_err() { &record[0] } else { &record[1] };
                return Err(refused(format!("{entry:?} in line {line} is not a number"), columns));
            }
        }
        stand.push(format!("line {line}"));
        if knots.len() > MOST_KNOTS {
            return Err(refused(format!("it has more than {MOST_KNOTS} lines"), "keep fewer points of it"));
        }
    }
    Ok((knots, stand))
}
