//! Rigid bodies as equations that hold for rotations of any size.
//!
//! A rigid motion is affine, so every node of a rigid body follows up to four of them that span it: u = Σ λ_m u_m with the coordinates λ of its
//! position between theirs. An affine motion is rigid if these keep their distances. Where two rotations are held, or all three, less
//! is needed: a motion in the plane across the axis is that of two nodes, and what does not turn moves as its reference does.

use pneuflex_mesh::vector::{cross, dot, norm, sub};
use pneuflex_model::{Curve, LinearEquation};

/// What is flat or straight up to this share of its size is taken so.
const FLAT: f64 = 1e-6;

/// The equations and fixed distances of one rigid body.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Bound {
    pub equations: Vec<LinearEquation>,
    pub distances: Vec<[u32; 2]>,
}

/// Binds nodes to the first of them, with the rotations about x, y and z that are held; only the directions `axes` of the others follow.
/// `positions` are those of all nodes.
///
/// # Errors
/// What cannot be said exactly, in words.
pub(super) fn bind(
    positions: &[[f64; 3]],
    nodes: &[u32],
    axes: [bool; 3],
    held_rotations: [bool; 3],
) -> Result<Bound, String> {
    let Some((&first, others)) = nodes.split_first() else { return Ok(Bound::default()) };
    let free: Vec<usize> = (0..3).filter(|&k| !held_rotations[k]).collect();
    let from_first = |node: u32| sub(positions[node as usize], positions[first as usize]);
    let mut bound = Bound::default();
    if free.is_empty() {
        for &node in others {
            (0..3).filter(|&k| axes[k]).for_each(|k| bound.equation(node, k, &[(first, k, 1.0)]));
        }
        return Ok(bound);
    }
    if axes != [true; 3] {
        return Err("single directions can be coupled only where all rotations of the reference node are held \
                    (*BOUNDARY, 4 to 6): couple all three directions, or write *EQUATION"
            .to_owned());
    }
    match free[..] {
        [axis] => {
            let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
            let arm = |node: u32| [from_first(node)[p], from_first(node)[q]];
            let size = |node: u32| arm(node)[0].hypot(arm(node)[1]);
            let Some(&second) = others.iter().max_by(|a, b| size(**a).total_cmp(&size(**b))) else { return Ok(bound) };
            let [a, b] = arm(second);
            let squared = a * a + b * b;
            let is_line = others.iter().all(|&node| size(node) <= FLAT * norm(from_first(node)));
            for &node in others {
                bound.equation(node, axis, &[(first, axis, 1.0)]);
                let [x, y] = arm(node);
                // (x + iy) = (α + iβ)(a + ib), at rest and ever after.
                let (alpha, beta) = ((x * a + y * b) / squared, (y * a - x * b) / squared);
                if is_line || squared == 0.0 {
                    bound.equation(node, p, &[(first, p, 1.0)]);
                    bound.equation(node, q, &[(first, q, 1.0)]);
                } else if node != second {
                    let own = [(first, p, 1.0 - alpha), (first, q, beta), (second, p, alpha), (second, q, -beta)];
                    bound.equation(node, p, &own);
                    let own = [(first, q, 1.0 - alpha), (first, p, -beta), (second, q, alpha), (second, p, beta)];
                    bound.equation(node, q, &own);
                }
            }
            if !is_line && squared > 0.0 {
                bound.distances.push([first, second]);
            }
            Ok(bound)
        }
        [_, _] => Err("one rotation is held and two are free: hold two of them, all three, or none; or hold nodes of the body instead"
            .to_owned()),
        _ => {
            let frame = Frame::of(positions, nodes);
            for &node in others.iter().filter(|node| !frame.nodes.contains(node)) {
                let shares = frame.coordinates(from_first(node));
                for k in 0..3 {
                    let terms: Vec<_> = frame.nodes.iter().zip(&shares).map(|(&m, &share)| (m, k, share)).collect();
                    bound.equation(node, k, &terms);
                }
            }
            for (i, &a) in frame.nodes.iter().enumerate() {
                bound.distances.extend(frame.nodes[..i].iter().map(|&b| [a, b]));
            }
            Ok(bound)
        }
    }
}

impl Bound {
    /// u of a node along an axis is a sum of others.
    fn equation(&mut self, node: u32, axis: usize, others: &[(u32, usize, f64)]) {
        let others = others.iter().filter(|(.., share)| share.abs() > 1e-14);
        let others = others.map(|&(other, axis, share)| (other, axis as u8, -share));
        let terms = std::iter::once((node, axis as u8, 1.0)).chain(others).collect();
        self.equations.push(LinearEquation { terms, value: Curve::ZERO });
    }
}

/// Nodes that span a rigid body, the first of them its reference.
struct Frame {
    nodes: Vec<u32>,
    /// Vectors whose products with a position are its coordinates along the edges from the first node.
    reciprocal: [[f64; 3]; 3],
}

impl Frame {
    /// The first node, that furthest from it, that furthest from the line through both, that furthest from the plane through all three; fewer
    /// where all lie in one plane, line or point.
    fn of(positions: &[[f64; 3]], nodes: &[u32]) -> Self {
        let at = |node: u32| sub(positions[node as usize], positions[nodes[0] as usize]);
        let furthest = |distance: &dyn Fn([f64; 3]) -> f64| {
            nodes
                .iter()
                .map(|&node| (distance(at(node)), node))
                .fold((0.0, nodes[0]), |best, other| if other.0 > best.0 { other } else { best })
        };
        let mut frame = Self { nodes: vec![nodes[0]], reciprocal: [[0.0; 3]; 3] };
        let (size, second) = furthest(&norm);
        if size == 0.0 {
            return frame;
        }
        frame.nodes.push(second);
        let along = at(second);
        let (width, third) = furthest(&|x| norm(cross(x, along)) / size);
        if width <= FLAT * size {
            frame.reciprocal[0] = along.map(|t| t / (size * size));
            return frame;
        }
        frame.nodes.push(third);
        let across = at(third);
        let normal = cross(along, across);
        let (height, fourth) = furthest(&|x| dot(x, normal).abs() / norm(normal));
        let last = if height <= FLAT * size { normal } else { at(fourth) };
        let volume = dot(normal, last);
        frame.reciprocal = [cross(across, last), cross(last, along), normal].map(|edge| edge.map(|t| t / volume));
        if height > FLAT * size {
            frame.nodes.push(fourth);
        }
        frame
    }

    /// Shares of the frame's nodes in what is linear in the position, at a vector from the first of them.
    fn coordinates(&self, x: [f64; 3]) -> Vec<f64> {
        let others: Vec<f64> = self.reciprocal[..self.nodes.len() - 1].iter().map(|edge| dot(*edge, x)).collect();
        std::iter::once(1.0 - others.iter().sum::<f64>()).chain(others).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A turn about an axis through a point off the body, and a shift.
    fn moved(x: [f64; 3], axis: [f64; 3], angle: f64) -> [f64; 3] {
        let n = axis.map(|t| t / norm(axis));
        let x = sub(x, [0.3, -0.2, 0.7]);
        let (along, side) = (dot(n, x), cross(n, x));
        std::array::from_fn(|k| {
            angle.cos() * x[k] + angle.sin() * side[k] + (1.0 - angle.cos()) * along * n[k] + [5.0, 1.0, -2.0][k]
        })
    }

    fn cloud(flat: [f64; 3]) -> Vec<[f64; 3]> {
        (0..12)
            .map(|i| {
                let t = f64::from(i);
                [1.0 + flat[0] * t.sin(), 2.0 + flat[1] * (2.3 * t).cos(), flat[2] * (0.7 * t + 1.0).sin()]
            })
            .collect()
    }

    fn violation(bound: &Bound, positions: &[[f64; 3]], now: &[[f64; 3]]) -> f64 {
        let u = |node: u32, axis: u8| now[node as usize][axis as usize] - positions[node as usize][axis as usize];
        let equation = |e: &LinearEquation| e.terms.iter().map(|&(n, k, c)| c * u(n, k)).sum::<f64>().abs();
        let length = |x: &[[f64; 3]], [a, b]: [u32; 2]| norm(sub(x[a as usize], x[b as usize]));
        let distance = |&pair: &[u32; 2]| (length(now, pair) - length(positions, pair)).abs();
        bound.equations.iter().map(equation).chain(bound.distances.iter().map(distance)).fold(0.0, f64::max)
    }

    /// Every rigid motion that the held rotations leave satisfies all equations, and as many constraints are there as leave just these.
    #[test]
    fn rigid_motions_and_no_others_are_left() {
        let nodes: Vec<u32> = (0..12).collect();
        // Unknowns that are left: 3 translations, and rotations by what the shape is.
        for (flat, held, axis, left) in [
            ([1.0, 2.0, 1.5], [false; 3], [1.0, -2.0, 0.5], 6),
            ([1.0, 2.0, 0.0], [false; 3], [1.0, -2.0, 0.5], 6),
            ([1.0, 0.0, 0.0], [false; 3], [1.0, -2.0, 0.5], 5),
            ([1.0, 2.0, 1.5], [true, true, false], [0.0, 0.0, 1.0], 4),
            ([1.0, 2.0, 1.5], [true, false, true], [0.0, 1.0, 0.0], 4),
            ([0.0, 2.0, 0.0], [true, false, true], [0.0, 1.0, 0.0], 3),
            ([1.0, 2.0, 1.5], [true; 3], [1.0, 0.0, 0.0], 3),
        ] {
            let positions = cloud(flat);
            let bound = bind(&positions, &nodes, [true; 3], held).unwrap();
            let angle = if held == [true; 3] { 0.0 } else { 2.5 };
            let now: Vec<[f64; 3]> = positions.iter().map(|&x| moved(x, axis, angle)).collect();
            assert!(violation(&bound, &positions, &now) < 1e-12, "{flat:?} {held:?}");
            assert_eq!(36 - bound.equations.len() - bound.distances.len(), left, "{flat:?} {held:?}");
            let stretched: Vec<[f64; 3]> = positions.iter().map(|x| x.map(|t| 1.1 * t)).collect();
            assert!(violation(&bound, &positions, &stretched) > 0.01, "{flat:?} {held:?}");
        }
    }

    #[test]
    fn what_cannot_be_said_exactly_is_refused() {
        let positions = cloud([1.0; 3]);
        assert!(bind(&positions, &[0, 1], [true; 3], [true, false, false]).is_err());
        assert!(bind(&positions, &[0, 1], [true, false, true], [false; 3]).is_err());
        assert_eq!(bind(&positions, &[0, 1], [true, false, true], [true; 3]).unwrap().equations.len(), 2);
    }
}
