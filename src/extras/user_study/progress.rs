//! Progress of one participant.

use std::collections::BTreeMap;

use nima_score::{Guidance, Proficiency, TrainingState};
use serde::Serialize;

use crate::{
    EndReason, InterruptionPolicy, Label, NotReached, Participant, Questionnaire, QuestionnaireAnswers, StudyPlan,
    StudyStep, TrialEnding, TrialId, TrialMeasures, TrialPhase,
};

/// A finished trial that counts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CountedTrial {
    /// From 1.
    pub number: u32,
    /// The label of its condition.
    pub label: Label,
    /// The attempt that counts, or the last one.
    pub attempt: u32,
    /// How it ended; `None` without a result.
    pub ending: Option<TrialEnding>,
    /// `None` without a result.
    pub measures: Option<TrialMeasures>,
    /// Measures that reveal the condition, encrypted.
    #[serde(skip)]
    pub withheld: Option<String>,
    /// Whether the trial was done by a simulated person.
    pub simulated: bool,
    /// Whether the trial was done after the unblinding of a blind study.
    pub unblinded: bool,
}

/// Progress of one participant.
#[derive(Clone, Debug, Default)]
pub struct ParticipantProgress {
    /// Whether the participant has started.
    pub began: bool,
    /// Times of the practice trials, s; NaN for one that was not completed.
    pub practice_s: Vec<f64>,
    /// `None` without practice.
    pub practice: Option<Proficiency>,
    /// Which results are shown to the participant.
    guidance: Option<Guidance>,
    /// The finished trials, in order.
    pub trials: Vec<CountedTrial>,
    /// Breaks taken, s.
    pub breaks_s: Vec<f64>,
    /// Answers, each with the condition to which they refer, and whether they were simulated.
    pub answers: Vec<(Option<Label>, QuestionnaireAnswers, bool)>,
    /// Why the participant is excluded.
    pub excluded: Option<String>,
    /// Trials excluded by a person, with the reasons.
    pub excluded_trials: BTreeMap<u32, String>,
    /// Total number of attempts that were interrupted or given up.
    pub interruptions: u32,
    /// Finished attempts at the current trial.
    attempts: u32,
    /// Those of them that do not count.
    stalls: u32,
    open: Option<(TrialId, bool)>,
    since_break: u32,
}

impl ParticipantProgress {
    pub(crate) fn of(plan: &StudyPlan) -> Self {
        let guidance = Guidance::new(plan.feedback.rule, plan.feedback.criterion);
        let practice = plan.practice.map(|practice| Proficiency::new(practice.criterion));
        Self { practice, guidance: Some(guidance), ..Self::default() }
    }

    pub(crate) fn rest(&mut self, seconds: f64) {
        self.breaks_s.push(seconds);
        self.since_break = 0;
    }

    /// Returns the trial that has begun and not ended.
    pub fn open(&self) -> Option<TrialId> {
        self.open.map(|(trial, _)| trial)
    }

    /// Returns whether the participant may be shown the result of the last finished trial: it follows from the rule of
    /// the study and this participant's trials, including practice.
    pub fn shows_result(&self) -> bool {
        self.guidance.as_ref().is_none_or(Guidance::is_shown)
    }

    /// Returns the number of trials made since the last break, including practice.
    pub const fn since_break(&self) -> u32 {
        self.since_break
    }

    pub(crate) fn next(&self, plan: &StudyPlan, participant: &Participant) -> StudyStep {
        if let Some((trial, _)) = self.open {
            return StudyStep::Running { trial };
        }
        if self.excluded.is_some() {
            return StudyStep::Done { why: EndReason::Excluded };
        }
        let attempt = self.attempts + 1;
        let made = self.trials.len() as u32;
        let practises = made == 0 && self.practice.as_ref().is_some_and(practises);
        if !practises && let Some(asked) = self.asked(plan, participant, made) {
            return asked;
        }
        let number = made + 1;
        let step = if practises {
            StudyStep::Practice { number: self.practice_s.len() as u32 + 1, attempt }
        } else {
            match plan.label(participant, number) {
                Some(label) => StudyStep::Trial { number, attempt, label },
                None => return StudyStep::Done { why: EndReason::Finished },
            }
        };
        // A repeated trial follows at once; the break comes after it.
        match plan.breaks {
            Some(breaks) if attempt == 1 && self.since_break >= breaks.after_trials => {
                StudyStep::Break { min_s: breaks.min_s }
            }
            _ => step,
        }
    }

    /// Returns the questionnaire that is due after this many trials.
    fn asked(&self, plan: &StudyPlan, participant: &Participant, made: u32) -> Option<StudyStep> {
        let is_answered = |questionnaire: Questionnaire, after: Option<Label>| {
            self.answers.iter().any(|(of, answers, _)| answers.questionnaire() == questionnaire && *of == after)
        };
        let due = |all: &[Questionnaire], after: Option<Label>| {
            let next = all.iter().copied().find(|questionnaire| !is_answered(*questionnaire, after))?;
            Some(StudyStep::Questionnaire { questionnaire: next, after })
        };
        let is_block_over = made > 0 && made.is_multiple_of(plan.trials);
        let after = plan.label(participant, made).filter(|_| is_block_over);
        let about = after.and_then(|label| due(&plan.questionnaires.after_condition, Some(label)));
        about.or_else(|| due(&plan.questionnaires.at_end, None).filter(|_| made == plan.trials_of_each()))
    }

    pub(crate) fn begin(
        &mut self,
        plan: &StudyPlan,
        participant: &Participant,
        trial: TrialId,
        label: Option<Label>,
        simulated: bool,
    ) -> Result<(), String> {
        let next = self.next(plan, participant);
        if next.trial() != Some((trial, label)) {
            let TrialId { phase, number, attempt } = trial;
            let what = if phase == TrialPhase::Practice { "practice trial" } else { "trial" };
            return Err(format!(
                "{} began {what} {number}, attempt {attempt}, but the next step is {next}",
                participant.name
            ));
        }
        self.open = Some((trial, simulated));
        Ok(())
    }

    pub(crate) fn close(&mut self, trial: TrialId, participant: &str) -> Result<bool, String> {
        match self.open.take() {
            Some((open, simulated)) if open == trial => Ok(simulated),
            _ => Err(format!("trial {} of {participant} ended, but it had not begun", trial.number)),
        }
    }

    pub(crate) fn end(
        &mut self,
        plan: &StudyPlan,
        participant: &Participant,
        trial: TrialId,
        result: Option<(TrialEnding, TrialMeasures, Option<String>)>,
        simulated: bool,
        unblinded: bool,
    ) {
        self.attempts = 0;
        self.stalls = 0;
        self.since_break += 1;
        if let (Some((_, measures, _)), Some(guidance)) = (&result, &mut self.guidance) {
            let (time_s, drops) = judged(measures);
            guidance.take_trial(time_s, drops);
        }
        if trial.phase == TrialPhase::Practice {
            return self.practised(plan, result);
        }
        let Some(label) = plan.label(participant, trial.number) else { return };
        let (ending, measures, withheld) =
            result.map_or((None, None, None), |(ending, measures, withheld)| (Some(ending), Some(measures), withheld));
        let TrialId { number, attempt, .. } = trial;
        self.trials.push(CountedTrial { number, label, attempt, ending, measures, withheld, simulated, unblinded });
    }

    fn practised(&mut self, plan: &StudyPlan, result: Option<(TrialEnding, TrialMeasures, Option<String>)>) {
        let measures = result.map(|(_, measures, _)| measures).unwrap_or_default();
        let (time_s, drops) = judged(&measures);
        self.practice_s.push(time_s.unwrap_or(f64::NAN));
        let standing = self.practice.as_mut().map(|practice| practice.take_trial(time_s, drops));
        let excludes = plan.practice.is_some_and(|practice| practice.not_reached == NotReached::Exclude);
        if standing == Some(TrainingState::GivenUp) && excludes {
            self.excluded.get_or_insert_with(|| "the criterion of practice was not reached".to_owned());
        }
    }

    /// Allows another attempt at the current trial instead of one in which the computer stalled.
    pub(crate) const fn allow_attempt(&mut self) {
        self.stalls += 1;
    }

    /// The trial is repeated until no attempts are left; by the other rule a trial that counts is over at once.
    pub(crate) fn interrupt(
        &mut self,
        plan: &StudyPlan,
        participant: &Participant,
        trial: TrialId,
        simulated: bool,
        unblinded: bool,
    ) {
        self.interruptions += 1;
        self.attempts += 1;
        let resumes = plan.interrupted == InterruptionPolicy::Resume && trial.phase == TrialPhase::Trial;
        if resumes || self.attempts - self.stalls >= plan.attempts {
            self.end(plan, participant, trial, None, simulated, unblinded);
        }
    }
}

/// Returns the values that a criterion judges: completion time, s, and drops out of view.
fn judged(measures: &TrialMeasures) -> (Option<f64>, u32) {
    let drops = measures.get("drops_out_of_view").copied().unwrap_or(0.0);
    (measures.get("completion_time_s").copied(), drops as u32)
}

fn practises(practice: &Proficiency) -> bool {
    matches!(practice.standing(), TrainingState::Practising { .. } | TrainingState::Confirming { .. })
}
