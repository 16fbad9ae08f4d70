//! Checks that every device of the rig file is connected and stays connected for a second.

use nima_devices::ConnectionState;

use super::{
    CheckSubject, FigureUnit, PersonRequest, ReadyCause, ReadyFigure,
    item::{Item, PointProgress},
};
use crate::rig::Healths;

/// A device counts as steady after this time, s. Design choice.
const STEADY_S: f64 = 1.0;

#[derive(Debug)]
pub(super) struct ReadyDevices {
    count: usize,
    healths: Option<Healths>,
    /// Time since which all are connected, and the number of losses at that time.
    since: Option<(f64, u64)>,
}

impl ReadyDevices {
    pub(super) fn of(subject: &CheckSubject) -> Self {
        Self { count: subject.parts.len(), healths: None, since: None }
    }

    fn missing(&self) -> Option<usize> {
        let Some(healths) = &self.healths else { return Some(0) };
        healths.devices.iter().take(self.count).position(|health| health.standing != ConnectionState::Connected)
    }
}

impl Item for ReadyDevices {
    fn healths(&mut self, healths: &Healths) {
        self.healths = Some(*healths);
    }

    fn look(&mut self, now_s: f64) -> PointProgress {
        let outages = self.healths.map_or(0, |healths| healths.devices.iter().map(|health| health.outages).sum());
        // An outage in the meantime starts the second again: a device that drops out is not steady.
        if self.missing().is_some() || self.since.is_some_and(|(_, before)| before != outages) {
            self.since = None;
            return PointProgress::Asking(PersonRequest::Nothing);
        }
        let (since_s, _) = *self.since.get_or_insert((now_s, outages));
        if now_s - since_s < STEADY_S {
            return PointProgress::Asking(PersonRequest::Nothing);
        }
        PointProgress::Passed(ReadyFigure {
            value: self.count as f64,
            limit: self.count as f64,
            unit: FigureUnit::Count,
        })
    }

    fn late(&self) -> ReadyCause {
        ReadyCause::Missing { place: self.missing().unwrap_or(0) }
    }

    fn patience_s(&self) -> f64 {
        // Design choice: a device that needs longer is then reported by name.
        15.0
    }
}
