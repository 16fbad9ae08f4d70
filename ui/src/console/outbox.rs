//! What the operator asked for and the loop has not taken yet.

use nima_machine::{messages::Command, runtime::Handle};

/// Commands on their way; a stop overtakes everything.
#[derive(Debug, Default)]
pub struct Outbox {
    waiting: Vec<Command>,
    /// A stop was offered to the loop and not taken.
    stop_refused: bool,
}

impl Outbox {
    /// Puts a command in. A newer value of the same setting replaces the one that still waits, so that a dragged slider
    /// never fills the loop's queue; a stop throws away all that waits, because none of it is wanted any more.
    pub fn push(&mut self, command: Command) {
        if command == Command::Stop {
            self.waiting.clear();
        }
        self.waiting.retain(|old| std::mem::discriminant(old) != std::mem::discriminant(&command));
        self.waiting.push(command);
    }

    /// Hands over what the loop takes; the rest stays for the next frame. Without a loop nothing is taken.
    pub fn flush(&mut self, handle: Option<&Handle>) {
        self.flush_into(|command| handle.is_some_and(|handle| handle.send(command)));
    }

    fn flush_into(&mut self, mut send: impl FnMut(Command) -> bool) {
        let sent = self.waiting.iter().take_while(|&&command| send(command)).count();
        self.waiting.drain(..sent);
        self.stop_refused = self.holds_stop();
    }

    /// A stop is on its way.
    pub fn holds_stop(&self) -> bool {
        self.waiting.contains(&Command::Stop)
    }

    /// The stop itself was not taken by the loop: the operator must know. Not yet so in the frame in which it is asked for.
    pub const fn stop_is_stuck(&self) -> bool {
        self.stop_refused
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
