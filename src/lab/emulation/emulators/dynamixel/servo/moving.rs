//! Motion, measurements and self-protection of an emulated servo.

use nima_devices::dynamixel::table::{self, HardwareError, TICK_WRAP, TICKS_PER_TURN, VELOCITY_UNIT_RAD_S};

use super::{
    super::{
        ServoShaft, ServoSurroundings,
        motor::{MotorDrive, Plant, STEP_S},
    },
    EmulatedServo,
};

/// Full drive at standstill for this long counts as an overload, s.
const OVERLOAD_S: f64 = 1.0;
/// Maximum number of motor steps made up at a time. Without a limit, a paused process would integrate for longer than
/// the pause.
const CATCH_UP_STEPS: usize = 200;
/// An impossible reading, for the corresponding fault.
const IMPOSSIBLE_TICKS: i64 = 0x7FFF_FFFF;

/// Full drive, units of PWM (ROBOTIS e-manual, X series).
const FULL_PWM: f64 = 885.0;

impl EmulatedServo {
    /// Returns the sign and offset between the shaft's ticks and the register's.
    fn frame(&self) -> (f64, f64) {
        let homing = self.get(table::HOMING_OFFSET);
        let ignored = self.get(table::OPERATING_MODE) == 3 && homing.abs() > 1024;
        let sign = if self.get(table::DRIVE_MODE) & 1 == 0 { 1.0 } else { -1.0 };
        (sign, if ignored { 0.0 } else { homing as f64 })
    }

    pub(super) fn position_ticks(&self) -> f64 {
        let (sign, homing) = self.frame();
        table::TICKS_AT_ZERO + sign * (self.motor.ticks() - table::TICKS_AT_ZERO) + homing
    }

    pub(in super::super) fn shaft(&self) -> ServoShaft {
        ServoShaft {
            angle_rad: self.motor.angle_rad,
            velocity_rad_s: self.motor.velocity_rad_s,
            torque_on: self.torque_on(),
        }
    }

    /// Moves the motor until `now_s`, and measures.
    pub(in super::super) fn advance(&mut self, now_s: f64, around: &ServoSurroundings) {
        self.watch(now_s);
        let begin_s = *self.stepped_s.get_or_insert(now_s);
        let steps = (((now_s - begin_s) / STEP_S) as usize).min(CATCH_UP_STEPS);
        let plant = if self.model.is_small() { Plant::SMALL } else { Plant::LARGE };
        for _ in 0..steps {
            let drive = self.drive(around);
            self.motor.step(&drive, &plant);
            self.guard(&drive);
        }
        let caught_up_s = begin_s + steps as f64 * STEP_S;
        self.stepped_s = Some(if steps == CATCH_UP_STEPS { now_s } else { caught_up_s });
        self.limits(around);
        if !self.frozen {
            self.measure(now_s, around);
        }
    }

    fn watch(&mut self, now_s: f64) {
        let units = self.get(table::BUS_WATCHDOG);
        let active = self.torque_on() && (1..=127).contains(&units);
        if active && now_s - self.received_s > units as f64 * table::WATCHDOG_UNIT_S {
            self.set(table::BUS_WATCHDOG, table::WATCHDOG_EXPIRED.into());
            // Stop quickly at the current position.
            self.motor.restart();
            self.set(table::PROFILE_ACCELERATION, 0);
            self.set(table::PROFILE_VELOCITY, 0);
            self.set(table::GOAL_VELOCITY, 0);
            self.set(table::GOAL_POSITION, self.position_ticks().round() as i64);
            if matches!(self.get(table::OPERATING_MODE), 0 | 16) {
                self.set(table::GOAL_CURRENT, 0);
                self.set(table::GOAL_PWM, 0);
            }
        }
    }

    fn drive(&self, around: &ServoSurroundings) -> MotorDrive {
        let (sign, homing) = self.frame();
        let number = |register| self.get(register) as f64;
        let goal = number(table::GOAL_POSITION) - homing - table::TICKS_AT_ZERO;
        let has_current = self.model.measures_current();
        let unit_a = self.model.current_unit_a;
        MotorDrive {
            torque_on: self.torque_on(),
            mode: self.get(table::OPERATING_MODE) as u8,
            goal_ticks: table::TICKS_AT_ZERO + sign * goal,
            goal_velocity: sign * number(table::GOAL_VELOCITY),
            goal_current_a: if has_current { sign * number(table::GOAL_CURRENT) * unit_a } else { 0.0 },
            goal_pwm: sign * number(table::GOAL_PWM),
            pwm_limit: number(table::PWM_LIMIT),
            current_limit_a: if has_current { number(table::CURRENT_LIMIT) * unit_a } else { f64::INFINITY },
            profile_velocity: number(table::PROFILE_VELOCITY),
            profile_acceleration: number(table::PROFILE_ACCELERATION),
            position_pid: [table::POSITION_P, table::POSITION_I, table::POSITION_D].map(number),
            velocity_pi: [table::VELOCITY_P, table::VELOCITY_I].map(number),
            feedforward: [table::FEEDFORWARD_1, table::FEEDFORWARD_2].map(number),
            supply_v: around.supply_v,
            load_nm: around.load_nm,
        }
    }

    /// Detects an overload: full drive or full current without movement for too long.
    fn guard(&mut self, drive: &MotorDrive) {
        let all_pwm = self.motor.pwm.abs() >= 0.95 * drive.pwm_limit && drive.pwm_limit > 0.0;
        let all_current = drive.mode != 5 && self.motor.current_a.abs() >= 0.95 * drive.current_limit_a;
        let strained = all_pwm || all_current;
        let stalled = drive.torque_on && strained && self.motor.velocity_rad_s.abs() < 0.05;
        self.stalled_s = if stalled { self.stalled_s + STEP_S } else { 0.0 };
        if self.stalled_s > OVERLOAD_S {
            self.fail(HardwareError(HardwareError::OVERLOAD));
        }
    }

    fn limits(&mut self, around: &ServoSurroundings) {
        let tenths = (around.supply_v * 10.0).round() as i64;
        if !(self.get(table::VOLTAGE_MIN)..=self.get(table::VOLTAGE_MAX)).contains(&tenths) {
            self.fail(HardwareError(0x01));
        }
        if around.temperature_c > self.get(table::TEMPERATURE_LIMIT) as f64 {
            self.fail(HardwareError(0x04));
        }
    }

    fn measure(&mut self, now_s: f64, around: &ServoSurroundings) {
        let (sign, homing) = self.frame();
        let register = |rad_s: f64| (sign * rad_s / VELOCITY_UNIT_RAD_S).round() as i64;
        let motor = self.motor;
        let position = if self.impossible { IMPOSSIBLE_TICKS } else { self.position_ticks().round() as i64 };
        let velocity = register(motor.velocity_rad_s);
        let wanted = sign * motor.wanted_rad / std::f64::consts::TAU * TICKS_PER_TURN + table::TICKS_AT_ZERO + homing;
        let off = (self.get(table::GOAL_POSITION) - position).abs();
        let profile = motor.wanted_rad_s != 0.0;
        let status = i64::from(off < 20) | i64::from(profile) << 1 | i64::from(self.torque_on() && off > 200) << 3;
        let since_boot_s = if self.booted_s.is_finite() { now_s - self.booted_s } else { now_s };
        // A model without current reports the load in the same place, in 0.1 % of the full drive.
        let load = if self.model.measures_current() {
            sign * motor.current_a / self.model.current_unit_a
        } else {
            sign * motor.pwm / FULL_PWM * 1000.0
        };
        let load = load.round() as i64;
        let values = [
            (table::TICK, (since_boot_s * 1e3) as i64 % i64::from(TICK_WRAP)),
            (table::MOVING, (velocity.abs() > self.get(table::MOVING_THRESHOLD)).into()),
            (table::MOVING_STATUS, status),
            (table::PRESENT_PWM, (sign * motor.pwm).round() as i64),
            (table::PRESENT_CURRENT, load),
            (table::PRESENT_VELOCITY, velocity),
            (table::PRESENT_POSITION, position),
            (table::VELOCITY_TRAJECTORY, register(motor.wanted_rad_s)),
            (table::POSITION_TRAJECTORY, wanted.round() as i64),
            (table::VOLTAGE, (around.supply_v * 10.0).round() as i64),
            (table::TEMPERATURE, around.temperature_c.clamp(0.0, 255.0) as i64),
        ];
        for (register, value) in values {
            self.set(register, value);
        }
    }
}
