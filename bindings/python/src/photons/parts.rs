//! A detector and its evaluator, which runs, sources and histories share.

use rayweave::Packets;
use rayweave::formats::Imported;
use rayweave::photon::{Detector, SurfaceTables};

/// A detector with its evaluator, and the file and the tables that it is made from.
pub struct DetectorParts {
    pub detector: Detector,
    pub evaluator: Packets,
    pub imported: Imported,
    pub tables: SurfaceTables,
}
