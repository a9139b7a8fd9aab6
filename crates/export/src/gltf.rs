//! The body in motion as glTF 2.0 (`.glb`): the states are morph targets, which an animation goes through, with normals and, for a field,
//! colours at the corners. Rigid obstacles are bodies of their own that move along.
//!
//! The corners are in mm, relative to a point in the middle of the body so that few digits are lost; the nodes above turn them upright and into
//! glTF's metres.

use pneuflex_mesh::vector::{Vec3, bounds};
use serde_json::{Value, json};

use crate::error::ExportError;
use crate::glb::File;
use crate::paint::Paint;
use crate::surface::Surface;

/// A body at a moment of the animation.
#[derive(Clone, Debug)]
pub struct Moment {
    /// What it is, e.g. `at 35 kPa`.
    pub name: String,
    /// When it is shown, s.
    pub seconds: f64,
    /// Displacements of the mesh's nodes, mm; `None` for the body at rest.
    pub displacement: Option<Vec<Vec3>>,
    /// Values of the field at the mesh's nodes; empty without one.
    pub values: Vec<f64>,
}

/// A rigid body beside it.
#[derive(Clone, Debug)]
pub struct Thing {
    /// Its name.
    pub name: String,
    /// Corners at the first moment, mm, with their unit normals.
    pub corners: Vec<[Vec3; 2]>,
    /// Corners of its triangles.
    pub triangles: Vec<[u32; 3]>,
    /// How far it has moved at every moment, mm.
    pub offsets: Vec<Vec3>,
}

/// What a file shows.
#[derive(Clone, Debug)]
pub struct Scene<'a> {
    /// Title.
    pub title: &'a str,
    /// The body's surface.
    pub surface: &'a Surface,
    /// The moments in their order; one alone is a body that stands still.
    pub moments: &'a [Moment],
    /// What the field is, if there is one.
    pub paint: Option<&'a Paint>,
    /// Rigid bodies.
    pub things: &'a [Thing],
}

/// The bytes of a file.
///
/// # Errors
/// [`ExportError::TooLarge`] beyond the 4 GB that the format counts; [`ExportError::Format`] without a moment.
pub fn write(scene: &Scene<'_>) -> Result<Vec<u8>, ExportError> {
    let Some((first, later)) = scene.moments.split_first() else {
        return Err(ExportError::Format("there is no state".into()));
    };
    let mut file = File::default();
    let rest = scene.surface.positions(first.displacement.as_deref());
    let origin = middle(&rest);
    let base = Corners::new(scene, first, rest, origin);
    let mut attributes = json!({
        "POSITION": file.vectors(&base.positions, true),
        "NORMAL": file.vectors(&base.normals, false),
    });
    if scene.paint.is_some() {
        attributes["COLOR_0"] = file.vectors(&base.colours, false);
    }
    let mut primitive = json!({
        "attributes": attributes, "indices": file.indices(&scene.surface.triangles), "material": 0,
    });
    let mut mesh = json!({"name": "body"});
    if !later.is_empty() {
        let targets = later.iter().map(|moment| {
            let positions = scene.surface.positions(moment.displacement.as_deref());
            let there = Corners::new(scene, moment, positions, origin);
            let mut target = json!({
                "POSITION": file.vectors(&base.way_to(&there), true),
                "NORMAL": file.vectors(&differences(&base.normals, &there.normals), false),
            });
            if scene.paint.is_some() {
                target["COLOR_0"] = file.vectors(&differences(&base.colours, &there.colours), false);
            }
            target
        });
        primitive["targets"] = targets.collect::<Vec<_>>().into();
        // A program that plays nothing shows the last state.
        mesh["weights"] = weights(later.len(), later.len()).into();
        mesh["extras"] = json!({"targetNames": later.iter().map(|moment| &moment.name).collect::<Vec<_>>()});
    }
    mesh["primitives"] = json!([primitive]);
    let mut meshes = vec![mesh];
    let mut nodes = vec![json!({
        "name": if scene.title.is_empty() { "pneuflex" } else { scene.title },
        // z is upwards here, y there; mm here, m there.
        "rotation": [-std::f64::consts::FRAC_1_SQRT_2, 0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2],
        "scale": [0.001, 0.001, 0.001],
    })];
    nodes.push(json!({"name": "body", "mesh": 0, "translation": origin}));
    for thing in scene.things {
        let [positions, normals] =
            [0, 1].map(|k| thing.corners.iter().map(|corner| corner[k].map(|x| x as f32)).collect::<Vec<_>>());
        let attributes = json!({"POSITION": file.vectors(&positions, true), "NORMAL": file.vectors(&normals, false)});
        let primitive = json!({"attributes": attributes, "indices": file.indices(&thing.triangles), "material": 1});
        nodes.push(json!({"name": thing.name, "mesh": meshes.len()}));
        meshes.push(json!({"name": thing.name, "primitives": [primitive]}));
    }
    nodes[0]["children"] = (1..nodes.len()).collect::<Vec<_>>().into();
    let material = |name: &str, colour: [f64; 3], roughness: f64| {
        let [r, g, b] = colour;
        let look = json!({"baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": roughness});
        json!({"name": name, "pbrMetallicRoughness": look})
    };
    let body = if scene.paint.is_some() { [1.0; 3] } else { [0.38, 0.55, 0.73] };
    let mut materials = vec![material("silicone", body, 0.6)];
    if !scene.things.is_empty() {
        materials.push(material("obstacle", [0.5, 0.47, 0.42], 0.8));
    }
    let mut gltf = json!({
        "asset": {"version": "2.0", "generator": "pneuflex"},
        "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": nodes, "meshes": meshes, "materials": materials,
    });
    if let Some(Paint { label, range }) = scene.paint {
        gltf["asset"]["extras"] = json!({"colours": label, "range": range});
    }
    if !later.is_empty() {
        gltf["animations"] = json!([animation(scene, &mut file)]);
    }
    file.close(gltf)
}

/// The animation: every state has its weight at its moment, and things are where they are then.
fn animation(scene: &Scene<'_>, file: &mut File) -> Value {
    let targets = scene.moments.len() - 1;
    let seconds: Vec<f32> = scene.moments.iter().map(|moment| moment.seconds as f32).collect();
    let times = file.numbers(&seconds, true);
    let all: Vec<f32> = (0..=targets).flat_map(|moment| weights(targets, moment)).collect();
    let mut samplers = vec![json!({"input": times, "output": file.numbers(&all, false), "interpolation": "LINEAR"})];
    let mut channels = vec![json!({"sampler": 0, "target": {"node": 1, "path": "weights"}})];
    for (number, thing) in
        scene.things.iter().enumerate().filter(|(_, thing)| thing.offsets.iter().any(|u| *u != [0.0; 3]))
    {
        let offsets: Vec<[f32; 3]> = thing.offsets.iter().map(|u| u.map(|x| x as f32)).collect();
        channels.push(json!({"sampler": samplers.len(), "target": {"node": 2 + number, "path": "translation"}}));
        let output = file.accessor(offsets.as_flattened(), 3, false, None);
        samplers.push(json!({"input": times, "output": output, "interpolation": "LINEAR"}));
    }
    json!({"name": "through all states", "samplers": samplers, "channels": channels})
}

/// Weights of the targets at a moment; the first moment is none of them.
fn weights(targets: usize, moment: usize) -> Vec<f32> {
    (1..=targets).map(|target| if target == moment { 1.0 } else { 0.0 }).collect()
}

/// A whole number of mm in the middle of points.
fn middle(points: &[Vec3]) -> Vec3 {
    bounds(points.iter().copied())
        .map_or([0.0; 3], |[low, high]| std::array::from_fn(|d| (0.5 * (low[d] + high[d])).round()))
}

/// What the corners have at a moment.
struct Corners {
    positions: Vec<[f32; 3]>,
    /// The same with all digits.
    exact: Vec<Vec3>,
    normals: Vec<[f32; 3]>,
    colours: Vec<[f32; 3]>,
}

impl Corners {
    fn new(scene: &Scene<'_>, moment: &Moment, positions: Vec<Vec3>, origin: Vec3) -> Self {
        let normals = scene.surface.normals(&positions).into_iter().map(|n| n.map(|x| x as f32)).collect();
        let exact: Vec<Vec3> = positions.into_iter().map(|at| std::array::from_fn(|d| at[d] - origin[d])).collect();
        let colours = scene.paint.map_or_else(Vec::new, |paint| {
            scene.surface.values(&moment.values).into_iter().map(|value| paint.light(value)).collect()
        });
        Self { positions: exact.iter().map(|at| at.map(|x| x as f32)).collect(), exact, normals, colours }
    }

    /// What has to be added to the positions to come to another moment: to the rounded ones, so that errors do not add up.
    fn way_to(&self, there: &Self) -> Vec<[f32; 3]> {
        let pairs = self.positions.iter().zip(&there.exact);
        pairs.map(|(a, b)| std::array::from_fn(|d| (b[d] - f64::from(a[d])) as f32)).collect()
    }
}

fn differences(from: &[[f32; 3]], to: &[[f32; 3]]) -> Vec<[f32; 3]> {
    from.iter().zip(to).map(|(a, b)| std::array::from_fn(|d| b[d] - a[d])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glb::{BINARY_CHUNK, JSON_CHUNK, MAGIC};
    use crate::testing::{quarter, states, two_chambers};
    use pneuflex_mesh::vector::{dot, norm, sub};
    use pneuflex_model::{Formulation, Problem};

    /// A file that is read again.
    struct Read {
        gltf: Value,
        binary: Vec<u8>,
    }

    impl Read {
        fn new(file: &[u8]) -> Self {
            let number = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
            assert_eq!((number(0) as u32, number(4), number(8)), (MAGIC, 2, file.len()));
            let text = number(12);
            assert_eq!((number(16) as u32, number(24 + text) as u32), (JSON_CHUNK, BINARY_CHUNK));
            assert_eq!(number(20 + text), file.len() - 28 - text);
            let gltf = serde_json::from_slice(&file[20..20 + text]).unwrap();
            Self { gltf, binary: file[28 + text..].to_vec() }
        }

        fn bytes(&self, accessor: &Value) -> (&Value, Vec<[u8; 4]>) {
            let accessor = &self.gltf["accessors"][accessor.as_u64().unwrap() as usize];
            let view = &self.gltf["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
            let at = |key: &str| view[key].as_u64().unwrap() as usize;
            let bytes = &self.binary[at("byteOffset")..at("byteOffset") + at("byteLength")];
            (accessor, bytes.as_chunks().0.to_vec())
        }

        fn floats(&self, accessor: &Value) -> Vec<f64> {
            let (accessor, bytes) = self.bytes(accessor);
            let found: Vec<f64> = bytes.into_iter().map(|b| f64::from(f32::from_le_bytes(b))).collect();
            let width = if accessor["type"] == "VEC3" { 3 } else { 1 };
            assert_eq!(found.len(), width * accessor["count"].as_u64().unwrap() as usize);
            for (key, of) in [("min", f64::min as fn(f64, f64) -> f64), ("max", f64::max)] {
                for (d, end) in accessor[key].as_array().into_iter().flatten().enumerate() {
                    assert_eq!(found.iter().skip(d).step_by(width).copied().reduce(of), end.as_f64());
                }
            }
            found
        }

        /// An attribute at a time of the animation, as a player makes it.
        fn at(&self, seconds: f64, attribute: &str) -> Vec<Vec3> {
            let primitive = &self.gltf["meshes"][0]["primitives"][0];
            let mut found = self.floats(&primitive["attributes"][attribute]);
            let animation = &self.gltf["animations"][0];
            let sampler = &animation["samplers"][animation["channels"][0]["sampler"].as_u64().unwrap() as usize];
            let (times, weights) = (self.floats(&sampler["input"]), self.floats(&sampler["output"]));
            let targets = primitive["targets"].as_array().unwrap();
            let after = times.partition_point(|t| *t <= seconds).clamp(1, times.len() - 1);
            let share = (seconds - times[after - 1]) / (times[after] - times[after - 1]);
            for (number, target) in targets.iter().enumerate() {
                let of = |key: usize| weights[key * targets.len() + number];
                let weight = of(after - 1) + share * (of(after) - of(after - 1));
                let delta = self.floats(&target[attribute]);
                found.iter_mut().zip(delta).for_each(|(x, dx)| *x += weight * dx);
            }
            found.as_chunks().0.to_vec()
        }
    }

    fn moments(problem: &Problem) -> Vec<Moment> {
        let nodes = problem.mesh.num_nodes();
        let rest = Moment { name: "at rest".into(), seconds: 0.0, displacement: None, values: vec![0.0; nodes] };
        let moment = |(number, state): (usize, pneuflex_report::state::State)| Moment {
            name: format!("at {} kPa", state.time),
            seconds: 0.5 + number as f64,
            displacement: Some(state.displacement),
            values: state.von_mises,
        };
        let later = states(problem, &[1.0, 2.5]).into_iter().enumerate().map(moment);
        std::iter::once(rest).chain(later).collect()
    }

    #[test]
    fn what_plays_goes_through_the_states_of_the_fields() {
        for problem in [two_chambers(Formulation::Hex20), quarter()] {
            let (surface, moments) = (Surface::new(&problem), moments(&problem));
            let paint = Paint { label: "von Mises stress (MPa)".into(), range: [0.0, 0.2] };
            let scene = Scene { title: "t", surface: &surface, moments: &moments, paint: Some(&paint), things: &[] };
            let read = Read::new(&write(&scene).unwrap());
            let origin = &read.gltf["nodes"][1]["translation"];
            let origin: Vec3 = std::array::from_fn(|d| origin[d].as_f64().unwrap());
            let mut moved: f64 = 0.0;
            for (number, moment) in moments.iter().enumerate() {
                let expected = surface.positions(moment.displacement.as_deref());
                let normals = surface.normals(&expected);
                let values = surface.values(&moment.values);
                let found = read.at(moment.seconds, "POSITION");
                for (found, expected) in found.iter().zip(&expected) {
                    let at: Vec3 = std::array::from_fn(|d| found[d] + origin[d]);
                    assert!(norm(sub(at, *expected)) < 1e-5, "{number}: {at:?} {expected:?}");
                }
                for (found, expected) in read.at(moment.seconds, "NORMAL").iter().zip(&normals) {
                    assert!(dot(*found, *expected) > 1.0 - 1e-6);
                }
                for (found, value) in read.at(moment.seconds, "COLOR_0").iter().zip(&values) {
                    let light = paint.light(*value).map(f64::from);
                    assert!(norm(sub(*found, light)) < 1e-6);
                }
                let way = expected.iter().zip(surface.positions(None)).map(|(at, rest)| norm(sub(*at, rest)));
                moved = way.fold(moved, f64::max);
            }
            assert!(moved > 0.01);
            let between = read.at(1.0, "POSITION");
            let [a, b] = [0.5, 1.5].map(|t| read.at(t, "POSITION"));
            assert!(a.iter().zip(&b).any(|(a, b)| norm(sub(*a, *b)) > 1e-3));
            for i in 0..between.len() {
                let mean: Vec3 = std::array::from_fn(|d| 0.5 * (a[i][d] + b[i][d]));
                assert!(norm(sub(between[i], mean)) < 1e-6);
            }
            let (_, indices) = read.bytes(&read.gltf["meshes"][0]["primitives"][0]["indices"]);
            let indices: Vec<u32> = indices.into_iter().map(u32::from_le_bytes).collect();
            assert_eq!(indices, surface.triangles.as_flattened());
            assert_eq!(read.gltf["meshes"][0]["extras"]["targetNames"][1], "at 25 kPa");
        }
    }

    #[test]
    fn things_move_along_and_a_single_state_stands_still() {
        let problem = two_chambers(Formulation::Hex8Sri);
        let (surface, moments) = (Surface::new(&problem), moments(&problem));
        let up = [0.0, 0.0, 1.0];
        let corners = [[0.0, 0.0, -5.0], [9.0, 0.0, -5.0], [0.0, 9.0, -5.0]].map(|at| [at, up]);
        let thing = |offsets: Vec<Vec3>| Thing {
            name: "table".into(),
            corners: corners.into(),
            triangles: vec![[0, 1, 2]],
            offsets,
        };
        let things = [thing(vec![[0.0; 3]; 3]), thing(vec![[0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 3.0]])];
        let scene = Scene { title: "", surface: &surface, moments: &moments, paint: None, things: &things };
        let read = Read::new(&write(&scene).unwrap());
        let channels = read.gltf["animations"][0]["channels"].as_array().unwrap();
        assert_eq!((channels.len(), &channels[1]["target"]), (2, &json!({"node": 3, "path": "translation"})));
        let offsets = read.floats(&read.gltf["animations"][0]["samplers"][1]["output"]);
        assert_eq!(offsets, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 3.0]);
        assert!(read.gltf["meshes"][0]["primitives"][0]["attributes"].get("COLOR_0").is_none());

        let still = write(&Scene { moments: &moments[2..], ..scene.clone() }).unwrap();
        let still = Read::new(&still).gltf;
        assert!(still.get("animations").is_none() && still["meshes"][0].get("weights").is_none());
        assert!(write(&Scene { moments: &[], ..scene }).is_err());
    }
}
