//! An image: one slice of coloured pixels.

use super::{
    IgtlFormatError,
    wire::{IgtlCursor, put_f32s},
};

/// An image with 8 bits per colour, the first pixel at the upper left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width and height.
    pub size_px: [u16; 2],
    /// Colours of a pixel: 1 grey, 3 red, green and blue.
    pub colours: u8,
    /// Row by row.
    pub pixels: Vec<u8>,
}

/// Bytes before the pixels. Given by the specification of the protocol, IMAGE message.
const HEAD: usize = 72;
/// Version of the image's own header, unsigned bytes, and right-anterior-superior.
const VERSION: u16 = 1;
const BYTES_OF_8_BITS: u8 = 3;
const LITTLE_ENDIAN: u8 = 2;
const RAS: u8 = 1;

impl Image {
    pub(super) fn put(&self, bytes: &mut Vec<u8>) {
        let [width, height] = self.size_px;
        let size = [width, height, 1].map(u16::to_be_bytes);
        bytes.extend(VERSION.to_be_bytes());
        bytes.extend([self.colours, BYTES_OF_8_BITS, LITTLE_ENDIAN, RAS]);
        bytes.extend(size.as_flattened());
        // Pixels of 1 mm; the position of the image in space is not given.
        put_f32s(bytes, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        bytes.extend([0; 6]);
        bytes.extend(size.as_flattened());
        bytes.extend(&self.pixels);
    }

    pub(super) fn take(content: &[u8]) -> Result<Self, IgtlFormatError> {
        let wrong = |what| IgtlFormatError::Value { kind: "IMAGE".to_owned(), what };
        let mut from = IgtlCursor(content);
        if from.u16()? != VERSION {
            return Err(wrong("the version of the image"));
        }
        let [colours, scalar, ..] = from.array::<4>()?;
        let size = [from.u16()?, from.u16()?, from.u16()?];
        from.f32s::<12>()?;
        let begin = [from.u16()?, from.u16()?, from.u16()?];
        let part = [from.u16()?, from.u16()?, from.u16()?];
        if scalar != BYTES_OF_8_BITS || ![1, 3, 4].contains(&colours) {
            return Err(wrong("the pixel type (8 bits per colour are supported)"));
        }
        if begin != [0; 3] || part != size || size[2] != 1 {
            return Err(wrong("the part of the image (one complete slice is supported)"));
        }
        let count = usize::from(size[0]) * usize::from(size[1]) * usize::from(colours);
        if content.len() != HEAD + count {
            return Err(IgtlFormatError::Length { kind: "IMAGE".to_owned(), bytes: content.len() });
        }
        Ok(Self { size_px: [size[0], size[1]], colours, pixels: content[HEAD..].to_vec() })
    }
}
