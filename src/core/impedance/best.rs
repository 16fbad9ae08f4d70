//! The better of anchored and matched rendering, by what each was worth lately where the force is felt.

use super::{
    Mode,
    messages::Parcel,
    pace::share,
    settings::{MAX_DELAY_S, Settings},
};
use crate::signal::{DelayLine, Lanes};

/// Memory of the errors (s by the clock). Until it is full, the newest error has twice the share of a plain mean: what was
/// learnt first says little.
const MEMORY_S: f64 = 1.0;
const NEWEST: f64 = 2.0;
/// Matched rendering learns longer than anchored, so its past errors say too much: they count for this share less at first, and
/// for what they are once the memory is full.
const LEARNING: f64 = 0.2;
/// What matched rendering has erred by all the time, for half of this to all of it (s), counts at least for this share.
const LASTING_S: f64 = 0.06;
const LASTING: f64 = 0.7;
/// Errors below this are equal (N).
const EQUAL_N: f64 = 1e-12;

/// A softmin, per axis, of the running errors of what the leader itself rendered, judged by the force that a parcel brings one
/// delay later. The follower cannot judge this: it does not know the motion from which the leader makes the force, and matched
/// rendering errs by the stiffness times what that motion is wrong. Holding needs no weight of its own: anchored rendering is
/// holding wherever its correction does not help.
///
/// On another tissue both err at first. Anchored rendering does so for one delay, matched until it has learnt the tissue; but the
/// errors of both are known one delay late, so that both look bad for as long again. An error of matched that does not go
/// away tells it sooner: it is compared at once with what anchored usually errs by.
#[derive(Clone, Debug)]
pub(super) struct Best {
    rate_hz: f64,
    said: DelayLine<Said>,
    judged: f64,
    anchored_n: Lanes,
    matched_n: Lanes,
    lasting: Lasting,
    anchored: Lanes,
}

/// What both modes would have rendered at one tick (N), and how fast time ran then.
#[derive(Clone, Copy, Debug, Default)]
struct Said {
    forces_n: Option<[Lanes; 2]>,
    pace: f64,
}

/// The least error (N) of this block of ticks and the one before.
#[derive(Clone, Copy, Debug, Default)]
struct Lasting {
    ticks: usize,
    least_n: [Lanes; 2],
}

impl Lasting {
    fn step(&mut self, block: usize, error_n: Lanes) -> Lanes {
        if self.ticks.is_multiple_of(block) {
            let [newest_n, _] = self.least_n;
            // Nothing lasts before there is a block to compare with.
            self.least_n = [error_n, if self.ticks > 0 { newest_n } else { Lanes::ZERO }];
        }
        self.ticks += 1;
        let [newest_n, before_n] = &mut self.least_n;
        *newest_n = newest_n.zip(error_n, f64::min);
        newest_n.zip(*before_n, f64::min)
    }
}

impl Best {
    pub(super) fn new(settings: &Settings) -> Self {
        let none = Lanes::ZERO;
        Self {
            rate_hz: settings.rate_hz,
            said: DelayLine::new((MAX_DELAY_S * settings.rate_hz).ceil() as usize, Said::default()),
            judged: 0.0,
            anchored_n: none,
            matched_n: none,
            lasting: Lasting::default(),
            anchored: none,
        }
    }

    /// The weight of anchored rendering, 0 to 1; matched rendering has the rest, and everything until the first judgement.
    pub(super) const fn anchored(&self) -> Lanes {
        self.anchored
    }

    /// Keeps what was rendered in this tick by each mode ([`Mode::index`]).
    pub(super) fn say(&mut self, forces_n: &[Option<Lanes>], pace: f64) {
        let of = |mode: Mode| forces_n[mode.index()];
        self.said.push(Said { forces_n: of(Mode::Anchored).zip(of(Mode::Matched)).map(<[_; 2]>::from), pace });
    }

    /// Judges what was rendered `age` ticks ago by the force of that time, which has just come.
    pub(super) fn hear(&mut self, parcel: &Parcel, age: usize) {
        if !parcel.modes.contains(Mode::Best) {
            self.forget();
            return;
        }
        let Some(&Said { forces_n: Some(said_n), pace }) = self.said.get(age) else { return };
        if !parcel.fresh || parcel.resting {
            return;
        }
        let force_n = Lanes::from(parcel.force_n);
        self.judged += pace;
        let memory = MEMORY_S * self.rate_hz;
        let share = share(NEWEST * pace, self.judged, NEWEST * memory);
        let [anchored_n, matched_n] = said_n.map(|said_n| (force_n - said_n).map(f64::abs));
        for (mean_n, error_n) in [(&mut self.anchored_n, anchored_n), (&mut self.matched_n, matched_n)] {
            *mean_n = (*mean_n + (error_n - *mean_n) * share).settled();
        }
        let block = ((0.5 * LASTING_S * self.rate_hz).round() as usize).max(1);
        let lasting_n = self.lasting.step(block, matched_n) * LASTING;
        let learning = 1.0 - LEARNING * (1.0 - self.judged / memory).max(0.0);
        let floor_n = Lanes::splat(EQUAL_N);
        let matched_n = self.matched_n.zip(lasting_n, f64::max) * learning;
        let odds = eighth_power((matched_n + floor_n) / (self.anchored_n + floor_n));
        self.anchored = odds.map(|odds| 1.0 / (1.0 + odds.recip()));
    }

    /// Forgets what was judged.
    fn forget(&mut self) {
        let none = Lanes::ZERO;
        (self.judged, self.anchored_n, self.matched_n, self.anchored) = (0.0, none, none, none);
        self.lasting = Lasting::default();
    }

    pub(super) fn reset(&mut self) {
        self.said.clear();
        self.forget();
    }
}

/// The softmin's exponent.
pub(super) fn eighth_power(value: Lanes) -> Lanes {
    let square = value * value;
    let fourth = square * square;
    fourth * fourth
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impedance::{ModeSet, SLOTS};

    const DELAY: usize = 100;

    /// A leader that hears of a force of `0` what `errors_n` (anchored, matched) said one delay before.
    struct Bench(Best);

    impl Bench {
        fn new() -> Self {
            Self(Best::new(&Settings::default()))
        }

        /// Goes on for some ticks; the weight of anchored afterwards.
        fn run(&mut self, ticks: usize, errors_n: [f64; 2]) -> f64 {
            let parcel = Parcel { fresh: true, modes: ModeSet::only(Mode::Best), ..Parcel::BLANK };
            for _ in 0..ticks {
                let mut forces_n = [None; SLOTS];
                for (mode, error_n) in [Mode::Anchored, Mode::Matched].into_iter().zip(errors_n) {
                    forces_n[mode.index()] = Some(Lanes::splat(error_n));
                }
                self.0.say(&forces_n, 1.0);
                self.0.hear(&parcel, DELAY);
            }
            self.0.anchored()[0]
        }
    }

    #[test]
    fn an_error_that_does_not_go_away_tells_another_tissue_before_anchored_has_been_right_again() {
        let mut bench = Bench::new();
        assert!(bench.run(5000, [0.1, 0.05]) < 0.01, "on a known tissue matched is the better");
        // Both err by the new tissue: anchored for one delay. Nothing else is known yet when it is right again.
        bench.run(DELAY, [0.6, 0.6]);
        let weight = bench.run(DELAY, [0.1, 0.6]);
        assert!(weight > 0.9, "{weight} when the first errors of the new tissue have all come");
    }

    #[test]
    fn an_error_that_passes_changes_little() {
        let mut bench = Bench::new();
        bench.run(5000, [0.1, 0.05]);
        for _ in 0..20 {
            let weight = bench.run(20, [0.1, 0.3]).max(bench.run(180, [0.1, 0.03]));
            assert!(weight < 0.2, "{weight}");
        }
    }

    #[test]
    fn what_was_learnt_first_says_little_and_everything_ends_in_the_better() {
        let mut bench = Bench::new();
        assert!(bench.run(DELAY, [0.1, 0.5]) <= 0.0, "nothing was judged: matched has all the weight");
        assert!(bench.run(300, [0.1, 0.5]) > 0.9);
        assert!(bench.run(3000, [0.1, 0.05]) < 0.01);
        assert!(bench.run(5000, [0.1, 0.11]) > 0.6);
    }
}
