//! Performance of a tip-force network in use: the only sign that it no longer suits the work.

use nima_core::tip_force::Unsure;
use nima_machine::messages::{ForceSource, LoopState, Tick};

/// Ticks of use after which the fractions are meaningful: 10 s at 1 kHz.
const ENOUGH: u64 = 10_000;

/// Counts the ticks with force since the loop started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct InUse {
    ticks: u64,
    outside: u64,
    without: u64,
}

/// Fractions of the time with force, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TimeFractions {
    /// Outside the training data, where only the network's linear path is used.
    pub(super) outside: f64,
    /// So far outside that the network was not used.
    pub(super) without: f64,
}

impl InUse {
    pub(super) fn watch(&mut self, tick: &Tick) {
        if tick.state != LoopState::Engaged {
            return;
        }
        let (outside, without) = match tick.force.source {
            ForceSource::Network | ForceSource::InDoubt { unsure: Unsure::NotMoved | Unsure::Missing, .. } => (0, 0),
            ForceSource::Extrapolated => (1, 0),
            ForceSource::InDoubt { unsure: Unsure::OutsideTraining, .. } => (0, 1),
            // No network is active.
            _ => return,
        };
        self.ticks += 1;
        self.outside += outside;
        self.without += without;
    }

    /// `None` until there was enough use.
    pub(super) fn fractions(&self) -> Option<TimeFractions> {
        let fraction = |count: u64| count as f64 / self.ticks as f64;
        (self.ticks >= ENOUGH)
            .then(|| TimeFractions { outside: fraction(self.outside), without: fraction(self.without) })
    }
}

#[cfg(test)]
mod tests {
    use nima_core::tip_force::Fallback;
    use nima_machine::{
        config::RigConfig,
        rig::{SIDES, Side},
        teleop::{Calibrations, Loop, Timing},
    };

    use super::*;

    #[test]
    fn a_network_is_judged_by_the_time_in_which_its_force_was_rendered() {
        let rig = RigConfig::load("simulated").unwrap();
        let mut control = Loop::new(&rig, &[Some(Calibrations::default()), None]).unwrap();
        let some = control.step([None; SIDES], &Timing::default()).1[Side::Right.index()].unwrap();
        let mut in_use = InUse::default();
        let mut watch = |ticks: u64, state: LoopState, source: ForceSource| {
            let mut tick = some;
            tick.state = state;
            tick.force.source = source;
            (0..ticks).for_each(|_| in_use.watch(&tick));
            in_use.fractions()
        };
        let far = ForceSource::InDoubt { unsure: Unsure::OutsideTraining, fallback: Fallback::WristForce };
        assert_eq!(watch(20_000, LoopState::Idle, far), None, "nothing was rendered");
        assert_eq!(watch(20_000, LoopState::Engaged, ForceSource::Wrist), None, "there is no network");
        assert_eq!(watch(9_999, LoopState::Engaged, ForceSource::Network), None, "too short to say anything");
        watch(8_001, LoopState::Engaged, ForceSource::Extrapolated);
        let fractions = watch(2_000, LoopState::Engaged, far).unwrap();
        assert_eq!(fractions, TimeFractions { outside: 8_001.0 / 20_000.0, without: 0.1 });
    }
}
