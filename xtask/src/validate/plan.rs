//! Which runs the report is made of: fixtures, meshes, pressures. Every mesh is named here and nowhere else.

use std::fmt;

/// A mesh as it is asked for on the command line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mesh {
    /// Element formulation.
    pub element: &'static str,
    /// Largest element edge, mm.
    pub size: f64,
}

/// Large faces like the paper's "larger mesh size": quadratic faces with sides of up to 4 mm. The pictures show it.
pub const COARSE: Mesh = Mesh { element: "hex27", size: 4.5 };
/// One refinement of it.
pub const REFINED: Mesh = Mesh { element: "hex27", size: 3.0 };
/// Two refinements.
pub const FINE: Mesh = Mesh { element: "hex27", size: 2.0 };
/// The paper's trilinear element with small plane faces.
pub const TRILINEAR: Mesh = Mesh { element: "hex8-sri", size: 1.0 };
/// The same, coarser: for what does not depend on the mesh, or when time is short.
pub const TRILINEAR_COARSE: Mesh = Mesh { element: "hex8-sri", size: 2.0 };

/// One element across each wall: for what is only to be solved.
pub const TRILINEAR_COARSEST: Mesh = Mesh { element: "hex8-sri", size: 4.0 };

impl fmt::Display for Mesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} mm", self.element, self.size)
    }
}

/// The two bodies of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// Two adjacent chambers, 18 mm long.
    TwoChambers,
    /// All eight chambers.
    Actuator,
}

impl Body {
    /// Its case file in `fixtures`.
    pub fn fixture(self) -> &'static str {
        match self {
            Self::TwoChambers => "two_chamber.toml",
            Self::Actuator => "actuator.toml",
        }
    }

    /// In a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::TwoChambers => "two chambers",
            Self::Actuator => "actuator",
        }
    }

    /// Number of gaps between chambers.
    pub fn gaps(self) -> usize {
        match self {
            Self::TwoChambers => 1,
            Self::Actuator => 7,
        }
    }
}

/// The two contact variants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Centre against centre.
    Single,
    /// 4 × 4 points against their projections.
    Multiple,
}

impl Method {
    /// Both, in the paper's order.
    pub const BOTH: [Self; 2] = [Self::Single, Self::Multiple];

    /// Value of `contact.method`.
    pub fn key(self) -> &'static str {
        match self {
            Self::Single => "single-point",
            Self::Multiple => "multi-point",
        }
    }

    /// In a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single-point",
            Self::Multiple => "multiple-point",
        }
    }
}

/// Pressures of the paper's shapes, kPa.
pub const PRESSURES: [f64; 5] = [5.0, 15.0, 25.0, 35.0, 50.0];
/// Pressure of the paper's pictures, kPa.
pub const PICTURED: f64 = 35.0;

/// One run of `pneuflex run`.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Name of its output folder.
    pub name: String,
    /// The body.
    pub body: Body,
    /// Its mesh.
    pub mesh: Mesh,
    /// The contact variant.
    pub method: Method,
    /// Pressures reached on, kPa.
    pub pressures: Vec<f64>,
    /// Whether fields are written.
    pub has_fields: bool,
    /// Further `--set` changes.
    pub changes: Vec<String>,
}

impl Run {
    /// The five pressures of the paper.
    pub fn standard(body: Body, mesh: Mesh, method: Method) -> Self {
        let (body_name, size) = (body.fixture().trim_end_matches(".toml"), mesh.size);
        Self {
            name: format!("{body_name}-{}-{size}-{}", mesh.element, method.key()),
            body,
            mesh,
            method,
            pressures: PRESSURES.into(),
            has_fields: true,
            changes: Vec::new(),
        }
    }

    /// The same with changes to the case, under another name.
    pub fn varied(self, suffix: &str, changes: &[String]) -> Self {
        Self { name: format!("{}-{suffix}", self.name), changes: changes.to_vec(), ..self }
    }

    /// The same landing on other pressures, without fields.
    pub fn landing_on(self, pressures: Vec<f64>) -> Self {
        Self { pressures, has_fields: false, ..self }
    }

    /// Rough seconds on two quiet cores, for the progress display only.
    pub fn expected_s(&self) -> f64 {
        let body = match self.body {
            Body::TwoChambers => 1.0,
            Body::Actuator => 4.5,
        };
        let quadratic = (4.5 / self.mesh.size).powf(1.5);
        let mesh = if self.mesh.element == "hex27" { 1.7 * quadratic } else { 1.0 / self.mesh.size.powi(2) };
        let whole = if self.changes.iter().any(|c| c.contains("whole")) { 2.5 } else { 1.0 };
        0.2 + body * mesh * whole * (0.4 + 0.12 * self.pressures.len() as f64)
    }

    /// Arguments of the program, case file and output folder left out.
    pub fn settings(&self) -> Vec<String> {
        let pressures: Vec<String> = self.pressures.iter().map(f64::to_string).collect();
        let mut set = vec![
            format!("mesh.element={}", self.mesh.element),
            format!("mesh.size={:?}", self.mesh.size),
            format!("contact.method={}", self.method.key()),
            format!("load.pressure_kpa=[{}]", pressures.join(", ")),
            format!("output.fields={}", self.has_fields),
        ];
        set.extend(self.changes.iter().cloned());
        set
    }
}

/// How much is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Every mesh and every statement.
    Full,
    /// For CI: the actuator on one mesh, fewer pressures along the path, rod and sensitivities (of fewer lengths) on a coarse mesh.
    Quick,
}

impl Extent {
    /// Meshes of the statements about a body; the first one is that of the pictures.
    pub fn meshes(self, body: Body) -> Vec<Mesh> {
        match (self, body) {
            (Self::Quick, Body::Actuator) => vec![COARSE],
            _ => vec![COARSE, REFINED],
        }
    }

    /// Meshes of the chart of penetration against face size, on the two chambers.
    pub fn face_sizes(self) -> Vec<Mesh> {
        match self {
            Self::Full => vec![COARSE, REFINED, FINE, TRILINEAR],
            Self::Quick => vec![COARSE, REFINED, TRILINEAR],
        }
    }

    /// Meshes on which rods are identified.
    pub fn rod_meshes(self) -> Vec<Mesh> {
        match self {
            Self::Full => self.meshes(Body::Actuator),
            Self::Quick => vec![TRILINEAR_COARSE],
        }
    }

    /// Distance of the pressures along which work is integrated, kPa.
    pub fn work_step(self, body: Body) -> f64 {
        match (self, body) {
            (Self::Full, Body::TwoChambers) => 1.0,
            (Self::Full, Body::Actuator) => 1.25,
            (Self::Quick, _) => 5.0,
        }
    }

    /// Mesh of the sensitivities.
    pub fn sensitivity_mesh(self) -> Mesh {
        match self {
            Self::Full => COARSE,
            Self::Quick => TRILINEAR_COARSEST,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Quick => "quick",
        }
    }
}
