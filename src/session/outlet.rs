//! Where the topics of a session go: into its file, and to those who watch while it happens.

use std::{fmt::Debug, path::Path};

use nima_recording::session::{ChannelId, Encoding, WriteError, Writer};

/// Where a recorder writes to. With neither, it only empties the tap.
#[derive(Debug, Default)]
pub struct Destination<'a> {
    /// A new session file.
    pub file: Option<&'a Path>,
    /// Those who watch.
    pub audience: Option<Box<dyn Audience>>,
}

impl<'a> Destination<'a> {
    /// A file alone.
    pub fn file(path: &'a Path) -> Self {
        Self { file: Some(path), audience: None }
    }
}

/// Those who watch a session while it happens: they get the channels and messages of its file, without the journal. Called on the
/// recorder's thread, which must not wait for them.
pub trait Audience: Send + Debug {
    /// A new channel. Its number is the count of those before it.
    fn channel(&mut self, topic: &str, encoding: &Encoding);

    /// A message of a channel, with the time of its sample (ns since 1970).
    fn message(&mut self, channel: usize, log_time_ns: u64, data: &[u8]);
}

/// A channel of an outlet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Channel(usize);

/// The file, if there is one, and the audience, if there is one.
pub(crate) struct Outlet {
    /// What only the file gets is written here.
    pub(crate) file: Option<Writer>,
    /// Of the file, by number.
    channels: Vec<Option<ChannelId>>,
    audience: Option<Box<dyn Audience>>,
}

impl Outlet {
    pub(crate) fn create(to: Destination<'_>, program: &str) -> Result<Self, WriteError> {
        let file = to.file.map(|path| Writer::create(path, program)).transpose()?;
        Ok(Self { file, channels: Vec::new(), audience: to.audience })
    }

    /// A file alone, which was begun before.
    pub(crate) const fn of(file: Writer) -> Self {
        Self { file: Some(file), channels: Vec::new(), audience: None }
    }

    pub(crate) fn channel(&mut self, topic: &str, encoding: Encoding) -> Result<Channel, WriteError> {
        if let Some(audience) = &mut self.audience {
            audience.channel(topic, &encoding);
        }
        let of_file = self.file.as_mut().map(|file| file.channel(topic, encoding)).transpose()?;
        self.channels.push(of_file);
        Ok(Channel(self.channels.len() - 1))
    }

    pub(crate) fn message(&mut self, channel: Channel, log_time_ns: u64, data: &[u8]) -> Result<(), WriteError> {
        if let Some(audience) = &mut self.audience {
            audience.message(channel.0, log_time_ns, data);
        }
        match (&mut self.file, self.channels.get(channel.0)) {
            (Some(file), Some(Some(id))) => file.message(*id, log_time_ns, data),
            _ => Ok(()),
        }
    }

    /// Bytes in the file.
    pub(crate) fn bytes(&self) -> u64 {
        self.file.as_ref().map_or(0, |file| file.bytes().1)
    }

    /// Closes the chunk of the file now.
    pub(crate) fn flush(&mut self) -> Result<(), WriteError> {
        self.file.as_mut().map_or(Ok(()), Writer::flush)
    }
}
