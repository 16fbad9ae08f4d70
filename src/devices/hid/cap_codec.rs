//! Decodes and encodes the reports of six-axis caps (3Dconnexion). No clock, no allocation.
//!
//! A report is one packet that begins with its id. Split models send translation (id 1) and rotation (id 2) in 7 bytes
//! each; combined models send both as id 1 in 13 bytes; the length decides, not the product. Axes are signed 16-bit,
//! little-endian, full deflection 350; raw x points right, y towards the user, z down. Readings are rotated by half a
//! turn about x into [`CapReading`]'s frame (x right, y away from the user, z up), translation and rotation alike (the
//! convention "HID, z up" of pyspacemouse).
//!
//! Source of layouts and ranges: pyspacemouse 2.1.0 (reference `hid.md`), because the manufacturer publishes none.

use nalgebra::Vector3;

use crate::CapReading;

/// Counts of an axis at full deflection (logical maximum of the report descriptor).
pub const FULL: f64 = 350.0;
/// Larger counts are impossible: twice full deflection.
pub const POSSIBLE: u16 = 700;
/// A deflected cap that sends nothing for this time counts as released, s. Split models send each half every 16 ms,
/// wireless models everything every 16 ms, and all models send zeros before they become silent at rest.
pub const RELEASE_AFTER_S: f64 = 0.100;
/// Maximum length of a report encoded here.
pub const LENGTH_MAX: usize = 13;

/// One report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CapReport {
    /// x, y, z of a split model, counts.
    Translation([i16; 3]),
    /// Rotations about x, y, z of a split model, counts.
    Rotation([i16; 3]),
    /// All six of a combined model, counts.
    Motion([i16; 6]),
    /// Pressed buttons, one per bit, the first button in the lowest bit.
    Buttons(u32),
    Battery {
        percent: u8,
        /// Whether the device is charging by cable.
        charging: bool,
    },
    Other,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadReport {
    /// Id or length do not belong to a report of this device.
    Shape,
    Content,
}

// Report ids of 3Dconnexion devices: 6 bytes of motion, 6 of rotation (or all 12 in the first), and a bit map of
// buttons.
const TRANSLATION: u8 = 0x01;
const ROTATION: u8 = 0x02;
const BUTTONS: u8 = 0x03;
/// Id of the output report for the light.
const LIGHT: u8 = 0x04;
// Wireless models: charge in per cent and whether it is charging.
const BATTERY: u8 = 0x17;

/// Returns the output report that switches the light on or off.
pub const fn light(on: bool) -> [u8; 2] {
    [LIGHT, on as u8]
}

fn axes<const N: usize>(bytes: &[u8]) -> Result<[i16; N], BadReport> {
    let mut axes = [0; N];
    for (axis, pair) in axes.iter_mut().zip(bytes.as_chunks::<2>().0) {
        *axis = i16::from_le_bytes(*pair);
    }
    if axes.iter().any(|axis| axis.unsigned_abs() > POSSIBLE) { Err(BadReport::Content) } else { Ok(axes) }
}

impl CapReport {
    /// Decodes one report.
    ///
    /// # Errors
    /// [`BadReport`] if id or length do not belong to a report, or a value is impossible.
    ///
    /// ```
    /// use nima_devices::hid::cap_codec::{CapReport, CapState};
    ///
    /// let report = CapReport::decode(&[1, 0x5E, 0x01, 0, 0, 0, 0]);
    /// assert_eq!(report, Ok(CapReport::Translation([350, 0, 0])));
    ///
    /// let mut cap = CapState::default();
    /// cap.take(&CapReport::Translation([350, 175, 0]), 0.0);
    /// let push = cap.reading().translation;
    /// assert_eq!((push.x, push.y), (1.0, -0.5), "raw y points towards the user, the reading's y away");
    /// ```
    pub fn decode(bytes: &[u8]) -> Result<Self, BadReport> {
        match bytes {
            [TRANSLATION, rest @ ..] if rest.len() == 6 => axes(rest).map(Self::Translation),
            [TRANSLATION, rest @ ..] if rest.len() >= 12 => axes(rest).map(Self::Motion),
            [ROTATION, rest @ ..] if rest.len() == 6 => axes(rest).map(Self::Rotation),
            [BUTTONS, rest @ ..] if !rest.is_empty() => {
                let mut bits = [0; 4];
                bits.iter_mut().zip(rest).for_each(|(bit, byte)| *bit = *byte);
                Ok(Self::Buttons(u32::from_le_bytes(bits)))
            }
            [BATTERY, percent, rest @ ..] if *percent <= 100 => {
                Ok(Self::Battery { percent: *percent, charging: rest.first().is_some_and(|byte| *byte != 0) })
            }
            [BATTERY, _, ..] => Err(BadReport::Content),
            [] | [0 | TRANSLATION | ROTATION | BUTTONS | BATTERY, ..] => Err(BadReport::Shape),
            _ => Ok(Self::Other),
        }
    }

    /// Encodes the report; returns its length, 0 for [`CapReport::Other`]. Buttons are encoded in two bytes if they
    /// fit, as on two-button models.
    pub fn encode(&self, buffer: &mut [u8; LENGTH_MAX]) -> usize {
        let mut put = |id: u8, axes: &[i16]| {
            buffer[0] = id;
            for (pair, axis) in buffer[1..].as_chunks_mut::<2>().0.iter_mut().zip(axes) {
                *pair = axis.to_le_bytes();
            }
            1 + 2 * axes.len()
        };
        match self {
            Self::Translation(axes) => put(TRANSLATION, axes),
            Self::Rotation(axes) => put(ROTATION, axes),
            Self::Motion(axes) => put(TRANSLATION, axes),
            Self::Buttons(bits) => {
                let length = if *bits > 0xffff { 5 } else { 3 };
                buffer[0] = BUTTONS;
                buffer[1..5].copy_from_slice(&bits.to_le_bytes());
                length
            }
            Self::Battery { percent, charging } => {
                buffer[..3].copy_from_slice(&[BATTERY, *percent, u8::from(*charging)]);
                3
            }
            Self::Other => 0,
        }
    }
}

/// Signs between the raw frame and the frame of the readings; their own inverse.
const SIGNS: [f64; 3] = [1.0, -1.0, -1.0];

/// Returns the counts for a reading; a non-finite value becomes zero.
pub fn counts_of(reading: &CapReading) -> [i16; 6] {
    let count = |value: f64, sign: f64| (value.clamp(-1.0, 1.0) * sign * FULL).round() as i16;
    std::array::from_fn(|i| match i {
        0..3 => count(reading.translation[i], SIGNS[i]),
        _ => count(reading.rotation[i - 3], SIGNS[i - 3]),
    })
}

/// State of a cap: the newest translation and rotation, each of which counts as released if it is not renewed.
#[derive(Clone, Copy, Debug, Default)]
pub struct CapState {
    halves: [CapHalf; 2],
    buttons: u32,
}

#[derive(Clone, Copy, Debug, Default)]
struct CapHalf {
    axes: Vector3<f64>,
    at_s: f64,
}

fn scaled(counts: &[i16]) -> Vector3<f64> {
    Vector3::from_fn(|i, _| (f64::from(counts[i]) * SIGNS[i] / FULL).clamp(-1.0, 1.0))
}

impl CapState {
    /// Applies a report that arrived at `now_s`; returns true if it contains axes or buttons.
    pub fn take(&mut self, report: &CapReport, now_s: f64) -> bool {
        let [translation, rotation] = &mut self.halves;
        match report {
            CapReport::Translation(counts) => *translation = CapHalf { axes: scaled(counts), at_s: now_s },
            CapReport::Rotation(counts) => *rotation = CapHalf { axes: scaled(counts), at_s: now_s },
            CapReport::Motion(counts) => {
                *translation = CapHalf { axes: scaled(&counts[..3]), at_s: now_s };
                *rotation = CapHalf { axes: scaled(&counts[3..]), at_s: now_s };
            }
            CapReport::Buttons(bits) => self.buttons = *bits,
            CapReport::Battery { .. } | CapReport::Other => return false,
        }
        true
    }

    /// Sets axes that are already in the frame of the readings.
    pub fn set(&mut self, translation: Vector3<f64>, rotation: Vector3<f64>, now_s: f64) {
        self.halves = [translation, rotation].map(|axes| CapHalf { axes, at_s: now_s });
    }

    /// Sets one button, counted from 0.
    pub const fn set_button(&mut self, button: u32, pressed: bool) {
        if button < u32::BITS {
            let bit = 1 << button;
            self.buttons = if pressed { self.buttons | bit } else { self.buttons & !bit };
        }
    }

    /// Sets deflections to zero that were not renewed for [`RELEASE_AFTER_S`]; returns the number of affected halves.
    pub fn release_stale(&mut self, now_s: f64) -> u64 {
        let mut released = 0;
        for half in &mut self.halves {
            if half.axes != Vector3::zeros() && now_s - half.at_s > RELEASE_AFTER_S {
                half.axes = Vector3::zeros();
                released += 1;
            }
        }
        released
    }

    pub const fn reading(&self) -> CapReading {
        let [translation, rotation] = self.halves;
        CapReading { translation: translation.axes, rotation: rotation.axes, buttons: self.buttons }
    }
}
