//! Bodies that are built in memory, from nodes and cells.

use std::path::Path;

use pneuflex_deck::msh;
use pneuflex_mesh::{Facet, Mesh};
use pneuflex_model::model_file::{
    CavityTable, ContactTable, ForceTable, Model, PressureTable, RegionTable, Source, SupportTable, Times,
};
use pneuflex_model::{Choice, Formulation, Material, Probe, Problem, Series};

use crate::analysis::Analysis;
use crate::error::Error;
use crate::input_error::InputError;
use crate::recorded_mesh::{FILE, check, plain_mesh};
use crate::store::Store;

/// Absolute pressure of the atmosphere, kPa, where a cavity is filled with a gas.
const ATMOSPHERE_KPA: f64 = 101.325;

/// A body of any shape with materials, supports and loads on named sets of its nodes, faces and elements.
///
/// What has no method of its own is written into [`Body::model`], whose tables are those of a model file. Lengths are in mm, pressures in
/// kPa, forces in N. A load without a time of its own grows in proportion to time and has its full value at the last requested one.
#[derive(Clone, Debug)]
pub struct Body {
    /// Materials, supports, loads and settings, by the names of sets.
    pub model: Model,
    mesh: Mesh,
    formulation: Formulation,
}

impl Body {
    /// A body from the positions of its nodes, mm, and the nodes of every cell in VTK's order; cells have the family of the formulation.
    ///
    /// # Errors
    /// [`Error::Input`]: a cell with another number of nodes than its family has or with a node that is not there, a position that is not
    /// finite, no cell at all.
    pub fn new(formulation: Formulation, nodes: Vec<[f64; 3]>, cells: &[impl AsRef<[u32]>]) -> Result<Self, Error> {
        let kind = formulation.element_kind();
        for (number, cell) in cells.iter().enumerate() {
            let found = cell.as_ref().len();
            if found != kind.num_nodes() {
                let wanted = kind.num_nodes();
                return Err(InputError::new(format!("cell {number} has {found} nodes instead of {wanted}")).into());
            }
        }
        let connectivity = cells.iter().flat_map(|cell| cell.as_ref().iter().copied()).collect();
        Self::of_mesh(formulation, plain_mesh(kind.into(), nodes, connectivity))
    }

    /// A body from a mesh with named sets.
    ///
    /// # Errors
    /// As for [`Self::new`], and for members of sets that are not there.
    pub fn of_mesh(formulation: Formulation, mesh: Mesh) -> Result<Self, Error> {
        check(formulation, &mesh)?;
        let mut model = Model { model: Some(Source::of_file(FILE)), ..Model::default() };
        model.output.fields = true;
        Ok(Self { model, mesh, formulation })
    }

    /// A body from a mesh of Gmsh (`.msh`) with its physical groups as sets; `scale` is the number of mm per unit of length. Where its elements
    /// have no stable pressures, nodes are added to them for the analysis, unless `model.mesh.element` is set to what they are.
    ///
    /// # Errors
    /// [`Error::Input`] with everything that is wrong with the file.
    pub fn load(path: impl AsRef<Path>, scale: f64) -> Result<Self, Error> {
        let path = path.as_ref();
        let bytes = Store::Disk.bytes(path).map_err(|why| InputError::about_file(path, why))?;
        Self::from_msh(&path.display().to_string(), &bytes, scale)
    }

    /// The same from the file's bytes; `name` is what it is called in messages.
    ///
    /// # Errors
    /// As there.
    pub fn from_msh(name: &str, bytes: &[u8], scale: f64) -> Result<Self, Error> {
        let wrong = |errors: Vec<_>| errors.into_iter().map(InputError::from).collect::<Vec<_>>();
        let mesh = msh::read(name, bytes).map_err(wrong)?.mesh.map_nodes(|x| x.map(|t| scale * t));
        let unknown = || InputError::new(format!("{name}: {} cannot be solved", mesh.words()));
        let enriched = mesh.kinds.only().and_then(|kind| kind.enriched()).and_then(Formulation::of_kind);
        let mut body = Self::of_mesh(Formulation::of_mesh(&mesh).ok_or_else(unknown)?, mesh)?;
        body.model.mesh.element = enriched;
        Ok(body)
    }

    /// The mesh, without nodes that are added for the analysis.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Calls the nodes for whose positions `holds` is true `name`.
    pub fn name_nodes(&mut self, name: &str, holds: impl Fn([f64; 3]) -> bool) -> &mut Self {
        let nodes = self.mesh.select_nodes(holds);
        self.mesh.node_sets.insert(name.into(), nodes);
        self
    }

    /// Calls the faces of the body's surface all of whose nodes are where `holds` is true `name`.
    pub fn name_faces(&mut self, name: &str, holds: impl Fn([f64; 3]) -> bool) -> &mut Self {
        let facets = self.mesh.select_facets(holds);
        self.mesh.facet_sets.insert(name.into(), facets);
        self
    }

    /// Adds a named set of nodes, replacing one of the same name.
    pub fn add_node_set(&mut self, name: &str, mut nodes: Vec<u32>) -> &mut Self {
        nodes.sort_unstable();
        nodes.dedup();
        self.mesh.node_sets.insert(name.into(), nodes);
        self
    }

    /// Adds a named set of faces, given by cell and number of the face in it, replacing one of the same name.
    pub fn add_face_set(&mut self, name: &str, mut faces: Vec<Facet>) -> &mut Self {
        faces.sort_unstable();
        faces.dedup();
        self.mesh.facet_sets.insert(name.into(), faces);
        self
    }

    /// Adds a named set of cells, replacing one of the same name.
    pub fn add_cell_set(&mut self, name: &str, mut cells: Vec<u32>) -> &mut Self {
        cells.sort_unstable();
        cells.dedup();
        self.mesh.element_sets.insert(name.into(), cells);
        self
    }

    /// Sets the material of all cells that get no other one by [`Self::region`].
    pub fn material(&mut self, material: Material) -> &mut Self {
        self.model.material = Some(material);
        self
    }

    /// Gives a set of cells another material.
    pub fn region(&mut self, cells: &str, material: Material) -> &mut Self {
        let elements = Some(cells.into());
        self.model.regions.push(RegionTable { name: cells.into(), elements, within: None, material });
        self
    }

    /// Holds a set of nodes, the nodes of a set of faces, or those that a [`Choice`] says, along axes such as `"xyz"` or `"y"`.
    pub fn hold(&mut self, nodes: impl Into<Choice>, axes: &str) -> &mut Self {
        let (nodes, axes) = (nodes.into(), axes.to_owned());
        self.model.supports.push(SupportTable { nodes, axes, displacement: None, factor: None, symmetry: false });
        self
    }

    /// Says that the body is cut by a plane of symmetry normal to an axis (`"x"`, `"y"` or `"z"`), in which a set of nodes, or the nodes of
    /// a set of faces, lie: they are held along that axis, and results are those of the whole body.
    pub fn symmetry(&mut self, nodes: impl Into<Choice>, axis: &str) -> &mut Self {
        let (nodes, axes) = (nodes.into(), axis.to_owned());
        self.model.supports.push(SupportTable { nodes, axes, displacement: None, factor: None, symmetry: true });
        self
    }

    /// Moves a set of nodes along axes, by `displacement` (mm) at the last time.
    pub fn displace(&mut self, nodes: impl Into<Choice>, axes: &str, displacement: [f64; 3]) -> &mut Self {
        let (nodes, axes) = (nodes.into(), axes.to_owned());
        self.model.supports.push(SupportTable {
            nodes,
            axes,
            displacement: Some(displacement),
            factor: None,
            symmetry: false,
        });
        self
    }

    /// Fills a cavity, whose walls are a set of faces, with air of a pressure in kPa. The cavity's volume is reported where it is defined.
    pub fn cavity(&mut self, faces: &str, pressure_kpa: impl Into<Series>) -> &mut Self {
        self.model.cavities.push(CavityTable {
            name: faces.into(),
            faces: faces.into(),
            pressure_kpa: Some(pressure_kpa.into()),
            volume_mm3: None,
            gas: None,
            atmosphere_kpa: ATMOSPHERE_KPA,
            exponent: 1.0,
        });
        self
    }

    /// Lets a pressure in kPa act on a set of faces, which it follows as they move.
    pub fn pressure(&mut self, faces: impl Into<Choice>, pressure_kpa: impl Into<Series>) -> &mut Self {
        self.model.pressures.push(PressureTable { faces: faces.into(), pressure_kpa: pressure_kpa.into() });
        self
    }

    /// Lets a force (N, in all) act on a set of nodes; it keeps its direction.
    pub fn force(&mut self, nodes: impl Into<Choice>, total: [f64; 3]) -> &mut Self {
        self.model.forces.push(ForceTable { nodes: nodes.into(), total, factor: None });
        self
    }

    /// Keeps one set of faces from passing through another, or a set from passing through itself.
    pub fn contact(&mut self, slave: impl Into<Choice>, master: impl Into<Choice>) -> &mut Self {
        let (slave, master) = (slave.into(), master.into());
        let (method, stiffness, penetration_tolerance) = (None, None, None);
        let table = ContactTable {
            slave,
            master,
            method,
            stiffness,
            penetration_tolerance,
            two_pass: false,
            interference: false,
        };
        self.model.contacts.push(table);
        self
    }

    /// Reports the displacement of the node nearest to a point.
    pub fn probe(&mut self, name: &str, at: [f64; 3]) -> &mut Self {
        self.model.probes.push(Probe { name: name.into(), at });
        self
    }

    /// Sets the times at which results are wanted, increasing. Without a schedule of its own a load has its full value at the last one.
    pub fn times(&mut self, times: impl Into<Vec<f64>>) -> &mut Self {
        self.model.load = Some(Times { times: times.into() });
        self
    }

    /// Puts the problem together.
    ///
    /// # Errors
    /// [`Error::Input`]: every value out of range, every set that does not exist or is empty, times that are missing, a part that nothing holds.
    pub fn analysis(&self) -> Result<Analysis, Error> {
        let path = Path::new("body.toml");
        let said = |error: pneuflex_model::CaseError| InputError::new(error.to_string()).of_key(&error.key);
        let problems = self.model.problems();
        if !problems.is_empty() {
            return Err(problems.into_iter().map(said).collect::<Vec<_>>().into());
        }
        check(self.formulation, &self.mesh)?;
        // Elements of several families have no formulation that could be chosen.
        let own = self.mesh.kinds.only().map(|_| self.formulation);
        let problem = Problem::body(self.mesh.clone(), self.formulation, Material::default())
            .solved_by(self.model.mesh.element.or(own))
            .map_err(said)?;
        let analysis = Analysis::of_body(path, self.model.clone(), problem, None);
        Ok(analysis.map_err(|errors| errors.into_iter().map(said).collect::<Vec<_>>())?.held()?)
    }
}
