//! Points of the bottom centreline of an actuator, such as markers on it, between the nodes of the mesh.

use pneuflex_model::Problem;

use crate::measures::centreline_nodes;

/// Length of the bottom centreline at rest, mm; 0 if the mesh has no node set `bottom_centreline`.
pub fn length(problem: &Problem) -> f64 {
    let nodes = centreline_nodes(problem);
    let x = |node: &u32| problem.mesh.nodes[*node as usize][0];
    nodes.last().zip(nodes.first()).map_or(0.0, |(last, first)| x(last) - x(first))
}

/// The point of the bottom centreline at a distance from the clamp at rest, mm: nodes, and the weights of their positions in its own; `None`
/// beyond the ends.
///
/// Between two nodes the line is the cubic with the slopes of the parabolas through them and their neighbours: where lengths move the nodes, the point
/// moves without a corner.
pub fn point(problem: &Problem, distance: f64) -> Option<Vec<(u32, f64)>> {
    let nodes = centreline_nodes(problem);
    let first = problem.mesh.nodes[*nodes.first()? as usize][0];
    let x: Vec<f64> = nodes.iter().map(|node| problem.mesh.nodes[*node as usize][0] - first).collect();
    let end = *x.last()?;
    // A point at the end is not lost to rounding.
    let distance = if (distance - end).abs() < 1e-9 * end { end } else { distance };
    let begins = (0..x.len().checked_sub(1)?).rev().find(|&i| x[i] <= distance).filter(|_| distance <= end)?;
    let mut weights = vec![0.0; x.len()];
    let width = x[begins + 1] - x[begins];
    let t = (distance - x[begins]) / width;
    weights[begins] += (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t);
    weights[begins + 1] += t * t * (3.0 - 2.0 * t);
    for (at, factor) in [(begins, t * (1.0 - t) * (1.0 - t)), (begins + 1, t * t * (t - 1.0))] {
        slope(&x, at).into_iter().for_each(|(node, weight)| weights[node] += factor * width * weight);
    }
    Some(nodes.into_iter().zip(weights).filter(|(_, weight)| *weight != 0.0).collect())
}

/// Weights of the values at nodes in the slope at one of them, of the parabola through it and its neighbours, or the two nodes next to an end.
fn slope(x: &[f64], at: usize) -> Vec<(usize, f64)> {
    if x.len() == 2 {
        let width = x[1] - x[0];
        return vec![(0, -1.0 / width), (1, 1.0 / width)];
    }
    let first = at.saturating_sub(1).min(x.len() - 3);
    let weight = |i: usize| {
        let others: Vec<usize> = (first..first + 3).filter(|j| *j != i).collect();
        let (a, b) = (x[others[0]], x[others[1]]);
        (2.0 * x[at] - a - b) / ((x[i] - a) * (x[i] - b))
    };
    (first..first + 3).map(|i| (i, weight(i))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::two_chambers;

    #[test]
    fn parabolas_are_exact_and_nothing_is_beyond_the_ends() {
        let problem = two_chambers(3.0);
        let end = length(&problem);
        assert_eq!(end, 18.0);
        for distance in [0.0, 0.3, 0.5 * end, 0.77 * end, end] {
            let weights = point(&problem, distance).unwrap();
            let sum = |f: fn(f64) -> f64| -> f64 {
                weights.iter().map(|(node, weight)| weight * f(problem.mesh.nodes[*node as usize][0])).sum()
            };
            assert!((sum(|_| 1.0) - 1.0).abs() < 1e-12 && (sum(|x| x * x) - distance * distance).abs() < 1e-9);
        }
        assert!(point(&problem, -0.1).is_none() && point(&problem, end + 0.1).is_none());
    }
}
