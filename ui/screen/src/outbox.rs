//! Commands of the operator that the loop has not received yet.

use nima_machine::{messages::Command, runtime::LoopHandle};

use crate::live::LiveState;

/// Queue of commands; a stop overtakes all others.
#[derive(Debug, Default)]
pub struct Outbox {
    waiting: Vec<Command>,
    /// Stops requested by a person.
    stops: u64,
    /// A stop did not fit into the loop's queue.
    stop_refused: bool,
    /// The operator's choice whether all modes are compared, while a panel needs all of them.
    compares: Option<bool>,
}

impl Outbox {
    /// Adds a command. A newer value of a setting replaces a waiting one, so that dragging a slider does not fill the loop's
    /// queue. A stop removes all waiting commands.
    pub fn push(&mut self, command: Command) {
        if let (Command::Compare(compares), Some(choice)) = (command, &mut self.compares) {
            *choice = compares;
            return;
        }
        if command == Command::Stop {
            self.waiting.clear();
            self.stops += 1;
        }
        self.waiting.retain(|old| !is_outdated(old, command));
        self.waiting.push(command);
    }

    /// Returns whether the operator compares all modes, whatever a panel needs.
    pub fn compares(&self, live: &LiveState) -> bool {
        self.compares.unwrap_or_else(|| live.compares())
    }

    /// Makes the loop compute all modes while a panel on the screen shows them; afterwards the operator's choice applies
    /// again. Call once per frame.
    pub fn show_all_modes(&mut self, shows: bool, live: &LiveState) {
        if shows == self.compares.is_some() {
            return;
        }
        let waiting = self.waiting.iter().find_map(|command| match command {
            Command::Compare(compares) => Some(*compares),
            _ => None,
        });
        let choice = self.compares.take().or(waiting).unwrap_or_else(|| live.compares());
        if !choice {
            self.push(Command::Compare(shows));
        }
        self.compares = shows.then_some(choice);
    }

    /// Sends commands while the loop's queue has room; the others wait for the next frame. Without a loop nothing is sent.
    pub fn flush(&mut self, handle: Option<&LoopHandle>) {
        self.flush_into(|command| handle.is_some_and(|handle| handle.send(command)));
    }

    /// Takes the waiting commands without sending them.
    pub fn sent(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.waiting)
    }

    fn flush_into(&mut self, mut send: impl FnMut(Command) -> bool) {
        let sent = self.waiting.iter().take_while(|&&command| send(command)).count();
        self.waiting.drain(..sent);
        self.stop_refused = self.holds_stop();
    }

    /// Drops all waiting commands except a stop.
    pub fn only_stop(&mut self) {
        self.waiting.retain(|command| *command == Command::Stop);
    }

    /// Drops a delay of the link: over a network it is measured, and the loop would refuse it.
    pub fn without_delay(&mut self) {
        self.waiting.retain(|command| !matches!(command, Command::SetDelay(_)));
    }

    /// Drops all waiting commands.
    pub fn forget(&mut self) {
        self.waiting.clear();
    }

    pub fn holds_stop(&self) -> bool {
        self.waiting.contains(&Command::Stop)
    }

    /// Returns the number of stops requested by a person. Every stop of the window is a person's, and the loop ignores
    /// a stop under a latched fault.
    pub const fn stops(&self) -> u64 {
        self.stops
    }

    /// Returns whether the loop's queue had no room for a stop, which must be shown to the operator. Not yet true in
    /// the frame of the request.
    pub const fn stop_is_stuck(&self) -> bool {
        self.stop_refused
    }
}

/// Returns whether this newer command makes a waiting one obsolete: both concern the same setting of the same side.
fn is_outdated(old: &Command, newer: Command) -> bool {
    match (*old, newer) {
        (Command::Guide(old, _), Command::Guide(newer, _)) | (Command::Grip(old, _), Command::Grip(newer, _)) => {
            old == newer
        }
        // Task commands never replace each other: all of them are sent.
        (Command::Task(..), Command::Task(..)) => false,
        (old, newer) => std::mem::discriminant(&old) == std::mem::discriminant(&newer),
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::rig::{Side, TaskAction};

    use super::*;

    #[test]
    fn both_instruments_are_led_in_one_frame_and_every_act_is_done() {
        let mut outbox = Outbox::default();
        for rad in [0.6, 0.0] {
            for side in Side::ALL {
                outbox.push(Command::Guide(side, None));
                outbox.push(Command::Grip(side, Some(rad)));
            }
            outbox.push(Command::Task(Side::Right, TaskAction::Mark));
        }
        let [right, left] = Side::ALL;
        let mark = Command::Task(right, TaskAction::Mark);
        let of = |side| [Command::Guide(side, None), Command::Grip(side, Some(0.0))];
        let wanted: Vec<Command> = [mark].into_iter().chain(of(right)).chain(of(left)).chain([mark]).collect();
        assert_eq!(outbox.waiting, wanted);
    }

    #[test]
    fn a_panel_that_shows_all_modes_leaves_the_operators_choice() {
        let plan = nima_tests::plan("peg_transfer");
        let live = LiveState::new(plan.rig, plan.scene);
        let [all, one] = [true, false].map(Command::Compare);
        let mut outbox = Outbox::default();
        outbox.show_all_modes(true, &live);
        outbox.show_all_modes(true, &live);
        assert_eq!((outbox.sent(), outbox.compares(&live)), (vec![all], false));
        outbox.show_all_modes(false, &live);
        assert_eq!(outbox.sent(), [one]);
        outbox.push(all);
        outbox.show_all_modes(true, &live);
        assert_eq!((outbox.sent(), outbox.compares(&live)), (vec![all], true));
        outbox.push(one);
        assert_eq!((outbox.sent(), outbox.compares(&live)), (vec![], false), "the panel still needs all");
        outbox.push(all);
        outbox.show_all_modes(false, &live);
        assert_eq!(outbox.sent(), [], "the operator compares now");
    }

    #[test]
    fn a_dragged_slider_leaves_one_command() {
        let mut outbox = Outbox::default();
        for gain in [0.1, 0.2, 0.3] {
            outbox.push(Command::SetGain(gain));
        }
        outbox.push(Command::SetDelay(0.1));
        assert_eq!(outbox.waiting, [Command::SetGain(0.3), Command::SetDelay(0.1)]);
    }

    #[test]
    fn a_stop_overtakes_and_is_kept_until_taken() {
        let mut outbox = Outbox::default();
        outbox.push(Command::Engage);
        outbox.push(Command::Stop);
        assert!(outbox.holds_stop() && !outbox.stop_is_stuck(), "it has not been offered yet");
        outbox.flush_into(|_| false);
        assert!(outbox.stop_is_stuck());
        let mut sent = Vec::new();
        outbox.flush_into(|command| {
            sent.push(command);
            true
        });
        assert_eq!(sent, [Command::Stop]);
        assert!(!outbox.stop_is_stuck());
    }
}
