//! The tip-force wizard: check the rig, record, train, check the network, save.
//!
//! A recording outlives every step back, a cancelled training and the closing of the wizard; a trained network stays until a
//! newer one is there. Training and judging run in the background and go on while the wizard is closed; they end with the window.

mod check_ui;
mod job;
mod ready_ui;
mod record_ui;
mod take;
mod train_ui;

use crate::console::text;
use std::sync::Arc;

use egui::Ui;
use nima::{
    calibration::{Verdict, correspondence::Correspondence},
    device::Prompt,
    runtime::Tick,
    tip_force::{Model, Settings},
};

use super::{Binding, Step, Wish, save_card, steps_ui};
use crate::console::theme;
use job::{Checked, Job, Order, Shared, judge, look, train};
use take::{Clock, Take};

const STEPS: [Step; 5] = [
    Step { name: text::tip_force::READY, meaning: text::tip_force::IS_EVERYTHING_THERE_THAT },
    Step { name: text::tip_force::RECORD, meaning: text::tip_force::WORK_THROUGH_THE_TROCAR },
    Step { name: text::tip_force::TRAIN, meaning: text::tip_force::THE_NETWORK_LEARNS_FROM },
    Step { name: text::tip_force::CHECK, meaning: text::tip_force::A_NEW_SHORT_RECORDING },
    Step { name: text::tip_force::SAVE, meaning: text::tip_force::KEPT_FOR_THIS_SENSOR },
];
const READY: usize = 0;
const RECORD: usize = 1;
const TRAIN: usize = 2;
const CHECK: usize = 3;

/// Rows between two spells without contact, and rows of such a spell: where nothing is touched, nothing may be told.
const SPELL_EVERY: usize = 3000;
const SPELL: usize = 900;
/// Rows of the check: with work on the tissue (40 s), and then without contact (15 s).
const CHECK_WORK: usize = 8000;
const CHECK_ROWS: usize = CHECK_WORK + 3000;

/// What a recording was made with: rows of different rigs do not mix.
#[derive(Clone, Debug)]
struct RecordedWith {
    sensor: String,
    tool: String,
    correspondence: Correspondence,
}

impl RecordedWith {
    /// It is the same rig as far as that is known.
    fn fits(&self, binding: &Binding) -> bool {
        let same = |now: &Correspondence| {
            let then = &self.correspondence;
            let turned_rad = now.rotation.angle_to(&then.rotation);
            now.target == then.target && now.flip_s2 == then.flip_s2 && turned_rad < 1e-6
        };
        self.sensor == binding.sensor && self.tool == binding.tool && binding.correspondence.as_ref().is_none_or(same)
    }
}

/// A network of this wizard.
#[derive(Clone, Debug)]
struct Trained {
    model: Model,
    /// The goal that its recording had not met, if any.
    narrow: Option<&'static str>,
}

/// How large the networks are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Size {
    Small,
    #[default]
    Usual,
    Large,
}

impl Size {
    const ALL: [Self; 3] = [Self::Small, Self::Usual, Self::Large];

    const fn name(self) -> &'static str {
        match self {
            Self::Small => text::tip_force::SMALL,
            Self::Usual => text::tip_force::USUAL,
            Self::Large => text::tip_force::LARGE,
        }
    }

    fn settings(self) -> Settings {
        let usual = Settings::default();
        match self {
            Self::Small => Settings { hidden: vec![16], ..usual },
            Self::Usual => usual,
            Self::Large => Settings { hidden: vec![64, 64], ..usual },
        }
    }
}

/// The wizard's memory.
#[derive(Debug, Default)]
pub struct TipForceWizard {
    step: usize,
    clock: Clock,
    /// What the last tick brought.
    sources: ready_ui::Sources,
    recorded_with: Option<RecordedWith>,
    recording: Option<Take>,
    /// This recording has been written: its own file need not be kept as the previous one.
    written: bool,
    size: Size,
    training: Option<(Job<Model>, Option<&'static str>)>,
    curves: Shared,
    trained: Option<Trained>,
    proof: Option<Take>,
    judging: Option<Job<Checked>>,
    checked: Option<Checked>,
    /// What went wrong last, or what was put away.
    told: Option<String>,
    by: [String; 2],
    saved: Option<String>,
}

impl TipForceWizard {
    /// Takes in one tick of the loop. Rows are taken in the two steps that record, and only while that was started.
    pub fn tick(&mut self, tick: &Tick) {
        let (now_s, broken) = self.clock.at(tick.t_s);
        self.sources = ready_ui::sources(tick);
        if broken {
            [&mut self.recording, &mut self.proof].into_iter().flatten().for_each(Take::break_off);
        }
        match self.step {
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

    /// What the person at the arm is to do now.
    pub fn prompt(&self) -> Prompt {
        let take = match self.step {
            RECORD => self.recording.as_ref(),
            CHECK => self.proof.as_ref(),
            _ => None,
        };
        take.map_or(Prompt::Rest, Take::prompt)
    }

    /// Tells what became of the network that was handed out for saving.
    pub fn tell_saved(&mut self, words: String) {
        self.saved = Some(words);
    }

    /// Rows recorded for the training.
    pub fn rows(&self) -> usize {
        self.recording.as_ref().map_or(0, |take| take.recorder.rows())
    }

    /// The background is at the training.
    const fn is_training(&self) -> bool {
        self.training.is_some()
    }

    /// The first goal that the recording has not met.
    fn lacking(&self) -> Option<nima::tip_force::Goal> {
        self.recording.as_ref().and_then(|take| take.recorder.coverage().next())
    }

    fn may_record(&self, binding: &Binding) -> Result<(), &'static str> {
        if binding.correspondence.is_none() {
            return Err(text::tip_force::THE_CORRESPONDENCE_IS_NOT);
        }
        if self.sources.iter().all(|there| *there) { Ok(()) } else { Err(text::tip_force::A_CHECK_IS_NOT) }
    }

    /// Whether the step after this one may begin, or why not.
    fn may_go_on(&self, binding: &Binding) -> Result<(), &'static str> {
        match self.step {
            READY => self.may_record(binding),
            RECORD if self.rows() == 0 => Err(text::tip_force::NOTHING_IS_RECORDED_YET),
            RECORD if self.lacking().is_some() => Err(text::tip_force::NOT_ALL_GOALS_ARE),
            TRAIN if self.is_training() => Err(text::tip_force::WAIT_FOR_THE_TRAINING),
            TRAIN if self.trained.is_none() => Err(text::tip_force::NO_NETWORK_IS_TRAINED),
            CHECK if self.checked.is_none() => Err(text::tip_force::THE_NETWORK_IS_NOT),
            _ => Ok(()),
        }
    }

    /// The wizard; gives a network that shall be saved.
    pub fn ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<Model> {
        self.take_in(binding);
        let mut wish = steps_ui(ui, &STEPS, self.step, self.may_go_on(binding));
        ui.add_space(theme::GAP);
        if let Some(told) = &self.told {
            ui.label(told);
            ui.add_space(theme::GAP);
        }
        let mut save = None;
        match self.step {
            READY => self.ready_ui(ui, binding),
            RECORD => wish = self.record_ui(ui, binding).or(wish),
            TRAIN => self.train_ui(ui, binding),
            CHECK => wish = self.check_ui(ui, binding).or(wish),
            _ => save = self.save_ui(ui, binding),
        }
        match wish {
            Some(Wish::GoTo(step)) => self.go_to(step),
            Some(Wish::StartOver) => *self = Self { clock: self.clock, ..Self::default() },
            None => {}
        }
        save
    }

    fn go_to(&mut self, step: usize) {
        for take in [&mut self.recording, &mut self.proof].into_iter().flatten() {
            take.running = false;
        }
        self.told = None;
        self.step = step;
    }

    /// Results of the background, and a rig that has changed.
    fn take_in(&mut self, binding: &Binding) {
        if self.recorded_with.as_ref().is_some_and(|with| !with.fits(binding)) {
            let told = text::tip_force::SENSOR_TOOL_OR_CORRESPONDENCE;
            *self = Self { clock: self.clock, told: Some(told.to_owned()), ..Self::default() };
        }
        if let Some((job, narrow)) = &mut self.training
            && let Some(result) = job.take_result()
        {
            let (narrow, cancelled) = (*narrow, job.is_cancelled());
            self.training = None;
            self.take_model(result, narrow, cancelled);
        }
        if let Some(result) = self.judging.as_mut().and_then(Job::take_result) {
            self.judging = None;
            match result {
                Ok(checked) => self.checked = Some(checked),
                Err(error) => self.told = Some(text::tip_force::not_judged(&error)),
            }
        }
        self.judge_when_done(binding);
    }

    fn take_model(&mut self, result: Result<Model, String>, narrow: Option<&'static str>, cancelled: bool) {
        match result {
            Ok(model) => {
                // What was found of the network before says nothing about this one.
                (self.trained, self.proof, self.checked) = (Some(Trained { model, narrow }), None, None);
                (self.judging, self.saved, self.told) = (None, None, None);
            }
            Err(_) if cancelled => self.told = Some(text::tip_force::CANCELLED_THE_RECORDING_IS.to_owned()),
            Err(error) => self.told = Some(text::tip_force::not_trained(&error)),
        }
    }

    fn start_recording(&mut self, binding: &Binding) {
        let Some(correspondence) = binding.correspondence else { return };
        let Binding { sensor, tool, .. } = binding.clone();
        self.recorded_with.get_or_insert(RecordedWith { sensor, tool, correspondence });
        self.recording.get_or_insert_with(|| Take::new(correspondence)).running = true;
        self.told = None;
    }

    fn start_training(&mut self, binding: &Binding) {
        let (Some(take), Some(store)) = (&self.recording, &binding.store) else {
            self.told = Some(text::tip_force::NO_FOLDER_FOR_THE.to_owned());
            return;
        };
        self.curves = Shared::default();
        let order = Order {
            recorder: take.recorder.clone(),
            keep_previous: !self.written,
            settings: self.size.settings(),
            bound: [binding.sensor.clone(), binding.tool.clone()],
            store: store.clone(),
        };
        let (narrow, curves) = (self.lacking().map(|goal| goal.name), Arc::clone(&self.curves));
        match Job::start("tip-force-training", move |cancel| train(order, &curves, cancel)) {
            Ok(job) => (self.training, self.written, self.told) = (Some((job, narrow)), true, None),
            Err(error) => self.told = Some(error),
        }
    }

    fn start_check(&mut self, binding: &Binding) {
        let Some(correspondence) = binding.correspondence else { return };
        if self.checked.is_some() {
            // Another check judges anew; the one before stays until then.
            self.proof = None;
        }
        self.proof.get_or_insert_with(|| Take::new(correspondence)).running = true;
        self.told = None;
    }

    fn judge_when_done(&mut self, binding: &Binding) {
        let done = self.proof.as_ref().is_some_and(|take| take.recorder.rows() >= CHECK_ROWS);
        if !done || self.judging.is_some() {
            return;
        }
        let (Some(store), Some(Trained { model, narrow })) = (binding.store.clone(), self.trained.clone()) else {
            return;
        };
        let Some(take) = self.proof.take() else { return };
        let sensor = binding.sensor.clone();
        match Job::start("tip-force-check", move |_| judge(&take.recorder, model, narrow, (&store, &sensor))) {
            Ok(job) => (self.judging, self.saved) = (Some(job), None),
            Err(error) => self.told = Some(error),
        }
    }

    fn save_ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<Model> {
        let (Some(trained), Some(checked)) = (&self.trained, &self.checked) else {
            ui.label(text::tip_force::THERE_IS_NO_CHECKED);
            return None;
        };
        let accepted = checked.check.verdict == Verdict::Accepted;
        let proof = format!("{}: {}.", checked.check.verdict.words(), checked.check.reason);
        if !accepted {
            ui.label(&proof);
            ui.add_space(theme::GAP);
        }
        let [name, why] = &mut self.by;
        let wanted = save_card(ui, binding, accepted.then_some(proof.as_str()), [name, why], self.saved.as_deref());
        wanted.then(|| {
            let (mut model, mut check) = (trained.model.clone(), checked.check.clone());
            if !accepted {
                check.override_by = Some(self.by[0].trim().to_owned());
                check.override_reason = Some(self.by[1].trim().to_owned());
            }
            model.origin.check = Some(check);
            model
        })
    }

    /// Share of the training that is done, and how long it has taken, s.
    fn progress(&self) -> (f64, f64) {
        let curves = look(&self.curves);
        (curves.share(), curves.elapsed_s)
    }
}
