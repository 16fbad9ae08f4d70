//! Recognises how a table was written: encoding, separator, decimal comma, and the place of its column names. Whatever
//! is ambiguous is refused with the dialects in question.

use std::io::{self, Chain, Cursor, Read};

use csv::{ReaderBuilder, StringRecord, Trim};

/// Beginning of a file in which the dialect is recognised, bytes.
const HEAD: u64 = 1 << 16;
/// Number of rows that are searched for decimal commas.
const ROWS: usize = 50;
/// Separators with their names. A comma comes first, because it is the default; a space comes last, because it also
/// follows other separators.
const SEPARATORS: [(u8, &str); 5] =
    [(b',', "commas"), (b';', "semicolons"), (b'\t', "tabs"), (b'|', "vertical bars"), (b' ', "spaces")];
const REMEDY: &str = "save the table with commas between columns and points in numbers";

/// Whether a line that begins with `#` is a comment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comments {
    Skipped,
    /// Part of the table, such as a participant `#1`.
    Kept,
}

#[derive(Clone, Debug, PartialEq)]
pub struct CsvDialect {
    separator: u8,
    has_decimal_comma: bool,
    comments: Comments,
    /// Lines removed at the beginning.
    removed: u64,
    /// Column names in a comment, as `numpy.savetxt` writes them; otherwise they are in the first row.
    header: Option<StringRecord>,
}

/// A table as UTF-8, from its beginning.
pub type TableText<R> = Chain<Cursor<Vec<u8>>, TextReader<R>>;

/// Recognises the dialect of a table; returns it with the whole text.
///
/// # Errors
/// The reason why the table cannot be read, with the dialect in question, or an error of the source.
pub fn recognise<R: Read>(input: R, comments: Comments) -> Result<(CsvDialect, TableText<R>), String> {
    let mut text = TextReader::new(input).map_err(|error| error.to_string())?;
    let mut head = Vec::new();
    let count = (&mut text).take(HEAD).read_to_end(&mut head).map_err(|error| error.to_string())?;
    let dialect = CsvDialect::of(&mut head, comments, count as u64 == HEAD)?;
    Ok((dialect, Cursor::new(head).chain(text)))
}

impl CsvDialect {
    /// Opens a reader of the rows; returns it with the column names.
    ///
    /// # Errors
    /// The reason why the column names cannot be read.
    pub fn reader<R: Read>(&self, text: R) -> Result<(csv::Reader<R>, StringRecord), String> {
        let mut builder = ReaderBuilder::new();
        let comment = (self.comments == Comments::Skipped).then_some(b'#');
        builder.trim(Trim::All).comment(comment).delimiter(self.separator).has_headers(self.header.is_none());
        let mut reader = builder.from_reader(text);
        let header = match &self.header {
            Some(header) => header.clone(),
            None => reader.headers().map_err(|error| error.to_string())?.clone(),
        };
        Ok((reader, header))
    }

    /// Returns the line number in the file of a line that the reader counts.
    pub const fn line(&self, counted: u64) -> u64 {
        counted + self.removed
    }

    /// Rewrites a row with decimal points, and with its line number in the file.
    pub fn normalise(&self, row: &mut StringRecord) {
        if !self.has_decimal_comma && self.removed == 0 {
            return;
        }
        let mut position = row.position().cloned();
        if let Some(position) = &mut position {
            position.set_line(self.line(position.line()));
        }
        if self.has_decimal_comma {
            *row = row.iter().map(|field| field.replace(',', ".")).collect();
        }
        row.set_position(position);
    }

    /// Parses a number as this dialect writes it.
    pub fn number(&self, field: &str) -> Option<f64> {
        if self.has_decimal_comma {
            return if field.contains('.') { None } else { field.replace(',', ".").parse().ok() };
        }
        field.parse().ok()
    }

    fn of(head: &mut Vec<u8>, comments: Comments, is_cut: bool) -> Result<Self, String> {
        let named = named_separator(head);
        let removed = u64::from(named.is_some());
        let plain =
            Self { separator: named.unwrap_or(b','), has_decimal_comma: false, comments, removed, header: None };
        let text = String::from_utf8_lossy(head).into_owned();
        let mut lines: Vec<&str> =
            text.split(['\n', '\r']).map(str::trim_end).filter(|line| !line.is_empty()).collect();
        if is_cut {
            lines.pop();
        }
        let is_comment = |line: &&str| comments == Comments::Skipped && line.starts_with('#');
        let Some(first) = lines.iter().position(|line| !is_comment(line)) else {
            return Ok(plain);
        };
        let comment = lines[..first].last().map(|line| line.trim_start_matches('#').trim());
        let rows: Vec<&str> = lines[first..].iter().filter(|line| !is_comment(line)).copied().take(ROWS).collect();
        if let Some(separator) = of_numbers(rows[0], named) {
            return Self { separator, ..plain }.below_comment(comment, &rows);
        }
        let separator = named.map_or_else(|| separator_of(rows[0], rows.get(1).copied()), Ok)?;
        Self { separator, ..plain }.with_rows(&rows[1..])
    }

    /// Recognises a table whose first row contains numbers.
    fn below_comment(self, comment: Option<&str>, rows: &[&str]) -> Result<Self, String> {
        let header = comment.map(|comment| fields(comment, self.separator));
        match header.filter(|header| header.len() == fields(rows[0], self.separator).len()) {
            Some(header) => Self { header: Some(header), ..self }.with_rows(rows),
            None => Err("its first row contains numbers: give the columns names in a row above them".to_owned()),
        }
    }

    fn with_rows(self, rows: &[&str]) -> Result<Self, String> {
        let mut has_comma = false;
        let mut has_point = false;
        for row in rows {
            for field in &fields(row, self.separator) {
                match written(field) {
                    Written::Comma => has_comma = true,
                    Written::Point => has_point = true,
                    Written::Thousands => {
                        return Err(format!(
                            "the number \"{field}\" has both points and commas (thousands separators): {REMEDY}"
                        ));
                    }
                    Written::Other => {}
                }
            }
        }
        if has_comma && has_point {
            return Err(format!("its numbers have decimal commas and decimal points: {REMEDY}"));
        }
        Ok(Self { has_decimal_comma: has_comma, ..self })
    }
}

/// How a field writes a number.
enum Written {
    Comma,
    Point,
    Thousands,
    /// A text, or a number without a fraction.
    Other,
}

fn written(field: &str) -> Written {
    match (field.contains(','), field.contains('.')) {
        (true, false) if is_number(field) => Written::Comma,
        (false, true) if field.parse::<f64>().is_ok() => Written::Point,
        (true, true) if has_thousands(field) => Written::Thousands,
        _ => Written::Other,
    }
}

/// Returns whether a field is a number such as `1.234,5` or `1,234.5`.
fn has_thousands(field: &str) -> bool {
    let parts: Vec<&str> = field.trim_start_matches(['+', '-']).split([',', '.']).collect();
    let marks: Vec<char> = field.chars().filter(|letter| matches!(letter, ',' | '.')).collect();
    let (Some((last, others)), [first, groups @ .., _]) = (marks.split_last(), &parts[..]) else { return false };
    let digits = |part: &&str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    parts.iter().all(digits)
        && (1..=3).contains(&first.len())
        && groups.iter().all(|group| group.len() == 3)
        && others.iter().all(|mark| mark != last)
}

fn is_number(field: &str) -> bool {
    field.replacen(',', ".", 1).parse::<f64>().is_ok()
}

/// Returns the separator of a row that contains only numbers.
fn of_numbers(row: &str, named: Option<u8>) -> Option<u8> {
    let candidates =
        SEPARATORS.iter().map(|(separator, _)| *separator).filter(|one| named.is_none_or(|named| named == *one));
    let numbers = |separator: u8| {
        let fields = fields(row, separator);
        fields.iter().all(is_number).then_some((fields.len(), separator))
    };
    // A semicolon before a comma: in `0,5;1,5` the commas are decimal.
    let mut found: Vec<_> = candidates.filter_map(numbers).collect();
    found.sort_by_key(|(count, separator)| (*count == 1, *separator == b',', *separator == b' '));
    found.first().map(|(_, separator)| *separator)
}

/// Removes a first line `sep=;`, which spreadsheets write.
fn named_separator(head: &mut Vec<u8>) -> Option<u8> {
    let end = head.iter().position(|byte| matches!(byte, b'\n' | b'\r'))?;
    let line = &head[..end];
    let separator = match line {
        [s, e, p, b'=', separator] if [s, e, p].map(u8::to_ascii_lowercase) == *b"sep" => *separator,
        [s, e, p, b'=', b'\\', b't'] if [s, e, p].map(u8::to_ascii_lowercase) == *b"sep" => b'\t',
        _ => return None,
    };
    let line_break = if head[end..].starts_with(b"\r\n") { 2 } else { 1 };
    head.drain(..end + line_break);
    Some(separator)
}

fn fields(line: &str, separator: u8) -> StringRecord {
    let mut builder = ReaderBuilder::new();
    let mut reader = builder.has_headers(false).trim(Trim::All).delimiter(separator).from_reader(line.as_bytes());
    let mut record = StringRecord::new();
    reader.read_record(&mut record).ok();
    record
}

/// Returns the only separator with which the column names and the first row have as many fields.
fn separator_of(header: &str, row: Option<&str>) -> Result<u8, String> {
    let count = |line: &str, separator: u8| fields(line, separator).len();
    let names = |separator: &u8| count(header, *separator) > 1;
    let Some(row) = row else {
        return Ok(SEPARATORS.iter().map(|(separator, _)| *separator).find(names).unwrap_or(b','));
    };
    let fits = |separator: u8| names(&separator) && count(header, separator) == count(row, separator);
    let found: Vec<_> = SEPARATORS.iter().filter(|(separator, _)| fits(*separator)).collect();
    match found[..] {
        [(one, _)] | [(one, _), (b' ', _)] => return Ok(*one),
        [(_, one), (_, other), ..] => {
            return Err(format!("its columns may be separated by {one} or by {other}: {REMEDY}"));
        }
        [] => {}
    }
    let columns = count(header, b',');
    if columns > 1 && count(row, b',') == 2 * columns {
        return Err(format!(
            "its rows have {} fields for {columns} columns, as with decimal commas between separating commas: {REMEDY}",
            2 * columns
        ));
    }
    let words = header.split_whitespace().count();
    let by_spaces = words > 1 && words == row.split_whitespace().count() && row.contains("  ");
    if by_spaces && columns == 1 {
        return Err(format!("its columns are separated by several spaces: {REMEDY}"));
    }
    // The reader reports the row whose number of fields differs.
    Ok(SEPARATORS[..4].iter().map(|(separator, _)| *separator).find(names).unwrap_or(b','))
}

/// A text in UTF-8 or UTF-16 as UTF-8, without its byte order mark.
#[derive(Debug)]
pub struct TextReader<R> {
    source: R,
    /// `Some` for UTF-16; whether the more significant byte is first.
    is_big_endian: Option<bool>,
    /// Bytes that were read in advance, and converted bytes.
    ready: Vec<u8>,
    passed: usize,
    /// The first half of a pair of UTF-16.
    high: Option<u16>,
}

impl<R: Read> TextReader<R> {
    fn new(mut source: R) -> io::Result<Self> {
        let mut first = Vec::new();
        (&mut source).take(4).read_to_end(&mut first)?;
        let (is_big_endian, mark) = match first[..] {
            [0xEF, 0xBB, 0xBF, ..] => (None, 3),
            [0xFF, 0xFE, ..] => (Some(false), 2),
            [0xFE, 0xFF, ..] => (Some(true), 2),
            // Without a byte order mark: the letters of a table have a zero byte in UTF-16.
            [1..=255, 0, 1..=255, 0] => (Some(false), 0),
            [0, 1..=255, 0, 1..=255] => (Some(true), 0),
            _ => (None, 0),
        };
        first.drain(..mark);
        let mut reader = Self { source, is_big_endian, ready: Vec::new(), passed: 0, high: None };
        reader.ready = if is_big_endian.is_some() { reader.converted(&first) } else { first };
        Ok(reader)
    }

    fn converted(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut text = String::new();
        for pair in bytes.as_chunks::<2>().0 {
            let unit =
                if self.is_big_endian == Some(true) { u16::from_be_bytes(*pair) } else { u16::from_le_bytes(*pair) };
            let units = self.high.take().into_iter().chain([unit]);
            for decoded in char::decode_utf16(units) {
                match decoded {
                    Ok(letter) => text.push(letter),
                    Err(error) if (0xD800..0xDC00).contains(&error.unpaired_surrogate()) => {
                        self.high = Some(error.unpaired_surrogate());
                    }
                    Err(_) => text.push(char::REPLACEMENT_CHARACTER),
                }
            }
        }
        text.into_bytes()
    }
}

impl<R: Read> Read for TextReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.passed == self.ready.len() {
            if self.is_big_endian.is_none() {
                return self.source.read(buffer);
            }
            let mut bytes = Vec::new();
            // An even number of bytes, unless the file ends within a character.
            if (&mut self.source).take(8192).read_to_end(&mut bytes)? == 0 {
                return Ok(0);
            }
            self.ready = self.converted(&bytes);
            self.passed = 0;
        }
        let rest = &self.ready[self.passed..];
        let count = rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&rest[..count]);
        self.passed += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the column names, and the numbers of all rows.
    fn read(bytes: &[u8]) -> Result<(Vec<String>, Vec<Vec<f64>>), String> {
        let (dialect, text) = recognise(bytes, Comments::Skipped)?;
        let (mut reader, header) = dialect.reader(text)?;
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| error.to_string())?;
            rows.push(record.iter().map(|field| dialect.number(field).expect(field)).collect());
        }
        Ok((header.iter().map(str::to_owned).collect(), rows))
    }

    fn utf16(text: &str, is_big_endian: bool, mark: bool) -> Vec<u8> {
        let mark = if mark { "\u{feff}" } else { "" };
        let units = mark.encode_utf16().chain(text.encode_utf16());
        units.flat_map(|unit| if is_big_endian { unit.to_be_bytes() } else { unit.to_le_bytes() }).collect()
    }

    #[test]
    fn one_table_in_many_dialects() {
        let expected = (vec!["t_s".to_owned(), "x_m".to_owned()], vec![vec![0.0, 0.5], vec![0.001, -1.25]]);
        let plain = "t_s,x_m\n0,0.5\n0.001,-1.25\n";
        let texts = [
            plain,
            "\u{feff}t_s,x_m\r\n0,0.5\r\n0.001,-1.25\r\n",
            "t_s;x_m\n0;0,5\n0,001;-1,25\n",
            "t_s;x_m\n0;0.5\n0.001;-1.25\n",
            "t_s\tx_m\n0\t0.5\n0.001\t-1.25\n",
            "t_s\tx_m\n0\t0,5\n0,001\t-1,25\n",
            "sep=;\r\nt_s;x_m\r\n0;0,5\r\n0,001;-1,25\r\n",
            "sep=\\t\nt_s\tx_m\n0\t0.5\n0.001\t-1.25\n",
            "t_s,x_m\n0,\"0,5\"\n\"0,001\",\"-1,25\"\n",
            "# t_s,x_m\n0,0.5\n0.001,-1.25\n",
            "# made by numpy\n# t_s x_m\n0 0.5\n0.001 -1.25\n",
            "# t_s;x_m\n0,0;0,5\n0,001;-1,25\n",
            "# a note\nt_s , x_m\n0, 0.5\n0.001, -1.25\n",
            "t_s x_m\n0 0.5\n0.001 -1.25\n",
        ];
        for text in texts {
            assert_eq!(read(text.as_bytes()).as_ref(), Ok(&expected), "{text}");
        }
        for (is_big_endian, mark) in [(false, true), (true, true), (false, false), (true, false)] {
            assert_eq!(read(&utf16(plain, is_big_endian, mark)).as_ref(), Ok(&expected));
        }
    }

    #[test]
    fn what_is_ambiguous_is_refused_with_the_dialect() {
        for (text, words) in [
            ("t,x;y\n1,2;3\n", "by commas or by semicolons"),
            ("t_s,x_m\n0,000,0,001\n", "4 fields for 2 columns, as with decimal commas"),
            ("t_s;x_m\n0,5;0.5\n", "decimal commas and decimal points"),
            ("t_s;x_m\n0;1.234,5\n", "thousands separators"),
            ("0,1\n2,3\n", "give the columns names"),
            ("t_s  x_m\n0    0.5\n", "several spaces"),
        ] {
            let refused = read(text.as_bytes()).unwrap_err();
            assert!(refused.contains(words), "{text}: {refused}");
        }
    }

    #[test]
    fn letters_of_two_units_survive_any_cut() {
        let text = "name,x\n".to_owned() + &"\u{1F600}ab,1\n".repeat(5000);
        let bytes = utf16(&text, false, true);
        let mut read = String::new();
        TextReader::new(&bytes[..]).unwrap().read_to_string(&mut read).unwrap();
        assert_eq!(read, text);
    }
}
