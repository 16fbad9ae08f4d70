//! Content of tracking replies: `BX` bodies and `TX` texts, decoded and encoded (reference 1.4, 1.5).
//!
//! Units of the protocol: quaternions scalar first, tool in the camera's frame; translations and errors in mm.
//! Supported reply options are 0001 (transforms), 0800 (tools outside the volume), 1000 (stray markers, which are
//! skipped and never sent). Parsing allocates nothing and accepts any bytes; numbers are returned unchecked, even if
//! not finite.

use super::{
    command::STRAYS,
    crc::{read_hex, write_hex},
    text::{PortStatus, SystemStatus},
};

/// Maximum number of handles in one reply.
pub const HANDLES_MAX: usize = 24;

/// Position and orientation of a tool, in the units of the protocol.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transform {
    /// Orientation of the tool in the camera's frame, scalar first.
    pub quaternion: [f64; 4],
    /// Position of the tool's origin there, mm.
    pub translation_mm: [f64; 3],
    /// Root mean square error of the fit to the markers, mm.
    pub error_mm: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ToolVisibility {
    Valid(Transform),
    #[default]
    Missing,
    Disabled,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandleFrame {
    pub handle: u8,
    pub sight: ToolVisibility,
    /// Status of the tool; 0 if it is disabled.
    pub status: PortStatus,
    /// Frame number; 0 if the tool is disabled.
    pub frame: u32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackingReply {
    handles: [HandleFrame; HANDLES_MAX],
    count: usize,
    pub system: SystemStatus,
}

/// The reply has a correct checksum but not the expected structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("malformed tracking reply")]
pub struct MalformedReply;

impl TrackingReply {
    /// Creates a reply with these handles; those beyond [`HANDLES_MAX`] are dropped.
    pub fn new(handles: &[HandleFrame], system: SystemStatus) -> Self {
        let mut frames = Self { system, ..Self::default() };
        for one in handles {
            frames.push(*one).ok();
        }
        frames
    }

    pub fn handles(&self) -> &[HandleFrame] {
        &self.handles[..self.count]
    }

    fn push(&mut self, one: HandleFrame) -> Result<(), MalformedReply> {
        *self.handles.get_mut(self.count).ok_or(MalformedReply)? = one;
        self.count += 1;
        Ok(())
    }

    /// Decodes the body of a `BX` reply to a request with `options`.
    ///
    /// # Errors
    /// [`MalformedReply`] if the body does not have the structure that `options` require.
    pub fn of_block(body: &[u8], options: u16) -> Result<Self, MalformedReply> {
        let mut cursor = ReplyCursor(body);
        let mut frames = Self::default();
        for _ in 0..cursor.byte()? {
            let handle = cursor.byte()?;
            let sight = cursor.byte()?;
            let sight = match sight {
                1 => ToolVisibility::Valid(cursor.transform()?),
                2 => ToolVisibility::Missing,
                4 => ToolVisibility::Disabled,
                _ => return Err(MalformedReply),
            };
            let (status, frame) = match sight {
                ToolVisibility::Disabled => (0, 0),
                _ => (cursor.word()?, cursor.word()?),
            };
            frames.push(HandleFrame { handle, sight, status: PortStatus(status), frame })?;
        }
        if options & STRAYS != 0 {
            let strays = usize::from(cursor.byte()?);
            cursor.take(strays.div_ceil(8) + strays * 12)?;
        }
        frames.system = SystemStatus(u16::from_le_bytes(cursor.array()?));
        cursor.end()?;
        Ok(frames)
    }

    /// Encodes the body of a `BX` reply to a request with `options`.
    pub fn write_block(&self, options: u16, body: &mut Vec<u8>) {
        body.push(self.count as u8);
        for HandleFrame { handle, sight, status, frame } in self.handles() {
            body.push(*handle);
            match sight {
                ToolVisibility::Valid(at) => {
                    body.push(1);
                    let numbers = at.quaternion.iter().chain(&at.translation_mm).chain([&at.error_mm]);
                    numbers.for_each(|number| body.extend_from_slice(&(*number as f32).to_le_bytes()));
                }
                ToolVisibility::Missing => body.push(2),
                ToolVisibility::Disabled => {
                    body.push(4);
                    continue;
                }
            }
            body.extend_from_slice(&status.0.to_le_bytes());
            body.extend_from_slice(&frame.to_le_bytes());
        }
        if options & STRAYS != 0 {
            body.push(0);
        }
        body.extend_from_slice(&self.system.0.to_le_bytes());
    }

    /// Decodes a `TX` reply to a request with `options`.
    ///
    /// # Errors
    /// [`MalformedReply`] if the text does not have the structure that `options` require.
    pub fn of_text(text: &[u8], options: u16) -> Result<Self, MalformedReply> {
        let mut cursor = ReplyCursor(text);
        let mut frames = Self::default();
        for _ in 0..cursor.hex(2)? {
            let handle = cursor.hex(2)? as u8;
            if cursor.skip_word(b"UNOCCUPIED") {
                cursor.rest_of_line()?;
                continue;
            }
            let sight = if cursor.skip_word(b"MISSING") {
                ToolVisibility::Missing
            } else if cursor.skip_word(b"DISABLED") {
                ToolVisibility::Disabled
            } else {
                ToolVisibility::Valid(cursor.text_transform()?)
            };
            let mut status = 0;
            let mut frame = 0;
            if sight != ToolVisibility::Disabled {
                status = cursor.hex(8)?;
                frame = cursor.hex(8)?;
            }
            cursor.rest_of_line()?;
            frames.push(HandleFrame { handle, sight, status: PortStatus(status), frame })?;
        }
        if options & STRAYS != 0 {
            let strays = cursor.hex(2)? as usize;
            cursor.take(strays.div_ceil(4) + strays * 21)?;
        }
        frames.system = SystemStatus(cursor.hex(4)? as u16);
        cursor.end()?;
        Ok(frames)
    }

    /// Encodes a `TX` reply to a request with `options`. Numbers too large for their field become the largest that
    /// fits; NaN becomes 0.
    pub fn write_text(&self, options: u16, text: &mut Vec<u8>) {
        hex_to(text, 2, self.count as u32);
        for HandleFrame { handle, sight, status, frame } in self.handles() {
            hex_to(text, 2, u32::from(*handle));
            match sight {
                ToolVisibility::Valid(at) => {
                    at.quaternion.iter().for_each(|part| decimal_to(text, 5, part * 1e4));
                    at.translation_mm.iter().for_each(|part| decimal_to(text, 6, part * 1e2));
                    decimal_to(text, 5, at.error_mm * 1e4);
                }
                ToolVisibility::Missing => text.extend_from_slice(b"MISSING"),
                ToolVisibility::Disabled => text.extend_from_slice(b"DISABLED"),
            }
            hex_to(text, 8, status.0);
            hex_to(text, 8, *frame);
            text.push(b'\n');
        }
        if options & STRAYS != 0 {
            text.extend_from_slice(b"00");
        }
        hex_to(text, 4, u32::from(self.system.0));
    }
}

fn hex_to(text: &mut Vec<u8>, digits: usize, number: u32) {
    let mut room = [0; 8];
    write_hex(&mut room[..digits], u64::from(number));
    text.extend_from_slice(&room[..digits]);
}

/// Appends a sign and this number of decimal digits.
fn decimal_to(text: &mut Vec<u8>, digits: u32, number: f64) {
    let largest = f64::from(10_u32.pow(digits)) - 1.0;
    let whole = number.round().clamp(-largest, largest) as i64;
    text.extend_from_slice(format!("{whole:+0width$}", width = digits as usize + 1).as_bytes());
}

struct ReplyCursor<'a>(&'a [u8]);

impl<'a> ReplyCursor<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], MalformedReply> {
        let (head, tail) = self.0.split_at_checked(count).ok_or(MalformedReply)?;
        self.0 = tail;
        Ok(head)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], MalformedReply> {
        self.take(N)?.try_into().map_err(|_| MalformedReply)
    }

    fn byte(&mut self) -> Result<u8, MalformedReply> {
        Ok(self.array::<1>()?[0])
    }

    fn word(&mut self) -> Result<u32, MalformedReply> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    fn float(&mut self) -> Result<f64, MalformedReply> {
        Ok(f64::from(f32::from_le_bytes(self.array()?)))
    }

    fn transform(&mut self) -> Result<Transform, MalformedReply> {
        Ok(Transform {
            quaternion: [self.float()?, self.float()?, self.float()?, self.float()?],
            translation_mm: [self.float()?, self.float()?, self.float()?],
            error_mm: self.float()?,
        })
    }

    fn hex(&mut self, digits: usize) -> Result<u32, MalformedReply> {
        read_hex(self.take(digits)?).ok_or(MalformedReply)
    }

    /// Reads a sign and digits; returns the number times `scale`.
    fn decimal(&mut self, digits: usize, scale: f64) -> Result<f64, MalformedReply> {
        let sign = self.byte()?;
        let digits = self.take(digits)?;
        let whole = digits.iter().try_fold(0.0, |whole, digit| {
            if digit.is_ascii_digit() { Ok(whole * 10.0 + f64::from(digit - b'0')) } else { Err(MalformedReply) }
        })?;
        match sign {
            b'+' => Ok(whole / scale),
            b'-' => Ok(-whole / scale),
            _ => Err(MalformedReply),
        }
    }

    fn text_transform(&mut self) -> Result<Transform, MalformedReply> {
        let mut part = |digits, scale| self.decimal(digits, scale);
        Ok(Transform {
            quaternion: [part(5, 1e4)?, part(5, 1e4)?, part(5, 1e4)?, part(5, 1e4)?],
            translation_mm: [part(6, 1e2)?, part(6, 1e2)?, part(6, 1e2)?],
            error_mm: part(5, 1e4)?,
        })
    }

    fn skip_word(&mut self, word: &[u8]) -> bool {
        let rest = self.0.strip_prefix(word);
        self.0 = rest.unwrap_or(self.0);
        rest.is_some()
    }

    /// Skips to the next line. The current line may contain further information, after `DISABLED` also the status.
    fn rest_of_line(&mut self) -> Result<(), MalformedReply> {
        let end = self.0.iter().position(|byte| *byte == b'\n').ok_or(MalformedReply)?;
        self.take(end + 1).map(|_| ())
    }

    const fn end(&self) -> Result<(), MalformedReply> {
        if self.0.is_empty() { Ok(()) } else { Err(MalformedReply) }
    }
}
