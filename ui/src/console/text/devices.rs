//! The panel of devices: connection, data rate, faults.

pub(in crate::console) const NONE: &str = "This rig is simulated: it has no devices";
pub(in crate::console) const DISCONNECT: &str = "Disconnect";
pub(in crate::console) const CONNECT: &str = "Connect";
pub(in crate::console) const CONNECT_HOVER: &str =
    "A lost device is reconnected automatically until you press Disconnect";
pub(in crate::console) const CLEAR_FAULTS: &str = "Clear faults";
pub(in crate::console) const CLEAR_FAULTS_HOVER: &str =
    "Make sure that nobody is near the arm and the cause is gone: afterwards the arm may move again";
pub(in crate::console) const OPENING: &str = "connecting";
pub(in crate::console) const DISCONNECTED: &str = "disconnected";

/// Why an arm cannot be engaged.
pub(in crate::console) fn not_to_be_engaged(side: &str, obstacle: &impl std::fmt::Display) -> String {
    format!("The {side} arm cannot be engaged: {obstacle}")
}

/// Identity of a device.
pub(in crate::console) fn identity(product: &str, serial: &str, firmware: &str) -> String {
    format!("{product} {serial}, firmware {firmware}")
}

/// Accessible name of the button that clears a device's faults.
pub(in crate::console) fn clear_faults_of(name: &str) -> String {
    format!("Clear faults of the {name}")
}

/// Rate and losses of a device.
pub(in crate::console) fn delivery(rate_hz: f64, lost: u64, damaged: u64, refused: u64) -> String {
    format!("{rate_hz:.0} Hz; lost {lost}, damaged {damaged}, refused {refused}")
}

/// Number and longest duration of the outages.
pub(in crate::console) fn outages(count: u64, longest_s: f64) -> String {
    format!("; lost {count} times since the start, at longest for {longest_s:.1} s")
}

/// A device that was lost.
pub(in crate::console) fn lost(cause: &str, delivery: &str) -> String {
    format!("lost: {cause}; {delivery}")
}
