//! Report of the gates: which acted in a tick, why, and how often so far.

use super::ChainSettings;

/// Declares an enum together with the list of its values.
macro_rules! listed {
    ($(#[$attribute:meta])* enum $name:ident { $($(#[$doc:meta])* $value:ident,)* }) => {
        $(#[$attribute])*
        pub enum $name {
            $($(#[$doc])* $value,)*
        }

        impl $name {
            /// All values, in this order.
            pub const ALL: [Self; [$(stringify!($value)),*].len()] = [$(Self::$value),*];
        }
    };
}

listed! {
    /// The gates, in the order of the chain.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
    #[serde(rename_all = "snake_case")]
    enum Gate {
        /// Whether the state machine allows force at all.
        Permission,
        /// Whether the force is present, finite and plausible.
        Validity,
        /// Age of the data.
        Age,
        /// Whether the hand moves.
        DeadBand,
        /// The operator's factor.
        Gain,
        /// Rate of change of the force.
        Slew,
        /// Energy that the hand receives beyond the energy that it gave.
        Energy,
        /// Size of the force.
        Ceiling,
        /// Whether a hand carries the force.
        Governor,
    }
}

/// Number of gates.
pub const GATES: usize = Gate::ALL.len();

impl Gate {
    /// Returns the position in [`Gate::ALL`], for tables with one entry per gate.
    /// Declaration order is the index: see `listed!`.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Returns the name in a trace.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Permission => "not_permitted",
            Self::Validity => "validity",
            Self::Age => "age",
            Self::DeadBand => "dead_band",
            Self::Gain => "gain",
            Self::Slew => "slew",
            Self::Energy => "energy",
            Self::Ceiling => "ceiling",
            Self::Governor => "governor",
        }
    }
}

listed! {
    /// Why a gate took force away.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
    #[serde(rename_all = "snake_case")]
    enum Reason {
        /// The gate did not act: the force passed.
        #[default]
        Open,
        /// The loop is not engaged.
        NotPermitted,
        /// The mode has nothing valid to render.
        NothingAsked,
        /// A number of the request is NaN or infinite.
        NotFinite,
        /// The request is larger than any contact.
        Implausible,
        /// The data are older than the link explains: the force fades.
        Ageing,
        /// The data are too old, or of unknown age.
        TooOld,
        /// The hand is slower than the dead band.
        HandSlow,
        /// The speed of the hand is not known.
        SpeedUnknown,
        /// The operator set the gain to zero.
        GainZero,
        /// The gain is on its way to the value that was chosen.
        GainRamping,
        /// The force would change too fast.
        ChangeTooFast,
        /// The hand would receive more energy than it gave.
        EnergySpent,
        /// The force is above the ceiling.
        AboveCeiling,
        /// The force is above the capability of the device.
        AboveDeviceLimit,
        /// The handle moves along the force in a way that a hand rarely does: the force fades, or returns afterwards.
        RunsAway,
        /// The handle is at rest after a release, and there has been no sign of a hand since.
        HandGone,
        /// The hand has certainly released the handle: no force except the brake's.
        LetGo,
    }
}

/// Number of times that each gate acted since the chain was created, and its last reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct GateCounts {
    /// Number of requests, whether a gate acted or not.
    pub ticks: u64,
    /// Number of requests on which each gate acted, indexed by [`Gate::index`].
    pub acted: [u64; GATES],
    /// Last reason of each gate; [`Reason::Open`] if it never acted.
    pub last: [Reason; GATES],
}

impl GateCounts {
    /// Returns the fraction of all requests on which `gate` acted, 0 to 1.
    pub fn fraction(&self, gate: Gate) -> f64 {
        // Before the first request nothing has been gated, so the fraction is zero and not NaN.
        if self.ticks == 0 { 0.0 } else { self.acted[gate.index()] as f64 / self.ticks as f64 }
    }

    pub(super) fn add(&mut self, reasons: &[Reason; GATES]) {
        self.ticks += 1;
        for (gate, &reason) in reasons.iter().enumerate() {
            if reason != Reason::Open {
                self.acted[gate] += 1;
                self.last[gate] = reason;
            }
        }
    }
}

/// Actions of the gates in one tick. [`Reason::Open`] everywhere means that the force passed unchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GateReport {
    /// Reason of each gate, indexed by [`Gate::index`].
    pub reasons: [Reason; GATES],
    /// Force that the dead band removed, N.
    pub withheld_n: f64,
    /// Fraction of the force that the governor removed, 0 to 1.
    pub governed: f64,
    pub gain: f64,
    /// Energy that the hand may still receive, J; negative if it received too much (computed unless the gate is off).
    pub stored_j: f64,
    /// Counters since the chain was created, including this tick.
    pub counts: GateCounts,
    /// Settings of the chain (`gain` is the operator's setting; the ramped gain is the report's own).
    pub settings: ChainSettings,
}

impl GateReport {
    /// Records that `gate` acted for this reason; [`Reason::Open`] records nothing.
    pub(super) const fn note(&mut self, gate: Gate, reason: Reason) {
        self.reasons[gate.index()] = reason;
    }

    /// Returns the report with `gate` marked as acting for this reason; for tests of code that reads a report.
    #[must_use]
    pub const fn with(mut self, gate: Gate, reason: Reason) -> Self {
        self.note(gate, reason);
        self
    }

    /// Returns whether `gate` removed or held back force in this tick.
    pub const fn acted(&self, gate: Gate) -> bool {
        !matches!(self.reason(gate), Reason::Open)
    }

    pub const fn reason(&self, gate: Gate) -> Reason {
        self.reasons[gate.index()]
    }

    /// Returns the first gate that acted, if any. A ramping gain does not count; a gain of zero does.
    pub fn first(&self) -> Option<(Gate, Reason)> {
        let acted = |reason| !matches!(reason, Reason::Open | Reason::GainRamping);
        Gate::ALL.into_iter().map(|gate| (gate, self.reason(gate))).find(|(_, reason)| acted(*reason))
    }

    /// Returns the first closed gate in one word, for a trace; `open` if the force passed unchanged.
    pub fn first_closed(&self) -> &'static str {
        self.first().map_or("open", |(gate, _)| gate.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_gate_in_the_chains_order_is_told_and_every_one_is_counted() {
        let mut report = GateReport::default();
        assert_eq!(report.first_closed(), "open");
        report.note(Gate::Gain, Reason::GainRamping);
        assert_eq!(report.first_closed(), "open", "a ramp takes nothing away");
        report.note(Gate::Ceiling, Reason::AboveCeiling);
        report.note(Gate::Age, Reason::Ageing);
        assert_eq!(report.first(), Some((Gate::Age, Reason::Ageing)));
        let mut counts = GateCounts::default();
        counts.add(&report.reasons);
        counts.add(&[Reason::Open; GATES]);
        assert!((counts.fraction(Gate::Ceiling) - 0.5).abs() < f64::EPSILON && counts.fraction(Gate::Slew) == 0.0);
        assert_eq!(counts.last[Gate::Age.index()], Reason::Ageing);
    }
}
