//! Identity of the unit from the reply to `VER:0`, and the format of tracking replies that its firmware supports
//! (reference 1.3).

use nima_files::quoted;

use super::command::ReplyForm;
use crate::DeviceIdentity;

/// Firmware versions whose `BX` is unreliable and which therefore use `TX`.
const TEXT_ONLY: [&str; 5] =
    ["AURORA Rev 007", "AURORA Rev 008", "Polaris Vega 008", "Polaris Spectra Rev 006", "Polaris Spectra Rev 007"];

/// Parses the lines of `VER:0`. Missing fields stay empty.
pub fn identity_of(text: &str) -> DeviceIdentity {
    let after = |keys: &[&str]| {
        let found = text.lines().find_map(|line| keys.iter().find_map(|key| line.trim().strip_prefix(key)));
        found.map(|value| quoted(value.trim_start_matches([' ', ':']).trim())).unwrap_or_default()
    };
    let product = text.lines().next().unwrap_or_default().trim();
    DeviceIdentity {
        product: quoted(product.strip_suffix("Control Firmware").unwrap_or(product).trim()),
        serial: after(&["NDI S/N", "NDI Serial Number"]),
        firmware: after(&["Freeze Tag"]),
    }
}

/// Returns the format of tracking replies for this firmware.
pub fn form_of(firmware: &str) -> ReplyForm {
    if TEXT_ONLY.contains(&firmware) { ReplyForm::Text } else { ReplyForm::Binary }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_is_known_by_its_version_text() {
        let text = "Polaris Vega Control Firmware\nNDI S/N: P9-00042\nFreeze Tag: Polaris Vega 008\nFreeze Date: 1\n";
        let identity = identity_of(text);
        assert_eq!(identity.product, "Polaris Vega");
        assert_eq!((identity.serial.as_str(), identity.firmware.as_str()), ("P9-00042", "Polaris Vega 008"));
        assert_eq!(form_of(&identity.firmware), ReplyForm::Text);
        assert_eq!((identity_of(""), form_of("Polaris Vega 014")), (DeviceIdentity::default(), ReplyForm::Binary));
    }
}
