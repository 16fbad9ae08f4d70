//! The way of a released handle, which the field shows.

use nalgebra::Vector3;

/// Distance between two points of a trail, m, and their largest number.
const TRAIL_STEP_M: f64 = 0.5e-3;
const TRAIL_POINTS: usize = 128;

/// The way of a released handle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReleaseTrail {
    points_m: [Vector3<f64>; TRAIL_POINTS],
    count: usize,
}

impl Default for ReleaseTrail {
    fn default() -> Self {
        Self { points_m: [Vector3::zeros(); TRAIL_POINTS], count: 0 }
    }
}

impl ReleaseTrail {
    /// Returns the points of the trail, m, from the release on.
    pub fn points_m(&self) -> &[Vector3<f64>] {
        &self.points_m[..self.count]
    }

    /// Returns the largest distance from the place of the release, m.
    pub fn travel_m(&self) -> f64 {
        let points_m = self.points_m();
        points_m.iter().map(|point_m| (point_m - points_m[0]).norm()).fold(0.0, f64::max)
    }

    /// Adds a point, m, unless the trail is full or the point is too near to the last one.
    pub fn add(&mut self, point_m: Vector3<f64>) {
        let is_apart = |last_m: &Vector3<f64>| (last_m - point_m).norm() >= TRAIL_STEP_M;
        if self.points_m().last().is_none_or(is_apart)
            && let Some(place) = self.points_m.get_mut(self.count)
        {
            *place = point_m;
            self.count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trail_keeps_the_way_of_a_release_and_its_length() {
        let mut trail = ReleaseTrail::default();
        assert!(trail.points_m().is_empty() && trail.travel_m().abs() < 1e-12);
        for step in 0..=300 {
            trail.add(Vector3::new(0.0, 0.0, f64::from(step) * 1e-4));
        }
        assert!((trail.travel_m() - 0.030).abs() < 1e-3, "{}", trail.travel_m());
        assert!((50..=TRAIL_POINTS).contains(&trail.points_m().len()), "{}", trail.points_m().len());
        (0..1000).for_each(|step| trail.add(Vector3::x() * f64::from(step)));
        assert_eq!(trail.points_m().len(), TRAIL_POINTS, "never more than its room");
    }
}
