//! The JSON part of a glTF file: what of the format this crate writes; and the container of both parts.

use super::super::shapes::Shaded;
use super::buffer::{Accessor, Buffer, BufferLength, BufferView, pad};
use nalgebra::Vector3;
use serde::Serialize;

#[derive(Debug, Clone, PartialEq, Serialize, Default)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    pub asset: Asset,
    pub scene: usize,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub meshes: Vec<Mesh>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<Material>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub animations: Vec<Animation>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub accessors: Vec<Accessor>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub buffer_views: Vec<BufferView>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub buffers: Vec<BufferLength>,
}

impl Document {
    /// The container: header, the JSON part, the binary part.
    pub fn in_container(mut self, buffer: Buffer) -> Vec<u8> {
        let bytes;
        (bytes, self.accessors, self.buffer_views, self.buffers) = buffer.into_parts();
        let mut json = crate::document::compact(&self);
        pad(&mut json, b' ');
        let length = |bytes: &[u8]| (bytes.len() as u32).to_le_bytes();
        let mut file = Vec::with_capacity(28 + json.len() + bytes.len());
        file.extend(b"glTF");
        file.extend(2_u32.to_le_bytes());
        file.extend((28 + json.len() as u32 + bytes.len() as u32).to_le_bytes());
        file.extend(length(&json));
        file.extend(b"JSON");
        file.extend(json);
        file.extend(length(&bytes));
        file.extend(b"BIN\0");
        file.extend(bytes);
        file
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub(super) struct Asset {
    pub version: &'static str,
    pub generator: &'static str,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Scene {
    pub name: String,
    pub nodes: Vec<usize>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub(super) struct Node {
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub translation: Option<[f32; 3]>,
    /// Quaternion x, y, z, w.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f32; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<usize>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extras: Option<Extras>,
}

/// What a node states of itself beyond the format.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Extras {
    pub is_illustration: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Mesh {
    pub name: String,
    pub primitives: Vec<Primitive>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Primitive {
    pub attributes: Attributes,
    pub indices: usize,
    pub material: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) struct Attributes {
    pub position: usize,
    pub normal: usize,
    #[serde(rename = "COLOR_0", skip_serializing_if = "Option::is_none")]
    pub color: Option<usize>,
}

impl Primitive {
    /// Puts a mesh into the buffer, with a linear colour for each corner where it has them.
    pub fn new(buffer: &mut Buffer, mesh: &Shaded, colors: Option<&[[f32; 3]]>, material: usize) -> Self {
        let attributes = Attributes {
            position: buffer.positions(&mesh.positions),
            normal: buffer.normals(&mesh.normals),
            color: colors.map(|colors| buffer.colors(colors)),
        };
        Self { attributes, indices: buffer.triangles(&mesh.triangles), material }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Material {
    pub name: String,
    pub pbr_metallic_roughness: Surface,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha_mode: Option<&'static str>,
}

/// How a material reflects; the colour is linear.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Surface {
    pub base_color_factor: [f32; 4],
    pub metallic_factor: f32,
    pub roughness_factor: f32,
}

impl Material {
    pub fn new(name: &str, base_color_factor: [f32; 4], metallic_factor: f32, roughness_factor: f32) -> Self {
        let surface = Surface { base_color_factor, metallic_factor, roughness_factor };
        let alpha_mode = (base_color_factor[3] < 1.0).then_some("BLEND");
        Self { name: name.to_owned(), pbr_metallic_roughness: surface, alpha_mode }
    }

    pub fn looks_like(&self, other: &Self) -> bool {
        self.pbr_metallic_roughness == other.pbr_metallic_roughness
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub(super) struct Animation {
    pub name: String,
    pub samplers: Vec<Sampler>,
    pub channels: Vec<Channel>,
}

impl Animation {
    /// Adds a track, with the accessors of its times and values.
    pub fn add(&mut self, input: usize, output: usize, target: Target) {
        self.channels.push(Channel { sampler: self.samplers.len(), target });
        self.samplers.push(Sampler { input, output, interpolation: "LINEAR" });
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Sampler {
    pub input: usize,
    pub output: usize,
    pub interpolation: &'static str,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Channel {
    pub sampler: usize,
    pub target: Target,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Target {
    pub node: usize,
    pub path: &'static str,
}

/// A scene being written.
#[derive(Default)]
pub(super) struct Writer {
    pub document: Document,
    pub buffer: Buffer,
}

impl Writer {
    pub fn add_node(&mut self, node: Node) -> usize {
        self.document.nodes.push(node);
        self.document.nodes.len() - 1
    }

    pub fn add_child(&mut self, node: Node, parent: usize) -> usize {
        let child = self.add_node(node);
        self.document.nodes[parent].children.push(child);
        child
    }
}

/// A vector in single precision.
pub(super) fn single(vector: &Vector3<f64>) -> [f32; 3] {
    [vector.x as f32, vector.y as f32, vector.z as f32]
}

/// A part of a colour from sRGB to linear (IEC 61966-2-1).
pub(super) fn linear(part: f32) -> f32 {
    let part = f64::from(part);
    let linear = if part <= 0.04045 { part / 12.92 } else { libm::pow((part + 0.055) / 1.055, 2.4) };
    linear as f32
}
