//! The ring that an instrument's jaws would grip or hold: a user who drives by mouse cannot feel it.

use nalgebra::{UnitQuaternion, Vector3};
use nima_session::objects::JawState;
use nima_simulation::physics::ObjectSettings;

/// Relation of a ring to the jaws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JawReach {
    /// The open jaws are above the ring: if moved straight down, they enclose its rim.
    Above(usize),
    /// Between the open jaws.
    Between(usize),
    /// Held by the jaws.
    Held(usize),
}

/// Fingers pressed apart by more than this force hold an object, N.
const HELD_N: f64 = 0.2;
/// Jaws open less than this cannot grip, rad.
const OPEN_RAD: f64 = 0.4;
/// Maximum distance of a rim from the plane of the fingers, and above the tip, m.
const BESIDE_M: f64 = 0.0015;
const DEEP_M: std::ops::RangeInclusive<f64> = -0.0005..=0.006;
/// Maximum component of the rim's direction across the fingers' plane: jaws parallel to a rim close next to it.
const ALONG_MAX: f64 = 0.5;
/// Maximum apparent distance of jaws from the rim that they hold, m: ring and jaws are reported some milliseconds after the
/// tip.
const HELD_OFF_M: f64 = 0.004;

impl JawReach {
    pub(super) const fn ring(self) -> usize {
        match self {
            Self::Above(ring) | Self::Between(ring) | Self::Held(ring) => ring,
        }
    }

    /// Returns the reach of jaws at this tip (m, `world`), which open along x, among these rings.
    pub(super) fn of(
        setting: &ObjectSettings,
        rings: &[(Vector3<f32>, UnitQuaternion<f32>)],
        tip_m: &Vector3<f64>,
        jaws: &JawState,
    ) -> Option<Self> {
        let [touches_ring, ..] = jaws.touched;
        let rims = rings.iter().enumerate().filter_map(|(i, ring)| Some((i, Rim::nearest(setting, ring, tip_m)?)));
        if touches_ring && jaws.opens_n > HELD_N {
            let held = rims.map(|(i, rim)| (i, rim.off_m())).min_by(|one, other| one.1.total_cmp(&other.1));
            return held.filter(|(_, off_m)| *off_m < HELD_OFF_M).map(|(i, _)| Self::Held(i));
        }
        let fits = rims.filter(|(_, rim)| jaws.opening_rad > OPEN_RAD && rim.fits(setting, jaws.opening_rad));
        // The topmost ring below the jaws.
        let (i, rim) = fits
            .filter(|(_, rim)| rim.from_tip_m.z <= *DEEP_M.end())
            .max_by(|one, other| one.1.from_tip_m.z.total_cmp(&other.1.from_tip_m.z))?;
        Some(if DEEP_M.contains(&rim.from_tip_m.z) { Self::Between(i) } else { Self::Above(i) })
    }
}

/// The point of a ring nearest to the jaws, seen from above.
struct Rim {
    from_tip_m: Vector3<f64>,
    /// Direction of the rim there.
    along: Vector3<f64>,
}

impl Rim {
    fn nearest(
        setting: &ObjectSettings,
        (middle_m, turn): &(Vector3<f32>, UnitQuaternion<f32>),
        tip_m: &Vector3<f64>,
    ) -> Option<Self> {
        let middle_m: Vector3<f64> = middle_m.cast();
        let axis = turn.cast::<f64>() * Vector3::z();
        let level_m = Vector3::new(tip_m.x, tip_m.y, middle_m.z) - middle_m;
        let out = (level_m - axis * axis.dot(&level_m)).try_normalize(1e-5)?;
        let from_tip_m = middle_m + out * setting.ring.major_radius_m - tip_m;
        Some(Self { from_tip_m, along: axis.cross(&out) })
    }

    /// Returns whether it fits between fingers that are lowered straight down.
    fn fits(&self, setting: &ObjectSettings, opening_rad: f64) -> bool {
        let inside_m = setting.jaws.finger_length_m * (0.5 * opening_rad).sin();
        let room_m = inside_m - setting.ring.tube_radius_m;
        self.from_tip_m.x.abs() <= room_m && self.from_tip_m.y.abs() <= BESIDE_M && self.along.x.abs() <= ALONG_MAX
    }

    fn off_m(&self) -> f64 {
        let beyond_m = self.from_tip_m.z - self.from_tip_m.z.clamp(*DEEP_M.start(), *DEEP_M.end());
        Vector3::new(self.from_tip_m.x, self.from_tip_m.y, beyond_m).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPEN: JawState = JawState {
        opening_rad: 0.6,
        opens_n: 0.0,
        force_n: Vector3::new(0.0, 0.0, 0.0),
        torque_nm: Vector3::new(0.0, 0.0, 0.0),
        touched: [false; 4],
    };

    fn reach(tip_m: [f64; 3], jaws: &JawState) -> Option<JawReach> {
        let setting = ObjectSettings::default();
        let flat = UnitQuaternion::identity();
        let rings = [(Vector3::new(-0.019, 0.0, 0.00175), flat), (Vector3::new(-0.045, 0.0, 0.00175), flat)];
        JawReach::of(&setting, &rings, &tip_m.into(), jaws)
    }

    #[test]
    fn open_jaws_reach_a_rim_that_fits_between_them_and_no_other() {
        let rim_m = -0.019 - 0.00725;
        assert_eq!(reach([rim_m, 0.0, 0.030], &OPEN), Some(JawReach::Above(0)));
        assert_eq!(reach([rim_m, 0.0, 0.001], &OPEN), Some(JawReach::Between(0)));
        assert_eq!(reach([-0.045 + 0.00725, 0.0, 0.001], &OPEN), Some(JawReach::Between(1)), "the inner side too");
        assert_eq!(reach([rim_m + 0.002, 0.0, 0.030], &OPEN), None, "a finger would come down on it");
        assert_eq!(reach([-0.019, 0.00725, 0.030], &OPEN), None, "there the rim runs from finger to finger");
        assert_eq!(reach([rim_m, 0.0, 0.030], &JawState { opening_rad: 0.1, ..OPEN }), None, "closed");
        assert_eq!(reach([rim_m, 0.0, -0.020], &OPEN), None, "below it");
    }

    #[test]
    fn jaws_hold_what_presses_them_apart() {
        let holds = JawState { opening_rad: 0.35, opens_n: 2.5, touched: [true, false, false, false], ..OPEN };
        let rim_m = [-0.019 - 0.00725, 0.0, 0.001];
        assert_eq!(reach(rim_m, &holds), Some(JawReach::Held(0)));
        assert_eq!(reach(rim_m, &JawState { touched: [false, true, false, false], ..holds }), None, "a peg");
        assert_eq!(reach(rim_m, &JawState { opens_n: 0.0, ..holds }), None, "it only touches");
    }
}
