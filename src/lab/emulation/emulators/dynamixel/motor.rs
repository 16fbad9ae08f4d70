//! A geared motor under the servo's own control, with working profile, gains and limits.
//!
//! Voltage drives current against resistance and back EMF, current makes torque, torque moves an inertia with viscous
//! friction and the load of the world. Resistance, torque constant and speed follow from the stall and no-load values
//! in the e-manual; inertia and friction are guesses of a realistic magnitude. Gains are scaled as in the e-manual
//! (P/128, I/65536, D/16, FF/4).

use nima_devices::dynamixel::table::{
    ACCELERATION_UNIT_RAD_S2, TICKS_PER_TURN, VELOCITY_UNIT_RAD_S, rad_from_ticks, ticks_from_rad,
};

/// Step of the control loop and of the integration, s.
pub(super) const STEP_S: f64 = 1e-3;
/// Full PWM. 100 % in the unit of the control table (ROBOTIS e-manual, "PWM Limit").
const PWM_FULL: f64 = 885.0;

#[derive(Clone, Copy, Debug)]
pub(super) struct Plant {
    resistance_ohm: f64,
    torque_nm_per_a: f64,
    back_emf_v_s_per_rad: f64,
    inertia_kg_m2: f64,
    friction_nm_s_per_rad: f64,
}

impl Plant {
    /// XM430-W350: 4.1 Nm and 2.3 A at stall, 46 rpm free, at 12 V.
    pub(super) const LARGE: Self = Self {
        resistance_ohm: 12.0 / 2.3,
        torque_nm_per_a: 4.1 / 2.3,
        back_emf_v_s_per_rad: 12.0 / 4.82,
        inertia_kg_m2: 0.03,
        friction_nm_s_per_rad: 0.1,
    };
    /// XL330-M288: 0.52 Nm and 1.47 A at stall, 103 rpm free, at 5 V.
    pub(super) const SMALL: Self = Self {
        resistance_ohm: 5.0 / 1.47,
        torque_nm_per_a: 0.52 / 1.47,
        back_emf_v_s_per_rad: 5.0 / 10.8,
        inertia_kg_m2: 0.002,
        friction_nm_s_per_rad: 0.01,
    };
}

/// Register values that control the motor; positions in the shaft's own ticks, before sign and offset.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotorDrive {
    pub(super) torque_on: bool,
    pub(super) mode: u8,
    pub(super) goal_ticks: f64,
    pub(super) goal_velocity: f64,
    pub(super) goal_current_a: f64,
    pub(super) goal_pwm: f64,
    pub(super) pwm_limit: f64,
    pub(super) current_limit_a: f64,
    pub(super) profile_velocity: f64,
    pub(super) profile_acceleration: f64,
    pub(super) position_pid: [f64; 3],
    pub(super) velocity_pi: [f64; 2],
    pub(super) feedforward: [f64; 2],
    pub(super) supply_v: f64,
    pub(super) load_nm: f64,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Motor {
    pub(super) angle_rad: f64,
    pub(super) velocity_rad_s: f64,
    pub(super) current_a: f64,
    pub(super) pwm: f64,
    /// Set point of the profile, rad and rad/s.
    pub(super) wanted_rad: f64,
    pub(super) wanted_rad_s: f64,
    wanted_rad_s2: f64,
    integral: f64,
    error_before: f64,
}

impl Motor {
    /// Called when the torque is switched: the profile begins at the current position of the shaft.
    pub(super) const fn restart(&mut self) {
        self.wanted_rad = self.angle_rad;
        self.wanted_rad_s = 0.0;
        self.wanted_rad_s2 = 0.0;
        self.integral = 0.0;
        self.error_before = 0.0;
    }

    pub(super) fn step(&mut self, drive: &MotorDrive, plant: &Plant) {
        let volts = if drive.torque_on { self.control(drive, plant) } else { None };
        let Plant { resistance_ohm, torque_nm_per_a, back_emf_v_s_per_rad, inertia_kg_m2, friction_nm_s_per_rad } =
            *plant;
        let Some(volts) = volts else {
            self.pwm = 0.0;
            self.current_a = 0.0;
            self.turn(drive.load_nm, friction_nm_s_per_rad, inertia_kg_m2);
            return;
        };
        let free_a = (volts - back_emf_v_s_per_rad * self.velocity_rad_s) / resistance_ohm;
        let limit_a =
            if drive.mode == 5 { drive.current_limit_a.min(drive.goal_current_a.abs()) } else { drive.current_limit_a };
        if free_a.abs() > limit_a {
            let torque_nm = torque_nm_per_a * limit_a.copysign(free_a) + drive.load_nm;
            self.turn(torque_nm, friction_nm_s_per_rad, inertia_kg_m2);
            self.current_a = limit_a.copysign(free_a);
        } else {
            // The back EMF acts like friction; evaluating it at the end of the step keeps the integration stable.
            let braking = torque_nm_per_a * back_emf_v_s_per_rad / resistance_ohm;
            let torque_nm = torque_nm_per_a * volts / resistance_ohm + drive.load_nm;
            self.turn(torque_nm, friction_nm_s_per_rad + braking, inertia_kg_m2);
            self.current_a = (volts - back_emf_v_s_per_rad * self.velocity_rad_s) / resistance_ohm;
        }
    }

    fn turn(&mut self, torque_nm: f64, friction: f64, inertia: f64) {
        let step = STEP_S / inertia;
        self.velocity_rad_s = (self.velocity_rad_s + step * torque_nm) / (1.0 + step * friction);
        self.angle_rad += STEP_S * self.velocity_rad_s;
    }

    /// Returns the voltage on the motor.
    fn control(&mut self, drive: &MotorDrive, plant: &Plant) -> Option<f64> {
        let limit = drive.pwm_limit.min(if drive.mode == 16 { PWM_FULL } else { drive.goal_pwm.abs() });
        let pwm = match drive.mode {
            0 => {
                let current_a = drive.goal_current_a.clamp(-drive.current_limit_a, drive.current_limit_a);
                let volts = current_a * plant.resistance_ohm + plant.back_emf_v_s_per_rad * self.velocity_rad_s;
                volts / drive.supply_v * PWM_FULL
            }
            1 => self.velocity_control(drive),
            3..=5 => self.position_control(drive),
            16 => drive.goal_pwm,
            _ => return None,
        };
        self.pwm = pwm.clamp(-limit, limit);
        Some(self.pwm / PWM_FULL * drive.supply_v)
    }

    fn velocity_control(&mut self, drive: &MotorDrive) -> f64 {
        let goal_rad_s = drive.goal_velocity * VELOCITY_UNIT_RAD_S;
        let max = drive.profile_acceleration * ACCELERATION_UNIT_RAD_S2 * STEP_S;
        let change = goal_rad_s - self.wanted_rad_s;
        self.wanted_rad_s += if max > 0.0 { change.clamp(-max, max) } else { change };
        let error = (self.wanted_rad_s - self.velocity_rad_s) / VELOCITY_UNIT_RAD_S;
        let [p, i] = drive.velocity_pi;
        self.integral = (self.integral + error).clamp(-PWM_FULL * 65_536.0, PWM_FULL * 65_536.0);
        p / 128.0 * error + i / 65_536.0 * self.integral
    }

    fn position_control(&mut self, drive: &MotorDrive) -> f64 {
        self.follow_profile(drive);
        let error = (self.wanted_rad - self.angle_rad) / std::f64::consts::TAU * TICKS_PER_TURN;
        let slope = error - self.error_before;
        self.error_before = error;
        let [p, i, d] = drive.position_pid;
        let bound = if i > 0.0 { PWM_FULL * 65_536.0 / i } else { 0.0 };
        self.integral = (self.integral + error).clamp(-bound, bound);
        let [ff1, ff2] = drive.feedforward;
        let ahead = ff1 / 4.0 * self.wanted_rad_s / VELOCITY_UNIT_RAD_S / 128.0
            + ff2 / 4.0 * self.wanted_rad_s2 / ACCELERATION_UNIT_RAD_S2 / 128.0;
        p / 128.0 * error + i / 65_536.0 * self.integral + d / 16.0 * slope + ahead
    }

    /// A trapezoidal speed profile towards the goal; without limits, a jump.
    fn follow_profile(&mut self, drive: &MotorDrive) {
        let goal_rad = rad_from_ticks(drive.goal_ticks);
        let fastest = drive.profile_velocity * VELOCITY_UNIT_RAD_S;
        let acceleration = drive.profile_acceleration * ACCELERATION_UNIT_RAD_S2;
        if fastest <= 0.0 {
            self.wanted_rad = goal_rad;
            self.wanted_rad_s = 0.0;
            self.wanted_rad_s2 = 0.0;
            return;
        }
        let rest = goal_rad - self.wanted_rad;
        let before = self.wanted_rad_s;
        let mut speed = fastest.min(rest.abs() / STEP_S);
        if acceleration > 0.0 {
            // Limit the speed so that the motor can still stop in time, with a reserve of half a step for the discrete
            // time.
            speed = speed.min((2.0 * acceleration * (rest.abs() - 0.5 * STEP_S * before.abs()).max(0.0)).sqrt());
            let max = acceleration * STEP_S;
            let target = speed.copysign(rest);
            self.wanted_rad_s += (target - before).clamp(-max, max);
            if rest.abs() < max * STEP_S && self.wanted_rad_s.abs() <= 2.0 * max {
                self.wanted_rad = goal_rad;
                self.wanted_rad_s = 0.0;
            }
        } else {
            self.wanted_rad_s = speed.copysign(rest);
        }
        self.wanted_rad_s2 = (self.wanted_rad_s - before) / STEP_S;
        self.wanted_rad += STEP_S * self.wanted_rad_s;
    }

    /// Returns the position of the shaft, in its own ticks.
    pub(super) fn ticks(&self) -> f64 {
        ticks_from_rad(self.angle_rad)
    }
}
