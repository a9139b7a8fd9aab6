//! The faces and nodes of a body whose traction is a known pressure, and how they are stretched.

use std::collections::{BTreeMap, BTreeSet};

use pneuflex_mesh::{FaceKind, Facet, Outline};
use pneuflex_model::Problem;
use pneuflex_model::load::Load;

use super::SurfaceState;
use super::patch::{Patch, Sample, TERMS, Tensor, area_vector, dual, plane, sampling_points, tangents, turn, unit};
use pneuflex_mesh::vector::{Vec3, cross, dot};

/// Least cosine of the angles between the normals of the faces at a node of a smooth surface and their mean.
const SMOOTH: f64 = 0.866;

/// A face whose traction is a known pressure.
pub struct KnownFace {
    kind: FaceKind,
    pub nodes: Vec<u32>,
}

/// A node around which the surface is smooth.
pub struct Place {
    pub faces: Vec<usize>,
    /// Axes of the planes of symmetry that it lies on: the surface goes on as its mirror image.
    pub planes: [bool; 3],
    pub normal: Vec3,
    pub deformed_normal: Vec3,
    pub pressure: f64,
    pub material: usize,
}

pub struct KnownSurface<'a> {
    rest: &'a [[f64; 3]],
    deformed: Vec<[f64; 3]>,
    pub faces: Vec<KnownFace>,
    pub nodes: BTreeMap<u32, Place>,
}

impl<'a> KnownSurface<'a> {
    pub fn of(problem: &'a Problem, state: &SurfaceState<'_>) -> Self {
        let mesh = &problem.mesh;
        let deformed = mesh.deformed(state.displacement);
        let (_, material_of) = problem.materials();
        let unknown = unknown_nodes(problem, state);
        let pressure_of = pressures(problem, state);
        let held = held_axes(problem);
        let mut faces = Vec::new();
        // Per node: its faces, with their pressure and material.
        let mut around: BTreeMap<u32, Vec<(usize, f64, usize)>> = BTreeMap::new();
        let (mut planes, mut clamped): (BTreeMap<u32, [bool; 3]>, BTreeSet<u32>) = Default::default();
        let mut open = Vec::new();
        for facet in mesh.boundary_facets() {
            let (kind, nodes) = (mesh.face_kind(facet), mesh.facet_nodes(facet));
            let axes: [bool; 3] = std::array::from_fn(|axis| nodes.iter().all(|&node| held[node as usize][axis]));
            open.push((facet, kind, nodes, axes));
        }
        // Where a body is one element thick, faces have nodes on other planes, too.
        for _ in 0..2 {
            open.retain(|(_, kind, nodes, axes)| {
                let is_explained = |axis: usize| nodes.iter().all(|node| planes.get(node).is_some_and(|at| at[axis]));
                let normal = unit(area_vector(*kind, nodes, &mesh.nodes, kind.centre()));
                let along = (0..3).find(|&axis| axes[axis] && normal[axis].abs() > 1.0 - 1e-9);
                let is_free = |along: usize| (0..3).all(|axis| axis == along || !axes[axis] || is_explained(axis));
                let plane = along.filter(|&along| is_free(along));
                if let Some(axis) = plane {
                    nodes.iter().for_each(|&node| planes.entry(node).or_default()[axis] = true);
                }
                plane.is_none()
            });
        }
        for (facet, kind, nodes, axes) in open {
            let is_plane = |node: u32, axis: usize| planes.get(&node).is_some_and(|planes| planes[axis]);
            if (0..3).any(|axis| axes[axis] && !nodes.iter().all(|&node| is_plane(node, axis))) {
                clamped.extend(nodes);
                continue;
            }
            let pressure = pressure_of.get(&facet).copied().unwrap_or(0.0);
            let material = usize::from(material_of[facet.element as usize]);
            let face = faces.len();
            nodes.iter().for_each(|&node| around.entry(node).or_default().push((face, pressure, material)));
            faces.push(KnownFace { kind, nodes });
        }
        let mut surface = Self { rest: &mesh.nodes, deformed, faces, nodes: BTreeMap::new() };
        for (node, faces) in around {
            let planes = planes.get(&node).copied().unwrap_or_default();
            let is_held = (0..3).any(|axis| held[node as usize][axis] && !planes[axis]);
            let is_one = faces.iter().all(|face| (face.1, face.2) == (faces[0].1, faces[0].2));
            if is_held || !is_one || clamped.contains(&node) || unknown.contains(&node) {
                continue;
            }
            let (_, pressure, material) = faces[0];
            let faces: Vec<usize> = faces.into_iter().map(|face| face.0).collect();
            let normals = [surface.rest, &surface.deformed[..]].map(|at| surface.normal(node, &faces, planes, at));
            if let [Some(normal), Some(deformed_normal)] = normals {
                surface.nodes.insert(node, Place { faces, planes, normal, deformed_normal, pressure, material });
            }
        }
        surface
    }

    /// The mean unit normal of some faces at a node, and of their mirror images; `None` at an edge.
    fn normal(&self, node: u32, faces: &[usize], planes: [bool; 3], positions: &[[f64; 3]]) -> Option<Vec3> {
        let normals: Vec<Vec3> = faces
            .iter()
            .map(|&face| {
                let KnownFace { kind, nodes } = &self.faces[face];
                area_vector(*kind, nodes, positions, self.place_on(face, node))
            })
            .map(unit)
            .collect();
        let along = |d: usize| if planes[d] { 0.0 } else { normals.iter().map(|n| n[d]).sum() };
        let mean = unit(std::array::from_fn(along));
        normals.iter().all(|&n| dot(n, mean) > SMOOTH).then_some(mean)
    }

    /// Reference coordinates of a node on one of its faces.
    fn place_on(&self, face: usize, node: u32) -> [f64; 2] {
        let KnownFace { kind, nodes } = &self.faces[face];
        let local = nodes.iter().position(|&n| n == node).unwrap_or_default();
        kind.nodes[local]
    }

    /// U_s² at every node that a patch reaches. Patches are around corners; one of its own has a node all of whose corners are at edges.
    pub fn stretches(&self) -> BTreeMap<u32, Tensor> {
        let of_face = |KnownFace { kind, nodes }: &KnownFace| -> Vec<Sample> {
            sampling_points(*kind).into_iter().map(|xi| self.sample(*kind, nodes, xi)).collect()
        };
        let samples: Vec<Vec<Sample>> = self.faces.iter().map(of_face).collect();
        let mut patches: BTreeMap<u32, Patch> = BTreeMap::new();
        for (&node, place) in &self.nodes {
            if self.is_corner(node, place)
                && let Some(patch) = self.patch(node, place, &samples)
            {
                patches.insert(node, patch);
            }
        }
        let mut stretches = BTreeMap::new();
        for (&node, place) in &self.nodes {
            let around = place.faces.iter().flat_map(|&face| {
                let KnownFace { kind, nodes } = &self.faces[face];
                nodes[..kind.num_corners()].iter().copied()
            });
            let corners: BTreeSet<u32> =
                if self.is_corner(node, place) { [node].into() } else { self.nearest_corners(node, place, around) };
            let own = corners.iter().filter_map(|corner| patches.get(corner)).map(|patch| self.at(patch, node, place));
            let mut values: Vec<Tensor> = own.collect();
            if values.is_empty()
                && let Some(patch) = self.patch(node, place, &samples)
            {
                values.push(self.at(&patch, node, place));
            }
            if values.is_empty() {
                continue;
            }
            let count = values.len() as f64;
            let mean = std::array::from_fn(|i| {
                std::array::from_fn(|j| values.iter().map(|value| value[i][j]).sum::<f64>() / count)
            });
            stretches.insert(node, mean);
        }
        stretches
    }

    fn is_corner(&self, node: u32, place: &Place) -> bool {
        let KnownFace { kind, nodes } = &self.faces[place.faces[0]];
        nodes[..kind.num_corners()].contains(&node)
    }

    /// The corners at the ends of a node's edge, or all of its face's if it lies inside.
    fn nearest_corners(&self, node: u32, place: &Place, around: impl Iterator<Item = u32>) -> BTreeSet<u32> {
        let KnownFace { kind, nodes } = &self.faces[place.faces[0]];
        let edge =
            kind.edges().enumerate().find(|&(edge, _)| kind.middle_of_edge(edge).is_some_and(|m| nodes[m] == node));
        match edge {
            Some((_, ends)) => ends.map(|end| nodes[end]).into(),
            None => around.collect(),
        }
    }

    fn patch(&self, node: u32, place: &Place, samples: &[Vec<Sample>]) -> Option<Patch> {
        let mut samples: Vec<Sample> = place.faces.iter().flat_map(|&face| &samples[face]).copied().collect();
        let centre = self.rest[node as usize];
        for axis in (0..3).filter(|&axis| place.planes[axis]) {
            let mirrored: Vec<Sample> = samples.iter().map(|sample| sample.mirrored(axis, centre[axis])).collect();
            samples.extend(mirrored);
        }
        let kind = self.faces[place.faces[0]].kind;
        // The points of triangles are no better than others: a polynomial must smooth them.
        let is_enough = kind.outline == Outline::Square || samples.len() >= 2 * TERMS;
        Patch::fit(centre, place.normal, &samples, !kind.is_linear() && is_enough)
    }

    fn sample(&self, kind: FaceKind, nodes: &[u32], xi: [f64; 2]) -> Sample {
        let [position, a, b] = tangents(kind, nodes, self.rest, xi);
        let [_, da, db] = tangents(kind, nodes, &self.deformed, xi);
        let normal = unit(cross(a, b));
        let dual = dual([a, b], normal);
        let metric = [[dot(da, da), dot(da, db)], [dot(db, da), dot(db, db)]];
        let tensor = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                (0..2)
                    .flat_map(|p| (0..2).map(move |q| (p, q)))
                    .map(|(p, q)| metric[p][q] * dual[p][i] * dual[q][j])
                    .sum()
            })
        });
        Sample { position, normal, tensor }
    }

    /// A patch's value at a node, turned into its tangent plane.
    fn at(&self, patch: &Patch, node: u32, place: &Place) -> Tensor {
        let [xx, yy, xy] = patch.value(self.rest[node as usize]);
        let axes = patch.axes.map(|axis| turn(axis, patch.normal, place.normal));
        let c = [[xx, xy], [xy, yy]];
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                (0..2).flat_map(|p| (0..2).map(move |q| (p, q))).map(|(p, q)| c[p][q] * axes[p][i] * axes[q][j]).sum()
            })
        })
    }

    /// The axes of the tangent plane at rest as the surface turns them.
    pub fn turned_axes(&self, node: u32, place: &Place, axes: [Vec3; 2]) -> [Vec3; 2] {
        let mut map: Tensor = [[0.0; 3]; 3];
        for &face in &place.faces {
            let (KnownFace { kind, nodes }, xi) = (&self.faces[face], self.place_on(face, node));
            let [_, a, b] = tangents(*kind, nodes, self.rest, xi);
            let [_, da, db] = tangents(*kind, nodes, &self.deformed, xi);
            let dual = dual([a, b], unit(cross(a, b)));
            for i in 0..3 {
                for j in (0..3).filter(|&j| (0..3).all(|axis| !place.planes[axis] || (i == axis) == (j == axis))) {
                    map[i][j] += da[i] * dual[0][j] + db[i] * dual[1][j];
                }
            }
        }
        let moved = axes.map(|axis| -> Vec3 { map.map(|row| dot(row, axis)) });
        // The rotation next to the map in the plane (polar decomposition in two dimensions).
        let [e, f] = plane(place.deformed_normal);
        let cosine = dot(e, moved[0]) + dot(f, moved[1]);
        let sine = dot(f, moved[0]) - dot(e, moved[1]);
        let length = cosine.hypot(sine);
        let (c, s) = (cosine / length, sine / length);
        [std::array::from_fn(|d| c * e[d] + s * f[d]), std::array::from_fn(|d| c * f[d] - s * e[d])]
    }
}

/// Axes along which every node is held.
fn held_axes(problem: &Problem) -> Vec<[bool; 3]> {
    let mut held = vec![[false; 3]; problem.mesh.num_nodes()];
    for support in &problem.supports {
        for &node in &support.nodes {
            (0..3).for_each(|axis| held[node as usize][axis] |= support.axes[axis]);
        }
    }
    held
}

/// Nodes at which something acts that is no pressure.
fn unknown_nodes(problem: &Problem, state: &SurfaceState<'_>) -> BTreeSet<u32> {
    let mesh = &problem.mesh;
    let mut nodes = BTreeSet::new();
    for load in &problem.loads {
        match load {
            Load::Force { nodes: loaded, .. } => nodes.extend(loaded.iter().map(|&(node, _)| node)),
            Load::Traction { facets, .. } => nodes.extend(facets.iter().flat_map(|&facet| mesh.facet_nodes(facet))),
            Load::Pressure { .. } | Load::Gravity { .. } => {}
        }
    }
    nodes.extend(problem.equations.iter().flat_map(|equation| equation.terms.iter().map(|term| term.0)));
    let pairs = problem.contact_pairs.iter().zip(&state.contact.facet_force);
    let walls =
        pairs.flat_map(|(pair, [slave, master])| pair.slave.iter().zip(slave).chain(pair.master.iter().zip(master)));
    let obstacles = problem.obstacles.iter().zip(&state.contact.obstacles);
    let touching = walls.chain(obstacles.flat_map(|(obstacle, now)| obstacle.facets.iter().zip(&now.facet_force)));
    nodes.extend(touching.filter(|(_, force)| **force != [0.0; 3]).flat_map(|(&facet, _)| mesh.facet_nodes(facet)));
    nodes
}

/// Pressure on faces that have one, MPa.
fn pressures(problem: &Problem, state: &SurfaceState<'_>) -> BTreeMap<Facet, f64> {
    let mut all = BTreeMap::new();
    let mut add =
        |facets: &[Facet], pressure: f64| facets.iter().for_each(|&facet| *all.entry(facet).or_insert(0.0) += pressure);
    problem.cavities.iter().zip(state.pressures).for_each(|(cavity, pressure)| add(&cavity.facets, pressure.mpa()));
    for load in &problem.loads {
        if let Load::Pressure { facets, curve } = load {
            add(facets, curve.at(state.parameter));
        }
    }
    all
}
