//! The assignment of labels to conditions.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{Condition, Label, StudyFile, order, seal};

/// The assignment in the form that is sealed, committed to, and shown after the unblinding. Its `Debug` output reveals
/// nothing.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub struct Assignment {
    /// Random text, so that the few possible assignments cannot be found by hashing all of them.
    salt: String,
    /// The condition of each label, by name.
    labels: BTreeMap<Label, String>,
    conditions: Vec<Condition>,
    reference: Option<String>,
    practice: Option<String>,
    seed: Option<u64>,
    /// Hashes of `study.toml` (without the commitment) and of the scene; absent in older studies.
    #[serde(default)]
    rules: Option<RuleHashes>,
}

/// Hashes of the files that the commitment covers too.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct RuleHashes {
    pub(crate) study: String,
    pub(crate) scene: String,
}

impl RuleHashes {
    /// Fits no file.
    pub(crate) const NONE: Self = Self { study: String::new(), scene: String::new() };
}

impl std::fmt::Debug for Assignment {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Opened")
    }
}

impl Assignment {
    /// Draws an assignment for a checked file.
    pub(crate) fn draw(file: &StudyFile) -> std::io::Result<Self> {
        // Drawn separately from the seed of the orders, which is public.
        let seed = match file.seed {
            Some(seed) => seed ^ 0x6c61_6265_6c73,
            None => u64::from_le_bytes(seal::random()?),
        };
        let places = order::assignment(file.conditions.len(), seed);
        let names = places.into_iter().filter_map(|at| file.conditions.get(at)).map(|condition| condition.name.clone());
        Ok(Self {
            salt: seal::hex(&seal::random::<32>()?),
            labels: Label::first(file.conditions.len()).into_iter().zip(names).collect(),
            conditions: file.conditions.clone(),
            reference: file.reference.clone(),
            practice: file.practice.as_ref().and_then(|practice| practice.under.clone()),
            seed: file.seed,
            rules: None,
        })
    }

    /// Commits to these files too.
    pub(crate) fn with_rules(self, rules: RuleHashes) -> Self {
        Self { rules: Some(rules), ..self }
    }

    pub(crate) const fn rules(&self) -> Option<&RuleHashes> {
        self.rules.as_ref()
    }

    /// Returns the condition of a label.
    pub fn condition(&self, label: Label) -> Option<&Condition> {
        self.named(self.labels.get(&label)?)
    }

    /// Returns every label with the name of its condition.
    pub fn labels(&self) -> impl Iterator<Item = (Label, &str)> {
        self.labels.iter().map(|(label, name)| (*label, name.as_str()))
    }

    /// Returns the condition with which the others are compared.
    pub fn reference(&self) -> Option<&str> {
        self.reference.as_deref()
    }

    /// Returns the condition of practice, if it is always the same.
    pub(crate) fn practice(&self) -> Option<&Condition> {
        self.named(self.practice.as_ref()?)
    }

    fn named(&self, name: &str) -> Option<&Condition> {
        self.conditions.iter().find(|condition| condition.name == name)
    }
}
