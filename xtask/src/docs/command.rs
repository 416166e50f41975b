//! The page of the command: its parts and their arguments, as they are defined; not what they print.

use std::fmt::Write;

use super::described::{Argument, Program};
use crate::markdown::{cell, code};

/// The page.
pub fn page(program: &Program) -> String {
    let mut page = format!(
        "# The command `{}`\n\nWritten by `cargo xtask docs` from the definition of the command line, with the features that are on by default. {}\n\n| command | does |\n\
         |---|---|\n",
        program.name,
        cell(&program.about)
    );
    for part in &program.commands {
        let first = part.about.split_inclusive(". ").next().unwrap_or_default();
        let (name, about) = (&part.name, cell(first.trim().trim_end_matches('.')));
        let _ = writeln!(page, "| [`{name}`](#{name}) | {about} |");
    }
    for part in &program.commands {
        let _ = write!(
            page,
            "\n<a id=\"{0}\"></a>\n\n## {1} {0}\n\n{2}\n\n```text\n{3}\n```\n",
            part.name,
            program.name,
            cell(&part.about),
            part.usage
        );
        if !part.arguments.is_empty() {
            page.push_str("\n| argument | default | meaning |\n|---|---|---|\n");
        }
        for argument in &part.arguments {
            let _ = writeln!(page, "{}", row(argument));
        }
    }
    page
}

fn row(argument: &Argument) -> String {
    let default = match argument.required {
        true => "needed".to_owned(),
        false => code(&argument.default),
    };
    let values: Vec<String> = argument.values.iter().map(|value| code(value)).collect();
    let values = match values.is_empty() {
        true => String::new(),
        false => format!(" One of {}.", values.join(", ")),
    };
    let (name, help) = (code(&argument.name), cell(&argument.help));
    format!("| {name} | {default} | {help}{values} |")
}

/// What commands and arguments lack.
pub fn lacks(program: &Program) -> Vec<String> {
    let mut lacks = Vec::new();
    if program.about.is_empty() {
        lacks.push(format!("{} has no description", program.name));
    }
    let silent = program.arguments.iter().filter(|a| a.help.is_empty());
    lacks.extend(silent.map(|a| format!("{} {} has no help", program.name, a.name)));
    lacks.extend(program.commands.iter().flat_map(self::lacks));
    lacks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn program(help: &str) -> Program {
        let argument = Argument {
            name: "--field <FIELD>".into(),
            required: false,
            default: "a".into(),
            values: vec!["a".into(), "b".into()],
            help: help.into(),
        };
        let part = Program {
            name: "plot".into(),
            usage: "moreau plot [OPTIONS]".into(),
            about: "Draws again. And more.".into(),
            arguments: vec![argument],
            commands: Vec::new(),
        };
        Program {
            name: "moreau".into(),
            usage: String::new(),
            about: "Contact.".into(),
            arguments: Vec::new(),
            commands: vec![part],
        }
    }

    #[test]
    fn every_argument_has_a_row() {
        let page = page(&program("Field."));
        assert!(page.contains("| [`plot`](#plot) | Draws again |"), "{page}");
        assert!(
            page.contains("```text\nmoreau plot [OPTIONS]\n```"),
            "{page}"
        );
        let row = "| `--field <FIELD>` | `a` | Field. One of `a`, `b`. |";
        assert!(page.contains(row), "{page}");
    }

    #[test]
    fn an_argument_without_help_is_told() {
        assert!(lacks(&program("Field.")).is_empty());
        assert_eq!(lacks(&program("")), ["plot --field <FIELD> has no help"]);
    }
}
