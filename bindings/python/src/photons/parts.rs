//! A detector and its evaluator, which runs and histories share.

use rayweave::Packets;
use rayweave::photon::Detector;

/// A detector with its evaluator.
pub struct DetectorParts {
    pub detector: Detector,
    pub evaluator: Packets,
}
