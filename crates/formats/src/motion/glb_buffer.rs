//! The binary chunk of a `.glb`: views and accessors as they are added.

use serde_json::{Value, json};

use crate::FileProblem;

/// A 32-bit float.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;

/// What a view of the buffer is for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Target {
    /// Vertex attributes.
    Vertices,
    /// Vertex indices.
    Indices,
    /// Neither: animations, matrices.
    Other,
}

/// Bytes, views of them and accessors. Every view begins at a multiple of 4.
#[derive(Debug, Default)]
pub(super) struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Adds rows of floats and gives the accessor's index. Least and largest are of the numbers as they are stored.
    pub(super) fn floats<const N: usize>(
        &mut self,
        kind: &str,
        rows: impl IntoIterator<Item = [f32; N]>,
        target: Target,
        bounds: bool,
    ) -> usize {
        let start = self.bytes.len();
        let (mut min, mut max) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
        let mut count = 0;
        for row in rows {
            for ((value, min), max) in row.into_iter().zip(&mut min).zip(&mut max) {
                *min = min.min(value);
                *max = max.max(value);
                self.bytes.extend(value.to_le_bytes());
            }
            count += 1;
        }
        let mut accessor = self.accessor(start, FLOAT, kind, count, target);
        if bounds {
            // As doubles, or the decimals would not be the stored number's.
            accessor["min"] = json!(min.map(f64::from).to_vec());
            accessor["max"] = json!(max.map(f64::from).to_vec());
        }
        self.push(accessor)
    }

    /// Adds rows of four short integers: a vertex's joints.
    pub(super) fn shorts(&mut self, rows: impl IntoIterator<Item = [u16; 4]>) -> usize {
        let (start, mut count) = (self.bytes.len(), 0);
        for row in rows {
            self.bytes.extend(row.into_iter().flat_map(u16::to_le_bytes));
            count += 1;
        }
        let accessor = self.accessor(start, UNSIGNED_SHORT, "VEC4", count, Target::Vertices);
        self.push(accessor)
    }

    /// Adds indices of vertices.
    pub(super) fn indices(&mut self, indices: impl IntoIterator<Item = u32>) -> usize {
        let (start, mut count) = (self.bytes.len(), 0);
        for index in indices {
            self.bytes.extend(index.to_le_bytes());
            count += 1;
        }
        let accessor = self.accessor(start, UNSIGNED_INT, "SCALAR", count, Target::Indices);
        self.push(accessor)
    }

    fn accessor(&mut self, start: usize, component: u32, kind: &str, count: usize, target: Target) -> Value {
        let mut view = json!({"buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start});
        match target {
            Target::Vertices => view["target"] = json!(34962),
            Target::Indices => view["target"] = json!(34963),
            Target::Other => {}
        }
        self.views.push(view);
        json!({"bufferView": self.views.len() - 1, "componentType": component, "count": count, "type": kind})
    }

    fn push(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// The whole file: the document with buffers, views and accessors put in, and the bytes.
    ///
    /// # Errors
    /// More than 4 GiB.
    pub(super) fn into_file(self, mut document: Value) -> Result<Vec<u8>, FileProblem> {
        document["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        document["bufferViews"] = Value::Array(self.views);
        document["accessors"] = Value::Array(self.accessors);
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bytes = self.bytes;
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        let length = 12 + 8 + text.len() + 8 + bytes.len();
        let length = u32::try_from(length).ok().ok_or_else(|| FileProblem::Field {
            field: "frames".to_owned(),
            found: format!("so many that they fill {length} bytes"),
            expected: "less than 4 GiB".to_owned(),
        })?;
        // No part is longer than the whole.
        let mut out = b"glTF\x02\x00\x00\x00".to_vec();
        out.extend(length.to_le_bytes());
        out.extend((text.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(text);
        out.extend((bytes.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(bytes);
        Ok(out)
    }
}
