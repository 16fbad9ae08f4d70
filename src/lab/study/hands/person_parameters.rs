//! A person at random: handle, grip, tissue, and where the hand intends to be.

use std::f64::consts::TAU;

use nalgebra::SVector;
use nima_core::noise::Noise;

use super::kind::{HandKind, Targets};

/// Mass of the handle that the governor assumes, kg.
pub(super) const HANDLE_KG: f64 = 0.25;
/// Extent of the targets to one side, m.
const REACH_M: f64 = 0.035;
/// Time before the first motion, and distance from the tissue at the start, s and m.
const REST_S: f64 = 0.3;
const OUTSIDE_M: f64 = 0.003;
/// Duration of a motion, and longest pause after it, s: of the hand, and of a gripper.
const REACHES_S: ([f64; 2], f64) = ([0.2, 0.9], 0.5);
const GRIPS_S: ([f64; 2], f64) = ([0.08, 0.2], 0.3);
/// Motion of the handle while the gripper closes (m), and the force with which it pushes the handle (N/m of that motion).
const GRIPPER_M: f64 = 0.004;
pub(super) const GRIPPER_N_M: f64 = 100.0;
/// Sideways stiffness of the tissue, as a fraction of the stiffness into it.
pub(super) const SIDEWAYS: f64 = 0.3;

/// Uniform in this range.
pub(super) fn between(noise: &mut Noise, [low, high]: [f64; 2]) -> f64 {
    low + (high - low) * noise.uniform()
}

/// Returns a unit vector in any direction.
pub(super) fn direction<const D: usize>(noise: &mut Noise) -> SVector<f64, D> {
    let any = SVector::<f64, D>::from_fn(|_, _| noise.gaussian());
    any / any.norm().max(1e-9)
}

/// Properties of one person and one handle.
#[derive(Clone, Copy, Debug)]
pub(super) struct PersonParameters<const D: usize> {
    pub(super) handle_kg: f64,
    /// Mass that moves with the handle while it is held, kg.
    pub(super) hand_kg: f64,
    pub(super) damping_n_s_m: f64,
    pub(super) coulomb_n: f64,
    pub(super) grip_n_m: f64,
    pub(super) grip_n_s_m: f64,
    pub(super) tremor_phase: f64,
    pub(super) tremor_axis: SVector<f64, D>,
    pub(super) tissue: ElasticTissue<D>,
    /// Middle of the targets and their farthest distance from it, m.
    middle_m: SVector<f64, D>,
    radius_m: f64,
}

/// Half-space of elastic tissue, whose force arrives late.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElasticTissue<const D: usize> {
    pub(super) n_m: f64,
    pub(super) delay_s: f64,
    /// A point on the surface, and the direction into the tissue.
    pub(super) surface_m: SVector<f64, D>,
    pub(super) inwards: SVector<f64, D>,
}

impl<const D: usize> PersonParameters<D> {
    /// Creates a person of this kind.
    pub(super) fn drawn(kind: &HandKind, noise: &mut Noise) -> Self {
        let grip_n_m = 400.0 * 5.0_f64.powf(noise.uniform());
        let stiffest_n_m = between(noise, [0.3, 0.6]) * grip_n_m;
        let inwards = direction(noise);
        let (radius_m, middle_m, surface) = match kind.targets {
            Targets::Within35Mm => (0.5 * REACH_M, inwards * (0.5 * REACH_M), [-1.0, 0.6]),
            Targets::Within70Mm => (REACH_M, SVector::zeros(), [-0.4, 0.4]),
        };
        Self {
            handle_kg: HANDLE_KG * between(noise, [1.0 - kind.mass_error, 1.0 + kind.mass_error]),
            hand_kg: kind.hand_kg * noise.uniform(),
            damping_n_s_m: between(noise, [0.2, kind.damping_n_s_m]),
            coulomb_n: kind.coulomb_n * noise.uniform(),
            grip_n_m,
            grip_n_s_m: between(noise, [8.0, 40.0]),
            tremor_phase: TAU * noise.uniform(),
            tremor_axis: direction(noise),
            tissue: ElasticTissue {
                n_m: stiffest_n_m * noise.uniform().max(0.2),
                delay_s: 0.3 * noise.uniform(),
                surface_m: middle_m + inwards * (radius_m * between(noise, surface)),
                inwards,
            },
            middle_m,
            radius_m,
        }
    }

    /// Returns the initial position of the hand, m: outside the tissue.
    pub(super) fn start_m(&self) -> SVector<f64, D> {
        self.tissue.surface_m - self.tissue.inwards * OUTSIDE_M
    }

    /// Motions to random targets.
    pub(super) fn reaches(&self) -> PersonMotion<D> {
        PersonMotion::new(self.start_m(), self.middle_m, self.radius_m, REACHES_S)
    }

    /// Motions of the handle by a gripper.
    pub(super) fn grips() -> PersonMotion<D> {
        PersonMotion::new(SVector::zeros(), SVector::zeros(), GRIPPER_M, GRIPS_S)
    }
}

impl<const D: usize> ElasticTissue<D> {
    /// Returns the depth of this position below the surface, m; negative outside.
    pub(super) fn depth_m(&self, position_m: &SVector<f64, D>) -> f64 {
        self.inwards.dot(&(position_m - self.surface_m))
    }
}

/// Motions of minimum jerk, one after the other, with pauses.
#[derive(Clone, Copy, Debug)]
pub(super) struct PersonMotion<const D: usize> {
    middle_m: SVector<f64, D>,
    radius_m: f64,
    durations_s: [f64; 2],
    pause_s: f64,
    from_m: SVector<f64, D>,
    to_m: SVector<f64, D>,
    begin_s: f64,
    lasts_s: f64,
}

impl<const D: usize> PersonMotion<D> {
    pub(super) fn new(
        from_m: SVector<f64, D>,
        middle_m: SVector<f64, D>,
        radius_m: f64,
        (durations_s, pause_s): ([f64; 2], f64),
    ) -> Self {
        Self { middle_m, radius_m, durations_s, pause_s, from_m, to_m: from_m, begin_s: 0.0, lasts_s: REST_S }
    }

    /// Returns position (m) and velocity (m/s) at this time, s; call it with increasing times.
    pub(super) fn at(&mut self, t_s: f64, noise: &mut Noise) -> (SVector<f64, D>, SVector<f64, D>) {
        if t_s > self.begin_s + self.lasts_s {
            self.from_m = self.to_m;
            let distance_m = self.radius_m * noise.uniform().powf(1.0 / D as f64);
            self.to_m = self.middle_m + direction(noise) * distance_m;
            self.begin_s = t_s + self.pause_s * noise.uniform() * noise.uniform();
            self.lasts_s = between(noise, self.durations_s);
        }
        let s = ((t_s - self.begin_s) / self.lasts_s).clamp(0.0, 1.0);
        let travel_m = self.to_m - self.from_m;
        let part = s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
        let part_per_s = 30.0 * s * s * (1.0 - s) * (1.0 - s) / self.lasts_s;
        (self.from_m + travel_m * part, travel_m * part_per_s)
    }
}
