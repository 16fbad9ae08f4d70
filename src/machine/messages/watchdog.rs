//! The watchdogs of the loop that can be tested.

use super::Fault;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watchdog {
    /// The supervisor: the loop has not sent a beat for [`crate::runtime::STALL_MAX_S`].
    Loop,
    /// The rig has sent no sample for the age limit.
    Source,
    /// No packet has arrived over the link for too long.
    Link,
}

impl Watchdog {
    /// Every watchdog, in the order of the tests.
    pub const ALL: [Self; 3] = [Self::Loop, Self::Source, Self::Link];

    pub const fn raises(self, fault: Fault) -> bool {
        matches!(
            (self, fault),
            (Self::Loop, Fault::LoopStalled { .. })
                | (Self::Source, Fault::SourceSilent)
                | (Self::Link, Fault::LinkSilent)
        )
    }
}
