//! Numbers in words.

/// Bytes in words.
pub fn size(bytes: f64) -> String {
    const MIB: f64 = 1024.0 * 1024.0;
    if bytes < 1024.0 * MIB {
        format!("{:.0} MiB", (bytes / MIB).max(1.0))
    } else if bytes < 1e6 * 1024.0 * MIB {
        let gibibytes = bytes / (1024.0 * MIB);
        if gibibytes < 1000.0 { format!("{gibibytes:.1} GiB") } else { format!("{} GiB", count(gibibytes)) }
    } else {
        "more than 1,000,000 GiB".into()
    }
}

/// A number as people write it: without the digits that sums and a change of units leave behind.
pub fn plain(x: f64) -> String {
    format!("{x:.9e}").parse().unwrap_or(x).to_string()
}

/// A number to so many digits.
pub fn rounded(x: f64, digits: i32) -> f64 {
    let places = (digits - 1).max(0) as usize;
    format!("{x:.places$e}").parse().unwrap_or(x)
}

/// A length, an area or a volume as it was measured, to five digits.
pub fn measured(x: f64) -> String {
    plain(rounded(x, 5))
}

/// A point as it was measured: its coordinates to five digits of the largest one.
pub fn place(x: [f64; 3]) -> String {
    let largest = x.iter().fold(0.0, |most: f64, t| most.max(t.abs()));
    let unit = if largest > 0.0 { 10f64.powf(4.0 - largest.log10().floor()) } else { 1.0 };
    // Zero has no sign.
    let [x, y, z] = x.map(|t| plain((t * unit).round() / unit + 0.0));
    format!("({x}, {y}, {z})")
}

/// Numbers as people write them, in brackets.
pub fn plain_list(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|x| plain(*x)).collect::<Vec<_>>().join(", "))
}

/// A large count in words.
pub fn count(value: f64) -> String {
    if value < 1e12 { thousands(value.round() as u64) } else { format!("{value:.1e}") }
}

/// A number with separators between its thousands.
pub fn thousands(value: u64) -> String {
    let digits = value.to_string();
    let groups: Vec<&str> = {
        let first = (digits.len() + 2) % 3 + 1;
        let mut groups = vec![&digits[..first]];
        groups.extend((first..digits.len()).step_by(3).map(|i| &digits[i..i + 3]));
        groups
    };
    groups.join(",")
}

/// A number of things in words.
pub fn plural(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        assert_eq!(
            ["7", "26,310", "1,268", "123,456,789"],
            [7, 26_310, 1268, 123_456_789].map(thousands).each_ref().map(String::as_str)
        );
        assert_eq!(
            [plain(45.800_000_000_000_004), plain(-0.1 - 0.2), plain(4.0), plain(1.0 / 3.0)],
            ["45.8", "-0.3", "4", "0.3333333333"]
        );
        assert_eq!(plain_list(&[0.1 + 0.2, 0.0]), "[0.3, 0]");
        assert_eq!((size(5e8), size(5e9)), ("477 MiB".into(), "4.7 GiB".into()));
        assert_eq!(size(f64::INFINITY), "more than 1,000,000 GiB");
    }
}
