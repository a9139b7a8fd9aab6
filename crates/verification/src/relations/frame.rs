//! Another way to look at a problem: turned, mirrored, moved to other units of length and stress.
//!
//! The equations know no direction and no unit: with X' = ℓ R X, stresses s P and forces s ℓ² R f, an equilibrium stays one (theory §2).

use pneuflex::mesh::{Facet, Mesh, ReferenceBody};
use pneuflex::model::model_file::{
    CavityTable, ContactTable, EquationTable, ForceTable, GravityTable, Model, PressureTable, RegionTable, Series,
    Steps, SupportTable, TractionTable,
};
use pneuflex::model::{Choice, Material, ObstacleTable, Probe, ShapeName};

/// X' = `length` · `turn` X, stresses times `stress`.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// An orthogonal matrix whose entries are 0, 1 and −1.
    pub turn: [[f64; 3]; 3],
    /// Lengths in the second over those in the first.
    pub length: f64,
    /// The same for stresses.
    pub stress: f64,
    /// The same for times.
    pub time: f64,
}

impl Frame {
    /// Nothing changes.
    pub const SAME: Self =
        Self { turn: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], length: 1.0, stress: 1.0, time: 1.0 };

    /// −1 for a mirror image.
    pub fn determinant(&self) -> f64 {
        let [a, b, c] = self.turn;
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    }

    /// A direction.
    pub fn direction(&self, v: [f64; 3]) -> [f64; 3] {
        // Without the negative zeros of a product of matrices.
        self.turn.map(|row| (0..3).map(|k| row[k] * v[k]).sum::<f64>() + 0.0)
    }

    /// A point, or a displacement.
    pub fn point(&self, x: [f64; 3]) -> [f64; 3] {
        self.direction(x).map(|t| self.length * t)
    }

    /// A force.
    pub fn force(&self, f: [f64; 3]) -> [f64; 3] {
        self.direction(f).map(|t| self.stress * self.length * self.length * t)
    }

    /// A moment: a pseudo-vector.
    pub fn moment(&self, m: [f64; 3]) -> [f64; 3] {
        self.direction(m).map(|t| self.determinant() * self.stress * self.length.powi(3) * t)
    }

    /// Lengths along the axes, which have no sign.
    fn lengths(&self, size: [f64; 3]) -> [f64; 3] {
        self.turn.map(|row| self.length * (0..3).map(|k| row[k].abs() * size[k]).sum::<f64>())
    }

    /// Where an axis goes, and its sign.
    fn axis(&self, axis: char) -> (char, f64) {
        let from = "xyz".find(axis).unwrap_or(0);
        let to = (0..3).find(|&row| self.turn[row][from] != 0.0).unwrap_or(0);
        ("xyz".as_bytes()[to].into(), self.turn[to][from])
    }

    fn axes(&self, axes: &str) -> String {
        axes.chars().map(|axis| self.axis(axis).0).collect()
    }

    fn series(&self, series: &Series, scale: f64) -> Series {
        match series {
            Series::End(value) => Series::End(scale * value),
            Series::Points(points) => Series::Points(points.iter().map(|[t, v]| [self.time * t, scale * v]).collect()),
        }
    }

    fn factor(&self, factor: Option<&Series>) -> Option<Series> {
        factor.map(|series| self.series(series, 1.0))
    }

    /// A material.
    pub fn material(&self, material: &Material) -> Material {
        let s = self.stress;
        Material { law: material.law.scaled(s), bulk_modulus: s * material.bulk_modulus, ..material.clone() }
    }

    fn choice(&self, choice: &Choice) -> Choice {
        choice.moved(&|x| self.point(x), &|v| self.direction(v), self.length)
    }

    fn obstacle(&self, table: &ObstacleTable) -> ObstacleTable {
        let ObstacleTable {
            name,
            shape,
            faces,
            point,
            normal,
            centre,
            axis,
            radius,
            hollow,
            size,
            edge_radius,
            stiffness,
            penetration_tolerance,
            displacement,
            factor,
            interference,
            report_force,
        } = table.clone();
        let length = |x: f64| self.length * x;
        ObstacleTable {
            name,
            shape: match shape {
                ShapeName::Plane | ShapeName::Sphere | ShapeName::Cylinder | ShapeName::Cuboid => shape,
            },
            faces: faces.map(|faces| self.choice(&faces)),
            point: point.map(|x| self.point(x)),
            normal: normal.map(|v| self.direction(v)),
            centre: centre.map(|x| self.point(x)),
            axis: axis.map(|v| self.direction(v)),
            radius: radius.map(length),
            hollow,
            size: size.map(|size| self.lengths(size)),
            edge_radius: edge_radius.map(length),
            stiffness: stiffness.map(|k| k * self.stress / self.length),
            penetration_tolerance: penetration_tolerance.map(|depth| self.length * depth),
            displacement: displacement.map(|u| self.point(u)),
            factor: self.factor(factor.as_ref()),
            interference,
            report_force,
        }
    }

    /// The tables of a model whose body comes from a mesh.
    pub fn model(&self, model: &Model) -> Model {
        let Model {
            title,
            model: source,
            actuator,
            mesh,
            material,
            regions,
            supports,
            equations,
            cavities,
            forces,
            tractions,
            pressures,
            gravity,
            contacts,
            obstacles,
            load,
            probes,
            solver,
            output,
        } = model.clone();
        let (stress, volume) = (self.stress, self.length.powi(3));
        let per_length = stress / self.length;
        let time = |step: Option<f64>| step.map(|step| self.time * step);
        let Steps {
            tolerance,
            residual_tolerance,
            max_iterations,
            first_step,
            max_step,
            min_step,
            continuation,
            states_past_limit,
            imperfection,
        } = solver;
        Model {
            title,
            model: source,
            actuator,
            mesh,
            material: material.map(|material| self.material(&material)),
            regions: (regions.into_iter())
                .map(|RegionTable { name, elements, within, material }| RegionTable {
                    name,
                    elements: elements.map(|elements| self.choice(&elements)),
                    within: within.map(|corners| corners.map(|corner| self.point(corner))),
                    material: self.material(&material),
                })
                .collect(),
            supports: (supports.into_iter())
                .map(|SupportTable { nodes, axes, displacement, factor, symmetry }| SupportTable {
                    nodes: self.choice(&nodes),
                    axes: self.axes(&axes),
                    displacement: displacement.map(|u| self.point(u)),
                    factor: self.factor(factor.as_ref()),
                    symmetry,
                })
                .collect(),
            equations: (equations.into_iter())
                .map(|EquationTable { terms, value }| EquationTable {
                    terms: (terms.into_iter())
                        .map(|(nodes, axis, coefficient)| {
                            let (axis, sign) = self.axis(axis.chars().next().unwrap_or('x'));
                            (self.choice(&nodes), axis.to_string(), sign * coefficient)
                        })
                        .collect(),
                    value: value.map(|value| self.series(&value, self.length)),
                })
                .collect(),
            cavities: (cavities.into_iter())
                .map(|CavityTable { name, faces, pressure_kpa, volume_mm3, gas, atmosphere_kpa, exponent }| {
                    CavityTable {
                        name,
                        faces: self.choice(&faces),
                        pressure_kpa: pressure_kpa.map(|series| self.series(&series, stress)),
                        volume_mm3: volume_mm3.map(|series| self.series(&series, volume)),
                        gas: gas.map(|series| self.series(&series, 1.0)),
                        atmosphere_kpa: stress * atmosphere_kpa,
                        exponent,
                    }
                })
                .collect(),
            forces: (forces.into_iter())
                .map(|ForceTable { nodes, total, factor }| ForceTable {
                    nodes: self.choice(&nodes),
                    total: self.force(total),
                    factor: self.factor(factor.as_ref()),
                })
                .collect(),
            tractions: (tractions.into_iter())
                .map(|TractionTable { faces, traction_mpa, factor }| TractionTable {
                    faces: self.choice(&faces),
                    traction_mpa: self.direction(traction_mpa).map(|t| stress * t),
                    factor: self.factor(factor.as_ref()),
                })
                .collect(),
            pressures: (pressures.into_iter())
                .map(|PressureTable { faces, pressure_kpa }| PressureTable {
                    faces: self.choice(&faces),
                    pressure_kpa: self.series(&pressure_kpa, stress),
                })
                .collect(),
            gravity: gravity.map(|GravityTable { acceleration, factor }| GravityTable {
                acceleration: self.direction(acceleration).map(|a| per_length * a),
                factor: self.factor(factor.as_ref()),
            }),
            contacts: (contacts.into_iter())
                .map(|table| ContactTable {
                    slave: self.choice(&table.slave),
                    master: self.choice(&table.master),
                    stiffness: table.stiffness.map(|k| per_length * k),
                    penetration_tolerance: table.penetration_tolerance.map(|depth| self.length * depth),
                    ..table
                })
                .collect(),
            obstacles: obstacles.iter().map(|table| self.obstacle(table)).collect(),
            load: load.map(|mut load| {
                load.times.iter_mut().for_each(|t| *t *= self.time);
                load
            }),
            probes: probes.into_iter().map(|Probe { name, at }| Probe { name, at: self.point(at) }).collect(),
            solver: Steps {
                // mm and N: corrections of lengths are those of most unknowns.
                tolerance: tolerance.map(|t| t * self.length.min(1.0)),
                residual_tolerance,
                max_iterations,
                first_step: time(first_step),
                max_step: time(max_step),
                min_step: time(min_step),
                continuation,
                states_past_limit,
                imperfection: imperfection.map(|size| size * self.length),
            },
            output,
        }
    }

    /// A mesh; the nodes of its elements are put into another order where it is mirrored.
    pub fn mesh(&self, mesh: &Mesh) -> Mesh {
        let moved = mesh.clone().map_nodes(|x| self.point(x));
        if self.determinant() > 0.0 { moved } else { inside_out(moved) }
    }
}

/// The same body with the nodes of every element in the order of its mirror image.
pub fn inside_out(mut mesh: Mesh) -> Mesh {
    let close = |a: [f64; 3], b: [f64; 3]| (0..3).all(|d| (a[d] - b[d]).abs() < 1e-12);
    let orders = mesh.per_kind(|family| {
        let mirrored = |x: [f64; 3]| match family.body {
            ReferenceBody::Hexahedron => [-x[0], x[1], x[2]],
            ReferenceBody::Tetrahedron | ReferenceBody::Wedge => [x[1], x[0], x[2]],
        };
        let image = |&x: &[f64; 3]| family.nodes.iter().position(|&other| close(other, mirrored(x)));
        family.nodes.iter().filter_map(image).collect::<Vec<usize>>()
    });
    let old = mesh.clone();
    for element in 0..old.num_elements() {
        let slots = &mut mesh.connectivity[old.kinds.range(element)];
        let order = &orders[old.kind_of(element)];
        slots.iter_mut().zip(order).for_each(|(slot, &from)| *slot = old.element(element)[from]);
    }
    let corners = |mesh: &Mesh, facet: Facet| {
        let mut nodes = mesh.facet_nodes(facet);
        nodes.truncate(mesh.face_kind(facet).num_corners());
        nodes.sort_unstable();
        nodes
    };
    let sets = old.facet_sets.iter().map(|(name, facets)| {
        let face = |facet: &Facet| {
            let wanted = corners(&old, *facet);
            mesh.facets_of(facet.element).find(|other| corners(&mesh, *other) == wanted)
        };
        let mut found: Vec<Facet> = facets.iter().filter_map(face).collect();
        found.sort_unstable();
        (name.clone(), found)
    });
    mesh.facet_sets = sets.collect();
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex::mesh::ElementKind;
    use pneuflex::mesh::lattice::Lattice;

    #[test]
    fn a_mirror_image_has_the_volume_and_the_outward_faces_of_the_body() {
        let mirror = Frame { turn: [[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], length: 2.0, ..Frame::SAME };
        assert_eq!(mirror.determinant(), -1.0);
        for kind in ElementKind::ALL {
            let mut mesh = Lattice::uniform([0.0; 3], [1.0, 2.0, 3.0], [1, 2, 2]).mesh_all(kind);
            let end = mesh.select_facets(|x| x[0] == 1.0);
            mesh.facet_sets.insert("end".into(), end);
            let image = mirror.mesh(&mesh);
            assert!((image.volume() / (8.0 * mesh.volume()) - 1.0).abs() < 1e-12, "{kind:?}");
            assert!(image.scaled_jacobians().all(|quality| quality > 0.0), "{kind:?}");
            assert_eq!(image.facet_set("end"), image.select_facets(|x| x[1] == -2.0));
        }
    }
}
