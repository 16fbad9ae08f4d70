//! The correspondence wizard: check, pushes, result, save. Pushes are kept at every step back and on closing.

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
    pictures::{progress, sphere_picture},
    save_card, steps_ui,
};
use crate::console::{
    alarms::sentence,
    theme,
    widgets::{Sign, card, figure, sign_ui, small, three_digits},
};

/// Fewest pushes from which a fit is shown.
const PUSHES_MIN: usize = 6;
/// As many are asked for: one in each direction.
const PUSHES_ASKED: usize = TARGETS.len();
/// Steps of this wizard.
const STEPS: [Step; 4] = [
    Step { name: "Check", meaning: "Is everything there, and do both sensors read nothing without contact?" },
    Step {
        name: "Pushes",
        meaning: "The tool pushes the tissue in many directions; both sensors feel the same force.",
    },
    Step { name: "Result", meaning: "The rotation, judged on pushes it has not seen." },
    Step { name: "Save", meaning: "Kept for this sensor and this tool, with its residuals." },
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
        Self {
            session: CorrespondenceSession::new(SessionSettings::default()),
            step: CHECK,
            sources: None,
            clock_s: (0.0, 0.0),
            report: None,
            name: String::new(),
            why: String::new(),
            saved: None,
        }
    }
}

impl CorrespondenceWizard {
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
        let Some(sources) = self.sources else { return Err("The wrist sensor is silent: connect it.") };
        match self.session.phase() {
            _ if !sources.gravity => Err("Gravity is not in force: calibrate it first."),
            Phase::Missing(_) => Err("A check is not met yet."),
            Phase::Resting { .. } => Err("Both sensors must rest without contact first."),
            _ => Ok(()),
        }
    }

    /// Whether the step after this one may begin, or why not.
    fn may_go_on(&self) -> Result<(), &'static str> {
        match self.step {
            CHECK => self.may_push(),
            PUSHES if self.session.pushes() >= PUSHES_MIN => Ok(()),
            PUSHES => Err("At least six pushes are needed."),
            RESULT if self.solution().is_some() => Ok(()),
            RESULT => Err("There is no rotation to save: go back and push more."),
            _ => Err("This is the last step."),
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
            Some(Wish::StartOver) => *self = Self { clock_s: self.clock_s, ..Self::default() },
            None => {}
        }
        save
    }

    fn check_ui(&self, ui: &mut Ui) {
        card(ui, "Before the first push", "All four must be met before pushes are taken.", |ui| {
            ui.label(
                "Lay the tissue on its sensor, without the body wall. Nothing may touch the tool or the tissue yet.",
            );
            ui.add_space(6.0);
            let Sources { gravity, tissue, chain } = self.sources.unwrap_or_default();
            check_line(ui, "Force at the wrist", gravity, Missing::WristForce.words());
            check_line(ui, "Force under the tissue", tissue, Missing::TissueForce.words());
            check_line(ui, "Arm and tracker", chain, Missing::Chain.words());
            let (_, words) = phase_words(&self.session.phase());
            check_line(ui, "Rest", self.may_push().is_ok(), &words);
        });
    }

    fn pushes_ui(&mut self, ui: &mut Ui) {
        let count = self.session.pushes();
        let wanted = self.wanted();
        card(
            ui,
            "Push this way",
            "Push the tissue, hold half a second, let go. The push is taken when it ends.",
            |ui| {
                ui.label(RichText::new(sentence(wanted.name)).font(theme::strong(19.0)));
                let (share, words) = if self.sources.is_some() {
                    phase_words(&self.session.phase())
                } else {
                    (0.0, "the wrist sensor is silent; connect it".to_owned())
                };
                progress(ui, "Push", share, &words);
                ui.add_space(6.0);
                let directions = TARGETS.map(|target| target.push_in_kbf);
                let taken = self.session.taken_in_kbf();
                sphere_picture(ui, "Directions of pushes", &directions, &taken, Some(wanted.push_in_kbf));
                let share = count as f64 / PUSHES_ASKED as f64;
                progress(ui, "Pushes", share, &format!("{count} taken of {PUSHES_ASKED} or more"));
            },
        );
        card(ui, "So far", "The fit is made anew after each push, from the sixth on.", |ui| {
            figure(ui, "Taken", format!("{count} pushes"), "Pushes taken and kept.");
            match &self.report {
                Some(Ok(report)) => {
                    let words = format!("{}: {}", report.verdict.words(), report.reason);
                    ui.label(RichText::new(words).font(theme::strong(14.0)));
                }
                Some(Err(error)) => {
                    ui.label(error);
                }
                None => {
                    ui.label(small("A first fit is shown from the sixth push on."));
                }
            }
            if ui.add_enabled(count > 0, Button::new("Remove the last push")).clicked() {
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
                card(ui, "No result", "The pushes could not be fitted.", |ui| ui.label(error));
            }
            None => {
                ui.label("There are too few pushes: go back and take some.");
            }
        }
    }

    fn save_ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<CorrespondenceRecord> {
        let accepted = self.good_report().is_some_and(|report| report.verdict == Verdict::Accepted);
        let proof = accepted.then_some("Accepted on pushes that were held out.");
        let wanted = save_card(ui, binding, proof, [&mut self.name, &mut self.why], self.saved.as_deref());
        wanted.then(|| self.record(binding, accepted)).flatten()
    }

    fn record(&self, binding: &Binding, accepted: bool) -> Option<CorrespondenceRecord> {
        let flip_s2 = SessionSettings::default().options.flip_s2;
        let mut record = CorrespondenceRecord::of(self.good_report()?, &binding.sensor, &binding.tool, flip_s2)?;
        if !accepted {
            record.override_by = Some(self.name.trim().to_owned());
            record.override_reason = Some(self.why.trim().to_owned());
        }
        Some(record)
    }
}

/// One thing that must be met, or what to do about it.
pub(super) fn check_line(ui: &mut Ui, name: &str, met: bool, otherwise: &str) {
    let (what, colour, words) =
        if met { (Sign::Disc, theme::ENGAGED, "met") } else { (Sign::Triangle, theme::TEXT, otherwise) };
    ui.horizontal_wrapped(|ui| {
        sign_ui(ui, what, 6.0, colour);
        ui.label(format!("{name}: {words}"));
    });
}

/// How far the push is, and what to do.
fn phase_words(phase: &Phase) -> (f64, String) {
    match phase {
        Phase::Missing(missing) => (0.0, missing.words().to_owned()),
        Phase::Resting { share, f1_n, f2_n } => {
            let words =
                format!("wrist {f1_n:.2} N, tissue {f2_n:.2} N; touch nothing, and zero what stays above 0.3 N");
            (*share, words)
        }
        Phase::Ready => (0.0, "ready; push now".to_owned()),
        Phase::Pushing { force_n, enough: false } => (0.5, format!("{force_n:.1} N; hold it still")),
        Phase::Pushing { force_n, enough: true } => (1.0, format!("{force_n:.1} N; enough, let go")),
        Phase::Recorded(index) => (1.0, format!("push {} taken", index + 1)),
        Phase::Refused(refusal) => (0.0, format!("not taken: {}", refusal.words())),
    }
}

fn verdict_ui(ui: &mut Ui, report: &CorrespondenceReport) {
    card(ui, report.verdict.words(), "Judged on pushes that the rotation has not seen.", |ui| {
        ui.label(&report.reason);
        ui.add_space(4.0);
        let (left_out, weak) = (report.outliers.len(), report.weak.len());
        let pushes = format!("{}, {left_out} contradicted, {weak} too weak", report.pairs);
        figure(ui, "Pushes", pushes, "All that were taken, and those that were not used.");
        let spread = format!("{:.2}, {:.2}", report.excitation.second, report.excitation.third);
        figure(ui, "Spread", spread, "Second and third axis of the directions against the first; 1 is even.");
        let Some(solution) = &report.solution else { return };
        let [roll, pitch, yaw] = solution.roll_pitch_yaw_deg;
        let name = format!("Rotation {}", solution.target.name());
        figure(ui, &name, format!("{roll:.2}, {pitch:.2}, {yaw:.2} deg"), "Roll, pitch, yaw (Rz Ry Rx).");
        figure(ui, "Uncertainty", format!("{:.2} deg", solution.uncertainty_deg), "Expected angle of its error.");
        let check = format!("{:.3} deg", solution.cross_check_deg);
        figure(ui, "Euler cross-check", check, "Angle to what the paper's search over Euler angles finds.");
        if let Some(diagnosis) = &solution.diagnosis {
            let gain = format!("{:.3} +- {:.3}", diagnosis.gain, diagnosis.gain_se);
            figure(ui, "Gain", gain, "Force of the wrist sensor over that of the tissue sensor; 1 is right.");
            let offset = format!("{:.3} +- {:.3} N", diagnosis.offset_norm_n(), diagnosis.offset_se_n);
            figure(
                ui,
                "Offset",
                format!("{offset} ({})", frame_words(diagnosis.offset_frame)),
                "Constant between both.",
            );
        }
    });
}

const fn frame_words(frame: OffsetFrame) -> &'static str {
    match frame {
        OffsetFrame::S1 => "of the wrist sensor",
        OffsetFrame::S2 => "of the tissue sensor",
        OffsetFrame::Unknown => "of either sensor",
    }
}

/// The paper's Validation I: how well the rotated force under the tissue tells that at the wrist.
fn agreement_ui(ui: &mut Ui, agreement: &Agreement) {
    let meaning = "Errors in N in the axes of the wrist sensor; held out: pushes that the rotation was not fitted on.";
    card(ui, "Agreement per axis", meaning, |ui| {
        Grid::new("agreement").num_columns(7).spacing(vec2(22.0, 6.0)).show(ui, |ui| {
            for head in ["Axis", "fitted: MAE", "SD", "R2", "held out: MAE", "SD", "R2"] {
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
        figure(ui, "R2 of all axes", format!("{fitted:.3} fitted, {held_out:.3} held out"), "The paper has 0.95.");
    });
}
