//! Numbers and names in a message: big-endian, names padded with zeros.

use super::IgtlFormatError;

/// Reads numbers from the front of bytes.
#[derive(Clone, Debug)]
pub(super) struct IgtlCursor<'a>(pub(super) &'a [u8]);

impl<'a> IgtlCursor<'a> {
    pub(super) fn bytes(&mut self, count: usize) -> Result<&'a [u8], IgtlFormatError> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(IgtlFormatError::Short)?;
        self.0 = rest;
        Ok(taken)
    }

    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], IgtlFormatError> {
        let (taken, rest) = self.0.split_first_chunk().ok_or(IgtlFormatError::Short)?;
        self.0 = rest;
        Ok(*taken)
    }

    pub(super) fn u16(&mut self) -> Result<u16, IgtlFormatError> {
        Ok(u16::from_be_bytes(self.array()?))
    }

    pub(super) fn u32(&mut self) -> Result<u32, IgtlFormatError> {
        Ok(u32::from_be_bytes(self.array()?))
    }

    pub(super) fn u64(&mut self) -> Result<u64, IgtlFormatError> {
        Ok(u64::from_be_bytes(self.array()?))
    }

    pub(super) fn f32s<const N: usize>(&mut self) -> Result<[f32; N], IgtlFormatError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = f32::from_be_bytes(self.array()?);
        }
        Ok(numbers)
    }

    pub(super) fn f64(&mut self) -> Result<f64, IgtlFormatError> {
        Ok(f64::from_be_bytes(self.array()?))
    }

    /// Reads a name in a field of this length.
    pub(super) fn name(&mut self, length: usize) -> Result<String, IgtlFormatError> {
        let field = self.bytes(length)?;
        let end = field.iter().position(|byte| *byte == 0).unwrap_or(length);
        Ok(String::from_utf8_lossy(&field[..end]).into_owned())
    }
}

/// Appends a name in a field of this length. A name that is too long is cut between two characters.
pub(super) fn put_name(bytes: &mut Vec<u8>, name: &str, length: usize) {
    let mut end = name.len().min(length);
    while !name.is_char_boundary(end) {
        end -= 1;
    }
    bytes.extend(&name.as_bytes()[..end]);
    bytes.resize(bytes.len() + length - end, 0);
}

pub(super) fn put_f32s(bytes: &mut Vec<u8>, numbers: impl IntoIterator<Item = f32>) {
    for number in numbers {
        bytes.extend(number.to_be_bytes());
    }
}
