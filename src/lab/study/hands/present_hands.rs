//! Hands that hold the handle, in tissue whose force arrives late, with the last gate.

use nalgebra::SVector;
use nima_core::{
    noise::Noise,
    safety::{FreeHandle, Governor, GovernorOutput, GovernorReading, Reason},
};
use nima_machine::runtime::VirtualClock;
use serde::Serialize;

use super::{
    hand::{Intention, StudyHand, within},
    kind::HandKind,
    person_parameters::{HANDLE_KG, PersonParameters, SIDEWAYS, between},
};
use crate::pair::RATE_HZ;

/// Nominal period, s, slew limit, N/s, and ceiling of the requested force, N: the defaults of the chain.
pub(super) const PERIOD_S: f64 = 1.0 / RATE_HZ;
pub(super) const SLEW_N_PER_S: f64 = 500.0;
const CEILING_N: f64 = nima_core::limits::USUAL_CEILING_N;
/// A withheld fraction above this starts an alarm, which ends when nothing is withheld.
const ALARM: f64 = 0.02;
/// A force that opposes the requested force by more than this counts as reversed; for weaker requested forces, the
/// withheld part is not evaluated, N.
const JUDGED_N: f64 = 0.05;

/// The last gate, or an alternative to it under test.
pub(super) trait LastGate<const D: usize> {
    fn step(&mut self, t_s: f64, reading: GovernorReading<D>, asked_n: SVector<f64, D>) -> GovernorOutput<D>;
}

impl<const D: usize> LastGate<D> for Governor<D> {
    fn step(&mut self, t_s: f64, reading: GovernorReading<D>, asked_n: SVector<f64, D>) -> GovernorOutput<D> {
        Self::step(self, t_s, Some(reading), asked_n)
    }
}

/// Returns the governor with default settings, for readings of this kind.
pub(super) fn governor<const D: usize>(kind: &HandKind) -> Governor<D> {
    let handle = FreeHandle { mass_kg: HANDLE_KG, damping_n_s_m: 0.5, brake_n_s_m: 30.0, step_m: kind.step_m };
    Governor::new(handle, SLEW_N_PER_S, PERIOD_S)
}

/// Sums and worst values over hands that were present.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct HeldTally {
    /// Number of hands, and total time for which they held the handle, min.
    pub hands: u64,
    /// See above.
    pub minutes: f64,
    /// Number of times that the governor began to withhold more than 2 %.
    pub alarms: u64,
    /// Number of ticks in which the force opposed the requested force by more than 0.05 N.
    pub reversed_ticks: u64,
    /// Maximum force opposed to the requested force, N.
    pub reversed_n: f64,
    /// Largest change in one tick beyond the slew limit, N.
    pub beyond_slew_n: f64,
    /// Integral over time of the requested force, and of its withheld part, N s; above 0.05 N.
    pub asked_n_s: f64,
    /// See above.
    pub withheld_n_s: f64,
    /// Hands with an alarm.
    pub hands_alarmed: u64,
    /// Number of hands that were declared gone.
    pub hands_gone: u64,
}

impl HeldTally {
    /// Adds the results of other hands.
    pub fn add(&mut self, other: &Self) {
        self.hands += other.hands;
        self.minutes += other.minutes;
        self.alarms += other.alarms;
        self.reversed_ticks += other.reversed_ticks;
        self.reversed_n = self.reversed_n.max(other.reversed_n);
        self.beyond_slew_n = self.beyond_slew_n.max(other.beyond_slew_n);
        self.asked_n_s += other.asked_n_s;
        self.withheld_n_s += other.withheld_n_s;
        self.hands_alarmed += other.hands_alarmed;
        self.hands_gone += other.hands_gone;
    }

    /// Returns the alarms in a minute.
    pub fn alarms_per_min(&self) -> f64 {
        self.alarms as f64 / self.minutes.max(1e-9)
    }

    /// Returns the withheld part of the requested force, %.
    pub fn withheld_percent(&self) -> f64 {
        100.0 * self.withheld_n_s / self.asked_n_s.max(1e-9)
    }
}

/// Counters for one hand while it holds the handle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HeldWatch {
    pub(super) tally: HeldTally,
    alarmed: bool,
}

impl HeldWatch {
    /// Processes one tick, with the time since the previous one (s), the previous and the current applied force (N),
    /// and the requested force.
    pub(super) fn tick<const D: usize>(
        &mut self,
        dt_s: f64,
        before_n: &SVector<f64, D>,
        governed: &GovernorOutput<D>,
        asked_n: &SVector<f64, D>,
    ) {
        let tally = &mut self.tally;
        let size_n = asked_n.norm();
        let along_n = if size_n > 0.0 { governed.force_n.dot(asked_n) / size_n } else { -governed.force_n.norm() };
        let beyond_n = (governed.force_n - before_n).norm() - SLEW_N_PER_S * PERIOD_S;
        tally.minutes += dt_s / 60.0;
        tally.reversed_ticks += u64::from(-along_n > JUDGED_N);
        tally.reversed_n = tally.reversed_n.max(-along_n);
        tally.beyond_slew_n = tally.beyond_slew_n.max(beyond_n);
        if size_n > JUDGED_N {
            tally.asked_n_s += size_n * dt_s;
            tally.withheld_n_s += (size_n - along_n).max(0.0) * dt_s;
        }
        self.alarm(governed.withheld, governed.reason);
    }

    pub(super) const fn alarm(&mut self, withheld: f64, reason: Reason) {
        let alarms = withheld > ALARM;
        if alarms && !self.alarmed {
            self.tally.alarms += 1;
        }
        self.alarmed = alarms || self.alarmed && withheld > 0.0;
        self.tally.hands = 1;
        self.tally.hands_alarmed = if self.tally.alarms > 0 { 1 } else { 0 };
        if matches!(reason, Reason::HandGone) {
            self.tally.hands_gone = 1;
        }
    }
}

#[derive(Debug)]
struct HeldSide<const D: usize, G> {
    hand: StudyHand<D>,
    reader: Reader<D>,
    gate: G,
    asked_n: SVector<f64, D>,
    /// Position at which the tissue was entered, m.
    entry_m: Option<SVector<f64, D>>,
    watch: HeldWatch,
}

/// Simulates hands of one kind for this time (s), each with its own gate.
pub(super) fn held<const D: usize, G: LastGate<D>>(
    kind: &HandKind,
    clock: VirtualClock,
    seed: u64,
    seconds: f64,
    gate: impl Fn() -> G,
) -> HeldTally {
    let mut noise = Noise::new(seed);
    let mut sides = sides(kind, &mut noise, gate);
    let mut times = clock.tick_times(RATE_HZ);
    let mut next_s = times.advance().now_s;
    let mut last_s = 0.0;
    loop {
        for side in &mut sides {
            side.hand.step(&mut noise);
            side.reader.step(&side.hand, kind, &mut noise);
        }
        let now_s = sides[0].hand.now_s();
        if now_s + 1e-9 < next_s {
            continue;
        }
        // The depth at which two hands hold the tissue depends on the force of both.
        let depths_m = sides.iter().map(HeldSide::late_depth_m);
        let shared_m = kind.two_hands.then(|| depths_m.sum());
        for side in &mut sides {
            side.tick(kind, now_s, now_s - last_s, shared_m);
        }
        if now_s > seconds {
            break;
        }
        last_s = now_s;
        next_s = times.advance().now_s;
    }
    let mut all = HeldTally::default();
    for side in &sides {
        all.add(&side.watch.tally);
    }
    all
}

fn sides<const D: usize, G: LastGate<D>>(
    kind: &HandKind,
    noise: &mut Noise,
    gate: impl Fn() -> G,
) -> Vec<HeldSide<D, G>> {
    let mut persons: Vec<PersonParameters<D>> =
        (0..kind.hands()).map(|_| PersonParameters::drawn(kind, noise)).collect();
    if let [one, other] = persons.as_mut_slice() {
        // Each hand feels the motion of both, so with half the stiffness the loop is as stable as with one hand.
        let n_m = 0.5 * one.tissue.n_m.min(other.tissue.n_m);
        one.tissue.n_m = n_m;
        other.tissue.n_m = n_m;
        other.tissue.delay_s = one.tissue.delay_s;
    }
    let side = |person: PersonParameters<D>| HeldSide {
        hand: StudyHand::new(person, Intention::Reaches(person.reaches()), kind.gripper),
        reader: Reader::new(),
        gate: gate(),
        asked_n: SVector::zeros(),
        entry_m: None,
        watch: HeldWatch::default(),
    };
    persons.into_iter().map(side).collect()
}

impl<const D: usize, G: LastGate<D>> HeldSide<D, G> {
    /// Returns the depth in the tissue according to the leader's data, m; negative outside.
    fn late_depth_m(&self) -> f64 {
        let tissue = &self.hand.person.tissue;
        tissue.depth_m(&self.hand.before_m(tissue.delay_s))
    }

    fn tick(&mut self, kind: &HandKind, now_s: f64, dt_s: f64, shared_m: Option<f64>) {
        let wanted_n = within(self.pressed_n(shared_m.unwrap_or_else(|| self.late_depth_m())), CEILING_N);
        let change_n = SLEW_N_PER_S * dt_s.min(PERIOD_S);
        self.asked_n += within(wanted_n - self.asked_n, change_n);
        let governed = self.gate.step(now_s, self.reader.reading(now_s, &self.hand, kind), self.asked_n);
        self.watch.tick(dt_s, &self.hand.force_n, &governed, &self.asked_n);
        self.hand.force_n = governed.force_n;
    }

    /// Returns the late force of the tissue at this depth (m), N: an elastic half-space that also holds the tip
    /// sideways.
    fn pressed_n(&mut self, depth_m: f64) -> SVector<f64, D> {
        let tissue = self.hand.person.tissue;
        if depth_m <= 0.0 {
            self.entry_m = None;
            return SVector::zeros();
        }
        let position_m = self.hand.before_m(tissue.delay_s);
        let dragged_m = position_m - *self.entry_m.get_or_insert(position_m);
        let sideways_m = dragged_m - tissue.inwards * tissue.inwards.dot(&dragged_m);
        -(tissue.inwards * depth_m + sideways_m * SIDEWAYS) * tissue.n_m
    }
}

/// Probability of a pause before the device's next reading, and its length, s: a thread of ordinary priority.
const PAUSES: f64 = 0.005;
const PAUSE_S: [f64; 2] = [0.5e-3, 4e-3];

/// The handle as read by its device.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reader<const D: usize> {
    newest: Option<SVector<f64, D>>,
    next_s: f64,
}

impl<const D: usize> Reader<D> {
    pub(super) const fn new() -> Self {
        Self { newest: None, next_s: 0.0 }
    }

    /// Moves to the present; call after each step of the hand.
    pub(super) fn step(&mut self, hand: &StudyHand<D>, kind: &HandKind, noise: &mut Noise) {
        if kind.reads_every_s > 0.0 && hand.now_s() >= self.next_s {
            self.newest = Some(position(hand, kind));
            let pause_s = if noise.uniform() < PAUSES { between(noise, PAUSE_S) } else { 0.0 };
            self.next_s += kind.reads_every_s + pause_s;
        }
    }

    /// Returns the newest position, with the time at which it was read according to the loop.
    pub(super) fn reading(&self, now_s: f64, hand: &StudyHand<D>, kind: &HandKind) -> GovernorReading<D> {
        GovernorReading { t_s: now_s, position_m: self.newest.unwrap_or_else(|| position(hand, kind)) }
    }
}

fn position<const D: usize>(hand: &StudyHand<D>, kind: &HandKind) -> SVector<f64, D> {
    hand.before_m(kind.late_s).map(|x| (x / kind.step_m).floor() * kind.step_m)
}
