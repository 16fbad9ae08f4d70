//! A serial line that never waits, with the low-latency flag if the port supports it.

use std::{
    io::{ErrorKind, Read as _, Write},
    path::Path,
    time::Duration,
};

use serde::{Deserialize, Serialize};

#[cfg(unix)]
use serialport::SerialPort as _;

use super::ByteStream;
#[cfg(unix)]
use crate::os;
use crate::{DeviceError, Loss};

/// Settings of a line; always 8 bits, no parity, one stop bit, no handshake.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SerialSettings {
    /// Device file, or `COM3`.
    pub port: String,
    pub baud: u32,
}

pub struct Serial {
    /// Used for the settings of the line.
    port: SystemPort,
    /// Used for the bytes. The port's own `read` allocates an error whenever nothing has arrived.
    #[cfg(unix)]
    bytes: std::fs::File,
    low_latency: bool,
}

#[cfg(unix)]
type SystemPort = serialport::TTYPort;
#[cfg(not(unix))]
type SystemPort = Box<dyn serialport::SerialPort>;

impl std::fmt::Debug for Serial {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Serial").field("port", &self.port.name()).finish_non_exhaustive()
    }
}

/// udev rule: members of `plugdev` may use any USB serial adapter.
const UDEV: &str = r#"SUBSYSTEM=="tty", SUBSYSTEMS=="usb", GROUP="plugdev", MODE="0660", TAG+="uaccess""#;

impl Serial {
    /// Opens the line. Some sensors restart when their line is opened (DTR).
    ///
    /// # Errors
    /// [`DeviceError`] if the port is missing, in use, not permitted, or does not support the settings.
    pub fn open(settings: &SerialSettings) -> Result<Self, DeviceError> {
        let SerialSettings { port, baud } = settings;
        let builder = serialport::new(port, *baud).timeout(Duration::from_millis(1));
        #[cfg(unix)]
        {
            let native = builder.open_native().map_err(|error| Self::trouble(port, &error))?;
            let other = |error: std::io::Error| DeviceError::Other { place: port.clone(), reason: error.to_string() };
            let bytes = os::bytes_of(&native).map_err(other)?;
            let low_latency = os::ask_low_latency(&native);
            Ok(Self { port: native, bytes, low_latency })
        }
        #[cfg(not(unix))]
        {
            Ok(Self { port: builder.open().map_err(|error| Self::trouble(port, &error))?, low_latency: false })
        }
    }

    /// Returns whether the port's driver delivers bytes without delay instead of collecting them for up to 16 ms.
    pub const fn has_low_latency(&self) -> bool {
        self.low_latency
    }

    /// Returns a second writer of the open line for another thread; `None` if the system does not provide one.
    pub(crate) fn another_writer(&self) -> Option<Box<dyn Write + Send>> {
        #[cfg(unix)]
        {
            self.bytes.try_clone().ok().map(|file| Box::new(file) as Box<dyn Write + Send>)
        }
        #[cfg(not(unix))]
        {
            self.port.try_clone().ok().map(|port| Box::new(port) as Box<dyn Write + Send>)
        }
    }

    /// Returns the errors counted by the port's hardware (framing, parity, overrun, break); `None` if it does not count
    /// them.
    #[cfg_attr(not(unix), expect(clippy::unused_self, reason = "only other systems count"))]
    pub fn line_errors(&self) -> Option<u32> {
        #[cfg(unix)]
        {
            os::line_errors(&self.port)
        }
        #[cfg(not(unix))]
        {
            None
        }
    }

    /// Changes the speed of the open line.
    ///
    /// # Errors
    /// [`Loss::Disconnected`] if the port refuses the speed or is gone.
    pub fn set_baud(&mut self, baud: u32) -> Result<(), Loss> {
        self.port.set_baud_rate(baud).map_err(|_| Loss::Disconnected)
    }

    /// Sends a break of this length (blocks, so only while opening).
    ///
    /// # Errors
    /// [`Loss::Disconnected`] if the port refuses or is gone.
    pub fn send_break(&mut self, length: Duration) -> Result<(), Loss> {
        self.port.set_break().map_err(|_| Loss::Disconnected)?;
        std::thread::sleep(length);
        self.port.clear_break().map_err(|_| Loss::Disconnected)
    }

    /// Discards the data that have arrived.
    ///
    /// # Errors
    /// [`Loss::Disconnected`] if the port is gone.
    pub fn clear(&mut self) -> Result<(), Loss> {
        self.port.clear(serialport::ClearBuffer::Input).map_err(|_| Loss::Disconnected)
    }

    fn trouble(port: &str, error: &serialport::Error) -> DeviceError {
        let place = port.to_owned();
        match error.kind() {
            // The library reports a port that another program holds as if it were missing.
            serialport::ErrorKind::NoDevice if Path::new(port).exists() => DeviceError::Busy { place },
            serialport::ErrorKind::NoDevice => DeviceError::Absent { place },
            serialport::ErrorKind::Io(kind) => {
                DeviceError::of_port(Path::new(port), &std::io::Error::new(kind, error.description.clone()), UDEV)
            }
            _ => DeviceError::Other { place, reason: error.description.clone() },
        }
    }
}

impl Serial {
    #[cfg(unix)]
    const fn stream(&mut self) -> &mut std::fs::File {
        &mut self.bytes
    }

    #[cfg(not(unix))]
    const fn stream(&mut self) -> &mut SystemPort {
        &mut self.port
    }
}

impl ByteStream for Serial {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss> {
        match self.stream().read(buffer) {
            // Without data, reading is an error (raw mode waits for at least one byte), so 0 bytes mean that the line
            // was hung up.
            Ok(0) if !buffer.is_empty() => Err(Loss::Disconnected),
            Ok(count) => Ok(count),
            Err(error)
                if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted) =>
            {
                Ok(0)
            }
            // An unplugged adapter gives different errors on each system; all of them mean that the line is gone.
            Err(_) => Err(Loss::Disconnected),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        match self.stream().write(bytes) {
            // A message that was sent in part would be completed by the next one, and the device would read both
            // wrongly.
            Ok(count) if count == bytes.len() => Ok(()),
            _ => Err(Loss::Disconnected),
        }
    }
}
