//! The data that a session file lacks: one list for every command that reads a session.

use std::{
    ops::Range,
    sync::atomic::{AtomicBool, Ordering},
};

use nima_machine::runtime::Operation;
use nima_recording::{
    messages::foxglove::Log,
    session::{ChannelId, ReaderMessages, SessionMessage, SessionReader},
};
use prost::Message as _;

use crate::{
    journal::{MessageOutline, outline},
    logged::LogValue,
    plot_channels::{self, arms, topic},
    recorder::JOURNAL_TOPIC,
    topics::LOG_TOPIC,
    trim::{self, CutError},
};

/// A longer time between two ticks is reported, s, unless the log names it as a stall of the computer. The loop has a
/// tick in every period; half a second is more than a busy computer delays it.
const GAP_MAX_S: f64 = 0.5;
/// The same, ns: an excerpt that ends this shortly before the end of a session reaches its end.
const GAP_MAX_NS: u64 = 500_000_000;
/// Maximum number of lines; the rest is counted.
const LINES_MAX: usize = 20;
/// Replaces the lines of an anonymous excerpt that may contain text of the session.
const WITHHELD_LINE: &str = "its original session is damaged or lacks data";

/// Returns the faults of a session, one line each; empty for a whole one. Reads the journal, the log and the forces
/// completely.
///
/// The times are in seconds since the start of the session.
pub fn missing(reader: &SessionReader) -> Vec<String> {
    let mut check = CompletenessCheck::new(reader);
    while check.step() {}
    check.finish()
}

/// A line about missing data, and the part of the session that lacks them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct MissingLine {
    text: String,
    extent: MissingExtent,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MissingExtent {
    /// Damage of the file, at an unknown time.
    File,
    /// A part that cannot be read. An excerpt with this part cannot be saved, so no excerpt lacks it.
    Unreadable,
    /// Data that the original session of this excerpt lacks.
    Original,
    /// First and last time without data, ns.
    Times(u64, u64),
}

impl MissingLine {
    const fn new(text: String, extent: MissingExtent) -> Self {
        Self { text, extent }
    }

    /// Returns whether an excerpt of these times, ns, lacks the data too.
    const fn concerns(&self, times_ns: &Range<u64>) -> bool {
        match self.extent {
            MissingExtent::File | MissingExtent::Original => true,
            MissingExtent::Unreadable => false,
            MissingExtent::Times(first_ns, last_ns) => first_ns < times_ns.end && times_ns.start <= last_ns,
        }
    }

    /// Returns the line for an excerpt of the session.
    pub(crate) fn of_excerpt(self) -> String {
        match self.extent {
            MissingExtent::File => format!("its original session: {}", self.text),
            _ => self.text,
        }
    }

    /// Returns the line for an anonymous excerpt: only lines that this program has built from numbers are kept.
    pub(crate) fn anonymous(self) -> String {
        match self.extent {
            MissingExtent::Times(..) => self.text,
            _ => WITHHELD_LINE.to_owned(),
        }
    }
}

/// Returns the lines about data that an excerpt of these times (ns) lacks because its session lacks them. Reads the
/// journal, the log and the forces completely; setting `asked` stops the reading early.
///
/// # Errors
/// [`CutError::Asked`] once cancellation was requested.
pub(crate) fn missing_in_excerpt(
    reader: &SessionReader,
    times_ns: &Range<u64>,
    asked: &AtomicBool,
) -> Result<Vec<MissingLine>, CutError> {
    let mut check = CompletenessCheck::new(reader);
    while check.step() {
        if asked.load(Ordering::Relaxed) {
            return Err(CutError::Asked);
        }
    }
    let mut lines = check.all_lines();
    lines.retain(|line| line.concerns(times_ns));
    Ok(lines)
}

/// Returns the first lines, and the number of the others in another line.
pub(crate) fn capped(mut lines: Vec<String>) -> Vec<String> {
    let rest = lines.len().saturating_sub(LINES_MAX);
    lines.truncate(LINES_MAX);
    if rest > 0 {
        lines.push(format!("{rest} more places are damaged"));
    }
    lines
}

/// Finds missing parts message by message, for callers that have other work in between.
pub struct CompletenessCheck<'a> {
    messages: ReaderMessages<'a>,
    begin_ns: u64,
    journal: Option<ChannelId>,
    log: Option<ChannelId>,
    is_excerpt: bool,
    is_closed: bool,
    /// Time of the last tick.
    last_ns: Option<u64>,
    /// Time of the first tick after the last stall.
    stalled_ns: Option<u64>,
    /// Time of the last message of the journal.
    block_ns: u64,
    lines: Vec<MissingLine>,
}

impl<'a> CompletenessCheck<'a> {
    pub fn new(reader: &'a SessionReader) -> Self {
        let of_file = |text: String| MissingLine::new(text, MissingExtent::File);
        let mut lines: Vec<MissingLine> = reader.notes().iter().cloned().map(of_file).collect();
        let tables = reader.metadata().unwrap_or_else(|error| {
            lines.push(of_file(error.to_string()));
            Vec::new()
        });
        let excerpts = || tables.iter().filter(|(name, _)| name == trim::TABLE);
        let original = excerpts().flat_map(|(_, table)| trim::missing_in_original(table)).take(LINES_MAX + 1);
        lines.extend(original.map(|text| MissingLine::new(text, MissingExtent::Original)));
        let forces: Vec<String> = arms(reader).into_iter().map(|side| topic(side, "forces")).collect();
        let forces = forces.first().map(String::as_str);
        let topics: Vec<&str> = forces.into_iter().chain([JOURNAL_TOPIC, LOG_TOPIC]).collect();
        let channel = |topic: &str| reader.channels().iter().find(|channel| channel.topic == topic).map(|one| one.id);
        Self {
            messages: reader.messages(&topics, 0..u64::MAX),
            begin_ns: plot_channels::beginning_ns(reader).unwrap_or(reader.statistics().times_ns.0),
            journal: channel(JOURNAL_TOPIC),
            log: channel(LOG_TOPIC),
            is_excerpt: excerpts().next().is_some(),
            is_closed: false,
            last_ns: None,
            stalled_ns: None,
            block_ns: 0,
            lines,
        }
    }

    /// Reads one message; returns false at the end of the file.
    pub fn step(&mut self) -> bool {
        match self.messages.next() {
            None => return false,
            Some(Err(error)) => self.add(error.to_string(), MissingExtent::Unreadable),
            Some(Ok(message)) if Some(message.channel()) == self.journal => self.of_journal(&message),
            Some(Ok(message)) if Some(message.channel()) == self.log => self.of_log(&message),
            Some(Ok(message)) => self.tick(message.log_time_ns()),
        }
        true
    }

    /// Returns the faults found, one line each.
    pub fn finish(self) -> Vec<String> {
        capped(self.all_lines().into_iter().map(|line| line.text).collect())
    }

    fn all_lines(mut self) -> Vec<MissingLine> {
        if self.journal.is_some() && !self.is_closed && !self.is_excerpt {
            let text = match self.last_ns {
                Some(last_ns) => format!(
                    "the recording was not closed: it ends at {:.3} s, where the program was killed or the file was cut",
                    self.seconds(last_ns)
                ),
                None => "the recording was not closed: the program was killed, or the file was cut".to_owned(),
            };
            let from_ns = self.last_ns.unwrap_or_default().saturating_sub(GAP_MAX_NS);
            self.add(text, MissingExtent::Times(from_ns, u64::MAX));
        }
        // An excerpt has some of the faults of its original session itself.
        let is_original = |line: &MissingLine| line.extent == MissingExtent::Original;
        let original: Vec<String> =
            self.lines.iter().filter(|line| is_original(line)).map(|line| line.text.clone()).collect();
        self.lines.retain(|line| is_original(line) || !original.contains(&line.text));
        self.lines
    }

    fn add(&mut self, text: String, extent: MissingExtent) {
        self.lines.push(MissingLine::new(text, extent));
    }

    fn seconds(&self, time_ns: u64) -> f64 {
        time_ns.saturating_sub(self.begin_ns) as f64 * 1e-9
    }

    fn of_journal(&mut self, message: &SessionMessage) {
        let time_ns = message.log_time_ns();
        let t_s = self.seconds(time_ns);
        // The block has the ticks since the previous message.
        let extent = MissingExtent::Times(std::mem::replace(&mut self.block_ns, time_ns), time_ns);
        match outline(message.data()) {
            Ok(MessageOutline::Block { lost }) => {
                for lost in lost {
                    self.add(format!("the recording lost {lost} entries before {t_s:.3} s"), extent);
                }
            }
            Ok(MessageOutline::End(_)) => self.is_closed = true,
            Ok(_) => {}
            Err(error) => self.add(format!("its journal at {t_s:.3} s: {error}"), extent),
        }
    }

    /// Notes a stall of the loop, whose line in the log has the time of the tick before it.
    fn of_log(&mut self, message: &SessionMessage) {
        let Ok(line) = Log::decode(message.data()) else { return };
        let value = line.value.as_deref().and_then(LogValue::decode);
        if let Some(LogValue::Operation(Operation::Stall { t_s, .. })) = value {
            self.stalled_ns = Some(self.begin_ns.saturating_add((t_s.max(0.0) * 1e9).round() as u64));
        }
    }

    fn tick(&mut self, time_ns: u64) {
        let Some(last_ns) = self.last_ns.replace(time_ns) else { return };
        let [from_s, to_s] = [last_ns, time_ns].map(|time_ns| self.seconds(time_ns));
        if to_s - from_s > GAP_MAX_S && self.stalled_ns != Some(time_ns) {
            let extent = MissingExtent::Times(last_ns.saturating_add(1), time_ns.saturating_sub(1));
            self.add(format!("it has no ticks from {from_s:.3} s to {to_s:.3} s"), extent);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use nima_recording::{
        messages::foxglove::Level,
        session::{Encoding, SessionWriter},
    };

    use super::*;
    use crate::{
        journal::{JournalEncoder, JournalEnd},
        topics::{LINE, line},
    };

    const BEGIN_NS: u64 = 1_700_000_000_000_000_000;

    const fn at(ms: u64) -> u64 {
        BEGIN_NS + ms * 1_000_000
    }

    /// Writes a session whose journal has no end, with a tick every 10 ms from 0 to 8 s, and none from 3 to 5 s.
    fn not_closed(path: &Path) -> SessionReader {
        let mut writer = SessionWriter::create(path, "test").unwrap();
        writer.channel(JOURNAL_TOPIC, Encoding::default()).unwrap();
        let forces = writer.channel("right/forces", Encoding::default()).unwrap();
        for ms in (0..=8000).step_by(10).filter(|ms| !(3001..5000).contains(ms)) {
            writer.message(forces, at(ms), b"").unwrap();
        }
        writer.finish().unwrap();
        SessionReader::open(path).unwrap()
    }

    fn excerpt(reader: &SessionReader, times_ns: &Range<u64>, path: &Path) -> SessionReader {
        trim::write(reader, "a session", times_ns, path, &AtomicBool::new(false)).unwrap();
        SessionReader::open(path).unwrap()
    }

    #[test]
    fn an_excerpt_reports_what_its_session_lacks_in_its_time() {
        let folder = tempfile::tempdir().unwrap();
        let session = not_closed(&folder.path().join("session.mcap"));
        let gap = "it has no ticks from 3.000 s to 5.000 s";
        let end = "the recording was not closed: it ends at 8.000 s, where the program was killed or the file was cut";
        assert_eq!(missing(&session), [gap, end]);
        let cases = [
            ("whole", 0..u64::MAX, vec![gap, end]),
            ("first", 0..at(2000), vec![]),
            ("before", 0..at(3000) + 1, vec![]),
            ("into", at(1000)..at(4000), vec![gap]),
            ("across", at(1000)..at(6000), vec![gap]),
            ("after", at(5000)..at(6000), vec![]),
            ("last", at(6000)..at(8000), vec![end]),
        ];
        for (name, times_ns, lines) in cases {
            let part = excerpt(&session, &times_ns, &folder.path().join(format!("{name}.mcap")));
            assert_eq!(missing(&part), lines, "{name}");
            let again = excerpt(&part, &(0..u64::MAX), &folder.path().join(format!("{name}-again.mcap")));
            assert_eq!(missing(&again), lines, "{name}, again");
        }
    }

    #[test]
    fn an_excerpt_of_a_damaged_file_names_its_original_session() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("session.mcap");
        not_closed(&path);
        let bytes = std::fs::read(&path).unwrap();
        // The last byte belongs to the end of the file: all messages are readable.
        let cut = SessionReader::of_bytes("cut.mcap", bytes[..bytes.len() - 1].to_vec()).unwrap();
        let part = excerpt(&cut, &(0..at(2000)), &folder.path().join("part.mcap"));
        let lines = missing(&part);
        assert!(lines.iter().any(|line| line.starts_with("its original session: it is truncated")), "{lines:?}");
    }

    #[test]
    fn a_stall_that_the_log_names_is_not_a_loss() {
        let folder = tempfile::tempdir().unwrap();
        let stalls = [("none", None, 1), ("named", Some(2.0), 0), ("another", Some(0.5), 1)];
        for (name, stalled_s, lines) in stalls {
            let path = folder.path().join(format!("{name}.mcap"));
            let mut writer = SessionWriter::create(&path, "test").unwrap();
            let channel = |writer: &mut SessionWriter, topic: &str| writer.channel(topic, Encoding::default()).unwrap();
            let [journal, log, forces] =
                [JOURNAL_TOPIC, LOG_TOPIC, "right/forces"].map(|topic| channel(&mut writer, topic));
            for ms in (0..=3000).step_by(10).filter(|ms| !(991..2000).contains(ms)) {
                writer.message(forces, at(ms), b"").unwrap();
                if let Some(t_s) = stalled_s.filter(|_| ms == 990) {
                    let value = LogValue::Operation(Operation::Stall { silent_s: 0.02, t_s });
                    let line = line(at(ms), Level::Info, LINE, "a stall".to_owned(), Some(&value));
                    writer.message(log, at(ms), &line).unwrap();
                }
            }
            let end = JournalEncoder::default().end(&JournalEnd { ticks: 0, lost: 0 });
            writer.message(journal, at(3000), &end).unwrap();
            writer.finish().unwrap();
            let session = SessionReader::open(&path).unwrap();
            assert_eq!(missing(&session).len(), lines, "{name}: {:?}", missing(&session));
            // Without the journal.
            let part = excerpt(&session, &(at(500)..at(2500)), &folder.path().join(format!("{name}-part.mcap")));
            assert_eq!(missing(&part).len(), lines, "{name}: {:?}", missing(&part));
        }
    }

    #[test]
    fn lines_of_a_file_are_capped_and_without_control_characters() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.mcap");
        let mut writer = SessionWriter::create(&path, "test").unwrap();
        let lines = "\u{1b}[31mred\n".repeat(100);
        writer.metadata(trim::TABLE, &[("missing".to_owned(), lines)].into()).unwrap();
        writer.finish().unwrap();
        let lines = missing(&SessionReader::open(&path).unwrap());
        assert_eq!(lines.len(), LINES_MAX + 1);
        assert!(lines.iter().all(|line| !line.contains(char::is_control)), "{lines:?}");
    }
}
