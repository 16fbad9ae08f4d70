//! Where the camera is: fixed in the workspace, or on the endoscope's marker, which the tracker sees.

use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};
use nima_core::frames::from_roll_pitch_yaw_deg;
use nima_endoscope::{Camera, Lens};
use nima_machine::config::EndoscopeCamera;
use nima_world::emulators::endoscope::{camera_of, lens_of};

/// The tracker's noise is averaged over this time, s. At the tips, some decimetres from the marker, that of a single reading can be seen.
pub(in crate::console) const STEADY_S: f64 = 0.25;
/// What is farther away from the newest reading than noise comes from before a motion, m and rad.
const MOVED_M: f64 = 0.002;
const MOVED_RAD: f64 = 0.012;

/// How the camera is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mount {
    Fixed(Camera),
    OnMarker { lens: Lens, n_from_camera: Isometry3<f64> },
}

impl Mount {
    /// As the rig file says; `None` where it does not say where the camera is.
    pub(super) fn of(settings: &EndoscopeCamera) -> Option<Self> {
        if let Some((at_m, turn_deg)) = settings.n_from_camera_m.zip(settings.n_from_camera_deg) {
            let n_from_camera = Isometry3::from_parts(at_m.into(), from_roll_pitch_yaw_deg(&turn_deg));
            return Some(Self::OnMarker { lens: lens_of(settings), n_from_camera });
        }
        settings.position_m.is_some().then(|| Self::Fixed(camera_of(settings)))
    }

    /// The camera in the workspace, with its marker there; `None` where the marker's place is not known.
    pub(super) fn camera(&self, world_from_n: Option<&Isometry3<f64>>) -> Option<Camera> {
        match self {
            Self::Fixed(camera) => Some(*camera),
            Self::OnMarker { lens, n_from_camera } => {
                Some(Camera { lens: *lens, world_from_camera: world_from_n? * n_from_camera })
            }
        }
    }
}

/// The mean of a pose's readings without noise, the newest first, as far back as it has not moved.
pub(in crate::console) fn steadied(mut newest_first: impl Iterator<Item = Isometry3<f64>>) -> Option<Isometry3<f64>> {
    let newest = newest_first.next()?;
    let is_here = |pose: &Isometry3<f64>| {
        (pose.translation.vector - newest.translation.vector).norm() <= MOVED_M
            && pose.rotation.angle_to(&newest.rotation) <= MOVED_RAD
    };
    let (mut count, mut sum_m, mut sum) = (1.0, newest.translation.vector, newest.rotation.into_inner());
    for pose in newest_first.take_while(is_here) {
        count += 1.0;
        sum_m += pose.translation.vector;
        // Two quaternions stand for each rotation.
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

    fn reading(noise: &mut Noise, at_m: Vector3<f64>) -> Isometry3<f64> {
        let mut white = |sd: f64| Vector3::from_fn(|_, _| sd * noise.gaussian());
        let (miss_m, turn) = (white(0.000_25), UnitQuaternion::from_scaled_axis(white(0.001)));
        let pose =
            Isometry3::from_parts((at_m + miss_m).into(), turn * UnitQuaternion::from_euler_angles(2.0, 0.5, 3.0));
        // The other quaternion of the same rotation, now and then.
        let flipped = UnitQuaternion::new_unchecked(-pose.rotation.into_inner());
        if noise.gaussian() > 0.0 { Isometry3::from_parts(pose.translation, flipped) } else { pose }
    }

    #[test]
    fn noise_is_averaged_and_a_motion_is_followed_at_once() {
        let (mut noise, rest_m) = (Noise::new(7), Vector3::new(0.1, -0.2, 0.3));
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

    #[test]
    fn a_camera_on_the_marker_goes_where_the_marker_goes() {
        let scene = nima_world::scene::Scene::load("bimanual").unwrap();
        let mut settings = nima_world::emulators::endoscope::usual(&scene);
        let fixed = Mount::of(&settings).unwrap().camera(None).unwrap();
        (settings.position_m, settings.world_from_camera_deg) = (None, None);
        assert_eq!(Mount::of(&settings), None);
        settings.n_from_camera_m = Some(Vector3::new(0.0, 0.01, 0.3));
        settings.n_from_camera_deg = Some(Vector3::new(0.0, 0.0, 90.0));
        let mount = Mount::of(&settings).unwrap();
        assert_eq!(mount.camera(None), None);
        let n_from_camera = Isometry3::from_parts(
            Vector3::new(0.0, 0.01, 0.3).into(),
            from_roll_pitch_yaw_deg(&Vector3::new(0.0, 0.0, 90.0)),
        );
        let world_from_n = fixed.world_from_camera * n_from_camera.inverse();
        let camera = mount.camera(Some(&world_from_n)).unwrap();
        let tip_m = Vector3::new(0.01, 0.02, 0.004);
        assert!((camera.project(&tip_m).unwrap() - fixed.project(&tip_m).unwrap()).norm() < 1e-9);
    }
}
