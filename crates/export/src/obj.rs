//! Surfaces as Wavefront OBJ: the outside and the walls of the air as two groups, mm.

use std::fmt::Write;

use pneuflex_mesh::vector::Vec3;

use crate::paint::Paint;
use crate::surface::Surface;

/// The text of a file with the surface at some positions of its corners; with values at them, these give the corners colours.
pub fn write(surface: &Surface, positions: &[Vec3], painted: Option<(&Paint, &[f64])>) -> String {
    let mut text = String::from("# by pneuflex, lengths in mm\n");
    if let Some((Paint { label, range: [low, high] }, _)) = painted {
        let _ = writeln!(text, "# colours of the corners: {label} from {low} to {high}");
    }
    for (number, [x, y, z]) in positions.iter().enumerate() {
        let _ = write!(text, "v {x} {y} {z}");
        if let Some((paint, values)) = painted {
            let [r, g, b] = paint.colour(values[number]).0.map(|c| f64::from(c) / 255.0);
            let _ = write!(text, " {r:.4} {g:.4} {b:.4}");
        }
        text.push('\n');
    }
    for [x, y, z] in surface.normals(positions) {
        let _ = writeln!(text, "vn {x:.6} {y:.6} {z:.6}");
    }
    let (outside, air) = surface.triangles.split_at(surface.outside);
    for (group, triangles) in [("outside", outside), ("air", air)] {
        if !triangles.is_empty() {
            let _ = writeln!(text, "g {group}");
        }
        for triangle in triangles {
            let [a, b, c] = triangle.map(|corner| corner + 1);
            let _ = writeln!(text, "f {a}//{a} {b}//{b} {c}//{c}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bent, two_chambers};
    use pneuflex_model::Formulation;

    #[test]
    fn positions_are_those_of_the_fields_to_the_last_bit() {
        let problem = two_chambers(Formulation::Hex20);
        let surface = Surface::new(&problem);
        let positions = surface.positions(Some(&bent(&problem, 1.0)));
        let paint = Paint { label: "height (mm)".into(), range: [0.0, 13.0] };
        let heights: Vec<f64> = positions.iter().map(|x| x[2]).collect();
        let text = write(&surface, &positions, Some((&paint, &heights)));
        let numbers = |line: &str| line.split(' ').skip(1).map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>();
        let read: Vec<Vec<f64>> = text.lines().filter(|line| line.starts_with("v ")).map(numbers).collect();
        assert_eq!(read.len(), surface.len());
        assert!(read.iter().zip(&positions).all(|(found, at)| found[..3] == at[..] && found.len() == 6));
        let groups: Vec<usize> = text.split("\ng ").skip(1).map(|group| group.matches("\nf ").count()).collect();
        assert_eq!(groups, [surface.outside, surface.triangles.len() - surface.outside]);
        assert!(groups[1] > 0 && text.lines().filter(|line| line.starts_with("vn ")).count() == surface.len());
    }
}
