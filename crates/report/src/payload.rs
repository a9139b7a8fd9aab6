//! The data that the page's modules work on, as JSON.

use pneuflex_mesh::Facet;
use pneuflex_post::stress::von_mises;
use serde::Serialize;

use crate::body::{Block, Body};
use crate::error::ReportError;
use crate::obstacles::{self, Drawn};
use crate::parted::Parted;
use crate::quantise::{Quantised, floats, integers, small_integers};
use crate::regions::Regions;
use crate::report::Report;
use crate::series::Series;
use crate::skin::{Lines, Run, Skin, in_planes};
use crate::state::State;
use crate::stretch::{largest_stretch, thickness_change};
use crate::subdivision::tetrahedra;
use crate::summary::Reached;

#[derive(Serialize)]
struct Payload<'a> {
    title: &'a str,
    clock: ClockData<'a>,
    series: &'a Series,
    #[serde(skip_serializing_if = "Option::is_none")]
    body: Option<BodyData<'a>>,
}

/// What the slider stands for.
#[derive(Serialize)]
pub(crate) struct ClockData<'a> {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    /// What is at zero, in words; the body at rest if it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rest: Option<&'static str>,
    /// Decimals between the series' times; as many as these need if it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) decimals: Option<usize>,
    /// The parameter at the series' times, where it turned back.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) parameters: Option<&'a [f64]>,
}

/// Elements of one family.
#[derive(Serialize)]
struct BlockData {
    nodes: String,
    nodes_per_element: usize,
    tetrahedra: Vec<[u8; 4]>,
    /// The region of every element, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    regions: Option<String>,
}

#[derive(Serialize)]
struct BodyData<'a> {
    /// By axis, whether there is a plane of symmetry normal to it, through the origin.
    mirrored: [bool; 3],
    /// Point that the positions of nodes are relative to, mm: those of a small body far away would lose digits.
    origin: [f64; 3],
    regions: &'a [String],
    nodes: String,
    elements: Vec<BlockData>,
    skin_vertices: String,
    skin_triangles: String,
    skin_runs: &'a [Run],
    mesh_edges: LineData<'a>,
    sharp_edges: LineData<'a>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    obstacles: Vec<Drawn<'a>>,
    probes: Vec<ProbeData<'a>>,
    /// Nodes of the mesh. Behind them come copies of nodes for further regions, which belong to the nodes `copied`; those beyond were added.
    mesh_nodes: usize,
    copied: String,
    states: Vec<StateData>,
}

#[derive(Serialize)]
struct LineData<'a> {
    pairs: String,
    runs: &'a [Run],
}

#[derive(Serialize)]
struct ProbeData<'a> {
    name: &'a str,
    node: usize,
}

#[derive(Serialize)]
struct StateData {
    time: f64,
    displacement: Quantised,
    von_mises: Quantised,
    contact_pressure: Quantised,
    /// Components of the stress, MPa, the largest stretch, and the change of thickness at the surface (relative), coarsely: they are for colours.
    stress: Vec<Quantised>,
    stretch: Quantised,
    thickness: Quantised,
    /// The largest von Mises stress, MPa, as the table has it.
    largest_von_mises: f64,
    /// Values that 99 % of the nodes (for the contact: of the nodes in contact) do not exceed.
    typical: Typical,
}

#[derive(Serialize)]
struct Typical {
    von_mises: f64,
    contact_pressure: f64,
}

/// The data as JSON that can stand within a `script` element.
pub fn of(report: &Report<'_>, series: &Series) -> Result<String, ReportError> {
    let drawing = report.states.map(|_| Drawing::new(report));
    let body = drawing.as_ref().zip(report.states).map(|(drawing, states)| drawing.data(report, states, series));
    let body = body.transpose()?;
    let parameters = series.parameters.as_deref();
    let clock = ClockData { name: report.parameter(), unit: report.unit(), rest: None, decimals: None, parameters };
    let payload = Payload { title: report.title, clock, series, body };
    let text = serde_json::to_string(&payload).map_err(|e| ReportError::Json(e.to_string()))?;
    Ok(for_script(&text))
}

/// JSON without the one character that could end the script element around it.
pub fn for_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// What of a report's body is the same in all states.
struct Drawing<'a> {
    parted: Parted<'a>,
    body: Body,
    regions: Regions,
    skin: Skin,
    /// Facets of the surface that are no cuts.
    walls: Vec<Facet>,
    origin: [f64; 3],
}

impl<'b> Drawing<'b> {
    fn new(report: &Report<'b>) -> Self {
        let mesh = &report.problem.mesh;
        let (regions, planes) = (Regions::of(report.problem), report.symmetry_nodes());
        let parted = Parted::new(report.problem, &regions);
        let body = Body::new(parted.mesh());
        let skin = Skin::new(mesh, &report.problem.cavity_facets(), &planes, &regions, &body);
        let is_cut = in_planes(mesh, &planes);
        let walls = mesh.boundary_facets().into_iter().filter(|&facet| !is_cut(facet)).collect();
        // Mirror images are those at planes through the origin.
        let mut origin = centre(&mesh.nodes);
        report.problem.symmetry.iter().for_each(|plane| origin[plane.axis] = plane.at);
        Self { parted, body, regions, skin, walls, origin }
    }

    fn block_data(&self, block: &Block) -> BlockData {
        let of_element = || block.elements.iter().map(|&element| self.regions.of_element(element));
        BlockData {
            nodes: integers(&block.connectivity),
            nodes_per_element: block.family.num_nodes(),
            tetrahedra: tetrahedra(block.family),
            regions: self.regions.are_many().then(|| small_integers(&of_element().collect::<Vec<_>>())),
        }
    }

    fn data<'a>(
        &'a self,
        report: &'a Report<'_>,
        states: &[State],
        series: &Series,
    ) -> Result<BodyData<'a>, ReportError> {
        let Self { parted, body, regions, skin, origin, .. } = self;
        let mesh = &report.problem.mesh;
        let nodes: Vec<f64> = body.nodes.iter().flat_map(|x| [0, 1, 2].map(|d| x[d] - origin[d])).collect();
        let lines = |lines: &'a Lines| LineData { pairs: integers(lines.pairs.as_flattened()), runs: &lines.runs };
        let probes = report.summary.probes.iter().filter(|(_, site)| site.node < mesh.num_nodes());
        let reached = report.summary.reached().map(|(_, reached)| reached);
        let of_states = states.iter().zip(reached).zip(&series.times[1..]);
        Ok(BodyData {
            mirrored: report.mirrored(),
            origin: *origin,
            regions: &regions.names,
            nodes: floats(&nodes),
            elements: body.blocks().iter().map(|block| self.block_data(block)).collect(),
            skin_vertices: integers(&skin.vertices),
            skin_triangles: integers(skin.triangles.as_flattened()),
            skin_runs: &skin.runs,
            mesh_edges: lines(&skin.mesh_edges),
            sharp_edges: lines(&skin.sharp_edges),
            obstacles: obstacles::drawn(report, series, *origin)?,
            probes: probes.map(|(name, site)| ProbeData { name, node: site.node }).collect(),
            mesh_nodes: mesh.num_nodes(),
            copied: integers(&parted.copied),
            states: of_states
                .map(|((state, reached), time)| self.state_data(state, reached, *time))
                .collect::<Result<_, _>>()?,
        })
    }

    fn state_data(&self, state: &State, reached: &Reached, time: f64) -> Result<StateData, ReportError> {
        let Self { parted, body, .. } = self;
        let mesh = parted.mesh();
        let displacement = parted.spread(&state.displacement);
        let stresses = parted.stress(&state.stress, &state.displacement)?;
        let mut stress_sizes = state.von_mises.clone();
        stress_sizes.extend(parted.copied.iter().map(|_| 0.0));
        for node in parted.several() {
            stress_sizes[node] = von_mises(stresses[node]);
        }
        let quantised =
            |name: &str, values: &[f64]| Quantised::new(values).ok_or_else(|| ReportError::NotFinite(name.into()));
        // Between the nodes of hex20 a field may overshoot below zero, which neither of these can be.
        let scalar = |values: &[f64]| body.completed(values, 1).into_iter().map(|x| x.max(0.0)).collect::<Vec<f64>>();
        let mut touching: Vec<f64> = state.contact_pressure.iter().copied().filter(|p| *p > 0.0).collect();
        touching.sort_by(f64::total_cmp);
        let coarse = |name: &str, values: &[f64]| {
            Quantised::coarse(&body.completed(values, 1)).ok_or_else(|| ReportError::NotFinite(name.into()))
        };
        let component = |k: usize| {
            let values: Vec<f64> = stresses.iter().map(|stress| stress[k]).collect();
            coarse("cauchy_stress", &values)
        };
        let contact_p99 = touching.get((touching.len() * 99 / 100).min(touching.len().saturating_sub(1)));
        Ok(StateData {
            time,
            displacement: quantised("displacement", &body.completed(displacement.as_flattened(), 3))?,
            von_mises: quantised("von_mises", &scalar(&stress_sizes))?,
            contact_pressure: quantised("contact_traction", &scalar(&parted.spread(&state.contact_pressure)))?,
            stress: (0..6).map(component).collect::<Result<_, _>>()?,
            stretch: coarse("stretch", &largest_stretch(mesh, &displacement))?,
            thickness: coarse("thickness", &thickness_change(mesh, &self.walls, &displacement))?,
            largest_von_mises: reached.max_von_mises_mpa,
            typical: Typical {
                von_mises: reached.von_mises_p99_mpa,
                contact_pressure: contact_p99.copied().unwrap_or(0.0),
            },
        })
    }
}

/// Centre of the box around points.
pub(crate) fn centre(points: &[[f64; 3]]) -> [f64; 3] {
    let end = |d: usize, of: fn(f64, f64) -> f64| points.iter().map(|x| x[d]).reduce(of).unwrap_or(0.0);
    [0, 1, 2].map(|d| 0.5 * (end(d, f64::min) + end(d, f64::max)))
}
