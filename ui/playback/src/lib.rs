//! Playback: a recorded session at any moment, in the same views as the machine.
//!
//! The views get a separate state ([`LiveState`]) from the session, and an outbox that is never sent: no control on the screen
//! acts on the machine until the operator returns to it.
// These macros panic if stderr or stdout is closed.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

mod bar;
mod compare;
mod feed;
mod job;
pub mod list;
mod list_row;
mod overview;
mod playback_file;
mod session_index;
mod signals_view;
#[cfg(test)]
mod tests;
mod worker;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use egui::Context;
use nima_machine::rig::{DeviceName, Side};
use nima_panels::{roles::Panels, tiles::PanelTiles};
use nima_recording::csv::Signals;
use nima_screen::{live::LiveState, outbox::Outbox, scene3d::SceneView};
use nima_wizards::active_calibrations::ActiveCalibrations;
use nima_words::{report_text::side_word, text};

use self::{
    job::SessionJob,
    overview::{Overview, OverviewTables},
    worker::{PastWorker, SessionOverview, WorkerAnswer, WorkerExtent},
};

pub use bar::{FRAME, bar_ui, head_ui};
pub use compare::both_ui;
pub use signals_view::signals_ui;

/// Playback speeds.
const SPEEDS: [f64; 6] = [0.1, 0.25, 0.5, 1.0, 2.0, 4.0];
/// Maximum time by which the screen may be ahead of the ticks that it waits for, or one frame, s.
const AHEAD_S: f64 = 0.3;
/// Maximum playback time per frame, s: longer pauses between frames are not played.
const PAUSE_S: f64 = 1.0;
/// Figures are updated at this interval of session time, s.
const SETTLED_S: f64 = 0.02;

#[derive(Debug)]
pub struct Playback {
    pub path: PathBuf,
    /// The signals of another program's recording; `None`: a session, or not open yet.
    signals: Option<Arc<Signals>>,
    worker: PastWorker,
    about: Option<OpenSessionInfo>,
    /// State for the views; `None` until the first moment is loaded.
    pub live: Option<Box<LiveState>>,
    pub panels: Panels,
    pub active: ActiveCalibrations,
    /// Receives the commands of the views; they are never sent.
    pub outbox: Outbox,
    overview: Overview,
    calibrations: OverviewTables,
    devices: Vec<DeviceName>,
    extent: WorkerExtent,
    /// Requested time on the screen, s.
    wanted_s: f64,
    /// No time was requested since it was opened.
    is_unasked: bool,
    play: Play,
    stretch_s: [Option<f64>; 2],
    /// Another session on the same clock: equal times since the start of each.
    pub beside: Option<Box<Self>>,
    /// The operator requests a session for comparison.
    pub wants_beside: bool,
    /// The list to choose it from is on the screen.
    pub is_choosing: bool,
    job: Option<SessionJob>,
    report: OperatorLines,
    ctx: Context,
}

/// Facts of an open session.
#[derive(Clone, Copy, Debug)]
struct OpenSessionInfo {
    begin_ns: u64,
    end_s: f64,
}

#[derive(Debug)]
struct Play {
    runs: bool,
    speed: f64,
    /// Session time since the last update of the figures, s.
    unsettled_s: f64,
}

/// Messages for the operator.
#[derive(Debug, Default)]
struct OperatorLines {
    /// Reason why the session cannot be shown.
    refused: Option<String>,
    /// Reason why a part is available only from the recorded plots.
    limited: Option<String>,
    /// Missing data of the session, one line each.
    lacks: Vec<String>,
    /// Result of the last report or excerpt.
    job: Option<String>,
}

impl OperatorLines {
    /// Returns what is wrong with the session, the missing data first.
    fn trouble(&self) -> Option<String> {
        let lacks = self.lacks.iter().map(|line| text::playback::lacks(line));
        let all: Vec<String> = lacks.chain(self.limited.clone()).collect();
        (!all.is_empty()).then(|| all.join("\n"))
    }
}

impl Playback {
    /// Opens a session at its start, or another program's recording at its end, so that all of it can be seen; `scene` draws
    /// the operating field.
    pub fn open(path: &Path, ctx: &Context, scene: SceneView) -> Self {
        Self::open_any(path, None, ctx, scene)
    }

    /// Shows these signals of another program's recording.
    pub fn open_signals(path: &Path, signals: &Arc<Signals>, ctx: &Context) -> Self {
        Self::open_any(path, Some(Arc::clone(signals)), ctx, SceneView::default())
    }

    fn open_any(path: &Path, signals: Option<Arc<Signals>>, ctx: &Context, scene: SceneView) -> Self {
        let wakes = ctx.clone();
        let worker = PastWorker::start(path, signals.clone(), move || wakes.request_repaint());
        worker.show(0.0);
        Self {
            path: path.to_path_buf(),
            signals,
            worker,
            about: None,
            live: None,
            panels: Panels { scene, desk: PanelTiles::with_windows(), ..Panels::default() },
            active: ActiveCalibrations::of_past(Vec::new()),
            outbox: Outbox::default(),
            overview: Overview::default(),
            calibrations: OverviewTables::new(),
            devices: Vec::new(),
            extent: WorkerExtent::Plotted,
            wanted_s: 0.0,
            is_unasked: true,
            play: Play { runs: false, speed: 1.0, unsettled_s: 0.0 },
            stretch_s: [None; 2],
            beside: None,
            wants_beside: false,
            is_choosing: false,
            job: None,
            report: OperatorLines::default(),
            ctx: ctx.clone(),
        }
    }

    /// Receives answers about the session, and plays it by `dt_s`; `driven`: a machine is being driven at the same
    /// time.
    pub fn step(&mut self, dt_s: f64, driven: bool) {
        self.worker.go_gently(driven);
        while let Some(answer) = self.worker.answer() {
            self.take(answer);
        }
        if self.play.runs && self.live.is_some() {
            let step_s = dt_s.min(PAUSE_S) * self.play.speed;
            let max_s = self.shown_s() + step_s.max(AHEAD_S);
            self.wanted_s = (self.wanted_s + step_s).min(max_s);
            self.worker.go_on(self.wanted_s);
        }
        if let Some(beside) = &mut self.beside {
            beside.follow(self.play.runs.then_some(self.wanted_s), driven);
        }
        self.settle();
        if let Some((words, over)) = self.job.as_ref().map(SessionJob::message) {
            self.report.job = Some(words);
            if over {
                self.job = None;
            }
        }
    }

    /// Receives answers about a compared session, and continues up to this time, s.
    fn follow(&mut self, to_s: Option<f64>, driven: bool) {
        self.worker.go_gently(driven);
        while let Some(answer) = self.worker.answer() {
            self.take(answer);
        }
        self.settle();
        if let Some(to_s) = to_s {
            self.wanted_s = to_s.min(self.about.map_or(to_s, |about| about.end_s));
            self.worker.go_on(self.wanted_s);
        }
    }

    pub fn set_beside(&mut self, mut beside: Self) {
        beside.show(self.shown_s());
        self.beside = Some(Box::new(beside));
    }

    /// Updates calibrations and devices for the moment on the screen.
    fn settle(&mut self) {
        let t_s = self.shown_s();
        let line = |side: Side| {
            let later = self.overview.calibrations(side, t_s);
            let name = later.map_or_else(|| side.word().to_owned(), |(_, number)| number.to_string());
            let table = self.calibrations.get(&name)?;
            Some(text::playback::calibrations(side_word(side), table, later.map(|(since_s, _)| since_s)))
        };
        self.active = ActiveCalibrations::of_past(Side::ALL.into_iter().filter_map(line).collect());
        if let Some(live) = &mut self.live {
            let of = |(place, name): (usize, &DeviceName)| (*name, self.overview.standing(place, t_s));
            live.devices_then = self.devices.iter().enumerate().map(of).collect();
        }
    }

    fn take(&mut self, answer: WorkerAnswer) {
        match answer {
            WorkerAnswer::Opened(opened) => {
                let SessionOverview { begin_ns, end_s, calibrations, devices, endoscope, signals } = *opened;
                if let Some(endoscope) = endoscope {
                    self.panels.eyes.project(&self.path, endoscope, &self.ctx);
                }
                self.about = Some(OpenSessionInfo { begin_ns, end_s });
                self.calibrations = calibrations;
                self.devices = devices;
                if let Some(signals) = &signals {
                    signals_view::choose(signals, &mut self.panels.forces);
                }
                if (signals.is_some() && self.is_unasked) || self.wanted_s > end_s {
                    self.show(end_s);
                }
                self.signals = signals;
            }
            WorkerAnswer::Refused(why) => self.report.refused = Some(text::playback::refused(&why)),
            WorkerAnswer::Read(part) => self.overview.add(part),
            WorkerAnswer::Limited(why) => self.report.limited = Some(text::playback::limited(&why)),
            WorkerAnswer::Lacks(lines) => self.report.lacks = lines,
            // Ignore a moment that is no longer requested.
            WorkerAnswer::Shown(live, extent, t_s) if (t_s - self.wanted_s).abs() < 1e-9 => {
                self.extent = extent;
                self.live = Some(live);
            }
            WorkerAnswer::Shown(..) => {}
            WorkerAnswer::WentOn(None) => self.play.runs = false,
            WorkerAnswer::WentOn(Some(frames)) => {
                let Some(live) = &mut self.live else { return };
                let before_s = shown_s(live);
                for frame in frames {
                    live.replay(frame.events.iter(), &frame.ticks);
                    live.show_newer_objects(frame.objects);
                }
                self.play.unsettled_s += shown_s(live) - before_s;
                if self.play.unsettled_s >= SETTLED_S {
                    live.settle(std::mem::take(&mut self.play.unsettled_s));
                }
            }
        }
    }

    /// Shows this time, s, and pauses.
    pub fn show(&mut self, t_s: f64) {
        let end_s = self.about.map_or(f64::INFINITY, |about| about.end_s);
        self.play.runs = false;
        self.is_unasked = false;
        self.wanted_s = t_s.clamp(0.0, end_s);
        // Until the worker answers, the screen shows another moment.
        self.extent = WorkerExtent::Plotted;
        self.worker.show(self.wanted_s);
        if let Some(beside) = &mut self.beside {
            beside.show(t_s);
        }
    }

    /// Plays or pauses.
    pub fn toggle(&mut self) {
        self.play.runs = !self.play.runs && self.live.is_some();
        self.wanted_s = self.shown_s();
    }

    /// Returns the time on the screen, s.
    pub fn shown_s(&self) -> f64 {
        self.live.as_ref().map_or(self.wanted_s, |live| shown_s(live))
    }

    /// Returns whether the screen is about to change.
    pub const fn moves(&self) -> bool {
        self.play.runs || self.job.is_some()
    }

    /// Returns whether every value on the screen is replayed.
    pub fn is_whole(&self) -> bool {
        self.extent == WorkerExtent::Whole
    }

    /// Returns the fraction of the session that was read, 0 to 1.
    fn read_share(&self) -> f64 {
        self.about.map_or(0.0, |about| if about.end_s > 0.0 { self.overview.read_s / about.end_s } else { 1.0 })
    }

    /// Returns whether it was recorded by another program: only its signals are known.
    pub const fn is_foreign(&self) -> bool {
        self.signals.is_some()
    }

    /// Returns why there is no report or excerpt of it.
    fn blocked(&self) -> Option<String> {
        if self.is_foreign() {
            return Some(text::playback::ONLY_SESSIONS.get().to_owned());
        }
        let refused = || self.refused().map_or_else(|| text::playback::OPENING.get().to_owned(), str::to_owned);
        self.about.is_none().then(refused)
    }

    pub fn refused(&self) -> Option<&str> {
        self.report.refused.as_deref()
    }

    fn report(&mut self, ctx: &Context) {
        if self.job.is_none() {
            self.job = Some(SessionJob::report(ctx, &self.path));
        }
    }

    /// Returns the selected excerpt, s.
    fn stretch_s(&self) -> Option<std::ops::Range<f64>> {
        let [Some(from_s), Some(to_s)] = self.stretch_s else { return None };
        (from_s < to_s).then_some(from_s..to_s)
    }

    fn save(&mut self, ctx: &Context) {
        if let (Some(times_s), None) = (self.stretch_s(), &self.job) {
            self.job = Some(SessionJob::cut(ctx, &self.path, times_s));
        }
    }
}

/// Returns the time of the newest tick, s.
fn shown_s(live: &LiveState) -> f64 {
    live.ticks.iter().flatten().map(|tick| tick.t_s).fold(0.0, f64::max)
}
