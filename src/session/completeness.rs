//! The data that a session file lacks: one list for every command that reads a session.

use nima_recording::session::{ChannelId, ReaderMessages, SessionMessage, SessionReader};

use crate::{
    journal::{MessageOutline, outline},
    plot_channels::{self, arms, topic},
    recorder::JOURNAL_TOPIC,
    trim,
};

/// A longer time between two ticks is reported, s. The loop has a tick in every period; half a second is more than a
/// busy computer delays it.
const GAP_MAX_S: f64 = 0.5;
/// Maximum number of lines; the rest is counted.
const LINES_MAX: usize = 20;

/// Returns the faults of a session, one line each; empty for a whole one. Reads the journal and the forces completely.
///
/// The times are in seconds since the start of the session.
pub fn missing(reader: &SessionReader) -> Vec<String> {
    let mut check = CompletenessCheck::new(reader);
    while check.step() {}
    check.finish()
}

/// Finds missing parts message by message, for callers that have other work in between.
pub struct CompletenessCheck<'a> {
    messages: ReaderMessages<'a>,
    begin_ns: u64,
    journal: Option<ChannelId>,
    is_excerpt: bool,
    is_closed: bool,
    /// Time of the last tick.
    last_ns: Option<u64>,
    lines: Vec<String>,
}

impl<'a> CompletenessCheck<'a> {
    pub fn new(reader: &'a SessionReader) -> Self {
        let mut lines = reader.notes().to_vec();
        let tables = reader.metadata().unwrap_or_else(|error| {
            lines.push(error.to_string());
            Vec::new()
        });
        let forces: Vec<String> = arms(reader).into_iter().map(|side| topic(side, "forces")).collect();
        let topics: Vec<&str> = forces.first().map(String::as_str).into_iter().chain([JOURNAL_TOPIC]).collect();
        let journal = reader.channels().iter().find(|channel| channel.topic == JOURNAL_TOPIC);
        Self {
            messages: reader.messages(&topics, 0..u64::MAX),
            begin_ns: plot_channels::beginning_ns(reader).unwrap_or(reader.statistics().times_ns.0),
            journal: journal.map(|channel| channel.id),
            is_excerpt: tables.iter().any(|(name, _)| name == trim::TABLE),
            is_closed: false,
            last_ns: None,
            lines,
        }
    }

    /// Reads one message; returns false at the end of the file.
    pub fn step(&mut self) -> bool {
        match self.messages.next() {
            None => return false,
            Some(Err(error)) => self.lines.push(error.to_string()),
            Some(Ok(message)) if Some(message.channel()) == self.journal => self.of_journal(&message),
            Some(Ok(message)) => self.tick(message.log_time_ns()),
        }
        true
    }

    /// Returns the faults found, one line each.
    pub fn finish(mut self) -> Vec<String> {
        if self.journal.is_some() && !self.is_closed && !self.is_excerpt {
            self.lines.push(match self.last_ns {
                Some(last_ns) => format!(
                    "the recording was not closed: it ends at {:.3} s, where the program was killed or the file was cut",
                    self.seconds(last_ns)
                ),
                None => "the recording was not closed: the program was killed, or the file was cut".to_owned(),
            });
        }
        let rest = self.lines.len().saturating_sub(LINES_MAX);
        self.lines.truncate(LINES_MAX);
        if rest > 0 {
            self.lines.push(format!("{rest} more places are damaged"));
        }
        self.lines
    }

    fn seconds(&self, time_ns: u64) -> f64 {
        time_ns.saturating_sub(self.begin_ns) as f64 * 1e-9
    }

    fn of_journal(&mut self, message: &SessionMessage) {
        let t_s = self.seconds(message.log_time_ns());
        match outline(message.data()) {
            Ok(MessageOutline::Block { lost }) => self
                .lines
                .extend(lost.iter().map(|lost| format!("the recording lost {lost} entries before {t_s:.3} s"))),
            Ok(MessageOutline::End(_)) => self.is_closed = true,
            Ok(_) => {}
            Err(error) => self.lines.push(format!("its journal at {t_s:.3} s: {error}")),
        }
    }

    fn tick(&mut self, time_ns: u64) {
        let Some(last_ns) = self.last_ns.replace(time_ns) else { return };
        let [from_s, to_s] = [last_ns, time_ns].map(|time_ns| self.seconds(time_ns));
        if to_s - from_s > GAP_MAX_S {
            self.lines.push(format!("it has no ticks from {from_s:.3} s to {to_s:.3} s"));
        }
    }
}
