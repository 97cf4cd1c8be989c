//! Options of readers and writers.

/// Limits for reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReadOptions {
    /// The maximal number of triangles, and the maximal number of vertices.
    pub max_elements: u64,
}

impl ReadOptions {
    /// Upper bound of the memory per triangle for reading, diagnosing and preparing a mesh, in bytes.
    pub const BYTES_PER_TRIANGLE: u64 = 176;

    /// The default limit, lowered to the number of triangles that fit into this much memory, in bytes.
    pub fn for_memory(bytes: u64) -> ReadOptions {
        let options = ReadOptions::default();
        options.with_max_elements(options.max_elements.min(bytes / Self::BYTES_PER_TRIANGLE))
    }

    /// The options with this limit of triangles and of vertices.
    pub fn with_max_elements(self, max_elements: u64) -> ReadOptions {
        ReadOptions { max_elements }
    }
}

impl Default for ReadOptions {
    /// 20 million triangles and vertices: a solid of this size takes about a gigabyte.
    fn default() -> ReadOptions {
        ReadOptions { max_elements: 20_000_000 }
    }
}

/// Options for writing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MeshWriteOptions {
    /// Writes text where the format has both a text and a binary form. Numbers in text are the shortest decimals that read back to
    /// the same bits.
    pub text: bool,
}

impl MeshWriteOptions {
    /// The options with text or binary output.
    pub fn with_text(self, text: bool) -> MeshWriteOptions {
        MeshWriteOptions { text }
    }
}
