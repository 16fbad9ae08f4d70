//! The model that crosses the link, and the force that it gives for the hand's own motion.

use super::{
    super::{
        MAX_DEGREE,
        messages::Posture,
        packed::{PackedNumbers, PackedReader, PackedWriter},
    },
    form::{COLUMNS, ModelForm},
    slip::{SLIPS, Slip},
};
use crate::signal::Lanes;

/// Parameters of matched rendering: `f = clip(theta phi(own motion)) + o`. They contain no measured force, except
/// through the range and the offset (at most a tenth of the maximum force).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchedModel {
    pub form: ModelForm,
    /// Degree with the largest weight; 0 before anything is known.
    pub degree: u8,
    /// 1 on the axes in use.
    pub one: Lanes,
    /// N per unit of the column, zero beyond the columns in use: all experts, by their weights.
    pub parameters: [Lanes; COLUMNS],
    /// Origin of the positions (m; in the paper's form in scaled units).
    pub origin: Lanes,
    /// Length at which the springs of the slip columns slip, per force along the other axes (m/N).
    pub gives: [f64; SLIPS],
    /// Minimum and maximum force computed from the parameters (N).
    pub bounds_n: [Lanes; 2],
    /// A slow offset (N), added after the bounds.
    pub offset_n: Lanes,
}

impl MatchedModel {
    pub const NONE: Self = Self {
        form: ModelForm::Tissue,
        degree: 0,
        one: Lanes::ZERO,
        parameters: [Lanes::ZERO; COLUMNS],
        origin: Lanes::ZERO,
        gives: [0.0; SLIPS],
        bounds_n: [Lanes::ZERO; 2],
        offset_n: Lanes::ZERO,
    };

    /// Returns the force (N) for a motion; `None` without a model, or if the force is not finite. Advances the springs
    /// of this end (`slip`).
    pub(super) fn force(&self, now: &Posture, slip: &mut Slip) -> Option<Lanes> {
        if self.degree == 0 {
            return None;
        }
        let (_, force) = slip.step(self, now);
        // The offset is added after the clip: it is bounded on its own (`drift.rs`).
        force.is_finite().then(|| self.clipped(force) + self.offset_n)
    }

    pub(super) fn clipped(&self, force_n: Lanes) -> Lanes {
        let [low, high] = self.bounds_n;
        force_n.within(low, high)
    }
}

impl PackedNumbers for MatchedModel {
    const NONE: Self = Self::NONE;

    fn write(&self, row: &mut PackedWriter<'_>) {
        let (form, degree) = match self.form {
            ModelForm::Tissue => (0, 0),
            ModelForm::Sliding => (1, 0),
            ModelForm::Coupled => (2, 0),
            ModelForm::Paper(degree) => (3, degree),
        };
        row.put(f64::from(form));
        row.put(f64::from(degree));
        row.put(f64::from(self.degree));
        for lanes in [self.one, self.origin, self.bounds_n[0], self.bounds_n[1], self.offset_n] {
            row.lanes(lanes);
        }
        self.gives.iter().for_each(|give| row.put(*give));
        row.row(&self.parameters);
    }

    fn read(row: &mut PackedReader<'_>) -> Option<Self> {
        let form = row.count(3)?;
        let paper = row.count(MAX_DEGREE)? as u8;
        // The numbers of the forms are part of the packet's format: append, never reorder.
        let form = [ModelForm::Tissue, ModelForm::Sliding, ModelForm::Coupled, ModelForm::Paper(paper)][form];
        let degree = row.count(MAX_DEGREE)? as u8;
        let one = row.lanes()?;
        let origin = row.lanes()?;
        let bounds_n = [row.lanes()?, row.lanes()?];
        let offset_n = row.lanes()?;
        let gives = [row.take()?, row.take()?];
        Some(Self { form, degree, one, parameters: row.row()?, origin, gives, bounds_n, offset_n })
    }
}
