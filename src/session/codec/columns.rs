//! Columns of words, packed so that a general compressor finds repetitions.
//!
//! All words of one field of all ticks of a block form a column. Each column is stored in the form that needs the
//! fewest bytes: one word for all, a reference to an equal column, or differences, whose bytes are sorted by their
//! position in the word (byte shuffle); positions that are zero everywhere are left out.

use std::collections::HashMap;

use super::{CodecError, WordSink, WordSource};

/// Maximum length of a column, in values of 64 bits: no block has more ticks.
const WORDS_MAX: u64 = 4096;

#[derive(Clone, Debug, Default)]
pub(crate) struct BlockColumns {
    columns: Vec<Vec<u64>>,
    at: usize,
}

impl BlockColumns {
    pub(crate) fn next_row(&mut self) {
        self.at = 0;
    }

    /// Removes all words but keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.columns.iter_mut().for_each(Vec::clear);
        self.at = 0;
    }

    pub(crate) fn pack(&self, to: &mut Vec<u8>) {
        number(to, self.columns.len() as u64);
        let mut known: HashMap<&[u64], usize> = HashMap::new();
        for (i, column) in self.columns.iter().enumerate() {
            pack_one(column, known.get(column.as_slice()).copied(), to);
            known.entry(column).or_insert(i);
        }
    }
}

impl WordSink for BlockColumns {
    fn word(&mut self, word: u64) {
        if self.columns.len() <= self.at {
            self.columns.resize(self.at + 1, Vec::new());
        }
        self.columns[self.at].push(word);
        self.at += 1;
    }

    fn skip(&mut self, columns: usize) {
        self.at += columns;
    }
}

// Kinds of columns in a file: never renumber one.
const EMPTY: u8 = 0;
const CONSTANT: u8 = 1;
const AS: u8 = 2;
/// Three kinds of differences: XOR suits values with the same exponent, steps suit counters, and steps of steps suit
/// times.
const XOR: u8 = 3;
const STEP: u8 = 4;
const STEP_OF_STEP: u8 = 5;

fn pack_one(column: &[u64], same: Option<usize>, to: &mut Vec<u8>) {
    let Some(first) = column.first() else { return to.push(EMPTY) };
    if column.iter().all(|word| word == first) {
        to.push(CONSTANT);
        number(to, column.len() as u64);
        return to.extend_from_slice(&first.to_le_bytes());
    }
    if let Some(same) = same {
        to.push(AS);
        return number(to, same as u64);
    }
    let used = |way: u8| differences(column, way).iter().map(|word| 8 - word.leading_zeros() / 8).sum::<u32>();
    let way = [XOR, STEP, STEP_OF_STEP].into_iter().min_by_key(|way| used(*way)).unwrap_or(XOR);
    let words = differences(column, way);
    to.push(way);
    number(to, words.len() as u64);
    let all = words.iter().fold(0, |all, word| all | word);
    let places = all.to_le_bytes();
    to.push(places.iter().enumerate().fold(0, |mask, (place, byte)| mask | u8::from(*byte != 0) << place));
    for place in (0..8).filter(|place| places[*place] != 0) {
        to.extend(words.iter().map(|word| word.to_le_bytes()[place]));
    }
}

fn differences(column: &[u64], way: u8) -> Vec<u64> {
    let mut before = 0_u64;
    let mut step = 0_u64;
    let mut one = |word: u64| {
        let now = word.wrapping_sub(before);
        let difference = match way {
            XOR => word ^ before,
            STEP => folded(now),
            _ => folded(now.wrapping_sub(step)),
        };
        before = word;
        step = now;
        difference
    };
    column.iter().map(|word| one(*word)).collect()
}

fn undone(mut words: Vec<u64>, way: u8) -> Vec<u64> {
    let mut before = 0_u64;
    let mut step = 0_u64;
    for word in &mut words {
        let value = match way {
            XOR => *word ^ before,
            STEP => before.wrapping_add(unfolded(*word)),
            _ => before.wrapping_add(step.wrapping_add(unfolded(*word))),
        };
        step = value.wrapping_sub(before);
        before = value;
        *word = value;
    }
    words
}

/// Maps small negative steps to small numbers too.
const fn folded(step: u64) -> u64 {
    step << 1 ^ 0_u64.wrapping_sub(step >> 63)
}

const fn unfolded(word: u64) -> u64 {
    word >> 1 ^ 0_u64.wrapping_sub(word & 1)
}

#[derive(Clone, Debug)]
pub(crate) struct UnpackedColumns(Vec<Vec<u64>>);

impl UnpackedColumns {
    /// Parses the bytes of [`BlockColumns::pack`], of at most this many columns.
    pub(crate) fn of(from: &mut &[u8], max: usize) -> Result<Self, CodecError> {
        let count = take_number(from)?;
        // Checked before memory is allocated, because the count may be damaged.
        if count > max as u64 {
            return Err(CodecError::Long);
        }
        let mut columns: Vec<Vec<u64>> = Vec::new();
        for _ in 0..count {
            let column = unpack_one(from, &columns)?;
            columns.push(column);
        }
        Ok(Self(columns))
    }

    pub(crate) fn rows(&self) -> ColumnsSource<'_> {
        ColumnsSource { columns: &self.0, read: vec![0; self.0.len()], at: 0 }
    }
}

fn unpack_one(from: &mut &[u8], before: &[Vec<u64>]) -> Result<Vec<u64>, CodecError> {
    let way = *bytes(from, 1)?.first().ok_or(CodecError::Short)?;
    let length = |from: &mut &[u8]| take_number(from).and_then(|length| fits(length).ok_or(CodecError::NoSuchValue));
    match way {
        EMPTY => Ok(Vec::new()),
        CONSTANT => {
            let length = length(from)?;
            let word = bytes(from, 8)?.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte));
            Ok(vec![word; length])
        }
        AS => {
            let same = usize::try_from(take_number(from)?).map_err(|_| CodecError::NoSuchValue)?;
            before.get(same).cloned().ok_or(CodecError::NoSuchValue)
        }
        XOR | STEP | STEP_OF_STEP => {
            let length = length(from)?;
            let mask = *bytes(from, 1)?.first().ok_or(CodecError::Short)?;
            let mut words = vec![0_u64; length];
            for place in (0..8).filter(|place| mask >> place & 1 == 1) {
                let plane = bytes(from, length)?;
                words.iter_mut().zip(plane).for_each(|(word, byte)| *word |= u64::from(*byte) << (8 * place));
            }
            Ok(undone(words, way))
        }
        _ => Err(CodecError::NoSuchValue),
    }
}

fn fits(length: u64) -> Option<usize> {
    usize::try_from(length).ok().filter(|_| length <= WORDS_MAX)
}

/// A row-by-row reader of columns.
#[derive(Debug)]
pub(crate) struct ColumnsSource<'a> {
    columns: &'a [Vec<u64>],
    read: Vec<usize>,
    at: usize,
}

impl ColumnsSource<'_> {
    pub(crate) fn next_row(&mut self) {
        self.at = 0;
    }

    /// Checks that every word was read.
    pub(crate) fn end(&self) -> Result<(), CodecError> {
        let all = self.columns.iter().zip(&self.read).all(|(column, read)| column.len() == *read);
        if all { Ok(()) } else { Err(CodecError::Long) }
    }
}

impl WordSource for ColumnsSource<'_> {
    fn word(&mut self) -> Result<u64, CodecError> {
        let column = self.columns.get(self.at).ok_or(CodecError::Short)?;
        let read = self.read.get_mut(self.at).ok_or(CodecError::Short)?;
        let word = *column.get(*read).ok_or(CodecError::Short)?;
        *read += 1;
        self.at += 1;
        Ok(word)
    }

    fn skip(&mut self, columns: usize) {
        self.at = self.at.saturating_add(columns);
    }
}

/// Appends a number in as few bytes as it needs, seven bits in each.
pub(crate) fn number(to: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        to.push(number as u8 | 0x80);
        number >>= 7;
    }
    to.push(number as u8);
}

/// Reads a number written by [`number`].
pub(crate) fn take_number(from: &mut &[u8]) -> Result<u64, CodecError> {
    let mut number = 0_u64;
    // Ten bytes of seven bits contain all 64 bits.
    for shift in (0..64).step_by(7) {
        let byte = *bytes(from, 1)?.first().ok_or(CodecError::Short)?;
        number |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Ok(number);
        }
    }
    Err(CodecError::NoSuchValue)
}

pub(crate) fn bytes<'a>(from: &mut &'a [u8], count: usize) -> Result<&'a [u8], CodecError> {
    let (taken, rest) = from.split_at_checked(count).ok_or(CodecError::Short)?;
    *from = rest;
    Ok(taken)
}
