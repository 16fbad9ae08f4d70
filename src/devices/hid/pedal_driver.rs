//! Driver of foot pedals.

use serde::{Deserialize, Serialize};

use super::{
    driver::HidLine,
    models::HidKind,
    pedal_codec::{KEYS_MAX, PLACE_MAX, PedalLayout},
    source::{HidIdentity, HidSource},
};
use crate::{Device, DeviceError, DeviceIdentity, Health, PedalReading, TimedReading, transport::TransportDatagrams};

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PedalSettings {
    /// Source of its reports; see [`HidSource`].
    pub source: String,
    /// For a pedal that is a keyboard: the key code (HID usage page 7) of every switch, first switch first. Factory
    /// settings are `b` (5) for single pedals and `a`, `b`, `c` (4, 5, 6) for triple ones, so by default switch 0 is
    /// `b`, 1 is `a`, 2 is `c`.
    pub keys: Vec<u8>,
    /// For a pedal with other reports, which `source` names by its USB ids: byte and bit of every switch in a report,
    /// both from 0.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bits: Vec<[u8; 2]>,
    /// Index of the clutch switch, from 0; while pressed, the hand moves without moving the tip.
    pub clutch: u32,
    /// Index of the presence switch; `None` if the pedal has none.
    pub presence: Option<u32>,
}

impl Default for PedalSettings {
    fn default() -> Self {
        Self { source: "any".to_owned(), keys: vec![5, 4, 6], bits: Vec::new(), clutch: 0, presence: None }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PedalRoles {
    clutch: u32,
    presence: Option<u32>,
}

impl PedalRoles {
    pub const fn clutch(self, reading: PedalReading) -> bool {
        reading.pressed >> self.clutch & 1 == 1
    }

    /// Returns whether the presence switch is pressed; `None` if the pedal has none.
    pub fn presence(self, reading: PedalReading) -> Option<bool> {
        self.presence.map(|switch| reading.pressed >> switch & 1 == 1)
    }
}

impl PedalSettings {
    /// Checks the indices and returns the functions of the switches.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for an index that the pedal does not have, or that is used twice.
    pub fn roles(&self) -> Result<PedalRoles, DeviceError> {
        let setting = |key: &str, value: String, allowed: &str| DeviceError::Setting {
            key: key.to_owned(),
            value,
            allowed: allowed.to_owned(),
        };
        if self.keys.is_empty() || self.keys.len() > KEYS_MAX || self.keys.iter().any(|key| *key < 4) {
            return Err(setting("keys", format!("{:?}", self.keys), "one to eight key codes, each at least 4"));
        }
        let is_place = |[byte, bit]: &[u8; 2]| *byte <= PLACE_MAX[0] && *bit <= PLACE_MAX[1];
        if self.bits.len() > KEYS_MAX || !self.bits.iter().all(is_place) {
            let allowed = "at most eight pairs of a byte from 0 to 7 and a bit from 0 to 7";
            return Err(setting("bits", format!("{:?}", self.bits), allowed));
        }
        let switches = if self.bits.is_empty() { KEYS_MAX } else { self.bits.len() };
        for (key, switch) in [("clutch", Some(self.clutch)), ("presence", self.presence)] {
            if let Some(switch) = switch.filter(|switch| *switch >= switches as u32) {
                let allowed = format!("a switch from 0 to {}", switches - 1);
                return Err(setting(key, switch.to_string(), &allowed));
            }
        }
        if self.presence == Some(self.clutch) {
            return Err(setting("presence", self.clutch.to_string(), "a different switch than the clutch"));
        }
        Ok(PedalRoles { clutch: self.clutch, presence: self.presence })
    }

    /// Refuses invalid switches, keys and sources.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first invalid setting.
    pub fn check(&self) -> Result<(), DeviceError> {
        self.roles()?;
        self.source.parse::<HidSource>().map(drop)
    }

    fn layout(&self, kind: HidKind) -> PedalLayout {
        if !self.bits.is_empty() {
            let mut places = [None; KEYS_MAX];
            places.iter_mut().zip(&self.bits).for_each(|(to, from)| *to = Some(*from));
            return PedalLayout::Bits { places };
        }
        if kind == HidKind::SwitchPedal {
            return PedalLayout::Switches;
        }
        let mut keys = [0; KEYS_MAX];
        keys.iter_mut().zip(&self.keys).for_each(|(to, from)| *to = *from);
        PedalLayout::Keyboard { keys }
    }
}

/// An open pedal. All switches count as released until it reports. Reports arrive on changes, and a report that cannot
/// be decoded releases all switches. A silent pedal cannot be distinguished from one that is not moved.
pub struct PedalDriver {
    line: HidLine,
    layout: PedalLayout,
    roles: PedalRoles,
    pressed: u32,
}

impl PedalDriver {
    /// Opens the pedal; may take about 100 ms.
    ///
    /// # Errors
    /// [`DeviceError`] if a setting is invalid, or the device is missing, cannot be opened or is not a pedal.
    pub fn open(settings: &PedalSettings) -> Result<Self, DeviceError> {
        settings.roles()?;
        let source: HidSource = settings.source.parse()?;
        // With the places of its switches in the rig file, any device can be a pedal.
        let kinds = [HidKind::KeyboardPedal, HidKind::SwitchPedal];
        let (datagrams, identity) =
            if settings.bits.is_empty() { source.open(&kinds) } else { source.open_any(&kinds) }?;
        Self::over(datagrams, &identity, settings)
    }

    /// Uses an open source of reports. A pedal with unknown ids is treated as a keyboard.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] if a setting is invalid.
    pub fn over(
        datagrams: Box<dyn TransportDatagrams>,
        identity: &HidIdentity,
        settings: &PedalSettings,
    ) -> Result<Self, DeviceError> {
        let layout = settings.layout(identity.kind().unwrap_or(HidKind::KeyboardPedal));
        let line = HidLine::of(datagrams, identity.identity());
        Ok(Self { line, layout, roles: settings.roles()?, pressed: 0 })
    }

    pub const fn roles(&self) -> PedalRoles {
        self.roles
    }
}

impl Device for PedalDriver {
    type Reading = PedalReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<PedalReading>> {
        let Self { line, layout, pressed, .. } = self;
        let before = (*pressed, line.is_lost());
        let mut news = line.receive(now_s, |bytes| {
            let switches = layout.decode(bytes);
            *pressed = switches.unwrap_or(0);
            switches.map(|_| true)
        });
        if line.is_lost() {
            *pressed = 0;
        }
        news |= before != (*pressed, line.is_lost());
        news.then_some(TimedReading { device_s: None, arrival_s: now_s, value: PedalReading { pressed: *pressed } })
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.line.health, &self.line.identity)
    }
}
