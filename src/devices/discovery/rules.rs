//! The udev rules that give users access to the devices.

use super::plugged::UsbIds;

/// All rules, as installed.
pub const RULES: &str = include_str!("../../../assets/70-nima.rules");
/// Installed location; the number must be below 73, the rule file in which systemd grants access to the user.
pub const FILE: &str = "/etc/udev/rules.d/70-nima.rules";

// `uaccess` gives the user at the machine access; the group is for systems without systemd and for remote logins.
const RIGHTS: &str = r#"MODE="0660", GROUP="plugdev", TAG+="uaccess""#;

/// Returns the rule for one human interface device, or for all of them.
pub fn of_hidraw(ids: Option<(u16, u16)>) -> String {
    let ids = ids.map(|(vendor, product)| matching(vendor, product)).unwrap_or_default();
    format!(r#"KERNEL=="hidraw*", {ids}{RIGHTS}"#)
}

/// Returns the rule for one serial port, or for all serial ports on USB.
pub fn of_serial(ids: Option<&UsbIds>) -> String {
    match ids {
        Some(UsbIds { vendor, product, .. }) => {
            format!(r#"SUBSYSTEM=="tty", {}{RIGHTS}"#, matching(*vendor, *product))
        }
        None => format!(r#"SUBSYSTEM=="tty", SUBSYSTEMS=="usb", {RIGHTS}"#),
    }
}

fn matching(vendor: u16, product: u16) -> String {
    format!(r#"ATTRS{{idVendor}}=="{vendor:04x}", ATTRS{{idProduct}}=="{product:04x}", "#)
}

/// Returns a single command that installs the output of `program devices --udev-rules`.
pub fn install_command(program: &str) -> String {
    let quoted = format!("'{}'", program.replace('\'', r"'\''"));
    format!(
        "{quoted} devices --udev-rules | sudo tee {FILE} >/dev/null && sudo udevadm control --reload && sudo udevadm trigger"
    )
}
