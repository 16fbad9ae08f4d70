//! Ticks of a journal, in columns.

use nalgebra::Vector3;
use nima_machine::{
    messages::Event,
    rig::{Inputs, PlannedTip, SIDES},
    runtime::{Operation, TickRecord},
    teleop::Timing,
};

use crate::{
    codec::{
        BlockColumns, CodecError, FromWords, ToWords, UnpackedColumns, WordSink, WordSource, choice, number, record,
        take_number,
    },
    digest::DigestCheck,
};

/// Ticks of a full block: 0.2 s at 1 kHz. Short, because a crash loses the block that has not been written yet.
pub const BLOCK_TICKS: usize = 200;
/// Maximum number of ticks, and of operations, of a block that is read. Twenty times a full block: the counts come from
/// the file, and a damaged one must not reserve gigabytes.
const MAX: u64 = 4096;

/// An entry before a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TickNote {
    /// An operation on the loop.
    Operation(Operation),
    /// Entries were dropped here, so everything after this cannot be replayed.
    Hole {
        /// Number of dropped entries.
        lost: u64,
    },
}

choice!(TickNote {
    0 => Operation { 0: operation: Operation },
    1 => Hole { lost: lost: u64 },
});

/// One tick: the inputs of the loop, and the digest of its outputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickRow {
    /// The times that were passed in.
    pub timing: Timing,
    pub inputs: [Option<Inputs>; SIDES],
    pub check: DigestCheck,
}

// The columns of every version; `Plans` follow.
record!(TickRow { timing: Timing, inputs: [Option<Inputs>; SIDES], check: DigestCheck });

/// Commanded tip positions of both sides ([`PlannedTip`]), m, from version 6 on.
type Plans = [Option<Vector3<f64>>; SIDES];

#[derive(Clone, Debug, PartialEq)]
pub struct JournalBlock {
    /// Number of the block's first tick among all ticks in the journal.
    pub first_tick: u64,
    /// The entries before each row, in order; an index beyond the last row means after it.
    pub noted: Vec<(usize, TickNote)>,
    pub rows: Vec<TickRow>,
}

impl JournalBlock {
    pub(super) fn take(from: &mut &[u8], with_plans: bool) -> Result<Self, CodecError> {
        let (first_tick, rows, noted) = take_head(from)?;
        let columns = UnpackedColumns::of(from, TickRow::COLUMNS + if with_plans { Plans::COLUMNS } else { 0 })?;
        let mut source = columns.rows();
        let mut row = || {
            source.next_row();
            let mut row = TickRow::take(&mut source)?;
            let plans = if with_plans { Plans::take(&mut source)? } else { Plans::default() };
            for (inputs, planned_m) in row.inputs.iter_mut().zip(plans) {
                if let Some(inputs) = inputs {
                    inputs.planned = PlannedTip(planned_m);
                }
            }
            Ok(row)
        };
        let rows = (0..rows).map(|_| row()).collect::<Result<_, _>>()?;
        source.end()?;
        Ok(Self { first_tick, noted, rows })
    }
}

/// Entries, each with the index of the row that it precedes.
type EarlierEvents = Vec<(usize, TickNote)>;

/// Reads the number of the first tick, the number of rows, and the entries between them.
fn take_head(from: &mut &[u8]) -> Result<(u64, u64, EarlierEvents), CodecError> {
    let first_tick = take_number(from)?;
    let rows = take_number(from)?;
    let noted = take_number(from)?;
    if rows.max(noted) > MAX {
        return Err(CodecError::Long);
    }
    let noted = (0..noted).map(|_| take_noted(from)).collect::<Result<_, _>>()?;
    Ok((first_tick, rows, noted))
}

/// Returns the number of dropped entries for each gap in the block with this body.
pub(super) fn holes(mut body: &[u8]) -> Result<Vec<u64>, CodecError> {
    let (.., noted) = take_head(&mut body)?;
    let lost = |(_, noted): (usize, TickNote)| if let TickNote::Hole { lost } = noted { Some(lost) } else { None };
    Ok(noted.into_iter().filter_map(lost).collect())
}

fn take_noted(from: &mut &[u8]) -> Result<(usize, TickNote), CodecError> {
    let before = usize::try_from(take_number(from)?).map_err(|_| CodecError::NoSuchValue)?;
    let count = take_number(from)?;
    if count > TickNote::COLUMNS as u64 {
        return Err(CodecError::Long);
    }
    let words = (0..count).map(|_| take_number(from)).collect::<Result<Vec<_>, _>>()?;
    let mut words = words.into_iter();
    let noted = TickNote::take(&mut words)?;
    if words.len() == 0 { Ok((before, noted)) } else { Err(CodecError::Long) }
}

#[derive(Clone, Debug, Default)]
pub struct BlockWriter {
    first_tick: u64,
    noted: Vec<(usize, TickNote)>,
    columns: BlockColumns,
    rows: usize,
}

impl BlockWriter {
    /// Adds an entry before the next tick.
    pub fn note(&mut self, noted: TickNote) {
        self.noted.push((self.rows, noted));
    }

    pub fn tick(&mut self, row: &TickRow) {
        self.columns.next_row();
        row.put(&mut self.columns);
        row.inputs.each_ref().map(|inputs| inputs.as_ref()?.planned.0).put(&mut self.columns);
        self.rows += 1;
    }

    /// Makes the row of a tick, in which these events were reported.
    pub fn row<'a>(stepped: &TickRecord, events: impl Iterator<Item = &'a Event>) -> TickRow {
        let check = DigestCheck::of(events, &stepped.outputs, &stepped.ticks);
        TickRow { timing: stepped.timing, inputs: stepped.inputs, check }
    }

    /// Returns whether the block must be written.
    pub const fn is_full(&self) -> bool {
        // Entries count too, so that many operations in a row cannot exceed the maximum of a block that is read.
        self.rows >= BLOCK_TICKS || self.noted.len() >= BLOCK_TICKS
    }

    pub const fn is_empty(&self) -> bool {
        self.rows == 0 && self.noted.is_empty()
    }

    /// Returns its bytes and empties it.
    pub(super) fn take(&mut self) -> Vec<u8> {
        let mut bytes = Vec::new();
        number(&mut bytes, self.first_tick);
        number(&mut bytes, self.rows as u64);
        number(&mut bytes, self.noted.len() as u64);
        for (before, noted) in self.noted.drain(..) {
            let mut words = Vec::new();
            noted.put(&mut words);
            number(&mut bytes, before as u64);
            number(&mut bytes, words.len() as u64);
            for word in words {
                number(&mut bytes, word);
            }
        }
        self.columns.pack(&mut bytes);
        self.columns.clear();
        self.first_tick += self.rows as u64;
        self.rows = 0;
        bytes
    }
}
