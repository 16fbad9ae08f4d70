//! The window: takes in what the loop sent, lays out the panels, sends what the operator asked.

use std::time::{Duration, Instant};

use eframe::glow;
use egui::{CentralPanel, Event, Frame, Key, Margin, Panel, ScrollArea, Ui};
use nima::{
    config::{Rig, Scene},
    runtime::{self, Command, Handle, Plan, Tick},
    teleop::{Calibrations, LoopState},
};

use super::{
    Options,
    live::Live,
    outbox::Outbox,
    panels::{
        FeedbackState, ForcesState, TopBarState, TradeoffState, degrees_ui, feedback_ui, forces_ui, gates_ui,
        horizon_ui, timing_ui, top_bar_ui, tradeoff_ui,
    },
    scene3d::{SceneView, scene_ui},
    screenshot, theme,
};

/// Thirty pictures a second while data flow.
const FRAME: Duration = Duration::from_millis(33);
/// Smooth edges in 3-D are given up when the work for one picture takes longer than this (25 pictures a second) ...
const SLOW_MS: f64 = 38.0;
/// ... though the window has had this time to warm up.
const WARM_UP: Duration = Duration::from_secs(4);
/// When a picture was asked for but no end: the demo is in full swing by then.
const SCREENSHOT_AT: Duration = Duration::from_secs(3);
/// Room for the picture to be taken before the window closes.
const SCREENSHOT_BEFORE_EXIT: Duration = Duration::from_millis(700);

/// The console's state.
#[derive(Debug)]
pub struct ConsoleApp {
    handle: Option<Handle>,
    live: Live,
    outbox: Outbox,
    top_bar: TopBarState,
    feedback: FeedbackState,
    forces: ForcesState,
    tradeoff: TradeoffState,
    scene: SceneView,
    options: Options,
    opened: Instant,
    framed: Instant,
    pictured: bool,
}

impl ConsoleApp {
    /// The console on a running loop. Sets fonts and style of the context; draws in 3-D if it has OpenGL.
    pub fn new(cc: &eframe::CreationContext<'_>, handle: Handle, rig: Rig, scene: Scene) -> Self {
        theme::apply(&cc.egui_ctx);
        let now = Instant::now();
        Self {
            handle: Some(handle),
            live: Live::new(rig, scene),
            outbox: Outbox::default(),
            top_bar: TopBarState::default(),
            feedback: FeedbackState::default(),
            forces: ForcesState::default(),
            tradeoff: TradeoffState::default(),
            scene: SceneView::new(cc.gl.as_deref()),
            options: Options::default(),
            opened: now,
            framed: now,
            pictured: false,
        }
    }

    /// The same with wishes from outside.
    #[must_use]
    pub fn with_options(mut self, options: Options) -> Self {
        self.options = options;
        self
    }

    /// The newest tick that reached the screen.
    pub fn tick(&self) -> Option<&Tick> {
        self.live.tick.as_ref()
    }

    /// The rig that the loop runs on now.
    pub fn rig(&self) -> &Rig {
        &self.live.rig
    }

    /// The trade-off panel's memory, for what it has measured.
    pub fn tradeoff(&self) -> &TradeoffState {
        &self.tradeoff
    }

    /// Ends the loop and starts it anew with `rig`, idle: only the operator engages it again.
    fn restart(&mut self, rig: Rig) {
        if let Err(error) = rig.validate() {
            self.tradeoff.tell(format!("Not applied: {error}."));
            return;
        }
        if let Some(handle) = &self.handle {
            self.live.take_in(handle, |_| {});
        }
        if !matches!(self.live.state(), LoopState::Idle | LoopState::Engaged) {
            self.tradeoff.tell("Not applied: the loop has stopped. Release it first.");
            return;
        }
        let scene = self.live.scene.clone();
        // The old loop first: a rig has one master.
        drop(self.handle.take());
        match runtime::start(&Plan {
            rig: rig.clone(),
            scene: scene.clone(),
            calibrations: Calibrations::default(),
            engage: false,
        }) {
            Ok(handle) => {
                self.handle = Some(handle);
                self.tradeoff.tell("Applied. The loop was restarted and is idle: engage it when ready.");
            }
            Err(error) => self.tradeoff.tell(format!("The loop could not be started again: {error}.")),
        }
        let rough_edges = self.live.rough_edges;
        self.live = Live::new(rig, scene);
        self.live.rough_edges = rough_edges;
        self.forces = ForcesState::default();
        self.outbox = Outbox::default();
    }

    /// Space and Escape stop, wherever the keyboard's focus is; nothing else sees them, so no button is pressed by them.
    fn stop_key(&mut self, ctx: &egui::Context) {
        let stop = ctx.input_mut(|input| {
            let mut stop = false;
            input.events.retain(|event| match event {
                Event::Key { key: Key::Space | Key::Escape, pressed, repeat, .. } => {
                    stop |= *pressed && !*repeat;
                    false
                }
                Event::Text(text) => text != " ",
                _ => true,
            });
            stop
        });
        if stop {
            self.outbox.push(Command::Stop);
        }
    }

    fn layout(&mut self, ui: &mut Ui) {
        let mut restart = None;
        let bar = Frame::new().fill(theme::PANEL).inner_margin(Margin::symmetric(14, 0));
        Panel::top("top_bar").exact_size(72.0).resizable(false).frame(bar).show(ui, |ui| {
            top_bar_ui(ui, &self.live, &mut self.top_bar, &mut self.outbox);
        });
        let side = Frame::new().fill(theme::PANEL).inner_margin(Margin::same(8));
        Panel::left("feedback").exact_size(316.0).resizable(false).frame(side).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                feedback_ui(ui, &mut self.live, &mut self.feedback, &mut self.outbox);
                gates_ui(ui, &self.live);
            });
        });
        Panel::right("figures").exact_size(348.0).resizable(false).frame(side).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                horizon_ui(ui, &self.live);
                degrees_ui(ui, &self.live);
                timing_ui(ui, &self.live);
                restart = tradeoff_ui(ui, &self.live, &mut self.tradeoff, &mut self.outbox);
            });
        });
        CentralPanel::no_frame().show(ui, |ui| {
            let traces = (0.44 * ui.available_height()).clamp(230.0, 460.0);
            let frame = Frame::new().inner_margin(Margin::symmetric(12, 8));
            Panel::bottom("forces").exact_size(traces).resizable(false).frame(frame).show(ui, |ui| {
                forces_ui(ui, &self.live, &mut self.forces);
            });
            scene_ui(ui, &self.live, &mut self.scene);
        });
        // After everything was drawn of the loop as it was. A stop asked for in the same frame comes first.
        if let Some(rig) = restart.filter(|_| !self.outbox.stop_is_stuck()) {
            self.restart(rig);
        }
    }

    fn obey_options(&mut self, ctx: &egui::Context) {
        let open = self.opened.elapsed();
        let Options { exit_after, screenshot } = &self.options;
        let picture_at = exit_after.map_or(SCREENSHOT_AT, |exit| exit.saturating_sub(SCREENSHOT_BEFORE_EXIT));
        if let Some(path) = screenshot.as_ref().filter(|_| !self.pictured && open >= picture_at) {
            let path = path.clone();
            self.pictured = true;
            ctx.request_screenshot(move |picture| {
                // The window has no one to tell but the terminal it was started from.
                if let Err(error) = screenshot::save(&path, &picture) {
                    eprintln!("{error:#}");
                }
            });
        }
        if exit_after.is_some_and(|exit| open >= exit) {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }
}

impl eframe::App for ConsoleApp {
    fn logic(&mut self, _ctx: &egui::Context, _frame: &mut eframe::Frame) {
        // Also while the window is hidden, so that the queues stay empty and the history whole.
        if let Some(handle) = &self.handle {
            self.live.take_in(handle, |_| {});
        }
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        let period = std::mem::replace(&mut self.framed, Instant::now());
        self.live.frame(self.framed.duration_since(period).as_secs_f64(), frame.info().cpu_usage.map(f64::from));
        // Once given up they stay so: a view that changes its look by itself again and again would be worse.
        self.live.rough_edges |= self.opened.elapsed() > WARM_UP && self.live.figures.frame_work_ms > SLOW_MS;
        self.scene.smooth = !self.live.rough_edges;
        self.stop_key(&ctx);
        self.layout(ui);
        if let Some(handle) = &self.handle {
            self.outbox.flush(handle);
        }
        self.obey_options(&ctx);
        ctx.request_repaint_after(FRAME);
    }

    /// The ground of the whole window: clearing is far cheaper than painting panels over it.
    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        theme::BACKGROUND.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self, gl: Option<&glow::Context>) {
        if let Some(gl) = gl {
            self.scene.destroy(gl);
        }
        self.tradeoff.cancel();
        if let Some(handle) = self.handle.take() {
            handle.stop_and_join();
        }
    }
}
