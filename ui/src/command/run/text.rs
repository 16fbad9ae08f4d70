//! The results of a run as text.

use nima_core::statistics::Quantiles;
use nima_devices::{ConnectionState, Health};
use nima_machine::runtime::{ArmEnd, CauseAndCure, CpuFraction, DeviceFigures, RuntimeSummary};
use nima_simulation::SimulationPlan;

pub(super) fn as_text(plan: &SimulationPlan, summary: &RuntimeSummary, is_measured: bool) -> String {
    let times =
        |q: &Quantiles| format!("p50 {:7.1}   p99 {:7.1}   p99.9 {:7.1}   max {:7.1}", q.p50, q.p99, q.p999, q.max);
    let mut text = format!(
        "{} on \"{}\", {} clock{}: {:.1} s, {} ticks, {} missed, {:.1} times real time\n\
         {}, mode {}\n\
         wake-up us  {}\n\
         work us     {}\n\
         rig us      {}{}{}{}{}",
        plan.scene.name,
        plan.rig.name,
        summary.clock,
        summary.lateness.map_or_else(String::new, |late| format!(" ({}, seed {})", late.profile, late.seed)),
        summary.seconds,
        summary.ticks,
        summary.missed,
        summary.speed,
        if is_measured {
            "link over a network".to_owned()
        } else {
            format!("link delay {:.0} ms", plan.rig.delay_s * 1e3)
        },
        plan.rig.mode,
        times(&summary.wake_us),
        times(&summary.work_us),
        times(&summary.rig_us),
        summary.sample_to_force_us.map_or_else(String::new, |us| format!("\nsample to force us {}", times(&us))),
        summary.cpu.map_or_else(String::new, processor_text),
        devices_text(summary),
        ends_text(summary),
    );
    if !summary.error.is_empty() {
        text.push_str("\nerror of each mode before the gates, compared with the tip force at the same instant:");
    }
    for error in &summary.error {
        let fields = format!(
            "\n  {:5}  {:14}  mean {:10.4} N   sd {:10.4} N   max {:10.4} N   invalid {}",
            error.side.word(),
            error.mode,
            error.mae_n,
            error.sd_n,
            error.max_n,
            error.invalid
        );
        text.push_str(&fields);
    }
    if let (Some(advice), "real") = (summary.scheduling.advice(), summary.clock) {
        text.push_str("\nnote: ");
        text.push_str(&advice);
    }
    text
}

fn processor_text(CpuFraction { realtime, process }: CpuFraction) -> String {
    let [realtime, process] = [realtime, process].map(|fraction| fraction * 100.0);
    format!("\nprocessor   {realtime:.1} % of a core in the loop's thread, {process:.1} % in the whole program")
}

fn devices_text(summary: &RuntimeSummary) -> String {
    summary.devices.iter().map(device_text).collect()
}

fn device_text(DeviceFigures { name, health, trouble }: &DeviceFigures) -> String {
    let standing = match health.standing {
        ConnectionState::Connected => "connected".to_owned(),
        ConnectionState::Opening => "never connected".to_owned(),
        ConnectionState::Closed => "disconnected".to_owned(),
        ConnectionState::Lost(loss) => format!("lost: {}", loss.cause()),
    };
    let Health { readings, rate_hz, lost, damaged, refused, outages, longest_outage_s, .. } = health;
    let outages = match outages {
        0 => String::new(),
        _ => format!("   outages {outages}, the longest {longest_outage_s:.1} s"),
    };
    let trouble = match trouble {
        Some(CauseAndCure { cause, cure, .. }) => format!("\n  {:14}  {cause}. {cure}", ""),
        None => String::new(),
    };
    format!(
        "\n  {name:14}  {standing:12}  {readings:8} readings   {rate_hz:7.1} Hz   lost {lost}   damaged {damaged}   refused {refused}{outages}{trouble}"
    )
}

fn ends_text(summary: &RuntimeSummary) -> String {
    let end = |ArmEnd { side, final_state, fault, .. }: &ArmEnd| {
        let fault = fault.as_ref().map_or_else(String::new, |CauseAndCure { device, cause, .. }| {
            let device = device.as_ref().map_or_else(String::new, |device| format!(" ({device})"));
            format!(": {cause}{device}")
        });
        format!("\n{:5} arm ended: {}{fault}", side.word(), final_state.word())
    };
    summary.arms.iter().map(end).collect()
}
