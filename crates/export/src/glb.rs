//! The container of glTF 2.0 (`.glb`): a JSON text, and the numbers that it points to.

use serde_json::{Value, json};

use crate::error::ExportError;

/// Numbers of glTF.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
pub(crate) const MAGIC: u32 = 0x4654_6C67;
pub(crate) const JSON_CHUNK: u32 = 0x4E4F_534A;
pub(crate) const BINARY_CHUNK: u32 = 0x004E_4942;

/// The binary part of a file and the lists of what lies where in it.
#[derive(Default)]
pub(crate) struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    /// Vectors of corners; positions have to come with their box.
    pub(crate) fn vectors(&mut self, vectors: &[[f32; 3]], with_box: bool) -> Value {
        self.accessor(vectors.as_flattened(), 3, with_box, Some(ARRAY_BUFFER))
    }

    pub(crate) fn numbers(&mut self, numbers: &[f32], with_box: bool) -> Value {
        self.accessor(numbers, 1, with_box, None)
    }

    pub(crate) fn accessor(&mut self, numbers: &[f32], width: usize, with_box: bool, target: Option<u32>) -> Value {
        let bytes = numbers.iter().flat_map(|x| x.to_le_bytes());
        let kind = if width == 3 { "VEC3" } else { "SCALAR" };
        let mut accessor = json!({"componentType": FLOAT, "count": numbers.len() / width, "type": kind});
        if with_box {
            let end = |of: fn(f32, f32) -> f32| -> Vec<f32> {
                (0..width).filter_map(|d| numbers.iter().skip(d).step_by(width).copied().reduce(of)).collect()
            };
            accessor["min"] = end(f32::min).into();
            accessor["max"] = end(f32::max).into();
        }
        self.add(bytes.collect(), accessor, target)
    }

    pub(crate) fn indices(&mut self, triangles: &[[u32; 3]]) -> Value {
        let bytes = triangles.iter().flatten().flat_map(|corner| corner.to_le_bytes());
        let accessor = json!({"componentType": UNSIGNED_INT, "count": 3 * triangles.len(), "type": "SCALAR"});
        self.add(bytes.collect(), accessor, Some(ELEMENT_ARRAY_BUFFER))
    }

    pub(crate) fn add(&mut self, bytes: Vec<u8>, mut accessor: Value, target: Option<u32>) -> Value {
        let mut view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        accessor["bufferView"] = self.views.len().into();
        self.views.push(view);
        self.accessors.push(accessor);
        self.bytes.extend(bytes);
        (self.accessors.len() - 1).into()
    }

    pub(crate) fn close(self, mut gltf: Value) -> Result<Vec<u8>, ExportError> {
        gltf["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        gltf["bufferViews"] = self.views.into();
        gltf["accessors"] = self.accessors.into();
        let mut text = gltf.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut binary = self.bytes;
        binary.resize(binary.len().next_multiple_of(4), 0);
        let size =
            |bytes: usize| u32::try_from(bytes).map_err(|_| ExportError::TooLarge { what: "bytes of a glTF file" });
        let mut file = Vec::with_capacity(28 + text.len() + binary.len());
        for number in [MAGIC, 2, size(28 + text.len() + binary.len())?, size(text.len())?, JSON_CHUNK] {
            file.extend(number.to_le_bytes());
        }
        file.extend(text);
        for number in [size(binary.len())?, BINARY_CHUNK] {
            file.extend(number.to_le_bytes());
        }
        file.extend(binary);
        Ok(file)
    }
}
