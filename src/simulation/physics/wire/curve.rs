//! The middle line of a wire: a smooth curve through points, as many short straight pieces; and its closest points to a
//! loop.
//!
//! Only roots and divisions, so that every processor gives the same bits.

use nalgebra::Vector3;

use super::PLACES;
use crate::physics::geometry::Circle;

/// Maximum length of a piece, m. In a bend of 5 mm radius it deviates from the arc by 6 um.
const PIECE_M: f64 = 5e-4;
/// Minimum number of pieces between two points.
const PIECES_MIN: usize = 8;
/// Steps of the golden section that narrow down a closest point, to 1/15000 of the interval (`GOLDEN^20`).
const NARROWINGS: usize = 20;
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A smooth curve through points: cubic pieces with the slopes of the parabola through three neighbours.
///
/// ```
/// use nima_simulation::physics::WireSetting;
///
/// let points_m = vec![[0.0, 0.0, 0.03], [0.03, 0.0, 0.03]];
/// let curve = WireSetting { points_m, ..WireSetting::default() }.curve();
/// assert!((curve.length_m() - 0.03).abs() < 1e-12 && (curve.at(0.01).x - 0.01).abs() < 1e-12);
/// ```
#[derive(Clone, Debug)]
#[expect(clippy::struct_field_names, reason = "a name ends with its unit")]
pub struct SmoothCurve {
    points_m: Vec<Vector3<f64>>,
    /// Length from the beginning to each point, m.
    along_m: Vec<f64>,
    /// The same for the points of the setting.
    given_m: Vec<f64>,
    /// Maximum length of a piece, m.
    piece_m: f64,
}

/// A closest point between wire and loop.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "a name ends with its unit")]
pub(super) struct NearestPlace {
    /// Position along the wire, m.
    pub along_m: f64,
    pub wire_m: Vector3<f64>,
    /// Position on the middle line of the loop's tube.
    pub loop_m: Vector3<f64>,
}

/// The part of a curve near a loop.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CurveReach {
    /// Closest points that are nearer than allowed.
    pub places: [Option<NearestPlace>; PLACES],
    /// The crossing of the loop's plane that is nearest to the loop's middle: m along the curve, and distance from the
    /// middle, m.
    pub through: Option<(f64, f64)>,
}

impl SmoothCurve {
    /// Creates a curve through these points: at least two, all different from their neighbours.
    pub(super) fn through(given_m: &[[f64; 3]]) -> Self {
        let given: Vec<Vector3<f64>> = given_m.iter().map(|position_m| Vector3::from(*position_m)).collect();
        let mut curve =
            Self { points_m: Vec::new(), along_m: Vec::new(), given_m: Vec::with_capacity(given.len()), piece_m: 0.0 };
        let slopes = slopes(&given);
        for (i, pair) in given.windows(2).enumerate() {
            let chord_m = (pair[1] - pair[0]).norm();
            let pieces = ((chord_m / PIECE_M).ceil() as usize).max(PIECES_MIN);
            if i == 0 {
                curve.push(pair[0]);
            }
            curve.given_m.push(curve.length_m());
            for piece in 1..=pieces {
                let t = piece as f64 / pieces as f64;
                curve.push(hermite(pair[0], slopes[i] * chord_m, pair[1], slopes[i + 1] * chord_m, t));
            }
        }
        curve.given_m.push(curve.length_m());
        curve
    }

    fn push(&mut self, point_m: Vector3<f64>) {
        let piece_m = self.points_m.last().map_or(0.0, |last_m| (point_m - last_m).norm());
        self.along_m.push(self.length_m() + piece_m);
        self.points_m.push(point_m);
        self.piece_m = self.piece_m.max(piece_m);
    }

    pub fn length_m(&self) -> f64 {
        self.along_m.last().copied().unwrap_or(0.0)
    }

    /// Returns the points between which it is straight, m.
    pub fn points_m(&self) -> &[Vector3<f64>] {
        &self.points_m
    }

    /// Returns the position along it of the setting's point with this number, m; the end if there is no such point.
    pub fn given_m(&self, point: usize) -> f64 {
        self.given_m.get(point).copied().unwrap_or_else(|| self.length_m())
    }

    /// Returns the point at this position along it, clamped to its ends.
    pub fn at(&self, along_m: f64) -> Vector3<f64> {
        let after = self.along_m.partition_point(|before_m| *before_m < along_m);
        let (Some(from), Some(to)) = (self.points_m.get(after.saturating_sub(1)), self.points_m.get(after)) else {
            return self.points_m.last().copied().unwrap_or_default();
        };
        if after == 0 {
            return *to;
        }
        let from_m = self.along_m[after - 1];
        let to_m = self.along_m[after];
        let fraction = if to_m > from_m { ((along_m - from_m) / (to_m - from_m)).clamp(0.0, 1.0) } else { 0.0 };
        from + (to - from) * fraction
    }

    /// Returns the position along the curve and the point at a fractional index.
    fn between(&self, place: f64) -> (f64, Vector3<f64>) {
        let last = self.points_m.len() - 1;
        let place = place.clamp(0.0, last as f64);
        let i = (place as usize).min(last.saturating_sub(1));
        let fraction = place - i as f64;
        let next = (i + 1).min(last);
        (
            self.along_m[i] + (self.along_m[next] - self.along_m[i]) * fraction,
            self.points_m[i] + (self.points_m[next] - self.points_m[i]) * fraction,
        )
    }

    /// Returns where it is closer to a loop's middle line than `both_m`, and where it passes through the loop.
    pub(super) fn near(&self, circle: &Circle, both_m: f64) -> CurveReach {
        let reach_m = circle.radius_m + both_m + self.piece_m;
        let mut reach = CurveReach::default();
        // The two previous points; infinity where they were skipped.
        let mut gaps_m = [f64::INFINITY; 2];
        let mut height_before_m = None;
        let mut i = 0;
        let count = self.points_m.len();
        while i < count {
            let away_m = (self.points_m[i] - circle.centre_m).norm();
            if away_m > reach_m {
                self.note(circle, i, &[gaps_m[0], gaps_m[1], f64::INFINITY], both_m, &mut reach);
                gaps_m = [f64::INFINITY; 2];
                height_before_m = None;
                // No piece is longer than `piece_m`, so none of the skipped points is in reach.
                i += (((away_m - reach_m) / self.piece_m.max(1e-6)) as usize).max(1);
                continue;
            }
            let gap_m = (circle.closest(&self.points_m[i]) - self.points_m[i]).norm();
            self.note(circle, i, &[gaps_m[0], gaps_m[1], gap_m], both_m, &mut reach);
            let height_m = height_m(circle, &self.points_m[i]);
            if let Some(before_m) = height_before_m.filter(|before_m| crosses(*before_m, height_m)) {
                let (along_m, off_axis_m) = self.cross(circle, i - 1, before_m, height_m);
                if reach.through.is_none_or(|(_, min_m)| off_axis_m < min_m) {
                    reach.through = Some((along_m, off_axis_m));
                }
            }
            gaps_m = [gaps_m[1], gap_m];
            height_before_m = Some(height_m);
            i += 1;
        }
        self.note(circle, count, &[gaps_m[0], gaps_m[1], f64::INFINITY], both_m, &mut reach);
        reach
    }

    /// Notes the point before `next` if it is closer than its neighbours, and close enough.
    fn note(&self, circle: &Circle, next: usize, gaps_m: &[f64; 3], both_m: f64, reach: &mut CurveReach) {
        let [before_m, here_m, after_m] = *gaps_m;
        // Within a piece, the gap decreases by at most half the piece's length.
        let is_min = here_m < before_m && here_m <= after_m && here_m < both_m + self.piece_m;
        let Some(free) = reach.places.iter_mut().find(|place| place.is_none()).filter(|_| is_min) else { return };
        let point = (next - 1) as f64;
        let place = self.closest(circle, [point - 1.0, point + 1.0]);
        *free = ((place.loop_m - place.wire_m).norm() < both_m).then_some(place);
    }

    /// Returns the closest point within this distance along the wire, m.
    pub(super) fn closest_around(&self, circle: &Circle, along_m: f64, within_m: f64) -> NearestPlace {
        let place = |along_m: f64| self.along_m.partition_point(|before_m| *before_m < along_m) as f64;
        self.closest(circle, [place(along_m - within_m) - 1.0, place(along_m + within_m)])
    }

    /// Returns the closest point between two fractional indices (golden section; Kiefer, Proc. Amer. Math. Soc. 4,
    /// 1953).
    fn closest(&self, circle: &Circle, [mut low, mut high]: [f64; 2]) -> NearestPlace {
        let place = |at: f64| {
            let (along_m, wire_m) = self.between(at);
            let loop_m = circle.closest(&wire_m);
            (NearestPlace { along_m, wire_m, loop_m }, (loop_m - wire_m).norm_squared())
        };
        for _ in 0..NARROWINGS {
            let one = high - (high - low) * GOLDEN;
            let other = low + (high - low) * GOLDEN;
            if place(one).1 < place(other).1 {
                high = other;
            } else {
                low = one;
            }
        }
        place(0.5 * (low + high)).0
    }

    /// Returns the crossing of a loop's plane nearest to a position and at most this far from it, m along the wire.
    pub(super) fn crossing(&self, circle: &Circle, from_m: f64, within_m: f64) -> Option<f64> {
        let last = self.points_m.len().checked_sub(2)?;
        let here = self.along_m.partition_point(|along_m| *along_m <= from_m).saturating_sub(1).min(last);
        let max = (within_m / self.piece_m.max(1e-6)) as usize + 1;
        let of = |piece: usize| {
            let heights_m = [piece, piece + 1].map(|i| height_m(circle, &self.points_m[i]));
            crosses(heights_m[0], heights_m[1]).then(|| self.cross(circle, piece, heights_m[0], heights_m[1]).0)
        };
        (0..=max).find_map(|away| {
            let above = Some(here + away).filter(|piece| *piece <= last).and_then(of);
            above.or_else(|| here.checked_sub(away).filter(|_| away > 0).and_then(of))
        })
    }

    /// Returns the crossing of a loop's plane by a piece: m along the curve, and distance from the middle of the loop,
    /// m.
    fn cross(&self, circle: &Circle, piece: usize, from_m: f64, to_m: f64) -> (f64, f64) {
        let span_m = from_m - to_m;
        // A piece in the plane of the loop crosses it everywhere; its beginning is as good as any point.
        let fraction = if span_m.abs() > 0.0 { (from_m / span_m).clamp(0.0, 1.0) } else { 0.0 };
        let (along_m, point_m) = self.between(piece as f64 + fraction);
        (along_m, (point_m - circle.centre_m).norm())
    }
}

/// Returns the height above the plane of a loop, m.
fn height_m(circle: &Circle, point_m: &Vector3<f64>) -> f64 {
    circle.axis.dot(&(point_m - circle.centre_m))
}

fn crosses(from_m: f64, to_m: f64) -> bool {
    (from_m < 0.0) != (to_m < 0.0)
}

/// Returns the slope per length at each point: of the parabola through it and its neighbours, and straight at the ends.
fn slopes(points_m: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let secant = |i: usize| {
        let travel_m = points_m[i + 1] - points_m[i];
        let length_m = travel_m.norm().max(1e-9);
        (travel_m / length_m, length_m)
    };
    let last = points_m.len() - 1;
    (0..=last)
        .map(|i| match i {
            0 => secant(0).0,
            i if i == last => secant(last - 1).0,
            i => {
                let (before, before_m) = secant(i - 1);
                let (after, after_m) = secant(i);
                (before * after_m + after * before_m) / (before_m + after_m)
            }
        })
        .collect()
}

/// Returns the cubic from one point and slope to another, at a fraction `t`.
fn hermite(
    from: Vector3<f64>,
    from_slope: Vector3<f64>,
    to: Vector3<f64>,
    to_slope: Vector3<f64>,
    t: f64,
) -> Vector3<f64> {
    let t2 = t * t;
    let t3 = t * t * t;
    from * (2.0 * t3 - 3.0 * t2 + 1.0)
        + from_slope * (t3 - 2.0 * t2 + t)
        + to * (3.0 * t2 - 2.0 * t3)
        + to_slope * (t3 - t2)
}
