//! One hand, one handle, one follower in tissue, and the loop between them: the test bench of the studies `release`,
//! `passivity` and `stability_map`.
//!
//! The parts of the loop are the real ones (identifier, link, tracking, renderer, gates); hand, handle and follower are
//! models. SI units, workspace frame (z up, tissue at rest at z = 0), 1 kHz. Deterministic for a seed. Unlike in the
//! simulated world of the scenes, the hand can open here and release the handle. Ticks arrive at the times of the
//! trial's clock; between ticks, hand, handle and follower move for the true time, with the last force and command
//! held. As in the loop, identification, rendering and lag get evenly spaced values: each deadline that has passed gets
//! the value interpolated between two ticks.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use nima_core::{
    impedance::{Identifier, ImpedanceSettings, Mode, ModeSet, OwnMotion, Recipe, Renderer, Sample, SettingsError},
    noise::Noise,
    safety::{ChainSettings, ForceRequest, GateReport, SafetyChain},
    signal::Speed,
};
use nima_machine::{
    runtime::{TickTimes, VirtualClock},
    teleop::{
        Link as _, ProgrammedLink, Timing, TrackingLag,
        even::{Between, deadlines, stacked},
    },
};
use nima_simulation::{Tissue, scene::TissueModel as TissueConfig};

/// Ticks per second.
pub(super) const RATE_HZ: f64 = 1000.0;
/// Integration steps of the equation of motion per period.
const SUBSTEPS: u32 = 4;
/// An interval that exceeds a period by less than this fraction counts as one period, because times are rounded.
const ROUNDING_PERIODS: f64 = 1e-6;
/// Speed at which Coulomb friction reaches nearly its full value, m/s.
const RUBS_M_S: f64 = 0.002;
/// Values of the scenes: noise of the force sensor (N), resolution of the handle's position (m), natural frequency (Hz)
/// and maximum speed (m/s) of the follower.
pub(super) const NOISE_N: f64 = 0.02;
const RESOLUTION_M: f64 = 1e-5;
const FOLLOWER_HZ: f64 = 12.0;
const FOLLOWER_M_S: f64 = 0.3;

/// The handle without a hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoneHandle {
    /// Apparent mass at the grip, kg.
    pub(super) kg: f64,
    /// Damping of the handle's bearings and cables, N s/m, and their Coulomb friction, N.
    pub(super) n_s_m: f64,
    pub(super) coulomb_n: f64,
}

impl LoneHandle {
    /// Approximately an omega.7's.
    pub(super) const OMEGA: Self = Self { kg: 0.25, n_s_m: 0.5, coulomb_n: 0.0 };
}

/// The gripping hand with the handle.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairGrip {
    pub(super) kg: f64,
    pub(super) n_m: f64,
    pub(super) n_s_m: f64,
}

impl PairGrip {
    /// The grip of the scenes.
    pub(super) const FIRM: Self = Self { kg: 0.35, n_m: 900.0, n_s_m: 18.0 };

    /// Creates a grip of this stiffness (N/m) with the same damping ratio.
    pub(super) fn of_stiffness(n_m: f64) -> Self {
        let Self { kg, n_m: firm_n_m, n_s_m } = Self::FIRM;
        Self { kg, n_m, n_s_m: n_s_m * (n_m / firm_n_m).sqrt() }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct PairTrial {
    pub(super) mode: Mode,
    pub(super) own_motion: OwnMotion,
    /// Interpretation of the paper for the modes literal and linear.
    pub(super) literal: Recipe,
    pub(super) delay_s: f64,
    pub(super) gates: ChainSettings,
    pub(super) gain: f64,
    pub(super) tissue: TissueConfig,
    /// Amplitude of the hand's tremor, m.
    pub(super) tremor_m: f64,
    /// Noise of the force sensor, N.
    pub(super) noise_n: f64,
    pub(super) handle: LoneHandle,
    pub(super) grip: PairGrip,
    pub(super) seed: u64,
    /// Times of the loop's ticks.
    pub(super) clock: VirtualClock,
}

#[derive(Debug)]
pub(super) struct BenchPair {
    trial: PairTrial,
    times: TickTimes,
    now_s: f64,
    handle_m: Vector3<f64>,
    handle_m_s: Vector3<f64>,
    /// Whether the hand grips the handle.
    gripped: bool,
    tremor_phase: [[f64; 3]; 3],
    tip_m: Vector3<f64>,
    tip_m_s: Vector3<f64>,
    command_m: Vector3<f64>,
    tissue: Tissue,
    noise: Noise,
    identifier: Identifier,
    link: ProgrammedLink,
    tracking: TrackingLag,
    renderer: Renderer,
    /// Tip (m) and its force (N), command, handle and tip (m) of the last tick, for interpolation.
    measured: Between<6>,
    led: Between<9>,
    /// The rendered force at the newest deadline, N.
    asked_n: Option<Vector3<f64>>,
    chain: SafetyChain,
    speed: Speed<3>,
    speed_m_s: f64,
    tip_n: Vector3<f64>,
    force_n: Vector3<f64>,
    report: GateReport,
}

impl BenchPair {
    /// Creates a bench at rest at this position (m).
    pub(super) fn new(trial: &PairTrial, position_m: Vector3<f64>) -> Result<Self, SettingsError> {
        let settings = ImpedanceSettings {
            rate_hz: RATE_HZ,
            delay_s: trial.delay_s,
            modes: ModeSet::only(trial.mode),
            literal: trial.literal,
            own_motion: trial.own_motion,
            ..ImpedanceSettings::default()
        };
        let mut noise = Noise::new(trial.seed);
        let tremor_phase = std::array::from_fn(|_| std::array::from_fn(|_| TAU * noise.uniform()));
        let mut chain = SafetyChain::new(trial.gates, 1.0 / RATE_HZ);
        chain.set_gain_above_one(trial.gain);
        let mut times = trial.clock.tick_times(RATE_HZ);
        let now_s = times.advance().now_s;
        Ok(Self {
            trial: *trial,
            times,
            now_s,
            handle_m: position_m,
            handle_m_s: Vector3::zeros(),
            gripped: true,
            tremor_phase,
            tip_m: position_m,
            tip_m_s: Vector3::zeros(),
            command_m: position_m,
            tissue: Tissue::new(trial.tissue),
            noise,
            identifier: Identifier::new(&settings)?,
            link: ProgrammedLink::new(RATE_HZ, trial.delay_s),
            tracking: TrackingLag::new(RATE_HZ, false),
            renderer: Renderer::new(&settings)?,
            measured: Between::default(),
            led: Between::default(),
            asked_n: None,
            chain,
            speed: Speed::new(RESOLUTION_M, RATE_HZ),
            speed_m_s: 0.0,
            tip_n: Vector3::zeros(),
            force_n: Vector3::zeros(),
            report: GateReport::default(),
        })
    }

    /// Returns the time of the last tick, s; about 0 at the beginning.
    pub(super) const fn now_s(&self) -> f64 {
        self.now_s
    }

    pub(super) const fn handle_m(&self) -> Vector3<f64> {
        self.handle_m
    }

    pub(super) const fn handle_m_s(&self) -> Vector3<f64> {
        self.handle_m_s
    }

    /// Returns the force on the handle, N.
    pub(super) const fn force_n(&self) -> Vector3<f64> {
        self.force_n
    }

    /// Returns the force of the tissue on the tip without the sensor's noise, N.
    pub(super) const fn tip_n(&self) -> Vector3<f64> {
        self.tip_n
    }

    /// Returns the effect of the gates in the last tick.
    pub(super) const fn report(&self) -> &GateReport {
        &self.report
    }

    /// Opens the hand: its stiffness, damping and mass no longer act on the handle.
    pub(super) const fn let_go(&mut self) {
        self.gripped = false;
    }

    /// Replaces the tissue; the tip must be outside both.
    pub(super) fn exchange_tissue(&mut self, tissue: TissueConfig) {
        self.tissue = Tissue::new(tissue);
    }

    /// Runs one tick. `intended_m` returns the hand's intended position (m) at a time (s). It is called with rising
    /// times up to the time of the tick, at most a period apart, and with the time since the previous call (s).
    pub(super) fn step(&mut self, mut intended_m: impl FnMut(f64, f64) -> Vector3<f64>) {
        let timing = Timing::from(self.times.advance());
        let now_s = timing.now_s;
        let before_s = std::mem::replace(&mut self.now_s, now_s);
        let pieces = ((now_s - before_s) * RATE_HZ - ROUNDING_PERIODS).ceil().max(1.0);
        let piece_s = (now_s - before_s) / pieces;
        for piece in 1..=pieces as u32 {
            let t_s = before_s + piece_s * f64::from(piece);
            let intended_m = intended_m(t_s, piece_s) + self.tremor(t_s);
            self.move_handle(&intended_m, piece_s);
            self.follow(piece_s);
        }
        self.tip_n = self.tissue.contact_n(&self.tip_m, &self.tip_m_s);
        let noise = &mut self.noise;
        let noise_n = self.trial.noise_n;
        let force_n = self.tip_n + Vector3::from_fn(|_, _| noise_n * noise.gaussian());
        self.identify(&force_n, &timing);
        let read_m = self.handle_m.map(|x| (x / RESOLUTION_M).round() * RESOLUTION_M);
        self.speed_m_s = self.speed.step(now_s, read_m);
        self.command(&read_m, now_s - before_s);
        self.render(&read_m, &timing);
        let parcel = self.link.receive(now_s);
        let age_s = parcel.map_or(f64::INFINITY, |parcel| now_s - parcel.t_s - self.trial.delay_s);
        self.force_n = self.gated(self.asked_n, age_s, read_m);
    }

    fn identify(&mut self, force_n: &Vector3<f64>, timing: &Timing) {
        let now = (timing.now_s, stacked([&self.tip_m, force_n]));
        for t_s in deadlines(timing, 1.0 / RATE_HZ) {
            let at = self.measured.at(t_s, now);
            let [position_m, force_n] = [0, 3].map(|from| at.fixed_rows::<3>(from).into_owned());
            self.identifier.step(&Sample { t_s, position_m, force_n });
            self.link.send(self.identifier.parcel());
        }
        self.measured.keep(now);
    }

    fn render(&mut self, read_m: &Vector3<f64>, timing: &Timing) {
        let now = (timing.now_s, stacked([&self.command_m, read_m, &self.tip_m]));
        for t_s in deadlines(timing, 1.0 / RATE_HZ) {
            let at = self.led.at(t_s, now);
            let [command_m, handle_m, tip_m] = [0, 3, 6].map(|from| at.fixed_rows::<3>(from).into_owned());
            let follower_m = self.tracking.step(&command_m, &tip_m, 0);
            let motion_m = match self.trial.own_motion {
                OwnMotion::Follower => follower_m,
                OwnMotion::Handle => handle_m,
            };
            self.asked_n = self.renderer.step(&motion_m, self.link.receive(t_s)).force(self.trial.mode);
        }
        self.led.keep(now);
    }

    fn gated(&mut self, asked_n: Option<Vector3<f64>>, age_s: f64, hand_m: Vector3<f64>) -> Vector3<f64> {
        let speed_m_s = self.speed_m_s;
        let (force_n, report) = self.chain.step(&ForceRequest {
            t_s: self.now_s,
            force_n: asked_n,
            age_s,
            speed_m_s,
            hand_m: Some(hand_m),
            hand_age_s: 0.0,
            permitted: true,
        });
        self.report = report;
        force_n
    }

    fn move_handle(&mut self, intended_m: &Vector3<f64>, for_s: f64) {
        let dt_s = for_s / f64::from(SUBSTEPS);
        let handle = self.trial.handle;
        let grip = self.trial.grip;
        let (mass_kg, stiffness_n_m, friction_n_s_m) =
            if self.gripped { (grip.kg, grip.n_m, grip.n_s_m) } else { (handle.kg, 0.0, handle.n_s_m) };
        for _ in 0..SUBSTEPS {
            let hand_n = (intended_m - self.handle_m) * stiffness_n_m - self.handle_m_s * friction_n_s_m;
            let rubbed_n = self.handle_m_s * (handle.coulomb_n / self.handle_m_s.norm().max(RUBS_M_S));
            self.handle_m_s += (hand_n - rubbed_n + self.force_n) * (dt_s / mass_kg);
            self.handle_m += self.handle_m_s * dt_s;
        }
    }

    /// The follower: critically damped second order, exact for a constant command.
    fn follow(&mut self, dt_s: f64) {
        let omega = TAU * FOLLOWER_HZ;
        let offset_m = self.tip_m - self.command_m;
        let decay = (-omega * dt_s).exp();
        let slope_m_s = self.tip_m_s + offset_m * omega;
        self.tip_m = self.command_m + (offset_m + slope_m_s * dt_s) * decay;
        self.tip_m_s = (self.tip_m_s - slope_m_s * (omega * dt_s)) * decay;
    }

    fn command(&mut self, read_m: &Vector3<f64>, passed_s: f64) {
        let travel_m = read_m - self.command_m;
        let max_m = FOLLOWER_M_S * passed_s;
        self.command_m += travel_m * (max_m / travel_m.norm().max(max_m));
    }

    fn tremor(&self, now_s: f64) -> Vector3<f64> {
        const TREMOR_HZ: [f64; 3] = [8.3, 9.7, 11.6];
        let amplitude_m = self.trial.tremor_m / 3.0_f64.sqrt();
        Vector3::from_fn(|axis, _| {
            let waves = TREMOR_HZ.iter().zip(&self.tremor_phase[axis]);
            amplitude_m * waves.map(|(hz, phase)| (TAU * hz * now_s + phase).sin()).sum::<f64>()
        })
    }
}
