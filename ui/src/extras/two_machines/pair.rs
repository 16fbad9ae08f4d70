//! `nima pair`: two machines exchange keys, protected by a code that is shown at one and entered at the other.

use std::{
    io::BufRead as _,
    sync::Arc,
    sync::atomic::{AtomicBool, Ordering::Relaxed},
    time::Duration,
};

use anyhow::Context as _;
use clap::Args;
use nima_network::pairing::{Attempts, Code, Pairing, WAIT_MAX, WAIT_USUAL};
use nima_report::output;

use super::network;
use crate::{command::run::positive_seconds, shutdown::Leave};

#[derive(Debug, Args)]
pub(super) struct PairArguments {
    /// Host name or address of the follower's machine (run on the console's machine)
    #[arg(value_name = "HOST[:PORT]", required_unless_present = "offer", conflicts_with = "offer")]
    host: Option<String>,
    /// Wait for a console to pair (run on the follower's machine)
    #[arg(long)]
    offer: bool,
    /// With --offer: address of this machine to listen on (default: only consoles on this machine)
    #[arg(long, value_name = "ADDRESS[:PORT]", requires = "offer")]
    listen: Option<String>,
    /// With --offer: name under which this machine lists the console
    #[arg(long, value_name = "NAME", requires = "offer", default_value = "console")]
    name: String,
    /// Seconds to wait for the other machine, at most 600
    #[arg(long, value_name = "S", value_parser = wait_seconds, allow_negative_numbers = true, default_value_t = WAIT_USUAL.as_secs_f64())]
    wait: f64,
}

/// Returns a number of seconds above zero, up to the maximum wait.
fn wait_seconds(text: &str) -> Result<f64, String> {
    let max_s = WAIT_MAX.as_secs_f64();
    if text.parse::<f64>().is_ok_and(|seconds| seconds > max_s) {
        return Err(format!("enter at most {max_s} seconds; if they are not enough, pair again"));
    }
    positive_seconds(text)
}

pub(super) fn run(arguments: &PairArguments) -> anyhow::Result<()> {
    let folder = network::folder()?;
    let (keys, mut peers) = network::own_keys()?;
    let called_off = Arc::new(AtomicBool::new(false));
    let leave = Leave::on_signals()?;
    let off = Arc::clone(&called_off);
    leave.at_once(move || off.store(true, Relaxed));
    let wait = Duration::from_secs_f64(arguments.wait);
    let pairing = Pairing { keys: &keys, wait, called_off: &called_off };
    let (name, key) = if let Some(host) = &arguments.host {
        let follower = network::address(host)?;
        let mut attempts = Attempts::open(&folder)?;
        attempts.may_begin()?;
        output::line("Enter the code that the follower's screen shows:")?;
        let mut entered = String::new();
        std::io::stdin().lock().read_line(&mut entered).context("cannot read the code")?;
        (network::name_of(host), pairing.ask(follower, Code::parse(&entered)?, &mut attempts)?)
    } else {
        let at = network::listening(arguments.listen.as_deref())?;
        output::line(&format!("waiting at {at} for `nima pair HOST` on the console's machine"))?;
        let show = |code| {
            // If the output is closed, the code is not shown, and the offer ends when its time is over.
            output::line(&format!("code to enter on the console's machine: {code}")).ok();
        };
        (arguments.name.as_str(), pairing.offer(at, show)?)
    };
    peers.add(name, key)?;
    peers.save(&folder)?;
    output::line(&format!("paired with {name}"))?;
    Ok(())
}
