//! Tables of steps and of histories.

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
        let mut columns =
            vec![whole(|row| row.photon), whole(|row| row.track), whole(|row| i64::from(row.step))];
        columns.push(ids(|row| row.process.number() as u32));
        columns.extend(vector(|row| row.position));
        columns.push(real(|row| row.time));
        columns.extend(vector(|row| row.direction));
        columns.extend(vector(|row| row.polarisation));
        columns.push(real(|row| row.wavelength_nm));
        let volumes = self.steps.iter().map(|row| self.volumes()[row.volume as usize].clone());
        columns.push(Values::Text(volumes.collect()));
        columns.push(ids(|row| row.surface.unwrap_or(NO_NAME)));
        Chunk::new(columns)
    }

    /// The histories as rows of a table with the columns of [`history_schema`]: a row for each track, with the photon at its end.
    ///
    /// # Errors
    ///
    /// None: the columns are of equal length.
    pub fn to_history_rows(&self) -> Result<Chunk, TableError> {
        let tracks: Vec<&[StepRow]> = self.steps.chunk_by(|a, b| a.track == b.track).collect();
        let ends: Vec<&StepRow> = tracks.iter().filter_map(|rows| rows.last()).collect();
        let whole = |value: fn(&StepRow) -> i64| Values::I64(ends.iter().map(|row| value(row)).collect());
        let real = |value: fn(&StepRow) -> f64| Values::F64(ends.iter().map(|row| value(row)).collect());
        let text = |rows: &&[StepRow]| -> Arc<str> {
            rows.iter().map(|row| row.process.name()).collect::<Vec<_>>().join(" ").into()
        };
        let volumes = ends.iter().map(|row| self.volumes()[row.volume as usize].clone());
        Chunk::new(vec![
            whole(|row| row.photon),
            whole(|row| row.track),
            whole(|row| i64::from(row.step)),
            Values::Text(tracks.iter().map(text).collect()),
            Values::Text(volumes.collect()),
            real(|row| row.position.x),
            real(|row| row.position.y),
            real(|row| row.position.z),
            real(|row| row.time),
            real(|row| row.wavelength_nm),
        ])
    }
}

/// The columns of a table of histories, which has a row for each track: `photon`, `track`; `steps`; `history`, the names of the
/// processes, separated by spaces; and at the end of the track `volume`, a path; `x`, `y`, `z` in mm; `time` in ns;
/// `wavelength_nm`.
///
/// # Errors
///
/// None: the names are fixed.
pub fn history_schema() -> Result<Schema, TableError> {
    let mut columns = ["photon", "track", "steps"].map(|name| Column::new(name, DType::I64)).to_vec();
    columns.extend(["history", "volume"].map(|name| Column::new(name, DType::Text)));
    columns.extend(["x", "y", "z"].map(|name| Column::new(name, DType::F64).unit("mm")));
    columns.push(Column::new("time", DType::F64).unit("ns"));
    columns.push(Column::new("wavelength_nm", DType::F64).unit("nm"));
    Schema::new(columns)
}
