//! Words of the room `safety`.

pub(in crate::console) const IDLE: &str = "Idle";
pub(in crate::console) const READY: &str = "Ready";
pub(in crate::console) const ENGAGED: &str = "Engaged";
pub(in crate::console) const CLUTCHED: &str = "Clutched";
pub(in crate::console) const STOPPED: &str = "Stopped";
pub(in crate::console) const FAULT: &str = "Fault";
pub(in crate::console) const THE_OPERATOR_ASKED_FOR: &str = "the operator asked for it";
pub(in crate::console) const THE_DEVICES_CAME: &str = "the devices came";
pub(in crate::console) const A_DEVICE_WENT: &str = "a device went";
pub(in crate::console) const DRIVES_OBEY_HAND_AND: &str = "drives obey, hand and tip agree";
pub(in crate::console) const THE_CLUTCH: &str = "the clutch";
pub(in crate::console) const THE_DRIVES_DID_NOT: &str = "the drives did not obey in time";
pub(in crate::console) const NOBODY_HOLDS_THE_HANDLE: &str = "nobody holds the handle";
pub(in crate::console) const SINCE_THE_LOOP_BEGAN: &str = "since the loop began";
pub(in crate::console) const FORCE_AND_MOTION_EXIST: &str = "Force and motion exist in Engaged only. Stop and fault are latched: out of them it takes a release to Idle and a new \
         engagement. What went away comes back as Idle. Nothing resumes by itself; only the clutch returns to Engaged.";
pub(in crate::console) const FROM_EVERYWHERE: &str = "from everywhere";
pub(in crate::console) const SIZE_OF_THE_FORCE: &str =
    "Size of the force that the mode asks for now, and of what reaches the hand after all gates (N).";
