//! Writes a session without any data that reveal who recorded it, where or when.
//!
//! Nothing is copied. Messages of known topics are rebuilt from their numbers, under this program's own names and with
//! times that begin in 1970; everything else is left out. Data that a later version adds to a session are therefore
//! left out until they are handled here.

use std::{collections::BTreeMap, fs, ops::Range, path::Path, sync::atomic::AtomicBool, time::UNIX_EPOCH};

use nima_core::impedance::Mode;
use nima_machine::{
    rig::{DeviceName, Side},
    runtime::ClockProfile,
};
use nima_recording::{
    messages::{
        JointStateDecoder,
        foxglove::{self, FrameTransforms, Level, Log, SceneUpdate},
    },
    session::{ChannelId, SessionMessage, SessionReader, SessionWriter},
};
use prost::Message as _;

use crate::{
    calibration_metadata::{FIGURES, VERDICTS, verdicts},
    completeness::{self, MissingLine},
    layouts::layouts,
    logged::LogValue,
    objects, plot_channels,
    recorder::AttachedFile,
    sinks::{SessionSinks, SinkChannel},
    topics::{
        ALARM_LINE, ARROWS_TOPIC, FRAMES_TOPIC, HAPPENING_LINE, HAPPENINGS_TOPIC, LINE, LOG_TOPIC, MARK_LINE,
        MARKS_TOPIC, RINGS_TOPIC, SentenceChannel, happenings_channel, line, marks, marks_channel, marks_of,
        plot::Plot, plots, redrawn, rings, rings_channel, rings_of,
    },
    trim::{self, CutError, stretch},
};

/// Replaces a text that may identify someone.
pub const WITHHELD: &str = "(withheld)";
/// Key in the table of the session that marks it as anonymous.
pub const ANONYMOUS: &str = "anonymous";
/// The table of the session, and the entries of it that are kept if their value is one of these.
const TABLE: &str = "session";
const WORDS: [(&str, &[&str]); 2] = [("clock", &["real", "virtual"]), ("build", &["debug", "release"])];
/// Prefix of the tables of calibrations.
const CALIBRATIONS: &str = "calibrations ";
/// The entries that are kept if they are numbers.
const NUMBERS: [&str; 2] = ["rate_hz", "delay_s"];

/// Input of the caller, in addition to the session itself.
pub struct SessionFacts<'a> {
    /// Name and version of this program.
    pub program: &'a str,
    /// Files to attach instead of the session's own.
    pub files: &'a [AttachedFile],
    /// Texts for the values of the log.
    pub words: SentenceChannel,
    /// The devices of the session's rig, in the order of its roster.
    pub devices: &'a [DeviceName],
}

impl std::fmt::Debug for SessionFacts<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Known").field("files", &self.files).finish_non_exhaustive()
    }
}

/// Writes the messages between these times (ns), without identifying data, into a new file and returns their number.
/// Setting `asked` stops the writing early.
///
/// # Errors
/// [`CutError`] if the session cannot be read or the file cannot be written. The caller must then delete the file.
pub fn write(
    reader: &SessionReader,
    known: &SessionFacts<'_>,
    times_ns: &Range<u64>,
    to: &Path,
    asked: &AtomicBool,
) -> Result<u64, CutError> {
    let begin_ns = plot_channels::beginning_ns(reader)?;
    let mut writer = SessionWriter::create(to, known.program)?;
    for (name, entries) in reader.metadata()? {
        if name == TABLE {
            writer.metadata(TABLE, &about(&entries))?;
        } else if name.strip_prefix(CALIBRATIONS).is_some_and(is_ours) {
            writer.metadata(&name, &kept(&entries, &VERDICTS.map(|key| (key, verdicts().collect())), &FIGURES))?;
        }
    }
    let mut table = stretch(0, &(times_ns.start.saturating_sub(begin_ns)..since(times_ns.end, begin_ns)));
    let missing = completeness::missing_in_excerpt(reader, times_ns, asked)?;
    let mut missing: Vec<String> = missing.into_iter().map(MissingLine::anonymous).collect();
    missing.dedup();
    trim::note_missing(&mut table, missing);
    writer.metadata(trim::TABLE, &table)?;
    let forces = Side::ALL.map(|side| format!("{}/forces", side.word()));
    let sides = forces.map(|topic| reader.channels().iter().any(|channel| channel.topic == topic));
    for AttachedFile { name, media_type, data } in known.files.iter().chain(&layouts(sides)) {
        writer.attachment(name, media_type, 0, data)?;
    }
    let mut out = SessionSinks::of(writer);
    let mut topics: BTreeMap<ChannelId, RewrittenTopic> = BTreeMap::new();
    for channel in reader.channels() {
        if let Some(topic) = RewrittenTopic::named(&channel.topic, &mut out)? {
            topics.insert(channel.id, topic);
        }
    }
    for message in reader.messages(&[], times_ns.clone()) {
        let message = trim::unless(asked, message)?;
        if let Some(topic) = topics.get_mut(&message.channel()) {
            topic.pass(&mut out, since(message.log_time_ns(), begin_ns), &message, known)?;
        }
    }
    let messages = out.finish()?;
    // The file's times would reveal when the session was viewed.
    let times = fs::FileTimes::new().set_modified(UNIX_EPOCH).set_accessed(UNIX_EPOCH);
    fs::File::options().write(true).open(to).and_then(|file| file.set_times(times)).map_err(CutError::Times)?;
    Ok(messages)
}

const fn since(time_ns: u64, begin_ns: u64) -> u64 {
    if time_ns == u64::MAX { time_ns } else { time_ns.saturating_sub(begin_ns) }
}

/// Returns the entries of a session's table that reveal no persons, places or dates.
fn about(table: &BTreeMap<String, String>) -> BTreeMap<String, String> {
    let words = WORDS.map(|(key, words)| (key, words.to_vec()));
    let mode = table.get("mode").and_then(|mode| mode.parse::<Mode>().ok()).map(|mode| ("mode", mode.to_string()));
    let profile = table.get("clock_profile").and_then(|profile| profile.parse::<ClockProfile>().ok());
    let profile = profile.map(|profile| ("clock_profile", profile.to_string()));
    let mut about = kept(table, &words, &NUMBERS);
    about.extend(
        mode.into_iter()
            .chain(profile)
            .chain([(ANONYMOUS, "yes".to_owned())])
            .map(|(key, value)| (key.to_owned(), value)),
    );
    about
}

/// Returns the entries of a table with these keys whose values are numbers or in the list of this key.
fn kept(table: &BTreeMap<String, String>, words: &[(&str, Vec<&str>)], numbers: &[&str]) -> BTreeMap<String, String> {
    let word = |(key, words): &(&str, Vec<&str>)| {
        Some(((*key).to_owned(), table.get(*key).filter(|value| words.contains(&value.as_str()))?.clone()))
    };
    let number = |key: &&str| Some(((*key).to_owned(), table.get(*key)?.parse::<f64>().ok()?.to_string()));
    words.iter().filter_map(word).chain(numbers.iter().filter_map(number)).collect()
}

/// Returns whether calibrations belong to a side or have a number.
fn is_ours(of: &str) -> bool {
    Side::ALL.iter().any(|side| side.word() == of) || of.parse::<u32>().is_ok()
}

/// A topic that is rebuilt.
enum RewrittenTopic {
    Numbers { topic: String, names: Vec<String>, forces: bool, decoder: JointStateDecoder, plot: Option<Plot> },
    Frames(SinkChannel),
    Arrows(SinkChannel),
    Rings(SinkChannel),
    Marks(SinkChannel),
    Happenings(SinkChannel),
    Log(SinkChannel),
}

impl RewrittenTopic {
    /// Returns the topic of this name; `None` for a topic that is left out.
    fn named(name: &str, out: &mut SessionSinks) -> Result<Option<Self>, CutError> {
        Ok(match name {
            FRAMES_TOPIC => Some(Self::Frames(out.channel(name, foxglove::encoding::<FrameTransforms>())?)),
            ARROWS_TOPIC => Some(Self::Arrows(out.channel(name, foxglove::encoding::<SceneUpdate>())?)),
            RINGS_TOPIC => Some(Self::Rings(rings_channel(out)?)),
            MARKS_TOPIC => Some(Self::Marks(marks_channel(out)?)),
            HAPPENINGS_TOPIC => Some(Self::Happenings(happenings_channel(out)?)),
            LOG_TOPIC => Some(Self::Log(out.channel(name, foxglove::encoding::<Log>())?)),
            _ => plots().into_iter().find(|(topic, ..)| topic == name).map(|(topic, names, forces)| Self::Numbers {
                topic,
                names,
                forces,
                decoder: JointStateDecoder::default(),
                plot: None,
            }),
        })
    }

    /// Rebuilds the message; an unreadable message is left out.
    fn pass(
        &mut self,
        out: &mut SessionSinks,
        time_ns: u64,
        message: &SessionMessage,
        known: &SessionFacts<'_>,
    ) -> Result<(), CutError> {
        let data = message.data();
        match self {
            Self::Numbers { topic, names, forces, decoder, plot } => {
                if !decoder.decode(data) {
                    return Ok(());
                }
                // Leave out other columns.
                let column =
                    |(name, value): (&String, &f64)| Some((names.iter().find(|known| *known == name)?, *value));
                let columns: Vec<(&String, f64)> =
                    decoder.names().iter().zip(decoder.values()).filter_map(column).collect();
                if columns.is_empty() {
                    return Ok(());
                }
                let plot = if let Some(plot) = plot {
                    plot
                } else {
                    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
                    plot.insert(Plot::new(out, topic, &names)?)
                };
                plot.values.extend(columns.iter().map(|(_, value)| value));
                plot.write(out, time_ns, *forces)?;
            }
            Self::Frames(channel) => {
                if let Ok(frames) = FrameTransforms::decode(data) {
                    out.message(*channel, time_ns, &redrawn::frames(time_ns, &frames).encode_to_vec())?;
                }
            }
            Self::Arrows(channel) => {
                if let Ok(scene) = SceneUpdate::decode(data) {
                    out.message(*channel, time_ns, &redrawn::arrows(time_ns, &scene).encode_to_vec())?;
                }
            }
            Self::Rings(channel) => {
                out.message(*channel, time_ns, &rings(time_ns, &rings_of(data)).encode_to_vec())?;
            }
            Self::Marks(channel) => {
                out.message(*channel, time_ns, &marks(time_ns, &marks_of(data)).encode_to_vec())?;
            }
            Self::Happenings(channel) => {
                if let Some(happening) = objects::decode(data) {
                    out.message(*channel, time_ns, &objects::encode(&happening))?;
                }
            }
            Self::Log(channel) => {
                if let Ok(log) = Log::decode(data) {
                    let level = Level::try_from(log.level).unwrap_or(Level::Info);
                    let name = [MARK_LINE, ALARM_LINE, HAPPENING_LINE]
                        .into_iter()
                        .find(|name| *name == log.name)
                        .unwrap_or(LINE);
                    let value = log.value.as_deref().and_then(LogValue::decode);
                    let words = value.as_ref().map_or_else(
                        || WITHHELD.to_owned(),
                        |value| known.words.of(value, known.devices).unwrap_or(log.message),
                    );
                    out.message(*channel, time_ns, &line(time_ns, level, name, words, value.as_ref()))?;
                }
            }
        }
        Ok(())
    }
}
