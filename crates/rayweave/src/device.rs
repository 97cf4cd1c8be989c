//! The device that answers ray queries: the CPU, or a graphics card beside it.

use rayweave_error::{Classified, ErrorKind, Message};
use rayweave_model::Program;
use rayweave_trace::{AnyEvaluator, EvaluatorError};
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

#[cfg(feature = "gpu")]
use rayweave_gpu::{Adapter, AdapterKind, Gpu, GpuDevice, GpuError, GpuProgram};

/// The device that answers ray queries. All give the same answers, bit for bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Device {
    /// The CPU.
    #[default]
    Cpu,
    /// A graphics card, with the CPU for what the card cannot answer; an error if there is none or it cannot hold the model.
    Gpu,
    /// A graphics card if there is one that can hold the model, otherwise the CPU. An adapter that is a program on the CPU is
    /// used only if its number is given.
    Auto,
}

impl Device {
    /// The names of all devices; the first is the default.
    pub const NAMES: [&str; 3] = ["cpu", "gpu", "auto"];

    /// The name.
    pub fn name(self) -> &'static str {
        match self {
            Device::Cpu => "cpu",
            Device::Gpu => "gpu",
            Device::Auto => "auto",
        }
    }
}

impl FromStr for Device {
    type Err = DeviceError;

    fn from_str(name: &str) -> Result<Device, DeviceError> {
        let all = [Device::Cpu, Device::Gpu, Device::Auto];
        let found = all.into_iter().find(|device| device.name() == name);
        found.ok_or_else(|| DeviceError::UnknownName(Message::unknown("device", name, Device::NAMES)))
    }
}

/// A device that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// No device has this name.
    #[error("{0}")]
    UnknownName(Message),
    /// An evaluator is named beside a device other than the CPU.
    #[error(
        "the device `{0}` and an evaluator are given: evaluators are algorithms of the CPU. Leave one of them out."
    )]
    Evaluator(&'static str),
    /// The evaluator of the CPU cannot be made.
    #[error(transparent)]
    Cpu(#[from] EvaluatorError),
    /// The program was built without graphics cards.
    #[error(
        "the device `gpu` is not available: this program was built without the Cargo feature `gpu`. Build it with `--features gpu`, \
         or choose the device `cpu`."
    )]
    NotBuilt,
    /// Histories of photons are recorded on the CPU alone.
    #[error(
        "steps and histories of photons cannot be recorded on the device `gpu`: only hits and counts come back from it. Choose the \
         device `cpu`."
    )]
    Histories,
    /// The graphics card cannot be used.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

impl Classified for DeviceError {
    fn kind(&self) -> ErrorKind {
        match self {
            DeviceError::UnknownName(_) => ErrorKind::Name,
            DeviceError::Evaluator(_) | DeviceError::NotBuilt | DeviceError::Histories => ErrorKind::Value,
            DeviceError::Cpu(error) => error.kind(),
            #[cfg(feature = "gpu")]
            DeviceError::Gpu(error) => error.kind(),
        }
    }
}

/// The choice of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DeviceOptions {
    /// The device.
    pub device: Device,
    /// The number of the graphics card, in the order in which `rayweave devices` lists them; by default the best.
    pub adapter: Option<usize>,
}

/// The share of a device in the queries of an evaluator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct DeviceReport {
    /// Rays and points that were passed to the device.
    pub rays: u64,
    /// Those that its error bounds did not settle, so that the CPU traced them.
    pub uncertain: u64,
    /// Those that the CPU traced since they begin too far away from the model.
    pub distant: u64,
    /// Those that the CPU traced since it contradicts the device: above 0 only if a bound or the driver is wrong.
    pub contradicted: u64,
}

impl fmt::Display for DeviceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = 100.0 * self.uncertain as f64 / self.rays.max(1) as f64;
        write!(f, "GPU: {} of {} rays uncertain ({share:.3} %)", self.uncertain, self.rays)?;
        if self.distant > 0 {
            write!(f, ", {} too far away", self.distant)?;
        }
        if self.contradicted > 0 {
            write!(f, ", {} contradicted by the CPU", self.contradicted)?;
        }
        Ok(())
    }
}

/// A graphics card.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DeviceInfo {
    /// The name that the driver gives.
    pub name: String,
    /// The class in words, such as "card" or "software".
    pub kind: &'static str,
    /// The driver with its version.
    pub driver: String,
    /// The size of the largest table that a kernel can read, in bytes.
    pub largest_table_bytes: u64,
    /// True if kernels can compute in double precision.
    pub has_f64: bool,
}

/// The graphics cards of this machine, best first; none if no driver is installed.
///
/// # Errors
///
/// [`DeviceError::NotBuilt`] without the Cargo feature `gpu`.
pub fn list() -> Result<Vec<DeviceInfo>, DeviceError> {
    #[cfg(feature = "gpu")]
    return Ok(Gpu::new()
        .adapters()
        .iter()
        .map(|adapter| DeviceInfo {
            name: adapter.name().to_owned(),
            kind: adapter.kind().name(),
            driver: adapter.driver(),
            largest_table_bytes: adapter.largest_buffer(),
            has_f64: adapter.has_f64(),
        })
        .collect());
    #[cfg(not(feature = "gpu"))]
    return Err(DeviceError::NotBuilt);
}

/// The adapter of a choice. For [`Device::Auto`] a program on the CPU is one only if its number is given.
#[cfg(feature = "gpu")]
pub(crate) fn chosen_adapter(gpu: &Gpu, options: DeviceOptions) -> Result<&Adapter, GpuError> {
    let adapter = gpu.adapter(options.adapter.unwrap_or(0))?;
    let is_software = adapter.kind() == AdapterKind::Software;
    if is_software && options.device == Device::Auto && options.adapter.is_none() {
        return Err(GpuError::OnlySoftware { adapter: adapter.name().to_owned() });
    }
    Ok(adapter)
}

/// An evaluator on the chosen device.
#[derive(Clone, Debug)]
pub struct DeviceEvaluator {
    evaluator: AnyEvaluator,
    /// Why [`Device::Auto`] chose the CPU.
    notice: Option<String>,
    #[cfg(feature = "gpu")]
    gpu: Option<(Device, Arc<GpuDevice>)>,
}

impl DeviceEvaluator {
    /// Compiles a program for the chosen device; `evaluator` is the name of an evaluator of the CPU.
    ///
    /// # Errors
    ///
    /// [`DeviceError`] for an unknown evaluator and, with [`Device::Gpu`], if the card cannot be used.
    pub fn new(
        options: DeviceOptions,
        evaluator: Option<&str>,
        program: Arc<Program>,
    ) -> Result<DeviceEvaluator, DeviceError> {
        let device = options.device;
        if device != Device::Cpu && evaluator.is_some() {
            return Err(DeviceError::Evaluator(device.name()));
        }
        if device == Device::Cpu {
            return DeviceEvaluator::on_cpu(evaluator, program, None);
        }
        match DeviceEvaluator::on_gpu(options, &program) {
            Err(problem) if device == Device::Auto => {
                DeviceEvaluator::on_cpu(None, program, Some(problem.to_string()))
            }
            made => made,
        }
    }

    fn on_cpu(
        name: Option<&str>,
        program: Arc<Program>,
        notice: Option<String>,
    ) -> Result<DeviceEvaluator, DeviceError> {
        Ok(DeviceEvaluator {
            evaluator: AnyEvaluator::new(name, program)?,
            notice,
            #[cfg(feature = "gpu")]
            gpu: None,
        })
    }

    #[cfg(feature = "gpu")]
    fn on_gpu(options: DeviceOptions, program: &Arc<Program>) -> Result<DeviceEvaluator, DeviceError> {
        let gpu = Gpu::new();
        let adapter = chosen_adapter(&gpu, options)?;
        let device = Arc::new(GpuDevice::new(GpuProgram::new(adapter, program.clone())?));
        Ok(DeviceEvaluator {
            evaluator: AnyEvaluator::with_device(program.clone(), device.clone()),
            notice: None,
            gpu: Some((options.device, device)),
        })
    }

    #[cfg(not(feature = "gpu"))]
    fn on_gpu(_: DeviceOptions, _: &Arc<Program>) -> Result<DeviceEvaluator, DeviceError> {
        Err(DeviceError::NotBuilt)
    }

    /// The evaluator.
    pub fn evaluator(&self) -> &AnyEvaluator {
        &self.evaluator
    }

    /// True if a graphics card answers queries.
    pub fn is_on_gpu(&self) -> bool {
        #[cfg(feature = "gpu")]
        return self.gpu.is_some();
        #[cfg(not(feature = "gpu"))]
        return false;
    }

    /// The reason why [`Device::Auto`] uses the CPU, as a sentence; `None` if it does not.
    pub fn notice(&self) -> Option<&str> {
        self.notice.as_deref()
    }

    /// The share of the graphics card in all queries so far; `None` on the CPU.
    pub fn report(&self) -> Option<DeviceReport> {
        #[cfg(feature = "gpu")]
        return self.gpu.as_ref().map(|(_, device)| {
            let report = device.report();
            DeviceReport {
                rays: report.rays,
                uncertain: report.uncertain,
                distant: report.distant,
                contradicted: report.contradicted,
            }
        });
        #[cfg(not(feature = "gpu"))]
        return None;
    }

    /// Checks after the queries that the device has answered them. After a failure of the device the CPU traced the other
    /// rays, with the same answers: [`Device::Auto`] accepts this and returns the reason.
    ///
    /// # Errors
    ///
    /// `DeviceError::Gpu` with [`Device::Gpu`], if the device has failed.
    pub fn finish(&self) -> Result<Option<String>, DeviceError> {
        #[cfg(feature = "gpu")]
        if let Some((device, gpu)) = &self.gpu
            && let Some(problem) = gpu.problem()
        {
            return match device {
                Device::Auto => Ok(Some(problem.to_string())),
                _ => Err(problem.into()),
            };
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names() {
        assert_eq!("auto".parse(), Ok(Device::Auto));
        assert_eq!(Device::NAMES.map(|name| name.parse::<Device>().unwrap().name()), Device::NAMES);
        let problem = "gpi".parse::<Device>().unwrap_err();
        assert_eq!(problem.kind(), ErrorKind::Name);
        assert!(problem.to_string().contains("Did you mean `gpu`?"), "{problem}");
    }

    #[test]
    fn reports() {
        let report = DeviceReport { rays: 4000, uncertain: 10, ..DeviceReport::default() };
        assert_eq!(report.to_string(), "GPU: 10 of 4000 rays uncertain (0.250 %)");
        let report = DeviceReport { distant: 3, contradicted: 1, ..report };
        assert!(report.to_string().ends_with(", 3 too far away, 1 contradicted by the CPU"));
    }

    #[test]
    fn the_cpu_takes_the_name_of_an_evaluator_and_other_devices_do_not() {
        let program = Arc::new(Program::compile(&crate::shapes::sphere(1.0).unwrap()).unwrap());
        let make = |device, name| {
            let options = DeviceOptions { device, adapter: None };
            DeviceEvaluator::new(options, name, program.clone())
        };
        let cpu = make(Device::Cpu, Some("weave")).unwrap();
        assert_eq!(rayweave_model::Evaluator::name(cpu.evaluator()), "weave");
        assert_eq!((cpu.notice(), cpu.report(), cpu.finish()), (None, None, Ok(None)));
        assert_eq!(make(Device::Gpu, Some("weave")).unwrap_err(), DeviceError::Evaluator("gpu"));
    }

    #[cfg(not(feature = "gpu"))]
    #[test]
    fn without_the_feature_auto_uses_the_cpu_and_says_why() {
        let program = Arc::new(Program::compile(&crate::shapes::sphere(1.0).unwrap()).unwrap());
        let options = |device| DeviceOptions { device, adapter: None };
        let problem = DeviceEvaluator::new(options(Device::Gpu), None, program.clone()).unwrap_err();
        assert!(problem.to_string().contains("--features gpu"), "{problem}");
        let auto = DeviceEvaluator::new(options(Device::Auto), None, program).unwrap();
        assert!(!auto.is_on_gpu() && auto.notice().unwrap().contains("--features gpu"));
    }
}
