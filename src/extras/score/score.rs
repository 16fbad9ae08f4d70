//! The measures of one trial.

use nima_core::{SIDES, Side};
use serde::{Serialize, Serializer, ser::SerializeMap};

use crate::{CatalogueDefinition, MEASURES};

/// Outcome of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialOutcome {
    /// The task was completed within the time limit.
    Completed,
    OutOfTime,
    /// The trial was given up.
    Aborted,
    /// The samples end before any of these.
    Unfinished,
}

/// One measure of a trial; of one hand if it has a side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// Id, text, unit, definition and source.
    pub definition: &'static CatalogueDefinition,
    /// The hand; `None` for a measure of the whole trial.
    pub side: Option<Side>,
    /// In the unit of the definition, always finite. `None` if there is nothing to measure: no such hand, another task,
    /// no contact.
    pub value: Option<f64>,
}

impl Measure {
    /// Returns the key in JSON: the id, and the hand if the measure has one (`path_length_m_right`).
    pub fn key(&self) -> String {
        match self.side {
            Some(side) => format!("{}_{}", self.definition.id, side.word()),
            None => self.definition.id.to_owned(),
        }
    }
}

/// All measures of a trial. Serialises to one flat object of keys and numbers, with `null` for missing values.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    outcome: TrialOutcome,
    /// For each of [`MEASURES`]: both sides, or the whole trial at the first index.
    values: Vec<[Option<f64>; SIDES]>,
}

impl Score {
    pub(crate) fn new(outcome: TrialOutcome) -> Self {
        Self { outcome, values: vec![[None; SIDES]; MEASURES.len()] }
    }

    pub fn outcome(&self) -> TrialOutcome {
        self.outcome
    }

    /// Returns a measure of the whole trial; also `None` for an unknown id.
    pub fn value(&self, id: &str) -> Option<f64> {
        let place = MEASURES.iter().position(|definition| definition.id == id && !definition.per_hand)?;
        self.values.get(place)?[0]
    }

    /// Returns a measure of one hand; also `None` for an unknown id.
    pub fn of(&self, id: &str, side: Side) -> Option<f64> {
        let place = MEASURES.iter().position(|definition| definition.id == id && definition.per_hand)?;
        self.values.get(place)?[side.index()]
    }

    /// Returns every measure, in the order of [`MEASURES`]; left and right if the hands are measured separately.
    pub fn measures(&self) -> impl Iterator<Item = Measure> {
        MEASURES.iter().zip(&self.values).flat_map(|(definition, values)| {
            let of = |side: Side| Measure { definition, side: Some(side), value: values[side.index()] };
            let whole = Measure { definition, side: None, value: values[0] };
            if definition.per_hand { Side::LEFT_TO_RIGHT.map(of).to_vec() } else { vec![whole] }
        })
    }

    pub(crate) fn set(&mut self, id: &str, value: Option<f64>) {
        self.put(id, [value, None]);
    }

    pub(crate) fn set_hands(&mut self, id: &str, values: [Option<f64>; SIDES]) {
        self.put(id, values);
    }

    fn put(&mut self, id: &str, values: [Option<f64>; SIDES]) {
        let place = MEASURES.iter().position(|definition| definition.id == id);
        if let Some(slot) = place.and_then(|place| self.values.get_mut(place)) {
            *slot = values.map(|value| value.filter(|value| value.is_finite()));
        }
    }
}

impl Serialize for Score {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for measure in self.measures() {
            map.serialize_entry(&measure.key(), &measure.value)?;
        }
        map.end()
    }
}
