//! Converts values of the loop to 64-bit words and back, exact to the bit.
//!
//! Every value is split into words in a fixed order. A structure is split by all its fields, so that a new field does
//! not compile until it is handled. The same words go into the columns of a journal and into the digest that a replay
//! compares. An absent value leaves its columns out: each field has its own columns.

mod columns;
mod commands;
mod inputs;
mod shown;

pub(crate) use columns::{BlockColumns, UnpackedColumns, bytes, number, take_number};

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, UnitVector3, Vector3};

/// A destination of words.
pub(crate) trait WordSink {
    fn word(&mut self, word: u64);

    /// Leaves these columns out.
    fn skip(&mut self, columns: usize);
}

/// A source of words.
pub(crate) trait WordSource {
    /// Returns the next word.
    ///
    /// # Errors
    /// [`CodecError::Short`] if there is none.
    fn word(&mut self) -> Result<u64, CodecError>;

    /// Skips columns that were left out.
    fn skip(&mut self, columns: usize);
}

/// Why words cannot be decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CodecError {
    /// Not enough words.
    #[error("it is shorter than it states")]
    Short,
    /// More words than needed.
    #[error("it is longer than it states")]
    Long,
    /// A word without a meaning.
    #[error("it contains an undefined value")]
    NoSuchValue,
}

/// A value that can be split into words.
pub(crate) trait ToWords {
    /// Number of columns, used or not.
    const COLUMNS: usize;

    /// Writes the value as words.
    fn put(&self, to: &mut impl WordSink);
}

/// A value that can be rebuilt from words.
pub(crate) trait FromWords: ToWords + Sized {
    /// Reads a value.
    ///
    /// # Errors
    /// [`CodecError`] if the words are not a value of this type.
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError>;
}

/// Rows of words, one after the other: for rare values.
impl WordSink for Vec<u64> {
    fn word(&mut self, word: u64) {
        self.push(word);
    }

    fn skip(&mut self, _: usize) {}
}

impl WordSource for std::vec::IntoIter<u64> {
    fn word(&mut self) -> Result<u64, CodecError> {
        // Never a default: a value that is invented would replay to a different force.
        self.next().ok_or(CodecError::Short)
    }

    fn skip(&mut self, _: usize) {}
}

/// Numbers that fit into a word.
macro_rules! numbers {
    ($($number:ty),*) => { $(
        impl ToWords for $number {
            const COLUMNS: usize = 1;

            fn put(&self, to: &mut impl WordSink) {
                #[allow(clippy::cast_lossless, reason = "one of them is as wide as a word")]
                to.word(*self as u64);
            }
        }

        impl FromWords for $number {
            fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
                let word = from.word()?;
                #[allow(clippy::cast_lossless, reason = "one of them is as wide as a word")]
                let number = word as Self;
                #[allow(clippy::cast_lossless, reason = "one of them is as wide as a word")]
                if number as u64 == word { Ok(number) } else { Err(CodecError::NoSuchValue) }
            }
        }
    )* };
}

numbers!(u8, u16, u64, usize);

impl ToWords for f64 {
    const COLUMNS: usize = 1;

    fn put(&self, to: &mut impl WordSink) {
        to.word(self.to_bits());
    }
}

impl FromWords for f64 {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        from.word().map(Self::from_bits)
    }
}

impl ToWords for f32 {
    const COLUMNS: usize = 1;

    fn put(&self, to: &mut impl WordSink) {
        to.word(u64::from(self.to_bits()));
    }
}

impl FromWords for f32 {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        u32::take(from).map(Self::from_bits)
    }
}

impl ToWords for u32 {
    const COLUMNS: usize = 1;

    fn put(&self, to: &mut impl WordSink) {
        to.word(u64::from(*self));
    }
}

impl FromWords for u32 {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        Self::try_from(from.word()?).map_err(|_| CodecError::NoSuchValue)
    }
}

impl ToWords for bool {
    const COLUMNS: usize = 1;

    fn put(&self, to: &mut impl WordSink) {
        to.word(u64::from(*self));
    }
}

impl FromWords for bool {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        match from.word()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(CodecError::NoSuchValue),
        }
    }
}

impl<T: ToWords> ToWords for Option<T> {
    const COLUMNS: usize = 1 + T::COLUMNS;

    fn put(&self, to: &mut impl WordSink) {
        self.is_some().put(to);
        match self {
            Some(value) => value.put(to),
            None => to.skip(T::COLUMNS),
        }
    }
}

impl<T: FromWords> FromWords for Option<T> {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        if bool::take(from)? {
            return T::take(from).map(Some);
        }
        from.skip(T::COLUMNS);
        Ok(None)
    }
}

impl<T: ToWords, const N: usize> ToWords for [T; N] {
    const COLUMNS: usize = N * T::COLUMNS;

    fn put(&self, to: &mut impl WordSink) {
        for value in self {
            value.put(to);
        }
    }
}

impl<T: FromWords + Copy + Default, const N: usize> FromWords for [T; N] {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        let mut values = [T::default(); N];
        for value in &mut values {
            *value = T::take(from)?;
        }
        Ok(values)
    }
}

impl ToWords for Vector3<f64> {
    const COLUMNS: usize = 3;

    fn put(&self, to: &mut impl WordSink) {
        self.iter().for_each(|x| x.put(to));
    }
}

impl FromWords for Vector3<f64> {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        Ok(Self::new(f64::take(from)?, f64::take(from)?, f64::take(from)?))
    }
}

impl ToWords for UnitVector3<f64> {
    const COLUMNS: usize = 3;

    fn put(&self, to: &mut impl WordSink) {
        self.as_ref().put(to);
    }
}

impl FromWords for UnitVector3<f64> {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        // The bits must be exact, so do not normalise again.
        Vector3::take(from).map(Self::new_unchecked)
    }
}

impl ToWords for UnitQuaternion<f64> {
    const COLUMNS: usize = 4;

    fn put(&self, to: &mut impl WordSink) {
        self.coords.iter().for_each(|x| x.put(to));
    }
}

impl FromWords for UnitQuaternion<f64> {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        let [i, j, k, w] = <[f64; 4]>::take(from)?;
        // The bits must be exact, so do not normalise again.
        Ok(Self::new_unchecked(Quaternion::new(w, i, j, k)))
    }
}

impl ToWords for Isometry3<f64> {
    const COLUMNS: usize = 7;

    fn put(&self, to: &mut impl WordSink) {
        let Self { rotation, translation } = self;
        translation.vector.put(to);
        rotation.put(to);
    }
}

impl FromWords for Isometry3<f64> {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        let translation = Translation3::from(Vector3::take(from)?);
        Ok(Self::from_parts(translation, UnitQuaternion::take(from)?))
    }
}

/// A structure: all its fields, in this order.
macro_rules! record {
    (put $type:ty { $($field:ident: $kind:ty),* $(,)? }) => {
        impl ToWords for $type {
            const COLUMNS: usize = 0 $(+ <$kind as ToWords>::COLUMNS)*;

            fn put(&self, to: &mut impl WordSink) {
                // Without `..`, so that a new field does not compile until it is handled here.
                let Self { $($field),* } = self;
                $($field.put(to);)*
            }
        }
    };
    ($type:ty { $($field:ident: $kind:ty),* $(,)? }) => {
        record!(put $type { $($field: $kind),* });

        impl FromWords for $type {
            fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
                Ok(Self { $($field: <$kind as FromWords>::take(from)?),* })
            }
        }
    };
}

/// An enum: the number of the variant, then the columns of every variant. Only those of the current variant are used.
macro_rules! choice {
    (put $type:ty { $($tag:literal => $variant:ident { $($field:tt: $name:ident: $kind:ty),* }),* $(,)? }) => {
        impl ToWords for $type {
            const COLUMNS: usize = 1 $($(+ <$kind as ToWords>::COLUMNS)*)*;

            #[allow(unused_variables, reason = "variants without fields, and the number alone")]
            fn put(&self, to: &mut impl WordSink) {
                // Without `_` and `..`, so that a new variant or field does not compile until it is handled here.
                let tag: u64 = match self { $(Self::$variant { $($field: $name),* } => $tag),* };
                to.word(tag);
                $(
                    if let Self::$variant { $($field: $name),* } = self {
                        $($name.put(to);)*
                    } else {
                        to.skip(0 $(+ <$kind as ToWords>::COLUMNS)*);
                    }
                )*
            }
        }
    };
    ($type:ty { $($tag:literal => $variant:ident { $($field:tt: $name:ident: $kind:ty),* }),* $(,)? }) => {
        choice!(put $type { $($tag => $variant { $($field: $name: $kind),* }),* });

        impl FromWords for $type {
            fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
                let tag = from.word()?;
                let mut made = None;
                $(
                    if tag == $tag {
                        made = Some(Self::$variant { $($field: <$kind as FromWords>::take(from)?),* });
                    } else {
                        from.skip(0 $(+ <$kind as ToWords>::COLUMNS)*);
                    }
                )*
                made.ok_or(CodecError::NoSuchValue)
            }
        }
    };
}

pub(crate) use {choice, record};
