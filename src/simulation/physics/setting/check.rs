//! The ranges of all values.

use super::{ObjectSettings, RingStart, SettingError};

/// Maximum number of pegs: bounds the cost of a step.
const PEGS_MAX: usize = 32;
/// Maximum number of rings.
pub const RINGS_MAX: usize = 12;

fn within(key: &'static str, value: f64, fits: bool, allowed: &'static str) -> Result<(), SettingError> {
    if fits && value.is_finite() { Ok(()) } else { Err(SettingError { key, value, allowed }) }
}

impl ObjectSettings {
    /// # Errors
    /// [`SettingError`] for the first value out of range.
    pub fn validate(&self) -> Result<(), SettingError> {
        self.validate_board()?;
        self.validate_rings()?;
        self.validate_laws()?;
        self.validate_jaws()?;
        for axis in 0..3 {
            let from_m = self.view.from_m[axis];
            let to_m = self.view.to_m[axis];
            within("view.from_m", from_m, from_m.abs() <= 1.0, "within 1 m of the origin")?;
            within("view.to_m", to_m, to_m.abs() <= 1.0 && from_m < to_m, "above from_m, within 1 m of the origin")?;
        }
        Ok(())
    }

    fn validate_board(&self) -> Result<(), SettingError> {
        let board = &self.board;
        let pegs = &self.pegs;
        within("board.z_m", board.z_m, board.z_m.abs() <= 0.5, "within 0.5 m of 0")?;
        for size_m in board.size_m {
            within("board.size_m", size_m, (0.01..=1.0).contains(&size_m), "from 0.01 to 1 m")?;
        }
        let count = pegs.position_m.len();
        within("pegs.at_m (count)", count as f64, count <= PEGS_MAX, "at most 32")?;
        for entry in pegs.position_m.iter().flatten() {
            within("pegs.at_m", *entry, entry.abs() <= 0.5, "within 0.5 m of the origin")?;
        }
        within("pegs.radius_m", pegs.radius_m, (5e-4..=0.02).contains(&pegs.radius_m), "from 0.0005 to 0.02 m")?;
        let fits = (2.0 * pegs.radius_m..=0.1).contains(&pegs.height_m);
        within("pegs.height_m", pegs.height_m, fits, "from twice the radius to 0.1 m")
    }

    fn validate_rings(&self) -> Result<(), SettingError> {
        let ring = &self.ring;
        let fits = (5e-4..=0.01).contains(&ring.tube_radius_m);
        within("ring.tube_radius_m", ring.tube_radius_m, fits, "from 0.0005 to 0.01 m")?;
        let fits = ring.major_radius_m > ring.tube_radius_m && ring.major_radius_m <= 0.05;
        within("ring.major_radius_m", ring.major_radius_m, fits, "above tube_radius_m, at most 0.05 m")?;
        within("ring.mass_kg", ring.mass_kg, (5e-4..=0.05).contains(&ring.mass_kg), "from 0.0005 to 0.05 kg")?;
        let count = self.rings.len();
        within("rings (count)", count as f64, count <= RINGS_MAX, "at most 12")?;
        for start in &self.rings {
            match start {
                RingStart::Peg(peg) => {
                    within("rings.peg", *peg as f64, *peg < self.pegs.position_m.len(), "the number of a peg, from 0")?;
                    let hole_m = ring.major_radius_m - ring.tube_radius_m;
                    let fits = hole_m > self.pegs.radius_m;
                    within("pegs.radius_m", self.pegs.radius_m, fits, "less than the hole of the rings on them")?;
                }
                RingStart::At(position_m) => {
                    for entry in position_m {
                        within("rings.at_m", *entry, entry.abs() <= 0.5, "within 0.5 m of the origin")?;
                    }
                }
            }
        }
        Ok(())
    }

    fn validate_laws(&self) -> Result<(), SettingError> {
        let friction = &self.friction;
        for (key, value) in [
            ("friction.jaw_ring", friction.jaw_ring),
            ("friction.ring_board", friction.ring_board),
            ("friction.ring_peg", friction.ring_peg),
            ("friction.ring_ring", friction.ring_ring),
            ("friction.instrument", friction.instrument),
        ] {
            within(key, value, (0.0..=2.0).contains(&value), "from 0 to 2")?;
        }
        let patch_m = friction.patch_radius_m;
        within("friction.patch_radius_m", patch_m, (0.0..=0.005).contains(&patch_m), "from 0 to 0.005 m")?;
        let contact = &self.contact;
        let fits = (100.0..=5000.0).contains(&contact.stiffness_n_m);
        within("contact.stiffness_n_m", contact.stiffness_n_m, fits, "from 100 to 5000 N/m")?;
        let fits = (0.0..=50.0).contains(&contact.damping_n_s_m);
        within("contact.damping_n_s_m", contact.damping_n_s_m, fits, "from 0 to 50 N s/m")?;
        let fits = (500.0..=10_000.0).contains(&contact.ring_stiffness_n_m);
        within("contact.ring_stiffness_n_m", contact.ring_stiffness_n_m, fits, "from 500 to 10000 N/m")
    }

    fn validate_jaws(&self) -> Result<(), SettingError> {
        let jaws = &self.jaws;
        let fits = (0.002..=0.05).contains(&jaws.finger_length_m);
        within("jaws.finger_length_m", jaws.finger_length_m, fits, "from 0.002 to 0.05 m")?;
        let fits = (2e-4..=0.01).contains(&jaws.finger_radius_m);
        within("jaws.finger_radius_m", jaws.finger_radius_m, fits, "from 0.0002 to 0.01 m")?;
        let fits = (5e-4..=0.01).contains(&jaws.shaft_radius_m);
        within("jaws.shaft_radius_m", jaws.shaft_radius_m, fits, "from 0.0005 to 0.01 m")?;
        let fits = (50.0..=5000.0).contains(&jaws.stiffness_n_m);
        within("jaws.stiffness_n_m", jaws.stiffness_n_m, fits, "from 50 to 5000 N/m")?;
        let fits = jaws.force_max_n > 0.0 && jaws.force_max_n <= 20.0;
        within("jaws.force_max_n", jaws.force_max_n, fits, "above 0 N and at most 20 N")
    }
}
