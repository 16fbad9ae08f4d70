//! The operator's acts in a training task, apart from moving the instrument.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskAction {
    /// The trial restarts: earlier acts are discarded.
    Begin,
    /// The point under the tip is marked as containing a lump.
    Mark,
    /// The operator has completed the task.
    End,
}

/// Number of times that each act was performed. A simulation carries out each increase of a count, so that no act is
/// repeated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Acts {
    pub begins: u8,
    pub marks: u8,
    pub ends: u8,
}

impl TaskAction {
    pub const ALL: [Self; 3] = [Self::Begin, Self::Mark, Self::End];
}

impl Acts {
    pub const NONE: Self = Self { begins: 0, marks: 0, ends: 0 };

    pub const fn note(&mut self, act: TaskAction) {
        let count = match act {
            TaskAction::Begin => &mut self.begins,
            TaskAction::Mark => &mut self.marks,
            TaskAction::End => &mut self.ends,
        };
        *count = count.wrapping_add(1);
    }

    pub const fn of(&self, act: TaskAction) -> u8 {
        match act {
            TaskAction::Begin => self.begins,
            TaskAction::Mark => self.marks,
            TaskAction::End => self.ends,
        }
    }

    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self {
            begins: self.begins.wrapping_add(other.begins),
            marks: self.marks.wrapping_add(other.marks),
            ends: self.ends.wrapping_add(other.ends),
        }
    }

    /// Returns the number of times of an act since `before`. A count that decreased was restarted, and gives zero.
    pub const fn since(&self, before: &Self, act: TaskAction) -> u8 {
        let more = self.of(act).wrapping_sub(before.of(act));
        if more > u8::MAX / 2 { 0 } else { more }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn acts_are_counted_round_and_a_count_that_begins_anew_is_no_act() {
        let mut acts = Acts::NONE;
        for _ in 0..300 {
            acts.note(TaskAction::Mark);
        }
        let before = acts;
        assert_eq!((acts.since(&before, TaskAction::Mark), acts.since(&before, TaskAction::End)), (0, 0));
        acts.note(TaskAction::Mark);
        acts.note(TaskAction::End);
        assert_eq!(TaskAction::ALL.map(|act| acts.since(&before, act)), [0, 1, 1]);
        assert_eq!(Acts::NONE.since(&acts, TaskAction::Mark), 0, "the loop has ended");
        assert_eq!(acts.and(acts).marks, 2_u8.wrapping_mul(acts.marks));
    }
}
