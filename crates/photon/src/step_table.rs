//! Tables of steps.

use crate::detector::Detector;
use crate::history::{Histories, Process, StepRow};
use rayweave_math::Vec3;
use rayweave_table::{Chunk, Column, DType, NO_NAME, Schema, TableError, Values};
use std::sync::Arc;

/// The columns of a table of steps: `photon`, `track`, `step`, `process`; `x`, `y`, `z` in mm; `time` in ns; the direction `dx`,
/// `dy`, `dz`; the polarisation `px`, `py`, `pz`; `wavelength_nm`; `volume`, a path; `surface`, the name of an optical surface or
/// nothing.
///
/// # Errors
///
/// None: the names are fixed.
pub fn step_schema(detector: &Detector) -> Result<Schema, TableError> {
    let processes: Vec<String> = Process::ALL.iter().map(|process| process.name().to_owned()).collect();
    let surfaces: Vec<String> = detector.surfaces().iter().map(|surface| surface.name.clone()).collect();
    let mut columns = ["photon", "track", "step"].map(|name| Column::new(name, DType::I64)).to_vec();
    columns.push(Column::names("process", processes.into()));
    columns.extend(["x", "y", "z"].map(|name| Column::new(name, DType::F64).unit("mm")));
    columns.push(Column::new("time", DType::F64).unit("ns"));
    columns.extend(["dx", "dy", "dz", "px", "py", "pz"].map(|name| Column::new(name, DType::F64)));
    columns.push(Column::new("wavelength_nm", DType::F64).unit("nm"));
    columns.push(Column::new("volume", DType::Text));
    columns.push(Column::names("surface", surfaces.into()));
    Schema::new(columns)
}

impl Histories {
    /// The steps as rows of a table with the columns of [`step_schema`].
    ///
    /// # Errors
    ///
    /// None: the columns are of equal length.
    pub fn to_rows(&self) -> Result<Chunk, TableError> {
        let whole = |value: fn(&StepRow) -> i64| Values::I64(self.steps.iter().map(value).collect());
        let real = |value: fn(&StepRow) -> f64| Values::F64(self.steps.iter().map(value).collect());
        let ids = |value: fn(&StepRow) -> u32| Values::Name(self.steps.iter().map(value).collect());
        let vector = |vector: fn(&StepRow) -> Vec3| {
            [0, 1, 2].map(|k| Values::F64(self.steps.iter().map(|row| vector(row).to_array()[k]).collect()))
        };
        let paths: Vec<Arc<str>> = self.volumes().iter().map(|path| path.as_str().into()).collect();
        let mut columns =
            vec![whole(|row| row.photon), whole(|row| row.track), whole(|row| i64::from(row.step))];
        columns.push(ids(|row| row.process.number() as u32));
        columns.extend(vector(|row| row.position));
        columns.push(real(|row| row.time));
        columns.extend(vector(|row| row.direction));
        columns.extend(vector(|row| row.polarisation));
        columns.push(real(|row| row.wavelength_nm));
        let volumes = self.steps.iter().map(|row| paths[row.volume as usize].clone());
        columns.push(Values::Text(volumes.collect()));
        columns.push(ids(|row| row.surface.unwrap_or(NO_NAME)));
        Chunk::new(columns)
    }
}
