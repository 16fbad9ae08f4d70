//! Records a session: a thread of its own writes what passes the tap of a loop into a session file.
//!
//! The loop never waits for it. Whatever goes wrong, a full disk or a folder that is gone, is told at once by
//! [`Recorder::trouble`]; then the recording has ended, and what was written stays readable.

use std::{
    collections::BTreeMap,
    fs::File,
    io,
    path::{Path, PathBuf},
    sync::{
        Arc, OnceLock,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{Builder, JoinHandle},
    time::Duration,
};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};
use nima_machine::{
    rig::Side,
    runtime::{Entry, Passed, TapEnd},
    teleop::Origin,
};
use nima_recording::session::{ChannelId, Encoding, WriteError, Writer};

use crate::{
    journal::{End, JournalError, Start},
    kept::described,
    scribe::{Scribe, Written},
};

/// Topic of the journal.
pub const JOURNAL_TOPIC: &str = "nima/journal";
/// How its messages are encoded.
pub const JOURNAL_ENCODING: &str = "nima-journal";

/// The file is synchronised with the disk this often.
const SYNC_EVERY: Duration = Duration::from_secs(1);
/// How long the thread waits for the loop before it looks whether it is to end.
const LOOK_EVERY: Duration = Duration::from_millis(100);
/// After so many blocks of the journal the chunk is closed: 0.4 s at 1 kHz, which is what a kill can cost.
const BLOCKS_PER_CHUNK: u32 = 2;

/// What is told of a session beside what happened in it.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// Name and version of the program.
    pub program: String,
    /// When the loop's clock began, ns since 1970 (UTC).
    pub started_ns: u64,
    /// Tables of keys and values, by name.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// Whole files.
    pub files: Vec<Attached>,
}

/// A file inside a session file.
#[derive(Clone, Debug)]
pub struct Attached {
    /// Its name.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// Its content.
    pub data: Vec<u8>,
}

/// Why a recording could not begin, or ended.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Something of the loop cannot be written.
    #[error("the session cannot be recorded")]
    Journal(#[from] JournalError),
    /// The operating system gives no thread, or does not write to the disk.
    #[error("cannot record session {path}: {source}; check the disk or record to another one")]
    System {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

/// Figures of a recording so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Ticks that were taken.
    pub ticks: u64,
    /// Entries that the loop dropped, because this thread came too late.
    pub lost: u64,
    /// Bytes in the file.
    pub bytes: u64,
}

#[derive(Debug, Default)]
struct Shared {
    ticks: AtomicU64,
    lost: AtomicU64,
    bytes: AtomicU64,
    ends: AtomicBool,
    trouble: OnceLock<RecordError>,
}

/// A recording that is going on. Dropping it ends it as [`Recorder::finish`] does.
#[derive(Debug)]
pub struct Recorder {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Recorder {
    /// Begins a new session file with what passes this tap; `origin` is what its loop is made of.
    ///
    /// # Errors
    /// [`RecordError`] if the file cannot be created or its beginning cannot be written.
    pub fn start(path: &Path, about: About, origin: Origin, tap: TapEnd) -> Result<Self, RecordError> {
        let failed = |source| RecordError::System { path: path.to_owned(), source };
        let mut file = Session::create(path, about, origin)?;
        let shared = Arc::<Shared>::default();
        shared.bytes.store(file.writer.bytes().1, Ordering::Relaxed);
        let (told, sync) =
            (Arc::clone(&shared), Sync::start(path, file.writer.sync_handle().map_err(failed)?, &shared)?);
        let run = move || {
            let ran = file.run(&tap, &told);
            if let Err(error) = ran.and_then(|()| file.close(&tap, &told)) {
                told.trouble.set(error).ok();
                drain(&tap, &told);
            }
            drop(sync);
        };
        let thread = Builder::new().name("recorder".to_owned()).spawn(run).map_err(failed)?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Figures so far.
    pub fn progress(&self) -> Progress {
        let Shared { ticks, lost, bytes, .. } = &*self.shared;
        let [ticks, lost, bytes] = [ticks, lost, bytes].map(|count| count.load(Ordering::Relaxed));
        Progress { ticks, lost, bytes }
    }

    /// Why the recording has ended, if it has ended by itself.
    pub fn trouble(&self) -> Option<&RecordError> {
        self.shared.trouble.get()
    }

    /// Ends the recording, and the file. To be called when the loop has ended; what a loop that runs on does from now on is
    /// not recorded.
    ///
    /// # Errors
    /// Why the recording ended before.
    pub fn finish(mut self) -> Result<Progress, RecordError> {
        self.join();
        let progress = self.progress();
        match Arc::get_mut(&mut self.shared).and_then(|shared| shared.trouble.take()) {
            Some(trouble) => Err(trouble),
            None => Ok(progress),
        }
    }

    fn join(&mut self) {
        self.shared.ends.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.join();
    }
}

/// Goes on emptying the tap of a loop whose recording has ended, so that its boxes go round.
fn drain(tap: &TapEnd, shared: &Shared) {
    loop {
        match next(tap, shared) {
            Next::Entry(Entry { passed: Passed::Stepped(stepped), .. }) => tap.give_back(stepped),
            Next::Entry(_) | Next::Nothing => {}
            Next::End => return,
        }
    }
}

/// What comes out of the tap.
enum Next {
    Entry(Entry),
    /// The loop rests.
    Nothing,
    End,
}

fn next(tap: &TapEnd, shared: &Shared) -> Next {
    if shared.ends.load(Ordering::Acquire) {
        return tap.entries.try_recv().map_or(Next::End, Next::Entry);
    }
    match tap.entries.recv_timeout(LOOK_EVERY) {
        Ok(entry) => Next::Entry(entry),
        Err(RecvTimeoutError::Timeout) => Next::Nothing,
        Err(RecvTimeoutError::Disconnected) => Next::End,
    }
}

/// The file and what is written into it.
struct Session {
    writer: Writer,
    journal: ChannelId,
    scribe: Option<Scribe>,
    started_ns: u64,
    blocks: u32,
}

impl Session {
    fn create(path: &Path, about: About, origin: Origin) -> Result<Self, RecordError> {
        let About { program, started_ns, mut metadata, files } = about;
        for (side, known) in Side::ALL.into_iter().zip(&origin.calibrations) {
            if let Some(known) = known {
                metadata.insert(format!("calibrations {}", side.word()), described(known));
            }
        }
        let (scribe, first) = Scribe::new(&Start { program: program.clone(), origin })?;
        let mut writer = Writer::create(path, &program)?;
        for (name, entries) in &metadata {
            writer.metadata(name, entries)?;
        }
        for Attached { name, media_type, data } in &files {
            writer.attachment(name, media_type, started_ns, data)?;
        }
        let none = String::new;
        let encoding = Encoding {
            schema: none(),
            schema_encoding: none(),
            schema_data: Vec::new(),
            message_encoding: JOURNAL_ENCODING.to_owned(),
        };
        let journal = writer.channel(JOURNAL_TOPIC, encoding)?;
        let mut this = Self { writer, journal, scribe: Some(scribe), started_ns, blocks: 0 };
        this.write(&first)?;
        this.writer.flush()?;
        Ok(this)
    }

    fn run(&mut self, tap: &TapEnd, shared: &Shared) -> Result<(), RecordError> {
        loop {
            match next(tap, shared) {
                Next::Entry(entry) => self.take(entry, tap)?,
                Next::Nothing => self.writer.flush()?,
                Next::End => return Ok(()),
            }
            self.tell(shared);
        }
    }

    fn tell(&self, shared: &Shared) {
        if let Some(scribe) = &self.scribe {
            shared.ticks.store(scribe.ticks(), Ordering::Relaxed);
            shared.lost.store(scribe.lost(), Ordering::Relaxed);
        }
        shared.bytes.store(self.writer.bytes().1, Ordering::Relaxed);
    }

    fn take(&mut self, entry: Entry, tap: &TapEnd) -> Result<(), RecordError> {
        let Some(mut scribe) = self.scribe.take() else { return Ok(()) };
        let taken = scribe.take(entry, tap, |_, _| Ok::<_, RecordError>(()), |written| self.write(&written));
        self.scribe = Some(scribe);
        taken
    }

    fn write(&mut self, Written { t_s, bytes }: &Written) -> Result<(), RecordError> {
        self.writer.message(self.journal, self.log_time_ns(*t_s), bytes)?;
        self.blocks += 1;
        if self.blocks.is_multiple_of(BLOCKS_PER_CHUNK) {
            self.writer.flush()?;
        }
        Ok(())
    }

    fn log_time_ns(&self, t_s: f64) -> u64 {
        self.started_ns + (t_s.max(0.0) * 1e9).round() as u64
    }

    fn close(mut self, tap: &TapEnd, shared: &Shared) -> Result<(), RecordError> {
        if let Some(scribe) = self.scribe.take() {
            let End { ticks, lost } = scribe.end(tap, |written| self.write(&written))?;
            shared.ticks.store(ticks, Ordering::Relaxed);
            shared.lost.store(lost, Ordering::Relaxed);
        }
        self.writer.flush()?;
        shared.bytes.store(self.writer.bytes().1, Ordering::Relaxed);
        self.writer.finish()?;
        Ok(())
    }
}

/// The thread that writes the file to the disk each second, so that the loss of power costs no more.
struct Sync {
    ends: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Sync {
    fn start(path: &Path, file: File, shared: &Arc<Shared>) -> Result<Self, RecordError> {
        let (ends, asked) = bounded(1);
        let (path, told) = (path.to_owned(), Arc::clone(shared));
        let at = path.clone();
        let run = move || {
            if let Err(source) = sync(&file, &asked) {
                told.trouble.set(RecordError::System { path, source }).ok();
            }
        };
        let thread = Builder::new().name("recorder-sync".to_owned()).spawn(run);
        let thread = thread.map_err(|source| RecordError::System { path: at, source })?;
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
