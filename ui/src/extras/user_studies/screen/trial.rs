//! A trial in the window: the run of the loop is scored, and the participant sees the field, the task, the time and the
//! label. Only alarms and stop are shown in addition.

use egui::{Align, Button, CentralPanel, Frame, Label, Layout, Margin, Panel, RichText, Ui, vec2};
use nima_endoscope::FrameQueue;
use nima_machine::{
    config::SchedulingClass,
    messages::{LoopState, Tick},
    rig::SIDES,
    runtime::{self, Assembly, RuntimeClock},
};
use nima_score::TaskFile;
use nima_screen::{
    image_recorder,
    live::LiveState,
    objects::OfSimulation,
    outbox::Outbox,
    recording,
    scene3d::{CameraLook, SceneView, scene_ui},
    theme,
    widgets::weak,
};
use nima_session::{
    recorder::SessionRecorder,
    sinks::{Audience, Destination},
};
use nima_simulation::{ObjectFeed, SimulationPlan};
use nima_user_study::{ParticipantProgress, RunningTrial, TrialId, TrialPhase, UserStudy};
use nima_words::{report_text::chain, text::top_bar};

use super::open_study::HandSource;
use crate::{
    console::{
        app::StartedLoop,
        page::{PageRun, RunBreak},
    },
    extras::{
        tasks::scoring::LiveScorer,
        user_studies::{
            study::{self, TrialBreak},
            text,
        },
    },
};

/// Height of the line above the field.
const HEAD: f32 = 64.0;

#[derive(Debug)]
pub(super) struct TrialScreen {
    participant: String,
    running: RunningTrial,
    task: TaskFile,
    hand: HandSource,
    /// Number of trials of a participant.
    of: u32,
    scoring: Option<LiveScorer>,
    recorder: Option<SessionRecorder>,
    over: Option<TrialEnd>,
    /// Number of the newest tick of each side, and count of missing ticks.
    newest: [Option<u64>; SIDES],
    lost: u64,
    /// Rate of the loop, Hz; 0 before it starts.
    rate_hz: f64,
    /// The next press on the button aborts.
    is_asked: bool,
}

/// End of a trial.
#[derive(Clone, Debug, PartialEq, Eq)]
enum TrialEnd {
    /// The task is done, or the time limit is reached.
    Done,
    /// Aborted, for this reason.
    Broken(TrialBreak),
}

impl TrialScreen {
    pub(super) fn new(participant: &str, running: RunningTrial, task: TaskFile, hand: HandSource, of: u32) -> Self {
        Self {
            participant: participant.to_owned(),
            running,
            task,
            hand,
            of,
            scoring: None,
            recorder: None,
            over: None,
            newest: [None; SIDES],
            lost: 0,
            rate_hz: 0.0,
            is_asked: false,
        }
    }

    /// Aborts the trial, if it is not over yet.
    fn break_off_because(&mut self, why: &str) {
        self.over.get_or_insert_with(|| TrialEnd::Broken(TrialBreak::of(why)));
    }

    pub(super) const fn is_over(&self) -> bool {
        self.over.is_some()
    }

    pub(super) fn is_by_mouse(&self) -> bool {
        self.hand == HandSource::Mouse
    }

    /// Records the end of the trial; returns its text, and further notes. The loop must have ended.
    pub(super) fn close(self, study: &mut UserStudy) -> (String, Vec<String>) {
        let Self { participant, running, scoring, recorder, over, lost, .. } = self;
        let trial = running.trial();
        let mut notes = Vec::new();
        if let Some(Err(error)) = recorder.map(SessionRecorder::finish) {
            notes.push(text::studies::record_failed(&chain(&error)));
        }
        if lost > 0 {
            notes.push(text::studies::note_lost(trial, lost));
        }
        let why = match over {
            Some(TrialEnd::Done) => None,
            Some(TrialEnd::Broken(why)) => Some(why),
            None => Some(TrialBreak::of(study::CLOSED)),
        };
        let closed = study::close(study, running, why, scoring);
        let shows = study.state().progress(&participant).is_none_or(ParticipantProgress::shows_result);
        let words =
            closed.map_or_else(|error| error.to_string(), |ran| nima_words::report_text::sentence(&ran.as_text(shows)));
        (words, notes)
    }

    fn head_ui(&mut self, ui: &mut Ui, live: &LiveState) {
        ui.horizontal_centered(|ui| {
            ui.vertical(|ui| {
                ui.add_space(4.0);
                ui.label(RichText::new(&self.task.name).font(theme::strong(17.0)));
                ui.label(weak(text::studies::trial(self.running.trial(), self.of, self.running.label())));
            });
            ui.add_space(24.0);
            let elapsed_s = self.scoring.as_ref().map_or(0.0, |scoring| scoring.trial.elapsed_s());
            let clock = text::studies::time_of(elapsed_s, self.task.time_limit_s);
            ui.label(RichText::new(clock).font(theme::strong(22.0)));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let words = if self.is_asked { text::studies::GIVE_UP_NOW.get() } else { text::studies::GIVE_UP.get() };
                let button = Button::selectable(self.is_asked, words).frame_when_inactive(true);
                let button = ui.add_enabled(self.over.is_none(), button.min_size(vec2(150.0, 36.0)));
                if button.on_hover_text(text::studies::GIVE_UP_HOVER).clicked() {
                    if self.is_asked {
                        self.break_off_because(study::GIVEN_UP);
                    }
                    self.is_asked = true;
                }
                ui.add_space(12.0);
                ui.add(Label::new(state_text(live)).wrap());
            });
        });
    }
}

impl PageRun for TrialScreen {
    fn participant(&self) -> &str {
        &self.participant
    }

    fn name(&self) -> String {
        let TrialId { phase, number, attempt } = self.running.trial();
        let practice = if phase == TrialPhase::Practice { " practice" } else { "" };
        let again = if attempt > 1 { format!(" attempt {attempt}") } else { String::new() };
        format!("{}{practice} {number}{again}", self.participant)
    }

    fn start(
        &mut self,
        plan: &SimulationPlan,
        speed: Option<f64>,
        (reel, audiences): (&FrameQueue, Vec<Box<dyn Audience>>),
    ) -> Result<StartedLoop, String> {
        self.rate_hz = plan.rig.rate_hz;
        let to = Destination { file: self.running.session(), audiences };
        let is_received = to.file.is_some() || !to.audiences.is_empty();
        let recorded = is_received.then(|| recording::begin(to, plan, None));
        let (tap, recorder) = recorded.transpose().map_err(|error| chain(&error))?.unzip();
        self.recorder = recorder;
        if let Some(recorder) = &self.recorder {
            image_recorder::film(recorder, &plan.rig, reel);
        }
        let (assembly, mut watched) = match speed {
            Some(speed) => {
                let (assembly, watched) = plan.watched().map_err(|error| chain(&error))?;
                let scheduling = SchedulingClass::Ordinary;
                (Assembly { clock: RuntimeClock::Simulated { speed }, scheduling, ..assembly }, watched)
            }
            None => plan.watched_assembly().map_err(|error| chain(&error))?,
        };
        if let Some((recorder, watched)) = self.recorder.as_ref().zip(watched.as_mut().and_then(ObjectFeed::another)) {
            recorder.watch(OfSimulation::source(plan, watched));
        }
        self.scoring = Some(LiveScorer::new(&self.task, watched.as_mut().and_then(ObjectFeed::another)));
        let handle = runtime::start(Assembly { tap, ..assembly }).map_err(|error| chain(&error))?;
        Ok((handle, watched))
    }

    fn tick(&mut self, tick: &Tick) {
        let Some(scoring) = self.scoring.as_mut().filter(|_| self.over.is_none()) else { return };
        let before = self.newest[tick.side.index()].replace(tick.index);
        self.lost += before.map_or(0, |before| tick.index.saturating_sub(before + 1));
        scoring.tick(tick);
        self.over = match tick.state {
            LoopState::Faulted(fault) => Some(TrialEnd::Broken(TrialBreak::by(fault, self.rate_hz))),
            LoopState::Stopped => Some(TrialEnd::Broken(TrialBreak::of(study::STOPPED))),
            _ => scoring.trial.is_over().then_some(TrialEnd::Done),
        };
    }

    fn break_off(&mut self, why: RunBreak) {
        self.break_off_because(match why {
            RunBreak::Closed => study::CLOSED,
            RunBreak::LoopEnded => study::LOOP_ENDED,
            RunBreak::NotStarted => study::NOT_STARTED,
        });
    }

    fn ui(&mut self, ui: &mut Ui, live: &LiveState, view: &mut SceneView, outbox: &mut Outbox) {
        view.look = CameraLook::Endoscope;
        view.figures = false;
        let frame = Frame::new().fill(theme::now().panel).inner_margin(Margin::symmetric(14, 6));
        Panel::top("trial").exact_size(HEAD).resizable(false).frame(frame).show(ui, |ui| self.head_ui(ui, live));
        CentralPanel::no_frame().show(ui, |ui| scene_ui(ui, live, view, outbox));
    }
}

/// Returns the current instruction to the participant.
fn state_text(live: &LiveState) -> &'static str {
    match live.state() {
        _ if live.first_tick().is_none() => text::studies::STATE_STARTING.get(),
        LoopState::Stopped | LoopState::Faulted(_) => text::studies::STATE_STOPPED.get(),
        LoopState::Idle => text::studies::STATE_IDLE.get(),
        LoopState::Ready => text::studies::STATE_HOLD.get(),
        LoopState::Clutched => top_bar::CLUTCHED_MEANING.get(),
        LoopState::Disconnected => top_bar::DISCONNECTED_MEANING.get(),
        LoopState::Engaged if live.scene.is_searched() => text::studies::KEYS_SEARCH.get(),
        LoopState::Engaged => "",
    }
}
