//! Writes a session file to the disk every second.

use std::{
    fs::File,
    io,
    thread::{Builder, JoinHandle},
    time::Duration,
};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};

use super::RecordError;

/// Interval between two syncs of the file.
const SYNC_EVERY: Duration = Duration::from_secs(1);

/// The thread that syncs the file every second, so that a power loss costs no more than that.
#[derive(Debug)]
pub(crate) struct Sync {
    ends: Option<Sender<()>>,
    failure: Receiver<io::Error>,
    thread: Option<JoinHandle<()>>,
}

impl Sync {
    pub(crate) fn start(file: File) -> Result<Self, RecordError> {
        let (ends, asked) = bounded(1);
        let (report, failure) = bounded(1);
        let run = move || {
            if let Err(error) = sync(&file, &asked) {
                report.send(error).ok();
            }
        };
        let thread = Builder::new().name("recorder-sync".to_owned()).spawn(run);
        let thread = thread.map_err(RecordError::Thread)?;
        Ok(Self { ends: Some(ends), failure, thread: Some(thread) })
    }

    /// Returns once why the disk has not accepted the data.
    pub(crate) fn failed(&self) -> Option<io::Error> {
        self.failure.try_recv().ok()
    }

    /// Ends the thread without waiting for the disk.
    pub(crate) fn leave(mut self) {
        drop(self.thread.take());
    }
}

fn sync(file: &File, ends: &Receiver<()>) -> io::Result<()> {
    loop {
        let ended = ends.recv_timeout(SYNC_EVERY) != Err(RecvTimeoutError::Timeout);
        file.sync_data()?;
        if ended {
            return Ok(());
        }
    }
}

impl Drop for Sync {
    fn drop(&mut self) {
        drop(self.ends.take());
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}
