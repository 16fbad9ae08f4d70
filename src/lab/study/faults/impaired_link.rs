//! A link that loses, delays, reorders, duplicates, corrupts or repeats packets; it wraps the loop's own link.

use nima_core::impedance::LinkPacket;
use nima_machine::teleop::{Link, ProgrammedLink};

/// An impairment of the packets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum PacketImpairment {
    #[default]
    None,
    /// Loses every packet.
    LosesAll,
    /// Loses every second packet.
    LosesHalf,
    /// Delivers every packet late by this much, s.
    Late(f64),
    /// Swaps neighbouring packets.
    Swaps,
    /// Delivers every packet twice.
    Doubles,
    /// Replaces numbers of the force by NaN.
    Poisons,
    /// Repeats one packet under new time stamps.
    Repeats,
}

#[derive(Clone, Debug)]
pub(super) struct ImpairedLink {
    line: ProgrammedLink,
    impairment: PacketImpairment,
    /// Packets offered since the impairment changed, and one that is held back.
    offered: usize,
    kept: LinkPacket,
}

impl ImpairedLink {
    pub(super) fn new(rate_hz: f64, delay_s: f64) -> Self {
        let line = ProgrammedLink::new(rate_hz, delay_s);
        Self { line, impairment: PacketImpairment::None, offered: 0, kept: LinkPacket::BLANK }
    }

    /// Impairs the link from now on.
    pub(super) const fn impair(&mut self, impairment: PacketImpairment) {
        self.impairment = impairment;
        self.offered = 0;
    }
}

impl Link for ImpairedLink {
    fn set_delay(&mut self, delay_s: f64) {
        self.line.set_delay(delay_s);
    }

    fn clear(&mut self) {
        self.line.clear();
    }

    fn send(&mut self, parcel: &LinkPacket) {
        let first_of_two = self.offered.is_multiple_of(2);
        let first = self.offered == 0;
        self.offered += 1;
        match self.impairment {
            PacketImpairment::None | PacketImpairment::Late(_) => self.line.send(parcel),
            PacketImpairment::LosesAll => {}
            PacketImpairment::LosesHalf => {
                if first_of_two {
                    self.line.send(parcel);
                }
            }
            PacketImpairment::Swaps if first_of_two => self.kept = *parcel,
            PacketImpairment::Swaps => {
                self.line.send(parcel);
                self.line.send(&self.kept);
            }
            PacketImpairment::Doubles => {
                self.line.send(parcel);
                self.line.send(parcel);
            }
            PacketImpairment::Poisons => {
                let mut poisoned = *parcel;
                poisoned.force_n.fill(f64::NAN);
                self.line.send(&poisoned);
            }
            PacketImpairment::Repeats => {
                if first {
                    self.kept = *parcel;
                }
                self.line.send(&LinkPacket { t_s: parcel.t_s, ..self.kept });
            }
        }
    }

    fn receive(&mut self, now_s: f64) -> Option<&LinkPacket> {
        let late_s = if let PacketImpairment::Late(by_s) = self.impairment { by_s } else { 0.0 };
        self.line.receive(now_s - late_s)
    }
}
