//! The `moreau` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(moreau::command::main(std::env::args_os()))
}
