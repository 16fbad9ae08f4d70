//! Always there: what this is, the state of the loop, what is wrong, and the way to stop.

use egui::{Align, Button, Layout, Rect, RichText, Sense, Ui, UiBuilder, vec2};
use nima::{runtime::Command, teleop::LoopState};

use crate::console::{
    alarms::{Alarm, judge},
    live::Live,
    menu::menu_ui,
    outbox::Outbox,
    roles::switch_ui,
    settings::Settings,
    theme,
    widgets::{Sign, sign, small},
};

/// After a change of state the next step waits this long (s), so that a double click is never two steps.
const STEP_WAITS_S: f64 = 0.7;

/// Width of the window from which there is room for the scene's name.
const SCENE_FROM: f32 = 1400.0;

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
        identity_ui(ui, live);
        ui.add_space(10.0);
        state_ui(ui, now);
        ui.add_space(10.0);
        switch_ui(ui, &mut settings.role, !calibrating);
        menu_ui(ui, settings);
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

fn identity_ui(ui: &mut Ui, live: &Live) {
    ui.vertical(|ui| {
        ui.add_space(9.0);
        ui.spacing_mut().item_spacing.y = 3.0;
        ui.horizontal(|ui| {
            ui.label(RichText::new("NIMA Console").font(theme::strong(19.0)));
            if ui.ctx().content_rect().width() < SCENE_FROM {
                return;
            }
            ui.label(RichText::new(&live.scene.name).color(theme::now().text_weak))
                .on_hover_text(format!("Scene: {}\nRig: {}", live.scene.description, live.rig.name));
        });
        ui.label(small("Research software, not for clinical use"));
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

/// The most urgent alarm pinned with cause and cure; the others are counted and unfold on hover.
fn alarms_ui(ui: &mut Ui, live: &Live, alarms: &[Alarm], time_s: f64) {
    let room = ui.available_rect_before_wrap();
    let room = Rect::from_center_size(room.center(), vec2(room.width(), 56.0));
    let mut ui = ui.new_child(UiBuilder::new().max_rect(room).layout(Layout::left_to_right(Align::Center)));
    let Some(first) = alarms.first() else {
        refusal_ui(&mut ui, live);
        return;
    };
    let colour = first.priority.colour(time_s);
    let frame = egui::Frame::new()
        .fill(theme::DARK.card)
        .stroke(egui::Stroke::new(1.5, colour))
        .corner_radius(theme::CORNER)
        .inner_margin(egui::Margin::symmetric(12, 5));
    let pinned = frame.show(&mut ui, |ui| {
        ui.set_width(ui.available_width());
        ui.set_height(44.0);
        let (rect, _) = ui.allocate_exact_size(vec2(26.0, 44.0), Sense::hover());
        sign(ui.painter(), Sign::Triangle, rect.center(), 9.0, colour);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            ui.add_space(4.0);
            let more = if alarms.len() > 1 { format!("   (+{} more)", alarms.len() - 1) } else { String::new() };
            let cause = format!("{}: {}{more}", first.priority.word(), first.cause);
            ui.add(egui::Label::new(RichText::new(cause).font(theme::strong(14.0)).color(theme::DARK.text)).truncate());
            ui.add(egui::Label::new(small(&first.cure).color(theme::DARK.text_weak)).truncate());
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
