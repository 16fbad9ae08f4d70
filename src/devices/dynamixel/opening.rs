//! Finds and configures four servos on an open serial line, with the torque off. Blocks and allocates; runs on the
//! thread that opens the device.
//!
//! Waits 0.1 s for every answer, up to three times. The EEPROM, which wears out, is read first and
//! written only where it differs. Every written value is read back.

use std::{
    ops::Range,
    time::{Duration, Instant},
};

use super::{
    codec::{self, BROADCAST, IncomingPackets, OutgoingPackets, Packet, STATUS},
    driver::MOTION_BYTES,
    message::{Instruction, ServoRefusal},
    reboots::Reboots,
    settings::{DynamixelSettings, RegisterGoal, ServoSettings, ids_text},
    table::{self, DynamixelRegister, HardwareError, ServoFault, ServoModel},
};
use crate::{DeviceError, DeviceIdentity, SERVOS, transport::ByteStream};

/// Time limit for an answer, s: much longer than a servo takes, to allow for a busy computer.
pub(super) const ANSWER_S: f64 = 0.1;
/// Number of attempts.
const TRIES: usize = 3;

/// Maximum number of reads to discard old bytes, so that a line that sends without pause cannot hold up the opening.
pub(super) const REST_READS: usize = 64;
/// Time for a servo to answer again after a reboot, s.
const REBOOT_S: f64 = 2.0;
/// Longest packet while opening: the whole EEPROM, stuffed.
const LONGEST: usize = 256;

/// Clock for waiting: the system's, or a simulated one in tests.
pub trait WaitClock {
    /// Returns the current time, s; the origin is arbitrary.
    fn now_s(&self) -> f64;
    fn nap(&mut self);
}

#[derive(Debug)]
pub(super) struct SystemClock(pub(super) Instant);

impl WaitClock for SystemClock {
    fn now_s(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }

    fn nap(&mut self) {
        std::thread::sleep(Duration::from_micros(100));
    }
}

#[derive(Debug)]
pub(super) struct ServoProperties {
    pub(super) models: [&'static ServoModel; SERVOS],
    pub(super) identity: DeviceIdentity,
    pub(super) fast: bool,
}

pub(super) struct DynamixelSession<'a, T, P> {
    line: &'a mut T,
    pace: &'a mut P,
    place: &'a str,
    incoming: IncomingPackets,
    outgoing: OutgoingPackets,
    /// The newest bytes, and the part of them that has not been decoded: one read may contain several packets.
    arrived: [u8; LONGEST],
    undecoded: Range<usize>,
    received: usize,
}

struct DynamixelAnswer {
    error: u8,
    data: Vec<u8>,
}

impl<'a, T: ByteStream, P: WaitClock> DynamixelSession<'a, T, P> {
    pub(super) fn new(line: &'a mut T, pace: &'a mut P, place: &'a str) -> Self {
        let incoming = IncomingPackets::new(LONGEST);
        let outgoing = OutgoingPackets::new(LONGEST);
        let arrived = [0; LONGEST];
        Self { line, pace, place, incoming, outgoing, arrived, undecoded: 0..0, received: 0 }
    }

    pub(super) const fn received_anything(&self) -> bool {
        self.received > 0
    }

    /// Finds the servos and configures them according to `settings`.
    pub(super) fn configure(
        &mut self,
        settings: &DynamixelSettings,
        reboots: &Reboots,
    ) -> Result<ServoProperties, DeviceError> {
        let firmware = self.find(settings)?;
        let mut models = [&table::MODELS[0]; SERVOS];
        for (index, servo) in settings.servos.iter().enumerate() {
            if reboots.take(index) {
                self.reboot(servo.id)?;
            }
            models[index] = self.model_of(servo)?;
            self.check_fault(servo.id)?;
            self.prepare(servo, models[index])?;
        }
        let fast = settings.fast_sync_read && self.answers_fast(settings)?;
        let list = |words: Vec<String>| words.join(" ");
        let identity = DeviceIdentity {
            product: list(models.iter().map(|model| model.name.to_owned()).collect()),
            serial: settings.ids_text(),
            firmware: list(firmware.iter().map(u8::to_string).collect()),
        };
        Ok(ServoProperties { models, identity, fast })
    }

    /// Pings all servos; returns the firmware version of each.
    fn find(&mut self, settings: &DynamixelSettings) -> Result<[u8; SERVOS], DeviceError> {
        let mut firmware = [None; SERVOS];
        for (servo, version) in settings.servos.iter().zip(&mut firmware) {
            *version = self.ask(servo.id, &Instruction::Ping)?.and_then(|answer| answer.data.get(2).copied());
        }
        if firmware == [None; SERVOS] {
            let place = self.place.to_owned();
            // A wrong id in the settings is the usual cause, and the ids that do answer are its remedy.
            let others = self.everybody()?;
            if others.is_empty() {
                return Err(DeviceError::Silent { place });
            }
            // Servos identify themselves only by their ids.
            let found = ids_text(others.into_iter().map(|(id, _)| id));
            return Err(DeviceError::OtherSerial { place, expected: settings.ids_text(), found });
        }
        let missing = firmware.iter().position(Option::is_none);
        if let Some(index) = missing {
            return Err(DeviceError::Absent { place: self.name(settings.servos[index].id) });
        }
        Ok(firmware.map(Option::unwrap_or_default))
    }

    fn model_of(&mut self, servo: &ServoSettings) -> Result<&'static ServoModel, DeviceError> {
        let number = self.read(servo.id, table::MODEL)? as u16;
        let Some(model) = ServoModel::numbered(number) else {
            return Err(table::unsupported(self.name(servo.id), number));
        };
        match &servo.model {
            Some(name) if name != model.name => {
                let place = self.name(servo.id);
                return Err(DeviceError::WrongProduct { place, expected: name.clone(), found: model.name.to_owned() });
            }
            _ => {}
        }
        servo.check_current(model)?;
        Ok(model)
    }

    fn check_fault(&mut self, id: u8) -> Result<(), DeviceError> {
        let error = HardwareError(self.read(id, table::HARDWARE_ERROR)? as u8);
        if !error.is_any() {
            return Ok(());
        }
        Err(DeviceError::DeviceFault {
            place: self.place.to_owned(),
            words: ServoFault { id, error }.to_string(),
            cure: format!("Remove the cause, then restart servo {id} by command."),
        })
    }

    /// Switches torque and watchdog off, then writes all settings.
    fn prepare(&mut self, servo: &ServoSettings, model: &ServoModel) -> Result<(), DeviceError> {
        let id = servo.id;
        // A servo whose status return level is below 2 does not answer this write either. Therefore not by `write`,
        // which would fail without an answer.
        let level = [2];
        self.ask(id, &Instruction::Write { address: table::STATUS_RETURN_LEVEL.address, data: &level })?;
        // The EEPROM is locked while the torque is on (ROBOTIS e-manual, "Control table").
        self.write(id, (table::TORQUE_ENABLE, 0))?;
        self.write(id, (table::BUS_WATCHDOG, 0))?;
        let drive_mode = self.read(id, table::DRIVE_MODE)? as u8;
        for wanted in servo.eeprom(model, drive_mode) {
            if self.read(id, wanted.0)? != wanted.1 {
                self.write(id, wanted)?;
            }
        }
        for wanted in servo.ram(model) {
            self.write(id, wanted)?;
        }
        Ok(())
    }

    /// Restarts the servo and waits until it answers again.
    fn reboot(&mut self, id: u8) -> Result<(), DeviceError> {
        self.send(id, &Instruction::Reboot)?;
        let begin_s = self.pace.now_s();
        // The servo is silent while it restarts, so the first answer to a ping shows that it is back.
        while self.pace.now_s() - begin_s < REBOOT_S {
            self.wait(ANSWER_S);
            if self.once(id, &Instruction::Ping)?.is_some() {
                return Ok(());
            }
        }
        Err(DeviceError::Absent { place: self.name(id) })
    }

    /// Returns whether the firmware of all servos supports the fast sync read.
    fn answers_fast(&mut self, settings: &DynamixelSettings) -> Result<bool, DeviceError> {
        let ids = settings.servos.each_ref().map(|servo| servo.id);
        let address = table::TICK.address;
        let count = MOTION_BYTES as u16;
        for _ in 0..TRIES {
            self.send(BROADCAST, &Instruction::SyncRead { address, count, ids: &ids, fast: true })?;
            let whole = |packet: &Packet<'_>| packet.id == BROADCAST && packet.instruction == STATUS;
            let answer = self.receive(whole)?;
            let all = answer.is_some_and(|answer| {
                let body: Vec<u8> = std::iter::once(answer.error).chain(answer.data).collect();
                codec::blocks(&body, MOTION_BYTES).is_some_and(|blocks| blocks.map(|block| block.id).eq(ids))
            });
            if all {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn read(&mut self, id: u8, register: DynamixelRegister) -> Result<u32, DeviceError> {
        let DynamixelRegister { address, bytes } = register;
        let command = || format!("reading register {address}");
        let answer = self.ask(id, &Instruction::Read { address, count: bytes })?;
        let answer = answer.ok_or_else(|| self.refused(id, command(), "no answer".to_owned()))?;
        self.accept(id, &answer, command)?;
        if answer.data.len() != usize::from(bytes) {
            return Err(self.refused(id, command(), format!("{} bytes", answer.data.len())));
        }
        Ok(answer.data.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte)))
    }

    fn write(&mut self, id: u8, (register, value): RegisterGoal) -> Result<(), DeviceError> {
        let command = || format!("{value} in register {}", register.address);
        let bytes = value.to_le_bytes();
        let write = Instruction::Write { address: register.address, data: &bytes[..usize::from(register.bytes)] };
        let answer = self.ask(id, &write)?.ok_or_else(|| self.refused(id, command(), "no answer".to_owned()))?;
        self.accept(id, &answer, command)?;
        // An answer without an error does not prove that the value was stored.
        let kept = self.read(id, register)?;
        if kept == value { Ok(()) } else { Err(self.refused(id, command(), format!("it remains {kept}"))) }
    }

    fn accept(&self, id: u8, answer: &DynamixelAnswer, command: impl Fn() -> String) -> Result<(), DeviceError> {
        match ServoRefusal::of(answer.error) {
            Ok(None) => Ok(()),
            Ok(Some(refusal)) => Err(self.refused(id, command(), refusal.words().to_owned())),
            Err(code) => Err(self.refused(id, command(), format!("error {code:#04x}"))),
        }
    }

    fn refused(&self, id: u8, command: String, answer: String) -> DeviceError {
        DeviceError::Refused { place: self.name(id), command, answer }
    }

    fn name(&self, id: u8) -> String {
        format!("servo {id} on {}", self.place)
    }

    /// Sends the instruction several times until there is an answer.
    fn ask(&mut self, id: u8, instruction: &Instruction<'_>) -> Result<Option<DynamixelAnswer>, DeviceError> {
        for _ in 0..TRIES {
            let answer = self.once(id, instruction)?;
            if answer.is_some() {
                return Ok(answer);
            }
        }
        Ok(None)
    }

    fn once(&mut self, id: u8, instruction: &Instruction<'_>) -> Result<Option<DynamixelAnswer>, DeviceError> {
        self.send(id, instruction)?;
        self.receive(|packet| packet.instruction == STATUS && (packet.id == id || id == BROADCAST))
    }

    /// Returns whether any servo answers a broadcast ping.
    pub(super) fn anybody(&mut self) -> Result<bool, DeviceError> {
        Ok(self.once(BROADCAST, &Instruction::Ping)?.is_some())
    }

    /// Returns id and model number of all servos that answer a broadcast ping.
    pub(super) fn everybody(&mut self) -> Result<Vec<(u8, u16)>, DeviceError> {
        let mut servos: Vec<(u8, u16)> = Vec::new();
        self.send(BROADCAST, &Instruction::Ping)?;
        loop {
            let mut id = 0;
            let answer = self.receive(|packet| {
                id = packet.id;
                packet.instruction == STATUS
            })?;
            let Some(answer) = answer else { return Ok(servos) };
            let number = answer.data.first_chunk().map_or(0, |bytes| u16::from_le_bytes(*bytes));
            // More answers than there are ids: a line that repeats itself must not fill the memory.
            if servos.len() > usize::from(BROADCAST) {
                return Ok(servos);
            }
            servos.push((id, number));
        }
    }

    /// Returns the shortest time in which a servo answers a ping, s: of several, because the computer may pause.
    pub(super) fn answer_time_s(&mut self, id: u8) -> Result<Option<f64>, DeviceError> {
        let mut shortest_s = None;
        for _ in 0..TRIES {
            let begin_s = self.pace.now_s();
            self.send(id, &Instruction::Ping)?;
            if self.receive(|packet| packet.id == id && packet.instruction == STATUS)?.is_some() {
                let took_s = self.pace.now_s() - begin_s;
                shortest_s = Some(shortest_s.map_or(took_s, |shortest_s: f64| shortest_s.min(took_s)));
            }
        }
        Ok(shortest_s)
    }

    fn send(&mut self, id: u8, instruction: &Instruction<'_>) -> Result<(), DeviceError> {
        // Pending bytes are from earlier instructions.
        let mut rest = [0; LONGEST];
        for _ in 0..REST_READS {
            if self.line.receive(&mut rest).map_err(|_| self.gone())? == 0 {
                break;
            }
        }
        self.incoming.reset();
        self.undecoded = 0..0;
        self.outgoing.clear();
        instruction.encode(id, &mut self.outgoing);
        self.line.send(self.outgoing.bytes()).map_err(|_| self.gone())
    }

    fn receive(&mut self, mut fits: impl FnMut(&Packet<'_>) -> bool) -> Result<Option<DynamixelAnswer>, DeviceError> {
        let begin_s = self.pace.now_s();
        loop {
            if let Some(answer) = self.decoded(&mut fits) {
                return Ok(Some(answer));
            }
            if self.pace.now_s() - begin_s > ANSWER_S {
                return Ok(None);
            }
            let count = self.line.receive(&mut self.arrived).map_err(|_| self.gone())?;
            self.received += count;
            self.undecoded = 0..count;
            if count == 0 {
                self.pace.nap();
            }
        }
    }

    /// Returns the next fitting packet among the bytes that have arrived.
    fn decoded(&mut self, fits: &mut impl FnMut(&Packet<'_>) -> bool) -> Option<DynamixelAnswer> {
        loop {
            while let Some(packet) = self.incoming.next() {
                if let Some((error, data)) = packet.body.split_first().filter(|_| fits(&packet)) {
                    return Some(DynamixelAnswer { error: *error, data: data.to_vec() });
                }
            }
            if self.undecoded.is_empty() {
                return None;
            }
            self.undecoded.start += self.incoming.feed(&self.arrived[self.undecoded.clone()]);
        }
    }

    fn wait(&mut self, length_s: f64) {
        let begin_s = self.pace.now_s();
        while self.pace.now_s() - begin_s < length_s {
            self.pace.nap();
        }
    }

    fn gone(&self) -> DeviceError {
        DeviceError::Other { place: self.place.to_owned(), reason: "the connection was lost".to_owned() }
    }
}
