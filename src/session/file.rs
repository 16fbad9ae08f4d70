//! The journal in a session file.

use std::{iter, ops::Range, path::Path, sync::Arc, thread::Builder};

use crossbeam_channel::bounded;
use nima_recording::{
    messages::foxglove::{Level, Log},
    session::{ReadError, SessionReader},
};
use prost::Message as _;

use crate::{
    journal::{JournalMessage, JournalStart, decode},
    logged::LogValue,
    plot_channels,
    recorder::JOURNAL_TOPIC,
    replay::{Journal, Keyframe, ReplayCursor, ReplayError, StepsMessages, decoded},
    topics::{ALARM_LINE, HAPPENING_LINE, MARK_LINE},
    trim,
};

pub struct RecordedFile(Arc<SessionReader>);

/// Number of journal messages read ahead of the loop when starting from a keyframe: one second of the session.
const AHEAD: usize = 5;
/// Number of journal messages read ahead when starting from the beginning: as many as are stepped at once.
const FAR_AHEAD: usize = 80;

/// The chunk of a keyframe's last block is found by its time; the margin allows for rounding.
const MARGIN_NS: u64 = 1_000_000;

#[derive(Clone, Debug, PartialEq)]
pub struct LogLine {
    /// ns since 1970 (UTC).
    pub time_ns: u64,
    /// Kind of event.
    pub kind: LineKind,
    /// English text.
    pub words: String,
    /// The same as a value; `None` in a session of an earlier version, and where the text may contain a name.
    pub value: Option<LogValue>,
}

/// Kind of a log line, the most urgent first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LineKind {
    Fault,
    /// A moment that the operator marked.
    Mark,
    /// A warning: a command that was refused, or an alarm of the screen.
    Warning,
    /// An event of the scene's objects.
    Happening,
    /// A change of state, a command, a device that connected or disconnected.
    Told,
}

/// Summary of a session file that is available without replaying it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SessionInfo {
    /// Begin (UTC, ISO 8601).
    pub started: Option<String>,
    /// Name of the rig.
    pub rig: Option<String>,
    /// Name of the scene.
    pub scene: Option<String>,
    /// Mode at the start.
    pub mode: Option<String>,
    /// End, s since the start of the session.
    pub seconds: f64,
    /// Start of an excerpt, s since the start of the session; `None` for a whole session.
    pub stretch_from_s: Option<f64>,
}

impl SessionInfo {
    /// Returns the duration of the file's contents, s.
    pub fn length_s(&self) -> f64 {
        self.seconds - self.stretch_from_s.unwrap_or_default()
    }
}

impl RecordedFile {
    /// # Errors
    /// [`ReadError`] if it is not a session file or is damaged.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        SessionReader::open(path).map(|reader| Self(Arc::new(reader)))
    }

    pub fn reader(&self) -> &SessionReader {
        &self.0
    }

    /// Returns when and on which rig it was recorded, and its duration.
    ///
    /// # Errors
    /// [`ReadError`] if its tables cannot be read.
    pub fn about(&self) -> Result<SessionInfo, ReadError> {
        let begin_ns = plot_channels::beginning_ns(&self.0)?;
        let tables = self.0.metadata()?;
        let table = |wanted: &str| tables.iter().find(|(name, _)| name == wanted).map(|(_, table)| table);
        let report = |key: &str| table("session").and_then(|report| report.get(key)).cloned();
        let [first_s, seconds] =
            <[u64; 2]>::from(self.0.statistics().times_ns).map(|time_ns| time_ns.saturating_sub(begin_ns) as f64 / 1e9);
        let stretch_from_s = table(trim::TABLE).map(|_| first_s);
        let [started, rig, scene, mode] = ["started", "rig", "scene", "mode"].map(report);
        Ok(SessionInfo { started, rig, scene, mode, seconds, stretch_from_s })
    }

    /// Returns whether the recording was closed. If not, it is still running, the program was killed, or the file was
    /// cut.
    ///
    /// # Errors
    /// [`ReadError`] if the end cannot be read.
    pub fn is_closed(&self) -> Result<bool, ReadError> {
        let last_ns = self.0.statistics().times_ns.1;
        let end = self.0.messages(&[JOURNAL_TOPIC], last_ns..u64::MAX).last().transpose()?;
        Ok(end.is_some_and(|end| matches!(decode(end.data()), Ok((_, JournalMessage::End(_))))))
    }

    /// Returns the lines of the log between these times (ns).
    ///
    /// # Errors
    /// [`ReadError`] if the log cannot be read.
    pub fn log(&self, times_ns: Range<u64>) -> Result<Vec<LogLine>, ReadError> {
        let line = |message: Result<nima_recording::session::SessionMessage, ReadError>| {
            let message = message?;
            let Ok(line) = Log::decode(message.data()) else { return Ok(None) };
            let kind = match (line.level(), line.name.as_str()) {
                (_, MARK_LINE) => LineKind::Mark,
                (_, HAPPENING_LINE) => LineKind::Happening,
                (Level::Error | Level::Fatal, _) => LineKind::Fault,
                (Level::Warning, _) => LineKind::Warning,
                _ => LineKind::Told,
            };
            let value = line.value.as_deref().and_then(LogValue::decode);
            Ok(Some(LogLine { time_ns: message.log_time_ns(), kind, words: line.message, value }))
        };
        self.0.messages(&["log"], times_ns).map(line).filter_map(Result::transpose).collect()
    }

    /// Returns the number of faults and urgent alarms in the log.
    ///
    /// # Errors
    /// [`ReadError`] if the log cannot be read.
    pub fn alarms(&self) -> Result<usize, ReadError> {
        let mut alarms = 0;
        for message in self.0.messages(&["log"], 0..u64::MAX) {
            let Ok(line) = Log::decode(message?.data()) else { continue };
            let is_alarm = line.level() == Level::Warning && line.name == ALARM_LINE;
            alarms += usize::from(is_alarm || line.level() >= Level::Error);
        }
        Ok(alarms)
    }

    /// Returns time (ns) and text of the last error in the log.
    ///
    /// # Errors
    /// [`ReadError`] if the log cannot be read.
    pub fn last_fault(&self) -> Result<Option<(u64, String)>, ReadError> {
        let mut last = None;
        for message in self.0.messages(&["log"], 0..u64::MAX) {
            let message = message?;
            let line = Log::decode(message.data()).ok().filter(|line| line.level() >= Level::Error);
            last = line.map(|line| (message.log_time_ns(), line.message)).or(last);
        }
        Ok(last)
    }

    /// # Errors
    /// [`ReplayError`] if it has no journal or the journal's beginning cannot be read.
    pub fn journal(&self) -> Result<Journal<StepsMessages>, ReplayError> {
        Journal::open(ahead(Arc::clone(&self.0), 0, 0, FAR_AHEAD))
    }

    /// Returns a loop at this keyframe of its journal, which begins with `start`. `begin_ns` is the start of the
    /// session.
    pub fn cursor(&self, start: &JournalStart, keyframe: Keyframe, begin_ns: u64) -> ReplayCursor<StepsMessages> {
        let from_ns = (begin_ns + (keyframe.t_s() * 1e9) as u64).saturating_sub(MARGIN_NS);
        let messages = ahead(Arc::clone(&self.0), from_ns, keyframe.read(), AHEAD);
        keyframe.cursor(start.clone(), messages)
    }
}

/// Reads the messages of a journal from this time on, after the first `read` messages. A separate thread reads and
/// decodes them ahead of the loop; it ends when the receiver is dropped.
fn ahead(file: Arc<SessionReader>, from_ns: u64, read: u64, max: usize) -> StepsMessages {
    let (send, receive) = bounded(max);
    let go_ahead = move || {
        let messages = file.messages(&[JOURNAL_TOPIC], from_ns..u64::MAX);
        let mut messages = decoded(messages.map(|message| Ok(message?.data().to_vec())), read);
        while messages.next().is_some_and(|message| send.send(message).is_ok()) {}
    };
    match Builder::new().name("journal".to_owned()).spawn(go_ahead) {
        Ok(_) => Box::new(receive.into_iter()),
        Err(error) => Box::new(iter::once(Err(ReplayError::Thread(error)))),
    }
}
