//! The window: receives data from the loop, lays out the panels, and sends the operator's commands.

mod availability;
mod calibrating;
mod checking;
mod connecting;
mod dispatch;
mod frame_rate;
mod loop_start;
mod opening;
mod paging;
mod playback_mode;
mod setting_up;
mod shown_page;
mod starting;
mod views;
mod visible_state;
mod windows;

use std::{
    path::PathBuf,
    time::{Duration, Instant},
};

use eframe::glow;
use egui::{Frame, Id, Margin, Panel, Ui, UiBuilder};
use nima_machine::{config::RigConfig, messages::Command, rig::Side, runtime::LoopHandle};
use nima_panels::{rig_choice::RigChoice, roles::Panels, settings::SettingsStore, tiles::PanelTiles};
use nima_playback::list::SessionList;
use nima_screen::{
    alarms::judge,
    frames::FrameMeter,
    link::Reopen,
    live::LiveState,
    loop_connection::{LoopConnection, LoopMessage},
    objects,
    outbox::Outbox,
    renderer::{is_software, renderer_of},
    run_log::RunLog,
    scene3d::SceneView,
    theme,
    units::PlotUnits,
};
use nima_simulation::{ObjectFeed, scene::Scene, screen::Screen};
use nima_wizards::{Wizards, active_calibrations::ActiveCalibrations};
use nima_words::{
    language::{self, Language},
    text,
};

use crate::console::{
    ConsoleOptions,
    commands::{Action, Availability},
    help::Help,
    keys, menu,
    page::Page,
    palette::CommandPalette,
    reader::ScreenReader,
    screenshots::ScreenshotRun,
    sessions::ConsoleSessions,
    start::StartPage,
    top_bar::{DisplayRefusal, TopBarState, top_bar_ui},
    undo::LookHistory,
};
use crate::{
    emulators::Emulators,
    extras::{self, Extra},
};
use checking::CheckPage;
use loop_start::door_of;
pub(crate) use loop_start::{StartedLoop, start_recorded};
use shown_page::{ShownPage, WayBack};
use starting::StartingRig;

/// Antialiasing in 3-D is switched off if the median time between frames is longer than this (fewer than 26 frames per
/// second) after [`WARM_UP`].
const SLOW_MS: f64 = 38.0;
/// Time after which the window has warmed up, so that its frame rate can be judged.
const WARM_UP: Duration = Duration::from_secs(4);

#[derive(Debug)]
pub struct ConsoleApp {
    door: Option<LoopConnection>,
    /// Only in tests: the window shows the same state in every frame.
    frozen: bool,
    /// The emulators of an emulated rig; they end after the loop.
    emulators: Option<Emulators>,
    /// The emulators' technician, who follows the wizards' instructions.
    reader: Option<ScreenReader>,
    running: RigChoice,
    starting: Option<StartingRig>,
    start: StartPage,
    /// Speed of loops in simulated time, as a multiple of real time.
    simulated_speed: Option<f64>,
    /// Opens the link to the machine with the arm, if it is another machine.
    reopen: Option<Reopen>,
    /// Source of a simulated rig's objects.
    objects: Option<ObjectFeed>,
    /// Program that starts emulators: this program, except in a test.
    program: Option<PathBuf>,
    /// Wakes the window from another thread.
    ctx: egui::Context,
    live: LiveState,
    outbox: Outbox,
    top_bar: TopBarState,
    panels: Panels,
    settings: SettingsStore,
    help: Help,
    palette: CommandPalette,
    history: LookHistory,
    photographer: Option<ScreenshotRun>,
    wizards: Wizards,
    checking: CheckPage,
    /// The way back from a wizard or the check.
    way_back: WayBack,
    list: SessionList,
    /// The page of an extra that may reserve the machine.
    page: Option<Box<dyn Page>>,
    /// The content below the top bar.
    shown: ShownPage,
    active: ActiveCalibrations,
    diary: RunLog,
    sessions: ConsoleSessions,
    /// Scene that was shown before a wizard changed it.
    watched: Option<Scene>,
    /// The last screen that the emulated rig's technician has read.
    read: Option<Screen>,
    options: ConsoleOptions,
    renderer: String,
    meter: Option<FrameMeter>,
    opened: Instant,
    framed: Instant,
    /// Time at which a side was last engaged or a wizard was open.
    moved: Instant,
    /// Time at which the waiting ticks and events were last read.
    taken: Instant,
    /// The requested screenshot has been taken.
    is_photographed: bool,
    /// Few frames are drawn, because nothing is engaged.
    calm: bool,
}

impl ConsoleApp {
    /// Creates the console for a running loop. Sets fonts and style of the context; draws in 3-D if OpenGL is available.
    pub fn new(cc: &eframe::CreationContext<'_>, handle: LoopHandle, rig: RigConfig, scene: Scene) -> Self {
        extras::offer();
        theme::apply(&cc.egui_ctx);
        let now = Instant::now();
        let renderer = cc.gl.as_deref().map(renderer_of).unwrap_or_default();
        let active = ActiveCalibrations::load(None, &rig, &scene);
        let mut live = LiveState::new(rig, scene);
        live.rough_edges = is_software(&renderer);
        Self {
            renderer,
            meter: None,
            door: Some(door_of(handle, &cc.egui_ctx)),
            frozen: false,
            emulators: None,
            reader: None,
            running: RigChoice::default(),
            starting: None,
            start: StartPage::new(RigChoice::default()),
            simulated_speed: None,
            reopen: None,
            objects: None,
            program: None,
            ctx: cc.egui_ctx.clone(),
            active,
            diary: RunLog::default(),
            sessions: ConsoleSessions::default(),
            wizards: Wizards::default(),
            checking: CheckPage::default(),
            way_back: WayBack::default(),
            list: SessionList::default(),
            page: extras::part(Extra::page).map(|page| page()),
            shown: ShownPage::default(),
            watched: None,
            read: None,
            live,
            outbox: Outbox::default(),
            top_bar: TopBarState::default(),
            panels: Panels {
                scene: SceneView::new(cc.gl.as_deref()),
                desk: PanelTiles::with_windows(),
                ..Panels::default()
            },
            settings: SettingsStore::default(),
            help: Help::default(),
            palette: CommandPalette::default(),
            history: LookHistory::default(),
            photographer: None,
            options: ConsoleOptions::default(),
            opened: now,
            framed: now,
            moved: now,
            taken: now,
            is_photographed: false,
            calm: false,
        }
    }

    /// Reads all data that the loop has sent.
    fn take_in(&mut self) {
        if self.frozen {
            return;
        }
        if let Some(moment) = self.objects.as_ref().and_then(ObjectFeed::newest) {
            let scene = &self.live.scene;
            let has_jaws = Side::ALL.map(|side| scene.objects.is_some() && scene.has(&self.live.rig, side));
            self.live.objects = Some(objects::objects(&moment, has_jaws));
            self.live.training = Some(moment.training);
        }
        let Some(door) = &self.door else { return };
        self.taken = Instant::now();
        let rate_hz = self.live.rig.rate_hz;
        let wizards = &mut self.wizards;
        let wizard = self.shown.wizard();
        let active = &mut self.active;
        let diary = &mut self.diary;
        let eyes = &mut self.panels.eyes;
        let calibrated = active.side();
        let mut check = self.checking.run_mut();
        let mut run = self.page.as_mut().and_then(|page| page.run_mut());
        self.live.take_in(door, |news| {
            if let Some(check) = &mut check {
                check.take(news);
            }
            let LoopMessage::Tick(tick) = news else { return };
            if let Some(which) = wizard.filter(|_| tick.side == calibrated) {
                wizards.tick(which, tick, rate_hz);
            }
            active.watch(tick);
            eyes.note(tick);
            match &mut run {
                // A trial of a study records the tick; its diary includes the mode.
                Some(run) => run.tick(tick),
                None if tick.side == Side::Right => diary.tick(tick),
                None => {}
            }
        });
        if active.meet(door.handle(), &self.live.rig)[calibrated.index()] {
            self.forget_what_was_taken();
        }
        (self.live.bias_side, self.live.bias_moved_n) = self.active.bias_moved().unzip();
        self.live.tested = self.checking.tested();
    }

    fn layout(&mut self, ui: &mut Ui) {
        let bar = Frame::new().fill(theme::now().panel).inner_margin(Margin::symmetric(14, 0));
        Panel::top("top_bar").exact_size(56.0).resizable(false).frame(bar).show(ui, |ui| {
            let calibrating = self.is_calibrating();
            self.live.engage_closed = match self.may(Action::Engage) {
                Availability::Cannot(why) => Some(why),
                Availability::Can | Availability::Absent => None,
            };
            self.top_bar.participant = self.run().map(|run| run.participant().to_owned());
            self.top_bar.asked = self.checking.ask();
            self.top_bar.past = self.shown.is_past();
            self.top_bar.can_undo = [self.history.can_undo(), self.history.can_redo()];
            self.sessions.look_after();
            self.top_bar.recorded = self.sessions.shown();
            let live = &self.live;
            let bar = &mut self.top_bar;
            let settings = &mut self.settings.now;
            top_bar_ui(ui, live, bar, &mut self.outbox, settings, calibrating);
            if let Some(action) = self.top_bar.wanted.take() {
                self.act(action, ui.ctx());
            }
        });
        let signs = self.live.signs(self.outbox.stop_is_stuck(), self.sessions.trouble());
        let loop_s = self.live.first_tick().map(|tick| tick.t_s);
        let next = text::alarms::next_step(self.live.state(), self.live.engage_closed);
        let refused = DisplayRefusal::of(&self.live).map(DisplayRefusal::lines);
        let sounds = self.settings.now.sound;
        self.top_bar.alarms.strip_ui(ui, &signs, loop_s, sounds, &next, refused.as_ref());
        let written = || judge(&self.live.signs(self.outbox.stop_is_stuck(), self.sessions.trouble()));
        let written = language::with(Language::English, written);
        self.sessions.notify(&self.live.marks_s, &self.top_bar.alarms.log, &written, loop_s);
        let room = ui.available_rect_before_wrap();
        // A separate id: an alarm that appears above must not end the drag of a slider.
        ui.scope_builder(UiBuilder::new().scope_id(Id::unique("page")), |ui| self.page_layout(ui));
        self.top_bar.alarms.list_ui(ui.ctx(), room);
        self.settings.now.toured |= self.help.ui(ui.ctx(), room, matches!(self.shown, ShownPage::Monitor));
        self.welcome(ui.ctx(), room);
        self.palette_ui(ui.ctx(), room);
    }
}

impl eframe::App for ConsoleApp {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.use_language();
        if self.only_flashes(ctx) {
            return;
        }
        // Even while the window is hidden, so that the queues stay empty and the history stays complete.
        self.go_on_starting();
        self.take_in();
        self.ask();
        self.go_on_checking();
        self.go_on_with_page();
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.use_language();
        self.measure(&ctx, frame);
        // Do not switch it on again, because a view that keeps changing its look would be worse.
        // In simulated time (in tests), the period of the frames says nothing about the renderer.
        let slow = self.simulated_speed.is_none()
            && self.opened.elapsed() > WARM_UP
            && self.live.figures.frame_ms[0] > SLOW_MS;
        // Screenshots for the documentation are always antialiased, however long that takes.
        self.live.rough_edges = self.photographer.is_none() && (self.live.rough_edges || slow);
        self.panels.scene.smooth = !self.live.rough_edges;
        self.sessions.reel().rest(!self.settings.now.records_image);
        self.panels.eyes.show_as(self.settings.now.image);
        self.panels.eyes.serve(self.live.rig.endoscope.as_ref(), self.sessions.reel(), &ctx);
        self.panels.devices.image = self.panels.eyes.report();
        menu::apply(&ctx, &self.settings.now);
        self.close_welcome_by_key(&ctx);
        if keys::stop_pressed(&ctx) {
            self.outbox.push(Command::Stop);
            self.palette.close();
        }
        self.obey_commands(&ctx);
        // Use the elapsed time: `stable_dt` is 1/60 s in every window that waits between frames.
        self.go_on_in_past(f64::from(ui.input(|input| input.unstable_dt)));
        self.layout(ui);
        self.windows_layout(&ctx);
        self.end_hidden_drive();
        if !matches!(self.shown, ShownPage::Start) {
            self.start.rest();
        }
        self.remember_look(&ctx);
        self.settings.now.units = PlotUnits::of(&ctx);
        self.settings.save();
        self.compute_shown();
        if self.shown.is_past() {
            self.outbox.only_stop();
        }
        if self.live.line.is_some() {
            self.outbox.without_delay();
        }
        self.outbox.flush(self.door.as_ref().map(LoopConnection::handle));
        self.obey_options(&ctx);
        self.rest(&ctx);
        if let Some(meter) = &mut self.meter {
            meter.end(self.framed.elapsed());
        }
    }

    /// Returns the background of the whole window: clearing is much cheaper than painting panels over it.
    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        theme::now().background.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self, gl: Option<&glow::Context>) {
        if let Some(gl) = gl {
            self.panels.scene.destroy(gl);
        }
        if let Some(tradeoff) = &self.panels.tradeoff {
            tradeoff.stop();
        }
        self.break_off_run();
        self.write_figures();
    }
}
