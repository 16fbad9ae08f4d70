//! The emulated control table: registers, access rules, and factory values.

use std::ops::RangeInclusive;

use nima_devices::dynamixel::table::{self, DynamixelRegister, ServoModel};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Access {
    Read,
    /// While the torque is off; kept without power.
    Eeprom,
    /// Always; lost at a restart.
    Ram,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Rule {
    pub(super) register: DynamixelRegister,
    pub(super) access: Access,
    pub(super) low: i64,
    pub(super) high: i64,
    pub(super) factory: i64,
}

pub(super) const TABLE_BYTES: usize = 662;

const fn rule(register: DynamixelRegister, access: Access, range: (i64, i64), factory: i64) -> Rule {
    Rule { register, access, low: range.0, high: range.1, factory }
}

const fn at(address: u16, bytes: u16) -> DynamixelRegister {
    DynamixelRegister { address, bytes }
}

const U16: (i64, i64) = (0, 0xFFFF);
const I16: (i64, i64) = (-0x8000, 0x7FFF);
const I32: (i64, i64) = (-0x8000_0000, 0x7FFF_FFFF);
/// From the ROBOTIS e-manual, "Homing Offset".
const TURNS: (i64, i64) = (-1_044_479, 1_044_479);
/// From the ROBOTIS e-manual, "Position PID Gain".
const GAIN: (i64, i64) = (0, 16_383);
/// From the ROBOTIS e-manual, "Profile Velocity".
const PROFILE: (i64, i64) = (0, 32_767);

use Access::{Eeprom, Ram, Read};

/// All except the indirect registers; factory values of the XM430-W350.
const RULES: [Rule; 52] = [
    rule(table::MODEL, Read, U16, 1020),
    rule(at(2, 4), Read, I32, 0),
    rule(table::FIRMWARE, Read, (0, 255), 48),
    rule(table::ID, Eeprom, (0, 252), 1),
    rule(table::BAUD, Eeprom, (0, 7), 1),
    rule(table::RETURN_DELAY, Eeprom, (0, 254), 250),
    rule(table::DRIVE_MODE, Eeprom, (0, 15), 0),
    rule(table::OPERATING_MODE, Eeprom, (0, 16), 3),
    rule(table::SHADOW_ID, Eeprom, (0, 255), 255),
    rule(at(13, 1), Eeprom, (1, 22), 2),
    rule(table::HOMING_OFFSET, Eeprom, TURNS, 0),
    rule(table::MOVING_THRESHOLD, Eeprom, (0, 1023), 10),
    rule(table::TEMPERATURE_LIMIT, Eeprom, (0, 100), 80),
    rule(table::VOLTAGE_MAX, Eeprom, (95, 160), 160),
    rule(table::VOLTAGE_MIN, Eeprom, (95, 160), 95),
    rule(table::PWM_LIMIT, Eeprom, (0, 885), 885),
    rule(table::CURRENT_LIMIT, Eeprom, (0, 1193), 1193),
    rule(table::VELOCITY_LIMIT, Eeprom, (0, 1023), 200),
    rule(table::POSITION_MAX, Eeprom, (0, 4095), 4095),
    rule(table::POSITION_MIN, Eeprom, (0, 4095), 0),
    rule(at(60, 1), Eeprom, (0, 3), 0),
    rule(table::SHUTDOWN, Eeprom, (0, 255), 52),
    rule(table::TORQUE_ENABLE, Ram, (0, 1), 0),
    rule(at(65, 1), Ram, (0, 1), 0),
    rule(table::STATUS_RETURN_LEVEL, Ram, (0, 2), 2),
    rule(table::REGISTERED, Read, (0, 1), 0),
    rule(table::HARDWARE_ERROR, Read, (0, 255), 0),
    rule(table::VELOCITY_I, Ram, GAIN, 1920),
    rule(table::VELOCITY_P, Ram, GAIN, 100),
    rule(table::POSITION_D, Ram, GAIN, 0),
    rule(table::POSITION_I, Ram, GAIN, 0),
    rule(table::POSITION_P, Ram, GAIN, 800),
    rule(table::FEEDFORWARD_2, Ram, GAIN, 0),
    rule(table::FEEDFORWARD_1, Ram, GAIN, 0),
    rule(table::BUS_WATCHDOG, Ram, (0, 127), 0),
    rule(table::GOAL_PWM, Ram, (-885, 885), 885),
    rule(table::GOAL_CURRENT, Ram, I16, 1193),
    rule(table::GOAL_VELOCITY, Ram, (-1023, 1023), 0),
    rule(table::PROFILE_ACCELERATION, Ram, PROFILE, 0),
    rule(table::PROFILE_VELOCITY, Ram, PROFILE, 0),
    rule(table::GOAL_POSITION, Ram, (-1_048_575, 1_048_575), 2048),
    rule(table::TICK, Read, PROFILE, 0),
    rule(table::MOVING, Read, (0, 1), 0),
    rule(table::MOVING_STATUS, Read, (0, 255), 0),
    rule(table::PRESENT_PWM, Read, I16, 0),
    rule(table::PRESENT_CURRENT, Read, I16, 0),
    rule(table::PRESENT_VELOCITY, Read, I32, 0),
    rule(table::PRESENT_POSITION, Read, I32, 2048),
    rule(table::VELOCITY_TRAJECTORY, Read, I32, 0),
    rule(table::POSITION_TRAJECTORY, Read, I32, 2048),
    rule(table::VOLTAGE, Read, U16, 120),
    rule(table::TEMPERATURE, Read, (0, 255), 30),
];
/// 1 while a backup of the control table exists.
pub(super) const BACKUP_READY: Rule = rule(at(147, 1), Read, (0, 1), 0);

/// A range of indirect registers: pointers of two bytes each, and the bytes that they refer to.
#[derive(Clone, Copy, Debug)]
struct Indirect {
    pointers: u16,
    data: u16,
    count: u16,
}

const LARGE: [Indirect; 2] =
    [Indirect { pointers: 168, data: 224, count: 28 }, Indirect { pointers: 578, data: 634, count: 28 }];
const SMALL: [Indirect; 1] = [Indirect { pointers: 168, data: 208, count: 20 }];

const fn indirect(model: &ServoModel) -> &'static [Indirect] {
    if model.is_small() { &SMALL } else { &LARGE }
}

/// Returns the position of the pointer for indirect data at `address`, if it is indirect.
pub(super) fn pointer_of(model: &ServoModel, address: u16) -> Option<u16> {
    let block = indirect(model).iter().find(|block| (block.data..block.data + block.count).contains(&address))?;
    Some(block.pointers + 2 * (address - block.data))
}

/// Returns the rule of the register that begins at `address`.
pub(super) fn rule_at(model: &ServoModel, address: u16) -> Option<Rule> {
    let of_current = [table::CURRENT_LIMIT.address, table::GOAL_CURRENT.address];
    if !model.measures_current() && of_current.contains(&address) {
        return None;
    }
    if let Some(known) = RULES.iter().chain([&BACKUP_READY]).find(|rule| rule.register.address == address) {
        return Some(of_model(*known, model));
    }
    let top = if model.is_small() { 227 } else { 661 };
    for block in indirect(model) {
        let pointers: RangeInclusive<u16> = block.pointers..=block.pointers + 2 * block.count - 1;
        if pointers.contains(&address) && (address - block.pointers).is_multiple_of(2) {
            let own = block.data + (address - block.pointers) / 2;
            return Some(rule(at(address, 2), Ram, (64, top), own.into()));
        }
        if (block.data..block.data + block.count).contains(&address) {
            return Some(rule(at(address, 1), Ram, (0, 255), 0));
        }
    }
    None
}

/// Returns all rules of a model.
pub(super) fn rules(model: &'static ServoModel) -> impl Iterator<Item = Rule> {
    (0..TABLE_BYTES as u16).filter_map(|address| rule_at(model, address))
}

/// Applies the differences between models.
fn of_model(mut rule: Rule, model: &ServoModel) -> Rule {
    let register = rule.register;
    if register == table::MODEL {
        rule.factory = model.number.into();
    } else if register == table::CURRENT_LIMIT || register == table::GOAL_CURRENT {
        rule.factory = model.current_max.into();
        if register == table::CURRENT_LIMIT {
            rule.high = rule.factory;
        }
    }
    if !model.is_small() {
        return rule;
    }
    let small: [(DynamixelRegister, (i64, i64), i64); 11] = [
        (table::BAUD, (0, 6), 1),
        (table::TEMPERATURE_LIMIT, (0, 100), 70),
        (table::VOLTAGE_MAX, (31, 70), 70),
        (table::VOLTAGE_MIN, (31, 70), 35),
        (table::VELOCITY_LIMIT, (0, 2047), 445),
        (table::GOAL_VELOCITY, (-2047, 2047), 0),
        (table::SHUTDOWN, (0, 255), 53),
        (table::VELOCITY_I, GAIN, 1600),
        (table::VELOCITY_P, GAIN, 180),
        (table::POSITION_P, GAIN, 400),
        (table::VOLTAGE, U16, 50),
    ];
    if let Some((_, (low, high), factory)) = small.iter().find(|(known, _, _)| *known == register) {
        rule.low = *low;
        rule.high = *high;
        rule.factory = *factory;
    }
    rule
}
