//! Where an endoscope looks, and how its lens bends the picture: a pinhole with one coefficient of radial distortion (Brown 1966).
//!
//! The camera's frame: x to the right of the picture, y down, z away from the lens, m. Pixels are counted from the upper left corner.

use nalgebra::{Isometry3, Vector2, Vector3};

/// A thing must be so far in front of the lens, m.
const NEAREST_M: f64 = 1e-4;
/// Steps of Newton's method; four are enough for what a lens does.
const STEPS: usize = 12;
/// An angle beyond which no lens of this kind sees: 75 degrees from the axis.
const TANGENT_MOST: f64 = 3.8;

/// A lens and the picture behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Width and height of the picture, px.
    pub size_px: [usize; 2],
    /// Focal length, px.
    pub focal_px: f64,
    /// Where the lens's axis meets the picture, px.
    pub centre_px: Vector2<f64>,
    /// Radial distortion: the tangent of the angle from the axis, `t`, is seen at `t (1 + k1 t^2)`. Below 0 as a barrel.
    pub k1: f64,
}

impl Lens {
    /// The tangent at which the picture turns back on itself: nothing beyond has a place.
    fn tangent_most(&self) -> f64 {
        let turns = if self.k1 < 0.0 { (-1.0 / (3.0 * self.k1)).sqrt() } else { f64::INFINITY };
        turns.min(TANGENT_MOST)
    }

    /// Place in the picture of a point in the camera's frame (m), px; `None` if the lens does not see it. The place may be outside of the picture.
    pub fn project(&self, point_m: &Vector3<f64>) -> Option<Vector2<f64>> {
        let ahead = point_m.z > NEAREST_M && point_m.iter().all(|x| x.is_finite());
        let flat = ahead.then(|| point_m.xy() / point_m.z)?;
        let square = flat.norm_squared();
        let seen = square.sqrt() < self.tangent_most();
        seen.then(|| self.centre_px + flat * (self.focal_px * (1.0 + self.k1 * square)))
    }

    /// The direction of what is seen at a place of the picture (px), with z = 1; `None` where the lens sees nothing.
    pub fn direction(&self, place_px: &Vector2<f64>) -> Option<Vector3<f64>> {
        let bent = (place_px - self.centre_px) / self.focal_px;
        let far = bent.norm();
        if !far.is_finite() {
            return None;
        }
        if far < 1e-12 {
            return Some(Vector3::z());
        }
        let most = self.tangent_most();
        let mut tangent = far.min(0.999 * most);
        for _ in 0..STEPS {
            let miss = tangent * (1.0 + self.k1 * tangent * tangent) - far;
            tangent = (tangent - miss / (1.0 + 3.0 * self.k1 * tangent * tangent)).clamp(0.0, 0.999_999 * most);
        }
        let found = (tangent * (1.0 + self.k1 * tangent * tangent) - far).abs() < 1e-9 * (1.0 + far);
        found.then(|| {
            let flat = bent * (tangent / far);
            Vector3::new(flat.x, flat.y, 1.0)
        })
    }
}

/// A lens at a place of the workspace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Its lens.
    pub lens: Lens,
    /// Its place: takes a point of the camera's frame to the workspace, m.
    pub world_from_camera: Isometry3<f64>,
}

impl Camera {
    /// Place in the picture of a point of the workspace (m), px; `None` if the lens does not see it.
    pub fn project(&self, point_m: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.lens.project(&self.world_from_camera.inverse_transform_point(&(*point_m).into()).coords)
    }

    /// The line of sight through a place of the picture (px): from where, and in which direction, both in the workspace.
    pub fn sight(&self, place_px: &Vector2<f64>) -> Option<[Vector3<f64>; 2]> {
        let direction = self.lens.direction(place_px)?;
        Some([self.world_from_camera.translation.vector, self.world_from_camera.rotation * direction])
    }

    /// The camera of a second lens, so far to the right of this one (m) and otherwise alike.
    #[must_use]
    pub fn beside(mut self, right_m: f64) -> Self {
        self.world_from_camera.translation.vector += self.right() * right_m;
        self
    }

    /// The direction to the right of the picture in the workspace, unit length.
    pub fn right(&self) -> Vector3<f64> {
        self.world_from_camera.rotation * Vector3::x()
    }

    /// The direction up in the picture in the workspace, unit length.
    pub fn up(&self) -> Vector3<f64> {
        self.world_from_camera.rotation * -Vector3::y()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;
    use proptest::prelude::*;

    use super::*;

    fn lens(k1: f64) -> Lens {
        Lens { size_px: [1280, 720], focal_px: 900.0, centre_px: Vector2::new(640.0, 360.0), k1 }
    }

    #[test]
    fn right_is_right_and_down_is_down() {
        let at = |x, y| lens(0.3).project(&Vector3::new(x, y, 0.1)).unwrap();
        assert_eq!(at(0.0, 0.0), Vector2::new(640.0, 360.0));
        assert!(at(0.01, 0.0).x > 640.0 && at(0.0, 0.01).y > 360.0);
        // 1 + 0.3 x 0.1^2 times as far as without distortion.
        assert!((at(0.01, 0.0).x - 640.0 - 90.0 * 1.003).abs() < 1e-9);
        assert_eq!(lens(0.0).project(&Vector3::new(0.0, 0.0, -0.1)), None);
        assert_eq!(lens(0.0).project(&Vector3::new(f64::NAN, 0.0, 0.1)), None);
        // A barrel turns back on itself: what is far beside has no second place within the picture.
        assert_eq!(lens(-0.3).project(&Vector3::new(0.2, 0.0, 0.1)), None);
    }

    proptest! {
        #[test]
        fn a_direction_is_seen_where_it_came_from(
            x in -200.0..1480.0, y in -200.0..920.0, k1 in -0.35..0.5, turn in prop::array::uniform3(-3.0..3.0),
        ) {
            let place_px = Vector2::new(x, y);
            let rotation = UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]);
            let world_from_camera = Isometry3::from_parts(Vector3::new(0.1, -0.2, 0.3).into(), rotation);
            let camera = Camera { lens: lens(k1), world_from_camera };
            let sight = camera.sight(&place_px);
            // A barrel does not fill the corners.
            prop_assert!(sight.is_some() || k1 < -0.1);
            if let Some([from_m, direction]) = sight {
                let again_px = camera.project(&(from_m + 0.15 * direction)).unwrap();
                prop_assert!((again_px - place_px).norm() < 1e-4, "{again_px} {place_px}");
            }
        }
    }
}
