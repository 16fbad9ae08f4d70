//! Warnings and errors of background threads, on stderr. The loop itself logs nothing: it must not wait for a terminal.

use std::{env, io};

use tracing::level_filters::LevelFilter;
use tracing_subscriber::{Layer as _, filter::Targets, fmt, layer::SubscriberExt as _, util::SubscriberInitExt as _};

/// Names of the levels, from the fewest lines to the most.
pub(crate) const LEVELS: [&str; 5] = ["error", "warn", "info", "debug", "trace"];
/// The level where the command line names none.
const VARIABLE: &str = "NIMA_LOG";

/// Writes what is logged from now on up to this level, or to that of the environment. Without either, nothing is written.
pub(crate) fn begin(level: Option<LevelFilter>) {
    let given = || env::var(VARIABLE).ok()?.parse().ok();
    let Some(level) = level.or_else(given) else { return };
    // Libraries log much that is of no use here.
    let filter = Targets::new().with_default(level.min(LevelFilter::WARN)).with_target("nima", level);
    let lines = fmt::layer().with_writer(io::stderr).with_filter(filter);
    tracing_subscriber::registry().with(lines).try_init().ok();
}
