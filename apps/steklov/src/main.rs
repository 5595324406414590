//! The command `steklov`.

use std::process::ExitCode;

use clap::Parser;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let cli = steklov::cli::Cli::try_parse().unwrap_or_else(|error| with_remedy(error).exit());
    ExitCode::from(cli.run())
}

/// The options that other programs have under letters.
const LETTERS: [(&str, &str); 5] =
    [("-o", "--out"), ("-s", "--set"), ("-j", "--threads"), ("-f", "--force"), ("-q", "--quiet")];

/// Options that belong to another command.
const ELSEWHERE: [(&str, &str); 4] = [
    ("--csv", "tables come from a result: steklov show RESULT.vtkhdf --csv DIR"),
    ("--plots", "pictures come from solve and show: steklov show RESULT.vtkhdf --plots DIR"),
    ("--out", "this command stores nothing: redirect what it prints, > FILE"),
    ("--format", "tables of a document come from solve, show and study: steklov show RESULT.vtkhdf --format markdown"),
];

/// The error about an argument that is not known with what to write, instead of the advice to give it as a value.
fn with_remedy(mut error: clap::Error) -> clap::Error {
    let given = match (error.kind(), error.get(ContextKind::InvalidArg)) {
        (ErrorKind::UnknownArgument, Some(ContextValue::String(given))) => given.clone(),
        _ => return error,
    };
    if let Some((_, long)) = LETTERS.iter().find(|(letter, _)| *letter == given) {
        error.remove(ContextKind::Suggested);
        error.insert(ContextKind::SuggestedArg, ContextValue::String((*long).to_owned()));
        return error;
    }
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let elsewhere = || ELSEWHERE.iter().find(|(option, _)| *option == given).map(|(_, help)| (*help).to_owned());
    let key = || given.strip_prefix("--").and_then(|key| steklov_document::full_key(&key.replace('-', "_")));
    let of_scene = || key().map(|key| format!("keys of the scene are changed by --set {key}=VALUE"));
    if let Some(help) = torn(&arguments).or_else(elsewhere).or_else(of_scene) {
        error.remove(ContextKind::SuggestedArg);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![StyledStr::from(help)]));
    }
    error
}

/// What to write for an override that the shell has taken apart: without its equals sign, or at the blanks of a list.
fn torn(arguments: &[String]) -> Option<String> {
    let after = arguments.iter().position(|a| a == "--set").map(|at| &arguments[at + 1..])?;
    let (first, rest) = after.split_first()?;
    let value = rest.first().filter(|value| !value.starts_with("--"))?;
    if !first.contains('=') {
        return Some(format!("--set takes KEY=VALUE as one argument: --set '{first}={value}'"));
    }
    let is_open = |text: &str| text.matches('[').count() > text.matches(']').count();
    let mut whole = first.clone();
    for part in rest {
        if !is_open(&whole) {
            break;
        }
        whole = format!("{whole} {part}");
    }
    (whole != *first && !is_open(&whole)).then(|| {
        format!("the shell takes quotes and divides at blanks: put the whole into single quotes: --set '{whole}'")
    })
}
