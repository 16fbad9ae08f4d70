//! Is there a hand? A handle that flies off under the force it is given is held by nobody: the force goes at once.
//!
//! A hand that grips is in balance with a steady force; a handle alone takes it up with `a = f / m`, an acceleration that is known
//! beforehand. So: over the last 8 ms the force was steady, and the handle accelerated along it as it would
//! alone. That is told 7 to 9 ms after the hand opened, when a handle of 0.25 kg under 4 N has gone half a millimetre. Once closed, the gate stays so
//! until a reset (engaging anew): nothing resumes by itself. The loop takes it as a hand that is absent, and rests with the handle braked.
//! Weak forces (below 2 N) and slow accelerations are let pass: they kick nobody, and noise looks like them.

use nalgebra::SVector;

use super::Reason;

/// Half the time that is looked at, s.
const LAG_S: f64 = 0.004;
/// The same in ticks at most (10 kHz) and at least: a slower loop cannot tell in time.
const LAG_MAX: usize = 40;
const LAG_MIN: usize = 3;
/// Weakest force that is judged, N.
const FORCE_N: f64 = 2.0;
/// A force is steady if all of the time this share of its mean was there.
const STEADY: f64 = 0.75;
/// Shares of the lone handle's acceleration between which it tells: its mass is known roughly, and more is a hand's doing.
const ALONE: [f64; 2] = [0.7, 1.5];
/// For how long it must tell, s.
const SURE_S: f64 = 0.002;
/// Least acceleration that tells, m/s^2: steps of an encoder of 10 um look like 1 m/s^2, a lively hand makes up to 5.
const ACCELERATION_M_S2: f64 = 6.0;

const ROOM: usize = 2 * LAG_MAX + 1;

/// The last places of the handle and the forces on it.
#[derive(Clone, Copy, Debug)]
pub struct Release<const D: usize> {
    handle_kg: f64,
    period_s: f64,
    lag: usize,
    hand_m: [SVector<f64, D>; ROOM],
    held_n: [SVector<f64, D>; ROOM],
    newest: usize,
    filled: usize,
    /// For how long the handle has looked alone, s.
    alone_s: f64,
    /// There is no hand.
    gone: bool,
}

impl<const D: usize> Release<D> {
    /// For a handle of this apparent mass (kg; 0: not known, the gate stays open) and a loop of this period (s).
    pub fn new(handle_kg: f64, period_s: f64) -> Self {
        let lag = ((LAG_S / period_s).round() as usize).min(LAG_MAX);
        let zeros = [SVector::zeros(); ROOM];
        Self { handle_kg, period_s, lag, hand_m: zeros, held_n: zeros, newest: 0, filled: 0, alone_s: 0.0, gone: false }
    }

    /// The handle is here now (m), and this force (N) was held since the last call: may force pass?
    pub fn step(&mut self, hand_m: Option<SVector<f64, D>>, held_n: &SVector<f64, D>) -> Reason {
        if self.handle_kg <= 0.0 || self.lag < LAG_MIN {
            return Reason::Open;
        }
        match hand_m.filter(|at_m| at_m.iter().all(|x| x.abs() < 1e3)) {
            Some(hand_m) => self.keep(hand_m, *held_n),
            None => self.filled = 0,
        }
        self.alone_s = if self.is_alone() { self.alone_s + self.period_s } else { 0.0 };
        self.gone |= self.alone_s > SURE_S;
        if self.gone { Reason::HandGone } else { Reason::Open }
    }

    /// Starts anew: the hand is taken to be there.
    pub const fn reset(&mut self) {
        self.gone = false;
        self.alone_s = 0.0;
        self.filled = 0;
    }

    fn keep(&mut self, hand_m: SVector<f64, D>, held_n: SVector<f64, D>) {
        self.newest = (self.newest + 1) % ROOM;
        self.hand_m[self.newest] = hand_m;
        self.held_n[self.newest] = held_n;
        self.filled = (self.filled + 1).min(ROOM);
    }

    const fn back(&self, ticks: usize) -> usize {
        (self.newest + ROOM - ticks) % ROOM
    }

    fn is_alone(&self) -> bool {
        let ticks = 2 * self.lag;
        if self.filled <= ticks {
            return false;
        }
        let forces = || (0..ticks).map(|tick| &self.held_n[self.back(tick)]);
        let mean_n = forces().sum::<SVector<f64, D>>() / ticks as f64;
        let size_n = mean_n.norm();
        if size_n < FORCE_N {
            return false;
        }
        let along = mean_n / size_n;
        let [now_m, then_m, before_m] = [0, self.lag, ticks].map(|tick| self.hand_m[self.back(tick)]);
        let lag_s = self.lag as f64 * self.period_s;
        let acceleration_m_s2 = (now_m - then_m * 2.0 + before_m).dot(&along) / (lag_s * lag_s);
        let share = acceleration_m_s2 * self.handle_kg / size_n;
        acceleration_m_s2 > ACCELERATION_M_S2
            && (ALONE[0]..ALONE[1]).contains(&share)
            && forces().all(|force_n| force_n.dot(&along) >= STEADY * size_n)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    type One = SVector<f64, 1>;

    /// A handle under `force_n`, read in steps of 10 um, in a grip that opens at 0.5 s: when the gate closes after that, s, and how far it
    /// had gone, m; `None` if never. `Err`: it closed before.
    fn let_go(period_s: f64, force_n: f64) -> Result<Option<(f64, f64)>, f64> {
        let mut gate = Release::<1>::new(0.25, period_s);
        let (mut x, mut v, steps) = (force_n / 900.0, 0.0, (0.8 / period_s) as u32);
        for i in 0..steps {
            let t = f64::from(i) * period_s;
            let tremor_m = 8e-5 * (std::f64::consts::TAU * 9.7 * t).sin();
            let hand_n = if t < 0.5 { 900.0 * (tremor_m - x) - 18.0 * v } else { -0.5 * v };
            v += (hand_n + force_n) * period_s / if t < 0.5 { 0.35 } else { 0.25 };
            x += v * period_s;
            let read = One::new((x / 1e-5).round() * 1e-5);
            if gate.step(Some(read), &One::new(force_n)) != Reason::Open {
                return if t < 0.5 { Err(t) } else { Ok(Some((t - 0.5, x - force_n / 900.0))) };
            }
        }
        Ok(None)
    }

    #[test]
    fn an_opened_hand_is_told_within_11_ms_and_a_millimetre() {
        for (period_s, force_n) in [(1e-3, 4.0), (1e-3, -2.0), (1e-3, 2.5), (1e-4, 4.0), (5e-4, 3.0)] {
            let (after_s, way_m) = let_go(period_s, force_n).unwrap().unwrap();
            assert!(after_s < 0.011 && way_m.abs() < 1e-3, "{period_s} s, {force_n} N: {after_s} s, {way_m} m");
        }
        assert_eq!(let_go(1e-3, 1.4), Ok(None), "too weak to kick");
    }

    #[test]
    fn it_stays_closed_until_it_is_reset() {
        let mut gate = Release::<1>::new(0.25, 1e-3);
        let closed = |gate: &mut Release<1>, i: u32| {
            let x = 8.0 * (f64::from(i) * 1e-3).powi(2);
            gate.step(Some(One::new(x)), &One::new(4.0)) == Reason::HandGone
        };
        let still = |gate: &mut Release<1>| gate.step(Some(One::new(0.0)), &One::zeros()) == Reason::HandGone;
        assert!((0..20).any(|i| closed(&mut gate, i)));
        assert!((0..1000).all(|_| still(&mut gate)), "nothing resumes by itself");
        gate.reset();
        assert!(!still(&mut gate));
        assert!((0..20).any(|i| closed(&mut gate, i)));
    }

    proptest! {
        #[test]
        fn a_gripping_hand_is_never_taken_for_none(
            force_n in -4.0..4.0f64, hz in 0.2..2.0f64, amplitude_m in 0.0..0.02f64, tremor_m in 0.0..1.5e-4f64,
        ) {
            let mut gate = Release::<1>::new(0.25, 1e-3);
            for i in 0..1000 {
                let turns = std::f64::consts::TAU * f64::from(i) * 1e-3;
                let x = amplitude_m * (hz * turns).sin() + tremor_m * (9.7 * turns).sin();
                let read = One::new((x / 1e-5).round() * 1e-5);
                prop_assert_eq!(gate.step(Some(read), &One::new(force_n)), Reason::Open);
            }
        }

        #[test]
        fn no_reading_makes_it_panic(
            ticks in prop::collection::vec((prop::num::f64::ANY, prop::num::f64::ANY), 1..100),
        ) {
            let mut gate = Release::<1>::new(0.25, 1e-3);
            for (at_m, held_n) in ticks {
                gate.step(Some(One::new(at_m)), &One::new(held_n));
            }
        }
    }
}
