use std::collections::BTreeMap;

use crate::order::{assignment, orders, williams};

/// Checks that each condition occurs once in each row and equally often in each position, and that each ordered pair of
/// neighbours occurs equally often.
#[test]
fn a_design_is_balanced_for_place_and_for_carry_over() {
    for n in 2..=10 {
        let rows = williams(n);
        assert_eq!(rows.len(), if n % 2 == 0 { n } else { 2 * n });
        let mut places = BTreeMap::new();
        let mut pairs = BTreeMap::new();
        for row in &rows {
            let mut sorted = row.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..n).collect::<Vec<_>>());
            row.iter().enumerate().for_each(|place| *places.entry(place).or_insert(0) += 1);
            row.windows(2).for_each(|pair| *pairs.entry((pair[0], pair[1])).or_insert(0) += 1);
        }
        let times = rows.len() / n;
        assert!(places.len() == n * n && places.values().all(|count| *count == times), "{n}: {places:?}");
        assert!(pairs.len() == n * (n - 1) && pairs.values().all(|count| *count == times), "{n}: {pairs:?}");
    }
}

#[test]
fn whole_designs_are_balanced_over_the_participants_and_the_seed_decides_their_order() {
    for (conditions, participants) in [(2, 8), (3, 18), (4, 12), (5, 20)] {
        let all = orders(conditions, participants, 11);
        assert_eq!(all.len(), participants);
        for row in williams(conditions) {
            let count = all.iter().filter(|order| **order == row).count();
            assert_eq!(count, participants / williams(conditions).len(), "{row:?}");
        }
        assert_eq!(all, orders(conditions, participants, 11));
    }
    let different = (0..20).filter(|seed| orders(3, 18, *seed) != orders(3, 18, 99)).count();
    assert!(different >= 19, "{different}");
    assert_eq!(orders(3, 7, 1).len(), 7);
}

#[test]
fn every_assignment_of_labels_happens_equally_often() {
    let mut seen = BTreeMap::new();
    for seed in 0..6000 {
        *seen.entry(assignment(3, seed)).or_insert(0_u32) += 1;
    }
    // 1000 each, with a standard deviation of 29.
    assert!(seen.len() == 6 && seen.values().all(|count| (850..1150).contains(count)), "{seen:?}");
}
