//! Hands that release the handle: at once, or as the fingers open.

use nalgebra::SVector;
use nima_core::{noise::Noise, safety::Reason};
use nima_machine::runtime::{ClockProfile, VirtualClock};
use serde::Serialize;

use super::{
    hand::{Intention, StudyHand},
    kind::HandKind,
    person_parameters::{PersonParameters, between, direction},
    present_hands::{LastGate, Reader, governor},
};
use crate::{clocks, pair::RATE_HZ};

/// Forces that are released, N.
pub const FORCES_N: [f64; 7] = [0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0];
/// Times in which the fingers open, ms.
pub const OPENINGS_MS: [f64; 4] = [0.0, 10.0, 20.0, 40.0];
/// Opening times of the fingers for kinds other than the usual one, ms.
pub(super) const OPENINGS_OF_OTHERS_MS: [f64; 2] = [0.0, 20.0];
/// Time in which the force rises, time of the release, and observation time after it, s.
const RISE_S: f64 = 0.1;
const RELEASE_S: [f64; 2] = [0.3, 0.4];
const WATCHED_S: f64 = 0.3;
/// Maximum speed of the hand during the release, m/s; half of the hands are at rest.
const DRIFT_M_S: f64 = 0.03;
/// If this fraction is withheld before a release although the hand holds the handle, the release is not evaluated.
const WITHHELD: f64 = 0.02;

/// Releases of one force on one clock.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Releases {
    /// Clock of the loop.
    pub clock: ClockProfile,
    /// Kind of hand.
    pub kind: &'static str,
    /// Time in which the fingers opened, ms.
    pub opening_ms: f64,
    /// Force, N.
    pub force_n: f64,
    /// Releases.
    pub releases: u64,
    /// Number of releases before which force was withheld although the hand held the handle.
    pub withheld_before: usize,
    /// Travel of the handle, 95 % of the releases and the farthest, mm.
    pub travel_p95_mm: f64,
    /// See above.
    pub travel_max_mm: f64,
    /// Largest kinetic energy of the handle, mJ.
    pub energy_max_mj: f64,
    /// Median time until the release was detected with certainty, ms; `None` if most releases were not.
    pub detected_ms: Option<f64>,
}

/// One release.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ReleaseResult {
    pub(super) travel_m: f64,
    pub(super) energy_j: f64,
    pub(super) detected_s: Option<f64>,
    pub(super) withheld_before: bool,
}

/// Runs this many releases by hands of this kind, of this force (N) within this time (ms).
pub(super) fn releases(
    kind: &HandKind,
    clock: VirtualClock,
    seed: u64,
    count: u64,
    (opening_ms, force_n): (f64, f64),
) -> Releases {
    let one = |number: u64| {
        let clock = clocks::of_trial(clock, number);
        let seed = seed.wrapping_add(number);
        if kind.space {
            released::<3, _>(kind, clock, seed, (opening_ms, force_n), governor(kind))
        } else {
            released::<1, _>(kind, clock, seed, (opening_ms, force_n), governor(kind))
        }
    };
    let all: Vec<ReleaseResult> = (0..count).map(one).collect();
    let mut travels_mm: Vec<f64> = all.iter().map(|release| 1e3 * release.travel_m).collect();
    travels_mm.sort_by(f64::total_cmp);
    let mut detected_ms: Vec<f64> =
        all.iter().map(|release| release.detected_s.map_or(f64::INFINITY, |s| 1e3 * s)).collect();
    detected_ms.sort_by(f64::total_cmp);
    let at = |sorted: &[f64], percent: usize| sorted.get(sorted.len() * percent / 100).copied();
    Releases {
        clock: clock.profile,
        kind: kind.name,
        opening_ms,
        force_n,
        releases: count,
        withheld_before: all.iter().filter(|release| release.withheld_before).count(),
        travel_p95_mm: at(&travels_mm, 95).unwrap_or_default(),
        travel_max_mm: travels_mm.last().copied().unwrap_or_default(),
        energy_max_mj: all.iter().map(|release| 1e3 * release.energy_j).fold(0.0, f64::max),
        detected_ms: at(&detected_ms, 50).filter(|ms| ms.is_finite()),
    }
}

/// A hand carries a steady force, and opens.
pub(super) fn released<const D: usize, G: LastGate<D>>(
    kind: &HandKind,
    clock: VirtualClock,
    seed: u64,
    (opening_ms, force_n): (f64, f64),
    mut gate: G,
) -> ReleaseResult {
    let mut noise = Noise::new(seed);
    let person = PersonParameters::<D>::drawn(kind, &mut noise);
    let along = direction(&mut noise);
    let drift_m_s = DRIFT_M_S * between(&mut noise, [-1.0, 1.0]).max(0.0);
    let drift = Intention::Drifts(direction::<D>(&mut noise) * drift_m_s);
    let mut hand = StudyHand::new(person, drift, false);
    let mut reader = Reader::new();
    let release_s = between(&mut noise, RELEASE_S);
    let swing_s = person.handle_kg / person.damping_n_s_m;
    let mut times = clock.tick_times(RATE_HZ);
    let mut next_s = times.advance().now_s;
    let mut found = ReleaseResult::default();
    let mut from = None;
    while hand.now_s() < release_s + WATCHED_S {
        let since_s = hand.now_s() - release_s;
        if since_s >= 0.0 {
            let (from_m, from_m_s) = *from.get_or_insert((hand.position_m, hand.velocity_m_s));
            hand.holds = if opening_ms > 0.0 { (1.0 - 1e3 * since_s / opening_ms).max(0.0) } else { 0.0 };
            let travel_m: SVector<f64, D> = hand.position_m - from_m;
            let swing_m = from_m_s * (swing_s * (1.0 - (-since_s / swing_s).exp()));
            found.travel_m = found.travel_m.max(travel_m.norm().min((travel_m - swing_m).norm()));
            found.energy_j = found.energy_j.max(0.5 * person.handle_kg * hand.velocity_m_s.norm_squared());
        }
        hand.step(&mut noise);
        reader.step(&hand, kind, &mut noise);
        let now_s = hand.now_s();
        if now_s + 1e-9 < next_s {
            continue;
        }
        next_s = times.advance().now_s;
        let asked_n = along * (force_n * (now_s / RISE_S).min(1.0));
        let governed = gate.step(now_s, reader.reading(now_s, &hand, kind), asked_n);
        hand.carried_n = asked_n;
        hand.force_n = governed.force_n;
        if now_s < release_s {
            found.withheld_before |= governed.withheld > WITHHELD;
        } else if matches!(governed.reason, Reason::LetGo | Reason::HandGone) {
            found.detected_s.get_or_insert(now_s - release_s);
        }
    }
    found
}
