//! Published methods of others, with their names and the data that each of them sends. The crate `nima-baselines`
//! computes at most one of them.

use serde::{Deserialize, Serialize};

use super::packed::{PackedNumbers, PackedReader, PackedWriter};
use crate::signal::Lanes;

/// A method of others, computed to compare with; see [`add_baselines`](super::add_baselines).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Baseline {
    /// Model-mediated teleoperation: a Hunt-Crossley contact by recursive least squares.
    ModelMediated,
    /// Wave variables: the returning wave.
    Waves,
    /// Time-domain passivity: the energy returned by the tissue.
    Passivity,
    /// Extrapolation by a Kalman filter of force and its rate.
    Kalman,
    /// Extrapolation by an autoregressive model of the force, by recursive least squares.
    Autoregressive,
    /// Recursive least squares of the increments of motion and force over the delay, with the trend of the force.
    Increments,
}

impl Baseline {
    /// Every baseline.
    pub const ALL: [Self; 6] =
        [Self::ModelMediated, Self::Waves, Self::Passivity, Self::Kalman, Self::Autoregressive, Self::Increments];

    /// Returns the name used on the command line, in files and on the screen.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ModelMediated => "model_mediated",
            Self::Waves => "waves",
            Self::Passivity => "passivity",
            Self::Kalman => "kalman",
            Self::Autoregressive => "autoregressive",
            Self::Increments => "increments",
        }
    }
}

/// Parameters of a baseline in a packet: plain numbers of fixed size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BaselineModel {
    /// No baseline is computed, or it has no data yet.
    Nothing,
    /// Model-mediated teleoperation: the contact.
    Contact(HuntCrossleyContact),
    /// Wave variables: the returning wave.
    Wave(Wave),
    /// Time-domain passivity: the energy that the tissue has returned so far (J).
    Returned {
        /// Per axis, never falling.
        energy_j: Lanes,
    },
    /// Kalman: the filtered force and its rate, which the leader extrapolates.
    Trend {
        /// N.
        force_n: Lanes,
        /// N/s.
        rate_n_s: Lanes,
    },
    /// Autoregressive: the force predicted for one delay later.
    Forecast {
        /// N.
        force_n: Lanes,
    },
    /// Increments: the change of the force since the packet.
    Increments(ForceIncrements),
}

/// The change of the force over the delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceIncrements {
    /// Stiffness (N/m), damping (N s/m) and mass (kg).
    pub parameters: [Lanes; 3],
    /// Change that does not depend on the leader's motion (N).
    pub trend_n: Lanes,
    /// Minimum and maximum rendered force (N).
    pub bounds_n: [Lanes; 2],
}

/// A Hunt-Crossley contact on each side of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HuntCrossleyContact {
    /// The surface (m).
    pub surface_m: Lanes,
    /// Depth by which depths are divided (m).
    pub reach_m: Lanes,
    /// `n`.
    pub exponent: Lanes,
    /// For each side of the surface, stiffness (N at the reach) and damping (N s/m at the reach); then the offset (N),
    /// the instrument's damping (N s/m) and mass (kg).
    pub parameters: [Lanes; 7],
    /// Minimum and maximum rendered force (N).
    pub bounds_n: [Lanes; 2],
}

/// A returning wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// `w = (b v - F) / sqrt(2 b)` at the follower (square root of W).
    pub returning: Lanes,
    /// Wave impedance `b` (N s/m).
    pub impedance_n_s_m: Lanes,
}

impl PackedNumbers for BaselineModel {
    const NONE: Self = Self::Nothing;

    fn write(&self, row: &mut PackedWriter<'_>) {
        match self {
            Self::Nothing => row.put(0.0),
            Self::Contact(contact) => {
                row.put(1.0);
                for lanes in
                    [contact.surface_m, contact.reach_m, contact.exponent, contact.bounds_n[0], contact.bounds_n[1]]
                {
                    row.lanes(lanes);
                }
                row.row(&contact.parameters);
            }
            Self::Wave(wave) => {
                row.put(2.0);
                row.lanes(wave.returning);
                row.lanes(wave.impedance_n_s_m);
            }
            Self::Returned { energy_j } => {
                row.put(3.0);
                row.lanes(*energy_j);
            }
            Self::Trend { force_n, rate_n_s } => {
                row.put(4.0);
                row.lanes(*force_n);
                row.lanes(*rate_n_s);
            }
            Self::Forecast { force_n } => {
                row.put(5.0);
                row.lanes(*force_n);
            }
            Self::Increments(increments) => {
                row.put(6.0);
                for lanes in [increments.trend_n, increments.bounds_n[0], increments.bounds_n[1]] {
                    row.lanes(lanes);
                }
                row.row(&increments.parameters);
            }
        }
    }

    fn read(row: &mut PackedReader<'_>) -> Option<Self> {
        // An unknown tag fails here, so that a newer sender is not misread.
        Some(match row.count(6)? {
            0 => Self::Nothing,
            1 => {
                let surface_m = row.lanes()?;
                let reach_m = row.lanes()?;
                let exponent = row.lanes()?;
                let bounds_n = [row.lanes()?, row.lanes()?];
                Self::Contact(HuntCrossleyContact { surface_m, reach_m, exponent, parameters: row.row()?, bounds_n })
            }
            2 => Self::Wave(Wave { returning: row.lanes()?, impedance_n_s_m: row.lanes()? }),
            3 => Self::Returned { energy_j: row.lanes()? },
            4 => Self::Trend { force_n: row.lanes()?, rate_n_s: row.lanes()? },
            5 => Self::Forecast { force_n: row.lanes()? },
            _ => {
                let trend_n = row.lanes()?;
                let bounds_n = [row.lanes()?, row.lanes()?];
                Self::Increments(ForceIncrements { parameters: row.row()?, trend_n, bounds_n })
            }
        })
    }
}
