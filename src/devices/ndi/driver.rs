//! The driver: requests a frame as soon as the last reply has arrived, with one command in progress at a time, and
//! never waits.
//!
//! Readings in m, camera frame `c`, orientation `c_from_tool`. A reading is new if its frame number is. Losses:
//! [`Loss::Silent`] if no new frame arrived for [`SILENT_S`] and no byte for the current command; [`Loss::Corrupt`] if
//! the received bytes are not a reply, or after [`DAMAGED_MAX`] consecutive damaged replies; [`Loss::Implausible`] for
//! numbers that are not finite or impossible; [`Loss::Device`] for fault bits of the unit (`0x10000 +` system status),
//! its errors (their code) and a restart ([`RESTARTED`]). Dropping the driver stops tracking and resets the line to its
//! initial speed.

use std::time::Duration;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{
    command::{NdiCommand, ReplyForm},
    crc::read_hex,
    opening::{self, FIRST_BAUD, OPTIONS, OpenTracker},
    reply::{ExpectedReply, NdiArrival},
    session::{NdiSession, NdiWire},
    settings::NdiSettings,
    text::{PortStatus, SystemStatus},
    tracking::{HandleFrame, ToolVisibility, TrackingReply, Transform},
};
use crate::{
    ConnectionState, Device, DeviceError, DeviceIdentity, Health, Loss, TRACKED_TOOLS, TimedReading, TrackedTool,
    TrackerReading, transport::ByteStream as _,
};

/// Time limit for a new frame, and for the reply to a command, s: six frames at 60 Hz.
pub const SILENT_S: f64 = 0.100;
/// Number of consecutive damaged replies after which the unit counts as lost, so that a disturbance on a serial line
/// does not end the tracking.
pub const DAMAGED_MAX: u32 = 5;
/// Code of [`Loss::Device`] for a unit that was switched off and on while tracking. Above [`SYSTEM_FAULT`] and all of
/// its bits, so that the codes stay distinct.
pub const RESTARTED: u32 = 0x2_0000;
/// Code of [`Loss::Device`] for fault bits of the unit, which are in the lower bits.
pub const SYSTEM_FAULT: u32 = 0x1_0000;
/// Interval between two commands, s: a quarter of the frame time of the fastest unit.
const PACE_S: f64 = 0.002;
/// Pause after a damaged reply, s: its remainder may still be arriving.
const QUIET_S: f64 = 0.010;
/// Maximum number of reads in one poll, so that a unit that sends without pause cannot hold up the loop.
const READS_MAX: usize = 16;
/// Maximum plausible distance, mm; the largest measurement volume ends at 3 m.
const FARTHEST_MM: f64 = 6_000.0;
/// Maximum plausible deviation of a quaternion's norm from 1; rounding to four decimals gives 0.0002.
const NORM_WITHIN: f64 = 0.01;

#[derive(Clone, Copy, Debug, PartialEq)]
enum PendingCommand {
    /// None; the next one may be sent at this time, s.
    Idle(f64),
    /// A command that was sent at this time, s.
    Asked { at_s: f64, beep: bool },
}

#[derive(Debug)]
pub struct NdiDriver {
    session: NdiSession,
    identity: DeviceIdentity,
    health: Health,
    form: ReplyForm,
    handles: [Option<u8>; TRACKED_TOOLS],
    frame_hz: f64,
    serial: bool,
    flight: PendingCommand,
    /// Time of arrival of the current reply's last byte, s; `None` before the first byte.
    received_s: Option<f64>,
    damaged_in_a_row: u32,
    /// Whether the reply to the current command was damaged.
    spoilt: bool,
    fresh_s: Option<f64>,
    frame: Option<u32>,
    frames_since_open: u64,
    beeps: u8,
    beeped: bool,
    system: SystemStatus,
    status: [PortStatus; TRACKED_TOOLS],
}

/// Meaning of one arrival, computed before the driver's state changes.
#[expect(clippy::large_enum_variant, reason = "made and used within one poll, where a box would be an allocation")]
enum ArrivalMeaning {
    Frames(TrackingReply),
    Answered,
    Damaged,
    Fault(u32),
}

impl NdiDriver {
    /// Opens, configures and starts the unit; may take some seconds.
    ///
    /// # Errors
    /// [`DeviceError`] if a setting is invalid, the unit cannot be reached or reports a fault, or a tool definition is not
    /// accepted.
    pub fn open(settings: &NdiSettings) -> Result<Self, DeviceError> {
        let OpenTracker { session, identity, form, handles } = opening::open(settings)?;
        let mut health = Health::opening();
        health.standing = ConnectionState::Connected;
        Ok(Self {
            session,
            identity,
            health,
            form,
            handles,
            frame_hz: settings.frame_hz,
            serial: settings.port.is_some(),
            flight: PendingCommand::Idle(f64::NEG_INFINITY),
            received_s: None,
            damaged_in_a_row: 0,
            spoilt: false,
            fresh_s: None,
            frame: None,
            frames_since_open: 0,
            beeps: 0,
            beeped: false,
            system: SystemStatus::default(),
            status: [PortStatus::default(); TRACKED_TOOLS],
        })
    }

    pub const fn form(&self) -> ReplyForm {
        self.form
    }

    /// Returns the status of the unit in the latest reply.
    pub const fn system_status(&self) -> SystemStatus {
        self.system
    }

    /// Returns the status of each tool in the latest reply; 0 without a tool.
    pub const fn port_status(&self) -> [PortStatus; TRACKED_TOOLS] {
        self.status
    }

    /// Makes the unit beep 1 to 9 times as soon as no other command is in progress; a frame is requested between two
    /// beeps.
    pub fn beep(&mut self, times: u8) {
        self.beeps = times.min(9);
    }

    fn expected(&self) -> ExpectedReply {
        match (self.flight, self.form) {
            (PendingCommand::Asked { beep: false, .. } | PendingCommand::Idle(_), ReplyForm::Binary) => {
                ExpectedReply::Block
            }
            _ => ExpectedReply::Line,
        }
    }

    fn event_of(arrival: NdiArrival<'_>, beep: bool) -> ArrivalMeaning {
        let frames = match arrival {
            NdiArrival::Damaged => return ArrivalMeaning::Damaged,
            // Sent without a request after power-on: the tools are no longer initialised, so tracking cannot continue.
            NdiArrival::Line(line) if line == b"RESET" => return ArrivalMeaning::Fault(RESTARTED),
            NdiArrival::Line(line) if line.starts_with(b"ERROR") => {
                return read_hex(&line[5..]).map_or(ArrivalMeaning::Damaged, ArrivalMeaning::Fault);
            }
            NdiArrival::Line(_) if beep => return ArrivalMeaning::Answered,
            NdiArrival::Line(line) => TrackingReply::of_text(line, OPTIONS),
            NdiArrival::Block(body) => TrackingReply::of_block(body, OPTIONS),
        };
        frames.map_or(ArrivalMeaning::Damaged, ArrivalMeaning::Frames)
    }

    fn receive(&mut self, now_s: f64) -> Result<Option<TrackerReading>, Loss> {
        let mut newest = None;
        for _ in 0..READS_MAX {
            let count = self.session.wire.receive(self.session.inbox.room())?;
            if count == 0 {
                break;
            }
            self.session.inbox.filled(count);
            self.received_s = Some(now_s);
            while let Some(arrival) = self.session.inbox.next(self.expected()) {
                let PendingCommand::Asked { at_s, beep } = self.flight else {
                    // A reply without a command.
                    self.health.out_of_order += 1;
                    continue;
                };
                match Self::event_of(arrival, beep) {
                    ArrivalMeaning::Frames(frames) => {
                        self.answered(at_s);
                        newest = self.take(&frames, now_s)?.or(newest);
                    }
                    ArrivalMeaning::Answered => self.answered(at_s),
                    ArrivalMeaning::Damaged => self.damaged()?,
                    ArrivalMeaning::Fault(code) => return Err(Loss::Device { code }),
                }
            }
            self.health.skipped_bytes += self.session.inbox.take_skipped();
        }
        Ok(newest)
    }

    fn answered(&mut self, asked_s: f64) {
        self.flight = PendingCommand::Idle(asked_s + PACE_S);
        self.damaged_in_a_row = 0;
        self.spoilt = false;
    }

    fn damaged(&mut self) -> Result<(), Loss> {
        self.health.damaged += 1;
        self.spoilt = true;
        self.damaged_in_a_row += 1;
        if self.damaged_in_a_row >= DAMAGED_MAX { Err(Loss::Corrupt) } else { Ok(()) }
    }

    /// Handles a complete reply: status, faults, and a reading if its frame is new.
    fn take(&mut self, frames: &TrackingReply, now_s: f64) -> Result<Option<TrackerReading>, Loss> {
        self.system = frames.system;
        let faults = frames.system.faults();
        if faults != 0 {
            self.health.refused += 1;
            return Err(Loss::Device { code: SYSTEM_FAULT + u32::from(faults) });
        }
        if self.handles == [None; TRACKED_TOOLS] {
            // The unit works, but there is nothing to track yet. A new tool is prepared when the unit is opened again.
            self.fresh_s = Some(now_s);
            return if frames.system.0 & SystemStatus::TOOL_CAME == 0 { Ok(None) } else { Err(Loss::Silent) };
        }
        let mut reading = TrackerReading::default();
        let mut newest: Option<u32> = None;
        for (k, handle) in self.handles.iter().enumerate() {
            let Some(handle) = handle else { continue };
            let report = frames.handles().iter().find(|report| report.handle == *handle);
            self.status[k] = report.map_or(PortStatus(0), |report| report.status);
            reading.tools[k] = match report {
                None => TrackedTool::Disabled,
                Some(report) => tracked(report).ok_or_else(|| {
                    self.health.refused += 1;
                    Loss::Implausible
                })?,
            };
            if let Some(report) = report.filter(|report| report.sight != ToolVisibility::Disabled) {
                let later = newest.is_none_or(|frame| report.frame.wrapping_sub(frame).cast_signed() > 0);
                newest = if later { Some(report.frame) } else { newest };
            }
        }
        let Some(frame) = newest.filter(|frame| self.is_new(*frame, now_s)) else { return Ok(None) };
        reading.frame = frame;
        Ok(Some(reading))
    }

    /// Counts a frame; returns true if it is later than the last one.
    fn is_new(&mut self, frame: u32, now_s: f64) -> bool {
        // The signed difference, because the counter wraps around.
        let ahead = self.frame.map_or(1, |last| frame.wrapping_sub(last).cast_signed());
        if ahead <= 0 {
            self.health.out_of_order += u64::from(ahead < 0);
            return false;
        }
        // The first number counts the frames before this session, which belong to the unit's clock.
        let since = if self.frame.is_some() { u64::from(ahead.unsigned_abs()) } else { u64::from(frame) };
        self.frames_since_open += since;
        self.health.lost += u64::from(ahead.unsigned_abs()) - 1;
        self.frame = Some(frame);
        self.fresh_s = Some(now_s);
        self.health.accept(now_s);
        true
    }

    fn watch(&mut self, now_s: f64) -> Result<(), Loss> {
        if let PendingCommand::Asked { at_s, .. } = self.flight {
            if now_s - at_s >= SILENT_S {
                return Err(if self.received_s.is_some() { Loss::Corrupt } else { Loss::Silent });
            }
            // Only after the line is quiet: the rest of a damaged reply would be read as the answer to the next
            // command.
            if self.spoilt && self.received_s.is_none_or(|received_s| now_s - received_s >= QUIET_S) {
                self.session.inbox.clear();
                self.spoilt = false;
                self.flight = PendingCommand::Idle(now_s);
            }
        }
        if now_s - *self.fresh_s.get_or_insert(now_s) >= SILENT_S { Err(Loss::Silent) } else { Ok(()) }
    }

    fn ask(&mut self, now_s: f64) -> Result<(), Loss> {
        let PendingCommand::Idle(due_s) = self.flight else { return Ok(()) };
        if now_s < due_s {
            return Ok(());
        }
        // Never two in a row, because the readings would pause for longer than the loop accepts.
        let beep = self.beeps > 0 && !self.beeped;
        self.beeped = beep;
        let command = if beep { NdiCommand::Beep(self.beeps) } else { NdiCommand::Track(self.form, OPTIONS) };
        if beep {
            self.beeps = 0;
        }
        self.session.inbox.clear();
        self.received_s = None;
        self.session.wire.send(command.encode().as_bytes())?;
        self.flight = PendingCommand::Asked { at_s: now_s, beep };
        Ok(())
    }
}

impl Device for NdiDriver {
    type Reading = TrackerReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<TrackerReading>> {
        if matches!(self.health.standing, ConnectionState::Lost(_)) {
            return None;
        }
        let taken = self.receive(now_s).and_then(|reading| {
            self.watch(now_s)?;
            self.ask(now_s)?;
            Ok(reading)
        });
        match taken {
            Ok(reading) => reading.map(|value| TimedReading {
                device_s: Some(self.frames_since_open as f64 / self.frame_hz),
                arrival_s: now_s,
                value,
            }),
            Err(loss) => {
                // An unplugged serial adapter looks the same as a silent line.
                let gone = loss == Loss::Silent && self.session.wire.is_gone();
                self.health.lose(if gone { Loss::Disconnected } else { loss });
                None
            }
        }
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.health, &self.identity)
    }
}

impl Drop for NdiDriver {
    /// Waits for the current reply to pass, stops tracking, and resets the line to its initial speed for the next
    /// session.
    fn drop(&mut self) {
        // A reply at 60 Hz takes at most 17 ms; the program must still end promptly if the unit is gone.
        const TIMEOUT: Duration = Duration::from_millis(100);
        // Without a line every command would only wait for its timeout.
        if self.health.standing == ConnectionState::Lost(Loss::Disconnected) {
            return;
        }
        if matches!(self.flight, PendingCommand::Asked { .. }) {
            self.session.let_pass(TIMEOUT / 2);
        }
        // Sent even if the unit no longer answers.
        self.session.ask(&NdiCommand::Stop, TIMEOUT).ok();
        let first = NdiCommand::Comm { baud: FIRST_BAUD };
        if self.serial
            && self.session.ask(&first, TIMEOUT).is_ok()
            && let NdiWire::Serial(serial) = &mut self.session.wire
        {
            serial.set_baud(FIRST_BAUD).ok();
        }
    }
}

/// Converts a handle to SI units; returns `None` for impossible numbers.
fn tracked(report: &HandleFrame) -> Option<TrackedTool> {
    let out_of_volume = report.status.has(PortStatus::OUT_OF_VOLUME);
    match report.sight {
        ToolVisibility::Missing => Some(TrackedTool::Missing { out_of_volume }),
        ToolVisibility::Disabled => Some(TrackedTool::Disabled),
        ToolVisibility::Valid(at) => {
            let seen = seen(&at, report.status.has(PortStatus::PARTLY_OUT))?;
            // Outside the volume the accuracy is not specified, so the numbers are not used.
            Some(if out_of_volume { TrackedTool::Missing { out_of_volume } } else { seen })
        }
    }
}

fn seen(at: &Transform, at_the_edge: bool) -> Option<TrackedTool> {
    let [w, i, j, k] = at.quaternion;
    let quaternion = Quaternion::new(w, i, j, k);
    let norm_off = (quaternion.norm() - 1.0).abs();
    let position_mm = Vector3::from(at.translation_mm);
    let plausible = norm_off <= NORM_WITHIN && position_mm.norm() <= FARTHEST_MM && at.error_mm.is_finite();
    plausible.then(|| TrackedTool::Seen {
        c_from_tool: UnitQuaternion::new_normalize(quaternion),
        position_in_c_m: position_mm * 1e-3,
        error_m: at.error_mm * 1e-3,
        at_the_edge,
    })
}
