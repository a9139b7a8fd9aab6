//! Colours of a scalar.

use crate::drawing::Colour;

/// The map "viridis" (S. van der Walt and N. Smith, CC0) at 33 equal steps. It is perceptually uniform and can be read
/// in print and by readers with any colour vision; linear in between it is off by less than 2 of 255.
const VIRIDIS: [[u8; 3]; 33] = [
    [68, 1, 84],
    [71, 13, 96],
    [72, 24, 106],
    [72, 35, 116],
    [71, 45, 123],
    [69, 54, 129],
    [66, 64, 134],
    [63, 73, 137],
    [59, 82, 139],
    [55, 90, 141],
    [51, 99, 141],
    [47, 106, 142],
    [44, 114, 142],
    [41, 122, 142],
    [38, 129, 142],
    [35, 137, 142],
    [33, 144, 140],
    [31, 152, 139],
    [31, 159, 136],
    [33, 166, 133],
    [40, 174, 128],
    [49, 181, 123],
    [62, 188, 116],
    [76, 194, 108],
    [93, 201, 99],
    [110, 206, 88],
    [130, 211, 76],
    [150, 216, 63],
    [171, 220, 50],
    [192, 223, 36],
    [213, 226, 26],
    [234, 229, 26],
    [253, 231, 37],
];

/// Colour at a share of the range; below 0 and above 1 the ends.
pub fn viridis(share: f64) -> Colour {
    let last = VIRIDIS.len() - 1;
    let place = share.clamp(0.0, 1.0) * last as f64;
    let step = (place as usize).min(last - 1);
    Colour(VIRIDIS[step]).towards(Colour(VIRIDIS[step + 1]), place - step as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_grows_evenly() {
        // CIE L* of sRGB.
        let lightness = |Colour(rgb): Colour| {
            let [r, g, b] = rgb.map(|c| {
                let c = f64::from(c) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            });
            116.0 * (0.2126 * r + 0.7152 * g + 0.0722 * b).cbrt() - 16.0
        };
        let all: Vec<f64> = (0..=32).map(|i| lightness(viridis(f64::from(i) / 32.0))).collect();
        let mean = (all[32] - all[0]) / 32.0;
        for pair in all.windows(2) {
            assert!((pair[1] - pair[0] - mean).abs() < 0.6 * mean, "{pair:?}");
        }
        assert_eq!((viridis(-1.0), viridis(2.0)), (Colour(VIRIDIS[0]), Colour(VIRIDIS[32])));
    }
    /// The report draws in a browser, from a table of its own.
    #[test]
    fn the_report_has_the_same_colours() {
        let script = include_str!("../../../report/assets/js/colours.js");
        let words =
            script.split("size: `").nth(1).unwrap().split_whitespace().map(|word| word.trim_end_matches(['`', ',']));
        let found: Vec<&str> = words.take(VIRIDIS.len()).collect();
        assert_eq!(found, VIRIDIS.map(|[r, g, b]| format!("{r:02x}{g:02x}{b:02x}")));
    }
}
