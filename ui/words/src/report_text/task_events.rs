//! Events of the objects of a scene. Texts count rings and pegs from 1, data from 0.

use nima_core::task::TaskEvent;

use super::names::side_word;
use crate::language::{text_format, word};

/// An event without its own sentence is described by its name and values.
pub fn happening(event: &TaskEvent) -> String {
    let number = |count: usize| count.saturating_add(1);
    match *event {
        TaskEvent::Begun => word("the trial starts", "der Versuch beginnt").to_owned(),
        TaskEvent::Ended => word("the task is done", "die Aufgabe ist erledigt").to_owned(),
        TaskEvent::Aborted => word("the trial was aborted", "der Versuch wurde abgebrochen").to_owned(),
        TaskEvent::RingGrasped { ring, side } => {
            text_format!(
                "ring {} grasped by the {} instrument",
                "Ring {} mit Instrument {} gegriffen",
                number(ring),
                side_word(side)
            )
        }
        TaskEvent::RingLifted { ring, side } => {
            text_format!(
                "ring {} lifted off its peg by the {} instrument",
                "Ring {} mit Instrument {} vom Stift gehoben",
                number(ring),
                side_word(side)
            )
        }
        TaskEvent::RingTransferred { ring, to } => {
            text_format!(
                "ring {} passed to the {} instrument",
                "Ring {} an Instrument {} übergeben",
                number(ring),
                side_word(to)
            )
        }
        TaskEvent::RingPlaced { ring, side, peg } => {
            text_format!(
                "ring {} placed on peg {} by the {} instrument",
                "Ring {} auf Stift {} gesetzt, Instrument {}",
                number(ring),
                number(peg),
                side_word(side)
            )
        }
        TaskEvent::RingDropped { ring, side, in_view } => {
            let out = if in_view { "" } else { word(", out of view", ", außer Sicht") };
            text_format!(
                "ring {} dropped by the {} instrument{out}",
                "Ring {} von Instrument {} fallen gelassen{out}",
                number(ring),
                side_word(side)
            )
        }
        TaskEvent::RingKnockedOff { ring, side } => {
            let by = side.map_or_else(String::new, |side| {
                text_format!(" by the {} instrument", ", Instrument {}", side_word(side))
            });
            text_format!("ring {} knocked off its peg{by}", "Ring {} vom Stift gestoßen{by}", number(ring))
        }
        other => plain(&other),
    }
}

fn plain(event: &TaskEvent) -> String {
    let value = serde_json::to_value(event).unwrap_or_default();
    let with_spaces = |name: &str| name.replace('_', " ");
    match value.as_object().and_then(|one| one.iter().next()) {
        Some((name, fields)) => {
            let fields = fields.as_object().into_iter().flatten();
            let report = fields.filter(|(_, value)| !value.is_null()).map(|(key, value)| {
                format!(", {} {}", with_spaces(key), value.as_str().map_or_else(|| value.to_string(), str::to_owned))
            });
            with_spaces(name) + &report.collect::<String>()
        }
        None => with_spaces(value.as_str().unwrap_or_default()),
    }
}

#[cfg(test)]
mod tests {
    use nima_core::Side;

    use super::*;

    #[test]
    fn events_are_told_in_words_and_unknown_ones_by_their_names() {
        let side = Side::Left;
        for (event, words) in [
            (
                TaskEvent::RingDropped { ring: 2, side, in_view: false },
                "ring 3 dropped by the left instrument, out of view",
            ),
            (TaskEvent::RingKnockedOff { ring: 0, side: None }, "ring 1 knocked off its peg"),
            (TaskEvent::RingPlaced { ring: 5, side, peg: 11 }, "ring 6 placed on peg 12 by the left instrument"),
            (TaskEvent::WireTouched { side }, "wire touched, side left"),
            (TaskEvent::LumpMarked { side, lump: None }, "lump marked, side left"),
            (TaskEvent::LumpMarked { side, lump: Some(3) }, "lump marked, lump 3, side left"),
        ] {
            assert_eq!(happening(&event), words);
        }
    }
}
