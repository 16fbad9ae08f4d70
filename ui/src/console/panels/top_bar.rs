//! Always there: what this is, the state of the loop, what is wrong, and the way to stop.

use egui::{Align, Button, Layout, Rect, RichText, Sense, Ui, UiBuilder, vec2};
use nima::{runtime::Command, teleop::LoopState};

use crate::console::{
    alarms::{Alarm, judge},
    help::Help,
    live::Live,
    menu::menu_ui,
    outbox::Outbox,
    roles::switch_ui,
    settings::Settings,
    theme,
    widgets::{Sign, sign, small, weak},
};

/// After a change of state the next step waits this long (s), so that a double click is never two steps.
const STEP_WAITS_S: f64 = 0.7;

/// Width of the window from which there is room for the scene's name.
const SCENE_FROM: f32 = 1400.0;

/// Height of the alarm's plate: two lines of cause, two of cure.
const ALARM_HEIGHT: f32 = 66.0;
/// Room in which a cause and a cure take two lines each; with less they are cut, and whole on hover.
const TWO_LINES: f32 = 370.0;
/// Room in which a cause and a cure take one line each.
const ONE_LINE: f32 = 560.0;

/// When the state last changed, on the window's clock.
#[derive(Clone, Copy, Debug, Default)]
pub struct TopBarState {
    seen: Option<(LoopState, f64)>,
}

/// The bar, with the switch of roles and the menu. While somebody's hands are on the arm (`calibrating`) it cannot be engaged.
pub fn top_bar_ui(
    ui: &mut Ui,
    live: &Live,
    state: &mut TopBarState,
    outbox: &mut Outbox,
    settings: &mut Settings,
    help: &mut Help,
    calibrating: bool,
) {
    let time_s = ui.input(|input| input.time);
    let now = live.state();
    let since_s = match state.seen {
        Some((seen, at_s)) if seen == now => time_s - at_s,
        Some(_) => {
            state.seen = Some((now, time_s));
            0.0
        }
        None => {
            state.seen = Some((now, time_s - STEP_WAITS_S));
            STEP_WAITS_S
        }
    };
    ui.horizontal_centered(|ui| {
        identity_ui(ui, live, settings, help, calibrating);
        ui.add_space(10.0);
        state_ui(ui, now);
        ui.add_space(10.0);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            stop_ui(ui, now, outbox);
            let blocked = calibrating && now == LoopState::Idle;
            step_ui(ui, now, since_s >= STEP_WAITS_S && !blocked, outbox);
            ui.add_space(6.0);
            alarms_ui(ui, live, &judge(&live.signs(outbox.stop_is_stuck())), time_s);
        });
    });
}

/// What this is, and under it the switch of roles and the menu.
fn identity_ui(ui: &mut Ui, live: &Live, settings: &mut Settings, help: &mut Help, calibrating: bool) {
    ui.vertical(|ui| {
        ui.add_space(8.0);
        ui.spacing_mut().item_spacing.y = 4.0;
        ui.horizontal(|ui| {
            ui.label(RichText::new("NIMA Console").font(theme::strong(19.0)));
            ui.label(small("Research software, not for clinical use"));
        });
        ui.horizontal(|ui| {
            switch_ui(ui, &mut settings.role, !calibrating);
            menu_ui(ui, settings, help);
            if ui.ctx().content_rect().width() >= SCENE_FROM {
                ui.add_space(4.0);
                ui.label(weak(&live.scene.name))
                    .on_hover_text(format!("Scene: {}\nRig: {}", live.scene.description, live.rig.name));
            }
        });
    });
}

fn state_ui(ui: &mut Ui, state: LoopState) {
    let (what, colour, meaning) = match state {
        LoopState::Disconnected => {
            (Sign::Ring, theme::now().text_weak, "A device that force needs is missing; it is opened again by itself.")
        }
        LoopState::Ready => {
            (Sign::Ring, theme::now().engaged, "Drives on, at rest, without force, until hand and tip agree.")
        }
        LoopState::Clutched => (
            Sign::Ring,
            theme::now().engaged,
            "The clutch is pressed: the hand moves freely, the follower rests, no force.",
        ),
        LoopState::Idle => {
            (Sign::Ring, theme::now().at_rest, "The loop measures. No force, no motion until it is engaged.")
        }
        LoopState::Engaged => {
            (Sign::Disc, theme::now().engaged, "The follower moves with the hand and force is fed back.")
        }
        LoopState::Stopped => {
            (Sign::Square, theme::now().stop, "Stopped by the operator: no force, no motion. Latched.")
        }
        LoopState::Faulted(_) => {
            (Sign::Triangle, theme::now().alarm_high, "Stopped by a fault: no force, no motion. Latched.")
        }
    };
    let (rect, response) = ui.allocate_exact_size(vec2(136.0, 44.0), Sense::hover());
    let response = response.on_hover_text(format!("State of the loop. {meaning}"));
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, format!("Loop state: {}", state.word())));
    ui.painter().rect(rect, theme::CORNER, theme::now().card, egui::Stroke::new(1.5, colour), egui::StrokeKind::Inside);
    sign(ui.painter(), what, rect.left_center() + vec2(24.0, 0.0), 8.5, colour);
    let place = rect.left_center() + vec2(44.0, 0.0);
    ui.painter().text(place, egui::Align2::LEFT_CENTER, state.word(), theme::strong(17.0), theme::now().text);
}

/// Always in the same place, always ready: pressing it twice does no harm.
fn stop_ui(ui: &mut Ui, state: LoopState, outbox: &mut Outbox) {
    let latched = matches!(state, LoopState::Stopped | LoopState::Faulted(_));
    let (fill, ink) = if latched {
        (theme::now().control, theme::now().text_weak)
    } else {
        (theme::now().stop, theme::now().background)
    };
    let text = RichText::new("      Stop").font(theme::strong(21.0)).color(ink);
    let button = Button::new(text).min_size(theme::STOP_SIZE).fill(fill).corner_radius(theme::CORNER);
    let response = ui.add(button);
    // The text leaves room for the sign; its name is one word.
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Stop"));
    let response = response.on_hover_text("Zero force and a resting follower at once. Space or Escape does the same.");
    sign(ui.painter(), Sign::Octagon, response.rect.left_center() + vec2(32.0, 0.0), 11.0, ink);
    if response.clicked() {
        outbox.push(Command::Stop);
    }
}

/// The one step that leads on from here, beside the stop and never under it.
fn step_ui(ui: &mut Ui, state: LoopState, ready: bool, outbox: &mut Outbox) {
    let (name, command, meaning) = match state {
        LoopState::Idle => ("Engage", Command::Engage, "Second step: motion and force feedback begin."),
        LoopState::Stopped => {
            ("Release stop", Command::ReleaseStop, "First of two steps: back to idle, still without force.")
        }
        LoopState::Faulted(_) => (
            "Release stop",
            Command::ReleaseStop,
            "First of two steps: back to idle. Refused while the cause of the fault lives.",
        ),
        LoopState::Engaged | LoopState::Ready | LoopState::Clutched | LoopState::Disconnected => {
            ui.add_space(theme::STOP_SIZE.x + 8.0);
            return;
        }
    };
    let text = RichText::new(name).font(theme::strong(17.0));
    let button = Button::new(text).min_size(theme::STOP_SIZE).corner_radius(theme::CORNER);
    if ui.add_enabled(ready, button).on_hover_text(meaning).clicked() {
        outbox.push(command);
    }
}

/// What is wrong; where nothing is, the last refusal.
fn alarms_ui(ui: &mut Ui, live: &Live, alarms: &[Alarm], time_s: f64) {
    let room = ui.available_rect_before_wrap();
    let room = Rect::from_center_size(room.center(), vec2(room.width(), ALARM_HEIGHT));
    let mut ui = ui.new_child(UiBuilder::new().max_rect(room).layout(Layout::left_to_right(Align::Center)));
    match alarms.first() {
        Some(first) => alarm_ui(&mut ui, first, alarms, time_s),
        None => refusal_ui(&mut ui, live),
    }
}

/// The most urgent alarm pinned with cause and cure; the others are counted and unfold on hover.
fn alarm_ui(ui: &mut Ui, first: &Alarm, alarms: &[Alarm], time_s: f64) {
    let colour = first.priority.colour(time_s);
    let frame = egui::Frame::new()
        .fill(theme::DARK.card)
        .stroke(egui::Stroke::new(1.5, colour))
        .corner_radius(theme::CORNER)
        .inner_margin(egui::Margin::symmetric(10, 2));
    let pinned = frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.set_height(ALARM_HEIGHT - 6.0);
        let (rect, _) = ui.allocate_exact_size(vec2(24.0, ALARM_HEIGHT - 6.0), Sense::hover());
        sign(ui.painter(), Sign::Triangle, rect.center(), 9.0, colour);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 1.0;
            let more = if alarms.len() > 1 { format!(" (+{} more)", alarms.len() - 1) } else { String::new() };
            let cause = format!("{}: {}{more}", first.priority.word(), first.cause);
            let cause = RichText::new(cause).font(theme::strong(13.0)).color(theme::DARK.text);
            let cure = RichText::new(&first.cure).font(theme::regular(12.0)).color(theme::DARK.text_weak);
            // In the middle when both take one line each.
            ui.add_space(if ui.available_width() > ONE_LINE { 12.0 } else { 0.0 });
            let narrow = ui.available_width() < TWO_LINES;
            for text in [cause, cure] {
                let label = egui::Label::new(text);
                ui.add(if narrow { label.truncate() } else { label.wrap() });
            }
        });
    });
    pinned.response.on_hover_ui(|ui| {
        for alarm in alarms {
            ui.label(RichText::new(format!("{}: {}", alarm.priority.word(), alarm.cause)).font(theme::strong(14.0)));
            ui.label(small(&alarm.cure));
        }
    });
}

fn refusal_ui(ui: &mut Ui, live: &Live) {
    let Some(command) = live.refusal() else { return };
    let words = match command {
        Command::Engage => "Engaging was refused: release the stop first",
        Command::ReleaseStop => "The stop was not released: nothing is stopped, or the cause of the fault still lives",
        _ => "The loop refused the last setting: it is outside its range",
    };
    ui.label(small(words));
}

#[cfg(test)]
mod tests {
    use nima::{device::Loss, runtime::Fault};

    use super::*;
    use crate::console::alarms::Priority;

    /// Room for the alarm in a window of 1280 points while a step button stands beside the stop.
    const ROOM_AT_1280: f32 = 430.0;

    #[test]
    fn every_fault_is_told_whole_with_its_cure_in_a_small_window() {
        let device = 3;
        let lost = [Loss::Disconnected, Loss::Silent, Loss::Corrupt, Loss::Implausible, Loss::Device { code: 7 }]
            .map(|loss| Fault::DeviceLost { device, loss });
        let stalled = Fault::LoopStalled { periods: 99 };
        let others = [Fault::SourceSilent, stalled, Fault::ForceUnknown, Fault::DrivesOff, Fault::OtherArm];
        for fault in lost.into_iter().chain(others) {
            let alarm = Alarm {
                priority: Priority::High,
                cause: format!("{} (at 1234.5 s)", fault.cause()),
                cure: fault.cure().to_owned(),
            };
            let mut bottom = 0.0;
            let mut harness = egui_kittest::Harness::new_ui(|ui| {
                theme::apply(ui.ctx());
                ui.set_width(ROOM_AT_1280);
                ui.horizontal(|ui| alarm_ui(ui, &alarm, &[alarm.clone(), alarm.clone()], 0.0));
                bottom = ui.min_rect().height();
            });
            harness.run_steps(2);
            drop(harness);
            assert!(bottom <= ALARM_HEIGHT + 6.0, "{bottom} points for \"{}\"", alarm.cause);
        }
    }
}
