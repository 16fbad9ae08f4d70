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
                        cure_in_terminal(why)
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
    /// automatically; `link`: cause and remedy of a link to another machine that is down.
    pub(super) fn of(&self, summary: &RuntimeSummary, engages: bool, link: Option<&[String; 2]>) -> Option<String> {
        summary.arms.iter().find_map(|arm| self.of_arm(arm, summary, engages, link))
    }

    fn of_arm(
        &self,
        arm: &ArmEnd,
        summary: &RuntimeSummary,
        engages: bool,
        link: Option<&[String; 2]>,
    ) -> Option<String> {
        let side = arm.side.word();
        match arm.final_state {
            LoopState::Engaged | LoopState::Clutched => None,
            LoopState::Faulted(Fault::OtherArm) if summary.arms.len() > 1 => None,
            LoopState::Faulted(fault) => Some(ended_in(fault, side, arm.fault.as_ref()?, link)),
            LoopState::Disconnected => {
                Some(format!("the {side} arm ended without a device: {}", missing(arm.side, summary)))
            }
            LoopState::Stopped => Some(format!("the {side} arm was stopped")),
            LoopState::Idle | LoopState::Ready if !engages => None,
            LoopState::Idle | LoopState::Ready => Some(match self.refusals[arm.side.index()] {
                Some(why) => format!(
                    "the {side} arm ended without being engaged: {}; {}",
                    refused_because(why),
                    cure_in_terminal(why)
                ),
                None if self.was_engaged[arm.side.index()] => {
                    format!("the {side} arm was no longer engaged at the end of the run")
                }
                None => format!("the {side} arm was not yet engaged at the end of the run: increase --seconds"),
            }),
        }
    }
}

/// Returns the text of an arm that ended in a fault.
fn ended_in(fault: Fault, side: &str, known: &CauseAndCure, link: Option<&[String; 2]>) -> String {
    let CauseAndCure { device, cause, cure } = known;
    let device = device.as_ref().map(|device| format!(" ({device})")).unwrap_or_default();
    let begin = format!("the {side} arm ended in a fault: {cause}{device}");
    match (fault, link) {
        // The link has the reason, and starting again releases the stop.
        (Fault::LinkSilent, Some([why, cure])) => format!("{begin}: {why}; {cure}, then start this command again"),
        _ => format!("{begin}. {cure}"),
    }
}

/// Returns the remedy, a clause without a full stop, for a command: a terminal has no buttons.
fn cure_in_terminal(why: Refusal) -> &'static str {
    match why {
        Refusal::StillPresent(Fault::FarEnd { .. }) => {
            "remove the cause on the follower's machine, then start `nima follower` there again, or release both \
             machines in `nima console --follower HOST` with Stop and Release stop"
        }
        Refusal::State(LoopState::Stopped | LoopState::Faulted(_)) => {
            "remove the cause, then start the command again, which releases the stop"
        }
        why => cure_of_refusal(why),
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

#[cfg(test)]
mod tests {
    use nima_machine::messages::FarStop;

    use super::*;

    #[test]
    fn a_console_that_ended_is_named_as_the_cause_of_the_silent_link() {
        let known = CauseAndCure { device: None, cause: "No data".to_owned(), cure: "Press Release stop".to_owned() };
        let link = ["the program was closed", "restart it there"].map(str::to_owned);
        let words = ended_in(Fault::LinkSilent, "right", &known, Some(&link));
        assert!(words.ends_with("the program was closed; restart it there, then start this command again"), "{words}");
    }

    #[test]
    fn no_remedy_needs_a_button_that_a_terminal_lacks() {
        let refused = |why| {
            let command = Command::Engage;
            let event = Event::CommandRefused { t_s: 1.0, side: Side::Right, command, why };
            Reasons::default().take(&event).unwrap()
        };
        let far = refused(Refusal::StillPresent(Fault::FarEnd { stop: FarStop::LinkSilent }));
        assert!(far.contains("start `nima follower` there again") && !far.contains(" here"), "{far}");
        let stopped = refused(Refusal::State(LoopState::Stopped));
        assert!(stopped.contains("start the command again") && !stopped.contains("press"), "{stopped}");
    }
}
