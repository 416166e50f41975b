//! Tells as JSON what the results and the command line are made of: what `cargo xtask docs` writes pages from.

// A program, not a library: it prints.
#![allow(clippy::print_stdout)]

use clap::{Arg, Command};
use moreau::simulation::reference::{self, Entry};
use serde_json::{Value, json};

fn main() {
    let mut command = moreau::command::definition();
    command.build();
    let told = json!({
        "history": entries(&reference::history()),
        "contact": entries(&reference::contact()),
        "run": entries(&reference::run()),
        "command": program(&command),
    });
    println!("{told:#}");
}

fn entries(list: &[Entry]) -> Value {
    let entry =
        |e: &Entry| json!({ "name": e.name, "unit": e.unit, "meaning": e.meaning, "when": e.when });
    list.iter().map(entry).collect()
}

/// A command and its parts; the help of the command itself is known.
fn program(command: &Command) -> Value {
    let about = command.get_long_about().or_else(|| command.get_about());
    let arguments = command
        .get_arguments()
        .filter(|a| shown(a.get_id().as_str()));
    let parts = command
        .get_subcommands()
        .filter(|part| shown(part.get_name()));
    let usage = command.clone().render_usage().to_string();
    json!({
        "name": command.get_name(),
        "usage": usage.trim_start_matches("Usage: "),
        "about": about.map(ToString::to_string).unwrap_or_default(),
        "arguments": arguments.map(argument).collect::<Vec<_>>(),
        "commands": parts.map(program).collect::<Vec<_>>(),
    })
}

/// Whether a name is of the program and not of the library that reads its arguments.
fn shown(name: &str) -> bool {
    !["help", "version"].contains(&name)
}

fn argument(argument: &Arg) -> Value {
    let help = argument.get_long_help().or_else(|| argument.get_help());
    // A switch is false unless given, which goes without saying.
    let takes = argument.get_action().takes_values();
    let default = argument.get_default_values().iter().filter(|_| takes);
    let default: Vec<_> = default.map(|value| value.to_string_lossy()).collect();
    let values = argument.get_possible_values().into_iter().filter(|_| takes);
    json!({
        "name": argument.to_string(),
        "required": argument.is_required_set(),
        "default": default.join(", "),
        "values": values.map(|value| value.get_name().to_owned()).collect::<Vec<_>>(),
        "help": help.map(ToString::to_string).unwrap_or_default(),
    })
}
