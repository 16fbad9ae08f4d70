//! Saves an excerpt of a session as a session file.
//!
//! A journal can be replayed only from its beginning. An excerpt that begins with the first tick keeps the journal up
//! to its end; any other excerpt omits it.

use std::{
    collections::BTreeMap,
    io,
    ops::Range,
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
};

use nima_files::{PASSAGE, shortened};
use nima_recording::session::{ChannelId, ReadError, SessionMessage, SessionReader, SessionWriter, WriteError};

use crate::{
    completeness::{self, MissingLine},
    plot_channels,
    recorder::JOURNAL_TOPIC,
};

/// The table with the origin of an excerpt.
pub(crate) const TABLE: &str = "cut";
/// The table with the start of the loop's clock, which is later than the beginning of the file.
pub(crate) const CLOCK_TABLE: &str = "clock";
/// Key in both tables: start of the session, ns, so that times remain those of the whole session.
pub(crate) const BEGINNING: &str = "session_begins_ns";
/// Key in the table of an excerpt: name of the session.
pub(crate) const SESSION: &str = "session";
/// Key in the table of an excerpt: the data that its session lacks, one line each. Absent if it lacks none, and in
/// excerpts of older versions.
const MISSING: &str = "missing";

#[derive(Debug, thiserror::Error)]
pub enum CutError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("cannot set the times of the new file; check the permissions of its folder")]
    Times(#[source] io::Error),
    #[error("ended on request: nothing was written")]
    Asked,
}

/// Result of saving an excerpt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    pub messages: u64,
    /// Whether the journal was kept.
    pub journal: JournalOutcome,
}

/// Outcome for the journal of an excerpt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JournalOutcome {
    /// The journal is kept up to the end of the excerpt.
    Yes,
    /// Omitted, because the excerpt does not begin with the first tick.
    LeftOut,
    /// The session has no journal.
    None,
}

impl JournalOutcome {
    const fn word(self) -> &'static str {
        match self {
            Self::Yes => "kept up to the end of the stretch",
            Self::LeftOut => "left out: it can be replayed from its beginning only",
            Self::None => "none",
        }
    }
}

/// Writes the messages between these times (ns) into a new file, with all attachments and tables. `name` is the
/// session's name in the table with the excerpt's origin; the table also names the data that the session lacks in this
/// time. Setting `asked` stops the writing early.
///
/// # Errors
/// [`CutError`] if the session cannot be read or the file cannot be written. The caller must then delete the file.
pub fn write(
    reader: &SessionReader,
    name: &str,
    times_ns: &Range<u64>,
    to: &Path,
    asked: &AtomicBool,
) -> Result<Cut, CutError> {
    let begin_ns = plot_channels::beginning_ns(reader)?;
    let journal = journal(reader, times_ns.start)?;
    // The start state of the loop is stored before the first tick.
    let start_ns = if journal == JournalOutcome::Yes { 0 } else { times_ns.start };
    let mut writer = SessionWriter::create(to, reader.library())?;
    let mut tables = reader.metadata()?;
    let before = tables.iter().position(|(name, _)| name == TABLE).map(|place| tables.remove(place).1);
    let mut table = table(name, begin_ns, times_ns, journal, before.as_ref());
    let missing = completeness::missing_in_excerpt(reader, times_ns, asked)?;
    note_missing(&mut table, missing.into_iter().map(MissingLine::of_excerpt).collect());
    tables.push((TABLE.to_owned(), table));
    for (name, entries) in &tables {
        writer.metadata(name, entries)?;
    }
    for attachment in reader.attachments() {
        let data = reader.attachment(attachment)?;
        writer.attachment(&attachment.name, &attachment.media_type, attachment.log_time_ns, &data)?;
    }
    let mut channels: BTreeMap<ChannelId, ChannelId> = BTreeMap::new();
    for channel in reader.channels() {
        if journal != JournalOutcome::LeftOut || channel.topic != JOURNAL_TOPIC {
            channels.insert(channel.id, writer.channel(&channel.topic, channel.encoding.clone())?);
        }
    }
    for message in reader.messages(&[], start_ns..times_ns.end) {
        let message = unless(asked, message)?;
        if let Some(channel) = channels.get(&message.channel()) {
            writer.message(*channel, message.log_time_ns(), message.data())?;
        }
    }
    Ok(Cut { messages: writer.finish()?.messages, journal })
}

/// Returns the message, or an error once cancellation was requested.
pub(crate) fn unless(
    asked: &AtomicBool,
    message: Result<SessionMessage, ReadError>,
) -> Result<SessionMessage, CutError> {
    if asked.load(Ordering::Relaxed) { Err(CutError::Asked) } else { Ok(message?) }
}

/// Returns whether an excerpt that begins here can keep the journal.
fn journal(reader: &SessionReader, start_ns: u64) -> Result<JournalOutcome, ReadError> {
    if reader.channels().iter().all(|channel| channel.topic != JOURNAL_TOPIC) {
        return Ok(JournalOutcome::None);
    }
    let topics: Vec<String> =
        plot_channels::arms(reader).into_iter().map(|arm| plot_channels::topic(arm, "forces")).collect();
    let topics: Vec<&str> = topics.iter().map(String::as_str).collect();
    let first = reader.messages(&topics, 0..u64::MAX).next().transpose()?;
    let is_first = first.is_none_or(|first| start_ns <= first.log_time_ns());
    Ok(if is_first { JournalOutcome::Yes } else { JournalOutcome::LeftOut })
}

/// Returns the table of an excerpt of the session with this name.
pub(crate) fn table(
    name: &str,
    begin_ns: u64,
    times_ns: &Range<u64>,
    journal: JournalOutcome,
    before: Option<&BTreeMap<String, String>>,
) -> BTreeMap<String, String> {
    // An excerpt of an excerpt counts as an excerpt of the original session.
    let session = before.and_then(|before| before.get(SESSION)).map_or(name, String::as_str);
    let mut table = stretch(begin_ns, times_ns);
    for (key, value) in [(SESSION, session), ("journal", journal.word())] {
        table.insert(key.to_owned(), value.to_owned());
    }
    table
}

/// Adds the data that the session lacks, one line each, to the table of its excerpt.
pub(crate) fn note_missing(table: &mut BTreeMap<String, String>, lines: Vec<String>) {
    if !lines.is_empty() {
        table.insert(MISSING.to_owned(), completeness::capped(lines).join("\n"));
    }
}

/// Returns the data that the original session of an excerpt with this table lacks, one line each. The text comes from a
/// file, so it is shortened, and control characters are escaped.
pub(crate) fn missing_in_original(table: &BTreeMap<String, String>) -> impl Iterator<Item = String> {
    table.get(MISSING).map_or("", String::as_str).lines().map(|line| shortened(line, PASSAGE))
}

/// Returns the table of an excerpt: its times (s) in a session that begins at `begin_ns`.
pub(crate) fn stretch(begin_ns: u64, times_ns: &Range<u64>) -> BTreeMap<String, String> {
    let seconds = |time_ns: u64| match time_ns {
        u64::MAX => "the end".to_owned(),
        time_ns => (time_ns.saturating_sub(begin_ns) as f64 / 1e9).to_string(),
    };
    let entries =
        [("from_s", seconds(times_ns.start)), ("to_s", seconds(times_ns.end)), (BEGINNING, begin_ns.to_string())];
    entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}
