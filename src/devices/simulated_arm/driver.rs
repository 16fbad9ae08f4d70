use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use nima_core::kinematics::ArmModel;

use super::SimulatedArmSettings;
use crate::{
    ARM_JOINTS, ArmReading, Device, DeviceError, DeviceIdentity, Follower, Health, Lever, TimedReading,
    kinova::limits::Guard,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SimulatedArmMode {
    Resting,
    Servoing,
    Braking,
}

#[derive(Debug)]
pub struct SimulatedArmDriver {
    omega_rad_s: f64,
    joint_rad: [f64; ARM_JOINTS],
    joint_rad_s: [f64; ARM_JOINTS],
    guard: Guard,
    mode: SimulatedArmMode,
    last_s: Option<f64>,
    pulled: Arc<AtomicBool>,
    health: Health,
    identity: DeviceIdentity,
}

impl SimulatedArmDriver {
    /// Opens an arm at rest.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for a value outside its range.
    pub fn open(settings: &SimulatedArmSettings, model: &ArmModel) -> Result<Self, DeviceError> {
        settings.check(model)?;
        let mut guard = Guard::new(settings.joint_limits(model));
        guard.seed(&settings.start_rad);
        Ok(Self {
            omega_rad_s: settings.omega_rad_s(),
            joint_rad: settings.start_rad,
            joint_rad_s: [0.0; ARM_JOINTS],
            guard,
            mode: SimulatedArmMode::Resting,
            last_s: None,
            pulled: Arc::default(),
            health: Health::opening(),
            identity: DeviceIdentity { product: "simulated arm".to_owned(), ..DeviceIdentity::default() },
        })
    }

    fn advance(&mut self, elapsed_s: f64) {
        if elapsed_s <= 0.0 {
            return;
        }
        if self.mode != SimulatedArmMode::Resting {
            self.guard.step(elapsed_s);
        }
        let fraction = 1.0 - (-self.omega_rad_s * elapsed_s).exp();
        for ((at, speed), command) in self.joint_rad.iter_mut().zip(&mut self.joint_rad_s).zip(self.guard.command_rad())
        {
            let way = (command - *at) * fraction;
            *at += way;
            *speed = way / elapsed_s;
        }
        if self.mode == SimulatedArmMode::Braking && self.guard.is_still() {
            self.mode = SimulatedArmMode::Resting;
        }
    }
}

impl Device for SimulatedArmDriver {
    type Reading = ArmReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<ArmReading>> {
        if !now_s.is_finite() {
            return None;
        }
        if self.pulled.swap(false, Ordering::AcqRel) {
            self.leave_servoing();
        }
        let elapsed_s = self.last_s.replace(now_s).map_or(0.0, |last_s| now_s - last_s);
        self.advance(elapsed_s);
        self.health.accept(now_s);
        let value = ArmReading {
            joint_rad: self.joint_rad,
            joint_rad_s: self.joint_rad_s,
            joint_nm: [0.0; ARM_JOINTS],
            servoing: self.mode == SimulatedArmMode::Servoing,
        };
        Some(TimedReading { device_s: Some(now_s), arrival_s: now_s, value })
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.health, &self.identity)
    }
}

impl Follower for SimulatedArmDriver {
    fn enter_servoing(&mut self) {
        if self.mode == SimulatedArmMode::Resting {
            self.guard.seed(&self.joint_rad);
            self.mode = SimulatedArmMode::Servoing;
        }
    }

    fn leave_servoing(&mut self) {
        if self.mode == SimulatedArmMode::Servoing {
            self.guard.brake();
            self.mode = SimulatedArmMode::Braking;
        }
    }

    fn command_rad(&self) -> [f64; ARM_JOINTS] {
        *self.guard.command_rad()
    }

    fn aim(&mut self, target_rad: &[f64; ARM_JOINTS]) -> bool {
        let obeys = self.mode == SimulatedArmMode::Servoing && target_rad.iter().all(|rad| rad.is_finite());
        if !obeys {
            return false;
        }
        let taken = self.guard.aim(target_rad, &self.joint_rad).is_ok();
        if !taken {
            self.health.refused += 1;
            self.leave_servoing();
        }
        taken
    }

    fn attach(&self, lever: &Lever) {
        let pulled = Arc::clone(&self.pulled);
        lever.attach(move || pulled.store(true, Ordering::Release));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START_RAD: [f64; ARM_JOINTS] = [2.38, -1.34, -1.37, 1.91, -1.28, 1.68, 0.92];

    fn polled(arm: &mut SimulatedArmDriver, now_s: &mut f64, ticks: u32) -> ArmReading {
        let mut newest = None;
        for _ in 0..ticks {
            *now_s += 1e-3;
            newest = arm.poll(*now_s);
        }
        newest.unwrap().value
    }

    #[test]
    fn it_follows_what_it_is_asked_only_while_it_servoes() {
        let mut arm = SimulatedArmDriver::open(&SimulatedArmSettings::at(START_RAD), &ArmModel::GEN3).unwrap();
        let mut now_s = 0.0;
        let first = polled(&mut arm, &mut now_s, 1);
        assert_eq!((first.joint_rad, first.servoing), (START_RAD, false));
        assert!(!arm.aim(&START_RAD), "it rests");
        arm.enter_servoing();
        assert!(polled(&mut arm, &mut now_s, 1).servoing);
        // 0.1 rad/s in every joint, well below the limits; the lag is 1 / (2 pi 10 Hz).
        for tick in 1..=1000_u32 {
            assert!(arm.aim(&START_RAD.map(|rad| rad + 1e-4 * f64::from(tick))));
            polled(&mut arm, &mut now_s, 1);
        }
        let moving = polled(&mut arm, &mut now_s, 1);
        let behind_rad = START_RAD[0] + 0.1 - moving.joint_rad[0];
        assert!((behind_rad - 0.1 / (std::f64::consts::TAU * 10.0)).abs() < 3e-4, "{behind_rad}");
        arm.leave_servoing();
        let rested = polled(&mut arm, &mut now_s, 1000);
        assert!(!rested.servoing && rested.joint_rad_s.iter().all(|speed| speed.abs() < 1e-6));
        let held = polled(&mut arm, &mut now_s, 1).joint_rad;
        let apart_rad = held.iter().zip(arm.command_rad()).map(|(is, asked)| (is - asked).abs()).fold(0.0, f64::max);
        assert!(apart_rad < 1e-6, "{apart_rad}");
    }

    #[test]
    fn what_is_beyond_its_limits_is_refused_and_ends_servoing() {
        for bad in [START_RAD.map(|rad| rad + 1.0), START_RAD.map(|_| f64::NAN), [9.0; ARM_JOINTS]] {
            let mut arm = SimulatedArmDriver::open(&SimulatedArmSettings::at(START_RAD), &ArmModel::GEN3).unwrap();
            let mut now_s = 0.0;
            arm.enter_servoing();
            polled(&mut arm, &mut now_s, 1);
            assert!(!arm.aim(&bad), "{bad:?}");
            let later = polled(&mut arm, &mut now_s, 200);
            assert_eq!((later.joint_rad, later.servoing), (START_RAD, bad[0].is_nan()));
        }
    }

    #[test]
    fn its_lever_ends_servoing_from_another_thread() {
        let mut arm = SimulatedArmDriver::open(&SimulatedArmSettings::at(START_RAD), &ArmModel::GEN3).unwrap();
        let mut now_s = 0.0;
        let lever = Lever::default();
        Follower::attach(&arm, &lever);
        arm.enter_servoing();
        assert!(polled(&mut arm, &mut now_s, 1).servoing);
        std::thread::scope(|scope| scope.spawn(|| lever.pull()).join()).unwrap();
        assert!(!polled(&mut arm, &mut now_s, 1).servoing);
        assert!(!arm.aim(&START_RAD));
    }

    #[test]
    fn impossible_settings_are_told() {
        let report = |change: fn(&mut SimulatedArmSettings)| {
            let mut settings = SimulatedArmSettings::at(START_RAD);
            change(&mut settings);
            SimulatedArmDriver::open(&settings, &ArmModel::GEN3).unwrap_err().to_string()
        };
        assert!(report(|settings| settings.start_rad[1] = 2.3).contains("start_rad"));
        assert!(report(|settings| settings.start_rad[0] = f64::NAN).contains("start_rad"));
        assert!(report(|settings| settings.bandwidth_hz = 0.0).contains("bandwidth_hz"));
        assert!(report(|settings| settings.speed_fraction = f64::NAN).contains("speed_fraction"));
        assert!(report(|settings| settings.lead_rad = 0.3).contains("lead_rad"));
    }
}
