//! Triangles of a surface that pass through each other.

use pneuflex_mesh::vector::{Vec3, bounds, cross, dot, longest_axis, norm, sub};

use super::Surface;

/// How far beyond a triangle's side something must be, relative to its size, to be beyond.
const SMALL: f64 = 1e-9;

impl Surface {
    /// Points, `most` of them, at which an edge of a triangle passes through another one that has no corner in common with it.
    pub fn crossings(&self, most: usize) -> Vec<[f64; 3]> {
        let boxes = self.boxes();
        let axis = bounds(self.points.iter().copied()).map_or(0, longest_axis);
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        order.sort_by(|&a, &b| boxes[a][0][axis].total_cmp(&boxes[b][0][axis]).then(a.cmp(&b)));
        let mut found = Vec::new();
        // Those that the plane that sweeps along the axis is in.
        let mut active: Vec<usize> = Vec::new();
        for &triangle in &order {
            let [low, high] = boxes[triangle];
            active.retain(|&other| boxes[other][1][axis] >= low[axis]);
            for &other in &active {
                let [from, to] = boxes[other];
                if (0..3).all(|d| from[d] <= high[d] && low[d] <= to[d]) && self.share_nothing(triangle, other) {
                    found.extend(crossing(self.corners(triangle), self.corners(other)));
                    if found.len() >= most {
                        return found;
                    }
                }
            }
            active.push(triangle);
        }
        found
    }

    fn share_nothing(&self, one: usize, other: usize) -> bool {
        self.triangles[one].iter().all(|point| !self.triangles[other].contains(point))
    }
}

/// Where an edge of one triangle passes through the inside of the other.
fn crossing(one: [Vec3; 3], other: [Vec3; 3]) -> Option<Vec3> {
    let edges = |[a, b, c]: [Vec3; 3]| [[a, b], [b, c], [c, a]];
    let through = |triangle: [Vec3; 3]| move |edge: [Vec3; 2]| passes(edge, triangle);
    edges(one).into_iter().find_map(through(other)).or_else(|| edges(other).into_iter().find_map(through(one)))
}

fn passes([from, to]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> Option<Vec3> {
    let normal = cross(sub(b, a), sub(c, a));
    let size = norm(normal);
    let height = |x: Vec3| dot(sub(x, a), normal);
    let least = SMALL * size * size.sqrt();
    let (below, above) = (height(from), height(to));
    if below * above >= 0.0 || below.abs() <= least || above.abs() <= least {
        return None;
    }
    let share = below / (below - above);
    let x: Vec3 = std::array::from_fn(|d| from[d] + share * (to[d] - from[d]));
    let is_within = [[a, b], [b, c], [c, a]]
        .iter()
        .all(|[start, end]| dot(cross(sub(*end, *start), sub(x, *start)), normal) > SMALL * size * size);
    is_within.then_some(x)
}
