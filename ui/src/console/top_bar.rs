//! The top bar, always visible: identity, state of the loop, problems, and the stop button.

use std::mem::discriminant;

use egui::{
    Align, Align2, Area, Button, Id, Label, Layout, Order, Rect, RichText, Sense, Stroke, TextStyle, Ui, WidgetInfo,
    vec2,
};
use egui_material_icons::icons;
use nima_machine::{
    messages::{Command, LoopState, Refusal},
    ready::PersonRequest,
    rig::Side,
};
use nima_panels::{
    rig_choice::has_real_arm,
    roles::{Role, switch_ui},
    settings::ConsoleSettings,
};
use nima_screen::{
    alarms::{MissingDevice, strip::Alarms},
    live::{LiveState, RefusedCommand},
    outbox::Outbox,
    scene3d::side_name,
    steady_button::SteadyButton,
    theme,
    widgets::{Sign, fitting_style, next_button, sign, weak, with_icon},
};
use nima_words::{
    report_text::{cure_of_refusal, refused_because, sentence, side_word, state_name},
    text::{self, current_session::DisplayState, of_files::of_file},
};

use crate::console::{
    commands::{Action, CommandEntry},
    menu::menu_ui,
};

/// After a change of state the next step is disabled for this time (s), so that a double click never triggers two steps.
const STEP_WAITS_S: f64 = 0.7;

/// Width of the window from which the scene's name is shown.
const SCENE_FROM: f32 = 1400.0;

#[derive(Debug, Default)]
pub(crate) struct TopBarState {
    /// The last state, and the time of its start on the window's clock.
    seen: Option<(LoopState, f64)>,
    /// Current and past alarms; their strip is below the bar.
    pub alarms: Alarms,
    /// Instruction of the ready check that concerns a button of the bar, which is then highlighted.
    pub(in crate::console) asked: Option<PersonRequest>,
    /// The ready check has passed: Engage is the next button.
    pub(in crate::console) leads_to_engage: bool,
    /// The session that is being recorded.
    pub(in crate::console) recorded: Option<DisplayState>,
    /// The command of the pressed button or menu entry.
    pub(in crate::console) wanted: Option<Action>,
    /// The next step requested from elsewhere, as if its button were pressed.
    pub(in crate::console) wants_step: Option<Action>,
    /// Whether undo and redo are possible.
    pub(in crate::console) can_undo: [bool; 2],
    /// A recorded session is on the screen: only stop acts on the machine.
    pub(in crate::console) past: bool,
    /// Participant of a running study trial: then only state, stop and engaging are offered.
    pub(in crate::console) participant: Option<String>,
}

/// Draws the bar, with role switch and menu. While a person guides the arm (`calibrating`), it cannot be engaged.
pub(crate) fn top_bar_ui(
    ui: &mut Ui,
    live: &LiveState,
    state: &mut TopBarState,
    outbox: &mut Outbox,
    settings: &mut ConsoleSettings,
    calibrating: bool,
) {
    let wants_step = state.wants_step.take();
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
        identity_ui(ui, live, settings, state, calibrating);
        ui.add_space(10.0);
        state_ui(ui, live, now);
        ui.add_space(10.0);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let (place, _) = ui.allocate_exact_size(theme::STOP_SIZE, Sense::hover());
            let of_past = state.past.then_some(text::playback::BLOCKED.get());
            let closed = match now {
                LoopState::Idle => of_past.or(live.engage_closed),
                LoopState::Disconnected => of_past.or(text::calibrations::closed(now)),
                _ => of_past,
            };
            state.leads_to_engage &= matches!(now, LoopState::Idle | LoopState::Disconnected);
            let next = state.asked == Some(PersonRequest::Release) || state.leads_to_engage && closed.is_none();
            let ready = since_s >= STEP_WAITS_S;
            // The ready check stalls the loop on purpose, and nothing can be engaged from its page.
            let may_engage = live.engage_closed.is_none();
            let short_stall =
                matches!(now, LoopState::Faulted(fault) if may_engage && fault.is_short_stall(live.rig.rate_hz));
            step_ui(ui, now, TopBarStep { ready, next, wanted: wants_step, closed, short_stall }, outbox);
            // Drawn after the step button to its left, so that keyboard focus follows the reading order.
            stop_ui(ui, place, now, state.asked == Some(PersonRequest::PressStop), outbox);
            ui.add_space(6.0);
            refusal_ui(ui, live);
        });
    });
}

/// Draws the role switch, the button of the start page, and the menu.
fn identity_ui(
    ui: &mut Ui,
    live: &LiveState,
    settings: &mut ConsoleSettings,
    state: &mut TopBarState,
    calibrating: bool,
) {
    if let Some(participant) = &state.participant {
        ui.label(RichText::new(participant).font(theme::strong(17.0)));
        return;
    }
    let view = switch_ui(ui, &Role::ALL, settings.role, !calibrating);
    let font = TextStyle::Button.resolve(ui.style());
    let words = with_icon(ui, icons::ICON_PRECISION_MANUFACTURING, text::start::OPEN.get(), font.clone());
    let start = Button::new(words).min_size(vec2(44.0, 30.0));
    let why = if state.past { text::playback::BLOCKED.get() } else { text::start::OPEN_DISABLED_HOVER.get() };
    let free = !calibrating && !state.past;
    let start = ui.add_enabled(free, start);
    start.widget_info(|| WidgetInfo::labeled(egui::Role::Button, free, text::start::OPEN.get()));
    let start = start.on_hover_text(text::start::OPEN_HOVER);
    let wants_start = start.on_disabled_hover_text(why).clicked();
    let of_menu = menu_ui(ui, settings, &mut state.alarms, state.can_undo);
    let words = with_icon(ui, icons::ICON_VIDEO_LIBRARY, text::playback::SESSIONS.get(), font);
    let sessions = ui.add_enabled(free, Button::new(words).min_size(vec2(72.0, 30.0)));
    sessions.widget_info(|| WidgetInfo::labeled(egui::Role::Button, free, text::playback::SESSIONS.get()));
    let sessions = sessions.on_hover_text(text::playback::SESSIONS_HOVER);
    let wants_sessions = sessions.on_disabled_hover_text(why).clicked();
    let keeps = recorded_ui(ui, state);
    state.wanted = of_menu
        .or(view.map(Action::View))
        .or(wants_start.then_some(Action::Rig))
        .or(wants_sessions.then_some(Action::Sessions))
        .or(keeps.then_some(Action::Keep));
    if ui.ctx().content_rect().width() >= SCENE_FROM {
        ui.add_space(4.0);
        let name = if has_real_arm(&live.rig) { &live.rig.name } else { &live.scene.name };
        let [description, rig] = [&live.scene.description, &live.rig.name].map(|words| of_file(words));
        ui.label(weak(of_file(name))).on_hover_text(text::top_bar::scene_and_rig(description, rig));
    }
}

/// Draws the duration of the recording on the button that keeps it; returns true when pressed.
fn recorded_ui(ui: &mut Ui, state: &TopBarState) -> bool {
    let Some(shown) = &state.recorded else { return false };
    // Room for the dot.
    let words = format!("   {}", text::sessions::recorded_for(shown.seconds, shown.kept));
    let button = Button::selectable(shown.kept, words).frame_when_inactive(true);
    // Wide enough for hours, so that its neighbour never moves.
    let response = ui.add(button.min_size(vec2(118.0, 30.0)));
    let dot = response.rect.left_center() + vec2(11.0, 0.0);
    sign(ui.painter(), Sign::Disc, dot, 4.0, theme::now().alarm_high);
    let name = if shown.kept { text::sessions::NAME_KEPT.get() } else { text::sessions::NAME_KEEP.get() };
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, shown.kept, name));
    response.on_hover_text(shown.explained()).clicked()
}

/// Draws the state of the arm that needs more attention. If the states differ, draws both in a column: an idle arm
/// must not hide that the other hand feels a force.
pub(in crate::console) fn state_ui(ui: &mut Ui, live: &LiveState, state: LoopState) {
    let (what, colour, meaning) = match state {
        LoopState::Disconnected => (Sign::Ring, theme::now().text_weak, text::top_bar::DISCONNECTED_MEANING.get()),
        LoopState::Ready => (Sign::Ring, theme::now().engaged, text::top_bar::READY_MEANING.get()),
        LoopState::Clutched => (Sign::Ring, theme::now().engaged, text::top_bar::CLUTCHED_MEANING.get()),
        LoopState::Idle => (Sign::Ring, theme::now().at_rest, text::top_bar::IDLE_MEANING.get()),
        LoopState::Engaged => (Sign::Disc, theme::now().engaged, text::top_bar::ENGAGED_MEANING.get()),
        LoopState::Stopped => (Sign::Square, theme::now().stop, text::top_bar::STOPPED_MEANING.get()),
        LoopState::Faulted(_) => (Sign::Triangle, theme::now().alarm_high, text::top_bar::FAULT_MEANING.get()),
    };
    let lines = state_lines(live, state);
    // Two lines contain the names of the arms, so they are wider.
    let width = if lines.len() > 1 { 156.0 } else { 136.0 };
    let (rect, response) = ui.allocate_exact_size(vec2(width, 44.0), Sense::hover());
    let response = response.on_hover_text(text::top_bar::state_meaning(meaning));
    let name = text::top_bar::state(&lines.join(", "));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
    ui.painter().rect(rect, theme::CORNER, theme::now().card, egui::Stroke::new(1.5, colour), egui::StrokeKind::Inside);
    sign(ui.painter(), what, rect.left_center() + vec2(24.0, 0.0), 8.5, colour);
    let (size, height) = if lines.len() > 1 { (13.0, 17.0) } else { (17.0, 0.0) };
    for (line, offset) in lines.iter().zip([-0.5 * height, 0.5 * height]) {
        let place = rect.left_center() + vec2(44.0, offset);
        ui.painter().text(place, egui::Align2::LEFT_CENTER, line, theme::strong(size), theme::now().text);
    }
}

fn state_lines(live: &LiveState, state: LoopState) -> Vec<String> {
    let states: Vec<(Side, LoopState)> =
        live.sides().filter_map(|side| Some((side, live.tick_of(side)?.state))).collect();
    if states.iter().all(|(_, of_side)| discriminant(of_side) == discriminant(&state)) {
        return vec![state_name(state).to_owned()];
    }
    states
        .into_iter()
        .rev()
        .map(|(side, state)| text::top_bar::state_of_side(side_name(side), state_name(state)))
        .collect()
}

/// Always in the same place, above every window, menu and tooltip, and always enabled: pressing it twice does no harm.
fn stop_ui(ui: &Ui, place: Rect, state: LoopState, next: bool, outbox: &mut Outbox) {
    let area = Area::new(Id::unique("stop")).order(Order::TOP).fixed_pos(place.min).default_size(place.size());
    let pressed =
        area.movable(false).constrain(false).fade_in(false).show(ui.ctx(), |ui| stop_button_ui(ui, state, next)).inner;
    if pressed {
        outbox.push(Command::Stop);
    }
}

/// Draws the stop button, highlighted as the `next` one; returns true when pressed.
pub(in crate::console) fn stop_button_ui(ui: &mut Ui, state: LoopState, next: bool) -> bool {
    let latched = matches!(state, LoopState::Stopped | LoopState::Faulted(_));
    let (fill, ink) = if latched {
        (theme::now().control, theme::now().text_weak)
    } else {
        (theme::now().stop, theme::now().background)
    };
    let mut button = Button::new("").min_size(theme::STOP_SIZE).fill(fill).corner_radius(theme::CORNER);
    if next {
        button = button.stroke(Stroke::new(6.0, theme::now().primary));
    }
    let response = ui.add(button);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, text::top_bar::STOP.get()));
    let response = response.on_hover_text(text::top_bar::STOP_HOVER);
    let middle = response.rect.center();
    sign(ui.painter(), Sign::Octagon, middle - vec2(34.0, 0.0), 11.0, ink);
    ui.painter().text(
        middle - vec2(12.0, 0.0),
        Align2::LEFT_CENTER,
        text::top_bar::STOP.get(),
        theme::strong(21.0),
        ink,
    );
    response.clicked()
}

/// State of the next step.
#[derive(Clone, Copy)]
struct TopBarStep {
    /// The state has lasted long enough for a next step.
    ready: bool,
    /// Whether the button is highlighted.
    next: bool,
    /// The request from elsewhere.
    wanted: Option<Action>,
    /// Reason why the button cannot be pressed.
    closed: Option<&'static str>,
    /// The fault is left by engaging directly.
    short_stall: bool,
}

/// Draws the button for the next step, next to the stop button and never below it.
fn step_ui(ui: &mut Ui, state: LoopState, step: TopBarStep, outbox: &mut Outbox) {
    let TopBarStep { ready, next, wanted, closed, short_stall } = step;
    let (action, command, meaning) = match state {
        LoopState::Faulted(_) if short_stall => {
            (Action::Engage, Command::Engage, text::top_bar::ENGAGE_AFTER_STALL_HOVER.get())
        }
        LoopState::Idle | LoopState::Disconnected => {
            (Action::Engage, Command::Engage, text::top_bar::ENGAGE_HOVER.get())
        }
        LoopState::Stopped => (Action::Release, Command::ReleaseStop, text::top_bar::RELEASE_STOP_HOVER.get()),
        LoopState::Faulted(_) => (Action::Release, Command::ReleaseStop, text::top_bar::RELEASE_FAULT_HOVER.get()),
        LoopState::Engaged | LoopState::Ready | LoopState::Clutched => {
            ui.add_space(theme::STOP_SIZE.x + 8.0);
            return;
        }
    };
    let name = CommandEntry::of(action).map_or("", |entry| entry.title.as_str());
    let waits = (!ready).then_some(text::top_bar::JUST_CHANGED.get());
    let may = closed.or(waits).map_or(Ok(()), Err);
    // A click never waits: the machine moves at once or not at all.
    let button = SteadyButton { id: Id::unique("step"), label: name, meaning, may, waits_s: 0.0 };
    let pressed = button.ui(ui, |name, _| {
        let name = RichText::new(name).font(theme::strong(17.0));
        next_button(name, next).min_size(theme::STOP_SIZE).corner_radius(theme::CORNER)
    });
    if pressed || ready && closed.is_none() && wanted == Some(action) {
        outbox.push(command);
    }
}

/// Text of the last refused command.
#[derive(Debug)]
pub(in crate::console) struct DisplayRefusal {
    what: String,
    /// The same with the cause.
    because: String,
    cure: String,
}

impl DisplayRefusal {
    /// Returns the text for some seconds after a refusal.
    pub(in crate::console) fn of(live: &LiveState) -> Option<Self> {
        let RefusedCommand { side, command, why } = live.refusal()?;
        let what = match command {
            Command::Engage | Command::EngageOne(_) => text::top_bar::NOT_ENGAGED.get(),
            Command::ReleaseStop => text::top_bar::NOT_RELEASED.get(),
            _ => text::top_bar::NOT_SET.get(),
        };
        let arm = if live.is_bimanual() { side_word(side) } else { "" };
        let what = text::top_bar::refused(what, arm);
        // If a device is missing, show the reason from the list of devices.
        let missing = live.missing().next().filter(|_| why == Refusal::State(LoopState::Disconnected));
        let (cause, cure) = match missing {
            Some(MissingDevice { name, cause, cure, .. }) => (text::top_bar::device(&name, &cause), cure),
            None => (refused_because(why), cure_of_refusal(why).to_owned()),
        };
        let because = text::top_bar::refused_because(&what, &cause);
        Some(Self { what, because, cure })
    }

    /// Returns the lines for the alarm strip: command and cause, and the remedy.
    pub(in crate::console) fn lines(self) -> [String; 2] {
        [self.because, sentence(&self.cure)]
    }
}

/// Draws the last refused command in one line; hovering over it shows cause and remedy. The alarm strip has room for
/// both, but may be needed for an alarm.
fn refusal_ui(ui: &mut Ui, live: &LiveState) {
    let Some(DisplayRefusal { what, because, cure }) = DisplayRefusal::of(live) else { return };
    let whole = text::top_bar::refused_with_cure(&because, &cure);
    let font = fitting_style(ui, &what, &TextStyle::Small, ui.available_width());
    let response = ui.add(Label::new(weak(what).font(font)).extend());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &whole));
    response.on_hover_text(whole);
}

#[cfg(test)]
mod tests {
    use nima_machine::config::RigConfig;
    use nima_simulation::{SimulationPlan, run_virtual, scene::Scene};

    use super::*;

    #[test]
    fn an_idle_arm_does_not_hide_that_the_other_one_is_engaged() {
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load("bimanual").unwrap();
        let plan =
            SimulationPlan { rig: rig.clone(), scene: scene.clone(), calibrations: Default::default(), engage: true };
        let mut live = LiveState::new(rig, scene);
        run_virtual(&plan, 1.0, |tick| {
            live.ticks[tick.side.index()] = Some(*tick);
            None
        })
        .unwrap();
        assert_eq!(state_lines(&live, live.state()), ["Engaged"]);
        live.ticks[Side::Left.index()].as_mut().unwrap().state = LoopState::Idle;
        assert_eq!(state_lines(&live, live.state()), ["Left: Idle", "Right: Engaged"]);
    }
}
