//! All data of one hand during a trial.

use crate::{
    HandSample, TaskFile,
    force::Forces,
    jaw::Jaw,
    sample::Usable,
    signal::{Decimator, LONGEST_GAP_S},
};

/// One hand, fed sample by sample.
#[derive(Clone, Debug)]
pub(crate) struct ScoreHand {
    pub tip: Decimator,
    pub force: Decimator,
    pub forces: Forces,
    pub rendered: RenderedForce,
    pub jaw: Jaw,
    pub times: HandTimes,
}

/// Time in which the hand was known, s.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_field_names, reason = "the unit")]
pub(crate) struct HandTimes {
    last_s: Option<f64>,
    known_s: f64,
    engaged_s: f64,
    out_of_view_s: f64,
}

/// The force that the hand feels.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RenderedForce {
    last: Option<(f64, f64)>,
    peak_n: Option<f64>,
    known_s: f64,
    square_n2_s: f64,
}

impl ScoreHand {
    pub(crate) fn new(task: &TaskFile) -> Self {
        let room = || Decimator::with_room(task.limit_s());
        Self {
            tip: room(),
            force: room(),
            forces: Forces::new(task),
            rendered: RenderedForce::default(),
            jaw: Jaw::default(),
            times: HandTimes::default(),
        }
    }

    /// Adds a sample at `t_s` from the beginning; returns whether a part of it was unusable.
    pub(crate) fn take(&mut self, t_s: f64, sample: &HandSample) -> bool {
        let Usable { tip_m, jaw_rad, force_n, rendered_n, spoilt } = sample.usable();
        if let Some(tip_m) = tip_m {
            self.tip.take(t_s, tip_m);
            self.times.take(t_s, sample);
        }
        if let Some(force_n) = force_n {
            self.force.take(t_s, force_n);
            self.forces.take(t_s, force_n, LONGEST_GAP_S);
        }
        if let Some(rendered_n) = rendered_n {
            self.rendered.take(t_s, rendered_n.norm());
        }
        if let Some(jaw_rad) = jaw_rad {
            self.jaw.take(jaw_rad);
        }
        spoilt
    }
}

impl HandTimes {
    fn take(&mut self, t_s: f64, sample: &HandSample) {
        let step_s = self.last_s.map_or(0.0, |last_s| t_s - last_s);
        if step_s <= LONGEST_GAP_S {
            self.known_s += step_s;
            self.engaged_s += if sample.engaged { step_s } else { 0.0 };
            self.out_of_view_s += if sample.in_view { 0.0 } else { step_s };
        }
        self.last_s = Some(t_s);
    }

    pub(crate) fn known_s(&self) -> Option<f64> {
        (self.known_s > 0.0).then_some(self.known_s)
    }

    pub(crate) fn engaged_fraction(&self) -> Option<f64> {
        self.known_s().map(|known_s| self.engaged_s / known_s)
    }

    pub(crate) fn out_of_view_fraction(&self) -> Option<f64> {
        self.known_s().map(|known_s| self.out_of_view_s / known_s)
    }
}

impl RenderedForce {
    fn take(&mut self, t_s: f64, size_n: f64) {
        if let Some((last_s, last_n)) = self.last.filter(|(last_s, _)| t_s - last_s <= LONGEST_GAP_S) {
            self.known_s += t_s - last_s;
            self.square_n2_s += (t_s - last_s) * (size_n * size_n + last_n * last_n) / 2.0;
        }
        self.peak_n = Some(self.peak_n.map_or(size_n, |peak_n| peak_n.max(size_n)));
        self.last = Some((t_s, size_n));
    }

    pub(crate) fn peak_n(&self) -> Option<f64> {
        self.peak_n
    }

    pub(crate) fn rms_n(&self) -> Option<f64> {
        (self.known_s > 0.0).then(|| (self.square_n2_s / self.known_s).sqrt())
    }
}
