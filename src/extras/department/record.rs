//! Records a remote rig's session into a file on this machine while it runs.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use crossbeam_channel::{Receiver, RecvTimeoutError, unbounded};
use nima_session::{
    remote_copy::{Bundle, Copy, SessionHead},
    session_store,
};
use zenoh::{Wait as _, pubsub::Subscriber};

use crate::{DepartmentError, RemoteRig, keys};

/// Time to wait for a batch before requesting it. Batches may overtake each other; a request for one that is under way
/// would send it twice.
const PATIENCE: Duration = Duration::from_secs(2);
/// Timeout of a query for bundles.
const ANSWER: Duration = Duration::from_secs(5);

/// Result of a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecordStep {
    /// Nothing new: the rig is not running a loop, or is silent.
    Waits,
    /// A session is being written.
    Writes {
        file: PathBuf,
        /// Bytes in the file.
        bytes: u64,
    },
    /// A session has ended, and its file is complete.
    Ended {
        file: PathBuf,
        /// Number of messages in it.
        messages: u64,
    },
}

/// Writes the sessions of a rig into a folder, one file for each.
pub struct RigRecording<'a> {
    rig: &'a RemoteRig,
    folder: PathBuf,
    came: Receiver<Vec<u8>>,
    file: Option<OpenRecording>,
    /// The session whose file has ended.
    over: Option<u64>,
    asked: Option<Instant>,
    _subscriber: Subscriber<()>,
}

struct OpenRecording {
    copy: Copy,
    path: PathBuf,
    session: u64,
}

impl<'a> RigRecording<'a> {
    /// Begins with the running session, from its beginning if the rig still has it.
    ///
    /// # Errors
    /// [`DepartmentError`] if the rig cannot be queried or the folder does not exist.
    pub fn start(rig: &'a RemoteRig, folder: &Path) -> Result<Self, DepartmentError> {
        std::fs::create_dir_all(folder).map_err(DepartmentError::of_file(folder))?;
        let (to, came) = unbounded();
        let received = move |sample: zenoh::sample::Sample| drop(to.send(sample.payload().to_bytes().into_owned()));
        let subscriber = rig.session.declare_subscriber(keys::bundles(&rig.name)).callback(received).wait();
        let subscriber = subscriber.map_err(|error| rig.silent(&error.to_string()))?;
        let folder = folder.to_owned();
        Ok(Self { rig, folder, came, file: None, over: None, asked: None, _subscriber: subscriber })
    }

    /// Waits for the next data, at most this long, and writes them.
    ///
    /// # Errors
    /// [`DepartmentError`] if the file cannot be written, or the rig runs another version.
    pub fn step(&mut self, wait: Duration) -> Result<RecordStep, DepartmentError> {
        if self.file.is_none() && self.asked.is_none_or(|at| at.elapsed() >= wait) {
            self.asked = Some(Instant::now());
            self.begin()?;
        }
        let bundle = match self.came.recv_timeout(wait.min(PATIENCE)) {
            Ok(packed) => keys::unpack(&packed).map(|bytes| Bundle::read(&bytes)).transpose()?,
            Err(RecvTimeoutError::Disconnected) => return Err(self.rig.silent("the connection is closed")),
            Err(RecvTimeoutError::Timeout) => None,
        };
        match (bundle, &self.file) {
            (Some(bundle), Some(open)) if bundle.session == open.session => self.take(&bundle),
            // Another session has started; the end of this one was missed, or can still be requested.
            (Some(_), Some(_)) => {
                self.catch_up()?;
                self.end()
            }
            (Some(bundle), None) if Some(bundle.session) != self.over => {
                self.begin()?;
                Ok(self.report())
            }
            (Some(_) | None, None) => Ok(RecordStep::Waits),
            (None, Some(_)) => self.catch_up(),
        }
    }

    /// Ends the file that is being written.
    ///
    /// # Errors
    /// [`DepartmentError`] if it cannot be written.
    pub fn finish(mut self) -> Result<RecordStep, DepartmentError> {
        self.end()
    }

    fn report(&self) -> RecordStep {
        self.file
            .as_ref()
            .map_or(RecordStep::Waits, |open| RecordStep::Writes { file: open.path.clone(), bytes: open.copy.bytes() })
    }

    fn end(&mut self) -> Result<RecordStep, DepartmentError> {
        let Some(OpenRecording { copy, path, session }) = self.file.take() else { return Ok(RecordStep::Waits) };
        self.over = Some(session);
        self.asked = None;
        Ok(RecordStep::Ended { file: path, messages: copy.finish()? })
    }

    /// Starts a file with the oldest batch that the rig has, if it runs a session.
    fn begin(&mut self) -> Result<(), DepartmentError> {
        let Some(head) = self.rig.ask(&keys::head(&self.rig.name))? else { return Ok(()) };
        let Some(head) = keys::unpack(&head.to_bytes()).map(|bytes| SessionHead::read(&bytes)).transpose()? else {
            return Ok(());
        };
        if self.over == Some(head.session) {
            return Ok(());
        }
        let bundles = self.ask_from(head.first)?;
        let Some((first, rest)) = bundles.split_first().filter(|(first, _)| first.number == head.first) else {
            return Ok(());
        };
        let words = |key: &str| head.table(first, "session").and_then(|table| table.get(key)).cloned();
        let started = words("started").unwrap_or_else(|| "session".to_owned());
        let path = session_store::free_name(&self.folder, &started, &self.rig.name)
            .map_err(DepartmentError::of_file(&self.folder))?;
        let copy = Copy::create(&path, &head, first)?;
        self.file = Some(OpenRecording { copy, path, session: head.session });
        for bundle in rest {
            self.take(bundle)?;
        }
        Ok(())
    }

    fn take(&mut self, bundle: &Bundle) -> Result<RecordStep, DepartmentError> {
        let Some(open) = &mut self.file else { return Ok(RecordStep::Waits) };
        // Requested batches arrive a second time.
        if bundle.session != open.session || bundle.number < open.copy.due() {
            return Ok(self.report());
        }
        if bundle.number > open.copy.due() {
            return self.catch_up();
        }
        open.copy.add(bundle)?;
        if bundle.closes { self.end() } else { Ok(self.report()) }
    }

    /// Requests the missing batches until none are missing. Batches that the rig no longer has are lost: the file ends
    /// there, and another one starts.
    fn catch_up(&mut self) -> Result<RecordStep, DepartmentError> {
        loop {
            let Some(open) = &self.file else { return Ok(RecordStep::Waits) };
            let due = open.copy.due();
            let session = open.session;
            let bundles = self.ask_from(due)?;
            let next = bundles.iter().find(|bundle| bundle.number == due && bundle.session == session);
            if next.is_none() {
                return if self.has_lost(due, session)? { self.lose() } else { Ok(self.report()) };
            }
            for bundle in &bundles {
                let Some(open) = &mut self.file else { return Ok(RecordStep::Waits) };
                if bundle.session == session && bundle.number == open.copy.due() {
                    open.copy.add(bundle)?;
                    if bundle.closes {
                        return self.end();
                    }
                }
            }
        }
    }

    /// Returns whether the rig no longer has this batch.
    fn has_lost(&self, number: u64, session: u64) -> Result<bool, DepartmentError> {
        let Some(head) = self.rig.ask(&keys::head(&self.rig.name))? else { return Ok(false) };
        let head = keys::unpack(&head.to_bytes()).map(|bytes| SessionHead::read(&bytes)).transpose()?;
        Ok(head.is_some_and(|head| head.session != session || head.first > number))
    }

    fn lose(&mut self) -> Result<RecordStep, DepartmentError> {
        let ended = self.end()?;
        // The session may continue; its further data become an excerpt in a separate file.
        self.over = None;
        Ok(ended)
    }

    /// Returns the bundles from this one on that arrive in one answer, in order.
    fn ask_from(&self, number: u64) -> Result<Vec<Bundle>, DepartmentError> {
        let key = format!("{}?from={number}", keys::bundles(&self.rig.name));
        let replies =
            self.rig.session.get(key).consolidation(zenoh::query::ConsolidationMode::None).timeout(ANSWER).wait();
        let replies = replies.map_err(|error| self.rig.silent(&error.to_string()))?;
        let mut bundles = Vec::new();
        for reply in replies {
            let Ok(sample) = reply.into_result() else { continue };
            if let Some(bytes) = keys::unpack(&sample.payload().to_bytes()) {
                bundles.push(Bundle::read(&bytes)?);
            }
        }
        bundles.sort_by_key(|bundle| bundle.number);
        Ok(bundles)
    }
}

impl std::fmt::Debug for RigRecording<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recording").field("rig", &self.rig).field("folder", &self.folder).finish_non_exhaustive()
    }
}
