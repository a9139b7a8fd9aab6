//! Tables that case files and model files share, and what they are made of: mesh, contact, loads, probes, solver, output.

use std::collections::BTreeSet;

use pneuflex_mesh::{Actuator, MeshSize, NumberOrList, PerChamber, number_or_list};
use serde::de;
use serde::{Deserialize, Deserializer, Serialize};

use crate::formulation::Formulation;
use crate::range_check::{CaseError, Problems, Quantity};

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

/// How fine a mesh is. How exact results on it are depends on the design: `cargo xtask accuracy` measures it, kind by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Resolution {
    /// To try things out.
    Draft,
    /// To compare designs.
    #[default]
    Standard,
    /// For results.
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
    /// Gaps averaged around the corners of the slave's faces, integrated between the edges of the master's: faces that do not match transfer
    /// a uniform pressure exactly. Surfaces with nodes in common are one that may touch itself: there as [`Self::MultiPoint`].
    Mortar,
}

/// Pressures to land on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Increasing pressures, kPa.
    pub pressure_kpa: Vec<f64>,
    /// Pressures in the chambers over these, for chambers that no channel joins. `None` for one air in all of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chamber_factor: Option<PerChamber>,
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
    /// Convergence: ‖\[Δq; Δλ\]‖ below this, with lengths in mean spacings h of the nodes and forces in μ h², μ the shear modulus.
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
    /// What is prescribed from step to step.
    pub continuation: Continuation,
    /// States that are recorded beyond the first limit point, at the most.
    pub states_past_limit: usize,
    /// Largest displacement, mm, by which the body is pushed along the motion that becomes unstable where it buckles; `None` for a path that
    /// ends there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imperfection: Option<f64>,
}

/// What is prescribed from step to step along a path of equilibria (theory §14).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Continuation {
    /// The load parameter: the path ends where it has its greatest value.
    #[default]
    Load,
    /// The length of the path: the load parameter is found, and may fall.
    ArcLength,
    /// The load parameter; where the path ends, the body snaps, held back by dampers, to its next stable equilibrium.
    Damped,
}

/// What is written besides the summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Write `fields/*.vtu` at every requested pressure.
    pub fields: bool,
    /// Beside them write the stresses at the elements' integration points.
    pub points: bool,
    /// At the end estimate the errors of the last state, by what a mesh with every element divided into eight makes of it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub error_estimate: bool,
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
            continuation: Continuation::Load,
            states_past_limit: 30,
            imperfection: None,
        }
    }
}

impl Output {
    pub(crate) fn check(&self, found: &mut Problems) {
        if self.points && !self.fields {
            let why = "the points go into files beside the fields, which output.fields = false leaves out";
            found.add("output.points", &true, why);
        }
    }
}

impl Default for Output {
    fn default() -> Self {
        Self { fields: true, points: false, error_estimate: false }
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

impl<'de> Deserialize<'de> for Size {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        const EXPECTED: &str = "a number or three numbers [sx, sy, sz]";
        match number_or_list::<Vec<f64>, D>(deserializer, EXPECTED)? {
            NumberOrList::Number(h) => Ok(Self::Uniform(h)),
            NumberOrList::List(sizes) => {
                let count = sizes.len();
                sizes.try_into().map(Self::PerAxis).map_err(|_| de::Error::invalid_length(count, &EXPECTED))
            }
        }
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

impl MeshOptions {
    pub(crate) fn check(&self, found: &mut Problems) {
        // One of them is out of range if any is; a NaN is the largest or the smallest of all.
        let sizes: Vec<f64> = self.size.iter().flat_map(|size| size.per_axis()).collect();
        let [least, longest] = Quantity::Length.range();
        if let Some(bad) = sizes.into_iter().find(|h| !(least..=longest).contains(h)) {
            found.unless_positive("mesh.size", bad, Quantity::Length);
        }
        if let Some(edge) = self.edge_size {
            found.unless_positive("mesh.edge_size", edge, Quantity::Length);
        }
        if let Some(n) = self.wall_elements.filter(|n| !(1..=1000).contains(n)) {
            found.add("mesh.wall_elements", &n, "must be from 1 to 1000");
        }
    }

    /// Complains about every key of sizes, where there is nothing to be meshed.
    pub(crate) fn check_imported(&self, found: &mut Problems) {
        let given = [
            ("resolution", self.resolution.is_some()),
            ("size", self.size.is_some()),
            ("edge_size", self.edge_size.is_some()),
            ("wall_elements", self.wall_elements.is_some()),
        ];
        for (key, _) in given.into_iter().filter(|(_, is_given)| *is_given) {
            let allowed =
                "is for an [actuator], which is meshed here: the elements of an imported body are those of its file";
            found.0.push(CaseError { key: format!("mesh.{key}"), value: "something".into(), allowed: allowed.into() });
        }
    }
}

/// Names under which results are kept: none may hide another.
pub(crate) fn check_names<'a>(what: &str, names: impl IntoIterator<Item = &'a String>, found: &mut Problems) {
    let mut known = BTreeSet::new();
    for (i, name) in names.into_iter().enumerate() {
        if name.is_empty() || !known.insert(name) {
            let allowed = format!("must be non-empty and different for every {what}");
            found.add(&format!("{what}[{i}].name"), name, &allowed);
        }
    }
}

pub(crate) fn check_probes(probes: &[Probe], found: &mut Problems) {
    check_names("probe", probes.iter().map(|probe| &probe.name), found);
    for (i, probe) in probes.iter().enumerate() {
        found.unless_finite(&format!("probe[{i}].at"), &probe.at, "three finite coordinates", Quantity::Length);
    }
}

impl Resolution {
    /// Element sizes: at edges a share of the thinnest wall, elsewhere a share of the body's width. Where chambers differ, those of
    /// the thinnest and shortest hold for all.
    pub fn mesh_size(self, actuator: &Actuator) -> MeshSize {
        let (of_width, of_wall) = match self {
            Self::Draft => (1.0, 2.8),
            Self::Standard => (1.0, 1.4),
            Self::Fine => (1.0, 0.7),
        };
        let wall = actuator.thinnest_wall();
        let width = (0.5 * actuator.width).min(actuator.height).min(actuator.cavity_length.least());
        MeshSize { edge: of_wall * wall, ..MeshSize::uniform(of_width * width) }
    }
}

impl Solver {
    pub(crate) fn check(&self, found: &mut Problems) {
        found.unless_positive("solver.tolerance", self.tolerance, Quantity::Tolerance);
        found.unless_positive("solver.residual_tolerance", self.residual_tolerance, Quantity::Tolerance);
        found.unless_positive("solver.first_step_kpa", self.first_step, Quantity::Pressure);
        found.unless_positive("solver.min_step_kpa", self.min_step, Quantity::Pressure);
        found.unless_positive("solver.max_step_kpa", self.max_step, Quantity::Pressure);
        if self.max_step < self.min_step {
            found.add("solver.max_step_kpa", &self.max_step, "must not be below solver.min_step_kpa");
        }
        if !(2..=1000).contains(&self.max_iterations) {
            found.add("solver.max_iterations", &self.max_iterations, "must be from 2 to 1000");
        }
        if let Some(imperfection) = self.imperfection {
            found.unless_positive("solver.imperfection", imperfection, Quantity::Tolerance);
        }
        if !(1..=1000).contains(&self.states_past_limit) {
            found.add("solver.states_past_limit", &self.states_past_limit, "must be from 1 to 1000");
        }
    }
}
