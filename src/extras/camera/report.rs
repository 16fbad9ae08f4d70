//! What a calibration of a lens has found, and whether it may be used.

use nalgebra::Vector2;
use nima_core::calibration::Verdict;
use nima_endoscope::{Bend, Lens};

use crate::{Coverage, Terms};

/// Standard deviations of a lens's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviations {
    /// Of the focal lengths, px.
    pub focal_px: Vector2<f64>,
    /// Of the centre, px.
    pub centre_px: Vector2<f64>,
    /// Of the distortion.
    pub bend: Bend,
}

/// Why a view was not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOut {
    /// It is blurred.
    Blurred,
    /// The board was there before.
    Repeated,
    /// Its corners do not fit to the others: the board is not flat, or was misread.
    Outlier,
}

/// What is missing for a good calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// Too few views can be used.
    TooFew {
        /// Views that can be used, and views that are needed.
        used: usize,
        /// Views that are needed.
        needed: usize,
    },
    /// Too few remain, because most are blurred.
    Blurred {
        /// Blurred views.
        blurred: usize,
        /// All views.
        of: usize,
    },
    /// Too few remain, because the board was again and again at the same place.
    Repeated {
        /// Repeated views.
        repeated: usize,
        /// All views.
        of: usize,
    },
    /// The board was parallel to itself in all views.
    Parallel {
        /// The largest angle between two views, degrees.
        most_deg: f64,
    },
    /// It was tilted about one axis only.
    OneWay {
        /// Spread of the tilt in the other direction, degrees.
        spread_deg: f64,
    },
    /// Too little of the picture has shown corners.
    Coverage {
        /// Share of the picture.
        share: f64,
    },
    /// No lens of this kind explains the corners.
    NoFit,
    /// The lens does not predict views that were left out.
    HeldOut {
        /// Root mean square, px.
        rms_px: f64,
        /// Allowed, px.
        most_px: f64,
    },
    /// The views leave the focal length or the centre open.
    Uncertain {
        /// Standard deviation of the focal length, percent.
        focal_percent: f64,
        /// Standard deviation of the centre, px.
        centre_px: f64,
    },
}

impl Cause {
    /// What it makes of the calibration.
    pub const fn verdict(&self) -> Verdict {
        match self {
            Self::NoFit | Self::HeldOut { .. } | Self::Blurred { .. } => Verdict::PoorData,
            _ => Verdict::InsufficientMotion,
        }
    }
}

/// The result of a calibration.
#[derive(Clone, Debug)]
pub struct Report {
    /// The lens; `None` if none was found.
    pub lens: Option<Found>,
    /// Views that were used, by their places in the list.
    pub used: Vec<usize>,
    /// Views that were not used.
    pub left_out: Vec<(usize, LeftOut)>,
    /// Where corners were, of the used views.
    pub coverage: Coverage,
    /// What is missing; `None` if nothing is.
    pub cause: Option<Cause>,
}

/// A lens as it was found.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// The lens.
    pub lens: Lens,
    /// Its terms; those that do not pay on held-out views are left out.
    pub terms: Terms,
    /// How well each parameter is determined.
    pub deviations: Deviations,
    /// Root mean square of the corners' distances, px.
    pub fitted_px: f64,
    /// The same on views that were left out.
    pub held_out_px: f64,
    /// The largest of these.
    pub held_out_max_px: f64,
    /// The largest angle between the boards of two views, degrees.
    pub tilt_deg: f64,
}

impl Report {
    /// Whether the lens may be used.
    pub fn verdict(&self) -> Verdict {
        self.cause.as_ref().map_or(Verdict::Accepted, Cause::verdict)
    }
}
