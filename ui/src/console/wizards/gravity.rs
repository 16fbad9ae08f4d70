//! The gravity wizard: check, twelve poses, result, free motion, save. What was good is kept at every step back and on closing.

use crate::console::text;
use egui::{Button, Grid, RichText, Ui, vec2};
use nalgebra::{UnitQuaternion, Vector3};
use nima::{
    calibration::{
        Verdict,
        gravity::{
            CheckPass, Compensator, DEFAULT_TIME_CONSTANT_S, GravityRecord, GravityReport, GravitySession, ModelFit,
            PassResult, Phase, Precheck, SessionSettings, TARGETS,
        },
    },
    device::Prompt,
    frames::WristSample,
    runtime::Tick,
};

use super::{
    Binding, Step,
    checks::{check_ui, switch_ui},
    pictures::{pose_picture, progress, sphere_picture},
    save_card, steps_ui,
};
use crate::console::{
    theme,
    widgets::{card, figure, small, three_digits},
};

/// Free motion must read below this at its 95th percentile, N: noise of a sample included.
const FREE_MOTION_LIMIT_N: f64 = 0.25;
/// Fewest poses from which a fit is tried.
const POSES_MIN: usize = 6;
/// Steps of this wizard.
const STEPS: [Step; 5] = [
    Step { name: text::gravity::CHECK, meaning: text::gravity::DOES_THE_SENSOR_DELIVER },
    Step { name: text::gravity::POSES, meaning: text::gravity::TWELVE_ORIENTATIONS_THAT_SHOW },
    Step { name: text::gravity::RESULT, meaning: text::gravity::THE_FIT_JUDGED_ON },
    Step { name: text::gravity::FREE_MOTION, meaning: text::gravity::THE_PROOF_A_TOOL },
    Step { name: text::gravity::SAVE, meaning: text::gravity::KEPT_FOR_THIS_SENSOR },
];
const CHECK: usize = 0;
const POSES: usize = 1;
const RESULT: usize = 2;
const FREE_MOTION: usize = 3;

/// The wizard's memory.
#[derive(Debug)]
pub struct GravityWizard {
    session: GravitySession,
    precheck: Precheck,
    rate_hz: f64,
    step: usize,
    phase: Phase,
    held: Option<UnitQuaternion<f64>>,
    report: Option<Result<GravityReport, String>>,
    pass: Option<CheckPass>,
    left_n: Option<f64>,
    name: String,
    why: String,
    saved: Option<String>,
}

impl Default for GravityWizard {
    fn default() -> Self {
        Self::of(SessionSettings::default())
    }
}

impl GravityWizard {
    /// Nothing taken yet, on a rig that is built so.
    fn of(settings: SessionSettings) -> Self {
        Self {
            session: GravitySession::new(settings),
            precheck: Precheck::new(settings),
            rate_hz: f64::INFINITY,
            step: CHECK,
            phase: Phase::NoSample,
            held: None,
            report: None,
            pass: None,
            left_n: None,
            name: String::new(),
            why: String::new(),
            saved: None,
        }
    }

    /// Takes in one tick of a loop of this rate (Hz).
    pub fn tick(&mut self, tick: &Tick, rate_hz: f64) {
        self.rate_hz = rate_hz;
        if self.step == CHECK {
            self.precheck.step(tick.wrist.as_ref(), tick.t_s);
        }
        let Some(sample) = &tick.wrist else {
            self.phase = Phase::NoSample;
            return;
        };
        self.held = sample.kbf_from_s1;
        match self.step {
            POSES => self.pose(sample, tick.t_s),
            FREE_MOTION => self.left_n = self.pass.as_mut().and_then(|pass| pass.step(sample)),
            _ => {}
        }
    }

    fn pose(&mut self, sample: &WristSample, t_s: f64) {
        let phase = self.session.step(sample, t_s);
        if matches!(phase, Phase::Recorded { .. }) {
            self.fit();
        }
        self.phase = phase;
    }

    /// What was concluded from other poses does not hold any more.
    fn fit(&mut self) {
        self.report =
            (self.session.poses().len() >= POSES_MIN).then(|| self.session.report().map_err(|error| error.to_string()));
        self.pass = None;
        self.saved = None;
    }

    /// What the person at the arm is to do now.
    pub fn prompt(&self) -> Prompt {
        match (self.step, self.session.target()) {
            (POSES, Some(target)) => Prompt::Hold { kbf_from_s1: target.kbf_from_s1() },
            (FREE_MOTION, _) => Prompt::Wave,
            _ => Prompt::Rest,
        }
    }

    /// Tells what became of the record that was handed out for saving.
    pub fn tell_saved(&mut self, words: String) {
        self.saved = Some(words);
    }

    fn pass_result(&self) -> Option<PassResult> {
        self.pass.as_ref().map(CheckPass::result)
    }

    fn good_report(&self) -> Option<&GravityReport> {
        self.report.as_ref().and_then(|report| report.as_ref().ok())
    }

    /// Whether the step after this one may begin, or why not.
    fn may_go_on(&self) -> Result<(), &'static str> {
        match self.step {
            CHECK if self.precheck.passed(self.rate_hz) => Ok(()),
            CHECK => Err(text::gravity::A_CHECK_IS_NOT),
            POSES if self.session.poses().len() >= POSES_MIN => Ok(()),
            POSES => Err(text::gravity::AT_LEAST_SIX_POSES),
            RESULT if self.good_report().is_some_and(|report| report.chosen_fit().is_some()) => Ok(()),
            RESULT => Err(text::gravity::THERE_IS_NO_MODEL),
            FREE_MOTION if self.pass_result().is_some_and(|result| result.samples > 0) => Ok(()),
            FREE_MOTION => Err(text::gravity::NOTHING_WAS_MEASURED_IN),
            _ => Err(text::gravity::THIS_IS_THE_LAST),
        }
    }

    fn go_to(&mut self, step: usize) {
        self.step = step;
        if step == RESULT && self.report.is_none() {
            self.report = Some(self.session.report().map_err(|error| error.to_string()));
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

    /// The wizard; gives a record that shall be saved.
    pub fn ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<GravityRecord> {
        let wish = steps_ui(ui, &STEPS, self.step, self.may_go_on());
        ui.add_space(theme::GAP);
        let mut save = None;
        match self.step {
            CHECK => self.check_ui(ui),
            POSES => self.poses_ui(ui),
            RESULT => self.result_ui(ui),
            FREE_MOTION => self.free_motion_ui(ui),
            _ => save = self.save_ui(ui, binding),
        }
        match wish {
            Some(super::Wish::GoTo(step)) => self.go_to(step),
            Some(super::Wish::StartOver) => *self = Self::of(*self.session.settings()),
            None => {}
        }
        save
    }

    fn check_ui(&mut self, ui: &mut Ui) {
        card(ui, text::gravity::BEFORE_THE_FIRST_POSE, text::gravity::ALL_MUST_BE_MET, |ui| {
            ui.label(text::gravity::TAKE_THE_INSTRUMENT_OUT);
            ui.add_space(6.0);
            for check in self.precheck.checks(self.rate_hz) {
                check_ui(ui, &check);
            }
        });
        card(ui, text::gravity::HOW_THIS_RIG_IS, text::gravity::LEAVE_BOTH_OFF_UNLESS, |ui| {
            let SessionSettings { use_arm, fit, .. } = *self.session.settings();
            let none_taken = self.session.poses().is_empty();
            let by_arm = text::gravity::TAKE_THE_ORIENTATION_FROM;
            let meaning = text::gravity::FOR_SENSORS_WITHOUT_AN;
            if let Some(use_arm) = switch_ui(ui, none_taken, use_arm, by_arm, meaning) {
                *self = Self::of(SessionSettings { use_arm, ..*self.session.settings() });
            }
            let flipped = text::gravity::THE_ACCELEROMETER_POINTS_TO;
            let meaning = text::gravity::SOME_DRIVERS_TELL_GRAVITY;
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
        card(ui, text::gravity::TAKE_THIS_POSE, text::gravity::TURN_THE_TOOL_AS, |ui| {
            let name = target.map_or(text::gravity::ALL_DIRECTIONS_ARE_TAKEN, |target| target.name);
            ui.label(RichText::new(crate::console::alarms::sentence(name)).font(theme::strong(19.0)));
            let (share, words) = phase_words(&self.phase);
            progress(ui, text::gravity::POSE, share, &words);
            ui.add_space(6.0);
            let directions: Vec<Vector3<f64>> = TARGETS.iter().map(|target| Vector3::from(target.down_s1)).collect();
            let taken = self.session.taken_down_s1();
            let down_now = self.held.map(|held| held.inverse() * -Vector3::z());
            ui.horizontal_wrapped(|ui| {
                pose_picture(ui, target.map(|target| target.kbf_from_s1()).as_ref(), self.held.as_ref());
                sphere_picture(ui, text::gravity::DIRECTIONS_OF_GRAVITY, &directions, &taken, down_now);
            });
            progress(
                ui,
                text::gravity::DIRECTIONS,
                met as f64 / TARGETS.len() as f64,
                &format!("{met} of {} taken", TARGETS.len()),
            );
        });
        card(ui, "So far", text::gravity::THE_FIT_IS_MADE, |ui| {
            figure(ui, text::gravity::POSES, count.to_string(), text::gravity::POSES_TAKEN_AND_KEPT);
            if let Some(report) = self.good_report() {
                report_figures(ui, report);
            } else {
                ui.label(small(text::gravity::A_FIRST_FIT_IS));
            }
            if ui.add_enabled(count > 0, Button::new(text::gravity::REMOVE_THE_LAST_POSE)).clicked() {
                self.session.undo();
                self.fit();
            }
        });
    }

    fn result_ui(&self, ui: &mut Ui) {
        match &self.report {
            Some(Ok(report)) => {
                verdict_ui(ui, report);
                models_ui(ui, report);
            }
            Some(Err(error)) => {
                card(ui, "No result", text::gravity::THE_POSES_COULD_NOT, |ui| ui.label(error));
            }
            None => {
                ui.label(text::gravity::THERE_ARE_NO_POSES);
            }
        }
    }

    fn free_motion_ui(&mut self, ui: &mut Ui) {
        card(ui, text::gravity::MOVE_THE_TOOL_FREELY, text::gravity::NOTHING_MAY_TOUCH_IT, |ui| {
            ui.label(text::gravity::TURN_THE_TOOL_SLOWLY);
            ui.add_space(4.0);
            let left = self.left_n.map_or("no reading".to_owned(), |left_n| format!("{left_n:.2} N"));
            ui.label(RichText::new(left).font(theme::strong(34.0)));
            let Some(result) = self.pass_result() else { return };
            figure(ui, text::gravity::MEAN, format!("{:.3} N", result.mean_n), text::gravity::MEAN_SIZE_OF_WHAT);
            figure(
                ui,
                "95 % below",
                format!("{:.2} N of {FREE_MOTION_LIMIT_N} N allowed", result.p95_n),
                text::gravity::THE_NOISE_OF_SINGLE,
            );
            figure(
                ui,
                text::gravity::TILT_COVERED,
                format!("{:.0} deg", result.tilt_rad.to_degrees()),
                text::gravity::AT_LEAST_45_DEGREES,
            );
            let words = if result.passed { text::gravity::PASSED } else { text::gravity::NOT_PASSED_YET };
            ui.label(RichText::new(format!("{words}: {}", result.reason)).font(theme::strong(15.0)));
            if ui.button(text::gravity::MEASURE_AGAIN).clicked() {
                self.pass = None;
                self.go_to(FREE_MOTION);
            }
        });
    }

    /// Good enough to be saved without anyone's word for it.
    fn is_proven(&self) -> bool {
        self.good_report().is_some_and(|report| report.verdict == Verdict::Accepted)
            && self.pass_result().is_some_and(|result| result.passed)
    }

    fn save_ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<GravityRecord> {
        let proven = self.is_proven();
        let proof = proven.then_some(text::gravity::ACCEPTED_AND_PROVEN_IN);
        let wanted = save_card(ui, binding, proof, [&mut self.name, &mut self.why], self.saved.as_deref());
        wanted.then(|| self.record(binding, proven)).flatten()
    }

    fn record(&self, binding: &Binding, proven: bool) -> Option<GravityRecord> {
        let mut record = self.good_report()?.record(&binding.sensor, &binding.tool, &binding.date)?;
        if !proven {
            record.override_by = Some(self.name.trim().to_owned());
            record.override_reason = Some(self.why.trim().to_owned());
        }
        Some(record)
    }
}

fn phase_words(phase: &Phase) -> (f64, String) {
    match phase {
        Phase::NoSample => (0.0, text::gravity::NO_VALID_SAMPLE_FROM.to_owned()),
        Phase::Moving => (0.0, text::gravity::MOVING_HOLD_THE_TOOL.to_owned()),
        Phase::Disturbed => (0.0, text::gravity::THE_FORCE_IS_NOT.to_owned()),
        Phase::TakenHere => (0.0, text::gravity::TAKEN_HERE_ALREADY_TURN.to_owned()),
        Phase::Recording { share } => (*share, text::gravity::STILL_BEING_TAKEN.to_owned()),
        Phase::Recorded { index } => (1.0, text::gravity::pose_taken(index + 1)),
        Phase::Touched { by_n } => (0.0, text::gravity::touched(*by_n)),
    }
}

fn report_figures(ui: &mut Ui, report: &GravityReport) {
    let words = format!("{}: {}", report.verdict.words(), report.reason);
    ui.label(RichText::new(words).font(theme::strong(14.0)));
    figure(ui, text::gravity::COVERAGE, format!("{:.2}", report.coverage), text::gravity::SHARE_OF_ALL_DIRECTIONS);
    if let Some(mass_kg) = report.mass_kg {
        figure(ui, text::gravity::MASS, format!("{mass_kg:.3} kg"), text::gravity::OF_WHAT_HANGS_ON);
    }
}

fn verdict_ui(ui: &mut Ui, report: &GravityReport) {
    card(ui, report.verdict.words(), text::gravity::JUDGED_ON_POSES_THAT, |ui| {
        ui.label(&report.reason);
        ui.add_space(4.0);
        figure(ui, text::gravity::POSES, report.poses.to_string(), text::gravity::POSES_THAT_WERE_FITTED);
        figure(ui, text::gravity::COVERAGE, format!("{:.2}", report.coverage), text::gravity::SHARE_OF_ALL_DIRECTIONS);
        let condition = report.condition.map_or("undetermined".to_owned(), three_digits);
        figure(ui, text::gravity::CONDITION, condition, text::gravity::HOW_EVENLY_THE_POSES);
        if let (Some(mass_kg), Some(com_m)) = (report.mass_kg, report.com_m) {
            figure(ui, text::gravity::MASS, format!("{mass_kg:.3} kg"), text::gravity::OF_WHAT_HANGS_ON);
            let [x, y, z] = com_m.map(|m| m * 1e3);
            figure(
                ui,
                text::gravity::CENTRE_OF_MASS,
                format!("{x:.1}, {y:.1}, {z:.1} mm"),
                text::gravity::IN_THE_SENSOR_S,
            );
        }
        if !report.outliers.is_empty() {
            let list = report.outliers.iter().map(|i| (i + 1).to_string()).collect::<Vec<_>>().join(", ");
            figure(ui, text::gravity::LEFT_OUT, text::gravity::left_out(&list), text::gravity::FAR_FROM_WHAT_THE);
        }
    });
}

/// The models side by side, on the poses of the fit and on those held out.
fn models_ui(ui: &mut Ui, report: &GravityReport) {
    card(ui, text::gravity::MODELS_SIDE_BY_SIDE, text::gravity::FORCE_ERRORS_IN_N, |ui| {
        Grid::new("gravity_models").num_columns(5).spacing(vec2(22.0, 6.0)).show(ui, |ui| {
            for head in
                [text::gravity::MODEL, text::gravity::FITTED_MEAN, "largest", text::gravity::HELD_OUT_MEAN, "largest"]
            {
                ui.label(small(head));
            }
            ui.end_row();
            for fit in &report.fits {
                model_row(ui, fit, report.chosen == Some(fit.kind));
            }
        });
    });
}

fn model_row(ui: &mut Ui, fit: &ModelFit, chosen: bool) {
    let name = crate::console::alarms::sentence(fit.kind.name());
    ui.label(if chosen {
        RichText::new(format!("{name} (chosen)")).font(theme::strong(14.0))
    } else {
        RichText::new(name)
    });
    for stats in [&fit.force_n.fitted, &fit.force_n.held_out] {
        ui.label(format!("{:.3}", stats.mean_mae()));
        ui.label(format!("{:.3}", stats.largest()));
    }
    ui.end_row();
}
