//! Coverage of the conditions of use by a recording: tilt, force, travel, friction in both directions, slow and fast,
//! with and without contact.
//!
//! Takes rows of [`super::DEFAULT_INPUTS`] with the force at the tip (N, `shaft`); returns maps to draw and, as text,
//! the conditions that are still missing.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::LIVE_INPUTS;

/// Coarse, so that a recording of half a minute can fill the cells.
pub const MAP: usize = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoverageMap {
    /// Number of rows in each cell, `[vertical][horizontal]`, lowest values first.
    pub counts: [[u32; MAP]; MAP],
}

impl CoverageMap {
    const EMPTY: Self = Self { counts: [[0; MAP]; MAP] };

    fn add(&mut self, [horizontal, vertical]: [f32; 2], ranges: [[f32; 2]; 2]) {
        let place = |value: f32, [low, high]: [f32; 2]| {
            let fraction = (value - low) / (high - low);
            // Values beyond the map count in its edge.
            ((fraction * MAP as f32).max(0.0) as usize).min(MAP - 1)
        };
        self.counts[place(vertical, ranges[1])][place(horizontal, ranges[0])] += 1;
    }

    /// Returns the number of cells with at least a few rows.
    pub fn filled(&self) -> usize {
        // Three rows: a single one may be noise.
        self.counts.iter().flatten().filter(|count| **count >= 3).count()
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueSpan {
    pub low: f32,
    pub high: f32,
}

impl ValueSpan {
    const NONE: Self = Self { low: f32::INFINITY, high: f32::NEG_INFINITY };

    const fn add(&mut self, value: f32) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }

    /// Returns the width of the range; zero before the first value.
    pub const fn width(&self) -> f32 {
        (self.high - self.low).max(0.0)
    }
}

/// Maximum tilt of the shaft from straight down on a map, as a sine, in both directions.
pub const TILT: f32 = 0.8;
/// Largest force on a map, N: across the shaft and along it, in both directions.
/// Above the force ceiling of 4 N, so that every felt force is on the map.
pub const FORCE_N: f32 = 5.0;
/// Range of depth on a map, m.
pub const DEPTH_M: [f32; 2] = [0.0, 0.3];
/// Largest speed on a map, m/s, in both directions.
/// Above the brisk strokes (`BRISK_M_S`), so that they appear inside the map.
pub const SPEED_M_S: f32 = 0.16;

/// Requirements on a recording before it may be used for training. Design choice.
const ROWS: usize = 6000;
const TILT_SPAN: f32 = 0.25;
const DEPTH_SPAN_M: f32 = 0.015;
const ACROSS_SPAN_N: f32 = 0.6;
const ALONG_SPAN_N: f32 = 1.5;
const TRAVEL_FRACTION: f64 = 0.12;
/// Hands work faster during a task than during a careful recording: when trained below 0.06 m/s, the network had an
/// error of 0.05 N at 0.10 m/s. This many rows, about three strokes, must be this fast, inwards and outwards.
const BRISK_M_S: f32 = 0.10;
const BRISK_ROWS: usize = 60;
// Between 15 and 85 %: see `goals`.
const CONTACT_FRACTION: [f64; 2] = [0.15, 0.85];

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    pub what: GoalKind,
    /// Progress, 0 to 1.
    pub fraction: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GoalKind {
    Tilt,
    Depth,
    InAndOut,
    Speed,
    Force,
    Contact,
    Rows,
}

impl GoalKind {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tilt => "Tilt of the shaft",
            Self::Depth => "Depth",
            Self::InAndOut => "In and out",
            Self::Speed => "Speed",
            Self::Force => "Force at the tip",
            Self::Contact => "Contact and free",
            Self::Rows => "Rows",
        }
    }

    /// Returns the advice to follow until the requirement is met.
    pub const fn advice(self) -> &'static str {
        match self {
            Self::Tilt => "reach left, right, near and far",
            Self::Depth => "move in and out by 2 cm",
            Self::InAndOut => "move as often outwards as inwards",
            Self::Speed => "make quick strokes in and out, up to 10 cm/s",
            Self::Force => "press into the tissue up to 3 N, and drag it sideways",
            Self::Contact => "be in contact half of the time",
            Self::Rows => "keep going",
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct TipForceCoverage {
    /// Direction of the shaft (`world`), x horizontal, y vertical, each from -[`TILT`] to [`TILT`].
    pub tilt: CoverageMap,
    /// Force at the tip: horizontally the force across the shaft (0 to [`FORCE_N`]), vertically the force along it
    /// (-[`FORCE_N`] to [`FORCE_N`]).
    pub force: CoverageMap,
    /// Depth horizontal ([`DEPTH_M`]), speed vertical (-[`SPEED_M_S`] to [`SPEED_M_S`]).
    pub travel: CoverageMap,
    tilt_span: [ValueSpan; 2],
    force_span: [ValueSpan; 3],
    depth_span: ValueSpan,
    inwards: usize,
    outwards: usize,
    brisk: [usize; 2],
    contact: usize,
    rows: usize,
}

impl Default for TipForceCoverage {
    fn default() -> Self {
        Self {
            tilt: CoverageMap::EMPTY,
            force: CoverageMap::EMPTY,
            travel: CoverageMap::EMPTY,
            tilt_span: [ValueSpan::NONE; 2],
            force_span: [ValueSpan::NONE; 3],
            depth_span: ValueSpan::NONE,
            inwards: 0,
            outwards: 0,
            brisk: [0; 2],
            contact: 0,
            rows: 0,
        }
    }
}

impl TipForceCoverage {
    pub fn add(&mut self, inputs: &[f32; LIVE_INPUTS], tip_n: &[f32; 3], contact: bool) {
        let [_, _, _, _, _, _, w, x, y, z, depth_m, speed_m_s, _, travel_m, _] = *inputs;
        let shaft = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)) * Vector3::z();
        self.tilt.add([shaft.x, shaft.y], [[-TILT, TILT]; 2]);
        // The map shows the size across the shaft; its direction does not matter there.
        let across_n = libm::hypotf(tip_n[0], tip_n[1]);
        self.force.add([across_n, tip_n[2]], [[0.0, FORCE_N], [-FORCE_N, FORCE_N]]);
        self.travel.add([depth_m, speed_m_s], [DEPTH_M, [-SPEED_M_S, SPEED_M_S]]);
        self.tilt_span.iter_mut().zip([shaft.x, shaft.y]).for_each(|(span, value)| span.add(value));
        self.force_span.iter_mut().zip(tip_n).for_each(|(span, value)| span.add(*value));
        self.depth_span.add(depth_m);
        self.inwards += usize::from(travel_m > 0.0);
        self.outwards += usize::from(travel_m < 0.0);
        // The sign of the speed is the direction; the same index is used in `goals`.
        self.brisk[usize::from(speed_m_s < 0.0)] += usize::from(speed_m_s.abs() >= BRISK_M_S);
        self.contact += usize::from(contact);
        self.rows += 1;
    }

    /// Returns all requirements, in the order in which they should be met.
    pub fn goals(&self) -> [Goal; 7] {
        let rows = self.rows.max(1) as f64;
        let part = |have: f32, want: f32| f64::from(have / want).clamp(0.0, 1.0);
        let goal = |what, fraction: f64| Goal { what, fraction };
        let tilt = self.tilt_span.iter().map(|span| part(span.width(), TILT_SPAN)).fold(1.0, f64::min);
        let [x, y, z] = self.force_span.map(|span| span.width());
        // The weaker of the two directions across the shaft counts, because a network cannot learn a direction that was
        // never loaded.
        let force = part(x.min(y), ACROSS_SPAN_N).min(part(z, ALONG_SPAN_N));
        let way = self.inwards.min(self.outwards) as f64 / rows;
        // Both directions are required, because friction acts against the motion: a network that saw one of them does
        // not know the other.
        let brisk = self.brisk[0].min(self.brisk[1]) as f64 / BRISK_ROWS as f64;
        let contact = self.contact as f64 / rows;
        let [min, max] = CONTACT_FRACTION;
        // Too little contact leaves the force unknown, too much of it leaves the offset of the free instrument unknown.
        let mixed = (contact / min).min((1.0 - contact) / (1.0 - max));
        [
            goal(GoalKind::Tilt, tilt),
            goal(GoalKind::Depth, part(self.depth_span.width(), DEPTH_SPAN_M)),
            goal(GoalKind::InAndOut, (way / TRAVEL_FRACTION).min(1.0)),
            goal(GoalKind::Speed, brisk.min(1.0)),
            goal(GoalKind::Force, force),
            goal(GoalKind::Contact, mixed.clamp(0.0, 1.0)),
            goal(GoalKind::Rows, (self.rows as f64 / ROWS as f64).min(1.0)),
        ]
    }

    /// Returns the first requirement that is not met; `None` if the recording may be used for training.
    pub fn next(&self) -> Option<Goal> {
        self.goals().into_iter().find(|goal| goal.fraction < 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the progress of the speed goal after these strokes, each of 100 rows with a sine's speeds.
    fn speed_fraction(peaks_m_s: &[f32]) -> f64 {
        let mut coverage = TipForceCoverage::default();
        for peak_m_s in peaks_m_s {
            for row in 0..100_u8 {
                let mut inputs = [0.0; LIVE_INPUTS];
                inputs[11] = peak_m_s * libm::sinf(std::f32::consts::PI * f32::from(row) / 100.0);
                coverage.add(&inputs, &[0.0; 3], false);
            }
        }
        coverage.goals().into_iter().find(|goal| goal.what == GoalKind::Speed).unwrap().fraction
    }

    #[test]
    fn quick_strokes_are_wanted_in_both_directions() {
        assert!(speed_fraction(&[0.09; 50]) < 1e-9, "none is as fast as 0.10 m/s");
        assert!(speed_fraction(&[0.13; 50]) < 1e-9, "none goes outwards");
        assert!(speed_fraction(&[0.13, -0.13]) > 0.5);
        assert!(speed_fraction(&[0.13, -0.13, 0.13, -0.13]) >= 1.0);
    }
}
