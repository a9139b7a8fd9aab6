//! `[[obstacle]]` of case and model files: shapes with the keys they need.

use pneuflex_mesh::Facet;
use serde::{Deserialize, Serialize};

use crate::choice::Choice;
use crate::load::Motion;
use crate::obstacle::{Obstacle, Shape};
use crate::options::check_names;
use crate::quantity::LoadParameter;
use crate::range_check::{CaseError, Problems, Quantity};
use crate::series::Series;

/// A rigid body in the way. Which of the optional keys are needed depends on the shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObstacleTable {
    /// Name in the results.
    pub name: String,
    /// Its shape.
    pub shape: ShapeName,
    /// Set of faces that may touch it; an actuator's whole outer surface if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub faces: Option<Choice>,
    /// A point of the plane, or of the cylinder's axis, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<[f64; 3]>,
    /// Normal of the plane, towards the body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 3]>,
    /// Centre of the sphere or cuboid, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre: Option<[f64; 3]>,
    /// Direction of the cylinder's axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<[f64; 3]>,
    /// Radius of the sphere or cylinder, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Whether the body is inside of the sphere or cylinder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hollow: Option<bool>,
    /// Lengths of the cuboid along x, y, z, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<[f64; 3]>,
    /// Radius of the cuboid's edges, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edge_radius: Option<f64>,
    /// Penalty stiffness, N/mm³; that of the walls, or from material and faces, if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
    /// How far it has moved at the end, or where the factor is 1, mm; in model files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<[f64; 3]>,
    /// Factor by time; a straight line from 0 to 1 if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<Series>,
    /// Largest depth of a contact point at the requested loads, mm; in a model file a share of the faces' size if it is left out, in a case file
    /// as for the walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub penetration_tolerance: Option<f64>,
    /// Whether it may overlap the body at rest; it is pressed out of it by the first requested load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interference: Option<bool>,
    /// Whether the force on it is in the results; it is if this is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub report_force: Option<bool>,
}

/// The shapes of obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ShapeName {
    /// What lies behind a plane.
    Plane,
    /// A ball.
    Sphere,
    /// An endless cylinder.
    Cylinder,
    /// A cuboid along the axes.
    Cuboid,
}

impl ShapeName {
    /// Keys that the shape needs, and those that it may have.
    const fn keys(self) -> (&'static [&'static str], &'static [&'static str]) {
        match self {
            Self::Plane => (&["point", "normal"], &[]),
            Self::Sphere => (&["centre", "radius"], &["hollow"]),
            Self::Cylinder => (&["point", "axis", "radius"], &["hollow"]),
            Self::Cuboid => (&["centre", "size"], &["edge_radius"]),
        }
    }
}

impl ObstacleTable {
    /// The shape, if everything that it needs is there.
    pub fn shape(&self) -> Option<Shape> {
        let is_hollow = self.hollow.unwrap_or(false);
        Some(match self.shape {
            ShapeName::Plane => Shape::Plane { point: self.point?, normal: self.normal? },
            ShapeName::Sphere => Shape::Sphere { centre: self.centre?, radius: self.radius?, is_hollow },
            ShapeName::Cylinder => {
                Shape::Cylinder { point: self.point?, axis: self.axis?, radius: self.radius?, is_hollow }
            }
            ShapeName::Cuboid => Shape::Cuboid {
                centre: self.centre?,
                size: self.size?,
                axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                edge_radius: self.edge_radius.unwrap_or(0.0),
            },
        })
    }

    /// Key and value of its position.
    pub(crate) fn position(&self) -> (&'static str, [f64; 3]) {
        match self.shape {
            ShapeName::Plane | ShapeName::Cylinder => ("point", self.point.unwrap_or_default()),
            ShapeName::Sphere | ShapeName::Cuboid => ("centre", self.centre.unwrap_or_default()),
        }
    }

    /// The obstacle for some faces; `None` if its shape lacks something. An overlap that is meant is gone at the position `first`.
    pub fn obstacle(
        &self,
        facets: Vec<Facet>,
        stiffness: f64,
        motion: Option<Motion>,
        first: LoadParameter,
    ) -> Option<Obstacle> {
        let stiffness = self.stiffness.unwrap_or(stiffness);
        let report_force = self.report_force.unwrap_or(true);
        let (name, shape, penetration_tolerance) = (self.name.clone(), self.shape()?, self.penetration_tolerance);
        let interference_until = (self.interference == Some(true)).then_some(first);
        Some(Obstacle {
            name,
            shape,
            facets,
            stiffness,
            motion,
            report_force,
            penetration_tolerance,
            interference_until,
        })
    }
}

/// Finds what is missing, superfluous or out of range.
pub(crate) fn check(tables: &[ObstacleTable], found: &mut Problems) {
    check_names("obstacle", tables.iter().map(|table| &table.name), found);
    for (i, table) in tables.iter().enumerate() {
        check_keys(i, table, found);
        check_values(i, table, found);
    }
}

fn check_keys(i: usize, table: &ObstacleTable, found: &mut Problems) {
    let given = [
        ("point", table.point.is_some()),
        ("normal", table.normal.is_some()),
        ("centre", table.centre.is_some()),
        ("axis", table.axis.is_some()),
        ("radius", table.radius.is_some()),
        ("hollow", table.hollow.is_some()),
        ("size", table.size.is_some()),
        ("edge_radius", table.edge_radius.is_some()),
    ];
    let (needed, optional) = table.shape.keys();
    for (key, is_given) in given {
        let is_needed = needed.contains(&key);
        if is_needed && !is_given {
            let allowed = format!("must be given: the shape needs {}", needed.join(", "));
            found.0.push(CaseError { key: format!("obstacle[{i}].{key}"), value: "nothing".into(), allowed });
        } else if is_given && !is_needed && !optional.contains(&key) {
            let allowed = format!("the shape has the keys {}", [needed, optional].concat().join(", "));
            found.0.push(CaseError { key: format!("obstacle[{i}].{key}"), value: "something".into(), allowed });
        }
    }
}

fn check_values(i: usize, table: &ObstacleTable, found: &mut Problems) {
    let key = |name: &str| format!("obstacle[{i}].{name}");
    for (name, value) in [("point", table.point), ("centre", table.centre), ("displacement", table.displacement)] {
        found.unless_finite(&key(name), &value.unwrap_or_default(), "three finite numbers", Quantity::Length);
    }
    for (name, value) in [("normal", table.normal), ("axis", table.axis)] {
        let has_length = |v: &[f64; 3]| {
            let square = v.iter().map(|x| x * x).sum::<f64>();
            square.is_normal()
        };
        if let Some(value) = value.filter(|value| !has_length(value)) {
            found.add(&key(name), &value, "must be three finite numbers that are not all 0");
        }
    }
    for (name, value, quantity) in [
        ("radius", table.radius, Quantity::Length),
        ("stiffness", table.stiffness, Quantity::Stiffness),
        ("penetration_tolerance", table.penetration_tolerance, Quantity::Tolerance),
    ] {
        if let Some(value) = value {
            found.unless_positive(&key(name), value, quantity);
        }
    }
    let Some(size) = table.size else { return };
    let [least, longest] = Quantity::Length.range();
    if !size.iter().all(|s| (least..=longest).contains(s)) {
        let allowed = format!("must be three finite numbers greater than 0, from {least:e} to {longest:e} mm");
        found.add(&key("size"), &size, &allowed);
    }
    let most = 0.5 * size.into_iter().fold(f64::INFINITY, f64::min);
    if let Some(radius) = table.edge_radius.filter(|radius| !(0.0..most).contains(radius)) {
        found.add(
            &key("edge_radius"),
            &radius,
            &format!("must be from 0 to less than half the smallest edge, {most} mm"),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(shape: ShapeName) -> ObstacleTable {
        let none = ObstacleTable {
            name: "o".into(),
            shape,
            faces: None,
            point: None,
            normal: None,
            centre: None,
            axis: None,
            radius: None,
            hollow: None,
            size: None,
            edge_radius: None,
            stiffness: None,
            displacement: None,
            factor: None,
            penetration_tolerance: None,
            interference: None,
            report_force: None,
        };
        let one = Some([0.0, 0.0, 1.0]);
        match shape {
            ShapeName::Plane => ObstacleTable { point: one, normal: one, ..none },
            ShapeName::Sphere => ObstacleTable { centre: one, radius: Some(2.0), ..none },
            ShapeName::Cylinder => ObstacleTable { point: one, axis: one, radius: Some(2.0), ..none },
            ShapeName::Cuboid => ObstacleTable { centre: one, size: Some([1.0; 3]), ..none },
        }
    }

    fn keys(tables: &[ObstacleTable]) -> Vec<String> {
        let mut found = Problems(Vec::new());
        check(tables, &mut found);
        found.0.into_iter().map(|problem| problem.key).collect()
    }

    #[test]
    fn every_shape_needs_its_own_keys_and_takes_no_others() {
        for shape in [ShapeName::Plane, ShapeName::Sphere, ShapeName::Cylinder, ShapeName::Cuboid] {
            let complete = table(shape);
            assert!(keys(std::slice::from_ref(&complete)).is_empty() && complete.shape().is_some());
            let bare = ObstacleTable { point: None, centre: None, ..complete.clone() };
            assert_eq!((keys(std::slice::from_ref(&bare)).len(), bare.shape()), (1, None), "{shape:?}");
            let both = ObstacleTable { point: Some([0.0; 3]), centre: Some([0.0; 3]), ..complete };
            assert_eq!(keys(&[both]).len(), 1, "{shape:?}");
        }
    }

    #[test]
    fn values_out_of_range_are_named() {
        let plane = table(ShapeName::Plane);
        let [sphere, cuboid] = [table(ShapeName::Sphere), table(ShapeName::Cuboid)];
        for (wrong, key) in [
            (ObstacleTable { name: String::new(), ..plane.clone() }, "name"),
            (ObstacleTable { point: Some([f64::NAN, 0.0, 0.0]), ..plane.clone() }, "point"),
            (ObstacleTable { normal: Some([0.0; 3]), ..plane.clone() }, "normal"),
            (ObstacleTable { normal: Some([1e-200; 3]), ..plane.clone() }, "normal"),
            (ObstacleTable { stiffness: Some(0.0), ..plane.clone() }, "stiffness"),
            (ObstacleTable { radius: Some(-1.0), ..sphere.clone() }, "radius"),
            (ObstacleTable { size: Some([1.0, 0.0, 1.0]), ..cuboid.clone() }, "size"),
            (ObstacleTable { edge_radius: Some(0.5), ..cuboid.clone() }, "edge_radius"),
            (ObstacleTable { edge_radius: Some(f64::NAN), ..cuboid }, "edge_radius"),
        ] {
            assert_eq!(keys(&[wrong]), [format!("obstacle[0].{key}")]);
        }
        assert_eq!(keys(&[plane, ObstacleTable { name: "o".into(), ..sphere }]), ["obstacle[1].name"]);
    }
}
