//! Cooperation of the two hands.

use nima_core::SIDES;

use crate::{
    signal::STEP_S,
    tip_motion::{IDLE_M_PER_S, TipMotion},
};

/// Minimum number of points with both hands known for a result: 1 s.
const MIN_POINTS: usize = 100;
/// A speed that varies less than this (standard deviation, m/s) has only the correlation of its noise.
const MIN_SD_M_PER_S: f64 = 1e-4;

/// Speeds of both hands on the grid of the trial.
pub(crate) struct TwoHands {
    speeds: Vec<[Option<f64>; SIDES]>,
}

impl TwoHands {
    pub(crate) fn of(motions: &[TipMotion<'_>; SIDES]) -> Self {
        let ends =
            motions.iter().flat_map(|motion| &motion.stretches).map(|stretch| stretch.grid + stretch.speed.len());
        let mut speeds = vec![[None; SIDES]; ends.max().unwrap_or(0)];
        for (side, motion) in motions.iter().enumerate() {
            for stretch in &motion.stretches {
                for (both, speed) in speeds.iter_mut().skip(stretch.grid).zip(&stretch.speed) {
                    both[side] = Some(*speed);
                }
            }
        }
        Self { speeds }
    }

    /// Returns the time in which no known hand moves, s.
    pub(crate) fn idle_s(&self) -> Option<f64> {
        let known = self.speeds.iter().filter(|hands| hands.iter().flatten().next().is_some());
        let idle = known.clone().filter(|hands| hands.iter().flatten().all(|speed| *speed < IDLE_M_PER_S));
        (known.count() > 0).then_some(idle.count() as f64 * STEP_S)
    }

    /// Returns the fraction of the time with both hands known in which both move.
    pub(crate) fn both_move(&self) -> Option<f64> {
        let count = self.pairs().count();
        let both = self.pairs().filter(|pair| pair.iter().all(|speed| *speed >= IDLE_M_PER_S)).count();
        (count >= MIN_POINTS).then(|| both as f64 / count as f64)
    }

    /// Returns Pearson's correlation of the two speeds.
    pub(crate) fn correlation(&self) -> Option<f64> {
        let count = self.pairs().count();
        if count < MIN_POINTS {
            return None;
        }
        let mean = |side: usize| self.pairs().map(|pair| pair[side]).sum::<f64>() / count as f64;
        let means = [mean(0), mean(1)];
        let moment = |a: usize, b: usize| {
            self.pairs().map(|pair| (pair[a] - means[a]) * (pair[b] - means[b])).sum::<f64>() / count as f64
        };
        let sds = [moment(0, 0).sqrt(), moment(1, 1).sqrt()];
        let varies = sds.iter().all(|sd| *sd >= MIN_SD_M_PER_S);
        varies.then(|| (moment(0, 1) / (sds[0] * sds[1])).clamp(-1.0, 1.0))
    }

    fn pairs(&self) -> impl Iterator<Item = [f64; SIDES]> {
        self.speeds.iter().filter_map(|[one, other]| Some([(*one)?, (*other)?]))
    }
}
