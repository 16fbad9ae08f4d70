//! Settings of the force feedback: mode, gain, delay, dead band, standstill.
//!
//! Controls show the active values reported by the loop. While a control is being moved, and for a moment after, it shows the
//! requested value.

use egui::{Button, DragValue, Response, RichText, Slider, SliderClamping, Ui, vec2};
use nima_core::limits::{GAIN, GAIN_ABOVE_ONE, Limits, SLIDER_DEAD_BAND_M_S, SLIDER_DELAY_S};
use nima_machine::messages::Command;
use nima_screen::{
    live::LiveState,
    outbox::Outbox,
    theme,
    widgets::{at_the_right, small},
};
use nima_words::{language::Text, text};

use crate::panel::{Panel, PanelContext, PanelSize};

use super::modes::modes_ui;

/// Time for which a control shows the requested value before it shows the active value again, s: the gain ramps at 2
/// per second.
const ASKED_SHOWN_S: f64 = 1.6;

/// A requested value and the time of the request (s on the window's clock).
#[derive(Clone, Copy, Debug, Default)]
struct RequestedValue(Option<(f64, f64)>);

impl RequestedValue {
    /// Returns the value that a control shows at `time_s`, given the active value.
    fn shown(&mut self, active: f64, time_s: f64) -> f64 {
        match self.0 {
            Some((value, at_s)) if time_s - at_s < ASKED_SHOWN_S && (value - active).abs() > 1e-6 => value,
            _ => {
                self.0 = None;
                active
            }
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub struct FeedbackState {
    allow_above_one: bool,
    gain: RequestedValue,
    delay_ms: RequestedValue,
    dead_band_mm_s: RequestedValue,
}

#[derive(Debug, Default)]
pub struct FeedbackPanel;

impl Panel for FeedbackPanel {
    const NAME: Text = text::feedback::NAME;
    const MEANING: Text = text::feedback::MEANING;
    const SIZE: PanelSize = PanelSize::KNOBS;
    const ACTS: bool = true;

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        feedback_ui(ui, at.live, &mut at.panels.feedback, at.outbox);
    }
}

pub fn feedback_ui(ui: &mut Ui, live: &mut LiveState, state: &mut FeedbackState, outbox: &mut Outbox) {
    ui.spacing_mut().item_spacing = vec2(6.0, 4.0);
    modes_ui(ui, live, outbox);
    ui.add_space(4.0);
    gain_ui(ui, live, state, outbox);
    ui.add_space(4.0);
    delay_ui(ui, live, state, outbox);
    ui.add_space(4.0);
    standstill_ui(ui, live, state, outbox);
}

/// One setting: its name, its value and a slider over its range.
struct FeedbackSetting<'a> {
    name: &'static str,
    meaning: &'a str,
    suffix: &'static str,
    decimals: u8,
    /// Whether to send the value to the loop while the slider moves, not only when it is released.
    at_once: bool,
}

/// Shows the setting; returns the newly requested value, if there is one, and the slider's rectangle.
fn setting_ui(
    ui: &mut Ui,
    setting: &FeedbackSetting<'_>,
    limits: &Limits,
    active: f64,
    asked: &mut RequestedValue,
) -> (Option<f64>, egui::Rect) {
    let time_s = ui.input(|input| input.time);
    // Round for display here: a widget that rounds or clamps would report an edit, and the window would send a setting
    // that the user did not choose.
    let step = 10f64.powi(-i32::from(setting.decimals));
    let whole = |value: f64| (value / step).round() * step;
    let mut value = whole(asked.shown(active, time_s));
    let number = DragValue::new(&mut value)
        .range(limits.min..=limits.max)
        .clamp_existing_to_range(false)
        .speed((limits.max - limits.min) / 300.0)
        .fixed_decimals(usize::from(setting.decimals))
        .suffix(setting.suffix);
    let row = ui.horizontal(|ui| {
        let label = ui.label(setting.name).on_hover_text(setting.meaning);
        let number = ui
            .with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.add(number))
            .inner
            .labelled_by(label.id);
        (label.id, hover(number, setting.meaning))
    });
    let (label, number) = row.inner;
    ui.spacing_mut().slider_width = ui.available_width();
    let slider = Slider::new(&mut value, limits.min..=limits.max).show_value(false).clamping(SliderClamping::Edits);
    let slider = hover(ui.add(slider).labelled_by(label), setting.meaning);
    let rail = slider.rect;
    let both = slider.union(number);
    if both.changed() || both.dragged() {
        asked.0 = Some((whole(value), time_s));
    }
    let wanted =
        if setting.at_once { both.changed() } else { both.drag_stopped() || (both.changed() && !both.dragged()) };
    (wanted.then_some(whole(value)), rail)
}

/// Adds a hover text, which must not cover the value while it is dragged.
fn hover(response: Response, meaning: &str) -> Response {
    let still = !response.is_pointer_button_down_on() && !response.drag_stopped();
    if still { response.on_hover_text(meaning) } else { response }
}

fn gain_ui(ui: &mut Ui, live: &LiveState, state: &mut FeedbackState, outbox: &mut Outbox) {
    let setting = FeedbackSetting {
        name: text::feedback::GAIN.get(),
        meaning: &text::feedback::gain_hover(live.gate_settings().gain_rate_per_s),
        suffix: "",
        decimals: 2,
        at_once: true,
    };
    let limits = if state.allow_above_one { GAIN_ABOVE_ONE } else { GAIN };
    let (wanted, rail) = setting_ui(ui, &setting, &limits, live.gain(), &mut state.gain);
    if let Some(strip_ui) = super::PanelExtras::offered().stable_gain {
        strip_ui(ui, live, rail, limits.max);
    }
    if let Some(gain) = wanted {
        outbox.push(if gain > GAIN.max { Command::SetGainAboveOne(gain) } else { Command::SetGain(gain) });
    }
    ui.horizontal(|ui| {
        let meaning = text::feedback::allow_above_1_hover();
        let unlock = ui.checkbox(&mut state.allow_above_one, text::feedback::ALLOW_ABOVE_1).on_hover_text(meaning);
        if unlock.changed() && !state.allow_above_one && live.gain() > GAIN.max {
            outbox.push(Command::SetGain(GAIN.max));
            state.gain = RequestedValue::default();
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(small(text::feedback::gain_in_use(live.gain()))).on_hover_text(text::feedback::GAIN_IN_USE_HOVER);
        });
    });
}

/// Draws the gain alone, large: one number, one slider, two buttons for steps of 0.1. Never above [`GAIN`].
pub fn calm_gain_ui(ui: &mut Ui, live: &LiveState, state: &mut FeedbackState, outbox: &mut Outbox) {
    let time_s = ui.input(|input| input.time);
    let shown = state.gain.shown(live.gain(), time_s);
    let mut wanted = None;
    let meaning = &text::feedback::gain_hover(live.gate_settings().gain_rate_per_s);
    ui.horizontal(|ui| {
        ui.label(RichText::new(text::feedback::GAIN).font(theme::strong(17.0))).on_hover_text(meaning);
        at_the_right(ui, |ui| {
            ui.label(RichText::new(format!("{shown:.2}")).font(theme::strong(38.0))).on_hover_text(meaning);
            ui.add_space(8.0);
            let mut step = |ui: &mut Ui, text: &str, name: &str, by: f64| {
                let button =
                    ui.add(Button::new(RichText::new(text).font(theme::strong(22.0))).min_size(vec2(48.0, 48.0)));
                button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
                if button.on_hover_text(text::feedback::by_a_tenth(name)).clicked() {
                    wanted = Some(((shown + by) * 10.0).round() / 10.0);
                }
            };
            step(ui, "-", text::feedback::LOWER_GAIN.get(), -0.1);
            step(ui, "+", text::feedback::RAISE_GAIN.get(), 0.1);
        });
    });
    let mut value = shown.min(GAIN.max);
    ui.spacing_mut().slider_width = ui.available_width();
    let slider = ui.add(Slider::new(&mut value, GAIN.min..=GAIN.max).show_value(false).clamping(SliderClamping::Edits));
    slider.widget_info(|| egui::WidgetInfo::slider(true, value, text::feedback::GAIN.get()));
    if hover(slider, meaning).changed() {
        wanted = Some(value);
    }
    if let Some(gain) = wanted.map(|gain| gain.clamp(GAIN.min, GAIN.max)) {
        state.gain = RequestedValue(Some((gain, time_s)));
        outbox.push(Command::SetGain(gain));
    }
}

fn delay_ui(ui: &mut Ui, live: &LiveState, state: &mut FeedbackState, outbox: &mut Outbox) {
    let setting = FeedbackSetting {
        name: text::feedback::LINK_DELAY.get(),
        meaning: &text::feedback::delay_hover(),
        suffix: " ms",
        decimals: 0,
        at_once: false,
    };
    let active = live.delay_s() * 1e3;
    let measured = live.line.is_some();
    ui.add_enabled_ui(!measured, |ui| {
        if let Some(delay_ms) = setting_ui(ui, &setting, &SLIDER_DELAY_S.per(1e-3, "ms"), active, &mut state.delay_ms).0
        {
            outbox.push(Command::SetDelay(delay_ms * 1e-3));
        }
    })
    .response
    .on_disabled_hover_text(text::link::DELAY_IS_MEASURED);
}

fn standstill_ui(ui: &mut Ui, live: &LiveState, state: &mut FeedbackState, outbox: &mut Outbox) {
    let setting = FeedbackSetting {
        name: text::feedback::DEAD_BAND.get(),
        meaning: &text::feedback::dead_band_hover(),
        suffix: " mm/s",
        decimals: 1,
        at_once: true,
    };
    let active = live.gate_settings().dead_band_m_s * 1e3;
    let limits = SLIDER_DEAD_BAND_M_S.per(1e-3, "mm/s");
    if let Some(mm_s) = setting_ui(ui, &setting, &limits, active, &mut state.dead_band_mm_s).0 {
        outbox.push(Command::SetDeadBand(mm_s * 1e-3));
    }
    let mut hold = live.gate_settings().static_hold;
    if ui.checkbox(&mut hold, RichText::new(text::feedback::HOLD)).on_hover_text(text::feedback::HOLD_HOVER).changed() {
        outbox.push(Command::SetStaticHold(hold));
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::{Harness, kittest::Queryable as _};
    use nima_machine::config::RigConfig;
    use nima_simulation::scene::Scene;

    use super::*;

    #[test]
    fn the_hover_text_never_covers_a_gain_that_is_dragged() {
        let live = LiveState::new(RigConfig::load("simulated").unwrap(), Scene::load("peg_transfer").unwrap());
        let draw = move |ui: &mut Ui, (state, outbox): &mut (FeedbackState, Outbox)| {
            if theme::is_applied(ui.ctx()) {
                calm_gain_ui(ui, &live, state, outbox);
            }
        };
        let size = vec2(330.0, 400.0);
        let mut window = Harness::builder().with_size(size).with_step_dt(0.1).build_ui_state(draw, Default::default());
        window.run_steps(3);
        let place = window.get_by_role_and_label(egui::Role::Slider, "Gain").rect().center();
        let texts = |window: &Harness<'_, (FeedbackState, Outbox)>| window.query_all_by_label_contains("force").count();
        window.hover_at(place);
        window.run_steps(10);
        assert!(texts(&window) > 0, "the pointer explains the gain");
        window.drag_at(place);
        for step in 0..10_u8 {
            window.hover_at(place + vec2(f32::from(step), 0.0));
            window.step();
        }
        assert_eq!(texts(&window), 0);
    }

    #[test]
    fn a_control_shows_what_was_asked_for_a_moment_and_then_the_truth() {
        let mut asked = RequestedValue(Some((0.3, 10.0)));
        assert!((asked.shown(0.9, 10.5) - 0.3).abs() < 1e-12);
        assert!((asked.shown(0.9, 12.0) - 0.9).abs() < 1e-12, "the loop did not follow: show that");
        assert!((asked.shown(0.4, 10.5) - 0.4).abs() < 1e-12, "once given up it stays with the truth");
    }
}
