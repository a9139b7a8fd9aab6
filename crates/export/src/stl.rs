//! Surfaces as binary STL: triangles with their normals, mm.

use pneuflex_mesh::vector::{Vec3, cross, norm, sub};

use crate::error::ExportError;

const HEADER: usize = 80;

/// The bytes of a file.
///
/// # Errors
/// [`ExportError::TooLarge`] for more than 2³² triangles.
pub fn write(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Vec<u8>, ExportError> {
    let count = u32::try_from(triangles.len()).map_err(|_| ExportError::TooLarge { what: "triangles" })?;
    let mut bytes = Vec::with_capacity(HEADER + 4 + 50 * triangles.len());
    bytes.extend(format!("{:<HEADER$}", "binary STL, mm, by pneuflex").as_bytes());
    bytes.extend(count.to_le_bytes());
    for triangle in triangles {
        let corners = triangle.map(|corner| positions[corner as usize]);
        let area = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
        let length = norm(area);
        let normal = if length > 0.0 { area.map(|x| x / length) } else { area };
        let numbers = std::iter::once(normal).chain(corners).flatten();
        numbers.for_each(|x| bytes.extend((x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Surface, volume};
    use crate::testing::two_chambers;
    use pneuflex_model::Formulation;

    #[test]
    fn what_is_read_back_is_the_body() {
        let surface = Surface::new(&two_chambers(Formulation::Hex27));
        let bytes = write(&surface.positions(None), &surface.triangles).unwrap();
        assert_eq!(bytes.len(), 84 + 50 * surface.triangles.len());
        assert_eq!(bytes[80..84], (surface.triangles.len() as u32).to_le_bytes());
        let mut corners = Vec::new();
        for triangle in bytes[84..].chunks(50) {
            let number = |i: usize| f64::from(f32::from_le_bytes(triangle[4 * i..4 * i + 4].try_into().unwrap()));
            let at: Vec<Vec3> = (0..4).map(|k| std::array::from_fn(|d| number(3 * k + d))).collect();
            assert!((norm(at[0]) - 1.0).abs() < 1e-6);
            corners.extend(&at[1..]);
        }
        let triangles: Vec<[u32; 3]> = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        assert!((volume(&corners, &triangles) / 2536.0 - 1.0).abs() < 1e-6);
    }
}
