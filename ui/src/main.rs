//! The binary `nima`.

use std::process::ExitCode;

fn main() -> ExitCode {
    nima_console::command::main(&[])
}
