//! Colours of a field.

use pneuflex_plot::drawing::Colour;
use pneuflex_plot::picture::viridis;

/// A field that gives the surface its colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Paint {
    /// What it is, with the unit, e.g. `von Mises stress (MPa)`.
    pub label: String,
    /// Values at the ends of the colours.
    pub range: [f64; 2],
}

impl Paint {
    /// The colour of a value, sRGB.
    pub fn colour(&self, value: f64) -> Colour {
        let [low, high] = self.range;
        viridis(if high > low { (value - low) / (high - low) } else { 0.0 })
    }

    /// The same as shares of red, green and blue light.
    pub fn light(&self, value: f64) -> [f32; 3] {
        let Colour(rgb) = self.colour(value);
        rgb.map(|c| {
            let c = f32::from(c) / 255.0;
            if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        })
    }
}
