//! Fires a watchdog on purpose: what it watches over is withheld, in idle only, until it raises its fault by its usual way.
//!
//! Nothing else changes: the state stays idle until the fault is there, so drives are off and the force is zero before, while and
//! after. The fault is latched as any other one. A watchdog that does not bite within [`TEST_MAX_S`] has failed, and the loop goes on.

use super::Pair;
use crate::{
    messages::{Fault, LoopState, Refusal, Watchdog},
    teleop::Link,
};

/// Longest time for which something is withheld, s: the longest delay of the link, and half a second.
const TEST_MAX_S: f64 = nima_core::impedance::MAX_DELAY_S + 0.5;

/// A test that is going on.
#[derive(Clone, Copy, Debug)]
pub(super) struct WatchdogTest {
    watchdog: Watchdog,
    until_s: f64,
}

impl<L: Link> Pair<L> {
    pub(super) fn test_watchdog(&mut self, watchdog: Watchdog, t_s: f64) -> Result<(), Refusal> {
        if self.state() != LoopState::Idle {
            return Err(Refusal::State(self.state()));
        }
        self.watchdog_test = Some(WatchdogTest { watchdog, until_s: t_s + TEST_MAX_S });
        Ok(())
    }

    /// Ends a test whose watchdog has not bitten.
    pub(super) fn end_late_test(&mut self, now_s: f64) {
        // A time that is not a number ends it too.
        self.watchdog_test = self.watchdog_test.filter(|test| now_s <= test.until_s);
    }

    /// Whether what this watchdog watches over is withheld.
    pub(in crate::teleop) fn withholds(&self, watchdog: Watchdog) -> bool {
        self.watchdog_test.is_some_and(|test| test.watchdog == watchdog)
    }

    /// Whether this fault is the one that is wanted.
    pub(super) fn is_tested(&self, fault: Fault) -> bool {
        self.watchdog_test.is_some_and(|test| test.watchdog.raises(fault))
    }
}
