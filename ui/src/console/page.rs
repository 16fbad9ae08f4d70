//! A page of an extra: while it is used it holds the machine, and it runs loops of its own.

use std::{
    fmt::Debug,
    path::{Path, PathBuf},
};

use egui::Ui;
use nima_endoscope::Reel;
use nima_machine::{config::RigConfig, messages::Tick};
use nima_session::outlet::Audience;
use nima_simulation::{Plan, scene::Scene};

use super::{app::Started, live::Live, outbox::Outbox, scene3d::SceneView, start::Choice};

/// A page of the window.
pub trait Page: Debug {
    /// Name and purpose on the button that opens it.
    fn name(&self) -> [&'static str; 2];

    /// Whether it is shown.
    fn is_shown(&self) -> bool;

    /// Shows it, with the user's data and the other folders where it found something before.
    fn show(&mut self, folder: Option<&Path>, known: &[PathBuf]);

    /// Hides it.
    fn hide(&mut self);

    /// Whether it holds the machine: then the rest of the screen is closed.
    fn holds_machine(&self) -> bool;

    /// Draws it.
    fn ui(&mut self, ui: &mut Ui, room: Room<'_>) -> Option<Closed>;

    /// Goes on with what it does; returns what it wants of the window.
    fn go_on(&mut self, now: &Now<'_>) -> Option<Wish>;

    /// What it wanted was not done, for this reason if it is known.
    fn tell(&mut self, why: Option<String>);

    /// Prepares the run that it wants.
    fn prepare(&mut self) -> Result<Prepared, String>;

    /// The run that goes on: then the window shows nothing else.
    fn run(&self) -> Option<&dyn Run>;

    /// The same, to change it.
    fn run_mut(&mut self) -> Option<&mut (dyn Run + 'static)>;

    /// Writes down how the run ended. Its loop must have ended.
    fn finish_run(&mut self);
}

/// A run of a page, with a loop of its own.
pub trait Run {
    /// Who moves the instruments.
    fn participant(&self) -> &str;

    /// What those who watch may know of it.
    fn name(&self) -> String;

    /// Starts the loop, for these audiences; in simulated time if there is a `speed`.
    fn start(
        &mut self,
        plan: &Plan,
        speed: Option<f64>,
        audience: (&Reel, Vec<Box<dyn Audience>>),
    ) -> Result<Started, String>;

    /// Takes the next tick of a side.
    fn tick(&mut self, tick: &Tick);

    /// It is broken off, if it is not over yet.
    fn break_off(&mut self, why: Broken);

    /// Draws the participant's screen.
    fn ui(&mut self, ui: &mut Ui, live: &Live, view: &mut SceneView, outbox: &mut Outbox);
}

/// Why a run was broken off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Broken {
    /// The window was closed.
    Closed,
    /// The loop ended.
    LoopEnded,
    /// The loop did not start.
    NotStarted,
}

/// What a page is drawn from.
pub struct Room<'a> {
    /// The user's data.
    pub folder: Option<&'a Path>,
    /// Folders elsewhere that were opened before.
    pub known: &'a mut Vec<PathBuf>,
    /// Why no run can begin now.
    pub closed: Option<&'static str>,
    /// The arm is at another machine.
    pub is_over_a_line: bool,
    /// A rig is being started.
    pub is_starting: bool,
}

/// What the machine was given back with: what ran before.
#[derive(Debug)]
pub struct Closed(pub Option<Choice>);

/// How the window stands.
pub struct Now<'a> {
    /// What runs.
    pub running: &'a Choice,
    /// The loop has ended, by itself or because the process was asked to end.
    pub ended: Option<Broken>,
    /// A stop or a fault is latched.
    pub is_latched: bool,
    /// A rig is being started.
    pub is_starting: bool,
}

/// What a page wants of the window.
#[derive(Debug)]
pub enum Wish {
    /// This rig and scene in place of what runs.
    Start(Choice),
    /// The run that [`Page::prepare`] prepares.
    Run,
    /// The end of the run; `again`: then the rig runs idle.
    End { again: bool },
}

/// A run that is to begin.
pub struct Prepared {
    /// Its rig; `None` if that rig does not allow it, whose reason nobody must learn.
    pub rig: Option<RigConfig>,
    /// Its scene.
    pub scene: Scene,
    /// The instruments are moved from the screen.
    pub is_by_mouse: bool,
}
