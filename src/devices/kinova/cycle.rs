//! Matches answers to cyclic requests by their numbers and counts what is lost, late or duplicated. Fixed memory.

use crate::Health;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum CycleResult {
    #[default]
    Done,
    Waiting,
    Lost,
}

/// Number of stored requests; a quarter of a second at 1 kHz. An answer that is later than that counts as lost anyway.
const REMEMBERED: usize = 256;

/// The latest cyclic requests. Calls share their numbering.
#[derive(Clone, Debug)]
pub(super) struct Cycle {
    fates: [(u16, CycleResult); REMEMBERED],
    newest: Option<u16>,
}

impl Default for Cycle {
    fn default() -> Self {
        Self { fates: [(0, CycleResult::Done); REMEMBERED], newest: None }
    }
}

impl Cycle {
    /// Records that a request with this number was sent.
    pub(super) fn asked(&mut self, number: u16, health: &mut Health) {
        let place = &mut self.fates[usize::from(number) % REMEMBERED];
        // The place is being reused, so a request that still waits there counts as lost.
        if place.1 == CycleResult::Waiting {
            health.lost += 1;
        }
        *place = (number, CycleResult::Waiting);
    }

    /// Records an answer with this number. Returns true if it is the newest so far; otherwise it counts as out of
    /// order.
    pub(super) fn answered(&mut self, number: u16, health: &mut Health) -> bool {
        let place = &mut self.fates[usize::from(number) % REMEMBERED];
        let fate = if place.0 == number { std::mem::take(&mut place.1) } else { CycleResult::Done };
        match fate {
            CycleResult::Done => {
                health.out_of_order += 1;
                false
            }
            CycleResult::Lost => {
                // Late, so not lost after all.
                health.lost -= 1;
                health.out_of_order += 1;
                false
            }
            CycleResult::Waiting => {
                self.overtake(number, health);
                true
            }
        }
    }

    /// Counts requests older than the newest answer that have no answer yet as lost.
    fn overtake(&mut self, number: u16, health: &mut Health) {
        // The numbers wrap at 65 535, after about a minute.
        let behind = self.newest.map_or(0, |newest| number.wrapping_sub(newest));
        for back in 1..usize::from(behind).min(REMEMBERED) {
            let passed = number.wrapping_sub(back as u16);
            let place = &mut self.fates[usize::from(passed) % REMEMBERED];
            // The place may belong to a call, which shares the numbers but is answered on the other connection.
            if *place == (passed, CycleResult::Waiting) {
                place.1 = CycleResult::Lost;
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
            let mut cycle = Cycle::default();
            let mut health = Health::default();
            let number = |k: u16| start.wrapping_add(k);
            for k in 0..20 {
                // This number was used by a call.
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
