//! The binary `nima` with the extra `department`.

use std::process::ExitCode;

fn main() -> ExitCode {
    nima_console::command::main(&[&nima_department::Department])
}
