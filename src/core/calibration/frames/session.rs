//! Guided recording for every frame calibration: a state machine without a clock.
//!
//! Every sample is passed to [`FrameSession::step`]. A pose is recorded once it was held still for the required time and
//! differs from those before; one that moved is not. What is missing is told as values. [`FrameSession::report`] fits
//! (some milliseconds) and belongs to the screen's thread, not into a tick of the loop.

use super::{
    Calibration, Carrier, FrameError, FrameReport, FrameSample, Source,
    hold::{Held, Hold},
};

/// Most poses of a session.
pub const MOST_POSES: usize = 400;

/// State of a session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// A source is silent, or a number in the sample or the time is not finite.
    Missing(Option<Source>),
    /// It moves, by this much from where it was held.
    Moving {
        /// Distance, m.
        by_m: f64,
        /// Angle, rad.
        by_rad: f64,
    },
    /// Still, but not different enough from the poses that were recorded.
    TakenHere,
    /// Still, but not long enough yet.
    Recording {
        /// Share of the required time, 0 to 1.
        share: f64,
    },
    /// A pose was just recorded.
    Recorded {
        /// Its index, from 0.
        index: usize,
    },
    /// The session is full.
    Full,
}

/// What a session still needs most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missing {
    /// More poses.
    Poses,
    /// Larger turns.
    Turns,
    /// Turns about another axis than so far.
    SecondAxis,
    /// Larger tilts of the shaft.
    Tilt,
    /// Tilts towards the other side.
    SecondTilt,
    /// Points further apart.
    Distance,
    /// A point beside the line through the others.
    Beside,
    /// Other directions of gravity.
    Directions,
    /// This move, in the picture.
    Move(super::view::Move),
}

/// How much of the motion is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// 0 to 1; at 1 the data suffice, unless they are poor.
    pub share: f64,
    /// What is missing most; `None` at 1.
    pub missing: Option<Missing>,
}

impl Coverage {
    /// The least of these shares.
    pub(super) fn least<const N: usize>(shares: [(f64, Missing); N]) -> Self {
        let least = shares.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        // Written so that NaN is nothing.
        let share = least.map_or(1.0, |(share, _)| if share > 0.0 { share.min(1.0) } else { 0.0 });
        Self { share, missing: least.filter(|_| share < 1.0).map(|(_, missing)| missing) }
    }
}

/// A guided calibration.
#[derive(Clone, Debug)]
pub struct FrameSession<C> {
    calibration: C,
    hold: Hold,
    taken: Vec<FrameSample>,
    last_s: f64,
}

impl<C: Calibration> FrameSession<C> {
    /// A session without poses.
    pub fn new(calibration: C) -> Self {
        let hold = Hold::new(calibration.hold_s());
        Self { calibration, hold, taken: Vec::new(), last_s: f64::NEG_INFINITY }
    }

    /// Settings of the session.
    pub const fn calibration(&self) -> &C {
        &self.calibration
    }

    /// Adds one sample at time `t_s` (s, rising); returns the state of the session.
    pub fn step(&mut self, sample: &FrameSample, t_s: f64) -> Phase {
        let needs = self.calibration.needs();
        let silent = needs.iter().copied().find(|&source| !sample.has(source));
        if silent.is_some() || !sample.is_finite() || !t_s.is_finite() || t_s <= self.last_s {
            self.hold.reset();
            return Phase::Missing(silent);
        }
        self.last_s = t_s;
        if self.taken.len() == MOST_POSES {
            return Phase::Full;
        }
        if !self.differs(sample) {
            self.hold.reset();
            return Phase::TakenHere;
        }
        match self.hold.step(sample, watched(&needs), t_s) {
            Held::Moved { by_m, by_rad } => Phase::Moving { by_m, by_rad },
            Held::Share(share) => Phase::Recording { share },
            Held::Long(mean) => {
                self.taken.push(*mean);
                Phase::Recorded { index: self.taken.len() - 1 }
            }
        }
    }

    /// Whether the carrier, or the one that may have been mistaken for it, stands elsewhere than before.
    fn differs(&self, sample: &FrameSample) -> bool {
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

    /// How much of the motion is there, and what is missing.
    pub fn coverage(&self) -> Coverage {
        self.calibration.coverage(&self.taken)
    }

    /// Poses recorded so far: the means.
    pub fn samples(&self) -> &[FrameSample] {
        &self.taken
    }

    /// Adds a pose that was captured elsewhere.
    pub fn add(&mut self, sample: FrameSample) {
        if self.taken.len() < MOST_POSES {
            self.taken.push(sample);
        }
    }

    /// Removes a pose; `None` if there is no such pose.
    pub fn remove(&mut self, index: usize) -> Option<FrameSample> {
        (index < self.taken.len()).then(|| self.taken.remove(index))
    }

    /// Removes the newest pose.
    pub fn undo(&mut self) -> Option<FrameSample> {
        self.taken.pop()
    }

    /// Fit of the poses recorded so far. Allocates; for the screen's thread.
    ///
    /// # Errors
    /// As [`Calibration::fit`].
    pub fn report(&self) -> Result<FrameReport<C::Found>, FrameError> {
        self.calibration.fit(&self.taken)
    }
}

/// Which poses must be still, in the order of [`FrameSample::poses`]: those that are needed.
fn watched(needs: &[Source]) -> [bool; 5] {
    let needed = |carrier: Carrier| needs.contains(&carrier.source());
    [needed(Carrier::Flange), false, needed(Carrier::Marker), false, needed(Carrier::Handle)]
}
