//! The state of the loop as known to the window: updated from ticks and events, read by every panel, changed by none.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use nalgebra::Vector3;
use nima_core::{
    impedance::{MODES, Mode},
    safety::ChainSettings,
    statistics::{Percentiles, Quantiles},
};
use nima_devices::Standing;
use nima_machine::{
    config::RigConfig,
    messages::{Command, Event, Fault, LoopState, Refusal, Scheduling, Tick, attention},
    rig::{Healths, Roster, SIDES, Side},
};
use nima_world::scene::Scene;

use super::{
    alarms::{Missing, Signs},
    cloud::Cloud,
    deadlines::Deadlines,
    door::{Door, News},
    history::{CHANNELS, History},
    readings::{Change, Figures, Gates},
    rolling::{DegreeShares, Fading},
    stiffness::ContactStiffness,
    text,
};

/// Period of the degree histograms, s.
pub const DEGREES_S: f64 = 120.0;
/// Period of the trend of errors, s; one point per second.
pub const TREND_S: usize = 180;
/// Number of marks stored.
const MARKS: usize = 100;
/// Duration of the tip's trail, s, and time between its points.
const TRAIL_S: f64 = 1.2;
const TRAIL_STEP_S: f64 = 0.02;
/// Figures are updated four times a second, so that they can be read.
const FIGURES_EVERY: Duration = Duration::from_millis(250);
/// The two large force readings are updated more often.
const READINGS_EVERY: Duration = Duration::from_millis(100);
/// How long a refused command is displayed.
const REFUSAL_SHOWN: Duration = Duration::from_secs(6);

/// A command that was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refused {
    /// The side that refused it.
    pub side: Side,
    /// The command.
    pub command: Command,
    /// The reason.
    pub why: Refusal,
}

/// The state of the loop as known to the window.
#[derive(Debug)]
pub struct Live {
    /// The rig.
    pub rig: RigConfig,
    /// The scene.
    pub scene: Scene,
    /// Newest tick of each side.
    pub ticks: [Option<Tick>; SIDES],
    /// Forces over time, of each side.
    pub history: [History; SIDES],
    /// Forces of the last seconds, of each side.
    pub clouds: [Cloud; SIDES],
    /// Marks set by the operator, s on the loop's clock, oldest first.
    pub marks_s: VecDeque<f64>,
    /// Polynomial degrees chosen by the identification.
    pub degrees: DegreeShares,
    /// Degrees that the paper's in-window rule would choose.
    pub paper_degrees: DegreeShares,
    /// Error of each mode at the horizon, N, one value per second, oldest first.
    pub trend_n: VecDeque<[f64; MODES]>,
    /// Recent activity of each side's gates.
    pub gates: [Gates; SIDES],
    /// The last change of each side's state.
    pub changes: [Option<Change>; SIDES],
    /// Stiffness of each side's present or last contact.
    pub stiffness: [ContactStiffness; SIDES],
    /// Smoothed figures for display.
    pub figures: Figures,
    /// Recent positions of each side's tip, m, oldest first.
    pub trails: [VecDeque<Vector3<f32>>; SIDES],
    /// Periods that the loop missed, per second.
    pub deadlines: Deadlines,
    /// Real-time privileges that the operating system granted.
    pub scheduling: Option<Scheduling>,
    /// Antialiasing in 3-D was switched off because this computer draws too slowly.
    pub rough_edges: bool,
    /// Change of the wrist sensor's bias since its calibration, N; `None` if it has not changed.
    pub bias_moved_n: Option<f64>,
    /// The devices of the rig; empty if everything is simulated.
    pub roster: Roster,
    /// Health of the devices, in the same order.
    pub healths: Healths,
    first_fault: Option<(f64, Fault)>,
    refusal: Option<(Instant, Refused)>,
    horizon: [Fading; MODES],
    measured: [Fading; SIDES],
    rendered: [Fading; SIDES],
    missed_share: Fading,
    frames: Percentiles,
    frame_work: Fading,
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

impl Live {
    /// Before the first tick.
    pub fn new(rig: RigConfig, scene: Scene) -> Self {
        let ticks = (DEGREES_S * rig.rate_hz) as usize;
        let now = Instant::now();
        Self {
            rig,
            scene,
            ticks: [None; SIDES],
            history: Default::default(),
            clouds: Default::default(),
            marks_s: VecDeque::new(),
            degrees: DegreeShares::new(ticks),
            paper_degrees: DegreeShares::new(ticks),
            gates: Default::default(),
            changes: [None; SIDES],
            stiffness: Default::default(),
            figures: Figures::default(),
            trails: Default::default(),
            deadlines: Deadlines::default(),
            scheduling: None,
            rough_edges: false,
            bias_moved_n: None,
            roster: Roster::new(),
            healths: Healths::default(),
            first_fault: None,
            refusal: None,
            trend_n: VecDeque::with_capacity(TREND_S + 1),
            horizon: [Fading::default(); 4],
            measured: Default::default(),
            rendered: Default::default(),
            missed_share: Fading::default(),
            frames: Percentiles::new(),
            frame_work: Fading::default(),
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

    /// Reads everything that the loop has sent; `each` is called with every tick.
    pub fn take_in(&mut self, door: &Door, mut each: impl FnMut(&Tick)) {
        let handle = door.handle();
        if self.roster.len() != handle.roster().len() {
            self.roster.clone_from(handle.roster());
        }
        if let Some(healths) = handle.healths() {
            self.healths = healths;
        }
        let mut came = false;
        door.take(|news| {
            let tick = match news {
                News::Event(event) => return self.event(event),
                News::Tick(tick) => tick,
            };
            self.tick(tick);
            each(tick);
            came = true;
        });
        if came {
            self.tick_at = Instant::now();
        }
        self.running = handle.is_running();
        self.refresh_figures();
    }

    /// Records that a tick arrived at this moment and waits to be read: the loop is not silent.
    pub fn heard(&mut self, at: Instant) {
        self.tick_at = self.tick_at.max(at);
    }

    /// Least time between redrawing moving parts, s: on a slow computer every second frame.
    pub const fn least_step_s(&self) -> f64 {
        if self.rough_edges { 1.0 / 15.0 } else { 0.0 }
    }

    /// Records the time since the last frame and its work (s).
    pub fn frame(&mut self, period_s: f64, work_s: Option<f64>) {
        self.frames.record(period_s);
        self.frame_work.push(work_s.unwrap_or(0.0) * 1e3, period_s, 1.0);
    }

    /// Lateness of every wake-up of the loop since the window opened.
    pub const fn wake(&self) -> &Percentiles {
        &self.wake
    }

    /// Work of every tick since the window opened.
    pub const fn work(&self) -> &Percentiles {
        &self.work
    }

    /// Time from the arrival of a measurement until the force computed from it was given to the device.
    pub const fn sample_to_force(&self) -> &Percentiles {
        &self.sample_to_force
    }

    /// Sets a mark at the present time.
    pub fn mark(&mut self) {
        let Some(tick) = self.first_tick() else { return };
        let t_s = tick.t_s;
        self.marks_s.push_back(t_s);
        if self.marks_s.len() > MARKS {
            self.marks_s.pop_front();
        }
    }

    /// Newest tick of this side.
    pub const fn tick_of(&self, side: Side) -> Option<&Tick> {
        self.ticks[side.index()].as_ref()
    }

    /// Newest tick of the right arm pair, used for everything that is common to both.
    pub const fn first_tick(&self) -> Option<&Tick> {
        self.tick_of(Side::Right)
    }

    /// The arm pairs of the loop; the right one always exists.
    pub fn sides(&self) -> impl Iterator<Item = Side> {
        Side::ALL.into_iter().filter(|&side| side == Side::Right || self.is_bimanual())
    }

    /// Whether there are two arm pairs.
    pub const fn is_bimanual(&self) -> bool {
        self.scene.left.is_some() || self.tick_of(Side::Left).is_some()
    }

    /// Last state of the loop; with two arm pairs the one that needs more attention; idle before the first tick.
    pub fn state(&self) -> LoopState {
        let states = self.ticks.iter().flatten().map(|tick| tick.state);
        states.max_by_key(|state| attention(*state)).unwrap_or(LoopState::Idle)
    }

    /// Present mode.
    pub fn mode(&self) -> Mode {
        self.first_tick().map_or(self.rig.mode, |tick| tick.mode)
    }

    /// Present gain.
    pub fn gain(&self) -> f64 {
        self.first_tick().map_or(self.rig.gates.gain, |tick| tick.gates.gain)
    }

    /// Present delay, s.
    pub fn delay_s(&self) -> f64 {
        self.first_tick().map_or(self.rig.delay_s, |tick| tick.delay_s)
    }

    /// The last refused command, for some seconds.
    pub fn refusal(&self) -> Option<Refused> {
        self.refusal.filter(|(at, _)| at.elapsed() < REFUSAL_SHOWN).map(|(_, refused)| refused)
    }

    /// Present settings of the gates.
    pub fn gate_settings(&self) -> ChainSettings {
        self.first_tick().map_or(self.rig.gates, |tick| tick.gate_settings)
    }

    /// Stiffness of the stiffer of both hands' present or last contacts, N/m: the gain is common to both.
    pub fn stiffness_n_m(&self) -> Option<f64> {
        self.stiffness.iter().filter_map(ContactStiffness::n_m).max_by(f64::total_cmp)
    }

    /// Devices that are wanted and do not deliver, in the order of the roster.
    pub fn missing(&self) -> impl Iterator<Item = Missing> {
        self.roster.iter().zip(&self.healths.devices).enumerate().filter_map(|(place, (entry, health))| {
            let was_there = match health.standing {
                Standing::Connected | Standing::Closed => return None,
                Standing::Opening => false,
                Standing::Lost(_) => true,
            };
            let (cause, cure) = match (entry.view.report().trouble, health.standing) {
                (Some(trouble), _) => (trouble.to_string(), trouble.cure()),
                (None, Standing::Lost(loss)) => (loss.cause().to_owned(), text::alarms::DEVICE_MISSING_CURE.to_owned()),
                // The first attempt to open a device takes some time.
                (None, _) => return None,
            };
            Some(Missing { place, name: entry.name.clone(), was_there, cause, cure })
        })
    }

    /// The data from which alarms are determined.
    pub fn signs(&self, stop_is_stuck: bool) -> Signs {
        Signs {
            missing: self.missing().collect(),
            state: self.first_tick().map(|_| self.state()),
            first_fault: self.first_fault,
            running: self.running,
            silence: self.tick_at.elapsed(),
            missed_share: self.missed_share.get(),
            scheduling: self.scheduling,
            stop_is_stuck,
            bias_moved_n: self.bias_moved_n,
        }
    }

    fn event(&mut self, event: &Event) {
        match *event {
            Event::FaultRaised { t_s, fault, .. } => {
                self.first_fault.get_or_insert((t_s, fault));
            }
            Event::StateChanged { t_s, side, from, to, why } => {
                self.changes[side.index()] = Some(Change { t_s, from, why });
                if !matches!(to, LoopState::Faulted(_)) {
                    self.first_fault = None;
                }
            }
            Event::CommandRefused { side, command, why, .. } => {
                self.refusal = Some((Instant::now(), Refused { side, command, why }));
            }
            Event::Scheduling(scheduling) => self.scheduling = Some(scheduling),
            Event::Device(event) => {
                if let Some(health) = self.healths.devices.get_mut(usize::from(event.device)) {
                    health.standing = event.standing;
                }
            }
        }
    }

    fn tick(&mut self, tick: &Tick) {
        let before = self.ticks[tick.side.index()].replace(*tick);
        self.follow(tick, before.as_ref());
        if tick.side == Side::Right {
            self.follow_loop(tick, before.as_ref());
        }
    }

    /// Updates what is common to both sides: timing, and the identification of the first.
    fn follow_loop(&mut self, tick: &Tick, before: Option<&Tick>) {
        let dt_s = before.map_or(0.0, |before| (tick.t_s - before.t_s).max(0.0));
        let missed = before.map_or(0, |before| tick.missed.saturating_sub(before.missed));
        self.deadlines.push(tick.t_s, missed);
        self.missed_share.push(missed as f64 / (missed as f64 + 1.0), dt_s, 3.0);
        self.degrees.push(tick.identification.degree);
        self.paper_degrees.push(tick.identification.paper_degree);
        if before.is_some_and(|before| before.t_s.floor() < tick.t_s.floor()) {
            self.trend_n.push_back(tick.identification.horizon_error_n);
            if self.trend_n.len() > TREND_S {
                self.trend_n.pop_front();
            }
        }
        for (mean, error_n) in self.horizon.iter_mut().zip(tick.identification.horizon_error_n) {
            mean.push(error_n, dt_s, 4.0);
        }
        self.wake.record(tick.wake_s);
        self.work.record(tick.work_s);
        if let Some(seconds) = tick.sample_to_force_s {
            self.sample_to_force.record(seconds);
        }
        self.ticks_counted += 1;
    }

    /// Updates what is stored for each side: forces and trail of the tip.
    fn follow(&mut self, tick: &Tick, before: Option<&Tick>) {
        let (side, dt_s) = (tick.side.index(), before.map_or(0.0, |before| (tick.t_s - before.t_s).max(0.0)));
        let (m, r) = (tick.measured_n, tick.rendered_n);
        let values: [f32; CHANNELS] = [m.x, m.y, m.z, r.x, r.y, r.z].map(|x| x as f32);
        self.history[side].push(tick.t_s, &values);
        self.measured[side].push(m.norm(), dt_s, 0.05);
        self.rendered[side].push(r.norm(), dt_s, 0.05);
        self.gates[side].push(tick, dt_s);
        self.clouds[side].push(tick.t_s, m, r);
        self.stiffness[side].push(tick.t_s, &tick.tip_m, &m);
        if tick.t_s - self.trail_s[side] >= TRAIL_STEP_S && tick.tip_m.iter().all(|x| x.is_finite()) {
            self.trail_s[side] = tick.t_s;
            self.trails[side].push_back(tick.tip_m.cast());
            if self.trails[side].len() > (TRAIL_S / TRAIL_STEP_S) as usize {
                self.trails[side].pop_front();
            }
        }
    }

    fn refresh_figures(&mut self) {
        if self.readings_at.elapsed() >= READINGS_EVERY {
            self.figures.measured_n = self.measured.map(Fading::get);
            self.figures.rendered_n = self.rendered.map(Fading::get);
            self.readings_at = Instant::now();
        }
        let since = self.figures_at.elapsed();
        if since < FIGURES_EVERY {
            return;
        }
        self.figures = Figures {
            horizon_n: self.horizon.map(Fading::get),
            wake_us: self.wake.quantiles(),
            work_us: self.work.quantiles(),
            sample_to_force_us: self.sample_to_force.quantiles(),
            rate_hz: self.ticks_counted as f64 / since.as_secs_f64(),
            frame_ms: {
                let Quantiles { p50, p99, .. } = self.frames.quantiles();
                [p50 * 1e-3, p99 * 1e-3]
            },
            frame_work_ms: self.frame_work.get(),
            ..self.figures
        };
        self.ticks_counted = 0;
        self.figures_at = Instant::now();
    }
}
