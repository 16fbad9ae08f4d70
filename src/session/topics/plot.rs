//! A channel of named numbers.

use nima_machine::rig::Side;
use nima_recording::{messages::JointStateEncoder, session::WriteError};

use crate::sinks::{SessionSinks, SinkChannel};

/// A channel, and the values of its next message.
#[derive(Debug)]
pub(crate) struct Plot {
    channel: SinkChannel,
    encoder: JointStateEncoder,
    pub(crate) values: Vec<f64>,
}

impl Plot {
    pub(crate) fn of_side(out: &mut SessionSinks, side: Side, what: &str, names: &[&str]) -> Result<Self, WriteError> {
        let names: Vec<String> = names.iter().map(|name| format!("{}.{name}", side.word())).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        Self::new(out, &format!("{}/{what}", side.word()), &names)
    }

    pub(crate) fn new(out: &mut SessionSinks, topic: &str, names: &[&str]) -> Result<Self, WriteError> {
        let channel = out.channel(topic, JointStateEncoder::encoding())?;
        Ok(Self { channel, encoder: JointStateEncoder::new("world", names), values: Vec::new() })
    }

    /// Writes the values and clears them; forces are efforts.
    pub(crate) fn write(&mut self, out: &mut SessionSinks, time_ns: u64, efforts: bool) -> Result<(), WriteError> {
        let (position, effort) = if efforts { (&[][..], &self.values[..]) } else { (&self.values[..], &[][..]) };
        if let Ok(message) = self.encoder.encode(time_ns, position, &[], effort) {
            out.message(self.channel, time_ns, message)?;
        }
        self.values.clear();
        Ok(())
    }
}
