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
