//! Commands of the Combined API: encoding by the host, parsing by the unit.
//!
//! `NAME:arguments` + checksum + CR, or `NAME arguments` + CR without a checksum (reference 1.2, 1.3). Units are those
//! of the API. No allocation.

use super::{
    crc::{crc16, read_hex, write_hex},
    text::ErrorCode,
};

/// Bytes of a tool definition in one command: `PVWR` carries 128 hexadecimal digits (`ndicapi`).
pub const CHUNK: usize = 64;
/// Maximum length of an accepted command line, including CR; the line of a tool definition has 144 bytes.
pub const COMMAND_MAX: usize = 192;
/// Port to request: any device, any system, passive tool, any port.
pub const WIRELESS: [u8; 14] = *b"*********1****";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplyForm {
    /// `TX`: ASCII, four decimals.
    Text,
    /// `BX`: binary, 32-bit floats.
    Binary,
}

/// Reply option: transforms, port status and frame numbers.
pub const TRANSFORMS: u16 = 0x0001;
/// Reply option: also report tools outside the volume.
pub const OUTSIDE_TOO: u16 = 0x0800;
/// Reply option: stray passive markers (markers that belong to no tool).
pub const STRAYS: u16 = 0x1000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    All,
    ToFree,
    /// Occupied, not initialised.
    ToInitialise,
    /// Initialised, not enabled.
    ToEnable,
    Enabled,
}

impl Filter {
    const ALL: [Self; 5] = [Self::All, Self::ToFree, Self::ToInitialise, Self::ToEnable, Self::Enabled];
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NdiPriority {
    /// Fixed in the scene.
    Static,
    /// Moving.
    Dynamic,
    /// A tool that has only switches.
    Buttons,
}

impl NdiPriority {
    const fn letter(self) -> u8 {
        match self {
            Self::Static => b'S',
            Self::Dynamic => b'D',
            Self::Buttons => b'B',
        }
    }
}

/// Line speeds by their code in `COMM`, bit/s.
const SPEEDS: [(u8, u32); 9] = [
    (b'0', 9600),
    (b'1', 14_400),
    (b'2', 19_200),
    (b'3', 38_400),
    (b'4', 57_600),
    (b'5', 115_200),
    (b'6', 921_600),
    (b'7', 1_228_739),
    (b'A', 230_400),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NdiCommand<'a> {
    /// `INIT`: frees all handles and stops tracking.
    Init,
    /// `RESET`: returns to the state after power-on.
    Reset,
    /// `APIREV`: revision of the interface.
    ApiRevision,
    /// `COMM`: speed of the serial line, bit/s; 8 data bits, no parity, one stop bit, no handshake.
    Comm { baud: u32 },
    /// `VER`: version texts; 0 is the control firmware.
    Version(u8),
    /// `GETINFO`: description of a user parameter.
    GetInfo(&'a str),
    /// `GET`: value of a user parameter.
    Get(&'a str),
    /// `SET`: sets a user parameter, `name=value`.
    Set(&'a str),
    /// `ECHO`: returns its argument.
    Echo(&'a str),
    /// `BEEP`: beeps 1 to 9 times.
    Beep(u8),
    /// `PHSR`: lists handles and their status.
    Handles(Filter),
    /// `PHRQ`: requests a handle for the port described.
    Request([u8; 14]),
    /// `PVWR`: writes a piece of a tool definition.
    Write {
        handle: u8,
        /// Address within the definition.
        address: u16,
        data: [u8; CHUNK],
    },
    /// `PINIT`: initialises a handle.
    Initialise(u8),
    /// `PENA`: enables tracking of a handle.
    Enable(u8, NdiPriority),
    /// `PDIS`: disables tracking of a handle.
    Disable(u8),
    /// `PHF`: frees a handle.
    Free(u8),
    /// `PHINF`: information about a handle, selected by option bits.
    Information { handle: u8, options: u16 },
    /// `TSTART`: starts tracking; with option 80 the frame counter is reset.
    Start { anew: bool },
    /// `TSTOP`: stops tracking.
    Stop,
    /// `TX` or `BX`: requests tracking data, with reply options.
    Track(ReplyForm, u16),
}

#[derive(Clone, Copy, Debug)]
pub struct CommandLine {
    bytes: [u8; COMMAND_MAX],
    length: usize,
}

impl CommandLine {
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }

    /// Drops bytes that do not fit, so that the unit refuses the command; only free text can be that long.
    fn push(&mut self, bytes: &[u8]) {
        let count = bytes.len().min(COMMAND_MAX - 5 - self.length.min(COMMAND_MAX - 5));
        self.bytes[self.length..self.length + count].copy_from_slice(&bytes[..count]);
        self.length += count;
    }

    fn hex(&mut self, digits: usize, number: u32) {
        let mut text = [0; 8];
        write_hex(&mut text[..digits], u64::from(number));
        self.push(&text[..digits]);
    }
}

impl<'a> NdiCommand<'a> {
    /// Returns the name in the API.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Init => "INIT",
            Self::Reset => "RESET",
            Self::ApiRevision => "APIREV",
            Self::Comm { .. } => "COMM",
            Self::Version(_) => "VER",
            Self::GetInfo(_) => "GETINFO",
            Self::Get(_) => "GET",
            Self::Set(_) => "SET",
            Self::Echo(_) => "ECHO",
            Self::Beep(_) => "BEEP",
            Self::Handles(_) => "PHSR",
            Self::Request(_) => "PHRQ",
            Self::Write { .. } => "PVWR",
            Self::Initialise(_) => "PINIT",
            Self::Enable(..) => "PENA",
            Self::Disable(_) => "PDIS",
            Self::Free(_) => "PHF",
            Self::Information { .. } => "PHINF",
            Self::Start { .. } => "TSTART",
            Self::Stop => "TSTOP",
            Self::Track(ReplyForm::Text, _) => "TX",
            Self::Track(ReplyForm::Binary, _) => "BX",
        }
    }

    pub fn encode(&self) -> CommandLine {
        let mut line = self.written(b':');
        let crc = crc16(line.as_bytes());
        write_hex(&mut line.bytes[line.length..line.length + 4], u64::from(crc));
        line.length += 4;
        line.bytes[line.length] = b'\r';
        line.length += 1;
        line
    }

    /// Encodes the command without a checksum, with CR.
    pub fn encode_unchecked(&self) -> CommandLine {
        let mut line = self.written(b' ');
        line.bytes[line.length] = b'\r';
        line.length += 1;
        line
    }

    fn written(&self, separator: u8) -> CommandLine {
        let mut line = CommandLine { bytes: [0; COMMAND_MAX], length: 0 };
        line.push(self.name().as_bytes());
        line.push(&[separator]);
        match *self {
            Self::Init | Self::Reset | Self::ApiRevision | Self::Stop | Self::Start { anew: false } => {}
            Self::Start { anew: true } => line.push(b"80"),
            Self::Comm { baud } => {
                // The unit refuses a speed that has no code.
                let code = SPEEDS.iter().find(|(_, speed)| *speed == baud).map_or(b'?', |(code, _)| *code);
                line.push(&[code]);
                line.push(b"0000");
            }
            Self::Version(number) | Self::Beep(number) => line.hex(1, u32::from(number)),
            Self::GetInfo(text) | Self::Get(text) | Self::Set(text) | Self::Echo(text) => line.push(text.as_bytes()),
            Self::Handles(filter) => line.hex(2, filter as u32),
            Self::Request(port) => line.push(&port),
            Self::Write { handle, address, data } => {
                line.hex(2, u32::from(handle));
                line.hex(4, u32::from(address));
                for byte in data {
                    line.hex(2, u32::from(byte));
                }
            }
            Self::Initialise(handle) | Self::Disable(handle) | Self::Free(handle) => line.hex(2, u32::from(handle)),
            Self::Enable(handle, priority) => {
                line.hex(2, u32::from(handle));
                line.push(&[priority.letter()]);
            }
            Self::Information { handle, options } => {
                line.hex(2, u32::from(handle));
                line.hex(4, u32::from(options));
            }
            Self::Track(_, options) => line.hex(4, u32::from(options)),
        }
        line
    }

    /// Parses a line (without its CR) like the unit; an error is the unit's answer.
    ///
    /// # Errors
    /// [`ErrorCode`] that the unit would answer.
    ///
    /// ```
    /// use nima_devices::ndi::{NdiCommand, ErrorCode};
    ///
    /// let line = NdiCommand::Beep(2).encode();
    /// let (cr, text) = line.as_bytes().split_last().expect("a command is never empty");
    /// assert!(text.starts_with(b"BEEP:2") && *cr == b'\r');
    /// assert_eq!(NdiCommand::parse(text), Ok(NdiCommand::Beep(2)));
    /// assert_eq!(NdiCommand::parse(b"BEEP:20000"), Err(ErrorCode::BAD_CRC));
    /// ```
    pub fn parse(line: &'a [u8]) -> Result<Self, ErrorCode> {
        let is_name = |byte: &u8| byte.is_ascii_uppercase() || byte.is_ascii_digit();
        let end = line.iter().position(|byte| !is_name(byte)).unwrap_or(line.len());
        let (name, rest) = line.split_at(end);
        let arguments = match rest.first() {
            None => rest,
            Some(b' ') => &rest[1..],
            Some(b':') => {
                let cut = rest.len().checked_sub(4).filter(|cut| *cut >= 1).ok_or(ErrorCode::TOO_SHORT)?;
                if read_hex(&rest[cut..]) != Some(u32::from(crc16(&line[..end + cut]))) {
                    return Err(ErrorCode::BAD_CRC);
                }
                &rest[1..cut]
            }
            Some(_) => return Err(ErrorCode::INVALID_COMMAND),
        };
        Self::of(name, arguments)
    }

    fn of(name: &[u8], arguments: &'a [u8]) -> Result<Self, ErrorCode> {
        let text = || std::str::from_utf8(arguments).map_err(|_| ErrorCode::OUT_OF_RANGE);
        Ok(match name {
            b"INIT" => Self::Init,
            b"RESET" => Self::Reset,
            b"APIREV" => Self::ApiRevision,
            b"TSTOP" => Self::Stop,
            b"TSTART" => match arguments {
                b"" => Self::Start { anew: false },
                b"80" => Self::Start { anew: true },
                _ => return Err(ErrorCode::OUT_OF_RANGE),
            },
            b"COMM" => Self::comm(arguments)?,
            b"VER" => Self::Version(hex(arguments, 0, 1)? as u8),
            b"BEEP" => match hex(arguments, 0, 1)? {
                count @ 1..=9 => Self::Beep(count as u8),
                _ => return Err(ErrorCode::OUT_OF_RANGE),
            },
            b"GETINFO" => Self::GetInfo(text()?),
            b"GET" => Self::Get(text()?),
            b"SET" => Self::Set(text()?),
            b"ECHO" => Self::Echo(text()?),
            b"TX" => Self::Track(ReplyForm::Text, options(arguments, 0)?),
            b"BX" => Self::Track(ReplyForm::Binary, options(arguments, 0)?),
            _ => return Self::of_port(name, arguments),
        })
    }

    fn of_port(name: &[u8], arguments: &[u8]) -> Result<Self, ErrorCode> {
        let handle = || Ok(hex(arguments, 0, 2)? as u8);
        Ok(match name {
            b"PHSR" => {
                let number = if arguments.is_empty() { 0 } else { hex(arguments, 0, 2)? };
                Self::Handles(*Filter::ALL.get(number as usize).ok_or(ErrorCode::OUT_OF_RANGE)?)
            }
            b"PHRQ" => Self::Request(arguments.try_into().map_err(|_| ErrorCode::PARAMETER_COUNT)?),
            b"PVWR" => Self::write(arguments)?,
            b"PINIT" => Self::Initialise(handle()?),
            b"PDIS" => Self::Disable(handle()?),
            b"PHF" => Self::Free(handle()?),
            b"PENA" => {
                let priorities = [NdiPriority::Static, NdiPriority::Dynamic, NdiPriority::Buttons];
                let letter = *arguments.get(2).ok_or(ErrorCode::PARAMETER_COUNT)?;
                let priority = priorities.into_iter().find(|one| one.letter() == letter);
                Self::Enable(handle()?, priority.ok_or(ErrorCode::INVALID_PRIORITY)?)
            }
            b"PHINF" => Self::Information { handle: handle()?, options: options(arguments, 2)? },
            _ => return Err(ErrorCode::INVALID_COMMAND),
        })
    }

    fn comm(arguments: &[u8]) -> Result<Self, ErrorCode> {
        let [code, b'0', b'0', b'0', b'0'] = arguments else { return Err(ErrorCode::COMM_PARAMETERS) };
        let known = SPEEDS.iter().find(|(known, _)| known == code);
        known.map(|(_, baud)| Self::Comm { baud: *baud }).ok_or(ErrorCode::COMM_PARAMETERS)
    }

    fn write(arguments: &[u8]) -> Result<Self, ErrorCode> {
        if arguments.len() != 6 + 2 * CHUNK {
            return Err(ErrorCode::PARAMETER_COUNT);
        }
        let handle = hex(arguments, 0, 2)? as u8;
        let address = hex(arguments, 2, 4)? as u16;
        let mut data = [0; CHUNK];
        for (k, byte) in data.iter_mut().enumerate() {
            *byte = hex(arguments, 6 + 2 * k, 2)? as u8;
        }
        Ok(Self::Write { handle, address, data })
    }
}

/// Parses `digits` hexadecimal digits at `begin`.
fn hex(arguments: &[u8], begin: usize, digits: usize) -> Result<u32, ErrorCode> {
    let text = arguments.get(begin..begin + digits).ok_or(ErrorCode::PARAMETER_COUNT)?;
    read_hex(text).ok_or(ErrorCode::OUT_OF_RANGE)
}

/// Parses reply options at `begin`; without options, returns the default of the guide.
fn options(arguments: &[u8], begin: usize) -> Result<u16, ErrorCode> {
    if arguments.len() == begin { Ok(TRANSFORMS) } else { Ok(hex(arguments, begin, 4)? as u16) }
}
