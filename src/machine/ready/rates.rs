//! The test of every device ([`Checkup`]): rate, losses, age, noise, range. A finding must be confirmed by a second
//! test.

use super::{
    CheckSubject, FigureUnit, PersonRequest, ReadyCause, ReadyFigure,
    item::{Item, PointProgress},
};
use crate::{
    config::RigConfig,
    rig::{
        Gauges, PartKind, RigPart,
        checkup::{self, BLOCKS, Checkup, CheckupFinding, RATE_OFF},
    },
};

#[derive(Debug)]
pub(super) struct Rates {
    rig: RigConfig,
    parts: Vec<Option<RigPart>>,
    blocks: Vec<Gauges>,
    /// A sensor did not rest: the measurement is repeated.
    moved: Option<(usize, CheckupFinding)>,
    /// Devices with a finding in the previous measurement: one finding may be chance, two are not.
    suspects: Vec<usize>,
}

impl Rates {
    pub(super) fn of(subject: &CheckSubject) -> Self {
        Self {
            rig: subject.rig.clone(),
            parts: subject.parts.clone(),
            blocks: Vec::new(),
            moved: None,
            suspects: Vec::new(),
        }
    }

    fn tested(&self) -> Vec<(usize, Checkup)> {
        let blocks: Vec<&Gauges> = self.blocks.iter().collect();
        let test = |(place, part): (usize, &Option<RigPart>)| {
            Some((place, Checkup::of(&checkup::TestSubject::of((*part)?, place, &self.rig, &blocks)?)?))
        };
        self.parts.iter().enumerate().filter_map(test).collect()
    }
}

/// Returns the deviation of the rate, as a fraction.
fn off(checkup: &Checkup) -> f64 {
    checkup.nominal_hz.map_or(0.0, |nominal_hz| (checkup.rate_hz / nominal_hz - 1.0).abs())
}

impl Item for Rates {
    fn gauges(&mut self, gauges: &Gauges) {
        if self.blocks.len() < BLOCKS {
            self.blocks.push(*gauges);
        }
    }

    fn look(&mut self, _now_s: f64) -> PointProgress {
        if self.blocks.len() < BLOCKS {
            return PointProgress::Asking(PersonRequest::Nothing);
        }
        let tested = self.tested();
        self.blocks.clear();
        let moved = |found: &CheckupFinding| matches!(found, CheckupFinding::Moved { .. });
        // A person may hold the handle; its noise does not matter here.
        let is_handle = |place: usize| self.parts[place].is_some_and(|part| part.kind() == PartKind::Handle);
        let all = || tested.iter().flat_map(|(place, test)| test.findings.iter().map(|found| (*place, *found)));
        let findings = || all().filter(|(place, found)| !(moved(found) && is_handle(*place)));
        let found = || findings().filter(|(_, found)| !moved(found));
        if let Some((place, finding)) = found().find(|(place, _)| self.suspects.contains(place)) {
            return PointProgress::Failed(ReadyCause::Found { place, finding });
        }
        self.suspects = found().map(|(place, _)| place).collect();
        self.moved = findings().find(|(_, found)| moved(found));
        if findings().next().is_some() {
            return PointProgress::Asking(PersonRequest::Nothing);
        }
        let worst = tested.iter().map(|(_, test)| off(test)).fold(0.0, f64::max);
        PointProgress::Passed(ReadyFigure { value: 100.0 * worst, limit: 100.0 * RATE_OFF, unit: FigureUnit::Percent })
    }

    fn late(&self) -> ReadyCause {
        self.moved.map_or(ReadyCause::NoGauges, |(place, finding)| ReadyCause::Found { place, finding })
    }

    fn patience_s(&self) -> f64 {
        12.0
    }
}
