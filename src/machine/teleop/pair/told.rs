//! Fills in the [`Tick`] of a pair, and defines what is reported before the first sample.

use nalgebra::Vector3;
use nima_core::{calibration::frames::FrameSample, impedance::Rendered, safety::GateReport};

use super::{Pair, Timing};
use crate::{
    messages::{ForceReport, ForceSource, Tick},
    rig::Inputs,
    teleop::Link,
};

/// Marks a sample that was not measured.
pub(super) const NOWHERE: Vector3<f64> = Vector3::new(f64::NAN, f64::NAN, f64::NAN);

/// Used until the first sample. The source `AtTip` with no force is not usable, and shows a rig that measures at the
/// tip correctly from the start.
pub(super) const NO_FORCE_YET: ForceReport = ForceReport::none(ForceSource::AtTip, None);

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
        Tick {
            index: self.ticks,
            t_s: timing.now_s,
            side: self.side,
            state: self.state(),
            mode: self.mode,
            delay_s: self.delay_s,
            leader_m,
            tip_m: seen.tip_m,
            measured_n: self.force.tip_n,
            force: self.force,
            wrist: seen.sensed.wrist().copied(),
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
