//! Texts for the values that the libraries report: faults, reasons, sources, verdicts. The window and the command line
//! use the same texts. The libraries contain only the values, so every sentence that a person reads is here or in
//! [`text`](crate::text).
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

pub use calibration::{drift, refusal};
pub use causes::cause_text;
pub use channels::{channel_group, channel_name, marker};
pub use commands::operation;
pub use disk::disk_full_in;
pub use events::event;
pub use findings::finding_text;
pub use frames::{axes_text, cause, phase};
pub use gates::gate_text;
pub use modes::{COMPARED, EVERYDAY, OF_RESEARCH, mode_line, mode_meaning, mode_name};
pub use names::{
    device_name, exchange_text, goal_text, lack_text, loss_text, obstacle_text, part_name, role_name, scheduling_text,
    side_name, side_word, state_name, within,
};
pub use numbers::{UNKNOWN, newtons, newtons_in_three, newtons_read, three_digits};
pub use ready::{ask_text, check_name, figure_text, lacks_text, unit};
pub use refusals::{cure_of_refusal, refused_because};
pub use task_events::happening;

/// Returns an error with its causes, in one line.
pub fn chain(error: &dyn std::error::Error) -> String {
    let mut words = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        words = format!("{words}: {cause}");
        source = cause.source();
    }
    words
}

/// Returns the text with an upper-case first letter.
pub fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Returns the message of a library, which is English in every language: a whole sentence, in quotation marks within
/// German text.
pub fn quoted(message: &impl std::fmt::Display) -> String {
    crate::language::text_format!("{message}", "„{message}“")
}

/// A value with texts for its cause and its remedy.
pub trait Remedy {
    /// Returns one sentence.
    fn cause(self) -> &'static str;
    fn cure(self) -> &'static str;
}

pub trait ShortText {
    fn words(self) -> &'static str;
}
