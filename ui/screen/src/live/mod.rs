//! The window's copy of the loop's state: updated from ticks and events, read by every panel, changed by none.

mod arms;
mod intake;

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use nalgebra::Vector3;
use nima_core::{
    impedance::{Mode, SLOTS},
    safety::ChainSettings,
    statistics::Percentiles,
};
use nima_devices::ConnectionState;
use nima_machine::{
    config::RigConfig,
    messages::{Command, Fault, LoopState, Refusal, Scheduling, Tick, Watchdog, attention},
    rig::{DEVICES_MAX, DeviceName, Gauges, Healths, Roster, SIDES, Side},
};
use nima_session::objects::ObjectStates;
use nima_simulation::{Training, scene::Scene};
use nima_words::{
    report_text::{loss_text, quoted, role_name},
    text,
};

use crate::{link::LineConnection, objects::training};

use crate::{
    activity::Activity,
    alarms::{MissingDevice, Signs},
    compare_cost::CompareCost,
    deadlines::Deadlines,
    degree_record::DegreeRecord,
    force_cloud::ForceCloud,
    history::SignalHistory,
    readings::{DisplayFigures, GateActivity, StateEntry},
    rolling::FadingMean,
    stiffness::ContactStiffness,
};

/// Period of the trend of errors, s; one point per second.
pub const TREND_S: usize = 180;
/// Number of marks stored.
const MARKS: usize = 100;
/// Duration of the tip's trail, s, and time between its points.
const TRAIL_S: f64 = 1.2;
const TRAIL_STEP_S: f64 = 0.02;
/// Figures are updated four times per second, so that they can be read.
const FIGURES_EVERY: Duration = Duration::from_millis(250);
/// The two large force readings are updated more often.
const READINGS_EVERY: Duration = Duration::from_millis(100);
/// Number of stored blocks of device readings, 0.1 s each.
const BLOCKS_KEPT: usize = 40;
/// Time for which a refused command is displayed.
const REFUSAL_SHOWN: Duration = Duration::from_secs(6);

/// Returns a link without data as a missing device, after the last one of the roster.
fn missing_line(line: &dyn LineConnection) -> Option<MissingDevice> {
    let [cause, cure] = line.trouble()?;
    let was_there = line.has_delivered();
    Some(MissingDevice { place: DEVICES_MAX, name: text::link::LINK.get().to_owned(), was_there, cause, cure })
}

/// Source of the displayed state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScreenSource {
    /// The running loop.
    Now,
    /// A moment of a recorded session: nothing may act on the machine.
    Past,
    /// A loop at another machine, which this console only shows.
    Elsewhere,
}

impl ScreenSource {
    /// Returns the reason why controls that act on a machine are off.
    pub fn blocked(self) -> &'static str {
        match self {
            Self::Elsewhere => text::monitor::BLOCKED.get(),
            Self::Now | Self::Past => text::playback::BLOCKED.get(),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefusedCommand {
    /// The side that refused it.
    pub side: Side,
    pub command: Command,
    pub why: Refusal,
}

/// The window's copy of the loop's state.
#[derive(Debug)]
pub struct LiveState {
    pub rig: RigConfig,
    pub scene: Scene,
    pub of: ScreenSource,
    /// The last report of the simulation about the objects of the scene.
    pub objects: Option<ObjectStates>,
    /// Progress of the scene's training task.
    pub training: Option<Training>,
    pub ticks: [Option<Tick>; SIDES],
    /// Forces over time, of each side.
    pub history: [SignalHistory; SIDES],
    /// Forces of the last seconds, of each side.
    pub clouds: [ForceCloud; SIDES],
    /// Marks set by the operator, s on the loop's clock, oldest first.
    pub marks_s: VecDeque<f64>,
    /// Polynomial degrees of the last minutes.
    pub degrees: DegreeRecord,
    pub compare_cost: CompareCost,
    /// Prediction error of each mode, N, one value per second, oldest first; NaN while the force was unknown.
    pub trend_n: VecDeque<[f64; SLOTS]>,
    /// Recent activity of each side's gates.
    pub gates: [GateActivity; SIDES],
    /// The last change of each side's state.
    pub changes: [Option<StateEntry>; SIDES],
    /// Stiffness of each side's current or last contact.
    pub stiffness: [ContactStiffness; SIDES],
    /// Smoothed figures for display.
    pub figures: DisplayFigures,
    /// Recent positions of each side's tip, m, oldest first.
    pub trails: [VecDeque<Vector3<f32>>; SIDES],
    /// Periods that the loop missed, per second.
    pub deadlines: Deadlines,
    /// Real-time privileges that the operating system granted.
    pub scheduling: Option<Scheduling>,
    /// Whether antialiasing in 3-D was switched off because this computer draws too slowly.
    pub rough_edges: bool,
    /// Change of the wrist sensor's bias since its calibration, N; `None` if it has not changed.
    pub bias_moved_n: Option<f64>,
    /// The arm of that sensor.
    pub bias_side: Option<Side>,
    /// The watchdog that the ready check is testing.
    pub tested: Option<Watchdog>,
    /// No ready check has passed on this rig today.
    pub is_unchecked: bool,
    /// Reason why the loop cannot be engaged now, for the hover text of the button; `None` if it can.
    pub engage_closed: Option<&'static str>,
    /// The devices of the rig; empty if everything is simulated.
    pub roster: Roster,
    /// Names of the devices and their states at the moment shown, if nothing may act on the devices.
    pub devices_then: Vec<(DeviceName, ConnectionState)>,
    /// Health of the devices, in the same order.
    pub healths: Healths,
    /// The link to the machine with the arm, if it is another machine.
    pub line: Option<Box<dyn LineConnection>>,
    /// Device readings of the last seconds, oldest first.
    pub blocks: VecDeque<Box<Gauges>>,
    /// Number of blocks since the loop started.
    pub blocks_counted: u64,
    pub activity: Activity,
    first_fault: Option<(f64, Fault)>,
    /// The arm of that fault.
    fault_side: Side,
    refusal: Option<(Instant, RefusedCommand)>,
    horizon: [FadingMean; SLOTS],
    measured: [FadingMean; SIDES],
    rendered: [FadingMean; SIDES],
    missed_fraction: FadingMean,
    frames: Percentiles,
    frame_work: FadingMean,
    wake: Percentiles,
    work: Percentiles,
    sample_to_force: Percentiles,
    trail_s: [f64; SIDES],
    ticks_counted: u64,
    figures_at: Instant,
    readings_at: Instant,
    tick_at: Instant,
    running: bool,
}

impl LiveState {
    pub fn new(rig: RigConfig, scene: Scene) -> Self {
        let now = Instant::now();
        Self {
            degrees: DegreeRecord::new(rig.rate_hz),
            compare_cost: CompareCost::default(),
            rig,
            scene,
            of: ScreenSource::Now,
            objects: None,
            training: None,
            ticks: [None; SIDES],
            history: Default::default(),
            clouds: Default::default(),
            marks_s: VecDeque::new(),
            gates: Default::default(),
            changes: [None; SIDES],
            stiffness: Default::default(),
            figures: DisplayFigures::default(),
            trails: Default::default(),
            deadlines: Deadlines::default(),
            scheduling: None,
            rough_edges: false,
            bias_moved_n: None,
            bias_side: None,
            tested: None,
            is_unchecked: false,
            engage_closed: None,
            roster: Roster::new(),
            line: None,
            devices_then: Vec::new(),
            healths: Healths::default(),
            blocks: VecDeque::with_capacity(BLOCKS_KEPT + 1),
            blocks_counted: 0,
            activity: Activity::of(&[]),
            first_fault: None,
            fault_side: Side::Right,
            refusal: None,
            trend_n: VecDeque::with_capacity(TREND_S + 1),
            horizon: [FadingMean::default(); SLOTS],
            measured: Default::default(),
            rendered: Default::default(),
            missed_fraction: FadingMean::default(),
            frames: Percentiles::new(),
            frame_work: FadingMean::default(),
            wake: Percentiles::new(),
            work: Percentiles::new(),
            sample_to_force: Percentiles::new(),
            trail_s: [f64::NEG_INFINITY; SIDES],
            ticks_counted: 0,
            figures_at: now,
            readings_at: now,
            tick_at: now,
            running: true,
        }
    }

    /// Creates the state of a recorded session before its first tick.
    pub fn of_past(rig: RigConfig, scene: Scene) -> Self {
        Self { of: ScreenSource::Past, ..Self::new(rig, scene) }
    }

    /// Creates the state of a loop on another machine before its first tick, without control.
    pub fn of_elsewhere(rig: RigConfig, scene: Scene) -> Self {
        let devices = rig.device_names();
        let devices_then = devices.into_iter().map(|name| (name, ConnectionState::Opening)).collect();
        Self { of: ScreenSource::Elsewhere, devices_then, ..Self::new(rig, scene) }
    }

    /// Returns whether nothing on the screen may act on a machine.
    pub fn is_shown_only(&self) -> bool {
        self.of != ScreenSource::Now
    }

    /// Records that a tick arrived at this time and waits to be read: the loop is not silent.
    pub fn received(&mut self, at: Instant) {
        self.tick_at = self.tick_at.max(at);
    }

    /// Returns the minimum time between redraws of moving parts, s: on a slow computer every second frame.
    pub const fn min_step_s(&self) -> f64 {
        if self.rough_edges { 1.0 / 15.0 } else { 0.0 }
    }

    /// Records the time since the last frame and its work (s).
    pub fn frame(&mut self, period_s: f64, work_s: Option<f64>) {
        self.frames.record(period_s);
        self.frame_work.push(work_s.unwrap_or(0.0) * 1e3, period_s, 1.0);
    }

    /// Returns the lateness of every wake-up of the loop since the window opened.
    pub const fn wake(&self) -> &Percentiles {
        &self.wake
    }

    /// Returns the work of every tick since the window opened.
    pub const fn work(&self) -> &Percentiles {
        &self.work
    }

    /// Returns the time from the arrival of a measurement to the output of the force computed from it.
    pub const fn sample_to_force(&self) -> &Percentiles {
        &self.sample_to_force
    }

    /// Sets a mark at the current time.
    pub fn mark(&mut self) {
        let Some(tick) = self.first_tick() else { return };
        let t_s = tick.t_s;
        self.marks_s.push_back(t_s);
        if self.marks_s.len() > MARKS {
            self.marks_s.pop_front();
        }
    }

    /// Shows these objects of the scene, with the progress of the task; none if unknown.
    pub fn show_objects(&mut self, objects: Option<ObjectStates>) {
        self.training = objects.as_ref().and_then(|objects| objects.task.as_ref()).map(training);
        self.objects = objects;
    }

    /// Like [`LiveState::show_objects`], if there are newer objects.
    pub fn show_newer_objects(&mut self, objects: Option<ObjectStates>) {
        if objects.is_some() {
            self.show_objects(objects);
        }
    }

    pub const fn tick_of(&self, side: Side) -> Option<&Tick> {
        self.ticks[side.index()].as_ref()
    }

    /// Returns the newest tick of the right arm pair, for data that both pairs share.
    pub const fn first_tick(&self) -> Option<&Tick> {
        self.tick_of(Side::Right)
    }

    /// Returns whether all modes are computed to compare them.
    pub fn compares(&self) -> bool {
        self.first_tick().is_some_and(|tick| Mode::ALL.into_iter().all(|mode| tick.identification.modes.contains(mode)))
    }

    /// Returns the last state of the loop; with two arm pairs, the state that needs more attention; idle before the
    /// first tick.
    pub fn state(&self) -> LoopState {
        let states = self.ticks.iter().flatten().map(|tick| tick.state);
        states.max_by_key(|state| attention(*state)).unwrap_or(LoopState::Idle)
    }

    /// Returns the fault that occurred first, while one is latched.
    pub fn first_fault(&self) -> Option<Fault> {
        self.first_fault.map(|(_, fault)| fault)
    }

    pub fn mode(&self) -> Mode {
        self.first_tick().map_or(self.rig.mode, |tick| tick.mode)
    }

    pub fn gain(&self) -> f64 {
        self.first_tick().map_or(self.rig.gates.gain, |tick| tick.gates.gain)
    }

    /// Returns the current delay, s.
    pub fn delay_s(&self) -> f64 {
        self.first_tick().map_or(self.rig.delay_s, |tick| tick.delay_s)
    }

    pub fn refusal(&self) -> Option<RefusedCommand> {
        self.refusal.filter(|(at, _)| at.elapsed() < REFUSAL_SHOWN).map(|(_, refused)| refused)
    }

    pub fn gate_settings(&self) -> ChainSettings {
        self.first_tick().map_or(self.rig.gates, |tick| tick.gates.settings)
    }

    /// Returns the required parts that do not deliver: the link to the other machine, then devices in the order of the
    /// roster.
    pub fn missing(&self) -> impl Iterator<Item = MissingDevice> {
        self.line.as_deref().and_then(missing_line).into_iter().chain(self.missing_devices())
    }

    fn missing_devices(&self) -> impl Iterator<Item = MissingDevice> {
        self.roster.iter().zip(&self.healths.devices).enumerate().filter_map(|(place, (entry, health))| {
            let was_there = match health.standing {
                ConnectionState::Connected | ConnectionState::Closed => return None,
                ConnectionState::Opening => false,
                ConnectionState::Lost(_) => true,
            };
            let (cause, cure) = match (entry.view.report().trouble, health.standing) {
                (Some(trouble), _) => (quoted(&trouble), trouble.cure()),
                (None, ConnectionState::Lost(loss)) => {
                    (loss_text(loss).to_owned(), text::alarms::DEVICE_MISSING_CURE.get().to_owned())
                }
                // The first attempt to open a device takes some time, so do not report it as missing yet.
                (None, _) => return None,
            };
            Some(MissingDevice { place, name: role_name(entry.role), was_there, cause, cure })
        })
    }

    /// Returns the input of the alarms.
    pub fn signs(&self, stop_is_stuck: bool, unrecorded: Option<String>) -> Signs {
        Signs {
            missing: self.missing().collect(),
            state: self.first_tick().map(|_| self.state()),
            first_fault: self.first_fault,
            fault_side: self.is_bimanual().then_some(self.fault_side),
            fault_device: self.fault_device(),
            tested: self.tested,
            running: self.running,
            silence: if self.is_shown_only() { Duration::ZERO } else { self.tick_at.elapsed() },
            missed_fraction: self.missed_fraction.get(),
            scheduling: self.scheduling,
            stop_is_stuck,
            bias_moved_n: self.bias_moved_n,
            bias_side: self.bias_side.filter(|_| self.is_bimanual()),
            is_unchecked: self.is_unchecked,
            question: self.line.as_ref().and_then(|line| line.question()),
            unrecorded,
        }
    }
}
