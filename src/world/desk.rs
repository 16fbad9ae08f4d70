//! Desk devices that lead a simulated rig: a six-axis cap such as a `SpaceMouse` leads the right hand; pedals are
//! clutch and presence switch.
//!
//! The cap commands a velocity: its deflection (-1 to 1) times [`DeskSettings::speed_m_s`], in the workspace (x right,
//! y away, z up). Until it is touched, the simulated hand performs its task; from then on the hand is led by the cap,
//! until button 0 ends this. Button 1 marks the place under the tip in a scene where lumps are looked for. A cap that is lost or silent counts as released, and the hand stays where it is. Leading
//! from the screen takes precedence.

use nalgebra::Vector3;
use nima_devices::{
    CapReading, Health, PedalReading, Slot,
    hid::{CapDriver, Held, PedalDriver, PedalRoles},
};
use nima_machine::rig::{
    Act, Acts, DeskSettings, DeviceEvent, GUIDE_MAX_M, Healths, Inputs, Outputs, Rig, RigError, Roster, RosterEntry,
    SIDES, Side, Switches, Watch,
};

use super::Worlds;

/// Smaller deflections count as zero.
const TOUCH: f64 = 0.05;
/// Longest time step in which a deflection is integrated, s.
const STEP_MAX_S: f64 = 0.01;

/// A simulated rig with a cap and pedals.
pub struct Desk {
    worlds: Worlds,
    cap: Option<(Slot<CapDriver>, Held<CapReading>)>,
    pedal: Option<(Slot<PedalDriver>, Held<PedalReading>, PedalRoles)>,
    speed_m_s: f64,
    /// What was done with its buttons, and whether the one that marks is down.
    acts: Acts,
    marking: bool,
    /// Position to which the cap leads the hand, m; `None` until it is touched.
    at_m: Option<Vector3<f64>>,
    hand_m: Vector3<f64>,
    last_s: Option<f64>,
    watch: Watch,
    outputs: [Outputs; SIDES],
}

impl Desk {
    /// Starts opening the devices in the settings.
    ///
    /// # Errors
    /// [`RigError`] if a setting is invalid or a thread cannot be created.
    pub fn start(settings: &DeskSettings, worlds: Worlds) -> Result<(Self, Roster), RigError> {
        let mut roster = Roster::new();
        let cap = settings.cap.clone().map(|cap| {
            let driver = format!("cap, {}", cap.source);
            let slot = Slot::start("cap", move || CapDriver::open(&cap))?;
            let view = slot.view();
            roster.push(RosterEntry::new("cap", driver, view));
            Ok::<_, RigError>((slot, Held::default()))
        });
        let cap = cap.transpose()?;
        let pedal = settings.pedal.clone().map(|pedal| {
            let setting = |trouble| RigError::Setting { device: "pedal".to_owned(), trouble };
            let roles = pedal.roles().map_err(setting)?;
            let driver = format!("foot pedal, {}", pedal.source);
            let slot = Slot::start("pedal", move || PedalDriver::open(&pedal))?;
            let view = slot.view();
            roster.push(RosterEntry::new("pedal", driver, view));
            Ok::<_, RigError>((slot, Held::default(), roles))
        });
        let pedal = pedal.transpose()?;
        let desk = Self {
            worlds,
            cap,
            pedal,
            speed_m_s: settings.speed_m_s,
            acts: Acts::NONE,
            marking: false,
            at_m: None,
            hand_m: Vector3::zeros(),
            last_s: None,
            watch: Watch::default(),
            outputs: [Outputs::SAFE; SIDES],
        };
        Ok((desk, roster))
    }

    /// Present position to which the cap leads the hand.
    fn lead(&mut self, now_s: f64) -> Option<Vector3<f64>> {
        let dt_s = self.last_s.replace(now_s).map_or(0.0, |last_s| (now_s - last_s).clamp(0.0, STEP_MAX_S));
        let (slot, held) = self.cap.as_mut()?;
        let reading = slot.poll(now_s);
        let cap = held.update(reading, slot.health());
        let marks = cap.buttons >> 1 & 1 == 1;
        if marks && !std::mem::replace(&mut self.marking, marks) {
            self.acts.note(Act::Mark);
        }
        self.marking = marks;
        if cap.buttons & 1 == 1 {
            self.at_m = None;
        } else if cap.translation.norm() > TOUCH {
            let at_m = self.at_m.unwrap_or(self.hand_m) + cap.translation * (self.speed_m_s * dt_s);
            self.at_m = Some(at_m.map(|x| x.clamp(-GUIDE_MAX_M, GUIDE_MAX_M)));
        }
        self.at_m
    }

    fn switches(&mut self, now_s: f64) -> Switches {
        let Some((slot, held, roles)) = &mut self.pedal else { return Switches::default() };
        let reading = slot.poll(now_s);
        let pressed = held.update(reading, slot.health());
        Switches { clutch: roles.clutch(pressed), presence: roles.presence(pressed) }
    }

    fn standings(&self) -> impl Iterator<Item = &Health> {
        let cap = self.cap.as_ref().map(|(slot, _)| slot.health());
        cap.into_iter().chain(self.pedal.as_ref().map(|(slot, ..)| slot.health()))
    }
}

impl Rig for Desk {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let (led_m, switches) = (self.lead(now_s), self.switches(now_s));
        let mut outputs = self.outputs;
        let right = &mut outputs[Side::Right.index()];
        right.guide_m = right.guide_m.or(led_m);
        right.acts = right.acts.and(self.acts);
        let mut watch = std::mem::take(&mut self.watch);
        for (device, health) in self.standings().enumerate() {
            watch.look(now_s, device, health.standing, [false; SIDES]);
        }
        self.watch = watch;
        self.worlds.write(now_s, &outputs);
        let mut inputs = self.worlds.read(now_s);
        for input in inputs.iter_mut().flatten() {
            input.switches = switches;
        }
        if let Some(right) = &inputs[Side::Right.index()] {
            self.hand_m = right.hand.position_m;
        }
        inputs
    }

    fn write(&mut self, _: f64, outputs: &[Outputs; SIDES]) {
        self.outputs = *outputs;
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

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::time::{Duration, Instant};

    use nima_devices::hid::{CapSettings, PedalSettings};

    use nima_testing::real_time::judged;

    use super::*;
    use crate::{
        emulators::hid::{CapBody, CapModel, PedalBody, PedalModel, cap, pedal},
        scene::Scene,
    };

    #[test]
    fn a_cap_leads_the_hand_and_a_pedal_is_the_clutch() {
        judged(|| {
            let push = CapReading { translation: Vector3::new(0.5, 0.0, 0.0), ..CapReading::default() };
            // Released for a while, then pushed to the right.
            let cap = cap(
                None,
                CapModel::default(),
                CapBody::moved_by(move |t_s| if t_s > 1.0 { push } else { CapReading::default() }),
            )
            .serve()
            .unwrap();
            let pedal = pedal(
                None,
                PedalModel::default(),
                PedalBody::pressed_by(|t_s| PedalReading { pressed: u32::from(t_s > 1.0) }),
            )
            .serve()
            .unwrap();
            let source = |endpoint: &str| {
                if endpoint.starts_with("emulated:") { endpoint.to_owned() } else { format!("emulated:{endpoint}") }
            };
            let settings = DeskSettings {
                cap: Some(CapSettings { source: source(&cap.endpoint), ..CapSettings::default() }),
                pedal: Some(PedalSettings { source: source(&pedal.endpoint), ..PedalSettings::default() }),
                speed_m_s: 0.06,
            };
            let worlds = Worlds::new(&Scene::load("free_motion").unwrap(), 1000.0);
            let (mut desk, roster) = Desk::start(&settings, worlds).unwrap();
            assert_eq!(roster.len(), 2);
            let begin = Instant::now();
            let (mut first_m, mut led_s, mut clutched) = (None, 0.0, false);
            while begin.elapsed() < Duration::from_secs(6) && led_s < 0.8 {
                let now_s = begin.elapsed().as_secs_f64();
                let outputs = Outputs { tip_command_m: Some(desk.hand_m), ..Outputs::SAFE };
                desk.write(now_s, &[outputs; SIDES]);
                let inputs = desk.read(now_s);
                clutched |= inputs[0].is_some_and(|inputs| inputs.switches.clutch);
                if let Some(at_m) = desk.at_m {
                    let (from_s, from_m): (f64, Vector3<f64>) = *first_m.get_or_insert((now_s, at_m));
                    led_s = now_s - from_s;
                    // Half deflection: 30 mm/s to the right, no motion along the other axes.
                    let way_m = at_m - from_m;
                    assert!(way_m.y.abs() < 1e-9 && (way_m.x - 0.03 * led_s).abs() < 6e-3, "{way_m} after {led_s} s");
                }
                std::thread::sleep(Duration::from_millis(1));
            }
            assert!(led_s >= 0.8 && clutched, "led for {led_s} s, clutch {clutched}");
        });
    }
}
