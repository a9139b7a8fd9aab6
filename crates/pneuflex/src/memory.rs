//! How much memory a case will need, before anything is built.

use std::fs;

use pneuflex_mesh::{Actuator, Cuts, ElementKind, Mesh, MeshSize};
use pneuflex_model::{Case, Curve, LinearEquation};

use crate::input_error::{InputError, InputErrorKind};
use crate::words::{count, size};

/// Memory that meshing takes for every cell of the grid around the body, air and gaps included.
const GRID_BYTES: f64 = 41.0;

/// How much memory a body may be estimated to need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MemoryLimit {
    /// What the system says is available.
    #[default]
    Available,
    /// As much as it takes.
    None,
}

/// Size of a case as far as it is known from its lengths alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Number of elements.
    pub elements: f64,
    /// Number of unknown displacements.
    pub unknowns: f64,
    /// Peak memory, bytes.
    pub bytes: f64,
}

impl Estimate {
    /// Estimates a case whose values are within their ranges.
    ///
    /// Nodes per lattice cell approach 1, 4 and 8 (hex8, hex20, hex27 and tet10, which share their nodes) and exceed that
    /// by a share that falls like the surface does: fitted to the two default actuators from 4 to 0.25 mm, within 10 % up
    /// to 1 mm cells.
    pub fn of(case: &Case) -> Self {
        Self::of_size(case, &case.mesh.mesh_size(&case.actuator))
    }

    /// The same for other element sizes than the case's own.
    pub fn of_size(case: &Case, size: &MeshSize) -> Self {
        Self::of_actuator(&case.actuator, case.mesh.formulation().element_kind(), size, &Cuts::default())
    }

    /// Estimates an actuator's mesh with faces of elements in further planes.
    pub fn of_actuator(actuator: &Actuator, kind: ElementKind, size: &MeshSize, cuts: &Cuts) -> Self {
        let cells = actuator.estimate_cells(size, cuts);
        let per_chamber = cells / actuator.chambers as f64;
        let [inside, surface] = kind.lattice.nodes_per_cell;
        let unknowns = 3.0 * cells * (inside + surface / per_chamber.cbrt());
        let elements = cells * kind.lattice.elements as f64;
        let grid = GRID_BYTES * actuator.estimate_grid(size, cuts);
        Self { elements, unknowns, bytes: bytes(kind, actuator.chambers, unknowns) + grid }
    }

    /// Estimates a case whose mesh has the given numbers of elements and unknowns.
    pub fn of_mesh(case: &Case, elements: usize, unknowns: usize) -> Self {
        let bytes = bytes(case.mesh.formulation().element_kind(), case.actuator.chambers, unknowns as f64);
        Self { elements: elements as f64, unknowns: unknowns as f64, bytes }
    }

    /// Estimates a body of any shape that is meshed already, as if it were one chamber, with linear equations between its nodes.
    ///
    /// An equation couples its n degrees of freedom with each other, in the tangent, in its factor and while it is formed: half of n² blocks
    /// of 3 × 3 numbers each time. One with a right-hand side has a column over all nodes as well, and the answer to it.
    pub fn of_body(mesh: &Mesh, equations: &[LinearEquation]) -> Self {
        const COUPLING: f64 = 3.0 * 0.5 * 72.0;
        let unknowns = 3.0 * mesh.num_nodes() as f64;
        let of_equation = |equation: &LinearEquation| {
            let columns = if equation.value == Curve::ZERO { 0.0 } else { 2.0 };
            COUPLING * (equation.terms.len() as f64).powi(2) + columns * 8.0 * unknowns
        };
        let bytes = bytes(mesh.kind, 1, unknowns) + equations.iter().map(of_equation).sum::<f64>();
        Self { elements: mesh.num_elements() as f64, unknowns, bytes }
    }

    /// Refuses what needs more memory than there is, unless `limit` says otherwise; else returns what to warn of.
    ///
    /// # Errors
    /// The estimate and the memory available.
    pub fn within(&self, limit: MemoryLimit) -> Result<Option<String>, InputError> {
        if self.elements < 1.0 {
            return Err(InputError::new("the lengths of [actuator] differ too much to be meshed together"));
        }
        let available = available();
        // An estimate that is no number or infinite is too large also for a machine that does not say what it has.
        let fits = self.bytes.is_finite() && available.is_none_or(|bytes| self.bytes <= bytes);
        let text = format!(
            "{} elements and {} unknowns need about {}{}",
            count(self.elements),
            count(self.unknowns),
            size(self.bytes),
            available.map_or(String::new(), |bytes| format!(", {} are available", size(bytes)))
        );
        let can_be_numbered = self.unknowns < 3.0 * f64::from(u32::MAX);
        let may_try = limit == MemoryLimit::None && can_be_numbered;
        if !fits && !may_try {
            let kind = if can_be_numbered { InputErrorKind::TooLarge } else { InputErrorKind::Other };
            let help = "choose a coarser mesh.resolution or a larger mesh.size".to_owned();
            let error = InputError::new(format!("this case will not fit in memory: {text}"));
            return Err(error.of_kind(kind).with_help(Some(help)));
        }
        let is_large = !fits || available.is_some_and(|bytes| self.bytes > 0.5 * bytes) || self.elements >= 1e6;
        Ok(is_large.then(|| format!("this is a large case: {text}")))
    }
}

/// Peak memory in bytes, dominated by the factor of the tangent.
///
/// The body is a chain of chambers: the memory grows like their number, and for one chamber with n unknowns like n^1.25,
/// between the n log n of a plane body and the n^(4/3) of a cube. The constants are 5 to 15 % above the peak memory
/// measured with both default actuators, 5,900 to 278,000 unknowns without contact; contact adds up to 15 %.
fn bytes(kind: ElementKind, chambers: usize, unknowns: f64) -> f64 {
    const PROGRAM: f64 = 1e7;
    let per_unknown = if kind.is_quadratic() { 1000.0 } else { 800.0 };
    let chambers = chambers as f64;
    PROGRAM + chambers * per_unknown * (unknowns / chambers).powf(1.25)
}

/// Memory the system can still give away, bytes; `None` where it does not say.
fn available() -> Option<f64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_mesh::{Actuator, build_actuator};
    use pneuflex_model::{Contact, Formulation, Load, Material, MeshOptions, Output, Solver};

    fn case(actuator: Actuator, mesh: MeshOptions) -> Case {
        Case {
            title: String::new(),
            actuator,
            mesh,
            material: Material::default(),
            contact: Contact::default(),
            load: Load { pressure_kpa: vec![1.0] },
            obstacles: Vec::new(),
            probes: Vec::new(),
            solver: Solver::default(),
            output: Output::default(),
        }
    }

    /// Measured peak memory in KiB by actuator, element, size.
    #[test]
    fn memory_is_estimated_within_a_third() {
        let (two, full) = (Actuator::two_chambers, Actuator::full);
        for (actuator, element, h, kibibytes) in [
            (two(), Formulation::Hex8Sri, 1.0, 38_508.0),
            (two(), Formulation::Hex8Sri, 0.5, 345_132.0),
            (two(), Formulation::Hex8Sri, 0.25, 4_057_640.0),
            (full(), Formulation::Hex8Sri, 1.0, 145_524.0),
            (full(), Formulation::Hex8Sri, 0.5, 1_318_060.0),
            (full(), Formulation::Hex20, 1.0, 878_504.0),
            (two(), Formulation::Hex27, 1.0, 373_344.0),
        ] {
            let mesh = MeshOptions::uniform(h, element);
            let ratio = Estimate::of(&case(actuator, mesh)).bytes / (1024.0 * kibibytes);
            assert!((0.95..1.35).contains(&ratio), "{element} {h}: {ratio}");
        }
    }

    #[test]
    fn unknowns_are_estimated_within_a_tenth() {
        for actuator in [Actuator::two_chambers(), Actuator::full()] {
            for element in Formulation::ALL {
                for h in [1.0, 0.5] {
                    let mesh = MeshOptions::uniform(h, element);
                    let built = build_actuator(&actuator, &mesh.mesh_size(&actuator), element.element_kind()).unwrap();
                    let case = case(actuator.clone(), mesh);
                    let (estimate, exact) = (Estimate::of(&case).unknowns, 3.0 * built.num_nodes() as f64);
                    assert!((estimate / exact - 1.0).abs() < 0.1, "{element} {h}: {estimate} for {exact}");
                }
            }
        }
    }
}
