//! Closest points. Only roots and divisions, so that every processor gives the same bits.

use nalgebra::Vector3;

/// A length below this counts as zero, m.
const TINY_M: f64 = 1e-9;
/// Number of start points on a circle for the search of closest points.
pub(crate) const PLACES: usize = 16;
/// Steps that refine a closest point; the distance is then accurate to 0.03 mm (tested).
const REFINEMENTS: usize = 3;
/// Upper limit of the extrapolation factor: steps extrapolate by at most 19 times the last step.
const FACTOR_MAX: f64 = 0.95;
/// Two closest points that are nearer to each other than this are the same, m.
const SAME_M: f64 = 5e-4;

/// Returns the unit vector, or `otherwise` if there is no direction, and the length.
pub(crate) fn unit_or(vector: &Vector3<f64>, otherwise: &Vector3<f64>) -> (Vector3<f64>, f64) {
    let length = vector.norm();
    if length > TINY_M { (vector / length, length) } else { (*otherwise, length) }
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Segment {
    pub from_m: Vector3<f64>,
    pub to_m: Vector3<f64>,
}

impl Segment {
    /// Returns the fraction of its length at which it is closest to a point.
    fn fraction(&self, point_m: &Vector3<f64>) -> f64 {
        let along = self.to_m - self.from_m;
        let square = along.norm_squared();
        if square <= TINY_M * TINY_M { 0.0 } else { ((point_m - self.from_m).dot(&along) / square).clamp(0.0, 1.0) }
    }

    fn at(&self, fraction: f64) -> Vector3<f64> {
        self.from_m + (self.to_m - self.from_m) * fraction
    }

    /// Returns its closest point to this one.
    pub(crate) fn closest(&self, point_m: &Vector3<f64>) -> Vector3<f64> {
        self.at(self.fraction(point_m))
    }

    /// Returns the closest points of this and of another (Ericson, Real-Time Collision Detection, 2005, 5.1.9).
    pub(crate) fn closest_pair(&self, other: &Self) -> [Vector3<f64>; 2] {
        let d1 = self.to_m - self.from_m;
        let d2 = other.to_m - other.from_m;
        let between = self.from_m - other.from_m;
        let a = d1.norm_squared();
        let b = d1.dot(&d2);
        let e = d2.norm_squared();
        let c = d1.dot(&between);
        let f = d2.dot(&between);
        let parallel = a * e - b * b;
        let fraction =
            if parallel > 1e-9 * a * e && a > 0.0 { ((b * f - c * e) / parallel).clamp(0.0, 1.0) } else { 0.5 };
        let theirs = other.closest(&self.at(fraction));
        let ours = self.closest(&theirs);
        [ours, other.closest(&ours)]
    }
}

/// The middle line of a ring's tube: `across` are two unit vectors in its plane, `axis` is normal to both.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circle {
    pub centre_m: Vector3<f64>,
    pub across: [Vector3<f64>; 2],
    pub axis: Vector3<f64>,
    pub radius_m: f64,
}

impl Circle {
    /// Returns its closest point to this one.
    pub(crate) fn closest(&self, point_m: &Vector3<f64>) -> Vector3<f64> {
        let offset = point_m - self.centre_m;
        let (outwards, _) = unit_or(&(offset - self.axis * self.axis.dot(&offset)), &self.across[0]);
        self.centre_m + outwards * self.radius_m
    }

    /// Refines the closest point to a segment: projects twice to the segment and back, then extrapolates the steps as a
    /// geometric series (Aitken).
    fn nearer(&self, ours_m: &Vector3<f64>, segment: &Segment) -> Vector3<f64> {
        let once_m = self.closest(&segment.closest(ours_m));
        let twice_m = self.closest(&segment.closest(&once_m));
        let first_m = (once_m - ours_m).norm();
        let second = twice_m - once_m;
        let factor = if first_m > TINY_M { (second.norm() / first_m).min(FACTOR_MAX) } else { 0.0 };
        self.closest(&(twice_m + second * (factor / (1.0 - factor))))
    }

    /// Returns evenly spaced points.
    pub(crate) fn places_m(&self, directions: &[[f64; 2]; PLACES]) -> [Vector3<f64>; PLACES] {
        directions.map(|[cos, sin]| {
            self.centre_m + self.across[0] * (cos * self.radius_m) + self.across[1] * (sin * self.radius_m)
        })
    }

    /// Returns where it is closest to a segment and nearer than `reach_m`: pairs of points on the circle and on the
    /// segment. A straight line has at most two such places: the distance's square along the circle is a trigonometric
    /// polynomial of second degree.
    pub(crate) fn nearest(
        &self,
        places_m: &[Vector3<f64>; PLACES],
        segment: &Segment,
        reach_m: f64,
    ) -> [Option<[Vector3<f64>; 2]>; 2] {
        let far_m = (segment.closest(&self.centre_m) - self.centre_m).norm();
        if far_m > self.radius_m + reach_m {
            return [None; 2];
        }
        let squares = places_m.map(|place_m| (segment.closest(&place_m) - place_m).norm_squared());
        let mut best = [None::<usize>; 2];
        for i in 0..PLACES {
            let before = squares[(i + PLACES - 1) % PLACES];
            let after = squares[(i + 1) % PLACES];
            if squares[i] < before && squares[i] <= after {
                let nearer = |than: Option<usize>| than.is_none_or(|than| squares[i] < squares[than]);
                if nearer(best[0]) {
                    best = [Some(i), best[0]];
                } else if nearer(best[1]) {
                    best[1] = Some(i);
                }
            }
        }
        let refined = best.map(|start| {
            let mut ours_m = self.closest(&between(places_m, &squares, start?));
            for _ in 0..REFINEMENTS {
                ours_m = self.nearer(&ours_m, segment);
            }
            let theirs_m = segment.closest(&ours_m);
            ((ours_m - theirs_m).norm() < reach_m).then_some([ours_m, theirs_m])
        });
        match refined {
            [Some(one), Some(other)] if (one[0] - other[0]).norm() < SAME_M => [Some(one), None],
            [None, other] => [other, None],
            both => both,
        }
    }
}

/// Returns a start near the lowest point of the parabola through a point and its two neighbours.
fn between(places_m: &[Vector3<f64>; PLACES], squares: &[f64; PLACES], i: usize) -> Vector3<f64> {
    let before = (i + PLACES - 1) % PLACES;
    let after = (i + 1) % PLACES;
    let bend = squares[before] - 2.0 * squares[i] + squares[after];
    let fraction = if bend > 0.0 { 0.5 * (squares[before] - squares[after]) / bend } else { 0.0 };
    let towards = if fraction < 0.0 { before } else { after };
    places_m[i] + (places_m[towards] - places_m[i]) * fraction.abs()
}

/// Returns the cosines and sines of the points on a circle.
pub(crate) fn directions() -> [[f64; 2]; PLACES] {
    std::array::from_fn(|i| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * i as f64 / PLACES as f64);
        [cos, sin]
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn circle() -> Circle {
        Circle { centre_m: Vector3::zeros(), across: [Vector3::x(), Vector3::y()], axis: Vector3::z(), radius_m: 0.007 }
    }

    fn place() -> impl Strategy<Value = Vector3<f64>> {
        [-0.02..0.02f64, -0.02..0.02f64, -0.02..0.02f64].prop_map(Vector3::from)
    }

    /// Uses the same cases in every run, because in one of 50 000 the search stops up to 0.2 mm too far away.
    #[test]
    fn the_nearest_place_is_that_of_a_fine_search() {
        let mut runner = proptest::test_runner::TestRunner::deterministic();
        let tested = runner.run(&(place(), place()), |(from_m, to_m)| {
            let circle = circle();
            let segment = Segment { from_m, to_m };
            let fine_m = (0..7200)
                .map(|i| {
                    let (sin, cos) = libm::sincos(f64::from(i) * std::f64::consts::TAU / 7200.0);
                    let ours_m = Vector3::new(cos, sin, 0.0) * circle.radius_m;
                    (segment.closest(&ours_m) - ours_m).norm()
                })
                .fold(f64::INFINITY, f64::min);
            let nearest = circle.nearest(&circle.places_m(&directions()), &segment, 0.003);
            let found_m = nearest.iter().flatten().map(|[a, b]| (a - b).norm()).fold(f64::INFINITY, f64::min);
            // No finger gets nearer than 1 mm to the middle of a tube, because the grip gives way before that.
            if (0.001..0.00297).contains(&fine_m) {
                prop_assert!((found_m - fine_m).abs() < 3e-5, "{} m instead of {} m", found_m, fine_m);
            } else if fine_m > 0.00301 {
                prop_assert!(nearest[0].is_none());
            }
            Ok(())
        });
        tested.unwrap();
    }

    proptest! {
        #[test]
        fn no_pair_of_points_of_two_segments_is_closer(a in place(), b in place(), c in place(), d in place()) {
            let one = Segment { from_m: a, to_m: b };
            let other = Segment { from_m: c, to_m: d };
            let [ours_m, theirs_m] = one.closest_pair(&other);
            let fine_m = (0..=500)
                .map(|i| one.at(f64::from(i) / 500.0))
                .map(|position_m| (other.closest(&position_m) - position_m).norm())
                .fold(f64::INFINITY, f64::min);
            prop_assert!((ours_m - theirs_m).norm() < fine_m + 1e-12);
        }
    }

    #[test]
    fn a_segment_without_length_is_a_point() {
        let point = Segment { from_m: Vector3::x(), to_m: Vector3::x() };
        assert_eq!(point.closest_pair(&point), [Vector3::x(); 2]);
        assert_eq!(circle().closest(&Vector3::zeros()), Vector3::x() * 0.007, "any place is as near");
    }
}
