//! Writing a session: messages into chunks, chunks into a file that is valid at every moment.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};

use super::{
    at,
    chunk::{ClosedChunk, RecordingChunk},
    error::WriteError,
    format::{self, RecordPut as _, Statistics, kind, record},
    layout::{GROWTH, RecordingLayout},
    summary::RecordingSummary,
};

/// A chunk is closed before it spans more than this, ns; a killed process loses at most this much.
pub const CHUNK_NS: u64 = 500_000_000;
/// A chunk is also closed when its records have this many bytes before compression.
pub const CHUNK_BYTES: usize = 8 << 20;
/// Kinds of messages that have their own, uncompressed chunks: they are compressed already, and a reader of numbers can
/// skip them.
const IMAGES: [&str; 2] = ["foxglove.CompressedImage", "foxglove.CompressedVideo"];
/// Maximum bytes of a message, an attachment or the records of a kind of metadata: lengths have 32 bit.
const RECORD_MAX: u64 = 1 << 31;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ChannelId(pub(super) u16);

/// Encoding of a channel's messages; see [`crate::messages`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Encoding {
    /// Name of the message type, such as `sensor_msgs/msg/JointState`; empty, with the next two fields, for none.
    pub schema: String,
    /// Language of the description, such as `ros2msg`.
    pub schema_encoding: String,
    /// The description of the message type.
    pub schema_data: Vec<u8>,
    /// Encoding of a message, such as `cdr`.
    pub message_encoding: String,
}

/// Writes a session file (MCAP, chunks compressed with LZ4; images unchanged in their own chunks). Owned by one thread,
/// which waits for the disk.
///
/// The file is valid at every moment: whatever stops the process, `kill -9` or a full disk, every MCAP reader opens the
/// file without repair. At most the data that were not in a closed chunk are missing, so a thread that receives nothing
/// for a while should call [`SessionWriter::flush`]. To survive a loss of power, call `fdatasync` regularly
/// ([`SessionWriter::sync_handle`]).
///
/// If writing a message fails, the message is not in the file, and the next call tries again.
///
/// ```
/// use nima_recording::session::{Encoding, SessionWriter};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("session.mcap");
/// let mut writer = SessionWriter::create(&path, "an example")?;
/// let json = Encoding {
///     schema: "Force".into(),
///     schema_encoding: "jsonschema".into(),
///     schema_data: br#"{"type": "object", "properties": {"force_n": {"type": "number"}}}"#.to_vec(),
///     message_encoding: "json".into(),
/// };
/// let forces = writer.channel("forces", json)?;
/// writer.message(forces, 1_000_000, br#"{"force_n": 1.5}"#)?;
/// assert_eq!(writer.finish()?.messages, 1);
/// assert!(SessionWriter::create(&path, "an example").is_err(), "a session is never overwritten");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SessionWriter {
    path: PathBuf,
    layout: RecordingLayout,
    /// Kept while the file is written; see [`at::guard`].
    _guard: Option<File>,
    summary: RecordingSummary,
    /// The file's summary lacks more than can be appended.
    summary_changed: bool,
    numbers: WriterLane,
    images: WriterLane,
    /// By number.
    channels: Vec<ChannelState>,
    schemas: Vec<Encoding>,
}

struct ChannelState {
    topic: String,
    encoding: Encoding,
    sequence: u32,
}

struct WriterLane {
    chunk: RecordingChunk,
    /// A closed chunk that could not be written yet.
    waiting: Option<ClosedChunk>,
}

impl WriterLane {
    const fn new(chunk: RecordingChunk) -> Self {
        Self { chunk, waiting: None }
    }

    /// Returns whether the chunk must be written before it accepts a message of this length and time.
    fn is_due(&self, length: usize, time_ns: u64) -> bool {
        let full = self.chunk.len() + length > CHUNK_BYTES && self.chunk.len() > 0;
        self.waiting.is_some() || full || self.chunk.span_ns(time_ns) >= CHUNK_NS
    }

    fn close(&mut self) -> io::Result<()> {
        if self.waiting.is_none() && self.chunk.len() > 0 {
            self.waiting = Some(self.chunk.close()?);
        }
        Ok(())
    }
}

impl SessionWriter {
    /// Creates a file; `library` names the program and its version.
    ///
    /// # Errors
    /// The file exists, its folder does not, or the system reports no permission or no space.
    pub fn create(path: &Path, library: &str) -> Result<Self, WriteError> {
        Self::create_growing_by(path, library, GROWTH)
    }

    pub(super) fn create_growing_by(path: &Path, library: &str, growth: u64) -> Result<Self, WriteError> {
        let summary = RecordingSummary::default();
        let layout = create(path, library, growth, &summary).map_err(|error| WriteError::create(path, &error))?;
        Ok(Self {
            path: path.to_owned(),
            layout,
            _guard: at::guard(path),
            summary,
            summary_changed: false,
            numbers: WriterLane::new(RecordingChunk::compressed()),
            images: WriterLane::new(RecordingChunk::plain()),
            channels: Vec::new(),
            schemas: Vec::new(),
        })
    }

    /// Returns a new channel, or the existing one with this topic and encoding.
    ///
    /// # Errors
    /// More than 65 535 channels, or an I/O error while the file grows.
    pub fn channel(&mut self, topic: &str, encoding: Encoding) -> Result<ChannelId, WriteError> {
        if let Some(id) = self.channels.iter().position(|one| one.topic == topic && one.encoding == encoding) {
            return Ok(ChannelId(id as u16));
        }
        self.check("more channels", self.channels.len() as u64 + 1, u64::from(u16::MAX))?;
        self.check("a larger schema", encoding.schema_data.len() as u64, RECORD_MAX)?;
        let id = self.channels.len() as u16;
        let known = self.schemas.iter().position(|known| same_schema(known, &encoding));
        let mut schema = Vec::new();
        let mut channel = Vec::new();
        let number = match known {
            _ if encoding.schema_encoding.is_empty() => 0,
            Some(known) => known as u16 + 1,
            None => {
                let number = self.schemas.len() as u16 + 1;
                format::schema(&mut schema, number, &encoding.schema, &encoding.schema_encoding, &encoding.schema_data);
                number
            }
        };
        format::channel(&mut channel, id, number, topic, &encoding.message_encoding);
        self.reserve(0, (schema.len() + channel.len()) as u64)?;
        if !schema.is_empty() {
            self.schemas.push(encoding.clone());
            self.summary.statistics.schemas += 1;
        }
        // Store it in the chunk as well, for readers that start at the beginning.
        let lane = if is_image(&encoding) { &mut self.images } else { &mut self.numbers };
        for (record, in_summary) in [(schema, &mut self.summary.schemas), (channel, &mut self.summary.channels)] {
            lane.chunk.put_record(&record);
            in_summary.extend_from_slice(&record);
        }
        self.summary.statistics.channels += 1;
        self.summary_changed = true;
        self.channels.push(ChannelState { topic: topic.to_owned(), encoding, sequence: 0 });
        Ok(ChannelId(id))
    }

    /// Adds a message; `log_time_ns` is the time of its sample. Times should rise, and a chunk is closed before it
    /// spans more than [`CHUNK_NS`].
    ///
    /// # Errors
    /// A channel of another file, or an I/O error while a chunk is written. The message is then not added.
    pub fn message(&mut self, channel: ChannelId, log_time_ns: u64, data: &[u8]) -> Result<(), WriteError> {
        self.check("a larger message", data.len() as u64, RECORD_MAX)?;
        if usize::from(channel.0) >= self.channels.len() {
            return Err(WriteError::Channel { path: self.path.clone(), number: channel.0 });
        }
        let image = is_image(&self.channels[usize::from(channel.0)].encoding);
        let lane = if image { &self.images } else { &self.numbers };
        // Write both, so that a killed process loses the same period of each.
        if lane.is_due(data.len(), log_time_ns) {
            self.flush()?;
        }
        let lane = if image { &mut self.images } else { &mut self.numbers };
        let of_channel = &mut self.channels[usize::from(channel.0)];
        lane.chunk.put_message(channel.0, of_channel.sequence, log_time_ns, data);
        of_channel.sequence = of_channel.sequence.wrapping_add(1);
        Ok(())
    }

    /// Writes a whole file into the session.
    ///
    /// # Errors
    /// More than 2 GiB, or an I/O error.
    pub fn attachment(
        &mut self,
        name: &str,
        media_type: &str,
        log_time_ns: u64,
        data: &[u8],
    ) -> Result<(), WriteError> {
        self.check("a larger attachment", data.len() as u64, RECORD_MAX)?;
        let mut bytes = Vec::with_capacity(data.len() + 256);
        format::attachment(&mut bytes, name, media_type, log_time_ns, data);
        let length = bytes.len() as u64;
        let of_index = 128 + name.len() + media_type.len();
        let at = self.reserve(length, of_index as u64)?;
        self.layout.append(&bytes).map_err(|error| WriteError::write(&self.path, &error))?;
        record(&mut self.summary.attachments, kind::ATTACHMENT_INDEX, |out| {
            out.u64(at);
            out.u64(length);
            out.u64(log_time_ns);
            out.u64(log_time_ns);
            out.u64(data.len() as u64);
            out.text(name);
            out.text(media_type);
        });
        self.summary.statistics.attachments += 1;
        self.renew_summary()
    }

    /// # Errors
    /// I/O errors.
    pub fn metadata(&mut self, name: &str, entries: &BTreeMap<String, String>) -> Result<(), WriteError> {
        let size: usize = entries.iter().map(|(key, value)| 8 + key.len() + value.len()).sum();
        self.check("larger metadata", size as u64, RECORD_MAX)?;
        let mut bytes = Vec::new();
        format::metadata(&mut bytes, name, entries);
        let length = bytes.len() as u64;
        let at = self.reserve(length, 64 + name.len() as u64)?;
        self.layout.append(&bytes).map_err(|error| WriteError::write(&self.path, &error))?;
        record(&mut self.summary.metadata, kind::METADATA_INDEX, |out| {
            out.u64(at);
            out.u64(length);
            out.text(name);
        });
        self.summary.statistics.metadata += 1;
        self.renew_summary()
    }

    /// Closes the chunks now and writes them.
    ///
    /// # Errors
    /// I/O errors. The chunks are kept, and are written by the next call that succeeds.
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.write_chunk(|writer| &mut writer.numbers)?;
        self.write_chunk(|writer| &mut writer.images)?;
        if self.summary_changed { self.renew_summary() } else { Ok(()) }
    }

    fn write_chunk(&mut self, lane: fn(&mut Self) -> &mut WriterLane) -> Result<(), WriteError> {
        lane(self).close().map_err(|error| WriteError::write(&self.path, &error))?;
        let Some(chunk) = lane(self).waiting.take() else { return Ok(()) };
        let at = match self.place(&chunk) {
            Ok(at) => at,
            Err(error) => {
                lane(self).waiting = Some(chunk);
                return Err(error);
            }
        };
        self.count(&chunk);
        self.summary.index(&chunk.index(at));
        if self.summary_changed {
            return self.renew_summary();
        }
        // Set until the summary is in the file.
        self.summary_changed = true;
        self.layout.append_indexes(&mut self.summary).map_err(|error| WriteError::write(&self.path, &error))?;
        self.summary_changed = false;
        Ok(())
    }

    /// Returns the same file for a thread that calls `sync_data` every second.
    ///
    /// # Errors
    /// I/O errors.
    pub fn sync_handle(&self) -> io::Result<File> {
        self.layout.file().try_clone()
    }

    /// Returns the bytes passed to the system so far, and the bytes of data in the file; the difference is what keeps
    /// the file valid.
    pub fn bytes(&self) -> (u64, u64) {
        self.layout.written()
    }

    /// Closes the chunks, writes the last summary with its checksum, cuts off the free space and waits for the disk.
    ///
    /// # Errors
    /// I/O errors. The file is as readable as before.
    pub fn finish(mut self) -> Result<Statistics, WriteError> {
        self.flush()?;
        self.layout.finish(&mut self.summary).map_err(|error| WriteError::write(&self.path, &error))?;
        Ok(self.summary.statistics)
    }

    #[cfg(test)]
    pub(super) fn layout(&self) -> &RecordingLayout {
        &self.layout
    }

    /// Returns the bytes of chunk indexes in memory.
    #[cfg(test)]
    pub(super) fn held(&self) -> usize {
        self.summary.new_indexes().len()
    }

    fn place(&mut self, chunk: &ClosedChunk) -> Result<u64, WriteError> {
        let of_index = 128 + 10 * chunk.indexes.len();
        let at = self.reserve(chunk.bytes.len() as u64, of_index as u64)?;
        self.layout.append(&chunk.bytes).map_err(|error| WriteError::write(&self.path, &error))?;
        Ok(at)
    }

    fn reserve(&mut self, data: u64, in_summary: u64) -> Result<u64, WriteError> {
        if at::is_deleted(self.layout.file()).map_err(|error| WriteError::write(&self.path, &error))? {
            return Err(WriteError::Deleted { path: self.path.clone() });
        }
        self.layout.reserve(data, in_summary, &mut self.summary).map_err(|error| WriteError::write(&self.path, &error))
    }

    fn renew_summary(&mut self) -> Result<(), WriteError> {
        self.summary_changed = true;
        self.layout.renew(&mut self.summary).map_err(|error| WriteError::write(&self.path, &error))?;
        self.summary_changed = false;
        Ok(())
    }

    fn count(&mut self, chunk: &ClosedChunk) {
        let statistics = &mut self.summary.statistics;
        statistics.chunks += 1;
        statistics.messages += chunk.messages;
        if let Some((first, last)) = chunk.times_ns {
            let (begin, end) = statistics.times_ns;
            let none = statistics.messages == chunk.messages;
            statistics.times_ns = if none { (first, last) } else { (begin.min(first), end.max(last)) };
        }
        for &(channel, _, messages) in &chunk.indexes {
            *statistics.by_channel.entry(channel).or_default() += messages;
        }
    }

    fn check(&self, what: &'static str, value: u64, max: u64) -> Result<(), WriteError> {
        if value > max { Err(WriteError::TooMuch { path: self.path.clone(), what, max }) } else { Ok(()) }
    }
}

/// Returns whether a process is writing this session now. The writer holds a lock on the file (on Windows it prevents
/// the file's deletion), which the system releases however the process ends.
///
/// # Errors
/// I/O errors.
pub fn is_being_written(path: &Path) -> io::Result<bool> {
    at::is_locked(path)
}

fn is_image(encoding: &Encoding) -> bool {
    IMAGES.contains(&encoding.schema.as_str())
}

fn same_schema(one: &Encoding, other: &Encoding) -> bool {
    one.schema == other.schema && one.schema_encoding == other.schema_encoding && one.schema_data == other.schema_data
}

/// Lays out the empty file under another name, so that it appears complete.
fn create(path: &Path, library: &str, growth: u64, summary: &RecordingSummary) -> io::Result<RecordingLayout> {
    if path.symlink_metadata().is_ok() {
        return Err(io::Error::new(ErrorKind::AlreadyExists, "the file already exists"));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    #[cfg_attr(not(unix), expect(unused_mut, reason = "rights are set where there are any"))]
    let mut new = tempfile::Builder::new();
    #[cfg(unix)]
    new.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let new = new.tempfile_in(folder).map_err(|error| io::Error::new(error.kind(), plain(&error)))?;
    let layout = RecordingLayout::new(new.as_file().try_clone()?, library, growth, summary)?;
    at::lock(layout.file());
    new.persist_noclobber(path).map_err(|error| error.error)?;
    // Makes the new name survive a power failure as well, on systems that support it.
    #[cfg(unix)]
    File::open(folder).and_then(|folder| folder.sync_all()).ok();
    Ok(layout)
}

/// Removes the name of the temporary file, which the user never named.
fn plain(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" at path ").next().unwrap_or_default().to_owned()
}
