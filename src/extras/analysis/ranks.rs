//! Ranks in which equal values get the mean of their ranks (midranks).

/// Twice the midrank of each value, so that shared ranks are whole numbers, with the tie term.
pub(crate) struct Ranks {
    /// Twice the midrank, in the order of the values; ranks count from 1.
    pub(crate) doubled: Vec<usize>,
    /// Sum of t^3 - t over the groups of t equal values; 0 without ties.
    pub(crate) ties: f64,
}

impl Ranks {
    /// Ranks finite values.
    pub(crate) fn of(values: &[f64]) -> Self {
        // A negative zero equals zero.
        let compare = |&a: &usize, &b: &usize| (values[a] + 0.0).total_cmp(&(values[b] + 0.0));
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_unstable_by(compare);
        let mut ranks = Self { doubled: vec![0; values.len()], ties: 0.0 };
        let mut first = 0;
        for group in order.chunk_by(|a, b| compare(a, b).is_eq()) {
            for &at in group {
                // Ranks first + 1 to first + t: twice their mean.
                ranks.doubled[at] = 2 * first + group.len() + 1;
            }
            let t = group.len() as f64;
            ranks.ties += t.powi(3) - t;
            first += group.len();
        }
        ranks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tie_shares_its_ranks() {
        let ranks = Ranks::of(&[3.0, 1.0, 3.0, -0.0, 0.0, 0.0]);
        assert_eq!(ranks.doubled, [11, 8, 11, 4, 4, 4]);
        assert!((ranks.ties - (24.0 + 6.0)).abs() < 1e-12);
    }
}
