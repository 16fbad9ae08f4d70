//! Hand-eye mapping: the tip moves in the endoscope image as the hand moves in front of the screen.
//!
//! Frames: `leader` (the haptic device), `view` (the endoscope image: x right, y down, z into the image), `world`.
//! Positions in m. When the clutch is released, the hand is coupled to the tip at their current positions: engaging,
//! releasing and changing the mapping never move the tip. Input that is not finite gives no motion.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use thiserror::Error;

use crate::limits::SCALE;

#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum MotionMappingError {
    #[error("the rotation from the leader to the arm's base is not finite: enter the endoscope's pose again")]
    Rotation,
    #[error("the motion scale {scale} is out of range: use {SCALE}")]
    Scale { scale: f64 },
}

/// Returns `view_from_leader` of an Omega below a screen whose base faces the user (x towards the user, y to the user's
/// right, z up).
pub fn view_from_omega() -> UnitQuaternion<f64> {
    let matrix = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix))
}

/// Returns `world_from_view`, measured by the tracker `c`, which detects the marker `m` on the instrument and another
/// marker on the endoscope.
pub fn world_from_tracked_view(
    world_from_m: &UnitQuaternion<f64>,
    m_from_c: &UnitQuaternion<f64>,
    c_from_view: &UnitQuaternion<f64>,
) -> UnitQuaternion<f64> {
    world_from_m * m_from_c * c_from_view
}

/// Direction and distance of the tip's motion for a motion of the hand.
///
/// ```
/// use nalgebra::{UnitQuaternion, Vector3};
/// use nima_core::kinematics::{MotionMapping, MotionMappingError, view_from_omega};
///
/// let mapping = MotionMapping::new(&UnitQuaternion::identity(), &view_from_omega(), 0.5)?;
/// let hand_m = Vector3::new(0.02, 0.0, 0.0);
/// assert!((mapping.to_tip(&hand_m).norm() - 0.01).abs() < 1e-12, "half the travel");
/// let force_n = mapping.force_to_hand(&mapping.to_tip(&hand_m).normalize());
/// assert!((force_n - Vector3::x()).norm() < 1e-12, "a force along the tip's path is felt along the hand's path");
/// assert_eq!(mapping.scaled(100.0), Err(MotionMappingError::Scale { scale: 100.0 }));
/// # Ok::<(), MotionMappingError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionMapping {
    world_from_leader: UnitQuaternion<f64>,
    scale: f64,
}

impl Default for MotionMapping {
    /// Creates a mapping in which the leader's axes coincide with the workspace axes; scale 1.
    fn default() -> Self {
        Self { world_from_leader: UnitQuaternion::identity(), scale: 1.0 }
    }
}

impl MotionMapping {
    /// Creates the mapping `world_from_view * view_from_leader`; `scale` is the tip's travel per travel of the hand.
    ///
    /// # Errors
    /// [`MotionMappingError`] if a rotation is not finite or the scale is not within [`SCALE`].
    pub fn new(
        world_from_view: &UnitQuaternion<f64>,
        view_from_leader: &UnitQuaternion<f64>,
        scale: f64,
    ) -> Result<Self, MotionMappingError> {
        let product = world_from_view.into_inner() * view_from_leader.into_inner();
        let world_from_leader = UnitQuaternion::try_new(product, 1e-6).ok_or(MotionMappingError::Rotation)?;
        if !world_from_leader.coords.iter().all(|x| x.is_finite()) {
            return Err(MotionMappingError::Rotation);
        }
        if !SCALE.contains(scale) {
            return Err(MotionMappingError::Scale { scale });
        }
        Ok(Self { world_from_leader, scale })
    }

    /// Returns the mapping with another scale.
    ///
    /// # Errors
    /// [`MotionMappingError`] if the scale is not within [`SCALE`].
    pub fn scaled(&self, scale: f64) -> Result<Self, MotionMappingError> {
        if SCALE.contains(scale) { Ok(Self { scale, ..*self }) } else { Err(MotionMappingError::Scale { scale }) }
    }

    /// Returns the rotation from the leader's frame to `world`.
    pub const fn world_from_leader(&self) -> &UnitQuaternion<f64> {
        &self.world_from_leader
    }

    /// Returns the tip's travel per travel of the hand.
    pub const fn scale(&self) -> f64 {
        self.scale
    }

    /// Returns the displacement of the tip (m, `world`) for a displacement of the hand (m, `leader`).
    pub fn to_tip(&self, hand_m: &Vector3<f64>) -> Vector3<f64> {
        self.world_from_leader * hand_m * self.scale
    }

    /// Returns a force at the tip (N, `world`) in the leader's frame. Forces are not scaled here; the gates apply the
    /// gain.
    pub fn force_to_hand(&self, tip_n: &Vector3<f64>) -> Vector3<f64> {
        self.world_from_leader.inverse() * tip_n
    }
}

/// Pose of the hand measured by its device, in the leader's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandPose {
    /// Position in the leader's frame, m.
    pub position_m: Vector3<f64>,
    /// Orientation; `None` if the device has no wrist.
    pub orientation: Option<UnitQuaternion<f64>>,
}

impl HandPose {
    /// Creates a hand on a device without a wrist.
    pub const fn at(position_m: Vector3<f64>) -> Self {
        Self { position_m, orientation: None }
    }

    pub fn is_finite(&self) -> bool {
        self.position_m.iter().all(|x| x.is_finite())
            && self.orientation.is_none_or(|q| q.coords.iter().all(|x| x.is_finite()))
    }
}

/// Commanded pose of the tip, in `world`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipTarget {
    pub tip_m: Vector3<f64>,
    pub world_from_jaws: UnitQuaternion<f64>,
}

#[derive(Clone, Copy, Debug)]
pub struct HandEyeCoupling {
    mapping: MotionMapping,
    target: TipTarget,
    /// The hand's pose in the previous step; `None` while not coupled.
    hand: Option<HandPose>,
    engaged: bool,
}

impl HandEyeCoupling {
    /// Creates an uncoupled state in which the tip holds `target`.
    pub const fn new(mapping: MotionMapping, target: TipTarget) -> Self {
        Self { mapping, target, hand: None, engaged: false }
    }

    pub const fn mapping(&self) -> &MotionMapping {
        &self.mapping
    }

    /// Changes the mapping (for example, when the endoscope moved or the scale changed); it applies to motion from now
    /// on.
    pub const fn set_mapping(&mut self, mapping: MotionMapping) {
        self.mapping = mapping;
    }

    /// Couples the hand to the tip from the next step on. `target` is the current command to the tip.
    pub const fn engage(&mut self, target: TipTarget) {
        self.target = target;
        self.hand = None;
        self.engaged = true;
    }

    pub const fn release(&mut self) {
        self.engaged = false;
        self.hand = None;
    }

    pub const fn is_engaged(&self) -> bool {
        self.engaged
    }

    /// Updates the hand's pose and returns the command to the tip.
    pub fn step(&mut self, hand: &HandPose) -> TipTarget {
        if !self.engaged || !hand.is_finite() {
            return self.target;
        }
        if let Some(before) = self.hand {
            self.target.tip_m += self.mapping.to_tip(&(hand.position_m - before.position_m));
            if let (Some(now), Some(then)) = (hand.orientation, before.orientation) {
                let world_from_leader = self.mapping.world_from_leader;
                let turn = world_from_leader * (now * then.inverse()) * world_from_leader.inverse();
                // Renormalised, because rounding errors of many small rotations accumulate.
                self.target.world_from_jaws =
                    UnitQuaternion::new_normalize((turn * self.target.world_from_jaws).into_inner());
            }
        }
        self.hand = Some(*hand);
        self.target
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frames::from_roll_pitch_yaw_deg;

    fn hand(x: f64, y: f64, z: f64) -> HandPose {
        HandPose { position_m: Vector3::new(x, y, z), orientation: None }
    }

    fn target() -> TipTarget {
        TipTarget {
            tip_m: Vector3::new(0.4, 0.0, -0.1),
            world_from_jaws: from_roll_pitch_yaw_deg(&Vector3::new(180.0, 0.0, 20.0)),
        }
    }

    /// Returns the orientation of an endoscope that looks straight down; the right of its image is the base's -y.
    fn looking_down() -> UnitQuaternion<f64> {
        let columns = [-Vector3::y(), -Vector3::x(), -Vector3::z()];
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_basis_unchecked(&columns))
    }

    fn hand_eye(scale: f64) -> HandEyeCoupling {
        HandEyeCoupling::new(MotionMapping::new(&looking_down(), &view_from_omega(), scale).unwrap(), target())
    }

    #[test]
    fn the_hand_moves_the_tip_the_same_way_in_the_picture() {
        let view = view_from_omega();
        let right_up_away = [Vector3::y(), Vector3::z(), -Vector3::x()];
        let in_the_picture = [Vector3::x(), -Vector3::y(), Vector3::z()];
        for (hand, image) in right_up_away.iter().zip(in_the_picture) {
            assert!((view * hand - image).norm() < 1e-12, "{hand}");
        }
        let mut hand_eye = hand_eye(0.5);
        hand_eye.engage(target());
        hand_eye.step(&hand(0.0, 0.0, 0.0));
        let tip_m = hand_eye.step(&hand(-0.02, 0.04, 0.0)).tip_m;
        // 40 mm to the right and 20 mm away, halved: the base's -y, and down into the image.
        assert!((tip_m - target().tip_m - Vector3::new(0.0, -0.02, -0.01)).norm() < 1e-12, "{tip_m}");
    }

    #[test]
    fn the_tracker_gives_the_same_view_as_the_rig_file() {
        let turn = |x, y, z| from_roll_pitch_yaw_deg(&Vector3::new(x, y, z));
        let [world_from_m, world_from_c, n_from_view] =
            [turn(10.0, 40.0, -70.0), turn(-100.0, 5.0, 33.0), turn(0.0, 30.0, 4.0)];
        let c_from_m = world_from_c.inverse() * world_from_m;
        let c_from_n = world_from_c.inverse() * looking_down() * n_from_view.inverse();
        let seen = world_from_tracked_view(&world_from_m, &c_from_m.inverse(), &(c_from_n * n_from_view));
        assert!(seen.angle_to(&looking_down()) < 1e-12);
    }

    #[test]
    fn clutch_and_new_mappings_never_move_the_tip() {
        let mut hand_eye = hand_eye(0.4);
        assert_eq!(hand_eye.step(&hand(0.5, 0.5, 0.5)), target(), "released");
        hand_eye.engage(target());
        assert_eq!(hand_eye.step(&hand(0.03, -0.02, 0.05)), target(), "engaged wherever the hand is");
        let moved = hand_eye.step(&hand(0.03, -0.01, 0.05));
        assert!((moved.tip_m - target().tip_m).norm() > 3e-3);
        hand_eye.set_mapping(MotionMapping::new(&UnitQuaternion::identity(), &view_from_omega(), 2.0).unwrap());
        assert_eq!(hand_eye.step(&hand(0.03, -0.01, 0.05)), moved, "a new mapping at rest");
        hand_eye.release();
        assert_eq!(hand_eye.step(&hand(-0.2, 0.1, 0.0)), moved, "released again");
        hand_eye.engage(moved);
        assert_eq!(hand_eye.step(&hand(-0.2, 0.1, 0.0)), moved, "engaged elsewhere");
    }

    #[test]
    fn a_turn_of_the_hand_is_the_same_turn_in_the_picture() {
        let mut hand_eye = hand_eye(0.4);
        hand_eye.engage(target());
        let start = from_roll_pitch_yaw_deg(&Vector3::new(5.0, 10.0, 15.0));
        let turned = UnitQuaternion::from_scaled_axis(-Vector3::x() * 0.3) * start;
        let held = hand(0.0, 0.0, 0.0);
        hand_eye.step(&HandPose { orientation: Some(start), ..held });
        let jaws = hand_eye.step(&HandPose { orientation: Some(turned), ..held });
        // A rotation about the line of sight (away from the user) becomes one about the image's z axis, which is the
        // base's -z.
        let expected = UnitQuaternion::from_scaled_axis(-Vector3::z() * 0.3) * target().world_from_jaws;
        assert!(jaws.world_from_jaws.angle_to(&expected) < 1e-12);
        assert_eq!(jaws.tip_m, target().tip_m);
    }

    #[test]
    fn a_force_goes_back_the_way_the_motion_came() {
        let hand_eye = hand_eye(0.4);
        let motion = Vector3::new(0.01, -0.02, 0.03);
        let tip_n = hand_eye.mapping().to_tip(&motion) * -50.0;
        let hand_n = hand_eye.mapping().force_to_hand(&tip_n);
        assert!(
            (hand_n.normalize() + motion.normalize()).norm() < 1e-12 && (hand_n.norm() - tip_n.norm()).abs() < 1e-12
        );
    }

    #[test]
    fn what_is_not_finite_moves_nothing_and_makes_no_mapping() {
        let mut hand_eye = hand_eye(1.0);
        hand_eye.engage(target());
        hand_eye.step(&hand(0.0, 0.0, 0.0));
        assert_eq!(hand_eye.step(&hand(f64::NAN, 0.0, 0.0)), target());
        let identity = UnitQuaternion::identity();
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY, 6.0] {
            assert!(matches!(MotionMapping::new(&identity, &identity, scale), Err(MotionMappingError::Scale { .. })));
        }
        let broken = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(f64::NAN, 0.0, 0.0, 0.0));
        assert_eq!(MotionMapping::new(&broken, &identity, 1.0), Err(MotionMappingError::Rotation));
    }
}
