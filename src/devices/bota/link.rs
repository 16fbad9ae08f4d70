//! Carries the readings: within the bytes of the serial line, or as datagrams next to a connection for commands.

use super::codec::{BotaDecoder, BotaFrame, INERTIAL_BYTES};
use crate::{
    Loss,
    transport::{ByteStream, TransportDatagrams},
};

/// The connections of an open sensor. Receiving neither waits nor allocates.
pub(super) struct BotaLink {
    control: Box<dyn ByteStream>,
    stream: Option<Box<dyn TransportDatagrams>>,
    decoder: BotaDecoder,
    /// Datagrams that were not valid frames.
    damaged: u64,
}

/// Maximum number of reads from a serial line in one poll; each fills at most the decoder's buffer.
const READS_MAX: usize = 16;
/// Maximum number of datagrams read in one poll: over 60 ms of the fastest sensor.
const DATAGRAMS_MAX: usize = 256;
/// One byte more than the longest frame, so that a datagram that is too long is recognised.
const DATAGRAM_BYTES: usize = INERTIAL_BYTES + 1;

impl BotaLink {
    pub(super) fn new(control: Box<dyn ByteStream>, stream: Option<Box<dyn TransportDatagrams>>) -> Self {
        Self { control, stream, decoder: BotaDecoder::default(), damaged: 0 }
    }

    /// Passes every frame that has arrived to `give`.
    pub(super) fn receive(&mut self, give: impl FnMut(BotaFrame)) -> Result<(), Loss> {
        if self.stream.is_some() { self.receive_datagrams(give) } else { self.receive_bytes(give) }
    }

    fn receive_bytes(&mut self, mut give: impl FnMut(BotaFrame)) -> Result<(), Loss> {
        for _ in 0..READS_MAX {
            let count = self.control.receive(self.decoder.room())?;
            if count == 0 {
                break;
            }
            self.decoder.filled(count);
            while let Some(frame) = self.decoder.next() {
                give(frame);
            }
        }
        Ok(())
    }

    fn receive_datagrams(&mut self, mut give: impl FnMut(BotaFrame)) -> Result<(), Loss> {
        // No command is sent while the sensor runs, but a closed control connection means that the sensor is gone.
        self.control.receive(&mut [0; 64])?;
        let Some(stream) = &mut self.stream else { return Ok(()) };
        let mut buffer = [0; DATAGRAM_BYTES];
        for _ in 0..DATAGRAMS_MAX {
            let Some(count) = stream.receive(&mut buffer)? else { break };
            match BotaFrame::decode(&buffer[..count.min(DATAGRAM_BYTES)]) {
                Ok(frame) => {
                    stream.keep_to_sender();
                    give(frame);
                }
                Err(_) => self.damaged += 1,
            }
        }
        Ok(())
    }

    pub(super) fn discard(&mut self) -> Result<(), Loss> {
        self.receive(|_| {})?;
        self.decoder.clear();
        Ok(())
    }

    pub(super) const fn damaged(&self) -> u64 {
        self.damaged + self.decoder.damaged()
    }

    pub(super) const fn skipped(&self) -> u64 {
        self.decoder.skipped()
    }

    pub(super) fn send(&mut self, command: &[u8]) -> Result<(), Loss> {
        self.control.send(command)
    }

    pub(super) fn into_lines(self) -> (Box<dyn ByteStream>, Option<Box<dyn TransportDatagrams>>) {
        (self.control, self.stream)
    }
}
