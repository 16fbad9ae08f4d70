//! A moving hand that holds the handle, in the whole loop: every mode of the program, with its own gates.

use nalgebra::Vector3;
use nima_core::{
    impedance::{Mode, OwnMotion, Recipe},
    noise::Noise,
    safety::{ChainSettings, Gate, GovernorOutput, Reason},
};
use nima_machine::runtime::{ClockProfile, VirtualClock};
use nima_simulation::scene::TissueModel;
use serde::Serialize;

use super::{
    HandsError,
    person_parameters::{PersonMotion, between},
    present_hands::{HeldTally, HeldWatch},
};
use crate::{
    clocks,
    pair::{BenchPair, LoneHandle, NOISE_N, PairGrip, PairTrial, RATE_HZ},
    release::TREMOR_M,
};

/// Delays of the link, ms.
const DELAYS_MS: [f64; 2] = [10.0, 100.0];
/// Stiffness of the grips, N/m.
const GRIPS_N_M: [f64; 2] = [900.0, 2000.0];
/// Initial position of the hand and middle of its targets, height above the tissue, and maximum distance of the
/// targets, m.
const START_M: f64 = 0.005;
const MIDDLE_M: f64 = -0.002;
const RADIUS_M: f64 = 0.010;
/// Duration of a motion, and longest pause after it, s.
const REACHES_S: ([f64; 2], f64) = ([0.2, 0.9], 0.5);

/// One mode on one clock: all delays.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct InMode {
    /// Clock of the loop.
    pub clock: ClockProfile,
    /// Mode that rendered.
    pub mode: Mode,
    /// Events and sums; reversed forces are from the brake.
    #[serde(flatten)]
    pub tally: HeldTally,
}

/// Runs hands with random grips that touch the tissue in this mode, one for each delay.
pub(super) fn in_mode(
    mode: Mode,
    clock: VirtualClock,
    seed: u64,
    seconds: f64,
    tissue: TissueModel,
) -> Result<InMode, HandsError> {
    let mut tally = HeldTally::default();
    for (number, delay_ms) in (0..).zip(DELAYS_MS) {
        let trial = trial(mode, 1e-3 * delay_ms, clocks::of_trial(clock, number), seed.wrapping_add(number), tissue);
        tally.add(&touched(&trial, seconds)?);
    }
    Ok(InMode { clock: clock.profile, mode, tally })
}

fn trial(mode: Mode, delay_s: f64, clock: VirtualClock, seed: u64, tissue: TissueModel) -> PairTrial {
    let mut noise = Noise::new(seed);
    PairTrial {
        mode,
        own_motion: OwnMotion::Follower,
        literal: Recipe::default(),
        delay_s,
        gates: ChainSettings::default(),
        gain: 1.0,
        tissue,
        tremor_m: TREMOR_M,
        noise_n: NOISE_N,
        handle: LoneHandle::OMEGA,
        grip: PairGrip::of_stiffness(between(&mut noise, GRIPS_N_M)),
        seed,
        clock,
    }
}

fn touched(trial: &PairTrial, seconds: f64) -> Result<HeldTally, HandsError> {
    let start_m = Vector3::new(0.0, 0.0, START_M);
    let mut motion = PersonMotion::new(start_m, Vector3::new(0.0, 0.0, MIDDLE_M), RADIUS_M, REACHES_S);
    let mut noise = Noise::new(trial.seed);
    let mut pair = BenchPair::new(trial, start_m)?;
    let mut watch = HeldWatch::default();
    let mut asked_n = Vector3::zeros();
    while pair.now_s() < seconds - 0.5 / RATE_HZ {
        let last_n = pair.force_n();
        let last_s = pair.now_s();
        pair.step(|t_s, _| motion.at(t_s, &mut noise).0);
        let withheld = pair.report().governed;
        let reason = pair.report().reason(Gate::Governor);
        let governed = GovernorOutput { force_n: pair.force_n(), withheld, reason };
        asked_n = before_the_governor(&governed, &asked_n);
        // A request that is not a number causes a stop, which is not slew-limited and is not the governor's doing.
        let before_n = if pair.report().acted(Gate::Validity) { governed.force_n } else { last_n };
        watch.tick(pair.now_s() - last_s, &before_n, &governed, &asked_n);
    }
    Ok(watch.tally)
}

/// Returns the force that was requested from the governor (N), computed from the withheld fraction. While the whole
/// force is withheld, the previous value is kept; a brake counts as opposed to it.
fn before_the_governor(governed: &GovernorOutput<3>, last_n: &Vector3<f64>) -> Vector3<f64> {
    let GovernorOutput { force_n, withheld, reason } = *governed;
    if reason == Reason::LetGo && force_n.norm() > 0.0 {
        return force_n * (-last_n.norm() / force_n.norm());
    }
    if withheld < 1.0 { force_n / (1.0 - withheld) } else { *last_n }
}
