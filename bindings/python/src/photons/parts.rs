//! A detector and its evaluator, which runs, sources and histories share.

use std::sync::OnceLock;

use rayweave::Packets;
use rayweave::device::{Device, DeviceError, DeviceOptions};
use rayweave::formats::Imported;
use rayweave::photon::{Detector, SurfaceTables};
use rayweave::photon_simulator::PhotonSimulator;

/// A detector with its evaluator, and the file and the tables that it is made from.
pub struct DetectorParts {
    pub detector: Detector,
    pub evaluator: Packets,
    pub imported: Imported,
    pub tables: SurfaceTables,
    /// The simulators on the devices `gpu` and `auto`, made at their first use.
    pub simulators: [OnceLock<PhotonSimulator>; 2],
}

impl DetectorParts {
    /// The simulator on a device, compiled at its first use and kept. `records` states whether histories are recorded.
    pub fn with_simulator<T>(
        &self,
        device: Device,
        records: bool,
        run: impl FnOnce(&PhotonSimulator) -> T,
    ) -> Result<T, DeviceError> {
        let make = || PhotonSimulator::new(DeviceOptions { device, adapter: None }, &self.detector, records);
        if device == Device::Cpu || records {
            return Ok(run(&make()?));
        }
        let place = &self.simulators[usize::from(device == Device::Auto)];
        if let Some(kept) = place.get() {
            return Ok(run(kept));
        }
        let made = make()?;
        Ok(run(place.get_or_init(|| made)))
    }
}
