//! Tests a watchdog: its input is suppressed, in idle only, until it raises its fault in the usual way.
//!
//! Nothing else changes: the state stays idle until the fault is raised, so drives are off and the force is zero
//! before, during and after the test. The fault is latched like any other fault. A watchdog that does not trip within
//! [`TEST_MAX_S`] has failed, and the loop continues.

use super::Pair;
use crate::{
    messages::{Fault, LoopState, Refusal, Watchdog},
    teleop::Link,
};

/// Maximum time for which an input is suppressed, s: the longest delay of the link, and half a second.
const TEST_MAX_S: f64 = nima_core::impedance::MAX_DELAY_S + 0.5;

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

    /// Ends a test whose watchdog has not tripped.
    pub(super) fn end_late_test(&mut self, now_s: f64) {
        // A time of NaN ends the test too.
        self.watchdog_test = self.watchdog_test.filter(|test| now_s <= test.until_s);
    }

    /// Returns whether the input of this watchdog is suppressed.
    pub(in crate::teleop) fn withholds(&self, watchdog: Watchdog) -> bool {
        self.watchdog_test.is_some_and(|test| test.watchdog == watchdog)
    }

    pub(super) fn is_tested(&self, fault: Fault) -> bool {
        self.watchdog_test.is_some_and(|test| test.watchdog.raises(fault))
    }
}
