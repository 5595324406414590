//! The subcommands `completions` and `man`.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::{Cli, Failure};

#[derive(Args)]
pub(super) struct CompletionsArgs {
    /// The shell
    shell: Shell,
}

/// Prints completions of a shell.
pub(super) fn completions(args: &CompletionsArgs) -> Result<u8, Failure> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "steklov", &mut text);
    print(&text);
    Ok(0)
}

#[derive(Args)]
pub(super) struct ManArgs {
    /// The command whose page is printed; default: the page of steklov
    command: Option<String>,
}

/// Prints a man page.
pub(super) fn man(args: &ManArgs) -> Result<u8, Failure> {
    let mut all = Cli::command();
    all.build();
    let page = match &args.command {
        None => all,
        Some(name) => match all.find_subcommand(name) {
            Some(found) => found.clone().display_name(format!("steklov-{name}")),
            None => return Err(Failure(format!("error: there is no command {name:?}: steklov help lists all"))),
        },
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(page).render(&mut text)?;
    print(&text);
    Ok(0)
}

/// Prints to stdout; a reader that has gone away is no error.
fn print(text: &[u8]) {
    use std::io::Write as _;
    let _ = std::io::stdout().write_all(text);
}
