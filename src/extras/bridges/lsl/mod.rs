//! Markers for recordings of other instruments, over the Lab Streaming Layer (LSL): events with LSL time stamps.
//!
//! The library is loaded at run time, only when requested. Markers contain events, never the mode, gain or delay,
//! and in a trial not the cause of a fault, so that they can be used in a blind study.

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
use nima_session::sinks::Audience;

use self::{
    audience::SessionMarks,
    library::{Info, Lsl},
};

/// Name of the stream.
pub const STREAM: &str = "NIMA";
/// Type of the stream.
pub const STREAM_TYPE: &str = "Markers";
/// Force at the tip above which there is contact, N, unless the task sets it. Several times the noise of the sensors,
/// and below the lightest touch that a hand feels.
pub const CONTACT_N: f64 = 0.2;

/// Maximum number of markers that wait for the library.
const QUEUE: usize = 1024;
/// Interval between checks for a listener.
const LOOK_EVERY: Duration = Duration::from_millis(200);

/// Reason why there are no markers.
#[derive(Debug, thiserror::Error)]
pub enum LslError {
    /// The library was not found.
    #[error(
        "Lab Streaming Layer: liblsl not found (searched: {searched}); install it from https://github.com/sccn/liblsl/releases or with `pip install pylsl`, and name its file: --lsl FILE"
    )]
    Missing {
        /// The searched locations.
        searched: String,
    },
    /// The library cannot be used.
    #[error(
        "Lab Streaming Layer: {path} cannot be used: {reason}; name another file of liblsl 1.13 or newer: --lsl FILE"
    )]
    Unusable { path: PathBuf, reason: String },
    /// The library cannot create a stream.
    #[error("Lab Streaming Layer: cannot create a stream: {reason}; check the network and the file lsl_api.cfg")]
    Stream { reason: String },
}

/// Information about a session required for its markers.
#[derive(Clone, Debug)]
pub struct MarkContext {
    /// Force at the tip above which there is contact, N.
    pub contact_n: f64,
    /// Text of the markers at the start and the end of the trial: `trial P03 4`; `None` for a session that is not a
    /// trial.
    pub trial: Option<String>,
    /// Returns the cause of a fault as a sentence. `None` in a trial: some causes occur only with force, so they would
    /// reveal the condition.
    pub words: Option<fn(nima_machine::messages::Fault) -> &'static str>,
}

/// A stream of markers, until it is dropped.
pub struct MarkStream {
    shared: Arc<LslShared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct LslShared {
    lsl: Lsl,
    marks: Sender<LslMark>,
    dropped: AtomicU64,
    received: AtomicBool,
    ends: AtomicBool,
}

/// An event with its LSL time, s.
#[derive(Clone, Debug, PartialEq)]
struct LslMark {
    at_s: f64,
    what: String,
}

impl LslShared {
    fn mark(&self, at_s: f64, what: String) {
        if self.marks.try_send(LslMark { at_s, what }).is_err() {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }
}

impl MarkStream {
    /// Creates the stream in this network. `library` is the library's file; by default, the system's library is used.
    /// `program` and `machine` describe the source of the markers.
    ///
    /// # Errors
    /// [`LslError`] if there is no library, or it cannot create a stream.
    pub fn start(library: Option<&Path>, program: &str, machine: &str) -> Result<Self, LslError> {
        let lsl = Lsl::open(library)?;
        let (marks, comes) = bounded(QUEUE);
        let received = AtomicBool::new(false);
        let ends = AtomicBool::new(false);
        let shared = Arc::new(LslShared { lsl, marks, dropped: AtomicU64::new(0), received, ends });
        let info = Info {
            name: STREAM,
            kind: STREAM_TYPE,
            source: &format!("nima-{machine}"),
            about: &[("manufacturer", program), ("clock", "ticks of the loop, mapped onto lsl_local_clock")],
        };
        // The stream exists when this returns; only its own thread uses it.
        let stream = lsl.stream(&info)?;
        let report = Arc::clone(&shared);
        let run = move || push(&stream, &comes, &report);
        let thread = Builder::new().name("lsl-marks".to_owned()).spawn(run);
        let thread = thread.map_err(|error| LslError::Stream { reason: error.to_string() })?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Returns whether a listener is connected.
    pub fn is_received(&self) -> bool {
        self.shared.received.load(Ordering::Relaxed)
    }

    /// Returns the number of dropped markers.
    pub fn dropped(&self) -> u64 {
        self.shared.dropped.load(Ordering::Relaxed)
    }

    /// Returns the audience for the recorder of the next session.
    pub fn audience(&self, about: MarkContext) -> Box<dyn Audience> {
        Box::new(SessionMarks::new(Arc::clone(&self.shared), about))
    }
}

/// Passes markers to the library until the stream ends.
fn push(stream: &library::LslStream, comes: &Receiver<LslMark>, shared: &LslShared) {
    loop {
        match comes.recv_timeout(LOOK_EVERY) {
            Ok(LslMark { at_s, what }) => stream.push(&what, at_s),
            Err(RecvTimeoutError::Timeout) if !shared.ends.load(Ordering::Acquire) => {}
            Err(_) => return,
        }
        shared.received.store(stream.is_received(), Ordering::Relaxed);
    }
}

impl Drop for MarkStream {
    fn drop(&mut self) {
        self.shared.ends.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

impl fmt::Debug for MarkStream {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Marker").field("shared", &self.shared).finish_non_exhaustive()
    }
}
