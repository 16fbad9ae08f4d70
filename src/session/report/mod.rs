//! Statistics of a session from its plotted signals; nothing is replayed.

mod arm;
mod force;
mod images;
#[cfg(test)]
mod tests;
mod trace;

use std::{collections::BTreeMap, path::Path};

use nima_machine::{rig::Side, runtime::STALL_MAX_S};
use nima_recording::{
    messages::foxglove::{Level, Log},
    session::{ReadError, SessionMessage, SessionReader},
};
use prost::Message as _;
use serde::Serialize;

pub use arm::{
    ArmFigures, DEGREE_COLUMNS, FORCES, GateFraction, IdentificationFigures, NetworkFigures, STATES, StateSpan,
};
pub use force::ForceFigures;
pub use images::ImageReport;
pub use trace::{BUCKETS, SignalTrace};

use crate::{
    images::{IMAGE_FIGURES_TOPIC, IMAGE_TOPIC, VIDEO_TOPIC},
    journal::{MessageOutline, outline},
    objects::{self, kind},
    plot_channels,
    recorder::JOURNAL_TOPIC,
    topics::{
        HAPPENING_LINE, HAPPENINGS_TOPIC, LOG_TOPIC, MARK_LINE, MARKS_TOPIC, RINGS_TOPIC, TASK_TOPIC, TIMES,
        TIMING_TOPIC, columns::TopicColumns,
    },
    trim,
};
use arm::ArmCollector;

/// A shorter time without ticks is lateness, not a stall, periods.
const STALL_MIN_PERIODS: f64 = 2.5;
/// Maximum number of notes on damage that are kept; the rest are only counted.
const NOTES: usize = 20;

#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    #[error(transparent)]
    File(#[from] ReadError),
    #[error(
        "{path} contains neither a journal nor plots written by this program; choose a file written by `nima run --record` or the console"
    )]
    Foreign { path: String },
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SessionFigures {
    pub file: String,
    /// Faults of the file and missing parts, one line each.
    pub notes: Vec<String>,
    /// Information from the recorder: program, build, system, start, clock, rig, scene, seed and others.
    pub about: BTreeMap<String, String>,
    /// Tables of calibrations: `right`, `left`, and by number those that became active later.
    pub calibrations: BTreeMap<String, BTreeMap<String, String>>,
    pub length_s: f64,
    /// Whether the recording was closed; if not, the program was killed or the file was cut. `None` without a journal.
    pub closed: Option<bool>,
    /// Whether it is an excerpt of a session.
    pub stretch: bool,
    /// Gaps in the journal.
    pub holes: Vec<MissingTicks>,
    /// Stalls of the computer.
    pub stalls: Vec<Stall>,
    pub arms: Vec<ArmFigures>,
    /// Events in order.
    pub marks: Vec<EventMark>,
    /// Number of events of each kind, as named by [`kind`]. `None` if there was no source of events.
    pub happenings: Option<BTreeMap<String, u64>>,
    /// Statistics of the endoscope images. `None` if there are none.
    #[serde(rename = "pictures")]
    pub images: Option<ImageReport>,
    /// The timing of the loop, if the file has it.
    pub timing: Option<LoopTimes>,
}

/// A time without ticks that is long enough to switch the drives off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stall {
    /// Last tick before it, s since the start of the session.
    pub from_s: f64,
    /// Time for which the loop was silent, s.
    pub length_s: f64,
}

/// A gap in the journal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MissingTicks {
    /// End of the block with the gap, s since the start of the session.
    pub until_s: f64,
    /// Number of missing entries.
    pub lost: u64,
}

/// A single event.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EventMark {
    /// s since the start of the session.
    pub t_s: f64,
    /// Severity or kind.
    pub level: MarkLevel,
    /// Text.
    pub words: String,
}

/// Severity or kind of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MarkLevel {
    /// A fault.
    Error,
    /// A refusal, or an alarm.
    Warning,
    /// Any other event.
    Info,
    /// A moment that the operator marked.
    Mark,
    /// An event of the scene's objects.
    Event,
}

impl MarkLevel {
    /// Returns the name used in files.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Info => "info",
            Self::Mark => "mark",
            Self::Event => "event",
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LoopTimes {
    /// Number of missed periods.
    pub missed: u64,
    /// The seconds in which periods were missed: their ends, s, and the number of missed periods.
    pub missed_in: Vec<(f64, u64)>,
    /// Median, 99 %, 99.9 % and maximum, us, of the wake-up delay, of the work, and from sample to force; `None` where
    /// nothing was timed.
    pub times_us: [Option<[f64; 4]>; TIMES.len()],
}

impl SessionFigures {
    /// Reads a session.
    ///
    /// # Errors
    /// [`ReportError`] if it is not a session of this program.
    pub fn read(path: &Path) -> Result<Self, ReportError> {
        let reader = SessionReader::open(path)?;
        Self::of(&path.display().to_string(), &reader)
    }

    fn of(file: &str, reader: &SessionReader) -> Result<Self, ReportError> {
        let has = |topic: &str| reader.channels().iter().any(|channel| channel.topic == topic);
        let sides: Vec<Side> =
            Side::ALL.into_iter().filter(|side| has(&topic(*side, "forces")) && has(&topic(*side, "gates"))).collect();
        if !has(JOURNAL_TOPIC) && sides.is_empty() {
            return Err(ReportError::Foreign { path: file.to_owned() });
        }
        let mut figures = Self { file: file.to_owned(), notes: reader.notes().to_vec(), ..Self::default() };
        figures.tables(reader);
        let (first_ns, last_ns) = reader.times_ns().unwrap_or_default();
        let first_ns = if figures.stretch { first_ns } else { plot_channels::beginning_ns(reader).unwrap_or(first_ns) };
        figures.length_s = last_ns.saturating_sub(first_ns) as f64 * 1e-9;
        figures.closed = has(JOURNAL_TOPIC).then_some(false);
        figures.happenings = has(HAPPENINGS_TOPIC).then(BTreeMap::new);
        if sides.is_empty() {
            figures.notes.push("it has no plots: forces, states and gates are not known".to_owned());
        }
        let rate_hz = figures.about.get("rate_hz").and_then(|rate| rate.parse().ok()).filter(|rate: &f64| *rate > 0.0);
        let mut reading = FilePass::new(reader, first_ns, &sides, figures.length_s, 1.0 / rate_hz.unwrap_or(1000.0));
        reading.all(&mut figures);
        figures.arms = reading.arms.into_iter().map(|(_, arm)| arm.figures()).collect();
        if sides.iter().any(|side| !has(&topic(*side, "identification"))) || !has(TIMING_TOPIC) {
            let note =
                "an older version recorded it: errors of the modes, degrees, doubt and timing are not in the file";
            figures.notes.push(note.to_owned());
        }
        Ok(figures)
    }

    fn tables(&mut self, reader: &SessionReader) {
        match reader.metadata() {
            Err(error) => self.notes.push(error.to_string()),
            Ok(tables) => {
                for (name, table) in tables {
                    if let Some(of) = name.strip_prefix("calibrations ") {
                        self.calibrations.insert(of.to_owned(), table);
                    } else if name == "session" {
                        self.about = table;
                    } else if name == trim::TABLE {
                        self.stretch = true;
                        self.notes.extend(trim::missing_in_original(&table));
                    }
                }
            }
        }
    }
}

fn topic(side: Side, what: &str) -> String {
    format!("{}/{what}", side.word())
}

/// The role of a message for an arm, or for the whole session.
#[derive(Clone, Copy)]
enum MessageKind {
    Forces(usize),
    Gates(usize),
    Identification(usize),
    Timing,
    Log,
    Journal,
    Happening,
    Picture,
}

struct ReportChannel {
    id: nima_recording::session::ChannelId,
    kind: MessageKind,
    /// Only for a topic of numbers.
    columns: Option<TopicColumns>,
}

/// Reads the file once.
struct FilePass<'a> {
    reader: &'a SessionReader,
    first_ns: u64,
    channels: Vec<ReportChannel>,
    arms: Vec<(Side, ArmCollector)>,
    damaged: usize,
    /// Last tick of the first arm, s.
    last_s: Option<f64>,
    /// A longer time without ticks is a stall, s.
    stall_min_s: f64,
}

impl<'a> FilePass<'a> {
    fn new(reader: &'a SessionReader, first_ns: u64, sides: &[Side], length_s: f64, period_s: f64) -> Self {
        let mut kinds = vec![
            (TIMING_TOPIC.to_owned(), MessageKind::Timing),
            (LOG_TOPIC.to_owned(), MessageKind::Log),
            (JOURNAL_TOPIC.to_owned(), MessageKind::Journal),
            (HAPPENINGS_TOPIC.to_owned(), MessageKind::Happening),
            (IMAGE_FIGURES_TOPIC.to_owned(), MessageKind::Picture),
        ];
        for (arm, &side) in sides.iter().enumerate() {
            kinds.push((topic(side, "forces"), MessageKind::Forces(arm)));
            kinds.push((topic(side, "gates"), MessageKind::Gates(arm)));
            kinds.push((topic(side, "identification"), MessageKind::Identification(arm)));
        }
        let of = |channel: &nima_recording::session::ReaderChannel| {
            let &(_, kind) = kinds.iter().find(|(topic, _)| *topic == channel.topic)?;
            Some(ReportChannel { id: channel.id, kind, columns: TopicColumns::of(&channel.topic) })
        };
        let channels = reader.channels().iter().filter_map(of).collect();
        let arms = sides.iter().map(|&side| (side, ArmCollector::new(side.word(), length_s, period_s))).collect();
        // A slow loop has long periods.
        let stall_min_s = STALL_MAX_S.max(STALL_MIN_PERIODS * period_s);
        Self { reader, first_ns, channels, arms, damaged: 0, last_s: None, stall_min_s }
    }

    fn all(&mut self, figures: &mut SessionFigures) {
        let topics: Vec<&str> = self.reader.channels().iter().map(|channel| channel.topic.as_str()).collect();
        let drawn = ["frames", "arrows", RINGS_TOPIC, MARKS_TOPIC, IMAGE_TOPIC, VIDEO_TOPIC];
        let skipped = drawn.into_iter().chain(["right/poses", "left/poses", "right/jaws", "left/jaws", TASK_TOPIC]);
        let skipped: Vec<&str> = skipped.collect();
        let topics: Vec<&str> = topics.into_iter().filter(|topic| !skipped.contains(topic)).collect();
        for message in self.reader.messages(&topics, 0..u64::MAX) {
            match message {
                Ok(message) => self.message(&message, figures),
                Err(error) => {
                    self.damaged += 1;
                    if self.damaged <= NOTES {
                        figures.notes.push(error.to_string());
                    }
                }
            }
        }
        if self.damaged > NOTES {
            figures.notes.push(format!("{} more places are damaged", self.damaged - NOTES));
        }
    }

    fn message(&mut self, message: &SessionMessage, figures: &mut SessionFigures) {
        let Some(channel) = self.channels.iter_mut().find(|channel| channel.id == message.channel()) else { return };
        let t_s = message.log_time_ns().saturating_sub(self.first_ns) as f64 * 1e-9;
        let data = message.data();
        match channel.kind {
            MessageKind::Journal => return journal(t_s, data, figures),
            MessageKind::Log => return figures.marks.extend(mark(t_s, data)),
            MessageKind::Happening => {
                let event = objects::decode(data).map(|happening| kind(&happening.event));
                if let (Some(event), Some(happenings)) = (event, &mut figures.happenings) {
                    *happenings.entry(event).or_default() += 1;
                }
                return;
            }
            MessageKind::Picture => return figures.images.get_or_insert_default().take(t_s, data),
            _ => {}
        }
        let Some(values) = channel.columns.as_mut().and_then(|columns| columns.read(data)) else { return };
        match channel.kind {
            MessageKind::Timing => timing(t_s, values, figures),
            MessageKind::Forces(arm) => {
                self.arms[arm].1.forces(t_s, values);
                if let Some(from_s) = (arm == 0).then(|| self.last_s.replace(t_s)).flatten()
                    && t_s - from_s > self.stall_min_s
                {
                    figures.stalls.push(Stall { from_s, length_s: t_s - from_s });
                }
            }
            MessageKind::Gates(arm) => self.arms[arm].1.gates(t_s, values),
            MessageKind::Identification(arm) => self.arms[arm].1.identified(values),
            MessageKind::Journal | MessageKind::Log | MessageKind::Happening | MessageKind::Picture => {}
        }
    }
}

fn journal(t_s: f64, data: &[u8], figures: &mut SessionFigures) {
    match outline(data) {
        Ok(MessageOutline::Start | MessageOutline::Calibrations) => {}
        Ok(MessageOutline::Block { lost }) => {
            figures.holes.extend(lost.into_iter().map(|lost| MissingTicks { until_s: t_s, lost }));
        }
        Ok(MessageOutline::End(_)) => figures.closed = Some(true),
        Err(error) => {
            let note = format!("its journal: {error}");
            // One line covers all messages of another version.
            if !figures.notes.contains(&note) {
                figures.notes.push(note);
            }
        }
    }
}

fn mark(t_s: f64, data: &[u8]) -> Option<EventMark> {
    let log = Log::decode(data).ok()?;
    let level = match log.level {
        _ if log.name == MARK_LINE => MarkLevel::Mark,
        _ if log.name == HAPPENING_LINE => MarkLevel::Event,
        level if level >= Level::Error as i32 => MarkLevel::Error,
        level if level == Level::Warning as i32 => MarkLevel::Warning,
        _ => MarkLevel::Info,
    };
    Some(EventMark { t_s, level, words: log.message })
}

fn timing(t_s: f64, values: &[f64], figures: &mut SessionFigures) {
    let Some((&missed, times_us)) = values.split_first() else { return };
    let times = figures.timing.get_or_insert_default();
    let missed = missed as u64;
    if missed > times.missed {
        times.missed_in.push((t_s, missed - times.missed));
    }
    times.missed = missed;
    for (time_us, values) in times.times_us.iter_mut().zip(times_us.chunks_exact(4)) {
        *time_us = values.try_into().ok().filter(|values: &[f64; 4]| values.iter().all(|value| value.is_finite()));
    }
}
