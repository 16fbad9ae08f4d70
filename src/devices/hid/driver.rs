//! Functions used by both drivers: reads reports with bounded work, and determines when too many are damaged.

use super::cap_codec::BadReport;
use crate::{ConnectionState, DeviceIdentity, Health, Loss, TimedReading, transport::TransportDatagrams};

/// Maximum number of reports handled in one poll; further ones wait for the next poll.
const REPORTS_MAX: usize = 64;
/// Number of consecutive bad reports after which the device is lost: 64 ms of a wired cap.
const BAD_MAX: u32 = 8;
/// Maximum length of a full-speed device's report, with its id.
const BUFFER: usize = 65;

pub(super) struct HidLine {
    pub(super) source: Box<dyn TransportDatagrams>,
    pub(super) health: Health,
    pub(super) identity: DeviceIdentity,
    bad_in_a_row: u32,
}

impl HidLine {
    /// Connected immediately, because a device at rest sends nothing.
    pub(super) fn of(source: Box<dyn TransportDatagrams>, identity: DeviceIdentity) -> Self {
        let mut health = Health::opening();
        health.standing = ConnectionState::Connected;
        Self { source, health, identity, bad_in_a_row: 0 }
    }

    /// Passes every report that has arrived to `take`, which returns whether it was valid.
    pub(super) fn receive(&mut self, now_s: f64, mut take: impl FnMut(&[u8]) -> Result<bool, BadReport>) -> bool {
        let mut buffer = [0; BUFFER];
        let mut news = false;
        for _ in 0..REPORTS_MAX {
            if self.is_lost() {
                break;
            }
            match self.source.receive(&mut buffer) {
                Ok(Some(count)) => match take(&buffer[..count.min(BUFFER)]) {
                    Ok(is_news) => {
                        self.bad_in_a_row = 0;
                        if is_news {
                            self.health.accept(now_s);
                            news = true;
                        }
                    }
                    Err(bad) => self.count(bad),
                },
                Ok(None) => break,
                Err(loss) => {
                    self.health.lose(loss);
                }
            }
        }
        news
    }

    fn count(&mut self, bad: BadReport) {
        self.bad_in_a_row += 1;
        let loss = match bad {
            BadReport::Shape => {
                self.health.damaged += 1;
                Loss::Corrupt
            }
            BadReport::Content => {
                self.health.refused += 1;
                Loss::Implausible
            }
        };
        if self.bad_in_a_row >= BAD_MAX {
            self.health.lose(loss);
        }
    }

    pub(super) const fn is_lost(&self) -> bool {
        matches!(self.health.standing, ConnectionState::Lost(_))
    }
}

/// Value of a device that reports only changes: kept between its reports, and at rest while the device is not connected
/// or has not yet reported again.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeldValue<T> {
    value: T,
}

impl<T: Copy + Default> HeldValue<T> {
    /// Adds the result of this tick's poll; returns the value that applies now.
    pub fn update(&mut self, reading: Option<TimedReading<T>>, health: &Health) -> T {
        if let Some(reading) = reading {
            self.value = reading.value;
        }
        if health.standing != ConnectionState::Connected {
            self.value = T::default();
        }
        self.value
    }
}
