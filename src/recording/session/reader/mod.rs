//! Reads a session, written by this or another program.
//!
//! Does not use the indexed reader of the crate `mcap` (0.26), which checks no checksum of a chunk and trusts the
//! length that it claims: of 17 112 bits of a chunk, flipped one by one, 15 704 went unnoticed, 1355 made it panic, and
//! 53 ended the reading.

mod chunk;
mod contents;
mod messages;
mod parse;
mod source;

use std::{
    collections::BTreeMap,
    io,
    ops::Range,
    path::{Path, PathBuf},
};

use contents::ReaderContents;
pub(super) use source::{ReaderSource, Walk};

pub use messages::{ReaderMessages, SessionMessage};
pub use parse::Attachment;

use super::{
    error::ReadError,
    format::{MAGIC, Statistics, kind},
    writer::{ChannelId, Encoding},
};

/// An open session. Reads on demand; keeps the index and, while messages are read, their chunks.
///
/// Never uses more memory than a file of its size can justify, whatever its bytes claim.
///
/// ```
/// use nima_recording::session::{Encoding, SessionReader, SessionWriter};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("session.mcap");
/// let mut writer = SessionWriter::create(&path, "an example")?;
/// let text = Encoding { message_encoding: "text".into(), ..Encoding::default() };
/// let words = writer.channel("words", text)?;
/// for (time_ns, word) in [(1, "one"), (2, "two"), (3, "three")] {
///     writer.message(words, time_ns, word.as_bytes())?;
/// }
/// writer.flush()?;
///
/// let reader = SessionReader::open(&path)?;
/// let read: Result<Vec<_>, _> = reader.messages(&["words"], 2..4).collect();
/// let read: Vec<_> = read?.iter().map(|message| message.data().to_vec()).collect();
/// assert_eq!(read, [b"two".to_vec(), b"three".to_vec()]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SessionReader {
    path: PathBuf,
    source: ReaderSource,
    library: String,
    contents: ReaderContents,
    channels: Vec<ReaderChannel>,
}

/// A metadata record: its name and its values.
pub type Metadata = (String, BTreeMap<String, String>);

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReaderChannel {
    pub id: ChannelId,
    pub topic: String,
    /// Encoding of its messages.
    pub encoding: Encoding,
    /// `None` if the file does not state it.
    pub messages: Option<u64>,
}

impl SessionReader {
    /// Opens a file and reads its summary. If the summary is missing or damaged, scans all records, which takes as long
    /// as reading the file; [`SessionReader::notes`] then says so.
    ///
    /// # Errors
    /// The file does not exist, is empty, has another format or an unknown version, or is damaged before the first
    /// record.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let (file, size) = nima_files::open_file(path).map_err(|error| ReadError::open(path, &error))?;
        Self::of_source(path, ReaderSource::File(file, size))
    }

    /// Opens bytes in memory; `name` replaces the path in messages.
    ///
    /// # Errors
    /// As [`SessionReader::open`].
    pub fn of_bytes(name: &str, bytes: Vec<u8>) -> Result<Self, ReadError> {
        Self::of_source(Path::new(name), ReaderSource::Bytes(bytes))
    }

    fn of_source(path: &Path, source: ReaderSource) -> Result<Self, ReadError> {
        let failed = |error: io::Error| ReadError::open(path, &error);
        if source.size() == 0 {
            return Err(ReadError::Empty { path: path.to_owned() });
        }
        let magic = source.read(0, source.size().min(MAGIC.len() as u64)).map_err(failed)?;
        check_magic(path, &magic)?;
        let damaged = |what: &str| ReadError::damaged(path, MAGIC.len() as u64, what);
        let mut walk = Walk::new(&source, MAGIC.len() as u64, source.size());
        let header = walk.step().map_err(failed)?.filter(|place| place.kind == kind::HEADER);
        let header = header.ok_or_else(|| damaged("there is no header"))?;
        let library = {
            let mut fields = parse::ParseFields(walk.content(header, u64::MAX).map_err(failed)?);
            fields.text().and_then(|_| fields.text()).ok_or_else(|| damaged("the header is damaged"))?
        };
        let contents = match ReaderContents::of_summary(&source).map_err(failed)? {
            Ok(contents) => contents,
            Err(why) => {
                let mut contents = ReaderContents::of_records(&source, walk.at).map_err(failed)?;
                contents.notes.insert(0, format!("{why}: scanned all records instead"));
                contents
            }
        };
        let channels = contents.channels.values().map(|channel| of_channel(channel, &contents)).collect();
        Ok(Self { path: path.to_owned(), source, library, contents, channels })
    }

    pub fn library(&self) -> &str {
        &self.library
    }

    /// Returns the faults of the file, one line each; empty for a sound file.
    pub fn notes(&self) -> &[String] {
        &self.contents.notes
    }

    /// Returns the channels, sorted by number.
    pub fn channels(&self) -> &[ReaderChannel] {
        &self.channels
    }

    /// Returns the contents in numbers, from the file's summary or from a scan.
    pub fn statistics(&self) -> &Statistics {
        &self.contents.statistics
    }

    /// Returns the times of the first and the last message, ns.
    pub fn times_ns(&self) -> Option<(u64, u64)> {
        let times = self.contents.messages.iter().map(|one| one.times_ns);
        times.reduce(|all, one| (all.0.min(one.0), all.1.max(one.1)))
    }

    /// Returns the messages of these topics (of all topics if the list is empty) with times in this range, in the order
    /// of their times. Reads only the chunks that may contain some.
    pub fn messages(&self, topics: &[&str], times_ns: Range<u64>) -> ReaderMessages<'_> {
        let wanted = (!topics.is_empty()).then(|| {
            let channels = self.channels.iter().filter(|channel| topics.contains(&channel.topic.as_str()));
            channels.map(|channel| channel.id.0).collect()
        });
        ReaderMessages::new(self, wanted, times_ns)
    }

    /// Returns all attachments without their data.
    pub fn attachments(&self) -> &[Attachment] {
        &self.contents.attachments
    }

    /// Returns the data of an attachment.
    ///
    /// # Errors
    /// I/O errors, bytes that are not such a record, or a wrong checksum.
    pub fn attachment(&self, attachment: &Attachment) -> Result<Vec<u8>, ReadError> {
        let (at, length) = attachment.place;
        let damaged =
            || ReadError::damaged(&self.path, at, &format!("attachment {}", nima_files::quoted(&attachment.name)));
        let bytes = self.source.read(at, length).map_err(|_| damaged())?;
        let record = parse::first_record(&bytes).filter(|&(kind, ..)| kind == kind::ATTACHMENT);
        match record.and_then(|(_, content, _)| parse::attachment_data(content)) {
            Some((data, true)) => Ok(data.to_vec()),
            _ => Err(damaged()),
        }
    }

    /// # Errors
    /// I/O errors, or bytes that are not such a record.
    pub fn metadata(&self) -> Result<Vec<Metadata>, ReadError> {
        let read = |&(at, length): &(u64, u64)| {
            let damaged = || ReadError::damaged(&self.path, at, "metadata");
            let bytes = self.source.read(at, length).map_err(|_| damaged())?;
            let record = parse::first_record(&bytes).filter(|&(kind, ..)| kind == kind::METADATA);
            record.and_then(|(_, content, _)| parse::metadata(content)).ok_or_else(damaged)
        };
        self.contents.metadata.iter().map(read).collect()
    }

    #[cfg(test)]
    pub(super) fn chunk_places(&self) -> impl Iterator<Item = (u64, u64)> {
        self.contents.messages.iter().map(|one| (one.at, one.length))
    }

    /// Reads the records of one chunk, or of a run of messages outside chunks.
    fn records(&self, place: &contents::ContentsMessages) -> Result<Vec<u8>, ReadError> {
        let failed = |error: io::Error| ReadError::open(&self.path, &error);
        if !place.is_chunk {
            return self.source.read(place.at, place.length).map_err(failed);
        }
        let chunk = chunk::read(&self.source, place.at, place.length).map_err(failed)?.and_then(|chunk| {
            let agree = chunk.times_ns == place.times_ns;
            if agree { Ok(chunk) } else { Err("its times differ from those in its index".to_owned()) }
        });
        let seconds = |ns: u64| ns as f64 * 1e-9;
        let what = |why: String| {
            let (first, last) = place.times_ns;
            format!("the chunk from {:.3} s to {:.3} s: {why}", seconds(first), seconds(last))
        };
        chunk.map(|chunk| chunk.records).map_err(|why| ReadError::damaged(&self.path, place.at, &what(why)))
    }
}

fn check_magic(path: &Path, magic: &[u8]) -> Result<(), ReadError> {
    let path = path.to_owned();
    match (MAGIC.starts_with(magic), magic) {
        (true, magic) if magic.len() == MAGIC.len() => Ok(()),
        (true, _) => Err(ReadError::Cut { path }),
        (false, &[a, b, c, d, e, version, ..]) if [a, b, c, d, e] == MAGIC[..5] && version != MAGIC[5] => {
            Err(ReadError::Version { path, version: char::from(version).escape_default().to_string() })
        }
        _ => Err(ReadError::Foreign { path }),
    }
}

fn of_channel(channel: &parse::RawChannel, contents: &ReaderContents) -> ReaderChannel {
    let schema = contents.schemas.get(&channel.schema);
    let text = |of: fn(&parse::ParseSchema) -> &String| schema.map(of).cloned().unwrap_or_default();
    let encoding = Encoding {
        schema: text(|schema| &schema.name),
        schema_encoding: text(|schema| &schema.encoding),
        schema_data: schema.map(|schema| schema.data.clone()).unwrap_or_default(),
        message_encoding: channel.encoding.clone(),
    };
    let report = &contents.statistics.by_channel;
    let messages = (!report.is_empty()).then(|| report.get(&channel.id).copied().unwrap_or_default());
    ReaderChannel { id: ChannelId(channel.id), topic: channel.topic.clone(), encoding, messages }
}
