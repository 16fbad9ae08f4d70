//! The plotted topics of a session: forces, poses and gates of each arm, and the log.

pub(crate) mod columns;
mod identification;
mod images;
mod objects;
pub(crate) mod plot;
pub(crate) mod redrawn;
mod scene;
mod timing;

use nima_core::safety::{Gate, InterlockState};
use nima_machine::{
    messages::{Event, Fault, LoopState, Tick},
    rig::{DeviceName, SIDES, Side},
    runtime::{Operation, TickRecord},
};
use nima_recording::{
    messages::foxglove::{self, Level, Log},
    session::WriteError,
};

pub(crate) use objects::{
    HAPPENINGS_TOPIC, JAWS_PLOT, MARKS_TOPIC, RINGS_TOPIC, TASK_TOPIC, happenings_channel, jaws_of, marks,
    marks_channel, marks_of, rings, rings_channel, rings_of, standing_of,
};
pub(crate) use scene::{ARROWS_TOPIC, FRAMES_TOPIC, endoscope_of};
pub(crate) use timing::{TIMES, TIMING_TOPIC};

use crate::{
    images::{PendingImage, RecordedImageSource},
    logged::LogValue,
    objects::ObjectSource,
    recorder::{LogNote, NoteKind},
    sinks::{SessionSinks, SinkChannel},
};

use self::{
    identification::IdentificationChannel,
    images::ImageChannel,
    objects::{JAWS, OfObjects, TASK},
    plot::Plot,
    scene::SceneChannels,
    timing::TimingChannel,
};

/// Texts of the log.
#[derive(Clone, Copy, Debug)]
pub struct SentenceChannel {
    /// For an event of the loop, with the names of the rig's devices in the order of its roster.
    pub event: fn(&Event, &[DeviceName]) -> String,
    /// For an operation on the loop, with the same names.
    pub operation: fn(&Operation, &[DeviceName]) -> String,
    /// For an event of the scene's objects.
    pub happening: fn(&nima_core::task::TaskEvent) -> String,
}

impl SentenceChannel {
    /// Returns the text of a value of the log; `None` for a value that has no text.
    pub fn of(&self, logged: &LogValue, devices: &[DeviceName]) -> Option<String> {
        match logged {
            LogValue::Event(event) => Some((self.event)(event, devices)),
            LogValue::Operation(operation) => Some((self.operation)(operation, devices)),
            LogValue::Happening(event) => Some((self.happening)(event)),
            LogValue::Screen => None,
        }
    }
}

pub(crate) const LOG_TOPIC: &str = "log";
/// Name of the log's lines from the loop.
pub(crate) const LINE: &str = "nima";
/// Name of the line for a moment that the operator marked.
pub(crate) const MARK_LINE: &str = "mark";
/// Name of the line for an alarm of the screen.
pub(crate) const ALARM_LINE: &str = "alarm";
/// Name of the line for an event of the scene's objects.
pub(crate) const HAPPENING_LINE: &str = "happening";

#[derive(Debug)]
pub(crate) struct SessionTopics {
    sides: [Option<SideTopics>; SIDES],
    scene: SceneChannels,
    times: TimingChannel,
    log: SinkChannel,
    words: SentenceChannel,
    devices: Vec<DeviceName>,
    /// `None` if no source provides objects.
    objects: Option<OfObjects>,
    /// `None` without an endoscope.
    images: Option<ImageChannel>,
}

#[derive(Debug)]
struct SideTopics {
    forces: Plot,
    poses: Plot,
    gates: Plot,
    identified: IdentificationChannel,
}

pub(crate) const FORCES: [&str; 12] = [
    "measured.x_n",
    "measured.y_n",
    "measured.z_n",
    "delayed.x_n",
    "delayed.y_n",
    "delayed.z_n",
    "asked.x_n",
    "asked.y_n",
    "asked.z_n",
    "rendered.x_n",
    "rendered.y_n",
    "rendered.z_n",
];
const POSES: [&str; 6] = ["tip.x_m", "tip.y_m", "tip.z_m", "leader.x_m", "leader.y_m", "leader.z_m"];
/// In addition to one column for each gate: 1 while it acted.
pub(crate) const OF_GATES: [&str; 5] = ["gain_value", "stored_j", "withheld_n", "governed", "state"];

/// Returns every topic of named numbers of this program: its name, the names of its numbers, and whether they are
/// forces.
pub(crate) fn plots() -> Vec<(String, Vec<String>, bool)> {
    let of_side = |side: Side| {
        let parts = [
            ("forces", FORCES.map(str::to_owned).to_vec(), true),
            ("poses", POSES.map(str::to_owned).to_vec(), false),
            ("gates", gates().map(str::to_owned).collect(), false),
            ("identification", identification::names(), false),
            (JAWS_PLOT, JAWS.map(str::to_owned).to_vec(), false),
        ];
        parts.map(|(what, names, forces)| {
            let names = names.iter().map(|name| format!("{}.{name}", side.word())).collect();
            (format!("{}/{what}", side.word()), names, forces)
        })
    };
    let timing = (TIMING_TOPIC.to_owned(), timing::names(), false);
    let task = (TASK_TOPIC.to_owned(), TASK.map(str::to_owned).to_vec(), false);
    Side::ALL.into_iter().flat_map(of_side).chain([timing, task]).collect()
}

pub(crate) fn gates() -> impl Iterator<Item = &'static str> {
    Gate::ALL.iter().map(|gate| gate.name()).chain(OF_GATES)
}

impl SessionTopics {
    pub(crate) fn new(
        out: &mut SessionSinks,
        sides: [bool; SIDES],
        words: SentenceChannel,
        devices: Vec<DeviceName>,
    ) -> Result<Self, WriteError> {
        let mut of = [None, None];
        for side in Side::ALL.into_iter().filter(|side| sides[side.index()]) {
            let gates: Vec<&str> = gates().collect();
            let mut plot = |what: &str, names: &[&str]| Plot::of_side(out, side, what, names);
            of[side.index()] = Some(SideTopics {
                forces: plot("forces", &FORCES)?,
                poses: plot("poses", &POSES)?,
                gates: plot("gates", &gates)?,
                identified: IdentificationChannel::new(out, side)?,
            });
        }
        let times = TimingChannel::new(out)?;
        let log = out.channel(LOG_TOPIC, foxglove::encoding::<Log>())?;
        Ok(Self { sides: of, scene: SceneChannels::new(out)?, times, log, words, devices, objects: None, images: None })
    }

    /// Records the objects of this source from now on.
    pub(crate) fn watch(&mut self, out: &mut SessionSinks, source: Box<dyn ObjectSource>) -> Result<(), WriteError> {
        self.objects = Some(OfObjects::new(out, source)?);
        Ok(())
    }

    /// Writes the objects up to this time of the loop, s; `time_ns` computes the time of a message.
    pub(crate) fn objects(
        &mut self,
        out: &mut SessionSinks,
        t_s: f64,
        time_ns: impl Fn(f64) -> u64,
    ) -> Result<(), WriteError> {
        let Some(objects) = &mut self.objects else { return Ok(()) };
        for happening in objects.until(out, t_s, &time_ns)? {
            let time_ns = time_ns(happening.t_s);
            let words = (self.words.happening)(&happening.event);
            let value = LogValue::Happening(happening.event);
            out.message(self.log, time_ns, &line(time_ns, Level::Info, HAPPENING_LINE, words, Some(&value)))?;
        }
        Ok(())
    }

    /// Records the endoscope images of this source from now on.
    pub(crate) fn film(&mut self, source: Box<dyn RecordedImageSource>) {
        self.images = Some(ImageChannel::new(source));
    }

    /// Writes the images that arrived up to this time of the loop, s, and returns how many were written and how many
    /// were dropped so far. `t_s_of` computes the time of an image, `time_ns` the time of a message.
    pub(crate) fn images(
        &mut self,
        out: &mut SessionSinks,
        t_s: f64,
        t_s_of: impl Fn(&PendingImage) -> Option<f64>,
        time_ns: impl Fn(f64) -> u64,
    ) -> Result<[u64; 2], WriteError> {
        let Some(images) = &mut self.images else { return Ok([0; 2]) };
        images.until(out, t_s, t_s_of, &time_ns)?;
        let counts = images.counts();
        if let Some(at_s) = images.take_excess() {
            let words = "the camera sends too many or too large images: some are left out of the session".to_owned();
            let note = LogNote { kind: NoteKind::Alarm, warns: true, words, names: false };
            self.note(out, time_ns(at_s), note)?;
        }
        Ok(counts)
    }

    /// Writes a tick and the events in it.
    pub(crate) fn tick(
        &mut self,
        out: &mut SessionSinks,
        time_ns: u64,
        stepped: &TickRecord,
        events: &[Event],
    ) -> Result<(), WriteError> {
        for (plots, tick) in self.sides.iter_mut().zip(&stepped.ticks) {
            if let (Some(plots), Some(tick)) = (plots, tick) {
                plots.tick(out, time_ns, tick)?;
            }
        }
        let ticks = stepped.ticks.iter().flatten();
        self.scene.show(out, time_ns, stepped.timing.now_s, ticks)?;
        self.times.tick(out, time_ns, &stepped.timing)?;
        for event in events {
            let level = match event {
                Event::FaultRaised { .. } => Level::Error,
                Event::CommandRefused { .. } => Level::Warning,
                Event::StateChanged { .. } | Event::Device(_) | Event::Scheduling(_) => Level::Info,
            };
            self.log(out, time_ns, level, (self.words.event)(event, &self.devices), &LogValue::Event(*event))?;
        }
        Ok(())
    }

    /// Writes an operation on the loop.
    pub(crate) fn operation(
        &mut self,
        out: &mut SessionSinks,
        time_ns: u64,
        operation: &Operation,
    ) -> Result<(), WriteError> {
        let words = (self.words.operation)(operation, &self.devices);
        self.log(out, time_ns, Level::Info, words, &LogValue::Operation(*operation))
    }

    fn log(
        &self,
        out: &mut SessionSinks,
        time_ns: u64,
        level: Level,
        words: String,
        value: &LogValue,
    ) -> Result<(), WriteError> {
        out.message(self.log, time_ns, &line(time_ns, level, LINE, words, Some(value)))
    }

    /// Writes a log entry from a screen.
    pub(crate) fn note(&self, out: &mut SessionSinks, time_ns: u64, note: LogNote) -> Result<(), WriteError> {
        let LogNote { kind, warns, words, names } = note;
        let level = if warns { Level::Warning } else { Level::Info };
        let name = match kind {
            NoteKind::Mark => MARK_LINE,
            NoteKind::Alarm => ALARM_LINE,
        };
        let value = (!names).then_some(&LogValue::Screen);
        out.message(self.log, time_ns, &line(time_ns, level, name, words, value))
    }
}

/// Makes a line of the log, with the value that it is built from; `None` if the text may contain a name.
pub(crate) fn line(time_ns: u64, level: Level, name: &str, message: String, value: Option<&LogValue>) -> Vec<u8> {
    let log = Log {
        timestamp: Some(foxglove::timestamp(time_ns)),
        level: level as i32,
        message,
        name: name.to_owned(),
        value: value.map(LogValue::encode),
        ..Log::default()
    };
    prost::Message::encode_to_vec(&log)
}

impl SideTopics {
    fn tick(&mut self, out: &mut SessionSinks, time_ns: u64, tick: &Tick) -> Result<(), WriteError> {
        let asked_n = tick.rendering.asked_n[tick.mode.index()];
        let forces = [tick.measured_n, tick.rendering.delayed_n, asked_n, tick.rendering.rendered_n];
        self.forces.values.extend(forces.iter().flatten());
        self.poses.values.extend([tick.positions.tip_m, tick.positions.leader_m].iter().flatten());
        let acted = Gate::ALL.map(|gate| f64::from(u8::from(tick.gates.acted(gate))));
        let gates = &tick.gates;
        self.gates.values.extend(acted);
        self.gates.values.extend([gates.gain, gates.stored_j, gates.withheld_n, gates.governed, number_of(tick.state)]);
        self.forces.write(out, time_ns, true)?;
        self.poses.write(out, time_ns, false)?;
        self.gates.write(out, time_ns, false)?;
        self.identified.tick(out, time_ns, tick)
    }
}

/// The states in the order used in a session, all faults as one: a state is plotted as its index here.
pub const STATES: [LoopState; 7] = [
    InterlockState::Disconnected,
    InterlockState::Idle,
    InterlockState::Ready,
    InterlockState::Engaged,
    InterlockState::Clutched,
    InterlockState::Stopped,
    InterlockState::Faulted(Fault::OtherArm),
];

const fn number_of(state: LoopState) -> f64 {
    match state {
        InterlockState::Disconnected => 0.0,
        InterlockState::Idle => 1.0,
        InterlockState::Ready => 2.0,
        InterlockState::Engaged => 3.0,
        InterlockState::Clutched => 4.0,
        InterlockState::Stopped => 5.0,
        InterlockState::Faulted(_) => 6.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_plotted_as_its_place() {
        assert_eq!(STATES.map(|state| number_of(state) as usize), [0, 1, 2, 3, 4, 5, 6]);
    }
}
