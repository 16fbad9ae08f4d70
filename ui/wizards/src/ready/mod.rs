//! The ready check in the console and without a screen: its input, its record, and its page.

mod page;
mod record;

use std::time::{Duration, Instant};

use nima_machine::{
    config::RigConfig,
    messages::{Command, LoopState, Tick},
    ready::{CheckSubject, PersonRequest, ReadyArm, ReadySession},
    rig::{Prompt, Roster, Side},
};
use nima_screen::loop_connection::LoopMessage;
use nima_simulation::{
    scene::Scene,
    screen::{PersonTask, Screen},
};

pub use page::{ReadyRequest, ready_ui};
pub use record::{devices_of, record};

use crate::active_calibrations::ActiveCalibrations;

/// Returns the subject of the check: the rig of this name (built-in, or path of its file) with these devices.
pub fn subject(
    name: &str,
    rig: &RigConfig,
    scene: &Scene,
    roster: &Roster,
    active: &ActiveCalibrations,
) -> CheckSubject {
    let has_person = rig.devices.is_some() || scene.person.is_some();
    let arm = |side: Side| {
        let at_wrist = scene.measures_at_wrist(rig, side);
        scene.has(rig, side).then(|| ReadyArm { at_wrist, gravity: active.gravity(side), has_person })
    };
    CheckSubject {
        rig: rig.clone(),
        arms: Side::ALL.map(arm),
        parts: roster.iter().map(|entry| entry.part).collect(),
        gates_in_file: RigConfig::load(name).ok().map(|rig| rig.gates),
        is_date_behind: active.is_date_behind(),
    }
}

/// Upper limit of the time counted between two updates: a window or machine that stood still gave the person no time to act.
const BETWEEN_LOOKS_MAX: Duration = Duration::from_secs(1);

/// A running check, and its clock.
#[derive(Debug)]
pub struct ReadyRun {
    pub session: ReadySession,
    looked: Instant,
    clock: Duration,
    /// The arm of the last instruction.
    side: Side,
}

impl ReadyRun {
    pub fn new(subject: CheckSubject) -> Self {
        Self { session: ReadySession::new(subject), looked: Instant::now(), clock: Duration::ZERO, side: Side::Right }
    }

    /// Adds data from the loop.
    pub fn take(&mut self, news: &LoopMessage<'_>) {
        match news {
            LoopMessage::Tick(tick) => self.session.tick(tick),
            LoopMessage::Gauges(gauges) => self.session.gauges(gauges),
            LoopMessage::Event(event) => self.session.event(event),
        }
    }

    /// Continues the check; returns a command for the loop.
    pub fn look(&mut self) -> Option<Command> {
        let last = std::mem::replace(&mut self.looked, Instant::now());
        self.clock += (self.looked - last).min(BETWEEN_LOOKS_MAX);
        let command = self.session.look(self.clock.as_secs_f64());
        self.side = self.session.ask().side().unwrap_or(self.side);
        command
    }

    /// Returns the screen shown to the technician of an emulated rig.
    pub fn screen(&self) -> Screen {
        let ask = self.session.ask();
        // Outside the trocar, the technician follows instructions as in the gravity calibration.
        let task = if ask.is_out_of_trocar() { PersonTask::Gravity } else { PersonTask::Surgery };
        Screen { side: self.side, task, prompt: ask.prompt() }
    }

    /// Returns the new instruction for an arm, if it changes.
    pub fn prompt_for(&self, tick: &Tick) -> Option<Command> {
        let wanted =
            if self.session.ask().side() == Some(tick.side) { self.session.ask().prompt() } else { Prompt::Rest };
        let differs = tick.state == LoopState::Idle && tick.guidance.prompt != wanted;
        differs.then_some(Command::Prompt(tick.side, wanted))
    }

    /// Returns the action of the person at the screen; `None` for instructions at the arms.
    pub fn answer(&self) -> Option<Command> {
        match self.session.ask() {
            PersonRequest::PressStop => Some(Command::Stop),
            PersonRequest::Release => Some(Command::ReleaseStop),
            _ => None,
        }
    }
}
