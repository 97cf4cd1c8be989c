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

/// A unit of length of the 3MF core specification (`ST_Unit`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ThreeMfUnit {
    /// 1e-6 m.
    Micron,
    /// 1e-3 m, the default of the format.
    #[default]
    Millimeter,
    /// 1e-2 m.
    Centimeter,
    /// 25.4 mm.
    Inch,
    /// 304.8 mm.
    Foot,
    /// The metre.
    Meter,
}

impl ThreeMfUnit {
    /// The word of the format.
    pub fn word(self) -> &'static str {
        match self {
            ThreeMfUnit::Micron => "micron",
            ThreeMfUnit::Millimeter => "millimeter",
            ThreeMfUnit::Centimeter => "centimeter",
            ThreeMfUnit::Inch => "inch",
            ThreeMfUnit::Foot => "foot",
            ThreeMfUnit::Meter => "meter",
        }
    }
}

/// Options for writing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MeshWriteOptions {
    /// Writes text where the format has both a text and a binary form. Numbers in text are the shortest decimals that read back to
    /// the same bits.
    pub text: bool,
    /// The unit of the coordinates of the meshes, which a 3MF file states. Other formats have no unit, or always metres.
    pub unit: ThreeMfUnit,
}

impl MeshWriteOptions {
    /// The options with text or binary output.
    pub fn with_text(self, text: bool) -> MeshWriteOptions {
        MeshWriteOptions { text, ..self }
    }

    /// The options with this unit of 3MF files.
    pub fn with_unit(self, unit: ThreeMfUnit) -> MeshWriteOptions {
        MeshWriteOptions { unit, ..self }
    }
}
