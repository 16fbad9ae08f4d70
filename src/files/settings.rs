//! Settings in TOML, read into a type of its own.
//!
//! `toml` parses the text; the way from its values into a type is here, because `toml`'s builds each type four times (for tables, dates,
//! positions and documents), which was a megabyte of the program. Dates are not settings and are refused; so are entries
//! that nothing reads.

use std::{fmt, ops::Range};

use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, EnumAccess, Error as _, MapAccess, SeqAccess, Unexpected,
    VariantAccess, Visitor, value::StrDeserializer,
};
use toml::{
    Spanned,
    de::{DeString, DeTable, DeValue},
};

/// Why a text is not what it should be: what, and where in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misfit {
    message: String,
    span: Option<Range<usize>>,
}

impl Misfit {
    /// What is wrong, in one line.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Which line of `text`, which was read, it is about, from 1.
    #[must_use]
    pub fn line(&self, text: &str) -> usize {
        let start = self.span.as_ref().map_or(0, |span| span.start.min(text.len()));
        text.bytes().take(start).filter(|byte| *byte == b'\n').count() + 1
    }

    /// What is wrong, and where in the text.
    #[must_use]
    pub fn new(message: impl fmt::Display, span: Option<Range<usize>>) -> Self {
        Self { message: message.to_string().lines().collect::<Vec<_>>().join(" "), span }
    }

    /// At `span`, unless a place inside of it is known.
    fn at(mut self, span: &Range<usize>) -> Self {
        self.span.get_or_insert_with(|| span.clone());
        self
    }
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Misfit {}

impl serde::de::Error for Misfit {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::new(message, None)
    }
}

impl From<toml::de::Error> for Misfit {
    fn from(error: toml::de::Error) -> Self {
        Self::new(error.message(), error.span())
    }
}

/// Reads a text of settings.
///
/// # Errors
/// [`Misfit`]: the text is no TOML, or has an unknown, missing or wrong value.
///
/// ```
/// #[derive(serde::Deserialize)]
/// struct Hand {
///     stiffness_n_m: f64,
/// }
///
/// let hand: Hand = nima_files::from_toml("stiffness_n_m = 300").expect("whole");
/// assert_eq!(hand.stiffness_n_m, 300.0);
/// let text = "\nstiffness_n_m = \"much\"";
/// let wrong = nima_files::from_toml::<Hand>(text).err().expect("no number");
/// assert_eq!((wrong.line(text), wrong.message()), (2, "invalid type: string \"much\", expected f64"));
/// ```
pub fn from_toml<T: DeserializeOwned>(text: &str) -> Result<T, Misfit> {
    from_table(DeTable::parse(text)?)
}

/// Reads a parsed text, of which something may have been changed.
///
/// # Errors
/// [`Misfit`], as [`from_toml`].
pub fn from_table<T: DeserializeOwned>(table: Spanned<DeTable<'_>>) -> Result<T, Misfit> {
    let span = table.span();
    T::deserialize(Value(Spanned::new(span.clone(), DeValue::Table(table.into_inner()))))
        .map_err(|misfit| misfit.at(&span))
}

struct Value<'de>(Spanned<DeValue<'de>>);

impl Value<'_> {
    /// What it is, for a message.
    fn is_not(&self, expected: &dyn serde::de::Expected) -> Misfit {
        let found = match self.0.get_ref() {
            DeValue::String(text) => Unexpected::Str(text),
            DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
                Ok(number) => Unexpected::Signed(number),
                Err(_) => Unexpected::Other("integer"),
            },
            DeValue::Float(number) => number.as_str().parse().map_or(Unexpected::Other("number"), Unexpected::Float),
            DeValue::Boolean(truth) => Unexpected::Bool(*truth),
            DeValue::Datetime(_) => Unexpected::Other("date"),
            DeValue::Array(_) => Unexpected::Seq,
            DeValue::Table(_) => Unexpected::Map,
        };
        Misfit::invalid_type(found, expected).at(&self.0.span())
    }
}

/// The entries of a table, or of an array (then without keys).
struct Entries<I, V> {
    rest: I,
    value: Option<V>,
}

fn entries(table: DeTable<'_>) -> impl MapAccess<'_, Error = Misfit> {
    Entries { rest: table.into_iter(), value: None }
}

impl<'de, I: Iterator<Item = (Spanned<DeString<'de>>, Spanned<DeValue<'de>>)>> MapAccess<'de>
    for Entries<I, Spanned<DeValue<'de>>>
{
    type Error = Misfit;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Misfit> {
        let Some((key, value)) = self.rest.next() else { return Ok(None) };
        self.value = Some(value);
        seed.deserialize(StrDeserializer::new(key.get_ref())).map(Some).map_err(|misfit: Misfit| misfit.at(&key.span()))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Misfit> {
        let value = self.value.take().ok_or_else(|| Misfit::custom("a value was asked for before its key"))?;
        seed.deserialize(Value(value))
    }
}

impl<'de, I: Iterator<Item = Spanned<DeValue<'de>>>> SeqAccess<'de> for Entries<I, ()> {
    type Error = Misfit;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Misfit> {
        self.rest.next().map(|value| seed.deserialize(Value(value))).transpose()
    }
}

/// A choice: its name alone, or its name and what belongs to it.
struct Choice<'de> {
    name: Spanned<DeString<'de>>,
    value: Option<Spanned<DeValue<'de>>>,
}

impl<'de> Choice<'de> {
    fn value(self, expected: &dyn serde::de::Expected) -> Result<Value<'de>, Misfit> {
        let span = self.name.span();
        self.value.map(Value).ok_or_else(|| Misfit::invalid_type(Unexpected::UnitVariant, expected).at(&span))
    }
}

impl<'de> EnumAccess<'de> for Choice<'de> {
    type Error = Misfit;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Misfit> {
        let named = seed.deserialize(StrDeserializer::new(self.name.get_ref()));
        Ok((named.map_err(|misfit: Misfit| misfit.at(&self.name.span()))?, self))
    }
}

impl<'de> VariantAccess<'de> for Choice<'de> {
    type Error = Misfit;

    fn unit_variant(self) -> Result<(), Misfit> {
        match self.value {
            None => Ok(()),
            Some(value) if value.get_ref().as_table().is_some_and(DeTable::is_empty) => Ok(()),
            Some(value) => Err(Value(value).is_not(&"nothing behind this choice")),
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Misfit> {
        seed.deserialize(self.value(&"a choice with its settings")?)
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Misfit> {
        self.value(&visitor)?.deserialize_tuple(length, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(self, fields: &'static [&'static str], visitor: V) -> Result<V::Value, Misfit> {
        self.value(&visitor)?.deserialize_struct("", fields, visitor)
    }
}

/// Each kind asks its visitor for that kind alone: what is asked for in vain is built all the same.
impl<'de> Deserializer<'de> for Value<'de> {
    type Error = Misfit;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match self.0.get_ref() {
            DeValue::Table(_) => self.deserialize_map(visitor),
            DeValue::Array(_) => self.deserialize_seq(visitor),
            _ => self.deserialize_f64(visitor),
        }
    }

    /// Any single value: a visitor of numbers takes whole ones too.
    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        let span = self.0.span();
        match self.0.get_ref() {
            DeValue::String(text) => visitor.visit_str(text),
            DeValue::Boolean(truth) => visitor.visit_bool(*truth),
            DeValue::Integer(number) => {
                let (digits, radix) = (number.as_str(), number.radix());
                match (i64::from_str_radix(digits, radix), u64::from_str_radix(digits, radix)) {
                    (Ok(number), _) => visitor.visit_i64(number),
                    (_, Ok(number)) => visitor.visit_u64(number),
                    _ => Err(Misfit::custom("integer number overflowed")),
                }
            }
            DeValue::Float(number) => match number.as_str().parse::<f64>() {
                Ok(value) if value.is_finite() || number.as_str().contains("inf") || value.is_nan() => {
                    visitor.visit_f64(value)
                }
                _ => Err(Misfit::custom("floating-point number overflowed")),
            },
            DeValue::Datetime(_) | DeValue::Array(_) | DeValue::Table(_) => Err(self.is_not(&visitor)),
        }
        .map_err(|misfit| misfit.at(&span))
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match self.0.get_ref() {
            DeValue::String(text) => visitor.visit_str(text).map_err(|misfit: Misfit| misfit.at(&self.0.span())),
            _ => Err(self.is_not(&visitor)),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        let span = self.0.span();
        match self.0.into_inner() {
            DeValue::Table(table) => visitor.visit_map(entries(table)).map_err(|misfit| misfit.at(&span)),
            other => Err(Value(Spanned::new(span, other)).is_not(&visitor)),
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        let span = self.0.span();
        match self.0.into_inner() {
            DeValue::Array(array) => {
                let count = array.len();
                let mut items = Entries { rest: array.into_iter(), value: None };
                let value = visitor.visit_seq(&mut items).map_err(|misfit| misfit.at(&span))?;
                match items.rest.len() {
                    0 => Ok(value),
                    more => Err(Misfit::new(format_args!("{count} entries, expected {}", count - more), Some(span))),
                }
            }
            other => Err(Value(Spanned::new(span, other)).is_not(&visitor)),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, _length: usize, visitor: V) -> Result<V::Value, Misfit> {
        self.deserialize_seq(visitor)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _length: usize,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        self.deserialize_seq(visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        self.deserialize_map(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        let span = self.0.span();
        let choice = match self.0.into_inner() {
            DeValue::String(name) => Choice { name: Spanned::new(span.clone(), name), value: None },
            DeValue::Table(table) if table.len() == 1 => {
                let (name, value) = table.into_iter().next().ok_or_else(|| Misfit::custom("an empty table"))?;
                Choice { name, value: Some(value) }
            }
            DeValue::Table(table) => {
                let message = format!("wanted exactly 1 element, found {} elements", table.len());
                return Err(Misfit::new(message, Some(span)));
            }
            _ => return Err(Misfit::new("wanted string or table", Some(span))),
        };
        visitor.visit_enum(choice).map_err(|misfit| misfit.at(&span))
    }

    /// A key that is there is a value that is there.
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _name: &'static str, visitor: V) -> Result<V::Value, Misfit> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        visitor.visit_unit()
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        self.deserialize_str(visitor)
    }

    fn deserialize_char<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        self.deserialize_str(visitor)
    }

    fn deserialize_identifier<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        self.deserialize_str(visitor)
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        self.deserialize_f64(visitor)
    }

    serde::forward_to_deserialize_any! { i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 bytes byte_buf unit unit_struct }
}

#[cfg(test)]
#[path = "settings_tests.rs"]
mod tests;
