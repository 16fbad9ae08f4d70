//! Writes a session file to the disk each second.

use std::{
    fs::File,
    io,
    path::Path,
    sync::Arc,
    thread::{Builder, JoinHandle},
    time::Duration,
};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};

use super::{RecordError, Shared};

/// The file is synchronised with the disk this often.
const SYNC_EVERY: Duration = Duration::from_secs(1);

/// The thread that writes the file to the disk each second, so that the loss of power costs no more.
pub(super) struct Sync {
    ends: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Sync {
    pub(super) fn start(path: &Path, file: File, shared: &Arc<Shared>) -> Result<Self, RecordError> {
        let (ends, asked) = bounded(1);
        let (path, told) = (path.to_owned(), Arc::clone(shared));
        let run = move || {
            if let Err(source) = sync(&file, &asked) {
                told.trouble.set(RecordError::System { path, source }).ok();
            }
        };
        let thread = Builder::new().name("recorder-sync".to_owned()).spawn(run);
        let thread = thread.map_err(RecordError::Thread)?;
        Ok(Self { ends: Some(ends), thread: Some(thread) })
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
