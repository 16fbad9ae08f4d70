use serde::{Deserialize, Serialize};

use super::{
    cap_codec::{CapReport, CapState, light},
    driver::HidLine,
    models::HidKind,
    source::{HidIdentity, HidSource},
    spacenavd,
};
use crate::{CapReading, Device, DeviceError, DeviceIdentity, Health, TimedReading, transport::TransportDatagrams};

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CapSettings {
    /// Source of the reports; see [`HidSource`].
    pub source: String,
    /// Axes to invert: x, y, z, rotations about x, y, z (some models differ in the signs of the rotations).
    pub invert: [bool; 6],
    /// Whether the cap's light is on while it is connected.
    pub light: bool,
}

impl Default for CapSettings {
    fn default() -> Self {
        Self { source: "any".to_owned(), invert: [false; 6], light: true }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CapWire {
    Reports,
    #[cfg_attr(not(unix), expect(dead_code, reason = "the daemon needs a UNIX socket"))]
    Spacenavd,
}

/// An open cap. Lost when its source is gone, or when eight reports in a row are damaged or impossible. Silence at rest
/// is normal; a deflected cap that becomes silent counts as released after [`RELEASE_AFTER_S`](super::RELEASE_AFTER_S),
/// and its missing reports as lost.
pub struct CapDriver {
    line: HidLine,
    wire: CapWire,
    state: CapState,
    battery_percent: Option<u8>,
    invert: [bool; 6],
    light: bool,
}

impl CapDriver {
    /// Opens the cap; may take about 100 ms.
    ///
    /// # Errors
    /// [`DeviceError`] if the source is invalid, or the device is missing, cannot be opened or is not a cap.
    pub fn open(settings: &CapSettings) -> Result<Self, DeviceError> {
        let source: HidSource = settings.source.parse()?;
        let (datagrams, identity, wire) = match &source {
            #[cfg(unix)]
            HidSource::Spacenavd(path) => {
                let socket = spacenavd::Spacenavd::open(path)?;
                let identity = DeviceIdentity { product: "spacenavd".to_owned(), ..DeviceIdentity::default() };
                (Box::new(socket) as Box<dyn TransportDatagrams>, identity, CapWire::Spacenavd)
            }
            _ => {
                let (datagrams, identity) = source.open(&[HidKind::Cap])?;
                (datagrams, identity.identity(), CapWire::Reports)
            }
        };
        Ok(Self::on(datagrams, identity, wire, settings))
    }

    pub fn over(datagrams: Box<dyn TransportDatagrams>, identity: &HidIdentity, settings: &CapSettings) -> Self {
        Self::on(datagrams, identity.identity(), CapWire::Reports, settings)
    }

    fn on(
        datagrams: Box<dyn TransportDatagrams>,
        identity: DeviceIdentity,
        wire: CapWire,
        settings: &CapSettings,
    ) -> Self {
        let mut driver = Self {
            line: HidLine::of(datagrams, identity),
            wire,
            state: CapState::default(),
            battery_percent: None,
            invert: settings.invert,
            light: settings.light,
        };
        driver.show(true);
        driver
    }

    /// Returns the charge of a wireless model, percent, once it has reported it.
    pub const fn battery_percent(&self) -> Option<u8> {
        self.battery_percent
    }

    /// Switches the light, if the cap has one and the settings use it.
    fn show(&mut self, on: bool) {
        if self.light && self.wire == CapWire::Reports {
            // Models without a light refuse this; ignore it.
            self.line.source.send(&light(on)).ok();
        }
    }

    fn reading(&self) -> CapReading {
        let mut reading = self.state.reading();
        let CapReading { translation, rotation, .. } = &mut reading;
        for (axis, _) in translation.iter_mut().chain(rotation).zip(self.invert).filter(|(_, invert)| *invert) {
            *axis = -*axis;
        }
        reading
    }
}

impl Device for CapDriver {
    type Reading = CapReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<CapReading>> {
        let Self { line, wire, state, battery_percent, .. } = self;
        let was_lost = line.is_lost();
        let news = line.receive(now_s, |bytes| match wire {
            CapWire::Reports => {
                let report = CapReport::decode(bytes)?;
                if let CapReport::Battery { percent, .. } = report {
                    *battery_percent = Some(percent);
                }
                Ok(state.take(&report, now_s))
            }
            CapWire::Spacenavd => {
                spacenavd::SpacenavdEvent::decode(bytes)?.apply(state, now_s);
                Ok(true)
            }
        });
        let newly_lost = line.is_lost() && !was_lost;
        if line.is_lost() {
            *state = CapState::default();
        }
        let released = state.release_stale(now_s);
        line.health.lost += released;
        (news || newly_lost || released > 0).then(|| TimedReading {
            device_s: None,
            arrival_s: now_s,
            value: self.reading(),
        })
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.line.health, &self.line.identity)
    }
}

impl Drop for CapDriver {
    fn drop(&mut self) {
        self.show(false);
    }
}
