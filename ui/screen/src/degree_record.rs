//! Polynomial degrees of the last minutes: how often each was chosen, and how they changed over time.

use std::collections::VecDeque;

use nalgebra::Vector3;
use nima_core::impedance::{MAX_DEGREE, Mode};
use nima_machine::messages::{LoopState, Tick};

use crate::{
    rolling::{DegreeFractions, FadingMean},
    stiffness::CONTACT_N,
};

/// Period of the record, s.
pub const DEGREES_S: f64 = 120.0;
/// Length of a point of the course over time, s.
pub const POINT_S: f64 = 0.5;
/// Averaging time of the residuals of an axis, s: a degree chosen from a single sample would only show noise.
const RESIDUAL_S: f64 = 0.1;

/// A rule that chooses a degree in every tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DegreeRule {
    /// The rule of this console: smallest recent prediction error.
    Console,
    /// The paper's rule: smallest error in the window, all axes together.
    Paper,
    /// The literal degree with the smallest recent residual along one axis (0 is x).
    Axis(usize),
}

impl DegreeRule {
    pub const ALL: [Self; 5] = [Self::Console, Self::Paper, Self::Axis(0), Self::Axis(1), Self::Axis(2)];

    const fn index(self) -> usize {
        match self {
            Self::Console => 0,
            Self::Paper => 1,
            Self::Axis(axis) => 2 + axis,
        }
    }
}

const RULES: usize = DegreeRule::ALL.len();

/// Degrees in a short time: sum and number for each rule.
#[derive(Clone, Copy, Debug, Default)]
struct DegreePoint {
    number: u64,
    sums: [u32; RULES],
    counts: [u32; RULES],
}

/// Degrees of one set of ticks.
#[derive(Clone, Debug)]
struct DegreeCourse {
    fractions: [DegreeFractions; RULES],
    points: VecDeque<DegreePoint>,
}

impl DegreeCourse {
    fn new(ticks: usize) -> Self {
        Self { fractions: std::array::from_fn(|_| DegreeFractions::new(ticks)), points: VecDeque::new() }
    }

    fn push(&mut self, t_s: f64, degrees: &[Option<u8>; RULES]) {
        let number = (t_s / POINT_S) as u64;
        if self.points.back().is_none_or(|last| last.number != number) {
            self.points.push_back(DegreePoint { number, ..DegreePoint::default() });
        }
        let oldest = number.saturating_sub((DEGREES_S / POINT_S) as u64);
        while self.points.front().is_some_and(|first| first.number < oldest) {
            self.points.pop_front();
        }
        let Some(point) = self.points.back_mut() else { return };
        for (rule, degree) in degrees.iter().enumerate() {
            let Some(degree) = degree else { continue };
            self.fractions[rule].push(*degree);
            point.sums[rule] += u32::from(*degree);
            point.counts[rule] += 1;
        }
    }
}

/// Returns the degree by this console's rule: of the mode in use, or of the identification for a mode without its own.
pub fn chosen_degree(tick: &Tick) -> u8 {
    let report = &tick.identification;
    match tick.mode {
        mode @ (Mode::Matched | Mode::Nima | Mode::Best) => report.degree_of(mode),
        Mode::Literal | Mode::Linear | Mode::Dfr | Mode::Anchored | Mode::Baseline(_) => report.degrees.anchored,
    }
}

/// Degrees of the engaged ticks of the last minutes: of all, and of those in contact.
#[derive(Clone, Debug)]
pub struct DegreeRecord {
    all: DegreeCourse,
    in_contact: DegreeCourse,
    residuals_n2: [[FadingMean; MAX_DEGREE]; 3],
}

impl DegreeRecord {
    /// Creates an empty record for a loop of this rate.
    pub fn new(rate_hz: f64) -> Self {
        let ticks = (DEGREES_S * rate_hz) as usize;
        Self { all: DegreeCourse::new(ticks), in_contact: DegreeCourse::new(ticks), residuals_n2: Default::default() }
    }

    /// Adds a tick that came `dt_s` after the previous one; only engaged ticks count.
    pub fn push(&mut self, tick: &Tick, dt_s: f64) {
        if tick.state != LoopState::Engaged {
            return;
        }
        let report = &tick.identification;
        let console = chosen_degree(tick);
        let is_compared = report.modes.contains(Mode::Literal);
        let mut degrees = [None; RULES];
        degrees[DegreeRule::Console.index()] = Some(console);
        if is_compared {
            degrees[DegreeRule::Paper.index()] = Some(report.degrees.paper);
        }
        if is_compared && report.degrees.paper > 0 {
            for (axis, degree) in self.axis_degrees(&report.reconstruction_n, dt_s).into_iter().enumerate() {
                degrees[DegreeRule::Axis(axis).index()] = Some(degree);
            }
        }
        self.all.push(tick.t_s, &degrees);
        if tick.known_n().is_some_and(|force_n| force_n.norm() >= CONTACT_N) {
            self.in_contact.push(tick.t_s, &degrees);
        }
    }

    /// Returns the degree with the smallest mean square of the last residuals along each axis.
    fn axis_degrees(&mut self, residuals_n: &[Vector3<f64>; MAX_DEGREE], dt_s: f64) -> [u8; 3] {
        let mut degrees = [0; 3];
        for (axis, (degree, means)) in degrees.iter_mut().zip(&mut self.residuals_n2).enumerate() {
            for (mean, residual_n) in means.iter_mut().zip(residuals_n) {
                mean.push(residual_n[axis].powi(2), dt_s, RESIDUAL_S);
            }
            let best = means.iter().enumerate().min_by(|(_, a), (_, b)| a.get().total_cmp(&b.get()));
            *degree = best.map_or(0, |(place, _)| place as u8 + 1);
        }
        degrees
    }

    const fn course(&self, in_contact: bool) -> &DegreeCourse {
        if in_contact { &self.in_contact } else { &self.all }
    }

    /// Returns how often the rule chose each degree; `None` if it has not chosen any.
    pub fn fractions(&self, rule: DegreeRule, in_contact: bool) -> Option<&DegreeFractions> {
        Some(&self.course(in_contact).fractions[rule.index()]).filter(|fractions| !fractions.is_empty())
    }

    /// Returns the mean degree of each short time in which the rule chose any, with its start (s), oldest first.
    pub fn course_of(&self, rule: DegreeRule, in_contact: bool) -> impl Iterator<Item = (f64, f64)> {
        let rule = rule.index();
        self.course(in_contact).points.iter().filter(move |point| point.counts[rule] > 0).map(move |point| {
            (point.number as f64 * POINT_S, f64::from(point.sums[rule]) / f64::from(point.counts[rule]))
        })
    }
}

#[cfg(test)]
mod tests {
    use nima_core::impedance::ModeSet;
    use nima_simulation::run_virtual;

    use super::*;

    fn a_tick() -> Tick {
        let mut last = None;
        run_virtual(&nima_tests::plan("peg_transfer"), 0.5, |tick| {
            last = Some(*tick);
            None
        })
        .unwrap();
        let mut tick = last.unwrap();
        tick.state = LoopState::Engaged;
        tick.mode = Mode::Anchored;
        tick.identification.modes = ModeSet::ALL;
        tick
    }

    #[test]
    fn contact_and_free_motion_are_told_apart() {
        let mut record = DegreeRecord::new(1000.0);
        let mut tick = a_tick();
        for number in 0..1000_u32 {
            tick.t_s = f64::from(number) * 1e-3;
            let pressed = number >= 750;
            tick.measured_n = Vector3::z() * if pressed { 2.0 } else { 0.05 };
            tick.identification.degrees.anchored = if pressed { 3 } else { 0 };
            record.push(&tick, 1e-3);
        }
        let nonlinear = |in_contact| record.fractions(DegreeRule::Console, in_contact).unwrap().nonlinear();
        assert!((nonlinear(false) - 0.25).abs() < 1e-9 && (nonlinear(true) - 1.0).abs() < 1e-9);
        let course: Vec<_> = record.course_of(DegreeRule::Console, false).collect();
        assert_eq!(course, [(0.0, 0.0), (0.5, 1.5)]);
        assert_eq!(record.course_of(DegreeRule::Console, true).collect::<Vec<_>>(), [(0.5, 3.0)]);
    }

    #[test]
    fn each_axis_has_the_degree_that_leaves_least() {
        let mut record = DegreeRecord::new(1000.0);
        let mut tick = a_tick();
        tick.identification.degrees.paper = 5;
        tick.identification.reconstruction_n = [[1.0, 0.1, 0.5], [0.2, 0.3, 0.4], [0.3, 0.3, 0.1], [0.4; 3], [0.5; 3]]
            .map(|[x, y, z]| Vector3::new(x, y, z));
        record.push(&tick, 1e-3);
        let chosen = |rule| record.course_of(rule, false).next().map(|(_, degree)| degree);
        assert_eq!([0, 1, 2].map(|axis| chosen(DegreeRule::Axis(axis))), [Some(2.0), Some(1.0), Some(3.0)]);
    }

    #[test]
    fn nothing_is_told_about_a_rule_that_was_not_computed() {
        let mut record = DegreeRecord::new(1000.0);
        let mut tick = a_tick();
        tick.identification.modes = ModeSet::only(Mode::Anchored);
        record.push(&tick, 1e-3);
        assert!(record.fractions(DegreeRule::Console, false).is_some());
        assert!(record.fractions(DegreeRule::Paper, false).is_none());
        tick.state = LoopState::Idle;
        let mut idle = DegreeRecord::new(1000.0);
        idle.push(&tick, 1e-3);
        assert!(idle.fractions(DegreeRule::Console, false).is_none());
    }
}
