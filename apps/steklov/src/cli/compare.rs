//! The subcommand `compare`.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;
use steklov_figures::beside;
use steklov_io::{load_text, load_texts, open, read_text_attribute};
use steklov_picture::{short, write};
use steklov_report::compare::{Compared, compared, energies, table};
use steklov_report::format::csv_table;
use steklov_result::record::Record;
use steklov_result::store;

use super::output::check_folder;
use super::show::no_scene;
use super::told::TableFormat;
use super::{Failure, say, stem};

#[derive(Args)]
pub(super) struct CompareArgs {
    /// A result file
    first: PathBuf,
    /// Another result file
    second: PathBuf,
    /// Draw contact sides and lines of both into this folder, and write the table there
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
    /// Print the table in the format of a document
    #[arg(long, value_enum, conflicts_with = "json")]
    format: Option<TableFormat>,
}

/// A result, with the text of its scene and its overrides.
struct Stored {
    record: Record,
    scene: String,
    overrides: Vec<String>,
}

fn read(path: &Path) -> Result<Stored, Failure> {
    no_scene(path, "compare")?;
    let file = open(path)?;
    if read_text_attribute(&file, "content").is_ok_and(|content| content == "sweep") {
        let (file, table) = (path.display(), path.with_extension("csv"));
        let help = format!("its numbers are in {}; compare takes results of steklov solve", table.display());
        return Err(Failure(format!("error: {file} is a sweep: {help}")));
    }
    let (scene, overrides) = (load_text(&file, "scene")?, load_texts(&file, "overrides")?);
    Ok(Stored { record: store::read(&file)?, scene, overrides })
}

/// Compares two results.
pub(super) fn compare(args: &CompareArgs) -> Result<u8, Failure> {
    check_folder("--plots", args.plots.as_deref())?;
    let [first, second] = [read(&args.first)?, read(&args.second)?];
    let names = match [stem(&args.first), stem(&args.second)] {
        [a, b] if a == b => [&args.first, &args.second].map(|path| path.display().to_string()),
        names => names,
    };
    let names = [names[0].as_str(), names[1].as_str()];
    let rows = compared(&first.record.summary, &second.record.summary);
    let mut files = Vec::new();
    if let Some(folder) = &args.plots {
        for (part, picture) in beside(&first.record, &second.record, names)? {
            files.extend(write(folder, &format!("compared-{part}"), &picture)?);
        }
        let path = folder.join("compared.csv");
        let written = std::fs::create_dir_all(folder)
            .and_then(|()| steklov_picture::replace(folder, &path, table(&rows, names).as_bytes()));
        written.map_err(|e| Failure(format!("error: {} cannot be written: {e}", path.display())))?;
        files.push(path);
    }
    match (args.json, args.format) {
        (true, _) => say(&serde_json::to_string_pretty(&object([&first, &second], names, &rows, &files))?),
        (_, Some(format)) => say(csv_table(&table(&rows, names), format.format())?.trim_end()),
        _ => tell([&first, &second], names, &rows, &files),
    }
    Ok(0)
}

fn object(results: [&Stored; 2], names: [&str; 2], rows: &[Compared], files: &[PathBuf]) -> serde_json::Value {
    let [first, second] = results;
    let energies = energies(&first.record.summary, &second.record.summary);
    json!({
        "names": names, "same_scene": first.scene == second.scene, "settings": [first.overrides, second.overrides],
        "energy_distance": energies.map(|[distance, _]| distance), "energy_uncertainty": energies.map(|[_, sum]| sum),
        "numbers": rows, "files": files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>(),
    })
}

/// What is below this part of a size is rounding.
const ROUNDING: f64 = 1e-10;

/// Prints the table, what differs in the scenes, and whether the energies agree.
fn tell(results: [&Stored; 2], names: [&str; 2], rows: &[Compared], files: &[PathBuf]) {
    let [first, second] = results;
    if first.scene != second.scene {
        say(&format!("scenes      differ: {:?} and {:?}", first.record.summary.title, second.record.summary.title));
    }
    for (result, name) in results.iter().zip(names).filter(|(result, _)| !result.overrides.is_empty()) {
        say(&format!("settings    of {name}: {}", result.overrides.join(", ")));
    }
    let cells = |row: &Compared| {
        let shown = |value: f64| if value.abs() < ROUNDING * row.size { 0.0 } else { value };
        let number = |value: Option<f64>, digits| value.map_or("-".to_owned(), |value| short(shown(value), digits));
        let relative =
            row.relative.map_or("-".to_owned(), |v| if v == 0.0 { "0".to_owned() } else { format!("{v:.1e}") });
        [row.path.clone(), number(row.first, 9), number(row.second, 9), number(row.difference, 3), relative]
    };
    let is_quantity = |row: &&Compared| !row.path.starts_with("audit.");
    let head = ["number", names[0], names[1], "difference", "relative"].map(str::to_owned);
    let lines: Vec<[String; 5]> = std::iter::once(head).chain(rows.iter().filter(is_quantity).map(cells)).collect();
    let widths = [0, 1, 2, 3, 4].map(|k| lines.iter().map(|line| line[k].chars().count()).max().unwrap_or(0));
    for [path, a, b, difference, relative] in lines {
        let [w, x, y, z, r] = widths;
        say(&format!("{path:w$}  {a:>x$}  {b:>y$}  {difference:>z$}  {relative:>r$}"));
    }
    if let Some([distance, uncertainty]) = energies(&first.record.summary, &second.record.summary) {
        let told = if distance <= uncertainty { "within" } else { "MORE THAN" };
        say(&format!("J extrapolated differs by {distance:.1e}, {told} the uncertainties of both, {uncertainty:.1e}"));
    }
    files.iter().for_each(|file| say(&format!("wrote       {}", file.display())));
}
