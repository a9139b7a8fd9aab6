//! The data that the page's modules work on, as JSON.

use pneuflex_mesh::Mesh;
use pneuflex_model::SymmetryPlane;
use serde::Serialize;

use crate::body::{Block, Body};
use crate::error::ReportError;
use crate::obstacles::{self, Drawn};
use crate::quantise::{Quantised, floats, integers};
use crate::report::Report;
use crate::series::Series;
use crate::skin::{Lines, Skin};
use crate::state::State;
use crate::stretch::largest_stretch;
use crate::subdivision::tetrahedra;

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
struct ClockData<'a> {
    name: &'static str,
    unit: &'static str,
    /// The parameter at the series' times, where it turned back.
    #[serde(skip_serializing_if = "Option::is_none")]
    parameters: Option<&'a [f64]>,
}

/// Elements of one family.
#[derive(Serialize)]
struct BlockData {
    nodes: String,
    nodes_per_element: usize,
    tetrahedra: Vec<[u8; 4]>,
}

#[derive(Serialize)]
struct BodyData<'a> {
    /// Whether the other half is the mirror image at y = 0.
    mirrored: bool,
    /// Point that the positions of nodes are relative to, mm: those of a small body far away would lose digits.
    origin: [f64; 3],
    nodes: String,
    elements: Vec<BlockData>,
    skin_vertices: String,
    skin_triangles: String,
    skin_parts: [usize; 2],
    mesh_edges: LineData,
    sharp_edges: LineData,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    obstacles: Vec<Drawn<'a>>,
    probes: Vec<ProbeData<'a>>,
    /// Nodes of the mesh; those beyond were added.
    mesh_nodes: usize,
    states: Vec<StateData>,
}

#[derive(Serialize)]
struct LineData {
    pairs: String,
    parts: [usize; 2],
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
    /// Components of the stress, MPa, and the largest stretch, coarsely: they are for colours.
    stress: Vec<Quantised>,
    stretch: Quantised,
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
    let body = report.states.map(|states| body_data(report, states, series)).transpose()?;
    let parameters = series.parameters.as_deref();
    let clock = ClockData { name: report.parameter(), unit: report.unit(), parameters };
    let payload = Payload { title: report.title, clock, series, body };
    let text = serde_json::to_string(&payload).map_err(|e| ReportError::Json(e.to_string()))?;
    Ok(for_script(&text))
}

/// JSON without the one character that could end the script element around it.
pub fn for_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

fn block_data(block: &Block) -> BlockData {
    BlockData {
        nodes: integers(&block.connectivity),
        nodes_per_element: block.family.num_nodes(),
        tetrahedra: tetrahedra(block.family),
    }
}

fn body_data<'a>(report: &'a Report<'_>, states: &[State], series: &Series) -> Result<BodyData<'a>, ReportError> {
    let mesh = &report.problem.mesh;
    let body = Body::new(mesh);
    let held = |plane: &SymmetryPlane| &report.problem.supports[plane.support].nodes[..];
    let symmetry: Vec<&[u32]> = report.mirror().map(held).into_iter().collect();
    let skin = Skin::new(mesh, &report.problem.cavity_facets(), &symmetry, &body);
    // The mirror image is one at y = 0.
    let origin = if report.mirrored() { [0.0; 3] } else { centre(&mesh.nodes) };
    let nodes: Vec<f64> = body.nodes.iter().flat_map(|x| [0, 1, 2].map(|d| x[d] - origin[d])).collect();
    let lines = |lines: &Lines| LineData { pairs: integers(lines.pairs.as_flattened()), parts: lines.parts };
    let probes = report.summary.probes.iter().filter(|(_, site)| site.node < mesh.num_nodes());
    let typical = |((state, p99), time): ((&State, f64), &f64)| state_data(mesh, &body, state, p99, *time);
    let p99 = report.summary.reached().map(|(_, reached)| reached.von_mises_p99_mpa);
    Ok(BodyData {
        mirrored: report.mirrored(),
        origin,
        nodes: floats(&nodes),
        elements: body.blocks().iter().map(block_data).collect(),
        skin_vertices: integers(&skin.vertices),
        skin_triangles: integers(skin.triangles.as_flattened()),
        skin_parts: skin.parts,
        mesh_edges: lines(&skin.mesh_edges),
        sharp_edges: lines(&skin.sharp_edges),
        obstacles: obstacles::drawn(report, series, origin)?,
        probes: probes.map(|(name, site)| ProbeData { name, node: site.node }).collect(),
        mesh_nodes: mesh.num_nodes(),
        states: states.iter().zip(p99).zip(&series.times[1..]).map(typical).collect::<Result<_, _>>()?,
    })
}

/// Centre of the box around points.
pub(crate) fn centre(points: &[[f64; 3]]) -> [f64; 3] {
    let end = |d: usize, of: fn(f64, f64) -> f64| points.iter().map(|x| x[d]).reduce(of).unwrap_or(0.0);
    [0, 1, 2].map(|d| 0.5 * (end(d, f64::min) + end(d, f64::max)))
}

fn state_data(
    mesh: &Mesh,
    body: &Body,
    state: &State,
    von_mises_p99: f64,
    time: f64,
) -> Result<StateData, ReportError> {
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
        let values: Vec<f64> = state.stress.iter().map(|stress| stress[k]).collect();
        coarse("cauchy_stress", &values)
    };
    let contact_p99 = touching.get((touching.len() * 99 / 100).min(touching.len().saturating_sub(1)));
    Ok(StateData {
        time,
        displacement: quantised("displacement", &body.completed(state.displacement.as_flattened(), 3))?,
        von_mises: quantised("von_mises", &scalar(&state.von_mises))?,
        contact_pressure: quantised("contact_traction", &scalar(&state.contact_pressure))?,
        stress: (0..6).map(component).collect::<Result<_, _>>()?,
        stretch: coarse("stretch", &largest_stretch(mesh, &state.displacement))?,
        typical: Typical { von_mises: von_mises_p99, contact_pressure: contact_p99.copied().unwrap_or(0.0) },
    })
}
