//! Outcome of a run, with the reason if it failed.

use nima_core::safety::TransitionCause;
use nima_devices::ConnectionState;
use nima_machine::{
    messages::{Command, Event, Fault, LoopState, Refusal, Tick},
    rig::{SIDES, Side},
    runtime::{ArmEnd, CauseAndCure, RuntimeSummary},
};
use nima_words::report_text::{cure_of_refusal, refused_because};

#[derive(Debug, Default)]
pub(super) struct Reasons {
    refusals: [Option<Refusal>; SIDES],
    was_engaged: [bool; SIDES],
}

impl Reasons {
    pub(super) fn watch(&mut self, tick: &Tick) {
        self.was_engaged[tick.side.index()] |= tick.state == LoopState::Engaged;
    }

    /// Adds an event; returns a message to print at once, if there is one.
    pub(super) fn take(&mut self, event: &Event) -> Option<String> {
        match *event {
            Event::CommandRefused { side, command: Command::Engage | Command::EngageOne(_), why, .. } => {
                let before = self.refusals[side.index()].replace(why);
                let report = || {
                    format!(
                        "the {} arm was not engaged: {}; {}",
                        side.word(),
                        refused_because(why),
                        cure_of_refusal(why)
                    )
                };
                (before != Some(why)).then(report)
            }
            Event::StateChanged { side, why: TransitionCause::Absent, .. } => {
                self.refusals[side.index()] = Some(Refusal::HandAbsent);
                None
            }
            Event::StateChanged { side, to: LoopState::Engaged, .. } => {
                self.refusals[side.index()] = None;
                None
            }
            _ => None,
        }
    }

    /// Returns the reason why the run did not do its task; `None` if it did. `engages`: the rig was to engage
    /// automatically.
    pub(super) fn of(&self, summary: &RuntimeSummary, engages: bool) -> Option<String> {
        summary.arms.iter().find_map(|arm| self.of_arm(arm, summary, engages))
    }

    fn of_arm(&self, arm: &ArmEnd, summary: &RuntimeSummary, engages: bool) -> Option<String> {
        let side = arm.side.word();
        match arm.final_state {
            LoopState::Engaged | LoopState::Clutched => None,
            LoopState::Faulted(Fault::OtherArm) if summary.arms.len() > 1 => None,
            LoopState::Faulted(_) => {
                let CauseAndCure { device, cause, cure } = arm.fault.as_ref()?;
                let device = device.as_ref().map(|device| format!(" ({device})")).unwrap_or_default();
                Some(format!("the {side} arm ended in a fault: {cause}{device}. {cure}"))
            }
            LoopState::Disconnected => {
                Some(format!("the {side} arm ended without a device: {}", missing(arm.side, summary)))
            }
            LoopState::Stopped => Some(format!("the {side} arm was stopped")),
            LoopState::Idle | LoopState::Ready if !engages => None,
            LoopState::Idle | LoopState::Ready => Some(match self.refusals[arm.side.index()] {
                Some(why) => format!(
                    "the {side} arm ended without being engaged: {}; {}",
                    refused_because(why),
                    cure_of_refusal(why)
                ),
                None if self.was_engaged[arm.side.index()] => {
                    format!("the {side} arm was no longer engaged at the end of the run")
                }
                None => format!("the {side} arm was not yet engaged at the end of the run: increase --seconds"),
            }),
        }
    }
}

/// Returns the first missing device of this arm, with cause and remedy.
fn missing(side: Side, summary: &RuntimeSummary) -> String {
    let absent = || summary.devices.iter().filter(|device| device.health.standing != ConnectionState::Connected);
    let first = absent().find(|device| device.name.starts_with(side.word())).or_else(|| absent().next());
    let Some(device) = first else { return "its devices send no new data; test them with `nima devices`".to_owned() };
    match (&device.trouble, device.health.standing) {
        (Some(trouble), _) => format!("{}: {}. {}", device.name, trouble.cause, trouble.cure),
        (None, ConnectionState::Lost(loss)) => {
            format!("{}: {}; it reconnects automatically", device.name, loss.cause())
        }
        (None, _) => format!("{} was still being opened; increase --seconds", device.name),
    }
}
