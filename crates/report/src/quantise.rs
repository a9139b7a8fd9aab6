//! Lists of numbers as text: little-endian bytes in base64 (RFC 4648).

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// Numbers as whole multiples of a step, 16 or 8 bits each.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantised {
    /// The least number.
    pub low: f64,
    /// Number = low + step · n; off by half a step at most.
    pub step: f64,
    /// The n of all numbers, base64.
    pub data: String,
}

impl Quantised {
    /// The numbers over their own range, or `None` if one of them is not finite.
    pub fn new(values: &[f64]) -> Option<Self> {
        Self::with_levels(values, u16::MAX, |level| level.to_le_bytes())
    }

    /// The same with 8 bits each: as many as there are colours.
    pub fn coarse(values: &[f64]) -> Option<Self> {
        Self::with_levels(values, u16::from(u8::MAX), |level| [level as u8])
    }

    fn with_levels<const N: usize>(values: &[f64], levels: u16, encode: impl Fn(u16) -> [u8; N]) -> Option<Self> {
        let levels = f64::from(levels);
        let low = values.iter().copied().fold(f64::INFINITY, f64::min).min(f64::MAX);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max).max(f64::MIN);
        let (low, high) = if values.is_empty() { (0.0, 0.0) } else { (low, high) };
        let step = (high - low) / levels;
        if !values.iter().all(|x| x.is_finite()) || !step.is_finite() {
            return None;
        }
        // Equal numbers need no steps at all.
        let level = |x: &f64| if step > 0.0 { ((x - low) / step).round().clamp(0.0, levels) as u16 } else { 0 };
        Some(Self { low, step, data: STANDARD.encode(bytes(values, |x| encode(level(x)))) })
    }
}

/// Whole numbers, 32 bits each.
pub fn integers(values: &[u32]) -> String {
    STANDARD.encode(bytes(values, |x| x.to_le_bytes()))
}

/// Small whole numbers, 16 bits each.
pub fn small_integers(values: &[u16]) -> String {
    STANDARD.encode(bytes(values, |x| x.to_le_bytes()))
}

/// Single-precision numbers.
pub fn floats(values: &[f64]) -> String {
    STANDARD.encode(bytes(values, |x| (*x as f32).to_le_bytes()))
}

fn bytes<T, const N: usize>(values: &[T], encode: impl Fn(&T) -> [u8; N]) -> Vec<u8> {
    values.iter().flat_map(encode).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(quantised: &Quantised) -> Vec<f64> {
        let bytes = STANDARD.decode(&quantised.data).unwrap();
        let level = |c: &[u8]| f64::from(u16::from_le_bytes([c[0], c[1]]));
        bytes.chunks(2).map(|c| quantised.low + quantised.step * level(c)).collect()
    }

    #[test]
    fn no_number_is_off_by_more_than_half_a_step() {
        let values: Vec<f64> = (0..5000).map(|i| 60.0 * (0.7 * f64::from(i)).sin() - 3.0).collect();
        let quantised = Quantised::new(&values).unwrap();
        // 60 mm either way: less than a thousandth of a millimetre.
        assert!(quantised.step / 2.0 < 1e-3);
        let worst = decoded(&quantised).iter().zip(&values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst <= quantised.step / 2.0 * (1.0 + 1e-9) && worst > 0.4 * quantised.step, "{worst}");
    }

    #[test]
    fn equal_numbers_are_exact_and_undefined_ones_are_refused() {
        assert_eq!(decoded(&Quantised::new(&[2.5; 3]).unwrap()), [2.5; 3]);
        assert!(decoded(&Quantised::new(&[]).unwrap()).is_empty());
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(Quantised::new(&[0.0, bad]), None);
        }
        assert_eq!(Quantised::new(&[f64::MAX, f64::MIN]), None);
    }
}
