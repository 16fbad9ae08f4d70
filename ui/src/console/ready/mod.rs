//! The ready check in the console and without a screen: its input, its record, and its page.

mod page;
mod record;

use std::time::{Duration, Instant};

use nima_machine::{
    config::RigConfig,
    messages::{Command, LoopState, Tick},
    ready::{Arm, Ask, Session, Subject},
    rig::{Prompt, Roster, Side},
};
use nima_simulation::{
    scene::Scene,
    screen::{Screen, Task},
};

pub(crate) use page::{Wish, ready_ui};
pub(crate) use record::{devices_of, record};

use super::{door::News, in_force::InForce};

/// Subject of the check: the rig of this name (built-in, or path of its file) with these devices.
pub(crate) fn subject(name: &str, rig: &RigConfig, scene: &Scene, roster: &Roster, in_force: &InForce) -> Subject {
    let has_person = rig.devices.is_some() || scene.person.is_some();
    let arm = |side: Side| {
        let at_wrist = scene.measures_at_wrist(rig, side);
        scene.has(rig, side).then(|| Arm { at_wrist, gravity: in_force.gravity(side), has_person })
    };
    Subject {
        rig: rig.clone(),
        arms: Side::ALL.map(arm),
        parts: roster.iter().map(|entry| entry.part).collect(),
        gates_in_file: RigConfig::load(name).ok().map(|rig| rig.gates),
        is_date_behind: in_force.is_date_behind(),
    }
}

/// Upper limit of the time counted between two updates: a window or machine that stood still gave the person no time to act.
const BETWEEN_LOOKS_MOST: Duration = Duration::from_secs(1);

/// A running check, and its clock.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) session: Session,
    looked: Instant,
    clock: Duration,
    /// The arm of the last instruction.
    side: Side,
}

impl Run {
    pub(crate) fn new(subject: Subject) -> Self {
        Self { session: Session::new(subject), looked: Instant::now(), clock: Duration::ZERO, side: Side::Right }
    }

    /// Adds data from the loop.
    pub(crate) fn take(&mut self, news: &News<'_>) {
        match news {
            News::Tick(tick) => self.session.tick(tick),
            News::Gauges(gauges) => self.session.gauges(gauges),
            News::Event(event) => self.session.event(event),
        }
    }

    /// Continues the check; returns a command for the loop.
    pub(crate) fn look(&mut self) -> Option<Command> {
        let last = std::mem::replace(&mut self.looked, Instant::now());
        self.clock += (self.looked - last).min(BETWEEN_LOOKS_MOST);
        let command = self.session.look(self.clock.as_secs_f64());
        self.side = self.session.ask().side().unwrap_or(self.side);
        command
    }

    /// Screen shown to the technician of an emulated rig.
    pub(crate) fn screen(&self) -> Screen {
        let ask = self.session.ask();
        // Outside the trocar, the technician follows instructions as in the gravity calibration.
        let task = if ask.is_out_of_trocar() { Task::Gravity } else { Task::Surgery };
        Screen { side: self.side, task, prompt: ask.prompt() }
    }

    /// The new instruction for an arm, if it changes.
    pub(crate) fn prompt_for(&self, tick: &Tick) -> Option<Command> {
        let wanted =
            if self.session.ask().side() == Some(tick.side) { self.session.ask().prompt() } else { Prompt::Rest };
        let differs = tick.state == LoopState::Idle && tick.prompt != wanted;
        differs.then_some(Command::Prompt(tick.side, wanted))
    }

    /// Action of the person at the screen; `None` for instructions at the arms.
    pub(crate) fn answer(&self) -> Option<Command> {
        match self.session.ask() {
            Ask::PressStop => Some(Command::Stop),
            Ask::Release => Some(Command::ReleaseStop),
            _ => None,
        }
    }
}
