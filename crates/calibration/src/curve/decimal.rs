//! Numbers with a decimal point or a decimal comma.

/// The decimal sign of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DecimalSign {
    /// 1.5
    #[default]
    Point,
    /// 1,5
    Comma,
}

/// The finite number in a cell.
pub fn number(cell: &str, sign: DecimalSign) -> Option<f64> {
    let cell = cell.trim();
    // Rust would also read "inf", "nan" and "infinity".
    if !cell.contains(|c: char| c.is_ascii_digit()) || cell.len() > 64 {
        return None;
    }
    let mut text = String::with_capacity(cell.len());
    for c in cell.chars() {
        text.push(match (c, sign) {
            ('0'..='9' | '+' | '-' | 'e' | 'E', _) => c,
            ('−', _) => '-',
            ('.', DecimalSign::Point) | (',', DecimalSign::Comma) => '.',
            _ => return None,
        });
    }
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// Whether a cell is a number with one decimal sign or the other.
pub fn is_number(cell: &str) -> bool {
    number(cell, DecimalSign::Point).is_some() || number(cell, DecimalSign::Comma).is_some()
}

/// What the cells of a table say about its decimal sign.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Evidence {
    /// Line of the first number with a point.
    pub point: Option<usize>,
    /// Line of the first number with a comma.
    pub comma: Option<usize>,
    /// Whether a number with a comma cannot be grouped in thousands.
    pub comma_is_decimal: bool,
}

impl Evidence {
    /// Adds a cell.
    pub fn add(&mut self, cell: &str, line: usize) {
        let cell = cell.trim();
        if cell.contains('.') && number(cell, DecimalSign::Point).is_some() {
            self.point.get_or_insert(line);
        }
        if cell.contains(',') && number(cell, DecimalSign::Comma).is_some() {
            self.comma.get_or_insert(line);
            let (whole, part) = cell.split_once(',').unwrap_or((cell, ""));
            let whole = whole.trim_start_matches(['+', '-', '−']);
            let grouped = part.len() == 3 && !whole.starts_with('0') && (1..=3).contains(&whole.len());
            self.comma_is_decimal |= !grouped;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_finite_numbers_are_numbers() {
        use DecimalSign::{Comma, Point};
        assert_eq!(number(" −1.5e-3 ", Point), Some(-1.5e-3));
        assert_eq!(number("1,25", Comma), Some(1.25));
        for cell in ["", "nan", "inf", "1e999", "1,5", "1.2.3", "0x10", "e5", "12 MPa"] {
            assert_eq!(number(cell, Point), None, "{cell}");
        }
    }

    #[test]
    fn thousands_are_no_evidence_for_a_decimal_comma() {
        let of = |cells: &[&str]| {
            let mut evidence = Evidence::default();
            cells.iter().for_each(|c| evidence.add(c, 1));
            evidence.comma_is_decimal
        };
        assert!(!of(&["1,234", "12,000"]));
        assert!(of(&["1,234", "0,125"]) && of(&["1,5"]) && of(&["1234,567"]));
    }
}
