//! Computes the score of a trial from its samples and events.

use nima_core::{
    SIDES, Side,
    task::{TaskEvent, TaskKind, TimedTaskEvent},
};

use crate::{
    Score, ScoreSample, TaskFile, TrialOutcome,
    economy::path_economy,
    events::Events,
    hand::ScoreHand,
    signal::{DerivativeOrder, TipTrack, magnitudes, mean, peak},
    tip_motion::TipMotion,
    two_hands::TwoHands,
};

/// Maximum plausible time, s: beyond this, the clock is faulty, and steps of 1 ms lose their precision.
const LATEST_S: f64 = 1e12;
/// Period before a mark whose force belongs to the marked lump, s.
const BEFORE_MARK_S: f64 = 2.0;

/// Processes the samples and events of one trial in the order of time and computes its [`Score`].
///
/// Each sample costs the same. Memory is allocated at the beginning, for motion and force at 100 Hz up to the time
/// limit (4 MB for 300 s); only a signal with very many gaps needs more. Without [`TaskEvent::Begun`] the trial begins with
/// the first sample or event.
#[derive(Clone, Debug)]
pub struct Scorer {
    task: TaskFile,
    hands: [ScoreHand; SIDES],
    events: Events,
    begin_s: Option<f64>,
    /// Newest sample and newest event, s from the beginning.
    newest_s: Option<f64>,
    latest_s: f64,
    /// End of the trial, s since its start, and the kind of ending.
    end: Option<(f64, TrialOutcome)>,
    samples: u64,
    samples_skipped: u64,
    happenings_skipped: u64,
}

impl Scorer {
    /// Creates a scorer for one trial of this task.
    pub fn new(task: &TaskFile) -> Self {
        Self {
            task: task.clone(),
            hands: [ScoreHand::new(task), ScoreHand::new(task)],
            events: Events::default(),
            begin_s: None,
            newest_s: None,
            latest_s: 0.0,
            end: None,
            samples: 0,
            samples_skipped: 0,
            happenings_skipped: 0,
        }
    }

    /// Adds the next sample. Samples before the beginning and after the end do not count; a sample that is not finite
    /// or goes back in time is skipped and counted.
    pub fn sample(&mut self, sample: &ScoreSample) {
        if self.end.is_some() {
            return;
        }
        let Some(t_s) = self.since_begin_s(sample.t_s) else {
            self.samples_skipped += 1;
            return;
        };
        if t_s < 0.0 || self.out_of_time(t_s) {
            return;
        }
        if self.newest_s.is_some_and(|newest_s| t_s <= newest_s) {
            self.samples_skipped += 1;
            return;
        }
        self.newest_s = Some(t_s);
        self.latest_s = self.latest_s.max(t_s);
        self.samples += 1;
        let mut spoilt = false;
        for (hand, sample) in self.hands.iter_mut().zip(&sample.hands) {
            spoilt |= sample.as_ref().is_some_and(|sample| hand.take(t_s, sample));
        }
        self.samples_skipped += u64::from(spoilt);
    }

    /// Adds an event. It may follow the samples of its time by some samples.
    pub fn happening(&mut self, happening: &TimedTaskEvent) {
        if happening.event == TaskEvent::Begun && happening.t_s.abs() <= LATEST_S {
            *self = Self { begin_s: Some(happening.t_s), ..Self::new(&self.task) };
            return;
        }
        if self.end.is_some() {
            return;
        }
        let Some(t_s) = self.since_begin_s(happening.t_s).filter(|t_s| *t_s >= 0.0) else {
            self.happenings_skipped += 1;
            return;
        };
        if self.out_of_time(t_s) {
            return;
        }
        self.latest_s = self.latest_s.max(t_s);
        match happening.event {
            TaskEvent::Ended => self.end = Some((t_s, TrialOutcome::Completed)),
            TaskEvent::Aborted => self.end = Some((t_s, TrialOutcome::Aborted)),
            event => self.events.take(t_s, event),
        }
    }

    /// Ends the trial with the current data and returns its score. For a trial of 300 s, the spectra take about 100 ms
    /// and 15 MB, so do not call this within the loop.
    pub fn finish(self) -> Score {
        let (end_s, outcome) = self.end.unwrap_or((self.latest_s, TrialOutcome::Unfinished));
        let mut score = Score::new(outcome);
        self.score_time(&mut score, end_s, outcome);
        self.score_task(&mut score, end_s);
        self.score_force(&mut score);
        let handled_s = Side::ALL.map(|side| self.events.handled_s(side));
        let [right, left] = self.hands;
        let tips = [right.tip.finish(), left.tip.finish()];
        score_motion(&mut score, &tips, &handled_s, end_s);
        score_force_rate(&mut score, &[right.force.finish(), left.force.finish()]);
        score
    }

    /// Returns the time since the beginning, which is now if there was none before; `None` for an invalid time.
    fn since_begin_s(&mut self, t_s: f64) -> Option<f64> {
        (t_s.abs() <= LATEST_S).then(|| t_s - *self.begin_s.get_or_insert(t_s))
    }

    fn out_of_time(&mut self, t_s: f64) -> bool {
        let limit_s = self.task.limit_s();
        if t_s >= limit_s {
            self.end = Some((limit_s, TrialOutcome::OutOfTime));
        }
        self.end.is_some()
    }

    fn score_time(&self, score: &mut Score, end_s: f64, outcome: TrialOutcome) {
        let completed_s = (outcome == TrialOutcome::Completed).then_some(end_s);
        score.set("trial_time_s", self.begin_s.map(|_| end_s));
        score.set("completion_time_s", completed_s);
        score.set_hands("engaged_share", self.each(|hand| hand.times.engaged_fraction()));
        // Without a task there is neither a reference nor an image.
        if self.task.kind != TaskKind::Free {
            score.set("time_over_reference", completed_s.map(|time_s| time_s / self.task.reference_time_s));
            score.set_hands("out_of_view_share", self.each(|hand| hand.times.out_of_view_fraction()));
        }
        let known_s = self.each(|hand| hand.times.known_s());
        score.set_hands("unknown_time_s", known_s.map(|known_s| known_s.map(|known_s| (end_s - known_s).max(0.0))));
        score.set("samples", Some(self.samples as f64));
        score.set("samples_skipped", Some(self.samples_skipped as f64));
        score.set("happenings_skipped", Some(self.happenings_skipped as f64));
        let rest_s = self.task.time_limit_s - end_s - self.task.penalty_s * f64::from(self.events.dropped_out_of_view);
        let points = match outcome {
            TrialOutcome::Completed => Some(rest_s.max(0.0)),
            TrialOutcome::OutOfTime | TrialOutcome::Aborted => Some(0.0),
            TrialOutcome::Unfinished => None,
        };
        score.set("fls_like_score", points.filter(|_| self.task.kind == TaskKind::PegTransfer));
    }

    fn score_task(&self, score: &mut Score, end_s: f64) {
        let events = &self.events;
        match self.task.kind {
            TaskKind::Free => {}
            TaskKind::PegTransfer => {
                let drops = f64::from(events.dropped_in_view) + f64::from(events.dropped_out_of_view);
                score.set("time_to_first_grasp_s", events.first_grasp_s);
                score.set("drops", Some(drops));
                let counts = [
                    ("lifts", events.lifts),
                    ("transfers", events.transfers),
                    ("rings_placed", events.placed),
                    ("drops_in_view", events.dropped_in_view),
                    ("drops_out_of_view", events.dropped_out_of_view),
                    ("rings_knocked_off", events.knocked_off),
                ];
                for (id, count) in counts {
                    score.set(id, Some(f64::from(count)));
                }
            }
            TaskKind::Palpation => {
                let found = events.found() as f64;
                score.set("lumps_found", Some(found));
                score.set("lumps_false", Some(f64::from(events.false_marks)));
                score.set("lumps_missed", self.task.lumps.map(|lumps| (f64::from(lumps) - found).max(0.0)));
                score.set_hands("lump_peak_force_n", Side::ALL.map(|side| self.lump_peak_n(side)));
            }
            TaskKind::WireLoop => {
                score.set("wire_touches", Some(f64::from(events.touches)));
                score.set("wire_touch_time_s", Some(events.touched_s(end_s)));
            }
        }
    }

    fn lump_peak_n(&self, side: Side) -> Option<f64> {
        let forces = &self.hands[side.index()].forces;
        let before = |t_s: &f64| forces.peak_between_n(t_s - BEFORE_MARK_S, *t_s);
        self.events.marked_s(side).iter().filter_map(before).reduce(f64::max)
    }

    fn score_force(&self, score: &mut Score) {
        score.set_hands("peak_force_n", self.each(|hand| hand.forces.peak_n()));
        score.set_hands("mean_force_n", self.each(|hand| hand.forces.mean_n()));
        score.set_hands("force_sd_n", self.each(|hand| hand.forces.sd_n()));
        score.set_hands("rms_force_n", self.each(|hand| hand.forces.rms_n()));
        let integrals = self.each(|hand| hand.forces.integral_n_s());
        score.set_hands("force_integral_n_s", integrals);
        let sum: f64 = integrals.iter().flatten().sum();
        score.set_hands("force_share", integrals.map(|integral| integral.filter(|_| sum > 0.0).map(|one| one / sum)));
        score.set_hands("contact_time_s", self.each(|hand| hand.forces.contact_s()));
        score.set_hands("time_over_threshold_s", self.each(|hand| hand.forces.over_s()));
        score.set_hands("force_excursions", self.each(|hand| hand.forces.excursions()));
        score.set_hands("force_volume_n3", self.each(|hand| hand.forces.volume_n3()));
        score.set_hands("peak_rendered_n", self.each(|hand| hand.rendered.peak_n()));
        score.set_hands("rms_rendered_n", self.each(|hand| hand.rendered.rms_n()));
        let openings = self.each(|hand| hand.jaw.openings());
        let known_s = self.each(|hand| hand.times.known_s());
        let per_min = |side: usize| Some(openings[side]? * 60.0 / known_s[side]?);
        score.set_hands("jaw_openings", openings);
        score.set_hands("jaw_openings_per_min", Side::ALL.map(|side| per_min(side.index())));
    }

    fn each(&self, of: impl Fn(&ScoreHand) -> Option<f64>) -> [Option<f64>; SIDES] {
        self.hands.each_ref().map(of)
    }
}

fn score_motion(score: &mut Score, tips: &[TipTrack; SIDES], handled_s: &[Vec<f64>; SIDES], end_s: f64) {
    let motions = tips.each_ref().map(TipMotion::of);
    let each = motions.each_ref();
    let paths_m = each.map(TipMotion::path_m);
    let depths_m = each.map(TipMotion::depth_m);
    let depth_fraction =
        |side: usize| paths_m[side].filter(|path_m| *path_m > 0.0).and_then(|path_m| Some(depths_m[side]? / path_m));
    score.set_hands("path_length_m", paths_m);
    score.set_hands("depth_m", depths_m);
    score.set_hands("depth_share", [depth_fraction(0), depth_fraction(1)]);
    score.set_hands("path_economy", [0, 1].map(|side| path_economy(&motions[side], &handled_s[side])));
    score.set_hands("mean_speed_m_per_s", each.map(TipMotion::mean_speed));
    score.set_hands("peak_speed_m_per_s", each.map(TipMotion::peak_speed));
    score.set_hands("mean_acceleration_m_per_s2", each.map(TipMotion::mean_acceleration));
    score.set_hands("peak_acceleration_m_per_s2", each.map(TipMotion::peak_acceleration));
    score.set_hands("mean_jerk_m_per_s3", each.map(TipMotion::mean_jerk));
    score.set_hands("hand_idle_time_s", each.map(TipMotion::idle_s));
    score.set_hands("movements", each.map(TipMotion::movements));
    score.set_hands("motion_volume_m3", each.map(TipMotion::volume_m3));
    let whole = each.map(TipMotion::smoothness);
    score.set_hands("log_dimensionless_jerk", whole.map(|[jerk, _]| jerk));
    score.set_hands("sparc", whole.map(|[_, arc]| arc));
    let single = each.map(TipMotion::smoothness_of_movements);
    score.set_hands("log_dimensionless_jerk_per_movement", single.map(|[jerk, _]| jerk));
    score.set_hands("sparc_per_movement", single.map(|[_, arc]| arc));
    let hands = TwoHands::of(&motions);
    // Each grid point counts for one step, although there is one step fewer than points.
    score.set("idle_time_s", hands.idle_s().map(|idle_s| idle_s.min(end_s)));
    score.set("both_move_share", hands.both_move());
    score.set("bimanual_dexterity", hands.correlation());
}

fn score_force_rate(score: &mut Score, forces: &[TipTrack; SIDES]) {
    let rates: [Vec<Vec<f64>>; SIDES] =
        [0, 1].map(|side| forces[side].runs().map(|(_, points)| magnitudes(points, DerivativeOrder::First)).collect());
    score.set_hands("peak_force_rate_n_per_s", [0, 1].map(|side| peak(rates[side].iter().map(Vec::as_slice))));
    score.set_hands("mean_force_rate_n_per_s", [0, 1].map(|side| mean(rates[side].iter().map(Vec::as_slice))));
}
