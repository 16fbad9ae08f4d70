//! Writes a session file to the disk each second.

use std::{
    fs::File,
    io,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
    thread::{Builder, JoinHandle},
    time::Duration,
};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};

use super::RecordError;

/// The file is synchronised with the disk this often.
const SYNC_EVERY: Duration = Duration::from_secs(1);

/// The thread that writes the file to the disk each second, so that the loss of power costs no more.
#[derive(Debug)]
pub(crate) struct Sync {
    ends: Option<Sender<()>>,
    failure: Receiver<io::Error>,
    chunks: Arc<Chunks>,
    thread: Option<JoinHandle<()>>,
}

/// Chunks of the file: those that the system has, and those that the disk has said it has.
#[derive(Debug, Default)]
struct Chunks {
    written: AtomicU32,
    synchronised: AtomicU32,
}

impl Sync {
    pub(crate) fn start(file: File) -> Result<Self, RecordError> {
        let ((ends, asked), (tell, failure)) = (bounded(1), bounded(1));
        let chunks = Arc::<Chunks>::default();
        let counted = Arc::clone(&chunks);
        let run = move || {
            if let Err(error) = sync(&file, &asked, &counted) {
                tell.send(error).ok();
            }
        };
        let thread = Builder::new().name("recorder-sync".to_owned()).spawn(run);
        let thread = thread.map_err(RecordError::Thread)?;
        Ok(Self { ends: Some(ends), failure, chunks, thread: Some(thread) })
    }

    /// So many chunks are written whole; returns how many are on the disk.
    pub(crate) fn written(&self, chunks: u32) -> u32 {
        self.chunks.written.store(chunks, Ordering::Release);
        self.chunks.synchronised.load(Ordering::Acquire)
    }

    /// Why the disk has not taken what was written; told once.
    pub(crate) fn failed(&self) -> Option<io::Error> {
        self.failure.try_recv().ok()
    }

    /// Ends it without waiting for the disk.
    pub(crate) fn leave(mut self) {
        drop(self.thread.take());
    }
}

fn sync(file: &File, ends: &Receiver<()>, chunks: &Chunks) -> io::Result<()> {
    loop {
        let ended = ends.recv_timeout(SYNC_EVERY) != Err(RecvTimeoutError::Timeout);
        let written = chunks.written.load(Ordering::Acquire);
        file.sync_data()?;
        chunks.synchronised.store(written, Ordering::Release);
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
