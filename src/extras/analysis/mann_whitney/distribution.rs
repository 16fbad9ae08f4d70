//! The exact distribution of the rank sum of one group.

use crate::ranks::Ranks;

/// `[s]` is the probability that `chosen` of `ranks`, drawn without replacement, have the sum `s` (Streitberg & Röhmel, 1986).
fn sums(ranks: &[usize], chosen: usize) -> Vec<f64> {
    let max: usize = largest(ranks, chosen);
    // `ways[j][s]`: number of sets of j ranks with the sum s. At most 1e29 here: no overflow, and rounding stays
    // relative.
    let mut ways = vec![vec![0.0; max + 1]; chosen + 1];
    ways[0][0] = 1.0;
    for (seen, &rank) in ranks.iter().enumerate() {
        for size in (1..=chosen.min(seen + 1)).rev() {
            let (smaller, same) = ways.split_at_mut(size);
            for sum in rank..=max {
                same[0][sum] += smaller[size - 1][sum - rank];
            }
        }
    }
    let masses = ways.pop().unwrap_or_default();
    let total: f64 = masses.iter().sum();
    masses.iter().map(|mass| mass / total).collect()
}

/// Returns the sum of the `chosen` largest ranks.
fn largest(ranks: &[usize], chosen: usize) -> usize {
    let mut sorted = ranks.to_vec();
    sorted.sort_unstable();
    sorted.iter().rev().take(chosen).sum()
}

/// Returns the two-sided p-value of the sum of the first `first` ranks: probability of a sum at least as far from the
/// mean.
pub(super) fn two_sided(ranks: &Ranks, first: usize) -> f64 {
    let all = ranks.doubled.len();
    // Both groups are equally far from their means; the smaller one needs less work.
    let chosen = if first <= all - first { 0..first } else { first..all };
    // The mean of all doubled ranks is all + 1.
    let mean = chosen.len() * (all + 1);
    let far = ranks.doubled[chosen.clone()].iter().sum::<usize>().abs_diff(mean);
    let masses = sums(&ranks.doubled, chosen.len());
    let beyond = masses.iter().enumerate().filter(|(sum, _)| sum.abs_diff(mean) >= far);
    beyond.map(|(_, mass)| mass).sum::<f64>().min(1.0)
}

/// `[u]` is the probability of Mann & Whitney's U for groups of `m` and `n` values without ties, u from 0 to m n.
pub(super) fn masses(m: usize, n: usize) -> Vec<f64> {
    let chosen = m.min(n);
    let ranks: Vec<usize> = (1..=m + n).collect();
    sums(&ranks, chosen).split_off(chosen * (chosen + 1) / 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_of_four_ranks_have_six_sums() {
        // 1+2, 1+3, 1+4 and 2+3, 2+4, 3+4.
        let sixth = 1.0 / 6.0;
        let expected = [sixth, sixth, 2.0 * sixth, sixth, sixth];
        assert!(masses(2, 2).iter().zip(expected).all(|(mass, expected)| (mass - expected).abs() < 1e-15));
    }

    #[test]
    fn the_masses_of_two_groups_of_fifty_are_symmetric_and_sum_to_one() {
        let masses = masses(50, 50);
        assert_eq!(masses.len(), 2501);
        assert!((masses.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(masses.iter().zip(masses.iter().rev()).all(|(a, b)| (a - b).abs() < 1e-15));
    }
}
