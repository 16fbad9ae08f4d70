//! Prepares a connected unit for tracking: line speed, reset, freeing old handles, tool definitions, start (reference
//! 1.3).

use std::{path::PathBuf, time::Duration};

use super::{
    command::{Filter, NdiCommand, NdiPriority, OUTSIDE_TOO, ReplyForm, TRANSFORMS, WIRELESS},
    crc::read_hex,
    definition::NdiDefinition,
    session::{NdiFailure, NdiSession, NdiWire},
    settings::{NdiSettings, Replies},
    text::PortStatus,
    tracking::TrackingReply,
    version::{form_of, identity_of},
};
use crate::{
    DeviceError, DeviceIdentity, TRACKED_TOOLS,
    transport::{Serial, SerialSettings, Tcp},
};

/// Reply options used in every tracking command.
pub(super) const OPTIONS: u16 = TRANSFORMS | OUTSIDE_TOO;
/// Line speed after power-on and after a reset.
pub(super) const FIRST_BAUD: u32 = 9600;

/// Time for a reply, from the manufacturer's guide.
const QUICK: Duration = Duration::from_millis(500);
/// Time for the reply to a command that makes the unit work.
const SLOW: Duration = Duration::from_secs(5);
/// Wait after `INIT` and after a change of speed, as the guide requires.
const SETTLE: Duration = Duration::from_millis(100);
// A connection in the same network takes milliseconds; longer waits only delay the message that nothing answers.
const CONNECT: Duration = Duration::from_secs(2);
// Long enough for a break at the slowest line speed (9600 bit/s: a character takes 1 ms).
const BREAK: Duration = Duration::from_millis(250);

#[derive(Debug)]
pub(super) struct OpenTracker {
    pub(super) session: NdiSession,
    pub(super) identity: DeviceIdentity,
    pub(super) form: ReplyForm,
    pub(super) handles: [Option<u8>; TRACKED_TOOLS],
}

pub(super) fn open(settings: &NdiSettings) -> Result<OpenTracker, DeviceError> {
    settings.check()?;
    let key = |k: usize| format!("tools[{k}]");
    let load = |(k, path): (usize, &std::path::PathBuf)| NdiDefinition::load(&key(k), path);
    let definitions = settings.tools.iter().enumerate().map(load).collect::<Result<Vec<_>, _>>()?;
    check_distinct(&settings.tools, &definitions)?;
    let place = settings.place();
    let baud = settings.port.is_some().then_some(settings.baud);
    let session = match baud {
        None => over_network(&place),
        Some(baud) => over_line(&place, baud),
    }?;
    NdiOpening { session, place, baud }.start(settings, &definitions)
}

/// Refuses two tools with one definition: the unit could not tell their markers apart.
fn check_distinct(paths: &[PathBuf], definitions: &[NdiDefinition]) -> Result<(), DeviceError> {
    for (k, definition) in definitions.iter().enumerate() {
        if let Some(same) = definitions[..k].iter().position(|other| other == definition) {
            return Err(DeviceError::File {
                key: format!("tools[{k}]"),
                path: paths[k].display().to_string(),
                reason: format!("it is the same definition as tools[{same}], but each tool needs its own"),
            });
        }
    }
    Ok(())
}

fn over_network(place: &str) -> Result<NdiSession, DeviceError> {
    let mut session = NdiSession::new(NdiWire::Tcp(Tcp::open(place, SLOW.min(CONNECT))?));
    session.ask(&NdiCommand::Init, SLOW).map_err(|failure| trouble(place, None, "INIT", failure))?;
    std::thread::sleep(SETTLE);
    Ok(session)
}

/// Finds the line speed: the speed of the last session, the speed after power-on, or the speed after a reset by a
/// break.
fn over_line(place: &str, baud: u32) -> Result<NdiSession, DeviceError> {
    let line = Serial::open(&SerialSettings { port: place.to_owned(), baud })?;
    let mut session = NdiSession::new(NdiWire::Serial(line));
    let report = |command, failure| trouble(place, Some(baud), command, failure);
    // The line may still contain half a command or a reply from the last session, so the first attempt may fail.
    let mut found = false;
    for speed in [baud, FIRST_BAUD] {
        set_baud(&mut session, speed).map_err(|failure| report("INIT", failure))?;
        let mut answered = session.ask_again(&NdiCommand::Init, QUICK / 2);
        if answered.as_deref() == Ok("RESET") {
            // Bytes at a low speed look like a break to a unit at a higher speed.
            std::thread::sleep(SETTLE);
            answered = session.ask_again(&NdiCommand::Init, SLOW);
        }
        if answered == Err(NdiFailure::Gone) {
            return Err(report("INIT", NdiFailure::Gone));
        }
        if answered.is_ok_and(|answer| answer == "OKAY") {
            found = true;
            break;
        }
    }
    if !found {
        reset(&mut session).map_err(|failure| report("a reset", failure))?;
        session.ask_again(&NdiCommand::Init, SLOW).map_err(|failure| report("INIT", failure))?;
    }
    std::thread::sleep(SETTLE);
    session.ask(&NdiCommand::Comm { baud }, QUICK).map_err(|failure| report("COMM", failure))?;
    std::thread::sleep(SETTLE);
    set_baud(&mut session, baud).map_err(|failure| report("COMM", failure))?;
    Ok(session)
}

fn set_baud(session: &mut NdiSession, baud: u32) -> Result<(), NdiFailure> {
    match &mut session.wire {
        NdiWire::Serial(serial) => serial.set_baud(baud).map_err(|_| NdiFailure::Gone),
        NdiWire::Tcp(_) => Ok(()),
    }
}

/// Sends a break at the initial speed; the unit replies `RESET`.
fn reset(session: &mut NdiSession) -> Result<(), NdiFailure> {
    set_baud(session, FIRST_BAUD)?;
    session.drain()?;
    if let NdiWire::Serial(serial) = &mut session.wire {
        serial.send_break(BREAK).map_err(|_| NdiFailure::Gone)?;
    }
    session.wait(SLOW)?;
    std::thread::sleep(SETTLE);
    Ok(())
}

fn trouble(place: &str, baud: Option<u32>, command: &str, failure: NdiFailure) -> DeviceError {
    let place = place.to_owned();
    match (failure, baud) {
        (NdiFailure::Silent, _) => DeviceError::Silent { place },
        (NdiFailure::Garbled, Some(baud)) => DeviceError::WrongBaud { place, baud },
        (NdiFailure::Garbled, None) => DeviceError::WrongProduct {
            place,
            expected: "tracker with NDI's Combined API".to_owned(),
            found: "device with another protocol".to_owned(),
        },
        (NdiFailure::Gone, _) => DeviceError::Other { place, reason: "it closed the connection".to_owned() },
        (NdiFailure::Refused(code), _) => {
            DeviceError::Refused { place, command: command.to_owned(), answer: code.to_string() }
        }
    }
}

struct NdiOpening {
    session: NdiSession,
    place: String,
    baud: Option<u32>,
}

impl NdiOpening {
    fn start(mut self, settings: &NdiSettings, definitions: &[NdiDefinition]) -> Result<OpenTracker, DeviceError> {
        let identity = identity_of(&self.quick(&NdiCommand::Version(0))?);
        let form = match settings.replies {
            Replies::Auto => form_of(&identity.firmware),
            Replies::Text => ReplyForm::Text,
            Replies::Binary => ReplyForm::Binary,
        };
        for (handle, _) in self.handles(Filter::ToFree)? {
            self.quick(&NdiCommand::Free(handle))?;
        }
        let mut handles = [None; TRACKED_TOOLS];
        for (place, (definition, path)) in handles.iter_mut().zip(definitions.iter().zip(&settings.tools)) {
            let name = path.display().to_string();
            *place = Some(self.define(definition, &name)?);
        }
        if settings.wired {
            self.plugged(&mut handles)?;
        }
        for handle in handles.iter().flatten() {
            self.slow(&NdiCommand::Enable(*handle, NdiPriority::Dynamic), "PENA")?;
        }
        self.slow(&NdiCommand::Start { anew: false }, "TSTART")?;
        self.look()?;
        Ok(OpenTracker { session: self.session, identity, form, handles })
    }

    /// Reads the unit's status once, so that a fault is reported as such and not as a loss after every opening.
    fn look(&mut self) -> Result<(), DeviceError> {
        let answer = self.quick(&NdiCommand::Track(ReplyForm::Text, OPTIONS))?;
        let frames =
            TrackingReply::of_text(answer.as_bytes(), OPTIONS).map_err(|_| self.trouble("TX", NdiFailure::Garbled))?;
        if frames.system.faults() == 0 {
            return Ok(());
        }
        // Whether the unit stops or not, its fault is what the operator must know.
        self.session.ask(&NdiCommand::Stop, QUICK).ok();
        Err(DeviceError::DeviceFault {
            place: self.place.clone(),
            words: format!("{} (system status {:04X})", frames.system.words(), frames.system.0),
            cure: "Wait until the camera has reached its operating temperature, and check its cables; if this persists, restart it."
                .to_owned(),
        })
    }

    /// Requests a handle for one tool and loads its definition.
    fn define(&mut self, definition: &NdiDefinition, name: &str) -> Result<u8, DeviceError> {
        let answer = self.slow(&NdiCommand::Request(WIRELESS), "PHRQ")?;
        let handle = read_hex(answer.as_bytes()).filter(|_| answer.len() == 2);
        let handle = handle.ok_or_else(|| self.trouble("PHRQ", NdiFailure::Garbled))? as u8;
        for (address, data) in definition.chunks() {
            self.quick(&NdiCommand::Write { handle, address, data })?;
        }
        self.slow(&NdiCommand::Initialise(handle), &format!("PINIT for {name}"))?;
        Ok(handle)
    }

    /// Initialises tools that are plugged in. A tool can add further handles, so the unit is queried twice.
    fn plugged(&mut self, handles: &mut [Option<u8>; TRACKED_TOOLS]) -> Result<(), DeviceError> {
        for _ in 0..2 {
            for (handle, _) in self.handles(Filter::ToInitialise)? {
                self.slow(&NdiCommand::Initialise(handle), "PINIT")?;
                if let Some(free) = handles.iter_mut().find(|place| place.is_none()) {
                    *free = Some(handle);
                }
            }
        }
        Ok(())
    }

    /// Returns handles and their status.
    fn handles(&mut self, filter: Filter) -> Result<Vec<(u8, PortStatus)>, DeviceError> {
        let answer = self.quick(&NdiCommand::Handles(filter))?;
        handles_of(answer.as_bytes()).ok_or_else(|| self.trouble("PHSR", NdiFailure::Garbled))
    }

    fn quick(&mut self, command: &NdiCommand<'_>) -> Result<String, DeviceError> {
        self.session.ask_again(command, QUICK).map_err(|failure| self.trouble(command.name(), failure))
    }

    fn slow(&mut self, command: &NdiCommand<'_>, name: &str) -> Result<String, DeviceError> {
        self.session.ask(command, SLOW).map_err(|failure| self.trouble(name, failure))
    }

    fn trouble(&self, command: &str, failure: NdiFailure) -> DeviceError {
        trouble(&self.place, self.baud, command, failure)
    }
}

/// Parses `PHSR`: a count, then two digits for every handle and three for its status.
pub(super) fn handles_of(text: &[u8]) -> Option<Vec<(u8, PortStatus)>> {
    let (count, rest) = text.split_at_checked(2)?;
    let count = read_hex(count)? as usize;
    if rest.len() != count * 5 {
        return None;
    }
    let one = |entry: &[u8]| Some((read_hex(&entry[..2])? as u8, PortStatus(read_hex(&entry[2..])?)));
    rest.chunks(5).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn handles_and_their_status_are_read() {
        let handles = handles_of(b"020A0310B031").unwrap();
        assert_eq!(handles, [(0x0A, PortStatus(0x31)), (0x0B, PortStatus(0x31))]);
        assert_eq!(handles_of(b"00"), Some(Vec::new()));
        for bad in [&b""[..], b"0", b"01", b"010A03", b"010A0311", b"010AxYz"] {
            assert_eq!(handles_of(bad), None);
        }
    }
}
