//! The pose of a marker on the camera, as read by a tracker, without the tracker's noise.

use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};

/// Readings farther than this from the newest one, m and rad, are from before a motion.
const MOVED_M: f64 = 0.002;
const MOVED_RAD: f64 = 0.012;

/// Returns the noise-free mean of a pose's readings, the newest first, as far back as the pose has not changed.
pub fn steadied(mut newest_first: impl Iterator<Item = Isometry3<f64>>) -> Option<Isometry3<f64>> {
    let newest = newest_first.next()?;
    let is_here = |pose: &Isometry3<f64>| {
        (pose.translation.vector - newest.translation.vector).norm() <= MOVED_M
            && pose.rotation.angle_to(&newest.rotation) <= MOVED_RAD
    };
    let mut count = 1.0;
    let mut sum_m = newest.translation.vector;
    let mut sum = newest.rotation.into_inner();
    for pose in newest_first.take_while(is_here) {
        count += 1.0;
        sum_m += pose.translation.vector;
        // Two quaternions represent each rotation.
        let turn: Quaternion<f64> = pose.rotation.into_inner();
        sum += if turn.dot(&newest.rotation) < 0.0 { -turn } else { turn };
    }
    let mean_m: Vector3<f64> = sum_m / count;
    Some(Isometry3::from_parts(mean_m.into(), UnitQuaternion::new_normalize(sum)))
}

#[cfg(test)]
mod tests {
    use nima_core::noise::Noise;

    use super::*;

    fn reading(noise: &mut Noise, position_m: Vector3<f64>) -> Isometry3<f64> {
        let mut white = |sd: f64| Vector3::from_fn(|_, _| sd * noise.gaussian());
        let miss_m = white(0.000_25);
        let turn = UnitQuaternion::from_scaled_axis(white(0.001));
        let pose = Isometry3::from_parts(
            (position_m + miss_m).into(),
            turn * UnitQuaternion::from_euler_angles(2.0, 0.5, 3.0),
        );
        // Uses the other quaternion of the same rotation from time to time.
        let flipped = UnitQuaternion::new_unchecked(-pose.rotation.into_inner());
        if noise.gaussian() > 0.0 { Isometry3::from_parts(pose.translation, flipped) } else { pose }
    }

    #[test]
    fn noise_is_averaged_and_a_motion_is_followed_at_once() {
        let mut noise = Noise::new(7);
        let rest_m = Vector3::new(0.1, -0.2, 0.3);
        let mut kept: Vec<_> = (0..60).map(|_| reading(&mut noise, rest_m)).collect();
        let steady = steadied(kept.iter().rev().copied()).unwrap();
        assert!((steady.translation.vector - rest_m).norm() < 0.000_2, "{steady}");
        assert!(steady.rotation.angle_to(&UnitQuaternion::from_euler_angles(2.0, 0.5, 3.0)) < 0.000_8, "{steady}");
        let there_m = rest_m + Vector3::new(0.01, 0.0, 0.0);
        kept.extend((0..3).map(|_| reading(&mut noise, there_m)));
        let moved = steadied(kept.iter().rev().copied()).unwrap();
        assert!((moved.translation.vector - there_m).norm() < 0.001, "{moved}");
        assert_eq!(steadied(std::iter::empty()), None);
    }
}
