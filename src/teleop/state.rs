//! The loop's states and which command leads where.

use crate::runtime::{Command, Fault};

/// State of the loop. Force and motion exist only in [`LoopState::Engaged`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopState {
    /// Measuring; no force, the follower rests.
    Idle,
    /// Following and rendering.
    Engaged,
    /// Stopped by the operator; latched.
    Stopped,
    /// Stopped by a fault; latched.
    Faulted(Fault),
}

impl LoopState {
    /// The state that `command` leads to from here; `None` when it is not allowed here.
    pub const fn after(self, command: Command) -> Option<Self> {
        match (self, command) {
            // The safe state is reachable from everywhere; a fault stays visible under a stop's latch.
            (Self::Faulted(fault), Command::Stop) => Some(Self::Faulted(fault)),
            (_, Command::Stop) => Some(Self::Stopped),
            (Self::Stopped | Self::Faulted(_), Command::ReleaseStop) => Some(Self::Idle),
            (Self::Idle, Command::Engage) => Some(Self::Engaged),
            _ => None,
        }
    }

    /// One word for the screen.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Idle => "Idle",
            Self::Engaged => "Engaged",
            Self::Stopped => "Stopped",
            Self::Faulted(_) => "Fault",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_back_to_force_takes_two_deliberate_steps() {
        for latched in [LoopState::Stopped, LoopState::Faulted(Fault::SourceSilent)] {
            assert_eq!(latched.after(Command::Engage), None);
            assert_eq!(latched.after(Command::ReleaseStop), Some(LoopState::Idle));
        }
        assert_eq!(LoopState::Idle.after(Command::Engage), Some(LoopState::Engaged));
        assert_eq!(LoopState::Engaged.after(Command::Engage), None);
    }

    #[test]
    fn stop_is_reachable_from_everywhere() {
        for state in [LoopState::Idle, LoopState::Engaged, LoopState::Stopped] {
            assert_eq!(state.after(Command::Stop), Some(LoopState::Stopped));
        }
    }
}
