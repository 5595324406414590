//! The command `steklov`.

use std::process::ExitCode;

use clap::Parser;
use clap::error::{ContextKind, ContextValue};

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let cli = steklov::cli::Cli::try_parse().unwrap_or_else(|error| with_long_option(error).exit());
    ExitCode::from(cli.run())
}

/// The error about a letter like -o with the option that other programs have under it, instead of the advice to give it as a
/// value.
fn with_long_option(mut error: clap::Error) -> clap::Error {
    let long = match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(given)) => match given.as_str() {
            "-o" => "--out",
            "-s" => "--set",
            "-j" => "--threads",
            "-f" => "--force",
            "-q" => "--quiet",
            _ => return error,
        },
        _ => return error,
    };
    error.remove(ContextKind::Suggested);
    error.insert(ContextKind::SuggestedArg, ContextValue::String(long.to_owned()));
    error
}
