//! Closed shells of a surface: which way their triangles look, what lies in what.

use std::collections::BTreeMap;

use pneuflex_mesh::vector::{Vec3, cross, dot, ray_meets};

use super::{Surface, centre};

/// So many faults of a surface are named.
const MOST: usize = 5;

/// Points that are closer than this are one where a surface is open otherwise, relative to its diagonal.
const CLOSE: f64 = 1e-6;

/// A surface that bounds a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounded {
    /// Its triangles, looking away from the solid.
    pub surface: Surface,
    /// Volume of the solid.
    pub volume: f64,
    /// Number of closed hollows in it.
    pub hollows: usize,
    /// Number of solids that do not touch.
    pub solids: usize,
}

impl Surface {
    /// The body that the surface bounds: shells that lie in an odd number of others are hollows.
    ///
    /// # Errors
    /// Holes, and edges at which more than two triangles meet, with their places; as sentences.
    pub fn bounded(&self) -> Result<Bounded, Vec<String>> {
        let faults = self.faults();
        if faults.is_empty() {
            return Ok(self.outward());
        }
        let welded = self.welded();
        if welded.triangles.len() < self.triangles.len() || welded.points.len() < self.points.len() {
            let left = welded.faults();
            return if left.is_empty() { Ok(welded.outward()) } else { Err(left) };
        }
        Err(faults)
    }

    /// Triangles by the ends of their edges in ascending order.
    fn at_edges(&self) -> Vec<([u32; 2], u32)> {
        let of_triangle = |(number, &[a, b, c]): (usize, &[u32; 3])| {
            [[a, b], [b, c], [c, a]].map(|[from, to]| ([from.min(to), from.max(to)], number as u32))
        };
        let mut found: Vec<_> = self.triangles.iter().enumerate().flat_map(of_triangle).collect();
        found.sort_unstable();
        found
    }

    fn faults(&self) -> Vec<String> {
        let at_edges = self.at_edges();
        let (mut open, mut crowded) = (Vec::new(), Vec::new());
        for meeting in at_edges.chunk_by(|a, b| a.0 == b.0) {
            match meeting.len() {
                1 => open.push(meeting[0].0),
                2 => {}
                _ => crowded.push(meeting[0].0),
            }
        }
        let mut found = Vec::new();
        let holes = self.lines(&open);
        for (edges, at) in holes.iter().take(MOST) {
            let [x, y, z] = at.map(short);
            found.push(format!("the surface has a hole of {edges} edges around ({x}, {y}, {z})"));
        }
        if holes.len() > MOST {
            found.push(format!("and {} more holes", holes.len() - MOST));
        }
        if let Some(first) = crowded.first() {
            let [x, y, z] = self.middle(*first).map(short);
            found.push(format!(
                "at {} edges more than two triangles meet, the first near ({x}, {y}, {z}): parts that touch must be one",
                crowded.len()
            ));
        }
        found
    }

    fn middle(&self, [a, b]: [u32; 2]) -> Vec3 {
        let [a, b] = [a, b].map(|point| self.points[point as usize]);
        std::array::from_fn(|d| 0.5 * (a[d] + b[d]))
    }

    /// Numbers of edges, and the middles, of lines that edges make up.
    fn lines(&self, edges: &[[u32; 2]]) -> Vec<(usize, Vec3)> {
        let mut of: BTreeMap<u32, u32> = edges.iter().flatten().map(|&point| (point, point)).collect();
        fn root(of: &mut BTreeMap<u32, u32>, mut point: u32) -> u32 {
            while of[&point] != point {
                let next = of[&of[&point]];
                of.insert(point, next);
                point = next;
            }
            point
        }
        for &[a, b] in edges {
            let (a, b) = (root(&mut of, a), root(&mut of, b));
            of.insert(a.max(b), a.min(b));
        }
        let mut found: BTreeMap<u32, (usize, Vec3)> = BTreeMap::new();
        for &edge in edges {
            let (count, sum) = found.entry(root(&mut of, edge[0])).or_insert((0, [0.0; 3]));
            *count += 1;
            let middle = self.middle(edge);
            (0..3).for_each(|d| sum[d] += middle[d]);
        }
        found.into_values().map(|(count, sum)| (count, sum.map(|t| t / count as f64))).collect()
    }

    /// The surface with points that are close to each other made one.
    fn welded(&self) -> Self {
        let size = CLOSE * self.diagonal();
        let mut numbers: BTreeMap<[i64; 3], u32> = BTreeMap::new();
        let mut points = Vec::new();
        let mut number_of = Vec::with_capacity(self.points.len());
        for &x in &self.points {
            let key = x.map(|t| (t / size).round() as i64);
            number_of.push(*numbers.entry(key).or_insert_with(|| {
                points.push(x);
                points.len() as u32 - 1
            }));
        }
        let triangles = self.triangles.iter().map(|corners| corners.map(|point| number_of[point as usize]));
        let triangles = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        Self { points, triangles }
    }

    /// The triangles turned so that they look away from the solid.
    fn outward(&self) -> Bounded {
        let at_edges = self.at_edges();
        let mut beside: Vec<[u32; 3]> = vec![[0; 3]; self.triangles.len()];
        let mut filled = vec![0; self.triangles.len()];
        for meeting in at_edges.chunk_by(|a, b| a.0 == b.0) {
            for (one, other) in [(meeting[0].1, meeting[1].1), (meeting[1].1, meeting[0].1)] {
                beside[one as usize][filled[one as usize]] = other;
                filled[one as usize] += 1;
            }
        }
        let mut surface = self.clone();
        let mut shell = vec![usize::MAX; self.triangles.len()];
        let mut volumes = Vec::new();
        for first in 0..shell.len() {
            if shell[first] != usize::MAX {
                continue;
            }
            let number = volumes.len();
            shell[first] = number;
            let (mut waiting, mut volume) = (vec![first], 0.0);
            while let Some(triangle) = waiting.pop() {
                let [a, b, c] = surface.corners(triangle);
                volume += dot(a, cross(b, c)) / 6.0;
                let own = surface.triangles[triangle];
                for next in beside[triangle].map(|next| next as usize) {
                    if shell[next] == usize::MAX {
                        shell[next] = number;
                        // Neighbours run along their edge in opposite directions.
                        let runs = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
                        if runs(own).iter().any(|edge| runs(surface.triangles[next]).contains(edge)) {
                            surface.triangles[next].swap(1, 2);
                        }
                        waiting.push(next);
                    }
                }
            }
            volumes.push(volume);
        }
        let depths: Vec<usize> = (0..volumes.len()).map(|number| surface.depth(number, &shell)).collect();
        let is_hollow = |number: usize| depths[number] % 2 == 1;
        for (triangle, &number) in shell.iter().enumerate() {
            if (volumes[number] > 0.0) == is_hollow(number) {
                surface.triangles[triangle].swap(1, 2);
            }
        }
        let signed = volumes.iter().enumerate().map(|(number, v)| if is_hollow(number) { -v.abs() } else { v.abs() });
        let hollows = (0..volumes.len()).filter(|&number| is_hollow(number)).count();
        Bounded { volume: signed.sum(), hollows, solids: volumes.len() - hollows, surface }
    }

    /// In how many other shells one lies.
    fn depth(&self, number: usize, shell: &[usize]) -> usize {
        let Some(first) = shell.iter().position(|&of| of == number) else { return 0 };
        let from = centre(self.corners(first));
        // Along nothing that parts have in common.
        let direction = [0.831_47, 0.437_91, 0.341_77];
        let mut crossed: BTreeMap<usize, usize> = BTreeMap::new();
        for (triangle, &of) in shell.iter().enumerate().filter(|(_, of)| **of != number) {
            if ray_meets(from, direction, self.corners(triangle)).is_some_and(|along| along > 0.0) {
                *crossed.entry(of).or_default() += 1;
            }
        }
        crossed.values().filter(|count| *count % 2 == 1).count()
    }
}

/// A coordinate to six digits.
fn short(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let unit = 10f64.powf(5.0 - x.abs().log10().floor());
    (x * unit).round() / unit
}
