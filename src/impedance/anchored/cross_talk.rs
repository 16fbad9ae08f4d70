//! The full `M`: every axis' force from every axis' motion, 45 columns. Costs as much as all the rest; only where asked for.
//!
//! The paper leaves cross-talk out "for simplicity" and allows for it by the elements of `M` beside its diagonal. Here the
//! change of force over the delay is regressed on the changes of all features of all axes, and the result is one more
//! expert in the mixture: it is rendered as far as its own past predictions earn.

use super::{
    super::{
        AXES,
        features::{Features, MOTION_COLUMNS},
    },
    learner::{Learner, Variants, nothing, product},
};
use crate::signal::{DelayLine, Lanes};

/// Columns of the full `M` of one axis' force.
const COLUMNS: usize = AXES * MOTION_COLUMNS;
const VARIED: Variants = Variants { ridges_s: &[0.01], prefixes: &[COLUMNS] };

/// The full `M` (N per scaled feature): per column of the source axes in turn, a lane per axis of force.
pub(super) type CrossModel = [Lanes; COLUMNS];

/// Changes of every feature of every axis, the same for every axis of force.
fn columns(now: &Features, then: &Features) -> [Lanes; COLUMNS] {
    std::array::from_fn(|column| {
        let (axis, feature) = (column / MOTION_COLUMNS, column % MOTION_COLUMNS);
        Lanes::splat(now[feature][axis] - then[feature][axis])
    })
}

/// `M (phi(now) - phi(then))`, N.
pub(super) fn crossed(model: &CrossModel, now: &Features, then: &Features) -> Lanes {
    product(model, &columns(now, then), COLUMNS)
}

/// Learns the full `M`.
#[derive(Clone, Debug)]
pub(super) struct CrossTalk {
    learner: Learner<COLUMNS, 1>,
    snapshots: DelayLine<[CrossModel; 1]>,
}

impl CrossTalk {
    /// `most` is the longest delay in ticks.
    pub(super) fn new(rate_hz: f64, most: usize) -> Self {
        let learner = Learner::new(rate_hz, VARIED);
        let snapshots = DelayLine::new(most / learner.ticks_per_solve() + 1, nothing());
        Self { learner, snapshots }
    }

    /// Keeps the parameters in force at the first tick of a round.
    pub(super) fn begin_round(&mut self) {
        *self.snapshots.push_slot() = *self.learner.solutions();
    }

    /// The newest full `M`.
    pub(super) fn newest(&self) -> CrossModel {
        self.snapshots.get(0).map_or([Lanes::ZERO; COLUMNS], |[model]| *model)
    }

    /// What the parameters of `rounds_ago` expect of this change of motion, N.
    pub(super) fn expectation(&self, rounds_ago: usize, now: &Features, then: &Features) -> Lanes {
        self.snapshots.get(rounds_ago).map_or(Lanes::ZERO, |[model]| crossed(model, now, then))
    }

    /// Learns that this change of motion came with this change of force (N); solves what is due at this tick.
    pub(super) fn learn(&mut self, now: &Features, then: &Features, change: Lanes, tick: usize) {
        let columns = columns(now, then);
        self.learner.measure(&columns);
        let newest = [self.newest()];
        self.learner.learn(&columns, change, &newest);
        self.learner.solve_due(tick);
    }

    pub(super) fn reset(&mut self) {
        self.learner.reset();
        self.snapshots.clear();
    }
}
