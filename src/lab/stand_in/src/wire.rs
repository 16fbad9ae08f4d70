//! One exchange with an emulated handle: a request and a reply, each one datagram, like a USB exchange of the real
//! device.
//!
//! This file is compiled twice, here and in the stub library (`emulators/omega`), so that both sides agree by
//! construction; it uses only the standard library. Numbers are little-endian; lengths in m, forces in N, angles in
//! rad. A datagram ends with a checksum (FNV-1a, 32 bits); a datagram that is too short, too long, of another kind or
//! damaged is `None`.

/// Entries of the status array (SDK 3.17: power ... axis checked).
pub const STATUS_ENTRIES: usize = 17;
/// Bytes.
pub const REQUEST_BYTES: usize = 60;
/// Bytes.
pub const REPLY_BYTES: usize = 228;
/// Environment variable with the addresses of emulated handles, separated by commas; without it no device is attached.
pub const ADDRESS_VARIABLE: &str = "NIMA_EMULATED_HANDLE";

const REQUEST_KIND: u32 = 0x514d_494e; // "NIMQ"
const REPLY_KIND: u32 = 0x524d_494e; // "NIMR"

/// A client's command to the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum ClientOrder {
    /// Identifies the device. Changes nothing; allowed for every client.
    Hello = 0,
    /// Takes control of the device.
    Open,
    Read,
    /// Sets the force (first three values) and the gripper force (fourth), and reads everything.
    Force,
    /// Argument 1: force on. 0: force off.
    EnableForce,
    /// Argument 1: brakes on. 0: brakes off, no current.
    Brakes,
    /// Argument: 125 us steps without a force command until the device switches off; 0 is never.
    Watchdog,
    /// Argument: speed at which the force is cut, mm/s here (the real unit is specific to the device); 0 means never.
    VelocityThreshold,
    /// Argument 1: the gripper counts as a button when closed.
    Button,
    /// Releases the device, which then brakes.
    Close,
}

impl ClientOrder {
    const ALL: [Self; 10] = [
        Self::Hello,
        Self::Open,
        Self::Read,
        Self::Force,
        Self::EnableForce,
        Self::Brakes,
        Self::Watchdog,
        Self::VelocityThreshold,
        Self::Button,
        Self::Close,
    ];
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceRequest {
    /// Any number that differs between clients.
    pub client: u64,
    /// Number of the exchange.
    pub sequence: u32,
    /// The command.
    pub order: ClientOrder,
    /// Argument of the order.
    pub argument: u32,
    /// Values of [`ClientOrder::Force`], N.
    pub values: [f64; 4],
}

impl DeviceRequest {
    pub fn encode(&self) -> [u8; REQUEST_BYTES] {
        let mut out = Out([0; REQUEST_BYTES], 0);
        out.put(&REQUEST_KIND.to_le_bytes());
        out.put(&self.client.to_le_bytes());
        out.put(&self.sequence.to_le_bytes());
        out.put(&(self.order as u32).to_le_bytes());
        out.put(&self.argument.to_le_bytes());
        out.numbers(&self.values);
        out.sealed()
    }

    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let mut of = DatagramReader::opened(bytes, REQUEST_BYTES, REQUEST_KIND)?;
        let client = u64::from_le_bytes(of.take()?);
        let sequence = of.word()?;
        let order = of.word()?;
        let order = ClientOrder::ALL.into_iter().find(|known| *known as u32 == order)?;
        Some(Self { client, sequence, order, argument: of.word()?, values: of.numbers()? })
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeviceReply {
    /// Client of the request.
    pub client: u64,
    /// From the request.
    pub sequence: u32,
    /// Number of the SDK's error; 0 is none.
    pub error: u32,
    /// Bit 0: the state is newer than the previous one. Bit 1: the motors were saturated. Bit 2: another program has it
    /// open.
    pub flags: u32,
    pub serial: u32,
    /// Type of the device, numbered as in the SDK.
    pub kind: u32,
    /// The first in the lowest bit.
    pub buttons: u32,
    pub velocity_threshold: u32,
    /// 125 us steps.
    pub watchdog: u32,
    pub status: [u32; STATUS_ENTRIES],
    pub firmware: f64,
    pub position_m: [f64; 3],
    /// Row by row.
    pub frame: [f64; 9],
    /// Opening of the gripper, rad, negative on left-handed devices.
    pub gripper_rad: f64,
}

/// [`DeviceReply::flags`]: the state is newer than the previous one.
pub const FRESH: u32 = 1;
/// [`DeviceReply::flags`]: the motors were saturated.
pub const SATURATED: u32 = 2;
/// Flag in [`DeviceReply::flags`]: another program has the device open.
pub const TAKEN: u32 = 4;

impl DeviceReply {
    pub fn encode(&self) -> [u8; REPLY_BYTES] {
        let mut out = Out([0; REPLY_BYTES], 0);
        out.put(&REPLY_KIND.to_le_bytes());
        out.put(&self.client.to_le_bytes());
        let words = [self.sequence, self.error, self.flags, self.serial, self.kind, self.buttons];
        for word in words.into_iter().chain([self.velocity_threshold, self.watchdog]).chain(self.status) {
            out.put(&word.to_le_bytes());
        }
        out.numbers(&[self.firmware]);
        out.numbers(&self.position_m);
        out.numbers(&self.frame);
        out.numbers(&[self.gripper_rad]);
        out.sealed()
    }

    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let mut of = DatagramReader::opened(bytes, REPLY_BYTES, REPLY_KIND)?;
        let client = u64::from_le_bytes(of.take()?);
        let sequence = of.word()?;
        let error = of.word()?;
        let flags = of.word()?;
        let serial = of.word()?;
        let kind = of.word()?;
        let buttons = of.word()?;
        let velocity_threshold = of.word()?;
        let watchdog = of.word()?;
        let mut status = [0; STATUS_ENTRIES];
        for entry in &mut status {
            *entry = of.word()?;
        }
        let [firmware] = of.numbers()?;
        let position_m = of.numbers()?;
        let frame = of.numbers()?;
        let [gripper_rad] = of.numbers()?;
        Some(Self {
            client,
            sequence,
            error,
            flags,
            serial,
            kind,
            buttons,
            velocity_threshold,
            watchdog,
            status,
            firmware,
            position_m,
            frame,
            gripper_rad,
        })
    }
}

fn checksum(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0x811c_9dc5, |sum, byte| (sum ^ u32::from(*byte)).wrapping_mul(0x0100_0193))
}

/// A datagram being written; data that do not fit are left out, which cannot happen with the messages here.
struct Out<const N: usize>([u8; N], usize);

impl<const N: usize> Out<N> {
    fn put(&mut self, bytes: &[u8]) {
        if let Some(place) = self.0.get_mut(self.1..self.1 + bytes.len()) {
            place.copy_from_slice(bytes);
        }
        self.1 += bytes.len();
    }

    fn numbers(&mut self, numbers: &[f64]) {
        for number in numbers {
            self.put(&number.to_le_bytes());
        }
    }

    fn sealed(mut self) -> [u8; N] {
        let sum = checksum(&self.0[..N - 4]);
        self.1 = N - 4;
        self.put(&sum.to_le_bytes());
        self.0
    }
}

struct DatagramReader<'a>(&'a [u8]);

impl<'a> DatagramReader<'a> {
    fn opened(bytes: &'a [u8], length: usize, kind: u32) -> Option<Self> {
        let (body, sum) = bytes.split_last_chunk().filter(|_| bytes.len() == length)?;
        let mut of = Self(body);
        (u32::from_le_bytes(*sum) == checksum(body) && of.word()? == kind).then_some(of)
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    fn word(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn numbers<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = f64::from_le_bytes(self.take()?);
        }
        Some(numbers)
    }
}
