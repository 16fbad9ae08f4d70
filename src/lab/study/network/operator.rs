//! The study's operator: engages once the link has been measured, and after a stop releases it and engages again.

use nima_machine::messages::{Command, LoopState};

/// The operator's reaction time to a stop, and pause between two attempts, s.
const REACTS_S: f64 = 0.3;
const AGAIN_S: f64 = 0.5;

/// Observes both machines and sends commands at the console.
#[derive(Debug)]
pub(super) struct Operator {
    next_s: f64,
    states: [LoopState; 2],
    /// Whether an engagement has been commanded since the machine was last stopped.
    may_drive: [bool; 2],
    /// Number of stops of the console by a fault.
    pub(super) stops: u32,
    /// Number of times that a machine resumed without a command.
    pub(super) resumed: u32,
}

impl Operator {
    /// Engages for the first time at this time, s.
    pub(super) const fn new(from_s: f64) -> Self {
        Self { next_s: from_s, states: [LoopState::Disconnected; 2], may_drive: [false; 2], stops: 0, resumed: 0 }
    }

    /// Processes the states of console and follower.
    pub(super) fn look(&mut self, now_s: f64, states: [LoopState; 2]) {
        for (machine, (was, is)) in self.states.into_iter().zip(states).enumerate() {
            let begins = |of: fn(LoopState) -> bool| of(is) && !of(was);
            if begins(LoopState::is_latched) {
                self.may_drive[machine] = false;
                self.next_s = self.next_s.max(now_s + REACTS_S);
                self.stops += u32::from(machine == 0);
            }
            if begins(|state| state.permits().drives) && !self.may_drive[machine] {
                self.resumed += 1;
            }
        }
        self.states = states;
    }

    /// Returns the current command.
    pub(super) fn command(&mut self, now_s: f64) -> Option<Command> {
        if now_s < self.next_s {
            return None;
        }
        let [console, follower] = self.states;
        let command = if console.is_latched() || (console == LoopState::Idle && follower.is_latched()) {
            Command::ReleaseStop
        } else if console == LoopState::Idle {
            self.may_drive = [true; 2];
            Command::Engage
        } else {
            return None;
        };
        self.next_s = now_s + AGAIN_S;
        Some(command)
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::messages::Fault;

    use super::*;

    #[test]
    fn what_drives_again_unasked_is_counted() {
        let stopped = LoopState::Faulted(Fault::LinkSilent);
        for (asks, resumed) in [(true, 0), (false, 1)] {
            let mut operator = Operator::new(0.0);
            operator.look(0.0, [LoopState::Idle; 2]);
            assert_eq!(operator.command(0.0), Some(Command::Engage));
            operator.look(0.1, [LoopState::Engaged; 2]);
            operator.look(0.2, [stopped, LoopState::Engaged]);
            assert_eq!(operator.command(0.4), None, "he has not reacted yet");
            if asks {
                assert_eq!(operator.command(0.6), Some(Command::ReleaseStop));
                operator.look(0.7, [LoopState::Idle, LoopState::Engaged]);
                assert_eq!(operator.command(1.2), Some(Command::Engage));
            }
            operator.look(1.3, [LoopState::Engaged; 2]);
            assert_eq!((operator.stops, operator.resumed), (1, resumed));
        }
    }
}
