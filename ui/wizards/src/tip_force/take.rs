//! A recording that can be paused and resumed, with a clock that is continuous over restarts of the loop.

use nima_core::calibration::correspondence::Correspondence;
use nima_machine::{messages::Tick, rig::Prompt};
use nima_recording::tip_force::{MAX_ROWS, RecorderPhase, TipForceRecorder};
use nima_words::{report_text::ShortText as _, text};

use crate::Binding;

/// A gap in the ticks longer than this, s, means that the rig was not observed during the gap.
const HOLE_S: f64 = 1.0;

/// A continuous clock: the loop's clock starts at zero with each start.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RecordingClock {
    begin_s: f64,
    last_s: Option<f64>,
}

impl RecordingClock {
    /// Returns the continuous time, s, and whether ticks were missing before this one.
    pub(super) fn at(&mut self, t_s: f64) -> (f64, bool) {
        let now_s = self.begin_s + t_s;
        let Some(last_s) = self.last_s.replace(now_s) else { return (now_s, false) };
        if now_s > last_s {
            return (now_s, now_s - last_s > HOLE_S);
        }
        let now_s = last_s + HOLE_S;
        self.begin_s = now_s - t_s;
        self.last_s = Some(now_s);
        (now_s, true)
    }
}

/// Origin of a recording: rows of different rigs must not be mixed.
#[derive(Clone, Debug)]
pub(super) struct RecordedWith {
    pub(super) sensor: String,
    pub(super) tool: String,
    pub(super) correspondence: Correspondence,
}

impl RecordedWith {
    /// Returns whether it is the same rig, as far as known: a sensor that is lost briefly may come back as the same
    /// one.
    pub(super) fn fits(&self, binding: &Binding) -> bool {
        if binding.sensor.is_empty() {
            return true;
        }
        let same = |now: &Correspondence| {
            let then = &self.correspondence;
            let turned_rad = now.rotation.angle_to(&then.rotation);
            now.target == then.target && now.flip_s2 == then.flip_s2 && turned_rad < 1e-6
        };
        self.sensor == binding.sensor && self.tool == binding.tool && binding.correspondence.as_ref().is_none_or(same)
    }
}

/// A recording.
#[derive(Clone, Debug)]
pub(super) struct TipForceRecording {
    /// The recorded rows.
    pub(super) recorder: TipForceRecorder,
    /// Whether the recording is running, even if a source is missing at the moment.
    pub(super) running: bool,
    /// Whether the wrist sensor is silent.
    silent: bool,
    /// Current instruction to the person.
    asked: Prompt,
}

impl TipForceRecording {
    pub(super) fn new(correspondence: Correspondence) -> Self {
        Self { recorder: TipForceRecorder::new(correspondence), running: false, silent: false, asked: Prompt::Rest }
    }

    /// Adds one tick; `work` is the instruction after the rest period.
    pub(super) fn step(&mut self, now_s: f64, tick: &Tick, work: Prompt) {
        self.silent = tick.calibration.wrist.is_none();
        let (Some(sample), true) = (&tick.calibration.wrist, self.running) else { return };
        match self.recorder.step(now_s, tick.force.gravity_free.as_ref(), sample) {
            RecorderPhase::Resting { .. } => self.asked = Prompt::Rest,
            RecorderPhase::NotMoved | RecorderPhase::Recording => self.asked = work,
            // A brief loss of a source does not change the instruction.
            RecorderPhase::Lacks(_) => {}
            RecorderPhase::Full => self.running = false,
        }
    }

    /// Pauses: the rig may be touched, so a rest period is required before resuming.
    pub(super) fn break_off(&mut self) {
        self.recorder.interrupt();
        self.running = false;
        self.asked = Prompt::Rest;
    }

    pub(super) const fn prompt(&self) -> Prompt {
        if self.running { self.asked } else { Prompt::Rest }
    }

    pub(super) fn phase_text(&self) -> String {
        if self.recorder.rows() == MAX_ROWS {
            return text::tip_force::PHASE_FULL.get().to_owned();
        }
        match self.recorder.phase() {
            _ if !self.running => text::tip_force::PHASE_PAUSED.get().to_owned(),
            _ if self.silent => text::tip_force::PHASE_WRIST_SILENT.get().to_owned(),
            RecorderPhase::Lacks(lack) => text::tip_force::nothing_taken(lack.words()),
            RecorderPhase::Resting { fraction } => text::tip_force::taking_zero(100.0 * fraction),
            RecorderPhase::NotMoved => text::tip_force::PHASE_NOT_MOVED.get().to_owned(),
            RecorderPhase::Recording | RecorderPhase::Full => text::tip_force::PHASE_RECORDING.get().to_owned(),
        }
    }
}

/// Returns the instruction whose drawing is shown, also before and between the recordings.
pub(super) fn drawn(take: Option<&TipForceRecording>) -> Prompt {
    take.map(|take| take.asked).filter(|asked| *asked != Prompt::Rest).unwrap_or(Prompt::Work)
}

pub(super) fn words(prompt: Prompt) -> &'static str {
    match prompt {
        Prompt::Work => text::tip_force::TASK_WORK.get(),
        Prompt::WorkFree => text::tip_force::TASK_WORK_FREE.get(),
        _ => text::tip_force::TASK_REST.get(),
    }
}

#[cfg(test)]
mod tests {
    use super::RecordingClock;

    #[test]
    fn time_only_rises_and_every_hole_is_told() {
        let mut clock = RecordingClock::default();
        assert_eq!(clock.at(5.0), (5.0, false));
        assert_eq!(clock.at(5.001), (5.001, false));
        assert_eq!(clock.at(9.0), (9.0, true), "the page was hidden for four seconds");
        let (now_s, broken) = clock.at(0.001);
        assert!(broken && now_s > 9.0, "the loop was restarted");
        let (next_s, broken) = clock.at(0.002);
        assert!(!broken && (next_s - now_s - 0.001).abs() < 1e-9);
    }
}
