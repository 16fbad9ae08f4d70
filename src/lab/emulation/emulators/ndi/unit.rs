//! The unit itself, without I/O: takes a command line, returns a reply.

use nima_devices::{
    TrackedTool,
    ndi::{
        command::{COMMAND_MAX, Filter, NdiCommand, OUTSIDE_TOO, ReplyForm, STRAYS, TRANSFORMS},
        definition::DEFINITION,
        reply::{block_of, finish_line},
        text::{ErrorCode, PortStatus, SystemStatus},
        tracking::{HandleFrame, ToolVisibility, TrackingReply, Transform},
    },
};

use super::{
    FRAME_HZ, NdiBody, NdiProfile,
    port::{NdiPort, information},
};
use crate::emulators::EmulatedFault;

/// Handle of the first wireless tool.
const FIRST_HANDLE: u8 = 0x0A;
/// Maximum number of defined tools.
const HANDLES: usize = 12;
/// Baud rate after power-up.
pub(super) const FIRST_BAUD: u32 = 9600;
/// Text in the form of real units; hosts that search for a unit expect at least 84 bytes.
const FIRMWARE_INFO: &str = "Features.Firmware.Version=007.000.012;3;1;0;12;;Current firmware revision number";
/// Readable user parameters.
const PARAMETERS: [(&str, &str); 4] = [
    ("Features.Firmware.Version", "007.000.012"),
    ("Info.Timeout.INIT", "5"),
    ("Info.Timeout.PINIT", "5"),
    ("Info.Timeout.TSTART", "5"),
];

/// A reply, and its effect.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnitAnswer {
    /// The bytes of the reply on the wire.
    pub bytes: Vec<u8>,
    /// Baud rate of the line after the reply, bit/s.
    pub then_baud: Option<u32>,
}

/// The mode and state of a unit.
#[derive(Debug)]
pub struct NdiUnit {
    profile: NdiProfile,
    network: bool,
    ports: Vec<NdiPort>,
    initialised: bool,
    tracking: bool,
    /// Time of the unit at which the frame counter was 0, s.
    zero_s: f64,
    frozen_s: Option<f64>,
    asked: u32,
}

enum UnitReply {
    Line(String),
    Okay,
    Bytes(Vec<u8>),
    Switch(u32),
    Reset,
}

impl NdiUnit {
    /// Creates a unit that has just been switched on; `network` if it has no serial port.
    pub fn new(profile: NdiProfile, network: bool) -> Self {
        let ports = Vec::new();
        Self { profile, network, ports, initialised: false, tracking: false, zero_s: 0.0, frozen_s: None, asked: 0 }
    }

    /// Returns the bytes written as the definition of this tool, by its number.
    pub fn definition(&self, number: usize) -> Option<&[u8]> {
        self.ports.iter().find(|port| port.number == number && port.written).map(|port| &port.definition[..])
    }

    /// Returns the reply to a reset.
    pub fn reset(&mut self) -> UnitAnswer {
        *self = Self { zero_s: self.zero_s, ..Self::new(self.profile.clone(), self.network) };
        UnitAnswer { bytes: line("RESET"), then_baud: Some(FIRST_BAUD) }
    }

    /// Answers a line (without its CR) at `unit_s`, time of the unit in s. A failed command is answered with an error;
    /// faults of the content are applied here.
    pub fn answer(&mut self, unit_s: f64, text: &[u8], fault: EmulatedFault, body: &mut dyn NdiBody) -> UnitAnswer {
        let command = if text.len() < COMMAND_MAX { NdiCommand::parse(text) } else { Err(ErrorCode::TOO_LONG) };
        let mut then_baud = None;
        let mut bytes = match command.and_then(|command| self.obey(&command, unit_s, fault, body)) {
            Ok(UnitReply::Okay) => line("OKAY"),
            Ok(UnitReply::Line(text)) => line(&text),
            Ok(UnitReply::Bytes(bytes)) => bytes,
            Ok(UnitReply::Switch(baud)) => {
                then_baud = Some(baud);
                line("OKAY")
            }
            Ok(UnitReply::Reset) => {
                let answer = self.reset();
                then_baud = answer.then_baud;
                answer.bytes
            }
            Err(ErrorCode(code)) => line(&format!("ERROR{code:02X}")),
        };
        self.spoil(&mut bytes, fault);
        UnitAnswer { bytes, then_baud }
    }

    fn spoil(&self, bytes: &mut Vec<u8>, fault: EmulatedFault) {
        match fault {
            EmulatedFault::BadChecksum => {
                // The last byte of a line is its CR, preceded by the checksum.
                let place = if bytes.ends_with(b"\r") { bytes.len() - 2 } else { bytes.len() - 1 };
                bytes[place] = if bytes[place] == b'0' { b'1' } else { b'0' };
            }
            // The checksum is right, but the reply does not match the command.
            EmulatedFault::WrongFrame if self.tracking && bytes.starts_with(&[0xC4]) => {
                *bytes = block_of(b"\x01\x0A\x01");
            }
            EmulatedFault::WrongFrame if self.tracking => *bytes = line("010A+1000"),
            _ => {}
        }
    }

    fn obey(
        &mut self,
        command: &NdiCommand<'_>,
        unit_s: f64,
        fault: EmulatedFault,
        body: &mut dyn NdiBody,
    ) -> Result<UnitReply, ErrorCode> {
        self.permitted(command)?;
        match *command {
            NdiCommand::Init => {
                self.ports.clear();
                self.initialised = true;
                self.tracking = false;
                Ok(UnitReply::Okay)
            }
            NdiCommand::Reset => Ok(UnitReply::Reset),
            NdiCommand::ApiRevision => Ok(UnitReply::Line("G.003.004".to_owned())),
            NdiCommand::Comm { .. } if self.network => Err(ErrorCode::COMM_PARAMETERS),
            NdiCommand::Comm { baud } => Ok(UnitReply::Switch(baud)),
            NdiCommand::Version(number) => self.version(number),
            NdiCommand::GetInfo(name) => Self::parameter_info(name),
            NdiCommand::Get(name) => Self::parameter(name),
            NdiCommand::Set(pair) => {
                let name = pair.split('=').next().unwrap_or_default();
                Err(if known(name).is_some() { ErrorCode::READ_ONLY } else { ErrorCode::NO_SUCH_PARAMETER })
            }
            NdiCommand::Echo(text) => Ok(UnitReply::Line(text.to_owned())),
            NdiCommand::Beep(times) => {
                body.beep(times);
                Ok(UnitReply::Line("1".to_owned()))
            }
            NdiCommand::Start { anew } => {
                self.tracking = true;
                if anew {
                    self.zero_s = unit_s;
                }
                Ok(UnitReply::Okay)
            }
            NdiCommand::Stop => {
                self.tracking = false;
                Ok(UnitReply::Okay)
            }
            NdiCommand::Track(form, options) => self.track(form, options, unit_s, fault, body),
            _ => self.obey_port(command),
        }
    }

    /// Checks that a command is allowed in the current mode.
    const fn permitted(&self, command: &NdiCommand<'_>) -> Result<(), ErrorCode> {
        let anytime = matches!(
            command,
            NdiCommand::Init
                | NdiCommand::Reset
                | NdiCommand::ApiRevision
                | NdiCommand::Get(_)
                | NdiCommand::GetInfo(_)
                | NdiCommand::Echo(_)
                | NdiCommand::Beep(_)
        );
        let before = matches!(command, NdiCommand::Comm { .. } | NdiCommand::Version(_));
        let during = matches!(command, NdiCommand::Track(..) | NdiCommand::Stop | NdiCommand::Handles(_));
        let only_during = matches!(command, NdiCommand::Track(..) | NdiCommand::Stop);
        if anytime || (before && !self.tracking) {
            Ok(())
        } else if !self.initialised {
            Err(ErrorCode::SYSTEM_NOT_INITIALISED)
        } else if (self.tracking && !during) || (!self.tracking && only_during) {
            Err(ErrorCode::INVALID_MODE)
        } else {
            Ok(())
        }
    }

    fn version(&self, number: u8) -> Result<UnitReply, ErrorCode> {
        let NdiProfile { product, serial, firmware } = &self.profile;
        match number {
            0 => Ok(UnitReply::Line(format!(
                "{product} Control Firmware\nNDI S/N: {serial}\nCharacterization Date: 01/01/26\n\
                 Freeze Tag: {firmware}\nFreeze Date: 01/01/26\n(emulated)\n"
            ))),
            3 | 4 | 5 | 7 | 8 => Ok(UnitReply::Line(format!("{product} part {number}\nFreeze Tag: {firmware}\n"))),
            _ => Err(ErrorCode::OUT_OF_RANGE),
        }
    }

    fn parameter_info(name: &str) -> Result<UnitReply, ErrorCode> {
        match known(name) {
            Some(_) if name == PARAMETERS[0].0 => Ok(UnitReply::Line(FIRMWARE_INFO.to_owned())),
            Some(value) => Ok(UnitReply::Line(format!("{name}={value};1;1;0;60;;Longest time of the command, s"))),
            None => Err(ErrorCode::NO_SUCH_PARAMETER),
        }
    }

    fn parameter(name: &str) -> Result<UnitReply, ErrorCode> {
        let value = known(name).ok_or(ErrorCode::NO_SUCH_PARAMETER)?;
        Ok(UnitReply::Line(format!("{name}={value}\n")))
    }

    fn port(&mut self, handle: u8) -> Result<&mut NdiPort, ErrorCode> {
        self.ports.iter_mut().find(|port| port.handle == handle).ok_or(ErrorCode::INVALID_HANDLE)
    }

    /// Executes the commands on handles.
    fn obey_port(&mut self, command: &NdiCommand<'_>) -> Result<UnitReply, ErrorCode> {
        match *command {
            NdiCommand::Handles(filter) => Ok(UnitReply::Line(self.list(filter))),
            NdiCommand::Request(_) => self.request().map(UnitReply::Line),
            NdiCommand::Write { handle, address, data } => {
                let port = self.port(handle)?;
                let place = usize::from(address)..usize::from(address) + data.len();
                port.definition.get_mut(place).ok_or(ErrorCode::OUT_OF_RANGE)?.copy_from_slice(&data);
                port.written = true;
                Ok(UnitReply::Okay)
            }
            NdiCommand::Initialise(handle) => {
                let port = self.port(handle)?;
                port.initialised = port.written;
                if port.written { Ok(UnitReply::Okay) } else { Err(ErrorCode::NO_TOOL) }
            }
            NdiCommand::Enable(handle, _) => {
                let port = self.port(handle)?;
                port.enabled = port.initialised;
                if port.initialised { Ok(UnitReply::Okay) } else { Err(ErrorCode::NOT_INITIALISED) }
            }
            NdiCommand::Disable(handle) => {
                let port = self.port(handle)?;
                if std::mem::take(&mut port.enabled) { Ok(UnitReply::Okay) } else { Err(ErrorCode::NOT_ENABLED) }
            }
            NdiCommand::Free(handle) => {
                self.port(handle)?;
                self.ports.retain(|port| port.handle != handle);
                Ok(UnitReply::Okay)
            }
            NdiCommand::Information { handle, options } => {
                let port = self.port(handle)?;
                Ok(UnitReply::Line(if port.written { information(port, options) } else { "UNOCCUPIED".to_owned() }))
            }
            _ => Err(ErrorCode::INVALID_COMMAND),
        }
    }

    fn list(&self, filter: Filter) -> String {
        let wanted = |port: &&NdiPort| match filter {
            Filter::All => true,
            Filter::ToFree => false,
            Filter::ToInitialise => port.written && !port.initialised,
            Filter::ToEnable => port.initialised && !port.enabled,
            Filter::Enabled => port.enabled,
        };
        let ports: Vec<&NdiPort> = self.ports.iter().filter(wanted).collect();
        let entries = ports.iter().map(|port| format!("{:02X}{:03X}", port.handle, port.status()));
        format!("{:02X}{}", ports.len(), entries.collect::<String>())
    }

    fn request(&mut self) -> Result<String, ErrorCode> {
        let free = |number: &usize| self.ports.iter().all(|port| port.number != *number);
        let number = (0..HANDLES).find(free).ok_or(ErrorCode::NO_HANDLES_LEFT)?;
        let handle = FIRST_HANDLE + number as u8;
        let definition = Box::new([0; DEFINITION]);
        self.ports.push(NdiPort { handle, number, definition, written: false, initialised: false, enabled: false });
        self.ports.sort_by_key(|port| port.handle);
        Ok(format!("{handle:02X}"))
    }

    fn track(
        &mut self,
        form: ReplyForm,
        options: u16,
        unit_s: f64,
        fault: EmulatedFault,
        body: &mut dyn NdiBody,
    ) -> Result<UnitReply, ErrorCode> {
        if options & !(TRANSFORMS | OUTSIDE_TOO | STRAYS) != 0 || options & TRANSFORMS == 0 {
            return Err(ErrorCode::OUT_OF_RANGE);
        }
        let frame = self.frame_at(unit_s, fault);
        let frames = self.frames(frame, fault, body);
        Ok(match form {
            ReplyForm::Binary => {
                let mut reply = Vec::with_capacity(512);
                frames.write_block(options, &mut reply);
                UnitReply::Bytes(block_of(&reply))
            }
            ReplyForm::Text => {
                let mut reply = Vec::with_capacity(1024);
                frames.write_text(options, &mut reply);
                finish_line(&mut reply);
                UnitReply::Bytes(reply)
            }
        })
    }

    /// Returns the number of the frame at this time.
    fn frame_at(&mut self, unit_s: f64, fault: EmulatedFault) -> u64 {
        self.asked = self.asked.wrapping_add(1);
        let now_s = if fault == EmulatedFault::Freeze { *self.frozen_s.get_or_insert(unit_s) } else { unit_s };
        if fault != EmulatedFault::Freeze {
            self.frozen_s = None;
        }
        let frame = ((now_s - self.zero_s) * FRAME_HZ).max(0.0) as u64;
        // Every other reply contains an older frame.
        if fault == EmulatedFault::Reorder && self.asked % 2 == 1 { frame.saturating_sub(2) } else { frame }
    }

    /// Returns the tools at the time of a frame; the same frame always gives the same result.
    fn frames(&self, frame: u64, fault: EmulatedFault, body: &mut dyn NdiBody) -> TrackingReply {
        let at_s = self.zero_s + frame as f64 / FRAME_HZ;
        let mut system = body.system();
        if fault == EmulatedFault::DeviceFault {
            system.0 |= SystemStatus::EXCEPTION;
        }
        let mut frames = Vec::with_capacity(self.ports.len());
        for port in self.ports.iter().filter(|port| port.initialised) {
            let tracked = if port.enabled { body.tool(at_s, port.number) } else { TrackedTool::Disabled };
            let Some((sight, bits)) = sight_of(&tracked, fault) else { continue };
            let status = PortStatus(port.status() | bits);
            frames.push(HandleFrame { handle: port.handle, sight, status, frame: frame as u32 });
        }
        TrackingReply::new(&frames, system)
    }
}

/// Returns the wire form, with its status bits; `None` for a missing tool.
fn sight_of(tracked: &TrackedTool, fault: EmulatedFault) -> Option<(ToolVisibility, u32)> {
    match tracked {
        TrackedTool::Absent => None,
        TrackedTool::Disabled => Some((ToolVisibility::Disabled, 0)),
        TrackedTool::Missing { out_of_volume } => {
            Some((ToolVisibility::Missing, if *out_of_volume { PortStatus::OUT_OF_VOLUME } else { 0 }))
        }
        TrackedTool::Seen { c_from_tool, position_in_c_m, error_m, at_the_edge } => {
            let q = c_from_tool.quaternion();
            let bad = fault == EmulatedFault::NotANumber;
            // ASCII cannot express such a number; a quaternion of zeros is just as impossible.
            let quaternion = if bad { [f64::NAN; 4] } else { [q.w, q.i, q.j, q.k] };
            let translation_mm = (position_in_c_m * 1e3).into();
            let transform = Transform { quaternion, translation_mm, error_mm: error_m * 1e3 };
            Some((ToolVisibility::Valid(transform), if *at_the_edge { PortStatus::PARTLY_OUT } else { 0 }))
        }
    }
}

fn known(name: &str) -> Option<&'static str> {
    PARAMETERS.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

fn line(text: &str) -> Vec<u8> {
    let mut reply = text.as_bytes().to_vec();
    finish_line(&mut reply);
    reply
}
