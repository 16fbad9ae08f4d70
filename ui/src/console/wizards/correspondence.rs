//! The correspondence wizard: check, pushes, result, save. Pushes are kept at every step back and on closing.

use crate::console::text;
use egui::{Button, Grid, RichText, Ui, vec2};
use nalgebra::UnitVector3;
use nima::{
    calibration::{
        Verdict,
        correspondence::{
            Agreement, CorrespondenceRecord, CorrespondenceReport, CorrespondenceSession, Missing, OffsetFrame, Phase,
            PushTarget, SessionSettings, Solution, TARGETS,
        },
    },
    device::Prompt,
    runtime::Tick,
};

use super::{
    Binding, Step, Wish,
    checks::{check_line, switch_ui},
    pictures::{progress, sphere_picture},
    save_card, steps_ui,
};
use crate::console::{
    alarms::sentence,
    theme,
    widgets::{card, figure, small, three_digits},
};

/// Fewest pushes from which a fit is shown.
const PUSHES_MIN: usize = 6;
/// As many are asked for: one in each direction.
const PUSHES_ASKED: usize = TARGETS.len();
/// Steps of this wizard.
const STEPS: [Step; 4] = [
    Step { name: text::correspondence::CHECK, meaning: text::correspondence::IS_EVERYTHING_THERE_AND },
    Step { name: text::correspondence::PUSHES, meaning: text::correspondence::THE_TOOL_PUSHES_THE },
    Step { name: text::correspondence::RESULT, meaning: text::correspondence::THE_ROTATION_JUDGED_ON },
    Step { name: text::correspondence::SAVE, meaning: text::correspondence::KEPT_FOR_THIS_SENSOR },
];
const CHECK: usize = 0;
const PUSHES: usize = 1;
const RESULT: usize = 2;

/// What came with the wrist's sample in the last tick.
#[derive(Clone, Copy, Debug, Default)]
struct Sources {
    gravity: bool,
    tissue: bool,
    chain: bool,
}

/// The wizard's memory.
#[derive(Debug)]
pub struct CorrespondenceWizard {
    session: CorrespondenceSession,
    step: usize,
    /// `None` while the wrist sensor is silent.
    sources: Option<Sources>,
    /// The loop's clock begins anew with every start of it; the session's goes on.
    clock_s: (f64, f64),
    report: Option<Result<CorrespondenceReport, String>>,
    name: String,
    why: String,
    saved: Option<String>,
}

impl Default for CorrespondenceWizard {
    fn default() -> Self {
        Self::of(SessionSettings::default())
    }
}

impl CorrespondenceWizard {
    /// Nothing taken yet, on a rig that is built so.
    fn of(settings: SessionSettings) -> Self {
        Self {
            session: CorrespondenceSession::new(settings),
            step: CHECK,
            sources: None,
            clock_s: (0.0, 0.0),
            report: None,
            name: String::new(),
            why: String::new(),
            saved: None,
        }
    }

    /// Takes in one tick of the loop. Pushes are kept in their own step only.
    pub fn tick(&mut self, tick: &Tick) {
        let Some(sample) = &tick.wrist else {
            self.sources = None;
            return;
        };
        let mut f1_n = tick.force.gravity_free.map(|wrench| wrench.force_n);
        self.sources = Some(Sources {
            gravity: f1_n.is_some(),
            tissue: sample.tissue_n.is_some(),
            chain: sample.s1_from_c().is_some(),
        });
        let (begin_s, last_s) = self.clock_s;
        let mut now_s = begin_s + tick.t_s;
        if now_s < last_s {
            // The loop was started anew: a push that was on has a hole, and is lost.
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
        if self.step == PUSHES {
            self.fit();
        } else {
            self.session.undo();
        }
    }

    fn fit(&mut self) {
        let enough = self.session.pushes() >= PUSHES_MIN;
        self.report = enough.then(|| self.session.report().map_err(|error| error.to_string()));
        self.saved = None;
    }

    /// The direction to ask for: first those that nobody pushed in yet, then all of them in turn.
    fn wanted(&self) -> PushTarget {
        self.session.target().unwrap_or(TARGETS[self.session.pushes() % TARGETS.len()])
    }

    /// What the person at the arm is to do now.
    pub fn prompt(&self) -> Prompt {
        if self.step == PUSHES {
            return Prompt::Push { direction: UnitVector3::new_normalize(self.wanted().push_in_kbf) };
        }
        Prompt::Rest
    }

    /// Tells what became of the record that was handed out for saving.
    pub fn tell_saved(&mut self, words: String) {
        self.saved = Some(words);
    }

    fn good_report(&self) -> Option<&CorrespondenceReport> {
        self.report.as_ref().and_then(|report| report.as_ref().ok())
    }

    fn solution(&self) -> Option<&Solution> {
        self.good_report().and_then(|report| report.solution.as_ref())
    }

    /// All sources are there, and both sensors have rested.
    fn may_push(&self) -> Result<(), &'static str> {
        let Some(sources) = self.sources else { return Err(text::correspondence::THE_WRIST_SENSOR_IS) };
        match self.session.phase() {
            _ if !sources.gravity => Err(text::correspondence::GRAVITY_IS_NOT_IN),
            Phase::Missing(_) => Err(text::correspondence::A_CHECK_IS_NOT),
            Phase::Resting { .. } => Err(text::correspondence::BOTH_SENSORS_MUST_REST),
            _ => Ok(()),
        }
    }

    /// Whether the step after this one may begin, or why not.
    fn may_go_on(&self) -> Result<(), &'static str> {
        match self.step {
            CHECK => self.may_push(),
            PUSHES if self.session.pushes() >= PUSHES_MIN => Ok(()),
            PUSHES => Err(text::correspondence::AT_LEAST_SIX_PUSHES),
            RESULT if self.solution().is_some() => Ok(()),
            RESULT => Err(text::correspondence::THERE_IS_NO_ROTATION),
            _ => Err(text::correspondence::THIS_IS_THE_LAST),
        }
    }

    /// The wizard; gives a record that shall be saved.
    pub fn ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<CorrespondenceRecord> {
        let wish = steps_ui(ui, &STEPS, self.step, self.may_go_on());
        ui.add_space(theme::GAP);
        let mut save = None;
        match self.step {
            CHECK => self.check_ui(ui),
            PUSHES => self.pushes_ui(ui),
            RESULT => self.result_ui(ui),
            _ => save = self.save_ui(ui, binding),
        }
        match wish {
            Some(Wish::GoTo(step)) => self.step = step,
            Some(Wish::StartOver) => self.start_over(*self.session.settings()),
            None => {}
        }
        save
    }

    fn start_over(&mut self, settings: SessionSettings) {
        *self = Self { clock_s: self.clock_s, ..Self::of(settings) };
    }

    fn check_ui(&mut self, ui: &mut Ui) {
        card(ui, text::correspondence::BEFORE_THE_FIRST_PUSH, text::correspondence::ALL_FOUR_MUST_BE, |ui| {
            ui.label(text::correspondence::LAY_THE_TISSUE_ON);
            ui.add_space(6.0);
            let Sources { gravity, tissue, chain } = self.sources.unwrap_or_default();
            check_line(ui, text::correspondence::FORCE_AT_THE_WRIST, gravity, Missing::WristForce.words());
            check_line(ui, text::correspondence::FORCE_UNDER_THE_TISSUE, tissue, Missing::TissueForce.words());
            let tracker = if self.session.settings().chain {
                text::correspondence::ARM_AND_TRACKER
            } else {
                text::correspondence::ARM_AND_TRACKER_NOT
            };
            check_line(ui, tracker, chain || !self.session.settings().chain, Missing::Chain.words());
            let (_, words) = phase_words(&self.session.phase());
            check_line(ui, text::correspondence::REST, self.may_push().is_ok(), &words);
        });
        card(ui, text::correspondence::HOW_THIS_RIG_IS, text::correspondence::LEAVE_BOTH_OFF_UNLESS, |ui| {
            let SessionSettings { chain, options, .. } = *self.session.settings();
            let flip = text::correspondence::THE_SENSOR_UNDER_THE;
            let meaning = text::correspondence::AS_SCALES_DO_BOTH;
            if let Some(flip_s2) = switch_ui(ui, true, options.flip_s2, flip, meaning) {
                self.session.set_flip_s2(flip_s2);
                self.fit();
            }
            let alone = text::correspondence::NO_TRACKER_THE_WRIST;
            let meaning = text::correspondence::THE_ROTATION_THEN_HOLDS;
            if let Some(alone) = switch_ui(ui, self.session.pushes() == 0, !chain, alone, meaning) {
                self.start_over(SessionSettings { chain: !alone, ..*self.session.settings() });
            }
        });
    }

    fn pushes_ui(&mut self, ui: &mut Ui) {
        let count = self.session.pushes();
        let wanted = self.wanted();
        card(ui, text::correspondence::PUSH_THIS_WAY, text::correspondence::PUSH_THE_TISSUE_HOLD, |ui| {
            ui.label(RichText::new(sentence(wanted.name)).font(theme::strong(19.0)));
            let (share, words) = if self.sources.is_some() {
                phase_words(&self.session.phase())
            } else {
                (0.0, text::correspondence::THE_WRIST_SENSOR_IS_SILENT.to_owned())
            };
            progress(ui, text::correspondence::PUSH, share, &words);
            ui.add_space(6.0);
            let directions = TARGETS.map(|target| target.push_in_kbf);
            let taken = self.session.taken_in_kbf();
            sphere_picture(
                ui,
                text::correspondence::DIRECTIONS_OF_PUSHES,
                &directions,
                &taken,
                Some(wanted.push_in_kbf),
            );
            let share = count as f64 / PUSHES_ASKED as f64;
            progress(ui, text::correspondence::PUSHES, share, &text::correspondence::taken_of(count, PUSHES_ASKED));
        });
        card(ui, text::correspondence::SO_FAR, text::correspondence::THE_FIT_IS_MADE, |ui| {
            figure(
                ui,
                text::correspondence::TAKEN,
                text::correspondence::pushes(count),
                text::correspondence::PUSHES_TAKEN_AND_KEPT,
            );
            match &self.report {
                Some(Ok(report)) => {
                    let words = format!("{}: {}", report.verdict.words(), report.reason);
                    ui.label(RichText::new(words).font(theme::strong(14.0)));
                }
                Some(Err(error)) => {
                    ui.label(error);
                }
                None => {
                    ui.label(small(text::correspondence::A_FIRST_FIT_IS));
                }
            }
            if ui.add_enabled(count > 0, Button::new(text::correspondence::REMOVE_THE_LAST_PUSH)).clicked() {
                self.session.undo();
                self.fit();
            }
        });
    }

    fn result_ui(&self, ui: &mut Ui) {
        match &self.report {
            Some(Ok(report)) => {
                verdict_ui(ui, report);
                if let Some(solution) = &report.solution {
                    agreement_ui(ui, &solution.agreement);
                }
            }
            Some(Err(error)) => {
                card(ui, "No result", text::correspondence::THE_PUSHES_COULD_NOT, |ui| ui.label(error));
            }
            None => {
                ui.label(text::correspondence::THERE_ARE_TOO_FEW);
            }
        }
    }

    fn save_ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<CorrespondenceRecord> {
        let accepted = self.good_report().is_some_and(|report| report.verdict == Verdict::Accepted);
        let proof = accepted.then_some(text::correspondence::ACCEPTED_ON_PUSHES_THAT);
        let wanted = save_card(ui, binding, proof, [&mut self.name, &mut self.why], self.saved.as_deref());
        wanted.then(|| self.record(binding, accepted)).flatten()
    }

    fn record(&self, binding: &Binding, accepted: bool) -> Option<CorrespondenceRecord> {
        let flip_s2 = self.session.settings().options.flip_s2;
        let mut record = CorrespondenceRecord::of(self.good_report()?, &binding.sensor, &binding.tool, flip_s2)?;
        if !accepted {
            record.override_by = Some(self.name.trim().to_owned());
            record.override_reason = Some(self.why.trim().to_owned());
        }
        Some(record)
    }
}

/// How far the push is, and what to do.
fn phase_words(phase: &Phase) -> (f64, String) {
    match phase {
        Phase::Missing(missing) => (0.0, missing.words().to_owned()),
        Phase::Resting { share, f1_n, f2_n } => (*share, text::correspondence::at_rest(*f1_n, *f2_n)),
        Phase::Ready => (0.0, text::correspondence::READY_PUSH_NOW.to_owned()),
        Phase::Pushing { force_n, enough: false } => (0.5, text::correspondence::hold(*force_n)),
        Phase::Pushing { force_n, enough: true } => (1.0, text::correspondence::let_go(*force_n)),
        Phase::Recorded(index) => (1.0, text::correspondence::push_taken(index + 1)),
        Phase::Refused(refusal) => (0.0, text::correspondence::not_taken(&refusal.words())),
    }
}

fn verdict_ui(ui: &mut Ui, report: &CorrespondenceReport) {
    card(ui, report.verdict.words(), text::correspondence::JUDGED_ON_PUSHES_THAT, |ui| {
        ui.label(&report.reason);
        ui.add_space(4.0);
        let (left_out, weak) = (report.outliers.len(), report.weak.len());
        let pushes = text::correspondence::used(report.pairs, left_out, weak);
        figure(ui, text::correspondence::PUSHES, pushes, text::correspondence::ALL_THAT_WERE_TAKEN);
        let spread = format!("{:.2}, {:.2}", report.excitation.second, report.excitation.third);
        figure(ui, text::correspondence::SPREAD, spread, text::correspondence::SECOND_AND_THIRD_AXIS);
        let Some(solution) = &report.solution else { return };
        let [roll, pitch, yaw] = solution.roll_pitch_yaw_deg;
        let name = text::correspondence::rotation(solution.target.name());
        figure(ui, &name, format!("{roll:.2}, {pitch:.2}, {yaw:.2} deg"), text::correspondence::ROLL_PITCH_YAW_RZ);
        figure(
            ui,
            text::correspondence::UNCERTAINTY,
            format!("{:.2} deg", solution.uncertainty_deg),
            text::correspondence::EXPECTED_ANGLE_OF_ITS,
        );
        let check = format!("{:.3} deg", solution.cross_check_deg);
        figure(ui, text::correspondence::EULER_CROSS_CHECK, check, text::correspondence::ANGLE_TO_WHAT_THE);
        if let Some(diagnosis) = &solution.diagnosis {
            let gain = format!("{:.3} +- {:.3}", diagnosis.gain, diagnosis.gain_se);
            figure(ui, text::correspondence::GAIN, gain, text::correspondence::FORCE_OF_THE_WRIST);
            let offset = format!("{:.3} +- {:.3} N", diagnosis.offset_norm_n(), diagnosis.offset_se_n);
            figure(
                ui,
                text::correspondence::OFFSET,
                format!("{offset} ({})", frame_words(diagnosis.offset_frame)),
                text::correspondence::CONSTANT_BETWEEN_BOTH,
            );
        }
    });
}

const fn frame_words(frame: OffsetFrame) -> &'static str {
    match frame {
        OffsetFrame::S1 => text::correspondence::OF_THE_WRIST_SENSOR,
        OffsetFrame::S2 => text::correspondence::OF_THE_TISSUE_SENSOR,
        OffsetFrame::Unknown => text::correspondence::OF_EITHER_SENSOR,
    }
}

/// The paper's Validation I: how well the rotated force under the tissue tells that at the wrist.
fn agreement_ui(ui: &mut Ui, agreement: &Agreement) {
    let meaning = text::correspondence::ERRORS_IN_N_IN;
    card(ui, text::correspondence::AGREEMENT_PER_AXIS, meaning, |ui| {
        Grid::new("agreement").num_columns(7).spacing(vec2(22.0, 6.0)).show(ui, |ui| {
            for head in [
                text::correspondence::AXIS,
                text::correspondence::FITTED_MAE,
                "SD",
                "R2",
                text::correspondence::HELD_OUT_MAE,
                "SD",
                "R2",
            ] {
                ui.label(small(head));
            }
            ui.end_row();
            let sides = [
                (&agreement.residuals.fitted, &agreement.r2_fitted),
                (&agreement.residuals.held_out, &agreement.r2_held_out),
            ];
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                ui.label(name);
                for (stats, r2) in sides {
                    for value in [stats.mae[axis], stats.sd[axis], r2[axis]] {
                        ui.label(three_digits(value));
                    }
                }
                ui.end_row();
            }
        });
        let (fitted, held_out) = (agreement.r2_fitted_overall, agreement.r2_held_out_overall);
        figure(
            ui,
            text::correspondence::R2_OF_ALL_AXES,
            text::correspondence::agreement(fitted, held_out),
            text::correspondence::THE_PAPER_HAS_0,
        );
    });
}
