//! The exact distribution of the signed-rank statistic.

/// Returns the probability of each sum of positive ranks if every rank is positive or negative with equal chance; `[s]`
/// is the probability of sum `s`.
///
/// Rank by rank, each sum is reached without the new rank or with it (Streitberg & Röhmel, Exact distributions for
/// permutation and rank tests, Statistical Software Newsletter 12, 1986). With doubled midranks it also holds for ties.
pub(super) fn masses(ranks: impl IntoIterator<Item = usize>) -> Vec<f64> {
    let mut masses = vec![1.0];
    for rank in ranks {
        let before = masses.len();
        masses.resize(before + rank, 0.0);
        for sum in (0..masses.len()).rev() {
            let without = if sum < before { masses[sum] } else { 0.0 };
            let with = if sum >= rank { masses[sum - rank] } else { 0.0 };
            masses[sum] = f64::midpoint(without, with);
        }
    }
    masses
}

/// Returns the two-sided p-value of `lesser`, the smaller of the two rank sums. The distribution is symmetric, so both
/// tails are equal.
pub(super) fn two_sided(ranks: &[usize], lesser: usize) -> f64 {
    let tail: f64 = masses(ranks.iter().copied())[..=lesser].iter().sum();
    (2.0 * tail).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_to_sign_the_ranks_is_counted_once() {
        // Ranks 1, 2.5, 2.5, 4, doubled: all 16 combinations by hand.
        let ranks = [2, 5, 5, 8];
        let mut expected = [0.0; 21];
        for signs in 0..16 {
            let sum: usize = (0..4).filter(|bit| signs >> bit & 1 == 1).map(|bit| ranks[bit]).sum();
            expected[sum] += 1.0 / 16.0;
        }
        assert_eq!(masses(ranks), expected);
    }

    #[test]
    fn the_masses_of_fifty_ranks_sum_to_one() {
        let masses = masses(1..=50);
        assert!((masses.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        assert!(masses.iter().zip(masses.iter().rev()).all(|(a, b)| (a - b).abs() < 1e-18));
    }
}
