//! The subcommands `new` and `scenes`: scenes to start from.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use include_dir::{Dir, include_dir};
use steklov_document::TEMPLATES;
use steklov_expression::nearest;

use super::{Failure, say};

/// The folder of the gallery.
static SCENES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../scenes");

#[derive(Args)]
pub(super) struct NewArgs {
    /// What the scene is to show; contact has every key
    #[arg(long, value_name = "KIND", value_parser = kinds(), default_value = TEMPLATES[0].0)]
    kind: &'static str,
}

/// Takes the name of a template and gives its text.
fn kinds() -> impl TypedValueParser<Value = &'static str> {
    let names = PossibleValuesParser::new(TEMPLATES.map(|(name, _)| name));
    names.try_map(|name| TEMPLATES.iter().find(|(known, _)| *known == name).map(|found| found.1).ok_or("no such kind"))
}

/// Prints a commented scene.
pub(super) fn new(args: &NewArgs) -> Result<u8, Failure> {
    say(args.kind.trim_end());
    Ok(0)
}

#[derive(Args)]
pub(super) struct ScenesArgs {
    /// The scene to print: its name, the part after its number, or the number; default: a list of all
    name: Option<String>,
}

/// Lists the scenes of the gallery, a line each, or prints one.
pub(super) fn scenes(args: &ScenesArgs) -> Result<u8, Failure> {
    match &args.name {
        None => gallery().for_each(|(name, text)| say(&format!("{name:36}  {}", title(text)))),
        Some(name) => say(scene(name)?.trim_end()),
    }
    Ok(0)
}

/// Names without ending and texts of the scenes, in order.
fn gallery() -> impl Iterator<Item = (&'static str, &'static str)> {
    let file =
        |f: &'static include_dir::File<'static>| Some((f.path().to_str()?.strip_suffix(".toml")?, f.contents_utf8()?));
    let mut all: Vec<_> = SCENES.files().filter_map(file).collect();
    all.sort_unstable();
    all.into_iter()
}

/// The title of a scene.
fn title(text: &str) -> &str {
    let line = text.lines().find_map(|line| line.strip_prefix("title = \""));
    line.and_then(|rest| rest.split('"').next()).unwrap_or("")
}

/// The scene of a name, of a name without its number, or of a number.
fn scene(wanted: &str) -> Result<&'static str, Failure> {
    let wanted = wanted.strip_suffix(".toml").unwrap_or(wanted);
    let parts = |name: &'static str| name.split_once('-').filter(|(n, _)| n.chars().all(|c| c.is_ascii_digit()));
    let found = gallery().find(|(name, _)| {
        *name == wanted || parts(name).is_some_and(|(number, rest)| rest == wanted || number == wanted)
    });
    found.map(|(_, text)| text).ok_or_else(|| {
        let near = nearest(wanted, gallery().flat_map(|(name, _)| [Some(name), parts(name).map(|p| p.1)]).flatten());
        let help = near.map_or("steklov scenes lists all".to_owned(), |near| format!("did you mean {near}?"));
        Failure(format!("error: there is no scene {wanted:?}: {help}"))
    })
}
