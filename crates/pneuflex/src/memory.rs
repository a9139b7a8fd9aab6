//! How much memory a case will need, before anything is built.

use std::fs;
use std::path::Path;

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
    /// Nodes per lattice cell approach 1, 4, 8, 12 and 26 (hex8, hex20, hex27 and tet10, which share their nodes, wedge21, tet15) and exceed that
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
        Self { elements, unknowns, bytes: bytes(bytes_per_unknown(kind), actuator.chambers, unknowns) + grid }
    }

    /// Estimates a case whose mesh has the given numbers of elements and unknowns.
    pub fn of_mesh(case: &Case, elements: usize, unknowns: usize) -> Self {
        let bytes =
            bytes(bytes_per_unknown(case.mesh.formulation().element_kind()), case.actuator.chambers, unknowns as f64);
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
        let per_unknown = mesh.families().into_iter().map(bytes_per_unknown).fold(0.0, f64::max);
        let bytes = bytes(per_unknown, 1, unknowns) + equations.iter().map(of_equation).sum::<f64>();
        Self { elements: mesh.num_elements() as f64, unknowns, bytes }
    }

    /// Estimates a body of any shape with every element divided into eight, so many times, before it is.
    pub fn of_divided(mesh: &Mesh, times: u32) -> Self {
        let parts = f64::from(pneuflex_mesh::PARTS as u32).powi(times as i32);
        let [elements, unknowns] = [mesh.num_elements() as f64, 3.0 * mesh.num_nodes() as f64].map(|n| parts * n);
        let per_unknown = mesh.families().into_iter().map(bytes_per_unknown).fold(0.0, f64::max);
        Self { elements, unknowns, bytes: bytes(per_unknown, 1, unknowns) }
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

fn bytes_per_unknown(kind: ElementKind) -> f64 {
    // Nodes inside of elements and in their faces are coupled with few others.
    match kind {
        ElementKind::Tet15 => 560.0,
        ElementKind::Wedge21 => 800.0,
        _ if kind.is_quadratic() => 1000.0,
        _ => 800.0,
    }
}

/// Peak memory in bytes, dominated by the factor of the tangent.
///
/// The body is a chain of chambers: the memory grows like their number, and for one chamber with n unknowns like n^1.25,
/// between the n log n of a plane body and the n^(4/3) of a cube. The constants are 5 to 15 % above the peak memory
/// measured with both default actuators, 5,900 to 278,000 unknowns without contact; contact adds up to 15 %.
fn bytes(per_unknown: f64, chambers: usize, unknowns: f64) -> f64 {
    const PROGRAM: f64 = 1e7;
    let chambers = chambers as f64;
    PROGRAM + chambers * per_unknown * (unknowns / chambers).powf(1.25)
}

/// Memory the system can still give away, bytes: what is free, and what the limits of this process leave of it; `None` where it does not say.
pub fn available() -> Option<f64> {
    let read = |path: &str| fs::read_to_string(path).ok();
    let free = read("/proc/meminfo").and_then(|text| kibibytes(&text, "MemAvailable:"));
    let of_group = read("/proc/self/cgroup").and_then(|groups| left_to_group(&groups, Path::new("/sys/fs/cgroup")));
    let of_process = read("/proc/self/limits")
        .zip(read("/proc/self/status"))
        .and_then(|(limits, status)| left_to_process(&limits, &status));
    [free, of_group, of_process].into_iter().flatten().reduce(f64::min)
}

/// A number in KiB behind a name, in bytes.
fn kibibytes(text: &str, name: &str) -> Option<f64> {
    let number: f64 =
        text.lines().find_map(|line| line.strip_prefix(name))?.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024.0 * number)
}

/// What the address space of the process may still grow by (`ulimit -v`).
fn left_to_process(limits: &str, status: &str) -> Option<f64> {
    let limit = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: f64 = limit.split_whitespace().next()?.parse().ok()?;
    Some((limit - kibibytes(status, "VmSize:")?).max(0.0))
}

/// What a container, or any other control group, leaves to its processes: the least over the group and those around it, in version 2 and
/// in version 1. `groups` is what the process's file `cgroup` says; within a container its paths may be those of the outside.
fn left_to_group(groups: &str, root: &Path) -> Option<f64> {
    let mut least: Option<f64> = None;
    for line in groups.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else { continue };
        let (root, names) = if controllers.is_empty() {
            (root.to_owned(), ["memory.max", "memory.current", "inactive_file"])
        } else if controllers.split(',').any(|controller| controller == "memory") {
            (root.join("memory"), ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"])
        } else {
            continue;
        };
        let around = Path::new(path.trim_start_matches('/')).ancestors();
        let left = around.filter_map(|group| left_to_one_group(&root.join(group), names)).reduce(f64::min);
        least = [least, left].into_iter().flatten().reduce(f64::min);
    }
    least
}

/// The same of one group; what it holds only to read files faster can be given back.
fn left_to_one_group(folder: &Path, [limit, used, cached]: [&str; 3]) -> Option<f64> {
    let read = |name: &str| fs::read_to_string(folder.join(name)).ok();
    // Not a number where there is no limit.
    let limit: f64 = read(limit)?.trim().parse().ok()?;
    let used: f64 = read(used)?.trim().parse().ok()?;
    let cache = |text: String| text.lines().find_map(|line| line.strip_prefix(cached)?.trim().parse::<f64>().ok());
    let cached = read("memory.stat").and_then(cache).unwrap_or(0.0);
    Some((limit - used + cached).max(0.0))
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
            load: Load { pressure_kpa: vec![1.0], chamber_factor: None },
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
            (two(), Formulation::Tet15, 1.0, 823_300.0),
            (two(), Formulation::Wedge21, 1.0, 494_416.0),
        ] {
            let mesh = MeshOptions::uniform(h, element);
            let ratio = Estimate::of(&case(actuator, mesh)).bytes / (1024.0 * kibibytes);
            assert!((0.95..1.35).contains(&ratio), "{element} {h}: {ratio}");
        }
    }

    #[test]
    fn limits_of_groups_and_of_the_process_count() {
        let root = std::env::temp_dir().join(format!("pneuflex-memory-{}", std::process::id()));
        let write = |name: &str, text: &str| {
            let file = root.join(name);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, text).unwrap();
        };
        // Version 2, the limit is that of the group around.
        write("a/memory.max", "1000\n");
        write("a/memory.current", "300\n");
        write("a/memory.stat", "anon 200\nactive_file 1\ninactive_file 50\n");
        write("a/b/memory.max", "max\n");
        write("a/b/memory.current", "300\n");
        assert_eq!(left_to_group("0::/a/b\n", &root), Some(750.0));
        assert_eq!(left_to_group("0::/\n", &root), None);
        // Version 1; a container sees its own group as the root.
        write("memory/memory.limit_in_bytes", "500\n");
        write("memory/memory.usage_in_bytes", "600\n");
        assert_eq!(left_to_group("4:memory,x:/docker/12\n3:cpu:/\n0::/a\n", &root), Some(0.0));
        fs::remove_dir_all(&root).unwrap();

        let limits = |limit: &str| format!("Limit  Soft Limit\nMax address space         {limit}  unlimited  bytes\n");
        assert_eq!(left_to_process(&limits("4096000"), "VmPeak: 9 kB\nVmSize:     1000 kB\n"), Some(3_072_000.0));
        assert_eq!(left_to_process(&limits("unlimited"), "VmSize: 1000 kB\n"), None);
        assert_eq!(kibibytes("MemFree: 1 kB\nMemAvailable:    2 kB\n", "MemAvailable:"), Some(2048.0));
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
