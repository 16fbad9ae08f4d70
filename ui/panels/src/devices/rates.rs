//! The rate of each device over the last minute.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use egui::{Rect, Sense, Stroke, Ui, Vec2, pos2};
use nima_devices::{ConnectionState, Health};
use nima_screen::theme;
use nima_words::text;

/// Interval of the samples, the averaging time of a rate.
const EVERY: Duration = Duration::from_millis(500);
/// Number of samples: a minute.
const SAMPLES: usize = 120;

/// Rates of the devices, Hz, oldest first; `None` while a device is not connected.
#[derive(Debug, Default)]
pub(super) struct RateHistory {
    rates: Vec<VecDeque<Option<f32>>>,
    sampled: Option<Instant>,
}

impl RateHistory {
    /// Adds a sample of each device if it is time.
    pub(super) fn sample(&mut self, healths: &[Health], now: Instant) {
        if self.rates.len() != healths.len() {
            self.rates = vec![VecDeque::with_capacity(SAMPLES); healths.len()];
            self.sampled = None;
        }
        if self.sampled.is_some_and(|at| now.saturating_duration_since(at) < EVERY) {
            return;
        }
        self.sampled = Some(now);
        for (rates, health) in self.rates.iter_mut().zip(healths) {
            if rates.len() == SAMPLES {
                rates.pop_front();
            }
            rates.push_back((health.standing == ConnectionState::Connected).then_some(health.rate_hz as f32));
        }
    }

    pub(super) fn of(&self, place: usize) -> Option<&VecDeque<Option<f32>>> {
        self.rates.get(place)
    }
}

/// Draws a rate over the last minute, from zero; a gap where the device was not connected.
pub(super) fn rates_ui(ui: &mut Ui, size: Vec2, rates: Option<&VecDeque<Option<f32>>>) {
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.on_hover_text(text::devices::RATES_HOVER);
    let palette = theme::now();
    ui.painter().rect_filled(rect, 2.0, palette.groove);
    let Some(rates) = rates else { return };
    let highest = rates.iter().flatten().copied().fold(1.0_f32, f32::max);
    let from = SAMPLES - rates.len();
    let points = rates.iter().enumerate().map(|(i, rate)| rate.map(|rate| place(rect, from + i, rate / highest)));
    let mut line = Vec::new();
    for point in points.chain([None]) {
        match point {
            Some(point) => line.push(point),
            None => {
                ui.painter().line(std::mem::take(&mut line), Stroke::new(1.3, palette.text_weak));
            }
        }
    }
}

fn place(rect: Rect, sample: usize, fraction: f32) -> egui::Pos2 {
    let rect = rect.shrink(2.0);
    let x = rect.left() + rect.width() * sample as f32 / (SAMPLES - 1) as f32;
    pos2(x, rect.bottom() - rect.height() * fraction.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_sampled_twice_a_second_and_a_lost_device_has_none() {
        let mut history = RateHistory::default();
        let begin = Instant::now();
        let mut health = Health::opening();
        health.standing = ConnectionState::Connected;
        health.rate_hz = 1000.0;
        for tenths in 0..1300 {
            if tenths == 1000 {
                health.standing = ConnectionState::Opening;
            }
            history.sample(&[health], begin + Duration::from_millis(100 * tenths));
        }
        let rates = history.of(0).unwrap();
        assert_eq!(rates.len(), SAMPLES);
        assert_eq!((rates.front(), rates.back()), (Some(&Some(1000.0)), Some(&None)));
        assert_eq!(rates.iter().flatten().count(), 60, "half of the last minute");
        history.sample(&[], begin);
        assert!(history.of(0).is_none(), "another rig");
    }
}
