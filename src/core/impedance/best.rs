//! Mixture of anchored and matched rendering and of holding, weighted by their recent errors at the leader.
//!
//! The constants were chosen on four recordings of the first rig and on sequences of changing tissue.

use super::{
    Mode, SLOTS,
    change::LastingError,
    holding::{HeldMixture, Holding},
    messages::{IdentificationReport, LinkPacket},
    method::{LeaderEnd, LeaderInput, RenderingMethod},
    mixture::eighth_power,
    motion_clock::{fraction, newest_fraction},
    settings::{ImpedanceSettings, MAX_DELAY_S},
};
use crate::signal::{DelayLine, Lanes};

/// Memory of the errors (s by the clock).
/// Design choice: longer memories follow a change of tissue later, shorter ones follow the noise of the errors.
const MEMORY_S: f64 = 1.0;
/// Matched rendering learns more slowly than anchored rendering, so its past errors are pessimistic. At first they are
/// reduced by this fraction; they count fully once the memory is full.
const LEARNING: f64 = 0.2;
/// The smallest error of matched rendering over the last half to full period of this length (s), times this fraction,
/// is a lower bound of its mean error.
const LASTING_S: f64 = 0.06;
const LASTING: f64 = 0.7;
/// Memory in which the mixture itself is compared with anchored rendering (s by the clock): some touches. 1 to 8 s
/// perform equally well.
const TRIAL_S: f64 = 4.0;
/// Errors below this count as equal (N), because the weights would otherwise divide one rounding error by another.
const EQUAL_N: f64 = 1e-12;

/// The mixture of anchored and matched rendering and of holding.
#[derive(Clone, Debug)]
pub(super) struct Best {
    /// Only where the mode is computed.
    judge: Option<Judge>,
}

impl RenderingMethod for Best {
    const NAME: &'static str = "best";
    const ABOUT: &'static str = "anchored and matched, weighted by their recent errors";
    const PARTS: &'static [Mode] = &[Mode::Anchored, Mode::Matched];

    fn leader(settings: &ImpedanceSettings) -> Box<dyn LeaderEnd> {
        Box::new(Self { judge: settings.modes.contains(Mode::Best).then(|| Judge::new(settings)) })
    }

    fn degree(report: &IdentificationReport) -> u8 {
        report.degrees.matched
    }
}

impl LeaderEnd for Best {
    fn render(&mut self, moment: &LeaderInput<'_>) -> Option<Lanes> {
        let anchored = moment.forces_n[Mode::Anchored.index()]?;
        let matched = moment.forces_n[Mode::Matched.index()];
        match &mut self.judge {
            Some(judge) => Some(judge.render(anchored, matched, moment.measured_n)),
            None => Some(matched.unwrap_or(anchored)),
        }
    }

    fn keep(&mut self, forces_n: &[Option<Lanes>; SLOTS], pace: f64) {
        let is_rendered = forces_n[Mode::Best.index()].is_some();
        self.judge.iter_mut().for_each(|judge| judge.keep(is_rendered, pace));
    }

    fn judge(&mut self, parcel: &LinkPacket, age_ticks: usize) {
        self.judge.iter_mut().for_each(|judge| judge.receive(parcel, age_ticks));
    }

    fn reset(&mut self) {
        self.judge.iter_mut().for_each(Judge::reset);
    }
}

/// A softmin, per axis, of the running errors of the forces that the leader rendered, compared with the force that a
/// packet delivers one delay later. The follower cannot compute this, because it does not have the motion from which
/// the leader makes the force, and matched rendering errs by the stiffness times what that motion is wrong.
///
/// On another tissue both err at first: anchored rendering for one delay, matched rendering until it has learned the
/// tissue. Because the errors of both are known one delay late, both look bad for as long again. A lasting error of
/// matched rendering reveals the change sooner: it is compared at once with the usual error of anchored rendering.
///
/// If the tissue changes again and again, each change costs something before it is detected. The mixture itself is
/// therefore evaluated over some touches: the more it errs beyond anchored rendering, the smaller the weight of matched
/// rendering.
///
/// Where motion does not explain the force, both are worse than the held force, which is therefore mixed in.
#[derive(Clone, Debug)]
struct Judge {
    rate_hz: f64,
    /// The forces of this tick, until they are stored.
    newest: Option<Said>,
    said: DelayLine<Option<Said>>,
    judged: f64,
    anchored_n: Lanes,
    matched_n: Lanes,
    lasting: LastingError,
    trial: MixtureTrial,
    anchored: Lanes,
    /// `None` in the replay of a session that was recorded without it.
    holding: Option<Holding>,
}

/// Forces (N) that anchored, matched and their mixture rendered at one tick, and the pace of time then.
#[derive(Clone, Copy, Debug)]
struct Said {
    matched_n: Lanes,
    mixture: HeldMixture,
    pace: f64,
}

/// Mean errors (N) of the mixture and of anchored rendering.
#[derive(Clone, Copy, Debug, Default)]
struct MixtureTrial {
    judged: f64,
    anchored_n: Lanes,
    mixed_n: Lanes,
}

impl MixtureTrial {
    /// Returns the degree to which the mixture is to be abandoned, 0 to 1.
    fn step(&mut self, [anchored_n, mixed_n]: [Lanes; 2], pace: f64, rate_hz: f64) -> Lanes {
        self.judged += pace;
        let fraction = fraction(pace, self.judged, TRIAL_S * rate_hz);
        follow(&mut self.anchored_n, anchored_n, fraction);
        follow(&mut self.mixed_n, mixed_n, fraction);
        let odds = odds(self.mixed_n, self.anchored_n);
        // Squaring the odds doubles the exponent, so that the mixture is rarely worse by more than a few per cent.
        (odds * odds).map(|odds| 1.0 / (1.0 + odds.recip()))
    }
}

impl Judge {
    fn new(settings: &ImpedanceSettings) -> Self {
        let none = Lanes::ZERO;
        Self {
            rate_hz: settings.rate_hz,
            newest: None,
            said: DelayLine::new((MAX_DELAY_S * settings.rate_hz).ceil() as usize, None),
            judged: 0.0,
            anchored_n: none,
            matched_n: none,
            lasting: LastingError::default(),
            trial: MixtureTrial::default(),
            anchored: none,
            holding: (!settings.earlier_forces).then(|| Holding::new(settings.rate_hz)),
        }
    }

    /// Returns the mixture of the forces (N). Matched rendering has the whole weight before the first evaluation.
    fn render(&mut self, anchored_n: Lanes, matched_n: Option<Lanes>, held_n: Lanes) -> Lanes {
        let without_n = matched_n.map_or(anchored_n, |matched_n| matched_n + (anchored_n - matched_n) * self.anchored);
        let alone = HeldMixture { anchored: anchored_n, without: without_n, held: held_n, mixed: without_n };
        let mixture = self.holding.as_ref().map_or(alone, |holding| holding.mix(alone));
        self.newest = matched_n.map(|matched_n| Said { matched_n, mixture, pace: 0.0 });
        mixture.mixed
    }

    /// Stores the forces of this tick, if they were rendered.
    fn keep(&mut self, is_rendered: bool, pace: f64) {
        let newest = self.newest.take().filter(|_| is_rendered);
        self.said.push(newest.map(|said| Said { pace, ..said }));
    }

    /// Evaluates the forces rendered `age` ticks ago against the force of that time, which has just arrived.
    fn receive(&mut self, parcel: &LinkPacket, age: usize) {
        if !parcel.modes.contains(Mode::Best) {
            self.forget();
            return;
        }
        let Some(&Some(Said { matched_n, mixture, pace })) = self.said.get(age) else { return };
        if !parcel.fresh || parcel.resting {
            return;
        }
        let force_n = Lanes::from(parcel.force_n);
        self.judged += pace;
        let memory = MEMORY_S * self.rate_hz;
        let fraction = newest_fraction(pace, self.judged, memory);
        let said_n = [mixture.anchored, matched_n, mixture.without];
        let [anchored_n, matched_n, mixed_n] = said_n.map(|said_n| (force_n - said_n).map(f64::abs));
        follow(&mut self.anchored_n, anchored_n, fraction);
        follow(&mut self.matched_n, matched_n, fraction);
        let block = ((0.5 * LASTING_S * self.rate_hz).round() as usize).max(1);
        let lasting_n = self.lasting.step(block, matched_n) * LASTING;
        let full = (self.judged / memory).min(1.0);
        let learning = 1.0 - LEARNING * (1.0 - full);
        let odds = odds(self.matched_n.zip(lasting_n, f64::max) * learning, self.anchored_n);
        self.anchored = odds.map(|odds| 1.0 / (1.0 + odds.recip()));
        // In the first half of the memory, both modes are still learning, so neither is given up.
        if full > 0.5 {
            let given_up = self.trial.step([anchored_n, mixed_n], pace, self.rate_hz) * (2.0 * full - 1.0);
            self.anchored += (Lanes::splat(1.0) - self.anchored) * given_up;
        }
        self.holding.iter_mut().for_each(|holding| holding.judge(force_n, &mixture, pace, age));
    }

    fn forget(&mut self) {
        let none = Lanes::ZERO;
        self.judged = 0.0;
        self.anchored_n = none;
        self.matched_n = none;
        self.anchored = none;
        self.lasting = LastingError::default();
        self.trial = MixtureTrial::default();
        self.holding.iter_mut().for_each(Holding::reset);
    }

    fn reset(&mut self) {
        self.said.clear();
        self.newest = None;
        self.forget();
    }
}

/// Moves a mean error (N) towards the newest.
fn follow(mean_n: &mut Lanes, error_n: Lanes, fraction: f64) {
    *mean_n = (*mean_n + (error_n - *mean_n) * fraction).settled();
}

/// Returns the odds against a mode that errs by `error_n`, compared with a mode that errs by `other_n`.
fn odds(error_n: Lanes, other_n: Lanes) -> Lanes {
    let floor_n = Lanes::splat(EQUAL_N);
    eighth_power((error_n + floor_n) / (other_n + floor_n))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impedance::ModeSet;

    const DELAY: usize = 100;

    /// A leader that receives a force of `0` while the modes (anchored, matched) rendered `errors_n` one delay earlier.
    struct Fixture(Judge);

    impl Fixture {
        fn new() -> Self {
            Self(Judge::new(&ImpedanceSettings::default()))
        }

        /// Runs for some ticks; returns the weight of anchored rendering afterwards.
        fn run(&mut self, ticks: usize, errors_n: [f64; 2]) -> f64 {
            let parcel = LinkPacket { fresh: true, modes: ModeSet::only(Mode::Best), ..LinkPacket::BLANK };
            let [anchored_n, matched_n] = errors_n.map(Lanes::splat);
            for _ in 0..ticks {
                self.0.render(anchored_n, Some(matched_n), Lanes::splat(1.0));
                self.0.keep(true, 1.0);
                self.0.receive(&parcel, DELAY);
            }
            self.0.anchored[0]
        }
    }

    #[test]
    fn an_error_that_does_not_go_away_tells_another_tissue_before_anchored_has_been_right_again() {
        let mut bench = Fixture::new();
        assert!(bench.run(5000, [0.1, 0.05]) < 0.01, "on a known tissue matched is the better");
        // On new tissue both modes are wrong: anchored for one delay. Once anchored is right again, no newer error is
        // known yet.
        bench.run(DELAY, [0.6, 0.6]);
        let weight = bench.run(DELAY, [0.1, 0.6]);
        assert!(weight > 0.9, "{weight} when the first errors of the new tissue have all come");
    }

    #[test]
    fn an_error_that_passes_changes_little() {
        let mut bench = Fixture::new();
        bench.run(5000, [0.1, 0.05]);
        for _ in 0..20 {
            let weight = bench.run(20, [0.1, 0.3]).max(bench.run(180, [0.1, 0.03]));
            assert!(weight < 0.2, "{weight}");
        }
    }

    #[test]
    fn what_was_learnt_first_says_little_and_everything_ends_in_the_better() {
        let mut bench = Fixture::new();
        assert!(bench.run(DELAY, [0.1, 0.5]) <= 0.0, "nothing was judged: matched has all the weight");
        assert!(bench.run(300, [0.1, 0.5]) > 0.9);
        assert!(bench.run(5000, [0.1, 0.05]) < 0.01);
        assert!(bench.run(5000, [0.1, 0.11]) > 0.6);
    }

    #[test]
    fn where_the_tissue_changes_at_every_touch_matched_is_given_up_although_it_is_better_in_between() {
        let mut bench = Fixture::new();
        let mut touches = |count: usize, changed_n: f64| {
            let touch = |_| {
                bench.run(300, [0.1, changed_n]);
                bench.run(1700, [0.1, 0.06])
            };
            (0..count).map(touch).last().unwrap()
        };
        let known = touches(5, 0.1);
        let changing = touches(5, 0.6);
        assert!(known < 0.1, "{known}");
        assert!(changing > 0.6, "{changing} before the next change");
        let known = touches(5, 0.1);
        assert!(known < 0.1, "{known} when it no longer changes");
    }
}
