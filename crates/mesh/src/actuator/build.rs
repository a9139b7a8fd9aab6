//! The mesh of an actuator with its named sets.

use std::collections::BTreeMap;

use super::lengths::{Actuator, Part};
use super::planes::Cuts;
use super::ranges::GeometryError;
use super::row::{Region, Row};
use crate::element::ElementKind;
use crate::grading::MeshSize;
use crate::lattice::{BoundaryFacet, Lattice, Neighbour};
use crate::mesh::{Facet, Mesh};

/// Builds the mesh of the actuator with all its named sets (see the module's text).
///
/// # Errors
/// A length out of range, see [`Actuator::validate`].
///
/// # Panics
/// If a size is not positive: callers check their options first.
pub fn build_actuator(actuator: &Actuator, size: &MeshSize, kind: ElementKind) -> Result<Mesh, GeometryError> {
    build_actuator_with(actuator, size, kind, &Cuts::default())
}

/// The same with faces of elements in further planes.
///
/// # Errors
/// As there.
///
/// # Panics
/// As there.
pub fn build_actuator_with(
    actuator: &Actuator,
    size: &MeshSize,
    kind: ElementKind,
    cuts: &Cuts,
) -> Result<Mesh, GeometryError> {
    actuator.validate()?;
    let row = Row::of(actuator);
    let intervals = row.intervals(cuts);
    let lines: [Vec<f64>; 3] = std::array::from_fn(|d| {
        let mut line = vec![intervals[d][0].start];
        for interval in &intervals[d] {
            line.extend(size.divide(interval, d));
        }
        line
    });
    let lattice = Lattice { lines };
    let mut built = lattice.mesh(kind, |cell| row.region(lattice.centre(cell)) == Region::Solid);

    let mut facet_sets: BTreeMap<String, Vec<Facet>> = BTreeMap::new();
    let last = lattice.num_cells()[0] - 1;
    for BoundaryFacet { facet, cell, side, neighbour } in built.boundary() {
        let is_outer = match (neighbour, side) {
            (Neighbour::Void(void), _) => !matches!(row.region(lattice.centre(void)), Region::Air(_)),
            (Neighbour::Outside, 0) => false,
            // The plane of symmetry.
            (Neighbour::Outside, 2) => actuator.part == Part::Whole,
            (Neighbour::Outside, _) => true,
        };
        if is_outer {
            facet_sets.entry("outer".into()).or_default().push(facet);
        }
        let name = match (neighbour, side) {
            (Neighbour::Void(void), side) => match row.region(lattice.centre(void)) {
                Region::Air(chamber) => {
                    if !actuator.has_channel() {
                        facet_sets.entry(format!("cavity_{}", chamber + 1)).or_default().push(facet);
                    }
                    "cavity".into()
                }
                // The wall at the gap's low end looks along +x and belongs to the left chamber.
                Region::Gap(i) if side == 1 => format!("gap_{}_left", i + 1),
                Region::Gap(i) if side == 0 => format!("gap_{}_right", i + 1),
                _ => continue,
            },
            (Neighbour::Outside, 0) => "clamp".into(),
            (Neighbour::Outside, 1) if cell[0] == last && lattice.centre(cell)[2] < actuator.base => "end_face".into(),
            (Neighbour::Outside, 4) => "bottom".into(),
            _ => continue,
        };
        facet_sets.entry(name).or_default().push(facet);
    }
    facet_sets.values_mut().for_each(|facets| facets.sort_unstable());

    let mesh = &mut built.mesh;
    let length = actuator.length();
    let tolerance = 1e-9 * length;
    let near = |a: f64, b: f64| (a - b).abs() <= tolerance;
    let mut node_sets = BTreeMap::from([
        ("clamp".to_owned(), mesh.select_nodes(|x| near(x[0], 0.0))),
        ("bottom_centreline".to_owned(), mesh.select_nodes(|x| near(x[1], 0.0) && near(x[2], 0.0))),
        ("end_face".to_owned(), mesh.select_nodes(|x| near(x[0], length) && x[2] <= actuator.base + tolerance)),
    ]);
    if actuator.part == Part::Half {
        node_sets.insert("symmetry".to_owned(), mesh.select_nodes(|x| near(x[1], 0.0)));
    }
    mesh.node_sets = node_sets;
    mesh.facet_sets = facet_sets;
    Ok(built.mesh)
}
