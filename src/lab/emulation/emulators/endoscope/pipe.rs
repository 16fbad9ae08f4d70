//! Writes images into a file or a named pipe, one after the other, for programs that read raw streams: JPEGs, or H.264
//! if the path has that ending. A slow reader gets fewer images, and a late one begins with the next image.

use std::{
    fs::OpenOptions,
    io::{self, Write as _},
    path::PathBuf,
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    thread::{self, Builder},
    time::Duration,
};

use nima_endoscope::{h264::H264Encoder, jpeg};

use super::render::Shot;
use crate::emulators::EmulatedFault;

const RETRY: Duration = Duration::from_millis(200);

/// An image to be written.
struct ImageJob {
    rgb: Vec<u8>,
    size_px: [usize; 2],
    fault: EmulatedFault,
}

pub(super) struct Pipe(SyncSender<ImageJob>);

/// Coding of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PipeCoding {
    Jpeg(u8),
    H264(f64),
}

impl PipeCoding {
    /// Chosen by the path's ending.
    fn of(path: &std::path::Path, rate_hz: f64, quality: u8) -> Self {
        let is_h264 = |ending: &std::ffi::OsStr| ["h264", "264"].iter().any(|known| ending.eq_ignore_ascii_case(known));
        if path.extension().is_some_and(is_h264) { Self::H264(rate_hz) } else { Self::Jpeg(quality) }
    }
}

/// Checks whether images can be coded for this path.
///
/// # Errors
/// In a program built without the required feature.
pub(super) fn check(path: &std::path::Path, rate_hz: f64) -> io::Result<()> {
    match PipeCoding::of(path, rate_hz, 1) {
        PipeCoding::Jpeg(_) => Ok(()),
        PipeCoding::H264(rate_hz) => H264Encoder::new(rate_hz).map(drop),
    }
}

impl Pipe {
    /// Writes on its own thread, because opening a named pipe blocks until there is a reader.
    pub(super) fn start(path: PathBuf, rate_hz: f64, quality: u8) -> io::Result<Self> {
        check(&path, rate_hz)?;
        let coding = PipeCoding::of(&path, rate_hz, quality);
        let (sender, jobs) = sync_channel(1);
        Builder::new().name("pipe".to_owned()).spawn(move || {
            // Ends with the emulator, which holds the other end of `jobs`.
            while let Ok(Some(())) = write(&path, coding, &jobs) {
                thread::sleep(RETRY);
            }
        })?;
        Ok(Self(sender))
    }

    /// Sends an image if the previous one has been written.
    pub(super) fn send(&self, shot: &Shot<'_>, fault: EmulatedFault) {
        self.0.try_send(ImageJob { rgb: shot.rgb.to_vec(), size_px: shot.size_px, fault }).ok();
    }
}

/// Writes until the reader closes the pipe (which is then opened again), or the emulator ends.
fn write(path: &std::path::Path, coding: PipeCoding, jobs: &Receiver<ImageJob>) -> io::Result<Option<()>> {
    let Ok(mut file) = OpenOptions::new().write(true).create(true).truncate(true).open(path) else {
        // If the folder does not exist yet, images that wait now will be outdated by then.
        return Ok(jobs.recv().ok().map(drop));
    };
    let mut encoder = None;
    while let Ok(ImageJob { rgb, size_px, fault }) = jobs.recv() {
        let mut bytes = match coding {
            _ if fault == EmulatedFault::OtherFormat => b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec(),
            PipeCoding::Jpeg(quality) => jpeg::encode(&rgb, size_px, quality),
            PipeCoding::H264(rate_hz) => {
                let encoder = match &mut encoder {
                    Some(encoder) => encoder,
                    none => none.insert(H264Encoder::new(rate_hz)?),
                };
                encoder.encode(&rgb, size_px, false)?
            }
        };
        if fault == EmulatedFault::Torn {
            bytes.truncate(bytes.len() * 6 / 10);
        }
        if file.write_all(&bytes).is_err() {
            return Ok(Some(()));
        }
    }
    Ok(None)
}
