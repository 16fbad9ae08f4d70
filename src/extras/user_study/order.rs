//! The order of conditions for each participant: Williams' Latin square, balanced for carry-over.
//!
//! In a square every condition occurs once in each row and equally often in each position, and every ordered pair of
//! neighbours occurs equally often. An even number of conditions needs one square, an odd number two, which mirror each
//! other (Williams 1949, Experimental designs balanced for the estimation of residual effects of treatments, Australian
//! Journal of Scientific Research A 2:149-168).

use fastrand::Rng;

/// Returns the rows of the design for this number of conditions: as many rows as conditions if the number is even,
/// otherwise twice as many.
///
/// ```
/// use nima_user_study::order::williams;
///
/// assert_eq!(williams(4), [[0, 1, 3, 2], [1, 2, 0, 3], [2, 3, 1, 0], [3, 0, 2, 1]]);
/// assert_eq!(williams(3).len(), 6);
/// ```
pub fn williams(conditions: usize) -> Vec<Vec<usize>> {
    let n = conditions;
    let first = (0..n).map(|place| if place % 2 == 1 { place.div_ceil(2) } else { (n - place / 2) % n });
    let first: Vec<usize> = first.collect();
    let square: Vec<Vec<usize>> =
        (0..n).map(|row| first.iter().map(|condition| (condition + row) % n).collect()).collect();
    if n.is_multiple_of(2) || n < 3 {
        return square;
    }
    let mirrored: Vec<Vec<usize>> = square.iter().map(|row| row.iter().rev().copied().collect()).collect();
    square.into_iter().chain(mirrored).collect()
}

/// Returns an order for each participant: whole designs one after the other, each with its rows in an order determined
/// by the seed. Balanced if the number of participants is a multiple of the number of rows.
pub fn orders(conditions: usize, participants: usize, seed: u64) -> Vec<Vec<usize>> {
    let mut rng = Rng::with_seed(seed);
    let rows = williams(conditions);
    let mut orders = Vec::with_capacity(participants);
    while orders.len() < participants && !rows.is_empty() {
        let mut design = rows.clone();
        rng.shuffle(&mut design);
        orders.extend(design);
    }
    orders.truncate(participants);
    orders
}

/// Returns the condition of each label.
pub fn assignment(conditions: usize, seed: u64) -> Vec<usize> {
    let mut all: Vec<usize> = (0..conditions).collect();
    Rng::with_seed(seed).shuffle(&mut all);
    all
}
