//! The command `steklov`.

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    ExitCode::from(steklov::cli::Cli::parse().run())
}
