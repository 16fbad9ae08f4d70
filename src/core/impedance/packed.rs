//! The model of a packet as a row of plain numbers for a network: one rendering's parameters at a time.
//!
//! The numbers are 32 bits wide: a parameter that is accurate to 1 in 10 million changes no force that a hand can feel,
//! and half the bytes leave room for the repair of losses. Columns that a model does not use are omitted.

use super::{
    AnchoredModel, BaselineModel, Contact, Form, LiteralModel, MODES, MatchedModel, Mode, ModeSet, Parcel, Wave,
    matched::COLUMNS as MATCHED_COLUMNS,
};
use crate::signal::Lanes;

/// Maximum number of numbers in one packed model: matched rendering with every column in use.
pub const PACKED_MAX: usize = 3 * MATCHED_COLUMNS + 24;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packed {
    /// Mode of the parameters: index into [`Mode::ALL`]; [`MODES`] for a baseline.
    pub slot: u8,
    /// Number of entries in use.
    pub len: u8,
    /// The parameters, SI units, in the order in which [`Packed::of`] writes them.
    pub numbers: [f32; PACKED_MAX],
}

/// Conversion of a rendering's parameters to and from numbers.
trait Numbers: Sized {
    const NONE: Self;

    fn write(&self, row: &mut Writer<'_>);

    /// Returns the parameters, or `None` if the numbers are invalid or not finite.
    fn read(row: &mut Reader<'_>) -> Option<Self>;
}

/// The parameters of one rendering within a packet.
trait Parameters {
    fn write(&self, row: &mut Writer<'_>);

    /// Replaces the parameters; returns false, and changes nothing, if the new ones are invalid or not finite.
    fn renew(&mut self, row: &mut Reader<'_>) -> bool;

    fn forget(&mut self);
}

impl<T: Numbers> Parameters for T {
    fn write(&self, row: &mut Writer<'_>) {
        Numbers::write(self, row);
    }

    fn renew(&mut self, row: &mut Reader<'_>) -> bool {
        T::read(row).map(|model| *self = model).is_some()
    }

    fn forget(&mut self) {
        *self = T::NONE;
    }
}

impl Parcel {
    /// Returns the parameters of the rendering in this slot; `None` if that rendering has none. Every slot after the
    /// program's own modes is the baseline's.
    fn parameters(&mut self, slot: usize) -> Option<&mut dyn Parameters> {
        let parameters: &mut dyn Parameters = match Mode::ALL.get(slot) {
            Some(Mode::Literal) => &mut self.literal,
            Some(Mode::Linear) => &mut self.linear,
            Some(Mode::Anchored) => &mut self.anchored,
            Some(Mode::Matched) => &mut self.matched,
            Some(Mode::Nima) => &mut self.nima,
            Some(Mode::Dfr | Mode::Best | Mode::Baseline(_)) => return None,
            None => &mut self.baseline,
        };
        Some(parameters)
    }
}

impl Packed {
    pub const NONE: Self = Self { slot: MODES as u8, len: 0, numbers: [0.0; PACKED_MAX] };

    pub fn used(&self) -> &[f32] {
        self.numbers.get(..usize::from(self.len)).unwrap_or(&[])
    }

    /// Returns how many renderings of this set have parameters to send.
    pub fn turns(modes: ModeSet) -> usize {
        Self::renderings(modes).count()
    }

    /// Returns the renderings that have parameters, in the order in which they take turns.
    fn renderings(modes: ModeSet) -> impl Iterator<Item = Mode> {
        modes.modes().filter(|mode| !matches!(mode, Mode::Dfr | Mode::Best))
    }

    /// Packs the parameters of the rendering whose turn it is among those in the packet; returns `None` if there are
    /// none.
    pub fn of(parcel: &Parcel, turn: usize) -> Option<Self> {
        let turn = turn.checked_rem(Self::turns(parcel.modes))?;
        let slot = Self::renderings(parcel.modes).nth(turn)?.index();
        let mut packed = Self { slot: slot as u8, ..Self::NONE };
        // A copy, because `parameters` returns mutable references.
        let mut parcel = *parcel;
        parcel.parameters(slot)?.write(&mut Writer { packed: &mut packed });
        Some(packed)
    }

    /// Removes the parameters of this slot from the packet: they are too old to compute a force.
    pub fn forget(slot: u8, parcel: &mut Parcel) {
        if let Some(parameters) = parcel.parameters(usize::from(slot)) {
            parameters.forget();
        }
    }

    /// Writes the parameters into the packet. Returns false, and changes nothing, if they are invalid or not finite.
    pub fn put_into(&self, parcel: &mut Parcel) -> bool {
        let parameters = parcel.parameters(usize::from(self.slot));
        parameters.is_some_and(|parameters| parameters.renew(&mut Reader { rest: self.used() }))
    }
}

struct Writer<'a> {
    packed: &'a mut Packed,
}

impl Writer<'_> {
    fn put(&mut self, number: f64) {
        if let Some(place) = self.packed.numbers.get_mut(usize::from(self.packed.len)) {
            *place = number as f32;
            self.packed.len += 1;
        }
    }

    fn lanes(&mut self, lanes: Lanes) {
        let Lanes([x, y, z, _]) = lanes;
        for number in [x, y, z] {
            self.put(number);
        }
    }

    fn row(&mut self, row: &[Lanes]) {
        let used = row.iter().rposition(|lanes| *lanes != Lanes::ZERO).map_or(0, |last| last + 1);
        self.put(used as f64);
        row.iter().take(used).for_each(|lanes| self.lanes(*lanes));
    }
}

struct Reader<'a> {
    rest: &'a [f32],
}

impl Reader<'_> {
    fn take(&mut self) -> Option<f64> {
        let (first, rest) = self.rest.split_first()?;
        self.rest = rest;
        first.is_finite().then(|| f64::from(*first))
    }

    /// Reads a whole number up to `most`.
    fn count(&mut self, most: usize) -> Option<usize> {
        let number = self.take()?;
        let count = number as usize;
        ((count as f64 - number).abs() < f64::EPSILON && count <= most).then_some(count)
    }

    fn lanes(&mut self) -> Option<Lanes> {
        Some(Lanes([self.take()?, self.take()?, self.take()?, 0.0]))
    }

    fn row<const N: usize>(&mut self) -> Option<[Lanes; N]> {
        let used = self.count(N)?;
        let mut row = [Lanes::ZERO; N];
        for place in row.iter_mut().take(used) {
            *place = self.lanes()?;
        }
        Some(row)
    }
}

impl Numbers for LiteralModel {
    const NONE: Self = Self::NONE;

    fn write(&self, row: &mut Writer<'_>) {
        row.put(f64::from(self.degree));
        row.lanes(self.constant_n);
        row.row(&self.coefficients);
    }

    fn read(row: &mut Reader<'_>) -> Option<Self> {
        Some(Self { degree: row.count(super::MAX_DEGREE)? as u8, constant_n: row.lanes()?, coefficients: row.row()? })
    }
}

impl Numbers for AnchoredModel {
    const NONE: Self = Self::NONE;

    fn write(&self, row: &mut Writer<'_>) {
        row.put(f64::from(self.degree));
        row.put(self.gain);
        row.put(self.bound_n);
        for lanes in [self.constant_n, self.centre_m, self.knee, self.low_n, self.high_n] {
            row.lanes(lanes);
        }
        row.row(&self.motion);
    }

    fn read(row: &mut Reader<'_>) -> Option<Self> {
        let degree = row.count(3)? as u8;
        let gain = row.take()?;
        let bound_n = row.take()?;
        let constant_n = row.lanes()?;
        let centre_m = row.lanes()?;
        let knee = row.lanes()?;
        let low_n = row.lanes()?;
        let high_n = row.lanes()?;
        Some(Self { motion: row.row()?, constant_n, centre_m, knee, low_n, high_n, bound_n, degree, gain })
    }
}

impl Numbers for MatchedModel {
    const NONE: Self = Self::NONE;

    fn write(&self, row: &mut Writer<'_>) {
        let (form, degree) = match self.form {
            Form::Tissue => (0, 0),
            Form::Sliding => (1, 0),
            Form::Coupled => (2, 0),
            Form::Paper(degree) => (3, degree),
        };
        row.put(f64::from(form));
        row.put(f64::from(degree));
        row.put(f64::from(self.degree));
        for lanes in [self.one, self.origin, self.bounds_n[0], self.bounds_n[1], self.offset_n] {
            row.lanes(lanes);
        }
        self.gives.iter().for_each(|give| row.put(*give));
        row.row(&self.parameters);
    }

    fn read(row: &mut Reader<'_>) -> Option<Self> {
        let form = row.count(3)?;
        let paper = row.count(super::MAX_DEGREE)? as u8;
        let form = [Form::Tissue, Form::Sliding, Form::Coupled, Form::Paper(paper)][form];
        let degree = row.count(super::MAX_DEGREE)? as u8;
        let one = row.lanes()?;
        let origin = row.lanes()?;
        let bounds_n = [row.lanes()?, row.lanes()?];
        let offset_n = row.lanes()?;
        let gives = [row.take()?, row.take()?];
        Some(Self { form, degree, one, parameters: row.row()?, origin, gives, bounds_n, offset_n })
    }
}

impl Numbers for BaselineModel {
    const NONE: Self = Self::Nothing;

    fn write(&self, row: &mut Writer<'_>) {
        match self {
            Self::Nothing => row.put(0.0),
            Self::Contact(contact) => {
                row.put(1.0);
                for lanes in
                    [contact.surface_m, contact.reach_m, contact.exponent, contact.bounds_n[0], contact.bounds_n[1]]
                {
                    row.lanes(lanes);
                }
                row.row(&contact.parameters);
            }
            Self::Wave(wave) => {
                row.put(2.0);
                row.lanes(wave.returning);
                row.lanes(wave.impedance_n_s_m);
            }
            Self::Returned { energy_j } => {
                row.put(3.0);
                row.lanes(*energy_j);
            }
            Self::Trend { force_n, rate_n_s } => {
                row.put(4.0);
                row.lanes(*force_n);
                row.lanes(*rate_n_s);
            }
            Self::Forecast { force_n } => {
                row.put(5.0);
                row.lanes(*force_n);
            }
        }
    }

    fn read(row: &mut Reader<'_>) -> Option<Self> {
        Some(match row.count(5)? {
            0 => Self::Nothing,
            1 => {
                let surface_m = row.lanes()?;
                let reach_m = row.lanes()?;
                let exponent = row.lanes()?;
                let bounds_n = [row.lanes()?, row.lanes()?];
                Self::Contact(Contact { surface_m, reach_m, exponent, parameters: row.row()?, bounds_n })
            }
            2 => Self::Wave(Wave { returning: row.lanes()?, impedance_n_s_m: row.lanes()? }),
            3 => Self::Returned { energy_j: row.lanes()? },
            4 => Self::Trend { force_n: row.lanes()?, rate_n_s: row.lanes()? },
            _ => Self::Forecast { force_n: row.lanes()? },
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::impedance::{Baseline, Identifier, SLOTS, Sample, Settings};

    /// Packets of two seconds of pressing, with every rendering computed.
    fn parcels(baseline: Baseline) -> Vec<Parcel> {
        let modes = ModeSet::ALL.with(Mode::Baseline(baseline));
        let mut identifier = Identifier::new(&Settings { modes, delay_s: 0.05, ..Settings::default() }).unwrap();
        (0..2000_u32)
            .map(|i| {
                let t_s = f64::from(i) * 1e-3;
                let depth_m = 0.004 * (6.0 * t_s).sin();
                let position_m = Vector3::new(0.002 * (9.0 * t_s).cos(), 0.001 * (4.0 * t_s).sin(), -depth_m);
                let force_n = Vector3::new(0.3 * (9.0 * t_s).cos(), 0.0, 600.0 * depth_m.max(0.0));
                identifier.step(&Sample { t_s, position_m, force_n });
                *identifier.parcel()
            })
            .collect()
    }

    fn close(one: &Parcel, other: &Parcel) -> bool {
        // Compares every parameter to 32 bits: comparing the debug texts would hide nothing either, but is slow.
        let near = |a: Lanes, b: Lanes| (a - b).norm() <= 1e-6 * (a.norm() + 1e-9);
        let rows = |a: &[Lanes], b: &[Lanes]| a.iter().zip(b).all(|(a, b)| near(*a, *b));
        rows(&one.matched.parameters, &other.matched.parameters)
            && rows(&one.nima.parameters, &other.nima.parameters)
            && rows(&one.anchored.motion, &other.anchored.motion)
            && rows(&one.literal.coefficients, &other.literal.coefficients)
            && rows(&one.linear.coefficients, &other.linear.coefficients)
            && near(one.anchored.centre_m, other.anchored.centre_m)
            && near(one.matched.origin, other.matched.origin)
            && [one.literal.degree, one.anchored.degree, one.matched.degree, one.nima.degree]
                == [other.literal.degree, other.anchored.degree, other.matched.degree, other.nima.degree]
            && (one.matched.form, one.nima.form) == (other.matched.form, other.nima.form)
            && std::mem::discriminant(&one.baseline) == std::mem::discriminant(&other.baseline)
    }

    #[test]
    fn every_model_arrives_as_it_was_packed() {
        for baseline in Baseline::ALL {
            let parcel = *parcels(baseline).last().unwrap();
            let mut arrived = Parcel { modes: parcel.modes, ..Parcel::BLANK };
            assert!(!close(&parcel, &arrived));
            let turns = Packed::turns(parcel.modes);
            assert_eq!(turns, 6);
            for turn in 0..turns {
                assert!(Packed::of(&parcel, turn).unwrap().put_into(&mut arrived), "turn {turn}");
            }
            assert!(close(&parcel, &arrived), "{baseline:?}");
            (0..SLOTS as u8).for_each(|slot| Packed::forget(slot, &mut arrived));
            assert_eq!(arrived, Parcel { modes: parcel.modes, ..Parcel::BLANK });
        }
    }

    #[test]
    fn a_set_without_parameters_has_none_to_send() {
        let parcel = Parcel { modes: ModeSet::only(Mode::Dfr), ..Parcel::BLANK };
        assert_eq!((Packed::turns(parcel.modes), Packed::of(&parcel, 0)), (0, None));
        assert_eq!(Packed::turns(ModeSet::only(Mode::Best)), 2);
    }

    #[test]
    fn what_makes_no_sense_changes_nothing() {
        let parcel = *parcels(Baseline::ModelMediated).last().unwrap();
        for turn in 0..6 {
            let good = Packed::of(&parcel, turn).unwrap();
            for at in 0..usize::from(good.len) {
                for bad in [f32::NAN, f32::INFINITY] {
                    let mut packed = good;
                    packed.numbers[at] = bad;
                    let mut arrived = parcel;
                    assert!(!packed.put_into(&mut arrived), "turn {turn}, number {at}");
                    assert_eq!(arrived, parcel);
                }
                let cut = Packed { len: at as u8, ..good };
                assert!(!cut.put_into(&mut parcel.clone()), "turn {turn}, cut at {at}");
            }
            assert!(!Packed { slot: Mode::Best.index() as u8, ..good }.put_into(&mut parcel.clone()));
        }
        let mut packed = Packed::of(&parcel, 3).unwrap();
        packed.numbers[0] = 17.0;
        assert!(!packed.put_into(&mut parcel.clone()), "no such form");
    }
}
