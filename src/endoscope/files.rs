//! Images from files: one JPEG, a folder of them, or a sequence in a `.mjpeg` or `.h264` file. Sequences repeat at the
//! frame rate of a camera.

use std::{
    fs::{self, File},
    io::Read as _,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use crate::{CompressedFrame, EndoscopeError, Format, ImageSource, h264, jpeg::JpegSplitter};

/// Time from one image to the next.
const PERIOD: Duration = Duration::from_nanos(33_333_333);
/// Maximum time for which a source blocks its caller.
const PATIENCE: Duration = Duration::from_millis(100);
/// Maximum size of a file with one image, and maximum number of files in a folder.
const BYTES_MAX: u64 = 16 << 20;
const FILES_MAX: usize = 100_000;
const READ_BYTES: usize = 256 << 10;

pub(crate) fn open(path: &Path) -> Result<Box<dyn ImageSource>, EndoscopeError> {
    let about = fs::metadata(path).map_err(|error| trouble(path, &error))?;
    if about.is_dir() {
        return Ok(Box::new(PacedSeries::of(Folder { path: path.to_owned(), files: Vec::new().into_iter() })));
    }
    if is_jpeg(path) {
        return Ok(Box::new(StillImage { path: path.to_owned(), given: false }));
    }
    if is_stream(path) {
        if !h264::IS_BUILT {
            return Err(EndoscopeError::NotBuilt { what: "RTSP and H.264" });
        }
        return Ok(Box::new(PacedSeries::of(FileStream::open(path)?)));
    }
    Ok(Box::new(PacedSeries::of(JpegFile::open(path)?)))
}

fn trouble(path: &Path, error: &std::io::Error) -> EndoscopeError {
    let reason = match error.kind() {
        std::io::ErrorKind::NotFound => "no such file or folder".to_owned(),
        std::io::ErrorKind::PermissionDenied => "this user has no permission to read it".to_owned(),
        _ => error.to_string(),
    };
    EndoscopeError::File { path: path.display().to_string(), reason }
}

fn without_images(path: &Path) -> EndoscopeError {
    EndoscopeError::File { path: path.display().to_string(), reason: "it contains no complete JPEG".to_owned() }
}

fn is_jpeg(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("jpg") || ending.eq_ignore_ascii_case("jpeg"))
}

fn is_stream(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("h264") || ending.eq_ignore_ascii_case("264"))
}

fn read(path: &Path) -> Result<Vec<u8>, EndoscopeError> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| trouble(path, &error))?;
    file.take(BYTES_MAX + 1).read_to_end(&mut bytes).map_err(|error| trouble(path, &error))?;
    if bytes.len() as u64 > BYTES_MAX {
        let reason = format!("the image is larger than {} MB", BYTES_MAX >> 20);
        return Err(EndoscopeError::File { path: path.display().to_string(), reason });
    }
    Ok(bytes)
}

fn now(jpeg: Vec<u8>) -> CompressedFrame {
    CompressedFrame::jpeg(jpeg, Instant::now(), None)
}

struct StillImage {
    path: PathBuf,
    given: bool,
}

impl ImageSource for StillImage {
    fn next(&mut self) -> Result<Option<CompressedFrame>, EndoscopeError> {
        if self.given {
            thread::sleep(PATIENCE);
            return Ok(None);
        }
        self.given = true;
        Ok(Some(now(read(&self.path)?)))
    }

    fn is_still(&self) -> bool {
        true
    }
}

/// A sequence of images, as fast as they are requested.
trait ImageSeries: Send {
    fn next(&mut self) -> Result<Vec<u8>, EndoscopeError>;

    /// Returns the format of its images.
    fn format(&self, _: &[u8]) -> Format {
        Format::Jpeg
    }
}

/// Delivers a series at the frame rate of a camera.
struct PacedSeries<S> {
    series: S,
    due: Instant,
}

impl<S: ImageSeries> PacedSeries<S> {
    fn of(series: S) -> Self {
        Self { series, due: Instant::now() }
    }
}

impl<S: ImageSeries> ImageSource for PacedSeries<S> {
    fn next(&mut self) -> Result<Option<CompressedFrame>, EndoscopeError> {
        let bytes = self.series.next()?;
        let now_is = Instant::now();
        thread::sleep(self.due.saturating_duration_since(now_is));
        // Missed images are skipped.
        self.due = self.due.max(now_is) + PERIOD;
        let format = self.series.format(&bytes);
        Ok(Some(CompressedFrame { format, ..now(bytes) }))
    }
}

/// The JPEGs of a folder in the order of their names; the folder is read again after the last one.
struct Folder {
    path: PathBuf,
    files: std::vec::IntoIter<PathBuf>,
}

impl ImageSeries for Folder {
    fn next(&mut self) -> Result<Vec<u8>, EndoscopeError> {
        if let Some(file) = self.files.next() {
            return read(&file);
        }
        let entries = fs::read_dir(&self.path).map_err(|error| trouble(&self.path, &error))?;
        let paths = entries.flatten().map(|entry| entry.path()).filter(|path| is_jpeg(path));
        let mut files: Vec<PathBuf> = paths.take(FILES_MAX).collect();
        files.sort();
        self.files = files.into_iter();
        self.files.next().map_or_else(|| Err(without_images(&self.path)), |file| read(&file))
    }
}

/// A sequence of JPEGs in one file.
struct JpegFile {
    path: PathBuf,
    file: File,
    splitter: JpegSplitter,
    buffer: Vec<u8>,
    /// Images since the beginning of the file.
    found: u64,
}

impl JpegFile {
    fn open(path: &Path) -> Result<Self, EndoscopeError> {
        let file = File::open(path).map_err(|error| trouble(path, &error))?;
        let splitter = JpegSplitter::default();
        let buffer = vec![0; READ_BYTES];
        Ok(Self { path: path.to_owned(), file, splitter, buffer, found: 0 })
    }
}

impl ImageSeries for JpegFile {
    fn next(&mut self) -> Result<Vec<u8>, EndoscopeError> {
        loop {
            if let Some(jpeg) = self.splitter.next() {
                self.found += 1;
                return Ok(jpeg);
            }
            let count = self.file.read(&mut self.buffer).map_err(|error| trouble(&self.path, &error))?;
            self.splitter.take(&self.buffer[..count]);
            if count == 0 {
                if self.found == 0 {
                    return Err(without_images(&self.path));
                }
                *self = Self::open(&self.path)?;
            }
        }
    }
}

/// An H.264 stream in a file, as written by `ffmpeg -f h264`.
struct FileStream {
    path: PathBuf,
    file: File,
    splitter: h264::H264Splitter,
    buffer: Vec<u8>,
    found: bool,
}

impl FileStream {
    fn open(path: &Path) -> Result<Self, EndoscopeError> {
        let file = File::open(path).map_err(|error| trouble(path, &error))?;
        let splitter = h264::H264Splitter::default();
        let buffer = vec![0; READ_BYTES];
        Ok(Self { path: path.to_owned(), file, splitter, buffer, found: false })
    }
}

impl ImageSeries for FileStream {
    fn next(&mut self) -> Result<Vec<u8>, EndoscopeError> {
        loop {
            if let Some(unit) = self.splitter.next() {
                self.found = true;
                return Ok(unit);
            }
            let count = self.file.read(&mut self.buffer).map_err(|error| trouble(&self.path, &error))?;
            self.splitter.take(&self.buffer[..count]);
            if count == 0 {
                let last = self.splitter.rest();
                if last.is_none() && !self.found {
                    let reason = "it contains no H.264 image".to_owned();
                    return Err(EndoscopeError::File { path: self.path.display().to_string(), reason });
                }
                *self = Self::open(&self.path)?;
                if let Some(last) = last {
                    return Ok(last);
                }
            }
        }
    }

    fn format(&self, unit: &[u8]) -> Format {
        Format::H264 { is_key: h264::is_key(unit) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Address, jpeg};

    fn grey(value: u8) -> Vec<u8> {
        jpeg::encode(&[value; 3 * 64], [8, 8], 90)
    }

    fn next(source: &mut dyn ImageSource) -> Result<CompressedFrame, EndoscopeError> {
        loop {
            if let Some(compressed) = source.next()? {
                return Ok(compressed);
            }
        }
    }

    #[test]
    fn a_film_and_a_folder_begin_again_and_a_picture_stands_still() {
        let folder = tempfile::tempdir().unwrap();
        let film = folder.path().join("a.mjpeg");
        fs::write(&film, [grey(10), grey(100), grey(200)].concat()).unwrap();
        let mut source = Address::File(film).open().unwrap();
        let seen: Vec<Vec<u8>> = (0..4).map(|_| next(&mut *source).unwrap().bytes).collect();
        assert_eq!(seen, [grey(10), grey(100), grey(200), grey(10)]);
        assert!(!source.is_still());

        for (name, value) in [("2.jpg", 50), ("1.JPEG", 40), ("notes.txt", 60)] {
            fs::write(folder.path().join(name), grey(value)).unwrap();
        }
        let mut source = Address::File(folder.path().to_owned()).open().unwrap();
        let seen: Vec<Vec<u8>> = (0..3).map(|_| next(&mut *source).unwrap().bytes).collect();
        assert_eq!(seen, [grey(40), grey(50), grey(40)]);

        let mut source = Address::File(folder.path().join("2.jpg")).open().unwrap();
        assert_eq!(next(&mut *source).unwrap().bytes, grey(50));
        assert!(source.is_still() && source.next().unwrap().is_none());
    }

    #[test]
    fn what_is_not_there_or_has_no_picture_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let report = |path: PathBuf| {
            let mut source = match Address::File(path).open() {
                Ok(source) => source,
                Err(trouble) => return trouble.to_string(),
            };
            next(&mut *source).unwrap_err().to_string()
        };
        assert!(report(folder.path().join("missing.mjpeg")).contains("no such file or folder"));
        assert!(report(folder.path().to_owned()).contains("no complete JPEG"));
        let text = folder.path().join("text");
        fs::write(&text, "no picture").unwrap();
        assert!(report(text).contains("no complete JPEG"));
        let stream = folder.path().join("text.h264");
        fs::write(&stream, "no picture").unwrap();
        let expected = if h264::IS_BUILT { "no H.264 image" } else { "built without RTSP and H.264" };
        assert!(report(stream).contains(expected));
    }
}
