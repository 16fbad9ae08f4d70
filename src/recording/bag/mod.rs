//! Reading motion and force from recordings of ROS 2 and other programs (MCAP), by topic and field:
//! `x=/tool/pose.pose.position.x`.
//!
//! The messages of the force give the times; quantities of other topics are interpolated to them. Times are those in the
//! messages' headers, else of the recording. Samples within a gap of another topic are left out, and so are messages about
//! other joints.

mod codec;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use nima_core::impedance::{AXES, Sample};
use nima_files::{PASSAGE, quoted, shortened};

use crate::{
    csv::{AXIS_NAMES, ColumnMapping, CsvRecording, RecordingError, Signals},
    session::{ReadError, SessionReader},
};
use codec::{BagField, BagNumber, BagValue, examples};

/// Encoding of the messages of ROS 2.
const CDR: &str = "cdr";
/// First bytes of a frame of Zstandard (RFC 8878); those of a message are 0 and the byte order.
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// Maximum time between two messages of a topic over which is interpolated, s: three messages of a slow tracker.
const GAP_S: f64 = 0.1;
/// Maximum time by which a message may come after a later one, s: several publishers of a topic overtake each other by
/// the time of a message. A clock that is set steps further.
const LATE_S: f64 = 0.02;
/// Minimum number of samples.
const MIN_SAMPLES: usize = 3;

#[derive(Debug, thiserror::Error)]
pub enum BagError {
    #[error("{0}")]
    Read(#[from] ReadError),
    #[error(transparent)]
    Recording(#[from] RecordingError),
    #[error("cannot read recording {path}: {why}", path = .path.display())]
    Folder { path: PathBuf, why: String },
    #[error(
        "recording {path} needs a topic and a field for each quantity, such as --map fz=/sensor/wrench.wrench.force.z; it has: {available}",
        path = .path.display()
    )]
    NoMapping { path: PathBuf, available: String },
    #[error("recording {path} has no \"{column}\" for --map {quantity}; it has: {available}", path = .path.display())]
    NoField { path: PathBuf, quantity: String, column: String, available: String },
    #[error("recording {path}: --map {quantity} is missing; a force and a position on each axis are needed", path = .path.display())]
    NoQuantity { path: PathBuf, quantity: String },
    #[error("recording {path}: topic {topic} has a message that cannot be read; record it again", path = .path.display())]
    Message { path: PathBuf, topic: String },
    #[error(
        "recording {path}: each message of topic {topic} is compressed separately; convert it with `ros2 bag convert` without a compression_mode",
        path = .path.display()
    )]
    Compressed { path: PathBuf, topic: String },
    #[error(
        "recording {path}: the time of topic {topic} steps back by {back_s:.3} s, {after_s:.3} s after its first message, as happens when the computer's clock is set; split the recording there and use the parts separately",
        path = .path.display()
    )]
    ClockSet { path: PathBuf, topic: String, after_s: f64, back_s: f64 },
    #[error(
        "recording {path}: only {found} samples have a force and a position within {GAP_S} s; record the topics at the same time and with one clock",
        path = .path.display()
    )]
    TooShort { path: PathBuf, found: usize },
}

/// Values over time, of one quantity; not a number where the publisher does not know it.
struct Series {
    times_ns: Vec<u64>,
    values: Vec<f64>,
}

/// Returns whether a recording has messages of ROS 2 that can be read.
pub fn is_bag(reader: &SessionReader) -> bool {
    let is_readable = |schema: &str| !examples(schema).is_empty();
    reader.channels().iter().any(|one| one.encoding.message_encoding == CDR && is_readable(&one.encoding.schema))
}

/// Reads motion and force with this mapping of quantities to `TOPIC.FIELD`. The path may be the folder of a bag.
///
/// # Errors
/// [`BagError`] if the recording cannot be read, or lacks what is mapped.
pub fn read(path: &Path, mapping: &ColumnMapping) -> Result<CsvRecording, BagError> {
    let file = file_of(path)?;
    let reader = SessionReader::open(&file)?;
    if mapping.sources().next().is_none() {
        return Err(BagError::NoMapping { path: path.to_owned(), available: available(&reader) });
    }
    let axes: Vec<usize> = (0..AXIS_NAMES.len()).filter(|axis| is_named(mapping, AXIS_NAMES[*axis])).collect();
    let mut series = Vec::new();
    for axis in &axes {
        let name = AXIS_NAMES[*axis];
        let position = read_series(&reader, path, mapping, &format!("{name}_m"))?;
        let force = read_series(&reader, path, mapping, &format!("f{name}_n"))?;
        series.push((position, force));
    }
    let samples = joined(&series);
    if samples.len() < MIN_SAMPLES {
        return Err(BagError::TooShort { path: path.to_owned(), found: samples.len() });
    }
    Ok(CsvRecording::of_samples(path, axes, samples)?)
}

/// Reads as much of force and position as is mapped, for a look at it: the rest is unknown (NaN). Each message of any mapped
/// topic gives a row.
///
/// # Errors
/// [`BagError`] if the recording cannot be read, nothing is mapped, or it lacks what is mapped.
pub fn read_signals(path: &Path, mapping: &ColumnMapping) -> Result<Signals, BagError> {
    let file = file_of(path)?;
    let reader = SessionReader::open(&file)?;
    let series = |name: String| mapping.names(&name).then(|| read_series(&reader, path, mapping, &name)).transpose();
    let mut forces = [const { None }; AXES];
    let mut positions = [const { None }; AXES];
    for ((axis, force), position) in AXIS_NAMES.iter().zip(&mut forces).zip(&mut positions) {
        *force = series(format!("f{axis}_n"))?;
        *position = series(format!("{axis}_m"))?;
    }
    let mut times_ns: Vec<u64> =
        forces.iter().chain(&positions).flatten().flat_map(|series| &series.times_ns).copied().collect();
    times_ns.sort_unstable();
    times_ns.dedup();
    let Some(&first_ns) = times_ns.first() else {
        return Err(BagError::NoMapping { path: path.to_owned(), available: available(&reader) });
    };
    let at = |series: &[Option<Series>; AXES], time_ns: u64| {
        let value = |one: &Option<Series>| one.as_ref().and_then(|one| one.at(time_ns)).unwrap_or(f64::NAN);
        Vector3::from_fn(|axis, _| value(&series[axis]))
    };
    let row = |time_ns: u64| Sample {
        t_s: (time_ns - first_ns) as f64 * 1e-9,
        position_m: at(&positions, time_ns),
        force_n: at(&forces, time_ns),
    };
    Ok(Signals { notes: reader.notes().to_vec(), ..Signals::new(times_ns.into_iter().map(row).collect()) })
}

/// Returns the faults of a recording, one line each; empty for a sound one. A recording that was cut is read up to its cut.
/// The path may be the folder of a bag.
///
/// # Errors
/// [`BagError`] if the recording cannot be read.
pub fn missing(path: &Path) -> Result<Vec<String>, BagError> {
    Ok(SessionReader::open(&file_of(path)?)?.notes().to_vec())
}

fn is_named(mapping: &ColumnMapping, axis: &str) -> bool {
    mapping.names(&format!("{axis}_m")) || mapping.names(&format!("f{axis}_n"))
}

/// Returns the file of a recording, which `ros2 bag` puts into a folder.
fn file_of(path: &Path) -> Result<PathBuf, BagError> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let refused = |why: &str| BagError::Folder { path: path.to_owned(), why: why.to_owned() };
    let entries = std::fs::read_dir(path).map_err(|error| refused(&error.to_string()))?;
    let files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    let with = |ending: &str| files.iter().filter(|file| file.extension().is_some_and(|known| known == ending)).count();
    match files.iter().find(|file| file.extension().is_some_and(|known| known == "mcap")) {
        Some(file) if with("mcap") == 1 => Ok(file.clone()),
        Some(_) => Err(refused("it has several .mcap files: name one of them")),
        None if with("db3") > 0 => {
            Err(refused("it is stored as SQLite (.db3): convert it with `ros2 bag convert` to the storage mcap"))
        }
        None if with("zstd") > 0 => Err(refused("its file is compressed as a whole (.zstd): unpack it with `zstd -d`")),
        None => Err(refused("the folder has no .mcap file")),
    }
}

/// Returns the topics that can be read, with their fields.
fn available(reader: &SessionReader) -> String {
    let mut topics = Vec::new();
    for channel in reader.channels().iter().filter(|channel| channel.encoding.message_encoding == CDR) {
        topics.extend(examples(&channel.encoding.schema).into_iter().map(|field| format!("{}.{field}", channel.topic)));
    }
    if topics.is_empty() {
        return "no topic with a pose, a wrench, a transform or joint states in the encoding of ROS 2 (cdr)".to_owned();
    }
    shortened(&topics.join(", "), PASSAGE)
}

fn read_series(
    reader: &SessionReader,
    path: &Path,
    mapping: &ColumnMapping,
    quantity: &str,
) -> Result<Series, BagError> {
    if !mapping.names(quantity) {
        return Err(BagError::NoQuantity { path: path.to_owned(), quantity: quantity.to_owned() });
    }
    let source = mapping.source(quantity);
    let missing = || BagError::NoField {
        path: path.to_owned(),
        quantity: quantity.to_owned(),
        column: quoted(source.column()),
        available: available(reader),
    };
    // A topic has no point in its name.
    let (topic, field) = source.column().split_once('.').ok_or_else(missing)?;
    let topic = if topic.starts_with('/') { topic.to_owned() } else { format!("/{topic}") };
    let channel = reader.channels().iter().find(|channel| {
        channel.encoding.message_encoding == CDR && channel.topic.trim_start_matches('/') == &topic[1..]
    });
    let channel = channel.ok_or_else(missing)?;
    let field = BagField::find(&channel.encoding.schema, field).ok_or_else(missing)?;
    let topic = || quoted(&channel.topic);
    let mut series = Series { times_ns: Vec::new(), values: Vec::new() };
    let mut has_messages = false;
    for message in reader.messages(&[&channel.topic], 0..u64::MAX) {
        let message = message?;
        has_messages = true;
        if message.data().starts_with(&ZSTD_MAGIC) {
            return Err(BagError::Compressed { path: path.to_owned(), topic: topic() });
        }
        let damaged = || BagError::Message { path: path.to_owned(), topic: topic() };
        let BagValue { stamp_ns, number } = field.read(message.data()).ok_or_else(damaged)?;
        let BagNumber::Given(value) = number else { continue };
        let time_ns = stamp_ns.unwrap_or_else(|| message.log_time_ns());
        if let (Some(&first_ns), Some(&last_ns)) = (series.times_ns.first(), series.times_ns.last()) {
            let seconds = |from_ns: u64, to_ns: u64| to_ns.saturating_sub(from_ns) as f64 * 1e-9;
            if seconds(time_ns, last_ns) > LATE_S {
                let [after_s, back_s] = [seconds(first_ns, last_ns), seconds(time_ns, last_ns)];
                return Err(BagError::ClockSet { path: path.to_owned(), topic: topic(), after_s, back_s });
            }
        }
        series.add(time_ns, value * source.scale());
    }
    if has_messages && series.times_ns.is_empty() {
        return Err(missing());
    }
    Ok(series)
}

impl Series {
    /// Adds a value in the order of time, unless it is the same message again.
    fn add(&mut self, time_ns: u64, value: f64) {
        let earlier = self.times_ns.iter().rev().take_while(|known| **known >= time_ns).count();
        let at = self.times_ns.len() - earlier;
        if self.times_ns.get(at) != Some(&time_ns) {
            self.times_ns.insert(at, time_ns);
            self.values.insert(at, value);
        }
    }

    /// Returns the value at a time, between two messages that are close enough; `None` if it is unknown.
    fn at(&self, time_ns: u64) -> Option<f64> {
        self.between(time_ns).filter(|value| value.is_finite())
    }

    fn between(&self, time_ns: u64) -> Option<f64> {
        let next = self.times_ns.partition_point(|known| *known < time_ns);
        let (&after_ns, &after) = (self.times_ns.get(next)?, self.values.get(next)?);
        if after_ns == time_ns {
            return Some(after);
        }
        let before = next.checked_sub(1)?;
        let (&before_ns, &from) = (self.times_ns.get(before)?, self.values.get(before)?);
        let step_s = (after_ns - before_ns) as f64 * 1e-9;
        let share = (time_ns - before_ns) as f64 * 1e-9 / step_s;
        (step_s <= GAP_S).then_some(from + share * (after - from))
    }
}

/// Returns a sample for each message of the first axis' force at which all other quantities are known. Times count from
/// the first one, s.
fn joined(series: &[(Series, Series)]) -> Vec<Sample> {
    let Some((_, base)) = series.first() else { return Vec::new() };
    let mut samples: Vec<Sample> = Vec::new();
    let mut first_ns = None;
    for &time_ns in &base.times_ns {
        let mut position_m = Vector3::zeros();
        let mut force_n = Vector3::zeros();
        let is_known = series.iter().enumerate().all(|(lane, (position, force))| {
            let (Some(position), Some(force)) = (position.at(time_ns), force.at(time_ns)) else { return false };
            position_m[lane] = position;
            force_n[lane] = force;
            true
        });
        if is_known {
            let first_ns = *first_ns.get_or_insert(time_ns);
            samples.push(Sample { t_s: (time_ns - first_ns) as f64 * 1e-9, position_m, force_n });
        }
    }
    samples
}
