//! A window that only shows a rig at another machine, for example on the surgeon's second screen or a teacher's screen.
//!
//! The views are the same as in the console, with data from the rig. Their commands are discarded: there is no
//! connection back.

use std::{
    path::PathBuf,
    time::{Duration, Instant},
};

use crossbeam_channel::{Receiver, Sender, unbounded};
use eframe::glow;
use egui::{Align, CentralPanel, Color32, Frame, Label, Layout, Margin, Panel, RichText, Stroke, StrokeKind, Ui};
use nima_machine::config::RigConfig;
use nima_panels::{
    roles::{Panels, Role, role_ui, switch_ui},
    settings::ConsoleSettings,
};
use nima_screen::{
    alarms::judge, live::LiveState, outbox::Outbox, scene3d::SceneView, screenshot, stderr::print_line, theme,
    widgets::weak,
};
use nima_session::monitor_stream::MonitorMoment;
use nima_simulation::scene::Scene;
use nima_wizards::active_calibrations::ActiveCalibrations;
use nima_words::{
    language::{self, Language},
    text,
};

use crate::console::{keys, top_bar::state_ui};

const HEAD: f32 = 72.0;
/// A demonstration drives its rig, which a monitor cannot.
const ROLES: [Role; 2] = [Role::Surgeon, Role::Technician];
const SWITCH: egui::Vec2 = egui::vec2(150.0, 40.0);
const FRAME: f32 = 4.0;
/// Silence of this length is shown, s.
const SILENT_S: f64 = 1.0;
/// Interval between frames: about thirty per second.
const EVERY: Duration = Duration::from_millis(31);
/// Time to take the screenshot before the window closes.
const SCREENSHOT_BEFORE_EXIT: Duration = Duration::from_millis(700);

/// Data from the rig.
#[derive(Debug)]
pub enum MonitorMessage {
    /// A loop of this rig is running there.
    Runs(Box<RigConfig>, Box<Scene>),
    /// No loop is running there.
    Rests,
    Shows(Vec<MonitorMoment>),
    /// Reason for missing data.
    Trouble(String),
}

/// Sends data from the rig to the window; each call wakes the window.
#[derive(Clone, Debug)]
pub struct MonitorSender {
    to: Sender<MonitorMessage>,
    ctx: egui::Context,
}

impl MonitorSender {
    /// Returns false after the window was closed.
    pub fn notify(&self, received: MonitorMessage) -> bool {
        let report = self.to.send(received).is_ok();
        self.ctx.request_repaint();
        report
    }
}

#[derive(Clone, Debug, Default)]
pub struct MonitorOptions {
    pub role: Role,
    pub language: Language,
    pub exit_after: Option<Duration>,
    pub screenshot: Option<PathBuf>,
}

#[derive(Debug)]
pub struct Monitor {
    rig: String,
    came: Receiver<MonitorMessage>,
    live: Option<Box<LiveState>>,
    trouble: Option<String>,
    /// Time of the last new data.
    received: Instant,
    panels: Panels,
    active: ActiveCalibrations,
    /// Receives the commands of the views; they are never sent.
    outbox: Outbox,
    settings: ConsoleSettings,
    options: MonitorOptions,
    opened: Instant,
    shown: bool,
}

impl Monitor {
    /// Creates a window for the rig of this name, and the sender of its data.
    pub fn new(cc: &eframe::CreationContext<'_>, rig: &str, options: MonitorOptions) -> (Self, MonitorSender) {
        theme::apply(&cc.egui_ctx);
        let (to, came) = unbounded();
        let now = Instant::now();
        let monitor = Self {
            rig: rig.to_owned(),
            came,
            live: None,
            trouble: None,
            received: now,
            panels: Panels { scene: SceneView::new(cc.gl.as_deref()), ..Panels::default() },
            active: ActiveCalibrations::of_past(Vec::new()),
            outbox: Outbox::default(),
            settings: ConsoleSettings { role: options.role, ..ConsoleSettings::default() },
            options,
            opened: now,
            shown: false,
        };
        (monitor, MonitorSender { to, ctx: cc.egui_ctx.clone() })
    }

    pub fn live(&self) -> Option<&LiveState> {
        self.live.as_deref()
    }

    fn take_in(&mut self) {
        let before_s = self.shown_s();
        for received in self.came.try_iter() {
            match received {
                MonitorMessage::Runs(rig, scene) => {
                    self.live = Some(Box::new(LiveState::of_elsewhere(*rig, *scene)));
                    self.trouble = None;
                    self.received = Instant::now();
                }
                MonitorMessage::Rests => {
                    (self.live, self.trouble) = (None, Some(text::monitor::RESTS.get().to_owned()));
                }
                MonitorMessage::Trouble(why) => self.trouble = Some(why),
                MonitorMessage::Shows(moments) => {
                    let Some(live) = &mut self.live else { continue };
                    for MonitorMoment { events, ticks, objects } in moments {
                        live.replay(events.iter(), &ticks);
                        live.show_newer_objects(objects);
                    }
                    self.trouble = None;
                    self.received = Instant::now();
                }
            }
        }
        let passed_s = self.shown_s() - before_s;
        if let Some(live) = self.live.as_mut().filter(|_| passed_s > 0.0) {
            live.settle(passed_s);
        }
    }

    fn shown_s(&self) -> f64 {
        self.live.as_ref().and_then(|live| live.first_tick()).map_or(0.0, |tick| tick.t_s)
    }

    /// Returns the reason why the display is out of date.
    fn stale(&self) -> Option<String> {
        let seconds = self.received.elapsed().as_secs_f64();
        let silent = self.live.is_some() && seconds > SILENT_S;
        self.trouble.clone().or_else(|| silent.then(|| text::monitor::silent(seconds)))
    }

    fn head_ui(&mut self, ui: &mut Ui) {
        let frame = Frame::new().fill(theme::now().panel).inner_margin(Margin::symmetric(14, 0));
        Panel::top("watching").exact_size(HEAD).resizable(false).frame(frame).show(ui, |ui| {
            ui.horizontal_centered(|ui| {
                let word =
                    RichText::new(text::monitor::WATCHING).font(theme::strong(26.0)).color(theme::now().watching);
                ui.label(word).on_hover_text(text::monitor::WATCHING_HOVER);
                ui.add_space(10.0);
                let scene = self.live.as_ref().map(|live| live.scene.name.clone()).unwrap_or_default();
                let [rig, scene] = [&self.rig, &scene].map(|words| text::of_files::of_file(words));
                let words = text::monitor::rig_and_scene(rig, scene);
                ui.label(RichText::new(words).font(theme::strong(19.0)));
                ui.add_space(10.0);
                let stale = self.stale();
                if let Some(live) = self.live.as_ref().filter(|_| stale.is_none()) {
                    state_ui(ui, live, live.state());
                    ui.add_space(10.0);
                }
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    // Laid out from right to left.
                    ui.allocate_ui_with_layout(SWITCH, Layout::left_to_right(Align::Center), |ui| {
                        let pressed = switch_ui(ui, &ROLES, self.settings.role, true);
                        self.settings.role = pressed.unwrap_or(self.settings.role);
                    });
                    ui.with_layout(Layout::left_to_right(Align::Center), |ui| self.words_ui(ui, stale));
                });
            });
        });
    }

    /// Draws the reason why the display is out of date, otherwise the alarm at the rig.
    fn words_ui(&self, ui: &mut Ui, stale: Option<String>) {
        let stale = stale.map(|words| (words, theme::now().alarm_high));
        let Some((words, colour)) = stale.or_else(|| alarm_of(self.live.as_deref()?)) else { return };
        let label = RichText::new(&words).font(theme::strong(16.0)).color(colour);
        ui.add(Label::new(label).truncate()).on_hover_text(words);
    }

    fn view_ui(&mut self, ui: &mut Ui) {
        let stale = self.stale();
        let Self { live, settings, panels, active, outbox, .. } = self;
        let Some(live) = live else {
            let words = stale.unwrap_or_else(|| text::monitor::CONNECTING.get().to_owned());
            ui.centered_and_justified(|ui| ui.label(weak(words)));
            return;
        };
        if stale.is_some() {
            ui.set_opacity(0.45);
        }
        role_ui(ui, settings, live, panels, active, outbox);
        outbox.forget();
    }

    fn obey_options(&mut self, ctx: &egui::Context) {
        let open = self.opened.elapsed();
        let MonitorOptions { exit_after, screenshot, .. } = &self.options;
        let Some(exit_after) = *exit_after else { return };
        if let Some(path) = screenshot.clone().filter(|_| !self.shown && open + SCREENSHOT_BEFORE_EXIT >= exit_after) {
            self.shown = true;
            ctx.request_screenshot(move |image| {
                if let Err(error) = screenshot::save(&path, &image) {
                    print_line(format_args!("{error:#}"));
                }
            });
        }
        if open >= exit_after {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }
}

impl eframe::App for Monitor {
    fn logic(&mut self, _ctx: &egui::Context, _frame: &mut eframe::Frame) {
        language::set(self.options.language);
        self.take_in();
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        language::set(self.options.language);
        let ctx = ui.ctx().clone();
        if let Some(role) = keys::role_pressed(&ctx).filter(|role| ROLES.contains(role)) {
            self.settings.role = role;
        }
        let room = ui.available_rect_before_wrap();
        self.head_ui(ui);
        CentralPanel::no_frame().show(ui, |ui| self.view_ui(ui));
        ui.painter().rect_stroke(room, 0.0, Stroke::new(FRAME, theme::now().watching), StrokeKind::Inside);
        self.obey_options(&ctx);
        ctx.request_repaint_after(if self.live.is_some() { EVERY } else { Duration::from_millis(250) });
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        theme::now().background.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self, gl: Option<&glow::Context>) {
        if let Some(gl) = gl {
            self.panels.scene.destroy(gl);
        }
    }
}

/// Opens the window; `begin` starts the source of its data. Returns when the window is closed.
///
/// # Errors Returns an error if no window can be opened.
pub fn open(rig: &str, options: MonitorOptions, begin: impl FnOnce(MonitorSender)) -> anyhow::Result<()> {
    let title = language::with(options.language, || text::monitor::title(rig));
    let create: eframe::AppCreator<'_> = Box::new(|cc| {
        let (monitor, publisher) = Monitor::new(cc, rig, options);
        begin(publisher);
        Ok(Box::new(monitor))
    });
    let ended = crate::console::open_window(&title, create);
    language::set(Language::English);
    ended
}

/// Returns the most urgent alarm at the rig, in the colour of its priority.
fn alarm_of(live: &LiveState) -> Option<(String, Color32)> {
    let alarm = judge(&live.signs(false, None)).into_iter().next()?;
    Some((text::monitor::alarm(alarm.priority.word(), &alarm.cause), alarm.priority.ink()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_is_not_as_red_as_an_alarm() {
        let plan = nima_tests::plan("peg_transfer");
        let mut live = LiveState::of_elsewhere(plan.rig, plan.scene);
        assert_eq!(alarm_of(&live), None);
        live.is_unchecked = true;
        assert_eq!(alarm_of(&live).map(|(_, colour)| colour), Some(theme::now().alarm_low));
    }
}
