//! The study of faults as Markdown: summary, one row per fault and sensor, the faults outside the virtual clock, and
//! the bounded ones.

use std::fmt::Write as _;

use super::{
    CaseOutcome, FaultKind, FaultOptions, FaultPlace, FaultReport, FaultSums, FaultVerdict, FaultsError, HARMLESS_N,
    SensorAt, Special, study,
};
use crate::{Experiment, Findings};

impl Findings for FaultReport {
    fn text(&self) -> String {
        let mut text = self.sums_text();
        // Writing into a String cannot fail, here and below.
        writeln!(
            text,
            "\n| fault | sensor at |{}",
            FaultPlace::ALL.map(|place| format!(" {} |", place.word())).concat()
        )
        .ok();
        writeln!(text, "|---|---|{}", "---|".repeat(FaultPlace::ALL.len())).ok();
        for kind in FaultKind::ALL {
            for sensor in SensorAt::SIMULATED {
                self.row(&mut text, kind, sensor);
            }
        }
        self.on_arms(&mut text);
        text.push_str("\nFaults on the real clock and of files:\n\n| fault | verdict | detection (ms) | force gone (ms) | report |\n|---|---|---|---|---|\n");
        for Special { what, verdict, report, detection_ms, zero_ms } in &self.specials {
            let number = |ms: &Option<f64>| ms.map_or_else(|| "-".to_owned(), |ms| format!("{ms:.1}"));
            let [detection, zero] = [detection_ms, zero_ms].map(number);
            writeln!(text, "| {what} | {} | {detection} | {zero} | {report} |", word(*verdict)).ok();
        }
        text.push_str("\nBounded, not detected:\n\n| fault | sensor at | largest error (N) | why it cannot be detected |\n|---|---|---|---|\n");
        for kind in FaultKind::ALL {
            for sensor in SensorAt::ALL {
                let of = self
                    .outcomes
                    .iter()
                    .filter(|o| (o.kind, o.sensor, o.verdict) == (kind, sensor, FaultVerdict::Bounded));
                let largest_n =
                    of.map(|outcome| outcome.peak_error_n).fold(None, |max, n| Some(n.max(max.unwrap_or(0.0))));
                if let (Some(n), Some(why)) = (largest_n, kind.untellable().or(kind.passes_as_fresh())) {
                    writeln!(text, "| {} | {} | {n:.2} | {why} |", kind.words(), sensor.word()).ok();
                }
            }
        }
        text
    }

    fn judge(&self) -> Result<(), String> {
        let silent = self.sums.silent;
        let false_alarms = self.calm.false_alarms.len();
        if silent > 0 {
            return Err(format!("{silent} faults were not detected: see the table"));
        }
        if false_alarms > 0 {
            return Err(format!("{false_alarms} faults were reported in runs without a fault: see the table"));
        }
        Ok(())
    }
}

impl FaultReport {
    fn sums_text(&self) -> String {
        let FaultSums { kinds, cases, no_force, harmless, detected, bounded, silent, on_force_path, .. } = self.sums;
        let FaultSums { detection_p50_ms, detection_p99_ms, detection_max_ms, bounded_error_n, .. } = self.sums;
        let FaultSums { max_n, step_n, .. } = self.sums;
        let lines = [
            format!("{kinds} kinds of fault; {cases} cases on the virtual clock, {} others.", self.specials.len()),
            format!("- no force and no motion: {no_force}"),
            format!(
                "- harmless (at most {HARMLESS_N} N from the twin within 5 ms, or no further from the true force than the twin): {harmless}"
            ),
            format!("- detected: {detected}"),
            format!("- bounded, not detected: {bounded} (largest error {bounded_error_n:.2} N)"),
            format!("- silent: {silent}"),
            format!(
                "- detection on the force path while engaged ({on_force_path} cases): p50 {detection_p50_ms:.0} ms, p99 {detection_p99_ms:.0} ms, \
                 max {detection_max_ms:.0} ms"
            ),
            self.calm.line(),
            format!(
                "- largest force commanded {max_n:.2} N, largest change in a tick {step_n:.2} N, a fall to zero apart"
            ),
        ];
        lines.join("\n") + "\n"
    }

    /// One row per fault on the rigs with an arm, free and in contact together.
    fn on_arms(&self, text: &mut String) {
        let heads = SensorAt::ON_ARMS.map(|sensor| format!(" {} |", sensor.word())).concat();
        let rule = "---|".repeat(SensorAt::ON_ARMS.len());
        writeln!(text, "\nOn rigs with an arm, engaged, free and in contact:\n\n| fault |{heads}\n|---|{rule}").ok();
        for kind in FaultKind::ALL.into_iter().filter(|kind| kind.is_of_devices()) {
            let of = |sensor: SensorAt| {
                cell(&self.outcomes.iter().filter(|o| (o.kind, o.sensor) == (kind, sensor)).collect::<Vec<_>>())
            };
            let cells = SensorAt::ON_ARMS.map(|sensor| format!(" {} |", of(sensor))).concat();
            writeln!(text, "| {} |{cells}", kind.words()).ok();
        }
    }

    fn row(&self, text: &mut String, kind: FaultKind, sensor: SensorAt) {
        let of = |place: FaultPlace| {
            let at = move |o: &&CaseOutcome| o.kind == kind && o.sensor == sensor && o.place == place;
            self.outcomes.iter().filter(at).collect::<Vec<_>>()
        };
        if of(FaultPlace::Contact).is_empty() {
            return;
        }
        write!(text, "| {} | {} |", kind.words(), sensor.word()).ok();
        for place in FaultPlace::ALL {
            write!(text, " {} |", cell(&of(place))).ok();
        }
        text.push('\n');
    }
}

/// Returns the worst of some cases: outcome, slowest detection / removal of the force (ms), maximum error (N).
fn cell(cases: &[&CaseOutcome]) -> String {
    let Some(worst) = cases.iter().map(|outcome| outcome.verdict).max() else { return "-".to_owned() };
    let max = |of: fn(&CaseOutcome) -> Option<f64>| cases.iter().filter_map(|outcome| of(outcome)).reduce(f64::max);
    let number = |ms: Option<f64>| ms.map_or_else(|| "-".to_owned(), |ms| format!("{ms:.0}"));
    let peak_n = max(|outcome| Some(outcome.peak_error_n)).unwrap_or(0.0);
    let error_n = max(|outcome| Some(outcome.error_n)).unwrap_or(0.0);
    match worst {
        FaultVerdict::NoForce => "0".to_owned(),
        FaultVerdict::Harmless => format!("h {error_n:.2}"),
        FaultVerdict::Bounded => format!("**b** {peak_n:.2}"),
        FaultVerdict::Silent => format!("**SILENT** {peak_n:.2}"),
        FaultVerdict::Detected => {
            let report = max(|outcome| outcome.detection_ms);
            let zero = max(|outcome| outcome.zero_ms);
            format!("d {} / {} / {peak_n:.2}", number(report), number(zero))
        }
    }
}

const fn word(verdict: FaultVerdict) -> &'static str {
    match verdict {
        FaultVerdict::NoForce => "no force",
        FaultVerdict::Harmless => "harmless",
        FaultVerdict::Detected => "detected",
        FaultVerdict::Bounded => "bounded",
        FaultVerdict::Silent => "SILENT",
    }
}

impl Experiment for FaultOptions {
    const NAME: &'static str = "faults";
    type Findings = FaultReport;
    type Error = FaultsError;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<FaultReport, FaultsError> {
        study(self, progress)
    }
}
