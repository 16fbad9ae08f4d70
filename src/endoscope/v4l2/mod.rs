//! Cameras and capture cards of this computer, through the kernel's `Video4Linux2`: motion JPEG, YUYV and NV12, in
//! buffers that are shared with the driver. Only the newest image is used; older buffers are returned to the driver
//! unread.

mod kernel;
mod layout;

use std::{
    io::{Error, ErrorKind},
    path::Path,
    time::{Duration, Instant},
};

use self::{
    kernel::{Kernel, KernelDevice},
    layout::{
        CAN_CAPTURE, CAN_CAPTURE_PLANES, CAN_STREAM, CAPTURE, CLOCK_MASK, CLOCK_MONOTONIC, DAMAGED, DQBUF,
        ENCODING_709, ENUM_FMT, ENUM_FRAMESIZES, G_FMT, HAS_OWN, KernelRequest, LayoutBlock, MEMORY_MMAP, QBUF,
        QUERYBUF, QUERYCAP, RANGE_FULL, RANGE_LIMITED, REQBUFS, S_FMT, S_PARM, SIZE_DISCRETE, SPACE_DCI_P3, SPACE_JPEG,
        SPACE_REC709, STREAMOFF, STREAMON, at,
    },
};
use crate::{
    Capture, Colours, CompressedFrame, EndoscopeError, Format, ImageSource, PixelLayout, Pixels, RawLayout,
    colour::{ColourMatrix, ValueRange},
};

/// Number of buffers requested, and minimum for a stream. One is filled while another is copied, and two are spare for
/// a slow reader; more would only delay the image.
const BUFFERS: u32 = 4;
/// With a single one the driver has nothing to fill while we copy.
const BUFFERS_MIN: u32 = 2;
/// After this time without images, the camera is closed and reopened. Some cameras take more than a second for the
/// first image.
const SILENT: Duration = Duration::from_secs(4);
const PATIENCE: Duration = Duration::from_millis(100);
/// Pause after a wait that ended without an image.
const NAP: Duration = Duration::from_millis(5);
/// Maximum number of formats or sizes queried from a driver.
const LISTED_MAX: u32 = 64;
/// A time stamp that is older than this, or in the future, is not from this clock. Some drivers count from their own
/// start although they report the monotonic clock.
const STAMP_MAX: Duration = Duration::from_secs(5);

/// A camera that is streaming.
struct V4l2 {
    kernel: Box<dyn Kernel>,
    place: String,
    format: Format,
    received: Instant,
}

/// Opens a camera of this computer.
pub(crate) fn open(path: &Path, wanted: Capture) -> Result<Box<dyn ImageSource>, EndoscopeError> {
    let place = path.display().to_string();
    let device = KernelDevice::open(path).map_err(|error| report(&place, &error, "opening it"))?;
    Ok(Box::new(V4l2::start(Box::new(device), place, wanted)?))
}

/// Converts an error of the kernel.
fn report(place: &str, error: &Error, doing: &str) -> EndoscopeError {
    let path = place.to_owned();
    match error.raw_os_error() {
        Some(libc::ENOENT | libc::ENXIO | libc::ENODEV) => EndoscopeError::NoCamera { path },
        Some(libc::EBUSY) => EndoscopeError::Busy { path },
        Some(libc::EACCES | libc::EPERM) => EndoscopeError::NoPermission { path },
        // A file or folder that exists but is not a device answers like this.
        Some(libc::ENOTTY | libc::ENOTDIR | libc::EISDIR) => EndoscopeError::NotCamera { path },
        _ => EndoscopeError::Camera { path, reason: format!("{doing} failed: {error}") },
    }
}

/// Returns the four letters with which drivers name a format.
fn name_of(pixels: u32) -> String {
    pixels.to_le_bytes().iter().map(|byte| if byte.is_ascii_graphic() { char::from(*byte) } else { '?' }).collect()
}

impl Pixels {
    /// Returns the driver's names: motion JPEG has two.
    const fn names(self) -> &'static [&'static [u8; 4]] {
        match self {
            Self::Mjpeg => &[b"MJPG", b"JPEG"],
            Self::Yuyv => &[b"YUYV"],
            Self::Nv12 => &[b"NV12"],
        }
    }
}

/// Formats in order of preference: motion JPEG allows the highest frame rate over USB.
const PREFERRED: [Pixels; 3] = [Pixels::Mjpeg, Pixels::Nv12, Pixels::Yuyv];

impl V4l2 {
    fn start(mut kernel: Box<dyn Kernel>, place: String, wanted: Capture) -> Result<Self, EndoscopeError> {
        let mut opening = CameraOpening { kernel: &mut *kernel, place: &place };
        opening.check()?;
        let (pixels, code) = opening.choose(wanted.pixels)?;
        let format = opening.set(pixels, code, wanted)?;
        opening.stream()?;
        Ok(Self { kernel, place, format, received: Instant::now() })
    }

    /// Returns the next filled buffer: its number, its used bytes, and its time stamp.
    fn take(&mut self) -> Result<Option<LayoutBlock>, EndoscopeError> {
        let mut buffer = LayoutBlock::of(DQBUF).with(at::BUF_TYPE, CAPTURE).with(at::BUF_MEMORY, MEMORY_MMAP);
        match self.kernel.ioctl(DQBUF, &mut buffer.0) {
            Ok(()) => Ok(Some(buffer)),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(None),
            Err(error) => Err(self.lost(&error)),
        }
    }

    /// Returns a buffer to the driver.
    fn give(&mut self, index: u32) -> Result<(), EndoscopeError> {
        let mut buffer = queued(index);
        self.kernel.ioctl(QBUF, &mut buffer.0).map_err(|error| self.lost(&error))
    }

    fn lost(&self, error: &Error) -> EndoscopeError {
        let path = self.place.clone();
        match error.raw_os_error() {
            Some(libc::ENODEV | libc::ENXIO) => EndoscopeError::Unplugged { path },
            _ => EndoscopeError::Camera { path, reason: format!("the stream has ended: {error}") },
        }
    }

    /// Returns the newest available image; older ones are returned to the driver.
    fn newest(&mut self) -> Result<Option<CompressedFrame>, EndoscopeError> {
        let mut newest: Option<LayoutBlock> = None;
        while let Some(buffer) = self.take()? {
            // Any data count as a sign of life, even an image that cannot be shown.
            self.received = Instant::now();
            // A driver marks buffers of a disturbed transfer; an empty one has no image.
            let is_whole = buffer.get(at::BUF_FLAGS) & DAMAGED == 0 && buffer.get(at::BUF_USED) > 0;
            let older = if is_whole { newest.replace(buffer) } else { Some(buffer) };
            if let Some(older) = older {
                self.give(older.get(0))?;
            }
        }
        let Some(buffer) = newest else { return Ok(None) };
        // Copied before the buffer is returned, because the driver may fill it again at once.
        let mut bytes = self.kernel.copy(buffer.get(0) as usize, buffer.get(at::BUF_USED) as usize);
        if self.format == Format::Jpeg {
            // Some drivers pad the buffer.
            let end = bytes.iter().rposition(|byte| *byte != 0).map_or(0, |at| at + 1);
            bytes.truncate(end);
        }
        let taken = self.taken(&buffer);
        self.give(buffer.get(0))?;
        Ok(Some(CompressedFrame { format: self.format, bytes, arrived: self.received, stamp_s: None, taken }))
    }

    /// Returns when the driver received the image, if its stamps use our clock.
    fn taken(&self, buffer: &LayoutBlock) -> Option<Instant> {
        if buffer.get(at::BUF_FLAGS) & CLOCK_MASK != CLOCK_MONOTONIC {
            return None;
        }
        let seconds = u64::try_from(buffer.long(at::BUF_SECONDS)).ok()?;
        let microseconds = u32::try_from(buffer.long(at::BUF_MICROSECONDS)).ok().filter(|us| *us < 1_000_000)?;
        let ago = self.kernel.now().checked_sub(Duration::new(seconds, 1000 * microseconds))?;
        if ago > STAMP_MAX { None } else { Instant::now().checked_sub(ago) }
    }
}

impl ImageSource for V4l2 {
    fn next(&mut self) -> Result<Option<CompressedFrame>, EndoscopeError> {
        if let Some(compressed) = self.newest()? {
            return Ok(Some(compressed));
        }
        let begin = Instant::now();
        self.kernel.wait(PATIENCE).map_err(|error| self.lost(&error))?;
        let newest = self.newest()?;
        if newest.is_none() && self.received.elapsed() > SILENT {
            return Err(EndoscopeError::NoPictures { path: self.place.clone() });
        }
        // A driver that reports data and delivers none would otherwise keep a processor busy.
        if newest.is_none() && begin.elapsed() < NAP {
            std::thread::sleep(NAP);
        }
        Ok(newest)
    }
}

impl Drop for V4l2 {
    fn drop(&mut self) {
        // An unplugged camera cannot answer, and nothing remains to be done for it.
        self.kernel.ioctl(STREAMOFF, &mut CAPTURE.to_ne_bytes()).ok();
    }
}

fn queued(index: u32) -> LayoutBlock {
    LayoutBlock::of(QBUF).with(0, index).with(at::BUF_TYPE, CAPTURE).with(at::BUF_MEMORY, MEMORY_MMAP)
}

/// A camera that is being opened.
struct CameraOpening<'a> {
    kernel: &'a mut dyn Kernel,
    place: &'a str,
}

impl CameraOpening<'_> {
    fn ask(&mut self, request: KernelRequest, block: &mut LayoutBlock, doing: &str) -> Result<(), EndoscopeError> {
        self.kernel.ioctl(request, &mut block.0).map_err(|error| report(self.place, &error, doing))
    }

    /// Checks that the device is a camera that can stream.
    fn check(&mut self) -> Result<(), EndoscopeError> {
        let path = || self.place.to_owned();
        let mut about = LayoutBlock::of(QUERYCAP);
        match self.kernel.ioctl(QUERYCAP, &mut about.0) {
            Err(error) if error.raw_os_error() == Some(libc::EINVAL) => {
                return Err(EndoscopeError::NotCamera { path: path() });
            }
            answer => answer.map_err(|error| report(self.place, &error, "querying its capabilities"))?,
        }
        let all = about.get(at::CAP_ALL);
        // The first field describes the whole hardware; only the second one, where it exists, describes this device
        // file.
        let able = if all & HAS_OWN == 0 { all } else { about.get(at::CAP_OWN) };
        let card = about.text(at::CAP_CARD, 32);
        // Tested first, so that such a camera is not reported as something that is not a camera.
        if able & CAN_CAPTURE == 0 && able & CAN_CAPTURE_PLANES != 0 {
            let reason = format!("{card} sends its images in several planes, which is not supported");
            return Err(EndoscopeError::Camera { path: path(), reason });
        }
        if able & CAN_CAPTURE == 0 {
            return Err(EndoscopeError::NotCamera { path: path() });
        }
        if able & CAN_STREAM == 0 {
            let reason = format!("{card} does not support streaming");
            return Err(EndoscopeError::Camera { path: path(), reason });
        }
        Ok(())
    }

    /// Selects a format that the camera and this program support.
    fn choose(&mut self, wanted: Option<Pixels>) -> Result<(Pixels, u32), EndoscopeError> {
        let mut offered = Vec::new();
        for index in 0..LISTED_MAX {
            let mut block = LayoutBlock::of(ENUM_FMT).with(0, index).with(at::FMTDESC_TYPE, CAPTURE);
            if self.kernel.ioctl(ENUM_FMT, &mut block.0).is_err() {
                break;
            }
            offered.push(block.get(at::FMTDESC_PIXELS));
        }
        let known = PREFERRED.into_iter().filter(|pixels| wanted.is_none_or(|wanted| wanted == *pixels));
        let mut codes =
            known.flat_map(|pixels| pixels.names().iter().map(move |name| (pixels, u32::from_le_bytes(**name))));
        codes.find(|(_, code)| offered.contains(code)).ok_or_else(|| EndoscopeError::NoSuchFormat {
            path: self.place.to_owned(),
            wanted: wanted
                .map_or("MJPG, NV12 or YUYV".to_owned(), |pixels| name_of(u32::from_le_bytes(*pixels.names()[0]))),
            offered: listed(offered.into_iter().map(name_of)),
        })
    }

    /// Sets format, size and rate.
    fn set(&mut self, pixels: Pixels, code: u32, wanted: Capture) -> Result<Format, EndoscopeError> {
        let mut block = LayoutBlock::of(G_FMT).with(0, CAPTURE);
        self.ask(G_FMT, &mut block, "asking for its format")?;
        let before = [block.get(at::FMT_WIDTH), block.get(at::FMT_HEIGHT)];
        let [width, height] = wanted.size_px.map_or(before, |size_px| size_px.map(|side| side as u32));
        let mut block = LayoutBlock::of(S_FMT).with(0, CAPTURE).with(at::FMT_PIXELS, code).with(at::FMT_FIELD, 1);
        block.set(at::FMT_WIDTH, width);
        block.set(at::FMT_HEIGHT, height);
        self.ask(S_FMT, &mut block, "setting its format")?;
        let size_px = [block.get(at::FMT_WIDTH), block.get(at::FMT_HEIGHT)].map(|side| side as usize);
        let path = || self.place.to_owned();
        // A driver may change a format that it does not support instead of refusing it.
        if block.get(at::FMT_PIXELS) != code {
            let offered = name_of(block.get(at::FMT_PIXELS));
            return Err(EndoscopeError::NoSuchFormat { path: path(), wanted: name_of(code), offered });
        }
        // The same applies to the size, and a lens calibrated for one size does not fit another.
        if wanted.size_px.is_some_and(|wanted| wanted != size_px) {
            let path = path();
            return Err(EndoscopeError::NoSuchSize { path, wanted: [width, height], offered: self.sizes(code) });
        }
        crate::jpeg::check_size(size_px).map_err(|damage| EndoscopeError::Camera {
            path: path(),
            reason: format!("its size cannot be used: {damage}"),
        })?;
        self.set_rate(wanted.rate_hz);
        let colours = colours(&block);
        let raw = |layout, stride| RawLayout { layout, colours, size_px, stride };
        let stride = block.get(at::FMT_STRIDE) as usize;
        Ok(match pixels {
            Pixels::Mjpeg => Format::Jpeg,
            // Some drivers leave the length of a row at zero; it is at least the pixels themselves.
            Pixels::Yuyv => Format::Raw(raw(PixelLayout::Yuyv, stride.max(2 * size_px[0]))),
            Pixels::Nv12 => Format::Raw(raw(PixelLayout::Nv12, stride.max(size_px[0]))),
        })
    }

    /// Requests a rate. A camera without this setting has a fixed rate; others use the nearest one available. The
    /// screen shows the actual rate.
    fn set_rate(&mut self, rate_hz: Option<u32>) {
        let Some(rate_hz) = rate_hz else { return };
        let block = LayoutBlock::of(S_PARM).with(0, CAPTURE).with(at::PARM_NUMERATOR, 1);
        let mut block = block.with(at::PARM_DENOMINATOR, rate_hz);
        self.kernel.ioctl(S_PARM, &mut block.0).ok();
    }

    /// Returns the sizes that a driver offers for a format.
    fn sizes(&mut self, code: u32) -> String {
        let mut sizes = Vec::new();
        for index in 0..LISTED_MAX {
            let mut block = LayoutBlock::of(ENUM_FRAMESIZES).with(0, index).with(at::SIZE_PIXELS, code);
            if self.kernel.ioctl(ENUM_FRAMESIZES, &mut block.0).is_err() {
                break;
            }
            if block.get(at::SIZE_TYPE) == SIZE_DISCRETE {
                sizes.push(format!("{}x{}", block.get(at::SIZE_WIDTH), block.get(at::SIZE_HEIGHT)));
            } else {
                let max = [at::SIZE_MAX_WIDTH, at::SIZE_MAX_HEIGHT].map(|place| block.get(place));
                sizes.push(format!("up to {}x{}", max[0], max[1]));
                break;
            }
        }
        listed(sizes.into_iter())
    }

    /// Allocates buffers, passes them to the driver and starts the stream.
    fn stream(&mut self) -> Result<(), EndoscopeError> {
        let block = LayoutBlock::of(REQBUFS).with(0, BUFFERS).with(at::REQ_TYPE, CAPTURE);
        let mut block = block.with(at::REQ_MEMORY, MEMORY_MMAP);
        self.ask(REQBUFS, &mut block, "requesting buffers")?;
        // The driver may grant fewer buffers than requested, or more.
        let count = block.get(0);
        if !(BUFFERS_MIN..=32).contains(&count) {
            let reason = format!("the driver provides {count} buffers");
            return Err(EndoscopeError::Camera { path: self.place.to_owned(), reason });
        }
        for index in 0..count {
            let mut block = queued(index);
            self.ask(QUERYBUF, &mut block, "asking for a buffer")?;
            let offset = block.get(at::BUF_OFFSET);
            let length = block.get(at::BUF_LENGTH) as usize;
            self.kernel.map(offset, length).map_err(|error| report(self.place, &error, "sharing a buffer"))?;
        }
        for index in 0..count {
            self.ask(QBUF, &mut queued(index), "handing a buffer over")?;
        }
        let mut on = LayoutBlock(CAPTURE.to_ne_bytes().to_vec());
        match self.kernel.ioctl(STREAMON, &mut on.0) {
            Err(error) if error.raw_os_error() == Some(libc::ENOSPC) => {
                Err(EndoscopeError::NoBandwidth { path: self.place.to_owned() })
            }
            // No other error has a specific remedy.
            answer => answer.map_err(|error| report(self.place, &error, "starting the stream")),
        }
    }
}

/// Joins a few names.
fn listed(names: impl Iterator<Item = String>) -> String {
    let names: Vec<String> = names.take(12).collect();
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}

/// Returns the interpretation of the colours, as reported by the driver or implied by its colour space.
fn colours(format: &LayoutBlock) -> Colours {
    let space = format.get(at::FMT_SPACE);
    let is_709 = match format.get(at::FMT_ENCODING) {
        0 => matches!(space, SPACE_REC709 | SPACE_DCI_P3),
        encoding => ENCODING_709.contains(&encoding),
    };
    let is_full = match format.get(at::FMT_RANGE) {
        RANGE_FULL => true,
        RANGE_LIMITED => false,
        _ => space == SPACE_JPEG,
    };
    Colours {
        matrix: if is_709 { ColourMatrix::Bt709 } else { ColourMatrix::Bt601 },
        range: if is_full { ValueRange::Full } else { ValueRange::Limited },
    }
}

#[cfg(test)]
mod tests;
