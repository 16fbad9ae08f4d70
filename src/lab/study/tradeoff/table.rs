//! The results as CSV, one row per point.

use std::fmt::Write as _;

use nima_files::csv_cell;

use super::{SourceFigures, SweepStudy};

const HEADER: &str = "source,unit,method,degree,window_ms,rate_hz,delay_ms,differentiator,cost_p50_us,cost_p99_us,load,\
                      error,error_p50,error_p95,dfr_error,ratio,not_rendered,judged,pareto,knobs\n";

impl SweepStudy {
    /// Returns all points of all sources as CSV. The column `knobs` names the curves that pass through the point.
    pub fn csv(&self) -> String {
        let mut text = HEADER.to_owned();
        for figures in &self.sources {
            for index in 0..figures.points.len() {
                figures.push_row(index, &mut text);
            }
        }
        text
    }
}

impl SourceFigures {
    fn push_row(&self, index: usize, text: &mut String) {
        let point = &self.points[index];
        let choice = &point.choice;
        let mut knobs: Vec<_> =
            self.curves.iter().filter(|curve| curve.points.contains(&index)).map(|curve| curve.knob.name()).collect();
        knobs.dedup();
        // Writing into a String cannot fail.
        writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{:e},{:e},{:e},{:e},{:e},{:e},{:e},{},{},{}",
            csv_cell(&self.source),
            csv_cell(&self.unit),
            choice.method.name(),
            choice.degree,
            choice.window_ms,
            choice.rate_hz,
            choice.delay_ms,
            choice.differentiator.name(),
            point.cost_us.p50,
            point.cost_us.p99,
            point.load,
            point.error,
            point.error_p50,
            point.error_p95,
            point.dfr_error,
            point.ratio,
            point.not_rendered,
            point.judged,
            point.pareto,
            knobs.join(";"),
        )
        .ok();
    }
}
