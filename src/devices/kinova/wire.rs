//! Decodes protocol buffers in place: no allocation, bounded work, every byte checked.
//!
//! `prost` encodes all messages and decodes the rare ones. Messages that arrive a thousand times per second are decoded
//! here, because `prost` allocates for repeated fields and for errors.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Damaged;

/// The encoded value of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value<'a> {
    Varint(u64),
    Fixed64,
    Bytes(&'a [u8]),
    Fixed32(u32),
}

impl<'a> Value<'a> {
    pub(super) const fn fixed32(self) -> Result<u32, Damaged> {
        if let Self::Fixed32(bits) = self { Ok(bits) } else { Err(Damaged) }
    }

    pub(super) fn float(self) -> Result<f32, Damaged> {
        self.fixed32().map(f32::from_bits)
    }

    pub(super) fn uint32(self) -> Result<u32, Damaged> {
        // As protocol buffers specify, the upper half is dropped.
        if let Self::Varint(number) = self { Ok(number as u32) } else { Err(Damaged) }
    }

    pub(super) const fn bytes(self) -> Result<&'a [u8], Damaged> {
        if let Self::Bytes(bytes) = self { Ok(bytes) } else { Err(Damaged) }
    }
}

/// Iterates over the fields of a message; ends after the first error.
#[derive(Debug)]
pub(super) struct Fields<'a> {
    rest: &'a [u8],
}

impl<'a> Fields<'a> {
    pub(super) const fn of(message: &'a [u8]) -> Self {
        Self { rest: message }
    }

    fn varint(&mut self) -> Result<u64, Damaged> {
        let mut number = 0_u64;
        for (k, &byte) in self.rest.iter().take(10).enumerate() {
            if k == 9 && byte > 1 {
                return Err(Damaged);
            }
            number |= u64::from(byte & 0x7f) << (7 * k);
            if byte < 0x80 {
                self.rest = &self.rest[k + 1..];
                return Ok(number);
            }
        }
        Err(Damaged)
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], Damaged> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or(Damaged)?;
        self.rest = rest;
        Ok(taken)
    }

    fn field(&mut self) -> Result<(u32, Value<'a>), Damaged> {
        let key = u32::try_from(self.varint()?).map_err(|_| Damaged)?;
        let value = match key & 7 {
            0 => Value::Varint(self.varint()?),
            1 => {
                self.take(8)?;
                Value::Fixed64
            }
            2 => {
                let length = usize::try_from(self.varint()?).map_err(|_| Damaged)?;
                Value::Bytes(self.take(length)?)
            }
            5 => {
                let bytes: [u8; 4] = self.take(4)?.try_into().map_err(|_| Damaged)?;
                Value::Fixed32(u32::from_le_bytes(bytes))
            }
            _ => return Err(Damaged),
        };
        if key >> 3 == 0 { Err(Damaged) } else { Ok((key >> 3, value)) }
    }
}

impl<'a> Iterator for Fields<'a> {
    type Item = Result<(u32, Value<'a>), Damaged>;

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
