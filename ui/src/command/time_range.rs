//! `--from` and `--to`: an excerpt of a session.

use std::{ops::Range, path::Path};

use anyhow::bail;
use clap::Args;
use nima_recording::session::SessionReader;
use nima_session::plot_channels;

#[derive(Clone, Copy, Debug, Default, Args)]
pub(crate) struct TimeRange {
    /// Start of the excerpt, in seconds since the start of the session
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    from: Option<f64>,
    /// End of the excerpt; entries at this time are excluded
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    to: Option<f64>,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.0..=1e9).contains(&seconds) => Ok(seconds),
        _ => Err("enter a number of seconds, 0 or more".to_owned()),
    }
}

impl TimeRange {
    pub(crate) const fn is_asked(&self) -> bool {
        self.from.is_some() || self.to.is_some()
    }

    /// Returns the times of the excerpt, s since the start of the session, checked against the session.
    pub(crate) fn of(&self, session: &Path, reader: &SessionReader) -> anyhow::Result<Range<f64>> {
        let Self { from, to } = self;
        let begin_ns = plot_channels::beginning_ns(reader)?;
        let (first_ns, last_ns) = reader.statistics().times_ns;
        let [first_s, last_s] = [first_ns, last_ns].map(|time_ns| time_ns.saturating_sub(begin_ns) as f64 / 1e9);
        if let (Some(from), Some(to)) = (from, to)
            && from >= to
        {
            bail!("--from {from} is not before --to {to}");
        }
        let reaches = format!("session {} lasts from {first_s:.3} s to {last_s:.3} s", session.display());
        if let Some(from) = from.filter(|from| *from > last_s) {
            bail!("--from {from} is after the end: {reaches}");
        }
        if let Some(to) = to.filter(|to| *to <= first_s) {
            bail!("--to {to} is before the start: {reaches}");
        }
        Ok(from.unwrap_or(0.0)..to.unwrap_or(f64::INFINITY))
    }
}
