//! Surfaces of triangles: `.stl`, text or binary, and `.obj` → points and triangles; whether they bound a body, and which.
//!
//! * [`read`]: the formats.
//! * [`Surface::bounded`]: closed shells, which way their triangles look, what lies in what.
//! * [`Surface::crossings`]: triangles that pass through each other.
//! * [`Surface::thinnest_wall`].

mod crossing;
mod read;
mod shells;
mod wall;

use pneuflex_mesh::vector::{Vec3, bounds, cross, norm, sub};

pub use read::read;
pub use shells::Bounded;
pub use wall::Wall;

/// Points and triangles between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Positions, each once.
    pub points: Vec<[f64; 3]>,
    /// Corners of every triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// Positions of the corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [[f64; 3]; 3] {
        self.triangles[triangle].map(|point| self.points[point as usize])
    }

    /// Length of the diagonal of the box around it.
    pub fn diagonal(&self) -> f64 {
        bounds(self.points.iter().copied()).map_or(0.0, |[low, high]| norm(sub(high, low)))
    }

    /// The boxes around its triangles.
    fn boxes(&self) -> Vec<[Vec3; 2]> {
        (0..self.triangles.len()).map(|triangle| bounds(self.corners(triangle)).unwrap_or_default()).collect()
    }

    /// The surface as a binary `.stl`, whose numbers have seven digits.
    pub fn to_stl(&self) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        bytes.extend((self.triangles.len() as u32).to_le_bytes());
        for triangle in 0..self.triangles.len() {
            let corners = self.corners(triangle);
            let normal = unit_normal(corners);
            let numbers = std::iter::once(normal).chain(corners).flatten();
            numbers.for_each(|x| bytes.extend((x as f32).to_le_bytes()));
            bytes.extend([0, 0]);
        }
        bytes
    }
}

fn centre([a, b, c]: [Vec3; 3]) -> Vec3 {
    std::array::from_fn(|d| (a[d] + b[d] + c[d]) / 3.0)
}

/// 0 for a triangle without area.
fn unit_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    let normal = cross(sub(b, a), sub(c, a));
    let size = norm(normal);
    if size > 0.0 { normal.map(|t| t / size) } else { [0.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The twelve triangles of a box, looking outwards.
    pub(super) fn cuboid(low: Vec3, high: Vec3) -> Surface {
        let points = (0..8).map(|i| std::array::from_fn(|d| if i >> d & 1 == 0 { low[d] } else { high[d] })).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Surface { points, triangles }
    }

    pub(super) fn joined(parts: &[Surface]) -> Surface {
        let mut whole = Surface::default();
        for part in parts {
            let first = whole.points.len() as u32;
            whole.points.extend(&part.points);
            whole.triangles.extend(part.triangles.iter().map(|corners| corners.map(|point| point + first)));
        }
        whole
    }

    #[test]
    fn a_box_with_a_hollow_is_written_and_read_and_bounded() {
        let hollow = cuboid([1.0; 3], [2.0, 2.0, 2.5]);
        let whole = joined(&[cuboid([0.0; 3], [3.0, 4.0, 3.0]), hollow]);
        let again = read("a.stl", &whole.to_stl()).unwrap();
        assert_eq!((again.points.len(), again.triangles.len()), (16, 24));
        // The hollow looked the wrong way.
        let bounded = again.bounded().unwrap();
        assert!((bounded.volume - (36.0 - 1.5)).abs() < 1e-6, "{}", bounded.volume);
        assert_eq!(bounded.hollows, 1);
        assert!(bounded.surface.crossings(9).is_empty());
        let wall = bounded.surface.thinnest_wall().unwrap();
        assert!((wall.thickness - 0.5).abs() < 1e-6, "{wall:?}");
        assert!((wall.at[2] - 2.75).abs() < 1e-6, "{wall:?}");
        // From the outside it is a solid in a solid if the inner one is turned by hand: what lies in what decides.
        assert!((whole.bounded().unwrap().volume - 34.5).abs() < 1e-12);
    }

    #[test]
    fn holes_and_crossings_are_named_with_their_place() {
        let mut open = cuboid([0.0; 3], [1.0; 3]);
        open.triangles.truncate(10);
        let why = open.bounded().unwrap_err();
        assert!(why.len() == 1 && why[0].contains("hole of 4 edges around (1, 0.5, 0.5)"), "{why:?}");
        let crossing = joined(&[cuboid([0.0; 3], [1.0; 3]), cuboid([0.5, 0.25, 0.25], [1.5, 0.75, 0.75])]);
        let bounded = crossing.bounded().unwrap();
        let found = bounded.surface.crossings(9);
        assert!(!found.is_empty() && found.iter().all(|x| (x[0] - 1.0).abs() < 1e-9), "{found:?}");
        let fin = joined(&[
            cuboid([0.0; 3], [1.0; 3]),
            Surface { points: vec![[0.0; 3], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]], triangles: vec![[0, 1, 2]] },
        ]);
        let welded = read("a.stl", &fin.to_stl()).unwrap();
        let why = welded.bounded().unwrap_err();
        assert!(why.iter().any(|why| why.contains("more than two triangles meet")), "{why:?}");
    }

    #[test]
    fn texts_are_read_and_what_is_none_is_refused() {
        let obj = "# a tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1 3 2\nf 1//1 2//1 4//1\nf 2/1/1 3/1/1 4/1/1\nf -4 -1 -2\n";
        let surface = read("a.obj", obj.as_bytes()).unwrap();
        assert!((surface.bounded().unwrap().volume - 1.0 / 6.0).abs() < 1e-15);
        let stl = "solid x\nfacet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1e0 0\n endloop\nendfacet\nendsolid x\n";
        assert_eq!(read("a.stl", stl.as_bytes()).unwrap().triangles, [[0, 1, 2]]);
        for (name, text, said) in [
            ("a.stl", "solid x\nendsolid x\n", "no triangle"),
            ("a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nendloop", "a.stl:4"),
            ("a.stl", "solid x\nfacet\nvertex 0 0 nan", "not a number"),
            ("a.stl", "solid x\nfacet\nvertex 0 0 1\n", "ends within a triangle"),
            ("a.stl", "what is this", "neither text nor binary"),
            ("a.obj", "v 0 0 0\nf 1 2 3\n", "a.obj:2"),
            ("a.obj", "v 0 0 0\nf 1 1\n", "a.obj:2"),
        ] {
            let error = read(name, text.as_bytes()).unwrap_err();
            assert!(error.to_string().contains(said), "{text}: {error}");
        }
    }
}
