//! Fills in the [`Tick`] of a pair, and defines what is reported before the first sample.

use nalgebra::Vector3;
use nima_core::{calibration::frames::FrameSample, impedance::Rendered, safety::GateReport};

use super::{Pair, SILENT_AFTER_S, Timing};
use crate::{
    messages::{ForceReport, ForceSource, Tick},
    rig::Inputs,
    teleop::Link,
};

/// Marks a sample that was not measured.
pub(super) const NOWHERE: Vector3<f64> = Vector3::new(f64::NAN, f64::NAN, f64::NAN);

/// The force before the first sample, and when the last one is too old.
pub(super) const NO_FORCE: ForceReport = ForceReport::none(ForceSource::NoSample, None);

impl<L: Link> Pair<L> {
    #[expect(clippy::too_many_arguments, reason = "all that one tick tells")]
    pub(super) fn tick(
        &self,
        seen: &Inputs,
        leader_m: Vector3<f64>,
        rendered: &Rendered,
        delayed_n: Vector3<f64>,
        rendered_n: Vector3<f64>,
        gates: GateReport,
        timing: &Timing,
    ) -> Tick {
        let silent = self.is_silent(timing.now_s);
        // Over a network a gap is no fault until it has lasted for [`super::LINK_SILENT_AFTER_S`], but its force is not that of now.
        let force = if seen.silent_s > SILENT_AFTER_S { NO_FORCE } else { self.force };
        Tick {
            index: self.ticks,
            t_s: timing.now_s,
            side: self.side,
            state: self.state(),
            mode: self.mode,
            delay_s: self.delay_s,
            leader_m,
            tip_m: seen.tip_m,
            measured_n: force.measured_n(),
            force,
            wrist: seen.sensed.wrist().filter(|_| !silent).copied(),
            // A pose that is not new would look as if it were held still.
            frames: if self.was_there { seen.frames } else { FrameSample::default() },
            view: seen.view,
            prompt: self.prompt,
            guide_m: self.guide_m,
            delayed_n,
            asked_n: rendered.force_n,
            rendered_n,
            gates,
            gate_settings: *self.chain.settings(),
            identification: if self.far.is_there { self.far.report } else { *self.identifier.report() },
            wake_s: timing.wake_s,
            work_s: timing.work_s,
            sample_to_force_s: timing.sample_to_force_s,
            missed: self.missed,
            dropped: 0,
        }
    }
}
