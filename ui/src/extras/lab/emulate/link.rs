//! `nima emulate link`: a bad network between a console and a follower, generated from a seed, without special rights.
//!
//! `--set to=HOST[:PORT]` is the follower, `--set at=ADDRESS[:PORT]` the address for consoles (by default port 47151 of this
//! machine). The keys of [`nima_network::impairment::ImpairmentSettings`] set the impairments, for both directions or, after `there.`
//! or `back.`, for one.

use anyhow::{Context as _, bail};
use nima_network::{
    endpoint::PORT,
    impairment,
    relay::{Relay, RelaySettings},
};
use nima_report::output;
use serde::Deserialize;

use super::EmulatorEndpoint;
use crate::{extras::two_machines::network::address, shutdown::Leave};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct LinkLine {
    at: String,
    to: String,
    seed: u64,
    there: impairment::ImpairmentSettings,
    back: impairment::ImpairmentSettings,
}

impl Default for LinkLine {
    fn default() -> Self {
        let [there, back] = [impairment::ImpairmentSettings::default(); 2];
        Self { at: format!("127.0.0.1:{}", PORT + 1), to: format!("127.0.0.1:{PORT}"), seed: 1, there, back }
    }
}

fn line(set: &[String]) -> anyhow::Result<LinkLine> {
    let mut text = String::new();
    for setting in set {
        let Some((key, value)) = setting.split_once('=') else {
            bail!("--set {setting}: enter a key and a value, such as delay_s=0.02");
        };
        let key = key.trim();
        let value = value.trim();
        let lines = match key {
            "at" | "to" => format!("{key} = {value:?}\n"),
            _ if key == "seed" || key.starts_with("there.") || key.starts_with("back.") => format!("{key} = {value}\n"),
            _ => format!("there.{key} = {value}\nback.{key} = {value}\n"),
        };
        text += &lines;
    }
    nima_files::from_toml(&text).map_err(|misfit| {
        anyhow::anyhow!(
            "{}; keys: to, at, seed, and, for both directions or with the prefix there. or back.: delay_s, jitter.normal.deviation_s, \
             jitter.pareto.mean_s and .shape, overtakes, loss.independent.share, loss.bursts.share and .burst_s, reorder, reorder_s, \
             duplicate, rate_bit_s, queue_s, flap.down_s and flap.every_s",
            misfit.message()
        )
    })
}

pub(super) fn run(set: &[String]) -> anyhow::Result<()> {
    let LinkLine { at, to, seed, there, back } = line(set)?;
    let settings = RelaySettings { at: address(&at)?, to: address(&to)?, there, back, seed };
    let relay = Relay::start(settings).with_context(|| format!("cannot emulate a link on {at}"))?;
    let endpoint = relay.address().to_string();
    output::line(&serde_json::to_string(&EmulatorEndpoint { device: "link", endpoint: &endpoint })?)?;
    let leave = Leave::on_signals()?;
    while !leave.is_asked() {
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    let totals = relay.totals();
    output::line(&format!(
        "{} datagrams there, {} of them lost; {} back, {} of them lost",
        totals.there, totals.there_lost, totals.back, totals.back_lost
    ))
}

#[cfg(test)]
mod tests {
    use nima_network::impairment::{ImpairmentJitter, LossModel};

    use super::*;

    fn report(set: &[&str]) -> anyhow::Result<LinkLine> {
        line(&set.iter().map(|&setting| setting.to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn a_setting_is_for_both_directions_or_for_one() {
        let line = report(&[
            "to=theatre:99",
            "delay_s=0.02",
            "jitter.normal.deviation_s=0.001",
            "back.loss.independent.share=0.3",
            "there.flap.down_s=0.8",
            "there.flap.every_s=4",
        ])
        .unwrap();
        assert_eq!((line.to.as_str(), line.at.as_str()), ("theatre:99", "127.0.0.1:47151"));
        assert!([line.there.delay_s, line.back.delay_s].iter().all(|delay_s| (delay_s - 0.02).abs() < 1e-12));
        assert_eq!(line.there.jitter, ImpairmentJitter::Normal { deviation_s: 0.001 });
        assert_eq!((line.there.loss, line.back.loss), (LossModel::None, LossModel::Independent { fraction: 0.3 }));
        assert!(line.there.flap.is_some() && line.back.flap.is_none());
    }

    #[test]
    fn what_is_no_setting_is_told_with_all_that_are() {
        for bad in ["delay=20", "delay_s", "delay_s=long", "loss=0.3"] {
            let words = report(&[bad]).unwrap_err().to_string();
            assert!(words.contains("delay_s") && words.lines().count() == 1, "{bad}: {words}");
        }
    }
}
