//! Detects two parts whose devices report one serial number, because both addresses lead to one device. Which of the two
//! addresses is wrong cannot be known, so neither part is trusted.

use std::sync::{
    Arc, Mutex, PoisonError,
    atomic::{AtomicU8, Ordering},
};

use nima_devices::same_serial;

use super::{EngageBlocker, PartKind, RigPart};

/// The serial numbers of the open devices. Written by the threads that open devices; the real-time thread reads only
/// the result.
#[derive(Clone, Debug)]
pub(super) struct ReportedSerials {
    serials: Arc<Mutex<Vec<(RigPart, String)>>>,
    /// Index in [`OBSTACLES`], or [`NONE`].
    double: Arc<AtomicU8>,
}

const OBSTACLES: [(PartKind, EngageBlocker); 3] = [
    (PartKind::Handle, EngageBlocker::OneHandle),
    (PartKind::Arm, EngageBlocker::OneArm),
    (PartKind::Sensor, EngageBlocker::OneSensor),
];
const NONE: u8 = u8::MAX;

impl Default for ReportedSerials {
    fn default() -> Self {
        Self { serials: Arc::default(), double: Arc::new(AtomicU8::new(NONE)) }
    }
}

impl ReportedSerials {
    /// Forgets the device of a part, which is about to be opened again.
    pub(super) fn forget(&self, part: RigPart) {
        self.change(|serials| serials.retain(|(known, _)| *known != part));
    }

    pub(super) fn report(&self, part: RigPart, serial: &str) {
        self.change(|serials| {
            serials.retain(|(known, _)| *known != part);
            serials.push((part, serial.to_owned()));
        });
    }

    fn change(&self, change: impl FnOnce(&mut Vec<(RigPart, String)>)) {
        let mut serials = self.serials.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut serials);
        let double = serials.iter().enumerate().find_map(|(count, (part, serial))| {
            // Servos identify themselves only by their ids, which may be the same on two lines.
            let is_it = |known: RigPart| known.kind() == part.kind() && known.kind() != PartKind::Servos;
            let is_taken = serials[..count].iter().any(|(known, taken)| is_it(*known) && same_serial(taken, serial));
            is_taken.then_some(part.kind())
        });
        let code = OBSTACLES.iter().position(|(kind, _)| Some(*kind) == double).map_or(NONE, |place| place as u8);
        self.double.store(code, Ordering::Release);
    }

    /// Returns the objection to an engagement while two parts are one device.
    pub(super) fn obstacle(&self) -> Option<EngageBlocker> {
        OBSTACLES.get(usize::from(self.double.load(Ordering::Acquire))).map(|(_, obstacle)| *obstacle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::Side;

    #[test]
    fn two_parts_that_report_one_number_are_found_until_one_is_opened_again() {
        let [right, left] = Side::ALL.map(RigPart::Arm);
        let reported = ReportedSerials::default();
        reported.report(right, "PJ00650019");
        reported.report(RigPart::Sensor(Side::Left), "PJ00650019");
        reported.report(RigPart::Handle(Side::Left), "");
        reported.report(RigPart::Handle(Side::Right), "");
        assert_eq!(reported.obstacle(), None);
        reported.report(left, "PJ00650019");
        assert_eq!(reported.obstacle(), Some(EngageBlocker::OneArm));
        reported.forget(left);
        assert_eq!(reported.obstacle(), None);
        reported.report(RigPart::TissueSensor, "SN000853");
        reported.report(RigPart::Sensor(Side::Right), "853");
        assert_eq!(reported.obstacle(), Some(EngageBlocker::OneSensor));
    }

    #[test]
    fn servos_of_two_lines_may_have_the_same_ids() {
        let reported = ReportedSerials::default();
        for side in Side::ALL {
            reported.report(RigPart::Servos(side), "ids 1 2 3 4");
        }
        assert_eq!(reported.obstacle(), None);
    }
}
