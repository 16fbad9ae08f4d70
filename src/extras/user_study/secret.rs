//! Which label stands for which condition.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{Condition, Label, StudyFile, order, seal};

/// The assignment as it is sealed, committed to, and shown after the unblinding. Its `Debug` shows nothing of it.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub struct Opened {
    /// Random, so that nobody finds the few possible assignments by hashing them all.
    salt: String,
    /// Which label stands for which condition, by name.
    labels: BTreeMap<Label, String>,
    conditions: Vec<Condition>,
    reference: Option<String>,
    practice: Option<String>,
    seed: Option<u64>,
}

impl std::fmt::Debug for Opened {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Opened")
    }
}

impl Opened {
    /// Of a file that was checked.
    pub(crate) fn draw(file: &StudyFile) -> std::io::Result<Self> {
        // Drawn apart from the seed of the orders, which everybody sees.
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
        })
    }

    /// The condition that a label stands for.
    pub fn condition(&self, label: Label) -> Option<&Condition> {
        self.named(self.labels.get(&label)?)
    }

    /// Every label with the name of its condition.
    pub fn labels(&self) -> impl Iterator<Item = (Label, &str)> {
        self.labels.iter().map(|(label, name)| (*label, name.as_str()))
    }

    /// The condition with which others are compared.
    pub fn reference(&self) -> Option<&str> {
        self.reference.as_deref()
    }

    /// The condition of practice, if it is always the same.
    pub(crate) fn practice(&self) -> Option<&Condition> {
        self.named(self.practice.as_ref()?)
    }

    fn named(&self, name: &str) -> Option<&Condition> {
        self.conditions.iter().find(|condition| condition.name == name)
    }
}
