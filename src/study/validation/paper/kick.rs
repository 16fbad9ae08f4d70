//! What the handle does when the hand lets go while the paper's recipe renders, without the governor.

use nima_core::{impedance::Mode, safety::ChainSettings};
use nima_world::scene::Scene;
use serde::Serialize;

use super::judged::{PRINTED, REPAIRED};
use crate::{
    pair::{GRIP_N_M, Handle, NOISE_N, Trial},
    release::{ReleaseError, Row, Situation, TREMOR_M, release},
};

/// Force of the contact, N, and delays of the link, s.
const CONTACT_N: f64 = 5.0;
const DELAYS_S: [f64; 2] = [0.05, 0.3];
/// Tremor of the hand (m), noise of the force sensor (N), stiffness of the grip (N/m): a hand that gives way as usual and one that hardly
/// does, each without tremor and noise, with noise only, and with both.
const HANDS: [(f64, f64, f64); 6] = [
    (0.0, 0.0, FIRM_N_M),
    (0.0, NOISE_N, FIRM_N_M),
    (TREMOR_M, NOISE_N, FIRM_N_M),
    (0.0, 0.0, GRIP_N_M),
    (0.0, NOISE_N, GRIP_N_M),
    (TREMOR_M, NOISE_N, GRIP_N_M),
];
const FIRM_N_M: f64 = 1e5;

/// One letting go.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Kick {
    /// What is changed in the recipe; reflection for comparison.
    pub name: &'static str,
    /// Amplitude of the hand's tremor, m.
    pub tremor_m: f64,
    /// Noise of the force sensor, N.
    pub noise_n: f64,
    /// Stiffness of the grip, N/m.
    pub grip_n_m: f64,
    /// What happened.
    #[serde(flatten)]
    pub row: Row,
}

/// Held and pressing, by each hand, as printed and repaired, and reflection beside them.
///
/// # Errors
/// [`ReleaseError`] if the scene has no tissue or the force is never reached.
pub fn all() -> Result<Vec<Kick>, ReleaseError> {
    let tissue = Scene::load("peg_transfer")?.tissue.ok_or(ReleaseError::NoTissue)?;
    let (gates, handle, gain, seed) = (ChainSettings::default().without_governor(), Handle::OMEGA, 1.0, 1);
    let recipes = [
        ("as printed", Mode::Literal, PRINTED),
        ("repaired", Mode::Literal, REPAIRED),
        ("reflection", Mode::Dfr, PRINTED),
    ];
    let mut all = Vec::new();
    for (name, mode, literal) in recipes {
        for situation in Situation::ALL {
            for (tremor_m, noise_n, grip_n_m) in HANDS {
                for delay_s in DELAYS_S {
                    let trial = Trial {
                        mode,
                        literal,
                        delay_s,
                        gates,
                        gain,
                        tissue,
                        tremor_m,
                        noise_n,
                        grip_n_m,
                        handle,
                        seed,
                    };
                    all.push(Kick { name, tremor_m, noise_n, grip_n_m, row: release(&trial, situation, CONTACT_N)? });
                }
            }
        }
    }
    Ok(all)
}
