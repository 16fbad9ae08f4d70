//! One emulated servo: its control table with the rules of the e-manual, its motor, shutdown and bus watchdog.

mod moving;

use nima_devices::dynamixel::{
    message::{ALERT, Keep, ServoRefusal},
    table::{self, DynamixelRegister, HardwareError, ServoModel},
};

use super::{
    motor::Motor,
    registers::{self, Access, BACKUP_READY, TABLE_BYTES},
};

/// Time that a servo does not answer after a reboot, s.
const BOOT_S: f64 = 0.2;

const GOALS: [DynamixelRegister; 4] =
    [table::GOAL_PWM, table::GOAL_CURRENT, table::GOAL_VELOCITY, table::GOAL_POSITION];

#[derive(Debug)]
pub(super) struct EmulatedServo {
    pub(super) model: &'static ServoModel,
    table: Box<[u8; TABLE_BYTES]>,
    backup: Option<Box<[u8; TABLE_BYTES]>>,
    registered: Option<(u16, Vec<u8>)>,
    motor: Motor,
    stepped_s: Option<f64>,
    booted_s: f64,
    received_s: f64,
    stalled_s: f64,
    /// Whether its measurements are frozen.
    pub(super) frozen: bool,
    /// Whether it reports an impossible position.
    pub(super) impossible: bool,
}

impl EmulatedServo {
    pub(super) fn new(model: &'static ServoModel, id: u8, baud_code: u8) -> Self {
        let mut servo = Self {
            model,
            table: Box::new([0; TABLE_BYTES]),
            backup: None,
            registered: None,
            motor: Motor::default(),
            stepped_s: None,
            booted_s: f64::NEG_INFINITY,
            received_s: 0.0,
            stalled_s: 0.0,
            frozen: false,
            impossible: false,
        };
        servo.set_factory(|_| true);
        servo.set(table::ID, id.into());
        servo.set(table::BAUD, baud_code.into());
        servo
    }

    fn set_factory(&mut self, which: impl Fn(Access) -> bool) {
        for rule in registers::rules(self.model).filter(|rule| which(rule.access)) {
            self.set(rule.register, rule.factory);
        }
    }

    /// Returns the value of a register, with sign.
    pub(super) fn get(&self, register: DynamixelRegister) -> i64 {
        let at = usize::from(register.address);
        match register.bytes {
            1 => self.table[at].into(),
            2 => i16::from_le_bytes([self.table[at], self.table[at + 1]]).into(),
            _ => {
                i32::from_le_bytes([self.table[at], self.table[at + 1], self.table[at + 2], self.table[at + 3]]).into()
            }
        }
    }

    /// Sets a register without checking any rule.
    pub(super) fn set(&mut self, register: DynamixelRegister, value: i64) {
        let at = usize::from(register.address);
        self.table[at..at + usize::from(register.bytes)]
            .copy_from_slice(&value.to_le_bytes()[..usize::from(register.bytes)]);
    }

    pub(super) fn id(&self) -> u8 {
        self.get(table::ID) as u8
    }

    /// Returns whether it silently executes writes to this id.
    pub(super) fn is_shadow_of(&self, id: u8) -> bool {
        let shadow = self.get(table::SHADOW_ID);
        shadow <= 252 && shadow == i64::from(id)
    }

    /// Returns the alert bit, set while there is a hardware error.
    pub(super) fn alert(&self) -> u8 {
        if self.get(table::HARDWARE_ERROR) == 0 { 0 } else { ALERT }
    }

    /// Returns whether it receives; a servo that is starting does not.
    pub(super) fn is_up(&self, now_s: f64) -> bool {
        now_s >= self.booted_s + BOOT_S
    }

    /// Notes that an instruction was on the bus.
    pub(super) const fn receive(&mut self, now_s: f64) {
        self.received_s = now_s;
    }

    fn torque_on(&self) -> bool {
        self.get(table::TORQUE_ENABLE) != 0
    }

    /// Returns the actual position of a byte: indirect data are stored elsewhere.
    fn place(&self, address: u16) -> usize {
        let target = registers::pointer_of(self.model, address)
            .map(|pointer| self.get(DynamixelRegister { address: pointer, bytes: 2 }) as u16);
        usize::from(target.unwrap_or(address))
    }

    /// Reads into `out`; addresses between registers read as 0.
    pub(super) fn read(&self, address: u16, count: u16, out: &mut Vec<u8>) -> Result<(), ServoRefusal> {
        let end = usize::from(address) + usize::from(count);
        if count == 0 || end > TABLE_BYTES {
            return Err(if count == 0 { ServoRefusal::Length } else { ServoRefusal::Access });
        }
        out.extend((address..end as u16).map(|at| self.table[self.place(at)]));
        Ok(())
    }

    /// Writes whole registers: either all of them, or none with the reason.
    pub(super) fn write(&mut self, address: u16, data: &[u8], now_s: f64) -> Result<(), ServoRefusal> {
        if data.is_empty() || usize::from(address) + data.len() > TABLE_BYTES {
            return Err(if data.is_empty() { ServoRefusal::Length } else { ServoRefusal::Access });
        }
        let places: Vec<usize> = (address..).take(data.len()).map(|at| self.place(at)).collect();
        let mut writes = Vec::new();
        let mut at = 0;
        while at < data.len() {
            let rule = registers::rule_at(self.model, places[at] as u16).ok_or(ServoRefusal::Access)?;
            let bytes = usize::from(rule.register.bytes);
            let whole = (0..bytes).all(|k| places.get(at + k) == Some(&(places[at] + k)));
            if !whole {
                return Err(ServoRefusal::Length);
            }
            let value = signed(&data[at..at + bytes], rule.low < 0);
            self.check(rule, value)?;
            writes.push((rule.register, value));
            at += bytes;
        }
        for (register, value) in writes {
            self.obey(register, value, now_s);
        }
        Ok(())
    }

    fn check(&self, rule: registers::Rule, value: i64) -> Result<(), ServoRefusal> {
        let register = rule.register;
        if rule.access == Access::Read || (rule.access == Access::Eeprom && self.torque_on()) {
            return Err(ServoRefusal::Access);
        }
        let expired = self.get(table::BUS_WATCHDOG) == i64::from(table::WATCHDOG_EXPIRED);
        let locked = expired && (GOALS.contains(&register) || (register == table::BUS_WATCHDOG && value != 0));
        let no_mode = register == table::OPERATING_MODE && !matches!(value, 0 | 1 | 3..=5 | 16);
        if locked || no_mode || !(rule.low..=rule.high).contains(&value) {
            return Err(ServoRefusal::Range);
        }
        // After a shutdown, torque can be enabled again only after a reboot.
        let shut_down = self.get(table::HARDWARE_ERROR) & self.get(table::SHUTDOWN) != 0;
        if register == table::TORQUE_ENABLE && value != 0 && shut_down {
            return Err(ServoRefusal::Access);
        }
        let limits = match register {
            table::GOAL_POSITION if self.get(table::OPERATING_MODE) == 3 => {
                (self.get(table::POSITION_MIN), self.get(table::POSITION_MAX))
            }
            table::GOAL_CURRENT => (-self.get(table::CURRENT_LIMIT), self.get(table::CURRENT_LIMIT)),
            table::GOAL_VELOCITY => (-self.get(table::VELOCITY_LIMIT), self.get(table::VELOCITY_LIMIT)),
            table::GOAL_PWM => (-self.get(table::PWM_LIMIT), self.get(table::PWM_LIMIT)),
            _ => return Ok(()),
        };
        if (limits.0..=limits.1).contains(&value) { Ok(()) } else { Err(ServoRefusal::Limit) }
    }

    /// Writes a checked value and applies its effects.
    fn obey(&mut self, register: DynamixelRegister, value: i64, now_s: f64) {
        let before = self.get(register);
        self.set(register, value);
        match register {
            table::TORQUE_ENABLE if value != before => {
                self.motor.restart();
                self.received_s = now_s;
                self.set(table::GOAL_POSITION, self.position_ticks().round() as i64);
            }
            table::OPERATING_MODE if value != before => {
                for rule in registers::rules(self.model).filter(|rule| (76..118).contains(&rule.register.address)) {
                    if rule.register != table::BUS_WATCHDOG {
                        self.set(rule.register, rule.factory);
                    }
                }
                self.set(table::GOAL_CURRENT, self.get(table::CURRENT_LIMIT));
                self.set(table::GOAL_PWM, self.get(table::PWM_LIMIT));
            }
            table::GOAL_POSITION if self.get(table::DRIVE_MODE) & 0b1000 != 0 && !self.torque_on() => {
                self.motor.restart();
                self.set(table::TORQUE_ENABLE, 1);
            }
            table::CURRENT_LIMIT => {
                self.set(table::GOAL_CURRENT, self.get(table::GOAL_CURRENT).clamp(-value, value));
            }
            _ => {}
        }
    }

    /// Stores a write for the action instruction.
    pub(super) fn register(&mut self, address: u16, data: &[u8]) -> Result<(), ServoRefusal> {
        let known = registers::rule_at(self.model, self.place(address.min(TABLE_BYTES as u16 - 1)) as u16);
        if known.is_none_or(|rule| rule.access == Access::Read) {
            return Err(ServoRefusal::Access);
        }
        self.registered = Some((address, data.to_vec()));
        self.set(table::REGISTERED, 1);
        Ok(())
    }

    /// Executes the stored write.
    pub(super) fn act(&mut self, now_s: f64) -> Result<(), ServoRefusal> {
        let Some((address, data)) = self.registered.take() else { return Err(ServoRefusal::Failed) };
        self.set(table::REGISTERED, 0);
        self.write(address, &data, now_s)
    }

    /// Restarts: the RAM gets its factory values, the shutdown ends, and the turn count is lost.
    pub(super) fn reboot(&mut self, now_s: f64) {
        self.set_factory(|access| access != Access::Eeprom);
        self.set(table::GOAL_CURRENT, self.get(table::CURRENT_LIMIT));
        self.set(table::GOAL_PWM, self.get(table::PWM_LIMIT));
        self.set(BACKUP_READY.register, self.backup.is_some().into());
        self.registered = None;
        self.stalled_s = 0.0;
        self.booted_s = now_s;
        self.clear_turns();
        self.motor.restart();
    }

    pub(super) fn clear_turns(&mut self) {
        self.motor.angle_rad =
            (self.motor.angle_rad + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        self.motor.restart();
    }

    pub(super) fn factory_reset(&mut self, keep: Keep, now_s: f64) {
        let id = self.get(table::ID);
        let baud = self.get(table::BAUD);
        self.set_factory(|_| true);
        if keep != Keep::Nothing {
            self.set(table::ID, id);
        }
        if keep == Keep::IdAndBaud {
            self.set(table::BAUD, baud);
        }
        self.reboot(now_s);
    }

    pub(super) fn back_up(&mut self, restore: bool, now_s: f64) -> Result<(), ServoRefusal> {
        if self.torque_on() {
            return Err(ServoRefusal::Access);
        }
        if restore {
            let kept = self.backup.clone().ok_or(ServoRefusal::Failed)?;
            self.table[7..64].copy_from_slice(&kept[7..64]);
            self.reboot(now_s);
        } else {
            self.backup = Some(self.table.clone());
            self.set(BACKUP_READY.register, 1);
        }
        Ok(())
    }

    /// Latches a hardware error; switches the torque off if the shutdown register says so.
    pub(super) fn fail(&mut self, error: HardwareError) {
        let errors = self.get(table::HARDWARE_ERROR) | i64::from(error.0);
        self.set(table::HARDWARE_ERROR, errors);
        if errors & self.get(table::SHUTDOWN) != 0 {
            self.set(table::TORQUE_ENABLE, 0);
        }
    }
}

fn signed(bytes: &[u8], sign: bool) -> i64 {
    let value = bytes.iter().rev().fold(0_i64, |value, byte| value << 8 | i64::from(*byte));
    let top = 1_i64 << (8 * bytes.len());
    if sign && value >= top / 2 { value - top } else { value }
}
