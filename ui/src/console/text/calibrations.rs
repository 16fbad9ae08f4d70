//! Words of the room `calibrations`.

pub(in crate::console) const ALREADY_OPEN_OR_THE: &str = "Already open, or the loop has stopped: release it first.";
pub(in crate::console) const BACK_TO_THE_MONITOR: &str = "Back to the monitor";
pub(in crate::console) const WHAT_THE_WIZARD_HAS: &str =
    "What the wizard has taken is kept for when it is opened again.";
pub(in crate::console) const GRAVITY: &str = "Gravity";
pub(in crate::console) const CORRESPONDENCE: &str = "Correspondence";
pub(in crate::console) const TIP_FORCE: &str = "Tip force";
pub(in crate::console) const NO_FOLDER_FOR_CALIBRATIONS: &str =
    "no folder for calibrations is known; set NIMA_DATA_DIR";
pub(in crate::console) const THIS_SCENE_MEASURES_AT: &str =
    "This scene measures at the tip; a wrist sensor needs calibrations.";
pub(in crate::console) const GRAVITY_NONE: &str = "Gravity: none";
pub(in crate::console) const CORRESPONDENCE_NONE: &str = "Correspondence: none";
pub(in crate::console) const TIP_FORCE_NONE: &str = "Tip force: none";
pub(in crate::console) const TIP_FORCE_NEVER_CHECKED: &str = "Tip force: never checked";
pub(in crate::console) const MADE_IN_THE_FUTURE: &str = "; made in the future, check the clock";
