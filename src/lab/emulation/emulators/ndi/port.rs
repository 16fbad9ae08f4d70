//! A tool handle of the emulated unit.

use std::fmt::Write as _;

use nima_devices::ndi::{definition::DEFINITION, text::PortStatus};

/// The unit's state of one handle.
#[derive(Clone, Debug)]
pub(super) struct NdiPort {
    pub(super) handle: u8,
    pub(super) number: usize,
    pub(super) definition: Box<[u8; DEFINITION]>,
    pub(super) written: bool,
    pub(super) initialised: bool,
    pub(super) enabled: bool,
}

impl NdiPort {
    pub(super) fn status(&self) -> u32 {
        let bit = |on, bit| if on { bit } else { 0 };
        bit(self.written, PortStatus::OCCUPIED)
            | bit(self.initialised, PortStatus::INITIALISED)
            | bit(self.enabled, PortStatus::ENABLED)
    }
}

/// Returns the answer to `PHINF` for its option bits, in their order (reference 1.3).
pub(super) fn information(port: &NdiPort, options: u16) -> String {
    let mut text = String::new();
    let status = port.status() & 0xFF;
    if options & 0x01 != 0 {
        write!(text, "02000000{:<12}001{:08X}{status:02X}", "NIMA", port.number).ok();
    }
    if options & 0x02 != 0 {
        text.push_str("00000000");
    }
    if options & 0x04 != 0 {
        let name: String = port.definition[592..612].iter().map(|byte| char::from(*byte)).collect();
        let name: String = name.chars().filter(char::is_ascii_graphic).collect();
        write!(text, "{name:<20}").ok();
    }
    for (bit, part) in [(0x08, "00"), (0x10, "29"), (0x20, "00000000000000"), (0x40, "00")] {
        if options & bit != 0 {
            text.push_str(part);
        }
    }
    text
}
