//! Numbers for people.

/// A whole number with commas between thousands.
pub fn thousands(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A number as short as it can be, with seven digits at the most.
pub fn number(x: f64) -> String {
    minus(format!("{x:.6e}").parse::<f64>().unwrap_or(x).to_string())
}

/// A difference, to three digits.
pub fn difference(x: f64) -> String {
    number(format!("{x:.2e}").parse().unwrap_or(x))
}

/// A number with so many decimals.
pub fn fixed(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$}");
    // No "−0.000".
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') { text.replace('-', "") } else { minus(text) }
}

fn minus(text: String) -> String {
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!(
            (thousands(7), thousands(41_901), thousands(1_234_567)),
            ("7".into(), "41,901".into(), "1,234,567".into())
        );
        assert_eq!((number(0.603932828436), number(1234567.0)), ("0.6039328".into(), "1234567".into()));
        assert_eq!((difference(-0.0099819), difference(12345.0)), ("−0.00998".into(), "12300".into()));
        assert_eq!((fixed(-0.0001, 3), fixed(-1.5, 2), number(-5.0)), ("0.000".into(), "−1.50".into(), "−5".into()));
    }
}
