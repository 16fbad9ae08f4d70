//! The watchdogs of the loop that can be fired on purpose, to see that they bite.

use super::Fault;

/// A watchdog of the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watchdog {
    /// The supervisor: the loop has not beaten for [`crate::runtime::STALL_MAX_S`].
    Loop,
    /// The rig has sent no sample for the age limit.
    Source,
    /// Nothing has come over the link for too long.
    Link,
}

impl Watchdog {
    /// Every one, in the order in which they are tested.
    pub const ALL: [Self; 3] = [Self::Loop, Self::Source, Self::Link];

    /// Whether this is the fault that it raises.
    pub const fn raises(self, fault: Fault) -> bool {
        matches!(
            (self, fault),
            (Self::Loop, Fault::LoopStalled { .. })
                | (Self::Source, Fault::SourceSilent)
                | (Self::Link, Fault::LinkSilent)
        )
    }
}
