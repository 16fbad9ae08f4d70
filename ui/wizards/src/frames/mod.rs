//! One wizard for all frame calibrations: check, record, result, save. [`FrameKind`] distinguishes them. Recorded data are kept
//! when going back and when closing.

mod effect;
mod result_ui;
mod steps_ui;
#[cfg(test)]
mod tests;

use egui::Ui;
use nalgebra::{UnitQuaternion, Vector3};
use nima_calibrations::frames::{
    FrameKind, FrameSaving, FrameSubject,
    job::{FrameJob, Outcome, last_changes},
    kind::Texts,
    numbers::{self, FrameNumber},
};
use nima_core::calibration::{
    RecordHead, Verdict,
    frames::{CalibrationSource, FramePhase, FrameSample, RigChange},
    gravity::{PoseTarget, TARGETS},
};
use nima_machine::{
    messages::Tick,
    rig::{Prompt, ViewOrientation},
};
use nima_screen::widgets::card;
use nima_words::text::{self, frames as texts};

use self::result_ui::outcome_ui;
use super::{
    Binding, SaveRequest,
    frame::{Wizard, WizardFrame, WizardRequest, WizardStep},
    report::{WizardReport, result_ui},
};

const STEPS: [WizardStep; 4] = [
    WizardStep { name: text::wizards::STEP_CHECK, meaning: texts::STEP_CHECK_HOVER },
    WizardStep { name: texts::STEP_RECORD, meaning: texts::STEP_RECORD_HOVER },
    WizardStep { name: text::wizards::STEP_RESULT, meaning: texts::STEP_RESULT_HOVER },
    WizardStep { name: text::wizards::STEP_SAVE, meaning: texts::STEP_SAVE_HOVER },
];
// Positions in `STEPS`.
const CHECK: usize = 0;
const RECORD: usize = 1;
const RESULT: usize = 2;
const SAVE: usize = 3;
/// Interval of the samples, s: poses are held for half a second, and the tracker sends 60 frames per second.
const EVERY_S: f64 = 0.004;
/// A pose of a list without a new record for this time is skipped, s: longer than a person takes to start with it.
const PASSED_S: f64 = 8.0;
/// A gravity direction this close to one of the list replaces it, rad.
const NEAR_RAD: f64 = 0.3;

/// The wizard of one frame calibration.
#[derive(Debug)]
pub struct FrameWizard {
    kind: FrameKind,
    other_way: bool,
    frame: WizardFrame,
    subject: Option<FrameSubject>,
    job: Option<Box<dyn FrameJob>>,
    phase: FramePhase,
    seen: FrameSample,
    seen_view: Option<UnitQuaternion<f64>>,
    paused: bool,
    /// Number of skipped poses of a list, and time without a new record for the current one, s.
    passed: (usize, f64),
    /// Loop time, which starts at zero with each start of the loop, and session time, which continues, s.
    clock_s: (f64, f64),
    report: WizardReport<Outcome>,
    /// A gravity direction this close to a listed one replaces it, rad.
    undoable: Vec<RigChange>,
}

impl FrameWizard {
    pub fn new(kind: FrameKind) -> Self {
        Self {
            kind,
            other_way: false,
            frame: WizardFrame::default(),
            subject: None,
            job: None,
            phase: FramePhase::Missing(None),
            seen: FrameSample::default(),
            seen_view: None,
            paused: false,
            passed: (0, 0.0),
            clock_s: (0.0, 0.0),
            report: None,
            undoable: Vec::new(),
        }
    }

    /// Selects the method; data recorded with one method are useless for the other.
    pub(super) fn choose_way(&mut self, other_way: bool) {
        if self.other_way != other_way {
            self.other_way = other_way;
            self.begin(None);
        }
    }

    pub(super) const fn goes_the_other_way(&self) -> bool {
        self.other_way
    }

    /// Returns whether this step is before the result.
    pub(super) const fn records(&self) -> bool {
        self.frame.step < RESULT
    }

    fn texts(&self) -> Texts {
        self.kind.texts(self.other_way)
    }

    fn taken(&self) -> usize {
        self.job.as_ref().map_or(0, |job| job.samples().len())
    }

    fn is_complete(&self) -> bool {
        self.job.as_ref().is_some_and(|job| job.coverage().fraction >= 1.0)
    }

    /// Restarts for this subject.
    fn begin(&mut self, subject: Option<FrameSubject>) {
        let job = subject.as_ref().and_then(|subject| self.kind.job(subject, self.other_way));
        let other_way = self.other_way;
        let clock_s = self.clock_s;
        let kind = self.kind;
        *self = Self { other_way, subject, job, clock_s, ..Self::new(kind) };
    }

    /// Returns the time of the session at this time of the loop, s.
    fn session_s(&mut self, loop_s: f64) -> f64 {
        let (last_s, session_s) = self.clock_s;
        // When the loop restarts, leave a gap, which ends the current pose.
        let way_s = if loop_s > last_s { loop_s - last_s } else { 1.0 };
        self.clock_s = (loop_s, session_s + way_s);
        self.clock_s.1
    }

    fn record(&mut self, t_s: f64, since_s: f64) {
        if self.paused || self.is_complete() {
            return;
        }
        let (Some(job), Some(subject)) = (&mut self.job, &self.subject) else { return };
        self.phase = job.step(&self.kind.seen(&self.seen, subject), t_s);
        match self.phase {
            FramePhase::Recorded { .. } => {
                self.report = None;
                self.frame.saved = None;
                self.passed = (0, 0.0);
            }
            FramePhase::TakenHere => {
                self.passed.1 += since_s;
                if self.passed.1 > PASSED_S {
                    self.passed = (self.passed.0 + 1, 0.0);
                }
            }
            _ => self.passed.1 = 0.0,
        }
    }

    /// Returns the requested pose of the list: the first gravity direction without a record nearby, or the next one if
    /// that gave none, for example with a wrong sensor mount in the rig file.
    fn target(&self) -> PoseTarget {
        let (Some(job), Some(subject)) = (&self.job, &self.subject) else { return TARGETS[0] };
        let down = |sample: &FrameSample| {
            let base_from_s1 = sample.base_from_flange?.rotation * subject.arm.flange_from_s1.rotation;
            Some(-(base_from_s1.inverse() * subject.up_in_base()))
        };
        let taken: Vec<_> = job.samples().iter().filter_map(down).collect();
        let is_open = |target: &PoseTarget| taken.iter().all(|s1| s1.angle(&Vector3::from(target.down_s1)) > NEAR_RAD);
        let open: Vec<_> = TARGETS.into_iter().filter(is_open).collect();
        let list = if open.is_empty() { &TARGETS[..] } else { &open[..] };
        list[self.passed.0 % list.len()]
    }

    fn fit(&mut self) {
        self.report =
            self.job.as_ref().map(|job| job.report().map_err(|error| nima_words::report_text::quoted(&error)));
    }

    fn outcome(&self) -> Option<&Outcome> {
        self.report.as_ref().and_then(|report| report.as_ref().ok())
    }

    fn numbers(&self) -> Vec<FrameNumber> {
        let found = self.outcome().zip(self.subject.as_ref());
        found
            .and_then(|(outcome, subject)| numbers::of(outcome, subject, self.seen_view))
            .map_or(Vec::new(), |(all, _)| all)
    }

    fn lacks(&self) -> Option<CalibrationSource> {
        let has = |source: &CalibrationSource| match source {
            CalibrationSource::Flange => self.seen.base_from_flange.is_some(),
            CalibrationSource::Marker => self.seen.c_from_m.is_some(),
            CalibrationSource::Handle => self.seen.leader_from_handle.is_some(),
            CalibrationSource::Wrench => self.seen.wrench.is_some(),
        };
        self.job.as_ref()?.needs().into_iter().find(|source| !has(source))
    }

    /// Returns whether the person can follow the instructions: a view is found by looking at the endoscope image.
    fn has_image(&self, binding: &Binding) -> bool {
        self.kind != FrameKind::View || binding.has_image
    }

    fn result_ui(&self, ui: &mut Ui) {
        let otherwise = [texts::NO_RESULT_HOVER.get(), texts::TOO_FEW.get()];
        let Some(subject) = &self.subject else { return };
        result_ui(ui, self.report.as_ref(), otherwise, |ui, outcome| {
            outcome_ui(ui, outcome, subject, self.seen_view, self.texts().units);
        });
    }

    /// Finds the changes of the last saved calibration; none if the rig file has different values now.
    fn look_for_undo(&mut self, binding: &Binding) {
        let Some(store) = &binding.store else { return };
        let wrist = [binding.sensor.as_str(), binding.tool.as_str()];
        let handle = self.kind == FrameKind::View && self.other_way;
        self.undoable = last_changes(store, self.kind, handle, wrist);
        self.undoable.retain(|change| binding.rig_value(&change.key) == change.after);
    }
}

impl Wizard for FrameWizard {
    fn steps(&self) -> &'static [WizardStep] {
        &STEPS
    }

    fn frame_mut(&mut self) -> &mut WizardFrame {
        &mut self.frame
    }

    fn refresh(&mut self, binding: &Binding) {
        let changed = match (&self.subject, &binding.subject) {
            (Some(before), Some(now)) => !before.is_same_place(now),
            (before, now) => before.is_some() != now.is_some(),
        };
        // Recorded data belong to the rig's previous state, so keep it while there are any.
        if changed && self.taken() == 0 {
            let step = self.frame.step;
            self.begin(binding.subject.clone());
            self.frame.step = step;
        } else if let (Some(subject), Some(now)) = (&mut self.subject, &binding.subject) {
            subject.serials.clone_from(&now.serials);
        }
        // After a restart of the loop the sensor reports its number only after a while.
        if self.frame.step == SAVE && !binding.sensor.is_empty() && self.frame.take_changed() {
            self.look_for_undo(binding);
        }
    }

    fn tick(&mut self, tick: &Tick, _: f64) {
        let since_s = tick.t_s - self.clock_s.0;
        if (0.0..EVERY_S).contains(&since_s) {
            return;
        }
        self.seen = tick.calibration.frames;
        if let ViewOrientation::Seen(world_from_view) = tick.calibration.view
            && self.frame.step == RECORD
        {
            self.seen_view = Some(world_from_view);
        }
        let t_s = self.session_s(tick.t_s);
        if self.frame.step == RECORD {
            self.record(t_s, since_s.clamp(0.0, 0.1));
        }
    }

    fn prompt(&self) -> Prompt {
        if self.frame.step != RECORD || self.paused || self.job.is_none() || self.is_complete() {
            return Prompt::Rest;
        }
        self.kind.prompt(self.other_way, self.taken(), || self.target())
    }

    fn may_go_on(&self, binding: &Binding) -> Result<(), &'static str> {
        match self.frame.step {
            CHECK if self.job.is_none() => Err(texts::NEEDS_ARM.get()),
            CHECK if !self.has_image(binding) => Err(text::wizards::NEEDS_CHECKS.get()),
            CHECK => self.lacks().map_or(Ok(()), |_| Err(text::wizards::NEEDS_CHECKS.get())),
            RECORD if self.taken() >= 3 => Ok(()),
            RECORD => Err(texts::NEEDS_MORE.get()),
            RESULT if self.outcome().is_some_and(Outcome::is_found) => Ok(()),
            RESULT => Err(texts::NEEDS_RESULT.get()),
            _ => Err(text::wizards::LAST_STEP.get()),
        }
    }

    fn is_done(&self) -> bool {
        self.frame.step != RECORD || self.is_complete()
    }

    fn step_ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<WizardRequest> {
        match self.frame.step {
            CHECK => self.check_ui(ui, binding),
            RECORD => self.record_ui(ui),
            _ => self.result_ui(ui),
        }
        None
    }

    fn proof(&self) -> Option<String> {
        let proven = self.outcome().is_some_and(|outcome| outcome.quality().verdict == Verdict::Accepted);
        proven.then(|| texts::PROOF.get().to_owned())
    }

    fn made(&self, binding: &Binding) -> Option<SaveRequest> {
        let head = RecordHead::new(&binding.sensor, &binding.tool, &binding.date);
        let record = self.outcome()?.record(head, self.subject.as_ref()?.serials.clone())?;
        let numbers = self
            .numbers()
            .into_iter()
            .filter(FrameNumber::changes)
            .map(|number| (number.key.clone(), number.toml()))
            .collect();
        Some(SaveRequest::Frame(Box::new(FrameSaving { record, numbers })))
    }

    fn after_saving(&mut self, ui: &mut Ui) -> Option<SaveRequest> {
        if self.undoable.is_empty() {
            return None;
        }
        let wanted = card(ui, texts::UNDO_TITLE, texts::UNDO_CARD_HOVER, |ui| ui.button(texts::UNDO).clicked());
        wanted.then(|| SaveRequest::Undo(self.undoable.iter().cloned().map(RigChange::undone).collect()))
    }

    fn go_to(&mut self, step: usize) {
        self.frame.step = step;
        self.frame.changed = true;
        if step == RECORD {
            self.paused = false;
            self.phase = FramePhase::Missing(None);
        }
        if step == RESULT && self.report.is_none() {
            self.fit();
        }
    }

    fn start_over(&mut self) {
        // The current rig arrives with the next frame.
        self.begin(None);
    }
}
