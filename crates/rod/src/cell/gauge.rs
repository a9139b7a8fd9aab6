//! Where the curvature of a cell is read, and how.

use pneuflex_mesh::Actuator;
use pneuflex_model::Problem;

use super::error::CellError;
use super::plane::best_motion;

/// Where curvature is read.
pub struct Gauge {
    /// Reference x of the chambers' middles, mm.
    stations: [f64; 2],
    /// Height of the base, mm.
    base: f64,
}

impl Gauge {
    /// In the middles of the chambers of a cell.
    pub fn new(actuator: &Actuator) -> Self {
        let row = actuator.row();
        let middle = |i: usize| row.get(i).map_or(f64::NAN, |chamber| 0.5 * (chamber.start + chamber.end));
        Self { stations: [middle(0), middle(1)], base: actuator.base.min(actuator.floor()) }
    }

    fn length(&self) -> f64 {
        self.stations[1] - self.stations[0]
    }

    /// Curvature of the bottom, 1/mm, positive downwards.
    ///
    /// # Errors
    /// A mesh that ends before.
    pub fn curvature(&self, problem: &Problem, displacement: &[[f64; 3]]) -> Result<f64, CellError> {
        let angles = self.stations.map(|x| section_angle(problem, displacement, x, self.base));
        let [Some(a), Some(b)] = angles else {
            return Err(CellError::ShortMesh);
        };
        Ok((b - a) / self.length())
    }

    /// Change in length of the bottom between the stations, as a share.
    pub fn stretch(&self, problem: &Problem, displacement: &[[f64; 3]]) -> f64 {
        let points: Vec<[f64; 3]> = bottom(problem, displacement);
        let inside = |p: &&[[f64; 3]]| {
            let middle = 0.5 * (p[0][0] + p[1][0]);
            middle > self.stations[0] && middle < self.stations[1]
        };
        let (before, after) = points
            .windows(2)
            .filter(|p| inside(p))
            .fold((0.0, 0.0), |(a, b), p| (a + p[1][0] - p[0][0], b + (p[1][1] - p[0][1]).hypot(p[1][2] - p[0][2])));
        if before > 0.0 { after / before - 1.0 } else { 0.0 }
    }
}

/// Bottom centreline from the clamp on: reference x, deformed x and z, mm.
fn bottom(problem: &Problem, displacement: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mesh = &problem.mesh;
    let mut points: Vec<[f64; 3]> = mesh
        .node_set("bottom_centreline")
        .iter()
        .map(|&n| {
            let (n, at) = (n as usize, mesh.nodes[n as usize]);
            [at[0], at[0] + displacement[n][0], at[2] + displacement[n][2]]
        })
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// Rotation of the base's cross-section at a reference x, rad, positive downwards: the best-fitting one over its area. Where no faces of
/// elements lie there, that of the sections to either side by their distance. `None` beyond the mesh.
fn section_angle(problem: &Problem, displacement: &[[f64; 3]], x: f64, base: f64) -> Option<f64> {
    let mesh = &problem.mesh;
    let mut is_corner = vec![false; mesh.num_nodes()];
    for element in 0..mesh.num_elements() {
        mesh.corners(element).iter().for_each(|&node| is_corner[node as usize] = true);
    }
    let corners = mesh.node_set("bottom_centreline").iter().filter(|&&node| is_corner[node as usize]);
    let mut lines: Vec<f64> = corners.map(|&node| mesh.nodes[node as usize][0]).collect();
    lines.sort_by(f64::total_cmp);
    let tolerance = 1e-6 * lines.last()?;
    let before = lines.iter().copied().rfind(|at| *at <= x + tolerance)?;
    let after = lines.iter().copied().find(|at| *at >= x - tolerance)?;
    let [a, b] = [before, after].map(|at| {
        let in_section = |p: [f64; 3]| (p[0] - at).abs() <= tolerance && p[2] <= base + tolerance;
        best_motion(problem, &problem.mesh.select_nodes(in_section), displacement)[2]
    });
    let share = if after - before > tolerance { (x - before) / (after - before) } else { 0.0 };
    Some(a + share * (b - a))
}
