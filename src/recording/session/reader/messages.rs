//! Messages in the order of their times.

use std::{
    cmp::Reverse,
    collections::{BTreeSet, BinaryHeap},
    ops::Range,
    sync::Arc,
};

use super::{
    SessionReader, chunk, contents,
    parse::{self, MESSAGE_HEAD, MessageHead},
};
use crate::session::{ReadError, format::kind, writer::ChannelId};

/// One message, which shares its data with the other messages of its chunk.
#[derive(Clone)]
pub struct SessionMessage {
    head: MessageHead,
    records: Arc<Vec<u8>>,
    data: Range<usize>,
}

impl SessionMessage {
    pub fn channel(&self) -> ChannelId {
        ChannelId(self.head.channel)
    }

    /// Returns the number of the message, from 0, within its channel.
    pub fn sequence(&self) -> u32 {
        self.head.sequence
    }

    /// Returns the time of its sample, ns.
    pub fn log_time_ns(&self) -> u64 {
        self.head.log_time_ns
    }

    /// Returns the time of its publication, ns: the same in our files.
    pub fn publish_time_ns(&self) -> u64 {
        self.head.publish_time_ns
    }

    /// Returns the data, encoded as specified by the channel.
    pub fn data(&self) -> &[u8] {
        &self.records[self.data.clone()]
    }
}

/// The requested messages in the order of their times. A damaged chunk gives one error, then the messages after it
/// follow.
pub struct ReaderMessages<'a> {
    reader: &'a SessionReader,
    /// `None` for all channels.
    wanted: Option<BTreeSet<u16>>,
    times_ns: Range<u64>,
    /// In the order of their first times.
    places: Vec<&'a contents::ContentsMessages>,
    next_place: usize,
    /// Messages of the chunks that are open.
    open: BinaryHeap<Reverse<InOrder>>,
}

/// Time, position of the chunk, and position in it.
struct InOrder((u64, u64, usize), SessionMessage);

impl PartialEq for InOrder {
    fn eq(&self, other: &Self) -> bool {
        self.0 == other.0
    }
}
impl Eq for InOrder {}
impl PartialOrd for InOrder {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for InOrder {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.cmp(&other.0)
    }
}

impl<'a> ReaderMessages<'a> {
    pub(super) fn new(reader: &'a SessionReader, wanted: Option<BTreeSet<u16>>, times_ns: Range<u64>) -> Self {
        let may_hold = |one: &&contents::ContentsMessages| {
            let (first, last) = one.times_ns;
            let theirs = wanted.as_ref().is_none_or(|wanted| {
                // A file without an index of messages does not state the channels of its chunks.
                one.channels.is_empty() || one.channels.iter().any(|channel| wanted.contains(channel))
            });
            theirs && first < times_ns.end && last >= times_ns.start
        };
        let mut places: Vec<_> = reader.contents.messages.iter().filter(may_hold).collect();
        places.sort_by_key(|one| (one.times_ns.0, one.at));
        Self { reader, wanted, times_ns, places, next_place: 0, open: BinaryHeap::new() }
    }

    fn open(&mut self, place: &contents::ContentsMessages) -> Result<(), ReadError> {
        let records = Arc::new(self.reader.records(place)?);
        for (kind, content, at) in chunk::records(&records) {
            let Some(head) = parse::message(content).filter(|_| kind == kind::MESSAGE) else { continue };
            let wanted = self.wanted.as_ref().is_none_or(|wanted| wanted.contains(&head.channel));
            if wanted && self.times_ns.contains(&head.log_time_ns) {
                let data = at + MESSAGE_HEAD..at + content.len();
                let message = SessionMessage { head, records: records.clone(), data };
                self.open.push(Reverse(InOrder((head.log_time_ns, place.at, at), message)));
            }
        }
        Ok(())
    }
}

impl Iterator for ReaderMessages<'_> {
    type Item = Result<SessionMessage, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        while let Some(&place) = self.places.get(self.next_place) {
            // Nothing in the following chunks is older than this message.
            let first = self.open.peek().map(|Reverse(first)| first.0.0);
            if first.is_some_and(|first| first < place.times_ns.0) {
                break;
            }
            self.next_place += 1;
            if let Err(error) = self.open(place) {
                return Some(Err(error));
            }
        }
        self.open.pop().map(|Reverse(InOrder(_, message))| Ok(message))
    }
}
