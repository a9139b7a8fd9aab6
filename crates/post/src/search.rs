//! The closest point on a surface of many faces: a tree of boxes over exact projections.

use std::collections::BTreeMap;

use pneuflex_mesh::{Facet, Mesh};
use pneuflex_model::Problem;

use crate::surface::{Bounds, Patch, Projection, edge_distances};
use pneuflex_mesh::vector::Vec3;

/// A deformed surface that can be asked for its closest point.
pub struct Surface {
    patches: Vec<Patch>,
    /// For every patch whether the surface ends at its in the order of [`edges`].
    open_edges: Vec<[bool; 4]>,
    tree: Vec<Branch>,
    /// Patches in the order of the tree's leaves.
    order: Vec<u32>,
}

struct Branch {
    bounds: Bounds,
    /// Range of `order`.
    first: u32,
    last: u32,
    /// Index of the second child; the first follows its parent. 0 for a leaf.
    second: u32,
}

/// The closest point of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Closest {
    /// Index of the face in the list the surface was made of.
    pub facet: usize,
    /// Signed distance, mm: negative behind the surface, on the side its normals point away from.
    ///
    /// A point whose closest point lies on an end of the surface, and that is further to the side than behind, is next
    /// to the surface and not behind it: its distance is positive.
    pub signed_distance: f64,
}

const LEAF: usize = 4;

/// Reference points this near an edge are on it: rounding keeps sums of coordinates from being exact.
const ON_EDGE: f64 = 1e-12;

impl Surface {
    /// The surface of some facets in a deformed state.
    ///
    /// Edges on a symmetry plane (all their nodes held along exactly one axis by the same support) do not count as an
    /// end: the body goes on behind the plane.
    pub fn new(problem: &Problem, facets: &[Facet], displacement: &[[f64; 3]]) -> Self {
        let patches: Vec<Patch> = facets.iter().map(|&f| Patch::new(&problem.mesh, f, Some(displacement))).collect();
        let bounds: Vec<Bounds> = patches.iter().map(Patch::bounds).collect();
        let mut order: Vec<u32> = (0..patches.len() as u32).collect();
        let mut tree = Vec::new();
        if !order.is_empty() {
            grow(&mut tree, &mut order, 0, &bounds);
        }
        Self { patches, open_edges: open_edges(problem, facets), tree, order }
    }

    /// The closest point, or `None` if the surface has no faces. `hint` is a face likely to be close.
    pub fn closest(&self, point: Vec3, hint: Option<usize>) -> Option<Closest> {
        if self.tree.is_empty() {
            return None;
        }
        let mut best: Option<(usize, Projection)> = None;
        if let Some(facet) = hint {
            best = Some((facet, self.patches[facet].closest(point)));
        }
        let mut stack = vec![0_u32];
        while let Some(index) = stack.pop() {
            let branch = &self.tree[index as usize];
            if best.is_some_and(|(_, p)| branch.bounds.distance(point) > p.distance) {
                continue;
            }
            if branch.second == 0 {
                for &facet in &self.order[branch.first as usize..branch.last as usize] {
                    let facet = facet as usize;
                    if Some(facet) == hint {
                        continue;
                    }
                    if best.is_some_and(|(_, p)| self.patches[facet].bounds().distance(point) > p.distance) {
                        continue;
                    }
                    let candidate = self.patches[facet].closest(point);
                    if best.is_none_or(|(f, p)| is_better((facet, &candidate), (f, &p))) {
                        best = Some((facet, candidate));
                    }
                }
            } else {
                let children = [index + 1, branch.second];
                let [a, b] = children.map(|c| self.tree[c as usize].bounds.distance(point));
                // The nearer child is looked at first: it comes last on the stack.
                stack.extend(if a < b { [children[1], children[0]] } else { children });
            }
        }
        best.map(|(facet, projection)| Closest { facet, signed_distance: self.signed_distance(facet, &projection) })
    }

    fn signed_distance(&self, facet: usize, projection: &Projection) -> f64 {
        if projection.normal_distance >= 0.0 {
            return projection.distance;
        }
        let at = edge_distances(self.patches[facet].kind(), projection.xi).map(|distance| distance <= ON_EDGE);
        let ends_here = at.iter().zip(&self.open_edges[facet]).any(|(at, open)| *at && *open);
        let beside = projection.normal_distance.abs() < projection.distance * std::f64::consts::FRAC_1_SQRT_2;
        if ends_here && beside { projection.distance } else { -projection.distance }
    }
}

/// Nearer wins. At an edge shared by two faces both are equally near: the one that looks at the point more directly has
/// the reliable sign, then the lower number.
fn is_better((facet, candidate): (usize, &Projection), (other, best): (usize, &Projection)) -> bool {
    let tolerance = 1e-9 * (1e-3 + best.distance);
    if (candidate.distance - best.distance).abs() > tolerance {
        return candidate.distance < best.distance;
    }
    let (a, b) = (candidate.normal_distance.abs(), best.normal_distance.abs());
    if (a - b).abs() > tolerance { a > b } else { facet < other }
}

fn grow(tree: &mut Vec<Branch>, order: &mut [u32], first: u32, bounds: &[Bounds]) {
    let all = order.iter().fold(Bounds::EMPTY, |b, &i| b.join(&bounds[i as usize]));
    let here = tree.len();
    tree.push(Branch { bounds: all, first, last: first + order.len() as u32, second: 0 });
    if order.len() <= LEAF {
        return;
    }
    let extent: Vec3 = std::array::from_fn(|d| all.high[d] - all.low[d]);
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    order.sort_by(|&a, &b| {
        bounds[a as usize].centre()[axis].total_cmp(&bounds[b as usize].centre()[axis]).then(a.cmp(&b))
    });
    let middle = order.len() / 2;
    let (low, high) = order.split_at_mut(middle);
    grow(tree, low, first, bounds);
    tree[here].second = tree.len() as u32;
    grow(tree, high, first + middle as u32, bounds);
}

fn open_edges(problem: &Problem, facets: &[Facet]) -> Vec<[bool; 4]> {
    let mesh: &Mesh = &problem.mesh;
    let mirror: Vec<bool> = {
        let mut on_plane = vec![false; mesh.num_nodes()];
        for support in problem.supports.iter().filter(|s| s.axes.iter().filter(|held| **held).count() == 1) {
            for &node in &support.nodes {
                on_plane[node as usize] = true;
            }
        }
        on_plane
    };
    let edges_of = |facet: Facet| -> Vec<[u32; 2]> {
        let nodes = mesh.facet_nodes(facet);
        mesh.face_kind(facet).edges().map(|[a, b]| [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])]).collect()
    };
    let mut uses: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for &facet in facets {
        for edge in edges_of(facet) {
            *uses.entry(edge).or_default() += 1;
        }
    }
    facets
        .iter()
        .map(|&facet| {
            let mut open = [false; 4];
            for (open, edge) in open.iter_mut().zip(edges_of(facet)) {
                *open = uses[&edge] == 1 && !(mirror[edge[0] as usize] && mirror[edge[1] as usize]);
            }
            open
        })
        .collect()
}
