//! Messages about a loop for a remote screen: every event, a tick of each side every few milliseconds, and once per
//! bundle the objects of the scene and the progress of its task.
//!
//! Every bundle can be read alone, so that a screen may join late and miss some.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3, Vector4};
use nima_machine::{
    messages::{Event, Tick},
    rig::SIDES,
};

use crate::{
    codec::{
        BlockColumns, CodecError, FromWords, ToWords, UnpackedColumns, WordSink, WordSource, number, record,
        take_number,
    },
    objects::{JawState, LumpMark, ObjectStates, TaskProgress, WireLoop},
};

/// Version of the batches, whose values are coded as in a journal; other versions are rejected.
const VERSION: u8 = crate::journal::VERSION as u8;
/// Time between two ticks of a batch, s: the resolution that a trace on a screen can show.
const STEP_S: f64 = 0.005;
/// Maximum number of moments of a bundle, and of events of a moment.
const MAX: u64 = 1024;
/// Maximum number of rings of a bundle, and of marks.
const RINGS_MAX: u64 = 64;
const MARKS_MAX: u64 = 64;

/// All data up to a tick.
#[derive(Clone, Debug)]
pub struct MonitorMoment {
    /// Events of the loop since the previous moment, oldest first.
    pub events: Vec<Event>,
    /// State of each side.
    pub ticks: [Option<Tick>; SIDES],
    /// Objects of the scene at the end of a batch; `None` if nothing has changed.
    pub objects: Option<ObjectStates>,
}

#[derive(Clone, Copy, Debug)]
struct MonitorRow {
    ticks: [Option<Tick>; SIDES],
}

record!(MonitorRow { ticks: [Option<Tick>; SIDES] });

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WatchError {
    #[error("the rig runs a different version of this program; install the same version on both computers")]
    Version,
    #[error("a message from the rig is damaged: {0}")]
    Damaged(#[from] CodecError),
}

/// Collects moments.
#[derive(Clone, Debug, Default)]
pub struct MomentWriter {
    columns: BlockColumns,
    rows: u64,
    /// Events with the number of their moment.
    events: Vec<(u64, Event)>,
    last_s: Option<f64>,
    /// The newest objects.
    objects: Option<ObjectStates>,
}

impl MomentWriter {
    /// Adds a tick with the events reported in it.
    pub fn tick(&mut self, t_s: f64, ticks: &[Option<Tick>; SIDES], events: &[Event]) {
        self.events.extend(events.iter().map(|event| (self.rows, *event)));
        // Times are rounded, so a microsecond less is due too. An earlier time belongs to a new session.
        let is_due = self.last_s.is_none_or(|last_s| t_s - last_s >= STEP_S - 1e-6 || t_s < last_s);
        // A large number of events ends a moment early, so that they can be sent.
        if (is_due || self.events.len() as u64 >= MAX) && self.rows < MAX {
            self.columns.next_row();
            MonitorRow { ticks: *ticks }.put(&mut self.columns);
            self.rows += 1;
            self.last_s = Some(t_s);
        }
    }

    /// Sets the current objects of the scene.
    pub fn objects(&mut self, objects: &ObjectStates) {
        self.objects = Some(objects.clone());
    }

    pub const fn len(&self) -> u64 {
        self.rows
    }

    pub const fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// Returns the batch and empties it. Events whose time has not been reached stay for the next batch.
    pub fn take(&mut self) -> Vec<u8> {
        let mut bytes = vec![VERSION];
        let report = self.events.partition_point(|(moment, _)| *moment < self.rows);
        number(&mut bytes, self.rows);
        number(&mut bytes, report as u64);
        for (moment, event) in self.events.drain(..report) {
            let mut words = Vec::new();
            event.put(&mut words);
            number(&mut bytes, moment);
            number(&mut bytes, words.len() as u64);
            for word in words {
                number(&mut bytes, word);
            }
        }
        // The remaining events belong to the first moment of the next batch.
        for (moment, _) in &mut self.events {
            *moment = 0;
        }
        // Objects belong to a moment.
        let objects = if self.rows > 0 { self.objects.take() } else { None };
        put_objects(&mut bytes, objects.as_ref());
        self.columns.pack(&mut bytes);
        self.columns.clear();
        self.rows = 0;
        bytes
    }
}

/// Parses the moments of a bundle, oldest first.
///
/// # Errors
/// [`WatchError`] if it comes from another version or is damaged.
pub fn read(bundle: &[u8]) -> Result<Vec<MonitorMoment>, WatchError> {
    let (version, mut from) = bundle.split_first().ok_or(CodecError::Short)?;
    if *version != VERSION {
        return Err(WatchError::Version);
    }
    let from = &mut from;
    let rows = take_number(from)?;
    let report = take_number(from)?;
    // The last tick of a batch may exceed the writer's limit of events.
    if rows > MAX || report > 2 * MAX {
        return Err(CodecError::Long.into());
    }
    let events = (0..report).map(|_| take_event(from, rows)).collect::<Result<Vec<_>, _>>()?;
    let objects = take_objects(from)?;
    let columns = UnpackedColumns::of(from, MonitorRow::COLUMNS)?;
    if !from.is_empty() {
        return Err(CodecError::Long.into());
    }
    let mut source = columns.rows();
    let mut row = || {
        source.next_row();
        MonitorRow::take(&mut source)
    };
    let ticks = (0..rows).map(|_| row()).collect::<Result<Vec<_>, _>>()?;
    source.end()?;
    let mut moments: Vec<MonitorMoment> = ticks
        .into_iter()
        .map(|MonitorRow { ticks }| MonitorMoment { events: Vec::new(), ticks, objects: None })
        .collect();
    if let Some(last) = moments.last_mut() {
        last.objects = objects;
    }
    for (moment, event) in events {
        moments[moment].events.push(event);
    }
    Ok(moments)
}

/// Numbers of a ring, and of jaws.
const OF_RING: usize = 7;
const OF_JAWS: usize = 8;

fn put_objects(bytes: &mut Vec<u8>, objects: Option<&ObjectStates>) {
    number(bytes, u64::from(objects.is_some()));
    let Some(ObjectStates { t_s, rings, jaws, task }) = objects else { return };
    number(bytes, t_s.to_bits());
    // The reader rejects more.
    let rings = &rings[..rings.len().min(RINGS_MAX as usize)];
    number(bytes, rings.len() as u64);
    let mut words = |of: Option<&[f64]>| {
        number(bytes, u64::from(of.is_some()));
        of.into_iter().flatten().for_each(|value| bytes.extend(value.to_le_bytes()));
    };
    for ring in rings {
        let numbers = ring.as_ref().map(|ring| {
            let position_m = ring.translation.vector;
            let turn = ring.rotation.coords;
            [position_m.x, position_m.y, position_m.z, turn.x, turn.y, turn.z, turn.w]
        });
        words(numbers.as_ref().map(<[f64; OF_RING]>::as_slice));
    }
    for of_side in jaws {
        let numbers = of_side.map(|JawState { opening_rad, opens_n, force_n, torque_nm, touched: _ }| {
            let force = force_n;
            let torque = torque_nm;
            [opening_rad, opens_n, force.x, force.y, force.z, torque.x, torque.y, torque.z]
        });
        words(numbers.as_ref().map(<[f64; OF_JAWS]>::as_slice));
    }
    for touched in jaws.iter().flatten().map(|jaws| jaws.touched) {
        bytes.extend(touched.map(u8::from));
    }
    put_standing(bytes, task.as_ref());
}

fn put_standing(bytes: &mut Vec<u8>, standing: Option<&TaskProgress>) {
    number(bytes, u64::from(standing.is_some()));
    let Some(standing) = standing else { return };
    let TaskProgress { ended, fraction, marked, found, touches, passed, placed, dropped, loops, marks } = standing;
    number(bytes, fraction.to_bits());
    for count in [marked, found, touches, passed, placed, dropped] {
        number(bytes, u64::from(*count));
    }
    bytes.push(u8::from(*ended));
    bytes.extend(loops.iter().flat_map(|one| [one.touches, one.on_wire].map(u8::from)));
    let marks = &marks[..marks.len().min(MARKS_MAX as usize)];
    number(bytes, marks.len() as u64);
    for LumpMark { position_m, is_true } in marks {
        bytes.push(u8::from(*is_true));
        position_m.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
    }
}

fn take_standing(from: &mut &[u8]) -> Result<Option<TaskProgress>, CodecError> {
    if take_number(from)? == 0 {
        return Ok(None);
    }
    let fraction = f64::from_bits(take_number(from)?);
    let mut counts = [0; 6];
    for count in &mut counts {
        *count = u32::try_from(take_number(from)?).map_err(|_| CodecError::NoSuchValue)?;
    }
    let [marked, found, touches, passed, placed, dropped] = counts;
    let ended = take_byte(from)? != 0;
    let mut loops = [WireLoop::default(); SIDES];
    for one in &mut loops {
        *one = WireLoop { touches: take_byte(from)? != 0, on_wire: take_byte(from)? != 0 };
    }
    let count = take_number(from)?;
    if count > MARKS_MAX {
        return Err(CodecError::Long);
    }
    let mark = |from: &mut &[u8]| -> Result<LumpMark, CodecError> {
        Ok(LumpMark { is_true: take_byte(from)? != 0, position_m: vector(&take_numbers::<3>(from)?) })
    };
    let marks = (0..count).map(|_| mark(from)).collect::<Result<_, CodecError>>()?;
    Ok(Some(TaskProgress { ended, fraction, marked, found, touches, passed, placed, dropped, loops, marks }))
}

fn take_byte(from: &mut &[u8]) -> Result<u8, CodecError> {
    let (byte, rest) = from.split_first().ok_or(CodecError::Short)?;
    *from = rest;
    Ok(*byte)
}

fn take_objects(from: &mut &[u8]) -> Result<Option<ObjectStates>, CodecError> {
    if take_number(from)? == 0 {
        return Ok(None);
    }
    let t_s = f64::from_bits(take_number(from)?);
    let count = take_number(from)?;
    if count > RINGS_MAX {
        return Err(CodecError::Long);
    }
    let ring = |numbers: [f64; OF_RING]| {
        let at = vector(&numbers[..3]);
        let turn = Vector4::from_column_slice(&numbers[3..]);
        Isometry3::from_parts(Translation3::from(at), UnitQuaternion::new_unchecked(Quaternion::from(turn)))
    };
    let rings = (0..count).map(|_| Ok(take_some(from)?.map(ring))).collect::<Result<_, CodecError>>()?;
    let mut jaws = [None, None];
    for of_side in &mut jaws {
        *of_side = take_some(from)?.map(|numbers: [f64; OF_JAWS]| JawState {
            opening_rad: numbers[0],
            opens_n: numbers[1],
            force_n: vector(&numbers[2..5]),
            torque_nm: vector(&numbers[5..]),
            touched: [false; 4],
        });
    }
    for of_side in jaws.iter_mut().flatten() {
        let (touched, rest) = from.split_at_checked(of_side.touched.len()).ok_or(CodecError::Short)?;
        *from = rest;
        for (place, byte) in of_side.touched.iter_mut().zip(touched) {
            *place = *byte != 0;
        }
    }
    let task = take_standing(from)?;
    Ok(Some(ObjectStates { t_s, rings, jaws, task }))
}

fn vector(of: &[f64]) -> Vector3<f64> {
    Vector3::from_column_slice(of)
}

/// Reads this many numbers, or `None` if they are marked as absent.
fn take_some<const N: usize>(from: &mut &[u8]) -> Result<Option<[f64; N]>, CodecError> {
    if take_number(from)? == 0 { Ok(None) } else { take_numbers(from).map(Some) }
}

fn take_numbers<const N: usize>(from: &mut &[u8]) -> Result<[f64; N], CodecError> {
    let mut numbers = [0.0; N];
    for place in &mut numbers {
        let (first, rest) = from.split_first_chunk().ok_or(CodecError::Short)?;
        *place = f64::from_le_bytes(*first);
        *from = rest;
    }
    Ok(numbers)
}

/// Reads an event, and the number of its moment, which is below `rows`.
fn take_event(from: &mut &[u8], rows: u64) -> Result<(usize, Event), CodecError> {
    let moment = take_number(from)?;
    let count = take_number(from)?;
    if moment >= rows {
        return Err(CodecError::NoSuchValue);
    }
    if count > Event::COLUMNS as u64 {
        return Err(CodecError::Long);
    }
    let words = (0..count).map(|_| take_number(from)).collect::<Result<Vec<_>, _>>()?;
    let mut words = words.into_iter();
    let event = Event::take(&mut words)?;
    if words.len() > 0 {
        return Err(CodecError::Long);
    }
    Ok((usize::try_from(moment).map_err(|_| CodecError::NoSuchValue)?, event))
}

#[cfg(test)]
mod tests {
    use nima_core::kinematics::HandPose;
    use nima_machine::{
        config::RigConfig,
        messages::Command,
        rig::{Inputs, SensedForce, Side},
        teleop::{Calibrations, Loop, Timing},
    };

    use super::*;

    type Shown = [Option<Tick>; SIDES];

    /// Returns two seconds of a loop that is engaged and then stopped, in batches of 50 ms, with every tick and event.
    fn report() -> (Vec<Vec<u8>>, Vec<Shown>, Vec<Event>) {
        let rig = RigConfig::load("simulated").unwrap();
        let mut control = Loop::new(&rig, &[Some(Calibrations::default()), None]).unwrap();
        let mut writer = MomentWriter::default();
        let mut bundles = Vec::new();
        let mut ticks = Vec::new();
        let mut events = Vec::new();
        for i in 0..2000_u32 {
            let t_s = f64::from(i) * 1e-3;
            let hand = HandPose::at(Vector3::new(0.0, 0.0, 0.01 * (6.0 * t_s).sin()));
            let sensed = SensedForce::AtTip(Vector3::new(0.0, 0.0, 2.0 * (6.0 * t_s).sin().max(0.0)));
            let inputs = Inputs { hand, sensed, tip_m: hand.position_m, powered: true, ..Inputs::NOTHING };
            match i {
                5 => control.obey(Command::Engage, t_s),
                1503 => control.obey(Command::Stop, t_s),
                _ => {}
            }
            let timing = Timing { now_s: t_s, ..Timing::default() };
            let (_, shown) = control.step([Some(inputs), None], &timing);
            let new: Vec<Event> = control.events().copied().collect();
            control.clear_events();
            writer.objects(&objects(t_s));
            writer.tick(t_s, &shown, &new);
            events.extend(new);
            ticks.push(shown);
            if writer.len() == 10 {
                bundles.push(writer.take());
            }
        }
        (bundles, ticks, events)
    }

    /// Returns two rings, one of them lost, one pair of jaws, two marks, and a loop on a wire.
    fn objects(t_s: f64) -> ObjectStates {
        let turn = UnitQuaternion::from_euler_angles(t_s, 0.2, -t_s);
        let ring = Isometry3::from_parts(Translation3::new(t_s, 0.5, -0.25), turn);
        let force_n = Vector3::new(1.0, t_s, 3.0);
        let jaws = JawState {
            opening_rad: 0.5,
            opens_n: t_s,
            force_n,
            torque_nm: -force_n,
            touched: [true, false, true, false],
        };
        let mark = |x, is_true| LumpMark { position_m: Vector3::new(x, t_s, 0.5), is_true };
        let task = TaskProgress {
            fraction: t_s,
            marked: 2,
            dropped: 3,
            loops: [WireLoop { touches: false, on_wire: true }, WireLoop { touches: true, on_wire: false }],
            marks: vec![mark(0.25, true), mark(-0.5, false)],
            ..TaskProgress::default()
        };
        ObjectStates { t_s, rings: vec![Some(ring), None], jaws: [Some(jaws), None], task: Some(task) }
    }

    #[test]
    fn every_fifth_tick_comes_back_to_the_bit_and_every_event_once() {
        let (bundles, ticks, events) = report();
        assert_eq!(bundles.len(), 40);
        let moments: Vec<MonitorMoment> = bundles.iter().flat_map(|bundle| read(bundle).unwrap()).collect();
        assert_eq!(moments.len(), 400);
        for (moment, shown) in moments.iter().zip(ticks.iter().step_by(5)) {
            assert_eq!(format!("{:?}", moment.ticks), format!("{shown:?}"));
        }
        let came: Vec<Event> = moments.iter().flat_map(|moment| moment.events.clone()).collect();
        assert_eq!(came, events);
        let state = |at: usize| moments[at].ticks[Side::Right.index()].unwrap().state.word();
        assert_ne!((state(200), state(390)), (state(0), state(200)));
        assert!(events.len() >= 3, "{events:?}");
        let shown: Vec<&ObjectStates> = moments.iter().filter_map(|moment| moment.objects.as_ref()).collect();
        assert_eq!(shown.len(), 40, "once in each bundle");
        assert!(moments.iter().skip(9).step_by(10).all(|moment| moment.objects.is_some()));
        assert!(shown.iter().all(|one| **one == objects(one.t_s)));
    }

    #[test]
    fn a_bundle_is_read_without_those_before_it_and_a_damaged_one_never_panics() {
        let (bundles, ..) = report();
        assert_eq!(read(bundles.last().unwrap()).unwrap().len(), 10);
        assert_eq!(read(&[]).unwrap_err(), WatchError::Damaged(CodecError::Short));
        assert_eq!(read(&[VERSION + 1, 0, 0]).unwrap_err(), WatchError::Version);
        let mut random = fastrand::Rng::with_seed(5);
        for _ in 0..20_000 {
            let mut bundle = bundles[random.usize(..bundles.len())].clone();
            for _ in 0..random.usize(1..4) {
                let place = random.usize(1..bundle.len());
                bundle[place] = random.u8(..);
            }
            bundle.truncate(random.usize(1..=bundle.len()));
            read(&bundle).ok();
        }
    }
}
