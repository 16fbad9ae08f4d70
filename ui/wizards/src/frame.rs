//! Common parts of all wizards: steps, buttons for back, next and reset, and the last step, which saves.

use std::sync::Arc;

use egui::{Button, Id, RichText, TextEdit, Ui, WidgetInfo, vec2};
use nima_core::calibration::Judgement;
use nima_endoscope::DecodedImage;
use nima_machine::{messages::Tick, rig::Prompt};
use nima_screen::{
    steady_button::{PATIENT_S, SteadyButton},
    theme,
    widgets::{Sign, card, figure, next_button, sign_ui, small, weak},
};
use nima_words::{language::Text, text};

use super::{Binding, GoOn, SaveRequest, WizardPageRequest, report::judged_line};

#[derive(Clone, Copy, Debug)]
pub struct WizardStep {
    pub name: Text,
    pub meaning: Text,
}

/// A request of the technician.
#[derive(Clone, Copy, Debug)]
pub enum WizardRequest {
    GoTo(usize),
    StartOver,
    /// Continue elsewhere.
    GoOn(GoOn),
}

/// State of a wizard: its step, and the inputs and messages of the last step.
#[derive(Debug, Default)]
pub struct WizardFrame {
    pub step: usize,
    /// Name of the person who overrides the verdict.
    name: String,
    why: String,
    /// Result of saving.
    pub saved: Option<Result<String, String>>,
    /// The step after saving.
    following: Option<GoOn>,
    /// The step or the saved data have changed since [`WizardFrame::take_changed`].
    pub(super) changed: bool,
}

impl WizardFrame {
    /// Shows the result of saving, and the step after it.
    pub(super) fn report_saved(&mut self, report: Result<String, String>, following: Option<GoOn>) {
        self.saved = Some(report);
        self.changed = true;
        self.following = following;
    }

    const fn is_saved(&self) -> bool {
        matches!(self.saved, Some(Ok(_)))
    }

    /// `None` before anything was saved.
    fn following(&self) -> Option<GoOn> {
        self.following.filter(|_| self.is_saved())
    }

    /// Returns whether the step or the saved data have changed since the last call.
    pub const fn take_changed(&mut self) -> bool {
        std::mem::replace(&mut self.changed, false)
    }

    /// Copies the entered name and reason into the record.
    fn override_in(&self, judgement: &mut Judgement) {
        judgement.override_by(&self.name, Some(&self.why));
    }
}

/// A wizard for one calibration. It draws its own steps except the last one (saving), which is common.
pub trait Wizard: std::fmt::Debug {
    /// Returns its steps; the last one saves.
    fn steps(&self) -> &'static [WizardStep];
    fn frame_mut(&mut self) -> &mut WizardFrame;

    /// Adds one tick of a loop of this rate (Hz).
    fn tick(&mut self, tick: &Tick, rate_hz: f64);
    /// Returns the current instruction to the person at the arm.
    fn prompt(&self) -> Prompt;
    /// `Ok` if the next step may start; the error is the reason why not.
    fn may_go_on(&self, binding: &Binding) -> Result<(), &'static str>;
    /// Draws a step before the last.
    fn step_ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<WizardRequest>;
    /// Returns the evidence that the result is good, as text; `None` if it can only be saved with an override.
    fn proof(&self) -> Option<String>;
    /// Returns the record to save, if there is one, with its verdict before any override.
    fn made(&self, binding: &Binding) -> Option<SaveRequest>;
    /// Removes the data, but keeps the settings of the rig.
    fn start_over(&mut self);

    /// Receives the endoscope's newest image.
    fn see(&mut self, _newest: Option<(u64, Arc<DecodedImage>)>, _ctx: &egui::Context) {}

    /// Returns whether the result belongs to the wrist sensor and its tool.
    fn is_of_a_sensor(&self) -> bool {
        true
    }
    /// Returns whether the goal of this step is met; only then the next step is offered.
    fn is_done(&self) -> bool {
        true
    }
    /// Returns whether the next step is also offered before the goal is met: its result names what is wrong with the data,
    /// which may be the reason why the goal cannot be met.
    fn may_go_early(&self) -> bool {
        false
    }
    /// Acts as a technician without a screen in this step; returns whether it is complete.
    fn attend(&mut self, _binding: &Binding) -> bool {
        self.is_done()
    }

    /// Called before drawing.
    fn refresh(&mut self, _binding: &Binding) {}
    /// Returns a message shown in every step, below the row of steps.
    fn notice(&self) -> Option<&str> {
        None
    }
    /// Draws the part above the last step; returns false if there is nothing to save yet.
    fn before_saving(&self, _ui: &mut Ui) -> bool {
        true
    }
    /// Draws the part below the last step; returns further data to save.
    fn after_saving(&mut self, _ui: &mut Ui) -> Option<SaveRequest> {
        None
    }
    fn go_to(&mut self, step: usize) {
        self.frame_mut().step = step;
    }
}

/// Draws a wizard; returns its request.
pub(super) fn wizard_ui(wizard: &mut dyn Wizard, ui: &mut Ui, binding: &Binding) -> Option<WizardPageRequest> {
    wizard.refresh(binding);
    let steps = wizard.steps();
    let now = wizard.frame_mut().step;
    let following = wizard.frame_mut().following();
    let going_on = GoingOn {
        may: wizard.may_go_on(binding),
        is_done: wizard.is_done(),
        may_go_early: wizard.may_go_early(),
        following,
    };
    let mut wish = steps_ui(ui, steps, now, &going_on);
    ui.add_space(theme::GAP);
    if let Some(notice) = wizard.notice() {
        ui.label(notice);
        ui.add_space(theme::GAP);
    }
    let mut saving = None;
    if now + 1 < steps.len() {
        wish = wizard.step_ui(ui, binding).or(wish);
    } else if wizard.before_saving(ui) {
        let proof = wizard.proof();
        let of_sensor = wizard.is_of_a_sensor().then_some(binding);
        if save_card(ui, of_sensor, proof.as_deref(), wizard.frame_mut()) {
            saving = wizard.made(binding);
        }
        // Without proof, the file names the person who accepts the result.
        if let (None, Some(judgement)) = (proof, saving.as_mut().and_then(SaveRequest::judgement_mut)) {
            wizard.frame_mut().override_in(judgement);
        }
        saving = wizard.after_saving(ui).or(saving);
    }
    match wish {
        Some(WizardRequest::GoTo(step)) => wizard.go_to(step),
        Some(WizardRequest::StartOver) => wizard.start_over(),
        Some(WizardRequest::GoOn(following)) => return Some(WizardPageRequest::GoOn(following)),
        None => {}
    }
    saving.map(WizardPageRequest::Save)
}

/// State of the button for the next step.
struct GoingOn {
    /// Checks whether the next step may start; the error is the reason.
    may: Result<(), &'static str>,
    /// The current step is complete.
    is_done: bool,
    may_go_early: bool,
    /// The step after the last one.
    following: Option<GoOn>,
}

/// Draws the row of steps with buttons for back, next and reset. Going back loses no data.
fn steps_ui(ui: &mut Ui, steps: &[WizardStep], now: usize, going_on: &GoingOn) -> Option<WizardRequest> {
    let mut wish = None;
    let mut why = None;
    ui.horizontal_wrapped(|ui| {
        for (i, step) in steps.iter().enumerate() {
            if i < now {
                let done = sign_ui(ui, Sign::Tick, 6.0, theme::now().engaged);
                done.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, text::wizards::DONE.get()));
            }
            let (font, colour) = if i == now {
                (theme::strong(15.0), theme::now().text)
            } else {
                (theme::regular(14.0), theme::now().text_weak)
            };
            let words = format!("{}. {}", i + 1, step.name);
            ui.label(RichText::new(words).font(font).color(colour)).on_hover_text(step.meaning.get());
            ui.add_space(10.0);
        }
    });
    ui.label(small(text::wizards::step_of(now + 1, steps.len(), steps[now].meaning.get())));
    ui.horizontal_wrapped(|ui| {
        let size = vec2(96.0, 34.0);
        let back = ui.add_enabled(now > 0, Button::new(text::wizards::BACK).min_size(size));
        if back.on_disabled_hover_text(text::wizards::FIRST_STEP).clicked() {
            wish = Some(WizardRequest::GoTo(now - 1));
        }
        let last = now + 1 == steps.len();
        let following = going_on.following.filter(|_| last);
        let name = following.map_or_else(|| text::wizards::NEXT.get().to_owned(), GoOn::words);
        let may = match (following, last) {
            (Some(_), _) => Ok(()),
            (None, true) => Err(text::wizards::LAST_STEP.get()),
            (None, false) if going_on.is_done || going_on.may_go_early => going_on.may,
            (None, false) => going_on.may.and(Err(text::wizards::NEEDS_GOAL.get())),
        };
        let is_offered = following.is_some() || going_on.is_done;
        let next = SteadyButton { id: Id::unique(("next", now)), label: &name, meaning: "", may, waits_s: PATIENT_S };
        if next.ui(ui, |name, enabled| next_button(name, enabled && is_offered).min_size(size)) {
            wish = Some(following.map_or(WizardRequest::GoTo(now + 1), WizardRequest::GoOn));
        }
        why = may.err().filter(|_| !last);
        ui.add_space(24.0);
        if ui.button(text::wizards::START_OVER).on_hover_text(text::wizards::START_OVER_HOVER).clicked() {
            wish = Some(WizardRequest::StartOver);
        }
        // At the end of the row, so that nothing moves when it appears.
        if !last && !going_on.is_done && going_on.may.is_ok() {
            let anyway = ui.button(text::wizards::ANYWAY).on_hover_text(text::wizards::ANYWAY_HOVER);
            if anyway.clicked() {
                wish = Some(WizardRequest::GoTo(now + 1));
            }
        }
    });
    // A separate line that is always drawn, so that no button moves when a reason appears.
    ui.label(small(why.unwrap_or_default()));
    wish
}

/// Draws the last step of every wizard: sensor and tool of the record, if it is bound to them, and the save button;
/// returns true when pressed. Without `proof` a name and a reason are required.
fn save_card(ui: &mut Ui, binding: Option<&Binding>, proof: Option<&str>, frame: &mut WizardFrame) -> bool {
    let meaning =
        if binding.is_some() { text::wizards::SAVE_HOVER.get() } else { text::wizards::STEP_SAVE_IN_RIG_HOVER.get() };
    card(ui, text::wizards::STEP_SAVE, meaning, |ui| {
        if let Some(binding) = binding {
            figure(ui, text::wizards::SENSOR, &binding.sensor, text::wizards::SENSOR_HOVER);
            figure(ui, text::wizards::TOOL, &binding.tool, text::wizards::TOOL_HOVER);
        }
        let wanted = if let Some(proof) = proof {
            judged_line(ui, true, proof);
            let known = binding.is_none_or(|binding| !binding.sensor.is_empty());
            let next = !frame.is_saved();
            let may = if known { Ok(()) } else { Err(text::calibrations::SENSOR_NOT_CONNECTED.get()) };
            let label = text::wizards::SAVE_AND_USE.get();
            let save = SteadyButton { id: Id::unique("save"), label, meaning: "", may, waits_s: PATIENT_S };
            let wanted = save.ui(ui, |label, _| next_button(label, next).min_size(vec2(180.0, 36.0)));
            if let Err(why) = may {
                ui.label(small(why));
            }
            wanted
        } else {
            ui.label(weak(text::wizards::NOT_PROVEN));
            override_ui(ui, [&mut frame.name, &mut frame.why])
        };
        if let Some(Ok(report) | Err(report)) = &frame.saved {
            ui.label(report);
        }
        wanted
    })
}

/// Draws the name and reason for an override; returns true when both are entered and confirmed.
fn override_ui(ui: &mut Ui, by: [&mut String; 2]) -> bool {
    let mut named = true;
    for (label, text) in [text::wizards::YOUR_NAME.get(), text::wizards::REASON.get()].into_iter().zip(by) {
        ui.horizontal(|ui| {
            let label = ui.label(label);
            ui.add(TextEdit::singleline(text).desired_width(280.0).char_limit(120)).labelled_by(label.id);
        });
        named &= !text.trim().is_empty();
    }
    ui.add_enabled(named, Button::new(text::wizards::SAVE_ANYWAY).min_size(vec2(220.0, 36.0)))
        .on_disabled_hover_text(text::wizards::SAVE_ANYWAY_DISABLED_HOVER)
        .clicked()
}

#[cfg(test)]
mod tests {
    use egui_kittest::{Harness, kittest::Queryable as _};

    use super::*;

    const STEPS: [WizardStep; 3] = [
        WizardStep { name: text::wizards::STEP_CHECK, meaning: text::wizards::STEP_CHECK },
        WizardStep { name: text::wizards::STEP_RESULT, meaning: text::wizards::STEP_RESULT },
        WizardStep { name: text::wizards::STEP_SAVE, meaning: text::wizards::STEP_SAVE },
    ];

    /// A wizard whose device is lost in three of four frames.
    #[derive(Debug, Default)]
    struct Flickering {
        frame: WizardFrame,
        drawn: usize,
    }

    impl Wizard for Flickering {
        fn steps(&self) -> &'static [WizardStep] {
            &STEPS
        }
        fn frame_mut(&mut self) -> &mut WizardFrame {
            &mut self.frame
        }
        fn tick(&mut self, _: &Tick, _: f64) {}
        fn prompt(&self) -> Prompt {
            Prompt::Rest
        }
        fn may_go_on(&self, _: &Binding) -> Result<(), &'static str> {
            if self.frame.step == 0 && self.drawn.is_multiple_of(4) { Ok(()) } else { Err("a device is missing") }
        }
        fn step_ui(&mut self, _: &mut Ui, _: &Binding) -> Option<WizardRequest> {
            None
        }
        fn proof(&self) -> Option<String> {
            None
        }
        fn made(&self, _: &Binding) -> Option<SaveRequest> {
            None
        }
        fn start_over(&mut self) {}
        fn refresh(&mut self, _: &Binding) {
            self.drawn += 1;
        }
    }

    #[test]
    fn one_click_leads_to_the_next_step_whatever_frame_it_falls_into() {
        for late in 0..4 {
            let draw = |ui: &mut Ui, wizard: &mut Flickering| {
                if theme::is_applied(ui.ctx()) {
                    wizard_ui(wizard, ui, &Binding::default());
                }
            };
            let mut window = Harness::builder().with_step_dt(0.03).build_ui_state(draw, Flickering::default());
            window.run_steps(4 + late);
            let start_over = |window: &Harness<'_, Flickering>| window.get_by_label("Start over").rect();
            let place = start_over(&window);
            for _ in 0..4 {
                window.step();
                assert_eq!(start_over(&window), place, "the reason that comes and goes moves no button");
            }
            window.get_by_label("Next").click();
            window.run_steps(8);
            assert_eq!(window.state().frame.step, 1, "{late} frames later");
        }
    }
}
