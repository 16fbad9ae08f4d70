//! Which lines of a session's log this program makes, whatever the names in a rig or a scene are.
//!
//! A line is compared with all that the tables of words give, its numbers left open. A sentence that is missing in the lists here is
//! withheld from an anonymous session, so that forgetting one tells nobody anything.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use nima_core::{
    impedance::Mode,
    safety::{Implausible, Why},
    task::Event as Happens,
};
use nima_devices::{Loss, Standing};
use nima_machine::{
    messages::{Command, Event, Fault, ForceSource, LoopState, Refusal, Scheduling, Watchdog},
    rig::{Act, Awaited, DeviceEvent, Exchange, Obstacle, Part, Prompt, SIDES, Side},
    runtime::Operation,
};
use nima_session::STATES;

use super::{commands::operation, events::event, happenings::happening, refusals::REFUSALS};

/// The lines of the log that are free of names.
pub(crate) struct Lines(BTreeSet<String>);

impl Lines {
    /// All of them, with those that the console adds to a log.
    pub(crate) fn all(of_console: &[String]) -> Self {
        let mut lines = BTreeSet::new();
        for side in Side::ALL {
            lines.extend(of_side(side).map(|of| shape(&event(&of, &[]))));
            lines.insert(shape(&operation(&Operation::Suspend(side), &[])));
            lines.insert(shape(&operation(&Operation::Calibrations { side, number: 0 }, &[])));
        }
        lines.extend(commands().map(|command| shape(&operation(&Operation::Command { command, t_s: 0.0 }, &[]))));
        lines.insert(shape(&operation(&Operation::Stall { silent_s: 0.0, t_s: 0.0 }, &[])));
        for name in device_names() {
            let name = std::slice::from_ref(&name);
            lines.extend(devices().map(|of| shape(&operation(&Operation::Device(of), name))));
            let lost =
                |(side, loss)| Event::FaultRaised { t_s: 0.0, side, fault: Fault::DeviceLost { device: 0, loss } };
            let lost = Side::ALL.into_iter().flat_map(|side| losses().map(|loss| (side, loss))).map(lost);
            lines.extend(lost.map(|of| shape(&event(&of, name))));
        }
        let granted = [(true, true), (true, false), (false, true)];
        lines.extend(granted.map(|(fifo, memory_locked)| {
            shape(&event(&Event::Scheduling(Scheduling { fifo, deadline: false, memory_locked }), &[]))
        }));
        lines.extend(happenings().map(|of| shape(&happening(&of))));
        lines.extend(of_console.iter().map(|line| shape(line)));
        Self(lines)
    }

    /// Whether this is one.
    pub(crate) fn has(&self, line: &str) -> bool {
        self.0.contains(&shape(line))
    }
}

/// A line with `#` in place of each number.
fn shape(line: &str) -> String {
    let mut shape = String::with_capacity(line.len());
    for (letter, next) in line.chars().zip(line.chars().skip(1).map(Some).chain([None])) {
        let next_is_digit = next.is_some_and(|next| next.is_ascii_digit());
        let is_number = letter.is_ascii_digit() || matches!(letter, '-' | '.') && next_is_digit;
        match is_number {
            true if shape.ends_with('#') => {}
            true => shape.push('#'),
            false => shape.push(letter),
        }
    }
    shape
}

/// Events of a side.
fn of_side(side: Side) -> impl Iterator<Item = Event> {
    let changed = STATES
        .into_iter()
        .flat_map(move |from| STATES.map(|to| Event::StateChanged { t_s: 0.0, side, from, to, why: Why::Asked }));
    let raised = faults().map(move |fault| Event::FaultRaised { t_s: 0.0, side, fault });
    let refused = commands()
        .flat_map(move |command| refusals().map(move |why| Event::CommandRefused { t_s: 0.0, side, command, why }));
    changed.chain(raised).chain(refused)
}

fn faults() -> impl Iterator<Item = Fault> {
    let implausible = implausible().map(|what| Fault::Implausible { what });
    let lost = losses().map(|loss| Fault::DeviceLost { device: 0, loss });
    let others = [
        Fault::SourceSilent,
        Fault::LoopStalled { periods: 0 },
        Fault::DrivesOff,
        Fault::OtherArm,
        Fault::SamplesLost,
        Fault::LinkSilent,
        Fault::ClockJumped,
    ];
    let unknown = ForceSource::UNUSABLE.map(|source| Fault::ForceUnknown { source });
    others.into_iter().chain(unknown).chain(lost).chain(implausible)
}

const fn losses() -> [Loss; 5] {
    [Loss::Disconnected, Loss::Silent, Loss::Corrupt, Loss::Implausible, Loss::Device { code: 0 }]
}

const fn implausible() -> [Implausible; 12] {
    [
        Implausible::ForceFrozen,
        Implausible::ForceSaturated,
        Implausible::ForceRepeats,
        Implausible::ForceJumped,
        Implausible::ForceAlong,
        Implausible::LinkFrozen,
        Implausible::HandleJumped,
        Implausible::HandleFrozen,
        Implausible::HandleRepeats,
        Implausible::TipJumped,
        Implausible::ArmRepeats,
        Implausible::ArmAstray,
    ]
}

fn refusals() -> impl Iterator<Item = Refusal> {
    let exchanged =
        [Exchange::Handles, Exchange::Arms, Exchange::Sensors, Exchange::Servos, Exchange::Markers, Exchange::Trocars];
    let waiting = [Awaited::Servos, Awaited::Markers].map(Obstacle::Waiting);
    let obstacles = exchanged.map(Obstacle::Exchanged).into_iter().chain(waiting).chain([Obstacle::FarEnd]);
    let obstacles = obstacles.map(Refusal::Obstacle);
    let states = STATES.map(|state: LoopState| Refusal::State(state));
    let present = faults().map(Refusal::StillPresent).chain(implausible().map(Refusal::Implausible));
    REFUSALS.into_iter().chain(states).chain(obstacles).chain(present)
}

fn commands() -> impl Iterator<Item = Command> {
    let modes = Mode::ALL.into_iter().chain(Mode::BASELINES).map(Command::SetMode);
    let switches = [true, false].into_iter().flat_map(|on| {
        [
            Command::Compare(on),
            Command::SetStaticHold(on),
            Command::LetGo(on),
            Command::SetGovernor(on),
            Command::Checked(on),
        ]
    });
    let sides = Side::ALL.into_iter().flat_map(|side| {
        [
            Command::EngageOne(side),
            Command::Prompt(side, Prompt::Rest),
            Command::Guide(side, Some(Vector3::zeros())),
            Command::Guide(side, None),
            Command::Grip(side, Some(0.0)),
            Command::Grip(side, None),
        ]
    });
    let others = [
        Command::SetGain(0.0),
        Command::SetGainAboveOne(0.0),
        Command::SetDelay(0.0),
        Command::SetDeadBand(0.0),
        Command::SetScale(0.0),
        Command::Engage,
        Command::Rest,
        Command::Stop,
        Command::ReleaseStop,
        Command::Shutdown,
    ];
    let acts = Side::ALL.into_iter().flat_map(|side| Act::ALL.map(|act| Command::Task(side, act)));
    let counted = Watchdog::ALL.map(Command::TestWatchdog).into_iter().chain(acts);
    modes.chain(switches).chain(sides).chain(others).chain(counted)
}

/// Every name that a device can have: role and make, and by number those of older sessions.
fn device_names() -> impl Iterator<Item = String> {
    let of = |part: Part| part.makes().iter().map(move |make| part.name_of_make(make)).chain([part.name().to_owned()]);
    Part::ALL.into_iter().flat_map(of).chain(["cap".to_owned(), "device 0".to_owned()])
}

fn devices() -> impl Iterator<Item = DeviceEvent> {
    let standings = [Standing::Closed, Standing::Opening, Standing::Connected].into_iter();
    let standings = standings.chain(losses().map(Standing::Lost));
    standings.map(|standing| DeviceEvent { t_s: 0.0, device: 0, standing, of_side: [false; SIDES] })
}

fn happenings() -> impl Iterator<Item = Happens> {
    let (ring, peg) = (0, 0);
    let of_side = move |side| {
        [
            Happens::RingGrasped { ring, side },
            Happens::RingLifted { ring, side },
            Happens::RingTransferred { ring, to: side },
            Happens::RingPlaced { ring, side, peg },
            Happens::RingDropped { ring, side, in_view: true },
            Happens::RingDropped { ring, side, in_view: false },
            Happens::RingKnockedOff { ring, side: Some(side) },
            Happens::LumpMarked { side, lump: None },
            Happens::LumpMarked { side, lump: Some(0) },
            Happens::WireTouched { side },
            Happens::WireLeft { side },
        ]
    };
    let of_none = [Happens::Begun, Happens::Ended, Happens::Aborted, Happens::RingKnockedOff { ring, side: None }];
    Side::ALL.into_iter().flat_map(of_side).chain(of_none)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn our_own_lines_are_known_with_any_number_and_no_other_line() {
        let lines = Lines::all(&crate::console::sessions::lines());
        for line in [
            "right arm: from Ready to Engaged",
            "left arm: fault: The control loop was blocked: drives and force were switched off",
            "command: gain 0.35",
            "command: lead the left handle to 10, 0, -2 mm",
            "right arm: refused: engage the right arm: nobody holds the handle",
            "right arm: refused: delay of the link 100 ms: the delay is that of the network, which is measured and not set",
            "the loop was silent for 612 ms",
            "right handle (Force Dimension): connected",
            "device 3: it sends no data",
            "left arm: fault of the left arm (Kinova): A device was lost: it sends no data",
            "mark 12",
            "alarm: The control loop misses 2.4 % of its periods",
            "ring 3 dropped by the left instrument, out of view",
            "ring 12 placed on peg 7 by the right instrument",
            "alarm over: No ready check of the last 12 hours has passed with these devices",
        ] {
            assert!(lines.has(line), "{line}");
        }
        for line in [
            "",
            "command: gain high",
            "command: gain 0.35 by Jane",
            "Jane: from Ready to Engaged",
            "mark of Jane",
            "right handle (Jane): connected",
        ] {
            assert!(!lines.has(line), "{line}");
        }
    }
}
