//! Model-mediated teleoperation: a Hunt-Crossley contact is identified at the follower, its parameters cross the link,
//! and the leader renders the contact from its own motion (Mitra and Niemeyer, "Model-mediated telemanipulation", Int.
//! J. Robotics Research 27, 2008).
//!
//! `f = K d^n + B d^n v` at a depth `d` beyond the surface; `K` and `B` by recursive least squares with exponential
//! forgetting, the first stage of Diolaiti, Melchiorri and Stramigioli ("Contact impedance estimation for robotic
//! systems", IEEE Trans. Robotics 21, 2005).
//!
//! In the publications the surface is known and the sensors measure only the contact. Here the best of a few surfaces
//! and exponents is used (their second stage, a logarithmic regression for the exponent, was tried and was worse), with
//! a contact on each side of the surface (an instrument between two walls); an offset, damping and mass of the
//! instrument are fitted too; and the force stays within the range of past forces, as in our own modes.

use nima_core::{
    impedance::{Baseline, BaselineModel, Envelope, HuntCrossleyContact},
    signal::{Lanes, Motion},
};

use crate::{
    BaselineSender, kept,
    rls::{Rls, dot},
};

/// Memory (s) and ridge (s) of the regression, and memory of the errors (s) (chosen on recordings, see docs/modes.md).
const MEMORY_S: f64 = 1.0;
const RIDGE_S: f64 = 0.01;
const ERROR_S: f64 = 1.0;
/// Solves per second (at most one a tick), because the parameters hardly change within 5 ms.
const SOLVE_HZ: f64 = 200.0;
/// Number of candidate surfaces, evenly spaced over the visited range. Each has its own regression, so more of them
/// would cost more time in every tick.
const PLACES: usize = 5;
/// Exponents that are compared: a linear contact, a sphere, a cone. Hertz's equations give 1.5 for a sphere and
/// Sneddon's 2 for a cone; 1 is a layer of constant stiffness.
const EXPONENTS: [f64; 3] = [1.0, 1.5, 2.0];
const CANDIDATES: usize = PLACES * EXPONENTS.len();
/// The range is enlarged by this fraction at a time, so that the sums are rarely converted to another range.
const ROOM: f64 = 0.05;

/// Stiffness and damping on both sides, then an offset, and the instrument's own damping and mass.
const COLUMNS: usize = 7;
const SIDES: usize = 4;

const NONE: HuntCrossleyContact = HuntCrossleyContact {
    surface_m: Lanes::ZERO,
    reach_m: Lanes::ZERO,
    exponent: Lanes::ZERO,
    parameters: [Lanes::ZERO; COLUMNS],
    bounds_n: [Lanes::ZERO; 2],
};

/// Returns the force (N) of a contact for a motion.
pub(crate) fn force(contact: &HuntCrossleyContact, own: &Motion) -> Lanes {
    let force_n = dot(&contact.parameters, &columns(contact, own));
    let [low, high] = contact.bounds_n;
    // Clamping would turn NaN into one of the limits.
    if force_n.is_finite() { force_n.within(low, high) } else { force_n }
}

fn columns(contact: &HuntCrossleyContact, motion: &Motion) -> [Lanes; COLUMNS] {
    // Signed depth in units of the reach.
    let depth = (motion.x - contact.surface_m) * contact.reach_m.recip_or_zero();
    let power = |side: f64| (depth * side).zip(contact.exponent, |depth, n| power(depth.max(0.0), n));
    let above = power(1.0);
    let below = power(-1.0);
    [above, above * motion.v, below, below * motion.v, Lanes([1.0, 1.0, 1.0, 0.0]), motion.v, motion.a]
}

/// Takes over another contact on one axis; the reach is the same.
fn take(contact: &mut HuntCrossleyContact, lane: usize, better: &HuntCrossleyContact) {
    contact.surface_m[lane] = better.surface_m[lane];
    contact.exponent[lane] = better.exponent[lane];
    for (parameter, better) in contact.parameters.iter_mut().zip(&better.parameters) {
        parameter[lane] = better[lane];
    }
}

fn power(depth: f64, exponent: f64) -> f64 {
    if exponent > 1.75 {
        depth * depth
    } else if exponent > 1.25 {
        depth * depth.sqrt()
    } else {
        depth
    }
}

/// A surface and an exponent, with the contact identified for them.
#[derive(Clone, Debug)]
struct ModelCandidate {
    contact: HuntCrossleyContact,
    rls: Rls<COLUMNS>,
    error_n: Lanes,
}

#[derive(Clone, Debug)]
pub(crate) struct ModelMediated {
    errors_kept: f64,
    every: usize,
    tick: usize,
    candidates: [ModelCandidate; CANDIDATES],
    range_m: [Lanes; 2],
    envelope: Envelope,
    contact: HuntCrossleyContact,
}

impl ModelMediated {
    /// Enlarges the range to include the follower's position, and adjusts the surfaces to it.
    fn visit(&mut self, motion: &Motion) {
        if self.tick == 0 {
            self.range_m = [motion.x; 2];
        }
        let [low, high] = self.range_m;
        let room = (high - low) * ROOM;
        let lower = motion.x.zip(low, f64::min);
        let higher = motion.x.zip(high, f64::max);
        if self.tick > 0 && [lower, higher] == [low, high] {
            return;
        }
        let beyond = |edge: Lanes, before: Lanes, sign: f64| {
            let moved = edge.zip(before, |edge, before| if edge.to_bits() == before.to_bits() { 0.0 } else { sign });
            edge + moved * room
        };
        self.range_m = [beyond(lower, low, -1.0), beyond(higher, high, 1.0)];
        let [low, high] = self.range_m;
        for (i, candidate) in self.candidates.iter_mut().enumerate() {
            let fraction = (i % PLACES) as f64 / (PLACES - 1) as f64;
            candidate.move_to(low + (high - low) * fraction, high - low);
        }
    }

    /// Returns the contact that fits best on each axis.
    fn best(&self) -> HuntCrossleyContact {
        let [first, others @ ..] = &self.candidates;
        let mut best = first.contact;
        let mut min_n = first.error_n;
        for candidate in others {
            for lane in 0..3 {
                if candidate.error_n[lane] < min_n[lane] {
                    min_n[lane] = candidate.error_n[lane];
                    take(&mut best, lane, &candidate.contact);
                }
            }
        }
        HuntCrossleyContact { bounds_n: self.envelope.bounds_n(), ..best }
    }
}

impl BaselineSender for ModelMediated {
    const BASELINE: Baseline = Baseline::ModelMediated;

    fn new(rate_hz: f64, _delay_ticks: usize) -> Self {
        let rls = Rls::new(MEMORY_S, RIDGE_S, rate_hz);
        let mut model_mediated = Self {
            errors_kept: kept(ERROR_S, rate_hz),
            every: ((rate_hz / SOLVE_HZ).round() as usize).max(1),
            tick: 0,
            candidates: std::array::from_fn(|_| ModelCandidate {
                contact: NONE,
                rls: rls.clone(),
                error_n: Lanes::ZERO,
            }),
            range_m: [Lanes::ZERO; 2],
            envelope: Envelope::new(rate_hz),
            contact: NONE,
        };
        model_mediated.reset();
        model_mediated
    }

    fn step(&mut self, motion: &Motion, force_n: Option<Lanes>) -> BaselineModel {
        let Some(force_n) = force_n else { return BaselineModel::Contact(self.contact) };
        self.envelope.see(force_n, 1.0);
        self.visit(motion);
        for (i, candidate) in self.candidates.iter_mut().enumerate() {
            candidate.learn(motion, force_n, self.errors_kept);
            // Solve the candidates in turn, but all of them on the first tick.
            if self.tick == 0 || self.tick % self.every == i % self.every {
                candidate.solve();
            }
        }
        self.contact = self.best();
        self.tick = self.tick.wrapping_add(1);
        BaselineModel::Contact(self.contact)
    }

    fn reset(&mut self) {
        for (i, candidate) in self.candidates.iter_mut().enumerate() {
            let exponent = Lanes::splat(EXPONENTS[i / PLACES]);
            candidate.contact = HuntCrossleyContact { exponent, ..NONE };
            candidate.error_n = Lanes::ZERO;
            candidate.rls.reset();
        }
        self.envelope.reset();
        self.tick = 0;
        self.contact = NONE;
    }
}

impl ModelCandidate {
    fn learn(&mut self, motion: &Motion, force_n: Lanes, kept: f64) {
        let columns = columns(&self.contact, motion);
        let error_n = (force_n - dot(&self.contact.parameters, &columns)).map(f64::abs);
        self.error_n = (error_n + (self.error_n - error_n) * kept).settled();
        self.rls.learn(&columns, force_n);
    }

    fn solve(&mut self) {
        let found = self.rls.solve(&[Lanes::ZERO; COLUMNS]);
        if found.iter().all(|parameter| parameter.is_finite()) {
            self.contact.parameters = found;
        }
    }

    /// Switches to another surface and reach. The sums are converted to the new reach, because a depth in reaches
    /// becomes smaller; the shift of the surface is forgotten with time.
    fn move_to(&mut self, surface_m: Lanes, reach_m: Lanes) {
        let ratio = (self.contact.reach_m * reach_m.recip_or_zero()).zip(self.contact.exponent, power);
        let one = Lanes::splat(1.0);
        self.rls.rescale(&[ratio, ratio, ratio, ratio, one, one, one]);
        for parameter in &mut self.contact.parameters[..SIDES] {
            *parameter *= ratio.map(|ratio| if ratio > 1e-12 { 1.0 / ratio } else { 0.0 });
        }
        self.contact.surface_m = surface_m;
        self.contact.reach_m = reach_m;
    }
}
