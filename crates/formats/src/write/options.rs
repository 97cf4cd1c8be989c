//! Options of writers.

/// Options for writing a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// Chord tolerance: largest distance between a curved face and its triangles, in the unit of the scene; greater than 0.
    /// Default: 1/5000 of the diagonal of the model's bounding box.
    pub tolerance: Option<f64>,
    /// Selects text for mesh formats that have a text and a binary form (STL, PLY).
    pub text: bool,
    /// Writes meshes that are not sound, with a remark, instead of rejecting them: edges without two triangles, or triangles that
    /// intersect each other.
    pub allow_unsound: bool,
}
