//! Motion of the handle when the hand lets go during rendering by the paper's recipe, without the governor.

use nima_core::{
    impedance::{Mode, OwnMotion, Recipe},
    safety::ChainSettings,
};
use nima_machine::runtime::VirtualClock;
use serde::Serialize;

use super::judged::{PRINTED, REPAIRED};
use crate::{
    pair::{LoneHandle, NOISE_N, PairGrip, PairTrial},
    release::{ReleaseError, ReleaseRow, ReleaseSituation, TREMOR_M, pressed_tissue, release},
};

/// Force of the contact, N, and delays of the link, s.
const CONTACT_N: f64 = 5.0;
const DELAYS_S: [f64; 2] = [0.05, 0.3];
/// Tremor of the hand (m), noise of the force sensor (N), stiffness of the grip (N/m).
#[derive(Clone, Copy, Debug)]
pub(super) struct KickHand {
    tremor_m: f64,
    noise_n: f64,
    grip_n_m: f64,
}

impl KickHand {
    /// A hand that neither yields nor moves.
    pub(super) const FIRM: Self = Self { tremor_m: 0.0, noise_n: 0.0, grip_n_m: 1e5 };
    /// A hand that yields but does not move by itself.
    pub(super) const YIELDING: Self = Self { grip_n_m: PairGrip::FIRM.n_m, ..Self::FIRM };
    /// Both, with noise, and with noise and tremor.
    const ALL: [Self; 6] = [
        Self::FIRM,
        Self { noise_n: NOISE_N, ..Self::FIRM },
        Self { noise_n: NOISE_N, tremor_m: TREMOR_M, ..Self::FIRM },
        Self::YIELDING,
        Self { noise_n: NOISE_N, ..Self::YIELDING },
        Self { noise_n: NOISE_N, tremor_m: TREMOR_M, ..Self::YIELDING },
    ];
}

/// A renderer: its name, the mode, its recipe.
type KickRendering = (&'static str, Mode, Recipe);
/// The recipe as printed, repaired, and reflection for comparison.
pub(super) const WAYS: [KickRendering; 3] =
    [("as printed", Mode::Literal, PRINTED), ("repaired", Mode::Literal, REPAIRED), ("reflection", Mode::Dfr, PRINTED)];

/// One release.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Kick {
    /// The change of the recipe; reflection for comparison.
    pub name: &'static str,
    /// Amplitude of the hand's tremor, m.
    pub tremor_m: f64,
    /// Noise of the force sensor, N.
    pub noise_n: f64,
    /// Stiffness of the grip, N/m.
    pub grip_n_m: f64,
    /// Result.
    #[serde(flatten)]
    pub row: ReleaseRow,
}

/// Held and pressing, by each hand, as printed and repaired, and reflection for comparison.
///
/// # Errors
/// [`ReleaseError`] if the scene has no tissue or the force is never reached.
pub fn all() -> Result<Vec<Kick>, ReleaseError> {
    let mut all = Vec::new();
    for way in WAYS {
        for situation in ReleaseSituation::ALL {
            for hand in KickHand::ALL {
                for delay_s in DELAYS_S {
                    all.push(let_go(way, situation, hand, delay_s)?);
                }
            }
        }
    }
    Ok(all)
}

pub(super) fn let_go(
    way: KickRendering,
    situation: ReleaseSituation,
    hand: KickHand,
    delay_s: f64,
) -> Result<Kick, ReleaseError> {
    let tissue = pressed_tissue()?;
    let (name, mode, literal) = way;
    let KickHand { tremor_m, noise_n, grip_n_m } = hand;
    let gates = ChainSettings::default().without_governor();
    let handle = LoneHandle::OMEGA;
    let gain = 1.0;
    let seed = 1;
    let clock = VirtualClock::PERFECT;
    let own_motion = OwnMotion::Follower;
    let grip = PairGrip::of_stiffness(grip_n_m);
    let trial = PairTrial {
        mode,
        own_motion,
        literal,
        delay_s,
        gates,
        gain,
        tissue,
        tremor_m,
        noise_n,
        handle,
        grip,
        seed,
        clock,
    };
    Ok(Kick { name, tremor_m, noise_n, grip_n_m, row: release(&trial, situation, CONTACT_N)? })
}
