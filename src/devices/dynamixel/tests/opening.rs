//! Answers that arrive together.

use std::time::Instant;

use super::super::{
    codec::{OutgoingPackets, STATUS},
    opening::{DynamixelSession, SystemClock},
};
use crate::{Loss, transport::ByteStream};

/// A line on which all servos answer a request in one read.
struct Line {
    answers: Vec<u8>,
    asked: bool,
}

impl ByteStream for Line {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss> {
        let count = if self.asked { self.answers.len().min(buffer.len()) } else { 0 };
        buffer[..count].copy_from_slice(&self.answers[..count]);
        self.answers.drain(..count);
        Ok(count)
    }

    fn send(&mut self, _: &[u8]) -> Result<(), Loss> {
        self.asked = true;
        Ok(())
    }
}

#[test]
fn every_servo_is_found_though_their_answers_arrive_in_one_read() {
    // More servos than fit into one read.
    let ids: Vec<u8> = (1..=40).collect();
    let mut out = OutgoingPackets::new(1024);
    for id in &ids {
        let [low, high] = 1020_u16.to_le_bytes();
        out.begin(*id, STATUS).put(&[0, low, high, 45]).end();
    }
    let mut line = Line { answers: out.bytes().to_vec(), asked: false };
    let mut clock = SystemClock(Instant::now());
    let found = DynamixelSession::new(&mut line, &mut clock, "line").everybody().unwrap();
    assert_eq!(found, ids.into_iter().map(|id| (id, 1020)).collect::<Vec<_>>());
}
