//! The cases of the study: every clock, force, mode and delay, and other handles.

use nima_core::impedance::Mode;
use nima_machine::runtime::VirtualClock;
use nima_simulation::scene::TissueModel;

use super::{
    BRAKES_N_S_M, CONTACTS_N, DELAYS_MS, HANDLES, METHODS, ReleaseError, ReleaseOptions, ReleaseReport,
    ReleaseSituation, ReleaseStyle, WEAK_N, let_go, methods, pressed_tissue, worst_of,
};
use crate::{Experiment, clocks, pair::LoneHandle};

impl Experiment for ReleaseOptions {
    const NAME: &'static str = "release";
    const FILES: &'static [&'static str] = &[".md", ".svg"];
    type Findings = ReleaseReport;
    type Error = ReleaseError;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<ReleaseReport, ReleaseError> {
        let tissue = pressed_tissue()?;
        let mut report = ReleaseReport::default();
        let all = self.clocks.len() * (RELEASES + HANDLES_TRIED);
        for clock in &self.clocks {
            report.try_modes(*clock, tissue, &mut |done, mode| progress(done, all, mode.name()))?;
            report.try_handles(*clock, tissue, &mut |done| progress(done, all, "other handles"))?;
        }
        progress(all, all, "done");
        Ok(report)
    }
}

/// Number of releases, and of handles with brakes, on one clock.
const RELEASES: usize = CONTACTS_N.len() * 2 * ReleaseSituation::ALL.len() * METHODS * DELAYS_MS.len();
const HANDLES_TRIED: usize = 2 * BRAKES_N_S_M.len() * HANDLES.len();

impl ReleaseReport {
    fn done(&self) -> usize {
        self.rows.len() + self.worst.len()
    }

    fn try_modes(
        &mut self,
        clock: VirtualClock,
        tissue: TissueModel,
        progress: &mut dyn FnMut(usize, Mode),
    ) -> Result<(), ReleaseError> {
        for contact_n in CONTACTS_N {
            for governor in [false, true] {
                for (number, (situation, mode)) in ReleaseSituation::ALL
                    .into_iter()
                    .flat_map(|situation| methods().map(move |mode| (situation, mode)))
                    .enumerate()
                {
                    progress(self.done(), mode);
                    for (delay, delay_ms) in DELAYS_MS.into_iter().enumerate() {
                        let clock = clocks::of_trial(clock, (number * DELAYS_MS.len() + delay) as u64);
                        let way = ReleaseStyle { clock, situation, governor, mode, delay_ms, contact_n };
                        self.rows.push(let_go(&way, tissue)?);
                    }
                }
            }
        }
        Ok(())
    }

    fn try_handles(
        &mut self,
        clock: VirtualClock,
        tissue: TissueModel,
        progress: &mut dyn FnMut(usize),
    ) -> Result<(), ReleaseError> {
        for contact_n in [CONTACTS_N[0], WEAK_N] {
            for brake_n_s_m in BRAKES_N_S_M {
                for (kg, coulomb_n) in HANDLES {
                    progress(self.done());
                    let handle = LoneHandle { kg, coulomb_n, ..LoneHandle::OMEGA };
                    self.worst.push(worst_of(clock, contact_n, brake_n_s_m, &handle, tissue)?);
                }
            }
        }
        Ok(())
    }
}
