//! Texts for the values that the libraries report: faults, reasons, sources, verdicts. The window and the command line
//! use the same texts. The libraries contain only the values, so every sentence that a person reads is here or in
//! `console/text`.
//!
//! Causes are sentences; remedies are instructions to the operator; reasons start in lower case, because they follow a colon.

mod calibration;
mod causes;
mod channels;
mod commands;
mod disk;
mod events;
mod faults;
mod findings;
mod force;
mod frames;
mod gates;
mod happenings;
mod modes;
mod names;
mod numbers;
mod ready;
mod refusals;
mod sides;

pub(crate) use calibration::{drift, refusal};
pub(crate) use causes::cause_words;
pub(crate) use channels::{channel_group, channel_name, marker};
pub(crate) use commands::operation;
pub(crate) use disk::disk_full_in;
pub(crate) use events::event;
pub(crate) use findings::finding_words;
pub(crate) use frames::{axes_words, cause, phase};
pub(crate) use gates::gate_words;
pub(crate) use happenings::happening;
pub(crate) use modes::{COMPARED, OFFERED, mode_meaning, mode_name};
pub(crate) use names::{
    device_name, exchange_words, goal_words, lack_words, loss_words, obstacle_words, part_name, role_name,
    scheduling_words, side_word, state_name, within,
};
pub(crate) use numbers::{newtons, newtons_in_three, newtons_read, three_digits};
pub(crate) use ready::{ask_words, check_name, figure_words, lacks_words, unit};
pub(crate) use refusals::{cure_of_refusal, refused_because};

/// Message of a library, which is English in every language: a whole sentence, in quotation marks within German text.
pub(crate) fn quoted(message: &impl std::fmt::Display) -> String {
    crate::language::told!("{message}", "„{message}“")
}

/// A value with texts for its cause and its remedy.
pub(crate) trait Remedy {
    /// One sentence.
    fn cause(self) -> &'static str;
    fn cure(self) -> &'static str;
}

pub(crate) trait Words {
    fn words(self) -> &'static str;
}
