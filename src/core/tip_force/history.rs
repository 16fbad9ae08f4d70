//! Inputs computed from the history of other columns, because friction has a memory: a cable or seal carries different
//! loads before and after a reversal, which a single row does not show.
//!
//! Their names contain colons: `presliding:POSITION:WIDTH` and `midline:LOAD:POSITION:WIDTH`; WIDTH is in the unit of
//! the position. Both depend only on the path, not on speed or sample rate, and are causal. Their state is reset with
//! every trajectory.
//!
//! `presliding` is the stop operator of the position over its width, -1 to 1: +1 slides forwards, -1 backwards, values
//! in between occur while the motion reverses. `midline` is the load without its friction: the difference between the
//! loads of the two directions (the swing) is measured at every reversal, assuming that the load at the far end is
//! constant in the meantime, and half of it is subtracted. Until the first reversal the mean swing of the training data
//! is used, which is the second number in the name. The midline is smoothed over four widths of travel and is held
//! during a reversal. It follows a slow load; use the load itself as another input for fast changes.

#[derive(Clone, Debug, PartialEq)]
pub struct DerivedInput {
    /// The load column; `None` for `presliding`.
    load: Option<String>,
    position: String,
    width: f32,
    swing: Option<f32>,
}

/// State of a derived input. Steps allocate nothing.
#[derive(Clone, Debug)]
pub struct DerivedMemory {
    width: f32,
    /// The last position, and the distance travelled since the last reversal, limited to the width.
    last: Option<f32>,
    travel: f32,
    /// The direction of the last sliding motion (1, -1, or 0 before the first one), and its load, smoothed over twice
    /// the travel of a reversal.
    side: f32,
    load: f32,
    swing: f32,
}

impl DerivedInput {
    /// Parses a name. Returns `None` for a plain column (no colon), and an error that explains what is wrong with the
    /// name.
    pub fn parse(name: &str) -> Option<Result<Self, String>> {
        // A colon distinguishes a derived input from a column of a file.
        if !name.contains(':') {
            return None;
        }
        let number = |text: &str| text.parse::<f32>().ok().filter(|value| value.is_finite());
        let positive = |text: &str| number(text).filter(|value| *value > 0.0);
        let parts: Vec<&str> = name.split(':').collect();
        let made = match parts[..] {
            ["presliding", position, width] => positive(width).map(|width| (None, position, width, None)),
            ["midline", load, position, width] => positive(width).map(|width| (Some(load), position, width, None)),
            ["midline", load, position, width, swing] => {
                positive(width).zip(number(swing)).map(|(width, swing)| (Some(load), position, width, Some(swing)))
            }
            _ => None,
        };
        let refusal = || {
            format!(
                "\"{name}\" is neither presliding:POSITION:WIDTH nor midline:LOAD:POSITION:WIDTH with a width above 0"
            )
        };
        let build = |(load, position, width, swing): (Option<&str>, &str, f32, Option<f32>)| Self {
            load: load.map(str::to_owned),
            position: position.to_owned(),
            width,
            swing,
        };
        Some(made.map(build).ok_or_else(refusal))
    }

    /// Returns the columns from which the input is computed: position and load (the position twice if there is no
    /// load).
    pub fn columns(&self) -> [&str; 2] {
        [&self.position, self.load.as_ref().unwrap_or(&self.position)]
    }

    /// Returns whether the swing must still be determined from the training data.
    pub const fn is_open(&self) -> bool {
        self.load.is_some() && self.swing.is_none()
    }

    /// Creates the state at the start of a trajectory. A known swing (in the unit of the load) takes precedence over
    /// the one in the name.
    pub fn memory(&self, swing: Option<f32>) -> DerivedMemory {
        let swing = swing.or(self.swing).unwrap_or(0.0);
        DerivedMemory { width: self.width, last: None, travel: 0.0, side: 0.0, load: 0.0, swing }
    }

    /// Returns the value for the next row, and whether the swing has just been measured.
    pub fn step(&self, memory: &mut DerivedMemory, [position, load]: [f32; 2]) -> (f32, bool) {
        let measured = memory.step(position, load);
        let value = if self.load.is_some() { memory.midline(load) } else { memory.travel / memory.width };
        (value, measured)
    }

    /// Returns all swings of a trajectory in order: load forwards minus load backwards at each reversal.
    pub fn swings(&self, rows: &[[f32; 2]]) -> Vec<f32> {
        let mut memory = self.memory(None);
        rows.iter().filter_map(|row| self.step(&mut memory, *row).1.then_some(memory.swing)).collect()
    }
}

impl DerivedMemory {
    fn step(&mut self, position: f32, load: f32) -> bool {
        let moved = position - self.last.unwrap_or(position);
        self.last = Some(position);
        // Clamped at the width: beyond it the seal slides and only the direction is left.
        self.travel = (self.travel + moved).clamp(-self.width, self.width);
        if self.travel.abs() < self.width {
            return false;
        }
        let side = self.travel.signum();
        if side * self.side > 0.0 {
            // Four widths: twice the travel of a reversal, as in the description of `load`.
            self.load += (load - self.load) * (moved.abs() / (4.0 * self.width)).min(1.0);
            return false;
        }
        let turned = self.side != 0.0;
        if turned {
            // Half of this difference is friction: it changes its sign with the direction.
            self.swing = side * (load - self.load);
        }
        self.side = side;
        self.load = load;
        turned
    }

    fn midline(&self, load: f32) -> f32 {
        // Before the first reversal the direction is unknown, so only the travelled part counts.
        if self.side == 0.0 {
            return load - 0.5 * self.swing * self.travel / self.width;
        }
        self.load - 0.5 * self.swing * self.side
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presliding_tells_sliding_from_turning_round() {
        let derived = DerivedInput::parse("presliding:x_m:0.5").unwrap().unwrap();
        let mut memory = derived.memory(None);
        let values: Vec<f32> = [7.0, 7.25, 8.0, 7.75, 7.5, 6.0].map(|x| derived.step(&mut memory, [x, x]).0).to_vec();
        assert_eq!(values, [0.0, 0.5, 1.0, 0.5, 0.0, -1.0]);
    }

    #[test]
    fn a_midline_measures_coulomb_friction_at_each_reversal_and_holds_the_load_while_it_turns() {
        let derived = DerivedInput::parse("midline:f_n:x_m:0.05:1.0").unwrap().unwrap();
        let mut memory = derived.memory(None);
        let mut friction = derived.memory(None);
        let stop = DerivedInput::parse("presliding:x_m:0.02").unwrap().unwrap();
        let mut worst = 0.0_f32;
        for k in 0..4000_u16 {
            let x = (f32::from(k) * 0.01).sin();
            let sign = stop.step(&mut friction, [x, x]).0;
            // A growing load with friction 0.8: the swing is 1.6 plus or minus the growth during the reversal.
            let load = 2.0 + 0.0005 * f32::from(k);
            let (midline, _) = derived.step(&mut memory, [x, load + 0.8 * sign]);
            if k > 700 {
                worst = worst.max((midline - load).abs());
            }
        }
        assert!(worst < 0.1, "{worst}");
    }

    #[test]
    fn before_the_first_reversal_the_named_swing_stands() {
        let derived = DerivedInput::parse("midline:f_n:x_m:0.5:1.0").unwrap().unwrap();
        let mut memory = derived.memory(None);
        assert!(derived.step(&mut memory, [0.0, 3.0]) == (3.0, false));
        assert!(derived.step(&mut memory, [1.0, 3.0]) == (2.5, false));
        assert!(derived.swings(&[[0.0, 3.0], [1.0, 3.0], [0.0, 2.0]]) == [1.0]);
    }

    #[test]
    fn a_misspelt_name_is_refused_and_a_plain_one_is_not_touched() {
        assert!(DerivedInput::parse("fx_n").is_none());
        for name in
            ["presliding:x", "presliding:x:0", "presliding:x:nan", "midline:f:x:-1", "other:x:1", "midline:f:x:1:inf"]
        {
            assert!(DerivedInput::parse(name).unwrap().unwrap_err().contains(name));
        }
        assert!(DerivedInput::parse("midline:f:x:1").unwrap().unwrap().is_open());
        assert!(!DerivedInput::parse("midline:f:x:1:2").unwrap().unwrap().is_open());
    }
}
