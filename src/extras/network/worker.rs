//! Thread that runs next to the loop's thread for as long as its owner exists.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering::Relaxed},
    },
    thread::{Builder, JoinHandle, sleep},
    time::{Duration, Instant},
};

/// A thread that runs turns until this is dropped; dropping waits for the current turn.
#[derive(Debug)]
pub(crate) struct NetworkWorker {
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl NetworkWorker {
    /// Starts the thread; `turn` gets the time since then, s, and returns how long to wait before the next turn.
    pub(crate) fn start(name: &str, mut turn: impl FnMut(f64) -> Duration + Send + 'static) -> io::Result<Self> {
        let ends = Arc::new(AtomicBool::new(false));
        let theirs = Arc::clone(&ends);
        let work = move || {
            let begin = Instant::now();
            while !theirs.load(Relaxed) {
                sleep(turn(begin.elapsed().as_secs_f64()));
            }
        };
        let thread = Builder::new().name(name.into()).spawn(work)?;
        Ok(Self { ends, thread: Some(thread) })
    }
}

impl Drop for NetworkWorker {
    fn drop(&mut self) {
        self.ends.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}
