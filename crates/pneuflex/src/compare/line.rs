//! Lines in the plane x–z that measured points are compared with: the bottom line of an actuator, or the outline of a body as it is seen along y.

use std::collections::BTreeMap;

use pneuflex_export::surface::Surface;

/// A straight piece, mm.
pub(super) type Piece = [[f64; 2]; 2];

/// How far beside an edge it is looked whether something of the body is there, as a share of the body's size.
const BESIDE: f64 = 1e-5;

/// Cells of the grid by which triangles are found, along either axis.
const CELLS: usize = 200;

/// The pieces of a chain of points.
pub(super) fn chain(points: &[[f64; 2]]) -> Vec<Piece> {
    points.windows(2).map(|two| [two[0], two[1]]).collect()
}

/// The nearest point of some pieces, and a unit vector away from it: towards the point, or normal to the piece where the point lies on it.
pub(super) fn nearest(pieces: &[Piece], point: [f64; 2]) -> Option<([f64; 2], [f64; 2])> {
    let foot = |[a, b]: &Piece| {
        let along = [b[0] - a[0], b[1] - a[1]];
        let length = along[0] * along[0] + along[1] * along[1];
        let share = ((point[0] - a[0]) * along[0] + (point[1] - a[1]) * along[1]) / length;
        let share = if length > 0.0 { share.clamp(0.0, 1.0) } else { 0.0 };
        [a[0] + share * along[0], a[1] + share * along[1]]
    };
    let distance = |at: [f64; 2]| (point[0] - at[0]).hypot(point[1] - at[1]);
    let (piece, at) =
        pieces.iter().map(|piece| (piece, foot(piece))).min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
    let [a, b] = piece;
    let size = (b[0] - a[0]).hypot(b[1] - a[1]);
    let away = distance(at);
    let direction = if away > 1e-9 * size.max(1e-9) {
        [(point[0] - at[0]) / away, (point[1] - at[1]) / away]
    } else {
        [-(b[1] - a[1]) / size, (b[0] - a[0]) / size]
    };
    Some((at, direction))
}

/// The outline of the whole body as it is seen along y: edges of the surface beside which, on one side, there is nothing of it.
pub(super) fn outline(surface: &Surface, positions: &[[f64; 3]]) -> Vec<Piece> {
    let flat: Vec<[f64; 2]> = positions.iter().map(|x| [x[0], x[2]]).collect();
    let triangles: Vec<[[f64; 2]; 3]> =
        surface.triangles[..surface.outside].iter().map(|t| t.map(|corner| flat[corner as usize])).collect();
    let grid = Grid::new(&triangles);
    let (numbers, _) = surface.welded();
    // Both sides of an edge that are clearly seen, or clearly not, have no outline between them.
    let mut edges: BTreeMap<[u32; 2], (Piece, bool, bool)> = BTreeMap::new();
    for (corners, triangle) in surface.triangles[..surface.outside].iter().zip(&triangles) {
        let area = signed_area(triangle);
        let size =
            triangle.windows(2).map(|two| (two[0][0] - two[1][0]).hypot(two[0][1] - two[1][1])).fold(0.0, f64::max);
        let (is_seen, is_hidden) = (area > -1e-6 * size * size, area < 1e-6 * size * size);
        for [a, b] in [[0, 1], [1, 2], [2, 0]] {
            let [p, q] = [a, b].map(|i| numbers[corners[i] as usize]);
            let known = edges.entry([p.min(q), p.max(q)]).or_insert(([triangle[a], triangle[b]], false, false));
            known.1 |= is_seen;
            known.2 |= is_hidden;
        }
    }
    let beside = BESIDE * grid.size;
    let is_outline = |[a, b]: &Piece| {
        let along = [b[0] - a[0], b[1] - a[1]];
        let length = along[0].hypot(along[1]);
        // An edge along y is a point.
        if length <= beside {
            return false;
        }
        let normal = [-along[1] / length * beside, along[0] / length * beside];
        let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        [1.0, -1.0].iter().any(|side| !grid.covers([middle[0] + side * normal[0], middle[1] + side * normal[1]]))
    };
    let turns = edges.into_values().filter(|(_, seen, hidden)| *seen && *hidden).map(|(piece, ..)| piece);
    turns.filter(is_outline).collect()
}

fn signed_area(&[a, b, c]: &[[f64; 2]; 3]) -> f64 {
    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))
}

/// Triangles by the cells that they may touch.
struct Grid<'a> {
    triangles: &'a [[[f64; 2]; 3]],
    low: [f64; 2],
    size: f64,
    cells: Vec<Vec<u32>>,
}

impl<'a> Grid<'a> {
    fn new(triangles: &'a [[[f64; 2]; 3]]) -> Self {
        let end =
            |d: usize, of: fn(f64, f64) -> f64| triangles.iter().flatten().map(|p| p[d]).reduce(of).unwrap_or(0.0);
        let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max].map(|of| [end(0, of), end(1, of)]);
        let size = (high[0] - low[0]).max(high[1] - low[1]).max(1e-9);
        let mut grid = Self { triangles, low, size, cells: vec![Vec::new(); CELLS * CELLS] };
        for (number, triangle) in triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|p| grid.cell(p));
            let range = |d: usize| a[d].min(b[d]).min(c[d])..=a[d].max(b[d]).max(c[d]);
            for (i, j) in range(0).flat_map(|i| range(1).map(move |j| (i, j))) {
                grid.cells[i * CELLS + j].push(number as u32);
            }
        }
        grid
    }

    fn cell(&self, point: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|d| ((point[d] - self.low[d]) / self.size * CELLS as f64).clamp(0.0, CELLS as f64 - 1.0) as usize)
    }

    fn covers(&self, point: [f64; 2]) -> bool {
        let [i, j] = self.cell(point);
        self.cells[i * CELLS + j].iter().any(|&number| {
            let [a, b, c] = self.triangles[number as usize];
            let sides = [[a, b], [b, c], [c, a]].map(|[p, q]| signed_area(&[p, q, point]));
            sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_mesh::{Actuator, MeshSize};
    use pneuflex_model::{Contact, Formulation, Material, Problem};

    #[test]
    fn the_outline_of_two_chambers_is_their_profile_also_when_they_bend() {
        for formulation in [Formulation::Hex8Sri, Formulation::Hex27, Formulation::Tet15] {
            let actuator = Actuator::two_chambers();
            let problem = Problem::from_actuator(
                &actuator,
                &MeshSize::uniform(3.0),
                formulation,
                Material::default(),
                Contact::default(),
            )
            .unwrap();
            let surface = Surface::new(&problem);
            let rest = outline(&surface, &surface.positions(None));
            let length = |pieces: &[Piece]| pieces.iter().map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum::<f64>();
            // Several edges may lie behind each other: along the profile, which is 18 + 2 × 13 + 16 + 2 + 2 × 9 mm long, and nowhere else.
            let profile = [
                [0.0, 0.0],
                [18.0, 0.0],
                [18.0, 13.0],
                [10.0, 13.0],
                [10.0, 4.0],
                [8.0, 4.0],
                [8.0, 13.0],
                [0.0, 13.0],
                [0.0, 0.0],
            ];
            let profile = chain(&profile);
            assert!((length(&profile) - 80.0).abs() < 1e-12 && length(&rest) >= 80.0 - 1e-9, "{}", length(&rest));
            let far = |from: &[Piece], to: &[Piece]| {
                let middles = from
                    .iter()
                    .flat_map(|[a, b]| [0.1, 0.5, 0.9].map(|s| [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])]));
                let distance =
                    |p: [f64; 2]| nearest(to, p).map_or(f64::INFINITY, |(at, _)| (p[0] - at[0]).hypot(p[1] - at[1]));
                middles.map(distance).fold(0.0, f64::max)
            };
            assert!(far(&rest, &profile) < 1e-9 && far(&profile, &rest) < 1e-9, "{formulation}");
            // Turned as a whole, the outline turns.
            let (sin, cos) = 0.4_f64.sin_cos();
            let turn = |[x, z]: [f64; 2]| [cos * x + sin * z, cos * z - sin * x];
            let turned: Vec<[f64; 3]> = surface
                .positions(None)
                .iter()
                .map(|p| {
                    let [x, z] = turn([p[0], p[2]]);
                    [x, p[1], z]
                })
                .collect();
            let profile: Vec<Piece> = profile.iter().map(|piece| piece.map(turn)).collect();
            let turned = outline(&surface, &turned);
            assert!(far(&turned, &profile) < 1e-9 && far(&profile, &turned) < 1e-9, "{formulation}");
        }
    }
}
