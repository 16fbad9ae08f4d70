//! Experiments that print figures.
//!
//! Each is an [`Experiment`]: its options are the value, and what it finds are [`Findings`], which one writer turns into files
//! and into words on a terminal.
#![warn(missing_docs)]

pub mod faults;
pub mod gates;
mod pair;
pub mod picture;
pub mod reference;
pub mod release;
pub mod replay;
pub mod solvers;
pub mod stability;
pub mod stability_map;
pub mod tradeoff;
pub mod validation;

use std::{error::Error, path::PathBuf};

use serde::Serialize;

/// Something to measure, with its options.
pub trait Experiment {
    /// Its files begin so: `release` makes `release.json` and `release.md`.
    const NAME: &'static str;
    /// How the files end that it writes in any case beside the JSON: `.md`. It is tried before the work whether they can be written.
    const FILES: &'static [&'static str];
    /// What it finds.
    type Findings: Findings;
    /// Why it cannot be made.
    type Error: Error + Send + Sync + 'static;

    /// Files that it reads, which no result may replace.
    fn inputs(&self) -> Vec<PathBuf> {
        Vec::new()
    }

    /// Makes it. `progress` is told before each step how many are done, of how many, and what comes next.
    ///
    /// # Errors
    /// A setting is out of range, or what is to be measured cannot be had.
    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<Self::Findings, Self::Error>;
}

/// The result of an [`Experiment`], serialised as its JSON.
pub trait Findings: Serialize {
    /// For a terminal.
    fn text(&self) -> String;

    /// The files beside the JSON: how their names end (`.md`, `-errors.svg`), and what they hold.
    fn files(&self) -> Vec<(String, String)>;

    /// Why the result is bad, where it can be.
    ///
    /// # Errors
    /// What was found, in a sentence for the user.
    fn judge(&self) -> Result<(), String> {
        Ok(())
    }
}
