//! A file that is valid at every moment, even if the process is killed in the middle of a write.
//!
//! Writes are not atomic: a killed process leaves any number behind (measured: 39 of 60 writes of 800 kB were torn).
//! Bytes within one page arrive whole or not at all, and so does the file size that they set. Hence:
//!
//! ```text
//! data | free room | end of data, summary | free room | footer, magic
//!      p                                  q                         end of the file
//! ```
//!
//! Free space is a record of a private kind, which readers skip. New bytes are written inside it, where readers do not
//! look, followed by the head of the remaining free space. Then the nine bytes of the old head are replaced by the head
//! of the first new record, within one page. This is how chunks are added to the data (`p`) and chunk indexes to the
//! summary (`q`, together with the statistics). A summary that changes in any other way is rewritten into the free
//! space; then the footer is pointed at it, and then the head of the free space at `p`. The file grows by the same
//! step: a new footer far behind the end, whose summary is in the free space already. The gap between them is a hole,
//! which uses no disk space.

use std::{
    fs::File,
    io::{self, ErrorKind},
};

use super::{
    at,
    format::{self, DATA_END, END, HEAD, RecordPut as _, head, kind, record},
    reader::{ReaderSource, Walk},
    summary::RecordingSummary,
};

/// The size of a memory page, or a fraction of it, on every machine that this runs on.
const PAGE: u64 = 4096;
/// Free space is kept for a summary and for this many bytes more.
const SPARE: u64 = 64 << 10;
/// The file grows by at least this much; the hole uses no disk space.
pub(super) const GROWTH: u64 = 16 << 20;
/// The file also grows by at least this many summaries, because each growth writes two.
const GROWTH_IN_SUMMARIES: u64 = 32;

pub(super) struct RecordingLayout {
    file: File,
    growth: u64,
    /// End of the data and start of the free space.
    data_end: u64,
    /// End of the free space: the record that ends the data.
    room_end: u64,
    tail: Tail,
    /// Position of the footer, which ends the file.
    footer_at: u64,
    /// Bytes written so far.
    written: u64,
    /// The last switch failed, so it is unknown which version of the file a reader gets.
    failed: bool,
    #[cfg(test)]
    pub(super) log: Vec<(u64, Vec<u8>)>,
}

/// The file grows by at least this much; a hole uses no disk space.
#[derive(Clone, Copy, Default)]
struct Tail {
    /// The indexes of chunks, with free space between some of them. They are stored only here.
    indexes_at: u64,
    /// The statistics follow the indexes; they are the last record.
    statistics_at: u64,
}

/// Number of index bytes copied at a time.
const COPIED: usize = 64 << 10;

impl RecordingLayout {
    /// Lays out a new, empty file that other processes cannot see yet.
    pub(super) fn new(file: File, library: &str, growth: u64, summary: &RecordingSummary) -> io::Result<Self> {
        let mut begin = format::MAGIC.to_vec();
        format::header(&mut begin, "", library);
        let data_end = keep_whole(&mut begin, 0);
        let footer_at = pages(data_end + growth) - END as u64;
        let mut layout = Self {
            file,
            growth,
            data_end,
            room_end: 0,
            tail: Tail::default(),
            footer_at,
            written: 0,
            failed: false,
            #[cfg(test)]
            log: Vec::new(),
        };
        let at = footer_at - SPARE - summary.room();
        let tail = layout.write_tail(summary, at, footer_at)?;
        begin.extend_from_slice(&head(kind::ROOM, at - data_end - HEAD as u64));
        layout.write(&begin, 0)?;
        let mut end = Vec::new();
        format::end(&mut end, at + DATA_END as u64, 0, 0);
        layout.write(&end, footer_at)?;
        layout.room_end = at;
        layout.tail = tail;
        Ok(layout)
    }

    pub(super) fn file(&self) -> &File {
        &self.file
    }

    /// Returns the bytes written so far, and the bytes of data in the file.
    pub(super) fn written(&self) -> (u64, u64) {
        (self.written, self.data_end)
    }

    /// Makes room for this many bytes of data and of summary; returns the position of the data.
    pub(super) fn reserve(&mut self, data: u64, in_summary: u64, summary: &mut RecordingSummary) -> io::Result<u64> {
        // Reserve the summary twice: when it is rewritten, room must remain for the next rewrite.
        let needed = data + 4 * HEAD as u64 + 2 * (summary.room() + in_summary) + SPARE;
        if self.failed {
            return Err(io::Error::other("an earlier write failed"));
        }
        if self.room_end - self.data_end < needed {
            self.grow(needed, summary)?;
        }
        Ok(self.data_end)
    }

    /// Appends records to the data, at the position from [`RecordingLayout::reserve`].
    pub(super) fn append(&mut self, records: &[u8]) -> io::Result<()> {
        let end = self.data_end + records.len() as u64;
        let mut behind = Vec::new();
        let next = keep_whole(&mut behind, end);
        behind.extend_from_slice(&head(kind::ROOM, self.room_end - next - HEAD as u64));
        self.write(&records[HEAD..], self.data_end + HEAD as u64)?;
        self.write(&behind, end)?;
        self.switch(&records[..HEAD], self.data_end)?;
        self.data_end = next;
        Ok(())
    }

    /// Appends the new chunk indexes, followed by the statistics.
    pub(super) fn append_indexes(&mut self, summary: &mut RecordingSummary) -> io::Result<()> {
        let begin = self.tail.statistics_at;
        let mut bytes = summary.new_indexes().to_vec();
        let statistics = summary.statistics_record();
        let fits = |at: u64| at % PAGE + (bytes.len() + statistics.len() + 3 * HEAD) as u64 <= PAGE;
        // If the head does not fit into this page, write into the next page before this page points there.
        let at = if fits(begin) { begin } else { pages(begin + HEAD as u64) };
        let statistics_at = keep_whole(&mut bytes, at);
        bytes.extend_from_slice(&statistics);
        let end = at + (bytes.len() + HEAD) as u64;
        if end > self.footer_at {
            return self.renew(summary);
        }
        bytes.extend_from_slice(&head(kind::ROOM, self.footer_at - end));
        if at == begin {
            self.switch(&bytes, at)?;
        } else {
            self.write(&bytes, at)?;
            self.switch(&head(kind::ROOM, at - begin - HEAD as u64), begin)?;
        }
        self.tail.statistics_at = statistics_at;
        summary.is_in_file();
        Ok(())
    }

    /// Writes a summary that has changed in another way; [`RecordingLayout::reserve`] has made room for it.
    pub(super) fn renew(&mut self, summary: &mut RecordingSummary) -> io::Result<()> {
        self.reserve(0, 0, summary)?;
        let at = self.before_room_end(summary.room())?;
        let tail = self.write_tail(summary, at, self.footer_at)?;
        self.lead_to(at, tail, summary)
    }

    /// Appends the end of a finished file, with the positions of all groups and a checksum, and cuts off the rest.
    pub(super) fn finish(mut self, summary: &mut RecordingSummary) -> io::Result<()> {
        self.reserve(0, 0, summary)?;
        let begin = self.data_end + DATA_END as u64;
        let mut at = begin;
        let mut crc = crc32fast::Hasher::new();
        let mut offsets = Vec::new();
        let mut group = |kind, from: u64, to: u64| {
            if to > from {
                record(&mut offsets, kind::SUMMARY_OFFSET, |out| {
                    out.push(kind);
                    out.u64(from);
                    out.u64(to - from);
                });
            }
        };
        for (kind, records) in summary.groups() {
            self.write(records, at)?;
            crc.update(records);
            group(kind, at, at + records.len() as u64);
            at += records.len() as u64;
        }
        let statistics_at = self.write_indexes(summary, at, |copied| crc.update(copied))?;
        group(kind::CHUNK_INDEX, at, statistics_at);
        let mut end = summary.statistics_record();
        let offsets_at = statistics_at + end.len() as u64;
        group(kind::STATISTICS, statistics_at, offsets_at);
        end.append(&mut offsets);
        format::end(&mut end, begin, offsets_at, 0);
        let checked = end.len() - (END - HEAD - 16);
        crc.update(&end[..checked]);
        end[checked..checked + 4].copy_from_slice(&crc.finalize().to_le_bytes());
        self.write(&end, statistics_at)?;
        let mut data_end = Vec::new();
        record(&mut data_end, kind::DATA_END, |out| out.u32(0));
        self.write(&data_end[HEAD..], self.data_end + HEAD as u64)?;
        self.switch(&data_end[..HEAD], self.data_end)?;
        self.file.set_len(statistics_at + end.len() as u64)?;
        self.file.sync_data()
    }

    fn grow(&mut self, needed: u64, summary: &mut RecordingSummary) -> io::Result<()> {
        let room = summary.room();
        let more = (needed + 2 * room + 2 * SPARE).max(self.growth).max(GROWTH_IN_SUMMARIES * room);
        let footer_at = pages(self.footer_at + more) - END as u64;
        // Write the same summary into the remaining free space, with free space after it up to the new footer.
        let at = self.before_room_end(room)?;
        let tail = self.write_tail(summary, at, footer_at)?;
        let mut end = Vec::new();
        format::end(&mut end, at + DATA_END as u64, 0, 0);
        self.write(&end, footer_at)?;
        self.footer_at = footer_at;
        self.leave_room_up_to(at, tail, summary)?;
        // There is now room before the footer, so move the summary there.
        let at = footer_at - SPARE - room - room / 2;
        let tail = self.write_tail(summary, at, footer_at)?;
        self.lead_to(at, tail, summary)
    }

    /// Returns the position of a record of this length at the end of the free space.
    fn before_room_end(&self, length: u64) -> io::Result<u64> {
        let at = self.room_end.checked_sub(length).filter(|&at| at >= self.data_end + HEAD as u64);
        at.ok_or_else(|| io::Error::other("there is no room for the summary"))
    }

    /// Points the footer and the free space at another summary.
    fn lead_to(&mut self, at: u64, tail: Tail, summary: &mut RecordingSummary) -> io::Result<()> {
        let start = (at + DATA_END as u64).to_le_bytes();
        self.switch(&start, self.footer_at + HEAD as u64)?;
        self.leave_room_up_to(at, tail, summary)
    }

    fn leave_room_up_to(&mut self, at: u64, tail: Tail, summary: &mut RecordingSummary) -> io::Result<()> {
        self.switch(&head(kind::ROOM, at - self.data_end - HEAD as u64), self.data_end)?;
        self.room_end = at;
        self.tail = tail;
        summary.is_in_file();
        Ok(())
    }

    /// Writes the end of the data, the summary and the head of the free space before the footer into free space.
    fn write_tail(&mut self, summary: &RecordingSummary, at: u64, footer_at: u64) -> io::Result<Tail> {
        let mut bytes = Vec::new();
        record(&mut bytes, kind::DATA_END, |out| out.u32(0));
        summary.groups().iter().for_each(|(_, records)| bytes.extend_from_slice(records));
        self.write(&bytes, at)?;
        let indexes_at = at + bytes.len() as u64;
        let at = self.write_indexes(summary, indexes_at, |_| ())?;
        bytes.clear();
        let statistics_at = keep_whole(&mut bytes, at);
        bytes.extend_from_slice(&summary.statistics_record());
        let end = at + (bytes.len() + HEAD) as u64;
        let left = footer_at.checked_sub(end).ok_or(ErrorKind::FileTooLarge)?;
        bytes.extend_from_slice(&head(kind::ROOM, left));
        self.write(&bytes, at)?;
        Ok(Tail { indexes_at, statistics_at })
    }

    /// Writes the indexes of chunks again: those of the file's summary without the gaps between them, and the new ones.
    /// Returns the position after them.
    fn write_indexes(&mut self, summary: &RecordingSummary, at: u64, mut copied: impl FnMut(&[u8])) -> io::Result<u64> {
        let Tail { indexes_at, statistics_at } = self.tail;
        let source = ReaderSource::File(self.file.try_clone()?, statistics_at);
        let mut walk = Walk::new(&source, indexes_at, statistics_at);
        let end = at + summary.indexes();
        let mut at = at;
        let mut bytes = Vec::new();
        while let Some(place) = walk.step()? {
            if place.kind == kind::CHUNK_INDEX {
                bytes.extend_from_slice(&head(place.kind, place.length - HEAD as u64));
                bytes.extend_from_slice(walk.content(place, u64::MAX)?);
            }
            if bytes.len() >= COPIED {
                self.write(&bytes, at)?;
                copied(&bytes);
                at += bytes.len() as u64;
                bytes.clear();
            }
        }
        bytes.extend_from_slice(summary.new_indexes());
        self.write(&bytes, at)?;
        copied(&bytes);
        at += bytes.len() as u64;
        if at == end { Ok(at) } else { Err(io::Error::other("another program has changed the end of the file")) }
    }

    /// Writes within one page: this is where the change becomes visible to readers, at once.
    fn switch(&mut self, bytes: &[u8], at: u64) -> io::Result<()> {
        debug_assert_eq!(at / PAGE, (at + bytes.len() as u64 - 1) / PAGE, "across pages");
        self.write(bytes, at).inspect_err(|_| self.failed = true)
    }

    fn write(&mut self, bytes: &[u8], at: u64) -> io::Result<()> {
        at::write_all(&self.file, bytes, at)?;
        self.written += bytes.len() as u64;
        #[cfg(test)]
        self.log.push((at, bytes.to_vec()));
        Ok(())
    }
}

/// Pads `bytes`, which start at `at`, so that the head of the following record is within one page. Returns the position
/// of that record.
fn keep_whole(bytes: &mut Vec<u8>, at: u64) -> u64 {
    if (at + bytes.len() as u64) % PAGE + HEAD as u64 > PAGE {
        bytes.extend_from_slice(&head(kind::ROOM, 0));
    }
    at + bytes.len() as u64
}

/// Rounds up to whole pages.
fn pages(bytes: u64) -> u64 {
    bytes.next_multiple_of(PAGE)
}
