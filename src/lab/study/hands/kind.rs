//! Kinds of hands and of readings that the governor meets, each wider than the first in one respect.

use serde::Serialize;

/// Extent of the targets of a hand, and therefore of its longest motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Targets {
    /// To one side of the start.
    Within35Mm,
    /// To both sides of the start.
    Within70Mm,
}

/// Properties of one kind of hand. Every kind has grips of 400 to 2000 N/m and of 8 to 40 N s/m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HandKind {
    /// Name in the tables.
    pub name: &'static str,
    /// Whether the motion is in space; otherwise it is on one axis.
    pub space: bool,
    /// Whether two hands hold one piece of tissue between them.
    pub two_hands: bool,
    /// Targets of the hand.
    pub targets: Targets,
    /// Whether a gripper opens and closes in the meantime and pushes the handle.
    pub gripper: bool,
    /// Maximum mass of the hand that moves with the handle, kg.
    pub hand_kg: f64,
    /// Step of the position reading, m.
    pub step_m: f64,
    /// Time by which a reading is older than its time stamp, s.
    pub late_s: f64,
    /// Sampling period of a device with its own clock, s; 0: it reads at the loop's request. A reading is then up to
    /// this much older.
    pub reads_every_s: f64,
    /// Error of the handle's mass, as a fraction in both directions.
    pub mass_error: f64,
    /// Maximum Coulomb friction, N, and maximum viscous friction, N s/m.
    pub coulomb_n: f64,
    /// See above.
    pub damping_n_s_m: f64,
}

impl HandKind {
    /// One hand on one axis, readings in steps of 10 um without delay.
    pub const USUAL: Self = Self {
        name: "usual",
        space: false,
        two_hands: false,
        targets: Targets::Within35Mm,
        gripper: false,
        hand_kg: 0.0,
        step_m: 1e-5,
        late_s: 0.0,
        reads_every_s: 0.0,
        mass_error: 0.2,
        coulomb_n: 0.15,
        damping_n_s_m: 1.0,
    };

    /// Every kind, in the order of the tables.
    pub const ALL: [Self; 14] = [
        Self::USUAL,
        Self { name: "to both sides", targets: Targets::Within70Mm, ..Self::USUAL },
        Self { name: "in space", space: true, ..Self::USUAL },
        Self { name: "two hands", two_hands: true, ..Self::USUAL },
        Self { name: "gripper", gripper: true, ..Self::USUAL },
        Self { name: "hand's mass", hand_kg: 0.35, ..Self::USUAL },
        Self { name: "steps of 1 um", step_m: 1e-6, ..Self::USUAL },
        Self { name: "steps of 40 um", step_m: 4e-5, ..Self::USUAL },
        Self { name: "1 ms late", late_s: 1e-3, ..Self::USUAL },
        Self { name: "3 ms late", late_s: 3e-3, ..Self::USUAL },
        Self { name: "own clock", reads_every_s: 1.003e-3, ..Self::USUAL },
        Self { name: "other mass", mass_error: 0.25, ..Self::USUAL },
        Self { name: "more friction", coulomb_n: 0.3, damping_n_s_m: 2.0, ..Self::USUAL },
        Self {
            name: "all but steps",
            space: true,
            two_hands: true,
            gripper: true,
            hand_kg: 0.35,
            late_s: 1e-3,
            mass_error: 0.25,
            coulomb_n: 0.3,
            damping_n_s_m: 2.0,
            ..Self::USUAL
        },
    ];

    /// Returns the number of hands of one trial.
    pub(super) const fn hands(&self) -> usize {
        if self.two_hands { 2 } else { 1 }
    }

    /// Returns whether a release of this kind differs from a usual one: there is one hand, which no longer reaches or
    /// grips.
    pub(super) fn lets_go_otherwise(&self) -> bool {
        let Self { name, two_hands, targets, gripper, .. } = Self::USUAL;
        Self { name, two_hands, targets, gripper, ..*self } != Self::USUAL
    }
}
