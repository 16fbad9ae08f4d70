//! Sums over the contact force of one instrument, sample by sample.

use nalgebra::Vector3;

use crate::{ellipsoid::WeightedScatter, signal::RATE_HZ, task::TaskFile};

/// An excursion over the threshold ends below this fraction of it, so that noise at the threshold counts once.
const BACK: f64 = 0.9;

/// Sums over the raw samples, each weighted with half of the time to its neighbours (trapezoid).
#[derive(Clone, Debug)]
pub(crate) struct Forces {
    contact_n: f64,
    threshold_n: f64,
    last: Option<(f64, Vector3<f64>)>,
    above: bool,
    peak_n: Option<f64>,
    excursions: u32,
    known_s: f64,
    integral_n_s: f64,
    square_n2_s: f64,
    contact_s: f64,
    over_s: f64,
    in_contact: Magnitude,
    cloud: WeightedScatter,
    /// Largest force within each 10 ms of the trial, N.
    peaks_n: Vec<f64>,
}

/// Weighted mean and scatter of a number (West 1979).
#[derive(Clone, Copy, Debug, Default)]
struct Magnitude {
    weight: f64,
    mean: f64,
    scatter: f64,
}

impl Magnitude {
    fn add(&mut self, value: f64, weight: f64) {
        if weight > 0.0 {
            self.weight += weight;
            let from_mean = value - self.mean;
            self.mean += from_mean * weight / self.weight;
            self.scatter += weight * from_mean * (value - self.mean);
        }
    }
}

impl Forces {
    pub(crate) fn new(task: &TaskFile) -> Self {
        Self {
            contact_n: task.contact_n,
            threshold_n: task.force_threshold_n,
            last: None,
            above: false,
            peak_n: None,
            excursions: 0,
            known_s: 0.0,
            integral_n_s: 0.0,
            square_n2_s: 0.0,
            contact_s: 0.0,
            over_s: 0.0,
            in_contact: Magnitude::default(),
            cloud: WeightedScatter::default(),
            peaks_n: Vec::with_capacity((task.limit_s() * RATE_HZ) as usize + 1),
        }
    }

    /// Adds a force at `t_s` from the beginning; a step longer than `longest_step_s` adds no time.
    pub(crate) fn take(&mut self, t_s: f64, force_n: Vector3<f64>, longest_step_s: f64) {
        let size_n = force_n.norm();
        self.peak_n = Some(self.peak_n.map_or(size_n, |peak_n| peak_n.max(size_n)));
        self.note_peak(t_s, size_n);
        let over = size_n > self.threshold_n;
        self.excursions += u32::from(over && !self.above);
        self.above = over || (self.above && size_n >= BACK * self.threshold_n);
        if let Some((before_s, before_n)) = self.last.filter(|(before_s, _)| t_s - before_s <= longest_step_s) {
            for force_n in [before_n, force_n] {
                self.weigh(&force_n, (t_s - before_s) / 2.0);
            }
        }
        self.last = Some((t_s, force_n));
    }

    fn note_peak(&mut self, t_s: f64, size_n: f64) {
        let place = (t_s * RATE_HZ) as usize;
        if place >= self.peaks_n.len() {
            self.peaks_n.resize(place + 1, 0.0);
        }
        if let Some(peak_n) = self.peaks_n.get_mut(place) {
            *peak_n = peak_n.max(size_n);
        }
    }

    fn weigh(&mut self, force_n: &Vector3<f64>, step_s: f64) {
        let size_n = force_n.norm();
        self.known_s += step_s;
        self.integral_n_s += size_n * step_s;
        self.square_n2_s += size_n * size_n * step_s;
        if size_n > self.threshold_n {
            self.over_s += step_s;
        }
        if size_n >= self.contact_n {
            self.contact_s += step_s;
            self.in_contact.add(size_n, step_s);
            self.cloud.add(force_n, step_s);
        }
    }

    pub(crate) fn peak_n(&self) -> Option<f64> {
        self.peak_n
    }

    /// Returns the maximum force from `from_s` to `to_s`, N.
    pub(crate) fn peak_between_n(&self, from_s: f64, to_s: f64) -> Option<f64> {
        let [from, to] = [from_s, to_s].map(|t_s| (t_s.max(0.0) * RATE_HZ) as usize);
        let to = (to + 1).min(self.peaks_n.len());
        self.peaks_n.get(from..to)?.iter().copied().reduce(f64::max)
    }

    pub(crate) fn mean_n(&self) -> Option<f64> {
        (self.in_contact.weight > 0.0).then_some(self.in_contact.mean)
    }

    pub(crate) fn sd_n(&self) -> Option<f64> {
        let Magnitude { weight, scatter, .. } = self.in_contact;
        (weight > 0.0).then(|| (scatter / weight).max(0.0).sqrt())
    }

    pub(crate) fn rms_n(&self) -> Option<f64> {
        (self.known_s > 0.0).then(|| (self.square_n2_s / self.known_s).sqrt())
    }

    pub(crate) fn integral_n_s(&self) -> Option<f64> {
        self.known(self.integral_n_s)
    }

    pub(crate) fn contact_s(&self) -> Option<f64> {
        self.known(self.contact_s)
    }

    pub(crate) fn over_s(&self) -> Option<f64> {
        self.known(self.over_s)
    }

    pub(crate) fn excursions(&self) -> Option<f64> {
        self.peak_n.map(|_| f64::from(self.excursions))
    }

    pub(crate) fn volume_n3(&self) -> Option<f64> {
        self.cloud.volume()
    }

    fn known(&self, sum: f64) -> Option<f64> {
        (self.known_s > 0.0).then_some(sum)
    }
}
