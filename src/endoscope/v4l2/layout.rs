//! The structures of <linux/videodev2.h> on 64-bit systems, as bytes: the offset of each number, and the structure of
//! each request.

/// Buffer type of a capture device; the memory belongs to the driver.
pub(super) const CAPTURE: u32 = 1;
pub(super) const MEMORY_MMAP: u32 = 1;

pub(super) const CAN_CAPTURE: u32 = 0x1;
pub(super) const CAN_CAPTURE_PLANES: u32 = 0x1000;
pub(super) const CAN_STREAM: u32 = 0x0400_0000;
/// The capabilities of this node are in a separate field.
pub(super) const HAS_OWN: u32 = 0x8000_0000;

/// Flags of a filled buffer.
pub(super) const DAMAGED: u32 = 0x40;
pub(super) const CLOCK_MASK: u32 = 0xe000;
pub(super) const CLOCK_MONOTONIC: u32 = 0x2000;

/// Colour spaces of a device.
pub(super) const SPACE_REC709: u32 = 3;
pub(super) const SPACE_JPEG: u32 = 7;
pub(super) const SPACE_DCI_P3: u32 = 12;
pub(super) const ENCODING_709: [u32; 2] = [2, 4];
pub(super) const RANGE_FULL: u32 = 1;
pub(super) const RANGE_LIMITED: u32 = 2;

/// A single frame size, not a range.
pub(super) const SIZE_DISCRETE: u32 = 1;

/// A request: its number, the direction of its structure, and its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct KernelRequest {
    pub(super) number: u8,
    direction: u32,
    pub(super) length: usize,
}

const fn request(number: u8, direction: u32, length: usize) -> KernelRequest {
    KernelRequest { number, direction, length }
}

const READ: u32 = 2;
const WRITE: u32 = 1;

pub(super) const QUERYCAP: KernelRequest = request(0, READ, 104);
pub(super) const ENUM_FMT: KernelRequest = request(2, READ | WRITE, 64);
pub(super) const G_FMT: KernelRequest = request(4, READ | WRITE, 208);
pub(super) const S_FMT: KernelRequest = request(5, READ | WRITE, 208);
pub(super) const REQBUFS: KernelRequest = request(8, READ | WRITE, 20);
pub(super) const QUERYBUF: KernelRequest = request(9, READ | WRITE, 88);
pub(super) const QBUF: KernelRequest = request(15, READ | WRITE, 88);
pub(super) const DQBUF: KernelRequest = request(17, READ | WRITE, 88);
pub(super) const STREAMON: KernelRequest = request(18, WRITE, 4);
pub(super) const STREAMOFF: KernelRequest = request(19, WRITE, 4);
pub(super) const S_PARM: KernelRequest = request(22, READ | WRITE, 204);
pub(super) const ENUM_FRAMESIZES: KernelRequest = request(74, READ | WRITE, 44);

impl KernelRequest {
    /// Returns the number for the system call.
    pub(super) const fn code(self) -> u32 {
        self.direction << 30 | (self.length as u32) << 16 | (b'V' as u32) << 8 | self.number as u32
    }
}

/// Offsets, bytes.
pub(super) mod at {
    pub(in super::super) const CAP_CARD: usize = 16;
    pub(in super::super) const CAP_ALL: usize = 84;
    pub(in super::super) const CAP_OWN: usize = 88;
    pub(in super::super) const FMTDESC_TYPE: usize = 4;
    pub(in super::super) const FMTDESC_PIXELS: usize = 44;
    pub(in super::super) const FMT_WIDTH: usize = 8;
    pub(in super::super) const FMT_HEIGHT: usize = 12;
    pub(in super::super) const FMT_PIXELS: usize = 16;
    pub(in super::super) const FMT_FIELD: usize = 20;
    pub(in super::super) const FMT_STRIDE: usize = 24;
    pub(in super::super) const FMT_SPACE: usize = 32;
    pub(in super::super) const FMT_ENCODING: usize = 44;
    pub(in super::super) const FMT_RANGE: usize = 48;
    pub(in super::super) const REQ_TYPE: usize = 4;
    pub(in super::super) const REQ_MEMORY: usize = 8;
    pub(in super::super) const BUF_TYPE: usize = 4;
    pub(in super::super) const BUF_USED: usize = 8;
    pub(in super::super) const BUF_FLAGS: usize = 12;
    pub(in super::super) const BUF_SECONDS: usize = 24;
    pub(in super::super) const BUF_MICROSECONDS: usize = 32;
    pub(in super::super) const BUF_MEMORY: usize = 60;
    pub(in super::super) const BUF_OFFSET: usize = 64;
    pub(in super::super) const BUF_LENGTH: usize = 72;
    pub(in super::super) const PARM_NUMERATOR: usize = 12;
    pub(in super::super) const PARM_DENOMINATOR: usize = 16;
    pub(in super::super) const SIZE_PIXELS: usize = 4;
    pub(in super::super) const SIZE_TYPE: usize = 8;
    pub(in super::super) const SIZE_WIDTH: usize = 12;
    pub(in super::super) const SIZE_HEIGHT: usize = 16;
    pub(in super::super) const SIZE_MAX_WIDTH: usize = 16;
    pub(in super::super) const SIZE_MAX_HEIGHT: usize = 28;
}

/// A structure, initially all zero.
#[derive(Clone, Debug)]
pub(super) struct LayoutBlock(pub(super) Vec<u8>);

impl LayoutBlock {
    pub(super) fn of(request: KernelRequest) -> Self {
        Self(vec![0; request.length])
    }

    pub(super) fn with(mut self, at: usize, value: u32) -> Self {
        self.set(at, value);
        self
    }

    pub(super) fn set(&mut self, at: usize, value: u32) {
        if let Some(bytes) = self.0.get_mut(at..at + 4) {
            bytes.copy_from_slice(&value.to_ne_bytes());
        }
    }

    pub(super) fn get(&self, at: usize) -> u32 {
        self.0.get(at..).and_then(|bytes| bytes.first_chunk()).map_or(0, |bytes| u32::from_ne_bytes(*bytes))
    }

    /// Reads eight bytes as a signed number.
    pub(super) fn long(&self, at: usize) -> i64 {
        self.0.get(at..).and_then(|bytes| bytes.first_chunk()).map_or(0, |bytes| i64::from_ne_bytes(*bytes))
    }

    /// Returns the text up to its terminating zero, usable in a message.
    pub(super) fn text(&self, at: usize, length: usize) -> String {
        let bytes = self.0.get(at..at + length).unwrap_or_default();
        let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
        String::from_utf8_lossy(&bytes[..end]).chars().filter(|c| !c.is_control()).collect()
    }
}
