//! Tables of measured surfaces, given by the user as arrays or as files in the formats of Geant4.
//!
//! Geant4 reads the tables of its models `LUT` and `DAVIS` from the data set RealSurface (the folder in the environment
//! variable `G4REALSURFACEDATA`) and the table of dichroic filters from the file in `G4DICHROICDATA`. Rayweave ships no
//! tables.
//!
//! *Source*: `G4OpticalSurface` and `G4Physics2DVector` of Geant4 11: sizes, order and units of the numbers.

mod davis;
mod dichroic;
mod lut;
mod rows;
mod set;
mod text;

pub use davis::DavisTable;
pub use dichroic::DichroicTable;
pub use lut::LutTable;
pub use set::SurfaceTables;
