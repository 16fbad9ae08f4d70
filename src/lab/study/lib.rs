//! Experiments that measure the system and report results.
//!
//! Each is an [`Experiment`], a struct of its options; its result implements [`Findings`]. One writer in the console
//! converts findings into files and into text on a terminal.

pub mod baselines;
pub mod clocks;
pub mod effects;
pub mod faults;
pub mod gates;
pub mod hands;
pub mod network;
mod pair;
pub mod passivity;
pub mod reference;
pub mod release;
pub mod replay;
pub mod solvers;
pub mod stability;
pub mod stability_map;
pub mod tradeoff;
pub mod trials;
pub mod validation;

use std::{error::Error, path::PathBuf};

use serde::Serialize;

pub trait Experiment {
    /// Prefix of the names of its files: `release` gives `release.json` and `release.md`.
    const NAME: &'static str;
    /// Endings of the files that the experiment always writes in addition to the JSON. The writer checks before the
    /// experiment that these files can be written.
    const FILES: &'static [&'static str] = &[".md"];
    type Findings: Findings;
    /// Reason why it could not run.
    type Error: Error + Send + Sync + 'static;

    /// Returns the files that the experiment reads; results must not overwrite them.
    fn inputs(&self) -> Vec<PathBuf> {
        Vec::new()
    }

    /// Runs the experiment. Before each step `progress` is called with the number of steps done, their total, and the
    /// name of the next step.
    ///
    /// # Errors
    /// An option is out of range, or something needed for the measurement is missing.
    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<Self::Findings, Self::Error>;
}

/// The result of an [`Experiment`], serialised as its JSON.
pub trait Findings: Serialize {
    /// Returns the text for a terminal; in Markdown if it is also written to a file.
    fn text(&self) -> String;

    /// Returns the files in addition to the JSON: the ending of each name (`.md`, `-errors.svg`), and its contents. By
    /// default the text.
    fn files(&self) -> Vec<(String, String)> {
        vec![(".md".to_owned(), self.text())]
    }

    /// Checks whether the result meets its targets.
    ///
    /// # Errors
    /// A sentence for the user that says which target was missed.
    fn judge(&self) -> Result<(), String> {
        Ok(())
    }
}
