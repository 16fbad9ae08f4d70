//! The thread that reads a session and produces its moments.

use std::{
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel},
    },
    thread,
    time::{Duration, Instant},
};

use nima_machine::{config::EndoscopeConfig, rig::DeviceName};
use nima_recording::csv::Signals;
use nima_screen::live::LiveState;
use nima_session::completeness::CompletenessCheck;
use nima_words::language;

use super::{
    feed::TickFrame,
    overview::{Overview, OverviewTables},
    playback_file::PlaybackFile,
    session_index::{Chase, PlaybackPosition, SessionIndex},
};

/// Interval of progress reports.
const REPORT_EVERY: Duration = Duration::from_millis(60);
/// The search for missing data leaves the thread to requests of the window after this time.
const CHECK_TIME: Duration = Duration::from_millis(20);

/// A request of the window.
#[derive(Clone, Copy, Debug)]
enum WorkerRequest {
    /// This time of the session, s.
    Show(f64),
    /// Continue the moment on the screen up to this time, s.
    GoOn(f64),
}

/// Facts that a session reports when it is opened.
#[derive(Debug)]
pub(super) struct SessionOverview {
    pub(super) begin_ns: u64,
    pub(super) end_s: f64,
    pub(super) calibrations: OverviewTables,
    /// By their indices in the loop's events.
    pub(super) devices: Vec<DeviceName>,
    /// The endoscope whose images are in it.
    pub(super) endoscope: Option<EndoscopeConfig>,
    /// Of another program's recording.
    pub(super) signals: Option<Arc<Signals>>,
}

/// Extent of the replay of a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WorkerExtent {
    /// Forces, positions and states; the rest is at most 0.1 s older, if the session was read that far.
    Plotted,
    /// Every value, with the preceding seconds.
    Whole,
}

/// A message of the thread.
#[derive(Debug)]
pub(super) enum WorkerAnswer {
    Opened(Box<SessionOverview>),
    /// The session cannot be shown, for this reason.
    Refused(String),
    /// More of the session was read.
    Read(Overview),
    /// The rest is available only from the recorded plots, for this reason.
    Limited(String),
    /// The session or the other recording lacks this, one line each.
    Lacks(Vec<String>),
    Shown(Box<LiveState>, WorkerExtent, f64),
    /// The moment, continued by these ticks; `None` at the end of the session.
    WentOn(Option<Vec<TickFrame>>),
}

/// The window's end of the thread; dropping it ends the thread.
#[derive(Debug)]
pub(super) struct PastWorker {
    /// This computer drives a machine.
    gently: Arc<AtomicBool>,
    wishes: Sender<WorkerRequest>,
    answers: Receiver<WorkerAnswer>,
}

impl PastWorker {
    /// Opens a session, or the signals of another recording; `wake` is called whenever there is an answer.
    pub(super) fn start(path: &Path, signals: Option<Arc<Signals>>, wake: impl Fn() + Send + 'static) -> Self {
        let (wishes, wanted) = channel();
        let (channel_end, answers) = channel();
        let path = path.to_path_buf();
        let gently = Arc::<AtomicBool>::default();
        let of_thread = Arc::clone(&gently);
        let work = move || {
            let sender = AnswerSender { answers: channel_end, wake: Box::new(wake), gently: of_thread };
            if let Err(why) = run(&path, signals, &wanted, &sender) {
                sender.notify(WorkerAnswer::Refused(why));
            }
        };
        // If no thread can be created, the answers end at once.
        thread::Builder::new().name("past".to_owned()).spawn(language::carried(work)).ok();
        Self { gently, wishes, answers }
    }

    /// Shows this time, s. Only the newest request counts.
    pub(super) fn show(&self, t_s: f64) {
        self.wishes.send(WorkerRequest::Show(t_s)).ok();
    }

    /// Continues the moment up to this time, s.
    pub(super) fn go_on(&self, to_s: f64) {
        self.wishes.send(WorkerRequest::GoOn(to_s)).ok();
    }

    /// Sets whether this computer drives a machine, to which the first reading then leaves half of the time.
    pub(super) fn go_gently(&self, gently: bool) {
        self.gently.store(gently, Ordering::Relaxed);
    }

    pub(super) fn answer(&self) -> Option<WorkerAnswer> {
        self.answers.try_recv().ok()
    }
}

/// The thread's end of the answers.
struct AnswerSender {
    answers: Sender<WorkerAnswer>,
    wake: Box<dyn Fn() + Send>,
    gently: Arc<AtomicBool>,
}

impl AnswerSender {
    fn notify(&self, answer: WorkerAnswer) {
        self.answers.send(answer).ok();
        (self.wake)();
    }
}

fn run(
    path: &Path,
    signals: Option<Arc<Signals>>,
    wanted: &Receiver<WorkerRequest>,
    sender: &AnswerSender,
) -> Result<(), String> {
    let file = PlaybackFile::open(path, signals)?;
    let opened = SessionOverview {
        begin_ns: file.begin_ns,
        end_s: file.end_s,
        calibrations: file.calibrations(),
        devices: file.devices(),
        endoscope: file.endoscope(),
        signals: file.signals().cloned(),
    };
    sender.notify(WorkerAnswer::Opened(Box::new(opened)));
    if let Some(signals) = file.signals().filter(|signals| !signals.notes.is_empty()) {
        sender.notify(WorkerAnswer::Lacks(signals.notes.clone()));
    }
    let mut reading = FirstReading {
        part: Overview::default(),
        reported_at: Instant::now(),
        limited: false,
        reads: true,
        check: file.session().map(|recorded| CompletenessCheck::new(recorded.reader())),
        took: Duration::ZERO,
    };
    let mut film = SessionIndex::new(&file)?;
    let mut shown = DisplayedMoment::default();
    // Signals are in memory: the first moment shown already has all its traces.
    while reading.goes_on() && file.signals().is_some() {
        reading.go_on(&mut film, sender);
    }
    loop {
        let patience = match (&shown.chase, reading.goes_on()) {
            (Some(_), _) => Some(Duration::ZERO),
            (None, true) => Some(reading.took),
            (None, false) => None,
        };
        let wish = match newest(wanted, patience) {
            Ok(wish) => wish,
            Err(SessionClosed) => return Ok(()),
        };
        match wish {
            Some(WorkerRequest::Show(t_s)) => shown.show(&film, t_s.clamp(0.0, file.end_s), sender),
            Some(WorkerRequest::GoOn(to_s)) => shown.go_on(&film, to_s, sender),
            None if shown.chase.is_some() => shown.chase_on(&film, sender),
            None => {
                reading.go_on(&mut film, sender);
                shown.again(&film);
            }
        }
    }
}

/// The window has closed the session.
struct SessionClosed;

/// Returns the newest request; waits for one for `patience`, or without limit if there is no other work.
fn newest(
    wanted: &Receiver<WorkerRequest>,
    patience: Option<Duration>,
) -> Result<Option<WorkerRequest>, SessionClosed> {
    let mut newest = match patience.map(|patience| wanted.recv_timeout(patience)) {
        None => Some(wanted.recv().map_err(|_| SessionClosed)?),
        Some(Ok(wish)) => Some(wish),
        Some(Err(RecvTimeoutError::Timeout)) => None,
        Some(Err(RecvTimeoutError::Disconnected)) => return Err(SessionClosed),
    };
    loop {
        match wanted.try_recv() {
            Ok(wish) => newest = Some(wish),
            Err(TryRecvError::Empty) => return Ok(newest),
            Err(TryRecvError::Disconnected) => return Err(SessionClosed),
        }
    }
}

struct FirstReading<'a> {
    part: Overview,
    reported_at: Instant,
    limited: bool,
    reads: bool,
    /// The search for missing data, after the reading; `None` when it has ended.
    check: Option<CompletenessCheck<'a>>,
    /// Duration of the last step, if this computer drives a machine: an equally long pause follows.
    took: Duration,
}

impl FirstReading<'_> {
    const fn goes_on(&self) -> bool {
        self.reads || self.check.is_some()
    }

    fn go_on(&mut self, film: &mut SessionIndex<'_>, sender: &AnswerSender) {
        let began = Instant::now();
        if self.reads {
            self.read(film);
        } else {
            self.look_for_missing(sender);
        }
        self.took = if sender.gently.load(Ordering::Relaxed) { began.elapsed() } else { Duration::ZERO };
        if let Some(why) = film.why.as_ref().filter(|_| !self.limited) {
            sender.notify(WorkerAnswer::Limited(why.clone()));
            self.limited = true;
        }
        if !self.reads || self.reported_at.elapsed() > REPORT_EVERY {
            self.part.read_s = film.read_s();
            sender.notify(WorkerAnswer::Read(std::mem::take(&mut self.part)));
            self.reported_at = Instant::now();
        }
    }

    fn read(&mut self, film: &mut SessionIndex<'_>) {
        self.reads = film.read(|frame| self.part.take(frame));
        self.part.notes.extend(film.notes());
    }

    fn look_for_missing(&mut self, sender: &AnswerSender) {
        let began = Instant::now();
        let Some(check) = &mut self.check else { return };
        while check.step() {
            if began.elapsed() > CHECK_TIME {
                return;
            }
        }
        let missing = self.check.take().map(CompletenessCheck::finish).unwrap_or_default();
        if !missing.is_empty() {
            sender.notify(WorkerAnswer::Lacks(missing));
        }
    }
}

/// The moment on the screen, and the one in preparation.
#[derive(Default)]
struct DisplayedMoment {
    view: Option<PlaybackPosition>,
    chase: Option<(Chase, f64)>,
    /// A time that was shown before it had been read, s.
    early_s: Option<f64>,
}

impl DisplayedMoment {
    fn show(&mut self, film: &SessionIndex<'_>, t_s: f64, sender: &AnswerSender) {
        let live = film.at_once(t_s);
        sender.notify(WorkerAnswer::Shown(Box::new(live), WorkerExtent::Plotted, t_s));
        self.view = None;
        self.chase = Some((film.chase(t_s), t_s));
        self.early_s = None;
    }

    fn chase_on(&mut self, film: &SessionIndex<'_>, sender: &AnswerSender) {
        let Some((mut chase, t_s)) = self.chase.take() else { return };
        if !chase.go_on(film.file) {
            self.chase = Some((chase, t_s));
            return;
        }
        let (live, view) = chase.end(film.file);
        let extent = if view.is_exact() { WorkerExtent::Whole } else { WorkerExtent::Plotted };
        self.early_s = (extent == WorkerExtent::Plotted).then_some(t_s);
        self.view = Some(view);
        sender.notify(WorkerAnswer::Shown(Box::new(live), extent, t_s));
    }

    /// Shows again a moment that was shown before it was read, now replayed.
    fn again(&mut self, film: &SessionIndex<'_>) {
        if let Some(t_s) = self.early_s.take_if(|t_s| film.is_exact(*t_s)) {
            self.chase = Some((film.chase(t_s), t_s));
        }
    }

    fn go_on(&mut self, film: &SessionIndex<'_>, to_s: f64, sender: &AnswerSender) {
        if let Some(view) = &mut self.view {
            self.early_s = None;
            sender.notify(WorkerAnswer::WentOn(view.go_on(film.file, to_s)));
        }
    }
}
