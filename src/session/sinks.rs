//! Distributes the topics of a session to its file and to live viewers.
//!
//! If the file can no longer be written, the recording ends, but live viewers continue to receive everything.

use std::{
    collections::BTreeMap,
    fmt::Debug,
    path::{Path, PathBuf},
};

use nima_machine::{
    messages::{Event, Tick},
    rig::SIDES,
};
use nima_recording::session::{ChannelId, Encoding, SessionWriter, WriteError};

use crate::{
    objects::ObjectStates,
    recorder::{AttachedFile, RecordError, Sync},
};

/// Destinations of a recorder. Without any, it only empties the tap.
#[derive(Debug, Default)]
pub struct Destination<'a> {
    pub file: Option<&'a Path>,
    /// Live viewers.
    pub audiences: Vec<Box<dyn Audience>>,
}

impl<'a> Destination<'a> {
    pub fn file(path: &'a Path) -> Self {
        Self { file: Some(path), ..Self::default() }
    }
}

/// A live viewer of a session: receives everything that its file receives. Called on the recorder's thread, which must
/// not wait.
pub trait Audience: Send + Debug {
    /// Called when a session starts, recorded by this program; the clock of its loop started at this time (ns since
    /// 1970).
    fn begins(&mut self, _program: &str, _started_ns: u64) {}

    /// Called when the loop has started, and once a second: its clock started at this time (ns since 1970), as its clock
    /// and UTC relate now. The times of the messages refer to the first of these.
    fn clock(&mut self, _started_ns: u64) {}

    fn metadata(&mut self, _name: &str, _entries: &BTreeMap<String, String>) {}

    /// Called for a whole file.
    fn attachment(&mut self, _time_ns: u64, _attached: &AttachedFile) {}

    /// Called for a new channel. Channels are numbered from 0 in the order of these calls. Images are only in the file.
    fn channel(&mut self, topic: &str, encoding: &Encoding);

    /// Called for a message of a channel, with the time of its sample (ns since 1970).
    fn message(&mut self, channel: usize, log_time_ns: u64, data: &[u8]);

    /// Called for a tick as the screen shows it, with the events reported in it. All of it is in the journal too.
    fn tick(&mut self, _t_s: f64, _ticks: &[Option<Tick>; SIDES], _events: &[Event]) {}

    /// Called for the objects of a scene, before the tick of their time. Their messages follow separately.
    fn objects(&mut self, _objects: &ObjectStates) {}
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct SinkChannel(usize);

/// A channel of the file that viewers do not receive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FileChannel(usize);

struct WrittenChannel {
    of_file: Option<ChannelId>,
    /// Number for viewers; `None` if they do not receive it.
    of_audiences: Option<usize>,
}

/// The optional file, and the viewers.
pub(crate) struct SessionSinks {
    file: Option<SessionWriter>,
    channels: Vec<WrittenChannel>,
    audiences: Vec<Box<dyn Audience>>,
    /// Writes the file at this path to the disk; if absent, the caller gets the errors of the file.
    sync: Option<(PathBuf, Sync)>,
    /// Reason why the file has ended, until it has been reported.
    trouble: Option<RecordError>,
}

impl SessionSinks {
    /// Begins the file. If the file fails later, [`SessionSinks::trouble`] returns why.
    pub(crate) fn create(to: Destination<'_>, program: &str, started_ns: u64) -> Result<Self, RecordError> {
        let Destination { file: path, mut audiences } = to;
        let file = path.map(|path| SessionWriter::create(path, program)).transpose()?;
        let synchronised = |(path, file): (&Path, &SessionWriter)| {
            let handle = file.sync_handle().map_err(|source| RecordError::System { path: path.to_owned(), source })?;
            Ok::<_, RecordError>((path.to_owned(), Sync::start(handle)?))
        };
        let sync = path.zip(file.as_ref()).map(synchronised).transpose()?;
        for audience in &mut audiences {
            audience.begins(program, started_ns);
        }
        Ok(Self { file, channels: Vec::new(), audiences, sync, trouble: None })
    }

    /// Creates a file that was begun earlier, without viewers.
    pub(crate) const fn of(file: SessionWriter) -> Self {
        Self { file: Some(file), channels: Vec::new(), audiences: Vec::new(), sync: None, trouble: None }
    }

    /// Passes on the start of the loop's clock.
    pub(crate) fn clock(&mut self, started_ns: u64) {
        self.audiences.iter_mut().for_each(|audience| audience.clock(started_ns));
    }

    /// Returns whether any destination receives the data.
    pub(crate) const fn is_received(&self) -> bool {
        self.file.is_some() || !self.audiences.is_empty()
    }

    /// Opens a channel for the file and the viewers.
    pub(crate) fn channel(&mut self, topic: &str, encoding: Encoding) -> Result<SinkChannel, WriteError> {
        for audience in &mut self.audiences {
            audience.channel(topic, &encoding);
        }
        let number = self.channels.iter().filter(|known| known.of_audiences.is_some()).count();
        Ok(SinkChannel(self.add(topic, encoding, Some(number))?))
    }

    /// Opens a channel for the file only.
    pub(crate) fn file_channel(&mut self, topic: &str, encoding: Encoding) -> Result<FileChannel, WriteError> {
        Ok(FileChannel(self.add(topic, encoding, None)?))
    }

    fn add(&mut self, topic: &str, encoding: Encoding, of_audiences: Option<usize>) -> Result<usize, WriteError> {
        let of_file = self.file.as_mut().map(|file| file.channel(topic, encoding)).transpose()?;
        self.channels.push(WrittenChannel { of_file, of_audiences });
        Ok(self.channels.len() - 1)
    }

    pub(crate) fn message(&mut self, channel: SinkChannel, log_time_ns: u64, data: &[u8]) -> Result<(), WriteError> {
        if let Some(number) = self.channels.get(channel.0).and_then(|known| known.of_audiences) {
            for audience in &mut self.audiences {
                audience.message(number, log_time_ns, data);
            }
        }
        self.file_message(FileChannel(channel.0), log_time_ns, data)
    }

    /// Writes a message to the file only.
    pub(crate) fn file_message(
        &mut self,
        channel: FileChannel,
        log_time_ns: u64,
        data: &[u8],
    ) -> Result<(), WriteError> {
        let Some(WrittenChannel { of_file, .. }) = self.channels.get(channel.0) else { return Ok(()) };
        let (Some(file), Some(id)) = (&mut self.file, of_file) else { return Ok(()) };
        let written = file.message(*id, log_time_ns, data);
        self.or_end(written)
    }

    /// Passes a tick to the viewers; the file has it in its journal.
    pub(crate) fn tick(&mut self, t_s: f64, ticks: &[Option<Tick>; SIDES], events: &[Event]) {
        for audience in &mut self.audiences {
            audience.tick(t_s, ticks, events);
        }
    }

    /// Passes objects of a scene to the viewers; the file has them in its messages.
    pub(crate) fn objects(&mut self, objects: &ObjectStates) {
        for audience in &mut self.audiences {
            audience.objects(objects);
        }
    }

    /// Writes named values.
    pub(crate) fn metadata(&mut self, name: &str, entries: &BTreeMap<String, String>) -> Result<(), WriteError> {
        for audience in &mut self.audiences {
            audience.metadata(name, entries);
        }
        let Some(file) = &mut self.file else { return Ok(()) };
        let written = file.metadata(name, entries);
        self.or_end(written)
    }

    /// Writes a whole file.
    pub(crate) fn attachment(&mut self, time_ns: u64, attached: &AttachedFile) -> Result<(), WriteError> {
        for audience in &mut self.audiences {
            audience.attachment(time_ns, attached);
        }
        let Some(file) = &mut self.file else { return Ok(()) };
        let AttachedFile { name, media_type, data } = attached;
        let written = file.attachment(name, media_type, time_ns, data);
        self.or_end(written)
    }

    pub(crate) fn bytes(&self) -> u64 {
        self.file.as_ref().map_or(0, |file| file.bytes().1)
    }

    /// Closes the chunk of the file now.
    pub(crate) fn flush(&mut self) -> Result<(), WriteError> {
        let written = self.file.as_mut().map_or(Ok(()), SessionWriter::flush);
        self.or_end(written)
    }

    /// Closes the file and returns its number of messages.
    pub(crate) fn finish(mut self) -> Result<u64, WriteError> {
        let Some(file) = self.file.take() else { return Ok(0) };
        Ok(file.finish()?.messages)
    }

    /// Checks whether the disk has accepted the data; call it regularly.
    pub(crate) fn look(&mut self) {
        let Some((path, sync)) = &self.sync else { return };
        if let Some(source) = sync.failed() {
            let path = path.clone();
            self.give_up(RecordError::System { path, source });
        }
    }

    /// Returns once why the file has ended by itself.
    pub(crate) fn trouble(&mut self) -> Option<RecordError> {
        self.trouble.take()
    }

    fn or_end(&mut self, written: Result<(), WriteError>) -> Result<(), WriteError> {
        match written {
            Err(error) if self.sync.is_some() => {
                self.give_up(error.into());
                Ok(())
            }
            written => written,
        }
    }

    /// Ends the file after a failure; only the viewers remain.
    fn give_up(&mut self, why: RecordError) {
        // Closing the file may block as long as the disk does.
        if let Some((_, sync)) = self.sync.take() {
            sync.leave();
        }
        self.file = None;
        self.trouble = Some(why);
    }
}
