//! The follower's half of a pair: readings → tip force → identification → packets for the link.
//!
//! If the follower is at another machine, this half runs there, and its packets arrive over a
//! [`FarLink`](super::far_link::FarLink).

use nalgebra::Vector3;
use nima_core::impedance::{Identifier, ImpedanceSettings, LinkPacket, Sample, SettingsError};

use super::{
    Calibrations, ForcePath, Link, Timing,
    even::{Between, deadlines, stacked},
};
use crate::messages::{ForceReport, ForceSource};

/// Marks a sample that was not measured.
/// The identifier counts such a sample as rejected: it keeps its clock without learning.
const NOWHERE: Vector3<f64> = Vector3::new(f64::NAN, f64::NAN, f64::NAN);

/// The force before the first sample, and when the last one is too old.
pub(super) const NO_FORCE: ForceReport = ForceReport::none(ForceSource::NoSample, None);

#[derive(Clone, Debug)]
pub(super) struct FollowerHalf {
    pub(super) force_path: ForcePath,
    pub(super) force: ForceReport,
    pub(super) identifier: Identifier,
    /// Tip (m) and its force (N) in the last tick, for even spacing.
    measured: Between<6>,
    period_s: f64,
}

impl FollowerHalf {
    pub(super) fn new(settings: &ImpedanceSettings, calibrations: &Calibrations) -> Result<Self, SettingsError> {
        let period_s = 1.0 / settings.rate_hz;
        Ok(Self {
            force_path: ForcePath::new(calibrations, period_s),
            force: NO_FORCE,
            identifier: Identifier::new(settings)?,
            measured: Between::default(),
            period_s,
        })
    }

    /// Identifies at every deadline that has passed, and sends a packet for each; without a `link` none is sent.
    pub(super) fn identify<L: Link>(&mut self, tip_m: &Vector3<f64>, timing: &Timing, mut link: Option<&mut L>) {
        let now = (timing.now_s, stacked([tip_m, &self.force.tip_n]));
        // Several deadlines after a late tick: the identification needs evenly spaced samples.
        for t_s in deadlines(timing, self.period_s) {
            let at = self.measured.at(t_s, now);
            let [position_m, force_n] = [0, 3].map(|from| at.fixed_rows::<3>(from).into_owned());
            self.identifier.step(&Sample { t_s, position_m, force_n });
            if let Some(link) = &mut link {
                let parcel = self.identifier.parcel();
                // A force that was not measured may be rendered, but must not be used to evaluate modes.
                let fresh = parcel.fresh && self.force.source.is_known();
                link.send(&LinkPacket { fresh, ..*parcel });
            }
        }
        self.measured.keep(now);
    }

    /// Handles a tick without a sample. The identification needs evenly spaced samples: it interpolates the missing
    /// one, and no packet is sent for it.
    pub(super) fn miss(&mut self, timing: &Timing) {
        for t_s in deadlines(timing, self.period_s) {
            self.identifier.step(&Sample { t_s, position_m: NOWHERE, force_n: NOWHERE });
        }
        // A value from before the gap must not be interpolated into the next tick.
        self.measured.forget();
    }
}
