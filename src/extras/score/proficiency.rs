//! When training with a task is complete.

use serde::Serialize;

use crate::{Score, TaskCriterion};

/// Progress of training.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TrainingState {
    /// The trainee has not yet met the criterion in `consecutive` trials in a row.
    Practising {
        /// Number of successive trials that met the criterion, up to the newest.
        in_a_row: u32,
    },
    /// The consecutive trials were reached; the additional ones follow.
    Confirming {
        /// Number of additional trials that met the criterion.
        additional: u32,
    },
    /// All were reached, in this trial.
    Reached {
        /// From 1.
        trial: u32,
    },
    /// Not reached within the maximum number of trials.
    GivenUp,
}

/// Follows the trials of one person with one task.
///
/// ```
/// use nima_score::{TaskCriterion, Proficiency, TrainingState};
///
/// let mut proficiency = Proficiency::new(TaskCriterion::default());
/// for trial in 1..=12 {
///     proficiency.take_trial(Some(47.0), 0);
/// }
/// assert_eq!(proficiency.standing(), TrainingState::Reached { trial: 12 }, "two in a row, then ten more");
/// ```
#[derive(Clone, Debug)]
pub struct Proficiency {
    criterion: TaskCriterion,
    trials: u32,
    standing: TrainingState,
}

impl Proficiency {
    pub fn new(criterion: TaskCriterion) -> Self {
        Self { criterion, trials: 0, standing: TrainingState::Practising { in_a_row: 0 } }
    }

    /// Adds the score of the next trial.
    pub fn take(&mut self, score: &Score) -> TrainingState {
        let drops = score.value("drops_out_of_view").unwrap_or(0.0);
        self.take_trial(score.value("completion_time_s"), drops as u32)
    }

    /// Adds the next trial by its completion time (s; `None` if it was not completed) and its drops out of view.
    pub fn take_trial(&mut self, completion_time_s: Option<f64>, drops_out_of_view: u32) -> TrainingState {
        if matches!(self.standing, TrainingState::Reached { .. } | TrainingState::GivenUp) {
            return self.standing;
        }
        self.trials += 1;
        self.standing = self.after(self.criterion.is_met(completion_time_s, drops_out_of_view));
        self.standing
    }

    pub fn standing(&self) -> TrainingState {
        self.standing
    }

    /// Returns the number of trials so far, up to the deciding one.
    pub fn trials(&self) -> u32 {
        self.trials
    }

    fn after(&self, met: bool) -> TrainingState {
        let TaskCriterion { consecutive, additional: needed, max_trials, .. } = self.criterion;
        let next = match self.standing {
            TrainingState::Practising { in_a_row } if met && in_a_row + 1 >= consecutive => {
                TrainingState::Confirming { additional: 0 }
            }
            TrainingState::Practising { in_a_row } => {
                TrainingState::Practising { in_a_row: if met { in_a_row + 1 } else { 0 } }
            }
            TrainingState::Confirming { additional } => {
                TrainingState::Confirming { additional: additional + u32::from(met) }
            }
            decided => decided,
        };
        match next {
            TrainingState::Confirming { additional } if additional >= needed => {
                TrainingState::Reached { trial: self.trials }
            }
            _ if self.trials >= max_trials => TrainingState::GivenUp,
            undecided => undecided,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(trials: impl IntoIterator<Item = (f64, u32)>) -> TrainingState {
        let mut proficiency = Proficiency::new(TaskCriterion::default());
        for (time_s, drops) in trials {
            proficiency.take_trial(Some(time_s), drops);
        }
        proficiency.standing()
    }

    #[test]
    fn two_in_a_row_and_then_ten_more_with_failures_between_are_enough() {
        let early = [(47.0, 0), (60.0, 0), (48.0, 0), (30.0, 1), (40.0, 0), (40.0, 0)];
        assert_eq!(after(early), TrainingState::Confirming { additional: 0 });
        let more = std::iter::repeat_n([(48.0, 0), (48.1, 0)], 10).flatten();
        let last = u32::try_from(early.len()).unwrap() + 19;
        assert_eq!(after(early.into_iter().chain(more)), TrainingState::Reached { trial: last });
    }

    #[test]
    fn a_drop_out_of_view_or_an_unfinished_trial_does_not_count() {
        assert_eq!(after([(40.0, 0), (40.0, 1)]), TrainingState::Practising { in_a_row: 0 });
        let mut proficiency = Proficiency::new(TaskCriterion::default());
        proficiency.take_trial(Some(40.0), 0);
        assert_eq!(proficiency.take_trial(None, 0), TrainingState::Practising { in_a_row: 0 });
        assert_eq!(proficiency.take_trial(Some(f64::NAN), 0), TrainingState::Practising { in_a_row: 0 });
    }

    #[test]
    fn training_is_given_up_after_80_trials_and_then_stays_so() {
        let alternating = (0..79).map(|trial| (if trial % 2 == 0 { 40.0 } else { 60.0 }, 0));
        assert_eq!(after(alternating.clone()), TrainingState::Practising { in_a_row: 1 });
        assert_eq!(after(alternating.chain([(60.0, 0)])), TrainingState::GivenUp);
        assert_eq!(
            after(std::iter::repeat_n((60.0, 0), 80).chain(std::iter::repeat_n((40.0, 0), 20))),
            TrainingState::GivenUp
        );
        let just = std::iter::repeat_n((60.0, 0), 68).chain(std::iter::repeat_n((40.0, 0), 12));
        assert_eq!(after(just), TrainingState::Reached { trial: 80 });
    }
}
