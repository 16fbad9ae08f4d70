//! Which cyclic requests were answered, by their numbers: what is lost, late and twice. Fixed memory.

use crate::Health;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Fate {
    #[default]
    Done,
    Waiting,
    Lost,
}

/// Requests remembered; at one a millisecond a quarter of a second.
const REMEMBERED: usize = 256;

/// The requests of the last time. Numbers are shared with calls that are no cycle.
#[derive(Clone, Debug)]
pub(super) struct Cycle {
    fates: [(u16, Fate); REMEMBERED],
    newest: Option<u16>,
}

impl Default for Cycle {
    fn default() -> Self {
        Self { fates: [(0, Fate::Done); REMEMBERED], newest: None }
    }
}

impl Cycle {
    /// A request of this number leaves.
    pub(super) fn asked(&mut self, number: u16, health: &mut Health) {
        let place = &mut self.fates[usize::from(number) % REMEMBERED];
        if place.1 == Fate::Waiting {
            health.lost += 1;
        }
        *place = (number, Fate::Waiting);
    }

    /// An answer to this number came. True when it is the newest so far; else it is counted as out of order.
    pub(super) fn answered(&mut self, number: u16, health: &mut Health) -> bool {
        let place = &mut self.fates[usize::from(number) % REMEMBERED];
        let fate = if place.0 == number { std::mem::take(&mut place.1) } else { Fate::Done };
        match fate {
            Fate::Done => {
                health.out_of_order += 1;
                false
            }
            Fate::Lost => {
                // Late, but not lost.
                health.lost -= 1;
                health.out_of_order += 1;
                false
            }
            Fate::Waiting => {
                self.overtake(number, health);
                true
            }
        }
    }

    /// What was asked before the newest answer and has none yet counts as lost.
    fn overtake(&mut self, number: u16, health: &mut Health) {
        let behind = self.newest.map_or(0, |newest| number.wrapping_sub(newest));
        for back in 1..usize::from(behind).min(REMEMBERED) {
            let passed = number.wrapping_sub(back as u16);
            let place = &mut self.fates[usize::from(passed) % REMEMBERED];
            if *place == (passed, Fate::Waiting) {
                place.1 = Fate::Lost;
                health.lost += 1;
            }
        }
        self.newest = Some(number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lost_late_and_doubled_answers_are_told_apart_also_where_numbers_wrap() {
        for start in [1_u16, 65_530] {
            let (mut cycle, mut health) = (Cycle::default(), Health::default());
            let number = |k: u16| start.wrapping_add(k);
            for k in 0..20 {
                // A call in between takes a number and is no cycle.
                if k != 4 {
                    cycle.asked(number(k), &mut health);
                }
            }
            for k in [0, 1, 3, 5, 6] {
                assert!(cycle.answered(number(k), &mut health), "{k}");
            }
            assert_eq!((health.lost, health.out_of_order), (1, 0));
            assert!(!cycle.answered(number(2), &mut health), "late");
            assert_eq!((health.lost, health.out_of_order), (0, 1));
            assert!(!cycle.answered(number(6), &mut health), "twice");
            assert!(
                !cycle.answered(number(4), &mut health) && !cycle.answered(number(200), &mut health),
                "never asked"
            );
            assert_eq!((health.lost, health.out_of_order), (0, 4));
            assert!(cycle.answered(number(19), &mut health));
            assert_eq!(health.lost, 12);
        }
    }
}
