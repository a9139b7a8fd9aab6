//! Numbers of a `.msh` file one after the other, as text or binary.

use crate::report::quoted;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// A place in a file, behind which numbers are read.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Line, from 1; binary numbers are not counted.
    pub line: u32,
    pub encoding: Encoding,
}

impl<'a> Cursor<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, line: 1, encoding: Encoding::Text }
    }

    /// The rest of the line without blanks around it, or `None` at the end of the file.
    pub fn next_line(&mut self) -> Option<&'a str> {
        if self.at >= self.bytes.len() {
            return None;
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        self.line += 1;
        Some(std::str::from_utf8(&rest[..length]).unwrap_or("\u{fffd}").trim())
    }

    /// The next line that is not blank.
    pub fn next_full_line(&mut self) -> Option<&'a str> {
        loop {
            let line = self.next_line()?;
            if !line.is_empty() {
                return Some(line);
            }
        }
    }

    /// Goes behind the line that is `text`; whether there is one.
    pub fn skip_behind(&mut self, text: &str) -> bool {
        let wanted = text.as_bytes();
        let mut from = self.at;
        while let Some(found) = self.bytes[from..].windows(wanted.len()).position(|window| window == wanted) {
            let (begin, end) = (from + found, from + found + wanted.len());
            let begins =
                begin == 0 || matches!(self.bytes[begin - 1], b'\n' | b'\r') || self.encoding != Encoding::Text;
            if begins && self.bytes.get(end).is_none_or(|b| b.is_ascii_whitespace()) {
                self.line += self.bytes[self.at..end].iter().filter(|&&b| b == b'\n').count() as u32;
                self.at = end;
                self.next_line();
                return true;
            }
            from = begin + 1;
        }
        false
    }

    /// A whole number, four bytes in binary.
    pub fn int(&mut self) -> Result<i32, String> {
        if self.encoding == Encoding::Text {
            let word = self.word()?;
            return word.parse().map_err(|_| format!("{} is not a whole number", quoted(word)));
        }
        let bytes = self.take::<4>()?;
        Ok(if self.encoding == Encoding::BigEndian { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) })
    }

    /// A number of things or a tag, eight bytes in binary.
    pub fn size(&mut self) -> Result<u64, String> {
        if self.encoding == Encoding::Text {
            let word = self.word()?;
            return word.parse().map_err(|_| format!("{} is not a whole number of 0 or more", quoted(word)));
        }
        let bytes = self.take::<8>()?;
        Ok(if self.encoding == Encoding::BigEndian { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
    }

    /// A number of things in version 2.2, which is text always, at the end of a line.
    pub fn count(&mut self) -> Result<u64, String> {
        let encoding = std::mem::replace(&mut self.encoding, Encoding::Text);
        let count = self.size();
        if encoding != Encoding::Text {
            self.next_line();
        }
        self.encoding = encoding;
        count
    }

    /// A tag in version 2.2, four bytes in binary.
    pub fn tag(&mut self) -> Result<u64, String> {
        let tag = self.int()?;
        u64::try_from(tag).map_err(|_| format!("{tag} is not a whole number of 0 or more"))
    }

    /// A finite number, eight bytes in binary.
    pub fn double(&mut self) -> Result<f64, String> {
        let value = if self.encoding == Encoding::Text {
            return crate::syntax::real(self.word()?);
        } else {
            let bytes = self.take::<8>()?;
            if self.encoding == Encoding::BigEndian { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) }
        };
        if value.is_finite() { Ok(value) } else { Err(format!("{value} is not a finite number")) }
    }

    fn word(&mut self) -> Result<&'a str, String> {
        while let Some(&byte) = self.bytes.get(self.at)
            && byte.is_ascii_whitespace()
        {
            self.line += u32::from(byte == b'\n');
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        match std::str::from_utf8(&rest[..length]) {
            Ok("") => Err("the file ends here, too early".to_owned()),
            Ok(word) => Ok(word),
            Err(_) => Err("this is not a text".to_owned()),
        }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let bytes = self.bytes.get(self.at..self.at + N).and_then(|bytes| bytes.try_into().ok());
        let bytes = bytes.ok_or_else(|| "the file ends too early".to_owned())?;
        self.at += N;
        Ok(bytes)
    }
}
