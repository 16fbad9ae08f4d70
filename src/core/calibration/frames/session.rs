//! Guided recording for every frame calibration: a state machine without a clock.
//!
//! Every sample is passed to [`FrameSession::step`]. A pose is recorded when it has been held still for the required
//! time and differs from earlier poses; a pose that moved is not recorded. The missing parts are reported as values.
//! [`FrameSession::report`] runs the fit (some milliseconds) and belongs on the screen's thread, not in a tick of the
//! loop.

use super::{
    Calibration, CalibrationSource, Carrier, FrameError, FrameReport, FrameSample,
    hold::{HoldState, PoseHold},
};

/// Twenty times the poses of a good session, so that a forgotten session cannot fill the memory.
pub const MAX_POSES: usize = 400;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FramePhase {
    /// A source is silent, or a number in the sample or the time is not finite.
    Missing(Option<CalibrationSource>),
    /// The carrier is moving; `by_m` and the angle since the hold started.
    Moving {
        by_m: f64,
        /// Still, but not different enough from the recorded poses.
        by_rad: f64,
    },
    /// Still, but not different enough from the poses that were recorded.
    TakenHere,
    Recording {
        fraction: f64,
    },
    Recorded {
        index: usize,
    },
    Full,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissingMotion {
    Poses,
    Turns,
    SecondAxis,
    Tilt,
    SecondTilt,
    Distance,
    /// A point off the line through the others.
    Beside,
    Directions,
    Move(super::view::ViewMove),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameCoverage {
    /// Fraction of the required data, 0 to 1; at 1 the data suffice, unless they are poor.
    pub fraction: f64,
    /// Part that is missing most; `None` at 1.
    pub missing: Option<MissingMotion>,
}

impl FrameCoverage {
    pub(super) fn min<const N: usize>(fractions: [(f64, MissingMotion); N]) -> Self {
        let min = fractions.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        // Written so that NaN counts as zero.
        let fraction = min.map_or(1.0, |(fraction, _)| if fraction > 0.0 { fraction.min(1.0) } else { 0.0 });
        Self { fraction, missing: min.filter(|_| fraction < 1.0).map(|(_, missing)| missing) }
    }
}

#[derive(Clone, Debug)]
pub struct FrameSession<C> {
    calibration: C,
    hold: PoseHold,
    taken: Vec<FrameSample>,
    last_s: f64,
}

impl<C: Calibration> FrameSession<C> {
    pub fn new(calibration: C) -> Self {
        let hold = PoseHold::new(calibration.hold_s());
        Self { calibration, hold, taken: Vec::new(), last_s: f64::NEG_INFINITY }
    }

    pub const fn calibration(&self) -> &C {
        &self.calibration
    }

    /// Adds one sample at time `t_s` (s, increasing); returns the state of the session.
    pub fn step(&mut self, sample: &FrameSample, t_s: f64) -> FramePhase {
        let needs = self.calibration.needs();
        let silent = needs.iter().copied().find(|&source| !sample.has(source));
        if silent.is_some() || !sample.is_finite() || !t_s.is_finite() || t_s <= self.last_s {
            self.hold.reset();
            return FramePhase::Missing(silent);
        }
        self.last_s = t_s;
        if self.taken.len() == MAX_POSES {
            return FramePhase::Full;
        }
        if !self.differs(sample) {
            self.hold.reset();
            return FramePhase::TakenHere;
        }
        match self.hold.step(sample, watched(&needs), t_s) {
            HoldState::Moved { by_m, by_rad } => FramePhase::Moving { by_m, by_rad },
            HoldState::Share(fraction) => FramePhase::Recording { fraction },
            HoldState::Long(mean) => {
                self.taken.push(*mean);
                FramePhase::Recorded { index: self.taken.len() - 1 }
            }
        }
    }

    /// Returns whether the carrier, or the other one with which it may have been confused, is at a new pose.
    fn differs(&self, sample: &FrameSample) -> bool {
        // If the sides are swapped, only the other side's pose changes, and the session must still record it.
        let carrier = self.calibration.carrier();
        let of_other = |sample: &FrameSample| {
            let pose = *sample.other_pose(carrier)?;
            let mut other = *sample;
            *other.pose_mut(carrier)? = pose;
            Some(other)
        };
        let others: Option<Vec<FrameSample>> = self.taken.iter().map(of_other).collect();
        self.calibration.differs(sample, &self.taken)
            || others.zip(of_other(sample)).is_some_and(|(others, other)| self.calibration.differs(&other, &others))
    }

    /// Returns the completed fraction of the motion and the missing part.
    pub fn coverage(&self) -> FrameCoverage {
        self.calibration.coverage(&self.taken)
    }

    pub fn samples(&self) -> &[FrameSample] {
        &self.taken
    }

    pub fn add(&mut self, sample: FrameSample) {
        if self.taken.len() < MAX_POSES {
            self.taken.push(sample);
        }
    }

    /// Removes a pose; returns `None` if it does not exist.
    pub fn remove(&mut self, index: usize) -> Option<FrameSample> {
        (index < self.taken.len()).then(|| self.taken.remove(index))
    }

    pub fn undo(&mut self) -> Option<FrameSample> {
        self.taken.pop()
    }

    /// Fits the poses recorded so far. Allocates, so call it on the screen's thread.
    ///
    /// # Errors
    /// The errors of [`Calibration::fit`].
    pub fn report(&self) -> Result<FrameReport<C::Solution>, FrameError> {
        self.calibration.fit(&self.taken)
    }
}

/// Returns which poses must be still, in the order of [`FrameSample::poses`]: the required ones.
fn watched(needs: &[CalibrationSource]) -> [bool; 5] {
    let needed = |carrier: Carrier| needs.contains(&carrier.source());
    [needed(Carrier::Flange), false, needed(Carrier::Marker), false, needed(Carrier::Handle)]
}
