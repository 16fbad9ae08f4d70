//! The start of a loop, and its restart with another rig.

use std::time::Duration;

use nima_machine::{
    config::RigConfig,
    runtime::{self, Assembly, LoopHandle, LoopStartError},
};
use nima_screen::{
    link::RemoteLine, live::LiveState, loop_connection::LoopConnection, objects::OfSimulation, outbox::Outbox,
};
use nima_simulation::{ObjectFeed, SimulationPlan, scene::Scene};
use nima_words::{report_text::quoted, text};

use super::ConsoleApp;
use crate::console::sessions::ConsoleSessions;

/// Starts the loop of a plan, recorded if sessions are recorded.
pub(crate) fn start_recorded(
    plan: &SimulationPlan,
    sessions: &mut ConsoleSessions,
    line: Option<Box<dyn RemoteLine>>,
) -> Result<StartedLoop, LoopStartError> {
    let (assembly, mut watched) = plan.watched_assembly()?;
    let assembly = Assembly { tap: sessions.begin(plan), ..assembly };
    if let Some(watched) = watched.as_mut().and_then(ObjectFeed::another) {
        sessions.watch(OfSimulation::source(plan, watched));
    }
    let handle = runtime::start(match line {
        Some(line) => line.join(assembly),
        None => assembly,
    })?;
    Ok((handle, watched))
}

/// A running loop, and the source of a simulated rig's objects.
pub(crate) type StartedLoop = (LoopHandle, Option<ObjectFeed>);

impl ConsoleApp {
    /// Ends the loop and restarts it idle: only the operator engages it. Not possible in a stop or a fault.
    pub(super) fn restart(&mut self, rig: RigConfig, scene: Scene) -> Result<(), String> {
        rig.validate().and_then(|()| scene.validate()).map_err(|error| quoted(&error))?;
        self.take_in();
        if let Some(why) = text::calibrations::closed(self.live.state()) {
            return Err(why.to_owned());
        }
        // End the old loop first: a rig must have only one controller.
        drop(self.door.take());
        self.sessions.end();
        self.start_loop(rig, scene)
    }

    /// Starts the loop of this rig, idle, after the old one has ended.
    pub(super) fn start_loop(&mut self, mut rig: RigConfig, scene: Scene) -> Result<(), String> {
        let line = match &self.reopen {
            Some(reopen) => reopen.open(&mut rig, &scene).map_err(|error| {
                let cause = format!("{error:#}");
                text::calibrations::not_started_again(&cause)
            })?,
            None => None,
        };
        let door = line.as_ref().map(|line| line.door());
        self.active.bind(&rig, &scene);
        let calibrations = self.active.calibrations(&rig);
        let rig = self.active.with_checked(rig);
        let plan = SimulationPlan { rig: rig.clone(), scene: scene.clone(), calibrations, engage: false };
        let run = self.page.as_mut().and_then(|page| page.run_mut());
        let started = match (run, self.simulated_speed) {
            (Some(run), speed) => {
                let audiences = self.sessions.blind_audiences(&plan, &run.name());
                run.start(&plan, speed, (self.sessions.reel(), audiences))
            }
            (None, Some(speed)) => nima_simulation::start_watched(&plan, speed).map_err(|error| quoted(&error)),
            (None, None) => start_recorded(&plan, &mut self.sessions, line).map_err(|error| quoted(&error)),
        };
        let started = started.map_err(|error| text::calibrations::not_started_again(&error));
        let rough_edges = self.live.rough_edges;
        self.live = LiveState::new(rig, scene);
        self.live.rough_edges = rough_edges;
        self.live.line = door;
        self.panels.forces.begin_anew();
        self.history.adopt();
        self.panels.devices.begin_anew();
        self.panels.demo.begin_anew();
        self.checking.forget();
        self.outbox = Outbox::default();
        let (handle, watched) = started?;
        self.door = Some(door_of(handle, &self.ctx));
        self.objects = watched;
        self.leave_when_asked();
        Ok(())
    }

    /// Applies the choice of the Trade-off panel.
    pub(super) fn apply_tradeoff(&mut self, rig: RigConfig) {
        let outcome = self.restart(rig, self.live.scene.clone());
        if let Some(tradeoff) = &mut self.panels.tradeoff {
            tradeoff.restarted(outcome);
        }
    }
}

/// Connects to a loop that wakes the window of this context.
pub(super) fn door_of(handle: LoopHandle, ctx: &egui::Context) -> LoopConnection {
    let ctx = ctx.clone();
    // Wait briefly, because egui would otherwise draw two frames.
    LoopConnection::new(handle, move || ctx.request_repaint_after(Duration::from_millis(1)))
}
