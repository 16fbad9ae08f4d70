//! Engages automatically, once all data that the command line can have are known.

use nima_machine::{
    messages::{Event, Refusal},
    rig::EngageBlocker,
};

/// Time until the next request after a refusal for missing data, s.
const AGAIN_S: f64 = 0.3;

/// The single engagement of a run without a person.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RunEngagement {
    asked: bool,
    again_s: Option<f64>,
}

impl RunEngagement {
    /// Another part engages, or nothing may.
    pub(super) const fn left_to_others(others: bool) -> Self {
        Self { asked: others, again_s: None }
    }

    /// Returns whether to request an engagement now (s on the loop's clock), if everything is `ready`.
    pub(super) fn asks(&mut self, ready: bool, now_s: f64) -> bool {
        if self.again_s.take_if(|again_s| now_s >= *again_s).is_some() {
            self.asked = false;
        }
        let asks = ready && !self.asked;
        self.asked |= asks;
        asks
    }

    /// A device that starts later than the others, such as a tracker, must not leave the rig idle for the whole run.
    pub(super) fn receives(&mut self, event: &Event) {
        if let Event::CommandRefused { t_s, why: Refusal::Obstacle(EngageBlocker::Waiting(_)), .. } = event {
            self.again_s = Some(t_s + AGAIN_S);
        }
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::{
        messages::Command,
        rig::{AwaitedDevice, Side},
    };

    use super::*;

    #[test]
    fn it_asks_once_and_again_only_when_it_came_too_early() {
        let mut engaging = RunEngagement::default();
        assert!(!engaging.asks(false, 0.0) && engaging.asks(true, 0.1) && !engaging.asks(true, 0.2));
        let refused =
            |t_s: f64, why: Refusal| Event::CommandRefused { t_s, side: Side::Right, command: Command::Engage, why };
        engaging.receives(&refused(0.2, Refusal::DrivesOff));
        assert!(!engaging.asks(true, 5.0), "a person has to see to that");
        engaging.receives(&refused(5.0, Refusal::Obstacle(EngageBlocker::Waiting(AwaitedDevice::Markers))));
        assert!(!engaging.asks(true, 5.1) && engaging.asks(true, 5.3) && !engaging.asks(true, 9.0));
        assert!(!RunEngagement::left_to_others(true).asks(true, 1.0));
    }
}
