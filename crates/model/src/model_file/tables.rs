//! The model file's tables.

use pneuflex_mesh::{Actuator, Cuts, NumberOrList, number_or_list};
use serde::de;
use serde::{Deserialize, Deserializer, Serialize};

use crate::choice::Choice;
use crate::chosen::Asked;
use crate::material::Material;
use crate::obstacle_table::ObstacleTable;
use crate::options::{ContactMethod, Continuation, MeshOptions, Output, Probe};
use crate::series::Series;

/// A whole model file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Title, repeated in the output.
    #[serde(default)]
    pub title: String,
    /// File with the body; beside it there is no `actuator`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<Source>,
    /// Parameters of an actuator as the body, with its clamp, its plane of symmetry and the contact in its gaps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actuator: Option<Actuator>,
    /// Mesh of the actuator.
    #[serde(default, skip_serializing_if = "is_default")]
    pub mesh: MeshOptions,
    /// Material of all elements that belong to no region; a deck's own if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<Material>,
    /// Parts of another material; a later one wins.
    #[serde(default, rename = "region", skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<RegionTable>,
    /// Held or moved nodes.
    #[serde(default, rename = "support", skip_serializing_if = "Vec::is_empty")]
    pub supports: Vec<SupportTable>,
    /// Linear equations between displacements.
    #[serde(default, rename = "equation", skip_serializing_if = "Vec::is_empty")]
    pub equations: Vec<EquationTable>,
    /// Spaces filled with air or a liquid.
    #[serde(default, rename = "cavity", skip_serializing_if = "Vec::is_empty")]
    pub cavities: Vec<CavityTable>,
    /// Forces on nodes.
    #[serde(default, rename = "force", skip_serializing_if = "Vec::is_empty")]
    pub forces: Vec<ForceTable>,
    /// Loads on faces that keep their direction.
    #[serde(default, rename = "traction", skip_serializing_if = "Vec::is_empty")]
    pub tractions: Vec<TractionTable>,
    /// Pressures on other faces, which follow them.
    #[serde(default, rename = "pressure", skip_serializing_if = "Vec::is_empty")]
    pub pressures: Vec<PressureTable>,
    /// Weight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<GravityTable>,
    /// Surfaces that may touch.
    #[serde(default, rename = "contact", skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<ContactTable>,
    /// Rigid bodies in the way.
    #[serde(default, rename = "obstacle", skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<ObstacleTable>,
    /// When results are wanted; a deck's own schedule if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<Times>,
    /// Points whose displacement is reported.
    #[serde(default, rename = "probe", skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<Probe>,
    /// Solver settings.
    #[serde(default, skip_serializing_if = "is_default")]
    pub solver: Steps,
    /// What is written.
    #[serde(default)]
    pub output: Output,
}

impl Model {
    /// Planes in which the mesh of an actuator has faces of elements so that its regions are what their boxes say.
    pub fn cuts(&self) -> Cuts {
        let mut cuts = Cuts::default();
        self.regions.iter().filter_map(|region| region.within).for_each(|corners| cuts.add_box(corners));
        cuts
    }

    /// What is chosen in it: the keys, what is asked for there, the choices.
    pub fn choices(&self) -> Vec<(String, Asked, &Choice)> {
        let mut found = Vec::new();
        let mut add = |key: String, asked: Asked, choice| found.push((key, asked, choice));
        for (i, region) in self.regions.iter().enumerate() {
            region.elements.iter().for_each(|choice| add(format!("region[{i}].elements"), Asked::Elements, choice));
        }
        for (i, support) in self.supports.iter().enumerate() {
            add(format!("support[{i}].nodes"), Asked::Nodes, &support.nodes);
        }
        for (i, equation) in self.equations.iter().enumerate() {
            for (j, (choice, ..)) in equation.terms.iter().enumerate() {
                add(format!("equation[{i}].terms[{j}]"), Asked::Nodes, choice);
            }
        }
        for (i, cavity) in self.cavities.iter().enumerate() {
            add(format!("cavity[{i}].faces"), Asked::Faces, &cavity.faces);
        }
        for (i, force) in self.forces.iter().enumerate() {
            add(format!("force[{i}].nodes"), Asked::Nodes, &force.nodes);
        }
        for (i, traction) in self.tractions.iter().enumerate() {
            add(format!("traction[{i}].faces"), Asked::Faces, &traction.faces);
        }
        for (i, pressure) in self.pressures.iter().enumerate() {
            add(format!("pressure[{i}].faces"), Asked::Faces, &pressure.faces);
        }
        for (i, contact) in self.contacts.iter().enumerate() {
            add(format!("contact[{i}].slave"), Asked::Faces, &contact.slave);
            add(format!("contact[{i}].master"), Asked::Faces, &contact.master);
        }
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            obstacle.faces.iter().for_each(|choice| add(format!("obstacle[{i}].faces"), Asked::Faces, choice));
        }
        found
    }
}

/// The file that holds the body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// A deck of Abaqus or CalculiX (`.inp`) or FEBio (`.feb`), a mesh of Gmsh (`.msh`) or VTK (`.vtk`, `.vtu`), or a part from CAD, relative to the model file.
    pub file: String,
    /// Millimetres per unit of length in a mesh; decks are in mm, N, MPa.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub scale: f64,
    /// Largest edge of the elements of a part, mm; from its thinnest wall if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<f64>,
    /// Points in the mouths of chambers that open to the outside, mm.
    #[serde(default, skip_serializing_if = "Inlets::is_empty")]
    pub inlet: Inlets,
}

impl Source {
    /// A file in mm whose chambers are found by themselves.
    pub fn of_file(file: impl Into<String>) -> Self {
        Self { file: file.into(), scale: 1.0, size: None, inlet: Inlets::default() }
    }
}

/// Points in the mouths of chambers: one `[x, y, z]`, or several.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Inlets(pub Vec<[f64; 3]>);

impl Inlets {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl<'de> Deserialize<'de> for Inlets {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entry(NumberOrList<[f64; 3]>);

        impl<'de> Deserialize<'de> for Entry {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                number_or_list(deserializer, "a coordinate of one point, or a point [x, y, z] of several").map(Self)
            }
        }

        let entries = Vec::<Entry>::deserialize(deserializer)?;
        let number = |entry: &Entry| if let Entry(NumberOrList::Number(x)) = entry { Some(*x) } else { None };
        let point = |entry: &Entry| if let Entry(NumberOrList::List(x)) = entry { Some(*x) } else { None };
        let one: Option<Vec<f64>> = entries.iter().map(number).collect();
        if let Some([x, y, z]) = one.as_deref() {
            return Ok(Self(vec![[*x, *y, *z]]));
        }
        let several: Option<Vec<[f64; 3]>> = entries.iter().map(point).collect();
        several.map(Self).ok_or_else(|| de::Error::custom("must be a point [x, y, z], or a list of such points"))
    }
}

/// Elements with a material of their own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionTable {
    /// Name in reports.
    pub name: String,
    /// Which elements.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elements: Option<Choice>,
    /// Instead: the elements whose centre lies between two corners, mm.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub within: Option<[[f64; 3]; 2]>,
    /// Their material.
    pub material: Material,
}

/// Nodes that are held or moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SupportTable {
    /// A node set, the nodes of a surface, or where they are.
    pub nodes: Choice,
    /// Held axes, e.g. `xyz` or `y`.
    pub axes: String,
    /// Displacement at the end, or where the factor is 1, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<[f64; 3]>,
    /// Factor by time; a straight line from 0 to 1 if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<Series>,
    /// Whether it is the plane of symmetry of a body of which one side is modelled.
    #[serde(default, skip_serializing_if = "is_default")]
    pub symmetry: bool,
}

/// Σ cᵢ uᵢ = value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EquationTable {
    /// Terms \[node set, axis, coefficient\]: sets of one node, or all of the same size, which gives one equation for each.
    pub terms: Vec<(Choice, String, f64)>,
    /// Right-hand side by time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<Series>,
}

/// A cavity and what is known of the fluid in it: exactly one of pressure, volume and gas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CavityTable {
    /// Name in reports.
    pub name: String,
    /// Surface of its walls.
    pub faces: Choice,
    /// Pressure by time, kPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure_kpa: Option<Series>,
    /// Volume pumped in by time, mm³.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub volume_mm3: Option<Series>,
    /// Amount of gas by time, relative to what fills it at rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gas: Option<Series>,
    /// Absolute pressure of the atmosphere, kPa.
    #[serde(default = "atmosphere", skip_serializing_if = "is_atmosphere")]
    pub atmosphere_kpa: f64,
    /// Polytropic exponent: 1 for constant temperature, 1.4 for air without exchange of heat.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub exponent: f64,
}

/// A force on nodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceTable {
    /// A node set, a surface, or where they are.
    pub nodes: Choice,
    /// Force in all, N, spread evenly over the faces or edges that the nodes make up; single nodes get equal shares.
    pub total: [f64; 3],
    /// Factor by time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<Series>,
}

/// A traction on faces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TractionTable {
    /// A surface.
    pub faces: Choice,
    /// Force per area at rest, MPa.
    pub traction_mpa: [f64; 3],
    /// Factor by time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<Series>,
}

/// A pressure on faces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PressureTable {
    /// A surface.
    pub faces: Choice,
    /// Pressure by time, kPa.
    pub pressure_kpa: Series,
}

/// Weight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GravityTable {
    /// Acceleration, mm/s².
    pub acceleration: [f64; 3],
    /// Factor by time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<Series>,
}

/// Two surfaces that may touch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactTable {
    /// Surface that carries the contact points.
    pub slave: Choice,
    /// Surface onto which they are projected; the same one for a surface that may touch itself.
    pub master: Choice,
    /// How the surfaces are kept apart; [`ContactMethod::Mortar`] if it is left out, or as in the gaps of an actuator.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub method: Option<ContactMethod>,
    /// Penalty stiffness, N/mm³; from the material and the faces' size if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
    /// Largest depth at the requested times, mm; a share of the faces' size if it is left out, or as in the gaps of an actuator.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub penetration_tolerance: Option<f64>,
    /// Whether each surface is the slave in turn.
    #[serde(default, skip_serializing_if = "is_default")]
    pub two_pass: bool,
    /// Whether the surfaces may overlap at rest; they are pressed out of each other by the first requested time.
    #[serde(default, skip_serializing_if = "is_default")]
    pub interference: bool,
}

/// When results are wanted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Times {
    /// Increasing times.
    pub times: Vec<f64>,
}

/// Solver settings; steps are in time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Steps {
    /// As for actuators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// As for actuators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual_tolerance: Option<f64>,
    /// As for actuators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_iterations: Option<usize>,
    /// First load step; a tenth of the last time if it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_step: Option<f64>,
    /// Largest load step; the last time if it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_step: Option<f64>,
    /// Smallest load step; 1/100,000 of the last time if it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min_step: Option<f64>,
    /// As for actuators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub continuation: Option<Continuation>,
    /// As for actuators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub states_past_limit: Option<usize>,
    /// As for actuators, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imperfection: Option<f64>,
}

fn one() -> f64 {
    1.0
}

fn is_one(x: &f64) -> bool {
    *x == 1.0
}

fn atmosphere() -> f64 {
    101.325
}

fn is_atmosphere(x: &f64) -> bool {
    *x == atmosphere()
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
