//! Desk devices for a simulated rig: a six-axis cap such as a `SpaceMouse`, or a haptic handle (`held`), leads the
//! right hand; pedals are clutch and presence switch.
//!
//! The cap commands a velocity: its deflection (-1 to 1) times [`DeskSettings::speed_m_s`], in the workspace (x right,
//! y away, z up). The simulated hand performs its task until the cap is touched; from then on the cap leads the hand,
//! until button 0 ends this. Button 1 marks the position under the tip in a palpation scene, and opens and closes the
//! jaws in a scene with rings; there the left hand waits while the right one is led, so that it takes no ring away. A
//! cap that is lost or silent counts as released, and the hand stays where it is. Leading from the screen takes
//! precedence.

use nalgebra::Vector3;
use nima_devices::{
    CapReading, DeviceSlot, Health, Lever, PedalReading,
    hid::{CapDriver, HeldValue, PedalDriver, PedalRoles},
};
use nima_machine::rig::{
    Acts, DeskSettings, DeviceEvent, DeviceRole, DeviceWatch, GUIDE_MAX_M, Healths, Inputs, Outputs, Rig, RigError,
    RigPart, Roster, RosterEntry, SIDES, Side, Switches, TaskAction,
};

use super::{Worlds, haptic_input::HapticInput as HeldHandle};

/// Smaller deflections count as zero.
const TOUCH: f64 = 0.05;
/// Opening of the jaws by the button, rad. Jaws that are open by less than this fraction of it hold a ring, or nothing.
const OPEN_RAD: f64 = 0.6;
const OPEN_FRACTION: f64 = 0.8;
/// Maximum time step over which a deflection is integrated, s.
const STEP_MAX_S: f64 = 0.01;

pub struct InputDevices {
    worlds: Worlds,
    handle: Option<HeldHandle>,
    cap: Option<(DeviceSlot<CapDriver>, HeldValue<CapReading>)>,
    pedal: Option<(DeviceSlot<PedalDriver>, HeldValue<PedalReading>, PedalRoles)>,
    speed_m_s: f64,
    /// Actions done with the buttons, the opening at which they hold the jaws, rad, and whether the second button is
    /// down.
    acts: Acts,
    grip_rad: Option<f64>,
    is_down: bool,
    /// Position to which the cap guides the hand, m (`None` until it is touched), and where the left hand waits in the
    /// meantime.
    position_m: Option<Vector3<f64>>,
    left_m: Option<Vector3<f64>>,
    hands_m: [Vector3<f64>; SIDES],
    /// Opening of the right gripper, rad; `None` without jaws.
    gripper_rad: Option<f64>,
    last_s: Option<f64>,
    watch: DeviceWatch,
    outputs: [Outputs; SIDES],
}

impl InputDevices {
    /// Starts to open the devices in the settings.
    ///
    /// # Errors
    /// [`RigError`] if a setting is invalid or a thread cannot be created.
    pub fn start(settings: &DeskSettings, worlds: Worlds) -> Result<(Self, Roster), RigError> {
        let mut roster = Roster::new();
        let handle = settings.handle.as_ref().map(|handle| {
            let (handle, entry) = HeldHandle::start(handle)?;
            roster.push(entry);
            Ok::<_, RigError>(handle)
        });
        let handle = handle.transpose()?;
        let cap = settings.leading_cap().cloned().map(|cap| {
            let driver = format!("cap, {}", cap.source);
            let slot = DeviceSlot::start("cap", move || CapDriver::open(&cap))?;
            let view = slot.view();
            roster.push(RosterEntry::new(DeviceRole::Cap, driver, view));
            Ok::<_, RigError>((slot, HeldValue::default()))
        });
        let cap = cap.transpose()?;
        let pedal = settings.pedal.clone().map(|pedal| {
            let setting = |trouble| RigError::Setting { device: "pedal".to_owned(), trouble };
            let roles = pedal.roles().map_err(setting)?;
            let driver = format!("foot pedal, {}", pedal.source);
            let slot = DeviceSlot::start("pedal", move || PedalDriver::open(&pedal))?;
            let view = slot.view();
            roster.push(RosterEntry::new(DeviceRole::Part(RigPart::Pedal), driver, view));
            Ok::<_, RigError>((slot, HeldValue::default(), roles))
        });
        let pedal = pedal.transpose()?;
        let desk = Self {
            worlds,
            handle,
            cap,
            pedal,
            speed_m_s: settings.speed_m_s,
            acts: Acts::NONE,
            grip_rad: None,
            is_down: false,
            position_m: None,
            left_m: None,
            hands_m: [Vector3::zeros(); SIDES],
            gripper_rad: None,
            last_s: None,
            watch: DeviceWatch::default(),
            outputs: [Outputs::SAFE; SIDES],
        };
        Ok((desk, roster))
    }

    /// Returns the position to which the cap leads the hand, m; `None` until it is touched, and while its first button
    /// is down.
    pub const fn led_to_m(&self) -> Option<Vector3<f64>> {
        self.position_m
    }

    /// Updates and returns the position to which the cap leads the hand.
    fn lead(&mut self, now_s: f64) -> Option<Vector3<f64>> {
        let dt_s = self.last_s.replace(now_s).map_or(0.0, |last_s| (now_s - last_s).clamp(0.0, STEP_MAX_S));
        let (slot, held) = self.cap.as_mut()?;
        let reading = slot.poll(now_s);
        let cap = held.update(reading, slot.health());
        let is_down = cap.buttons >> 1 & 1 == 1;
        if is_down && !self.is_down {
            self.press();
        }
        self.is_down = is_down;
        if cap.buttons & 1 == 1 {
            self.position_m = None;
            self.grip_rad = None;
        } else if cap.translation.norm() > TOUCH {
            let position_m = self.position_m.unwrap_or(self.hands_m[Side::Right.index()]);
            let position_m = position_m + cap.translation * (self.speed_m_s * dt_s);
            self.position_m = Some(position_m.map(|x| x.clamp(-GUIDE_MAX_M, GUIDE_MAX_M)));
        }
        self.position_m
    }

    /// Handles the second button: it opens or closes jaws if there are any, and otherwise marks.
    fn press(&mut self) {
        let Some(gripper_rad) = self.gripper_rad else { return self.acts.note(TaskAction::Mark) };
        let is_open = self.grip_rad.unwrap_or(gripper_rad) > OPEN_FRACTION * OPEN_RAD;
        self.grip_rad = Some(if is_open { 0.0 } else { OPEN_RAD });
        // While its jaws are controlled by the user, the hand does not continue its own task.
        self.position_m.get_or_insert(self.hands_m[Side::Right.index()]);
    }

    /// Returns the loop's outputs with the led parts replaced, for the worlds.
    fn led(&mut self, led_m: Option<Vector3<f64>>) -> [Outputs; SIDES] {
        let left_m = self.left_m.unwrap_or(self.hands_m[Side::Left.index()]);
        self.left_m = led_m.and(self.gripper_rad).map(|_| left_m);
        let mut outputs = self.outputs;
        let [right, left] = &mut outputs;
        right.guide_m = right.guide_m.or(led_m);
        right.grip_rad = right.grip_rad.or(self.grip_rad);
        right.acts = right.acts.and(self.acts);
        left.guide_m = left.guide_m.or(self.left_m);
        outputs
    }

    fn switches(&mut self, now_s: f64) -> Switches {
        let Some((slot, held, roles)) = &mut self.pedal else { return Switches::default() };
        let reading = slot.poll(now_s);
        let pressed = held.update(reading, slot.health());
        Switches { clutch: roles.clutch(pressed), presence: roles.presence(pressed) }
    }

    fn standings(&self) -> impl Iterator<Item = &Health> {
        let handle = self.handle.as_ref().map(HeldHandle::health);
        let cap = self.cap.as_ref().map(|(slot, _)| slot.health());
        handle.into_iter().chain(cap).chain(self.pedal.as_ref().map(|(slot, ..)| slot.health()))
    }
}

impl Rig for InputDevices {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let by_handle_m = self.handle.as_mut().and_then(|handle| handle.poll(now_s));
        let led_m = by_handle_m.or_else(|| self.lead(now_s));
        let switches = self.switches(now_s);
        let outputs = self.led(led_m);
        let mut watch = std::mem::take(&mut self.watch);
        for (device, health) in self.standings().enumerate() {
            let carries_force = self.handle.is_some() && device == 0;
            watch.look(now_s, device, health.standing, [carries_force, false]);
        }
        self.watch = watch;
        self.worlds.write(now_s, &outputs);
        let mut inputs = self.worlds.read(now_s);
        if let Some(handle) = &self.handle {
            let right = &mut inputs[Side::Right.index()];
            *right = right.as_ref().and_then(|inputs| handle.led(now_s, inputs));
        }
        for input in inputs.iter_mut().flatten() {
            input.switches = switches;
        }
        for (hand_m, input) in self.hands_m.iter_mut().zip(&inputs) {
            *hand_m = input.map_or(*hand_m, |input| input.hand.position_m);
        }
        self.gripper_rad = inputs[Side::Right.index()].and_then(|right| right.gripper_rad);
        inputs
    }

    fn write(&mut self, _: f64, outputs: &[Outputs; SIDES]) {
        self.outputs = *outputs;
        if let Some(handle) = &mut self.handle {
            handle.write(&outputs[Side::Right.index()]);
        }
    }

    fn levers(&self) -> Vec<Lever> {
        self.handle.iter().map(HeldHandle::lever).collect()
    }

    fn event(&mut self) -> Option<DeviceEvent> {
        self.watch.take()
    }

    fn health(&self) -> Healths {
        let mut healths = Healths::default();
        for (entry, health) in healths.devices.iter_mut().zip(self.standings()) {
            *entry = *health;
        }
        healths
    }
}
