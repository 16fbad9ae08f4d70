//! Columns of a model; a force is computed from them.

use super::{
    super::{
        messages::Posture,
        normal::dot,
        regressors::{MotionState, saturated},
        settings::ImpedanceSettings,
    },
    slip::{SLIPS, SlipLanes},
};
use crate::signal::Lanes;

// The largest form (`Coupled`): 8 linear, 3 curved, 12 of the other axes and 2 that slip.
pub(in super::super) const COLUMNS: usize = 25;

/// The columns of one tick, or their parameters, one lane per axis.
pub(super) type FormRow = [Lanes; COLUMNS];

/// Leading columns of each nested model.
/// Each list ends with the full form; the shorter ones are its prefixes, so one factorisation serves all.
const TISSUE: &[usize] = &[8, 11];
const SLIDING: &[usize] = &[8, 11, 13];
const COUPLED: &[usize] = &[8, 11, 23, 25];
const PAPER: &[usize] = &[4, 7, 10, 13, 16];

/// Set of columns of a model; the first is a constant, positions count from a fixed origin `d = x - x0`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelForm {
    /// `1, d, u1..u4` (position above its low-passes at 5, 20, 80, 320 ms: four Maxwell branches), acceleration, dry friction;
    /// then `d^2, d^3, d u2`.
    Tissue,
    /// The columns of `Tissue`, and friction that grows with the force along the other axes: springs that slip
    /// (`slip.rs`).
    Sliding,
    /// The columns of `SlidingSolver`, and `d, u1..u4` and acceleration of the two other axes: the full `M`.
    Coupled,
    /// The paper's columns: `1, d, v, a, d^2, v^2, a^2, ...` up to this degree.
    Paper(u8),
}

impl ModelForm {
    /// Returns the form for matched rendering: columns of other axes are included only if there are other axes.
    pub(in super::super) const fn of(settings: &ImpedanceSettings) -> Self {
        match settings.axes {
            1 => Self::Tissue,
            _ if settings.cross_talk => Self::Coupled,
            _ => Self::Sliding,
        }
    }

    /// Returns the numbers of leading columns of the nested models, ascending.
    pub(super) fn nested(self) -> &'static [usize] {
        match self {
            Self::Tissue => TISSUE,
            Self::Sliding => SLIDING,
            Self::Coupled => COUPLED,
            Self::Paper(degree) => &PAPER[..usize::from(degree).clamp(1, PAPER.len())],
        }
    }

    pub(super) fn columns(self) -> usize {
        self.nested().last().copied().unwrap_or(1)
    }

    /// Returns the degree of the nested model with this many columns.
    pub(super) fn degree(self, columns: usize) -> u8 {
        match self {
            Self::Tissue | Self::Sliding | Self::Coupled => {
                if columns > TISSUE[0] {
                    3
                } else {
                    // Three columns per power after the constant, so `3 N + 1` over 3 is `N`.
                    1
                }
            }
            Self::Paper(_) => (columns / 3) as u8,
        }
    }

    /// Returns the position from which the columns are computed.
    pub(super) fn position(self, posture: &Posture) -> Lanes {
        match self {
            Self::Tissue | Self::Sliding | Self::Coupled => posture.stance.x,
            // The paper's columns are scaled, so their origin has to be in the same units.
            Self::Paper(_) => posture.features[0],
        }
    }

    pub(super) const fn slips(self) -> bool {
        matches!(self, Self::Sliding | Self::Coupled)
    }

    /// Returns the columns of a posture. `one`: 1 in the lanes in use; `origin`: origin of the positions; `held`:
    /// values of the slip columns.
    pub(super) fn row(self, posture: &Posture, one: Lanes, origin: Lanes, held: &SlipLanes) -> FormRow {
        let mut row = [Lanes::ZERO; COLUMNS];
        // Positions count from a kept origin: a constant then absorbs the force there, and powers stay small.
        let d = self.position(posture) - origin;
        row[0] = one;
        if let Self::Paper(degree) = self {
            let base = [d, posture.features[1], posture.features[2]];
            let mut power = base;
            for triple in row[1..].chunks_exact_mut(3).take(usize::from(degree)) {
                triple.copy_from_slice(&power);
                for (power, base) in power.iter_mut().zip(base) {
                    *power *= base;
                }
            }
            return row;
        }
        let MotionState { u, surge, knee, .. } = posture.stance;
        let own = [d, u[0], u[1], u[2], u[3], surge];
        row[1..7].copy_from_slice(&own);
        // The second difference (20 ms) is smooth enough for a sign, and still follows each reversal.
        row[7] = saturated(u[1], knee);
        row[8] = d * d;
        row[9] = row[8] * d;
        row[10] = d * u[1];
        if self.slips() {
            // Last, so that the nested models without slip are prefixes.
            row[self.columns() - SLIPS..self.columns()].copy_from_slice(held);
        }
        if self == Self::Coupled {
            for (j, Lanes([x, y, z, _])) in own.into_iter().enumerate() {
                // Rotated lanes: lane x gets the motion of y, lane y that of z, lane z that of x.
                row[11 + j] = Lanes([y, z, x, 0.0]);
                row[17 + j] = Lanes([z, x, y, 0.0]);
            }
        }
        row
    }
}

/// Returns `sum_j parameters_j row_j` over the leading columns.
#[inline]
pub(super) fn product(parameters: &FormRow, row: &FormRow, columns: usize) -> Lanes {
    dot(&parameters[..columns], row)
}
