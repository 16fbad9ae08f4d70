//! Training rows and held-out rows of each member. Rows are never shuffled individually, because neighbouring rows are
//! similar.

use std::ops::Range;

use nima_recording::tip_force::DataSet;

/// Rows left out between a held-out block and its neighbours if a trajectory had to be divided.
/// A quarter of a second of the wizard's rows (5 ms).
const GAP: usize = 50;

/// With fewer trajectories than this, they are divided into blocks. Whole trajectories are preferable: early stopping
/// on them rewards a network that generalises beyond the loads of its training rows.
const FEW: usize = 3;

#[derive(Clone, Debug)]
pub(super) struct Folds {
    blocks: Vec<Range<usize>>,
    /// Fold of every block.
    fold: Vec<usize>,
    gap: usize,
}

impl Folds {
    /// Creates five folds, or one per member if there are more members. They consist of whole trajectories (at most as
    /// many folds as trajectories), or of blocks if there are few trajectories.
    pub(super) fn of(data: &DataSet, members: usize, seed: u64) -> Self {
        let count = members.max(5);
        let whole: Vec<Range<usize>> = data.trajectories.iter().map(|trajectory| trajectory.rows.clone()).collect();
        let (blocks, gap) = if whole.len() >= FEW {
            (whole, 0)
        } else {
            let pieces = (2 * count).div_ceil(whole.len()).max(2);
            (whole.iter().flat_map(|rows| cut(rows, pieces)).collect(), GAP)
        };
        let count = count.min(blocks.len());
        let mut order: Vec<usize> = (0..blocks.len()).collect();
        // Another random sequence than that of the initial weights.
        fastrand::Rng::with_seed(seed ^ 0xf01d).shuffle(&mut order);
        let mut fold = vec![0; blocks.len()];
        for (place, block) in order.into_iter().enumerate() {
            fold[block] = place % count;
        }
        Self { blocks, fold, gap }
    }

    pub(super) fn count(&self) -> usize {
        self.fold.iter().max().map_or(0, |last| last + 1)
    }

    /// Returns the training rows and held-out rows of a member.
    pub(super) fn split(&self, member: usize) -> (Vec<usize>, Vec<usize>) {
        let mut training = Vec::new();
        let mut validation = Vec::new();
        for (block, fold) in self.blocks.iter().zip(&self.fold) {
            if *fold == member % self.count() {
                // In a short block the gaps take at most half of the rows.
                let gap = self.gap.min(block.len() / 4);
                validation.extend(block.start + gap..block.end - gap);
            } else {
                training.extend(block.clone());
            }
        }
        (training, validation)
    }
}

fn cut(rows: &Range<usize>, pieces: usize) -> impl Iterator<Item = Range<usize>> {
    let start = rows.start;
    let length = rows.len();
    (0..pieces).map(move |k| start + k * length / pieces..start + (k + 1) * length / pieces)
}
