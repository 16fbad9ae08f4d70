//! Reasons why an arm that delivers data cannot be engaged from its position, and detection of swapped sides by the
//! rig's geometry: the other arm's mount, trocar or marker fits where its own does not.

use nalgebra::Isometry3;
use nima_core::kinematics::{Arm, ArmStartError, Joints, Rcm, START_MISS_M};

/// Reason why an arm that delivers data cannot be engaged.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum EngageBlocker {
    /// The arm cannot start from its current position.
    #[error(transparent)]
    Start(#[from] ArmStartError),
    /// A device has not reported yet, so it is unknown whether it belongs to this side.
    #[error("{}", .0.words())]
    Waiting(AwaitedDevice),
    #[error("{}", .0.words())]
    Exchanged(SideSwap),
    /// The handles of both sides report one serial number.
    #[error("the right and left handles are one device: both report the same serial number")]
    OneHandle,
    #[error("the right and left arms are one device: both report the same serial number")]
    OneArm,
    #[error("two of the sensors are one device: both report the same serial number")]
    OneSensor,
    /// An obstacle at the other end of a network, where the screen shows what it is.
    #[error("the follower's machine refuses to engage; its screen shows the reason")]
    FarEnd,
}

/// A device outside the force path that must have reported its side before an engagement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AwaitedDevice {
    /// The servos, until they are open or known to be missing.
    Servos,
    /// The markers by which the tracker joins hand and tip.
    Markers,
}

impl AwaitedDevice {
    const fn words(self) -> &'static str {
        match self {
            Self::Servos => "the servos have not responded yet",
            Self::Markers => "the tracker has not seen the markers of both instruments yet",
        }
    }
}

/// The devices that are swapped between right and left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SideSwap {
    /// The other handle moves than the requested one.
    Handles,
    /// The arms or their mounts.
    Arms,
    Sensors,
    Servos,
    Markers,
    Trocars,
}

impl SideSwap {
    /// Returns the swapped devices, as a clause without a full stop.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Handles => "the right and left handles are swapped",
            Self::Arms => "the right and left arms, or their mounts in the rig file, are swapped",
            Self::Sensors => "the right and left sensors are swapped",
            Self::Servos => "the servos of the right and left instruments are swapped",
            Self::Markers => "the markers of the right and left instruments are swapped",
            Self::Trocars => "the right and left trocars are swapped, or each instrument is in the other's trocar",
        }
    }
}

/// Expected pose of a marker relative to the arm, from the hand-eye calibration.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExpectedMarker {
    pub(super) s1_from_m: Isometry3<f64>,
    pub(super) base_from_c: Isometry3<f64>,
}

/// Current pose of an arm and its marker.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArmAndMarker {
    pub(super) mount: Arm,
    pub(super) rcm: Rcm,
    pub(super) joints: Joints,
    pub(super) base_from_s1: Isometry3<f64>,
    pub(super) hand_eye: Option<ExpectedMarker>,
    pub(super) c_from_m: Option<Isometry3<f64>>,
}

/// A marker is at its expected pose within this distance (m, rad).
/// Above the errors of a calibrated marker (millimetres, a degree), below the distance of two instruments.
const NEAR: (f64, f64) = (0.020, 0.15);
/// A marker beyond this distance (m, rad) is certainly not at its expected pose.
/// Between [`NEAR`] and this the marker may simply have slipped, which is not a swap.
const FAR: (f64, f64) = (0.050, 0.35);

impl ArmAndMarker {
    /// Returns the device that is swapped with the other arm's, if the current poses contradict the arm's own settings
    /// and match the other arm's.
    pub(super) fn exchange(&self, other: &Self) -> Option<SideSwap> {
        self.exchanged_place(other).or_else(|| self.exchanged_marker(other))
    }

    /// Returns whether the marker has an expected pose and is visible.
    pub(super) const fn is_marked(&self) -> bool {
        self.hand_eye.is_none() || self.c_from_m.is_some()
    }

    fn exchanged_place(&self, other: &Self) -> Option<SideSwap> {
        let passes = |mount: &Arm, rcm: &Rcm| {
            let pose = mount.pose(&self.joints);
            let trocar_m = &rcm.settings().trocar_m;
            pose.axis_miss_m(trocar_m).norm() <= START_MISS_M && pose.insertion_m(trocar_m) > 0.0
        };
        if passes(&self.mount, &self.rcm) {
            return None;
        }
        let by_mount = passes(&other.mount, &self.rcm) || passes(&other.mount, &other.rcm);
        let by_trocar = || passes(&self.mount, &other.rcm).then_some(SideSwap::Trocars);
        by_mount.then_some(SideSwap::Arms).or_else(by_trocar)
    }

    fn exchanged_marker(&self, other: &Self) -> Option<SideSwap> {
        let own = self.hand_eye?;
        let others = other.hand_eye?;
        let seen = self.c_from_m?;
        let others_seen = other.c_from_m?;
        let off = |hand_eye: ExpectedMarker, seen: &Isometry3<f64>| {
            let c_from_m = hand_eye.base_from_c.inverse() * self.base_from_s1 * hand_eye.s1_from_m;
            let place_m = (c_from_m.translation.vector - seen.translation.vector).norm();
            (place_m, c_from_m.rotation.angle_to(&seen.rotation))
        };
        let is_near = |(place_m, turn_rad): (f64, f64)| place_m <= NEAR.0 && turn_rad <= NEAR.1;
        let is_far = |(place_m, turn_rad): (f64, f64)| place_m > FAR.0 || turn_rad > FAR.1;
        if !is_far(off(own, &seen)) {
            return None;
        }
        let marker = ExpectedMarker { s1_from_m: others.s1_from_m, ..own };
        let camera = ExpectedMarker { base_from_c: others.base_from_c, ..own };
        let by_file = [marker, camera, others].into_iter().any(|hand_eye| is_near(off(hand_eye, &seen)));
        (by_file || is_near(off(own, &others_seen))).then_some(SideSwap::Markers)
    }
}
