//! Numbers as Fortran writes them.

use crate::report::quoted;

/// Sizes of numbers: beyond them squares and products are infinite or lost. No quantity is of such a size in any unit.
const LEAST: f64 = 1e-100;
const MOST: f64 = 1e100;

/// A real number that is 0 or of a size that can be computed with: `1`, `1.`, `.5`, `1e-3`, `1.D0`, and Fortran's `1.5-3` for 1.5 · 10⁻³.
///
/// # Errors
/// Anything else, as a message.
pub fn real(text: &str) -> Result<f64, String> {
    let wrong = || format!("{} is not a number", quoted(text));
    let text = text.trim();
    // Rust would take "inf", "nan" and "infinity", too.
    if text.is_empty()
        || !text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E' | b'd' | b'D'))
    {
        return Err(wrong());
    }
    let value: f64 = match text.parse() {
        Ok(value) => value,
        Err(_) => {
            let written = text.replace(['d', 'D'], "e");
            let sign = written.char_indices().skip(1).find(|(_, c)| matches!(c, '+' | '-')).map(|(at, _)| at);
            match (written.contains(['e', 'E']), sign) {
                (false, Some(at)) => format!("{}e{}", &written[..at], &written[at..]).parse(),
                _ => written.parse(),
            }
            .map_err(|_| wrong())?
        }
    };
    match value.abs() {
        size if size > MOST => Err(format!("{} is too large a number", quoted(text))),
        size if size != 0.0 && size < LEAST => Err(format!("{} is too small a number, and not 0", quoted(text))),
        _ => Ok(value),
    }
}

/// A whole number that fits 32 bits.
///
/// # Errors
/// Anything else, as a message.
pub fn integer(text: &str) -> Result<i32, String> {
    let text = text.trim();
    text.parse().map_err(|_| format!("{} is not a whole number of at most nine digits", quoted(text)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_fortran_writes_them() {
        let cases = [
            ("1", 1.0),
            (" -1. ", -1.0),
            (".5", 0.5),
            ("+2.5e-3", 2.5e-3),
            ("1.D0", 1.0),
            ("1.5d+02", 150.0),
            ("1.5-3", 1.5e-3),
            ("-1.5+3", -1500.0),
        ];
        for (text, expected) in cases {
            assert_eq!(real(text), Ok(expected), "{text}");
        }
        for text in [
            "", "x", "1e", "inf", "nan", "0x1", "1..2", "--1", "-", ".", "1,5", "1e999", "1e308", "-1e300", "5e-324",
            "1-2-3", "+", "1d",
        ] {
            assert!(real(text).is_err(), "{text}");
        }
        assert_eq!(integer(" 12"), Ok(12));
        for text in ["", "1.", "3000000000", "x"] {
            assert!(integer(text).is_err(), "{text}");
        }
    }
}
