//! Columns of ray files and light files.

/// The six columns of a ray file: origin, then direction.
pub const RAY_COLUMNS: [&str; 6] = ["ox", "oy", "oz", "dx", "dy", "dz"];

/// The optional columns of a light file: the vacuum wavelength in nanometres, and the power.
pub const LIGHT_COLUMNS: [&str; 2] = ["wavelength_nm", "power"];

/// All columns, in the order of NPY.
pub(super) const COLUMNS: [&str; 8] = ["ox", "oy", "oz", "dx", "dy", "dz", "wavelength_nm", "power"];

/// The values of a row; columns that the file lacks are 0.
pub(super) type Row = [f64; COLUMNS.len()];

/// Whether a file has each of the columns.
pub(super) type Present = [bool; COLUMNS.len()];

/// The content of a file.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Content {
    /// [`RAY_COLUMNS`].
    Rays,
    /// [`RAY_COLUMNS`] and optional [`LIGHT_COLUMNS`].
    Light,
}

impl Content {
    /// The supported columns.
    pub fn columns(self) -> &'static [&'static str] {
        match self {
            Content::Rays => &COLUMNS[..RAY_COLUMNS.len()],
            Content::Light => &COLUMNS,
        }
    }
}
