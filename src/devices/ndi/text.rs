//! Texts for the unit's error codes and status bits.
//!
//! Sources: `ndicapi` (errors) and NDI's Python client (`bx.py`, status bits); reference `ndi.md`,
//! sections 1.7 and 1.8.

/// An error reply, `ERRORnn`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ErrorCode(pub u8);

impl ErrorCode {
    pub const INVALID_COMMAND: Self = Self(0x01);
    pub const TOO_LONG: Self = Self(0x02);
    pub const TOO_SHORT: Self = Self(0x03);
    pub const BAD_CRC: Self = Self(0x04);
    /// Invalid line parameters.
    pub const COMM_PARAMETERS: Self = Self(0x06);
    /// Wrong number of parameters.
    pub const PARAMETER_COUNT: Self = Self(0x07);
    pub const INVALID_HANDLE: Self = Self(0x08);
    /// Priority other than S, D or B.
    pub const INVALID_PRIORITY: Self = Self(0x09);
    /// Not possible in this mode (tracking or not tracking).
    pub const INVALID_MODE: Self = Self(0x0C);
    pub const NO_TOOL: Self = Self(0x0D);
    pub const NOT_INITIALISED: Self = Self(0x0E);
    pub const NOT_ENABLED: Self = Self(0x0F);
    /// `INIT` was not sent.
    pub const SYSTEM_NOT_INITIALISED: Self = Self(0x10);
    pub const OUT_OF_RANGE: Self = Self(0x23);
    pub const NO_HANDLES_LEFT: Self = Self(0x2D);
    pub const NO_SUCH_PARAMETER: Self = Self(0x34);
    pub const READ_ONLY: Self = Self(0x39);

    /// Returns the text for a message.
    pub const fn words(self) -> &'static str {
        match self.0 {
            0x01 => "unknown command",
            0x02 => "command too long",
            0x03 => "command too short",
            0x04 => "checksum of the command is wrong",
            0x05 => "the command took too long",
            0x06 => "the line parameters are invalid",
            0x07 => "wrong number of parameters",
            0x08 => "unknown tool handle",
            0x09 => "unknown tracking priority",
            0x0A | 0x0B => "unknown light or state of a light",
            0x0C => "not possible in the current mode",
            0x0D => "the port handle has no tool",
            0x0E => "the tool is not initialised",
            0x0F => "the tool is not enabled",
            0x10 => "the system is not initialised",
            0x11 => "tracking cannot be stopped",
            0x12 => "tracking cannot be started",
            0x13 => "the tool cannot be initialised",
            0x14 => "the calibration of the camera is damaged",
            0x15 => "the system cannot be initialised",
            0x16 | 0x17 => "diagnostics cannot be started or stopped",
            0x19 => "the firmware version cannot be read",
            0x1A => "internal fault",
            0x1C => "the markers' firing cannot be set",
            0x1E | 0x1F => "the tool's memory cannot be read or written",
            0x21 => "the tool's current test failed",
            0x22 => "no camera parameters for the tool's wavelength",
            0x23 => "a parameter is out of range",
            0x24 => "no camera parameters for this volume",
            0x25 => "the features cannot be determined",
            0x28 => "too many tools, or the hardware has changed",
            0x2A => "out of memory",
            0x2B => "the port handle was not allocated",
            0x2C => "the port handle is empty",
            0x2D => "no free port handle is left",
            0x2E => "the firmware versions of the parts are incompatible",
            0x2F => "unknown port",
            0x30 => "the port already has a port handle",
            0x32 => "not possible",
            0x33 => "this feature is not available",
            0x34 => "unknown user parameter",
            0x35..=0x38 => "the user parameter's type, range, index or size is wrong",
            0x39 => "the user parameter is read-only",
            0x3B..=0x3D => "a file of the unit cannot be found, written or read",
            0x40 | 0x41 => "the tool definition is not usable",
            0x42 => "a part of the system is missing",
            0xF1 => "too much infrared light",
            0xF4..=0xF6 => "the unit's flash memory cannot be read, written or erased",
            _ => "undocumented error code",
        }
    }
}

impl std::fmt::Display for ErrorCode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} (ERROR{:02X})", self.words(), self.0)
    }
}

/// Status of one tool, as in `TX`, `BX` and (its low 12 bits) `PHSR`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PortStatus(pub u32);

impl PortStatus {
    /// A tool is present.
    pub const OCCUPIED: u32 = 1;
    /// Initialised with `PINIT`.
    pub const INITIALISED: u32 = 1 << 4;
    /// Enabled with `PENA`.
    pub const ENABLED: u32 = 1 << 5;
    /// Outside the measurement volume.
    pub const OUT_OF_VOLUME: u32 = 1 << 6;
    /// Some markers are outside the measurement volume.
    pub const PARTLY_OUT: u32 = 1 << 7;

    pub const fn has(self, bits: u32) -> bool {
        self.0 & bits != 0
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SystemStatus(pub u16);

impl SystemStatus {
    /// Bits that make the readings unreliable: sync error, recoverable exception, temperature, changed hardware.
    pub const FAULTS: u16 = 1 | 1 << 3 | 1 << 9 | 1 << 10;
    /// A recoverable processing exception.
    pub const EXCEPTION: u16 = 1 << 3;
    /// A tool was plugged in.
    pub const TOOL_CAME: u16 = 1 << 6;
    /// A tool was unplugged.
    pub const TOOL_WENT: u16 = 1 << 7;
    /// A diagnostic message is waiting (about a bump, for instance).
    pub const DIAGNOSTIC: u16 = 1 << 8;

    /// Returns the fault bits that are set; 0 without a fault.
    pub const fn faults(self) -> u16 {
        self.0 & Self::FAULTS
    }

    /// Returns the text for the most serious fault; empty without a fault.
    pub const fn words(self) -> &'static str {
        match self.0 & Self::FAULTS {
            0 => "",
            bits if bits & 1 != 0 => "its parts are out of step (communication synchronisation error)",
            bits if bits & 1 << 3 != 0 => "an exception occurred while processing",
            bits if bits & 1 << 9 != 0 => "its temperature is out of range",
            _ => "its hardware configuration has changed",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_faults_are_told_in_words() {
        assert_eq!(ErrorCode(0x0C).to_string(), "not possible in the current mode (ERROR0C)");
        assert_eq!(ErrorCode(0xEE).to_string(), "undocumented error code (ERROREE)");
        assert_eq!(SystemStatus(0x01C0).faults(), 0, "plugging, unplugging and messages are not faults");
        for bit in [0, 3, 9, 10] {
            assert!(!SystemStatus(1 << bit).words().is_empty());
        }
    }
}
