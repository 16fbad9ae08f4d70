//! Pose and lens of an endoscope camera: a pinhole with radial and tangential distortion (Brown 1966), the first four
//! coefficients of the usual model (`OpenCV`).
//!
//! The camera's frame: x to the right of the image, y down, z away from the lens, m. Pixels are counted from the upper
//! left corner.

use nalgebra::{Isometry3, Matrix2, Vector2, Vector3};

/// Minimum distance of a visible point from the lens, m.
const NEAREST_M: f64 = 1e-4;
/// Steps of Newton's method; four are enough for the distortion of real lenses.
const STEPS: usize = 12;
/// Tangent of the largest angle that a lens of this kind can see: 75 degrees from the axis.
const TANGENT_MAX: f64 = 3.8;

/// A lens and its image size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Width and height of the image, px.
    pub size_px: [usize; 2],
    /// Horizontal and vertical focal lengths, px; equal if pixels are square.
    pub focal_px: Vector2<f64>,
    /// Intersection of the lens's axis with the image, px.
    pub centre_px: Vector2<f64>,
    pub bend: Bend,
}

/// Distortion: maps a direction to the one at which it appears, both with z = 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bend {
    /// Radial: the tangent of the angle from the axis, `t`, appears at `t (1 + k1 t^2 + k2 t^4)`. Negative for barrel
    /// distortion.
    pub k1: f64,
    /// Next radial term.
    pub k2: f64,
    /// Tangential, of a lens that is not parallel to the sensor.
    pub p1: f64,
    /// Tangential, in the other direction.
    pub p2: f64,
}

impl Bend {
    /// Creates a lens with radial distortion of one coefficient.
    pub const fn radial(k1: f64) -> Self {
        Self { k1, k2: 0.0, p1: 0.0, p2: 0.0 }
    }

    /// Returns where a direction appears.
    pub fn at(&self, flat: &Vector2<f64>) -> Vector2<f64> {
        let Self { p1, p2, .. } = *self;
        let square = flat.norm_squared();
        let [x, y] = [flat.x, flat.y];
        let cross = 2.0 * x * y;
        let tangential =
            Vector2::new(p1 * cross + p2 * (square + 2.0 * x * x), p2 * cross + p1 * (square + 2.0 * y * y));
        flat * self.radially(square) + tangential
    }

    /// Returns the derivative of that position by the direction.
    pub fn slope(&self, flat: &Vector2<f64>) -> Matrix2<f64> {
        let Self { k1, k2, p1, p2 } = *self;
        let square = flat.norm_squared();
        let [x, y] = [flat.x, flat.y];
        let radially = self.radially(square);
        let more = 2.0 * k1 + 4.0 * k2 * square;
        let across = x * y * more + 2.0 * (p1 * x + p2 * y);
        Matrix2::new(
            radially + x * x * more + 2.0 * p1 * y + 6.0 * p2 * x,
            across,
            across,
            radially + y * y * more + 6.0 * p1 * y + 2.0 * p2 * x,
        )
    }

    fn radially(&self, square: f64) -> f64 {
        1.0 + square * (self.k1 + square * self.k2)
    }

    /// Returns the tangent at which the image folds back on itself: directions beyond it are not visible.
    pub fn tangent_max(&self) -> f64 {
        // The first zero of 1 + 3 k1 t^2 + 5 k2 t^4.
        let half = 3.0 * self.k1;
        let discriminant = 9.0 * self.k1 * self.k1 - 20.0 * self.k2;
        if discriminant < 0.0 {
            return TANGENT_MAX;
        }
        let squares = [2.0 / (-half + discriminant.sqrt()), 2.0 / (-half - discriminant.sqrt())];
        let turns = squares.into_iter().filter(|square| *square > 0.0).fold(f64::INFINITY, f64::min);
        turns.sqrt().min(TANGENT_MAX)
    }

    /// Returns the direction that appears at `bent`; `None` if no direction does.
    fn straightened(&self, bent: &Vector2<f64>) -> Option<Vector2<f64>> {
        let far = bent.norm();
        if !far.is_finite() {
            return None;
        }
        if far < 1e-12 && self.p1 == 0.0 && self.p2 == 0.0 {
            return Some(*bent);
        }
        let max = self.tangent_max();
        let mut tangent = far.min(0.999 * max);
        for _ in 0..STEPS {
            let square = tangent * tangent;
            let miss = tangent * self.radially(square) - far;
            let slope = 1.0 + square * (3.0 * self.k1 + 5.0 * self.k2 * square);
            tangent = (tangent - miss / slope).clamp(0.0, 0.999_999 * max);
        }
        let mut flat = bent * (tangent / far.max(1e-12));
        if self.p1 != 0.0 || self.p2 != 0.0 {
            for _ in 0..STEPS {
                flat -= self.slope(&flat).try_inverse()? * (self.at(&flat) - bent);
            }
        }
        let found = (self.at(&flat) - bent).norm() < 1e-9 * (1.0 + far) && flat.norm() < max;
        found.then_some(flat)
    }
}

impl Lens {
    /// Creates a lens with square pixels whose axis passes through the middle of the image.
    pub fn simple(size_px: [usize; 2], focal_px: f64, k1: f64) -> Self {
        let centre_px = Vector2::from(size_px.map(|side| 0.5 * side as f64));
        Self { size_px, focal_px: Vector2::repeat(focal_px), centre_px, bend: Bend::radial(k1) }
    }

    /// Projects a point of the camera's frame (m) into the image, px; `None` if the lens does not see it. The result
    /// may be outside the image.
    pub fn project(&self, point_m: &Vector3<f64>) -> Option<Vector2<f64>> {
        let ahead = point_m.z > NEAREST_M && point_m.iter().all(|x| x.is_finite());
        let flat = ahead.then(|| point_m.xy() / point_m.z)?;
        let seen = flat.norm() < self.bend.tangent_max();
        seen.then(|| self.centre_px + self.bend.at(&flat).component_mul(&self.focal_px))
    }

    /// Returns the direction, with z = 1, that appears at a position of the image (px); `None` where the lens sees
    /// nothing.
    pub fn direction(&self, place_px: &Vector2<f64>) -> Option<Vector3<f64>> {
        let bent = (place_px - self.centre_px).component_div(&self.focal_px);
        self.bend.straightened(&bent).map(|flat| flat.push(1.0))
    }
}

/// A lens at a pose in the workspace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub lens: Lens,
    /// Pose: maps a point of the camera's frame to the workspace, m.
    pub world_from_camera: Isometry3<f64>,
}

impl Camera {
    /// Projects a point of the workspace (m) into the image, px; `None` if the lens does not see it.
    pub fn project(&self, point_m: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.lens.project(&self.world_from_camera.inverse_transform_point(&(*point_m).into()).coords)
    }

    /// Returns the line of sight through a position of the image (px): its origin and its direction, both in the
    /// workspace.
    pub fn sight(&self, place_px: &Vector2<f64>) -> Option<[Vector3<f64>; 2]> {
        let direction = self.lens.direction(place_px)?;
        Some([self.world_from_camera.translation.vector, self.world_from_camera.rotation * direction])
    }

    /// Returns the camera of a second, identical lens at this distance to the right (m).
    #[must_use]
    pub fn beside(mut self, right_m: f64) -> Self {
        self.world_from_camera.translation.vector += self.right() * right_m;
        self
    }

    /// Returns the direction to the right of the image in the workspace, unit length.
    pub fn right(&self) -> Vector3<f64> {
        self.world_from_camera.rotation * Vector3::x()
    }

    /// Returns the upward direction of the image in the workspace, unit length.
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
        Lens::simple([1280, 720], 900.0, k1)
    }

    #[test]
    fn right_is_right_and_down_is_down() {
        let at = |x, y| lens(0.3).project(&Vector3::new(x, y, 0.1)).unwrap();
        assert_eq!(at(0.0, 0.0), Vector2::new(640.0, 360.0));
        assert!(at(0.01, 0.0).x > 640.0 && at(0.0, 0.01).y > 360.0);
        // Farther out by the factor 1 + 0.3 x 0.1^2 than without distortion.
        assert!((at(0.01, 0.0).x - 640.0 - 90.0 * 1.003).abs() < 1e-9);
        assert_eq!(lens(0.0).project(&Vector3::new(0.0, 0.0, -0.1)), None);
        assert_eq!(lens(0.0).project(&Vector3::new(f64::NAN, 0.0, 0.1)), None);
        // Barrel distortion folds back on itself: a point far to the side must not appear again within the image.
        assert_eq!(lens(-0.3).project(&Vector3::new(0.2, 0.0, 0.1)), None);
    }

    #[test]
    fn the_slope_is_that_of_the_bend() {
        let bend = Bend { k1: -0.3, k2: 0.08, p1: 0.003, p2: -0.002 };
        let flat = Vector2::new(0.4, -0.3);
        let slope = bend.slope(&flat);
        for axis in 0..2 {
            let mut step = Vector2::zeros();
            step[axis] = 1e-6;
            let measured = (bend.at(&(flat + step)) - bend.at(&(flat - step))) / 2e-6;
            assert!((measured - slope.column(axis)).norm() < 1e-8, "{axis}: {measured} {slope}");
        }
    }

    #[test]
    fn every_term_bends_a_direction_and_it_is_found_again() {
        let bend = Bend { k1: -0.25, k2: 0.06, p1: 0.004, p2: -0.003 };
        let lens = Lens { focal_px: Vector2::new(900.0, 880.0), bend, ..lens(0.0) };
        for place in [[640.0, 360.0], [10.0, 20.0], [1270.0, 700.0], [300.0, 650.0]] {
            let place_px = Vector2::from(place);
            let again_px = lens.project(&(lens.direction(&place_px).unwrap() * 0.2)).unwrap();
            assert!((again_px - place_px).norm() < 1e-6, "{again_px} {place_px}");
        }
        // Swapping x and y swaps the roles of p1 and p2.
        let other = Bend { p1: bend.p2, p2: bend.p1, ..bend };
        let flat = Vector2::new(0.3, 0.1);
        assert!((bend.at(&flat).yx() - other.at(&flat.yx())).norm() < 1e-15);
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
            // Strong barrel distortion does not fill the corners.
            prop_assert!(sight.is_some() || k1 < -0.1);
            if let Some([from_m, direction]) = sight {
                let again_px = camera.project(&(from_m + 0.15 * direction)).unwrap();
                prop_assert!((again_px - place_px).norm() < 1e-4, "{again_px} {place_px}");
            }
        }
    }
}
