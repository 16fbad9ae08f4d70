//! The correspondence wizard: check, pushes, result, save. Recorded pushes are kept when going back and when closing.

mod result_ui;

use egui::{Button, RichText, Ui};
use nalgebra::UnitVector3;
use nima_core::calibration::{
    Verdict,
    correspondence::{
        CorrespondencePhase, CorrespondenceRecord, CorrespondenceReport, CorrespondenceSession,
        CorrespondenceSessionSettings, CorrespondenceSolution, MissingInput, PushTarget, TARGETS,
    },
};
use nima_machine::{messages::Tick, rig::Prompt};
use nima_screen::{
    theme,
    widgets::{card, figure, small},
};
use nima_words::{
    report_text::{self, ShortText as _, sentence},
    text,
};

use self::result_ui::{agreement_ui, verdict_ui};
use super::{
    Binding, SaveRequest,
    checks::{check_line, switch_ui, waiting_line},
    drawings::{progress, sphere_image},
    frame::{Wizard, WizardFrame, WizardRequest, WizardStep},
    guide::beside,
    report::{WizardReport, result_ui, verdict_line},
};

/// Minimum number of pushes for a fit.
const PUSHES_MIN: usize = 6;
/// Requested number of pushes: one in each direction.
const PUSHES_ASKED: usize = TARGETS.len();
const STEPS: [WizardStep; 4] = [
    WizardStep { name: text::wizards::STEP_CHECK, meaning: text::correspondence::STEP_CHECK_HOVER },
    WizardStep { name: text::correspondence::STEP_PUSHES, meaning: text::correspondence::STEP_PUSHES_HOVER },
    WizardStep { name: text::wizards::STEP_RESULT, meaning: text::correspondence::STEP_RESULT_HOVER },
    WizardStep { name: text::wizards::STEP_SAVE, meaning: text::wizards::STEP_SAVE_HOVER },
];
// Positions in `STEPS`.
const CHECK: usize = 0;
const PUSHES: usize = 1;
const RESULT: usize = 2;

/// Sources that delivered together with the wrist sensor's sample in the last tick.
#[derive(Clone, Copy, Debug, Default)]
struct DeliveredSources {
    gravity: bool,
    tissue: bool,
    chain: bool,
}

#[derive(Debug)]
pub struct CorrespondenceWizard {
    session: CorrespondenceSession,
    frame: WizardFrame,
    /// `None` while the wrist sensor is silent.
    sources: Option<DeliveredSources>,
    /// Loop time, which starts at zero with each start of the loop, and session time, which continues.
    clock_s: (f64, f64),
    report: WizardReport<CorrespondenceReport>,
}

impl Default for CorrespondenceWizard {
    fn default() -> Self {
        Self::of(CorrespondenceSessionSettings::default())
    }
}

impl CorrespondenceWizard {
    /// Creates the state without data, for a rig with these settings.
    fn of(settings: CorrespondenceSessionSettings) -> Self {
        Self {
            session: CorrespondenceSession::new(settings),
            frame: WizardFrame::default(),
            sources: None,
            clock_s: (0.0, 0.0),
            report: None,
        }
    }

    fn fit(&mut self) {
        let enough = self.session.pushes() >= PUSHES_MIN;
        self.report = enough.then(|| self.session.report().map_err(|error| nima_words::report_text::quoted(&error)));
        self.frame.saved = None;
    }

    /// Returns the next direction to request: first those without a push, then all in turn.
    fn wanted(&self) -> PushTarget {
        self.session.target().unwrap_or(TARGETS[self.session.pushes() % TARGETS.len()])
    }

    fn push(&self) -> Prompt {
        Prompt::Push { direction: UnitVector3::new_normalize(self.wanted().push_in_world) }
    }

    fn good_report(&self) -> Option<&CorrespondenceReport> {
        self.report.as_ref().and_then(|report| report.as_ref().ok())
    }

    fn solution(&self) -> Option<&CorrespondenceSolution> {
        self.good_report().and_then(|report| report.solution.as_ref())
    }

    /// Checks whether all sources deliver and both sensors have been at rest.
    fn may_push(&self) -> Result<(), &'static str> {
        let Some(sources) = self.sources else { return Err(text::correspondence::NEEDS_WRIST_SENSOR.get()) };
        match self.session.phase() {
            _ if !sources.gravity => Err(text::correspondence::NEEDS_GRAVITY.get()),
            CorrespondencePhase::Missing(_) => Err(text::wizards::NEEDS_CHECKS.get()),
            CorrespondencePhase::Resting { .. } => Err(text::correspondence::NEEDS_REST.get()),
            _ => Ok(()),
        }
    }

    fn start_anew(&mut self, settings: CorrespondenceSessionSettings) {
        *self = Self { clock_s: self.clock_s, ..Self::of(settings) };
    }

    fn check_ui(&mut self, ui: &mut Ui) {
        card(ui, text::correspondence::CHECKS_TITLE, text::correspondence::CHECKS_HOVER, |ui| {
            ui.label(text::correspondence::CHECKS_TASK);
            ui.add_space(6.0);
            let tracker = if self.session.settings().chain {
                text::correspondence::CHECK_TRACKER.get()
            } else {
                text::correspondence::CHECK_TRACKER_UNUSED.get()
            };
            let names = [text::correspondence::CHECK_TISSUE.get(), tracker, text::correspondence::CHECK_REST.get()];
            let Some(DeliveredSources { gravity, tissue, chain }) = self.sources else {
                let why = text::correspondence::NEEDS_WRIST_SENSOR.get();
                check_line(ui, text::correspondence::CHECK_WRIST.get(), false, why);
                // Without the wrist sensor, the state of the other checks is unknown.
                for name in names {
                    waiting_line(ui, name);
                }
                return;
            };
            let (_, words) = phase_text(&self.session.phase());
            let rests = self.may_push().is_ok();
            check_line(ui, text::correspondence::CHECK_WRIST.get(), gravity, MissingInput::WristForce.words());
            check_line(ui, names[0], tissue, MissingInput::TissueForce.words());
            check_line(ui, names[1], chain || !self.session.settings().chain, MissingInput::Chain.words());
            check_line(ui, names[2], rests, &words);
        });
        card(ui, text::wizards::OPTIONS_TITLE, text::wizards::OPTIONS_HOVER, |ui| {
            let CorrespondenceSessionSettings { chain, options, .. } = *self.session.settings();
            let flip = text::correspondence::OPTION_FLIP.get();
            let meaning = text::correspondence::OPTION_FLIP_HOVER.get();
            if let Some(flip_s2) = switch_ui(ui, true, options.flip_s2, flip, meaning) {
                self.session.set_flip_s2(flip_s2);
                self.fit();
            }
            let alone = text::correspondence::OPTION_NO_TRACKER.get();
            let meaning = text::correspondence::OPTION_NO_TRACKER_HOVER.get();
            if let Some(alone) = switch_ui(ui, self.session.pushes() == 0, !chain, alone, meaning) {
                self.start_anew(CorrespondenceSessionSettings { chain: !alone, ..*self.session.settings() });
            }
        });
    }

    fn pushes_ui(&mut self, ui: &mut Ui) {
        let count = self.session.pushes();
        let wanted = self.wanted();
        card(ui, text::correspondence::PUSH_TITLE, text::correspondence::PUSH_HOVER, |ui| {
            beside(ui, &self.push(), None, |ui| {
                ui.label(RichText::new(sentence(wanted.name)).font(theme::strong(19.0)));
                let (fraction, words) = if self.sources.is_some() {
                    phase_text(&self.session.phase())
                } else {
                    (0.0, text::correspondence::PHASE_WRIST_SILENT.get().to_owned())
                };
                progress(ui, text::correspondence::PUSH_PROGRESS.get(), fraction, &words);
                ui.add_space(6.0);
                let directions = TARGETS.map(|target| target.push_in_world);
                let taken = self.session.taken_in_world();
                sphere_image(
                    ui,
                    text::correspondence::DIRECTIONS_IMAGE.get(),
                    &directions,
                    &taken,
                    Some(wanted.push_in_world),
                );
            });
            let fraction = count as f64 / PUSHES_ASKED as f64;
            progress(
                ui,
                text::correspondence::STEP_PUSHES.get(),
                fraction,
                &text::correspondence::taken_of(count, PUSHES_ASKED),
            );
        });
        card(ui, text::wizards::SO_FAR, text::correspondence::SO_FAR_HOVER, |ui| {
            figure(
                ui,
                text::correspondence::RECORDED,
                text::correspondence::pushes(count),
                text::correspondence::RECORDED_HOVER,
            );
            match &self.report {
                Some(Ok(report)) => verdict_line(ui, report.verdict, &report.reason),
                Some(Err(error)) => {
                    ui.label(error);
                }
                None => {
                    ui.label(small(text::correspondence::SO_FAR_EMPTY));
                }
            }
            let remove = ui.add_enabled(count > 0, Button::new(text::correspondence::REMOVE_LAST));
            if remove.on_disabled_hover_text(text::wizards::NOTHING_RECORDED).clicked() {
                self.session.undo();
                self.fit();
            }
        });
    }

    fn result_ui(&self, ui: &mut Ui) {
        let otherwise = [text::correspondence::NO_RESULT_HOVER.get(), text::correspondence::TOO_FEW.get()];
        result_ui(ui, self.report.as_ref(), otherwise, |ui, report| {
            verdict_ui(ui, report);
            if let Some(solution) = &report.solution {
                agreement_ui(ui, &solution.agreement);
            }
        });
    }
}

impl Wizard for CorrespondenceWizard {
    fn steps(&self) -> &'static [WizardStep] {
        &STEPS
    }

    fn frame_mut(&mut self) -> &mut WizardFrame {
        &mut self.frame
    }

    fn tick(&mut self, tick: &Tick, _: f64) {
        let Some(sample) = &tick.calibration.wrist else {
            self.sources = None;
            return;
        };
        let mut f1_n = tick.force.gravity_free.map(|wrench| wrench.force_n);
        self.sources = Some(DeliveredSources {
            gravity: f1_n.is_some(),
            tissue: sample.tissue_n.is_some(),
            chain: sample.s1_from_c().is_some(),
        });
        let (begin_s, last_s) = self.clock_s;
        let mut now_s = begin_s + tick.t_s;
        if now_s < last_s {
            // The loop was restarted, so an unfinished push has a gap and is discarded.
            now_s = last_s + 1e-3;
            self.clock_s.0 = now_s - tick.t_s;
            f1_n = None;
        }
        self.clock_s.1 = now_s;
        let before = self.session.pushes();
        self.session.step(f1_n, sample, now_s);
        if self.session.pushes() == before {
            return;
        }
        // Pushes count only on their page.
        if self.frame.step == PUSHES {
            self.fit();
        } else {
            self.session.undo();
        }
    }

    fn prompt(&self) -> Prompt {
        if self.frame.step == PUSHES {
            return self.push();
        }
        Prompt::Rest
    }

    fn may_go_on(&self, _: &Binding) -> Result<(), &'static str> {
        match self.frame.step {
            CHECK => self.may_push(),
            PUSHES if self.session.pushes() >= PUSHES_MIN => Ok(()),
            PUSHES => Err(text::correspondence::NEEDS_PUSHES.get()),
            RESULT if self.solution().is_some() => Ok(()),
            RESULT => Err(text::correspondence::NEEDS_ROTATION.get()),
            _ => Err(text::wizards::LAST_STEP.get()),
        }
    }

    fn is_done(&self) -> bool {
        self.frame.step != PUSHES || self.session.target().is_none()
    }

    fn step_ui(&mut self, ui: &mut Ui, _: &Binding) -> Option<WizardRequest> {
        match self.frame.step {
            CHECK => self.check_ui(ui),
            PUSHES => self.pushes_ui(ui),
            _ => self.result_ui(ui),
        }
        None
    }

    fn proof(&self) -> Option<String> {
        let accepted = self.good_report().is_some_and(|report| report.verdict == Verdict::Accepted);
        accepted.then(|| text::correspondence::PROOF.get().to_owned())
    }

    fn made(&self, binding: &Binding) -> Option<SaveRequest> {
        let flip_s2 = self.session.settings().options.flip_s2;
        let record =
            CorrespondenceRecord::of(self.good_report()?, [&binding.sensor, &binding.tool], flip_s2, &binding.date)?;
        Some(SaveRequest::Correspondence(Box::new(record)))
    }

    fn start_over(&mut self) {
        self.start_anew(*self.session.settings());
    }
}

/// Returns the progress of the push, and the instruction.
fn phase_text(phase: &CorrespondencePhase) -> (f64, String) {
    match phase {
        CorrespondencePhase::Missing(missing) => (0.0, missing.words().to_owned()),
        CorrespondencePhase::Resting { fraction, f1_n, f2_n } => {
            (*fraction, text::correspondence::at_rest(*f1_n, *f2_n))
        }
        CorrespondencePhase::Ready => (0.0, text::correspondence::PHASE_READY.get().to_owned()),
        CorrespondencePhase::Pushing { force_n, enough: false } => (0.5, text::correspondence::hold(*force_n)),
        CorrespondencePhase::Pushing { force_n, enough: true } => (1.0, text::correspondence::let_go(*force_n)),
        CorrespondencePhase::Recorded(index) => (1.0, text::correspondence::push_taken(index + 1)),
        CorrespondencePhase::Refused(refusal) => (0.0, text::correspondence::not_taken(&report_text::refusal(refusal))),
    }
}
