//! Contents of a session, from its summary or, without a summary, from its records one after the other.

use std::{collections::BTreeMap, io};

use super::{
    chunk,
    parse::{self, Attachment, ParseSchema, RawChannel},
    source::{ReaderSource, RecordPlace, Walk},
};
use crate::session::format::{END, HEAD, MAGIC, Statistics, kind};

/// Position of messages: a chunk, or a run of messages outside chunks, as other programs write them.
#[derive(Clone, Debug)]
pub(super) struct ContentsMessages {
    pub(super) is_chunk: bool,
    pub(super) at: u64,
    pub(super) length: u64,
    pub(super) times_ns: (u64, u64),
    /// Channels of the messages; empty if unknown.
    pub(super) channels: Vec<u16>,
}

#[derive(Default)]
pub(super) struct ReaderContents {
    pub(super) schemas: BTreeMap<u16, ParseSchema>,
    pub(super) channels: BTreeMap<u16, RawChannel>,
    pub(super) messages: Vec<ContentsMessages>,
    pub(super) attachments: Vec<Attachment>,
    /// Positions and lengths of the records of metadata.
    pub(super) metadata: Vec<(u64, u64)>,
    pub(super) statistics: Statistics,
    /// Faults of the file, one line each.
    pub(super) notes: Vec<String>,
}

/// Maximum number of notes about one file.
const NOTES: usize = 20;
/// Runs of messages outside chunks are read in parts of this size.
const ROW: u64 = 4 << 20;

impl ReaderContents {
    /// Reads the summary, or returns why this is impossible.
    pub(super) fn of_summary(source: &ReaderSource) -> io::Result<Result<Self, &'static str>> {
        let Some(end) = source.size().checked_sub(END as u64) else { return Ok(Err("it is truncated")) };
        let last = source.read(end, END as u64)?;
        if last[END - MAGIC.len()..] != MAGIC {
            return Ok(Err("it is truncated"));
        }
        let footer = parse::first_record(&last).filter(|&(kind, ..)| kind == kind::FOOTER);
        let Some(footer) = footer.and_then(|(_, content, _)| parse::footer(content)) else {
            return Ok(Err("its last record is damaged"));
        };
        // In the MCAP specification 0 means that there is none; the same holds for the checksum.
        if footer.summary_start == 0 {
            return Ok(Err("it has no summary"));
        }
        if footer.crc != 0 && !checksum_agrees(source, footer.summary_start, end, footer.crc)? {
            return Ok(Err("its summary is damaged"));
        }
        let mut contents = Self::default();
        let mut walk = Walk::new(source, footer.summary_start, end);
        let mut report = None;
        while let Some(place) = walk.step()? {
            match place.kind {
                kind::FOOTER => break,
                // Bytes that were never written are zero: the power failed.
                0 => return Ok(Err("its summary is damaged")),
                _ => {}
            }
            if place.kind == kind::STATISTICS {
                report = parse::statistics(walk.content(place, u64::MAX)?);
                continue;
            }
            if contents.take_summary_record(&mut walk, place)?.is_none() {
                return Ok(Err("its summary is damaged"));
            }
        }
        if contents.has_overlaps() {
            return Ok(Err("its summary is damaged"));
        }
        let none = contents.messages.is_empty();
        match report {
            // Messages outside chunks are not indexed.
            Some(report) if report.messages == 0 || !none => contents.statistics = report,
            None if !none => {}
            _ => return Ok(Err("its summary has no index")),
        }
        Ok(Ok(contents))
    }

    fn take_summary_record(&mut self, walk: &mut Walk, place: RecordPlace) -> io::Result<Option<()>> {
        let content = match place.kind {
            kind::SCHEMA | kind::CHANNEL | kind::CHUNK_INDEX | kind::ATTACHMENT_INDEX | kind::METADATA_INDEX => {
                walk.content(place, u64::MAX)?
            }
            _ => return Ok(Some(())),
        };
        Ok(match place.kind {
            kind::SCHEMA | kind::CHANNEL => self.take_definition(place.kind, content),
            kind::CHUNK_INDEX => parse::chunk_index(content).map(|index| {
                let at = index.at;
                let length = index.length;
                let times_ns = index.times_ns;
                self.messages.push(ContentsMessages { is_chunk: true, at, length, times_ns, channels: index.channels });
            }),
            kind::ATTACHMENT_INDEX => parse::attachment_index(content).map(|index| self.attachments.push(index)),
            _ => parse::metadata_index(content).map(|index| self.metadata.push(index)),
        })
    }

    /// Returns whether chunks overlap. Chunks whose times overlap are open at once: a chunk that is listed a thousand
    /// times would need a thousand times its memory.
    fn has_overlaps(&mut self) -> bool {
        self.messages.sort_by_key(|one| one.at);
        self.messages.windows(2).any(|pair| pair[0].at.saturating_add(pair[0].length) > pair[1].at)
    }

    fn take_definition(&mut self, kind: u8, content: &[u8]) -> Option<()> {
        if kind == kind::SCHEMA {
            let schema = parse::schema(content)?;
            self.schemas.entry(schema.id).or_insert(schema);
        } else {
            let channel = parse::channel(content)?;
            self.channels.entry(channel.id).or_insert(channel);
        }
        Some(())
    }

    /// Scans the records, beginning at `begin`.
    pub(super) fn of_records(source: &ReaderSource, begin: u64) -> io::Result<Self> {
        let mut contents = Self::default();
        let mut walk = Walk::new(source, begin, source.size());
        loop {
            let at = walk.at;
            let Some(place) = walk.step()? else {
                if at < source.size() {
                    contents.note(|| format!("it ends within the record at byte {at}; everything before it is read"));
                }
                break;
            };
            match place.kind {
                kind::DATA_END | kind::FOOTER => break,
                0 | kind::HEADER => {
                    contents.note(|| format!("no record at byte {at}; everything before it is read"));
                    break;
                }
                kind::CHUNK => contents.scan_chunk(source, place)?,
                kind::SCHEMA | kind::CHANNEL => {
                    let taken = contents.take_definition(place.kind, walk.content(place, u64::MAX)?);
                    taken.unwrap_or_else(|| contents.note(|| format!("the definition at byte {at} is damaged")));
                }
                kind::MESSAGE => contents.scan_message(walk.content(place, parse::MESSAGE_HEAD as u64)?, place),
                kind::ATTACHMENT => {
                    let head = walk.content(place, 1 << 16)?;
                    contents.attachments.extend(parse::attachment_head(head, (place.at, place.length)));
                }
                kind::METADATA => contents.metadata.push((place.at, place.length)),
                _ => {}
            }
        }
        contents.count();
        Ok(contents)
    }

    fn scan_chunk(&mut self, source: &ReaderSource, place: RecordPlace) -> io::Result<()> {
        let chunk = match chunk::read(source, place.at, place.length)? {
            Ok(chunk) => chunk,
            Err(why) => {
                self.note(|| format!("the chunk at byte {} is skipped: {why}", place.at));
                return Ok(());
            }
        };
        let mut channels = BTreeMap::new();
        for (kind, content, _) in chunk::records(&chunk.records) {
            match (kind, parse::message(content)) {
                (kind::MESSAGE, Some(message)) => *channels.entry(message.channel).or_insert(0) += 1,
                (kind::SCHEMA | kind::CHANNEL, _) => drop(self.take_definition(kind, content)),
                _ => {}
            }
        }
        let at = place.at;
        let length = place.length;
        let times_ns = chunk.times_ns;
        for (&channel, count) in &channels {
            *self.statistics.by_channel.entry(channel).or_default() += count;
        }
        let channels = channels.into_keys().collect();
        self.messages.push(ContentsMessages { is_chunk: true, at, length, times_ns, channels });
        Ok(())
    }

    fn scan_message(&mut self, head: &[u8], place: RecordPlace) {
        let Some(message) = parse::message(head) else { return };
        *self.statistics.by_channel.entry(message.channel).or_default() += 1;
        let time = message.log_time_ns;
        let end = place.at + place.length;
        match self.messages.last_mut() {
            Some(row) if !row.is_chunk && row.at + row.length == place.at && end - row.at <= ROW => {
                row.length += place.length;
                row.times_ns = (row.times_ns.0.min(time), row.times_ns.1.max(time));
            }
            _ => {
                let at = place.at;
                let length = place.length;
                let times_ns = (time, time);
                self.messages.push(ContentsMessages { is_chunk: false, at, length, times_ns, channels: Vec::new() });
            }
        }
    }

    /// Computes the statistics of the scanned records.
    fn count(&mut self) {
        let times = self.messages.iter().map(|one| one.times_ns);
        let times_ns = times.reduce(|all, one| (all.0.min(one.0), all.1.max(one.1))).unwrap_or_default();
        let by_channel = std::mem::take(&mut self.statistics.by_channel);
        self.statistics = Statistics {
            messages: by_channel.values().sum(),
            schemas: self.schemas.len() as u16,
            channels: self.channels.len() as u32,
            attachments: self.attachments.len() as u32,
            metadata: self.metadata.len() as u32,
            chunks: self.messages.iter().filter(|one| one.is_chunk).count() as u32,
            times_ns,
            by_channel,
        };
    }

    fn note(&mut self, line: impl FnOnce() -> String) {
        if self.notes.len() < NOTES {
            self.notes.push(line());
        }
    }
}

/// Covers the summary and the footer up to the checksum.
fn checksum_agrees(source: &ReaderSource, begin: u64, end: u64, crc: u32) -> io::Result<bool> {
    let length = (end + HEAD as u64 + 16).checked_sub(begin);
    Ok(match length {
        Some(length) => crc32fast::hash(&source.read(begin, length)?) == crc,
        None => false,
    })
}
