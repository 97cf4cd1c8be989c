//! The device that simulates photons: the CPU, or a graphics card beside it.

use crate::device::{Device, DeviceError, DeviceOptions};
use rayweave_model::Evaluator;
use rayweave_photon::{
    Detector, HistoryOptions, PhotonError, PhotonPart, RunSettings, Source, simulate_parts,
};
use std::fmt;

#[cfg(feature = "gpu")]
use crate::device::chosen_adapter;
#[cfg(feature = "gpu")]
use rayweave_gpu::Gpu;
#[cfg(feature = "gpu")]
use rayweave_photon::{PhotonDevice, PhotonDeviceReport};
#[cfg(feature = "gpu")]
use std::sync::{Mutex, PoisonError};

/// Simulates photons on the chosen device. All devices give the same results, bit for bit.
#[derive(Debug, Default)]
pub struct PhotonSimulator {
    /// Why [`Device::Auto`] chose the CPU.
    notice: Option<String>,
    #[cfg(feature = "gpu")]
    gpu: Option<OnGpu>,
}

/// A graphics card, and what it has done so far.
#[cfg(feature = "gpu")]
#[derive(Debug)]
struct OnGpu {
    device: Device,
    photons: PhotonDevice,
    report: Mutex<PhotonDeviceReport>,
}

/// The share of a graphics card in runs of photons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct PhotonShare {
    /// The photons of the source that the card began.
    pub photons: u64,
    /// Those that the CPU finished.
    pub handed_back: u64,
    /// The steps on the card.
    pub steps: u64,
}

impl fmt::Display for PhotonShare {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = 100.0 * self.handed_back as f64 / self.photons.max(1) as f64;
        write!(f, "GPU: {} of {} photons finished by the CPU ({share:.3} %)", self.handed_back, self.photons)
    }
}

impl PhotonSimulator {
    /// Chooses a device for a detector. `records` states whether histories are recorded, which the CPU does alone.
    ///
    /// # Errors
    ///
    /// [`DeviceError`] with [`Device::Gpu`], if the card cannot be used.
    pub fn new(
        options: DeviceOptions,
        detector: &Detector,
        records: bool,
    ) -> Result<PhotonSimulator, DeviceError> {
        if options.device == Device::Cpu {
            return Ok(PhotonSimulator::on_cpu(None));
        }
        let made =
            if records { Err(DeviceError::Histories) } else { PhotonSimulator::on_gpu(options, detector) };
        match made {
            Err(problem) if options.device == Device::Auto => {
                Ok(PhotonSimulator::on_cpu(Some(problem.to_string())))
            }
            made => made,
        }
    }

    fn on_cpu(notice: Option<String>) -> PhotonSimulator {
        PhotonSimulator {
            notice,
            #[cfg(feature = "gpu")]
            gpu: None,
        }
    }

    #[cfg(feature = "gpu")]
    fn on_gpu(options: DeviceOptions, detector: &Detector) -> Result<PhotonSimulator, DeviceError> {
        let gpu = Gpu::new();
        let photons = PhotonDevice::new(chosen_adapter(&gpu, options)?, detector)?;
        let gpu = OnGpu { device: options.device, photons, report: Mutex::default() };
        Ok(PhotonSimulator { notice: None, gpu: Some(gpu) })
    }

    #[cfg(not(feature = "gpu"))]
    fn on_gpu(_: DeviceOptions, _: &Detector) -> Result<PhotonSimulator, DeviceError> {
        Err(DeviceError::NotBuilt)
    }

    /// Simulates photons as [`simulate_parts`] does; the parts of a card are larger. `detector` is that of the device.
    ///
    /// # Errors
    ///
    /// Those of [`simulate_parts`].
    pub fn simulate_parts<E: Evaluator, X: From<PhotonError>>(
        &self,
        detector: &Detector,
        evaluator: &E,
        source: &Source,
        settings: &RunSettings,
        histories: Option<HistoryOptions>,
        merge: impl FnMut(PhotonPart) -> Result<(), X>,
    ) -> Result<(), X> {
        #[cfg(feature = "gpu")]
        if let (Some(gpu), None) = (&self.gpu, histories) {
            let mut own = PhotonDeviceReport::default();
            let done = gpu.photons.simulate_parts(detector, evaluator, source, settings, &mut own, merge);
            gpu.report.lock().unwrap_or_else(PoisonError::into_inner).add(own);
            return done;
        }
        simulate_parts(detector, evaluator, source, settings, histories, merge)
    }

    /// The reason why [`Device::Auto`] uses the CPU, as a sentence; `None` if it does not.
    #[must_use]
    pub fn notice(&self) -> Option<&str> {
        self.notice.as_deref()
    }

    /// The share of the graphics card in all runs so far; `None` on the CPU.
    #[must_use]
    pub fn share(&self) -> Option<PhotonShare> {
        #[cfg(feature = "gpu")]
        return self.gpu.as_ref().map(|gpu| {
            let report = gpu.report.lock().unwrap_or_else(PoisonError::into_inner);
            PhotonShare { photons: report.photons, handed_back: report.handed_back, steps: report.steps }
        });
        #[cfg(not(feature = "gpu"))]
        return None;
    }

    /// Checks after a run that the card did not fail. After a failure the CPU simulated the rest, with the same results:
    /// [`Device::Auto`] accepts this and returns the reason.
    ///
    /// # Errors
    ///
    /// `DeviceError::Gpu` with [`Device::Gpu`], if the card has failed.
    pub fn finish(&self) -> Result<Option<String>, DeviceError> {
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &self.gpu
            && let Some(problem) = gpu.report.lock().unwrap_or_else(PoisonError::into_inner).problem.clone()
        {
            return match gpu.device {
                Device::Auto => Ok(Some(problem.to_string())),
                _ => Err(problem.into()),
            };
        }
        Ok(None)
    }
}
