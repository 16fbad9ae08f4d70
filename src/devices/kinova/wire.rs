//! Decodes protocol buffers in place: no allocation, bounded work, every byte checked.
//!
//! `prost` encodes all messages and decodes the rare ones. Messages that arrive a thousand times per second are decoded
//! here, because `prost` allocates for repeated fields and for errors.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DamagedMessage;

/// The encoded value of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value<'a> {
    Varint(u64),
    Fixed64,
    Bytes(&'a [u8]),
    Fixed32(u32),
}

impl<'a> Value<'a> {
    pub(super) const fn fixed32(self) -> Result<u32, DamagedMessage> {
        if let Self::Fixed32(bits) = self { Ok(bits) } else { Err(DamagedMessage) }
    }

    pub(super) fn float(self) -> Result<f32, DamagedMessage> {
        self.fixed32().map(f32::from_bits)
    }

    pub(super) fn uint32(self) -> Result<u32, DamagedMessage> {
        // As protocol buffers specify, the upper half is dropped.
        if let Self::Varint(number) = self { Ok(number as u32) } else { Err(DamagedMessage) }
    }

    pub(super) const fn bytes(self) -> Result<&'a [u8], DamagedMessage> {
        if let Self::Bytes(bytes) = self { Ok(bytes) } else { Err(DamagedMessage) }
    }
}

/// Iterates over the fields of a message; ends after the first error.
#[derive(Debug)]
pub(super) struct WireFields<'a> {
    rest: &'a [u8],
}

impl<'a> WireFields<'a> {
    pub(super) const fn of(message: &'a [u8]) -> Self {
        Self { rest: message }
    }

    fn varint(&mut self) -> Result<u64, DamagedMessage> {
        let mut number = 0_u64;
        for (k, &byte) in self.rest.iter().take(10).enumerate() {
            if k == 9 && byte > 1 {
                return Err(DamagedMessage);
            }
            number |= u64::from(byte & 0x7f) << (7 * k);
            if byte < 0x80 {
                self.rest = &self.rest[k + 1..];
                return Ok(number);
            }
        }
        Err(DamagedMessage)
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], DamagedMessage> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or(DamagedMessage)?;
        self.rest = rest;
        Ok(taken)
    }

    fn field(&mut self) -> Result<(u32, Value<'a>), DamagedMessage> {
        let key = u32::try_from(self.varint()?).map_err(|_| DamagedMessage)?;
        let value = match key & 7 {
            0 => Value::Varint(self.varint()?),
            1 => {
                self.take(8)?;
                Value::Fixed64
            }
            2 => {
                let length = usize::try_from(self.varint()?).map_err(|_| DamagedMessage)?;
                Value::Bytes(self.take(length)?)
            }
            5 => {
                let bytes: [u8; 4] = self.take(4)?.try_into().map_err(|_| DamagedMessage)?;
                Value::Fixed32(u32::from_le_bytes(bytes))
            }
            _ => return Err(DamagedMessage),
        };
        if key >> 3 == 0 { Err(DamagedMessage) } else { Ok((key >> 3, value)) }
    }
}

impl<'a> Iterator for WireFields<'a> {
    type Item = Result<(u32, Value<'a>), DamagedMessage>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let field = self.field();
        if field.is_err() {
            self.rest = &[];
        }
        Some(field)
    }
}
