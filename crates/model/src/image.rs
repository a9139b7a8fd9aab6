//! The mirror images of a modelled part that make the whole body with it.

use crate::problem::Problem;
use crate::symmetry::SymmetryPlane;

/// A copy of the modelled part: itself, or a mirror image of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Planes that it is mirrored at, one after the other.
    planes: Vec<SymmetryPlane>,
}

impl Image {
    /// Where a point of the part is on it.
    pub fn point(&self, point: [f64; 3]) -> [f64; 3] {
        self.planes.iter().fold(point, |point, plane| plane.mirror_point(point))
    }

    /// A displacement, a force or a normal of the part as it is there.
    pub fn vector(&self, vector: [f64; 3]) -> [f64; 3] {
        self.planes.iter().fold(vector, |vector, plane| plane.mirror_vector(vector))
    }

    /// Whether it is turned inside out: the corners of its faces run the other way round.
    pub fn is_turned(&self) -> bool {
        self.planes.len() % 2 == 1
    }

    /// Planes that it is mirrored at.
    pub fn planes(&self) -> &[SymmetryPlane] {
        &self.planes
    }
}

impl Problem {
    /// The part itself and its mirror images: together they are the whole body.
    pub fn images(&self) -> Vec<Image> {
        let planes = |number: usize| {
            let chosen = self.symmetry.iter().enumerate().filter(|(bit, _)| number >> bit & 1 == 1);
            Image { planes: chosen.map(|(_, plane)| *plane).collect() }
        };
        (0..self.parts_of_whole()).map(planes).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_has_four_images_that_are_turned_by_turns() {
        let plane = |axis, at| SymmetryPlane { axis, at, support: 0 };
        let planes = [plane(1, 0.0), plane(0, 2.0)];
        let image = |chosen: &[usize]| Image { planes: chosen.iter().map(|&i| planes[i]).collect() };
        let all = [image(&[]), image(&[0]), image(&[1]), image(&[0, 1])];
        let places = all.each_ref().map(|image| image.point([3.0, 1.0, 5.0]));
        assert_eq!(places, [[3.0, 1.0, 5.0], [3.0, -1.0, 5.0], [1.0, 1.0, 5.0], [1.0, -1.0, 5.0]]);
        assert_eq!(all.each_ref().map(Image::is_turned), [false, true, true, false]);
        assert_eq!(all[3].vector([1.0, 1.0, 1.0]), [-1.0, -1.0, 1.0]);
    }
}
