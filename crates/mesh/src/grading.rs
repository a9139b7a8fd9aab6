//! Element sizes along one axis: small at re-entrant edges, growing away from them.
//!
//! At a re-entrant edge of a body the stress of the exact solution is unbounded, and uniform meshes converge slowly whatever
//! the element (Szabó & Babuška 1991, *Finite Element Analysis*, ch. 10). The element size wanted at a distance d from the
//! nearest edge plane is
//!
//! ```text
//! h(d) = min(size, edge + growth · d)
//! ```
//!
//! and an interval gets ⌈∫ dx / h⌉ elements, each with the same share of the integral. For studies of convergence every element
//! can be divided once more: such meshes hold all nodes of the undivided one.

/// How fine a lattice is: target element size per direction, at re-entrant edges, and through thin walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshSize {
    /// Largest element edge along x, y, z, mm.
    pub size: [f64; 3],
    /// Element edge at re-entrant edges of the body, mm; where it is not below `size`, the mesh is uniform.
    pub edge: f64,
    /// Growth of the element size with the distance from an edge.
    pub growth: f64,
    /// Least number of elements through end, side and top walls.
    pub wall_elements: usize,
    /// Number of parts into which every element is divided along every direction; 1 leaves it whole.
    pub divisions: usize,
}

/// Usual growth: neighbours differ by a factor of about 2.
const GROWTH: f64 = 1.0;

/// Rounding that must not become an element: keeps 6 mm at 0.1 mm from becoming 61 elements.
const ROUNDING: f64 = 1e-9;

/// Interval between two neighbouring break planes of the geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Where it begins, mm.
    pub start: f64,
    /// Where it ends, mm.
    pub end: f64,
    /// Whether it is the thickness of a wall.
    pub is_wall: bool,
    /// Whether re-entrant edges lie in the planes at its start and at its end.
    pub edges: [bool; 2],
}

impl MeshSize {
    /// The same size in all directions, without grading.
    pub fn uniform(size: f64) -> Self {
        Self::per_axis([size; 3])
    }

    /// One size per direction, without grading.
    pub fn per_axis(size: [f64; 3]) -> Self {
        Self { size, edge: f64::INFINITY, growth: GROWTH, wall_elements: 1, divisions: 1 }
    }

    /// The mesh of these sizes with every element divided.
    pub fn divided(&self, divisions: usize) -> Self {
        Self { divisions: self.divisions * divisions, ..*self }
    }

    /// Number of elements of an interval along an axis, a whole number that may be too large for a mesh.
    pub(crate) fn cells(&self, interval: &Interval, axis: usize) -> f64 {
        let least = if interval.is_wall { self.wall_elements.max(1) as f64 } else { 1.0 };
        (self.density(axis).total(interval) - ROUNDING).ceil().max(least) * self.divisions.max(1) as f64
    }

    /// Positions of the element boundaries inside an interval and at its end, in ascending order.
    pub(crate) fn divide(&self, interval: &Interval, axis: usize) -> Vec<f64> {
        let n = self.cells(interval, axis) as usize;
        let density = self.density(axis);
        let mut lines: Vec<f64> = (1..n).map(|i| density.position(interval, i as f64 / n as f64)).collect();
        lines.push(interval.end);
        lines
    }

    fn density(&self, axis: usize) -> Density {
        let size = self.size[axis];
        Density { size, edge: self.edge.min(size), growth: self.growth }
    }
}

/// Elements per length.
struct Density {
    size: f64,
    edge: f64,
    growth: f64,
}

impl Density {
    /// Length of the graded part and the number of elements in it, not rounded.
    fn graded(&self) -> (f64, f64) {
        ((self.size - self.edge) / self.growth, (self.size / self.edge).ln() / self.growth)
    }

    /// Number of elements, not rounded, from an edge to a distance from it.
    fn count(&self, distance: f64) -> f64 {
        let graded = self.graded().0.min(distance);
        (self.growth * graded / self.edge).ln_1p() / self.growth + (distance - graded) / self.size
    }

    /// Distance from an edge up to which there are `count` elements: the inverse of [`Self::count`].
    fn distance(&self, count: f64) -> f64 {
        let (length, in_graded) = self.graded();
        if count <= in_graded {
            self.edge * (self.growth * count).exp_m1() / self.growth
        } else {
            length + (count - in_graded) * self.size
        }
    }

    fn total(&self, interval: &Interval) -> f64 {
        let length = interval.end - interval.start;
        match interval.edges {
            [false, false] => length / self.size,
            [true, true] => 2.0 * self.count(0.5 * length),
            _ => self.count(length),
        }
    }

    /// Where `share` of the interval's elements lie below.
    fn position(&self, interval: &Interval, share: f64) -> f64 {
        let (start, end) = (interval.start, interval.end);
        let total = self.total(interval);
        let from_start = |share: f64| start + self.distance(share * total);
        let from_end = |share: f64| end - self.distance((1.0 - share) * total);
        match interval.edges {
            [false, false] => start + (end - start) * share,
            [true, false] => from_start(share),
            [false, true] => from_end(share),
            [true, true] if share < 0.5 => from_start(share),
            [true, true] if share > 0.5 => from_end(share),
            [true, true] => 0.5 * (start + end),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval(edges: [bool; 2]) -> Interval {
        Interval { start: 3.0, end: 11.0, is_wall: false, edges }
    }

    #[test]
    fn sizes_grow_away_from_edges() {
        let size = MeshSize { edge: 0.25, growth: 0.5, ..MeshSize::uniform(2.0) };
        for edges in [[true, true], [true, false], [false, true]] {
            let interval = interval(edges);
            let lines: Vec<f64> = std::iter::once(interval.start).chain(size.divide(&interval, 0)).collect();
            assert_eq!((lines[0], lines[lines.len() - 1]), (3.0, 11.0));
            let distance = |x: f64| {
                let ends = [(edges[0], x - interval.start), (edges[1], interval.end - x)];
                ends.into_iter().filter(|(is_edge, _)| *is_edge).fold(f64::INFINITY, |d, (_, x)| d.min(x))
            };
            for pair in lines.windows(2) {
                let wanted = |x| (0.25 + size.growth * distance(x)).min(2.0);
                // Between two edges the size is largest in the middle, 4 mm from both.
                let middle = if pair[0] < 7.0 && pair[1] > 7.0 { wanted(7.0) } else { 0.0 };
                let (length, largest) = (pair[1] - pair[0], wanted(pair[0]).max(wanted(pair[1])).max(middle));
                assert!(length > 0.0 && length <= largest * (1.0 + 1e-12), "{edges:?}: {pair:?}");
                let smallest = wanted(pair[0]).min(wanted(pair[1])).min(wanted(0.5 * (pair[0] + pair[1])));
                assert!(length > 0.7 * smallest, "{edges:?}: {pair:?}");
            }
        }
    }

    #[test]
    fn halves_of_an_interval_between_edges_mirror_each_other() {
        let size = MeshSize { edge: 0.3, ..MeshSize::uniform(1.5) };
        let interval = interval([true, true]);
        let lines = size.divide(&interval, 1);
        for (low, high) in lines.iter().zip(lines[..lines.len() - 1].iter().rev()) {
            assert!((low + high - 14.0).abs() < 1e-12);
        }
    }

    #[test]
    fn without_grading_elements_are_equal() {
        for size in [MeshSize::uniform(1.0), MeshSize { edge: 1.0, ..MeshSize::uniform(1.0) }] {
            let lines = size.divide(&interval([true, true]), 2);
            assert_eq!(lines.len(), 8);
            assert!(lines.iter().enumerate().all(|(i, x)| (x - (4.0 + i as f64)).abs() < 1e-12));
        }
    }

    #[test]
    fn divided_elements_keep_the_nodes_and_the_grading() {
        let size = MeshSize { edge: 0.5, ..MeshSize::uniform(3.0) };
        for edges in [[true, true], [true, false], [false, true], [false, false]] {
            let interval = interval(edges);
            let (whole, thirds) = (size.divide(&interval, 0), size.divided(3).divide(&interval, 0));
            assert_eq!(thirds.len(), 3 * whole.len());
            for (i, x) in whole.iter().enumerate() {
                assert!((x - thirds[3 * i + 2]).abs() < 1e-12, "{edges:?}");
            }
        }
    }
}
