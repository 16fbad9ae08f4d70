//! `nima calibrate board`: draws a checkerboard for printing.

use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use nima_endoscope::{Checkerboard, board::BoardCorners};
use nima_report::output;

#[derive(Debug, Args)]
pub(in crate::command) struct CalibrateBoardArguments {
    /// Number of inner corners along each side: one number odd, the other even
    #[arg(long, value_name = "AxB", default_value = "9x6")]
    board: BoardCorners,
    /// Side length of a square
    #[arg(long, value_name = "MM", default_value_t = 10.0)]
    square_mm: f64,
    /// SVG file to write
    #[arg(long, value_name = "F.svg")]
    out: PathBuf,
}

pub(super) fn run(arguments: &CalibrateBoardArguments) -> anyhow::Result<()> {
    let BoardCorners(corners) = arguments.board;
    let board = Checkerboard::new(corners, arguments.square_mm * 1e-3)?;
    output::check(&arguments.out, &[])?;
    nima_files::write_atomically(&arguments.out, |file| file.write_all(board.svg().as_bytes()))
        .with_context(|| format!("cannot write {}", arguments.out.display()))?;
    output::line(&format!(
        "{}: print it at 100 %, measure a square, and fix the paper to a flat, stiff board",
        arguments.out.display()
    ))
}
