//! The tables for the measured surfaces of a detector, from arrays and files.

use super::davis::DavisTable;
use super::dichroic::DichroicTable;
use super::lut::LutTable;
use crate::error::PhotonError;
use crate::surface::{DAVIS_FINISHES, LUT_FINISHES, MeasuredTable, SurfaceType};
use rayweave_error::Message;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// The tables for the measured surfaces of a detector.
#[derive(Clone, Debug, Default)]
pub struct SurfaceTables {
    folder: Option<PathBuf>,
    dichroic: Option<Arc<DichroicTable>>,
    given: HashMap<String, MeasuredTable>,
}

impl SurfaceTables {
    /// Adds a folder with the files of Geant4's data set RealSurface, as they are (`.z`, compressed by zlib) or decompressed
    /// (`.dat`). Only the files of finishes that a detector has are read.
    #[must_use]
    pub fn folder(self, path: impl Into<PathBuf>) -> SurfaceTables {
        SurfaceTables { folder: Some(path.into()), ..self }
    }

    /// Sets the table of all dichroic surfaces that have none of their own.
    #[must_use]
    pub fn dichroic(self, table: DichroicTable) -> SurfaceTables {
        SurfaceTables { dichroic: Some(Arc::new(table)), ..self }
    }

    /// Adds the table of an optical surface, or of all surfaces with a measured finish, by name.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, table: MeasuredTable) -> SurfaceTables {
        self.given.insert(name.into(), table);
        self
    }

    /// True if a surface has a table of its own.
    pub(crate) fn has(&self, surface: &str) -> bool {
        self.given.contains_key(surface)
    }

    /// The table of a surface by its name, type and the name of its measured finish (or an empty one); `None` for types
    /// without tables.
    ///
    /// # Errors
    ///
    /// A table that is absent, invalid, or of another type.
    pub(crate) fn find(
        &self,
        surface: &str,
        kind: SurfaceType,
        finish: &str,
    ) -> Result<Option<MeasuredTable>, Message> {
        let problem = || format!("optical surface `{surface}` has no table");
        let needed = match kind {
            SurfaceType::DielectricLut => "an LUT table",
            SurfaceType::DielectricLutDavis => "a DAVIS table",
            SurfaceType::DielectricDichroic => "a table of dichroic transmittance",
            _ => return Ok(None),
        };
        if let Some(table) = self.given.get(surface).or_else(|| self.given.get(finish)) {
            let fits = matches!(
                (kind, table),
                (SurfaceType::DielectricLut, MeasuredTable::Lut(_))
                    | (SurfaceType::DielectricLutDavis, MeasuredTable::Davis(_))
                    | (SurfaceType::DielectricDichroic, MeasuredTable::Dichroic(_))
            );
            let wrong = || {
                let problem = format!("optical surface `{surface}` has a table of another type");
                Message::new(problem, format!("its type needs {needed}"))
            };
            return if fits { Ok(Some(table.clone())) } else { Err(wrong()) };
        }
        if kind == SurfaceType::DielectricDichroic {
            let reason = "the transmittance of a dichroic filter is not part of a GDML file";
            let absent = || {
                Message::new(problem(), reason)
                    .suggest("Give the file that Geant4 finds by the variable G4DICHROICDATA.")
            };
            return self
                .dichroic
                .clone()
                .map(|table| Some(MeasuredTable::Dichroic(table)))
                .ok_or_else(absent);
        }
        let file = match kind {
            SurfaceType::DielectricLut => LUT_FINISHES.iter().find(|row| row.0 == finish).map(|row| row.1),
            _ => DAVIS_FINISHES.iter().find(|name| **name == finish).copied(),
        };
        let Some(file) = file.filter(|file| !file.is_empty()) else {
            let reason = format!("its type needs {needed}, and Geant4 has none for the finish `{finish}`");
            return Err(
                Message::new(problem(), reason).suggest("Choose a finish that Geant4 has tables for.")
            );
        };
        let Some(folder) = &self.folder else {
            let reason = format!("its type needs {needed}, which is not part of a GDML file");
            let suggestion = format!("Give the folder of Geant4's data set RealSurface with {file}.z.");
            return Err(Message::new(problem(), reason).suggest(suggestion));
        };
        let read = |suffix: &str| folder.join(format!("{file}{suffix}.dat"));
        let table = match kind {
            SurfaceType::DielectricLut => {
                LutTable::read(&read("")).map(|table| MeasuredTable::Lut(table.into()))
            }
            _ => DavisTable::read(&read("R"), &read("")).map(|table| MeasuredTable::Davis(table.into())),
        };
        table.map(Some).map_err(|error| match error {
            PhotonError::Setting(message) => message,
            other => Message::new(problem(), other.to_string()),
        })
    }
}
