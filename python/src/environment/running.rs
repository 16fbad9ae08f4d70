//! A loop on its simulated worlds, stepped tick by tick.

use std::collections::VecDeque;

use nalgebra::Vector3;
use nima_core::{impedance::SettingsError, task::TaskEvent};
use nima_machine::{
    messages::{Command, LoopState, Tick},
    rig::{GRIP_MAX_RAD, GUIDE_MAX_M, Inputs, Side},
    runtime,
    teleop::Loop,
};
use nima_score::{Score, TaskFile, trial_score::LiveTrial};
use nima_simulation::{ObjectFeed, SimulationPlan, Training, Worlds};

use super::{
    handle::{HandleWorlds, Holder},
    link::OwnLink,
};

/// Side that a controller can use.
pub(super) const SIDE: Side = Side::Right;
/// Maximum time until the pair is engaged, s.
const ENGAGED_WITHIN_S: f64 = 5.0;

/// Action of an external controller in a step.
#[derive(Clone, Copy, Debug)]
pub(super) enum ControllerAction {
    /// None: the scene's hand holds the handle, and a mode renders.
    Watch,
    /// Sets the position of the handle, m.
    Place(Vector3<f64>),
    /// Applies a force to the handle, N.
    Push(Vector3<f64>),
    /// Requests this force in the hand, N, instead of a mode's.
    Render(Vector3<f64>),
}

/// Information after a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepObservation {
    pub(super) tick: Tick,
    pub(super) handle_m: Vector3<f64>,
    pub(super) handle_m_s: Vector3<f64>,
    /// Position of the tip, one delay ago, m.
    pub(super) delayed_tip_m: Vector3<f64>,
    /// Force at the tip, one delay ago, N.
    pub(super) delayed_n: Vector3<f64>,
    /// Whether the link has delivered a force.
    pub(super) has_force: bool,
    pub(super) training: Option<Training>,
}

pub(super) struct SimulationRun {
    control: Loop<OwnLink>,
    rig: HandleWorlds,
    watched: Option<ObjectFeed>,
    training: Option<Training>,
    trial: Option<LiveTrial>,
    ticks: u64,
    period_s: f64,
    /// Positions of the tip until one delay ago, the oldest first, m.
    tips_m: VecDeque<Vector3<f64>>,
    handle_before_m: Option<Vector3<f64>>,
    known: Option<StepObservation>,
}

impl SimulationRun {
    pub(super) fn new(plan: &SimulationPlan) -> Result<Self, SettingsError> {
        let origin = plan.origin();
        let control = Loop::over(&origin.rig, &origin.calibrations, OwnLink::new)?;
        let (worlds, watched) = Worlds::watched(&plan.scene, plan.rig.rate_hz);
        let period_s = 1.0 / plan.rig.rate_hz;
        let rig = HandleWorlds::new(worlds, SIDE, plan.scene.leader, plan.scene.hand.mass_kg, period_s);
        let training = None;
        let tips_m = VecDeque::new();
        let task = plan.scene.task.as_ref().and_then(|task| TaskFile::of(task).ok());
        let trial = task.as_ref().map(LiveTrial::new);
        let handle_before_m = None;
        let known = None;
        Ok(Self { control, rig, watched, training, trial, ticks: 0, period_s, tips_m, handle_before_m, known })
    }

    /// Runs until the pair is engaged.
    pub(super) fn engage(&mut self) -> Result<StepObservation, String> {
        let mut command = Some(Command::Engage);
        while (self.ticks as f64) * self.period_s < ENGAGED_WITHIN_S {
            let known = self.tick(command.take());
            if let Some(known) = known.filter(|known| known.tick.state == LoopState::Engaged) {
                return Ok(known);
            }
        }
        let state = self.known.map_or("without an arm", |known| known.tick.state.word());
        Err(format!("the scene cannot be engaged: after {ENGAGED_WITHIN_S} s its right arm is still in {state}"))
    }

    /// Runs one step of this many ticks.
    pub(super) fn step(
        &mut self,
        action: ControllerAction,
        grip_rad: Option<f64>,
        ticks: u32,
    ) -> Option<StepObservation> {
        self.take(action, ticks);
        if let Some(grip_rad) = grip_rad {
            self.obey(Command::Grip(SIDE, Some(grip_rad.clamp(0.0, GRIP_MAX_RAD))));
        }
        for _ in 0..ticks {
            // The scene's hand waits at the handle; the loop is notified that the handle is being guided.
            let guide = |position_m: Vector3<f64>| position_m.map(|x| x.clamp(-GUIDE_MAX_M, GUIDE_MAX_M));
            let command = self.rig.position_m().map(|position_m| Command::Guide(SIDE, Some(guide(position_m))));
            self.tick(command)?;
        }
        self.known
    }

    fn take(&mut self, action: ControllerAction, ticks: u32) {
        let measured_m = self.rig.seen.map_or_else(Vector3::zeros, |seen: Inputs| seen.hand.position_m);
        let position_m = self.rig.position_m().unwrap_or(measured_m);
        match action {
            ControllerAction::Watch => {}
            ControllerAction::Place(to_m) => self.rig.holder = Holder::Placed { position_m, to_m, ticks },
            ControllerAction::Push(force_n) => {
                let speed_m_s = match self.rig.holder {
                    Holder::Pushed { speed_m_s, .. } => speed_m_s,
                    Holder::Scene | Holder::Placed { .. } => Vector3::zeros(),
                };
                self.rig.holder = Holder::Pushed { position_m, speed_m_s, force_n };
            }
            ControllerAction::Render(force_n) => {
                if let Some(link) = self.control.link_mut(SIDE) {
                    link.ask(force_n);
                }
            }
        }
    }

    fn obey(&mut self, command: Command) {
        self.control.obey(command, self.ticks as f64 * self.period_s);
    }

    fn tick(&mut self, command: Option<Command>) -> Option<StepObservation> {
        let now_s = self.ticks as f64 * self.period_s;
        let ticks = runtime::tick(&mut self.control, &mut self.rig, now_s, command);
        self.ticks += 1;
        self.score(&ticks);
        let tick = ticks[SIDE.index()]?;
        let handle_m = self.rig.seen.map_or(tick.positions.leader_m, |seen| seen.hand.position_m);
        let before_m = self.handle_before_m.replace(handle_m).unwrap_or(handle_m);
        self.tips_m.push_back(tick.positions.tip_m);
        while self.tips_m.len() > (tick.delay_s / self.period_s).round() as usize + 1 {
            self.tips_m.pop_front();
        }
        let delivered_n = self.control.link_mut(SIDE).and_then(|link| link.delayed_n);
        let known = StepObservation {
            tick,
            handle_m,
            handle_m_s: (handle_m - before_m) / self.period_s,
            delayed_tip_m: self.tips_m.front().copied().unwrap_or(tick.positions.tip_m),
            // An observation contains no NaN.
            has_force: delivered_n.is_some(),
            delayed_n: delivered_n.unwrap_or_else(Vector3::zeros),
            training: self.training,
        };
        self.known = Some(known);
        Some(known)
    }

    /// Adds a tick to the score.
    fn score(&mut self, ticks: &[Option<Tick>]) {
        let moments: Vec<_> = self.watched.iter().flat_map(ObjectFeed::moments).collect();
        self.training = moments.last().map(|moment| moment.training).or(self.training);
        let happenings: Vec<_> = self.watched.iter().flat_map(ObjectFeed::happenings).collect();
        if let Some(training) = &mut self.training {
            training.ended |= happenings.iter().any(|happening| happening.event == TaskEvent::Ended);
        }
        let Some(trial) = &mut self.trial else { return };
        for moment in &moments {
            trial.opening(moment.t_s, moment.opening_rad);
        }
        for happening in &happenings {
            trial.happening(happening);
        }
        for tick in ticks.iter().flatten() {
            trial.tick(tick);
        }
    }

    /// Ends the score and returns it. `None` in a scene without a task.
    pub(super) fn end(&mut self) -> Option<Score> {
        let has_no_publisher = self.watched.is_none();
        self.trial.take().and_then(|trial| trial.end(has_no_publisher))
    }
}
