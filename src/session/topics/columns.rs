//! Reads a topic of named numbers by the names in its messages, into this program's own order.

use nima_recording::messages::JointStateDecoder;

use super::plots;

/// A column of this name occurs twice in sessions of an earlier version. The second one is the gain itself.
const BEFORE: &str = ".gain";
/// Name that the gain's column has now.
const NOW: &str = ".gain_value";

#[derive(Debug)]
pub(crate) struct TopicColumns {
    /// Names in the order of this program.
    known: Vec<String>,
    decoder: JointStateDecoder,
    /// Names in the messages, and the index of each known name among them.
    read: Vec<String>,
    places: Option<Vec<usize>>,
    values: Vec<f64>,
}

impl TopicColumns {
    /// Returns the columns of the topic with this name; `None` if it is not a topic of named numbers.
    pub(crate) fn of(topic: &str) -> Option<Self> {
        let (_, known, _) = plots().into_iter().find(|(name, ..)| name == topic)?;
        let decoder = JointStateDecoder::default();
        let values = Vec::new();
        Some(Self { known, decoder, read: Vec::new(), places: None, values })
    }

    /// Returns the numbers of a message in the order of this program; `None` if it cannot be read or a number is
    /// missing.
    pub(crate) fn read(&mut self, message: &[u8]) -> Option<&[f64]> {
        if !self.decoder.decode(message) {
            return None;
        }
        if self.read != self.decoder.names() {
            self.read = self.decoder.names().to_vec();
            self.places = self.known.iter().map(|name| place(&self.read, name)).collect();
        }
        let places = self.places.as_ref()?;
        self.values.clear();
        self.values.extend(places.iter().map(|place| self.decoder.values()[*place]));
        Some(&self.values)
    }
}

fn place(names: &[String], name: &str) -> Option<usize> {
    let before = || {
        let before = format!("{}{BEFORE}", name.strip_suffix(NOW)?);
        let place = names.iter().rposition(|known| *known == before)?;
        names[..place].contains(&before).then_some(place)
    };
    names.iter().position(|known| known == name).or_else(before)
}

#[cfg(test)]
mod tests {
    use nima_recording::messages::JointStateEncoder;

    use super::*;

    #[test]
    fn numbers_are_found_by_their_names_whatever_their_order() {
        let (_, names, _) = plots().into_iter().find(|(topic, ..)| topic == "left/gates").unwrap();
        let mut distinct = names.clone();
        distinct.sort();
        distinct.dedup();
        assert_eq!(distinct.len(), names.len(), "no two columns have the same name");
        let expected: Vec<f64> = (0..names.len()).map(|i| i as f64).collect();
        let message = |names: &[&str], values: &[f64]| {
            JointStateEncoder::new("world", names).encode(1, values, &[], &[]).unwrap().to_vec()
        };
        let read = |message: &[u8]| TopicColumns::of("left/gates").unwrap().read(message).map(<[f64]>::to_vec);
        let forward: Vec<&str> = names.iter().map(String::as_str).collect();
        assert_eq!(read(&message(&forward, &expected)).unwrap(), expected);
        let backward: Vec<&str> = forward.iter().rev().copied().chain(["left.other"]).collect();
        let values: Vec<f64> = expected.iter().rev().copied().chain([99.0]).collect();
        assert_eq!(read(&message(&backward, &values)).unwrap(), expected, "turned round, with one more");
        let before: Vec<&str> =
            forward.iter().map(|name| if *name == "left.gain_value" { "left.gain" } else { *name }).collect();
        assert_eq!(read(&message(&before, &expected)).unwrap(), expected, "as a version before wrote it");
        assert_eq!(read(&message(&forward[1..], &expected[1..])), None, "one is missing");
        assert_eq!(read(b"something else"), None);
        assert!(TopicColumns::of("log").is_none());
    }
}
