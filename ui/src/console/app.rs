//! The window: takes in what the loop sent, lays out the panels, sends what the operator asked.

mod calibrating;
mod pace;

use std::{
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use eframe::glow;
use egui::{Frame, Margin, Panel, Ui};
use nima_machine::{
    config::RigConfig,
    messages::{Command, LoopState, Tick},
    rig::Side,
    runtime::Handle,
};
use nima_world::{Plan, scene::Scene};

use super::{
    Options,
    canvas::{Canvas, Surface, renderer_of},
    diary::Diary,
    door::Door,
    frames::Meter,
    help::Help,
    in_force::InForce,
    keys,
    live::Live,
    menu,
    outbox::Outbox,
    panels::{ForcesState, TopBarState, TradeoffState, top_bar_ui},
    pictures::Photographer,
    roles::{Panels, Role, Wishes, role_ui},
    scene3d::{SceneView, extras::Extras},
    screenshot,
    settings::{Kept, Settings},
    theme,
    wizards::Wizards,
};
use crate::{console::text, telling::tell};

/// Smooth edges in 3-D are given up when every second picture comes later than this after the one before (25 a second) ...
const SLOW_MS: f64 = 38.0;
/// ... though the window has had this time to warm up.
const WARM_UP: Duration = Duration::from_secs(4);

/// The console's state.
#[derive(Debug)]
pub struct ConsoleApp {
    door: Option<Door>,
    /// Wakes the window from another thread.
    ctx: egui::Context,
    live: Live,
    outbox: Outbox,
    top_bar: TopBarState,
    panels: Panels,
    settings: Kept,
    help: Help,
    photographer: Option<Photographer>,
    wizards: Wizards,
    in_force: InForce,
    diary: Diary,
    /// What was watched before a wizard took the rig over.
    watched: Option<Scene>,
    options: Options,
    surface: Option<Arc<Surface>>,
    /// What draws, in the driver's words.
    renderer: String,
    meter: Option<Meter>,
    opened: Instant,
    framed: Instant,
    /// When something was last engaged, or a wizard was open.
    moved: Instant,
    /// When what waited was last taken in.
    taken: Instant,
    pictured: bool,
    /// Few pictures are drawn, because nothing is engaged.
    calm: bool,
}

impl ConsoleApp {
    /// The console on a running loop. Sets fonts and style of the context; draws in 3-D if it has OpenGL.
    pub fn new(cc: &eframe::CreationContext<'_>, handle: Handle, rig: RigConfig, scene: Scene) -> Self {
        theme::apply(&cc.egui_ctx);
        let now = Instant::now();
        let surface = cc.gl.as_deref().and_then(Surface::where_it_pays);
        if let Some(surface) = &surface {
            cc.egui_ctx.add_plugin(Canvas::new(Arc::clone(surface), || theme::now().background));
        }
        let in_force = InForce::load(None, &rig, &scene);
        let mut live = Live::new(rig, scene);
        live.rough_edges = surface.is_some();
        Self {
            renderer: cc.gl.as_deref().map(renderer_of).unwrap_or_default(),
            meter: None,
            door: Some(door_of(handle, &cc.egui_ctx)),
            ctx: cc.egui_ctx.clone(),
            in_force,
            diary: Diary::default(),
            wizards: Wizards::default(),
            watched: None,
            live,
            surface,
            outbox: Outbox::default(),
            top_bar: TopBarState::default(),
            panels: Panels { scene: SceneView::new(cc.gl.as_deref()), ..Panels::default() },
            settings: Kept::default(),
            help: Help::default(),
            photographer: None,
            options: Options::default(),
            opened: now,
            framed: now,
            moved: now,
            taken: now,
            pictured: false,
            calm: false,
        }
    }

    /// The same with wishes from outside.
    #[must_use]
    pub fn with_options(mut self, options: Options) -> Self {
        self.options = options;
        self.meter = self.options.frames.as_ref().map(|_| Meter::new(self.options.exit_after));
        if let Some(seconds) = self.options.traces_s {
            self.panels.forces.show_last(seconds);
        }
        self.photographer = self.options.pictures.clone().map(Photographer::new);
        self.settings.now.role = self.options.role.unwrap_or(self.settings.now.role);
        if let Some(which) = self.options.wizard {
            self.open_wizard(which);
        }
        self.leave_when_asked();
        self
    }

    /// Asked from outside to end, the loop ends at once, whatever the window does, and then the window.
    fn leave_when_asked(&self) {
        let Some(door) = &self.door else { return };
        let (ender, ctx) = (door.handle().ender(), self.ctx.clone());
        self.options.leave.at_once(move || {
            ender.end();
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
            ctx.request_repaint();
        });
    }

    /// The same with what was chosen before; changes are kept.
    #[must_use]
    pub fn with_settings(mut self, settings: Kept) -> Self {
        if let Some(told) = settings.told() {
            self.in_force.tell(format!("{told}."));
        }
        if settings.is_first_run() {
            self.help.begin_tour();
        }
        self.settings = settings;
        self
    }

    /// What is remembered from one day to the next, to be changed from outside.
    pub const fn settings_mut(&mut self) -> &mut Settings {
        &mut self.settings.now
    }

    /// Who sits before the screen.
    pub const fn role(&self) -> Role {
        self.settings.now.role
    }

    /// The newest tick that reached the screen.
    pub fn tick(&self) -> Option<&Tick> {
        self.live.first_tick()
    }

    /// The rig that the loop runs on now.
    pub fn rig(&self) -> &RigConfig {
        &self.live.rig
    }

    /// The trade-off panel's memory, for what it has measured.
    pub fn tradeoff(&self) -> &TradeoffState {
        &self.panels.tradeoff
    }

    /// What is drawn into the view on request.
    pub const fn extras(&self) -> Extras {
        self.panels.scene.extras
    }

    /// Moments that were marked, s on the loop's clock.
    pub fn marks_s(&self) -> impl Iterator<Item = f64> {
        self.live.marks_s.iter().copied()
    }

    /// What calibrations are in force.
    pub fn in_force(&self) -> &InForce {
        &self.in_force
    }

    /// Keeps calibrations in this store from now on, and uses what it holds for the rig's sensors and tools.
    #[must_use]
    pub fn with_store(mut self, folder: &Path) -> Self {
        self.in_force = InForce::load(Some(folder), &self.live.rig, &self.live.scene);
        self
    }

    /// Goes on with these wizards and what they have taken.
    #[must_use]
    pub fn with_wizards(mut self, wizards: Wizards) -> Self {
        self.wizards = wizards;
        self
    }

    /// Takes in all that the loop has sent.
    fn take_in(&mut self) {
        let Some(door) = &self.door else { return };
        self.taken = Instant::now();
        let rate_hz = self.live.rig.rate_hz;
        let (wizards, in_force, diary) = (&mut self.wizards, &mut self.in_force, &mut self.diary);
        let calibrated = in_force.side();
        self.live.take_in(door, |tick| {
            if tick.side == calibrated {
                wizards.tick(tick, rate_hz);
            }
            in_force.watch(tick);
            if tick.side == Side::Right {
                diary.tick(tick);
            }
        });
        if in_force.meet(door.handle(), &self.live.rig)[calibrated.index()] {
            self.forget_what_was_taken();
        }
        self.live.bias_moved_n = self.in_force.bias_moved_n();
    }

    /// Ends the loop and starts it anew, idle: only the operator engages it again. Never a way out of a stop or a fault.
    fn restart(&mut self, rig: RigConfig, scene: Scene) -> Result<(), String> {
        rig.validate().and_then(|()| scene.validate()).map_err(|error| error.to_string())?;
        self.take_in();
        if !matches!(self.live.state(), LoopState::Idle | LoopState::Engaged) {
            return Err(text::calibrations::LOOP_STOPPED.to_owned());
        }
        // The old loop first: a rig has one master.
        drop(self.door.take());
        self.in_force.bind(&rig, &scene);
        let calibrations = self.in_force.calibrations(&rig);
        let plan = Plan { rig: rig.clone(), scene: scene.clone(), calibrations, engage: false };
        let started = nima_world::start(&plan).map_err(|error| text::calibrations::not_started_again(&error));
        let rough_edges = self.live.rough_edges;
        self.live = Live::new(rig, scene);
        self.live.rough_edges = rough_edges;
        self.panels.forces = ForcesState::default();
        self.outbox = Outbox::default();
        self.door = Some(door_of(started?, &self.ctx));
        self.leave_when_asked();
        Ok(())
    }

    /// Takes over what the trade-off panel chose.
    fn apply_tradeoff(&mut self, rig: RigConfig) {
        let told = match self.restart(rig, self.live.scene.clone()) {
            Ok(()) => text::tradeoff::APPLIED_BY_RESTART.to_owned(),
            Err(reason) => text::tradeoff::not_applied(&reason),
        };
        self.panels.tradeoff.tell(told);
    }

    fn layout(&mut self, ui: &mut Ui) {
        let bar = Frame::new().fill(theme::now().panel).inner_margin(Margin::symmetric(14, 0));
        Panel::top("top_bar").exact_size(72.0).resizable(false).frame(bar).show(ui, |ui| {
            let calibrating = self.wizards.open.is_some();
            top_bar_ui(
                ui,
                &self.live,
                &mut self.top_bar,
                &mut self.outbox,
                &mut self.settings.now,
                &mut self.help,
                calibrating,
            );
            let pressed = keys::role_pressed(ui.ctx()).filter(|_| !calibrating);
            self.settings.now.role = pressed.unwrap_or(self.role());
        });
        let signs = self.live.signs(self.outbox.stop_is_stuck());
        let loop_s = self.live.first_tick().map(|tick| tick.t_s);
        self.top_bar.alarms.strip_ui(ui, &signs, loop_s, self.settings.now.sound);
        let room = ui.available_rect_before_wrap();
        if self.wizards.open.is_some() {
            self.wizard_layout(ui);
        } else {
            self.monitor_layout(ui);
        }
        self.top_bar.alarms.list_ui(ui.ctx(), room);
        self.settings.now.toured |= self.help.ui(ui.ctx(), room);
    }

    fn monitor_layout(&mut self, ui: &mut Ui) {
        let Wishes { restart, calibration } =
            role_ui(ui, &mut self.settings.now, &mut self.live, &mut self.panels, &self.in_force, &mut self.outbox);
        // After everything was drawn of the loop as it was. A stop asked for in the same frame comes first.
        if self.outbox.holds_stop() {
            return;
        }
        if let Some(rig) = restart {
            self.apply_tradeoff(rig);
        }
        self.obey_calibrations(calibration);
    }

    fn obey_options(&mut self, ctx: &egui::Context) {
        let open = self.opened.elapsed();
        let Options { exit_after, screenshot, .. } = self.options.clone();
        if let Some(path) = screenshot.filter(|_| !self.pictured && open >= self.picture_at()) {
            self.pictured = true;
            ctx.request_screenshot(move |picture| {
                // The window has no one to tell but the terminal it was started from.
                if let Err(error) = screenshot::save(&path, &picture) {
                    tell(format_args!("{error:#}"));
                }
            });
        }
        let finished =
            self.photographer.as_mut().is_some_and(|taker| taker.step(ctx, &self.live, &mut self.settings.now));
        if let Some(stall) = self.options.stall.take_if(|_| open >= WARM_UP) {
            std::thread::sleep(stall);
        }
        if finished || exit_after.is_some_and(|exit| open >= exit) {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }
}

impl eframe::App for ConsoleApp {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        if self.only_flashes(ctx) {
            return;
        }
        // Also while the window is hidden, so that the queues stay empty and the history whole.
        self.take_in();
        self.ask();
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.measure(&ctx, frame);
        // Once given up they stay so: a view that changes its look by itself again and again would be worse.
        let slow = self.opened.elapsed() > WARM_UP && self.live.figures.frame_ms[0] > SLOW_MS;
        // Pictures for documents are taken with smooth edges, however long that takes.
        self.live.rough_edges = self.photographer.is_none() && (self.live.rough_edges || slow);
        self.panels.scene.smooth = !self.live.rough_edges;
        menu::apply(&ctx, &mut self.settings.now);
        if keys::stop_pressed(&ctx) {
            self.outbox.push(Command::Stop);
        }
        self.help.glossary ^= keys::glossary_pressed(&ctx);
        if keys::mark_pressed(&ctx) {
            self.live.mark();
        }
        self.layout(ui);
        self.settings.save();
        self.outbox.flush(self.door.as_ref().map(Door::handle));
        self.obey_options(&ctx);
        self.rest(&ctx);
        if let Some(meter) = &mut self.meter {
            meter.end(self.framed.elapsed());
        }
    }

    /// The ground of the whole window: clearing is far cheaper than painting panels over it.
    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        theme::now().background.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self, gl: Option<&glow::Context>) {
        if let Some(gl) = gl {
            self.panels.scene.destroy(gl);
        }
        self.panels.tradeoff.cancel();
        self.write_figures();
        if let (Some(gl), Some(surface)) = (gl, &self.surface) {
            surface.destroy(gl);
        }
    }
}

/// The door to a loop, that wakes the window of this context.
fn door_of(handle: Handle, ctx: &egui::Context) -> Door {
    let ctx = ctx.clone();
    // Once: without any delay egui draws two pictures.
    Door::new(handle, move || ctx.request_repaint_after(Duration::from_millis(1)))
}
