//! Guided recording of still poses from live samples: a state machine without a clock.
//!
//! Every sample is passed to [`GravitySession::step`]. It allocates nothing, except in the step that records a pose,
//! which repeats the fit (a few ms): it belongs to the screen's thread, not into a tick of the loop. A pose is an
//! interval in which force and orientation are still for the required time. Once there are enough poses, a still pose
//! that differs too much from the fit of the others is refused as touched, and can be repeated at once.

use nalgebra::Vector3;

use super::{
    GravityError, GravityModel, GravityPose, GravityReport, GravitySettings, Orientation, fit,
    model::arm_field_m_s2,
    still::{StillInterval, StillSettings},
    targets::{PoseTarget, TARGETS},
};
use crate::frames::WristSample;

/// Number of poses above which a new pose is compared with the others: a fit of fewer is too uncertain to contradict a
/// pose.
const COMPARE_FROM: usize = 6;
/// Maximum angle between the directions of gravity of a pose and of its target, rad, because a person reaches a target
/// only roughly, and the fit needs only that the poses differ.
const REACH_RAD: f64 = 25.0 * std::f64::consts::PI / 180.0;
/// Longest step that counts as time between two samples, s: after a longer gap no pose was being recorded. Otherwise a
/// pause of the program would count as a pose that was held still.
const STEP_MAX_S: f64 = 0.1;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravitySessionSettings {
    pub fit: GravitySettings,
    pub still: StillSettings,
    /// Whether to use the orientation from the arm even if there is an accelerometer.
    pub use_arm: bool,
    /// If the force of a still pose differs by more than this from the model of the other poses, the tool was touched,
    /// N.
    pub touched_n: f64,
    /// Minimum rotation of the tool between two poses, rad.
    pub turn_rad: f64,
}

impl Default for GravitySessionSettings {
    fn default() -> Self {
        Self {
            fit: GravitySettings::default(),
            still: StillSettings::default(),
            use_arm: false,
            // Three times the noise of the noisiest sensor that passes the check.
            touched_n: 0.3,
            // At 10 degrees the weight changes by a sixth across; closer poses add little.
            turn_rad: 10_f64.to_radians(),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GravityPhase {
    /// The sample is incomplete or contains a non-finite number.
    NoSample,
    /// The tool is moving, or still where the last pose was recorded.
    Moving,
    Recording {
        fraction: f64,
    },
    Recorded {
        /// Index of the pose, from 0.
        index: usize,
    },
    /// The tool does not rotate, but the force is not constant, so something touches it.
    Disturbed,
    /// Still where the last pose was recorded: turn the tool to the next one.
    TakenHere,
    /// Still, but inconsistent with the other poses: take the hand off the tool and repeat the pose.
    Touched {
        by_n: f64,
    },
}

/// Orientation in which a pose was recorded; only for guiding the operator, because the fit uses the measurements.
#[derive(Clone, Copy, Debug)]
struct PosePlace {
    /// Index of the target for which the pose counts.
    target: Option<usize>,
    /// Direction of gravity in `s1` from the arm, if available.
    down_s1: Option<Vector3<f64>>,
}

/// Returns the gravity vector (m/s^2, source's frame) from the source in the settings; `None` if it is missing or
/// defective.
pub(super) fn field_of(settings: &GravitySessionSettings, sample: &WristSample) -> Option<Vector3<f64>> {
    let field = if settings.use_arm {
        arm_field_m_s2(&sample.world_from_s1?)
    } else {
        sample.acceleration_m_s2? * -f64::from(settings.fit.imu_sign)
    };
    (field.norm() >= super::model::MIN_FIELD_M_S2).then_some(field)
}

#[derive(Clone, Debug)]
pub struct GravitySession {
    settings: GravitySessionSettings,
    still: StillInterval,
    poses: Vec<GravityPose>,
    places: Vec<PosePlace>,
    running: Option<GravityModel>,
    last: Option<WristSample>,
    refused: Option<f64>,
    stepped_s: Option<f64>,
    touched_s: f64,
}

impl GravitySession {
    pub fn new(settings: GravitySessionSettings) -> Self {
        let still = StillInterval::new(settings.still);
        let poses = Vec::with_capacity(64);
        let places = Vec::with_capacity(64);
        Self {
            settings,
            still,
            poses,
            places,
            running: None,
            last: None,
            refused: None,
            stepped_s: None,
            touched_s: 0.0,
        }
    }

    pub const fn settings(&self) -> &GravitySessionSettings {
        &self.settings
    }

    /// Sets the sign of the accelerometer (+1 or -1), also for the poses already recorded.
    pub fn set_imu_sign(&mut self, imu_sign: i8) {
        self.settings.fit.imu_sign = imu_sign;
        self.still.reset();
        self.refit();
    }

    /// Adds one sample at time `t_s` (s, increasing); returns the state of the session.
    pub fn step(&mut self, sample: &WristSample, t_s: f64) -> GravityPhase {
        let phase = self.phase(sample, t_s);
        let step_s = self.stepped_s.replace(t_s).map_or(0.0, |before_s| t_s - before_s);
        if matches!(phase, GravityPhase::Disturbed | GravityPhase::Touched { .. }) && step_s > 0.0 {
            self.touched_s += step_s.min(STEP_MAX_S);
        }
        phase
    }

    /// Returns the total time for which something touched the tool during poses, s.
    pub const fn touched_s(&self) -> f64 {
        self.touched_s
    }

    fn phase(&mut self, sample: &WristSample, t_s: f64) -> GravityPhase {
        let Some(field) = field_of(&self.settings, sample).filter(|_| sample.is_finite() && t_s.is_finite()) else {
            self.still.reset();
            self.last = None;
            return GravityPhase::NoSample;
        };
        self.last = Some(*sample);
        let Some(progress) = self.still.step(sample, &field, t_s) else {
            self.refused = None;
            return if self.still.only_force_moved() { GravityPhase::Disturbed } else { GravityPhase::Moving };
        };
        if self.taken_here(&field) {
            return GravityPhase::TakenHere;
        }
        if let Some(by_n) = self.refused {
            // The pose stays rejected while the tool is held like this; a new attempt starts once the tool has moved or
            // was released.
            if progress >= 1.0 {
                self.still.reset();
                self.refused = None;
            }
            return GravityPhase::Touched { by_n };
        }
        if progress < 1.0 {
            return GravityPhase::Recording { fraction: progress };
        }
        self.record()
    }

    /// Stores the still interval as a pose, unless the other poses show that it was touched.
    fn record(&mut self) -> GravityPhase {
        let Some((mean, field)) = self.still.mean() else { return GravityPhase::Moving };
        let world_from_s1 = self.still.mean_world_from_s1();
        self.still.reset();
        // Without an accepted model there is nothing to compare with, so the pose is kept.
        let by_n = self.running.map_or(0.0, |model| (mean.force_n - model.predict(&field).force_n).norm());
        if by_n > self.settings.touched_n {
            self.refused = Some(by_n);
            return GravityPhase::Touched { by_n };
        }
        let orientation = match (self.settings.use_arm, world_from_s1) {
            (true, Some(world_from_s1)) => Orientation::Arm(world_from_s1),
            (true, None) => return GravityPhase::NoSample,
            // Back to the reading of the accelerometer, which is what files store.
            (false, _) => Orientation::Imu(field * -f64::from(self.settings.fit.imu_sign)),
        };
        let place = self.place();
        self.poses.push(GravityPose { wrench: mean, has_torque: true, orientation });
        self.places.push(place);
        self.refit();
        GravityPhase::Recorded { index: self.poses.len() - 1 }
    }

    fn pose_field(&self, pose: &GravityPose) -> Vector3<f64> {
        match pose.orientation {
            Orientation::Imu(acceleration) => acceleration * -f64::from(self.settings.fit.imu_sign),
            Orientation::Arm(world_from_s1) => arm_field_m_s2(&world_from_s1),
        }
    }

    fn taken_here(&self, field: &Vector3<f64>) -> bool {
        self.poses.last().is_some_and(|pose| self.pose_field(pose).angle(field) < self.settings.turn_rad)
    }

    fn refit(&mut self) {
        let enough = self.poses.len() >= COMPARE_FROM;
        let report = enough.then(|| self.report().ok()).flatten();
        // Only an accepted model can show that a new pose is wrong.
        let usable = report.filter(|report| report.verdict == crate::calibration::Verdict::Accepted);
        self.running = usable.and_then(|report| report.chosen_fit().map(|fit| fit.model));
    }

    /// Returns the next target: the first one without a pose.
    pub fn target(&self) -> Option<PoseTarget> {
        self.next().map(|index| TARGETS[index])
    }

    fn next(&self) -> Option<usize> {
        (0..TARGETS.len()).find(|&index| !self.is_met(index))
    }

    fn is_met(&self, index: usize) -> bool {
        self.places.iter().any(|place| place.target == Some(index))
    }

    pub fn targets_met(&self) -> usize {
        (0..TARGETS.len()).filter(|&index| self.is_met(index)).count()
    }

    /// Returns the target for which a pose recorded now counts: the nearest one within reach, by the arm's orientation.
    /// Without an arm the sensor's mounting is not known yet, so the requested target is assumed; the coverage of the
    /// fit decides in the end.
    fn place(&self) -> PosePlace {
        let Some(down_s1) = self.down_s1() else { return PosePlace { target: self.next(), down_s1: None } };
        let angle = |index: &usize| Vector3::from(TARGETS[*index].down_s1).angle(&down_s1);
        let nearest = (0..TARGETS.len()).min_by(|a, b| angle(a).total_cmp(&angle(b)));
        PosePlace { target: nearest.filter(|index| angle(index) < REACH_RAD), down_s1: Some(down_s1) }
    }

    /// Returns the current direction of gravity in `s1`, from the arm.
    fn down_s1(&self) -> Option<Vector3<f64>> {
        arm_field_m_s2(&self.last?.world_from_s1?).try_normalize(1e-9)
    }

    /// Returns the directions of gravity in `s1` of the recorded poses, for drawing: from the arm if available,
    /// otherwise the requested ones.
    pub fn taken_down_s1(&self) -> Vec<Vector3<f64>> {
        let known = |place: &PosePlace| place.down_s1.or_else(|| Some(Vector3::from(TARGETS[place.target?].down_s1)));
        self.places.iter().filter_map(known).collect()
    }

    pub fn poses(&self) -> &[GravityPose] {
        &self.poses
    }

    /// Removes a pose; returns `None` if it does not exist.
    pub fn remove(&mut self, index: usize) -> Option<GravityPose> {
        let removed = (index < self.poses.len()).then(|| {
            self.places.remove(index);
            self.poses.remove(index)
        });
        self.refit();
        removed
    }

    pub fn undo(&mut self) -> Option<GravityPose> {
        self.remove(self.poses.len().checked_sub(1)?)
    }

    /// Fits the poses recorded so far.
    ///
    /// # Errors
    /// The errors of [`fit`](super::fit()).
    pub fn report(&self) -> Result<GravityReport, GravityError> {
        fit(&self.poses, &self.settings.fit)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::calibration::{
        Verdict,
        gravity::{CheckPass, Compensator, tests::Tool},
    };

    /// Holds the tool still for 1.6 s with an additional force and noise of 0.02 N; returns the observed states.
    fn hold(
        session: &mut GravitySession,
        tool: &mut Tool,
        target: &PoseTarget,
        push_n: f64,
        t_s: &mut f64,
    ) -> Vec<GravityPhase> {
        let still = |tool: &mut Tool| {
            let mut sample = tool.sample(target.world_from_s1(), 0.02, 1e-3);
            sample.raw.force_n.x += push_n;
            *t_s += 1e-3;
            (sample, *t_s)
        };
        let mut still = still;
        (0..1600)
            .map(|_| {
                let (sample, t_s) = still(tool);
                session.step(&sample, t_s)
            })
            .collect()
    }

    #[test]
    fn a_guided_session_ends_accepted_and_refuses_a_touched_pose() {
        let mut tool = Tool::new(31, 0.4);
        tool.s1_from_imu = UnitQuaternion::identity();
        let mut session = GravitySession::new(GravitySessionSettings::default());
        let mut t_s = 0.0;
        for count in 0..9 {
            let target = session.target().unwrap();
            let phases = hold(&mut session, &mut tool, &target, 0.0, &mut t_s);
            assert!(phases.contains(&GravityPhase::Recorded { index: count }), "{}", target.name);
        }
        let target = session.target().unwrap();
        let touched = hold(&mut session, &mut tool, &target, 1.0, &mut t_s);
        assert!(touched.iter().any(|phase| matches!(phase, GravityPhase::Touched { .. })));
        assert_eq!(session.poses().len(), 9);
        let touched_s = session.touched_s();
        assert!((0.5..1.6).contains(&touched_s), "{touched_s} s");
        while let Some(target) = session.target() {
            hold(&mut session, &mut tool, &target, 0.0, &mut t_s);
        }
        let report = session.report().unwrap();
        assert_eq!((report.verdict, session.targets_met()), (Verdict::Accepted, 12), "{}", report.reason);
        assert!(session.touched_s() < touched_s + 0.1, "{} s: nothing touched it again", session.touched_s());
        assert!(session.undo().is_some() && session.remove(99).is_none());
        assert!(session.target().is_some());

        let model = report.chosen_fit().unwrap().model;
        let mut pass = CheckPass::new(Compensator::new(model, 0.002, 1e-3), 0.2);
        for i in 0..3000 {
            let tilt = UnitQuaternion::from_euler_angles(f64::from(i) * 5e-4, 0.0, 0.0);
            pass.step(&tool.sample(tilt, 0.02, 1e-3));
        }
        assert!(pass.result().passed, "{:?}", pass.result());
    }

    #[test]
    fn a_moving_tool_and_a_poisoned_sample_record_nothing() {
        let mut tool = Tool::new(32, 0.4);
        let mut session = GravitySession::new(GravitySessionSettings::default());
        for i in 0..5000 {
            let turning = UnitQuaternion::from_euler_angles(f64::from(i) * 1e-3, 0.0, 0.0);
            session.step(&tool.sample(turning, 0.02, 1e-3), f64::from(i) * 1e-3);
        }
        let mut bad = tool.sample(UnitQuaternion::identity(), 0.0, 0.0);
        bad.raw.force_n.x = f64::NAN;
        assert_eq!(session.step(&bad, 6.0), GravityPhase::NoSample);
        assert!(session.poses().is_empty());
    }

    #[test]
    fn a_pose_by_the_arm_is_the_mean_over_the_stretch_and_not_its_last_sample() {
        let mut tool = Tool::new(33, 0.4);
        let held = TARGETS[5].world_from_s1();
        let mut session =
            GravitySession::new(GravitySessionSettings { use_arm: true, ..GravitySessionSettings::default() });
        for tick in 0..1600 {
            let mut sample = tool.sample(held, 0.02, 1e-3);
            // Joint sensor noise of half a degree per axis.
            let tremble = UnitQuaternion::from_scaled_axis(tool.vector(0.009));
            sample.world_from_s1 = Some(held * tremble);
            if matches!(session.step(&sample, f64::from(tick) * 1e-3), GravityPhase::Recorded { .. }) {
                break;
            }
        }
        let Orientation::Arm(taken) = session.poses()[0].orientation else { panic!("not by the arm") };
        let off_deg = taken.angle_to(&held).to_degrees();
        assert!(off_deg < 0.1, "{off_deg} degrees");
    }
}
