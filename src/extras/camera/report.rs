//! Results of a lens calibration, and whether it may be used.

use nalgebra::Vector2;
use nima_core::calibration::Verdict;
use nima_endoscope::{Bend, Lens};

use crate::{CameraCoverage, Terms};

/// Standard deviations of a lens's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviations {
    pub focal_px: Vector2<f64>,
    pub centre_px: Vector2<f64>,
    pub bend: Bend,
}

/// Why a view was not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOut {
    Blurred,
    /// The board had been in this place before.
    Repeated,
    /// Corners do not fit the others: the board is not flat, or was misread.
    Outlier,
}

/// A deficiency of a calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraCause {
    /// Too few views can be used.
    TooFew {
        /// Usable views.
        used: usize,
        /// Required views.
        needed: usize,
    },
    /// Too few views remain, because most are blurred.
    Blurred {
        /// Number of blurred views.
        blurred: usize,
        /// Number of all views.
        of: usize,
    },
    /// Too few remain, because the board was in the same place repeatedly.
    Repeated {
        /// Number of repeated views.
        repeated: usize,
        /// Number of all views.
        of: usize,
    },
    /// The board was parallel to itself in all views.
    Parallel {
        /// Maximum angle between two views, degrees.
        max_deg: f64,
    },
    /// The board was tilted about one axis only.
    OneWay {
        /// Spread of the tilt in the other direction, degrees.
        spread_deg: f64,
    },
    /// Corners were seen in too small a part of the image.
    Coverage {
        /// Fraction of the image.
        fraction: f64,
    },
    /// No lens of this kind fits the corners.
    NoFit,
    /// The lens does not predict held-out views.
    HeldOut {
        /// Root mean square, px.
        rms_px: f64,
        /// Limit, px.
        max_px: f64,
    },
    /// The views do not determine the focal length or the centre.
    Uncertain {
        /// Standard deviation of the focal length, percent.
        focal_percent: f64,
        /// Standard deviation of the centre, px.
        centre_px: f64,
    },
}

impl CameraCause {
    pub const fn verdict(&self) -> Verdict {
        match self {
            Self::NoFit | Self::HeldOut { .. } | Self::Blurred { .. } => Verdict::PoorData,
            _ => Verdict::InsufficientMotion,
        }
    }
}

#[derive(Clone, Debug)]
pub struct LensReport {
    /// `None` if no lens was found.
    pub lens: Option<CalibratedLens>,
    /// Used views, by their indices in the list.
    pub used: Vec<usize>,
    /// Views that were not used.
    pub left_out: Vec<(usize, LeftOut)>,
    /// Positions of corners in the used views.
    pub coverage: CameraCoverage,
    /// The deficiency; `None` if there is none.
    pub cause: Option<CameraCause>,
}

/// Lens determined by a calibration.
#[derive(Clone, Copy, Debug)]
pub struct CalibratedLens {
    pub lens: Lens,
    /// Terms of the lens; terms that do not improve held-out views are omitted.
    pub terms: Terms,
    /// Uncertainty of each parameter.
    pub deviations: Deviations,
    /// Root mean square of the corners' distances, px.
    pub fitted_px: f64,
    /// The same on held-out views.
    pub held_out_px: f64,
    /// Maximum of these, px.
    pub held_out_max_px: f64,
    /// Maximum angle between the boards of two views, degrees.
    pub tilt_deg: f64,
}

impl LensReport {
    /// Returns the verdict on the lens.
    pub fn verdict(&self) -> Verdict {
        self.cause.as_ref().map_or(Verdict::Accepted, CameraCause::verdict)
    }
}
