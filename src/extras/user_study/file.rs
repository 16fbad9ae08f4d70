//! The study file (TOML): conditions, participants, order, and rules.

use std::{collections::BTreeSet, fmt};

use nima_core::Side;
use nima_score::{CatalogueDefinition, FeedbackSchedule, LONGEST_TRIAL_S, MEASURES, TaskCriterion, TaskFile};
use serde::{Deserialize, Serialize};

use crate::{Condition, ExclusionRule, Label, Questionnaire, unblinding_risk};

pub const PARTICIPANTS_MAX: u32 = 200;
pub const TRIALS_MAX: u32 = 100;
pub const ATTEMPTS_MAX: u32 = 10;
pub const PRACTICE_MAX: u32 = 200;
pub const BREAK_AFTER_MAX: u32 = 1000;
/// Maximum required duration of a break, s.
pub const BREAK_MAX_S: f64 = 7200.0;
const NAME_MAX: usize = 120;

/// A study in its TOML file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyFile {
    /// Name for the screen and the report. In a blind study it must not name a condition.
    pub name: String,
    /// Built-in name or file.
    pub scene: String,
    /// Built-in name or file.
    #[serde(default = "simulated")]
    pub rig: String,
    /// Use only this many rings of the scene, for a short trial.
    #[serde(default)]
    pub rings: Option<u32>,
    /// The scored task, instead of the scene's.
    #[serde(default)]
    pub task: Option<TaskFile>,
    /// Primary measure, chosen before the first trial: a key of `docs/reference/measures.md`, with the hand if it has
    /// one.
    pub primary: String,
    /// Further measures of the report.
    #[serde(default)]
    pub secondary: Vec<String>,
    /// Number of participants.
    pub participants: u32,
    /// Trials under each condition.
    pub trials: u32,
    /// Whether the conditions are hidden until the unblinding.
    #[serde(default = "yes")]
    pub blind: bool,
    /// Makes orders and labels reproducible. With the seed and this file, the labels can be determined, so omit it in a
    /// real study.
    #[serde(default)]
    pub seed: Option<u64>,
    /// Whether every trial is recorded as a session; in a blind study the session is encrypted when the trial is over.
    #[serde(default)]
    pub record: bool,
    /// Action after an interrupted trial.
    #[serde(default)]
    pub interrupted: InterruptionPolicy,
    /// Maximum number of attempts at a trial; after that, it has no result.
    #[serde(default = "three")]
    pub attempts: u32,
    /// The compared conditions.
    pub conditions: Vec<Condition>,
    /// The condition with which the others are compared, in the report after the unblinding.
    #[serde(default)]
    pub reference: Option<String>,
    /// Practice before the first trial.
    #[serde(default)]
    pub practice: Option<Practice>,
    /// After which trials the participant is shown the result.
    #[serde(default)]
    pub feedback: FeedbackSchedule,
    #[serde(default)]
    pub breaks: Option<Breaks>,
    #[serde(default)]
    pub questionnaires: Questionnaires,
    /// Which trials and participants are excluded from the analysis.
    #[serde(default)]
    pub exclusion: Vec<ExclusionRule>,
}

/// Action after a trial that was interrupted or given up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InterruptionPolicy {
    /// The trial is repeated from its beginning, under the same condition, up to the number of attempts.
    #[default]
    Repeat,
    /// The session continues with the next trial; the interrupted one has no result.
    Resume,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Practice {
    /// Name of the condition for practice; by default each in turn, in the participant's order.
    #[serde(default)]
    pub under: Option<String>,
    /// Action if the criterion was not met within the maximum number of trials.
    #[serde(default)]
    pub not_reached: NotReached,
    /// When practice is over.
    pub criterion: TaskCriterion,
}

/// Action for a participant who did not meet the criterion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NotReached {
    /// The trials follow regardless.
    #[default]
    GoOn,
    /// The participant is excluded.
    Exclude,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Breaks {
    /// Number of trials since the last break, including practice.
    pub after_trials: u32,
    /// Minimum duration, s.
    #[serde(rename = "least_s")]
    pub min_s: f64,
}

/// Which questionnaires are filled in, and when.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Questionnaires {
    /// After the last trial under each condition.
    pub after_condition: Vec<Questionnaire>,
    /// Questionnaires at the end.
    pub at_end: Vec<Questionnaire>,
}

/// All mistakes in a study file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistakes(pub Vec<String>);

impl fmt::Display for Mistakes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.as_slice() {
            [one] => write!(f, "the study file has an error: {one}"),
            several => write!(f, "the study file has {} errors: {}", several.len(), several.join("; ")),
        }
    }
}

impl std::error::Error for Mistakes {}

fn simulated() -> String {
    "simulated".to_owned()
}

const fn yes() -> bool {
    true
}

const fn three() -> u32 {
    3
}

/// Returns whether this is the key of a measure: `completion_time_s`, `peak_force_n_right`.
pub(crate) fn is_measure(key: &str) -> bool {
    measure_keys().any(|known| known == key)
}

/// Returns the keys of all measures, in display order.
pub(crate) fn measure_keys() -> impl Iterator<Item = String> {
    MEASURES.iter().flat_map(|definition| keys_of(definition, &Side::LEFT_TO_RIGHT))
}

/// Returns the keys of a measure: one for each of these hands, if it is measured per hand.
pub fn keys_of(definition: &CatalogueDefinition, hands: &[Side]) -> Vec<String> {
    let of = |side: &Side| format!("{}_{}", definition.id, side.word());
    if definition.per_hand { hands.iter().map(of).collect() } else { vec![definition.id.to_owned()] }
}

impl StudyFile {
    /// Parses and checks a study file.
    ///
    /// # Errors
    /// [`Mistakes`]: every wrong value, or why the text cannot be parsed at all.
    pub fn from_toml(text: &str) -> Result<Self, Mistakes> {
        let file: Self = nima_files::from_toml(text)
            .map_err(|misfit| Mistakes(vec![format!("line {}: {}", misfit.line(text), misfit.message())]))?;
        file.check()?;
        Ok(file)
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`Mistakes`]: all wrong values.
    pub fn check(&self) -> Result<(), Mistakes> {
        let mut wrong = Vec::new();
        self.check_numbers(&mut wrong);
        self.check_conditions(&mut wrong);
        self.check_measures(&mut wrong);
        self.check_practice(&mut wrong);
        for (key, asked) in
            [("after_condition", &self.questionnaires.after_condition), ("at_end", &self.questionnaires.at_end)]
        {
            let twice = asked.iter().enumerate().find(|(at, one)| asked[..*at].contains(one));
            wrong.extend(twice.map(|(_, one)| format!("questionnaires.{key}: {} occurs twice", one.name())));
        }
        if self.blind {
            wrong.extend(self.reported_by_name());
        }
        if wrong.is_empty() { Ok(()) } else { Err(Mistakes(wrong)) }
    }

    fn check_numbers(&self, wrong: &mut Vec<String>) {
        let Self { name, participants, trials, attempts, rings, task, breaks, .. } = self;
        if name.trim().is_empty() || name.chars().count() > NAME_MAX || name.chars().any(char::is_control) {
            wrong.push(format!("name must be one line of 1 to {NAME_MAX} characters"));
        }
        let mut within = |key: &str, value: u32, max: u32| {
            if !(1..=max).contains(&value) {
                wrong.push(format!("{key} = {value}: it must be from 1 to {max}"));
            }
        };
        within("participants", *participants, PARTICIPANTS_MAX);
        within("trials", *trials, TRIALS_MAX);
        within("attempts", *attempts, ATTEMPTS_MAX);
        within("rings", rings.unwrap_or(1), 100);
        within("breaks.after_trials", breaks.map_or(1, |breaks| breaks.after_trials), BREAK_AFTER_MAX);
        let min_s = breaks.map_or(0.0, |breaks| breaks.min_s);
        if !(0.0..=BREAK_MAX_S).contains(&min_s) {
            wrong.push(format!("breaks.least_s = {min_s}: it must be from 0 to {BREAK_MAX_S:.0} s"));
        }
        if let Some(Err(error)) = task.as_ref().map(TaskFile::check) {
            wrong.push(format!("task: {error}"));
        }
    }

    fn check_conditions(&self, wrong: &mut Vec<String>) {
        let conditions = &self.conditions;
        if !(2..=Label::MAX).contains(&conditions.len()) {
            wrong.push(format!("there are {} conditions: use 2 to {}", conditions.len(), Label::MAX));
        }
        for (at, condition) in conditions.iter().enumerate() {
            let of = |mistake: String| format!("condition {} (\"{}\"): {mistake}", at + 1, shown(&condition.name));
            wrong.extend(condition.mistakes().into_iter().map(of));
            for before in &conditions[..at] {
                let names = [&before.name, &condition.name].map(|name| shown(name));
                if before.name.to_lowercase() == condition.name.to_lowercase() {
                    wrong.push(format!("two conditions are called \"{}\"", names[0]));
                } else if before.feels_like(condition) {
                    wrong.push(format!("conditions \"{}\" and \"{}\" are the same", names[0], names[1]));
                }
            }
        }
        let known = |name: &String| conditions.iter().any(|condition| condition.name == *name);
        let under = self.practice.as_ref().and_then(|practice| practice.under.as_ref());
        for (key, name) in [("reference", self.reference.as_ref()), ("practice.under", under)] {
            if let Some(name) = name.filter(|name| !known(name)) {
                wrong.push(format!("{key}: there is no condition \"{}\"", shown(name)));
            }
        }
    }

    fn check_measures(&self, wrong: &mut Vec<String>) {
        let measures: Vec<&String> = std::iter::once(&self.primary).chain(&self.secondary).collect();
        let ruled = self.exclusion.iter().map(|rule| &rule.measure);
        for key in measures.iter().copied().chain(ruled) {
            if !is_measure(key) {
                let key = shown(key);
                wrong.push(format!(
                    "there is no measure \"{key}\": docs/reference/measures.md lists all measures; a measure of one hand ends with _left or _right"
                ));
            }
        }
        let mut seen = BTreeSet::new();
        let twice = measures.iter().find(|key| !seen.insert(key.as_str()));
        wrong.extend(twice.map(|key| format!("measure {key} occurs twice")));
        for (at, rule) in self.exclusion.iter().enumerate() {
            let of = |mistake: String| format!("exclusion {}: {mistake}", at + 1);
            wrong.extend(rule.mistakes().into_iter().map(of));
            if self.blind && unblinding_risk::tells(&rule.measure) {
                wrong.push(of(format!(
                    "{} reveals the condition, so a blind study cannot use it in an exclusion rule",
                    rule.measure
                )));
            }
        }
    }

    /// Returns the criterion for skill: that of practice, or that of the study's task.
    pub(crate) fn skill(&self) -> Option<TaskCriterion> {
        let practised = self.practice.as_ref().map(|practice| practice.criterion);
        practised.or_else(|| self.task.as_ref().map(|task| task.proficiency))
    }

    fn check_practice(&self, wrong: &mut Vec<String>) {
        if self.feedback == FeedbackSchedule::Fades && self.skill().is_none() {
            wrong.push(
                "feedback = \"fades\" requires a skill criterion: add [practice.criterion], or a [task] with proficiency"
                    .to_owned(),
            );
        }
        let Some(Practice { criterion, .. }) = &self.practice else { return };
        let TaskCriterion { time_s, consecutive, additional, max_trials, .. } = *criterion;
        if !(time_s > 0.0 && time_s <= LONGEST_TRIAL_S) {
            wrong.push(format!(
                "practice.criterion.time_s = {time_s}: it must be above 0 and at most {LONGEST_TRIAL_S} s"
            ));
        }
        if consecutive == 0 || max_trials == 0 || max_trials > PRACTICE_MAX {
            wrong.push(format!(
                "practice.criterion: consecutive must be at least 1, and max_trials from 1 to {PRACTICE_MAX}"
            ));
        }
        if consecutive.saturating_add(additional) > max_trials {
            wrong.push(format!(
                "practice.criterion: {consecutive} in a row and {additional} more do not fit into {max_trials} trials"
            ));
        }
    }

    /// Returns a name that all users read must not reveal a condition or a number.
    fn reported_by_name(&self) -> Option<String> {
        let words = |text: &str| format!(" {} ", split(text).join(" "));
        let name = words(&self.name);
        let report: Vec<String> = self.conditions.iter().flat_map(Condition::tells).collect();
        let report = report.iter().find(|word| !word.trim().is_empty() && name.contains(&words(word)))?;
        Some(format!(
            "name contains \"{}\", which is part of a condition, and everyone can read it: choose a neutral name",
            shown(report)
        ))
    }
}

/// Returns the words and numbers of a text, in lower case.
fn split(text: &str) -> Vec<String> {
    let parts = text.split(|letter: char| !letter.is_alphanumeric() && letter != '.');
    parts.filter(|part| !part.is_empty()).map(|part| part.trim_matches('.').to_lowercase()).collect()
}

fn shown(text: &str) -> String {
    nima_files::quoted(text)
}
