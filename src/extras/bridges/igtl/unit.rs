//! The unit of a sensor's values: a prefix, and up to six units with their powers, in 64 bits.

/// A unit. The prefix has 4 bits, followed by six fields of 6 bits for a unit and 4 bits for its power, the first in
/// the highest bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IgtlUnit(pub u64);

impl IgtlUnit {
    pub const NEWTON: Self = Self::of(0, &[(0xB, 1)]);

    /// Creates a unit from the number of a prefix, and numbers of units with their powers (-8 to 7); more than six are
    /// left out.
    pub const fn of(prefix: u8, units: &[(u8, i8)]) -> Self {
        let mut packed = (prefix as u64 & 0xF) << 60;
        let mut place = 0;
        while place < 6 && place < units.len() {
            let (unit, power) = units[place];
            let shift = 10 * (5 - place);
            packed |= ((unit as u64 & 0x3F) << (shift + 4)) | ((power as u64 & 0xF) << shift);
            place += 1;
        }
        Self(packed)
    }
}
