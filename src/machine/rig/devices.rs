//! The devices of a rig behind the interface that the loop uses: one [`ArmPair`] per side, and the devices that both
//! sides share.
//!
//! Input: the loop's outputs (m, N). Output: measurements in the workspace frame, with the age of the oldest part (s),
//! because the devices sample at their own clocks. Every device has a [`DeviceSlot`]: it may disconnect and reconnect at any
//! time, and is then connected but not engaged. Reading and writing neither wait nor allocate. A value that is lost,
//! refused or older than 20 ms is `None`; an old value is never repeated as a new one.

use std::io;

use nalgebra::Isometry3;
use nima_core::frames::from_roll_pitch_yaw_deg;
use nima_devices::{
    ConnectionState, Device, DeviceError, DeviceSlot, ForceSensor, Health, Lever, PedalReading, Switch, TimedReading,
    TrackedTool, Tracker, TrackerReading,
    hid::{self, HeldValue},
    ndi,
};

use super::{
    ArmPair, AwaitedDevice, DEVICES_MAX, DeviceEvent, DeviceWatch, EndoscopeSettings, EngageBlocker, Gauge, Gauges,
    Healths, Inputs, Outputs, Rig, RigPart, RigSettings, Roster, RosterEntry, SIDES, Side, Switches, ViewOrientation,
    arm_pair::SharedReadings, device_identity::DeviceIdentities, doubles::ReportedSerials, makes::Opener,
};

/// A reading older than this counts as missing, s. The same age as `SILENT_AFTER_S` of the loop: a force must not be
/// older for either reason.
pub(super) const OLDEST_S: f64 = 0.020;

/// All devices of a rig. Owned by the real-time thread.
#[derive(Debug)]
pub struct DeviceRig {
    pairs: [Option<Box<ArmPair>>; SIDES],
    tissue: Option<DeviceSlot<Box<dyn ForceSensor>>>,
    tissue_n: Option<TimedReading<nalgebra::Vector3<f64>>>,
    tracker: Option<DeviceSlot<Box<dyn Tracker>>>,
    endoscope: Option<EndoscopeSettings>,
    tracked: Option<TimedReading<TrackerReading>>,
    reported: ReportedSerials,
    /// The markers of both instruments have been compared with their expected poses.
    has_seen_markers: bool,
    pedal: Option<Pedal>,
    watch: DeviceWatch,
    /// Deliveries of tissue sensor, tracker and pedal since the last [`Rig::gauges`], and the start of that time, s.
    gauges: [Gauge; 3],
    gauged_s: f64,
    period_s: f64,
}

impl Drop for DeviceRig {
    /// Closes all devices together: while one arm brakes, the other one must be served too.
    fn drop(&mut self) {
        self.pairs.iter_mut().flatten().for_each(|pair| pair.retire());
        self.tissue.iter_mut().for_each(DeviceSlot::retire);
        self.tracker.iter_mut().for_each(DeviceSlot::retire);
        self.pedal.iter_mut().for_each(|pedal| pedal.slot.retire());
    }
}

struct Pedal {
    slot: DeviceSlot<Box<dyn Switch>>,
    held: HeldValue<PedalReading>,
    roles: hid::PedalRoles,
}

impl std::fmt::Debug for Pedal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pedal").field("held", &self.held).finish_non_exhaustive()
    }
}

/// Reason why the devices of a rig cannot be set up.
#[derive(Debug, thiserror::Error)]
pub enum RigError {
    #[error("cannot start a thread for a device")]
    Thread(#[from] io::Error),
    #[error("rig file, {device}: {trouble}")]
    Setting {
        device: String,
        /// The fault of the setting.
        trouble: DeviceError,
    },
    #[error("rig file, {side} mount")]
    Mount { side: &'static str, source: nima_core::kinematics::ArmError },
    #[error("rig file, {side} rcm")]
    Rcm { side: &'static str, source: nima_core::kinematics::RcmError },
}

impl DeviceRig {
    /// Starts opening every device of these settings, for a loop of this period (s). `at_wrist`: whether the force
    /// sensor of each side is at the wrist.
    ///
    /// # Errors
    /// [`RigError`] if a setting is invalid or a thread cannot be created.
    pub fn start(settings: &RigSettings, period_s: f64, at_wrist: [bool; SIDES]) -> Result<(Self, Roster), RigError> {
        let mut roster = Roster::new();
        let known = DeviceIdentities::of(settings);
        let mut pairs = [None, None];
        for side in Side::ALL {
            if let Some(set) = settings.arm(side) {
                let pair =
                    ArmPair::start(side, set, period_s, at_wrist[side.index()], settings.ends, &known, &mut roster)?;
                pairs[side.index()] = Some(Box::new(pair));
            }
        }
        let at_follower = settings.ends.have_follower();
        let tissue = settings.tissue_sensor.as_ref().filter(|_| at_follower).map(|sensor| {
            let Opener { driver, mut open, .. } = sensor.opener();
            let known = known.clone();
            let slot =
                DeviceSlot::start(RigPart::TissueSensor.name(), move || known.admit(RigPart::TissueSensor, &mut open))?;
            enrol(&mut roster, RigPart::TissueSensor, driver, &slot);
            Ok::<_, io::Error>(slot)
        });
        let tracker = settings.tracker.clone().filter(|_| at_follower).map(|tracker| {
            let place = tracker.place();
            let open = move || ndi::NdiDriver::open(&tracker).map(|driver| Box::new(driver) as Box<dyn Tracker>);
            let slot = DeviceSlot::start(RigPart::Tracker.name(), open)?;
            enrol(&mut roster, RigPart::Tracker, format!("NDI tracker, {place}"), &slot);
            Ok::<_, io::Error>(slot)
        });
        let pedal = settings.pedal.clone().filter(|_| settings.ends.have_leader()).map(|pedal| {
            let setting = |trouble| RigError::Setting { device: "pedal".to_owned(), trouble };
            let roles = pedal.roles().map_err(setting)?;
            let place = pedal.source.clone();
            let open = move || hid::PedalDriver::open(&pedal).map(|driver| Box::new(driver) as Box<dyn Switch>);
            let slot = DeviceSlot::start(RigPart::Pedal.name(), open)?;
            enrol(&mut roster, RigPart::Pedal, format!("foot pedal, {place}"), &slot);
            Ok::<_, RigError>(Pedal { slot, held: HeldValue::default(), roles })
        });
        let rig = Self {
            pairs,
            tissue: tissue.transpose()?,
            tissue_n: None,
            tracker: tracker.transpose()?,
            endoscope: settings.endoscope,
            tracked: None,
            reported: known.reported().clone(),
            has_seen_markers: false,
            pedal: pedal.transpose()?,
            watch: DeviceWatch::default(),
            gauges: [Gauge::NONE; 3],
            gauged_s: 0.0,
            period_s,
        };
        Ok((rig, roster))
    }

    fn poll_shared(&mut self, now_s: f64) -> Switches {
        let [of_tissue, of_tracker, of_pedal] = &mut self.gauges;
        if let Some(reading) = self.tissue.as_mut().and_then(|slot| slot.poll(now_s)) {
            of_tissue.sensor(&reading.value);
            let usable = reading.value.status.is_usable();
            self.tissue_n = usable.then_some(TimedReading {
                device_s: reading.device_s,
                arrival_s: reading.arrival_s,
                value: reading.value.wrench.force_n,
            });
        }
        if let Some(reading) = self.tracker.as_mut().and_then(|slot| slot.poll(now_s)) {
            of_tracker.tracker(&reading.value);
            self.tracked = Some(reading);
        }
        let ticked = [self.tissue.as_ref().map(DeviceSlot::health), self.tracker.as_ref().map(DeviceSlot::health)];
        for (gauge, health) in [of_tissue, of_tracker].into_iter().zip(ticked) {
            if let Some(health) = health {
                gauge.tick(health, now_s, self.period_s);
            }
        }
        let Some(pedal) = &mut self.pedal else { return Switches::default() };
        let reading = pedal.slot.poll(now_s);
        let pressed = pedal.held.update(reading, pedal.slot.health());
        // The pedal sends only changes: record its state in every tick.
        of_pedal.pedal(pressed);
        of_pedal.tick(pedal.slot.health(), now_s, self.period_s);
        // A disconnected pedal must not report the presence of a hand.
        Switches { clutch: pedal.roles.clutch(pressed), presence: pedal.roles.presence(pressed) }
    }

    /// Returns readings of the shared devices for this side.
    fn shared(&self, side: Side, now_s: f64) -> SharedReadings {
        /// The tracker sends 60 frames a second; allow six frames.
        const TRACKED_S: f64 = 0.1;
        let tissue_n =
            self.tissue_n.filter(|stamped| now_s - stamped.arrival_s <= OLDEST_S).map(|stamped| stamped.value);
        let tracked = self.tracked.filter(|stamped| now_s - stamped.arrival_s <= TRACKED_S);
        let c_from = |tool: usize| match tracked?.value.tools.get(tool)? {
            TrackedTool::Seen { c_from_tool, position_in_c_m, .. } => {
                Some(Isometry3::from_parts((*position_in_c_m).into(), *c_from_tool))
            }
            _ => None,
        };
        let c_from_n = self.endoscope.and_then(|endoscope| c_from(endoscope.tool));
        let c_from_view = self.endoscope.map_or(ViewOrientation::Fixed, |endoscope| {
            let n_from_view = from_roll_pitch_yaw_deg(&endoscope.n_from_view_deg);
            c_from_n.map_or(ViewOrientation::Unseen, |c_from_n| ViewOrientation::Seen(c_from_n.rotation * n_from_view))
        });
        SharedReadings { tissue_n, c_from_m: c_from(side.index()), c_from_view, c_from_n }
    }

    /// Compares each arm, while its drives are off, with the other arm's settings to detect swapped devices.
    fn look_for_exchanges(&mut self, shared: &[SharedReadings; SIDES]) {
        let [Some(right), Some(left)] = &mut self.pairs else { return };
        let [of_right, of_left] = shared.each_ref().map(|shared| shared.c_from_m);
        let (Some(on_right), Some(on_left)) = (right.shown(of_right), left.shown(of_left)) else { return };
        self.has_seen_markers |= on_right.is_marked() && on_left.is_marked();
        if self.endoscope.is_some() && !self.has_seen_markers {
            right.wait_for(AwaitedDevice::Markers);
            left.wait_for(AwaitedDevice::Markers);
        }
        if let Some(exchange) = on_right.exchange(&on_left) {
            right.object(EngageBlocker::Exchanged(exchange));
        }
        if let Some(exchange) = on_left.exchange(&on_right) {
            left.object(EngageBlocker::Exchanged(exchange));
        }
    }

    fn each_health(&self, mut each: impl FnMut(&Health, [bool; SIDES])) {
        for side in Side::ALL {
            if let Some(pair) = &self.pairs[side.index()] {
                let of_side = Side::ALL.map(|other| other == side);
                for (health, on_force_path) in pair.healths().into_iter().flatten() {
                    each(health, of_side.map(|of| of && on_force_path));
                }
            }
        }
        let shared = [
            self.tissue.as_ref().map(DeviceSlot::health),
            self.tracker.as_ref().map(DeviceSlot::health),
            self.pedal.as_ref().map(|pedal| pedal.slot.health()),
        ];
        shared.into_iter().flatten().for_each(|health| each(health, [false; SIDES]));
    }
}

impl Rig for DeviceRig {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let switches = self.poll_shared(now_s);
        let shared = Side::ALL.map(|side| self.shared(side, now_s));
        self.pairs.iter_mut().flatten().for_each(|pair| pair.poll(now_s));
        self.look_for_exchanges(&shared);
        if let Some(obstacle) = self.reported.obstacle() {
            self.pairs.iter_mut().flatten().for_each(|pair| pair.object(obstacle));
        }
        let mut inputs = [None; SIDES];
        for ((pair, shared), inputs) in self.pairs.iter().zip(&shared).zip(&mut inputs) {
            *inputs = pair.as_ref().and_then(|pair| pair.inputs(now_s, shared));
            *inputs = inputs.map(|inputs| Inputs { switches, ..inputs });
        }
        join_sides(&mut inputs);
        let mut watch = std::mem::take(&mut self.watch);
        let mut device = 0;
        self.each_health(|health, of_side| {
            watch.look(now_s, device, health.standing, of_side);
            device += 1;
        });
        self.watch = watch;
        inputs
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        for (pair, outputs) in self.pairs.iter_mut().zip(outputs) {
            if let Some(pair) = pair {
                pair.write(now_s, outputs);
            }
        }
    }

    fn event(&mut self) -> Option<DeviceEvent> {
        self.watch.take()
    }

    fn levers(&self) -> Vec<Lever> {
        self.pairs.iter().flatten().flat_map(|pair| pair.levers().clone()).collect()
    }

    fn health(&self) -> Healths {
        let mut healths = Healths::default();
        let mut place = 0;
        self.each_health(|health, _| {
            if let Some(entry) = healths.devices.get_mut(place) {
                *entry = *health;
            }
            place += 1;
        });
        healths.obstacles = self.pairs.each_ref().map(|pair| pair.as_ref().and_then(|pair| pair.obstacle()));
        healths
    }

    fn gauges(&mut self, now_s: f64) -> Option<Gauges> {
        let from_s = std::mem::replace(&mut self.gauged_s, now_s);
        let mut gauges = Gauges { from_s, to_s: now_s, devices: [Gauge::NONE; DEVICES_MAX] };
        let mut places = gauges.devices.iter_mut();
        let mut put = |gauge: Gauge| {
            if let Some(place) = places.next() {
                *place = gauge;
            }
        };
        for pair in self.pairs.iter_mut().flatten() {
            pair.take_gauges().into_iter().flatten().for_each(&mut put);
        }
        let there = [self.tissue.is_some(), self.tracker.is_some(), self.pedal.is_some()];
        let shared = std::mem::replace(&mut self.gauges, [Gauge::NONE; 3]);
        shared.into_iter().zip(there).filter(|(_, there)| *there).for_each(|(gauge, _)| put(gauge));
        Some(gauges)
    }
}

/// Adds the other side's poses to each side, because they reveal a swapped arm or marker.
fn join_sides(inputs: &mut [Option<Inputs>; SIDES]) {
    let frames = inputs.map(|inputs| inputs.map(|inputs| inputs.frames));
    for side in Side::ALL {
        if let (Some(inputs), Some(other)) = (&mut inputs[side.index()], frames[side.other().index()]) {
            inputs.frames.other_base_from_flange = other.base_from_flange;
            inputs.frames.c_from_other_m = other.c_from_m;
        }
    }
}

/// Adds a device to the roster.
pub(super) fn enrol<D: Device + 'static>(roster: &mut Roster, part: RigPart, driver: String, slot: &DeviceSlot<D>) {
    debug_assert!(roster.len() < DEVICES_MAX, "more devices than places");
    roster.push(RosterEntry::of(part, driver, slot.view()));
}

pub(super) fn is_there<D: Device + 'static>(slot: &DeviceSlot<D>) -> bool {
    slot.health().standing == ConnectionState::Connected
}
