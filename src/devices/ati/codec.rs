//! Requests and records, all numbers big endian. No clock, no allocation.

/// UDP port of the sensor.
pub const PORT: u16 = 49_152;
// First bytes of every request.
const HEADER: u16 = 0x1234;
pub const REQUEST_BYTES: usize = 8;
// Three numbers and six counts of four bytes each.
pub const RECORD_BYTES: usize = 36;

/// A command to the sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RdtCommand {
    Stop,
    /// Sends one record per datagram until it is stopped.
    StartRealTime,
}

impl RdtCommand {
    const fn code(self) -> u16 {
        match self {
            Self::Stop => 0,
            Self::StartRealTime => 2,
        }
    }

    /// Returns the request; a sample count of 0 means without end.
    pub fn encode(self) -> [u8; REQUEST_BYTES] {
        let [h0, h1] = HEADER.to_be_bytes();
        let [c0, c1] = self.code().to_be_bytes();
        [h0, h1, c0, c1, 0, 0, 0, 0]
    }

    /// Parses a request; `None` for another one.
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let [h0, h1, c0, c1, _, _, _, _] = *bytes else { return None };
        if u16::from_be_bytes([h0, h1]) != HEADER {
            return None;
        }
        [Self::Stop, Self::StartRealTime].into_iter().find(|command| command.code() == u16::from_be_bytes([c0, c1]))
    }
}

/// One record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RdtRecord {
    /// Number of the record since the start of the transfer.
    pub number: u32,
    /// Number of the measurement since the sensor was switched on.
    pub measurement: u32,
    /// 0 without a fault.
    pub status: u32,
    /// Force and torque, counts.
    pub counts: [i32; 6],
}

impl RdtRecord {
    /// Parses a datagram; `None` if it is not a record.
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let bytes: &[u8; RECORD_BYTES] = bytes.try_into().ok()?;
        let (words, _) = bytes.as_chunks::<4>();
        let unsigned = |place: usize| u32::from_be_bytes(words[place]);
        Some(Self {
            number: unsigned(0),
            measurement: unsigned(1),
            status: unsigned(2),
            counts: std::array::from_fn(|axis| i32::from_be_bytes(words[3 + axis])),
        })
    }

    pub fn encode(&self) -> [u8; RECORD_BYTES] {
        let mut bytes = [0; RECORD_BYTES];
        let counts = self.counts.map(i32::cast_unsigned);
        let words = [self.number, self.measurement, self.status].into_iter().chain(counts);
        bytes.as_chunks_mut::<4>().0.iter_mut().zip(words).for_each(|(to, word)| *to = word.to_be_bytes());
        bytes
    }
}
