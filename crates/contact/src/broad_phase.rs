//! Which faces may be near which: boxes in a tree, and by brute force.

use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

/// A box along the axes: \[low, high\], mm.
pub type Bounds = [[f64; 3]; 2];

/// Boxes of faces in an R*-tree.
pub struct FaceTree {
    tree: RTree<GeomWithData<Rectangle<[f64; 3]>, usize>>,
}

impl FaceTree {
    /// Sorts boxes into a tree. Boxes with a coordinate that is not finite overlap nothing.
    pub fn new(boxes: &[Bounds]) -> Self {
        let finite = boxes.iter().enumerate().filter(|(_, b)| b.as_flattened().iter().all(|x| x.is_finite()));
        let entries = finite.map(|(face, b)| GeomWithData::new(Rectangle::from_corners(b[0], b[1]), face));
        Self { tree: RTree::bulk_load(entries.collect()) }
    }

    /// Numbers of the boxes that overlap `bounds` grown by `margin`, in ascending order: those of [`overlapping_by_brute_force`].
    pub fn overlapping(&self, boxes: &[Bounds], bounds: &Bounds, margin: f64, out: &mut Vec<usize>) {
        out.clear();
        // The tree rounds differently from the test that counts.
        let scale = bounds.as_flattened().iter().fold(margin.abs(), |a, x| a.max(x.abs()));
        let safe = margin + 1e-12 * scale;
        let window = AABB::from_corners(bounds[0].map(|x| x - safe), bounds[1].map(|x| x + safe));
        if !window.lower().iter().chain(&window.upper()).all(|x| x.is_finite()) {
            return;
        }
        let found = self.tree.locate_in_envelope_intersecting(window).map(|entry| entry.data);
        out.extend(found.filter(|&face| overlap(bounds, &boxes[face], margin)));
        out.sort_unstable();
    }
}

/// The same by looking at every box.
pub fn overlapping_by_brute_force(boxes: &[Bounds], bounds: &Bounds, margin: f64) -> Vec<usize> {
    (0..boxes.len()).filter(|&face| overlap(bounds, &boxes[face], margin)).collect()
}

/// Whether two boxes are nearer than `margin` along every axis.
pub fn overlap(a: &Bounds, b: &Bounds, margin: f64) -> bool {
    (0..3).all(|d| a[0][d] <= b[1][d] + margin && b[0][d] <= a[1][d] + margin)
}

/// The box around boxes.
pub fn join<'a>(boxes: impl IntoIterator<Item = &'a Bounds>) -> Bounds {
    boxes.into_iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |all, b| {
        [std::array::from_fn(|d| all[0][d].min(b[0][d])), std::array::from_fn(|d| all[1][d].max(b[1][d]))]
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn boxes() -> impl Strategy<Value = Vec<Bounds>> {
        // Coordinates on a grid, so that boxes that just touch are common.
        let coordinate = prop_oneof![(-8_i32..8).prop_map(|i| 0.1 * f64::from(i)), -1.0..1.0];
        let corner = [coordinate.clone(), coordinate.clone(), coordinate];
        let size = [0.0..0.4, 0.0..0.4, 0.0..0.4];
        let one = (corner, size).prop_map(|(low, size)| [low, std::array::from_fn(|d| low[d] + size[d])]);
        proptest::collection::vec(one, 0..120)
    }

    proptest! {
        #[test]
        fn the_tree_finds_what_brute_force_finds(boxes in boxes(), margin in prop_oneof![Just(0.0), Just(0.1), 0.0..0.5]) {
            let tree = FaceTree::new(&boxes);
            let mut found = Vec::new();
            for bounds in &boxes {
                tree.overlapping(&boxes, bounds, margin, &mut found);
                let expected = overlapping_by_brute_force(&boxes, bounds, margin);
                prop_assert!(!expected.is_empty(), "a box overlaps itself");
                prop_assert_eq!(&found, &expected);
            }
        }
    }

    #[test]
    fn numbers_that_are_none_overlap_nothing() {
        let boxes = [[[0.0; 3], [1.0; 3]], [[f64::NAN; 3], [1.0; 3]], [[0.5; 3], [f64::INFINITY; 3]]];
        let tree = FaceTree::new(&boxes);
        let mut found = vec![7];
        tree.overlapping(&boxes, &[[0.2; 3], [0.3; 3]], 0.1, &mut found);
        assert_eq!(found, [0]);
        tree.overlapping(&boxes, &[[0.2; 3], [f64::NAN; 3]], 0.1, &mut found);
        assert!(found.is_empty());
    }
}
