//! The part of the page about one arm.

use std::fmt::Write as _;

use nima_core::{impedance::Mode, safety::Gate};
use nima_session::report::{ArmFigures, DEGREE_COLUMNS, FORCES, Figures, ForceFigures, Identified};

use super::{
    html::{digits, escape, percent, table, time},
    plots,
};
use crate::words::{gate_words, mode_name};

pub(super) fn arm(session: &Figures, arm: &ArmFigures) -> String {
    let mut out = format!("<section>\n<h2>The {} arm</h2>\n", arm.side);
    out.push_str("<h3>States</h3>\n");
    out.push_str(&plots::states(session, arm));
    out.push_str(
        "<p class=\"note\">Triangles: black for faults, white for refused commands and alarms. Numbered lines: \
     operator marks.</p>\n",
    );
    out.push_str(&seconds(session, arm));
    out.push_str("<h3>Forces</h3>\n");
    out.push_str(&plots::forces(session, arm));
    out.push_str(
        "<p class=\"note\">Magnitudes of the forces; each column spans the minimum and maximum of its time. \
         Delayed: as delivered by the link. Rendered: to the hand, after the gates.</p>\n",
    );
    out.push_str(&forces(arm));
    out.push_str("<h3>Gates</h3>\n");
    out.push_str(&gates(arm));
    if let Some(identified) = &arm.identified {
        out.push_str("<h3>Prediction and network</h3>\n");
        out.push_str(&identification(identified));
    }
    out.push_str("</section>\n");
    out
}

fn seconds(session: &Figures, arm: &ArmFigures) -> String {
    let total_s: f64 = arm.seconds.iter().sum();
    let of = |(seconds, (name, colour, hatched)): (&f64, &(&str, &str, bool))| {
        let hatched = if *hatched { " hatched" } else { "" };
        let key = format!("<span class=\"key{hatched}\" style=\"background-color:{colour}\"></span>{name}");
        (*seconds > 0.0).then(|| vec![key, format!("{seconds:.1} s"), percent(seconds / total_s.max(1e-9))])
    };
    let mut rows: Vec<_> = arm.seconds.iter().zip(&plots::STATE).filter_map(of).collect();
    let unknown_s = session.length_s - total_s;
    if unknown_s > 0.05 {
        rows.push(vec![
            format!("<span class=\"key gap\"></span>{}", plots::NOT_RECORDED),
            format!("{unknown_s:.1} s"),
            String::new(),
        ]);
    }
    table(&["state", "time", "share"], &rows)
}

fn forces(arm: &ArmFigures) -> String {
    let rows: Vec<_> =
        FORCES.iter().zip(&arm.forces).filter_map(|(name, of)| Some(force(name, of.as_ref()?))).collect();
    if rows.is_empty() {
        return "<p>The arm was never engaged: no force results.</p>\n".to_owned();
    }
    let heads = [
        "while engaged",
        "peak (N)",
        "at",
        "mean (N)",
        "integral (N&nbsp;s)",
        "sd on principal axes (N)",
        "force volume (N<sup>3</sup>)",
        "rate RMS (N/s)",
        "rate peak (N/s)",
    ];
    table(&heads, &rows)
}

fn force(name: &str, of: &ForceFigures) -> Vec<String> {
    vec![
        name.to_owned(),
        digits(of.peak_n),
        time(of.peak_at_s).replace(' ', "&nbsp;"),
        digits(of.mean_n),
        digits(of.integral_n_s),
        of.principal_sd_n.map(digits).join(", "),
        digits(of.volume_n3),
        digits(of.rate_rms_n_s),
        digits(of.rate_peak_n_s),
    ]
}

fn gates(arm: &ArmFigures) -> String {
    let row = |gate: Gate, share: f64| {
        let [name, meaning] = gate_words(gate);
        let of = if gate == Gate::Permission { "all time" } else { "engaged time" };
        vec![escape(name), format!("{} of {of}", percent(share)), escape(meaning)]
    };
    let rows: Vec<_> = arm.gates.iter().map(|of| row(of.gate, of.share)).collect();
    format!(
        "{}<p>Dead band: withheld {} N on average while engaged, maximum {} N. Energy: minimum {} mJ left for \
         the hand.</p>\n",
        table(&["gate", "reduced the force", "meaning"], &rows),
        digits(arm.withheld_mean_n),
        digits(arm.withheld_max_n),
        digits(1e3 * arm.stored_least_j),
    )
}

fn identification(of: &Identified) -> String {
    let direct_n = of.error_n[Mode::Dfr.index()];
    let row = |name: &str, error_n: &Option<f64>| {
        let error_n = (*error_n)?;
        let ratio = direct_n
            .filter(|direct_n| *direct_n > 1e-4)
            .map_or_else(|| "-".to_owned(), |n| format!("{:.2}", error_n / n));
        Some(vec![escape(name), digits(error_n), ratio])
    };
    let names = Mode::ALL.iter().map(|mode| mode_name(*mode)).chain(["the rig's baseline method"]);
    let rows: Vec<_> = names.zip(&of.error_n).filter_map(|(name, error_n)| row(name, error_n)).collect();
    if rows.is_empty() {
        return "<p>No mode predicted a force.</p>\n".to_owned();
    }
    let mut out = table(&["mode, where computed", "mean prediction error (N)", "over direct (DFR)"], &rows);
    let shares = |(name, shares): (&&str, &Option<[f64; 6]>)| {
        let shares = (*shares)?;
        Some(std::iter::once((*name).to_owned()).chain(shares.map(percent)).collect())
    };
    let rows: Vec<Vec<String>> = DEGREE_COLUMNS.iter().zip(&of.degree_shares).filter_map(shares).collect();
    if !rows.is_empty() {
        out.push_str(&table(&["degree chosen by", "none", "1", "2", "3", "4", "5"], &rows));
    }
    writeln!(
        out,
        "<p>Without contact, and therefore without learning: {} of engaged time.</p>",
        percent(of.resting_share)
    )
    .ok();
    if let Some(network) = of.network {
        writeln!(
            out,
            "<p>Network: {} of the tip force came from a network; {} of the time was outside its training data; largest \
             uncertainty {} (1: limit of its training).</p>",
            percent(network.share),
            percent(network.outside_share),
            digits(network.doubt_max)
        )
        .ok();
    } else {
        out.push_str("<p>No network gave the force at the tip.</p>\n");
    }
    out
}
