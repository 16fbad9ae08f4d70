//! Targets of the study, and the cases that miss them.

use std::fmt;

use nima_machine::runtime::ClockProfile;

use super::{HandReport, present_hands::HeldTally, released::Releases};

/// For hands that hold the handle: alarms per minute, withheld fraction (%); reversed ticks and steps beyond the slew
/// limit must not occur.
pub(super) const ALARMS_PER_MIN: f64 = 0.02;
/// See above.
pub(super) const WITHHELD_PERCENT: f64 = 0.1;
/// Rounding of a sum of forces, N.
const ROUNDING_N: f64 = 1e-9;
/// Releases that have an aim, N.
pub(super) const FROM_N: f64 = 1.0;
/// Kinetic energy of a handle that was released at once, mJ.
pub(super) const ENERGY_MJ: f64 = 2.0;
/// Travel, mm, 95 % of the releases and the maximum: released at once, on a clock without late ticks.
pub(super) const AT_ONCE_MM: [f64; 2] = [2.0, 3.0];
/// Maximum travel, mm: released at once with up to 1 % of late ticks, and with more.
pub(super) const AT_ONCE_LATE_MM: [f64; 2] = [4.0, 5.0];
/// Travel, mm, 95 % of the releases and the farthest: fingers that open within 10 to 40 ms.
pub(super) const OPENING_MM: [f64; 2] = [4.5, 6.0];

/// Number of evaluated targets, and the missed ones.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Aims {
    /// Number of aims.
    pub judged: usize,
    /// One line for each missed aim.
    pub missed: Vec<String>,
}

impl Aims {
    fn judge(&mut self, met: bool, miss: impl fmt::Display) {
        self.judged += 1;
        if !met {
            self.missed.push(miss.to_string());
        }
    }

    fn held(&mut self, tally: &HeldTally, of: &str) {
        let HeldTally { reversed_ticks, reversed_n, beyond_slew_n, .. } = *tally;
        let alarms = tally.alarms_per_min();
        let withheld = tally.withheld_percent();
        self.judge(
            reversed_ticks == 0,
            format_args!("{of}: {reversed_ticks} ticks reversed, by up to {reversed_n:.2} N"),
        );
        self.judge(beyond_slew_n <= ROUNDING_N, format_args!("{of}: steps {beyond_slew_n:.2} N beyond the slew limit"));
        self.judge(alarms <= ALARMS_PER_MIN, format_args!("{of}: {alarms:.3} alarms a minute"));
        self.judge(withheld <= WITHHELD_PERCENT, format_args!("{of}: {withheld:.3} % withheld"));
    }

    fn released(&mut self, releases: &Releases) {
        let Releases { clock, kind, opening_ms, force_n, travel_p95_mm, travel_max_mm, energy_max_mj, .. } = *releases;
        let Some([p95_mm, max_mm]) = travel_aims_mm(clock, opening_ms).filter(|_| force_n >= FROM_N) else { return };
        let of = format!("{clock}, {kind}, {force_n} N within {opening_ms} ms");
        self.judge(travel_p95_mm <= p95_mm, format_args!("{of}: {travel_p95_mm:.1} mm at p95"));
        self.judge(travel_max_mm <= max_mm, format_args!("{of}: {travel_max_mm:.1} mm at most"));
        if opening_ms <= 0.0 {
            self.judge(energy_max_mj <= ENERGY_MJ, format_args!("{of}: {energy_max_mj:.1} mJ"));
        }
    }
}

/// Returns the travel at 95 % and farthest that is aimed for, mm; none while the whole loop pauses.
fn travel_aims_mm(clock: ClockProfile, opening_ms: f64) -> Option<[f64; 2]> {
    let at_once = match clock {
        ClockProfile::Stall { .. } => return None,
        ClockProfile::Perfect | ClockProfile::Quiet => AT_ONCE_MM,
        ClockProfile::Late { percent } if percent <= 1.0 => [f64::INFINITY, AT_ONCE_LATE_MM[0]],
        ClockProfile::Late { .. } | ClockProfile::Busy => [f64::INFINITY, AT_ONCE_LATE_MM[1]],
    };
    Some(if opening_ms > 0.0 { OPENING_MM } else { at_once })
}

impl HandReport {
    /// Returns every target with its result: for hands that hold the handle, over all kinds on a clock together; for
    /// modes and releases, over each row.
    pub fn aims(&self) -> Aims {
        let mut aims = Aims::default();
        for clock in self.clocks() {
            aims.held(&self.all_kinds(clock), &format!("{clock}, all kinds"));
        }
        for row in &self.modes {
            aims.held(&row.tally, &format!("{}, mode {}", row.clock, row.mode));
        }
        self.releases.iter().for_each(|releases| aims.released(releases));
        aims
    }
}
