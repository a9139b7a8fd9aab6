//! Which share of a body lies in a box along the axes.
//!
//! Elements are divided into tetrahedra through their corners, and these are cut at the planes of the box: exact for elements with straight
//! edges and flat faces.

use crate::family::ReferenceBody;
use crate::mesh::{Mesh, determinant};

type Tetrahedron = [[f64; 3]; 4];

/// Corners of the tetrahedra around the diagonal from corner 0 to corner 6 of a hexahedron.
const HEXAHEDRON: [[usize; 4]; 6] =
    [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];

/// Of a wedge.
const WEDGE: [[usize; 4]; 3] = [[0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3]];

impl Mesh {
    /// Volume of the body between two corners of a box, mm³; edges and faces of elements count as straight.
    pub fn volume_within(&self, [one, other]: [[f64; 3]; 2]) -> f64 {
        let low: [f64; 3] = std::array::from_fn(|d| one[d].min(other[d]));
        let high: [f64; 3] = std::array::from_fn(|d| one[d].max(other[d]));
        let of_element = |element: usize| {
            let corners = self.corners(element);
            let range = |d: usize| {
                let along = corners.iter().map(|&n| self.nodes[n as usize][d]);
                along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
            };
            let ranges: [(f64, f64); 3] = std::array::from_fn(range);
            if (0..3).any(|d| ranges[d].1 <= low[d] || ranges[d].0 >= high[d]) {
                return 0.0;
            }
            let mut parts = self.corner_tetrahedra(element);
            for d in (0..3).filter(|&d| ranges[d].0 < low[d] || ranges[d].1 > high[d]) {
                parts = above(&parts, |x| x[d] - low[d]);
                parts = above(&parts, |x| high[d] - x[d]);
            }
            parts.iter().map(volume).sum::<f64>()
        };
        (0..self.num_elements()).map(of_element).sum()
    }

    /// Tetrahedra through the corners of an element that fill it.
    fn corner_tetrahedra(&self, element: usize) -> Vec<Tetrahedron> {
        let nodes = self.element(element);
        let at = |local: usize| self.nodes[nodes[local] as usize];
        match self.kind_of(element).body {
            ReferenceBody::Tetrahedron => vec![[0, 1, 2, 3].map(at)],
            ReferenceBody::Wedge => WEDGE.iter().map(|corners| corners.map(at)).collect(),
            ReferenceBody::Hexahedron => HEXAHEDRON.iter().map(|corners| corners.map(at)).collect(),
        }
    }
}

fn volume([a, b, c, d]: &Tetrahedron) -> f64 {
    let edge = |x: &[f64; 3]| std::array::from_fn(|k| x[k] - a[k]);
    determinant(&[edge(b), edge(c), edge(d)]).abs() / 6.0
}

/// What of some tetrahedra lies where a linear function is not negative.
fn above(parts: &[Tetrahedron], height: impl Fn(&[f64; 3]) -> f64) -> Vec<Tetrahedron> {
    let mut kept = Vec::with_capacity(parts.len());
    for part in parts {
        let heights = part.map(|x| height(&x));
        let (mut inside, mut outside) = (Vec::with_capacity(4), Vec::with_capacity(4));
        (0..4).for_each(|i| if heights[i] >= 0.0 { inside.push(i) } else { outside.push(i) });
        let x = |i: usize| part[i];
        // Where the edge from a corner inside to one outside is cut.
        let cut = |i: usize, o: usize| -> [f64; 3] {
            let share = heights[i] / (heights[i] - heights[o]);
            std::array::from_fn(|k| part[i][k] + share * (part[o][k] - part[i][k]))
        };
        let mut prism = |[a, b, c]: [[f64; 3]; 3], [d, e, f]: [[f64; 3]; 3]| {
            kept.extend([[a, b, c, d], [b, c, d, e], [c, d, e, f]]);
        };
        match (&inside[..], &outside[..]) {
            (_, []) => kept.push(*part),
            (&[i], &[a, b, c]) => kept.push([x(i), cut(i, a), cut(i, b), cut(i, c)]),
            (&[i, j], &[a, b]) => prism([x(i), cut(i, a), cut(i, b)], [x(j), cut(j, a), cut(j, b)]),
            (&[i, j, k], &[o]) => prism([x(i), x(j), x(k)], [cut(i, o), cut(j, o), cut(k, o)]),
            _ => {}
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use crate::element::ElementKind;
    use crate::lattice::Lattice;

    #[test]
    fn boxes_cut_elements_of_every_family() {
        for kind in ElementKind::ALL {
            let mesh = Lattice::uniform([0.0; 3], [4.0, 3.0, 2.0], [2, 2, 2]).mesh_all(kind);
            for (corners, volume) in [
                ([[-1.0; 3], [9.0; 3]], 24.0),
                ([[9.0; 3], [-1.0; 3]], 24.0),
                ([[0.3, -1.0, 0.1], [3.9, 1.7, 1.3]], 3.6 * 1.7 * 1.2),
                ([[1.1, 1.1, 1.1], [1.2, 1.2, 1.2]], 1e-3),
                ([[4.0, 0.0, 0.0], [5.0, 3.0, 2.0]], 0.0),
            ] {
                let found = mesh.volume_within(corners);
                assert!((found - volume).abs() < 1e-12, "{kind:?} {corners:?}: {found} for {volume}");
            }
            // A shear keeps the volume: the layer below z = 0.5 of the sheared block.
            let sheared = mesh.map_nodes(|[x, y, z]| [x + 0.7 * z, y - 0.2 * x, z]);
            assert!((sheared.volume_within([[-9.0, -9.0, -1.0], [9.0, 9.0, 0.5]]) - 6.0).abs() < 1e-12, "{kind:?}");
        }
    }
}
