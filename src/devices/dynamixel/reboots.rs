use std::sync::{
    Arc,
    atomic::{AtomicU32, Ordering},
};

use crate::SERVOS;

/// Servos to restart, which is the only way to clear a shutdown. Requests come from any thread and are carried out when
/// the servos are next opened: a running driver that finds a request switches the torque off and reports itself lost,
/// so that it is reopened.
#[derive(Clone, Debug, Default)]
pub struct Reboots(Arc<AtomicU32>);

impl Reboots {
    /// Requests a restart of the servo with this index (0 to 3) in the settings.
    pub fn ask(&self, index: usize) {
        self.0.fetch_or(1 << index.min(SERVOS - 1), Ordering::AcqRel);
    }

    pub fn is_any(&self) -> bool {
        self.0.load(Ordering::Acquire) != 0
    }

    pub(super) fn take(&self, index: usize) -> bool {
        self.0.fetch_and(!(1 << index), Ordering::AcqRel) & 1 << index != 0
    }
}
