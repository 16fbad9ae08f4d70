//! Writes a session of invented signals in the form of a rig's recording: two arms with 150 signals each at 1 kHz,
//! frames, arrows, a log.
//!
//! `session FILE.mcap [SECONDS]` writes the file and reads random ticks of it. It also writes the expected contents to
//! `FILE.csv`, `FILE.poses.csv` and `FILE.log.csv`, for comparison with other readers, and prints bytes and times. The
//! tables contain the first second only.

use std::{
    collections::BTreeMap,
    error::Error,
    fs::{self, File},
    io::{BufWriter, Write as _},
    path::Path,
    process::ExitCode,
    time::{Duration, Instant},
};

use nima_recording::{
    messages::{
        JointStateEncoder,
        foxglove::{
            self, ArrowPrimitive, Color, FrameTransform, FrameTransforms, Level, Log, Pose, Quaternion, SceneEntity,
            SceneUpdate, Vector3, timestamp,
        },
    },
    session::{ChannelId, Encoding, SessionReader, SessionWriter},
};
use prost::Message as _;

const SIGNALS: usize = 150;
const TICK_NS: u64 = 1_000_000;
/// Not zero, because no clock of a session is.
const BEGIN_NS: u64 = 1_790_000_000_000_000_000;
const IN_TABLES: u64 = 1_000;

fn main() -> ExitCode {
    match write_and_look() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn write_and_look() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("name the file to write: session FILE.mcap [SECONDS]")?;
    let seconds: u64 = arguments.next().map_or(Ok(5), |text| text.parse())?;
    let path = Path::new(&path);
    let mut session = ExampleSession::create(path)?;
    let mut spent = Duration::ZERO;
    for block in 0..seconds * 10 {
        let ticks: Vec<_> =
            (block * 100..block * 100 + 100).map(|tick| (tick, [0, 1].map(|arm| signals(arm, tick)))).collect();
        let begin = processor_time()?;
        for (tick, values) in &ticks {
            session.tick(*tick, values)?;
        }
        spent += processor_time()?.saturating_sub(begin);
        for (tick, values) in ticks.iter().filter(|(tick, _)| *tick < IN_TABLES) {
            session.tables.tick(*tick, values)?;
        }
    }
    let (written, _) = session.writer.bytes();
    session.writer.finish()?;
    let size = fs::metadata(path)?.len();
    let per_minute = 60.0 / seconds as f64;
    println!("{seconds} s: {size} bytes, {written} written; {:.3} s of the processor", spent.as_secs_f64());
    println!(
        "a minute: {:.1} MB, {:.1} MB written, {:.2} s of the processor",
        size as f64 * 1e-6 * per_minute,
        written as f64 * 1e-6 * per_minute,
        spent.as_secs_f64() * per_minute
    );
    look(path, seconds)
}

/// Opens the file and reads single ticks at random positions.
fn look(path: &Path, seconds: u64) -> Result<(), Box<dyn Error>> {
    let begin = Instant::now();
    let reader = SessionReader::open(path)?;
    let opened = begin.elapsed();
    let mut random = fastrand::Rng::with_seed(1);
    let mut times = Vec::new();
    for _ in 0..100 {
        let at = BEGIN_NS + random.u64(..seconds * 1_000) * TICK_NS;
        let begin = Instant::now();
        let found = reader.messages(&["/left/signals"], at..at + 1).collect::<Result<Vec<_>, _>>()?;
        times.push(begin.elapsed());
        assert!(found.len() == 1 && found[0].log_time_ns() == at, "this tick must exist");
    }
    times.sort_unstable();
    println!("opened in {opened:.1?}; a tick anywhere: median {:.1?}, longest {:.1?}", times[50], times[99]);
    Ok(())
}

/// One third of the signals holds still for long, one third changes in steps of a device, one third is noisy in every
/// bit.
fn signals(arm: u64, tick: u64) -> [f64; SIGNALS] {
    let t = tick as f64 * 1e-3;
    std::array::from_fn(|signal| {
        let phase = (signal as f64 + 1.0) * 0.37 + arm as f64;
        let slow = (t * (0.3 + 0.01 * signal as f64) + phase).sin();
        match signal % 3 {
            0 => (slow * 4.0).round(),
            1 => (slow * 20_000.0).round() * 1e-5,
            _ => {
                let mut bits = (tick * 2 + arm) * SIGNALS as u64 + signal as u64;
                bits = (bits ^ (bits >> 31)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                slow + 1e-3 * ((bits >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
            }
        }
    })
}

struct ExampleSession {
    writer: SessionWriter,
    arms: [(JointStateEncoder, ChannelId); 2],
    frames: ChannelId,
    arrows: ChannelId,
    log: ChannelId,
    own: ChannelId,
    tables: RecordingTables,
}

impl ExampleSession {
    fn create(path: &Path) -> Result<Self, Box<dyn Error>> {
        let mut writer = SessionWriter::create(path, concat!("nima ", env!("CARGO_PKG_VERSION")))?;
        let mut arm = |side: &str| -> Result<_, Box<dyn Error>> {
            let names: Vec<String> = (0..SIGNALS).map(|signal| format!("{side}.signal_{signal:03}.x_n")).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let encoder = JointStateEncoder::new("world", &names);
            Ok((encoder, writer.channel(&format!("/{side}/signals"), JointStateEncoder::encoding())?))
        };
        let arms = [arm("left")?, arm("right")?];
        let own = Encoding { message_encoding: "nima".into(), ..Encoding::default() };
        let about: BTreeMap<_, _> =
            [("rig", "made up"), ("scene", "none")].map(|(key, value)| (key.to_owned(), value.to_owned())).into();
        writer.metadata("session", &about)?;
        writer.attachment("rig.toml", "text/plain", BEGIN_NS, b"rate_hz = 1000.0\n")?;
        Ok(Self {
            arms,
            frames: writer.channel("/frames", foxglove::encoding::<FrameTransforms>())?,
            arrows: writer.channel("/forces", foxglove::encoding::<SceneUpdate>())?,
            log: writer.channel("/log", foxglove::encoding::<Log>())?,
            own: writer.channel("/inputs", own)?,
            writer,
            tables: RecordingTables::create(path)?,
        })
    }

    fn tick(&mut self, tick: u64, values: &[[f64; SIGNALS]; 2]) -> Result<(), Box<dyn Error>> {
        let time_ns = BEGIN_NS + tick * TICK_NS;
        for ((encoder, channel), values) in self.arms.iter_mut().zip(values) {
            self.writer.message(*channel, time_ns, encoder.encode(time_ns, &[], &[], values)?)?;
        }
        self.writer.message(self.own, time_ns, &tick.to_le_bytes())?;
        // Roughly the refresh rate of a screen.
        if tick.is_multiple_of(20) {
            let frames = frames(time_ns, &values[0]);
            self.writer.message(self.frames, time_ns, &frames.encode_to_vec())?;
            self.writer.message(self.arrows, time_ns, &arrow(time_ns, &values[1]).encode_to_vec())?;
        }
        if tick.is_multiple_of(250) {
            let log = line(tick, time_ns);
            self.writer.message(self.log, time_ns, &log.encode_to_vec())?;
        }
        Ok(())
    }
}

fn place(values: &[f64; SIGNALS]) -> Vector3 {
    Vector3 { x: values[2], y: values[5], z: values[8] }
}

const UPRIGHT: Quaternion = Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };

fn frames(time_ns: u64, values: &[f64; SIGNALS]) -> FrameTransforms {
    let timestamp = Some(timestamp(time_ns));
    let translation = Some(place(values));
    let rotation = Some(UPRIGHT);
    let parent_frame_id = "world".into();
    let child_frame_id = "left.tip".into();
    FrameTransforms {
        transforms: vec![FrameTransform { timestamp, parent_frame_id, child_frame_id, translation, rotation }],
    }
}

fn arrow(time_ns: u64, values: &[f64; SIGNALS]) -> SceneUpdate {
    let pose = Some(Pose { position: Some(place(values)), orientation: Some(UPRIGHT) });
    let color = Some(Color { r: 1.0, g: 0.5, b: 0.0, a: 1.0 });
    let arrow = ArrowPrimitive {
        pose,
        shaft_length: 0.05,
        shaft_diameter: 0.002,
        head_length: 0.01,
        head_diameter: 0.004,
        color,
    };
    let entity = SceneEntity {
        timestamp: Some(timestamp(time_ns)),
        frame_id: "world".into(),
        id: "right.force".into(),
        frame_locked: true,
        arrows: vec![arrow],
        ..SceneEntity::default()
    };
    SceneUpdate { entities: vec![entity], ..SceneUpdate::default() }
}

fn line(tick: u64, time_ns: u64) -> Log {
    Log {
        timestamp: Some(timestamp(time_ns)),
        level: Level::Warning.into(),
        message: format!("tick {tick}"),
        name: "right".into(),
        file: String::new(),
        line: 0,
        value: None,
    }
}

/// The expected contents, as text.
struct RecordingTables {
    signals: BufWriter<File>,
    poses: BufWriter<File>,
    log: BufWriter<File>,
}

impl RecordingTables {
    fn create(path: &Path) -> Result<Self, Box<dyn Error>> {
        let table = |extension: &str| File::create(path.with_extension(extension)).map(BufWriter::new);
        Ok(Self { signals: table("csv")?, poses: table("poses.csv")?, log: table("log.csv")? })
    }

    fn tick(&mut self, tick: u64, values: &[[f64; SIGNALS]; 2]) -> Result<(), Box<dyn Error>> {
        let time_ns = BEGIN_NS + tick * TICK_NS;
        write!(self.signals, "{time_ns}")?;
        for value in values.iter().flatten() {
            write!(self.signals, ",{value}")?;
        }
        writeln!(self.signals)?;
        if tick.is_multiple_of(20) {
            let [left, right] = values.each_ref().map(place);
            writeln!(self.poses, "{time_ns},{},{},{},{},{},{}", left.x, left.y, left.z, right.x, right.y, right.z)?;
        }
        if tick.is_multiple_of(250) {
            writeln!(self.log, "{time_ns},tick {tick}")?;
        }
        Ok(())
    }
}

/// Returns the processor time of this thread so far.
fn processor_time() -> Result<Duration, Box<dyn Error>> {
    let report = fs::read_to_string("/proc/thread-self/schedstat")?;
    Ok(Duration::from_nanos(report.split(' ').next().unwrap_or_default().parse()?))
}
