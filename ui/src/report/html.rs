//! Building blocks of a page.

/// Escapes text for an element or an attribute.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            letter => escaped.push(letter),
        }
    }
    escaped
}

/// A table; the cells are markup.
pub(crate) fn table(heads: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: &mut dyn Iterator<Item = &str>, tag: &str| {
        let cells: Vec<String> = cells.map(|cell| format!("<{tag}>{cell}</{tag}>")).collect();
        format!("<tr>{}</tr>\n", cells.concat())
    };
    let rows: Vec<String> = rows.iter().map(|row| line(&mut row.iter().map(String::as_str), "td")).collect();
    let heads = line(&mut heads.iter().copied(), "th");
    format!("<table>\n<thead>{heads}</thead>\n<tbody>\n{}</tbody>\n</table>\n", rows.concat())
}

/// A number with three significant digits.
pub(crate) fn digits(value: f64) -> String {
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

pub(super) fn percent(share: f64) -> String {
    match share {
        0.0 => "0 %".to_owned(),
        ..0.001 => "< 0.1 %".to_owned(),
        _ => format!("{:.1} %", 100.0 * share),
    }
}

pub(super) fn time(t_s: f64) -> String {
    if t_s < 60.0 { format!("{t_s:.3} s") } else { format!("{}:{:06.3} min", (t_s / 60.0).floor(), t_s % 60.0) }
}
