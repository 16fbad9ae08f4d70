//! Schedule for showing a trainee the result of a trial: always, never, or less often with growing skill.
//!
//! Results after every trial guide a beginner, but those who practise with fewer results learn more, because they do
//! not come to depend on them (guidance hypothesis; Salmoni, Schmidt and Walter 1984, Psychol. Bull. 95:355-386). In
//! two of the three experiments of Winstein and Schmidt 1990 (J. Exp. Psychol. Learn. Mem. Cogn. 16:677-691) results
//! became rarer over practice, by a schedule. Here they become rarer with the skill shown by the trainee's own trials.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::{Score, TaskCriterion};

/// Number of recent trials used to determine skill.
const JUDGED: u32 = 4;
/// Results per trial for a beginner and, halved, for a trainee who always meets the criterion, in units of `1 / (2 *
/// JUDGED)`.
const ALL: u32 = 2 * JUDGED;

/// When the result of a trial is shown to the trainee. Independent of the force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FeedbackSchedule {
    /// After every trial.
    #[default]
    Always,
    /// After every trial at first, and after half of the trials at full skill.
    Fades,
    Never,
}

/// Follows the trials of one person and decides after each trial whether its result is shown.
///
/// With [`FeedbackSchedule::Fades`] results are shown after the fraction `1 - m / 8` of the trials, where `m` is how many of
/// the last four (fewer at the beginning) met the criterion: all of them for a beginner, half of them for a trainee who
/// always meets it. The choice depends only on the trials: the same trials give the same answer.
///
/// ```
/// use nima_score::{TaskCriterion, FeedbackSchedule, Guidance};
///
/// let mut guidance = Guidance::new(FeedbackSchedule::Fades, TaskCriterion::default());
/// let beginner: Vec<bool> = (0..4).map(|_| guidance.take_trial(Some(90.0), 0)).collect();
/// assert_eq!(beginner, [true; 4]);
/// let skilled: Vec<bool> = (0..12).map(|_| guidance.take_trial(Some(40.0), 0)).collect();
/// assert_eq!(skilled[4..].iter().filter(|shown| **shown).count(), 4, "of eight");
/// ```
#[derive(Clone, Debug)]
pub struct Guidance {
    feedback: FeedbackSchedule,
    criterion: TaskCriterion,
    /// Whether each of the last trials met the criterion.
    met: VecDeque<bool>,
    /// The accumulated fraction of a result that is due, in parts of [`ALL`].
    due: u32,
    shown: bool,
}

impl Guidance {
    pub fn new(feedback: FeedbackSchedule, criterion: TaskCriterion) -> Self {
        let met = VecDeque::with_capacity(JUDGED as usize + 1);
        Self { feedback, criterion, met, due: 0, shown: feedback != FeedbackSchedule::Never }
    }

    /// Adds the score of the next trial; returns whether its result is shown.
    pub fn take(&mut self, score: &Score) -> bool {
        let drops = score.value("drops_out_of_view").unwrap_or(0.0);
        self.take_trial(score.value("completion_time_s"), drops as u32)
    }

    /// Adds the next trial by its completion time (s; `None` if it was not completed) and its drops out of view;
    /// returns whether its result is shown.
    pub fn take_trial(&mut self, completion_time_s: Option<f64>, drops_out_of_view: u32) -> bool {
        self.met.push_back(self.criterion.is_met(completion_time_s, drops_out_of_view));
        if self.met.len() > JUDGED as usize {
            self.met.pop_front();
        }
        self.due += ALL - self.skill();
        self.shown = match self.feedback {
            FeedbackSchedule::Always => true,
            FeedbackSchedule::Never => false,
            FeedbackSchedule::Fades => self.due >= ALL,
        };
        if self.due >= ALL {
            self.due -= ALL;
        }
        self.shown
    }

    /// Returns whether the result of the newest trial is shown.
    pub fn is_shown(&self) -> bool {
        self.shown
    }

    /// Returns the fraction of the trials whose results are shown, at the current skill.
    pub fn frequency(&self) -> f64 {
        match self.feedback {
            FeedbackSchedule::Always => 1.0,
            FeedbackSchedule::Never => 0.0,
            FeedbackSchedule::Fades => f64::from(ALL - self.skill()) / f64::from(ALL),
        }
    }

    /// Returns how many of the last trials met the criterion.
    fn skill(&self) -> u32 {
        self.met.iter().filter(|met| **met).count() as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: (Option<f64>, u32) = (Some(40.0), 0);
    const SLOW: (Option<f64>, u32) = (Some(60.0), 0);

    fn shown(feedback: FeedbackSchedule, trials: &[(Option<f64>, u32)]) -> Vec<bool> {
        let mut guidance = Guidance::new(feedback, TaskCriterion::default());
        trials.iter().map(|(time_s, drops)| guidance.take_trial(*time_s, *drops)).collect()
    }

    fn count(shown: &[bool]) -> usize {
        shown.iter().filter(|shown| **shown).count()
    }

    #[test]
    fn always_is_after_every_trial_and_never_after_none() {
        for trials in [[GOOD; 12], [SLOW; 12]] {
            assert_eq!(
                (count(&shown(FeedbackSchedule::Always, &trials)), count(&shown(FeedbackSchedule::Never, &trials))),
                (12, 0)
            );
        }
    }

    #[test]
    fn it_fades_from_every_trial_to_every_second_one_as_the_criterion_is_met() {
        let trials = [[SLOW; 8], [GOOD; 8], [GOOD; 8]].concat();
        let shown = shown(FeedbackSchedule::Fades, &trials);
        assert_eq!([&shown[..8], &shown[8..16], &shown[16..]].map(count), [8, 4, 4], "{shown:?}");
        assert!(shown[16..].windows(2).all(|pair| pair[0] != pair[1]), "every second one: {shown:?}");
    }

    #[test]
    fn it_comes_back_when_skill_is_lost_and_drops_and_trials_not_completed_are_no_skill() {
        let lost = [[GOOD; 8], [SLOW; 8]].concat();
        assert_eq!(count(&shown(FeedbackSchedule::Fades, &lost)[12..]), 4);
        for without in [(Some(40.0), 1), (None, 0)] {
            assert_eq!(count(&shown(FeedbackSchedule::Fades, &[without; 12])), 12, "{without:?}");
        }
    }

    #[test]
    fn the_frequency_is_that_of_the_last_four_trials() {
        let mut guidance = Guidance::new(FeedbackSchedule::Fades, TaskCriterion::default());
        let frequencies: Vec<f64> = [SLOW, GOOD, GOOD, GOOD, GOOD, SLOW]
            .into_iter()
            .map(|(time_s, drops)| {
                guidance.take_trial(time_s, drops);
                guidance.frequency()
            })
            .collect();
        assert_eq!(frequencies, [1.0, 0.875, 0.75, 0.625, 0.5, 0.625]);
    }

    #[test]
    fn the_switch_is_one_word_of_a_file() {
        for (word, feedback) in [
            ("always", FeedbackSchedule::Always),
            ("fades", FeedbackSchedule::Fades),
            ("never", FeedbackSchedule::Never),
        ] {
            let text = format!("\"{word}\"");
            assert_eq!(serde_json::from_str::<FeedbackSchedule>(&text).unwrap(), feedback);
            assert_eq!(serde_json::to_string(&feedback).unwrap(), text);
        }
        assert_eq!(FeedbackSchedule::default(), FeedbackSchedule::Always);
    }
}
