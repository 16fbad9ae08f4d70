//! Matched rendering: parameters cross the link, and the force is computed from the hand's own motion, so a late force
//! cannot push the hand.
//!
//! The follower fits the force at its tip, `f = theta phi(motion)`, on normal equations whose memory runs on a clock
//! that motion drives; two ridges and nested sets of columns are its experts. The force that each expert would have
//! predicted one delay ago is compared with the force measured now. The weights are a softmin of that running error.
//! The follower sends the weighted sum of the parameters, with the range of past forces and a small offset. The leader
//! inserts its own motion, which may be the follower's motion as estimated there (accurate) or the handle's (passive at
//! any delay, with a little damping).
//!
//! Positions count from a fixed origin, there is a constant, and the ridge is in proportion to each column's mean
//! square. With the paper's recipe (increments, raw columns, no constant, no ridge, degree by the error inside the
//! window) the force at the prediction horizon reaches 1e6 N; the paper's own columns under these rules
//! ([`ModelForm::Paper`]) are better than reflection.
//!
//! The constants were chosen on eight recordings of the first rig and on simulated palpation.

mod drift;
mod form;
mod methods;
mod model;
mod slip;
mod sums;
#[cfg(test)]
mod tests;

pub(super) use form::COLUMNS;
pub use form::ModelForm;
pub(super) use methods::{MatchedMethod, Nima};
pub use model::MatchedModel;

use self::{
    drift::ResidualDrift,
    form::{FormRow, product},
    slip::{FollowerSlip, SlipLanes},
    sums::MatchedSums,
};
use super::{
    Mode,
    change::ChangeDetector,
    envelope::Envelope,
    messages::{IdentificationReport, LinkPacket, Posture},
    method::{FollowerEnd, MethodInput},
    mixture::eighth_power,
    motion_clock::newest_fraction,
    settings::{ImpedanceSettings, MAX_DELAY_S, ModeSet},
};
use crate::signal::{DelayLine, Lanes};

/// Memories of the fit (s of the motion clock). The longer one, for friction across the contact, includes the tissue of
/// earlier touches. The paper's form uses its window instead.
const MEMORIES_S: [f64; 2] = [1.0, 10.0];
/// Ridges, in seconds of typical motion without force, each with its memory. The last is for forms with slip columns.
const RIDGES: [Ridge; 3] =
    [Ridge { s: 0.0001, memory: 0 }, Ridge { s: 0.01, memory: 0 }, Ridge { s: 0.0001, memory: 1 }];
/// Number of solutions per second for every expert (at most one per tick); the paper's form, whose memory is short,
/// uses the second value.
const SOLVE_HZ: [f64; 2] = [150.0, 200.0];
/// Number of renewals of the other experts per renewal of an expert with the long memory: its parameters change more
/// slowly, so it needs less processor time.
const LONG_RENEWALS: usize = 2;
/// Memory of the experts' errors (s by the clock; the softmin's exponent is eight), and the error below which experts
/// count as equal (N).
const ERROR_S: f64 = 1.0;
const EQUAL_N: f64 = 1e-12;

/// Follower part of both methods.
#[derive(Clone, Debug)]
struct Learner {
    form: ModelForm,
    rate_hz: f64,
    delay_ticks: usize,
    renewals: RenewalSchedule,
    one: Lanes,
    sums: Vec<MatchedSums>,
    experts: Vec<Expert>,
    envelope: Envelope,
    drift: ResidualDrift,
    /// Origin of the positions: the first one.
    origin: Option<Lanes>,
    /// The newest columns, with springs loaded by the measured force.
    row: FormRow,
    slip: FollowerSlip,
    /// Number of evaluated ticks, by the clock.
    judged: f64,
    model: MatchedModel,
    /// `None` for the paper's form, and in the replay of a session that was recorded without it.
    change: Option<ChangeDetector>,
}

/// Spreads the renewals of the experts over the ticks: one ridge after another.
#[derive(Clone, Copy, Debug)]
struct RenewalSchedule {
    /// Number of ticks from one renewal of an expert to its next.
    every: usize,
    tick: usize,
    ridges: usize,
}

impl RenewalSchedule {
    fn phase(&self, ridge: usize) -> usize {
        ridge * self.every / self.ridges
    }

    /// Returns whether this is the tick of this ridge.
    fn is_turn_of(&self, ridge: usize) -> bool {
        self.tick % self.every == self.phase(ridge)
    }

    /// Returns how many renewals ago the parameters that were active `ticks` ago were found.
    fn since(&self, ridge: usize, ticks: usize) -> usize {
        let ahead = self.every - self.phase(ridge);
        (self.tick + ahead) / self.every - (self.tick.saturating_sub(ticks) + ahead) / self.every
    }
}

#[derive(Debug)]
struct Ridge {
    s: f64,
    memory: usize,
}

/// Returns the ridges of a form.
fn ridges_of(form: ModelForm) -> &'static [Ridge] {
    if form.slips() { &RIDGES } else { &RIDGES[..2] }
}

#[derive(Clone, Debug)]
struct Expert {
    ridge: usize,
    columns: usize,
    parameters: FormRow,
    past: DelayLine<FormRow>,
    error_n: Lanes,
    weight: Lanes,
}

impl Learner {
    fn new(form: ModelForm, settings: &ImpedanceSettings, delay_ticks: usize) -> Self {
        let rate_hz = settings.rate_hz;
        let solve_hz = SOLVE_HZ[usize::from(matches!(form, ModelForm::Paper(_)))];
        // At least one tick: a slow loop solves in every tick.
        let every = ((rate_hz / solve_hz).round() as usize).max(1);
        let max_delay = (MAX_DELAY_S * rate_hz).ceil() as usize;
        let memories_s = match form {
            ModelForm::Paper(_) => &[settings.window_s][..],
            ModelForm::Sliding | ModelForm::Coupled => &MEMORIES_S,
            ModelForm::Tissue => &MEMORIES_S[..1],
        };
        let sums = memories_s
            .iter()
            // One sample per renewal for the long memory (see `learn`), hence its lower rate.
            .zip([1, every])
            .map(|(memory_s, step)| MatchedSums::new(form.columns(), *memory_s, rate_hz / step as f64))
            .collect();
        let expert = |ridge, columns| Expert {
            ridge,
            columns,
            parameters: [Lanes::ZERO; COLUMNS],
            past: DelayLine::new(max_delay / every + 1, [Lanes::ZERO; COLUMNS]),
            error_n: Lanes::ZERO,
            weight: Lanes::ZERO,
        };
        let experts = ridges_of(form).iter().enumerate().flat_map(|(ridge, Ridge { memory, .. })| {
            // Memory of earlier touches helps only if the columns can distinguish contact from free motion, which
            // requires all of them.
            let min = if *memory == 0 { 0 } else { form.columns() };
            form.nested().iter().filter(move |columns| **columns >= min).map(move |&columns| expert(ridge, columns))
        });
        let mut matched = Self {
            form,
            rate_hz,
            delay_ticks,
            renewals: RenewalSchedule { every, tick: 0, ridges: ridges_of(form).len() },
            one: super::messages::active(&nalgebra::Vector3::repeat(1.0), settings.axes),
            sums,
            experts: experts.collect(),
            envelope: Envelope::new(rate_hz),
            drift: ResidualDrift::new(rate_hz, max_delay),
            origin: None,
            row: [Lanes::ZERO; COLUMNS],
            slip: FollowerSlip::default(),
            judged: 0.0,
            model: MatchedModel::NONE,
            change: (!settings.earlier_forces && !matches!(form, ModelForm::Paper(_)))
                .then(|| ChangeDetector::new(rate_hz)),
        };
        matched.reset();
        matched
    }

    /// Returns whether this is the mode nima, with the paper's columns.
    fn is_paper(&self) -> bool {
        matches!(self.form, ModelForm::Paper(_))
    }

    /// Returns the age in ticks of the packet that the leader has now; without a delay, the last packet is used.
    fn horizon(&self) -> usize {
        self.delay_ticks.max(1)
    }

    /// Adds the follower's newest motion and force (N), `None` if either was not measured; `sent`: the model of
    /// [`horizon`](Self::horizon) ticks ago. Returns the model to send.
    fn step(&mut self, posture: &Posture, force_n: Option<Lanes>, sent: Option<&MatchedModel>) -> &MatchedModel {
        // Learn, then solve, then predict: the leader's part below uses only what was sent before.
        if let Some(force_n) = force_n {
            self.learn(posture, force_n);
        }
        self.solve();
        let sent = self.leader(posture, sent);
        if let Some(force_n) = force_n {
            if let Some((sent, said)) = sent {
                self.judge(posture, force_n, sent, &said);
            }
            self.mix(force_n);
        } else {
            self.drift.hold();
        }
        self.renewals.tick += 1;
        &self.model
    }

    /// Returns the leader's result for this motion: the model that it has at that time, its columns and its force
    /// before the limits (N).
    fn leader<'a>(
        &mut self,
        posture: &Posture,
        sent: Option<&'a MatchedModel>,
    ) -> Option<(&'a MatchedModel, (FormRow, Lanes))> {
        let sent = sent.filter(|sent| sent.degree > 0)?;
        Some((sent, self.slip.twin.step(sent, posture)))
    }

    /// Continues without learning: the learnt parameters stay active.
    fn rest(&mut self, posture: &Posture, sent: Option<&MatchedModel>) {
        self.leader(posture, sent);
        // Store one entry per renewal even at rest, so that each index corresponds to a time.
        for ridge in (0..self.renewals.ridges).filter(|ridge| self.renewals.is_turn_of(*ridge)) {
            for expert in self.experts.iter_mut().filter(|expert| expert.ridge == ridge) {
                expert.past.push(expert.parameters);
            }
        }
        self.drift.hold();
        self.renewals.tick += 1;
    }

    fn learn(&mut self, posture: &Posture, force_n: Lanes) {
        let origin = *self.origin.get_or_insert_with(|| self.form.position(posture));
        let pace = posture.stance.pace;
        let held =
            if self.form.slips() { *self.slip.step(posture, force_n, self.rate_hz) } else { SlipLanes::default() };
        let row = self.form.row(posture, self.one, origin, &held);
        // A long memory loses nothing by adding only one sample per renewal.
        // The short memory is the first one.
        let memories = if self.renewals.is_turn_of(0) { self.sums.len() } else { 1 };
        for (memory, sums) in self.sums.iter_mut().enumerate().take(memories) {
            let full = self.experts.iter().rfind(|expert| ridges_of(self.form)[expert.ridge].memory == memory);
            // The largest model of this memory weighs the samples: its error is the least biased.
            let error_n = full.map_or(force_n, |full| force_n - product(&full.parameters, &row, full.columns));
            sums.learn(&row, force_n, error_n, pace);
        }
        self.row = row;
        self.envelope.see(force_n, pace);
    }

    /// Computes one factorisation per ridge, spread over the ticks between two renewals.
    fn solve(&mut self) {
        let RenewalSchedule { tick, every, .. } = self.renewals;
        for (ridge, Ridge { s, memory }) in ridges_of(self.form).iter().enumerate() {
            // On the first tick solve all of them, because an expert without a prediction cannot be evaluated.
            if !self.renewals.is_turn_of(ridge) && tick > 0 {
                continue;
            }
            let sums = &mut self.sums[*memory];
            // A long memory changes slowly, so it is renewed less often.
            let renew = *memory == 0 || (tick / every).is_multiple_of(LONG_RENEWALS);
            if renew {
                sums.factorise(*s);
            }
            for expert in self.experts.iter_mut().filter(|expert| expert.ridge == ridge) {
                // Non-finite results are neither kept nor sent.
                if renew && let Some(found) = sums.parameters(expert.columns) {
                    expert.parameters = found;
                }
                expert.past.push(expert.parameters);
            }
        }
    }

    fn judge(&mut self, posture: &Posture, force_n: Lanes, sent: &MatchedModel, (row, said_n): &(FormRow, Lanes)) {
        let pace = posture.stance.pace;
        self.judged += pace;
        let fraction = newest_fraction(pace, self.judged, ERROR_S * self.rate_hz);
        let mut min_n = Lanes::splat(f64::INFINITY);
        let horizon = self.horizon();
        let mut ages = [0; RIDGES.len()];
        for (ridge, age) in ages.iter_mut().enumerate().take(self.renewals.ridges) {
            *age = self.renewals.since(ridge, horizon);
        }
        for expert in &mut self.experts {
            let age = ages[expert.ridge];
            let Some(parameters) = expert.past.get(age) else { continue };
            // Clipped like the leader's force: the error of an expert is the error that the hand would feel.
            let said_n = sent.clipped(product(parameters, row, expert.columns));
            expert.error_n =
                (expert.error_n + ((force_n - said_n).map(f64::abs) - expert.error_n) * fraction).settled();
            min_n = min_n.zip(expert.error_n, f64::min);
        }
        let mut sum = Lanes::ZERO;
        for expert in &mut self.experts {
            expert.weight = eighth_power((min_n + Lanes::splat(EQUAL_N)) / (expert.error_n + Lanes::splat(EQUAL_N)));
            sum += expert.weight;
        }
        // Only the ratio of the errors counts, so that the weights are the same in every unit.
        let scale = sum.recip_or_zero();
        self.experts.iter_mut().for_each(|expert| expert.weight *= scale);
        let error_n = force_n - sent.clipped(*said_n);
        self.drift.judge(self.horizon(), error_n, sent.offset_n);
        if self.change.as_mut().is_some_and(|change| change.step(force_n, error_n.map(f64::abs), pace, horizon)) {
            // The samples of the previous tissue would spoil the fit for as long as the memory lasts.
            self.sums.iter_mut().for_each(MatchedSums::reset);
        }
    }

    /// Mixes the experts by their weights and adds the other data that the leader needs.
    /// All experts are prefixes of the same columns, so their parameters can be added.
    fn mix(&mut self, force_n: Lanes) {
        let mut parameters = [Lanes::ZERO; COLUMNS];
        let mut heaviest = (f64::NEG_INFINITY, 0);
        for expert in &self.experts {
            for (sum, parameter) in parameters.iter_mut().zip(&expert.parameters).take(expert.columns) {
                *sum += *parameter * expert.weight;
            }
            // Unused axes have weight zero through `one`.
            let [x, y, z, _] = (expert.weight * self.one).0;
            if x + y + z > heaviest.0 {
                heaviest = (x + y + z, expert.columns);
            }
        }
        self.model = MatchedModel {
            form: self.form,
            degree: self.form.degree(heaviest.1),
            one: self.one,
            parameters,
            origin: self.origin.unwrap_or(Lanes::ZERO),
            gives: self.slip.gives,
            bounds_n: self.envelope.bounds_n(),
            offset_n: Lanes::ZERO,
        };
        // The offset corrects what the mixed model leaves of this tick's force.
        let said_n = self.model.clipped(product(&parameters, &self.row, self.form.columns()));
        self.model.offset_n = self.drift.step(force_n - said_n, force_n);
    }
}

impl FollowerEnd for Learner {
    fn serves(&self, modes: ModeSet) -> bool {
        modes.contains(if self.is_paper() { Mode::Nima } else { Mode::Matched })
    }

    fn take(&mut self, seen: &MethodInput<'_>, parcel: &mut LinkPacket, report: &mut IdentificationReport) {
        let is_paper = self.is_paper();
        let sent = seen.sent.map(|sent| if is_paper { &sent.models.nima } else { &sent.models.matched });
        if !seen.learn {
            return self.rest(seen.posture, sent);
        }
        // The paper's columns need settled derivatives, the low-passes of the other forms do not.
        let measured = if is_paper { seen.usable } else { seen.good };
        let model = *self.step(seen.posture, measured.then_some(seen.force_n), sent);
        if is_paper {
            report.degrees.nima = model.degree;
            parcel.models.nima = model;
        } else {
            report.degrees.matched = model.degree;
            parcel.models.matched = model;
        }
    }

    fn set_delay(&mut self, delay_ticks: usize) {
        self.delay_ticks = delay_ticks;
        // The usual error depends on the delay.
        self.change = self.change.map(|_| ChangeDetector::new(self.rate_hz));
    }

    fn reset(&mut self) {
        self.renewals.tick = 0;
        self.sums.iter_mut().for_each(MatchedSums::reset);
        // Equal weights: before the first error no expert is known to be better.
        let weight = self.one * (1.0 / self.experts.len() as f64);
        for expert in &mut self.experts {
            expert.parameters = [Lanes::ZERO; COLUMNS];
            expert.error_n = Lanes::ZERO;
            expert.weight = weight;
            expert.past.clear();
        }
        self.envelope.reset();
        self.drift.reset();
        self.origin = None;
        self.judged = 0.0;
        self.slip = FollowerSlip::default();
        self.change = self.change.map(|_| ChangeDetector::new(self.rate_hz));
        self.model = MatchedModel::NONE;
    }
}
