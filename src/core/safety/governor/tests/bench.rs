//! A hand, a handle, a follower in tissue and a delay, on one axis at 1 kHz, behind the real chain: small enough for thousands of runs.
//! `study/pair.rs` has the same on three axes with the real modes.

use std::f64::consts::TAU;

use nalgebra::Vector1;

use crate::{
    noise::Noise,
    safety::{ChainSettings, ForceRequest, GateReport, SafetyChain},
    signal::Speed,
};

pub(super) const PERIOD_S: f64 = 1e-3;
const SUBSTEPS: u32 = 4;
/// The follower: natural frequency (Hz), maximum speed of commands (m/s), and the lag assumed by the leader (ticks).
const FOLLOWER_HZ: f64 = 12.0;
const FOLLOWER_M_S: f64 = 0.3;
const LAG_TICKS: usize = 26;
/// Longest delay, ticks.
const PAST: usize = 512;

/// Source of the force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Render {
    /// The delayed force of the tissue.
    Reflection,
    /// A model of the tissue, applied at the follower's position as estimated by the leader.
    Model,
    /// A spring at the handle itself.
    Spring,
}

/// A person and a handle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Person {
    /// Mass of hand and handle (kg), stiffness and damping of the grip (N/m, N s/m), and tremor (m).
    pub(super) mass_kg: f64,
    pub(super) grip_n_m: f64,
    pub(super) grip_n_s_m: f64,
    pub(super) tremor_m: f64,
    /// The handle without a hand: mass, viscous and Coulomb friction, step of its reading.
    pub(super) handle_kg: f64,
    pub(super) handle_n_s_m: f64,
    pub(super) coulomb_n: f64,
    pub(super) count_m: f64,
}

impl Person {
    pub(super) const STANDARD: Self = Self {
        mass_kg: 0.35,
        grip_n_m: 900.0,
        grip_n_s_m: 18.0,
        tremor_m: 8e-5,
        handle_kg: 0.25,
        handle_n_s_m: 0.5,
        coulomb_n: 0.0,
        count_m: 1e-5,
    };
}

#[derive(Clone, Debug)]
pub(super) struct Fixture {
    pub(super) person: Person,
    render: Render,
    delay: usize,
    /// Factor on the tissue's stiffness and on the grip's.
    pub(super) stiffer: f64,
    pub(super) tighter: f64,
    pub(super) gripped: bool,
    chain: SafetyChain<1>,
    noise: Noise,
    phases: [f64; 3],
    tick: usize,
    pub(super) handle_m: f64,
    pub(super) handle_m_s: f64,
    tip_m: f64,
    tip_m_s: f64,
    command_m: f64,
    commands_m: [f64; PAST],
    forces_n: [f64; PAST],
    speed: Speed<1>,
    pub(super) tip_n: f64,
    pub(super) force_n: f64,
    /// Force passed by the gates before the governor, without slew limit and energy gate, N.
    pub(super) passed_n: f64,
    pub(super) report: GateReport,
}

impl Fixture {
    /// Creates a chain with the usual gates and a brake of this viscosity, N s/m.
    pub(super) fn new(person: Person, render: Render, delay: usize, brake_n_s_m: f64, seed: u64) -> Self {
        Self::of(person, render, delay, ChainSettings { brake_n_s_m, ..ChainSettings::default() }, seed)
    }

    pub(super) fn of(person: Person, render: Render, delay: usize, settings: ChainSettings, seed: u64) -> Self {
        let mut noise = Noise::new(seed);
        let phases = std::array::from_fn(|_| TAU * noise.uniform());
        let start_m = 0.005;
        Self {
            person,
            render,
            delay,
            stiffer: 1.0,
            tighter: 1.0,
            gripped: true,
            chain: SafetyChain::new(settings, PERIOD_S),
            noise,
            phases,
            tick: 0,
            handle_m: start_m,
            handle_m_s: 0.0,
            tip_m: start_m,
            tip_m_s: 0.0,
            command_m: start_m,
            commands_m: [start_m; PAST],
            forces_n: [0.0; PAST],
            speed: Speed::new(person.count_m, 1.0 / PERIOD_S),
            tip_n: 0.0,
            force_n: 0.0,
            passed_n: 0.0,
            report: GateReport::default(),
        }
    }

    /// One tick, the hand meaning to be here (m).
    pub(super) fn step(&mut self, intended_m: f64) {
        self.tick += 1;
        let now_s = self.tick as f64 * PERIOD_S;
        let waves = [8.3, 9.7, 11.6].iter().zip(self.phases).map(|(hz, phase)| (TAU * hz * now_s + phase).sin());
        let wanted_m = intended_m + self.person.tremor_m / 3.0_f64.sqrt() * waves.sum::<f64>();
        self.move_handle(wanted_m);
        self.follow();
        let read_m = (self.handle_m / self.person.count_m).round() * self.person.count_m;
        let speed_m_s = self.speed.step(now_s, Vector1::new(read_m));
        self.command_m += (read_m - self.command_m).clamp(-FOLLOWER_M_S * PERIOD_S, FOLLOWER_M_S * PERIOD_S);
        self.commands_m[self.tick % PAST] = self.command_m;
        let asked_n = self.asked(read_m);
        let (force_n, report) = self.chain.step(&ForceRequest {
            t_s: now_s,
            force_n: Some(Vector1::new(asked_n)),
            age_s: 0.0,
            speed_m_s,
            hand_m: Some(Vector1::new(read_m)),
            hand_age_s: 0.0,
            permitted: true,
        });
        self.force_n = force_n.x;
        self.report = report;
        self.passed_n = asked_n.signum() * (asked_n.abs() - report.withheld_n).min(4.0);
    }

    fn asked(&mut self, read_m: f64) -> f64 {
        self.forces_n[self.tick % PAST] = self.tip_n + 0.02 * self.noise.gaussian();
        let back = |ticks: usize| (self.tick + PAST - ticks) % PAST;
        match self.render {
            Render::Reflection if self.tick <= self.delay => 0.0,
            Render::Reflection => self.forces_n[back(self.delay)],
            Render::Model => self.tissue_n(self.commands_m[back(LAG_TICKS)], 0.0),
            Render::Spring => self.tissue_n(read_m, 0.0),
        }
    }

    fn tissue_n(&self, position_m: f64, velocity_m_s: f64) -> f64 {
        let depth_m = (-position_m).max(0.0);
        (self.stiffer * 1300.0 * depth_m.powf(1.3) * (1.0 - 1.5 * velocity_m_s)).max(0.0)
    }

    fn move_handle(&mut self, wanted_m: f64) {
        let Person { mass_kg, grip_n_m, grip_n_s_m, handle_kg, handle_n_s_m, coulomb_n, .. } = self.person;
        let dt_s = PERIOD_S / f64::from(SUBSTEPS);
        for _ in 0..SUBSTEPS {
            let rubbed_n = self.force_n - coulomb_n * (self.handle_m_s / 0.002).tanh();
            let (hand_n, mass_kg) = if self.gripped {
                let damping_n_s_m = grip_n_s_m * self.tighter.sqrt();
                ((wanted_m - self.handle_m) * grip_n_m * self.tighter - self.handle_m_s * damping_n_s_m, mass_kg)
            } else {
                (-handle_n_s_m * self.handle_m_s, handle_kg)
            };
            self.handle_m_s += (hand_n + rubbed_n) * dt_s / mass_kg;
            self.handle_m += self.handle_m_s * dt_s;
        }
    }

    fn follow(&mut self) {
        let omega = TAU * FOLLOWER_HZ;
        let offset_m = self.tip_m - self.command_m;
        let decay = (-omega * PERIOD_S).exp();
        let slope_m_s = self.tip_m_s + offset_m * omega;
        self.tip_m = self.command_m + (offset_m + slope_m_s * PERIOD_S) * decay;
        self.tip_m_s = (self.tip_m_s - slope_m_s * (omega * PERIOD_S)) * decay;
        self.tip_n = self.tissue_n(self.tip_m, self.tip_m_s);
    }
}
