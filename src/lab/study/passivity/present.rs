//! The study of passivity as tables.

use std::fmt::Write as _;

use nima_machine::runtime::ClockProfile;

use super::{DELAYS_MS, LOOSE_N_M, OwnMotion, PassivityReport, PassivityTask, STILL_M_S, WAYS, study};
use crate::{Experiment, Findings, clocks, release::ReleaseError};

impl Findings for PassivityReport {
    /// Returns power and error of each task, and the speed of loose grips, by delay, for each clock.
    fn text(&self) -> String {
        let mut clocks: Vec<_> = self.rows.iter().map(|row| row.clock).collect();
        clocks.dedup();
        clocks.into_iter().map(|clock| self.tables(clock)).collect()
    }
}

impl PassivityReport {
    fn tables(&self, clock: ClockProfile) -> String {
        let mut text = clocks::heading(clock);
        let delays = DELAYS_MS.map(|delay_ms| format!(" {delay_ms:.0} ms |")).concat();
        for task in PassivityTask::ALL {
            let head = format!("| mode | own motion |{delays}\n|---|---|{}\n", "---|".repeat(DELAYS_MS.len()));
            // Writing into a String cannot fail, here and below.
            write!(text, "{}: mean power into the hand (mW) / mean error (N):\n\n{head}", title(task)).ok();
            for way in WAYS {
                let rows = self.rows.iter().filter(|row| row.clock == clock && row.task == task);
                let rows = rows.filter(|row| (row.mode, row.own_motion) == way);
                let cells: Vec<_> = rows.map(|row| format!(" {:.1} / {:.3} |", row.power_mw, row.error_n)).collect();
                let cells = cells.concat();
                writeln!(text, "| {} | {} |{cells}", way.0, word(way.1)).ok();
            }
            text.push('\n');
        }
        for grip_n_m in LOOSE_N_M {
            let head = format!("| mode | own motion |{delays}\n|---|---|{}\n", "---|".repeat(DELAYS_MS.len()));
            let limit_mm_s = 1e3 * STILL_M_S;
            write!(
                text,
                "A grip of {grip_n_m:.0} N/m holds still: fastest motion (mm/s); above {limit_mm_s:.0} it oscillates:\n\n{head}"
            )
            .ok();
            for way in WAYS {
                let held = self.held.iter().filter(|held| (held.mode, held.own_motion) == way);
                let held = held.filter(|held| held.clock == clock && (held.grip_n_m - grip_n_m).abs() < 1e-9);
                let cells: Vec<_> = held.map(|held| format!(" {:.1} |", 1e3 * held.peak_m_s)).collect();
                let cells = cells.concat();
                writeln!(text, "| {} | {} |{cells}", way.0, word(way.1)).ok();
            }
            text.push('\n');
        }
        text
    }
}

const fn title(task: PassivityTask) -> &'static str {
    match task {
        PassivityTask::PalpationSlow => "Palpation at 1 Hz",
        PassivityTask::PalpationFast => "Palpation at 3 Hz",
        PassivityTask::PegTransfer => "Peg transfer",
        PassivityTask::Withdrawal => "Withdrawal at 200 mm/s",
    }
}

const fn word(own_motion: OwnMotion) -> &'static str {
    match own_motion {
        OwnMotion::Follower => "follower",
        OwnMotion::Handle => "handle",
    }
}

impl Experiment for super::PassivityOptions {
    const NAME: &'static str = "passivity";
    type Findings = PassivityReport;
    type Error = ReleaseError;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<PassivityReport, ReleaseError> {
        study(self, progress)
    }
}
