//! A driver implemented as a table of requests, with the numbers of the kernel's header rather than ours.

use std::{
    collections::VecDeque,
    io,
    sync::{Arc, Mutex},
};

use super::*;
use crate::{Damage, jpeg};

const MJPG: [u8; 4] = *b"MJPG";
const YUYV: [u8; 4] = *b"YUYV";
const NV12: [u8; 4] = *b"NV12";

/// Contents of a driver's buffer.
#[derive(Clone, Debug, Default)]
struct Filled {
    bytes: Vec<u8>,
    flags: u32,
    taken: Duration,
}

#[derive(Clone, Debug)]
struct Table {
    capabilities: u32,
    formats: Vec<[u8; 4]>,
    sizes: Vec<[u32; 2]>,
    size_px: [u32; 2],
    colours: [u32; 3],
    stride_more: u32,
    /// Requests that fail, by number, with this error.
    fails: Vec<(u8, i32)>,
    buffers: u32,
    /// Images that arrive.
    comes: VecDeque<Filled>,
    /// Buffers that the driver may fill, and the contents of filled buffers.
    queued: VecDeque<u32>,
    filled: Vec<Vec<u8>>,
    streams: bool,
    rate: Option<[u32; 2]>,
    now: Duration,
}

impl Default for Table {
    fn default() -> Self {
        Self {
            capabilities: 0x0400_0001,
            formats: vec![YUYV, MJPG],
            sizes: vec![[640, 480], [1280, 720]],
            size_px: [640, 480],
            colours: [0; 3],
            stride_more: 0,
            fails: Vec::new(),
            buffers: 4,
            comes: VecDeque::new(),
            queued: VecDeque::new(),
            filled: vec![Vec::new(); 4],
            streams: false,
            rate: None,
            now: Duration::from_secs(1000),
        }
    }
}

#[derive(Clone, Debug, Default)]
struct Driver(Arc<Mutex<Table>>);

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_ne_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn put(bytes: &mut [u8], at: usize, value: u32) {
    bytes[at..at + 4].copy_from_slice(&value.to_ne_bytes());
}

fn error(number: i32) -> io::Error {
    io::Error::from_raw_os_error(number)
}

impl Kernel for Driver {
    fn ioctl(&mut self, request: KernelRequest, bytes: &mut [u8]) -> io::Result<()> {
        let mut table = self.0.lock().unwrap();
        if let Some((_, number)) = table.fails.iter().find(|(failing, _)| *failing == request.number) {
            return Err(error(*number));
        }
        // The codes of <linux/videodev2.h> on x86-64, as computed by a C compiler.
        match request.code() {
            0x8068_5600 => {
                bytes[16..22].copy_from_slice(b"Camera");
                put(bytes, 84, 0x8000_0000 | 0x0420_0003);
                put(bytes, 88, table.capabilities);
            }
            0xc040_5602 => {
                assert_eq!(word(bytes, 4), 1);
                let format = table.formats.get(word(bytes, 0) as usize).ok_or_else(|| error(libc::EINVAL))?;
                bytes[44..48].copy_from_slice(format);
            }
            0xc0d0_5604 => {
                put(bytes, 8, table.size_px[0]);
                put(bytes, 12, table.size_px[1]);
            }
            0xc0d0_5605 => {
                let wanted = [word(bytes, 8), word(bytes, 12)];
                let size = table.sizes.iter().copied().find(|size| *size == wanted).unwrap_or(table.sizes[0]);
                let code: [u8; 4] = bytes[16..20].try_into().unwrap();
                let stride = if code == YUYV { 2 * size[0] } else { size[0] };
                for (at, value) in [(8, size[0]), (12, size[1]), (24, stride + table.stride_more)] {
                    put(bytes, at, value);
                }
                for (at, value) in [32, 44, 48].into_iter().zip(table.colours) {
                    put(bytes, at, value);
                }
                if !table.formats.contains(&code) {
                    bytes[16..20].copy_from_slice(&table.formats[0]);
                }
            }
            0xc0cc_5616 => table.rate = Some([word(bytes, 12), word(bytes, 16)]),
            0xc014_5608 => {
                assert_eq!([word(bytes, 4), word(bytes, 8)], [1, 1]);
                put(bytes, 0, table.buffers);
            }
            0xc058_5609 => {
                let index = word(bytes, 0);
                put(bytes, 64, 4096 * index);
                put(bytes, 72, 4096);
            }
            0xc058_560f => {
                assert_eq!([word(bytes, 4), word(bytes, 60)], [1, 1]);
                let index = word(bytes, 0);
                assert!(!table.queued.contains(&index), "buffer {index} was returned twice");
                table.queued.push_back(index);
            }
            0xc058_5611 => {
                assert!(table.streams);
                let Some(index) = table.queued.front().copied() else { return Err(error(libc::EAGAIN)) };
                let Some(filled) = table.comes.pop_front() else { return Err(error(libc::EAGAIN)) };
                table.queued.pop_front();
                put(bytes, 0, index);
                put(bytes, 8, filled.bytes.len() as u32);
                put(bytes, 12, filled.flags);
                bytes[24..32].copy_from_slice(&filled.taken.as_secs().cast_signed().to_ne_bytes());
                bytes[32..40].copy_from_slice(&i64::from(filled.taken.subsec_micros()).to_ne_bytes());
                table.filled[index as usize] = filled.bytes;
            }
            0x4004_5612 => table.streams = true,
            0x4004_5613 => table.streams = false,
            0xc02c_564a => {
                let size = table.sizes.get(word(bytes, 0) as usize).ok_or_else(|| error(libc::EINVAL))?;
                for (at, value) in [(8, 1), (12, size[0]), (16, size[1])] {
                    put(bytes, at, value);
                }
            }
            other => panic!("an unknown request {other:#x}"),
        }
        Ok(())
    }

    fn map(&mut self, offset: u32, length: usize) -> io::Result<()> {
        assert!(offset.is_multiple_of(4096) && length == 4096);
        Ok(())
    }

    fn copy(&self, buffer: usize, length: usize) -> Vec<u8> {
        self.0.lock().unwrap().filled[buffer][..length].to_vec()
    }

    fn wait(&mut self, _: Duration) -> io::Result<()> {
        Ok(())
    }

    fn now(&self) -> Duration {
        self.0.lock().unwrap().now
    }
}

fn start(table: Table, wanted: &str) -> (Driver, Result<V4l2, EndoscopeError>) {
    let driver = Driver(Arc::new(Mutex::new(table)));
    let Ok(crate::Address::Camera { capture, .. }) = format!("/dev/video0?{wanted}").parse() else {
        panic!("{wanted}")
    };
    let started = V4l2::start(Box::new(driver.clone()), "/dev/video0".to_owned(), capture);
    (driver, started)
}

fn comes(driver: &Driver, bytes: Vec<u8>, flags: u32, ago: Duration) {
    let mut table = driver.0.lock().unwrap();
    let taken = table.now.saturating_sub(ago);
    table.comes.push_back(Filled { bytes, flags, taken });
}

#[test]
fn the_best_format_is_taken_and_the_newest_picture_wins() {
    let (driver, started) = start(Table::default(), "size=1280x720&rate=30");
    let mut camera = started.unwrap();
    assert_eq!(camera.format, Format::Jpeg);
    assert_eq!(driver.0.lock().unwrap().rate, Some([1, 30]));
    assert!(camera.next().unwrap().is_none());
    let frame = |value: u8| jpeg::encode(&[value; 3 * 64], [8, 8], 90);
    for value in [10, 100, 200] {
        // Padded, as by some drivers.
        comes(&driver, [frame(value), vec![0; 300]].concat(), 0x2000, Duration::from_millis(40));
    }
    let image = camera.next().unwrap().unwrap();
    assert_eq!(image.bytes, frame(200));
    assert_eq!(image.decode().unwrap().size_px, [8, 8]);
    let late = image.arrived.duration_since(image.taken.unwrap());
    assert!(late.as_millis().abs_diff(40) <= 20, "{late:?}");
    // Every buffer returns to the driver, however often images arrive.
    for value in 0..40 {
        comes(&driver, frame(value), 0, Duration::ZERO);
        let image = camera.next().unwrap().unwrap();
        assert_eq!((image.bytes, image.taken), (frame(value), None), "another clock is not ours");
        assert_eq!(driver.0.lock().unwrap().queued.len(), 4);
    }
    drop(camera);
    assert!(!driver.0.lock().unwrap().streams);
}

#[test]
fn a_stamp_of_another_time_is_none() {
    let (driver, started) = start(Table::default(), "");
    let mut camera = started.unwrap();
    comes(&driver, vec![1], 0x2000, Duration::from_mins(1));
    assert_eq!(camera.next().unwrap().unwrap().taken, None);
    driver.0.lock().unwrap().comes.push_back(Filled {
        bytes: vec![1],
        flags: 0x2000,
        taken: Duration::from_secs(2000),
    });
    assert_eq!(camera.next().unwrap().unwrap().taken, None);
}

#[test]
fn pictures_that_are_not_compressed_have_the_colours_that_the_driver_says() {
    let full = Colours { matrix: ColourMatrix::Bt601, range: ValueRange::Full };
    let hd = Colours { matrix: ColourMatrix::Bt709, range: ValueRange::Limited };
    let sd = Colours { matrix: ColourMatrix::Bt601, range: ValueRange::Limited };
    for (numbers, expected) in
        [([0, 0, 0], sd), ([8, 0, 0], sd), ([3, 0, 0], hd), ([7, 0, 0], full), ([8, 2, 0], hd), ([3, 1, 1], full)]
    {
        let sizes = vec![[4, 2]];
        let table =
            Table { colours: numbers, sizes, size_px: [4, 2], formats: vec![NV12], stride_more: 4, ..Table::default() };
        let (driver, started) = start(table, "");
        let mut camera = started.unwrap();
        let raw = RawLayout { layout: PixelLayout::Nv12, colours: expected, size_px: [4, 2], stride: 8 };
        assert_eq!(camera.format, Format::Raw(raw), "{numbers:?}");
        // Two rows of brightness and one of colours, each of 8 bytes.
        let white = if expected.range == ValueRange::Full { 255 } else { 235 };
        comes(&driver, [[white; 16].to_vec(), vec![128; 8]].concat(), 0x2000, Duration::ZERO);
        let image = camera.next().unwrap().unwrap();
        assert!(image.decode().unwrap().rgba.iter().all(|value| *value == 255));
        comes(&driver, vec![white; 10], 0, Duration::ZERO);
        assert_eq!(camera.next().unwrap().unwrap().decode(), Err(Damage::Torn));
    }
}

#[test]
fn what_is_marked_as_damaged_is_passed_over() {
    let (driver, started) = start(Table::default(), "format=yuyv");
    let mut camera = started.unwrap();
    comes(&driver, vec![7; 640 * 480 * 2], 0, Duration::ZERO);
    comes(&driver, vec![9; 640 * 480 * 2], 0x40, Duration::ZERO);
    assert_eq!(camera.next().unwrap().unwrap().bytes[0], 7);
    assert_eq!(driver.0.lock().unwrap().queued.len(), 4);
}

#[test]
fn each_cause_is_told_with_its_cure() {
    let failing = |number, error| Table { fails: vec![(number, error)], ..Table::default() };
    for (table, wanted, report, cure) in [
        (failing(0, libc::ENOTTY), "", "is not a camera", "nima devices"),
        (failing(0, libc::EINVAL), "", "is not a camera", "nima devices"),
        (Table { capabilities: 0x0400_0002, ..Table::default() }, "", "is not a camera", "nima devices"),
        (
            Table { capabilities: 0x0400_1000, ..Table::default() },
            "",
            "Camera sends its images in several planes",
            "dmesg",
        ),
        (Table { capabilities: 1, ..Table::default() }, "", "does not support streaming", "dmesg"),
        (failing(5, libc::EBUSY), "", "in use by another program", "Close"),
        (failing(8, libc::EBUSY), "", "in use by another program", "Close"),
        (
            Table { formats: vec![*b"RGB3", *b"H264"], ..Table::default() },
            "",
            "does not offer MJPG, NV12 or YUYV, only RGB3, H264",
            "format",
        ),
        (Table::default(), "format=nv12", "does not offer NV12, only YUYV, MJPG", "format"),
        (Table { formats: Vec::new(), ..Table::default() }, "", "only nothing", "format"),
        (Table::default(), "size=800x600", "does not offer images of 800x600, only 640x480, 1280x720", "size"),
        (Table { sizes: vec![[9000, 9000]], ..Table::default() }, "", "exceed the limit", "dmesg"),
        (Table { buffers: 1, ..Table::default() }, "", "provides 1 buffers", "dmesg"),
        (failing(18, libc::ENOSPC), "", "lacks bandwidth on its USB", "its own USB port"),
        (failing(18, libc::EIO), "", "starting the stream failed", "dmesg"),
    ] {
        let (_, started) = start(table, wanted);
        let trouble = started.err().unwrap();
        let words = trouble.to_string();
        assert!(words.starts_with("/dev/video0") && words.contains(report) && !words.contains('\n'), "{words}");
        assert!(trouble.cure().contains(cure), "{words}: {}", trouble.cure());
    }
    for (number, report) in [
        (libc::ENOENT, "/dev/video0 does not exist"),
        (libc::ENODEV, "/dev/video0 does not exist"),
        (libc::EACCES, "this user has no permission to use /dev/video0"),
        (libc::EBUSY, "in use"),
    ] {
        let trouble = super::report("/dev/video0", &error(number), "opening it");
        assert!(trouble.to_string().contains(report), "{trouble}");
    }
}

#[test]
fn what_is_pulled_while_it_streams_and_what_stays_silent_is_told() {
    let (driver, started) = start(Table::default(), "");
    let mut camera = started.unwrap();
    camera.received -= SILENT;
    assert_eq!(camera.next().unwrap_err().to_string(), "/dev/video0 is open but sends no images");
    driver.0.lock().unwrap().fails.push((17, libc::ENODEV));
    assert_eq!(camera.next().unwrap_err().to_string(), "/dev/video0 was unplugged");
    driver.0.lock().unwrap().fails[0].1 = libc::EIO;
    assert!(camera.next().unwrap_err().to_string().contains("the stream has ended"));
}

#[test]
fn files_that_are_no_cameras_are_told_by_the_real_calls() {
    let report = |path: &str| open(Path::new(path), Capture::default()).err().unwrap().to_string();
    assert_eq!(report("/dev/video987654"), "/dev/video987654 does not exist");
    assert_eq!(report("/dev/null"), "/dev/null is not a camera");
}

/// Any response of a driver with any bytes results in an image, a damage report or an error.
fn any_driver(seed: u64, count: usize) {
    let mut random = fastrand::Rng::with_seed(seed);
    for _ in 0..count {
        let mut table = Table {
            capabilities: if random.u8(..4) > 0 { 0x0400_0001 } else { random.u32(..) },
            sizes: (0..random.usize(1..3)).map(|_| [random.u32(..40), random.u32(..40)]).collect(),
            colours: [random.u32(..9), random.u32(..5), random.u32(..4)],
            stride_more: random.u32(..100),
            ..Table::default()
        };
        table.formats = vec![[MJPG, YUYV, NV12, *b"RGB3"][random.usize(..4)]];
        if random.u8(..4) == 0 {
            table.fails.push((random.u8(..80), random.i32(1..130)));
        }
        let (driver, started) = start(table, "");
        let Ok(mut camera) = started else { continue };
        for _ in 0..random.usize(..6) {
            let bytes = (0..random.usize(..4000)).map(|_| random.u8(..)).collect();
            comes(&driver, bytes, random.u32(..0x1_0000), Duration::from_millis(random.u64(..9000)));
        }
        if let Ok(Some(compressed)) = camera.newest() {
            let _ = compressed.decode();
        }
    }
}

#[test]
fn any_driver_is_borne() {
    any_driver(1, 500);
}

#[test]
#[ignore = "as long as ./dev fuzz asks for"]
fn fuzz_drivers() {
    let rounds = nima_testing::fuzz::rounds(|seed| any_driver(seed, 2000));
    println!("{rounds} x 2000 drivers");
}
