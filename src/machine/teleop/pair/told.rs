//! Fills in the [`Tick`] of a pair, and defines what is reported before the first sample.

use nalgebra::Vector3;
use nima_core::{calibration::frames::FrameSample, impedance::Rendered, kinematics::Hand, safety::GateReport};

use super::{Pair, Timing};
use crate::{
    messages::{ForceReport, ForceSource, Tick},
    rig::{Inputs, Sensed, Switches, View},
    teleop::Link,
};

/// Marks a sample that was not measured.
pub(super) const NOWHERE: Vector3<f64> = Vector3::new(f64::NAN, f64::NAN, f64::NAN);

/// No poses: nothing was measured in this tick.
const NO_FRAMES: FrameSample = FrameSample {
    base_from_flange: None,
    other_base_from_flange: None,
    c_from_m: None,
    c_from_other_m: None,
    leader_from_handle: None,
    wrench: None,
};

/// Displayed until the rig has delivered its first sample.
pub(super) const NOTHING_YET: Inputs = Inputs {
    hand: Hand::at(Vector3::new(0.0, 0.0, 0.0)),
    gripper_rad: None,
    grip_n: None,
    tip_m: Vector3::new(0.0, 0.0, 0.0),
    world_from_jaws: None,
    sensed: Sensed::AtTip(Vector3::new(0.0, 0.0, 0.0)),
    view: View::Fixed,
    frames: NO_FRAMES,
    switches: Switches { clutch: false, presence: None },
    powered: false,
    obstacle: None,
    age_s: 0.0,
};

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
            wrist: match seen.sensed {
                Sensed::AtTip(_) => None,
                Sensed::AtWrist(sample) => Some(sample),
            },
            // A pose that is not new would look as if it were held still.
            frames: if self.was_there { seen.frames } else { NO_FRAMES },
            view: seen.view,
            prompt: self.prompt,
            guide_m: self.guide_m,
            delayed_n,
            asked_n: rendered.force_n,
            rendered_n,
            gates,
            gate_settings: *self.chain.settings(),
            identification: *self.identifier.report(),
            wake_s: timing.wake_s,
            work_s: timing.work_s,
            sample_to_force_s: timing.sample_to_force_s,
            missed: self.missed,
            dropped: 0,
        }
    }
}
