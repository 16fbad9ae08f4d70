//! Words of the room `devices`.

pub(in crate::console) const EVERYTHING_ON_THIS_RIG: &str =
    "Everything on this rig is simulated: there are no devices.";
pub(in crate::console) const DISCONNECT: &str = "Disconnect";
pub(in crate::console) const CONNECT: &str = "Connect";
pub(in crate::console) const A_LOST_DEVICE_IS: &str =
    "A lost device is opened again by itself until it is disconnected.";
pub(in crate::console) const CLEAR_FAULTS: &str = "Clear faults";
pub(in crate::console) const ONCE_NOBODY_IS_NEAR: &str =
    "Once nobody is near the arm and the cause is gone: it may move again.";
pub(in crate::console) const BEING_OPENED: &str = "being opened";
pub(in crate::console) const DISCONNECTED: &str = "disconnected";

/// Why an arm stays disengaged.
pub(in crate::console) fn not_to_be_engaged(side: &str, obstacle: &impl std::fmt::Display) -> String {
    format!("The {side} arm cannot be engaged: {obstacle}.")
}

/// What a device is.
pub(in crate::console) fn identity(product: &str, serial: &str, firmware: &str) -> String {
    format!("{product} {serial}, firmware {firmware}")
}

/// The name of the button that clears them.
pub(in crate::console) fn clear_faults_of(name: &str) -> String {
    format!("Clear faults of the {name}")
}

/// How well a device delivers.
pub(in crate::console) fn delivery(rate_hz: f64, lost: u64, damaged: u64, refused: u64) -> String {
    format!("{rate_hz:.0} Hz; lost {lost}, damaged {damaged}, refused {refused}")
}

/// A device that went.
pub(in crate::console) fn lost(cause: &str, delivery: &str) -> String {
    format!("lost: {cause}; {delivery}")
}
