//! A button whose condition may flicker, for example while a device is lost for a moment.
//!
//! A click is never swallowed: it acts, or the button says why not. A short gap in the condition does not disable the button,
//! and its label does not change while the pointer is down on it. Only a click in the first frame of a button does nothing: the
//! button has not been seen yet, and the click was meant for what was drawn in its place before.

use std::time::Duration;

use egui::{Button, Id, Response, Tooltip, Ui};
use nima_words::text;

/// A gap in the condition that is shorter than this is not shown, s.
const STEADY_S: f64 = 0.5;
/// Time for which the reason of a refused click is shown, s.
const SAID_S: f64 = 4.0;
/// A click in a wizard waits this long for its condition, s.
pub const PATIENT_S: f64 = 1.0;

/// State between two frames; times are on the window's clock, s.
#[derive(Clone, Debug, Default)]
struct SteadyState {
    /// The last time at which the condition was met.
    met_s: Option<f64>,
    /// The label while the pointer is down on the button.
    pressed: Option<String>,
    /// Time of a click that has not acted.
    clicked_s: Option<f64>,
    /// The label changed between the press and the click, so the click meant another action.
    has_changed: bool,
    /// The reason why the last click did not act.
    why: String,
    /// The last pass of the window in which the button was drawn.
    drawn_pass: u64,
}

#[derive(Clone, Copy, Debug)]
pub struct SteadyButton<'a> {
    /// Unique in the window.
    pub id: Id,
    pub label: &'a str,
    /// Hover text.
    pub meaning: &'a str,
    /// The condition, or the reason why it is not met.
    pub may: Result<(), &'a str>,
    /// Maximum time that a click waits for the condition, s; 0 for a button that moves the machine.
    pub waits_s: f64,
}

impl SteadyButton<'_> {
    /// Draws the button that `look` returns for its label and whether it is enabled; returns whether to act now.
    pub fn ui(self, ui: &mut Ui, look: impl FnOnce(String, bool) -> Button<'static>) -> bool {
        self.show(ui, look).1
    }

    /// Like [`Self::ui`]; `by_key`: the key of the button was pressed in this frame, which counts as a click.
    pub fn ui_by_key(self, ui: &mut Ui, by_key: bool, look: impl FnOnce(String, bool) -> Button<'static>) -> bool {
        self.show_or_key(ui, by_key, look).1
    }

    /// Like [`Self::ui`], with the button's response.
    pub fn show(self, ui: &mut Ui, look: impl FnOnce(String, bool) -> Button<'static>) -> (Response, bool) {
        self.show_or_key(ui, false, look)
    }

    fn show_or_key(
        self,
        ui: &mut Ui,
        by_key: bool,
        look: impl FnOnce(String, bool) -> Button<'static>,
    ) -> (Response, bool) {
        let Self { id, label, meaning, may, waits_s } = self;
        let now_s = ui.input(|input| input.time);
        let mut state: SteadyState = ui.data(|data| data.get_temp(id)).unwrap_or_default();
        if may.is_ok() {
            state.met_s = Some(now_s);
        }
        let is_recent = |since_s: Option<f64>, within_s: f64| since_s.is_some_and(|at_s| now_s - at_s < within_s);
        // A button that moves the machine shows at once that it cannot act.
        let steady_s = STEADY_S.min(waits_s);
        let enabled = state.pressed.is_some() || may.is_ok() || is_recent(state.met_s, steady_s);
        let shown = state.pressed.take().unwrap_or_else(|| label.to_owned());
        let response = ui.add_enabled(enabled, look(shown.clone(), enabled));
        let pressed_in_vain =
            !enabled && response.contains_pointer() && ui.input(|input| input.pointer.primary_pressed());
        let pass = ui.ctx().cumulative_pass_nr();
        let was_seen = std::mem::replace(&mut state.drawn_pass, pass) + 1 == pass;
        let clicked = by_key || was_seen && (response.clicked() || pressed_in_vain);
        if clicked {
            state.clicked_s = Some(now_s);
            state.has_changed = shown != label;
            state.why.clear();
        }
        state.pressed = (enabled && response.is_pointer_button_down_on()).then_some(shown);
        let waits = !state.has_changed && (clicked || is_recent(state.clicked_s, waits_s));
        let acts = waits && may.is_ok();
        if acts {
            state.clicked_s = None;
        } else if is_recent(state.clicked_s, SAID_S) {
            match may {
                _ if state.has_changed => state.why = text::common::has_become(label),
                Err(why) if waits => why.clone_into(&mut state.why),
                _ => {}
            }
            say(&response, id, &state.why);
        }
        if state.pressed.is_some() || state.clicked_s.is_some() || enabled && may.is_err() {
            ui.ctx().request_repaint_after(Duration::from_millis(50));
        }
        ui.data_mut(|data| data.insert_temp(id, state));
        let response = if meaning.is_empty() { response } else { response.on_hover_text(meaning) };
        (response.on_disabled_hover_text(may.err().unwrap_or(meaning)), acts)
    }
}

/// Shows the reason of a refusal below the button, over everything else, so that nothing moves.
fn say(response: &Response, id: Id, why: &str) {
    let tooltip = Tooltip::always_open(response.ctx.clone(), response.layer_id, id.with("why"), response.rect);
    tooltip.show(|ui| ui.label(why));
}

#[cfg(test)]
mod tests {
    use egui::Vec2;
    use egui_kittest::{Harness, kittest::Queryable as _};

    use super::*;
    use crate::theme;

    /// A button whose condition and label a test changes, and how often it acted.
    struct Shown {
        may: Result<(), &'static str>,
        label: &'static str,
        waits_s: f64,
        /// The step of the wizard; every step has its own button in the same place.
        step: usize,
        acted: usize,
    }

    fn window(waits_s: f64) -> Harness<'static, Shown> {
        let shown = Shown { may: Ok(()), label: "Next", waits_s, step: 0, acted: 0 };
        let draw = |ui: &mut Ui, shown: &mut Shown| {
            if !theme::is_applied(ui.ctx()) {
                return;
            }
            let Shown { may, label, waits_s, step, .. } = *shown;
            let button = SteadyButton { id: Id::unique(("next", step)), label, meaning: "", may, waits_s };
            shown.acted += usize::from(button.ui(ui, |label, _| Button::new(label)));
        };
        let mut window =
            Harness::builder().with_size(Vec2::new(300.0, 200.0)).with_step_dt(0.05).build_ui_state(draw, shown);
        window.run_steps(2);
        window
    }

    fn pointer(window: &mut Harness<'_, Shown>, pressed: bool) {
        let pos = window.get_by_label("Next").rect().center();
        window.event(egui::Event::PointerMoved(pos));
        let modifiers = egui::Modifiers::NONE;
        window.event(egui::Event::PointerButton { pos, button: egui::PointerButton::Primary, pressed, modifiers });
        window.step();
    }

    #[test]
    fn a_click_acts_once_although_its_condition_flickers() {
        let mut window = window(PATIENT_S);
        pointer(&mut window, true);
        window.state_mut().may = Err("a device is missing");
        window.step();
        pointer(&mut window, false);
        assert_eq!(window.state().acted, 0, "never while the condition is not met");
        window.run_steps(4);
        window.state_mut().may = Ok(());
        window.run_steps(20);
        assert_eq!(window.state().acted, 1);
    }

    #[test]
    fn a_second_click_does_not_act_on_the_next_step_before_it_was_seen() {
        let mut window = window(PATIENT_S);
        window.get_by_label("Next").click_accesskit();
        // The first click was acted upon after the last frame, and the second one is already on its way.
        window.state_mut().step = 1;
        window.step();
        assert_eq!(window.state().acted, 0, "the click was meant for the step before");
        window.get_by_label("Next").click_accesskit();
        window.step();
        assert_eq!(window.state().acted, 1);
    }

    #[test]
    fn a_refused_click_says_why_and_never_acts_later() {
        let mut window = window(0.0);
        window.state_mut().may = Err("a device is missing");
        window.run_steps(20);
        pointer(&mut window, true);
        pointer(&mut window, false);
        window.state_mut().may = Ok(());
        window.run_steps(4);
        assert!(window.query_by_label("a device is missing").is_some(), "the click was swallowed");
        assert_eq!(window.state().acted, 0, "a machine does not move by itself");
        window.run_steps(100);
        assert!(window.query_by_label("a device is missing").is_none(), "the reason stays for some seconds");
    }

    #[test]
    fn the_label_stays_under_the_pointer_and_a_click_never_means_another_one() {
        let mut window = window(PATIENT_S);
        pointer(&mut window, true);
        window.state_mut().label = "Start again";
        window.step();
        pointer(&mut window, false);
        window.run_steps(2);
        assert_eq!(window.state().acted, 0, "the person pressed Next");
        assert!(window.query_by_label_contains("now reads").is_some());
        assert!(window.query_by_label("Start again").is_some());
    }
}
