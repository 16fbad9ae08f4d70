//! Building blocks of a page.

use maud::{DOCTYPE, Markup, PreEscaped, Render, html};

const STYLE: &str = include_str!("style.css");

/// Returns a page that needs no other file.
pub fn page(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (title) }
                (body)
            }
        }
    };
    page.into_string()
}

/// Returns a part of a page under its title.
pub fn section(title: &str, body: &impl Render) -> Markup {
    html! {
        section {
            h2 { (title) }
            (body)
        }
    }
}

/// Returns a table of text or markup.
pub fn table<Cell: Render>(heads: &[impl Render], rows: &[Vec<Cell>]) -> Markup {
    html! {
        table {
            thead {
                tr { @for head in heads { th { (head) } } }
            }
            tbody {
                @for row in rows { tr { @for cell in row { td { (cell) } } } }
            }
        }
    }
}

/// Returns a table, or this sentence instead of an empty one.
pub fn table_or<Cell: Render>(heads: &[impl Render], rows: &[Vec<Cell>], nothing: &str) -> Markup {
    if rows.is_empty() {
        html! { p { (nothing) } }
    } else {
        table(heads, rows)
    }
}

/// Returns a drawing of this width and height.
pub fn drawing(size: [f64; 2], title: &str, body: &Markup) -> Markup {
    let [width, height] = size;
    html! {
        svg viewBox=(format_args!("0 0 {width} {height}")) role="img" aria-label=(title) font-family="sans-serif" font-size="12"
            style=(format_args!("max-width: {width}px")) {
            title { (title) }
            (body)
        }
    }
}

/// Returns a number with three significant digits.
pub fn digits(value: f64) -> String {
    let size = value.abs();
    match size {
        _ if !value.is_finite() => "-".to_owned(),
        100.0.. => format!("{value:.0}"),
        10.0.. => format!("{value:.1}"),
        1.0.. => format!("{value:.2}"),
        0.001.. => format!("{value:.3}"),
        _ if size == 0.0 => "0".to_owned(),
        _ => format!("{value:.1e}"),
    }
}

pub(super) fn percent(fraction: f64) -> String {
    match fraction {
        0.0 => "0 %".to_owned(),
        ..0.001 => "< 0.1 %".to_owned(),
        _ => format!("{:.1} %", 100.0 * fraction),
    }
}

pub(super) fn time(t_s: f64) -> String {
    if t_s < 60.0 { format!("{t_s:.3} s") } else { format!("{}:{:06.3} min", (t_s / 60.0).floor(), t_s % 60.0) }
}
