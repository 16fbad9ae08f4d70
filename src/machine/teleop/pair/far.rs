//! A pair whose follower is at another machine: force and parameters come identified over a network.

use nima_core::impedance::{Packed, Parcel, Report, SLOTS};

use super::Pair;
use crate::{
    messages::{Bulletin, FarStop, Fault, ForceReport, ForceSource, Refusal, Watchdog},
    rig::Identified,
    teleop::Link,
};

/// Parameters that were not renewed for so long make no force, s: a matched model remembers some seconds, and a renewal comes every
/// 20 ms.
const PARAMETERS_OLD_S: f64 = 0.3;

/// What the other machine has told.
#[derive(Clone, Debug)]
pub(super) struct Far {
    /// The follower is there, not here.
    pub(super) is_there: bool,
    /// The newest parcel, put together from its parts.
    pub(super) parcel: Parcel,
    /// What is known of the identification there.
    pub(super) report: Report,
    /// Ticks from a command to the answer to it.
    pub(super) behind: usize,
    /// When the parameters of each slot last came, s.
    renewed_s: [f64; SLOTS],
    /// Why that machine is stopped.
    pub(super) stop: Option<FarStop>,
    source: ForceSource,
}

impl Far {
    /// Nothing told: the follower is here.
    pub(super) fn none() -> Box<Self> {
        Box::new(Self {
            is_there: false,
            parcel: Parcel::BLANK,
            report: Report::BLANK,
            behind: 0,
            renewed_s: [f64::NEG_INFINITY; SLOTS],
            stop: None,
            source: ForceSource::NoSample,
        })
    }
}

impl<L: Link> Pair<L> {
    /// Takes what the other machine identified; returns its force.
    pub(super) fn hear(&mut self, identified: &Identified) -> ForceReport {
        let behind = self.settings.delay_ticks(identified.delay_s);
        if !self.far.is_there || behind != self.far.behind {
            (self.far.is_there, self.far.behind) = (true, behind);
            self.delay_s = behind as f64 / self.rate_hz;
            self.renderer.set_delay(self.delay_s);
        }
        // What an identification here would send is withheld in the same way.
        if !self.withholds(Watchdog::Link) {
            let far = &mut self.far;
            (far.stop, far.source) = (identified.stop, identified.source);
            let parcel = &mut far.parcel;
            (parcel.t_s, parcel.force_n) = (identified.t_s, identified.force_n);
            (parcel.fresh, parcel.resting) = (identified.fresh, identified.resting);
            parcel.modes = identified.modes;
            let packed = &identified.packed;
            if packed.put_into(parcel)
                && let Some(renewed_s) = far.renewed_s.get_mut(usize::from(packed.slot))
            {
                *renewed_s = identified.t_s;
            }
            // Parameters that are lost again and again are no parameters: the force is then reflected as it came.
            for (slot, renewed_s) in far.renewed_s.iter().enumerate() {
                if identified.t_s - renewed_s > PARAMETERS_OLD_S {
                    Packed::forget(slot as u8, parcel);
                }
            }
            let report = &mut far.report;
            (report.t_s, report.modes, report.resting) = (parcel.t_s, parcel.modes, parcel.resting);
            (report.paper_degree, report.degree) = (parcel.literal.degree, parcel.anchored.degree);
            (report.matched_degree, report.nima_degree) = (parcel.matched.degree, parcel.nima.degree);
            report.gain = parcel.anchored.gain;
            if let Some(errors_n) = identified.errors_n {
                report.horizon_error_n = errors_n.map(f64::from);
            }
        }
        ForceReport::of_far_end(self.far.source, self.far.parcel.force_n)
    }

    /// The fault that the other machine's stop is here.
    pub(super) fn far_fault(&self) -> Option<Fault> {
        self.far.stop.map(|stop| Fault::FarEnd { stop })
    }

    /// Releases the other machine's stop where nothing is to be released here; `None` if there is no such stop.
    pub(super) fn release_far(&mut self) -> Option<Result<(), Refusal>> {
        self.far.stop.filter(|_| !self.state().is_latched()).map(|_| {
            self.releases = self.releases.wrapping_add(1);
            Ok(())
        })
    }

    /// What the other machine has to know.
    pub(in crate::teleop) fn bulletin(&self) -> Bulletin<'_> {
        Bulletin {
            side: self.side,
            state: self.state(),
            mode: self.mode,
            compares: self.compares,
            delay_s: self.delay_s,
            releases: self.releases,
            source: self.force.source,
            parcel: self.identifier.parcel(),
            report: self.identifier.report(),
        }
    }
}
