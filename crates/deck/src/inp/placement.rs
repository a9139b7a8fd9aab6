//! Where an instance puts its part: a translation, then a rotation about an axis.

use super::context::Context;
use crate::syntax::Block;

/// x ↦ a + R (x + t − a): translation t, then rotation R about an axis through the point a.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    translation: [f64; 3],
    rotation: [[f64; 3]; 3],
    point: [f64; 3],
}

impl Default for Placement {
    fn default() -> Self {
        let rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self { translation: [0.0; 3], rotation, point: [0.0; 3] }
    }
}

impl Placement {
    /// Reads the data lines of an `*INSTANCE`: the translation; two points of the axis and the angle in degrees.
    pub fn read(block: &Block, context: &mut Context<'_>) -> Self {
        let mut placement = Self::default();
        for (number, line) in block.lines.iter().enumerate() {
            let fields = context.fields(line);
            let mut values = [0.0; 7];
            let wanted = [3, 7].get(number).copied().unwrap_or(0);
            if fields.len() > wanted {
                context.error(
                    line.place,
                    "*INSTANCE takes a line with three translations and one with two points and an angle",
                );
                return placement;
            }
            for (value, field) in values.iter_mut().zip(&fields) {
                *value = context.real_or_zero(line.place, Some(field)).unwrap_or(0.0);
            }
            let [a0, a1, a2, b0, b1, b2, angle] = values;
            if number == 0 {
                placement.translation = [a0, a1, a2];
                continue;
            }
            let axis = [b0 - a0, b1 - a1, b2 - a2];
            let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
            if !(length.is_finite() && length > 0.0) {
                context.error(line.place, "the axis of a rotation needs two different points");
                return placement;
            }
            placement.point = [a0, a1, a2];
            placement.rotation = rodrigues(axis.map(|x| x / length), angle.to_radians());
        }
        placement
    }

    /// Where a point of the part comes to lie.
    pub fn place(&self, x: [f64; 3]) -> [f64; 3] {
        let from_point: [f64; 3] = std::array::from_fn(|i| x[i] + self.translation[i] - self.point[i]);
        std::array::from_fn(|i| self.point[i] + (0..3).map(|j| self.rotation[i][j] * from_point[j]).sum::<f64>())
    }
}

/// Rotation about a unit axis by an angle in radians: R = cos φ 1 + sin φ \[n\]× + (1 − cos φ) n nᵀ.
fn rodrigues(n: [f64; 3], angle: f64) -> [[f64; 3]; 3] {
    let (sin, cos) = angle.sin_cos();
    let cross = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| f64::from(u8::from(i == j)) * cos + sin * cross[i][j] + (1.0 - cos) * n[i] * n[j])
    })
}
