//! Marks for recordings of other instruments, over the Lab Streaming Layer (LSL): what happened, when, by the clock of LSL.
//!
//! Its library is loaded while the program runs, where somebody asks for it. Marks tell what happened, never under which mode, gain or delay, so
//! that they can be taken in a blind study.

mod audience;
mod clock;
mod library;
mod marks;
#[cfg(test)]
mod tests;

use std::{
    fmt,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{Builder, JoinHandle},
    time::Duration,
};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};
use nima_session::outlet::Audience;

use self::{
    audience::Marking,
    library::{Info, Lsl},
};

/// Name and kind of the stream.
pub const STREAM: &str = "NIMA";
/// See [`STREAM`].
pub const STREAM_TYPE: &str = "Markers";
/// Force at the tip from which on it is in contact, N, where a task does not say it.
pub const CONTACT_N: f64 = 0.2;

/// Marks that wait for the library, at most.
const QUEUE: usize = 1024;
/// How often is looked whether somebody listens.
const LOOK_EVERY: Duration = Duration::from_millis(200);

/// Why there are no marks.
#[derive(Debug, thiserror::Error)]
pub enum LslError {
    /// The library is nowhere.
    #[error(
        "Lab Streaming Layer: liblsl is not installed (searched: {searched}); install it from \
         https://github.com/sccn/liblsl/releases or with `pip install pylsl`, and name its file: --lsl FILE"
    )]
    Missing {
        /// Where it was looked for.
        searched: String,
    },
    /// It cannot be used.
    #[error(
        "Lab Streaming Layer: {path} cannot be used: {reason}; name another file of liblsl 1.13 or newer: --lsl FILE"
    )]
    Unusable {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// It offers no stream.
    #[error("Lab Streaming Layer: it cannot offer a stream: {reason}; check the network and the file lsl_api.cfg")]
    Stream {
        /// Why.
        reason: String,
    },
}

/// What a session's marks need to know of it.
#[derive(Clone, Debug)]
pub struct About {
    /// Force at the tip from which on it is in contact, N.
    pub contact_n: f64,
    /// What is marked at its begin and its end: `trial P03 4`; nothing for a session that is no trial.
    pub trial: Option<String>,
    /// A sentence for a fault.
    pub words: fn(nima_machine::messages::Fault) -> &'static str,
}

/// A stream of marks, until it is dropped.
pub struct Marker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    lsl: Lsl,
    marks: Sender<Mark>,
    dropped: AtomicU64,
    heard: AtomicBool,
    ends: AtomicBool,
}

/// What happened, by the clock of LSL (s).
#[derive(Clone, Debug, PartialEq)]
struct Mark {
    at_s: f64,
    what: String,
}

impl Shared {
    fn mark(&self, at_s: f64, what: String) {
        if self.marks.try_send(Mark { at_s, what }).is_err() {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }
}

impl Marker {
    /// Offers the stream to this network. The library is this file, or without one that of the system; `program` and `machine` describe where the
    /// marks come from.
    ///
    /// # Errors
    /// [`LslError`] if there is no library, or it offers no stream.
    pub fn start(library: Option<&Path>, program: &str, machine: &str) -> Result<Self, LslError> {
        let lsl = Lsl::open(library)?;
        let (marks, comes) = bounded(QUEUE);
        let heard = AtomicBool::new(false);
        let ends = AtomicBool::new(false);
        let shared = Arc::new(Shared { lsl, marks, dropped: AtomicU64::new(0), heard, ends });
        let info = Info {
            name: STREAM,
            kind: STREAM_TYPE,
            source: &format!("nima-{machine}"),
            about: &[("manufacturer", program), ("clock", "ticks of the loop, mapped onto lsl_local_clock")],
        };
        // The stream is there when this returns; it is used by its own thread alone.
        let stream = lsl.stream(&info)?;
        let told = Arc::clone(&shared);
        let run = move || push(&stream, &comes, &told);
        let thread = Builder::new().name("lsl-marks".to_owned()).spawn(run);
        let thread = thread.map_err(|error| LslError::Stream { reason: error.to_string() })?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Whether somebody listens.
    pub fn is_heard(&self) -> bool {
        self.shared.heard.load(Ordering::Relaxed)
    }

    /// Marks that found no room.
    pub fn dropped(&self) -> u64 {
        self.shared.dropped.load(Ordering::Relaxed)
    }

    /// For the recorder of the next session.
    pub fn audience(&self, about: About) -> Box<dyn Audience> {
        Box::new(Marking::new(Arc::clone(&self.shared), about))
    }
}

/// Hands marks to the library until the stream ends.
fn push(stream: &library::Stream, comes: &Receiver<Mark>, shared: &Shared) {
    loop {
        match comes.recv_timeout(LOOK_EVERY) {
            Ok(Mark { at_s, what }) => stream.push(&what, at_s),
            Err(RecvTimeoutError::Timeout) if !shared.ends.load(Ordering::Acquire) => {}
            Err(_) => return,
        }
        shared.heard.store(stream.is_heard(), Ordering::Relaxed);
    }
}

impl Drop for Marker {
    fn drop(&mut self) {
        self.shared.ends.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

impl fmt::Debug for Marker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Marker").field("shared", &self.shared).finish_non_exhaustive()
    }
}
