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
mod modes;
mod names;
mod numbers;
mod ready;
mod refusals;
mod sides;
mod task_events;

pub(crate) use calibration::{drift, refusal};
pub(crate) use causes::cause_text;
pub(crate) use channels::{channel_group, channel_name, marker};
pub(crate) use commands::operation;
pub(crate) use disk::disk_full_in;
pub(crate) use events::event;
pub(crate) use findings::finding_text;
pub(crate) use frames::{axes_text, cause, phase};
pub(crate) use gates::gate_text;
pub(crate) use modes::{COMPARED, EVERYDAY, OF_RESEARCH, mode_line, mode_meaning, mode_name};
pub(crate) use names::{
    device_name, exchange_text, goal_text, lack_text, loss_text, obstacle_text, part_name, role_name, scheduling_text,
    side_word, state_name, within,
};
pub(crate) use numbers::{UNKNOWN, newtons, newtons_in_three, newtons_read, three_digits};
pub(crate) use ready::{ask_text, check_name, figure_text, lacks_text, unit};
pub(crate) use refusals::{cure_of_refusal, refused_because};
pub(crate) use task_events::happening;

/// Returns the message of a library, which is English in every language: a whole sentence, in quotation marks within
/// German text.
pub(crate) fn quoted(message: &impl std::fmt::Display) -> String {
    crate::language::text_format!("{message}", "„{message}“")
}

/// A value with texts for its cause and its remedy.
pub(crate) trait Remedy {
    /// Returns one sentence.
    fn cause(self) -> &'static str;
    fn cure(self) -> &'static str;
}

pub(crate) trait ShortText {
    fn words(self) -> &'static str;
}
