//! The tip-force wizard: check the rig, record, train, check the network, save.
//!
//! A recording is kept when going back, cancelling the training, or closing the wizard; a trained network is kept until there
//! is a newer one. Training and evaluation run in the background and continue while the wizard is closed; they end with the
//! window.

mod check_ui;
mod job;
mod ready_ui;
mod record_ui;
mod take;
mod train_ui;

use std::sync::Arc;

use egui::Ui;
use job::{CheckResult, SharedLosses, TrainingJob, TrainingOrder, judge, look, train};
use nima_core::{
    calibration::Verdict,
    tip_force::{ForceModel, Goal, GoalKind, TrainingSettings},
};
use nima_machine::{messages::Tick, rig::Prompt};
use nima_screen::theme;
use nima_words::text;
use take::{RecordedWith, RecordingClock, TipForceRecording};

use super::{
    Binding, SaveRequest,
    frame::{Wizard, WizardFrame, WizardRequest, WizardStep},
    report::verdict_text,
};

const STEPS: [WizardStep; 5] = [
    WizardStep { name: text::tip_force::STEP_READY, meaning: text::tip_force::STEP_READY_HOVER },
    WizardStep { name: text::tip_force::STEP_RECORD, meaning: text::tip_force::STEP_RECORD_HOVER },
    WizardStep { name: text::tip_force::STEP_TRAIN, meaning: text::tip_force::STEP_TRAIN_HOVER },
    WizardStep { name: text::wizards::STEP_CHECK, meaning: text::tip_force::STEP_CHECK_HOVER },
    WizardStep { name: text::wizards::STEP_SAVE, meaning: text::wizards::STEP_SAVE_HOVER },
];
// Positions in `STEPS`.
const READY: usize = 0;
const RECORD: usize = 1;
const TRAIN: usize = 2;
const CHECK: usize = 3;

/// Number of rows between two periods without contact, and rows of such a period: the network must learn to predict
/// zero there.
const SPELL_EVERY: usize = 3000;
const SPELL: usize = 900;
/// Rows of the check: in contact with the tissue (25 s), then without contact (10 s).
const CHECK_WORK: usize = 5000;
const CHECK_ROWS: usize = CHECK_WORK + 2000;

/// Rows that a technician without a screen records: 80 s.
const ENOUGH_ROWS: usize = 16_000;

impl CheckResult {
    fn as_text(&self) -> String {
        verdict_text(self.check.judgement.verdict, &self.check.judgement.reason)
    }
}

/// A network trained in this wizard.
#[derive(Clone, Debug)]
struct TrainedNetwork {
    model: ForceModel,
    /// A requirement that its recording did not meet, if any.
    narrow: Option<GoalKind>,
}

/// Size of the networks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Size {
    Small,
    #[default]
    Usual,
    Large,
}

impl Size {
    const ALL: [Self; 3] = [Self::Small, Self::Usual, Self::Large];

    fn name(self) -> &'static str {
        match self {
            Self::Small => text::tip_force::SIZE_SMALL.get(),
            Self::Usual => text::tip_force::SIZE_USUAL.get(),
            Self::Large => text::tip_force::SIZE_LARGE.get(),
        }
    }

    fn settings(self) -> TrainingSettings {
        let usual = TrainingSettings::default();
        match self {
            Self::Small => TrainingSettings { hidden: vec![16], ..usual },
            Self::Usual => usual,
            Self::Large => TrainingSettings { hidden: vec![64, 64], ..usual },
        }
    }
}

#[derive(Debug, Default)]
pub struct TipForceWizard {
    frame: WizardFrame,
    clock: RecordingClock,
    /// Sources that delivered in the last tick.
    sources: ready_ui::ReadySources,
    recorded_with: Option<RecordedWith>,
    recording: Option<TipForceRecording>,
    /// This recording has been saved: its file need not be kept as the previous one.
    written: bool,
    size: Size,
    training: Option<(TrainingJob<ForceModel>, Option<GoalKind>)>,
    curves: SharedLosses,
    trained: Option<TrainedNetwork>,
    proof: Option<TipForceRecording>,
    judging: Option<TrainingJob<CheckResult>>,
    checked: Option<CheckResult>,
    /// The last error or message.
    report: Option<String>,
}

impl TipForceWizard {
    /// Returns the rows recorded for the training.
    pub fn rows(&self) -> usize {
        self.recording.as_ref().map_or(0, |take| take.recorder.rows())
    }

    fn is_checking(&self) -> bool {
        self.judging.is_some() || self.proof.as_ref().is_some_and(|take| take.running)
    }

    fn is_recording(&self) -> bool {
        self.recording.as_ref().is_some_and(|take| take.running)
    }

    /// Returns whether a training is running.
    const fn is_training(&self) -> bool {
        self.training.is_some()
    }

    /// Returns the first requirement that the recording does not meet.
    fn lacking(&self) -> Option<Goal> {
        self.recording.as_ref().and_then(|take| take.recorder.coverage().next())
    }

    /// Handles results of background work, and a change of the rig.
    fn take_in(&mut self, binding: &Binding) {
        if self.recorded_with.as_ref().is_some_and(|with| !with.fits(binding)) {
            let report = text::tip_force::RECORDING_DISCARDED.get();
            *self = Self { clock: self.clock, report: Some(report.to_owned()), ..Self::default() };
        }
        if let Some((job, narrow)) = &mut self.training
            && let Some(result) = job.take_result()
        {
            let narrow = *narrow;
            let cancelled = job.is_cancelled();
            self.training = None;
            self.take_model(result, narrow, cancelled);
        }
        if let Some(result) = self.judging.as_mut().and_then(TrainingJob::take_result) {
            self.judging = None;
            match result {
                Ok(checked) => self.checked = Some(checked),
                Err(error) => self.report = Some(text::tip_force::not_judged(&error)),
            }
        }
        self.judge_when_done(binding);
    }

    fn take_model(&mut self, result: Result<ForceModel, String>, narrow: Option<GoalKind>, cancelled: bool) {
        match result {
            Ok(model) => {
                // Results of the previous network do not apply to this one.
                self.trained = Some(TrainedNetwork { model, narrow });
                self.proof = None;
                self.checked = None;
                self.judging = None;
                self.frame.saved = None;
                self.report = None;
            }
            Err(_) if cancelled => self.report = Some(text::tip_force::CANCELLED.get().to_owned()),
            Err(error) => self.report = Some(text::tip_force::not_trained(&error)),
        }
    }

    fn start_recording(&mut self, binding: &Binding) {
        let Some(correspondence) = binding.correspondence else { return };
        let Binding { sensor, tool, .. } = binding.clone();
        self.recorded_with.get_or_insert(RecordedWith { sensor, tool, correspondence });
        self.recording.get_or_insert_with(|| TipForceRecording::new(correspondence)).running = true;
        self.report = None;
    }

    fn start_training(&mut self, binding: &Binding) {
        let (Some(take), Some(with), Some(store)) = (&self.recording, &self.recorded_with, &binding.store) else {
            self.report = Some(text::tip_force::NO_FOLDER.get().to_owned());
            return;
        };
        self.curves = SharedLosses::default();
        let order = TrainingOrder {
            recorder: take.recorder.clone(),
            keep_previous: !self.written,
            settings: self.size.settings(),
            bound: [with.sensor.clone(), with.tool.clone()],
            store: store.clone(),
        };
        let narrow = self.lacking().map(|goal| goal.what);
        let curves = Arc::clone(&self.curves);
        match TrainingJob::start("tip-force-training", move |cancel| train(order, &curves, cancel)) {
            Ok(job) => (self.training, self.written, self.report) = (Some((job, narrow)), true, None),
            Err(error) => self.report = Some(error),
        }
    }

    fn start_check(&mut self, binding: &Binding) {
        let Some(correspondence) = binding.correspondence else { return };
        if self.checked.is_some() {
            // The check is repeated; until then the model keeps its previous check.
            self.proof = None;
        }
        self.proof.get_or_insert_with(|| TipForceRecording::new(correspondence)).running = true;
        self.report = None;
    }

    fn judge_when_done(&mut self, binding: &Binding) {
        let done = self.proof.as_ref().is_some_and(|take| take.recorder.rows() >= CHECK_ROWS);
        if !done || self.judging.is_some() {
            return;
        }
        let (Some(store), Some(TrainedNetwork { model, narrow })) = (binding.store.clone(), self.trained.clone())
        else {
            return;
        };
        let (Some(take), Some(with)) = (self.proof.take(), &self.recorded_with) else { return };
        let sensor = with.sensor.clone();
        match TrainingJob::start("tip-force-check", move |_| judge(&take.recorder, model, narrow, (&store, &sensor))) {
            Ok(job) => (self.judging, self.frame.saved) = (Some(job), None),
            Err(error) => self.report = Some(error),
        }
    }

    /// Returns the progress of the training, 0 to 1, and its duration so far, s.
    fn progress(&self) -> (f64, f64) {
        let curves = look(&self.curves);
        (curves.fraction(), curves.elapsed_s)
    }
}

impl Wizard for TipForceWizard {
    fn steps(&self) -> &'static [WizardStep] {
        &STEPS
    }

    fn frame_mut(&mut self) -> &mut WizardFrame {
        &mut self.frame
    }

    fn tick(&mut self, tick: &Tick, _: f64) {
        let (now_s, broken) = self.clock.at(tick.t_s);
        self.sources = ready_ui::sources(tick);
        if broken {
            [&mut self.recording, &mut self.proof].into_iter().flatten().for_each(TipForceRecording::break_off);
        }
        match self.frame.step {
            RECORD => {
                if let Some(take) = &mut self.recording {
                    let free = take.recorder.rows() % SPELL_EVERY >= SPELL_EVERY - SPELL;
                    take.step(now_s, tick, if free { Prompt::WorkFree } else { Prompt::Work });
                }
            }
            CHECK => {
                if let Some(take) = &mut self.proof {
                    let contact = take.recorder.rows() < CHECK_WORK;
                    take.step(now_s, tick, if contact { Prompt::Work } else { Prompt::WorkFree });
                    if take.recorder.rows() >= CHECK_ROWS {
                        take.running = false;
                    }
                }
            }
            _ => {}
        }
    }

    fn prompt(&self) -> Prompt {
        let take = match self.frame.step {
            RECORD => self.recording.as_ref(),
            CHECK => self.proof.as_ref(),
            _ => None,
        };
        take.map_or(Prompt::Rest, TipForceRecording::prompt)
    }

    fn may_go_on(&self, binding: &Binding) -> Result<(), &'static str> {
        match self.frame.step {
            READY => self.may_record(binding),
            RECORD if self.rows() == 0 => Err(text::tip_force::NEEDS_RECORDING.get()),
            RECORD if self.lacking().is_some() => Err(text::tip_force::NEEDS_GOALS.get()),
            TRAIN if self.is_training() => Err(text::tip_force::NEEDS_TRAINING_END.get()),
            TRAIN if self.trained.is_none() => Err(text::tip_force::NEEDS_NETWORK.get()),
            CHECK if self.checked.is_none() => Err(text::tip_force::NEEDS_CHECK.get()),
            _ => Ok(()),
        }
    }

    fn refresh(&mut self, binding: &Binding) {
        self.take_in(binding);
    }

    fn is_done(&self) -> bool {
        match self.frame.step {
            RECORD => self.rows() > 0 && self.lacking().is_none(),
            TRAIN => self.trained.is_some(),
            CHECK => self.checked.is_some(),
            _ => true,
        }
    }

    fn attend(&mut self, binding: &Binding) -> bool {
        let enough = self.frame.step != RECORD || self.rows() >= ENOUGH_ROWS;
        let done = self.is_done() && enough;
        match self.frame.step {
            _ if done => {}
            RECORD if !self.is_recording() && self.may_record(binding).is_ok() => self.start_recording(binding),
            TRAIN if !self.is_training() && self.report.is_none() => self.start_training(binding),
            CHECK if !self.is_checking() && self.report.is_none() => self.start_check(binding),
            _ => {}
        }
        done
    }

    fn notice(&self) -> Option<&str> {
        self.report.as_deref()
    }

    fn step_ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<WizardRequest> {
        match self.frame.step {
            READY => self.ready_ui(ui, binding),
            RECORD => return self.record_ui(ui, binding),
            TRAIN => self.train_ui(ui, binding),
            _ => return self.check_ui(ui, binding),
        }
        None
    }

    fn before_saving(&self, ui: &mut Ui) -> bool {
        let (Some(_), Some(checked)) = (&self.trained, &self.checked) else {
            ui.label(text::tip_force::NETWORK_UNCHECKED);
            return false;
        };
        if self.proof().is_none() {
            ui.label(checked.as_text());
            ui.add_space(theme::GAP);
        }
        true
    }

    fn proof(&self) -> Option<String> {
        let checked = self.checked.as_ref()?;
        (checked.check.judgement.verdict == Verdict::Accepted).then(|| checked.as_text())
    }

    fn made(&self, _: &Binding) -> Option<SaveRequest> {
        let mut model = self.trained.as_ref()?.model.clone();
        model.origin.check = Some(self.checked.as_ref()?.check.clone());
        Some(SaveRequest::TipForce(Box::new(model)))
    }

    fn go_to(&mut self, step: usize) {
        for take in [&mut self.recording, &mut self.proof].into_iter().flatten() {
            take.running = false;
        }
        self.report = None;
        self.frame.step = step;
    }

    fn start_over(&mut self) {
        *self = Self { clock: self.clock, ..Self::default() };
    }
}
