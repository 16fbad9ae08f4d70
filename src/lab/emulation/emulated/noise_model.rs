//! Effects of real devices' flaws on the readings of a side.

use std::collections::VecDeque;

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::frames::Wrench;
use nima_devices::{ARM_JOINTS, TrackedTool};
use nima_machine::rig::Flaws;

/// Duration for which a marker is hidden each time, s. Longer than the 0.1 s after which the loop treats a marker as
/// missing.
const HIDDEN_S: f64 = 0.25;
/// Number of stored marker readings for a late tracker: more than its frames in the maximum delay.
const KEPT: usize = 256;

/// The flaws of a side, and their state.
#[derive(Clone, Debug)]
pub(super) struct FlawedSide {
    flaws: Flaws,
    /// Angles reported by the encoders, rad.
    reported_rad: [f64; ARM_JOINTS],
    seen: VecDeque<(f64, TrackedTool)>,
}

impl FlawedSide {
    /// Starts with the joints at these angles, rad.
    pub(super) const fn new(flaws: Flaws, joint_rad: [f64; ARM_JOINTS]) -> Self {
        Self { flaws, reported_rad: joint_rad, seen: VecDeque::new() }
    }

    /// Returns the encoder readings for these angles, rad: they follow once the play is used up.
    pub(super) fn encoders(&mut self, joint_rad: &[f64; ARM_JOINTS]) -> [f64; ARM_JOINTS] {
        let play_rad = 0.5 * self.flaws.backlash_deg.to_radians();
        for (report, rad) in self.reported_rad.iter_mut().zip(joint_rad) {
            *report = report.clamp(rad - play_rad, rad + play_rad);
        }
        self.reported_rad
    }

    /// Returns the error of the wrist sensor after `t_s`, with the last joint at this angle (rad), in its own frame.
    pub(super) fn wrench(&self, t_s: f64, last_rad: f64) -> Wrench {
        let Flaws { drift_n_per_min, cable_n, .. } = self.flaws;
        let cable = Vector3::new(last_rad.sin(), last_rad.cos(), 0.5 * (2.0 * last_rad).sin()) * cable_n;
        Wrench { force_n: Vector3::repeat(drift_n_per_min * t_s / 60.0) + cable, torque_nm: Vector3::zeros() }
    }

    /// Returns the accelerometer's misalignment in addition to the scene's.
    pub(super) fn askew(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(Vector3::new(0.8, 0.6, 0.0) * self.flaws.imu_askew_deg.to_radians())
    }

    /// Returns the bending of a shaft that points along `direction` under this force on the tip (N, `world`), m.
    pub(super) fn bent_m(&self, force_n: &Vector3<f64>, direction: &Vector3<f64>) -> Vector3<f64> {
        (force_n - direction * force_n.dot(direction)) * self.flaws.bend_m_per_n
    }

    /// Returns the tracker's reading at `now_s` of a marker in this state.
    pub(super) fn tracked(&mut self, now_s: f64, marker: TrackedTool) -> TrackedTool {
        let Flaws { tracker_late_s, tracker_missing, .. } = self.flaws;
        if self.seen.len() == KEPT {
            self.seen.pop_front();
        }
        self.seen.push_back((now_s, marker));
        while self.seen.get(1).is_some_and(|(at_s, _)| *at_s <= now_s - tracker_late_s) {
            self.seen.pop_front();
        }
        // The sequence is the same in every run.
        let turn = (now_s / HIDDEN_S) as u64;
        let chance = fastrand::Rng::with_seed(turn).f64();
        if chance < tracker_missing {
            return TrackedTool::Missing { out_of_volume: false };
        }
        self.seen.front().map_or(marker, |(_, seen)| *seen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(angle_rad: f64) -> TrackedTool {
        TrackedTool::Seen {
            c_from_tool: UnitQuaternion::from_scaled_axis(Vector3::x() * angle_rad),
            position_in_c_m: Vector3::zeros(),
            error_m: 0.0,
            at_the_edge: false,
        }
    }

    #[test]
    fn without_flaws_everything_is_told_as_it_is() {
        let mut none = FlawedSide::new(Flaws::default(), [0.0; ARM_JOINTS]);
        assert!(none.encoders(&[0.3; ARM_JOINTS]).iter().all(|rad| (rad - 0.3).abs() < 1e-15));
        assert_eq!(none.wrench(600.0, 1.0).force_n, Vector3::zeros());
        assert!(none.bent_m(&Vector3::x(), &Vector3::z()).norm() < 1e-15);
        for tick in 0..1000 {
            let t_s = f64::from(tick) * 1e-3;
            assert_eq!(none.tracked(t_s, seen(t_s)), seen(t_s));
        }
    }

    #[test]
    fn a_late_tracker_tells_what_was_and_hidden_markers_are_missing() {
        let flaws = Flaws { tracker_late_s: 0.05, tracker_missing: 0.3, ..Flaws::default() };
        let mut flawed = FlawedSide::new(flaws, [0.0; ARM_JOINTS]);
        let mut missing = 0;
        let mut late_s = 0.0_f64;
        for frame in 0..6000 {
            let t_s = f64::from(frame) / 60.0;
            match flawed.tracked(t_s, seen(1e-3 * t_s)) {
                TrackedTool::Seen { c_from_tool, .. } if t_s > 1.0 => {
                    late_s = late_s.max(t_s - 1e3 * c_from_tool.angle());
                }
                TrackedTool::Seen { .. } => {}
                _ => missing += 1,
            }
        }
        assert!((0.04..0.08).contains(&late_s), "{late_s}");
        assert!((1200..2400).contains(&missing), "{missing}");
    }

    #[test]
    fn an_encoder_follows_once_its_play_is_used_up() {
        let mut flawed = FlawedSide::new(Flaws { backlash_deg: 2.0, ..Flaws::default() }, [0.0; ARM_JOINTS]);
        let half = 1_f64.to_radians();
        assert!(flawed.encoders(&[half; ARM_JOINTS])[0].abs() < 1e-12);
        assert!((flawed.encoders(&[3.0 * half; ARM_JOINTS])[0] - 2.0 * half).abs() < 1e-12);
        assert!(
            (flawed.encoders(&[2.0 * half; ARM_JOINTS])[0] - 2.0 * half).abs() < 1e-12,
            "it turns back in its play"
        );
    }
}
