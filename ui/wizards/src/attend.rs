//! Runs a wizard without a screen: the same sessions and the same order of steps; each step ends as soon as it is complete.

use super::{Binding, CorrespondenceWizard, FrameKind, FrameWizard, SaveRequest, TipForceWizard, WizardKind, Wizards};

/// Result of attending to a wizard.
#[derive(Debug)]
pub enum WizardOutcome {
    /// In progress, in this step, with the message of the wizard.
    Working(&'static str, Option<String>),
    /// Proven, and ready to be saved.
    Proven(SaveRequest),
    /// Ended without proof, for this reason.
    NotProven(String),
}

impl Wizards {
    /// Acts as the technician in this wizard; `None` if this build lacks it.
    pub fn attend(&mut self, which: WizardKind, binding: &Binding) -> Option<WizardOutcome> {
        let wizard = self.the_mut(which)?;
        wizard.refresh(binding);
        let steps = wizard.steps();
        let now = wizard.frame_mut().step;
        if now + 1 < steps.len() {
            if wizard.attend(binding) && wizard.may_go_on(binding).is_ok() {
                wizard.go_to(now + 1);
            }
            return Some(WizardOutcome::Working(steps[now].name.get(), wizard.notice().map(str::to_owned)));
        }
        let proven = wizard.proof().is_some();
        let made = wizard.made(binding);
        Some(match made {
            Some(saving) if proven => {
                self.forget_what_rests_on(which, &saving);
                WizardOutcome::Proven(saving)
            }
            Some(mut saving) => {
                let reason = saving.judgement_mut().map(|judgement| judgement.reason.clone());
                WizardOutcome::NotProven(reason.unwrap_or_default())
            }
            None => WizardOutcome::NotProven(String::new()),
        })
    }

    /// Discards data that depend on the calibration that `which` saves. Pushes and recordings use the gravity calibration; those made with
    /// the previous one must not be mixed with new ones. The recordings of the other frame wizards belong to the previous rig
    /// file.
    pub(super) fn forget_what_rests_on(&mut self, which: WizardKind, saving: &SaveRequest) {
        if matches!(saving, SaveRequest::Gravity(_)) {
            self.correspondence = CorrespondenceWizard::default();
            self.tip_force = TipForceWizard::default();
        }
        if matches!(saving, SaveRequest::Frame(_) | SaveRequest::Undo(_)) {
            for kind in FrameKind::ALL.into_iter().filter(|kind| which != WizardKind::Frame(*kind)) {
                self.frames[kind as usize] = FrameWizard::new(kind);
            }
        }
    }
}
