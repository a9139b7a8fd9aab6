//! Numbers as people write them.

/// To twelve digits: the paper's constants give the paper's numbers, not their neighbours.
pub(crate) fn rounded(value: f64) -> f64 {
    if !value.is_finite() || value == 0.0 {
        return value;
    }
    let unit = 10f64.powf(11.0 - value.abs().log10().floor());
    let rounded = (value * unit).round() / unit;
    if rounded.is_finite() { rounded } else { value }
}
