//! The better of anchored and matched rendering, by what each was worth lately where the force is felt.

use super::{
    Mode,
    messages::Parcel,
    pace::share,
    settings::{MAX_DELAY_S, Settings},
};
use crate::signal::{DelayLine, Lanes};

/// Memory of the errors (s by the clock).
const MEMORY_S: f64 = 1.0;
/// Errors below this are equal (N).
const EQUAL_N: f64 = 1e-12;

/// A softmin, per axis, of the running errors of what the leader itself rendered, judged by the force that a parcel brings one
/// delay later. The follower cannot judge this: it does not know the motion from which the leader makes the force, and matched
/// rendering errs by the stiffness times what that motion is wrong. Holding needs no weight of its own: anchored rendering is
/// holding wherever its correction does not help.
#[derive(Clone, Debug)]
pub(super) struct Best {
    rate_hz: f64,
    said: DelayLine<Said>,
    judged: f64,
    anchored_n: Lanes,
    matched_n: Lanes,
    anchored: Lanes,
}

/// What both modes would have rendered at one tick (N), and how fast time ran then.
#[derive(Clone, Copy, Debug, Default)]
struct Said {
    forces_n: Option<[Lanes; 2]>,
    pace: f64,
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
        let Some(&Said { forces_n: Some([anchored_n, matched_n]), pace }) = self.said.get(age) else { return };
        if !parcel.fresh || parcel.resting {
            return;
        }
        let force_n = Lanes::from(parcel.force_n);
        self.judged += pace;
        let share = share(pace, self.judged, MEMORY_S * self.rate_hz);
        for (mean_n, said_n) in [(&mut self.anchored_n, anchored_n), (&mut self.matched_n, matched_n)] {
            *mean_n = (*mean_n + ((force_n - said_n).map(f64::abs) - *mean_n) * share).settled();
        }
        let floor_n = Lanes::splat(EQUAL_N);
        // The sixteenth power: where one mode is much better, a share of the other only harms.
        let root = eighth_power((self.matched_n + floor_n) / (self.anchored_n + floor_n));
        self.anchored = root.map(|root| root / (root + root.recip()));
    }

    /// Forgets what was judged.
    fn forget(&mut self) {
        let none = Lanes::ZERO;
        (self.judged, self.anchored_n, self.matched_n, self.anchored) = (0.0, none, none, none);
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
