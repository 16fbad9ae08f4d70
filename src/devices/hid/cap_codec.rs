//! Reports of six-axis caps (3Dconnexion): bytes in, axes and buttons out, and back. No clock, no allocation.
//!
//! A report is one packet, its id first. Split models send translation (id 1) and rotation (id 2) in 7 bytes each; combined ones send both
//! as id 1 in 13 bytes; the length decides, not the product. Axes are signed 16-bit, little-endian, full deflection 350; raw x points
//! right, y towards the user, z down. Readings are turned half around x into [`CapReading`]'s frame (x right, y away from the
//! user, z up), translation and rotation alike, which is a proper rotation (the convention "HID, z up" of pyspacemouse).

use nalgebra::Vector3;

use crate::CapReading;

/// Counts of an axis at full deflection (logical maximum of the report descriptor).
pub const FULL: f64 = 350.0;
/// Counts above which an axis is not possible: twice full deflection.
pub const POSSIBLE: u16 = 700;
/// A cap that is deflected and sends nothing for so long counts as let go, s. Split models send each half every 16 ms, wireless ones
/// everything every 16 ms, and all send zeros before they fall silent at rest.
pub const RELEASE_AFTER_S: f64 = 0.100;
/// The longest report that we make.
pub const LENGTH_MAX: usize = 13;

/// One report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CapReport {
    /// x, y, z of a split model, counts.
    Translation([i16; 3]),
    /// Turns about x, y, z of a split model, counts.
    Rotation([i16; 3]),
    /// All six of a combined model, counts.
    Motion([i16; 6]),
    /// Buttons, first in the lowest bit.
    Buttons(u32),
    /// Battery of a wireless model.
    Battery {
        /// Charge, percent.
        percent: u8,
        /// On the cable.
        charging: bool,
    },
    /// Something that this program does not need.
    Other,
}

/// Why a report was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadReport {
    /// No report of this device has such a shape.
    Shape,
    /// The shape is right, the content is not possible.
    Content,
}

const TRANSLATION: u8 = 0x01;
const ROTATION: u8 = 0x02;
const BUTTONS: u8 = 0x03;
/// Output report that switches the light.
const LIGHT: u8 = 0x04;
const BATTERY: u8 = 0x17;

/// The output report that switches the light on or off.
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
    /// Reads one report.
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

    /// Writes it, and gives its length; 0 for [`CapReport::Other`]. Buttons take two bytes where they fit, as on two-button models.
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

/// Between the raw frame and that of the readings; its own inverse.
const SIGNS: [f64; 3] = [1.0, -1.0, -1.0];

/// The counts of a reading; what is not finite is zero.
pub fn counts_of(reading: &CapReading) -> [i16; 6] {
    let count = |value: f64, sign: f64| (value.clamp(-1.0, 1.0) * sign * FULL).round() as i16;
    std::array::from_fn(|i| match i {
        0..3 => count(reading.translation[i], SIGNS[i]),
        _ => count(reading.rotation[i - 3], SIGNS[i - 3]),
    })
}

/// What is known of a cap: the newest of both halves, each let go by itself when it is not renewed.
#[derive(Clone, Copy, Debug, Default)]
pub struct CapState {
    halves: [Half; 2],
    buttons: u32,
}

#[derive(Clone, Copy, Debug, Default)]
struct Half {
    axes: Vector3<f64>,
    at_s: f64,
}

fn scaled(counts: &[i16]) -> Vector3<f64> {
    Vector3::from_fn(|i, _| (f64::from(counts[i]) * SIGNS[i] / FULL).clamp(-1.0, 1.0))
}

impl CapState {
    /// Takes a report that arrived at `now_s`; true when it says something of axes or buttons.
    pub fn take(&mut self, report: &CapReport, now_s: f64) -> bool {
        let [translation, rotation] = &mut self.halves;
        match report {
            CapReport::Translation(counts) => *translation = Half { axes: scaled(counts), at_s: now_s },
            CapReport::Rotation(counts) => *rotation = Half { axes: scaled(counts), at_s: now_s },
            CapReport::Motion(counts) => {
                *translation = Half { axes: scaled(&counts[..3]), at_s: now_s };
                *rotation = Half { axes: scaled(&counts[3..]), at_s: now_s };
            }
            CapReport::Buttons(bits) => self.buttons = *bits,
            CapReport::Battery { .. } | CapReport::Other => return false,
        }
        true
    }

    /// Takes axes that are in the frame of the readings already.
    pub fn set(&mut self, translation: Vector3<f64>, rotation: Vector3<f64>, now_s: f64) {
        self.halves = [translation, rotation].map(|axes| Half { axes, at_s: now_s });
    }

    /// One button, from 0.
    pub const fn set_button(&mut self, button: u32, pressed: bool) {
        if button < u32::BITS {
            let bit = 1 << button;
            self.buttons = if pressed { self.buttons | bit } else { self.buttons & !bit };
        }
    }

    /// Lets go what was deflected and not renewed for [`RELEASE_AFTER_S`]; gives how many halves that were.
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

    /// As it is now.
    pub const fn reading(&self) -> CapReading {
        let [translation, rotation] = self.halves;
        CapReading { translation: translation.axes, rotation: rotation.axes, buttons: self.buttons }
    }
}
