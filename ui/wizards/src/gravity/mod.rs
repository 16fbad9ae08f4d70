//! The gravity wizard: check, twelve poses, result, free motion, save. Recorded data are kept when going back and when
//! closing.

mod result_ui;

use egui::{Button, RichText, Ui};
use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{
    calibration::{
        Verdict,
        gravity::{
            CheckPass, Compensator, DEFAULT_TIME_CONSTANT_S, GravityPhase, GravityReport, GravitySession,
            GravitySessionSettings, PassResult, Precheck, TARGETS,
        },
    },
    frames::WristSample,
};
use nima_machine::{messages::Tick, rig::Prompt};
use nima_screen::{
    theme,
    widgets::{card, figure, small},
};
use nima_words::text;

use self::result_ui::{models_ui, report_figures, verdict_ui};
use super::{
    Binding, SaveRequest,
    checks::{check_ui, switch_ui},
    drawings::{pose_image, progress, sphere_image},
    frame::{Wizard, WizardFrame, WizardRequest, WizardStep},
    guide::beside,
    report::{WizardReport, judged_line, result_ui},
};

/// Limit of the 95th percentile of the force in free motion, N; includes the noise of a sample.
const FREE_MOTION_LIMIT_N: f64 = 0.25;
/// Samples of free motion that a technician without a screen records.
const FREE_MOTION_SAMPLES: u64 = 8000;
/// Minimum number of poses for a fit.
const POSES_MIN: usize = 6;
const STEPS: [WizardStep; 5] = [
    WizardStep { name: text::wizards::STEP_CHECK, meaning: text::gravity::STEP_CHECK_HOVER },
    WizardStep { name: text::gravity::STEP_POSES, meaning: text::gravity::STEP_POSES_HOVER },
    WizardStep { name: text::wizards::STEP_RESULT, meaning: text::gravity::STEP_RESULT_HOVER },
    WizardStep { name: text::gravity::STEP_FREE_MOTION, meaning: text::gravity::STEP_FREE_MOTION_HOVER },
    WizardStep { name: text::wizards::STEP_SAVE, meaning: text::wizards::STEP_SAVE_HOVER },
];
// Positions in `STEPS`.
const CHECK: usize = 0;
const POSES: usize = 1;
const RESULT: usize = 2;
const FREE_MOTION: usize = 3;
/// While the result is good, a touch shorter than this counts as the hand releasing the tool, s.
const TOUCHED_S: f64 = 2.0;

#[derive(Debug)]
pub struct GravityWizard {
    session: GravitySession,
    precheck: Precheck,
    rate_hz: f64,
    frame: WizardFrame,
    phase: GravityPhase,
    held: Option<UnitQuaternion<f64>>,
    report: WizardReport<GravityReport>,
    pass: Option<CheckPass>,
    left_n: Option<f64>,
}

impl Default for GravityWizard {
    fn default() -> Self {
        Self::of(GravitySessionSettings::default())
    }
}

impl GravityWizard {
    /// Creates the state without data, for a rig with these settings.
    fn of(settings: GravitySessionSettings) -> Self {
        Self {
            session: GravitySession::new(settings),
            precheck: Precheck::new(settings),
            rate_hz: f64::INFINITY,
            frame: WizardFrame::default(),
            phase: GravityPhase::NoSample,
            held: None,
            report: None,
            pass: None,
            left_n: None,
        }
    }

    fn pose(&mut self, sample: &WristSample, t_s: f64) {
        let phase = self.session.step(sample, t_s);
        if matches!(phase, GravityPhase::Recorded { .. }) {
            self.fit();
        }
        self.phase = phase;
    }

    /// Results from other poses are no longer valid.
    fn fit(&mut self) {
        self.report = (self.session.poses().len() >= POSES_MIN)
            .then(|| self.session.report().map_err(|error| nima_words::report_text::quoted(&error)));
        // Check and file belong to the previous model.
        self.pass = None;
        self.frame.saved = None;
    }

    fn pass_result(&self) -> Option<PassResult> {
        self.pass.as_ref().map(CheckPass::result)
    }

    fn good_report(&self) -> Option<&GravityReport> {
        self.report.as_ref().and_then(|report| report.as_ref().ok())
    }

    fn check_ui(&mut self, ui: &mut Ui) {
        card(ui, text::gravity::CHECKS_TITLE, text::gravity::CHECKS_HOVER, |ui| {
            ui.label(text::gravity::CHECKS_TASK);
            ui.add_space(6.0);
            for check in self.precheck.checks(self.rate_hz) {
                check_ui(ui, &check);
            }
        });
        card(ui, text::wizards::OPTIONS_TITLE, text::wizards::OPTIONS_HOVER, |ui| {
            let GravitySessionSettings { use_arm, fit, .. } = *self.session.settings();
            let none_taken = self.session.poses().is_empty();
            let by_arm = text::gravity::OPTION_BY_ARM.get();
            let meaning = text::gravity::OPTION_BY_ARM_HOVER.get();
            // Only before the first pose, because poses with and without the arm's orientation do not mix.
            if let Some(use_arm) = switch_ui(ui, none_taken, use_arm, by_arm, meaning) {
                *self = Self::of(GravitySessionSettings { use_arm, ..*self.session.settings() });
            }
            let flipped = text::gravity::OPTION_FLIP_IMU.get();
            let meaning = text::gravity::OPTION_FLIP_IMU_HOVER.get();
            if let Some(flip) = switch_ui(ui, !use_arm, fit.imu_sign < 0, flipped, meaning) {
                self.session.set_imu_sign(if flip { -1 } else { 1 });
                self.precheck = Precheck::new(*self.session.settings());
                self.fit();
            }
        });
    }

    fn poses_ui(&mut self, ui: &mut Ui) {
        let count = self.session.poses().len();
        let met = self.session.targets_met();
        let target = self.session.target();
        card(ui, text::gravity::POSE_TITLE, text::gravity::POSE_HOVER, |ui| {
            let name = target.map_or(text::gravity::POSES_COMPLETE.get(), |target| target.name);
            ui.label(RichText::new(nima_words::report_text::sentence(name)).font(theme::strong(19.0)));
            let (fraction, words) = phase_text(&self.phase);
            progress(ui, text::gravity::POSE_PROGRESS.get(), fraction, &words);
            ui.add_space(6.0);
            let directions: Vec<Vector3<f64>> = TARGETS.iter().map(|target| Vector3::from(target.down_s1)).collect();
            let taken = self.session.taken_down_s1();
            let down_now = self.held.map(|held| held.inverse() * -Vector3::z());
            ui.horizontal_wrapped(|ui| {
                pose_image(ui, target.map(|target| target.world_from_s1()).as_ref(), self.held.as_ref());
                sphere_image(ui, text::gravity::DIRECTIONS_IMAGE.get(), &directions, &taken, down_now);
            });
            progress(
                ui,
                text::gravity::DIRECTIONS.get(),
                met as f64 / TARGETS.len() as f64,
                &text::gravity::recorded_of(met, TARGETS.len()),
            );
        });
        card(ui, text::wizards::SO_FAR, text::gravity::SO_FAR_HOVER, |ui| {
            figure(ui, text::gravity::STEP_POSES, count.to_string(), text::gravity::POSES_HOVER);
            if let Some(report) = self.good_report() {
                report_figures(ui, report);
            } else {
                ui.label(small(text::gravity::SO_FAR_EMPTY));
            }
            self.touched_ui(ui);
            let remove = ui.add_enabled(count > 0, Button::new(text::gravity::REMOVE_LAST));
            if remove.on_disabled_hover_text(text::wizards::NOTHING_RECORDED).clicked() {
                self.session.undo();
                self.fit();
            }
        });
    }

    /// Shows that the tool was touched, even afterwards.
    fn touched_ui(&self, ui: &mut Ui) {
        let touched_s = self.session.touched_s();
        let is_bad = self.good_report().is_some_and(|report| report.verdict != Verdict::Accepted);
        if touched_s >= TOUCHED_S || is_bad && touched_s > 0.0 {
            ui.label(text::gravity::was_touched(touched_s)).on_hover_text(text::gravity::WAS_TOUCHED_HOVER);
        }
    }

    fn result_ui(&self, ui: &mut Ui) {
        let otherwise = [text::gravity::NO_RESULT_HOVER.get(), text::gravity::NO_POSES.get()];
        result_ui(ui, self.report.as_ref(), otherwise, |ui, report| {
            verdict_ui(ui, report);
            self.touched_ui(ui);
            models_ui(ui, report);
        });
    }

    fn free_motion_ui(&mut self, ui: &mut Ui) {
        card(ui, text::gravity::FREE_MOTION_TITLE, text::gravity::FREE_MOTION_HOVER, |ui| {
            beside(ui, &Prompt::Wave, None, |ui| {
                ui.label(RichText::new(text::gravity::FREE_MOTION_TASK).font(theme::strong(19.0)));
                ui.add_space(4.0);
                let left =
                    self.left_n.map_or(text::gravity::NO_READING.get().to_owned(), |left_n| format!("{left_n:.2} N"));
                ui.label(RichText::new(left).font(theme::strong(34.0)));
            });
            let Some(result) = self.pass_result() else { return };
            figure(ui, text::gravity::MEAN, format!("{:.3} N", result.mean_n), text::gravity::MEAN_HOVER);
            figure(
                ui,
                text::gravity::P95,
                text::gravity::of_allowed(result.p95_n, FREE_MOTION_LIMIT_N),
                text::gravity::P95_HOVER,
            );
            figure(
                ui,
                text::gravity::TILT,
                format!("{:.0} deg", result.tilt_rad.to_degrees()),
                text::gravity::TILT_HOVER,
            );
            let words = if result.passed { text::gravity::PASSED.get() } else { text::gravity::NOT_PASSED.get() };
            judged_line(ui, result.passed, &format!("{words}: {}", result.reason));
            if ui.button(text::gravity::MEASURE_AGAIN).clicked() {
                self.pass = None;
                self.go_to(FREE_MOTION);
            }
        });
    }

    /// Returns whether the result is good enough to be saved without an override.
    fn is_proven(&self) -> bool {
        self.good_report().is_some_and(|report| report.verdict == Verdict::Accepted)
            && self.pass_result().is_some_and(|result| result.passed)
    }
}

impl Wizard for GravityWizard {
    fn steps(&self) -> &'static [WizardStep] {
        &STEPS
    }

    fn frame_mut(&mut self) -> &mut WizardFrame {
        &mut self.frame
    }

    fn tick(&mut self, tick: &Tick, rate_hz: f64) {
        self.rate_hz = rate_hz;
        if self.frame.step == CHECK {
            self.precheck.step(tick.calibration.wrist.as_ref(), tick.t_s);
        }
        let Some(sample) = &tick.calibration.wrist else {
            self.phase = GravityPhase::NoSample;
            return;
        };
        self.held = sample.world_from_s1;
        match self.frame.step {
            POSES => self.pose(sample, tick.t_s),
            FREE_MOTION => self.left_n = self.pass.as_mut().and_then(|pass| pass.step(sample)),
            _ => {}
        }
    }

    fn prompt(&self) -> Prompt {
        match (self.frame.step, self.session.target()) {
            (POSES, Some(target)) => Prompt::Hold { world_from_s1: target.world_from_s1() },
            (FREE_MOTION, _) => Prompt::Wave,
            _ => Prompt::Rest,
        }
    }

    fn may_go_on(&self, _: &Binding) -> Result<(), &'static str> {
        match self.frame.step {
            CHECK if self.precheck.passed(self.rate_hz) => Ok(()),
            CHECK => Err(text::wizards::NEEDS_CHECKS.get()),
            POSES if self.session.poses().len() >= POSES_MIN => Ok(()),
            POSES => Err(text::gravity::NEEDS_POSES.get()),
            RESULT if self.good_report().is_some_and(|report| report.chosen_fit().is_some()) => Ok(()),
            RESULT => Err(text::gravity::NEEDS_MODEL.get()),
            FREE_MOTION if self.pass_result().is_some_and(|result| result.samples > 0) => Ok(()),
            FREE_MOTION => Err(text::gravity::NEEDS_FREE_MOTION.get()),
            _ => Err(text::wizards::LAST_STEP.get()),
        }
    }

    fn is_done(&self) -> bool {
        match self.frame.step {
            POSES => self.session.target().is_none(),
            FREE_MOTION => self.pass_result().is_some_and(|result| result.samples >= FREE_MOTION_SAMPLES),
            _ => true,
        }
    }

    /// A sensor of the wrong sign never reaches all poses, and the result says so.
    fn may_go_early(&self) -> bool {
        self.frame.step == POSES
    }

    fn step_ui(&mut self, ui: &mut Ui, _: &Binding) -> Option<WizardRequest> {
        match self.frame.step {
            CHECK => self.check_ui(ui),
            POSES => self.poses_ui(ui),
            RESULT => self.result_ui(ui),
            _ => self.free_motion_ui(ui),
        }
        None
    }

    fn proof(&self) -> Option<String> {
        self.is_proven().then(|| text::gravity::PROOF.get().to_owned())
    }

    fn made(&self, binding: &Binding) -> Option<SaveRequest> {
        let record = self.good_report()?.record(&binding.sensor, &binding.tool, &binding.date)?;
        Some(SaveRequest::Gravity(Box::new(record)))
    }

    fn go_to(&mut self, step: usize) {
        self.frame.step = step;
        if step == RESULT && self.report.is_none() {
            // With too few poses this is the error, which the page shows.
            self.report = Some(self.session.report().map_err(|error| nima_words::report_text::quoted(&error)));
        }
        if step == FREE_MOTION && self.pass.is_none() {
            let model = self.good_report().and_then(GravityReport::chosen_fit).map(|fit| fit.model);
            self.pass = model.map(|model| {
                CheckPass::new(
                    Compensator::new(model, DEFAULT_TIME_CONSTANT_S, 1.0 / self.rate_hz),
                    FREE_MOTION_LIMIT_N,
                )
            });
        }
    }

    fn start_over(&mut self) {
        *self = Self::of(*self.session.settings());
    }
}

fn phase_text(phase: &GravityPhase) -> (f64, String) {
    match phase {
        GravityPhase::NoSample => (0.0, text::gravity::PHASE_NO_SAMPLE.get().to_owned()),
        GravityPhase::Moving => (0.0, text::gravity::PHASE_MOVING.get().to_owned()),
        GravityPhase::Disturbed => (0.0, text::gravity::PHASE_DISTURBED.get().to_owned()),
        GravityPhase::TakenHere => (0.0, text::gravity::PHASE_SAME_POSE.get().to_owned()),
        GravityPhase::Recording { fraction } => (*fraction, text::gravity::PHASE_RECORDING.get().to_owned()),
        GravityPhase::Recorded { index } => (1.0, text::gravity::pose_taken(index + 1)),
        GravityPhase::Touched { by_n } => (0.0, text::gravity::touched(*by_n)),
    }
}
