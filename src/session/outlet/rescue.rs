//! A recording whose file fails: what the disk has not confirmed yet, and the second place, where it goes on.

use std::{
    collections::{BTreeMap, VecDeque},
    mem::take,
    path::{Path, PathBuf},
};

use nima_recording::session::{WriteError, Writer};

use super::Known;
use crate::{
    cut,
    recorder::{Attached, RecordError, Sync},
};

/// What went wrong with a file.
#[derive(Debug)]
pub(crate) struct Trouble {
    /// What.
    pub(crate) why: RecordError,
    /// Where the recording goes on; `None`: nowhere.
    pub(crate) to: Option<PathBuf>,
}

/// Most bytes that are kept of what the disk has not confirmed: far more than it usually has not.
const MOST_BYTES: usize = 256 << 20;

/// A message that may not be on the disk.
#[derive(Debug)]
struct Unwritten {
    /// Chunks of the file before it.
    chunks: u32,
    channel: usize,
    time_ns: u64,
    data: Vec<u8>,
}

/// What a recording needs to go on elsewhere.
#[derive(Debug)]
pub(crate) struct Rescue {
    file: Option<PathBuf>,
    second: Option<PathBuf>,
    program: String,
    started_ns: u64,
    tables: Vec<(String, BTreeMap<String, String>)>,
    attached: Vec<(u64, Attached)>,
    /// Messages that the disk has not confirmed yet, oldest first.
    unwritten: VecDeque<Unwritten>,
    /// Their bytes.
    bytes: usize,
    sync: Option<Sync>,
    troubles: Vec<Trouble>,
}

impl Rescue {
    pub(crate) fn new(file: Option<&Path>, second: Option<&Path>, program: &str, started_ns: u64) -> Self {
        Self {
            file: file.map(Path::to_owned),
            second: second.map(Path::to_owned),
            program: program.to_owned(),
            started_ns,
            tables: Vec::new(),
            attached: Vec::new(),
            unwritten: VecDeque::new(),
            bytes: 0,
            sync: None,
            troubles: Vec::new(),
        }
    }

    /// Keeps this file on the disk from now on.
    pub(super) fn synchronise(&mut self, writer: &Writer) -> Result<(), RecordError> {
        let Some(path) = &self.file else { return Ok(()) };
        let failed = |source| RecordError::System { path: path.clone(), source };
        self.sync = Some(Sync::start(writer.sync_handle().map_err(failed)?)?);
        Ok(())
    }

    /// Why the disk has not taken what was written.
    pub(super) fn unsynchronised(&self) -> Option<RecordError> {
        let source = self.sync.as_ref().and_then(Sync::failed)?;
        Some(RecordError::System { path: self.file.clone().unwrap_or_default(), source })
    }

    pub(super) fn troubles(&mut self) -> Vec<Trouble> {
        take(&mut self.troubles)
    }

    /// A message was handed to the file, which has so many chunks now.
    pub(super) fn message(&mut self, chunks: u32, channel: usize, log_time_ns: u64, data: &[u8]) {
        if self.second.is_none() {
            return;
        }
        let on_disk = self.sync.as_ref().map_or(0, |sync| sync.written(chunks));
        let is_old = |bytes: usize, first: &Unwritten| first.chunks < on_disk || bytes > MOST_BYTES;
        while let Some(first) = self.unwritten.front().filter(|first| is_old(self.bytes, first)) {
            self.bytes -= first.data.len();
            self.unwritten.pop_front();
        }
        self.bytes += data.len();
        self.unwritten.push_back(Unwritten { chunks, channel, time_ns: log_time_ns, data: data.to_vec() });
    }

    pub(super) fn metadata(&mut self, name: &str, entries: &BTreeMap<String, String>) {
        if self.second.is_some() {
            self.tables.push((name.to_owned(), entries.clone()));
        }
    }

    pub(super) fn attachment(&mut self, time_ns: u64, attached: &Attached) {
        if self.second.is_some() {
            self.attached.push((time_ns, attached.clone()));
        }
    }

    /// The file has failed: begins the second one with all that is not in the first, if there is one.
    pub(super) fn go_on(&mut self, why: RecordError, channels: &mut [Known]) -> Option<Writer> {
        // It may hang in the system as long as the disk does.
        if let Some(sync) = self.sync.take() {
            sync.leave();
        }
        let Some(to) = self.second.take() else {
            self.troubles.push(Trouble { why, to: None });
            return None;
        };
        let begun = self.begin(&to, &why, channels).map_err(RecordError::from).and_then(|writer| {
            self.file = Some(to.clone());
            self.synchronise(&writer).map(|()| writer)
        });
        (self.unwritten, self.bytes) = (VecDeque::new(), 0);
        match begun {
            Ok(writer) => {
                self.troubles.push(Trouble { why, to: Some(to) });
                Some(writer)
            }
            Err(second) => {
                let why = RecordError::Both { first: Box::new(why), second: Box::new(second) };
                self.troubles.push(Trouble { why, to: None });
                None
            }
        }
    }

    fn begin(&self, to: &Path, why: &RecordError, channels: &mut [Known]) -> Result<Writer, WriteError> {
        let mut writer = Writer::create(to, &self.program)?;
        let from_ns = self.unwritten.front().map_or(self.started_ns, |first| first.time_ns);
        let name = self.file.as_deref().and_then(Path::file_name).unwrap_or_default().to_string_lossy();
        let mut table = cut::table(&name, self.started_ns, &(from_ns..u64::MAX), cut::Kept::GoesOn, None);
        table.insert(cut::WHY.to_owned(), why.to_string());
        writer.metadata(cut::TABLE, &table)?;
        for (name, entries) in &self.tables {
            writer.metadata(name, entries)?;
        }
        for (time_ns, Attached { name, media_type, data }) in &self.attached {
            writer.attachment(name, media_type, *time_ns, data)?;
        }
        for known in &mut *channels {
            known.of_file = Some(writer.channel(&known.topic, known.encoding.clone())?);
        }
        let id = |channel: usize| channels.get(channel).and_then(|known| known.of_file);
        for Unwritten { channel, time_ns, data, .. } in &self.unwritten {
            if let Some(id) = id(*channel) {
                writer.message(id, *time_ns, data)?;
            }
        }
        writer.flush()?;
        Ok(writer)
    }
}
