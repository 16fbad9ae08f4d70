//! One side's devices: handle, arm, force sensor, servos; and the kinematics between the loop's metres and their joints.

use nalgebra::{UnitQuaternion, Vector3};

use super::{ArmSet, OLDEST_S, RigError, enrol, is_there, jaws::JawsControl};
use crate::{
    device::{
        ArmReading, ClearFaults, ForceReading, HandleReading, Health, Inputs, Lever, Outputs, Roster, SERVOS, Sensed,
        ServoReading, Side, Slot, Stamped, Switches, View, bota, dynamixel,
        force_dimension::{self, HandleEvent},
        kinova,
    },
    frames::{WristSample, from_roll_pitch_yaw_deg},
    kinematics::{Arm, Hand, Inverse, Jaws, Joints, Pose, Rcm, StartError, kbf_from_tracked_view},
};

/// Why an arm that delivers cannot be engaged.
pub type Obstacle = StartError;

/// What both sides share.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shared {
    pub(super) tissue_n: Option<Vector3<f64>>,
    pub(super) m_from_c: Option<UnitQuaternion<f64>>,
    /// How the endoscope looks, in the camera's frame: `c_from_view`.
    pub(super) c_from_view: View,
}

/// Gives the device that was enrolled last its way to clear faults.
fn clears(roster: &mut Roster, command: impl Fn() + Send + Sync + 'static) {
    if let Some(entry) = roster.last_mut() {
        entry.clear_faults = Some(ClearFaults::by(command));
    }
}

/// The devices of one side.
#[derive(Debug)]
pub struct ArmPair {
    levers: [Lever; 2],
    handle: Slot<force_dimension::Driver>,
    arm: Slot<kinova::Driver>,
    sensor: Slot<bota::Driver>,
    servos: Option<(Slot<dynamixel::Driver>, JawsControl)>,
    hand: Option<Stamped<HandleReading>>,
    joints: Option<Stamped<ArmReading>>,
    force: Option<Stamped<ForceReading>>,
    turned: Option<Stamped<ServoReading>>,
    mount: Arm,
    rcm: Rcm,
    s1_from_m: Option<UnitQuaternion<f64>>,
    at_wrist: bool,
    period_s: f64,
    /// Where the arm is by its joints.
    pose: Option<Pose>,
    inverse: Option<Inverse>,
    obstacle: Option<Obstacle>,
    /// Drives were permitted in the last tick.
    driven: bool,
    force_is_on: bool,
}

impl ArmPair {
    pub(super) fn start(
        side: Side,
        set: &ArmSet,
        period_s: f64,
        at_wrist: bool,
        roster: &mut Roster,
    ) -> Result<Self, RigError> {
        let word = side.word();
        let mount = Arm::new(&set.mount).map_err(|source| RigError::Mount { side: word, source })?;
        let rcm = Rcm::new(&set.rcm).map_err(|source| RigError::Rcm { side: word, source })?;
        let ArmSet { handle, arm, sensor, servos, .. } = set.clone();
        let which = handle.serial.map_or_else(|| "any".to_owned(), |serial| serial.to_string());
        let places = [which, arm.host.clone(), sensor.port.clone()];
        let names = ["handle", "arm", "sensor"].map(|device| format!("{word} {device}"));
        let levers = [Lever::default(), Lever::default()];
        let [of_handle, of_arm] = levers.clone();
        let handle = Slot::start(&names[0], move || {
            force_dimension::open(&handle).inspect(|driver| of_handle.attach(driver.lever()))
        })?;
        enrol(roster, &names[0], format!("Force Dimension omega.7, {}", places[0]), &handle);
        let clearing = kinova::FaultClearing::default();
        let of_opening = clearing.clone();
        let arm = Slot::start(&names[1], move || {
            kinova::open_clearing(&arm, &of_opening).inspect(|driver| {
                if let Ok(lever) = driver.lever() {
                    of_arm.attach(lever);
                }
            })
        })?;
        enrol(roster, &names[1], format!("Kinova Gen3, {}", places[1]), &arm);
        clears(roster, move || clearing.command());
        let sensor = Slot::start(&names[2], move || bota::Driver::open(&sensor))?;
        enrol(roster, &names[2], format!("Bota sensor, {}", places[2]), &sensor);
        let servos = servos.map(|settings| {
            let name = format!("{word} servos");
            let place = settings.port.clone();
            let reboots = dynamixel::Reboots::default();
            let of_opening = reboots.clone();
            let slot = Slot::start(&name, move || dynamixel::open_with(&settings, &of_opening))?;
            enrol(roster, &name, format!("DYNAMIXEL servos, {place}"), &slot);
            clears(roster, move || (0..SERVOS).for_each(|servo| reboots.ask(servo)));
            Ok::<_, std::io::Error>((slot, JawsControl::new(set.jaws, period_s)))
        });
        Ok(Self {
            levers,
            handle,
            arm,
            sensor,
            servos: servos.transpose()?,
            hand: None,
            joints: None,
            force: None,
            turned: None,
            mount,
            rcm,
            s1_from_m: set.s1_from_m_deg.as_ref().map(from_roll_pitch_yaw_deg),
            at_wrist,
            period_s,
            pose: None,
            inverse: None,
            obstacle: None,
            driven: false,
            force_is_on: false,
        })
    }

    /// Takes in what has arrived.
    pub(super) fn poll(&mut self, now_s: f64) {
        if let Some(reading) = self.handle.poll(now_s) {
            self.hand = Some(reading);
        }
        if let Some(reading) = self.arm.poll(now_s) {
            self.pose = Some(self.mount.pose(&Joints::from(reading.value.joint_rad)));
            self.joints = Some(reading);
        }
        if let Some(reading) = self.sensor.poll(now_s) {
            self.force = Some(reading).filter(|reading| reading.value.status.is_usable());
        }
        if let Some((slot, _)) = &mut self.servos
            && let Some(reading) = slot.poll(now_s)
        {
            self.turned = Some(reading);
        }
        let mut on = self.force_is_on && is_there(&self.handle);
        if let Some(handle) = self.handle.device() {
            while let Some(event) = handle.take_event() {
                on = event == HandleEvent::ForceOn;
            }
        }
        self.force_is_on = on;
        if !self.driven {
            self.obstacle = self.begin().err();
        }
    }

    /// The inverse kinematics from where the arm is.
    fn begin(&self) -> Result<Option<Inverse>, StartError> {
        let Some(joints) = &self.joints else { return Ok(None) };
        Inverse::new(self.mount, self.rcm, self.period_s, &Joints::from(joints.value.joint_rad)).map(Some)
    }

    /// The measurements, if every device of the force path delivers and none of them is too old.
    pub(super) fn inputs(&self, now_s: f64, shared: &Shared) -> Option<Inputs> {
        let (hand, joints, force) = (self.hand?, self.joints?, self.force?);
        let pose = self.pose.as_ref()?;
        let age_s = [hand.arrival_s, joints.arrival_s, force.arrival_s].map(|at_s| now_s - at_s);
        let age_s = age_s.into_iter().fold(0.0, f64::max);
        let there = is_there(&self.handle) && is_there(&self.arm) && is_there(&self.sensor);
        if !there || age_s > OLDEST_S {
            return None;
        }
        let HandleReading { position_m, orientation, gripper_rad, .. } = hand.value;
        let kbf_from_s1 = pose.orientation();
        let jaws = self.measured_jaws();
        Some(Inputs {
            hand: Hand { position_m, orientation },
            gripper_rad,
            grip_n: self.servos.as_ref().zip(self.turned).and_then(|((_, jaws), turned)| jaws.grip_n(&turned.value)),
            tip_m: pose.tip_m,
            kbf_from_jaws: jaws.map(|jaws| kbf_from_s1 * jaws.s1_from_jaws()),
            sensed: self.sensed(&force.value, pose, &kbf_from_s1, shared),
            view: self.view(&kbf_from_s1, shared),
            switches: Switches::default(),
            powered: self.force_is_on && joints.value.servoing && self.obstacle.is_none(),
            age_s,
        })
    }

    fn view(&self, kbf_from_s1: &UnitQuaternion<f64>, shared: &Shared) -> View {
        let View::Seen(c_from_view) = shared.c_from_view else { return shared.c_from_view };
        self.s1_from_m.zip(shared.m_from_c).map_or(View::Unseen, |(s1_from_m, m_from_c)| {
            View::Seen(kbf_from_tracked_view(&(kbf_from_s1 * s1_from_m), &m_from_c, &c_from_view))
        })
    }

    fn measured_jaws(&self) -> Option<Jaws> {
        let ((slot, control), turned) = (self.servos.as_ref()?, self.turned.as_ref()?);
        is_there(slot).then(|| control.measured(&turned.value))
    }

    fn sensed(&self, force: &ForceReading, pose: &Pose, kbf_from_s1: &UnitQuaternion<f64>, shared: &Shared) -> Sensed {
        if !self.at_wrist {
            return Sensed::AtTip(kbf_from_s1 * force.wrench.force_n);
        }
        Sensed::AtWrist(WristSample {
            raw: force.wrench,
            acceleration_m_s2: force.acceleration_m_s2,
            kbf_from_s1: Some(*kbf_from_s1),
            kbf_from_m: self.s1_from_m.map(|s1_from_m| kbf_from_s1 * s1_from_m),
            m_from_c: shared.m_from_c,
            insertion_m: Some(pose.insertion_m(&self.rcm.settings().trocar_m)),
            tissue_n: shared.tissue_n,
        })
    }

    /// Carries out what the loop commands.
    pub(super) fn apply(&mut self, now_s: f64, outputs: &Outputs) {
        if outputs.drives != self.driven {
            self.driven = outputs.drives;
            self.switch_drives(outputs.drives);
        }
        if outputs.drives
            && let Some(handle) = self.handle.device()
        {
            handle.set_force(outputs.hand_force_n, outputs.gripper_n);
        }
        self.lead(outputs.tip_command_m);
        self.turn(now_s, outputs.kbf_from_jaws);
    }

    /// On once, by command: what switches itself off stays off until the next engagement.
    fn switch_drives(&mut self, on: bool) {
        if let Some(arm) = self.arm.device() {
            if on {
                // A refusal shows in the readings: the arm does not servo.
                arm.enter_low_level().ok();
            } else {
                arm.stop();
                arm.leave_low_level();
            }
        }
        if let Some(handle) = self.handle.device() {
            if on { handle.enable_force() } else { handle.disable_force() }
        }
        if let Some((slot, control)) = &mut self.servos {
            control.reset();
            if let Some(servos) = slot.device() {
                servos.set_torque(on);
            }
        }
    }

    fn lead(&mut self, tip_command_m: Option<Vector3<f64>>) {
        let Some(target_m) = tip_command_m else {
            if self.inverse.take().is_some()
                && let Some(arm) = self.arm.device()
            {
                arm.stop();
            }
            return;
        };
        if self.inverse.is_none() {
            match self.begin() {
                Ok(inverse) => self.inverse = inverse,
                Err(obstacle) => self.obstacle = Some(obstacle),
            }
        }
        let (Some(inverse), Some(arm)) = (&mut self.inverse, self.arm.device()) else { return };
        let step = inverse.step(&target_m);
        arm.aim(step.joint_rad.as_ref()).ok();
    }

    fn turn(&mut self, now_s: f64, kbf_from_jaws: Option<UnitQuaternion<f64>>) {
        let (Some(kbf_from_jaws), Some(pose)) = (kbf_from_jaws, &self.pose) else { return };
        let Some(turned) = self.turned.filter(|turned| now_s - turned.arrival_s <= OLDEST_S) else { return };
        let gripper_rad = self.hand.and_then(|hand| hand.value.gripper_rad);
        let Some((slot, control)) = &mut self.servos else { return };
        let s1_from_jaws = pose.orientation().inverse() * kbf_from_jaws;
        let goals = control.goals(&s1_from_jaws, gripper_rad, &turned.value);
        if let Some(servos) = slot.device() {
            servos.set_goals(&goals);
        }
    }

    /// Of the handle and the arm.
    pub(super) const fn levers(&self) -> &[Lever; 2] {
        &self.levers
    }

    /// Why the arm cannot be engaged from where it is.
    pub(super) const fn obstacle(&self) -> Option<Obstacle> {
        self.obstacle
    }

    /// The devices in the order of the roster, and whether force depends on each.
    pub(super) fn healths(&self) -> [Option<(&Health, bool)>; 4] {
        [
            Some((self.handle.health(), true)),
            Some((self.arm.health(), true)),
            Some((self.sensor.health(), true)),
            self.servos.as_ref().map(|(slot, _)| (slot.health(), false)),
        ]
    }
}
