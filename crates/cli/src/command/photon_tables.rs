//! The tables of measured surfaces for `rayweave photons` and `rayweave check`.

use crate::failure::Failure;
use clap::Args;
use rayweave::photon::{DichroicTable, SurfaceTables};
use std::path::PathBuf;

/// The arguments that name tables of measured surfaces.
#[derive(Args)]
pub struct SurfaceTableArguments {
    /// Folder with the tables of Geant4's data set RealSurface, for LUT and DAVIS surfaces: as they are (PolishedTyvek.z) or
    /// decompressed (PolishedTyvek.dat)
    #[arg(long, value_name = "FOLDER")]
    surface_tables: Option<PathBuf>,

    /// Table of the transmittance of dichroic surfaces, in the format of Geant4 (G4DICHROICDATA)
    #[arg(long, value_name = "FILE")]
    dichroic: Option<PathBuf>,
}

impl SurfaceTableArguments {
    /// The tables of measured surfaces.
    pub fn tables(&self) -> Result<SurfaceTables, Failure> {
        let mut tables = SurfaceTables::default();
        if let Some(folder) = &self.surface_tables {
            tables = tables.folder(folder);
        }
        if let Some(path) = &self.dichroic {
            tables = tables.dichroic(DichroicTable::read(path)?);
        }
        Ok(tables)
    }
}
