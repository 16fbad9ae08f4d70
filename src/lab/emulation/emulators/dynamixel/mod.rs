//! Emulated servos on one bus: every instruction of Protocol 2.0, at the baud rate of the bus.
//!
//! [`Bus::receive`] takes data of a client, [`Bus::send`] returns the data to send by now. The forces on the shafts
//! come from a closure, [`DynamixelBody`], called at every instruction and every millisecond between them; the same call passes
//! it the effects of commands.
//!
//! Inferred, because the e-manual does not say: servos after a missing one do not answer a sync read; a failed part of
//! a fast read returns zeros with its error.

mod motor;
mod registers;
mod servo;
pub(super) mod standalone;
#[cfg(test)]
mod tests;
mod wire;

use std::{collections::VecDeque, io, path::PathBuf};

use nima_devices::dynamixel::{
    codec::{BROADCAST, IncomingPackets, OutgoingPackets, STATUS},
    message::{self, Instruction, Keep, ServoRefusal},
    table::{self, BAUDS, HardwareError, ServoModel},
};
use servo::EmulatedServo;

use crate::emulators::{EmulatedFault, Emulator};

/// Maximum instruction that an emulated servo accepts, bytes.
const LONGEST: usize = 2048;
/// Interval between updates of the world while no instruction arrives, s.
const ADVANCE_S: f64 = 0.001;
/// A packet that pauses for longer is discarded, s. Otherwise the beginning of a packet that was cut off would swallow
/// the next one.
const PAUSE_S: f64 = 0.050;

/// A servo's shaft as seen by the world: before offset and sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoShaft {
    pub angle_rad: f64,
    pub velocity_rad_s: f64,
    /// Whether the motor is driven; otherwise only the load moves it.
    pub torque_on: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoSurroundings {
    /// Torque on the shaft, Nm.
    pub load_nm: f64,
    /// Supply, V.
    pub supply_v: f64,
    /// Temperature of the housing, degrees Celsius.
    pub temperature_c: f64,
}

/// The world: called with the time, s, the index of the servo, and the state of its shaft.
pub type DynamixelBody = Box<dyn FnMut(f64, usize, &ServoShaft) -> ServoSurroundings + Send>;

#[derive(Clone, Debug)]
pub struct EmulatedDynamixel {
    /// Ids on the bus.
    pub ids: Vec<u8>,
    pub model: u16,
    /// Baud rate, bit/s.
    pub baud: u32,
    /// Whether the firmware supports the fast reads.
    pub fast: bool,
    /// The name of its port; by default in its own folder.
    pub link: Option<PathBuf>,
}

impl Default for EmulatedDynamixel {
    fn default() -> Self {
        Self { ids: vec![1, 2, 3, 4], model: 1020, baud: 1_000_000, fast: true, link: None }
    }
}

impl EmulatedDynamixel {
    /// Starts the servos on a bus; if no simulated body moves them, the shafts sway slowly.
    ///
    /// # Errors
    /// If the model or the baud rate does not exist.
    pub fn with(&self, body: Option<DynamixelBody>) -> io::Result<Box<dyn Emulator>> {
        Ok(Box::new(Bus::new(self, body)?))
    }
}

pub struct Bus {
    servos: Vec<EmulatedServo>,
    body: DynamixelBody,
    fast: bool,
    incoming: IncomingPackets,
    out: OutgoingPackets,
    queue: VecDeque<(f64, Vec<u8>)>,
    link: Option<PathBuf>,
    received_s: f64,
    advanced_s: f64,
    free_s: f64,
    fault: EmulatedFault,
}

impl std::fmt::Debug for Bus {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bus").field("servos", &self.servos.len()).finish_non_exhaustive()
    }
}

/// Returns a default body: a soft hand sways the shafts slowly, which resist once the torque is on.
pub fn swaying(supply_v: f64) -> DynamixelBody {
    Box::new(move |now_s, index, shaft| {
        let there_rad = 0.4 * (0.6 * now_s + index as f64).sin();
        let load_nm = if shaft.torque_on { 0.05 } else { 0.5 } * (there_rad - shaft.angle_rad).clamp(-1.0, 1.0);
        ServoSurroundings { load_nm, supply_v, temperature_c: 31.0 }
    })
}

impl Bus {
    /// Creates servos as new from the factory, except for ids and baud rate. Without a body the shafts sway slowly.
    ///
    /// # Errors
    /// If the model or the baud rate does not exist.
    pub fn new(settings: &EmulatedDynamixel, body: Option<DynamixelBody>) -> io::Result<Self> {
        let baud = BAUDS.iter().position(|baud| *baud == settings.baud);
        let (Some(model), Some(baud)) = (ServoModel::numbered(settings.model), baud) else {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "no servo has this model number and line speed"));
        };
        let supply_v = if model.is_small() { 5.0 } else { 12.0 };
        Ok(Self {
            servos: settings.ids.iter().map(|id| EmulatedServo::new(model, *id, baud as u8)).collect(),
            body: body.unwrap_or_else(|| swaying(supply_v)),
            fast: settings.fast,
            incoming: IncomingPackets::new(LONGEST),
            out: OutgoingPackets::new(LONGEST),
            queue: VecDeque::new(),
            link: settings.link.clone(),
            received_s: 0.0,
            advanced_s: f64::NEG_INFINITY,
            free_s: 0.0,
            fault: EmulatedFault::None,
        })
    }

    /// Returns the current baud rate of the servos, bit/s.
    pub fn baud(&self) -> u32 {
        let code = self.servos.first().map_or(1, |servo| servo.get(table::BAUD));
        BAUDS[code as usize % BAUDS.len()]
    }

    /// Latches a hardware error of a servo, as a fault in the world would.
    pub fn fail(&mut self, index: usize, error: HardwareError) {
        if let Some(servo) = self.servos.get_mut(index) {
            servo.fail(error);
        }
    }

    pub fn shaft(&self, index: usize) -> Option<ServoShaft> {
        self.servos.get(index).map(EmulatedServo::shaft)
    }

    /// Interrupts a servo's power for a moment; the servo then restarts.
    pub fn interrupt(&mut self, index: usize, now_s: f64) {
        if let Some(servo) = self.servos.get_mut(index) {
            servo.reboot(now_s);
        }
    }

    /// Processes data of a client at `now_s`.
    pub fn receive(&mut self, now_s: f64, bytes: &[u8]) {
        if self.incoming.is_midway() && now_s - self.received_s > PAUSE_S {
            self.incoming.reset();
        }
        self.received_s = now_s;
        let mut taken = 0;
        while taken < bytes.len() {
            taken += self.incoming.feed(&bytes[taken..]);
            while let Some(packet) = self.incoming.next() {
                if packet.instruction == STATUS {
                    continue;
                }
                let id = packet.id;
                let instruction = packet.instruction;
                let wire_bytes = packet.wire_bytes;
                let body = packet.body.to_vec();
                self.advance(now_s);
                // The response starts after the request and after any data still being sent.
                self.free_s = self.free_s.max(now_s) + wire_bytes as f64 * 10.0 / f64::from(self.baud());
                self.obey(id, instruction, &body, now_s);
            }
        }
    }

    /// Sends the data due by `now_s`, changed by `fault` if that is a fault of the content.
    pub fn send(&mut self, now_s: f64, fault: EmulatedFault, send: &mut dyn FnMut(&[u8])) {
        if fault == EmulatedFault::DeviceFault && self.fault != fault {
            self.fail(0, HardwareError(HardwareError::OVERLOAD));
        }
        self.fault = fault;
        for servo in &mut self.servos {
            servo.frozen = fault == EmulatedFault::Freeze;
            servo.impossible = fault == EmulatedFault::NotANumber;
        }
        if now_s - self.advanced_s >= ADVANCE_S {
            self.advance(now_s);
        }
        while self.queue.front().is_some_and(|(due_s, _)| *due_s <= now_s) {
            let Some((_, mut frame)) = self.queue.pop_front() else { break };
            match fault {
                EmulatedFault::BadChecksum => frame.iter_mut().rev().take(1).for_each(|byte| *byte ^= 0x55),
                EmulatedFault::WrongFrame => {
                    self.out.clear();
                    message::encode_status(frame[4], 0, &[1, 2, 3], &mut self.out);
                    frame = self.out.bytes().to_vec();
                }
                _ => {}
            }
            send(&frame);
        }
    }

    pub fn next_s(&self) -> Option<f64> {
        self.queue.front().map(|(due_s, _)| *due_s)
    }

    fn advance(&mut self, now_s: f64) {
        self.advanced_s = now_s;
        for (index, servo) in self.servos.iter_mut().enumerate() {
            let around = (self.body)(now_s, index, &servo.shaft());
            servo.advance(now_s, &around);
        }
    }

    fn obey(&mut self, id: u8, instruction: u8, body: &[u8], now_s: f64) {
        for servo in &mut self.servos {
            servo.receive(now_s);
        }
        let instruction = Instruction::decode(instruction, body);
        match instruction {
            Ok(Instruction::SyncRead { fast: true, .. } | Instruction::BulkRead { fast: true, .. }) if !self.fast => {}
            Ok(Instruction::SyncRead { address, count, ids, fast }) => {
                let asked: Vec<_> = ids.iter().map(|id| (*id, address, count)).collect();
                self.read_many(&asked, fast, now_s);
            }
            Ok(Instruction::BulkRead { items, fast }) => {
                let asked: Vec<_> = message::bulk_reads(items).collect();
                self.read_many(&asked, fast, now_s);
            }
            Ok(Instruction::SyncWrite { address, count, items }) => {
                for (id, data) in message::sync_items(items, count) {
                    self.write_silently(id, address, data, now_s);
                }
            }
            Ok(Instruction::BulkWrite { items }) => {
                for (id, address, data) in message::bulk_writes(items) {
                    self.write_silently(id, address, data, now_s);
                }
            }
            Ok(instruction) => self.obey_one(id, &instruction, now_s),
            Err(refusal) => {
                if let Some(index) = self.index_of(id, now_s) {
                    self.answer(index, 2, Err(refusal), &[]);
                }
            }
        }
    }

    fn index_of(&self, id: u8, now_s: f64) -> Option<usize> {
        self.servos.iter().position(|servo| servo.id() == id && servo.is_up(now_s))
    }

    fn write_silently(&mut self, id: u8, address: u16, data: &[u8], now_s: f64) {
        let meant = |servo: &&mut EmulatedServo| (servo.id() == id || servo.is_shadow_of(id)) && servo.is_up(now_s);
        for servo in self.servos.iter_mut().filter(meant) {
            // Not reported, as on the real bus.
            let _silent: Result<(), ServoRefusal> = servo.write(address, data, now_s);
        }
    }

    /// Executes an instruction for one servo, or for all on the bus.
    fn obey_one(&mut self, id: u8, instruction: &Instruction<'_>, now_s: f64) {
        let all = id == BROADCAST;
        for index in 0..self.servos.len() {
            let servo = &mut self.servos[index];
            if !servo.is_up(now_s) {
                continue;
            }
            let own = servo.id() == id;
            if !own && !all {
                if servo.is_shadow_of(id)
                    && let Instruction::Write { address, data } = *instruction
                {
                    self.write_silently(id, address, data, now_s);
                }
                continue;
            }
            let mut data = Vec::new();
            let (level, result) = Self::one(servo, instruction, all, now_s, &mut data);
            // All servos answer a broadcast ping; none answers any other broadcast.
            if own || *instruction == Instruction::Ping {
                self.answer(index, level, result, &data);
            }
        }
    }

    /// Executes an instruction on a servo; returns the minimum status return level for an answer, and the answer.
    fn one(
        servo: &mut EmulatedServo,
        instruction: &Instruction<'_>,
        all: bool,
        now_s: f64,
        data: &mut Vec<u8>,
    ) -> (i64, Result<(), ServoRefusal>) {
        let result = match *instruction {
            Instruction::Ping => {
                let firmware = servo.get(table::FIRMWARE) as u8;
                data.extend(servo.model.number.to_le_bytes());
                data.push(firmware);
                return (0, Ok(()));
            }
            Instruction::Read { address, count } => return (1, servo.read(address, count, data)),
            Instruction::Write { address, data } => servo.write(address, data, now_s),
            Instruction::RegWrite { address, data } => servo.register(address, data),
            Instruction::Action => servo.act(now_s),
            Instruction::FactoryReset { keep: Keep::Nothing } if all => Err(ServoRefusal::Range),
            Instruction::FactoryReset { keep } => {
                servo.factory_reset(keep, now_s);
                Ok(())
            }
            Instruction::Reboot => {
                servo.reboot(now_s);
                Ok(())
            }
            Instruction::ClearTurns => {
                servo.clear_turns();
                Ok(())
            }
            Instruction::Backup { restore } => servo.back_up(restore, now_s),
            Instruction::SyncRead { .. }
            | Instruction::SyncWrite { .. }
            | Instruction::BulkRead { .. }
            | Instruction::BulkWrite { .. } => Err(ServoRefusal::Instruction),
        };
        (2, result)
    }

    fn answer(&mut self, index: usize, level: i64, result: Result<(), ServoRefusal>, data: &[u8]) {
        let servo = &self.servos[index];
        if servo.get(table::STATUS_RETURN_LEVEL) < level {
            return;
        }
        let error = servo.alert() | result.err().map_or(0, |refusal| refusal as u8);
        self.out.clear();
        message::encode_status(servo.id(), error, data, &mut self.out);
        self.enqueue(index);
    }

    /// Several servos answer one after the other, or with blocks of one packet.
    fn read_many(&mut self, asked: &[(u8, u16, u16)], fast: bool, now_s: f64) {
        self.out.clear();
        if fast {
            let block_bytes = asked.iter().map(|(_, _, count)| usize::from(*count) + 4).sum();
            self.out.begin_fast(block_bytes);
        }
        let mut last = None;
        for (id, address, count) in asked {
            // Each servo waits for the previous one; after a missing servo none answers.
            let Some(index) = self.index_of(*id, now_s) else { break };
            let mut data = Vec::new();
            let result = self.servos[index].read(*address, *count, &mut data);
            if fast {
                data.resize(usize::from(*count), 0);
                let error = self.servos[index].alert() | result.err().map_or(0, |refusal| refusal as u8);
                self.out.put_block(error, *id, &data);
                last = Some(index);
            } else {
                self.answer(index, 1, result, &data);
            }
        }
        if let Some(index) = last {
            self.enqueue(index);
        }
    }

    /// Sends the packet in `out` when it is due.
    fn enqueue(&mut self, index: usize) {
        let delay_s = self.servos[index].get(table::RETURN_DELAY) as f64 * 2e-6;
        let wire_s = self.out.bytes().len() as f64 * 10.0 / f64::from(self.baud());
        self.free_s += delay_s + wire_s;
        self.queue.push_back((self.free_s, self.out.bytes().to_vec()));
    }
}
