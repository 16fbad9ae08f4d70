//! Where a study stands: a pure function of its plan and its journal.

use std::collections::BTreeMap;

use nima_score::{Proficiency, Standing};
use serde::Serialize;

use crate::{
    Answers, Ending, Entry, Event, Interrupted, Label, Measures, NotReached, Participant, Phase, Plan, Questionnaire,
    TrialId,
};

/// What a participant does next.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "step", rename_all = "snake_case")]
pub enum Step {
    /// A trial for practice.
    Practice {
        /// Its number, from 1.
        number: u32,
        /// From 1.
        attempt: u32,
    },
    /// A trial that counts.
    Trial {
        /// Its number, from 1.
        number: u32,
        /// From 1.
        attempt: u32,
        /// What stands for its condition.
        label: Label,
    },
    /// A break.
    Break {
        /// For at least so long, s.
        least_s: f64,
    },
    /// A questionnaire.
    Questionnaire {
        /// Which.
        questionnaire: Questionnaire,
        /// About which condition; `None` at the end.
        after: Option<Label>,
    },
    /// A trial has begun and has not ended: it runs, or the program ended in the middle of it.
    Running {
        /// Which.
        trial: TrialId,
    },
    /// Nothing.
    Done {
        /// Why.
        why: Done,
    },
}

/// Why there is nothing left to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Done {
    /// All was done.
    Finished,
    /// The participant is excluded.
    Excluded,
}

/// A trial that counts and is over.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Made {
    /// Its number, from 1.
    pub number: u32,
    /// What stands for its condition.
    pub label: Label,
    /// The attempt that counts, or the last one.
    pub attempt: u32,
    /// How it ended; `None` without a result.
    pub ending: Option<Ending>,
    /// Its measures; `None` without a result.
    pub measures: Option<Measures>,
    /// Measures that tell the condition, encrypted.
    #[serde(skip)]
    pub withheld: Option<String>,
    /// By a simulated person.
    pub simulated: bool,
    /// Made after the unblinding of a blind study.
    pub unblinded: bool,
}

/// What one participant has done.
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// Has begun.
    pub began: bool,
    /// Times of the practice trials, s; NaN for one that was not completed.
    pub practice_s: Vec<f64>,
    /// Practice, if there is any.
    pub practice: Option<Proficiency>,
    /// The trials that are over, in order.
    pub trials: Vec<Made>,
    /// Breaks taken, s.
    pub breaks_s: Vec<f64>,
    /// Answers, each with the condition that they are about, and whether they were simulated.
    pub answers: Vec<(Option<Label>, Answers, bool)>,
    /// Why the participant is excluded.
    pub excluded: Option<String>,
    /// Trials that a person left out, and why.
    pub excluded_trials: BTreeMap<u32, String>,
    /// Attempts that were interrupted or given up, in all.
    pub interruptions: u32,
    /// Attempts at the present trial that are over.
    attempts: u32,
    open: Option<(TrialId, bool)>,
    since_break: u32,
}

/// The unblinding.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unblinding {
    /// Who asked for it.
    pub who: String,
    /// Why.
    pub why: String,
    /// When.
    pub at: String,
    /// Trials that had a result then.
    pub trials_before: usize,
    /// Whether every participant had finished.
    pub complete: bool,
}

/// Where a study stands.
#[derive(Clone, Debug)]
pub struct State {
    participants: BTreeMap<String, Progress>,
    /// The first unblinding.
    pub unblinding: Option<Unblinding>,
    /// Notes: when, about whom, what.
    pub notes: Vec<(String, Option<String>, String)>,
    /// Lines that a power cut tore, bytes.
    pub torn: Vec<u64>,
}

impl State {
    /// Before the first entry.
    pub fn new(plan: &Plan) -> Self {
        let progress = || Progress {
            practice: plan.practice.map(|practice| Proficiency::new(practice.criterion)),
            ..Progress::default()
        };
        let participants = plan.participants.iter().map(|participant| (participant.name.clone(), progress())).collect();
        Self { participants, unblinding: None, notes: Vec::new(), torn: Vec::new() }
    }

    /// After these entries.
    ///
    /// # Errors
    /// The number of the first entry that cannot follow those before it, and why.
    pub fn of<'a>(plan: &Plan, entries: impl IntoIterator<Item = &'a Entry>) -> Result<Self, (u64, String)> {
        let mut state = Self::new(plan);
        for entry in entries {
            state.take(plan, entry).map_err(|why| (entry.n, why))?;
        }
        Ok(state)
    }

    /// The participants and what they have done, in the order of their names.
    pub fn participants(&self) -> impl Iterator<Item = (&str, &Progress)> {
        self.participants.iter().map(|(name, progress)| (name.as_str(), progress))
    }

    /// What this one has done.
    pub fn progress(&self, participant: &str) -> Option<&Progress> {
        self.participants.get(participant)
    }

    /// Whether conditions may be shown.
    pub fn is_open(&self, plan: &Plan) -> bool {
        !plan.blind || self.unblinding.is_some()
    }

    /// Trials with a result.
    pub fn results(&self) -> usize {
        self.participants.values().flat_map(|one| &one.trials).filter(|made| made.measures.is_some()).count()
    }

    /// Whether some of it was done by simulated people.
    pub fn is_simulated(&self) -> bool {
        let simulated =
            |one: &Progress| one.trials.iter().any(|made| made.simulated) || one.answers.iter().any(|given| given.2);
        self.participants.values().any(simulated)
    }

    /// What this participant does next.
    pub fn next(&self, plan: &Plan, participant: &Participant) -> Step {
        let Some(progress) = self.participants.get(&participant.name) else {
            return Step::Done { why: Done::Excluded };
        };
        progress.next(plan, participant)
    }

    /// Takes the next entry.
    ///
    /// # Errors
    /// Why it cannot follow those before it.
    pub(crate) fn take(&mut self, plan: &Plan, entry: &Entry) -> Result<(), String> {
        let unblinded = plan.blind && self.unblinding.is_some();
        match &entry.event {
            Event::StudyMade { commitment } | Event::Unblinded { commitment, .. } if *commitment != plan.commitment => {
                return Err("the commitment is not that of study.toml: one of the two files was changed".to_owned());
            }
            Event::StudyMade { .. } => {}
            Event::ParticipantBegan { participant } => found(plan, &mut self.participants, participant)?.1.began = true,
            Event::TrialBegan { participant, trial, label, simulated } => {
                let (who, progress) = found(plan, &mut self.participants, participant)?;
                progress.begin(plan, who, *trial, *label, *simulated)?;
            }
            Event::TrialEnded { participant, trial, ending, measures, withheld, .. } => {
                let (who, progress) = found(plan, &mut self.participants, participant)?;
                let simulated = progress.close(*trial, participant)?;
                progress.end(
                    plan,
                    who,
                    *trial,
                    Some((*ending, measures.clone(), withheld.clone())),
                    simulated,
                    unblinded,
                );
            }
            Event::TrialAborted { participant, trial, .. } | Event::TrialInterrupted { participant, trial } => {
                let (who, progress) = found(plan, &mut self.participants, participant)?;
                let simulated = progress.close(*trial, participant)?;
                progress.interrupt(plan, who, *trial, simulated, unblinded);
            }
            Event::BreakTaken { participant, seconds, .. } => {
                let progress = found(plan, &mut self.participants, participant)?.1;
                progress.breaks_s.push(*seconds);
                progress.since_break = 0;
            }
            Event::Answered { participant, after, answers, simulated } => {
                let (who, progress) = found(plan, &mut self.participants, participant)?;
                let asked = Step::Questionnaire { questionnaire: answers.questionnaire(), after: *after };
                let next = progress.next(plan, who);
                if next != asked {
                    return Err(format!(
                        "{participant} answered {}, but next is {next}",
                        answers.questionnaire().name()
                    ));
                }
                progress.answers.push((*after, answers.clone(), *simulated));
            }
            Event::Excluded { participant, number: None, why } => {
                found(plan, &mut self.participants, participant)?.1.excluded.get_or_insert_with(|| why.clone());
            }
            Event::Excluded { participant, number: Some(number), why } => {
                let progress = found(plan, &mut self.participants, participant)?.1;
                if !progress.trials.iter().any(|made| made.number == *number) {
                    return Err(format!("{participant} has not made trial {number}"));
                }
                progress.excluded_trials.insert(*number, why.clone());
            }
            Event::Noted { participant, text } => {
                self.notes.push((entry.at.clone(), participant.clone(), text.clone()));
            }
            Event::TornLineDropped { bytes } => self.torn.push(*bytes),
            Event::Unblinded { who, why, .. } => self.unblind(plan, entry, who, why),
        }
        Ok(())
    }

    fn unblind(&mut self, plan: &Plan, entry: &Entry, who: &str, why: &str) {
        let is_done = |participant: &Participant| matches!(self.next(plan, participant), Step::Done { .. });
        let unblinding = Unblinding {
            who: who.to_owned(),
            why: why.to_owned(),
            at: entry.at.clone(),
            trials_before: self.results(),
            complete: plan.participants.iter().all(is_done),
        };
        self.unblinding.get_or_insert(unblinding);
    }
}

impl Progress {
    /// The trial that has begun and not ended.
    pub fn open(&self) -> Option<TrialId> {
        self.open.map(|(trial, _)| trial)
    }

    /// Trials made since the last break, practice included.
    pub const fn since_break(&self) -> u32 {
        self.since_break
    }

    fn next(&self, plan: &Plan, participant: &Participant) -> Step {
        if let Some((trial, _)) = self.open {
            return Step::Running { trial };
        }
        if self.excluded.is_some() {
            return Step::Done { why: Done::Excluded };
        }
        let attempt = self.attempts + 1;
        let made = self.trials.len() as u32;
        let practises = made == 0 && self.practice.as_ref().is_some_and(practises);
        if !practises && let Some(asked) = self.asked(plan, participant, made) {
            return asked;
        }
        let number = made + 1;
        let step = if practises {
            Step::Practice { number: self.practice_s.len() as u32 + 1, attempt }
        } else {
            match plan.label(participant, number) {
                Some(label) => Step::Trial { number, attempt, label },
                None => return Step::Done { why: Done::Finished },
            }
        };
        // A trial that is repeated follows at once; the break is due after it.
        match plan.breaks {
            Some(breaks) if attempt == 1 && self.since_break >= breaks.after_trials => {
                Step::Break { least_s: breaks.least_s }
            }
            _ => step,
        }
    }

    /// The questionnaire that is due after so many trials.
    fn asked(&self, plan: &Plan, participant: &Participant, made: u32) -> Option<Step> {
        let is_answered = |questionnaire: Questionnaire, after: Option<Label>| {
            self.answers.iter().any(|(of, answers, _)| answers.questionnaire() == questionnaire && *of == after)
        };
        let due = |all: &[Questionnaire], after: Option<Label>| {
            let next = all.iter().copied().find(|questionnaire| !is_answered(*questionnaire, after))?;
            Some(Step::Questionnaire { questionnaire: next, after })
        };
        let is_block_over = made > 0 && made.is_multiple_of(plan.trials);
        let after = plan.label(participant, made).filter(|_| is_block_over);
        let about = after.and_then(|label| due(&plan.questionnaires.after_condition, Some(label)));
        about.or_else(|| due(&plan.questionnaires.at_end, None).filter(|_| made == plan.trials_of_each()))
    }

    fn begin(
        &mut self,
        plan: &Plan,
        participant: &Participant,
        trial: TrialId,
        label: Option<Label>,
        simulated: bool,
    ) -> Result<(), String> {
        let next = self.next(plan, participant);
        if next.trial() != Some((trial, label)) {
            let TrialId { phase, number, attempt } = trial;
            let what = if phase == Phase::Practice { "practice trial" } else { "trial" };
            return Err(format!("{} began {what} {number}, attempt {attempt}, but next is {next}", participant.name));
        }
        self.open = Some((trial, simulated));
        Ok(())
    }

    fn close(&mut self, trial: TrialId, participant: &str) -> Result<bool, String> {
        match self.open.take() {
            Some((open, simulated)) if open == trial => Ok(simulated),
            _ => Err(format!("trial {} of {participant} ended, but it had not begun", trial.number)),
        }
    }

    fn end(
        &mut self,
        plan: &Plan,
        participant: &Participant,
        trial: TrialId,
        result: Option<(Ending, Measures, Option<String>)>,
        simulated: bool,
        unblinded: bool,
    ) {
        self.attempts = 0;
        self.since_break += 1;
        if trial.phase == Phase::Practice {
            return self.practised(plan, result);
        }
        let Some(label) = plan.label(participant, trial.number) else { return };
        let (ending, measures, withheld) =
            result.map_or((None, None, None), |(ending, measures, withheld)| (Some(ending), Some(measures), withheld));
        let TrialId { number, attempt, .. } = trial;
        self.trials.push(Made { number, label, attempt, ending, measures, withheld, simulated, unblinded });
    }

    fn practised(&mut self, plan: &Plan, result: Option<(Ending, Measures, Option<String>)>) {
        let measures = result.map(|(_, measures, _)| measures).unwrap_or_default();
        let time_s = measures.get("completion_time_s").copied();
        let drops = measures.get("drops_out_of_view").copied().unwrap_or(0.0);
        self.practice_s.push(time_s.unwrap_or(f64::NAN));
        let standing = self.practice.as_mut().map(|practice| practice.take_trial(time_s, drops as u32));
        let excludes = plan.practice.is_some_and(|practice| practice.not_reached == NotReached::Exclude);
        if standing == Some(Standing::GivenUp) && excludes {
            self.excluded.get_or_insert_with(|| "the criterion of practice was not reached".to_owned());
        }
    }

    /// A practice trial is done again; one that counts by the rule.
    fn interrupt(&mut self, plan: &Plan, participant: &Participant, trial: TrialId, simulated: bool, unblinded: bool) {
        self.interruptions += 1;
        self.attempts += 1;
        let is_over = plan.interrupted == Interrupted::Resume || self.attempts >= plan.attempts;
        if trial.phase == Phase::Trial && is_over {
            self.end(plan, participant, trial, None, simulated, unblinded);
        }
    }
}

/// A participant, and what this one has done.
fn found<'a>(
    plan: &'a Plan,
    participants: &'a mut BTreeMap<String, Progress>,
    name: &str,
) -> Result<(&'a Participant, &'a mut Progress), String> {
    let participant = plan.participant(name).map_err(|error| error.to_string())?;
    let progress = participants.get_mut(name).ok_or_else(|| format!("there is no {name}"))?;
    Ok((participant, progress))
}

fn practises(practice: &Proficiency) -> bool {
    matches!(practice.standing(), Standing::Practising { .. } | Standing::Confirming { .. })
}

impl Step {
    /// The trial that it is, with its label if it counts.
    pub(crate) fn trial(&self) -> Option<(TrialId, Option<Label>)> {
        match *self {
            Self::Practice { number, attempt } => Some((TrialId { phase: Phase::Practice, number, attempt }, None)),
            Self::Trial { number, attempt, label } => {
                Some((TrialId { phase: Phase::Trial, number, attempt }, Some(label)))
            }
            _ => None,
        }
    }
}

impl std::fmt::Display for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let again = |attempt: u32| if attempt > 1 { format!(", attempt {attempt}") } else { String::new() };
        match self {
            Self::Practice { number, attempt } => write!(f, "practice trial {number}{}", again(*attempt)),
            Self::Trial { number, attempt, label } => {
                write!(f, "trial {number} under condition {label}{}", again(*attempt))
            }
            Self::Break { least_s } => write!(f, "a break of at least {least_s:.0} s"),
            Self::Questionnaire { questionnaire, after: Some(label) } => {
                write!(f, "questionnaire {} about condition {label}", questionnaire.name())
            }
            Self::Questionnaire { questionnaire, after: None } => {
                write!(f, "questionnaire {} at the end", questionnaire.name())
            }
            Self::Running { trial } => write!(f, "the end of trial {}, which has begun", trial.number),
            Self::Done { why: Done::Finished } => write!(f, "nothing: all is done"),
            Self::Done { why: Done::Excluded } => write!(f, "nothing: the participant is excluded"),
        }
    }
}
