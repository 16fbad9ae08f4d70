//! Runs the exchanges: sends, receives answers, times out, and determines when the servos are lost.

use super::{
    super::{
        clock::ReadingAge,
        codec::{self, BROADCAST, OVERHEAD, STATUS},
        message::{ALERT, Instruction, ServoRefusal},
        table::{self, HardwareError, ServoFault, TEMPERATURE, VELOCITY_UNIT_RAD_S, rad_from_ticks},
    },
    CONDITION_BYTES, CONDITION_EVERY_S, CONDITION_FROM, CURRENT_MAX, DynamixelDriver, LONGEST, MOTION_BYTES,
    POSITION_MAX, Quiet, SLACK, ServoCondition, ServoExchange, ServoMotion, ServoQuestion, Torque, VELOCITY_MAX,
};
use crate::{ConnectionState, Health, Loss, SERVOS, ServoReading, TimedReading, transport::ByteStream};

impl<T: ByteStream> DynamixelDriver<T> {
    pub(super) fn turn(&mut self, now_s: f64) -> Result<Option<TimedReading<ServoReading>>, Loss> {
        self.quiet.pass(now_s, self.silence_s);
        let reading = self.listen(now_s)?;
        self.expire(now_s);
        if self.exchange.is_none() {
            self.ask(now_s)?;
        }
        self.judge_silence()?;
        Ok(reading)
    }

    fn listen(&mut self, now_s: f64) -> Result<Option<TimedReading<ServoReading>>, Loss> {
        let mut newest = None;
        let mut buffer = [0; 256];
        // A line that sends without pause must not hold up the loop.
        for _ in 0..4 {
            let count = self.line.receive(&mut buffer)?;
            let mut taken = 0;
            while taken < count {
                taken += self.incoming.feed(&buffer[taken..count]);
                while let Some(packet) = self.incoming.next() {
                    // A copy, because the packet borrows the decoder, which belongs to `self`.
                    let mut copy = [0; LONGEST];
                    let body = &mut copy[..packet.body.len()];
                    body.copy_from_slice(packet.body);
                    let id = packet.id;
                    let instruction = packet.instruction;
                    if instruction == STATUS {
                        newest = self.take(id, body, now_s)?.or(newest);
                    } else {
                        self.wrong += 1;
                    }
                }
            }
            if count < buffer.len() {
                break;
            }
        }
        let refused = self.incoming.refused();
        self.health.damaged = refused.damaged + self.wrong;
        self.health.skipped_bytes = refused.skipped;
        Ok(newest)
    }

    /// Handles a status packet: accepts it as part of the expected answer, or counts the reason for rejecting it.
    fn take(&mut self, id: u8, body: &[u8], now_s: f64) -> Result<Option<TimedReading<ServoReading>>, Loss> {
        let plain = body.len() == MOTION_BYTES + 1;
        let condition = body.len() == CONDITION_BYTES + 1;
        // Each block of a fast answer has an error, an id and two bytes of CRC in addition to its data; the decoder has
        // already removed the CRC of the last block, which is also the packet's.
        let fast = id == BROADCAST && body.len() + 2 == SERVOS * (MOTION_BYTES + 4);
        if !(plain || condition || fast || body.len() == 1) {
            self.wrong += 1;
            return Ok(None);
        }
        match self.exchange.map(|exchange| exchange.question) {
            Some(ServoQuestion::Motion { .. }) if self.fast && fast => {
                let mut good = true;
                for (index, block) in codec::blocks(body, MOTION_BYTES).into_iter().flatten().enumerate() {
                    good &= block.id == self.servos[index].id && self.take_motion(index, block.error, block.data);
                }
                self.finish(good, now_s)
            }
            Some(ServoQuestion::Motion { next }) if !self.fast && plain && id == self.servos[next].id => {
                let good = self.take_motion(next, body[0], &body[1..]);
                if good && next + 1 < SERVOS {
                    if let Some(exchange) = &mut self.exchange {
                        exchange.question = ServoQuestion::Motion { next: next + 1 };
                    }
                    return Ok(None);
                }
                self.finish(good, now_s)
            }
            Some(ServoQuestion::Condition { index }) if condition && id == self.servos[index].id => {
                self.exchange = None;
                self.take_condition(index, &body[1..])?;
                Ok(None)
            }
            _ => {
                self.health.out_of_order += 1;
                Ok(None)
            }
        }
    }

    /// Stores one servo's part of a reading; returns false if the servo refused.
    fn take_motion(&mut self, index: usize, error: u8, data: &[u8]) -> bool {
        if error & ALERT != 0 {
            self.alert.get_or_insert(index);
        }
        let two = |at: usize| [data[at], data[at + 1]];
        let four = |at: usize| i32::from_le_bytes([data[at], data[at + 1], data[at + 2], data[at + 3]]);
        self.motions[index] = ServoMotion {
            tick: u16::from_le_bytes(two(0)),
            current: i16::from_le_bytes(two(6)),
            velocity: four(8),
            position: four(12),
        };
        ServoRefusal::of(error) == Ok(None)
    }

    /// Completes a reading whose parts have all arrived.
    fn finish(&mut self, good: bool, now_s: f64) -> Result<Option<TimedReading<ServoReading>>, Loss> {
        if !good {
            self.exchange = None;
            self.health.refused += 1;
            return Ok(None);
        }
        let possible = |motion: &ServoMotion| {
            motion.velocity.unsigned_abs() <= VELOCITY_MAX.unsigned_abs()
                && motion.position.unsigned_abs() <= POSITION_MAX.unsigned_abs()
                && motion.current.unsigned_abs() <= CURRENT_MAX.unsigned_abs()
        };
        if !self.motions.iter().all(possible) {
            self.exchange = None;
            self.health.refused += 1;
            return Err(Loss::Implausible);
        }
        let (device_s, age) = self.clock.take(self.motions[0].tick, now_s);
        if age == ReadingAge::Old {
            // An answer to an earlier exchange; the expected answer may still arrive.
            self.health.out_of_order += 1;
            if let Some(exchange) = &mut self.exchange {
                exchange.question = ServoQuestion::Motion { next: 0 };
            }
            return Ok(None);
        }
        self.exchange = None;
        if age == ReadingAge::New {
            self.quiet.end(&self.health);
        }
        self.health.accept(now_s);
        let each = |of: &dyn Fn(usize) -> f64| std::array::from_fn(of);
        let value = ServoReading {
            position_rad: each(&|index| rad_from_ticks(f64::from(self.motions[index].position))),
            velocity_rad_s: each(&|index| f64::from(self.motions[index].velocity) * VELOCITY_UNIT_RAD_S),
            current_a: each(&|index| f64::from(self.motions[index].current) * self.servos[index].current_unit_a),
        };
        Ok(Some(TimedReading { device_s: Some(device_s), arrival_s: now_s, value }))
    }

    fn take_condition(&mut self, index: usize, data: &[u8]) -> Result<(), Loss> {
        let at = |register: table::DynamixelRegister| usize::from(register.address - CONDITION_FROM);
        let byte = |register| data[at(register)];
        let expired = if byte(table::BUS_WATCHDOG) == table::WATCHDOG_EXPIRED { HardwareError::WATCHDOG } else { 0 };
        let torque_on = byte(table::TORQUE_ENABLE) != 0;
        let servo = &mut self.servos[index];
        let mut error = HardwareError(byte(table::HARDWARE_ERROR) | expired);
        if servo.driven && !torque_on && self.torque == Torque::On {
            error.0 |= HardwareError::TORQUE_GONE;
        }
        let voltage = u16::from_le_bytes([byte(table::VOLTAGE), data[at(table::VOLTAGE) + 1]]);
        servo.condition = Some(ServoCondition {
            torque_on,
            error,
            voltage_v: f64::from(voltage) * 0.1,
            temperature_c: f64::from(byte(TEMPERATURE)),
        });
        servo.driven = torque_on;
        if error.is_any() {
            return Err(Loss::Device { code: ServoFault { id: servo.id, error }.code() });
        }
        // Repeat a torque command that may have been lost on the line, because a sync write has no answer.
        match self.torque {
            Torque::On if !torque_on => self.torque = Torque::Wanted,
            Torque::Off if torque_on => self.torque = Torque::Ending,
            _ => {}
        }
        Ok(())
    }

    /// Abandons an exchange that is not answered in time.
    fn expire(&mut self, now_s: f64) {
        let Some(exchange) = self.exchange.filter(|exchange| now_s >= exchange.until_s) else { return };
        self.exchange = None;
        // Otherwise the bytes of the next answer could complete a half packet of this one.
        self.incoming.reset();
        if matches!(exchange.question, ServoQuestion::Motion { .. }) {
            self.health.lost += 1;
        }
    }

    fn ask(&mut self, now_s: f64) -> Result<(), Loss> {
        if self.reboots.is_any() {
            return Err(Loss::Silent);
        }
        self.outgoing.clear();
        self.put_commands();
        let ids = self.servos.map(|servo| servo.id);
        let due = self.alert.take().or_else(|| {
            let due = now_s >= self.condition_due_s;
            due.then_some(self.condition_next)
        });
        let (question, answer_bytes) = if let Some(index) = due {
            self.condition_due_s = now_s + CONDITION_EVERY_S;
            self.condition_next = (index + 1) % SERVOS;
            let read = Instruction::Read { address: CONDITION_FROM, count: CONDITION_BYTES as u16 };
            read.encode(ids[index], &mut self.outgoing);
            (ServoQuestion::Condition { index }, CONDITION_BYTES + OVERHEAD + 1)
        } else {
            let address = table::TICK.address;
            let count = MOTION_BYTES as u16;
            Instruction::SyncRead { address, count, ids: &ids, fast: self.fast }.encode(BROADCAST, &mut self.outgoing);
            (ServoQuestion::Motion { next: 0 }, SERVOS * (MOTION_BYTES + OVERHEAD + 1))
        };
        self.line.send(self.outgoing.bytes())?;
        let wire_s = (self.outgoing.bytes().len() + answer_bytes) as f64 * self.byte_s;
        self.exchange = Some(ServoExchange { question, until_s: now_s + wire_s + SLACK * self.silence_s });
        Ok(())
    }

    /// Appends the sync writes that precede the read; they have no answers.
    fn put_commands(&mut self) {
        match self.torque {
            Torque::Wanted if self.health.standing == ConnectionState::Connected => {
                // The goal is the current position, so that switching on the torque does not move the instrument.
                let here = std::array::from_fn(|index| {
                    let (low, high) = self.servos[index].limits_ticks;
                    f64::from(self.motions[index].position).clamp(low, high) as i32
                });
                self.goals = Some(here);
                // An expired watchdog makes the goals read-only until it is cleared with 0 (ROBOTIS e-manual, "Bus
                // Watchdog").
                self.put_all(table::BUS_WATCHDOG.address, [[0]; SERVOS]);
                self.put_all(table::GOAL_POSITION.address, here.map(i32::to_le_bytes));
                self.put_all(table::BUS_WATCHDOG.address, [[self.watchdog]; SERVOS]);
                self.put_all(table::TORQUE_ENABLE.address, [[1]; SERVOS]);
                self.torque = Torque::On;
            }
            Torque::On => {
                if let Some(goals) = self.goals {
                    self.put_all(table::GOAL_POSITION.address, goals.map(i32::to_le_bytes));
                }
            }
            Torque::Ending => {
                self.put_torque_off();
                self.torque = Torque::Off;
                self.goals = None;
            }
            Torque::Off | Torque::Wanted => {}
        }
    }

    pub(super) fn put_torque_off(&mut self) {
        // Switch the torque off first: if the second packet is lost, the servos are still off.
        self.put_all(table::TORQUE_ENABLE.address, [[0]; SERVOS]);
        self.put_all(table::BUS_WATCHDOG.address, [[0]; SERVOS]);
    }

    fn put_all<const N: usize>(&mut self, address: u16, data: [[u8; N]; SERVOS]) {
        let out = self.outgoing.begin(BROADCAST, 0x83).put_u16(address).put_u16(N as u16);
        for (servo, bytes) in self.servos.iter().zip(data) {
            out.put(&[servo.id]).put(&bytes);
        }
        out.end();
    }

    fn judge_silence(&self) -> Result<(), Loss> {
        if self.quiet.length_s < self.silence_s {
            return Ok(());
        }
        // All three look like silence to the loop, but each has a different remedy.
        Err(if self.health.damaged > self.quiet.damaged_before {
            Loss::Corrupt
        } else if self.health.refused > self.quiet.refused_before {
            Loss::Implausible
        } else {
            Loss::Silent
        })
    }
}

impl Quiet {
    fn pass(&mut self, now_s: f64, silence_s: f64) {
        let step_s = self.polled_s.map_or(0.0, |polled_s| now_s - polled_s);
        self.polled_s = Some(now_s);
        // A poll that is late itself says nothing about the servos: it counts as a quarter of the limit at most.
        self.length_s += step_s.clamp(0.0, silence_s / 4.0);
    }

    const fn end(&mut self, health: &Health) {
        self.length_s = 0.0;
        self.damaged_before = health.damaged;
        self.refused_before = health.refused;
    }
}
