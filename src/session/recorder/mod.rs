//! Records a session: a separate thread writes the entries of a loop's tap into a session file.
//!
//! The loop never waits for it. A failure, such as a full disk or a deleted folder, is reported at once
//! ([`SessionRecorder::trouble`]), and everything written before stays readable. [`RecordingProgress`] shows if the disk is too slow.

mod session_file;
mod shared;
mod sync;
mod utc_clock;

use std::{
    collections::BTreeMap,
    io,
    path::PathBuf,
    sync::{Arc, atomic::Ordering},
    thread::{Builder, JoinHandle},
    time::{Duration, Instant},
};

use crossbeam_channel::{Receiver, Sender, unbounded};
use nima_machine::{
    rig::Side,
    runtime::{TapEnd, TapEntry, TapItem, TapPayload},
    teleop::{Calibrations, LoopOrigin},
};
use nima_recording::session::WriteError;
use tracing::{error, warn};

pub use self::shared::RecordingProgress;
pub(crate) use self::sync::Sync;
use self::{
    session_file::{SessionFile, log_time_ns},
    shared::RecorderShared,
    utc_clock::UtcClock,
};
use crate::{
    calibration_metadata::described,
    images::{ImageLoopClock, RecordedImageSource},
    journal::{JournalEnd, JournalError, JournalStart},
    journal_writer::{JournalWriter, Pages as _},
    objects::ObjectSource,
    sinks::{Destination, SessionSinks},
    topics::SentenceChannel,
};

/// Topic of the journal.
pub const JOURNAL_TOPIC: &str = "nima/journal";
/// Encoding of its messages.
pub const JOURNAL_ENCODING: &str = "nima-journal";

/// Time for which the thread waits for the loop before it checks whether it must end. A tenth of a second is hardly
/// noticed when a session is ended, and an idle loop costs next to nothing.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// Information about a session, recorded in addition to its events.
#[derive(Clone, Debug)]
pub struct RecordingInfo {
    pub program: String,
    /// Start of the loop's clock, ns since 1970 (UTC).
    pub started_ns: u64,
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    pub files: Vec<AttachedFile>,
    /// Texts for the events of the log.
    pub words: SentenceChannel,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AttachedFile {
    pub name: String,
    pub media_type: String,
    pub data: Vec<u8>,
}

#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("cannot record the session")]
    Journal(#[from] JournalError),
    #[error("cannot start the recording thread: {0}; end other programs, then try again")]
    Thread(#[source] io::Error),
    /// The operating system does not write to the disk.
    #[error("cannot record session {path}: {source}; check the disk or record to another one")]
    System { path: PathBuf, source: io::Error },
}

/// A log entry from a screen, which does not pass through the loop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogNote {
    /// Kind of the entry.
    pub kind: NoteKind,
    /// Whether it is a warning; otherwise it is information.
    pub warns: bool,
    /// English text.
    pub words: String,
    /// Whether the text may contain a name that a person gave.
    pub names: bool,
}

/// Kind of a note.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoteKind {
    /// A moment that the operator marked.
    Mark,
    /// An alarm of the screen.
    Alarm,
}

/// An additional source of data for a recording.
#[derive(Debug)]
enum RecorderSource {
    Objects(Box<dyn ObjectSource>),
    Pictures(Box<dyn RecordedImageSource>),
}

/// A running recording. Dropping it ends it like [`SessionRecorder::finish`].
#[derive(Debug)]
pub struct SessionRecorder {
    shared: Arc<RecorderShared>,
    notes: Sender<(f64, LogNote)>,
    sources: Sender<RecorderSource>,
    thread: Option<JoinHandle<()>>,
}

impl SessionRecorder {
    /// Begins a session with the entries of this tap; `origin` describes the construction of its loop.
    ///
    /// # Errors
    /// [`RecordError`] if the file cannot be created or its beginning cannot be written.
    pub fn start(
        to: Destination<'_>,
        about: RecordingInfo,
        origin: LoopOrigin,
        tap: TapEnd,
    ) -> Result<Self, RecordError> {
        let (notes, noted) = unbounded();
        let (sources, watched) = unbounded();
        let mut session = OpenSession::create(to, about, origin, noted, watched)?;
        let shared = Arc::new(RecorderShared::new());
        shared.bytes.store(session.file.out.bytes(), Ordering::Relaxed);
        let report = Arc::clone(&shared);
        let run = move || {
            let ran = session.run(&tap, &report);
            if let Err(error) = ran.and_then(|()| session.close(&tap, &report)) {
                error!(error = &error as &dyn std::error::Error, "the recording has ended by itself");
                report.trouble.set(error).ok();
            }
            drain(&tap, &report);
        };
        let thread = Builder::new().name("recorder".to_owned()).spawn(run).map_err(RecordError::Thread)?;
        Ok(Self { shared, notes, sources, thread: Some(thread) })
    }

    /// Also records the objects of this source. Call it before the loop starts, so that nothing is missing.
    pub fn watch(&self, source: Box<dyn ObjectSource>) {
        // A recording that has ended by itself accepts no more sources.
        self.sources.send(RecorderSource::Objects(source)).ok();
    }

    /// Also records the images of this source from now on.
    pub fn film(&self, source: Box<dyn RecordedImageSource>) {
        // A recording that has ended by itself accepts no more sources.
        self.sources.send(RecorderSource::Pictures(source)).ok();
    }

    /// Adds a line to the log at this time of the loop (s), or at its last tick if that is earlier.
    pub fn note(&self, t_s: f64, note: LogNote) {
        // A recording that has ended by itself accepts no more notes.
        self.notes.send((t_s, note)).ok();
    }

    /// Returns the statistics so far.
    pub fn progress(&self) -> RecordingProgress {
        self.shared.progress()
    }

    /// Returns why the recording has ended by itself, if it has.
    pub fn trouble(&self) -> Option<&RecordError> {
        self.shared.trouble.get()
    }

    /// Ends the recording and the file. Call it when the loop has ended; later ticks of a running loop are not
    /// recorded.
    ///
    /// # Errors
    /// The reason why the recording ended by itself before.
    pub fn finish(mut self) -> Result<RecordingProgress, RecordError> {
        self.end();
        let progress = self.progress();
        match Arc::get_mut(&mut self.shared).and_then(|shared| shared.trouble.take()) {
            Some(trouble) => Err(trouble),
            None => Ok(progress),
        }
    }

    /// Ends the recording like [`SessionRecorder::finish`]; its status can still be queried.
    pub fn end(&mut self) {
        self.shared.ends.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

impl Drop for SessionRecorder {
    fn drop(&mut self) {
        self.end();
    }
}

/// Keeps emptying the tap of a loop whose recording has ended, so that its buffers circulate.
fn drain(tap: &TapEnd, shared: &RecorderShared) {
    loop {
        match next(tap, shared) {
            TapItem::Entry(TapEntry { passed: TapPayload::Stepped(stepped), .. }) => tap.give_back(stepped),
            TapItem::Entry(_) | TapItem::Nothing => {}
            TapItem::End => return,
        }
    }
}

/// Reports a failure of the file.
fn report(out: &mut SessionSinks, shared: &RecorderShared) {
    if let Some(why) = out.trouble() {
        error!(error = &why as &dyn std::error::Error, "the file has ended by itself");
        shared.trouble.set(why).ok();
    }
}

fn next(tap: &TapEnd, shared: &RecorderShared) -> TapItem {
    shared.looked();
    if shared.ends.load(Ordering::Acquire) {
        return tap.entries.try_recv().map_or(TapItem::End, TapItem::Entry);
    }
    tap.next(LOOK_EVERY)
}

/// The file and its writer.
struct OpenSession {
    scribe: JournalWriter,
    file: SessionFile,
    noted: Receiver<(f64, LogNote)>,
    sources: Receiver<RecorderSource>,
    /// The note whose time has not been reached yet.
    waiting: Option<(f64, LogNote)>,
    clock: ImageLoopClock,
    utc: UtcClock,
}

impl OpenSession {
    fn create(
        to: Destination<'_>,
        about: RecordingInfo,
        origin: LoopOrigin,
        noted: Receiver<(f64, LogNote)>,
        sources: Receiver<RecorderSource>,
    ) -> Result<Self, RecordError> {
        let sides = origin.calibrations.each_ref().map(Option::is_some);
        let of = |(side, known): (Side, &Option<Calibrations>)| Some((side, described(known.as_ref()?)));
        let known: Vec<_> = Side::ALL.into_iter().zip(&origin.calibrations).filter_map(of).collect();
        let devices = origin.rig.device_names();
        let (scribe, first) = JournalWriter::new(&JournalStart { program: about.program.clone(), origin })?;
        let mut file = SessionFile::create(to, about, &known, sides, devices)?;
        file.write(&first)?;
        // A file without a loop's origin cannot be replayed, so the beginning must be on the disk before the first
        // tick.
        file.out.flush()?;
        Ok(Self {
            scribe,
            file,
            noted,
            sources,
            waiting: None,
            clock: ImageLoopClock::default(),
            utc: UtcClock::default(),
        })
    }

    fn run(&mut self, tap: &TapEnd, shared: &RecorderShared) -> Result<(), RecordError> {
        loop {
            let next = next(tap, shared);
            // Sources added before the loop's start must be present at its first tick.
            while let Ok(source) = self.sources.try_recv() {
                match source {
                    RecorderSource::Objects(source) => self.file.topics.watch(&mut self.file.out, source)?,
                    RecorderSource::Pictures(source) => self.file.topics.film(source),
                }
            }
            match next {
                TapItem::Entry(entry) => {
                    self.follow_clock(tap)?;
                    let before = self.scribe.ticks();
                    self.scribe.take(entry, tap, &mut self.file)?;
                    if self.scribe.ticks() > before {
                        self.clock.note(self.scribe.t_s(), Instant::now());
                        self.images(shared)?;
                    }
                }
                // The loop is idle, so write all pending data without delay.
                TapItem::Nothing => {
                    self.notes(f64::INFINITY)?;
                    self.file.out.flush()?;
                }
                TapItem::End => return self.notes(f64::INFINITY),
            }
            self.notes(self.scribe.t_s())?;
            self.file.out.look();
            report(&mut self.file.out, shared);
            // Neither file nor viewer is left, so recording further would only use the processor.
            if !self.file.out.is_received() {
                return Ok(());
            }
            shared.ticks.store(self.scribe.ticks(), Ordering::Relaxed);
            if self.scribe.lost() > 0 && shared.lost.swap(self.scribe.lost(), Ordering::Relaxed) == 0 {
                warn!("entries are lost: the disk is slower than the loop");
            }
            shared.bytes.store(self.file.out.bytes(), Ordering::Relaxed);
        }
    }

    /// Relates the times of the loop to UTC. The times of the messages refer to the relation at the start of the loop, so
    /// that they are equally spaced; viewers also get the current one.
    fn follow_clock(&mut self, tap: &TapEnd) -> Result<(), RecordError> {
        let Some(change) = self.utc.look(Instant::now(), || tap.utc_start_ns()) else { return Ok(()) };
        if change.is_first {
            self.file.started(change.started_ns)?;
        }
        self.file.out.clock(change.started_ns);
        if let Some(jump_s) = change.jump_s {
            let words = format!("the clock of this computer was set by {:+.1} ms", 1e3 * jump_s);
            let note = LogNote { kind: NoteKind::Alarm, warns: true, words, names: false };
            let time_ns = self.file.log_time_ns(self.scribe.t_s());
            self.file.topics.note(&mut self.file.out, time_ns, note)?;
        }
        Ok(())
    }

    /// Writes the images up to the last tick.
    fn images(&mut self, shared: &RecorderShared) -> Result<(), RecordError> {
        let clock = &self.clock;
        let started_ns = self.file.started_ns;
        let [written, dropped] = self.file.topics.images(
            &mut self.file.out,
            self.scribe.t_s(),
            |taken| clock.at(taken.arrived),
            |t_s| log_time_ns(started_ns, t_s),
        )?;
        shared.images.store(written, Ordering::Relaxed);
        shared.images_dropped.store(dropped, Ordering::Relaxed);
        Ok(())
    }

    /// Writes the notes up to this time (s) of the loop, but none after its last tick: the last message must be the end
    /// of the journal.
    fn notes(&mut self, until_s: f64) -> Result<(), RecordError> {
        while let Some((t_s, note)) = self.waiting.take().or_else(|| self.noted.try_recv().ok()) {
            if t_s > until_s {
                self.waiting = Some((t_s, note));
                return Ok(());
            }
            let time_ns = self.file.log_time_ns(t_s.min(self.scribe.t_s()));
            self.file.topics.note(&mut self.file.out, time_ns, note)?;
        }
        Ok(())
    }

    fn close(self, tap: &TapEnd, shared: &RecorderShared) -> Result<(), RecordError> {
        let Self { scribe, mut file, .. } = self;
        let JournalEnd { ticks, lost } = scribe.end(tap, &mut file)?;
        file.out.flush()?;
        report(&mut file.out, shared);
        shared.ticks.store(ticks, Ordering::Relaxed);
        shared.lost.store(lost, Ordering::Relaxed);
        shared.bytes.store(file.out.bytes(), Ordering::Relaxed);
        file.out.finish()?;
        Ok(())
    }
}
