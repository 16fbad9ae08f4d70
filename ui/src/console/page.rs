//! A page of an extra: it reserves the machine while it is used, and runs its own loops.

use std::{
    fmt::Debug,
    path::{Path, PathBuf},
};

use egui::Ui;
use nima_endoscope::FrameQueue;
use nima_machine::{config::RigConfig, messages::Tick};
use nima_panels::rig_choice::RigChoice;
use nima_screen::{live::LiveState, outbox::Outbox, scene3d::SceneView};
use nima_session::sinks::Audience;
use nima_simulation::{SimulationPlan, scene::Scene};

use crate::console::app::StartedLoop;

pub trait Page: Debug {
    /// Returns the name and purpose on the button that opens it.
    fn name(&self) -> [&'static str; 2];

    /// Reads its content before it is shown: from the user's data, and other folders with known content.
    fn read(&mut self, folder: Option<&Path>, known: &[PathBuf]);

    /// Returns whether it reserves the machine: then the rest of the screen is closed.
    fn holds_machine(&self) -> bool;

    fn ui(&mut self, ui: &mut Ui, room: Room<'_>) -> Option<LeftPage>;

    /// Continues its work; returns its request to the window.
    fn go_on(&mut self, now: &PageContext<'_>) -> Option<PageRequest>;

    /// Reports that its request was not fulfilled, and the reason if known.
    fn notify(&mut self, why: Option<String>);

    /// Prepares the requested run.
    fn prepare(&mut self) -> Result<PreparedRun, String>;

    /// Returns the current run: then the window shows nothing else.
    fn run(&self) -> Option<&dyn PageRun>;

    fn run_mut(&mut self) -> Option<&mut (dyn PageRun + 'static)>;

    /// Records the result of the run. Its loop must have ended.
    fn finish_run(&mut self);
}

/// A run of a page, with its own loop.
pub trait PageRun {
    /// Returns the participant who moves the instruments.
    fn participant(&self) -> &str;

    /// Returns the name that live viewers may see.
    fn name(&self) -> String;

    /// Starts the loop, for these audiences; in simulated time if `speed` is given.
    fn start(
        &mut self,
        plan: &SimulationPlan,
        speed: Option<f64>,
        audience: (&FrameQueue, Vec<Box<dyn Audience>>),
    ) -> Result<StartedLoop, String>;

    fn tick(&mut self, tick: &Tick);

    /// Aborts the run, if it is not over yet.
    fn break_off(&mut self, why: RunBreak);

    /// Draws the participant's screen.
    fn ui(&mut self, ui: &mut Ui, live: &LiveState, view: &mut SceneView, outbox: &mut Outbox);
}

/// Reason why a run was aborted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunBreak {
    Closed,
    LoopEnded,
    NotStarted,
}

/// Input for drawing a page.
pub struct Room<'a> {
    /// The user's data.
    pub folder: Option<&'a Path>,
    /// Other folders that were opened before.
    pub known: &'a mut Vec<PathBuf>,
    /// Reason why no run can start now.
    pub closed: Option<&'static str>,
    /// The arm is at another machine.
    pub is_over_a_line: bool,
    pub is_starting: bool,
}

/// The page that the user has left.
#[derive(Debug)]
pub enum LeftPage {
    Page,
    /// The machine is no longer reserved; the rig and scene that ran before.
    Machine(Option<RigChoice>),
}

/// State of the window.
pub struct PageContext<'a> {
    /// The running rig and scene.
    pub running: &'a RigChoice,
    /// The loop has ended, on its own or because the end of the process was requested.
    pub ended: Option<RunBreak>,
    pub is_latched: bool,
    pub is_starting: bool,
}

/// A page's request to the window.
#[derive(Debug)]
pub enum PageRequest {
    /// Start this rig and scene instead of the running ones.
    Start(RigChoice),
    /// Start the run that [`Page::prepare`] prepares.
    Run,
    /// End the run; `again`: then the rig runs idle.
    End { again: bool },
}

/// A run that is about to start.
pub struct PreparedRun {
    /// Rig; `None` if the rig does not permit the run. The reason stays secret, because it could reveal the condition.
    pub rig: Option<RigConfig>,
    pub scene: Scene,
    /// The instruments are moved from the screen.
    pub is_by_mouse: bool,
}
