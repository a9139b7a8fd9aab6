//! The case file: one struct per table, with defaults and range checks.

use std::collections::BTreeSet;
use std::fmt;

use pneuflex_mesh::{Actuator, ElementKind, GeometryError, MeshSize};
use serde::de::value::SeqAccessDeserializer;
use serde::de::{self, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::material::Material;
use crate::obstacle_table::{self, ObstacleTable};
use crate::written::Written;

/// A whole case file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "Written")]
pub struct Case {
    /// Title, repeated in the output.
    pub title: String,
    /// Geometry; every length is required.
    pub actuator: Actuator,
    /// Mesh size and element.
    pub mesh: MeshOptions,
    /// Material law and constants.
    pub material: Material,
    /// Contact between neighbouring chambers.
    pub contact: Contact,
    /// Rigid bodies in the way.
    #[serde(rename = "obstacle", skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<ObstacleTable>,
    /// Pressures to land on.
    pub load: Load,
    /// Points whose displacement is reported.
    #[serde(rename = "probe", skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<Probe>,
    /// Solver settings.
    pub solver: Solver,
    /// What is written.
    pub output: Output,
}

/// Mesh size and element formulation. A resolution sets all of them; keys given beside it win.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MeshOptions {
    /// A graded mesh of quadratic hexahedra, by how exact it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resolution: Option<Resolution>,
    /// Largest element edge, mm: one number or one per direction. The mesh is uniform unless `edge_size` is given, too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<Size>,
    /// Element edge at the body's re-entrant edges, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edge_size: Option<f64>,
    /// Least number of elements through end, side and top walls.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall_elements: Option<usize>,
    /// Element formulation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub element: Option<Formulation>,
}

/// How exact a mesh is. Errors of the tip's displacement are those of the default actuator at 50 kPa, see
/// ARCHITECTURE.md.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Resolution {
    /// To try things out.
    Draft,
    /// Within 2 %.
    #[default]
    Standard,
    /// Within 0.7 %.
    Fine,
}

/// An element size: the same in all directions, or one per direction, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Size {
    /// The same along x, y and z.
    Uniform(f64),
    /// Along x, y, z.
    PerAxis([f64; 3]),
}

/// Element formulation: shape functions together with the treatment of the volumetric energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Formulation {
    /// The paper's: trilinear hexahedron, volumetric energy at the centre (selective reduced integration).
    #[serde(rename = "hex8-sri")]
    Hex8Sri,
    /// Trilinear hexahedron with mean dilatation J̄ = deformed / reference volume.
    #[serde(rename = "hex8-q1p0")]
    Hex8Q1p0,
    /// Serendipity quadratic hexahedron with a discontinuous linear pressure.
    #[serde(rename = "hex20")]
    Hex20,
    /// Triquadratic hexahedron with a discontinuous linear pressure.
    #[serde(rename = "hex27")]
    Hex27,
    /// Quadratic tetrahedron with a constant pressure (P2–P0); six per lattice cell.
    #[serde(rename = "tet10")]
    Tet10,
}

/// Contact between the facing walls of neighbouring chambers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contact {
    /// Where contact is looked for.
    pub method: ContactMethod,
    /// Penalty stiffness k, N/mm³.
    pub stiffness: f64,
    /// Whether both walls of a gap are the slave in turn, with half the weight each.
    pub two_pass: bool,
    /// Whether the outer surface is also kept from passing through itself elsewhere than in the gaps.
    pub self_contact: bool,
    /// Largest penetration of a contact point at the requested pressures, mm: there the contact is solved by an augmented Lagrangian.
    /// `None` for the penalty alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub penetration_tolerance: Option<f64>,
}

/// Where contact is looked for (theory §5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactMethod {
    /// Nowhere: walls pass through each other.
    None,
    /// Centre of a slave face against the centre of its corresponding master face.
    SinglePoint,
    /// 4 × 4 Gauss points of a slave face against their closest points on the master surface.
    MultiPoint,
}

/// Sets of an actuator's faces that may touch an obstacle; the first one if nothing is said.
const FACES: [&str; 3] = ["outer", "bottom", "end_face"];

/// Pressures to land on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Increasing pressures, kPa.
    pub pressure_kpa: Vec<f64>,
}

/// A point whose displacement is reported.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// Name in the summary.
    pub name: String,
    /// Reference position, mm; the nearest node is taken.
    pub at: [f64; 3],
}

/// Solver settings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solver {
    /// Convergence: ‖\[Δq; Δλ\]‖ (mm, N) below this.
    pub tolerance: f64,
    /// Convergence: residual norm relative to the norm of the pressure forces below this.
    pub residual_tolerance: f64,
    /// Iterations after which a load step is given up and halved.
    pub max_iterations: usize,
    /// First load step: kPa for actuators, else a time.
    #[serde(rename = "first_step_kpa")]
    pub first_step: f64,
    /// Largest load step.
    #[serde(rename = "max_step_kpa")]
    pub max_step: f64,
    /// A step smaller than this ends the run as not converged.
    #[serde(rename = "min_step_kpa")]
    pub min_step: f64,
}

/// What is written besides the summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Write `fields/*.vtu` at every requested pressure.
    pub fields: bool,
}

impl Default for Contact {
    fn default() -> Self {
        Self {
            method: ContactMethod::MultiPoint,
            stiffness: 4.0,
            two_pass: false,
            self_contact: false,
            penetration_tolerance: None,
        }
    }
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            tolerance: 1e-6,
            residual_tolerance: 1e-8,
            max_iterations: 25,
            first_step: 5.0,
            max_step: 20.0,
            min_step: 1e-3,
        }
    }
}

impl Default for Output {
    fn default() -> Self {
        Self { fields: true }
    }
}

impl Size {
    /// Sizes along x, y, z.
    pub fn per_axis(self) -> [f64; 3] {
        match self {
            Self::Uniform(h) => [h; 3],
            Self::PerAxis(h) => h,
        }
    }
}

/// Written out because the derived reader of an untagged enum cannot say what it expects.
impl<'de> Deserialize<'de> for Size {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct SizeVisitor;
        impl<'de> Visitor<'de> for SizeVisitor {
            type Value = Size;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or three numbers [sx, sy, sz]")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Size, E> {
                Ok(Size::Uniform(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Size, E> {
                Ok(Size::Uniform(value as f64))
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Size, E> {
                Ok(Size::Uniform(value as f64))
            }

            fn visit_seq<A: de::SeqAccess<'de>>(self, sequence: A) -> Result<Size, A::Error> {
                let sizes = Vec::<f64>::deserialize(SeqAccessDeserializer::new(sequence))?;
                let count = sizes.len();
                sizes.try_into().map(Size::PerAxis).map_err(|_| de::Error::invalid_length(count, &self))
            }
        }
        deserializer.deserialize_any(SizeVisitor)
    }
}

impl MeshOptions {
    /// A uniform mesh of one formulation.
    pub fn uniform(size: f64, element: Formulation) -> Self {
        Self { size: Some(Size::Uniform(size)), element: Some(element), ..Self::default() }
    }

    /// Element formulation.
    pub fn formulation(&self) -> Formulation {
        self.element.unwrap_or(Formulation::Hex27)
    }

    /// The resolution of keys that are not given.
    pub fn resolution(&self) -> Resolution {
        self.resolution.unwrap_or_default()
    }

    /// The same with every default written out for an actuator.
    pub fn resolved(&self, actuator: &Actuator) -> Self {
        let MeshSize { size, edge, wall_elements, .. } = self.mesh_size(actuator);
        Self {
            resolution: self.resolution,
            size: Some(Size::PerAxis(size)),
            edge_size: edge.is_finite().then_some(edge),
            wall_elements: Some(wall_elements),
            element: Some(self.formulation()),
        }
    }

    /// Element sizes of an actuator's mesh.
    pub fn mesh_size(&self, actuator: &Actuator) -> MeshSize {
        let preset = self.resolution().mesh_size(actuator);
        let edge = match (self.edge_size, self.size) {
            (Some(edge), _) => edge,
            (None, Some(_)) => f64::INFINITY,
            (None, None) => preset.edge,
        };
        let size = self.size.map_or(preset.size, Size::per_axis);
        MeshSize { size, edge, wall_elements: self.wall_elements.unwrap_or(preset.wall_elements), ..preset }
    }
}

impl Resolution {
    /// Element sizes: at edges a share of the thinnest wall, elsewhere a share of the body's width.
    pub fn mesh_size(self, actuator: &Actuator) -> MeshSize {
        let (of_width, of_wall) = match self {
            Self::Draft => (1.0, 2.8),
            Self::Standard => (1.0, 1.4),
            Self::Fine => (1.0, 0.7),
        };
        let wall = actuator.thinnest_wall();
        let width = (0.5 * actuator.width).min(actuator.height).min(actuator.cavity_length);
        MeshSize { edge: of_wall * wall, ..MeshSize::uniform(of_width * width) }
    }
}

impl Formulation {
    /// Element family of the formulation.
    pub const fn element_kind(self) -> ElementKind {
        match self {
            Self::Hex8Sri | Self::Hex8Q1p0 => ElementKind::Hex8,
            Self::Hex20 => ElementKind::Hex20,
            Self::Hex27 => ElementKind::Hex27,
            Self::Tet10 => ElementKind::Tet10,
        }
    }

    /// The formulation of bodies that come with elements of a family: free of locking.
    pub const fn of_kind(kind: ElementKind) -> Self {
        match kind {
            ElementKind::Hex8 => Self::Hex8Q1p0,
            ElementKind::Hex20 => Self::Hex20,
            ElementKind::Hex27 => Self::Hex27,
            ElementKind::Tet10 => Self::Tet10,
        }
    }

    /// Part of the bulk modulus, MPa, that resists fluctuations of J within an element; the rest resists its mean. Zero but
    /// for the tetrahedron, whose constant pressure leaves three quadratic motions without energy otherwise
    /// (`pneuflex-assembly`, formulations).
    pub fn fluctuation_modulus(self, material: &Material) -> f64 {
        match self {
            Self::Tet10 => material.shear_modulus().min(0.5 * material.bulk_modulus),
            _ => 0.0,
        }
    }

    /// Name in case files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hex8Sri => "hex8-sri",
            Self::Hex8Q1p0 => "hex8-q1p0",
            Self::Hex20 => "hex20",
            Self::Hex27 => "hex27",
            Self::Tet10 => "tet10",
        }
    }
}

impl fmt::Display for Formulation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A value out of range; names the key as written in the case file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value} is out of range: {allowed}")]
pub struct CaseError {
    /// Dotted key, e.g. `mesh.size`; entries of a list by their number from 0, e.g. `probe[1].at`.
    pub key: String,
    /// The offending value as text.
    pub value: String,
    /// What would be allowed.
    pub allowed: String,
}

impl From<GeometryError> for CaseError {
    fn from(error: GeometryError) -> Self {
        Self { key: format!("actuator.{}", error.key), value: error.value.to_string(), allowed: error.allowed }
    }
}

impl Case {
    /// The same with every default of the mesh written out.
    pub fn resolved(&self) -> Self {
        Self { mesh: self.mesh.resolved(&self.actuator), ..self.clone() }
    }

    /// Checks every value against its range.
    ///
    /// # Errors
    /// The first key that is out of range; [`Self::problems`] has all.
    pub fn validate(&self) -> Result<(), CaseError> {
        self.problems().into_iter().next().map_or(Ok(()), Err)
    }

    /// Every key whose value is out of range, table by table.
    pub fn problems(&self) -> Vec<CaseError> {
        let mut found = Problems(self.actuator.problems().into_iter().map(CaseError::from).collect());
        let smallest = self.mesh.size.iter().flat_map(|size| size.per_axis()).min_by(f64::total_cmp);
        let largest = self.mesh.size.iter().flat_map(|size| size.per_axis()).max_by(f64::total_cmp);
        // One of them is out of range if any is; a NaN is the largest or the smallest of all.
        if let Some(bad) = [smallest, largest].into_iter().flatten().find(|h| !(h.is_finite() && *h > 0.0)) {
            found.unless_positive("mesh.size", bad, " mm");
        }
        if let Some(edge) = self.mesh.edge_size {
            found.unless_positive("mesh.edge_size", edge, " mm");
        }
        if let Some(n) = self.mesh.wall_elements.filter(|n| !(1..=1000).contains(n)) {
            found.add("mesh.wall_elements", &n, "must be from 1 to 1000");
        }
        found.0.extend(self.material.problems("material"));
        found.unless_positive("contact.stiffness", self.contact.stiffness, " N/mm3");
        if let Some(tolerance) = self.contact.penetration_tolerance {
            found.unless_positive("contact.penetration_tolerance", tolerance, " mm");
        }
        let is_single = self.contact.method == ContactMethod::SinglePoint;
        for (key, is_asked) in
            [("contact.two_pass", self.contact.two_pass), ("contact.self_contact", self.contact.self_contact)]
        {
            if is_asked && is_single {
                found.add(key, &true, "is for contact.method = \"multi-point\" only");
            }
        }
        obstacle_table::check(&self.obstacles, &mut found);
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            if let Some(faces) = obstacle.faces.as_ref().filter(|faces| !FACES.contains(&faces.as_str())) {
                found.add(&format!("obstacle[{i}].faces"), faces, &format!("must be one of {}", FACES.join(", ")));
            }
            let moves = [("displacement", obstacle.displacement.is_some()), ("factor", obstacle.factor.is_some())];
            for (key, _) in moves.into_iter().filter(|(_, is_given)| *is_given) {
                let allowed = "is for model files: obstacles of an actuator stay where they are";
                found.add(&format!("obstacle[{i}].{key}"), &"something", allowed);
            }
        }
        self.check_load_and_probes(&mut found);
        self.solver.check(&mut found);
        found.0
    }

    fn check_load_and_probes(&self, found: &mut Problems) {
        let pressures = &self.load.pressure_kpa;
        let increasing = pressures.windows(2).all(|w| w[0] < w[1]);
        if pressures.is_empty() || !pressures.iter().all(|p| p.is_finite() && *p > 0.0) || !increasing {
            let allowed = "must be a non-empty, strictly increasing list of finite pressures greater than 0 kPa";
            found.add("load.pressure_kpa", pressures, allowed);
        }
        let mut names = BTreeSet::new();
        for (i, probe) in self.probes.iter().enumerate() {
            if probe.name.is_empty() || !names.insert(&probe.name) {
                let allowed = "must be non-empty and different for every probe";
                found.add(&format!("probe[{i}].name"), &probe.name, allowed);
            }
            if !probe.at.iter().all(|x| x.is_finite()) {
                found.add(&format!("probe[{i}].at"), &probe.at, "must be three finite coordinates, mm");
            }
        }
    }
}

impl Solver {
    fn check(&self, found: &mut Problems) {
        found.unless_positive("solver.tolerance", self.tolerance, " (mm, N)");
        found.unless_positive("solver.residual_tolerance", self.residual_tolerance, "");
        found.unless_positive("solver.first_step_kpa", self.first_step, " kPa");
        found.unless_positive("solver.min_step_kpa", self.min_step, " kPa");
        found.unless_positive("solver.max_step_kpa", self.max_step, " kPa");
        if self.max_step < self.min_step {
            found.add("solver.max_step_kpa", &self.max_step, "must not be below solver.min_step_kpa");
        }
        if !(2..=1000).contains(&self.max_iterations) {
            found.add("solver.max_iterations", &self.max_iterations, "must be from 2 to 1000");
        }
    }
}

/// Values found out of range.
#[derive(Default)]
pub(crate) struct Problems(pub(crate) Vec<CaseError>);

impl Problems {
    pub(crate) fn add(&mut self, key: &str, value: &dyn fmt::Debug, allowed: &str) {
        self.0.push(CaseError { key: key.into(), value: format!("{value:?}"), allowed: allowed.into() });
    }

    pub(crate) fn unless_positive(&mut self, key: &str, value: f64, unit: &str) {
        if !(value.is_finite() && value > 0.0) {
            self.add(key, &value, &format!("must be a finite number greater than 0{unit}"));
        }
    }
}
