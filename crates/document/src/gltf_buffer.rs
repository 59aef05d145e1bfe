//! The binary part of a glTF file.

use serde::Serialize;

/// Component types of glTF.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
/// What a view of the buffer is bound to.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// Where numbers begin in the buffer, and how they are to be read.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
#[serde(rename_all = "camelCase")]
pub struct Accessor {
    buffer_view: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    shape: &'static str,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    normalized: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<Vec<f32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<Vec<f32>>,
}

impl Accessor {
    /// So many things of a shape, in numbers of a component type.
    fn new(component_type: u32, count: usize, shape: &'static str) -> Self {
        Self { component_type, count, shape, ..Self::default() }
    }
}

/// A stretch of the buffer.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct BufferView {
    buffer: usize,
    byte_offset: usize,
    byte_length: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    target: Option<u32>,
}

/// The buffer as the JSON part knows it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct BufferLength {
    byte_length: usize,
}

/// The buffer under construction, with a view and an accessor for each list of numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Buffer {
    bytes: Vec<u8>,
    accessors: Vec<Accessor>,
    views: Vec<BufferView>,
}

impl Buffer {
    /// Corners of a mesh; returns the number of the accessor, as the others do.
    pub fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        let bounds = Some(bounds(positions));
        self.floats(positions, "VEC3", Some(VERTICES), bounds)
    }

    /// Unit normals.
    pub fn normals(&mut self, normals: &[[f32; 3]]) -> usize {
        self.floats(normals, "VEC3", Some(VERTICES), None)
    }

    /// Linear colours of corners, stored as fractions of 65535 with an opacity of one.
    pub fn colors(&mut self, colors: &[[f32; 3]]) -> usize {
        let part = |part: &f32| (part.clamp(0.0, 1.0) * 65535.0).round() as u16;
        let bytes = colors.iter().flat_map(|color| color.iter().map(part).chain([u16::MAX]).flat_map(u16::to_le_bytes));
        let accessor = Accessor { normalized: true, ..Accessor::new(UNSIGNED_SHORT, colors.len(), "VEC4") };
        self.put(bytes.collect(), Some(VERTICES), accessor)
    }

    /// Corners of triangles.
    pub fn triangles(&mut self, triangles: &[[u32; 3]]) -> usize {
        let largest = triangles.iter().flatten().copied().max().unwrap_or(0);
        let corners = triangles.iter().flatten();
        let count = triangles.len() * 3;
        // The largest number of a type is reserved.
        if largest < u32::from(u16::MAX) {
            let bytes = corners.flat_map(|k| (*k as u16).to_le_bytes()).collect();
            return self.put(bytes, Some(INDICES), Accessor::new(UNSIGNED_SHORT, count, "SCALAR"));
        }
        let bytes = corners.flat_map(|k| k.to_le_bytes()).collect();
        self.put(bytes, Some(INDICES), Accessor::new(UNSIGNED_INT, count, "SCALAR"))
    }

    /// Times of keys, rising. s
    pub fn times(&mut self, times: &[f32]) -> usize {
        let times: Vec<[f32; 1]> = times.iter().map(|time| [*time]).collect();
        let bounds = Some(bounds(&times));
        self.floats(&times, "SCALAR", None, bounds)
    }

    /// Places of a node.
    pub fn translations(&mut self, translations: &[[f32; 3]]) -> usize {
        self.floats(translations, "VEC3", None, None)
    }

    /// Quaternions x, y, z, w.
    pub fn rotations(&mut self, rotations: &[[f32; 4]]) -> usize {
        self.floats(rotations, "VEC4", None, None)
    }

    fn floats<const N: usize>(
        &mut self,
        numbers: &[[f32; N]],
        shape: &'static str,
        target: Option<u32>,
        bounds: Option<[Vec<f32>; 2]>,
    ) -> usize {
        let bytes = numbers.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
        let (min, max) = bounds.map_or((None, None), |[min, max]| (Some(min), Some(max)));
        self.put(bytes, target, Accessor { min, max, ..Accessor::new(FLOAT, numbers.len(), shape) })
    }

    fn put(&mut self, bytes: Vec<u8>, target: Option<u32>, accessor: Accessor) -> usize {
        let view = BufferView { buffer: 0, byte_offset: self.bytes.len(), byte_length: bytes.len(), target };
        self.bytes.extend(bytes);
        pad(&mut self.bytes, 0);
        self.views.push(view);
        self.accessors.push(Accessor { buffer_view: self.views.len() - 1, ..accessor });
        self.accessors.len() - 1
    }

    /// The bytes, padded, with accessors and views, and the buffer as the JSON part knows it, where there are any.
    pub fn into_parts(self) -> (Vec<u8>, Vec<Accessor>, Vec<BufferView>, Vec<BufferLength>) {
        let Self { bytes, accessors, views } = self;
        let length = (!bytes.is_empty()).then_some(BufferLength { byte_length: bytes.len() });
        (bytes, accessors, views, length.into_iter().collect())
    }
}

/// Fills up to a multiple of four bytes.
pub fn pad(bytes: &mut Vec<u8>, filler: u8) {
    bytes.resize(bytes.len().next_multiple_of(4), filler);
}

/// The smallest and the largest of each component.
fn bounds<const N: usize>(numbers: &[[f32; N]]) -> [Vec<f32>; 2] {
    let extreme = |start: f32, choose: fn(f32, f32) -> f32| {
        (0..N).map(|k| numbers.iter().fold(start, |bound, number| choose(bound, number[k]))).collect()
    };
    [extreme(f32::INFINITY, f32::min), extreme(f32::NEG_INFINITY, f32::max)]
}
