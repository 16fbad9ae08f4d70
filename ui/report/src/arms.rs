//! The part of the page about one arm.

use maud::{Markup, html};
use nima_core::{impedance::Mode, safety::Gate};
use nima_session::report::{ArmFigures, DEGREE_COLUMNS, FORCES, ForceFigures, IdentificationFigures, SessionFigures};
use nima_words::report_text::{gate_text, mode_name};

use super::{
    html::{digits, percent, table, table_or, time},
    plots,
};

pub(super) fn arm(session: &SessionFigures, arm: &ArmFigures) -> Markup {
    html! {
        section {
            h2 { "The " (arm.side) " arm" }
            h3 { "States" }
            (plots::states(session, arm))
            p.note { "Triangles: black for faults, white for refused commands and alarms. Numbered lines: operator marks." }
            (seconds(session, arm))
            h3 { "Forces" }
            (plots::forces(session, arm))
            p.note {
                "Magnitudes of the forces; each column spans the minimum and maximum of its time. \
                 Delayed: as delivered by the link. Rendered: to the hand, after the gates."
            }
            (forces(arm))
            h3 { "Gates" }
            (gates(arm))
            @if let Some(identified) = &arm.identified {
                h3 { "Prediction and network" }
                (identification(identified))
            }
        }
    }
}

fn seconds(session: &SessionFigures, arm: &ArmFigures) -> Markup {
    let total_s: f64 = arm.seconds.iter().sum();
    let of = |(seconds, (name, colour, hatched)): (&f64, &(&str, &str, bool))| {
        let key = html! { span.key.hatched[*hatched] style=(format_args!("background-color:{colour}")) {} (name) };
        let seconds_s = html! { (format_args!("{seconds:.1} s")) };
        (*seconds > 0.0).then(|| vec![key, seconds_s, html! { (percent(seconds / total_s.max(1e-9))) }])
    };
    let mut rows: Vec<_> = arm.seconds.iter().zip(&plots::STATE).filter_map(of).collect();
    let unknown_s = session.length_s - total_s;
    if unknown_s > 0.05 {
        let key = html! { span.key.gap {} (plots::NOT_RECORDED) };
        rows.push(vec![key, html! { (format_args!("{unknown_s:.1} s")) }, html! {}]);
    }
    table(&["state", "time", "share"], &rows)
}

fn forces(arm: &ArmFigures) -> Markup {
    let rows: Vec<_> =
        FORCES.iter().zip(&arm.forces).filter_map(|(name, of)| Some(force(name, of.as_ref()?))).collect();
    let heads = [
        "while engaged",
        "peak (N)",
        "at",
        "mean (N)",
        "integral (N\u{a0}s)",
        "sd on principal axes (N)",
        "force volume (N³)",
        "rate RMS (N/s)",
        "rate peak (N/s)",
    ];
    table_or(&heads, &rows, "The arm was never engaged: no force results.")
}

fn force(name: &str, of: &ForceFigures) -> Vec<String> {
    vec![
        name.to_owned(),
        digits(of.peak_n),
        time(of.peak_at_s).replace(' ', "\u{a0}"),
        digits(of.mean_n),
        digits(of.integral_n_s),
        of.principal_sd_n.map(digits).join(", "),
        digits(of.volume_n3),
        digits(of.rate_rms_n_s),
        digits(of.rate_peak_n_s),
    ]
}

fn gates(arm: &ArmFigures) -> Markup {
    let row = |gate: Gate, fraction: f64| {
        let [name, meaning] = gate_text(gate);
        let of = if gate == Gate::Permission { "all time" } else { "engaged time" };
        vec![name.to_owned(), format!("{} of {of}", percent(fraction)), meaning.to_owned()]
    };
    let rows: Vec<_> = arm.gates.iter().map(|of| row(of.gate, of.fraction)).collect();
    html! {
        (table(&["gate", "reduced the force", "meaning"], &rows))
        p {
            "Dead band: withheld " (digits(arm.withheld_mean_n)) " N on average while engaged, maximum " (digits(arm.withheld_max_n))
            " N. Energy: minimum " (digits(1e3 * arm.stored_min_j)) " mJ left for the hand."
        }
    }
}

fn identification(of: &IdentificationFigures) -> Markup {
    let direct_n = of.error_n[Mode::Dfr.index()];
    let row = |name: &str, error_n: &Option<f64>| {
        let error_n = (*error_n)?;
        let ratio = direct_n
            .filter(|direct_n| *direct_n > 1e-4)
            .map_or_else(|| "-".to_owned(), |n| format!("{:.2}", error_n / n));
        Some(vec![name.to_owned(), digits(error_n), ratio])
    };
    let names = Mode::ALL.iter().map(|mode| mode_name(*mode)).chain(["the rig's baseline method"]);
    let errors: Vec<_> = names.zip(&of.error_n).filter_map(|(name, error_n)| row(name, error_n)).collect();
    if errors.is_empty() {
        return html! { p { "No mode predicted a force." } };
    }
    let fractions = |(name, fractions): (&&str, &Option<[f64; 6]>)| {
        let fractions = (*fractions)?;
        Some(std::iter::once((*name).to_owned()).chain(fractions.map(percent)).collect())
    };
    let degrees: Vec<Vec<String>> = DEGREE_COLUMNS.iter().zip(&of.degree_fractions).filter_map(fractions).collect();
    html! {
        (table(&["mode, where computed", "mean prediction error (N)", "over direct (DFR)"], &errors))
        @if !degrees.is_empty() { (table(&["degree chosen by", "none", "1", "2", "3", "4", "5"], &degrees)) }
        p { "Without contact, and therefore without learning: " (percent(of.resting_fraction)) " of engaged time." }
        @if let Some(network) = of.network {
            p {
                "Network: " (percent(network.fraction)) " of the tip force came from a network; " (percent(network.outside_fraction))
                " of the time was outside its training data; largest uncertainty " (digits(network.doubt_max)) " (1: limit of its training)."
            }
        } @else {
            p { "No network gave the force at the tip." }
        }
    }
}
