//! An event as a message: JSON, so that it can hold any event.

use nima_core::task::{TaskEvent, TimedTaskEvent};
use serde_json::{Map, Value};

/// Name and JSON schema of the messages. Additional properties of an event are named like its fields.
pub(crate) const SCHEMA_NAME: &str = "nima.Happening";
/// See [`SCHEMA_NAME`].
pub(crate) const SCHEMA: &str = r#"{
  "title": "nima.Happening",
  "type": "object",
  "properties": {
    "t_s": {"type": "number", "description": "loop time, s"},
    "event": {"type": "string", "description": "what happened"},
    "side": {"type": ["string", "null"], "description": "instrument: left or right"},
    "to": {"type": "string", "description": "instrument that takes the ring: left or right"},
    "ring": {"type": "integer", "description": "number of the ring, from 0"},
    "peg": {"type": "integer", "description": "number of the peg, from 0"},
    "in_view": {"type": "boolean", "description": "in the endoscope's picture"}
  },
  "required": ["t_s", "event"]
}"#;

const TIME: &str = "t_s";
const EVENT: &str = "event";

/// Encodes a message. The fields of the event are at the same level as its name, so that a viewer can filter by them.
pub(crate) fn encode(happening: &TimedTaskEvent) -> Vec<u8> {
    let (name, fields) = parts(&happening.event);
    let mut message = fields;
    message.insert(TIME.to_owned(), happening.t_s.into());
    message.insert(EVENT.to_owned(), name.into());
    Value::Object(message).to_string().into_bytes()
}

/// Decodes a message; `None` for an event that this program does not support.
pub(crate) fn decode(message: &[u8]) -> Option<TimedTaskEvent> {
    let Ok(Value::Object(mut fields)) = serde_json::from_slice(message) else { return None };
    let t_s = fields.remove(TIME)?.as_f64()?;
    let Some(Value::String(name)) = fields.remove(EVENT) else { return None };
    let event =
        if fields.is_empty() { Value::String(name) } else { Value::Object(Map::from_iter([(name, fields.into())])) };
    Some(TimedTaskEvent { t_s, event: serde_json::from_value(event).ok()? })
}

/// Returns the name under which an event is counted: the name in its message, with drops out of view counted
/// separately.
pub fn kind(event: &TaskEvent) -> String {
    let (name, _) = parts(event);
    if matches!(event, TaskEvent::RingDropped { in_view: false, .. }) { format!("{name}_out_of_view") } else { name }
}

/// Returns name and fields of an event, as `serde` writes them.
fn parts(event: &TaskEvent) -> (String, Map<String, Value>) {
    match serde_json::to_value(event) {
        Ok(Value::String(name)) => (name, Map::new()),
        Ok(Value::Object(one)) => match one.into_iter().next() {
            Some((name, Value::Object(fields))) => (name, fields),
            Some((name, _)) => (name, Map::new()),
            None => Default::default(),
        },
        _ => Default::default(),
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::rig::Side;

    use super::*;

    #[test]
    fn every_kind_of_event_comes_back_and_stands_flat_in_its_message() {
        let side = Side::Left;
        let events = [
            TaskEvent::Begun,
            TaskEvent::Ended,
            TaskEvent::Aborted,
            TaskEvent::RingGrasped { ring: 5, side },
            TaskEvent::RingLifted { ring: 0, side },
            TaskEvent::RingTransferred { ring: 1, to: Side::Right },
            TaskEvent::RingPlaced { ring: 2, side, peg: 11 },
            TaskEvent::RingDropped { ring: 2, side, in_view: false },
            TaskEvent::RingKnockedOff { ring: 3, side: None },
            TaskEvent::RingKnockedOff { ring: 3, side: Some(side) },
            TaskEvent::LumpMarked { side, lump: None },
            TaskEvent::WireTouched { side },
            TaskEvent::WireLeft { side },
        ];
        for event in events {
            let happening = TimedTaskEvent { t_s: 12.25, event };
            assert_eq!(decode(&encode(&happening)), Some(happening));
        }
        let dropped = encode(&TimedTaskEvent { t_s: 0.5, event: events[7] });
        let dropped: Value = serde_json::from_slice(&dropped).unwrap();
        let expected: Value =
            serde_json::json!({"t_s": 0.5, "event": "ring_dropped", "ring": 2, "side": "left", "in_view": false});
        assert_eq!(dropped, expected);
        assert_eq!([events[7], events[4]].map(|event| kind(&event)), ["ring_dropped_out_of_view", "ring_lifted"]);
        assert!(serde_json::from_str::<Value>(SCHEMA).is_ok());
    }

    #[test]
    fn what_is_no_happening_of_this_version_is_none() {
        for text in [
            "",
            "{}",
            "[1]",
            r#"{"t_s": 1.0, "event": "ring_melted", "ring": 1}"#,
            r#"{"t_s": 1.0, "event": "ring_grasped", "ring": -1, "side": "left"}"#,
            r#"{"t_s": "now", "event": "begun"}"#,
            r#"{"t_s": 1.0, "event": 3}"#,
        ] {
            assert_eq!(decode(text.as_bytes()), None, "{text}");
        }
    }
}
