//! The data that a session file lacks: one list for every command that reads a session.

use nima_recording::session::SessionReader;

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
    let mut lines = reader.notes().to_vec();
    let tables = reader.metadata().unwrap_or_else(|error| {
        lines.push(error.to_string());
        Vec::new()
    });
    let is_excerpt = tables.iter().any(|(name, _)| name == trim::TABLE);
    let has_journal = reader.channels().iter().any(|channel| channel.topic == JOURNAL_TOPIC);
    let forces: Vec<String> = arms(reader).into_iter().map(|side| topic(side, "forces")).collect();
    let begin_ns = plot_channels::beginning_ns(reader).unwrap_or(reader.statistics().times_ns.0);
    let seconds = |time_ns: u64| time_ns.saturating_sub(begin_ns) as f64 * 1e-9;
    let mut is_closed = false;
    let mut last_ns = None;
    let topics: Vec<&str> = forces.first().map(String::as_str).into_iter().chain([JOURNAL_TOPIC]).collect();
    let journal = reader.channels().iter().find(|channel| channel.topic == JOURNAL_TOPIC).map(|channel| channel.id);
    for message in reader.messages(&topics, 0..u64::MAX) {
        let message = match message {
            Ok(message) => message,
            Err(error) => {
                lines.push(error.to_string());
                continue;
            }
        };
        let time_ns = message.log_time_ns();
        if Some(message.channel()) == journal {
            match outline(message.data()) {
                Ok(MessageOutline::Block { lost }) => lines.extend(
                    lost.iter()
                        .map(|lost| format!("the recording lost {lost} entries before {:.3} s", seconds(time_ns))),
                ),
                Ok(MessageOutline::End(_)) => is_closed = true,
                Ok(_) => {}
                Err(error) => lines.push(format!("its journal at {:.3} s: {error}", seconds(time_ns))),
            }
            continue;
        }
        if let Some(last_ns) = last_ns.replace(time_ns)
            && seconds(time_ns) - seconds(last_ns) > GAP_MAX_S
        {
            lines.push(format!("it has no ticks from {:.3} s to {:.3} s", seconds(last_ns), seconds(time_ns)));
        }
    }
    if has_journal && !is_closed && !is_excerpt {
        lines.push(match last_ns {
            Some(last_ns) => format!(
                "the recording was not closed: it ends at {:.3} s, where the program was killed or the file was cut",
                seconds(last_ns)
            ),
            None => "the recording was not closed: the program was killed, or the file was cut".to_owned(),
        });
    }
    let rest = lines.len().saturating_sub(LINES_MAX);
    lines.truncate(LINES_MAX);
    if rest > 0 {
        lines.push(format!("{rest} more places are damaged"));
    }
    lines
}
